"""The processor time that a check tells of a case, next to what its run takes: cases of all kinds, in turn.

Both are commands in processes of their own. The run finds kernels that were kept before it, and no finished
work; --compiling gives each case a folder without kernels, and compares the time of compiling, too. Printed
are told and taken times, their ratio, and the parts that are told.

    python benchmarks/told_times.py
    python benchmarks/told_times.py "wheel, 5 bays" "bearing, hertz"
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
BALL = """
kind = "ball-on-beam"
laws = {laws}
start = "0.4 m"
duration = "{duration}"
settling = "50 ms"
ball = {{ load = "30 N" }}
numerics = {{ highest_frequency = "2 kHz" }}
surface = {surface}
contact = {contact}
"""
COARSE = {
    "laws": "['areal', 'shifted', 'printed', 'table', 'linear-filtered', 'linear']",
    "duration": "0.1 s",
    "surface": "{ rms = '0.05 um', longest = '0.4 mm', shortest = '80 um' }",
    "contact": "{ spacing = '40 um', window = '0.76 mm' }",
}
FINE = {
    "surface": "{ rms = '0.1 um', longest = '0.4 mm', shortest = '60 um' }",
    "contact": "{ spacing = '20 um', window = '0.8 mm' }",
}
WHEEL = """
kind = "wheel-on-rail"
laws = {laws}
duration = "{duration}"
settling = "0.1 s"
surface = {{ spectrum = "iso3095" }}
"""
BEARING = """
kind = "ball-bearing"
laws = {laws}
duration = "0.2 s"
settling = "20 ms"
axial = "100 N"
bearing = {{ name = "6205" }}
"""


def ball(more: str = "", **keys: str) -> str:
    """A ball on a beam."""
    return BALL.format(**COARSE | keys) + more


def wheel(more: str = "", laws: str = "['areal', 'linear-filtered']", duration: str = "0.3 s") -> str:
    """A wheel on a rail."""
    return WHEEL.format(laws=laws, duration=duration) + more


def bearing(laws: str, more: str = "") -> str:
    """A ball bearing."""
    return BEARING.format(laws=laws) + more


BAYS = "pad_scatter = 0.1, spacing_scatter = 0.05, ballast_scatter = 0.3"
CASES = {
    "ball, six laws": ball(),
    **{f"ball, {law}": ball(laws=f"['{law}']") for law in ("areal", "shifted", "table", "linear", "hertz")},
    "ball, table, longer": ball(laws="['table']", duration="0.3 s"),
    "ball, table, fine": ball(laws="['table']", **FINE),
    "ball, direct": ball(laws="['direct']", duration="20 ms"),
    "ball, direct, fine": ball(laws="['direct']", duration="10 ms", **FINE),
    "ball, smooth": ball(surface="{ smooth = true }"),
    "ball, shifted, longer": ball(laws="['shifted']", duration="0.5 s"),
    "wheel": wheel(),
    "wheel, linear": wheel(laws="['linear']"),
    "wheel, printed, shifted": wheel(laws="['printed', 'shifted']"),
    "wheel, table": wheel(laws="['table']", duration="0.05 s"),
    "wheel, direct": wheel(laws="['direct']", duration="20 ms"),
    "wheel, 3 s": wheel(duration="3 s"),
    "wheel, rigid": wheel("wheel = { section = 'rigid' }"),
    "wheel, uic60": wheel("track = { name = 'uic60' }"),
    "wheel, nordborg": wheel("track = { name = 'nordborg' }"),
    "wheel, 5 bays": wheel(f"track = {{ bays = 5, {BAYS} }}"),
    "wheel, 15 bays": wheel(f"track = {{ bays = 15, {BAYS} }}"),
    "wheel, scattered": wheel("numerics = { kernel = 'scatter' }", laws="['linear']"),
    "wheels, two": wheel("wheel = { positions = ['0 m', '2.5 m'] }"),
    "wheel, sideways": wheel("sideways = { contact_place = '5 mm' }"),
    **{f"bearing, {law}": bearing(f"['{law}']") for law in ("hertz", "areal", "table")},
    "bearing, three laws": bearing("['table', 'areal', 'hertz']"),
    "bearing, waves": bearing("['areal']", "inner_raceway = { waviness = '0.5 um' }"),
    "bearing, pit": bearing("['hertz']", "fault = { on = 'outer', length = '0.18 mm', depth = '0.1 mm' }"),
}


def asperity(arguments: list[str], environment: dict[str, str]) -> tuple[str, float]:
    """What a command prints, and its processor time with all its processes, s."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [sys.executable, "-W", "ignore", "-m", "asperity", *arguments]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"{' '.join(command)}\n{done.stderr}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return done.stdout, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def compared(text: str, *, compiling: bool) -> tuple[float, float]:
    """Processor time told and taken, s."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        own = {"PYTHONPATH": str(ROOT / "src"), "ASPERITY_CACHE": str(folder / "told")}
        if compiling:
            own["ASPERITY_KERNELS"] = str(folder / "kernels")
        environment = os.environ | own
        (folder / "case.toml").write_text(text)
        case = str(folder / "case.toml")
        work = json.loads(asperity(["check", case, "--json"], environment)[0])["work"]
        told = work["processor_seconds"] + work["compiling_seconds"]
        environment["ASPERITY_CACHE"] = str(folder / "taken")
        if compiling:
            environment["ASPERITY_KERNELS"] = str(folder / "other kernels")
        return told, asperity(["run", case, "-o", str(folder / "run")], environment)[1]


def main() -> None:
    """Compare and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("cases", nargs="*", help="some of the cases; all by default")
    parser.add_argument("--compiling", action="store_true", help="without kernels that are kept")
    arguments = parser.parse_args()
    names = arguments.cases or list(CASES)
    if not arguments.compiling:  # kernels of a contact and of what rolls, also of other precisions
        compared(CASES["ball, table"], compiling=False)
    print("| case | told, s | taken, s | ratio |\n|---|---:|---:|---:|")
    ratios = []
    for name in names:
        told, taken = compared(CASES[name], compiling=arguments.compiling)
        ratios.append(told / taken)
        print(f"| {name} | {told:.1f} | {taken:.1f} | {told / taken:.2f} |", flush=True)
    off = sorted(max(ratio, 1.0 / ratio) for ratio in ratios)
    within = sum(each <= 1.5 for each in off)
    print(f"\nratio {statistics.median(ratios):.2f} in the median; {within} of {len(off)} within a factor of")
    print(f"1.5, all within {off[-1]:.2f}")


if __name__ == "__main__":
    main()
