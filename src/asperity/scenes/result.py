"""The result of a case of any kind, laid out as labelled groups: each observer adds what it sees."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from asperity.reference.cnossos import CITATION
from asperity.scenarios import tree, validity
from asperity.scenarios.contact_group import contact_group
from asperity.scenarios.surface_group import surface_group
from asperity.scenes import schema
from asperity.scenes.cnossos_labels import findings_of_labels
from asperity.scenes.compute import Computed
from asperity.scenes.loss_factors import (
    described_losses,
    error_of_losses,
    findings_of_losses,
    warn_of_loss_factors,
)
from asperity.scenes.sound import pass_by_group, warn_of_silence
from asperity.scenes.track import track_facts, track_group, track_spectra
from asperity.schema import Entry, attributes, rolling, spectra, variables
from asperity.spectra import averaging_time, band_levels, psd
from asperity.structures.rail_poles import RailBetween, RailPoles
from asperity.structures.track import Track

USUAL = (schema.OVER_DISPLACEMENT, schema.ROLLING_DISPLACEMENT)
"""What displacements at a contact are called."""


def layout(
    computed: Computed, caught: list[warnings.WarningMessage], *, brief: bool = False
) -> xarray.DataTree:
    """Lay out what was computed: surface, contact, rolling and spectra; of a track itself and the pass-by.

    With units and provenance. `caught` are the warnings met on the way; those of laying out may still be
    added to it. In brief without what only a report shows: what the path is like, and the choice of a law
    where nothing depends on it.
    """
    chain, scene = computed.chain, computed.scene
    over_frequency = spectra_group(computed)
    choice = validity.choice_of(chain, scene, brief=brief)
    found, own, citations = validity.findings(chain, choice), dict[str, xarray.Dataset](), tuple[str, ...]()
    if isinstance(scene.over, Track):
        losses = error_of_losses(computed)
        found += findings_of_losses(losses)
        if schema.SOUND_POWER_LEVEL.name in over_frequency:
            found += findings_of_labels(computed.case)
        own = {"/track": track_group(computed), "/pass_by": pass_by_group(computed.case, over_frequency)}
        citations = (*scene.over.sources, CITATION)
        warn_of_silence(computed.case)
        warn_of_loss_factors(losses)
    validity.warn_of_findings(found)
    groups = {
        "/surface": surface_group(chain, brief=brief),
        "/contact": contact_group(chain, found),
        "/rolling": rolling_group(computed),
        "/spectra": over_frequency,
    }
    power = _sound_power(over_frequency)
    return tree.assembled(
        chain,
        groups | own,
        caught,
        title=scene.title,
        verdict=validity.verdict(chain, over_frequency, found, computed.kind.rolling, power, choice),
        numerics=_numerics(computed),
        citations=citations,
        choice=choice,
    )


def _sound_power(over_frequency: xarray.Dataset) -> xarray.DataArray | None:
    level = over_frequency.get(schema.SOUND_POWER_LEVEL_A.name)
    return None if level is None else level.sel(source="total")


def _numerics(computed: Computed) -> Iterable[tuple[str, str]]:
    over = computed.over
    if len(computed.scene.offsets) > 1:
        yield "contacts", f"{len(computed.scene.offsets)}"
    if isinstance(over, RailBetween):
        weights, lag = computed.kernel.weights, computed.kernel.lag
        yield "start positions of the moving kernel", f"{weights.shape[0]} in a bay"
        yield "length of the moving kernel", f"{lag[-1]:.3g} s, {weights.shape[1]} steps"
        if isinstance(over.direct, RailPoles):
            yield "track in time", f"{over.direct.count} poles"
            yield "error of the fitted poles, relative", f"{over.direct.fit_error:.1e}"
        else:
            yield "track in time", "scattered from the moving kernel"
        yield from described_losses(error_of_losses(computed), computed.chain.shape.load)
    elif over is not None:
        yield "modes of what is rolled over", f"{len(over.natural_frequencies)}"
    for name, run in computed.chain.runs.items():
        yield f"energy residual, {name}", f"{run.energy.residual:.1e}"


def rolling_group(computed: Computed) -> xarray.Dataset:
    """Lay out what was recorded in time: each contact, what it is over, each body, energy."""
    scene, stack = computed.scene, computed.chain.stacked
    runs = list(computed.chain.runs.values())
    terms = list(runs[0].energy.shares)
    losses = [run.contact_loss for run in runs]
    over, rolls = scene.displacements or USUAL
    laid_out: dict[Entry, Any] = {
        rolling.LAW: list(computed.chain.runs),
        rolling.TIME: runs[0].time,
        rolling.POSITION: runs[0].positions[0],
        rolling.CONTACT: 1 + np.arange(len(scene.offsets)),
        rolling.OFFSET: scene.offsets,
        rolling.STATIC_LOAD: scene.loads,
        rolling.CONTACT_FORCE: stack("contact_force"),
        rolling.RELATIVE_DISPLACEMENT: stack("relative_displacement"),
        over: stack("over_displacement"),
        rolls: stack("rolling_displacement"),
        rolling.CONTACT_LOSS_SHARE: 1.0 - stack("in_contact").mean(axis=-1),
        rolling.CONTACT_LOSS_EVENTS: [[len(flights) for flights in run] for run in losses],
        rolling.LONGEST_LOSS: [
            [max((flight.duration for flight in flights), default=0.0) for flights in run] for run in losses
        ],
        schema.ROLLING_DEGREE: list(scene.levers),
        schema.BODY_DISPLACEMENT: _motion(computed),
        schema.ENERGY_TERM: terms,
        schema.ENERGY: [[run.energy.shares[term] for term in terms] for run in runs],
        schema.ENERGY_RESIDUAL: [run.energy.residual for run in runs],
    }
    if scene.sensors:
        laid_out |= {schema.ROLLING_SENSOR: scene.sensors, schema.ACCELERATION: stack("acceleration")}
    if scene.points:
        moved, velocity = computed.points
        laid_out |= {schema.ROLLING_POINT: scene.points}
        laid_out |= {schema.POINT_DISPLACEMENT: moved, schema.POINT_VELOCITY: velocity}
    return xarray.Dataset(variables(laid_out), attrs=attributes({rolling.SPEED: computed.case.speed}))


def _motion(computed: Computed) -> NDArray[np.float64]:
    """Degrees of freedom of all bodies (laws, d, n), positive downwards, m."""
    levers = np.array(list(computed.scene.levers.values()))[:, None]
    runs = computed.chain.runs.values()
    return np.stack([-levers * np.concatenate(run.degrees_of_freedom) for run in runs])


def spectra_group(computed: Computed) -> xarray.Dataset:
    """Lay out PSDs and one-third octaves of force and motion, and what follows from them for sound.

    With how sure the levels are, and how far the laws are from each other.
    """
    chain, scene, case = computed.chain, computed.scene, computed.case
    forces, step, highest = chain.stacked("contact_force"), case.time_step, highest_of(computed)
    segment = tree.spectrum_segment(forces.shape[-1], step)
    frequency, of_contacts = psd(forces, step, segment=segment)
    density, shown = of_contacts.mean(axis=1), tree.drawn(frequency, highest)
    band, level = band_levels(frequency, density, high=highest)
    levels = band_levels(frequency, of_contacts, high=highest)[1]
    laid_out: dict[Entry, Any] = {
        spectra.LAW: list(chain.runs),
        spectra.FREQUENCY: frequency[shown],
        spectra.BAND: band,
        spectra.CONTACT: 1 + np.arange(forces.shape[1]),
        spectra.FORCE_PSD: density[..., shown],
        spectra.FORCE_LEVEL: level,
        spectra.CONTACT_FORCE_PSD: of_contacts[..., shown],
        spectra.CONTACT_FORCE_LEVEL: levels,
        **tree.sureness(chain, band, averaging_time(forces.shape[-1], step, segment=segment), scene.transfer),
        **tree.level_differences(list(chain.runs), level),
        **_bodies(computed, frequency, segment),
    }
    if forces.shape[1] > 1:
        laid_out[schema.SUM_PSD] = psd(forces.sum(axis=1), step, segment=segment)[1][..., shown]
        tones = passing_frequencies(scene.offsets, case.speed, highest)
        laid_out |= {schema.PASSING_FREQUENCY: tones} if tones.size else {}
    if scene.sensors:
        laid_out |= _accelerations(computed, segment)
    facts = {}
    if isinstance(scene.over, Track):
        laid_out |= track_spectra(computed, frequency, of_contacts, band, levels)
        facts = attributes(track_facts(computed))
    return xarray.Dataset(variables(laid_out), attrs=facts)


def highest_of(computed: Computed) -> float:
    """Highest frequency of the spectra, Hz."""
    return computed.case.numerics.highest_frequency


def _bodies(computed: Computed, frequency: NDArray[np.float64], segment: int) -> Mapping[Entry, Any]:
    """Acceleration of the bodies in their degrees of freedom, from second differences of their motion."""
    step = computed.case.time_step
    curvature = np.pad(np.diff(_motion(computed), 2) / step**2, ((0, 0), (0, 0), (1, 1)), mode="edge")
    _, curved = psd(curvature, step, segment=segment)
    half = np.pi * frequency * step
    to_acceleration = (half / np.sin(np.maximum(half, 1e-12))) ** 4
    density = (curved * to_acceleration)[..., tree.drawn(frequency, highest_of(computed))]
    return {schema.SPECTRA_DEGREE: list(computed.scene.levers), schema.BODY_ACCELERATION_PSD: density}


def _accelerations(computed: Computed, segment: int) -> Mapping[Entry, Any]:
    highest, motion = highest_of(computed), computed.chain.stacked("acceleration")
    frequency, density = psd(motion, computed.case.time_step, segment=segment)
    _, level = band_levels(frequency, density, schema.ACCELERATION_REFERENCE, high=highest)
    return {
        schema.SPECTRA_SENSOR: computed.scene.sensors,
        schema.ACCELERATION_PSD: density[..., tree.drawn(frequency, highest)],
        schema.ACCELERATION_LEVEL: level,
    }


EQUAL = 1e-6
"""Relative difference of distances that are equal."""


def passing_frequencies(offsets: Iterable[float], speed: float, highest: float) -> NDArray[np.float64]:
    """Multiples k v/L, Hz, of the frequency at which contacts at an equal distance L pass a place.

    Offsets in m, speed in m/s, up to the highest frequency, Hz; none where distances differ.
    """
    gaps = np.diff(np.sort(np.fromiter(offsets, dtype=float)))
    if not gaps.size or np.ptp(gaps) > EQUAL * gaps.mean():
        return np.zeros(0)
    first = speed / gaps.mean()
    return np.asarray(first * np.arange(1, int(highest / first) + 1))
