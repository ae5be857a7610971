"""Lengths that a case need not give: grid, window and waves follow from the contact of its smooth bodies."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple, Self

if TYPE_CHECKING:
    from asperity.config.case import Case
    from asperity.config.form import Section

CELLS = 9.0
"""Cells in the smaller semi-axis of the smooth contact, at least."""
CELLS_PER_WAVE = 4.0
"""Cells that the shortest wave has, so that single cells carry little of the load."""
SIDE = 3.2
"""Side of the window in larger semi-axes of the smooth contact: that under three loads, and a tenth more."""
FINEST = 1e-7
"""Least spacing that is chosen, m: heights are not known closer than light shows them."""
PEAKS, MOST_PEAKS = 3.0, 30.0
"""Peaks in the contact, in rms heights of waves shorter than the window, and at most in approaches."""
LONGEST = 20.0
"""Longest wave of a texture that is synthesised, in larger semi-axes: the contact follows it as a whole."""

_FIT_FOR_ALL = {
    "contact.spacing": min,
    "contact.window": max,
    "surface.shortest": min,
    "surface.longest": max,
}
"""Which of several chosen lengths suits all cases."""


class NominalPatch(NamedTuple):
    """Contact of smooth bodies under the working load: within a tenth where radii differ by up to five."""

    semi_axes: tuple[float, float]  # along and across the path, m
    approach: float  # m

    @classmethod
    def of(cls, modulus: float, radius_x: float, radius_y: float, load: float) -> Self:
        """Take the circle of mean relative radius, drawn out; E*, Pa, relative radii, m, and load, N."""
        radius, stretch = math.sqrt(radius_x * radius_y), (radius_x / radius_y) ** (1.0 / 3.0)
        a = (0.75 * load * radius / modulus) ** (1.0 / 3.0)
        return cls((a * stretch, a / stretch), a**2 / radius)


def choose_lengths(case: Case, patch: NominalPatch) -> None:
    """Fill in what a case does not say of the grid, of the window, and of a self-affine texture."""
    small, large = min(patch.semi_axes), max(patch.semi_axes)
    surface = _given(case.surface, ("longest", "shortest"))
    contact = _given(case.contact, ("spacing", "window"))
    fine = max(rounded(small / CELLS), FINEST)
    longest = surface.get("longest", math.inf)
    shortest = surface.get("shortest", 0.25 * longest)
    spacing = max(rounded(min(fine, shortest / CELLS_PER_WAVE, case.coarsest_spacing)), FINEST)
    spacing = contact.get("spacing", spacing)
    roughness, rms = 0.0, case.surface.rms
    if rms is not None:
        usual = max(2.0 * spacing, min(CELLS_PER_WAVE * max(spacing, fine), 0.25 * longest))
        shortest = surface.get("shortest", usual)
        longest = surface.get("longest", max(rounded(LONGEST * large), 4.0 * shortest))
        _fill_in(case, "surface", {"shortest": shortest, "longest": longest})
        roughness = rms * min(SIDE * large / longest, 1.0) ** case.surface.hurst
    peaks = min(PEAKS * roughness / patch.approach, MOST_PEAKS)
    window = rounded(max(SIDE * large * math.sqrt(1.0 + peaks), SIDE * large + case.defect_length), up=True)
    _fill_in(case, "contact", {"spacing": spacing, "window": window})


def _given(section: Section, names: tuple[str, ...]) -> dict[str, float]:
    """Those of some lengths that are given, m."""
    found = {name: getattr(section, name) for name in names if name in section.model_fields_set}
    return {name: value for name, value in found.items() if value is not None and not math.isnan(value)}


def rounded(length: float, *, up: bool = False) -> float:
    """The next length below, or above, of ten in a decade: 1, 1.25, 1.6, 2, 2.5, 3.2, 4, 5, 6.3, 8, m."""
    steps = (1.0, 1.25, 1.6, 2.0, 2.5, 3.2, 4.0, 5.0, 6.3, 8.0)
    decade = math.floor(math.log10(length))
    found = [float(f"{step}e{decade + more}") for more in (0, 1) for step in steps]
    if up:
        return min(each for each in found if each >= length * (1 - 1e-9))
    return max(each for each in found if each <= length * (1 + 1e-9))


def _fill_in(case: Case, name: str, chosen: Mapping[str, float]) -> None:
    """Put chosen lengths where a section says nothing; they do not count as given."""
    section: Section = getattr(case, name).model_copy()
    for each in chosen.keys() - _given(section, tuple(chosen)).keys():
        section.__dict__[each] = chosen[each]
        section.model_fields_set.discard(each)
    case.__dict__[name] = section


def with_chosen_window(case: Case, window: float) -> Case:
    """Return a case with another window, m, that does not count as given either."""
    changed = case.model_copy()
    _fill_in(changed, "contact", {"window": window})
    return changed


def shared_lengths(cases: Sequence[Case]) -> dict[str, float]:
    """Lengths that were chosen otherwise for some of these cases than for others, fit for all of them, m."""
    found = {}
    for key, fit in _FIT_FOR_ALL.items():
        title, _, name = key.partition(".")
        sections: list[Section] = [getattr(case, title) for case in cases]
        chosen = {getattr(each, name) for each in sections if name not in each.model_fields_set} - {None}
        if len(chosen) > 1:
            found[key] = fit(chosen)
    return found
