"""Running-in: what a capped pressure leaves of a surface, pressed, rolled over, and rolled over again."""

import warnings

import numpy as np
import pytest

from asperity.contact import HalfSpace
from asperity.contact.running_in import RunningIn, run_in
from asperity.errors import InputError, TruncatedContactWarning, UnconvergedWarning
from asperity.store import Store
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.synthesis import self_affine

STEEL = 115e9  # E*, Pa


def ball(cells, spacing, radius):
    x = (np.arange(cells) - cells // 2) * spacing
    return (x[:, None] ** 2 + x**2) / (2 * radius)


def rough(rows, cells, spacing, rms, seed=1):
    waves = {"longest": 0.2e-3, "shortest": 4 * spacing}
    return self_affine((rows, cells), (spacing, spacing), rms=rms, hurst=0.8, seed=seed, **waves).heights


BODY = ball(41, 8e-6, 25e-3)
HARD = 0.5e9  # yields at asperities, not as a whole: Hertz's largest pressure is 0.2 GPa
LOAD = 2.0


class TestStandingContact:
    def test_the_second_loading_is_elastic_with_the_same_pressure(self):
        gap = BODY - rough(41, 41, 8e-6, 0.2e-6)
        first = HalfSpace(BODY.shape, 8e-6, STEEL, HARD).solve(gap, load=LOAD, rtol=1e-9)
        assert 0.1 < first.yielded_share < 0.9
        uncapped = HalfSpace(BODY.shape, 8e-6, STEEL).solve(
            gap + first.plastic_indentation, load=LOAD, rtol=1e-9
        )
        assert np.abs(uncapped.pressure - first.pressure).max() < 1e-5 * HARD
        assert uncapped.approach == pytest.approx(first.approach, rel=1e-6)

    def test_only_capped_cells_yield_and_they_are_lowered(self):
        gap = BODY - rough(41, 41, 8e-6, 0.2e-6)
        contact = HalfSpace(BODY.shape, 8e-6, STEEL, HARD).solve(gap, load=LOAD)
        capped = contact.pressure == HARD
        assert contact.plastic_indentation.min() == 0.0
        assert not contact.plastic_indentation[~capped].any()
        assert contact.plastic_indentation[capped].max() > 10e-9
        # lower heights, a larger gap, carry less at the same approach
        lowered = HalfSpace(BODY.shape, 8e-6, STEEL).solve(
            gap + contact.plastic_indentation, approach=contact.approach
        )
        untouched = HalfSpace(BODY.shape, 8e-6, STEEL).solve(gap, approach=contact.approach)
        assert lowered.force < untouched.force

    def test_elastic_contact_yields_nowhere(self):
        contact = HalfSpace(BODY.shape, 8e-6, STEEL).solve(BODY, load=LOAD)
        assert contact.yielded_share == 0.0
        assert not contact.plastic_indentation.any()

    def test_full_plasticity_carries_hardness_times_area(self):
        """A ball far beyond yield: uniform pressure H on a circle, whose displacement has a closed form.

        F = H π a²; at the rim the surfaces just meet, so that the depth of the mark in the middle is
        a²/2R − (2 − 4/π) H a/E* (Johnson, Contact Mechanics, 1985).
        """
        radius, hardness, spacing, n = 1.0, 1e6, 1e-3, 81
        half_space = HalfSpace((n, n), spacing, STEEL, hardness)
        a = 30e-3
        contact = half_space.solve(ball(n, spacing, radius), load=hardness * np.pi * a**2)
        assert contact.yielded_share > 0.99
        assert contact.yielded_share * contact.area * hardness <= contact.force <= contact.area * hardness
        depth = a**2 / (2 * radius) - (2 - 4 / np.pi) * hardness * a / STEEL
        assert contact.plastic_indentation[n // 2, n // 2] == pytest.approx(depth, rel=5e-3)


class TestRolling:
    def test_groove_of_a_ball_beyond_yield_has_the_width_of_scratch_hardness(self):
        """ASTM G171: H = 8 F/(π w²), because a body that moves rests on the half of its patch ahead."""
        radius, hardness, spacing, n = 1.0, 1e6, 1e-3, 61
        width = 40e-3
        load = hardness * np.pi * width**2 / 8
        half_space = HalfSpace((n, n), spacing, STEEL, hardness)
        found = half_space.run_in(np.zeros((170, n)), ball(n, spacing, radius), load, passes=1)
        depth = -found.heights[105:120].mean(axis=0)  # behind a ball that has reached its depth
        # on cells the half patch has half a row more: π a²/2 + a h, 1.6 % less width at 20 cells
        assert depth.max() == pytest.approx((width / 2) ** 2 / (2 * radius), rel=0.04)
        # the groove's section is the ball's: its width by the parabola through its upper half
        y = (np.arange(n) - n // 2) * spacing
        deep = depth > 0.5 * depth.max()
        slope, top = np.polyfit(y[deep] ** 2, depth[deep], 1)
        assert 2 * np.sqrt(-top / slope) == pytest.approx(width, rel=0.02)
        assert -0.5 / slope == pytest.approx(radius, rel=0.01)

    def test_shakedown_leaves_a_surface_whose_next_pass_is_elastic(self):
        heights = rough(140, 41, 8e-6, 0.2e-6)
        hard = HalfSpace(BODY.shape, 8e-6, STEEL, HARD)
        surface = hard.run_in(heights, BODY, LOAD)
        assert (surface.heights <= heights).all()
        assert np.abs(surface.heights - heights).max() > 50e-9
        tolerance = 1e-3 * HalfSpace(BODY.shape, 8e-6, STEEL).solve(BODY, load=LOAD).approach
        again = hard.run_in(surface, BODY, LOAD, passes=1)
        assert np.abs(again.heights - surface.heights).max() <= tolerance
        elastic = HalfSpace(BODY.shape, 8e-6, STEEL)
        for first in range(0, 100, 7):
            before = elastic.solve(BODY - heights[first : first + 41], load=LOAD)
            after = elastic.solve(BODY - surface.heights[first : first + 41], load=LOAD)
            assert before.pressure.max() > 1.2 * HARD
            assert after.pressure.max() < 1.02 * HARD  # what the tolerance leaves

    def test_a_soft_smooth_ball_shakes_down_in_a_groove(self):
        """Hertz's largest pressure is 0.20 GPa: at 0.18 GPa a groove carries it elastically at last."""
        soft = HalfSpace(BODY.shape, 8e-6, STEEL, 0.18e9)
        surface = soft.run_in(np.zeros((120, 41)), BODY, LOAD)
        contact = HalfSpace(BODY.shape, 8e-6, STEEL).solve(BODY - surface.heights[40:81], load=LOAD)
        smooth = HalfSpace(BODY.shape, 8e-6, STEEL).solve(BODY, load=LOAD)
        assert smooth.pressure.max() > 0.2e9
        assert contact.pressure.max() == pytest.approx(0.18e9, rel=0.01)

    def test_each_pass_lowers_less_and_the_yielded_share_is_of_what_was_touched(self):
        heights = rough(140, 41, 8e-6, 0.2e-6)
        job = RunningIn(HalfSpace(BODY.shape, 8e-6, STEEL, HARD), BODY, LOAD, 4, 0.3e-9)
        found = run_in(heights, job)
        assert (np.diff(found.largest) < 0).all()
        assert found.largest[1] < 0.2 * found.largest[0]
        lowered = found.lowering > job.tolerance
        assert found.yielded_share == np.count_nonzero(lowered) / np.count_nonzero(found.touched)
        assert not found.lowering[~found.touched].any()
        assert found.yielding[0] <= found.yielded_share

    def test_a_load_that_yields_nothing_changes_nothing(self):
        heights = rough(90, 41, 8e-6, 0.01e-6)
        found = HalfSpace(BODY.shape, 8e-6, STEEL, 5e9).run_in(heights, BODY, LOAD)
        assert np.array_equal(found.heights, heights)
        assert found.source == "run in by 1 pass under 2 N, 0 % yielded"

    def test_threads_change_no_digit(self):
        heights = rough(41 + 600, 41, 8e-6, 0.2e-6)
        job = RunningIn(HalfSpace(BODY.shape, 8e-6, STEEL, HARD), BODY, LOAD, 1, 0.3e-9)
        one, three = (run_in(heights, job, workers=n) for n in (1, 3))
        assert np.array_equal(one.heights, three.heights)
        assert one.counts == three.counts

    def test_what_the_cache_knows_is_not_rolled_again(self, tmp_path):
        heights, cache = rough(90, 41, 8e-6, 0.2e-6), Store(tmp_path)
        half_space, calls = HalfSpace(BODY.shape, 8e-6, STEEL, HARD), []

        def interrupted(done, total, message):
            calls.append(message)
            if message.endswith("pass 3"):
                raise KeyboardInterrupt

        with pytest.raises(KeyboardInterrupt):
            half_space.run_in(heights, BODY, LOAD, 4, cache=cache, progress=interrupted)
        calls.clear()
        found = half_space.run_in(
            heights, BODY, LOAD, 4, cache=cache, progress=lambda *step: calls.append(step[2])
        )
        assert set(calls) == {"running in, pass 3", "running in, pass 4"}
        assert np.array_equal(found.heights, half_space.run_in(heights, BODY, LOAD, 4).heights)


class TestMessages:
    def test_elastic_half_space(self):
        with pytest.raises(InputError, match="hardness of the half-space: received None"):
            HalfSpace(BODY.shape, 8e-6, STEEL).run_in(np.zeros((90, 41)), BODY, LOAD)

    @pytest.mark.parametrize("passes", ["often", 0, 1.5, 101])
    def test_passes(self, passes):
        with pytest.raises(InputError, match=r'passes.*from 1 to 100, or "shakedown"'):
            HalfSpace(BODY.shape, 8e-6, STEEL, HARD).run_in(np.zeros((90, 41)), BODY, LOAD, passes)

    def test_surface_of_another_width(self):
        with pytest.raises(InputError, match="90 × 50 cells under a window of 41 × 41"):
            HalfSpace(BODY.shape, 8e-6, STEEL, HARD).run_in(np.zeros((90, 50)), BODY, LOAD)

    def test_body_of_another_shape(self):
        with pytest.raises(InputError, match="body that runs in"):
            HalfSpace(BODY.shape, 8e-6, STEEL, HARD).run_in(np.zeros((90, 41)), BODY[1:], LOAD)

    def test_missing_points(self):
        heights = np.full((90, 41), np.nan)
        with pytest.raises(InputError, match="Fill missing points"):
            HalfSpace(BODY.shape, 8e-6, STEEL, HARD).run_in(heights, BODY, LOAD)

    def test_no_shakedown_and_a_cut_off_contact_are_warned_of(self, monkeypatch):
        monkeypatch.setattr("asperity.contact.running_in.MOST_PASSES", 2)
        window = HalfSpace((17, 17), 8e-6, STEEL, 0.19e9)
        surface = HeightMap(np.zeros((60, 17)), (8e-6, 8e-6), "plate")
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            found = window.run_in(surface, ball(17, 8e-6, 25e-3), LOAD)
        kinds = {w.category for w in caught}
        assert kinds == {UnconvergedWarning, TruncatedContactWarning}
        assert any("has not reached shakedown" in str(w.message) for w in caught)
        assert found.source.startswith("plate; run in by 2 passes under 2 N")
