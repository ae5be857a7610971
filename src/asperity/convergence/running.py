"""A run again with each setting made finer: what is kept is taken, the rest is computed."""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from xarray import DataTree

from asperity import __version__
from asperity.case.content import content, file_digest
from asperity.case.scene import Case
from asperity.convergence.group import NOT_CONVERGED, Comparison, Levels, convergence_group, halves
from asperity.errors import AsperityError, CaseError, InputError, PhysicsWarning
from asperity.progress import COMPILED, Progress
from asperity.scenarios.geometry import window_cells
from asperity.scenarios.preparing import PreparedCase, prepare
from asperity.scenarios.refining import Setting, Way, restricted, shared_settings
from asperity.scenes.plan import own_settings
from asperity.scenes.result import computed_result
from asperity.schema import contact, convergence, provenance
from asperity.store import Store, content_key
from asperity.threads import one_thread_in_linear_algebra

FORMAT = 1
"""Raise it when kept levels no longer mean what they meant."""


def with_convergence(prepared: PreparedCase, result: DataTree, progress: Progress) -> DataTree:
    """Compute a case again with each setting made finer, and add to its result what that changes.

    Parameters
    ----------
    prepared : PreparedCase
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
    with warnings.catch_warnings(), one_thread_in_linear_algebra():
        warnings.simplefilter("ignore", PhysicsWarning)  # those of the case itself were told
        states = result[contact.APPROACH.group].to_dataset()[contact.APPROACH.name].values
        settings = settings_for(prepared, states)
        found = []
        for number, setting in enumerate(settings):
            progress(number, len(settings), "convergence")
            found.append(_compared(prepared, result, setting, _named(setting, progress)))
        progress(len(settings), len(settings), "convergence")
    group = convergence_group(result, found)
    told = [str(result.attrs[provenance.VERDICT.name]), str(group.attrs[convergence.SENTENCE.name])]
    if told[1].startswith(NOT_CONVERGED):
        told.reverse()
    tree = DataTree(result.to_dataset(inherit=False), children=result.children)
    tree["convergence"] = DataTree(group)
    tree.attrs[provenance.VERDICT.name] = " ".join(told)
    return tree


def settings_for(prepared: PreparedCase, states: np.ndarray) -> list[Setting]:
    """All settings of a case; its states (k,), m."""
    first, last = shared_settings(prepared.case, prepared.textures, states)
    return [*first, *own_settings(prepared.case), *last]


def unchangeable(prepared: PreparedCase, states: np.ndarray) -> dict[str, str]:
    """Why each setting that is to be computed anew cannot be changed; empty of those that can.

    States of the case (k,), m.
    """
    found: dict[str, str] = {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PhysicsWarning)
        for setting in settings_for(prepared, states):
            if setting.name != convergence.PATH_LENGTH:
                found[setting.name] = _refusal(prepared, setting)
    return found


def _refusal(prepared: PreparedCase, setting: Setting) -> str:
    """Why no way of changing a setting can be computed; empty where one can."""
    reason = setting.limit
    for way in setting.ways:
        try:
            changed_case(prepared, way)
        except InputError as error:
            reason = reason or brief(error)
            continue
        return ""
    return reason


def _named(setting: Setting, progress: Progress) -> Progress:
    """Say for which setting a piece of work is done."""

    def told(done: int, total: int, message: str) -> None:
        if message != COMPILED:  # long since
            progress(done, total, f"{setting.name}: {message}")

    return told


def _compared(prepared: PreparedCase, result: DataTree, setting: Setting, progress: Progress) -> Comparison:
    """Take the first way of changing a setting that can be computed."""
    base = Levels.of_result(result)
    if setting.name == convergence.PATH_LENGTH:
        whole, half = halves(result, prepared.case.time_step, prepared.case.numerics.highest_frequency)
        return Comparison(setting.name, setting.ways[0].words, "", half.over(whole, base.band))
    limit = setting.limit
    for way in setting.ways:
        try:
            finer, coarser = _both(prepared, base, setting, way, progress)
        except AsperityError as error:
            limit = limit or brief(error)
            continue
        return Comparison(setting.name, way.words, "", finer.over(coarser, base.band))
    return Comparison(setting.name, "", limit, base.nothing)


def _both(
    prepared: PreparedCase, base: Levels, setting: Setting, way: Way, progress: Progress
) -> tuple[Levels, Levels]:
    """Levels of the finer and of the coarser computation; `base` are those of the case."""
    changed = changed_case(prepared, way)
    if not setting.laid_anew:
        return _levels(changed.case, "", lambda: changed, progress), base
    small, large = (changed, prepared) if way.coarser else (prepared, changed)
    textures_of = json.dumps(content(large.case, file_digest), sort_keys=True)
    twin = _levels(small.case, textures_of, lambda: on_the_surface_of(small, large), progress)
    if way.coarser:
        return base, twin
    return _levels(changed.case, "", lambda: changed, progress), twin


def changed_case(prepared: PreparedCase, way: Way) -> PreparedCase:
    """The case with a setting changed."""
    return prepare(prepared.case.with_(**way.changes))


def on_the_surface_of(small: PreparedCase, large: PreparedCase) -> PreparedCase:
    """A case on the textures of a finer or wider one, restricted to its own grid and window."""
    spacing = large.case.contact.spacing
    every = round(small.case.contact.spacing / spacing)
    lines = window_cells(small.case.contact)
    return replace(small, textures=restricted(large.textures, spacing, every, lines))


def _levels(case: Case, textures_of: str, make: Callable[[], PreparedCase], progress: Progress) -> Levels:
    """Levels of a run, kept by all that they depend on."""
    store = Store()
    told = json.dumps(content(case, file_digest), sort_keys=True)
    key = content_key("convergence", FORMAT, __version__, told, textures_of)
    found = store.get(key)
    if found is not None:
        return Levels.unpacked(found)
    prepared = make()
    levels = Levels.of_result(computed_result(prepared, progress, []))
    store.put(key, levels.packed())
    return levels


def brief(error: AsperityError) -> str:
    """Why a setting was not changed, in a line."""
    if isinstance(error, CaseError):
        return error.errors[0]
    if isinstance(error, InputError):
        return f"{error.what}: received {error.received}; allowed: {error.allowed}"
    return str(error)
