"""Checks of beams, balls, wheels and springs that relax."""

import math
import warnings
from dataclasses import replace
from functools import partial

import mpmath as mp
import numpy as np
from ledger import Check
from scipy.optimize import newton
from scipy.special import ivp, jvp, kvp, yvp

from asperity import BallBearing, Beam, RollerBearing, Support, SupportedBeam, Wheel, material
from asperity.errors import OutOfRangeWarning
from asperity.structures.outline import checked_outline, mesh_of
from asperity.structures.wheel_modes import natural_modes

STEEL = material("steel")
EQUATION = "Euler–Bernoulli, frequency equation solved by mpmath"


def beam_frequencies():
    """Roots of the frequency equations of Euler–Bernoulli beams, found by mpmath."""
    wave = mp.sqrt(mp.mpf(STEEL.youngs_modulus) * mp.mpf("0.01") ** 2 / (12 * mp.mpf(STEEL.density)))

    def of_free_or_clamped(x):
        return mp.cos(x) - 1 / mp.cosh(x)

    for support, equation, starts in (
        ("simply-supported", mp.sin, (mp.pi, 5 * mp.pi)),
        ("clamped", of_free_or_clamped, ("4.73", "17.28")),
        ("free", of_free_or_clamped, ("4.73", "17.28")),
    ):
        beam = Beam.rectangular(1.0, 0.05, 0.01, STEEL, support=support, highest_frequency=2e3)
        bending = beam.natural_frequencies[beam.natural_frequencies > 20.0]
        row = partial(Check, body=f"steel beam 1 m × 10 mm, {support}", source=EQUATION, tolerance=1e-9)
        for start, number, found in zip(starts, ("first", "fifth"), bending[[0, 4]], strict=True):
            expected = mp.findroot(equation, mp.mpf(start)) ** 2 * wave / (2 * mp.pi)
            yield row(f"{number} bending frequency", expected, found, "Hz")


def beam_compliance():
    beam = Beam.rectangular(1.0, 0.05, 0.01, STEEL, loss_factor=0.0, highest_frequency=2e5)
    expected = 1 / (48 * mp.mpf(STEEL.youngs_modulus) * (mp.mpf("0.05") * mp.mpf("0.01") ** 3 / 12))
    found = abs(beam.receptance(1e-3, 0.5, 0.5))
    what = "simply supported beam: static compliance at mid-span"
    source = "L³/48EI; tolerance: modes up to 200 kHz"
    yield Check(what, expected, found, "µm/N", source=source, tolerance=1e-5)


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
    straight = RollerBearing(199, 1e-3, 1e-3, 80e-3, crowning="cylindrical")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", OutOfRangeWarning)  # of their ends
        heaviest = straight.loaded(100.0, cage_angles=[0.0]).inner_load.max()
        inclined, ratios = straight.with_(contact_angle=angle), np.array([1.25, 1.27])
        axial = [
            inclined.loaded(100.0, 100.0 * each * math.tan(angle), cage_angles=[0.0]).displacement[0, 2]
            for each in ratios
        ]
    printed = partial(Check, source="printed, as above; that is for δ^1.1, here δ^(10/9)", tolerance=2e-3)
    body = "roller bearing without clearance, radial load F"
    yield printed("largest roller load Z/F", 4.08, heaviest * 199 / 100.0, body=body)
    found = np.interp(0.0, axial, ratios)
    yield printed("axial over radial load and tan α, half of it loaded", 1.260, found, body="rollers at 30°")


ROLLERS = {
    "straight": ({"crowning": "cylindrical"}, {0: (896.222, 1e-6), 1: (623.282, 1e-6)}),
    "of a drop of 2 µm in a circle": (
        {"crowning": "circular", "crowning_drop": 2e-6},
        {0: (906.461, 1e-5), 1: (611.908, 5e-5), 2: (8.717, 5e-3)},
    ),
}
"""Loads of rollers by their places, N, and how near: of one that hardly touches both differ by its ends."""


def loaded_rollers():
    """An NU205 of steel of 207 GPa, 13 rollers 7.8 mm long, 20 µm of clearance, 2 kN on the first of them."""
    source = "tribology 0.5.16 (M. Ploss), fcylrolbear, DIN 26281, on 2001 places, to 1e-9 of the load"
    steel = replace(RollerBearing.named("NU205").material, youngs_modulus=207e9)
    of = RollerBearing.named("NU205", clearance=20e-6, slices=1000, material=steel, roller_material=steel)
    for name, (crowning, expected) in ROLLERS.items():
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", OutOfRangeWarning)  # of their ends
            loads = of.with_(**crowning).loaded(2000.0, cage_angles=[0.0]).inner_load[0]
        for place, (load, tolerance) in expected.items():
            what = f"NU205 under 2 kN, rollers {name}: load of that at {360 * place / 13:.0f}°"
            yield Check(what, load, loads[place], "N", source=source, tolerance=tolerance)


def rollers_of_a_printed_test():
    """12 rollers of steel of 207 GPa; the test has 3 kN on them and, once more, on the first."""
    printed = 967.7
    steel = replace(RollerBearing.named("NU205").material, youngs_modulus=207e9)
    straight = {"crowning": "cylindrical", "clearance": 18.4e-6, "material": steel, "roller_material": steel}
    of = RollerBearing(12, 9e-3, 10e-3, 46.5e-3, **straight)
    heaviest = of.loaded(3000.0 - printed, cage_angles=[0.0]).inner_load.max()
    what = "12 straight rollers of 10 mm, 18.4 µm of clearance, 2032.3 N: load of the heaviest"
    source = "printed in the tests of tribology 0.5.16, which leaves up to 0.05 % of 3 kN out of balance"
    yield Check(what, printed, heaviest, "N", source=source, tolerance=0.1, absolute=True)


def wheels():
    found = Wheel(600.0, 65e3).receptance(np.array([250.0])).real
    what, expected = "rigid wheel of 600 kg, 250 Hz: receptance", -1 / (600 * (2 * np.pi * 250.0) ** 2)
    yield Check(what, expected, found, "nm/N", source="−1/Mω²", tolerance=1e-12)
    f, zeta, m = 1100.0, 1e-3, 250.0
    wheel = Wheel(600.0, 65e3, [f], [zeta], [m])
    for frequency, where in ((900.0, "below"), (f, "at"), (2400.0, "above")):
        w, w0 = 2 * mp.pi * frequency, 2 * mp.pi * f
        expected = abs(-1 / (600 * w**2) + 1 / (m * (w0**2 - w**2 + 2j * zeta * w0 * w)))
        found = abs(wheel.receptance(np.array([frequency])))
        source = "rigid mass and mode, 1/m(ω₀² − ω² + 2iζω₀ω)"
        what = f"wheel with a mode of 1100 Hz, {where} it: magnitude of the receptance"
        yield Check(what, expected, found, "nm/N", source=source, tolerance=1e-9)


def solids_of_revolution():
    """Rings, a disc clamped inside and a thick cylinder without axial strain, by the elements of wheels."""
    modulus, nu, density = STEEL.youngs_modulus, STEEL.poisson_ratio, STEEL.density

    def found(n, inner, outer, height, held, near):
        """Frequency nearest to one, Hz, of a section that is held in some directions at some nodes."""
        corners = [[inner, 0.0], [outer, 0.0], [outer, height], [inner, height]]
        mesh = mesh_of(checked_outline(corners), min(height, outer - inner) / 2)
        fixed = np.zeros((len(mesh.nodes), 3), dtype=bool)
        for direction in range(3):
            fixed[:, direction] = held(mesh.nodes, direction)
        frequency, _ = natural_modes(mesh, n, STEEL, 1.2 * float(near), fixed)
        return frequency[np.argmin(np.abs(frequency - float(near)))]

    row = partial(Check, unit="Hz", tolerance=3e-3)
    radius, side = 0.5, 0.008
    body = "steel ring of radius 0.5 m, 8 mm square"
    for n in (0, 2, 3):
        bent = modulus * side**2 / (12 * density * radius**4) * n**2 * (n**2 - 1) ** 2 / (n**2 + 1)
        expected = math.sqrt(bent if n else modulus / density / radius**2) / (2 * math.pi)
        what, source = (f"bending, n = {n}", "Hoppe") if n else ("breathing", "√(E/ρ)/2πR")
        obtained = found(n, 0.496, 0.504, 0.008, lambda nodes, _: nodes[:, 0] < 0.0, expected)
        yield row(what, expected, obtained, body=body, source=source)

    inner, outer, thick = 0.2, 0.5, 0.004
    scale = math.sqrt(modulus * thick**2 / (12 * (1 - nu**2) * density)) / (2 * math.pi)

    def plate(n, k):
        """Clamped inside and free outside, in the functions of Bessel."""
        rows = []
        for f, sign in ((jvp, -1), (yvp, -1), (ivp, 1), (kvp, 1)):
            w, d, dd = (k**order * f(n, outer * k, order) for order in range(3))
            moment = dd + nu * (d / outer - (n / outer) ** 2 * w)
            shear = sign * k**2 * d + (1 - nu) * n**2 / outer**2 * (w / outer - d)
            rows.append([f(n, inner * k, 0), k * f(n, inner * k), moment / k**2, shear / k**3])
        return np.linalg.det(rows)

    body = "steel disc, 0.2 m to 0.5 m, 4 mm, clamped inside"
    source = "Kirchhoff's plate, in the functions of Bessel"
    for n, start in ((0, 6.5), (2, 7.5), (4, 11.5)):
        expected = newton(lambda k, n=n: plate(n, k), start) ** 2 * scale
        clamped = found(n, 0.2, 0.5, 0.004, lambda nodes, _: nodes[:, 0] < 0.2 + 1e-9, expected)
        yield row(f"lowest frequency, n = {n}", expected, clamped, body=body, source=source)

    shear, lame = modulus / (2 * (1 + nu)), modulus * nu / ((1 + nu) * (1 - 2 * nu))
    radii, along = np.array([0.08, 0.16]), math.sqrt((lame + 2 * shear) / density)

    def breathing(frequency):
        k = 2 * math.pi * frequency / along
        stress = (lame + 2 * shear) / lame
        rows = (stress * k * f(1, k * radii) + f(1, k * radii, 0) / radii for f in (jvp, yvp))
        return np.linalg.det(list(rows))

    body = "steel cylinder, 0.08 m to 0.16 m, no axial strain"
    source = "stress-free, in the functions of Bessel"
    for what, start in (("breathing", 7500), ("radial thickness mode", 37500)):
        expected = newton(breathing, start)
        flat = found(0, 0.08, 0.16, 0.02, lambda _, direction: direction == 2, expected)
        yield row(what, expected, flat, body=body, source=source)
