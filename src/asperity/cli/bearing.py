"""``asperity bearing``: how a ball bearing carries a load, its tones, and which of them its signal holds."""

import math
import textwrap
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from asperity import diagnostics
from asperity.arguments import require
from asperity.case.ball_bearing import BearingKeys, read_bearing
from asperity.diagnostics import Diagnosis, LineFamily, Spectrum, Tone
from asperity.diagnostics.decision import NAMES
from asperity.diagnostics.verdict import faint_lines
from asperity.reporting.chart import Chart
from asperity.reporting.figure import write_chart
from asperity.scenes.bearing import HARMONICS, REACH, envelope_group, static_group, tones_group
from asperity.scenes.figures.bearing import ball_contacts_table, envelope_spectrum, kurtogram_panel, load_zone
from asperity.schema import tree
from asperity.structures.ball_bearing import PARTS, PRINTED_BY, Kinematics
from asperity.structures.bearing_statics import doubt_speed
from asperity.studies.signals import read_record
from asperity.surfaces.readers.hints import on_command_line, spelled
from asperity.terminal import say, say_table
from asperity.units import quantity
from asperity.written_numbers import rounded, unbroken

Band = tuple[float, float] | None
WIDTH = 122
TITLE = 105
"""Characters of a line of a title."""
TOLD = ("balls", "displacement", "stiffness", "imbalance", "tones", "speed", "speed_is", "band", "lines",
        "faults", "confidence", "resolution", "verdict")  # fmt: skip
"""Names of what is said to programs."""
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
        f"{of.outer_conformity:g} D (outer), clearance {rounded(of.radial_clearance * 1e6)} µm, free contact "
        f"angle {rounded(math.degrees(of.free_angle))}°"
    )
    if keys.name:
        say(f"Balls and diameters as printed by {PRINTED_BY}; grooves and clearance chosen here or given.")
    told = _heard(keys, signal, picture, **hints) if signal else _carried(keys, picture)
    if picture is not None:
        told["files"] = {"picture": picture}
    return {"bearing": name, **dict.fromkeys(TOLD), **told}


# --- what it carries


def _carried(keys: BearingKeys, picture: Path | None) -> dict[str, Any]:
    speed = keys.speed or 0.0
    doubt_speed(keys.bearing, speed)
    found = keys.bearing.loaded(keys.radial, keys.axial, speed=speed)
    load = f"{rounded(found.radial, 4)} N radial, {rounded(found.axial, 4)} N axial"
    turning = keys.bearing.kinematics(speed or 1.0, contact_angle=found.contact_angle)
    at_rest = tree(static_group(found, turning))
    contacts = ball_contacts_table(at_rest)
    cells = [[cell.text for cell in row] for row in contacts.rows]
    say_table(f"{contacts.title} under {load}", contacts.head, cells, width=WIDTH)
    say(contacts.note)
    ends = dict.fromkeys(f"{each:.0f}" for each in (found.touching.min(), found.touching.max()))
    say(f"{' to '.join(ends)} of {found.bearing.balls} balls touch the inner ring while the cage turns.")
    _say_tones(turning, f"Hz at {rounded(60.0 * speed, 5)} 1/min" if speed else "per turn")
    say(f"Balance to {rounded(found.imbalance, 1)} of the load.")
    if picture is not None:
        write_chart(load_zone.drawn(at_rest).chart, f"{keys.name or 'bearing'}, {load}", picture)
        say(f"Picture: {picture.resolve()}")
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
    known: str | None,
) -> dict[str, Any]:
    allowed = "the speed at which it was recorded"
    require(keys.speed, "speed", "nothing", allowed, 'Give it, as in --speed "1800 1/min".')
    told = float(keys.speed or 0.0)
    given = None if rate is None else quantity(rate, "Hz")
    with spelled(on_command_line):
        record = read_record(signal, given, array=array, column=column)
    values, sampled = record.values, record.rate
    tones, edges = keys.bearing.tones(axial=keys.axial > 0.0), _band(band, sampled)
    diagnosis = diagnostics.diagnose(values, sampled, tones, told, band=edges)
    speed, within = diagnosis.speed, diagnosis.record.limits
    name, length = f"{signal.name}{f', {array}' if array else ''}", values.size / sampled
    origin = {
        "confirmed": "by lines of the shaft",
        "unconfirmed": "as given: lines of the shaft are not found",
        "contradicted": f"by what its lines fit, not {rounded(60.0 * told, 5)} 1/min as given",
    }[diagnosis.speed_is]
    recorded = f"{values.size} samples, {rounded(length, 4)} s at {rounded(sampled, 6)} Hz"
    recorded += f", as {record.rate_by}" * bool(record.rate_by)
    say(f"{name}: {recorded}; {rounded(60.0 * speed, 5)} 1/min {origin}")
    struck = diagnostics.envelope_spectrum(values, sampled, within)
    found = _lines_of(struck, tones, diagnosis)
    faults = [each.part for each in diagnosis.parts]
    _say_lines(found, tones, diagnosis)
    if faint := faint_lines(diagnosis):
        say(faint)
    verdict = diagnostics.diagnosis_sentence(diagnosis, known)
    if picture is not None:
        nominal = {part: tone.order * speed for part, tone in tones.items()}
        highest = REACH * HARMONICS * max(nominal.values())
        shown = {part: lines or _no_lines(nominal[part]) for part, lines in found.items()}
        drawn = envelope_group(["signal"], [struck], [shown], [faults], highest, "unit of the file")
        turning = keys.bearing.kinematics(speed, contact_angle=0.0)
        envelope = envelope_spectrum.drawn(tree(tones_group(turning) | drawn)).chart
        bands = kurtogram_panel(diagnostics.kurtogram(values, sampled), within)
        title = textwrap.fill(unbroken(f"{name}: {verdict}"), TITLE)
        write_chart(Chart((*envelope.panels, bands)), title, picture)
        say(f"Picture: {picture.resolve()}")
    say(verdict)
    names = ("expected", "deviation", "found", "frequency", "amplitude", "background", "side_bands")
    lines = {part: each and {name: getattr(each, name) for name in names} for part, each in found.items()}
    return {
        "speed": speed,
        "speed_is": diagnosis.speed_is,
        "band": within,
        "lines": lines,
        "faults": [] if diagnosis.speed_is == "contradicted" else faults,
        "confidence": diagnosis.confidence,
        "resolution": diagnosis.resolution,
        "verdict": verdict,
    }


def _band(band: str | None, rate: float) -> Band:
    """Band of the envelope, Hz, given as ``"2 kHz, 4 kHz"`` or ``"all"``; None where it is to be found."""
    if band is None:
        return None
    edges = [] if band == "all" else [quantity(part.strip(), "Hz") for part in band.split(",")]
    require(len(edges) in (0, 2), "--band", band, '"all", or two frequencies, as "2 kHz, 4 kHz"')
    return (edges[0], edges[1]) if edges else (0.0, 0.5 * rate)


def _lines_of(
    spectrum: Spectrum, tones: Mapping[str, Tone], diagnosis: Diagnosis
) -> dict[str, LineFamily | None]:
    """Lines of each part at the speed of a diagnosis: of those it names where it found them; None if not
    resolved."""
    named = {each.part: each.blows for each in diagnosis.parts}
    reached, step = spectrum[0][-1], spectrum[0][1]
    found: dict[str, LineFamily | None] = {}
    for part, tone in tones.items():
        nominal, distance = tone.order * diagnosis.speed, tone.modulation * diagnosis.speed
        at = named.get(part, nominal)
        if not 8.0 * step <= at <= 0.9 * reached:
            found[part] = None
            continue
        low, high = tone.lowest / tone.order - 1.0, tone.highest / tone.order - 1.0
        slip = 0.0 if part in named else max(-low, high, 0.0)
        lines = diagnostics.find_lines(spectrum, at, distance=distance, slip=slip)
        off = lines.frequency[0] / nominal - 1.0 if part in named else lines.deviation
        found[part] = replace(lines, expected=nominal, deviation=off)
    return found


def _no_lines(expected: float) -> LineFamily:
    """What stands for lines that the record does not resolve."""
    missing = np.full(HARMONICS, np.nan)
    return LineFamily(expected, 0.0, 0.0, missing, missing, missing, np.full((HARMONICS, 2), np.nan))


def _say_lines(
    found: Mapping[str, LineFamily | None], tones: Mapping[str, Tone], diagnosis: Diagnosis
) -> None:
    rows = []
    named = {each.part for each in diagnosis.parts}
    for part, lines in found.items():
        expected = f"{tones[part].order * diagnosis.speed:.2f}"
        if lines is None:
            rows.append([NAMES[part], expected, "not resolved", *["–"] * 6])
            continue
        line, height = lines.frequency[0], lines.amplitude[0]
        sides = "±{:.4g}: {:.2f}, {:.2f}".format(lines.distance, *lines.side_bands[0] / height)
        stand = " ".join(str(n + 1) for n in np.flatnonzero(lines.prominent)) or "–"
        seen = [f"{line:.2f}", f"{line / diagnosis.speed:.3f}", f"{100 * lines.deviation:+.2f} %"]
        seen += [stand, sides if lines.distance else "–"]
        heights = [rounded(height), f"{height / lines.background[0]:.1f}"]
        rows.append([NAMES[part], expected, *heights, *(seen if part in named else ["–"] * 5)])
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
    low, high = diagnosis.record.limits
    where = f"{low:g} to {high:g} Hz"
    say_table(f"Lines in the envelope of {where}", [*columns, "side bands / line"], rows, width=WIDTH)
