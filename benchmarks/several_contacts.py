# ruff: noqa: E402 (the threads are set before numpy is imported)
"""Time a step of several contacts at once: against as many single runs, and against a general integrator.

Balls a tenth of a metre apart on a beam of 4 m, and the wheels of a train on a rail, each over its own rough
path. Timed is the rolling alone: structure, bodies and all contacts of every time step, and the mode shapes
under the contacts. Beside it the same number of runs of one contact, in turn in the same run, best of the
rounds. CPU time of one thread.

The general integrator is SciPy's `solve_ivp` (LSODA, which the stiff contacts need; it stands for what is
written by hand for such a problem) with the same modes, balls and Hertzian contacts over the same textures.
Its tolerance is the loosest whose forces are as near to a run of fine steps as those of the time step.

    python benchmarks/several_contacts.py
"""

from __future__ import annotations

import os

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"

import argparse
import time
import warnings
from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from step_clock import Clock

from asperity.laws import HertzLaw
from asperity.reduction.texture import StateTexture
from asperity.reference.materials import material
from asperity.rolling.roll import roll_bodies
from asperity.structures.beam import Beam
from asperity.structures.body import GRAVITY, Body
from asperity.structures.moving_kernel import moving_kernel
from asperity.structures.rail_poles import RailBetween, RailPoles, rail_between, rail_poles
from asperity.structures.track import Track

STEEL = material("steel")
MASS = 0.514  # kg, of a steel ball of 25 mm radius
LOAD = GRAVITY * MASS
STIFFNESS, APART = 2.4e10, 0.1  # N/m^1.5, m
COACH = np.array([0.0, 2.5, 17.5, 20.0])  # wheels of a coach, m
COACHES = 26.0  # m
SPEED, STEP = 56.0, 50e-6  # of the train, m/s, and its time step, s


def rough(rms: float, spacing: float, start: float, end: float) -> StateTexture:
    """A rough path from start to end, m."""
    points = int((end - start) / spacing) + 2
    heights = np.convolve(np.random.default_rng(2).standard_normal(points), np.hanning(30), mode="same")
    return StateTexture.unfiltered(rms * heights / heights.std(), spacing, start)


def seconds_per_step(run: Callable[[Clock], object]) -> float:
    """CPU time of a step of one run, s."""
    clock = Clock()
    run(clock)
    return clock.seconds_per_step


def balls(count: int, beam: Beam, law: HertzLaw, steps: int) -> tuple[float, float]:
    """Time of a step and contact, s: all at once, and one after another."""
    path = {"speed": 1.0, "duration": steps * 1e-5, "time_step": 1e-5}
    bodies, at = [Body.rigid(MASS, LOAD)] * count, APART * np.arange(count)
    together = seconds_per_step(
        lambda clock: roll_bodies(
            beam, bodies, [law] * count, positions=at, start=0.3, progress=clock, **path
        )
    )
    single = [
        seconds_per_step(
            lambda clock, start=0.3 + place: roll_bodies(
                beam, bodies[:1], [law], positions=[0.0], start=start, progress=clock, **path
            )
        )
        for place in at
    ]
    return together / count, float(np.mean(single))


def wheels(
    count: int, rail: RailPoles, between: RailBetween, law: HertzLaw, steps: int
) -> tuple[float, float]:
    """The same of the wheels of a train."""
    at = (COACH + COACHES * np.arange(8)[:, None]).ravel()[:count]
    body = Body.rigid(600.0, 65e3)
    together = seconds_per_step(
        lambda clock: roll_bodies(
            between, [body] * count, [law] * count, positions=at, start=0.3, speed=SPEED, time_step=STEP,
            duration=steps * STEP, progress=clock,
        )
    )  # fmt: skip
    single = [
        seconds_per_step(
            lambda clock, start=0.3 + place: roll_bodies(
                RailBetween(rail, {}),
                [body],
                [law],
                positions=[0.0],
                start=start,
                speed=SPEED,
                time_step=STEP,
                duration=steps * STEP,
                progress=clock,
            )
        )
        for place in at
    ]
    return together / count, float(np.mean(single))


def table(title: str, rounds: int, counts: list[int], timed: Callable[[int], tuple[float, float]]) -> None:
    """Best of the rounds, as a table."""
    print(f"\n{title}\n\n| contacts | µs a step and contact | single runs | ratio |\n|---:|---:|---:|---:|")
    for count in counts:
        found = np.array([timed(count) for _ in range(rounds)])
        ratio = float(np.median(found[:, 0] / found[:, 1]))
        best = 1e6 * found.min(axis=0)
        print(f"| {count} | {best[0]:.2f} | {best[1]:.2f} | {ratio:.2f} |")


def by_integrator(
    beam: Beam, law: HertzLaw, at: np.ndarray, times: np.ndarray, tolerance: float
) -> np.ndarray:
    """Contact forces (n, t) of the same balls by `solve_ivp`."""
    natural = 2 * np.pi * beam.natural_frequencies
    modes, n, load = len(natural), len(at), LOAD
    grid = law.texture
    places = grid.start + grid.spacing * np.arange(grid.heights.shape[1])
    height = CubicSpline(places, grid.heights[0], bc_type="natural")

    def forces(t: float, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        x = 0.3 + at + t
        shapes = beam.shapes(x)[0]
        approach = -(shapes @ y[:modes] + y[modes : modes + n]) - height(x)
        return STIFFNESS * np.maximum(approach, 0.0) ** 1.5, shapes

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        force, shapes = forces(t, y)
        half = modes + n
        modal = force @ shapes - 2 * beam.damping_ratios * natural * y[half : half + modes]
        return np.concatenate([y[half:], modal - natural**2 * y[:modes], (force - load) / MASS])

    shapes = beam.shapes(0.3 + at)[0]
    q = load * shapes.sum(axis=0) / natural**2
    heights = height(0.3 + at)
    start = np.concatenate([q, -(shapes @ q + heights + (load / STIFFNESS) ** (2 / 3)), np.zeros(modes + n)])
    scale = tolerance * np.concatenate([np.full(modes + n, 1e-6), np.full(modes + n, 1e-3)])
    found = solve_ivp(rates, times[[0, -1]], start, "LSODA", times, rtol=tolerance, atol=scale)
    return np.array([forces(t, y)[0] for t, y in zip(found.t, found.y.T, strict=True)]).T


def against_integrator(steps: int = 2000, count: int = 4) -> None:
    """One problem by both."""
    beam = Beam.rectangular(1.0, 0.05, 0.01, STEEL, highest_frequency=5e3)
    law = HertzLaw(STIFFNESS, rough(8e-9, 2e-5, 0.25, 0.8))
    at, bodies = 0.1 * np.arange(count), [Body.rigid(MASS, LOAD)] * count

    def rolled(h: float) -> np.ndarray:
        return roll_bodies(
            beam,
            bodies,
            [law] * count,
            positions=at,
            start=0.3,
            speed=1.0,
            duration=steps * 1e-5,
            time_step=h,
        ).contact_force

    fine = rolled(2.5e-7)[:, ::40]
    print(
        f"\n{count} balls on a beam of {len(beam.natural_frequencies)} modes, {steps} steps, start included\n"
    )
    print("| | largest error of a force, of the load | CPU time, s | ratio |\n|---|---:|---:|---:|")
    for refined in (1, 4):
        h, began = 1e-5 / refined, time.process_time()
        for _ in range(5):
            forces = rolled(h)
        ours = (time.process_time() - began) / 5
        reached = float(np.abs(forces[:, ::refined] - fine).max() / LOAD)
        print(f"| asperity, steps of {1e6 * h:g} µs | {reached:.1e} | {ours:.3f} | 1 |")
        for tolerance in 10.0 ** -np.arange(3, 9):
            began = time.process_time()
            found = by_integrator(beam, law, at, 1e-5 * np.arange(steps + 1), tolerance)
            theirs = time.process_time() - began
            error = float(np.abs(found - fine).max() / LOAD)
            if error <= reached:
                what = f"solve_ivp, LSODA, rtol {tolerance:.0e}"
                print(f"| {what} | {error:.1e} | {theirs:.2f} | {theirs / ours:.0f} |")
                break


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--steps", type=int, default=20000)
    chosen = parser.parse_args()
    warnings.simplefilter("ignore")  # steps are coarse enough to be told
    beam = Beam.rectangular(4.0, 0.05, 0.01, STEEL, highest_frequency=2.4e3)
    law = HertzLaw(STIFFNESS, rough(1e-8, 1e-5, 0.2, 4.0))
    title = f"Balls on a beam of {len(beam.natural_frequencies)} modes"
    table(title, chosen.rounds, [1, 2, 4, 8, 16, 32], lambda n: balls(n, beam, law, chosen.steps))
    track = Track.named("x2000")
    rail = rail_poles(moving_kernel(track, SPEED, STEP), 100)
    between = rail_between(rail, (COACH + COACHES * np.arange(8)[:, None]).ravel())
    law = HertzLaw(9.4e10, rough(1e-5, 1e-3, -1.0, 1.2 * SPEED * STEP * chosen.steps + 250.0))
    title = "Wheels on a rail, each felt as far as it matters"
    table(title, chosen.rounds, [1, 2, 4, 8, 16, 32], lambda n: wheels(n, rail, between, law, chosen.steps))
    against_integrator()


if __name__ == "__main__":
    main()
