"""The time a person waits: whole runs of the working tree against those of a commit, in one run.

Default wheel on rail, a check of it, and the demonstration, as commands: start-up, files and report included,
kernels compiled and finished work kept by a first round. Both trees run in turn.
Printed are least wall times, with processor times of all processes and the memory of the largest; then where
the time of the default wheel goes, part after part in one process.

    python benchmarks/whole_runs.py ac0672f
    python benchmarks/whole_runs.py c551c7ce --first  # of wheel and 6205 by `table`, nothing kept but kernels
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path

ROOT = Path(__file__).parents[1]
COMMANDS = {
    "wheel, run": ["run", "wheel.toml", "-o", "wheel"],
    "wheel, check": ["check", "wheel.toml", "-o", "wheel"],
    "demo": ["demo", "-o", "demo"],
}
FIRST = {
    "wheel, table": """kind = "wheel-on-rail"
speed = "56 m/s"
laws = ["table"]
[surface]
spectrum = "iso3095"
[wheel]
roughness = "disc"
section = "straight-web"
[track]
name = "x2000"
""",
    "6205, table": """kind = "ball-bearing"
axial = "100 N"
laws = ["table"]
[bearing]
name = "6205"
[inner_raceway]
waviness = "0.5 um"
roughness = "20 nm"
[outer_raceway]
waviness = "0.5 um"
roughness = "20 nm"
""",
}
"""Cases whose scans take most of a first run, of keys that have been there since November 2026."""
PARTS = """
import json, sys, time, warnings
clock = [time.perf_counter()]
def lap(): clock.append(time.perf_counter())
warnings.simplefilter("ignore")
from asperity.case.cases import as_case  # as it was called before, too
case = as_case("wheel.toml")
from asperity.running import prepare_case, run
lap()
prepared = prepare_case(case, "wheel.toml")
lap()
import asperity
tree = run(prepared)
lap()
asperity.save(tree, "parts/run.nc")
lap()
asperity.report(tree, "parts")
lap()
names = ("start", "textures", "computing", "writing run.nc", "report")
print(json.dumps(dict(zip(names, [b - a for a, b in zip(clock, clock[1:])]))))
"""


@dataclass(frozen=True)
class Took:
    """What a command took."""

    wall: float  # s
    processor: float  # s, of all processes
    memory: float  # MiB, of the largest process


class Tree:
    """A version of the package, with a folder, kernels and kept work of its own."""

    def __init__(self, source: Path, folder: Path) -> None:
        self.folder = folder
        folder.mkdir()
        own = {
            "PYTHONPATH": source,
            "ASPERITY_KERNELS": folder / "kernels",
            "ASPERITY_CACHE": folder / "kept",
        }
        self.environment = os.environ | {name: str(value) for name, value in own.items()}
        self.environment.pop("PYTHONDONTWRITEBYTECODE", None)  # what is installed is in bytecode
        command = [sys.executable, "-m", "asperity", "new", "wheel-on-rail"]
        done = subprocess.run(command, env=self.environment, capture_output=True, check=True)
        (folder / "wheel.toml").write_bytes(done.stdout)

    def took(self, arguments: list[str]) -> Took:
        """Time a command, in a process whose children are its own alone.

        What it wrote before goes first: a finished run is not run again.
        """
        shutil.rmtree(self.folder / arguments[arguments.index("-o") + 1], ignore_errors=True)
        timed = (
            "import json, resource, subprocess, sys, time; begin = time.perf_counter(); "
            "subprocess.run([sys.executable, '-m', 'asperity', *sys.argv[1:]], check=True, "
            "stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL); wall = time.perf_counter() - begin; "
            "used = resource.getrusage(resource.RUSAGE_CHILDREN); "
            "print(json.dumps([wall, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024]))"
        )
        command = [sys.executable, "-c", timed, *arguments]
        done = subprocess.run(
            command, cwd=self.folder, env=self.environment, stdout=subprocess.PIPE, check=True
        )
        return Took(*json.loads(done.stdout))

    def took_first(self, case: str) -> Took:
        """Time a run of a case of which nothing is kept but kernels."""
        (self.folder / "first.toml").write_text(case)
        shutil.rmtree(self.folder / "kept", ignore_errors=True)
        return self.took(["run", "first.toml", "-o", "first"])

    def parts(self) -> dict[str, float]:
        """Wall time of each part of the default wheel, in one process, s."""
        begin = time.perf_counter()
        done = subprocess.run(
            [sys.executable, "-c", PARTS],
            cwd=self.folder,
            env=self.environment,
            stdout=subprocess.PIPE,
            check=True,
        )
        found: dict[str, float] = json.loads(done.stdout.splitlines()[-1])
        found["whole"] = time.perf_counter() - begin
        return found


@contextmanager
def two_trees(commit: str) -> Iterator[tuple[Tree, Tree]]:
    """The commit and the working tree."""
    with tempfile.TemporaryDirectory() as folder:
        archive = subprocess.run(["git", "archive", commit, "src"], cwd=ROOT, check=True, capture_output=True)
        subprocess.run(["tar", "-x", "-C", folder], input=archive.stdout, check=True)
        yield Tree(Path(folder) / "src", Path(folder) / "old"), Tree(ROOT / "src", Path(folder) / "new")


def main() -> None:
    """Compare."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("commit", nargs="?", default="HEAD", help="what the working tree is compared with")
    parser.add_argument("--rounds", type=int, default=3, help="rounds that count")
    parser.add_argument("--first", action="store_true", help="first runs by table alone")
    arguments = parser.parse_args()
    works: dict[str, Callable[[Tree], Took]] = {
        name: partial(Tree.took, arguments=command) for name, command in COMMANDS.items()
    }
    if arguments.first:
        works = {name: partial(Tree.took_first, case=case) for name, case in FIRST.items()}
    with two_trees(arguments.commit) as trees:
        print(f"{'':14} {arguments.commit[:10]:>28} {'here':>28}")
        print(f"{'':14} " + 2 * f"{'wall s':>9} {'cpu s':>9} {'MiB':>8} " + " ratios: wall, cpu")
        for name, work in works.items():
            found: list[list[Took]] = [[], []]
            for number in range(arguments.rounds + 1):
                for which in (0, 1) if number % 2 else (1, 0):
                    took = work(trees[which])
                    if number:
                        found[which].append(took)
            before, now = (min(rounds, key=lambda took: took.wall) for rounds in found)
            told = "".join(f"{b.wall:9.2f} {b.processor:9.2f} {b.memory:8.0f} " for b in (before, now))
            ratios = f"{now.wall / before.wall:6.2f} {now.processor / before.processor:6.2f}"
            print(f"{name:14} {told} {ratios}", flush=True)
        if arguments.first:
            return
        print(f"\n{'part, s':14} {arguments.commit[:10]:>10} {'here':>10}")
        old, new = ([tree.parts() for _ in range(2)][1] for tree in trees)
        for name, seconds in old.items():
            print(f"{name:14} {seconds:10.2f} {new[name]:10.2f}")


if __name__ == "__main__":
    main()
