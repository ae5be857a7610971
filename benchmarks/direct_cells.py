"""`direct` on nearly smooth balls, with 6, 9 and 12 cells in the half-width of the contact against 24.

A ball rolls over a texture of a twohundredth of its approach rms, so that the force varies by some per cent.
Compared are one-third-octave levels of the force, 100 Hz to 5 kHz, of cells that are whole and of those that
count as far as they are covered; the reference are 24 covered ones. With ``--table`` the law `table` beside
`direct`, on grids of the same cells.

    python benchmarks/direct_cells.py --textures 4
    python benchmarks/direct_cells.py --textures 4 --table
"""

import argparse
import os
import tempfile
from unittest.mock import patch

import numpy as np

from asperity.case.cases import parse_case
from asperity.running import prepare_case
from asperity.scenes.compute import compute
from asperity.spectra import band_levels, psd

LOAD = 10.0  # N
SHARE = 0.005  # rms of the texture over the approach
SETTLED = 0.02  # s, of the record, that do not count
CASE = """
kind = "ball-on-beam"
laws = {laws}
seed = {seed}
start = "0.4 m"
duration = "0.08 s"
[surface]
rms = "{rms} um"
longest = "0.6 mm"
shortest = "{shortest} um"
[ball]
load = "{load} N"
[contact]
spacing = "{spacing} um"
window = "{window} mm"
samples = 2
rim_cells = "{cells}"
"""


def levels(cells: str, across: int, seed: int, laws: list[str]) -> list[np.ndarray]:
    """One-third-octave levels of the force, dB, of each law."""
    any_grid = {
        "laws": '["hertz"]',
        "seed": 1,
        "rms": 1,
        "shortest": 100,
        "spacing": 10,
        "window": 1,
        "cells": cells,
    }
    hertz = parse_case(CASE.format(**any_grid, load=LOAD)).smooth_contact
    approach = hertz.approach(LOAD)
    half_width = hertz.semi_axes(approach)[0]
    numbers = {"rms": SHARE * approach * 1e6, "shortest": 0.8 * half_width * 1e6, "load": LOAD}
    grid = {"spacing": half_width / across * 1e6, "window": 2.6 * half_width * 1e3, "cells": cells}
    names = "[" + ", ".join(f'"{law}"' for law in laws) + "]"
    case = CASE.format(laws=names, seed=seed, **numbers, **grid)
    with tempfile.TemporaryDirectory() as folder, patch.dict(os.environ, ASPERITY_CACHE=folder):
        computed = compute(prepare_case(parse_case(case)), lambda *_: None)
    found = []
    for law in laws:
        run, step = computed.runs[law], computed.case.time_step
        force = run.contact_force[0][round(SETTLED / step) :]
        segment = min(len(force), round(0.05 / step))
        found.append(band_levels(*psd(force, step, segment=segment), low=100.0, high=5000.0)[1])
    return found


def rms(difference: np.ndarray) -> str:
    return f"{np.sqrt(np.mean(difference**2)):.2f}"


def against_fine(textures: int) -> None:
    """Print how far coarse grids are from the fine one."""
    print("| texture | cells | covered, dB rms | whole, dB rms |\n|---|---|---|---|")
    for seed in range(1, textures + 1):
        fine = levels("covered", 24, seed, ["direct"])[0]
        for across in (6, 9, 12):
            off = [rms(levels(c, across, seed, ["direct"])[0] - fine) for c in ("covered", "whole")]
            print(f"| {seed} | {across} | {off[0]} | {off[1]} |", flush=True)


def table_beside(textures: int) -> None:
    """Print how far `table` is from `direct` on the same cells."""
    print("| texture | cells | covered, dB rms | whole, dB rms |\n|---|---|---|---|")
    for seed in range(1, textures + 1):
        for across in (6, 9):
            pairs = [levels(c, across, seed, ["direct", "table"]) for c in ("covered", "whole")]
            print(f"| {seed} | {across} | " + " | ".join(rms(b - a) for a, b in pairs) + " |", flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--textures", type=int, default=4)
    parser.add_argument("--table", action="store_true", help="`table` beside `direct`")
    chosen = parser.parse_args()
    (table_beside if chosen.table else against_fine)(chosen.textures)
