"""Several wheels on one rail: against one wheel, single runs, receptances in superposition."""

from dataclasses import replace

import numpy as np
import pytest
from shelf import Shelf

from asperity.errors import ComputationError, InputError
from asperity.laws import HertzLaw, Linear
from asperity.reduction.texture import StateTexture
from asperity.rolling.roll import roll_bodies
from asperity.structures.body import Body
from asperity.structures.moving_kernel import moving_kernel
from asperity.structures.rail_poles import rail_between, rail_poles
from asperity.structures.track import Track
from asperity.structures.wheel import Wheel
from one_contact import roll_wheel

TRACK = Track(
    bending_stiffness=4.725e6, mass_per_length=60.0, rail_loss_factor=0.03, pad_stiffness=300e6,
    pad_damping=18e3, sleeper_mass=150.0, ballast_stiffness=150e6, ballast_damping=48e3, sleeper_spacing=0.6,
)  # fmt: skip
SPEED, STEP, LOAD, MASS = 56.0, 50e-6, 65e3, 600.0
PATH = {"start": 0.53, "duration": 0.03, "settling": 0.011, "speed": SPEED, "time_step": STEP}
RIGID = Body.rigid(MASS, LOAD)


def rough(rms, start, points=8000, spacing=1e-3):
    steps = np.random.default_rng(2).standard_normal(points)
    heights = np.convolve(steps, np.hanning(30), mode="same")
    return StateTexture.unfiltered(rms * heights / heights.std(), spacing, start)


def same(found, expected, rel=1e-9):
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=rel * np.abs(expected).max())


@pytest.fixture(scope="module")
def kernel():
    return moving_kernel(TRACK, SPEED, STEP, duration=0.08, positions=12)


@pytest.fixture(scope="module")
def poles(kernel):
    return rail_poles(kernel, 60)


@pytest.fixture(scope="module")
def bogie(poles):
    return rail_between(poles, [0.0, 2.5])


def ringing():
    """As `Wheel`."""
    one, none = np.ones((1, 1)), np.zeros((1, 1))
    shapes = 1 / np.sqrt([[300.0, 100.0]])
    modes = np.array([400.0, 2000.0]), np.array([0.01, 0.002])
    return Body(MASS * one, none, none, one, np.array([LOAD]), np.zeros(1), *modes, shapes)


# --- one wheel ---------------------------------------------------------------------------------


def test_a_rail_that_sinks_is_no_result(poles):
    """As a mass that nothing holds, ten times that of the wheel, which then falls with it."""
    swing = np.exp(1j * 0.5 * STEP)  # so slow that it has no time to turn back
    sinking = np.full((len(poles.residues), 1), -1j * STEP / (10 * MASS * 0.5))
    falling = replace(
        poles, poles=np.append(poles.poles, swing), residues=np.append(poles.residues, sinking, axis=1)
    )
    law, path = HertzLaw(9.4e10, rough(1e-6, -1.0)), {"start": 0.53, "duration": 0.03, "settling": 0.02}
    assert roll_wheel(poles, Wheel(MASS, LOAD), law, **path).outcome.ok
    with pytest.raises(
        ComputationError, match=r"hertz: the mean contact force .* load of 6.5e\+04 N"
    ) as told:
        roll_wheel(falling, Wheel(MASS, LOAD), law, **path)
    assert float(str(told.value).split("force of ")[1].split()[0]) == pytest.approx(LOAD / 1.1, rel=0.02)
    assert "Try: what a warning asks for, if there is one; else" in str(told.value)
    assert told.value.exit_code == 3


# --- two wheels --------------------------------------------------------------------------------


def test_two_wheels_far_apart_are_two_single_ones(kernel):
    """At 40 m the vibration of this rail has died away to 1e-4; nearer by it has not."""
    law = HertzLaw(9.4e10, rough(1e-5, -0.5, 50000))
    single = [
        roll_bodies(
            rail_between(kernel, [0.0]),
            [RIGID],
            [law],
            positions=[0.0],
            **PATH | {"start": PATH["start"] + at},
        ).contact_force[0]
        for at in (0.0, 40.0, 2.5)
    ]

    def together(at, reach):
        between = rail_between(kernel, [0.0, at], reach=reach)
        assert (between.between(at) is not None) == (at <= reach)
        return roll_bodies(between, [RIGID] * 2, [law] * 2, positions=[0.0, at], **PATH).contact_force

    same(together(40.0, 30.0), np.array(single[:2]), 1e-9)
    same(together(40.0, 50.0), np.array(single[:2]), 2e-3)
    near = together(2.5, 10.0)
    for found, expected in zip(near, (single[0], single[2]), strict=True):
        assert np.abs(found - expected).max() > 0.05 * LOAD


def test_poles_are_as_good_as_the_kernels_themselves(kernel, bogie):
    law = HertzLaw(9.4e10, rough(1e-5, -0.5))
    scattered = rail_between(kernel, [0.0, 2.5])
    runs = [
        roll_bodies(rail, [RIGID] * 2, [law] * 2, positions=[0.0, 2.5], **PATH) for rail in (bogie, scattered)
    ]
    same(runs[0].contact_force, runs[1].contact_force, 0.01)
    assert runs[0].contact_force.std() > 0.05 * LOAD


@pytest.fixture(scope="module")
def slow():
    """Hardly moving: at one place of the bay."""
    return moving_kernel(TRACK, 0.01, 25e-6, duration=0.12, positions=6)


def test_two_loads_deflect_the_rail_as_its_receptances_superpose(slow):
    between = rail_between(slow, [0.0, 2.5])
    bodies, laws = [RIGID, Body.rigid(MASS, 40e3)], [HertzLaw(9.4e10)] * 2
    found = roll_bodies(
        between, bodies, laws, start=0.1, duration=2e-3, speed=0.01, time_step=25e-6, positions=[0.0, 2.5]
    )
    places, track = (0.1, 2.6), slow.track
    static = np.array([[track.receptance(0.2, x, x0).real for x0 in places] for x in places])
    assert static[0, 1] < 0.0  # it rises there
    expected = static @ [LOAD, 40e3]
    np.testing.assert_allclose(found.over_displacement[:, 0], expected, rtol=2e-3)
    # and stay so, at rest
    np.testing.assert_allclose(found.contact_force[:, -1], [LOAD, 40e3], rtol=1e-3)


def test_a_pulse_under_one_wheel_shakes_both_as_receptances_say(slow):
    """F = −(A_wheel + A_contact + A_rail)⁻¹ h with the rail's point and transfer receptances.

    Superposition for several wheels on a rail: Wu and Thompson, J. Sound Vib. 247 (2001) 57 (not seen).
    """
    stiffness, speed, h, start = 1.2e9, 0.01, 25e-6, 0.1
    between = rail_between(slow, [0.0, 2.5])
    pulse = np.zeros(20000)
    pulse[400:425] = 1e-7 * np.hanning(25)
    bump = StateTexture.unfiltered(pulse, speed * h, start)
    smooth = StateTexture.unfiltered(np.zeros(20000), speed * h, start + 2.5)
    laws = [Linear(LOAD, stiffness, 0.0, texture) for texture in (bump, smooth)]
    found = roll_bodies(
        between, [RIGID] * 2, laws, start=start, duration=0.45, speed=speed, time_step=h, positions=[0.0, 2.5]
    )
    force = found.contact_force - LOAD
    assert np.abs(force[:, -2000:]).max() < 1e-3 * np.abs(force).max()  # all of it is in the record
    frequency = np.fft.rfftfreq(force.shape[1], h)
    chosen = (frequency > 80.0) & (frequency < 1500.0)
    spectrum = np.fft.rfft(force)[:, chosen]
    roughness = np.fft.rfft(pulse[: force.shape[1]])[chosen]
    frequency, expected = frequency[chosen], np.zeros_like(spectrum)
    places, track = (start, start + 2.5), slow.track
    rail = np.array([[track.receptance(frequency, x, x0) for x0 in places] for x in places])
    own = -1.0 / (MASS * (2 * np.pi * frequency) ** 2) + 1.0 / stiffness
    for line in range(len(frequency)):
        matrix = rail[:, :, line] + own[line] * np.eye(2)
        expected[:, line] = -np.linalg.solve(matrix, [roughness[line], 0.0])
    assert np.abs(expected[1]).max() > 0.2 * np.abs(expected[0]).max()
    for wheel in (0, 1):
        error = np.abs(spectrum[wheel] - expected[wheel]) / np.abs(expected[wheel]).max()
        assert error.max() < 0.02


# --- bodies on several wheels ------------------------------------------------------------------


def test_a_rigid_carriage_on_three_wheels_starts_steadily(kernel):
    """Statically indeterminate on a rail: the loads settle between the bodies and the rail."""
    places = np.array([-1.8, 0.0, 1.8])
    none, empty = np.zeros((2, 2)), np.zeros(0)
    rows = np.column_stack([np.ones(3), places])
    mass = np.diag([1800.0, 2000.0])
    body = Body(mass, none, none, rows, np.array([3 * LOAD, 0.0]), places, empty, empty, np.zeros((3, 0)))
    path = PATH | {"settling": 0.0}
    run = roll_bodies(rail_between(kernel, places), [body], [HertzLaw(9.4e10)] * 3, positions=[1.8], **path)
    force = run.contact_force
    assert force[:, 0].sum() == pytest.approx(3 * LOAD, rel=1e-6)
    assert force[:, 0] @ places == pytest.approx(0.0, abs=1e-6 * LOAD)
    assert np.ptp(force[:, 0]) > 0.02 * LOAD  # the rail is not rigid, the carriage is
    np.testing.assert_allclose(force[:, :10], np.tile(force[:, :1], 10), rtol=5e-3)
    assert run.energy.residual < 1e-5
    assert run.energy.shares["structure"] == run.energy.shares["slope of the structure"] == 0.0


def test_the_energy_of_sprung_wheels_on_a_rail_closes(bogie):
    """Two wheels under a frame on springs and dampers, and what goes into contacts and rail."""
    spring, damper, arm = 1.2e6, 2e4, 1.25
    rows = np.array([[1.0, 0.0, -1.0, -arm], [0.0, 1.0, -1.0, arm]])  # wheels, heave and pitch of the frame
    wheels = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]])
    body = Body(
        np.diag([MASS, MASS, 3000.0, 2500.0]), damper * rows.T @ rows, spring * rows.T @ rows, wheels,
        np.array([6e3, 6e3, 118e3, 0.0]), np.array([0.0, 2.5]), np.zeros(0), np.zeros(0), np.zeros((2, 0)),
    )  # fmt: skip
    law = HertzLaw(9.4e10, rough(3e-5, -0.5), damping=2e3)
    run = roll_bodies(bogie, [body], [law] * 2, positions=[0.0], **PATH)
    energy = run.energy
    assert run.contact_force.std() > 0.1 * LOAD
    assert energy.residual < 1e-5
    assert energy.shares["damping of the bodies"] > 1e-3 * energy.throughput
    assert energy.contact_damping > 1e-3 * energy.throughput


@pytest.mark.parametrize("scattered", [False, True], ids=["poles", "scattered"])
def test_wheels_on_a_rail_go_on_where_they_were(kernel, bogie, scattered):
    rail = rail_between(kernel, [0.0, 2.5]) if scattered else bogie
    law = HertzLaw(9.4e10, rough(2e-5, -0.5, 30000))
    path, shelf = PATH | {"duration": 0.2}, Shelf()
    whole = roll_bodies(rail, [RIGID] * 2, [law] * 2, positions=[0.0, 2.5], **path)

    def stop(done, total, what):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        roll_bodies(
            rail, [RIGID] * 2, [law] * 2, positions=[0.0, 2.5], progress=stop, checkpoint=shelf, **path
        )
    assert 0 < shelf.arrays["motion.counts"][0] < 4000
    resumed = roll_bodies(rail, [RIGID] * 2, [law] * 2, positions=[0.0, 2.5], checkpoint=shelf, **path)
    np.testing.assert_array_equal(resumed.contact_force, whole.contact_force)
    np.testing.assert_array_equal(resumed.over_displacement, whole.over_displacement)


# --- cost and messages -------------------------------------------------------------------------


def test_a_rail_for_other_wheels_is_refused(bogie):
    law = HertzLaw(9.4e10)
    with pytest.raises(
        InputError, match=r"distance of two contacts on the rail.*3.*-2\.5, 2\.5.*rail between"
    ):
        roll_bodies(bogie, [RIGID] * 2, [law] * 2, positions=[0.0, 3.0], **PATH)
    with pytest.raises(InputError, match=r"path.*50 m/s.*kernel was computed"):
        roll_bodies(bogie, [RIGID] * 2, [law] * 2, positions=[0.0, 2.5], **PATH | {"speed": 50.0})
    with pytest.raises(InputError, match=r"sensors.*a rail is known under the contacts alone"):
        roll_bodies(bogie, [RIGID] * 2, [law] * 2, positions=[0.0, 2.5], sensors=[1.0], **PATH)
