"""How much more a cell that a sharp edge crosses gives way: the curves of `contact.edges`.

    python benchmarks/cell_edges.py            # the curves, as they stand in contact/edges.py
    python benchmarks/cell_edges.py --check    # against flat punches and finer grids
    python benchmarks/cell_edges.py --faults   # balls over pits and spalls, against cells a quarter as large
    python benchmarks/cell_edges.py --flow     # likewise with a hardness; what cells sink until they flow

Near the straight edge of what carries, the pressure on an elastic half-space is A/√d at a distance d from
it, whatever presses, and displaces all that carries alike: by U; beyond the edge by 4A/E* √|d| less. On
cells, its means p̄ displace the middle of a cell by Σ K p̄. What is missing to U, over the mean pressure of
the cell, is the compliance that makes the means of the true pressure solve the contact on cells:

    γ/E* = (U − Σ K p̄)/p̄.

Over the width w of the cell along the normal of the edge, γ is a function of the distance of the cell's
middle from the edge over w, and of the slant, the smaller over the larger of the two parts |n_x| dx and
|n_y| dy of w; how long the cells are for their width makes no difference that matters (`--check`). What is
kept is κ = 1/(1 + γ/w), from 0 where nothing of the cell carries to 1. It is not let above: a cell that
gave way by less than a whole one would take the proof that energy is convex away.

A slope is an edge as far as it does not carry. Beyond a kink of an angle α, from which the pressure A/√d
falls far off, it does up to l = (π A/(α E*))², as an edge would that lay l/3 farther out. The pressure at x
beyond it is α E*/2π ln((√(l − x) + √l)/|√(l − x) − √l|). So what cells sink by, on the way from γ p̄/E* to
their mean depth, is known, too: the law of `contact.edges` is within 0.11 of that depth of it (`--check`).
Its powers are those that leave the least over slopes of pits and spalls (`--faults`).

Where surfaces flow at H, they do up to a length c from a deep edge (D. S. Dugdale, 1960, for cracks):

    p = H,  d < c;     p = (2H/π) arcsin √(c/d) → A/√d, A = (2H/π) √c,  beyond.

With s = √(c/b) a sound width b has the mean q H, q = (2/π)(arcsin s + s √(1 − s²)), where A alone would have
x H, x = 4s/π: it flows at x = 4/π. So a cell sinks by x γ/E* times its share of H, in place of q γ/E*, and by
what the means of both pressures displace otherwise: on cells in plane strain about half a width over E*,
times that share. Both rise with q as 1 − (1 − q⁴)^(2/3) does (`--flow`).

Cells next to those that are crossed should give way by up to 0.2 w less or more. Where the edge is slanted
this averages out along it, but for `BEYOND` of a width, by which round punches would be too large: edges are
taken as so much nearer. Along the grid it does not: whole cells up to an edge on their border act as if
they ended 0.174 of a cell before it. There one row of cells is made as soft as makes the whole punch right:
that of a flat strip in plane strain, whose approach under a load P per length is −(2/π) P/E* ln(a/2), gives
its half-width a away. The row is that whose middles lie from 0.33 cells before the edge to 0.67 beyond it.
"""

import argparse
import itertools
import math
import sys

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

from asperity import HalfSpace
from asperity.contact.edges import KNOTS, PER_UNIT, POWERS, SLANTS
from asperity.kernels.influence import cell_displacement
from asperity.surfaces.edges import FIRST, Edges
from asperity.surfaces.faults import PARTS as FAULT_PARTS
from asperity.surfaces.faults import Fault

AROUND, PARTS = 15, 21
"""Cells about one, whose pressure is taken part by part, and parts of a cell; both odd."""
STRIP = 40
"""Rows of cells across a strip."""
BEYOND = 0.014
"""By how much slanted edges act as if they lay farther out, in widths of a cell and roots of the slant.

From round punches (`--check`), which then have their stiffness on average.
"""
NEAR = 0.13
"""Place of the edge up to which parts are too coarse: it is close to where displacements are taken."""


def means(distance, normal, places, sides, power=-0.5):
    """Means over cells at places (x, y), m, of (distance + n·r)₊ to a power."""
    along = distance + normal[0] * places[0] + normal[1] * places[1]
    wide, narrow = sorted((0.5 * abs(n) * side for n, side in zip(normal, sides, strict=True)), reverse=True)
    one, two = power + 1.0, power + 2.0
    if narrow < 1e-6 * wide:
        ends = (np.maximum(along + s * wide, 0.0) ** one for s in (1, -1))
        return np.subtract(*ends) / (2.0 * wide * one)
    corners = [
        s * t * np.maximum(along + s * wide + t * narrow, 0.0) ** two for s in (1, -1) for t in (1, -1)
    ]
    return sum(corners) / (4.0 * wide * narrow * one * two)


def grid(number, sides):
    """Middles (x, y) of so many cells each way, m."""
    return np.meshgrid(*((np.arange(number) - 0.5 * (number - 1)) * side for side in sides), indexing="ij")


def more_compliant(distance, normal, sides, parts=PARTS):
    """Length γ of a cell of these sides, m, whose middle is at a distance, m, from an edge."""
    fine = tuple(side / parts for side in sides)
    coarse_places, fine_places = grid(AROUND, sides), grid(AROUND * parts, fine)
    pressure = means(distance, normal, coarse_places, sides)
    true = (cell_displacement(*fine_places, *fine) * means(distance, normal, fine_places, fine)).sum()
    on_cells = (cell_displacement(*coarse_places, *sides) * pressure).sum()
    beyond = 4.0 * math.sqrt(max(-distance, 0.0))
    return ((true - on_cells) / math.pi + beyond) / pressure[AROUND // 2, AROUND // 2]


def kept(ratio, slant, sides=(1.0, 1.0), swapped=False):
    """κ of a cell at a distance over its width, and a slant."""
    parts = np.array([slant, 1.0] if swapped else [1.0, slant]) / sides
    normal = parts / np.hypot(*parts)
    width = float(normal @ sides)
    return 1.0 / (1.0 + max(more_compliant(ratio * width, normal, sides) / width, 0.0))


def half_width(softness):
    """Half-width as which `STRIP` rows of cells act, with one more on either side of a softness γ/w."""
    ends = np.arange(STRIP + 3) - 0.5
    logs = np.sign(ends) * np.abs(ends) * (np.log(np.abs(ends)) - 1.0)
    apart = np.abs(np.subtract.outer(np.arange(STRIP + 2), np.arange(STRIP + 2)))
    matrix = -2.0 / math.pi * np.diff(logs)[apart]
    matrix[[0, -1], [0, -1]] += softness
    force = np.linalg.solve(matrix, np.ones(STRIP + 2)).sum()
    return 2.0 * math.exp(-0.5 * math.pi / force)


def kept_along(ratio):
    """κ of cells along an edge of the grid."""
    wanted = 0.5 * STRIP + 0.5 + ratio
    if half_width(1e9) >= wanted:
        return 0.0
    return 1.0 if half_width(0.0) <= wanted else brentq(lambda k: half_width(1.0 / k - 1.0) - wanted, 1e-9, 1)


def kept_across(places, slant):
    """κ of cells at places over their widths, of a slanted edge."""
    ratios = places - BEYOND * math.sqrt(slant)
    apart = (ratios > -0.499) & (np.abs(ratios) > NEAR)  # between, what is smooth there is interpolated
    values = np.array([kept(ratio, slant) for ratio in ratios[apart]])
    return np.where(ratios > -0.499, CubicSpline(ratios[apart], values)(ratios), 0.0)


def rising(lengths):
    """x (ln |x| − 1), of which the displacement by a strip of even pressure is the difference."""
    apart = np.abs(lengths)
    return lengths * (np.log(np.where(apart > 0.0, apart, 1.0)) - 1.0)


def sunk_at_kink(place, reach):
    """Mean pressure of a cell along a kink, and by how much it sinks, with w, E* and the angle one.

    The slope carries up to the reach. Parts of cells have their mean pressures, as cells have theirs.
    """
    ends = np.arange(-5 * STRIP, 5 * STRIP + 2) - 0.5 - place
    parts = np.linspace(ends[0], ends[-1], 5 * PARTS * (len(ends) - 1) + 1)
    displaced = []
    for borders in (parts, ends):
        root, end = np.sqrt(np.maximum(reach - borders, 0.0)), math.sqrt(reach)
        apart = np.where(root == end, 1.0, np.abs(root - end))
        force = ((root**2 - end**2) * np.log((root + end) / apart) + 2.0 * end * root) / (2.0 * math.pi)
        pressure = -np.diff(force) / np.diff(borders)
        displaced.append(-2.0 / math.pi * float(np.diff(rising(borders + place)) @ pressure))
    beyond, free = max(-place, 0.0), max(-place - reach, 0.0)
    gap = 2.0 / math.pi * (beyond * math.atan(math.sqrt(free / reach)) - math.sqrt(free * reach))
    return float(pressure[5 * STRIP]), displaced[0] - displaced[1] + beyond - gap


def check_kinks():
    """Tell how far what cells along kinks sink by is from the law that cells at edges follow."""
    off = []
    for place in (-0.4, -0.25, -0.1, 0.1):
        depth, power = 0.5 * (0.5 - place) ** 2, np.interp(place, *POWERS)
        low, sunk = sunk_at_kink(place, 1e-5)
        for reach in np.geomspace(1e-3, 3.0, 30):
            pressure, found = sunk_at_kink(place, reach)
            alone = pressure * sunk / low / depth
            off.append(found / depth - alone / (1.0 + alone**power) ** (1.0 / power))
    print(f"cells along kinks sink by {min(off):.2f} to {max(off):.2f} of their depth more than by the law")


def print_curves():
    """Print the curves, as `asperity/contact/cell_edges.txt` holds them."""
    ratios = FIRST + np.arange(KNOTS) / PER_UNIT
    slants = np.linspace(0.0, 1.0, SLANTS)[1:] ** 2
    curves = [[kept_along(ratio) for ratio in ratios], *(kept_across(ratios, slant) for slant in slants)]
    found = np.clip(curves, 0.0, 1.0)
    np.savetxt(sys.stdout, found, fmt="%.4f")


def punch(shape, spacing, middle, distance_and_normal, sharp=True):
    """Stiffness of a flat punch on a half-space of unit modulus: E* times a length."""
    x, y = ((np.arange(n) - n // 2 - o) * h for n, o, h in zip(shape, middle, spacing, strict=True))
    distance, normal = distance_and_normal(*np.meshgrid(x, y, indexing="ij"))
    edges = Edges(distance, normal, np.ones(shape) * 1e3, spacing)
    carries = edges.sound if sharp else distance > 0.0
    half_space = HalfSpace(shape, spacing, 1.0)
    return half_space.solve(
        np.where(carries, 0.0, 1e3), approach=1.0, rtol=1e-8, edges=edges if sharp else None
    ).force


def check():
    """Tell what cells of other sides would ask for, and how punches are met."""
    for ratio, slant in ((-0.3, 0.0), (-0.3, 0.3), (0.0, 0.1), (0.0, 1.0), (0.2, 0.3)):
        values = [
            kept(ratio, slant, (1.0, long), swapped) for long in (1.0, 3.0, 8.0) for swapped in (False, True)
        ]
        print(
            f"distance {ratio:4.1f}, slant {slant:.1f}: kept {min(values):.3f} to {max(values):.3f} "
            "on cells to 1 : 8"
        )
    check_kinks()
    rng = np.random.default_rng(0)
    for spacing in ((1.0, 1.0), (1.0, 3.0)):
        for cells in (4.0, 8.0, 16.0):
            errors = {True: [], False: []}
            for _ in range(20):
                radius = cells * spacing[1] * (1.0 + 0.25 * rng.random())
                shape = tuple(2 * math.ceil(radius / h + 2) + 1 for h in spacing)

                def disc(x, y, radius=radius):
                    r = np.hypot(x, y) + 1e-12
                    return radius - r, np.abs(x) / r

                middle = rng.random(2) - 0.5
                for sharp, found in errors.items():
                    found.append(punch(shape, spacing, middle, disc, sharp) / (2.0 * radius) - 1.0)
            words = [
                f"{100 * np.mean(each):.2f} ± {100 * np.std(each):.2f}, "
                f"at most {100 * np.abs(each).max():.2f} %"
                for each in errors.values()
            ]
            print(
                f"disc of {cells:.0f} to {1.25 * cells:.0f} cells {spacing}: with edges {words[0]}, "
                f"whole cells {words[1]}"
            )


SLOPES = {
    "upright": ((280e-6, 0.0), (50e-6, 0.0), (5e-6, 0.0), (2e-6, 0.0), (0.5e-6, 0.0)),
    "sloped": ((280e-6, 20e-6), (280e-6, 60e-6), (50e-6, 60e-6), (10e-6, 60e-6)),
    "gentle": ((2e-6, 30e-6), (3e-6, 40e-6), (5e-6, 60e-6), (5e-6, 100e-6), (10e-6, 150e-6)),
}
"""Depths of faults, and lengths over which they fall to their floor, m."""


def force_over(fault, cell, middle, place, sharp=True, hardness=None):
    """Force, N, of a steel ball of 10 mm, pressed by 4 µm beside the middle of a fault on square cells, m."""
    count = 2 * round(0.36e-3 / cell) + 1
    at = (np.arange(count) - count // 2) * cell
    ball = np.add.outer((at - place) ** 2, at**2) / 20e-3
    along, across = at[:, None] - middle[0], at[None, :] - middle[1]
    heights, edges = fault.heights(along, across), None
    if sharp:
        outline = fault.outline(along, across)
        parts = ((np.arange(FAULT_PARTS) + 0.5) / FAULT_PARTS - 0.5) * cell
        depth = -np.mean([fault.heights(along + i, across + j) for i in parts for j in parts], axis=0)
        edges = Edges(*outline, depth, (cell, cell))
        heights = np.where(edges.sound, 0.0, heights)
    space = HalfSpace(ball.shape, cell, 115e9, hardness)
    return space.solve(ball - heights, approach=4e-6, edges=edges).force


def check_faults(cell=30e-6, draws=8):
    """Print how far forces over pits and spalls of 0.30 to 0.40 mm are from those of finer cells."""
    rng = np.random.default_rng(99)
    print("| fall to the floor | fault | edges within cells: rms, % | most | whole cells: most |")
    print("|---|---|---|---|---|")
    for name, shapes in SLOPES.items():
        for kind in ("spall", "pit"):
            errors = []
            for depth, edge in shapes:
                for draw in range(draws):
                    middle, place = (rng.random(2) - 0.5) * cell, (draw % 2) * rng.uniform(0.0, 0.2e-3)
                    for size in np.arange(0.30e-3, 0.405e-3, 0.02e-3):
                        fault = Fault(kind, length=size, depth=depth, edge=edge)
                        fine = force_over(fault, cell / 4, middle, place)
                        found = [force_over(fault, cell, middle, place, sharp) for sharp in (True, False)]
                        errors.append(100.0 * (np.array(found) / fine - 1.0))
            most, rms = np.abs(errors).max(axis=0), math.sqrt(np.mean(np.square(errors), axis=0)[0])
            print(f"| {name} | {kind} | {rms:.2f} | {most[0]:.2f} | {most[1]:.1f} |", flush=True)


def flowing_force(width, length):
    """Force per H up to widths from a deep edge, of surfaces that flow up to a length from it."""
    width = np.asarray(width, dtype=float)
    beyond = np.maximum(width, length)
    inside = beyond * np.arcsin(np.sqrt(length / beyond)) + np.sqrt(length * (beyond - length))
    return np.where(width < length, width, 2.0 / np.pi * inside)


def print_flow(cells=4000):
    """Print what cells at the edge of a deep step sink until their sound part flows, by closed forms."""

    def antiderivative(x):
        return x * np.log(np.maximum(np.abs(x), 1e-300)) - x

    place = np.arange(cells)
    displaced = -2.0 / np.pi * (antiderivative(place + 0.5) - antiderivative(place - 0.5))  # of strips
    print("| q | x - q, over that at q = 1 | φ | widths over E*, at shares of 0.25, 0.5, 0.75, 1 |")
    print("|---|---|---|---|")
    for s in (0.2, 0.4, 0.6, 0.8, 0.9, 0.95, 1.0):
        sinks = []
        for share in (0.25, 0.5, 0.75, 1.0):
            ends, length = share + place, s * s * share
            elastic = np.diff(4.0 / np.pi * np.sqrt(length * ends), prepend=0.0)
            flowing = np.diff(flowing_force(ends, length), prepend=0.0)
            sinks.append(f"{displaced @ (elastic - flowing) / share:.3f}")
        q = float(flowing_force(1.0, s * s))
        more = (4.0 / np.pi * s - q) / (4.0 / np.pi - 1.0)
        print(f"| {q:.3f} | {more:.3f} | {1.0 - (1.0 - q**4) ** (2 / 3):.3f} | {', '.join(sinks)} |")


def print_errors(errors):
    """Print a table of errors, by fault and hardness."""
    print("\n| fault | hardness, GPa | rms, % | most | beyond 1 % | cases |")
    print("|---|---|---|---|---|---|")
    for (kind, hardness), each in sorted(errors.items()):
        rms, most, beyond = math.sqrt(np.mean(np.square(each))), np.abs(each).max(), np.abs(each) > 1.0
        print(f"| {kind} | {hardness / 1e9} | {rms:.2f} | {most:.2f} | {beyond.sum()} | {len(each)} |")


def missed(fault, hardness, cell, middle, place):
    """Error of a force where surfaces flow, against that on cells an eighth as large, %."""
    coarse, fine = (force_over(fault, each, middle, place, hardness=hardness) for each in (cell, cell / 8))
    return 100.0 * (coarse / fine - 1.0)


def check_flow(cell=30e-6, draws=220):
    """Print that, and errors over faults of surfaces that flow: drawn at random, and all of a grid."""
    print_flow()
    rng = np.random.default_rng(2024)
    errors = {}
    for _ in range(draws):
        kind, hardness = str(rng.choice(["spall", "pit"])), float(rng.choice([1.5e9, 2e9, 2.5e9, 3e9, 4e9]))
        depth = float(np.exp(rng.uniform(np.log(0.5e-6), np.log(100e-6))))
        edge = float(rng.choice([0.0, 0.0, rng.uniform(20e-6, 200e-6)]))
        middle, place = (rng.random(2) - 0.5) * cell, rng.uniform(0.0, 0.15e-3)
        fault = Fault(kind, length=rng.uniform(0.30e-3, 0.40e-3), depth=depth, edge=edge)
        errors.setdefault((kind, hardness), []).append(missed(fault, hardness, cell, middle, place))
    print_errors(errors)
    errors = {}
    shapes = [each for group in SLOPES.values() for each in group]
    for kind, hardness in itertools.product(("pit", "spall"), (1.5e9, 2e9, 3e9, 4e9)):
        for (depth, edge), size in itertools.product(shapes, np.arange(0.30e-3, 0.405e-3, 0.01e-3)):
            fault = Fault(kind, length=size, depth=depth, edge=edge)
            middle, place = (rng.random(2) - 0.5) * cell, rng.uniform(0.0, 0.15e-3)
            errors.setdefault((kind, hardness), []).append(missed(fault, hardness, cell, middle, place))
    print_errors(errors)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    chosen = parser.add_mutually_exclusive_group()
    for name, function in {"check": check, "faults": check_faults, "flow": check_flow}.items():
        chosen.add_argument(f"--{name}", dest="work", action="store_const", const=function)
    (parser.parse_args().work or print_curves)()
