"""Wheels on one rail: against single runs, receptances in superposition, energy, interruption."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from asperity.errors import ComputationError, LargeDeflectionWarning
from asperity.laws import HertzLaw, Linear
from asperity.reduction.texture import StateTexture
from asperity.rolling.course import Course
from asperity.rolling.driver import RolledMechanism, carried, recorded
from asperity.rolling.mechanism import Mechanism, RollingContact, Side
from asperity.rolling.roll import roll_bodies
from asperity.rolling.trajectory import Path
from asperity.structures.body import GRAVITY, Body, Wheel, carriage, chain
from asperity.structures.modal import ModalStructure
from asperity.structures.moving_kernel import moving_kernel
from asperity.structures.rail_poles import rail_between, rail_poles
from asperity.structures.track import Track
from one_contact import Shelf, rigid_bar, roll_wheel, rough, same

TRACK = Track.named("nordborg", rail_loss_factor=0.03)
SPEED, STEP, LOAD, MASS = 56.0, 50e-6, 65e3, 600.0
PATH = {"start": 0.53, "duration": 0.03, "settling": 0.011, "speed": SPEED, "time_step": STEP}
SLOW = {"start": 0.1, "speed": 0.01, "time_step": 25e-6, "positions": [0.0, 2.5]}
RIGID = Body.rigid(MASS, LOAD)


def texture(rms, points=8000):
    return rough(rms, 1e-3, -1.0, points)


@pytest.fixture(scope="module")
def kernel():
    return moving_kernel(TRACK, SPEED, STEP, duration=0.08, positions=6)


@pytest.fixture(scope="module")
def poles(kernel):
    return rail_poles(kernel, 60)


@pytest.fixture(scope="module")
def between(poles):
    return rail_between(poles, [0.0, 2.5])


@pytest.fixture(scope="module")
def slow():
    """The rail between two wheels that hardly move: at one place of the bay."""
    return rail_between(moving_kernel(TRACK, 0.01, 25e-6, duration=0.12, positions=6), [0.0, 2.5])


def test_a_rail_that_sinks_is_no_result(poles):
    """As a mass that nothing holds, ten times that of the wheel, which then falls with it."""
    swing = np.exp(1j * 0.5 * STEP)  # so slow that it has no time to turn back
    sinking = np.full((len(poles.residues), 1), -1j * STEP / (10 * MASS * 0.5))
    residues = np.append(poles.residues, sinking, axis=1)
    falling = replace(poles, poles=np.append(poles.poles, swing), residues=residues)
    law, path = HertzLaw(9.4e10, texture(1e-6)), {"start": 0.53, "duration": 0.03, "settling": 0.02}
    assert roll_wheel(poles, Wheel(MASS, LOAD), law, **path).outcome.ok
    with (
        pytest.warns(LargeDeflectionWarning, match="the rail is displaced by up to 0.2"),
        pytest.raises(ComputationError, match=r"hertz: the mean contact force .* load of 65000 N") as told,
    ):
        roll_wheel(falling, Wheel(MASS, LOAD), law, **path)
    assert float(str(told.value).split("force of ")[1].split()[0]) == pytest.approx(LOAD / 1.1, rel=0.02)
    assert "Try: what a warning asks for, if there is one; else" in str(told.value)
    assert told.value.exit_code == 3


def test_two_wheels_far_apart_are_two_single_ones(kernel, monkeypatch):
    """At 40 m the vibration of this rail has died away to 1e-4; nearer by it has not."""
    law = HertzLaw(9.4e10, texture(1e-5, 50000))

    def rolled(places, negligible=0.0, start=0.53):
        monkeypatch.setattr("asperity.structures.rail_poles.NEGLIGIBLE", negligible)
        between, bodies = rail_between(kernel, places), [RIGID] * len(places)
        path = PATH | {"start": start, "positions": places}
        return roll_bodies(between, bodies, [law] * len(places), **path).contact_force

    single, far, near = (rolled([0.0], start=0.53 + at)[0] for at in (0.0, 40.0, 2.5))
    same(rolled([0.0, 40.0], np.inf), np.array([single, far]), 1e-9)
    same(rolled([0.0, 40.0]), np.array([single, far]), 2e-3)
    difference = np.abs(rolled([0.0, 2.5]) - [single, near])
    assert (difference.max(axis=1) > 0.05 * LOAD).all()


def test_a_pulse_under_one_wheel_shakes_both_as_receptances_say(slow):
    """F = −(A_wheel + A_contact + A_rail)⁻¹ h with the rail's point and transfer receptances.

    Superposition for several wheels on a rail: Wu and Thompson, J. Sound Vib. 247 (2001) 57 (not seen).
    """
    stiffness, h, pulse = 1.2e9, 25e-6, np.zeros(20000)
    pulse[400:425] = 1e-7 * np.hanning(25)
    bump = StateTexture.unfiltered(pulse, 0.01 * h, 0.1)
    smooth = StateTexture.unfiltered(0.0 * pulse, 0.01 * h, 2.6)
    laws = [Linear(LOAD, stiffness, 0.0, each) for each in (bump, smooth)]
    force = roll_bodies(slow, [RIGID] * 2, laws, duration=0.45, **SLOW).contact_force - LOAD
    assert np.abs(force[:, -2000:]).max() < 1e-3 * np.abs(force).max()  # all of it is in the record
    frequency = np.fft.rfftfreq(force.shape[1], h)
    chosen = (frequency > 80.0) & (frequency < 1500.0)
    f, spectrum = frequency[chosen], np.fft.rfft(force)[:, chosen].T
    roughness = np.fft.rfft(pulse[: force.shape[1]])[chosen]
    rail = [[slow.kernel.track.receptance(f, x, x0) for x0 in (0.1, 2.6)] for x in (0.1, 2.6)]
    own = 1.0 / stiffness - 1.0 / (MASS * (2 * np.pi * f) ** 2)
    matrix = np.moveaxis(rail, 2, 0) + own[:, None, None] * np.eye(2)
    expected = -np.linalg.inv(matrix)[:, :, 0] * roughness[:, None]
    largest = np.abs(expected).max(axis=0)
    assert largest[1] > 0.2 * largest[0]
    assert (np.abs(spectrum - expected).max(axis=0) < 0.02 * largest).all()


def test_a_rigid_carriage_on_three_wheels_starts_steadily(kernel):
    """Statically indeterminate on a rail: the loads settle between the bodies and the rail."""
    places = np.array([-1.8, 0.0, 1.8])
    body = rigid_bar(1800.0, 2000.0, places, 3 * LOAD)
    path = PATH | {"settling": 0.0, "positions": [1.8]}
    run = roll_bodies(rail_between(kernel, places), [body], [HertzLaw(9.4e10)] * 3, **path)
    force = run.contact_force
    assert force[:, 0].sum() == pytest.approx(3 * LOAD, rel=1e-6)
    assert force[:, 0] @ places == pytest.approx(0.0, abs=1e-6 * LOAD)
    assert np.ptp(force[:, 0]) > 0.02 * LOAD  # the rail is not rigid, the carriage is
    assert_allclose(force[:, :10], np.tile(force[:, :1], 10), rtol=5e-3)
    assert run.energy.residual < 1e-5
    assert run.energy.shares["structure"] == run.energy.shares["slope of the structure"] == 0.0


def test_the_energy_of_sprung_wheels_on_a_rail_closes(between):
    """What goes into springs and dampers of a bogie, into contacts and rail."""
    law = HertzLaw(9.4e10, texture(3e-5), damping=2e3)
    body = carriage(3000.0, 2500.0, [0.0, 2.5], MASS, 1.2e6, 2e4, load=90e3)
    run = roll_bodies(between, [body], [law] * 2, positions=[0.0], **PATH)
    energy = run.energy
    assert run.contact_force.std() > 0.1 * LOAD
    assert energy.residual < 1e-5
    assert energy.shares["damping of the bodies"] > 1e-3 * energy.throughput
    assert energy.contact_damping > 1e-3 * energy.throughput


def test_what_a_spring_carries_above_two_wheels_may_be_a_structure(between):
    """A free mass that a spring presses on each wheel, against masses that are coordinates of the bodies."""
    above, spring, damper, load = 1200.0, 2e7, 3e4, 40e3
    law = HertzLaw(9.4e10, texture(4e-5), damping=2e3)
    path = Path.laid(PATH["start"], SPEED, STEP, PATH["duration"], PATH["settling"]).ahead([0.0, 2.5])
    on_rail = [RollingContact(law, along.places, (Side(0, along),)) for along in path.trajectories]

    def rolled(mechanism):
        course = Course(mechanism, STEP, path.total)
        loads = np.full(course.contacts, LOAD)
        none = np.zeros((0, mechanism.first_modes[-1]))
        run = carried(course, loads, sensors=none)
        return RolledMechanism(**recorded(run))

    sprung = chain([MASS, above], [spring], [damper], load=load)
    expected = rolled(Mechanism([between], [sprung] * 2, on_rail)).contact_force
    none, both = np.zeros((1, 1)), np.array([[1.0], [-1.0]])
    wheel = Body(np.array([[MASS]]), none, none, both, np.array([MASS * GRAVITY]), np.zeros(2))
    mass = ModalStructure([-10.0, 1e3], [0.0], 0.0, np.full((2, 1), above**-0.5))
    link = Linear(load + above * GRAVITY, spring, damping=damper)
    contacts = []
    for place, (below, along) in enumerate(zip(on_rail, path.trajectories, strict=True), 1):
        contacts += [below, RollingContact(link, along.places, (Side(place, along),))]
    pressed = np.array([-(load + above * GRAVITY) * above**-0.5])
    made = Mechanism([between, mass, mass], [wheel] * 2, contacts, [np.zeros(0), pressed, pressed])
    run = rolled(made)
    assert expected.std() > 0.1 * LOAD
    same(run.contact_force[::2], expected, 1e-3)  # of the damper, in steps
    assert np.ptp(run.contact_force[1::2]) > 0.05 * LOAD
    assert run.energy.residual < 1e-9
    assert run.energy.shares["structure"] > 1e-4 * run.energy.throughput


def test_wheels_go_on_where_they_were_on_poles_as_good_as_the_kernels_themselves(kernel, between):
    law, forces = HertzLaw(9.4e10, texture(2e-5, 30000)), []
    path = PATH | {"duration": 0.25, "positions": [0.0, 2.5]}

    def stop(done, total, what):
        raise KeyboardInterrupt

    for rail in (rail_between(kernel, [0.0, 2.5]), between):
        shelf = Shelf()
        whole = roll_bodies(rail, [RIGID] * 2, [law] * 2, **path)
        with pytest.raises(KeyboardInterrupt):
            roll_bodies(rail, [RIGID] * 2, [law] * 2, progress=stop, checkpoint=shelf, **path)
        assert 0 < shelf.arrays["motion.counts"][0] < whole.history.shape[1] - 1
        resumed = roll_bodies(rail, [RIGID] * 2, [law] * 2, checkpoint=shelf, **path)
        assert_array_equal(resumed.contact_force, whole.contact_force)
        assert_array_equal(resumed.over_displacement, whole.over_displacement)
        forces.append(whole.contact_force[:, :600])
    same(forces[1], forces[0], 0.01)
    assert forces[0].std() > 0.05 * LOAD
