"""The result of a ball-on-beam case, laid out as labelled groups."""

from __future__ import annotations

import warnings
from collections.abc import Iterable

import xarray

from asperity.kinds.ball_on_beam import schema
from asperity.kinds.ball_on_beam.compute import Computed
from asperity.scenarios.contact_group import contact_group
from asperity.scenarios.surface_group import surface_group
from asperity.scenarios.tree import (
    assembled,
    level_differences,
    product_of_bands,
    rolling_group,
    spectrum_segment,
)
from asperity.scenarios.validity import findings, warn_of_findings
from asperity.scenarios.verdict import verdict
from asperity.schema import spectra, variables
from asperity.spectra import averaging_time, band_levels, psd


def layout(computed: Computed, caught: list[warnings.WarningMessage]) -> xarray.DataTree:
    """Lay out what was computed, as scenario, surface, contact, rolling and spectra.

    With units and provenance. `caught` are the warnings met on the way; those of laying out may still be
    added to it.
    """
    over_frequency = _spectra(computed)
    found = findings(computed.chain)
    warn_of_findings(found)
    groups = {
        "/surface": surface_group(computed.chain),
        "/contact": contact_group(computed.chain, found),
        "/rolling": _rolling(computed),
        "/spectra": over_frequency,
    }
    return assembled(
        computed.chain,
        groups,
        caught,
        title=_title(computed.case.ball.material.name, computed.case.beam.material.name),
        verdict=verdict(computed.chain, over_frequency, found, "ball"),
        numerics=_numerics(computed),
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
    terms = list(runs[0].energy.terms())
    return rolling_group(
        computed.chain,
        {
            schema.ROLLING_SENSOR: computed.case.beam.sensor_positions,
            schema.ACCELERATION: stack("acceleration"),
            schema.BALL_DISPLACEMENT: stack("ball_displacement"),
            schema.BEAM_DISPLACEMENT: stack("beam_displacement"),
            schema.ENERGY_TERM: terms,
            schema.ENERGY: [[run.energy.terms()[t] for t in terms] for run in runs],
            schema.ENERGY_RESIDUAL: [run.energy.residual for run in runs],
        },
    )


def _spectra(computed: Computed) -> xarray.Dataset:
    step, highest = computed.case.time_step, computed.case.numerics.highest_frequency
    laws, stack = list(computed.chain.runs), computed.chain.stacked
    samples = len(computed.chain.runs[laws[0]].time)
    segment = spectrum_segment(samples, step)
    time = averaging_time(samples, step, segment=segment)
    frequency, force = psd(stack("contact_force"), step, segment=segment)
    _, acceleration = psd(stack("acceleration"), step, segment=segment)
    band, force_level = band_levels(frequency, force, high=highest)
    _, acceleration_level = band_levels(frequency, acceleration, schema.ACCELERATION_REFERENCE, high=highest)
    shown = (frequency > 0.0) & (frequency <= 1.13 * highest)
    found = variables(
        {
            spectra.LAW: laws,
            schema.SPECTRA_SENSOR: computed.case.beam.sensor_positions,
            spectra.FREQUENCY: frequency[shown],
            spectra.BAND: band,
            spectra.BAND_TIME_PRODUCT: product_of_bands(spectra.BAND_TIME_PRODUCT, band, time),
            spectra.FORCE_PSD: force[:, shown],
            spectra.FORCE_LEVEL: force_level,
            schema.ACCELERATION_PSD: acceleration[..., shown],
            schema.ACCELERATION_LEVEL: acceleration_level,
        }
    )
    return xarray.Dataset(found | level_differences(laws, force_level))
