"""Ends of intervals where a sum of squares is no parabola, against those that are known in closed form."""

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar

import asperity
from asperity.fitting.interval_ends import MOST, Bowl, End
from asperity.observables.observable import Measured
from known_keys import RUBBER

STIFFNESS, LOSS = "track.pad_stiffness", "track.pad_loss_factor"
AT = np.linspace(0.0, 3.0, 12)
OF_NEPER = 10.0 / np.log(10.0)
NORMAL = 1.959964


def bowl(residuals, slopes, allowed=1.0, low=-1e9, high=1e9):
    """Of values that are zero where the sum of squares is least; counts how often residuals are computed."""
    count = []

    def counted(place):
        count.append(1)
        return residuals(place)

    zero = np.zeros(np.shape(slopes)[1])
    ends = np.full(len(zero), low), np.full(len(zero), high)
    numbers = np.arange(len(zero))
    return Bowl(counted, zero, residuals(zero), np.array(slopes, float), *ends, numbers, allowed), count


@pytest.mark.parametrize("keys", [[LOSS], [STIFFNESS, LOSS]])
def test_an_end_lies_where_the_sum_of_squares_has_risen_by_what_is_allowed(track, rubber, keys):
    """ln k − η x is a line in η, though η is fitted by its logarithm: its interval is η − h to η + h."""
    loss, deviation = 0.2, 1.2
    free = {STIFFNESS: None, LOSS: (1e-3, 10.0)}
    base = track.with_(**{STIFFNESS: 4e8})
    data = Measured(RUBBER, AT, 4.0 * np.exp(-loss * AT), uncertainty=deviation)
    found = asperity.fit(base, data, {key: free[key] for key in keys}, starts=1)
    design = np.stack([np.ones(12), -AT], axis=1)[:, -len(keys) :]
    half = NORMAL * deviation / OF_NEPER * np.sqrt(np.linalg.inv(design.T @ design)[-1, -1])
    low, high = found.intervals[LOSS]
    assert low == pytest.approx(loss - half, abs=0.01 * half)
    by_slope = loss * np.exp(-half / loss)
    assert low < by_slope - 0.1 * half
    assert high == pytest.approx(loss * np.exp(half / loss), rel=1e-3)  # farther than η + h: not narrowed
    assert found.estimates[-1].stops == ("", "")


def test_ends_of_a_linear_problem_do_not_move_by_a_digit(track, rubber):
    """Of ln k, of which the data are a line, in every digit that is shown, the loss factor free beside it."""
    data = Measured(RUBBER, AT, 4.0 * np.exp(-0.25 * AT), uncertainty=0.5)
    found = asperity.fit(track, data, starts=1)
    design = np.stack([np.ones(12), -AT], axis=1)
    half = NORMAL * 0.5 / OF_NEPER * np.sqrt(np.linalg.inv(design.T @ design)[0, 0])
    estimate = found.estimates[0]
    expected = [estimate.free.words(4e8 * np.exp(sign * half)) for sign in (-1.0, 1.0)]
    assert [estimate.free.words(end) for end in estimate.interval] == expected


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_linear_end_takes_one_evaluation(sign):
    slopes = np.array([[3.0, 1.0], [0.5, 2.0], [1.0, 1.0]])
    linear, count = bowl(lambda place: slopes @ place + [0.0, 0.0, 0.0], slopes)
    half = np.sqrt(np.linalg.inv(slopes.T @ slopes)[0, 0])
    assert linear.end(0, sign * half) == End(sign * half)
    assert len(count) == 1


def test_a_curve_that_saturates_has_its_end_where_it_is_met():
    """A (1 − e^−x) over A is 0.8 at ln 5, where its slope at the minimum has it at 0.8."""
    saturating, count = bowl(lambda place: 1.25 * (1.0 - np.exp(-place)), [[1.25]])
    found = saturating.end(0, 0.8)
    assert found.stop == ""
    assert 1.0 - np.exp(-found.place) == pytest.approx(0.8, rel=0.011)
    assert len(count) <= MOST
    assert saturating.end(0, -0.8) == End(-0.8)  # there it rises more quickly: never narrower


def test_an_end_follows_a_valley_that_bends():
    """Reference: the least over the other value, found by itself for each place of the first."""

    def residuals(place):
        x, y = place
        return np.array([1.25 * (1.0 - np.exp(-x)), 0.5 * (y - x**2), 0.1 * y**2])

    def rise(x):
        return minimize_scalar(lambda y: np.sum(residuals((x, y)) ** 2), bounds=(-1, 9), method="bounded").fun

    known = brentq(lambda x: rise(x) - 1.0, 0.5, 3.0)
    bent, count = bowl(residuals, [[1.25, 0.0], [0.0, 0.5], [0.0, 0.0]])
    found = bent.end(0, 0.8)
    along = brentq(lambda x: np.sum(residuals((x, 0.0)) ** 2) - 1.0, 0.5, 3.0)
    print(known, along, found)
    assert 0.8 < (found.place - along) / (known - along) < 1.01
    assert len(count) <= MOST


def test_an_end_stops_at_a_limit_or_as_far_as_was_tried():
    def short(place):
        return 0.9 * np.tanh(place)

    assert bowl(short, [[0.9]], low=-2.0, high=2.0)[0].end(0, 1.0 / 0.9) == End(2.0, "limit")
    assert bowl(short, [[0.9]], low=-2.0, high=2.0)[0].end(0, -1.0 / 0.9) == End(-2.0, "limit")
    endless, count = bowl(short, [[0.9]])
    found = endless.end(0, 1.0 / 0.9)
    assert found.stop == "further"
    assert found.place > 3.0
    assert len(count) == MOST


def test_beyond_what_can_be_computed_no_end_is_told():
    """A wall at 3, behind which nothing is computed, before what is allowed: it stops on this side of it."""

    def walled(place):
        return np.where(place > 3.0, 1e3, 0.6 * np.tanh(place))

    found = bowl(walled, [[0.6]])[0].end(0, 1.0 / 0.6)
    assert found.stop == "further"
    assert 2.5 < found.place <= 3.0


def test_an_end_by_slopes_beyond_a_limit_is_not_tried():
    linear, count = bowl(lambda place: place, [[1.0]], low=-0.5, high=0.5)
    assert linear.end(0, 1.0) == End(1.0)
    assert not count


def test_a_stop_is_told(track, rubber):
    """η − h lies below the least loss factor of 0.05 that pads usually have."""
    data = Measured(RUBBER, AT, 4.0 * np.exp(-0.2 * AT), uncertainty=2.5)
    found = asperity.fit(track.with_(**{STIFFNESS: 4e8}), data, [LOSS], starts=1)
    assert found.estimates[0].stops == ("limit", "")
    assert found.intervals[LOSS][0] == pytest.approx(0.05)
    told = (
        "The interval of track.pad_loss_factor stops at 0.05, a limit (chosen here from what is printed of "
        "pads): the data allow what lies below it."
    )
    assert told in found.sentence
