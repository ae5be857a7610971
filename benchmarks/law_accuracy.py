# ruff: noqa: E402 (the threads are set before numpy is imported)
"""The law accuracy map: how far every contact law, and the filters of practice, are from `direct`.

A point of the map is a texture, by its rms over Hertz's approach and its correlation length over the length
of the contact, anisotropy and Hurst exponent, under a ball or a wheel and a load. Over a few paths of it all
laws are rolled, with `direct`, the 3-D contact solved in every time step, as the reference. Finished points
are kept in the folder, so that an interrupted run goes on; a point takes about half a minute of one core.

    python benchmarks/law_accuracy.py map FOLDER           # the grid; --quick for a few of its points
    python benchmarks/law_accuracy.py aside FOLDER         # cases drawn at random: how wide the band must be
    python benchmarks/law_accuracy.py fresh FOLDER         # others, drawn afterwards: how often it holds
    python benchmarks/law_accuracy.py own FOLDER           # what time step and cells change of `direct`
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
import time
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from law_pages import publish
from law_points import BALL, WHEEL, Point, compute_point, own_error, place_on_map, solved

from asperity.progress import progress_bar

QUICK = 4
"""Points of the small part."""
RANDOM = {
    "aside": (
        (3141, 48, (20.0, 28.0, 41.0, 66.0, 90.0)),
        (1618, 64, (25.0, 37.0, 53.0, 75.0)),
        (2718, 64, (22.0, 33.0, 48.0, 80.0)),
        (5772, 64, (24.0, 35.0, 50.0, 72.0)),
    ),
    "fresh": ((6007, 128, (23.0, 31.0, 46.0, 60.0, 82.0)),),
}
"""Sets of random cases, those that fill the map and set the bands and those that test these: seed, number,
and speeds of the wheels, m/s, few of them: each has a track to lay out."""
OWN = 24
"""Of the fresh cases, the first whose `direct` is rolled again with half the step and half the cells."""
SPEEDS = {BALL: (0.3, 3.0), WHEEL: (20.0, 90.0)}
"""Least and greatest speed of the map, m/s."""


def grid() -> list[Point]:
    """Points of the map, so ordered that any beginning of it covers one speed of each kind coarsely."""
    ball, wheel = partial(Point, BALL), partial(Point, WHEEL)
    isotropic = [
        ball(roughness, length, 1.0, 30.0, 1.0, scanned=roughness < 10)
        for roughness in (0.1, 1.0, 0.3, 0.03, 3.0, 10.0)
        for length in (1.0, 0.3, 3.0, 0.1, 10.0)
    ]
    wheels = [
        wheel(r, length, 1.0, 65e3, 56.0) for r in (0.1, 1.0, 0.3, 0.03, 3.0) for length in (1.0, 0.3, 3.0)
    ]
    wheels += [wheel(r, length, 1.0, 65e3, 56.0) for r in (0.1, 1.0) for length in (0.1, 10.0)]
    lay = [
        ball(r, length, ratio, 30.0, 1.0, scanned=length == 1.0)
        for r in (0.1, 1.0)
        for length in (1.0, 0.3, 3.0)
        for ratio in (6.0, 1 / 6)
    ]
    lay += [wheel(r, 1.0, ratio, 65e3, 56.0) for r in (0.1, 1.0) for ratio in (6.0, 1 / 6)]
    loads = [ball(r, length, 1.0, p, 1.0) for p in (5.0, 150.0) for r in (0.1, 1.0) for length in (0.3, 3.0)]
    loads += [wheel(0.3, length, 1.0, p, 56.0) for p in (25e3, 125e3) for length in (0.3, 3.0)]
    speeds = [
        Point(kind, r, length, 1.0, load, speed)
        for r, length in ((0.1, 1.0), (1.0, 0.3), (0.1, 0.3), (1.0, 3.0), (0.1, 3.0), (0.03, 1.0), (3.0, 1.0))
        for kind, load in ((BALL, 30.0), (WHEEL, 65e3))
        for speed in SPEEDS[kind]
    ]
    found: list[Point] = []
    while isotropic or wheels or lay or loads:
        for part, count in ((isotropic, 2), (wheels, 1), (lay, 1), (loads, 1)):
            found += part[:count]
            del part[:count]
    return found + speeds


def drawn(seed: int, count: int, speeds: Sequence[float]) -> list[Point]:
    """Cases drawn at random, balls and wheels in turn, inside the map; half of them are scanned."""
    random, found = np.random.default_rng(seed), []

    def between(low: float, high: float) -> float:
        return math.exp(random.uniform(math.log(low), math.log(high)))

    for number in range(count):
        kind = BALL if number % 2 == 0 else WHEEL
        found.append(
            Point(
                kind,
                roughness=between(0.03, 3.0),
                correlation=between(0.15, 8.0),
                anisotropy=between(0.25, 4.0) if random.random() < 0.5 else 1.0,
                load=between(5.0, 150.0) if kind == BALL else random.uniform(25e3, 125e3),
                speed=between(*SPEEDS[kind]) if kind == BALL else float(random.choice(speeds)),
                hurst=random.uniform(0.5, 1.0),
                finest=between(0.4, 1.5),
                scanned=number % 4 < 2,
            )
        )
    return found


def points_of(part: str) -> list[tuple[int, Point]]:
    """Points of a part of the study, each with the seed of its first path."""
    if part == "map":
        return [(1 + 100 * number, point) for number, point in enumerate(grid())]
    return [
        (1 + 100 * number + 100000 * seed, point)
        for seed, count, speeds in RANDOM[part]
        for number, point in enumerate(drawn(seed, count, speeds))
    ]


def compute_own(options: argparse.Namespace) -> None:
    """Roll `direct` of the first fresh cases again, on finer steps and cells."""
    number, shares = map(int, options.share.split("/"))
    folder = options.folder / "own"
    folder.mkdir(parents=True, exist_ok=True)
    for seed, point in points_of("fresh")[:OWN][number::shares]:
        file = folder / f"{point.name}.json"
        if not file.exists():
            with progress_bar() as progress:
                error = own_error(point, seed, options.folder, progress)
            file.write_text(json.dumps({"point": point.name, **error}))
            print(f"{point.name}: {error}", file=sys.stderr, flush=True)


def read_own(folder: Path) -> dict[str, dict[str, float]]:
    """What step and cells change of `direct`, dB, by the name of the point."""
    found = [json.loads(file.read_text()) for file in sorted(folder.glob("*.json"))]
    return {error["point"]: error for error in found}


def compute(options: argparse.Namespace) -> None:
    """Compute the points of a part that the folder does not hold yet, or what `direct` gives of them."""
    number, shares = map(int, options.share.split("/"))
    points = points_of(options.part)[: QUICK if options.quick else None][number::shares]
    folder, direct = options.folder / options.part, options.folder / "direct"
    folder.mkdir(parents=True, exist_ok=True)
    for done, (seed, point) in enumerate(points, 1):
        began, file = time.process_time(), folder / f"{point.name}.json"
        if file.exists():
            continue
        with progress_bar() as progress:
            if options.direct:
                for path in range(point.seeds):
                    solved(point, seed + path, direct, progress)
            else:
                file.write_text(json.dumps(compute_point(point, seed, direct, progress)))
        words = f"{done} of {len(points)}: {point.name}, {time.process_time() - began:.0f} s"
        print(words, file=sys.stderr, flush=True)


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
    parser.add_argument("part", choices=["map", "aside", "fresh", "own", "publish"])
    parser.add_argument("folder", type=Path, help="where finished points are kept")
    parser.add_argument("--quick", action="store_true", help=f"the first {QUICK} points alone")
    parser.add_argument(
        "--share", default="0/1", metavar="i/n", help="every n-th point from the i-th, from 0"
    )
    parser.add_argument("--direct", action="store_true", help="`direct` alone; its forces are kept")
    options = parser.parse_args()
    if options.part == "own":
        compute_own(options)
        return
    if options.part != "publish":
        compute(options)
        return
    parts = {part: read(part, options.folder / part) for part in ("map", "aside", "fresh")}
    publish(parts, read_own(options.folder / "own"))


if __name__ == "__main__":
    main()
