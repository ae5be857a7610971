"""A run again with each setting made finer: what that changes, in a group of its result and a sentence."""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import xarray
from xarray import DataTree

from asperity.arguments import Array, Flags, NDArray
from asperity.case.any_case import AnyCase, ReadyCase, function_named
from asperity.case.form import case_key, content, file_digest
from asperity.errors import AsperityError, CaseError, InputError, PhysicsWarning
from asperity.progress import COMPILED, Progress, counted
from asperity.scenarios.refining import Setting, Way
from asperity.scenes import schema as scene
from asperity.scenes.validity import compared_bands
from asperity.schema import Entry, Values, bearing, contact, convergence, group, provenance, rolling, spectra
from asperity.spectra import (
    HALF_BAND,
    band_levels,
    energy_of,
    level_of,
    lowest_band,
    nominal_frequency,
    psd,
    spectrum_segment,
)
from asperity.store import Store, made
from asperity.threads import one_thread_in_linear_algebra
from asperity.written_numbers import rounded

FORMAT = 1
"""Raise it when kept levels no longer mean what they meant."""
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
    change: xarray.Dataset  # of the finer computation over the coarser, on the bands of the result


def settings_of(prepared: ReadyCase, result: DataTree) -> Sequence[Setting]:
    """All settings by which a case of any kind is made finer, as its kind lists them."""
    settings: Sequence[Setting] = function_named(prepared.case.REFINED_BY)(prepared, result)
    return settings


def with_convergence(prepared: ReadyCase, result: DataTree, progress: Progress) -> DataTree:
    """Compute a case again with each setting made finer, and add to its result what that changes.

    Parameters
    ----------
    prepared : ReadyCase
        The case.
    result : xarray.DataTree
        What it gave.
    progress : Progress
        Called during the work.

    Returns
    -------
    xarray.DataTree
        The result with the group convergence, and one more sentence in its verdict. Levels of each
        computation are kept in the store: interrupted, the work goes on where it was.
    """
    # those of the case itself were told
    with PhysicsWarning.ignored(), one_thread_in_linear_algebra():
        settings = settings_of(prepared, result)
        each = (_compared(prepared, result, setting, _named(setting, progress)) for setting in settings)
        found = list(counted(each, len(settings), "convergence", progress))
    group = convergence_group(result, found)
    told = [str(result.attrs[provenance.VERDICT.name]), str(group.attrs[convergence.SENTENCE.name])]
    if told[1].startswith(NOT_CONVERGED):
        told.reverse()
    tree = DataTree(result.to_dataset(inherit=False), children=result.children)
    tree["convergence"] = DataTree(group)
    tree.attrs[provenance.VERDICT.name] = " ".join(told)
    return tree


def _named(setting: Setting, progress: Progress) -> Progress:
    """Say for which setting a piece of work is done."""

    def told(done: int, total: int, message: str) -> None:
        if message != COMPILED:  # long since
            progress(done, total, f"{setting.name}: {message}")

    return told


def _compared(prepared: ReadyCase, result: DataTree, setting: Setting, progress: Progress) -> Comparison:
    """Take the first way of changing a setting that can be computed."""
    base = levels_of(result)
    limit = setting.limit
    for way in setting.ways:
        try:
            if setting.name == convergence.PATH_LENGTH:
                case = prepared.case
                coarser, finer = halves(result, case.recorded_step, case.highest_frequency)
            else:
                finer, coarser = _both(prepared, base, setting, way, progress)
        except AsperityError as error:
            limit = limit or brief(error)
        else:
            return Comparison(setting.name, way.words, "", _over(finer, coarser, base))
    return Comparison(setting.name, "", limit, xarray.full_like(base, np.nan))


def _both(
    prepared: ReadyCase, base: xarray.Dataset, setting: Setting, way: Way, progress: Progress
) -> tuple[xarray.Dataset, xarray.Dataset]:
    """Levels of the finer and of the coarser computation; `base` are those of the case."""
    case = prepared.case.with_(**way.changes)
    changed: ReadyCase = function_named(case.PREPARED_BY)(case, "case")
    if setting.laid_anew is None:
        return _levels(changed.case, "", lambda: changed, progress), base
    small, large = (changed, prepared) if way.coarser else (prepared, changed)
    textures_of = json.dumps(content(large.case, file_digest), sort_keys=True)
    twin = _levels(small.case, textures_of, partial(setting.laid_anew, small, large), progress)
    if way.coarser:
        return base, twin
    return _levels(changed.case, "", lambda: changed, progress), twin


def _levels(
    case: AnyCase, textures_of: str, make: Callable[[], ReadyCase], progress: Progress
) -> xarray.Dataset:
    """Levels of a run, kept by all that they depend on."""

    def computed() -> dict[str, NDArray[Any]]:
        found = levels_of(function_named(case.COMPUTED_BY)(make(), progress, [], brief=True))
        return {str(name): values.values for name, values in found.variables.items()}

    return _laid_out(**made(Store(), case_key("convergence", FORMAT, case, textures_of), computed))


def _laid_out(band: Array, force: Array, motion: Array, stiffness: Any) -> xarray.Dataset:
    """Levels of force and motion (laws, bands), dB, and the mean contact stiffness under the load, N/m.

    Of the motion the energy mean over the places; NaN where none is recorded.
    """
    both = {"force": (("law", "band"), force), "motion": (("law", "band"), motion)}
    return xarray.Dataset(both | {"stiffness": ((), stiffness)}, {"band": band})


def levels_of(tree: DataTree) -> xarray.Dataset:
    """Take the levels that are compared from the result of a run."""
    held = tree[spectra.FORCE_LEVEL.group].to_dataset()
    force = held[spectra.FORCE_LEVEL.name].values
    recorded = motion_entry(held)
    motion = np.full(force.shape, np.nan)
    if recorded is not None:
        power = energy_of(held[recorded.name].values)
        motion = level_of(power.mean(axis=tuple(range(1, power.ndim - 1))))
    stiffness = tree[contact.WORKING_STIFFNESS.group].attrs.get(contact.WORKING_STIFFNESS.name, np.nan)
    return _laid_out(held[spectra.BAND.name].values, force, motion, stiffness)


def _over(finer: xarray.Dataset, coarser: xarray.Dataset, base: xarray.Dataset) -> xarray.Dataset:
    """Differences of two computations, dB, on the bands of the case; NaN where one lacks a band.

    Of the stiffness the ratio, less one.
    """
    band = base["band"].values
    mine, others = (
        each.reindex(band=band, method="nearest", tolerance=1e-3 * band) for each in (finer, coarser)
    )
    with np.errstate(invalid="ignore"):
        return (mine - others).assign(stiffness=finer["stiffness"] / coarser["stiffness"] - 1.0)


def motion_entry(held: Mapping[Any, Any]) -> Entry | None:
    """The level of a motion that spectra hold, by law and band; None if there is none."""
    levels = (entry for entry in (*scene.KEPT, bearing.ACCELERATION_LEVEL))
    fitting = (e for e in levels if e.dims[0] == "law" and e.dims[-1] == "band" and e.name in held)
    return next(fitting, None)


def halves(tree: DataTree, step: float, highest: float) -> tuple[xarray.Dataset, xarray.Dataset]:
    """Levels of the force over all of a record and over its first half, from segments of one length.

    An `InputError` says that the half holds no one-third octave up to the highest frequency.
    """
    force = np.asarray(tree[rolling.CONTACT_FORCE.path].values)
    half = force.shape[-1] // 2
    segment = min(spectrum_segment(force.shape[-1], step), half)
    lowest = lowest_band(half, step, segment=segment)
    if highest * HALF_BAND < lowest:
        received = (
            f"{half * step:.4g} s, half of the record, of which the lowest band is at {rounded(lowest, 4)} Hz"
        )
        raise InputError("duration", received, f"a half that holds a band up to {rounded(highest, 4)} Hz")

    def levels(part: Array) -> xarray.Dataset:
        frequency, density = psd(part, step, segment=segment)
        band, level = band_levels(frequency, density.mean(axis=1), high=highest)
        return _laid_out(band, level, np.full(level.shape, np.nan), np.nan)

    return levels(force), levels(force[..., :half])


def convergence_group(result: DataTree, found: Sequence[Comparison]) -> xarray.Dataset:
    """Lay out comparisons: changes by setting, law and band, the largest of the main law, and a sentence."""
    held = result[spectra.BAND.group].to_dataset()
    band = held[spectra.BAND.name].values
    laws = [str(law) for law in held[spectra.LAW.name].values]
    changes = [comparison.change for comparison in found]
    shown = compared_bands(held.drop_vars(spectra.START_SHARE.name, errors="ignore"))  # all start alike
    largest = [_largest(change.force.values[0], shown) for change in changes]
    laid_out: Values = {
        convergence.SETTING: [comparison.setting for comparison in found],
        convergence.CHANGE: [comparison.words for comparison in found],
        convergence.LIMIT: [comparison.limit for comparison in found],
        convergence.LAW: laws,
        convergence.BAND: band,
        convergence.FORCE_LEVEL_CHANGE: [change.force.values for change in changes],
        convergence.STIFFNESS_CHANGE: [float(change.stiffness) for change in changes],
        convergence.LARGEST_CHANGE: [size for size, _ in largest],
        convergence.LARGEST_BAND: [band[at] if at is not None else np.nan for _, at in largest],
    }
    if (motion := motion_entry(held)) is not None:
        entry = convergence.MOTION_LEVEL_CHANGE
        values = [change.motion.values for change in changes]
        laid_out[entry] = entry.variable(values, quantity=motion.long_name)
    return group(laid_out | {convergence.SENTENCE: sentence(group(laid_out), laws[0])})


def _largest(change: Array, shown: Flags) -> tuple[float, int | None]:
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
        if softened := [name for name in tried if np.isfinite(stiffness[name])]:
            most = max(softened, key=lambda name: abs(stiffness[name]))
            share = f"{100 * stiffness[most]:+.2f} %".replace("-", "−")
            yield f"The mean contact stiffness depends most on {most} ({share})."
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


def brief(error: AsperityError) -> str:
    """Why a setting was not changed, in a line."""
    if isinstance(error, CaseError):
        return error.errors[0]
    if isinstance(error, InputError):
        return f"{error.what}: received {error.received}; allowed: {error.allowed}"
    return str(error)
