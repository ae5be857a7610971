"""What several contacts refuse, warn of, and fail with."""

import warnings

import numpy as np
import pytest

from asperity.errors import (
    CoarseSamplingWarning,
    ComputationError,
    ExtrapolationWarning,
    InputError,
    Outcome,
    UnconvergedWarning,
)
from asperity.kernels import stepping
from asperity.laws import HertzLaw, Linear
from asperity.reduction.texture import StateTexture
from asperity.reference.materials import material
from asperity.rolling.rest import at_rest
from asperity.rolling.roll import roll_bodies
from asperity.structures.beam import Beam
from asperity.structures.body import Body

BEAM = Beam.rectangular(1.0, 0.05, 0.01, material("steel"), highest_frequency=2e3)
BALL = Body.rigid(0.5, 5.0)
PATH = {"speed": 1.0, "start": 0.3, "duration": 0.01, "time_step": 1e-5}
LAW = Linear(5.0, 1e7)


def test_wrong_numbers_of_things_are_refused():
    with pytest.raises(InputError, match=r"bodies: received none.*one or more"):
        roll_bodies(BEAM, [], [], positions=[], **PATH)
    with pytest.raises(InputError, match=r"positions of the bodies.*2 finite numbers, one for each body"):
        roll_bodies(BEAM, [BALL] * 2, [LAW] * 2, positions=[0.0], **PATH)
    with pytest.raises(InputError, match=r"laws.*1.*2, one for each contact"):
        roll_bodies(BEAM, [BALL] * 2, [LAW], positions=[0.0, 0.1], **PATH)
    with pytest.raises(InputError, match=r"path of contact 2.*0.995 to 1.005.*on the structure"):
        roll_bodies(BEAM, [BALL] * 2, [LAW] * 2, positions=[0.0, 0.695], **PATH)
    with pytest.raises(InputError, match=r"sensors: received 1 on a rigid plane"):
        roll_bodies(None, [BALL], [LAW], positions=[0.0], sensors=[0.5], **PATH)
    with pytest.raises(InputError, match=r"loads of the bodies.*none that presses"):
        roll_bodies(None, [Body.rigid(0.5, 0.0)], [LAW], positions=[0.0], **PATH)


def body(mass=1.0, damping=None, stiffness=None):
    """Two masses on one contact."""
    none = np.zeros((2, 2))
    damping, stiffness = (none if part is None else np.array(part) for part in (damping, stiffness))
    rows, empty = np.array([[1.0, 0.0]]), np.zeros(0)
    return Body(
        mass * np.eye(2), damping, stiffness, rows, np.array([5.0, 0.0]), np.zeros(1), empty, empty,
        np.zeros((1, 0)),
    )  # fmt: skip


def test_bodies_that_are_none_are_refused():
    with pytest.raises(InputError, match=r"damping of a body.*not symmetric"):
        roll_bodies(None, [body(damping=[[0, 1.0], [0, 0]])], [LAW], positions=[0.0], **PATH)
    with pytest.raises(InputError, match=r"stiffness of a body.*negative.*springs that pull back"):
        roll_bodies(None, [body(stiffness=[[-1e3, 0], [0, 1e3]])], [LAW], positions=[0.0], **PATH)


def test_a_contact_that_carries_nothing_is_told():
    """One law alone, and bodies whose contacts cannot carry them together."""
    with pytest.raises(
        ComputationError, match=r"do not come to rest on their contacts \(1\) at the start.*loads of 5 N"
    ):
        roll_bodies(None, [BALL], [HertzLaw(1e-3)], positions=[0.0], **PATH)

    def weak(approach):
        return min(max(1e6 * approach, 0.0), 2.51), 1e6 if 0.0 < approach < 2.51e-6 else 0.0

    one, none, empty = np.ones((1, 1)), np.zeros((1, 1)), np.zeros(0)
    pair = Body(
        one, none, none, np.ones((2, 1)), np.array([5.0]), np.zeros(2), empty, empty, np.zeros((2, 0))
    )
    with pytest.raises(ComputationError, match=r"do not come to rest on their contacts \(2\) at the start"):
        at_rest([pair], np.array([0.0, 1e4]), np.zeros((2, 2)), [weak, weak])


def test_time_steps_that_are_too_long_are_warned_of():
    seen = warned(Linear(5.0, 1e9), time_step=2e-5, highest_frequency=6e3)
    for what in ("the contact resonance", "the highest mode of the structure", "the highest frequency asked"):
        assert sum(what in message for message in seen[CoarseSamplingWarning]) == 1


def warned(law, structure=None, count=2, **changes):
    beam = structure or Beam.rectangular(1.0, 0.05, 0.01, material("steel"), highest_frequency=15e3)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        at = 0.1 * np.arange(count)
        run = roll_bodies(beam, [BALL] * count, [law] * count, positions=at, **PATH | changes)
    found = {"run": run}
    for warning in caught:
        found.setdefault(warning.category, []).append(str(warning.message))
    return found


def test_a_law_beyond_its_data_is_told_once_for_all_contacts():
    class Short:
        name, damping = "short", 0.0

        def prepare(self, positions):
            return HertzLaw(1e9).prepare(positions)._replace(upper=1e-7)

    seen = warned(Short(), BEAM)[ExtrapolationWarning]
    assert len(seen) == 1
    assert "short: the contact was closer than its largest computed state in 2002 of 2002" in seen[0]


def test_forces_that_miss_the_tolerance_are_counted(monkeypatch):
    """Sweeps of Python: with one alone the contacts have not heard of each other."""

    class Python:
        name, damping = "stepped", 0.0

        def prepare(self, positions):
            return self

        def evaluate(self, step, approach):
            return 5.0 + 1e7 * (approach + 1e-7 * np.sin(step)), 1e7

        accept = restore = lambda self, value: None
        state = dict
        warn_of_flaws = staticmethod(lambda: None)

    monkeypatch.setattr(stepping, "SWEEPS", 1)
    seen = warned(Python(), BEAM, duration=1e-4)
    assert len(seen[UnconvergedWarning]) == 1
    assert "stepped: 10 of 10 time steps (100 %) missed the tolerance" in seen[UnconvergedWarning][0]
    assert seen["run"].outcome is Outcome.STEPS_UNCONVERGED
    assert seen["run"].unconverged_steps == 10
    monkeypatch.undo()
    assert warned(Python(), BEAM, duration=1e-4)["run"].outcome is Outcome.CONVERGED


def test_a_motion_that_runs_away_is_told():
    cliff = np.zeros(4000)
    cliff[1400:] = -10.0  # m
    texture = StateTexture.unfiltered(cliff, 1e-5, 0.29)
    with pytest.raises(
        ComputationError, match=r"runs away: at step \d+, time .* contact force is .* under a load"
    ):
        roll_bodies(None, [BALL] * 2, [LAW, Linear(5.0, 1e7, 0.0, texture)], positions=[0.0, 0.0], **PATH)
