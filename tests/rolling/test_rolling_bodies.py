"""Bodies on any number of contacts: closed forms, integrators, energy, laws from Python, interruption."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from asperity import Beam, ModalStructure, material
from asperity.errors import InputError
from asperity.kernels.pointforce import evaluate_all
from asperity.laws import HertzLaw, Linear, Printed
from asperity.laws.layout import force
from asperity.reduction.stiffness import ForceCurve
from asperity.reduction.texture import StateTexture
from asperity.rolling import stepper, steps
from asperity.rolling.roll import roll_bodies
from asperity.structures.body import Body, carriage, chain
from one_contact import Shelf, Stepped, first_contact, rigid_bar, rough, same

STEEL = material("steel")
BEAM = Beam.rectangular(1.0, 0.05, 0.01, STEEL, highest_frequency=5e3)
PATH = {"speed": 1.0, "start": 0.3, "duration": 0.02, "time_step": 1e-5, "settling": 0.005}
MASS, LOAD, CONTACT = 0.5, 5.0, 2e7
BALL = Body.rigid(MASS, LOAD)
OMEGA, DRIVEN = np.sqrt(CONTACT / MASS), 2 * np.pi * 350.0


def waves(amplitude, length, start, end, points=200):
    """A sine along the path; the spline through it is exact to (2π/points)⁴/384."""
    spacing = length / points
    x = start + spacing * np.arange(int((end - start) / spacing) + 2)
    return StateTexture.unfiltered(amplitude * np.sin(2 * np.pi * x / length), spacing, start)


def rolled(over, law, body=BALL, **path):
    path = {"speed": 1.0, "start": 0.0, "positions": [0.0]} | path
    return first_contact(roll_bodies(over, [body], [law], **path))


@pytest.mark.filterwarnings("ignore::asperity.errors.CoarseSamplingWarning")
def test_a_mass_over_waves_of_rigid_ground_is_the_closed_form_to_second_order():
    """m z'' = −k (z − h), h = a sin Ωt downwards, from rest: Duhamel's integral."""
    law = Linear(LOAD, CONTACT, texture=waves(1e-8, 2 * np.pi / DRIVEN, 0.0, 0.03))
    errors = []
    for h in (2e-5, 1e-5, 5e-6):
        run = rolled(None, law, duration=0.02, time_step=h)
        z = run.rolling_displacement - run.rolling_displacement[0]
        scale = 1e-8 * OMEGA**2 / (OMEGA**2 - DRIVEN**2)
        closed = scale * (np.sin(DRIVEN * run.time) - DRIVEN / OMEGA * np.sin(OMEGA * run.time))
        errors.append(np.abs(z - closed).max() / np.abs(closed).max())
    assert errors[-1] < 2e-3
    assert_allclose([errors[0] / errors[1], errors[1] / errors[2]], 4.0, atol=0.2)


FOUNDATION = ModalStructure([-10.0, 1e3], [], [], np.zeros((2, 0)), residual_flexibility=np.full(2, 1 / 3e6))
OSCILLATOR = ModalStructure(
    [-10.0, 1e3], [np.sqrt(4e6 / 2.0) / (2 * np.pi)], 450.0 / np.sqrt(4e6 * 2.0), np.ones((2, 1)), [2.0]
)


@pytest.mark.filterwarnings("ignore::asperity.errors.CoarseSamplingWarning")
@pytest.mark.parametrize(
    ("over", "receptance"),
    [(FOUNDATION, 1 / 3e6), (OSCILLATOR, 1 / (4e6 - 2.0 * DRIVEN**2 + 900j * DRIVEN))],
    ids=["elastic foundation", "oscillator"],
)
def test_steady_waves_give_the_force_of_the_receptances(over, receptance):
    """F = −h / (α of the ball + α of the contact + α of what is rolled over); damping ends the start."""
    damping, a, h = 2000.0, 1e-8, 2 * np.pi / DRIVEN / 400
    law = Linear(LOAD, CONTACT, texture=waves(-a, 2 * np.pi / DRIVEN, 0.0, 0.5), damping=damping)
    run = rolled(over, law, duration=0.4, time_step=h, sensors=[0.2])
    t, force = run.time[-16000:], run.contact_force[-16000:] - LOAD  # forty periods
    contact = 1 / (CONTACT + 1j * DRIVEN * damping)
    spring = CONTACT * contact  # the texture works on the spring alone
    expected = a * spring / (receptance + contact - 1 / (MASS * DRIVEN**2))
    assert 2.0 * np.mean(force * np.exp(-1j * DRIVEN * t)) * 1j == pytest.approx(expected, rel=1e-3)
    moved = 2.0 * np.mean(run.acceleration[0, -16000:] * np.exp(-1j * DRIVEN * t)) * 1j
    assert over is FOUNDATION or moved == pytest.approx(-(DRIVEN**2) * receptance * expected, rel=1e-3)


def pitching(mass, load, places):
    """A rigid body that heaves and pitches, with its mass as far out as its contacts."""
    places = np.asarray(places, float)
    return rigid_bar(mass, mass * np.mean(places**2), places, load)


def test_a_coordinate_too_fast_for_the_step_follows_at_rest():
    """A wheel whose rim sits on a spring of 200 kHz is a wheel with a softer contact, at steps of 10 µs."""
    stiff, light, mass = 6e10, 0.04, 0.46
    rim = chain([light, mass], [stiff], [0.0])
    between = (mass / (mass + light)) ** 2 / stiff  # static compliance of its mode at the rim
    load, texture = float(rim.pressing.sum()), waves(3e-8, 4e-4, 0.28, 0.4)
    hard, soft = (Linear(load, k, 0.0, texture, damping=300.0) for k in (5e8, 1 / (1 / 5e8 + between)))
    expected = roll_bodies(None, [Body.rigid(mass + light, load)], [soft], positions=[0.0], **PATH)
    assert expected.contact_force.std() > 1.0
    found = roll_bodies(None, [rim], [hard], positions=[0.0], **PATH)
    same(found.contact_force, expected.contact_force, 0.01)


def test_the_energy_of_four_contacts_closes_contact_losses_included():
    law = HertzLaw(2.4e10, rough(3e-7, 1e-5, 0.1, 60000), damping=3.0)
    stretch = np.array([[1.0, 0.0, -1.0]])  # between the pair of balls and the mass above it
    pair = Body(
        np.diag([0.6, 0.002, 1.5]), 8.0 * stretch.T @ stretch, 3e5 * stretch.T @ stretch,
        np.array([[1.0, -0.05, 0.0], [1.0, 0.05, 0.0]]), np.array([6.0, 0.0, 15.0]), np.array([-0.05, 0.05]),
    )  # fmt: skip
    bodies = [Body.rigid(0.5, 5.0), pair, Body.rigid(0.3, 8.0)]
    found = roll_bodies(BEAM, bodies, [law] * 4, positions=[0.0, 0.15, 0.26], **PATH | {"time_step": 5e-6})
    energy = found.energy
    assert all(len(starts) > 2 for starts, _ in found.flights)
    assert energy.residual < 1e-5
    # every term counts
    assert all(abs(share) > 1e-4 * energy.throughput for share in energy.shares.values())
    assert 0.0 < energy.contact_damping < energy.throughput


@pytest.mark.filterwarnings("ignore::asperity.errors.LargeDeflectionWarning")
def test_evaluations_for_each_contact_do_not_grow_with_their_number():
    beam = Beam.rectangular(4.0, 0.05, 0.01, STEEL, highest_frequency=2e3)
    law = HertzLaw(2.4e10, rough(2e-8, 1e-5, 0.05, 400000))
    path, each = PATH | {"duration": 0.005, "settling": 0.0}, []
    for count in (2, 32):
        run = roll_bodies(beam, [BALL] * count, [law] * count, positions=0.1 * np.arange(count), **path)
        each.append(run.evaluations / count / 500)
        assert run.unconverged_steps == 0
    # one finds a force, and how it answers to the others
    assert each[1] < 1.1 * each[0] < 1.2


@pytest.mark.parametrize("damping", [0.0, 200.0])
@pytest.mark.parametrize("kinks", [0.0, 0.3])
def test_forces_that_were_found_together_meet_their_laws_beside_kinks_too(kinks, damping):
    """Textures rise and fall by a share of the approach from state to state, and some are passed."""
    line = np.random.default_rng(3).normal(size=400) * 2e-9
    states = np.linspace(0.25e-6, 0.45e-6, 8001)
    zigzag = kinks * np.diff(states[:2]) * (np.arange(states.size) % 2)
    texture = StateTexture.unfiltered(line, 1e-3, 0.1)
    if kinks:
        texture = StateTexture(line + zigzag[:, None], states, 0.1, 1e-3)
    law = HertzLaw(2.4e10, texture, damping=damping)
    path = PATH | {"start": 0.11, "speed": 10.0, "duration": 0.005, "settling": 0.0}
    ball = Body.rigid(0.02, LOAD)
    run = roll_bodies(BEAM, [ball] * 4, [law] * 4, positions=0.05 * np.arange(4), **path)
    for place, found, approach in zip(
        run.positions, run.contact_force, run.relative_displacement, strict=True
    ):
        before, now, ahead = (approach[i : i + 499] for i in range(3))
        rate = (1.5 * ahead - 2.0 * now + 0.5 * before) / run.time[1]
        expected = force(law, place, approach)[2:] + damping * rate
        assert_allclose(found[2:], expected, rtol=0.0, atol=3e-10 * LOAD)
    assert (run.energy.contact_damping > 1e-9 * run.energy.throughput) == (damping > 0.0)
    assert abs(run.energy.contact_damping) < (1e-12 + damping) * run.energy.throughput


def test_a_force_that_changes_evenly_is_expected_to_its_tolerance():
    """Fourth differences of a wave of 3000 steps are 2e-11 of it, second ones 4e-6."""
    law = HertzLaw(2.4e10, waves(1e-6, 0.03, 0.0, 0.2), damping=2e3)
    run = rolled(None, law, start=0.03, duration=0.1, settling=0.01, time_step=1e-5)
    assert np.ptp(run.contact_force) > 1e-3 * LOAD
    assert run.evaluations < 1.1 * 11000


@pytest.mark.filterwarnings("ignore::asperity.errors.CoarseSamplingWarning")
def test_a_force_that_no_other_changes_is_that_of_its_law_at_once():
    """Of a light ball that bounces, of whose force guesses are far off."""
    law = HertzLaw(2.4e10, rough(1e-6, 1e-5, 0.05, 40000))
    run = rolled(None, law, Body.rigid(5e-3, LOAD), start=0.06, duration=0.02, time_step=1e-5)
    expected = force(law, run.positions, run.relative_displacement)
    assert np.ptp(expected) > LOAD
    assert_allclose(run.contact_force, expected, rtol=1e-9, atol=1e-9 * LOAD)


class Interrupted(Stepped):
    def evaluate(self, step, approach):
        if step == 57:
            raise KeyboardInterrupt
        return super().evaluate(step, approach)


def test_laws_that_python_steps_stand_beside_compiled_ones_and_go_on_amid_a_step():
    laws = [HertzLaw(2.4e10, rough(2e-8, 1e-5, 0.29, 20000, seed), 2.0) for seed in (2, 3, 4)]
    bodies = [BALL, pitching(0.8, 12.0, [-0.05, 0.05])]
    path = PATH | {"duration": 0.001, "settling": 0.0, "positions": [0.0, 0.12], "sensors": [0.4]}
    whole, resumed, shelf = Stepped(laws[2]), Stepped(laws[2]), Shelf()
    expected, found = (roll_bodies(BEAM, bodies, [*laws[:2], law], **path) for law in (laws[2], whole))
    assert expected.contact_force[2].std() > 0.1 * LOAD
    same(found.contact_force, expected.contact_force, 2e-5)
    assert (whole.accepted, whole.warned) == (100, 1)
    with pytest.raises(KeyboardInterrupt):
        roll_bodies(BEAM, bodies, [*laws[:2], Interrupted(laws[2])], checkpoint=shelf, **path)
    again = roll_bodies(BEAM, bodies, [*laws[:2], resumed], checkpoint=shelf, **path)
    assert int(shelf.arrays["law.2.accepted"]) == resumed.accepted == 100
    for name in ("contact_force", "relative_displacement", "over_displacement", "acceleration"):
        assert_array_equal(getattr(again, name), getattr(found, name))
    assert_array_equal(again.degrees_of_freedom[1], found.degrees_of_freedom[1])
    assert again.energy == found.energy
    assert_array_equal(again.in_contact, found.in_contact)


@pytest.mark.parametrize("rate", [1e-3, 0.1, 1.0, 50.0, 1e4])
def test_what_a_damper_takes_in_a_step_is_exact_however_stiff_it_is(rate):
    """Of two masses that move apart, nothing else on them: m v²/2 (1 - exp(-2 rate)), m the reduced mass."""
    h, v, (below, above) = 2e-5, np.array([3e-3, -1e-3]), (0.5, 2.0)
    reduced = below * above / (below + above)
    pair = chain([below, above], [1e-6], [rate / h * reduced])
    taken = steps.taken_by_dampers(pair, h)[1, :, 1]
    expected = 0.5 * reduced * 16e-6 * -np.expm1(-2.0 * rate)
    assert v @ taken @ v == pytest.approx(expected, rel=1e-9)
    assert steps.stiff_dampers(pair, h) is (rate > 0.1)


def energy_of_a_bogie(damper):
    """Ledger of a bogie on dampers of a constant, N s/m."""
    bogie = carriage(1.0, 2e-3, [0.0, 0.1], 0.5, 2e4, damper, load=20.0)
    law = Linear(20.0, CONTACT, texture=rough(1e-7, 1e-4, 0.1, 4000))
    return roll_bodies(BEAM, [bogie], [law] * 2, positions=[0.0], **PATH | {"time_step": 2e-5}).energy


@pytest.mark.parametrize("damper", [10.0, 1e4, 1e6, 1e9, 1e12])
def test_the_energy_of_a_bogie_closes_with_dampers_of_any_stiffness(damper):
    """Their rates die away within a step, where the powers at both ends are far too much."""
    energy = energy_of_a_bogie(damper)
    assert energy.residual < 1e-5
    if damper < 1e12:  # there rounding is more
        assert energy.shares["damping of the bodies"] > 0.0


def test_stiff_dampers_take_the_less_the_stiffer_they_are():
    """What they hold together gives the force on them: they take its square over their constant."""
    stiff, stiffer, stiffest = (
        energy_of_a_bogie(c).shares["damping of the bodies"] for c in (1e6, 1e8, 1e12)
    )
    assert stiffer == pytest.approx(0.01 * stiff, rel=0.02)
    assert abs(stiffest) < 0.01 * stiff


def test_what_a_law_says_of_a_run_is_said_of_all_its_pieces():
    """As of one laid out on all the way: where surfaces touch, and the damper pulls in flight; how close."""
    law = Printed(ForceCurve.hertz(2e10), rough(1e-5, 1e-4, -0.01), 4e-6, damping=5.0)
    path = {"speed": 1.0, "start": 0.05, "duration": 0.05, "time_step": 5e-6, "positions": [0.0]}
    run = roll_bodies(None, [Body.rigid(0.02, 0.4)], [law], **path)
    assert run.contact_force.shape[1] > 2 * stepper.LONGEST
    approach = run.relative_displacement[0] - run.softening[0] * run.contact_force[0]
    elastic = evaluate_all(law.prepare(run.positions[0]), approach, 0)[0]
    assert_array_equal(run.in_contact[0], elastic > 0.0)
    assert 0.05 < run.in_contact.mean() < 0.95
    assert_array_equal(run.visited, [[approach.min(), approach.max()]])
    assert approach.argmin() < 2 * stepper.LONGEST  # not in the last piece


def test_a_way_that_a_law_does_not_know_is_refused_before_anything_rolls():
    law = HertzLaw(1e9, rough(1e-7, 1e-4, 0.0, points=500))
    told = []
    with pytest.raises(InputError, match="Shorten the duration or provide a longer texture"):
        roll_bodies(
            None, [BALL], [law], positions=[0.0], speed=1.0, start=0.01, duration=0.1, time_step=5e-6,
            progress=lambda *done: told.append(done),
        )  # fmt: skip
    assert not told


@pytest.mark.filterwarnings("ignore::asperity.errors.CoarseSamplingWarning")
def test_approaches_of_a_law_are_without_what_a_softened_contact_yields():
    law = HertzLaw(2e11, rough(1e-7, 1e-4, -0.01))
    path = {"speed": 1.0, "start": 0.05, "duration": 0.01, "time_step": 2e-5, "positions": [0.0]}
    run = roll_bodies(None, [Body.rigid(0.02, 5.0)], [law], **path)
    yielded = run.softening[0] * run.contact_force[0]
    assert yielded.max() > 0.05 * np.ptp(run.relative_displacement)
    seen = run.relative_displacement[0] - yielded
    assert_allclose(run.visited, [[seen.min(), seen.max()]], rtol=1e-12)
