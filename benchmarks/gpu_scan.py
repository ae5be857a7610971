"""Time a scan solved in batches on a GPU against the same scan on all cores of the processor.

A ball moves over a rough surface; the 3-D contact is solved at every position and approach, to a relative
tolerance of 1e-8. Wall time, best of the rounds; compilation, plans of transforms and the first batch are
left out by a run before. The GPU solves whole blocks of positions, the processor fewer of them, on one thread
and on all its cores; solutions per second are compared, and the forces of the positions that both solved.

    pip install 'asperity[gpu]'
    python benchmarks/gpu_scan.py
    python benchmarks/gpu_scan.py --cells 64 128 256 --positions 4096 --rtol 1e-6
    python benchmarks/gpu_scan.py --device numpy --positions 64   # tries the script without a GPU
"""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

import asperity
from asperity import HalfSpace, Hertz
from asperity.contact.batched import Device, gpu, processor
from asperity.contact.scan import BLOCK, ScanJob, scan_forces
from asperity.errors import InputError
from asperity.kernels.batched import convolve_padded, padded_spectrum
from asperity.surfaces.strip import Rows
from asperity.surfaces.synthesis import self_affine

MODULUS = 115e9  # Pa, steel on steel
RADIUS = 25e-3  # m
LOAD = 10.0  # N, of the smooth ball
AGREEMENT = 1e-6  # relative, of the forces


@dataclass(frozen=True)
class Problem:
    """A surface, a body and the approaches at which it moves."""

    heights: np.ndarray
    body: np.ndarray
    spacing: tuple[float, float]
    approaches: np.ndarray
    stride: int

    def job(self, positions: int, rtol: float, device: Device | None) -> ScanJob:
        """Scan of the first positions."""
        half_space = HalfSpace(self.body.shape, self.spacing, MODULUS)
        rows = Rows(self.heights[: (positions - 1) * self.stride + len(self.body)])
        return ScanJob(half_space, rows, self.body, self.approaches, self.stride, rtol, device=device)


def problem(cells: int, options: argparse.Namespace) -> Problem:
    """Build the surface and the body; the roughness has the same wavelengths on every grid."""
    hertz = Hertz(MODULUS, RADIUS, RADIUS)
    approach = hertz.approach(LOAD)
    radius = hertz.semi_axes(approach)[0]
    spacing = 2 * radius / options.radius_share / cells
    stride = max(1, round(radius / 8 / spacing))
    x = (np.arange(cells) - cells // 2) * spacing
    heights = self_affine(
        (cells + (options.positions - 1) * stride, cells),
        (spacing, spacing),
        rms=options.rms * approach,
        hurst=0.8,
        longest=1.4 * radius,
        shortest=0.36 * radius,
        seed=1,
    ).heights
    body = (x[:, None] ** 2 + x[None, :] ** 2) / (2 * RADIUS)
    share = (np.arange(options.approaches) + 1) / options.approaches
    return Problem(np.asarray(heights), body, (spacing, spacing), share * approach, stride)


def on_device(p: Problem, positions: int, rtol: float, device: Device) -> tuple[np.ndarray, float]:
    """Scan on the device; forces, and iterations of a solution."""
    found = scan_forces(p.job(positions, rtol, device))
    assert not found.counts.unconverged, "solutions that did not converge"
    return found.forces, found.counts.iterations / found.forces.size


def on_cores(p: Problem, positions: int, rtol: float, workers: int) -> np.ndarray:
    """Scan as the reduction does; forces."""
    return scan_forces(p.job(positions, rtol, None), workers=workers).forces


def best(task: Callable[[], object], rounds: int) -> float:
    """Shortest wall time of some rounds, s, after one that does not count."""
    task()
    seconds = []
    for _ in range(rounds):
        began = time.perf_counter()
        task()
        seconds.append(time.perf_counter() - began)
    return min(seconds)


def transform_time(cells: int, members: int, rounds: int, device: Device) -> float:
    """Wall time of one convolution per member on half the window, the usual size of the overlap, s."""
    xp, n = device.xp, cells // 2
    spectrum = xp.asarray(padded_spectrum(np.ones((n, n)), n, n))
    field = xp.ones((members, n, n))
    repeats = 20

    def convolutions() -> None:
        for _ in range(repeats):
            found = convolve_padded(field, spectrum, xp)
        device.to_host(found[0, 0, 0])  # waits for the device

    return best(convolutions, rounds) / repeats / members


def report(cells: int, options: argparse.Namespace, device: Device) -> None:
    """Measure one grid and print its table in Markdown."""
    p, cores = problem(cells, options), options.workers
    sizes = {"device": options.positions, "cores": min(options.positions, options.cpu_positions)}
    forces, iterations = on_device(p, sizes["device"], options.rtol, device)
    reference = on_cores(p, sizes["cores"], options.rtol, cores)
    k = len(p.approaches)
    seconds = {
        device.name: best(lambda: on_device(p, sizes["device"], options.rtol, device), options.rounds)
        / (k * sizes["device"]),
        f"processor, {cores} cores": best(
            lambda: on_cores(p, sizes["cores"], options.rtol, cores), options.rounds
        )
        / (k * sizes["cores"]),
        "processor, one thread": best(lambda: on_cores(p, sizes["cores"], options.rtol, 1), options.rounds)
        / (k * sizes["cores"]),
    }
    print(
        f"\n{cells} x {cells} cells, {k} approaches, tolerance {options.rtol:g}; "
        f"{sizes['device']} positions on the device, {sizes['cores']} on the processor\n"
    )
    print("| where | solutions per second | ms per solution | device to it |")
    print("|---|---:|---:|---:|")
    first = seconds[device.name]
    for name, each in seconds.items():
        print(f"| {name} | {1 / each:.0f} | {1e3 * each:.4f} | {each / first:.2f} |")
    transform = transform_time(cells, min(sizes["device"], 1024), options.rounds, device)
    print(
        f"\n{iterations:.1f} iterations per solution, {1e6 * first / iterations:.2f} us each; "
        "the transforms of one ",
        end="",
    )
    print(f"convolution on half the window take {1e6 * transform:.2f} us.")
    both = forces[:, : sizes["cores"]]
    worst = float(np.max(np.abs(both / reference - 1.0)[reference > 0.0], initial=0.0))
    verdict = "agree" if worst <= AGREEMENT else "DO NOT agree"
    print(f"Forces {verdict} to {AGREEMENT:g} (at worst {worst:.1e}).")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--cells", type=int, nargs="+", default=[64, 128, 256], help="cells along the window")
    parser.add_argument("--positions", type=int, default=4096, help="on the device")
    parser.add_argument("--cpu-positions", type=int, default=2 * BLOCK, help="on the processor")
    parser.add_argument("--approaches", type=int, default=10)
    parser.add_argument("--radius-share", type=float, default=0.35, help="contact radius in half windows")
    parser.add_argument("--rms", type=float, default=0.1, help="rms roughness in approaches")
    parser.add_argument("--rtol", type=float, default=1e-8)
    parser.add_argument("--workers", type=int, default=len(os.sched_getaffinity(0)), help="cores to use")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--device", choices=["gpu", "numpy"], default="gpu")
    options = parser.parse_args()
    try:
        device = gpu() if options.device == "gpu" else processor()
    except InputError as error:
        parser.error(str(error))
    print(f"asperity {asperity.__version__}; {device.name}")
    for cells in options.cells:
        report(cells, options, device)


if __name__ == "__main__":
    main()
