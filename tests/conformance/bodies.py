"""Checks of beams, balls, wheels and springs that relax."""

from __future__ import annotations

import math

import mpmath as mp
import numpy as np
from ledger import Check

from asperity.reference.materials import contact_modulus, material
from asperity.structures.beam import Beam, Support, SupportedBeam
from asperity.structures.body import Ball, carriage, chain
from asperity.structures.track import Relaxation
from asperity.structures.wheel import Wheel

STEEL = material("steel")


def beam_frequencies():
    """Roots of the frequency equations of Euler–Bernoulli beams, found by mpmath."""
    e, rho = mp.mpf(STEEL.youngs_modulus), mp.mpf(STEEL.density)
    length, height = mp.mpf(1), mp.mpf("0.01")
    wave = mp.sqrt(e * height**2 / (12 * rho)) / (2 * mp.pi * length**2)
    source = "Euler–Bernoulli, frequency equation solved by mpmath"
    for support, equation, starts in (
        ("simply-supported", mp.sin, (mp.pi, 5 * mp.pi)),
        ("clamped", lambda x: mp.cos(x) - 1 / mp.cosh(x), ("4.73", "17.28")),
        ("free", lambda x: mp.cos(x) - 1 / mp.cosh(x), ("4.73", "17.28")),
    ):
        beam = Beam.rectangular(1.0, 0.05, 0.01, STEEL, support=support, highest_frequency=2e3)
        bending = beam.natural_frequencies[beam.natural_frequencies > 20.0]
        for start, number in zip(starts, ("first", "fifth"), strict=True):
            root = mp.findroot(equation, mp.mpf(start))
            found = bending[0 if number == "first" else 4]
            what = f"steel beam 1 m × 10 mm, {support}: {number} bending frequency"
            yield Check(what, source, float(root**2 * wave), found, 1e-9, "Hz")


def beam_compliance():
    beam = Beam.rectangular(1.0, 0.05, 0.01, STEEL, loss_factor=0.0, highest_frequency=2e5)
    inertia = mp.mpf("0.05") * mp.mpf("0.01") ** 3 / 12
    expected = 1 / (48 * mp.mpf(STEEL.youngs_modulus) * inertia)
    found = abs(complex(np.squeeze(beam.receptance(1e-3, 0.5, 0.5))))
    source = "L³/48EI; tolerance: modes up to 200 kHz"
    yield Check(
        "simply supported beam: static compliance at mid-span",
        source,
        float(expected) * 1e6,
        found * 1e6,
        1e-5,
        "µm/N",
    )


def ball():
    ball = Ball(0.025, STEEL)
    mass = 4 / 3 * mp.pi * mp.mpf("0.025") ** 3 * mp.mpf(STEEL.density)
    yield Check("steel ball, R = 25 mm: mass", "4/3 π R³ ρ", float(mass), ball.mass, 1e-12, "kg")
    weight = float(mass * mp.mpf("9.80665"))
    yield Check(
        "steel ball, R = 25 mm: load of its weight",
        "standard gravity 9.80665 m/s²",
        weight,
        ball.static_load,
        1e-12,
        "N",
    )
    modulus = STEEL.youngs_modulus / (2 * (1 - STEEL.poisson_ratio**2))
    yield Check(
        "steel on steel: E*",
        "1/E* = Σ (1 − ν²)/E",
        modulus / 1e9,
        contact_modulus(STEEL, STEEL) / 1e9,
        1e-12,
        "GPa",
    )


def wheels():
    rigid, omega = Wheel(600.0, 65e3), 2 * np.pi * 250.0
    found = complex(np.squeeze(rigid.receptance(np.array([250.0]))))
    yield Check(
        "rigid wheel of 600 kg, 250 Hz: receptance",
        "−1/Mω²",
        -1e9 / (600 * omega**2),
        found.real * 1e9,
        1e-12,
        "nm/N",
    )
    f, zeta, m = 1100.0, 1e-3, 250.0
    wheel = Wheel(600.0, 65e3, [f], [zeta], [m])
    for frequency, where in ((900.0, "below"), (f, "at"), (2400.0, "above")):
        w, w0 = 2 * mp.pi * frequency, 2 * mp.pi * f
        expected = -1 / (600 * w**2) + 1 / (m * (w0**2 - w**2 + 2j * zeta * w0 * w))
        found = complex(np.squeeze(wheel.receptance(np.array([frequency]))))
        source = "rigid mass and mode, 1/m(ω₀² − ω² + 2iζω₀ω)"
        what = f"wheel with a mode of 1100 Hz, {where} it: magnitude of the receptance"
        yield Check(what, source, abs(complex(expected)) * 1e9, abs(found) * 1e9, 1e-9, "nm/N")


def relaxing_springs():
    element = Relaxation(0.25, (2.0,), (100.0,))
    for frequency in (10.0, 100.0, 1000.0):
        x = mp.mpf(frequency) / 100
        loss = (2 * x / (1 + x**2)) / (mp.mpf("0.25") + 2 * x**2 / (1 + x**2))
        stiffness = complex(element.at(2 * np.pi * frequency))
        what = f"spring beside a Maxwell element of 100 Hz, {frequency:g} Hz: loss factor"
        yield Check(what, "Im K/Re K of iωτ/(1 + iωτ)", float(loss), stiffness.imag / stiffness.real, 1e-12)


def supported_beams():
    """Spans, springs and ends of beams."""
    bar, per_length = 4375.0, 3.925
    pinned, clamped = Support(0.0), Support(0.0, rotational_stiffness=math.inf)
    wave = math.sqrt(bar / per_length) / (2 * math.pi)  # Hz of a root of one over a span of 1 m
    root = mp.findroot(lambda x: mp.tan(x) - mp.tanh(x), 3.9)
    spans = SupportedBeam(2.0, bar, per_length, [pinned, Support(1.0), Support(2.0)], highest_frequency=30e3)
    body, source = "beam on three supports", "Euler–Bernoulli, frequency equation solved by mpmath"
    for number, value in (("first", mp.pi), ("second", root)):
        found = spans.natural_frequencies[0 if number == "first" else 1]
        what = f"{body}, two spans of 1 m: {number} frequency"
        yield Check(what, source, float(value**2) * wave, found, 1e-9, "Hz")
    source = "three-moment equation; tolerance: modes up to 30 kHz"
    found = spans.receptance(0.0, 0.5, 0.5).real * bar
    yield Check(f"{body}: deflection under a load amid a span, B w/FL³", source, 23 / 1536, found, 2e-5)
    found = spans.receptance(0.0, 1.5, 0.5).real * bar
    yield Check(f"{body}: amid the other span", source, -3 / 512, found, 2e-5)
    propped = SupportedBeam(1.0, bar, per_length, [clamped, Support(1.0)], highest_frequency=90e3)
    found = propped.receptance(0.0, 0.5, 0.5).real * bar
    source = "three-moment equation; tolerance: modes up to 90 kHz"
    yield Check("beam clamped and pinned: deflection amid, B w/FL³", source, 7 / 768, found, 1e-5)
    kappa = 40.0
    sprung = SupportedBeam(1.0, bar, per_length, [clamped, Support(1.0, kappa * bar)], highest_frequency=2e3)

    def equation(x):
        bent = mp.sin(x) * mp.cosh(x) - mp.cos(x) * mp.sinh(x)
        return x**3 * (1 + mp.cos(x) * mp.cosh(x)) + kappa * bent

    source = "Euler–Bernoulli, frequency equation solved by mpmath"
    expected = float(mp.findroot(equation, 3.4) ** 2) * wave
    what = "cantilever with a spring of 40 B/L³ at its tip: first frequency"
    yield Check(what, source, expected, sprung.natural_frequencies[0], 1e-9, "Hz")


def suspended_bodies():
    """Two masses in a row, and a rigid carriage off its centre."""
    body, f = chain([600.0, 4000.0], [1.2e6], [8e3]), 4.0
    s = 2j * math.pi * f
    link = 1.2e6 + 8e3 * s
    expected = abs((4000 * s**2 + link) / ((600 * s**2 + link) * (4000 * s**2 + link) - link**2))
    found = float(np.abs(body.receptance(f))[0, 0, 0])
    what = "wheel of 600 kg under 4 t on a spring and damper: receptance at 4 Hz"
    yield Check(what, "Newton's equations, by hand", expected * 1e6, found * 1e6, 1e-12, "µm/N")
    loaded = carriage(2.0, 0.01, [0.0, 0.03, 0.09], centre=0.03)
    expected = abs((1 / 2.0 + 0.06 * 0.06 / 0.01) / s**2)
    found = float(np.abs(loaded.receptance(f))[0, 2, 2])
    what = "rigid carriage at the contact farthest from its centre: receptance at 4 Hz"
    yield Check(what, "1/m + x²/J over ω²", expected * 1e6, found * 1e6, 1e-12, "µm/N")


CHECKS = (
    beam_frequencies, beam_compliance, supported_beams, suspended_bodies, ball, wheels, relaxing_springs,
)  # fmt: skip
