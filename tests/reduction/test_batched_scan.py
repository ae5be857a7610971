"""The scan in batches against the scan position by position."""

import os
import sys
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner

import asperity
from asperity.cli import main
from asperity.contact import HalfSpace
from asperity.contact.device import choose_device, find_device, gpu, processor
from asperity.errors import InputError
from asperity.reduction.batched_scan import solve_rows
from asperity.reduction.scan import TRUNCATED, scan_forces

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
    reference = scan_forces(
        heights,
        (DX, DX),
        ball(cells),
        MODULUS,
        approaches,
        hardness,
        stride=stride,
        rtol=1e-11,
        planes=planes,
    )
    half_space = HalfSpace((cells, cells), (DX, DX), MODULUS, hardness)
    forces, iterations, unconverged, truncated = solve_rows(
        half_space, heights, ball(cells), approaches, planes, stride, 1e-11, device, TRUNCATED
    )
    np.testing.assert_allclose(forces, reference.forces, rtol=1e-9)
    assert iterations.sum() > 0
    assert unconverged.sum() == reference.unconverged == 0
    assert truncated.sum() == reference.truncated
    assert bool(reference.truncated) == (cells == 15)


def test_scan_on_a_device_agrees_and_keeps_its_own_blocks(monkeypatch):
    """Blocks of the device are longer, and not taken for those of the processor."""
    heights = 0.05e-6 * np.random.default_rng(3).standard_normal((90, 31))
    arguments = (heights, (DX, DX), ball(31), MODULUS, [0.0, 0.2e-6])
    kept = {}
    cache = SimpleNamespace(get=kept.get, put=kept.__setitem__)
    alone = asperity.scan(*arguments, rtol=1e-11, cache=cache)
    monkeypatch.setattr("asperity.reduction.scan.find_device", lambda name: processor())
    monkeypatch.setattr("asperity.reduction.batched_scan.BLOCK", 32)
    together = asperity.scan(*arguments, rtol=1e-11, cache=cache, device="gpu")
    np.testing.assert_allclose(together, alone, rtol=1e-9)
    assert len(kept) == 1 + 2
    kept_then = dict(kept)
    assert asperity.scan(*arguments, rtol=1e-11, cache=cache, device="gpu").equals(together)
    assert kept == kept_then


def test_scan_on_the_gpu(device):
    if device.name.startswith("processor"):
        pytest.skip("stands for the scan on a real GPU")
    heights = 0.05e-6 * np.random.default_rng(3).standard_normal((90, 31))
    arguments = (heights, (DX, DX), ball(31), MODULUS, [0.0, 0.2e-6])
    found = asperity.scan(*arguments, rtol=1e-11, device="gpu")
    np.testing.assert_allclose(found, asperity.scan(*arguments, rtol=1e-11), rtol=1e-9)


def test_scan_refuses_unknown_devices(monkeypatch):
    arguments = (np.zeros((20, 11)), (DX, DX), ball(11), MODULUS, [0.1e-6])
    with pytest.raises(InputError, match="device: received 'tpu'; allowed: 'cpu' or 'gpu'"):
        asperity.scan(*arguments, device="tpu")
    monkeypatch.setenv("ASPERITY_DEVICE", "GPU")
    with pytest.raises(InputError, match=r"\$ASPERITY_DEVICE: received 'GPU'; allowed: 'cpu' or 'gpu'"):
        asperity.scan(*arguments)


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
