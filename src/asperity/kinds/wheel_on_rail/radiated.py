"""Sound power of a run from its vibration: of the rail, the sleepers and the wheel."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.errors import Grade, MissingSourceWarning
from asperity.kinds.wheel_on_rail import schema
from asperity.kinds.wheel_on_rail.case import WheelOnRail
from asperity.kinds.wheel_on_rail.compute import Computed
from asperity.kinds.wheel_on_rail.linear_reference import force_transfer
from asperity.kinds.wheel_on_rail.tables import read_mode_shapes, read_ratios
from asperity.radiation.modal_velocity import modal_velocity_psd
from asperity.radiation.rail import STEEL_DENSITY, RailSection
from asperity.radiation.sleeper import SleeperTop
from asperity.radiation.wheel import RadiatingWheel
from asperity.scenarios.laws import working_point
from asperity.schema import Entry
from asperity.spectra import HALF_BAND, a_weighted_total, band_energies, psd
from asperity.structures.decay_rate import decay_rate
from asperity.structures.track import Track

RADIATORS = ("rail", "sleepers", "wheel", "total")
PICOWATT = 1e-12
"""Of sound power levels, W."""


@dataclass(frozen=True, eq=False)
class RadiatedPower:
    """Sound power of one wheel, of the rail under it and of the half sleepers under that.

    Of an axle it is twice as much. The total holds what is known: without a wheel that says how its modes
    move it, rail and sleepers.
    """

    band: NDArray[np.float64]  # (b,), exact centres of the one-third octaves, Hz
    power: NDArray[np.float64]  # (laws, 4, b), of the `RADIATORS`, W; NaN where unknown
    decay_rate: NDArray[np.float64]  # (b,), of the rail's vibration, dB/m
    silent_wheel: str  # why the wheel's part is missing; empty where it is there


def rail_section(case: WheelOnRail, track: Track) -> RailSection:
    """Section of the rail of a case: its widths, and the area that its mass makes of steel."""
    noise = case.noise
    table = None if noise.rail_radiation is None else read_ratios(noise.rail_radiation)
    area = track.mass_per_length / STEEL_DENSITY
    return RailSection(noise.rail_foot_width, noise.rail_head_width, area, table)


def radiating_wheel(case: WheelOnRail) -> RadiatingWheel | None:
    """Wheel of a case as a radiator of its rigid motion, first, and of its modes; None if they are unknown.

    A rigid wheel that moves up and down has one nodal diameter around its tread.
    """
    shapes = None if case.wheel.modes is None else read_mode_shapes(case.wheel.modes)
    if shapes is None:
        return None
    diameters, axial, radial = np.vstack([[1.0, 0.0, math.sqrt(0.5)], shapes]).T
    return RadiatingWheel(case.wheel.radius, case.noise.wheel_width, diameters.astype(int), axial, radial)


def silent_wheel(case: WheelOnRail) -> str:
    """Say why the sound of a wheel is not computed; nothing where it is."""
    if case.wheel.modes is None:
        if case.wheel.receptance is None:
            return "the wheel is rigid"
        return "the wheel's receptance does not say how its disc and tread move"
    if radiating_wheel(case) is None:
        return "the table wheel.modes does not say how the modes move disc and tread"
    return ""


def warn_of_silence(case: WheelOnRail) -> None:
    """Note that the sound power from vibration lacks the wheel's part, where it does."""
    if reason := silent_wheel(case):
        warnings.warn(
            MissingSourceWarning(
                f"the sound power from vibration is that of rail and sleepers alone: {reason}. Above about "
                "2 kHz the wheel is the loudest. Give wheel.modes, with how they move the wheel.",
                Grade.NOTE,
            ),
            stacklevel=2,
        )


def radiated_power(
    computed: Computed,
    band: NDArray[np.float64],
    frequency: NDArray[np.float64],
    force: NDArray[np.float64],
    segment: int,
) -> RadiatedPower:
    """Sound power of every law of a run in one-third octaves with centres (b,), Hz.

    Frequencies of the spectra (f,), from zero, Hz, PSDs of the contact force (laws, f), N²/Hz, and the length
    of the segments that they are averaged over, in time steps. Track with constant loss factors where it has
    them: their sound power is a matter of frequency, as decay rates are. Over a bay the force is spread as
    that of the linear contact: near the pinned-pinned frequency the wheel presses hardly at all at mid-span.
    """
    case, track = computed.case, computed.track.nominal
    used = (frequency > 0.0) & (frequency <= 1.13 * band[-1])
    lines, exciting = frequency[used], force[:, used]
    _, stiffness = working_point(case.contact, computed.chain.shape, computed.chain.reduction)

    def spread(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.abs(force_transfer(lines, computed.wheel, track, stiffness, x)) ** 2

    top = SleeperTop(case.noise.sleeper_length, case.noise.sleeper_width)
    rail, sleepers = (part.power_per_force(track, lines, spread) for part in (rail_section(case, track), top))
    density = np.zeros((len(force), 3, len(frequency)))
    density[:, 0, used], density[:, 1, used] = rail * exciting, sleepers * exciting
    wheel = radiating_wheel(case)
    if wheel is not None:
        _, motion = psd(computed.chain.stacked("wheel_displacement"), case.time_step, segment=segment)
        middle = 0.5 * track.sleeper_spacing
        compliance = np.abs(1.0 / stiffness + track.receptance(lines, middle, middle))
        square = modal_velocity_psd(computed.wheel, lines, exciting, motion[:, used], compliance)
        density[:, 2, used] = [wheel.power(lines, square[:, law]) for law in range(len(force))]
    low, high = band / HALF_BAND, band * HALF_BAND
    power = np.maximum(band_energies(frequency, density, low, high), 0.0)
    power = np.concatenate([power, power.sum(axis=1, keepdims=True)], axis=1)
    if wheel is None:
        power[:, 2] = np.nan
    return RadiatedPower(band, power, _band_decay_rate(track, band), silent_wheel(case))


def _band_decay_rate(track: Track, band: NDArray[np.float64]) -> NDArray[np.float64]:
    """Decay rate whose length 8.686/Δ is the mean of those over each band, dB/m."""
    within = 10.0 ** (0.1 * (np.arange(9) - 4.0) / 9.0)
    return np.asarray(1.0 / np.mean(1.0 / decay_rate(track, band[:, None] * within), axis=1))


def radiation(
    computed: Computed,
    band: NDArray[np.float64],
    frequency: NDArray[np.float64],
    force: NDArray[np.float64],
    segment: int,
) -> dict[Entry, Any]:
    """Lay out the sound power of all axles of a case, arguments as in `radiated_power`."""
    found = radiated_power(computed, band, frequency, force, segment)
    with np.errstate(divide="ignore"):
        level = 10.0 * np.log10(2.0 * computed.case.noise.axles * found.power / PICOWATT)
    silent = found.silent_wheel or "computed"
    return {
        schema.RADIATOR: RADIATORS,
        schema.RADIATED_POWER_LEVEL: schema.RADIATED_POWER_LEVEL.variable(level, wheel=silent),
        schema.RADIATED_POWER_LEVEL_A: schema.RADIATED_POWER_LEVEL_A.variable(
            a_weighted_total(level, band), wheel=silent
        ),
        schema.BAND_DECAY_RATE: found.decay_rate,
    }
