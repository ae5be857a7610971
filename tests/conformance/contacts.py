"""Checks of the contact: Hertz, Love, the program CONTACT, peers, hardness, and traps."""

from __future__ import annotations

import json
from pathlib import Path

import mpmath as mp
import numpy as np
from ledger import Check

from asperity.contact import HalfSpace, Hertz
from asperity.contact.hertz import in_groove

DATA = Path(__file__).parent / "data"
STEEL = 210e9 / (1 - 0.3**2) / 2  # E*, both bodies of steel


# --- smooth bodies ----------------------------------------------------------------------------


def hertz_sphere():
    source = "Hertz, closed form"
    hertz, radius = Hertz(STEEL, 12.5e-3, 12.5e-3), mp.mpf("12.5e-3")
    approach = (3 * 10 / (4 * mp.mpf(STEEL) * mp.sqrt(radius))) ** (mp.mpf(2) / 3)
    body = "steel ball, R = 12.5 mm, on a steel plane, 10 N"
    yield Check(f"{body}: approach", source, float(approach) * 1e6, hertz.approach(10.0) * 1e6, 1e-12, "µm")
    radius_of_patch = mp.sqrt(radius * approach)
    obtained = hertz.semi_axes(hertz.approach(10.0))[0]
    yield Check(f"{body}: contact radius", source, float(radius_of_patch) * 1e6, obtained * 1e6, 1e-12, "µm")
    stiffness = 2 * STEEL * radius_of_patch
    obtained = hertz.tangent_stiffness(hertz.approach(10.0))
    yield Check(f"{body}: dF/dδ = 2E*a", source, float(stiffness) / 1e6, obtained / 1e6, 1e-12, "MN/m")


def hertz_wheel_on_rail():
    """General curvatures: the ratio of the axes from complete elliptic integrals, solved by mpmath."""
    source = "Hertz, elliptic integrals by mpmath"
    a_x, b_y = 1 / (2 * mp.mpf("0.46")), 1 / (2 * mp.mpf("0.3"))  # gap = A x² + B y², B > A

    def ratio(m):  # B/A for the parameter m = e²; the longer axis lies along x
        k, e = mp.ellipk(m), mp.ellipe(m)
        return ((e / (1 - m)) - k) / (k - e) - b_y / a_x

    m = mp.findroot(ratio, (0.05, 0.6), solver="anderson")
    k, e = mp.ellipk(m), mp.ellipe(m)
    hertz = Hertz(STEEL, 0.46, 0.3)
    for load in (50e3, 65e3, 100e3):
        # a³ = 3 F (K − E)/(2π E* A e²)·…: with p0 = 3F/(2πab), A = p0 b (K − E)/(E* e² a²)
        a = (3 * load * (k - e) / (2 * mp.pi * mp.mpf(STEEL) * a_x * m)) ** (mp.mpf(1) / 3)
        b = a * mp.sqrt(1 - m)
        peak = 3 * load / (2 * mp.pi * a * b)
        approach = peak * b * k / mp.mpf(STEEL)
        found = hertz.approach(load)
        axes = hertz.semi_axes(found)
        body = f"wheel R = 0.46 m on rail head R = 0.30 m, {load / 1e3:.0f} kN"
        yield Check(f"{body}: approach", source, float(approach) * 1e6, found * 1e6, 1e-9, "µm")
        yield Check(f"{body}: semi-axis along", source, float(a) * 1e3, axes[0] * 1e3, 1e-9, "mm")
        yield Check(f"{body}: semi-axis across", source, float(b) * 1e3, axes[1] * 1e3, 1e-9, "mm")
        stiffness = float(3 * load / (2 * approach)) / 1e9
        yield Check(f"{body}: dF/dδ", source, stiffness, hertz.tangent_stiffness(found) / 1e9, 1e-9, "GN/m")


def sphere(n):
    """A sphere on the grid, contact radius 0.35 of the half width."""
    h = 1.0 / n
    x = (np.arange(n) + 0.5) * h - 0.5
    radius, approach = 1.0, (0.35 * 0.5) ** 2
    gap = (x[:, None] ** 2 + x[None, :] ** 2) / (2 * radius)
    return HalfSpace((n, n), (h, h), 1.0), gap, approach


def sphere_on_the_grid():
    source = "Hertz; tolerance: cells of constant pressure"
    for n, force_error, peak_error in ((64, 5e-4, 2e-3), (128, 1e-4, 5e-4), (256, 5e-5, 1.5e-4)):
        half_space, gap, approach = sphere(n)
        contact = half_space.solve(gap, approach=approach, rtol=1e-10)
        force = 4 / 3 * approach**1.5
        yield Check(f"sphere on {n}² cells: force at an approach", source, force, contact.force, force_error)
        peak = 2 / np.pi * np.sqrt(approach)
        yield Check(
            f"sphere on {n}² cells: largest pressure", source, peak, contact.pressure.max(), peak_error
        )
    half_space, gap, approach = sphere(128)
    contact = half_space.solve(gap, load=4 / 3 * approach**1.5, rtol=1e-10)
    yield Check("sphere on 128² cells: approach under a load", source, approach, contact.approach, 1e-4)
    tangent = half_space.tangent_stiffness(contact.pressure)
    yield Check("sphere on 128² cells: dF/dδ = 2a", source, 2 * np.sqrt(approach), tangent, 0.02)


def flat_punch():
    n = 128
    h = 1.0 / n
    x = (np.arange(n) + 0.5) * h - 0.5
    inside = x[:, None] ** 2 + x[None, :] ** 2 < 0.25**2
    contact = HalfSpace((n, n), (h, h), 1.0).solve(np.where(inside, 0.0, 1.0), approach=1e-3)
    source = "Sneddon, F = 2E*aδ; tolerance: the steps of a circle on cells"
    yield Check("rigid circular punch, a = 32 cells: force", source, 2 * 0.25 * 1e-3, contact.force, 0.01)


# --- influence coefficients -------------------------------------------------------------------


def love(width, length, x, y):
    """Displacement at (x, y) under unit pressure on a rectangle about the origin, E* = 1."""
    west, east, south, north = x - width / 2, x + width / 2, y - length / 2, y + length / 2

    def corner(p, q):  # ∫∫ 1/√(ξ²+η²) over the rectangle from the origin to (p, q), p, q > 0
        return p * mp.asinh(q / p) + q * mp.asinh(p / q) if p * q else mp.mpf(0)

    total = mp.mpf(0)
    for p, sign_p in ((east, 1), (west, -1)):
        for q, sign_q in ((north, 1), (south, -1)):
            sign = sign_p * sign_q * mp.sign(p) * mp.sign(q)
            total += sign * corner(abs(p), abs(q))
    return float(total / mp.pi)


def influence():
    source = "Love 1929 in inverse hyperbolic sines, by mpmath"
    for width, length in ((1.0, 1.0), (1.0, 2.0), (5.0, 1.0)):
        n = 33
        half_space = HalfSpace((n, n), (width, length), 1.0)
        pressure = np.zeros((n, n))
        pressure[0, 0] = 1.0
        moved = half_space.displacement(pressure)
        for i, j in ((0, 0), (1, 0), (3, 2), (32, 32)):
            expected = love(mp.mpf(width), mp.mpf(length), mp.mpf(i * width), mp.mpf(j * length))
            what = f"cell {width:g} × {length:g}: displacement {i}, {j} cells away"
            yield Check(what, source, expected, moved[i, j], 1e-11)


def traps_of_convolution():
    """A window filled with pressure: a periodic kernel, or one sampled in the frequency domain, is off."""
    n = 63
    moved = HalfSpace((n, n), (1.0 / n, 1.0 / n), 1.0).displacement(np.ones((n, n)))
    centre = 4 / mp.pi * mp.log(1 + mp.sqrt(2))
    source = "uniform pressure on a square, 4 ln(1 + √2)/π"
    what = "window full of pressure (trap: periodic kernel): displacement of its centre"
    yield Check(what, source, float(centre), moved[n // 2, n // 2], 1e-12)
    corner = float(centre) / 2
    at = 2 * moved[0, 0] - moved[1, 1]  # to the corner itself, half a cell away
    yield Check("the same: displacement of its corner, half of that", source, corner, at, 0.03)
    n = 65
    h, radius = 2.2 / n, 1.0
    x = (np.arange(n) - n // 2) * h
    gap = (x[:, None] ** 2 + x[None, :] ** 2) / (2 * radius)
    contact = HalfSpace((n, n), (h, h), 1.0).solve(gap, approach=0.8, rtol=1e-10)
    what = "sphere that fills 0.81 of the window (trap: kernel sampled in the frequency domain, +2 %)"
    yield Check(what, "Hertz; tolerance: the grid", 4 / 3 * 0.8**1.5, contact.force, 1e-3)


# --- rough contacts of other programs ---------------------------------------------------------


def contact_program_gap(data, rms, n):
    a = (3 * data["load"] * data["R"] / (4 * data["estar"])) ** (1 / 3)
    d = 2.6 * a / n
    c = (np.arange(n) + 0.5) * d - 1.3 * a
    x, y = np.meshgrid(c, c, indexing="ij")
    rng = np.random.default_rng(7)
    wavelength = a * np.exp(rng.uniform(np.log(0.2), np.log(1.5), 40))
    theta, phase = rng.uniform(0, np.pi, 40), rng.uniform(0, 2 * np.pi, 40)
    amplitude = wavelength**1.8
    amplitude *= rms / np.sqrt((amplitude**2).sum() / 2)
    gap = (x**2 + y**2) / (2 * data["R"])
    for size, lam, angle, shift in zip(amplitude, wavelength, theta, phase, strict=True):
        gap -= size * np.cos(2 * np.pi / lam * (x * np.cos(angle) + y * np.sin(angle)) + shift)
    return gap, d


def contact_program():
    data = json.loads((DATA / "contact_program_64.json").read_text())
    source = "program CONTACT, rev. 2707, module 3, tolerance 1e-12"
    for case in data["cases"]:
        gap, d = contact_program_gap(data, case["rms"], case["n"])
        half_space = HalfSpace(gap.shape, (d, d), data["estar"])
        at = case["mode"] == "approach"
        given = {"approach": case["approach"]} if at else {"load": case["force"]}
        contact = half_space.solve(gap, rtol=1e-12, **given)
        surface = "smooth" if case["rms"] == 0 else f"{case['rms'] * 1e6:g} µm rms"
        body = (
            f"ball R = 25 mm, 64², {surface}, at an {case['mode']}"
            if at
            else f"ball R = 25 mm, 64², {surface}, under 30 N"
        )
        if at:
            yield Check(f"{body}: force", source, case["force"], contact.force, 1e-9, "N")
        else:
            yield Check(
                f"{body}: approach", source, case["approach"] * 1e6, contact.approach * 1e6, 1e-9, "µm"
            )
        yield Check(
            f"{body}: largest pressure", source, case["pmax"] / 1e6, contact.pressure.max() / 1e6, 1e-7, "MPa"
        )
        cells = float(np.count_nonzero(contact.pressure))
        yield Check(f"{body}: cells in contact", source, float(case["cells"]), cells, 0.0, absolute=True)
        squares = float((contact.pressure**2).sum())
        yield Check(
            f"{body}: sum of squared pressures",
            source,
            case["sum_p2"] / 1e18,
            squares / 1e18,
            1e-7,
            "MPa²·10⁶",
        )


def contact_test_bank():
    source = "public test bank of CONTACT, contact_nonhz 1; tolerance: the last digit printed"
    x = -5.25e-3 + (np.arange(21) + 0.5) * 0.5e-3
    y = -8.647e-3 + (np.arange(33) + 0.5) * 0.5241e-3
    gap = 1.214 * x[:, None] ** 2 + 0.573 * y[None, :] ** 2
    contact = HalfSpace((21, 33), (0.5e-3, 0.5241e-3), 82e9 / (1 - 0.28)).solve(gap, approach=0.05e-3)
    body = "paraboloid on 21 × 33 oblong cells"
    yield Check(f"{body}: force", source, 42.08, contact.force / 1e3, 0.01, "kN", absolute=True)
    yield Check(
        f"{body}: largest pressure", source, 675.4, contact.pressure.max() / 1e6, 0.1, "MPa", absolute=True
    )
    cells = float(np.count_nonzero(contact.pressure))
    yield Check(f"{body}: cells in contact", source, 363.0, cells, 0.0, absolute=True)


def peers():
    """Forces of tamaas and ContactMechanics, made by `make_peers.py` in an environment of their own."""
    stored = json.loads((DATA / "peers.json").read_text())
    problem = stored["problem"]
    half_space, gaps = peers_problem(problem, None)
    for peer, version in stored["versions"].items():
        for m, force in enumerate(stored["forces"][peer]):
            contact = half_space.solve(gaps[m], approach=problem["approach"], rtol=1e-10)
            what = f"rough ball on {problem['cells']}² cells, position {m + 1}, at an approach: force"
            yield Check(what, f"{peer} {version}, tolerance 1e-9", force, contact.force, 1e-6, "N")


def plastic_peer():
    """What ContactMechanics leaves of the same contacts with hardness, made by `make_plastic_peer.py`."""
    stored = json.loads((DATA / "plastic_peer.json").read_text())
    problem = json.loads((DATA / "peers.json").read_text())["problem"]
    half_space, gaps = peers_problem(problem, stored["hardness"])
    source = f"ContactMechanics {stored['version']}, tolerance 1e-10"
    for m, found in enumerate(stored["contacts"]):
        contact = half_space.solve(gaps[m], approach=problem["approach"], rtol=1e-10)
        body = f"the same, position {m + 1}, with a hardness of {stored['hardness'] / 1e9:g} GPa"
        yield Check(f"{body}: force", source, found["force"], contact.force, 1e-8, "N")
        mark = contact.plastic_indentation
        deepest = found["deepest"] * 1e6
        yield Check(f"{body}: deepest plastic indentation", source, deepest, mark.max() * 1e6, 1e-8, "µm")
        volume = mark.sum() * half_space.cell_area * 1e18
        yield Check(f"{body}: volume of the marks", source, found["volume"] * 1e18, volume, 1e-8, "µm³")


def peers_problem(problem, hardness):
    """Half-space and gaps of the three contacts that the peers solved."""
    n, spacing = problem["cells"], problem["spacing"]
    heights = np.array(problem["waves"])
    rows = np.arange(n + 2 * problem["stride"])[:, None] * spacing
    columns = np.arange(n)[None, :] * spacing
    surface = sum(a * np.cos(kx * rows + ky * columns + phase) for a, kx, ky, phase in heights)
    body = ball_on_cells(n, spacing, problem["radius"])
    starts = [m * problem["stride"] for m in range(3)]
    half_space = HalfSpace((n, n), (spacing, spacing), problem["modulus"], hardness)
    return half_space, [body - surface[first : first + n] for first in starts]


# --- hardness, first touch, hard starts -------------------------------------------------------


def hardness():
    n, spacing, cap = 32, 1e-6, 1e9
    gap = np.zeros((n, n))
    half_space = HalfSpace((n, n), (spacing, spacing), 100e9, hardness=cap)
    contact = half_space.solve(gap, approach=1e-3)
    source = "mean pressure of full plasticity is the hardness"
    area = (n * spacing) ** 2
    yield Check("flat window pressed far: force", source, cap * area, contact.force, 1e-12, "N")
    rng = np.random.default_rng(3)
    rough = HalfSpace((64, 64), (spacing, spacing), 100e9, hardness=cap)
    heights = 1e-6 * rng.standard_normal((64, 64))
    load = 0.97 * cap * (64 * spacing) ** 2
    pressed = rough.solve(-heights, load=load)
    what = "rough window under 97 % of what it carries (trap: ContactMechanics does not converge): load met"
    yield Check(what, "equilibrium", load, pressed.force, 1e-9, "N")
    at_cap = float((pressed.pressure > cap * (1 + 1e-12)).sum())
    yield Check("the same: cells above the hardness", "0 ≤ p ≤ H", 0.0, at_cap, 0.0, absolute=True)
    open_gap = float(pressed.gap[(pressed.pressure > 0) & (pressed.pressure < cap)].max() / 1e-6)
    yield Check(
        "the same: gap of the cells that are elastic",
        "complementarity",
        0.0,
        open_gap,
        1e-5,
        "µm",
        absolute=True,
    )


def full_plasticity():
    """A ball far beyond yield: F = H π a², and the displacement under uniform pressure on a circle."""
    radius, cap, spacing, n, a = 1.0, 1e6, 1e-3, 81, 30e-3
    gap = ball_on_cells(n, spacing, radius)
    half_space = HalfSpace((n, n), (spacing, spacing), STEEL, cap)
    contact = half_space.solve(gap, load=cap * np.pi * a**2, rtol=1e-9)
    body = "ball far beyond yield, mark of 30 cells radius"
    source = "closed form; tolerance: the cells of its rim"
    mean = contact.force / contact.area
    yield Check(f"{body}: mean pressure, the hardness", source, cap / 1e6, mean / 1e6, 0.01, "MPa")
    depth = a**2 / (2 * radius) - (2 - 4 / np.pi) * cap * a / STEEL
    what = f"{body}: its depth, a²/2R − (2 − 4/π) H a/E*"
    obtained = contact.plastic_indentation[n // 2, n // 2]
    yield Check(what, "uniform pressure on a circle, closed form", depth * 1e6, obtained * 1e6, 5e-3, "µm")
    elastic = HalfSpace((n, n), (spacing, spacing), STEEL)
    lowered = gap + contact.plastic_indentation
    again = elastic.solve(lowered, load=contact.force, rtol=1e-9).pressure.max() / 1e6
    what = "the same mark loaded again without hardness: largest pressure"
    yield Check(what, "a second loading is elastic", cap / 1e6, again, 1e-6, "MPa")


def scratch_hardness():
    """A ball that rolls far beyond yield rests on the half of its patch ahead: H = 8F/πw²."""
    radius, cap, spacing, n, width = 1.0, 1e6, 1e-3, 61, 40e-3
    half_space = HalfSpace((n, n), (spacing, spacing), STEEL, cap)
    load = cap * np.pi * width**2 / 8
    run_in = half_space.run_in(np.zeros((170, n)), ball_on_cells(n, spacing, radius), load, passes=1)
    depth = -run_in.heights[105:120].mean(axis=0)
    y = (np.arange(n) - n // 2) * spacing
    deep = depth > 0.5 * depth.max()
    slope, top = np.polyfit(y[deep] ** 2, depth[deep], 1)
    what = "groove of a ball rolled far beyond yield: width, of 40 cells"
    source = "scratch hardness, ASTM G171; tolerance: half a row"
    yield Check(what, source, width * 1e3, 2e3 * np.sqrt(-top / slope), 0.025, "mm")


def shakedown():
    """A smooth ball above yield rolls itself a groove that carries it at the hardness."""
    n, spacing, radius, load, cap = 41, 8e-6, 25e-3, 2.0, 0.18e9
    gap = ball_on_cells(n, spacing, radius)
    surface = HalfSpace((n, n), (spacing, spacing), 115e9, cap).run_in(np.zeros((120, n)), gap, load)
    elastic = HalfSpace((n, n), (spacing, spacing), 115e9)
    peak = max(elastic.solve(gap - surface.heights[m : m + n], load=load).pressure.max() for m in (30, 40))
    what = "ball with Hertz's 0.201 GPa on steel of 0.18 GPa, run in to shakedown: largest elastic pressure"
    source = "shakedown: p ≤ H; tolerance: 1/1000 of the approach"
    yield Check(what, source, cap / 1e9, peak / 1e9, 0.01, "GPa")


def ball_on_cells(n, spacing, radius):
    x = (np.arange(n) - n // 2) * spacing
    return (x[:, None] ** 2 + x[None, :] ** 2) / (2 * radius)


def first_touch():
    """One node touches: the load to approach curve starts as that of a single cell."""
    gap = np.full((16, 16), 1e-6)
    gap[5, 9] = 0.2e-6
    h, modulus = 2e-6, 100e9
    contact = HalfSpace((16, 16), (h, h), modulus).solve(gap, approach=0.25e-6)
    self_term = 4 * mp.log(1 + mp.sqrt(2)) / mp.pi
    force = float(0.05e-6 * h * modulus / self_term)
    yield Check(
        "one node touches, at an approach: force", "Love's self term", force, contact.force, 1e-10, "N"
    )
    touched = HalfSpace((16, 16), (h, h), modulus).solve(gap, load=force)
    yield Check(
        "one node touches, under that load: approach",
        "Love's self term",
        0.25,
        touched.approach * 1e6,
        1e-10,
        "µm",
    )
    apart = HalfSpace((16, 16), (h, h), modulus).solve(gap, approach=0.2e-6)
    yield Check("at first touch: force", "complementarity", 0.0, apart.force, 0.0, "N", absolute=True)


def cold_start():
    """White noise pressed under a load from nothing: projected conjugate gradients may cycle there."""
    rng = np.random.default_rng(11)
    h = 1e-6
    x = (np.arange(96) - 48) * h
    gap = (x[:, None] ** 2 + x[None, :] ** 2) / (2 * 5e-3) - 0.3e-6 * rng.standard_normal((96, 96))
    half_space = HalfSpace((96, 96), (h, h), 115e9, hardness=6e9)
    contact = half_space.solve(gap, load=2.0, rtol=1e-9)
    what = "white noise, capped, from a cold start (trap: cycling): load met"
    yield Check(what, "equilibrium", 2.0, contact.force, 1e-9, "N")
    again = half_space.solve(gap, approach=contact.approach, rtol=1e-9)
    yield Check(
        "the same at the approach found: force", "uniqueness of the solution", 2.0, again.force, 1e-6, "N"
    )


def bearings():
    """Curvatures of a bearing from its dimensions, and contacts over the difference of their curvatures."""
    ball, conformity, pitch = 12.7e-3, 0.52, 65e-3
    gamma = ball / pitch
    for ring, sign in (("inner", 1.0), ("outer", -1.0)):
        rolling = (2.0 + 2.0 * sign * gamma / (1.0 - sign * gamma)) / ball  # ball and raceway, by Jones
        groove = (2.0 - 1.0 / conformity) / ball
        contact = in_groove(STEEL, ball / 2, conformity * ball, sign * (pitch - sign * ball) / 2)
        along, across = 1.0 / contact.radius_x, 1.0 / contact.radius_y
        body, source = f"ball of 12.7 mm in a bearing of pitch 65 mm, {ring} ring", "sum over its radii"
        total, found = rolling + groove, along + across
        yield Check(f"{body}: curvature sum", source, total / 1e3, found / 1e3, 1e-12, "1/mm")
        expected = (rolling - groove) / total
        yield Check(f"{body}: difference over sum", source, expected, (along - across) / found, 1e-12)
    source = "Hertz, elliptic integrals by mpmath"
    for difference in (0.83495, 0.93657, 0.97290):
        contact, load = Hertz(1.0, 2.0 / (1.0 + difference), 2.0 / (1.0 - difference)), 1e-9
        unit, depth = (1.5 * load) ** (1.0 / 3.0), contact.approach(load)
        b, a = contact.semi_axes(depth)
        body = f"elliptic contact, difference over sum of curvatures {difference}"
        for name, expected, found in zip(
            ("a*", "b*", "δ*"),
            dimensionless(difference),
            (a / unit, b / unit, 2.0 * depth / unit**2),
            strict=True,
        ):
            yield Check(f"{body}: {name}", source, expected, found, 1e-9)


def dimensionless(difference):
    """Semi-axes over (3F/2E*Σρ)^(1/3), and the approach over half of Σρ times its square."""

    def integrals(ratio):  # of the semi-axes, above 1
        m = 1 - 1 / ratio**2
        return mp.ellipk(m), mp.ellipe(m)

    def miss(ratio):
        k, e = integrals(ratio)
        return ((ratio**2 + 1) * e - 2 * k) / ((ratio**2 - 1) * e) - difference

    ratio = mp.findroot(miss, (1.5, 40), solver="anderson")
    k, e = integrals(ratio)
    a = mp.cbrt(2 * ratio**2 * e / mp.pi)
    return float(a), float(a / ratio), float(2 * k / (mp.pi * a))


def slender_ellipse_on_the_grid():
    """Ball in a groove of 0.52 diameters: axis ratio 9.3, eight cells to the minor semi-axis."""
    contact = in_groove(STEEL, 6.35e-3, 0.52 * 12.7e-3, 26.15e-3)
    approach = contact.approach(200.0)
    along, across = contact.semi_axes(approach)
    h = along / 8
    x, y = (h * np.arange(-round(1.15 * a / h), round(1.15 * a / h) + 1) for a in (along, across))
    gap = x[:, None] ** 2 / (2 * contact.radius_x) + y**2 / (2 * contact.radius_y)
    solved = HalfSpace(gap.shape, (h, h), STEEL).solve(gap, approach=approach)
    body, source = "ball in a groove on the grid, axis ratio 9.3", "Hertz; tolerance: the grid"
    yield Check(f"{body}: force", source, 200.0, solved.force, 3e-4, "N")
    peak = contact.peak_pressure(approach)
    yield Check(f"{body}: peak pressure", source, peak / 1e9, solved.pressure.max() / 1e9, 1e-3, "GPa")


CHECKS = (
    hertz_sphere, hertz_wheel_on_rail, bearings, slender_ellipse_on_the_grid,
    sphere_on_the_grid, flat_punch, influence, traps_of_convolution,
    contact_program, contact_test_bank, peers, plastic_peer, hardness, full_plasticity, scratch_hardness,
    shakedown, first_touch, cold_start,
)  # fmt: skip
