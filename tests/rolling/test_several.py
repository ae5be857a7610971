"""Several contacts at once: against one contact, closed forms, other integrators, energy, interruption."""

import warnings

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from shelf import Shelf

from asperity.contact import Hertz
from asperity.errors import CoarseSamplingWarning
from asperity.laws import Direct, HertzLaw, Linear
from asperity.laws.layout import force as force_of
from asperity.reduction.texture import StateTexture
from asperity.reference.materials import material
from asperity.rolling.roll import roll_bodies
from asperity.structures.beam import Beam
from asperity.structures.body import Ball, Body

STEEL = material("steel")
BALL = Ball(0.025, STEEL)
BEAM = Beam.rectangular(1.0, 0.05, 0.01, STEEL, highest_frequency=5e3)
LONG = Beam.rectangular(3.0, 0.05, 0.01, STEEL, highest_frequency=4.3e3)
PATH = {"speed": 1.0, "start": 0.3, "duration": 0.02, "time_step": 1e-5, "settling": 0.005}


def rough(rms, spacing, start, points=4000, seed=2):
    steps = np.random.default_rng(seed).standard_normal(points)
    heights = np.convolve(steps, np.hanning(30), mode="same")
    return StateTexture.unfiltered(rms * heights / heights.std(), spacing, start)


def waves(amplitude, length, start, end, points=200):
    """A sine along the path; the spline through it is exact to (2π/points)⁴/384."""
    spacing = length / points
    x = start + spacing * np.arange(int((end - start) / spacing) + 2)
    return StateTexture.unfiltered(amplitude * np.sin(2 * np.pi * x / length), spacing, start)


def same(found, expected, rel=1e-9):
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=rel * np.abs(expected).max())


def rolling_ball(mass=BALL.mass, load=BALL.static_load):
    return Body.rigid(mass, load)


def assembled(mass, damping, stiffness, contacts, pressing, places):
    """A body without modes."""
    none, c = np.zeros(0), len(places)
    parts = (np.asarray(part, float) for part in (mass, damping, stiffness, contacts, pressing, places))
    return Body(*parts, none, none, np.zeros((c, 0)))


def carriage(mass, load, places, inertia=None):
    """A rigid body that heaves and pitches."""
    places = np.asarray(places, float)
    inertia = mass * np.mean(places**2) if inertia is None else inertia
    none = np.zeros((2, 2))
    rows = np.column_stack([np.ones(len(places)), places])
    return assembled(np.diag([mass, inertia]), none, none, rows, [load, 0.0], places)


# --- one contact -------------------------------------------------------------------------------


@pytest.mark.parametrize("count", [2, 4])
def test_equal_balls_under_a_rigid_carriage_share_it(count):
    """Each as one ball with its share of mass and load: the carriage only heaves."""
    shift = 0.1 * (np.arange(count) - 0.5 * (count - 1))
    body = carriage(count * 0.2, count * 6.0, shift)
    laws = [HertzLaw(2e9, rough(8e-8, 1e-5, 0.29 + place)) for place in shift]
    one = roll_bodies(
        None, [Body.rigid(0.2, 6.0)], [HertzLaw(2e9, rough(8e-8, 1e-5, 0.29))], positions=[0.0], **PATH
    )
    found = roll_bodies(None, [body], laws, positions=[0.0], **PATH)
    assert one.contact_force.std() > 1.0
    for force in found.contact_force:
        same(force, one.contact_force[0], 1e-8)
    heave, pitch = found.degrees_of_freedom[0]
    same(heave, one.degrees_of_freedom[0][0], 1e-8)
    assert np.abs(pitch).max() < 1e-6 * np.ptp(heave)


def test_a_symmetric_beam_is_shaken_symmetrically():
    """Two balls at equal distances from mid-span, hardly moving, over equal textures."""
    path = PATH | {"speed": 1e-6, "settling": 0.0, "start": 0.3, "duration": 0.01}
    laws = [HertzLaw(2.4e10, rough(1e-8, 1e-11, at)) for at in (0.3, 0.7)]
    found = roll_bodies(
        BEAM, [rolling_ball()] * 2, laws, positions=[0.0, 0.4], sensors=[0.1, 0.35, 0.65, 0.9], **path
    )
    assert found.contact_force.std() > 0.1 * BALL.static_load
    same(found.contact_force[0], found.contact_force[1], 2e-5)  # of the texture, at such a speed
    same(found.acceleration[:2], found.acceleration[:1:-1], 2e-5)


def test_the_order_of_the_bodies_does_not_matter():
    law = HertzLaw(2.4e10, rough(8e-9, 1e-5, 0.29, 20000))
    at, masses = np.array([0.0, 0.02, 0.09, 0.1]), np.array([0.4, 0.5, 0.6, 0.7])
    found = [
        roll_bodies(
            BEAM, [rolling_ball(mass) for mass in masses[order]], [law] * 4, positions=at[order], **PATH
        )
        for order in (np.arange(4), np.array([2, 0, 3, 1]))
    ]
    assert found[0].contact_force.std() > 0.1 * BALL.static_load
    same(found[1].contact_force, found[0].contact_force[[2, 0, 3, 1]], 1e-8)


def test_contacts_feel_each_other_through_the_beam():
    """What makes the tests above say something: a second ball changes the force of the first."""
    law = HertzLaw(2.4e10, rough(2e-8, 1e-5, 0.29, 20000))
    one = roll_bodies(BEAM, [rolling_ball()], [law], positions=[0.0], **PATH)
    two = roll_bodies(BEAM, [rolling_ball()] * 2, [law] * 2, positions=[0.0, 0.05], **PATH)
    assert np.abs(two.contact_force[0] - one.contact_force[0]).max() > 0.05 * BALL.static_load


# --- against closed forms and another integrator -----------------------------------------------


def test_two_moving_forces_superpose():
    """Frýba, Vibration of Solids and Structures under Moving Loads: each mode in closed form."""
    beam = Beam.rectangular(1.0, 0.05, 0.01, STEEL, highest_frequency=2e3, loss_factor=0.0)
    load, speed, apart = 50.0, 8.0, 0.23
    # a contact so soft, and a mass so large, that the force stays the load
    bodies, laws = [Body.rigid(1e3, load)] * 2, [Linear(load, 1e-3)] * 2
    found = roll_bodies(
        beam, bodies, laws, speed=speed, start=0.1, duration=0.06, time_step=1e-5, positions=[0.0, apart]
    )
    same(found.contact_force, np.full((2, 6001), load), 1e-6)
    t, expected = found.time, np.zeros_like(found.over_displacement)
    for n, frequency in enumerate(beam.natural_frequencies, start=1):
        omega, turn = 2 * np.pi * frequency, n * np.pi * speed
        scale, q = np.sqrt(2.0 / beam.mass), 0.0
        for first in (0.1, 0.1 + apart):
            phase, factor = n * np.pi * first, scale * load / (omega**2 - turn**2)
            # from the static displacement under the forces where they start, as it moves with them
            rest = scale * load / omega**2 - factor
            q = q + factor * np.sin(phase + turn * t) + rest * np.sin(phase) * np.cos(omega * t)
            q = q + rest * turn * np.cos(phase) * np.sin(omega * t) / omega
        expected += scale * np.sin(n * np.pi * found.positions) * q
    same(found.over_displacement, expected, 1e-6)


RIG = assembled(
    np.diag([0.4, 1.1]),
    [[30.0, -30.0], [-30.0, 30.0]],
    [[4e5, -4e5], [-4e5, 4e5]],
    [[1.0, 0.0]],
    [4.0, 11.0],
    [0.0],
)
"""A wheel that carries a mass on spring and damper."""


def rig_by_integrator(time, speed, start, amplitude, length, stiffness):
    """Force of the rig over a sine, by an adaptive integrator of high order."""

    def force_at(t, y):
        height = amplitude * np.sin(2 * np.pi * (start + speed * t) / length)
        return stiffness * max(-y[0] - height, 0.0) ** 1.5

    def rates(t, y):
        total = RIG.contacts[0] * force_at(t, y) - RIG.damping @ y[2:] - RIG.stiffness @ y[:2] - RIG.pressing
        return np.concatenate([y[2:], total / np.diag(RIG.mass)])

    height = amplitude * np.sin(2 * np.pi * start / length)
    wheel = -((15.0 / stiffness) ** (2 / 3) + height)
    rest = [wheel, wheel - 11.0 / 4e5, 0.0, 0.0]
    found = solve_ivp(
        rates, (0.0, time[-1]), rest, method="DOP853", t_eval=time, rtol=1e-12, atol=1e-18, max_step=2e-5
    )
    return np.array([force_at(t, y) for t, y in zip(found.t, found.y.T, strict=True)])


def rig_by_rolling(time_step, amplitude=5e-7, duration=0.02):
    law = HertzLaw(3e9, waves(amplitude, 4e-3, 0.29, 0.4))
    return roll_bodies(
        None, [RIG], [law], speed=1.0, start=0.3, duration=duration, time_step=time_step, positions=[0.0]
    )


@pytest.fixture(scope="module")
def rig():
    time = 1e-5 * np.arange(2001)
    return rig_by_integrator(time, 1.0, 0.3, 5e-7, 4e-3, 3e9)


def test_a_rig_of_two_masses_is_that_of_an_adaptive_integrator(rig):
    found = rig_by_rolling(2.5e-7)
    assert np.ptp(rig) > 2.0  # of 15 N
    same(found.contact_force[0, ::40], rig, 1e-6)


def test_the_step_is_of_second_order(rig):
    errors = [np.abs(rig_by_rolling(h).contact_force[0, ::n] - rig).max() for h, n in ((1e-5, 1), (5e-6, 2))]
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.05)


def test_a_sprung_carriage_answers_tones_and_balls_cancel():
    """Four balls a quarter period apart on a texture of period L: of its tones k v/L only each fourth heaves.

    On stiff linear contacts a carriage heaves by K/(K − M ω²) times the mean texture under its balls.
    """
    period, speed, h, stiffness, mass = 8e-3, 1.0, 4e-6, 2e7, 0.8
    places = 0.25 * period * (np.arange(4) - 1.5)
    shape = lambda x: 1e-8 * sum(np.cos(2 * np.pi * k * x / period) / k for k in range(1, 9))  # noqa: E731
    x = 0.28 + period / 800 * np.arange(80000)
    law = Linear(5.0, stiffness, 0.0, StateTexture.unfiltered(shape(x), period / 800, 0.28), damping=200.0)
    run = roll_bodies(
        None, [carriage(mass, 20.0, places)], [law] * 4, speed=speed, start=0.35, settling=0.04,
        duration=0.2, time_step=h, positions=[0.0],
    )  # fmt: skip
    heave, pitch = run.degrees_of_freedom[0][:, :-1]
    count = heave.size
    lines = np.round(np.arange(1, 9) * speed / period * count * h).astype(int)
    spectrum = np.abs(np.fft.rfft(heave)) * 2 / count
    omega = 2 * np.pi * np.arange(1, 9) * speed / period
    spring = 4 * (stiffness + 200j * omega)
    one_ball = np.abs(spring / (spring - mass * omega**2)) * 1e-8 / np.arange(1, 9)
    passing = np.abs(np.exp(2j * np.pi * np.outer(np.arange(1, 9), places) / period).mean(axis=1))
    np.testing.assert_allclose(passing, [0, 0, 0, 1, 0, 0, 0, 1], atol=1e-12)
    np.testing.assert_allclose(spectrum[lines] / one_ball, passing, atol=0.01)
    between = np.setdiff1d(np.arange(2, lines[-1]), np.concatenate([lines - 1, lines, lines + 1]))
    assert spectrum[between].max() < 1e-3 * spectrum[lines].max()
    tilted = np.abs(np.fft.rfft(pitch))[lines]  # what does not heave, pitches
    assert tilted[[3, 7]].max() < 1e-3 * tilted[[0, 1, 2]].min()


def test_a_coordinate_too_fast_for_the_step_follows_at_rest():
    """A wheel whose rim sits on a spring of 200 kHz is a wheel with a softer contact, at steps of 10 µs."""
    stiff, light, mass = 6e10, 0.04, 0.46
    rim = assembled(
        np.diag([light, mass]), np.zeros((2, 2)), [[stiff, -stiff], [-stiff, stiff]], [[1.0, 0.0]],
        [0.0, 5.0], [0.0],
    )  # fmt: skip
    texture = waves(3e-8, 4e-4, 0.28, 0.4)
    between = (mass / (mass + light)) ** 2 / stiff  # static compliance of its mode at the rim
    hard, soft = (Linear(5.0, k, 0.0, texture, damping=300.0) for k in (5e8, 1 / (1 / 5e8 + between)))
    found = roll_bodies(None, [rim], [hard], positions=[0.0], **PATH)
    expected = roll_bodies(None, [Body.rigid(mass + light, 5.0)], [soft], positions=[0.0], **PATH)
    assert expected.contact_force.std() > 1.0
    same(found.contact_force, expected.contact_force, 0.01)


# --- energy ------------------------------------------------------------------------------------


def test_the_energy_of_four_contacts_closes_contact_losses_included():
    law = HertzLaw(2.4e10, rough(3e-7, 1e-5, 0.1, 60000), damping=3.0)
    pair = assembled(
        np.diag([0.6, 0.002, 1.5]),
        [[8.0, 0.0, -8.0], [0.0, 0.0, 0.0], [-8.0, 0.0, 8.0]],
        [[3e5, 0.0, -3e5], [0.0, 0.0, 0.0], [-3e5, 0.0, 3e5]],
        [[1.0, -0.05, 0.0], [1.0, 0.05, 0.0]],
        [6.0, 0.0, 15.0],
        [-0.05, 0.05],
    )
    bodies = [rolling_ball(), pair, rolling_ball(0.3, 8.0)]
    found = roll_bodies(BEAM, bodies, [law] * 4, positions=[0.0, 0.15, 0.26], **PATH | {"time_step": 5e-6})
    energy = found.energy
    assert all(len(losses) > 2 for losses in found.contact_loss)
    assert energy.residual < 1e-5
    # every term counts
    assert all(abs(share) > 1e-4 * energy.throughput for share in energy.shares.values())
    assert 0.0 < energy.contact_damping < energy.throughput


# --- cost --------------------------------------------------------------------------------------


@pytest.mark.filterwarnings("ignore::asperity.errors.LargeDeflectionWarning")
def test_evaluations_for_each_contact_do_not_grow_with_their_number():
    beam = Beam.rectangular(4.0, 0.05, 0.01, STEEL, highest_frequency=2e3)
    law = HertzLaw(2.4e10, rough(2e-8, 1e-5, 0.05, 400000))
    path = PATH | {"duration": 0.005, "settling": 0.0}
    each = []
    for count in (2, 8, 32):
        bodies, at = [rolling_ball()] * count, 0.1 * np.arange(count)
        run = roll_bodies(beam, bodies, [law] * count, positions=at, **path)
        each.append(run.evaluations / count / 500)
        assert run.unconverged_steps == 0
    assert each[2] < 1.3 * each[0] < 8.0


# --- laws that Python steps, interruption ------------------------------------------------------


class Stepped:
    """A law that Python steps, and that can be interrupted."""

    name, damping = "stepped", 0.0

    def __init__(self, law, fails_at=-1):
        self.law, self.fails_at = law, fails_at

    def prepare(self, positions):
        self.positions, self.accepted = positions, 0
        return self

    def evaluate(self, step, approach):
        if step == self.fails_at:
            raise KeyboardInterrupt
        at = [self.positions[step]]
        here, beyond = (force_of(self.law, at, approach + by)[0] for by in (0.0, 1e-12))
        return here, (beyond - here) / 1e-12

    def accept(self, step):
        self.accepted += 1

    def state(self):
        return {"accepted": np.array(self.accepted)}

    def restore(self, state):
        self.accepted = int(state["accepted"])

    def warn_of_flaws(self):
        warnings.warn("seen", UserWarning, stacklevel=2)


def test_laws_that_python_steps_stand_beside_compiled_ones():
    smooth, other = (HertzLaw(2.4e10, rough(2e-8, 1e-5, 0.29, 20000, seed)) for seed in (2, 3))
    path = PATH | {"duration": 0.002, "settling": 0.0}
    compiled = roll_bodies(BEAM, [rolling_ball()] * 2, [smooth, other], positions=[0.0, 0.05], **path)
    mixed = [smooth, Stepped(other)]
    with pytest.warns(UserWarning, match="seen"):
        found = roll_bodies(BEAM, [rolling_ball()] * 2, mixed, positions=[0.0, 0.05], **path)
    assert compiled.contact_force[1].std() > 0.1 * BALL.static_load
    same(found.contact_force, compiled.contact_force, 2e-5)
    assert mixed[1].accepted == 200


def test_the_direct_law_stands_beside_one_in_closed_form():
    """A smooth ball on a flat: the half-space solved in every step, and Hertz's law, under one carriage."""
    dx, n, radius, modulus = 5e-6, 41, 10e-3, 115e9
    x = (np.arange(n) - n // 2) * dx
    body, flat = (x[:, None] ** 2 + x**2) / (2 * radius), np.zeros((400, n))
    bump = -4e-8 * np.exp(-(((np.arange(400) - 130) / 15.0) ** 2))  # a dale
    direct = Direct(flat + bump[:, None], body, (dx, dx), modulus, start=0.0)
    hertz = HertzLaw(Hertz(modulus, radius, radius).stiffness_constant)
    run = roll_bodies(
        None, [carriage(0.2, 4.0, [-2e-4, 2e-4])], [direct, hertz], positions=[4e-4], speed=1.0, start=0.2e-3,
        duration=4e-4, time_step=4e-6,
    )  # fmt: skip
    assert run.unconverged_steps == 0
    np.testing.assert_allclose(run.contact_force[:, 0], 2.0, rtol=0.02)  # the grid is coarse
    assert run.contact_force[0].min() < 1.9  # in the dale
    approach = run.relative_displacement[1]
    np.testing.assert_allclose(run.contact_force[1], hertz.stiffness * approach**1.5, rtol=1e-6)


def records(run):
    return (
        run.contact_force, run.relative_displacement, run.over_displacement, run.rolling_displacement,
        run.acceleration, *run.degrees_of_freedom,
    )  # fmt: skip


def test_a_run_goes_on_where_it_was_bit_by_bit():
    law = HertzLaw(2.4e10, rough(2e-7, 1e-5, 0.29, 30000), damping=2.0)
    bodies, at = [rolling_ball(), carriage(0.8, 12.0, [-0.05, 0.05])], [0.0, 0.12]
    path = PATH | {"duration": 0.05, "sensors": [0.4]}
    whole = roll_bodies(BEAM, bodies, [law] * 3, positions=at, **path)
    shelf = Shelf()

    def stop(done, total, what):
        if done > 0.4 * total:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        roll_bodies(BEAM, bodies, [law] * 3, positions=at, progress=stop, checkpoint=shelf, **path)
    assert 0 < shelf.arrays["motion.counts"][0] < 5500
    resumed = roll_bodies(BEAM, bodies, [law] * 3, positions=at, checkpoint=shelf, **path)
    for found, expected in zip(records(resumed), records(whole), strict=True):
        np.testing.assert_array_equal(found, expected)
    assert resumed.energy == whole.energy
    assert resumed.contact_loss == whole.contact_loss


def test_a_stepped_law_goes_on_with_what_it_held():
    laws = [HertzLaw(2.4e10, rough(2e-8, 1e-5, 0.29, 20000, seed)) for seed in (2, 3)]
    path, at = PATH | {"duration": 0.001, "settling": 0.0}, [0.0, 0.05]
    bodies, shelf = [rolling_ball()] * 2, Shelf()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        whole = roll_bodies(BEAM, bodies, [laws[0], Stepped(laws[1])], positions=at, **path)
        with pytest.raises(KeyboardInterrupt):
            roll_bodies(BEAM, bodies, [laws[0], Stepped(laws[1], 57)], positions=at, checkpoint=shelf, **path)
        last = Stepped(laws[1])
        resumed = roll_bodies(BEAM, bodies, [laws[0], last], positions=at, checkpoint=shelf, **path)
    assert int(shelf.arrays["law.1.accepted"]) == last.accepted == 100
    np.testing.assert_array_equal(resumed.contact_force, whole.contact_force)


def test_steps_too_long_for_contacts_are_softened_and_stay_stable():
    """Four stiff contacts on one light carriage: together they are stiffer than each alone."""
    body = carriage(0.02, 4.0, 0.01 * np.arange(-1.5, 2.0))
    law = Linear(1.0, 2e8, 0.0, rough(1e-8, 1e-5, 0.25, 20000))
    with warnings.catch_warnings(record=True) as seen:
        warnings.simplefilter("always")
        found = roll_bodies(None, [body], [law] * 4, positions=[0.0], **PATH | {"time_step": 2e-5})
    told = [str(warning.message) for warning in seen if warning.category is CoarseSamplingWarning]
    assert sum("kept stable by softening" in message for message in told) == 1
    swing = np.abs(found.contact_force - 1.0)
    assert swing[:, -300:].max() < 3.0 * swing[:, :300].max()
