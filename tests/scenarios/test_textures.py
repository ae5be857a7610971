"""Textures of a case: what is measured or synthesised becomes samples and path, and defects lie on it."""

import json
import re
import tracemalloc

import numpy as np
import pytest

import asperity
from asperity import HeightMap, Profile
from asperity.errors import InputError, MissingPointsWarning, OutOfRangeWarning, TruncatedContactWarning
from asperity.reference.cnossos import rail_roughness
from asperity.reporting.data import unless_missing
from asperity.reporting.tables import homogeneity_table
from asperity.running import prepare_case
from asperity.surfaces.bands import band_levels_of
from asperity.surfaces.synthesis import self_affine
from small_cases import COARSE, changed

UM = 1e-6
SIDE = (20 * UM, 20 * UM)


def prepared(kind="ball-on-beam", **keys):
    return prepare_case(changed(kind, **keys))


def textures(kind="ball-on-beam", **keys):
    return prepared(kind, **keys).textures


def whole(strip):
    return strip.rows(0, strip.shape[0])


def rough(shape, seed=2):
    return self_affine(shape, SIDE, rms=0.05 * UM, hurst=0.8, longest=0.4e-3, shortest=80 * UM, seed=seed)


# --- measured maps


def test_an_ensemble_of_a_file_is_the_samples_and_the_path_is_like_them(tmp_path):
    heights = np.array([rough((80, 80), seed).heights / UM for seed in (1, 2)])
    heights[0, 3, 4] = np.nan
    np.savez(tmp_path / "maps.npz", patch=heights)
    surface = {"file": tmp_path / "maps.npz", "array": "patch", "height_unit": "um", "pixel": "20 um"}
    with pytest.raises(InputError, match="Set fill = true"):
        textures(surface=surface)
    surface["fill"] = True
    case = prepared(surface=surface)
    assert MissingPointsWarning in {warning.category for warning in case.caught}
    found = case.textures
    assert "2 samples measured, maps.npz" in found.origin
    assert "path synthesised in their likeness" in found.origin
    assert [each.shape for each in found.maps] == [(80, 80)] * 2
    limited = textures(surface=surface | {"longest": "0.2 mm"})
    assert limited.maps[0].heights.std() < 0.7 * found.maps[0].heights.std()


@pytest.mark.parametrize("settling", ["0 s", "10 ms"])
def test_a_long_map_is_the_path_itself_and_mirrored_for_the_run_in(settling):
    found = textures(surface={"file": rough((1100, 40))}, settling=settling)
    path = whole(found.path)
    lead = max(len(path) - 1100, 0)
    assert (lead > 400) == (settling != "0 s")
    np.testing.assert_array_equal(path[:lead], path[2 * lead : lead : -1])
    assert "path cut from the first" + ", its mirror image for the run-in" * bool(lead) in found.origin


MAP = rough((200, 90))
LINE = Profile(MAP.heights[:, 3] - MAP.heights[:, 3].mean(), SIDE[0])


@pytest.mark.parametrize("how", ["repeat", "mirror"])
def test_a_measured_map_goes_on_where_it_is_shorter_than_the_path(how):
    found = textures(surface={"file": MAP, "continuation": how}, settling="50 ms")
    heights, window = whole(found.path), found.path.shape[1]
    assert f"{how}ed" in found.origin
    first = found.before - window  # a window before the record
    if how == "mirror":
        np.testing.assert_array_equal(heights[first : first + 200], heights[first : first + 399][:198:-1])
        return
    np.testing.assert_array_equal(heights[200:], heights[:-200])
    inside, middle = heights[first + window : first + 200 - window], (90 - window) // 2  # but where it closes
    expected = found.maps[0].heights[window : 200 - window, middle : middle + window]
    np.testing.assert_allclose(inside - inside.mean(), expected - expected.mean(), atol=1e-12)
    step, whole_step = (np.abs(np.diff(each, axis=0)).max() for each in (heights, MAP.heights))
    assert step < 1.5 * whole_step  # the ends meet


def test_a_map_is_rolled_over_in_the_direction_asked_for():
    """Grooves across the x axis: in between with longer waves."""
    x = np.arange(240) * 10 * UM
    noise = np.random.default_rng(0).normal(size=(240, 200))
    grooves = HeightMap(UM * (0.04 * np.cos(2 * np.pi * x / 200e-6)[:, None] + 1e-4 * noise), 10 * UM)
    bare, along, slanted = (
        textures(surface={"file": grooves, "direction": f"{angle} deg"}) for angle in (0, 90, 60)
    )
    np.testing.assert_allclose(np.rot90(along.maps[0].heights), bare.maps[0].heights, atol=1e-15)
    spectrum = np.abs(np.fft.rfft(slanted.maps[0].heights[:, 20], 4096))
    longest = 4096 * 20e-6 / np.argmax(spectrum)
    assert longest == pytest.approx(200e-6 / np.cos(np.radians(60)), rel=0.03)
    assert slanted.maps[0].size == pytest.approx((1.15e-3, 1.99e-3), abs=20e-6)  # 2.4 mm × 2 mm, turned
    assert "rolled over at 60° to their x axis" in slanted.origin


def test_measured_maps_are_tested_for_being_the_same_everywhere(real_runs):
    texture = 0.02 * UM * np.random.default_rng(5).normal(size=(5, 72, 72))
    told = {}
    for name, factor in (("even", 1.0), ("trend", np.linspace(0.3, 1.7, 72)[:, None])):
        maps = tuple(HeightMap(each, SIDE) for each in texture * factor)
        tree = asperity.run(changed("ball-on-beam", laws=["linear"], surface={"file": maps}))
        warned = [w["message"] for w in json.loads(tree.attrs["warnings"]) if "Inhomog" in w["category"]]
        told[name] = (tree["surface"], " ".join(warned), [r[-1].text for r in homogeneity_table(tree).rows])
    surface, warned, rows = told["even"]
    assert surface["homogeneity_p"].sizes == {"sample": 5}
    assert (warned, rows[0]) == ("", "as far as chance tells")
    surface, warned, rows = told["trend"]
    np.testing.assert_allclose(surface["homogeneity_p"], 1 / 40)
    assert "5 of 5 measured maps are not the same everywhere (p ≤ 0.05)" in warned
    assert rows == ["no"] * 5
    assert {"Str", "Std"} <= {s["symbol"] for s in json.loads(surface.attrs["statistics"])}
    assert unless_missing(homogeneity_table, real_runs["ball-on-beam"]) is None  # of what is synthesised


# --- measured lines


def test_before_a_measured_line_lies_its_mirror_image():
    line = Profile(1e-8 * np.random.default_rng(0).normal(size=2000), SIDE[0])
    keys = {"surface": {"line": line}, "laws": ["hertz"], "settling": "50 ms", "duration": "15 ms"}
    found = textures(**keys, start="0.45 m")
    lead, rows = found.before - 33, len(found.line)
    assert (lead, rows) == (pytest.approx(2500, abs=1), pytest.approx(lead + 750 + 1 + 66, abs=1))
    at = rows - 2000
    np.testing.assert_array_equal(found.line[at - 40 : at], found.line[at + 40 : at : -1])
    # a window beyond the contact is looked at: where the first point of the file lies, and is said to lie
    assert found.start + lead * SIDE[0] == pytest.approx(0.45 - 33 * SIDE[0])
    assert "from 0.66 mm before the record on, its mirror image for the run-in" in found.origin


# --- band levels

WAVELENGTHS = 10.0 ** (-np.arange(26, 41) / 10.0)  # 2.5 mm to 0.1 mm
LEVELS = np.stack([WAVELENGTHS, -20.0 + 8.0 * np.log10(WAVELENGTHS / 1e-3)], axis=1)


def by_levels(lateral, **keys):
    surface = {"spectrum": LEVELS, "lateral": lateral, **keys}
    return prepare_case(
        asperity.BallOnBeam(**COARSE | {"surface": surface, "start": "0.2 m", "duration": "0.4 s"})
    ).textures


def test_path_and_samples_have_the_levels():
    """As far as a record of its length tells them: standard deviation 4.34 dB / √(bandwidth · length)."""
    found = by_levels(1.0, level="+6 dB")
    path, dx = whole(found.path), found.maps[0].spacing
    for heights in (path, found.maps[0].heights):
        wavelength, level = band_levels_of(HeightMap(heights, dx))
        given = (wavelength > 0.9e-4) & (wavelength < 1.1 * WAVELENGTHS[0])
        wavelength, level = wavelength[given], level[given]
        asked = np.interp(np.log(wavelength), np.log(WAVELENGTHS[::-1]), LEVELS[::-1, 1] + 6.0)
        scatter = 4.34 / np.sqrt(0.23 / wavelength * heights.shape[0] * dx[0])
        assert (np.abs(level - asked) < 3.0 * scatter).all()
        assert np.mean(np.abs(level - asked)) < 1.2 * np.mean(scatter)
    assert found.areal
    np.testing.assert_array_equal(found.line, path[:, path.shape[1] // 2])


def test_a_lateral_correlation_above_one_draws_the_texture_out_across_the_path():
    heights = [by_levels(lateral).maps[0].heights for lateral in (0.25, 1.0, 4.0)]
    slopes = [np.std(np.diff(each, axis=0)) / np.std(np.diff(each, axis=1)) for each in heights]
    assert slopes[0] < 0.7
    assert slopes[1] == pytest.approx(1.0, abs=0.15)
    assert slopes[2] > 2.0


def test_a_spectrum_is_a_line_without_lateral_and_a_surface_with_it():
    line, surface = (asperity.BallOnBeam(surface={"spectrum": LEVELS} | k) for k in ({}, {"lateral": 1.0}))
    assert (line.surface.has_line, line.surface.has_samples) == (True, False)
    assert "areal" not in line.laws
    assert surface.laws == asperity.BallOnBeam(surface={"rms": "1 um"}).laws
    by_level = ({"spectrum": LEVELS, "level": f"{level} dB"} for level in (0, 20))
    low, high = (textures(surface=each, laws=["hertz"]) for each in by_level)
    np.testing.assert_allclose(high.line, 10.0 * low.line, rtol=1e-9)


def test_a_table_as_spectrum_is_the_named_one(tmp_path):
    pairs = zip(*(values.tolist() for values in rail_roughness("iso3095")), strict=True)
    rows = "\n".join(f"{100 * wavelength!r}; {level!r}" for wavelength, level in pairs)
    (tmp_path / "limit.csv").write_text(f"wavelength (cm); level (dB re 1 um)\n{rows}\n")
    named, table = (
        textures("wheel-on-rail", surface={"spectrum": each}) for each in ("iso3095", tmp_path / "limit.csv")
    )
    assert "limit" in table.origin
    np.testing.assert_allclose(table.line, named.line, rtol=1e-9, atol=1e-15)


# --- what turns, and what lies on the path


def test_rail_and_wheel_add_up_and_the_wheel_repeats_with_its_circumference():
    found = textures("wheel-on-rail")
    np.testing.assert_allclose(found.line, found.parts["rail"] + found.parts["wheel"], atol=1e-12)
    np.testing.assert_array_equal(found.line, whole(found.path)[:, found.path.shape[1] // 2])
    case = changed("wheel-on-rail", surface={"smooth": True})
    found = prepare_case(case).textures
    turn, wheel = round(2 * np.pi * 0.46 / 1e-3), found.parts["wheel"]
    assert len(wheel) > turn
    np.testing.assert_array_equal(wheel[turn:], wheel[:-turn])
    assert found.start + found.before * 1e-3 == pytest.approx(case.start)
    assert not found.parts["rail"].any()
    bump = Profile(1e-6 * np.exp(-(((np.arange(turn) - 500) / 20.0) ** 2)), 1e-3)
    found = textures("wheel-on-rail", wheel={"roughness": None, "line": bump}, surface={"smooth": True})
    first = np.argmax(found.parts["wheel"][found.before :])  # its first point first
    assert first == pytest.approx(500, abs=1)


def test_a_long_rail_is_never_held_as_a_whole():
    """Less than the strip itself would take, 21 numbers a row: lines and positions along it are."""
    rows, peaks = [], []
    for duration in (0.5, 3.0):
        textures("wheel-on-rail", duration=duration)
        tracemalloc.start()
        rows.append(textures("wheel-on-rail", duration=duration).path.shape[0])
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] - peaks[0] < 21 * 8 * (rows[1] - rows[0])


def struck(**keys):
    """Textures of a smooth wheel and rail with a defect, and the positions along them."""
    keys = {"surface": {"smooth": True}, "wheel": {"roughness": None}} | keys
    found = textures("wheel-on-rail", laws=["linear"], contact={"window": "20 mm"}, **keys)
    return found, found.rows_along(1e-3)


def test_flats_lie_where_they_are_said_and_are_as_long():
    flat = {"roughness": None, "flat_depth": "0.3 mm", "flat_position": "1 m"}
    found, at = struck(wheel=flat)
    assert found.trajectory.min() == pytest.approx(-0.3e-3, rel=1e-2)
    assert at[np.argmin(found.trajectory)] == pytest.approx(1.0, abs=2e-3)
    assert not found.line.any()
    assert len(found.maps) == 1
    assert not np.ptp(found.maps[0].heights)  # samples have none of it
    found, at = struck(wheel=flat | {"flat_length": "80 mm", "flat_shape": "worn"})
    within = (found.defects.heights(at) < 0) & (np.abs(at - 1.0) < 0.2)
    assert np.ptp(at[within]) == pytest.approx(80e-3, abs=3e-3)


@pytest.mark.parametrize("duration", ["40 ms", "1 s"])
def test_first_impact_of_a_flat_lies_in_the_record(duration):
    found, at = struck(wheel={"roughness": None, "flat_depth": "0.3 mm"}, duration=duration)
    touched = np.flatnonzero(found.defects.heights(at[found.recorded]))
    assert 500 < touched[0] < touched[-1] < found.recorded.stop - found.recorded.start - 100


def test_corrugation_is_texture_and_a_joint_is_a_defect_into_which_the_wheel_falls_less_deep():
    found, _ = struck(surface={"corrugation": "20 um", "corrugation_wavelength": "50 mm"})
    assert found.defects is None
    assert np.ptp(found.line) == pytest.approx(40e-6, rel=1e-2)
    assert not np.ptp(found.strips[0].heights)
    assert "corrugation" not in found.origin
    band = {"corrugation": "20 um", "corrugation_wavelength": "50 mm", "corrugation_bandwidth": 0.3}
    found, _ = struck(surface=band)
    rms = 1e6 * np.std(found.line[found.recorded])
    told = re.search(r"corrugation: (\S+) µm rms over this record, 14\.1 µm in the long run", found.origin)
    assert float(told[1]) == pytest.approx(rms, rel=5e-3)
    assert found.drawn["corrugation"].startswith("0.05 m, 0.3 octaves, seed ")
    found, at = struck(surface={"joint_depth": "2 mm", "joint_position": "1 m"})
    heights = found.defects.heights(at)
    assert np.all(found.trajectory >= heights - 1e-12)
    assert heights.min() < found.trajectory.min() < 0.0


@pytest.mark.parametrize(
    "defect", [{"wheel": {"flat_depth": "0.3 mm"}}, {"surface": {"joint_depth": "1 mm"}}]
)
def test_defects_are_rolled_over_by_a_law_that_sees_them_unless_another_is_named(defect):
    given = {"kind": "wheel-on-rail", "surface": {"smooth": True}} | defect
    assert asperity.WheelOnRail(surface={"smooth": True}).laws[0] == "areal"
    struck = asperity.WheelOnRail(**given)
    assert struck.laws[0] == struck.default_of("laws")[0] == "direct"
    assert asperity.WheelOnRail(**given | {"laws": ["areal"]}).laws == ("areal",)


@pytest.mark.parametrize(
    ("laws", "depth", "message"),
    [
        (["linear", "hertz"], "0.1 mm", "linear follows the path of the wheel's centre"),
        (["table"], "0.3 mm", "the flat is 33.2 mm long"),
    ],
)
def test_what_does_not_see_a_flat_is_warned_of(laws, depth, message):
    keys = {"laws": laws, "wheel": {"roughness": None, "flat_depth": depth}, "contact": {"window": "20 mm"}}
    found = prepared("wheel-on-rail", surface={"smooth": True}, **keys)
    doubts = (OutOfRangeWarning, TruncatedContactWarning)
    told = [str(warning.message) for warning in found.caught if issubclass(warning.category, doubts)]
    assert [message in each for each in told] == [True]


ROOM = "So that there is time for settling, shorten the duration or start farther along."


@pytest.mark.parametrize(
    ("kind", "settling", "told"),
    [
        ("wheel-on-rail", "20 ms", "20 ms after rest, less than 50 ms: its levels hold the start. Take a "
         "settling of 50 ms or more."),
        ("ball-on-beam", "20 ms", "20 ms after rest, less than 50 ms: its levels hold the start. Take a "
         "settling of 50 ms or more, with room for it."),
        ("ball-on-beam", None, f"less than 50 ms: its levels hold the start. {ROOM}"),
        ("ball-on-beam", "50 ms", None),
    ],
)  # fmt: skip
def test_a_record_that_holds_the_start_is_marked(kind, settling, told):
    """With what is to be done: a longer settling of one that is given, else room for it."""
    own = {"settling": settling} | ({} if settling else {"start": "20 mm"})
    said = [str(each.message) for each in prepared(kind, **own).caught]
    held = [each for each in said if "its levels hold the start" in each]
    assert [each.endswith(told) for each in held] == ([True] if told else [])


# --- what is said of textures that cannot be

METRES = HeightMap(MAP.heights * 1e6, SIDE)
SLOPE, UNIT = "received heights with an rms slope of ", "Are the heights in µm? Then set"
REFUSED = [
    ({"file": rough((24, 24))}, "contact.window: received 660 um; allowed: at most the measured map, 480 um"),
    (
        {"file": HeightMap(MAP.heights[:, :30], SIDE), "continuation": "mirror"},
        "surface.continuation: received 0.6 mm across; allowed: a map as wide as",
    ),
    ({"file": METRES}, f'surface.file: {SLOPE}*{UNIT} height_unit = "um"'),
    (
        {"file": HeightMap(MAP.heights, 8e-3)},
        "surface.file: received maps of 1600 mm × 720 mm, 2.9·10⁹ points at*Is the pixel in µm, not mm?",
    ),
    ({"rms": "0.5 mm"}, 'Is rms in µm? Then write it so: rms = "0.5 um".'),
    (
        {"rms": "60 um", "longest": "1 mm", "shortest": "0.5 mm"},
        "um rms within the window; allowed: up to 100 approaches of the bodies, ",
    ),
    (
        {"line": LINE},
        "surface.line: received 0.004 m; allowed: at least*a longer line, or surface.continuation",
    ),
    (
        {"line": Profile(np.tile(LINE.heights, 20) * 1e6, 4e-5)},
        f'surface.line: {SLOPE}*{UNIT} line_unit = "um"',
    ),
    (
        {"line": Profile(np.tile(LINE.heights, 20), SIDE[0]), "line_distance": "0.1 mm"},
        "duration: received 0.02 s, a path of *strips from which filters are estimated",
    ),
]


@pytest.mark.parametrize(("surface", "message"), REFUSED)
def test_what_cannot_be_is_refused(surface, message):
    keys = (
        {"contact": {"sample_length": "30 mm"}} if "line_distance" in surface else {"ball": {"load": "5 N"}}
    )
    with pytest.raises(InputError) as caught:
        prepared(surface=surface, laws=["hertz" if "line" in surface else "areal"], **keys)
    assert all(part in str(caught.value) for part in message.split("*"))
