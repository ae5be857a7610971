"""A roller by slices: closed forms of sums over its length, energy, moment and stiffness."""

import math

import numpy as np
import pytest
from scipy.special import beta

from asperity import Crowning, LineContact, SlicedContact
from asperity.contact.line import palmgren_approach
from asperity.contact.slices import ISO_MODULUS
from refusals import refusals

LENGTH, DIAMETER = 10e-3, 8e-3
STRAIGHT = Crowning("cylindrical", LENGTH)
ISO = Crowning.iso(LENGTH, DIAMETER)


def sliced(crowning=STRAIGHT, slices=400):
    return SlicedContact(ISO_MODULUS, 3e-3, crowning, slices)


def test_between_two_raceways_a_roller_gives_way_as_the_standard_has_it():
    """Q = 35948 L^(8/9) δ^(10/9) in N and mm, δ of both contacts."""
    delta = sliced().approach(1000.0) + sliced(slices=30).approach(1000.0)
    assert 35948.0 * 10.0 ** (8 / 9) * (1e3 * delta) ** (10 / 9) == pytest.approx(1000.0, rel=1e-9)


def test_of_a_straight_roller_one_contact_is_near_palmgrens_and_that_of_half_spaces():
    delta = sliced().approach(1000.0)
    assert delta == pytest.approx(palmgren_approach(1000.0, LENGTH), rel=0.035)
    assert delta == pytest.approx(LineContact(ISO_MODULUS, 3e-3, LENGTH).approach(1000.0), rel=0.12)


def test_of_a_tilted_straight_roller_force_and_moment_are_integrals_in_closed_form():
    """∫(δ + xψ)^n and ∫x(δ + xψ)^n over the length that touches: all of it, then from an end on."""
    n, roller, constant = 10 / 9, sliced(), sliced().stiffness_constant / LENGTH
    for delta, psi in ((5e-6, 6e-4), (1e-6, 2e-3)):
        low, high = np.maximum(delta + np.array([-0.5, 0.5]) * LENGTH * psi, 0.0)
        whole = (high ** (n + 1) - low ** (n + 1)) / ((n + 1) * psi)
        lever = ((high ** (n + 2) - low ** (n + 2)) / ((n + 2) * psi) - delta * whole) / psi
        found = roller.pressed(delta, psi)
        assert found.force == pytest.approx(constant * whole, rel=2e-4)
        assert found.moment == pytest.approx(constant * lever, rel=5e-4)


def test_of_a_circular_crowning_the_force_is_a_beta_function():
    """∫(δ − y²/2R)^n dy over the part that touches = δ^n a B(1/2, n + 1), a = √(2Rδ)."""
    delta, n = 2e-6, 10 / 9
    crowning = Crowning("circular", LENGTH, 20e-6)
    half = math.sqrt(2.0 * LENGTH**2 / (8.0 * 20e-6) * delta)
    expected = delta**n * half * beta(0.5, n + 1) * sliced().stiffness_constant / LENGTH
    assert sliced(crowning).force(delta) == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("crowning", [STRAIGHT, ISO])
def test_force_moment_and_stiffness_are_derivatives_of_the_energy(crowning):
    roller = SlicedContact(90e9, 3e-3, crowning)
    delta, psi = np.array([3e-6, 1e-6, -1e-6]), np.array([1e-4, 1e-3, 5e-4])
    found, step, turn = roller.pressed(delta, psi), 1e-10, 1e-8
    wide = [roller.pressed(delta + s * step, psi) for s in (1, -1)]
    tilted = [roller.pressed(delta, psi + s * turn) for s in (1, -1)]
    for (up, down), size, column, slope in ((wide, step, 0, "force"), (tilted, turn, 1, "moment")):
        by = 2.0 * size
        assert (up.energy - down.energy) / by == pytest.approx(getattr(found, slope), rel=1e-5)
        for row, name in enumerate(("force", "moment")):
            change = (getattr(up, name) - getattr(down, name)) / by
            assert found.stiffness[:, row, column] == pytest.approx(change, rel=1e-3)
    assert found.loads.shape == (3, 41)
    assert found.moment[0] > 0.0
    assert found.loads[1, 30] > found.loads[1, 20] > found.loads[1, 0] == 0.0


@pytest.mark.parametrize("crowning", [STRAIGHT, ISO, Crowning("partial", LENGTH, 30e-6, 5e-3)])
def test_approach_is_the_inverse_of_force_and_pressure_that_of_the_line(crowning):
    roller = sliced(crowning, 41)
    for force in (1e-3, 10.0, 3000.0):
        delta = roller.approach(force)
        assert roller.force(delta) == pytest.approx(force, rel=1e-10)
        even = LineContact(ISO_MODULUS, 3e-3, LENGTH)
        line = even.peak_pressure(even.approach(force))
        assert roller.peak_pressure(delta) >= line * (1.0 - 1e-9)
        assert (crowning is STRAIGHT) == (roller.peak_pressure(delta) == pytest.approx(line, rel=1e-9))
    assert roller.approach(0.0) == roller.force(-1e-6) == roller.tangent_stiffness(-1e-6) == 0.0


test_what_is_no_sliced_roller_is_refused = refusals(
    (lambda: SlicedContact(1e11, 1e-3, STRAIGHT, 29), "slices of a roller: received 29.*30 or more.*ISO"),
    (lambda: SlicedContact(0.0, 1e-3, STRAIGHT), "modulus of the roller's contact"),
    (lambda: SlicedContact(1e11, 0.0, STRAIGHT), "radius of the roller's contact"),
    (lambda: sliced().approach(-1.0), "force"),
)
