"""Wheels on a track whose speed changes: what results, reports and checks say, and leave out."""

import json

import numpy as np
import pytest

from asperity import Profile
from asperity.case.bodies import WheelOnRail
from asperity.errors import CaseError
from asperity.rolling.roll import roll_bodies
from asperity.running import prepare_case
from asperity.scenarios.preparing import Work
from asperity.scenes import compute
from asperity.scenes.cnossos_power import standard_power
from asperity.scenes.planning import plan
from asperity.scenes.report import figures_of
from small_cases import HEARD

RUN_UP = HEARD | {"speed": "80..96 km/h in 0.2 s", "contact": HEARD["contact"] | {"spacing": "0.5 mm"}}
ORDER = 8


def out_of_round():
    angle = 2.0 * np.pi * np.arange(5781) / 5781
    line = Profile(20e-6 * np.cos(ORDER * angle), 2.0 * np.pi * 0.46 / 5781)
    return {"section": "rigid", "line": line}


@pytest.fixture(scope="module")
def tree(runs):
    return runs(WheelOnRail(**RUN_UP | {"wheel": out_of_round()}))


def test_speed_stands_beside_the_forces_and_points_are_passed_as_it_grows(tree):
    rolling = tree["rolling"].to_dataset()
    time = rolling["time"].values
    first, last = 80.0 / 3.6, 96.0 / 3.6
    assert rolling["momentary_speed"].values == pytest.approx(first + (last - first) * time / 0.2)
    assert tree.attrs["title"] == "Wheel on rail at 80 to 96 km/h"
    force = rolling["contact_force"].values.reshape(-1, len(time))[0]
    assert force.mean() == pytest.approx(65e3, rel=0.02)


def test_an_order_of_the_wheel_is_met_as_often_as_it_turns(tree):
    """Eight waves around: over the angle of the wheel one line, over time smeared by a half."""
    rolling = tree["rolling"].to_dataset()
    time = rolling["time"].values
    force = rolling["contact_force"].values.reshape(-1, len(time))[0]
    turned = np.concatenate(
        [
            [0.0],
            np.cumsum(0.5 * np.diff(time) * (lambda v: v[1:] + v[:-1])(rolling["momentary_speed"].values)),
        ]
    ) / (2.0 * np.pi * 0.46)
    even = np.linspace(0.0, 1.5, 4096, endpoint=False)
    held = np.interp(even, turned, force)
    lines = np.abs(np.fft.rfft((held - held.mean()) * np.hanning(4096)))
    assert lines[:60].argmax() == pytest.approx(1.5 * ORDER, abs=1)
    assert float(tree["spectra"].to_dataset()["order_frequency"].sel(order=ORDER)) == pytest.approx(
        ORDER * 96.0 / 3.6 / (2.0 * np.pi * 0.46), rel=1e-3
    )


def test_what_is_of_one_speed_is_left_out_and_the_page_stands(tree):
    assert "pass_by" not in tree.children
    assert "sound_power_level" not in tree["spectra"]
    assert np.isfinite(tree["spectra"]["radiated_power_level_a"].values).any()
    drawn = {each.name: each for each in figures_of(tree)}
    assert "at the fastest, 26.667 m/s" in drawn["out_of_round"].caption
    numerics = {each["name"]: each["value"] for each in json.loads(tree["scenario"].attrs["numerics"])}
    assert "at the fastest, 26.667 m/s" in numerics["wheel out of round"]
    case = WheelOnRail(**RUN_UP)
    told = dict(plan(prepare_case(case), Work({}, {}, 0, None)))
    assert "at the fastest, 26.667 m/s" in told["track"]
    assert told["not of a speed that changes"].endswith("levels beside the track")
    assert "CNOSSOS" not in told["sound power"]


@pytest.mark.parametrize(("speed", "times"), [("96..100 km/h in 0.2 s", 1), ("100 km/h", 2)])
def test_for_a_sound_power_that_is_not_told_no_law_is_rolled(speed, times, monkeypatch):
    """CNOSSOS-EU's is changed by as much as the force of the bare linear law, at a constant speed alone."""
    rolled = []

    def counted(*given, **keys):
        rolled.append(keys["speed"])
        return roll_bodies(*given, **keys)

    monkeypatch.setattr(compute, "roll_bodies", counted)
    case = WheelOnRail(**RUN_UP | {"laws": ["shifted"], "speed": speed, "settling": "20 ms"})
    found = compute.compute(prepare_case(case), lambda *_: None)
    assert len(rolled) == times
    assert (found.bare_levels is None) == (times == 1)
    assert bool(standard_power(found)) == (times == 2)


def test_levels_beside_the_track_are_refused():
    with pytest.raises(CaseError, match=r"noise\.receiver_distance: .* at a constant speed alone"):
        WheelOnRail(**RUN_UP | {"noise": {"receiver_distance": 25.0}})
