"""Contacts on covered cells: that there is one, whether it is the only one, and what is not monotone.

    python benchmarks/rim_monotony.py             # that there is one; pressures where nothing is monotone
    python benchmarks/rim_monotony.py --contacts  # how many contacts are proved to be the only ones
    python benchmarks/rim_monotony.py --adversary # looks for pressures with a singular derivative

Lengths are in sides of a cell along, and E* is one. With numbers c, a and b of each cell, which
`rim_bounds` finds and proves, and matrices Δ of the differences, no other pressure solves a contact if

    K − diag(c) − Δₓᵀ diag(a) Δₓ − Δᵧᵀ diag(b) Δᵧ                                                      (1)

is positive definite: docs/method/theory.md has the proof.
"""

import argparse
import math
from functools import lru_cache
from itertools import combinations

import numpy as np
from cell_rims import rough_waves
from rim_bounds import SLANT_KNOTS, curve, left_in, numbers_of, times
from scipy.linalg import eig, eigh

from asperity import HalfSpace
from asperity.kernels.influence import means_table
from asperity.kernels.rim_curves import END, SLANTS
from asperity.kernels.rims import rim_slopes

NOT_MONOTONE = np.array([
    [4.2e-4, 1.0, 4.4e-4, 2.3e-4],
    [5.4e-4, 1.0e-3, 4.8e-4, 1.1e-4],
    [3.9e-4, 4.5e-1, 4.2e-4, 2.1e-1],
    [5.2e-4, 3.0e-4, 5.1e-4, 2.5e-4],
])  # fmt: skip
"""Pressures of cells, with none around them, whose derivative K + D − N is not positive."""
MARGIN = 1e-6
"""Eigenvalue of (1) that counts as positive."""


def largest_product():
    """Bound of u² L from above: p·R is at most this times the width times S²."""
    ratios = np.linspace(0.0, END, 2001)
    places = (each.ravel() for each in np.meshgrid(np.arange(2000), np.arange(SLANTS - 1)))
    u, m = (np.stack([each[i], each[i + 1]]) for each, i in zip((ratios, SLANT_KNOTS), places, strict=True))
    return times(u * u, curve(u, m)[0])[1].max()


def coercive(elongation, size=512):
    """Least of K's coefficients over that of a cell itself, and that over what R takes of it at most.

    Sides of the cells are 1 and the elongation.
    """
    table = means_table(size, size, 1.0, elongation) / math.pi
    return table.min() / table[0, 0], table[0, 0] / (4.0 * largest_product() * elongation)


def steps_beside(pressure):
    """Differences of the pressures beside each cell, not negative."""
    p = np.pad(pressure, 1)
    return np.abs(p[2:, 1:-1] - p[:-2, 1:-1]), np.abs(p[1:-1, 2:] - p[1:-1, :-2])


@lru_cache
def influence(shape, across=1.0):
    """Matrix K between the cells of a grid."""
    table = means_table(*shape, 1.0, across) / math.pi
    i, j = np.divmod(np.arange(shape[0] * shape[1]), shape[1])
    return table[np.abs(i[:, None] - i), np.abs(j[:, None] - j)]


@lru_cache
def beside(shape, axis):
    """Matrix of the differences between the cells on both sides of each."""
    one = [np.eye(n) for n in shape]
    one[axis] = np.eye(shape[axis], k=1) - np.eye(shape[axis], k=-1)
    return np.kron(*one)


def own_numbers(pressure, gap, across=1.0, hardness=math.inf):
    """Numbers (3, nx, ny) of the cells of a contact: c, and those of the differences along and across.

    Gaps are K p + g − δ.
    """
    flows = math.isfinite(hardness)
    fields = (pressure, *steps_beside(pressure), gap)
    p, x, y, gap = (each.ravel() / (hardness if flows else 1.0) for each in fields)
    kept = left_in(p, x, y, across, flows)
    gap = np.where(p > 0.0, kept, np.maximum(gap, kept))
    if flows:  # what holds of p and Γ holds of 1 − p and −Γ
        gap = np.where(p < 1.0, gap, np.minimum(fields[3].ravel() / hardness, kept))
        p, gap = np.minimum(p, 1.0 - p), np.where(p > 0.5, -gap, gap)
    size = np.stack([p, x, y]).max(0)
    cells = np.stack([p, x, y, np.where(size > 0.0, gap, 0.0)])
    if not flows:
        cells /= np.where(size > 0.0, size, 1.0)
    cells, places = np.unique(cells.round(14), axis=1, return_inverse=True)
    return numbers_of(cells, across, flows)[:, places.ravel()].reshape(3, *pressure.shape)


def left_over(numbers, across=1.0):
    """Smallest eigenvalue of (1): if it is positive, no other pressure solves the contact."""
    own, *beside_it = numbers
    matrix = influence(own.shape, across) - np.diag(own.ravel())
    for axis, each in enumerate(beside_it):
        differences = beside(own.shape, axis)
        matrix -= differences.T @ (each.reshape(-1, 1) * differences)
    return eigh(matrix, eigvals_only=True, subset_by_index=[0, 0])[0]


def contact_of_ball(cells, height, rng, across=1.0, hardness=math.inf):
    """Pressure and gap of a ball at a random place, of so many cells in its half-width at an approach of one.

    The rms height of its waves and its approach, 0.6 to 1.4, are in approaches.
    """
    shape = [math.ceil(2.6 * cells / side) + 4 for side in (1.0, across)]
    x, y = (
        (np.arange(count) - 0.5 * (count - 1) + rng.random()) * side / cells
        for count, side in zip(shape, (1.0, across), strict=True)
    )
    waves = rough_waves(x, height, rng.integers(2**31), y) if height else 0.0
    undeformed = cells * (0.5 * np.add.outer(x**2, y**2) + waves)
    flows = None if hardness == math.inf else hardness
    space = HalfSpace(shape, (1.0, across), 1.0, hardness=flows, cells="covered")
    approach = cells * (0.6 + 0.8 * rng.random())
    pressure = space.solve(undeformed, approach=approach, rtol=1e-10).pressure
    return pressure, space.displacement(pressure) + undeformed - approach


KINDS = (
    ("squares", 1.0, False),
    ("squares, with a hardness", 1.0, True),
    ("1 : 2", 2.0, False),
    ("2 : 1", 0.5, False),
    ("1 : 2, with a hardness", 2.0, True),
)
"""Sides of cells, that across over that along, and whether surfaces flow.

They do at 0.4 to 1 of Hertz's largest pressure at an approach of one.
"""


def check_contacts(count=4):
    """Print how many contacts are proved to be the only ones, of six cells in the half-width."""
    print(f"| sides of the cells | rms / approach | proved, of {count} | least of (1) |\n|---|---|---|---|")
    for name, across, flows in KINDS:
        for height in (0.0, 0.03, 0.1, 0.3):
            rng = np.random.default_rng(7)
            found = []
            for _ in range(count):
                hardness = rng.uniform(0.4, 1.0) * 2.0 / math.pi if flows else math.inf
                contact = contact_of_ball(6, height, rng, across, hardness)
                found.append(left_over(own_numbers(*contact, across, hardness), across))
            proofs = sum(each > MARGIN for each in found)
            print(f"| {name} | {height} | {proofs} | {min(found):.3f} |", flush=True)


def derivative(pressure):
    """Matrices K + D and N of the derivative of K p − R."""
    own, along, across = slopes_ = np.zeros((3, *pressure.shape))
    rim_slopes(pressure, 1.0, 1.0, math.inf, slopes_)
    beside_it = [beside(pressure.shape, axis) for axis in (0, 1)]
    n = along.reshape(-1, 1) * beside_it[0] + across.reshape(-1, 1) * beside_it[1]
    return influence(pressure.shape) - np.diag(own.ravel()), n


def not_monotone(pressure):
    """Smallest eigenvalue of the symmetric part of the derivative."""
    stiff, n = derivative(pressure)
    return np.linalg.eigvalsh(stiff - 0.5 * (n + n.T))[0]


def least_minor(pressure):
    """Least principal minor of the derivative, over the product of its diagonal in K + D.

    Where all are positive, any small change of the pressure has a cell whose residual changes the same way.
    """
    stiff, n = derivative(pressure)
    scaled = (stiff - n) / np.diag(stiff)[:, None]
    kept = [np.array(list(combinations(range(len(n)), k + 1))) for k in range(len(n))]
    return min(np.linalg.det(scaled[each[:, :, None], each[:, None, :]]).min() for each in kept)


def nearest_to_singular(pressure):
    """Largest real eigenvalue of (K + D)⁻¹N: at one the derivative is singular; and its two vectors."""
    stiff, n = derivative(pressure)
    values, left, right = eig(n, stiff, left=True)
    real = np.where(np.abs(values.imag) < 1e-9, values.real, -math.inf)
    k = real.argmax()
    return real[k], left[:, k].real, right[:, k].real


def climb(size, rng, tries=300):
    """Look for a pressure whose derivative is nearest to singular, from a random one; return how near."""
    logs = rng.normal(size=(size, size)) * rng.choice([0.3, 1.0, 3.0, 5.0])
    logs = np.clip(logs, -25.0, 5.0)
    best, left, right = nearest_to_singular(np.exp(logs))
    step = 0.5
    for _ in range(tries):
        shape = (60, size, size)
        moved = rng.random(shape) < rng.choice([1.0 / size**2, 0.1, 0.3, 1.0], size=(60, 1, 1))
        tried = logs + step * np.exp(rng.normal(size=(60, 1, 1))) * rng.normal(size=shape) * moved
        tried = np.clip(tried, -25.0, 5.0)
        gains = []
        for each in tried:
            stiff, n = derivative(np.exp(each))
            gains.append(left @ (n - best * stiff) @ right / (left @ stiff @ right))
        found = np.exp(tried[int(np.argmax(gains))])
        value, *vectors = nearest_to_singular(found)
        step *= 1.1 if value > best else 0.95
        if value > best:
            best, logs = value, np.log(found)
            left, right = vectors
    return best


def look_for_singular(starts=8):
    """Print how near to singular derivatives are that are looked for."""
    print("| cells | largest real eigenvalue of (K + D)⁻¹N |\n|---|---|")
    for size in (3, 4, 5, 6):
        rng = np.random.default_rng(size)
        print(f"| {size} × {size} | {max(climb(size, rng) for _ in range(starts)):.3f} |", flush=True)


def print_numbers():
    """Print what the proof of a solution takes, and what is not monotone."""
    print(f"u² L is at most {largest_product():.4f}")
    print("| elongation | least coefficient of K over the largest | the largest over what R takes |")
    print("|---|---|---|")
    for elongation in (1.0, 2.0, 4.0, 8.0):
        smallest, times_over = coercive(elongation)
        print(f"| {elongation:.0f} | {smallest:.4f} | {times_over:.2f} |")
    eigenvalue, near = not_monotone(NOT_MONOTONE), nearest_to_singular(NOT_MONOTONE)[0]
    print(
        f"Not monotone: eigenvalue {eigenvalue:.3f}; largest real eigenvalue of (K + D)⁻¹N {near:.3f}; ",
        end="",
    )
    print(f"least principal minor {least_minor(NOT_MONOTONE):.3f} of the diagonal")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    work = {"contacts": check_contacts, "adversary": look_for_singular}
    chosen = parser.add_mutually_exclusive_group()
    for name, function in work.items():
        chosen.add_argument(f"--{name}", dest="work", action="store_const", const=function)
    (parser.parse_args().work or print_numbers)()
