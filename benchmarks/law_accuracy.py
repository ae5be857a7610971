# ruff: noqa: E402 (the threads are set before numpy is imported)
"""The law accuracy map: how far every contact law, and the filters of practice, are from `direct`.

A point of the map is a texture, by its rms over Hertz's approach and its correlation length over the length
of the contact, anisotropy and Hurst exponent, under a ball or a wheel and a load. Over a few paths of it all
laws are rolled, with `direct`, the 3-D contact solved in every time step, as the reference. Finished points
are kept in the folder, so that an interrupted run goes on; a point takes about half a minute of one core.

    python benchmarks/law_accuracy.py map FOLDER           # the grid; --quick for a few of its points
    python benchmarks/law_accuracy.py aside FOLDER         # cases drawn at random: how wide the band must be
    python benchmarks/law_accuracy.py fresh FOLDER         # others, drawn afterwards: how often it holds
    python benchmarks/law_accuracy.py publish FOLDER       # data in the package; figure and tables

`--share 1/2` computes the second half of the points, so that two processes can do them.
"""

from __future__ import annotations

import os

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"

import argparse
import json
import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
from law_pages import publish
from law_points import BALL, WHEEL, Point, compute_point, place_on_map

from asperity.progress import progress_bar

QUICK = 4
"""Points of the small part."""
RANDOM = {"aside": ((1, 16, 4), (2026, 20, 2)), "fresh": ((2027, 20, 0),)}
"""Sets of random cases, those that widen the band and those that test it: seed, number, and how many of four
roll `table`. The second set was drawn to test a band from the first alone."""


def grid() -> list[Point]:
    """Points of the map, so ordered that any beginning of it covers all of it coarsely."""
    isotropic = [
        Point(BALL, roughness, length, 1.0, 30.0, scanned=roughness < 10)
        for roughness in (0.1, 1.0, 0.3, 0.03, 3.0, 10.0)
        for length in (1.0, 0.3, 3.0, 0.1, 10.0)
    ]
    wheel = [
        Point(WHEEL, r, length, 1.0, 65e3) for r in (0.1, 1.0, 0.3, 0.03, 3.0) for length in (1.0, 0.3, 3.0)
    ]
    wheel += [Point(WHEEL, r, length, 1.0, 65e3) for r in (0.1, 1.0) for length in (0.1, 10.0)]
    lay = [
        Point(BALL, r, length, ratio, 30.0, scanned=length == 1.0)
        for r in (0.1, 1.0)
        for length in (1.0, 0.3, 3.0)
        for ratio in (6.0, 1 / 6)
    ]
    lay += [Point(WHEEL, r, 1.0, ratio, 65e3) for r in (0.1, 1.0) for ratio in (6.0, 1 / 6)]
    loads = [
        Point(BALL, r, length, 1.0, p) for p in (5.0, 150.0) for r in (0.1, 1.0) for length in (0.3, 3.0)
    ]
    loads += [Point(WHEEL, 0.3, length, 1.0, p) for p in (25e3, 125e3) for length in (0.3, 3.0)]
    found: list[Point] = []
    while isotropic or wheel or lay or loads:
        for part, count in ((isotropic, 2), (wheel, 1), (lay, 1), (loads, 1)):
            found += part[:count]
            del part[:count]
    return found


def drawn(seed: int, count: int, scanned: int) -> list[Point]:
    """Cases drawn at random, balls and wheels in turn, inside the map; so many of four are scanned."""
    random, found = np.random.default_rng(seed), []
    for number in range(count):
        kind = BALL if number % 2 == 0 else WHEEL
        roughness = math.exp(random.uniform(math.log(0.03), math.log(3.0)))
        length = math.exp(random.uniform(math.log(0.15), math.log(8.0)))
        ratio = math.exp(random.uniform(-math.log(4.0), math.log(4.0))) if random.random() < 0.5 else 1.0
        load = (
            math.exp(random.uniform(math.log(5.0), math.log(150.0)))
            if kind == BALL
            else random.uniform(25e3, 125e3)
        )
        hurst = random.uniform(0.6, 1.0)
        found.append(Point(kind, roughness, length, ratio, load, hurst, scanned=number % 4 < scanned))
    return found


def points_of(part: str) -> list[tuple[int, Point]]:
    """Points of a part of the study, each with the seed of its first path."""
    if part == "map":
        return [(1 + 100 * number, point) for number, point in enumerate(grid())]
    return [
        (1 + 100 * number + 100000 * seed, point)
        for seed, count, scanned in RANDOM[part]
        for number, point in enumerate(drawn(seed, count, scanned))
    ]


def compute(part: str, folder: Path, *, quick: bool, share: str) -> None:
    """Compute the points of a part that the folder does not hold yet."""
    number, shares = map(int, share.split("/"))
    points = points_of(part)[: QUICK if quick else None][number::shares]
    folder.mkdir(parents=True, exist_ok=True)
    for done, (seed, point) in enumerate(points, 1):
        file = folder / f"{point.name}.json"
        if file.exists():
            continue
        with progress_bar() as progress:
            found = compute_point(point, seed, progress)
        file.write_text(json.dumps(found))
        print(
            f"{done} of {len(points)}: {point.name}, {found['processor']:.0f} s", file=sys.stderr, flush=True
        )


def read(part: str, folder: Path) -> list[dict[str, Any]]:
    """Finished points of a part, each path with its place on the map."""
    found = []
    for _, point in points_of(part):
        file = folder / f"{point.name}.json"
        if not file.exists():
            continue
        kept = json.loads(file.read_text())
        if "places" not in kept:
            kept["places"] = [
                place_on_map(point, kept["seed"] + number) for number in range(len(kept["paths"]))
            ]
            file.write_text(json.dumps(kept))
        found.append(kept)
    return found


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("part", choices=["map", "aside", "fresh", "publish"])
    parser.add_argument("folder", type=Path, help="where finished points are kept")
    parser.add_argument("--quick", action="store_true", help=f"the first {QUICK} points alone")
    parser.add_argument(
        "--share", default="0/1", metavar="i/n", help="every n-th point from the i-th, from 0"
    )
    options = parser.parse_args()
    if options.part != "publish":
        compute(options.part, options.folder / options.part, quick=options.quick, share=options.share)
        return
    publish({part: read(part, options.folder / part) for part in ("map", "aside", "fresh")})


if __name__ == "__main__":
    main()
