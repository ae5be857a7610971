"""How long the scan of a case's path will take, and what it will keep on disk, before it starts."""

from __future__ import annotations

import math
import shutil
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from asperity.config import BallOnBeamCase, Case, WheelOnRailCase
from asperity.errors import InputError, PhysicsWarning
from asperity.reduction.accuracy import FILTER_SHARE, in_single, rtol_for
from asperity.reduction.real_contact import expected_area_ratio as expected_area_ratio_of
from asperity.reduction.scan import BLOCK
from asperity.reference.materials import contact_modulus
from asperity.scenarios import rail_textures
from asperity.scenarios.ball_on_beam import ball_geometry
from asperity.scenarios.geometry import HIGHEST_FORCE, Geometry, window_cells
from asperity.scenarios.laws import table_stride
from asperity.scenarios.line_filters import filter_stride
from asperity.scenarios.rail_geometry import rail_geometry
from asperity.scenarios.reducing import STATES
from asperity.scenarios.textures import measured_maps, strip_rows, synthesised
from asperity.structures.ball import Ball
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.statistics import rms_slope
from asperity.threads import thread_count

SOLUTION_TIME = 1e-5
"""Time of a contact solution on one core at the accuracy of a scan, beside that of its cells, s."""
CELL_TIME = 7e-8
"""Time of a contact solution for each cell of the box around the overlap, s."""
SINGLE_TIME = 0.65
"""Time of a contact solution in single precision to that in double."""
BLOCK_BYTES = 1200
"""What the file of a block holds beside its forces, bytes."""


@dataclass(frozen=True)
class Expected:
    """What a scan will take, in order of magnitude: processors differ by a factor of two or three.

    Attributes
    ----------
    positions, states : int
        Size of the scan.
    step : float
        Distance of the positions, m.
    seconds : float
        Time on all threads, nothing of it found in the cache.
    bytes : int
        Size on disk.
    single : bool
        Whether the iteration will be in single precision.
    """

    positions: int
    states: int
    step: float
    seconds: float
    bytes: int
    single: bool

    @property
    def solutions(self) -> int:
        """Contact solutions, at most: states that do not touch need none."""
        return self.positions * self.states


def expected_scans(case: Case) -> dict[str, Expected]:
    """Expect the scans of a case.

    Parameters
    ----------
    case : BallOnBeamCase or WheelOnRailCase
        The case.

    Returns
    -------
    dict of Expected
        ``"filters"`` where samples are scanned, ``"path"`` where `table` is among the laws.

    Raises
    ------
    InputError
        If the bodies do not fit the contact's window.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PhysicsWarning)  # the run tells
        shape = _geometry(case)
    contact, window = case.contact, window_cells(case.contact)
    result = {}
    if isinstance(case, WheelOnRailCase) or case.surface.has_samples:
        rows = contact.samples * max(strip_rows(contact) - window, 1)
        result["filters"] = _expected(case, shape, rows, filter_stride(shape), FILTER_SHARE)
    if "table" in case.laws:
        pace = case.speed / contact.spacing
        rows = math.ceil(case.settled_time * pace) + math.ceil(case.rolled_time * pace) + 2 + window
        result["path"] = _expected(case, shape, rows, table_stride(shape))
    return result


def expected_area_ratio(case: Case) -> float | None:
    """Expect the real contact area under the working load over that of smooth bodies.

    Parameters
    ----------
    case : BallOnBeamCase or WheelOnRailCase
        The case.

    Returns
    -------
    float or None
        About what `asperity.scenarios.reducing.Reduction.area_ratio` will be, from the slope of the
        samples; None where the case has none.

    Raises
    ------
    InputError
        If a file does not hold what the case needs of it.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PhysicsWarning)
        shape, samples = _geometry(case), _samples(case)
    if not samples:
        return None
    slope = float(np.sqrt(np.mean([rms_slope(sample) ** 2 for sample in samples])))
    peak = 1.5 * shape.load / (np.pi * math.prod(shape.semi_axes))
    return expected_area_ratio_of(slope, peak, shape.modulus)


def _samples(case: Case) -> tuple[HeightMap, ...]:
    """Samples like those of the case, without its path."""
    rows = strip_rows(case.contact)
    if isinstance(case, WheelOnRailCase):
        short = {"duration": rows * case.contact.spacing / case.speed, "settling": 0.0}
        return rail_textures.gather(case.model_copy(update=short)).maps
    if case.surface.file is not None:
        return measured_maps(case.surface, case.contact.spacing)[0]
    if case.surface.rms is None:
        return ()
    size = (rows, window_cells(case.contact))
    return (synthesised(case.surface, case.contact.spacing, size, case.seed),)


def direct_time(case: Case) -> float:
    """Time of a contact solution under the working load, s."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PhysicsWarning)
        shape = _geometry(case)
    return float(_solution_times(shape, np.array([shape.hertz.approach(shape.load)]))[0])


def check_disk(expected: Expected, root: Path) -> None:
    """Refuse a scan that the disk cannot hold.

    Parameters
    ----------
    expected : Expected
        The scan.
    root : Path
        Folder of the cache.

    Raises
    ------
    InputError
        If the disk has less room.
    """
    existing = next(folder for folder in (root.absolute(), *root.absolute().parents) if folder.exists())
    free = shutil.disk_usage(existing).free
    if free < expected.bytes:
        raise InputError(
            "disk of the cache",
            f"{free / 2**20:.0f} MiB free in {root}",
            f"{expected.bytes / 2**20:.0f} MiB for the scan of the path",
            "Set $ASPERITY_CACHE to a folder on another disk, or free some space.",
        )


def _geometry(case: Case) -> Geometry:
    if isinstance(case, WheelOnRailCase):
        return rail_geometry(case)
    assert isinstance(case, BallOnBeamCase)
    ball = Ball(case.ball.radius, case.ball.material, case.ball.load, case.ball.mass)
    modulus = contact_modulus(case.ball.material, case.beam.material)
    return ball_geometry(case, ball.static_load, modulus)


def _expected(case: Case, shape: Geometry, rows: int, stride: int, share: float = 1.0) -> Expected:
    """Expect a scan whose forces are accurate to a share of what the case asks for."""
    positions = -(-rows // stride)
    approaches = _approaches(case, shape)
    seconds = float(_solution_times(shape, approaches).sum()) * positions / thread_count()
    cells = positions * approaches.size * shape.body.size
    single = in_single(rtol_for(share * case.numerics.force_accuracy), cells)
    seconds *= SINGLE_TIME if single else 1.0
    size = positions * len(approaches) * 8 + -(-positions // BLOCK) * BLOCK_BYTES
    return Expected(positions, len(approaches), stride * shape.spacing[0], seconds, size, single)


def _solution_times(shape: Geometry, approaches: NDArray[np.float64]) -> NDArray[np.float64]:
    """Time of a contact solution at each approach on one core, by the box around the overlap, s."""
    radii = (shape.hertz.radius_x, shape.hertz.radius_y)
    cells = np.ones(len(approaches))
    for n, d, radius in zip(shape.body.shape, shape.spacing, radii, strict=True):
        cells *= np.minimum(n, 2.0 * np.sqrt(2.0 * radius * approaches) / d)
    return SOLUTION_TIME + CELL_TIME * cells


def _approaches(case: Case, shape: Geometry) -> NDArray[np.float64]:
    """Overlaps of smooth bodies in the states: as given, or up to the force that chosen states reach."""
    if case.contact.approaches is not None:
        return np.maximum(np.array(case.contact.approaches), 0.0)
    highest = shape.hertz.approach(min(shape.largest_force, HIGHEST_FORCE * shape.load))
    return np.asarray(highest * np.linspace(0.0, 1.0, STATES) ** 1.3)
