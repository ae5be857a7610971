# ruff: noqa: E402 (the threads are set before numpy is imported)
"""Measure which residual a force accuracy needs, what it saves, and what it does to spectra and filters.

A ball (R = 25 mm, E* = 115 GPa) moves over self-affine surfaces, from smooth to rougher than the approach,
with and without a hardness, on 49 to 97 cells, from the first touches to thrice the approach of 10 N. At
each tolerance the forces are compared with those of a residual of 1e-10: the largest relative error, and the
largest difference of a one-third-octave band of the force along the path up to ka = 16. CPU time of one
thread, the smallest of the rounds; tolerances and precisions take turns. Scans as short as these would stay
in double precision: here each is made in both, where single is enough.

    python benchmarks/force_accuracy.py
"""

from __future__ import annotations

import os

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[variable] = "1"

import argparse
import time
from dataclasses import dataclass
from unittest.mock import patch

import numpy as np
from numpy.typing import NDArray

from asperity import HalfSpace, Hertz
from asperity.contact.scan import (
    FILTER_SHARE,
    FORCE_ACCURACY,
    SINGLE_ENOUGH,
    ScanJob,
    ScannedForces,
    rtol_for,
    scan_forces,
)
from asperity.reduction.filter import estimate_filter, filter_spectra
from asperity.spectra import band_levels, psd
from asperity.surfaces.strip import Rows
from asperity.surfaces.synthesis import self_affine

MODULUS, RADIUS, LOAD = 115e9, 25e-3, 10.0
TIGHT = 1e-10
TOLERANCES = (1e-2, 1e-3, 2e-4, rtol_for(FORCE_ACCURACY), rtol_for(FILTER_SHARE * FORCE_ACCURACY), 1e-6, 1e-8)
ASKED = [
    (rtol, single) for rtol in TOLERANCES for single in (False, True) if not single or rtol >= SINGLE_ENOUGH
]
"""Tolerances, and whether in single precision."""
CASES = [  # rms in approaches, hardness, cells, seed
    (0.0, None, 49, 1),
    (0.02, None, 49, 1),
    (0.1, None, 49, 1),
    (0.5, None, 49, 2),
    (1.5, None, 49, 3),
    (0.5, 2e9, 49, 2),
    (0.1, None, 97, 4),
    (0.5, None, 97, 5),
]


@dataclass
class Problem:
    """A surface, and what presses on it."""

    heights: NDArray
    body: NDArray
    spacing: float
    approaches: NDArray
    hardness: float | None
    radius: float

    def scanned(self, rtol: float, single: bool = False) -> ScannedForces:
        """Scan on one thread."""
        half_space = HalfSpace(self.body.shape, self.spacing, MODULUS, self.hardness)
        job = ScanJob(half_space, Rows(self.heights), self.body, self.approaches, rtol=rtol, device=None)
        with patch("asperity.contact.scan.SINGLE_PAYS", 0.0 if single else np.inf):
            return scan_forces(job, workers=1)


def problem(rms: float, hardness: float | None, cells: int, seed: int, positions: int) -> Problem:
    hertz = Hertz(MODULUS, RADIUS, RADIUS)
    approach = hertz.approach(LOAD)
    radius = hertz.semi_axes(approach)[0]
    dx = 2 * radius / (0.35 * cells)
    x = (np.arange(cells) - cells // 2) * dx
    waves = {"hurst": 0.8, "longest": 2 * radius, "shortest": 2 * dx}
    shape = (cells + positions - 1, cells)
    heights = np.asarray(self_affine(shape, (dx, dx), rms=rms * approach, **waves, seed=seed).heights)
    body = (x[:, None] ** 2 + x[None, :] ** 2) / (2 * RADIUS)
    approaches = approach * np.array([-rms, 0.1, 0.3, 1.0, 3.0])
    return Problem(heights, body, dx, approaches, hardness, radius)


def errors(p: Problem, found: NDArray, tight: NDArray) -> tuple[float, float, float]:
    """Largest relative error of a force, of a band in dB, and of a fitted filter in dB."""
    touching = tight > 0.0
    largest = float(np.abs(found[touching] / tight[touching] - 1.0).max())
    if not np.ptp(p.heights):
        return largest, 0.0, 0.0
    bands = []
    for forces in (found, tight):
        wavenumber, density = psd(forces[2:], p.spacing, segment=forces.shape[1] // 2)
        inside = wavenumber < 16 / (2 * np.pi * p.radius)
        bands.append(np.array([band_levels(wavenumber[inside], row[inside])[1] for row in density]))
    half, across = p.body.shape[0] // 2, int(p.radius / p.spacing)
    lines = p.heights[half:, half - across : half + across + 1][: found.shape[1]].T
    fitted = [
        estimate_filter(
            [filter_spectra(f[2:], lines, p.spacing)], p.approaches[2:], 1.0, normalise="low-wavenumber"
        ).magnitude
        for f in (found, tight)
    ]
    return (
        largest,
        float(np.abs(bands[0] - bands[1]).max()),
        float(20 * np.abs(np.log10(fitted[0] / fitted[1])).max()),
    )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--positions", type=int, default=192)
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    problems = [problem(*case, options.positions) for case in CASES]
    tight = [p.scanned(TIGHT) for p in problems]
    worst = np.zeros((len(ASKED), 3))
    iterations = np.zeros(len(ASKED))
    seconds = np.zeros((len(ASKED), len(problems)))
    problems[0].scanned(rtol_for(FORCE_ACCURACY), single=True)  # compiles
    for j, p in enumerate(problems):
        times = np.full((len(ASKED), options.rounds), np.inf)
        for r in range(options.rounds):
            for i, (rtol, single) in enumerate(ASKED):
                began = time.process_time()
                scanned = p.scanned(rtol, single)
                times[i, r] = time.process_time() - began
                if r == 0:
                    worst[i] = np.maximum(worst[i], errors(p, scanned.forces, tight[j].forces))
                    iterations[i] += scanned.counts.iterations
        seconds[:, j] = times.min(axis=1)
    solved = sum(t.counts.solved for t in tight)
    reference = seconds[ASKED.index((1e-6, False))].sum()
    print(f"{solved} contact solutions, {len(problems)} surfaces, {options.positions} positions\n")
    columns = ["rtol", "precision", "largest error of a force", "to rtol", "of a band, dB", "of a filter, dB"]
    print("| " + " | ".join([*columns, "iterations", "time to 1e-6"]) + " |")
    print("|---:|---|---:|---:|---:|---:|---:|---:|")
    for i, (rtol, single) in enumerate(ASKED):
        force, band, fitted = worst[i]
        precision, share = "single" if single else "double", seconds[i].sum() / reference
        print(
            f"| {rtol:.0e} | {precision} | {force:.1e} | {force / rtol:.2f} | {band:.3f} | {fitted:.2f} "
            f"| {iterations[i] / solved:.1f} | {share:.2f} |"
        )
    asked = f"{FORCE_ACCURACY:g} of the force, one for filters for {FILTER_SHARE * FORCE_ACCURACY:g}"
    print(f"\nA scan asks for {asked}.")


if __name__ == "__main__":
    main()
