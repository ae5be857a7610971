"""A contact that does not carry its load in the mean is refused; slow, short and flying motion is not."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from asperity.errors import ComputationError
from asperity.rolling.ground import Path, ground_of
from asperity.rolling.roll import free_motion, refuse_missed_load
from asperity.structures.beam import Beam, SupportedBeam
from asperity.structures.body import Body
from refusals import refusals

LOAD, MASS, STEP = 65e3, 600.0, 1e-4


def judge(force, reach=0.5e-3, settled=0):
    refuse_missed_load("hertz", force, LOAD, MASS, reach, STEP, settled)


def bounded(seed, count):
    """Force of a bounded motion, whose acceleration is the difference of random velocities of 5 cm/s."""
    return LOAD - MASS * np.diff(0.05 * np.random.default_rng(seed).normal(size=count + 1)) / STEP


test_a_mass_that_falls_or_flies_off_is_refused = refusals(
    (bounded(0, 10000) - 0.05 * LOAD, r"hertz: the mean .* misses the load of 6.5e.*rolls 2.7 m away"),
    (bounded(0, 10000) - LOAD, "misses the load"),
    (np.where(np.arange(10000) % 1500 == 0, 4e8, 0.0), "standard error"),  # several loads in the mean
    (np.repeat([LOAD, 0.0], [20, 30]), r"nothing touches in all of the rec.* load 6.5e\+04 N"),
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
    displacement = amplitude * LOAD / MASS * (count * STEP / (2 * np.pi * periods)) ** 2 * np.sin(angle)
    judge(LOAD * (1.0 + amplitude * np.sin(angle)), reach=max(np.ptp(displacement), 1e-12))


@given(restitution=st.floats(0.3, 0.95), height=st.floats(1e-4, 1e-2), count=st.integers(50, 5000))
@settings(max_examples=60)
def test_flights_are_never_refused(restitution, height, count):
    """It hops, thrown anew whenever it has come to rest."""
    pull = LOAD / MASS
    thrown = speed = np.sqrt(2 * height * pull)
    force = [LOAD, LOAD + MASS * speed / STEP]
    while len(force) < count:
        steps = max(int(2 * speed / pull / STEP), 1)
        back = restitution * speed if speed > 0.3 * thrown else thrown
        force += [0.0] * steps + [MASS * (steps * pull * STEP - speed + back) / STEP + LOAD]
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
    path = Path.laid(0.1, 1.0, 1e-4, 0.8, 0.0)
    for beam, expected in ((Beam, 1.0 / 48e4), (SupportedBeam, np.inf)):
        over = beam(1.0, 1e4, 10.0, highest_frequency=2e4)
        assert ground_of(over, path, np.zeros(0)).softest == pytest.approx(expected, rel=1e-3)
