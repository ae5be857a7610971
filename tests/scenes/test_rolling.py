"""A ball rolls over a beam: moving loads, moving mass, bumps, energy, interruption, bad input."""

import warnings
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from asperity import Beam, material
from asperity.errors import ComputationError, InputError
from asperity.laws import HertzLaw, Linear, Printed, Shifted
from asperity.reduction.stiffness import ForceCurve
from asperity.reduction.texture import StateTexture
from asperity.rolling.roll import RolledBodies
from asperity.structures.body import GRAVITY, Body
from one_contact import Shelf, Stepped, roll_ball
from refusals import refusals

STEEL = material("steel")
MASS = 4.0 / 3.0 * np.pi * 0.025**3 * STEEL.density
LOAD = GRAVITY * MASS
BALL = Body.rigid(MASS, LOAD)
K = 2.4e10
HERTZ = ForceCurve.hertz(K)
WORKING = float(HERTZ.inverse(LOAD))
BEAM = Beam.rectangular(1.0, 0.05, 0.01, STEEL, highest_frequency=5e3)
ROUGH = {"speed": 1.0, "start": 0.3, "duration": 0.02, "time_step": 1e-5, "sensors": [0.35, 0.5]}


def rolled(law, beam=BEAM, **changes):
    return roll_ball(beam, BALL, law, **ROUGH | changes)


def rough_texture(rms, seed=3, shortest=2e-4, spacing=1e-5, points=4000, start=0.29):
    """A band-limited random texture."""
    rng = np.random.default_rng(seed)
    spectrum = np.fft.rfft(rng.standard_normal(points))
    wavenumber = np.fft.rfftfreq(points, spacing)
    spectrum[(wavenumber > 1 / shortest) | (wavenumber == 0)] = 0.0
    heights = np.fft.irfft(spectrum, points)
    return StateTexture.unfiltered(rms * heights / heights.std(), spacing, start)


# --- moving force and moving mass -------------------------------------------------------------


def moving_mass(beam, speed, times):
    """Deflection under a mass that keeps touching a simply supported beam; total derivatives.

    m d2/dt2 w(vt, t) = m (w_tt + 2 v w_xt + v^2 w_xx) = load - force, in the beam's own sines.
    """
    n = np.arange(1, len(beam.natural_frequencies) + 1)
    k = n * np.pi / beam.length
    scale = np.sqrt(2.0 / beam.mass)
    omega = k**2 * np.sqrt(beam.bending_stiffness / beam.mass_per_length)

    def right(t, y):
        q, v = np.split(y, 2)
        shape, slope = scale * np.sin(k * speed * t), scale * k * np.cos(k * speed * t)
        inertia = np.eye(n.size) + MASS * np.outer(shape, shape)
        coriolis, centripetal = 2 * speed * slope @ v, speed**2 * (-(k**2) * shape) @ q
        load = shape * (LOAD - MASS * (coriolis + centripetal))
        restoring = 2 * beam.damping_ratios * omega * v + omega**2 * q
        return np.concatenate([v, np.linalg.solve(inertia, load - restoring)])

    rest = np.zeros(2 * n.size)
    solution = solve_ivp(right, (0.0, times[-1]), rest, method="DOP853", rtol=1e-9, atol=1e-13, t_eval=times)
    return np.sum(scale * np.sin(np.outer(speed * times, k)) * solution.y[: n.size].T, axis=1)


def test_stiff_contact_converges_to_the_moving_mass():
    beam = Beam.rectangular(1.0, 0.05, 0.01, STEEL, highest_frequency=1.5e3)
    path = {"speed": 20.0, "start": 0.0, "duration": 0.05, "time_step": 5e-6, "sensors": []}
    runs = [rolled(HertzLaw(stiffness), beam, **path) for stiffness in (1e10, 1e11, 1e12)]
    reference = moving_mass(beam, 20.0, runs[0].time[::100])
    errors = [np.abs(run.over_displacement[::100] - reference).max() / reference.max() for run in runs]
    # the compression of a Hertzian contact shrinks with K^(-2/3)
    assert_allclose(np.log10(np.array(errors[:-1]) / errors[1:]), 2 / 3, atol=0.1)
    assert errors[-1] < 1e-4


# --- texture ----------------------------------------------------------------------------------


def test_ball_leaves_a_step_on_a_parabola():
    drop, x = 20e-6, np.arange(0.29, 0.35, 1e-5)
    texture = StateTexture.unfiltered(0.5 * drop * (1 + np.tanh((x - 0.305) / 2e-5)), 1e-5, 0.29)
    run = rolled(HertzLaw(K, texture), duration=0.008)
    start, duration = (each[0] for each in run.flights)
    assert_allclose(start, 0.005, atol=1e-4)
    flying = (run.time >= start) & (run.time < start + duration)
    assert flying.sum() > 50
    # half a step is needed to lose the force that stood at the last touch
    fall = np.diff(run.rolling_displacement[flying][1:], 2) / 1e-10
    assert_allclose(fall, LOAD / MASS, rtol=1e-4)
    assert run.contact_force.min() == 0.0


def test_flights_are_found():
    in_contact = np.array([[0, 0, 1, 1, 0, 1, 0, 0, 0], np.ones(9)], dtype=bool)
    record = SimpleNamespace(time=0.5 * np.arange(9), in_contact=in_contact)
    (starts, durations), (never, _) = RolledBodies.flights.fget(record)
    assert (starts.tolist(), durations.tolist()) == ([0.0, 2.0, 3.0], [1.0, 0.5, 1.5])
    assert not len(never)


def test_a_linear_contact_pulls_and_is_never_lost_and_printed_flies_though_its_damper_acts():
    texture = rough_texture(1e-6)
    run = rolled(Linear(LOAD, 2e7, 0.0, texture))
    assert run.contact_force.min() < 0.0
    assert not len(run.flights[0])
    run = rolled(Printed(HERTZ, texture, datum=0.0, damping=20.0))
    assert 0.0 < run.in_contact.mean() < 1.0
    assert np.all(run.contact_force[~run.in_contact][1:] != 0.0)


# --- numerics ---------------------------------------------------------------------------------


@pytest.mark.parametrize("support", ["simply-supported", "free", "clamped"])
def test_energy_balance_closes_and_the_better_the_finer(support):
    beam = replace(BEAM, support=support)
    law = Shifted(HERTZ, rough_texture(0.2e-6, shortest=5e-4), damping=30.0)
    coarse, fine = (rolled(law, beam, time_step=h).energy for h in (1e-5, 2.5e-6))
    assert fine.residual < coarse.residual / 8 < 1e-3 / 8
    load, *others = coarse.shares.values()
    assert_allclose(load, sum(others), atol=1.01 * coarse.residual * coarse.throughput)
    assert coarse.shares["damping of the structure"] > 0.0
    assert replace(coarse, throughput=0.0).residual == 0.0  # of nothing


def test_a_checkpoint_of_another_run_is_refused():
    shelf = Shelf()
    run, again = (rolled(HertzLaw(K), checkpoint=shelf) for _ in range(2))
    assert np.array_equal(run.contact_force, again.contact_force)
    with pytest.raises(InputError, match=r"checkpoint.*roll anew"):
        rolled(HertzLaw(K), sensors=[0.5], checkpoint=shelf)


def test_smooth_rolling_starts_at_rest_carries_the_load_and_warns_of_nothing():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        run = rolled(HertzLaw(K), highest_frequency=5000.0)
    assert_allclose(run.contact_force[0], LOAD, rtol=1e-9)
    assert_allclose(run.relative_displacement[0], WORKING, rtol=1e-8)
    assert_allclose(run.contact_force.mean(), LOAD, rtol=0.02)
    deflection = BEAM.receptance(0.0, 0.3, 0.3).real * LOAD
    assert_allclose(run.over_displacement[0], deflection, rtol=1e-10)
    assert_allclose(np.diff(run.time), 1e-5)


def forced_part_apart(**path):
    """How far the beam is from the forced part of Frýba's series, each mode with its damping.

    Relative to its largest deflection, in squares of the first mode's k v/ω.
    """
    beam, speed = replace(BEAM, highest_frequency=1e3), 1.0
    found = rolled(HertzLaw(K), beam, duration=0.1, time_step=5e-5, sensors=[], **path)
    omega = 2.0 * np.pi * beam.natural_frequencies
    k = np.pi / beam.length * np.arange(1, len(omega) + 1)
    damped = omega**2 - (k * speed) ** 2 + 1j * beam.loss_factor * omega * k * speed
    waves = np.outer(found.position, k)
    answer = np.sin(waves) * (np.exp(1j * waves) / damped).imag
    forced = 2.0 * LOAD / beam.mass * np.sum(answer, axis=1)
    first = k[0] * speed / omega[0]
    return np.abs(found.over_displacement - forced).max() / (first**2 * np.abs(forced).max())


@pytest.mark.parametrize("path", [{}, {"start": 0.05, "settling": 0.05}])
def test_a_start_on_the_beam_and_a_run_in_from_its_support_do_not_ring(path):
    assert forced_part_apart(**path) < 2.0  # after a start from rest: the inverse of k v/ω, 47


def test_without_a_run_in_a_ball_on_the_support_comes_onto_a_beam_at_rest():
    assert forced_part_apart(start=0.0) > 20.0


def test_a_record_after_a_run_in_is_the_end_of_a_longer_run():
    law = HertzLaw(K, rough_texture(0.05e-6))
    whole, late = rolled(law), rolled(law, start=0.305, duration=0.015, settling=0.005)
    assert late.time[0] == 0.0
    assert_allclose(late.position[0], 0.305)
    assert len(late.time) == len(late.position) == len(whole.time) - 500
    for name in ("contact_force", "relative_displacement", "rolling_displacement", "acceleration"):
        assert_allclose(getattr(late, name), getattr(whole, name)[..., 500:], rtol=1e-7, atol=1e-9)
    assert_allclose(*(run.energy.shares["work of the loads"] for run in (late, whole)), rtol=1e-9)


# --- bad input and doubtful physics -----------------------------------------------------------


test_bad_paths_are_refused = refusals(
    ({"speed": 0.0}, r"speed \(m/s\)"),
    ({"duration": np.nan}, r"duration \(s\)"),
    ({"time_step": np.inf}, r"time step \(s\)"),
    ({"settling": -0.1}, r"settling \(s\)"),
    ({"duration": 1e-6}, "at least one time step"),
    ({"duration": 0.8}, r"path of contact 1 .*received 0.3 to 1.1; allowed: 0 to 1, on the structure"),
    ({"settling": 0.4}, "path .* -0.1 to"),
    ({"start": -0.1}, "Choose start, duration, run-in"),
    ({"sensors": [1.2]}, "positions on the beam"),
    ({"duration": 0.1}, "longer texture"),
    of=lambda change: rolled(HertzLaw(K, rough_texture(1e-7)), **change),
)


class Broken(Stepped):
    """A law whose force is no number in the seventh step."""

    def evaluate(self, step, approach):
        return (np.nan, 0.0) if step == 7 else super().evaluate(step, approach)


def test_forces_that_are_none_are_told_with_their_place():
    shelf = Shelf()
    with pytest.raises(ComputationError, match=r"step 7, time 7e-05 s, position 0.30007 m.*smaller"):
        rolled(Broken(HertzLaw(K)), checkpoint=shelf)
    assert shelf.arrays is None
