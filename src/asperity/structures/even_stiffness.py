"""Fitted modes that can be rolled over: smooth shapes, and an even stiffness of modes above the band."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline, make_interp_spline, make_lsq_spline
from scipy.optimize import nnls

from asperity.structures.modal_fit import RESIDUAL_DAMPING, Complex, Modes, modal_answers

Array = NDArray[np.float64]

INSIDE = 1.02
"""Of the highest frequency, up to which a mode is one of the band."""
ABOVE = (1.15, 1.5, 3.0)
"""Of the highest frequency: modes that stand for all above the band."""
FINER = 4
"""Places for each place of a record, at which shapes of these modes are given."""
DEGREE = 7
SPARE_KNOTS, KNOTS_PER_WAVELENGTH, MORE_KNOTS = 8, 4.0, 1.5
MOST_KNOTS = 0.6
"""Of the places; a shape that needs more is not smoothed."""
WORTH_KNOTS = 0.7
"""Of the scatter that fewer knots leave, which more must leave to be worthwhile: noise leaves the same."""


def in_band(modes: Modes, highest: float) -> Modes:
    """Modes, with shapes (p, m), up to a frequency, Hz."""
    natural, ratios, shapes = modes
    inside = natural <= INSIDE * highest
    return natural[inside], ratios[inside], shapes[:, inside]


def with_stiffness_above(
    frequency: Array, at: Array, number: NDArray[np.intp], flexible: Complex, modes: Modes
) -> tuple[Array, Modes]:
    """Modes at finer places, m, their shapes smoothed, and others for the stiffness of those above the band.

    Flexible receptances (n, p, e) of places `at` (p,) under forces at those with the numbers `number` (e,).
    What the modes leave of each force's own receptance is that of modes of positive masses at `ABOVE`.
    Between forces it goes on evenly, as waves of two phases, r cos κ(x − x₀): they have the same flexibility
    everywhere. Wavenumbers follow from that of the highest mode as those of bending waves do.
    """
    natural, ratios, shapes = modes
    parts = [at[:-1] + k / FINER * np.diff(at) for k in range(FINER)]
    fine = np.append(np.stack(parts, axis=1).ravel(), at[-1])
    finer = np.array([smoothed(at, shape)(fine) for shape in shapes.T]).reshape(-1, fine.size).T
    squares = _squares_above(frequency, number, flexible, modes)
    wave = _wavenumber(at, shapes[:, -1]) if natural.size else 0.0
    order = np.argsort(at[number])
    added: list[Array] = []
    frequencies: list[float] = []
    for k, ratio in enumerate(ABOVE):
        size = np.sqrt(np.interp(fine, at[number][order], squares[order, k]))
        phase = wave * np.sqrt(ratio) * (fine - fine[0])
        for shape in (size * np.cos(phase), size * np.sin(phase)):
            if shape.any():
                added.append(shape)
                frequencies.append(ratio * float(frequency[-1]))
    return fine, (
        np.concatenate([natural, frequencies]),
        np.concatenate([ratios, np.full(len(added), RESIDUAL_DAMPING)]),
        np.column_stack([finer, *added]),
    )


def _squares_above(frequency: Array, number: NDArray[np.intp], flexible: Complex, modes: Modes) -> Array:
    """Squared shapes (e, above), 1/kg, of the modes above the band where forces act."""
    natural, ratios, shapes = modes
    answers = modal_answers(frequency, natural, ratios)
    above = frequency[-1] * np.array(ABOVE)
    columns = modal_answers(frequency, above, np.full(above.size, RESIDUAL_DAMPING))
    squares = []
    for j, i in enumerate(number):
        own = flexible[:, i, j]
        weight = 1.0 / np.maximum(np.abs(own), np.finfo(float).tiny)
        left = weight * (own - answers @ shapes[i] ** 2)
        matrix = np.concatenate([(weight[:, None] * columns).real, (weight[:, None] * columns).imag])
        size = np.linalg.norm(matrix, axis=0)
        squares.append(nnls(matrix / size, np.concatenate([left.real, left.imag]))[0] / size)
    return np.array(squares)


def smoothed(at: Array, shape: Array) -> BSpline:
    """Spline through a shape (p,) at places (p,), with as many knots as leave no more than its noise."""
    degree = min(DEGREE, at.size - 1)
    through = make_interp_spline(at, shape, k=degree - (degree + 1) % 2)
    count = int(KNOTS_PER_WAVELENGTH * _wavenumber(at, shape) * np.ptp(at) / (2.0 * np.pi)) + SPARE_KNOTS
    best, noise = through, np.inf
    while count < MOST_KNOTS * at.size:
        inner = np.interp(np.linspace(0.0, at.size - 1.0, count - DEGREE + 1), np.arange(at.size), at)
        knots = np.r_[(at[0],) * DEGREE, inner, (at[-1],) * DEGREE]
        found = make_lsq_spline(at, shape, knots, k=DEGREE)
        scatter = float(np.sum((found(at) - shape) ** 2) / (at.size - count))
        if scatter > WORTH_KNOTS * noise:
            return best
        best, noise, count = found, scatter, int(MORE_KNOTS * count)
    return through


def _wavenumber(at: Array, shape: Array) -> float:
    """Root mean square slope of a shape over its root mean square, rad/m."""
    distance = np.diff(at)
    rise = np.sum(np.diff(shape) ** 2 / distance)
    size = np.sum(distance * 0.5 * (shape[:-1] ** 2 + shape[1:] ** 2))
    return float(np.sqrt(rise / size)) if size > 0.0 else 0.0
