"""The schema is what is written and what is drawn: no name more, no name less, on either side."""

import ast

import numpy as np
import pytest
import xarray as xr
from schema_page import PAGE, SHARED, contents_of, page

from asperity.errors import PhysicsWarning
from asperity.scenes import schema
from asperity.scenes.report import CHAPTERS, figures_of, page_of
from asperity.schema import UNKNOWN, VERSION, Entry, bearing, convergence
from asperity.schema.spectra import NO_SIGNAL
from package_source import MODULES, nodes_of
from small_cases import BEARING, WHEEL, unmarked

GROUPS = ("scenario", "surface", "contact", "rolling", "spectra", "track", "pass_by", "convergence",
          "measured", "effects", "bearing")  # fmt: skip


ENTRIES, ATTRIBUTES = contents_of(*SHARED, schema)
OWN, FACTS = contents_of(bearing)


def written(tree):
    """Variables of a result, by path."""
    return {
        f"{node.name}/{name}": values
        for node in tree.subtree
        for name, values in node.to_dataset(inherit=False).variables.items()
    }


def assert_as_declared(tree, entries, needed):
    """What is written is among some entries, all that is needed of them is, and each is as it says."""
    known, found = {entry.path: entry for entry in entries}, written(tree)
    assert {entry.path for entry in needed} <= set(found) <= set(known)
    for path, values in found.items():
        entry, told = known[path], values.attrs
        expected = entry.dims, entry.units, entry.long_name, set(entry.attributes)
        more = set(told) - {"units", "long_name", "missing"}
        assert (values.dims, told["units"], told["long_name"], more) == expected, path
        assert told.get("missing") != UNKNOWN, path


def test_what_is_written_is_what_the_schema_says(real_run):
    assert_as_declared(real_run, ENTRIES, [entry for entry in ENTRIES if not entry.condition])


def test_attributes_are_those_of_the_schema(real_run):
    known = {(item.group, item.name): item for item in ATTRIBUTES}
    found = {
        (node.name or "", name): value for node in real_run.subtree for name, value in node.attrs.items()
    }
    assert {place for place, item in known.items() if not item.condition} <= set(found) <= set(known)
    for place, value in found.items():
        assert isinstance(value, str) == (known[place].units in ("text", "JSON")), place


ON_TRACK = "over a track", "of a wheel", "rail is rough", "loss factors"
NOWHERE = (
    "calls them nothing else", "of several contacts", "contacts at equal distances", "measured on the track",
    "passage was measured", "names tables", "says what passes", "disc and tread vibrate", "bays differ",
    "[creep] gives",
)  # fmt: skip
OTHERS = {
    "ball-on-beam": (*NOWHERE, *ON_TRACK, "train"),
    "wheel-on-rail": (*NOWHERE, "of a ball", "accelerometers"),
    "bodies": (),
}
"""Words of conditions that name another scene than that of a small run."""


def test_conditions_of_small_runs_cover_the_schema(real_runs):
    """What is not in a small run is named here, so that nothing is optional without a reason."""
    absent = {
        kind: {e.path for e in ENTRIES if not any(word in e.condition for word in OTHERS[kind])}
        - set(written(tree))
        for kind, tree in real_runs.items()
    }
    homogeneity = {f"surface/{name}" for name in ("homogeneity_p", "tile_variation")}
    homogeneity |= {"surface/tile_variation_expected"}  # of measured maps
    asked = {entry.path for entry in contents_of(convergence)[0]}  # written by tests/test_convergence.py
    asked |= {e.path for e in contents_of(schema)[0] if e.group == schema.EFFECT.group}  # by tests/studies
    around = {f"spectra/{name}" for name in ("order", "order_level", "order_frequency")}
    asked |= around  # of measured lines around, written by tests/scenes/test_roundness.py
    assert absent["ball-on-beam"] == homogeneity | asked
    absent_of_wheel = {"spectra/force_level_difference_to_reference"}
    absent_of_wheel |= {f"pass_by/{name}" for name in ("pass_by_equivalent_level", "transit_exposure_level")}
    assert absent["wheel-on-rail"] == homogeneity | asked | absent_of_wheel  # of one axle, without a length


def test_result_states_speed(real_runs):
    for tree in real_runs.values():
        rolling = tree["rolling"].to_dataset()
        path, time = rolling["position"].values, rolling["time"].values
        assert (rolling["momentary_speed"].values == rolling.attrs["speed"]).all()
        assert rolling.attrs["speed"] == pytest.approx((path[-1] - path[0]) / (time[-1] - time[0]), rel=1e-9)


OF_BEARINGS = ("bearing", "load", "creep")
"""Chapters of ball bearings."""
CHANGING = "speed changes"
"""Words of conditions of a run-up."""


def test_a_bearing_writes_and_draws_what_its_schema_says(runs):
    tree = runs(BEARING | {"wear_coefficient": 1e-8, "friction": 0.1})
    others = CHANGING, bearing.OILED, bearing.OF_ROLLERS
    others += bearing.OF_TAPERED, bearing.OF_ARCHES
    needed = [entry for entry in OWN if not any(each in entry.condition for each in others)]
    assert_as_declared(tree, [*OWN, *ENTRIES], needed)
    facts = {fact.name for fact in FACTS if not any(each in fact.condition for each in others)}
    assert facts == set(tree["bearing"].attrs)
    of_others = {entry for entry in OWN if entry.condition in (bearing.OILED, bearing.OF_ROLLERS)}
    figures = [part for chapter in CHAPTERS if chapter.name in OF_BEARINGS for part in chapter.figures]
    shown = [part.name for part in figures if not of_others & set(part.needs)]
    bodies = {"friction_force", "squeal"}  # of creepages that a case gives
    after_force = [name for name in shown if name == "stick_and_slip"]
    before = [name for name in shown if name not in {*bodies, *after_force}]
    assert [part.name for part in figures_of(tree)] == [*before, "force_bands", *after_force]
    assert "Diamond: the fault of the outer raceway." in figures_of(tree)[0].caption


def test_names_stand_once():
    for items in ([*ENTRIES, *OWN], [*ATTRIBUTES, *FACTS]):
        places = [(item.group, item.name) for item in items]
        assert len(places) == len(set(places))


def test_no_drawing_and_no_writing_goes_by_a_string():
    """A path or a name in quotes would go on quietly after the schema has changed."""
    paths = tuple(f"{group}/" for group in GROUPS)
    for module in MODULES:
        for node in nodes_of(module):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                docstring = " " in node.value or "\n" in node.value
                assert docstring or not node.value.startswith(paths), f"{module}: {node.value}"


def test_every_figure_of_a_real_run_is_drawn(real_run):
    several, track = real_run["rolling"].sizes["contact"] > 1, "track" in real_run.children
    drawn = {part.name for part in figures_of(real_run)}
    for chapter in CHAPTERS:
        for part in chapter.figures:
            told = " ".join(entry.condition for entry in part.needs)
            elsewhere = chapter.name == "acceleration" if track else any(word in told for word in ON_TRACK)
            elsewhere |= chapter.name == "contacts" and not several
            elsewhere |= chapter.name in (*OF_BEARINGS, "run_up", "creep")  # of a wheel that is said to creep
            elsewhere |= part.name in (
                "pass_by_bands",
                "beside_measured",
                "out_of_round",
            )  # of what was measured
            assert (part.name in drawn) != elsewhere, part.name


def test_needs_of_figures_are_in_the_schema():
    for part in (part for chapter in CHAPTERS for part in chapter.figures):
        assert set(part.needs) <= {*ENTRIES, *OWN}, part.name


def test_the_page_lists_the_schema():
    """Whoever changes the schema raises its version, and runs tests/reporting/schema_page.py."""
    assert PAGE.read_text(encoding="utf-8") == page()
    assert f"Version {VERSION}" in page()


# --- values that are not there are marked, with the reason; all others are finite

LEVEL = Entry("spectra", "level(band)", "dB re 1 N", "level", missing=NO_SIGNAL)
FORCE = Entry("rolling", "force(time)", "N", "force")


def test_what_is_not_finite_is_missing_with_a_reason_or_a_warning():
    found = LEVEL.variable([1.0, -np.inf])  # of nothing
    np.testing.assert_array_equal(found.values, [1.0, np.nan])
    assert (found.attrs["missing"], found.attrs["long_name"]) == (NO_SIGNAL, "level")
    expected = xr.Variable("time", [1.0, 2.0], {"units": "N", "long_name": "force"})
    xr.testing.assert_identical(FORCE.variable([1.0, 2.0]), expected)
    with pytest.warns(PhysicsWarning, match="1 of 2 values of force are not finite numbers"):
        found = FORCE.variable([1.0, np.nan])
    assert found.attrs["missing"] == UNKNOWN


BEAM = {"kind": "ball-on-beam", "duration": "10 ms", "laws": ["hertz"], "contact": {"samples": 1},
        "surface": {"rms": "0.3 um"}, "numerics": {"highest_frequency": "2 kHz"}}  # fmt: skip
RAIL = {"kind": "wheel-on-rail", "duration": "50 ms", "settling": "50 ms", "laws": ["hertz", "linear"],
        "contact": {"samples": 1, "spacing": "1 mm"}, "wheel": {"section": "rigid"},
        "numerics": WHEEL["numerics"]}  # fmt: skip
RINGING = {"wheel": {"section": "straight-web"}, "numerics": {"highest_frequency": "1.6 kHz"}}
CORRUGATED = {"corrugation": "0.2 mm", "corrugation_wavelength": "30 mm"}


@pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")
@pytest.mark.parametrize(
    ("case", "missing"),
    [
        (BEAM | {"beam": {"sensors": ["0 m", "0.5 m"]}}, ["acceleration_level"]),  # at an end
        (BEAM | {"beam": {"length": "100 m"}}, None),
        (RAIL | {"surface": {"smooth": True}} | RINGING, None),
        (RAIL | {"surface": CORRUGATED}, None),  # that the wheel leaves
    ],
)
def test_every_value_of_a_result_is_finite_or_marked(runs, case, missing):
    tree = runs(case)
    assert list(unmarked(tree)) == []
    if missing is not None:
        assert [v.name for v in tree["spectra"].data_vars.values() if "missing" in v.attrs] == missing
        assert "there is no signal in these bands, and nothing has no level" in page_of(tree)
