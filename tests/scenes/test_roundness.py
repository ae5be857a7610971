"""Orders of what rolls out of round, with amplitudes and frequencies; why no law is advised there."""

import math

import numpy as np
import pytest

from asperity import Profile
from asperity.case.bodies import WheelOnRail
from asperity.running import prepare_case
from asperity.scenarios.preparing import Work
from asperity.scenes.figures.track import out_of_round
from asperity.scenes.planning import plan
from small_cases import HEARD

AROUND = 2.0 * math.pi * 0.46
SPEED = 56.0
NO_WORK = Work({}, {}, 0, None)


def wheel(*waves, points=2890, **keys):
    """A line around the wheel: order, and amplitude in µm."""
    angle = 2.0 * np.pi * np.arange(points) / points
    heights = sum(1e-6 * size * np.cos(order * angle + order) for order, size in waves)
    line = Profile(heights, AROUND / points)
    return WheelOnRail(**HEARD | {"wheel": {"section": "rigid", "line": line}, "speed": SPEED} | keys)


def test_orders_are_told_with_amplitude_and_frequency_by_check_result_and_page(runs):
    """n waves around pass n v/(2πR) times in a second; an amplitude A has a level of 20 lg(A/√2/1 µm)."""
    case = wheel((1, 80.0), (3, 30.0), (18, 5.0))
    tree = runs(case)
    held = tree["spectra"].to_dataset()
    turns = SPEED / AROUND
    assert held["order"].values.tolist() == list(range(1, 61))
    np.testing.assert_allclose(held["order_frequency"], turns * held["order"], rtol=1e-3)
    for order, size in ((1, 80.0), (3, 30.0), (18, 5.0)):
        level = float(held["order_level"].sel(order=order))
        assert level == pytest.approx(20.0 * math.log10(size / math.sqrt(2.0)), abs=0.02)
    others = held["order_level"].drop_sel(order=[1, 3, 18])
    assert float(others.max()) < -20.0
    told = dict(plan(prepare_case(case), NO_WORK))["wheel out of round"]
    first = f"order 1 80.0 µm at {turns:.3g} Hz, order 3 30.0 µm at {3 * turns:.3g} Hz"
    assert f"amplitudes: {first}, order 18 5.00 µm" in told
    assert 100e-6 < tree["spectra"].attrs["run_out"] < 230e-6
    drawn = out_of_round.drawn(tree)
    assert f"1 with 80.0 µm at {turns:.3g} Hz, 3 with 30.0 µm" in drawn.caption


def test_less_than_a_turn_says_what_would_tell_the_orders():
    told = dict(plan(prepare_case(wheel((3, 30.0), duration="20 ms", settling="5 ms")), NO_WORK))
    assert "% of a turn: orders are told from a duration of 0.06 s on" in told["wheel out of round"]


def test_why_no_law_is_advised_is_said():
    prepared = prepare_case(wheel((3, 30.0), duration="60 ms", settling="10 ms"))
    told = dict(plan(prepared, NO_WORK))["law to take"]
    assert told.startswith("not told by the map of law errors: it holds textures that are rough across")
    assert "heights beside the measured lines of the wheel are carried over" in told


def test_round_wheels_have_no_orders(runs):
    assert "order" not in runs(WheelOnRail(**HEARD))["spectra"]
