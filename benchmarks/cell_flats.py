"""Flats of wheels and dipped joints: whole and covered cells of the default grid, against finer ones.

    python benchmarks/cell_flats.py         # contacts at positions all along defects
    python benchmarks/cell_flats.py --runs  # records of runs over them, by direct and table

At positions along a defect, on rows of the grid and between, `direct` finds forces at seven approaches about
the one under which finer cells carry the load. Those are a third as large and covered, with means of the
exact shape of the defect; such that are whole show how far they are known. Covered cells of the grid are
given means of the defect, as cases have them, and its heights in their middles. The texture is self-affine,
from two half-widths to four cells.
"""

import argparse
import math
import os
import tempfile
from functools import partial
from unittest.mock import patch

import numpy as np

from asperity import HalfSpace, Hertz
from asperity.case.cases import parse_case, template
from asperity.laws.direct import Direct
from asperity.running import prepare_case
from asperity.scenarios.defects import PARTS
from asperity.scenarios.geometry import Geometry
from asperity.scenarios.rim_cells import roughness_within
from asperity.scenes.compute import compute
from asperity.spectra import band_levels, psd
from asperity.surfaces.cell_means import cell_means, pressed_heights
from asperity.surfaces.defects import dipped_joint, flat_geometry
from asperity.surfaces.synthesis import self_affine

RADIUS, RADIUS_ACROSS, MODULUS, LOAD, SIDE = 0.46, 0.30, 115.4e9, 65e3, 0.5e-3
"""Wheel on rail as `asperity new` writes it, m, Pa, N; side of its cells, m."""
FINER = 3
"""Times that cells are finer that are compared with: odd, so that the points of both are the same."""
STATES = np.linspace(-0.2, 0.2, 7)
"""Approaches about that under the load, over the approach of the sound wheel."""
HERTZ = Hertz(MODULUS, RADIUS, RADIUS_ACROSS)
APPROACH = HERTZ.approach(LOAD)
ALONG, ACROSS = HERTZ.semi_axes(APPROACH)
KINDS = ("covered", "on points", "whole", "whole and finer")


def flat(length, shape):
    """Length, m, beside which positions lie, and height of a flat at positions, m."""
    given = length if shape == "worn" else None
    return 0.5 * length, lambda at: flat_geometry(at, length**2 / (8.0 * RADIUS), RADIUS, shape, given)


def joint(length):
    """Likewise of a joint 1 mm deep."""
    return 3.0 * ALONG, lambda at: dipped_joint(at, 1e-3, length)


DEFECTS = {f"flat of {length} mm": flat(1e-3 * length, "fresh") for length in (20, 30, 40, 60)}
DEFECTS |= {f"worn flat of {length} mm": flat(1e-3 * length, "worn") for length in (30, 50)}
DEFECTS |= {f"joint of {length} mm": joint(1e-3 * length) for length in (1000, 500, 100)}


def means_of(defect, at, side):
    """Mean heights over cells of a side about positions, m."""
    return np.mean([defect(at + side * ((i + 0.5) / PARTS - 0.5)) for i in range(PARTS)], axis=0)


def body_of(nx, ny, side):
    """Gap (nx, ny) of the sound wheel at points so far apart, m."""
    x, y = (((np.arange(n) - 0.5 * (n - 1)) * side) ** 2 for n in (nx, ny))
    return np.add.outer(x / (2.0 * RADIUS), y / (2.0 * RADIUS_ACROSS))


def texture_of(shape, rms, seed):
    """Heights on the finer points, m."""
    if rms == 0.0:
        return np.zeros(shape)
    waves = {"longest": 2.0 * ALONG, "shortest": 4.0 * SIDE}
    heights = self_affine(shape, 2 * (SIDE / FINER,), rms=rms, hurst=0.8, **waves, seed=seed).heights
    return heights * rms / heights.std()


def forces_of(space, gap, approaches, start):
    """Forces at approaches, N."""
    found = []
    for approach in approaches:
        solved = space.solve(gap, approach=approach, start=start, rtol=1e-7)
        start = solved.pressure
        found.append(solved.force)
    return found


def along_defect(name, rms, seed, count=12):
    """Roughness within the contact, and forces (count, states) on each kind of cells, over the load."""
    reach, defect = DEFECTS[name]
    fine, span = SIDE / FINER, reach + 1.3 * ALONG
    half = [math.ceil(length / SIDE) for length in (reach + 1.7 * ALONG, 1.7 * ACROSS)]
    nx, ny = (2 * n + 1 for n in half)
    middle = math.ceil(span / SIDE) + half[0] + 8
    x = (np.arange(FINER * (2 * middle + 1)) - FINER * middle - FINER // 2) * fine
    at = x - np.random.default_rng(seed).uniform(-0.5, 0.5) * SIDE
    texture = texture_of((len(x), FINER * ny), rms, seed)
    points = slice(FINER // 2, None, FINER)
    coarse, body = texture[points, points], body_of(nx, ny, SIDE)
    ball = Geometry(body, (SIDE, SIDE), MODULUS, HERTZ, LOAD, LOAD)
    within = roughness_within([coarse[middle - half[0] : middle + half[0] + 1]], ball)

    law = partial(Direct, spacing=(SIDE, SIDE), modulus=MODULUS, start=x[points][0])
    means, middles = means_of(defect, at[points], SIDE)[:, None], defect(at[points])[:, None]
    places = np.round(np.linspace(-0.1 * span, span, count) / fine).astype(int)
    laws = [
        law(pressed_heights(coarse) + means, cell_means(body), cells="covered"),
        law(pressed_heights(coarse) + middles, cell_means(body), cells="covered"),
        law(coarse + middles, body),
    ]
    on_path = [each.prepare(places * fine) for each in laws]
    smooth = body_of(FINER * nx, FINER * ny, fine)
    finer = {
        "covered": (cell_means(smooth), pressed_heights(texture) + means_of(defect, at, fine)[:, None]),
        "whole": (smooth, texture + defect(at)[:, None]),
    }
    spaces = {cells: HalfSpace(smooth.shape, fine, MODULUS, cells=cells) for cells in finer}
    forces = {kind: [] for kind in (*KINDS, "finer")}
    for step, place in enumerate(places):
        first = FINER * (middle - half[0]) + place
        gaps = {cells: gap - heights[first : first + len(gap)] for cells, (gap, heights) in finer.items()}
        held = spaces["covered"].solve(gaps["covered"], load=LOAD, rtol=1e-5)
        approaches = held.approach + STATES * APPROACH
        for kind, cells in (("finer", "covered"), ("whole and finer", "whole")):
            forces[kind].append(forces_of(spaces[cells], gaps[cells], approaches, held.pressure))
        for kind, each in zip(KINDS, on_path, strict=False):
            forces[kind].append([each.evaluate(step, approach)[0] for approach in approaches.tolist()])
            each.accept(step)
    return within, {kind: np.array(found) / LOAD for kind, found in forces.items()}


def of_contacts(seeds=range(4)):
    """Print how far forces, and their change with the approach, are from those of finer cells."""
    print("Force over the load and its change with the approach, rms and most, %\n")
    print("| defect | rms / approach | " + " | ".join(f"{q}: {kind}" for kind in KINDS for q in "Fk") + " |")
    print(10 * "|---" + "|")
    for name in DEFECTS:
        for rms in (0.0, 0.05, 0.15):
            of = [along_defect(name, rms * APPROACH, seed) for seed in seeds]
            columns = []
            for kind in KINDS:
                pairs = [(forces[kind], forces["finer"]) for _, forces in of]
                force = [found - fine for found, fine in pairs]
                steps = [np.diff(found) / np.diff(fine) - 1.0 for found, fine in pairs]
                for off in (100.0 * np.array(force), 100.0 * np.array(steps)):
                    columns.append(f"{np.sqrt(np.mean(off**2)):.3f}, {np.abs(off).max():.2f}")
            print(f"| {name} | {np.mean([w for w, _ in of]):.3f} | " + " | ".join(columns) + " |", flush=True)


RUNS = {f"flat of {length} mm": {"wheel.flat_length": f"{length} mm"} for length in (20, 40, 60)}
WORN = {"wheel.flat_depth": "0.3 mm", "wheel.flat_shape": "worn"}
RUNS |= {"worn flat of 60 mm": {"wheel.flat_length": "60 mm"} | WORN}
RUNS |= {"joint of 1 m": {"surface.joint_depth": "1 mm"}}
"""Keys of defects that are rolled over."""
TRIED = {"fine": ("covered", 2), "whole": ("whole", 1), "covered": ("covered", 1)}
"""Cells at rims, and how much finer the grid is than that of the case."""
LAWS = ("direct", "table")


def of_runs():
    """Print how far 60 ms at 20 m/s are from `direct` on covered cells half as large, on the same surface."""
    print("| defect | cells | law | force / load, rms and most, % | peak, % | levels, dB rms and most |")
    print(6 * "|---" + "|")
    base = parse_case(template("wheel-on-rail"))
    for name, keys in RUNS.items():
        case = base.with_(**keys, laws=LAWS, duration="60 ms", settling="20 ms", speed="20 m/s")
        chosen = prepare_case(case).case
        same = {"contact.window": chosen.contact.window, "numerics.time_step": chosen.time_step}
        forces = {}
        for kind, (cells, finer) in TRIED.items():
            grid = {"contact.spacing": chosen.contact.spacing / finer, "contact.rim_cells": cells}
            with tempfile.TemporaryDirectory() as folder, patch.dict(os.environ, ASPERITY_CACHE=folder):
                computed = compute(prepare_case(case.with_(**same, **grid)), lambda *_: None)
            for law in LAWS:
                forces[kind, law] = computed.runs[law].contact_force[0] / LOAD
        fine = forces["fine", "direct"]
        for (kind, law), force in forces.items():
            off = 100.0 * (force - fine)
            levels = [
                band_levels(*psd(each, chosen.time_step, segment=len(each) // 2), low=100.0, high=5000.0)[1]
                for each in (force, fine)
            ]
            change = levels[0] - levels[1]
            row = f"| {name} | {kind} | {law} | {np.sqrt(np.mean(off**2)):.3f}, {np.abs(off).max():.2f} "
            row += f"| {100.0 * (force.max() / fine.max() - 1.0):+.2f} "
            print(row + f"| {np.sqrt(np.mean(change**2)):.3f}, {np.abs(change).max():.2f} |", flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", action="store_true", help="records of runs")
    (of_runs if parser.parse_args().runs else of_contacts)()
