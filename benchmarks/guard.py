"""Say what became slower: the working tree against a commit, piece by piece, in one run.

Both roll the same cases in turn, the one that begins changing from round to round, in processes that stay:
kernels are compiled in a first round, which does not count. The progress that a run reports tells its pieces
apart: pressing samples, scanning, rolling. Compared is the least processor time of each piece over the
rounds, of twice as many where a piece looks slower; what takes more than a tenth longer than before is
listed again below, and the exit code is then 1.

    python benchmarks/guard.py HEAD~1
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Mapping
from pathlib import Path

ROOT = Path(__file__).parents[1]
CASES = {
    "ball": {
        "kind": "ball-on-beam",
        "laws": ["areal", "shifted", "table", "linear-filtered"],
        "start": "0.2 m",
        "duration": "0.2 s",
        "settling": "50 ms",
        "surface": {"rms": "0.1 um", "longest": "0.4 mm", "shortest": "80 um"},
        "ball": {"load": "30 N"},
        "contact": {"spacing": "40 um", "window": "0.76 mm", "samples": 3},
        "numerics": {"highest_frequency": "2 kHz"},
    },
    "ball, direct": {
        "kind": "ball-on-beam",
        "laws": ["direct"],
        "start": "0.2 m",
        "duration": "10 ms",
        "settling": "5 ms",
        "surface": {"rms": "0.1 um", "longest": "0.4 mm", "shortest": "50 um"},
        "ball": {"load": "60 N"},
        "contact": {"spacing": "25 um", "window": "1.1 mm", "samples": 1},
    },
    "wheel": {
        "kind": "wheel-on-rail",
        "laws": ["areal", "shifted", "linear-filtered", "linear"],
        "duration": "0.5 s",
        "surface": {"spectrum": "iso3095"},
    },
    "bearing": {
        "kind": "ball-bearing",
        "speed": "1800 1/min",
        "radial": "100 N",
        "laws": ["hertz", "table"],
        "duration": "50 ms",
        "settling": "10 ms",
        "bearing": {"name": "6205"},
        "fault": {"on": "outer", "length": "0.18 mm", "depth": "0.1 mm"},
    },
    "creep": {
        "kind": "wheel-on-rail",
        "speed": "10 m/s",
        "laws": ["linear"],
        "duration": "0.2 s",
        "settling": "50 ms",
        "surface": {"spectrum": "iso3095"},
        "wheel": {"section": "rigid"},
        "contact": {"spacing": "1 mm", "samples": 2},
        "numerics": {"highest_frequency": "2 kHz"},
        "creep": {"angle_of_attack": "8 mrad", "kinetic": 0.5, "falling_velocity": "1 m/s"},
    },
}
"""By name; of public keys that both trees know."""
ALLOWED = 1.1
"""Ratio of the times from which on a piece has become slower."""
LEAST = 0.05
"""Pieces that take less are not judged, s: clocks and caches weigh more than they."""
Times = dict[str, float]


def timed(case: Mapping[str, object]) -> Times:
    """Processor time of each piece of a run, s: of all threads, between reports of one message."""
    import asperity

    spent: Times = defaultdict(float)
    last = time.process_time()

    def mark(done: int, total: int, message: str) -> None:
        nonlocal last
        now = time.process_time()
        spent[message.partition(":")[0]] += now - last
        last = now

    asperity.run(dict(case), progress=mark)
    spent["whole run"] = sum(spent.values()) + time.process_time() - last
    return dict(spent)


def work() -> None:
    """Time the cases whose names arrive, each without what an earlier round has kept."""
    import warnings

    warnings.simplefilter("ignore")
    for line in sys.stdin:
        with tempfile.TemporaryDirectory() as cache:
            os.environ["ASPERITY_CACHE"] = cache
            print(json.dumps(timed(CASES[line.strip()])), flush=True)


class Tree:
    """A version of the package, and a process that runs it."""

    def __init__(self, source: Path, kernels: Path) -> None:
        environment = os.environ | {"PYTHONPATH": str(source), "ASPERITY_KERNELS": str(kernels)}
        command = [sys.executable, __file__, "--work"]
        self.process = subprocess.Popen(
            command, env=environment, text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE
        )

    def time(self, case: str) -> Times:
        """Let it run a case."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        self.process.stdin.write(f"{case}\n")
        self.process.stdin.flush()
        line = self.process.stdout.readline()
        if not line:
            raise SystemExit(f"{case}: the process ended; this commit does not know the case, or it failed")
        found: Times = json.loads(line)
        return found


def least(rounds: list[Times]) -> Times:
    """The least time of each piece that is in all rounds."""
    names = set.intersection(*(set(times) for times in rounds))
    return {name: min(times[name] for times in rounds) for name in sorted(names)}


def ratios(before: Times, after: Times) -> dict[str, float]:
    """Time of each piece over that before, of those long enough to be judged."""
    return {n: after[n] / before[n] for n in before if n in after and max(before[n], after[n]) >= LEAST}


def rolled_in_turn(trees: list[Tree], case: str, rounds: int) -> tuple[Times, Times]:
    """Least times of a case with both trees; twice as many rounds before a piece is called slower."""
    found: list[list[Times]] = [[], []]
    for tree in trees:  # compiles its kernels
        tree.time(case)
    for number in range(2 * rounds):
        if number == rounds and max(ratios(*map(least, found)).values(), default=0.0) <= ALLOWED:
            break
        for which in (0, 1) if number % 2 else (1, 0):
            found[which].append(trees[which].time(case))
    return least(found[0]), least(found[1])


def compare_trees(commit: str, rounds: int) -> int:
    """Print all ratios, and what became slower; return the exit code."""
    slower = []
    with tempfile.TemporaryDirectory() as folder:
        archive = subprocess.run(["git", "archive", commit, "src"], cwd=ROOT, check=True, capture_output=True)
        subprocess.run(["tar", "-x", "-C", folder], input=archive.stdout, check=True)
        trees = [
            Tree(source, Path(folder) / name)
            for source, name in ((Path(folder) / "src", "old"), (ROOT / "src", "new"))
        ]
        print(f"{'case':14} {'piece':38} {commit[:12]:>12} {'here':>9} {'ratio':>6}")
        for case in CASES:
            before, after = rolled_in_turn(trees, case, rounds)
            for name, ratio in ratios(before, after).items():
                print(f"{case:14} {name:38} {before[name]:10.3f} s {after[name]:7.3f} s {ratio:6.2f}")
                if ratio > ALLOWED:
                    slower.append(f"{case}, {name}: {ratio:.2f} times")
        for tree in trees:
            tree.process.communicate()
    print("slower than before: " + ("; ".join(slower) or "nothing"))
    return 1 if slower else 0


def main() -> int:
    """Compare, or be one of those compared."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("commit", nargs="?", default="HEAD", help="what the working tree is compared with")
    parser.add_argument("--rounds", type=int, default=5, help="rounds that count")
    parser.add_argument("--work", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.work:
        work()
        return 0
    return compare_trees(arguments.commit, max(arguments.rounds, 1))


if __name__ == "__main__":
    sys.exit(main())
