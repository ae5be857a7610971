"""Noise over a track: by CNOSSOS-EU, from the vibration of rail, sleepers and wheel, and beside the track."""

import math
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, Self

import numpy as np
import xarray

from asperity.arguments import Array, ArrayLike, NDArray
from asperity.case.tables import read_ratios
from asperity.errors import Finding, Grade, MissingSourceWarning
from asperity.laws import Role, in_role, names
from asperity.radiation import pass_by
from asperity.radiation.track import STEEL_DENSITY, RailSection, SleeperTop
from asperity.radiation.wheel import RadiatingWheel, modal_velocity_psd
from asperity.reference import cnossos, railways
from asperity.scenarios.scene import force_transfer
from asperity.scenes import compute, measured, schema
from asperity.scenes.measured import measured_passage
from asperity.schema import Entry, Values, spectra
from asperity.spectra import (
    HALF_BAND,
    a_weighted_total,
    a_weighting,
    averaging_time,
    band_energies,
    energy_sum,
    level_deviation,
    level_of,
)
from asperity.speeds import SpeedCourse
from asperity.structures.lateral_rail import LateralTrack
from asperity.structures.track import Track, decay_rate
from asperity.surfaces import bands, heightmap

Table = tuple[ArrayLike, ArrayLike]
"""Band centres and levels in dB, each (n,)."""

# --- by CNOSSOS-EU

SOURCES = ("track", "wheel", "total")
EMPTY = -200.0
"""Level of a band without texture, dB re 1 µm."""
MONO_BLOCK = (110.0, 210.0)
"""Mass of half a mono-block sleeper of concrete, kg: 140 to 177.5 kg are published for models of tracks; half
of one of wood, or of two blocks, is lighter."""
CLOSE = 1.15
"""Ratio to the diameter of the label by which the wheel may be larger or smaller."""


def track_label(case: Any) -> str:
    """Class of rail pads nearest to those of the case."""
    return cnossos.nearest_pad_class(case.track.model().pad_stiffness)


def wheel_label(case: Any) -> str:
    """Diameter nearest to that of the wheel of the case."""
    return cnossos.nearest_wheel_transfer(2.0 * case.rolling.radius)


def findings_of_labels(case: Any) -> list[Finding]:
    """Hold track and wheel of a case to those of which CNOSSOS-EU knows the sound power."""
    track = case.track.model()
    wheel = float(wheel_label(case).split()[0])
    least, most = cnossos.PAD_CLASSES[track_label(case)]
    rows = {  # value, and between which it may lie
        "dynamic stiffness of the rail pads, MN/m": (1e-6 * track.pad_stiffness, 1e-6 * least, 1e-6 * most),
        "mass of half a sleeper, kg": (track.sleeper_mass, *MONO_BLOCK),
        "diameter of the wheel, mm": (2e3 * case.rolling.radius, wheel / CLOSE, wheel * CLOSE),
    }
    words = "CNOSSOS-EU's sound power is that of another one.", "Take the sound power from the vibration."
    return [
        Finding(f"{name}, for CNOSSOS-EU", f"{value:.4g}", f"{low:.4g} to {high:.4g}", Grade.WARNING, *words)
        for name, (value, low, high) in rows.items()
        if not low <= value <= high
    ]


def cited(case: Any) -> tuple[str, ...]:
    """What sound power at a constant speed is cited by."""
    return () if isinstance(case.speed, SpeedCourse) else (cnossos.CITATION,)


def rolling_sound_power(
    speed: float,
    rail_roughness: Table | None,
    wheel_roughness: Table | None,
    track_transfer: Table,
    wheel_transfer: Table,
    *,
    contact_filter: Table | None = None,
    axles: int = 1,
) -> tuple[Array, Array]:
    """Sound power of rolling: L_W = (L_rail ⊕ L_wheel + A₃) + L_H + 10 lg N, for N axles at a speed, m/s.

    Exact centres of the one-third octaves (b,), Hz, and levels of the `SOURCES` (3, b), dB re 1 pW.
    Roughnesses are wavelengths, m, and levels, dB re 1 µm, None for a smooth one; transfers frequencies, Hz,
    and L_H, dB, both for the same bands, in which the result is; the contact filter wavelengths, m, and A₃,
    dB, for all bands of the roughness. Leave it out where a difference of force levels will be added that
    holds the filtering of the contact already.

    A band of frequency f holds the wavelengths around v/f: those of two wavelength bands, whose energies are
    shared in proportion, that is interpolated in lg λ. Where one surface has no level, the other one's counts
    alone; where both have none, the band is NaN.
    """
    numbers, track = _bands(track_transfer)
    _, wheel = _bands(wheel_transfer)
    rough = [_bands(table) for table in (rail_roughness, wheel_roughness) if table is not None]
    wavelength = np.arange(min(n[0] for n, _ in rough), max(n[-1] for n, _ in rough) + 1)
    energy = np.zeros(len(wavelength))
    for at, level in rough:
        energy[at - wavelength[0]] += 10.0 ** (level / 10.0)
    if contact_filter is not None:
        at, gain = _bands(contact_filter)
        energy *= 10.0 ** (gain[wavelength - at[0]] / 10.0)
    energy[energy == 0.0] = np.nan
    place = np.round(10.0 * np.log10(speed) - numbers, 9)  # 10 lg λ
    shared = axles * np.interp(place, wavelength, energy, left=np.nan, right=np.nan)
    levels = 10.0 * np.log10(shared) + np.stack([track, wheel])
    return 10.0 ** (numbers / 10.0), np.vstack([levels, energy_sum(levels, axis=0)])


def _bands(table: Table) -> tuple[NDArray[np.int64], Array]:
    """Numbers n of the bands 10^(n/10), rising, nearest to nominal or exact centres, and their levels."""
    numbers = _numbers(table[0])
    levels = np.asarray(table[1], dtype=float)
    order = np.argsort(numbers)
    return numbers[order], levels[order]


def _numbers(centres: ArrayLike) -> NDArray[np.int64]:
    return np.rint(10.0 * np.log10(centres)).astype(np.int64)


def noise(computed: compute.Computed) -> Values:
    """Sound power of each law: that of the linear contact, changed in each band by as much as the force.

    Several contacts count by the energy mean of their changes, all with the roughness of the first. The
    linear law follows the bare line, so its sound power is that of CNOSSOS-EU without the contact filter A3:
    the difference of another law holds what its contact filters. Bands in which the force is not computed are
    left out of all totals. The linear law is rolled for it where the case does not name it. Nothing without
    roughness, nor at a speed that changes, of which CNOSSOS-EU does not know.
    """
    case = computed.case
    bare = in_role(Role.BARE, names())
    if bare is None or computed.bare_levels is None:
        return {}
    contact_filter = cnossos.nearest_contact_filter(computed.shape.load, 2.0 * case.rolling.radius)
    centres, linear = _linear(computed, None)
    _, filtered = _linear(computed, cnossos.contact_filter(contact_filter))
    changes = computed.force_levels - computed.bare_levels
    change = 10.0 * np.log10(np.mean(10.0 ** (changes / 10.0), axis=1))
    at = np.searchsorted(_numbers(computed.band), _numbers(centres))
    levels = linear + np.where(np.isfinite(change), change, 0.0)[:, None, at]
    power, standard = schema.SOUND_POWER_LEVEL, schema.CNOSSOS_SOUND_POWER_LEVEL_A
    of_standard = a_weighted_total(filtered, centres)
    return {
        schema.SOURCE: SOURCES,
        schema.NOISE_BAND: centres,
        power: power.variable(levels, reference=bare),
        schema.SOUND_POWER_LEVEL_A: a_weighted_total(levels, centres),
        standard: standard.variable(of_standard, contact_filter=contact_filter),
    }


def _linear(computed: compute.Computed, contact_filter: Table | None) -> tuple[Array, Array]:
    """Sound power of CNOSSOS-EU in the bands for which there are roughness and force."""
    case = computed.case
    textures = computed.textures
    band = computed.band
    parts = textures.parts or {"rail": textures.line, "wheel": np.zeros(len(textures.line))}
    rail, wheel = (_roughness(parts[part], case.contact.spacing) for part in ("rail", "wheel"))
    transfers = cnossos.track_transfer(track_label(case)), cnossos.wheel_transfer(wheel_label(case))
    centres, levels = rolling_sound_power(
        case.speed, rail, wheel, *transfers, contact_filter=contact_filter, axles=len(case.contacts_behind)
    )
    shown = (centres > band[0] / 1.05) & (centres < band[-1] * 1.05) & ~np.isnan(levels).any(axis=0)
    return centres[shown], levels[:, shown]


def _roughness(line: Array, spacing: float) -> Table | None:
    """Band levels of the line that is rolled over, at the wavelengths of CNOSSOS-EU, where it is rough."""
    if not np.ptp(line):
        return None
    known = cnossos.wavelengths()
    shortest = max(known.min(), 2.0 * spacing * HALF_BAND)
    longest = known.max()
    wavelength, level = bands.band_levels_of(heightmap.Profile(line, spacing))
    inside = (wavelength > shortest / 1.05) & (wavelength < longest * 1.05)
    return wavelength[inside], np.where(np.isfinite(level), level, EMPTY)[inside]


# --- from the vibration itself

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
    case, band = computed.case, computed.band
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
    weighted = weighted * 10.0 ** (a_weighting(band) / 10.0)
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
    weighted = power @ 10.0 ** (a_weighting(band) / 10.0)
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


# --- beside the track

KEPT_STEP = 0.02
"""Time between levels that are kept, s, where the record is finer: a sixth of the time constant F."""
ONE_WAVE = 20.0 * math.log10(math.e)
"""Decay rate, dB/m, times the length of a wave that radiates."""
LONGEST = 1000.0
"""Greatest of these lengths, m; the exposure depends on none of them."""


def sources_of(case: Any) -> tuple[str, ...]:
    """What the level beside the track is computed by, beyond the sound power."""
    ground = (railways.GROUND_CITATION,) if case.noise.sound_path(np.array([1000.0])).ground else ()
    return ground if case.noise.vehicle is None else (*ground, railways.TSI_CITATION)


def pass_by_group(case: Any, over_frequency: xarray.Dataset, beside: Values | None = None) -> Values:
    """Lay out levels beside the track, from the sound power and the decay rates that the spectra hold.

    All axles radiate alike: where several were rolled, as their mean. What moves sideways decays along the
    rail as its own waves do, of which the group `beside` tells.
    """
    keys = case.noise
    passage = case.passage
    band = over_frequency[spectra.BAND.name].values
    sources = _sources(case, over_frequency, beside or {})
    weights = 10.0 ** (a_weighting(band) / 10.0)
    length = max(float(np.max(source.length)) for source in sources)

    @cache
    def heard(at: pass_by.Receiver) -> tuple[Array, ...]:
        """Times, squared pressure and exposure (laws, radiators, …), and the single numbers of both."""
        path = keys.sound_path(band, at)
        time = passage.times(at, length)

        def with_sum(each: list[Array]) -> Array:
            return np.stack([*each, np.sum(each, axis=0)], axis=1)

        squared = with_sum([weights @ path.squared_pressure(each, passage, time) for each in sources])
        exposed = with_sum([path.exposure(each, passage) for each in sources])
        levels = [pass_by.pass_by_levels(time, law, passage.passed) for law in squared]
        return time, squared, exposed, *np.stack(levels, axis=1)

    receiver = keys.receiver
    time, squared, exposed, maximum, equivalent, transit_exposure = heard(receiver)
    step = float(time[1] - time[0])
    kept = slice(None, None, max(1, math.floor(KEPT_STEP / step)))
    laid_out: Values = {
        schema.PASS_BY_LAW: over_frequency[spectra.LAW.name].values,
        schema.PASS_BY_RADIATOR: over_frequency[schema.RADIATOR.name].values.tolist(),
        schema.PASS_BY_BAND: band,
        schema.PASS_BY_TIME: time[kept],
        schema.AXLE: 1 + np.arange(len(passage.axles)),
        schema.AXLE_TIME: np.array(passage.axles) / passage.speed,
        schema.PASS_BY_LEVEL: pass_by.pressure_level(pass_by.time_weighted(squared, step)[..., kept]),
        schema.PASS_BY_MAXIMUM_LEVEL: maximum,
        schema.SOUND_EXPOSURE_LEVEL: pass_by.pressure_level(exposed),
        schema.SOUND_EXPOSURE_LEVEL_A: pass_by.pressure_level(exposed @ weights),
        schema.RECEIVER_DISTANCE: receiver.distance,
        schema.RECEIVER_HEIGHT: receiver.height,
        schema.GROUND: keys.ground_words,
        schema.DIRECTIVITY: keys.directivity,
        schema.RAIL_DISTANCE: keys.rail_distance or 0.0,
        schema.FAR_RAIL_SCREENING: keys.far_rail_screening,
        schema.RECEIVER_OFFSET: keys.receiver_offset,
    }
    if passage.passed is not None:
        laid_out[schema.PASS_BY_EQUIVALENT_LEVEL] = equivalent
        laid_out[schema.TRANSIT_EXPOSURE_LEVEL] = transit_exposure
        laid_out |= dict(zip((schema.FRONT_TIME, schema.REAR_TIME), passage.passed, strict=True))
        laid_out |= measured.held_to_limits(case, over_frequency, lambda at: heard(at)[4])
    return laid_out | measured_passage(case.noise, band)


def _sources(case: Any, over_frequency: xarray.Dataset, beside: Values) -> list[pass_by.AxleSource]:
    """What one axle makes radiate: a wheel from its axle, the others along the rail as its waves decay.

    Waves sideways reach no farther than the longest of those up and down, but where that was measured.
    """
    power = over_frequency[schema.RADIATED_POWER_LEVEL.name].transpose("law", "radiator", "band")
    band = power["band"].values
    decay = over_frequency[schema.BAND_DECAY_RATE.name].values
    height = case.noise.source_heights
    up = ONE_WAVE / np.maximum(decay, ONE_WAVE / LONGEST)
    found = []
    for name, level in zip(power["radiator"].values.tolist(), np.moveaxis(power.values, 1, 0), strict=True):
        sent = PICOWATT * np.nan_to_num(10.0 ** (level / 10.0)) / len(case.contacts_behind)
        if name == "wheel":
            found.append(pass_by.AxleSource(sent, 0.0, case.rolling.radius))
        elif name == schema.RAIL_SIDEWAYS:
            rate = np.interp(
                band[:, None] * WITHIN, beside[schema.SIDEWAYS_FREQUENCY], beside[schema.LATERAL_DECAY_RATE]
            )
            lateral = np.minimum(np.mean(ONE_WAVE / rate, axis=1), float(np.max(up)))
            if (change := schema.MEASURED_LATERAL_POWER_CHANGE.name) in over_frequency:
                own = lateral * 10.0 ** (0.1 * over_frequency[change].values)
                lateral = np.where(np.isfinite(own), np.minimum(own, LONGEST), lateral)
            found.append(pass_by.AxleSource(sent, lateral, height["rail"], "lateral"))
        elif name != "total":
            motion = "vertical" if name == "rail" else "all"
            found.append(pass_by.AxleSource(sent, up, height[name], motion))
    return found
