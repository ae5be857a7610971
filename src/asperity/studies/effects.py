"""What each variant of a case does to a level: its difference to the case as it is, and how sure that is."""

import json
from collections.abc import Collection, Mapping
from typing import Any

import numpy as np
import xarray
from xarray import DataTree

from asperity.arguments import FilePath, Integers, one_of, require, shown
from asperity.case import any_case, cases
from asperity.errors import InputError
from asperity.progress import Progress
from asperity.scenes import schema
from asperity.schema import Entry, spectra
from asperity.studies.axes import AS_IT_IS, VARIANT
from asperity.studies.definition import Study, study_of
from asperity.studies.ensemble import SEED, student
from asperity.studies.member import JUDGED, VELOCITY_LEVEL

SEEDS = 3
"""Textures by which the ready list says how sure its effects are: that of the case, and the next."""
CONFIDENCE = 0.95


def _named_changes(case: any_case.AnyCase) -> dict[str, Mapping[str, Any]]:
    """Changes of a case that are ready to be asked; an `InputError` says if its kind lists none."""
    listed = case.helping_changes
    allowed = "a case over a track, which is heard, of a ball bearing, or of a kind that lists its own"
    require(listed, "what helps", f"a {case.kind} case", allowed)
    return dict(listed)


def what_helps(
    case: FilePath | Mapping[str, Any] | any_case.AnyCase,
    sweep: Mapping[str, Any] | None = None,
) -> Study:
    """Make the study that answers what makes a case over a track, or a ball bearing, quieter.

    Parameters
    ----------
    case : path, mapping or case object
        The case, as `asperity.run` takes it.
    sweep : mapping of str to list, optional
        Further keys, as `asperity.study` takes them; ``"seed"`` in place of the usual three.

    Returns
    -------
    Study
        Of the main law of the case, of its seed and the next two, and of variants of it: pads, roughness,
        speed, …, as ``asperity new what-helps`` lists them; of a bearing clearance, preload, grooves, waves
        of each part, …, as ``asperity new what-helps-in-bearings`` does. `asperity.study` computes it,
        `effects` reads it.

    Raises
    ------
    InputError
        If the case is wrong, or its kind lists nothing that may help it: other than tracks and bearings.

    Examples
    --------
    >>> import asperity
    >>> plan = asperity.what_helps(asperity.WheelOnRail(surface={"spectrum": "iso3095"}))
    >>> sorted(plan.sweep), plan.sweep["variant"]["a fifth slower"]
    (['seed', 'variant'], {'speed': 'times 0.8'})
    """
    given = cases.as_case(case)
    variants = _named_changes(given)
    seeds = [given.seed + more for more in range(SEEDS)]
    asked: dict[str, Any] = {SEED: seeds, VARIANT: variants, **(sweep or {})}
    return study_of(given.with_(laws=given.laws[:1]), asked)


def with_effects(case: any_case.AnyCase, result: DataTree, progress: Progress | None = None) -> DataTree:
    """Compute what helps a case, and add it to the result of its run."""
    from asperity.studies.running import study

    tree = DataTree(result.to_dataset(inherit=False), children=result.children)
    tree[schema.EFFECT.group] = DataTree(effects(study(what_helps(case), progress=progress)))
    return tree


def judged_levels(table: xarray.Dataset) -> list[str]:
    """Levels of a study by which effects are told: A-weighted ones, and those of a bearing's velocities."""
    return [
        str(name)
        for name, each in table.data_vars.items()
        if each.attrs["units"].startswith("dB(A)") or name == VELOCITY_LEVEL
    ]


def effects(table: xarray.Dataset, quantity: str = "") -> xarray.Dataset:
    """What each variant of a study does to a level, the quietest first.

    Parameters
    ----------
    table : xarray.Dataset
        From `asperity.study`, of variants; with several seeds, they say how sure the effects are.
    quantity : str, optional
        An A-weighted level of the table; by default the sound power of rail, sleepers and wheel, the
        velocity of a bearing in its bands, or the contact force.

    Returns
    -------
    xarray.Dataset
        By `variant`, of the main law: `effect`, dB, the level less that of the case as it is, of the same
        seed, mean over the seeds; `effect_error`, dB, half of its confidence interval of 95 %; `left_out`,
        why there is none; and `level` of the case as it is. Other swept keys and what radiates are further
        dimensions.

    Raises
    ------
    InputError
        If the table has no variants, or no such quantity.

    Notes
    -----
    Each variant rolls over the textures of the case as it is, so that chance is in both and the scatter of
    the difference is small: with n seeds the error is t s/√n, s its standard deviation over the seeds and
    Student's t for n − 1 degrees of freedom.

    Examples
    --------
    >>> import asperity
    >>> from concurrent.futures import ThreadPoolExecutor
    >>> smoother = {"smoother": {"surface.level": "minus 20 dB"}}
    >>> with ThreadPoolExecutor(1) as here:
    ...     table = asperity.study(case, {"variant": smoother}, executor=here)
    >>> found = asperity.effects(table)
    >>> found["effect"].dims, bool(found["effect"].sel(variant="smoother") < 0.0)
    (('variant',), True)
    """
    if not isinstance(table, xarray.Dataset) or VARIANT not in table.dims:
        received = list(map(str, table.dims)) if isinstance(table, xarray.Dataset) else shown(table)
        raise InputError("table of the study", received, f'one with the dimension "{VARIANT}"')
    judged = judged_levels(table)
    first = schema.RADIATED_POWER_LEVEL_A.name, VELOCITY_LEVEL
    usual = next((name for name in first if name in judged), f"{spectra.FORCE_LEVEL.name}_a")
    held = table[one_of("quantity", quantity or usual, judged)]
    law = str(table["law"].values[0])
    held = held.sel(law=law, drop=True) if "law" in held.dims else held
    base = held.sel({VARIANT: AS_IT_IS}, drop=True)
    change = held.transpose(VARIANT, ...).drop_sel({VARIANT: AS_IT_IS}) - base
    several = [SEED] if SEED in change.dims else []
    seeds = table.sizes.get(SEED, 1)
    if several and float((base.max(SEED) - base.min(SEED)).max()) == 0.0:
        seeds = 1  # what is rolled over was measured: nothing was drawn, and others tell nothing of chance
    effect = change.mean(several)
    level = base.mean(several)
    found = {
        schema.EFFECT: effect,
        schema.EFFECT_ERROR: student(change, CONFIDENCE)[0] if seeds > 1 else effect * np.nan,
        schema.LEFT_OUT: _left_out(table, effect),
    }
    told = xarray.Dataset(
        {entry.name: each.assign_attrs(_attributes(entry)) for entry, each in found.items()},
        attrs={schema.EFFECT_LAW.name: law, schema.EFFECT_SEEDS.name: seeds},
    )
    told[schema.EFFECT_LEVEL.name] = level.assign_attrs(_attributes(schema.EFFECT_LEVEL) | held.attrs)
    if held.name == usual == schema.RADIATED_POWER_LEVEL_A.name:
        by_chance = table[schema.RADIATED_POWER_DEVIATION.name].sel(
            {VARIANT: AS_IT_IS, "law": law}, drop=True
        )
        mean = ((by_chance**2).mean(several) / seeds) ** 0.5
        told[schema.EFFECT_LEVEL_DEVIATION.name] = mean.assign_attrs(
            _attributes(schema.EFFECT_LEVEL_DEVIATION)
        )
    return told.isel({VARIANT: _order(effect, json.loads(table.attrs["sweep"]))})


def _attributes(entry: Entry) -> dict[str, str]:
    held = {"units": entry.units, "long_name": entry.long_name}
    return held | {"missing": entry.missing} if entry.missing else held


def _left_out(table: xarray.Dataset, effect: xarray.DataArray) -> xarray.DataArray:
    """Why each variant has no effect; empty where it has one."""
    known = effect.notnull().any([dim for dim in effect.dims if dim != VARIANT]).values
    met = [(f"{m},", f["message"]) for f in json.loads(table.attrs["failures"]) for m in f["members"]]
    reasons = [
        "" if here else next((why for member, why in met if f"{VARIANT} = {name}," in member), "it failed")
        for name, here in zip(effect[VARIANT].values, known, strict=True)
    ]
    return xarray.DataArray(reasons, dims=VARIANT)


def _order(effect: xarray.DataArray, sweep: Collection[str]) -> Integers:
    """Places of the variants by what they do to the whole, of several parts; mean over other keys."""
    whole = effect
    for parts in (schema.EFFECT_RADIATOR.name, JUDGED):
        if parts in effect.coords:
            whole = whole.sel({parts: "total"})
    whole = whole.isel({dim: -1 for dim in whole.dims if dim not in sweep})
    return np.argsort(whole.mean([dim for dim in whole.dims if dim != VARIANT]).values, kind="stable")
