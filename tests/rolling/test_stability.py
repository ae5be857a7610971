"""A coupled step is stable whatever masses, stiffness and damping; a motion that runs away is told."""

import warnings
from contextlib import nullcontext

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from asperity.errors import CoarseSamplingWarning, ComputationError, LargeDeflectionWarning
from asperity.laws import HertzLaw, Linear
from asperity.reduction.texture import StateTexture
from asperity.reference.materials import material
from asperity.rolling import stability
from asperity.rolling.assembly import alternating, system_of
from asperity.rolling.ground import ground_of
from asperity.rolling.path import Path
from asperity.rolling.steps import alternating_of_modes, modal_coefficients, resolved_step
from asperity.structures.beam import Beam
from asperity.structures.body import Ball, Body
from asperity.structures.moving_kernel import moving_kernel
from asperity.structures.rail_poles import RailBetween, rail_poles
from asperity.structures.track import Track
from asperity.structures.wheel import Wheel
from one_contact import roll_ball, roll_wheel

STEEL = material("steel")
BEAM = Beam.rectangular(1.0, 0.05, 0.01, STEEL, highest_frequency=5e3)
STEPS = 1500


def bump(spacing, start, height):
    """A texture with one rise at its beginning: what comes after rings freely."""
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
    ball, speed = Ball(0.025, STEEL, load=5.0, given_mass=mass), 1e-3
    texture = bump(speed * time_step, 0.3, 1e-3 / stiffness)
    law = Linear(5.0, stiffness, 0.0, texture, damping)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CoarseSamplingWarning)
        run = roll_ball(
            BEAM, ball, law, speed=speed, start=0.3, duration=(STEPS - 2) * time_step,
            time_step=time_step, sensors=[0.5],
        )  # fmt: skip
    assert not grows(run.contact_force, 5.0, 0.01)


@settings(max_examples=60, derandomize=True)  # how high one bounces later is chance
@given(powers(-7, 0), powers(8, 14), powers(-6, -4), st.floats(2.0, 10.0))
@example(1.3e-6, 2.7e11, 5.7e-6, 8.0)
@example(0.0024, 2.4e13, 3.6e-5, 9.0)
def test_no_flight_of_a_ball_grows(mass, stiffness, time_step, flight):
    """A ball that a ramp throws up bounces no higher later: impacts return no more than they receive."""
    speed, ramp, load = 1e-3, STEPS // 10, 5.0
    thrown = 0.5 * flight * time_step * load / mass  # so many steps until it falls back
    texture = np.zeros(STEPS)
    texture[:ramp] = -2 / np.pi * thrown * ramp * time_step * np.hanning(2 * ramp)[:ramp]
    law = HertzLaw(stiffness, StateTexture.unfiltered(texture, speed * time_step, 0.3))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        run = roll_ball(
            BEAM, Ball(0.025, STEEL, load, mass), law, speed=speed, start=0.3,
            duration=(STEPS - 2) * time_step, time_step=time_step, sensors=[0.5],
        )  # fmt: skip
    height = -run.relative_displacement
    early, late = height[ramp : STEPS // 2].max(), height[-STEPS // 4 :].max()
    assert late <= max(4.0 * early, 0.0)


def test_an_impact_on_a_rigid_contact_returns_its_energy():
    """Softened by h²/3m, wherever in a step it begins: leapfrog on a rigid wall, two steps long."""
    h, mass, speed = 1e-4, 0.2, 3.0
    softer = stability.ELASTIC * h**2 / (12 * mass)
    for share in np.linspace(0.02, 0.98, 25):
        place, velocity, force = -(1.0 - share) * speed * h, speed, 0.0
        for _ in range(6):
            free = place + h * velocity - h**2 * force / (3 * mass)
            before, force = force, max(free / (h**2 / (6 * mass) + softer), 0.0)
            place = free - h**2 * force / (6 * mass)
            velocity -= h * (before + force) / (2 * mass)
        assert velocity == pytest.approx(-speed, rel=1e-12)


TRACK = Track(
    bending_stiffness=4.725e6, mass_per_length=60.0, rail_loss_factor=0.004, pad_stiffness=300e6,
    pad_damping=18e3, sleeper_mass=150.0, ballast_stiffness=150e6, ballast_damping=48e3, sleeper_spacing=0.6,
)  # fmt: skip


@pytest.fixture(scope="module")
def poles():
    return rail_poles(moving_kernel(TRACK, 56.0, 50e-6), 100)


@settings(max_examples=60)
@given(st.data())
def test_no_step_of_a_wheel_grows(poles, data):
    mass, stiffness = data.draw(powers(-3, 5)), data.draw(powers(5, 13))
    damping = data.draw(st.one_of(st.just(0.0), powers(0, 10)))
    modes = data.draw(st.integers(0, 3))
    wheel = Wheel(mass, 65e3)
    if modes:
        frequencies = data.draw(st.lists(st.floats(100.0, 2e4), min_size=modes, max_size=modes))
        masses = data.draw(st.lists(powers(-2, 3), min_size=modes, max_size=modes))
        wheel = Wheel(mass, 65e3, frequencies, [0.01] * modes, masses)
    texture = bump(56.0 * 50e-6, 0.0, 1.0 / stiffness)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", CoarseSamplingWarning)
        run = roll_wheel(
            poles, wheel, Linear(65e3, stiffness, 0.0, texture, damping),
            start=0.0, duration=(STEPS - 2) * 50e-6, settling=0.0,
        )  # fmt: skip
    assert not grows(run.contact_force, 65e3, 0.1)


def of_body(body, h):
    """Its alternating compliance at its contact."""
    path = Path(np.zeros((1, 2)), 1.0, h)
    return alternating(system_of(ground_of(None, path, np.zeros(0)), [body], path))[0]


class TestAlternatingCompliance:
    """What a force that alternates from step to step does, against closed forms and a long run."""

    def test_free_mass(self):
        # Newmark's β = 1/6 at the highest frequency: −h²/12m; a mode far below that frequency is such a mass
        h, mass = 1e-4, 0.3
        a = modal_coefficients(np.array([1e-3]), np.array([0.0]), h)
        found = alternating_of_modes(a)[0] / mass
        assert found == pytest.approx(-(h**2) / 12 / mass, rel=1e-6)
        assert of_body(Body.rigid(mass, 1.0), h) == pytest.approx(found, rel=1e-6)

    def test_stiff_mode(self):
        # a mode far above it answers statically
        a = modal_coefficients(np.array([1e7]), np.array([0.5]), 1e-3)
        assert 4.0 * alternating_of_modes(a)[0] == pytest.approx(4.0 / 1e14, rel=1e-3)

    def test_modes_stepped_for_long(self):
        h, natural = 2e-4, 2 * np.pi * np.array([90.0, 1300.0, 2700.0])
        a, shape = modal_coefficients(natural, np.full(3, 0.3), h), np.array([1.0, -0.7, 0.4])
        q, v, force = np.zeros(3), np.zeros(3), 1.0
        for _ in range(4000):
            p = shape * force
            q, v = a[0] * q + a[1] * v + (a[2] - a[3]) * p, a[4] * q + a[5] * v + (a[6] - a[7]) * p
            force = -force
        assert shape**2 @ alternating_of_modes(a) == pytest.approx(force * (shape @ q), rel=1e-9)

    def test_a_rail_and_a_wheel(self):
        path = Path(np.zeros((1, 2)), 56.0, 50e-6)
        kernel = moving_kernel(TRACK, 56.0, 50e-6)
        least = min(row @ (-1.0) ** np.arange(row.size) for row in kernel.weights)
        ground = ground_of(RailBetween(kernel, {}), path, np.zeros(0))
        assert (ground.alternating, ground.thrown) == (pytest.approx(least, rel=1e-12), 0.0)
        wheel = Body.rigid(1e30, 65e3).with_modes([3000.0], [0.2], [20.0])
        # the mode by itself, as an oscillator
        a = modal_coefficients(np.array([2 * np.pi * 3000.0]), np.array([0.2]), 50e-6)
        mode = alternating_of_modes(a)[0] / 20.0
        assert of_body(wheel, 50e-6) == pytest.approx(mode, rel=1e-6)


def test_modes_too_fast_for_the_step_answer_statically():
    natural = np.array([1e3, 4e4])
    coefficients = resolved_step(natural, np.full(2, 0.01), 1e-4)
    np.testing.assert_array_equal(
        coefficients[:, 0], modal_coefficients(natural, np.full(2, 0.01), 1e-4)[:, 0]
    )
    assert coefficients[:, 1].tolist() == [0.0, 0.0, 0.0, 1 / 1.6e9, 0.0, 0.0, 0.0, 0.0]


@pytest.mark.parametrize(
    ("alternating", "stiffness", "damping", "softer", "told"),
    [
        ((-1e-12, -1e-12), (1e11, 2.4e11), 0.0, 0.0, ""),
        ((-1e-12, -1e-12), (1e11, 2.4e11), 9e5, 0.0, ""),
        ((-1e-12, 0.0), (4.9e11, 1e13), 0.0, 0.0, ""),
        ((-1e-12, -1e-12), (1e11, 0.0), 0.0, 0.0, ""),
        ((-1e-12, -1e-12), (1e11, 5e11), 0.0, 2e-12, "by 20 %.*take at most 7.1e-06 s"),
        ((-1e-12, 0.0), (2e11, 5e11), 2e6, 1.1e-12, "by 11 %.*take at most 5e-06 s"),
    ],
)
def test_a_contact_is_softened_for_impacts_or_to_be_stable(alternating, stiffness, damping, softer, told):
    arrays = (np.array([value]) for value in (*alternating, *stiffness, damping, 1e11))
    with pytest.warns(CoarseSamplingWarning, match=told) if told else nullcontext():
        assert stability.softening(*arrays, 1e-5)[0] == pytest.approx(softer)


def test_softened_contact_has_the_frequency_of_newmark():
    """A mass on a spring: Newmark's method turns its phase φ by 2 (1 - cos φ) = (ω h)² / (1 + β (ω h)²)."""
    h, mass, stiffness = 1e-4, 0.5, 0.5 * (2 * np.pi * 4500.0) ** 2  # ω h = 2.8
    heavy = Beam(1.0, 4e12, 1e8, highest_frequency=5e3)
    texture = bump(1e-3 * h, 0.3, 1e-3 / stiffness)
    with pytest.warns(CoarseSamplingWarning):
        run = roll_ball(
            heavy, Ball(0.025, STEEL, 5.0, mass), Linear(5.0, stiffness, 0.0, texture), speed=1e-3, start=0.3,
            duration=(STEPS - 2) * h, time_step=h, sensors=[0.5],
        )  # fmt: skip
    free = run.contact_force[STEPS // 8 :] - 5.0
    turned = np.arccos(np.clip((free[2:] + free[:-2]) @ free[1:-1] / (2 * free[1:-1] @ free[1:-1]), -1, 1))
    squared, beta = stiffness / mass * h**2, 1 / 6 + stability.STABLE / 12
    assert turned == pytest.approx(np.arccos(1 - 0.5 * squared / (1 + beta * squared)), rel=1e-3)


def test_a_motion_that_runs_away_is_told():
    texture = StateTexture.unfiltered(np.r_[np.zeros(50), np.full(50, -0.5)], 1e-5, 0.3)  # a step of 0.5 m
    with (
        pytest.warns(LargeDeflectionWarning),
        pytest.raises(ComputationError, match=r"the motion runs away: at step \d+.*under a load of 5 N"),
    ):
        roll_ball(
            BEAM, Ball(0.025, STEEL, 5.0, 0.5), HertzLaw(1e12, texture), speed=1.0, start=0.3, duration=9e-4,
            time_step=1e-5, sensors=[0.5],
        )  # fmt: skip


def test_a_strong_damper_stays_below_what_a_rigid_contact_does():
    """A damper of 1e9 N s/m holds wheel and rail together; it does not pump."""
    pole_model = rail_poles(moving_kernel(TRACK, 56.0, 50e-6), 60)
    spacing = 56.0 * 50e-6
    texture = StateTexture.unfiltered(
        1e-6 * np.sin(2 * np.pi * np.arange(2000) * spacing / 0.5), spacing, 0.0
    )
    forces = []
    for damping in (1e8, 1e10):
        law = HertzLaw(9.413e10, texture, damping)
        with pytest.warns(CoarseSamplingWarning, match=r"softening the contact by 2.2 %"):
            run = roll_wheel(pole_model, Wheel(600.0, 65e3), law, start=0.0, duration=0.09, settling=0.0)
        assert run.contact_loss_share == 0.0
        forces.append(run.contact_force)
    assert forces[1].std() == pytest.approx(forces[0].std(), rel=0.02)


def test_a_beam_that_bends_too_far_is_told():
    soft = Beam.rectangular(30.0, 0.05, 0.01, STEEL, highest_frequency=100.0)
    static = 20.0 * 30.0**3 / (48.0 * soft.bending_stiffness)
    with pytest.warns(
        LargeDeflectionWarning, match=f"up to {static:.3g} m under the contact, 43 % of its length"
    ):
        roll_ball(
            soft, Ball(0.025, STEEL, 20.0), HertzLaw(1e10), speed=1.0, start=15.0, duration=1e-3,
            time_step=1e-5, sensors=[0.5],
        )  # fmt: skip
