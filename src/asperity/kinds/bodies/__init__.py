"""Bodies roll, one or many, over any structure."""
