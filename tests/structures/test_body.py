"""What rolls: what it weighs, how several contacts share it, how it moves against closed forms."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from asperity.structures.body import GRAVITY, Body, carriage, chain
from refusals import refusals

F = np.array([0.7, 4.0, 31.0, 250.0])
S = 2j * np.pi * F
BOGIE = (3000.0, 1800.0, [0.0, 2.5], 600.0, 1.2e6, 8e3)


def two_masses(lower, upper, spring, damper):
    """Receptance at the lower of two masses: −(1/ω²)(…) from Newton's equations, solved by hand."""
    link = spring + damper * S
    return (upper * S**2 + link) / ((lower * S**2 + link) * (upper * S**2 + link) - link**2)


def bar_on(places, pressing=(981.0, 0.0)):
    """A rigid bar of 100 kg and 10 kg m², on contacts at places from its centre of mass, m."""
    contacts, none = np.stack([np.ones(len(places)), places], axis=1), np.zeros((2, 2))
    return Body(np.diag([100.0, 10.0]), none, none, contacts, np.array(pressing), np.array(places))


@pytest.mark.parametrize(
    ("body", "loads"),
    [
        (Body.rigid(600.0, 65e3), [65e3]),
        (bar_on([-1.0, 3.0]), [0.75 * 981.0, 0.25 * 981.0]),
        (bar_on([-3.0, -1.0, 1.0, 3.0]), [0.25 * 981.0] * 4),
        (chain([600.0, 1500.0, 8e3], [1.2e6, 0.4e6], [1e4, 2e4], load=1e3), [10100.0 * GRAVITY + 1e3]),
        (carriage(*BOGIE, load=2e3), [2100.0 * GRAVITY + 1e3] * 2),
    ],
)
def test_contacts_carry_weights_and_load_as_levers_share_them(body, loads):
    assert body.static_loads == pytest.approx(loads)


def test_the_modes_of_a_bogie_are_bounce_and_pitch():
    """Both wheels alike lift half of what is above, against one another its pitch: each a chain of masses."""
    rolled = 1800.0 / (2.0 * 1.25**2)  # kg at each wheel
    body = carriage(*BOGIE)
    point, transfer = body.receptance(F)[:, 0, 0], body.receptance(F)[:, 0, 1]
    assert_allclose(point + transfer, two_masses(600.0, 1500.0, 1.2e6, 8e3), rtol=1e-10)
    assert_allclose(point - transfer, two_masses(600.0, rolled, 1.2e6, 8e3), rtol=1e-10)
    assert body.places.tolist() == [0.0, 2.5]


def test_elements_carry_a_carriage_on_springs():
    body = carriage(2.0, 0.01, [0.0, 0.03, 0.06], 0.05, 40e6, 100.0, load=60.0)
    assert body.static_loads == pytest.approx([(2.0 * GRAVITY + 60.0) / 3.0 + 0.05 * GRAVITY] * 3)
    # all elements alike: a third of the carriage on each
    alike = body.receptance(F).sum(axis=2)[:, 1]
    assert_allclose(alike, two_masses(0.05, 2.0 / 3.0, 40e6, 100.0), rtol=1e-9)


def test_each_wheel_has_its_own_modes():
    modes, pair = ([400.0, 2000.0], [0.01, 0.002], [300.0, 100.0]), carriage(*BOGIE)
    ringing = pair.with_modes(*modes)
    added = ringing.receptance(F) - pair.receptance(F)
    flexible = 0.0
    for f, ratio, mass in zip(*modes, strict=True):
        omega = 2 * np.pi * f
        flexible = flexible + 1.0 / mass / (omega**2 + 2 * ratio * omega * S + S**2)
    assert_allclose(added[:, 1, 1], flexible, rtol=1e-6)
    assert np.abs(added[:, 0, 1]).max() < 1e-6 * np.abs(flexible).min()
    assert ringing.static_loads == pytest.approx(pair.static_loads)


test_bodies_that_cannot_be_are_refused = refusals(
    (lambda: bar_on([1.0]), r"too few: it falls or tilts.*more contacts"),
    (lambda: bar_on([-1.0, 1.0], [981.0]), r"pressing of a body.*shape \(2,\)"),
    (lambda: Body.rigid(0.0, 1.0), "one without inertia; allowed: positive masses"),
    (lambda: chain([1.0], [], [], load=-20.0), r"a contact under -10.19 N; allowed: contacts that"),
    (lambda: chain([1.0], [], []).receptance(0.0), "no static receptance"),
)
