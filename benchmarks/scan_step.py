# ruff: noqa: E402 (the threads are set before numpy is imported)
"""Time a step of the contact scan against slippy, aspher, tamaas and ContactMechanics.

A ball moves over a rough surface in 64 positions at one prescribed approach (or, with ``--loading``, is
pressed on it in 30 approaches); at each the 3-D contact (elastic half-space, free boundary) is solved to a
relative tolerance of 1e-8. Compared are asperity's scan (each contact from those before it), its cold
solutions, and the same contacts solved by the peers: cold from Hertz's pressure of the smooth ball, warm
from the previous contact, on request from their own start. ``--cropped`` hands all codes the smallest square
window that holds the overlap at all contacts. One thread each, CPU time, set-up of the kernel included,
compilation and imports not; the codes take turns in every round, and medians over the rounds count. Forces
are compared with asperity's cold ones.

    benchmarks/peers.sh FOLDER
    python benchmarks/scan_step.py --peers-python FOLDER/bin/python
"""

from __future__ import annotations

import os

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[variable] = "1"

import argparse
import subprocess
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import asperity
from asperity import HalfSpace, Hertz
from asperity.contact.scan import ScanJob, scan_forces
from asperity.surfaces.strip import Rows
from asperity.surfaces.synthesis import self_affine

MODULUS = 115e9  # Pa, steel on steel
RADIUS = 25e-3  # m
LOAD = 10.0  # N, of the smooth ball
AGREEMENT = 1e-6  # relative, of the forces
PEER_RUNS = [
    ("slippy", "cold", "slippy, cold"),
    ("slippy", "warm", "slippy, warm"),
    ("aspher", "warm", "aspher, secant on the load, warm"),
    ("aspher", "load", "aspher, load known beforehand, cold"),
    ("tamaas", "cold", "tamaas, secant on the load, cold"),
    ("tamaas", "warm", "tamaas, secant on the load, warm"),
    ("tamaas", "load", "tamaas, load known beforehand, cold"),
    ("ContactMechanics", "cold", "ContactMechanics, cold"),
    ("ContactMechanics", "warm", "ContactMechanics, warm"),
]
OWN_STARTS = [
    ("tamaas", "own", "tamaas, secant on the load, its own start"),
    ("ContactMechanics", "own", "ContactMechanics, its own start"),
]


@dataclass
class Measured:
    """What one code did in all rounds."""

    seconds: list[float]
    forces: np.ndarray
    residual: np.ndarray
    failed: np.ndarray


Run = tuple[float, np.ndarray, np.ndarray, np.ndarray]  # seconds, then force, residual, failure by position


def problem(cells: int, options: argparse.Namespace) -> dict[str, np.ndarray]:
    """Build the surface and the body; the roughness has the same wavelengths on every grid."""
    hertz = Hertz(MODULUS, RADIUS, RADIUS)
    approach = hertz.approach(LOAD)
    radius = hertz.semi_axes(approach)[0]
    window = 2 * radius / options.radius_share
    spacing = window / cells
    stride = options.stride or max(1, round(radius / 8 / spacing))
    x = (np.arange(cells) - cells // 2) * spacing
    length = cells + (0 if options.loading else (options.positions - 1) * stride)
    heights = self_affine(
        (length, cells),
        (spacing, spacing),
        rms=options.rms * approach,
        hurst=0.8,
        longest=1.4 * radius,
        shortest=0.36 * radius,
        seed=1,
    ).heights
    steps = np.arange(options.loading or options.positions)
    shares = (steps + 1.0) / options.loading if options.loading else np.ones(len(steps))
    body = (x[:, None] ** 2 + x[None, :] ** 2) / (2 * RADIUS)
    p = {
        "heights": np.asarray(heights),
        "body": body,
        "spacing": np.array(spacing),
        "modulus": np.array(MODULUS),
        "approaches": approach * shares,
        "smooth_force": np.array(LOAD),
        "offsets": steps * (0 if options.loading else stride),
        "rtol": np.array(options.rtol),
        "forces": np.zeros(len(steps)),
    }
    return cropped(p) if options.cropped else p


def cropped(p: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Cut the smallest square window that holds the overlap at all contacts; its side is even."""
    n = len(p["body"])
    gaps = np.array([p["body"] - p["heights"][m : m + n] for m in p["offsets"]])
    overlap = (gaps < p["approaches"].max()).any(axis=0)
    used = [np.flatnonzero(overlap.any(axis=axis)) for axis in (1, 0)]
    side = max(int(u[-1] - u[0]) + 1 for u in used)
    side += side % 2
    i, j = (min(int(u[0]), n - side) for u in used)
    rows = len(p["heights"]) - n + side
    return p | {
        "heights": np.ascontiguousarray(p["heights"][i : i + rows, j : j + side]),
        "body": np.ascontiguousarray(p["body"][i : i + side, j : j + side]),
    }


def scanned(p: dict[str, np.ndarray]) -> Run:
    """Scan as the reduction does: warm-started, one thread."""
    loading = not p["offsets"].any()
    began = time.process_time()
    job = ScanJob(
        HalfSpace(p["body"].shape, float(p["spacing"]), MODULUS),
        Rows(p["heights"]),
        p["body"],
        p["approaches"] if loading else p["approaches"][:1],
        stride=int(p["offsets"][1]) or 1,
        rtol=float(p["rtol"]),
    )
    result = scan_forces(job, workers=1)
    seconds, unknown = time.process_time() - began, np.full(len(p["forces"]), np.nan)
    return seconds, result.forces.ravel(), unknown, np.arange(len(unknown)) < result.counts.unconverged


def cold(p: dict[str, np.ndarray]) -> Run:
    """Solve every contact from nothing."""
    rows = len(p["body"])
    began = time.process_time()
    half_space = HalfSpace(p["body"].shape, (float(p["spacing"]),) * 2, MODULUS)
    contacts = [
        half_space.solve(
            p["body"] - p["heights"][m : m + rows], approach=float(approach), rtol=float(p["rtol"])
        )
        for m, approach in zip(p["offsets"], p["approaches"], strict=True)
    ]
    seconds = time.process_time() - began
    failed = np.array([not c.converged for c in contacts])
    return seconds, np.array([c.force for c in contacts]), np.array([c.residual for c in contacts]), failed


def by_peer(python: str, peer: str, start: str, p: dict[str, np.ndarray]) -> tuple[Run, str]:
    """Hand the problem to a peer's interpreter; `RuntimeError` with its last words if it cannot."""
    worker = Path(__file__).with_name("peers_worker.py")
    with tempfile.TemporaryDirectory() as folder:
        source, target = Path(folder) / "problem.npz", Path(folder) / "result.npz"
        np.savez(source, **p)
        done = subprocess.run(
            [python, str(worker), peer, start, str(source), str(target)], capture_output=True, text=True
        )
        if done.returncode:
            raise RuntimeError((done.stderr.strip() or "no message").splitlines()[-1])
        with np.load(target, allow_pickle=False) as result:
            run = (float(result["seconds"]), result["forces"], result["residual"], result["failed"])
            return run, str(result["version"])


def measure(p: dict[str, np.ndarray], options: argparse.Namespace) -> tuple[dict[str, Measured], list[str]]:
    """Let the codes take turns; return what they did, and what could not be done."""
    measured: dict[str, Measured] = {}
    notes = [f"asperity {asperity.__version__}"]

    def add(name: str, run: Run) -> None:
        measured.setdefault(name, Measured([], *run[1:])).seconds.append(run[0])

    scanned(p), cold(p)  # compiles
    python, peers = options.peers_python, PEER_RUNS + (OWN_STARTS if options.own_starts else [])
    peers = [run for run in peers if not options.peers or run[0] in options.peers]
    if not python:
        peers = []
        notes.append("no peers: make their environment with peers.sh and name it with --peers-python")
    for _ in range(options.rounds):
        add("asperity, scan (warm)", scanned(p))
        add("asperity, cold", cold(p))
        p["forces"] = measured["asperity, cold"].forces
        for peer, start, name in list(peers):
            try:
                run, version = by_peer(python, peer, start, p)
            except (RuntimeError, OSError) as error:
                notes.append(f"{name}: not measured ({error})")
                peers.remove((peer, start, name))
                continue
            add(name, run)
            if f"{peer} {version}" not in notes:
                notes.append(f"{peer} {version}")
    return measured, notes


def report(p: dict[str, np.ndarray], measured: dict[str, Measured], notes: list[str]) -> None:
    """Print the table in Markdown."""
    cells, positions = p["body"].shape[0], len(p["forces"])
    stride = int(p["offsets"][1])
    kind = f"positions, stride {stride}" if stride else "approaches"
    print(
        f"\n{positions} {kind}, {cells} x {cells} cells, tolerance {float(p['rtol']):g}, one thread, CPU time"
    )
    print("; ".join(notes) + "\n")
    print("| code | ms per solve | to the scan | to cold | accuracy | failed | largest difference of force |")
    print("|---|---:|---:|---:|---:|---:|---:|")
    reference = measured["asperity, cold"]
    per_scan = np.array(measured["asperity, scan (warm)"].seconds)
    worst = 0.0
    for name, entry in measured.items():
        seconds, solved = np.array(entry.seconds), ~entry.failed
        difference = float(np.max(np.abs(entry.forces / reference.forces - 1.0)[solved], initial=0.0))
        worst = max(worst, difference)
        to_scan = np.median(seconds / per_scan[: len(seconds)])
        to_cold = np.median(seconds / np.array(reference.seconds)[: len(seconds)])
        reached = float(np.max(entry.residual[solved], initial=0.0))
        accuracy = "" if np.isnan(reached) else f"{reached:.1e}"
        print(
            f"| {name} | {1e3 * np.median(seconds) / positions:.2f} | {to_scan:.1f} | {to_cold:.1f} "
            f"| {accuracy} | {entry.failed.sum()} | {difference:.1e} |"
        )
    verdict = "agree" if worst <= AGREEMENT else "DO NOT agree"
    print(f"\nForces of all solutions that did not fail {verdict} to {AGREEMENT:g} (at worst {worst:.1e}).")
    print("Accuracy: largest complementarity residual relative to the largest overlap.")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--cells", type=int, nargs="+", default=[128], help="cells along the window")
    parser.add_argument("--positions", type=int, default=64)
    parser.add_argument("--loading", type=int, default=0, metavar="N", help="one position, N approaches")
    parser.add_argument("--cropped", action="store_true", help="hand all codes the window of the overlap")
    parser.add_argument("--peers", nargs="+", help="these peers only")
    parser.add_argument("--radius-share", type=float, default=0.35, help="contact radius in half windows")
    parser.add_argument("--rms", type=float, default=0.1, help="rms roughness in approaches")
    parser.add_argument("--stride", type=int, help="rows between positions; default an eighth of the radius")
    parser.add_argument("--rtol", type=float, default=1e-8)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--peers-python", metavar="PATH", help="interpreter that has the peers")
    parser.add_argument(
        "--own-starts", action="store_true", help="measure the peers from their own start too (slow)"
    )
    options = parser.parse_args()
    for cells in options.cells:
        p = problem(cells, options)
        measured, notes = measure(p, options)
        report(p, measured, notes)


if __name__ == "__main__":
    main()
