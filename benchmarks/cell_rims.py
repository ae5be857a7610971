"""The gap that is left in cells at the rim of a contact, and their covered share: curves of `kernels.rims`.

    python benchmarks/cell_rims.py            # the curves, as they stand in the kernel
    python benchmarks/cell_rims.py --check    # against Hertz, 4 to 24 cells

The contact of a ball on a half-space is known in closed form: half-width, approach, radius and modulus E*
are one, δ = a² = 1, and the pressure is (2/π) √(1 − r²). Its means over cells, displaced by the coefficients
between means, with the means of the undeformed gap, tell what is left of the gap in each cell. Over the
step S of the pressure beside the cell, it is a function of √(p/S), of the slant, and of the side of a
cell over the half-width h/a. Balls of all sizes, at random places on the grid, are fitted by

    left = left₀(√(p/S), slant) + h/a · left₁(√(p/S), slant)

with cubic splines on the knots of the kernel, straight between slants. The curves are those of h/a = 1/9,
between a straight rim and the smallest contacts that have a rim at all.
"""

import argparse
import math

import numpy as np

from asperity import HalfSpace
from asperity.kernels.batched import convolve_padded, padded_spectrum
from asperity.kernels.influence import means_table
from asperity.kernels.rims import END, KNOTS, PER_UNIT, SLANTS, cubics

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


def cells_of_ball(across, offset):
    """Ratio, slant, gap that is left, covered share and side of cells at the rim of a ball's contact."""
    side, count = 1.0 / across, math.ceil(across) + 4
    edges = [(np.arange(-count, count + 2) - 0.5 + o) * side for o in offset]
    (pressure, covered), size = means_of_ball(*edges), 2 * count + 1
    pressure *= 2.0 / math.pi
    spectrum = padded_spectrum(means_table(size, size, side, side) / math.pi, size, size)
    x, y = (0.5 * (e[1:] + e[:-1]) for e in edges)
    undeformed = 0.5 * np.add.outer(x**2, y**2) + side**2 / 12.0
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


def fitted(cells, values, first, last, fine, smoothness=1e-3):
    """Curves (SLANTS, KNOTS) of a side `fine`; `first` and `last` values are given, or None."""
    knots = influence_of_knots(cells[0], cells[1])
    thick = np.zeros((KNOTS, KNOTS // 3 + 1))  # h/a counts smoothly
    for n in range(thick.shape[1]):
        thick[:, n] = np.maximum(1.0 - np.abs(np.arange(KNOTS) / 3.0 - n), 0.0)
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
            blocks.append(np.hstack([np.kron(np.eye(SLANTS), each) for each in (here, fine * here @ thick)]))
            targets.append(np.full(SLANTS, 1e4 * value))
    matrix, target = np.vstack(blocks), np.concatenate(targets)
    solution = np.linalg.lstsq(matrix, target, rcond=None)[0]
    print(f"# off by {np.std(values - (matrix @ solution)[: len(values)]):.4f}")
    size = SLANTS * KNOTS
    slope = solution[size:].reshape(SLANTS, -1) @ thick.T
    return solution[:size].reshape(SLANTS, KNOTS) + fine * slope


def print_curves():
    """Print the curves."""
    rng = np.random.default_rng(5)
    cells = np.concatenate(
        [
            cells_of_ball(across * (1.0 + 0.1 * rng.random()), rng.random(2) - 0.5)
            for across, count in BALLS.items()
            for _ in range(count)
        ],
        axis=1,
    )
    asked = (("LEFT", cells[2], None, 0.0, FINE), ("COVERED", cells[3], 0.0, 1.0, FINE))
    for name, values, first, last, fine in asked:
        found = fitted(cells, values, first, last, fine)
        found = np.clip(found, 0.0, 1.0) if name == "COVERED" else found
        text = np.array2string(
            found.round(4) + 0.0, separator=", ", max_line_width=100, formatter={"float": "{:.4f}".format}
        )
        print(f"{name} = np.array({text})")


def errors_of_ball(across, offset, count=200):
    """Stiffness (difference quotients), force and area of a ball against Hertz, relative."""
    side = 1.0 / across
    shape = (math.ceil(2.5 / side) + 6,) * 2
    x, y = ((np.arange(n) - 0.5 * (n - 1) - o) * side for n, o in zip(shape, offset, strict=True))
    gap = 0.5 * np.add.outer(x**2, y**2) + side**2 / 12.0
    half_space = HalfSpace(shape, side, 1.0, cells="covered")
    approaches = np.linspace(0.85, 1.15, count)
    contacts = [half_space.solve(gap, approach=d, rtol=1e-9) for d in approaches]
    force, area = (np.array([getattr(c, name) for c in contacts]) for name in ("force", "area"))
    middle = 0.5 * (approaches[1:] + approaches[:-1])
    quotient = np.diff(force) / np.diff(approaches)
    return (
        quotient / (2.0 * np.sqrt(middle)) - 1.0,
        force / (4.0 / 3.0 * approaches**1.5) - 1.0,
        area / (math.pi * approaches) - 1.0,
    )


def check():
    """Print errors against Hertz."""
    print(
        "cells in the half-width: largest error of k, mean and largest of F, mean and largest of the area, %"
    )
    for across in (4, 6, 9, 12, 18, 24):
        found = [
            100.0 * np.concatenate(e) for e in zip(*(errors_of_ball(across, o) for o in OFFSETS), strict=True)
        ]
        k, force, area = found
        words = [f"{np.abs(k).max():.3f}"]
        words += [f"{e.mean():+.4f} {np.abs(e).max():.4f}" for e in (force, area)]
        print(f"{across:3d}: " + ", ".join(words))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="contacts against Hertz")
    check() if parser.parse_args().check else print_curves()
