"""Sound of a rail that moves sideways: sums against many bays, radiation against exact fields."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from section_field import INSIDE_60E1, SECTION_60E1, mirrored, power_per_length

from asperity import Track
from asperity.radiation.track import IMPEDANCE, SPEED_OF_SOUND, SideOfRail, squared_lateral_mobility
from asperity.structures.lateral_rail import LateralTrack

TRACK = LateralTrack(Track.named("nordborg-loss-factor", rail_loss_factor=0.05))
SIDE = SideOfRail(0.172, 0.150, 0.072)


def test_the_integral_along_the_rail_is_that_of_many_bays():
    frequency, place, bay, bays, cells = np.array([80.0, 500.0, 1500.0]), 0.012, 0.6, 60, 24
    places = (np.arange(4) + 0.5) * bay / 4
    waves, forces = TRACK.waves(2.0 * np.pi * frequency), TRACK.contact_shapes(place)
    along = (np.arange(-bays * cells, bays * cells) + 0.5) * bay / cells
    heights = np.linspace(-TRACK.foot_depth, TRACK.head_height, 201)
    simpson = np.ones(201)
    simpson[1:-1:2], simpson[2:-1:2] = 4.0, 2.0
    levers = np.stack([np.ones(201), heights])
    over_height = (levers * simpson) @ levers.T / simpson.sum()
    expected = np.zeros((2, 2, 3), complex)
    for x0 in places:
        moved = np.array([np.einsum("abf,nb->anf", waves.receptance(x, x0), forces) for x in along])
        expected += np.einsum("xamf,ab,xbnf->mnf", moved.conj(), over_height, moved) * bay / cells / 4
    found = squared_lateral_mobility(TRACK, frequency, places, place).mean(axis=0)
    assert_allclose(found, (2.0 * np.pi * frequency) ** 2 * expected, rtol=5e-4)
    assert_allclose(found, found.conj().swapaxes(0, 1), rtol=1e-9)


@pytest.mark.parametrize(
    ("frequency", "low", "high"),
    [(100.0, 0.5, 1.0), (315.0, -1.2, -0.8), (630.0, -3.5, -3.2), (1250.0, 0.0, 0.5), (2500.0, 1.5, 2.2)],
)
def test_the_ratio_is_near_that_of_a_60e1_section(frequency, low, high):
    """By how much the model is above boundary elements of the section turned by a right angle, dB."""
    turned = [np.stack([-each[:, 1], each[:, 0]], axis=1) for each in (mirrored(SECTION_60E1), INSIDE_60E1)]
    field = power_per_length(*turned, 2.0 * math.pi * frequency / SPEED_OF_SOUND)
    model = SIDE.power(frequency, np.ones(1))[0] / IMPEDANCE
    assert low < 10.0 * math.log10(model / field) < high
