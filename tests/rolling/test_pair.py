"""Any two bodies: the general pair against the compiled ones, closed forms, an integrator, interruption."""

import warnings
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from shelf import Shelf

from asperity.errors import CoarseSamplingWarning, InputError
from asperity.laws import HertzLaw, Linear
from asperity.laws.layout import force
from asperity.reduction.texture import StateTexture
from asperity.reference.materials import material
from asperity.rolling import one_body
from asperity.rolling.ball import FreeMass, RollingBall
from asperity.rolling.beam import RolledBeam
from asperity.rolling.pair import roll_pair
from asperity.rolling.path import Path
from asperity.rolling.rail import RolledRail
from asperity.rolling.wheel import RollingWheel
from asperity.structures.beam import Beam
from asperity.structures.body import Ball
from asperity.structures.moving_kernel import moving_kernel
from asperity.structures.rail_poles import rail_poles
from asperity.structures.track import Track
from asperity.structures.wheel import Wheel

STEEL = material("steel")
BALL = Ball(0.025, STEEL)
BEAM = Beam.rectangular(1.0, 0.05, 0.01, STEEL, highest_frequency=5e3)
TRACK = Track(
    bending_stiffness=4.725e6, mass_per_length=60.0, rail_loss_factor=0.004, pad_stiffness=300e6,
    pad_damping=18e3, sleeper_mass=150.0, ballast_stiffness=150e6, ballast_damping=48e3, sleeper_spacing=0.6,
)  # fmt: skip
RIGID = Wheel.rigid(600.0, 65e3)
RINGING = Wheel.from_modes(600.0, 65e3, [400.0, 2000.0], [0.01, 0.002], [300.0, 100.0])


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


# --- laws that Python steps --------------------------------------------------------------------


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


# --- the same as compiled ----------------------------------------------------------------------


def same(found, expected, rel=1e-9):
    np.testing.assert_allclose(found, expected, rtol=rel, atol=rel * np.abs(expected).max())


@pytest.mark.parametrize("support", ["simply-supported", "free"])
def test_a_ball_on_a_beam_is_that_of_the_compiled_stepper(support):
    beam = Beam.rectangular(1.0, 0.05, 0.01, STEEL, highest_frequency=5e3, support=support)
    law = HertzLaw(2.4e10, rough(1e-7, 1e-5, 0.29), damping=2.0)
    path = {"speed": 1.0, "start": 0.3, "duration": 0.02, "time_step": 1e-5, "settling": 0.005}
    compiled = one_body.roll_ball(beam, BALL, law, sensors=[0.5], **path)
    pair = roll_pair(RolledBeam(beam), RollingBall(BALL), law, **path)
    assert np.std(compiled.contact_force) > 0.2 * BALL.static_load
    same(pair.contact_force, compiled.contact_force)
    same(pair.over_displacement, compiled.over_displacement)
    same(pair.rolling_displacement, compiled.rolling_displacement)
    same(pair.relative_displacement, compiled.relative_displacement)
    # flights multiply what rounding leaves: a shorter run of a rougher path
    law, path = HertzLaw(2.4e10, rough(3e-7, 1e-5, 0.29)), path | {"duration": 0.004, "settling": 0.0}
    compiled = one_body.roll_ball(beam, BALL, law, sensors=[0.5], **path)
    pair = roll_pair(RolledBeam(beam), RollingBall(BALL), law, **path)
    assert compiled.contact_loss
    assert pair.contact_loss == compiled.contact_loss


@pytest.mark.parametrize("wheel", [RIGID, RINGING], ids=["rigid", "ringing"])
@pytest.mark.parametrize("scattered", [False, True], ids=["poles", "scattered"])
def test_a_wheel_on_a_rail_is_that_of_the_compiled_stepper(kernel, poles, wheel, scattered):
    rail = kernel if scattered else poles
    law = HertzLaw(9.4e10, rough(2e-5, 1e-3, -0.5))
    where = {"start": 0.53, "duration": 0.03, "settling": 0.011}
    compiled = one_body.roll_wheel(rail, wheel, law, **where)
    pair = roll_pair(RolledRail(rail), RollingWheel(wheel), law, speed=56.0, time_step=50e-6, **where)
    assert np.std(compiled.contact_force) > 0.1 * wheel.load
    same(pair.contact_force, compiled.contact_force)
    same(pair.over_displacement, compiled.over_displacement)
    same(pair.rolling_displacement, compiled.rolling_displacement)


def test_a_law_that_python_steps(poles):
    law = HertzLaw(9.4e10, rough(1e-5, 1e-3, -0.5))
    where = {"start": 0.53, "duration": 0.005, "settling": 0.001}
    compiled = one_body.roll_wheel(poles, RINGING, Stepped(law), **where)
    pair = roll_pair(
        RolledRail(poles), RollingWheel(RINGING), Stepped(law), speed=56.0, time_step=50e-6, **where
    )
    same(pair.contact_force, compiled.contact_force)
    # its contact is solved to 1e-6, that of the compiled law to 1e-10
    known = roll_pair(RolledRail(poles), RollingWheel(RINGING), law, speed=56.0, time_step=50e-6, **where)
    same(pair.contact_force, known.contact_force, rel=1e-4)


# --- structures of one's own: each is one class, and its state ----------------------------------


@dataclass(frozen=True)
class SpringAndDamper:
    """A massless foundation, rolled over: c u' + k u = F, exact for a force that is linear over a step."""

    stiffness: float
    damping: float = 0.0

    def laid(self, path, load):
        return Yielding(self, path.time_step, load)

    def alternating_compliance(self, path):
        decay, before, now = Yielding(self, path.time_step, 0.0).factors
        return (now - before) / (1.0 + decay)


class Yielding:
    def __init__(self, foundation, time_step, load):
        k, c, h = foundation.stiffness, foundation.damping, time_step
        rate = k * h / c if c else np.inf
        decay = np.exp(-rate)
        mean = (1.0 - decay) / rate if c else 0.0
        self.factors = decay, (mean - decay) / k, (1.0 - mean) / k
        self.foundation, self.displacement, self.force = foundation, load / k, load

    @property
    def velocity(self):
        k, c = self.foundation.stiffness, self.foundation.damping
        return (self.force - k * self.displacement) / c if c else 0.0

    def free(self, step, before):
        return self.factors[0] * self.displacement + self.factors[1] * before

    def compliance(self, step):
        return self.factors[2]

    def complete(self, step, before, force):
        self.displacement, self.force = self.free(step, before) + self.factors[2] * force, force

    def state(self):
        return {"spring": np.array([self.displacement, self.force])}

    def restore(self, state):
        self.displacement, self.force = state["spring"]


@dataclass(frozen=True)
class Oscillator:
    """A mass on a spring and a damper, rolled over: m u'' + c u' + k u = F, by the matrix exponential."""

    mass: float
    stiffness: float
    damping: float = 0.0

    def laid(self, path, load):
        return Swinging(self, path.time_step, load)

    def alternating_compliance(self, path):
        side = Swinging(self, path.time_step, 0.0)
        return float(np.linalg.solve(np.eye(2) + side.step, side.now - side.before)[0])


class Swinging:
    def __init__(self, body, time_step, load):
        from scipy.linalg import expm

        m, k, c, h = body.mass, body.stiffness, body.damping, time_step
        generator = np.array(
            [[0, 1, 0, 0], [-k / m, -c / m, 1 / m, 0], [0, 0, 0, 1 / h], [0, 0, 0, 0]], dtype=float
        )
        full = expm(generator * h)
        self.step, self.now = full[:2, :2], full[:2, 3]
        self.before = full[:2, 2] - full[:2, 3]
        self.motion = np.array([load / k, 0.0])

    displacement = property(lambda self: float(self.motion[0]))
    velocity = property(lambda self: float(self.motion[1]))

    def free(self, step, before):
        return float(self.step[0] @ self.motion + self.before[0] * before)

    def compliance(self, step):
        return float(self.now[0])

    def complete(self, step, before, force):
        self.motion = self.step @ self.motion + self.before * before + self.now * force

    def state(self):
        return {"motion": self.motion}

    def restore(self, state):
        self.motion = state["motion"]


class RigidGround:
    """What does not yield at all."""

    displacement = velocity = 0.0

    def laid(self, path, load):
        return self

    def alternating_compliance(self, path):
        return 0.0

    def free(self, step, before):
        return 0.0

    def compliance(self, step):
        return 0.0

    def complete(self, step, before, force):
        pass

    def state(self):
        return {}

    def restore(self, state):
        pass


MASS, LOAD, CONTACT = 0.5, 5.0, 2e7
BODY = RollingBall(Ball(0.025, STEEL, load=LOAD, given_mass=MASS))
OMEGA, DRIVEN = np.sqrt(CONTACT / MASS), 2 * np.pi * 350.0


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
        run = roll_pair(RigidGround(), BODY, law, speed=1.0, start=0.0, duration=0.02, time_step=h)
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
        (SpringAndDamper(3e6, 400.0), 1 / (3e6 + 400j * DRIVEN)),
        (SpringAndDamper(3e6), 1 / 3e6),
        (Oscillator(2.0, 4e6, 900.0), 1 / (4e6 - 2.0 * DRIVEN**2 + 900j * DRIVEN)),
    ],
    ids=["spring and damper", "elastic foundation", "oscillator"],
)
def test_steady_waves_give_the_force_of_the_receptances(over, receptance):
    # F = −h / (α of the ball + α of the contact + α of what is rolled over); contact damping ends the start
    damping, a = 2000.0, 1e-8
    law = Linear(LOAD, CONTACT, texture=waves(a), damping=damping)
    step = 2 * np.pi / DRIVEN / 400
    run = roll_pair(over, BODY, law, speed=1.0, start=0.0, duration=0.4, time_step=step)
    contact = 1 / (CONTACT + 1j * DRIVEN * damping)
    spring = CONTACT * contact  # the texture works on the spring alone
    expected = a * spring / (receptance + contact - 1 / (MASS * DRIVEN**2))
    assert harmonic(run, 40) == pytest.approx(expected, rel=1e-3)


def test_two_degrees_of_freedom_against_an_adaptive_integrator():
    over, law = Oscillator(0.8, 3e6, 150.0), Linear(LOAD, CONTACT, texture=waves(2e-8))
    run = roll_pair(over, BODY, law, speed=1.0, start=0.0, duration=0.01, time_step=2e-7)

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
    run = roll_pair(
        RigidGround(), BODY, HertzLaw(2.4e10, texture), speed=1.0, start=0.0, duration=0.008, time_step=1e-6
    )
    flight = run.contact_loss[0]
    away = slice(round(flight.start / 1e-6) + 1, round((flight.start + flight.duration) / 1e-6) - 1)
    t, y = run.time[away], run.rolling_displacement[away]
    assert len(t) > 500
    assert np.polyfit(t - t[0], y, 2)[0] == pytest.approx(0.5 * LOAD / MASS, rel=1e-6)
    assert not run.contact_force[away].any()


# --- each side keeps what the protocol promises --------------------------------------------------


def sides(kernel, poles):
    path = Path.laid(0.3, 56.0, 50e-6, 5e-3, 0.0)
    slow = Path.laid(0.3, 1.0, 1e-5, 5e-3, 0.0)
    return {
        "beam": RolledBeam(BEAM).laid(slow, 5.0),
        "poles": RolledRail(poles).laid(path, 65e3),
        "scattered": RolledRail(kernel).laid(path, 65e3),
        "ball": RollingBall(BALL).placed(slow, 1e-6, 0.01),
        "wheel": RollingWheel(RINGING).placed(path, 1e-4, 0.01),
        "foundation": SpringAndDamper(3e6, 400.0).laid(slow, 5.0),
        "oscillator": Oscillator(2.0, 4e6, 900.0).laid(slow, 5.0),
    }


DEAD = Beam.rectangular(1.0, 0.05, 0.01, STEEL, loss_factor=0.5)
NAMES = ("beam", "poles", "scattered", "ball", "wheel", "foundation", "oscillator")


@pytest.mark.parametrize("name", NAMES)
def test_a_side_is_linear_in_the_force_at_the_end_of_a_step(kernel, poles, name):
    found = []
    for push in (0.0, 1e3):
        side = sides(kernel, poles)[name]
        free = side.free(1, 700.0)
        side.complete(1, 700.0, push)
        found.append(side.displacement)
        assert side.displacement == pytest.approx(free + side.compliance(1) * push, rel=1e-12)
    assert found[1] > found[0]


@pytest.mark.parametrize("name", NAMES)
def test_the_velocity_is_that_of_the_displacement(kernel, poles, name):
    side = sides(kernel, poles)[name]
    h = 50e-6 if name in ("poles", "scattered", "wheel") else 1e-5
    steady = 65e3 if h == 50e-6 else 5.0
    moved, rates, pushes = [], [], steady * (1.0 + 0.1 * np.sin(np.arange(60) / 9.0))
    for step in range(1, 60):
        side.free(step, pushes[step - 1])
        side.complete(step, pushes[step - 1], pushes[step])
        moved.append(side.displacement)
        rates.append(side.velocity)
    central = (np.array(moved[2:]) - np.array(moved[:-2])) / (2.0 * h)
    late = 0.1 if name in ("poles", "scattered") else 0.02  # theirs is the mean over the last step
    assert np.abs(central - rates[1:-1]).max() < late * np.ptp(rates)


@pytest.mark.parametrize("name", NAMES)
def test_a_side_goes_on_from_its_state(kernel, poles, name):
    whole, again = sides(kernel, poles)[name], sides(kernel, poles)[name]

    def advance(side, first, last):
        for step in range(first, last):
            side.free(step, 100.0 * step)
            side.complete(step, 100.0 * step, 100.0 * step + 100.0)

    advance(whole, 1, 20)
    kept = {name: np.array(value) for name, value in whole.state().items()}
    advance(whole, 20, 40)
    again.restore(kept)
    advance(again, 20, 40)
    assert (again.displacement, again.velocity) == (whole.displacement, whole.velocity)


@pytest.mark.parametrize(
    ("body", "path"),
    [
        (RolledBeam(DEAD), Path.laid(0.5, 1e-9, 3e-5, 1.0, 0.0)),
        (SpringAndDamper(3e6, 400.0), Path.laid(0.0, 1.0, 1e-4, 1.0, 0.0)),
        (Oscillator(2.0, 4e6, 900.0), Path.laid(0.0, 1.0, 1e-4, 1.0, 0.0)),
    ],
    ids=["beam", "foundation", "oscillator"],
)  # fmt: skip
def test_the_alternating_compliance_is_what_a_long_alternation_shows(body, path):
    side, push = body.laid(path, 0.0), 1.0
    for step in range(1, 8001):
        side.free(step, -push)
        side.complete(step, -push, push)
        push = -push
    assert -push * side.displacement == pytest.approx(body.alternating_compliance(path), rel=1e-6)


# --- interruption --------------------------------------------------------------------------------


def interrupted_amid_a_step(rolled, law):
    """Roll to a step whose contact is interrupted, and go on from what was kept."""
    shelf = Shelf()
    whole = rolled(Stepped(law), None)
    with pytest.raises(KeyboardInterrupt):
        rolled(Stepped(law, fails_at=43), shelf)
    assert 30 <= shelf.arrays["motion.counts"][0] < 43
    resumed = rolled(Stepped(law), shelf)
    np.testing.assert_array_equal(resumed.contact_force, whole.contact_force)
    assert resumed.evaluations == whole.evaluations


def test_a_pair_that_is_interrupted_amid_a_step_goes_on_bit_by_bit(poles):
    def rolled(law, checkpoint):
        return roll_pair(
            RolledRail(poles), RollingWheel(RINGING), law, speed=56.0, time_step=50e-6, start=0.53,
            duration=0.003, settling=0.001, checkpoint=checkpoint,
        )  # fmt: skip

    interrupted_amid_a_step(rolled, HertzLaw(9.4e10, rough(1e-5, 1e-3, -0.5)))


@pytest.mark.parametrize("scattered", [False, True], ids=["poles", "scattered"])
def test_a_wheel_that_is_interrupted_amid_a_step_goes_on_bit_by_bit(kernel, poles, scattered):
    def rolled(law, checkpoint):
        return one_body.roll_wheel(
            kernel if scattered else poles, RINGING, law, start=0.53, duration=0.003, settling=0.001,
            checkpoint=checkpoint,
        )  # fmt: skip

    interrupted_amid_a_step(rolled, HertzLaw(9.4e10, rough(1e-5, 1e-3, -0.5)))


def test_a_compiled_law_goes_on_bit_by_bit(monkeypatch):
    monkeypatch.setattr("asperity.rolling.pair.CHUNK", 70)
    law, shelf = HertzLaw(2.4e10, rough(3e-7, 1e-5, 0.28), damping=2.0), Shelf()
    path = {"speed": 1.0, "start": 0.3, "duration": 0.003, "time_step": 1e-5}
    bodies = RolledBeam(BEAM), RollingBall(BALL)
    whole = roll_pair(*bodies, law, **path)

    def stop(done, total, message):
        if done >= 140:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        roll_pair(*bodies, law, **path, checkpoint=shelf, progress=stop)
    resumed = roll_pair(*bodies, law, **path, checkpoint=shelf)
    np.testing.assert_array_equal(resumed.contact_force, whole.contact_force)
    with pytest.raises(InputError, match=r"checkpoint.*roll anew"):
        roll_pair(RigidGround(), RollingBall(BALL), law, **path, checkpoint=shelf)


# --- stability and bad input -----------------------------------------------------------------------


@pytest.mark.parametrize("stiffness", [1e6, 1e9, 1e13])
@pytest.mark.parametrize("damping", [0.0, 1e3])
@pytest.mark.parametrize(
    "over", [Oscillator(1e-4, 1e5), SpringAndDamper(1e7), RigidGround()], ids=lambda over: type(over).__name__
)
def test_no_step_of_a_pair_grows(over, stiffness, damping):
    step = 1e-4  # much too long for all of them
    texture = np.zeros(800)
    texture[:80] = 1e-3 / stiffness * np.hanning(80)
    law = Linear(LOAD, stiffness, 0.0, StateTexture.unfiltered(texture, 1e-3 * step), damping)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CoarseSamplingWarning)
        run = roll_pair(over, BODY, law, speed=1e-3, start=0.0, duration=700 * step, time_step=step)
    swing = np.abs(run.contact_force - LOAD)
    assert swing[-200:].max() <= 2.0 * swing[:200].max() + 1e-3 * LOAD


def test_a_step_too_long_for_the_contact_is_told():
    law = Linear(LOAD, CONTACT)
    path = {"speed": 1.0, "start": 0.0, "duration": 0.01}
    # sqrt(2e7/0.5)/2π = 1007 Hz, by a step of 0.2 ms 5 in a period
    with pytest.warns(CoarseSamplingWarning, match=r"contact resonance, 1007 Hz, has 4.97 time steps"):
        roll_pair(RigidGround(), BODY, law, **path, time_step=2e-4)
    # on a spring the contact is softer: sqrt(1/(1/2e7 + 1/5e6)/0.5)/2π = 450.2 Hz
    with pytest.warns(CoarseSamplingWarning, match=r"contact resonance, 450.2 Hz, has 5.55 time steps"):
        roll_pair(SpringAndDamper(5e6), BODY, law, **path, time_step=4e-4)
    with pytest.warns(CoarseSamplingWarning, match=r"highest frequency asked for, 5000 Hz, has 8 time steps"):
        roll_pair(RigidGround(), BODY, law, **path, time_step=2.5e-5, highest_frequency=5000.0)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"speed": 0.0}, r"speed \(m/s\): received 0"),
        ({"time_step": -1.0}, r"time step \(s\): received -1"),
        ({"duration": 1e-9}, r"duration \(s\).*at least one time step"),
        ({"settling": -0.1}, r"settling \(s\).*zero or a finite positive number"),
        ({"duration": 0.9}, r"path \(m\): received 0.3 to 1.2.*the beam ends after 0.7 s"),
    ],
)
def test_bad_input_of_a_pair_is_refused(changed, message):
    path = {"speed": 1.0, "start": 0.3, "duration": 0.002, "time_step": 1e-5} | changed
    with pytest.raises(InputError, match=message):
        roll_pair(RolledBeam(BEAM), RollingBall(BALL), HertzLaw(2.4e10), **path)


def test_a_rail_of_another_speed_is_refused(poles):
    path = {"speed": 50.0, "start": 0.0, "duration": 0.002, "time_step": 50e-6}
    with pytest.raises(InputError, match=r"50 m/s in steps of 5e-05 s.*56 m/s.*Compute the moving kernel"):
        roll_pair(RolledRail(poles), RollingWheel(RIGID), HertzLaw(9.4e10), **path)


def test_a_free_mass_under_a_load_falls():
    mass = FreeMass(2.0, 3.0, 0.1, 0.5, 0.0)
    for step in range(1, 11):
        mass.free(step, 0.0)
        mass.complete(step, 0.0, 0.0)
    assert mass.displacement == pytest.approx(0.5 - 0.5 * 3.0 / 2.0 * 1.0**2)
    assert mass.velocity == pytest.approx(-1.5)
