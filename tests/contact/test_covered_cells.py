"""Cells at the rim of a contact that count as far as they are covered: against Hertz and finer grids."""

import math
import re

import numpy as np
import pytest
from scipy import optimize

from asperity import HalfSpace, Hertz, run
from asperity.contact import pressed
from asperity.contact.batched import processor, solve_batched
from asperity.kernels import rim_curves, rims
from asperity.laws import names, spec_of
from asperity.reporting.contact_figures import contact_pressure
from asperity.scenarios.geometry import Geometry
from asperity.scenarios.rim_cells import stiffness_missed
from asperity.studies.member import kept
from asperity.surfaces.cell_means import cell_means, pressed_heights
from refusals import refusals
from small_cases import changed

OFFSETS = [(0.0, 0.0), (0.5, 0.5), (0.3, 0.1), (0.5, 0.0)]
"""Of the ball's middle from a cell's, in cells."""


def ball_on_cells(across, offset=(0.0, 0.0), ratio=1.0, cells="covered", **more):
    """Half-space and gap, as means over cells, of a ball whose contact has so many cells in its half-width.

    Modulus and radius are one: an approach is the square of the half-width.
    """
    spacing = (1.0 / across, ratio / across)
    shape = tuple(math.ceil(2.4 / h) + 5 for h in spacing)
    x, y = ((np.arange(n) - 0.5 * (n - 1) - o) * h for n, h, o in zip(shape, spacing, offset, strict=True))
    gap = 0.5 * np.add.outer(x**2 + spacing[0] ** 2 / 12.0, y**2 + spacing[1] ** 2 / 12.0)
    return HalfSpace(shape, spacing, 1.0, cells=cells, **more), gap


def stiffness_error(half_space, gap, count=25):
    """Difference quotients of the force over the approach against Hertz's tangent, and forces against his."""
    approaches = np.linspace(0.85, 1.15, count)
    forces = np.array([half_space.solve(gap, approach=d, rtol=1e-9).force for d in approaches])
    middle = 0.5 * (approaches[1:] + approaches[:-1])
    quotient = np.diff(forces) / np.diff(approaches)
    return quotient / (2.0 * np.sqrt(middle)) - 1.0, forces / (4.0 / 3.0 * approaches**1.5) - 1.0


@pytest.mark.parametrize("offset", OFFSETS)
def test_the_stiffness_of_a_ball_follows_hertz_without_steps(offset):
    for across, largest in ((6, 0.005), (9, 0.002)):
        error, _ = stiffness_error(*ball_on_cells(across, offset))
        assert np.abs(error).max() < largest
    whole, _ = stiffness_error(*ball_on_cells(6, offset, cells="whole"))
    error, _ = stiffness_error(*ball_on_cells(6, offset))
    assert whole.std() > 5.0 * error.std()


@pytest.mark.parametrize(("single", "tolerance"), [(False, 1e-12), (True, 1e-5)])
@pytest.mark.parametrize(("across", "ratio", "height"), [(5, 1.0, 0.0), (9, 0.5, 0.1), (14, 2.0, 0.03)])
def test_every_cell_at_a_rim_keeps_the_gap_of_the_curves(across, ratio, height, single, tolerance):
    """Cells are listed and computed by vectors: here one after the other, of the pressure that was found."""
    half_space, gap = ball_on_cells(across, (0.2, 0.1), ratio)
    gap += height * np.random.default_rng(across).uniform(-1.0, 1.0, gap.shape)
    block = pressed.block_of(half_space, -gap, np.zeros_like(gap), np.zeros(1), [1.0], 1, 1e-5, single)
    pressed.solve_block(half_space, block)
    pressure, found = np.pad(block.pressures[0, 0], 1), block.room.rims
    overlap = gap < 1.0
    rows, across_them = (np.flatnonzero(overlap.any(axis=axis)) for axis in (1, 0))
    first, left = max(int(rows[0]) - 1, 0), max(int(across_them[0]) - 1, 0)
    columns = min(int(across_them[-1]) + 2, gap.shape[1]) - left
    lane = 16 if single else 8
    pitch = max(-(-columns // lane) * lane, columns + 2)
    number = found.number.item()
    kept = found.kept.reshape(-1, rims.KEPT, rims.CHUNK)
    known = kept.transpose(1, 0, 2).reshape(rims.KEPT, -1)[:, :number].astype(float)
    listed = {divmod(int(q), pitch): g for q, g in zip(found.cell[:number], known[rims.GAP], strict=True)}
    sides = np.divide(half_space.spacing, half_space.modulus)
    expected, ratios = {}, []
    for i, j in zip(*np.nonzero(pressure[1:-1, 1:-1]), strict=True):
        x = pressure[i + 2, j + 1] - pressure[i, j + 1]
        y = pressure[i + 1, j + 2] - pressure[i + 1, j]
        step, p = math.hypot(x, y), pressure[i + 1, j + 1]
        if p < rim_curves.END**2 * step:
            slant = min(abs(x), abs(y)) / max(abs(x), abs(y))
            width = step / math.hypot(x / sides[0], y / sides[1])
            left_over = rim_curves.remaining_gap(math.sqrt(p / step), slant)[0]
            expected[int(i) - first, int(j) - left] = left_over * step * width
            ratios.append(math.sqrt(p / step))
    assert len(expected) > 4 * across
    assert number == len(listed)
    most = tolerance * max(expected.values())
    assert {cell: listed[cell] for cell in expected} == pytest.approx(expected, rel=0, abs=most)
    bare = [cell for cell in listed if cell not in expected]
    assert all(pressure[1 + first + i, 1 + left + j] == 0.0 or abs(listed[i, j]) < most for i, j in bare)
    softness = known[rims.SOFTNESS]
    steep = [ratio < rims.STEEP_END for ratio in ratios]
    assert 0 < sum(steep) < len(steep)
    assert (softness[[list(listed).index(cell) for cell in expected]] > 1.0).tolist() == steep
    np.testing.assert_allclose(known[rims.WEIGHT] * softness, 1.0, rtol=tolerance)
    everywhere = np.ones(int(found.cell[:number].max()) + 1)
    everywhere[found.cell[:number]] = softness
    np.testing.assert_array_equal(found.softness[: len(everywhere)], everywhere)
    np.testing.assert_allclose(found.weight[: len(everywhere)] * everywhere, 1.0, rtol=tolerance)


@pytest.mark.parametrize("across", [6, 9])
def test_what_is_told_of_whole_cells_is_about_the_most_that_they_miss(across):
    half_space, gap = ball_on_cells(across, cells="whole")
    error, _ = stiffness_error(half_space, gap)
    ball = Geometry(gap, half_space.spacing, 1.0, Hertz(1.0, 1.0, 1.0), 4.0 / 3.0, 4.0)
    assert 0.5 < np.abs(error).max() / stiffness_missed(ball) < 1.2


@pytest.mark.parametrize("ratio", [0.5, 2.0, 0.25])
def test_cells_that_are_not_square_follow_hertz_too(ratio):
    error, force = stiffness_error(*ball_on_cells(8 if ratio > 1.0 else 4, (0.3, 0.1), ratio))
    assert np.abs(error).max() < 0.006
    assert np.abs(force).max() < 0.004


def test_the_force_keeps_a_bound_of_second_order():
    cells, errors = (8, 12, 18), []
    for across in cells:
        force = np.concatenate([stiffness_error(*ball_on_cells(across, o), 4)[1] for o in OFFSETS])
        errors.append(math.sqrt(np.mean(force**2)))
    assert np.all(np.array(errors) < 0.01 / np.square(cells))


@pytest.mark.parametrize("slender", [1.0, 3.0])
def test_the_area_is_of_second_order(slender):
    """Balls and ellipses, 4 to 24 cells in the smaller semi-axis, off middles of cells, by Hertz."""
    radius = optimize.brentq(
        lambda r: np.divide(*Hertz(1.0, 1.0, r).semi_axes(1.0)[::-1]) - slender, 1.0, 50.0
    )
    hertz = Hertz(1.0, 1.0, radius)
    cells = (4, 6, 9, 12, 18, 24)
    errors = []
    most = []
    for across in cells:
        found = []
        for seed in range(8):
            offset = np.random.default_rng(seed).random(2) - 0.5
            side = hertz.semi_axes(1.0)[0] / across
            shape = tuple(math.ceil(2.3 * a / side) + 4 for a in hertz.semi_axes(1.0))
            x, y = ((np.arange(n) - 0.5 * (n - 1) - o) * side for n, o in zip(shape, offset, strict=True))
            gap = cell_means(np.add.outer(x**2 / 2.0, y**2 / (2.0 * radius)))
            half_space = HalfSpace(shape, side, 1.0, cells="covered")
            for approach in (0.9, 1.0, 1.1):
                area = half_space.solve(gap, approach=approach, rtol=1e-8).area
                found.append(area / (math.pi * np.prod(hertz.semi_axes(approach))) - 1.0)
        errors.append(math.sqrt(np.mean(np.square(found))))
        most.append(np.abs(found).max())
    assert -np.polyfit(np.log(cells), np.log(errors), 1)[0] > 1.8
    assert np.all(np.array(errors) < 0.04 / np.square(cells))
    assert max(errors[1:]) < 5e-4, errors  # from six cells on
    assert np.all(np.array(most) < 0.1 / np.square(cells))


def test_real_areas_on_whole_cells_are_less_what_stands_out_beyond_rims():
    """Balls by Hertz, a rough ball by covered cells a quarter as large; to covered cells nothing is done."""
    counted, real = [], []
    for offset in OFFSETS:
        half_space, gap = ball_on_cells(9, offset, cells="whole")
        contacts = [half_space.solve(gap, approach=d) for d in np.linspace(0.85, 1.15, 12)]
        counted += [c.area / (math.pi * c.approach) - 1.0 for c in contacts]
        real += [c.real_area / (math.pi * c.approach) - 1.0 for c in contacts]
    assert np.mean(counted) > 0.02
    assert abs(np.mean(real)) < 0.01
    assert np.std(real) < 0.017
    fine = rough((96, 96), 0.025, 0.03)
    middles = np.ascontiguousarray(fine.reshape(24, 4, 24, 4)[:, 1:3, :, 1:3].mean(axis=(1, 3)))
    exact = HalfSpace(fine.shape, 0.025, 1.0, cells="covered").solve(fine, approach=0.3)
    whole = HalfSpace(middles.shape, 0.1, 1.0).solve(middles, approach=0.3)
    assert exact.real_area == exact.area
    lone = HalfSpace((1, 1), 0.1, 1.0).solve(np.zeros((1, 1)), approach=0.1)
    assert lone.real_area == pytest.approx((1.0 - (math.pi - 1.0 + math.log(2.0)) / 6.0) * 0.1**2)
    assert abs(whole.real_area / exact.area - 1.0) < 0.3 * (whole.area / exact.area - 1.0)


def test_forces_and_stiffness_of_rough_balls_are_nearer_to_fine_cells_than_on_whole_ones():
    """Waves of 5 to 20 cells, 0.1 approaches rms: on means the force is too small, on middles too large."""
    across, parts, approaches = 9, 5, np.linspace(0.85, 1.15, 5)
    points = 2 * math.ceil(1.6 * across) + 3
    x = (np.arange(parts * points) - 0.5 * (parts * points - 1)) / (parts * across)
    ball, middle = 0.5 * np.add.outer(x**2, x**2), slice(parts // 2, None, parts)
    smooth = ball[middle, middle]

    def forces(gap, cells="covered"):
        space = HalfSpace(gap.shape, points / across / len(gap), 1.0, cells=cells)
        gap = np.ascontiguousarray(gap)
        return np.array([space.solve(gap, approach=d, rtol=1e-7).force for d in approaches])

    off, steps = {}, {}
    for seed in range(1, 6):
        rng = np.random.default_rng(seed)
        waves = [
            rng.normal() * np.cos(np.add.outer(k * x, m * x) + 6.3 * rng.random())
            for k, m in rng.normal(0.0, 5.0, (30, 2))
        ]
        texture = 0.1 * sum(waves) / math.sqrt(15.0)
        rough, exact = texture[middle, middle], forces(ball + texture)
        found = {"pressed": pressed_heights(rough), "means": cell_means(rough), "middles": rough}
        of_kinds = {name: forces(cell_means(smooth) + heights) for name, heights in found.items()}
        of_kinds["whole"] = forces(smooth + rough, "whole")
        for name, each in of_kinds.items():
            off.setdefault(name, []).extend(each / exact - 1.0)
            steps.setdefault(name, []).extend(np.diff(each) / np.diff(exact) - 1.0)
    assert np.mean(off["means"]) < 0.0 < np.mean(off["middles"])
    force, stiffness = (
        {name: math.sqrt(np.mean(np.square(each))) for name, each in of.items()} for of in (off, steps)
    )
    assert force["pressed"] < 0.7 * min(force[name] for name in ("means", "middles", "whole"))
    assert stiffness["pressed"] < 0.8 * stiffness["whole"]


def test_a_load_and_its_approach_belong_together():
    half_space, gap = ball_on_cells(6, (0.2, 0.4))
    given = half_space.solve(gap, approach=1.0, rtol=1e-9)
    found = half_space.solve(gap, load=given.force, rtol=1e-9)
    assert found.approach == pytest.approx(1.0, rel=1e-8)
    np.testing.assert_allclose(found.pressure, given.pressure, atol=1e-6 * given.pressure.max())


def test_a_case_of_covered_cells_rolls_by_table_as_by_direct():
    """On a texture of a hundredth of the approach, where both see the slope of a ball on a plane."""
    surface = {"rms": "2 nm", "longest": "0.4 mm", "shortest": "80 um"}
    contact = {"spacing": "20 um", "window": "0.5 mm", "samples": 1}
    of = {"laws": ["table", "direct"], "duration": "4 ms", "surface": surface}
    covered = run(changed("ball-on-beam", **of, contact=contact | {"rim_cells": "covered"}))
    assert covered["contact"].attrs["rim_cells"] == "covered"
    force = covered["rolling/contact_force"]
    table, direct = (force.sel(law=law).values for law in ("table", "direct"))
    assert np.sqrt(np.mean((table - direct) ** 2)) < 0.03 * direct.std()
    tree = run(changed("ball-on-beam", **of, contact=contact))
    told = tree["contact"].attrs
    assert told["rim_cells"] == "covered for table and direct"
    assert re.fullmatch(r"the texture has 0\.0\d+ approaches rms .*, up to 0\.1", told["rim_cells_chosen"])
    assert kept(tree).attrs["rim_cells"] == "covered for table and direct"
    count = f"Cells at rims count as covered for table and direct: {told['rim_cells_chosen']}."
    assert count in contact_pressure.drawn(tree).caption
    force = tree["rolling/contact_force"]
    np.testing.assert_allclose(force.sel(law="direct").values, direct, rtol=1e-9)
    assert np.sqrt(np.mean((force.sel(law="table").values - direct) ** 2)) < 0.03 * direct.std()


def test_by_default_all_laws_but_those_that_see_heights_have_the_digits_of_whole_cells():
    surface = {"rms": "20 nm", "longest": "0.4 mm", "shortest": "80 um"}
    keys = {"laws": [*names()], "duration": "4 ms", "surface": surface}
    contact = {"spacing": "20 um", "window": "0.5 mm", "samples": 1}
    usual = run(changed("ball-on-beam", **keys, contact=contact))
    whole = run(changed("ball-on-beam", **keys, contact=contact | {"rim_cells": "whole"}))
    assert usual["contact"].attrs["rim_cells"] == "covered for table and direct"
    for law in names():
        found, expected = (each["rolling/contact_force"].sel(law=law).values for each in (usual, whole))
        assert np.array_equal(found, expected) is not spec_of(law).sees_heights
    assert (usual["contact/stiffness"] == whole["contact/stiffness"]).all()


def test_starts_do_not_matter():
    half_space, gap = ball_on_cells(7, (0.1, 0.3))
    cold = half_space.solve(gap, approach=1.0, rtol=1e-10)
    other = half_space.solve(gap, approach=0.8, rtol=1e-4)
    warm = half_space.solve(gap, approach=1.0, start=other.pressure, rtol=1e-10)
    np.testing.assert_allclose(warm.pressure, cold.pressure, atol=1e-8 * cold.pressure.max())


def rough(shape, spacing, height=0.02):
    """A ball's gap with waves of some cells on it."""
    x, y = ((np.arange(n) - n / 2 + 0.3) * spacing for n in shape)
    rng = np.random.default_rng(0)
    waves = sum(
        rng.normal() * np.cos(np.add.outer(rng.normal() * x, rng.normal() * y) * 9.0 + 6.0 * rng.random())
        for _ in range(30)
    )
    return 0.5 * np.add.outer(x**2, y**2) + height * waves


@pytest.mark.parametrize("hardness", [None, 0.3, 0.2])
def test_the_tangent_is_the_central_difference(hardness):
    shape, spacing, step = (26, 22), 0.11, 1e-6
    half_space = HalfSpace(shape, spacing, 1.0, hardness, cells="covered")
    gap = rough(shape, spacing)
    contact = half_space.solve(gap, approach=0.4, rtol=1e-12)
    plus, minus = (half_space.solve(gap, approach=0.4 + s, rtol=1e-13) for s in (step, -step))
    assert contact.stiffness == pytest.approx((plus.force - minus.force) / (2.0 * step), rel=1e-5)


@pytest.mark.parametrize(("height", "share"), [(0.001, 0.3), (0.004, 0.5), (0.02, 0.8)])
def test_rough_contacts_are_nearer_to_those_of_a_fine_grid(height, share):
    """Stiffness over an approach that changes by a fiftieth, against four times the resolution.

    The rougher the surface, the more is lost with the waves that the coarse grid does not hold.
    """
    fine, shape = 0.02, (120, 120)
    gap = rough(shape, fine, height)
    approaches = np.linspace(0.3, 0.6, 16)
    quotients = {}
    for name, times, cells in (("fine", 1, "covered"), ("covered", 4, "covered"), ("whole", 4, "whole")):
        sides = tuple(n // times for n in shape)
        means = gap.reshape(sides[0], times, sides[1], times).mean(axis=(1, 3))
        half_space = HalfSpace(sides, fine * times, 1.0, cells=cells)
        forces = [half_space.solve(means, approach=d, rtol=1e-8).force for d in approaches]
        quotients[name] = np.diff(forces)
    covered = np.std(quotients["covered"] / quotients["fine"])
    whole = np.std(quotients["whole"] / quotients["fine"])
    assert covered < share * whole


def test_a_cap_is_kept_and_rims_still_count():
    half_space, gap = ball_on_cells(8, (0.3, 0.1), hardness=0.45)
    contact = half_space.solve(gap, approach=1.0, rtol=1e-8)
    finer, finer_gap = ball_on_cells(24, (0.3, 0.1), hardness=0.45)
    reference = finer.solve(finer_gap, approach=1.0, rtol=1e-8)
    assert contact.converged
    assert contact.pressure.max() == 0.45
    assert contact.force == pytest.approx(reference.force, rel=5e-3)


@pytest.mark.parametrize(("share", "largest"), [(0.86, 0.003), (0.79, 0.004), (0.63, 0.008)])
def test_the_stiffness_has_no_steps_as_cells_begin_to_flow(share, largest):
    """Against whole cells a sixth as large, whose own steps are small."""

    def quotients(across, cells, count=13):
        half_space, gap = ball_on_cells(across, (0.3, 0.1), cells=cells, hardness=share * 2.0 / math.pi)
        approaches = np.linspace(0.9, 1.1, count)
        return np.diff([half_space.solve(gap, approach=d, rtol=1e-7).force for d in approaches])

    fine = quotients(54, "whole")
    covered, whole = (np.abs(quotients(9, cells) / fine - 1.0).max() for cells in ("covered", "whole"))
    assert covered < largest
    assert whole > 2.0 * covered


def test_no_step_in_the_force_as_cells_enter():
    """Second differences of the force are bounded: where cells are whole, each that enters is a kink."""
    kinks = {}
    for cells in ("covered", "whole"):
        half_space, gap = ball_on_cells(6, cells=cells)
        approaches = np.linspace(0.9, 1.1, 81)
        forces = np.array([half_space.solve(gap, approach=d, rtol=1e-10).force for d in approaches])
        kinks[cells] = np.abs(np.diff(forces, 2)).max()
    assert kinks["covered"] < 0.25 * kinks["whole"]


def test_forces_of_six_cells_are_those_of_hertz_to_a_thousandth():
    for offset in OFFSETS:
        _, force = stiffness_error(*ball_on_cells(6, offset), 13)
        assert np.abs(force).max() < 1e-3
        assert abs(force.mean()) < 2e-4


def test_a_mean_pressure_displaces_by_the_mean_of_what_the_pressure_displaces():
    """Pressure exp(−r²/2) displaces by √(2π)/E* in the middle, with −√(2π)/E* as its Laplacian there."""
    side, size = 0.5, 41
    edges = side * (np.arange(size + 1) - 0.5 * size)
    along = np.diff([math.sqrt(0.5 * math.pi) * math.erf(x / math.sqrt(2.0)) for x in edges]) / side
    pressure = np.outer(along, along)
    expected = math.sqrt(2.0 * math.pi) * (1.0 - side**2 / 24.0)
    error = {
        cells: HalfSpace((size, size), side, 1.0, cells=cells).displacement(pressure)[size // 2, size // 2]
        / expected
        - 1.0
        for cells in ("covered", "whole")
    }
    assert abs(error["covered"]) < 5e-4
    assert abs(error["whole"]) > 5e-3


def test_a_scan_is_what_its_contacts_are_one_by_one():
    half_space, gap = ball_on_cells(6, (0.3, 0.1))
    n, m = len(gap) + 4, gap.shape[1]
    surface = 0.01 * np.cos(np.add.outer(0.7 * np.arange(n), 0.4 * np.arange(m)))
    surface -= surface.mean()
    forces = half_space.scan(surface, gap - gap.min(), [0.8, 0.9, 1.0], stride=2, rtol=1e-8)
    for position in range(3):
        here = gap - gap.min() - surface[2 * position : 2 * position + len(gap)]
        alone = half_space.solve(here, approach=0.9, rtol=1e-8).force
        assert forces.values[1, position] == pytest.approx(alone, rel=1e-6)


def rough_scan(cells, count=12):
    """Iterations of contacts of a rough ball, each from those before, and whether all converged."""
    half_space, gap = ball_on_cells(9, (0.2, 0.4), cells=cells)
    rows = np.arange(len(gap) + count)
    rng = np.random.default_rng(4)
    surface = sum(
        0.02 * rng.normal() * np.cos(np.add.outer(k * rows, m * np.arange(gap.shape[1])) + 6.0 * rng.random())
        for k, m in rng.normal(0.0, 0.7, (20, 2))
    )
    forces = half_space.scan(surface - surface.mean(), gap - gap.min(), [0.9], rtol=4e-5)
    return forces.iterations, forces.unconverged


def test_covered_cells_take_no_more_iterations_than_whole_ones():
    whole, _ = rough_scan("whole")
    covered, unconverged = rough_scan("covered")
    assert covered < 1.15 * whole
    assert unconverged == 0


def test_curves_go_through_their_values():
    for j, values in enumerate(rim_curves.LEFT):
        slant = (j / (rim_curves.SLANTS - 1)) ** 2
        found = [rim_curves.remaining_gap(k / 25.0, slant)[0] for k in range(rim_curves.KNOTS)]
        np.testing.assert_allclose(found, values, atol=1e-6)


def test_nothing_is_left_of_the_gap_far_inside_a_rim():
    for slant in (0.0, 0.3, 1.0):
        assert rim_curves.remaining_gap(rim_curves.END, slant)[0] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("cell", [(12, 0), (-12, 0), (0, 11), (8, -9), (-8, -8), (10, 6)])
def test_pressure_inside_a_rim_bends_by_the_side_of_a_cell_over_the_half_width(cell):
    """p² = 1 − r² of a ball with 12 cells in the half-width, rims along the grid and aslant."""
    n = np.arange(-14, 15) / 12.0
    pressure = np.sqrt(np.maximum(1.0 - np.add.outer(n**2, n**2), 0.0))
    i, j = (14 + each for each in cell)
    p = np.pad(pressure, 1)
    x, y = p[i + 2, j + 1] - p[i, j + 1], p[i + 1, j + 2] - p[i + 1, j]
    slant = min(abs(x), abs(y)) / max(abs(x), abs(y))
    assert rims.bend_inside(pressure, i, j, x, y, slant) == pytest.approx(rims.BEND_SHARE / 12.0, rel=0.2)


def test_asperities_of_few_cells_bend_as_the_smallest_that_are_resolved():
    lone = np.zeros((7, 7))
    lone[3, 3], lone[2, 3] = 2.0, 1.0
    assert rims.bend_inside(lone, 2, 3, 2.0, 0.0, 0.0) == rims.MOST_BENT


def on_a_device():
    """A scan of covered cells, solved in batches."""
    half_space, gap = ball_on_cells(2)
    block = pressed.block_of(half_space, 0.0 * gap, gap, np.zeros(1), np.ones(1), 1, 1e-6)
    solve_batched(half_space, block, processor())


test_what_is_refused = refusals(
    (lambda: HalfSpace((4, 4), 1.0, 1.0, cells="half"), "cells of the half-space: received 'half'"),
    (on_a_device, "cells of a scan on a device: received 'covered'"),
)
