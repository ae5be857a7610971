"""Figures and tables of the report that only a ball on a beam has."""
