"""Curves of `kernels.rim_curves`: the gap left in cells at the rim of a contact, and their covered share.

    python benchmarks/cell_rims.py            # the curves, as rim_curves.toml beside the kernel has them
    python benchmarks/cell_rims.py --check    # against Hertz, 4 to 24 cells, balls and ellipses
    python benchmarks/cell_rims.py --rough    # rough balls against grids four times as fine
    python benchmarks/cell_rims.py --choice   # where covered cells serve better: `SMOOTH`
    python benchmarks/cell_rims.py --fresh    # likewise, textures that nothing was chosen by
    python benchmarks/cell_rims.py --caps     # smooth balls with a hardness, against finer grids
    python benchmarks/cell_rims.py --raceways # a ball in the groove of a 6205, against finer grids
    python benchmarks/cell_rims.py --elongated # iterations on cells that are wider than long
    python benchmarks/cell_rims.py --cost     # time and iterations against those of whole cells, in turn

The contact of a ball on a half-space is known in closed form: half-width, approach, radius and modulus E*
are one, δ = a² = 1, and the pressure is (2/π) √(1 − r²). Its means over cells, displaced by the coefficients
between means, with the means of the undeformed gap, tell what is left of the gap in each cell. Over the
step S of the pressure beside the cell, it is a function of √(p/S), of the slant, and of the side of a
cell over the half-width h/a. Balls of all sizes, at random places on the grid, are fitted by

    left = left₀(√(p/S), slant) + h/a · left₁(√(p/S), slant)

with cubic splines on the knots of the kernel, straight between slants. The curves of the gap are those of
h/a = 1/9, between a straight rim and the smallest contacts that have a rim at all. The covered share is
fitted likewise, to contacts solved with these, and both of its parts are kept: h/a is seen in the pressure.
"""

import argparse
import math
import time
import warnings
from unittest.mock import patch

import numpy as np
from scan_step import MODULUS, problem

from asperity import BallBearing, HalfSpace, Hertz
from asperity.contact import elastic_grid
from asperity.contact.scan import ScanJob, scan_forces
from asperity.kernels.batched import convolve_padded, padded_spectrum
from asperity.kernels.influence import means_table
from asperity.kernels.rim_curves import END, KNOTS, PER_UNIT, SLANTS, cubics, every_knot
from asperity.scenarios.geometry import Geometry
from asperity.scenarios.rim_cells import roughness_within
from asperity.surfaces.cell_means import cell_means, pressed_heights
from asperity.surfaces.strip import Rows
from asperity.surfaces.synthesis import self_affine

BALLS = {6: 60, 8: 50, 12: 50, 16: 40, 24: 30, 40: 14}
"""Cells in the half-width, at least, and how many balls."""
PARTS = 32
"""Parts of a cell for the mean of what ends within it."""
FINE = 1.0 / 9.0
"""Side of a cell over the half-width, of the curves of the gap."""
OFFSETS = [(0.0, 0.0), (0.5, 0.5), (0.5, 0.0), (0.3, 0.1)]
"""Of the ball's middle from a cell's, in cells."""


def means_of_ball(x, y):
    """Means over cells between edges x and y of √(1 − r²), and of one in r = 1: in closed form along y."""
    nodes, weights = np.polynomial.legendre.leggauss(8)
    starts = x[:-1, None] + np.diff(x)[:, None] * np.arange(PARTS) / PARTS
    places = (starts[..., None] + np.diff(x)[:, None, None] * (nodes + 1.0) / (2 * PARTS)).reshape(-1, 1)
    chord = np.sqrt(np.maximum(1.0 - places**2, 0.0))
    inside = np.clip(y, -chord, chord)
    angle = np.arcsin(np.clip(inside / np.where(chord > 0.0, chord, 1.0), -1.0, 1.0))
    whole = 0.5 * (inside * np.sqrt(np.maximum(chord**2 - inside**2, 0.0)) + chord**2 * angle)
    share = np.tile(weights, PARTS) / (2 * PARTS)
    return tuple(
        share @ np.diff(each, axis=1).reshape(len(x) - 1, len(share), -1) / np.diff(y)
        for each in (whole, inside)
    )


def cells_of_ball(across, offset, solved):
    """Ratio, slant, gap that is left, covered share and side of cells at the rim of a ball's contact.

    Pressures are those of Hertz, or solved on the cells, with the curves of the gap that the kernel has.
    """
    side, count = 1.0 / across, math.ceil(across) + 4
    edges = [(np.arange(-count, count + 2) - 0.5 + o) * side for o in offset]
    (pressure, covered), size = means_of_ball(*edges), 2 * count + 1
    pressure *= 2.0 / math.pi
    spectrum = padded_spectrum(means_table(size, size, side, side) / math.pi, size, size)
    x, y = (0.5 * (e[1:] + e[:-1]) for e in edges)
    undeformed = 0.5 * np.add.outer(x**2, y**2) + side**2 / 12.0
    if solved:
        space = HalfSpace((size, size), side, 1.0, cells="covered")
        pressure = space.solve(undeformed, approach=1.0, start=pressure, rtol=1e-8).pressure
    gap = convolve_padded(pressure[None], spectrum, np)[0] + undeformed - 1.0
    p = np.pad(pressure, 1)
    along, across_it = np.abs(p[2:, 1:-1] - p[:-2, 1:-1]), np.abs(p[1:-1, 2:] - p[1:-1, :-2])
    step = np.hypot(along, across_it)
    rim = (pressure > 0.0) & (pressure < END**2 * step)
    step, along, across_it = step[rim], along[rim], across_it[rim]
    slant = np.minimum(along, across_it) / np.maximum(along, across_it)
    ratio = np.sqrt(pressure[rim] / step)
    return np.stack([ratio, slant, gap[rim] / (step * side), covered[rim], np.full(len(step), side)])


def influence_of_knots(ratio, slant):
    """What each value of the curves counts for at ratios and slants, as in `rims.between_curves`."""
    unit = np.moveaxis(cubics(np.eye(KNOTS)), 0, 2)  # (interval, power, knot)
    place = ratio * PER_UNIT
    k = np.minimum(place.astype(int), KNOTS - 2)
    along = np.einsum("nps,np->ns", unit[k], (place - k)[:, None] ** np.arange(4))
    j = np.minimum((np.sqrt(slant) * (SLANTS - 1)).astype(int), SLANTS - 2)
    share = (slant * (SLANTS - 1) ** 2 - j**2) / (2 * j + 1)
    rows, found = np.arange(len(ratio)), np.zeros((len(ratio), SLANTS, KNOTS))
    found[rows, j] = (1.0 - share)[:, None] * along
    found[rows, j + 1] = share[:, None] * along
    return found.reshape(len(ratio), -1)


def fitted(cells, values, first, last, sides, smoothness=1e-3):
    """Curves (SLANTS, KNOTS) of a straight rim, and what they gain per side at every third knot.

    At the sides h/a of `sides` the `first` and `last` values are given, or None.
    """
    knots = influence_of_knots(cells[0], cells[1])
    thick = every_knot(np.eye(KNOTS // 3 + 1)).T  # h/a counts smoothly
    with_side = knots.reshape(-1, SLANTS, KNOTS) @ thick
    with_side = with_side.reshape(len(knots), -1) * cells[4][:, None]
    bend = np.kron(np.eye(SLANTS), np.diff(np.eye(KNOTS), 2, axis=0))
    bend *= smoothness * math.sqrt(len(knots))
    blocks, targets = [np.hstack([knots, with_side])], [values]
    blocks.append(np.hstack([bend, np.zeros((len(bend), with_side.shape[1]))]))
    targets.append(np.zeros(len(bend)))
    for place, value in ((0, first), (KNOTS - 1, last)):
        if value is not None:
            here = 1e4 * np.eye(KNOTS)[[place]]
            for side in sides:
                both = (here, side * here @ thick)
                blocks.append(np.hstack([np.kron(np.eye(SLANTS), each) for each in both]))
                targets.append(np.full(SLANTS, 1e4 * value))
    matrix, target = np.vstack(blocks), np.concatenate(targets)
    solution = np.linalg.lstsq(matrix, target, rcond=None)[0]
    print(f"# off by {np.std(values - (matrix @ solution)[: len(values)]):.4f}")
    size = SLANTS * KNOTS
    return solution[:size].reshape(SLANTS, KNOTS), solution[size:].reshape(SLANTS, -1)


def print_curves():
    """Print the curves."""
    rng = np.random.default_rng(5)
    balls = [
        (across * (1.0 + 0.1 * rng.random()), rng.random(2) - 0.5)
        for across, count in BALLS.items()
        for _ in range(count)
    ]
    exact, solved = (
        np.concatenate([cells_of_ball(*ball, kind) for ball in balls], axis=1) for kind in (False, True)
    )
    straight, gained = fitted(exact, exact[2], None, 0.0, (FINE,))
    curves = {"left": straight + FINE * every_knot(gained)}
    straight, gained = fitted(solved, solved[3], 0.0, 1.0, (0.0, FINE))
    curves |= {"covered": np.clip(straight, 0.0, 1.0), "bent": gained}
    for name, found in curves.items():
        text = np.array2string(
            found.round(4) + 0.0, separator=", ", max_line_width=100, formatter={"float": "{:.4f}".format}
        )
        print(f"{name} = {text}")


def errors_of_ellipse(slender, across, offset, cells, count):
    """Stiffness (difference quotients), force and area of a smooth contact against Hertz, relative.

    So many cells in the smaller semi-axis, along x, at an approach of one; the other is `slender` times it.
    """
    low, high = 1.0, 4.0 * slender**2  # of the other radius over the first: bisected
    while high / low > 1.0 + 1e-12:
        middle = math.sqrt(low * high)
        axes = Hertz(1.0, 1.0, middle).semi_axes(1.0)
        low, high = (middle, high) if axes[1] < slender * axes[0] else (low, middle)
    hertz, radii = Hertz(1.0, 1.0, low), (1.0, low)
    axes = hertz.semi_axes(1.0)
    side = axes[0] / across
    shape = [math.ceil(2.4 * a / side) + 6 for a in axes]
    x, y = ((np.arange(n) - 0.5 * (n - 1) - o) * side for n, o in zip(shape, offset, strict=True))
    gap = np.add.outer(x**2 / (2 * radii[0]), y**2 / (2 * radii[1]))
    if cells == "covered":
        gap += side**2 / 24.0 * sum(1.0 / r for r in radii)
    half_space = HalfSpace(tuple(shape), side, 1.0, cells=cells)
    approaches, contacts, start = np.linspace(0.85, 1.15, count), [], None
    for approach in approaches:
        contacts.append(half_space.solve(gap, approach=approach, start=start, rtol=1e-8))
        start = contacts[-1].pressure
    force, area = (np.array([getattr(c, name) for c in contacts]) for name in ("force", "area"))
    exact = np.array([hertz.force(d) for d in approaches])
    areas = np.array([math.pi * np.prod(hertz.semi_axes(d)) for d in approaches])
    return np.diff(force) / np.diff(exact) - 1.0, force / exact - 1.0, area / areas - 1.0


def check(count=200):
    """Print errors against Hertz."""
    print("| semi-axes | cells in the smaller | k, least and most, % | F, rms, % | area, rms, % |")
    print("|---|---|---|---|---|")
    for slender in (1.0, 3.0, 8.0):
        sizes = (4, 6, 9, 12, 18, 24) if slender < 8.0 else (4, 6, 9, 12)
        for cells in ("covered", "whole"):
            bounds = []
            for across in sizes:
                found = [errors_of_ellipse(slender, across, o, cells, count) for o in OFFSETS]
                k, force, area = (100.0 * np.concatenate(each) for each in zip(*found, strict=True))
                rms = [math.sqrt(np.mean(np.square(each))) for each in (force, area)]
                bounds.append([np.abs(k).max(), *rms])
                row = f"| 1 : {slender:.0f}, {cells} | {across} | {k.min():+.2f} to {k.max():+.2f} "
                print(row + f"| {rms[0]:.4f} | {rms[1]:.3f} |", flush=True)
            rates = np.polyfit(np.log(sizes), np.log(bounds), 1)[0]
            row = f"| 1 : {slender:.0f}, {cells} | order in h | "
            print(row + " | ".join(f"{-rate:.1f}" for rate in rates) + " |")


def rough_ball(fine, across, height, seed, times=4):
    """Gap of a ball with waves of its half-width and less, on a grid of so many parts of a cell."""
    count = (math.ceil(3.2 * across) + 2) * times
    x = (np.arange(count) - 0.5 * count + 0.3) * fine
    return 0.5 * np.add.outer(x**2, x**2) + rough_waves(x, height, seed)


def rough_waves(x, height, seed, y=None):
    """Waves of a half-width and less, of an rms height, on points x and y, or x squared."""
    y = x if y is None else y
    rng = np.random.default_rng(seed)
    waves = sum(
        rng.normal() * np.cos(np.add.outer(k * x, m * y) + 6.3 * rng.random())
        for k, m in rng.normal(0.0, 5.0, (30, 2))
    )
    return height * waves / math.sqrt(15.0)


def check_rough():
    """Print stiffness, force and area of rough balls against covered cells a quarter as large."""
    head = "| rms / approach | cells in the half-width | k, rms, %: covered | whole "
    print(head + "| F: covered | whole | area: covered | whole |")
    print(8 * "|---" + "|")
    approaches = np.linspace(0.8, 1.2, 41)
    for height in (0.003, 0.03, 0.1, 0.3):
        for across in (6, 9, 12):
            errors = {"covered": [], "whole": []}
            for seed in range(3):
                gap = rough_ball(0.25 / across, across, height, seed)
                n = len(gap) // 4
                means, middles = gap.reshape(n, 4, n, 4).mean(axis=(1, 3)), gap.reshape(n, 4, n, 4)
                grids = {"fine": (gap, "covered"), "covered": (means, "covered")}
                grids["whole"] = (middles[:, 1:3, :, 1:3].mean(axis=(1, 3)), "whole")
                forces, areas = {}, {}
                for name, (heights, cells) in grids.items():
                    space = HalfSpace(heights.shape, 1.0 / across / (len(heights) / n), 1.0, cells=cells)
                    solved, start = [], None
                    for approach in approaches:
                        solved.append(space.solve(heights, approach=approach, start=start, rtol=1e-7))
                        start = solved[-1].pressure
                    forces[name], areas[name] = np.transpose([(c.force, c.area) for c in solved])
                for name, kept in errors.items():
                    steps = np.diff(forces[name]) / np.diff(forces["fine"]) - 1.0
                    off = [steps, *(each[name] / each["fine"] - 1.0 for each in (forces, areas))]
                    kept.append([np.mean(each**2) for each in off])
            rms = {name: 100.0 * np.sqrt(np.mean(kept, axis=0)) for name, kept in errors.items()}
            columns = [rms[name][i] for i in range(3) for name in ("covered", "whole")]
            print(f"| {height} | {across} | " + " | ".join(f"{c:.2f}" for c in columns) + " |", flush=True)


PARTED = 5
"""Parts of a cell of the grids that are compared with: odd, so that the points of both are the same."""


def textures_of_patch(count, fine, height, seed):
    """Textures of a ball's contact, by name, on points that are so far apart; rms height in approaches.

    Waves of a Gaussian spectrum, down to 0.4 half-widths, and self-affine ones as grids are chosen for: from
    two half-widths to four of nine cells.
    """
    grid, lengths = (fine, fine), {"longest": 2.0, "shortest": 4.0 / 9.0}
    affine = self_affine((count, count), grid, rms=height, hurst=0.8, **lengths, seed=seed).heights
    x = (np.arange(count) - 0.5 * (count - 1)) * fine
    short = rough_waves(x, height, seed)
    return {"short waves": short, "self-affine": affine * height / affine.std()}


def check_choice(seeds=range(6)):
    """Print force and stiffness of rough balls on cells as cases lay them, and on covered ones of means."""
    head = "| texture | rms / approach | cells | within "
    print(head + "| F, rms, %: covered | on means | whole | k: covered | on means | whole |")
    print(10 * "|---" + "|")
    approaches = np.linspace(0.8, 1.2, 13)
    for name in ("short waves", "self-affine"):
        for height in (0.03, 0.07, 0.1, 0.2, 0.3):
            for across in (6, 9):
                errors, within = {"covered": [], "means": [], "whole": []}, []
                for seed in seeds:
                    side = 1.0 / across
                    points = 2 * math.ceil(1.6 * across) + 3
                    x = (np.arange(PARTED * points) - 0.5 * (PARTED * points - 1)) * side / PARTED
                    texture = textures_of_patch(len(x), side / PARTED, height, seed)[name]
                    gap = 0.5 * np.add.outer(x**2, x**2) + texture
                    middle = slice(PARTED // 2, None, PARTED)
                    ball = Geometry(
                        gap[middle, middle], (side, side), 1.0, Hertz(1.0, 1.0, 1.0), 4.0 / 3.0, 4.0
                    )
                    within.append(roughness_within([-texture[middle, middle]], ball))
                    bent = cell_means((gap - texture)[middle, middle])
                    pressed = bent + pressed_heights(texture[middle, middle])
                    grids = {"fine": (gap, "covered"), "covered": (pressed, "covered")}
                    grids |= {
                        "means": (cell_means(gap[middle, middle]), "covered"),
                        "whole": (ball.body, "whole"),
                    }
                    forces = {
                        kind: forces_of(*grid, side * points, approaches) for kind, grid in grids.items()
                    }
                    for kind, kept in errors.items():
                        steps = np.diff(forces[kind]) / np.diff(forces["fine"]) - 1.0
                        kept.append([np.mean((forces[kind] / forces["fine"] - 1.0) ** 2), np.mean(steps**2)])
                rms = {kind: 100.0 * np.sqrt(np.mean(kept, axis=0)) for kind, kept in errors.items()}
                columns = [f"{rms[kind][i]:.2f}" for i in (0, 1) for kind in errors]
                row = f"| {name} | {height} | {across} | {np.mean(within):.3f} | "
                print(row + " | ".join(columns) + " |", flush=True)


def check_fresh():
    """Print the same of eight textures of each kind by which nothing was chosen."""
    check_choice(range(201, 209))


def forces_of(gap, cells, width, approaches, hardness=None):
    """Forces at approaches of a gap on cells that fill a width."""
    space, start, forces = HalfSpace(gap.shape, width / len(gap), 1.0, hardness, cells=cells), None, []
    for approach in approaches:
        solved = space.solve(np.ascontiguousarray(gap), approach=approach, start=start, rtol=1e-7)
        start = solved.pressure
        forces.append(solved.force)
    return np.array(forces)


def check_caps(finer=8):
    """Print force and stiffness of smooth balls whose pressure is capped, against finer covered cells."""
    head = "| hardness / largest pressure | cells in the half-width "
    print(head + "| k, rms and most, %: covered | whole | F, rms, %: covered | whole |")
    print(6 * "|---" + "|")
    for share in (1.2, 0.86, 0.79, 0.63, 0.47):
        for across in (6, 9, 18):
            k, force = {"covered": [], "whole": []}, {"covered": [], "whole": []}
            for offset in OFFSETS[::3]:
                fine = forces_of_capped(share, across, offset, "covered", finer)
                for kind in k:
                    found = forces_of_capped(share, across, offset, kind)
                    k[kind].append(100.0 * (np.diff(found) / np.diff(fine) - 1.0))
                    force[kind].append(100.0 * (found / fine - 1.0))
            columns = [f"{np.sqrt(np.mean(np.square(v))):.2f}, {np.abs(v).max():.1f}" for v in k.values()]
            columns += [f"{np.sqrt(np.mean(np.square(v))):.3f}" for v in force.values()]
            print(f"| {share} | {across} | " + " | ".join(columns) + " |", flush=True)


def forces_of_capped(share, across, offset, cells, parts=1):
    """Forces of a ball of so many cells, each in parts, capped at a share of its largest pressure."""
    side, points = 1.0 / (parts * across), 2 * math.ceil(1.6 * across * parts) + 1
    x, y = ((np.arange(points) - points // 2) * side - o / across for o in offset)
    gap = 0.5 * np.add.outer(x**2, y**2) + (side**2 / 12.0 if cells == "covered" else 0.0)
    return forces_of(gap, cells, points * side, np.linspace(0.9, 1.1, 25), share * 2.0 / math.pi)


def check_raceways(positions=6):
    """Print force and stiffness of a ball on a rough raceway, a slender contact, against finer cells."""
    contact, load, shortest = BallBearing.named("6205").inner_contact, 50.0, 50e-6
    first = contact.approach(load)
    axes, approaches = contact.semi_axes(first), first * np.linspace(0.9, 1.1, 11)
    waves = np.exp(np.random.default_rng(7).uniform(*np.log([shortest, 0.5e-3]), 60))
    angles, phases = np.random.default_rng(8).uniform(0.0, 2.0 * math.pi, (2, 60))

    def forces(along, across, cells, rms):
        grid = np.array([axes[0] / along, across])
        x, y = (
            np.arange(-n, n + 1) * d for n, d in zip(np.ceil(1.5 * np.divide(axes, grid)), grid, strict=True)
        )
        body, found = np.add.outer(x**2 / (2 * contact.radius_x), y**2 / (2 * contact.radius_y)), []
        space = HalfSpace(body.shape, tuple(grid), contact.modulus, cells=cells)
        for place in np.linspace(0.0, 0.4e-3, positions):
            k = 2.0 * math.pi / waves
            texture = np.zeros_like(body)
            for each, angle, phase, size in zip(k, angles, phases, waves**0.8, strict=True):
                wave = np.add.outer(each * math.cos(angle) * (x + place), each * math.sin(angle) * y)
                texture += size * np.cos(wave + phase)
            texture *= rms / math.sqrt(0.5 * np.sum(waves**1.6))
            gap = cell_means(body) + pressed_heights(texture) if cells == "covered" else body + texture
            found.append([space.solve(gap, approach=each, rtol=1e-6).force for each in approaches])
        return np.array(found)

    print(
        "| rms, nm | cells | along | across, um | F, rms, % | k, rms, % | k, most, % |\n" + 7 * "|---" + "|"
    )
    for rms in (0.0, 20e-9, 100e-9):
        exact = forces(20, shortest / 6, "covered", rms)
        for cells, along in (("whole", 8), ("covered", 8), ("covered", 6), ("covered", 5), ("covered", 4)):
            found = forces(along, shortest / 3, cells, rms)
            steps = 100.0 * (np.diff(found) / np.diff(exact) - 1.0)
            off = 100.0 * math.sqrt(np.mean((found / exact - 1.0) ** 2))
            row = f"| {1e9 * rms:.0f} | {cells} | {along} | {1e6 * shortest / 3:.1f} | {off:.3f} "
            print(row + f"| {math.sqrt(np.mean(steps**2)):.2f} | {np.abs(steps).max():.2f} |", flush=True)


def check_elongated(contacts=40):
    """Print iterations of ellipses of 8 by 16 and 6 by 9 cells that are wider than long."""
    print("| wide over long | half axes | rms | iterations | most | not converged |\n" + 6 * "|---" + "|")
    for elongation in (1.0, 2.0, 4.0, 5.0, 6.0, 8.0):
        for axes in ((8.0, 16.0), (6.0, 9.0)):
            for height in (0.0, 0.02, 0.1):
                rng = np.random.default_rng(5)
                found = [ellipse_on(elongation, axes, height, rng) for _ in range(contacts)]
                taken = [each.iterations for each in found]
                row = f"| {elongation:g} | {axes[0]:g} × {axes[1]:g} | {height} | {np.mean(taken):.1f} "
                print(row + f"| {max(taken)} | {sum(not each.converged for each in found)} |", flush=True)


def ellipse_on(elongation, axes, height, rng):
    """A contact of so many cells in its half axes at a random place, of a rms height in approaches."""
    a, b = axes[0], axes[1] * elongation
    x, y = (
        (np.arange(-n, n + 1) + rng.random() - 0.5) * side
        for n, side in zip(np.ceil(1.7 * np.array(axes)), (1.0, elongation), strict=True)
    )
    curvature = (1.0 / a**2, (1.0 / a**2) * (b / a) ** -1.5)
    gap = 0.5 * np.add.outer(curvature[0] * x**2, curvature[1] * y**2)
    waves = np.exp(rng.uniform(np.log(0.5), np.log(4.0), 40))
    texture = np.zeros_like(gap)
    for wave in waves:
        angle, phase = rng.uniform(0.0, 2.0 * math.pi, 2)
        along = np.add.outer(math.cos(angle) * x, math.sin(angle) * y) / a
        texture += wave**0.8 * np.cos(2.0 * math.pi / wave * along + phase)
    texture *= height / math.sqrt(0.5 * np.sum(waves**1.6))
    with patch.object(elastic_grid, "MOST_ELONGATED", math.inf):
        space = HalfSpace(gap.shape, (1.0, elongation), 1.0, cells="covered")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return space.solve(gap + texture, approach=rng.uniform(0.4, 1.3), rtol=1e-6)


def cost(rounds=21):
    """Print time and iterations of scans of 64 contacts, and of 8 approaches at each, against whole cells."""
    print(
        "| rms / approach | cells in the half-width | approaches | rtol | iterations | to whole | time | us |"
    )
    print("|---|---|---|---|---|---|---|---|")
    given = {"radius_share": 0.35, "stride": None, "positions": 64, "loading": 0, "cropped": False}
    for rms, across, count, rtol in (
        (1e-4, 6, 1, 4e-5), (0.02, 6, 1, 4e-5), (0.3, 6, 1, 4e-5), (1e-3, 12, 1, 4e-5), (0.05, 12, 1, 4e-5),
        (0.3, 12, 1, 4e-5), (1.0, 24, 1, 4e-5), (0.05, 12, 1, 1e-8), (0.05, 12, 8, 4e-5), (0.5, 12, 8, 4e-5),
    ):  # fmt: skip
        p = problem(round(across / 0.175), argparse.Namespace(**given, rms=rms, rtol=rtol))
        approaches = (
            p["approaches"][0] * np.linspace(0.3, 1.0, count)[-count:] if count > 1 else p["approaches"][:1]
        )
        seconds, counts = {"whole": [], "covered": []}, {}
        for _ in range(rounds + 1):
            for cells, taken in seconds.items():
                space = HalfSpace(p["body"].shape, float(p["spacing"]), MODULUS, cells=cells)
                job = ScanJob(space, Rows(p["heights"]), p["body"], approaches, int(p["offsets"][1]), rtol)
                began = time.process_time()
                counts[cells] = scan_forces(job, workers=1).counts
                taken.append(time.process_time() - began)
        least = {cells: min(taken[1:]) / counts[cells].solved for cells, taken in seconds.items()}
        iterations = {cells: each.iterations / each.solved for cells, each in counts.items()}
        print(
            f"| {rms} | {across} | {count} | {rtol:.0e} | {iterations['covered']:.1f} "
            f"| {iterations['covered'] / iterations['whole']:.2f} | {least['covered'] / least['whole']:.2f} "
            f"| {1e6 * least['covered']:.0f} |", flush=True,
        )  # fmt: skip


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    work = {"check": check, "rough": check_rough, "choice": check_choice}
    work |= {"fresh": check_fresh, "caps": check_caps, "raceways": check_raceways, "cost": cost}
    work |= {"elongated": check_elongated}
    chosen = parser.add_mutually_exclusive_group()
    for name, function in work.items():
        chosen.add_argument(f"--{name}", dest="work", action="store_const", const=function)
    (parser.parse_args().work or print_curves)()
