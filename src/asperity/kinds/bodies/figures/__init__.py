"""Figures of bodies that roll."""
