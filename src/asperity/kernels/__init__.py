"""Compiled functions on plain arrays: the numerical work of all rooms."""
