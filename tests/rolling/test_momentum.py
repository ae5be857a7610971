"""A contact that does not carry its load in the mean is refused; slow, short and flying motion is not."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from asperity.errors import ComputationError
from asperity.rolling.ground import ground_of
from asperity.rolling.outcome import free_motion, refuse_missed_load
from asperity.rolling.path import Path
from asperity.structures.beam import Beam
from asperity.structures.body import Body

LOAD, MASS, STEP = 65e3, 600.0, 1e-4
REACH = 0.5e-3


def force_of(acceleration):
    """Of a mass, by its equation of motion."""
    return LOAD - MASS * acceleration


def judge(force, reach=REACH):
    refuse_missed_load("hertz", force, LOAD, MASS, reach, STEP)


def noise(seed, count):
    """Acceleration of a motion that is bounded: the difference of random velocities of 5 cm/s."""
    return np.diff(0.05 * np.random.default_rng(seed).normal(size=count + 1)) / STEP


@pytest.mark.parametrize("share", [0.05, 1.0])
def test_a_mass_that_falls_is_refused(share):
    falls = noise(0, 10000) + share * LOAD / MASS
    with pytest.raises(
        ComputationError, match=r"hertz: the mean contact force of .* misses the load of 6.5e"
    ):
        judge(force_of(falls))


def test_a_record_of_nothing_is_refused_however_short():
    force = np.r_[np.full(20, LOAD), np.zeros(30)]
    judge(force)
    with pytest.raises(ComputationError, match=r"nothing touches in all of the rec.* load 6.5e\+04 N"):
        refuse_missed_load("hertz", force, LOAD, MASS, REACH, STEP, settled=20)


def test_a_mean_of_several_loads_is_outside_any_scatter():
    blows = np.where(np.arange(10000) % 1500 == 0, 4e8, 0.0)
    with pytest.raises(ComputationError, match="standard error"):
        judge(blows)


@given(seed=st.integers(0, 10**6), count=st.integers(2, 3000))
@settings(max_examples=60)
def test_a_bounded_motion_is_never_refused_however_short(seed, count):
    judge(force_of(noise(seed, count)), reach=0.05 * STEP * 3)


@given(
    periods=st.floats(0.01, 30.0),
    phase=st.floats(0.0, 6.3),
    amplitude=st.floats(0.0, 0.9),
    count=st.integers(300, 3000),
)
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
    speed = np.sqrt(2 * height * pull)
    force = [LOAD, LOAD + MASS * speed / STEP]
    while len(force) < count:
        flight = 2 * speed / pull
        steps = max(int(flight / STEP), 1)
        back = restitution * speed if speed > 0.3 * np.sqrt(2 * height * pull) else np.sqrt(2 * height * pull)
        force += [0.0] * steps + [MASS * (steps * pull * STEP - speed + back) / STEP + LOAD]
        speed = back
    judge(np.array(force[:count]), reach=1e-4)


def test_a_body_on_two_contacts_falls_as_one():
    """A bar of 4 kg and 0.1 kg m² on two contacts, 0.3 and 0.5 m from its middle."""
    empty = np.zeros(0)
    contacts = np.array([[1.0, 0.3], [1.0, -0.5]])
    mass, none = np.diag([4.0, 0.1]), np.zeros((2, 2))
    bar = Body(mass, none, none, contacts, np.array([40.0, 0.0]), np.zeros(2), empty, empty, np.zeros((2, 0)))
    shape, moved, load = free_motion(bar)
    np.testing.assert_allclose(shape, [1.0, 1.0])
    assert (moved, load) == (pytest.approx(4.0), pytest.approx(40.0))
    held = Body(mass, none, np.diag([1e6, 0.0]), contacts, bar.pressing, bar.places, empty, empty, bar.shapes)
    assert free_motion(held) is None


def test_a_beam_gives_way_by_what_it_bends_at_most():
    """F L³/48 B in its middle; without bound where nothing holds it."""
    beam = Beam(1.0, 1e4, 10.0, highest_frequency=2e4)
    path = Path.laid(0.1, 1.0, 1e-4, 0.8, 0.0)
    assert ground_of(beam, path, np.zeros(0)).softest == pytest.approx(1.0 / 48e4, rel=1e-3)
    two, ones = np.array([0.0, 100.0]), np.ones((8001, 2))
    loose = SimpleNamespace(
        natural_frequencies=two, damping_ratios=two, extent=(0.0, 1.0), shapes=lambda x: (ones[: len(x)],) * 2
    )
    assert ground_of(loose, path, np.zeros(0)).softest == np.inf
