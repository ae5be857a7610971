"""From raw heights to the roughness that is meant: levelling, wavelength band, missing points, grid."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product
from typing import Any, Literal, TypeVar

import numpy as np
import scipy
from numpy.typing import NDArray
from scipy import fft

from asperity.arguments import FORMS, Array, real, shown
from asperity.errors import ComputationError, InputError, MissingPointsWarning, ShortRecordWarning
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.parallel_lines import are_lines

__all__ = [
    "GAUSSIAN_CONSTANT",
    "Form",
    "band_limit",
    "fill",
    "fit_form",
    "level",
    "nearly_complete",
    "remove_form",
    "resample",
]

GAUSSIAN_CONSTANT = float(np.sqrt(np.log(2.0) / np.pi))
"""Of ISO 16610-21: makes the transmission 50 % at the cut-off wavelength."""

FILLED_SHARE_WARNED = 0.05


def level(surface: Surface, degree: int | str = "plane") -> Surface:
    """Remove a least-squares polynomial, by the word of a case or by its degree; missing points stay missing.

    ``"plane"`` or 1 is the mean plane or line, ``"quadratic"`` or 2 a paraboloid, 0 the mean.
    """
    known: dict[Any, int] = {**FORMS, 0: 0, 1: 1, 2: 2}
    if not isinstance(degree, int | str | np.integer) or degree not in known:
        allowed = '"plane" (or 1), "quadratic" (or 2) or 0, the mean'
        raise InputError("degree", shown(degree), allowed, "Use remove_form for more.")
    return replace(surface, heights=surface.heights - polynomial(surface, known[degree]))


def band_limit(surface: Surface, longest: float | None = None, shortest: float | None = None) -> Surface:
    """Keep a band of wavelengths, m, with zero-phase Gaussian filters; None leaves a side open.

    Transmission is 50 % at each limit. `shortest` is the nesting index of the S-filter (low pass), `longest`
    that of the L-filter (high pass, the heights less their low pass): ISO 16610-21:2011 (profiles) and ISO
    16610-61:2015 (areas), s(x) = exp(-π (x/αλ)²)/(αλ), α = √(ln 2/π), cut at one cut-off wavelength on either
    side. Where `longest` exceeds the surface, a warning says that the high pass removes little more than the
    mean.

    At edges and beside missing points, which stay missing, the weights are normalised to those that fall on
    data (a regression of degree zero): a constant passes unchanged, but within half a cut-off of an edge a
    slope is bent. Level or remove the form first, or cut the margin off afterwards.
    """
    spacings = np.atleast_1d(np.asarray(surface.spacing))
    for name, cut_off in (("longest", longest), ("shortest", shortest)):
        if cut_off is not None:
            allowed = f"at least two samples, {2.0 * spacings.max():.4g} m, and finite"
            real(f"{name} wavelength", cut_off, allowed, at_least=2.0 * spacings.max())
    if longest is not None and shortest is not None and not longest > shortest:
        raise InputError("wavelengths", f"shortest {shortest}, longest {longest}", "shortest < longest")
    size = float(np.max(surface.size))
    if longest is not None and longest > size:
        message = (
            f"cut-off {longest:.4g} m exceeds the surface, {size:.4g} m: the high pass removes little more "
            "than the mean; use a shorter cut-off or a longer surface"
        )
        warnings.warn(message, ShortRecordWarning, stacklevel=2)
    heights = surface.heights
    if shortest is not None:
        heights = _gaussian(heights, spacings, shortest)
    if longest is not None:
        heights = heights - _gaussian(heights, spacings, longest)
    return replace(surface, heights=heights)


def _gaussian(heights: Array, spacings: Array, cut_off: float) -> Array:
    valid = np.isfinite(heights)
    weighted, weight = np.where(valid, heights, 0.0), valid.astype(np.float64)
    for axis, spacing in enumerate(spacings):
        reach = int(min(np.ceil(cut_off / spacing), heights.shape[axis]))
        x = np.arange(-reach, reach + 1) * spacing
        kernel = np.exp(-np.pi * (x / (GAUSSIAN_CONSTANT * cut_off)) ** 2)
        kernel = np.expand_dims(kernel / kernel.sum(), tuple(a for a in range(heights.ndim) if a != axis))
        weighted, weight = (_convolve(v, kernel, axis) for v in (weighted, weight))
    return np.where(valid, weighted / np.where(valid, weight, 1.0), np.nan)


def _convolve(values: Array, kernel: Array, axis: int) -> Array:
    from scipy.signal import oaconvolve  # takes a second to import

    full = oaconvolve(values, kernel, mode="full", axes=axis)
    start = (kernel.shape[axis] - 1) // 2
    return np.take(full, np.arange(start, start + values.shape[axis]), axis=axis)


def fill(surface: Surface, lines: bool | None = None) -> Surface:
    """Fill missing points: the harmonic surface through their neighbours, or straight lines in a profile.

    Solves the five-point Laplace equation on the missing points, with no slope at the border: no new peak or
    valley arises. `source` states the share that was filled; more than 5 % are warned of, as filled points
    carry no roughness. `lines` says whether an array holds lines measured side by side; by default its shape
    does, see `parallel_lines.are_lines`. Neighbours need not be in register: such lines are filled along
    themselves, by straight lines, and what is missing at their ends stays missing.
    """
    missing = np.isnan(surface.heights)
    along = None
    if isinstance(surface, HeightMap) and (are_lines(surface) if lines is None else lines):
        along = int(np.argmax(surface.shape))
        known = [np.maximum.accumulate(~each, axis=along) for each in (missing, np.flip(missing, along))]
        missing &= known[0] & np.flip(known[1], along)
    share = float(missing.mean())
    if share == 0.0:
        return surface
    if share > FILLED_SHARE_WARNED:
        message = (
            f"{share:.1%} of the points were missing and are filled, more than {FILLED_SHARE_WARNED:.0%}: "
            "filled points are smooth and lower Sq and Sdq; measure again or crop"
        )
        warnings.warn(message, MissingPointsWarning, stacklevel=2)
    heights = np.array(surface.heights)
    if along is None:
        heights[missing] = _harmonic(surface.heights, missing, np.atleast_1d(np.asarray(surface.spacing)))
    else:
        for line, holes in zip(*(np.moveaxis(each, along, -1) for each in (heights, missing)), strict=True):
            there = np.flatnonzero(np.isfinite(line))
            if holes.any():
                line[holes] = np.interp(np.flatnonzero(holes), there, line[there])
    source = f"{surface.source}; {share:.2%} of the points filled".lstrip("; ")
    return replace(surface, heights=heights, source=source)


def nearly_complete(surface: Surface) -> Surface | None:
    """Surface with its missing points filled, for what needs all; None where more than 5 % are missing."""
    return fill(surface, lines=False) if surface.missing_share <= FILLED_SHARE_WARNED else None


def _harmonic(heights: Array, missing: NDArray[np.bool_], spacings: Array) -> Array:
    """Heights of the missing points, from the discrete Laplace equation."""
    from scipy import sparse
    from scipy.sparse.linalg import spsolve

    index = np.full(heights.shape, -1)
    index[missing] = np.arange(missing.sum())
    diagonal, right = np.zeros(missing.sum()), np.zeros(missing.sum())
    rows, columns, values = [], [], []
    for axis, spacing in enumerate(spacings):
        weight = (spacings.max() / spacing) ** 2
        low, high = (_slab(index, axis, s) for s in (slice(None, -1), slice(1, None)))
        z_low, z_high = (_slab(heights, axis, s) for s in (slice(None, -1), slice(1, None)))
        for here, there, z_there in ((low, high, z_high), (high, low, z_low)):
            mine = here >= 0
            np.add.at(diagonal, here[mine], weight)
            known, unknown = mine & (there < 0), mine & (there >= 0)
            np.add.at(right, here[known], weight * z_there[known])
            rows.append(here[unknown])
            columns.append(there[unknown])
            values.append(np.full(unknown.sum(), -weight))
    coupling = (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))
    shape = (diagonal.size, diagonal.size)
    matrix = sparse.csc_array(sparse.coo_array(coupling, shape=shape) + sparse.diags_array(diagonal))
    return np.atleast_1d(spsolve(matrix, right))


def _slab(values: NDArray[Any], axis: int, part: slice) -> NDArray[Any]:
    return values[(slice(None),) * axis + (part,)]


def resample(surface: Surface, spacing: float | tuple[float, float]) -> Surface:
    """Bring a complete surface to another spacing, m, without aliasing.

    Wavelengths shorter than two new samples are removed by a sharp zero-phase low pass (cosine series, which
    mirrors the surface at its edges: level it first, as a slope is broken there); what is left is
    interpolated. A finer grid gains points but no shorter wavelengths. The points are the centres of the new
    cells that fit in the area, counted from its first edge.
    """
    if np.isnan(surface.heights).any():
        received = f"{surface.missing_share:.2%} missing points"
        raise InputError("surface to resample", received, "complete heights", "Use fill first.")
    new = np.broadcast_to(np.asarray(spacing, dtype=np.float64), (surface.heights.ndim,))
    size = np.atleast_1d(np.asarray(surface.size))
    if not ((new > 0.0).all() and (new * 2.0 <= size * (1.0 + 1e-9)).all()):
        raise InputError(
            "spacing", spacing, f"above zero, at most half the surface, {size.min() / 2.0:.4g} m"
        )
    heights = surface.heights
    for axis, (old_step, new_step) in enumerate(zip(np.atleast_1d(surface.spacing), new, strict=True)):
        if not np.isclose(old_step, new_step, rtol=1e-9, atol=0.0):
            heights = _resample_axis(heights, float(old_step), float(new_step), axis)
    if isinstance(surface, Profile):
        return replace(surface, heights=heights, spacing=float(new[0]))
    return replace(surface, heights=heights, spacing=(float(new[0]), float(new[1])))


def _resample_axis(heights: Array, old_step: float, new_step: float, axis: int) -> Array:
    points = heights.shape[axis]
    length = points * old_step
    series = np.moveaxis(fft.dct(heights, type=2, axis=axis), axis, -1)
    kept = int(min(points, np.floor(length / new_step + 1e-9)))  # term k has the wavelength 2 length/k
    # four samples or more per shortest wavelength left: the quintic spline is then right within 0.2 %
    dense = fft.next_fast_len(max(2 * kept, 16), real=True)
    padded = np.zeros((*series.shape[:-1], dense))
    padded[..., :kept] = series[..., :kept] * (dense / points)
    values = fft.idct(padded, type=2, axis=-1)
    centres = (np.arange(dense) + 0.5) * (length / dense)
    new_centres = (np.arange(int(np.floor(length / new_step + 1e-9))) + 0.5) * new_step
    margin = 8  # mirrored points, so that the spline has no free end
    mirrored = np.concatenate(
        [values[..., margin - 1 :: -1], values, values[..., : -margin - 1 : -1]], axis=-1
    )
    positions = np.concatenate(
        [-centres[margin - 1 :: -1], centres, 2 * length - centres[: -margin - 1 : -1]]
    )
    from scipy.interpolate import make_interp_spline

    spline = make_interp_spline(positions, mirrored, k=5, axis=-1)
    return np.moveaxis(spline(new_centres), -1, axis)


Surface = TypeVar("Surface", HeightMap, Profile)


@dataclass(frozen=True, eq=False)
class Form:
    """Least-squares form of a surface."""

    kind: str  # ``"sphere"``, ``"cylinder"`` or ``"polynomial"``
    heights: Array  # of the form, m, with the shape of the surface
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
    sag: Callable[..., Array],
    start: Array,
    x: Array,
    y: Array,
    heights: Array,
    valid: NDArray[np.bool_],
    scale: float,
) -> tuple[Array, float]:
    """Refine a curved form; `start` and `sag` work in coordinates divided by `scale`."""
    unit = float(np.ptp(heights[valid])) or 1.0
    if not abs(start[1]) > 1e-9 * unit:
        raise InputError("surface", "no curvature", "a curved surface", "Use level for a flat one.")
    z = heights[valid] / scale
    start = np.array([start[0] / scale, start[1] / scale, *start[2:]])

    def residual(p: Array) -> Array:
        return (sag(p, x[valid], y[valid]) - z) * (scale / unit)

    steps = np.maximum(np.abs(start), 1e-12)
    found = scipy.optimize.least_squares(residual, start, x_scale=steps, xtol=1e-15, ftol=1e-14, gtol=1e-15)
    if not found.success:
        raise ComputationError(f"fit of the form: {found.message}", "a polynomial form")
    return sag(found.x, x, y) * scale, float(found.x[1]) / scale


def _sphere_start(q: Array, line: bool) -> Array:
    curvature = 2.0 * q[3] if line else q[3] + q[5]
    x0, y0 = (-q[1] / curvature, -q[2] / curvature) if curvature else (0.0, 0.0)
    return np.array([q[0] - curvature * (x0 * x0 + y0 * y0) / 2.0, curvature, x0, y0][: 3 if line else 4])


def _sphere(p: Array, x: Array, y: Array) -> Array:
    y0 = p[3] if p.size > 3 else 0.0
    square = (x - p[2]) ** 2 + (y - y0) ** 2
    return p[0] + p[1] * square / (1.0 + np.sqrt(np.maximum(1.0 - p[1] ** 2 * square, 0.0)))


def _cylinder_start(q: Array) -> Array:
    values, vectors = np.linalg.eigh([[2.0 * q[3], q[4]], [q[4], 2.0 * q[5]]])
    across = int(np.abs(values).argmax())
    cosine, sine = vectors[:, across]
    curvature = float(values[across])
    offset = -(q[1] * cosine + q[2] * sine) / curvature if curvature else 0.0
    tilt = -q[1] * sine + q[2] * cosine
    return np.array([q[0] - curvature * offset**2 / 2.0, curvature, offset, np.arctan2(sine, cosine), tilt])


def _cylinder(p: Array, x: Array, y: Array) -> Array:
    across = x * np.cos(p[3]) + y * np.sin(p[3]) - p[2]
    along = -x * np.sin(p[3]) + y * np.cos(p[3])
    bow = p[1] * across**2 / (1.0 + np.sqrt(np.maximum(1.0 - (p[1] * across) ** 2, 0.0)))
    return p[0] + bow + p[4] * along


def _coordinates(surface: HeightMap | Profile) -> tuple[Array, Array, float]:
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


def polynomial(surface: HeightMap | Profile, degree: int) -> Array:
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


def _outer(factors: list[Array]) -> Array:
    return factors[0] if len(factors) == 1 else np.multiply.outer(factors[0], factors[1])
