"""The schema is what is written and what is drawn: no name more, no name less, on either side."""

import ast
from pathlib import Path

import pytest
from schema_page import PAGE, SHARED, contents_of, page

import asperity
from asperity.scenes import schema
from asperity.scenes.report import CHAPTERS, figures_of
from asperity.schema import UNKNOWN, VERSION, bearing, convergence
from small_cases import BEARING

SOURCE = Path(asperity.__file__).parent
GROUPS = ("scenario", "surface", "contact", "rolling", "spectra", "track", "pass_by", "convergence",
          "effects", "bearing")  # fmt: skip


def schema_of(tree):
    return contents_of(*SHARED, schema)


def written(tree):
    """Variables of a result, by path."""
    return {
        f"{node.name}/{name}": values
        for node in tree.subtree
        for name, values in node.to_dataset(inherit=False).variables.items()
    }


def test_what_is_written_is_what_the_schema_says(real_run):
    entries = {entry.path: entry for entry in schema_of(real_run)[0]}
    found = written(real_run)
    assert set(found) <= set(entries)
    assert {path for path, entry in entries.items() if not entry.condition} <= set(found)
    for path, values in found.items():
        entry = entries[path]
        assert values.dims == entry.dims, path
        assert values.attrs["units"] == entry.units, path
        assert values.attrs["long_name"] == entry.long_name, path
        assert set(values.attrs) - {"units", "long_name", "missing"} == set(entry.attributes), path
        assert values.attrs.get("missing") != UNKNOWN, path


def test_attributes_are_those_of_the_schema(real_run):
    known = {(item.group, item.name): item for item in schema_of(real_run)[1]}
    found = {
        (node.name or "", name): value for node in real_run.subtree for name, value in node.attrs.items()
    }
    assert set(found) <= set(known)
    assert {place for place, item in known.items() if not item.condition} <= set(found)
    for place, value in found.items():
        assert isinstance(value, str) == (known[place].units in ("text", "JSON")), place


ON_TRACK = "over a track", "of a wheel", "law linear", "loss factors"
NOWHERE = (
    "calls them nothing else", "of several contacts", "contacts at equal distances", "measured on the track",
    "passage was measured", "says what passes", "disc and tread vibrate", "bays differ", "[creep] gives",
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
        kind: {e.path for e in schema_of(tree)[0] if not any(word in e.condition for word in OTHERS[kind])}
        - set(written(tree))
        for kind, tree in real_runs.items()
    }
    homogeneity = {f"surface/{name}" for name in ("homogeneity_p", "tile_variation")}
    homogeneity |= {"surface/tile_variation_expected"}  # of measured maps
    asked = {entry.path for entry in contents_of(convergence)[0]}  # written by tests/test_convergence.py
    asked |= {e.path for e in contents_of(schema)[0] if e.group == schema.EFFECT.group}  # by tests/studies
    assert absent["ball-on-beam"] == homogeneity | asked
    absent_of_wheel = {"spectra/force_level_difference_to_reference"}
    absent_of_wheel |= {f"pass_by/{name}" for name in ("pass_by_equivalent_level", "transit_exposure_level")}
    assert absent["wheel-on-rail"] == homogeneity | asked | absent_of_wheel  # of one axle, without a length


def test_result_states_speed(real_runs):
    for tree in real_runs.values():
        rolling = tree["rolling"].to_dataset()
        path, time = rolling["position"].values, rolling["time"].values
        assert rolling.attrs["speed"] == pytest.approx((path[-1] - path[0]) / (time[-1] - time[0]), rel=1e-9)


OF_BEARINGS = ("bearing", "load")
"""Chapters of ball bearings."""


def test_a_bearing_writes_and_draws_what_its_schema_says(runs):
    tree = runs(BEARING)
    own, facts = contents_of(bearing)
    entries = {entry.path: entry for entry in (*own, *schema_of(tree)[0])}
    found = written(tree)
    assert {entry.path for entry in own} <= set(found) <= set(entries)
    for path, values in found.items():
        entry = entries[path]
        told = entry.dims, entry.units, entry.long_name
        assert (values.dims, values.attrs["units"], values.attrs["long_name"]) == told, path
        assert values.attrs.get("missing") != UNKNOWN, path
    assert {fact.name for fact in facts} == set(tree["bearing"].attrs)
    shown = [part.name for chapter in CHAPTERS if chapter.name in OF_BEARINGS for part in chapter.figures]
    assert [part.name for part in figures_of(tree)] == shown
    assert "Diamond: the fault of the outer raceway." in figures_of(tree)[0].caption


def test_names_stand_once():
    entries, attributes = contents_of(*SHARED, schema, bearing)
    for items in (entries, attributes):
        places = [(item.group, item.name) for item in items]
        assert len(places) == len(set(places))


def test_no_drawing_and_no_writing_goes_by_a_string():
    """A path or a name in quotes would go on quietly after the schema has changed."""
    paths = tuple(f"{group}/" for group in GROUPS)
    for module in SOURCE.rglob("*.py"):
        for node in ast.walk(ast.parse(module.read_text(encoding="utf-8"))):
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
            elsewhere |= chapter.name in (*OF_BEARINGS, "creep")  # of a wheel that is said to creep
            elsewhere |= part.name == "pass_by_bands"  # of what was measured
            assert (part.name in drawn) != elsewhere, part.name


def test_needs_of_figures_are_in_the_schema():
    entries, _ = contents_of(*SHARED, schema, bearing)
    for chapter in CHAPTERS:
        for part in chapter.figures:
            assert set(part.needs) <= set(entries), part.name


def test_the_page_lists_the_schema():
    """Whoever changes the schema raises its version, and runs tests/reporting/schema_page.py."""
    assert PAGE.read_text(encoding="utf-8") == page()
    assert f"Version {VERSION}" in page()
