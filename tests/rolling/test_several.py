"""Several contacts at once: against one contact, closed forms, other integrators, energy, interruption."""

import numpy as np
import pytest

from asperity.errors import InputError
from asperity.kinds.ball_on_beam import roll as ball_on_beam
from asperity.laws import HertzLaw, Linear
from asperity.reduction.texture import StateTexture
from asperity.reference.materials import material
from asperity.rolling.several import roll_bodies
from asperity.structures.ball import Ball
from asperity.structures.beam import Beam
from asperity.structures.body import Body

STEEL = material("steel")
BALL = Ball(0.025, STEEL)
BEAM = Beam.rectangular(1.0, 0.05, 0.01, STEEL, highest_frequency=5e3)
PATH = {"speed": 1.0, "start": 0.3, "duration": 0.02, "time_step": 1e-5, "settling": 0.005}


def rough(rms, spacing, start, points=4000, seed=2):
    steps = np.random.default_rng(seed).standard_normal(points)
    heights = np.convolve(steps, np.hanning(30), mode="same")
    return StateTexture.unfiltered(rms * heights / heights.std(), spacing, start)


def same(found, expected, rel=1e-9):
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=rel * np.abs(expected).max())


def rolling_ball(**changes):
    return Body.rigid(**{"mass": BALL.mass, "load": BALL.static_load} | changes)


# --- one contact -------------------------------------------------------------------------------


@pytest.mark.parametrize("support", ["simply-supported", "free"])
def test_one_ball_on_a_beam_is_that_of_the_kind(support):
    beam = Beam.rectangular(1.0, 0.05, 0.01, STEEL, highest_frequency=5e3, support=support)
    law = HertzLaw(2.4e10, rough(2e-8, 1e-5, 0.29), damping=2.0)
    kind = ball_on_beam.roll_ball(beam, BALL, law, sensors=[0.5, 0.7], **PATH)
    found = roll_bodies(beam, [rolling_ball()], [law], positions=[0.0], sensors=[0.5, 0.7], **PATH)
    assert np.std(kind.contact_force) > 0.1 * BALL.static_load
    assert not kind.contact_loss  # flights multiply what rounding leaves
    same(found.contact_force[0], kind.contact_force)
    same(found.over_displacement[0], kind.beam_displacement)
    same(found.rolling_displacement[0], kind.ball_displacement)
    same(found.acceleration, kind.acceleration)
    same(found.positions[0], kind.position)
    assert found.energy.throughput == pytest.approx(kind.energy.throughput, rel=1e-9)


# --- messages ----------------------------------------------------------------------------------


def test_wrong_numbers_of_things_are_refused():
    law = Linear(5.0, 1e7)
    with pytest.raises(InputError, match=r"bodies: received none.*one or more"):
        roll_bodies(BEAM, [], [], positions=[], **PATH)
    with pytest.raises(InputError, match=r"positions of the bodies.*2 finite numbers, one for each body"):
        roll_bodies(BEAM, [rolling_ball()] * 2, [law] * 2, positions=[0.0], **PATH)
    with pytest.raises(InputError, match=r"laws.*1.*2, one for each contact"):
        roll_bodies(BEAM, [rolling_ball()] * 2, [law], positions=[0.0, 0.1], **PATH)
    with pytest.raises(InputError, match=r"path of contact 2.*on the structure"):
        roll_bodies(BEAM, [rolling_ball()] * 2, [law] * 2, positions=[0.0, 0.69], **PATH)
    with pytest.raises(InputError, match=r"sensors: received 1 on a rigid plane"):
        roll_bodies(None, [rolling_ball()], [law], positions=[0.0], sensors=[0.5], **PATH)
    with pytest.raises(InputError, match=r"loads of the bodies.*none that presses"):
        roll_bodies(None, [rolling_ball(load=0.0)], [law], positions=[0.0], **PATH)
