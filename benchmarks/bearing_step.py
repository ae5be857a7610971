# ruff: noqa: E402 (the threads are set before numpy is imported)
"""Time a step of a ball bearing: against a single contact, and a second of it with texture on all parts.

A 6205 under 100 N at 1800 1/min, nine balls, 18 contacts; waviness and roughness on both raceways and on
every ball. First the time of a step and contact, next to that with a film of ISO VG 68 in each contact and
to that of one ball on one contact by the same law (`roll_bodies`, a ball on a short beam), in turn in the
same run, CPU time of one thread. Then one
second, whole calls, wall and CPU time: scans, made once and kept (`--cache`), the textures of the balls, and
the rolling after them.

    python benchmarks/bearing_step.py --cache FOLDER
"""

from __future__ import annotations

import os

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"

import argparse
import time
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
from step_clock import Clock

from asperity import BallBearing
from asperity.case.ball_bearing import BearingUnderLoad
from asperity.laws import Law
from asperity.laws.film import WithFilm
from asperity.reference.materials import material
from asperity.rolling.bearing import BearingRings, RolledBearing, roll_bearing
from asperity.rolling.roll import roll_bodies
from asperity.scenarios.raceway_grids import raceway_on
from asperity.scenarios.raceway_laws import ball_heights, raceway_laws
from asperity.store import Store
from asperity.structures.beam import Beam
from asperity.structures.body import Body
from asperity.structures.ring import Ring
from asperity.surfaces.raceway import AroundTexture

BEARING, RADIAL, SPEED, STEP = BallBearing.named("6205"), 100.0, 30.0, 3.5e-6
RINGS = BearingRings(Ring.rigid(0.5), Ring.rigid(0.3, radial_stiffness=1e8, damping_ratio=0.03))
OILED = BearingUnderLoad(bearing={"name": "6205"}, radial=RADIAL, speed=SPEED, lubricant={"oil": "ISO VG 68"})
GROUND = AroundTexture(waviness=0.2e-6, roughness=20e-9, longest=0.5e-3, shortest=50e-6)
LAPPED = AroundTexture(waviness=0.02e-6, last_order=30, roughness=8e-9, longest=0.5e-3, shortest=50e-6)
LIMITS = {"table": 20.0, "areal": 5.0}


def timed(call: Callable[[], object]) -> tuple[object, float, float]:
    """What a call returns, and its wall and CPU time, s."""
    wall, cpu = time.perf_counter(), time.process_time()
    found = call()
    return found, time.perf_counter() - wall, time.process_time() - cpu


def prepared(cache: Store) -> tuple[dict[str, list[Law]], list[np.ndarray]]:
    """Laws on inner and outer raceway by name, and heights of the balls; told how long they took."""
    load = float(BEARING.loaded(RADIAL).inner_load.max())
    laws: dict[str, list[Law]] = {name: [] for name in LIMITS}
    contacts = BEARING.inner_contact, BEARING.outer_contact
    for seed, (contact, radius) in enumerate(zip(contacts, BEARING.raceway_radii, strict=True)):
        surface = raceway_on(contact, load, radius, GROUND, seed=seed)
        for name, found in laws.items():
            made = timed(
                lambda name=name, contact=contact, surface=surface: raceway_laws(
                    [name], contact, surface, load, damping=50.0, cache=cache
                )[name]
            )
            found.append(made[0])
            print(f"| {name}, raceway of {surface.heights.shape} points | {made[1]:.1f} | {made[2]:.1f} |")

    def balls() -> list[np.ndarray]:
        made = [
            raceway_on(contacts[0], load, 0.5 * BEARING.ball_diameter, LAPPED, seed=10 + j) for j in range(9)
        ]
        return [ball_heights(contacts[0], each, load) for each in made]

    heights, wall, cpu = timed(balls)
    print(f"| balls | {wall:.1f} | {cpu:.1f} |")
    return laws, heights


def bearing(laws: list[Law], heights: list[np.ndarray], duration: float, clock: Clock) -> RolledBearing:
    """The bearing, turned for so long, s."""
    sensors = [("outer", 0.0, "radial")]
    return roll_bearing(
        BEARING, RINGS, *laws, speed=SPEED, radial=RADIAL, duration=duration, time_step=STEP,
        ball_heights=heights, sensors=sensors, progress=clock,
    )  # fmt: skip


def single(law: Law, duration: float, clock: Clock) -> None:
    """One ball of 50 N on a short beam that has the outer raceway on it."""
    beam = Beam.rectangular(0.2, 0.05, 0.02, material("steel"), highest_frequency=4e3)
    body, speed = Body.rigid(BEARING.ball_mass, 50.0), 1.76
    roll_bodies(
        beam, [body], [law], positions=[0.0], start=0.05, speed=speed, duration=min(duration, 0.05),
        time_step=STEP, progress=clock,
    )  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--cache", type=Path, required=True)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--duration", type=float, default=1.0)
    chosen = parser.parse_args()
    warnings.simplefilter("ignore")
    print("| prepared | wall, s | CPU, s |\n|---|---:|---:|")
    laws, heights = prepared(Store(chosen.cache))
    print("\n| law | µs a step and contact | with oil | ratio | single contact | ratio |")
    print("|---|---:|---:|---:|---:|---:|")
    for name, both in laws.items():
        wet = [
            WithFilm(law, film, load)
            for law, film, (_, load) in zip(both, OILED.films or (), OILED.contacts, strict=True)
        ]
        rounds = []
        for _ in range(chosen.rounds + 1):
            clocks = Clock(), Clock(), Clock()
            bearing(both, heights, 0.1, clocks[0])
            bearing(wet, heights, 0.1, clocks[1])
            single(both[1], 0.1, clocks[2])
            rounds.append(
                [each.seconds_per_step / count for each, count in zip(clocks, (18, 18, 1), strict=True)]
            )
        found = 1e6 * np.array(rounds[1:])
        dry, oiled, alone = found.min(axis=0)
        oil, many = np.median(found[:, [1, 0]] / found[:, [0, 2]], axis=0)
        print(f"| `{name}` | {dry:.2f} | {oiled:.2f} | {oil:.2f} | {alone:.2f} | {many:.2f} |")
    print("\n| one second, law | wall, s | CPU, s | limit, s | energy left over |\n|---|---:|---:|---:|---:|")
    for name, both in laws.items():
        run, wall, cpu = timed(lambda both=both: bearing(both, heights, chosen.duration, Clock()))
        print(f"| `{name}` | {wall:.1f} | {cpu:.1f} | {LIMITS[name]:g} | {run.energy.residual:.0e} |")


if __name__ == "__main__":
    main()
