"""Measured and synthesised surfaces: reading, levelling, statistics, synthesis."""
