"""Squeal: roots of a wheel that creeps, by closed forms and eigenvalues of states."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from asperity import Friction
from asperity.structures.modal import modal_answers
from asperity.structures.squeal import CreepingContact, poles_of, ringing_modes, standing_modes
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


# --- one mass on two springs or one, against eigenvalues of its states and closed forms of their boundary

MASS, LOSS = 40.0, 90.0  # kg, N s/m


def mass_on_springs(up, across, oblique):
    """A mass that is held up and down, sideways, and by what couples both, N/m; damped alike each way."""
    square, ways = np.linalg.eigh(np.array([[up, oblique], [oblique, across]]) / MASS)
    natural = np.sqrt(square)
    return modes_of(natural / TURN, LOSS / (2.0 * MASS * natural), *(ways / math.sqrt(MASS)))


def states(stiffness, damping):
    """Angular frequencies, rad/s, of M q̈ + C q̇ + K q = 0, those with positive real parts."""
    none, one = np.zeros((2, 2)), np.eye(2)
    values = -1j * np.linalg.eigvals(np.block([[none, one], [-stiffness / MASS, -damping / MASS]]))
    return np.sort_complex(values[values.real > 0.0])


@pytest.mark.parametrize("oblique", [6e7, -6e7])
@pytest.mark.parametrize("side", [0.97, 1.03])
def test_constant_friction_couples_two_modes_to_flutter_beyond_its_closed_form(oblique, side):
    """Hoffmann et al. (2002): F = κ N with N = k_N z makes K unsymmetric.

    [[k_z + k_N, k], [k − κ k_N, k_y]]: its eigenvalues p ± iq are complex where 4 k (κ k_N − k) is more than
    (k_z + k_N − k_y)², and damping c alike each way is overcome where q² > c² p/m. Of the other sign κ draws
    the frequencies apart.
    """
    normal, up, across = 4e8, 1e8, 5.4e8
    mean, apart = 0.5 * (up + normal + across), up + normal - across
    overcome = LOSS**2 * mean / MASS  # q², (N/m)²
    critical = ((4.0 * overcome + apart**2) / (4.0 * oblique) + oblique) / normal
    assert 0.1 < abs(critical) < 0.3
    for sign in (1.0, -1.0):
        kappa = sign * side * critical
        contact, wheel = CreepingContact(normal, RIGID, 0.0, kappa), mass_on_springs(up, across, oblique)
        stiffness = np.array([[up + normal, oblique], [oblique - kappa * normal, across]])
        both = states(stiffness, LOSS * np.eye(2)), roots_of(contact, wheel)
        expected, found = (each[np.argsort(each.real + 0.1 * each.imag)] for each in both)
        assert found == pytest.approx(expected, rel=1e-8)
        flutters = sign > 0.0 and side > 1.0
        assert np.sum(found.imag < 0.0) == (1 if flutters else 0)
        assert (np.ptp(found.real) < 1e-3 * found.real.mean()) == flutters


@pytest.mark.parametrize("side", [0.9, 1.1])
def test_falling_friction_is_unstable_where_its_slope_is_more_than_the_damping(side):
    """A mass on a belt: −β = N |dµ/dv| against c, growth (−β − c)/2m; constant and rising friction damp.

    Of Coulomb's coefficient µ_s (k + (1 − k) exp(−v/v₀)), by the slope that a case has for it.
    """
    load, kinetic, fall, slip = 5e3, 0.6, 0.5, 0.2
    friction, step = Friction(0.3, kinetic, fall), 1e-6
    speeds = np.array([slip - step, slip + step])
    slope = float(np.diff(friction.coefficient(speeds, np.ones(2, dtype=bool)))[0]) / (2.0 * step)
    assert slope == pytest.approx(-0.3 * (1.0 - kinetic) / fall * math.exp(-slip / fall), rel=1e-6)
    loss, stiffness = -load * slope / side, 5e8
    natural = math.sqrt(stiffness / MASS)
    wheel = modes_of([natural / TURN], [loss / (2.0 * MASS * natural)], [0.0], [MASS**-0.5])
    for beta, growth in ((load * slope, 0.5 * (side - 1.0) * loss / MASS), (0.0, -0.5 * loss / MASS)):
        (root,) = roots_of(CreepingContact(1e9, RIGID, beta, 0.3), wheel)
        assert -root.imag == pytest.approx(growth, rel=1e-6)
        damping = np.diag([1e-3, loss + beta])
        assert root == pytest.approx(states(np.diag([9e9, stiffness]), damping)[0], rel=1e-8)
    assert (side > 1.0) == (load * slope + loss < 0.0)


def test_a_spring_in_line_delays_what_friction_does():
    """With it the states are three: m ÿ + c ẏ + k y = −k_T e, β (ẏ − ė) = k_T e; stable, unstable alike."""
    stiffness, spring, natural = 5e8, 2e9, math.sqrt(5e8 / MASS)
    wheel = modes_of([natural / TURN], [LOSS / (2.0 * MASS * natural)], [0.0], [MASS**-0.5])
    for beta in (-80.0, -100.0, -3e3, 3e3):
        moving = [-stiffness / MASS, -LOSS / MASS, -spring / MASS]
        values = -1j * np.linalg.eigvals(np.array([[0.0, 1.0, 0.0], moving, [0.0, 1.0, -spring / beta]]))
        (root,) = roots_of(CreepingContact(1e9, spring, beta, 0.0), wheel)
        assert root == pytest.approx(values[values.real > 1.0][0], rel=1e-8)
        assert (root.imag < 0.0) == (beta < -LOSS)


def test_waves_of_one_mode_are_told_apart_from_modes():
    """As a wheel turns, each mode with nodal diameters is two; each gets the number of what it is at rest."""
    none = np.zeros(5)
    wheel = WheelModes(np.linspace(200.0, 900.0, 5), none + 1e-3, np.array([1, 0, 2, 2, 0]), np.zeros(1),
                       none[:, None] + 0.1, none[:, None] + 0.1, none, none)  # fmt: skip
    assert standing_modes(wheel.turning(10.0)).tolist() == [1, 1, 2, 3, 3, 4, 4, 5]


@pytest.mark.parametrize(("force", "rings"), [(1.0, 0), (-1.0, 1), (1.0j, 2)])
def test_the_mode_that_rings_is_the_one_that_both_forces_push_together(force, rings):
    """Three modes as far off: pushed by f + 1, f − 1 and 1.9 f times the lateral force."""
    radial, axial = np.array([[1.0, 1.0, 1.9], [1.0, -1.0, 0.0]])
    modes = SimpleNamespace(
        natural_frequencies=np.full(3, 1e3), damping_ratios=np.full(3, 1e-4), at=lambda _: (radial, axial)
    )
    omega = np.array([2.0 * np.pi * 1.1e3 + 0.0j])
    assert ringing_modes(modes, 0.0, omega, np.array([force])).tolist() == [rings]
