"""What Python callers hand to `HalfSpace.scan`, checked, and the labelled array that they get."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from asperity.arguments import Array, real, real_array, shown, whole
from asperity.contact.batched import find_device
from asperity.contact.halfspace import BELOW_ONE, HalfSpace
from asperity.contact.scan import (
    ScanJob,
    ScannedForces,
    first_touch,
    rtol_for,
    scan_forces,
    warn_of_flaws,
    window_for,
)
from asperity.errors import InputError
from asperity.progress import Progress
from asperity.store import Cache
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.strip import Rows

if TYPE_CHECKING:
    import xarray


def scan_surface(
    half_space: HalfSpace,
    surface: ArrayLike | HeightMap,
    body: ArrayLike,
    approaches: ArrayLike,
    stride: int,
    rtol: float | None,
    force_accuracy: float | None,
    workers: int | None,
    cache: Cache | None,
    progress: Progress | None,
    device: str | None,
) -> xarray.DataArray:
    """Check the arguments of `HalfSpace.scan`, scan, and warn of flaws."""
    heights = heights_on(half_space, surface, "surface of the scan")
    job = ScanJob(
        half_space,
        Rows(heights - heights.mean()),
        real_array("body of the scan", body, "an array (nx, ny) of lengths in m"),
        real_array("approaches of the scan", approaches, "increasing lengths in m"),
        whole("stride of the scan", stride, "a whole number ≥ 1", at_least=1),
        _residual(rtol, force_accuracy),
        device=find_device(device),
    )
    check_settings(workers, cache, progress)
    scanned = scan_forces(job, cache=cache, workers=workers, progress=progress)
    remedy = ""
    if scanned.counts.truncated:
        overlap = job.approaches[-1] - float(first_touch(job.surface, job.body, job.stride).min())
        side = window_for(job.body, half_space.spacing, overlap)
        remedy = f"A window of {side * 1e3:.3g} mm holds them."
    tolerance = "rtol" if force_accuracy is None else "force_accuracy"
    warn_of_flaws(scanned.counts, "the scan", tolerance, remedy)
    return _labelled(job, scanned)


def heights_on(half_space: HalfSpace, surface: ArrayLike | HeightMap, what: str) -> Array:
    """Heights of a surface, complete and on the grid of a half-space, m; `what` names it in messages."""
    allowed = "a height map, or an array (n, ny) of finite lengths in m"
    if isinstance(surface, Profile):
        raise InputError(what, "a line of heights", "a map of heights")
    if isinstance(surface, HeightMap):
        if not np.allclose(surface.spacing, half_space.spacing, rtol=1e-9, atol=0.0):
            received, own = (
                f"{each[0]:.6g} × {each[1]:.6g} m" for each in (surface.spacing, half_space.spacing)
            )
            remedy = "Resample the map, or choose the half-space's spacing after it."
            raise InputError(
                what,
                f"a height map with points {received} apart",
                f"{own} apart, as in the half-space",
                remedy,
            )
        surface = surface.heights
    heights = real_array(what, surface, allowed)
    if heights.ndim != 2 or not np.isfinite(heights).all():
        missing = heights.size - int(np.isfinite(heights).sum())
        if missing:
            received = f"{missing} of {heights.size} points without a height"
            raise InputError(what, received, allowed, "Fill missing points.")
        raise InputError(what, f"an array {heights.shape}", allowed)
    return heights


def _residual(rtol: float | None, force_accuracy: float | None) -> float:
    if rtol is not None and force_accuracy is not None:
        raise InputError("rtol and force_accuracy", "both", "one of them", "Give one of the two, or neither.")
    if force_accuracy is not None:
        allowed = "a number above 0, at most 0.1, as 1e-4"
        return rtol_for(real("force_accuracy", force_accuracy, allowed, above=0.0, at_most=0.1))
    allowed = "a number between 0 and 1, as 1e-6"
    return 1e-6 if rtol is None else real("rtol", rtol, allowed, above=0.0, at_most=BELOW_ONE)


def check_settings(workers: object, cache: object, progress: object) -> None:
    """Refuse what is no number of threads, no cache, or no progress."""
    if workers is not None:
        whole("workers", workers, "a number of threads, 1 or more, or None", at_least=1)
    if cache is not None and not (hasattr(cache, "get") and hasattr(cache, "put")):
        raise InputError("cache", shown(cache), "an object with get and put, as Store(), or None")
    if progress is not None and not callable(progress):
        raise InputError("progress", shown(progress), "a callable (done, total, message), or None")


def _labelled(job: ScanJob, scanned: ScannedForces[Array]) -> xarray.DataArray:
    import xarray

    position = np.arange(job.positions) * job.stride * job.half_space.spacing[0]
    counts = scanned.counts
    return xarray.DataArray(
        scanned.forces,
        dims=("approach", "position"),
        coords={
            "approach": (
                "approach",
                job.approaches,
                {"units": "m", "long_name": "approach from the mean plane"},
            ),
            "position": ("position", position, {"units": "m", "long_name": "offset of the window along x"}),
        },
        name="force",
        attrs={
            "units": "N",
            "long_name": "quasi-static contact force",
            "iterations": counts.iterations,
            "unconverged": counts.unconverged,
            "truncated": counts.truncated,
        },
    )
