"""The scan in batches against the scan position by position."""

import os
import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner

from asperity import HalfSpace
from asperity.cli import main
from asperity.contact.batched import choose_device, find_device, gpu, processor
from asperity.contact.scan import ScanJob, scan_forces
from asperity.errors import InputError
from asperity.surfaces.strip import Rows

DX = 5e-6
MODULUS = 115e9
RADIUS = 10e-3


def ball(n):
    x = (np.arange(n) - n // 2) * DX
    return (x[:, None] ** 2 + x[None, :] ** 2) / (2 * RADIUS)


@pytest.fixture(params=["numpy", "gpu"])
def device(request):
    if request.param == "gpu":
        try:
            return gpu()
        except InputError as reason:
            pytest.skip(str(reason))
    return processor()


@pytest.mark.parametrize(("stride", "cells", "hardness"), [(1, 41, None), (3, 41, 1e9), (2, 15, None)])
def test_block_agrees_with_the_scan(device, stride, cells, hardness):
    """The window of 15 cells cuts the contact off."""
    heights = 0.05e-6 * np.random.default_rng(2).standard_normal((cells + 40, cells))
    approaches = np.array([-0.1e-6, 0.1e-6, 0.3e-6])
    planes = 0.02e-6 * np.sin(np.arange(40 // stride + 1))
    job = ScanJob(
        HalfSpace((cells, cells), DX, MODULUS, hardness), Rows(heights), ball(cells), approaches, stride,
        1e-11, planes, device=None,
    )  # fmt: skip
    reference, found = scan_forces(job), scan_forces(replace(job, device=device))
    np.testing.assert_allclose(found.forces, reference.forces, rtol=1e-9)
    assert found.counts.iterations > 0
    assert found.counts.solved == reference.counts.solved == np.count_nonzero(reference.forces)
    assert found.counts.unconverged == reference.counts.unconverged == 0
    assert found.counts.truncated == reference.counts.truncated
    assert bool(reference.counts.truncated) == (cells == 15)


def scan(cells, **keywords):
    heights = 0.05e-6 * np.random.default_rng(3).standard_normal((90, cells))
    return HalfSpace((cells, cells), DX, MODULUS).scan(heights, ball(cells), [0.0, 0.2e-6], **keywords)


def test_scan_on_a_device_agrees_and_keeps_its_own_blocks(monkeypatch):
    """Blocks of the device are longer, and not taken for those of the processor."""
    kept = {}
    cache = SimpleNamespace(get=kept.get, put=kept.__setitem__)
    alone = scan(31, rtol=1e-11, cache=cache)
    monkeypatch.setattr("asperity.contact.public_scan.find_device", lambda name: processor())
    monkeypatch.setattr("asperity.contact.scan.BATCH", 32)
    together = scan(31, rtol=1e-11, cache=cache, device="gpu")
    np.testing.assert_allclose(together, alone, rtol=1e-9)
    assert len(kept) == 1 + 2
    kept_then = dict(kept)
    assert scan(31, rtol=1e-11, cache=cache, device="gpu").equals(together)
    assert kept == kept_then


def test_scan_on_the_gpu(device):
    if device.name.startswith("processor"):
        pytest.skip("stands for the scan on a real GPU")
    found = scan(31, rtol=1e-11, device="gpu")
    np.testing.assert_allclose(found, scan(31, rtol=1e-11), rtol=1e-9)


def test_scan_refuses_unknown_devices(monkeypatch):
    with pytest.raises(InputError, match="device: received 'tpu'; allowed: 'cpu' or 'gpu'"):
        scan(11, device="tpu")
    monkeypatch.setenv("ASPERITY_DEVICE", "GPU")
    with pytest.raises(InputError, match=r"\$ASPERITY_DEVICE: received 'GPU'; allowed: 'cpu' or 'gpu'"):
        scan(11)


def test_the_command_line_refuses_a_gpu_that_is_not_there(monkeypatch):
    monkeypatch.setitem(sys.modules, "cupy", None)
    monkeypatch.setenv("ASPERITY_DEVICE", "cpu")
    outcome = CliRunner().invoke(main, ["run", "case.toml", "--device", "gpu"])
    assert outcome.exit_code == 2
    assert "no CuPy" in outcome.output
    assert "Traceback" not in outcome.output
    assert os.environ["ASPERITY_DEVICE"] == "cpu"


def test_the_chosen_device_is_that_of_all_scans(monkeypatch):
    monkeypatch.setenv("ASPERITY_DEVICE", "gpu")
    choose_device("cpu")
    assert os.environ["ASPERITY_DEVICE"] == "cpu"
    assert find_device() is None
