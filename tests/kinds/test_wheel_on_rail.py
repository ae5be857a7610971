"""The whole chain of a wheel on a rail on small cases: result, textures, geometry, defects."""

import json
import tracemalloc

import numpy as np
import pytest

import asperity
from asperity.case.cases import parse_case
from asperity.contact import Hertz
from asperity.errors import InputError, OutOfRangeWarning
from asperity.reference.cnossos import rail_roughness
from asperity.running import prepare_case, run
from asperity.scenarios.geometry import geometry_of
from asperity.scenarios.textures import textures_of
from asperity.surfaces.bands import band_levels_of
from asperity.surfaces.heightmap import Profile

pytestmark = pytest.mark.usefixtures("cache_of_module")

CASE = """
kind = "wheel-on-rail"
laws = {laws}
duration = "40 ms"
settling = "20 ms"
[surface]
{surface}
[wheel]
{wheel}
[track]
{track}
[contact]
spacing = "{spacing}"
window = "20 mm"
samples = 2
sample_length = "60 mm"
[numerics]
highest_frequency = "4 kHz"
poles = 60
"""
ALL = ["areal", "shifted", "printed", "table", "hertz", "linear", "hertz-filtered", "linear-filtered"]


def case(
    surface='spectrum = "iso3095"',
    wheel='roughness = "disc"',
    track="",
    laws=ALL,
    source="case.toml",
    spacing="1 mm",
):
    values = {"surface": surface, "wheel": wheel, "track": track, "spacing": spacing}
    text = CASE.format(laws=json.dumps(laws), **values)
    return parse_case(text, source)


@pytest.fixture(scope="module")
def tree():
    return run(case())


class TestResult:
    def test_statistics_and_line_are_those_of_the_whole_path(self, monkeypatch):
        """A flat 2 m along the path, beyond what is kept to be looked at from above."""
        monkeypatch.setattr("asperity.scenes.groups.PATH_ROWS", 100)
        found = run(case(wheel='flat_depth = "0.3 mm"\nflat_position = "1 m"', laws=["linear"]))["surface"]
        assert found["path_heights"].shape[0] == 100
        assert found["line"].size == round(56 * 40e-3 / 1e-3) + 1
        statistics = {s["symbol"]: s for s in json.loads(found.attrs["statistics"]) if s["surface"] == "path"}
        assert statistics["Sz"]["value"] > 0.29e-3
        assert statistics["Sku"]["value"] > 20.0
        assert statistics["Sq"]["bandwidth"].endswith("2.24 m")
        assert float(found["path_height"].min()) < -0.27e-3  # about the mean
        assert float(found["line"].min()) < -0.25e-3  # with the texture there
        width = float(found["path_height"][1] - found["path_height"][0])
        assert float(found["path_height_density"].sum()) * width == pytest.approx(1.0)

    def test_lines_side_by_side_have_statistics_of_lines(self, tmp_path):
        """Interpolated between lines 5 mm apart, a strip has no correlation length of its own."""
        rng, turn = np.random.default_rng(0), round(2 * np.pi * 460)
        np.save(tmp_path / "lines.npy", rng.normal(0.0, 10.0, (3, turn)))
        wheel = 'line = "lines.npy"\nline_unit = "um"\nline_spacing = "1 mm"\nline_distance = "5 mm"'
        found = run(case(wheel=wheel, laws=["linear"], source=tmp_path / "case.toml"))["surface"]
        statistics = json.loads(found.attrs["statistics"])
        assert {s["surface"] for s in statistics} == {"middle line of the path", "3 lines of the wheel, mean"}
        assert all(s["symbol"].startswith("R") for s in statistics)
        mean = next(s for s in statistics if s["symbol"] == "Rq" and "mean" in s["surface"])
        assert mean["value"] == pytest.approx(10e-6, rel=0.05)
        assert found.attrs["across"] == "lines"

    def test_what_is_the_same_all_across_has_statistics_of_lines(self):
        for surface in (
            'spectrum = "iso3095"\nlateral = "inf"',
            'corrugation = "20 um"\ncorrugation_wavelength = "50 mm"',
        ):
            found = run(case(surface=surface, wheel="", laws=["linear"]))["surface"]
            assert all(s["symbol"].startswith("R") for s in json.loads(found.attrs["statistics"]))


class TestTextures:
    def test_wheel_repeats_with_its_circumference_from_the_start(self):
        small = case(surface="smooth = true")
        found = textures_of(small)
        turn = round(2 * np.pi * 0.46 / 1e-3)
        wheel = found.parts["wheel"]
        assert len(wheel) > turn
        np.testing.assert_array_equal(wheel[turn:], wheel[:-turn])
        assert found.start + found.before * 1e-3 == pytest.approx(small.start)
        assert not found.parts["rail"].any()

    def test_rail_and_wheel_add_up(self):
        found = textures_of(case())
        np.testing.assert_allclose(found.line, found.parts["rail"] + found.parts["wheel"], atol=1e-12)
        np.testing.assert_array_equal(
            found.line, found.path.rows(0, found.path.shape[0])[:, found.path.shape[1] // 2]
        )

    def test_levels_of_the_rail_are_those_of_its_spectrum(self):
        long = case(wheel="").with_(duration="0.8 s")
        rail = textures_of(long).parts["rail"]
        wavelength, level = band_levels_of(Profile(rail, 1e-3), shortest=4e-3, longest=0.1)
        given, wanted = rail_roughness("iso3095")
        expected = np.interp(-np.log(wavelength), -np.log(given), wanted)
        np.testing.assert_allclose(level, expected, atol=1.5)  # one line of a strip scatters

    def test_samples_are_flat_where_nothing_is_rough(self):
        found = textures_of(case(surface="smooth = true", wheel='flat_depth = "0.2 mm"'))
        assert len(found.maps) == 1
        assert not np.ptp(found.maps[0].heights)

    def test_path_shorter_than_the_strips_is_refused(self):
        long = case(surface="smooth = true").with_(contact={"sample_length": "9 m"})
        with pytest.raises(InputError, match=r"duration: received 0\.04 s, a path of"):
            textures_of(long)

    def test_a_long_rail_is_never_held_as_a_whole(self):
        """Less than the strip itself would take, 21 numbers a row: lines and positions along it are."""
        rows, peaks = [], []
        for duration in (0.5, 3.0):
            made = case().with_(duration=duration)
            textures_of(made)
            tracemalloc.start()
            rows.append(textures_of(made).path.shape[0])
            peaks.append(tracemalloc.get_traced_memory()[1])
            tracemalloc.stop()
        assert peaks[1] - peaks[0] < 21 * 8 * (rows[1] - rows[0])


class TestDefects:
    def test_flat_lies_where_it_is_said_and_returns_each_turn(self):
        found = textures_of(
            case(surface="smooth = true", wheel='flat_depth = "0.3 mm"\nflat_position = "1 m"')
        )
        at = found.start + 1e-3 * np.arange(len(found.line))
        assert found.trajectory.min() == pytest.approx(-0.3e-3, rel=1e-2)
        assert at[np.argmin(found.trajectory)] == pytest.approx(1.0, abs=2e-3)
        assert not found.line.any()

    def test_worn_flat_is_as_long_as_it_is_said(self):
        wheel = 'flat_depth = "0.3 mm"\nflat_length = "80 mm"\nflat_shape = "worn"\nflat_position = "1 m"'
        found = textures_of(case(surface="smooth = true", wheel=wheel))
        at = found.start + 1e-3 * np.arange(len(found.line))
        struck = at[(found.defects < 0) & (np.abs(at - 1.0) < 0.2)]
        assert np.ptp(struck) == pytest.approx(80e-3, abs=3e-3)

    def test_corrugation_is_texture_and_no_defect(self):
        found = textures_of(case(surface='corrugation = "20 um"\ncorrugation_wavelength = "50 mm"', wheel=""))
        assert found.defects is None
        assert np.ptp(found.line) == pytest.approx(40e-6, rel=1e-2)
        assert not np.ptp(found.strips[0].heights)

    def test_wheel_does_not_fall_as_deep_into_a_joint_as_it_dips(self):
        found = textures_of(case(surface='joint_depth = "2 mm"\njoint_position = "1 m"', wheel=""))
        assert np.all(found.trajectory >= found.defects - 1e-12)
        assert found.defects.min() < found.trajectory.min() < 0.0

    def test_flat_strikes_every_law(self):
        laws = ["areal", "shifted", "linear"]
        quiet = run(case(surface="smooth = true", wheel="", laws=laws))["rolling/contact_force"][:, 0].std(
            "time"
        )
        wheel = 'flat_depth = "0.3 mm"\nflat_position = "1 m"'
        struck = run(case(surface="smooth = true", wheel=wheel, laws=laws))
        force = struck["rolling/contact_force"].sel(contact=1)
        assert np.all(force.std("time") > 5 * quiet)
        assert np.all(force.max("time") > 1.5 * 65e3)
        hit = struck["rolling/position"][int(force.sel(law="areal").argmax("time"))]
        assert float(hit) == pytest.approx(1.0, abs=0.15)

    @pytest.mark.parametrize(
        "defect", [{"wheel": {"flat_depth": "0.3 mm"}}, {"surface": {"joint_depth": "1 mm"}}]
    )
    def test_defects_are_rolled_over_by_a_law_that_sees_them_unless_another_is_named(self, defect):
        given = {"kind": "wheel-on-rail", "surface": {"smooth": True}}
        assert asperity.WheelOnRail(surface={"smooth": True}).laws[0] == "areal"
        struck = asperity.WheelOnRail(**(given | defect))
        assert struck.laws[0] == struck.default_of("laws")[0] == "direct"
        assert asperity.WheelOnRail(**(given | defect | {"laws": ["areal"]})).laws == ("areal",)

    @pytest.mark.parametrize("duration", ["40 ms", "1 s"])
    def test_first_impact_of_a_flat_lies_in_the_record(self, duration):
        struck = asperity.WheelOnRail(
            duration=duration, surface={"smooth": True}, wheel={"flat_depth": "0.3 mm"}, laws=["linear"]
        )
        found = textures_of(struck)
        touched = np.flatnonzero(found.defects[found.recorded])
        assert touched[0] * struck.contact.spacing > 0.5
        assert (found.recorded.stop - found.recorded.start - touched[-1]) * struck.contact.spacing > 0.1

    def test_a_law_that_does_not_see_a_flat_says_so(self):
        struck = case(surface="smooth = true", wheel='flat_depth = "0.1 mm"', laws=["linear", "hertz"])
        told = [str(w.message) for w in prepare_case(struck).caught if w.category is OutOfRangeWarning]
        assert [message.partition(" over")[0] for message in told] == [
            "linear follows the path of the wheel's centre"
        ]

    def test_table_in_a_window_shorter_than_the_flat_warns(self):
        wheel = 'flat_depth = "0.3 mm"'
        found = run(case(surface="smooth = true", wheel=wheel, laws=["table"]))
        messages = [w["message"] for w in json.loads(found.attrs["warnings"])]
        assert any("the flat is 33.2 mm long" in m for m in messages)


def fine(**keys):
    return case(spacing="0.4 mm", **keys)


class TestGeometry:
    def test_radii_make_hertz(self):
        shape = geometry_of(fine(wheel='transverse_radius = "0.5 m"'))
        assert shape.hertz.radius_x == 0.46
        assert shape.hertz.radius_y == pytest.approx(1 / (1 / 0.3 + 1 / 0.5))
        assert shape.largest_force < 8 * 65e3  # what the window holds

    def test_measured_section_of_a_circle_is_its_radius(self, tmp_path):
        y = np.linspace(-30e-3, 30e-3, 121)
        rows = "\n".join(f"{a * 1e3:.4f}\t{-(a**2) / 0.6 * 1e6:.6f}" for a in y)
        (tmp_path / "head.txt").write_text("y [mm]\tz [um]\n" + rows + "\n")
        measured = fine(track='rail_profile = "head.txt"', source=tmp_path / "case.toml")
        shape, round_head = geometry_of(measured), geometry_of(fine())
        assert shape.hertz.radius_y == pytest.approx(0.3, rel=1e-3)
        np.testing.assert_allclose(shape.body, round_head.body, atol=1e-9)

    def test_section_narrower_than_the_window_is_refused(self, tmp_path):
        rows = "\n".join(f"{a:.4f}\t{-(a**2):.6f}" for a in np.linspace(-5, 5, 41))
        (tmp_path / "head.txt").write_text("y [mm]\tz [um]\n" + rows + "\n")
        with pytest.raises(InputError, match=r"track\.rail_profile: received a section 10 mm wide"):
            geometry_of(fine(track='rail_profile = "head.txt"', source=tmp_path / "case.toml"))

    def test_bodies_that_fit_each_other_are_refused(self, tmp_path):
        rows = "\n".join(f"{a:.4f}\t{a**2 * 10:.6f}" for a in np.linspace(-30, 30, 121))
        (tmp_path / "tread.txt").write_text("y [mm]\tz [um]\n" + rows + "\n")
        with pytest.raises(InputError, match="bodies that"):
            geometry_of(fine(wheel='profile = "tread.txt"', source=tmp_path / "case.toml"))

    def test_wheel_and_rail_under_their_load(self):
        shape = geometry_of(fine())
        expected = Hertz(shape.modulus, 0.46, 0.3)
        assert expected.stiffness_constant == pytest.approx(9.413e10, rel=1e-3)
        assert shape.semi_axes == pytest.approx((6.20e-3, 4.67e-3), rel=1e-3)


def test_a_record_that_holds_the_start_is_marked(tree):
    """The run-in of these cases is 20 ms."""
    messages = [w["message"] for w in json.loads(tree.attrs["warnings"])]
    assert any("the record starts 20 ms after rest, less than 50 ms" in message for message in messages)
