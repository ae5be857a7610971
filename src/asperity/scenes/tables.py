"""Tables of a wheel that a case names: its modes and its receptance."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

from asperity.config.content import name_of
from asperity.config.tables import Column, TableSource, read_table
from asperity.errors import InputError

FEWEST_LINES = 10  # of a receptance

MODES = (Column("frequency", "Hz"), Column("damping ratio", ""), Column("modal mass", "kg"))
RADIATION = (
    Column("nodal diameters", ""),
    Column("axial velocity over the disc", ""),
    Column("radial velocity of the tread", ""),
)
"""Further columns of modes: how they move the whole wheel, rms per radial velocity at the contact."""
RATIOS = (Column("frequency", "Hz"), Column("radiation ratio", ""))
RECEPTANCE = (Column("frequency", "Hz"), Column("real part", "m/N"), Column("imaginary part", "m/N"))


@contextmanager
def fitted_to(table: TableSource) -> Iterator[None]:
    """Name the table where modes cannot be fitted to its receptance."""
    try:
        yield
    except InputError as error:
        raise InputError(
            f"{error.what} in {name_of(table)}", error.received, error.allowed, error.remedy
        ) from None


def read_modes(table: TableSource) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Read the modes of a wheel: frequencies, Hz, damping ratios and modal masses, kg, (n,) each."""
    frequency, ratio, mass = read_table(table, MODES, RADIATION)[:, : len(MODES)].T
    read_mode_shapes(table)  # which may stand beside them
    for name, values, right, allowed in (
        ("frequency", frequency, frequency > 0, "greater than 0 Hz"),
        ("damping ratio", ratio, (ratio > 0) & (ratio < 1), "greater than 0 and less than 1"),
        ("modal mass", mass, mass > 0, "greater than 0 kg"),
    ):
        if not right.all():
            raise InputError(name_of(table), f"a {name} of {values[~right][0]:g}", allowed)
    return frequency, ratio, mass


def read_mode_shapes(table: TableSource) -> NDArray[np.float64] | None:
    """Read how the modes of a wheel move its disc and tread, the further columns (n, 3); None without them.

    Number of nodal diameters, rms axial velocity over the disc and rms radial velocity of the tread, both per
    radial velocity of the mode at the contact.
    """
    shapes = read_table(table, MODES, RADIATION)[:, len(MODES) :]
    if not shapes.shape[1]:
        return None
    diameters, ratios = shapes[:, 0], shapes[:, 1:]
    if (wrong := (diameters < 0) | (diameters % 1 != 0)).any():
        received = f"a number of nodal diameters of {diameters[wrong][0]:g}"
        raise InputError(name_of(table), received, "a whole number, zero or more")
    if (ratios < 0).any():
        received = f"an rms velocity of {ratios[ratios < 0][0]:g}"
        raise InputError(name_of(table), received, "zero or more, per radial velocity at the contact")
    return shapes


def read_ratios(table: TableSource) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Read radiation ratios (n,) over rising frequencies (n,), Hz, all above zero."""
    frequency, ratio = read_table(table, RATIOS).T
    if frequency[0] <= 0 or (np.diff(frequency) <= 0).any():
        raise InputError(name_of(table), "frequencies that do not rise", "rising frequencies, all above 0 Hz")
    if (ratio <= 0).any():
        received = f"a radiation ratio of {ratio[ratio <= 0][0]:g}"
        raise InputError(name_of(table), received, "greater than 0")
    return frequency, ratio


def read_receptance(table: TableSource) -> tuple[NDArray[np.float64], NDArray[np.complex128]]:
    """Read the receptance of a wheel, (n,), m/N, e^{+iωt}, with its rising frequencies, Hz.

    A table of three columns: frequency, real and imaginary part.
    """
    frequency, real, imaginary = read_table(table, RECEPTANCE).T
    if frequency.size < FEWEST_LINES:
        raise InputError(name_of(table), f"{frequency.size} frequencies", f"at least {FEWEST_LINES}")
    if frequency[0] <= 0 or (np.diff(frequency) <= 0).any():
        raise InputError(name_of(table), "frequencies that do not rise", "rising frequencies, all above 0 Hz")
    return frequency, real + 1j * imaginary
