import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from asperity.errors import InputError
from asperity.surfaces.synthesis import close, extend

RAMP = np.arange(5.0)


def test_a_record_that_is_long_enough_is_cut():
    assert_array_equal(extend(RAMP, 3, spacing=1.0), [0, 1, 2])
    assert_array_equal(extend(RAMP, 3, spacing=1.0, start=2), [2, 3, 4])


def test_mirroring_runs_to_and_fro_without_a_step():
    assert_array_equal(extend(RAMP, 11, "mirror", spacing=1.0), [0, 1, 2, 3, 4, 3, 2, 1, 0, 1, 2])
    assert_array_equal(extend(RAMP, 5, "mirror", spacing=1.0, start=-2), [2, 1, 0, 1, 2])


def test_repeating_has_the_period_of_the_record():
    assert_array_equal(extend(RAMP, 7, "repeat", spacing=1.0), [0, 1, 2, 3, 4, 0, 1])
    assert_array_equal(extend(RAMP, 4, "repeat", spacing=1.0, start=-2), [3, 4, 0, 1])


def test_strips_are_continued_along_x():
    strip = np.stack([RAMP, 10 * RAMP], axis=1)
    for how in ("mirror", "repeat"):
        longer = extend(strip, 12, how, spacing=1.0)
        assert longer.shape == (12, 2)
        assert_array_equal(longer[:, 1], 10 * longer[:, 0])


def test_closing_spreads_the_step_over_both_sides_of_the_join():
    line = np.linspace(0.0, 1.0, 101)
    closed = close(line, 20)
    assert closed[0] == closed[-1] == 0.5
    assert_array_equal(closed[20:-20], line[20:-20])
    assert np.abs(np.diff(np.concatenate([closed, closed]))).max() < 0.06
    assert_array_equal(close(line, 0), line)
    assert_allclose(extend(line, 101, "repeat", spacing=1.0, crossfade=20), closed)
    wave = np.sin(2 * np.pi * np.arange(100) / 100)[:, None] * [1.0, 2.0]
    assert np.abs(close(wave, 10) - wave).max() <= 0.5 * np.abs(wave[0] - wave[-1]).max()


def test_too_short_a_record_is_refused_with_the_choices():
    with pytest.raises(InputError) as caught:
        extend(RAMP, 100, spacing=0.5, what="wheel line")
    message = str(caught.value)
    for part in ("length of the wheel line: received 2.5 m", "50 m", "'mirror' or 'repeat'"):
        assert part in message
    with pytest.raises(InputError, match=r"received 2\.5 m; allowed: .* 2 m, from 1 m on"):
        extend(RAMP, 4, spacing=0.5, start=2)


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"how": "stretch"}, "one of refuse, mirror, repeat"),
        ({"heights": [0.0, np.nan, 1.0]}, "missing points"),
        ({"how": "repeat", "crossfade": 3}, "0 to 2, half the record"),
    ],
)
def test_extend_says_what_is_wrong(arguments, text):
    with pytest.raises(InputError, match=text):
        extend(**{"heights": RAMP, "rows": 3, "spacing": 1.0, **arguments})
