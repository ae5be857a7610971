"""A ball bearing of a case laid ready: what is on its parts, its rings, how much work it is; and its runs."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from asperity.arguments import Array
from asperity.case.ball_bearing import BallBearingCase
from asperity.errors import InputError, PhysicsWarning
from asperity.laws import Law, Need, spec_of
from asperity.progress import Progress
from asperity.rolling.bearing import BearingRings, RolledBearing, Sensor, roll_bearing
from asperity.scenarios import preparing, reducing
from asperity.scenarios.raceway_laws import ball_heights, raceway_laws, raceway_on, raceway_with_balls
from asperity.store import Store
from asperity.structures.ball_bearing import PARTS
from asperity.structures.ring import Ring
from asperity.surfaces.raceway import Raceway

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
STEP_TIME, SOLUTION_TIME = 1e-6, 1e-3
"""Times of a step of one ball, and of a contact of a scan, s."""
SEEDS = 1000
"""Seeds of the parts of a bearing lie beside each other, and no two bearings share any."""


@dataclass(frozen=True, eq=False)
class PreparedBearing:
    """A case of a bearing that can be computed."""

    case: BallBearingCase
    raceways: tuple[Raceway, Raceway]  # inner and outer one
    balls: tuple[Raceway, ...]  # their surfaces; none where all are smooth
    caught: tuple[warnings.WarningMessage, ...]  # warnings met on the way


def prepare_bearing(case: BallBearingCase, source: str = "case") -> PreparedBearing:
    """Load the bearing at rest and lay out what is on its parts; refuse what cannot be."""
    errors, made, of = list[InputError](), list[Raceway](), case.bearing.bearing
    parts = [("inner", case.inner_raceway, of.raceway_radii[0])]
    parts += [("outer", case.outer_raceway, of.raceway_radii[1])]
    parts += [("ball", case.balls, 0.5 * of.ball_diameter)] * of.balls * (not case.has_smooth_balls)
    with PhysicsWarning.caught() as caught:
        case.loaded()
        for number, (name, keys, radius) in enumerate(parts):
            contact, load = case.contacts[min(number, 1)]  # of balls those with the outer ring
            on_it = (each for each in case.faults.values() if each.lies_on(name, number - 1))
            faults = [each.fault for each in on_it if each.fault]
            seed = SEEDS * case.seed + number
            try:
                made.append(raceway_on(contact, load, radius, keys.texture(), faults, seed=seed))
            except InputError as error:
                errors.append(error.about(f"{NAMES[name]}: {error.what}"))
    preparing.refuse(errors, source)
    return PreparedBearing(case, (made[0], made[1]), tuple(made[2:]), tuple(caught))


def expected(prepared: PreparedBearing) -> tuple[list[tuple[str, str]], preparing.Work]:
    """What will be computed, in words, and how much work it is; coarsely, as nothing is solved for that."""
    case, turning, found = prepared.case, prepared.case.kinematics, prepared.case.static
    steps = round((case.settling + case.duration) / case.step)
    textured = sum(bool(getattr(case, key).given()) for key in ON)
    runs, solutions = len(case.laws) + textured + (textured > 0), {}
    for name, surface in zip(RINGS, prepared.raceways, strict=True):
        rough = np.count_nonzero((surface.heights + surface.faults).any(axis=1))
        if rough and any(Need.SCAN in spec_of(law).needs for law in case.laws):
            solutions[f"scan of the {NAMES[name]}"] = int(rough) * reducing.STATES
    for law in (law for law in case.laws if spec_of(law).solved_every_step):
        solutions[law] = steps * int(found.touching.max() + found.bearing.balls)
    seconds = preparing.START_TIME + STEP_TIME * steps * found.bearing.balls * runs
    tones = ", ".join(f"{NAMES[part]} {turning.tone(part):.4g} Hz" for part in PARTS)
    load, angle = max(load for _, load in case.contacts), np.degrees(found.contact_angle)
    touching, at_rest = (each.static.touching for each in (case, case.with_(centrifugal=False)))
    held = f"{touching.mean():.3g} of {found.bearing.balls} on average, {touching.min():.0f} or more"
    rows = [
        ("heaviest load of a ball", f"{load:.4g} N, contact angle {angle:.3g}°"),
        ("balls that touch both rings", f"{held}; at rest {at_rest.mean():.3g}"),
        ("tones", f"{tones}; cage {turning.cage:.4g} Hz"),
        ("time", f"{steps} steps of {case.step * 1e6:.4g} µs, {case.settling:g} s of them before the record"),
        ("runs", f"{', '.join(case.laws)}, and {runs - len(case.laws)} by areal with parts alone"),
        *((f"contact solutions, {name}", f"at most {count}") for name, count in solutions.items()),
        ("not in it", LEFT_OUT),
    ]
    return rows, preparing.Work({}, solutions, steps, None, seconds + SOLUTION_TIME * sum(solutions.values()))


def bearing_rings(case: BallBearingCase) -> BearingRings:
    """Both rings with what they carry, on what holds them; they bend if the case says so."""
    angle, outer, of = case.static.contact_angle, case.housing, case.bearing.bearing
    inner, held = (
        Ring.rigid(
            keys.mass, angle, radial_stiffness=keys.radial_stiffness, axial_stiffness=keys.axial_stiffness,
            damping_ratio=keys.damping_ratio
        )
        for keys in (case.shaft, outer)
    )  # fmt: skip
    if outer.lobes is None:
        return BearingRings(inner, held, case.shaft.bending(angle), outer.bending(angle))
    radius = of.raceway_radii[1] + 0.5 * outer.thickness
    mass = of.material.density * 2.0 * np.pi * radius * outer.width * outer.thickness
    stiffness = of.material.youngs_modulus * outer.width * outer.thickness**3 / 12.0
    lobes: dict[str, Any] = {"most_lobes": outer.lobes, "damping_ratio": outer.damping_ratio}
    bending = Ring.bending(mass, radius, stiffness, angle, **lobes)
    return BearingRings(inner, held, case.shaft.bending(angle), bending)


def cage_slip(case: BallBearingCase) -> Callable[[Array], Array]:
    """Slip of the cage at times (n,), s, drawn anew for each of its turns, and straight between these."""
    least, most = case.cage_slip
    rate = case.kinematics.cage
    turns = int(rate * (case.settling + case.duration)) + 3
    drawn = np.random.default_rng([case.seed, 7]).uniform(least, most, turns)
    return lambda at: np.interp((at + case.settling) * rate + 1.0, np.arange(turns), drawn)


def rolled(prepared: PreparedBearing, progress: Progress) -> dict[str, RolledBearing]:
    """Run the bearing by each law, at the sampling rate of the case."""
    case, store = prepared.case, Store()
    keys: dict[str, Any] = {"damping": case.contact_damping, "hardness": case.bearing.bearing.hardness}
    contacts = list(zip(RINGS, case.contacts, prepared.raceways, strict=True))
    laws_of = [
        raceway_laws(case.laws, smooth, surface, load, cache=store, progress=progress, **keys)
        for _, (smooth, load), surface in contacts
    ]
    smooth, load = case.contacts[1]
    averaged = [ball_heights(smooth, surface, load) for surface in prepared.balls]
    sensors: list[Sensor] = [("outer", angle, "radial") for angle in case.sensors]
    found = {}
    for name in case.laws:
        laws: list[Law | list[Law]] = [built[name] for built in laws_of]
        heights = averaged
        if prepared.balls and spec_of(name).solved_every_step:
            turning, heights = case.bearing.bearing.turning, []
            laws = [
                raceway_with_balls(smooth, surface, prepared.balls, load, forwards=ring != turning, **keys)
                for ring, (smooth, load), surface in contacts
            ]
        run = roll_bearing(
            case.bearing.bearing, bearing_rings(case), *laws,
            speed=case.speed, radial=case.radial, axial=case.axial, duration=case.duration,
            time_step=case.step, settling=case.settling, slip=cage_slip(case), ball_heights=heights,
            centrifugal=case.centrifugal, sensors=sensors, highest_frequency=case.highest_frequency,
            progress=progress
        )  # fmt: skip
        every = case.steps_per_sample
        signals: dict[str, Any] = {each: thinned(getattr(run, each), every) for each in SIGNALS}
        found[name] = replace(run, time=run.time[::every], cage=run.cage[::every], **signals)
    return found


SIGNALS = ("inner_force", "outer_force", "ball_motion", "inner_motion", "outer_motion", "acceleration")
"""What a run holds over time, beside what grows evenly."""


def thinned(signal: Array, every: int) -> Array:
    """A signal (…, n) at one of so many samples, without what the fewer samples do not hold."""
    if every == 1:
        return signal
    from scipy.signal import resample_poly

    return np.asarray(resample_poly(signal, 1, every, axis=-1, padtype="line"))
