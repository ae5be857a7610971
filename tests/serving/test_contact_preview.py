"""The contact to play with against Hertz, and against the path that led to it."""

import numpy as np
import pytest

from asperity.case.cases import case_of
from asperity.serving.contact_preview import MOST_CELLS_SHOWN, PressedSample
from small_cases import BALL, WHEEL

SMOOTH = {
    "kind": "wheel-on-rail",
    "surface": {"smooth": True},
    "wheel": {"load": "65 kN"},
    "contact": {"spacing": "0.4 mm", "window": "30 mm"},
}


def test_smooth_bodies_follow_hertz():
    """F = K δ^1.5; K of a wheel of 0.46 m on a rail head of 0.3 m, E = 210 GPa, ν = 0.3: 9.413e10 N/m^1.5."""
    sample = PressedSample(case_of(SMOOTH))
    at_load = sample.at(None)
    assert at_load["force"] == pytest.approx(65e3, rel=1e-4)
    assert at_load["approach"] == pytest.approx(78.1e-6, rel=5e-3)
    assert at_load["tangent_stiffness"] == pytest.approx(1.248e9, rel=1e-2)
    length = (at_load["pressure"] > 0.0).any(axis=1).sum() * sample.spacing[0]
    assert sample.described()["passing"] == pytest.approx(case_of(SMOOTH).speed / length, rel=0.08)
    for share in (0.3, 0.6, 1.0):
        pressed = sample.at(share)
        assert pressed["force"] == pytest.approx(9.413e10 * pressed["approach"] ** 1.5, rel=1e-2)
        assert pressed["stiffness"] == pytest.approx(2 / 3 * pressed["tangent_stiffness"], rel=2e-2)


def test_where_it_came_from_changes_nothing():
    sample = PressedSample(case_of(BALL))
    down = [sample.at(share) for share in (0.9, 0.5, 0.1)]
    up = [sample.at(share) for share in (0.1, 0.5, 0.9)][::-1]
    for one, other in zip(down, up, strict=True):
        assert one["force"] == pytest.approx(other["force"], rel=1e-4)
        np.testing.assert_allclose(one["pressure"], other["pressure"], atol=1e-3 * one["largest_pressure"])


def test_at_touch_nothing_is_carried_and_force_grows_from_there():
    sample = PressedSample(case_of(BALL))
    assert sample.at(0.0)["force"] == 0.0
    told = sample.described()
    forces = [state["force"] for state in told["curve"]]
    assert forces == sorted(forces)
    assert forces[0] > 0.0
    assert told["touch"] < told["working"] < told["deepest"]
    assert sample.at(None)["force"] == pytest.approx(told["load"], rel=1e-3)


def test_a_wide_window_is_thinned_and_says_so():
    wide = {**SMOOTH, "contact": {"spacing": "0.1 mm", "window": "30 mm"}}
    sample = PressedSample(case_of(wide))
    told = sample.described()
    assert told["thinning"] == 3
    assert max(told["shape"]) <= MOST_CELLS_SHOWN
    assert sample.at(None)["approach"] == pytest.approx(78.1e-6, rel=5e-3)
    assert told["heights"].shape == sample.gap.shape
    middle = tuple(n // 2 for n in told["shape"])
    assert sample.gap[middle] == sample.gap.min() == 0.0


def test_a_sample_of_each_kind_can_be_pressed():
    assert PressedSample(case_of(WHEEL)).at(0.5)["force"] > 0.0
