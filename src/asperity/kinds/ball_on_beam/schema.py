"""What the result of a ball on a beam holds beside what all results hold."""

from __future__ import annotations

from asperity.schema import Entry
from asperity.schema.spectra import NO_SIGNAL

ACCELERATION_REFERENCE = 1e-6
"""Of acceleration levels, m/s²."""
_SENSOR = "position of the accelerometer on what is rolled over"

ROLLING_SENSOR = Entry("rolling", "sensor", ("sensor",), "m", _SENSOR)
ACCELERATION = Entry(
    "rolling",
    "acceleration",
    ("law", "sensor", "time"),
    "m/s2",
    "acceleration of what is rolled over, positive downwards",
)
BALL_DISPLACEMENT = Entry(
    "rolling", "ball_displacement", ("law", "time"), "m", "displacement of the ball, positive downwards"
)
BEAM_DISPLACEMENT = Entry(
    "rolling",
    "beam_displacement",
    ("law", "time"),
    "m",
    "displacement of the beam under the ball, positive downwards",
)
ENERGY_TERM = Entry("rolling", "energy_term", ("energy_term",), "1", "term of the energy balance")
ENERGY = Entry("rolling", "energy", ("law", "energy_term"), "J", "energy since the start of the run-in")
ENERGY_RESIDUAL = Entry(
    "rolling",
    "energy_residual",
    ("law",),
    "1",
    "what the energy balance leaves open, relative to the throughput",
)

SPECTRA_SENSOR = Entry("spectra", "sensor", ("sensor",), "m", _SENSOR)
ACCELERATION_PSD = Entry(
    "spectra",
    "acceleration_psd",
    ("law", "sensor", "frequency"),
    "(m/s2)2/Hz",
    "PSD of the acceleration of what is rolled over, one-sided",
)
ACCELERATION_LEVEL = Entry(
    "spectra",
    "acceleration_level",
    ("law", "sensor", "band"),
    "dB re 1e-6 m/s2",
    "acceleration level",
    missing=NO_SIGNAL,
)

KEPT: dict[Entry, dict[str, str]] = {ACCELERATION_LEVEL: {}}
"""What a study keeps."""
SHOWN = (f"{ACCELERATION_LEVEL.name}_a",)
"""What a study shows of it unasked."""
