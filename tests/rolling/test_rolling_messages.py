"""What rolling bodies refuse, warn of, and fail with; a contact that does not carry its load in the mean."""

import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from asperity import Beam, SupportedBeam, Track, errors, material
from asperity.errors import ComputationError, Outcome
from asperity.kernels import stepping
from asperity.laws import HertzLaw, Linear
from asperity.reduction.texture import StateTexture
from asperity.rolling.course import Course
from asperity.rolling.ground import ground_of
from asperity.rolling.mechanism import Mechanism, RollingContact, Side
from asperity.rolling.rest import at_rest
from asperity.rolling.roll import roll_bodies
from asperity.rolling.soundness import free_motion, refuse_missed_load
from asperity.rolling.trajectory import Path
from asperity.structures.body import Body
from asperity.structures.moving_kernel import MovingKernel
from asperity.structures.rail_poles import RailBetween
from one_contact import Stepped, rough
from refusals import refusals

BEAM = Beam.rectangular(1.0, 0.05, 0.01, material("steel"), highest_frequency=2e3)
BALL, LAW, NONE = Body.rigid(0.5, 5.0), Linear(5.0, 1e7), np.zeros((2, 2))
PATH = {"speed": 1.0, "start": 0.3, "duration": 0.01, "time_step": 1e-5}
KERNEL = MovingKernel(Track.named("nordborg"), 1.0, 1e-5, np.ones((4, 100)))
RAIL = RailBetween(KERNEL, {2.5: KERNEL, -2.5: KERNEL})


def body(damping=NONE, stiffness=NONE):
    """Two masses on one contact."""
    parts = np.array(damping), np.array(stiffness), np.array([[1.0, 0.0]]), np.array([5.0, 0.0])
    return Body(np.eye(2), *parts, np.zeros(1))


def rolled(over=None, bodies=(BALL,), laws=(LAW,), positions=(0.0,), **changes):
    return roll_bodies(over, bodies, laws, positions=positions, **PATH | changes)


TWO = {"bodies": [BALL] * 2, "laws": [LAW] * 2}
CLIFF = StateTexture.unfiltered(np.where(np.arange(4000) < 1400, 0.0, -10.0), 1e-5, 0.29)  # of 10 m


test_what_cannot_roll_is_told = refusals(
    ({"bodies": [], "laws": [], "positions": []}, r"bodies: received none.*one or more"),
    (TWO, r"positions of the bodies.*2 finite numbers, one for each body"),
    (TWO | {"positions": [0.0, np.nan]}, r"positions of the bodies.*2 finite numbers"),
    ({"laws": [LAW] * 2}, r"laws.*2.*1, one for each contact"),
    (
        TWO | {"over": BEAM, "positions": [0.0, 0.695]},
        r"path of contact 2.*0.995 to 1.005.*on the structure",
    ),
    ({"sensors": [0.5]}, r"sensors: received 1 on a rigid plane"),
    ({"bodies": [Body.rigid(0.5, 0.0)]}, r"loads of the bodies.*none that presses"),
    ({"bodies": [body([[0, 1.0], [0, 0]])]}, r"damping of a body.*not symmetric"),
    (
        {"bodies": [body(NONE, [[-1e3, 0], [0, 1e3]])]},
        r"stiffness of a body.*negative.*springs that pull back",
    ),
    (
        TWO | {"over": RAIL, "positions": [0.0, 3.0]},
        r"distance of two contacts on the rail.*3.*-2\.5, 2\.5.*rail between",
    ),
    ({"over": RAIL, "speed": 50.0}, r"path.*50 m/s.*kernel was computed"),
    ({"over": RAIL, "sensors": [1.0]}, r"sensors.*a rail is known under the contacts alone"),
    of=lambda changes: rolled(**changes),
)


test_what_fails_is_told = refusals(
    (
        {"laws": [HertzLaw(1e-3)]},
        r"do not come to rest on their contacts \(1\) at the start.*loads of 5 N",
    ),
    (
        TWO | {"laws": [LAW, Linear(5.0, 1e7, 0.0, CLIFF)], "positions": [0.0, 0.0]},
        r"runs away: at step \d+, time .* contact force is .* under a load",
    ),
    of=lambda changes: rolled(**changes),
    error=ComputationError,
)


def test_contacts_that_cannot_carry_together_are_told():
    def weak(approach):
        return np.clip(1e6 * approach, 0.0, 2.51), np.where((approach > 0.0) & (approach < 2.51e-6), 1e6, 0.0)

    one, none = np.ones((1, 1)), np.zeros((1, 1))
    pair = Body(one, none, none, np.ones((2, 1)), np.array([5.0]), np.zeros(2))
    with pytest.raises(ComputationError, match=r"do not come to rest on their contacts \(2\) at the start"):
        at_rest([pair], np.array([0.0, 1e4]), np.zeros((2, 2)), weak, np.full(2, 2.5))


def warned(law, over=BEAM, **changes):
    """A run of two balls, and what was warned of, by category."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        run = rolled(over, [BALL] * 2, [law] * 2, [0.0, 0.1], **changes)
    found = {}
    for warning in caught:
        found.setdefault(warning.category, []).append(str(warning.message))
    return run, found


def test_a_law_beyond_its_data_is_told_once_for_all_contacts():
    class Short:
        name, damping = "short", 0.0

        def prepare(self, positions):
            return HertzLaw(1e9).prepare(positions)._replace(upper=1e-7)

    (message,) = warned(Short())[1][errors.ExtrapolationWarning]
    assert "short: the contact was closer than its largest computed state in 2002 of 2002" in message
    assert "let contact.approaches reach higher" in message


def test_forces_that_miss_the_tolerance_are_counted(monkeypatch):
    """Sweeps of Python: with one alone the contacts have not heard of each other."""
    law = Stepped(Linear(5.0, 1e7, texture=rough(1e-7, 1e-5, 0.29, 20000)))
    assert warned(law, duration=1e-4)[0].outcome is Outcome.CONVERGED
    monkeypatch.setattr(stepping, "SWEEPS", 1)
    run, seen = warned(law, duration=1e-4)
    (message,) = seen[errors.UnconvergedWarning]
    assert "stepped: 10 of 10 time steps (100 %) missed the tolerance" in message
    assert (run.outcome, run.unconverged_steps) == (Outcome.STEPS_UNCONVERGED, 10)


WEIGHT, INERTIA, STEP = 65e3, 600.0, 1e-4


def judge(force, reach=0.5e-3, settled=0):
    refuse_missed_load("hertz", force, WEIGHT, INERTIA, reach, STEP, settled)


def bounded(seed, count):
    """Force of a bounded motion, whose acceleration is the difference of random velocities of 5 cm/s."""
    return WEIGHT - INERTIA * np.diff(0.05 * np.random.default_rng(seed).normal(size=count + 1)) / STEP


test_a_mass_that_falls_or_flies_off_is_refused = refusals(
    (bounded(0, 10000) - 0.05 * WEIGHT, r"hertz: the mean .* misses the load of 65000 N.*rolls 2.7 m away"),
    (bounded(0, 10000) - WEIGHT, "misses the load"),
    (np.where(np.arange(10000) % 1500 == 0, 4e8, 0.0), "standard error"),  # several loads in the mean
    (np.repeat([WEIGHT, 0.0], [20, 30]), r"nothing touches in all of the rec.* load 65000 N"),
    of=lambda force: judge(force, settled=20),
    error=ComputationError,
)


@given(seed=st.integers(0, 10**6), count=st.integers(2, 3000))
@settings(max_examples=60)
def test_a_bounded_motion_is_never_refused_however_short(seed, count):
    judge(bounded(seed, count), reach=0.05 * STEP * 3)


@given(st.floats(0.01, 30.0), st.floats(0.0, 6.3), st.floats(0.0, 0.9), st.integers(300, 3000))
@settings(max_examples=60)
def test_a_slow_oscillation_is_never_refused_however_short(periods, phase, amplitude, count):
    """In contact throughout, with what it deflects and no more."""
    angle = 2 * np.pi * periods * np.arange(count) / count + phase
    displacement = amplitude * WEIGHT / INERTIA * (count * STEP / (2 * np.pi * periods)) ** 2 * np.sin(angle)
    judge(WEIGHT * (1.0 + amplitude * np.sin(angle)), reach=max(np.ptp(displacement), 1e-12))


@given(restitution=st.floats(0.3, 0.95), height=st.floats(1e-4, 1e-2), count=st.integers(50, 5000))
@settings(max_examples=60)
def test_flights_are_never_refused(restitution, height, count):
    """It hops, thrown anew whenever it has come to rest."""
    pull = WEIGHT / INERTIA
    thrown = speed = np.sqrt(2 * height * pull)
    force = [WEIGHT, WEIGHT + INERTIA * speed / STEP]
    while len(force) < count:
        steps = max(int(2 * speed / pull / STEP), 1)
        back = restitution * speed if speed > 0.3 * thrown else thrown
        force += [0.0] * steps + [INERTIA * (steps * pull * STEP - speed + back) / STEP + WEIGHT]
        speed = back
    judge(np.array(force[:count]), reach=1e-4)


def test_a_body_on_two_contacts_falls_as_one():
    """A bar of 4 kg and 0.1 kg m² on two contacts, 0.3 and 0.5 m from its middle."""
    none, rest = np.zeros((2, 2)), (np.array([[1.0, 0.3], [1.0, -0.5]]), np.array([40.0, 0.0]), np.zeros(2))
    shape, moved, load = free_motion(Body(np.diag([4.0, 0.1]), none, none, *rest))
    np.testing.assert_allclose([*shape, moved, load], [1.0, 1.0, 4.0, 40.0])
    assert free_motion(Body(np.diag([4.0, 0.1]), none, np.diag([1e6, 0.0]), *rest)) is None


def test_a_beam_gives_way_by_what_it_bends_at_most():
    """F L³/48 B in its middle; without bound where nothing holds it."""
    (along,) = Path.laid(0.1, 1.0, 1e-4, 0.8, 0.0).trajectories
    contact = RollingContact(LAW, along.places, (Side(0, along),))
    for beam, expected in ((Beam, 1.0 / 48e4), (SupportedBeam, np.inf)):
        over = beam(1.0, 1e4, 10.0, highest_frequency=2e4)
        course = Course(Mechanism([over], [BALL], [contact]), 1e-4, 8000)
        assert ground_of(course, np.zeros((0, 0))).softest == pytest.approx(expected, rel=1e-3)
