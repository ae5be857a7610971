"""The group of a result that shows the track: receptances, decay rates, the moving kernel."""

from __future__ import annotations

import numpy as np
import xarray
from numpy.typing import NDArray

from asperity.kinds.wheel_on_rail.compute import Computed
from asperity.kinds.wheel_on_rail.loss_factors import LossFactorError
from asperity.kinds.wheel_on_rail.losses import loss_variables
from asperity.reference.decay_rate_limit import iso_3095_decay_rate
from asperity.results import variable
from asperity.scenarios.laws import working_point
from asperity.structures.decay_rate import decay_rate, decay_rate_en15461
from asperity.structures.rail_poles import RailPoles

LOWEST_FREQUENCY = 20.0
FREQUENCIES = 600
KERNEL_STARTS = 6
KERNEL_LAG = 0.25
"""Longest lag of the moving kernel that is kept in a result, s."""


def track_group(computed: Computed, losses: LossFactorError) -> xarray.Dataset:
    """Lay out what the wheel rolls on.

    Parameters
    ----------
    computed : Computed
        What was computed.
    losses : LossFactorError
        How far the force is off for loss factors.

    Returns
    -------
    xarray.Dataset
        Receptances over frequency, decay rates, moving kernel, loss factors and characteristic numbers.
    """
    track, case = computed.track, computed.case
    frequency = np.geomspace(LOWEST_FREQUENCY, case.numerics.highest_frequency, FREQUENCIES)
    half = 0.5 * track.sleeper_spacing
    midspan, support = track.receptance(frequency, half, half), track.receptance(frequency, 0.0, 0.0)
    wheel = np.abs(computed.wheel.receptance(frequency))
    _, stiffness = working_point(case.contact, computed.chain.shape, computed.chain.reduction)

    def over(values: NDArray, units: str, name: str) -> xarray.Variable:
        return variable("frequency", values, units, name)

    variables = {
        "frequency": over(frequency, "Hz", "frequency"),
        "receptance_midspan": over(np.abs(midspan), "m/N", "receptance of the rail at mid-span"),
        "receptance_midspan_phase": over(np.angle(midspan), "rad", "its phase"),
        "receptance_support": over(np.abs(support), "m/N", "receptance of the rail over a sleeper"),
        "receptance_support_phase": over(np.angle(support), "rad", "its phase"),
        "wheel_receptance": over(wheel, "m/N", "receptance of the wheel"),
        "contact_receptance": over(
            np.full(FREQUENCIES, 1.0 / stiffness), "m/N", "receptance of the contact spring at the load"
        ),
        "decay_rate": over(decay_rate(track, frequency), "dB/m", "decay rate, eigenvalue"),
        "decay_rate_en15461": over(
            decay_rate_en15461(track, frequency), "dB/m", "decay rate as measured by EN 15461"
        ),
        "decay_rate_limit": over(iso_3095_decay_rate(frequency), "dB/m", "lower limit, ISO 3095:2013"),
    }
    variables |= _kernel(computed) | loss_variables(losses)
    return xarray.Dataset(variables, attrs=_attributes(computed))


def _kernel(computed: Computed) -> dict[str, xarray.Variable]:
    kernel = computed.kernel
    positions, taps = kernel.weights.shape
    rows = np.arange(0, positions, max(1, positions // KERNEL_STARTS))
    kept = slice(0, min(taps, round(KERNEL_LAG / kernel.time_step)))
    responses = kernel.weights[rows, kept] / kernel.time_step
    starts = rows * computed.track.sleeper_spacing / positions
    return {
        "start_position": variable("start_position", starts, "m", "place of the impulse, from a sleeper"),
        "lag": variable("lag", kernel.lag[kept], "s", "time since the impulse"),
        "moving_kernel": variable(
            ("start_position", "lag"), responses, "m/(N s)", "displacement of the rail under the wheel"
        ),
    }


def _attributes(computed: Computed) -> dict[str, float | int | str]:
    track, case = computed.track, computed.case
    attrs: dict[str, float | int | str] = {
        "name": track.name,
        "pinned_pinned_frequency": track.pinned_pinned_frequency,
        "cut_on_frequency": track.cut_on_frequency,
        "antiresonance_frequency": track.antiresonance_frequency,
        "critical_speed": track.critical_speed,
        "static_deflection": track.static_deflection(case.wheel.load, 0.5 * track.sleeper_spacing),
        "static_deflection_in_time": computed.kernel.track.static_deflection(
            case.wheel.load, 0.5 * track.sleeper_spacing
        ),
        "kernel_method": "poles" if isinstance(computed.rail, RailPoles) else "scatter",
    }
    if isinstance(computed.rail, RailPoles):
        attrs |= {"kernel_fit_error": computed.rail.fit_error, "kernel_poles": computed.rail.count}
    return attrs
