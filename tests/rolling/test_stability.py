"""A coupled step is stable whatever masses, stiffness and damping; `direct` settles in one solution."""

import warnings
from contextlib import nullcontext

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from asperity import Beam, HalfSpace, Track, material
from asperity.errors import CoarseSamplingWarning, ComputationError, LargeDeflectionWarning
from asperity.laws import Areal, Direct, HertzLaw, Linear
from asperity.reduction.stiffness import ForceCurve
from asperity.reduction.texture import StateTexture
from asperity.rolling import stepper as stepping
from asperity.rolling import steps
from asperity.rolling.resolution import steps_per_resonance
from asperity.rolling.roll import roll_bodies
from asperity.structures.body import GRAVITY, Body, Wheel
from asperity.structures.moving_kernel import moving_kernel
from asperity.structures.rail_poles import RailBetween, rail_poles
from one_contact import rigid_bar, roll_ball, roll_wheel, rough

STEEL = material("steel")
BEAM = Beam.rectangular(1.0, 0.05, 0.01, STEEL, highest_frequency=5e3)
STEPS, LOAD, RAIL_STEP = 1500, 5.0, 50e-6


def ringing(mass, law, time_step, over=BEAM):
    """A ball creeps along: what comes after the beginning of its texture rings freely."""
    path = {"speed": 1e-3, "start": 0.3, "duration": (STEPS - 2) * time_step, "time_step": time_step}
    return roll_ball(over, Body.rigid(mass, LOAD), law, **path)


def bump(spacing, start, height):
    """A texture with one rise at its beginning."""
    texture = np.zeros(STEPS)
    texture[: STEPS // 10] = height * np.hanning(STEPS // 10)
    return StateTexture.unfiltered(texture, spacing, start)


def grows(force, load, share):
    """Whether a disturbance has grown beyond itself, and a share of the load that moving loads explain."""
    swing = np.abs(force - load)
    return swing[-STEPS // 4 :].max() > 2.0 * swing[: STEPS // 4].max() + share * load


def powers(low, high):
    return st.floats(low, high).map(lambda exponent: 10.0**exponent)


@settings(max_examples=120)
@example(0.01, 1e3, 1e10, 1e-5)  # on the bound itself it grows slowly
@given(powers(-7, 3), powers(3, 13), st.one_of(st.just(0.0), powers(-2, 10)), powers(-6, -4))
def test_no_step_of_a_ball_grows(mass, stiffness, damping, time_step):
    law = Linear(LOAD, stiffness, 0.0, bump(1e-3 * time_step, 0.3, 1e-3 / stiffness), damping)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CoarseSamplingWarning)
        run = ringing(mass, law, time_step)
    assert not grows(run.contact_force, LOAD, 0.01)


@settings(max_examples=60, derandomize=True)  # how high one bounces later is chance
@given(powers(-7, 0), powers(8, 14), powers(-6, -4), st.floats(2.0, 10.0))
@example(1.3e-6, 2.7e11, 5.7e-6, 8.0)
@example(0.0024, 2.4e13, 3.6e-5, 9.0)
def test_no_flight_of_a_ball_grows(mass, stiffness, time_step, flight):
    """A ball that a ramp throws up bounces no higher later: impacts return no more than they receive."""
    ramp = STEPS // 10
    thrown = 0.5 * flight * time_step * LOAD / mass  # so many steps until it falls back
    texture = np.zeros(STEPS)
    texture[:ramp] = -2 / np.pi * thrown * ramp * time_step * np.hanning(2 * ramp)[:ramp]
    law = HertzLaw(stiffness, StateTexture.unfiltered(texture, 1e-3 * time_step, 0.3))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        height = -ringing(mass, law, time_step).relative_displacement
    early, late = height[ramp : STEPS // 2].max(), height[-STEPS // 4 :].max()
    assert late <= max(4.0 * early, 0.0)


@pytest.fixture(scope="module")
def poles():
    return rail_poles(moving_kernel(Track.named("nordborg"), 56.0, RAIL_STEP), 100)


WHEEL_MODES = st.lists(st.tuples(st.floats(100.0, 2e4), st.just(0.01), powers(-2, 3)), max_size=3)


@settings(max_examples=60)
@given(powers(-3, 5), powers(5, 13), st.one_of(st.just(0.0), powers(0, 10)), WHEEL_MODES)
def test_no_step_of_a_wheel_grows(poles, mass, stiffness, damping, modes):
    wheel = Wheel(mass, 65e3, *zip(*modes, strict=True))
    law = Linear(65e3, stiffness, 0.0, bump(56.0 * RAIL_STEP, 0.0, 1.0 / stiffness), damping)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CoarseSamplingWarning)
        run = roll_wheel(poles, wheel, law, start=0.0, duration=(STEPS - 2) * RAIL_STEP, settling=0.0)
    assert not grows(run.contact_force, 65e3, 0.1)


def test_the_contact_resonance_is_that_of_a_mass_on_springs_in_series():
    h, mass, stiffness, soft = 1e-5, 0.5, np.array([2e7]), 3e-8
    found = steps.contact_resonance(stiffness, h**2 / (6 * mass) + soft, soft - h**2 / (12 * mass), h)
    expected = np.sqrt(1.0 / (1.0 / stiffness + soft) / mass) / (2 * np.pi)
    np.testing.assert_allclose(found, expected, rtol=1e-12)


@pytest.mark.parametrize(
    ("compliances", "stiffness", "damping", "softer", "told"),
    [
        ((-1e-12, -1e-12), (1e11, 2.4e11), 0.0, 0.0, ""),
        ((-1e-12, -1e-12), (1e11, 2.4e11), 9e5, 0.0, ""),
        ((-1e-12, 0.0), (4.9e11, 1e13), 0.0, 0.0, ""),
        ((-1e-12, -1e-12), (1e11, 0.0), 0.0, 0.0, ""),
        ((-1e-12, -1e-12), (1e11, 5e11), 0.0, 2e-12, "by 20 %.*take at most 7.1 µs"),
        ((-1e-12, 0.0), (2e11, 5e11), 2e6, 1.1e-12, "by 11 %.*take at most 5.0 µs"),
    ],
)
def test_a_contact_is_softened_for_impacts_or_to_be_stable(compliances, stiffness, damping, softer, told):
    arrays = (np.array([value]) for value in (*compliances, *stiffness, damping, 1e11))
    with pytest.warns(CoarseSamplingWarning, match=told) if told else nullcontext():
        assert steps.softening(*arrays, 1e-5)[0] == pytest.approx(softer, rel=1e-6, abs=0.0)


@pytest.mark.parametrize("exponent", [1.5, 10 / 9])
def test_a_contact_becomes_as_stiff_in_impacts_as_under_64_times_its_load(exponent):
    """dF/dδ of F = k δⁿ; Hertz's is four times as stiff there, a roller's half as much again."""

    def stiffness(approach):
        return 1e12 * exponent * approach ** (exponent - 1.0)

    samples = np.array([1e-6, 2e-6])
    law = Areal(ForceCurve.from_samples(samples, 1e12 * samples**exponent, exponent), None).prepare([0.0])
    rest = 1.5e-6
    found = steps.largest_values(law, stiffness(rest))
    assert found[0] == pytest.approx(stiffness(2e-6), rel=1e-9)
    assert found[1] == pytest.approx(stiffness(rest * 64.0 ** (1.0 / exponent)), rel=1e-9)


@pytest.mark.parametrize("resonance", [10e3, 25e3, 40e3, 56e3, 70e3, 300e3])
def test_a_resonance_beyond_what_is_asked_takes_fewer_steps_as_long_as_nobody_hears_it(resonance):
    """Receptance of a mass on a spring, stepped with forces linear in between: Newmark's of β = 1/6."""
    asked = 20e3
    count = steps_per_resonance(resonance, asked)
    turned = 2.0 * np.pi / count  # of the resonance in a step
    cosine = np.cos(turned * asked / resonance)
    mean = (cosine + 2.0) / 3.0
    stepped = mean / (2.0 * cosine - 2.0 + turned**2 * mean)
    exact = 1.0 / (1.0 - (asked / resonance) ** 2) / turned**2
    assert 5.0 <= count <= steps_per_resonance(resonance, None) == 10.0
    if count < 10.0:
        assert abs(stepped / exact - 1.0) < 0.016 * turned**2 * exact
    assert steps_per_resonance(resonance, 0.5 * asked) <= count


def test_softened_contact_has_the_frequency_of_newmark():
    """A mass on a spring: Newmark's method turns its phase φ by 2 (1 - cos φ) = (ω h)² / (1 + β (ω h)²)."""
    h, mass, stiffness = 1e-4, 0.5, 0.5 * (2 * np.pi * 4500.0) ** 2  # ω h = 2.8
    heavy = Beam(1.0, 4e12, 1e8, highest_frequency=5e3)
    with pytest.warns(CoarseSamplingWarning):
        run = ringing(mass, Linear(LOAD, stiffness, 0.0, bump(1e-3 * h, 0.3, 1e-3 / stiffness)), h, heavy)
    free = run.contact_force[STEPS // 8 :] - LOAD
    turned = np.arccos(np.clip((free[2:] + free[:-2]) @ free[1:-1] / (2 * free[1:-1] @ free[1:-1]), -1, 1))
    squared, beta = stiffness / mass * h**2, 1 / 6 + steps.STABLE / 12
    assert turned == pytest.approx(np.arccos(1 - 0.5 * squared / (1 + beta * squared)), rel=1e-3)


def test_stiff_contacts_on_one_light_carriage_are_softened_and_stay_stable():
    """Together they are stiffer than each alone; one warning is enough."""
    body = rigid_bar(0.02, 2.5e-6, 0.01 * np.arange(-1.5, 2.0), 4.2)
    law = Linear(1.0, 2e8, 0.0, rough(1e-8, 1e-5, 0.25, 20000))
    path = {"speed": 1.0, "start": 0.3, "duration": 0.02, "time_step": 2e-5, "settling": 0.005}
    with pytest.warns(CoarseSamplingWarning) as seen:
        found = roll_bodies(None, [body], [law] * 4, positions=[0.0], **path)
    assert sum("kept stable by softening" in str(warning.message) for warning in seen) == 1
    swing = np.abs(found.contact_force - 1.0)
    assert swing[:, -300:].max() < 3.0 * swing[:, :300].max()


def test_a_beam_that_bends_too_far_is_told_whatever_becomes_of_the_motion():
    soft, path = Beam.rectangular(30.0, 0.05, 0.01, STEEL, highest_frequency=100.0), {"time_step": 1e-5}
    static = 20.0 * 30.0**3 / (48.0 * soft.bending_stiffness)
    said = f"up to {static:.3g} m under the contact, 43 % of its length"
    with pytest.warns(LargeDeflectionWarning, match=said):
        roll_ball(soft, Body.rigid(0.514, 20.0), HertzLaw(1e10), speed=1.0, start=15.0, duration=1e-3, **path)
    cliff = StateTexture.unfiltered(np.repeat([0.0, -0.5], 50), 1e-5, 0.3)  # a step of 0.5 m
    with (
        pytest.warns(LargeDeflectionWarning),
        pytest.raises(ComputationError, match=r"the motion runs away: at step \d+.*under a load of 5 N"),
    ):
        roll_ball(
            BEAM, Body.rigid(0.5, LOAD), HertzLaw(1e12, cliff), speed=1.0, start=0.3, duration=9e-4, **path
        )


# --- `direct` finds contact and bodies in one solution, with the forces of an iteration between them

CELLS, RTOL = 31, 1e-6
SMALL, STEPPED, START = 0.514, 150, 0.3  # kg
BALL, WHEEL = Body.rigid(SMALL, SMALL * GRAVITY), Body.rigid(600.0, 65e3)


def law(rms, depth=0.0, wheel=False, rows=STEPPED + CELLS + 20, **options):
    """A texture of waves longer than four cells, and a dale into which a body flies."""
    dx, radii, start = (1e-3, (0.46, 0.3), 0.0) if wheel else (1e-5, (0.025, 0.025), START)
    spectrum = np.fft.rfft2(np.random.default_rng(2).standard_normal((rows, CELLS)))
    long = np.hypot(np.fft.fftfreq(rows)[:, None], np.fft.rfftfreq(CELLS)) < 0.25
    found = np.fft.irfft2(spectrum * long, (rows, CELLS))
    dale = np.where(np.abs(np.arange(rows) - 0.4 * rows) < 0.2 * rows, depth, 0.0)
    heights = rms * (found - found.mean()) / found.std() - dale[:, None]
    x = (np.arange(CELLS) - CELLS // 2) * dx
    body = x[:, None] ** 2 / (2 * radii[0]) + x**2 / (2 * radii[1])
    return Direct(heights, body, (dx, dx), 115e9, start - (CELLS // 2) * dx, rtol=RTOL, **options)


def ball_on_beam(law, positions=(0.0,), steps=STEPPED):
    count, path = len(positions), {"speed": 1.0, "start": START, "duration": steps * 1e-5, "time_step": 1e-5}
    return roll_bodies(BEAM, [BALL] * count, [law] * count, positions=positions, **path)


def wheel_on_rail(law):
    kernel = moving_kernel(Track.named("nordborg"), 50.0, 20e-6, duration=0.02, positions=6)
    path = {"speed": 50.0, "start": 0.0, "duration": STEPPED * 2e-5, "time_step": 2e-5}
    return roll_bodies(RailBetween(kernel, {}), [WHEEL], [law], positions=[0.0], **path)


def iterated(roll, law, monkeypatch):
    """The same by Newton's iteration: a solution and a tangent in each of its steps."""
    with monkeypatch.context() as patch:
        patch.setattr(stepping, "settles", lambda law: False)
        return roll(law)


def check_steps(law, run):
    """The half-space alone, at the approach of a step, has the force of that step."""
    space, half = HalfSpace(law.body.shape, law.spacing, law.modulus, law.hardness), CELLS // 2
    for step in range(1, STEPPED + 1, 7):
        row = round((run.positions[0, step] - law.start) / law.spacing[0])
        gap = law.body - law.heights[row - half : row + half + 1]
        alone = space.solve(gap, approach=run.relative_displacement[0, step], rtol=1e-9).force
        assert run.contact_force[0, step] == pytest.approx(alone, rel=2 * RTOL, abs=1e-12)


CASES = {
    "rough": (ball_on_beam, law(0.05e-6)),
    "smooth": (ball_on_beam, law(0.0)),
    "yielding asperities": (ball_on_beam, law(0.05e-6, hardness=0.4e9)),
    "losses of contact": (ball_on_beam, law(0.05e-6, 2e-6)),
    "damped": (ball_on_beam, law(0.05e-6, damping=2e3)),
    "damped, with losses": (ball_on_beam, law(0.05e-6, 2e-6, damping=50.0)),
    "wheel": (wheel_on_rail, law(5e-6, wheel=True)),
    "wheel, with losses": (wheel_on_rail, law(5e-6, 200e-6, wheel=True)),
}


@pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")
@pytest.mark.parametrize("name", CASES)
def test_the_forces_are_those_of_the_iteration(name, monkeypatch):
    roll, law = CASES[name]
    found, expected = roll(law), iterated(roll, law, monkeypatch)
    load = (WHEEL if "wheel" in name else BALL).static_loads[0]
    scale = max(load, float(expected.contact_force.max()))
    apart = "losses" in name
    assert apart == bool((expected.contact_force == 0.0).any())
    # where contact is lost, small differences grow
    tolerance = (1e-3 if apart else 5e-6) * scale
    np.testing.assert_allclose(found.contact_force, expected.contact_force, rtol=0.0, atol=tolerance)
    assert found.unconverged_steps == 0
    assert found.evaluations <= (1.3 if apart else 1.0) * STEPPED
    # on a smooth beam nothing rings, and the force expected is the force
    assert apart or name == "smooth" or expected.evaluations > 1.9 * STEPPED
    if law.damping == 0.0:
        check_steps(law, found)


@pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")
def test_several_contacts_settle_too(monkeypatch):
    def roll(law):
        return ball_on_beam(law, [0.0, 5e-5], steps=60)

    rough = law(0.05e-6)
    expected = iterated(roll, rough, monkeypatch).contact_force
    tolerance = 1e-5 * SMALL * GRAVITY
    np.testing.assert_allclose(roll(rough).contact_force, expected, rtol=0.0, atol=tolerance)
