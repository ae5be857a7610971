"""Checks of contact filters, laws and rolling."""

import mpmath as mp
import numpy as np
from ledger import Check

from asperity import HalfSpace, Hertz


def filter_of_the_half_space():
    """A ball over a small sine: force at constant approach against the transform of the punch."""
    modulus, radius, delta = 115e9, 25e-3, 1.2e-6
    hertz = Hertz(modulus, radius, radius)
    a, stiffness = hertz.semi_axes(delta)[0], hertz.tangent_stiffness(delta)
    dx = a / 16
    n = 2 * int(1.4 * a / dx) + 1
    x = (np.arange(n) - n // 2) * dx
    body = (x[:, None] ** 2 + x[None, :] ** 2) / (2 * radius)
    half_space = HalfSpace((n, n), (dx, dx), modulus)
    amplitude = 0.01 * delta
    for q, tolerance in ((1.0, 0.005), (2.0, 0.005), (3.0, 0.01), (4.0, 0.01), (5.0, 0.01)):
        wave = amplitude * np.cos(q / a * x)[:, None] * np.ones(n)
        crest, trough = (
            half_space.solve(body - s * wave, approach=delta, rtol=1e-10).force for s in (1.0, -1.0)
        )
        found = (crest - trough) / (2 * amplitude * stiffness)
        what = f"ball over a sine of ka = {q:g}: force over stiffness times height"
        source = "transform of the flat-punch pressure, sin q/q; tolerance: 16 cells in a"
        yield Check(what, mp.sinc(q), found, source=source, tolerance=tolerance, absolute=True)
