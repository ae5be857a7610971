"""Checks of friction: examples of the program CONTACT, as it prints them."""

import math
from functools import partial

import numpy as np
from ledger import Check
from scipy.special import ellipe, ellipk

from asperity import Friction, FrictionalHalfSpace, HalfSpace, Hertz, Material
from asperity.contact.creep import RollingEllipse
from asperity.contact.friction import cell_places

RAIL = (82e9, 0.28)
"""Shear modulus, Pa, and Poisson's ratio of a body, as that of wheel and rail."""


def source(example, note="to the digits printed"):
    return f"program CONTACT, rev. 2707, example {example}; {note}"


def two_bodies(shape, spacing, friction, first, second=None):
    """Two bodies on a grid, from shear moduli and Poisson's ratios."""
    pair = [np.array(each) for each in (first, second or first)]
    shear = 2.0 / sum(1.0 / g for g, _ in pair)
    poisson = 0.5 * shear * sum(nu / g for g, nu in pair)
    bodies = tuple(Material("body", 2.0 * g * (1.0 + nu), nu, 1.0) for g, nu in pair)
    return FrictionalHalfSpace(HalfSpace(shape, spacing, shear / (1.0 - poisson)), bodies, friction)


def pressed(rolling, a_x, b_y, load, middle=(0.0, 0.0)):
    """The contact of a gap ``a_x x² + b_y y²``, 1/m, around a place of the grid, m."""
    x, y = cell_places(rolling.half_space)
    return rolling.half_space.solve(a_x * (x - middle[0]) ** 2 + b_y * (y - middle[1]) ** 2, load=load)


def in_cells(found):
    return np.count_nonzero(found.normal.pressure), np.count_nonzero(found.sticks)


def carter():
    rolling = two_bodies((55, 1), (0.04e-3, 0.2), 0.3, RAIL)
    contact = pressed(rolling, 1.0, 0.0, 35780.0, middle=(-0.03e-3, 0.0))
    found = rolling.roll(contact, (-0.00024, 0.0), distance=0.0401e-3, speed=30.0)
    row = partial(Check, body="cylinder on a plane, 55 cells", source=source("carter2d"), absolute=True)
    yield row("force / friction", 0.6480, found.force[0] / found.limit, tolerance=5e-5)
    yield row("cells that stick, of 50", 30, in_cells(found)[1], tolerance=0.0)
    yield row("power", 47.62, found.work_of_slip * found.speed, "W", tolerance=5e-3)


def cattaneo():
    rolling = two_bodies((19, 19), (0.13333e-3, 0.13333e-3), 0.4, (200e6, 0.42))
    contact = pressed(rolling, 10.0, 10.0, 9.1954)
    found = rolling.shift(contact, force=(-0.875 * 0.4 * contact.force, None))
    row = partial(Check, body="ball of polyethylene, 19²", source=source("cattaneo"), absolute=True)
    yield row("shift under 7/8 of the friction", 8.155e-6, found.creepage[0], "µm", tolerance=5e-4)
    yield row("cells that stick, of 177", 45, in_cells(found)[1], tolerance=0.0)
    yield row("work", 2.750e-6, found.work_of_slip, "J", tolerance=5e-10)


def onset_of_rolling():
    rolling = two_bodies((34, 33), (0.25e-3, 0.25e-3), 0.4013, (1e6, 0.28))
    contact = pressed(rolling, 2.963, 2.963, 0.4705, middle=(-0.125e-3, 0.0))
    force = (-0.657 * 0.4013 * contact.force, None)
    state = rolling.shift(contact, force=force)
    row = partial(
        Check, body="from Cattaneo to Carter, 34 × 33", source=source("catt_to_cart"), absolute=True
    )
    yield row("shift", 17.74e-6, state.creepage[0], "µm", tolerance=5e-3)
    printed = {1: 1.824e-3, 2: 1.882e-3, 5: 2.140e-3, 29: 3.093e-3, 56: 3.101e-3}
    for step in range(1, 57):
        state = rolling.roll(contact, force=force, before=state, start=state)
        if step in printed:
            found = state.creepage[0]
            yield row(f"creepage after {step} cells", printed[step], found, tolerance=5e-7)


def creep_curve():
    smooth = Hertz(RAIL[0] / (1.0 - RAIL[1]), 0.625, 1.7767208179193736)
    axes = smooth.semi_axes(smooth.approach(106.7e3))
    rolling = two_bodies((48, 44), (2.2 * axes[0] / 48, 2.2 * axes[1] / 44), 0.33, RAIL)
    contact = pressed(rolling, 0.8, 0.5 / smooth.radius_y, 106.7e3)
    row = partial(Check, body="wheel, a/b = 0.5, 48 × 44", source=source("tractcurv"), absolute=True)
    yield row("approach", 76.51e-6, contact.approach, "µm", tolerance=5e-3)
    percent = [0.001, 0.04, 0.08, 0.12, 0.16, 0.2, 0.24, 0.28, 0.32, 0.36, 0.6]
    shares = [0.007015, 0.2588, 0.4742, 0.6482, 0.7831, 0.8816, 0.9467, 0.9832, 0.9976, 0.9991, 0.9997]
    for creepage, share in zip(percent, shares, strict=True):
        found = -rolling.roll(contact, (0.01 * creepage, 0.0)).force[0] / (0.33 * contact.force)
        yield row(f"force / friction at {creepage:g} %", share, found, tolerance=5e-5)


def spin_and_lateral():
    (a, b), load, spin = (8e-3, 4e-3), 82e3, 0.625
    rolling = two_bodies((44, 44), (2.2 * a / 44, 2.2 * b / 44), 0.3, RAIL)
    m = 1.0 - (b / a) ** 2
    k, e = ellipk(m), ellipe(m)
    unit = 1.5 * load / (math.pi * a**3 * m * rolling.half_space.modulus)
    contact = pressed(rolling, unit * (k - e), unit * ((a / b) ** 2 * e - k), load)
    found = rolling.roll(contact, (0.0, -0.625e-3), spin, distance=0.4e-3, speed=30.0)
    row = partial(Check, body="ellipse 8 × 4 mm, 44², lateral creepage and spin", absolute=True)
    exact = partial(row, source=source("fastsim"))
    yield exact("force across / friction", -0.6074, found.force[1] / found.limit, tolerance=5e-5)
    yield exact("moment", -48.21, found.moment, "N m", tolerance=5e-3)
    yield exact("cells that stick, of 1276", 356, in_cells(found)[1], tolerance=0.0)
    yield exact("power", 540.4, found.work_of_slip * found.speed, "W", tolerance=0.05)
    fast = WithPrintedFlexibilities((a, b), *RAIL).fastsim_force((0.0, -0.625e-3), spin, 0.3 * load)
    limit = -0.6359 + (-0.6359 + 0.6118) / 4.0  # of first order in cells, of which there are 40² and 200²
    note = "cases 2 and 5, extrapolated, with its flexibilities"
    yield row(
        "the same by FASTSIM", limit, fast[1] / (0.3 * load), source=source("fastsim", note), tolerance=0.003
    )


class WithPrintedFlexibilities(RollingEllipse):
    """FASTSIM of an ellipse 8 × 4 mm with what is printed: 4.937e-5, 5.152e-5 and 4.090e-5 mm³/N."""

    coefficients = (
        8.0 * 8.0 / (3.0 * 82e3 * 4.937e-5),
        8.0 * 8.0 / (3.0 * 82e3 * 5.152e-5),
        math.pi * 8.0 * math.sqrt(2.0) / (4.0 * 82e3 * 4.090e-5),
    )


def falling_friction():
    falling = Friction(0.3, kinetic=0.6, velocity=0.1 / math.log(2.0))
    rolling = two_bodies((92, 1), (0.1e-3, 0.2), falling, RAIL)
    x, _ = cell_places(rolling.half_space)
    contact = rolling.half_space.solve(0.46 - np.sqrt(0.46**2 - (x - 0.05e-3) ** 2), load=622216.0)
    found = rolling.roll(contact, (-0.0009999, 0.0), speed=45.0)
    row = partial(Check, body="cylinder, friction falls by 0.12", source=source("veldep_fric"), absolute=True)
    yield row("force / friction", 0.5941, found.force[0] / (0.3 * contact.force), tolerance=5e-5)
    yield row("cells that stick, of 81", 45, in_cells(found)[1], tolerance=0.0)
    yield row("power", 4849.0, found.work_of_slip * found.speed, "W", tolerance=0.5)


def unlike_ball():
    """Pressed in 35 stages: friction, pressure and traction that act on each other."""
    rolling = two_bodies((45, 45), (0.2e-3, 0.2e-3), 0.2986, (0.5e6, 0.0), (1e11, 0.0))
    state = None
    for stage in range(1, 36):
        load = round((stage / 45) ** 3, 6)
        state = rolling.shift(pressed(rolling, 4.116, 4.116, load, middle=(-1e-7, -1e-7)), before=state)
    row = partial(Check, body="soft ball on a rigid plane, 45²", source=source("spence35"), absolute=True)
    yield row("approach", 98.74e-6, state.normal.approach, "µm", tolerance=5e-3)
    near = source("spence35", "to 0.7 of the last digit printed")
    yield row("largest pressure", 23920.0, state.normal.pressure.max(), "Pa", source=near, tolerance=7.0)
    yield row("cells in contact", 921, in_cells(state)[0], tolerance=0.0)
    yield row("cells that stick", 225, in_cells(state)[1], tolerance=0.0)
    yield row("work of the last stage", 1.842e-8, state.work_of_slip, "J", tolerance=5e-12)


def unlike_cylinders():
    """Rolling to the other side there: forces and creepages change their sign."""
    printed = {  # friction, force over it: creepage, cells in contact and cells that stick
        (1e-4, 0.0): (5.260e-4, 200, 1),
        (10.0, 0.0): (3.591e-4, 200, 200),
        (0.05, 0.0): (4.294e-4, 200, 125),
        (0.05, 0.75): (2.108e-4, 200, 36),
        (0.05, -0.75): (5.392e-4, 201, 106),
    }
    for (friction, share), (creepage, touching, sticking) in printed.items():
        rolling = two_bodies((216, 1), (1e-6, 1.0), friction, (23e9, 0.31), RAIL)
        contact = pressed(rolling, 20.0, 0.0, 16201.9)
        found = rolling.roll(contact, force=(-share * friction * contact.force, None), speed=1.0)
        body = f"aluminium on steel, µ = {friction:g}, F = {share:g} µP"
        row = partial(Check, body=body, source=source("bentall"), absolute=True)
        yield row("creepage", creepage, -found.creepage[0], tolerance=5e-8)
        yield row("cells in contact", touching, in_cells(found)[0], tolerance=0.0)
        yield row("cells that stick", sticking, in_cells(found)[1], tolerance=0.0)
