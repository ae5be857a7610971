"""What a study of speeds and loads costs next to a single run, and what its members share.

The default case of a kind is run once, then studied, each in a process of its own with an empty cache; the
kernels are compiled before. Wall time, processor time with that of child processes, the largest resident
memory of one process, and what each cache holds afterwards: what is there once was computed once.

    python benchmarks/study_cost.py wheel-on-rail
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

DEFAULTS = {
    "wheel-on-rail": ("wheel.load", "kN", [20.0, 25.0, 33.0, 40.0], [50.0, 65.0, 80.0]),
    "ball-on-beam": ("ball.load", "N", [0.5, 0.7, 1.0, 1.5], [4.0, 5.0, 8.0]),
}
"""Key of the load, its unit, speeds in m/s and loads."""


def asperity(folder: Path, cache: str, *words: str) -> tuple[float, float, float]:
    """Run the program with an empty cache; return wall and processor time, s, and largest memory, MiB."""
    variables = os.environ | {"ASPERITY_CACHE": str(folder / cache)}
    began = time.perf_counter()
    child = subprocess.Popen(
        [sys.executable, "-m", "asperity", *words], cwd=folder, env=variables, stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )  # fmt: skip
    _, status, used = os.wait4(child.pid, 0)
    if status:
        raise SystemExit(f"asperity {' '.join(words)} failed")
    return time.perf_counter() - began, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def held(folder: Path) -> Counter[str]:
    """How many results of each sort a cache holds."""
    return Counter(re.sub(r"-[0-9a-f]{64}$", "", path.stem) for path in folder.glob("*.npz"))


def lasting(case: str, duration: str) -> str:
    """A case with a record of another duration."""
    return re.sub(r"^#? *duration = .*$", f'duration = "{duration}"', case, flags=re.MULTILINE)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("kind", choices=DEFAULTS)
    parser.add_argument("--speeds", type=float, nargs="+", help="m/s")
    parser.add_argument("--loads", type=float, nargs="+", help="kN of a wheel, N of a ball")
    parser.add_argument("--duration", help="of the record, as '0.2 s'; by default that of the case")
    options = parser.parse_args()
    key, unit, speeds, loads = DEFAULTS[options.kind]
    speeds, loads = options.speeds or speeds, options.loads or loads
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        case = subprocess.run(
            [sys.executable, "-m", "asperity", "new", options.kind],
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        if options.duration:
            case = lasting(case, options.duration)
        (folder / "case.toml").write_text(case)
        (folder / "short.toml").write_text(lasting(case, "0.05 s"))
        asperity(folder, "warm", "run", "short.toml", "-o", "short")  # compiles
        single = asperity(folder, "single", "run", "case.toml", "-o", "single")
        swept = [
            "--vary", "speed = " + ", ".join(f"{v:g} m/s" for v in speeds),
            "--vary", f"{key} = " + ", ".join(f"{v:g} {unit}" for v in loads),
        ]  # fmt: skip
        study = asperity(folder, "study", "study", "case.toml", *swept, "-o", "study")
        print(f"{options.kind}, {len(speeds)} speeds × {len(loads)} loads, {os.cpu_count()} processors\n")
        print("| | wall, s | processors, s | largest process, MiB |\n|---|---:|---:|---:|")
        for what, (wall, processor, memory) in (("single run", single), ("study", study)):
            print(f"| {what} | {wall:.1f} | {processor:.1f} | {memory:.0f} |")
        print(f"| ratio | {study[0] / single[0]:.2f} | {study[1] / single[1]:.2f} | |\n")
        print("| kept | single run | study |\n|---|---:|---:|")
        one, all_of = held(folder / "single"), held(folder / "study")
        for sort in sorted(one | all_of):
            print(f"| {sort} | {one[sort]} | {all_of[sort]} |")


if __name__ == "__main__":
    main()
