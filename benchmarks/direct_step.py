# ruff: noqa: E402 (the threads are set before numpy is imported)
"""Time a step of `direct`, the law that solves the rough contact in every step, next to that of a commit.

A ball on a beam (55 × 55 cells) and the default wheel on a rail (41 × 41) are prepared once by the package of
the commit and by that of the working tree. Both then roll the same paths in turn, in processes that stay,
the one that begins changing from round to round. Beside it, in the working tree: the time of a contact in a
quasi-static scan of the same path in the same strides, which `scan_step.py` compares with the peers. CPU time
of one thread, preparation and laying-out left out; least times over the rounds, medians of the ratios round
by round. The forces of both must agree.

    python benchmarks/direct_step.py HEAD~1
"""

from __future__ import annotations

import os

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from step_clock import Clock

ROOT = Path(__file__).parents[1]
CASES = {
    "ball": """
kind = "ball-on-beam"
laws = ["direct"]
seed = 1
start = "0.4 m"
duration = "10 ms"
surface = {rms = "0.05 um", longest = "0.4 mm", shortest = "32 um"}
ball = {load = "30 N"}
contact = {spacing = "12 um", window = "0.65 mm", samples = 1}
""",
    "wheel": """
kind = "wheel-on-rail"
laws = ["direct"]
duration = "20 ms"
settling = "10 ms"
surface = {spectrum = "iso3095"}
""",
}
SCANNED = 200
"""Positions of the scan."""
Timed = dict[str, float]


def rolled(name: str) -> tuple[Any, Callable[[Clock], Any]]:
    """Prepare a case; its law, and what rolls it."""
    from asperity.case.cases import parse_case
    from asperity.rolling.roll import roll_bodies
    from asperity.running import prepare_case
    from asperity.scenes.compute import compute

    prepared = prepare_case(parse_case(CASES[name]))
    case, found = prepared.case, compute(prepared, lambda *_: None)
    law, scene = found.build("direct"), found.scene
    path = {"speed": case.speed, "start": case.record_start, "time_step": case.time_step}
    path |= {"duration": case.rolled_time, "settling": case.settled_time}
    path["sensors"] = case.rolled_over.sensor_positions
    return law, lambda clock: roll_bodies(
        found.over, scene.rolling, [law], positions=scene.positions, progress=clock, **path
    )


def scanned(law: Any, run: Any) -> float:
    """CPU time of a contact of a scan of the same path, s, at the mean approach of the run."""
    from asperity.contact.halfspace import HalfSpace

    space = HalfSpace(law.body.shape, law.spacing, law.modulus, law.hardness)
    stride = max(1, round(float(run.positions[0, 1] - run.positions[0, 0]) / law.spacing[0]))
    rows = law.heights[: (SCANNED - 1) * stride + len(law.body)]
    approach, planes = np.array([run.relative_displacement.mean()]), np.zeros(SCANNED)
    began = time.process_time()
    block = space.solve_block(space.block(rows, law.body, planes, approach, stride, law.rtol))
    return (time.process_time() - began) / max(int(block.counts[0]), 1)


def work() -> None:
    """Time the cases whose names arrive."""
    import warnings

    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as cache:  # nothing is taken up where an earlier run left it
        os.environ["ASPERITY_CACHE"] = cache
        made: dict[str, Any] = {}
        for line in sys.stdin:
            name = line.strip()
            law, roll = made[name] = made.get(name) or rolled(name)
            clock = Clock()
            run = roll(clock)
            found = {"step": clock.seconds_per_step, "scan": scanned(law, run), "steps": clock.marks[-1][0]}
            found |= {
                "cells": len(law.body),
                "mean": run.contact_force.mean(),
                "rms": run.contact_force.std(),
            }
            print(json.dumps(found), flush=True)


class Tree:
    """A version of the package, and a process that rolls with it."""

    def __init__(self, source: Path) -> None:
        command, environment = [sys.executable, __file__, "--work"], os.environ | {"PYTHONPATH": str(source)}
        self.process = subprocess.Popen(
            command, env=environment, text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE
        )

    def time(self, name: str) -> Timed:
        """Let it roll a case."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        print(name, file=self.process.stdin, flush=True)
        line = self.process.stdout.readline()
        if not line:
            raise SystemExit(f"{name}: the process ended; this commit does not know the case, or it failed")
        found: Timed = json.loads(line)
        return found


def compare(commit: str, rounds: int) -> None:
    """Print the table in Markdown."""
    with tempfile.TemporaryDirectory() as folder:
        archive = subprocess.run(["git", "archive", commit, "src"], cwd=ROOT, check=True, capture_output=True)
        subprocess.run(["tar", "-x", "-C", folder], input=archive.stdout, check=True)
        trees = [Tree(Path(folder) / "src"), Tree(ROOT / "src")]
        print(
            "| case | cells | steps | us per step before | now | before to now | now to a contact of a scan |"
        )
        print("|---|---:|---:|---:|---:|---:|---:|")
        for name in CASES:
            found: list[list[Timed]] = [[], []]
            for number in range(rounds + 1):  # the first compiles
                for which in (0, 1) if number % 2 else (1, 0):
                    found[which].append(trees[which].time(name))
            before, now = (np.array([timed["step"] for timed in times[1:]]) for times in found)
            scan = np.array([timed["scan"] for timed in found[1][1:]])
            one, cells = found[1][0], f"{found[1][0]['cells']}²"
            print(
                f"| {name} | {cells} | {one['steps']} | {1e6 * before.min():.0f} | {1e6 * now.min():.0f} "
                f"| {np.median(before / now):.2f} | {np.median(now / scan):.2f} |"
            )
            for which in ("mean", "rms"):
                apart = abs(found[0][0][which] - one[which]) / one["mean"]
                assert apart < 1e-5, f"{name}: the {which} force differs by {apart:.1e} of its mean"
        for tree in trees:
            tree.process.communicate()


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("commit", nargs="?", default="HEAD", help="what the working tree is compared with")
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--work", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    work() if options.work else compare(options.commit, options.rounds)


if __name__ == "__main__":
    main()
