"""How many time steps a period takes: with as many, a run has no doubt of what it resolves."""

PER_RESONANCE, PER_RESONANCE_ON_RAIL = 10.0, 5.0
"""In a period of the contact resonance, and of that on a bay of rail, which carries vibration away."""
PER_HIGHEST, PER_HIGHEST_ON_RAIL = 10.0, 5.0
"""In a period of the highest frequency asked for, likewise."""
PER_MODE = 4.0
"""In a period of a mode of a structure or a body, which is exact for forces that are linear over a step."""
PER_SLEEPER = 20.0
"""From one sleeper to the next."""
