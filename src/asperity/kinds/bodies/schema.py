"""What the result of bodies that roll holds beside what all results hold."""

from __future__ import annotations

from asperity.kinds.ball_on_beam.schema import (
    ACCELERATION,
    ACCELERATION_LEVEL,
    ACCELERATION_PSD,
    ENERGY,
    ENERGY_RESIDUAL,
    ENERGY_TERM,
    ROLLING_SENSOR,
    SPECTRA_SENSOR,
)
from asperity.schema import Entry
from asperity.schema.spectra import NO_SIGNAL

__all__ = [
    "ACCELERATION",
    "ACCELERATION_LEVEL",
    "ACCELERATION_PSD",
    "ENERGY",
    "ENERGY_RESIDUAL",
    "ENERGY_TERM",
    "ROLLING_SENSOR",
    "SPECTRA_SENSOR",
]

_CONTACT = "number of the contact, body by body, each from its rearmost; contact_force is that of the first"
_DEGREE = "degree of freedom of a body: what moves, and how"
BODY_REFERENCE = 1e-6
"""Of acceleration levels, m/s²."""

CONTACT = Entry("rolling", "contact", ("contact",), "1", _CONTACT)
OFFSET = Entry("rolling", "offset", ("contact",), "m", "position of a contact ahead of that of the run")
STATIC_LOAD = Entry("rolling", "static_load", ("contact",), "N", "static force of a contact")
CONTACT_FORCES = Entry(
    "rolling",
    "contact_forces",
    ("law", "contact", "time"),
    "N",
    "force of each contact, compression positive",
)
APPROACHES = Entry(
    "rolling",
    "approaches",
    ("law", "contact", "time"),
    "m",
    "approach of the mean surfaces at each contact, positive closing",
)
OVER_DISPLACEMENTS = Entry(
    "rolling",
    "over_displacements",
    ("law", "contact", "time"),
    "m",
    "displacement of what is rolled over at each contact, positive downwards",
)
ROLLING_DISPLACEMENTS = Entry(
    "rolling",
    "rolling_displacements",
    ("law", "contact", "time"),
    "m",
    "displacement of what rolls at each contact, positive downwards",
)
LOSS_SHARES = Entry(
    "rolling", "contact_loss_shares", ("law", "contact"), "1", "share of the time out of each contact"
)
DEGREE = Entry("rolling", "degree", ("degree",), "1", _DEGREE)
BODY_DISPLACEMENT = Entry(
    "rolling",
    "body_displacement",
    ("law", "degree", "time"),
    "m",
    "motion of the bodies in their degrees of freedom, positive downwards; of a pitch at the front end, half "
    "the distance of the outermost contacts from the middle",
)

SPECTRA_CONTACT = Entry("spectra", "contact", ("contact",), "1", _CONTACT)
FORCE_PSDS = Entry(
    "spectra",
    "contact_force_psds",
    ("law", "contact", "frequency"),
    "N2/Hz",
    "PSD of the force of each contact, one-sided",
)
FORCE_LEVELS = Entry(
    "spectra",
    "contact_force_levels",
    ("law", "contact", "band"),
    "dB re 1 N",
    "level of the force of each contact",
    missing=NO_SIGNAL,
)
SUM_PSD = Entry(
    "spectra",
    "force_sum_psd",
    ("law", "frequency"),
    "N2/Hz",
    "PSD of the sum of all contact forces, one-sided",
)
SPECTRA_DEGREE = Entry("spectra", "degree", ("degree",), "1", _DEGREE)
BODY_ACCELERATION_PSD = Entry(
    "spectra",
    "body_acceleration_psd",
    ("law", "degree", "frequency"),
    "(m/s2)2/Hz",
    "PSD of the acceleration of the bodies in their degrees of freedom, one-sided",
)
PASSING_FREQUENCY = Entry(
    "spectra",
    "passing_frequency",
    ("passing_frequency",),
    "Hz",
    "frequency at which contacts at equal distances pass a place, and its multiples",
    condition="contacts at equal distances",
)

KEPT: dict[Entry, dict[str, str]] = {FORCE_LEVELS: {}, ACCELERATION_LEVEL: {}}
"""What a study keeps."""
SHOWN = (f"{ACCELERATION_LEVEL.name}_a",)
"""What a study shows of it unasked."""
