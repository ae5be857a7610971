"""The quasi-static scan: geometry, signs, caching and messages."""

import threading

import numpy as np
import pytest

import asperity
from asperity.contact import HalfSpace, Hertz
from asperity.errors import InputError, TruncatedContactWarning, UnconvergedWarning
from asperity.reduction.accuracy import in_single
from asperity.reduction.blocks import solve_block
from asperity.reduction.scan import first_touch, scan_forces

DX = 5e-6
MODULUS = 115e9
RADIUS = 10e-3


def ball(n):
    x = (np.arange(n) - n // 2) * DX
    return (x[:, None] ** 2 + x[None, :] ** 2) / (2 * RADIUS)


def rough(n, ny, seed=0, rms=0.05e-6):
    return rms * np.random.default_rng(seed).standard_normal((n, ny))


def test_each_position_is_a_contact_of_its_own():
    heights, body = rough(60, 41), ball(41)
    approaches = [0.1e-6, 0.3e-6]
    forces = asperity.scan(heights, (DX, DX), body, MODULUS, approaches, rtol=1e-9)
    assert forces.dims == ("approach", "position")
    assert forces.shape == (2, 20)
    half_space = HalfSpace((41, 41), (DX, DX), MODULUS)
    for m in (0, 7, 19):
        gap = body - (heights - heights.mean())[m : m + 41]
        for i, approach in enumerate(approaches):
            alone = half_space.solve(gap, approach=approach, rtol=1e-9).force
            assert forces.values[i, m] == pytest.approx(alone, rel=1e-7)


def test_the_body_moves_towards_larger_rows():
    """A bump around row 30 is under the ball's middle (row 20 of the window) at position 10."""
    rows = np.arange(60.0)[:, None]
    heights = 0.05e-6 * np.exp(-(((rows - 30) / 12) ** 2)) * np.ones((1, 41))
    forces = asperity.scan(heights, (DX, DX), ball(41), MODULUS, [0.1e-6])
    assert int(forces.argmax("position")[0]) == 10
    assert forces.position.values[10] == pytest.approx(10 * DX)


def test_mean_plane_is_the_datum():
    forces = [
        asperity.scan(rough(44, 41) + offset, (DX, DX), ball(41), MODULUS, [0.2e-6]) for offset in (0, 1e-6)
    ]
    np.testing.assert_allclose(forces[0], forces[1], rtol=1e-6)


def test_smooth_surface_is_hertz_everywhere():
    forces = asperity.scan(np.zeros((50, 41)), (DX, DX), ball(41), MODULUS, [-0.1e-6, 0.0, 0.2e-6])
    hertz = Hertz(MODULUS, RADIUS, RADIUS)
    assert np.all(forces.values[:2] == 0.0)
    np.testing.assert_allclose(forces.values[2], hertz.force(0.2e-6), rtol=3e-3)


def test_stride_takes_every_other_position():
    heights, body = rough(70, 41), ball(41)
    full = asperity.scan(heights, (DX, DX), body, MODULUS, [0.2e-6], rtol=1e-9)
    half = asperity.scan(heights, (DX, DX), body, MODULUS, [0.2e-6], rtol=1e-9, stride=3)
    np.testing.assert_allclose(half, full[:, ::3], rtol=1e-7)
    np.testing.assert_allclose(half.position, full.position[::3])


@pytest.mark.parametrize(("hardness", "pays"), [(None, np.inf), (1e9, np.inf), (None, 0.0)])
def test_workers_do_not_change_a_digit(monkeypatch, hardness, pays):
    monkeypatch.setattr("asperity.reduction.scan.BLOCK", 7)
    monkeypatch.setattr("asperity.reduction.accuracy.SINGLE_PAYS", pays)
    heights, body, approaches = rough(70, 41), ball(41), [0.1e-6, 0.2e-6]
    one, two = (
        scan_forces(heights, (DX, DX), body, MODULUS, approaches, hardness, rtol=4e-6, workers=n)
        for n in (1, 2)
    )
    assert np.array_equal(one.forces, two.forces)
    assert (one.solved, one.iterations) == (two.solved, two.iterations)


class Memory(dict):
    def put(self, key, arrays):
        self[key] = arrays


def test_interrupted_scan_goes_on_where_it_was(monkeypatch):
    monkeypatch.setattr("asperity.reduction.scan.BLOCK", 8)
    heights, body, interrupted = rough(120, 41), ball(41), threading.Event()

    class Waiting(Memory):
        def put(self, key, arrays):
            if len(self) >= 2:  # the third block ends after the interrupt, however slow the main thread is
                interrupted.wait(30)
            super().put(key, arrays)

    cache = Waiting()

    def interrupt(done, total, message):
        if done >= 16:
            interrupted.set()
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        scan_forces(heights, (DX, DX), body, MODULUS, [0.2e-6], workers=1, cache=cache, progress=interrupt)
    kept = len(cache)
    assert 2 <= kept < 10
    solved = []

    def solve(*block):
        forces, counts = solve_block(*block)
        solved.append(counts[0])
        return forces, counts

    monkeypatch.setattr("asperity.reduction.scan.solve_block", solve)
    resumed = scan_forces(heights, (DX, DX), body, MODULUS, [0.2e-6], workers=1, cache=cache)
    assert sum(solved) == 80 - 8 * kept
    fresh = scan_forces(heights, (DX, DX), body, MODULUS, [0.2e-6], workers=1)
    assert np.array_equal(resumed.forces, fresh.forces)


def test_cache_knows_what_the_force_depends_on():
    heights, body, cache = rough(44, 41), ball(41), Memory()
    scan_forces(heights, (DX, DX), body, MODULUS, [0.2e-6], cache=cache)
    for change in ({"modulus": 1e11}, {"approaches": [0.1e-6]}, {"hardness": 1e9}, {"rtol": 1e-5}):
        keywords = {"modulus": MODULUS, "approaches": [0.2e-6], "cache": cache} | change
        before = len(cache)
        scan_forces(heights, (DX, DX), body, **keywords)
        assert len(cache) == before + 1


def test_first_touch_is_where_the_force_starts():
    heights, body = rough(60, 41), ball(41)
    touches = first_touch(heights, body)
    touch = touches.min()
    assert touches.shape == (20,)
    assert touch < 0.0
    below = scan_forces(heights, (DX, DX), body, MODULUS, [touch - 1e-12, touch + 1e-9]).forces
    assert not below[0].any()
    assert np.flatnonzero(below[1]).tolist() == np.flatnonzero(touches < touch + 1e-9).tolist()


def test_planes_shift_the_approach_of_each_position():
    heights, body = rough(44, 41), ball(41)
    planes = np.array([0.0, 0.1e-6, -0.05e-6, 0.2e-6])
    shifted = scan_forces(heights, (DX, DX), body, MODULUS, [0.1e-6], rtol=1e-9, planes=planes).forces[0]
    for m, plane in enumerate(planes):
        alone = scan_forces(heights[m : m + 41], (DX, DX), body, MODULUS, [0.1e-6 - plane], rtol=1e-9)
        assert shifted[m] == pytest.approx(alone.forces[0, 0], rel=1e-7)


def test_contact_at_the_edge_warns():
    with pytest.warns(
        TruncatedContactWarning, match=r"4 of 4 .* \(100 %\) .* A window of 0\.1\d+ mm holds them"
    ):
        asperity.scan(np.zeros((24, 21)), (DX, DX), ball(21), MODULUS, [0.5e-6])


def test_unconverged_solutions_warn(monkeypatch):
    monkeypatch.setattr("asperity.contact.halfspace.MAX_ITERATIONS", 1)
    with pytest.warns(UnconvergedWarning, match="4 of 4 contact solutions of the scan"):
        forces = asperity.scan(rough(44, 41), (DX, DX), ball(41), MODULUS, [0.2e-6])
    assert forces.attrs["unconverged"] == 4


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"heights": np.zeros((30, 41))}, "window of the scan: received 41 × 41 cells"),
        ({"heights": np.zeros((60, 40))}, "window of the scan"),
        ({"heights": np.full((60, 41), np.nan)}, "heights of the scan"),
        ({"body": np.zeros(41)}, "body of the scan"),
        ({"approaches": [0.2e-6, 0.1e-6]}, "approaches of the scan"),
        ({"approaches": []}, "approaches of the scan"),
        ({"stride": 0}, "stride of the scan"),
        ({"modulus": -1.0}, "contact modulus"),
        ({"spacing": (0.0, DX)}, "spacing of the scan"),
    ],
)
def test_bad_input(change, message):
    keywords = {
        "heights": np.zeros((60, 41)),
        "spacing": (DX, DX),
        "body": ball(41),
        "modulus": MODULUS,
        "approaches": [0.1e-6],
    }
    with pytest.raises(InputError, match=message):
        asperity.scan(**(keywords | change))


@pytest.mark.parametrize("hardness", [None, 1e9])
@pytest.mark.parametrize("rtol", [4e-5, 4e-6])
def test_single_precision_is_as_accurate_as_the_tolerance(monkeypatch, hardness, rtol):
    heights, body, approaches = rough(120, 41), ball(41), [0.05e-6, 0.15e-6, 0.3e-6]
    scans = []
    for pays, tolerance in ((np.inf, 1e-10), (np.inf, rtol), (0.0, rtol)):
        monkeypatch.setattr("asperity.reduction.accuracy.SINGLE_PAYS", pays)
        scans.append(scan_forces(heights, (DX, DX), body, MODULUS, approaches, hardness, rtol=tolerance))
    exact, double, single = scans
    assert single.unconverged == 0
    assert (double.single, single.single) == (False, True)
    assert not np.array_equal(single.forces, double.forces)
    assert single.iterations <= 1.03 * double.iterations
    np.testing.assert_allclose(single.forces, exact.forces, rtol=2.5 * rtol, atol=0.0)


def test_tight_tolerances_and_short_scans_stay_in_double():
    assert in_single(4e-6, 1e10)
    assert not in_single(1e-6, 1e10)
    assert not in_single(4e-6, 1e9)
