"""Sound of a run: by CNOSSOS-EU, from the vibration of rail, sleepers and wheel, and beside the track."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray
from numpy.typing import ArrayLike, NDArray

from asperity.errors import Grade, InputError, MissingSourceWarning
from asperity.laws import Role, in_role
from asperity.radiation.pass_by import (
    AxleSource,
    Passage,
    Receiver,
    exposure,
    pass_by_levels,
    pressure_level,
    squared_pressure,
    time_weighted,
)
from asperity.radiation.track import STEEL_DENSITY, RailSection, SleeperTop
from asperity.radiation.wheel import RadiatingWheel, modal_velocity_psd
from asperity.reference import cnossos
from asperity.scenarios.laws import working_point
from asperity.scenarios.linear_force import force_transfer
from asperity.scenes import schema
from asperity.scenes.cnossos_labels import CaseOnTrack, track_label, wheel_label
from asperity.scenes.compute import Computed
from asperity.scenes.tables import read_mode_shapes, read_ratios
from asperity.schema import Attribute, Entry, attributes, spectra, variables
from asperity.spectra import HALF_BAND, a_weighted_total, a_weighting, band_energies, energy_sum, psd
from asperity.structures.track import Track, decay_rate
from asperity.surfaces.bands import band_levels_of
from asperity.surfaces.heightmap import Profile

Table = tuple[ArrayLike, ArrayLike]
"""Band centres and levels in dB, each (n,)."""

SOURCES = ("track", "wheel", "total")


@dataclass(frozen=True, eq=False)
class SoundPower:
    """Sound power levels of rolling, by source."""

    band: NDArray[np.float64]  # (b,), exact centres of the one-third octaves, Hz
    levels: NDArray[np.float64]  # (3, b), of the `SOURCES`, dB re 1 pW; NaN where no roughness is known

    @property
    def a_weighted(self) -> NDArray[np.float64]:
        """A-weighted total over the known bands of each source, dB(A) re 1 pW, shape (3,)."""
        known = ~np.isnan(self.levels[0])
        return energy_sum(self.levels[:, known] + a_weighting(self.band[known]))

    def with_difference(self, band: ArrayLike, difference: ArrayLike) -> SoundPower:
        """The same with another contact force: each band changed by as much as the force, dB.

        Centres (n,), nominal or exact, Hz; bands without a difference, or with NaN, keep their level. The
        sound of rail and wheel is linear in the contact force; both change alike.
        """
        numbers, change = _band_numbers(band), np.atleast_1d(np.asarray(difference, dtype=float))
        if numbers.shape != change.shape or np.isinf(change).any():
            received = f"{numbers.size} bands and {change.size} values"
            raise InputError("difference of force levels", received, "one finite value or NaN per band")
        own = _band_numbers(self.band)
        known = dict(zip(numbers.tolist(), np.nan_to_num(change).tolist(), strict=True))
        return SoundPower(self.band, self.levels + np.array([known.get(n, 0.0) for n in own.tolist()]))


def rolling_sound_power(
    speed: float,
    rail_roughness: Table | None,
    wheel_roughness: Table | None,
    track_transfer: Table,
    wheel_transfer: Table,
    *,
    contact_filter: Table | None = None,
    axles: int = 1,
) -> SoundPower:
    """Sound power of rolling: L_W = (L_rail ⊕ L_wheel + A₃) + L_H + 10 lg N, for N axles at a speed, m/s.

    Roughnesses are wavelengths, m, and levels, dB re 1 µm, None for a smooth one; transfers frequencies, Hz,
    and L_H, dB, both for the same bands, in which the result is; the contact filter wavelengths, m, and A₃,
    dB, for all bands of the roughness. Leave it out where a difference of force levels will be added that
    holds the filtering of the contact already.

    A band of frequency f holds the wavelengths around v/f: those of two wavelength bands, whose energies are
    shared in proportion, that is interpolated in lg λ. Where one surface has no level, the other one's counts
    alone; where both have none, the band is NaN and left out of totals.
    """
    if not (np.isfinite(speed) and speed > 0.0):
        raise InputError("speed (m/s)", speed, "a finite positive number")
    if axles < 1:
        raise InputError("number of axles", axles, "one or more")
    numbers, track = _bands("track transfer", track_transfer)
    wheel_numbers, wheel = _bands("wheel transfer", wheel_transfer)
    if not np.array_equal(numbers, wheel_numbers):
        raise InputError("wheel transfer", f"{wheel_numbers.size} bands", "the bands of the track transfer")
    wavelength, effective = _effective_roughness(rail_roughness, wheel_roughness, contact_filter)
    place = np.round(10.0 * np.log10(speed) - numbers, 9)  # 10 lg λ
    energy = np.interp(place, wavelength, 10.0 ** (effective / 10.0), left=np.nan, right=np.nan)
    roughness = 10.0 * np.log10(energy) + 10.0 * np.log10(axles)
    levels = np.stack([roughness + track, roughness + wheel])
    return SoundPower(10.0 ** (numbers / 10.0), np.vstack([levels, energy_sum(levels, axis=0)]))


def _effective_roughness(
    rail: Table | None, wheel: Table | None, contact_filter: Table | None
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Energy sum of the surfaces, with the filter: band numbers 10 lg λ, levels with NaN in the gaps."""
    given = [
        _bands(what, table)
        for what, table in (("rail roughness", rail), ("wheel roughness", wheel))
        if table is not None
    ]
    if not given:
        raise InputError("roughness", "none", "levels of the rail, the wheel or both")
    first, last = min(n[0] for n, _ in given), max(n[-1] for n, _ in given)
    numbers = np.arange(first, last + 1)
    energy = np.zeros(numbers.size)
    for at, level in given:
        energy[at - first] += 10.0 ** (level / 10.0)
    with np.errstate(divide="ignore"):
        total = np.where(energy > 0.0, 10.0 * np.log10(energy), np.nan)
    if contact_filter is None:
        return numbers, total
    at, gain = _bands("contact filter", contact_filter)
    if at[0] > first or at[-1] < last:
        received = f"wavelengths from {10.0 ** (at[0] / 10.0):.3g} to {10.0 ** (at[-1] / 10.0):.3g} m"
        raise InputError("contact filter", received, "every band of the roughness")
    return numbers, total + gain[first - at[0] : last - at[0] + 1]


def _bands(what: str, table: Table) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Band numbers, rising without gaps, and their levels."""
    numbers, levels = _band_numbers(table[0]), np.atleast_1d(np.asarray(table[1], dtype=float))
    if numbers.shape != levels.shape or not np.isfinite(levels).all():
        received = f"{numbers.size} bands and {levels.size} levels"
        raise InputError(what, received, "one finite level per band")
    order = np.argsort(numbers)
    if not (np.diff(numbers[order]) == 1).all():
        raise InputError(
            what, "missing or repeated bands", "every one-third octave between first and last once"
        )
    return numbers[order], levels[order]


def _band_numbers(centres: ArrayLike) -> NDArray[np.int64]:
    """Nearest numbers n of the bands 10^(n/10), which takes nominal centres to exact ones."""
    values = np.atleast_1d(np.asarray(centres, dtype=float))
    if values.ndim != 1 or values.size == 0 or not ((values > 0.0) & (values < np.inf)).all():
        raise InputError("band centres", f"{values.size} values", "finite positive numbers")
    return np.rint(10.0 * np.log10(values)).astype(np.int64)


EMPTY = -200.0
"""Level of a band without texture, dB re 1 µm."""


def noise(
    computed: Computed, band: NDArray[np.float64], force_level: NDArray[np.float64]
) -> dict[Entry, Any]:
    """Sound power of each law: that of the linear contact, changed in each band by as much as the force.

    Force levels (laws, c, b), dB re 1 N, in bands with centres (b,), Hz; several contacts count by the energy
    mean of their changes, all with the roughness of the first. The linear law follows the bare line,
    so its sound power is that of CNOSSOS-EU without the contact filter A3: the difference of another law
    holds what its contact filters. Bands in which the force is not computed are left out of all totals.
    Nothing without the linear law or without roughness.
    """
    laws = list(computed.chain.runs)
    bare = in_role(Role.BARE, laws)
    if bare is None or not np.ptp(computed.chain.textures.line):
        return {}
    linear, filtered = (_within(_linear(computed, name), band) for name in (None, _filter_of(computed)))
    difference = _mean_level(force_level - force_level[laws.index(bare)])
    powers = [linear.with_difference(band, np.where(np.isfinite(d), d, np.nan)) for d in difference]
    levels = np.stack([power.levels for power in powers])
    standard = schema.CNOSSOS_SOUND_POWER_LEVEL_A
    return {
        schema.SOURCE: SOURCES,
        schema.NOISE_BAND: linear.band,
        schema.SOUND_POWER_LEVEL: schema.SOUND_POWER_LEVEL.variable(levels, reference=bare),
        schema.SOUND_POWER_LEVEL_A: np.stack([power.a_weighted for power in powers]),
        standard: standard.variable(filtered.a_weighted, contact_filter=_filter_of(computed)),
    }


def _mean_level(levels: NDArray[np.float64]) -> NDArray[np.float64]:
    """Energy mean of levels (laws, c, b), dB, over the contacts (laws, b)."""
    if levels.shape[1] == 1:
        return levels[:, 0]
    return np.asarray(10.0 * np.log10(np.mean(10.0 ** (levels / 10.0), axis=1)))


def _filter_of(computed: Computed) -> str:
    return cnossos.nearest_contact_filter(computed.chain.shape.load, 2.0 * computed.case.rolling_radius)


def _linear(computed: Computed, contact_filter: str | None) -> SoundPower:
    """Sound power of CNOSSOS-EU, with or without a contact filter."""
    case, textures = computed.case, computed.chain.textures
    parts = textures.parts or {"rail": textures.line, "wheel": np.zeros(len(textures.line))}
    rail, wheel = (_levels(parts[part], case.contact.spacing) for part in ("rail", "wheel"))
    return rolling_sound_power(
        case.speed,
        rail,
        wheel,
        cnossos.track_transfer(track_label(case)),
        cnossos.wheel_transfer(wheel_label(case)),
        contact_filter=None if contact_filter is None else cnossos.contact_filter(contact_filter),
        axles=case.axles,
    )


def _within(power: SoundPower, band: NDArray[np.float64]) -> SoundPower:
    """Keep the bands for which there are roughness and force."""
    shown = (power.band > band[0] / 1.05) & (power.band < band[-1] * 1.05)
    shown &= ~np.isnan(power.levels).any(axis=0)
    return SoundPower(power.band[shown], power.levels[:, shown])


def _levels(
    line: NDArray[np.float64], spacing: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """Band levels of the line that is rolled over, at the wavelengths of CNOSSOS-EU, where it is rough."""
    if not np.ptp(line):
        return None
    known = cnossos.wavelengths()
    shortest, longest = max(known.min(), 2.0 * spacing * HALF_BAND), known.max()
    wavelength, level = band_levels_of(Profile(line, spacing))
    inside = (wavelength > shortest / 1.05) & (wavelength < longest * 1.05)
    return wavelength[inside], np.where(np.isfinite(level), level, EMPTY)[inside]


RADIATORS = ("rail", "sleepers", "wheel", "total")
PICOWATT = 1e-12
"""Of sound power levels, W."""


@dataclass(frozen=True, eq=False)
class RadiatedPower:
    """Sound power of the wheels on one rail, of the rail under them and of the half sleepers under that.

    Of the whole axles it is twice as much. The total holds what is known: without a wheel that says how its
    modes move it, rail and sleepers.
    """

    band: NDArray[np.float64]  # (b,), exact centres of the one-third octaves, Hz
    power: NDArray[np.float64]  # (laws, 4, b), of the `RADIATORS`, W; NaN where unknown
    decay_rate: NDArray[np.float64]  # (b,), of the rail's vibration, dB/m
    silent_wheel: str  # why the wheel's part is missing; empty where it is there


def rail_section(case: CaseOnTrack, track: Track) -> RailSection:
    """Section of the rail of a case: its widths, and the area that its mass makes of steel."""
    noise = case.noise
    table = None if noise.rail_radiation is None else read_ratios(noise.rail_radiation)
    area = track.mass_per_length / STEEL_DENSITY
    return RailSection(noise.rail_foot_width, noise.rail_head_width, area, table)


def radiating_wheel(case: CaseOnTrack) -> RadiatingWheel | None:
    """Wheel of a case as a radiator of its rigid motion, first, and of its modes; None if they are unknown.

    A rigid wheel that moves up and down has one nodal diameter around its tread.
    """
    shapes = None if case.tread.modes is None else read_mode_shapes(case.tread.modes)
    if shapes is None:
        return None
    diameters, axial, radial = np.vstack([[1.0, 0.0, math.sqrt(0.5)], shapes]).T
    return RadiatingWheel(case.rolling_radius, case.noise.wheel_width, diameters.astype(int), axial, radial)


def silent_wheel(case: CaseOnTrack) -> str:
    """Say why the sound of a wheel is not computed; nothing where it is."""
    if case.tread.modes is None:
        if case.tread.receptance is None:
            return "the wheel is rigid"
        return "the wheel's receptance does not say how its disc and tread move"
    if radiating_wheel(case) is None:
        return f"the table {case.tread_name}.modes does not say how the modes move disc and tread"
    return ""


def warn_of_silence(case: CaseOnTrack) -> None:
    """Note that the sound power from vibration lacks the wheel's part, where it does."""
    if reason := silent_wheel(case):
        warnings.warn(
            MissingSourceWarning(
                f"the sound power from vibration is that of rail and sleepers alone: {reason}. Above about "
                f"2 kHz the wheel is the loudest. Give {case.tread_name}.modes, with how they move the "
                "wheel.",
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

    Frequencies of the spectra (f,), from zero, Hz, PSDs of the contact forces (laws, c, f), N²/Hz, and the
    length of the segments that they are averaged over, in time steps. The contacts feel each other in their
    forces; what several of them radiate adds up as that of incoherent forces. Track with constant loss
    factors where it has them: their sound power is a matter of frequency, as decay rates are. Over a bay the
    force is spread as that of the linear contact: near the pinned-pinned frequency the wheel presses hardly
    at all at mid-span.
    """
    case, track = computed.case, computed.track.nominal
    used = (frequency > 0.0) & (frequency <= 1.13 * band[-1])
    lines, exciting = frequency[used], force[..., used].sum(axis=1)
    _, stiffness = working_point(case.contact, computed.chain.shape, computed.chain.reduction)

    def spread(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.abs(force_transfer(lines, computed.scene.first, track, stiffness, x)) ** 2

    top = SleeperTop(case.noise.sleeper_length, case.noise.sleeper_width)
    rail, sleepers = (part.power_per_force(track, lines, spread) for part in (rail_section(case, track), top))
    density = np.zeros((len(force), 3, len(frequency)))
    density[:, 0, used], density[:, 1, used] = rail * exciting, sleepers * exciting
    wheel, own = radiating_wheel(case), computed.scene.wheel
    if wheel is not None and own is not None:
        _, motion = psd(computed.chain.stacked("rolling_displacement"), case.time_step, segment=segment)
        middle = 0.5 * track.sleeper_spacing
        compliance = np.abs(1.0 / stiffness + track.receptance(lines, middle, middle))
        square = [  # by law (modes, c, f)
            modal_velocity_psd(own, lines, *of_law, compliance)
            for of_law in zip(force[..., used], motion[..., used], strict=True)
        ]
        density[:, 2, used] = [wheel.power(lines, of_law.sum(axis=1)) for of_law in square]
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
        wheels = 2.0 * computed.case.axles / len(computed.scene.offsets)  # for each that was rolled
        level = 10.0 * np.log10(wheels * found.power / PICOWATT)
    silent = found.silent_wheel or "computed"
    return {
        schema.RADIATOR: RADIATORS,
        schema.RADIATED_POWER_LEVEL: schema.RADIATED_POWER_LEVEL.variable(level, wheel=silent),
        schema.RADIATED_POWER_LEVEL_A: schema.RADIATED_POWER_LEVEL_A.variable(
            a_weighted_total(level, band), wheel=silent
        ),
        schema.BAND_DECAY_RATE: found.decay_rate,
    }


KEPT_STEP = 0.02
"""Time between levels that are kept, s, where the record is finer: a sixth of the time constant F."""
ONE_WAVE = 20.0 * math.log10(math.e)
"""Decay rate, dB/m, times the length of a wave that radiates."""
LONGEST = 1000.0
"""Greatest of these lengths, m; the exposure depends on none of them."""


def pass_by_group(case: CaseOnTrack, found: xarray.Dataset) -> xarray.Dataset:
    """Lay out levels beside the track, from the sound power and the decay rates that the spectra hold.

    All axles radiate alike: where several were rolled, as their mean.
    """
    passage, receiver = case.passage, Receiver()
    sources, band = _sources(case, found), found[spectra.BAND.name].values
    length = max(float(np.max(source.length)) for source in sources)
    time, weights = passage.times(receiver, length), 10.0 ** (a_weighting(band) / 10.0)
    squared = _with_total([weights @ squared_pressure(source, passage, receiver, time) for source in sources])
    exposed = _with_total([exposure(source, passage, receiver) for source in sources])
    levels = [pass_by_levels(time, of_law, passage.passed) for of_law in squared]
    step = float(time[1] - time[0])
    kept = slice(None, None, max(1, math.floor(KEPT_STEP / step)))
    entries: dict[Entry, Any] = {
        schema.PASS_BY_LAW: found[spectra.LAW.name].values,
        schema.PASS_BY_RADIATOR: found[schema.RADIATOR.name].values,
        schema.PASS_BY_BAND: band,
        schema.PASS_BY_TIME: time[kept],
        schema.AXLE: 1 + np.arange(len(passage.axles)),
        schema.AXLE_TIME: np.array(passage.axles) / passage.speed,
        schema.PASS_BY_LEVEL: pressure_level(time_weighted(squared, step)[..., kept]),
        schema.PASS_BY_MAXIMUM_LEVEL: np.stack([each.maximum for each in levels]),
        schema.SOUND_EXPOSURE_LEVEL: pressure_level(exposed),
        schema.SOUND_EXPOSURE_LEVEL_A: pressure_level(exposed @ weights),
    }
    if passage.passed is not None:
        entries[schema.PASS_BY_EQUIVALENT_LEVEL] = np.stack([each.equivalent for each in levels])
        entries[schema.TRANSIT_EXPOSURE_LEVEL] = np.stack([each.transit_exposure for each in levels])
    return xarray.Dataset(variables(entries), attrs=attributes(_facts(passage, receiver)))


def _sources(case: CaseOnTrack, found: xarray.Dataset) -> list[AxleSource]:
    """What one axle makes radiate: a wheel from its axle, the others along the rail as its waves decay."""
    level = found[schema.RADIATED_POWER_LEVEL.name].transpose("law", "radiator", "band")
    power = PICOWATT * np.nan_to_num(10.0 ** (level.values / 10.0)) / case.axles
    decay = found[schema.BAND_DECAY_RATE.name].values
    length = ONE_WAVE / np.maximum(decay, ONE_WAVE / LONGEST)
    places = {"wheel": (0.0, case.rolling_radius)}
    return [
        AxleSource(power[:, number], *places.get(name, (length, 0.0)))
        for number, name in enumerate(level["radiator"].values.tolist())
        if name != "total"
    ]


def _with_total(parts: list[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Sources (law, …) along the second axis, their sum the last of them."""
    return np.stack([*parts, np.sum(parts, axis=0)], axis=1)


def _facts(passage: Passage, receiver: Receiver) -> dict[Attribute, float]:
    facts = {schema.RECEIVER_DISTANCE: receiver.distance, schema.RECEIVER_HEIGHT: receiver.height}
    if passage.passed is not None:
        facts |= dict(zip((schema.FRONT_TIME, schema.REAR_TIME), passage.passed, strict=True))
    return facts
