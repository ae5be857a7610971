"""Checks of contact filters, laws and rolling."""

from dataclasses import replace

import mpmath as mp
import numpy as np
from ledger import Check
from scipy.integrate import cumulative_trapezoid

from asperity import Beam, HalfSpace, Hertz, material
from asperity.laws import Linear
from asperity.reduction.filter import punch_taps, response
from asperity.reduction.texture import areal_texture
from asperity.structures.body import Body
from one_contact import roll_ball

STEEL = material("steel")


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


def punch():
    a, dx = 100e-6, 1e-6
    heights = np.zeros((801, 401))
    x = (np.arange(801) - 400) * dx
    source = "sin q/q; tolerance: 100 cells in a"
    for q in (1.0, 2.5):
        heights[:] = np.cos(q / a * x)[:, None] * 1e-9
        texture = areal_texture(heights, (dx, dx), [0.0, 1e-6], [(a, a), (a, a)], start=x[0])
        found = -texture.at(np.array([0.0]))[0, 0] / 1e-9
        what = f"`areal` on a sine of ka = {q:g}: height under the patch"
        yield Check(what, mp.sinc(q), found, source=source, tolerance=2e-3, absolute=True)
    taps = punch_taps(np.array([a]), 2e-6)
    for q in (0.0, 1.0, 2.0, 4.0):
        found, expected = response(taps, 2e-6, np.array([q / (2 * np.pi * a)]))[0, 0], float(mp.sinc(q))
        what = f"taps of Hertz's patch at ka = {q:g}: response"
        found = np.copysign(found, expected)
        yield Check(what, expected, found, source="sin q/q", tolerance=5e-3, absolute=True)


def moving_force():
    beam = Beam.rectangular(1.0, 0.05, 0.01, STEEL, loss_factor=0.0, highest_frequency=5e3)
    ball = Body.rigid(0.5, 5.0)
    critical = np.pi / beam.length * np.sqrt(beam.bending_stiffness / beam.mass_per_length)
    static = 5.0 * beam.length**3 / (48 * beam.bending_stiffness)
    for alpha in (0.1, 0.25, 0.5, 0.75):
        speed = alpha * critical
        run = roll_ball(
            replace(beam), ball, Linear(5.0, stiffness=1e-3), speed=speed, start=0.0,
            duration=1 / speed, time_step=2e-5, sensors=[0.5],
        )  # fmt: skip
        velocity = cumulative_trapezoid(run.acceleration[0], run.time, initial=0.0)
        deflection = cumulative_trapezoid(velocity, run.time, initial=0.0)
        source = "Frýba's series, Eq. 1.41; tolerance: accelerations integrated twice"
        what = f"force at {alpha:g} of the critical speed: largest mid-span deflection over the static one"
        found = deflection.max() / static
        yield Check(what, fryba_maximum(alpha), found, source=source, tolerance=1e-3)


def fryba_maximum(alpha):
    """Largest mid-span deflection over FL³/48EI under a constant force that crosses an undamped beam."""
    s = np.linspace(0.0, 1.0, 20001)  # vt/L
    total = np.zeros_like(s)
    for n in range(1, 60, 2):
        bracket = np.sin(n * np.pi * s) - alpha / n * np.sin(n**2 * np.pi * s / alpha)
        total += np.sin(n * np.pi / 2) * bracket / (n**2 * (n**2 - alpha**2))
    return float(96 / np.pi**4 * total.max())
