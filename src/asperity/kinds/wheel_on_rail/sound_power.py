"""Rolling noise: sound power from roughness by CNOSSOS-EU, and what a change of contact force makes of it.

Directive (EU) 2015/996, appendix, section 2.3, as amended by Delegated Directive (EU) 2021/1226.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.errors import InputError
from asperity.spectra import a_weighting, energy_sum

Table = tuple[ArrayLike, ArrayLike]
"""Band centres and levels in dB, each (n,)."""

SOURCES = ("track", "wheel", "total")


@dataclass(frozen=True, eq=False)
class SoundPower:
    """Sound power levels of rolling, by source."""

    band: NDArray[np.float64]  # (b,), exact centres of the one-third octaves, Hz
    levels: NDArray[np.float64]  # (3, b), of the `SOURCES`, dB re 1 pW; NaN where no roughness is known

    @property
    def a_weighted(self) -> NDArray[np.float64]:
        """A-weighted total over the known bands of each source, dB(A) re 1 pW, shape (3,)."""
        known = ~np.isnan(self.levels[0])
        return energy_sum(self.levels[:, known] + a_weighting(self.band[known]))

    def with_difference(self, band: ArrayLike, difference: ArrayLike) -> SoundPower:
        """The same with another contact force: each band changed by as much as the force, dB.

        Centres (n,), nominal or exact, Hz; bands without a difference, or with NaN, keep their level. The
        sound of rail and wheel is linear in the contact force; both change alike.
        """
        numbers, change = _band_numbers(band), np.atleast_1d(np.asarray(difference, dtype=float))
        if numbers.shape != change.shape or np.isinf(change).any():
            received = f"{numbers.size} bands and {change.size} values"
            raise InputError("difference of force levels", received, "one finite value or NaN per band")
        own = _band_numbers(self.band)
        known = dict(zip(numbers.tolist(), np.nan_to_num(change).tolist(), strict=True))
        return SoundPower(self.band, self.levels + np.array([known.get(n, 0.0) for n in own.tolist()]))


def rolling_sound_power(
    speed: float,
    rail_roughness: Table | None,
    wheel_roughness: Table | None,
    track_transfer: Table,
    wheel_transfer: Table,
    *,
    contact_filter: Table | None = None,
    axles: int = 1,
) -> SoundPower:
    """Sound power of rolling: L_W = (L_rail ⊕ L_wheel + A₃) + L_H + 10 lg N, for N axles at a speed, m/s.

    Roughnesses are wavelengths, m, and levels, dB re 1 µm, None for a smooth one; transfers frequencies, Hz,
    and L_H, dB, both for the same bands, in which the result is; the contact filter wavelengths, m, and A₃,
    dB, for all bands of the roughness. Leave it out where a difference of force levels will be added that
    holds the filtering of the contact already.

    A band of frequency f holds the wavelengths around v/f: those of two wavelength bands, whose energies are
    shared in proportion, that is interpolated in lg λ. Where one surface has no level, the other one's counts
    alone; where both have none, the band is NaN and left out of totals.
    """
    if not (np.isfinite(speed) and speed > 0.0):
        raise InputError("speed (m/s)", speed, "a finite positive number")
    if axles < 1:
        raise InputError("number of axles", axles, "one or more")
    numbers, track = _bands("track transfer", track_transfer)
    wheel_numbers, wheel = _bands("wheel transfer", wheel_transfer)
    if not np.array_equal(numbers, wheel_numbers):
        raise InputError("wheel transfer", f"{wheel_numbers.size} bands", "the bands of the track transfer")
    wavelength, effective = _effective_roughness(rail_roughness, wheel_roughness, contact_filter)
    place = np.round(10.0 * np.log10(speed) - numbers, 9)  # 10 lg λ
    energy = np.interp(place, wavelength, 10.0 ** (effective / 10.0), left=np.nan, right=np.nan)
    roughness = 10.0 * np.log10(energy) + 10.0 * np.log10(axles)
    levels = np.stack([roughness + track, roughness + wheel])
    return SoundPower(10.0 ** (numbers / 10.0), np.vstack([levels, energy_sum(levels, axis=0)]))


def _effective_roughness(
    rail: Table | None, wheel: Table | None, contact_filter: Table | None
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Energy sum of the surfaces, with the filter: band numbers 10 lg λ, levels with NaN in the gaps."""
    given = [
        _bands(what, table)
        for what, table in (("rail roughness", rail), ("wheel roughness", wheel))
        if table is not None
    ]
    if not given:
        raise InputError("roughness", "none", "levels of the rail, the wheel or both")
    first, last = min(n[0] for n, _ in given), max(n[-1] for n, _ in given)
    numbers = np.arange(first, last + 1)
    energy = np.zeros(numbers.size)
    for at, level in given:
        energy[at - first] += 10.0 ** (level / 10.0)
    with np.errstate(divide="ignore"):
        total = np.where(energy > 0.0, 10.0 * np.log10(energy), np.nan)
    if contact_filter is None:
        return numbers, total
    at, gain = _bands("contact filter", contact_filter)
    if at[0] > first or at[-1] < last:
        received = f"wavelengths from {10.0 ** (at[0] / 10.0):.3g} to {10.0 ** (at[-1] / 10.0):.3g} m"
        raise InputError("contact filter", received, "every band of the roughness")
    return numbers, total + gain[first - at[0] : last - at[0] + 1]


def _bands(what: str, table: Table) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Band numbers, rising without gaps, and their levels."""
    numbers, levels = _band_numbers(table[0]), np.atleast_1d(np.asarray(table[1], dtype=float))
    if numbers.shape != levels.shape or not np.isfinite(levels).all():
        received = f"{numbers.size} bands and {levels.size} levels"
        raise InputError(what, received, "one finite level per band")
    order = np.argsort(numbers)
    if not (np.diff(numbers[order]) == 1).all():
        raise InputError(
            what, "missing or repeated bands", "every one-third octave between first and last once"
        )
    return numbers[order], levels[order]


def _band_numbers(centres: ArrayLike) -> NDArray[np.int64]:
    """Nearest numbers n of the bands 10^(n/10), which takes nominal centres to exact ones."""
    values = np.atleast_1d(np.asarray(centres, dtype=float))
    if values.ndim != 1 or values.size == 0 or not ((values > 0.0) & (values < np.inf)).all():
        raise InputError("band centres", f"{values.size} values", "finite positive numbers")
    return np.rint(10.0 * np.log10(values)).astype(np.int64)
