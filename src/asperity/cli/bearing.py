"""``asperity bearing``: how a bearing carries a load, its tones, and which of them its signal holds."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from asperity.case.loaded_bearing import LoadKeys, bearing_of_run, read_bearing
from asperity.cli.bearing_films import say_films
from asperity.cli.bearing_table import write_table
from asperity.cli.bearing_tolerances import say_tolerances
from asperity.cli.heard import heard
from asperity.diagnostics.diagnosis import part_name
from asperity.errors import InputError
from asperity.files import write_bytes
from asperity.reference.bearings import COLUMNS, LISTED, PITCH, TONES, by_citation, named_bearings
from asperity.reporting.figure import write_chart
from asperity.scenes.bearing_at_rest import static_group
from asperity.scenes.figures.bearing import ball_contacts_table, load_zone
from asperity.schema import tree
from asperity.structures.bearing_creepage import flank_spin
from asperity.structures.bearing_statics import LoadedBearing, doubt_speed
from asperity.structures.roller_bearing import PRINTED, ROLLER_BEARINGS, AnyBearing, RollerBearing
from asperity.structures.roller_statics import LoadedRollers
from asperity.structures.rolling_bearing import PARTS, Kinematics
from asperity.terminal import say, say_table
from asperity.written_numbers import rounded

WIDTH = 122
TOLD = ("balls", "displacement", "stiffness", "imbalance", "films", "tones", "speed", "speed_is", "tacho",
        "band", "lines", "faults", "confidence", "resolution", "turns", "doubts", "signals", "verdict",
        "catalogue", "tolerances")  # fmt: skip
"""Names of what is said to programs."""
OPTIONS = ("radial", "axial", "tilt", "speed", "clearance", "contact_damping")
"""Keys of a bearing and its load that are options, too."""
OIL = ("oil", "temperature")
"""Those of its lubricant."""
FLANKS = ("inner_loads", "outer_loads", "inner_angles", "outer_angles")
"""What is said to programs of each flank of an arch."""
MEANINGS = {
    "outer": "BPFO: {}s pass a spot of it",
    "inner": "BPFI: {}s pass a spot of it",
    "ball": "2 BSF: a spot of it meets a ring",
}


def show_bearing(
    bearing: str | None,
    signal: Sequence[Path],
    more: Sequence[Path],
    picture: Path | None,
    *,
    listed: bool = False,
    table: Path | None = None,
    sheet: Path | None = None,
    limits: str | None = None,
    cage_angle: str | None = None,
    load_direction: str | None = None,
    outer_mass: str | None = None,
    **choices: Any,
) -> dict[str, Any]:
    """Print what a bearing does under its load, or what its signals say, and draw it; return the numbers.

    Or list all bearings that have a name, write the stiffness over load and speed to a `table`, or say how
    large waves may be for `limits` of the bands. `more` are signals behind the first one.
    """
    options = {name: choices.pop(name, None) for name in OPTIONS}
    oil = {name: value for name in OIL if (value := choices.pop(name, None)) is not None}
    options["lubricant"] = oil or None
    if listed:
        return _listed()
    if bearing is None:
        raise InputError("bearing", "none", "a NAME or a FILE", named_bearings())
    if more and not signal:
        received = " and ".join([bearing, *map(str, more)])
        raise InputError("bearing", received, "one", "Files of signals follow --signal.")
    for_table = {"cage-angle": cage_angle, "load-direction": load_direction}
    for_table["damping"] = options["contact_damping"]
    looks_elsewhere = bool(signal) or picture is not None
    _refuse_mixed("--table", table, for_table, looks_elsewhere or limits is not None)
    _refuse_mixed("--limits", limits, {"outer-mass": outer_mass}, looks_elsewhere)
    if oil and (signal or any(each is not None for each in (table, limits, sheet))):
        raise InputError("--oil", "a signal, table, sheet or limits with it", "load and speed alone")
    if table is not None:
        told = write_table(bearing, options, table, cage_angle, load_direction)
        return {"bearing": bearing, **dict.fromkeys(TOLD), **told}
    _refuse_mixed("--sheet", sheet, {}, looks_elsewhere or limits is not None or table is not None)
    if sheet is not None:
        return {"bearing": bearing, **dict.fromkeys(TOLD), **_write_sheet(bearing, options, sheet)}
    if limits is not None:
        waves = say_tolerances(bearing, options, limits, outer_mass)
        return {"bearing": bearing, **dict.fromkeys(TOLD), "tolerances": waves}
    keys = read_bearing(bearing, options)
    name = keys.name or bearing
    say(f"{name}: {_in_words(keys.bearing)}")
    if keys.name:
        say(PRINTED.get(keys.name) or LISTED[keys.name].sentence)
    told = heard(keys, (*signal, *more), picture, **choices) if signal else _carried(keys, picture)
    if picture is not None:
        told["files"] = {"picture": picture}
    return {"bearing": name, **dict.fromkeys(TOLD), **told}


def _in_words(of: AnyBearing) -> str:
    """What a bearing is made of, in a line."""
    rolling = f"{of.ball_diameter * 1e3:.4g}"
    pitch = f"pitch diameter {of.pitch_diameter * 1e3:.4g} mm"
    clearance = f"clearance {rounded(of.radial_clearance * 1e6)} µm"
    angle = f"contact angle {rounded(math.degrees(of.free_angle))}°"
    if isinstance(of, RollerBearing):
        crowning = f"{of.crowning} profile" + f" of {rounded(of.profile.drop * 1e6)} µm" * (
            of.profile.drop > 0.0
        )
        if of.taper:
            angle += f", taper {rounded(math.degrees(of.taper))}°, its rib {of.rib}"
        return (
            f"{of.rollers} rollers of {rolling} × {of.roller_length * 1e3:.4g} mm, {crowning}, {pitch}, "
            f"{clearance}, {angle}"
        )
    grooves = f"grooves of {of.inner_conformity:g} D (inner) and {of.outer_conformity:g} D (outer)"
    if of.arch_angle is not None:
        grooves += f", gothic arches of {rounded(math.degrees(of.arch_angle), 4)}°"
    return f"{of.balls} balls of {rolling} mm, {pitch}, {grooves}, {clearance}, free {angle}"


def _write_sheet(source: str, options: Mapping[str, Any], sheet: Path) -> dict[str, Any]:
    """Write the data sheet of a bearing, or of a run with what its parts make in the bands."""
    from asperity.running import open_result
    from asperity.scenes.bearing_sheet import bearing_sheet

    if sheet.suffix.lower() != ".html":
        raise InputError("--sheet", f"'{sheet}'", "a name that ends in .html")
    run = open_result(source) if Path(source).is_dir() or source.endswith(".nc") else None
    keys = read_bearing(source, options) if run is None else bearing_of_run(run.attrs["case"], source)
    doubt_speed(keys.bearing, float(keys.speed or 0.0))
    text = bearing_sheet(keys.name or Path(source).stem, keys, run)
    written = write_bytes(sheet, text.encode()).resolve()
    say(f"Data sheet: {written}")
    return {"files": {"sheet": written}}


def _refuse_mixed(name: str, given: object, belonging: Mapping[str, object], looks_elsewhere: bool) -> None:
    """Refuse an option beside others that it leaves no room for, and what belongs to it without it."""
    alone = [(option, value) for option, value in belonging.items() if value is not None]
    if given is None and alone:
        raise InputError(f"--{alone[0][0]}", f"'{alone[0][1]}'", f"{name} with it")
    if given is not None and looks_elsewhere:
        raise InputError(name, "a signal, a picture or another table with it", "load and speed alone")


def _listed() -> dict[str, Any]:
    """Print all bearings that have a name, source by source; return them."""
    for citation, prints, group in by_citation(LISTED.values()):
        say_table(f"{citation}. Printed: {prints}.", COLUMNS, [each.cells for each in group], width=WIDTH)
    say(PITCH)
    say("Nobody prints radii of grooves or clearances of mounted bearings: 0.52 D and 10 µm unless given.")
    say(f"Roller bearings: {', '.join(ROLLER_BEARINGS)}.")
    known = [
        {**asdict(each), "tones": dict(zip(TONES, each.tones, strict=False))} for each in LISTED.values()
    ]
    return {"bearing": None, **dict.fromkeys(TOLD), "catalogue": known}


# --- what it carries


def _carried(keys: LoadKeys, picture: Path | None) -> dict[str, Any]:
    speed = keys.speed or 0.0
    if keys.lubricant.found is not None and not speed:
        raise InputError(
            "speed", "none of a bearing with oil", "that at which its films are, as '1800 1/min'"
        )
    doubt_speed(keys.bearing, speed)
    if keys.held.get("tilt") and not keys.is_loaded:
        raise InputError("tilt", "a tilt without a load", "a load beside it, as --radial '1 kN'")
    if not (keys.is_loaded or keys.lubricant.found or picture):
        return _rolling(keys.bearing, speed)
    found = keys.loaded()
    load = f"{rounded(found.radial, 4)} N radial, {rounded(found.axial, 4)} N axial"
    turning = keys.bearing.kinematics(speed or 1.0, contact_angle=found.contact_angle)
    at_rest = tree(static_group(found, turning))
    contacts = ball_contacts_table(at_rest)
    cells = [[cell.text for cell in row] for row in contacts.rows]
    say_table(f"{contacts.title} under {load}", contacts.head, cells, width=WIDTH)
    say(contacts.note)
    ends = dict.fromkeys(f"{each:.0f}" for each in (found.touching.min(), found.touching.max()))
    of = found.bearing
    say(f"{' to '.join(ends)} of {of.balls} {of.ELEMENT}s touch the inner ring while the cage turns.")
    if isinstance(found, LoadedRollers):
        carrying = (
            f"{rounded(1e3 * found.carrying_length[found.heaviest])} of {rounded(1e3 * of.roller_length)} mm"
        )
        say(f"Of the roller that carries most {carrying} touch the inner ring; {_tilted(found)}.")
        _say_rubbing(keys, found)
    elif isinstance(found, LoadedBearing) and of.arches:
        _say_flanks(found, turning)
    films = say_films(keys, found)
    tones = _say_tones(of, turning, speed)
    say(f"Balance to {rounded(found.imbalance, 1)} of the load.")
    if picture is not None:
        write_chart(load_zone.drawn(at_rest).chart, f"{keys.name or 'bearing'}, {load}", picture)
        say(f"Picture: {picture.resolve()}")
    names = ("azimuth", "inner_load", "outer_load", "inner_angle", "inner_pressure", "outer_pressure")
    balls = {name: getattr(found, name)[0] for name in names}
    if isinstance(found, LoadedBearing) and of.arches:
        balls |= {name: getattr(found, name)[0] for name in FLANKS}
    if isinstance(found, LoadedRollers) and found.bearing.taper:
        balls["rib_force"] = found.rib_force[0]
        if friction := getattr(keys, "friction", None):
            balls["rib_torque"] = found.rib_torque(friction)[0]
    ring = {"displacement": found.displacement, "stiffness": found.stiffness, "imbalance": found.imbalance}
    return {"balls": balls, **ring, "films": films, "tones": tones}


def _tilted(found: LoadedRollers) -> str:
    """How the inner ring is held against tilt, and rollers by a rib, in words."""
    tilt = found.tilt
    told = "rings are held against tilt"
    if tilt:
        moment = rounded(float(found.moment[:, 0].mean()), 4)
        told = (
            f"the inner ring is held at a tilt of {rounded(1e3 * tilt, 4)} mrad by a moment of {moment} N m"
        )
    if not found.bearing.taper:
        return told
    return f"{told}; the rib pushes with up to {rounded(float(found.rib_force.max()), 4)} N along a roller"


def _say_rubbing(keys: LoadKeys, found: LoadedRollers) -> None:
    """Say what friction on the rib asks of the rings, and the heat of it, where a file has friction."""
    friction = getattr(keys, "friction", None)
    if friction is None:
        return
    torque = float(found.rib_torque(friction).sum(axis=1).mean())
    heat = f", {rounded(2.0 * math.pi * keys.speed * torque, 4)} W of heat" if keys.speed else ""
    say(f"Friction of rollers on the rib asks the rings for {rounded(1e3 * torque, 4)} N mm{heat}.")


def _say_flanks(found: LoadedBearing, turning: Kinematics) -> None:
    """Say what both flanks of each ring carry of the ball that carries most, and how balls spin on them."""
    loads = [
        f"{rounded(float(max(each)), 4)} and {rounded(float(min(each)), 4)} N on the {ring} ring"
        for ring, each in (
            ("inner", found.inner_loads[found.heaviest]),
            ("outer", found.outer_loads[found.heaviest]),
        )
    ]
    say(f"Flanks of the ball that carries most: {', '.join(loads)}; contacts of the others are in --json.")
    spins = " and ".join(f"{rounded(1e-3 * each, 3)}" for each in flank_spin(found.bearing))
    tone = turning.tone("ball") / math.cos(found.bearing.arch_angle or 0.0)
    per = "Hz" if found.speed else "per turn"
    say(
        f"Balls on all four flanks spin by {spins} rad per mm of way on the inner and outer ring, and turn "
        f"about the axis of the bearing: their tone is {tone:.4g} {per}, not that below."
    )


def _rolling(of: AnyBearing, speed: float) -> dict[str, Any]:
    """Tones of a bearing of which no load is known."""
    tones = _say_tones(of, of.kinematics(speed or 1.0), speed)
    angle = f" at the free contact angle, {rounded(math.degrees(of.free_angle))}°, which a load changes"
    say(
        f"Tones{angle * (of.free_angle > 0.0)}. A load, as --radial '1 kN', gives loads, pressures and "
        "stiffness."
    )
    return {"tones": tones}


def _say_tones(of: AnyBearing, turning: Kinematics, speed: float) -> dict[str, float] | None:
    """Say tones of the kinematics, and those of waviness where an axial load is carried; return the first.

    None at no speed, where they are per turn.
    """
    unit = f"Hz at {rounded(60.0 * speed, 5)} 1/min" if speed else "per turn"
    element = of.ELEMENT
    rows = [["cage", f"{turning.cage:.4g}", f"{turning.cage / turning.turning:.4f}", ""]]
    waves = []
    for part, words in MEANINGS.items():
        tone = turning.tone(part)
        beside = turning.modulation(part)
        words = words.format(element)
        words += f", ± {beside:.4g} as it turns through the load" if beside else ""
        name = part_name(part, element)
        rows.append([name, f"{tone:.4g}", f"{tone / turning.turning:.4f}", words])
        for order in range(1, 6 if part == "ball" else 2 * turning.balls + 2):
            heard = [turning.waviness(part, order, lobes) for lobes in (0, 1)]
            cells = [", ".join(f"{tone:.4g}" for tone in tones) or "–" for tones in heard]
            waves += [[name, str(order), *cells]] if any(heard) else []
    say_table("Tones of pure rolling", ["of", unit, "orders", "meaning"], rows, width=WIDTH)
    one_arc = of.contact_angle if isinstance(of, RollerBearing) else not of.arches
    if one_arc:
        title = "Waviness that is heard under an axial load; other small waves move nothing"
        say_table(title, ["of", "waves per turn", f"axial, {unit}", f"radial, {unit}"], waves, width=WIDTH)
    return {"cage": turning.cage} | {part: turning.tone(part) for part in PARTS} if speed else None
