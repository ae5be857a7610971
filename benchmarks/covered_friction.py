"""Friction on covered cells: against closed forms and the limit of small cells, and how many contacts settle.

    python benchmarks/covered_friction.py            # errors with 6 and 9 cells in the smaller semi-axis
    python benchmarks/covered_friction.py --settle   # contacts at random: which do not settle
    python benchmarks/covered_friction.py --samples  # rough samples: their share of the smooth force

Balls and ellipses of like bodies, anywhere on the grid, beside those on whole cells. Shifts are Cattaneo's
and Mindlin's, exact without Poisson's ratio. The limit of steady rolling is told by whole cells on two grids,
of 40 and 80 cells, in first order; its errors are those of both forces over the friction and of the moment
over that and the mean semi-axis. Rough contacts have heights that are smoothed by a Gaussian of 1.5 cells;
those of samples are means of a texture on cells a quarter as large, where whole ones tell the limit.
"""

import argparse
import math
import warnings

import numpy as np
from scipy.ndimage import gaussian_filter

from asperity import Friction, FrictionalHalfSpace, HalfSpace, Hertz, Material
from asperity.contact.creep import over_smooth, rolled_over
from asperity.errors import OutOfRangeWarning, UnconvergedWarning

FRICTION, SHEAR, LOAD, RADIUS = 0.3, 1e9, 100.0, 0.1
OFFSETS = [(0.0, 0.0), (0.5, 0.5), (0.4, 0.2)]
"""Of the middle of a contact from that of a cell, in cells."""
RATIOS = (1.0, 0.4, 2.5)
"""Second radius over the first."""
SHARES = (0.2, 0.3, 0.6, 0.9)
"""Of what friction carries, in a shift."""
MOTIONS = {
    "creepages, some spin": [(2e-3, 0.0, 0.0), (0.0, 2e-3, 0.0), (2e-3, 1.5e-3, 2e-3), (0.0, 0.0, 2e-3)],
    "much spin": [(1e-3, 0.0, 5e-3), (0.0, 0.0, 8e-3)],
    "all pivots": [(0.0, 0.0, 2e-2)],
}
"""Creepages, and spin times the mean semi-axis."""
TURNS = (0.8, -0.6, 0.7, -0.2)
"""Friction between which a shift turns back, over the most there is."""
SETTLING = 600
PARTS = 4
"""Of a side of a cell in which the limit of rough samples is found."""
SAMPLES = 6


def contact(across, ratio, nu, offset, cells, shape=1.0, rough=None):
    """A contact of so many cells in its smaller semi-axis; its solver, semi-axes, and its middle, m."""
    modulus = SHEAR / (1.0 - nu)
    smooth = Hertz(modulus, RADIUS / ratio, RADIUS)
    axes = smooth.semi_axes(smooth.approach(LOAD))
    sides = np.array([math.sqrt(shape), 1.0 / math.sqrt(shape)]) * min(axes) / across
    counts = tuple(2 * math.ceil(axis / side) + 5 for axis, side in zip(axes, sides, strict=True))
    middle = np.multiply(offset, sides)
    x, y = (s * (np.arange(n) - 0.5 * (n - 1)) - m for n, s, m in zip(counts, sides, middle, strict=True))
    curvatures = np.array((ratio / RADIUS, 1.0 / RADIUS))
    gap = 0.5 * np.add.outer(curvatures[0] * x**2, curvatures[1] * y**2)
    if cells == "covered":
        gap += curvatures @ sides**2 / 24.0
    if rough is not None:
        rms, random = rough
        heights = gaussian_filter(random.normal(size=counts), 1.5, mode="wrap")
        gap -= rms * smooth.approach(LOAD) * heights / heights.std()
    space = HalfSpace(counts, tuple(sides), modulus, cells=cells)
    body = Material("body", 2.0 * SHEAR * (1.0 + nu), nu, 7850.0)
    solver = FrictionalHalfSpace(space, (body, body), FRICTION)
    return space.solve(gap, load=LOAD), solver, axes, middle


def shifted(across, cells):
    """Largest errors of shift and stick area of a ball, over those of Cattaneo and Mindlin."""
    errors = []
    for offset in OFFSETS:
        normal, solver, (a, _), _ = contact(across, 1.0, 0.0, offset, cells)
        full = 3.0 * FRICTION * LOAD / (4.0 * SHEAR * a)
        for share in SHARES:
            found = solver.shift(normal, force=(-share * FRICTION * LOAD, None))
            shift = full * (1.0 - (1.0 - share) ** (2 / 3))
            stick = math.pi * a**2 * (1.0 - share) ** (2 / 3)
            errors.append((found.creepage[0] / shift - 1.0, found.stick_area / stick - 1.0))
    return np.abs(errors).max(axis=0)


def turned_back(across, cells):
    """Largest error of the shift of a ball under friction that turns back, over that at which all slips.

    By twice the first curve of half of the force, from turn to turn (Mindlin and Deresiewicz).
    """
    errors = []
    for offset in OFFSETS:
        normal, solver, (a, _), _ = contact(across, 1.0, 0.0, offset, cells)
        full = 3.0 * FRICTION * LOAD / (4.0 * SHEAR * a)
        state, at, start, place = None, 0.0, 0.0, 0.0
        for turns, corner in enumerate(TURNS):
            times = 2.0 if turns else 1.0
            for force in np.linspace(at, corner, 4)[1:]:
                state = solver.shift(normal, force=(-force * FRICTION * LOAD, None), before=state)
                place += state.creepage[0]
                grown = times * full * (1.0 - (1.0 - abs(force - at) / times) ** (2 / 3))
                grown = math.copysign(grown, force - at)
                errors.append((place - start - grown) / full)
            at, start = corner, start + grown
    return np.abs(errors).max()


def rolled(across, ratio, motion, offset, cells):
    """Forces over friction, and the moment over that and the mean semi-axis, about the middle."""
    normal, solver, axes, (x, y) = contact(across, ratio, 0.3, offset, cells)
    mean = math.sqrt(axes[0] * axes[1])
    xi, eta, spin = motion[0], motion[1], motion[2] / mean
    found = solver.roll(normal, (xi + spin * y, eta - spin * x), spin)
    along, aside = found.force
    moment = found.moment - (x * aside - y * along)
    return np.array((along, aside, moment / mean)) / found.limit


def fallen(across, offset, cells, friction):
    """Force of a ball that rolls, over the load."""
    normal, solver, *_ = contact(across, 1.0, 0.3, offset, cells)
    found = FrictionalHalfSpace(solver.half_space, solver.bodies, friction).roll(normal, (2e-3, 0.0))
    return found.force[0] / LOAD


def errors_where_friction_falls(columns):
    """Largest errors of the force where friction falls at once to a half, over the force in the limit.

    There all cells have the half, for which two grids of whole cells stand.
    """
    coarse, fine = (fallen(n, OFFSETS[0], "whole", 0.5 * FRICTION) for n in (40, 80))
    limit = 2.0 * fine - coarse
    falling = Friction(FRICTION, kinetic=0.5)
    forces = [[fallen(across, each, cells, falling) for each in OFFSETS] for across, cells in columns]
    return np.abs(np.array(forces) / limit - 1.0).max(axis=1)


def errors():
    """Print the table of errors."""
    print("| largest error, % | covered, 6 | 9 | whole, 6 | 9 |")
    columns = [(across, cells) for cells in ("covered", "whole") for across in (6, 9)]
    found = np.array([shifted(*each) for each in columns])
    for name, values in zip(("shift of a ball", "its stick area"), found.T, strict=True):
        print(f"| {name} |", " | ".join(f"{100.0 * each:.2f}" for each in values), "|")
    turned = [turned_back(*each) for each in columns]
    print("| shift of a ball that turns back |", " | ".join(f"{100.0 * each:.2f}" for each in turned), "|")
    for name, motions in MOTIONS.items():
        largest = np.zeros(len(columns))
        for ratio in RATIOS:
            for motion in motions:
                coarse, fine = (rolled(n, ratio, motion, OFFSETS[0], "whole") for n in (40, 80))
                limit = 2.0 * fine - coarse
                for k, (across, cells) in enumerate(columns):
                    misses = [rolled(across, ratio, motion, each, cells) - limit for each in OFFSETS]
                    largest[k] = max(largest[k], np.abs(misses).max())
        print(f"| rolling, {name} |", " | ".join(f"{100.0 * each:.2f}" for each in largest), "|")
    fallen_by = errors_where_friction_falls(columns)
    print("| rolling, friction halves at once |", " | ".join(f"{100.0 * e:.2f}" for e in fallen_by), "|")


def random_state(seed, rms, cells, way):
    """A shift, a contact in steady rolling, or the fifth step of a transient, drawn at random."""
    random = np.random.default_rng(seed)
    ratio, shape = np.exp(random.uniform(-1.2, 1.2)), np.exp(random.uniform(-0.7, 0.7))
    across, offset = random.uniform(5.0, 16.0), random.uniform(-0.5, 0.5, 2)
    normal, solver, axes, _ = contact(across, ratio, 0.3, offset, cells, shape, (rms, random))
    mean = math.sqrt(axes[0] * axes[1])
    xi, eta, spin = 10.0 ** random.uniform(-4.5, -2.0) * random.normal(size=3) * (random.random(3) < 0.7)
    if way == "shift":
        return solver.shift(normal, (xi * mean, eta * mean), spin)
    if way == "steady rolling":
        return solver.roll(normal, (xi, eta), spin / mean)
    state = solver.shift(normal)
    for _ in range(5):
        state = solver.roll(normal, (xi, eta), spin / mean, before=state)
    return state


def settle():
    """Print how many contacts do not settle, and the convolutions of one in the middle of them."""
    print(f"| of {SETTLING} | rms, approaches | covered: not settled | convolutions | whole: not settled | |")
    for way in ("shift", "steady rolling", "step of a transient"):
        for rms in (0.0, 0.02, 0.05):
            row = []
            for cells in ("covered", "whole"):
                found = [random_state(seed, rms, cells, way) for seed in range(SETTLING)]
                row.append(sum(not each.converged for each in found))
                row.append(round(float(np.median([each.convolutions for each in found]))))
            print(f"| {way} | {rms} |", " | ".join(map(str, row)), "|", flush=True)


def over_sample(across, cells, parts, heights, motion):
    """Mean force over a sample that is known on the finest grid, over the smooth one; steps not settled."""
    modulus = SHEAR / 0.7
    smooth = Hertz(modulus, RADIUS, RADIUS)
    side = smooth.semi_axes(smooth.approach(LOAD))[0] / (across * parts)
    count = heights.shape[1] * parts // PARTS
    x = side * (np.arange(count) - 0.5 * (count - 1))
    gap = np.add.outer(x**2, x**2) / (2.0 * RADIUS) + side**2 / (12.0 * RADIUS)
    space = HalfSpace(gap.shape, side, modulus, cells=cells)
    body = Material("body", 2.6 * SHEAR, 0.3, 7850.0)
    solver = FrictionalHalfSpace(space, (body, body), FRICTION)
    step = PARTS // parts
    means = heights.reshape(-1, step, count, step).mean(axis=(1, 3)) * smooth.approach(LOAD)
    ((steady, states),) = rolled_over(solver, space.solve(gap, load=LOAD), means, [motion])
    return over_smooth(steady, states, 0 if motion[0] else 1)[0], sum(not each.converged for each in states)


def samples():
    """Print largest errors of the share of rough samples in the smooth force."""
    print("| cells in the semi-axis | creepage | covered, % | not settled | whole, % |")
    for across in (6, 9):
        for motion in ((1.5e-3, 0.0, 0.0), (0.0, 5.5e-4, 0.0)):
            errors = []
            for seed in range(SAMPLES):
                shape = (13 * across + 9) * PARTS, (2 * across + 5) * PARTS
                heights = gaussian_filter(np.random.default_rng(seed).normal(size=shape), 1.5 * PARTS)
                heights *= 0.05 / heights.std()
                limit, _ = over_sample(across, "whole", PARTS, heights, motion)
                covered, left = over_sample(across, "covered", 1, heights, motion)
                whole, _ = over_sample(across, "whole", 1, heights, motion)
                errors.append((covered / limit - 1.0, left, whole / limit - 1.0))
            errors = np.abs(errors)
            largest = 100.0 * errors.max(axis=0)
            left = int(errors[:, 1].sum())
            print(f"| {across} | {motion[:2]} | {largest[0]:.2f} | {left} | {largest[2]:.2f} |", flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--settle", action="store_true", help="which contacts do not settle")
    parser.add_argument("--samples", action="store_true", help="the share of rough samples")
    asked = parser.parse_args()
    warnings.simplefilter("ignore", UnconvergedWarning)
    warnings.simplefilter("ignore", OutOfRangeWarning)
    if asked.settle:
        settle()
    elif asked.samples:
        samples()
    else:
        errors()
