"""The scan in batches against the scan position by position."""

import numpy as np
import pytest

from asperity.contact import HalfSpace
from asperity.contact.device import gpu, processor
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
