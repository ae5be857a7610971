"""What presses on what: the gap of the bodies on the contact grid, and Hertz's answer to it."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import scipy
from numpy.typing import NDArray

from asperity.case.scene import Case
from asperity.case.sections import ContactKeys
from asperity.contact import HalfSpace, Hertz
from asperity.contact.hertz import check_half_space, groove_gap
from asperity.contact.scan import window_for
from asperity.errors import CoarseSamplingWarning, HalfSpaceWarning, InputError
from asperity.scenarios.records import read_section
from asperity.surfaces.heightmap import Profile
from asperity.surfaces.levelling import level

HIGHEST_FORCE = 8.0
"""Largest force that the chosen states cover, in loads of the class of the working load."""
FILLED = 0.9
"""Share of the window's width for the smooth contact of the largest chosen state; rough ones vary."""
CLASS = 4.0
"""Ratio of the largest working load of a class to the smallest."""
WIDEST = 0.75
"""Share of the window's width for the smooth contact under the largest working load of a class."""


@dataclass(frozen=True, eq=False)
class Geometry:
    """The gap of two smooth bodies on the contact grid, and their closed-form contact."""

    # (nx, ny), gap of the smooth bodies at zero approach, m; zero at its lowest point, the middle cell
    body: NDArray[np.float64]
    spacing: tuple[float, float]  # (dx, dy), m
    modulus: float  # E*, Pa
    hertz: Hertz  # smooth contact; of the osculating paraboloids where the gap is none
    load: float  # working load, N
    largest_force: float  # that chosen states cover, N

    @property
    def semi_axes(self) -> tuple[float, float]:
        """Semi-axes of the nominal patch under the working load, m."""
        return self.axes(self.load)

    @property
    def filling_force(self) -> float:
        """Force whose smooth contact is as wide as the window, N."""
        sides = [n * d for n, d in zip(self.body.shape, self.spacing, strict=True)]
        one = self.axes(1.0)  # contacts grow as the cube root of the force
        return float(min(side / (2 * a) for side, a in zip(sides, one, strict=True)) ** 3)

    @property
    def class_load(self) -> float:
        """Load in the middle of the class that the working load belongs to, N.

        Samples are reduced alike for all loads of a class, so that they share every scan. Classes are counted
        from a contact that is `WIDEST` in the window.
        """
        top = WIDEST**3 * self.filling_force
        return top / CLASS ** (math.floor(math.log(top / self.load, CLASS)) + 0.5)

    @property
    def class_axes(self) -> tuple[float, float]:
        """Semi-axes of the nominal patch under the load of the class, m: within 26 % of `semi_axes`."""
        return self.axes(self.class_load)

    def axes(self, force: float) -> tuple[float, float]:
        """Semi-axes (a_x, a_y) of the nominal patch under a force, N; m."""
        return self.hertz.semi_axes(self.hertz.approach(force))

    def half_space(self, hardness: float | None) -> HalfSpace:
        """Make the half-space of the window, whose asperities flow at a pressure, Pa, or not at all."""
        nx, ny = self.body.shape
        return HalfSpace((nx, ny), self.spacing, self.modulus, hardness)

    def remedy_for_cut_off(self, highest: float, working: float, datum: float, widest: float) -> str:
        """Name a window that holds the contacts of all states, also of those that this one keeps out.

        Approaches of the highest state and under the working load, m; d0 of the states, m, minus the lowest
        first touch; widest window that the samples allow, m. One sentence.
        """
        wanted = max(HIGHEST_FORCE * self.class_load, self.largest_force)
        kept_out = self.hertz.approach(wanted) - self.hertz.approach(self.largest_force)
        overlap = highest + kept_out + datum
        side = window_for(self.body, self.spacing, overlap)
        if side <= widest:
            return f'contact.window = "{side * 1e3:.3g} mm" holds them.'
        text = f"It takes a window of {side * 1e3:.3g} mm, and the maps are {widest * 1e3:.3g} mm wide: "
        held = overlap * (widest / side) ** 2 - datum  # the side grows as the root of the overlap
        if held < working:
            return text + "measure wider maps, or remove the waviness by surface.longest."
        return (
            text + f"a window as wide as they are holds approaches up to {held * 1e6:.3g} µm; end "
            "contact.approaches there."
        )

    def within_window(self) -> Geometry:
        """Bound the states by a contact that the window holds."""
        largest = min(self.largest_force, max(FILLED**3 * self.filling_force, self.load))
        return replace(self, largest_force=largest)


def window_cells(contact: ContactKeys) -> int:
    """Cells along the window's side: odd, so that the lowest point of the gap lies on a cell."""
    return 2 * (contact.cells // 2) + 1


def cells_over(length: float, spacing: float) -> int:
    """Cells of a spacing that cover a length, both in m; one that is missed by rounding counts."""
    return math.ceil(length / spacing - 1e-6)


def across_window(contact: ContactKeys) -> NDArray[np.float64]:
    """Coordinates (n,) of the window's cells from its middle, in both directions, m."""
    n = window_cells(contact)
    return contact.spacing * np.arange(-(n // 2), n // 2 + 1, dtype=np.float64)


def parabola(contact: ContactKeys, radius: float) -> NDArray[np.float64]:
    """Section x²/2R (n,) of the gap on the window's cells, R and section in m."""
    return across_window(contact) ** 2 / (2.0 * radius)


def geometry_of(case: Case) -> Geometry:
    """Lay what rolls and what it rolls over out on the contact grid, under the static load.

    Where a section is measured, Hertz's contact is that of the paraboloid fitted to the gap over the width of
    the contact; in a groove the gap is that of circle in circle, and the half-space is asked for the angle
    that it fills. Refused are contacts that are not small against the bodies, wider than a beam's section, or
    not held by the window.
    """
    body, over, contact, hertz = case.rolling, case.rolled_over, case.contact, case.smooth_contact
    load = body.contact_load
    smallest = min(body.radius, body.across, over.radius_across, abs(body.raceway_along), hertz.radius_y)
    section = parabola(contact, hertz.radius_y)
    if body.groove_radius is not None:
        smallest = math.inf  # looked at below
        section = groove_gap(across_window(contact), body.across, body.groove_radius)
        _check_groove(case, hertz, load)
    elif body.profile is not None or over.profile is not None:
        section, hertz = _measured_gap(case, hertz, load)
        smallest = min(smallest, hertz.radius_y)
    shape = _geometry(contact, section, hertz, load, smallest_radius=smallest, body=case.ROLLING)
    width = 2.0 * max(shape.semi_axes)
    for side, size in over.sides.items():
        if size < width:
            allowed = f"at least {width * 1e6:.3g} um, the width of the smooth contact under {load:.3g} N"
            remedy = "A beam smaller than its contact is no elastic half-space: enlarge it, or press less."
            raise InputError(f"{case.over_name}.{side}", f"{size * 1e6:.3g} um", allowed, remedy)
    return shape.within_window()


def _check_groove(case: Case, hertz: Hertz, load: float) -> None:
    """Hold the contact under the load, and in the highest state given, to the half-space in a groove."""
    body, top = case.rolling, case.contact.approaches
    asked = [(hertz.approach(load), f"a working load of {load:.3g} N")]
    if top is not None:
        asked.append((top[-1], f"an approach of {top[-1] * 1e6:.3g} µm"))
    assert body.groove_radius is not None
    for approach, cause in asked:
        check_half_space(
            hertz.semi_axes(approach),
            body.across,
            groove_radius=body.groove_radius,
            raceway_radius=body.raceway_along,
            groove_width=body.groove_width,
            cause=cause,
        )


_FINE = 10
"""Points per cell on which the lowest point of a measured gap is looked for."""


class _Section:
    """Depth below the middle of one body across the path, m."""

    def __init__(self, measured: Path | Profile | None, radius: float, key: str) -> None:
        self.curvature, self.key, self.half_width = 1.0 / radius, key, math.inf
        self._spline = None
        if measured is not None:
            levelled = level(read_section(measured, key))
            count = len(levelled.heights)
            y = (np.arange(count) - 0.5 * (count - 1)) * levelled.spacing
            self._spline = scipy.interpolate.make_interp_spline(y, -levelled.heights, k=3)
            self.half_width = float(y[-1])

    def at(self, y: NDArray[np.float64]) -> NDArray[np.float64]:
        if self._spline is None:
            return 0.5 * self.curvature * y**2
        if (reach := np.abs(y).max()) > self.half_width:
            received = f"a section {2e3 * self.half_width:.4g} mm wide"
            allowed = f"at least {2e3 * reach:.4g} mm, the window about the point of contact"
            raise InputError(
                self.key, received, allowed, "Measure a wider section, or shrink contact.window."
            )
        return np.asarray(self._spline(y))


def _measured_gap(case: Case, hertz: Hertz, load: float) -> tuple[NDArray[np.float64], Hertz]:
    """Gap of measured sections across the window, (n,), m, and the contact of its osculating parabola."""
    y, body, over = across_window(case.contact), case.rolling, case.rolled_over
    keys = f"{case.ROLLING}.profile", f"{case.over_name}.rail_profile"
    tread = _Section(body.profile, body.across, keys[0])
    head = _Section(over.profile, over.radius_across, keys[1])
    gap = _lowest_in_the_middle(tread, head, y, " and ".join(keys))
    half = 0.5 * y[-1]
    for _ in range(10):
        inside = np.abs(y) <= max(half, 3 * case.contact.spacing)
        curvature = np.polynomial.polynomial.polyfit(y[inside], gap[inside], 2)[2]
        if curvature <= 0.0:
            received, allowed = "bodies that fit each other across the path", "a gap that opens on both sides"
            raise InputError(" and ".join(keys), received, allowed)
        hertz = replace(hertz, radius_y=float(0.5 / curvature))
        half = hertz.semi_axes(hertz.approach(load))[1]
    return gap, hertz


def _lowest_in_the_middle(
    tread: _Section, head: _Section, y: NDArray[np.float64], keys: str
) -> NDArray[np.float64]:
    """Gap across, m, moved so that the bodies first touch in the middle of the window."""
    reach = min(tread.half_width, head.half_width)
    middle = 0.0
    if np.isfinite(reach) and reach > y[-1]:
        fine = np.linspace(y[-1] - reach, reach - y[-1], _FINE * len(y))
        lowest = int(np.argmin(tread.at(fine) + head.at(fine)))
        around = (float(fine[max(lowest - 1, 0)]), float(fine[min(lowest + 1, len(fine) - 1)]))
        middle = scipy.optimize.minimize_scalar(
            lambda at: float((tread.at(np.array([at])) + head.at(np.array([at])))[0]),
            bounds=around,
            method="bounded",
            options={"xatol": 1e-7},
        ).x
    gap = tread.at(y + middle) + head.at(y + middle)
    gap = gap - gap[len(y) // 2]
    if gap.min() < -1e-9:
        allowed = "sections that touch in one place, convex against each other"
        raise InputError(keys, "bodies that touch outside the window's middle", allowed)
    return np.maximum(gap, 0.0)


def _geometry(
    contact: ContactKeys,
    section: NDArray[np.float64],
    hertz: Hertz,
    load: float,
    *,
    smallest_radius: float,
    body: str,
) -> Geometry:
    """Lay the gap x²/2R + section (n,), m, of two bodies out on the contact grid.

    The section is across the rolling direction, from `parabola` or of given profiles; the radius in the
    rolling direction is that of the smooth contact `hertz`, under the working load, N. The gap is checked
    against the half-space assumption: a contact that is not small against the smallest radius of curvature, m
    (a > R/3), is refused, and a window that does not hold it. `body` names what rolls in messages.
    """
    n, h = window_cells(contact), contact.spacing
    gap = parabola(contact, hertz.radius_x)[:, None] + section[None, :]
    shape = Geometry(gap, (h, h), hertz.modulus, hertz, load, load)
    carried = math.inf if contact.hardness is None else contact.hardness * h**2 * gap.size
    of_class = HIGHEST_FORCE * shape.class_load
    shape = replace(shape, largest_force=of_class if of_class < carried else HIGHEST_FORCE * load)
    axes = shape.semi_axes
    _check_half_space(max(axes), smallest_radius, f"a working load of {load:.3g} N", body)
    if contact.approaches is not None:
        top = contact.approaches[-1]
        cause = f"an approach of {top * 1e6:.3g} µm"
        _check_half_space(max(hertz.semi_axes(top)), smallest_radius, cause, body)
    if 2.2 * max(axes) > n * h:
        raise InputError(
            "contact.window",
            f"{n * h * 1e6:.4g} um",
            f"at least {2.2e6 * max(axes):.4g} um, 1.1 times the width of the smooth contact under "
            f"{load:.3g} N",
            "Enlarge the window.",
        )
    if h > 2.0 * min(axes):
        raise InputError(
            "contact.spacing",
            f"{h * 1e6:.3g} um",
            f"less than {2e6 * min(axes):.2g} um, the width of the smooth contact under {load:.3g} N",
            "Refine the spacing and the window with it, or press harder.",
        )
    if h > min(axes) / 8:
        warnings.warn(
            f"contact.spacing = {h * 1e6:.3g} µm is coarser than an eighth of the contact radius "
            f"({min(axes) * 1e6:.3g} µm under {load:.3g} N): forces carry an error of some per cent. "
            "Refine the spacing.",
            CoarseSamplingWarning,
            stacklevel=2,
        )
    return shape


def _check_half_space(a: float, radius: float, cause: str, body: str) -> None:
    if a > radius / 3:
        raise InputError(
            "contact",
            f"{cause}, a contact radius of {a / radius:.2g} R",
            f"a contact radius of at most R/3, where the {body} is an elastic half-space",
            f"Lower the load or the approaches, or take a larger {body}.",
        )
    if a > radius / 10:
        warnings.warn(
            f"{cause} makes a contact radius of {a / radius:.2g} R, above 0.1 R: the elastic half-space "
            "overestimates the stiffness by some per cent. Lower the load.",
            HalfSpaceWarning,
            stacklevel=3,
        )
