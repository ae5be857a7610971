"""Sleepers as radiators."""

import math

import numpy as np
import pytest

from asperity import Track
from asperity.errors import InputError
from asperity.radiation.track import (
    IMPEDANCE,
    SPEED_OF_SOUND,
    RailSection,
    SleeperTop,
    squared_sleeper_mobility,
)

TOP = SleeperTop(length=2.6, width=0.25)


def test_half_a_sleeper_is_a_piston_of_its_area():
    assert TOP.area == pytest.approx(0.325)
    assert math.pi * TOP.radius**2 == pytest.approx(TOP.area)
    ka = 2.0 * math.pi * 10.0 / SPEED_OF_SOUND * TOP.radius
    assert TOP.radiation_ratio(10.0)[0] == pytest.approx(0.5 * ka**2, rel=2e-3)
    assert TOP.radiation_ratio(20e3)[0] == pytest.approx(1.0, abs=2e-3)


def test_the_power_is_that_of_all_half_sleepers():
    track, f = Track.named("uic60"), np.array([200.0, 600.0])
    expected = IMPEDANCE * 0.325 * TOP.radiation_ratio(f) * squared_sleeper_mobility(track, f)
    np.testing.assert_allclose(TOP.power_per_force(track, f), expected, rtol=1e-12)


def test_a_soft_pad_makes_the_rail_louder_and_the_sleepers_quieter():
    """For the same force on the rail, where waves run along it on the soft pad and not on the stiff one."""
    f = np.array([500.0, 630.0])
    soft, stiff = (Track.named("uic60", pad_stiffness=stiffness) for stiffness in (100e6, 1200e6))
    rail = RailSection(0.15, 0.072, 7.67e-3)
    assert (rail.power_per_force(soft, f) > 10.0 * rail.power_per_force(stiff, f)).all()
    assert (2.0 * TOP.power_per_force(soft, f) < TOP.power_per_force(stiff, f)).all()


@pytest.mark.parametrize("what", ["length", "width"])
def test_a_sleeper_without_size_is_refused(what):
    with pytest.raises(InputError, match=f"{what} of a sleeper: received -1.0; allowed: a finite positive"):
        SleeperTop(**({"length": 2.6, "width": 0.25} | {what: -1.0}))
