"""Checks of the contact: Hertz, Love, the program CONTACT, peers, and hardness."""

import json
from functools import partial
from pathlib import Path

import mpmath as mp
import numpy as np
from ledger import Check
from make_peers import PERIOD, ball_on_cells, gaps_of, periodic_gap

from asperity import HalfSpace, Hertz
from asperity.contact.hertz import in_groove

DATA = Path(__file__).parent / "data"
STEEL = 210e9 / (1 - 0.3**2) / 2  # E*, both bodies of steel
INTEGRALS = "Hertz, elliptic integrals by mpmath"


def stored(name):
    return json.loads((DATA / name).read_text())


# --- smooth bodies ----------------------------------------------------------------------------


def hertz():
    """General curvatures: the ratio of the axes from complete elliptic integrals, solved by mpmath."""
    groove = "ball in a groove, difference over sum of curvatures"
    for body, along, across, load in (
        ("wheel R = 0.46 m on rail head R = 0.30 m, 65 kN", 0.46, 0.3, 65e3),
        *((f"{groove} {d}, 100 N", 0.01 / (1 - d), 0.01 / (1 + d), 100.0) for d in (0.83495, 0.9729)),
    ):
        a_x, b_y = 1 / (2 * mp.mpf(along)), 1 / (2 * mp.mpf(across))  # gap = A x² + B y², B > A

        def ratio(m, expected=b_y / a_x):  # B/A for the parameter m = e²; the longer axis lies along x
            k, e = mp.ellipk(m), mp.ellipe(m)
            return ((e / (1 - m)) - k) / (k - e) - expected

        m = mp.findroot(ratio, (0.05, 0.9999), solver="ridder")
        k, e = mp.ellipk(m), mp.ellipe(m)
        # a³ = 3 F (K − E)/(2π E* A e²)·…: with p0 = 3F/(2πab), A = p0 b (K − E)/(E* e² a²)
        a = (3 * load * (k - e) / (2 * mp.pi * mp.mpf(STEEL) * a_x * m)) ** (mp.mpf(1) / 3)
        approach = 3 * load / (2 * mp.pi * a) * k / mp.mpf(STEEL)
        hertz = Hertz(STEEL, along, across)
        found = hertz.approach(load)
        axes = hertz.semi_axes(found)
        row = partial(Check, body=body, source=INTEGRALS, tolerance=1e-9)
        yield row("approach", approach, found, "µm")
        yield row("semi-axis along", a, axes[0], "mm")
        yield row("semi-axis across", a * mp.sqrt(1 - m), axes[1], "mm")
        yield row("dF/dδ", 3 * load / (2 * approach), hertz.tangent_stiffness(found), "MN/m")


def bearings():
    """Curvatures of a bearing from its dimensions."""
    ball, conformity, pitch = 12.7e-3, 0.52, 65e-3
    gamma = ball / pitch
    for ring, sign in (("inner", 1.0), ("outer", -1.0)):
        rolling = (2.0 + 2.0 * sign * gamma / (1.0 - sign * gamma)) / ball  # ball and raceway, by Jones
        groove = (2.0 - 1.0 / conformity) / ball
        contact = in_groove(STEEL, ball / 2, conformity * ball, sign * (pitch - sign * ball) / 2)
        along, across = 1.0 / contact.radius_x, 1.0 / contact.radius_y
        body = f"ball of 12.7 mm in a bearing of pitch 65 mm, {ring} ring"
        row = partial(Check, body=body, source="sum over its radii", tolerance=1e-12)
        total, found = rolling + groove, along + across
        yield row("curvature sum", total, found, "1/mm")
        yield row("difference over sum", (rolling - groove) / total, (along - across) / found)


def slender_ellipse_on_the_grid():
    """Ball in a groove of 0.52 diameters: axis ratio 9.3, eight cells to the minor semi-axis."""
    contact = in_groove(STEEL, 6.35e-3, 0.52 * 12.7e-3, 26.15e-3)
    approach = contact.approach(200.0)
    along, across = contact.semi_axes(approach)
    h = along / 8
    x, y = (h * np.arange(-round(1.15 * a / h), round(1.15 * a / h) + 1) for a in (along, across))
    gap = x[:, None] ** 2 / (2 * contact.radius_x) + y**2 / (2 * contact.radius_y)
    solved = HalfSpace(gap.shape, (h, h), STEEL).solve(gap, approach=approach)
    row = partial(
        Check, body="ball in a groove on the grid, axis ratio 9.3", source="Hertz; tolerance: the grid"
    )
    peak = contact.peak_pressure(approach)
    yield row("force", 200.0, solved.force, "N", tolerance=3e-4)
    yield row("peak pressure", peak, solved.pressure.max(), "GPa", tolerance=1e-3)


def around(n, h):
    """Squared distance of the centres of n² cells of width h from the middle."""
    x = (np.arange(n) - (n - 1) / 2) * h
    return x[:, None] ** 2 + x**2


def flat_punch():
    gap = np.where(around(128, 1 / 128) < 0.25**2, 0.0, 1.0)
    contact = HalfSpace((128, 128), 1 / 128, 1.0).solve(gap, approach=1e-3)
    source = "Sneddon, F = 2E*aδ; tolerance: the steps of a circle on cells"
    what = "rigid circular punch, a = 32 cells: force"
    yield Check(what, 2 * 0.25 * 1e-3, contact.force, source=source, tolerance=0.01)


# --- influence coefficients -------------------------------------------------------------------


def love(width, length, x, y):
    """Displacement at (x, y) under unit pressure on a rectangle about the origin, E* = 1."""

    def corner(p, q):  # ∫∫ 1/√(ξ²+η²) over the rectangle from the origin to (p, q)
        return p * mp.asinh(q / abs(p)) + q * mp.asinh(p / abs(q)) if p * q else mp.mpf(0)

    ends = [(x + s * width / 2, y + t * length / 2, s * t) for s in (1, -1) for t in (1, -1)]
    return sum(sign * corner(p, q) for p, q, sign in ends) / mp.pi


def influence():
    source = "Love 1929 in inverse hyperbolic sines, by mpmath"
    for width, length in ((1.0, 1.0), (1.0, 2.0), (5.0, 1.0)):
        pressure = np.zeros((33, 33))
        pressure[0, 0] = 1.0
        moved = HalfSpace(pressure.shape, (width, length), 1.0).displacement(pressure)
        for i, j in ((0, 0), (1, 0), (3, 2), (32, 32)):
            expected = love(mp.mpf(width), mp.mpf(length), mp.mpf(i * width), mp.mpf(j * length))
            what = f"cell {width:g} × {length:g}: displacement {i}, {j} cells away"
            yield Check(what, expected, moved[i, j], source=source, tolerance=1e-11)


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
    data = stored("contact_program_64.json")
    source = "program CONTACT, rev. 2707, module 3, tolerance 1e-12"
    for case in data["cases"]:
        gap, d = contact_program_gap(data, case["rms"], case["n"])
        at = case["mode"] == "approach"
        given = {"approach": case["approach"]} if at else {"load": case["force"]}
        contact = HalfSpace(gap.shape, (d, d), data["estar"]).solve(gap, rtol=1e-12, **given)
        surface = "smooth" if case["rms"] == 0 else f"{case['rms'] * 1e6:g} µm rms"
        body = f"ball R = 25 mm, 64², {surface}, {'at an approach' if at else 'under 30 N'}"
        row = partial(Check, body=body, source=source, tolerance=1e-7)
        if at:
            yield row("force", case["force"], contact.force, "N", tolerance=1e-9)
        else:
            yield row("approach", case["approach"], contact.approach, "µm", tolerance=1e-9)
        yield row("largest pressure", case["pmax"], contact.pressure.max(), "MPa")
        cells = np.count_nonzero(contact.pressure)
        yield row("cells in contact", case["cells"], cells, tolerance=0.0, absolute=True)
        yield row("sum of squared pressures", case["sum_p2"], (contact.pressure**2).sum(), "MPa²·10⁶")


def contact_test_bank():
    x = -5.25e-3 + (np.arange(21) + 0.5) * 0.5e-3
    y = -8.647e-3 + (np.arange(33) + 0.5) * 0.5241e-3
    gap = 1.214 * x[:, None] ** 2 + 0.573 * y[None, :] ** 2
    contact = HalfSpace((21, 33), (0.5e-3, 0.5241e-3), 82e9 / (1 - 0.28)).solve(gap, approach=0.05e-3)
    source = "public test bank of CONTACT, contact_nonhz 1; tolerance: the last digit printed"
    row = partial(Check, body="paraboloid on 21 × 33 oblong cells", source=source, absolute=True)
    yield row("force", 42.08e3, contact.force, "kN", tolerance=0.01)
    yield row("largest pressure", 675.4e6, contact.pressure.max(), "MPa", tolerance=0.1)
    yield row("cells in contact", 363, np.count_nonzero(contact.pressure), tolerance=0.0)


def solved_as_peers(problem, hardness):
    """The three contacts that the peers solved, and the half-space."""
    n = problem["cells"]
    half_space = HalfSpace((n, n), problem["spacing"], problem["modulus"], hardness)
    gaps = gaps_of(problem)
    return [half_space.solve(gap, approach=problem["approach"], rtol=1e-10) for gap in gaps], half_space


def peers():
    """Forces of tamaas and ContactMechanics, made by `make_peers.py` in an environment of their own."""
    found = stored("peers.json")
    problem = found["problem"]
    contacts, _ = solved_as_peers(problem, None)
    for peer, version in found["versions"].items():
        source = f"{peer} {version}, tolerance 1e-9"
        for m, (force, contact) in enumerate(zip(found["forces"][peer], contacts, strict=True), 1):
            what = f"rough ball on {problem['cells']}² cells, position {m}, at an approach: force"
            yield Check(what, force, contact.force, "N", source=source, tolerance=1e-6)


def plastic_peer():
    """What ContactMechanics leaves of the same contacts with hardness."""
    plastic = stored("plastic_peer.json")
    source = f"ContactMechanics {plastic['version']}, tolerance 1e-10"
    contacts, half_space = solved_as_peers(stored("peers.json")["problem"], plastic["hardness"])
    for m, (found, contact) in enumerate(zip(plastic["contacts"], contacts, strict=True), 1):
        body = f"the same, position {m}, with a hardness of {plastic['hardness'] / 1e9:g} GPa"
        row = partial(Check, body=body, source=source, tolerance=1e-8)
        mark = contact.plastic_indentation
        yield row("force", found["force"], contact.force, "N")
        yield row("deepest plastic indentation", found["deepest"], mark.max(), "µm")
        yield row("volume of the marks", found["volume"], mark.sum() * half_space.cell_area, "µm³")


# --- one period of a surface without end ------------------------------------------------------


def periodic_peer():
    """A rough period under mean pressures, by tamaas, with the same spectrum of the half-space."""
    found, gap = stored("periodic_peer.json"), periodic_gap(PERIOD)
    half_space = HalfSpace(PERIOD["cells"], PERIOD["spacing"], PERIOD["modulus"], boundary="periodic")
    for peer in found["contacts"]:
        load = peer["mean"] * gap.size * half_space.cell_area
        contact = half_space.solve(gap, load=load, rtol=1e-12)
        body = f"rough period of {gap.shape[0]} × {gap.shape[1]} cells under {peer['mean'] / 1e6:g} MPa"
        source = f"tamaas {found['version']}, tolerance 1e-13"
        row = partial(Check, body=body, source=source, tolerance=1e-9)
        yield row("approach of the mean planes", peer["approach"], contact.approach, "µm")
        yield row("largest pressure", peer["largest"], contact.pressure.max(), "MPa")
        touching = np.count_nonzero(contact.pressure)
        yield row("cells in contact", peer["cells"], touching, tolerance=0)


def westergaard():
    """A wave Δ (1 − cos 2πx/λ) of 256 cells in plane strain: p* = π E* Δ/λ, a = (λ/π) asin √(p/p*)."""
    length, amplitude, n = 1e-3, 1e-7, 256
    x = (np.arange(n) - n // 2) * length / n
    gap, full = amplitude * (1 - np.cos(2 * np.pi * x[:, None] / length)), np.pi * STEEL * amplitude / length
    half_space = HalfSpace((n, 1), length / n, STEEL, boundary="periodic")
    for share in (0.1, 0.5, 0.9):
        contact = half_space.solve(gap, load=share * full * length**2 / n, rtol=1e-9)
        edge = np.arcsin(np.sqrt(share))  # πa/λ
        pressure = 2 * share * full * np.cos(np.pi * x / length) / share
        pressure *= np.sqrt(np.maximum(share - np.sin(np.pi * x / length) ** 2, 0.0))
        off = np.abs(contact.pressure[:, 0] - pressure)[
            np.abs(np.abs(x) / length - edge / np.pi) > 2 / n
        ].max()
        source = "Westergaard 1939, closed form; tolerance: the grid"
        row = partial(Check, body=f"wave of one length, p = {share:g} p*", source=source)
        moved = share * (1 - np.log(share))  # integral of the compliance −λ ln(p/p*)/(π E*)
        touching = contact.area / (length**2 / n)
        yield row("approach over amplitude", moved, contact.approach / amplitude, tolerance=1e-4)
        yield row("share in contact", 2 * edge / np.pi, touching, tolerance=2 / n, absolute=True)
        yield row(
            "largest pressure over p*", 2 * np.sqrt(share), contact.pressure.max() / full, tolerance=1e-4
        )
        yield row(
            "largest error of the pressure over p*, two cells from the edge",
            0.0,
            off / full,
            tolerance=2e-3,
            absolute=True,
        )


def wavy_in_two_directions():
    """A surface Δ (1 − cos 2πx/λ cos 2πy/λ): p* = √2 π E* Δ/λ, Hertz's balls, and circles not in contact."""
    length, amplitude, n = 1e-3, 1e-7, 256
    wave = np.cos(2 * np.pi * np.arange(n) / n)
    gap, full = amplitude * (1 - np.outer(wave, wave)), np.sqrt(2) * np.pi * STEEL * amplitude / length
    half_space = HalfSpace((n, n), length / n, STEEL, boundary="periodic")
    printed = "Johnson, Greenwood, Higginson 1985"
    row = partial(Check, body="waves along and across")

    def share_in_contact(load):
        return half_space.solve(gap, load=load * full * length**2, rtol=1e-6)

    whole = share_in_contact(1.0)
    yield row(
        "largest pressure under p*, over p*",
        2.0,
        whole.pressure.max() / full,
        source=f"{printed}, √2 π E* Δ/λ",
        tolerance=1e-5,
    )
    yield row(
        "approach under p*, over amplitude",
        1.0,
        whole.approach / amplitude,
        source="full contact",
        tolerance=1e-5,
    )
    light = share_in_contact(0.01).area / length**2
    source = f"as {printed}, π (3p/8πp*)^⅔: a ball on each crest; tolerance: its limit, the cells of rims"
    yield row(
        "share in contact, p = 0.01 p*",
        np.pi * (0.03 / (8 * np.pi)) ** (2 / 3),
        light,
        source=source,
        tolerance=0.05,
    )
    apart = 1 - share_in_contact(0.97).area / length**2
    source = (
        f"as {printed}, (3/2π)(1 − p/p*): circles in the troughs; tolerance: its limit, the cells of rims"
    )
    yield row("share not in contact, p = 0.97 p*", 1.5 / np.pi * 0.03, apart, source=source, tolerance=0.1)


def rough_period():
    """A self-affine surface, 16 cells to the shortest wave: share in contact over p/(E* h'), h' rms slope."""
    n, rng = 256, np.random.default_rng(1)
    k = np.hypot(np.fft.fftfreq(n, 1 / n)[:, None], np.fft.rfftfreq(n, 1 / n))
    filtered = np.where((k >= 4) & (k <= 16), np.maximum(k, 1.0) ** -1.8, 0.0)
    spectrum = np.fft.rfft2(rng.standard_normal((n, n))) * filtered
    heights = np.fft.irfft2(spectrum)
    curved = np.fft.irfft2(spectrum * (2 * np.pi * k) ** 2)  # the mean of height times it is that of h'²
    heights /= np.sqrt((heights * curved).mean())
    half_space = HalfSpace((n, n), 1 / n, 1.0, boundary="periodic")
    areas = [half_space.solve(-heights, load=p, rtol=1e-4).real_area for p in (0.05, 0.8)]
    row = partial(Check, body="rough period, Hurst exponent 0.8")
    source = "between √(8/π) (Persson) and √(2π) (Bush, Gibson, Thomas), as printed of computed ones"
    yield row(
        "share in contact over p/E*h' = 0.05",
        2.05,
        areas[0] / 0.05,
        source=source,
        tolerance=0.45,
        absolute=True,
    )
    source = "Persson, erf(√2 p/E*h'); tolerance: his theory"
    yield row(
        "share in contact at p/E*h' = 0.8", mp.erf(0.8 * mp.sqrt(2)), areas[1], source=source, tolerance=0.05
    )


# --- hardness ---------------------------------------------------------------------------------


def full_plasticity():
    """A ball far beyond yield: F = H π a², and the displacement under uniform pressure on a circle."""
    radius, cap, spacing, n, a = 1.0, 1e6, 1e-3, 81, 30e-3
    gap = ball_on_cells(n, spacing, radius)
    contact = HalfSpace((n, n), spacing, STEEL, cap).solve(gap, load=cap * np.pi * a**2, rtol=1e-9)
    row = partial(Check, body="ball far beyond yield, mark of 30 cells radius")
    source, mean = "closed form; tolerance: the cells of its rim", contact.force / contact.area
    yield row("mean pressure, the hardness", cap, mean, "MPa", source=source, tolerance=0.01)
    depth = a**2 / (2 * radius) - (2 - 4 / np.pi) * cap * a / STEEL
    source, found = "uniform pressure on a circle, closed form", contact.plastic_indentation[n // 2, n // 2]
    yield row("its depth, a²/2R − (2 − 4/π) H a/E*", depth, found, "µm", source=source, tolerance=5e-3)
    lowered = gap + contact.plastic_indentation
    again = HalfSpace((n, n), spacing, STEEL).solve(lowered, load=contact.force, rtol=1e-9).pressure.max()
    what = "the same mark loaded again without hardness: largest pressure"
    yield Check(what, cap, again, "MPa", source="a second loading is elastic", tolerance=1e-6)


def scratch_hardness():
    """A ball that rolls far beyond yield rests on the half of its patch ahead: H = 8F/πw²."""
    cap, spacing, n, width = 1e6, 1e-3, 61, 40e-3
    half_space, load = HalfSpace((n, n), spacing, STEEL, cap), cap * np.pi * width**2 / 8
    run_in = half_space.run_in(np.zeros((170, n)), ball_on_cells(n, spacing, 1.0), load, passes=1)
    depth = -run_in.heights[105:120].mean(axis=0)
    y = (np.arange(n) - n // 2) * spacing
    deep = depth > 0.5 * depth.max()
    slope, top = np.polyfit(y[deep] ** 2, depth[deep], 1)
    what = "groove of a ball rolled far beyond yield: width, of 40 cells"
    source = "scratch hardness, ASTM G171; tolerance: half a row"
    yield Check(what, width, 2 * np.sqrt(-top / slope), "mm", source=source, tolerance=0.025)
