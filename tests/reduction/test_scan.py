"""The quasi-static scan: geometry, signs, caching and messages; long paths, whose memory does not grow."""

import gc
import tempfile
import tracemalloc

import numpy as np
import pytest

from asperity import HalfSpace, HeightMap
from asperity.contact import scan
from asperity.contact.pressed import block_of, solve_block
from asperity.contact.scan import ScanJob, first_touch, scan_forces
from asperity.errors import TruncatedContactWarning, UnconvergedWarning
from asperity.reduction.stiffness import ForceTable
from asperity.reduction.texture import areal_texture
from asperity.store import Store, content_key
from asperity.surfaces.strip import Rows
from asperity.surfaces.synthesis import long_self_affine, self_affine

DX, MODULUS, RADIUS = 5e-6, 115e9, 10e-3


def ball(n=41, radius=RADIUS):
    x = (np.arange(n) - n // 2) * DX
    return (x[:, None] ** 2 + x[None, :] ** 2) / (2 * radius)


def half_space(n=41, hardness=None, modulus=MODULUS):
    return HalfSpace((n, n), DX, modulus, hardness)


def job(heights, approaches, hardness=None, modulus=MODULUS, **details):
    space = half_space(41, hardness, modulus)
    return ScanJob(space, Rows(heights), ball(), np.array(approaches), **details)


def rough(n, ny=41, seed=0, rms=0.05e-6):
    return rms * np.random.default_rng(seed).standard_normal((n, ny))


@pytest.mark.parametrize("stride", [1, 3])
def test_each_position_is_a_contact_of_its_own(stride):
    """Of the body on the rows from m on, at approaches from the mean plane."""
    heights, approaches = rough(60) + 1e-6, [0.1e-6, 0.3e-6]
    forces = half_space().scan(heights, ball(), approaches, stride, rtol=1e-9)
    assert forces.dims == ("approach", "position")
    np.testing.assert_allclose(forces.position, DX * np.arange(0, 20, stride))
    for m in range(0, 20, 6):
        gap = ball() - (heights - heights.mean())[m : m + 41]
        for i, approach in enumerate(approaches):
            alone = half_space().solve(gap, approach=approach, rtol=1e-9).force
            assert forces.values[i, m // stride] == pytest.approx(alone, rel=1e-7)
    of_map = half_space().scan(HeightMap(heights, DX), ball(), approaches, stride, rtol=1e-9)
    assert of_map.equals(forces)


def test_a_contact_that_stays_as_it_is_soon_takes_no_iteration():
    """A ball on a plane: the patch stays in the window, where asperities would move with the surface."""
    few, many = (half_space().scan(np.zeros((n, 41)), ball(), [0.2e-6, 0.3e-6]) for n in (44, 60))
    # the first two meet the tolerance in the force, the next in the pressure
    assert few.sizes["position"] == 4
    assert many.attrs["iterations"] == few.attrs["iterations"]


@pytest.mark.parametrize("stride", [1, 3])
def test_of_the_window_is_looked_at_what_may_overlap(stride):
    """With cells around it, so that no digit depends on how much that is."""
    heights, approaches = rough(70), np.array([0.02e-6, 0.05e-6])
    scanned = job(heights, approaches, rtol=4e-6, stride=stride)
    along, across = scanned.touched(float(heights.max()))
    assert 0 < across.start < across.stop < 41
    assert along.start > 0
    assert (ball()[: along.start + 2] - heights.max() > approaches[-1]).all()
    space = half_space()
    planes = np.zeros(scanned.positions)
    whole = block_of(space, heights, ball(), planes, approaches, stride, 4e-6, forces_alone=True)
    solve_block(space, whole)
    assert np.array_equal(scan_forces(scanned).forces, whole.totals * space.cell_area)
    assert scanned.touched(-1e-3) == (slice(0, 1), slice(0, 1))


@pytest.mark.parametrize("stride", [1, 3])
@pytest.mark.parametrize(("cells", "hardness"), [("whole", None), ("whole", 1e9), ("covered", None)])
def test_forces_alone_are_as_exact_as_with_pressures_for_less(stride, cells, hardness):
    """And what an approach adds to the pressure, by which they are, adds up to the tangent stiffness."""
    space = HalfSpace((41, 41), DX, MODULUS, hardness, cells=cells)
    waves = {"hurst": 0.8, "longest": 20 * DX, "shortest": 4 * DX, "seed": 1}
    surface = self_affine((41 + 60 * stride, 41), (DX, DX), rms=0.05e-6, **waves).heights
    asked = np.array(surface), ball(), np.zeros(61), np.array([0.2e-6, 0.3e-6]), stride
    exact = solve_block(space, block_of(space, *asked, 1e-9)).totals
    pressed = solve_block(space, block_of(space, *asked, 4e-5))
    alone = solve_block(space, block_of(space, *asked, 4e-5, forces_alone=True))
    known, found = (np.abs(each.totals / exact - 1.0) for each in (pressed, alone))
    assert known.max() < 4e-5
    assert found.max() < 4e-5
    assert np.sqrt(np.mean(found**2)) < 1e-5
    assert alone.counts[1] < 0.87 * pressed.counts[1]
    assert alone.counts[2] == 0
    for pressure, rise in zip(alone.pressures[0], alone.rises, strict=True):
        assert not rise[(pressure == 0.0) | (pressure >= space.pressure_cap)].any()
        assert rise.sum() * space.cell_area == pytest.approx(space.tangent_stiffness(pressure), rel=0.06)


def test_planes_shift_the_approach_of_each_position():
    heights, planes = rough(44), np.array([0.0, 0.1e-6, -0.05e-6, 0.2e-6])
    shifted = scan_forces(job(heights, [0.1e-6], rtol=1e-9, planes=planes)).forces[0]
    for m, plane in enumerate(planes):
        alone = scan_forces(job(heights[m : m + 41], [0.1e-6 - plane], rtol=1e-9))
        assert shifted[m] == pytest.approx(alone.forces[0, 0], rel=1e-7)


@pytest.mark.parametrize(("hardness", "pays"), [(None, np.inf), (1e9, np.inf), (None, 0.0)])
def test_workers_do_not_change_a_digit(monkeypatch, hardness, pays):
    monkeypatch.setattr("asperity.contact.scan.BLOCK", 7)
    monkeypatch.setattr("asperity.contact.scan.SINGLE_PAYS", pays)
    scanned = job(rough(70), [0.1e-6, 0.2e-6], hardness, rtol=4e-6)
    one, two = (scan_forces(scanned, workers=n) for n in (1, 2))
    assert one.single == two.single == (pays == 0.0)
    assert np.array_equal(one.forces, two.forces)
    assert one.counts == two.counts


def test_the_cache_knows_what_the_force_depends_on():
    known = {"heights": rough(44), "approaches": [0.2e-6]}
    changes = [
        {}, {"modulus": 1e11}, {"approaches": [0.1e-6]}, {"hardness": 1e9}, {"rtol": 1e-5}, {"stride": 2},
        {"planes": 1e-9}, {"heights": rough(44, seed=1)},
    ]  # fmt: skip
    paths = [job(**known | change) for change in changes]
    assert len({path.key(*path.under(0)) for path in paths}) == len(changes)


def test_kept_blocks_have_the_names_that_caches_know():
    """A cache of years keeps its worth: the name is made of these parts, in this order."""
    path = job(rough(44), [0.2e-6], 1e9, stride=2, rtol=4e-5, planes=1e-9)
    parameters = [[DX, DX], MODULUS, 1e9, 2, 4e-5]
    parts = rough(44)[:43], ball(), np.array([0.2e-6]), np.full(2, 1e-9), parameters
    assert path.key(*path.under(0)) == content_key("scan", *parts)


def test_flaws_are_warned_of(monkeypatch):
    cut_off = r"4 of 4 .* \(100 %\) .* A window of 0\.1\d+ mm holds them"
    with pytest.warns(TruncatedContactWarning, match=cut_off):
        half_space(21).scan(np.zeros((24, 21)), ball(21), [0.5e-6])
    monkeypatch.setattr("asperity.contact.pressed.MAX_ITERATIONS", 1)
    with pytest.warns(UnconvergedWarning, match="4 of 4 contact solutions of the scan.* larger rtol"):
        forces = half_space().scan(rough(44), ball(), [0.2e-6])
    assert forces.attrs["unconverged"] == 4
    with pytest.warns(UnconvergedWarning, match="Try a larger force_accuracy"):
        half_space().scan(rough(44), ball(), [0.2e-6], force_accuracy=1e-5)


@pytest.mark.parametrize("hardness", [None, 1e9])
@pytest.mark.parametrize("rtol", [4e-5, 4e-6])
def test_single_precision_is_as_accurate_as_the_tolerance(monkeypatch, hardness, rtol):
    heights, approaches = rough(120), [0.05e-6, 0.15e-6, 0.3e-6]
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
    """At 41 × 41 cells, 3e7 cells are 17 847 positions, at however many approaches."""
    for positions, rtol, single in [(18000, 4e-6, True), (18000, 1e-6, False), (17800, 4e-6, False)]:
        flat = np.broadcast_to(0.0, (positions + 40, 41))
        for approaches in ([0.1e-6], [0.1e-6, 0.2e-6]):
            assert job(flat, approaches, rtol=rtol).single == single


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


# --- long paths

N, APPROACHES = 15, [0.0, 0.02e-6, 0.05e-6]


def strip(rows):
    waves = {"rms": 0.02e-6, "hurst": 0.5, "longest": 20 * DX, "shortest": 2 * DX}
    return long_self_affine((rows, N), (DX, DX), **waves, seed=1)


def along(rows, **details):
    return ScanJob(half_space(N), strip(rows), ball(N, 3e-3), np.array(APPROACHES), **details)


@pytest.fixture
def short_blocks(monkeypatch):
    monkeypatch.setattr("asperity.contact.scan.BLOCK", 16)


@pytest.mark.usefixtures("short_blocks")
@pytest.mark.parametrize("anchor", [0, 1, 47, 48, 290])
def test_positions_and_blocks_count_from_the_anchor(anchor, tmp_path):
    """Against a tight scan of every row from the first on: each position is a row, in any blocks."""
    every = scan_forces(along(300, rtol=1e-10, device=None)).forces
    path = along(300, stride=3, anchor=anchor, rtol=1e-10, device=None)
    held, mapped = scan_forces(path), scan_forces(path, mapped=True, cache=Store(tmp_path))
    expected = every[:, anchor % 3 :: 3]
    assert anchor // 3 in path.starts or anchor // 3 >= path.positions
    assert held.forces.shape == expected.shape
    np.testing.assert_allclose(held.forces, expected, rtol=1e-7, atol=1e-9 * every.max())
    assert np.array_equal(mapped.forces, held.forces)
    assert mapped.counts == held.counts
    assert held.counts.solved == np.count_nonzero(held.forces)


def test_a_table_is_read_in_pieces_and_in_memory_where_no_file_is_written(monkeypatch):
    path, at = along(300), np.linspace(0.0, 285 * DX, 700)

    def table(**how):
        return ForceTable(scan_forces(path, **how).forces, APPROACHES, 0.0, DX, np.zeros(path.positions))

    expected = table().at(at)
    monkeypatch.setattr("asperity.reduction.stiffness.PIECE", 50)
    mapped = table(mapped=True)
    np.testing.assert_allclose(mapped.at(at), expected, rtol=1e-11, atol=1e-12)
    np.testing.assert_allclose(mapped.at(at[::-1])[::-1], expected, rtol=1e-11, atol=1e-12)
    assert isinstance(mapped.forces.base, np.memmap)
    monkeypatch.setattr(tempfile, "tempdir", "/no such folder")
    assert np.array_equal(table(mapped=True).forces, mapped.forces)


MORE = 6000  # rows


def peak(work, rows):
    """Least memory of two times: others may take some."""
    tries = []
    for _ in range(2):
        gc.collect()
        tracemalloc.start()
        work(rows)
        tries.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    return min(tries)


def test_lines_of_a_path_are_made_in_pieces(monkeypatch):
    monkeypatch.setenv("ASPERITY_THREADS", "1")  # each holds a piece
    monkeypatch.setattr("asperity.reduction.texture.PIECE", 500)
    monkeypatch.setattr("asperity.contact.scan.TOUCHED", 500)
    given_ = (DX, DX), [0.0, 1e-6], [(20e-6, 20e-6), (30e-6, 35e-6)]

    def work(rows):
        areal_texture(strip(rows), *given_)
        first_touch(strip(rows), ball(N, 3e-3))

    work(400)  # compiles
    assert peak(work, 2000 + MORE) - peak(work, 2000) < 40 * MORE
    whole, pieces = strip(2000).rows(0, 2000), areal_texture(strip(2000), *given_).heights
    monkeypatch.setattr("asperity.reduction.texture.PIECE", 5000)
    np.testing.assert_allclose(pieces, areal_texture(whole, *given_).heights, rtol=0, atol=1e-20)
    assert np.array_equal(first_touch(strip(2000), ball(N, 3e-3)), first_touch(whole, ball(N, 3e-3)))


@pytest.mark.usefixtures("short_blocks")
def test_a_longer_scan_goes_on_with_nothing_recomputed_that_was_kept(tmp_path, monkeypatch):
    store, solved, kept, positions, solve = Store(tmp_path), [], 64, 96, ScanJob.solve
    scan_forces(along(kept + N - 1), cache=store, workers=1)
    monkeypatch.setattr(ScanJob, "solve", lambda *block: solved.append(solve(*block)) or solved[-1])
    resumed = scan_forces(along(positions + N - 1), cache=store, workers=1).forces
    assert sum(block["counts"][0] for block in solved) == np.count_nonzero(resumed[:, kept:])
    assert np.array_equal(resumed, scan_forces(along(positions + N - 1), workers=2).forces)
