"""A track with known keys, a cheap quantity of it in closed form, and its mobility."""

import numpy as np

from asperity.observables.observable import Measured, Observable

TRACK = {"name": "uic60", "pad_stiffness": 3e8, "pad_loss_factor": 0.2, "ballast_loss_factor": 1.0}
RUBBER = "rubber"
"""A quantity in closed form, k exp(−η x): pad stiffness, and its loss factor as a rate."""


def _predict(trial, measured):
    keys = trial.case.track
    return 1e-8 * keys.pad_stiffness * np.exp(-keys.pad_loss_factor * measured.at)


RUBBERY = Observable(
    RUBBER,
    "1",
    "x (1)",
    10.0,
    1.0,
    lambda _: "",
    _predict,
    lambda _: ("track.pad_stiffness", "track.pad_loss_factor"),
    "rubber",
)


def mobility(case, frequency, **more):
    """Point mobility of a track in mid-span, (m/s)/N."""
    half = 0.5 * case.track.sleeper_spacing if case.track.sleeper_spacing else 0.3
    receptance = case.track.model().receptance(frequency, half, half)
    return Measured("mobility", frequency, 2j * np.pi * np.asarray(frequency) * receptance, **more)
