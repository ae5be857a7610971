"""Checks of beams, ball bearings and a disc."""

import math
from functools import partial

import mpmath as mp
import numpy as np
from ledger import Check

from asperity.reference.materials import material
from asperity.structures.ball_bearing import BallBearing
from asperity.structures.beam import Support, SupportedBeam
from asperity.structures.outline import checked_outline, mesh_of
from asperity.structures.wheel_modes import natural_modes

STEEL = material("steel")
EQUATION = "Euler–Bernoulli, frequency equation solved by mpmath"


def supported_beams():
    """Spans, springs and ends of beams."""
    bar, per_length = 4375.0, 3.925
    pinned, clamped = Support(0.0), Support(0.0, rotational_stiffness=math.inf)
    wave = math.sqrt(bar / per_length) / (2 * math.pi)  # Hz of a root of one over a span of 1 m
    spans = SupportedBeam(2.0, bar, per_length, [pinned, Support(1.0), Support(2.0)], highest_frequency=30e3)
    of_modes = partial(Check, unit="Hz", source=EQUATION, tolerance=1e-9)
    root, found = mp.findroot(lambda x: mp.tan(x) - mp.tanh(x), 3.9), spans.natural_frequencies
    body = "beam on three supports, two spans of 1 m"
    yield of_modes("first frequency", mp.pi**2 * wave, found[0], body=body)
    yield of_modes("second frequency", root**2 * wave, found[1], body=body)
    source = "three-moment equation; tolerance: modes up to 30 kHz"
    bent = partial(Check, body="beam on three supports", source=source, tolerance=2e-5)
    under, beside = (spans.receptance(0.0, place, 0.5).real * bar for place in (0.5, 1.5))
    yield bent("deflection under a load amid a span, B w/FL³", 23 / 1536, under)
    yield bent("amid the other span", -3 / 512, beside)
    propped = SupportedBeam(1.0, bar, per_length, [clamped, Support(1.0)], highest_frequency=90e3)
    found = propped.receptance(0.0, 0.5, 0.5).real * bar
    what = "beam clamped and pinned: deflection amid, B w/FL³"
    source = "three-moment equation; tolerance: modes up to 90 kHz"
    yield Check(what, 7 / 768, found, source=source, tolerance=1e-5)
    kappa = 40.0
    sprung = SupportedBeam(1.0, bar, per_length, [clamped, Support(1.0, kappa * bar)], highest_frequency=2e3)

    def equation(x):
        bent = mp.sin(x) * mp.cosh(x) - mp.cos(x) * mp.sinh(x)
        return x**3 * (1 + mp.cos(x) * mp.cosh(x)) + kappa * bent

    expected = mp.findroot(equation, 3.4) ** 2 * wave
    what = "cantilever with a spring of 40 B/L³ at its tip: first frequency"
    yield of_modes(what, expected, sprung.natural_frequencies[0])


def loaded_bearings():
    """Very many balls, and loads so small that contact angles stay: what catalogues print of any bearing."""
    row = partial(Check, source="printed, NSK CAT. No. E728g, 5.1", tolerance=5e-4, absolute=True)
    many = BallBearing(199, 1e-3, 80e-3, clearance=0.0).loaded(100.0, cage_angles=[0.0])
    body = "ball bearing without clearance, radial load F"
    yield row("largest ball load Z/F", 4.37, many.inner_load.max() * 199 / 100.0, body=body, tolerance=5e-3)
    angle, ratios = math.radians(30.0), np.array([1.21, 1.22])
    tilted = BallBearing(199, 1e-3, 80e-3, contact_angle=angle)
    axial = [
        tilted.loaded(1e-3, 1e-3 * ratio * math.tan(angle), cage_angles=[0.0]).displacement[0, 2]
        for ratio in ratios
    ]
    found = np.interp(tilted.groove_distance * math.sin(angle), axial, ratios)  # as far as without load
    yield row("axial over radial load and tan α, half of it loaded", 1.216, found, body="ball bearing of 30°")


def clamped_disc():
    """A disc clamped inside, by the elements of wheels."""
    modulus, nu, density = (mp.mpf(x) for x in (STEEL.youngs_modulus, STEEL.poisson_ratio, STEEL.density))

    inner, outer, thick = mp.mpf("0.2"), mp.mpf("0.5"), mp.mpf("0.004")
    scale = mp.sqrt(modulus * thick**2 / (12 * (1 - nu**2) * density)) / (2 * mp.pi)

    def plate(n, k):
        """Clamped inside and free outside, in the functions of Bessel."""
        rows = []
        for f, sign in ((mp.besselj, -1), (mp.bessely, -1), (mp.besseli, 1), (mp.besselk, 1)):
            w, d, dd = (k**order * mp.diff(lambda x, f=f: f(n, x), outer * k, order) for order in range(3))
            moment = dd + nu * (d / outer - (n / outer) ** 2 * w)
            shear = sign * k**2 * d + (1 - nu) * n**2 / outer**2 * (w / outer - d)
            slope = k * mp.diff(lambda x, f=f: f(n, x), inner * k)
            rows.append([f(n, inner * k), slope, moment / k**2, shear / k**3])
        return mp.det(mp.matrix(rows))

    body, source = "steel disc, 0.2 m to 0.5 m, 4 mm, clamped inside", "Kirchhoff's plate, solved by mpmath"
    mesh = mesh_of(checked_outline([[0.2, 0.0], [0.5, 0.0], [0.5, 0.004], [0.2, 0.004]]), 0.002)
    fixed = np.tile(mesh.nodes[:, :1] < 0.2 + 1e-9, 3)
    row = partial(Check, body=body, source=source, tolerance=3e-3)
    for n, start in ((0, "6.5"), (2, "7.5"), (4, "11.5")):
        expected = mp.findroot(lambda k, n=n: plate(n, k), mp.mpf(start)) ** 2 * scale
        frequency, _ = natural_modes(mesh, n, STEEL, 1.2 * float(expected), fixed)
        yield row(f"lowest frequency, n = {n}", expected, frequency[0], "Hz")
