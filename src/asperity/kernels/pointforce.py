"""The moving point force, compiled: forms that cover all laws made of state functions."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.options import INNER, ONCE, compiled

SHIFTED = 0  # F = f(approach - h)
SECANT = 1  # F = f(approach)/r (r - h), r = approach + datum: Eq. 2.1 as printed
TABLE = 2  # F = g(approach)^1.5, g interpolated at every position
SLICED = 3  # F = Σ c (approach - h + tilt × place - drop)^n over the slices of a roller
ITERATIONS = 100
FILM_TOLERANCE = 1e-12
"""Of the approach of bodies with a film, over its thickness."""


class SeriesFilm(NamedTuple):
    """A film in series with a law, thinner by a power of the force: the bodies are as far apart."""

    thickness: float  # under the lightest force and less, m; 0 of dry bodies
    lightest: float  # that force, N
    power: float  # below zero


DRY = SeriesFilm(0.0, 1.0, 0.0)


class Prepared(NamedTuple):
    """A law laid out on the n positions of a path, for the compiled kernels."""

    form: int  # `SHIFTED`, `SECANT`, `TABLE` or `SLICED`
    # (n,), at every position the plane from which approaches count here, m, positive away from contact
    planes: NDArray
    states: NDArray  # (s,), approaches of the states, m
    # (n, s), at every position: the texture h over the plane, m, or for `TABLE` the root g of the force,
    # N^(2/3)
    values: NDArray
    slopes: NDArray  # (n, s), for `TABLE` the slope of g, N^(2/3)/m; else an array without rows
    # (n,), for `TABLE` the approach at first touch, m, for `SLICED` the tilt, rad; else an array without rows
    touches: NDArray
    # this and the next three: the force curve, `reduction.stiffness.ForceCurve`; for `SLICED` the places of
    # the slices (k,), m, and their drops, m, and constants c (k, 2)
    knots: NDArray
    coefficients: NDArray
    exponent: float
    bilateral: bool
    datum: float  # offset of the state r from the approach, m (`SECANT`)
    damping: float  # contact damping, N s/m
    damped_in_flight: bool  # whether the damper also acts, and pulls, out of contact (Eq. 2.2)
    upper: float  # largest argument that the data cover, m: of f, or the last state of a table
    film: SeriesFilm  # that keeps the bodies apart


@compiled(**INNER)
def curve_force(knots, coefficients, exponent, bilateral, s):  # type: ignore[no-untyped-def]
    """Force and slope of a force curve at the approach `s`."""
    if s <= knots[0] and not bilateral:
        return 0.0, 0.0
    i = interval(knots, s)
    u = s - knots[i]
    within = min(max(u, 0.0), knots[i + 1] - knots[i])
    c3 = coefficients[i, 0]
    c2 = coefficients[i, 1]
    c1 = coefficients[i, 2]
    c0 = coefficients[i, 3]
    slope = (3.0 * c3 * within + 2.0 * c2) * within + c1
    g = ((c3 * within + c2) * within + c1) * within + c0 + slope * (u - within)
    return power(g, slope, exponent)


@compiled(**INNER)
def power(g, slope, exponent):  # type: ignore[no-untyped-def]
    """Force g**exponent and its slope."""
    if exponent == 1.0:
        return g, slope
    if g <= 0.0:
        return 0.0, 0.0
    root = np.sqrt(g) if exponent == 1.5 else g ** (exponent - 1.0)
    return root * g, exponent * root * slope


@compiled(**INNER)
def interval(points, x):  # type: ignore[no-untyped-def]
    """Index i with points[i] < x <= points[i + 1], for x above the first and not above the last."""
    low = 0
    high = points.shape[0] - 1
    while high - low > 1:
        middle = (low + high) // 2
        if points[middle] < x:
            low = middle
        else:
            high = middle
    return low


@compiled(**INNER)
def texture_at(states, heights, step, approach):  # type: ignore[no-untyped-def]
    """Texture at a step between the states, linear in the approach, and its slope; constant outside."""
    last = states.shape[0] - 1
    if approach <= states[0]:
        return heights[step, 0], 0.0
    if not approach < states[last]:  # not a number included
        return heights[step, last], 0.0
    i = interval(states, approach)
    slope = (heights[step, i + 1] - heights[step, i]) / (states[i + 1] - states[i])
    return heights[step, i] + slope * (approach - states[i]), slope


@compiled(**INNER)
def table_root(states, values, slopes, step, touch, approach):  # type: ignore[no-untyped-def]
    """Monotone cubic g at a step between the states, from first touch on, straight beyond; and its slope."""
    last = states.shape[0] - 1
    if approach <= touch:
        return 0.0, 0.0
    if not approach < states[last]:
        return values[step, last] + slopes[step, last] * (approach - states[last]), slopes[step, last]
    i = interval(states, approach)
    low = states[i]
    value = values[step, i]
    if touch > low:
        low = touch
        value = 0.0
    elif approach < low:  # between a touch below all states and the first of them
        low = touch
        value = 0.0
        i = -1
    width = states[i + 1] - low
    t = (approach - low) / width
    secant = (values[step, i + 1] - value) / width
    if low == touch:  # convex from the touch on, as asperities join in, but never flat
        start = min(max(2.0 * secant - slopes[step, i + 1], 0.25 * secant), 2.0 * secant) - secant
    else:
        start = slopes[step, i] - secant
    end = slopes[step, i + 1] - secant
    g = value + width * t * (secant + (1.0 - t) * (start * (1.0 - t) - end * t))
    slope = secant + start * (1.0 - t) * (1.0 - 3.0 * t) + end * t * (3.0 * t - 2.0)
    return g, slope


@compiled(**ONCE)
def sliced_force(places, parts, exponent, tilt, approach):  # type: ignore[no-untyped-def]
    """Force and slope of all slices at an approach of their middle, tilted: end at positive places nearer."""
    force = 0.0
    slope = 0.0
    for i in range(places.shape[0]):
        overlap = approach + tilt * places[i] - parts[i, 0]
        if overlap > 0.0:
            root = parts[i, 1] * overlap ** (exponent - 1.0)
            force += root * overlap
            slope += root
    return force, exponent * slope


@compiled(**INNER)
def evaluate(law, step, approach):  # type: ignore[no-untyped-def]
    """Elastic force of a law at a position, N, and its derivative, N/m, by the approach of its bodies, m."""
    approach -= law.planes[step]
    if law.form == TABLE:
        g, slope = table_root(law.states, law.values, law.slopes, step, law.touches[step], approach)
        return power(g, slope, 1.5)
    height, height_slope = texture_at(law.states, law.values, step, approach)
    if law.form == SHIFTED:
        force, slope = curve_force(
            law.knots, law.coefficients, law.exponent, law.bilateral, approach - height
        )
        return force, slope * (1.0 - height_slope)
    if law.form == SLICED:
        force, slope = sliced_force(
            law.knots, law.coefficients, law.exponent, law.touches[step], approach - height
        )
        return force, slope * (1.0 - height_slope)
    r = approach + law.datum
    if r <= 0.0 or r <= height:
        return 0.0, 0.0
    force, slope = curve_force(law.knots, law.coefficients, law.exponent, law.bilateral, approach)
    secant = force / r
    return secant * (r - height), (slope - secant) / r * (r - height) + secant * (1.0 - height_slope)


@compiled(**INNER)
def with_damping(elastic, slope, rate, rate_compliance, damping, in_flight):  # type: ignore[no-untyped-def]
    """Contact force with a damper, N, and its derivative, N/m, when the rate itself falls with the force.

    The rate at the end of a step is ``rate - rate_compliance * F`` (m/s and m/(s N); the latter is zero if
    `rate` is the rate itself), so ``F = elastic + c * (rate - rate_compliance * F)`` is solved for F, c in N
    s/m. Out of contact the damper is idle and in contact the sum never pulls, unless `in_flight`.
    """
    if damping == 0.0 or (elastic <= 0.0 and not in_flight):
        return elastic, slope
    share = 1.0 / (1.0 + damping * rate_compliance)
    force = (elastic + damping * rate) * share
    if force < 0.0 and not in_flight:
        return 0.0, 0.0
    return force, slope * share


@compiled(**INNER)
def film_under(film, force):  # type: ignore[no-untyped-def]
    """Thickness of a film under a force, N; m, and its derivative, m/N."""
    if force <= film.lightest or film.thickness == 0.0:
        return film.thickness, 0.0
    thickness = film.thickness * (force / film.lightest) ** film.power
    return thickness, film.power * thickness / force


@compiled(**INNER)
def refine(low, high, approach, residual, slope, iteration):  # type: ignore[no-untyped-def]
    """Newton step inside a bracket that it narrows; bisection where Newton fails or dawdles.

    The bracket is infinite where still open; the residual rises. Returns the bracket and the next trial
    value.
    """
    if residual < 0.0:
        low = max(low, approach)
    else:
        high = min(high, approach)
    # without contact the residual's slope is one; a smaller one is a texture that outruns the approach
    trial = approach - residual / max(slope, 1.0)
    closed = low > -np.inf and high < np.inf
    # eight steps are more than Newton needs; from there every other one halves the bracket, so that it ends
    if closed and (not (low < trial < high) or (iteration > 8 and iteration % 2 == 0)):
        trial = 0.5 * (low + high)
    return low, high, trial


@compiled(**INNER)
def without_film(law, step, approach):  # type: ignore[no-untyped-def]
    """Approach of the bodies at a position, m, of that of bodies and film, m."""
    film = law.film
    if film.thickness == 0.0:
        return approach
    low = approach
    high = approach + film.thickness
    bodies = high
    for iteration in range(ITERATIONS):
        force, stiffness = evaluate(law, step, bodies)
        apart, thinner = film_under(film, force)
        residual = bodies - apart - approach
        if abs(residual) <= FILM_TOLERANCE * film.thickness:
            break
        low, high, bodies = refine(low, high, bodies, residual, 1.0 - thinner * stiffness, iteration)
    return bodies


@compiled(cache=True)
def evaluate_all(law, approach, first):  # type: ignore[no-untyped-def]
    """Elastic forces, N, and derivatives, N/m, from the position `first` on, for one approach each (n,), m.

    The approaches are those of bodies and film. And the number of positions at which the law is continued
    beyond its data.
    """
    force = np.empty(approach.size)
    slope = np.empty(approach.size)
    beyond = 0
    for i in range(approach.size):
        step = first + i
        bodies = without_film(law, step, approach[i])
        force[i], stiffness = evaluate(law, step, bodies)
        slope[i] = stiffness / (1.0 - film_under(law.film, force[i])[1] * stiffness)
        argument = bodies - law.planes[step]
        if law.form == SHIFTED or law.form == SLICED:
            argument -= texture_at(law.states, law.values, step, argument)[0]
        beyond += argument > law.upper
    return force, slope, beyond
