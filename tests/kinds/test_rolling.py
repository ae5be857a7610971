"""A ball rolls over a beam: moving loads, moving mass, bumps, energy, interruption, bad input."""

import itertools
import warnings
from dataclasses import dataclass, replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import cumulative_trapezoid, solve_ivp

from asperity.errors import (
    CoarseSamplingWarning,
    ComputationError,
    ExtrapolationWarning,
    InputError,
    Outcome,
    UnconvergedWarning,
)
from asperity.laws import Areal, HertzLaw, Linear, Printed, Shifted, Table
from asperity.reduction.stiffness import ForceCurve
from asperity.reduction.table import ForceTable
from asperity.reduction.texture import StateTexture
from asperity.reference.materials import material
from asperity.rolling.outcome import contact_losses
from asperity.rolling.roll import roll_bodies
from asperity.structures.beam import Beam
from asperity.structures.body import Ball, Body
from one_contact import roll_ball

STEEL = material("steel")
BALL = Ball(0.025, STEEL)
K = 2.4e10
HERTZ = ForceCurve.hertz(K)
WORKING = float(HERTZ.inverse(BALL.static_load))
BEAM = Beam.rectangular(1.0, 0.05, 0.01, STEEL, highest_frequency=5e3)
ROUGH = {"speed": 1.0, "start": 0.3, "duration": 0.02, "time_step": 1e-5, "sensors": [0.35, 0.5]}


def rough_texture(rms, seed=3, shortest=2e-4, spacing=1e-5, points=4000, start=0.29):
    """A band-limited random texture."""
    rng = np.random.default_rng(seed)
    spectrum = np.fft.rfft(rng.standard_normal(points))
    wavenumber = np.fft.rfftfreq(points, spacing)
    spectrum[(wavenumber > 1 / shortest) | (wavenumber == 0)] = 0.0
    heights = np.fft.irfft(spectrum, points)
    return StateTexture.unfiltered(rms * heights / heights.std(), spacing, start)


# --- moving force and moving mass -------------------------------------------------------------


def fryba(beam, force, speed, t, x, terms):
    """Deflection under a moving constant force: Fryba, Vibration of Solids and Structures, Eq. 1.41."""
    length = beam.length
    first = (np.pi / length) ** 2 * np.sqrt(beam.bending_stiffness / beam.mass_per_length)
    alpha, drive = speed * np.pi / length / first, np.pi * speed / length
    total = np.zeros_like(t)
    for n in range(1, terms + 1):
        bracket = np.sin(n * drive * t) - alpha / n * np.sin(n**2 * first * t)
        total += np.sin(n * np.pi * x / length) * bracket / (n**2 * (n**2 - alpha**2))
    return 2 * force * length**3 / (np.pi**4 * beam.bending_stiffness) * total


def moving_force(alpha, time_step, sensors=(0.5,)):
    """Roll a soft linear spring, so that the force stays what it is: a moving constant force."""
    beam = replace(BEAM, loss_factor=0.0)
    critical = np.pi / beam.length * np.sqrt(beam.bending_stiffness / beam.mass_per_length)
    speed = alpha * critical
    law = Linear(BALL.static_load, stiffness=1e-3)
    run = roll_ball(
        beam, BALL, law, speed=speed, start=0.0, duration=1 / speed, time_step=time_step, sensors=sensors
    )
    assert_allclose(run.contact_force, BALL.static_load, rtol=1e-6)
    return beam, speed, run


@pytest.mark.parametrize(("alpha", "printed"), [(0.1, 1.0965), (0.25, 1.2576), (0.5, 1.7054), (0.75, 1.7016)])
def test_moving_force_reaches_fryba_s_amplification(alpha, printed):
    beam, _, run = moving_force(alpha, 2e-5)
    # the deflection of mid-span, twice integrated from the accelerometer there, from rest
    velocity = cumulative_trapezoid(run.acceleration[0], run.time, initial=0.0)
    deflection = cumulative_trapezoid(velocity, run.time, initial=0.0)
    static = BALL.static_load * beam.length**3 / (48 * beam.bending_stiffness)
    assert_allclose(deflection.max() / static, printed, rtol=1e-3)


def test_deflection_under_a_moving_force_is_fryba_s_series():
    errors = []
    for time_step in (4e-5, 2e-5):
        beam, speed, run = moving_force(0.5, time_step)
        series = np.array(
            [
                fryba(beam, BALL.static_load, speed, np.array([t]), x, len(beam.natural_frequencies))[0]
                for t, x in zip(run.time[::25], run.position[::25], strict=True)
            ]
        )
        errors.append(np.abs(run.over_displacement[::25] - series).max() / series.max())
    assert errors[1] < 1e-4
    assert 1.8 < np.log2(errors[0] / errors[1]) < 2.2


def moving_mass(beam, ball, speed, times):
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
        inertia = np.eye(n.size) + ball.mass * np.outer(shape, shape)
        coriolis, centripetal = 2 * speed * slope @ v, speed**2 * (-(k**2) * shape) @ q
        load = shape * (ball.static_load - ball.mass * (coriolis + centripetal))
        restoring = 2 * beam.damping_ratios * omega * v + omega**2 * q
        return np.concatenate([v, np.linalg.solve(inertia, load - restoring)])

    start = np.zeros(2 * n.size)
    solution = solve_ivp(
        right, (0.0, times[-1]), start, method="DOP853", rtol=1e-10, atol=1e-14, t_eval=times
    )
    return np.sum(scale * np.sin(np.outer(speed * times, k)) * solution.y[: n.size].T, axis=1)


def test_stiff_contact_converges_to_the_moving_mass():
    beam = Beam.rectangular(1.0, 0.05, 0.01, STEEL, highest_frequency=1.5e3)
    speed, errors = 20.0, []
    for stiffness in (1e10, 1e11, 1e12):
        run = roll_ball(
            beam, BALL, HertzLaw(stiffness), speed=speed, start=0.0, duration=0.05, time_step=5e-6, sensors=[]
        )
        reference = moving_mass(beam, BALL, speed, run.time[::100])
        errors.append(np.abs(run.over_displacement[::100] - reference).max() / reference.max())
    # the compression of a Hertzian contact shrinks with K^(-2/3)
    assert_allclose(np.log10(np.array(errors[:-1]) / errors[1:]), 2 / 3, atol=0.1)
    assert errors[-1] < 1e-4


# --- texture ----------------------------------------------------------------------------------


BUMP = 2e-9  # m, small against the approach


def bump_texture():
    x = np.arange(0.29, 0.34, 1e-5)
    inside = np.abs(x - 0.315) < 0.01
    bump = np.where(inside, 0.5 * BUMP * (1 + np.cos(np.pi * (x - 0.315) / 0.01)), 0.0)
    return -bump, x[1] - x[0]  # a peak is negative away from contact


def bump_law(name):
    line, spacing = bump_texture()
    texture = StateTexture.unfiltered(line, spacing, 0.29)
    if name == "printed":
        return Printed(HERTZ, texture, datum=0.0)
    if name == "table":
        approaches = WORKING + np.linspace(-0.2e-6, 0.2e-6, 9)
        return Table(ForceTable(HERTZ.force(approaches[:, None] - line), approaches, 0.29, spacing))
    return {"shifted": Shifted, "areal": Areal}[name](HERTZ, texture)


@pytest.mark.parametrize(
    ("name", "followed"), [("shifted", 1.0), ("areal", 1.0), ("table", 1.0), ("printed", 2 / 3)]
)
def test_body_follows_a_slow_bump(name, followed):
    stiff = Beam(1.0, bending_stiffness=1e6, mass_per_length=100.0, highest_frequency=5e3)
    run = roll_ball(
        stiff, BALL, bump_law(name), speed=0.05, start=0.3, duration=0.4, time_step=5e-5, sensors=[]
    )
    rise = run.relative_displacement[0] - run.relative_displacement.min()
    assert_allclose(rise / BUMP, followed, rtol=0.01)
    assert_allclose(run.position[run.relative_displacement.argmin()], 0.315, atol=2e-4)


def test_linear_contact_answers_a_sine_as_its_receptances_say():
    # beam so stiff and heavy that it stays put: F = -h k/(1 - (k + i w c)/(m w^2))
    beam = Beam(1.0, 1e9, 1e5, highest_frequency=1e3)
    stiffness, damping, frequency, height = 2e7, 400.0, 700.0, 1e-8
    x = np.arange(0.19, 0.5, 2e-5)
    texture = StateTexture.unfiltered(height * np.sin(2 * np.pi * frequency * (x - 0.2)), 2e-5, 0.19)
    law = Linear(BALL.static_load, stiffness, 0.0, texture, damping)
    run = roll_ball(beam, BALL, law, speed=1.0, start=0.2, duration=0.2, time_step=1e-5, sensors=[])
    tail = run.time >= 0.1 - 1e-9
    phase = np.exp(-2j * np.pi * frequency * run.time[tail])[:-1]
    amplitude = 2 * np.mean((run.contact_force[tail][:-1] - BALL.static_load) * phase) * 1j
    omega = 2 * np.pi * frequency
    dynamic = 1 - (stiffness + 1j * omega * damping) / (BALL.mass * omega**2)
    assert_allclose(amplitude, -height * stiffness / dynamic, rtol=2e-3)


def test_ball_leaves_a_step_on_a_parabola():
    drop = 20e-6
    x = np.arange(0.29, 0.35, 1e-5)
    texture = StateTexture.unfiltered(0.5 * drop * (1 + np.tanh((x - 0.305) / 2e-5)), 1e-5, 0.29)
    run = roll_ball(BEAM, BALL, HertzLaw(K, texture), **ROUGH | {"duration": 0.008})
    first = run.contact_loss[0]
    assert_allclose(first.start, 0.005, atol=1e-4)
    flying = (run.time >= first.start) & (run.time < first.start + first.duration)
    assert flying.sum() > 50
    # half a step is needed to lose the force that stood at the last touch
    t, z = run.time[flying][1:], run.rolling_displacement[flying][1:]
    assert_allclose(np.diff(z, 2) / 1e-10, BALL.static_load / BALL.mass, rtol=1e-4)
    assert len(t) > 50
    assert_allclose(run.contact_loss_share, 1 - run.in_contact.mean())
    assert max(each.duration for each in run.contact_loss) >= first.duration
    assert run.contact_force.min() == 0.0


def test_flights_are_found():
    flying = np.array([1, 1, 0, 0, 1, 0, 1, 1, 1], dtype=bool)
    events = contact_losses(flying, 0.5)
    assert [(e.start, e.duration) for e in events] == [(0.0, 1.0), (2.0, 0.5), (3.0, 1.5)]
    assert contact_losses(np.zeros(4, dtype=bool), 0.5) == []


def test_linear_contact_is_never_lost_though_it_pulls():
    run = roll_ball(BEAM, BALL, Linear(BALL.static_load, 2e7, 0.0, rough_texture(1e-6)), **ROUGH)
    assert run.contact_force.min() < 0.0
    assert run.contact_loss == []


def test_printed_with_damping_flies_though_its_damper_acts():
    law = Printed(HERTZ, rough_texture(1e-6), datum=0.0, damping=20.0)
    run = roll_ball(BEAM, BALL, law, **ROUGH)
    assert 0.0 < run.contact_loss_share < 1.0
    assert np.all(run.contact_force[~run.in_contact][1:] != 0.0)


# --- numerics ---------------------------------------------------------------------------------


def test_force_converges_with_the_square_of_the_time_step():
    texture = rough_texture(0.03e-6, shortest=1e-3)
    steps = 2e-5 * 0.5 ** np.arange(4)
    forces = [
        roll_ball(BEAM, BALL, HertzLaw(K, texture), **ROUGH | {"time_step": h}).contact_force[:: 2**i]
        for i, h in enumerate(steps)
    ]
    change = [np.abs(a - b).max() for a, b in itertools.pairwise(forces)]
    assert_allclose(np.log2(np.array(change[:-1]) / change[1:]), 2.0, atol=0.15)


@pytest.mark.parametrize("support", ["simply-supported", "free", "clamped"])
def test_energy_balance_closes_and_the_better_the_finer(support):
    beam = replace(BEAM, support=support)
    law = Shifted(HERTZ, rough_texture(0.2e-6, shortest=5e-4), damping=30.0)
    residuals = [
        roll_ball(beam, BALL, law, **ROUGH | {"time_step": h}).energy.residual for h in (1e-5, 5e-6, 2.5e-6)
    ]
    assert residuals[0] < 1e-3
    assert residuals[2] < residuals[0] / 8


def test_energy_terms_add_up():
    energy = roll_ball(BEAM, BALL, HertzLaw(K, rough_texture(0.05e-6)), **ROUGH).energy
    load, *others = energy.shares.values()
    assert_allclose(load, sum(others), atol=1.01 * energy.residual * energy.throughput + 1e-18)
    assert energy.shares["damping of the structure"] > 0.0


def test_balance_of_nothing_is_closed():
    energy = roll_ball(BEAM, BALL, HertzLaw(K), **ROUGH).energy
    assert replace(energy, throughput=0.0).residual == 0.0


@dataclass(frozen=True, eq=False)
class FromPython:
    """A compiled law, evaluated from Python; remembers what it was asked."""

    law: Shifted
    damping: float = 0.0
    name: str = "from-python"

    def prepare(self, positions):
        return SteppedShifted(self.law.prepare(positions))


class SteppedShifted:
    def __init__(self, prepared):
        self.prepared, self.accepted = prepared, 0

    def evaluate(self, step, approach):
        from asperity.kernels.pointforce import evaluate

        return evaluate(self.prepared, step, approach)

    def accept(self, step):
        assert step == self.accepted + 1
        self.accepted = step

    def warn_of_flaws(self):
        pass

    def state(self):
        return {"accepted": np.array(self.accepted)}

    def restore(self, state):
        self.accepted = int(state["accepted"])


@pytest.mark.parametrize("damping", [0.0, 60.0])
def test_python_and_compiled_stepping_agree(damping):
    law = Shifted(HERTZ, rough_texture(0.3e-6), damping)
    path = ROUGH | {"duration": 0.015}  # each flight multiplies what the tolerances leave
    compiled = roll_ball(BEAM, BALL, law, **path)
    stepped = roll_ball(BEAM, BALL, FromPython(law, damping), **path)
    assert compiled.contact_loss_share > 0.0  # through flights and landings
    assert_allclose(stepped.contact_force, compiled.contact_force, atol=1e-4 * compiled.contact_force.max())
    assert len(stepped.contact_loss) == len(compiled.contact_loss)
    assert stepped.evaluations < 5 * len(stepped.time)
    assert compiled.outcome is stepped.outcome is Outcome.CONVERGED


class Shelf:
    """A checkpoint in memory, which checks that what it gets is made of plain arrays."""

    def __init__(self):
        self.arrays, self.saves = None, 0

    def load(self):
        return self.arrays

    def save(self, arrays):
        assert all(isinstance(a, np.ndarray) and a.dtype != object for a in arrays.values())
        self.arrays, self.saves = arrays, self.saves + 1


@pytest.mark.parametrize("wrap", [lambda law: law, FromPython], ids=["compiled", "from Python"])
def test_interrupted_run_goes_on_bit_by_bit(wrap):
    law = wrap(Shifted(HERTZ, rough_texture(0.2e-6)))
    path = ROUGH | {"time_step": 5e-6}  # more than one chunk
    whole = roll_ball(BEAM, BALL, law, **path)
    shelf, seen = Shelf(), []

    def stop_half_way(done, total, message):
        seen.append(done)
        if done > total / 2 - 100:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        roll_ball(BEAM, BALL, law, **path, progress=stop_half_way, checkpoint=shelf)
    seen_again = []
    resumed = roll_ball(
        BEAM, BALL, law, **path, checkpoint=shelf, progress=lambda done, *_: seen_again.append(done)
    )
    assert seen_again[0] > seen[-1]
    assert seen_again[-1] == len(whole.time) - 1
    for name in ("contact_force", "relative_displacement", "acceleration", "over_displacement"):
        assert np.array_equal(getattr(resumed, name), getattr(whole, name))
    assert resumed.energy == whole.energy
    assert resumed.evaluations == whole.evaluations
    finished = roll_ball(BEAM, BALL, law, **path, checkpoint=shelf)
    assert np.array_equal(finished.contact_force, whole.contact_force)


def test_checkpoint_of_another_run_is_refused():
    shelf = Shelf()
    roll_ball(BEAM, BALL, HertzLaw(K), **ROUGH, checkpoint=shelf)
    with pytest.raises(InputError, match=r"checkpoint.*roll anew"):
        roll_ball(BEAM, BALL, HertzLaw(K), **ROUGH | {"sensors": [0.5]}, checkpoint=shelf)


def test_smooth_rolling_starts_at_rest_and_carries_the_load():
    run = roll_ball(BEAM, BALL, HertzLaw(K), **ROUGH)
    assert_allclose(run.contact_force[0], BALL.static_load, rtol=1e-9)
    assert_allclose(run.relative_displacement[0], WORKING, rtol=1e-8)
    assert_allclose(run.contact_force.mean(), BALL.static_load, rtol=0.02)
    deflection = BEAM.receptance(0.0, 0.3, 0.3).real * BALL.static_load
    assert_allclose(run.over_displacement[0], deflection, rtol=1e-10)
    assert_allclose(np.diff(run.time), 1e-5)


def by_ball(beam, **path):
    return roll_ball(beam, BALL, HertzLaw(K), sensors=[], **path).over_displacement


def by_bodies(beam, **path):
    body = Body.rigid(BALL.mass, BALL.static_load)
    return roll_bodies(beam, [body], [HertzLaw(K)], positions=[0.0], **path).over_displacement[0]


@pytest.mark.parametrize("roll", [by_ball, by_bodies])
def test_a_start_on_the_beam_does_not_ring(roll):
    """The forced part of Frýba's series, each mode with its damping: nothing is left of a sudden start."""
    beam = replace(BEAM, highest_frequency=1e3)
    speed, start = 1.0, 0.3
    path = {"speed": speed, "start": start, "duration": 0.1, "time_step": 5e-5}
    found = roll(beam, **path)
    x = start + speed * 5e-5 * np.arange(len(found))
    omega = 2.0 * np.pi * beam.natural_frequencies
    k = np.pi / beam.length * np.arange(1, len(omega) + 1)
    answer = np.exp(1j * np.outer(x, k)) / (
        omega**2 - (k * speed) ** 2 + 1j * beam.loss_factor * omega * k * speed
    )
    forced = 2.0 * BALL.static_load / beam.mass * np.sum(np.sin(np.outer(x, k)) * answer.imag, axis=1)
    first = k[0] * speed / omega[0]
    assert np.abs(found - forced).max() < 2.0 * first**2 * forced.max()  # from rest it rings by `first`


# --- bad input and doubtful physics -----------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"speed": 0.0}, r"speed \(m/s\)"),
        ({"speed": -1.0}, r"speed \(m/s\)"),
        ({"duration": np.nan}, r"duration \(s\)"),
        ({"time_step": np.inf}, r"time step \(s\)"),
        ({"duration": 1e-6}, "at least one time step"),
        ({"duration": 0.8}, r"path of contact 1 .*received 0.3 to 1.1; allowed: 0 to 1, on the structure"),
        ({"start": -0.1}, "Choose start, duration, run-in"),
        ({"sensors": [1.2]}, "positions on the beam"),
    ],
)
def test_bad_paths_are_refused(change, message):
    with pytest.raises(InputError, match=message):
        roll_ball(BEAM, BALL, HertzLaw(K), **ROUGH | change)


def test_path_longer_than_the_texture_is_refused():
    with pytest.raises(InputError, match="longer texture"):
        roll_ball(BEAM, BALL, HertzLaw(K, rough_texture(1e-7)), **ROUGH | {"duration": 0.1})


def test_coarse_time_steps_are_named():
    coarse = ROUGH | {"time_step": 2e-4}
    with pytest.warns(CoarseSamplingWarning) as caught:
        roll_ball(BEAM, BALL, HertzLaw(K), **coarse, highest_frequency=2000.0)
    text = "\n".join(str(w.message) for w in caught)
    for part in ("contact resonance", "highest mode", "highest frequency asked for", "time step of at most"):
        assert part in text


def test_resolved_run_warns_of_nothing():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        roll_ball(BEAM, BALL, HertzLaw(K), **ROUGH, highest_frequency=5000.0)


def test_continuation_beyond_the_data_is_named():
    s = np.linspace(0.0, 1.05 * WORKING, 6)
    law = Shifted(ForceCurve.from_samples(s, HERTZ.force(s)), rough_texture(0.1e-6))
    with pytest.warns(ExtrapolationWarning, match=r"let contact\.approaches reach higher"):
        roll_ball(BEAM, BALL, law, **ROUGH)


class Erratic(SteppedShifted):
    def evaluate(self, step, approach):
        self.calls = getattr(self, "calls", 0) + 1
        force, slope = super().evaluate(step, approach)
        return force * (1.1 if step > 10 and self.calls % 2 else 1.0), slope


class Broken(SteppedShifted):
    def evaluate(self, step, approach):
        return (np.nan, 0.0) if step == 7 else super().evaluate(step, approach)


@dataclass(frozen=True, eq=False)
class Failing(FromPython):
    kind: type = Erratic

    def prepare(self, positions):
        return self.kind(self.law.prepare(positions))


def test_steps_that_do_not_converge_are_counted():
    law = Failing(Shifted(HERTZ, None))
    with pytest.warns(UnconvergedWarning, match=r"take a smaller numerics\.time_step"):
        run = roll_ball(BEAM, BALL, law, **ROUGH | {"duration": 2e-4})
    assert run.unconverged_steps > 0
    assert run.outcome is Outcome.STEPS_UNCONVERGED
    assert not run.outcome.ok


def test_force_that_is_not_finite_is_reported_with_its_place():
    shelf = Shelf()
    with pytest.raises(ComputationError, match=r"step 7, time 7e-05 s, position 0.30007 m.*smaller"):
        roll_ball(BEAM, BALL, Failing(Shifted(HERTZ, None), kind=Broken), **ROUGH, checkpoint=shelf)
    assert shelf.saves == 0


# --- the run-in -------------------------------------------------------------------------------


def test_a_record_after_a_run_in_is_the_end_of_a_longer_run():
    law = HertzLaw(K, rough_texture(0.05e-6))
    whole = roll_ball(BEAM, BALL, law, **ROUGH)
    late = roll_ball(BEAM, BALL, law, **ROUGH | {"start": 0.305, "duration": 0.015}, settling=0.005)
    assert late.time[0] == 0.0
    assert_allclose(late.position[0], 0.305)
    assert len(late.time) == len(late.position) == len(whole.time) - 500
    for name in ("contact_force", "relative_displacement", "rolling_displacement", "acceleration"):
        assert_allclose(getattr(late, name), getattr(whole, name)[..., 500:], rtol=1e-7, atol=1e-9)
    assert_allclose(
        late.energy.shares["work of the loads"], whole.energy.shares["work of the loads"], rtol=1e-9
    )


def test_a_run_in_on_a_smooth_beam_starts_at_rest():
    """The static deflection is that of the place where the ball lies, not of where the record starts."""
    run = roll_ball(BEAM, BALL, HertzLaw(K), speed=1.0, start=0.5, duration=0.02, time_step=1e-5, sensors=[],
               settling=0.2)  # fmt: skip
    assert np.abs(run.contact_force - BALL.static_load).max() < 0.02 * BALL.static_load


@pytest.mark.parametrize(("settling", "text"), [(-0.1, r"settling \(s\)"), (0.4, "path .* -0.1 to")])
def test_a_run_in_that_cannot_be_is_refused(settling, text):
    with pytest.raises(InputError, match=text):
        roll_ball(BEAM, BALL, HertzLaw(K), **ROUGH, settling=settling)
