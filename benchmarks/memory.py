"""Memory of whole runs: the largest process of the working tree against that of a commit, in one run.

Default wheel on rail and the demonstration, each with its report, kernels compiled and finished work kept by
a first round. Both trees run in turn, each time into a new folder; the largest of the rounds counts. Then
longer records of the wheel, by the working tree alone and without a report: how much the peak grows per
second, and how much of that is the result itself.

    python benchmarks/memory.py 34dea8e
"""

from __future__ import annotations

import argparse
import shutil

import h5py
import numpy as np
from whole_runs import Tree, two_trees

COMMANDS = {"wheel, run": ["run", "wheel.toml"], "demo": ["demo"]}


def peak(tree: Tree, arguments: list[str]) -> float:
    """Memory of the largest process of a command, MiB."""
    shutil.rmtree(tree.folder / "results", ignore_errors=True)
    return tree.took([*arguments, "-o", "results"]).memory


def result_size(tree: Tree) -> float:
    """Size of all arrays of the last result, MiB."""
    sizes = []
    with h5py.File(tree.folder / "results" / "run.nc") as file:
        file.visititems(lambda _, item: sizes.append(item.nbytes) if isinstance(item, h5py.Dataset) else None)
    return sum(sizes) / 2**20


def longer(tree: Tree, duration: float) -> list[str]:
    """Arguments that run the default wheel for a duration, s, without its report."""
    name, text = f"wheel{duration:g}.toml", (tree.folder / "wheel.toml").read_text()
    (tree.folder / name).write_text(text.replace('duration = "1 s"', f'duration = "{duration:g} s"'))
    return ["run", name, "--no-report"]


def main() -> None:
    """Compare, then lengthen."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("commit", nargs="?", default="HEAD", help="what the working tree is compared with")
    parser.add_argument("--rounds", type=int, default=3, help="rounds that count")
    parser.add_argument("--durations", type=float, nargs="*", default=[1.0, 2.0, 4.0], help="of records, s")
    arguments = parser.parse_args()
    with two_trees(arguments.commit) as trees:
        print(f"| largest process, MiB | {arguments.commit[:10]} | here | ratio |\n|---|---:|---:|---:|")
        for name, command in COMMANDS.items():
            rounds = [[peak(tree, command) for tree in trees] for _ in range(arguments.rounds + 1)][1:]
            before, here = np.max(rounds, axis=0)
            print(f"| {name} | {before:.0f} | {here:.0f} | {here / before:.2f} |", flush=True)
        print("\n| record, s | largest process, MiB | results, MiB |\n|---:|---:|---:|")
        found = []
        for duration in arguments.durations:
            command = longer(trees[1], duration)
            largest = max(peak(trees[1], command) for _ in range(arguments.rounds))
            found.append((duration, largest, result_size(trees[1])))
            print("| {:g} | {:.0f} | {:.1f} |".format(*found[-1]), flush=True)
        if len(found) > 1:
            duration, largest, held = np.array(found).T
            slopes = [np.polyfit(duration, sizes, 1)[0] for sizes in (largest, held)]
            print("\n{:.0f} MiB per second of record, of which results {:.0f}".format(*slopes))


if __name__ == "__main__":
    main()
