"""Contact filters of practice, as laws of a linear contact: registered for a study, no part of the package.

Each filters the line texture once, at the working load, and hands it to the linearised contact of smooth
bodies. They differ in the filter alone:

- ``linear-remington``: |H(k)|² = 1/(1 + π/4 (k a)³), k the angular wavenumber and a the semi-axis in the
  rolling direction: the approximation of P. J. Remington, J. Sound Vib. 46 (1976) 359 (not seen).
- ``linear-dprs``: discrete point-reacting springs under the static load, on all lines of the texture, after
  Remington and Webb, named by R. A. J. Ford and D. J. Thompson, J. Sound Vib. 293 (2006) 807. The springs do
  not feel each other. Here the force of each grows as the root of its deflection, on bodies of half the
  radii, so that smooth bodies have Hertz's patch, pressure and load.
- ``linear-cnossos``: table A3 of CNOSSOS-EU for the nearest load and wheel diameter; of wheels alone.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial

import numba
import numpy as np
from numpy.typing import NDArray

from asperity import laws
from asperity.laws import LawSpec, Linear, Materials, Need
from asperity.reduction.texture import StateTexture
from asperity.reference.cnossos import contact_filter, nearest_contact_filter
from asperity.scenarios.geometry import Geometry

Gain = Callable[[NDArray[np.float64]], NDArray[np.float64]]


def remington(wavenumber: NDArray[np.float64], semi_axis: float) -> NDArray[np.float64]:
    """Magnitude of the filter at wavenumbers, cycles/m, for a semi-axis in the rolling direction, m."""
    return 1.0 / np.sqrt(1.0 + 0.25 * math.pi * (2.0 * math.pi * wavenumber * semi_axis) ** 3)


def cnossos(wavenumber: NDArray[np.float64], load: float, diameter: float) -> NDArray[np.float64]:
    """Magnitude of the nearest tabulated filter A3 at wavenumbers, cycles/m, of a wheel: N and m."""
    wavelengths, gain = contact_filter(nearest_contact_filter(load, diameter))
    at = np.log(1.0 / np.maximum(wavenumber, 1e-9))
    return np.asarray(10.0 ** (np.interp(at, np.log(wavelengths[::-1]), gain[::-1]) / 20.0))


def filtered(line: NDArray[np.float64], spacing: float, gain: Gain) -> NDArray[np.float64]:
    """Filter a line (n,), m, by a magnitude without phase; beyond its ends it is mirrored."""
    mirrored = np.concatenate([line, line[::-1]])
    spectrum = np.fft.rfft(mirrored) * gain(np.fft.rfftfreq(len(mirrored), spacing))
    return np.fft.irfft(spectrum, len(mirrored))[: len(line)]


@numba.njit
def _carried(heights, gap, row, approach):  # type: ignore[no-untyped-def]
    """Sum of the roots of the deflections of all springs, the window on a row."""
    total = 0.0
    for j in range(gap.shape[0]):
        for k in range(gap.shape[1]):
            deflection = approach - gap[j, k] + heights[row + j, k]
            if deflection > 0.0:
                total += math.sqrt(deflection)
    return total


@numba.njit
def _on_springs(heights, gap, scale, wanted):  # type: ignore[no-untyped-def]
    """Approach (n,) at which springs carry what is wanted, at each row, by bisection to a millionth."""
    found = np.empty(heights.shape[0] - gap.shape[0] + 1)
    for row in range(found.size):
        low = np.min(gap - heights[row : row + gap.shape[0]])
        high = low + scale
        while _carried(heights, gap, row, high) < wanted:
            low, high = high, high + 2.0 * (high - low)
        while high - low > 1e-6 * scale:
            middle = 0.5 * (low + high)
            if _carried(heights, gap, row, middle) < wanted:
                low = middle
            else:
                high = middle
        found[row] = 0.5 * (low + high)
    return found


def springs(heights: NDArray[np.float64], shape: Geometry) -> NDArray[np.float64]:
    """Texture (rows,), m, away from contact, that point-reacting springs leave of heights (rows, ny)."""
    approach = shape.hertz.approach(shape.load)
    (a, b), (dx, dy), (nx, ny) = shape.semi_axes, shape.spacing, shape.body.shape
    x, y = (step * (np.arange(n) - n // 2) for step, n in ((dx, nx), (dy, ny)))
    gap = approach * ((x[:, None] / a) ** 2 + (y / b) ** 2)
    root = (
        1.5 * shape.load / (math.pi * a * b) / math.sqrt(approach)
    )  # pressure over the root of a deflection
    wanted = shape.load / (root * dx * dy)
    smooth = _on_springs(np.zeros(gap.shape), gap, approach, wanted)[0]
    found = _on_springs(np.ascontiguousarray(heights), gap, approach, wanted) - smooth
    return np.pad(found, (nx // 2, nx // 2), mode="edge")


def _linear(materials: Materials, heights: NDArray[np.float64]) -> Linear:
    approach, stiffness = materials.working_point
    texture = StateTexture.unfiltered(heights, materials.spacing[0], materials.start)
    return Linear(materials.load, stiffness, approach, texture, materials.damping, materials.name)


def _by_gain(materials: Materials, gain: Gain) -> Linear:
    return _linear(materials, filtered(materials.line.heights[0], materials.spacing[0], gain))


def _by_springs(materials: Materials, shape: Geometry) -> Linear:
    return _linear(materials, springs(materials.heights, shape))


@contextmanager
def practice(shape: Geometry, diameter: float | None) -> Iterator[tuple[str, ...]]:
    """Register the filters of practice for the bodies of a case; a wheel has a diameter, m."""
    builders = {
        "linear-remington": partial(_by_gain, gain=partial(remington, semi_axis=shape.semi_axes[0])),
        "linear-dprs": partial(_by_springs, shape=shape),
    }
    if diameter is not None:
        gain = partial(cnossos, load=shape.load, diameter=diameter)
        builders["linear-cnossos"] = partial(_by_gain, gain=gain)
    for name, build in builders.items():
        needs = frozenset({Need.SURFACE}) if name == "linear-dprs" else frozenset()
        laws.register(LawSpec(name, "A filter of practice.", build, needs, may_pull=True))
    try:
        yield tuple(builders)
    finally:
        for name in builders:
            laws.unregister(name)
