"""Wheels from their drawing: solids of revolution, outlines, the tread, damping, turning, and tables."""

import math

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.optimize import brentq
from scipy.special import jv, jvp, yv, yvp

from asperity.case.tables import read_outline
from asperity.errors import InputError
from asperity.reference.materials import MATERIALS
from asperity.reference.railways import SECTIONS
from asperity.store import Store
from asperity.structures.body import Wheel
from asperity.structures.outline import WheelSection, checked_outline, mesh_of, volume_of
from asperity.structures.wheel_modes import (
    DAMPING,
    FIRST_MODES,
    SILENT,
    WheelModes,
    matrices,
    natural_modes,
    wheel_modes,
)
from refusals import refusals

STEEL = MATERIALS["steel"]
E, NU, RHO = STEEL.youngs_modulus, STEEL.poisson_ratio, STEEL.density


def rectangle(inner, outer, height, size=None):
    corners = [[inner, 0.0], [outer, 0.0], [outer, height], [inner, height]]
    return mesh_of(checked_outline(corners), size)


def held(mesh, nodes=None, directions=(0, 1, 2)):
    """Displacements that are zero: of some nodes, in some directions."""
    fixed = np.zeros((len(mesh.nodes), 3), dtype=bool)
    if nodes is not None:
        for direction in directions:
            fixed[nodes, direction] = True
    return fixed


RING, SIDE = 0.5, 0.008


@pytest.mark.parametrize("n", [0, 2, 3])
def test_a_thin_ring_breathes_and_bends_in_its_plane(n):
    """Closed forms of Hoppe; the modal mass of a radial displacement of one at n = 0 is that of the ring."""
    mesh = rectangle(RING - 0.5 * SIDE, RING + 0.5 * SIDE, SIDE)
    frequency, shapes = natural_modes(mesh, n, STEEL, 2000.0, held(mesh))
    bending = E * SIDE**2 / (12.0 * RHO * RING**4) * n**2 * (n**2 - 1) ** 2 / (n**2 + 1)
    exact = math.sqrt(bending if n else E / RHO) / (2.0 * math.pi * (1.0 if n else RING))
    at = np.argmin(np.abs(frequency - exact))
    assert frequency[at] == pytest.approx(exact, rel=1e-3)
    middle = np.argmin(np.hypot(mesh.nodes[:, 0] - RING, mesh.nodes[:, 1] - 0.5 * SIDE))
    mass = RHO * SIDE**2 * 2.0 * math.pi * RING * (0.5 * (1.0 + 1.0 / n**2) if n else 1.0)
    assert shapes[at, middle, 0] ** -2.0 == pytest.approx(mass, rel=2e-3)


@pytest.mark.parametrize("highest", [6e3, 100e3])
def test_modes_are_all_up_to_the_highest_frequency_however_many(highest):
    """As LAPACK finds them of the whole matrices: few, and more than are sought at first."""
    mesh = rectangle(0.05, 0.2, 0.01, 0.02)
    inside = mesh.nodes[:, 0] < 0.05 + 1e-9
    frequency, _ = natural_modes(mesh, 2, STEEL, highest, held(mesh, inside))
    free = np.flatnonzero(~held(mesh, inside).ravel())
    whole = [each.toarray()[np.ix_(free, free)] for each in matrices(mesh, 2, STEEL)]
    exact = np.sqrt(eigh(*whole, eigvals_only=True)) / (2.0 * np.pi)
    assert (len(frequency) > 2 * FIRST_MODES) is (highest > 6e3)
    np.testing.assert_allclose(frequency, exact[exact <= highest], rtol=1e-8)


CYLINDER = (0.08, 0.16, 0.12)
"""Radii and length of a thick cylinder, m, whose faces slide: u_z = 0 without shear."""


def cylinder_determinant(n, frequency):
    """Gazis (J. Acoust. Soc. Am. 31, 1959, 568): waves with one half-wave along; zero at natural frequencies.

    From the potentials of Helmholtz: φ, ψ e_z and ∇×(χ e_z), by their Bessel functions.
    """
    inner, outer, length = CYLINDER
    shear, lame = E / (2.0 * (1.0 + NU)), E * NU / ((1.0 + NU) * (1.0 - 2.0 * NU))
    omega, k = 2.0 * math.pi * frequency, math.pi / length
    along, across = (lame + 2.0 * shear) / RHO, shear / RHO
    columns = []
    for kind, square in enumerate([omega**2 / along, omega**2 / across, omega**2 / across]):
        part = np.sqrt(complex(square - k**2))
        for f, fp in ((jv, jvp), (yv, yvp)):
            entries = []
            for r in (inner, outer):
                x = part * r
                v, d1, d2 = f(n, x), part * fp(n, x), part**2 * fp(n, x, 2)
                if kind == 0:  # u = ∇(v cos nθ cos kz)
                    ur, dur, ut, dut, uz, duz = d1, d2, -n * v / r, -n * (d1 / r - v / r**2), -k * v, -k * d1
                elif kind == 1:  # u = ∇×(v sin nθ cos kz e_z)
                    ur, dur, ut, dut, uz, duz = n * v / r, n * (d1 / r - v / r**2), -d1, -d2, 0.0, 0.0
                else:  # u = ∇×∇×(v cos nθ sin kz e_z)
                    ur, dur, ut, dut = k * d1, k * d2, -k * n * v / r, -k * n * (d1 / r - v / r**2)
                    uz, duz = part**2 * v, part**2 * d1
                hoop = (ur + n * ut) / r
                uz_z = k * uz  # u_z goes as sin kz
                entries += [
                    (lame + 2 * shear) * dur + lame * (hoop + uz_z),
                    shear * (dut - (n * ur + ut) / r),
                    shear * (duz - k * ur),
                ]
            columns.append(np.array(entries) / shear)
    matrix = np.array(columns).T
    if n == 0:  # torsion apart
        matrix = matrix[np.ix_([0, 2, 3, 5], [0, 1, 4, 5])]
    return np.linalg.det(matrix / np.abs(matrix).max(axis=0))


def cylinder_modes(n, size=None, highest=25e3):
    """Natural frequencies whose shapes are those with one half-wave along the cylinder."""
    inner, outer, length = CYLINDER
    mesh = rectangle(inner, outer, length, size)
    faces = (mesh.nodes[:, 1] < 1e-9) | (mesh.nodes[:, 1] > length - 1e-9)
    frequency, shapes = natural_modes(mesh, n, STEEL, highest, held(mesh, faces, (2,)))
    lower, upper = (
        np.argmin(np.hypot(mesh.nodes[:, 0] - outer, mesh.nodes[:, 1] - z)) for z in (0.0, length)
    )
    first, last = shapes[:, lower, 0], shapes[:, upper, 0]
    return frequency[np.abs(first + last) < 0.02 * (np.abs(first) + np.abs(last))]


@pytest.mark.parametrize("n", [0, 1, 2, 3])
def test_a_thick_cylinder(n):
    lowest, second = cylinder_modes(n)[:2]
    for found in (lowest, second):
        low, high = (cylinder_determinant(n, found * (1.0 + part)) for part in (-5e-4, 5e-4))
        assert (low * np.conj(high)).real < 0.0  # the exact one is within 0.05 %


def test_finer_triangles_are_better_by_the_fourth_power():
    sizes = 0.02 * 0.5 ** np.arange(3)
    found = np.array([cylinder_modes(2, size)[0] for size in sizes])
    low = found[-1] * (1.0 - 2e-4)
    phase = np.conj(cylinder_determinant(2, low))
    exact = brentq(lambda f: (cylinder_determinant(2, f) * phase).real, low, found[-1], rtol=1e-13)
    errors = found / exact - 1.0
    assert (errors > 0.0).all()  # elements are too stiff
    assert (errors[:-1] / errors[1:] > 2.0**3.5).all()


# --- outlines, the tread, damping, and the table of modes

RADIUS = 0.46
SQUARE = [[0.1, -0.05], [0.2, -0.05], [0.2, 0.05], [0.1, 0.05]]


@pytest.fixture(scope="module")
def modes():
    return wheel_modes(WheelSection.named("curved-web").outline(RADIUS), STEEL, 2500.0, size=0.02)


def one_mode(n=3, frequency=2000.0, ratio=1e-3):
    row = np.array([[frequency, ratio, 250.0, n, 0.5, 0.7]])
    return WheelModes.from_table(row)


def triangles(mesh):
    """Their corners, and their areas."""
    corner = mesh.nodes[mesh.triangles[:, :3]]
    return corner, 0.5 * np.linalg.det(corner[:, 1:] - corner[:, :1])


@pytest.mark.parametrize("name", SECTIONS)
def test_named_sections_are_meshed_whole(name):
    outline = checked_outline(WheelSection.named(name).outline(RADIUS))
    mesh = mesh_of(outline)
    corner, area = triangles(mesh)
    assert (area > 0.0).all()
    volume = 2.0 * np.pi * np.sum(area * corner[:, :, 0].mean(axis=1))
    assert volume == pytest.approx(volume_of(outline), rel=2e-3)  # fillets are straightened
    assert 250.0 < STEEL.density * volume < 450.0


def test_a_web_leaves_hub_and_rim_at_right_angles_and_gets_thinner():
    section = WheelSection.named("curved-web", fillet_radius=0.0, web_bend=0.01)
    outline = section.outline(RADIUS)
    points = (len(outline) - 12) // 2
    outside, inside = outline[3 : 3 + points], outline[-1 - points : -1][::-1]
    assert (outside[:, 0] == inside[:, 0]).all()
    share = (outside[:, 0] - section.hub_radius) / (RADIUS - section.rim_thickness - section.hub_radius)
    assert outside[:, 1] - inside[:, 1] == pytest.approx(0.026 - 0.004 * share)
    middle = 0.5 * (outside[:, 1] + inside[:, 1])
    assert middle[[0, -1]] == pytest.approx([0.045 - 0.0025, -0.0025])  # the rim is from −70 to 65 mm
    assert np.interp(0.5, share, middle) == pytest.approx(0.5 * 0.045 + 0.01 - 0.0025)
    ends = np.diff(middle)[[0, -1]] / np.diff(share)[[0, -1]]
    assert np.abs(ends).max() < 0.02 * 0.045


def test_a_mesh_follows_the_outline_whatever_its_order_and_its_points():
    corners, share = np.array(SQUARE), np.arange(50)[:, None] / 50
    fine = np.vstack(
        [a + (b - a) * share for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)]
    )
    for outline in (SQUARE, SQUARE[::-1], [*SQUARE, SQUARE[0]], fine):
        mesh = mesh_of(checked_outline(outline))
        around = mesh.nodes[mesh.edges[:, 0]]
        assert len(mesh.edges) == pytest.approx(4 * 8, abs=4)
        assert (mesh.edges[:, 2] == np.roll(mesh.edges[:, 0], -1)).all()
        (r, z), (r2, z2) = around.T, np.roll(around, -1, axis=0).T
        assert 0.5 * np.sum(r * z2 - r2 * z) == pytest.approx(0.01)


def test_edges_that_triangles_do_not_meet_are_halved():
    """Along a thin web points of both sides stand against each other: a whole mesh needs more of them."""
    upper = [[0.1, 0.1], [0.2, 0.1], [0.2, 0.002], [0.237, 0.0015], [0.3, 0.002], [0.3, 0.1], [0.4, 0.1]]
    outline = checked_outline(upper + [[r, -z] for r, z in upper[::-1] if r != 0.237])
    step = 0.03
    length = np.hypot(*(np.roll(outline, -1, axis=0) - outline).T)
    mesh = mesh_of(outline, step)
    assert len(mesh.edges) > np.ceil(length / step).sum()
    (r, z), (r2, z2) = outline.T, np.roll(outline, -1, axis=0).T
    assert triangles(mesh)[1].sum() == pytest.approx(0.5 * np.sum(r * z2 - r2 * z), rel=2e-3)


test_outlines_that_are_none_are_refused = refusals(
    (SQUARE[:2], "2 different points"),
    ([SQUARE[0], SQUARE[2], SQUARE[1], SQUARE[3]], "that touch"),
    ([*SQUARE[:2], [0.3, 0.0], [0.2, -0.05], *SQUARE[2:]], "that touch"),
    ([[-0.1, 0.0], [0.2, -0.05], [0.2, 0.05]], "a radius of -100 mm"),
    ([[0.0, 0.0], [0.2, -0.05], [0.2, 0.05]], "a radius of 0 mm"),
    (np.array(SQUARE) * 1e3, "a point 200 m away"),
    (np.array(SQUARE) * 1e-3, "a point 0.0002 m away"),
    ([[0.1, 0.0], [np.nan, 0.0], [0.2, 0.1]], "received nan"),
    (np.random.default_rng(1).uniform(0.1, 0.2, (3000, 2)), "3000 different points"),
    (np.array(SQUARE) + np.array([0.0, 0.1]), "axial places of 50 mm to 150 mm"),
    ([[0.1, -0.1], [0.46, 0.1], [0.46, 0.10002], [0.1, -0.09998]], "a mean thickness of 0.0175 mm"),
    (
        [[0.1, -1e-3], [0.46, -1e-3], [0.46, 0.0], [0.46, 1e-3], [0.1, 1e-3]],
        r"6725 triangles of 0.497 mm, for a mean thickness of 1.99 mm; allowed: at most 5000, .* unit right",
    ),
    ([[0.1, 0.0], [0.2, -0.05], [0.2, 0.05]], "one point nearest to the axis"),
    of=lambda outline: wheel_modes(outline, STEEL, 1000.0),
)


test_dimensions_that_do_not_fit_are_refused = refusals(
    ({"hub_radius": 0.5}, "radii of 0.0925, 0.5"),
    ({"web_thickness": 0.2}, "a web wider"),
    ({"rim_width": 0.06}, "a rim of 0.06 m"),
    ({"flange_thickness": 0.05}, "a rim of 0.135 m"),
    of=lambda changes: WheelSection.named("curved-web", **changes).outline(RADIUS),
)


def test_a_wheel_has_its_modes_by_frequency_with_the_usual_damping(modes):
    assert (np.diff(modes.natural_frequencies) >= 0.0).all()
    assert set(modes.nodal_diameters[:4]) == {0, 1, 2, 3}
    expected = [DAMPING[min(n, 2)] for n in modes.nodal_diameters]
    assert modes.damping_ratios == pytest.approx(expected)
    quieter = modes.damped((2e-3, 3e-3), added=0.01)
    assert quieter.damping_ratios == pytest.approx(
        [(2e-3, 3e-3, 0.013)[min(n, 2)] for n in modes.nodal_diameters]
    )


def test_the_tread_is_that_beside_the_flange(modes):
    assert modes.places[[0, -1]] == pytest.approx([-0.022, 0.065], abs=5e-3)
    assert 0.0 in modes.places
    assert modes.at(0.0)[0] == pytest.approx(modes.radial[:, np.flatnonzero(modes.places == 0.0)[0]])
    for place in (-0.07, 0.066, np.nan):
        with pytest.raises(InputError, match="the tread"):
            modes.at(place)


@pytest.mark.parametrize(("unit", "metres"), [("m", 1.0), ("mm", 1e-3), ("cm", 1e-2), ("in", 0.0254)])
def test_an_outline_gives_the_same_modes_in_whatever_unit(unit, metres, tmp_path):
    """A chamfer ends as far below the running circle as the tread goes, or a rounding error further."""
    outline = np.round(WheelSection.named("straight-web").outline(0.46), 4)
    corner = int(np.argmax(outline[:, 1] + outline[:, 0]))
    chamfer = [[0.45, outline[corner, 1]], [0.457, outline[corner, 1] - 0.007]]
    drawn = np.insert(np.delete(outline, corner, axis=0), corner, chamfer, axis=0)
    lines = "".join(f"{r / metres:.12g}, {z / metres:.12g}\n" for r, z in drawn)
    (tmp_path / "a.csv").write_text(f"radius ({unit}), axial place ({unit})\n{lines}")
    np.testing.assert_allclose(read_outline(tmp_path / "a.csv"), drawn, rtol=0.0, atol=1e-11)
    expected = wheel_modes(drawn, STEEL, 500.0, size=0.02)
    assert expected.places[-1] == pytest.approx(outline[corner, 1])
    moved = np.array(drawn)
    moved[corner, 0] += -1e-12 if unit == "m" else 1e-12
    for other in (drawn / metres * metres, moved):
        found = wheel_modes(other, STEEL, 500.0, size=0.02)
        for name in ("natural_frequencies", "disc", "tread", "places"):
            np.testing.assert_allclose(getattr(found, name), getattr(expected, name), rtol=1e-6, atol=1e-9)


def test_modes_that_do_not_answer_in_the_middle_answer_beside_it():
    """A section that is its own mirror image has modes whose tread tilts."""
    half = [[0.1, 0.08], [0.15, 0.08], [0.15, 0.015], [0.4, 0.015], [0.4, 0.06], [0.46, 0.06]]
    outline = np.vstack([half, (np.array(half) * [1.0, -1.0])[::-1]])
    modes = wheel_modes(outline, STEEL, 2000.0, size=0.02)
    radial, axial = modes.at(0.0)
    tilting = np.abs(radial) < 1e-2 * np.abs(axial)
    assert 3 <= tilting.sum() < len(tilting)
    assert len(modes.table(0.03)) == len(tilting)
    aside = np.abs(modes.at(0.03)[0])
    assert (aside > SILENT * np.abs(axial))[tilting].all()
    assert modes.at(-0.03)[0][~tilting] == pytest.approx(modes.at(0.03)[0][~tilting], rel=0.02)
    assert modes.at(-0.03)[0][tilting] == pytest.approx(-modes.at(0.03)[0][tilting], rel=0.02)


def test_sound_of_a_rigid_motion_is_that_of_the_disc():
    """A ring on a soft web moves along as a whole, and the web by less than half of it."""
    below = [[0.05, -0.0005], [0.1, -0.0005], [0.1, -0.05], [0.3, -0.05]]
    modes = wheel_modes(below + [[r, -z] for r, z in below[::-1]], STEEL, 100.0, size=0.02)
    axial = int(np.flatnonzero(modes.nodal_diameters == 0)[0])
    mass = STEEL.density * np.pi * (0.3**2 - 0.1**2) * 0.1
    assert modes.at(0.0)[1][axial] ** -2.0 == pytest.approx(mass, rel=0.01)
    ring, web = ((outer**2 - inner**2) / 0.3**2 / mass for outer, inner in ((0.3, 0.1), (0.1, 0.05)))
    assert ring < modes.disc[axial] ** 2 < ring + 0.5 * web
    assert modes.tread[axial] < 0.01 * modes.disc[axial]
    # it tilts about a diameter: axially as r cos θ, whose mean square is a quarter of that at the edge
    tilting = int(np.flatnonzero(modes.nodal_diameters == 1)[0])
    quarter = 0.25 * modes.at(0.0)[1][tilting] ** 2 * (1.0 - (0.1 / 0.3) ** 4)
    assert quarter < modes.disc[tilting] ** 2 < 1.01 * quarter


def test_the_table_says_all_of_a_contact(modes):
    again = WheelModes.from_table(modes.table())
    assert again.table() == pytest.approx(modes.table(), rel=1e-12)
    place = 0.02
    table, radial = modes.table(place), modes.at(place)[0]
    frequency = np.linspace(100.0, 2500.0, 301)
    omega, natural = 2.0 * np.pi * frequency[:, None], 2.0 * np.pi * modes.natural_frequencies
    answer = np.sum(radial**2 / (natural**2 - omega**2 + 2j * modes.damping_ratios * natural * omega), axis=1)
    answer = answer - 1.0 / (600.0 * omega[:, 0] ** 2)
    found = Wheel(600.0, 65e3, *table.T[:3]).receptance(frequency)
    np.testing.assert_allclose(found, answer, rtol=1e-6)


def test_modes_are_kept(modes, tmp_path):
    outline = np.array(SQUARE)
    store = Store(tmp_path)
    first = wheel_modes(outline, STEEL, 9000.0, cache=store)
    (kept,) = store.files()
    again = wheel_modes(outline, STEEL, 9000.0, cache=store)
    assert (first.table() == again.table()).all()
    wheel_modes(outline * 1.01, STEEL, 9000.0, cache=store)
    assert len(store.files()) == 2
    assert kept.exists()


# --- turning


def receptance(modes, frequency):
    """Radial receptance of the modes alone."""
    omega, natural = 2.0 * np.pi * np.asarray(frequency)[:, None], 2.0 * np.pi * modes.natural_frequencies
    answers = 1.0 / (natural**2 - omega**2 + 2j * modes.damping_ratios * natural * omega)
    return answers @ modes.at()[0] ** 2


@pytest.mark.parametrize("ratio", [1e-4, 0.05])
def test_a_turning_wheel_answers_by_the_mean_of_shifted_receptances(ratio):
    """D. J. Thompson, Railway Noise and Vibration (2009): α(ω) = ½ [α_n(ω + nΩ) + α_n(ω − nΩ)]."""
    speed, n, modes = 120.0, 3, one_mode(ratio=ratio)
    frequency = np.linspace(1700.0, 2300.0, 601)
    shift = n * speed / (2.0 * np.pi)
    mean = 0.5 * (receptance(modes, frequency + shift) + receptance(modes, frequency - shift))
    np.testing.assert_allclose(receptance(modes.turning(speed), frequency), mean, rtol=1e-9)


def test_waves_of_a_turning_wheel_radiate_as_its_standing_modes():
    """cos nφ and sin nφ, and a force that turns around: on the tread ¼ (|α(ω + nΩ)|² + |α(ω − nΩ)|²)."""
    speed, modes = 150.0, one_mode(n=2, frequency=800.0, ratio=2e-3)
    frequency, shift = np.linspace(700.0, 900.0, 201), 2.0 * speed / (2.0 * np.pi)
    answers = [receptance(modes, frequency + way) for way in (shift, -shift)]
    around = 0.25 * np.sum(np.abs(answers) ** 2, axis=0) * 0.7**2
    turning, omega = modes.turning(speed), 2.0 * np.pi * frequency[:, None]
    natural = 2.0 * np.pi * turning.natural_frequencies
    waves = 1.0 / np.abs(natural**2 - omega**2 + 2j * turning.damping_ratios * natural * omega) ** 2
    found = 0.5 * waves @ (turning.tread * turning.at()[0]) ** 2
    np.testing.assert_allclose(found, around, rtol=0.01)


def test_modes_without_nodal_diameters_do_not_turn_and_none_turns_without_speed(modes):
    still = modes.turning(0.0)
    assert len(still.natural_frequencies) == len(modes.nodal_diameters) + np.sum(modes.nodal_diameters > 0)
    frequency = np.linspace(100.0, 2400.0, 101)
    np.testing.assert_allclose(receptance(still, frequency), receptance(modes, frequency), rtol=1e-9)
    breathing = modes.nodal_diameters == 0
    moved = modes.turning(200.0)
    alike = moved.nodal_diameters == 0
    assert moved.natural_frequencies[alike] == pytest.approx(modes.natural_frequencies[breathing], rel=1e-12)
    assert moved.disc[alike] == pytest.approx(modes.disc[breathing])


def test_a_wheel_that_outruns_its_waves_is_refused():
    with pytest.raises(InputError, match="faster than a wave of a mode of 3 nodal diameters"):
        one_mode().turning(5000.0)
