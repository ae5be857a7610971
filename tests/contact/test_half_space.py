"""The half-space solver: orders of convergence, conservation laws, loads, starts; what callers are told."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from asperity import HalfSpace, HeightMap, Hertz, Profile
from asperity.contact.hertz import in_groove
from asperity.errors import Outcome, UnconvergedWarning
from asperity.surfaces.edges import Edges
from refusals import refusals

MODULUS = 1e11


def rough(seed=0):
    """A rough gap over a ball, and its half-space."""
    shape, spacing = (24, 18), 8e-5
    x, y = ((np.arange(n) - n / 2 + 0.5) * spacing for n in shape)
    gap = np.add.outer(x**2, y**2) / 0.2 - 1e-7 * np.random.default_rng(seed).standard_normal(shape)
    return gap, HalfSpace(shape, spacing, MODULUS)


def test_errors_against_hertz_fall_at_the_expected_order():
    """Pressure ends like a square root at the edge: order 3/2 for integrals, 2 for the smooth centre."""
    hertz, delta, cells = Hertz(1.0, 10.0, 6.0), 0.012, (24, 48, 96, 192)
    errors = np.zeros((len(cells), 2))
    for row, n in zip(errors, cells, strict=True):
        h = 1.4 / n
        x = (np.arange(n) - n / 2 + 0.5) * h
        for offset in np.linspace(0.0, 0.5, 5):  # the error also depends on how the edge cuts the cells
            gap = np.add.outer((x + offset * h) ** 2 / 20.0, (x + 0.7 * offset * h) ** 2 / 12.0)
            contact = HalfSpace((n, n), h, 1.0).solve(gap, approach=delta, rtol=1e-8)
            row[0] += (contact.force / hertz.force(delta) - 1.0) ** 2
            row[1] += (contact.pressure.max() / hertz.peak_pressure(delta) - 1.0) ** 2
    orders = -np.polyfit(np.log(cells), 0.5 * np.log(errors), 1)[0]
    assert orders[0] > 1.4
    assert orders[1] > 1.5


def test_superposition_and_reciprocity():
    half_space = HalfSpace((12, 17), (1e-5, 2e-5), MODULUS)
    p, q = np.random.default_rng(1).random((2, 12, 17)) * 1e8
    u, v = half_space.displacement(p), half_space.displacement(q)
    np.testing.assert_allclose(half_space.displacement(2 * p - 3 * q), 2 * u - 3 * v, rtol=1e-12)
    assert np.vdot(p, v) == pytest.approx(np.vdot(q, u), rel=1e-13)


def test_the_tangent_is_the_central_difference():
    gap, half_space = rough()
    contact, step = half_space.solve(gap, approach=1e-6, rtol=1e-12), 1e-12
    plus, minus = (half_space.solve(gap, approach=1e-6 + s, rtol=1e-13) for s in (step, -step))
    assert np.array_equal(plus.pressure > 0, minus.pressure > 0)
    assert contact.stiffness == pytest.approx((plus.force - minus.force) / (2 * step), rel=1e-6)


@settings(max_examples=15)
@given(st.integers(0, 10_000), st.floats(1e-3, 1e3), st.floats(1e-3, 1e3))
def test_lengths_and_modulus_scale_the_force(seed, length, modulus):
    gap, half_space = rough(seed=seed)
    one = half_space.solve(gap, approach=1e-6, rtol=1e-9)
    other = HalfSpace(gap.shape, 8e-5 * length, MODULUS * modulus)
    scaled = other.solve(gap * length, approach=1e-6 * length, rtol=1e-9)
    assert scaled.force == pytest.approx(one.force * length**2 * modulus, rel=1e-7, abs=0.0)


@pytest.mark.parametrize("load", [0.0, 1e-9, 1e-3, 1.0, 1e3, 1e6])
def test_any_load_is_met(load):
    gap, half_space = rough()
    contact = half_space.solve(gap, load=load)
    assert contact.force == pytest.approx(load, rel=1e-12)
    assert contact.area == np.count_nonzero(contact.pressure) * half_space.cell_area
    assert contact.converged
    assert load > 0.0 or (contact.approach, contact.outcome) == (gap.min(), Outcome.NO_CONTACT)


def test_a_peak_touches_first():
    """Contact of a rough surface starts at a negative approach of the mean planes."""
    gap = np.zeros((9, 9))
    gap[4, 4] = -2e-6
    half_space = HalfSpace((9, 9), (1e-5, 1e-5), MODULUS)
    assert half_space.solve(gap, approach=-2.1e-6).force == 0.0
    touching = half_space.solve(gap, approach=-1.9e-6)
    assert touching.force > 0.0
    assert np.argwhere(touching.pressure).tolist() == [[4, 4]]


def test_a_start_changes_nothing_but_the_work_and_is_left_as_it_is():
    gap, half_space = rough()
    cold = half_space.solve(gap, approach=1e-6, rtol=1e-10)
    for start, most in ((cold.pressure, 1), (-1e9 * np.ones_like(gap), 1000)):
        given_ = start.copy()
        warm = half_space.solve(gap, approach=1e-6, rtol=1e-10, start=start)
        assert warm.force == pytest.approx(cold.force, rel=1e-9)
        assert warm.iterations <= most
        assert np.array_equal(start, given_)


def test_what_does_not_converge_says_so(monkeypatch):
    gap, half_space = rough()
    contact = half_space.solve(gap, approach=1e-6)
    monkeypatch.setattr("asperity.kernels.batched.FEW", 0)
    for module in ("elastic_grid", "pressed"):
        monkeypatch.setattr(f"asperity.contact.{module}.MAX_ITERATIONS", 2)
    with pytest.warns(UnconvergedWarning, match=r"contact at approach 1·10⁻⁶ m .*iteration limit"):
        found = half_space.solve(gap, approach=1e-6, rtol=1e-9)
    assert (found.converged, found.outcome) == (False, Outcome.ITERATION_LIMIT)
    assert found.residual > 1e-9
    with pytest.warns(UnconvergedWarning, match=r"tangent stiffness .*iteration limit"):
        half_space.tangent_stiffness(contact.pressure)


@pytest.mark.parametrize("cells", ["whole", "edges", "covered"])
def test_few_cells_are_solved_at_once_as_by_iterations(cells, monkeypatch):
    """What no cell says of its own: that it is soft at an edge, or that the gap at a rim falls beside it."""
    gap, _ = rough()
    edges = None
    seen = "covered" if cells == "covered" else "whole"
    half_space = HalfSpace(gap.shape, (8e-5, 5e-5), MODULUS, cells=seen)
    if cells == "edges":
        distance = np.repeat(1e-4 - 8e-5 * np.arange(-12.0, 12.0)[:, None], gap.shape[1], axis=1)
        edges = Edges(distance, np.ones(gap.shape), np.full(gap.shape, 1e-5), half_space.spacing)
    contact = half_space.solve(gap, approach=1e-6, edges=edges)
    found = []
    for few in (0, 1000):
        for module in ("kernels.batched", "contact.elastic_grid"):
            monkeypatch.setattr(f"asperity.{module}.FEW", few)
        found.append(half_space.tangent_stiffness(contact.pressure, edges=edges))
    assert found[1] == pytest.approx(found[0], rel=1e-8)
    assert found[0] > 0.0


def test_a_tolerance_beyond_rounding_is_reported():
    gap, half_space = rough()
    with pytest.warns(UnconvergedWarning, match="rounding allows no better solution; try a larger rtol"):
        contact = half_space.solve(gap, approach=1e-6, rtol=1e-17)
    assert contact.residual < 1e-12
    assert contact.iterations < 500


def test_contact_at_the_edge_is_seen():
    x = np.arange(16) - 7.5
    half_space, gap = HalfSpace((16, 16), 1.0, 1.0), np.add.outer(x**2, x**2)
    assert half_space.solve(gap, approach=-1.0).edge_share == 0.0
    assert half_space.solve(gap, approach=20.0).edge_share == 0.0
    contact = half_space.solve(gap, approach=100.0)
    p = contact.pressure
    inside = p[1:-1, 1:-1].sum() / p.sum()
    assert contact.edge_share == pytest.approx(1.0 - inside)
    assert math.isclose(contact.force, p.sum())


FLAT = np.zeros((4, 4))
ONE_MISSING = np.where(np.eye(4)[1] * np.eye(4)[:, [2]], math.nan, 0.0)
ELASTIC, HARD = HalfSpace((4, 4), 1.0, 1.0), HalfSpace((4, 4), 1.0, 1.0, hardness=2.0)
RADIUS, GROOVE = 6.35e-3, 6.6e-3


def scan(surface=FLAT, body=FLAT, approaches=(0.1,), **keywords):
    ELASTIC.scan(surface, body, approaches, **keywords)


def run_in(surface=FLAT, body=FLAT, load=1.0, half_space=HARD, **keywords):
    half_space.run_in(surface, body, load, **keywords)


def groove(*arguments):
    in_groove(115e9, *arguments)


test_messages = refusals(
    (
        HalfSpace,
        ((8, 8), (1e-5, 1.6e-6), 1e11),
        {"cells": "covered"},
        "spacing of the half-space: received covered cells of 10 um × 1.6 um; allowed: sides up to 1 : 6",
    ),
    (HalfSpace, ((0, 4), 1.0, 1.0), {}, "half-space shape: received 0; allowed: two positive whole"),
    (HalfSpace, ((4, 4), (1.0, -1.0), 1.0), {}, "half-space spacing: received -1.0"),
    (HalfSpace, ((4, 4), 1.0, 0.0), {}, "contact modulus: received 0.0.*Steel on steel has 115e9"),
    (HalfSpace, ((4, 4), 1.0, 1.0, -3.0), {}, "hardness: received -3.0"),
    (ELASTIC.solve, (FLAT,), {}, "approach and load: received neither; allowed: exactly one"),
    (ELASTIC.solve, (FLAT, 1.0, 1.0), {}, "approach and load: received both"),
    (ELASTIC.solve, (FLAT,), {"load": -1.0}, "load: received -1.0; allowed: a force ≥ 0"),
    (ELASTIC.solve, (FLAT, 1.0), {"rtol": 0.0}, "rtol: received 0.0; allowed: a number between 0 and 1"),
    (ELASTIC.solve, (FLAT, 1.0), {"start": np.zeros((2, 2))}, r"start pressure: received shape \(2, 2\)"),
    (ELASTIC.solve, (np.zeros((4, 5)), 1.0), {}, r"gap: .*of the half-space's shape \(4, 4\)"),
    (HARD.solve, (FLAT,), {"load": 33.0}, "33 N; allowed: less than hardness × window area = 32 N"),
    (scan, (FLAT[1:],), {}, "window of the scan: received 4 × 4 cells on a surface of 3 × 4 cells"),
    (scan, (ONE_MISSING,), {}, "the scan: received 1 of 16 points without a height.*Fill missing points"),
    (scan, (FLAT[0],), {}, "surface of the scan: received 4 numbers; allowed: a height map, or an array"),
    (scan, (HeightMap(FLAT, 2.0),), {}, "2 × 2 m apart; allowed: 1 × 1 m apart.*Resample the map"),
    (scan, (Profile(FLAT[0], 1.0),), {}, "surface of the scan: received a line of heights"),
    (scan, (FLAT, FLAT[1:]), {}, r"body of the scan: .*finite array of the half-space's shape \(4, 4\)"),
    (scan, (FLAT, ONE_MISSING), {}, "body of the scan: received nan"),
    (scan, (FLAT, FLAT, [0.2, 0.1]), {}, "approaches of the scan: received numbers that do not rise"),
    (scan, (FLAT, FLAT, []), {}, "approaches of the scan: received none; allowed: finite, increasing"),
    (scan, (), {"stride": 0}, "stride of the scan: received 0"),
    (scan, (), {"force_accuracy": 0.2}, "force_accuracy: received 0.2; allowed: .* at most 0.1"),
    (scan, (), {"force_accuracy": 1e-4, "rtol": 1e-6}, "rtol and force_accuracy: received both"),
    (run_in, (), {"half_space": ELASTIC}, "hardness of the half-space: received None"),
    (run_in, (), {"passes": "often"}, r'passes.*from 1 to 100, or "shakedown"'),
    (run_in, (), {"passes": 101}, "passes: received 101"),
    (run_in, (FLAT, FLAT[1:]), {}, r"body that runs in: received shape \(3, 4\)"),
    (run_in, (), {"stride": 4}, "stride of running-in: received 4; allowed: a whole number from 1 to 3"),
    (Hertz, (1e11, 1.0, math.inf), {}, "Hertz radius_y: received inf"),
    (Hertz, (1e11, 0.0, 1.0), {}, "Hertz radius_x: received 0.0; allowed: a .*positive"),
    (groove, (RADIUS, RADIUS), {}, r"radii of ball and groove \(m\): received 0.00635 and -0.00635"),
    (groove, (RADIUS, 0.9 * RADIUS), {}, "A hollow must be rounder than what lies in it"),
    (groove, (RADIUS, -GROOVE), {}, r"radius of the groove \(m\): received -0.0066"),
    (groove, (RADIUS, GROOVE, -5e-3), {}, "radii of ball and raceway"),
    (groove, (RADIUS, GROOVE, 0.0), {}, "raceway.*received 0.0; allowed: numbers other than 0"),
    of=lambda call, arguments, keywords: call(*arguments, **keywords),
)
