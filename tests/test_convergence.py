"""A case computed again with each setting finer: on the same surface, told in numbers, kept and resumed."""

import json
import re
from dataclasses import replace
from typing import ClassVar

import numpy as np
import pytest
import xarray

import asperity
from asperity import HeightMap
from asperity import convergence as converging
from asperity.case.cases import as_case
from asperity.convergence import halves
from asperity.errors import InputError
from asperity.reporting.page import sections_of
from asperity.reporting.tables import changes_table, settings_table
from asperity.running import prepare_case
from asperity.scenarios.refining import Way, on_the_surface_of, restricted, settings_for
from asperity.scenes import schema as scene
from asperity.scenes.bearing_refining import settings_of_bearing
from asperity.scenes.report import CHAPTERS
from asperity.schema import Entry, contact, convergence, spectra
from asperity.surfaces.synthesis import long_self_affine
from command_line import call
from small_cases import COARSE, changed

pytestmark = pytest.mark.usefixtures("cache_of_module")
BALL = COARSE | {
    "laws": ["areal", "linear"],
    "start": "0.45 m",
    "duration": "60 ms",
    "settling": "0 s",
    "contact": COARSE["contact"] | {"samples": 2, "sample_length": "3 mm"},
}
LINE = BALL | {"laws": ["hertz"], "surface": {"spectrum": "iso3095", "level": "-30 dB"}}
"""The same on a line, of which no sample is pressed."""
WHEEL = changed(
    "wheel-on-rail",
    laws=["shifted", "linear"],
    speed="30 m/s",
    contact={"window": "25 mm", "sample_length": "0.1 m"},
    numerics={"highest_frequency": "1 kHz"},
)
NAMES = ["grid", "window", "samples", "approaches", "time step", "modes", "path length"]
SILENT = pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")


@pytest.fixture(scope="module")
def ball(cache_of_module):
    return asperity.run(BALL, converge=True)


def case_of(data):
    return prepare_case(as_case(data))


def settings(prepared):
    return {setting.name: setting for setting in settings_for(prepared, np.linspace(-1e-6, 3e-6, 5))}


def finer(data, setting):
    small = case_of(data)
    return small, prepare_case(small.case.with_(**settings(small)[setting].ways[0].changes))


def told(result, name):
    """What each setting has of a variable."""
    values = result["convergence"][name].values.tolist()
    return dict(zip(result["convergence"]["setting"].values.tolist(), values, strict=True))


class TestOnTheSameSurface:
    """Heights of the coarser computation are those of the finer one, at its own points."""

    @pytest.mark.parametrize("data", [BALL, WHEEL])
    @pytest.mark.parametrize("setting", ["grid", "window"])
    def test_the_coarser_grid_has_points_of_the_finer(self, data, setting):
        small, large = finer(data, setting)
        every = 2 if setting == "grid" else 1
        found, whole = on_the_surface_of(small, large).textures, large.textures
        spacing = small.case.contact.spacing
        assert found.path.spacing == (spacing, spacing)
        assert found.path.shape[1] == small.textures.path.shape[1]
        assert found.start + found.before * spacing == pytest.approx(small.case.record_start, abs=1e-12)
        assert abs(found.before - small.textures.before) <= small.textures.path.shape[1]
        first = round((found.start - whole.start) / large.case.contact.spacing)
        reach = every * (found.path.shape[1] // 2)
        middle = whole.path.shape[1] // 2
        columns = slice(middle - reach, middle + reach + 1, every)
        same = whole.path.rows(0, whole.path.shape[0])[first::every, columns]
        if data is BALL or setting == "window":  # nothing of a spectrum is too short for the grid
            np.testing.assert_array_equal(found.path.heights, same)
        else:  # it has shorter bands on the finer grid, which are removed
            long = np.convolve(whole.line, np.ones(8) / 8, "same")[first::2]
            assert np.corrcoef(np.convolve(found.line, np.ones(4) / 4, "same"), long)[0, 1] > 0.99
            assert np.std(np.diff(found.line)) < np.std(np.diff(same[:, middle // 2]))
        np.testing.assert_array_equal(found.line, found.path.heights[:, found.path.shape[1] // 2])
        recorded = found.recorded
        assert recorded.stop - recorded.start >= small.textures.recorded.stop - small.textures.recorded.start
        assert len(found.line) - recorded.stop > reach // every  # the window stays on the path

    def test_waves_that_a_grid_holds_stay_and_others_go(self):
        """A wave of four coarse points stays as it is, one of one and a half points goes."""
        large = finer(BALL, "grid")[1].textures
        x = np.arange(large.path.shape[0])[:, None]
        long = np.cos(2 * np.pi * (x / 8 + 0.1)) + np.zeros(large.path.shape)
        heights = long + np.cos(2 * np.pi * x / 3)
        path = HeightMap(heights, large.path.spacing)
        found = restricted(replace(large, path=path, line=heights[:, large.path.shape[1] // 2]), 20e-6, 2, 19)
        inside = slice(20, -20)
        np.testing.assert_allclose(found.line[inside], long[large.before % 2 :: 2, 0][inside], atol=0.02)

    def test_a_long_path_is_held_or_refused(self, monkeypatch):
        large = finer(BALL, "grid")[1].textures
        waves = {"rms": 1e-6, "hurst": 0.8, "longest": 0.4e-3, "shortest": 80e-6}
        strip = long_self_affine(large.path.shape, large.path.spacing, **waves, seed=1)
        found = restricted(replace(large, path=strip), 20e-6, 2, 19)
        assert found.path.shape == (len(found.line), 19)
        monkeypatch.setattr("asperity.scenarios.refining.MOST_POINTS", 1000)
        with pytest.raises(InputError, match="at most 1000 points, to be compared on another grid"):
            restricted(replace(large, path=strip), 20e-6, 2, 19)


class TestNumbers:
    def test_each_setting_is_told_as_the_schema_says(self, ball):
        group = ball["convergence"].to_dataset()
        entries = [item for item in vars(convergence).values() if isinstance(item, Entry)]
        assert set(group.variables) == {entry.name for entry in entries}
        assert set(group.attrs) == {convergence.SENTENCE.name}
        for entry in entries:
            assert (group[entry.name].dims, group[entry.name].attrs["units"]) == (entry.dims, entry.units)
        words = told(ball, "change")
        assert list(words) == NAMES
        assert (words["grid"], words["samples"]) == ("40 µm → 20 µm", "2 → 4")
        assert words["modes"] == "up to 8 kHz → up to 16 kHz"
        assert not any(group["limit"].values)
        assert np.isfinite(group["largest_change"].values).all()
        assert np.isfinite(group["stiffness_change"].values).tolist() == [True] * 6 + [False]

    def test_what_cannot_change_does_not_and_all_else_as_the_changed_case(self, ball):
        """The linear law has Hertz's stiffness: samples and states mean nothing to it, modes do."""
        change, stiffness = ball["convergence/force_level_change"], told(ball, "stiffness_change")
        for setting in ("samples", "approaches"):
            np.testing.assert_array_equal(change.sel(setting=setting, law="linear"), 0.0)
        assert stiffness["time step"] == stiffness["modes"] == 0.0
        assert float(np.abs(change.sel(setting="modes", law="linear")).max()) > 1e-3
        found = asperity.run(BALL | {"contact": BALL["contact"] | {"samples": 4}})
        difference = (found["spectra/force_level"] - ball["spectra/force_level"]).values
        np.testing.assert_allclose(change.sel(setting="samples"), difference, atol=1e-9)
        stiff, before = (tree["contact"].attrs["working_stiffness"] for tree in (found, ball))
        assert stiffness["samples"] == pytest.approx(stiff / before - 1.0, rel=1e-9)
        assert abs(stiffness["samples"]) > 1e-5

    def test_half_of_a_record_is_compared_with_all_of_it(self, ball):
        """The first half: here a tone is there of twice the amplitude that the second half has."""
        time = np.arange(8000) * 1e-4
        force = np.where(time < 0.4, 2.0, 1.0) * np.sin(2 * np.pi * 500.0 * time)
        held = xarray.Dataset({"contact_force": (("law", "contact", "time"), force[None, None])})
        tree = xarray.DataTree.from_dict({"/rolling": held})
        whole, half = halves(tree, 1e-4, 2e3)
        at = np.argmin(np.abs(whole.band.values - 500.0))
        assert half.force.values[0, at] == pytest.approx(10 * np.log10(2.0), abs=0.1)
        assert whole.force.values[0, at] == pytest.approx(10 * np.log10(1.25), abs=0.2)
        whole, half = halves(ball, as_case(BALL).time_step, 2e3)
        expected = (half - whole)["force"]
        change = ball["convergence/force_level_change"].sel(setting="path length")
        change = change.sel(band=expected["band"], method="nearest")
        np.testing.assert_allclose(change, expected, atol=1e-9)
        assert told(ball, "largest_change")["path length"] > 0.1

    @SILENT
    def test_a_setting_that_is_too_coarse_is_named(self):
        """A time step of six points per period of the highest frequency."""
        coarse = {"laws": ["hertz", "linear"], "numerics": COARSE["numerics"] | {"time_step": "80 us"}}
        verdict = asperity.run(LINE | coarse, converge=True)["convergence"].attrs["verdict"]
        expected = "Of its settings, time step (80 µs → 40 µs) changes the levels of hertz most"
        assert verdict.startswith(expected)


@pytest.fixture
def converged(monkeypatch):
    """Compare a case with some settings alone."""

    def converged(prepared, *settings):
        result = asperity.run(prepared, brief=True)
        monkeypatch.setattr(converging, "settings_of", lambda *_: settings)
        return converging.with_convergence(prepared, result, lambda *_: None)

    return converged


class TestLimits:
    @SILENT
    def test_a_map_too_small_for_a_wider_window_is_tried_with_a_narrower_one(self, converged):
        heights = 1e-8 * np.random.default_rng(0).normal(size=(130, 30))
        case = BALL | {"laws": ["hertz"], "surface": {"file": heights, "pixel": 40e-6}}
        prepared = case_of(case | {"contact": {"spacing": 40e-6, "window": 0.9e-3, "samples": 2}})
        found = converged(prepared, settings(prepared)["window"])
        assert told(found, "change") == {"window": "900 µm → 440 µm"}
        assert 0.0 < abs(told(found, "stiffness_change")["window"]) < 0.1

    def test_a_line_has_no_samples(self):
        result = asperity.run(LINE, converge=True)
        reason = "nothing is reduced from samples here"
        limited = [name for name, limit in told(result, "limit").items() if limit == reason]
        assert limited == ["window", "samples", "approaches"]
        assert "Not changed: window, samples, approaches." in result.attrs["verdict"]
        assert settings_table(result).rows[1][1].text == f"not changed: {reason}"
        assert told(result, "stiffness_change")["grid"] == 0.0

    def test_poles_are_held_to_the_kernel_that_they_stand_for(self):
        prepared = case_of(WHEEL)
        (way,) = settings(prepared)["poles"].ways
        assert way.words == "up to 60 → the kernel that they are fitted to"
        assert prepared.case.with_(**way.changes).numerics.kernel == "scatter"
        scattered = case_of(WHEEL.with_(numerics={"poles": None, "kernel": "scatter"}))
        assert "without poles" in settings(scattered)["poles"].limit

    @SILENT
    @pytest.mark.parametrize(("highest", "is_held"), [("215 Hz", False), ("2 kHz", True)])
    def test_half_of_a_record_that_holds_no_band_is_not_compared(self, converged, highest, is_held):
        """All of it holds the band of 200 Hz, half of it that of 400 Hz at least."""
        shorter = {"duration": "24 ms", "numerics": {"highest_frequency": highest, "time_step": "40 us"}}
        prepared = case_of(BALL | {"laws": ["linear"]} | shorter)
        found = converged(prepared, settings(prepared)["path length"])
        limit = told(found, "limit")["path length"]
        change = found["convergence/force_level_change"].sel(setting="path length")
        assert bool(np.isfinite(change).any()) == is_held
        assert ("Not changed: path length." in found.attrs["verdict"]) != is_held
        if not is_held:
            words = r"duration: received 0.012 s, half of the record, .*allowed: a half that holds a band up"
            assert re.match(words, limit), limit

    def test_what_fails_is_a_limit(self, converged):
        """No way of changing a setting ends the run."""
        never = converging.Setting("grid", (Way("to nothing", {"contact.spacing": 1.0}),))
        found = converged(case_of(BALL), never)
        assert told(found, "limit")["grid"].startswith("contact.spacing: received")
        assert found.attrs["verdict"].endswith("Not changed: grid.")


class TestKept:
    def test_an_interrupted_convergence_goes_on_where_it_was(self, own_cache, monkeypatch):
        prepared = case_of(BALL)
        result = asperity.run(prepared)
        some = [settings(prepared)[name] for name in ("grid", "window", "samples")]
        monkeypatch.setattr(converging, "settings_of", lambda *_: some)

        def messages(stop="never"):
            seen = []

            def progress(done, total, message):
                seen.append(message)
                if message.startswith(stop):
                    raise KeyboardInterrupt

            try:
                found = converging.with_convergence(prepared, result, progress)
            except KeyboardInterrupt:
                found = None
            return found, set(seen)

        _, first = messages(stop="samples")
        assert any(message.startswith("grid: ") for message in first)
        whole, again = messages()
        assert not any(message.startswith(("grid: ", "window: ")) for message in again)
        assert {"convergence", "samples: pressing the samples"} <= again
        same, last = messages()
        assert last == {"convergence"}
        assert same.identical(whole)

    def test_a_result_is_shown(self, ball):
        assert [each.title for each in sections_of(ball, CHAPTERS[-1:])] == ["Uncertainty"]
        table = changes_table(ball)
        assert table.head == ["band / Hz", *NAMES]
        assert len(table.rows) == ball["spectra"].sizes["band"]
        cells = [cell.text for row in table.rows for cell in row[1:]]
        assert not {"+0.00", "−0.00"} & set(cells)
        assert ball["convergence"].attrs["verdict"] in ball.attrs["verdict"]


@SILENT
def test_the_command_line_does_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case.toml").write_text(as_case(LINE).to_toml())
    words = ("run", "case.toml", "--converge", "-o", "out", "--no-report")
    assert "Of its settings" in call(*words).stdout
    result = asperity.open_result("out")
    assert json.loads(result["scenario"].attrs["laws"])[0]["name"] == "hertz"
    assert "convergence" in result.children
    assert "Nothing to do" in call(*words).stderr


class TestBearing:
    """A ball bearing is made finer by the same machinery: by settings of its own, on records of its own."""

    CASE: ClassVar = {
        "kind": "ball-bearing", "speed": "3600 1/min", "axial": "100 N", "laws": ["hertz"],
        "duration": "50 ms", "settling": "10 ms", "bearing": {"name": "6205"},
        "inner_raceway": {"waviness": "50 nm"}, "housing": {"lobes": 3},
    }  # fmt: skip

    @SILENT
    def test_changes_of_the_time_step_are_of_second_order(self, converged):
        sizes = []
        for step in ("8 us", "4 us"):
            prepared = prepare_case(as_case(self.CASE | {"time_step": step}))
            (setting,) = (each for each in settings_of_bearing(prepared, None) if each.name == "time step")
            found = converged(prepared, setting)
            level = found["convergence/force_level_change"].values[0, 0]
            sizes.append(np.sqrt(np.mean(level[np.isfinite(level)][:12] ** 2)))
        assert 3.0 < sizes[0] / sizes[1] < 5.5

    @SILENT
    def test_what_matters_is_told_with_what_was_not_changed(self, converged, tmp_path):
        case = as_case(self.CASE)
        prepared = prepare_case(case)
        every = {each.name: each for each in settings_of_bearing(prepared, None)}
        found = converged(prepared, *(every[name] for name in ("grid", "lobes", "path length")))
        assert told(found, "change")["lobes"] == "3 → 5"
        assert told(found, "largest_change")["lobes"] > 0.5
        assert "Of its settings, lobes (3 → 5) changes the levels of hertz most" in found.attrs["verdict"]
        assert found.attrs["verdict"].endswith("Not changed: grid.")
        assert np.isfinite(found["convergence/motion_level_change"].values[1:]).any()
        assert "lobes" in asperity.report(found, tmp_path).read_text(encoding="utf-8")
        slips = prepare_case(case.with_(cage_slip=[0.0, 0.01], housing={"lobes": None}, settling=0.0))
        limits = {each.name: each.limit for each in settings_of_bearing(slips, None)}
        assert limits["run-in"].startswith("the cage slips by chance")
        assert limits["lobes"] == "the outer ring is rigid, or bends by given modes"
        still = {
            each.name: each for each in settings_of_bearing(prepare_case(case.with_(settling=0.0)), None)
        }
        assert still["run-in"].ways[0].words == "0 ms → 50 ms"
        for lobes, words in ((19, "19 → 20"), (20, "the ring bends in 20 lobes, the most there are")):
            softest = settings_of_bearing(prepare_case(case.with_(housing={"lobes": lobes})), None)
            setting = next(each for each in softest if each.name == "lobes")
            assert (setting.ways[0].words if setting.ways else setting.limit) == words


@pytest.mark.parametrize("coarser", [False, True])
def test_of_a_way_that_is_coarser_the_case_itself_is_the_finer_of_the_two(coarser, monkeypatch):
    """Levels of either are those of its own textures: the coarser case is laid on those of the finer one."""
    prepared = case_of(LINE)
    asked = []

    def levels(case, textures_of, make, progress):
        asked.append(bool(textures_of))
        return "twin" if textures_of else "changed"

    monkeypatch.setattr(converging, "_levels", levels)
    setting = replace(settings(prepared)["grid"], laid_anew=lambda small, large: small)
    finer = converging._both(prepared, "case", setting, Way("", coarser=coarser), lambda *_: None)
    assert finer == (("case", "twin") if coarser else ("changed", "twin"))
    assert asked == ([True] if coarser else [True, False])


def test_of_a_motion_at_several_places_the_powers_are_averaged_over_these():
    held = xarray.Dataset(
        {
            "band": ("band", [100.0, 200.0]),
            "force_level": (("law", "band"), [[1.0, 2.0]]),
            "velocity_level": (("law", "place", "band"), [[[0.0, 50.0], [10.0, 50.0]]]),
        }
    )
    name = next(entry.name for entry in scene.KEPT if entry.dims[0] == "law" and len(entry.dims) == 3)
    held = held.rename(velocity_level=name, force_level=spectra.FORCE_LEVEL.name)
    tree = xarray.DataTree.from_dict({spectra.FORCE_LEVEL.group: held, contact.WORKING_STIFFNESS.group: None})
    found = converging.levels_of(tree)
    np.testing.assert_allclose(found.motion.values, [[10.0 * np.log10(5.5), 50.0]])


def test_the_largest_change_is_that_of_the_bands_that_are_compared_whatever_its_sign():
    change = np.array([0.1, -3.0, 2.0, np.nan])
    assert converging._largest(change, np.array([True, True, True, True])) == (3.0, 1)
    assert converging._largest(change, np.array([True, False, True, True])) == (2.0, 2)
    assert converging._largest(change, np.array([False, False, False, True]))[1] is None


@pytest.mark.parametrize(("sizes", "told"), [
    ((1.2, 0.6, 0.4), "Above 0.5 dB is also window (0.6 dB)."),
    ((1.2, 0.6, 0.55), "Above 0.5 dB is also window (0.6 dB), modes (0.6 dB)."),
    ((1.2, 0.41, 0.2), "The others change them by up to 0.41 dB."),
    ((0.49, 0.41, 0.2), "All are fine enough for 0.5 dB."),
])  # fmt: skip
def test_what_is_told_of_the_other_settings_begins_at_half_a_decibel(sizes, told):
    names = ("grid", "window", "modes")
    assert converging._told_of_others("grid", names[1:], dict(zip(names, sizes, strict=True))) == told
