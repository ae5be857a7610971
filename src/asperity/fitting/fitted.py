"""Result of a fit: values with intervals, what the data leave open, and what is left of the data."""

from dataclasses import dataclass

import numpy as np

from asperity.arguments import Array
from asperity.case.any_case import AnyCase
from asperity.fitting.free import NEPER, Free
from asperity.fitting.interval_ends import LIMIT
from asperity.observables import observable
from asperity.observables.observable import Measured, Values
from asperity.observables.reading import told_repeats
from asperity.spectra import root_mean_square
from asperity.written_numbers import count_of, in_a_row, rounded


@dataclass(frozen=True)
class Estimate:
    """A value that was fitted.

    Attributes
    ----------
    free : Free
        What it is.
    value : float
        In SI.
    interval : tuple of two floats, optional
        95 % interval, in SI; None of a value on a limit beyond which the data want it.
    limit : str
        ``"least"`` or ``"largest"`` of a value on its limit; else empty.
    stops : tuple of two str
        Of the lower and the upper end of the interval why it stops there although the data allow what lies
        beyond: at a ``"limit"`` of the key, or as what lies ``"further"`` was not tried; else empty.
    """

    free: Free
    value: float
    interval: tuple[float, float] | None
    limit: str
    stops: tuple[str, str] = ("", "")

    @property
    def name(self) -> str:
        """The dotted key, or what else it is called."""
        return self.free.name

    @property
    def words(self) -> str:
        """The value with its interval, for people."""
        told = self.free.words(self.value)
        if self.interval is not None:
            low, high = map(self.free.words, self.interval)
            told = f"{told} ({low} to {high})"
        return told + f", on its limit ({self.free.range_source})" * bool(self.limit)

    @property
    def interval_in_words(self) -> str:
        """The interval, for people."""
        return " to ".join(map(self.free.words, self.interval)) if self.interval else "on its limit"

    @property
    def before_in_words(self) -> str:
        """The value that the case gave, for people."""
        return self.free.words(self.free.before) if self.free.given else "–"

    @property
    def open_ends(self) -> list[str]:
        """Ends at which the interval stops although the data allow what lies beyond, one sentence each."""
        told = []
        for stop, value, beyond in zip(self.stops, self.interval or (), ("below", "above"), strict=False):
            if stop:
                why = f", a limit ({self.free.range_source})" if stop == LIMIT else ", as far as was tried"
                told.append(
                    f"The interval of {self.name} stops at {self.free.words(value)}{why}: "
                    f"the data allow what lies {beyond} it."
                )
        return told


@dataclass(frozen=True)
class Undetermined:
    """A key that the data leave open, and that was left as the case has it.

    Attributes
    ----------
    free : Free
        What it is.
    others : tuple of (str, float)
        Keys with which alone the data determine a combination: how many times its own change, in parts of
        each, another has to change so that the data are met alike.
    levels : tuple of str
        Keys that are levels, whose parts are those of an amplitude.
    """

    free: Free
    others: tuple[tuple[str, float], ...]
    levels: tuple[str, ...] = ()

    @property
    def words(self) -> str:
        """What is not known, and what it was left at."""
        name = self.free.name
        left = (
            f"left at {self.free.words(self.free.before)}" if self.free.given else "left as the case has it"
        )
        if not self.others:
            return f"{name} is not determined by these data; {left}"
        names = in_a_row([other for other, _ in self.others])
        scale, unit = self._told(name)
        met = []
        for other, by in self.others:
            other_scale, other_unit = self._told(other)
            change = f"{rounded(abs(by) * other_scale / scale, 2)} {other_unit}"
            met.append(f"{change} {'more' if by > 0.0 else 'less'} of {other}")
        apart = f"{name} is not determined apart from {names}: 1 {unit} more of it is made up for by"
        return f"{apart} {in_a_row(met)}; {left}"

    def _told(self, name: str) -> tuple[float, str]:
        """How much of its unit an e-fold is, and the unit in which a change of a key is told."""
        return (NEPER, "dB") if name in self.levels else (100.0, "%")


@dataclass(frozen=True, eq=False)
class Fitted:
    """A case that was fitted.

    Attributes
    ----------
    case : Case
        With the values found.
    before : Case
        As it was.
    measured : tuple of Measured
        What it was fitted to, repeated measurements as their means.
    estimates : tuple of Estimate
        Values found, in the order in which they were named.
    undetermined : tuple of Undetermined
        Keys that the data leave open, the worst first.
    correlations : ndarray (k, k)
        Of the estimates that do not lie on a limit, on the scale of the search (logarithms).
    predicted_before, predicted : list of ndarray
        Of each measurement what the case predicts as it was, and as it is.
    stated : bool
        Whether the uncertainties of the data are known.
    left_out : float
        Standard deviation of what the case leaves out, dB, beside uncertainties that are known; zero where it
        meets the data within them.
    rivals : tuple of dict
        Values of other minima that meet the data as well.
    """

    case: AnyCase
    before: AnyCase
    measured: tuple[Measured, ...]
    estimates: tuple[Estimate, ...]
    undetermined: tuple[Undetermined, ...]
    correlations: Array
    predicted_before: list[Values]
    predicted: list[Values]
    stated: bool
    left_out: float
    rivals: tuple[dict[str, float], ...]

    @property
    def values(self) -> dict[str, float]:
        """Values found, by name, in SI."""
        return {each.name: each.value for each in self.estimates}

    @property
    def intervals(self) -> dict[str, tuple[float, float] | None]:
        """95 % intervals by name; None of a value on its limit."""
        return {each.name: each.interval for each in self.estimates}

    def residuals(self, *, before: bool = False) -> list[Array]:
        """Level of what was measured over what is predicted, dB, of each measurement."""
        predicted = self.predicted_before if before else self.predicted
        both = zip(self.measured, predicted, strict=True)
        return [observable(each.what).differs(each.values, found) for each, found in both]

    def rms(self, *, before: bool = False) -> float:
        """Root mean square of these of all data, dB."""
        return root_mean_square(np.concatenate(self.residuals(before=before)))

    @property
    def sentence(self) -> str:
        """What came of it, for people: what is not known first."""
        found = "; ".join(f"{each.name} = {each.words}" for each in self.estimates)
        return " ".join([*self.open_sentences, f"Fitted: {found}.", *self.remarks])

    @property
    def headline(self) -> str:
        """What came of it in one sentence."""
        values = sum(each.count for each in self.measured)
        fitted_keys = len(self.estimates)
        told = f"{count_of(fitted_keys, 'key')} fitted to {count_of(values, 'value')}"
        names = [each.free.name for each in self.undetermined]
        left_open = f"; not determined: {in_a_row(names)}" if names else ""
        left, before = (rounded(self.rms(before=each), 2) for each in (False, True))
        return f"{told}: {left} dB rms left, {before} dB before{left_open}."

    @property
    def open_sentences(self) -> list[str]:
        """What the data leave open, one sentence each."""
        return [f"{each.words}." for each in self.undetermined]

    @property
    def remarks(self) -> list[str]:
        """What is left, and what is doubtful of it, one sentence each."""
        values = count_of(sum(each.count for each in self.measured), "value")
        left = self.rms()
        before = self.rms(before=True)
        told = [f"Left: {rounded(left, 2)} dB rms of {values}, before {rounded(before, 2)} dB."]
        told += [sentence for each in self.measured if (sentence := told_repeats(each))]
        if limited := [each for each in self.estimates if each.limit]:
            names = in_a_row([each.name for each in limited])
            told.append(
                f"On a limit: {names}. What the case leaves out may be why; a range of one's own is given as "
                f'"{limited[0].name} = least..largest".'
            )
        told += [sentence for each in self.estimates for sentence in each.open_ends]
        if self.left_out:
            told.append(
                "The case does not meet the data within their uncertainty: it leaves out "
                f"{self.left_out:.1f} dB, which the intervals have in them."
            )
        if self.rivals:
            told.append(f"{count_of(len(self.rivals), 'other set')} of values meet the data as well.")
        return told
