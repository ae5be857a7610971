# ruff: noqa: E402 (the threads are set before numpy is imported)
"""Time a second of a roller bearing by slices, next to the same with finer time steps: time, memory, levels.

An NU205 under 2 kN at 1800 1/min, 26 contacts, waviness of 0.2 µm on both raceways; the whole run in a fresh
process each, after a short one that loads the kernels. CPU time of one thread; memory of the process at its
largest, and beyond what it had before; velocities in the three bands.

    python benchmarks/roller_second.py --duration 1
"""

from __future__ import annotations

import os

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"

import argparse
import multiprocessing
import resource
import tempfile
import time
import warnings

CASE = {
    "kind": "roller-bearing",
    "speed": "1800 1/min",
    "radial": "2 kN",
    "bearing": {"name": "NU205"},
    "inner_raceway": {"waviness": "0.2 um"},
    "outer_raceway": {"waviness": "0.2 um"},
}
STEPS = (None, "1.4 us", "0.7 us")
"""Time steps: that which the case chooses, and finer ones."""


def peak() -> float:
    """Largest memory of this process so far, MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def second(step: str | None, duration: float) -> str:
    """A row of the table."""
    import asperity
    from asperity.case.cases import as_case

    warnings.simplefilter("ignore")
    chosen = {} if step is None else {"time_step": step}
    case = as_case(CASE | chosen | {"duration": duration})
    short = case.with_(duration="30 ms", settling="1 ms", speed="6000 1/min")
    asperity.run(short, brief=True)
    before, began = peak(), time.process_time()
    found = asperity.run(case, brief=True)
    taken = time.process_time() - began
    bands = found["bearing"].dataset.band_velocity.values[0, 0]
    levels = ", ".join(f"{1e6 * each:.3f}" for each in bands)
    return f"| {case.step * 1e6:.2f} | {taken:.1f} | {peak():.0f} | {peak() - before:.0f} | {levels} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--duration", type=float, default=1.0)
    chosen = parser.parse_args()
    kept = tempfile.TemporaryDirectory()  # else a second benchmark would take up what the first one kept
    os.environ["ASPERITY_CACHE"] = kept.name
    print("| time step, µs | CPU, s | memory, MB | of the run, MB | bands, µm/s |\n|---:|---:|---:|---:|---|")
    spawn = multiprocessing.get_context("spawn")
    for step in STEPS:
        with spawn.Pool(1) as pool:
            print(pool.apply(second, (step, chosen.duration)), flush=True)
    kept.cleanup()


if __name__ == "__main__":
    main()
