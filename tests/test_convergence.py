"""A case computed again with each setting finer: on the same surface, told in numbers, kept and resumed."""

import json
from dataclasses import replace

import numpy as np
import pytest
import xarray
from click.testing import CliRunner

import asperity
from asperity.case.cases import as_case
from asperity.cli import main
from asperity.convergence import running
from asperity.convergence.group import halves
from asperity.convergence.running import changed_case, on_the_surface_of, settings_for
from asperity.errors import InputError
from asperity.reporting.page import page
from asperity.reporting.uncertainty import changes_table, settings_table
from asperity.running import prepare_case
from asperity.scenarios.refining import Way, restricted
from asperity.scenes.report import CHAPTERS
from asperity.schema import contents_of, convergence
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.strip import LongStrip
from small_cases import COARSE

BALL = COARSE | {
    "laws": ["areal", "linear"],
    "start": "0.45 m",
    "duration": "60 ms",
    "settling": "0 s",
    "contact": COARSE["contact"] | {"samples": 2, "sample_length": "3 mm"},
}
WHEEL = {
    "kind": "wheel-on-rail",
    "laws": ["shifted", "linear"],
    "speed": "30 m/s",
    "duration": "50 ms",
    "settling": "20 ms",
    "surface": {"spectrum": "iso3095"},
    "contact": {"spacing": "1 mm", "window": "25 mm", "samples": 2, "sample_length": "0.1 m"},
    "numerics": {"highest_frequency": "1 kHz", "poles": 60},
}
SILENT = pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")


def quiet(done, total, message):
    """No progress."""


@pytest.fixture(autouse=True, scope="module")
def cache(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ASPERITY_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture(scope="module")
def ball(cache):
    return asperity.run(BALL, converge=True)


def case_of(data):
    return prepare_case(as_case(data))


def ways(prepared):
    found = settings_for(prepared, np.linspace(-1e-6, 3e-6, 5))
    return {setting.name: setting.ways for setting in found}


def change(result, setting, law=0):
    return result["convergence/force_level_change"].sel(setting=setting).values[law]


class TestOnTheSameSurface:
    """Heights of the coarser computation are those of the finer one, at its own points."""

    @pytest.mark.parametrize("data", [BALL, WHEEL])
    @pytest.mark.parametrize("setting", ["grid", "window"])
    def test_the_coarser_grid_has_points_of_the_finer(self, data, setting):
        small = case_of(data)
        large = changed_case(small, ways(small)[setting][0])
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
        same = whole.path.rows(0, whole.path.shape[0])[
            first::every, middle - reach : middle + reach + 1 : every
        ]
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
        small = case_of(BALL)
        large = changed_case(small, ways(small)["grid"][0]).textures
        x, y = (np.arange(n) for n in large.path.shape)
        long = np.cos(2 * np.pi * (x[:, None] / 8 + 0.1)) + 0 * y
        heights = long + np.cos(2 * np.pi * x[:, None] / 3)
        rough = replace(large, path=HeightMap(heights, large.path.spacing), line=heights[:, len(y) // 2])
        found = restricted(rough, 20e-6, 2, 19)
        inside = slice(20, -20)
        np.testing.assert_allclose(found.line[inside], long[large.before % 2 :: 2, 0][inside], atol=0.02)

    def test_a_long_path_is_held_or_refused(self, monkeypatch):
        small = case_of(BALL)
        large = changed_case(small, ways(small)["grid"][0]).textures
        strip = LongStrip(
            large.path.shape, large.path.spacing, lambda rows, seed: np.ones((rows, large.path.shape[1])),
            seed=1, stride=500, blend=1,
        )  # fmt: skip
        found = restricted(replace(large, path=strip), 20e-6, 2, 19)
        assert found.path.shape == (len(found.line), 19)
        monkeypatch.setattr("asperity.scenarios.refining.MOST_POINTS", 1000)
        with pytest.raises(InputError, match="at most 1000 points, to be compared on another grid"):
            restricted(replace(large, path=strip), 20e-6, 2, 19)


class TestNumbers:
    def test_each_setting_is_told(self, ball):
        group = ball["convergence"].to_dataset()
        names = ["grid", "window", "samples", "approaches", "time step", "modes", "path length"]
        assert group["setting"].values.tolist() == names
        words = dict(zip(names, group["change"].values, strict=True))
        assert words["grid"] == "40 µm → 20 µm"
        assert words["samples"] == "2 → 4"
        assert words["modes"] == "up to 8 kHz → up to 16 kHz"
        assert not any(group["limit"].values)
        assert np.isfinite(group["largest_change"].values).all()
        assert np.isfinite(group["stiffness_change"].values[:6]).all()
        assert np.isnan(group["stiffness_change"].values[6])

    def test_what_is_written_is_what_the_schema_says(self, ball):
        entries, (sentence,) = contents_of(convergence)
        found = ball["convergence"].to_dataset()
        assert set(found.variables) == {entry.name for entry in entries}
        assert set(found.attrs) == {sentence.name}
        for entry in entries:
            assert (found[entry.name].dims, found[entry.name].attrs["units"]) == (entry.dims, entry.units)

    def test_what_cannot_change_does_not(self, ball):
        """The linear law has Hertz's stiffness: samples and states mean nothing to it, modes do."""
        for setting in ("samples", "approaches"):
            np.testing.assert_array_equal(change(ball, setting, law=1), 0.0)
        stiffness = ball["convergence/stiffness_change"]
        assert float(stiffness.sel(setting="time step")) == float(stiffness.sel(setting="modes")) == 0.0
        assert np.abs(change(ball, "modes", law=1)).max() > 1e-3
        assert abs(float(stiffness.sel(setting="samples"))) > 1e-5

    def test_the_surface_is_not_drawn_anew(self, ball):
        """Finer and wider change far less than another seed does."""
        other = asperity.run(BALL | {"seed": 2})
        scatter = np.abs((other["spectra/force_level"] - ball["spectra/force_level"]).values[0]).max()
        for setting in ("grid", "window"):
            assert np.abs(change(ball, setting)).max() < 0.2 * scatter

    def test_the_changed_case_is_the_case_itself_with_that_key(self, ball):
        """Twice the modes, from Python."""
        found = asperity.run(BALL | {"beam": {"modes_up_to": "16 kHz"}})
        difference = (found["spectra/force_level"] - ball["spectra/force_level"]).values
        np.testing.assert_allclose(change(ball, "modes"), difference[0], atol=1e-9)

    def test_half_of_a_record_is_compared_with_all_of_it(self, ball):
        """The first half: here a tone is there of twice the amplitude that the second half has."""
        time = np.arange(8000) * 1e-4
        force = np.where(time < 0.4, 2.0, 1.0) * np.sin(2 * np.pi * 500.0 * time)
        held = xarray.Dataset({"contact_force": (("law", "contact", "time"), force[None, None])})
        tree = xarray.DataTree.from_dict({"/rolling": held})
        whole, half = halves(tree, 1e-4, 2e3)
        at = np.argmin(np.abs(whole.band - 500.0))
        assert half.force[0, at] == pytest.approx(10 * np.log10(2.0), abs=0.1)
        assert whole.force[0, at] == pytest.approx(10 * np.log10(1.25), abs=0.2)
        assert np.abs(change(ball, "path length", law=1)).max() > 0.1

    @SILENT
    def test_a_setting_that_is_too_coarse_is_named(self):
        """A time step of six points per period of the highest frequency."""
        coarse = BALL | {
            "laws": ["hertz", "linear"],
            "numerics": {"highest_frequency": "2 kHz", "time_step": "80 us"},
        }
        told = asperity.run(coarse, converge=True)["convergence"].attrs["verdict"]
        assert told.startswith("Of its settings, time step (80 µs → 40 µs) changes the levels of hertz most")


class TestLimits:
    @SILENT
    def test_a_map_too_small_for_a_wider_window_is_tried_with_a_narrower_one(self, monkeypatch):
        heights = 1e-8 * np.random.default_rng(0).normal(size=(130, 30))
        case = BALL | {"laws": ["hertz"], "surface": {"file": heights, "pixel": 40e-6}}
        prepared = case_of(case | {"contact": {"spacing": 40e-6, "window": 0.9e-3, "samples": 2}})
        states = np.linspace(-1e-8, 4e-6, 5)
        window = [setting for setting in settings_for(prepared, states) if setting.name == "window"]
        result = asperity.run(prepared)
        monkeypatch.setattr(running, "settings_for", lambda *_: window)
        found = running.with_convergence(prepared, result, quiet)["convergence"].to_dataset()
        assert found["change"].values.tolist() == ["900 µm → 440 µm"]
        assert 0.0 < abs(float(found["stiffness_change"].values[0])) < 0.1

    def test_a_line_has_no_samples(self):
        case = BALL | {"laws": ["hertz"], "surface": {"spectrum": "iso3095", "level": "-30 dB"}}
        result = asperity.run(case, converge=True)
        limits = dict(
            zip(
                result["convergence"]["setting"].values.tolist(),
                result["convergence"]["limit"].values.tolist(),
                strict=True,
            )
        )
        told = {name for name, limit in limits.items() if limit == "nothing is reduced from samples here"}
        assert told == {"window", "samples", "approaches"}
        assert "Not changed: window, samples, approaches." in result.attrs["verdict"]
        rows = settings_table(result).rows
        assert rows[1][1].text == "not changed: nothing is reduced from samples here"
        assert float(result["convergence/stiffness_change"].sel(setting="grid")) == 0.0

    def test_poles_are_held_to_the_kernel_that_they_stand_for(self):
        names = {setting.name: setting for setting in settings_for(case_of(WHEEL), np.zeros(2))}
        (way,) = names["poles"].ways
        assert way.words == "up to 60 → the kernel that they are fitted to"
        assert case_of(WHEEL).case.with_(**way.changes).numerics.kernel == "scatter"
        scattered = case_of(WHEEL | {"numerics": {"highest_frequency": "1 kHz", "kernel": "scatter"}})
        assert "without poles" in {s.name: s for s in settings_for(scattered, np.zeros(2))}["poles"].limit

    def test_what_fails_is_a_limit(self, monkeypatch):
        """No way of changing a setting ends the run."""
        prepared = case_of(BALL)
        result = asperity.run(prepared)
        never = [running.Setting("grid", (Way("to nothing", {"contact.spacing": 1.0}),))]
        monkeypatch.setattr(running, "settings_for", lambda *_: never)
        found = running.with_convergence(prepared, result, quiet)
        (limit,) = found["convergence"]["limit"].values
        assert limit.startswith("contact.spacing: received")
        assert found.attrs["verdict"].endswith("Not changed: grid.")


class TestKept:
    def test_an_interrupted_convergence_goes_on_where_it_was(self, monkeypatch, tmp_path):
        monkeypatch.setenv("ASPERITY_CACHE", str(tmp_path))
        prepared = case_of(BALL)
        result = asperity.run(prepared)
        seen = []

        def stopping(done, total, message):
            seen.append(message)
            if message.startswith("samples"):
                raise KeyboardInterrupt

        with pytest.raises(KeyboardInterrupt):
            running.with_convergence(prepared, result, stopping)
        again = []
        whole = running.with_convergence(prepared, result, lambda done, total, message: again.append(message))
        assert any(message.startswith("grid: ") for message in seen)
        assert not any(message.startswith(("grid: ", "window: ")) for message in again)
        assert {"convergence", "samples: pressing the samples"} <= set(again)
        last = []
        same = running.with_convergence(prepared, result, lambda done, total, message: last.append(message))
        assert set(last) == {"convergence"}
        assert same.identical(whole)

    def test_a_result_is_written_read_and_shown(self, ball, tmp_path):
        asperity.save(ball, tmp_path / "run.nc")
        assert asperity.open_result(tmp_path / "run.nc").identical(ball)
        assert ">Uncertainty</h2>" in page(ball, CHAPTERS[-1:])
        table = changes_table(ball)
        assert table.head == ["band / Hz", *ball["convergence"]["setting"].values.tolist()]
        assert len(table.rows) == ball["spectra"].sizes["band"]
        cells = [cell.text for row in table.rows for cell in row[1:]]
        assert not {"+0.00", "−0.00"} & set(cells)
        assert ball["convergence"].attrs["verdict"] in ball.attrs["verdict"]


@SILENT
def test_the_command_line_expects_it_and_does_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    case = as_case(BALL | {"laws": ["hertz"]})
    (tmp_path / "case.toml").write_text(case.to_toml())
    told = CliRunner().invoke(main, ["check", "case.toml", "--converge"])
    assert told.exit_code == 0, told.output
    plan = " ".join(told.stdout.replace("│", " ").split())
    assert "runs more, each about as long or a few times that: grid" in plan
    for setting in ("window", "samples", "approaches", "time step", "modes"):
        assert setting in plan.split("times that: grid")[1]
    done = CliRunner().invoke(main, ["run", "case.toml", "--converge", "-o", "out", "--no-report"])
    assert done.exit_code == 0, done.output
    assert "Of its settings" in done.stdout
    result = asperity.open_result("out")
    assert json.loads(result["scenario"].attrs["laws"])[0]["name"] == "hertz"
    assert "convergence" in result.children
    again = CliRunner().invoke(main, ["run", "case.toml", "--converge", "-o", "out", "--no-report"])
    assert "Nothing to do" in again.stderr
