"""Figures of the report that only a wheel on a rail has."""
