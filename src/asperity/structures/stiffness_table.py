"""The dynamic stiffness of a pad as it was measured: over frequency, at one preload or several."""

from dataclasses import dataclass

import numpy as np

from asperity.arguments import Array, ArrayLike, Complex, NDArray, finite_array
from asperity.errors import InputError

NOMINAL = 300.0
"""Frequency at which the real part of a table is the nominal stiffness of a pad, Hz; chosen here."""
FEWEST = 3
"""Frequencies of a table at one preload."""


@dataclass(frozen=True)
class StiffnessTable:
    """Dynamic stiffness over frequency, as of the pad of a track.

    Between the frequencies real and imaginary part are linear in the logarithm of frequency; below the first
    and above the last they are as there.

    Parameters
    ----------
    frequencies : tuple of float
        Hz, rising, three or more.
    real, imaginary : tuple of float
        N/m, e^{+iωt}.

    Raises
    ------
    InputError
        If frequencies do not rise, or in some band a real part is not positive, or an imaginary part is
        negative, so that the pad would make energy.
    """

    frequencies: tuple[float, ...]
    real: tuple[float, ...]
    imaginary: tuple[float, ...]

    def __post_init__(self) -> None:
        allowed = f"{FEWEST} or more, rising, all above 0 Hz"
        at = finite_array(
            "frequencies of a stiffness (Hz)", self.frequencies, allowed, above=0.0, rising=True
        )
        if at.ndim != 1 or at.size < FEWEST:
            raise InputError("frequencies of a stiffness (Hz)", f"{at.size} frequencies", allowed)
        finite_array("dynamic stiffness (N/m)", [self.real, self.imaginary], shape=(2, at.size))
        if wrong := band_of(at, np.asarray(self.real) <= 0.0):
            remedy = "Is the unit right, and the phase that of force over displacement?"
            raise InputError(
                "dynamic stiffness", f"a real part of zero or less {wrong}", "above zero", remedy
            )
        if wrong := band_of(at, np.asarray(self.imaginary) < 0.0):
            received = f"an imaginary part below zero {wrong}, by which the pad would make energy"
            remedy = "With a time factor e^{-iωt} change its sign; else leave these lines out."
            raise InputError("dynamic stiffness", received, "zero or more", remedy)

    @property
    def nominal(self) -> float:
        """Real part at 300 Hz, N/m."""
        return float(np.interp(np.log(NOMINAL), np.log(self.frequencies), self.real))

    @property
    def static(self) -> float:
        """Real part at its lowest frequency, which stands for the stiffness at rest, over the nominal one."""
        return self.real[0] / self.nominal

    def at(self, omega: ArrayLike) -> Complex:
        """Stiffness relative to the nominal one at angular frequencies, rad/s, zero or more."""
        frequency = np.maximum(np.real(omega) / (2.0 * np.pi), self.frequencies[0])
        place, known = np.log(frequency), np.log(self.frequencies)
        real, imaginary = (np.interp(place, known, part) for part in (self.real, self.imaginary))
        return np.asarray((real + 1j * imaginary) / self.nominal, dtype=complex)


def stiffness_at_preload(rows: Array, preload: float) -> StiffnessTable:
    """Dynamic stiffness at a preload, N, from a table of several.

    Rows (n, 3) of frequency, Hz, real and imaginary part, N/m, or with the preload, N, (n, 4), in any order,
    are the table. Between two preloads real and imaginary part
    are linear in preload, beyond them as there. An `InputError` says what is wrong with the table.
    """
    preloads = preloads_of(rows)
    tables = [_table(rows if rows.shape[1] < 4 else rows[rows[:, 3] == each]) for each in preloads]
    place = np.interp(preload, preloads, np.arange(len(preloads)))
    below, above = tables[int(place)], tables[min(int(place) + 1, len(tables) - 1)]
    at = np.union1d(below.frequencies, above.frequencies)
    low, high = (each.at(2.0 * np.pi * at) * each.nominal for each in (below, above))
    mixed = low + (place - int(place)) * (high - low)
    return StiffnessTable(*(tuple(part.tolist()) for part in (at, mixed.real, mixed.imag)))


def preloads_of(rows: Array) -> Array:
    """Preloads of a table, N, rising; one, zero, of a table that does not tell them."""
    return np.unique(rows[:, 3]) if rows.shape[1] > 3 else np.zeros(1)


def _table(rows: Array) -> StiffnessTable:
    sorted_rows = rows[np.argsort(rows[:, 0], kind="stable")]
    return StiffnessTable(*(tuple(column.tolist()) for column in sorted_rows[:, :3].T))


def band_of(frequencies: Array, wrong: NDArray[np.bool_]) -> str:
    """The first band in which something is wrong; nothing where it is nowhere."""
    found = np.flatnonzero(wrong)
    if not found.size:
        return ""
    after = found[0] + np.argmin(np.append(wrong[found[0] :], False)) - 1
    ends = frequencies[found[0]], frequencies[after]
    return f"at {ends[0]:g} Hz" if ends[0] == ends[1] else f"from {ends[0]:g} to {ends[1]:g} Hz"
