"""Nominal form of a surface: sphere, cylinder or polynomial, fitted and removed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product
from typing import Literal, TypeVar

import numpy as np
import scipy
from numpy.typing import NDArray

from asperity.errors import ComputationError, InputError
from asperity.surfaces.heightmap import HeightMap, Profile

Surface = TypeVar("Surface", HeightMap, Profile)


@dataclass(frozen=True, eq=False)
class Form:
    """Least-squares form of a surface."""

    kind: str  # ``"sphere"``, ``"cylinder"`` or ``"polynomial"``
    heights: NDArray[np.float64]  # of the form, m, with the shape of the surface
    radius: float  # of curvature, m, positive for a hill and negative for a hollow; NaN for a polynomial


def remove_form(
    surface: Surface, form: Literal["sphere", "cylinder", "polynomial"] = "sphere", *, degree: int = 2
) -> Surface:
    """Remove the form that `fit_form` finds, m; missing points stay missing."""
    return replace(surface, heights=surface.heights - fit_form(surface, form, degree=degree).heights)


def fit_form(
    surface: HeightMap | Profile,
    form: Literal["sphere", "cylinder", "polynomial"] = "sphere",
    *,
    degree: int = 2,
) -> Form:
    """Fit a form by least squares of the height differences, m.

    A cylinder lies in any direction of the plane and may be tilted slightly along its axis; for a profile,
    sphere and cylinder both mean a circle. `degree` is the total degree of the polynomial. The differences
    are taken along z, not along the normal: the same for a cap that is shallow against its radius, as
    measured patches are.
    """
    if form == "polynomial":
        return Form("polynomial", polynomial(surface, degree), float("nan"))
    if form not in ("sphere", "cylinder"):
        raise InputError("form", repr(form), "'sphere', 'cylinder' or 'polynomial'")
    x, y, scale = _coordinates(surface)
    valid = np.isfinite(surface.heights)
    terms = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=-1)
    if isinstance(surface, Profile):
        terms[..., [2, 4, 5]] = 0.0
    _check_count(valid, 6 if surface.heights.ndim == 2 else 3)
    quadratic = np.asarray(
        np.linalg.lstsq(terms[valid], surface.heights[valid], rcond=None)[0], dtype=np.float64
    )
    if isinstance(surface, Profile) or form == "sphere":
        start, sag = _sphere_start(quadratic, isinstance(surface, Profile)), _sphere
    else:
        start, sag = _cylinder_start(quadratic), _cylinder
    heights, curvature = _fit_sag(sag, start, x, y, surface.heights, valid, scale)
    return Form(form, heights, -1.0 / curvature)


def _fit_sag(
    sag: Callable[..., NDArray[np.float64]],
    start: NDArray[np.float64],
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    heights: NDArray[np.float64],
    valid: NDArray[np.bool_],
    scale: float,
) -> tuple[NDArray[np.float64], float]:
    """Refine a curved form; `start` and `sag` work in coordinates divided by `scale`."""
    unit = float(np.ptp(heights[valid])) or 1.0
    if not abs(start[1]) > 1e-9 * unit:
        raise InputError("surface", "no curvature", "a curved surface", "Use level for a flat one.")
    z = heights[valid] / scale
    start = np.array([start[0] / scale, start[1] / scale, *start[2:]])

    def residual(p: NDArray[np.float64]) -> NDArray[np.float64]:
        return (sag(p, x[valid], y[valid]) - z) * (scale / unit)

    steps = np.maximum(np.abs(start), 1e-12)
    found = scipy.optimize.least_squares(residual, start, x_scale=steps, xtol=1e-15, ftol=1e-14, gtol=1e-15)
    if not found.success:
        raise ComputationError(f"fit of the form: {found.message}", "a polynomial form")
    return sag(found.x, x, y) * scale, float(found.x[1]) / scale


def _sphere_start(q: NDArray[np.float64], line: bool) -> NDArray[np.float64]:
    curvature = 2.0 * q[3] if line else q[3] + q[5]
    x0, y0 = (-q[1] / curvature, -q[2] / curvature) if curvature else (0.0, 0.0)
    return np.array([q[0] - curvature * (x0 * x0 + y0 * y0) / 2.0, curvature, x0, y0][: 3 if line else 4])


def _sphere(p: NDArray[np.float64], x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    y0 = p[3] if p.size > 3 else 0.0
    square = (x - p[2]) ** 2 + (y - y0) ** 2
    return p[0] + p[1] * square / (1.0 + np.sqrt(np.maximum(1.0 - p[1] ** 2 * square, 0.0)))


def _cylinder_start(q: NDArray[np.float64]) -> NDArray[np.float64]:
    values, vectors = np.linalg.eigh([[2.0 * q[3], q[4]], [q[4], 2.0 * q[5]]])
    across = int(np.abs(values).argmax())
    cosine, sine = vectors[:, across]
    curvature = float(values[across])
    offset = -(q[1] * cosine + q[2] * sine) / curvature if curvature else 0.0
    tilt = -q[1] * sine + q[2] * cosine
    return np.array([q[0] - curvature * offset**2 / 2.0, curvature, offset, np.arctan2(sine, cosine), tilt])


def _cylinder(p: NDArray[np.float64], x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    across = x * np.cos(p[3]) + y * np.sin(p[3]) - p[2]
    along = -x * np.sin(p[3]) + y * np.cos(p[3])
    bow = p[1] * across**2 / (1.0 + np.sqrt(np.maximum(1.0 - (p[1] * across) ** 2, 0.0)))
    return p[0] + bow + p[4] * along


def _coordinates(surface: HeightMap | Profile) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """Centred x and y, broadcast to the heights and divided by half the longest side, with that half side."""
    if isinstance(surface, Profile):
        x, y = surface.x - surface.x.mean(), np.zeros(surface.shape)
    else:
        x, y = np.meshgrid(surface.x - surface.x.mean(), surface.y - surface.y.mean(), indexing="ij")
    scale = float(max(x.max(), y.max()))
    return x / scale, y / scale, scale


def _check_count(valid: NDArray[np.bool_], coefficients: int) -> None:
    if valid.sum() < coefficients:
        raise InputError("surface", f"{valid.sum()} valid points", f"at least {coefficients} for this fit")


def polynomial(surface: HeightMap | Profile, degree: int) -> NDArray[np.float64]:
    """Heights, m, of the least-squares polynomial of a total degree, 0 to 12, through the valid points."""
    if not (isinstance(degree, int | np.integer) and 0 <= degree <= 12):
        raise InputError("degree", degree, "a whole number from 0 to 12")
    axes = [np.linspace(-1.0, 1.0, n) for n in surface.shape]
    valid = np.isfinite(surface.heights)
    powers = [p for p in product(range(degree + 1), repeat=len(axes)) if sum(p) <= degree]
    _check_count(valid, len(powers))
    bases = [np.asarray(np.polynomial.legendre.legvander(a, degree), dtype=np.float64) for a in axes]
    terms = [_outer([b[:, k] for b, k in zip(bases, power, strict=True)]) for power in powers]
    # normal equations: a Legendre basis on the grid is nearly orthogonal, and long maps stay in memory
    kept = np.where(valid, surface.heights, 0.0)
    matrix = np.array([[np.sum(a * b, where=valid) for a in terms] for b in terms])
    weights = np.linalg.lstsq(matrix, np.array([np.sum(t * kept) for t in terms]), rcond=None)[0]
    fitted = np.zeros(surface.shape)
    for weight, term in zip(weights, terms, strict=True):
        fitted += weight * term
    return fitted


def _outer(factors: list[NDArray[np.float64]]) -> NDArray[np.float64]:
    return factors[0] if len(factors) == 1 else np.multiply.outer(factors[0], factors[1])
