"""Contacts between any two of bodies and structures: against bodies on a plane, and closed forms."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from asperity.errors import ExtrapolationWarning, LargeDeflectionWarning
from asperity.laws import HertzLaw, Linear, Printed
from asperity.reduction.stiffness import ForceCurve
from asperity.reduction.texture import StateTexture
from asperity.rolling.course import laid_out, laid_together, steps_beyond
from asperity.rolling.driver import roll_mechanism
from asperity.rolling.mechanism import Mechanism, RollingContact, Side
from asperity.rolling.roll import roll_bodies
from asperity.rolling.trajectory import Trajectory
from asperity.structures.body import Body, chain
from asperity.structures.modal import ModalStructure
from asperity.structures.rail_poles import RailBetween
from one_contact import Stepped, rough, same
from refusals import refusals

SPEED, STEP, TIME = 1.0, 1e-5, 0.02
MASS, ABOVE, SPRING, LOAD = 0.02, 0.5, 4e6, 8.0
BELOW = HertzLaw(2e10, rough(2e-7, 1e-4, -0.01), damping=5.0)


def running(step):
    """A contact that runs from zero on."""
    return Trajectory(
        lambda steps: SPEED * step * np.asarray(steps), lambda steps: np.full(len(steps), SPEED)
    )


ALONG = running(STEP)
along = ALONG.places


def plate(mass, frequency=0.0, damping=0.0):
    """A mass that moves as a whole, held by a spring or by nothing."""
    shape = np.full((2, 1), mass**-0.5)
    return ModalStructure([-1.0, 1.0], [frequency], damping, shape)


def between(step):
    """A ball between a plane and a heavy plate that presses on it with a spring."""
    none, rows = np.zeros((1, 1)), np.array([[1.0], [-1.0]])
    ball = Body(np.array([[MASS]]), none, none, rows, np.array([MASS * 9.80665]), np.zeros(2))
    upper = Linear(0.0, SPRING)
    at = running(step)
    contacts = [RollingContact(BELOW, at.places), RollingContact(upper, at.places, (Side(0, at),))]
    force = np.array([LOAD + ABOVE * 9.80665]) * -(ABOVE**-0.5)
    return Mechanism([plate(ABOVE)], [ball], contacts, [force])


def test_a_ball_between_two_planes_is_a_chain_on_one():
    """The plate moves up by q; the upper contact opens with q − b, the lower one with b."""
    two, errors = chain([MASS, ABOVE], [SPRING], [0.0], load=LOAD), []
    for step in (STEP, 0.5 * STEP):
        run = roll_mechanism(between(step), 10.0, time_step=step, duration=TIME)
        keys = {"speed": SPEED, "start": 0.0, "duration": TIME, "time_step": step, "positions": [0.0]}
        other = roll_bodies(None, [two], [BELOW], **keys)
        same(run.contact_force[:, 0], [other.contact_force[0, 0], LOAD + ABOVE * 9.80665], 1e-9)
        missed = np.abs(run.contact_force[0] - other.contact_force[0]).max()
        errors.append(missed / np.ptp(other.contact_force[0]))
        assert run.energy.residual < 1e-6
    assert errors[1] < 1e-3  # of the spring above, which the chain carries on exactly
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)


def test_two_structures_swing_against_each_other_with_their_reduced_mass():
    """No body between them: ω² = k (1/m + 1/M), from the forces that press them."""
    light, heavy, k, press = 0.2, 0.8, 1e6, 3.0
    sides = Side(0, ALONG, 1.0), Side(1, ALONG, -1.0)
    contact = RollingContact(Linear(0.0, k), along, sides)
    forces = [np.array([-press]) / light**0.5, np.array([press]) / heavy**0.5]
    both = Mechanism([plate(light), plate(heavy)], [], [contact], forces)
    run = roll_mechanism(both, press, time_step=STEP, duration=TIME)
    assert_allclose(run.contact_force, press, rtol=1e-9)
    waved = RollingContact(Linear(0.0, k), along, sides, heights=lambda steps: 1e-6 * (np.asarray(steps) > 9))
    run = roll_mechanism(
        Mechanism(both.structures, [], [waved], forces), press, time_step=STEP, duration=TIME
    )
    omega, time = np.sqrt(k * (1 / light + 1 / heavy)), STEP * np.arange(run.contact_force.shape[1])
    swing = run.contact_force[0, 10:] - press
    assert_allclose(swing, k * 1e-6 * np.cos(omega * (time[10:] - 9.5 * STEP)), atol=0.02)


def test_a_spring_between_two_places_of_one_structure_is_opened_by_their_difference():
    """A free bar that turns, in a spring from one arm to the frame through the other: ω² = k (a + b)²/J."""
    inertia, arms, k, press = 0.02, (0.3, -0.2), 1e6, 3.0
    bar = np.linspace(-1.0, 1.0, 9)
    turning = ModalStructure(bar, [0.0], 0.0, (bar * inertia**-0.5)[:, None])
    sides = tuple(
        Side(0, Trajectory(lambda s, at=at: np.full(len(s), at), lambda s: np.zeros(len(s))), np.sign(at))
        for at in arms
    )
    contact = RollingContact(Linear(0.0, k), along, sides, lambda s: 1e-6 * (np.asarray(s) > 9))
    made = Mechanism([turning], [], [contact], [np.array([-press * 0.5 * inertia**-0.5])])
    force = roll_mechanism(made, press, time_step=STEP, duration=TIME).contact_force[0]
    omega, time = np.sqrt(k * 0.5**2 / inertia), STEP * np.arange(len(force))
    assert_allclose(force[10:] - press, k * 1e-6 * np.cos(omega * (time[10:] - 9.5 * STEP)), atol=0.02)


def test_a_structure_that_nothing_holds_or_presses_starts_where_it_is():
    """It falls under the body from then on: F = P − (P/M)/(1/m + 1/M) (1 − cos ωt), ω² = k (1/m + 1/M)."""
    light, heavy, k, press = 0.2, 0.8, 1e6, 3.0
    path = {"speed": SPEED, "start": 0.0, "duration": TIME, "time_step": STEP, "positions": [0.0]}
    run = roll_bodies(plate(heavy), [Body.rigid(light, press)], [Linear(press, k)], **path)
    both = 1 / light + 1 / heavy
    swing = 1.0 - np.cos(np.sqrt(k * both) * run.time)
    assert_allclose(run.contact_force[0], press - press / heavy / both * swing, atol=2e-3)


def test_what_swings_along_a_slope_works_on_it_at_the_rate_that_is_given():
    """On a mode that tilts: its drive takes up what bodies and structure lose, and nothing else."""
    turning = 2 * np.pi * 200.0
    swing = Trajectory(
        lambda steps: 0.2 + 0.1 * np.sin(turning * STEP * np.asarray(steps)),
        lambda steps: 0.1 * turning * np.cos(turning * STEP * np.asarray(steps)),
    )
    across = np.linspace(-1.0, 1.0, 9)
    tilting = ModalStructure(across, [10.0], 0.0, across[:, None])
    contact = RollingContact(Linear(LOAD, 1e6, damping=2.0), swing.places, (Side(0, swing),))
    run = roll_mechanism(
        Mechanism([tilting], [Body.rigid(MASS, LOAD)], [contact]), LOAD, time_step=STEP, duration=TIME
    )
    slope = run.energy.shares["slope of the structure"]
    assert abs(slope) > 0.01 * run.energy.throughput
    assert run.energy.residual < 1e-6


def test_a_law_that_contacts_share_is_laid_out_once_as_for_each_of_them():
    asked = []

    class Counted(Printed):
        def prepare(self, positions):
            asked.append(len(positions))
            return super().prepare(positions)

    heights = 1e-7 * np.random.default_rng(3).normal(size=(2, 400))
    texture = StateTexture(heights, np.array([0.0, 1e-6]), -0.1, 1e-3)
    curve = ForceCurve.hertz(1e10)
    shared, other = Counted(curve, texture, 0.0), HertzLaw(1e10)
    raising = [
        None,
        lambda steps: 1e-8 * np.arange(len(steps)),
        None,
        lambda steps: np.full(len(steps), 3e-8),
    ]
    contacts = [
        RollingContact(law, lambda steps, k=k: 1e-3 * np.asarray(steps) + 0.01 * k, heights=raised)
        for k, (law, raised) in enumerate(zip([shared, shared, other, shared], raising, strict=True))
    ]
    steps = range(3, 60)
    together = laid_together(contacts, steps)
    assert asked == [3 * len(steps)]
    for found, contact in zip(together, contacts, strict=True):
        expected = laid_out(contact, steps)
        for name, value in expected._asdict().items():
            assert_allclose(getattr(found, name), value, rtol=1e-11, atol=1e-20, err_msg=name)


def test_a_structure_that_bends_far_is_warned_of():
    """A mode that yields by F φ²/ω²: 8 N on 40 g at 1 Hz, 5 m of 2 m."""
    across = np.linspace(-1.0, 1.0, 9)
    soft = ModalStructure(across, [1.0], 0.0, np.full((9, 1), 5.0))
    made = Mechanism([soft], [Body.rigid(MASS, LOAD)], [on(Side(0, ALONG))])
    with pytest.warns(LargeDeflectionWarning, match="the structure is displaced by up to 5"):
        roll_mechanism(made, LOAD, time_step=STEP, duration=1e-4)


def test_a_law_beyond_its_data_is_warned_of():
    class Short:
        name, damping = "short", 0.0

        def prepare(self, positions):
            return BELOW.prepare(positions)._replace(upper=1e-9)

    ball = Body.rigid(MASS, LOAD)
    with pytest.warns(ExtrapolationWarning, match=r"short: .* in \d+ of 101 time steps"):
        roll_mechanism(
            Mechanism([], [ball], [RollingContact(Short(), along)]), LOAD, time_step=STEP, duration=1e-3
        )


def test_the_thesis_law_is_beyond_its_data_by_its_approach_whatever_the_texture():
    """Its force curve is read at the approach, not at what is left above the texture."""
    raised = Printed(ForceCurve.hertz(2e10), StateTexture.unfiltered(np.full(400, 1e-6), 1e-4, -0.01), 1e-6)

    law = raised.prepare(np.arange(5) * 1e-5)._replace(upper=4e-7)
    assert steps_beyond(law, 1, np.array([3e-7, 5e-7, 5e-7, 9e-7])) == 3
    assert steps_beyond(law, 1, np.full(4, 3e-7)) == 0


def test_laws_that_are_solved_in_every_step_go_beside_others():
    """The same law looked up; heights of a contact raise both."""
    runs = []
    for law in (BELOW, Stepped(BELOW)):
        made = between(STEP)
        lower = RollingContact(law, along, heights=lambda steps: 1e-7 * np.sin(np.asarray(steps) / 30.0))
        made = replace(made, contacts=[lower, made.contacts[1]])
        runs.append(roll_mechanism(made, 10.0, time_step=STEP, duration=2e-3).contact_force)
    same(runs[1], runs[0], 3e-5)  # each step to 1e-6
    assert np.ptp(runs[0][0]) > 1.0


BALL = Body.rigid(MASS, LOAD)
RAIL = object.__new__(RailBetween)


def on(*sides):
    return RollingContact(BELOW, along, sides)


test_what_is_no_mechanism_is_refused = refusals(
    (lambda: Mechanism([], [BALL], []), "contacts.*0 for 1 contact .*one for each contact of a body"),
    (lambda: Mechanism([], [BALL], [on(Side(0, ALONG))]), "structure of a contact"),
    (lambda: Mechanism([RAIL, RAIL], [BALL], [on(Side(0, ALONG))]), "structures.*2 rails.*one at most"),
    (
        lambda: Mechanism([RAIL, plate(1.0)], [BALL], [on(Side(0, ALONG), Side(1, ALONG, -1.0))]),
        r"sides of a contact on a rail: received 2 of signs \[1.0, -1.0\].*alone, with a sign of 1",
    ),
    (
        lambda: Mechanism([RAIL], [BALL], [on(Side(0, ALONG, -1.0))]),
        r"sides of a contact on a rail: received 1 of signs \[-1.0\]",
    ),
)


def test_a_law_that_python_steps_is_laid_out_for_each_contact():
    """Its state is that of one contact; here what is laid out are the places themselves."""
    law = SimpleNamespace(prepare=lambda positions: positions)
    contacts = [RollingContact(law, lambda steps, at=at: at + np.array(steps), ()) for at in (0.5, 2.5)]
    np.testing.assert_array_equal(laid_together(contacts, range(3, 4)), [[3.5], [5.5]])
