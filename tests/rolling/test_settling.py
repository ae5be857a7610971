"""The law `direct` finds contact and bodies in one solution, with the forces of an iteration between them."""

import numpy as np
import pytest

from asperity import HalfSpace
from asperity.laws import Direct
from asperity.reference.materials import material
from asperity.rolling import stepper as stepping
from asperity.rolling.roll import roll_bodies
from asperity.structures.beam import Beam
from asperity.structures.body import GRAVITY, Body
from asperity.structures.moving_kernel import moving_kernel
from asperity.structures.rail_poles import RailBetween
from asperity.structures.track import Track

pytestmark = pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")
STEEL, CELLS, RTOL = material("steel"), 31, 1e-6
BEAM = Beam.rectangular(1.0, 0.05, 0.01, STEEL, highest_frequency=5e3)
SMALL, STEPS, START = 0.514, 150, 0.3  # kg
BALL, WHEEL = Body.rigid(SMALL, SMALL * GRAVITY), Body.rigid(600.0, 65e3)


def law(rms, depth=0.0, wheel=False, rows=STEPS + CELLS + 20, **options):
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


def ball_on_beam(law, positions=(0.0,), steps=STEPS):
    count, path = len(positions), {"speed": 1.0, "start": START, "duration": steps * 1e-5, "time_step": 1e-5}
    return roll_bodies(BEAM, [BALL] * count, [law] * count, positions=positions, **path)


def wheel_on_rail(law):
    kernel = moving_kernel(Track.named("nordborg"), 50.0, 20e-6, duration=0.02, positions=6)
    path = {"speed": 50.0, "start": 0.0, "duration": STEPS * 2e-5, "time_step": 2e-5}
    return roll_bodies(RailBetween(kernel, {}), [WHEEL], [law], positions=[0.0], **path)


def iterated(roll, law, monkeypatch):
    """The same by Newton's iteration: a solution and a tangent in each of its steps."""
    with monkeypatch.context() as patch:
        patch.setattr(stepping, "settles", lambda law: False)
        return roll(law)


def check_steps(law, run):
    """The half-space alone, at the approach of a step, has the force of that step."""
    space, half = HalfSpace(law.body.shape, law.spacing, law.modulus, law.hardness), CELLS // 2
    for step in range(1, STEPS + 1, 7):
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
    assert found.evaluations <= (1.3 if apart else 1.0) * STEPS
    # on a smooth beam nothing rings, and the force expected is the force
    assert apart or name == "smooth" or expected.evaluations > 1.9 * STEPS
    if law.damping == 0.0:
        check_steps(law, found)


def test_several_contacts_settle_too(monkeypatch):
    def roll(law):
        return ball_on_beam(law, [0.0, 5e-5], steps=60)

    rough = law(0.05e-6)
    expected = iterated(roll, rough, monkeypatch).contact_force
    tolerance = 1e-5 * SMALL * GRAVITY
    np.testing.assert_allclose(roll(rough).contact_force, expected, rtol=0.0, atol=tolerance)
