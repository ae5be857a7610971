"""A contact is solved from any start, for any gap, under any cap, at an approach or under a load."""

from statistics import median

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import lsq_linear

from asperity import HalfSpace
from asperity.contact import Hertz
from asperity.contact.in_place import ContactInPlace
from asperity.kernels import projected_cg as cg
from asperity.kernels.box import empty_box
from asperity.kernels.contact import room
from asperity.kernels.influence import convolution
from asperity.kernels.options import LOOP, compiled
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
@given(contacts())
def test_approach_against_an_active_set_method(contact):
    half_space, gap, approach, peak, start = contact
    found = half_space.solve(gap, approach=approach, start=start, rtol=1e-8)
    assert found.converged
    expected = dense(half_space, approach - gap, peak)
    assert found.force == pytest.approx(expected.sum() * half_space.cell_area, rel=1e-5)
    assert found.pressure.max() <= half_space.pressure_cap


@settings(max_examples=150)
@given(contacts(), st.floats(0.02, 0.99))
def test_load_against_an_active_set_method(contact, share):
    half_space, gap, approach, peak, start = contact
    load = share * half_space.solve(gap, approach=approach, rtol=1e-8).force
    found = half_space.solve(gap, load=load, start=start, rtol=1e-8)
    assert found.converged
    assert found.force == pytest.approx(load, rel=1e-12)
    assert found.approach <= approach * (1 + 1e-9) + 1e-18
    expected = dense(half_space, found.approach - gap, peak)
    assert expected.sum() * half_space.cell_area == pytest.approx(load, rel=1e-5)


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


@settings(max_examples=25)
@given(st.integers(0, 10_000), st.floats(-2.0, 2.0), st.booleans(), st.sampled_from(["none", "full", "any"]))
def test_rough_contacts_of_many_asperities(seed, cap, under_load, start):
    """Complementarity on a grid too large for the dense method, from bad starts."""
    rng = np.random.default_rng(seed)
    n, spacing = 60, 1.5e-6
    surface = self_affine(
        (n, n), (spacing, spacing), rms=10 ** rng.uniform(-8, -5), hurst=rng.uniform(0.2, 1.0),
        longest=n * spacing, shortest=rng.uniform(2.2, 8.0) * spacing, seed=seed,
    )  # fmt: skip
    gap = surface.heights.max() - surface.heights
    approach = np.quantile(gap, rng.uniform(0.05, 0.9))
    elastic = HalfSpace((n, n), (spacing, spacing), MODULUS).solve(gap, approach=approach)
    half_space = HalfSpace((n, n), (spacing, spacing), MODULUS, elastic.pressure.max() * 10**cap)
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


class TestSheet:
    """A rolled sheet under a ball, where most of the contact flows at the hardness."""

    SPACING = 1.5625e-6

    def problem(self, hardness, measured, index=0):
        heights = levelled(sheet(index, measured=measured))
        x = (np.arange(256) - 127.5) * self.SPACING
        gap = (x[:, None] ** 2 + x**2) / 0.02 - heights
        return HalfSpace((256, 256), (self.SPACING,) * 2, 57.69e9, hardness), gap

    @either
    @pytest.mark.parametrize("hardness", [1e9, 2e9, 3e9])
    def test_start_from_a_neighbouring_approach(self, hardness, measured):
        half_space, gap = self.problem(hardness, measured)
        near = half_space.solve(gap, approach=0.0)
        cold, warm = (half_space.solve(gap, approach=0.25e-6, start=s) for s in (None, near.pressure))
        assert cold.converged
        assert warm.converged
        assert warm.force == pytest.approx(cold.force, rel=1e-5)
        assert warm.iterations < 60

    @pytest.mark.parametrize("load", [20.0, 100.0])
    @pytest.mark.parametrize("index", range(3))
    @either
    def test_load(self, measured, index, load):
        half_space, gap = self.problem(2e9, measured, index)
        contact = half_space.solve(gap, load=load)
        assert contact.converged
        assert contact.force == pytest.approx(load, rel=1e-12)
        again = half_space.solve(gap, approach=contact.approach)
        assert again.force == pytest.approx(load, rel=1e-5)


class TestCostOfALoad:
    """A load is a condition of the iteration, not an iteration around it."""

    LOAD = 30.0
    HERTZ = Hertz(115e9, 25e-3, 25e-3)

    def gap(self, n, rms):
        delta = self.HERTZ.approach(self.LOAD)
        half_width = 1.5 * self.HERTZ.semi_axes(delta)[0]
        spacing = 2 * half_width / n
        x = (np.arange(n) - (n - 1) / 2) * spacing
        heights = np.zeros((n, n))
        if rms:
            waves = {"longest": half_width, "shortest": 4 * spacing}
            heights = self_affine((n, n), (spacing,) * 2, rms=rms, hurst=0.8, seed=3, **waves).heights
        return (x[:, None] ** 2 + x**2) / 50e-3 - heights, spacing

    @pytest.mark.parametrize("rtol", [1e-6, 1e-8])
    def test_against_the_same_contact_at_its_approach(self, rtol):
        ratios = []
        peak = self.HERTZ.peak_pressure(self.HERTZ.approach(self.LOAD))
        for n in (64, 128):
            for rms in (0.0, 0.05e-6, 0.2e-6, 0.6e-6):
                gap, spacing = self.gap(n, rms)
                for hardness in (None, 0.5 * peak, 1.5 * peak, 4 * peak):
                    half_space = HalfSpace((n, n), (spacing, spacing), 115e9, hardness)
                    by_load = half_space.solve(gap, load=self.LOAD, rtol=rtol)
                    by_approach = half_space.solve(gap, approach=by_load.approach, rtol=rtol)
                    assert by_load.converged
                    assert by_approach.force == pytest.approx(self.LOAD, rel=10 * rtol)
                    ratios.append(by_load.iterations / by_approach.iterations)
        assert median(ratios) <= 1.0
        assert max(ratios) <= 1.5

    def test_an_estimate_that_is_too_low_is_put_right(self, monkeypatch):
        gap, spacing = self.gap(64, 0.2e-6)
        half_space = HalfSpace((64, 64), (spacing, spacing), 115e9)
        expected = half_space.solve(gap, load=self.LOAD, rtol=1e-9)
        calls = []

        def low(gap, *rest):
            calls.append(rest)
            return gap.min() + 0.3 * (expected.approach - gap.min())

        monkeypatch.setattr("asperity.contact.halfspace.foundation_approach", low)
        found = half_space.solve(gap, load=self.LOAD, rtol=1e-9)
        assert calls
        assert found.approach == pytest.approx(expected.approach, rel=1e-8)
        np.testing.assert_allclose(found.pressure, expected.pressure, atol=1e-6 * expected.pressure.max())


@compiled(**LOOP)
def energies(known, overlap, room, task, done, found):
    """Energy ½ p·K p − p·overlap after each of some iterations that are counted from `done`."""
    nx, ny = overlap.shape
    c, b = convolution(known, nx, ny), empty_box(nx, ny, room)
    for i in range(nx):
        for j in range(ny):
            b.overlap[i * b.pitch + j] = overlap[i, j]
    cg.true_residual(c, b, task.compliance)
    for step in range(done, done + len(found)):
        once = cg.Task(
            task.hardness, task.total, task.compliance, task.largest, task.rtol, task.softest, step + 1
        )
        cg.solve(c, known.taps, b, once, step)
        found[step - done] = 0.0
        for q in range(len(b.pressure)):
            found[step - done] += 0.5 * b.pressure[q] * (b.residual[q] - b.overlap[q])


@pytest.mark.parametrize("yielding", [0.0, 3.0])
@pytest.mark.parametrize("done", [0, cg.PATIENCE])
def test_no_iteration_raises_the_energy(done, yielding):
    """Neither those of conjugate gradients nor the steps of the projected gradient among them.

    Nor where bodies yield to the force by so many times what one cell yields to its pressure.
    """
    n, hardness = 40, 2e9
    overlap = 1e-7 * np.random.default_rng(5).standard_normal((n, n))
    half_space = HalfSpace((n, n), (1e-6, 1e-6), MODULUS, hardness)
    compliance = yielding * half_space.influence.table[0, 0]
    contact = ContactInPlace(half_space, -overlap, 1e-9)
    contact.solve(np.zeros((n, n)), 0.0, compliance / half_space.cell_area)
    p, known = contact.pressure, half_space.influence
    least = 0.5 * (np.vdot(p, half_space.displacement(p)) + compliance * p.sum() ** 2) - np.vdot(p, overlap)
    found = np.empty(200)
    softest = known.softest + compliance * n**2
    task = cg.Task(hardness, -1.0, compliance, overlap.max(), 1e-12, softest, 0)
    energies(known, overlap, room(known, n, n).outer, task, done, found)
    assert np.all(np.diff(found) <= 1e-13 * abs(least))
    assert found[-1] == pytest.approx(least, rel=1e-6)


def test_a_tolerance_beyond_rounding_is_reported():
    n = 48
    x = (np.arange(n) - n / 2) * 1e-5
    half_space = HalfSpace((n, n), (1e-5, 1e-5), MODULUS)
    with pytest.warns(UserWarning, match="rounding allows no better solution; try a larger rtol"):
        contact = half_space.solve((x[:, None] ** 2 + x**2) / 0.05, approach=1e-6, rtol=1e-17)
    assert not contact.converged
    assert contact.residual < 1e-12
    assert contact.iterations < 500
