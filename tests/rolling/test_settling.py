"""The law `direct` finds contact and bodies in one solution, with the forces of an iteration between them."""

import numpy as np
import pytest

from asperity.contact import HalfSpace
from asperity.laws import Direct
from asperity.reference.materials import material
from asperity.rolling import stepper as stepping
from asperity.rolling.roll import roll_bodies
from asperity.structures.beam import Beam
from asperity.structures.body import Ball, Body
from asperity.structures.moving_kernel import moving_kernel
from asperity.structures.track import Track
from asperity.structures.wheel import Wheel
from one_contact import roll_ball, roll_wheel

STEEL, MODULUS, CELLS, RTOL = material("steel"), 115e9, 31, 1e-6
BALL, BEAM = Ball(0.025, STEEL), Beam.rectangular(1.0, 0.05, 0.01, STEEL, highest_frequency=5e3)
DX, START, STEPS = 1e-5, 0.3, 150
WHEEL, RAIL_DX = Wheel(600.0, 65e3), 1e-3


def heights(rms, depth, seed=2, rows=STEPS + CELLS + 20):
    """A texture of waves longer than four cells, and a dale into which a body flies."""
    spectrum = np.fft.rfft2(np.random.default_rng(seed).standard_normal((rows, CELLS)))
    long = np.hypot(np.fft.fftfreq(rows)[:, None], np.fft.rfftfreq(CELLS)) < 0.25
    found = np.fft.irfft2(spectrum * long, (rows, CELLS))
    dale = np.where(np.abs(np.arange(rows) - 0.4 * rows) < 0.2 * rows, depth, 0.0)
    return rms * (found - found.mean()) / found.std() - dale[:, None]


def body(dx, across, along):
    x = (np.arange(CELLS) - CELLS // 2) * dx
    return x[:, None] ** 2 / (2 * along) + x**2 / (2 * across)


def under_the_ball(rms, depth=0.0, **options):
    shape = body(DX, BALL.radius, BALL.radius)
    return Direct(
        heights(rms, depth), shape, (DX, DX), MODULUS, START - (CELLS // 2 + 5) * DX, rtol=RTOL, **options
    )


PATH = {"speed": 1.0, "start": START, "duration": STEPS * 1e-5, "time_step": 1e-5}


def ball_on_beam(law):
    return roll_ball(BEAM, BALL, law, sensors=[], **PATH)


def wheel_on_rail(law):
    track = Track(
        bending_stiffness=4.725e6, mass_per_length=60.0, rail_loss_factor=0.004, pad_stiffness=300e6,
        pad_damping=18e3, sleeper_mass=150.0, ballast_stiffness=150e6, ballast_damping=48e3,
        sleeper_spacing=0.6,
    )  # fmt: skip
    kernel = moving_kernel(track, 50.0, 20e-6, duration=0.02, positions=6)
    return roll_wheel(kernel, WHEEL, law, start=0.0, duration=STEPS * 2e-5, settling=0.0)


def under_the_wheel(rms, depth=0.0, **options):
    shape, start = body(RAIL_DX, 0.3, 0.46), -(CELLS // 2) * RAIL_DX
    return Direct(heights(rms, depth), shape, (RAIL_DX, RAIL_DX), MODULUS, start, rtol=RTOL, **options)


def iterated(roll, law, monkeypatch):
    """The same by Newton's iteration: a solution and a tangent in each of its steps."""
    monkeypatch.setattr(stepping, "settles", lambda law: False)
    found = roll(law)
    monkeypatch.undo()
    return found


def check_steps(law, positions, run):
    """The half-space alone, at the approach of a step, has the force of that step."""
    space = HalfSpace(law.body.shape, law.spacing, law.modulus, law.hardness)
    half = len(law.body) // 2
    for step in range(1, len(run.contact_force), 7):
        row = round((positions[step] - law.start) / law.spacing[0])
        gap = law.body - law.heights[row - half : row + half + 1]
        alone = space.solve(gap, approach=run.relative_displacement[step], rtol=1e-9).force
        assert run.contact_force[step] == pytest.approx(alone, rel=2 * RTOL, abs=1e-12)


CASES = {
    "rough": (ball_on_beam, under_the_ball(0.05e-6)),
    "smooth": (ball_on_beam, under_the_ball(0.0)),
    "yielding asperities": (ball_on_beam, under_the_ball(0.05e-6, hardness=0.4e9)),
    "losses of contact": (ball_on_beam, under_the_ball(0.05e-6, 2e-6)),
    "damped": (ball_on_beam, under_the_ball(0.05e-6, damping=50.0)),
    "damped, with losses": (ball_on_beam, under_the_ball(0.05e-6, 2e-6, damping=50.0)),
    "wheel": (wheel_on_rail, under_the_wheel(5e-6)),
    "wheel, with losses": (wheel_on_rail, under_the_wheel(5e-6, 200e-6)),
}


@pytest.mark.parametrize("name", CASES)
@pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")
def test_the_forces_are_those_of_the_iteration(name, monkeypatch):
    roll, law = CASES[name]
    found, expected = roll(law), iterated(roll, law, monkeypatch)
    load = WHEEL.load if "wheel" in name else BALL.static_load
    scale = max(load, float(expected.contact_force.max()))
    apart = "losses" in name
    assert apart == bool((expected.contact_force == 0.0).any())
    # where contact is lost, small differences grow
    np.testing.assert_allclose(
        found.contact_force, expected.contact_force, rtol=0.0, atol=(1e-3 if apart else 5e-6) * scale
    )
    assert found.unconverged_steps == 0
    assert found.evaluations <= (1.3 if apart else 1.0) * STEPS
    # on a smooth beam nothing rings, and the force expected is the force
    assert apart or name == "smooth" or expected.evaluations > 1.9 * STEPS
    if law.damping == 0.0:
        start = 0.0 if roll is wheel_on_rail else START
        check_steps(law, start + law.spacing[0] * np.arange(STEPS + 1), found)


@pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")
def test_several_contacts_settle_too(monkeypatch):
    law, balls = under_the_ball(0.05e-6), [Body.rigid(BALL.mass, BALL.static_load)] * 2

    def roll(law):
        return roll_bodies(BEAM, balls, [law, law], positions=[0.0, 5 * DX], **PATH | {"duration": 60 * 1e-5})

    expected = iterated(roll, law, monkeypatch).contact_force
    np.testing.assert_allclose(roll(law).contact_force, expected, rtol=0.0, atol=1e-5 * BALL.static_load)
