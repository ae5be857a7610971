"""One body on a structure of one's own, by its modes: closed forms, and laws that Python steps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from shelf import Shelf

from asperity.laws import HertzLaw, Linear
from asperity.laws.layout import force
from asperity.reduction.texture import StateTexture
from asperity.rolling.roll import roll_bodies
from asperity.structures.body import Body
from asperity.structures.modal import STATIC, STATIC_DAMPING
from asperity.structures.moving_kernel import moving_kernel
from asperity.structures.rail_poles import rail_poles
from asperity.structures.track import Track
from asperity.structures.wheel import Wheel
from one_contact import first_contact, roll_wheel

TRACK = Track(
    bending_stiffness=4.725e6, mass_per_length=60.0, rail_loss_factor=0.004, pad_stiffness=300e6,
    pad_damping=18e3, sleeper_mass=150.0, ballast_stiffness=150e6, ballast_damping=48e3, sleeper_spacing=0.6,
)  # fmt: skip
RINGING = Wheel(600.0, 65e3, [400.0, 2000.0], [0.01, 0.002], [300.0, 100.0])

MASS, LOAD, CONTACT = 0.5, 5.0, 2e7
OMEGA, DRIVEN = np.sqrt(CONTACT / MASS), 2 * np.pi * 350.0


@dataclass(frozen=True)
class OneMode:
    """A mass on a spring and a damper, the same all along the path; without mass, a foundation."""

    mass: float
    stiffness: float
    damping: float = 0.0

    extent = (-10.0, 1e3)

    @property
    def natural(self):
        return np.sqrt(self.stiffness / self.mass) if self.mass else 2.0 * np.pi * STATIC

    @property
    def natural_frequencies(self):
        return np.array([self.natural / (2.0 * np.pi)])

    @property
    def damping_ratios(self):
        if not self.mass:
            return np.array([STATIC_DAMPING])
        return np.array([0.5 * self.damping / np.sqrt(self.stiffness * self.mass)])

    def shapes(self, x):
        shape = self.natural / np.sqrt(self.stiffness)  # φ²/ω² = 1/k
        return np.full((np.size(x), 1), shape), np.zeros((np.size(x), 1))

    def shapes_along(self, start, spacing, count):
        return self.shapes(np.zeros(count))


def rolled(over, law, **path):
    path = {"speed": 1.0, "start": 0.0, "positions": [0.0]} | path
    return first_contact(roll_bodies(over, [Body.rigid(MASS, LOAD)], [law], **path))


def waves(amplitude, speed=1.0, start=0.0, length=1.2):
    """A texture −a sin(Ω x / v): the peaks lift the body."""
    x = start + np.arange(round(length / 2e-5)) * 2e-5
    return StateTexture.unfiltered(-amplitude * np.sin(DRIVEN * x / speed), 2e-5, start)


@pytest.mark.filterwarnings("ignore::asperity.errors.CoarseSamplingWarning")
def test_a_mass_over_waves_of_rigid_ground_is_the_closed_form_to_second_order():
    # m z'' = −k (z − h), h = a sin Ωt downwards, from rest: Duhamel's integral
    law = Linear(LOAD, CONTACT, texture=waves(-1e-8))
    errors = []
    for h in (2e-5, 1e-5, 5e-6):
        run = rolled(None, law, duration=0.02, time_step=h)
        z = run.rolling_displacement - run.rolling_displacement[0]
        scale = 1e-8 * OMEGA**2 / (OMEGA**2 - DRIVEN**2)
        closed = scale * (np.sin(DRIVEN * run.time) - DRIVEN / OMEGA * np.sin(OMEGA * run.time))
        errors.append(np.abs(z - closed).max() / np.abs(closed).max())
    assert errors[-1] < 2e-3
    assert 3.8 < errors[0] / errors[1] < 4.2
    assert 3.8 < errors[1] / errors[2] < 4.2


def harmonic(run, cycles):
    """Amplitude and phase of the force at the driving frequency, over its last whole cycles, against sin."""
    count = round(cycles * 2 * np.pi / DRIVEN / run.time[1])
    t, f = run.time[-count:], run.contact_force[-count:] - LOAD
    return 2.0 * np.mean(f * np.exp(-1j * DRIVEN * t)) * 1j


@pytest.mark.filterwarnings("ignore::asperity.errors.CoarseSamplingWarning")
@pytest.mark.parametrize(
    ("over", "receptance"),
    [
        (OneMode(0.0, 3e6), 1 / 3e6),
        (OneMode(2.0, 4e6, 900.0), 1 / (4e6 - 2.0 * DRIVEN**2 + 900j * DRIVEN)),
    ],
    ids=["elastic foundation", "oscillator"],
)
def test_steady_waves_give_the_force_of_the_receptances(over, receptance):
    # F = −h / (α of the ball + α of the contact + α of what is rolled over); contact damping ends the start
    damping, a = 2000.0, 1e-8
    law = Linear(LOAD, CONTACT, texture=waves(a), damping=damping)
    step = 2 * np.pi / DRIVEN / 400
    run = rolled(over, law, duration=0.4, time_step=step)
    contact = 1 / (CONTACT + 1j * DRIVEN * damping)
    spring = CONTACT * contact  # the texture works on the spring alone
    expected = a * spring / (receptance + contact - 1 / (MASS * DRIVEN**2))
    assert harmonic(run, 40) == pytest.approx(expected, rel=1e-3)


@pytest.mark.filterwarnings("ignore::asperity.errors.CoarseSamplingWarning")
def test_two_degrees_of_freedom_against_an_adaptive_integrator():
    over, law = OneMode(0.8, 3e6, 150.0), Linear(LOAD, CONTACT, texture=waves(2e-8))
    run = rolled(over, law, duration=0.01, time_step=2e-7)

    def rates(t, y):
        below, below_rate, above, above_rate = y
        push = LOAD + CONTACT * (above - below + 2e-8 * np.sin(DRIVEN * t))
        bent = (push - 150.0 * below_rate - 3e6 * below) / 0.8
        return [below_rate, bent, above_rate, (LOAD - push) / MASS]

    rest = [LOAD / 3e6, 0.0, LOAD / 3e6, 0.0]
    told = solve_ivp(rates, (0, run.time[-1]), rest, "DOP853", run.time[::100], rtol=1e-12, atol=1e-18).y
    for found, expected in ((run.over_displacement, told[0]), (run.rolling_displacement, told[2])):
        swing = np.abs(expected - expected[0]).max()
        assert np.abs(found[::100] - expected).max() < 2e-6 * swing


def test_a_ball_that_leaves_the_ground_falls_freely():
    # a step down by more than the approach: F = 0 and the body accelerates by P/m
    texture = StateTexture.unfiltered(np.where(np.arange(2000) < 300, 0.0, 1e-5), 1e-5)
    run = rolled(None, HertzLaw(2.4e10, texture), duration=0.008, time_step=1e-6)
    flight = run.contact_loss[0]
    away = slice(round(flight.start / 1e-6) + 1, round((flight.start + flight.duration) / 1e-6) - 1)
    t, y = run.time[away], run.rolling_displacement[away]
    assert len(t) > 500
    assert np.polyfit(t - t[0], y, 2)[0] == pytest.approx(0.5 * LOAD / MASS, rel=1e-6)
    assert not run.contact_force[away].any()


def rough(rms, spacing, start, points=4000):
    steps = np.random.default_rng(2).standard_normal(points)
    heights = np.convolve(steps, np.hanning(30), mode="same")
    return StateTexture.unfiltered(rms * heights / heights.std(), spacing, start)


@pytest.fixture(scope="module")
def kernel():
    return moving_kernel(TRACK, 56.0, 50e-6, duration=0.06, positions=12)


@pytest.fixture(scope="module")
def poles(kernel):
    return rail_poles(kernel, 60)


@dataclass
class Stepped:
    """A law stepped from Python, which can be interrupted amid a step."""

    law: object
    fails_at: int = -1
    damping: float = 0.0
    name: str = "stepped"

    def prepare(self, positions):
        return SteppedOnPath(self, positions)


class SteppedOnPath:
    def __init__(self, law, positions):
        self.law, self.positions, self.calls = law, positions, 0

    def evaluate(self, step, approach):
        if step == self.law.fails_at:
            raise KeyboardInterrupt
        self.calls += 1
        at, d = self.positions[step], 1e-12
        here, beyond = (force(self.law.law, [at], approach + by)[0] for by in (0.0, d))
        return here, (beyond - here) / d

    def accept(self, step):
        pass

    def state(self):
        return {"calls": np.array(self.calls)}

    def restore(self, state):
        self.calls = int(state["calls"])

    def warn_of_flaws(self):
        pass


def test_a_law_that_python_steps_is_the_compiled_one(poles):
    """Its contact is solved to 1e-6, that of the compiled law to 1e-10."""
    law = HertzLaw(9.4e10, rough(1e-5, 1e-3, -0.5))
    path = {"start": 0.53, "duration": 0.005, "settling": 0.001}
    forces = [roll_wheel(poles, RINGING, each, **path).contact_force for each in (law, Stepped(law))]
    np.testing.assert_allclose(forces[1], forces[0], rtol=1e-4)


def interrupted_amid_a_step(along, law):
    """Roll to a step whose contact is interrupted, and go on from what was kept."""
    shelf = Shelf()
    whole = along(Stepped(law), None)
    with pytest.raises(KeyboardInterrupt):
        along(Stepped(law, fails_at=43), shelf)
    assert 30 <= shelf.arrays["motion.counts"][0] < 43
    resumed = along(Stepped(law), shelf)
    np.testing.assert_array_equal(resumed.contact_force, whole.contact_force)
    assert resumed.evaluations == whole.evaluations


@pytest.mark.parametrize("scattered", [False, True], ids=["poles", "scattered"])
def test_a_wheel_that_is_interrupted_amid_a_step_goes_on_bit_by_bit(kernel, poles, scattered):
    def along(law, checkpoint):
        return roll_wheel(
            kernel if scattered else poles, RINGING, law, start=0.53, duration=0.003, settling=0.001,
            checkpoint=checkpoint,
        )  # fmt: skip

    interrupted_amid_a_step(along, HertzLaw(9.4e10, rough(1e-5, 1e-3, -0.5)))
