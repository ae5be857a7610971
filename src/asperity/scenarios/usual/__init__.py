"""What a kind of case does where it says nothing of its own: one body rolls over another, any two."""
