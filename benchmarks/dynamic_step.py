# ruff: noqa: E402 (the threads are set before numpy is imported)
"""Time a dynamic step of the contact laws.

One case is prepared (textures, reduction, scan of the path); then every law rolls the ball over the same
path. Timed is the rolling alone: beam, ball and contact of each time step. Not timed are the preparation of
the case (kept in the disk cache between runs of this script), the laying-out of the law on the path
(reported beside it), the start from static equilibrium and the compilation. `direct`, which solves the 3-D
contact in every step, rolls a shorter piece. CPU time of one thread; the laws take turns in every round,
medians over the rounds, ratios within one round.

    python benchmarks/dynamic_step.py
"""

from __future__ import annotations

import os

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"

import argparse
import json
import time
import warnings
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike
from step_clock import Clock

from asperity.case.cases import parse_case
from asperity.errors import PhysicsWarning
from asperity.laws import Law
from asperity.progress import progress_bar
from asperity.rolling.roll import RolledBodies, roll_bodies
from asperity.running import prepare_case
from asperity.scenes.compute import Computed, compute

COMPILED = ["linear", "hertz", "printed", "shifted", "areal", "table"]


@dataclass
class Timed:
    """A law whose laying-out on the path is timed apart."""

    law: Law
    seconds: float = 0.0
    name: str = field(init=False)
    damping: float = field(init=False)

    def __post_init__(self) -> None:
        self.name, self.damping = self.law.name, self.law.damping

    def prepare(self, positions: ArrayLike) -> object:
        """Lay the law out, and keep how long it took."""
        began = time.process_time()
        prepared = self.law.prepare(positions)
        self.seconds = time.process_time() - began
        return prepared


def prepared_case(load: float, rms: float, duration: float) -> Computed:
    """Prepare the case and all laws but `direct`, which shares their path; rolling them compiles them."""
    case = parse_case(
        f"""
        kind = "ball-on-beam"
        laws = {json.dumps(COMPILED)}
        seed = 1
        start = "0.4 m"
        duration = "{duration} s"
        [surface]
        rms = "{rms} um"
        longest = "0.4 mm"
        shortest = "32 um"
        [ball]
        load = "{load} N"
        [contact]
        spacing = "12 um"
        window = "0.65 mm"
        samples = 2
        """
    )
    with progress_bar() as progress:
        return compute(prepare_case(case), progress)


def direct_law(computed: Computed) -> Law:
    """Make the law that solves the contact in every step of the same path."""
    return computed.build("direct")


def rolled(computed: Computed, law: Law, duration: float) -> tuple[float, float, RolledBodies]:
    """CPU time of a step and of the laying-out, s, and what was rolled."""
    case, timed, clock = computed.case, Timed(law), Clock()
    run = roll_bodies(
        computed.over,
        computed.scene.rolling,
        [timed],
        positions=computed.scene.positions,
        speed=case.speed,
        start=case.record_start,
        duration=duration,
        time_step=case.time_step,
        sensors=case.rolled_over.sensor_positions,
        progress=clock,
    )
    return clock.seconds_per_step, timed.seconds, run


def report(
    computed: Computed, steps: dict[str, list[float]], layouts: dict[str, list[float]], runs: dict
) -> None:
    """Print the table in Markdown."""
    case = computed.case
    modes, sensors = len(computed.over.natural_frequencies), len(computed.case.rolled_over.sensor_positions)
    print(
        f"\nBall on beam, {computed.shape.load:g} N, window {computed.shape.body.shape[0]} x "
        f"{computed.shape.body.shape[1]} cells, {modes} beam modes, {sensors} sensors, "
        f"time step {1e6 * case.time_step:.3g} us, CPU time\n"
    )
    print("| law | steps | us per step | to areal | direct to it | evaluations per step | laying out, ms |")
    print("|---|---:|---:|---:|---:|---:|---:|")
    areal, direct = np.array(steps["areal"]), np.array(steps["direct"])
    for name, seconds in steps.items():
        s, run = np.array(seconds), runs[name]
        count = len(run.time) - 1
        print(
            f"| `{name}` | {count} | {1e6 * np.median(s):.3g} | {np.median(s / areal):.3g} "
            f"| {np.median(direct / s):.3g} | {run.evaluations / count:.2f} "
            f"| {1e3 * np.median(layouts[name]):.3g} |"
        )
    print(f"\ndirect / areal: {np.median(direct / areal):.0f}")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--load", type=float, default=30.0, help="N")
    parser.add_argument("--rms", type=float, default=0.05, help="um")
    parser.add_argument("--duration", type=float, default=0.2, help="s, of the compiled laws")
    parser.add_argument("--direct-duration", type=float, default=0.01, help="s, of direct")
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    warnings.simplefilter("ignore", PhysicsWarning)  # what is timed is not what is concluded
    computed = prepared_case(options.load, options.rms, options.duration)
    laws = {name: computed.build(name) for name in computed.runs} | {"direct": direct_law(computed)}
    steps: dict[str, list[float]] = {name: [] for name in laws}
    layouts: dict[str, list[float]] = {name: [] for name in laws}
    runs: dict[str, RolledBodies] = {}
    rolled(computed, laws["direct"], 20 * computed.case.time_step)  # compiles
    for _ in range(options.rounds):
        for name, law in laws.items():
            duration = options.direct_duration if name == "direct" else options.duration
            step, layout, runs[name] = rolled(computed, law, duration)
            steps[name].append(step)
            layouts[name].append(layout)
    report(computed, steps, layouts, runs)


if __name__ == "__main__":
    main()
