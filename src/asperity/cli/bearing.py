"""``asperity bearing``: how a ball bearing carries a load, its tones, and which of them its signal holds."""

import math
from pathlib import Path
from typing import Any

import numpy as np

from asperity import diagnostics
from asperity.arguments import Array, require
from asperity.case.ball_bearing import BearingKeys, read_bearing
from asperity.diagnostics import LineFamily
from asperity.reporting.figure import write_chart
from asperity.scenes.bearing import HARMONICS, REACH, envelope_group, static_group, tones_group
from asperity.scenes.figures.bearing import ball_contacts_table, envelope_spectrum, load_zone
from asperity.schema import tree
from asperity.structures.ball_bearing import PARTS, PRINTED_BY, Kinematics
from asperity.structures.bearing_statics import doubt_speed
from asperity.studies.signals import read_signal
from asperity.surfaces.readers.hints import on_command_line, spelled
from asperity.terminal import say, say_table
from asperity.units import quantity

Band = tuple[float, float] | None
WIDTH = 122
TOLD = ("balls", "displacement", "stiffness", "imbalance", "tones", "speed", "band", "lines", "faults",
        "verdict")  # fmt: skip
"""Names of what is said to programs."""
NAMES = {"outer": "outer ring", "inner": "inner ring", "ball": "ball"}
MEANINGS = {
    "outer": "BPFO: balls pass a spot of it",
    "inner": "BPFI: balls pass a spot of it",
    "ball": "2 BSF: a spot of it meets a ring",
}


def show_bearing(
    source: str, signal: Path | None, picture: Path | None, options: dict[str, Any], **hints: Any
) -> dict[str, Any]:
    """Print what a bearing does under its load, or what its signal says, and draw it; return the numbers."""
    keys = read_bearing(source, options)
    of, name = keys.bearing, keys.name or source
    say(
        f"{name}: {of.balls} balls of {of.ball_diameter * 1e3:.4g} mm, pitch diameter "
        f"{of.pitch_diameter * 1e3:.4g} mm, grooves of {of.inner_conformity:g} D (inner) and "
        f"{of.outer_conformity:g} D (outer), clearance {of.radial_clearance * 1e6:.3g} µm, free contact "
        f"angle {math.degrees(of.free_angle):.3g}°"
    )
    if keys.name:
        say(f"Balls and diameters as printed by {PRINTED_BY}; grooves and clearance chosen here or given.")
    told = _heard(keys, signal, picture, **hints) if signal else _carried(keys, picture)
    if picture is not None:
        say(f"Picture: {picture.resolve()}")
        told["files"] = {"picture": picture}
    return {"bearing": name, **dict.fromkeys(TOLD), **told}


# --- what it carries


def _carried(keys: BearingKeys, picture: Path | None) -> dict[str, Any]:
    speed = keys.speed or 0.0
    doubt_speed(keys.bearing, speed)
    found = keys.bearing.loaded(keys.radial, keys.axial, speed=speed)
    load = f"{found.radial:.4g} N radial, {found.axial:.4g} N axial"
    turning = keys.bearing.kinematics(speed or 1.0, contact_angle=found.contact_angle)
    at_rest = tree(static_group(found, turning))
    contacts = ball_contacts_table(at_rest)
    cells = [[cell.text for cell in row] for row in contacts.rows]
    say_table(f"{contacts.title} under {load}", contacts.head, cells, width=WIDTH)
    say(contacts.note)
    ends = dict.fromkeys(f"{each:.0f}" for each in (found.touching.min(), found.touching.max()))
    say(f"{' to '.join(ends)} of {found.bearing.balls} balls touch the inner ring while the cage turns.")
    _say_tones(turning, f"Hz at {60.0 * speed:.5g} 1/min" if speed else "per turn")
    say(f"Balance to {found.imbalance:.0e} of the load.")
    if picture is not None:
        write_chart(load_zone.drawn(at_rest).chart, f"{keys.name or 'bearing'}, {load}", picture)
    names = ("azimuth", "inner_load", "outer_load", "inner_angle", "inner_pressure", "outer_pressure")
    balls = {name: getattr(found, name)[0] for name in names}
    tones = {"cage": turning.cage} | {part: turning.tone(part) for part in PARTS}
    ring = {"displacement": found.displacement, "stiffness": found.stiffness, "imbalance": found.imbalance}
    return {"balls": balls, **ring, "tones": tones if speed else None}


def _say_tones(turning: Kinematics, unit: str) -> None:
    """Tones of the kinematics, and those of waviness."""
    rows = [["cage", f"{turning.cage:.4g}", f"{turning.cage / turning.turning:.4f}", ""]]
    waves = []
    for part, words in MEANINGS.items():
        tone, beside = turning.tone(part), turning.modulation(part)
        words += f", ± {beside:.4g} as it turns through the load" if beside else ""
        rows.append([NAMES[part], f"{tone:.4g}", f"{tone / turning.turning:.4f}", words])
        for order in range(1, 6 if part == "ball" else 2 * turning.balls + 2):
            heard = [turning.waviness(part, order, lobes) for lobes in (0, 1)]
            cells = [", ".join(f"{tone:.4g}" for tone in tones) or "–" for tones in heard]
            waves += [[NAMES[part], str(order), *cells]] if any(heard) else []
    say_table("Tones of pure rolling", ["of", unit, "orders", "meaning"], rows, width=WIDTH)
    title = "Waviness that is heard under an axial load; other small waves move nothing"
    say_table(title, ["of", "waves per turn", f"axial, {unit}", f"radial, {unit}"], waves, width=WIDTH)


# --- what its signal says


def _heard(
    keys: BearingKeys,
    signal: Path,
    picture: Path | None,
    *,
    rate: str | None,
    array: str | None,
    column: int | None,
    band: str | None,
) -> dict[str, Any]:
    allowed = "the speed at which it was recorded"
    require(keys.speed, "speed", "nothing", allowed, 'Give it, as in --speed "1800 1/min".')
    nominal = float(keys.speed or 0.0)
    given = None if rate is None else quantity(rate, "Hz")
    with spelled(on_command_line):
        values, sampled = read_signal(signal, given, array=array, column=column)
    lines = diagnostics.find_lines(diagnostics.amplitude_spectrum(values, sampled), nominal, harmonics=3)
    speed = nominal * (1.0 + lines.deviation) if lines.found else nominal
    name, length = f"{signal.name}{f', {array}' if array else ''}", values.size / sampled
    origin = "by its lines" if lines.found else "as given: it has no clear lines"
    say(f"{name}: {values.size} samples, {length:.4g} s at {sampled:g} Hz; {60.0 * speed:.5g} 1/min {origin}")
    turning = keys.bearing.kinematics(speed, contact_angle=None if keys.axial else 0.0)
    within = _band(values, sampled, band, 5.0 * turning.ball_pass_inner)
    spectrum = diagnostics.envelope_spectrum(values, sampled, within)
    explained = diagnostics.explained_lines(spectrum, turning.families | {"turns": (speed, 0.0)})
    found = {part: lines for part, lines in explained.items() if part in PARTS}
    faults = diagnostics.clear_families(found)
    _say_lines(found, faults, speed, within)
    there = [f"lines of the {NAMES[each]} at {found[each].frequency[0]:.1f} Hz" for each in faults]
    verdict = f"There are {' and '.join(there)}." if there else "No lines of rings or balls stand out."
    say(verdict)
    if picture is not None:
        highest = REACH * HARMONICS * max(tone for tone, _ in turning.families.values())
        drawn = envelope_group(["signal"], [spectrum], [found], [faults], highest, "unit of the file")
        chart = envelope_spectrum.drawn(tree(tones_group(turning) | drawn)).chart
        write_chart(chart, f"{name}: {verdict}", picture)
    names = ("expected", "deviation", "found", "frequency", "amplitude", "background", "side_bands")
    told = {part: {name: getattr(found[part], name) for name in names} for part in PARTS}
    return {"speed": speed, "band": within, "lines": told, "faults": faults, "verdict": verdict}


def _band(values: Array, rate: float, band: str | None, least: float) -> Band:
    """Band of the envelope, Hz: found, given as ``"2 kHz, 4 kHz"``, or none for ``"all"``."""
    if band is None:
        return diagnostics.impulsive_band(values, rate, least)
    edges = [] if band == "all" else [quantity(part.strip(), "Hz") for part in band.split(",")]
    require(len(edges) in (0, 2), "--band", band, '"all", or two frequencies, as "2 kHz, 4 kHz"')
    return (edges[0], edges[1]) if edges else None


def _say_lines(found: dict[str, LineFamily], faults: list[str], speed: float, band: Band) -> None:
    rows = []
    for part in PARTS:
        lines = found[part]
        line, height = lines.frequency[0], lines.amplitude[0]
        sides = "±{:.4g}: {:.2f}, {:.2f}".format(lines.distance, *lines.side_bands[0] / height)
        stand = " ".join(str(n + 1) for n in np.flatnonzero(lines.prominent))
        seen = [f"{line:.2f}", f"{line / speed:.3f}", f"{100 * lines.deviation:+.2f} %"]
        seen += [stand, sides if lines.distance else "–"]
        heights = [f"{height:.3g}", f"{height / lines.background[0]:.1f}"]
        rows.append(
            [NAMES[part], f"{lines.expected:.2f}", *heights, *(seen if part in faults else ["–"] * 5)]
        )
    columns = [
        "of",
        "expected / Hz",
        "amplitude",
        "over median",
        "found / Hz",
        "orders",
        "off by",
        "harmonics",
    ]
    where = "all frequencies" if band is None else f"{band[0]:g} to {band[1]:g} Hz"
    say_table(f"Lines in the envelope of {where}", [*columns, "side bands / line"], rows, width=WIDTH)
