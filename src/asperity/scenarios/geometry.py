"""What presses on what: the gap of the bodies on the contact grid, and Hertz's answer to it."""

import math
from dataclasses import dataclass, replace

import numpy as np

from asperity.arguments import Array, require
from asperity.case import across, scene, sections
from asperity.case.rolled_over import TrackKeys
from asperity.contact.halfspace import HalfSpace
from asperity.contact.hertz import Hertz, check_half_space, groove_gap
from asperity.contact.scan import window_for
from asperity.errors import CoarseSamplingWarning, Grade, OutOfRangeWarning
from asperity.structures.outline import LARGEST_WHEEL, checked_outline, doubts_of
from asperity.surfaces.cell_means import cell_means
from asperity.written_numbers import in_newtons, rounded

CLEAR = 1.1
"""Least side of a window, over the width of the smooth contact under the load."""
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

    # (nx, ny), gap of the smooth bodies at zero approach, m; zero at its lowest point, the middle cell; of
    # covered cells the mean
    body: Array
    spacing: tuple[float, float]  # (dx, dy), m
    modulus: float  # E*, Pa
    hertz: Hertz  # smooth contact; of the osculating paraboloids where the gap is none
    load: float  # working load, N
    largest_force: float  # that chosen states cover, N
    cells: str = "whole"  # how cells at the rim of a contact count: as in `HalfSpace`

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
        return self.hertz.semi_axes_under(force)

    def half_space(self, hardness: float | None) -> HalfSpace:
        """Make the half-space of the window, whose asperities flow at a pressure, Pa, or not at all."""
        nx, ny = self.body.shape
        return HalfSpace((nx, ny), self.spacing, self.modulus, hardness, self.cells)

    def remedy_for_cut_off(self, highest: float, datum: float) -> str:
        """Name a window that holds the contacts of all states, also of those that this one keeps out.

        Approach of the highest state, m; d0 of the states, m, minus the lowest first touch. One sentence.
        """
        wanted = max(HIGHEST_FORCE * self.class_load, self.largest_force)
        kept_out = self.hertz.approach(wanted) - self.hertz.approach(self.largest_force)
        side = window_for(self.body, self.spacing, highest + kept_out + datum)
        return f'contact.window = "{rounded(side * 1e3)} mm" holds them.'

    def over_cells(self) -> "Geometry":
        """The same gap as means over its cells, which at rims count as far as they are covered."""
        return replace(self, body=cell_means(self.body), cells="covered")

    def on_long_cells(self) -> "Geometry":
        """The same gap at points of every second row, the middle one among them: cells are twice as long."""
        dx, dy = self.spacing
        return replace(self, body=self.body[len(self.body) // 2 % 2 :: 2], spacing=(2.0 * dx, dy))

    def within_window(self) -> "Geometry":
        """Bound the states by a contact that the window holds."""
        held = max(FILLED**3 * self.filling_force, self.load)
        return replace(self, largest_force=min(self.largest_force, held))


def window_cells(contact: sections.ContactKeys) -> int:
    """Cells along the window's side: odd, so that the lowest point of the gap lies on a cell."""
    return 2 * (contact.cells // 2) + 1


def cells_over(length: float, spacing: float) -> int:
    """Cells of a spacing that cover a length, both in m; one that is missed by rounding counts."""
    return math.ceil(length / spacing - 1e-6)


def across_window(contact: sections.ContactKeys) -> Array:
    """Coordinates (n,) of the window's cells from its middle, in both directions, m."""
    n = window_cells(contact)
    return contact.spacing * np.arange(-(n // 2), n // 2 + 1, dtype=np.float64)


def parabola(contact: sections.ContactKeys, radius: float) -> Array:
    """Section x²/2R (n,) of the gap on the window's cells, R and section in m."""
    return across_window(contact) ** 2 / (2.0 * radius)


def geometry_of(case: scene.Case) -> Geometry:
    """Lay what rolls and what it rolls over out on the contact grid, under the static load.

    The gap x²/2R + section is that of the smooth contact along the path; the section across is x²/2R, too, or
    measured: then Hertz's contact is that of the paraboloid fitted to the gap over the width of the contact;
    or in a groove that of circle in circle. Refused are contacts that are not small against the bodies, wider
    than a beam's section, or not held by the window, and a grid that is coarser than they are.
    """
    body = case.rolling
    over = case.rolled_over
    contact = case.contact
    hertz = case.smooth_contact
    load = body.contact_load
    n = window_cells(contact)
    h = contact.spacing
    section = parabola(contact, hertz.radius_y)
    met = None
    if body.groove_radius is not None:
        section = groove_gap(across_window(contact), body.across, body.groove_radius)
    elif body.profile is not None or over.profile is not None or case.meeting is not None:
        met = case.meeting or across.meeting_of(case)
        section, hertz = _measured_gap(case, met, hertz, load)
    gap = parabola(contact, hertz.radius_x)[:, None] + section[None, :]
    shape = Geometry(gap, (h, h), hertz.modulus, hertz, load, load)
    carried = math.inf if contact.hardness is None else contact.hardness * h**2 * gap.size
    of_class = HIGHEST_FORCE * shape.class_load
    shape = replace(shape, largest_force=of_class if of_class < carried else HIGHEST_FORCE * load)
    _check_half_space(case, met, hertz, load)
    _doubt_wheel(case)
    width = 2.0 * max(shape.semi_axes)
    for side, size in over.sides.items():
        allowed = (
            f"at least {rounded(width * 1e6)} um, the width of the smooth contact under {in_newtons(load)}"
        )
        remedy = "A beam smaller than its contact is no elastic half-space: enlarge it, or press less."
        require(size >= width, f"{case.over_name}.{side}", f"{rounded(size * 1e6)} um", allowed, remedy)
    _check_grid(n, h, shape.semi_axes, load)
    return shape.within_window()


SECTIONS = (
    "Look at the sections first: do they hold radii, no diameters, and lie as on the rail "
    "(sideways.rail_inclination lays them so)? Else lower the load"
)
"""What makes a contact smaller that sections as they were measured make too large."""


def _check_half_space(case: scene.Case, met: across.Meeting | None, hertz: Hertz, load: float) -> None:
    """Hold the contact under the load, and in the highest state given, to the half-space."""
    body = case.rolling
    top = case.contact.approaches
    asked = [(hertz.approach(load), f"a working load of {in_newtons(load)}")]
    if top is not None:
        asked.append((top[-1], f"an approach of {rounded(top[-1] * 1e6)} µm"))
    bent = abs(body.raceway_along)
    smallest = min(body.radius, body.across, case.rolled_over.radius_across, bent, hertz.radius_y)
    lighter = "Lower the load" if met is None else " ".join((*met.doubts, SECTIONS))
    for approach, cause in asked:
        along, across = axes = hertz.semi_axes(approach)
        if body.groove_radius is None:
            longest = (along, 0.0) if along >= across else (0.0, across)
            check_half_space(longest, smallest, cause=cause, lighter=lighter)
        else:
            check_half_space(
                axes, body.across, groove_radius=body.groove_radius, raceway_radius=body.raceway_along,
                cause=cause,
            )  # fmt: skip


def _doubt_wheel(case: scene.Case) -> None:
    """Warn of a wheel on a rail that is hardly meant as it was given."""
    wheel = case.rolling
    name = case.ROLLING
    if not isinstance(case.rolled_over, TrackKeys):
        return
    if wheel.is_drawn:
        for doubt in doubts_of(checked_outline(wheel.outline), wheel.radius):
            OutOfRangeWarning.warn(f"{name}: {doubt}")
    elif wheel.radius > LARGEST_WHEEL:
        radius = f"{name}.radius = {rounded(wheel.radius * 1e3, 4)} mm"
        OutOfRangeWarning.warn(f"{radius}: wheels of trains have 170 mm to 625 mm. Is it the diameter?")


def _check_grid(cells: int, spacing: float, axes: tuple[float, float], load: float) -> None:
    """Hold the grid to the smooth contact under the load, N: the window holds it, cells are finer than it."""
    wide = CLEAR * 2e6 * max(axes)
    small = min(axes)
    width = f"the width of the smooth contact under {in_newtons(load)}"
    allowed = f"at least {rounded(wide, 4)} um, {CLEAR:g} times {width}"
    held = cells * spacing * 1e6
    require(held >= wide, "contact.window", f"{rounded(held, 4)} um", allowed, "Enlarge the window.")
    allowed = f"less than {rounded(2e6 * small, 2)} um, {width}"
    remedy = "Refine the spacing and the window with it, or press harder."
    require(spacing <= 2.0 * small, "contact.spacing", f"{rounded(spacing * 1e6)} um", allowed, remedy)
    if spacing > small / 8:
        CoarseSamplingWarning.warn(
            f"contact.spacing = {rounded(spacing * 1e6)} µm is coarser than an eighth of the contact radius "
            f"({rounded(small * 1e6)} µm under {in_newtons(load)}): the stiffness of whole cells is some "
            "per cent off. Refine the spacing."
        )


def _measured_gap(case: scene.Case, met: across.Meeting, hertz: Hertz, load: float) -> tuple[Array, Hertz]:
    """Gap of measured sections across the window, (n,), m, and the contact of its osculating parabola."""
    y = across_window(case.contact)
    both = " and ".join(across.section_keys(case))
    for sentence in across.turned_sections(case, met):
        OutOfRangeWarning.warn(sentence, Grade.NOTE)
    for sentence in met.doubts:
        OutOfRangeWarning.warn(sentence)
    gap = met.gap(y)
    allowed = "sections that touch in one place, convex against each other"
    require(gap.min() >= -1e-9, both, "bodies that touch outside the window's middle", allowed)
    gap = np.maximum(gap, 0.0)
    half = 0.5 * y[-1]
    for _ in range(10):
        inside = np.abs(y) <= max(half, 3 * case.contact.spacing)
        curvature = np.polynomial.polynomial.polyfit(y[inside], gap[inside], 2)[2]
        received = "bodies that fit each other across the path"
        allowed = "a gap that opens on both sides"
        require(curvature > 0.0, both, received, allowed)
        hertz = replace(hertz, radius_y=float(0.5 / curvature))
        half = hertz.semi_axes_under(load)[1]
    if doubt := met.doubt_of_printed(hertz.radius_y, half, both):
        OutOfRangeWarning.warn(doubt)
    return gap, hertz
