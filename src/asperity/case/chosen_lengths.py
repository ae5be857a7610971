"""Lengths that a case need not give: grid, window and waves follow from the contact of its smooth bodies."""

import math
from bisect import bisect_left, bisect_right
from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import TypeVar

from asperity.case.any_case import AnyCase
from asperity.case.rolling_case import RollingCase
from asperity.contact.hertz import Hertz
from asperity.errors import InputError

C = TypeVar("C", bound=AnyCase)

CELLS = 9.0
"""Cells in the smaller semi-axis of the smooth contact, at least."""
CELLS_PER_WAVE = 4.0
"""Cells that the shortest wave has, so that single cells carry little of the load."""
SIDE = 3.2
"""Side of the window in larger semi-axes of the smooth contact: that under three loads, and a tenth more."""
NARROWEST = 2.5
"""And at least, where no more was measured across the path."""
FINEST = 1e-7
"""Least spacing that is chosen, m: heights are not known closer than light shows them."""
PEAKS, MOST_PEAKS = 3.0, 30.0
"""Peaks in the contact, in rms heights of waves shorter than the window, and at most in approaches."""
_STEPS = (1.0, 1.25, 1.6, 2.0, 2.5, 3.2, 4.0, 5.0, 6.3, 8.0)

_FIT_FOR_ALL = {
    "contact.spacing": min,
    "contact.window": max,
    "surface.shortest": min,
    "surface.longest": max,
}
"""Which of several chosen lengths suits all cases."""


def chosen_lengths(case: RollingCase) -> dict[str, dict[str, float]]:
    """Grid, window and waves of a self-affine texture, m, by section: as given, else as fits the contact.

    The contact of smooth bodies under the working load is taken for the circle of mean relative radius, drawn
    out: within a tenth where radii differ by up to five.
    """
    hertz, held = _contact_across(case)
    radius = math.sqrt(hertz.radius_x * hertz.radius_y)
    stretch = (hertz.radius_x / hertz.radius_y) ** (1.0 / 3.0)
    circle = (0.75 * case.rolling.contact_load * radius / hertz.modulus) ** (1.0 / 3.0)
    small, large = sorted((circle * stretch, circle / stretch))
    surface, contact = (
        {name: getattr(section, name) for name in names if name in section.given_names}
        for section, names in ((case.surface, ("longest", "shortest")), (case.contact, ("spacing", "window")))
    )
    fine = max(preferred_length(small / CELLS), FINEST)
    longest = surface.get("longest", math.inf)
    shortest = surface.get("shortest", 0.25 * longest)
    spacing = max(preferred_length(min(fine, shortest / CELLS_PER_WAVE, case.coarsest_spacing)), FINEST)
    spacing = contact.get("spacing", spacing)
    roughness = 0.0
    rms = case.surface.rms
    if rms is not None:
        usual = max(2.0 * spacing, min(CELLS_PER_WAVE * max(spacing, fine), 0.25 * longest))
        shortest = surface.get("shortest", usual)
        longest = surface.get("longest") or _longest_wave(case, max(SIDE * large, 4.0 * shortest))
        surface = {"shortest": shortest, "longest": longest}
        roughness = rms * min(SIDE * large / longest, 1.0) ** case.surface.hurst
    peaks = min(PEAKS * roughness / (circle**2 / radius), MOST_PEAKS)
    wanted = max(SIDE * large * math.sqrt(1.0 + peaks), SIDE * large + case.defect_length)
    window = preferred_length(wanted, up=True)
    if window > held >= NARROWEST * large:
        window = preferred_length(held)
    return {"surface": surface, "contact": {"spacing": spacing, "window": window}}


def _longest_wave(case: RollingCase, least: float) -> float:
    """Longest wave, m: that of what is rolled over, whatever rolls, in tens of it where that is too short."""
    longest = case.rolled_over.LONGEST_WAVE
    return float(longest * 10.0 ** max(0, math.ceil(math.log10(least / longest) - 1e-9)))


def _contact_across(case: RollingCase) -> tuple[Hertz, float]:
    """Contact of the smooth bodies, by their measured sections, and how wide a window these hold, m."""
    hertz = case.smooth_contact
    if case.rolling.groove_radius is not None or (
        case.rolling.profile is None and case.rolled_over.profile is None
    ):
        return hertz, math.inf
    from asperity.case.across import meeting_of

    with suppress(InputError):  # sections that cannot touch: said where they are laid out
        met = meeting_of(case, clear=0.0)
        if (found := met.osculating(hertz, case.rolling.contact_load)) is not None:
            return found, 2.0 * met.inside
    return hertz, math.inf


def preferred_length(length: float, *, up: bool = False) -> float:
    """The next length below, or above, of ten in a decade: 1, 1.25, 1.6, 2, 2.5, 3.2, 4, 5, 6.3, 8, m."""
    decade = math.floor(math.log10(length))
    lengths = [float(f"{step}e{decade + more}") for more in (0, 1) for step in _STEPS]
    if up:
        return lengths[bisect_left(lengths, length * (1 - 1e-9))]
    return lengths[bisect_right(lengths, length * (1 + 1e-9)) - 1]


def with_chosen(case: C, chosen: Mapping[str, Mapping[str, float]]) -> C:
    """Return a case with lengths, m, by section, where it gives none; they do not count as given."""
    sections = {title: getattr(case, title).with_chosen(**lengths) for title, lengths in chosen.items()}
    return case.with_chosen(**sections)


def shared_lengths(cases: Sequence[AnyCase]) -> dict[str, float]:
    """Lengths that were chosen otherwise for some of these cases than for others, fit for all of them, m."""
    shared = {}
    for key, fit in _FIT_FOR_ALL.items():
        title, _, name = key.partition(".")
        sections = [getattr(case, title) for case in cases]
        chosen = {getattr(each, name) for each in sections if name not in each.given_names} - {None}
        if len(chosen) > 1:
            shared[key] = fit(chosen)
    return shared
