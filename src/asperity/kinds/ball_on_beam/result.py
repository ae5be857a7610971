"""The result of a ball-on-beam case, laid out as labelled groups."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from functools import partial

import xarray

from asperity.kinds.ball_on_beam import schema
from asperity.kinds.ball_on_beam.bodies import Bodies, ball_transfer, square_transfer
from asperity.kinds.ball_on_beam.compute import Computed
from asperity.scenarios.contact_group import contact_group
from asperity.scenarios.surface_group import surface_group
from asperity.scenarios.tree import (
    assembled,
    drawn,
    force_spectra,
    rolling_group,
    spectrum_segment,
)
from asperity.scenarios.validity import choice_of, findings, verdict, warn_of_findings
from asperity.schema import variables
from asperity.spectra import band_levels, psd


def layout(
    computed: Computed, caught: list[warnings.WarningMessage], *, brief: bool = False
) -> xarray.DataTree:
    """Lay out what was computed, as scenario, surface, contact, rolling and spectra.

    With units and provenance. `caught` are the warnings met on the way; those of laying out may still be
    added to it. In brief without what only a report shows: what the path is like, and the choice of a law
    where nothing depends on it.
    """
    over_frequency = _spectra(computed)
    transfer = partial(square_transfer, Bodies(computed.ball, computed.beam))
    choice = choice_of(computed.chain, transfer, brief=brief)
    found = findings(computed.chain, choice)
    warn_of_findings(found)
    groups = {
        "/surface": surface_group(computed.chain, brief=brief),
        "/contact": contact_group(computed.chain, found),
        "/rolling": _rolling(computed),
        "/spectra": over_frequency,
    }
    return assembled(
        computed.chain,
        groups,
        caught,
        title=_title(computed.case.ball.material.name, computed.case.beam.material.name),
        verdict=verdict(computed.chain, over_frequency, found, "ball", choice=choice),
        numerics=_numerics(computed),
        choice=choice,
    )


def _title(ball: str, beam: str) -> str:
    article = "an" if beam[0].lower() in "aeiou8" else "a"
    return f"{ball[0].upper()}{ball[1:]} ball on {article} {beam} beam"


def _numerics(computed: Computed) -> Iterable[tuple[str, str]]:
    yield "beam modes", f"{len(computed.beam.natural_frequencies)}"
    for name, run in computed.chain.runs.items():
        yield f"energy residual, {name}", f"{run.energy.residual:.1e}"


def _rolling(computed: Computed) -> xarray.Dataset:
    runs, stack = list(computed.chain.runs.values()), computed.chain.stacked
    terms = list(runs[0].energy.shares())
    return rolling_group(
        computed.chain,
        {
            schema.ROLLING_SENSOR: computed.case.beam.sensor_positions,
            schema.ACCELERATION: stack("acceleration"),
            schema.BALL_DISPLACEMENT: stack("rolling_displacement"),
            schema.BEAM_DISPLACEMENT: stack("over_displacement"),
            schema.ENERGY_TERM: terms,
            schema.ENERGY: [[run.energy.shares()[t] for t in terms] for run in runs],
            schema.ENERGY_RESIDUAL: [run.energy.residual for run in runs],
        },
    )


def _spectra(computed: Computed) -> xarray.Dataset:
    case, acceleration = computed.case, computed.chain.stacked("acceleration")
    highest = case.numerics.highest_frequency
    segment = spectrum_segment(acceleration.shape[-1], case.time_step)
    frequency, density = psd(acceleration, case.time_step, segment=segment)
    _, level = band_levels(frequency, density, schema.ACCELERATION_REFERENCE, high=highest)
    own = variables(
        {
            schema.SPECTRA_SENSOR: case.beam.sensor_positions,
            schema.ACCELERATION_PSD: density[..., drawn(frequency, highest)],
            schema.ACCELERATION_LEVEL: level,
        }
    )
    transfer = partial(ball_transfer, Bodies(computed.ball, computed.beam))
    return xarray.Dataset(force_spectra(computed.chain, transfer) | own)
