"""Waves of a cell of many bays: against one bay, long direct sums, its mirror image and energy."""

import numpy as np
import pytest

from asperity.errors import InputError
from asperity.structures.cell_waves import CellWaves, cell_waves
from asperity.structures.track import Track
from superposed import superposed

TIMOSHENKO = {"shear_stiffness": 243e6, "rotary_inertia": 0.24}
PAIRS = [(0.0, 0.0), (0.3, 0.3), (0.1, 0.5), (0.6, 0.2), (13.3, 0.25), (0.31, -8.21), (59.9, 59.7)]


def drawn(track: Track, omega: np.ndarray, count: int, seed: int = 1) -> CellWaves:
    """Waves of a cell whose supports and distances are drawn."""
    draw, support = np.random.default_rng(seed), track.support.stiffness(omega)
    supports = support * draw.uniform(0.3, 2.0, (count, 1))
    return cell_waves(*track.rail.waves(omega), supports, draw.uniform(0.5, 0.7, count), count)


@pytest.mark.parametrize("section", [{}, TIMOSHENKO])
@pytest.mark.parametrize("shift", [0.0, 33.0])
@pytest.mark.parametrize("count", [1, 2, 7, 100])
def test_equal_bays_answer_as_one(section: dict[str, float], shift: float, count: int) -> None:
    track = Track.named("x2000", **section)
    omega = np.concatenate([np.geomspace(30.0, 3e4, 40), np.linspace(4e4, 5e5, 10)]) - 1j * shift
    one, support = track.waves(omega), track.support.stiffness(omega)
    cell = cell_waves(*track.rail.waves(omega), np.array([support] * count), np.full(count, 0.6), count)
    for x, x0 in PAIRS:
        assert cell.receptance(x, x0) == pytest.approx(one.receptance(x, x0), rel=1e-9, abs=1e-200)
    slowest = np.abs(one.multipliers).max(axis=0)
    assert np.abs(cell.multipliers).max(axis=0) == pytest.approx(slowest**count, rel=1e-10, abs=0.0)
    for bay in (0, count // 2, count - 1):
        assert np.abs(cell.bay(bay).multipliers).max(axis=0) == pytest.approx(slowest, rel=1e-10)


def test_it_is_the_sum_over_very_many_supports() -> None:
    track = Track.named("x2000", rail_loss_factor=0.05, **TIMOSHENKO)
    omega, count, cells = 2.0 * np.pi * np.array([90.0, 700.0, 1100.0, 4000.0]), 3, 120
    cell = drawn(track, omega.astype(complex), count)
    (k, a), draw = track.rail.waves(omega.astype(complex)), np.random.default_rng(1)
    supports = np.tile(track.support.stiffness(omega) * draw.uniform(0.3, 2.0, (count, 1)), (cells, 1))
    lengths = np.tile(draw.uniform(0.5, 0.7, count), cells)
    at = np.concatenate([[0.0], np.cumsum(lengths)])[:-1] - cells // 2 * lengths[:count].sum()
    pairs = [(0.2, 0.2), (-1.0, 0.9), (2.5, 0.0)]
    for n in range(omega.size):

        def free(x: np.ndarray, n: int = n) -> np.ndarray:
            return np.sum(a[:, n] * np.exp(-1j * k[:, n] * np.abs(x)[..., None]), axis=-1)

        found = [cell.receptance(*pair)[n] for pair in pairs]
        np.testing.assert_allclose(found, superposed(free, supports[:, n], at, pairs), rtol=1e-9)


def test_a_stretch_of_it_answers_like_one_bay() -> None:
    cell = drawn(Track.named("x2000"), np.geomspace(60.0, 2e5, 30) - 10j, 5)
    length = cell.spacing / cell.bays
    here, there = cell.bay(1), cell.bay(4)
    for x, x0 in [(0.1, 0.2), (0.55, 0.0), (0.3, 0.59)]:
        carried = cell.carried(1, 9)
        seen = np.sum(there.outgoing(x) * carried * here.coefficients * here.incoming(x0), axis=0)
        exact = cell.receptance(9 * length + x, length + x0)
        assert seen == pytest.approx(exact, rel=1e-10, abs=1e-60)
    nodes = np.linspace(0.0, length, 5)
    for of_nodes, of_places in zip(here.shapes_at_nodes(4), here.symmetric_shapes(nodes), strict=True):
        assert of_nodes == pytest.approx(of_places, rel=1e-12)
    assert cell.carried(-9, -6) == pytest.approx(cell.carried(1, 4), rel=1e-12)
    assert cell.carried(9, 1) == pytest.approx(
        np.prod([cell.bay(n).multipliers for n in range(1, 9)], axis=0), rel=1e-6, abs=0.0
    )


def test_waves_lost_between_two_supports_are_refused() -> None:
    with pytest.raises(InputError, match="at most 200"):
        drawn(Track.named("x2000"), np.array([1e9 + 0j]), 2)
    cell = drawn(Track.named("x2000"), np.array([2e5 + 0j]), 30)
    with pytest.raises(InputError, match="at most 200"):
        cell.outgoing(cell.spacing)
