"""A contact is solved from any start, for any gap, under any cap, at an approach or under a load."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import lsq_linear

from asperity import HalfSpace
from asperity.kernels.scanning import continue_rolling
from asperity.laws import Direct
from asperity.surfaces.synthesis import self_affine
from like_measured import either, sheet

MODULUS = 1e11


def matrix(half_space):
    """The influence of every cell on every other one, m/Pa."""
    n = half_space.shape[0] * half_space.shape[1]
    return np.array([half_space.displacement(e.reshape(half_space.shape)).ravel() for e in np.eye(n)])


def dense(half_space, overlap, scale):
    """The pressure by an active-set method on the dense matrix: a least-squares problem within bounds.

    ½ pᵀ K p − overlapᵀ p, with K = L Lᵀ, is half the square of Lᵀ p − L⁻¹ overlap, but for a constant.
    """
    root = np.linalg.cholesky(matrix(half_space))
    right = np.linalg.solve(root, overlap.ravel())
    bounds = (0.0, half_space.pressure_cap / scale)
    found = lsq_linear(root.T * scale, right, bounds, method="bvls", tol=1e-14, max_iter=2000)
    return found.x.reshape(overlap.shape) * scale


@st.composite
def contacts(draw):
    """A rough gap on a few cells, a cap of 0.01 to 100 elastic peaks or none, and a start."""
    shape = (draw(st.integers(1, 10)), draw(st.integers(1, 10)))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    spacing = (1e-6, 1e-6 * draw(st.sampled_from([1.0, 0.3, 4.0])))
    x, y = (np.arange(n) - n / 2 for n in shape)
    gap = (x[:, None] ** 2 + y**2) * draw(st.sampled_from([0.0, 1e-10, 1e-8]))
    gap += 10.0 ** draw(st.floats(-12.0, -6.0)) * rng.standard_normal(shape)
    gap = np.round(gap, draw(st.sampled_from([7, 9, 15])))  # measured heights are whole steps
    depth = (np.ptp(gap) + 1e-12) * 10.0 ** draw(st.floats(-3.0, 2.0))
    elastic = HalfSpace(shape, spacing, MODULUS)
    peak = elastic.solve(gap, approach=gap.min() + depth, rtol=1e-8).pressure.max()
    share = draw(st.one_of(st.none(), st.floats(-2.0, 2.0)))
    hardness = None if share is None else peak * 10.0**share
    largest = 10.0 * peak if hardness is None else hardness
    start = {
        "none": None,
        "zero": np.zeros(shape),
        "full": np.full(shape, largest),
        "any": rng.random(shape) * largest,
        "one cell": np.eye(1, gap.size, rng.integers(gap.size)).reshape(shape) * largest,
        "next to nothing": np.full(shape, 1e-300),
        "near": elastic.solve(gap, approach=gap.min() + 0.9 * depth).pressure,
    }[draw(st.sampled_from(["none", "zero", "full", "any", "one cell", "next to nothing", "near"]))]
    return HalfSpace(shape, spacing, MODULUS, hardness), gap, gap.min() + depth, peak, start


@settings(max_examples=150)
@given(contacts(), st.floats(0.02, 0.99))
def test_against_an_active_set_method(contact, share):
    """At an approach, and under a share of the load that it takes there."""
    half_space, gap, approach, peak, start = contact
    at_approach = half_space.solve(gap, approach=approach, start=start, rtol=1e-8)
    load = share * at_approach.force
    at_load = half_space.solve(gap, load=load, start=start, rtol=1e-8)
    assert at_load.force == pytest.approx(load, rel=1e-12, abs=0.0)
    assert at_load.approach <= approach + 1e-9 * abs(approach) + 1e-18
    for found in (at_approach, at_load):
        assert found.converged
        assert found.pressure.max() <= half_space.pressure_cap
        expected = dense(half_space, found.approach - gap, peak)
        assert found.force == pytest.approx(expected.sum() * half_space.cell_area, rel=1e-5, abs=0.0)


@pytest.mark.parametrize("hardness", np.linspace(1.84e9, 2.6e9, 20))
def test_a_load_that_leaves_every_cell_at_a_bound(hardness):
    """Five of ten cells yield and five carry nothing: no cell tells the approach, rounding must not."""
    x = np.arange(10) - 5.0
    gap = 1e-8 * x[:, None] ** 2 + 2.5e-9
    half_space = HalfSpace((10, 1), (1e-6, 1e-6), 1e11, hardness)
    load, half = 5 * hardness * half_space.cell_area, np.full((10, 1), 0.5 * hardness)
    found = half_space.solve(gap, load=load, start=half)
    assert found.converged
    np.testing.assert_array_equal(np.sort(found.pressure.ravel()), [0.0] * 5 + [hardness] * 5)
    lack = found.approach - gap - half_space.displacement(found.pressure)
    assert lack[found.pressure > 0.0].min() >= 0.0 >= lack[found.pressure == 0.0].max()


def rough(n, spacing, seed, rms, **waves):
    waves = {"hurst": 0.7, "longest": n * spacing, "shortest": 4.0 * spacing} | waves
    return self_affine((n, n), (spacing, spacing), rms=rms, seed=seed, **waves).heights


@settings(max_examples=25)
@given(st.integers(0, 10_000), st.floats(-2.0, 2.0), st.booleans(), st.sampled_from(["none", "full", "any"]))
def test_rough_contacts_of_many_asperities(seed, cap, under_load, start):
    """Complementarity on a grid too large for the dense method, from bad starts."""
    rng = np.random.default_rng(seed)
    n, spacing = 60, 1.5e-6
    waves = {"hurst": rng.uniform(0.2, 1.0), "shortest": rng.uniform(2.2, 8.0) * spacing}
    heights = rough(n, spacing, seed, 10 ** rng.uniform(-8, -5), **waves)
    gap = heights.max() - heights
    approach = np.quantile(gap, rng.uniform(0.05, 0.9))
    elastic = HalfSpace((n, n), spacing, MODULUS).solve(gap, approach=approach)
    half_space = HalfSpace((n, n), spacing, MODULUS, elastic.pressure.max() * 10**cap)
    full, random = np.full((n, n), half_space.hardness), rng.random((n, n)) * 1e12
    first = {"none": None, "full": full, "any": random}[start]
    given_ = {"approach": approach}
    if under_load:
        given_ = {"load": 0.7 * half_space.solve(gap, approach=approach).force}
    found = half_space.solve(gap, **given_, start=first, rtol=1e-7)
    assert found.converged
    between = (found.pressure > 0) & (found.pressure < half_space.hardness)
    tolerance = 1.001e-7 * (found.approach - gap.min())
    assert found.gap[found.pressure == 0].min() >= -tolerance
    assert np.abs(found.gap[between]).max(initial=0.0) <= tolerance
    assert found.gap[found.pressure == half_space.hardness].max(initial=-1.0) <= tolerance


def levelled(heights):
    x, y = (a.ravel() for a in np.indices(heights.shape))
    plane = np.column_stack([np.ones(heights.size), x, y])
    return heights - (plane @ np.linalg.lstsq(plane, heights.ravel(), rcond=None)[0]).reshape(heights.shape)


@either
@pytest.mark.parametrize(("index", "hardness"), [(0, 1e9), (1, 2e9), (2, 3e9)])
def test_a_rolled_sheet_most_of_whose_contact_flows(measured, index, hardness):
    """From a neighbouring approach it takes few iterations, and a load leads to the same contact."""
    spacing = 1.5625e-6
    x = (np.arange(256) - 127.5) * spacing
    gap = np.add.outer(x**2, x**2) / 0.02 - levelled(sheet(index, measured=measured))
    half_space = HalfSpace((256, 256), spacing, 57.69e9, hardness)
    near = half_space.solve(gap, approach=0.0)
    cold, warm = (half_space.solve(gap, approach=0.25e-6, start=s) for s in (None, near.pressure))
    assert warm.force == pytest.approx(cold.force, rel=1e-5)
    assert warm.iterations < 60
    by_load = half_space.solve(gap, load=cold.force)
    assert all(each.converged for each in (cold, warm, by_load))
    assert by_load.approach == pytest.approx(cold.approach, rel=1e-4)


@pytest.mark.parametrize("hardness", [None, 0.5e9, 4e9])
@pytest.mark.parametrize("rms", [0.0, 0.05e-6, 0.6e-6])
def test_a_load_costs_no_more_than_the_approach_that_it_leads_to(monkeypatch, rms, hardness):
    """It is a condition of the iteration, not an iteration around it; a low estimate is put right."""
    n, spacing, load = 96, 6e-6, 30.0
    x = (np.arange(n) - (n - 1) / 2) * spacing
    heights = rough(n, spacing, 3, rms, longest=0.3e-3) if rms else 0.0
    gap, half_space = np.add.outer(x**2, x**2) / 50e-3 - heights, HalfSpace((n, n), spacing, 115e9, hardness)
    by_load = half_space.solve(gap, load=load, rtol=1e-8)
    by_approach = half_space.solve(gap, approach=by_load.approach, rtol=1e-8)
    assert by_approach.force == pytest.approx(load, rel=1e-7)
    assert by_load.iterations <= 1.5 * by_approach.iterations
    low = gap.min() + 0.3 * (by_load.approach - gap.min())
    monkeypatch.setattr("asperity.contact.pressed.foundation_approach", lambda *_: low)
    again = half_space.solve(gap, load=load, rtol=1e-8)
    assert again.iterations > by_load.iterations
    np.testing.assert_allclose(again.pressure, by_load.pressure, atol=1e-5 * by_load.pressure.max())


@pytest.mark.parametrize("yielding", [0.0, 3.0])
def test_no_iteration_raises_the_energy(yielding):
    """Neither those of conjugate gradients nor, after a hundred, steps of the projected gradient.

    Nor where bodies yield to the force by so many times what one cell yields to its pressure.
    """
    n, spacing = 60, (1e-6, 1e-4)  # slender cells, which take many iterations
    overlap = 1e-5 + 1e-7 * np.random.default_rng(5).standard_normal((n, n))
    law = Direct(np.zeros((n + 1, n)), -overlap, spacing, MODULUS, 0.0, hardness=1e10, rtol=1e-12)
    energies = []
    for most in range(1, 141):
        contact = law.prepare([n // 2 * spacing[0]])
        contact.block = contact.block._replace(max_iterations=most)
        compliance = yielding * contact.half_space.influence.table[0, 0]
        contact.settle(0, 0.0, compliance / contact.half_space.cell_area)
        p = contact.pressure
        stored = np.vdot(p, contact.half_space.displacement(p)) + compliance * p.sum() ** 2
        energies.append(0.5 * stored - np.vdot(p, overlap))
    assert contact.counts[1] > 120
    assert np.all(np.diff(energies) <= 1e-13 * abs(energies[-1]))


# --- bodies that yield, and starts: one contact after the other on a grid

DX, N, RTOL = 5e-6, 41, 1e-7
X = (np.arange(N) - N // 2) * DX
BALL = np.add.outer(X**2, X**2) / 20e-3


@pytest.mark.parametrize("hardness", [None, 1.5e9])
@pytest.mark.parametrize("rms", [0.0, 0.3e-6])
@pytest.mark.parametrize("yielding", [1e-3, 1.0, 30.0])
def test_what_the_bodies_yield_and_the_contact_agree(yielding, rms, hardness):
    """Pressure within its bounds, no overlap but at the hardness, no gap under pressure: at δ − C F."""
    noise = np.random.default_rng(0).standard_normal((N + 20, N))
    smoothed = np.apply_along_axis(np.convolve, 0, noise, np.hanning(7), mode="same")
    space, heights = HalfSpace((N, N), DX, 115e9, hardness), rms * smoothed / smoothed.std()
    rows, free = range(0, 20, 5), 0.6e-6
    law = Direct(heights, BALL, (DX, DX), 115e9, 0.0, hardness, RTOL).prepare((np.array(rows) + N // 2) * DX)
    compliance = yielding / space.solve(BALL - heights[:N], load=3.0).stiffness
    for step, row in enumerate(rows):  # from nothing, and from what was there
        force, p, gap = law.settle(step, free, compliance), law.pressure, BALL - heights[row : row + N]
        assert force == pytest.approx(p.sum() * DX**2, rel=1e-12, abs=0.0)
        open_by, overlap = gap + space.displacement(p) - free + compliance * force, free - compliance * force
        limit = RTOL * (overlap - gap.min())
        assert law.overlap >= (1 - 1e-6) * (overlap - gap.min())
        assert p.min() >= 0.0
        assert p.max() <= space.pressure_cap
        assert open_by[p < space.pressure_cap].min() >= -limit
        assert open_by[p > 0.0].max() <= limit
        law.accept(step)
    assert law.counts[[0, 2]].tolist() == [len(rows), 0]
    assert law.settle(0, -2e-6, compliance) == 0.0
    assert not law.pressure.any()


def test_pressures_follow_the_surface_or_stay_in_the_window():
    """As they did from the one before to the last; on the way they go on straight, within the hardness."""
    asperity, patch, start = np.zeros((3, N, N))
    asperity[20, 20], patch[18:23, 18:23] = 1.0, 1.0
    moved = 1.5 * np.roll(asperity, -2, axis=0)
    continue_rolling(moved, asperity, 2, 2, 2.0, start)
    assert start[16, 20] == start.sum() == 2.0  # 1.5 + 0.5, at the cap
    continue_rolling(moved, asperity, 3, 2, 2.0, start)  # another stride: no line
    assert start[15, 20] == start.sum() == 1.5
    continue_rolling(1.1 * patch, patch, 2, 2, 2.0, start)
    assert np.array_equal(start, 1.1 * patch)
