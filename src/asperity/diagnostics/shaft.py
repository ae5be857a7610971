"""What of a record is its shaft's: where its lines are, which other speeds have them, and its blows."""

from collections.abc import Mapping

import numpy as np

from asperity.arguments import Array
from asperity.diagnostics.hypotheses import BETTER, DEEP, FINE, NEAR, BearingRecord, Hypothesis, Tone

SUPPORTED = 15.0
"""Support from which on the shaft is believed to be where it is sought: of a wrong speed one in ten has
it."""
APART = 0.06
"""Share about the speed given within which its lines are sought: one that is 3 % off is told where it is."""
ODD = 8.0
"""Support that the odd multiples of a speed alone must have: half of the true one has none, and lines between
the multiples that have it are those of a slower shaft."""
TIMES, MULTIPLES = (2, 3), (2, 3, 4)
"""Multiples and parts of a speed that are taken for another one by their own lines, and multiples that are
where theirs are clearer."""
SHARES = (1.0 / 3.0, 0.5, 2.0 / 3.0, 0.75, 4.0 / 3.0, 1.5)
"""Speeds that have half of the lines of a speed, a third or a quarter: over that speed."""
MAINS = (50.0, 60.0, 100.0, 120.0)
"""Hz, at which motors and inverters hum."""
AS_HIGH = 0.7
"""Share of the height of a line that others have which are one comb with it."""
AS_HIGH_AS_RUB = 0.85
"""The same of the lines of a rub that is not where the speed says: side bands of an inner ring have 0.75."""
AS_CLEAR = 0.8
"""Share of the support of a part's speed that the speed of a rub has whose multiples look like the part."""
SURELY = 25.0
"""Support of a part at another speed whose blows come once in a turn of the shaft, as those of a rub."""


def at_speed(speed: float, told: float) -> bool:
    """Whether a speed is the one given, but for what speeds are rounded by."""
    return abs(speed / told - 1.0) <= NEAR + 2 * FINE


def near_speed(each: Hypothesis, told: float) -> bool:
    """Whether a part is struck at the speed given."""
    return at_speed(each.speed, told)


def shaft_near(
    record: BearingRecord, tones: Mapping[str, Tone], told: float, deepest: float
) -> tuple[float, float, tuple[float, ...]]:
    """Where near a speed lines of the shaft are clearest, Hz, how clear, and which other speeds, Hz, have
    them as well: those whose lines are clearer, or of which these are a part's; a multiple that leaves few of
    them, and a part of it where there are lines between."""

    def support(speeds: Array, but: int = 0) -> Array:
        return record.supports(speeds, deepest=deepest, but=but)

    speeds = told * np.exp(np.arange(-APART, APART, FINE))
    clear = support(speeds)
    at = int(clear.argmax())
    here = float(speeds[at])
    near = here * _around()
    spans = [share * near for share in SHARES]
    spans += [here / np.arange(part.lowest, part.highest, FINE * part.order) for part in tones.values()]
    others = [float(span[span.size // 2]) for span in spans if support(span).max() > clear[at]]
    ahead = {times: float(support(times * near).max() - clear[at]) for times in MULTIPLES}
    clearer = [times for times in MULTIPLES if ahead[times] > BETTER]
    own = [(times, SUPPORTED if ahead[times] > 0.0 else ODD) for times in TIMES]
    fewer = [times for times, least in own if support(near, times).max() < least]
    others += [times * here for times in (*clearer, *fewer)]
    others += [here / times for times in TIMES if support(near / times, times).max() >= ODD]
    return here, float(clear[at]), tuple(sorted(set(others)))


def has_own_lines(record: BearingRecord, each: Hypothesis, tones: Mapping[str, Tone]) -> bool:
    """Whether lines of the shaft, and side bands, speak for a speed without those that its double and its
    threefold would have alone: a half and a third of each speed have its lines."""
    near = each.speed * _around()
    turned = tones[each.part].modulation or 1.0
    own = (record.supports(near, each.tone, turned, deepest=each.tone, but=times) for times in TIMES)
    return all(support.max() >= ODD for support in own)


def _around() -> Array:
    """Speeds close to one, over it."""
    return np.linspace(1.0 - NEAR / 4.0, 1.0 + NEAR / 4.0, 1 + round(NEAR / 2.0 / FINE))


def of_shaft_or_mains(
    record: BearingRecord,
    each: Hypothesis,
    told: float,
    resolution: float,
    seen: bool,
    others: tuple[float, ...] = (),
    rub: float = 0.0,
) -> bool:
    """Whether blows are those of a shaft with the speed given, as of a coupling or a fan, or with one of
    others that have its lines, or those of a rub near that speed, or of the mains.

    Multiples of its speed are the shaft's where its lines are seen; of a half and a third of it, as of what
    is loose, the loud lines are those of the shaft.
    """
    if any(_of_turns(record, each, speed) for speed in (told, each.speed, *others)):
        return True
    if rub and _of_turns(record, each, rub, AS_HIGH_AS_RUB):
        return True
    double = [speed for speed in others if _is_double(speed, told)]
    if each.support < SURELY and any(abs(each.tone - speed) <= resolution for speed in double):
        return True
    if near_speed(each, told):
        return False
    if is_turn(each.tone, told, resolution) or (rub and is_turn(each.tone, rub, resolution)):
        return each.support < SURELY
    lines = (round(each.tone / told) * told, *MAINS) if seen else MAINS
    return min(abs(each.tone - line) for line in lines) <= 0.5 * resolution


def _is_double(speed: float, told: float) -> bool:
    """Whether a shaft would turn twice as fast as told."""
    return at_speed(0.5 * speed, told)


def once_in_a_turn(record: BearingRecord, each: Hypothesis, told: float, resolution: float) -> bool:
    """Whether deep blows that are no part's are those of the shaft."""
    return each.depth >= DEEP and (is_turn(each.tone, told, resolution) or _of_turns(record, each, told))


def is_turn(tone: float, told: float, resolution: float) -> bool:
    """Whether a tone is the speed given, or a half or a third of it."""
    return min(abs(tone - told / times) for times in (1, *TIMES)) <= resolution


def _of_turns(record: BearingRecord, each: Hypothesis, speed: float, as_high: float = AS_HIGH) -> bool:
    """Whether the tone of a part is a multiple of a shaft's speed, whose own lines are as high: of a rub.

    Of a part that has nearly such a tone, lines of the shaft are clearer where the part has them.
    """
    order = round(each.tone / speed)
    if order < 2 or not at_speed(each.tone / order, speed):
        return False
    of_turns, of_part = record.supports(np.array([each.tone / order, each.speed]))
    if of_turns < max(SUPPORTED, AS_CLEAR * of_part):
        return False
    view = max(record.envelopes, key=lambda view: view.depth(each.tone))
    own, turned = (view.lines_of(tone)[1] for tone in (each.tone, each.tone / order))
    return bool(own.size and turned.size > 1 and turned[: min(order - 1, 2)].min() >= as_high * own[0])
