"""Checks of contact filters, laws and rolling."""

from __future__ import annotations

from dataclasses import replace

import mpmath as mp
import numpy as np
from ledger import Check
from scipy.integrate import cumulative_trapezoid

from asperity.contact import HalfSpace, Hertz
from asperity.laws import HertzLaw, Linear, Printed, Shifted
from asperity.laws.layout import force
from asperity.reduction.filter import punch_taps, response
from asperity.reduction.stiffness import ForceCurve
from asperity.reduction.texture import StateTexture, areal_texture
from asperity.reference.materials import material
from asperity.structures.beam import Beam
from asperity.structures.body import Ball
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
        yield Check(what, source, float(mp.sin(q) / q), found, tolerance, absolute=True)


def punch():
    a, dx = 100e-6, 1e-6
    heights = np.zeros((801, 401))
    x = (np.arange(801) - 400) * dx
    for q in (1.0, 2.5):
        heights[:] = np.cos(q / a * x)[:, None] * 1e-9
        texture = areal_texture(heights, (dx, dx), [0.0, 1e-6], [(a, a), (a, a)], start=x[0])
        found = -float(texture.at(np.array([0.0]))[0, 0]) / 1e-9
        what = f"`areal` on a sine of ka = {q:g}: height under the patch"
        yield Check(
            what, "sin q/q; tolerance: 100 cells in a", float(mp.sin(q) / q), found, 2e-3, absolute=True
        )
    taps = punch_taps(np.array([a]), 2e-6)
    for q in (0.0, 1.0, 2.0, 4.0):
        found = float(response(taps, 2e-6, np.array([q / (2 * np.pi * a)]))[0, 0])
        expected = float(mp.sinc(q))
        what = f"taps of Hertz's patch at ka = {q:g}: response"
        yield Check(what, "sin q/q", expected, abs(found) * np.sign(expected), 5e-3, absolute=True)


def laws():
    curve, bump = ForceCurve.hertz(2.4e10), 0.2e-6
    lifted = StateTexture.unfiltered(np.full(8, bump), 1e-3, 0.0)
    at = [3e-3]
    approach = 1.5e-6
    hertz = float(mp.mpf("2.4e10") * (mp.mpf("1.5e-6")) ** mp.mpf("1.5"))
    follows = float(mp.mpf("2.4e10") * (mp.mpf("1.3e-6")) ** mp.mpf("1.5"))
    source = "F = K s^1.5"
    yield Check(
        "`hertz` on a smooth path",
        source,
        hertz,
        float(force(HertzLaw(2.4e10, None), at, approach)[0]),
        1e-12,
        "N",
    )
    found = float(force(Shifted(curve, lifted), at, approach)[0])
    yield Check("`shifted` over a pit of 0.2 µm", source, follows, found, 1e-9, "N")
    printed = float(force(Printed(curve, lifted, 0.0), at, approach)[0])
    expected = hertz / 1.5e-6 * 1.3e-6
    yield Check(
        "`printed` over a pit of 0.2 µm", "thesis Eq. 2.1, k_c(r)(r − h̃)", expected, printed, 1e-9, "N"
    )
    linear = float(force(Linear(50.0, 5e7, 1e-6, lifted), at, approach)[0])
    yield Check("`linear` over a pit of 0.2 µm", "P + k(s − s₀ − h)", 50.0 + 5e7 * 0.3e-6, linear, 1e-12, "N")


def moving_force():
    beam = Beam.rectangular(1.0, 0.05, 0.01, STEEL, loss_factor=0.0, highest_frequency=5e3)
    ball = Ball(0.025, STEEL)
    critical = np.pi / beam.length * np.sqrt(beam.bending_stiffness / beam.mass_per_length)
    static = ball.static_load * beam.length**3 / (48 * beam.bending_stiffness)
    for alpha in (0.1, 0.25, 0.5, 0.75):
        speed = alpha * critical
        run = roll_ball(
            replace(beam), ball, Linear(ball.static_load, stiffness=1e-3), speed=speed, start=0.0,
            duration=1 / speed, time_step=2e-5, sensors=[0.5],
        )  # fmt: skip
        velocity = cumulative_trapezoid(run.acceleration[0], run.time, initial=0.0)
        deflection = cumulative_trapezoid(velocity, run.time, initial=0.0)
        source = "Frýba's series, Eq. 1.41; tolerance: accelerations integrated twice"
        expected = fryba_maximum(alpha)
        what = f"force at {alpha:g} of the critical speed: largest mid-span deflection over the static one"
        yield Check(what, source, expected, deflection.max() / static, 1e-3)


def fryba_maximum(alpha):
    """Largest mid-span deflection over FL³/48EI under a constant force that crosses an undamped beam."""
    s = np.linspace(0.0, 1.0, 20001)  # vt/L
    total = np.zeros_like(s)
    for n in range(1, 60, 2):
        bracket = np.sin(n * np.pi * s) - alpha / n * np.sin(n**2 * np.pi * s / alpha)
        total += np.sin(n * np.pi / 2) * bracket / (n**2 * (n**2 - alpha**2))
    return float(96 / np.pi**4 * total.max())


CHECKS = (filter_of_the_half_space, punch, laws, moving_force)
