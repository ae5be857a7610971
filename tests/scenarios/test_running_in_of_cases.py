"""Running-in as a key of a case: samples, path and line are lowered, and all else is of what is left."""

import numpy as np
import pytest

from asperity.case.cases import as_case
from asperity.errors import CaseError, InputError
from asperity.reporting.data import unless_missing
from asperity.reporting.tables import condition_table
from asperity.reporting.texture_figures import running_in
from asperity.running import prepare_case
from asperity.scenarios.running_in import run_in_case, running_in_solutions
from asperity.schema import contact
from asperity.studies.member import kept
from asperity.studies.table import USUAL
from asperity.surfaces.synthesis import self_affine
from refusals import refusals

BALL = {
    "kind": "ball-on-beam",
    "laws": ["table", "shifted"],
    "start": "0.45 m",
    "duration": "4 ms",
    "settling": "2 ms",
    "surface": {"rms": "0.15 um", "longest": "0.3 mm", "shortest": "60 um"},
    "ball": {"load": "20 N"},
    "contact": {
        "spacing": "20 um", "window": "0.66 mm", "samples": 2, "sample_length": "1.4 mm",
        "hardness": "0.6 GPa",
    },
    "numerics": {"highest_frequency": "2 kHz"},
}  # fmt: skip
RAIL = {
    "kind": "wheel-on-rail",
    "laws": ["table"],
    "duration": "10 ms",
    "settling": "5 ms",
    "surface": {"rms": "3 um", "longest": "20 mm", "shortest": "4 mm"},
    "wheel": {"section": "rigid"},
    "contact": {
        "spacing": "1 mm", "samples": 1, "sample_length": "60 mm", "hardness": "0.9 GPa", "running_in": 1,
    },
    "numerics": {"highest_frequency": "1 kHz", "poles": 60},
}  # fmt: skip


def ball(**contact):
    return BALL | {"contact": BALL["contact"] | contact}


def run_in_of(case):
    prepared = prepare_case(as_case(case))
    return prepared, *run_in_case(prepared, lambda *_: None)


@pytest.fixture
def untouched(runs):
    return runs(ball())


@pytest.fixture
def run_in(runs):
    return runs(ball(running_in="shakedown"))


def test_the_line_is_nowhere_raised_and_crests_are_lowered(untouched, run_in):
    surface = run_in["surface"]
    lowering = (surface["line_untouched"] - surface["line"]).values
    assert lowering.min() == 0.0
    assert lowering.max() > 5e-9
    high = surface["line_untouched"] > surface["line_untouched"].quantile(0.8)
    assert lowering[high].mean() > 3 * lowering[~high].mean()
    np.testing.assert_array_equal(surface["line_untouched"], untouched["surface/line"])
    assert "samples and path run in by" in surface.attrs["source"]


def test_stiffness_and_forces_are_of_what_is_left(untouched, run_in):
    """Without its crests the surface closes over a shorter way; where the first one touches is chance."""
    ways = []
    for state in (untouched["contact"], run_in["contact"]):
        light, heavy = np.interp([1.0, 20.0], state["force"], state["approach"])
        ways.append(heavy - light)
    assert ways[1] < ways[0]
    change = np.abs(run_in["rolling/contact_force"] - untouched["rolling/contact_force"]).max("time")
    assert float(change.min()) > 0.01 * 20.0


def test_the_report_says_before_and_after_and_nothing_of_untouched_surfaces(untouched, run_in):
    condition = condition_table(run_in)
    assert condition.rows[0][0].text == "rms height on the track, as wide as the nominal patch"
    assert condition.rows[0][3].text.startswith("−")
    assert "of the area that carried pressure has yielded" in condition.note
    assert "last pass changed nothing" in condition.note
    marks = running_in.drawn(run_in).chart.panels[0].marks
    assert [line.label for line in marks] == ["before running-in", "after"]
    columns = ["distance [m]", "before running-in [m]", "after running-in [m]"]
    assert list(running_in.drawn(run_in).columns) == columns
    assert "Lowered by" in running_in.drawn(run_in).caption
    assert unless_missing(running_in.drawn, untouched) is None
    assert unless_missing(condition_table, untouched) is None
    assert "line_untouched" not in untouched["surface"]
    assert "yielded_share" not in untouched["contact"].attrs


def test_a_study_keeps_what_running_in_changed(untouched, run_in):
    """Sq of the track and k_c, before and after, what yielded and how deep; unasked they are shown."""
    table, contact = kept(run_in), run_in["contact"]
    for name in ("track_rms", "track_stiffness"):
        np.testing.assert_array_equal(table[name], contact[name])
    assert table["running_in_lowering"] == contact["running_in_lowering"].values.max() > 0.0
    assert table["yielded_share"] == contact.attrs["yielded_share"] > 0.0
    assert table["working_stiffness"] == contact.attrs["working_stiffness"]
    shown = {"track_rms", "track_stiffness", "running_in_lowering", "yielded_share"}
    assert shown <= set(USUAL)
    assert not shown & set(kept(untouched))


def test_measured_maps_are_run_in_along_their_strips():
    band = {"longest": 0.3e-3, "shortest": 60e-6}
    surface = self_affine((160, 60), (15e-6, 15e-6), rms=0.2e-6, hurst=0.8, seed=3, **band)
    prepared, found, values = run_in_of(ball(running_in=1) | {"surface": {"file": surface}})
    assert all(map_.shape[1] == prepared.shape.body.shape[1] for map_ in found.maps)
    assert values[contact.RUNNING_IN_LOWERING][0] > 5e-9


def test_a_line_of_the_path_stays_as_it_is():
    keys = ball(running_in=1) | {"laws": ["shifted"]}
    prepared, found, _ = run_in_of(
        keys | {"surface": BALL["surface"] | {"spectrum": "iso3095", "level": "-40 dB"}}
    )
    told = "samples run in by 1 pass under 20 N, line of the path as given"
    assert found.origin.endswith(told)
    np.testing.assert_array_equal(found.line, prepared.textures.line)


def test_the_rail_takes_the_lowering_and_what_still_yields_is_said(runs):
    tree = runs(RAIL)
    lowering = (tree["surface/line_untouched"] - tree["surface/line"]).values
    assert lowering.min() >= 0.0
    assert lowering.max() > 50e-9
    assert (tree["contact"].sizes["running_in_pass"], tree["contact"].attrs["shaken_down"]) == (1, 0)
    assert "still lowered places" in condition_table(tree).note
    prepared, found, _ = run_in_of(RAIL)
    parts, line = found.parts, found.line
    np.testing.assert_allclose(parts["rail"] + parts["wheel"], line, atol=1e-15)
    np.testing.assert_array_equal(parts["wheel"], prepared.textures.parts["wheel"])


NUMBER = r'"shakedown", or a whole number at least 1 and at most 100'
SOFT = {name: value for name, value in BALL["contact"].items() if name != "hardness"}


test_what_cannot_run_in_is_refused = refusals(
    *((ball(running_in=passes), NUMBER) for passes in (0, 101, 1.5, True, "often", [1])),
    (ball(running_in="shake-down"), 'Did you mean "shakedown"'),
    (BALL | {"contact": SOFT | {"running_in": 2}}, r"contact.running_in.*only together with hardness"),
    (
        ball(running_in=1) | {"laws": ["hertz"], "surface": {"spectrum": "iso3095"}},
        r"contact\.running_in.*only together with a surface that asperities are known of",
    ),
    of=lambda case: prepare_case(as_case(case)),
    error=(CaseError, InputError),
)


def test_the_plan_says_how_often():
    once, thrice = (running_in_solutions(prepare_case(as_case(ball(running_in=n)))) for n in (1, 3))
    assert thrice == 3 * once > 0
