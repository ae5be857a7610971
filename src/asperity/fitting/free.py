"""What a fit may change: keys of a case, and what is no key of it, each on a scale and within limits."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

from asperity.arguments import Array, require, shown
from asperity.case.any_case import AnyCase, CaseKey, entry_of
from asperity.case.tables import TableFile, read_levels
from asperity.case.written_values import in_words
from asperity.errors import InputError
from asperity.parameters import FROM_PYTHON, Bounded, Either, Key, Quantity, outside
from asperity.scenarios.records import spectrum_levels
from asperity.spectra import HALF_BAND
from asperity.studies.axes import Unfit, value_of
from asperity.units import limits_in, quantity, unit_in
from asperity.written_numbers import rounded

NEPER = 20.0 / math.log(10.0)
"""dB that an e-fold of an amplitude is."""
LEAST_PART = 1e-4
"""Of a value that a case has: from there on it is sought by its logarithm where it may be zero."""
Range = tuple[float, float]


@dataclass(frozen=True)
class Free:
    """A quantity that a fit may change, in SI.

    Parameters
    ----------
    name : str
        The dotted key, or what else it is called.
    start, low, high : float
        Value from which the search begins, that of the case within the limits, and these.
    logarithmic : bool
        Whether it is fitted by its logarithm; else by parts of `size`.
    size : float
        Change that counts as much as an e-fold does of what is fitted by its logarithm.
    range_source : str
        Where the limits come from.
    entry : CaseKey
        The key.
    units : str
        SI units of the value.
    given : bool
        Whether the case has a value of its own, or its named set.
    band : float, optional
        Wavelength of the one-third octave, m, of a spectrum in whose bands levels are fitted.
    before : float
        Value of the case, which may lie beyond the limits that the search begins within.
    """

    name: str
    start: float
    low: float
    high: float
    logarithmic: bool
    size: float
    range_source: str
    entry: CaseKey
    units: str
    given: bool = True
    band: float | None = None
    before: float = math.nan

    def inward(self, value: float) -> float:
        """The value on the scale of the search."""
        return math.log(value) if self.logarithmic else value / self.size

    def outward(self, place: float) -> float:
        """A place on the scale of the search as a value, in SI, never beyond the limits."""
        return min(max(self.end(place), self.low), self.high)

    def end(self, place: float) -> float:
        """An end of an interval as a value, which may lie beyond the limits."""
        return math.exp(place) if self.logarithmic else place * self.size

    def words(self, value: float) -> str:
        """A value for people, in three digits."""
        if self.band is not None:
            return f"{value:.1f} dB re 1 µm"
        return in_words(float(f"{value:.3g}"), self.entry.key)


# --- limits that fits keep where nobody gives others

_CHOSEN = "chosen here from what is printed of"
USUAL: dict[str, tuple[str, str, str]] = {
    "track.pad_stiffness": ("30 MN/m", "3 GN/m", f"{_CHOSEN} soft and stiff pads"),
    "track.pad_damping": ("1 kN s/m", "300 kN s/m", f"{_CHOSEN} pads"),
    "track.pad_loss_factor": ("0.05", "0.5", f"{_CHOSEN} pads"),
    "track.ballast_stiffness": ("10 MN/m", "500 MN/m", f"{_CHOSEN} ballast"),
    "track.ballast_damping": ("5 kN s/m", "500 kN s/m", f"{_CHOSEN} ballast"),
    "track.ballast_loss_factor": ("0.1", "2.5", f"{_CHOSEN} ballast"),
    "sideways.pad_stiffness": ("3 MN/m", "1 GN/m", f"{_CHOSEN} soft and stiff pads"),
    "sideways.ballast_stiffness": ("5 MN/m", "500 MN/m", f"{_CHOSEN} ballast"),
    "track.rail_loss_factor": ("0.001", "0.1", f"{_CHOSEN} rails on their fastenings"),
}
"""Least, largest and why, of keys that are limited more widely in a case."""


def free_key(case: AnyCase, dotted: str, within: Range | None = None) -> Free:
    """A key of a case that is one number, with the limits of a range, else the usual ones, else its own."""
    entry = entry_of(type(case), dotted)
    kind = entry.key.kind
    allowed = "a key that holds one number, as track.pad_stiffness"
    require(
        entry.unit is not None and not getattr(kind, "whole", False), dotted, "a key to be fitted", allowed
    )
    try:
        start = float(value_of(case, entry))
        given = True
    except Unfit:
        start = math.nan
        given = False
    before = start
    if within is None and dotted in USUAL:
        least, most, why = USUAL[dotted]
        low, high = (float(entry.read(_read(each, kind), FROM_PYTHON)) for each in (least, most))
        low, high = (min(low, start), max(high, start)) if given and start > 0.0 else (low, high)
    elif within is None:
        low, high, why = *_own_limits(dotted, entry.key), "limits of the key"
        if low == 0.0 and given and start > 0.0:
            low = LEAST_PART * start
            why = f"from {LEAST_PART:g} of the case's value to the limit of the key"
    else:
        low, high, why = *within, "given here"
        for end in within:
            for error in outside(dotted, end, kind, entry.key.within):
                raise error
    require(low < high, dotted, f"limits from {low:g} to {high:g}", "a least value below the largest")
    logarithmic = low > 0.0
    if given and math.isfinite(start) and not low <= start <= high and within is not None:
        start = min(max(start, low), high)
    if not math.isfinite(start) or not low <= start <= high:
        start = math.sqrt(low * high) if logarithmic else 0.5 * (low + high)
    size = 1.0 if logarithmic else NEPER if entry.unit == "dB" else 0.25 * (high - low)
    return Free(
        dotted, start, low, high, logarithmic, size, why, entry, str(entry.unit), given, before=before
    )


# --- spectra, band by band

WITHIN = 25.0
"""By how much a level may be changed, dB, where nobody gives limits."""


def spectrum_of(case: AnyCase, entry: CaseKey) -> tuple[Array, Array]:
    """Wavelengths, m, and levels, dB re 1 µm, of a key that names a spectrum, or has it as a table."""
    spectrum = getattr(getattr(case, entry.section), entry.name)
    require(spectrum is not None, entry.dotted, "no spectrum in the case", "a spectrum to begin with")
    wavelength, levels, _ = spectrum_levels(spectrum)
    return wavelength, levels


def is_spectrum(entry: CaseKey) -> bool:
    """Whether a key holds levels over wavelength."""
    kind = entry.key.kind
    table = kind.other if isinstance(kind, Either) else kind
    return isinstance(table, TableFile) and table.read is read_levels


def free_bands(case: AnyCase, entry: CaseKey, heard: Range, within: Range | None) -> list[Free]:
    """Levels of a spectrum in the bands whose wavelengths are heard, m, each within limits, dB re 1 µm."""
    wavelengths, levels = spectrum_of(case, entry)
    found = []
    for wavelength, level in zip(wavelengths.tolist(), levels.tolist(), strict=True):
        if heard[0] / HALF_BAND < wavelength < heard[1] * HALF_BAND:
            low, high = within or (level - WITHIN, level + WITHIN)
            name = f"{entry.dotted} at {rounded(1e3 * wavelength)} mm"
            start = min(max(level, low), high)
            why = "given here" if within else f"{WITHIN:g} dB about the case's"
            found.append(
                Free(name, start, low, high, False, NEPER, why, entry, "dB", band=wavelength, before=level)
            )
    require(found, entry.dotted, "no band that is heard in what was measured", "one band or more")
    return found


def _read(text: str, kind: object) -> str | float:
    return text if isinstance(kind, Quantity) else float(text)


def _own_limits(dotted: str, key: Key) -> Range:
    """Plausible limits of a key, else those of its kind."""
    kind = key.kind
    unit = kind.dimension if isinstance(kind, Quantity) else ""
    if key.within:
        ends = limits_in(key.within)[:2]
        low, high = (quantity(end, unit) if unit else float(end) for end in ends)
        return low, high
    assert isinstance(kind, Bounded)
    least = kind.at_least if kind.at_least is not None else kind.above
    if least is not None and kind.at_most is not None:
        return least if least > 0.0 else 1e-4 * kind.at_most, kind.at_most
    if unit == "dB":
        return -60.0, 60.0
    raise InputError(dotted, "a key without limits", "limits", f'Say them, as "{dotted} = 1..10".')


_TO = re.compile(r"(.+?)\.\.(.+)")


def read_free(text: str) -> tuple[str, str | None]:
    """Take a key and its range apart, as ``"track.pad_stiffness = 100..2000 MN/m"``."""
    name, sign, within = (each.strip() for each in text.partition("="))
    require(name and bool(within) == bool(sign), "free", shown(text), "a key, or a key = least..largest")
    return name, within or None


def read_range(what: str, within: object, unit: str) -> Range:
    """A least and a largest value: two numbers in SI, or text as ``"100..2000 MN/m"``; unit "1" for none."""
    allowed = 'a least and a largest value, as (1e8, 2e9) or "100..2000 MN/m"'
    if isinstance(within, str):
        found = _TO.fullmatch(within.strip())
        require(found, what, shown(within), allowed)
        assert found is not None
        low = found[1].strip()
        high = found[2].strip()
        if unit_in(high) and not unit_in(low):
            low = f"{low} {unit_in(high)}"
        within = (low, high)
    require(isinstance(within, Sequence) and len(within) == 2, what, shown(within), allowed)
    assert isinstance(within, Sequence)
    ends = []
    for end in within:
        try:
            ends.append(quantity(end, "" if unit == "1" else unit) if isinstance(end, str) else float(end))
        except (InputError, TypeError, ValueError) as error:
            remedy = error.remedy if isinstance(error, InputError) else ""
            raise InputError(what, shown(end), allowed, remedy) from None
    require(all(map(math.isfinite, ends)), what, shown(within), "finite ends")
    require(ends[0] < ends[1], what, shown(within), "a least value below the largest")
    return ends[0], ends[1]
