"""Contacts of bodies that yield: one solution for both, checked by what defines it."""

import numpy as np
import pytest

from asperity import HalfSpace
from asperity.contact.scan import ContactInPlace

MODULUS, DX, N, RADIUS, RTOL = 115e9, 5e-6, 41, 10e-3, 1e-7
X = (np.arange(N) - N // 2) * DX
BALL = (X[:, None] ** 2 + X**2) / (2 * RADIUS)


@pytest.mark.parametrize("hardness", [None, 1.5e9])
@pytest.mark.parametrize("rms", [0.0, 0.3e-6])
@pytest.mark.parametrize("yielding", [1e-3, 1.0, 30.0])
def test_what_the_bodies_yield_and_the_contact_agree(yielding, rms, hardness):
    """Pressure within its bounds, no overlap but at the hardness, no gap under pressure: at δ − C F."""
    rough = np.random.default_rng(0).standard_normal((N + 20, N))
    rough = np.apply_along_axis(np.convolve, 0, rough, np.hanning(7), mode="same")
    space, heights = HalfSpace((N, N), DX, MODULUS, hardness), rms * rough / rough.std()
    contact, free = ContactInPlace(space, BALL, RTOL), 0.6e-6
    compliance = yielding / space.solve(BALL - heights[:N], load=3.0).stiffness
    for row in range(0, 20, 5):  # from nothing, and from what stands there
        found = contact.solve(heights[row : row + N], free, compliance)
        assert found.converged
        p, gap = contact.pressure, BALL - heights[row : row + N]
        force = p.sum() * DX**2
        assert found.force == pytest.approx(force, rel=1e-12, abs=0.0)
        assert found.approach == pytest.approx(free - compliance * force, rel=1e-9, abs=1e-15)
        open_by = gap + space.displacement(p) - (free - compliance * force)
        limit = RTOL * found.overlap
        assert found.overlap == pytest.approx(found.approach - gap.min(), rel=1e-6, abs=0.0)
        assert p.min() >= 0.0
        assert p.max() <= space.pressure_cap
        assert open_by[p < space.pressure_cap].min() >= -limit
        assert open_by[p > 0.0].max() <= limit
        contact.start_again()
    found = contact.solve(heights[:N], -2e-6, compliance)
    assert (found.force, found.approach, found.converged) == (0.0, -2e-6, True)
    assert not contact.pressure.any()


def test_pressures_follow_the_surface_or_stay_in_the_window():
    """As they did from the one before to the last; on the way they go on straight, within the hardness."""
    contact = ContactInPlace(HalfSpace((N, N), DX, MODULUS, hardness=2.0), BALL, RTOL)
    asperity, patch = np.zeros((2, N, N))
    asperity[20, 20], patch[18:23, 18:23] = 1.0, 1.0
    moved = 1.5 * np.roll(asperity, -2, axis=0)
    contact.start_from(moved, asperity, 2, 2)
    assert contact.start[16, 20] == 2.0  # 1.5 + 0.5, at the cap
    assert contact.start.sum() == 2.0
    contact.start_from(moved, asperity, 3, 2)  # another stride: no line
    assert contact.start[15, 20] == contact.start.sum() == 1.5
    contact.start_from(1.1 * patch, patch, 2, 2)
    assert np.array_equal(contact.start, 1.1 * patch)
