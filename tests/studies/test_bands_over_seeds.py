"""Mean and band over seeds: the band holds fresh members as often as it says."""

import numpy as np
import pytest
import xarray
from executors import Here

import asperity
from asperity.errors import InputError
from asperity.reporting.chart import INK, Area, Line
from asperity.reporting.study_figures import ensemble_figure
from asperity.studies.ensemble import mean_and_scatter
from small_cases import COARSE

CASE = COARSE | {
    "laws": ["hertz", "linear"],
    "start": "0.4 m",
    "duration": "0.15 s",
    "contact": COARSE["contact"] | {"samples": 1, "sample_length": "1.6 mm"},
}


def table(levels, **coordinates):
    """A table of levels (seed, …) as a study has it."""
    coords = {"seed": np.arange(len(levels)), **coordinates}
    held = {"force_level": (list(coords), levels, {"units": "dB re 1 N", "long_name": "level"})}
    held["completed"] = ("seed", np.isfinite(levels).reshape(len(levels), -1).any(axis=1).astype(np.int8))
    return xarray.Dataset(held, coords)


def held(found, level):
    """Where levels lie in a band."""
    return (level >= found["force_level_low"]) & (level <= found["force_level_high"])


class TestBand:
    def test_the_numbers_of_a_textbook(self):
        """Hahn and Meeker's formula, with t(0.9; 4) = 1.533 from a table of Student's distribution."""
        found = asperity.prediction_band(table(np.array([1.0, 2.0, 3.0, 4.0, 5.0])))
        reach = 1.533 * np.sqrt(2.5) * np.sqrt(1.2)
        assert float(found["force_level"]) == 3.0
        assert float(found["force_level_low"]) == pytest.approx(3.0 - reach, abs=2e-3)
        assert float(found["force_level_high"]) == pytest.approx(3.0 + reach, abs=2e-3)

    @pytest.mark.parametrize("count", [3, 8, 30])
    @pytest.mark.parametrize("freedom", [2, 20])
    def test_levels_of_short_records_are_held_as_often_as_it_says(self, count, freedom):
        """Levels of noise are chi-square with 2 B T degrees of freedom: 20 000 bands, one more level each."""
        power = np.random.default_rng(0).chisquare(freedom, (count + 1, 20_000)) / freedom
        level = 10 * np.log10(power)
        found = asperity.prediction_band(table(level[:count], place=np.arange(20_000)))
        assert held(found, level[count]).mean() == pytest.approx(0.8, abs=0.04)

    @pytest.mark.parametrize("share", [0.5, 0.95])
    def test_another_share(self, share):
        level = np.random.default_rng(1).normal(size=(7, 20_000))
        found = asperity.prediction_band(table(level[:6], place=np.arange(20_000)), share=share)
        assert held(found, level[6]).mean() == pytest.approx(share, abs=0.01)

    def test_failed_members_are_left_out(self):
        level = np.array([[1.0, 1.0, 1.0], [2.0, np.nan, 3.0], [np.nan] * 3, [4.0, -np.inf, np.nan]])
        found = asperity.prediction_band(table(level, place=[0.0, 1.0, 2.0]))
        assert found["force_level"][::2].values == pytest.approx([7 / 3, 2.0])  # two are enough
        assert np.isfinite(found["force_level_low"][2])
        assert np.isnan(found["force_level"][1])
        assert found["force_level"].attrs["missing"] == "fewer than two members have it"
        assert found.attrs["members"] == 3

    def test_it_says_what_is_wrong(self):
        levels = table(np.zeros((4, 2)), place=[0.0, 1.0])
        for few, count in ((levels[{"seed": [0, 1]}], 2), (3, 0)):
            with pytest.raises(InputError, match=f"received {count} values of seed; allowed: at least 3"):
                asperity.prediction_band(few)
        for share in (0.0, 1.0, "half"):
            with pytest.raises(InputError, match="a number above 0 and below 1"):
                asperity.prediction_band(levels, share=share)


@pytest.mark.long
def test_the_band_of_a_study_covers_fresh_seeds_as_often_as_it_claims():
    """Ten seeds make the band, twenty fresh ones lie in it as often as it says, within ten points."""
    study = asperity.study(CASE, {"seed": list(range(1, 31))}, executor=Here())
    found = asperity.prediction_band(study.isel(seed=slice(10)))
    inside = held(found, study["force_level"].isel(seed=slice(10, None)))
    assert inside.sizes["seed"] == 20
    for law in ("hertz", "linear"):
        assert float(inside.sel(law=law).mean()) == pytest.approx(0.8, abs=0.1)
    width = found["force_level_high"] - found["force_level_low"]
    assert 1.0 < float(width.min()) < float(width.max()) < 20.0


def test_the_figure_shows_mean_and_band():
    levels = np.random.default_rng(2).normal(60.0, 3.0, (5, 2, 3))
    found = asperity.prediction_band(table(levels, law=["hertz", "linear"], band=[100.0, 125.0, 160.0]))
    panel, meaning, left = ensemble_figure(found, {"hertz": {"colour": "#0067a5", "law": "hertz"}})
    lines = {mark.label: mark for mark in panel.marks if isinstance(mark, Line)}
    np.testing.assert_allclose(lines["linear"].y, found["force_level"].sel(law="linear"))
    areas = [mark for mark in panel.marks if isinstance(mark, Area)]
    assert [(area.colour, area.law) for area in areas] == [(INK, ""), ("#0067a5", "hertz")]  # main on top
    np.testing.assert_allclose(areas[1].high, found["force_level_high"].sel(law="hertz"))
    assert "mean over 5 values of seed" in meaning
    assert "it holds the value of one more seed with a probability of 80 %" in meaning
    assert not left


def test_panels_of_other_keys_reach_from_first_to_last_and_are_counted_where_some_are_left_out():
    levels = np.random.default_rng(2).normal(60.0, 3.0, (4, 9, 1, 3))
    swept = table(levels, speed=np.arange(9.0), law=["hertz"], band=[100.0, 125.0, 160.0])
    swept["speed"].attrs |= {"units": "m/s", "long_name": "speed"}
    *panels, _, left = ensemble_figure(asperity.prediction_band(swept), {})
    assert [panel.title.split()[2] for panel in (panels[0], panels[-1])] == ["0", "8"]
    assert left == f"{len(panels)} of 9 values of speed are shown; the CSV file has all."


def test_fewer_than_two_members_do_not_scatter():
    """None, one and two of them: (n − 1) is of two at least."""
    levels = np.array([[np.nan, 1.0, 1.0], [np.nan, np.nan, 3.0]])
    mean, scatter = mean_and_scatter(table(levels, band=[1.0, 2.0, 3.0]))
    np.testing.assert_array_equal(scatter["force_level"], [np.nan, np.nan, np.sqrt(2.0)])
    np.testing.assert_array_equal(mean["force_level"], [np.nan, 1.0, 2.0])
