"""Scans of long paths: memory does not grow, a killed scan goes on, stored forces are those in memory."""

import gc
import os
import signal
import subprocess
import sys
import time
import tracemalloc
from dataclasses import replace
from itertools import count

import numpy as np
import pytest

from asperity.contact import HalfSpace
from asperity.contact.scan import ScanJob, first_touch, scan_forces
from asperity.errors import ComputationError, InputError
from asperity.reduction.stiffness import stiffness_ensemble
from asperity.reduction.table import ForceTable, scan_into
from asperity.reduction.texture import areal_texture
from asperity.store import Store
from asperity.surfaces.strip import LongStrip, Rows
from asperity.threads import in_order

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
def test_stored_forces_are_those_in_memory(tmp_path):
    path = job(300, stride=3, planes=0.01e-6 * np.sin(np.arange(96)))
    held = scan_forces(replace(path, surface=Rows(path.surface.rows(0, 300))))
    stored = scan_into(Store(tmp_path), path)
    assert stored.forces.shape == held.forces.shape == (3, 96)
    for first, stop in [(0, 96), (0, 16), (15, 17), (40, 41), (80, 200), (7, 7)]:
        assert np.array_equal(stored.forces.columns(first, stop), held.forces[:, first:stop])
    assert stored.counts == held.counts
    assert held.counts.solved == np.count_nonzero(held.forces)


@pytest.mark.usefixtures("short_blocks")
@pytest.mark.parametrize("anchor", [0, 1, 47, 48, 100, 290])
def test_positions_and_blocks_count_from_the_anchor(anchor, tmp_path):
    """Against a tight scan of every row from the first on: each position is a row, in any blocks."""
    every = scan_forces(job(300, rtol=1e-10, device=None)).forces
    path = job(300, stride=3, anchor=anchor, rtol=1e-10, device=None)
    stored = scan_into(Store(tmp_path), path).forces
    expected = every[:, anchor % 3 :: 3]
    assert anchor // 3 in path.starts or anchor // 3 >= path.positions
    assert stored.shape == expected.shape
    scale = every.max()
    for first, stop in [(0, 95), (0, 1), (10, 40), (15, 17), (80, 200), (7, 7)]:
        found = stored.columns(first, stop)
        np.testing.assert_allclose(found, expected[:, first:stop], rtol=1e-7, atol=1e-9 * scale)


@pytest.mark.usefixtures("short_blocks")
def test_a_table_of_stored_forces_is_that_of_held_ones(tmp_path, monkeypatch):
    path = job(300)
    held = ForceTable(scan_forces(path).forces, APPROACHES, 0.0, DX)
    monkeypatch.setattr("asperity.reduction.table.PIECE", 50)
    stored = ForceTable(scan_into(Store(tmp_path), path).forces, APPROACHES, 0.0, DX)
    at = np.linspace(0.0, 285 * DX, 700)
    np.testing.assert_allclose(stored.at(at), held.at(at), rtol=1e-11, atol=1e-12)
    np.testing.assert_allclose(stored.at(at[::-1])[::-1], held.at(at), rtol=1e-11, atol=1e-12)


@pytest.mark.usefixtures("short_blocks")
def test_forces_that_were_cleared_away_are_missed(tmp_path):
    store = Store(tmp_path)
    stored = scan_into(store, job(60))
    for file in store.files():
        file.unlink()
    with pytest.raises(ComputationError, match="no longer in the cache"):
        stored.forces.columns(0, 5)


@pytest.mark.usefixtures("short_blocks")
@pytest.mark.parametrize("workers", [2, 3, 8])
def test_workers_change_no_digit_of_scans_and_samples(tmp_path, workers):
    path = job(400)
    alone = scan_into(Store(tmp_path / "1"), path, workers=1)
    together = scan_into(Store(tmp_path / "n"), path, workers=workers)
    assert together.forces.keys == alone.forces.keys
    for one, other in zip(Store(tmp_path / "1").files(), Store(tmp_path / "n").files(), strict=True):
        assert one.name == other.name
        with np.load(one) as a, np.load(other) as b:
            assert all(np.array_equal(a[name], b[name]) for name in ("forces", "counts"))
    samples = [path.surface.rows(20 * i, 20 * i + N) for i in range(9)]
    curves = [
        stiffness_ensemble(samples, path.half_space, path.body, path.approaches, 0.1e-6, workers=w)
        for w in (1, workers)
    ]
    assert np.array_equal(curves[0].forces, curves[1].forces)


def peak(work):
    """The most memory of a short path and of a long one: least of three, as others may take some."""
    work(400)  # compiles
    peaks = []
    for rows in (4000, 24000):
        tries = []
        for _ in range(3):
            gc.collect()
            tracemalloc.start()
            work(rows)
            tries.append(tracemalloc.get_traced_memory()[1])
            tracemalloc.stop()
        peaks.append(min(tries))
    return peaks


def test_memory_does_not_grow_with_the_path(tmp_path, monkeypatch):
    """Beyond a few bytes a position (names of blocks, planes); the strip alone would take 120 a row."""
    monkeypatch.setattr("asperity.contact.scan.BLOCK", 64)
    stores = (Store(tmp_path / str(n)) for n in count())
    monkeypatch.setattr(ScanJob, "solve", overlaps)
    short, long = peak(lambda rows: scan_into(next(stores), job(rows), workers=1))
    assert long - short < 12 * 20000


def overlaps(job, rows, planes):
    """Instead of contacts: something that costs nothing."""
    largest = [(rows[m : m + N] - job.body).max() - plane for m, plane in enumerate(planes)]
    return np.maximum(np.add.outer(job.approaches, largest), 0.0), np.zeros(4, dtype=np.int64)


def test_lines_of_a_path_are_made_in_pieces(monkeypatch):
    monkeypatch.setattr("asperity.reduction.texture.PIECE", 500)
    monkeypatch.setattr("asperity.contact.scan.TOUCHED", 500)
    axes = [(20e-6, 20e-6), (30e-6, 35e-6)]

    def work(rows):
        areal_texture(strip(rows), (DX, DX), [0.0, 1e-6], axes)
        first_touch(strip(rows), body())

    short, long = peak(work)
    assert long - short < 40 * 20000
    whole = strip(2000).rows(0, 2000)
    pieces = areal_texture(strip(2000), (DX, DX), [0.0, 1e-6], axes).heights
    monkeypatch.setattr("asperity.reduction.texture.PIECE", 5000)
    np.testing.assert_allclose(
        pieces, areal_texture(whole, (DX, DX), [0.0, 1e-6], axes).heights, rtol=0, atol=1e-20
    )
    assert np.array_equal(first_touch(strip(2000), body()), first_touch(whole, body()))


SCRIPT = """
import sys
import numpy as np
from asperity.contact import scan
from asperity.reduction.table import scan_into
from asperity.store import Store
sys.path.insert(0, {folder!r})
from test_long_scan import job
scan.BLOCK = 16
scan_into(Store({root!r}), job(1000000), workers=1)
"""


def counted(solved, solve=ScanJob.solve):
    """Solution of a block that tells of the number of its contacts."""

    def told(*block):
        forces, counts = solve(*block)
        solved.append(counts[0])
        return forces, counts

    return told


def test_a_killed_scan_goes_on_with_nothing_recomputed_but_the_last_block(tmp_path, monkeypatch):
    script = SCRIPT.format(folder=os.path.dirname(__file__), root=str(tmp_path))
    scanning = subprocess.Popen([sys.executable, "-c", script])
    store = Store(tmp_path)
    try:
        give_up = time.monotonic() + 60
        while len(store.files()) < 4 and scanning.poll() is None and time.monotonic() < give_up:
            time.sleep(0.01)
    finally:
        scanning.send_signal(signal.SIGKILL)
        scanning.wait()
    kept = len(store.files())
    assert kept >= 4
    solved = []
    monkeypatch.setattr("asperity.contact.scan.BLOCK", 16)
    monkeypatch.setattr(ScanJob, "solve", counted(solved))
    positions = 16 * (kept + 2)
    resumed = scan_into(store, job(positions + N - 1), workers=1)
    again = np.count_nonzero(resumed.forces.columns(16 * kept, positions))
    assert sum(solved) == again  # the two blocks beyond the last kept one, and no other
    fresh = scan_forces(job(positions + N - 1), workers=2)
    assert np.array_equal(resumed.forces.columns(0, positions), fresh.forces)


def test_results_come_in_order_and_few_are_held():
    begun = []

    def task(i):
        begun.append(i)
        time.sleep(0.001 * (i % 3))
        return i

    results = in_order(task, range(1000), workers=3)
    assert [next(results) for _ in range(20)] == list(range(20))
    assert len(begun) <= 20 + 2 * 3 + 1
    results.close()
    assert len(begun) <= 20 + 2 * 3 + 1


def test_an_error_in_a_task_comes_out():
    def task(i):
        raise InputError("task", i, "none")

    with pytest.raises(InputError, match="task"):
        list(in_order(task, range(9), workers=2))
