"""A contact to play with: one sample of a case's surface under its body, pressed by hand."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from asperity.arguments import Array
from asperity.case.any_case import AnyCase, function_named
from asperity.case.ball_bearing import BearingUnderLoad
from asperity.case.scene import Case
from asperity.contact.halfspace import HalfSpace
from asperity.contact.solved import Contact
from asperity.errors import CaseError, InputError
from asperity.reduction.stiffness import patches
from asperity.reduction.texture import punch_weights
from asperity.scenarios.geometry import Geometry
from asperity.scenarios.prepared_bearing import prepare_bearing, raceways_of
from asperity.scenarios.preparing import prepare
from asperity.scenarios.roller_raceways import on_cells
from asperity.scenarios.scene import PreparedCase
from asperity.scenarios.textures import strip_rows
from asperity.speeds import at_fastest
from asperity.written_numbers import rounded

MOST_CELLS_SHOWN = 129
"""Cells along a side of the window that are solved; of wider ones every second, third, … is taken."""
CURVE = 16
"""States of the curve of k_c."""
RTOL = 1e-5
DESCRIBED = (
    "spacing",
    "thinning",
    "heights",
    "source",
    "load",
    "passing",
    "passing_at",
    "touch",
    "deepest",
    "working",
)
"""What is told of a sample that does not change while it is pressed."""
SPARE = 4.0
"""Length of the path beyond a strip for the filters, in windows: one sample needs no longer one."""


@dataclass(frozen=True, eq=False)
class PressedSurface:
    """What is pressed: a body on heights, on the window of a contact."""

    shape: Geometry  # gap, load and smooth contact
    heights: Array  # (nx, ny), m, peaks positive
    speed: float  # of the contact along them, m/s
    hardness: float | None  # Pa
    source: str  # where the heights come from
    at: str = ""  # of which speed it is, of one that changes


class PressedSample:
    """One sample of a surface, which is pressed to one approach after the other, each from the last pressure.

    Forces, pressures and k_c are those of `HalfSpace.solve`. r counts from the first touch of this sample;
    in a run it counts from the highest one of all samples.
    """

    def __init__(self, case: AnyCase) -> None:
        pressed: PressedSurface = function_named(case.PRESSED_BY)(case)
        shape = pressed.shape.within_window()
        self.heights, gap, self.thinning = _thinned(pressed)
        self.spacing = tuple(self.thinning * d for d in shape.spacing)
        self.load = shape.load
        self.hertz = shape.hertz
        self.passing = pressed.speed / (2.0 * shape.semi_axes[0])  # Hz, of waves as long as the contact
        self.passing_at = pressed.at
        self.half_space = HalfSpace(
            (gap.shape[0], gap.shape[1]), (self.spacing[0], self.spacing[1]), shape.modulus,
            pressed.hardness,
        )  # fmt: skip
        self.gap = gap
        self.source = pressed.source
        self.touch = float(gap.min())
        self.last = self.half_space.solve(gap, load=self._largest(shape), rtol=RTOL)
        self.deepest = self.last.approach
        share = np.linspace(1.0, 0.0, CURVE, endpoint=False) ** 1.5  # from the deepest, denser at touch
        states = self.touch + (self.deepest - self.touch) * share
        self.curve = [_state(self._at(approach), self.touch) for approach in states]
        self.last = self.half_space.solve(gap, load=self.load, start=self.last.pressure, rtol=RTOL)
        self.working = self.last.approach

    def _largest(self, shape: Geometry) -> float:
        """Largest force, N, that the window holds and, with a hardness, carries."""
        cells = self.gap.size
        carried = 0.9 * self.half_space.pressure_cap * self.half_space.cell_area * cells
        largest = min(shape.largest_force, carried)
        if largest <= shape.load:
            received = f"{rounded(self.half_space.pressure_cap / 1e9)} GPa"
            allowed = f"a hardness with which the window carries the load of {rounded(shape.load)} N"
            raise InputError("contact.hardness", received, allowed)
        return largest

    def _at(self, approach: float) -> Contact:
        self.last = self.half_space.solve(self.gap, approach=approach, start=self.last.pressure, rtol=RTOL)
        return self.last

    def at(self, share: float | None) -> dict[str, Any]:
        """Press to an approach: a share, 0 to 1, of the way from touch to the deepest; None to the load."""
        reach = self.deepest - self.touch
        wanted = self.working if share is None else self.touch + min(max(share, 0.0), 1.0) * reach
        contact = self._at(wanted)
        pressure = contact.pressure
        smooth = self.hertz.force(max(contact.approach, 0.0))
        return {
            "share": (wanted - self.touch) / reach if reach else 0.0,
            "pressure": pressure,
            "largest_pressure": float(pressure.max()),
            "area": contact.real_area,
            "converged": contact.converged,
            "at_edge": contact.edge_share,
            "smooth_force": float(smooth),
            **_state(contact, self.touch),
        }

    def described(self) -> dict[str, Any]:
        """What does not change while the slider moves."""
        return {
            "shape": list(self.gap.shape),
            "curve": self.curve[::-1],
            **{name: getattr(self, name) for name in DESCRIBED},
        }


def _state(contact: Contact, touch: float) -> dict[str, float]:
    """Force and stiffness at an approach: k_c = F/r (Eq. 2.3), and dF/dδ."""
    state = contact.approach - touch
    secant = contact.force / state if state > 0.0 else 0.0
    return {
        "approach": contact.approach,
        "state": state,
        "force": contact.force,
        "stiffness": secant,
        "tangent_stiffness": contact.stiffness,
    }


def _prepared(case: Case) -> PreparedCase:
    """Lay a case ready with a path as short as it may be; where none is allowed, with its own."""
    contact = case.contact
    length = strip_rows(contact) * contact.spacing + SPARE * contact.window
    if case.surface.rms is not None:  # each sample is synthesised by itself, and one is pressed
        case = case.with_(contact={"samples": 1})
    try:
        speed = float(case.speed)
        duration = max(length / speed, 2.0 * case.time_step)
        return prepare(case.with_(speed=speed, duration=duration, settling=0.0))
    except (InputError, CaseError):
        return prepare(case)


def scene_surface(case: Case) -> PressedSurface:
    """The first sample of a case under its body."""
    prepared = _prepared(case)
    shape = prepared.shape
    maps = prepared.textures.maps
    heights = np.zeros_like(shape.body)
    source = "smooth bodies: no sample is given"
    if maps:
        cells = (shape.body.shape[0], shape.body.shape[1])
        weights = punch_weights(shape.spacing, shape.semi_axes)
        heights = patches([m.heights for m in maps], cells, prepared.case.contact.samples, weights)[0]
        source = prepared.textures.origin
    at = at_fastest(case.speed)
    return PressedSurface(shape, heights, case.speed, case.contact.hardness, source, at)


def raceway_surface(case: BearingUnderLoad) -> PressedSurface:
    """The most loaded ball on the outer raceway: over the middle of what is damaged, else where it begins."""
    on = raceways_of(prepare_bearing(case), None)[1]
    _, passing = case.passing_speeds
    damaged = np.flatnonzero(on.surface.damaged.any(axis=1))
    middle = int(damaged[len(damaged) // 2]) if damaged.size else 0
    rows = (np.arange(len(on.shape.body)) - len(on.shape.body) // 2 + middle) % on.rows
    heights = on_cells(on, on.surface.heights + on.surface.faults)[rows]
    where = "over the middle of what is damaged" if damaged.size else "where it begins"
    element = case.bearing.bearing.ELEMENT
    source = f"the most loaded {element} on the outer raceway, {where}; long waves lift it as a whole"
    at = at_fastest(case.speed, "1/min", 60.0)
    return PressedSurface(on.shape, heights, passing, on.hardness, source, at)


def _thinned(pressed: PressedSurface) -> tuple[Array, Array, int]:
    """Heights and gap (nx, ny), m, and how many cells apart their points are."""
    heights = pressed.heights
    body = pressed.shape.body
    step = math.ceil(max(heights.shape) / MOST_CELLS_SHOWN)
    first = [(n // 2) % step for n in heights.shape]  # the middle cell stays
    thinned = heights[first[0] :: step, first[1] :: step]
    gap = body[first[0] :: step, first[1] :: step] - thinned
    return thinned, np.ascontiguousarray(gap), step
