"""Three-dimensional contact: the half-space solver and Hertz's closed forms."""
