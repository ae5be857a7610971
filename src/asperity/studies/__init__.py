"""Studies: one case with lists of values for some keys, computed side by side into one table."""
