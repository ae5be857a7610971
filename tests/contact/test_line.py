"""Rollers on raceways: closed forms of a line contact, profiles of rollers."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from asperity import Crowning, LineContact
from asperity.contact.line import palmgren_approach
from refusals import refusals

ISO_STEEL = 207e9 / (2.0 * (1.0 - 0.3**2))  # E* of two bodies of 207 GPa and 0.3
ROLLER = LineContact(ISO_STEEL, 3.25e-3, 6e-3)
FORCE = 500.0


def given_way(contact, force, place):
    """How far two half-spaces give way at a place along a band of Hertz's pressure, m, by quadrature."""
    b, half = contact.half_width(contact.approach(force)), 0.5 * contact.length
    peak = 2.0 * force / (math.pi * b * contact.length)

    def of_line(t):  # a line of length L at t from the place, of pressure √(1 − t²/b²)
        along = math.asinh((half - place) / abs(t)) + math.asinh((half + place) / abs(t))
        return math.sqrt(1.0 - (t / b) ** 2) * along

    return peak * 2.0 * quad(of_line, 0.0, b, epsabs=0.0, epsrel=1e-8)[0] / (math.pi * contact.modulus)


def test_the_middle_gives_way_as_half_spaces_do():
    share = (ROLLER.half_width(ROLLER.approach(FORCE)) / ROLLER.length) ** 2
    assert ROLLER.approach(FORCE) == pytest.approx(given_way(ROLLER, FORCE, 0.0), rel=share)


def test_a_pressure_that_is_alike_along_the_line_asks_for_lundbergs_profile():
    """Until some widths before the ends, where the sum of an endless band and its ends is no more."""
    profile = Crowning.lundberg(ROLLER, FORCE)
    places = np.array([0.1, 0.25, 0.4]) * ROLLER.length
    moved = [given_way(ROLLER, FORCE, place) for place in places]
    fallen = given_way(ROLLER, FORCE, 0.0) - np.array(moved)
    assert profile.drops(places) == pytest.approx(fallen, rel=1e-3)


def test_pressure_and_width_are_those_of_hertz_across():
    """Johnson (1985), 4.45: p = 2F/πbL, which carries the force; b² = 4FR/πE*L."""
    delta = ROLLER.approach(FORCE)
    b, p = ROLLER.half_width(delta), ROLLER.peak_pressure(delta)
    assert p == pytest.approx(2.0 * FORCE / (math.pi * b * ROLLER.length), rel=1e-12)
    assert p == pytest.approx(0.5 * ROLLER.modulus * b / ROLLER.radius, rel=1e-12)


@settings(max_examples=25)
@given(st.floats(1e-3, 2e4), st.floats(1e-3, 0.1), st.floats(2e-3, 0.1))
def test_force_is_the_inverse_of_approach_and_stiffness_its_slope(force, radius, length):
    contact = LineContact(ISO_STEEL, radius, length)
    force = min(force, 0.9 * contact.largest_force)
    delta = contact.approach(force)
    assert contact.force(delta) == pytest.approx(force, rel=1e-10)
    slope = (contact.approach(1.001 * force) - contact.approach(0.999 * force)) / (2e-3 * force)
    assert contact.tangent_stiffness(delta) == pytest.approx(1.0 / slope, rel=1e-5)
    assert contact.force(-delta) == contact.tangent_stiffness(-delta) == contact.approach(0.0) == 0.0


def test_palmgrens_fit_lies_within_a_fifth_of_half_spaces():
    """Rollers of usual bearings, from a tenth to a third of what dents: it knows no radius."""
    for radius, length in ((3.25e-3, 6e-3), (3e-3, 9.6e-3), (12e-3, 25e-3)):
        contact = LineContact(ISO_STEEL, radius, length)
        for pressure in (0.8e9, 1.5e9):
            force = math.pi * radius * length * pressure**2 / ISO_STEEL
            assert palmgren_approach(force, length) == pytest.approx(contact.approach(force), rel=0.2)
    assert palmgren_approach(1000.0, 10e-3) == pytest.approx(3.84e-8 * 1000.0**0.9 / 10.0**0.8, rel=1e-12)


def test_the_profile_of_iso_is_lundbergs_for_three_gigapascals_on_a_plane():
    diameter, length = 7.5e-3, 9e-3
    on_plane = LineContact(ISO_STEEL, 0.5 * diameter, length)
    force = math.pi * on_plane.radius * length * 3e9**2 / ISO_STEEL
    iso, lundberg = Crowning.iso(length, diameter), Crowning.lundberg(on_plane, force)
    assert on_plane.peak_pressure(on_plane.approach(force)) == pytest.approx(3e9)
    assert iso.drop / diameter == round(lundberg.drop / diameter, 5) == 0.00035  # as it is printed
    assert iso.drops([0.45 * length])[0] == pytest.approx(0.00035 * diameter * math.log(1.0 / 0.19))


def test_arcs_of_a_crowning_reach_their_drop_and_begin_without_a_kink():
    length, drop = 10e-3, 20e-6
    full = Crowning("circular", length, drop)
    partly = Crowning("partial", length, drop, straight=6e-3)
    for profile in (full, partly):
        assert profile.drops([0.0, 0.5 * length]) == pytest.approx([0.0, drop], rel=1e-12)
        assert np.all(profile.drops([-2e-3, -4e-3]) == profile.drops([2e-3, 4e-3]))
    y, radius = 3e-3, (0.25 * length**2 + drop**2) / (2.0 * drop)
    assert full.drops([y])[0] == pytest.approx(radius - math.sqrt(radius**2 - y**2), rel=1e-9)
    assert partly.drops([3e-3])[0] == 0.0
    assert partly.drops([3.5e-3])[0] == pytest.approx(drop / 16.0, rel=1e-4)
    assert not Crowning("cylindrical", length).drops([0.0, 4e-3]).any()
    assert np.isinf(Crowning.iso(length, 10e-3).drops([0.5 * length])[0])


test_what_is_no_line_is_refused = refusals(
    (lambda: LineContact(0.0, 1.0, 1.0), "modulus of the line contact: received 0"),
    (lambda: LineContact(1e11, 1.0, -1.0), "length of the line contact"),
    (lambda: ROLLER.approach(-1.0), "force"),
    (lambda: ROLLER.approach(1e6), r"force on the line contact: received .* at most .* N, where half"),
    (lambda: ROLLER.force(1e-3), r"approach of the line contact: received 1000 µm; allowed: at most"),
    (lambda: palmgren_approach(1.0, 0.0), "length of the roller"),
    (lambda: Crowning("round", 1e-2), 'form of the crowning: received .round.; allowed: one of "?cyl'),
    (lambda: Crowning("circular", 1e-2), "drop of the crowning: received 0 µm; allowed: more than 0"),
    (lambda: Crowning("cylindrical", 1e-2, 1e-6), "received 1 µm; allowed: 0 of a cylindrical roller"),
    (lambda: Crowning("circular", 1e-2, 5e-3), "at most 1000 µm, a tenth of the length.*unit"),
    (lambda: Crowning("circular", 1e-2, 1e-6, 1e-3), "straight middle.*received 1 mm.*else 0"),
    (lambda: Crowning("partial", 1e-2, 1e-6, 1e-2), "straight middle.*less than the length, 10 mm"),
    (lambda: Crowning.iso(1e-2, 0.0), "diameter of the roller"),
    (lambda: Crowning("cylindrical", 1e-2).drops([6e-3]), "received 6 mm from the middle; .*5 mm"),
)
