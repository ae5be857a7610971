"""The force accuracy that is asked for is had: against solutions of a residual ten thousand times smaller."""

import numpy as np
import pytest

from asperity.contact import HalfSpace, Hertz
from asperity.contact.scan import FORCE_ACCURACY, ScanJob, rtol_for, scan_forces
from asperity.errors import InputError
from asperity.surfaces.strip import Rows
from asperity.surfaces.synthesis import self_affine

MODULUS, RADIUS, N = 115e9, 25e-3, 49
HERTZ = Hertz(MODULUS, RADIUS, RADIUS)


@pytest.mark.parametrize("accuracy", [1e-2, 1e-3, FORCE_ACCURACY, 1e-5])
@pytest.mark.parametrize(
    ("rms", "hardness"), [(0.0, None), (0.1, None), (0.5, None), (1.5, None), (0.5, 2e9)]
)
def test_forces_are_as_accurate_as_asked_for(accuracy, rms, hardness):
    """From first touches to thrice the working approach; rms in approaches."""
    approach = HERTZ.approach(10.0)
    radius = HERTZ.semi_axes(approach)[0]
    dx = 2 * radius / (0.35 * N)
    x = (np.arange(N) - N // 2) * dx
    body = (x[:, None] ** 2 + x[None, :] ** 2) / (2 * RADIUS)
    waves = {"hurst": 0.8, "longest": 1.4 * radius, "shortest": 2 * dx}
    heights = self_affine((N + 11, N), (dx, dx), rms=rms * approach, **waves, seed=1).heights
    approaches = approach * np.array([-rms, 0.1, 0.3, 1.0, 3.0])
    half_space = HalfSpace((N, N), dx, MODULUS, hardness)
    found, tight = (
        scan_forces(ScanJob(half_space, Rows(heights), body, approaches, rtol=rtol)).forces
        for rtol in (rtol_for(accuracy), 1e-4 * rtol_for(accuracy))
    )
    touching = tight > 0.0
    assert touching[-1].all()
    assert np.all(found[~touching] == 0.0)
    assert np.abs(found[touching] / tight[touching] - 1.0).max() <= accuracy


@pytest.mark.parametrize("accuracy", [0.0, -1e-3, 0.2, float("nan")])
def test_an_accuracy_out_of_range_is_refused(accuracy):
    with pytest.raises(InputError, match="force_accuracy: received"):
        rtol_for(accuracy)
