"""Cells that sharp edges cross: against flat punches, whose stiffness is printed, and against finer cells."""

import itertools
import math

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from asperity import HalfSpace
from asperity.contact.edges import softness_at
from asperity.contact.scan import ScanJob, scan_forces
from asperity.surfaces.edges import FAR, Edges
from asperity.surfaces.faults import Fault, lay
from asperity.surfaces.strip import Rows
from refusals import refusals

MM, UM = 1e-3, 1e-6
MODULUS, RADIUS, CELL = 115e9, 10 * MM, 30 * UM
OFF = (7 * UM, -4 * UM)  # middle of a fault from that of a cell
UNIT_SQUARE = 0.36679
"""Capacity of a square of side one over 4π ε₀."""


def punch(size, shape, ratio=1.0, offset=(0.0, 0.0), sharp=True):
    """Stiffness of a flat punch, over E*, with the outline of a pit or a spall; cells are 1 × ratio."""
    spacing, outline = (1.0, ratio), Fault(shape, length=size[0] * UM, width=size[1] * UM, depth=UM)
    cells = tuple(2 * math.ceil(0.5 * side / h + 2.0) + 1 for side, h in zip(size, spacing, strict=True))
    at = [((np.arange(n) - n // 2) * h - o * h) * UM for n, h, o in zip(cells, spacing, offset, strict=True)]
    distance, normal = outline.outline(*np.meshgrid(*at, indexing="ij"))
    edges = Edges(-distance / UM, normal, np.full(cells, 1e3), spacing)
    inside = edges.sound if sharp else distance < 0.0
    edges = edges if sharp else None
    return (
        HalfSpace(cells, spacing, 1.0)
        .solve(np.where(inside, 0.0, 1e3), approach=1.0, rtol=1e-7, edges=edges)
        .force
    )


@pytest.mark.parametrize(("cells", "within"), [(4, 0.006), (8, 0.0025)])
def test_a_round_punch_of_any_size_anywhere_has_its_stiffness(cells, within):
    """k = 2 E* a; cells that are whole or not are off by ten times as much."""
    rng = np.random.default_rng(1)
    draws = [(cells * (1.0 + 0.25 * rng.random()), rng.random(2) - 0.5) for _ in range(12)]
    for ratio in (1.0, 2.5):
        error = {
            sharp: [
                punch((2 * a * ratio, 2 * a * ratio), "pit", ratio, at, sharp) / (2 * a * ratio) - 1
                for a, at in draws
            ]
            for sharp in (True, False)
        }
        assert np.abs(error[True]).max() < within
        assert np.abs(error[False]).max() > 4.0 * np.abs(error[True]).max()


def test_a_place_is_the_distance_over_the_width_of_a_cell_along_the_normal():
    """An edge at φ from the rows, the cells 2 × 3: from corner to corner 2 sin φ + 3 cos φ."""
    angles = np.radians([0.0, 10.0, 25.0, 50.0, 90.0])[:, None]
    distance = np.array([[0.4, -0.4]]) + np.zeros(angles.shape)
    edges = Edges(distance, np.sin(angles) + np.zeros(distance.shape), np.zeros(distance.shape), (2.0, 3.0))
    assert_allclose(edges.places, distance / (2.0 * np.sin(angles) + 3.0 * np.cos(angles)), rtol=1e-12)


def test_an_elliptic_punch_has_its_stiffness():
    """k = π E* a / K(e), a the longer half axis."""
    from scipy.special import ellipk

    a, b = 12.3, 6.1
    expected = math.pi * a / ellipk(1.0 - (b / a) ** 2)
    for offset in ((0.0, 0.0), (0.4, 0.2), (0.1, -0.45)):
        assert punch((2 * a, 2 * b), "pit", offset=offset) == pytest.approx(expected, rel=3e-3)


def test_a_square_punch_grows_evenly_from_cell_to_cell():
    """Its capacity is printed by F. H. Read, J. Comput. Phys. 133 (1997) 1, for a side of one."""
    sides = np.arange(8.0, 10.05, 0.2)
    stiffness = np.array([punch((side, side), "spall", offset=(0.2, 0.35)) for side in sides])
    assert_allclose(stiffness, math.pi * UNIT_SQUARE * sides, rtol=4e-3)
    whole = [punch((side, side), "spall", offset=(0.2, 0.35), sharp=False) for side in sides]
    assert np.abs(whole / (math.pi * UNIT_SQUARE * sides) - 1.0).max() > 0.04


def over(fault, cell=CELL, approach=4 * UM, sharp=True, hardness=None, **more):
    """Contact of a ball with a fault below it."""
    n = 2 * round(0.33 * MM / cell) + 1
    x = (np.arange(n) - n // 2) * cell
    ball = np.add.outer(x**2, x**2) / (2 * RADIUS)
    places = x[:, None] - OFF[0], x[None, :] - OFF[1]
    heights, edges = fault.heights(*places), None
    if sharp:
        distance, normal = fault.outline(*places)
        edges = Edges(distance, normal, np.zeros((n, n)), (cell, cell))
        parts = (np.arange(6) + 0.5) / 6 - 0.5
        depth = -np.mean(
            [fault.heights(places[0] + i * cell, places[1] + j * cell) for i in parts for j in parts], axis=0
        )
        edges = Edges(distance, normal, np.where(edges.crossed, depth, 0.0), (cell, cell))
        heights = np.where(edges.sound, 0.0, heights)
    space = HalfSpace((n, n), cell, MODULUS, hardness)
    return space.solve(ball - heights, approach=approach, edges=edges, **more)


SIZES = np.arange(0.30, 0.405, 0.01) * MM


@pytest.mark.parametrize("shape", ["pit", "spall"])
def test_the_force_over_a_pit_falls_evenly_with_its_size(shape):
    faults = [Fault(shape, length=size, depth=0.28 * MM) for size in SIZES]
    forces = np.array([over(fault).force for fault in faults])
    fall = -np.diff(forces)
    smooth = np.polyval(np.polyfit(SIZES[1:], fall, 2), SIZES[1:])
    assert np.abs(fall / smooth - 1.0).max() < 0.25
    finer = [over(faults[i], CELL / 4).force for i in (3, 7)]
    assert_allclose(forces[[3, 7]], finer, rtol=6e-3)
    whole = np.array([over(fault, sharp=False).force for fault in faults])
    assert np.abs(-np.diff(whole) / smooth - 1.0).max() > 0.45


@pytest.mark.parametrize("depth", [0.3 * UM, 1 * UM, 2 * UM])
def test_a_shallow_spall_is_stepped_on(depth):
    """What lies deeper carries, too: all of it in the limit, where heights are means over cells."""
    spall = Fault("spall", length=0.34 * MM, depth=depth)
    assert over(spall).force == pytest.approx(over(spall, CELL / 4).force, rel=5e-3)


GENTLE = [(2, 30), (3, 40), (5, 60), (5, 100), (10, 150)]
"""Depths and lengths of slopes, µm, that carry as far as they are pressed."""


@pytest.mark.parametrize("shape", ["pit", "spall"])
def test_slopes_that_carry_are_less_of_an_edge(shape):
    """Cells that sank by the pressure alone up to their depth were up to 2.1 % off."""
    for depth, edge in GENTLE:
        for size in (0.30 * MM, 0.34 * MM, 0.38 * MM, 0.40 * MM):
            fault = Fault(shape, length=size, depth=depth * UM, edge=edge * UM)
            assert over(fault).force == pytest.approx(over(fault, CELL / 4).force, rel=0.01)


def test_where_surfaces_flow_forces_are_those_of_finer_cells():
    """Cells whose sound part flowed all at once were up to 2.8 % off."""
    shapes = ((0.28 * MM, 0.0), (5 * UM, 0.0), (2 * UM, 0.0), (50 * UM, 60 * UM), (5 * UM, 100 * UM))
    for shape in ("pit", "spall"):
        contacts = ((0.31 * MM, 2.2e9), (0.36 * MM, 2e9), (0.40 * MM, 2.2e9))
        for (size, hardness), (depth, edge) in itertools.product(contacts, shapes):
            fault = Fault(shape, length=size, depth=depth, edge=edge)
            coarse, fine = (over(fault, cell, hardness=hardness) for cell in (CELL, CELL / 4))
            assert coarse.converged
            assert coarse.pressure.max() <= hardness
            assert coarse.force == pytest.approx(fine.force, rel=0.011)


def test_cells_come_to_flow_as_the_length_that_flows_before_an_edge_grows():
    """Dugdale's closed form, in plane strain: q of the hardness where the softness alone asks for 4s/π."""
    edges = Edges(np.zeros((1, 5)), np.zeros((1, 5)), np.ones((1, 5)), (CELL, CELL))
    soft, elastic = (softness_at(edges, MODULUS, hardness) for hardness in (2e9, None))
    assert_allclose(soft.flow, 1e9, rtol=1e-3)
    width = CELL / MODULUS
    for s in (0.3, 0.6, 0.8, 0.9, 1.0):
        q = 2.0 / math.pi * (math.asin(s) + s * math.sqrt(1.0 - s * s))
        pressure = np.full((1, 5), q * 1e9)
        more = (soft.sunk(pressure) - elastic.sunk(pressure))[0, 2] / 1e9
        closed = (4.0 / math.pi * s - q) * elastic.softness[0, 2]
        assert closed < more < closed + 0.5 * width
        assert more == pytest.approx(closed + 0.468 * s**3.7 * width, rel=0, abs=0.06 * width)
    assert (soft.sunk(1.01 * pressure) > 1.15 * soft.sunk(pressure)).all()


def test_contacts_that_flow_over_steps_and_slopes_settle():
    """With cells that stopped at once at their depth one in thirty did not."""
    for shape, depth, edge in (("pit", 1, 0), ("spall", 2, 30), ("spall", 5, 60), ("pit", 10, 150)):
        for size in SIZES:
            fault = Fault(shape, length=size, depth=depth * UM, edge=edge * UM)
            contact = over(fault, hardness=2e9)
            assert contact.converged
            assert contact.iterations < 30


def test_the_tangent_is_the_central_difference():
    pit, step = Fault("pit", length=0.33 * MM, depth=1 * UM), 1e-5 * UM
    contact = over(pit, rtol=1e-12)
    plus, minus = (over(pit, approach=4 * UM + s, rtol=1e-12, start=contact.pressure) for s in (step, -step))
    assert contact.stiffness == pytest.approx((plus.force - minus.force) / (2 * step), rel=1e-5)


def test_a_load_finds_the_approach_and_the_gap_is_closed_where_pressure_acts():
    given = over(Fault("spall", length=0.33 * MM, depth=0.28 * MM), rtol=1e-9)
    found = given.half_space.solve(given.undeformed_gap, load=given.force, rtol=1e-9, edges=given.edges)
    assert found.approach == pytest.approx(given.approach, rel=1e-7)
    assert np.abs(found.gap[found.pressure > 0.0]).max() < 1e-7 * UM + 1e-8 * given.approach


def test_a_scan_is_what_its_contacts_are_one_by_one():
    (n, m), lines = (61, 25), 25
    pits = (
        Fault("pit", angle=math.pi, length=0.2 * MM, depth=0.1 * MM),
        Fault("spall", angle=math.pi, length=0.14 * MM, depth=1 * UM, offset=0.2 * MM),
    )
    surface, edges = lay(pits, (n, lines), (CELL, CELL))
    x, y = (np.arange(k) - k // 2 for k in (m, lines))
    body = np.add.outer(x**2, y**2) * CELL**2 / (2 * RADIUS)
    space = HalfSpace((m, lines), CELL, MODULUS)
    given = space, Rows(surface), body, [3 * UM, 4 * UM], 6, 1e-8
    job = ScanJob(*given, edges=edges)
    forces = scan_forces(job).forces
    for at in range(job.positions):
        here = slice(6 * at, 6 * at + m)
        under = edges.rearranged(lambda field, here=here: field[here])
        alone = space.solve(body - surface[here], approach=4 * UM, rtol=1e-8, edges=under).force
        assert forces[1, at] == pytest.approx(alone, rel=1e-6)
    without = scan_forces(ScanJob(*given)).forces
    assert np.abs(without / forces - 1.0).max() > 0.01
    assert job.key(*job.under(0)) != ScanJob(*given).key(*job.under(0)[:2])
    labelled = space.scan(surface - surface.mean(), body, [3 * UM], 6, edges=edges)
    assert labelled.shape == (1, job.positions)


def test_cells_far_from_edges_are_as_they_were():
    sound = np.full((20, 20), FAR)
    edges = Edges(sound, 0.0 * sound, 0.0 * sound, (1.0, 1.0))
    gap = np.add.outer((np.arange(20) - 9.3) ** 2, (np.arange(20) - 9.7) ** 2) / 100
    one, other = (
        HalfSpace((20, 20), 1.0, 1.0).solve(gap, approach=0.4, edges=each) for each in (None, edges)
    )
    assert_array_equal(one.pressure, other.pressure)


def test_softness_only_adds_and_falls_as_a_cell_becomes_sound():
    """So the matrix stays positive definite, and the energy convex."""
    place, normal = np.meshgrid(np.linspace(-0.69, 0.499, 120), [1.0, 0.999, 0.9, 0.7], indexing="ij")
    width = normal + np.sqrt(1.0 - normal**2)
    soft = softness_at(Edges(place * width, normal, 1.0 + 0.0 * place, (1.0, 1.0)), 1.0, None).softness
    assert soft.min() >= 0.0
    assert (np.diff(soft / width, axis=0) < 0.06).all()


def test_cells_sink_no_deeper_than_the_step_and_steps_of_two_surfaces_add_up():
    distance, normal = np.zeros((3, 3)), np.ones((3, 3))
    one, other = (Edges(distance, normal, np.full((3, 3), depth), (CELL, CELL)) for depth in (UM, 2 * UM))
    both = one.with_others(other)
    assert_allclose(both.drop, 3 * UM)
    soft = softness_at(both, 115e9, None)
    pressures = np.geomspace(1e8, 1e12, 40)[:, None]
    sunk = soft.sunk(pressures[:, :, None])[:, 0, 0]
    alone = soft.softness[0, 0] * pressures[:, 0]
    assert (np.diff(sunk) >= 0.0).all()
    assert (sunk <= np.minimum(alone, 3 * UM)).all()
    assert_allclose(sunk[:10], alone[:10], rtol=1e-3)
    assert_allclose(sunk[-1], 3 * UM, rtol=1e-6)


def test_compliance_is_the_derivative_of_what_cells_sink_by():
    place = np.linspace(-0.69, 0.29, 50)[:, None]
    edges = Edges(place * CELL, 0.0 * place, 1 * UM + 0.0 * place, (CELL, CELL))
    for hardness in (None, 3e9):
        soft = softness_at(edges, MODULUS, hardness)
        for pressure in (0.5e9, 2.2e9):
            rise = soft.sunk(pressure * (1.0 + 1e-6) + 0.0 * place) - soft.sunk(pressure + 0.0 * place)
            assert_allclose(soft.compliance(pressure + 0.0 * place), rise / (1e-6 * pressure), rtol=1e-3)


def test_shares_are_those_of_straight_edges():
    distance, normal = np.array([[0.0, 0.3, -0.3, 0.6]]), np.array([[0.6, 1.0, 0.6, 1.0]])
    shares = Edges(distance, normal, 0.0 * distance, (1.0, 2.0)).shares
    fine = (np.arange(400) + 0.5) / 400 - 0.5
    for k in range(4):
        across = math.sqrt(1.0 - normal[0, k] ** 2)
        before = distance[0, k] + np.add.outer(normal[0, k] * fine, across * 2.0 * fine) > 0.0
        assert shares[0, k] == pytest.approx(before.mean(), abs=4e-3)


def test_the_area_is_that_of_the_ground_that_carries():
    """Of a round punch π a², which whole cells miss by steps."""
    shape = (15, 15)
    x, y = np.meshgrid(np.arange(15) - 7.2, np.arange(15) - 6.9, indexing="ij")
    distance, normal = Fault("pit", length=9.7, width=9.7, depth=1.0, offset=0.0).outline(x, y)
    edges = Edges(-distance, normal, np.ones(shape), (1.0, 1.0))
    contact = HalfSpace(shape, 1.0, 1.0).solve(np.where(edges.sound, 0.0, 9.0), load=1e-3, edges=edges)
    assert contact.area == pytest.approx(math.pi * 4.85**2, rel=5e-3)


def on(shape=(9, 9), spacing=(1.0, 1.0), **more):
    """A contact with edges on nine cells each way."""
    edges = Edges(np.full((9, 9), FAR), np.zeros((9, 9)), np.zeros((9, 9)), (1.0, 1.0))
    return lambda: HalfSpace(shape, spacing, 1.0, **more).solve(np.zeros(shape), load=1.0, edges=edges)


test_what_is_refused = refusals(
    (on(shape=(9, 8)), r"edges of a contact: received shape \(9, 9\); .* shape \(9, 8\)"),
    (on(spacing=(1e-3, 2e-3)), "received cells of 1·10⁶ × 1·10⁶ µm; allowed: cells of 1000 × 2000 µm"),
    (on(cells="covered"), "cells of a contact with edges: received 'covered'; .* 'whole'"),
    (on(boundary="periodic"), "boundary of a contact with edges: received 'periodic'; .* 'free'"),
    (
        lambda: Edges(np.ones((3, 3)), np.full((3, 3), 2.0), np.ones((3, 3)), (1.0, 1.0)),
        "normal of edges: .*0 to 1",
    ),
)


def flowing_at(place, drop, hardness=2e9, deeper=None):
    """How a cell at a place by a straight edge gives way: of a drop, m, or those after it of another one."""
    places = place - np.arange(5.0)[:, None] + 2.0
    drops = np.where(np.abs(places) < 0.5, drop, np.where(places < 0.0, deeper or drop, 0.0))
    edges = Edges(places * CELL, np.ones((5, 1)), drops, (CELL, CELL))
    soft = softness_at(edges, MODULUS, hardness)
    return [field[2, 0] for field in soft]


def test_slopes_flow_later_than_steps_and_sink_as_far_as_they_carry():
    *_, deep, _, step_yields = flowing_at(0.0, 100 * UM)
    assert deep == pytest.approx(0.5 * 2e9, rel=1e-3)
    flows, yields = np.transpose([flowing_at(0.0, each * UM)[3::2] for each in (2.0, 1.0, 0.5, 0.2)])
    assert (np.diff([deep, *flows]) > 0.0).all()
    assert (np.diff([1.001 * step_yields, *yields]) < 0.0).all()
    carried = 2e9 * 0.5**2 / (2 * 0.2 * UM)  # of a slope, by which p rises with what it sinks
    assert yields[-1] == pytest.approx(1.0 / carried, rel=1e-6)


def test_whole_cells_beside_deep_edges_flow_bit_by_bit_and_others_at_once():
    """In plane strain it is by up to 0.2 to 0.36 widths as the border of the flow leaves such a cell."""
    width = CELL / MODULUS
    crossed, *more = (flowing_at(place, 100 * UM)[4] / (2e9 * width) for place in (0.3, 0.7, 1.4, 1.9))
    assert all(0.1 < each < 0.36 < crossed for each in more)
    assert flowing_at(1.4, 0.01 * UM)[4] < 0.03 * 2e9 * width
    assert flowing_at(2.6, 100 * UM)[0] == 0.0


def test_cells_that_are_nearly_whole_sink_as_deep_as_those_beside_them():
    for place, expected in ((0.39, 3 * UM), (0.45, 50 * UM)):
        assert flowing_at(place, 3 * UM, deeper=50 * UM)[1] == pytest.approx(expected)
