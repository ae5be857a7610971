"""A wheel rolls on an infinite track."""
