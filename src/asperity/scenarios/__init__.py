"""What all kinds of case share on the way from a case to its result."""
