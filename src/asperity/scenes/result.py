"""The result of a case of any kind, laid out as labelled groups: each observer adds what it sees."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from asperity.reference.cnossos import CITATION
from asperity.scenarios.contact_group import contact_group
from asperity.scenarios.surface_group import surface_group
from asperity.scenarios.tree import assembled, drawn, force_spectra, rolling_group, spectrum_segment
from asperity.scenarios.validity import choice_of, findings, verdict, warn_of_findings
from asperity.scenes import schema
from asperity.scenes.cnossos_labels import findings_of_labels
from asperity.scenes.compute import Computed
from asperity.scenes.contacts import contacts_in_time, contacts_over_frequency, lost_contacts
from asperity.scenes.loss_factors import (
    described_losses,
    error_of_losses,
    findings_of_losses,
    warn_of_loss_factors,
)
from asperity.scenes.sound import pass_by_group, warn_of_silence
from asperity.scenes.track import track_facts, track_group, track_spectra
from asperity.schema import Entry, attributes, variables
from asperity.spectra import band_levels, psd
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
    spectra = spectra_group(computed)
    choice = choice_of(chain, scene, brief=brief)
    found, own, citations = findings(chain, choice), dict[str, xarray.Dataset](), tuple[str, ...]()
    if isinstance(scene.over, Track):
        losses = error_of_losses(computed)
        found += findings_of_losses(losses)
        if schema.SOUND_POWER_LEVEL.name in spectra:
            found += findings_of_labels(computed.case)
        own = {"/track": track_group(computed), "/pass_by": pass_by_group(computed.case, spectra)}
        citations = (*scene.over.sources, CITATION)
        warn_of_silence(computed.case)
        warn_of_loss_factors(losses)
    warn_of_findings(found)
    groups = {
        "/surface": surface_group(chain, brief=brief),
        "/contact": contact_group(chain, found),
        "/rolling": rolling_group(chain, _rolling(computed)),
        "/spectra": spectra,
    }
    several = len(scene.offsets) > 1
    rolls = "first contact" if several else computed.kind.rolling
    told = verdict(chain, spectra, found, rolls, _sound_power(spectra), choice) + lost_contacts(computed)
    return assembled(
        chain,
        groups | own,
        caught,
        title=scene.title,
        verdict=told,
        numerics=_numerics(computed),
        citations=citations,
        choice=choice,
    )


def _sound_power(spectra: xarray.Dataset) -> xarray.DataArray | None:
    level = spectra.get(schema.SOUND_POWER_LEVEL_A.name)
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


def _rolling(computed: Computed) -> dict[Entry, Any]:
    scene, runs, stack = computed.scene, list(computed.chain.runs.values()), computed.chain.stacked
    terms = list(runs[0].energy.shares())
    found: dict[Entry, Any] = {
        schema.ENERGY_TERM: terms,
        schema.ENERGY: [[run.energy.shares()[term] for term in terms] for run in runs],
        schema.ENERGY_RESIDUAL: [run.energy.residual for run in runs],
    }
    displacements = zip(scene.displacements or USUAL, ("over", "rolling"), strict=True)
    if scene.degrees:
        found |= contacts_in_time(computed)
    else:
        found |= {entry: stack(f"{side}_displacement") for entry, side in displacements}
    if scene.sensors:
        found |= {schema.ROLLING_SENSOR: scene.sensors, schema.ACCELERATION: stack("acceleration")}
    if scene.points:
        moved, velocity = computed.points
        found |= {
            schema.ROLLING_POINT: scene.points,
            schema.POINT_DISPLACEMENT: moved,
            schema.POINT_VELOCITY: velocity,
        }
    return found


def spectra_group(computed: Computed) -> xarray.Dataset:
    """Lay out PSDs and one-third octaves of force and motion, and what follows from them for sound."""
    chain, scene, case = computed.chain, computed.scene, computed.case
    forces, step, highest = computed.of_contacts("contact_force"), case.time_step, highest_of(computed)
    segment = spectrum_segment(forces.shape[-1], step)
    frequency, density = psd(forces, step, segment=segment)
    band, level = band_levels(frequency, density, high=highest)
    own: dict[Entry, Any] = {}
    if scene.degrees:
        own |= contacts_over_frequency(computed, frequency, density, level)
    if scene.sensors:
        own |= _accelerations(computed, segment)
    facts = {}
    if isinstance(scene.over, Track):
        own |= track_spectra(computed, frequency, density, band, level)
        facts = attributes(track_facts(computed))
    return xarray.Dataset(force_spectra(chain, scene.transfer) | variables(own), attrs=facts)


def highest_of(computed: Computed) -> float:
    """Highest frequency of the spectra, Hz."""
    return computed.case.numerics.highest_frequency


def _accelerations(computed: Computed, segment: int) -> dict[Entry, NDArray[np.float64]]:
    highest, motion = highest_of(computed), computed.chain.stacked("acceleration")
    frequency, density = psd(motion, computed.case.time_step, segment=segment)
    return {
        schema.SPECTRA_SENSOR: np.asarray(computed.scene.sensors),
        schema.ACCELERATION_PSD: density[..., drawn(frequency, highest)],
        schema.ACCELERATION_LEVEL: band_levels(
            frequency, density, schema.ACCELERATION_REFERENCE, high=highest
        )[1],
    }
