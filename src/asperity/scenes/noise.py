"""Sound power over a track, from the vibration of rail, sleepers and wheel."""

import math
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from asperity.arguments import Array, ArrayLike
from asperity.case.tables import read_ratios
from asperity.errors import Grade, MissingSourceWarning
from asperity.radiation.track import STEEL_DENSITY, RailSection, SleeperTop
from asperity.radiation.wheel import RadiatingWheel, modal_velocity_psd
from asperity.scenarios.scene import force_transfer
from asperity.scenes import compute, measured, schema
from asperity.schema import Entry, Values
from asperity.spectra import (
    HALF_BAND,
    a_weighted_total,
    a_weighting,
    averaging_time,
    band_energies,
    energy_of,
    level_deviation,
    level_of,
)
from asperity.structures.lateral_rail import LateralTrack
from asperity.structures.track import Track, decay_rate

RADIATORS = ("rail", "sleepers", "wheel", "total")
WITH_SIDEWAYS = ("rail", schema.RAIL_SIDEWAYS, "sleepers", "wheel", "total")
"""Where something moves sideways: the rail up and down, then sideways; the wheel under both forces."""
WITHIN = 10.0 ** (0.1 * (np.arange(9) - 4.0) / 9.0)
"""Frequencies in a band over its centre, over which lengths are averaged."""
PICOWATT = 1e-12
"""Of sound power levels, W."""


def rail_section(case: Any, track: Track) -> RailSection:
    """Section of the rail of a case: its widths, and the area that its mass makes of steel."""
    keys = case.track
    given = case.noise.rail_radiation
    table = None if given is None else read_ratios(given)
    area = track.mass_per_length / STEEL_DENSITY
    return RailSection(keys.rail_foot_width, keys.rail_head_width, area, table)


def sleeper_top(case: Any, track: Track) -> SleeperTop:
    """Top of a sleeper of a case; one that bends is as long as it radiates, if nothing else is said."""
    keys = case.noise
    bends = track.sleeper_bending_stiffness is not None and "sleeper_length" not in keys.given_names
    return SleeperTop(track.sleeper_length if bends else keys.sleeper_length, keys.sleeper_width)


def radiating_wheel(case: Any) -> RadiatingWheel | None:
    """Wheel of a case as a radiator of its rigid motion, first, and of its modes; None if they are unknown.

    A rigid wheel that moves up and down has one nodal diameter around its tread.
    """
    modes = case.rolling.turning_modes(case.numerics.highest_frequency, case.speed)
    if modes is None:
        return None
    diameters, axial, radial = np.vstack(
        [[1.0, 0.0, math.sqrt(0.5)], modes.table(case.contact_places[0])[:, 3:]]
    ).T
    return RadiatingWheel(case.rolling.radius, case.noise.wheel_width, diameters.astype(int), axial, radial)


def silent_wheel(case: Any) -> str:
    """Say why the sound of a wheel is not computed; nothing where it is."""
    return schema.SILENT if radiating_wheel(case) is None else ""


def warn_of_silence(case: Any) -> None:
    """Note that the sound power from vibration lacks the wheel's part, where it does.

    It is no mere note where a level is held to a limit.
    """
    if reason := silent_wheel(case):
        limited = case.noise.vehicle is not None
        told = "; no limit of TSI Noise can be met by it" if limited else ""
        MissingSourceWarning.warn(
            f"the sound power from vibration is that of rail and sleepers alone{told}: {reason}. Above about "
            f"2 kHz the wheel is the loudest. Give {case.ROLLING}.section, or {case.ROLLING}.modes with how "
            "they move the wheel.",
            Grade.WARNING if limited else Grade.NOTE,
        )


@dataclass(frozen=True, eq=False)
class SidewaysPower:
    """Sound power of what moves sideways, or also, of what was rolled on one rail, on all lines.

    Parameters
    ----------
    parts : ndarray (laws, 3, f)
        W/Hz, of the rail, which adds to the total, of the wheels under both forces, which stands there in
        place of that under the vertical one, and under the lateral one alone.
    of_modes : ndarray (laws, modes, f)
        W/Hz, of each mode of the wheels under both forces, the rigid motion first.
    track : LateralTrack
        What moves so.
    """

    parts: Array
    of_modes: Array
    track: LateralTrack


def radiation(computed: compute.Computed, values: Array, side: SidewaysPower | None) -> Values:
    """Lay out the sound power of all axles from the vibration of rail, sleepers and wheels: one total.

    What was rolled on one rail stands for axles, each with two wheels, on two rails. The total
    holds all that is known: without a wheel that says how its modes move it, rail and sleepers. What was
    measured on the track changes the power of both up and down, and the length that radiates, band by band;
    lateral decay rates change the rail sideways.

    Parameters
    ----------
    values : ndarray (b,)
        Independent values that the record holds in each band.
    side : SidewaysPower or None
        That of what moves sideways, if something does.
    """
    case = computed.case
    band = computed.band
    edges = band / HALF_BAND, band * HALF_BAND
    density, of_modes = _radiated(computed)

    def in_bands(density: Array) -> Array:
        return np.maximum(band_energies(computed.frequency, density, *edges), 0.0)

    beside = None if side is None else in_bands(side.parts)
    power = _SoundPower(band, in_bands(density), beside, silent_wheel(case) or "computed")
    more: Values = {}
    longer: ArrayLike = 1.0
    if (found := measured.measured_track(computed)) is not None:
        more = power.laid_out(schema.UNMEASURED_POWER_LEVEL, schema.UNMEASURED_POWER_LEVEL_A)
        own, louder, longer = found
        more |= own
        longer_sideways: Array | float = 1.0
        if side is not None:
            own, longer_sideways = measured.lateral_rates(case.track, side.track, band)
            more |= own
        power = power.changed(louder, longer_sideways)
    rung: Values = {}
    if of_modes.shape[1]:
        each = 2.0 * in_bands(of_modes if side is None else side.of_modes)
        rung = mode_by_mode(case, each, band, every=side is not None)
    # the length 8.686/Δ of the decay is the mean of those over a band
    lengths = 1.0 / decay_rate(computed.track.nominal, band[:, None] * WITHIN)
    radiated = power.laid_out(schema.RADIATED_POWER_LEVEL, schema.RADIATED_POWER_LEVEL_A)
    densities = _all_parts(density, None if side is None else side.parts)
    deviation = _deviation(computed, densities, power.parts, values)
    said = radiated[schema.RADIATED_POWER_LEVEL_A].attrs
    told = {name: said[name] for name in ("wheel", "missing") if name in said}
    return {
        schema.RADIATOR: RADIATORS if side is None else WITH_SIDEWAYS,
        **radiated,
        schema.RADIATED_POWER_DEVIATION: schema.RADIATED_POWER_DEVIATION.variable(deviation, **told),
        schema.BAND_DECAY_RATE: 1.0 / np.mean(lengths, axis=1) / longer,
        **more,
        **power.single_forces(),
        **rung,
    }


@dataclass(frozen=True, eq=False)
class _SoundPower:
    """Sound power in bands, W, of what was rolled on one rail."""

    band: Array  # (b,), Hz
    up: Array  # (laws, 3, b), of rail, sleepers and wheel, by what moves up and down
    beside: Array | None  # the same sideways, if something moves so
    silent: str  # why the wheel's is not known, or "computed"

    @property
    def parts(self) -> Array:
        """All that radiates (laws, n, b), as the result orders it."""
        return _all_parts(self.up, self.beside)

    def changed(self, louder: Array, longer_sideways: Array | float) -> Self:
        """Power with that of rail and sleepers, and of the rail sideways, times factors, band by band."""
        up = np.array(self.up)
        beside = self.beside
        up[:, :2] *= louder
        if beside is not None:
            beside = np.array(beside)
            beside[:, 0] *= longer_sideways
        return replace(self, up=up, beside=beside)

    def laid_out(self, levels: Entry, totals: Entry) -> Values:
        """Levels of all parts and their sum, and their A-weighted totals."""
        whole = np.concatenate([self.parts, self.parts.sum(axis=1, keepdims=True)], axis=1)
        if self.silent != "computed":
            whole[:, -2] = np.nan
        said = {"wheel": self.silent}
        if not self.up[:, 1].any():
            of_wheel = () if self.silent == "computed" else (schema.SILENT,)
            said["missing"] = "; ".join((schema.STILL, *of_wheel))
        found = _level(whole)
        return {
            levels: levels.variable(found, **said),
            totals: totals.variable(a_weighted_total(found, self.band), **said),
        }

    def single_forces(self) -> Values:
        """Levels by one force alone, up and down or sideways; nothing where nothing moves sideways."""
        if self.beside is None:
            return {}
        alone = _level(np.stack([self.up[:, 2], self.beside[:, 2], self.up.sum(axis=1)], axis=1))
        return {
            schema.SINGLE_FORCE: schema.SINGLE_FORCES,
            schema.SINGLE_FORCE_POWER_LEVEL: alone,
            schema.SINGLE_FORCE_POWER_LEVEL_A: a_weighted_total(alone, self.band),
        }


def _level(power: Array) -> Array:
    """Level of a sound power of one rail, W, for two of them, dB re 1 pW."""
    return level_of(2.0 * power / PICOWATT)


def _all_parts(up: Array, side: Array | None) -> Array:
    """All that radiates (laws, n, ...), as the result orders it, of what moves up and down and sideways."""
    return up if side is None else np.stack([up[:, 0], side[:, 0], up[:, 1], side[:, 1]], axis=1)


def _deviation(computed: compute.Computed, density: Array, power: Array, values: Array) -> Array:
    """Standard deviation of A-weighted levels by chance (laws, n), dB, of parts and, last, of their sum.

    A part whose power in a band is that of few lines, as of a wheel that rings, holds fewer independent
    values there than the force does: of lines e, Hz apart by Δf, over a time T it is (Σe)²/Σe² Δf T. Bands
    count by their share of the power. Densities (laws, n, f) on all lines, powers (laws, n, b); NaN of what
    does not radiate.
    """
    case = computed.case
    band = computed.band
    frequency = computed.frequency
    time = averaging_time(len(computed.first.time), case.time_step, segment=computed.segment)
    density = np.concatenate([density, density.sum(axis=1, keepdims=True)], axis=1)
    weighted = np.concatenate([power, power.sum(axis=1, keepdims=True)], axis=1)
    weighted = weighted * energy_of(a_weighting(band))
    variance = np.zeros(weighted.shape)
    for b, centre in enumerate(band):
        inside = density[..., (frequency >= centre / HALF_BAND) & (frequency < centre * HALF_BAND)]
        square = np.maximum(np.sum(inside**2, axis=-1), np.finfo(float).tiny)
        lines = np.sum(inside, axis=-1) ** 2 / square
        held = np.minimum(values[b], lines * float(frequency[1] - frequency[0]) * time)
        variance[..., b] = level_deviation(held) ** 2
    with np.errstate(invalid="ignore", divide="ignore"):
        share = weighted / weighted.sum(axis=-1, keepdims=True)
    return np.sqrt(np.sum(share**2 * variance, axis=-1))


def mode_by_mode(case: Any, power: Array, band: Array, *, every: bool) -> Values:
    """Lay out the modes of the wheels with their A-weighted sound power, of powers (laws, modes, b), W.

    The rigid motion comes first; of the two waves in which turning splits a mode the powers are added. Powers
    of `every` mode, or of those alone that answer a vertical force.
    """
    modes = case.rolling.standing_modes(case.numerics.highest_frequency)
    if every:
        own = np.stack([modes.natural_frequencies, modes.damping_ratios, modes.nodal_diameters])
    else:
        own = modes.table(case.contact_places[0]).T[[0, 1, 3]]
    frequency, damping, diameters = np.hstack([np.array([[0.0], [0.0], [1.0]]), own])
    number = np.arange(len(diameters))
    mode = np.append(0, np.repeat(number[1:], np.where(diameters[1:] > 0.0, 2, 1)))
    weighted = power @ energy_of(a_weighting(band))
    summed = np.stack([weighted[:, mode == each].sum(axis=1) for each in number], axis=1)
    return {
        schema.WHEEL_MODE: number,
        schema.WHEEL_MODE_FREQUENCY: frequency,
        schema.WHEEL_MODE_DAMPING: damping,
        schema.WHEEL_MODE_DIAMETERS: diameters.astype(int),
        schema.WHEEL_MODE_POWER_LEVEL_A: level_of(summed / PICOWATT),
    }


def _radiated(computed: compute.Computed) -> tuple[Array, Array]:
    """Sound power (laws, 3, f), W/Hz, of rail, sleepers and wheels, of what was rolled on one rail.

    And that of the wheel's rigid motion and each of its modes (laws, modes, f), none where they are unknown.

    The contacts feel each other in their forces; what several of them radiate adds up as that of incoherent
    forces. Track with constant loss factors where it has them: their sound power is a matter of frequency, as
    decay rates are. Over a bay the force is spread as that of the linear contact: near the pinned-pinned
    frequency the wheel presses hardly at all at mid-span.
    """
    case = computed.case
    track = computed.track.nominal
    stiffness = computed.stiffness
    used = (computed.frequency > 0.0) & (computed.frequency <= 1.13 * computed.band[-1])
    lines = computed.frequency[used]
    force = computed.force_psd[..., used]
    exciting = force.sum(axis=1)
    known = dict[bytes, Array]()

    def spread(x: Array) -> Array:
        """Of rail and sleepers the places are the same."""
        if (at := x.tobytes()) not in known:
            known[at] = np.abs(force_transfer(lines, computed.scene.first, track, stiffness, x)) ** 2
        return known[at]

    density = np.zeros((len(force), 3, len(used)))
    rail = rail_section(case, track)
    top = sleeper_top(case, track)
    density[:, 0, used] = rail.power_per_force(track, lines, spread) * exciting
    density[:, 1, used] = top.power_per_force(track, lines, spread) * exciting
    wheel = radiating_wheel(case)
    own = computed.scene.wheel
    of_modes = np.zeros((len(force), 0 if wheel is None else len(wheel.axial), len(used)))
    if wheel is not None and own is not None:
        motion = computed.psd(computed.stacked("rolling_displacement"))[..., used]
        middle = float(track.mid_spans[0])
        compliance = np.abs(1.0 / stiffness + track.receptance(lines, middle, middle))
        for law, (of_force, of_motion) in enumerate(zip(force, motion, strict=True)):
            square = modal_velocity_psd(own, lines, of_force, of_motion, compliance)  # (modes, c, f)
            of_modes[law][:, used] = wheel.power(lines, square.sum(axis=1))
            density[law, 2] = of_modes[law].sum(axis=0)
    return density, of_modes
