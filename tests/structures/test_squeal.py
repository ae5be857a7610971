"""Squeal: roots of a wheel that creeps, by closed forms and eigenvalues of states."""

import math

import numpy as np
import pytest

from asperity.structures.modal import modal_answers
from asperity.structures.squeal import CreepingContact, poles_of, ringing_modes
from asperity.structures.wheel_modes import WheelModes

RIGID, TURN = 1e30, 2.0 * math.pi


def modes_of(frequency, ratio, *shapes):
    """A wheel with modes of unit mass at one place of its tread, radial and axial."""
    none, places = np.zeros(len(frequency)), [np.atleast_2d(each).T for each in shapes]
    return WheelModes(np.array(frequency), np.array(ratio), none, np.zeros(1), *places, none, none)


def roots_of(contact, modes):
    """Of a wheel without rigid motion on a rigid rail."""
    return contact.roots(lambda omega: alone(modes, omega), poles_of(modes))


def alone(modes, omega):
    answer = modal_answers(omega / TURN, modes.natural_frequencies, modes.damping_ratios)
    return np.einsum("ap,bp,fp->abf", *[np.stack(modes.at())] * 2, answer)


def test_creep_that_damps_without_bounds_sticks_and_one_that_stops_all_motion_is_not_told():
    """The lateral spring of the contact holds the mass: ω² = (k + k_T)/m."""
    wheel = modes_of([1000.0], [1e-9], [0.0], [0.1])
    (root,) = roots_of(CreepingContact(1e9, 2e9, 1e12, 0.0), wheel)
    assert root.real == pytest.approx(math.hypot(TURN * 1000.0, 0.1 * math.sqrt(2e9)), rel=1e-6)
    assert np.isnan(roots_of(CreepingContact(1e9, RIGID, 2.5e6, 0.0), wheel).imag).all()


@pytest.mark.parametrize("seed", range(12))
def test_roots_are_the_eigenvalues_of_states(seed):
    """Of a wheel of seven modes on a rail of a mass on a spring, each way, in all states (q, q̇, e).

    N = k_N z and F_y = −k_T e by the motion z, y of the wheel against the rail, β (ẏ − ė) = k_T e + κ N.
    """
    draw = np.random.default_rng(seed)
    frequency, ratios = np.sort(draw.uniform(300.0, 4e3, 7)), draw.uniform(1e-4, 5e-3, 7)
    shapes = draw.normal(0, 0.06, (2, 7))
    modes = modes_of(frequency, ratios, *shapes)
    mass, damping, stiffness = np.array([[4e3, 2.5e3], [1e6, 7e5], [6e9, 2e9]])
    beta, kappa = draw.choice([-1.0, 1.0]) * draw.uniform(500.0, 2e4), draw.uniform(-0.6, 0.6)
    of, ratio = CreepingContact(1.1e9, 0.9e9, beta, kappa), 0.5 * damping / np.sqrt(stiffness * mass)
    poles = np.append(poles_of(modes), np.sqrt(stiffness / mass) * (np.sqrt(1.0 - ratio**2) + 1j * ratio))

    def receptances(omega):
        rail = 1.0 / (stiffness[:, None] - np.outer(mass, omega**2) + 1j * np.outer(damping, omega))
        return alone(modes, omega) + np.eye(2)[..., None] * rail

    inverse = np.append(np.ones(7), 1.0 / mass)
    z, y = np.hstack([shapes, -np.eye(2)])
    held = np.diag(np.abs(poles) ** 2) + of.normal * np.outer(inverse * z, z)
    pulled, none = (of.tangential * inverse * y)[:, None], np.zeros((9, 9))
    spring = [-kappa * of.normal / beta * z[None], y[None], np.array([[-of.tangential / beta]])]
    moving = [-held, -np.diag(2.0 * poles.imag), -pulled]
    states = np.block([[none, np.eye(9), none[:, :1]], moving, spring])
    values = -1j * np.linalg.eigvals(states)
    ringing, roots = values[values.real > 1.0], of.roots(receptances, poles)
    assert np.sort_complex(roots) == pytest.approx(np.sort_complex(ringing), rel=1e-8)


def test_the_normal_force_follows_the_lateral_one():
    """N (φ_r² α + 1/k_N) + F φ_r φ_a α = 0."""
    wheel, omega = modes_of([1000.0], [1e-3], [0.1], [0.05]), np.array([TURN * 700.0])
    receptances = alone(wheel, omega)
    answer, found = receptances[0, 0] / 0.01, CreepingContact(1e7, 1e9, 50.0, 0.0).force_ratio(receptances)
    assert found == pytest.approx(-0.005 * answer / (0.01 * answer + 1e-7))


def test_the_mode_that_rings_is_that_of_most_energy():
    """Of two modes apart each root is its own; between them the one that is pushed more."""
    wheel = modes_of([1000.0, 2000.0], [1e-3, 1e-3], [0.0, 0.0], [0.1, 0.02])
    contact = CreepingContact(1e9, 1e9, 50.0, 0.0)
    roots = np.append(roots_of(contact, wheel), TURN * 1700.0)
    forces = contact.force_ratio(alone(wheel, roots))
    assert forces == pytest.approx(0.0)
    assert ringing_modes(wheel, 0.0, roots, forces).tolist() == [0, 1, 0]
    poles = poles_of(wheel)  # without friction each mode rings alone
    assert ringing_modes(wheel, 0.0, poles, 0.0 * poles).tolist() == [*range(len(poles))]
