"""Processes that solve blocks: the same digits as here, and nothing lost if they go."""

import numpy as np
import pytest

from asperity.reduction import blocks
from asperity.reduction.scan import scan_forces

DX, MODULUS, RADIUS, N = 5e-6, 115e9, 3e-3, 21


def scanned(workers, hardness=None):
    x = (np.arange(N) - N // 2) * DX
    body = (x[:, None] ** 2 + x[None, :] ** 2) / (2 * RADIUS)
    heights = 0.03e-6 * np.random.default_rng(1).standard_normal((200 + N, N))
    planes = 0.01e-6 * np.sin(np.arange(101))
    return scan_forces(
        heights, (DX, DX), body, MODULUS, [0.0, 0.05e-6, 0.1e-6], hardness,
        stride=2, rtol=1e-5, planes=planes, workers=workers,
    )  # fmt: skip


@pytest.fixture
def started(monkeypatch):
    """Processes from the second block of each thread on; returns them."""
    found = []

    class Recorded(blocks.Worker):
        def __init__(self, *arguments):
            super().__init__(*arguments)
            found.append(self)

    monkeypatch.setattr("asperity.reduction.scan.BLOCK", 8)
    monkeypatch.setattr(blocks, "PAYS", 0.0)
    monkeypatch.setattr(blocks, "Worker", Recorded)
    return found


@pytest.mark.parametrize("hardness", [None, 1e9])
def test_processes_change_no_digit(started, hardness):
    alone = scanned(1, hardness)
    assert not started
    together = scanned(2, hardness)
    assert 1 <= len(started) <= 2
    assert all(worker._process.returncode == 0 for worker in started)
    assert np.array_equal(together.forces, alone.forces)
    assert (together.solved, together.iterations) == (alone.solved, alone.iterations)


def test_work_of_a_process_that_is_gone_is_done_here(started, monkeypatch):
    alone = scanned(1)
    original = blocks.Worker.solve

    def solve(worker, rows, planes):
        worker._process.kill()
        worker._process.wait()
        return original(worker, rows, planes)

    monkeypatch.setattr(blocks.Worker, "solve", solve)
    assert np.array_equal(scanned(2).forces, alone.forces)
    assert started
