"""Films of line contacts by Reynolds' equation and an elastic half-plane, solved by Newton's method."""

import numpy as np
from scipy.sparse import diags_array

from asperity.contact.oil import POLE, REFERENCE_PRESSURE


def solved_film(speed, material, load, *, compressed=True, inlet=8.0, cells=600):
    """Film of a steady line contact over its radius, in the middle and least, by its numbers U, G and W.

    d/dx (ρ h³/12η dp/dx) = u d(ρh)/dx for p > 0, h = h₀ + x²/2R − (2/πE*) ∫ p ln|x − s| ds, ∫ p dx = F/L;
    viscosity by Roelands, density by Dowson and Higginson, or constant. Lengths are half widths b of the dry
    contact, pressures those of Hertz there, films b²/R; steel and an oil of 20 mPa s.
    """
    twice, viscosity = 2.3e11, 0.02
    width, peak = np.sqrt(8.0 * load / np.pi), twice * np.sqrt(load / (2.0 * np.pi))
    drag = 12.0 * speed * twice / (width**3 * peak)
    height = np.log(viscosity) + POLE
    index = material / twice * REFERENCE_PRESSURE / height
    x = np.linspace(-inlet, 1.5, cells)
    step = x[1] - x[0]
    distance = x[:, None] - x[None, :]
    elastic = -(_integral(distance + 0.5 * step) - _integral(distance - 0.5 * step)) / np.pi
    pressure = np.sqrt(np.maximum(1.0 - x**2, 0.0))
    guess = 3.0 * speed**0.69 * material**0.56 * load**-0.1 / width**2
    apart = guess - float(np.interp(0.0, x, 0.5 * x**2 + elastic @ pressure))
    mean = diags_array([0.5, 0.5], offsets=[0, 1], shape=(cells - 1, cells))
    rise = diags_array([-1.0 / step, 1.0 / step], offsets=[0, 1], shape=(cells - 1, cells))
    gain = diags_array([-1.0 / step, 1.0 / step], offsets=[0, 1], shape=(cells - 2, cells - 1))
    behind = _upwind(cells, step)
    for _ in range(80):
        film = np.maximum(apart + 0.5 * x**2 + elastic @ pressure, 1e-3 * guess)
        ratio = 1.0 + pressure * peak / REFERENCE_PRESSURE
        thin = np.exp(-height * (ratio**index - 1.0))  # η₀/η
        thinning = -thin * height * index * ratio ** (index - 1.0) * peak / REFERENCE_PRESSURE
        below = 1.0 + 1.7e-9 * peak * pressure * compressed
        dense = 1.0 + 0.6e-9 * peak * pressure * compressed / below
        densing = 0.6e-9 * peak * compressed / below**2
        # what flows by pressure, ε dp/dx, and with the surfaces; derivatives by films, pressures and h₀
        easy = dense * film**3 * thin
        easing = film**3 * (densing * thin + dense * thinning)
        slope = rise @ pressure
        sloping = gain @ diags_array(slope) @ mean
        by_film = sloping @ diags_array(3.0 * easy / film) - drag * behind @ diags_array(dense)
        by_pressure = sloping @ diags_array(easing) - drag * behind @ diags_array(densing * film)
        by_pressure += gain @ diags_array(mean @ easy) @ rise
        missed, matrix = np.zeros(cells + 1), np.zeros((cells + 1, cells + 1))
        missed[1:-2] = gain @ (mean @ easy * slope) - drag * behind @ (dense * film)
        matrix[1:-2, :-1] = by_film @ elastic + by_pressure.toarray()
        matrix[1:-2, -1] = by_film.sum(axis=1)
        scale = np.abs(np.diag(matrix)[:-1]) + 1e-30
        empty = np.flatnonzero(pressure + missed[:-1] / scale <= 0.0)  # where the oil leaves
        matrix[empty] = 0.0
        matrix[empty, empty] = 1.0
        missed[empty] = pressure[empty]
        matrix[-1, :-1], missed[-1] = step, pressure.sum() * step - 0.5 * np.pi
        rows = 1.0 / np.abs(matrix).max(axis=1)
        change = -np.linalg.solve(matrix * rows[:, None], missed * rows)
        most = np.abs(change[:-1]).max()
        share = min(1.0, 0.3 / most)
        pressure = np.maximum(pressure + share * change[:-1], 0.0)
        apart += share * change[-1]
        if most < 1e-6:
            break
    else:
        raise AssertionError("Newton's method has not come to its end")
    film = (apart + 0.5 * x**2 + elastic @ pressure) * width**2
    return float(np.interp(0.0, x, film)), float(film[np.abs(x) < 1.2].min())


def _integral(distance):
    """Integral of ln|x| from zero to a distance."""
    return distance * (np.log(np.abs(distance) + 1e-300) - 1.0)


def _upwind(cells, step):
    """Derivative of what surfaces carry, at all points but both ends, from the inlet on, a matrix."""
    found = diags_array([0.5, -2.0, 1.5], offsets=[-1, 0, 1], shape=(cells - 2, cells)).tolil()
    found[0, :2] = -1.0, 1.0
    return found.tocsr() / step
