"""The half-space solver against Hertz, Kalker's CONTACT, conservation laws and itself."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from asperity.contact import HalfSpace, Hertz
from asperity.contact.fixed_set import unit_indentation
from asperity.errors import InputError, Outcome, UnconvergedWarning


def grid(n, half_width):
    h = 2 * half_width / n
    return (np.arange(n) - n / 2 + 0.5) * h, h


def paraboloid(n, half_width, radius_x, radius_y):
    x, h = grid(n, half_width)
    return x[:, None] ** 2 / (2 * radius_x) + x[None, :] ** 2 / (2 * radius_y), h


def rough_gap(n=32, seed=0):
    gap, h = paraboloid(n, 1e-3, 0.1, 0.1)
    return gap - 1e-7 * np.random.default_rng(seed).standard_normal((n, n)), h


class TestAgainstHertz:
    # contact radius 0.35 of the half width, as tabulated for codes of this kind
    @pytest.mark.parametrize(
        ("n", "force_error", "peak_error"),
        [(64, 4.3e-4, -1.5e-3), (128, 7.7e-5, -3.6e-4), (256, 3.5e-5, -9.4e-5)],
    )
    def test_sphere_errors_are_those_of_the_discretisation(self, n, force_error, peak_error):
        hertz = Hertz(1.0, 10.0, 10.0)
        delta = 0.35**2 / 10.0
        gap, h = paraboloid(n, 1.0, 10.0, 10.0)
        contact = HalfSpace((n, n), (h, h), 1.0).solve(gap, approach=delta, rtol=1e-9)
        assert contact.force / hertz.force(delta) - 1 == pytest.approx(force_error, rel=0.05)
        assert contact.pressure.max() / hertz.peak_pressure(delta) - 1 == pytest.approx(peak_error, rel=0.05)
        radius = math.sqrt(contact.area / math.pi)
        assert radius == pytest.approx(hertz.semi_axes(delta)[0], abs=0.5 * h)

    def test_errors_fall_at_the_expected_order(self):
        hertz = Hertz(1.0, 10.0, 6.0)
        delta = 0.012
        orders, spacings = {"force": [], "peak": []}, []
        for n in (24, 48, 96, 192):
            # several grid offsets, since the error also depends on how the edge cuts the cells
            force, peak = [], []
            for offset in np.linspace(0.0, 0.5, 5):
                x, h = grid(n, 0.7)
                gap = (x[:, None] + offset * h) ** 2 / 20.0 + (x[None, :] + 0.7 * offset * h) ** 2 / 12.0
                contact = HalfSpace((n, n), (h, h), 1.0).solve(gap, approach=delta, rtol=1e-8)
                force.append(contact.force / hertz.force(delta) - 1)
                peak.append(contact.pressure.max() / hertz.peak_pressure(delta) - 1)
            orders["force"].append(np.sqrt(np.mean(np.square(force))))
            orders["peak"].append(np.sqrt(np.mean(np.square(peak))))
            spacings.append(h)
        # pressure ends like a square root at the edge: order 3/2 for integrals, 2 for the smooth centre
        for name, least in (("force", 1.4), ("peak", 1.5)):
            slope = np.polyfit(np.log(spacings), np.log(orders[name]), 1)[0]
            assert slope > least, (name, slope)

    def test_ellipse(self):
        hertz = Hertz(115e9, 0.46, 0.30)
        load = 65e3
        delta = hertz.approach(load)
        n = 128
        gap, h = paraboloid(n, 8e-3, 0.46, 0.30)
        contact = HalfSpace((n, n), (h, h), 115e9).solve(gap, load=load, rtol=1e-9)
        assert contact.approach == pytest.approx(delta, rel=2e-4)
        assert contact.pressure.max() == pytest.approx(hertz.peak_pressure(delta), rel=1e-3)
        a, b = hertz.semi_axes(delta)
        rows, columns = contact.pressure.any(axis=1).sum() * h / 2, contact.pressure.any(axis=0).sum() * h / 2
        assert (rows, columns) == pytest.approx((a, b), abs=h)
        assert rows > columns

    def test_tangent_stiffness_of_a_sphere(self):
        gap, h = paraboloid(128, 1.0, 10.0, 10.0)
        contact = HalfSpace((128, 128), (h, h), 1.0).solve(gap, approach=0.35**2 / 10, rtol=1e-9)
        assert contact.stiffness == pytest.approx(2 * 1.0 * 0.35, rel=1e-2)


def test_against_contact_by_kalker():
    """Public test bank of CONTACT, case contact_nonhz 1."""
    modulus = 82e9 / (1 - 0.28)
    x = -5.25e-3 + (np.arange(21) + 0.5) * 0.5e-3
    y = -8.647e-3 + (np.arange(33) + 0.5) * 0.5241e-3
    gap = 1.214 * x[:, None] ** 2 + 0.573 * y[None, :] ** 2
    contact = HalfSpace((21, 33), (0.5e-3, 0.5241e-3), modulus).solve(gap, approach=0.05e-3)
    assert contact.force == pytest.approx(42.08e3, rel=2e-4)
    assert contact.pressure.max() == pytest.approx(675.4e6, rel=2e-4)
    assert np.count_nonzero(contact.pressure) == 363


class TestConservation:
    def test_superposition_and_reciprocity(self):
        half_space = HalfSpace((12, 17), (1e-5, 2e-5), 1e11)
        rng = np.random.default_rng(1)
        p, q = rng.random((2, 12, 17)) * 1e8
        u, v = half_space.displacement(p), half_space.displacement(q)
        np.testing.assert_allclose(half_space.displacement(2 * p - 3 * q), 2 * u - 3 * v, rtol=1e-12)
        assert np.vdot(p, v) == pytest.approx(np.vdot(q, u), rel=1e-13)

    def test_far_from_a_cell_it_is_boussinesq(self):
        half_space = HalfSpace((101, 101), (1e-5, 1e-5), 1e11)
        p = np.zeros((101, 101))
        p[0, 0] = 1e9
        point_force = 1e9 * 1e-10
        distance = 100e-5 * math.sqrt(2)
        expected = point_force / (math.pi * 1e11 * distance)
        assert half_space.displacement(p)[100, 100] == pytest.approx(expected, rel=1e-5)

    def test_self_term_of_a_square_cell(self):
        half_space = HalfSpace((1, 1), (2e-6, 2e-6), 1e11)
        assert half_space.displacement([[3e8]])[0, 0] == pytest.approx(1.122200 * 3e8 * 2e-6 / 1e11, rel=1e-6)

    def test_rigid_flat_punch(self):
        # a rigid circular punch: F = 2 E* a δ
        x, h = grid(64, 1.0)
        inside = np.hypot(x[:, None], x[None, :]) < 0.5
        contact = HalfSpace((64, 64), (h, h), 1.0).solve(np.where(inside, 0.0, 1.0), approach=1e-3)
        assert contact.force == pytest.approx(2 * 0.5 * 1e-3, rel=0.02)

    @settings(max_examples=15)
    @given(st.integers(0, 10_000), st.floats(0.1, 3.0))
    def test_complementarity_and_tangent(self, seed, depth):
        gap, h = rough_gap(24, seed)
        half_space = HalfSpace((24, 24), (h, h), 1e11)
        delta = gap.min() + depth * 1e-6
        contact = half_space.solve(gap, approach=delta, rtol=1e-10)
        largest = delta - gap.min()
        assert contact.converged
        assert contact.pressure.min() >= 0.0
        assert contact.gap.min() >= -1e-9 * largest
        assert np.abs(contact.gap[contact.pressure > 0]).max() <= 1e-9 * largest
        assert contact.force == pytest.approx(contact.pressure.sum() * h * h, rel=1e-14)

    def test_tangent_equals_central_difference(self):
        gap, h = rough_gap()
        half_space = HalfSpace(gap.shape, (h, h), 1e11)
        contact = half_space.solve(gap, approach=1e-6, rtol=1e-12)
        step = 1e-12
        plus, minus = (half_space.solve(gap, approach=1e-6 + s, rtol=1e-13) for s in (step, -step))
        assert np.array_equal(plus.pressure > 0, minus.pressure > 0)
        assert contact.stiffness == pytest.approx((plus.force - minus.force) / (2 * step), rel=1e-6)

    def test_an_indentation_that_is_not_a_number_did_not_converge(self):
        taps, inside = (1.0, 0.0, 0.0, 0.0, 0.0, 0.0), np.ones((4, 4), dtype=bool)
        assert not unit_indentation(np.full((4, 4), np.nan), taps, inside, 1e-9, 5)[1]

    @settings(max_examples=15)
    @given(st.integers(0, 10_000), st.floats(0.2, 2.0), st.floats(1e-3, 0.5))
    def test_force_is_monotone(self, seed, depth, rise):
        gap, h = rough_gap(20, seed)
        half_space = HalfSpace((20, 20), (h, h), 1e11)
        low = half_space.solve(gap, approach=depth * 1e-6, rtol=1e-9)
        high = half_space.solve(gap, approach=(depth + rise) * 1e-6, rtol=1e-9)
        assert high.force > low.force
        assert high.area >= low.area

    @settings(max_examples=15)
    @given(st.integers(0, 10_000), st.floats(1e-3, 1e3), st.floats(1e-3, 1e3))
    def test_scale_invariance(self, seed, length, modulus):
        """All lengths × s and modulus × m: force × s² m."""
        gap, h = rough_gap(20, seed)
        one = HalfSpace((20, 20), (h, h), 1e11).solve(gap, approach=1e-6, rtol=1e-9)
        other = HalfSpace((20, 20), (h * length, h * length), 1e11 * modulus)
        scaled = other.solve(gap * length, approach=1e-6 * length, rtol=1e-9)
        assert scaled.force == pytest.approx(one.force * length**2 * modulus, rel=1e-7)

    def test_turning_the_window_turns_the_pressure(self):
        gap, h = rough_gap(24, 5)
        gap = gap[:, :18]
        one = HalfSpace((24, 18), (h, 1.3 * h), 1e11).solve(gap, approach=1e-6, rtol=1e-10)
        turned = HalfSpace((18, 24), (1.3 * h, h), 1e11).solve(gap.T, approach=1e-6, rtol=1e-10)
        np.testing.assert_allclose(turned.pressure.T, one.pressure, atol=1e-7 * one.pressure.max())


class TestControl:
    @pytest.mark.parametrize("seed", range(3))
    @pytest.mark.parametrize("depth", [0.05e-6, 0.5e-6, 3e-6])
    def test_load_and_approach_agree(self, seed, depth):
        gap, h = rough_gap(32, seed)
        half_space = HalfSpace(gap.shape, (h, h), 1e11)
        by_approach = half_space.solve(gap, approach=gap.min() + depth, rtol=1e-11)
        by_load = half_space.solve(gap, load=by_approach.force, rtol=1e-11)
        assert by_load.force == pytest.approx(by_approach.force, rel=1e-8)
        assert by_load.approach - gap.min() == pytest.approx(depth, rel=1e-8)

    @pytest.mark.parametrize("load", [1e-9, 1e-3, 1.0, 1e3, 1e6])
    def test_any_load_is_met(self, load):
        gap, h = rough_gap()
        contact = HalfSpace(gap.shape, (h, h), 1e11).solve(gap, load=load)
        assert contact.converged
        assert contact.force == pytest.approx(load, rel=1e-6)

    def test_zero_load_is_first_touch(self):
        gap, h = rough_gap()
        contact = HalfSpace(gap.shape, (h, h), 1e11).solve(gap, load=0.0)
        assert (contact.force, contact.approach, contact.outcome) == (0.0, gap.min(), Outcome.NO_CONTACT)

    def test_sign_a_peak_touches_first(self):
        """Contact of a rough surface starts at a negative approach of the mean planes."""
        gap = np.full((9, 9), 0.0)
        gap[4, 4] = -2e-6
        half_space = HalfSpace((9, 9), (1e-5, 1e-5), 1e11)
        assert half_space.solve(gap, approach=-2.1e-6).force == 0.0
        touching = half_space.solve(gap, approach=-1.9e-6)
        assert touching.force > 0.0
        assert np.argwhere(touching.pressure).tolist() == [[4, 4]]

    def test_warm_start_changes_nothing_but_the_work(self):
        gap, h = rough_gap()
        half_space = HalfSpace(gap.shape, (h, h), 1e11)
        cold = half_space.solve(gap, approach=1e-6, rtol=1e-10)
        warm = half_space.solve(gap, approach=1e-6, rtol=1e-10, start=cold.pressure)
        assert warm.force == pytest.approx(cold.force, rel=1e-9)
        assert warm.iterations <= 1
        wrong = half_space.solve(gap, approach=1e-6, rtol=1e-10, start=-1e9 * np.ones_like(gap))
        assert wrong.force == pytest.approx(cold.force, rel=1e-9)

    def test_start_is_not_changed(self):
        gap, h = rough_gap()
        start = np.full_like(gap, 1e6)
        HalfSpace(gap.shape, (h, h), 1e11).solve(gap, approach=1e-6, start=start)
        assert np.all(start == 1e6)


class TestHardness:
    def test_pressure_stops_at_the_cap(self):
        gap, h = paraboloid(48, 1.0, 10.0, 10.0)
        delta = 0.35**2 / 10
        elastic = HalfSpace((48, 48), (h, h), 1.0).solve(gap, approach=delta, rtol=1e-9)
        cap = 0.6 * elastic.pressure.max()
        contact = HalfSpace((48, 48), (h, h), 1.0, hardness=cap).solve(gap, approach=delta, rtol=1e-9)
        assert contact.converged
        assert contact.pressure.max() == cap
        assert contact.force < elastic.force
        flowing = contact.pressure == cap
        assert contact.gap[flowing].max() <= 1e-9 * delta  # the asperity is flattened there
        elastic_part = (contact.pressure > 0) & ~flowing
        assert np.abs(contact.gap[elastic_part]).max() <= 1e-8 * delta

    def test_full_plasticity_is_hardness_times_area(self):
        gap, h = paraboloid(48, 1.0, 10.0, 10.0)
        cap = 1e-6
        contact = HalfSpace((48, 48), (h, h), 1.0, hardness=cap).solve(gap, load=0.1 * cap, rtol=1e-8)
        assert contact.force == pytest.approx(0.1 * cap, rel=1e-7)
        assert contact.area * cap == pytest.approx(contact.force, rel=0.05)


class TestNonConvergence:
    def test_it_says_so(self, monkeypatch):
        monkeypatch.setattr("asperity.contact.halfspace.MAX_ITERATIONS", 2)
        gap, h = rough_gap()
        with pytest.warns(UnconvergedWarning, match="iteration limit"):
            contact = HalfSpace(gap.shape, (h, h), 1e11).solve(gap, approach=1e-6, rtol=1e-9)
        assert not contact.converged
        assert contact.outcome is Outcome.ITERATION_LIMIT
        assert contact.residual > 1e-9

    def test_contact_at_the_edge_is_seen(self):
        gap, h = paraboloid(16, 1.0, 10.0, 10.0)
        half_space = HalfSpace((16, 16), (h, h), 1.0)
        assert half_space.solve(gap, approach=0.2).edge_share > 0.1
        assert half_space.solve(gap, approach=0.01).edge_share == 0.0
        assert half_space.solve(gap, approach=-1.0).edge_share == 0.0


class TestBadInput:
    @pytest.mark.parametrize(
        ("arguments", "message"),
        [
            (((0, 4), (1.0, 1.0), 1.0), "half-space shape: received"),
            (((4.5, 4), (1.0, 1.0), 1.0), "half-space shape: received"),
            (((4, 4), (1.0, -1.0), 1.0), "half-space spacing: received"),
            (((4, 4), (1.0, math.nan), 1.0), "half-space spacing: received"),
            (((4, 4), (1.0, 1.0), 0.0), "contact modulus: received"),
            (((4, 4), (1.0, 1.0), 1.0, -3.0), "hardness: received"),
        ],
    )
    def test_construction(self, arguments, message):
        with pytest.raises(InputError, match=message):
            HalfSpace(*arguments)

    @pytest.mark.parametrize(
        ("keywords", "message"),
        [
            ({}, "approach and load: received neither"),
            ({"approach": 1.0, "load": 1.0}, "approach and load: received both"),
            ({"approach": math.nan}, "approach: received nan"),
            ({"load": -1.0}, "load: received -1.0"),
            ({"load": 1.0, "rtol": 0.0}, "rtol: received"),
            ({"approach": 1.0, "start": np.zeros((2, 2))}, "start pressure shape: received"),
        ],
    )
    def test_solve(self, keywords, message):
        with pytest.raises(InputError, match=message):
            HalfSpace((4, 4), (1.0, 1.0), 1.0).solve(np.zeros((4, 4)), **keywords)

    def test_gap(self):
        half_space = HalfSpace((4, 4), (1.0, 1.0), 1.0)
        with pytest.raises(InputError, match="gap shape: received"):
            half_space.solve(np.zeros((4, 5)), approach=1.0)
        gap = np.zeros((4, 4))
        gap[1, 2] = math.nan
        with pytest.raises(InputError, match="1 of 16 values NaN"):
            half_space.solve(gap, approach=1.0)

    def test_load_beyond_plastic_capacity(self):
        half_space = HalfSpace((4, 4), (1.0, 1.0), 1.0, hardness=2.0)
        with pytest.raises(InputError, match="hardness × window area = 32 N"):
            half_space.solve(np.zeros((4, 4)), load=33.0)
