"""What of a result is compared: levels by law and band, and the mean contact stiffness."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.scenarios.kind import Kind
from asperity.scenarios.tree import spectrum_segment
from asperity.schema import Entry, contact, rolling, spectra
from asperity.spectra import band_levels, psd


@dataclass(frozen=True, eq=False)
class Levels:
    """Levels of a run."""

    band: NDArray[np.float64]  # (b,), centres, Hz
    force: NDArray[np.float64]  # (laws, b), dB
    motion: NDArray[np.float64]  # (laws, b), dB, energy mean over the places; NaN where none is recorded
    stiffness: float  # mean contact stiffness under the load, N/m

    @classmethod
    def of_result(cls, tree: DataTree, kind: Kind) -> Levels:
        """Take them from the result of a run of a kind."""
        held = tree[spectra.FORCE_LEVEL.group].to_dataset()
        force = held[spectra.FORCE_LEVEL.name].values
        recorded = motion_entry(kind)
        motion = np.full(force.shape, np.nan)
        if recorded is not None and recorded.name in held:
            power = 10.0 ** (held[recorded.name].values / 10.0)
            with np.errstate(divide="ignore"):
                motion = 10.0 * np.log10(power.mean(axis=tuple(range(1, power.ndim - 1))))
        stiffness = tree[contact.WORKING_STIFFNESS.group].attrs[contact.WORKING_STIFFNESS.name]
        return cls(held[spectra.BAND.name].values, force, motion, float(stiffness))

    def packed(self) -> dict[str, NDArray[Any]]:
        """Lay them out as a store keeps them."""
        return {name: np.asarray(value) for name, value in vars(self).items()}

    @classmethod
    def unpacked(cls, arrays: Mapping[str, NDArray[Any]]) -> Levels:
        """Make them of what `packed` laid out."""
        return cls(arrays["band"], arrays["force"], arrays["motion"], float(arrays["stiffness"]))

    @property
    def nothing(self) -> Levels:
        """No levels, on the same bands."""
        none = np.full(self.force.shape, np.nan)
        return Levels(self.band, none, none, np.nan)

    def over(self, coarser: Levels, band: NDArray[np.float64]) -> Levels:
        """Differences to those of a coarser computation, dB, on some bands; NaN where one lacks a band.

        Of the stiffness the ratio, less one.
        """
        mine, others = self._on(band), coarser._on(band)
        with np.errstate(invalid="ignore"):
            differences = [a - b for a, b in zip(mine, others, strict=True)]
        return Levels(band, differences[0], differences[1], self.stiffness / coarser.stiffness - 1.0)

    def _on(self, band: NDArray[np.float64]) -> list[NDArray[np.float64]]:
        places = [np.flatnonzero(np.isclose(self.band, centre, rtol=1e-3)) for centre in band]
        found = []
        for values in (self.force, self.motion):
            columns = [values[:, at[0]] if len(at) else np.full(len(values), np.nan) for at in places]
            found.append(np.stack(columns, axis=1))
        return found


def motion_entry(kind: Kind) -> Entry | None:
    """The level of a recorded motion that a study keeps of a kind, by law and band; None if there is none."""
    fitting = (entry for entry in kind.kept if entry.dims[0] == "law" and entry.dims[-1] == "band")
    return next(fitting, None)


def halves(tree: DataTree, step: float, highest: float) -> tuple[Levels, Levels]:
    """Levels of the force over all of a record and over its first half, from segments of one length."""
    force = tree[rolling.CONTACT_FORCE.group].to_dataset()[rolling.CONTACT_FORCE.name].values
    half = force.shape[1] // 2
    segment = min(spectrum_segment(force.shape[1], step), half)
    found = []
    for part in (force, force[:, :half]):
        frequency, density = psd(part, step, segment=segment)
        band, level = band_levels(frequency, density, high=highest)
        found.append(Levels(band, level, np.full(level.shape, np.nan), np.nan))
    return found[0], found[1]
