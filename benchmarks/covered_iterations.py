"""Time of an iteration on covered cells, against one of a commit on whole cells of the same grid.

Balls whose overlap has 16 to 96 cells across, smooth and rough, in double precision as `HalfSpace.solve`
takes them and in single precision as scans do. An iteration: what 24 contacts, each from nothing, take more
if they are solved more accurately, over the iterations that they take more. A contact, with all surveys and
copies: each from nothing in double precision; in single precision from those before, at 64 positions one
after the other. Processor time in the compiled entry, the least of several short rounds in turn, and the mean
of that over processes: by where a process finds its memory an iteration varies by a fifth.

    python benchmarks/covered_iterations.py c551c7ce
    python benchmarks/covered_iterations.py c551c7ce --cells 16 32 --processes 20
"""

from __future__ import annotations

import argparse
import itertools
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np

ROOT = Path(__file__).parents[1]
MODULUS, RADIUS, APPROACH = 115e9, 25e-3, 1e-6
ROUGH = (0.001, 0.03, 0.1, 0.3)
"""Rms heights, over the approach."""
TOLERANCES = {False: (1e-2, 1e-8, 1e-6), True: (1e-2, 1e-5, 4e-5)}
"""A looser and a tighter tolerance, and the one that is usual: in double and in single precision."""
ROUNDS = 4
"""Turns that a case has in a process."""
KINDS = {"before": "whole", "covered": "covered", "whole": "whole"}
"""What is measured, and its cells."""
SHORTEST = 0.05
"""Time that a case is measured for before the next version has its turn, s."""


def counted(cells: str, single: bool, across: int, rough: float) -> list[Callable[[], int]]:
    """Work that returns its iterations: contacts to the looser, to the tighter and to the usual tolerance."""
    from asperity import HalfSpace
    from asperity.contact.scan import ScanJob, scan_forces
    from asperity.surfaces.strip import Rows
    from asperity.surfaces.synthesis import self_affine

    half_width = np.sqrt(RADIUS * APPROACH)
    spacing = 8**0.5 * half_width / across  # so that bodies overlap by so many cells
    n = 2 * (5 * across // 8)
    x = (np.arange(n) - n // 2 + 0.3) * spacing
    body = np.add.outer(x**2, x**2) / (2 * RADIUS)
    waves = {"longest": 1.4 * half_width, "shortest": 0.36 * half_width}
    made = self_affine((24 * n, n), (spacing,) * 2, rms=rough * APPROACH, hurst=0.8, seed=1, **waves)
    heights, approaches = np.asarray(made.heights), np.array([APPROACH])
    space = HalfSpace(body.shape, (spacing,) * 2, MODULUS, **({} if cells == "whole" else {"cells": cells}))

    def scanned(stride: int, positions: int, rtol: float) -> int:
        rows = Rows(heights[: n + (positions - 1) * stride])
        return scan_forces(ScanJob(space, rows, body, approaches, stride, rtol), workers=1).counts.iterations

    def solved(rtol: float) -> int:
        gaps = (body - heights[m : m + n] for m in range(0, len(heights), n))
        return sum(space.solve(gap, approach=APPROACH, rtol=rtol).iterations for gap in gaps)

    *both, usual = TOLERANCES[single]
    if not single:
        return [lambda rtol=rtol: solved(rtol) for rtol in (*both, usual)]
    near = max(1, across // 24)
    return [*(lambda rtol=rtol: scanned(n, 24, rtol) for rtol in both), lambda: scanned(near, 64, usual)]


def least_times(*case: Any) -> list[tuple[float, int]]:
    """Time in the compiled entry, s, and iterations, of the work of `counted`."""
    from asperity.contact import scan
    from asperity.kernels import scanning

    entry, seconds = scanning.solve_positions, [0.0]

    def timed(*arguments: Any) -> Any:
        began = time.thread_time()
        result = entry(*arguments)
        seconds[0] += time.thread_time() - began
        return result

    works = counted(*case)
    found = [(np.inf, 0)] * len(works)
    with patch.object(scan, "SINGLE_PAYS", 0.0), patch.object(scanning, "solve_positions", timed):
        began = time.perf_counter()
        while time.perf_counter() < began + SHORTEST or not found[0][0] < np.inf:
            for i, work in enumerate(works):
                seconds[0] = 0.0
                count = work()
                found[i] = (min(found[i][0], seconds[0]), count)
    return found


class Worker:
    """A version of the package in a process of its own."""

    def __init__(self, source: Path) -> None:
        command = [sys.executable, __file__, "--serve"]
        environment = os.environ | {"PYTHONPATH": str(source), "OPENBLAS_NUM_THREADS": "1"}
        pipe = subprocess.PIPE
        self.process = subprocess.Popen(command, env=environment, stdin=pipe, stdout=pipe, text=True)

    def ask(self, *case: Any) -> Any:
        """Measure a case while this process waits."""
        assert self.process.stdin
        assert self.process.stdout
        print(json.dumps(case), file=self.process.stdin, flush=True)
        return json.loads(self.process.stdout.readline())

    def end(self) -> None:
        """Let the process end."""
        assert self.process.stdin
        self.process.stdin.close()
        self.process.wait()


def serve() -> None:
    """Measure what is asked for line by line."""
    for line in sys.stdin:
        print(json.dumps(least_times(*json.loads(line))), flush=True)


def summary(rounds: list[Any]) -> np.ndarray:
    """Time of an iteration, of a contact, and that over its iterations, us; and these."""
    loose, tight, usual = (min(each) for each in zip(*rounds, strict=True))
    return np.array([(tight[0] - loose[0]) / (tight[1] - loose[1]), usual[0], usual[0] / usual[1], usual[1]])


def measured(sources: dict[str, Path], options: argparse.Namespace) -> dict[tuple, dict[str, np.ndarray]]:
    """What `summary` says of each case, in new processes."""
    workers = {name: Worker(source) for name, source in sources.items()}
    found = {}
    for case in itertools.product((False, True), options.cells, ROUGH):
        rounds: dict[str, list[Any]] = {name: [] for name in KINDS}
        for _ in range(ROUNDS):
            for name, kind in KINDS.items():
                worker = workers["before" if name == "before" else "now"]
                rounds[name].append(worker.ask(kind, *case))
        found[case] = {name: summary(each) for name, each in rounds.items()}
    for worker in workers.values():
        worker.end()
    return found


def compare(sources: dict[str, Path], options: argparse.Namespace) -> None:
    """Print the table."""
    processes = [measured(sources, options) for _ in range(options.processes)]
    print("| precision | cells across | rms / approach | an iteration before, us | covered | whole ", end="")
    print("| a contact: covered | whole | over iterations: covered | iterations: covered |")
    print(10 * "|---" + "|")
    for case in processes[0]:
        single, across, rough = case
        means = {name: np.mean([each[case][name] for each in processes], axis=0) for name in KINDS}
        before = means["before"]
        covered, whole = means["covered"] / before, means["whole"] / before
        print(
            f"| {'single' if single else 'double'} | {across} | {rough} | {1e6 * before[0]:.2f} "
            f"| {covered[0]:.2f} | {whole[0]:.2f} | {covered[1]:.2f} | {whole[1]:.2f} "
            f"| {covered[2]:.2f} | {covered[3]:.2f} |"
        )


def main() -> None:
    """Compare."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("commit", help="what the working tree is compared with")
    parser.add_argument("--cells", type=int, nargs="+", default=[16, 21, 28, 36, 48, 64, 96])
    parser.add_argument("--processes", type=int, default=8)
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        archive = subprocess.run(
            ["git", "archive", chosen.commit, "src"], cwd=ROOT, check=True, capture_output=True
        )
        subprocess.run(["tar", "-x", "-C", folder], input=archive.stdout, check=True)
        compare({"before": Path(folder) / "src", "now": ROOT / "src"}, chosen)


if __name__ == "__main__":
    serve() if sys.argv[1:] == ["--serve"] else main()
