"""The rail's section as a radiator, against boundary elements, and the power of a rail."""

import math

import numpy as np
import pytest
from section_field import INSIDE_60E1, SECTION_60E1, mirrored, power_per_length

from asperity import Track
from asperity.errors import InputError
from asperity.radiation.track import (
    IMPEDANCE,
    SPEED_OF_SOUND,
    STEEL_DENSITY,
    RailSection,
    cylinder,
    effective_length,
    squared_point_mobility,
)

UIC60 = RailSection(foot_width=0.150, head_width=0.072, area=60.2 / STEEL_DENSITY)


@pytest.mark.parametrize("ka", [0.1, 1.0, 3.0])
def test_the_boundary_elements_are_right_for_a_cylinder(ka):
    radius, angle = 0.07, np.linspace(0.0, 2.0 * math.pi, 200, endpoint=False)
    outline = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    inside = np.array([(0.01, 0.02), (-0.03, 0.013)])
    found = power_per_length(outline, inside, ka / radius)
    assert found / (math.pi * radius) == pytest.approx(float(cylinder(ka)), rel=2e-3)


@pytest.mark.parametrize(
    ("frequency", "low", "high"),
    [(100.0, 0.0, 0.5), (400.0, 0.3, 0.8), (800.0, 0.0, 0.6), (1600.0, -2.0, 0.0)],
)
def test_the_ratio_of_a_uic60_rail_is_near_that_of_its_section(frequency, low, high):
    """By how much the model is above boundary elements, dB, as its page says it is."""
    field = power_per_length(mirrored(SECTION_60E1), INSIDE_60E1, 2.0 * math.pi * frequency / SPEED_OF_SOUND)
    model = UIC60.radiating_width * UIC60.radiation_ratio(frequency)[0]
    assert low < 10.0 * math.log10(model / field) < high


def test_limits_of_the_section():
    """W' = ρ c ⟨v²⟩ k³ D²/8 at low frequency, both faces of the foot at high frequency."""
    k = 2.0 * math.pi * 1.0 / SPEED_OF_SOUND
    low = UIC60.radiating_width * UIC60.radiation_ratio(1.0)[0]
    assert low == pytest.approx(k**3 * UIC60.dipole_area**2 / 8.0, rel=1e-4)
    assert UIC60.radiation_ratio(1e6)[0] == pytest.approx(1.0, abs=1e-3)
    assert UIC60.dipole_area == pytest.approx(0.02941, rel=1e-3)  # by hand: 0.00767 + 0.01767 + 0.00407


def test_a_table_replaces_the_model():
    table = (np.array([100.0, 1000.0]), np.array([0.01, 1.0]))
    section = RailSection(0.15, 0.072, 7.67e-3, table)
    found = section.radiation_ratio([50.0, 100.0, 316.2278, 2000.0])
    np.testing.assert_allclose(found, [0.01, 0.01, 0.1, 1.0], rtol=1e-6)


def test_the_power_of_a_rail_is_that_of_its_effective_length():
    track, f = Track.named("uic60"), np.array([300.0, 1000.0])
    at_the_force = squared_point_mobility(track, f) * effective_length(track, f)
    expected = IMPEDANCE * 0.3 * UIC60.radiation_ratio(f) * at_the_force
    np.testing.assert_allclose(UIC60.power_per_force(track, f), expected, rtol=1e-12)


@pytest.mark.parametrize("what", ["foot_width", "head_width", "area"])
def test_a_section_without_size_is_refused(what):
    sizes = {"foot_width": 0.15, "head_width": 0.07, "area": 7e-3} | {what: 0.0}
    with pytest.raises(InputError, match=f"{what} of the rail's section: received 0.0; allowed: a finite"):
        RailSection(**sizes)
