"""What finer settings change: levels compared, the group of a result that says so, and its sentence."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray
from xarray import DataTree

from asperity.scenes import schema as scene
from asperity.scenes.compute import spectrum_segment
from asperity.scenes.validity import compared_bands
from asperity.schema import Entry, attributes, contact, convergence, rolling, spectra, variables
from asperity.spectra import band_levels, nominal_frequency, psd


@dataclass(frozen=True, eq=False)
class Levels:
    """Levels of a run."""

    band: NDArray[np.float64]  # (b,), centres, Hz
    force: NDArray[np.float64]  # (laws, b), dB
    motion: NDArray[np.float64]  # (laws, b), dB, energy mean over the places; NaN where none is recorded
    stiffness: float  # mean contact stiffness under the load, N/m

    @classmethod
    def of_result(cls, tree: DataTree) -> Levels:
        """Take them from the result of a run."""
        held = tree[spectra.FORCE_LEVEL.group].to_dataset()
        force = held[spectra.FORCE_LEVEL.name].values
        recorded = motion_entry(held)
        motion = np.full(force.shape, np.nan)
        if recorded is not None:
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


def motion_entry(held: Mapping[Any, Any]) -> Entry | None:
    """The level of a motion that spectra hold, by law and band; None if there is none."""
    fitting = (e for e in scene.KEPT if e.dims[0] == "law" and e.dims[-1] == "band" and e.name in held)
    return next(fitting, None)


def halves(tree: DataTree, step: float, highest: float) -> tuple[Levels, Levels]:
    """Levels of the force over all of a record and over its first half, from segments of one length."""
    force = tree[rolling.CONTACT_FORCE.group].to_dataset()[rolling.CONTACT_FORCE.name].values
    half = force.shape[-1] // 2
    segment = min(spectrum_segment(force.shape[-1], step), half)
    found = []
    for part in (force, force[..., :half]):
        frequency, density = psd(part, step, segment=segment)
        band, level = band_levels(frequency, density.mean(axis=1), high=highest)
        found.append(Levels(band, level, np.full(level.shape, np.nan), np.nan))
    return found[0], found[1]


CONVERGED = 0.5
"""Change of a level up to which a setting is fine enough, dB."""
NOT_CONVERGED = "Not converged"
"""How a sentence begins that comes before all others."""


@dataclass(frozen=True, eq=False)
class Comparison:
    """What a setting was changed by, and what that did."""

    setting: str
    words: str  # from what to what
    limit: str  # why it was not changed; empty where it was
    change: Levels  # of the finer computation over the coarser, on the bands of the result


def convergence_group(result: DataTree, found: Sequence[Comparison]) -> xarray.Dataset:
    """Lay out comparisons: changes by setting, law and band, the largest of the main law, and a sentence."""
    held = result[spectra.BAND.group].to_dataset()
    band, laws = held[spectra.BAND.name].values, [str(law) for law in held[spectra.LAW.name].values]
    changes = [comparison.change for comparison in found]
    shown = compared_bands(held.drop_vars(spectra.START_SHARE.name, errors="ignore"))  # all start alike
    largest = [_largest(change.force[0], shown) for change in changes]
    laid_out: dict[Entry, object] = {
        convergence.SETTING: [comparison.setting for comparison in found],
        convergence.CHANGE: [comparison.words for comparison in found],
        convergence.LIMIT: [comparison.limit for comparison in found],
        convergence.LAW: laws,
        convergence.BAND: band,
        convergence.FORCE_LEVEL_CHANGE: [change.force for change in changes],
        convergence.STIFFNESS_CHANGE: [change.stiffness for change in changes],
        convergence.LARGEST_CHANGE: [size for size, _ in largest],
        convergence.LARGEST_BAND: [band[at] if at is not None else np.nan for _, at in largest],
    }
    if (motion := motion_entry(held)) is not None:
        entry = convergence.MOTION_LEVEL_CHANGE
        values = [change.motion for change in changes]
        laid_out[entry] = entry.variable(values, quantity=motion.long_name)
    group = xarray.Dataset(variables(laid_out))
    return group.assign_attrs(attributes({convergence.SENTENCE: sentence(group, laws[0])}))


def _largest(change: NDArray[np.float64], shown: NDArray[np.bool_]) -> tuple[float, int | None]:
    """Largest size of a change in the bands that are compared, and its place."""
    size = np.where(shown & np.isfinite(change), np.abs(change), -1.0)
    at = int(size.argmax())
    return (float(size[at]), at) if size[at] >= 0.0 else (np.nan, None)


def sentence(group: xarray.Dataset, main: str) -> str:
    """Say which setting matters most and how much, which others matter, and which were not changed."""
    return " ".join(filter(None, _sentences(group, main)))


def _sentences(group: xarray.Dataset, main: str) -> Iterator[str]:
    names = [str(name) for name in group[convergence.SETTING.name].values]
    words = dict(zip(names, map(str, group[convergence.CHANGE.name].values), strict=True))
    limits = dict(zip(names, map(str, group[convergence.LIMIT.name].values), strict=True))
    size = dict(zip(names, group[convergence.LARGEST_CHANGE.name].values.tolist(), strict=True))
    known = sorted((name for name in names if np.isfinite(size[name])), key=lambda name: -size[name])
    tried = [name for name in known if name != convergence.PATH_LENGTH]
    if tried:
        first, *others = tried
        band = float(group[convergence.LARGEST_BAND.name].values[names.index(first)])
        lost = convergence.meaningless(size[first], size.get(convergence.PATH_LENGTH, np.nan))
        yield f"{NOT_CONVERGED}: {first} is too coarse for these levels to mean anything." if lost else ""
        yield (
            f"Of its settings, {first} ({words[first]}) changes the levels of {main} most, by up to "
            f"{size[first]:.2f} dB ({nominal_frequency(band)})."
        )
        yield _told_of_others(first, others, size)
        stiffness = dict(zip(names, group[convergence.STIFFNESS_CHANGE.name].values.tolist(), strict=True))
        most = max(tried, key=lambda name: abs(stiffness[name]))
        yield f"The mean contact stiffness depends most on {most} ({_percent(stiffness[most])})."
    if convergence.PATH_LENGTH in known:
        yield f"The first half of the record is up to {size[convergence.PATH_LENGTH]:.1f} dB from all of it."
    if unchanged := [name for name in names if limits[name]]:
        yield f"Not changed: {', '.join(unchanged)}."


def _told_of_others(first: str, others: Sequence[str], size: dict[str, float]) -> str:
    above = [name for name in others if size[name] > CONVERGED]
    if size[first] <= CONVERGED:
        return f"All are fine enough for {CONVERGED:g} dB."
    if above:
        named = ", ".join(f"{name} ({size[name]:.1f} dB)" for name in above)
        return f"Above {CONVERGED:g} dB is also {named}."
    if others:
        return f"The others change them by up to {size[others[0]]:.2f} dB."
    return ""


def _percent(share: float) -> str:
    return f"{100 * share:+.2f} %".replace("-", "−")
