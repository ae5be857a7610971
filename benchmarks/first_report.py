"""What a person waits for the first report of a fresh virtual environment, and for the second.

Installs this checkout into a new environment, with a home folder of its own: neither kernels nor fonts nor
finished work of another are found. Then runs the demo and the default wheel on the rail, each in a new home
and once again in it. Told are wall time and processor time of all processes, the wall time in which functions
were compiled, and how long that was announced to take, over how long it took: the smallest and the largest of
all announcements. With --busy other processes keep so many cores from it.

    python benchmarks/first_report.py
    python benchmarks/first_report.py --busy 1
"""

from __future__ import annotations

import argparse
import os
import re
import resource
import subprocess
import sys
import tempfile
import time
import venv
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]
WORDS = "compiled functions"
BURN = "while True: pass"


@dataclass(frozen=True)
class Waited:
    """Times of a run, s."""

    wall: float
    processor: float
    compiling: float
    expected: tuple[float, ...]  # time of all compilation, as it was announced again and again


def installed(folder: Path) -> Path:
    """Make an environment with this checkout in it; its program."""
    venv.create(folder, with_pip=True)
    programs = next(path for path in (folder / "bin", folder / "Scripts") if path.is_dir())
    subprocess.run([programs / "python", "-m", "pip", "install", "-q", str(ROOT)], check=True)
    return programs / "asperity"


def run(command: list[str], home: Path) -> Waited:
    """Run the program in a home, and listen to what it announces."""
    kept = {k: v for k, v in os.environ.items() if not k.startswith(("ASPERITY", "PYTHON", "XDG", "MPL"))}
    environment = kept | {"HOME": str(home), "TMPDIR": str(home), "USERPROFILE": str(home)}
    before, begun = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    first, last = None, begun
    left: list[tuple[float, float]] = []
    lines, done = [], False
    pipes = {"stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(command, cwd=home, env=environment, **pipes) as process:
        assert process.stderr is not None
        for line in process.stderr:
            now = time.monotonic()
            lines.append(line)
            if line.startswith(f"{WORDS} …"):
                first = first or now
            if line.startswith(f"{WORDS}: ") and not done:
                last, done = now, "100 of 100" in line
                if told := re.search(r"about (\d+) s left", line):
                    left.append((now, float(told[1])))
    if process.returncode:
        raise SystemExit("".join(lines[-20:]) + f"{' '.join(command)} failed")
    wall = time.monotonic() - begun
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    processor = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
    start = begun if first is None else first
    ends = [now - start + seconds for now, seconds in left]
    return Waited(wall, processor, last - start, tuple(ends))


def row(name: str, waited: Waited) -> str:
    """A line of the table."""
    ratios = [each / waited.compiling for each in waited.expected]
    told = f"{min(ratios):.2f} to {max(ratios):.2f}" if ratios else ""
    compiling = f"{waited.compiling:.1f}" if waited.compiling >= 0.1 else ""
    return f"| {name} | {waited.wall:.1f} | {waited.processor:.1f} | {compiling} | {told} |"


def main() -> int:
    """Install, run and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--busy", type=int, default=0, help="cores that are kept busy by others")
    parser.add_argument("--program", help="an asperity that is installed already")
    arguments = parser.parse_args()
    print("| run | wall, s | processor, s | compiling, s | announced, to taken |\n|---|---:|---:|---:|---:|")
    others = [subprocess.Popen([sys.executable, "-c", BURN]) for _ in range(arguments.busy)]
    try:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            program = arguments.program or installed(folder / "environment")
            for case in ("demo", "wheel-on-rail"):
                home = folder / case
                home.mkdir()
                command = [str(program), "demo"]
                if case != "demo":
                    text = subprocess.run([program, "new", case], check=True, capture_output=True).stdout
                    (home / "case.toml").write_bytes(text)
                    command = [str(program), "run", "case.toml", "-o", "runs"]
                print(row(f"{case}, first", run([*command, "--verbose"], home)), flush=True)
                print(row(f"{case}, again", run([*command, "--verbose"], home)), flush=True)
    finally:
        for other in others:
            other.kill()
    return 0


if __name__ == "__main__":
    sys.exit(main())
