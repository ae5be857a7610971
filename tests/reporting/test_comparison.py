"""Comparing runs: differences from closed forms, one page, one table."""

import csv
import json
import re

import numpy as np
import pytest
import xarray as xr
from report_reading import own_scripts
from report_tree import report_tree

import asperity
from asperity.reporting.chart import Boxes
from asperity.reporting.comparison import MAIN, working_filter
from asperity.reporting.comparison_page import compared_blocks, summary
from asperity.scenes.report import comparison_of, names_of
from asperity.spectra import a_weighted_total
from refusals import refusals

LAWS = ["areal", "linear-filtered", "linear"]
HOSTILE = "<script>alert(1)</script>"


@pytest.fixture(scope="module")
def first():
    return report_tree(LAWS)


def changed(tree, group, **new):
    """A copy of a result with other values for some variables of a group."""
    other, held = tree.copy(deep=True), tree[group].to_dataset()
    values = {name: (held[name].dims, np.asarray(found), held[name].attrs) for name, found in new.items()}
    other[group] = xr.DataTree(held.assign(values))
    return other


def louder(tree, level):
    return changed(tree, "spectra", force_level=tree["spectra/force_level"].values + level)


def with_parameters(tree, **values):
    other = tree.copy(deep=True)
    items = [{"key": key, "value": value, "note": "what it is"} for key, value in values.items()]
    other["scenario"].attrs["parameters"] = json.dumps(items)
    return other


def finite(found):
    return found.values[np.isfinite(found.values)]


def test_cells_at_rims_that_were_chosen_otherwise_are_told(first):
    runs = [first.copy(deep=True) for _ in range(2)]
    for run, cells in zip(runs, ("covered", "whole"), strict=True):
        run["contact"].attrs["rim_cells"] = cells
    told = {"key": "contact.rim_cells", "note": "chosen by the texture", "values": ["covered", "whole"]}
    assert comparison_of(runs, ["a", "b"]).keys == [told]


def test_a_run_does_not_differ_from_itself(first):
    found = comparison_of([first, first], ["a", "b"])
    for name in found.table.data_vars:
        if name.endswith("_difference"):
            assert (finite(found.table[name]) == 0.0).all()
    assert found.keys == []
    assert summary(found).startswith("The cases are the same. b against a, ")
    force = first["rolling/contact_force"]
    np.testing.assert_array_equal(found.table["peak_force"][0], force.max("time"))
    np.testing.assert_allclose(found.table["rms_force"][0], force.std("time"))
    np.testing.assert_array_equal(found.table["contact_loss_share"][0], first["rolling/contact_loss_share"])


@pytest.mark.parametrize("more", [0.0, 6.0])
def test_the_same_difference_in_all_bands_is_told_once(first, more, monkeypatch):
    """Not as '+6.0 dB (25 Hz) to +6.0 dB (25 Hz)'; here all bands of a short record say something."""
    monkeypatch.setattr("asperity.reporting.comparison_page._sure", lambda table, run: True)
    told = summary(comparison_of([first, louder(first, more)], ["a", "b"]))
    assert re.search(rf"contact force level {more} dB in \d\d bands, {more} dB\(A\)", told.replace("+", ""))


def test_a_weighted_total_of_two_bands():
    """IEC 61672-1:2013, table 3: the A-weighting is -19.1 dB at 100 Hz and 0 dB at 1 kHz."""
    total = a_weighted_total([[80.0, 60.0], [np.nan, 60.0], [np.nan, np.nan]], [100.0, 1000.0])
    assert total[0] == pytest.approx(10 * np.log10(10 ** (8.0 - 1.91) + 10**6.0), abs=0.03)
    assert total[1] == pytest.approx(60.0, abs=0.01)
    assert np.isnan(total[2])


def test_levels_are_compared_over_the_bands_of_both(first):
    """6 dB more in all bands; the third run lacks its loudest ones: its total is lower, no difference is."""
    level = first["spectra/force_level"].values.copy()
    level[:, 5:] = np.nan
    table = asperity.compare(first, louder(first, 6.0), changed(first, "spectra", force_level=level))
    np.testing.assert_allclose(finite(table["force_level_difference"][1]), 6.0, rtol=1e-12)
    np.testing.assert_allclose(table["force_level_a_difference"][1], 6.0, rtol=1e-12)
    total = a_weighted_total(first["spectra/force_level"].values, first["spectra/band"].values)
    np.testing.assert_allclose(table["force_level_a"][0], total)
    assert float(table["force_level_a"][2, 0]) < float(table["force_level_a"][0, 0])
    np.testing.assert_allclose(table["force_level_a_difference"][2], 0.0, atol=1e-12)


def test_accelerometers_count_by_their_energy_mean_and_chance_is_that_of_each_run(first):
    """10 lg((10^9 + 10^10 + 3 · 10^9)/5) = 94.47 dB."""
    level = np.full(first["spectra/acceleration_level"].shape, 90.0)
    level[:, 1] = 100.0
    told = np.full(first["spectra/level_deviation"].shape, 0.4)
    found = comparison_of([first, changed(first, "spectra", acceleration_level=level, level_deviation=told)])
    table, drawn = found.table, compared_blocks(found)[3].chart
    expected = 10 * np.log10((1e10 + 4e9) / 5)
    np.testing.assert_allclose(table["acceleration_level"][1], expected, rtol=1e-12)
    np.testing.assert_allclose(table["level_deviation"][1], 0.4)
    (chance,) = (mark for mark in drawn.panels[1].marks if isinstance(mark, Boxes))
    own = first["spectra/level_deviation"].values
    np.testing.assert_allclose(chance.high, np.sqrt(own**2 + 0.4**2))


def test_stiffness_twice_as_large_is_six_decibels(first):
    soft, stiff = first.copy(deep=True), first["contact/stiffness"].values * 2.0
    stiff = changed(first, "contact", stiffness=stiff)
    soft["contact"].attrs["working_stiffness"] = 2e7
    stiff["contact"].attrs["working_stiffness"] = 4e7
    table = asperity.compare(soft, stiff)
    np.testing.assert_allclose(finite(table["stiffness_difference"][1]), 20 * np.log10(2.0), rtol=1e-9)
    assert float(table["working_stiffness_difference"][1]) == pytest.approx(6.0206, abs=1e-4)


def test_the_filter_is_that_of_the_working_approach(first):
    """Half way between two states it is the mean of both."""
    magnitude = np.ones(first["contact/filter"].shape)
    magnitude[1] = 0.5
    other = changed(first, "contact", filter=magnitude)
    other["contact"].attrs["working_approach"] = float(first["contact/approach"][:2].mean())
    wavenumber, level = working_filter(other)
    assert len(wavenumber) > 10
    np.testing.assert_allclose(level, 20 * np.log10(0.75), rtol=1e-9)


def test_keys_that_differ_are_listed_and_no_others(first):
    cases = [{"speed": "1 m/s"}, {"speed": "2 m/s"}, {"radius": "5 mm"}]
    found = comparison_of([with_parameters(first, seed="1", **case) for case in cases])
    told = [(item["key"], item["values"]) for item in found.keys]
    assert told == [("speed", ["1 m/s", "2 m/s", None]), ("radius", [None, None, "5 mm"])]
    ball = with_parameters(first, kind="ball", speed="1 m/s", radius="5 mm")
    wheel = with_parameters(first, kind="wheel", speed="2 m/s", load="60 kN")
    found = comparison_of([ball, wheel])
    assert [item["key"] for item in found.keys] == ["kind", "speed"]


def test_different_main_laws_are_compared_as_such(first):
    other = report_tree(["shifted", "linear"])
    table = asperity.compare(first, other)
    assert table["law"].values.tolist() == [MAIN, *LAWS, "shifted"]
    own = other["spectra/force_level"].sel(law="shifted")
    np.testing.assert_array_equal(table["force_level"].sel(law=MAIN)[1], own)
    assert np.isnan(table["force_level_difference"].sel(law="areal")[1]).all()
    assert np.isfinite(table["force_level_difference"].sel(law="linear")[1]).any()


@pytest.mark.parametrize(
    ("paths", "names"),
    [(["runs/a/run.nc", "runs/b"], ["a", "b"]), (["x/a", "y/a/run.nc"], ["x/a", "y/a"]),
     (["a", "a"], ["a (1)", "a (2)"])],
)  # fmt: skip
def test_runs_are_called_so_that_they_can_be_told_apart(paths, names):
    assert names_of(paths) == names


test_wrong_arguments_are_explained = refusals(
    (1, {}, "runs to compare: received 1; allowed: two to 8 runs."),
    (9, {}, "runs to compare: received 9"),
    (2, {"names": ["a", "a"]}, "names: received ['a', 'a']; allowed: one name for each run, each once."),
    of=lambda count, settings, first: asperity.compare(*[first] * count, **settings),
)


def test_page_and_table_of_runs_with_hostile_names(first, tmp_path):
    second = with_parameters(louder(first, 3.0), speed=HOSTILE)
    second.attrs["verdict"] = HOSTILE
    table = asperity.compare(first, second, names=["=a", HOSTILE], path=tmp_path)
    page = (tmp_path / "comparison.html").read_text(encoding="utf-8")
    assert len(own_scripts(page)) == 2
    assert "&lt;script&gt;" in page
    assert page.count("<figure") == 3  # force, acceleration, contact
    with open(tmp_path / "comparison.csv", encoding="utf-8", newline="") as file:
        heading, *rows = csv.reader(file)
    assert heading[:5] == ["what", "quantity", "law", "at", "unit"]
    assert heading[5:] == ["'=a", HOSTILE, "unit of the difference", f"{HOSTILE} - =a"]
    by_place = {tuple(row[1:4]): row for row in rows}
    for law in LAWS:
        for b, band in enumerate(table["band"].values):
            row = by_place["force_level", law, f"{band:.6g} Hz"]
            assert [float(row[5]), float(row[6])] == table["force_level"].sel(law=law)[:, b].values.tolist()
            assert float(row[8]) == pytest.approx(3.0)
    assert by_place["speed", "", ""][6] == HOSTILE
    assert float(by_place["force_level_a", "areal", ""][8]) == pytest.approx(3.0)


def test_missing_groups_leave_a_page(first, tmp_path):
    """Runs of laws that need no samples have no filters; a level that nobody has is left out."""
    bare = first.copy(deep=True)
    bare["contact"] = bare["contact"].to_dataset().drop_vars(["filter", "stiffness"])
    bare["spectra"] = bare["spectra"].to_dataset().drop_vars("acceleration_level")
    table = asperity.compare(bare, louder(bare, 1.0), path=tmp_path / "page.html")
    assert not {"filter", "stiffness", "acceleration_level"} & set(table)
    assert "Contact force level" in (tmp_path / "page.html").read_text(encoding="utf-8")
    assert (tmp_path / "page.csv").exists()
