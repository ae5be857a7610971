"""Wheel and rail at a contact off the middle: symmetry, reciprocity, and what modes the place excites."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from asperity import Track
from asperity.errors import InputError
from asperity.structures.lateral_rail import (
    LateralTrack,
    at_springs,
    lateral_force,
    vertical_change,
    wheel_receptances,
)
from asperity.structures.wheel_modes import WheelModes

FREQUENCIES = np.array([90.0, 431.0, 1500.0, 2703.0])
ACROSS = np.linspace(-0.06, 0.06, 13)
RINGING = np.array([500.0, 1600.0, 2500.0, 3100.0])


def plane_wheel(**changes):
    """Modes of a plane web: radial ones are even across the tread, axial ones tilt it."""
    even, tilt = np.ones(13), ACROSS / 0.46
    radial = 0.06 * np.stack([tilt, even, tilt, even])
    axial = 0.06 * np.stack([even, 0.0 * even, even, 0.0 * even])
    numbers, none = np.array([0, 2, 3, 4]), np.full(4, 0.01)
    fields = {"radial": radial, "axial": axial} | changes
    return WheelModes(RINGING, np.full(4, 2e-4), numbers, ACROSS, disc=none, tread=none, **fields)


def answer(modes, place, mass=600.0, tangential=9e8):
    rail = LateralTrack(Track.named("uic60")).answers(2.0 * np.pi * FREQUENCIES, 0.1, 0.1, place)
    return at_springs(rail + wheel_receptances(modes, mass, FREQUENCIES, place), 1.1e9, tangential)


def test_in_the_middle_of_a_plane_wheel_nothing_moves_sideways():
    middle = answer(plane_wheel(), 0.0)
    assert np.all(np.abs(lateral_force(middle)) == 0.0)
    assert np.all(vertical_change(middle) == 1.0)
    assert np.all(np.abs(lateral_force(answer(plane_wheel(), 0.01))) > 1e-3)
    assert np.all(np.abs(lateral_force(answer(plane_wheel(axial=np.full((4, 13), 0.03)), 0.0))) > 1e-4)


def test_receptances_of_a_wheel_are_reciprocal():
    found = wheel_receptances(plane_wheel(), 600.0, FREQUENCIES, 0.023)
    assert_allclose(found[0, 1], found[1, 0], rtol=1e-12)
    rigid = wheel_receptances(None, 600.0, FREQUENCIES, 0.023)
    assert_allclose(rigid[1, 1], -1.0 / (600.0 * (2.0 * np.pi * FREQUENCIES) ** 2), rtol=1e-14)
    assert np.all(rigid[0, 1] == 0.0)


def test_axial_modes_ring_under_a_vertical_force_off_the_middle_only():
    """At resonance of a mode with three nodal diameters: (φ_r(y) φ_a)/(2iζω₀²), none of it in the middle."""
    modes, at = plane_wheel(), RINGING[[2]]
    for place in (0.0, 0.01, -0.02):
        cross = wheel_receptances(modes, 1e9, at, place)[1, 0]
        expected = 0.06**2 * place / 0.46 / (4e-4j * (2.0 * np.pi * 2500.0) ** 2)
        assert_allclose(cross, expected, rtol=2e-2, atol=1e-22)


def test_the_lateral_force_satisfies_compatibility():
    """Both forces at once; displacements of each body by itself differ by what the springs take up."""
    place, k_n, k_t = 0.012, 1.1e9, 9e8
    wheel = wheel_receptances(plane_wheel(), 600.0, FREQUENCIES, place)
    rail = LateralTrack(Track.named("uic60")).answers(2.0 * np.pi * FREQUENCIES, 0.1, 0.1, place)
    whole = at_springs(wheel + rail, k_n, k_t)
    forces = np.moveaxis(np.linalg.solve(np.moveaxis(whole, -1, 0), np.array([[1.0], [0.0]]))[..., 0], -1, 0)
    assert_allclose(lateral_force(whole), forces[1] / forces[0], rtol=1e-12)
    assert_allclose(vertical_change(whole), forces[0] * whole[0, 0], rtol=1e-12)
    on_rail = np.einsum("abf,bf->af", rail, forces)
    on_wheel = np.einsum("abf,bf->af", wheel, -forces)
    assert_allclose(on_wheel[1] - on_rail[1], forces[1] / k_t, rtol=1e-9)  # the wheel drags the rail
    assert_allclose(on_rail[0] - on_wheel[0], 1.0 - forces[0] / k_n, rtol=1e-9)


def test_a_place_off_the_tread_is_refused():
    with pytest.raises(InputError, match=r"place of the contact \(m\): received 0.07; allowed: -60 mm to 60"):
        wheel_receptances(plane_wheel(), 600.0, FREQUENCIES, 0.07)
