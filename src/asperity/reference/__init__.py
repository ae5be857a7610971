"""Cited tables and named parameter sets: materials and rail roughness."""
