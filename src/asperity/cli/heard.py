"""What signals of a bearing say, on the command line: each file, and all of one measurement together."""

import textwrap
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from asperity import diagnostics
from asperity.arguments import Array, require
from asperity.case.loaded_bearing import LoadKeys
from asperity.diagnostics import Diagnosis, LineFamily, Spectrum, Tacho, Tone
from asperity.diagnostics.verdict import faint_lines
from asperity.errors import InputError
from asperity.progress import Progress, counted, progress_bar
from asperity.reporting.chart import Chart
from asperity.reporting.figure import write_chart
from asperity.scenes.bearing_at_rest import tones_group
from asperity.scenes.bearing_heard import HARMONICS, REACH, envelope_group
from asperity.scenes.figures.bearing import envelope_spectrum
from asperity.scenes.figures.kurtogram import kurtogram_panel
from asperity.schema import tree
from asperity.studies.recorded import Recorded, read_record
from asperity.studies.tacho import Turned, at_constant_speed, fitting_speed, read_turned
from asperity.surfaces.readers.hints import on_command_line, spelled
from asperity.terminal import say, say_table
from asperity.units import quantity
from asperity.written_numbers import count_of, rounded, signed, unbroken

Band = tuple[float, float] | None
Signals = Mapping[str, Recorded]
WIDTH = 122
TITLE = 105
"""Characters of a line of a title."""
SAME_RATE = 1e-3
"""Share by which sampling rates of files may differ, as times were printed."""
MANY = 1_000_000
"""Samples of all signals from which on it takes seconds, and progress is shown."""
SMEARED = 1.01
"""Factor of speeds from which on it is said that resonances are smeared."""
SAME_SPEED = 0.01
"""Share by which speeds by the lines of files may differ that are told to be of one speed."""


OF_LINE = ("expected", "deviation", "found", "frequency", "amplitude", "background", "side_bands")
"""What is told of each line."""


def heard(
    keys: LoadKeys,
    files: Sequence[Path],
    picture: Path | None,
    *,
    rate: str | None,
    array: str | None,
    column: int | None,
    band: str | None,
    known: str | None,
    tacho: str | None = None,
    tacho_reads: str | None = None,
) -> dict[str, Any]:
    """Print what signals of a bearing say and draw it; return the numbers."""
    allowed = "the speed at which it was recorded"
    remedy = 'Give it, as in --speed "1800 1/min", or --tacho.'
    require(keys.speed or tacho, "speed", "nothing", allowed, remedy)
    require(tacho or tacho_reads is None, "--tacho-reads", f"'{tacho_reads}'", "--tacho COLUMN with it")
    element = keys.bearing.ELEMENT
    require(known != "roller" or element == known, "--known", known, "outer, inner or ball of a ball bearing")
    tones = keys.bearing.tones(axial=keys.axial > 0.0)
    signals, singles, diagnosis, together, turned = _judged(
        keys, files, tones, rate=rate, array=array, column=column, band=band, tacho=tacho,
        tacho_reads=tacho_reads,
    )  # fmt: skip
    title = f"All {len(together)} together" if singles else next(iter(signals))
    found = _lines_of(diagnosis.record.band.spectrum, tones, diagnosis)
    verdict = diagnostics.diagnosis_sentence(diagnosis, "ball" if known == element else known)
    _say_signals(signals, singles)
    say(f"{title}: {_length(together)}{_taken(diagnosis)}")
    if singles:
        say(_agreement(singles))
    _say_lines(found, tones, diagnosis)
    if faint := faint_lines(diagnosis):
        say(faint)
    if picture is not None:
        _draw(keys, title, found, tones, diagnosis, verdict, picture)
    say(verdict)
    return {
        **_told(diagnosis),
        "tacho": turned,
        "band": diagnosis.record.limits,
        "lines": {
            part: each and {name: getattr(each, name) for name in OF_LINE} for part, each in found.items()
        },
        "signals": [
            {"signal": name, **_told(each), "verdict": diagnostics.diagnosis_sentence(each)}
            for name, each in (singles or {title: diagnosis}).items()
        ],
        "verdict": verdict,
    }


class _Judged(NamedTuple):
    """Signals that were read, what each of several says alone, all together, and how fast all turned."""

    signals: Signals
    singles: dict[str, Diagnosis]
    diagnosis: Diagnosis
    together: list[Recorded]  # that say something alone, of which the diagnosis is
    turned: dict[str, Any] | None


def _judged(
    keys: LoadKeys,
    files: Sequence[Path],
    tones: Mapping[str, Tone],
    *,
    rate: str | None,
    array: str | None,
    column: int | None,
    band: str | None,
    tacho: str | None,
    tacho_reads: str | None,
) -> _Judged:
    """Read signals, over angle where a tacho tells how they turned, and judge them."""
    told = float(keys.speed or 0.0)
    with progress_bar() as progress:
        signals, sampled = _read(files, rate, progress, array=array, column=column)
        turned: dict[str, Any] | None = None
        given: Tacho | None = None
        if tacho is not None:
            beside = zip(files, signals.values(), strict=True)
            courses = [read_turned(*each, tacho, tacho_reads, array) for each in beside]
            told = fitting_speed(courses, told)
            signals = at_constant_speed(signals, courses, told)
            sampled = next(iter(signals.values())).rate
            turned = _turned(courses, told)
            given = courses[0].tacho
        edges = _band(band, sampled)
        told_of = progress if sum(each.values.size for each in signals.values()) >= MANY else None
        judge = partial(
            diagnostics.diagnose_together, rate=sampled, tones=tones, speed=told, band=edges,
            fastest=keys.bearing.fastest, element=keys.bearing.ELEMENT, tacho=given,
        )  # fmt: skip
        singles = _one_by_one(signals, judge, told_of)
        together = [signals[name] for name in singles] or list(signals.values())
        diagnosis = judge([each.values for each in together], progress=told_of)
    return _Judged(signals, singles, diagnosis, together, turned)


def _say_signals(signals: Signals, singles: Mapping[str, Diagnosis]) -> None:
    """Print what each of several signals says alone."""
    for name, single in singles.items():
        say(f"{name}: {_length([signals[name]])}. {diagnostics.diagnosis_sentence(single)}")


def _turned(courses: Sequence[Turned], told: float) -> dict[str, Any]:
    """Say how fast all turned, and of which speed frequencies are; return that."""
    slow, _, fast = np.transpose([each.speeds for each in courses])
    slowest = float(slow.min())
    fastest = float(fast.max())
    span = f"{rounded(60.0 * slowest, 5)} to {rounded(60.0 * fastest, 5)} 1/min"
    factor = fastest / slowest
    smeared = f"; resonances are smeared by a factor of {rounded(factor, 3)}" if factor >= SMEARED else ""
    at = f"Frequencies are those at {rounded(60.0 * told, 5)} 1/min"
    say(f"Read over angle, by the tacho: {span}. {at}{smeared}.")
    return {"slowest": slowest, "fastest": fastest, "at": told}


def _read(files: Sequence[Path], rate: str | None, progress: Progress, **which: Any) -> tuple[Signals, float]:
    """Signals by name, and their sampling rate, Hz."""
    given = None if rate is None else quantity(rate, "Hz")
    with spelled(on_command_line):
        reading = (read_record(each, given, **which) for each in files)
        read = list(counted(reading, len(files), "reading signals", progress))
    rates = [each.rate for each in read]
    received = " and ".join(dict.fromkeys(f"{rounded(each, 6)} Hz" for each in rates))
    remedy = "Resample them, or judge them one by one."
    same = max(rates) / min(rates) - 1.0 <= SAME_RATE
    require(same, "sampling rates of the signals", received, "one for all", remedy)
    array = which["array"]
    named = [f"{each.name}{f', {array}' if array else ''}" for each in files]
    if len(set(named)) < len(named):
        named = [f"{each}{f', {array}' if array else ''}" for each in files]
    received = f"{len(named) - len(set(named))} twice"
    require(len(set(named)) == len(named), "--signal", received, "each file once")
    return dict(zip(named, read, strict=True)), float(np.mean(rates))


def _one_by_one(
    signals: Signals, judge: Callable[[list[Array]], Diagnosis], progress: Progress | None
) -> dict[str, Diagnosis]:
    """What each of several signals says; one that says nothing is left out, and why is said."""
    found: dict[str, Diagnosis] = {}
    if len(signals) == 1:
        return found
    for name, signal in counted(signals.items(), len(signals), "signals one by one", progress):
        try:
            found[name] = judge([signal.values])
        except InputError as wrong:
            say(f"{name} is left out. {wrong}")
    return found


def _length(signals: Sequence[Recorded]) -> str:
    """How long signals are."""
    size = sum(each.values.size for each in signals)
    rate = signals[0].rate
    length = f"{count_of(size, 'sample')}, {rounded(size / rate, 4)} s at {rounded(rate, 6)} Hz"
    tellers = {each.rate_by for each in signals} - {""}
    return f"{length}, as {tellers.pop()}" if len(tellers) == 1 else length


def _taken(diagnosis: Diagnosis) -> str:
    """In which pieces a signal is read, and which speed is taken."""
    given = "as given" if diagnosis.tacho is None else "by the tacho"
    not_found = f"{given}{': lines of the shaft are not found' * (not diagnosis.others)}"
    origin = {
        "confirmed": "by lines of the shaft",
        "measured": not_found,
        "unconfirmed": not_found,
        "contradicted": f"by what its lines fit, not {rounded(60.0 * diagnosis.told, 5)} 1/min {given}",
    }[diagnosis.speed_is]
    pieces = diagnosis.record.pieces
    read = f", read in {pieces} pieces of {rounded(diagnosis.record.duration, 4)} s" if pieces > 1 else ""
    return f"{read}; {rounded(60.0 * diagnosis.speed, 5)} 1/min {origin}"


def _agreement(singles: Mapping[str, Diagnosis]) -> str:
    """How many signals name which part, and whether they are of one speed."""
    named = Counter(
        " and ".join(each.name(part.part) for part in each.parts) or "no part" for each in singles.values()
    )
    words = ", ".join(
        f"{count} name{'s' * (count == 1)} {_article(what)}" for what, count in named.most_common()
    )
    speeds = [each.speed for each in singles.values() if each.speed_is in ("confirmed", "contradicted")]
    said = f"Of {len(singles)} signals, {words}."
    if speeds and max(speeds) / min(speeds) - 1.0 > SAME_SPEED:
        turning = f"{rounded(min(speeds), 4)} to {rounded(max(speeds), 4)} Hz"
        said += f" Their shafts turn at {turning}: lines of unlike speeds do not add up, believe each alone."
    return said


def _article(what: str) -> str:
    return what if what == "no part" else f"the {what}"


def _told(diagnosis: Diagnosis) -> dict[str, Any]:
    """What is told to programs of one diagnosis."""
    named = [] if diagnosis.speed_is == "contradicted" else [each.part for each in diagnosis.parts]
    return {
        "speed": diagnosis.speed,
        "speed_is": diagnosis.speed_is,
        "faults": named,
        "confidence": diagnosis.confidence,
        "resolution": diagnosis.resolution,
        "turns": diagnosis.turns,
        "doubts": list(diagnosis.doubts),
    }


def _draw(
    keys: LoadKeys,
    title: str,
    found: Mapping[str, LineFamily | None],
    tones: Mapping[str, Tone],
    diagnosis: Diagnosis,
    verdict: str,
    picture: Path,
) -> None:
    """Write the envelope spectrum with its lines, and the kurtogram that its band is from."""
    nominal = {part: tone.order * diagnosis.speed for part, tone in tones.items()}
    highest = REACH * HARMONICS * max(nominal.values())
    shown = {part: lines or _no_lines(nominal[part]) for part, lines in found.items()}
    faults = [each.part for each in diagnosis.parts]
    drawn = envelope_group(
        ["signal"], [diagnosis.record.band.spectrum], [shown], [faults], highest, "unit of the file"
    )
    turning = keys.bearing.kinematics(diagnosis.speed, contact_angle=0.0)
    envelope = envelope_spectrum.drawn(tree(tones_group(turning) | drawn)).chart
    bands = kurtogram_panel(diagnosis.record.kurtogram, diagnosis.record.limits)
    told = textwrap.fill(unbroken(verdict).replace("% sure", "%\u00a0sure"), TITLE)
    write_chart(Chart((*envelope.panels, bands)), f"{title}\n{told}", picture)
    say(f"Picture: {picture.resolve()}")


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
    reached = spectrum[0][-1]
    step = spectrum[0][1]
    found: dict[str, LineFamily | None] = {}
    for part, tone in tones.items():
        nominal = tone.order * diagnosis.speed
        distance = tone.modulation * diagnosis.speed
        at = named.get(part, nominal)
        if not 8.0 * step <= at <= 0.9 * reached:
            found[part] = None
            continue
        low = tone.lowest / tone.order - 1.0
        high = tone.highest / tone.order - 1.0
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
            rows.append([diagnosis.name(part), expected, "not resolved", *["–"] * 6])
            continue
        line = lines.frequency[0]
        height = lines.amplitude[0]
        sides = "±{:.4g}: {:.2f}, {:.2f}".format(lines.distance, *lines.side_bands[0] / height)
        stand = " ".join(str(n + 1) for n in np.flatnonzero(lines.prominent)) or "–"
        seen = [f"{line:.2f}", f"{line / diagnosis.speed:.3f}", f"{signed(100 * lines.deviation, 2)} %"]
        seen += [stand, sides if lines.distance else "–"]
        heights = [rounded(height), f"{height / lines.background[0]:.1f}"]
        rows.append([diagnosis.name(part), expected, *heights, *(seen if part in named else ["–"] * 5)])
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
    where = f"{rounded(low, 4)} to {rounded(high, 4)} Hz"
    say_table(f"Lines in the envelope of {where}", [*columns, "side bands / line"], rows, width=WIDTH)
