"""Bodies that roll on several contacts: what carries them."""

import numpy as np
import pytest

from asperity.errors import InputError
from asperity.structures.body import Body

NONE = np.zeros(0)


def _beam_on(places, pressing):
    """A rigid bar of 100 kg and 10 kg m², on contacts at places from its centre of mass, m."""
    places = np.asarray(places, dtype=float)
    contacts = np.stack([np.ones_like(places), places], axis=1)
    zero = np.zeros((2, 2))
    return Body(
        np.diag([100.0, 10.0]), zero, zero, contacts, np.asarray(pressing, float), places,
        NONE, NONE, np.zeros((len(places), 0)),
    )  # fmt: skip


def test_a_mass_is_carried_by_its_contact():
    assert Body.rigid(600.0, 65e3).static_loads == pytest.approx([65e3])


def test_two_contacts_share_by_the_lever():
    body = _beam_on([-1.0, 3.0], [981.0, 0.0])
    assert body.static_loads == pytest.approx([0.75 * 981.0, 0.25 * 981.0])


def test_four_contacts_share_evenly():
    assert _beam_on([-3, -1, 1, 3], [400.0, 0.0]).static_loads == pytest.approx(np.full(4, 100.0))


def test_a_suspended_mass_rests_on_its_wheel():
    """Wheel and body on a spring: the contact carries both weights, whatever the spring."""
    spring = 1e5 * np.array([[1.0, -1.0], [-1.0, 1.0]])
    body = Body(
        np.diag([1000.0, 5000.0]), 0.0 * spring, spring, np.array([[1.0, 0.0]]), np.array([9810.0, 49050.0]),
        np.zeros(1), NONE, NONE, np.zeros((1, 0)),
    )  # fmt: skip
    assert body.static_loads == pytest.approx([58860.0])


def test_a_body_that_tilts_is_refused():
    with pytest.raises(InputError, match=r"too few: it falls or tilts.*more contacts"):
        _beam_on([1.0], [981.0, 0.0])


def test_shapes_must_fit():
    with pytest.raises(InputError, match=r"pressing of a body.*shape \(2,\)"):
        _beam_on([-1.0, 1.0], [981.0])
