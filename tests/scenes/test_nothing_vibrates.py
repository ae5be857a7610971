"""Where nothing vibrates that is said: what rounding leaves is no level, no velocity and no force."""

import re

import numpy as np
import pytest

import small_cases
from asperity.case.cases import as_case
from asperity.running import run
from asperity.scenes import computed_bearing
from asperity.scenes.report import page_of

SMOOTH = {"laws": ["hertz", "linear"], "surface": {"smooth": True}, "settling": "50 ms"}
PLANE = {name: each for name, each in small_cases.BALL.items() if name != "ball"} | SMOOTH
PLANE |= {"kind": "bodies", "over": "plane", "body": {"load": "30 N"}}
PERFECT = {name: each for name, each in small_cases.BEARING.items() if name != "fault"}
PERFECT |= {"radial": "0 N", "axial": "100 N", "settling": "0 s", "sampling_rate": "16 kHz"}
FEW = {
    "bearing": {
        "balls": 3, "ball_diameter": "7.94 mm", "pitch_diameter": "39.04 mm", "contact_angle": "20 deg"
    }
}  # fmt: skip
NOISE = re.compile(r"10⁻[⁹¹][⁰¹²³⁴⁵⁶⁷⁸⁹]*|[−-][23]\d\d(?:\.\d+)? dB|0\.0{6,}\d|\d pN|\d [pf]m/s")


@pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")
@pytest.mark.parametrize(
    ("keys", "said"), [(PLANE, "nothing vibrates"), (PERFECT, "Nothing vibrates by hertz")]
)
def test_rounding_is_told_as_nothing_in_verdict_page_and_result(keys, said):
    """A smooth ball on a rigid plane, and a perfect bearing under an axial load."""
    tree = run(as_case(keys))
    assert said in tree.attrs["verdict"]
    assert not NOISE.search(tree.attrs["verdict"])
    for name in ("contact_force", "inner_force", "acceleration", "ring_acceleration"):
        for node in tree.subtree:
            if name in node.data_vars:
                assert float(np.ptp(node[name].values, axis=-1).max(initial=0.0)) == 0.0
    if "bearing" in tree.children:
        velocity = tree["bearing"]["band_velocity"].values
        np.testing.assert_array_equal(velocity[..., :2], 0.0)
        assert np.isnan(velocity[..., 2]).all()  # not sampled finely enough
    heard = tree["spectra"].dataset
    for name in ("force_level", "velocity_amplitude"):
        assert name not in heard or np.isnan(heard[name].values).all()
    page = re.sub(r"<script.*?</script>|<style.*?</style>|<svg.*?</svg>", " ", page_of(tree), flags=re.S)
    shown = re.sub(r"\s+", " ", re.sub(r"<[^>]+>", " ", page))
    told = re.sub(r"imbalance of the static solution.{0,40}|Residual.{0,200}", "", shown)
    assert not NOISE.search(told), NOISE.search(told)
    assert said in shown


@pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")
def test_perfect_surfaces_of_a_bearing_with_waves_under_an_axial_load_have_no_velocity():
    tree = run(as_case(PERFECT | {"inner_raceway": {"waviness": "0.2 um"}}))
    found = tree["bearing"].dataset
    assert found["source"].values[0] == "perfect surfaces"
    assert np.isnan(found["alone_velocity"].values[:, 2]).all()
    perfect, waves = found["alone_velocity"].values[:, :2]  # the record is not sampled finely enough for more
    np.testing.assert_array_equal(perfect, 0.0)
    assert (waves > 0.0).all()
    assert np.isnan(found["alone_velocity_deviation"].values[0]).all()


def recorded_durations(monkeypatch):
    """Durations of the records of all bearings that are rolled from now on, s."""
    rolled = []

    def roll(*given, duration, **others):
        rolled.append(duration)
        return roll_bearing(*given, duration=duration, **others)

    roll_bearing = computed_bearing.roll_bearing
    monkeypatch.setattr(computed_bearing, "roll_bearing", roll)
    return rolled


@pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")
@pytest.mark.parametrize(("settling", "tried"), [("20 ms", 0.1 * 0.1 - 0.02), ("5 ms", 0.1 * 0.085 - 0.005)])
def test_a_law_that_is_looked_up_is_tried_for_a_tenth_of_run_in_and_record(monkeypatch, settling, tried):
    """For one step of the record where the run-in is longer than that."""
    case = as_case(PERFECT | {"laws": ["table"], "duration": "80 ms", "settling": settling})
    rolled = recorded_durations(monkeypatch)
    run(case, brief=True)
    assert rolled == pytest.approx([max(tried, case.step), 0.08])


@pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")
@pytest.mark.parametrize(
    ("keys", "asked", "still"),
    [
        ({}, True, True),
        ({"radial": "1 N"}, False, False),  # balls are not carried alike
        ({"rotating": "1 N"}, True, False),  # they are at rest alone
        ({"speed": "11200..14400 1/min in 12.5 ms", "duration": "19 ms"}, False, False),
        ({"duration": "10 ms", "bearing": {"name": "6205"}}, False, True),
    ],
)
def test_perfect_surfaces_are_rolled_for_a_turn_of_the_cage_where_nothing_vibrates(
    monkeypatch, keys, asked, still
):
    """All of the record elsewhere, as of one that is shorter than a turn; three balls are few contacts."""
    waves = {"laws": ["hertz"], "inner_raceway": {"waviness": "0.2 um"}}
    case = as_case(PERFECT | FEW | waves | {"speed": "14400 1/min", "duration": "18 ms"} | keys)
    rolled = recorded_durations(monkeypatch)
    found = run(case)["bearing"]["alone_velocity"].values[0, :2]
    assert (found == 0.0).all() == still
    turn = [1.0 / case.kinematics.cage] * asked
    perfect = turn if asked and still else [*turn, case.duration]
    assert rolled == pytest.approx([case.duration, *perfect, case.duration])


def test_a_force_that_varies_is_none_of_these(runs):
    tree = runs(small_cases.changed("ball-on-beam"))
    assert "nothing vibrates" not in tree.attrs["verdict"]
    assert np.isfinite(tree["spectra"]["force_level"].values).any()
