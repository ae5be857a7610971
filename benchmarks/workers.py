"""How much faster a scan is on all cores, next to what the cores themselves allow.

The scan of path_scaling.py on one worker, on several, and, for what the machine can do at all at that moment,
in as many processes that know nothing of each other, each doing all of it on one worker. The three take
turns; the least time of each counts. Start and compilation are not in the times.

    python benchmarks/workers.py --rounds 8
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from dataclasses import replace

import numpy as np
from path_scaling import CELLS, LOAD, MODULUS, RADIUS, SPACING


def serve(positions: int, approaches: int) -> None:
    """Scan with as many workers as each line of standard input says; write how long it took."""
    import time

    from asperity import HalfSpace, Hertz
    from asperity.contact.scan import FORCE_ACCURACY, ScanJob, rtol_for, scan_forces
    from asperity.surfaces.strip import Rows
    from asperity.surfaces.synthesis import long_self_affine

    approach = Hertz(MODULUS, RADIUS, RADIUS).approach(LOAD)
    x = (np.arange(CELLS) - CELLS // 2) * SPACING
    body = (x[:, None] ** 2 + x[None, :] ** 2) / (2 * RADIUS)
    waves = {"rms": 0.2 * approach, "hurst": 0.8, "longest": 0.4e-3, "shortest": 40e-6}
    grid, states = (SPACING, SPACING), approach * np.linspace(0.2, 1.5, approaches)
    rows = long_self_affine((positions + CELLS - 1, CELLS), grid, **waves, seed=1).rows(
        0, positions + CELLS - 1
    )
    half_space = HalfSpace(body.shape, SPACING, MODULUS)
    job = ScanJob(half_space, Rows(rows), body, states, rtol=rtol_for(FORCE_ACCURACY), device=None)
    scan_forces(replace(job, surface=Rows(rows[: 4 * CELLS])), workers=1)
    print("ready", flush=True)
    reference = None
    for line in sys.stdin:
        began = time.perf_counter()
        forces = scan_forces(job, workers=int(line)).forces
        print(time.perf_counter() - began, flush=True)
        reference = forces if reference is None else reference
        assert np.array_equal(forces, reference), "the digits depend on the number of workers"


class Server:
    """A process that scans when told to."""

    def __init__(self, positions: int, approaches: int) -> None:
        self.process = subprocess.Popen(
            [sys.executable, __file__, "--serve", str(positions), str(approaches)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.answer()

    def ask(self, workers: int) -> None:
        """Have it scan."""
        assert self.process.stdin is not None
        self.process.stdin.write(f"{workers}\n")
        self.process.stdin.flush()

    def answer(self) -> str:
        """Wait for its line."""
        assert self.process.stdout is not None
        return self.process.stdout.readline()


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--positions", type=int, default=30000)
    parser.add_argument("--approaches", type=int, default=3)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--serve", type=int, nargs=2, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.serve:
        serve(*options.serve)
        return
    count = options.workers
    servers = [Server(options.positions, options.approaches) for _ in range(count)]

    def turn(asked: list[Server], workers: int) -> float:
        for server in asked:
            server.ask(workers)
        return max(float(server.answer()) for server in asked)

    print(f"| round | one worker, s | {count} workers, s | {count} processes, each all of it, s |")
    print("|---:|---:|---:|---:|")
    rounds = []
    for number in range(options.rounds):
        times = turn(servers[:1], 1), turn(servers[:1], count), turn(servers, 1)
        rounds.append(times)
        print(f"| {number + 1} | " + " | ".join(f"{t:.2f}" for t in times) + " |", flush=True)
    one, several, apart = np.min(rounds, axis=0)
    print(f"\n{count} workers: {one / several:.2f} times as fast as one, the same digits")
    print(f"{count} processes apart: {count * one / apart:.2f} times the work of one in the same time")


if __name__ == "__main__":
    main()
