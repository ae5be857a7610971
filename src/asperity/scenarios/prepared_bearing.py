"""A ball bearing laid ready: what is on its parts, what its balls roll over, and what is to be computed."""

import math
import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np

from asperity.arguments import one_of
from asperity.case.ball_bearing import BearingUnderLoad
from asperity.case.bearing_sections import AroundKeys
from asperity.errors import InputError, PhysicsWarning
from asperity.laws import Law, Need, spec_of
from asperity.progress import Progress
from asperity.scenarios import compiling, preparing, reducing, run_time
from asperity.scenarios.doubts import doubt_bearing
from asperity.scenarios.problems import refuse
from asperity.scenarios.raceway_films import films_on
from asperity.scenarios.raceway_grids import raceway_on
from asperity.scenarios.raceway_laws import OnRaceway, doubt_faults
from asperity.scenarios.raceway_limits import doubt_fault, doubt_rise, doubt_surface
from asperity.scenarios.roller_raceways import on_surface
from asperity.speeds import at_fastest, slowest
from asperity.store import Store
from asperity.structures.bearing_statics import doubt_speed
from asperity.structures.rolling_bearing import PARTS, RollingBearing
from asperity.surfaces.raceway import Raceway
from asperity.written_numbers import in_newtons, rounded

RINGS = ("inner", "outer")
NAMES = {"outer": "outer raceway", "inner": "inner raceway", "ball": "balls"}


def names_in(bearing: RollingBearing) -> dict[str, str]:
    """Names of the parts of a bearing: what rolls in it is balls or rollers."""
    return NAMES | {"ball": f"{bearing.ELEMENT}s"}


ON = {
    "inner_raceway": "the inner raceway",
    "outer_raceway": "the outer raceway",
    "balls": "the balls",
    "fault": "the fault",
}
"""Sections of a case that say what is on a part."""
STEP_TIME = {"ball": 2.0e-6, "roller": 1.75e-6}
"""Processor time of a step of a ball or a roller with its record and spectra, s; rollers by seven runs."""
TILTED = 2.4
"""Times as long where slices are summed in every step; by three runs."""
SOLUTION_TIME = 1e-3
"""Processor time of a contact of a scan, s."""
CELL_TIME = 3.5e-8
"""Time of a contact under a load over a fault, for each of its cells, s."""
SEEDS = 1000
"""Seeds of the parts of a bearing lie beside each other, and no two bearings share any."""


def named_on(case: BearingUnderLoad, section: str) -> str:
    """What a section of a case is about that says what is on a part."""
    return f"the {names_in(case.bearing.bearing)['ball']}" if section == case.called("balls") else ON[section]


@dataclass(frozen=True, eq=False)
class PreparedBearing:
    """A case of a bearing that can be computed."""

    case: BearingUnderLoad
    raceways: tuple[Raceway, Raceway]  # inner and outer one
    balls: tuple[Raceway, ...]  # their surfaces; none where all are smooth
    caught: tuple[warnings.WarningMessage, ...]  # warnings met on the way
    asked: tuple[Any, ...]  # what each of these surfaces was made of: raceways, then balls

    def surface_of(self, asked: Any) -> Raceway | None:
        """The surface that was made of the same, if one was."""
        made = zip(self.asked, (*self.raceways, *self.balls), strict=True)
        return next((surface for of, surface in made if of == asked), None)

    @property
    def chosen(self) -> dict[str, str]:
        """Keys that were chosen for it: none."""
        return {}


def bearing_parts(case: BearingUnderLoad) -> list[tuple[str, Any, float]]:
    """Names of inner and outer raceway and of balls, their sections, and their radii, m."""
    of = case.bearing.bearing
    return [
        ("inner", case.inner_raceway, of.raceway_radii[0]),
        ("outer", case.outer_raceway, of.raceway_radii[1]),
        ("ball", case.elements, 0.5 * of.ball_diameter),
    ]


def prepare_bearing(
    case: BearingUnderLoad, source: str = "case", beside: PreparedBearing | None = None
) -> PreparedBearing:
    """Load the bearing at rest and lay out what is on its parts; refuse what cannot be.

    Surfaces that one beside it has, too, are taken from there.
    """
    errors = list[InputError]()
    made = list[Raceway]()
    of_surfaces = list[Any]()
    of = case.bearing.bearing
    *parts, balls = bearing_parts(case)
    parts += [balls] * of.balls * (not case.has_smooth_balls)
    with PhysicsWarning.caught() as caught:
        case.loaded()
        doubt_speed(of, case.speed)
        doubt_bearing(case)
        for number, (name, keys, radius) in enumerate(parts):
            contact, load = case.contacts[min(number, 1)]  # of balls those with the outer ring
            on_it = [each for each in case.faults.values() if each.lies_on(name, number - 1)]
            faults = [each.fault for each in on_it if each.fault]
            seed = SEEDS * case.seed + number
            of_surfaces.append((contact, load, radius, keys, on_it, seed))
            known = beside and beside.surface_of(of_surfaces[-1])
            try:
                made.append(known or raceway_on(contact, load, radius, keys.texture(), faults, seed=seed))
                doubt_surface(made[-1], contact.approach(load), of.ELEMENT)
            except InputError as error:
                errors.append(_by_key(case, name, keys, error))
            apart = 2.0 * np.pi * radius / of.balls
            part = NAMES.get(name, of.ELEMENT)
            for fault in faults:
                doubt_rise(fault, contact.approach(load), part, of.ELEMENT)
                if name != "ball":
                    doubt_fault(fault, apart, part, of.ELEMENT)
    refuse(errors, source)
    return PreparedBearing(case, (made[0], made[1]), tuple(made[2:]), tuple(caught), tuple(of_surfaces))


def _by_key(case: BearingUnderLoad, part: str, keys: AroundKeys, error: InputError) -> InputError:
    """An error about what is on a part, by the key of the case that it is about."""
    section = case.called("balls") if part == "ball" else f"{part}_raceway"
    what, _, of = error.what.partition(" of the fault")
    if of:
        damaged = (name for name, each in case.faults.items() if each.part == part)
        return error.about(f"{next(damaged, 'fault')}.{what}")
    heights = ("waviness", "amplitudes", "trace", "roughness", "map")
    sources = {"rms slope": heights[::-1], "waves per turn": ("last_order", "waves")}
    given = (name for name in (error.what, *sources.get(error.what, heights)) if name in keys.given_names)
    told = error.received if error.what in keys.keys else f"{error.received} ({error.what})"
    return error.about(f"{section}.{next(given, 'waviness')}", told)


def raceways_of(prepared: PreparedBearing, progress: Progress | None) -> list[OnRaceway]:
    """What a ball feels of the inner and the outer raceway, and their scans."""
    case = prepared.case
    of = prepared.case.bearing.bearing
    share = slowest(case.speed) / case.speed
    of_rings = case.contacts, prepared.raceways, case.dampings, case.passing_speeds, _least(case)
    return [
        on_surface(
            smooth, surface, load, damping=damping, hardness=of.hardness,
            cache=Store(), progress=progress,
            shortest=share * speed / case.highest_frequency, least_load=least,
            parameters={law: case.law_parameters(law) for law in case.laws},
        )
        for (smooth, load), surface, damping, speed, least in zip(*of_rings, strict=True)
    ]  # fmt: skip


def _least(case: BearingUnderLoad) -> tuple[float, float]:
    """Least static load of a ball or roller on the inner and on the outer raceway, N."""
    return float(case.static.inner_load.min()), float(case.static.outer_load.min())


def law_on_raceway(prepared: PreparedBearing, name: str, ring: str) -> Law:
    """A law on the inner or the outer raceway, without the texture of a ball."""
    return raceways_of(prepared, None)[RINGS.index(one_of("ring", ring, RINGS))].build(name)


def planned_bearing(prepared: PreparedBearing, progress: Progress) -> preparing.Plan:
    """Plan a bearing; nothing is solved for that but contacts over faults, where they are few."""
    rows, work = expected(prepared)
    if work.time.parts["contacts over the faults"] <= preparing.LONG:
        for on in raceways_of(prepared, progress):
            doubt_faults(on, [spec_of(name) for name in prepared.case.laws])
    return preparing.Plan([*rows, ("work", work.told)], work)


def expected(prepared: PreparedBearing) -> tuple[list[tuple[str, str]], preparing.Work]:
    """What will be computed, in words, and how much work it is; coarsely, as nothing is solved for that."""
    case = prepared.case
    turning = case.kinematics
    found = case.static
    steps = case.steps_taken
    textured = sum(bool(getattr(case, case.called(key)).given()) for key in ON)
    runs = len(case.laws) + textured + (textured > 0)
    solutions = _contact_solutions(prepared)
    cells = _cells_at_rims(prepared)
    rolled_once = STEP_TIME[found.bearing.ELEMENT] * steps * found.bearing.balls
    rolled_once *= TILTED if case.tilts else 1.0
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
    tones = ", ".join(
        f"{names_in(found.bearing)[part]} {rounded(turning.tone(part), 4)} Hz" for part in PARTS
    )
    load = max(load for _, load in case.contacts)
    angle = np.degrees(found.contact_angle)
    touching, at_rest = (each.static.touching for each in (case, case.with_(centrifugal=False)))
    held = f"{rounded(touching.mean())} of {found.bearing.balls} on average, {touching.min():.0f} or more"
    alone = f", and {runs - len(case.laws)} by areal with parts alone" if textured else ""
    fastest = at_fastest(case.speed, "1/min", 60.0)
    rows = [
        (
            f"heaviest load of a {found.bearing.ELEMENT}",
            f"{in_newtons(load)}, contact angle {rounded(angle)}°",
        ),
        (f"{found.bearing.ELEMENT}s that touch both rings", f"{held}; at rest {rounded(at_rest.mean())}"),
        ("tones", f"{tones}; cage {rounded(turning.cage, 4)} Hz{fastest}"),
        (
            "time",
            f"{steps} steps of {rounded(case.step * 1e6, 4)} µs, {case.settling:g} s of them "
            "before the record",
        ),
        ("runs", ", ".join(case.laws) + alone),
        *((f"contact solutions, {name}", f"at most {count}") for name, count in solutions.items()),
        *rims_in_words(prepared),
        *films_in_words(prepared),
        ("not in it", omitted_from(case)),
    ]
    if case.tilts:
        rows.insert(1, ("tilt of the inner ring", _tilt_in_words(case)))
    if case.rotating:
        rows.insert(
            1, ("load that turns", f"{in_newtons(case.rotating)}, once in {1e3 / case.speed:.4g} ms{fastest}")
        )
    compiled = pace * compiling.time_to_compile(*{"whole", *cells.values()})
    return rows, preparing.Work({}, solutions, steps, None, taken, compiled)


def _contact_solutions(prepared: PreparedBearing) -> dict[str, int]:
    """How many contacts are solved, by the scan or the law that does it."""
    case = prepared.case
    solutions = {}
    for name, on in zip(RINGS, raceways_of(prepared, progress=None), strict=True):
        rough = np.count_nonzero((on.surface.heights + on.surface.faults).any(axis=1))
        if rough and any(Need.SCAN in spec_of(law).needs for law in case.laws):
            positions = math.ceil(int(rough) / on.scanned_stride)
            solutions[f"scan of the {NAMES[name]}"] = positions * reducing.STATES
    for law in (law for law in case.laws if spec_of(law).solved_every_step):
        solutions[law] = case.steps_taken * int(case.static.touching.max() + case.static.bearing.balls)
    return solutions


def _cells_at_rims(prepared: PreparedBearing) -> dict[str, str]:
    """How cells at rims count on raceways, by their names, where a law sees heights."""
    if not any(spec_of(law).sees_heights for law in prepared.case.laws):
        return {}
    ons = zip(RINGS, raceways_of(prepared, progress=None), strict=True)
    return {NAMES[name]: on.seen.cells for name, on in ons}


def rims_in_words(prepared: PreparedBearing) -> list[tuple[str, str]]:
    """How cells at rims count on each raceway; none where no law sees heights."""
    return [("cells at rims", f"{kind} on the {name}") for name, kind in _cells_at_rims(prepared).items()]


def _tilt_in_words(case: BearingUnderLoad) -> str:
    """How far the inner ring is tilted, and which moment holds it at rest where that is most."""
    told = [rounded(1e3 * each, 4) + " mrad" for each in case.tilts.values()]
    turning = f"{told[0]} and {told[1]} that turns" if case.tilts["rotating_tilt"] else told[0]
    rollers: Any = case.static
    if case.held.get("tilt_stiffness"):
        turning += f", as the shaft gives way from {rounded(1e3 * case.held['tilt'], 4)} mrad"
    return f"{turning}; {rounded(rollers.moment[:, 0].mean())} N m hold it in the plane of the load"


def films_in_words(prepared: PreparedBearing) -> list[tuple[str, str]]:
    """How thick films are, what they leave to asperities, what is outside of their fit; none without oil."""
    case = prepared.case
    found = films_on(case, prepared.raceways, prepared.balls)
    if not found:
        return []
    oil = found[0].film
    rows = [
        (
            "oil",
            f"{rounded(1e3 * oil.viscosity)} mPa s at {case.lubricant.temperature:g} °C, pressure-viscosity "
            f"coefficient {rounded(1e9 * oil.pressure_viscosity)} 1/GPa",
        )
    ]
    rows += [
        (f"film, {ring} ring, {in_newtons(each.load)}{at_fastest(case.speed, '1/min', 60.0)}", each.in_words)
        for ring, each in zip(RINGS, found, strict=True)
    ]
    outside = [f"{ring} ring: {', '.join(each.outside)}" for ring, each in zip(RINGS, found, strict=True)]
    if any(each.outside for each in found):
        rows.append(("film outside of its fit", "; ".join(outside)))
    return rows


def omitted_from(case: BearingUnderLoad) -> str:
    """What is not in the computation of a bearing, with oil or without."""
    of = case.bearing.bearing
    return str(of.LEFT_OUT if case.films is None else of.LEFT_OUT_OILED)


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
        found += times * on_surface(contact, surface, load).cells_over_faults
    return found
