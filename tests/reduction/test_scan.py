"""The quasi-static scan: geometry, signs, caching and messages."""

import doctest
import threading

import numpy as np
import pytest

from asperity import HalfSpace, HeightMap
from asperity.contact import Hertz, halfspace, scan
from asperity.contact.scan import ScanJob, first_touch, scan_forces
from asperity.errors import InputError, TruncatedContactWarning, UnconvergedWarning
from asperity.store import content_key
from asperity.surfaces.strip import Rows

DX = 5e-6
MODULUS = 115e9
RADIUS = 10e-3


def ball(n):
    x = (np.arange(n) - n // 2) * DX
    return (x[:, None] ** 2 + x[None, :] ** 2) / (2 * RADIUS)


def half_space(n=41, hardness=None, modulus=MODULUS):
    return HalfSpace((n, n), DX, modulus, hardness)


def job(heights, approaches, hardness=None, modulus=MODULUS, **details):
    return ScanJob(
        half_space(41, hardness, modulus), Rows(heights), ball(41), np.array(approaches), **details
    )


def rough(n, ny, seed=0, rms=0.05e-6):
    return rms * np.random.default_rng(seed).standard_normal((n, ny))


def test_each_position_is_a_contact_of_its_own():
    heights, body = rough(60, 41), ball(41)
    approaches = [0.1e-6, 0.3e-6]
    forces = half_space().scan(heights, body, approaches, rtol=1e-9)
    assert forces.dims == ("approach", "position")
    assert forces.shape == (2, 20)
    for m in (0, 7, 19):
        gap = body - (heights - heights.mean())[m : m + 41]
        for i, approach in enumerate(approaches):
            alone = half_space().solve(gap, approach=approach, rtol=1e-9).force
            assert forces.values[i, m] == pytest.approx(alone, rel=1e-7)


def test_the_body_moves_towards_larger_rows():
    """A bump around row 30 is under the ball's middle (row 20 of the window) at position 10."""
    rows = np.arange(60.0)[:, None]
    heights = 0.05e-6 * np.exp(-(((rows - 30) / 12) ** 2)) * np.ones((1, 41))
    forces = half_space().scan(heights, ball(41), [0.1e-6])
    assert int(forces.argmax("position")[0]) == 10
    assert forces.position.values[10] == pytest.approx(10 * DX)


def test_mean_plane_is_the_datum():
    forces = [half_space().scan(rough(44, 41) + offset, ball(41), [0.2e-6]) for offset in (0, 1e-6)]
    np.testing.assert_allclose(forces[0], forces[1], rtol=1e-6)


def test_smooth_surface_is_hertz_everywhere():
    forces = half_space().scan(np.zeros((50, 41)), ball(41), [-0.1e-6, 0.0, 0.2e-6])
    hertz = Hertz(MODULUS, RADIUS, RADIUS)
    assert np.all(forces.values[:2] == 0.0)
    np.testing.assert_allclose(forces.values[2], hertz.force(0.2e-6), rtol=3e-3)


def test_stride_takes_every_other_position():
    heights, body = rough(70, 41), ball(41)
    full = half_space().scan(heights, body, [0.2e-6], rtol=1e-9)
    half = half_space().scan(heights, body, [0.2e-6], rtol=1e-9, stride=3)
    np.testing.assert_allclose(half, full[:, ::3], rtol=1e-7)
    np.testing.assert_allclose(half.position, full.position[::3])


@pytest.mark.parametrize(("hardness", "pays"), [(None, np.inf), (1e9, np.inf), (None, 0.0)])
def test_workers_do_not_change_a_digit(monkeypatch, hardness, pays):
    monkeypatch.setattr("asperity.contact.scan.BLOCK", 7)
    monkeypatch.setattr("asperity.contact.scan.SINGLE_PAYS", pays)
    scanned = job(rough(70, 41), [0.1e-6, 0.2e-6], hardness, rtol=4e-6)
    one, two = (scan_forces(scanned, workers=n) for n in (1, 2))
    assert one.single == two.single == (pays == 0.0)
    assert np.array_equal(one.forces, two.forces)
    assert one.counts == two.counts


class Memory(dict):
    def put(self, key, arrays):
        self[key] = arrays


def test_interrupted_scan_goes_on_where_it_was(monkeypatch):
    monkeypatch.setattr("asperity.contact.scan.BLOCK", 8)
    path, interrupted = job(rough(120, 41), [0.2e-6]), threading.Event()

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
        scan_forces(path, workers=1, cache=cache, progress=interrupt)
    kept = len(cache)
    assert 2 <= kept < 10
    solved, solve = [], ScanJob.solve

    def counted(self, rows, planes):
        forces, counts = solve(self, rows, planes)
        solved.append(counts[0])
        return forces, counts

    monkeypatch.setattr(ScanJob, "solve", counted)
    resumed = scan_forces(path, workers=1, cache=cache)
    assert sum(solved) == 80 - 8 * kept
    fresh = scan_forces(path, workers=1)
    assert np.array_equal(resumed.forces, fresh.forces)


def test_cache_knows_what_the_force_depends_on():
    known = {"heights": rough(44, 41), "approaches": [0.2e-6]}
    cache = Memory()
    scan_forces(job(**known), cache=cache)
    changes = [
        {"modulus": 1e11}, {"approaches": [0.1e-6]}, {"hardness": 1e9}, {"rtol": 1e-5}, {"stride": 2},
        {"planes": 1e-9}, {"heights": rough(44, 41, seed=1)},
    ]  # fmt: skip
    for change in changes:
        before = len(cache)
        scan_forces(job(**known | change), cache=cache)
        assert len(cache) == before + 1, change


def test_kept_blocks_have_the_names_that_caches_know():
    """A cache of years keeps its worth: the name is made of these parts, in this order."""
    path = job(rough(44, 41), [0.2e-6], 1e9, stride=2, rtol=4e-5, planes=1e-9)
    cache = Memory()
    scan_forces(path, cache=cache)
    parameters = [[DX, DX], MODULUS, 1e9, 2, 4e-5]
    parts = rough(44, 41)[:43], ball(41), np.array([0.2e-6]), np.full(2, 1e-9), parameters
    assert list(cache) == [content_key("scan", *parts)]


def test_first_touch_is_where_the_force_starts():
    heights, body = rough(60, 41), ball(41)
    touches = first_touch(heights, body)
    touch = touches.min()
    assert touches.shape == (20,)
    assert touch < 0.0
    below = scan_forces(job(heights, [touch - 1e-12, touch + 1e-9])).forces
    assert not below[0].any()
    assert np.flatnonzero(below[1]).tolist() == np.flatnonzero(touches < touch + 1e-9).tolist()


def test_planes_shift_the_approach_of_each_position():
    heights = rough(44, 41)
    planes = np.array([0.0, 0.1e-6, -0.05e-6, 0.2e-6])
    shifted = scan_forces(job(heights, [0.1e-6], rtol=1e-9, planes=planes)).forces[0]
    for m, plane in enumerate(planes):
        alone = scan_forces(job(heights[m : m + 41], [0.1e-6 - plane], rtol=1e-9))
        assert shifted[m] == pytest.approx(alone.forces[0, 0], rel=1e-7)


def test_contact_at_the_edge_warns():
    with pytest.warns(
        TruncatedContactWarning, match=r"4 of 4 .* \(100 %\) .* A window of 0\.1\d+ mm holds them"
    ):
        half_space(21).scan(np.zeros((24, 21)), ball(21), [0.5e-6])


def test_unconverged_solutions_warn(monkeypatch):
    monkeypatch.setattr("asperity.contact.halfspace.MAX_ITERATIONS", 1)
    with pytest.warns(UnconvergedWarning, match="4 of 4 contact solutions of the scan.* larger rtol"):
        forces = half_space().scan(rough(44, 41), ball(41), [0.2e-6])
    assert forces.attrs["unconverged"] == 4
    with pytest.warns(UnconvergedWarning, match="Try a larger force_accuracy"):
        half_space().scan(rough(44, 41), ball(41), [0.2e-6], force_accuracy=1e-5)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"surface": np.zeros((30, 41))}, "window of the scan: received 41 × 41 cells"),
        ({"surface": np.zeros((60, 40))}, "window of the scan"),
        ({"surface": np.full((60, 41), np.nan)}, "surface of the scan: received 2460 of 2460 points without"),
        ({"surface": np.zeros(60)}, r"surface of the scan: received an array \(60,\)"),
        (
            {"surface": HeightMap(np.zeros((60, 41)), 2 * DX)},
            "1e-05 × 1e-05 m apart; allowed: 5e-06 × 5e-06 m",
        ),
        ({"body": np.zeros(41)}, "body of the scan"),
        (
            {"body": ball(39)},
            r"body of the scan: .*allowed: a finite array of the half-space's shape \(41, 41\)",
        ),
        ({"body": np.full((41, 41), np.inf)}, "body of the scan"),
        ({"approaches": [0.2e-6, 0.1e-6]}, "approaches of the scan"),
        ({"approaches": []}, "approaches of the scan"),
        ({"stride": 0}, "stride of the scan"),
        ({"rtol": 1.0}, "rtol: received 1.0"),
        ({"force_accuracy": 0.2}, "force_accuracy: received 0.2; allowed: a number above 0, at most 0.1"),
        (
            {"force_accuracy": 1e-4, "rtol": 1e-6},
            "rtol and force_accuracy: received both; allowed: one of them",
        ),
    ],
)
def test_bad_input(change, message):
    keywords = {"surface": np.zeros((60, 41)), "body": ball(41), "approaches": [0.1e-6]}
    with pytest.raises(InputError, match=message):
        half_space().scan(**(keywords | change))


def test_the_example_of_a_scan_holds():
    """A crest of 50 nm lifts the force above Hertz's on the plane, 1.37 N, a trough lowers it."""
    found = doctest.testmod(halfspace)
    assert found.attempted >= 6
    assert found.failed == 0
    assert 1.03 < Hertz(MODULUS, RADIUS, RADIUS).force(0.2e-6) < 1.75


def test_a_height_map_is_scanned_like_its_heights():
    heights = rough(50, 41)
    found = half_space().scan(HeightMap(heights, DX), ball(41), [0.2e-6], 3)
    assert found.equals(half_space().scan(heights, ball(41), [0.2e-6], stride=3))


def test_a_force_accuracy_is_the_tolerance_of_a_case():
    """1e-3 of the force asks for a residual of 4e-4, and is had."""
    heights = rough(50, 41)
    found = half_space().scan(heights, ball(41), [0.2e-6], force_accuracy=1e-3)
    assert found.equals(half_space().scan(heights, ball(41), [0.2e-6], rtol=1e-3 / 2.5))
    assert not found.equals(half_space().scan(heights, ball(41), [0.2e-6]))
    tight = half_space().scan(heights, ball(41), [0.2e-6], rtol=1e-10)
    np.testing.assert_allclose(found, tight, rtol=1e-3)


@pytest.mark.parametrize("hardness", [None, 1e9])
@pytest.mark.parametrize("rtol", [4e-5, 4e-6])
def test_single_precision_is_as_accurate_as_the_tolerance(monkeypatch, hardness, rtol):
    heights, approaches = rough(120, 41), [0.05e-6, 0.15e-6, 0.3e-6]
    scans = []
    for pays, tolerance in ((np.inf, 1e-10), (np.inf, rtol), (0.0, rtol)):
        monkeypatch.setattr("asperity.contact.scan.SINGLE_PAYS", pays)
        scans.append(scan_forces(job(heights, approaches, hardness, rtol=tolerance)))
    exact, double, single = scans
    assert single.counts.unconverged == 0
    assert (double.single, single.single) == (False, True)
    assert not np.array_equal(single.forces, double.forces)
    assert single.counts.iterations <= 1.03 * double.counts.iterations
    np.testing.assert_allclose(single.forces, exact.forces, rtol=2.5 * rtol, atol=0.0)


def test_tight_tolerances_and_short_scans_stay_in_double():
    """At 41 × 41 cells and two approaches, 2e9 cells are 595 000 positions."""
    for positions, rtol, single in [(600000, 4e-6, True), (600000, 1e-6, False), (590000, 4e-6, False)]:
        flat = np.broadcast_to(0.0, (positions + 40, 41))
        assert job(flat, [0.1e-6, 0.2e-6], rtol=rtol).single == single


@pytest.mark.parametrize("stride", [1, 3])
@pytest.mark.parametrize("form", ["ball", "flat", "any"])
def test_first_touch_is_that_of_every_cell(monkeypatch, stride, form):
    """The least gap of all cells of the window, position by position, to the bit: on a slope, with a hole."""
    monkeypatch.setattr(scan, "TOUCHED", 50)
    rng = np.random.default_rng(3)
    surface = 1e-6 * rng.standard_normal((200, 15)) + 1e-6 * np.arange(200)[:, None]
    surface[90:120] -= 50e-6
    x, y = np.mgrid[-7:8, -7:8] * 1e-4
    body = {"ball": (x**2 + y**2) / 0.02, "flat": 0.0 * x, "any": 1e-5 * rng.random(x.shape)}[form]
    expected = [np.min(body - surface[first : first + 15]) for first in range(0, 186, stride)]
    np.testing.assert_array_equal(first_touch(surface, body, stride), expected)
