"""What is wrong with a recording, whatever it was of: samples that are missing, stand still, are clipped."""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from asperity.arguments import Array, ArrayLike, floats, kept_small, positive, real_numbers, require
from asperity.diagnostics.foretold import unforetold
from asperity.diagnostics.missing_samples import (
    BLOCK,
    Mask,
    Runs,
    Samples,
    blocks,
    filled_in,
    runs,
    runs_of,
)
from asperity.diagnostics.phase_jumps import lost_between
from asperity.diagnostics.pure_tones import beat, tones_alone
from asperity.ranks import Ranked
from asperity.spectra import hann_window, quick_length
from asperity.written_numbers import count_of, rounded

FEWEST = 64
"""Samples of a signal, at least."""
BRIDGED = 3
"""Missing samples in a row that a straight line stands for."""
CLIPPED = 8
"""Samples at an end of a signal, at least, that tell that it is clipped there, …"""
AT_THE_END = 1e-3
"""… within this share of its height, …"""
BELOW = 1e-2
"""… and those in the next share, which are fewer by …"""
FEWER = 4.0
"""… this factor at least: what nothing clips thins out towards its ends."""
MOST_SAMPLES = 2**19
"""Samples of a signal that are transformed together: it takes some twenty times their memory."""
WIDER = 1.25
"""Band of what is kept of a long piece, over the lines that are sought: medians are taken around them."""
SLOW = 2**18
"""Samples of a piece from which on it is cut to a length that is quick to transform."""
OFFSET = 1.0
"""Mean over the rms about it from which on it is told."""
ROUNDING = 1e-12
"""Share of its largest value by which a signal that stands still may move, by rounding."""
HOLDS_TONES = 512
"""Samples of a stretch, at least, by which it is known that it holds tones alone."""
CLICK = 1.5
"""Of the size that loud tones reach so seldom, from which on it is no top of theirs."""
FADED = 0.25
"""Share of a piece at either end that is faded."""
SELDOM = 0.5
"""Times in a turn at most that something happens which is no blow of a part."""


@dataclass(frozen=True, eq=False)
class Recording:
    """A signal by its stretches without a gap, and what is wrong with it.

    Attributes
    ----------
    stretches : tuple of ndarray (n,)
        In their order, as they were measured, in the unit of the signal; in the type that they were kept in.
    doubts : tuple of str
        What is wrong with it, in sentences.
    clipped : float
        Share of its samples that lie at an end at which it is clipped.
    tones_alone : tuple of float
        Frequencies, Hz, of a record that holds a few tones wherever nothing is missing; none of others.
    """

    stretches: tuple[Samples, ...]
    doubts: tuple[str, ...]
    clipped: float
    tones_alone: tuple[float, ...] = ()

    @classmethod
    def of(cls, signal: ArrayLike, rate: float, still: float = np.inf) -> "Recording":
        """A signal (n,), in which NaN stands for what is missing, at a sampling rate, Hz.

        What does not move for so long, s, is no signal: a channel that was stuck, or filled up.
        """
        measured, rate = _given(signal, rate)
        values, left_out, told_missing = _bridged(measured)
        stuck, told_stuck = _stands_still(values, rate, still)
        straight, told_straight = _straight(measured, rate, still)
        _leave_out(left_out, (*stuck, *straight))
        lost, told_lost = _lost(values, left_out, rate, still)
        _leave_out(left_out, lost)
        whole = values[~left_out] if left_out.any() else values
        allowed = "a signal that varies"
        remedy = "Is the sensor connected?"
        low, high = _ends(whole)
        moves = high - low > ROUNDING * max(high, -low)
        require(moves, "signal", "the same number throughout", allowed, remedy)
        between = _between(left_out, values)
        stretches = tuple(each for each in between if each.size >= FEWEST and each.max() > each.min())
        longest = f"{max(map(len, between))} samples without a gap at most"
        require(stretches, "signal", longest, f"at least {FEWEST} that vary")
        clipped, told_clipped = _clipped(whole)
        told = (told_missing, told_stuck, told_straight, told_lost)
        doubts = (*told, _in_stretches(stretches, left_out, rate), told_clipped, _offset(whole))
        tones = _tones(_between(left_out, measured), rate, clipped > 0.0)
        return cls(stretches, tuple(each for each in doubts if each), clipped, tones)


@dataclass(frozen=True, eq=False)
class SignalPieces:
    """Pieces of one length of a record, each made when it is read: a record is not held beside itself.

    Attributes
    ----------
    size : int
        Samples of each.
    cut : tuple of (ndarray (n,), float, float, bool)
        Samples of each as they were measured, the mean of their stretch, which is taken off, the size to
        which it is limited then, and whether its ends are faded.
    """

    size: int
    cut: tuple[tuple[Samples, float, float, bool], ...]

    @classmethod
    def of(
        cls, stretches: Sequence[Samples], longest: float, rate: float = 1.0, speed: float = 0.0
    ) -> "SignalPieces":
        """Cut stretches (n,) of a sampling rate and a speed, Hz, into pieces of so many samples at most.

        Their length is that of the shortest that has half the length of the longest one, or a part of it;
        what is shorter is left out, and of a long one what makes it slow to transform: a prime length takes
        three times as long. What is larger than a stretch reaches once in two turns is no blow that recurs: a
        single click, as of a loose cable, would be all that a spectrum shows. So would the ends of loud
        tones, which do not meet: they are faded.
        """
        most = max(each.size for each in stretches)
        size = min(each.size for each in stretches if each.size >= 0.5 * most)
        size //= int(np.ceil(size / longest))
        if size > SLOW:
            size = quick_length(size)
        cut = list[tuple[Samples, float, float, bool]]()
        for each in stretches:
            mean = _mean(each)
            turns = each.size / rate * speed
            loud = bool(speed) and beat(each, rate, (0.0, 0.5 * rate))
            reached = _reached(each, mean, max(int(SELDOM * turns), 1)) if speed else np.inf
            reached *= CLICK if loud else 1.0
            parts = (each[n * size : (n + 1) * size] for n in range(each.size // size))
            cut += [(part, mean, reached, loud) for part in parts]
        return cls(size, tuple(cut))

    def __len__(self) -> int:
        """How many there are."""
        return len(self.cut)

    def __iter__(self) -> Iterator[Array]:
        """Return one after the other, (n,), without their means."""
        return (_limited(*each) for each in self.cut)

    def step(self, rate: float, highest: float) -> int:
        """Of how many samples at a rate, Hz, one is kept of long pieces, which holds lines up to a frequency,
        Hz."""
        return 1 if self.size <= MOST_SAMPLES else max(int(0.5 * rate / (WIDER * highest)), 1)

    @property
    def block_count(self) -> int:
        """How many blocks there are in all."""
        return len(self) * math.ceil(self.size / MOST_SAMPLES)

    def blocks(self) -> Iterator[Array]:
        """Return what is transformed together, one after the other: pieces, or equal parts of long ones."""
        count = self.block_count // len(self)
        size = self.size // count
        parts = (slice(n * size, (n + 1) * size) for n in range(count))
        return (
            _limited(samples[part], mean, reached, faded)
            for part in parts
            for samples, mean, reached, faded in self.cut
        )

    def seen(self, view: Callable[[Array], Array], step: int) -> Iterator[Array]:
        """Return what a view (n,) -> (n,) makes of each, at one of so many samples: 1 for all of them.

        Of more than one it is made in blocks, each faded into the next by squared sines, without what is
        faster than the samples that are kept: how many turns a long piece has is no matter of memory.
        """
        for each in self.cut:
            yield view(_limited(*each)) if step == 1 else _thinned(*each, view, step)


def _limited(samples: Samples, mean: float, reached: float, faded: bool) -> Array:
    """Samples less a mean, within a size, and faded at their ends."""
    limited = floats(samples) - mean
    np.clip(limited, -reached, reached, out=limited)
    if faded:
        limited *= _fading(samples.size, 0, samples.size)
    return limited


def _fading(size: int, first: int, last: int) -> Array:
    """Weights of some of so many samples, (last - first,): squared sines at both ends."""
    place = np.arange(first, last) + 0.5
    share = np.minimum(place, size - place) / (FADED * size)
    return np.asarray(np.sin(0.5 * np.pi * np.minimum(share, 1.0)) ** 2)


def _thinned(
    samples: Samples, mean: float, reached: float, faded: bool, view: Callable[[Array], Array], step: int
) -> Array:
    """What a view makes of samples (n,), at one of so many of them, as `SignalPieces.seen` has it."""
    halves = max(math.ceil(2 * samples.size / MOST_SAMPLES), 2)
    half = quick_length(samples.size // halves // step)
    fading = hann_window(2 * half, centred=True)
    total, weight = np.zeros((2, halves * half))
    for first in range(0, (halves - 1) * half, half):
        places = slice(first * step, (first + 2 * half) * step)
        block = _limited(samples[places], mean, reached, False)
        if faded:
            block *= _fading(samples.size, places.start, places.start + block.size)
        kept = slice(first, first + 2 * half)
        total[kept] += fading * np.fft.irfft(np.fft.rfft(view(block))[: half + 1], 2 * half)
        weight[kept] += fading
    return total / (weight * step)


def _reached(values: Samples, mean: float, times: int) -> float:
    """Size that values (n,) have so many times, about a mean."""
    largest = np.zeros(0)
    for block in blocks(values, max(BLOCK, times)):
        largest = np.concatenate([largest, np.abs(floats(block) - mean)])
        largest = np.partition(largest, -times)[-times:] if largest.size > times else largest
    return float(largest.min())


def _given(signal: ArrayLike, rate: float) -> tuple[Samples, float]:
    """A signal of numbers and NaN, and its sampling rate, Hz."""
    allowed = "a series of numbers, NaN where one is missing"
    values = kept_small(real_numbers("signal", signal, allowed))
    require(values.ndim == 1, "signal", f"shape {values.shape}", allowed)
    require(values.size >= FEWEST, "signal", count_of(values.size, "sample"), f"at least {FEWEST}")
    known = any(not np.isnan(block).all() for block in blocks(values))
    require(known, "signal", "no number, NaN throughout", allowed)
    for block in blocks(values):
        endless = block[np.isinf(block)]
        require(not endless.size, "signal", f"{endless[:1].sum()}", allowed)
    return values, positive("sampling rate (Hz)", rate)


def _ends(values: Samples) -> tuple[float, float]:
    """Smallest and largest of values (n,); zeros of none."""
    return (float(values.min()), float(values.max())) if values.size else (0.0, 0.0)


def _mean(values: Samples) -> float:
    return float(values.mean(dtype=np.float64))


def _between(left_out: Mask, values: Samples) -> list[Samples]:
    """Stretches of values that are not left out, and known."""
    kept = (~(out | np.isnan(part)) for out, part in zip(blocks(left_out), blocks(values), strict=True))
    return [values[first:last] for first, last in runs_of(kept)]


def _bridged(values: Samples) -> tuple[Samples, Mask, str]:
    """Values with few missing ones filled in, which others are missing (n,), and what is told of those filled
    in."""
    missing = np.isnan(values)
    few = [
        (first, last)
        for first, last in runs(missing)
        if last - first <= BRIDGED and first > 0 and last < values.size
    ]
    if not few:
        return values, missing, ""
    values = values.astype(np.float64)
    for first, last in few:
        ends = values[[first - 1, last]]
        values[first:last] = np.interp(np.arange(first, last), [first - 1, last], ends)
    count = sum(last - first for first, last in few)
    told = f"{count} missing samples, up to {BRIDGED} in a row, are replaced by straight lines."
    return values, np.isnan(values), told


def _stands_still(values: Samples, rate: float, still: float) -> tuple[Runs, str]:
    """Where values do not move for so long, s, and what is told of that."""
    least = math.ceil(max(still * rate, FEWEST)) - 1 if still < values.size / rate else values.size
    parts = (values[first : first + BLOCK + 1] for first in range(0, values.size - 1, BLOCK))
    found = runs_of((part[1:] == part[:-1] for part in parts), least)
    found[:, 1] += 1  # the last of them, which is like the one before it
    if not len(found):
        return found, ""
    first, last = found[np.argmax(found[:, 1] - found[:, 0])]
    when = f"for {rounded((last - first) / rate)} s, from {rounded(first / rate)} s on"
    where = f"at {rounded(float(values[first]), 4)} {when}"
    return found, f"The signal stands still {where}, as of a channel that is stuck: that is left out."


def _straight(values: Samples, rate: float, turn: float) -> tuple[Runs, str]:
    """Where values are filled in by straight lines and cubics, and what is told of that."""
    found = filled_in(values, max(values.size / (turn * rate), 1.0))
    if not len(found):
        return found, ""
    longest = rounded((found[:, 1] - found[:, 0]).max() / rate, 2)
    where = f"from {rounded(found[0, 0] / rate)} s on"
    if len(found) > 1:
        where = f"{len(found)} times, for {longest} s at most, first {where}"
    else:
        where = f"for {longest} s {where}"
    told = f"The signal is held or on a smooth line {where}, as where samples were lost: that is left out."
    return found, told


def _lost(values: Samples, left_out: Mask, rate: float, still: float) -> tuple[list[Array], str]:
    """Where, of what is not left out, samples are missing that nothing marks, and what is told of that."""
    turn = min(still * rate, values.size)
    whole = runs_of((~part for part in blocks(left_out)), HOLDS_TONES)
    jumps = list[Array]()
    other = list[Array]()
    for first, last in whole:
        stretch = values[first:last]
        jumps += [each + first for each in lost_between(stretch, turn)]
        other += [each + first for each in unforetold(stretch, stretch.size / turn)]
    told = [
        f"The phase of the loudest tone jumps {_places(jumps, rate)}: samples are missing there, unmarked.",
        f"{_places(other, rate).capitalize()} the signal is not what its tones foretell, as where samples "
        "were lost, or a sensor was knocked: that is left out.",
    ]
    return jumps + other, told[0] if jumps else told[1] if other else ""


def _places(found: Sequence[Array], rate: float) -> str:
    """Where stretches are, in words."""
    first = f"at {rounded(found[0].mean() / rate)} s" if found else ""
    return first if len(found) <= 1 else f"in {len(found)} places, first {first},"


def _leave_out(left_out: Mask, found: Iterable[Array]) -> None:
    """Mark stretches from a first place to that behind the last, in a mask (n,)."""
    for first, last in found:
        left_out[max(first, 0) : last] = True


def _tones(whole: Sequence[Samples], rate: float, clipped: bool) -> tuple[float, ...]:
    """Tones that all stretches without a gap hold alone, Hz, by the longest; none where one holds more."""
    known = sorted((each for each in whole if each.size >= HOLDS_TONES), key=len, reverse=True)
    found = tones_alone(known[0], rate, clipped=clipped) if known else ()
    return found if all(tones_alone(each, rate, clipped=clipped) for each in known[1:] if found) else ()


def _in_stretches(stretches: Sequence[Samples], left_out: Mask, rate: float) -> str:
    """What is told of a record with gaps."""
    if not left_out.any():
        return ""
    first = runs(left_out)[0, 0] / rate
    lengths = ", ".join(rounded(each.size / rate) for each in stretches[:5])
    more = ", …" if len(stretches) > 5 else ""
    where = f"Samples are missing or left out, first at {rounded(first)} s"
    number = f"{len(stretches)} stretch{'es' * (len(stretches) > 1)}"
    return f"{where}: read in {number} without a gap ({lengths}{more} s)."


def _clipped(values: Samples) -> tuple[float, str]:
    """Share of values (n,) at an end at which they are clipped, and what is told of it."""
    middle = _median(values)
    ends = []
    count = 0
    for end in _ends(values):
        here, beside = _at_the_end(values, end, max(abs(end - middle), 1e-300))
        if here >= CLIPPED and here > FEWER * beside:
            ends.append(rounded(end, 4))
            count += here
    share = count / values.size
    where = " and ".join(ends)
    told = f"The signal is clipped at {where}, where {_percent(share)} of its samples lie: blows are higher."
    return share, told if ends else ""


def _at_the_end(values: Samples, end: float, reach: float) -> tuple[int, int]:
    """How many values (n,) lie at an end, and how many at the next step beside it, which of coarse steps is
    farther away than `BELOW`."""

    def shares() -> Iterator[Array]:
        return (np.abs(end - floats(block)) / reach for block in blocks(values))

    here = sum(int((share <= AT_THE_END).sum()) for share in shares())
    next_step = min(float(share[share > AT_THE_END].min(initial=1.0)) for share in shares()) + AT_THE_END
    reached = max(BELOW, next_step)
    beside = sum(int(((share > AT_THE_END) & (share <= reached)).sum()) for share in shares())
    return here, beside


def _median(values: Samples) -> float:
    """Median of values (n,)."""
    ranked = Ranked([values])
    return float(ranked.between((ranked.count - 1) // 2, ranked.count // 2 + 1).mean())


def _percent(share: float) -> str:
    return f"{rounded(100.0 * share, 2)} %"


def _offset(values: Samples) -> str:
    """What is told of a mean that is large beside what moves."""
    mean = _mean(values)
    squares = sum(float(np.square(floats(block) - mean).sum()) for block in blocks(values))
    rest = float(np.sqrt(squares / values.size))
    if abs(mean) < OFFSET * rest:
        return ""
    times = f"{rounded(abs(mean) / rest, 2)} times the rms of the rest"
    return f"Its mean of {rounded(mean)}, {times}, is taken off."
