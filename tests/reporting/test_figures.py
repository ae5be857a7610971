"""Figures that all kinds share, as charts: what is drawn, how far axes reach, what is shaded and said."""

import json

import numpy as np
import pytest
import xarray as xr
from report_tree import LAWS, PARTS, laws_in, report_tree, uncertain, with_force

from asperity.laws import spec_of
from asperity.ranks import Ranked
from asperity.reporting.chart import Boxes, Field, Line, Note, Rules, as_seen
from asperity.reporting.data import law_entries, missing
from asperity.reporting.fit_figures import Compared, fit_figure
from asperity.reporting.texture_figures import distribution, height_histogram
from asperity.scenes.figures.force import TO_REFERENCE
from asperity.schema import bearing, contact

SPECTRA = ("force_bands", "force_psd", "acceleration_sensors", "acceleration_laws")
OF_LAWS = ("force_psd", "force_bands", "acceleration_laws", "force_peak", "force_envelope")
WAVE = np.sin(np.arange(1000) * 0.1)


@pytest.fixture(scope="module")
def tree():
    return report_tree()


@pytest.fixture
def small():
    return report_tree(["areal", "linear"])


def panels(name, tree):
    return PARTS[name].drawn(tree).chart.panels


def marks(name, tree, kind=Line):
    return [mark for panel in panels(name, tree) for mark in panel.marks if isinstance(mark, kind)]


# --- laws


@pytest.mark.parametrize("laws", [LAWS, ["linear"], ["areal", "hertz-filtered", "linear-filtered"]])
def test_any_set_of_laws_in_its_colours(laws):
    tree = report_tree(laws)
    for name in OF_LAWS:
        assert laws_in(PARTS[name].drawn(tree).chart) == set(laws)
        drawn = {line.law: line.colour for line in marks(name, tree) if line.law}
        assert drawn == {law: spec_of(law).look.colour for law in laws}, name
        assert set(laws) <= {line.label for line in marks(name, tree)}


def test_no_two_laws_of_a_result_have_one_colour():
    gold = {"colour": "#96700a", "dashes": "-"}
    taken = [{"name": "a", **gold}, {"name": "b", **gold}, {"name": "c", "colour": "#6b3e12"}]
    tree = xr.DataTree.from_dict({"scenario": xr.Dataset(attrs={"laws": json.dumps(taken)})})
    a, b, c = law_entries(tree).values()
    assert (a.colour, c.colour) == ("#96700a", "#6b3e12")
    assert b.colour not in {a.colour, c.colour}


# --- the force in time


@pytest.mark.parametrize("name", ["force_peak", "force_envelope"])
def test_a_wild_law_does_not_flatten_the_main_one(name):
    tree = with_force(60 + 10 * WAVE, 60 + 30 * WAVE, 60 + 400 * WAVE)
    axis = panels(name, tree)[0].y
    assert axis.high - axis.low < 2.2 * 20.0
    assert axis.low < 50.0 < 70.0 < axis.high
    assert [line.opacity for line in marks(name, tree)] == [0.5, 0.5, 1.0]  # the main law is drawn last
    flying = with_force(np.maximum(5 + 10 * WAVE, 0.0), 5 + 4 * WAVE)
    assert panels(name, flying)[0].y.low < 0.0  # zero is where contact is lost


def test_loss_of_contact_is_drawn_where_there_is_any():
    force = np.full(1000, 5.0)
    force[[0, 1, 700, 999]] = 0.0
    tree = with_force(force, force, 5 * WAVE)
    chart, time = PARTS["force_envelope"].drawn(tree).chart, 1e3 * tree["rolling/time"].values
    whole, below = chart.panels
    areal, shifted = (mark for mark in below.marks if isinstance(mark, Boxes))  # linear pulls
    assert (areal.law, shifted.law) == ("areal", "shifted")
    assert [word for _, word in below.y.ticks] == ["areal", "shifted", "linear"]
    half = (time[1] - time[0]) / 2
    np.testing.assert_allclose(areal.left, time[[0, 700, 999]] - half)
    np.testing.assert_allclose(areal.right, time[[1, 700, 999]] + half)
    (shaded,) = (mark for mark in whole.marks if isinstance(mark, Boxes))
    assert (shaded.law, shaded.left.tolist()) == ("areal", areal.left.tolist())
    calm = with_force(60 + WAVE)
    assert len(panels("force_peak", calm)) == 1


def test_the_whole_run_is_there_step_by_step(tree):
    force = tree["rolling/contact_force"]
    for line in marks("force_envelope", tree):
        np.testing.assert_array_equal(line.y, force.sel(law=line.law).values)


# --- the contact


def test_filters_are_drawn_as_estimated_as_fitted_and_as_applied(tree):
    held = tree["contact"].to_dataset()
    row = int(np.abs(held["approach"].values - held.attrs["working_approach"]).argmin())
    excited, lines = held["filter_excited"].values > 0, marks("contact_filter", tree)
    for name in ("filter_raw", "filter", "filter_applied"):
        level = 20 * np.log10(held[name].values[row])
        shown = excited & (level > -40)
        assert any(np.allclose(line.y[shown], level[shown]) for line in lines), name
    assert not any(np.isfinite(line.y[~excited]).any() for line in lines if not line.dashes)
    assert len(marks("contact_filter", tree, Boxes)) == 1
    assert "Grey: waves that the texture lacks" in PARTS["contact_filter"].drawn(tree).caption


def test_hertz_is_drawn_in_closed_form_and_not_below_its_touch(small):
    constant = small["contact"].attrs["hertz_constant"]
    for panel, power, unit in zip(panels("contact_force", small), (1.5, 0.5), (1.0, 1e6), strict=True):
        (line,) = (mark for mark in panel.marks if isinstance(mark, Line) and mark.label == "Hertz")
        assert line.x[0] == 0.0
        assert len(line.x) > 10 * small["contact"].sizes["approach"]
        assert np.allclose(line.y, constant * (line.x * 1e-6) ** power / unit)


def test_gaps_are_told_in_plain_words(tree):
    held = contact.FILTER.variable(tree["contact/filter"].values)
    gaps = xr.DataTree.from_dict({"contact": xr.Dataset({contact.FILTER.name: held})})
    told = "Gaps in the contact filter, fitted magnitude: the samples do not touch in these states, or have"
    assert missing(gaps, contact.FILTER).startswith(told)
    assert missing(xr.DataTree(), contact.FILTER) == ""
    films = bearing.FILM_THICKNESS, bearing.LEAST_FILM
    no_film = {each.name: each.variable(np.array([[[1e-7, np.nan]]])) for each in films}
    gaps = xr.DataTree.from_dict({"bearing": xr.Dataset(no_film)})
    assert missing(gaps, *films) == (
        f"Gaps in the {films[0].long_name} and in the {films[1].long_name}: {films[0].missing}."
    )


# --- the texture


def test_a_spike_of_the_sample_does_not_take_its_colours(small):
    surface = small["surface"].to_dataset()
    heights = surface["sample_heights"].values
    usual = np.ptp(np.percentile(heights, [0.1, 99.9]))
    heights[0, 0] = 1e3 * heights.max()  # a spike: colours leave out one in a thousand
    small["surface"] = surface
    small["surface"].attrs["across"] = "lines"
    (field,) = marks("texture_sample", small, Field)
    assert (field.high - field.low) / field.values.max() < 2 * usual / heights.max()
    for name in ("texture_sample", "texture_path"):
        assert any(panel.title.endswith("as laid out between lines") for panel in panels(name, small))


# --- bands that say little, and the linear laws that all others are compared with


@pytest.mark.parametrize("name", SPECTRA)
def test_bands_that_say_little_or_hold_the_start_are_shaded(name):
    tree, little = uncertain(0.4)
    bands = tree["spectra/band"].values
    edge = bands[little].max() * 10**0.05
    for panel in panels(name, tree):
        (shaded,) = (mark for mark in panel.marks if isinstance(mark, Boxes))
        assert shaded.right == pytest.approx([edge], rel=1e-6)
    assert any(note.text == "says little" for note in marks(name, tree, Note))
    assert "B T is below 10" in PARTS[name].drawn(tree).caption
    held = np.where(np.arange(little.size) == np.flatnonzero(little)[-1] + 3, 0.3, 0.1)
    tree["spectra"]["start_share"] = xr.Variable("band", held)
    shaded = marks(name, tree, Boxes)[0]
    assert shaded.right[0] < shaded.left[1] < bands[held > 0.2] < shaded.right[1]
    assert "low by more than 1 dB" in PARTS[name].drawn(tree).caption
    enough, _ = uncertain(0.0)
    assert not marks(name, enough, Boxes)
    assert "B T" not in PARTS[name].drawn(enough).caption


def test_differences_are_drawn_over_the_filtered_linear_contact_first(tree):
    part, spectra = PARTS["force_bands"], tree["spectra"].to_dataset()
    labels = [panel.y.label for panel in panels("force_bands", tree)]
    assert labels[1:] == [f"level − {law} / dB" for law in ("linear-filtered", "linear", "table")]
    assert len(marks("force_bands", tree, Rules)) == 3  # zero
    columns = part.drawn(tree).columns
    own = [name for name in columns if name.startswith("areal minus l")]
    assert own == ["areal minus linear-filtered [dB]", "areal minus linear [dB]"]
    assert {"linear minus linear-filtered [dB]"} < {*columns} - {"linear minus linear [dB]"} == {*columns}
    for law in ("linear-filtered", "linear"):
        expected = spectra["force_level"].sel(law="areal") - spectra["force_level"].sel(law=law)
        np.testing.assert_allclose(columns[f"areal minus {law} [dB]"], expected)
    solved = columns["areal minus reference [dB]"]
    np.testing.assert_array_equal(solved, spectra[TO_REFERENCE.name].sel(law="areal"))
    assert "minus that of linear-filtered and that of linear" in part.drawn(tree).caption


def test_of_a_large_field_means_are_drawn_and_missing_points_stay_missing():
    values = np.arange(2_100.0 * 3).reshape(2_100, 3)
    values[4:6] = np.nan
    values[1, 0] = np.nan
    seen, (along, across) = as_seen(values)
    assert seen.shape == (1_050, 3)
    assert (along, across) == (1.0, 1.0)
    assert np.isnan(seen[2]).all()
    assert seen[0].tolist() == [0.0, 2.5, 3.5]
    assert seen[-1].tolist() == values[-2:].mean(axis=0).tolist()
    odd, shares = as_seen(values[:1_537])
    assert odd.shape == (768, 3)
    assert shares == (1_536 / 1_537, 1.0)
    assert as_seen(values[:1_535])[0].shape == (1_535, 3)


def test_a_histogram_of_few_heights_is_in_its_panel():
    """Of digits few bins hold all, each higher than the normal distribution: the panel was empty."""
    heights = 1e-9 * np.random.default_rng(0).integers(0, 10, 20_000)
    panel = height_histogram({"heights": distribution(Ranked([heights]))}, (1e-9, "nm"), beside=False)
    steps = panel.marks[0]
    assert panel.y.high >= steps.y.max()
    assert steps.y.min() == panel.y.low  # steps stand on the foot of the panel, also between digits


def test_the_normal_distribution_of_heights_ends_before_it_is_zero():
    """Of heights with one far from all others it falls below all numbers, which no axis in decades holds."""
    heights = np.append(np.random.default_rng(0).normal(3.0, 0.3, 5_000), 65.0)
    panel = height_histogram({"heights": distribution(Ranked([1e-6 * heights]))}, (1e-6, "µm"), beside=False)
    normal = panel.marks[1].y
    assert np.isnan(normal).any()
    assert np.nanmin(normal) > 1e-9 * np.nanmax(normal)


@pytest.mark.parametrize(
    ("count", "left"), [(8, ""), (9, "8 of 9 measurements are shown; the CSV file has all.")]
)
def test_measurements_of_a_fit_that_are_left_out_are_counted(count, left):
    at = np.array([100.0, 200.0])
    one = Compared("decay rate", "dB/m", "frequency (Hz)", "rates.csv", at, at, at, at, at, 0.0)
    *panels, _, told = fit_figure([one] * count, stated=True)
    assert (len(panels), told) == (8, left)
