"""Radiation of wheels, against a disc and a ring whose sound is known."""

import math

import numpy as np
import pytest
from disc_field import axial_ratio
from scipy.special import jv

from asperity.errors import InputError
from asperity.radiation.track import IMPEDANCE, SPEED_OF_SOUND
from asperity.radiation.wheel import RadiatingWheel, axial_transition, radial_transition


def wheel(**changed):
    told = {
        "radius": 0.46,
        "width": 0.135,
        "nodal_diameters": np.array([0, 1, 2, 3, 4]),
        "axial": np.full(5, 0.5),
        "radial": np.full(5, 0.7),
    }
    return RadiatingWheel(**(told | changed))


def at(ka):
    return ka * SPEED_OF_SOUND / (2.0 * math.pi * 0.46)


def test_a_rigid_disc_has_the_transition_of_rayleigh():
    """Force (8/3) ρ ω a³ v on the air, and F² k²/(12π ρ c) of a dipole: 8 (ka)⁴/(27π²) = 1."""
    assert axial_transition(0) == pytest.approx((27.0 * math.pi**2 / 8.0) ** 0.25, rel=1e-12)


@pytest.mark.parametrize("diameters", [0, 1, 2, 3, 4])
def test_axial_motion_at_low_frequency_is_that_of_a_disc(diameters):
    ka = 0.1 * axial_transition(diameters)
    found = wheel().axial_ratio(at(ka))[diameters, 0]
    assert found == pytest.approx(axial_ratio(diameters, ka), rel=0.03)


@pytest.mark.parametrize("diameters", [0, 1, 2, 3, 4])
def test_axial_motion_is_near_that_of_a_disc_beyond_its_transition(diameters):
    """Within 2 dB from 1.25 of the transition on, as its page says; at the transition within 4 dB."""
    transition = axial_transition(diameters)
    for over, allowed in ((1.0, 4.0), (1.25, 2.1), (1.6, 1.1), (2.5, 0.6), (5.0, 0.2)):
        found = wheel().axial_ratio(at(over * transition))[diameters, 0]
        exact = axial_ratio(diameters, over * transition)
        assert abs(10.0 * math.log10(found / exact)) < allowed, over


@pytest.mark.parametrize("diameters", [0, 1, 2, 4])
def test_radial_motion_at_low_frequency_is_that_of_a_ring_of_monopoles(diameters):
    """Power through a far sphere, from the pressure of cos(nθ) around a ring, by quadrature."""
    radius, width = 0.46, 0.135
    ka = 0.1 * radial_transition(diameters, width / radius)
    node, weight = np.polynomial.legendre.leggauss(60)
    sine = np.sqrt(1.0 - node**2)
    around = 2.0 if diameters == 0 else 1.0  # π times this: integral of cos²
    pressure = 0.5 * (ka / radius) * width * radius * jv(diameters, ka * sine)  # times r, per velocity
    power = math.pi * around * np.sum(weight * pressure**2)
    expected = power / (2.0 * math.pi * radius * width * 0.5 * around)
    assert wheel().radial_ratio(at(ka))[diameters, 0] == pytest.approx(expected, rel=0.03)


def test_ratios_rise_with_the_published_exponents_and_end_at_one():
    low = np.array([1.0, 2.0])
    axial, radial = wheel().axial_ratio(low), wheel().radial_ratio(low)
    for n in range(5):
        assert math.log2(axial[n, 1] / axial[n, 0]) == pytest.approx(2 * n + 4, rel=1e-3)
        assert math.log2(radial[n, 1] / radial[n, 0]) == pytest.approx(2 * n + 2, rel=1e-3)
    assert wheel().axial_ratio(50e3) == pytest.approx(1.0, abs=1e-3)
    assert wheel().radial_ratio(50e3) == pytest.approx(1.0, abs=1e-3)


def test_the_power_is_that_of_both_faces_of_the_disc_and_of_the_tread():
    body = wheel(nodal_diameters=np.array([3]), axial=np.array([4.0]), radial=np.array([0.5]))
    f = np.array([20e3])
    disc, tread = 2.0 * math.pi * 0.46**2 * 16.0, 2.0 * math.pi * 0.46 * 0.135 * 0.25
    assert body.power(f, np.array([[1e-6]])) == pytest.approx(IMPEDANCE * 1e-6 * (disc + tread), rel=1e-4)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"radius": 0.0}, "radius of the wheel's tread: received 0.0"),
        ({"axial": np.full(4, 1.0)}, "radiating modes: received lists of different lengths"),
        ({"radial": np.full(5, -1.0)}, "radial velocity of a mode"),
    ],
)
def test_a_wheel_that_cannot_be_is_refused(changed, message):
    with pytest.raises(InputError, match=message):
        wheel(**changed)


def test_half_a_nodal_diameter_is_refused():
    with pytest.raises(InputError, match=r"number of nodal diameters: received 0\.5"):
        axial_transition(0.5)
    with pytest.raises(InputError, match=r"width of the tread over its radius: received 0\.0"):
        radial_transition(1, 0.0)
