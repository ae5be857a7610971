"""Scans of long paths: memory does not grow, a scan goes on, stored forces are those in memory."""

import gc
import tracemalloc

import numpy as np
import pytest

from asperity import HalfSpace
from asperity.contact.scan import ScanJob, first_touch, scan_forces
from asperity.errors import ComputationError
from asperity.reduction.table import ForceTable, scan_into
from asperity.reduction.texture import areal_texture
from asperity.store import Store
from asperity.surfaces.strip import LongStrip

DX, MODULUS, RADIUS, N = 5e-6, 115e9, 3e-3, 15
APPROACHES = [0.0, 0.02e-6, 0.05e-6]


def body(n=N):
    x = (np.arange(n) - n // 2) * DX
    return (x[:, None] ** 2 + x[None, :] ** 2) / (2 * RADIUS)


def strip(rows):
    def piece(count, seed):
        return 0.02e-6 * np.random.default_rng(seed).standard_normal((count, N))

    return LongStrip((rows, N), (DX, DX), piece, 1, stride=400, blend=20)


def job(rows, **details):
    return ScanJob(HalfSpace((N, N), DX, MODULUS), strip(rows), body(), np.array(APPROACHES), **details)


@pytest.fixture
def short_blocks(monkeypatch):
    monkeypatch.setattr("asperity.contact.scan.BLOCK", 16)


@pytest.mark.usefixtures("short_blocks")
@pytest.mark.parametrize("anchor", [0, 1, 47, 48, 290])
def test_positions_and_blocks_count_from_the_anchor(anchor, tmp_path):
    """Against a tight scan of every row from the first on: each position is a row, in any blocks."""
    every = scan_forces(job(300, rtol=1e-10, device=None)).forces
    path = job(300, stride=3, anchor=anchor, rtol=1e-10, device=None)
    held, stored = scan_forces(path), scan_into(Store(tmp_path), path)
    expected = every[:, anchor % 3 :: 3]
    assert anchor // 3 in path.starts or anchor // 3 >= path.positions
    assert stored.forces.shape == held.forces.shape == expected.shape
    np.testing.assert_allclose(held.forces, expected, rtol=1e-7, atol=1e-9 * every.max())
    for first, stop in [(0, 95), (0, 1), (10, 40), (15, 17), (80, 200), (7, 7)]:
        assert np.array_equal(stored.forces.columns(first, stop), held.forces[:, first:stop])
    assert stored.counts == held.counts
    assert held.counts.solved == np.count_nonzero(held.forces)


@pytest.mark.usefixtures("short_blocks")
def test_a_table_of_stored_forces_is_that_of_held_ones_until_they_are_cleared_away(tmp_path, monkeypatch):
    path, store = job(300), Store(tmp_path)
    held = ForceTable(scan_forces(path).forces, APPROACHES, 0.0, DX, np.zeros(path.positions))
    at = np.linspace(0.0, 285 * DX, 700)
    expected = held.at(at)
    monkeypatch.setattr("asperity.reduction.table.PIECE", 50)
    stored = ForceTable(scan_into(store, path).forces, APPROACHES, 0.0, DX, np.zeros(path.positions))
    np.testing.assert_allclose(stored.at(at), expected, rtol=1e-11, atol=1e-12)
    np.testing.assert_allclose(stored.at(at[::-1])[::-1], expected, rtol=1e-11, atol=1e-12)
    for file in store.files():
        file.unlink()
    with pytest.raises(ComputationError, match="no longer in the cache"):
        stored.at(at)


MORE = 6000  # rows


def peak(work):
    """How much more memory a path takes that is longer by `MORE`: less of two, as others may take some."""
    work(400)  # compiles
    peaks = []
    for rows in (2000, 2000 + MORE):
        tries = []
        for _ in range(2):
            gc.collect()
            tracemalloc.start()
            work(rows)
            tries.append(tracemalloc.get_traced_memory()[1])
            tracemalloc.stop()
        peaks.append(min(tries))
    return peaks[1] - peaks[0]


def test_lines_of_a_path_are_made_in_pieces(monkeypatch):
    monkeypatch.setattr("asperity.reduction.texture.PIECE", 500)
    monkeypatch.setattr("asperity.contact.scan.TOUCHED", 500)
    given_ = (DX, DX), [0.0, 1e-6], [(20e-6, 20e-6), (30e-6, 35e-6)]

    def work(rows):
        areal_texture(strip(rows), *given_)
        first_touch(strip(rows), body())

    assert peak(work) < 40 * MORE
    whole, pieces = strip(2000).rows(0, 2000), areal_texture(strip(2000), *given_).heights
    monkeypatch.setattr("asperity.reduction.texture.PIECE", 5000)
    np.testing.assert_allclose(pieces, areal_texture(whole, *given_).heights, rtol=0, atol=1e-20)
    assert np.array_equal(first_touch(strip(2000), body()), first_touch(whole, body()))


def counted(solved, solve=ScanJob.solve):
    """Solution of a block that tells of the number of its contacts."""

    def told(*block):
        found = solve(*block)
        solved.append(found["counts"][0])
        return found

    return told


@pytest.mark.usefixtures("short_blocks")
def test_a_longer_scan_goes_on_with_nothing_recomputed_that_was_kept(tmp_path, monkeypatch):
    store, solved, kept, positions = Store(tmp_path), [], 64, 96
    scan_into(store, job(kept + N - 1), workers=1)
    monkeypatch.setattr(ScanJob, "solve", counted(solved))
    resumed = scan_into(store, job(positions + N - 1), workers=1).forces.columns(0, positions)
    assert sum(solved) == np.count_nonzero(resumed[:, kept:])
    assert np.array_equal(resumed, scan_forces(job(positions + N - 1), workers=2).forces)
