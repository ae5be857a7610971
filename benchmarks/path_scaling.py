# ruff: noqa: E402 (the threads are set before numpy is imported)
"""Measure how the scan of a path grows: time with length, approaches and workers, memory with length.

A ball (R = 25 mm, 10 N) on a self-affine strip that is generated in pieces, 61 × 61 cells of 10 µm, scanned
into a cache as a run does. Each scan is a process of its own, so that its peak memory (ru_maxrss) is its own;
compilation is not in the times. Forces of all numbers of workers are compared digit by digit. With
--figure, time and memory are drawn.

    python benchmarks/path_scaling.py --figure growth.png
"""

from __future__ import annotations

import os

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[variable] = "1"

import argparse
import json
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

SPACING, CELLS, MODULUS, RADIUS, LOAD = 10e-6, 61, 115e9, 25e-3, 10.0


def scanned(positions: int, approaches: int, workers: int, stored: bool) -> dict[str, float | str]:
    """Scan, in this process."""
    import hashlib
    import resource

    from asperity import HalfSpace, Hertz
    from asperity.contact.scan import FORCE_ACCURACY, ScanJob, rtol_for, scan_forces
    from asperity.store import Store
    from asperity.surfaces.strip import Rows
    from asperity.surfaces.synthesis import long_self_affine

    approach = Hertz(MODULUS, RADIUS, RADIUS).approach(LOAD)
    x = (np.arange(CELLS) - CELLS // 2) * SPACING
    body = (x[:, None] ** 2 + x[None, :] ** 2) / (2 * RADIUS)
    waves = {"rms": 0.2 * approach, "hurst": 0.8, "longest": 0.4e-3, "shortest": 40e-6}
    grid, states = (SPACING, SPACING), approach * np.linspace(0.2, 1.5, approaches)
    strip = long_self_affine((positions + CELLS - 1, CELLS), grid, **waves, seed=1)
    half_space = HalfSpace(body.shape, SPACING, MODULUS)
    job = ScanJob(half_space, strip, body, states, rtol=rtol_for(FORCE_ACCURACY), device=None)
    scan_forces(replace(job, surface=Rows(strip.rows(0, CELLS))))  # compiles, or reads what is compiled
    digest = hashlib.sha256()
    with tempfile.TemporaryDirectory() as folder:
        began = time.perf_counter()
        cache = Store(Path(folder)) if stored else None
        surface = strip if stored else Rows(strip.rows(0, strip.shape[0]))
        job = replace(job, surface=surface)
        forces = scan_forces(job, mapped=stored, cache=cache, workers=workers).forces
        seconds, size = time.perf_counter() - began, cache.size() if cache else 0
        for first in range(0, positions, 4096):
            digest.update(np.ascontiguousarray(forces[:, first : first + 4096]).tobytes())
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return {"seconds": seconds, "MiB": peak, "disk": size / 2**20, "digest": digest.hexdigest()}


def in_process(positions: int, approaches: int, workers: int = 1, stored: bool = True) -> dict:
    """Scan, in a process of its own."""
    job = ["--job", json.dumps([positions, approaches, workers, stored])]
    done = subprocess.run([sys.executable, __file__, *job], capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def slope(x: list[int], y: list[float]) -> float:
    """Exponent of the growth, from a straight line on logarithmic scales."""
    return float(np.polyfit(np.log(x), np.log(y), 1)[0])


def draw(path: str, lengths: list[int], streamed: list[dict], held: list[dict], more: list[tuple]) -> None:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, panels = plt.subplots(1, 3, figsize=(10, 3.2), layout="constrained")
    panels[0].loglog(lengths, [r["seconds"] for r in streamed], "o-")
    panels[0].set(xlabel="positions", ylabel="time, s", title="path length")
    panels[1].plot([k for k, _ in more], [r["seconds"] for _, r in more], "o-")
    panels[1].set(xlabel="approaches", ylabel="time, s", title="approaches", xlim=(0, None), ylim=(0, None))
    panels[2].semilogx(lengths, [r["MiB"] for r in streamed], "o-", label="streamed")
    panels[2].semilogx(lengths, [r["MiB"] for r in held], "s--", label="held in memory")
    panels[2].set(xlabel="positions", ylabel="peak memory, MiB", title="memory", ylim=(0, None))
    panels[2].legend(frameon=False)
    for panel in panels:
        panel.grid(alpha=0.3)
    figure.savefig(path, dpi=110)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--lengths", type=int, nargs="+", default=[3000, 10000, 30000, 100000])
    parser.add_argument("--approaches", type=int, nargs="+", default=[2, 4, 8, 16, 32])
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--figure", metavar="FILE", help="draw the growth")
    parser.add_argument("--job", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.job:
        print(json.dumps(scanned(*json.loads(options.job))))
        return
    lengths = options.lengths
    streamed = [in_process(n, 3) for n in lengths]
    held = [in_process(n, 3, stored=False) for n in lengths]
    print("| positions | time, s | us per solution | peak, MiB | held in memory, MiB | disk, MiB |")
    print("|---:|---:|---:|---:|---:|---:|")
    for n, r, h in zip(lengths, streamed, held, strict=True):
        assert r["digest"] == h["digest"]
        per = 1e6 * r["seconds"] / (3 * n)
        print(f"| {n} | {r['seconds']:.2f} | {per:.0f} | {r['MiB']:.0f} | {h['MiB']:.0f} | {r['disk']:.1f} |")
    print(f"\ntime grows as positions^{slope(lengths, [r['seconds'] for r in streamed]):.2f}\n")
    more = [(k, in_process(lengths[1], k)) for k in options.approaches]
    print("| approaches | time, s |\n|---:|---:|")
    for k, r in more:
        print(f"| {k} | {r['seconds']:.2f} |")
    print(f"\ntime grows as approaches^{slope(options.approaches, [r['seconds'] for _, r in more]):.2f}\n")
    one, several = in_process(lengths[-1], 3), in_process(lengths[-1], 3, options.workers)
    same = "the same digits" if one["digest"] == several["digest"] else "OTHER DIGITS"
    ratio = one["seconds"] / several["seconds"]
    print(f"{options.workers} workers: {ratio:.2f} times as fast at {lengths[-1]} positions, {same}")
    if options.figure:
        draw(options.figure, lengths, streamed, held, more)


if __name__ == "__main__":
    main()
