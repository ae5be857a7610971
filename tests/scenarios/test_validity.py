"""What is outside the range of its law says so: number, limit, meaning and a remedy that helps."""

import json
import re
import warnings
from pathlib import Path

import numpy as np
import pytest

from asperity.case.cases import parse_case
from asperity.cli.planning import plan, planned
from asperity.contact import HalfSpace
from asperity.contact.scan import Counts, warn_of_flaws, window_for
from asperity.errors import Grade, PhysicsWarning
from asperity.running import prepare_case, run
from asperity.scenarios.expecting import Work
from asperity.scenes.validity import SLOPE
from asperity.surfaces.levelling import band_limit
from asperity.surfaces.statistics import rms_slope, shortest_wave_for
from asperity.surfaces.synthesis import self_affine

pytestmark = pytest.mark.usefixtures("cache_of_module")

NO_WORK = Work({}, {}, 0, None, 0.0)
MAPS = Path(__file__).parents[3] / "shared" / "data" / "aa5754_um.npz"
CASE = """
kind = "ball-on-beam"
laws = {laws}
start = "0.45 m"
duration = "6 ms"
settling = "2 ms"
[surface]
{surface}
[ball]
load = "20 N"
[contact]
spacing = "{spacing} um"
window = "{window} mm"
samples = 3
sample_length = "2.2 mm"
[numerics]
highest_frequency = "4 kHz"
"""


def result(surface, laws=("areal",), spacing=10, window=0.66):
    text = CASE.format(surface=surface, laws=json.dumps(list(laws)), spacing=spacing, window=window)
    return run(parse_case(text))


def synthetic(rms, shortest=60, hurst=0.8, **keys):
    waves = f'longest = "0.4 mm"\nshortest = "{shortest} um"\nhurst = {hurst}'
    return result(f'rms = "{rms} um"\n{waves}', **keys)


def validity(tree):
    return {entry["quantity"]: entry for entry in json.loads(tree["contact"].attrs["validity"])}


def messages(tree, category="OutOfRangeWarning"):
    return [w for w in json.loads(tree.attrs["warnings"]) if w["category"] == category]


class TestInRange:
    def test_a_slightly_rough_contact_is_in_range(self):
        tree = synthetic(0.02)
        assert not messages(tree)
        found = validity(tree)
        assert all(entry["grade"] == "" for name, entry in found.items() if "cuts off" not in name)
        assert float(tree["contact"].attrs["contact_area_ratio"]) == pytest.approx(1.0, abs=0.03)
        assert tree["contact"].attrs["isolated_share"] < 0.01
        assert not tree.attrs["verdict"].startswith(("Out of range", "Doubtful"))


class TestArea:
    @pytest.mark.parametrize(("rms", "grade"), [(0.12, "warning"), (0.4, "out of range")])
    def test_a_rough_contact_is_warned_of_and_table_is_named(self, rms, grade):
        tree = synthetic(rms, laws=["areal", "table"])
        ratio = tree["contact"].attrs["contact_area_ratio"]
        assert 0.7 < ratio < 0.9 if grade == "warning" else ratio < 0.7
        (warning,) = messages(tree)
        assert warning["grade"] == grade
        assert f"{ratio:.2f}, in range from 0.9 on" in warning["message"]
        assert "Read table, which was rolled as well." in warning["message"]
        table = tree["rolling/contact_force"].sel(law="table").values.std()
        assert tree.attrs["verdict"].startswith(
            {"warning": "Doubtful", "out of range": "Out of range"}[grade]
        )
        assert f"real contact area {100 * ratio:.2g} %" in tree.attrs["verdict"]
        assert f"table varies by {table:.3g} N rms" in tree.attrs["verdict"]

    def test_without_table_it_is_the_remedy(self):
        (warning,) = messages(synthetic(0.4))
        assert "Take table." in warning["message"]

    def test_table_alone_is_not_concerned(self):
        tree = synthetic(0.4, laws=["table"])
        assert not messages(tree)
        assert "range" not in tree.attrs["verdict"]

    @pytest.mark.parametrize(
        ("rms", "shortest", "window"), [(0.02, 60, 0.66), (0.4, 60, 0.66), (1.0, 20, 0.44)]
    )
    def test_check_foresees_what_the_run_will_find_fault_with(self, rms, shortest, window):
        """Area, slope, grid and window, each of the same grade."""
        keys = f'rms = "{rms} um"\nlongest = "0.4 mm"\nshortest = "{shortest} um"\nhurst = 0.2'
        text = CASE.format(laws='["areal"]', surface=keys, spacing=10, window=window)
        prepared = prepare_case(parse_case(text))
        told = planned(prepared)
        tree = run(prepared)
        rows = {row["name"]: row["value"] for row in told["plan"]}
        area = float(re.search(r"about (\d+) %", rows["real contact"])[1])
        assert area == pytest.approx(100 * tree["contact"].attrs["contact_area_ratio"], abs=10)
        names = ("real contact area", "rms slope", "on asperities of a single cell")
        for name in names:
            foreseen = [w["grade"] for w in told["warnings"] if name in w["message"]]
            assert foreseen == [w["grade"] for w in messages(tree) if name in w["message"]]
        cut_off = "contacts that the window cuts off, the loading curve"
        foreseen = [w["grade"] for w in told["warnings"] if cut_off in w["message"]]
        found = [w["grade"] for w in messages(tree, "TruncatedContactWarning") if "loading" in w["message"]]
        assert foreseen == found

    def test_a_line_without_samples_has_no_real_contact(self):
        case = prepare_case(parse_case('kind = "ball-on-beam"\n[surface]\nspectrum = "iso3095"\n'))
        assert "real contact" not in dict(plan(case, NO_WORK))


class TestGrid:
    def test_asperities_of_a_single_cell(self):
        tree = synthetic(1.0, shortest=20, hurst=0.2)
        entry = validity(tree)["share of the load on asperities of a single cell"]
        share = tree["contact"].attrs["isolated_share"]
        assert share > 0.05
        assert entry["grade"] == ("out of range" if share > 0.25 else "warning")
        assert entry["remedy"] == (
            'A grid that would do: contact.spacing = "5 um" resolves all waves, or surface.shortest = '
            '"40 um" leaves out the waves that this one does not resolve.'
        )

    @pytest.mark.parametrize(("shortest", "spacing"), [(20, 5), (40, 10)])
    def test_both_remedies_help(self, shortest, spacing):
        tree = synthetic(1.0, shortest=shortest, hurst=0.2, spacing=spacing)
        assert tree["contact"].attrs["isolated_share"] < 0.05

    def test_the_wave_to_leave_out_leaves_the_slope_that_was_asked_for(self):
        surface = self_affine(
            (300, 300), (2e-6, 2e-6), rms=6e-6, hurst=0.7, longest=0.2e-3, shortest=4e-6, seed=1
        )
        assert rms_slope(surface) > 2 * SLOPE[0]
        limited = band_limit(surface, shortest=shortest_wave_for(surface, SLOPE[0]))
        assert rms_slope(limited) == pytest.approx(SLOPE[0], rel=0.1)
        assert shortest_wave_for(limited, 1.0) == 0.0


class TestWindow:
    def test_the_window_that_is_named_holds_the_contacts(self):
        small = synthetic(0.3, window=0.36)
        entry = validity(small)["share of contacts that the window cuts off, filters"]
        assert entry["grade"] == "out of range"
        named = float(re.search(r'contact\.window = "([\d.]+) mm" holds them', entry["remedy"])[1])
        assert 0.5 < named < 1.0
        (warning,) = [w for w in messages(small, "TruncatedContactWarning") if "loading" in w["message"]]
        assert entry["remedy"] in warning["message"]
        large = validity(synthetic(0.3, window=named))
        for name, found in large.items():
            assert "cuts off" not in name or float(found["value"].rstrip(" %")) < 1.0

    def test_only_contacts_that_are_rolled_reach_the_headline(self):
        """The highest of the given states is cut off, but the ball does not get there."""
        keys = 'rms = "0.02 um"\nlongest = "0.4 mm"\nshortest = "60 um"'
        text = CASE.format(laws='["areal"]', surface=keys, spacing=10, window=0.44)
        states = 'approaches = ["-0.1 um", "0 um", "0.3 um", "0.6 um", "1 um", "1.5 um", "4 um"]'
        quiet = run(parse_case(text.replace("samples = 3", f"samples = 3\n{states}")))
        assert validity(quiet)["share of contacts that the window cuts off, filters"]["grade"] != ""
        entry = validity(quiet)["share of the time in contacts that the window cuts off, areal"]
        assert (entry["value"], entry["grade"]) == ("0 %", "")
        assert quiet.attrs["verdict"].startswith("The ball never loses contact")
        held = float(re.search(r"Forces above ([\d.]+) N", entry["meaning"])[1])
        force = quiet["rolling/contact_force"].values
        assert force.max() < held < quiet["contact/force"].values[-1]

    def test_maps_that_are_too_small_for_it_end_the_approaches(self, tmp_path):
        surface = self_affine(
            (70, 70), (10e-6, 10e-6), rms=0.3e-6, hurst=0.8, longest=0.4e-3, shortest=60e-6, seed=2
        )
        np.savez(tmp_path / "map.npz", map=surface.heights * 1e6)
        keys = 'file = "map.npz"\narray = "map"\nheight_unit = "um"\npixel = "10 um"'
        text = CASE.format(surface=keys, laws='["areal"]', spacing=10, window=0.5)
        found = validity(run(parse_case(text, tmp_path / "case.toml")))
        remedy = found["share of contacts that the window cuts off, filters"]["remedy"]
        held = float(re.search(r"the maps are 0\.69 mm wide: .* approaches up to ([\d.]+) µm", remedy)[1])
        ended = text.replace('window = "0.5 mm"', 'window = "0.69 mm"').replace(
            "samples = 3", f'samples = 1\napproaches = ["-0.5 um", "0 um", "{held / 2} um", "{held} um"]'
        )
        after = validity(run(parse_case(ended, tmp_path / "case.toml")))
        assert after["share of contacts that the window cuts off, filters"]["grade"] in ("", "note")

    def test_window_of_smooth_bodies_is_a_tenth_wider_than_their_patch(self):
        x = 1e-5 * np.arange(-20, 21)
        body = (x[:, None] ** 2 + x**2) / (2 * 0.025)
        expected = 1.1 * 2 * np.sqrt(0.025 * 2e-6)  # a = sqrt(R δ)
        assert window_for(body, (1e-5, 1e-5), 2e-6) == pytest.approx(expected, rel=0.03)

    def test_a_scan_names_its_window(self):
        x = 1e-5 * np.arange(-10, 11)
        body = (x[:, None] ** 2 + x**2) / (2 * 0.025)
        with pytest.warns(PhysicsWarning, match=r"A window of 0\.\d+ mm holds them\.") as caught:
            HalfSpace((21, 21), 1e-5, 115e9).scan(np.zeros((25, 21)), body, [1e-6, 2e-6])
        assert caught[0].message.grade is Grade.OUT


class TestGrades:
    def told(self, solved, unconverged, truncated):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            warn_of_flaws(Counts(solved, 0, unconverged, truncated), "the path", "numerics.force_accuracy")
        return caught[0].message

    def test_few_contacts_cut_off_do_not_read_like_many(self):
        few, many = self.told(9206, 0, 29), self.told(36488, 0, 16064)
        assert (few.grade, many.grade) == (Grade.NOTE, Grade.OUT)
        assert "29 of 9206 contact solutions of the path (0.32 %)" in str(few)
        assert "too seldom to matter" in str(few)
        assert "(44 %)" in str(many)
        assert "so often that levels are wrong" in str(many)

    @pytest.mark.parametrize(
        ("share", "grade"),
        [(0.0099, Grade.NOTE), (0.01, Grade.WARNING), (0.099, Grade.WARNING), (0.1, Grade.OUT)],
    )
    def test_limits_of_a_share(self, share, grade):
        assert Grade.of_share(share) is grade

    def test_unconverged_contacts_are_graded_too(self):
        assert self.told(10_000, 5, 0).grade is Grade.NOTE
        assert self.told(10_000, 2000, 0).grade is Grade.OUT

    def test_a_plain_warning_has_the_middle_grade(self):
        assert PhysicsWarning("text").grade is Grade.WARNING

    def test_the_gravest_come_first_in_the_result(self):
        tree = synthetic(0.6, shortest=20, window=0.44)
        grades = [w["grade"] for w in json.loads(tree.attrs["warnings"])]
        order = ["out of range", "warning", "note"]
        assert grades == sorted(grades, key=order.index)
        assert grades[0] == "out of range"


@pytest.mark.skipif(not MAPS.is_file(), reason=f"measured maps of {MAPS} are missing")
def test_a_measured_map_that_areal_cannot_do_says_so():
    keys = f'file = "{MAPS}"\narray = "bb20"\nheight_unit = "um"\npixel = "1.5625 um"'
    tree = result(keys, laws=["areal", "table", "linear-filtered"], spacing=8, window=0.7)
    verdict = tree.attrs["verdict"]
    assert verdict.startswith("Out of range for areal: real contact area ")
    assert "rms slope 0.2" in verdict
    assert "of the load on single cells" in verdict
    assert "; table varies by" in verdict
    assert {w["grade"] for w in messages(tree)} == {"out of range", "warning"}
    contact = tree["contact"].attrs
    assert contact["contact_area_ratio"] < 0.1
    assert contact["rms_slope"] > SLOPE[0]
    assert contact["isolated_share"] > 0.25
    slope = validity(tree)["rms slope of the samples, Sdq"]["remedy"]
    assert re.search(r'surface\.shortest = "\d+ um" leaves a slope of 0\.2, or give contact\.hardness', slope)
