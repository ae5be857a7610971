"""A ball bearing: laid ready, run by each law, and what its acceleration says; as a result."""

from __future__ import annotations

import math
import time
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray

from asperity import diagnostics
from asperity.arguments import Array
from asperity.case.ball_bearing import AroundKeys, BearingUnderLoad
from asperity.diagnostics import ISO_BANDS, LineFamily, Spectrum, band_velocities
from asperity.errors import InputError, PhysicsWarning, percent, warn_of_findings
from asperity.laws import Need, spec_of
from asperity.progress import Progress
from asperity.rolling.bearing import BearingRings, RolledBearing, Sensor, roll_bearing, steady_where_still
from asperity.scenarios import compiling, preparing, reducing, run_time
from asperity.scenarios.doubts import doubt_bearing
from asperity.scenarios.problems import refuse
from asperity.scenarios.raceway_laws import OnRaceway, ball_heights, laws_on, raceway_on
from asperity.scenarios.raceway_limits import doubt_fault, doubt_surface
from asperity.scenes import schema
from asperity.scenes.bearing_levels import levels_group
from asperity.scenes.bearing_validity import bearing_findings
from asperity.scenes.compute import checkpoint_of
from asperity.scenes.result import root_attributes, scenario_group
from asperity.schema import Values, bearing, contact, rolling, spectra, tree
from asperity.store import Store
from asperity.structures.ball_bearing import PARTS, Kinematics
from asperity.structures.bearing_statics import LoadedBearing, doubt_speed
from asperity.structures.ring import Ring
from asperity.surfaces.raceway import Raceway
from asperity.written_numbers import in_newtons, rounded

RINGS = ("inner", "outer")
NAMES = {"outer": "outer raceway", "inner": "inner raceway", "ball": "balls"}
ON = {
    "inner_raceway": "the inner raceway",
    "outer_raceway": "the outer raceway",
    "balls": "the balls",
    "fault": "the fault",
}
"""Sections of a case that say what is on a part."""
LEFT_OUT = (
    "There is no film of lubricant, no friction, no shoulder of a groove, and no tilt of a ring; the contact "
    "angle is that of the static load."
)
STEP_TIME, SOLUTION_TIME = 2.0e-6, 1e-3
"""Processor times of a step of one ball with its record and spectra, and of a contact of a scan, s."""
CELL_TIME = 3.5e-8
"""Time of a contact under a load over a fault, for each of its cells, s."""
SEEDS = 1000
"""Seeds of the parts of a bearing lie beside each other, and no two bearings share any."""
DIRECTIONS = ("along", "across", "axial")
HARMONICS = 5
REACH = 1.2
"""How far the envelope spectrum is kept, beyond the highest harmonic of a tone."""
RESOLVED = 0.003
"""Share by which a line may lie beside the tone of pure rolling, beyond the slip of the cage."""
SILENT = 1e-5
"""Amplitude of a line, m/s², that no accelerometer feels: what is left of rounding and of the start."""
BY_PARTS = "areal"
"""The law by which parts are run alone: it sees whole contacts, and asks for no scan."""
SOURCES = (
    "T. A. Harris and M. N. Kotzalas, Essential Concepts of Bearing Technology, 5th ed. (2007).",
    "F. P. Wardle, Proc. IMechE 202 C (1988) 305 (vibration of ball bearings by waviness).",
    "ISO 15242-2 (velocities in three bands).",
    "R. B. Randall and J. Antoni, Mechanical Systems and Signal Processing 25 (2011) 485 (envelope).",
    "J. Antoni, Mechanical Systems and Signal Processing 21 (2007) 108 (spectral kurtosis, of the band).",
    "H. Hertz, J. reine angew. Math. 92 (1882) 156 (contact of smooth bodies).",
)


# --- laid ready, and run


@dataclass(frozen=True, eq=False)
class PreparedBearing:
    """A case of a bearing that can be computed."""

    case: BearingUnderLoad
    raceways: tuple[Raceway, Raceway]  # inner and outer one
    balls: tuple[Raceway, ...]  # their surfaces; none where all are smooth
    caught: tuple[warnings.WarningMessage, ...]  # warnings met on the way


def _parts(case: BearingUnderLoad) -> list[tuple[str, Any, float]]:
    """Names of inner and outer raceway and of balls, their sections, and their radii, m."""
    of = case.bearing.bearing
    return [
        ("inner", case.inner_raceway, of.raceway_radii[0]),
        ("outer", case.outer_raceway, of.raceway_radii[1]),
        ("ball", case.balls, 0.5 * of.ball_diameter),
    ]


def prepare_bearing(case: BearingUnderLoad, source: str = "case") -> PreparedBearing:
    """Load the bearing at rest and lay out what is on its parts; refuse what cannot be."""
    errors = list[InputError]()
    made = list[Raceway]()
    of = case.bearing.bearing
    *parts, balls = _parts(case)
    parts += [balls] * of.balls * (not case.has_smooth_balls)
    with PhysicsWarning.caught() as caught:
        case.loaded()
        doubt_speed(of, case.speed)
        doubt_bearing(case)
        for number, (name, keys, radius) in enumerate(parts):
            contact, load = case.contacts[min(number, 1)]  # of balls those with the outer ring
            on_it = (each for each in case.faults.values() if each.lies_on(name, number - 1))
            faults = [each.fault for each in on_it if each.fault]
            seed = SEEDS * case.seed + number
            try:
                made.append(raceway_on(contact, load, radius, keys.texture(), faults, seed=seed))
                doubt_surface(made[-1], contact.approach(load))
            except InputError as error:
                errors.append(_by_key(case, name, keys, error))
            apart = 2.0 * np.pi * radius / of.balls
            for fault in faults if name != "ball" else ():
                doubt_fault(fault, apart, NAMES[name])
    refuse(errors, source)
    return PreparedBearing(case, (made[0], made[1]), tuple(made[2:]), tuple(caught))


def _by_key(case: BearingUnderLoad, part: str, keys: AroundKeys, error: InputError) -> InputError:
    """An error about what is on a part, by the key of the case that it is about."""
    section = "balls" if part == "ball" else f"{part}_raceway"
    what, _, of = error.what.partition(" of the fault")
    if of:
        damaged = (name for name, each in case.faults.items() if each.on == part)
        return error.about(f"{next(damaged, 'fault')}.{what}")
    heights = ("waviness", "amplitudes", "trace", "roughness", "map")
    sources = {"rms slope": heights[::-1], "waves per turn": ("last_order", "waves")}
    given = (name for name in (error.what, *sources.get(error.what, heights)) if name in keys.given_names)
    told = error.received if error.what in keys.keys else f"{error.received} ({error.what})"
    return error.about(f"{section}.{next(given, 'waviness')}", told)


def expected(prepared: PreparedBearing) -> tuple[list[tuple[str, str]], preparing.Work]:
    """What will be computed, in words, and how much work it is; coarsely, as nothing is solved for that."""
    case = prepared.case
    turning = prepared.case.kinematics
    found = prepared.case.static
    steps = round((case.settling + case.duration) / case.step)
    textured = sum(bool(getattr(case, key).given()) for key in ON)
    runs = len(case.laws) + textured + (textured > 0)
    solutions = {}
    for name, on in zip(RINGS, raceways_of(prepared, progress=None), strict=True):
        rough = np.count_nonzero((on.surface.heights + on.surface.faults).any(axis=1))
        if rough and any(Need.SCAN in spec_of(law).needs for law in case.laws):
            positions = math.ceil(int(rough) / on.scanned_stride)
            solutions[f"scan of the {NAMES[name]}"] = positions * reducing.STATES
    for law in (law for law in case.laws if spec_of(law).solved_every_step):
        solutions[law] = steps * int(found.touching.max() + found.bearing.balls)
    rolled_once = STEP_TIME * steps * found.bearing.balls
    parts = {
        "start and report": run_time.START,
        "each part alone": rolled_once * (runs - len(case.laws)),
    }
    parts |= {f"the law {law}": run_time.LAW + rolled_once for law in case.laws}
    for name, count in solutions.items():
        part = f"the law {name}" if f"the law {name}" in parts else f"the {name}"
        parts[part] = parts.get(part, 0.0) + SOLUTION_TIME * count
    parts["contacts over the faults"] = CELL_TIME * _cells_over_faults(prepared)
    pace = run_time.pace()
    taken = run_time.RunTime({part: pace * seconds for part, seconds in parts.items()})
    tones = ", ".join(f"{NAMES[part]} {rounded(turning.tone(part), 4)} Hz" for part in PARTS)
    load, angle = max(load for _, load in case.contacts), np.degrees(found.contact_angle)
    touching, at_rest = (each.static.touching for each in (case, case.with_(centrifugal=False)))
    held = f"{rounded(touching.mean())} of {found.bearing.balls} on average, {touching.min():.0f} or more"
    rows = [
        ("heaviest load of a ball", f"{in_newtons(load)}, contact angle {rounded(angle)}°"),
        ("balls that touch both rings", f"{held}; at rest {rounded(at_rest.mean())}"),
        ("tones", f"{tones}; cage {rounded(turning.cage, 4)} Hz"),
        (
            "time",
            f"{steps} steps of {rounded(case.step * 1e6, 4)} µs, {case.settling:g} s of them "
            "before the record",
        ),
        ("runs", f"{', '.join(case.laws)}, and {runs - len(case.laws)} by areal with parts alone"),
        *((f"contact solutions, {name}", f"at most {count}") for name, count in solutions.items()),
        ("not in it", LEFT_OUT),
    ]
    if case.rotating:
        rows.insert(1, ("load that turns", f"{in_newtons(case.rotating)}, once in {1e3 / case.speed:.4g} ms"))
    return rows, preparing.Work({}, solutions, steps, None, taken, pace * compiling.time_to_compile())


def _cells_over_faults(prepared: PreparedBearing) -> float:
    """Cells of all contacts that are solved over faults: by the laws, and with the faults alone.

    A law that solves every step asks for none on a ring.
    """
    case = prepared.case
    found = 0.0
    by_height = any(not spec_of(law).solved_every_step for law in case.laws)
    for number, surface in enumerate((*prepared.raceways, *prepared.balls)):
        contact, load = case.contacts[min(number, 1)]
        times = 2 if by_height or number >= len(RINGS) else 1
        found += times * OnRaceway(contact, surface, load).cells_over_faults
    return found


def bearing_rings(case: BearingUnderLoad) -> BearingRings:
    """Both rings with what they carry, on what holds them; they bend if the case says so."""
    angle = case.static.contact_angle
    inner, held = (
        Ring.rigid(
            keys.mass, angle, radial_stiffness=keys.radial_stiffness, axial_stiffness=keys.axial_stiffness,
            damping_ratio=keys.damping_ratio
        )
        for keys in (case.shaft, case.housing)
    )  # fmt: skip
    return BearingRings(inner, held, *case.bending_rings())


def cage_slip(case: BearingUnderLoad) -> Callable[[Array], Array]:
    """Slip of the cage at times (n,), s, drawn anew for each of its turns, and straight between these."""
    least, most = case.cage_slip
    rate = case.kinematics.cage
    turns = int(rate * (case.settling + case.duration)) + 3
    drawn = np.random.default_rng([case.seed, 7]).uniform(least, most, turns)
    return lambda at: np.interp((at + case.settling) * rate + 1.0, np.arange(turns), drawn)


def raceways_of(prepared: PreparedBearing, progress: Progress | None) -> list[OnRaceway]:
    """What a ball feels of the inner and the outer raceway, and their scans."""
    case = prepared.case
    of = prepared.case.bearing.bearing
    turning = prepared.case.kinematics
    passing = [2.0 * np.pi * abs(turning.cage - ring) for ring in (turning.inner, turning.outer)]
    each = zip(case.contacts, prepared.raceways, of.raceway_radii, passing, strict=True)
    return [
        OnRaceway(
            smooth, surface, load, case.contact_damping, of.hardness, cache=Store(), progress=progress,
            shortest=radius * pace / case.highest_frequency,
            parameters={law: case.law_parameters(law) for law in case.laws},
        )
        for (smooth, load), surface, radius, pace in each
    ]  # fmt: skip


def rolled(prepared: PreparedBearing, progress: Progress) -> dict[str, RolledBearing]:
    """Run the bearing by each law, at the sampling rate of the case."""
    case, of, ons = prepared.case, prepared.case.bearing.bearing, raceways_of(prepared, progress)
    looked_up = {name for name in case.laws if Need.SCAN in spec_of(name).needs}
    others = [name for name in case.laws if name not in looked_up]
    laws_of = [  # balls run forwards on the ring that stands still
        laws_on(on, others, balls=prepared.balls, forwards=ring != of.turning)
        for ring, on in zip(RINGS, ons, strict=True)
    ]
    smooth, load = case.contacts[1]
    averaged = [ball_heights(smooth, surface, load) for surface in prepared.balls]
    sensors: list[Sensor] = [("outer", angle, "radial") for angle in case.sensors]

    def surfaces() -> list[Array]:
        every = (*prepared.raceways, *prepared.balls)
        return [heights for each in every for heights in (each.heights, each.line, each.faults)]

    def once(law: str, inner: Any, outer: Any, duration: float = case.duration) -> RolledBearing:
        return roll_bearing(
            of, bearing_rings(case), inner, outer,
            speed=case.speed, radial=case.radial, axial=case.axial, rotating=case.rotating,
            duration=duration, time_step=case.step, settling=case.settling, slip=cage_slip(case),
            ball_heights=[] if isinstance(inner, list) else averaged,
            centrifugal=case.centrifugal, sensors=sensors,
            highest_frequency=case.highest_frequency, progress=progress,
            checkpoint=checkpoint_of(law, case, surfaces, Store()),
        )  # fmt: skip

    found = {}
    for name in case.laws:
        if name in looked_up:
            run = _within_scan(case, name, ons, once)
        else:
            run = once(name, *(of[name] for of in laws_of))
        every = case.steps_per_sample
        signals: dict[str, Any] = {each: thinned(getattr(run, each), every) for each in SIGNALS}
        signals |= {each: np.maximum(signals[each], getattr(run, each).min()) for each in FORCES}
        found[name] = replace(run, time=run.time[::every], cage=run.cage[::every], **signals)
    return found


DAMPED = 0.05
"""Share by which the force of a contact that is looked up may lie beside what its damping leaves of it."""
TRIED = 0.1
"""Share of the record after which it is asked first whether forces leave what was scanned."""


def _within_scan(
    case: BearingUnderLoad,
    law: str,
    ons: Sequence[OnRaceway],
    once: Callable[[str, Any, Any, float], RolledBearing],
) -> RolledBearing:
    """Run by a law in the states expected; where forces leave what was scanned, scan more and run anew."""
    loads = case.static.inner_load, case.static.outer_load
    states = [on.states_under(each.min(), each.max()) for on, each in zip(ons, loads, strict=True)]
    duration = max(TRIED * case.duration, case.step)
    while True:
        with PhysicsWarning.caught() as caught:
            inner, outer = (on.build(law, each) for on, each in zip(ons, states, strict=True))
            run = once(law, inner, outer, duration)
        wider = [
            on.wider(each, (1.0 - DAMPED) * least, (1.0 + DAMPED) * most)
            for on, each, (least, most) in zip(ons, states, run.reached, strict=True)
        ]
        if wider == states and duration == case.duration:
            break
        states = wider
        duration = case.duration
    for each in caught:
        warnings.warn(each.message, stacklevel=2)
    return run


FORCES = ("inner_force", "outer_force")
"""They begin and end at once, where the filter rings: none is written that is below all that were found."""
SIGNALS = (*FORCES, "ball_motion", "inner_motion", "outer_motion", "acceleration")
"""What a run holds over time, beside what grows evenly."""


def thinned(signal: Array, every: int) -> Array:
    """A signal (…, n) at one of so many samples, without what the fewer samples do not hold."""
    if every == 1:
        return signal
    from scipy.signal import resample_poly

    return np.asarray(resample_poly(signal, 1, every, axis=-1, padtype="line"))


# --- its result


def bearing_result(
    prepared: PreparedBearing,
    progress: Progress,
    caught: list[warnings.WarningMessage],
    *,
    brief: bool = False,
) -> xarray.DataTree:
    """Run a bearing by each of its laws and lay its result out, as `asperity.scenes.result` does others."""
    case = prepared.case
    began = time.monotonic()
    runs = rolled(prepared, progress)
    heard = heard_group(case, runs)
    apart = Values() if brief else alone(prepared, progress)
    runs = {name: steady_where_still(run) for name, run in runs.items()}
    found = list(bearing_findings(case, runs))
    warn_of_findings(found)
    scenario = scenario_group(case, _numerics(case, time.monotonic() - began))
    scenario[contact.VALIDITY] = [finding.row() for finding in found]
    at_rest = static_group(case.static, case.kinematics)
    levels = levels_group(case, runs)
    result = tree(scenario | at_rest | motion_group(case, runs) | heard | levels | apart)
    result.attrs = root_attributes(
        case,
        case.title,
        SOURCES,
        _verdict(heard, _deciding(apart), bool(case.faults)),
        caught,
        {NAMES[name]: f"{draw} on {radius:.6g} m, seed {case.seed}" for name, draw, radius in _draws(case)},
    )
    return result


def _draws(case: BearingUnderLoad) -> Iterator[tuple[str, str, float]]:
    """Parts whose surface is drawn, what is drawn, and their radius, m."""
    for name, keys, radius in _parts(case):
        if draw := keys.texture().draw:
            yield name, draw, radius


# --- at rest


def static_group(found: LoadedBearing, turning: Kinematics) -> Values:
    """Lay out how a bearing carries its load, and what turns how fast."""
    of = found.bearing
    along, across = np.transpose([found.semi_axes(ring) for ring in RINGS], (1, 0, 2, 3))

    def both(what: str) -> list[Array]:
        return [getattr(found, f"{ring}_{what}") for ring in RINGS]

    return {
        bearing.BALL: 1 + np.arange(of.balls),
        bearing.RING: list(RINGS),
        bearing.DIRECTION: list(DIRECTIONS),
        bearing.CAGE_ANGLE: found.azimuth[:, 0],
        bearing.AZIMUTH: found.azimuth,
        bearing.BALL_LOAD: both("load"),
        bearing.BALL_ANGLE: both("angle"),
        bearing.PEAK_PRESSURE: both("pressure"),
        bearing.SEMI_AXIS_ALONG: along,
        bearing.SEMI_AXIS_ACROSS: across,
        bearing.RING_DISPLACEMENT: found.displacement.T,
        bearing.RING_STIFFNESS: np.diagonal(found.stiffness, axis1=1, axis2=2).T,
        bearing.BALL_DIAMETER: of.ball_diameter,
        bearing.PITCH_DIAMETER: of.pitch_diameter,
        bearing.CONTACT_ANGLE: found.contact_angle,
        bearing.LEFT_OUT: LEFT_OUT,
        **tones_group(turning),
    }


def tones_group(turning: Kinematics) -> Values:
    """Lay out what turns how fast."""
    return {
        bearing.PART: list(PARTS),
        bearing.TONE: [turning.tone(part) for part in PARTS],
        bearing.MODULATION: [turning.modulation(part) for part in PARTS],
        bearing.TURNING: turning.turning,
        bearing.CAGE: turning.cage,
    }


# --- in time


def motion_group(case: BearingUnderLoad, runs: dict[str, RolledBearing]) -> Values:
    """Lay out what was recorded in time, at the sampling rate of the case."""
    (first, *_), balls = runs.values(), np.arange(case.bearing.bearing.balls)

    def stacked(name: str) -> Array:
        return np.stack([getattr(run, name) for run in runs.values()])

    return {
        rolling.LAW: list(runs),
        rolling.TIME: first.time,
        bearing.ROLLING_BALL: 1 + balls,
        bearing.ROLLING_RING: list(RINGS),
        bearing.ROLLING_DIRECTION: list(DIRECTIONS),
        bearing.ROLLING_SENSOR: case.sensors,
        bearing.BALL_AZIMUTH: first.cage + 2.0 * np.pi / len(balls) * balls[:, None],
        bearing.INNER_FORCE: stacked("inner_force"),
        bearing.OUTER_FORCE: stacked("outer_force"),
        bearing.BALL_MOTION: stacked("ball_motion"),
        bearing.RING_MOTION: np.stack([stacked(f"{ring}_motion") for ring in RINGS], axis=1),
        bearing.RING_ACCELERATION: stacked("acceleration"),
        schema.ENERGY_TERM: list(first.energy.shares),
        schema.ENERGY: [list(run.energy.shares.values()) for run in runs.values()],
        schema.ENERGY_RESIDUAL: [run.energy.residual for run in runs.values()],
    }


# --- what its acceleration says


def heard_group(case: BearingUnderLoad, runs: dict[str, RolledBearing]) -> Values:
    """Lay out velocities in bands at all sensors; spectrum, envelope and lines in it at the first one."""
    rate = case.sampling_rate
    signals = [run.acceleration for run in runs.values()]
    families = case.kinematics.families
    highest = REACH * HARMONICS * max(tone for tone, _ in families.values())
    low, high = case.envelope_band or diagnostics.impulsive_band(signals[0][0], rate, highest)
    lines = [diagnostics.amplitude_spectrum(law[0], rate) for law in signals]
    frequency = lines[0][0]
    kept = (frequency > 0.0) & (frequency <= case.highest_frequency)
    struck = [diagnostics.envelope_spectrum(law[0], rate, (low, high)) for law in signals]
    slip = max(case.cage_slip) + RESOLVED
    found = [diagnostics.explained_lines(each, families, slip=slip, harmonics=HARMONICS) for each in struck]
    clear = [diagnostics.clear_families(each, SILENT) for each in found]
    judged = [[band_velocities(one, rate, quantity="acceleration") for one in law] for law in signals]
    for n in (
        n for n, run in enumerate(runs.values()) if not run.vibrates
    ):  # what rounding leaves is no result
        lines[n], struck[n] = ((at, np.full_like(size, np.nan)) for at, size in (lines[n], struck[n]))
        judged[n] = [np.zeros_like(each) for each in judged[n]]
        found[n] = {
            part: replace(each, **{what: np.nan * getattr(each, what) for what in LINES.values()})
            for part, each in found[n].items()
        }
    return {
        spectra.LAW: list(runs),
        spectra.FREQUENCY: frequency[kept],
        bearing.VELOCITY_AMPLITUDE: [each[kept] / (2.0 * np.pi * frequency[kept]) for _, each in lines],
        bearing.SENSOR: case.sensors,
        bearing.JUDGED_BAND: [f"{first:g} to {last:g} Hz" for first, last in ISO_BANDS],
        bearing.BAND_VELOCITY: judged,
        bearing.ENVELOPE_LOW: low,
        bearing.ENVELOPE_HIGH: high,
        **envelope_group(list(runs), struck, found, clear, highest),
    }


def envelope_group(
    names: Sequence[str],
    struck: Sequence[Spectrum],
    found: Sequence[Mapping[str, LineFamily]],
    clear: Sequence[Sequence[str]],
    highest: float,
    units: str = bearing.ENVELOPE.units,
) -> Values:
    """Lay out spectra of envelopes by name up to a frequency, Hz, lines of the parts, and which are clear."""
    frequency = struck[0][0]
    within = frequency <= highest
    envelopes = np.array([each[within] for _, each in struck])
    return {
        bearing.LAW: names,
        bearing.ENVELOPE_FREQUENCY: frequency[within],
        bearing.ENVELOPE: bearing.ENVELOPE.variable(envelopes, units=units),
        bearing.HARMONIC: 1 + np.arange(HARMONICS),
        **{entry: [_of_lines(each, what) for each in found] for entry, what in LINES.items()},
        bearing.LINES_FOUND: [[float(part in each) for part in PARTS] for each in clear],
    }


LINES = {
    bearing.LINE_FREQUENCY: "frequency",
    bearing.LINE_AMPLITUDE: "amplitude",
    bearing.LINE_SIDE_BANDS: "side_bands",
}


def _of_lines(found: Mapping[str, LineFamily], what: str) -> list[Array]:
    """Numbers of the lines of each part (parts, harmonics), of side bands the larger; NaN if not reached."""
    values = [getattr(found[part], what) for part in PARTS]
    each = [value.max(axis=1) if value.ndim == 2 else value for value in values]
    return [np.pad(value, (0, HARMONICS - len(value)), constant_values=np.nan) for value in each]


def _verdict(heard: Values, deciding: Sequence[str], faulty: bool) -> str:
    """How quiet the bearing is, by what in each band, and which part is heard if it has faults.

    Without, beats of waves of the parts lie in the envelope, some of them where lines of others would.
    """
    velocities = heard[bearing.BAND_VELOCITY][0][0]
    told = ", ".join(
        f"{rounded(1e6 * rms)} µm/s in {band}{part}"
        for rms, band, part in zip(velocities, heard[bearing.JUDGED_BAND], deciding, strict=True)
        if np.isfinite(rms)
    )
    lines = zip(PARTS, heard[bearing.LINES_FOUND][0], heard[bearing.LINE_FREQUENCY][0], strict=True)
    parts = " and of the ".join(
        f"{NAMES[part]} ({rounded(at[0], 4)} Hz)" for part, found, at in lines if found
    )
    law = heard[bearing.LAW][0]
    lead = f"Radial velocity by {law}: {told or 'no band is sampled'}"
    if not np.nan_to_num(velocities).any() and told:
        lead = f"Nothing vibrates by {law}: all balls are carried alike, on surfaces without waves"
    struck = f" Its envelope has lines of {f'the {parts}' if parts else 'no part'}." if faulty else ""
    return f"{lead}.{struck} {LEFT_OUT}"


# --- which part makes it so


def alone(prepared: PreparedBearing, progress: Progress) -> Values:
    """Velocities with what is on each part alone, and on none, by `BY_PARTS`."""
    case = prepared.case
    textured = [key for key in ON if getattr(case, key).given()]
    if not textured:
        return {}
    names = ["perfect surfaces", *(ON[key] for key in textured)]
    found = list[Array]()
    if len(case.faults) > 1:
        names[-1] = "the faults"
    for kept in (None, *textured):
        others = case.with_(laws=[BY_PARTS], **{key: None for key in textured if key != kept})
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", PhysicsWarning)  # of the whole bearing it has been warned
            (run,) = rolled(prepare_bearing(others), progress).values()
        found.append(band_velocities(run.acceleration[0], case.sampling_rate, quantity="acceleration"))
        found[-1] *= run.vibrates
    held = bearing.ALONE_VELOCITY.variable(np.array(found), law=BY_PARTS)
    return {bearing.SOURCE: names, bearing.ALONE_VELOCITY: held}


def _deciding(apart: Values) -> list[str]:
    """Which part makes most of each band, in brackets after a blank; empty where none is known to."""
    found = [""] * len(ISO_BANDS)
    if apart:
        names = apart[bearing.SOURCE]
        velocities = apart[bearing.ALONE_VELOCITY].values
        for band, energy in enumerate(velocities.T**2):
            if np.isfinite(energy).all():
                parts = np.append(energy[0], np.maximum(energy[1:] - energy[0], 0.0))
                share = percent(float(parts.max() / parts.sum()))
                found[band] = f" ({share} from {names[int(parts.argmax())]})"
    return found


# --- how it was computed


def _numerics(case: BearingUnderLoad, wall: float) -> Iterator[tuple[str, str]]:
    """Numbers of the computation: names and values."""
    yield "time step", f"{rounded(case.step * 1e6, 4)} µs"
    yield "time steps per sample that is written", f"{case.steps_per_sample}"
    yield "resonance of the most loaded ball between the rings", f"{rounded(case.ball_resonance, 4)} Hz"
    yield "imbalance of the static solution", f"{rounded(case.static.imbalance, 1)} of the load"
    yield "wall time", f"{wall:.2f} s"
