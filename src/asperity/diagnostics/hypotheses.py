"""What the lines of a record may mean: which part is struck, at which speed, and what the shaft says of
it."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from asperity.arguments import Array
from asperity.diagnostics.envelopes import band_envelope, mean_spectrum, prewhitened
from asperity.diagnostics.kurtogram import Kurtogram
from asperity.diagnostics.lines import STANDS_OUT
from asperity.diagnostics.prominence import LOWEST_PLACE, SPREAD, Prominence
from asperity.diagnostics.pure_tones import beat
from asperity.diagnostics.recording import SignalPieces
from asperity.progress import Progress, counted

RANGE = 8.0
"""Factor by which the speed is sought off the one given, either way."""
NEAR = 0.02
"""Share by which a speed may be off the one given: motors slip, and speeds are rounded."""
FINE = 2e-4
"""Share between speeds that are tried."""
TURNS = (10, 6, 6)
"""Multiples of the speed that are sought: in the spectrum, and in both envelopes."""
BESIDE = (1, 2, 3)
"""Harmonics of a fault beside which the speed is sought."""
TURNED = 25.0
"""Multiples of the speed up to which lines are held against one another."""
BETTER = 8.0
"""Support by which a speed beside the one given must be better to be taken in its place."""
DEEP = 0.25
"""Share by which the envelope follows blows that are no shaft's."""
UNLIKE = 55.0
"""Support from which on unlike blows are believed as others are.

Wrong ones of made machines had up to 49. Right ones, of balls that one ring strikes harder, have 65 to 75 in
noise of 0.1 rms and less, and 33 to 63 in noise of 0.2 and 0.3, of which those below are doubted, too."""
WEAK = 3.0
"""Amplitude over the median from which on lines count that lie where a part has them."""


@dataclass(frozen=True)
class Tone:
    """A fault's tone, per turn of the shaft.

    Parameters
    ----------
    order : float
        Blows per turn in pure rolling.
    modulation : float
        Turns of the fault past a load that stands still, per turn of the shaft: 0 of one that stands, too.
    lowest, highest : float
        Orders that the contact angle and slip allow.
    unlike : int
        Blows of a turn of the part that may be unlike: 2 of a spot on a ball, which meets the inner and the
        outer ring in turn.
    """

    order: float
    modulation: float
    lowest: float
    highest: float
    unlike: int = 1

    def of_every(self, number: int) -> "Tone":
        """Its comb where only every so many-th blow is like another, as of a ball that one ring strikes
        harder."""
        return replace(
            self,
            order=self.order / number,
            lowest=self.lowest / number,
            highest=self.highest / number,
            unlike=1,
        )


def chance_of(tones: Mapping[str, Tone]) -> float:
    """Chance that a comb of any frequency, from an octave below the lowest tone to one above the highest, is
    taken for one of these at the speed given: for each of them several frequencies are."""
    every = [part.of_every(n) for part in tones.values() for n in range(1, part.unlike + 1)]
    spans = sorted((part.lowest * (1.0 - NEAR), part.highest * (1.0 + NEAR)) for part in every)
    covered = 0.0
    reached = 0.0
    for low, high in spans:
        covered += max(float(np.log(high / max(low, reached))), 0.0)
        reached = max(reached, high)
    return covered / float(np.log(4.0 * reached / spans[0][0]))


@dataclass(frozen=True)
class Hypothesis:
    """A part that is struck at a speed, and what speaks for it.

    Attributes
    ----------
    part : str
        As in the tones.
    speed, tone : float
        Of the shaft, and fundamental of the comb, Hz.
    clearness : float
        Mean logarithm of the lines of the comb over the median around them, from 0 to ln 30.
    support : float
        How clearly lines of the shaft, and side bands at its speed or the cage's, stand at that speed: a sum
        of standardised values, each kind less its largest, so that one foreign line does not make it.
    depth : float
        Share by which the envelope rises and falls with the blows.
    every : int
        Blows in a period of the comb: 2 of a ball that one ring strikes harder than the other.
    """

    part: str
    speed: float
    tone: float
    clearness: float
    support: float
    depth: float
    every: int = 1

    @property
    def blows(self) -> float:
        """Frequency of the blows, Hz."""
        return self.every * self.tone

    @property
    def is_sure(self) -> bool:
        """Whether the shaft speaks clearly enough for it: unlike blows have the comb of a spin, which is one
        more that any comb may be."""
        return self.every == 1 or self.support >= UNLIKE

    @property
    def score(self) -> float:
        """By which hypotheses are ranked: a shaft that is not heard speaks for none and against none."""
        return (
            max(self.support, 0.0) + 10.0 * self.clearness + 15.0 * float(np.log(min(self.depth, 1.0) + 1e-3))
        )


@dataclass(frozen=True, eq=False)
class BearingRecord:
    """A record by what stands out in it: its spectrum and two envelopes.

    Attributes
    ----------
    duration : float
        Of a piece, s.
    spectrum, white, band : Prominence
        Of the signal, of the envelope of the prewhitened signal, and of that of a band.
    kurtogram : Kurtogram
        Of the signal above the lines of the parts.
    limits : (float, float)
        Of the band, Hz: its most impulsive one, or one that was given.
    pieces : int
        How many there are: all of these are means over them.
    """

    duration: float
    spectrum: Prominence
    white: Prominence
    band: Prominence
    kurtogram: Kurtogram
    limits: tuple[float, float]
    pieces: int

    @classmethod
    def of(
        cls,
        pieces: SignalPieces,
        rate: float,
        kurtogram: Kurtogram,
        limits: tuple[float, float],
        sought: float = np.inf,
        beyond: float = 0.0,
        progress: Progress | None = None,
    ) -> "BearingRecord":
        """Pieces of a record at a sampling rate, Hz, their kurtogram, the band of the second envelope, and
        the highest frequency, Hz, at which lines are looked for: of a shaft that turns slowly a small part of
        what long pieces hold. Of others what lies so far beyond is kept, too."""
        step = pieces.step(rate, sought)
        highest = sought + beyond if step == 1 else sought

        def white(block: Array) -> Array:
            level = 1.0 if step == 1 else float(block.std())  # a loud block stays louder than others
            return band_envelope(level * prewhitened(block, rate), rate, 0.0, 0.5 * rate)

        def ringing(block: Array) -> Array:
            heard = prewhitened(block, rate) if beat(block, rate, limits) else block
            return band_envelope(heard, rate, *limits)

        def seen(view: Callable[[Array], Array], what: str) -> Iterator[Array]:
            return counted(pieces.seen(view, step), len(pieces), what, progress)

        plain = ((each, float(each.std())) for each in seen(np.asarray, "spectrum"))
        spectrum = Prominence.of(mean_spectrum(plain, rate / step)[0], means=len(pieces), highest=highest)

        def stands_out(view: Callable[[Array], Array], width: float, name: str) -> Prominence:
            envelopes = seen(view, f"envelope of the {name}")
            return Prominence.of_envelopes(envelopes, rate / step, width, len(pieces), highest)

        return cls(
            duration=pieces.size / rate,
            spectrum=spectrum,
            white=stands_out(white, 0.5 * rate, "whitened signal"),
            band=stands_out(ringing, limits[1] - limits[0], "band"),
            kurtogram=kurtogram,
            limits=limits,
            pieces=len(pieces),
        )

    @property
    def envelopes(self) -> tuple[Prominence, Prominence]:
        """Both of them."""
        return self.white, self.band

    def holds_shaft(self, speed: float) -> bool:
        """Whether it is long enough for the line of a shaft at a speed, Hz."""
        return self.duration * speed >= 2.0 * LOWEST_PLACE

    def _beside(self, view: Prominence, frequency: Array, *combs: Array) -> Array:
        """Standardised values at frequencies (n, k), without those that combs of tones (n, 1) may make
        themselves; NaN for none."""
        found = view.standardised(frequency, TURNED * float(frequency.flat[0]))
        for tone in combs:
            nearest = np.maximum(np.rint(frequency / tone), 1.0) * tone
            own = np.abs(frequency - nearest) <= (LOWEST_PLACE + 1) * view.step
            found = np.where(own, np.nan, found)
        return found

    def supports(
        self, speed: Array, tone: float = 0.0, modulation: float = 1.0, *, deepest: float = 0.0, but: int = 0
    ) -> Array:
        """How clearly there are lines of the shaft at each speed (n,), Hz, as `Hypothesis.support` has it.

        Without those of the combs of a tone and of the deepest blows, but with side bands of the tone at the
        modulation times the speed. With `but`, instead of lines at multiples of so many times the speed
        others that follow.
        """
        views = (self.spectrum, *self.envelopes)
        total = np.zeros(speed.size)
        own = [np.full((speed.size, 1), each) for each in (tone, deepest) if each]
        for view, count in zip(views, TURNS, strict=True):
            order = np.arange(1, 2 * count + 1)
            lines = speed[:, None] * (order[order % but > 0] if but else order)[:count]
            total += _less_largest(self._beside(view, lines, *(own if view is not self.spectrum else ())))
        if deepest:
            once = np.abs(speed - deepest)[:, None] <= SPREAD * self.white.step  # blows of the shaft itself
            own[-1] = np.where(once, np.nan, own[-1])
        for view in self.envelopes if tone and modulation else ():
            sides = np.array([n * tone + side * modulation * speed for n in BESIDE for side in (-1.0, 1.0)]).T
            total += _less_largest(self._beside(view, sides, *own))
        return np.where(speed >= 2 * LOWEST_PLACE * self.spectrum.step, total, 0.0)

    def read(self, tones: Mapping[str, Tone], told: float) -> list[Hypothesis]:
        """What the combs of the record may mean, the best first: of each comb and part the best speeds."""
        found = []
        combs = [
            (name, every, part.of_every(every))
            for name, part in tones.items()
            for every in range(1, part.unlike + 1)
            if every == 1 or self.holds_shaft(told)
        ]
        clear_combs = self._combs([part for _, _, part in combs], told)
        deepest = deepest_comb((self._depth(tone), tone) for _, tone in clear_combs)
        for clear, tone in clear_combs:
            depth = self._depth(tone, deepest)
            for name, every, part in combs:
                best, support = self._best_speed(part, tone, deepest, told / RANGE, told * RANGE)
                near, nearly = self._best_speed(part, tone, deepest, told * (1.0 - NEAR), told * (1.0 + NEAR))
                if best:
                    found.append(Hypothesis(name, best, tone, clear, support, depth, every))
                resolved = abs(best - near) > 0.5 / self.duration
                if near and (nearly >= support - BETTER or not resolved):
                    found.append(Hypothesis(name, near, tone, clear, nearly, depth, every))
        return sorted(found, key=lambda each: -each.score)

    def _depth(self, tone: float, deepest: float = 0.0) -> float:
        """Share by which an envelope follows a comb, without what is that of the deepest one."""
        return max(each.depth(tone, deepest) for each in self.envelopes)

    def _combs(self, tones: Sequence[Tone], told: float) -> list[tuple[float, float]]:
        """How clear combs are, and their tones, Hz: the clearest at any speed, and those of the parts."""
        lowest = min(tone.lowest for tone in tones) * told / RANGE
        highest = max(tone.highest for tone in tones) * told * RANGE
        step = self.white.step
        places = self.white.amplitude.size
        low = max(lowest, 2 * LOWEST_PLACE * step)
        high = min(highest, step * places / 2.2)
        found = [each.strongest(low, high) for each in self.envelopes] if high > low else []
        found += [self._at_its_place(part, told) for part in tones]
        return [each for each in found if each[0]]

    def _at_its_place(self, part: Tone, told: float) -> tuple[float, float]:
        """The comb, a faint one too, where a part has it at the speed given; 0 for none."""
        low = part.lowest * told * (1.0 - NEAR)
        high = part.highest * told * (1.0 + NEAR)
        found = [(0.0, 0.0)]
        for view in self.envelopes:
            tones = np.linspace(low, high, 3 + int(15.0 * (high - low) / view.step))
            clear = view.combs(tones, WEAK)
            if clear.max() > 0.0:
                tone = view.refined(float(tones[clear.argmax()]))
                if view.true_fundamental(tone, told) == tone:
                    found.append((float(clear.max()), tone))
        return max(found)

    def _best_speed(
        self, part: Tone, tone: float, deepest: float, low: float, high: float
    ) -> tuple[float, float]:
        """Speed within limits at which the shaft speaks most for a part with a tone, Hz, and how much; 0 for
        none."""
        blurred = 0.5 * self.white.step  # a comb is known to a quarter of the resolution
        low = max((tone - blurred) / part.highest, low)
        high = min((tone + blurred) / part.lowest, high)
        if low >= high:
            return 0.0, 0.0
        speeds = np.exp(np.arange(np.log(low), np.log(high) + FINE, FINE))
        support = self.supports(speeds, tone, part.modulation or 1.0, deepest=deepest)
        clearest = np.flatnonzero(support >= support.max() - 1e-9)
        at = int(clearest[clearest.size // 2])
        return float(speeds[at]), float(support[at])

    def speed(self, about: float) -> float:
        """Speed by the lines of the shaft near one, Hz: the median of what each line says, higher ones the
        more.

        The median, so that a foreign line beside one of them does not decide.
        """
        said = []
        for view, count in zip((self.spectrum, *self.envelopes), TURNS, strict=True):
            order = np.arange(1, count + 1)
            middle = np.rint(order * about / view.step).astype(int)
            inside = (middle >= LOWEST_PLACE) & (middle < view.amplitude.size - 3)
            order = order[inside]
            middle = middle[inside]
            around = middle[:, None] + np.arange(-2, 3)
            place = np.take_along_axis(around, view.amplitude[around].argmax(axis=1)[:, None], axis=1)[:, 0]
            clear = view.amplitude[place] >= STANDS_OUT * view.background(place)
            said += [(p * view.step / n, n) for p, n in zip(place[clear], order[clear], strict=True)]
        if len(said) < 3:
            return about
        value, weight = np.array(sorted(said)).T
        return float(value[np.searchsorted(np.cumsum(weight), 0.5 * weight.sum())])


def deepest_comb(combs: Iterable[tuple[float, float]]) -> float:
    """Tone of the deepest of combs by depth and tone, Hz: of blows, whose lines are not the shaft's; 0 for
    none that is as deep as those of a fault."""
    depth, tone = max(combs, default=(0.0, 0.0))
    return tone if depth >= DEEP else 0.0


def _less_largest(terms: Array) -> Array:
    """Sums (n,) of values (n, k) without the largest of each row; what is not known counts nothing."""
    known = np.where(np.isnan(terms), 0.0, terms)
    return np.asarray(known.sum(axis=-1) - known.max(axis=-1))
