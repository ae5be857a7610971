"""Running-in: what a capped pressure leaves of a surface, pressed, rolled over, and rolled over again."""

import warnings

import numpy as np
import pytest

from asperity import HalfSpace, HeightMap
from asperity.contact.running_in import RunningIn, run_in
from asperity.errors import TruncatedContactWarning, UnconvergedWarning
from asperity.store import Store
from asperity.surfaces.synthesis import self_affine

STEEL, LOAD, DX = 115e9, 2.0, 8e-6
HARD = 0.5e9  # yields at asperities, not as a whole: Hertz's largest pressure is 0.2 GPa


def half_space(hardness=HARD, cells=41):
    return HalfSpace((cells, cells), DX, STEEL, hardness)


def ball(cells=41):
    x = (np.arange(cells) - cells // 2) * DX
    return (x[:, None] ** 2 + x**2) / (2 * 25e-3)


def rough(rows, rms=0.2e-6):
    """A draw of which no contact reaches the edge of the window: crests far out carry in others."""
    waves = {"longest": 0.2e-3, "shortest": 4 * DX}
    return self_affine((rows, 41), (DX, DX), rms=rms, hurst=0.8, seed=3, **waves).heights


def test_the_second_loading_is_elastic_with_the_same_pressure():
    gap = ball() - rough(41)
    first = half_space().solve(gap, load=LOAD, rtol=1e-9)
    assert first.yielded_share == np.mean(first.pressure[first.pressure > 0.0] == HARD)
    assert 0.1 < first.yielded_share < 0.9
    assert first.plastic_indentation.max() > 10e-9
    assert not first.plastic_indentation[first.pressure < HARD].any()
    uncapped = half_space(None).solve(gap + first.plastic_indentation, load=LOAD, rtol=1e-9)
    assert np.abs(uncapped.pressure - first.pressure).max() < 1e-5 * HARD
    assert uncapped.approach == pytest.approx(first.approach, rel=1e-6, abs=0.0)
    assert uncapped.yielded_share == uncapped.plastic_indentation.max() == 0.0


def test_shakedown_leaves_a_surface_whose_next_pass_is_elastic():
    heights = rough(120, rms=0.12e-6)
    surface = half_space().run_in(heights, ball(), LOAD)
    assert (surface.heights <= heights).all()
    assert np.abs(surface.heights - heights).max() > 50e-9
    tolerance = 1e-3 * half_space(None).solve(ball(), load=LOAD).approach
    again = half_space().run_in(surface, ball(), LOAD, passes=1)
    assert np.abs(again.heights - surface.heights).max() <= tolerance
    for first in range(0, 80, 20):
        before, after = (
            half_space(None).solve(ball() - each[first : first + 41], load=LOAD).pressure.max()
            for each in (heights, surface.heights)
        )
        assert before > 1.2 * HARD
        assert after < 1.02 * HARD  # what the tolerance leaves


@pytest.mark.parametrize("cells", ["whole", "covered"])
def test_what_counts_as_no_lowering_is_a_share_of_the_elastic_approach_on_the_same_cells(cells):
    own = HalfSpace((41, 41), DX, STEEL, HARD, cells=cells)
    elastic = HalfSpace((41, 41), DX, STEEL, cells=cells).solve(ball(), load=LOAD, rtol=1e-9)
    found = RunningIn(own, ball(), LOAD, None).tolerance
    solved_to = 1e-4  # residual over the overlap: enough for what shall be no lowering
    assert found == pytest.approx(1e-3 * elastic.approach, rel=solved_to, abs=0.0)


def test_each_pass_lowers_less_and_the_yielded_share_is_of_what_was_touched():
    job = RunningIn(half_space(), ball(), LOAD, 4)
    found = run_in(rough(100), job)
    assert (np.diff(found.largest) < 0).all()
    assert found.largest[1] < 0.2 * found.largest[0]
    lowered = found.lowering > job.tolerance
    assert found.yielded_share == np.count_nonzero(lowered) / np.count_nonzero(found.touched)
    assert not found.lowering[~found.touched].any()
    assert found.settled == (found.largest[-1] <= job.tolerance)


def test_a_load_that_yields_nothing_changes_nothing():
    heights = rough(60, 0.01e-6)
    found = half_space(5e9).run_in(heights, ball(), LOAD)
    assert np.array_equal(found.heights, heights)
    assert found.source == "run in by 1 pass under 2 N, 0 % yielded"


def test_threads_change_no_digit(monkeypatch):
    monkeypatch.setattr("asperity.contact.running_in.PIECE", 64)
    job = RunningIn(half_space(), ball(), LOAD, 1)
    one, three = (run_in(rough(41 + 200), job, workers=n) for n in (1, 3))
    assert np.array_equal(one.heights, three.heights)
    assert one.counts == three.counts
    assert one.counts.solved == 201


def test_what_the_cache_knows_is_not_rolled_again(tmp_path):
    heights, cache, calls = rough(60), Store(tmp_path), []

    def told(done, total, message):
        calls.append(message)
        if calls.count("running in, pass 3") == 1:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        half_space().run_in(heights, ball(), LOAD, 4, cache=cache, progress=told)
    assert len(set(calls)) == 3
    again = half_space().run_in(heights, ball(), LOAD, 4, cache=cache, progress=told)
    assert set(calls[calls.index("running in, pass 3") :]) == {"running in, pass 3", "running in, pass 4"}
    assert np.array_equal(again.heights, half_space().run_in(heights, ball(), LOAD, 4).heights)


def test_no_shakedown_and_a_cut_off_contact_are_warned_of(monkeypatch):
    monkeypatch.setattr("asperity.contact.running_in.MOST_PASSES", 2)
    surface = HeightMap(np.zeros((60, 17)), (DX, DX), "plate")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        found = half_space(0.19e9, 17).run_in(surface, ball(17), LOAD)
    told = {w.category: str(w.message) for w in caught}
    assert set(told) == {UnconvergedWarning, TruncatedContactWarning}
    assert "has not reached shakedown" in told[UnconvergedWarning]
    assert "of running-in (100 %)" in told[TruncatedContactWarning]
    assert "the contact is cut off and yields too much" in told[TruncatedContactWarning]
    assert found.source.startswith("plate; run in by 2 passes under 2 N")
