"""`direct` on nearly smooth balls, with 6, 9 and 12 cells in the half-width of the contact against 24.

A ball rolls over a texture of a twohundredth of its approach rms, so that the force varies by some per cent.
Compared are one-third-octave levels of the force, 100 Hz to 5 kHz, of cells that are whole and of those that
count as far as they are covered; the reference are 24 covered ones. With ``--table`` the law `table` beside
`direct`, on grids of the same cells.

    python benchmarks/direct_cells.py --textures 4
    python benchmarks/direct_cells.py --textures 4 --table
    python benchmarks/direct_cells.py --templates ball-on-beam wheel-on-rail

With ``--templates`` the cases that `asperity new` writes, on their grids against covered cells half as large,
over the same surface: errors of laws, and processor time.
"""

import argparse
import os
import tempfile
import time
from unittest.mock import patch

import numpy as np

from asperity.case.cases import parse_case, template
from asperity.running import prepare_case, run
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


TEMPLATES = {
    "ball-on-beam": {"laws": ("areal", "table", "direct"), "duration": 0.04},
    "wheel-on-rail": {"laws": ("areal", "linear-filtered", "table"), "duration": 0.15},
}
"""What is changed of templates: laws, and how long the record is, s."""

TRIED = {
    "fine": ("covered", 2),
    "whole": ("whole", 1),
    "auto": ("auto", 1),
    "covered": ("covered", 1),
    "larger": ("covered", 0.8),
    "coarse": ("covered", 2 / 3),
}
"""Cells at rims, and how much finer the grid is than that of the case."""


def of_templates(kinds: list[str]) -> None:
    """Print what each kind of cells makes of the cases that users begin with."""
    print("| case | cells | law | dB rms | most | processor time of all laws, s |\n|---|---|---|---|---|---|")
    for kind in kinds:
        base = parse_case(template(kind)).with_(**TEMPLATES[kind])
        chosen = prepare_case(base).case
        same = {"contact.window": chosen.contact.window, "numerics.time_step": chosen.time_step}
        if chosen.surface.rms is not None:
            waves = {f"surface.{name}": getattr(chosen.surface, name) for name in ("shortest", "longest")}
            same |= waves | {"contact.samples": 4}
        found, seconds = {}, {}
        for name, (cells, finer) in TRIED.items():
            grid = {"contact.spacing": chosen.contact.spacing / finer, "contact.rim_cells": cells}
            with tempfile.TemporaryDirectory() as folder, patch.dict(os.environ, ASPERITY_CACHE=folder):
                begun = time.process_time()
                tree = run(base.with_(**same, **grid))
                seconds[name] = time.process_time() - begun
            found[name] = tree["spectra/force_level"]
        for name in list(TRIED)[1:]:
            off = found[name] - found["fine"]
            for law in off["law"].values.tolist():
                each = off.sel(law=law).values
                most = np.nanmax(np.abs(each))
                row = f"| {kind} | {name} | {law} | {np.sqrt(np.nanmean(each**2)):.3f} | {most:.2f} "
                print(row + f"| {seconds[name]:.1f} |", flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--textures", type=int, default=4)
    parser.add_argument("--table", action="store_true", help="`table` beside `direct`")
    parser.add_argument("--templates", nargs="+", choices=TEMPLATES, help="cases that users begin with")
    chosen = parser.parse_args()
    if chosen.templates:
        of_templates(chosen.templates)
        raise SystemExit
    (table_beside if chosen.table else against_fine)(chosen.textures)
