"""What comes before the work: the bodies, textures and geometry of a case, or all that is wrong with them."""

from __future__ import annotations

import math
import time
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from asperity.case.chosen import with_chosen
from asperity.case.scene import Case
from asperity.contact.batched import find_device
from asperity.errors import CaseError, InputError, PhysicsWarning
from asperity.reduction.filter import FEWEST_POSITIONS
from asperity.scenarios.expecting import problem_of_disk, scan_sizes
from asperity.scenarios.geometry import Geometry, geometry_of, window_cells
from asperity.scenarios.reducing import filter_stride
from asperity.scenarios.scene import Scene, scene_of
from asperity.scenarios.textures import Textures, textures_of, warn_of_textures
from asperity.store import Store
from asperity.threads import one_thread_in_linear_algebra, thread_count
from asperity.units import written

T = TypeVar("T")

STEEPEST = 1.0
"""Rms slope up to which surfaces are taken for such: the half-space is for small ones."""
ROUGHEST = 100.0
"""Rms height within the window up to which contacts are solved, in approaches of the smooth bodies."""
_UNITS = {
    "file": 'Are the heights in µm? Then set height_unit = "um", and the pixel with its unit.',
    "rms": 'Is rms in µm? Then write it so: rms = "0.5 um".',
    "line": 'Are the heights in µm? Then set line_unit = "um", and line_spacing with its unit.',
    "spectrum": "Are the levels in dB re 1 µm, and the wavelengths in their unit?",
}
"""What to ask about heights that are too large, by the key that they come from."""


@dataclass(frozen=True, eq=False)
class PreparedCase:
    """A case that can be computed."""

    case: Case
    scene: Scene  # what rolls over what
    shape: Geometry  # the gap of the bodies on the contact grid
    textures: Textures  # what is rolled over
    caught: tuple[warnings.WarningMessage, ...]  # warnings met on the way
    seconds: float  # that it took
    processor: float  # time, s


def prepare(case: Case, source: str = "case") -> PreparedCase:
    """Build and read all that a case needs, and refuse what cannot be computed, with all errors at once."""
    begin, spent = time.perf_counter(), time.process_time()
    with warnings.catch_warnings(record=True) as caught, one_thread_in_linear_algebra():
        warnings.simplefilter("always", PhysicsWarning)
        tried = _Attempts()
        scene = tried(lambda: scene_of(case))
        shape = tried(lambda: geometry_of(case))
        textures = tried(lambda: textures_of(case))
        tried(thread_count)
        tried(find_device)
        tried.refuse(source)
        assert scene is not None
        assert shape is not None
        assert textures is not None
        if (smaller := _within_the_map(case, textures)) is not None:
            return prepare(smaller, source)
        tried.errors += _problems(case, shape, textures)
        tried.refuse(source)
        warn_of_textures(case, shape, textures)
    seconds, processor = time.perf_counter() - begin, time.process_time() - spent
    return PreparedCase(case, scene, shape, textures, tuple(caught), seconds, processor)


def _within_the_map(case: Case, textures: Textures) -> Case | None:
    """The case with a window no wider than its measured maps, where it was chosen wider; else None."""
    smallest = min((min(sample.shape) for sample in textures.maps), default=math.inf)
    if "window" in case.contact.given_names or window_cells(case.contact) <= smallest:
        return None
    cells = int(smallest) - 1 + int(smallest) % 2  # odd, as those of every window
    return with_chosen(case, {"contact": {"window": cells * case.contact.spacing}})


class _Attempts:
    """Tries one thing after the other, so that all errors come at once."""

    def __init__(self) -> None:
        self.errors: list[InputError] = []

    def __call__(self, make: Callable[[], T]) -> T | None:
        try:
            return make()
        except InputError as error:
            self.errors.append(error)
            return None

    def refuse(self, source: str) -> None:
        if len(self.errors) == 1:
            raise self.errors[0]
        if self.errors:
            raise CaseError(source, [str(error) for error in self.errors])


def _problem_of_heights(case: Case, shape: Geometry, textures: Textures) -> InputError | None:
    """Heights that no surface has on which bodies roll: most often in another unit."""
    (nx, ny), maps = shape.body.shape, textures.maps
    slope, rough = float(np.sqrt(np.mean(np.diff(textures.line) ** 2))) / case.contact.spacing, 0.0
    if maps:
        slope = textures.rms_slope
        rough = float(np.mean([np.std(sample.heights[:nx, :ny]) for sample in maps]))
    approach = shape.hertz.approach(shape.load)
    if slope <= STEEPEST and rough <= ROUGHEST * approach:
        return None
    received = f"heights with an rms slope of {slope:.3g}"
    allowed = f"slopes up to {STEEPEST:g}"
    if slope <= STEEPEST:
        received = f"heights of {1e6 * rough:.3g} um rms within the window"
        allowed = f"up to {ROUGHEST:g} approaches of the bodies, {1e6 * approach:.3g} um each"
    key = next((key for key in _UNITS if getattr(case.surface, key) is not None), "")
    return InputError(f"surface.{key}".rstrip("."), received, allowed, _UNITS.get(key, ""))


def _problems(case: Case, shape: Geometry, textures: Textures) -> Iterator[InputError]:
    """What fits neither samples nor window."""
    contact, (nx, ny) = case.contact, shape.body.shape
    if (steep := _problem_of_heights(case, shape, textures)) is not None:
        yield steep
        return
    smallest = min((min(sample.shape) for sample in textures.maps), default=nx)
    if smallest < nx:
        allowed = f"at most the measured map, {smallest * contact.spacing * 1e6:.4g} um"
        received = written(contact.window, "m", "um")
        yield InputError("contact.window", received, allowed, "Choose a smaller contact.window.")
        return
    if textures.strips and any(strip.heights.any() for strip in textures.strips):
        rows, stride = min(strip.shape[0] for strip in textures.strips), filter_stride(shape)
        if (rows - nx) // stride + 1 < FEWEST_POSITIONS:
            least = (nx + (FEWEST_POSITIONS - 1) * stride) * contact.spacing
            received = f"strips of {rows * contact.spacing * 1e6:.4g} um"
            allowed = f"at least {least * 1e6:.4g} um, in which the contact is filtered"
            yield InputError(
                "contact.sample_length", received, allowed, "Lengthen it, or measure larger maps."
            )
    path = scan_sizes(case, shape, textures).get("path")
    if path is not None:
        yield from problem_of_disk(path, Store().root)
    if contact.running_in is not None and not textures.strips:
        allowed = "only together with a surface that asperities are known of: file, or rms"
        yield InputError(
            "contact.running_in", str(contact.running_in), allowed, "Remove the key, or name one."
        )
    if contact.hardness is not None:
        largest = contact.hardness * contact.spacing**2 * nx * ny
        needed = shape.load if contact.approaches is not None else shape.largest_force
        if needed >= largest:
            received = f"{contact.hardness / 1e9:.4g} GPa, with which the window carries {largest:.4g} N"
            allowed = f"more than the {needed:.4g} N that are needed"
            yield InputError("contact.hardness", received, allowed, "Enlarge contact.window.")
