"""Compiled functions on plain arrays, in SI, without classes and without input or output."""
