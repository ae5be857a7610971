"""How many time steps a period takes: with as many, a run has no doubt of what it resolves."""

PER_RESONANCE, PER_RESONANCE_ON_RAIL = 10.0, 5.0
"""In a period of the contact resonance, and of that on a bay of rail, which carries vibration away."""
OF_HIGHEST, PER_RESONANCE_BEYOND = 15.0, 5.0
"""In a period of the highest frequency asked for, and at least in one of a resonance, if that lies so far
beyond that it takes fewer. With n of them its frequency f₀ is lower by (2π/n)²/24, and what it adds to the
answer at f, (f/f₀)², larger by (2π/n)²/12: at most 1.5 % of the answer to a constant force."""
PER_HIGHEST, PER_HIGHEST_ON_RAIL = 10.0, 5.0
"""In a period of the highest frequency asked for, likewise."""
PER_MODE = 4.0
"""In a period of a mode of a structure or a body, which is exact for forces that are linear over a step."""
PER_SLEEPER = 20.0
"""From one sleeper to the next."""


def steps_per_resonance(resonance: float, highest: float | None) -> float:
    """Time steps in a period of a contact resonance, Hz, if one asks up to a highest frequency, Hz."""
    if highest is None or PER_RESONANCE * resonance <= OF_HIGHEST * highest:
        return PER_RESONANCE
    return max(OF_HIGHEST * highest / resonance, PER_RESONANCE_BEYOND)
