"""The result of a ball-on-beam case, laid out as labelled groups."""

from __future__ import annotations

import warnings
from collections.abc import Iterable

import numpy as np
import xarray

from asperity.kinds.ball_on_beam.compute import Computed
from asperity.results import variable
from asperity.scenarios.contact_group import contact_group
from asperity.scenarios.surface_group import surface_group
from asperity.scenarios.tree import (
    assembled,
    law_coordinate,
    level_differences,
    loss_variables,
    product_variable,
    spectrum_segment,
)
from asperity.scenarios.validity import findings, warn_of
from asperity.scenarios.verdict import verdict
from asperity.spectra import averaging_time, band_levels, psd

ACCELERATION_REFERENCE = 1e-6


def layout(computed: Computed, caught: list[warnings.WarningMessage]) -> xarray.DataTree:
    """Lay out what was computed, with units and provenance.

    Parameters
    ----------
    computed : Computed
        Textures, reduction and runs.
    caught : list of WarningMessage
        Warnings met on the way; those of laying out may still be added to it.

    Returns
    -------
    xarray.DataTree
        Groups scenario, surface, contact, rolling, spectra.
    """
    spectra = _spectra(computed)
    found = findings(computed.chain)
    warn_of(found)
    groups = {
        "/surface": surface_group(computed.chain),
        "/contact": contact_group(computed.chain, found),
        "/rolling": _rolling(computed),
        "/spectra": spectra,
    }
    return assembled(
        computed.chain,
        groups,
        caught,
        title=_title(computed.case.ball.material.name, computed.case.beam.material.name),
        verdict=verdict(computed.chain, spectra, found, "ball"),
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
    sensors = np.array(computed.case.beam.sensor_positions)
    terms = list(runs[0].energy.terms())
    energy = np.array([[run.energy.terms()[t] for t in terms] for run in runs])
    return xarray.Dataset(
        {
            "law": law_coordinate(computed.chain),
            "sensor": variable("sensor", sensors, "m", "position of the accelerometer on the beam"),
            "time": variable("time", runs[0].time, "s", "time since the run-in"),
            "position": variable("time", runs[0].position, "m", "position of the contact on the beam"),
            "contact_force": variable(("law", "time"), stack("contact_force"), "N", "contact force"),
            "relative_displacement": variable(
                ("law", "time"),
                stack("relative_displacement"),
                "m",
                "approach of the mean surfaces, positive closing",
            ),
            "acceleration": variable(
                ("law", "sensor", "time"),
                stack("acceleration"),
                "m/s2",
                "acceleration of the beam, positive downwards",
            ),
            "ball_displacement": variable(
                ("law", "time"),
                stack("ball_displacement"),
                "m",
                "displacement of the ball, positive downwards",
            ),
            "beam_displacement": variable(
                ("law", "time"),
                stack("beam_displacement"),
                "m",
                "displacement of the beam under the ball, positive downwards",
            ),
            "energy_term": variable("energy_term", np.array(terms), "1", "term of the energy balance"),
            "energy": variable(("law", "energy_term"), energy, "J", "energy since the start of the run-in"),
            "energy_residual": variable(
                "law",
                np.array([run.energy.residual for run in runs]),
                "1",
                "what the energy balance leaves open, relative to the throughput",
            ),
        }
        | loss_variables(computed.chain)
    )


def _spectra(computed: Computed) -> xarray.Dataset:
    step, highest = computed.case.time_step, computed.case.numerics.highest_frequency
    laws, stack = list(computed.chain.runs), computed.chain.stacked
    samples = len(computed.chain.runs[laws[0]].time)
    segment = spectrum_segment(samples, step)
    frequency, force = psd(stack("contact_force"), step, segment=segment)
    _, acceleration = psd(stack("acceleration"), step, segment=segment)
    band, force_level = band_levels(frequency, force, high=highest)
    _, acceleration_level = band_levels(frequency, acceleration, ACCELERATION_REFERENCE, high=highest)
    shown = (frequency > 0.0) & (frequency <= 1.13 * highest)
    by_law, by_sensor = ("law", "frequency"), ("law", "sensor", "frequency")
    variables = {
        "law": law_coordinate(computed.chain),
        "sensor": variable(
            "sensor", np.array(computed.case.beam.sensor_positions), "m", "position of the accelerometer"
        ),
        "frequency": variable("frequency", frequency[shown], "Hz", "frequency"),
        "band": variable("band", band, "Hz", "one-third-octave band centre"),
        "band_time_product": product_variable("band", band, averaging_time(samples, step, segment=segment)),
        "force_psd": variable(by_law, force[:, shown], "N2/Hz", "PSD of the contact force, one-sided"),
        "force_level": variable(("law", "band"), force_level, "dB re 1 N", "contact force level"),
        "acceleration_psd": variable(
            by_sensor, acceleration[..., shown], "(m/s2)2/Hz", "PSD of the beam acceleration, one-sided"
        ),
        "acceleration_level": variable(
            ("law", "sensor", "band"), acceleration_level, "dB re 1e-6 m/s2", "acceleration level"
        ),
    }
    return xarray.Dataset(variables | level_differences(laws, force_level))
