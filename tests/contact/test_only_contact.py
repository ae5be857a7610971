"""Numbers that prove contacts on covered cells to be the only ones hold for the curves that there are."""

import sys
from pathlib import Path

import numpy as np
import pytest

from asperity.kernels.rim_curves import END, LEFT, cubics

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))
import rim_monotony
from rim_monotony import APART, CLASSES, FAR, NOT_MONOTONE, REST, USUAL


def least_of_pairs(ratios, slants, constants, apart, rng, count=6000):
    """Least f of a class between random cells of it and any others, half of them close by."""

    def drawn(ends):
        return ends[0] + (ends[1] - ends[0]) * rng.random(count)

    u, m = drawn(ratios), drawn(slants)
    near = rng.random(count) < 0.5
    spread = 10.0 ** rng.uniform(-3.0, -0.5, count)
    w = np.where(near, np.abs(u + 0.1 * spread * rng.normal(size=count)), 1.3 * rng.random(count))
    k = np.where(near, np.abs(m + spread * rng.normal(size=count)), rng.random(count) ** 2)
    k = np.minimum(k, 1.0)
    points = [np.stack([each, each]) for each in (u, m, w, k)]
    found = []
    for swapped in (False, True):
        cells = (
            rim_monotony.cell(*points[:2], False, constants, apart),
            rim_monotony.cell(*points[2:], swapped, constants),
        )
        found.append(rim_monotony.least(*cells, constants).min())
    return min(found)


def least_of_all():
    rng = np.random.default_rng(3)
    classes = [(*each, 0.0) for each in CLASSES] + [(*each, *USUAL, 0.0) for each in REST]
    classes += [((0.0, 0.0), slants, *USUAL[:2], across, apart) for slants, apart, across in APART]
    return min(
        least_of_pairs(ratios, slants, constants, apart, rng) for ratios, slants, *constants, apart in classes
    )


def test_numbers_of_all_classes_hold_for_the_curves():
    assert least_of_all() > -1e-12
    assert rim_monotony.far_enough((0.0, END), (0.0, 1.0), USUAL)


def test_all_cells_under_pressure_are_in_a_class():
    rng = np.random.default_rng(4)
    u, m = FAR * rng.random(20_000) ** 2, rng.random(20_000)
    known = [(ratios, slants) for ratios, slants, *_ in CLASSES] + list(REST)
    inside = [(r[0] <= u) & (u <= r[1]) & (s[0] <= m) & (m <= s[1]) for r, s in known]
    assert np.any(inside, axis=0).all()


@pytest.mark.parametrize("change", [1.15 * LEFT, LEFT + 0.3 * (LEFT - LEFT[0])])
def test_other_curves_do_not_pass(change, monkeypatch):
    monkeypatch.setattr(rim_monotony, "CUBICS", cubics(change))
    assert least_of_all() < -1e-5


def test_boxes_prove_a_class_and_refute_less():
    ratios, slants = (0.02, 0.04), (0.045, 0.07)
    assert rim_monotony.proved(ratios, slants, (*USUAL[:2], 0.09)) > 0
    assert rim_monotony.proved(ratios, slants, (*USUAL[:2], 0.07)) == 0


def test_there_is_a_contact():
    smallest, times_over = rim_monotony.coercive(4.0, size=64)
    assert smallest > 0.0
    assert times_over > 3.0


def test_a_contact_is_the_only_one_though_not_all_pressures_are_monotone():
    pressure, gap = rim_monotony.contact_of_ball(6, 0.1, np.random.default_rng(1))
    assert rim_monotony.left_over(pressure, rim_monotony.needed(pressure, gap)) > 0.01
    assert rim_monotony.not_monotone(NOT_MONOTONE) < -0.1
