"""From a record to what is said of it: hypotheses are sifted, and one of them is decided for, or none."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from asperity.arguments import ArrayLike, positive, require
from asperity.diagnostics.confidence import Basis
from asperity.diagnostics.diagnosis import (
    CONFIRMED,
    CONTRADICTED,
    ELSEWHERE,
    EVEN,
    MEASURED,
    NOT_FOUND,
    RESOLVED,
    UNCONFIRMED,
    Diagnosis,
    part_name,
)
from asperity.diagnostics.envelopes import above_frequency
from asperity.diagnostics.hypotheses import (
    NEAR,
    RANGE,
    BearingRecord,
    Hypothesis,
    Tone,
    chance_of,
    deepest_comb,
)
from asperity.diagnostics.kurtogram import Kurtogram, kurtogram
from asperity.diagnostics.prominence import HARMONICS, LOWEST_PLACE
from asperity.diagnostics.recording import MOST_SAMPLES, Recording, SignalPieces
from asperity.diagnostics.shaft import (
    APART,
    SUPPORTED,
    at_speed,
    has_own_lines,
    is_turn,
    near_speed,
    of_shaft_or_mains,
    once_in_a_turn,
    shaft_near,
)
from asperity.diagnostics.tacho import Tacho
from asperity.progress import Progress, counted
from asperity.written_numbers import capital, rounded

TOLD = 15.0
"""Score that the speed given is worth: what is told is more often right than not."""
AHEAD, AHEAD_OF_SHAFT = 10.0, 25.0
"""Score by which a hypothesis at another speed must be ahead to be named: where lines of the shaft are found
at the speed given, another shaft may be near, and more is asked."""
HUM = 400.0
"""Frequency up to which lines of the mains and of motors are, Hz."""
LONGEST = 500.0
"""Turns of a piece of a record: blows that slip have wide lines in longer ones."""
ENOUGH = 100.0
"""Turns of a piece that is no longer than it must be."""
LEAST_DEPTH = {"stands": 0.25, "turns": 0.15}
"""Share by which the envelope follows the blows of a fault: balls that pass a sound ring that stands in the
load make it rise and fall, too, by 0.19 at most in the records of sound bearings that were looked at."""
FEW_BLOWS = 20.0
"""Number of blows for which twice that share is asked: of few, some line up by chance."""
ALIKE = 8.0
"""Score within which two parts that have the same lines are not told apart."""
CLEARER = 0.5
"""Logarithm by which the lines of a comb must be clearer, on the mean, than those of its side bands."""
BESIDE = 0.005
"""Share by which the speed of a part may be beside that of the lines of the shaft: contact angle and slip are
in its tones."""
AROUND_LINES = 2.5
"""Of the highest line that is sought, up to which others are looked at, by which it is told how far it stands
out."""


def diagnose(
    signal: ArrayLike,
    rate: float,
    tones: Mapping[str, Tone],
    speed: float,
    *,
    band: tuple[float, float] | None = None,
    fastest: float = math.inf,
    tacho: Tacho | None = None,
    progress: Progress | None = None,
) -> Diagnosis:
    """Find which part of a bearing is struck in a record, at which speed, and how sure that is.

    Parameters
    ----------
    signal : array_like (n,)
        Acceleration, in any unit; NaN where a sample is missing.
    rate : float
        Samples per second, Hz.
    tones : dict
        `Tone` by part, as of `BallBearing.tones`.
    speed : float
        Of the shaft, as told, Hz.
    band : (float, float), optional
        Of the second envelope, Hz; by default that of the largest kurtosis (`impulsive_band`).
    fastest : float, optional
        Speed beyond which hardly any such bearing runs, Hz, as of `BallBearing.fastest`: beyond it that is
        said first, and nothing is surer than even.
    tacho : Tacho, optional
        What gave the speed, by which the signal was resampled over angle, for sentences.
    progress : callable, optional
        Called as ``progress(done, total, message)``.

    Returns
    -------
    Diagnosis
        Its confidence is calibrated on measured records (`asperity.diagnostics.confidence`).

    Raises
    ------
    InputError
        If the record is too short for any tone, or sampled too slowly to hold the blows of all parts.

    Notes
    -----
    Two envelopes are looked at, as W. A. Smith and R. B. Randall (Mechanical Systems and Signal Processing
    64–65 (2015) 100) recommend: that of the prewhitened signal, and that of the band of the largest kurtosis.
    In both the clearest combs of harmonics are sought at *any* speed within a factor of eight of that given.
    Each comb may be that of each part, at the speed that follows from it; the lines of the shaft, and side
    bands at its speed or, of a ball, at that of the cage, say which. That speaks against two mistakes: a
    wrong speed or sampling rate, and a second ring beside the right one, whose lines f_i = Z f_r − f_o are
    those of the right one and the shaft's.
    """
    return diagnose_together(
        [signal], rate, tones, speed, band=band, fastest=fastest, tacho=tacho, progress=progress
    )


def diagnose_together(
    signals: Sequence[ArrayLike],
    rate: float,
    tones: Mapping[str, Tone],
    speed: float,
    *,
    band: tuple[float, float] | None = None,
    fastest: float = math.inf,
    element: str = "ball",
    tacho: Tacho | None = None,
    progress: Progress | None = None,
) -> Diagnosis:
    """Find which part of a bearing is struck by several records of it, at one speed and sampling rate.

    Parameters
    ----------
    signals : sequence of array_like (n,)
        As of `diagnose`: files of one measurement, or several sensors. Their spectra are averaged, each by
        its own level, over pieces of one length; a signal with less than half the length of the longest is
        left out.
    rate, tones, speed, band, fastest, tacho, progress
        As of `diagnose`.
    element : {"ball", "roller"}
        What rolls in the bearing, for sentences.

    Returns
    -------
    Diagnosis
        Of all together.
    """
    told = positive("speed (Hz)", speed)
    recordings = [Recording.of(each, rate, still=1.0 / told) for each in signals]
    stretches = [each for recording in recordings for each in recording.stretches]
    longest = _longest_piece(rate / told)
    duration = SignalPieces.of(stretches, longest).size / rate
    part, tone = max(tones.items(), key=lambda each: each[1].order)
    blows = f"the blows of the {part_name(part, element)} at {rounded(tone.order * told, 4)} Hz"
    received = f"{rounded(rate, 6)} Hz"
    allowed = f"more than {rounded(2.0 * tone.order * told, 4)} Hz, to hold {blows}"
    asked = f"Is the speed, {rounded(told, 5)} Hz, in 1/min?" if tacho is None else capital(tacho.question)
    remedy = f"{asked} Otherwise sample faster."
    require(rate > 2.0 * tone.order * told, "sampling rate of the signal", received, allowed, remedy)
    needed = 2.0 * LOWEST_PLACE / (tone.order * told)
    lines = f"the lines of the {part_name(part, element)} at {rounded(tone.order * told, 4)} Hz"
    gaps = " without a gap" * (sum(each.size for each in stretches) < sum(np.size(each) for each in signals))
    received = f"{rounded(duration)} s{gaps}"
    allowed = f"at least {rounded(needed)} s, to resolve {lines}"
    require(duration >= needed, "duration of the signal", received, allowed, "Record longer.")
    pieces = SignalPieces.of(stretches, longest, rate, told)
    reached = HARMONICS * tone.order * told
    seen = Kurtogram.mean(_kurtograms(pieces, rate, reached, progress))
    limits = band or _ringing_band(seen, rate, reached)
    sought = AROUND_LINES * HARMONICS * RANGE * told * max(1.0, *(each.highest for each in tones.values()))
    record = BearingRecord.of(pieces, rate, seen, limits, sought, HUM, progress)
    alone = [each.tones_alone for each in recordings]
    if all(alone):
        silent = decided(record, (), tones, told)
        basis = Basis("nothing", silent.turns)
        found = replace(
            silent, speed=told, speed_is=UNCONFIRMED, others=(), basis=basis, tones_alone=alone[0]
        )
    else:
        found = decided(record, record.read(tones, told), tones, told)
    doubts = dict.fromkeys(each for recording in recordings for each in recording.doubts)
    speed_is = MEASURED if tacho is not None and found.speed_is == UNCONFIRMED else found.speed_is
    told_of = replace(found, doubts=tuple(doubts), fastest=fastest, element=element)
    return replace(told_of, speed_is=speed_is, tacho=tacho)


def _longest_piece(samples_of_turn: float) -> float:
    """Samples of a piece at most."""
    return min(LONGEST * samples_of_turn, max(ENOUGH * samples_of_turn, MOST_SAMPLES))


def _kurtograms(
    pieces: SignalPieces, rate: float, reached: float, progress: Progress | None
) -> Iterator[Kurtogram]:
    """Kurtogram of each block of pieces above the lines that an envelope shall show, up to a frequency, Hz.

    Below lie the shaft's own lines, hum and the tone of balls that pass the load: each beats with the others.
    """
    above = _above(reached, rate)
    for block in counted(pieces.blocks(), pieces.block_count, "kurtogram", progress):
        yield kurtogram(above_frequency(block, rate, above), rate, reached)


def _above(reached: float, rate: float) -> float:
    """Frequency above which the band of an envelope lies that shall show lines up to another one, Hz."""
    return min(max(reached, HUM), rate / 8.0)


def _ringing_band(seen: Kurtogram, rate: float, reached: float) -> tuple[float, float]:
    """Most impulsive band above the lines that its envelope shall show, Hz."""
    low, high = seen.best
    return max(low, _above(reached, rate)), high


def decided(
    record: BearingRecord, found: Sequence[Hypothesis], tones: Mapping[str, Tone], told: float
) -> Diagnosis:
    """Decide what the hypotheses of a record say of the speed given."""
    bare, struck, ranked = _sifted(record, found, tones, told)
    resolution = bare.resolution
    there = bare.speed_is == CONFIRMED
    turns = record.duration * told
    if not struck:
        return replace(bare, faint=next((each for each in ranked if near_speed(each, told)), None))
    best = struck[0]
    rivals = [each for each in struck if not _same(each, struck[0])]
    margin = _worth(best, told) - max((_worth(each, told) for each in rivals), default=0.0)
    if near_speed(best, told):
        return _of_parts(bare, best, rivals, tones, margin)
    another = there and not _multiple(best.speed / told)
    ahead = AHEAD_OF_SHAFT if another or best.every > 1 else AHEAD  # a comb of the spin is one more that fits
    here = [each for each in struck if near_speed(each, told) and abs(each.tone - best.tone) <= resolution]
    unresolved = [each for each in here if each.part == best.part]
    if unresolved and _agrees(best.speed, told, resolution):
        return _of_parts(bare, unresolved[0], rivals, tones, 0.0)
    if best.support >= SUPPORTED and margin >= ahead and has_own_lines(record, best, tones):
        basis = Basis(ELSEWHERE, turns, margin, best.support, best.depth)
        elsewhere = replace(bare, speed=record.speed(best.speed), speed_is=CONTRADICTED, basis=basis)
        return replace(elsewhere, parts=(best,), blows=best.blows)
    if here and _worth(here[0], told) >= _worth(best, told) - AHEAD:
        return _of_parts(bare, here[0], [each for each in struck if not _same(each, here[0])], tones, 0.0)
    if abs(best.tone - round(best.tone / told) * told) <= resolution:  # blows of the shaft, as of a coupling
        return bare
    faint = [each for each in ranked if near_speed(each, told) and abs(each.tone - best.tone) <= resolution]
    if faint:
        return replace(bare, faint=faint[0])
    otherwise = _nearest([each for each in struck if abs(each.tone - best.tone) <= resolution], told)
    return replace(bare, blows=best.tone, basis=Basis("blows", turns), nearest=otherwise)


def _sifted(
    record: BearingRecord, found: Sequence[Hypothesis], tones: Mapping[str, Tone], told: float
) -> tuple[Diagnosis, list[Hypothesis], list[Hypothesis]]:
    """Find what a record says of the speed given, parts that are struck, and all hypotheses, by their worth.

    Left out is what is of the shaft itself, side bands and, where lines of the shaft are there, parts
    beside them.
    """
    ranked = sorted(found, key=lambda each: -_worth(each, told))
    resolution = 1.0 / record.duration
    struck = _likely([each for each in ranked if _deep(each, tones, record.duration * record.pieces)])
    struck = [each for each in struck if not _of_sound_ring(each, ranked, tones)]
    deepest = deepest_comb((each.depth, each.tone) for each in found)
    once = abs(deepest / told - 1.0) <= APART or is_turn(deepest, told, resolution)
    blows = 0.0 if once else deepest  # once a turn they are the shaft's
    shaft, support, others = shaft_near(record, tones, told, blows)
    seen = support >= SUPPORTED and all(
        _agrees(each, told, resolution) for each in (shaft, record.speed(shaft))
    )
    there = seen and not others
    heard = others if seen else ()
    rub = deepest if once else 0.0
    turning = (told, resolution, seen, heard, rub)
    of_turns = [each for each in struck if of_shaft_or_mains(record, each, *turning)]
    struck = [each for each in struck if each not in of_turns]
    seen_at = record.speed(shaft)
    near = [each for each in struck if near_speed(each, told) and record.holds_shaft(told)]
    foreign = [each for each in near if _side_band(each, found, told, resolution)]
    if there:
        foreign += [each for each in near if _beside_shaft(each, seen_at, resolution)]
    struck = [each for each in struck if each not in foreign]
    ranked = [each for each in ranked if each not in foreign]
    turns = record.duration * told
    bare = Diagnosis(
        told=told,
        speed=seen_at if there and at_speed(seen_at, told) else told,
        speed_is=CONFIRMED if there else UNCONFIRMED,
        parts=(),
        alike=(),
        faint=None,
        blows=0.0,
        others=heard,
        basis=Basis("sound" if seen else "nothing", turns),
        once_in_a_turn=any(
            once_in_a_turn(record, each, speed, resolution)
            for each in of_turns
            for speed in (told, *heard, *([rub] if rub else []))
        ),
        resolution=resolution,
        record=record,
        by_chance=chance_of(tones),
    )
    return bare, struck, ranked


def _nearest(found: Sequence[Hypothesis], told: float) -> Hypothesis | None:
    """What is struck at the speed that is nearest to the one given, where that is near."""
    nearest = min(found, key=lambda each: abs(math.log(each.speed / told)))
    return nearest if abs(nearest.speed / told - 1.0) <= APART else None


def _of_parts(
    bare: Diagnosis, best: Hypothesis, rivals: Sequence[Hypothesis], tones: Mapping[str, Tone], margin: float
) -> Diagnosis:
    """What is said where a part is struck at the speed given."""
    told = bare.told
    resolution = bare.resolution
    better = [each for each in rivals if each.support >= SUPPORTED and each.score > best.score]
    otherwise = next((each for each in better if not near_speed(each, told)), None)
    there = otherwise is None and (bare.speed_is == CONFIRMED or best.support >= SUPPORTED)
    near = [each for each in rivals if near_speed(each, told)]
    close = [each for each in near if abs(each.tone - best.tone) <= 2.0 * resolution]
    alike = {each.part: each for each in close if _worth(each, told) >= _worth(best, told) - ALIKE}
    seconds = () if alike else tuple(_seconds(near, best, tones, resolution))
    kind = "ball" if best.part == "ball" else "fault" if there else NOT_FOUND
    basis = Basis(kind, bare.turns, margin, best.support, best.depth)
    if bare.turns < RESOLVED and basis.confidence < EVEN:
        return bare
    found = replace(bare, parts=(best, *seconds), alike=tuple(alike.values()), basis=basis)
    if not there:
        return replace(found, speed=told, speed_is=UNCONFIRMED, otherwise=otherwise)
    speed = bare.record.speed(best.speed)
    if at_speed(speed, told):
        return replace(found, speed=speed, speed_is=CONFIRMED)
    if _agrees(speed, told, resolution):
        return replace(found, speed=told, speed_is=CONFIRMED)
    return replace(found, speed=speed, speed_is=CONTRADICTED)


def _worth(each: Hypothesis, told: float) -> float:
    """Score of a hypothesis, that of the speed given the more."""
    return each.score + (TOLD if near_speed(each, told) else 0.0)


def _agrees(speed: float, told: float, resolution: float) -> bool:
    """Whether a speed by its lines is the one given, as far as the record resolves the two.

    Lines lie on places half a resolution apart, up to rounding.
    """
    return at_speed(speed, told) or abs(speed - told) <= 0.5001 * resolution


def _multiple(ratio: float) -> bool:
    """Whether one speed is a multiple of the other, whose lines the other has, too."""
    larger = max(ratio, 1.0 / ratio)
    return abs(larger / round(larger) - 1.0) <= NEAR


def _deep(each: Hypothesis, tones: Mapping[str, Tone], duration: float) -> bool:
    """Whether the envelope follows the blows as it does those of a fault."""
    least = LEAST_DEPTH["turns" if tones[each.part].modulation else "stands"]
    return each.depth >= least * (1.0 + FEW_BLOWS / (each.tone * duration))


def _side_band(each: Hypothesis, found: Sequence[Hypothesis], told: float, resolution: float) -> bool:
    """Whether a comb is a side band, by a turn of the shaft or two, of one that is deeper and clearer."""
    stronger = [
        other for other in found if other.depth >= each.depth and other.clearness >= each.clearness + CLEARER
    ]
    off = [abs(abs(each.tone - other.tone) - turns * told) for other in stronger for turns in (1, 2)]
    return min(off, default=math.inf) <= 0.5 * resolution


def _beside_shaft(each: Hypothesis, seen_at: float, resolution: float) -> bool:
    """Whether a part fits the speed given, but not that of the lines of the shaft, and none speak for it."""
    off = abs(each.speed - seen_at)
    return each.support < SUPPORTED and off > max(BESIDE * seen_at, resolution)


def _of_sound_ring(each: Hypothesis, ranked: Sequence[Hypothesis], tones: Mapping[str, Tone]) -> bool:
    """Whether faint blows of a part that turns are as likely those of balls that pass a sound ring, which
    stands: at the speed that lines of the shaft speak for."""
    standing = [other for other in ranked if not tones[other.part].modulation and other.tone == each.tone]
    likelier = any(other.support > max(each.support, 0.0) for other in standing)
    return each.depth < LEAST_DEPTH["stands"] and likelier


def _likely(struck: Sequence[Hypothesis]) -> list[Hypothesis]:
    """Those that are struck, without unlike blows that no shaft speaks for where one speaks for another part.

    A comb of the spin is one more that any comb at a wrong speed may be.
    """
    told = {each.tone for each in struck if each.support >= SUPPORTED}
    return [each for each in struck if each.every == 1 or each.support >= SUPPORTED or each.tone not in told]


def _same(one: Hypothesis, other: Hypothesis) -> bool:
    return one.part == other.part and abs(one.speed / other.speed - 1.0) <= 1.5 * NEAR


def _seconds(
    near: Sequence[Hypothesis], best: Hypothesis, tones: Mapping[str, Tone], resolution: float
) -> list[Hypothesis]:
    """Other parts that are struck, too: with lines of their own, that those of the first and the shaft do not
    make."""
    found: dict[str, Hypothesis] = {}
    for each in near:
        own = each.part != best.part and each.part not in found and each.every == 1
        own = own and abs(each.speed / best.speed - 1.0) <= 0.5 * NEAR  # there is one shaft
        if own and each.depth >= 0.5 * best.depth and not _of_shaft(each, best, tones, resolution):
            found[each.part] = each
    return list(found.values())


def _of_shaft(each: Hypothesis, best: Hypothesis, tones: Mapping[str, Tone], resolution: float) -> bool:
    """Whether the tone of a part is made by the harmonics of another with the shaft or the cage.

    Both rings are: f_o + f_i = Z f_r.
    """
    rings = {name for name in tones if name != "ball"}
    if {each.part, best.part} <= rings:
        return True
    turns = np.arange(-2, 3)[:, None] * best.speed
    made = np.arange(1, HARMONICS + 1) * best.tone + turns
    return bool((np.abs(made - each.tone) <= 2.0 * resolution).any())
