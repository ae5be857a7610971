"""Reports, comparisons and notebooks of results of any scene."""
