"""The gap that a straight rim of a contact leaves at the centre of a cell: the curves of `kernels.rims`.

    python benchmarks/cell_rims.py

Inside a straight rim, at a distance s, the pressure is √s (E* and the cell's width are one); outside of it
the surfaces part by (4/3)(−s)^(3/2). Cells hold the mean of that pressure. What they displace at the centre
of one of them differs from what the pressure displaces, and that difference, with the gap, is what the cell
keeps.

- Rim along an axis of the grid: all is plane, and the sums over cells are in closed form but for the pressure
  itself, which is constant on parts of a cell; cells far away act as dipoles.
- Rim along the diagonal: the mean along the rim is plane, with hats in place of cells; what cells differ from
  their mean along the rim decays within a few of them, and is summed on a fine grid.

Printed are the curves over √(p/S), S the step of the pressure between the neighbours, as they stand in the
kernel, and the share of the cell that is covered.
"""

import numpy as np
from scipy.interpolate import PchipInterpolator

from asperity.kernels.batched import convolve_padded, padded_spectrum
from asperity.kernels.influence import influence_table
from asperity.kernels.rims import KNOTS

FAR = 400
"""Cells inside the rim that are summed one by one."""
PARTS = 64
"""Parts of a cell on which the pressure is constant."""
FINE, NEAR = 16, 15
"""Parts of a cell, and cells, of the sum beside the diagonal."""


def once(s):
    """First integral of √s, zero outside."""
    return 2.0 / 3.0 * np.maximum(s, 0.0) ** 1.5


def twice(s):
    """Second integral of √s, zero outside."""
    return 4.0 / 15.0 * np.maximum(s, 0.0) ** 2.5


def cell_mean(s):
    """Mean over a width of one about s."""
    return once(s + 0.5) - once(s - 0.5)


def hat_mean(s, half):
    """Mean under a hat about s."""
    return (twice(s + half) - 2.0 * twice(s) + twice(s - half)) / half**2


def displacement(edges, density, place):
    """Displacement of a plane half-space at a place by pressures that are constant between edges."""

    def integral(z):
        return z - z * np.log(np.abs(np.where(z == 0.0, 1.0, z)))

    return 2.0 / np.pi * np.sum(density * (integral(place - edges[:-1]) - integral(place - edges[1:])))


def gap_beyond(s):
    """Gap of the deformed surfaces outside of the rim."""
    return 4.0 / 3.0 * max(-s, 0.0) ** 1.5


def along_axis(s):
    """Pressure of the cell whose centre is at s, step beside it, and the gap that it keeps."""
    centres = s + np.arange(-6, FAR)
    edges = np.append((centres[:, None] - 0.5 + np.arange(PARTS) / PARTS).ravel(), centres[-1] + 0.5)
    excess = np.repeat(cell_mean(centres), PARTS) - PARTS * np.diff(once(edges))
    beyond = 1.0 / (6.0 * np.pi * np.sqrt(edges[-1]))  # dipoles −1/(24 √s) of cells farther inside
    kept = displacement(edges, excess, s) + beyond + gap_beyond(s)
    return cell_mean(s), cell_mean(s + 1.0) - cell_mean(s - 1.0), kept


def along_diagonal(s):
    """Likewise for a rim along the diagonal."""
    half = np.sqrt(0.5)
    numbers = np.arange(-8, int(FAR / half) + 3)
    nodes, means = s + half * numbers, hat_mean(s + half * numbers, half)
    edges = s + half * np.arange(-6 * PARTS, int(FAR / half) * PARTS) / PARTS
    middle = 0.5 * (edges[1:] + edges[:-1])
    excess = np.interp(middle, nodes, means) - PARTS * np.diff(once(edges)) / half
    last = edges[-1]
    beyond = (
        half**2 / 12.0 / np.pi * (2.0 * np.log(last) + 4.0) / np.sqrt(last)
    )  # of half²/6 d²√s/ds² farther inside
    kept = displacement(edges, excess, s) + beyond + beside_diagonal(s, half) + gap_beyond(s)
    return hat_mean(s, half), np.sqrt(2.0) * (hat_mean(s + half, half) - hat_mean(s - half, half)), kept


def beside_diagonal(s, half, inner=4):
    """Displacement at the middle cell by what cells differ from their mean along the diagonal."""
    size = FINE * NEAR
    spectrum = padded_spectrum(influence_table(size, size, 1.0 / FINE, 1.0 / FINE) / np.pi, size, size)
    nodes = s + half * np.arange(-2 * NEAR, 2 * NEAR + 1)
    means = hat_mean(nodes, half)
    places = (np.arange(size * inner) + 0.5) / (FINE * inner) - 0.5 * NEAR
    smooth = np.interp(np.add.outer(places, places) * half + s, nodes, means)
    smooth = smooth.reshape(size, inner, size, inner).mean(axis=(1, 3))
    cells = np.arange(NEAR) - NEAR // 2
    whole = np.kron(hat_mean(np.add.outer(cells, cells) * half + s, half), np.ones((FINE, FINE)))
    spread = convolve_padded((whole - smooth)[None], spectrum, np)[0]
    middle = size // 2
    return spread[middle - 1 : middle + 1, middle - 1 : middle + 1].mean()


def covered_along_axis(s):
    """Share of the cell inside the rim."""
    return np.clip(s + 0.5, 0.0, 1.0)


def covered_along_diagonal(s):
    """Likewise, along the diagonal."""
    t = np.clip(s * np.sqrt(2.0), -1.0, 1.0)
    return np.where(t < 0.0, 0.5 * (1.0 + t) ** 2, 1.0 - 0.5 * (1.0 - t) ** 2)


def curves(kept, covered, first):
    """Curves on the knots of the kernel; the rim touches the cell when its centre is at `first`."""
    places = np.concatenate([first + np.geomspace(1e-3, 0.05, 12), np.linspace(first + 0.06, 2.4, 80)])
    rows = np.array([kept(s) for s in (first + 1e-9, *places)])
    ratio = np.sqrt(np.maximum(rows[:, 0] / rows[:, 1], 0.0))
    ratio[0] = 0.0
    knots = np.linspace(0.0, 1.0, KNOTS)
    gap = PchipInterpolator(ratio, rows[:, 2] / rows[:, 1])(knots)
    gap = np.minimum.accumulate(np.maximum(gap, 0.0))
    gap[-1] = 0.0
    share = PchipInterpolator(ratio, np.append(0.0, covered(places)))(knots)
    return gap, np.minimum(np.maximum.accumulate(share), 1.0)


def main():
    """Print the curves."""
    for name, kept, covered, first in (
        ("axis", along_axis, covered_along_axis, -0.5),
        ("diagonal", along_diagonal, covered_along_diagonal, -np.sqrt(0.5)),
    ):
        for what, values in zip(("gap", "covered"), curves(kept, covered, first), strict=True):
            print(f"{what}, rim along the {name}:")
            print(np.array2string(values, separator=", ", precision=5, max_line_width=100, floatmode="fixed"))


if __name__ == "__main__":
    main()
