"""From raw heights to the roughness that is meant: form, wavelength band, grid."""

import math
from dataclasses import replace
from functools import reduce
from itertools import product
from typing import Any, TypeVar

import numpy as np
import scipy

from asperity.arguments import FORMS, Array, real, require, shown
from asperity.errors import ShortRecordWarning
from asperity.surfaces.even_heights import EvenHeights

S = TypeVar("S", bound=EvenHeights)

GAUSSIAN_CONSTANT = float(np.sqrt(np.log(2.0) / np.pi))
"""Of ISO 16610-21: makes the transmission 50 % at the cut-off wavelength."""
MIRRORED = 8
"""Points that a spline goes on beyond either end of a surface, so that it has no free end."""
PIECE = 2**18
"""Points of a surface that are looked at in one go."""


def level(surface: S, degree: int | str = "plane", *, overwrite: bool = False) -> S:
    """Remove a least-squares polynomial, by the word of a case or by its degree; missing points stay missing.

    ``"plane"`` or 1 is the mean plane or line, ``"quadratic"`` or 2 a paraboloid, ``"quartic"`` or 4 what a
    steep cap needs, 0 the mean. Heights that nobody needs as they are may be overwritten.
    """
    degrees: dict[Any, int] = {0: 0} | FORMS | {each: each for each in FORMS.values()}
    allowed = "0, the mean, or " + ", ".join(f'"{word}" (or {each})' for word, each in FORMS.items())
    offered = isinstance(degree, int | str | np.integer) and degree in degrees
    require(offered, "degree", shown(degree), allowed)
    into = own(surface.heights) if overwrite else None
    return replace(surface, heights=without_polynomial(surface.heights, degrees[degree], into=into))


def own(heights: Array) -> Array:
    """Heights that nobody needs as they are, to be written to; a copy of those that cannot be."""
    owner = heights if heights.base is None else heights.base
    if not (isinstance(owner, np.ndarray) and owner.flags.owndata):
        return heights.copy()
    for each in (owner, heights):
        each.flags.writeable = True
    return heights


def band_limit(surface: S, longest: float | None = None, shortest: float | None = None) -> S:
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
    heights = surface.heights
    spacings = np.atleast_1d(np.asarray(surface.spacing))
    for name, cut_off in (("longest", longest), ("shortest", shortest)):
        if cut_off is not None:
            allowed = f"at least two samples, {2.0 * spacings.max():.4g} m, and finite"
            real(f"{name} wavelength", cut_off, allowed, at_least=2.0 * spacings.max())
    ordered = longest is None or shortest is None or longest > shortest
    require(ordered, "wavelengths", f"shortest {shortest}, longest {longest}", "shortest < longest")
    size = float(np.max(spacings * heights.shape))
    if longest is not None and longest > size:
        what = f"cut-off {longest:.4g} m exceeds the surface, {size:.4g} m"
        remedy = "the high pass removes little more than the mean; use a shorter cut-off or a longer surface"
        ShortRecordWarning.warn(f"{what}: {remedy}")
    if shortest is not None:
        heights = _gaussian(heights, spacings, shortest)
    if longest is not None:
        heights = heights - _gaussian(heights, spacings, longest)
    return replace(surface, heights=heights)


def _gaussian(heights: Array, spacings: Array, cut_off: float) -> Array:
    valid = np.isfinite(heights)
    weighted = np.where(valid, heights, 0.0)
    weight = valid.astype(np.float64)
    for axis, spacing in enumerate(spacings):
        reach = int(min(np.ceil(cut_off / spacing), heights.shape[axis]))
        x = np.arange(-reach, reach + 1) * spacing
        kernel = np.exp(-np.pi * (x / (GAUSSIAN_CONSTANT * cut_off)) ** 2)
        kernel = np.expand_dims(kernel / kernel.sum(), tuple(a for a in range(heights.ndim) if a != axis))
        middle = np.arange(reach, reach + heights.shape[axis])
        weighted, weight = (
            np.take(scipy.signal.oaconvolve(each, kernel, axes=axis), middle, axis=axis)
            for each in (weighted, weight)
        )
    return np.where(valid, weighted / np.where(valid, weight, 1.0), np.nan)


def resample(surface: S, spacing: float | tuple[float, float]) -> S:
    """Bring a complete surface to another spacing, m, without aliasing.

    Wavelengths shorter than two new samples are removed by a sharp zero-phase low pass (cosine series, which
    mirrors the surface at its edges: level it first, as a slope is broken there); what is left is
    interpolated. A finer grid gains points but no shorter wavelengths. The points are the centres of the new
    cells that fit in the area, counted from its first edge.
    """
    heights = surface.heights
    old = np.atleast_1d(surface.spacing)
    complete = not np.isnan(heights).any()
    received = f"{surface.missing_share:.2%} missing points"
    require(complete, "surface to resample", received, "complete heights", "Use fill first.")
    new = np.broadcast_to(np.asarray(spacing, dtype=np.float64), (heights.ndim,))
    size = old * heights.shape
    fits = (new > 0.0).all() and (new * 2.0 <= size * (1.0 + 1e-9)).all()
    require(fits, "spacing", spacing, f"above zero, at most half the surface, {size.min() / 2.0:.4g} m")
    for axis, (old_step, new_step) in enumerate(zip(old, new, strict=True)):
        if not np.isclose(old_step, new_step, rtol=1e-9, atol=0.0):
            heights = _resample_axis(heights, float(old_step), float(new_step), axis)
    steps = float(new[0]) if heights.ndim == 1 else tuple(map(float, new))
    return replace(surface, heights=heights, spacing=steps)


def _resample_axis(heights: Array, old_step: float, new_step: float, axis: int) -> Array:
    turned = np.moveaxis(heights, axis, -1)
    lines = turned.reshape(-1, heights.shape[axis])
    together = max(1, PIECE // lines.shape[1])  # a large map is not held many times
    pieces = (lines[first : first + together] for first in range(0, len(lines), together))
    resampled = np.concatenate([_resampled(piece, old_step, new_step) for piece in pieces])
    return np.moveaxis(resampled.reshape(*turned.shape[:-1], -1), -1, axis)


def _resampled(lines: Array, old_step: float, new_step: float) -> Array:
    """Lines (k, n) at another step along them."""
    points = lines.shape[1]
    length = points * old_step
    count = int(np.floor(length / new_step + 1e-9))
    series = scipy.fft.dct(lines, type=2)
    terms = min(points, count)  # term k has the wavelength 2 length/k
    # four samples or more per shortest wavelength left: the quintic spline is then right within 0.2 %
    dense = scipy.fft.next_fast_len(max(2 * terms, 16), real=True)
    padded = np.zeros((len(lines), dense))
    padded[:, :terms] = series[:, :terms] * (dense / points)
    values = scipy.fft.idct(padded, type=2)
    centres = (np.arange(dense) + 0.5) * (length / dense)
    before = slice(MIRRORED - 1, None, -1)
    beyond = slice(None, -MIRRORED - 1, -1)
    mirrored = np.concatenate([values[:, before], values, values[:, beyond]], axis=-1)
    positions = np.concatenate([-centres[before], centres, 2 * length - centres[beyond]])
    spline = scipy.interpolate.make_interp_spline(positions, mirrored, k=5, axis=-1)
    return spline((np.arange(count) + 0.5) * new_step)


def without_polynomial(heights: Array, degree: int, *, into: Array | None) -> Array:
    """Heights, m, less the least-squares polynomial of a total degree through the valid points.

    Written into an array, which may be that of the heights; into a new one by default. By normal equations,
    in pieces along the first axis: a Legendre basis on the grid is nearly orthogonal, and large maps stay in
    memory.
    """
    powers = [p for p in product(range(degree + 1), repeat=heights.ndim) if sum(p) <= degree]
    received = f"{np.isfinite(heights).sum()} valid points"
    allowed = f"at least {len(powers)} for this form"
    require(np.isfinite(heights).sum() >= len(powers), "surface", received, allowed)
    others = [_legendre(0, n, n, degree) for n in heights.shape[1:]]
    across = math.prod(heights.shape[1:])

    def pieces(points: int) -> list[slice]:
        rows = max(1, points // across)
        return [slice(first, min(first + rows, len(heights))) for first in range(0, len(heights), rows)]

    def terms(piece: slice) -> list[Array]:
        bases = [_legendre(piece.start, piece.stop, len(heights), degree), *others]
        factors = [[basis[:, k] for basis, k in zip(bases, power, strict=True)] for power in powers]
        return [reduce(np.multiply.outer, each) for each in factors]

    matrix = np.zeros((len(powers), len(powers)))
    right = np.zeros(len(powers))
    for piece in pieces(PIECE):
        known = np.isfinite(heights[piece])
        of_piece = terms(piece)
        matrix += [[np.sum(a * b, where=known) for a in of_piece] for b in of_piece]
        right += [np.sum(term * heights[piece], where=known) for term in of_piece]
    weights = np.linalg.lstsq(matrix, right, rcond=None)[0]
    left = np.empty(heights.shape) if into is None else into
    for piece in pieces(PIECE // 4):  # beside both arrays of heights, and in the processor's cache
        weighted = (w * term for w, term in zip(weights, terms(piece), strict=True))
        left[piece] = heights[piece] - sum(weighted, np.zeros(heights[piece].shape))
    for each in (left, left.base):
        if isinstance(each, np.ndarray):
            each.flags.writeable = False  # it need not be copied
    return left


def _legendre(first: int, stop: int, count: int, degree: int) -> Array:
    """Legendre polynomials (stop - first, degree + 1) at some of so many points evenly from -1 to 1."""
    points = np.arange(first, stop) * (2.0 / (count - 1)) - 1.0
    points[count - 1 - first :] = 1.0  # as it is
    return np.polynomial.legendre.legvander(points, degree)
