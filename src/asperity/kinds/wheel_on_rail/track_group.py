"""The group of a result that shows the track: receptances, decay rates, the moving kernel."""

from __future__ import annotations

import numpy as np
import xarray
from numpy.typing import NDArray

from asperity.kinds.wheel_on_rail import schema
from asperity.kinds.wheel_on_rail.compute import Computed
from asperity.kinds.wheel_on_rail.losses import error_of_losses, relaxed
from asperity.reference.decay_rate_limit import iso_3095_decay_rate
from asperity.scenarios.laws import working_point
from asperity.schema import Attribute, Entry, attributes, variables
from asperity.structures.decay_rate import decay_rate, decay_rate_en15461
from asperity.structures.rail_poles import RailPoles

LOWEST_FREQUENCY = 20.0
FREQUENCIES = 600
KERNEL_STARTS = 6
KERNEL_LAG = 0.25
"""Longest lag of the moving kernel that is kept in a result, s."""


def track_group(computed: Computed) -> xarray.Dataset:
    """Lay out what the wheel rolls on: receptances, decay rates, moving kernel, loss factors and numbers.

    None of it depends on what has rolled.
    """
    track, case = computed.track, computed.case
    frequency = np.geomspace(LOWEST_FREQUENCY, case.numerics.highest_frequency, FREQUENCIES)
    half = 0.5 * track.sleeper_spacing
    midspan, support = track.receptance(frequency, [half, 0.0], [half, 0.0])
    _, stiffness = working_point(case.contact, computed.chain.shape, computed.chain.reduction)

    found = {
        schema.TRACK_FREQUENCY: frequency,
        schema.RECEPTANCE_MIDSPAN: np.abs(midspan),
        schema.RECEPTANCE_MIDSPAN_PHASE: np.angle(midspan),
        schema.RECEPTANCE_SUPPORT: np.abs(support),
        schema.RECEPTANCE_SUPPORT_PHASE: np.angle(support),
        schema.WHEEL_RECEPTANCE: np.abs(computed.wheel.receptance(frequency)),
        schema.CONTACT_RECEPTANCE: np.full(FREQUENCIES, 1.0 / stiffness),
        schema.DECAY_RATE: decay_rate(track, frequency),
        schema.DECAY_RATE_EN15461: decay_rate_en15461(track, frequency),
        schema.DECAY_RATE_LIMIT: iso_3095_decay_rate(frequency),
    }
    found |= _kernel(computed) | relaxed(error_of_losses(computed))
    return xarray.Dataset(variables(found), attrs=attributes(_facts(computed)))


def _kernel(computed: Computed) -> dict[Entry, NDArray[np.float64]]:
    kernel = computed.kernel
    positions, taps = kernel.weights.shape
    rows = np.arange(0, positions, max(1, positions // KERNEL_STARTS))
    kept = slice(0, min(taps, round(KERNEL_LAG / kernel.time_step)))
    responses = kernel.weights[rows, kept] / kernel.time_step
    starts = rows * computed.track.sleeper_spacing / positions
    return {
        schema.START_POSITION: starts,
        schema.LAG: kernel.lag[kept],
        schema.MOVING_KERNEL: responses,
    }


def _facts(computed: Computed) -> dict[Attribute, float | int | str]:
    track, load, rail = computed.track, computed.case.wheel.load, computed.rail
    half = 0.5 * track.sleeper_spacing
    facts: dict[Attribute, float | int | str] = {
        schema.NAME: track.name,
        schema.SLEEPER_SPACING: track.sleeper_spacing,
        schema.PINNED_PINNED_FREQUENCY: track.pinned_pinned_frequency,
        schema.CUT_ON_FREQUENCY: track.cut_on_frequency,
        schema.ANTIRESONANCE_FREQUENCY: track.antiresonance_frequency,
        schema.CRITICAL_SPEED: track.critical_speed,
        schema.STATIC_DEFLECTION: track.static_deflection(load, half),
        schema.STATIC_DEFLECTION_IN_TIME: computed.kernel.track.static_deflection(load, half),
        schema.KERNEL_METHOD: "poles" if isinstance(rail, RailPoles) else "scatter",
    }
    if isinstance(rail, RailPoles):
        facts |= {schema.KERNEL_FIT_ERROR: rail.fit_error, schema.KERNEL_POLES: rail.count}
    return facts
