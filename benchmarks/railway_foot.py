"""How the foot of a rail flaps: waves of a 60E1 by finite elements of its section, and one mass on a spring.

    python benchmarks/railway_foot.py

Half of the section, in elements of nine nodes, moves as exp(i(ωt − kx)) along the rail: (K₀ + k K₁ + k² K₂) u
= ω² M u, with all three components of u. Waves up and down are those that are symmetric. A beam whose foot is
a mass on a spring follows the lowest of these waves; its mass and its frequency are found from these waves
alone, not from decay rates.
"""

from __future__ import annotations

from functools import cache
from itertools import pairwise, product

import numpy as np
import scipy.sparse as sparse
from scipy.optimize import brentq, least_squares
from scipy.sparse.linalg import eigsh

from asperity.structures.track import Track

YOUNG, POISSON, DENSITY = 210e9, 0.3, 7850.0
PRINTED = {"area / cm²": 76.70, "centroid / mm": 80.95, "upright / cm⁴": 3038.3, "sideways / cm⁴": 512.3}
"""Of a 60E1: area, height of the centroid, second moments of area, as in EN 13674-1."""
FOOT = (0.0, 50.1, 75.0), (31.5, 13.28, 11.5)
"""Half of the top of the foot, across and up, mm: 1:2.75 near the web, 1:14 outside."""
HEAD = (0.0, 10.0, 20.0, 26.0, 31.0, 36.5), (172.0, 171.8, 171.0, 169.8, 168.1, 164.0)
"""Half of the top of the head, mm, with its corner."""
FISHING = 121.0
"""Height, mm, at which the bottom of the head, 1:2.75, would meet the middle."""
WEB_HALF, WEB_MIDDLE, WEB_REACH, WEB_RADIUS = 8.25, 76.25, 45.0, 120.0
"""Half its thickness at its middle, height of that, how far it goes up and down, and radius of sides, mm."""
WAVENUMBERS = np.array([4.0, 8.0, 12.0, 16.0, 20.0, 22.0, 25.0])
"""rad/m: the lowest wave is from 0.7 to 5.4 kHz there."""


def web_half(height, flare):
    """Half thickness of the web, mm, with the share of its printed radius that its area leaves."""
    off = np.clip(np.abs(height - WEB_MIDDLE), 0.0, WEB_REACH)
    return WEB_HALF + flare * (WEB_RADIUS - np.sqrt(WEB_RADIUS**2 - off**2))


def blocks(flare):
    """Parts of the half section: place across and up, mm, at shares of both ways, and numbers of elements."""
    root = float(web_half(33.5, flare))
    neck = float(web_half(119.0, flare))
    low = float(np.interp(root, *FOOT))
    high = FISHING + neck / 2.75

    def foot(begin, end):
        def at(s, t):
            x = begin + s * (end - begin)
            return x, t * np.interp(max(x, root), *FOOT)

        return at

    def web(s, t):
        y = low + t * (high - low)
        return s * web_half(np.clip(y, 33.5, 119.0), flare), y

    def head(begin, end):
        def at(s, t):
            x = begin + s * (end - begin)
            bottom = FISHING + max(x, neck) / 2.75
            return x, bottom + t * (np.interp(x, *HEAD) - bottom)

        return at

    first, second, last = pairwise((0.0, root, *FOOT[0][1:]))
    feet = [(foot(*first), 2, 4), (foot(*second), 5, 4), (foot(*last), 4, 4)]
    return [*feet, (web, 2, 10), (head(0.0, neck), 2, 5), (head(neck, HEAD[0][-1]), 4, 5)]


def mesh(flare):
    """Nodes (n, 2), m, and those of each element (e, 9), three by three."""
    places = [
        [at((i + a / 2.0) / across, (j + b / 2.0) / up) for b in range(3) for a in range(3)]
        for at, across, up in blocks(flare)
        for i in range(across)
        for j in range(up)
    ]
    nodes, numbers = np.unique(np.round(np.reshape(places, (-1, 2)), 6), axis=0, return_inverse=True)
    return 1e-3 * nodes, numbers.reshape(-1, 9)


def shapes(at):
    """Lagrange's three shapes and their slopes at a place from −1 to 1."""
    values = np.array([at * (at - 1.0) / 2.0, 1.0 - at**2, at * (at + 1.0) / 2.0])
    return values, np.array([at - 0.5, -2.0 * at, at + 0.5])


def points(corners):
    """Weight, m², shapes (9,) and their slopes across and up (2, 9) at the nine points of an element."""
    gauss = list(zip(*np.polynomial.legendre.leggauss(3), strict=True))
    for (first, weight), (second, other) in product(gauss, repeat=2):
        (across, turned), (up, raised) = shapes(first), shapes(second)
        slopes = np.array([np.outer(up, turned).ravel(), np.outer(raised, across).ravel()])
        jacobian = slopes @ corners
        area = weight * other * np.linalg.det(jacobian)
        yield area, np.outer(up, across).ravel(), np.linalg.solve(jacobian, slopes)


def stiffness():
    """Of strains xx, yy, zz, yz, zx, xy."""
    shear = YOUNG / 2.0 / (1.0 + POISSON)
    found = np.diag([2.0 * shear] * 3 + [shear] * 3)
    found[:3, :3] += YOUNG * POISSON / (1.0 + POISSON) / (1.0 - 2.0 * POISSON)
    return found


def section_of(flare):
    """Area, m², height of the centroid, m, and second moments upright and sideways, m⁴."""
    nodes, elements = mesh(flare)
    sums = np.zeros(4)
    for corners in nodes[elements]:
        for weight, values, _ in points(corners):
            x, y = values @ corners
            sums += 2.0 * weight * np.array([1.0, y, y**2, x**2])
    area, first, second, sideways = sums
    return np.array([area, first / area, second - first**2 / area, sideways])


def printed_units(section):
    """The same in the units that are printed."""
    return section * np.array([1e4, 1e3, 1e8, 1e8])


@cache
def flare():
    """Of the web, so that the area is the one that is printed."""
    area = 1e-4 * PRINTED["area / cm²"]
    return brentq(lambda each: section_of(each)[0] - area, -0.2, 1.0, xtol=1e-4)


def matrices():
    """K₀, K₁, K₂ and M of symmetric motion, the component along the rail a quarter of a period behind."""
    nodes, elements = mesh(flare())
    held, count = stiffness(), 3 * len(nodes)
    found = [sparse.lil_matrix((count, count)) for _ in range(4)]
    for element in elements:
        own = np.zeros((4, 27, 27))
        for weight, values, (across, up) in points(nodes[element]):
            section, along, moves = np.zeros((6, 27)), np.zeros((6, 27)), np.zeros((3, 27))
            section[0, 0::3], section[1, 1::3], section[5, 0::3], section[5, 1::3] = across, up, up, across
            section[3, 2::3], section[4, 2::3] = up, across  # of i times the component along
            along[2, 2::3], along[3, 1::3], along[4, 0::3] = values, -values, -values
            for number in range(3):
                moves[number, number::3] = values
            own[0] += weight * section.T @ held @ section
            own[1] += weight * (section.T @ held @ along + along.T @ held @ section)
            own[2] += weight * along.T @ held @ along
            own[3] += weight * DENSITY * moves.T @ moves
        moved = (3 * element[:, None] + np.arange(3)).ravel()
        for whole, part in zip(found, own, strict=True):
            whole[np.ix_(moved, moved)] += part
    kept = np.setdiff1d(np.arange(count), 3 * np.flatnonzero(nodes[:, 0] < 1e-9))
    return [each.tocsc()[kept][:, kept] for each in found]


@cache
def lowest_waves(count=3):
    """Frequencies (k, count), Hz, of the lowest symmetric waves at `WAVENUMBERS`."""
    first, mixed, second, mass = matrices()
    begin = np.ones(mass.shape[0])
    found = []
    for k in WAVENUMBERS:
        squares = eigsh(first + k * mixed + k**2 * second, count, mass, sigma=-1e6, v0=begin)[0]
        found.append(np.sqrt(np.sort(squares)) / (2.0 * np.pi))
    return np.array(found)


def wavenumber(frequency, frequency_of_foot=np.inf, foot=0.0):
    """Of the package's rail without losses, rad/m, with a foot of so many kg/m on a spring; zero for none."""
    rail, omega = Track.named("uic60").rail, 2.0 * np.pi * frequency
    ratio = (frequency / frequency_of_foot) ** 2
    mass = rail.mass_per_length + foot * ratio / (1.0 - ratio)
    bending, shear, inertia = rail.bending_stiffness, rail.shear_stiffness, rail.rotary_inertia
    middle = omega**2 * (inertia + mass * bending / shear)
    last = 4.0 * bending * mass * omega**2 * (1.0 - inertia * omega**2 / shear)
    squares = middle + np.sqrt(np.maximum(middle**2 + last, 0.0))
    return np.sqrt(np.maximum(squares, 0.0) / (2.0 * bending))


@cache
def foot_on_spring():
    """Frequency, Hz, and mass, kg/m, of a foot whose rail has the lowest of the waves."""
    frequency = lowest_waves()[:, 0]

    def off(unknowns):
        return wavenumber(frequency, 1e3 * unknowns[0], unknowns[1]) / WAVENUMBERS - 1.0

    kilohertz, mass = least_squares(off, (6.5, 10.0)).x
    return 1e3 * kilohertz, mass


def main() -> None:
    for (what, value), computed in zip(PRINTED.items(), printed_units(section_of(flare())), strict=True):
        print(f"{what}: {computed:.2f}, printed {value:g}")
    frequency, mass = foot_on_spring()
    print(f"foot of {mass:.1f} kg/m at {frequency:.0f} Hz; wavenumbers of beams over those of the elements:")
    print("| kHz | rad/m | rigid section | foot on a spring |")
    print("|---:|---:|---:|---:|")
    lowest = lowest_waves()[:, 0]
    each = wavenumber(lowest), wavenumber(lowest, frequency, mass)
    for at, k, rigid, flaps in zip(lowest, WAVENUMBERS, *each, strict=True):
        print(f"| {1e-3 * at:.2f} | {k:g} | {rigid / k:.3f} | {flaps / k:.3f} |")


if __name__ == "__main__":
    main()
