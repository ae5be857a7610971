"""Scans of long paths: memory does not grow, a scan goes on, mapped forces are those in memory."""

import gc
import tempfile
import tracemalloc

import numpy as np
import pytest

from asperity import HalfSpace
from asperity.contact.scan import ScanJob, first_touch, scan_forces
from asperity.reduction.stiffness import ForceTable
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
    held, mapped = scan_forces(path), scan_forces(path, mapped=True, cache=Store(tmp_path))
    expected = every[:, anchor % 3 :: 3]
    assert anchor // 3 in path.starts or anchor // 3 >= path.positions
    assert held.forces.shape == expected.shape
    np.testing.assert_allclose(held.forces, expected, rtol=1e-7, atol=1e-9 * every.max())
    assert np.array_equal(mapped.forces, held.forces)
    assert mapped.counts == held.counts
    assert held.counts.solved == np.count_nonzero(held.forces)


def test_a_table_is_read_in_pieces_and_in_memory_where_no_file_is_written(monkeypatch):
    path, at = job(300), np.linspace(0.0, 285 * DX, 700)

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
    scan_forces(job(kept + N - 1), cache=store, workers=1)
    monkeypatch.setattr(ScanJob, "solve", counted(solved))
    resumed = scan_forces(job(positions + N - 1), cache=store, workers=1).forces
    assert sum(solved) == np.count_nonzero(resumed[:, kept:])
    assert np.array_equal(resumed, scan_forces(job(positions + N - 1), workers=2).forces)
