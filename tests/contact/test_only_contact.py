"""Numbers that prove contacts on covered cells to be the only ones hold for the curves that there are."""

import math
import sys
from pathlib import Path

import numpy as np
import pytest

from asperity.kernels.rim_curves import LEFT, cubics, remaining_gap

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))
import rim_bounds
import rim_monotony
from rim_bounds import described, left_on, numbers_of, proved
from rim_monotony import NOT_MONOTONE, contact_of_ball, left_over, own_numbers


def left_there(p, x, y, elongation, flows):
    """The gap that is left, as kernels compute it."""
    if flows:
        return left_there(p, x, y, elongation, False) - left_there(1.0 - p, x, y, elongation, False)
    step = math.hypot(x, y)
    ratio = min(math.sqrt(p / step), rim_bounds.END)
    return step**2 / math.sqrt(x**2 + elongation * y**2) * remaining_gap(ratio, min(x, y) / max(x, y))[0]


def cells_of(pressure, x, y, across, flows):
    """A cell with the gap that is left in it, as `numbers_of` takes it."""
    return np.array([[pressure], [x], [y], [left_there(pressure, x, y, across**-2, flows)]])


@pytest.mark.parametrize("flows", [False, True])
@pytest.mark.parametrize("elongation", [1.0, 0.25, 4.0])
def test_boxes_hold_what_is_left_and_its_slopes(elongation, flows):
    rng = np.random.default_rng(2)
    low = np.stack([0.9 * rng.random(60), 0.9 * rng.random(60) + 0.01, 0.99 * rng.random(60)])
    knots = rim_bounds.SLANT_KNOTS
    top = np.minimum(low + 0.1 * rng.random((3, 60)) ** 4, 1.0)
    top[2] = np.minimum(top[2], knots[np.searchsorted(knots, low[2], side="right")])
    box = np.stack([low, top], axis=1)
    left = left_on(box, (np.ones(60), np.full(60, elongation)), flows)
    for k in range(60):
        for _ in range(5):
            p, x, m = low[:, k] + rng.random(3) * (top - low)[:, k]

            def at(p, x, y):
                return left_there(p, x, y, elongation, flows)

            h, y = 1e-7, m * x
            slopes = (
                at(p + h, x, y) - at(p, x, y),
                at(p, x + h, y) - at(p, x, y),
                at(p, x, y + h) - at(p, x, y),
                at(p, x + h, m * (x + h)) - at(p, x, y),
                at(p, x, y + h * x) - at(p, x, y),
            )
            for interval, value in zip(left, (at(p, x, y), *(each / h for each in slopes)), strict=True):
                spare = 1e-4 * (1.0 + abs(value))
                assert interval[0, k] - spare <= value <= interval[1, k] + spare


@pytest.mark.parametrize(
    ("pressure", "x", "y", "across", "flows"),
    [
        (2e-4, 1.0, 0.02, 1.0, False),
        (0.5, 0.2, 1.0, 2.0, False),
        (1.0, 0.05, 0.02, 0.5, False),
        (0.45, 0.1, 0.8, 1.0, True),
        (0.02, 0.5, 0.3, 2.0, True),
    ],
)
def test_numbers_of_a_cell_hold_elsewhere_and_lesser_ones_are_refuted(pressure, x, y, across, flows):
    cells = cells_of(pressure, x, y, across, flows)
    c, a, b = numbers_of(cells, across, flows)
    assert c < rim_bounds.UNPROVED
    rng = np.random.default_rng(5)
    for size in 10.0 ** rng.uniform(-3.0, 0.0, 3000):
        p, u, v = np.abs(cells[:3, 0] + size * rng.normal(size=3))
        if flows and max(p, u, v) > 1.0:
            continue
        gain = (p - pressure) * (left_there(p, u, v, across**-2, flows) - cells[3, 0])
        assert gain <= c * (p - pressure) ** 2 + a * (u - x) ** 2 + b * (v - y) ** 2 + 1e-12
    lesser = np.full((3, 1), rim_bounds.LEAST)
    assert not proved(described(cells, lesser, across, flows), flows)


def test_other_curves_do_not_pass(monkeypatch):
    cells = cells_of(0.45, 0.1, 0.8, 1.0, True)
    numbers = numbers_of(cells, 1.0, True)
    assert proved(described(cells, numbers, 1.0, True), True)
    monkeypatch.setattr(rim_bounds, "CUBICS", cubics(2.0 * LEFT))
    extremes = [[rim_bounds.extremes(j, order) for j in range(rim_bounds.SLANTS)] for order in (0, 1)]
    monkeypatch.setattr(rim_bounds, "EXTREMES", extremes)
    cells[3] *= 2.0
    assert not proved(described(cells, numbers, 1.0, True), True)


def test_what_bare_cells_take_is_held_without_a_hardness():
    assert min(rim_bounds.growth(across) for across in (0.5, 1.0, 2.0)) > 0.001


def test_there_is_a_contact():
    smallest, times_over = rim_monotony.coercive(4.0, size=64)
    assert smallest > 0.0
    assert times_over > 3.0


@pytest.mark.parametrize(
    ("across", "hardness"), [(1.0, math.inf), (1.0, 0.5), (2.0, math.inf), (0.5, math.inf)]
)
def test_a_contact_is_the_only_one(across, hardness):
    contact = contact_of_ball(3 * max(1.0, across / 1.5), 0.1, np.random.default_rng(1), across, hardness)
    assert left_over(own_numbers(*contact, across, hardness), across) > 0.03


def test_not_all_pressures_are_monotone():
    assert rim_monotony.not_monotone(NOT_MONOTONE) < -0.1
    assert rim_monotony.least_minor(NOT_MONOTONE) > 0.5
