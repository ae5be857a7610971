"""Wrong types and values at the doors of Python: always a message that names what was received."""

import re
import warnings

import numpy as np
import pytest
import xarray as xr

import asperity
from asperity import HalfSpace, HeightMap, Profile, Track, read_surface, study
from asperity.arguments import finite_array, one_of, real, real_array, shown, two_lengths, whole
from asperity.errors import InputError
from asperity.structures.moving_kernel import moving_kernel

MICROMETRE = (1e-6, 1e-6)
MAP = HeightMap(np.random.default_rng(0).normal(size=(20, 8)) * 1e-8, MICROMETRE)
X = (np.arange(8) - 4) * 1e-6
BALL = np.add.outer(X**2, X**2) / 2e-4
HALF_SPACE = HalfSpace((8, 8), MICROMETRE, 1e11)
TRACK = Track.named("x2000")

NO_NUMBERS = ["1 um", b"x", [], {}, Ellipsis, 1 + 2j, np.array(["x"]), len, float("nan"), True, (1, 2, 3)]
"""Values that stand for no single number and for no pair of them."""


def scanned(**changes):
    arguments = {"surface": MAP.heights, "body": BALL, "approaches": [1e-8]}
    return HALF_SPACE.scan(**(arguments | changes))


DOORS = {
    "half-space shape": lambda v: HalfSpace(v, MICROMETRE, 1e11),
    "half-space spacing": lambda v: HalfSpace((8, 8), v, 1e11),
    "contact modulus": lambda v: HalfSpace((8, 8), MICROMETRE, v),
    "hardness": lambda v: HalfSpace((8, 8), MICROMETRE, 1e11, v),
    "load": lambda v: HALF_SPACE.solve(BALL, load=v),
    "approach": lambda v: HALF_SPACE.solve(BALL, approach=v),
    "rtol of a contact": lambda v: HALF_SPACE.solve(BALL, load=1e-3, rtol=v),
    "stride of the scan": lambda v: scanned(stride=v),
    "rtol of a scan": lambda v: scanned(rtol=v),
    "force_accuracy": lambda v: scanned(force_accuracy=v),
    "workers": lambda v: scanned(workers=v),
    "spacing of the height map": lambda v: HeightMap(MAP.heights, v),
    "spacing of the profile": lambda v: Profile(MAP.heights[0], v),
    "index of a line": lambda v: MAP.line(v),
    "start of a piece": lambda v: MAP.crop(v, (4e-6, 4e-6)),
    "size of a piece": lambda v: MAP.crop((0.0, 0.0), v),
    "longest wavelength": lambda v: MAP.band_limited(longest=v),
    "pad stiffness": lambda v: Track.named("x2000", pad_stiffness=v),
    "sleeper mass": lambda v: Track.named("x2000", sleeper_mass=v),
    "pad damping": lambda v: Track.named("x2000", pad_damping=v),
    "positions on the track": lambda v: TRACK.receptance(100.0, v, 0.0),
    "speed": lambda v: moving_kernel(TRACK, v, 1e-4),
    "time step": lambda v: moving_kernel(TRACK, 20.0, v),
    "workers of a study": lambda v: study({"kind": "ball-on-beam"}, {"seed": [1]}, workers=v),
}
NEEDED = (
    "half-space shape",
    "half-space spacing",
    "contact modulus",
    "stride",
    "rtol of a contact",
    "pad stiffness",
)


@pytest.mark.parametrize("value", NO_NUMBERS, ids=repr)
@pytest.mark.parametrize("door", DOORS)
def test_what_is_no_number_is_refused_by_name(door, value):
    with pytest.raises(
        InputError, match=rf"^{re.sub(' of a (scan|contact|study)$', '', door)}.*: received .*; allowed: "
    ):
        DOORS[door](value)


@pytest.mark.parametrize("door", [door for door in DOORS if door.startswith(NEEDED)])
def test_what_is_needed_is_not_none(door):
    with pytest.raises(InputError, match="received None; allowed: "):
        DOORS[door](None)


ARRAYS = {
    "gap": lambda v: HALF_SPACE.solve(v, load=1e-3),
    "start pressure": lambda v: HALF_SPACE.solve(BALL, load=1e-3, start=v),
    "pressure": lambda v: HALF_SPACE.displacement(v),
    "surface of the scan": lambda v: scanned(surface=v),
    "body of the scan": lambda v: scanned(body=v),
    "approaches of the scan": lambda v: scanned(approaches=v),
    "heights": lambda v: HeightMap(v, 1e-6),
    "frequency": lambda v: TRACK.receptance(v, 0.0, 0.0),
}


@pytest.mark.parametrize("value", ["a", b"x", {}, Ellipsis, [1 + 2j], ["x"], len, [[1], [1, 2]]], ids=repr)
@pytest.mark.parametrize("door", ARRAYS)
def test_what_is_no_array_of_numbers_is_refused_by_name(door, value):
    with pytest.raises(InputError, match=rf"^{door}.*: received .*; allowed: "):
        ARRAYS[door](value)


def test_one_number_stands_for_both_spacings():
    assert HalfSpace((8, 8), 1e-6, 1e11).spacing == MICROMETRE
    assert HalfSpace((8, 8), np.float32(1.0), xr.DataArray(2.0)).modulus == 2.0


def test_text_is_told_to_leave_unit_and_quotes():
    with pytest.raises(InputError, match=r"received '115 GPa'.*in SI, without unit and quotes"):
        HalfSpace((8, 8), 1e-6, "115 GPa")


def test_a_height_map_is_scanned_on_the_spacing_of_the_half_space():
    assert scanned(surface=MAP).equals(scanned())
    assert scanned(surface=MAP, approaches=1e-8).equals(scanned())
    with pytest.raises(
        InputError, match=r"surface of the scan: .* 2e-06 × 1e-06 m apart; .*Resample the map"
    ):
        scanned(surface=HeightMap(MAP.heights, (2e-6, 1e-6)))
    with pytest.raises(InputError, match="received a line of heights; allowed: a map of heights"):
        scanned(surface=MAP.line())
    holed = MAP.heights.copy()
    holed[3, 4] = np.nan
    with pytest.raises(InputError, match=r"1 of 160 points without a height.*Fill missing points"):
        scanned(surface=HeightMap(holed, MICROMETRE))
    with pytest.raises(InputError, match="1 of 160 points without a height"):
        scanned(surface=np.ma.masked_invalid(holed))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"cache": "folder"}, "cache: received 'folder'; allowed: an object with get and put"),
        ({"progress": 1}, "progress: received 1; allowed: a callable"),
        ({"device": 0}, "device: received 0; allowed: 'cpu' or 'gpu'"),
        ({"device": ""}, "device: received ''"),
    ],
)
def test_settings_of_a_scan(change, message):
    with pytest.raises(InputError, match=message):
        scanned(**change)


@pytest.mark.parametrize("value", [None, 1, [], Ellipsis, True, ""], ids=repr)
def test_what_is_no_path_is_refused(value):
    for door in (read_surface, asperity.open_result, asperity.run):
        with pytest.raises(InputError, match=r"received .*; allowed: the path of "):
            door(value)
    for definition, sweep in ((value, {"seed": [1]}), (value, None)):
        with pytest.raises(InputError, match=r"received .*; allowed: the path of "):
            study(definition, sweep)


@pytest.mark.parametrize(
    ("hints", "message"),
    [
        ({"height_unit": True}, "height_unit: received True"),
        ({"pixel": b"x"}, "pixel: received b'x'"),
        ({"pixel": {}}, "pixel: received {}"),
        ({"pixel": (1e-6, True)}, "pixel: received True"),
        ({"index": True}, "index of a sample in .*: received True; allowed: 0 to 0"),
        ({"index": "0"}, "index of a sample in .*: received '0'"),
        ({"fill": "no"}, "fill: received 'no'; allowed: True or False"),
        ({"transpose": None}, "transpose: received None; allowed: True or False"),
        ({"decimal": []}, r"decimal: received \[\]"),
    ],
)
def test_hints_of_the_wrong_kind(tmp_path, hints, message):
    np.save(tmp_path / "a.npy", MAP.heights)
    with pytest.raises(InputError, match=message):
        read_surface(tmp_path / "a.npy", **({"height_unit": "m", "pixel": "1 um"} | hints))


def test_a_kernel_needs_a_track():
    with pytest.raises(InputError, match=r"track: received 'x2000'; allowed: a Track, as Track.named"):
        moving_kernel("x2000", 20.0, 1e-4)
    with pytest.raises(InputError, match="track name: received None"):
        Track.named(None)


# --- run and study of a mapping

KEYS = {
    "kind": "ball-on-beam",
    "duration": "0.002 s",
    "laws": ("linear",),
    "seed": np.int64(3),
    "surface": {"spectrum": "iso3095"},
}


@pytest.mark.usefixtures("own_cache")
def test_a_mapping_of_keys_is_run_as_its_toml_text():
    from asperity.case.cases import parse_case

    result = asperity.run(KEYS)
    again = asperity.run(parse_case(result.attrs["case"]))
    assert result["rolling/contact_force"].equals(again["rolling/contact_force"])
    assert result.attrs["seed"] == 3
    assert 'spectrum = "iso3095"' in result.attrs["case"]


@pytest.mark.usefixtures("own_cache")
def test_a_study_of_a_mapping():
    found = study(KEYS, {"seed": [1, 2]}, workers=1)
    assert found["completed"].values.tolist() == [True, True]
    with pytest.raises(InputError, match="sweep: received nothing; allowed: keys of the case"):
        study(KEYS)


def test_a_number_in_a_mapping_is_in_si_units():
    """From Python a number is metres; in a file it has to say so."""
    from asperity.case.cases import as_case, parse_case

    assert as_case({"kind": "ball-on-beam", "surface": {"rms": 5e-7}}).surface.rms == 5e-7
    with pytest.raises(InputError, match=r"surface.rms: received 5e-07"):
        parse_case('kind = "ball-on-beam"\n[surface]\nrms = 5e-7\n')
    with pytest.raises(InputError, match='kind: received nothing; allowed: "ball-on-beam"'):
        asperity.run({})
    with pytest.raises(InputError, match="progress: received 'yes'"):
        asperity.run(KEYS, progress="yes")


# --- what takes them


def test_numbers_of_other_libraries_are_numbers():
    for value in (np.float32(2.0), np.array(2), xr.DataArray(2.0), np.int8(2)):
        assert real("x", value, "a number") == whole("x", value, "a number", at_least=0) == 2
    assert two_lengths("x", np.array([1.0, 2.0])) == (1.0, 2.0)


def test_arrays_keep_their_shape_and_masked_points_are_missing():
    assert real_array("x", 1.0, "numbers").shape == ()
    masked = np.ma.masked_equal([[1, 2], [3, 4]], 3)
    assert np.isnan(real_array("x", masked, "numbers")[1, 0])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(InputError, match="rows of unequal length"):
            real_array("x", [[1], [1, 2]], "numbers")


def test_received_values_are_shown_short_and_plain():
    assert shown("C:\\data") == "'C:\\data'"
    assert shown(np.zeros((3, 4))) == "an array of float64 of shape (3, 4)"
    assert shown(np.float64(1.5)) == "1.5"
    assert len(shown("x" * 1000)) < 70
    assert shown(10**5000) == "a huge number"


@pytest.mark.parametrize(
    ("values", "limits", "message"),
    [
        ([1.0, 1.0], {"rising": True}, "received numbers that do not rise"),
        ([[1.0, 2.0]], {"shape": (2, None)}, r"received shape \(1, 2\); allowed: numbers"),
        ([1.0, 2.0], {"count": 3}, "received 2 numbers; allowed: 3"),
        ([1.0, np.inf], {}, "received inf"),
        ([0.0, 1.0], {"above": 0.0}, r"received 0\.0"),
        ([0.0, 1.0], {"below": 1.0}, r"received 1\.0"),
        ([-0.5], {"at_least": 0.0}, r"received -0\.5"),
    ],
)
def test_arrays_within_limits(values, limits, message):
    with pytest.raises(InputError, match=message):
        finite_array("x", values, "numbers", **limits)
    assert finite_array("x", 2.0, "numbers", count=1).shape == (1,)
    np.testing.assert_array_equal(finite_array("x", [[1], [2]], shape=(2, None), rising=True), [[1], [2]])


def test_one_of_some_words():
    assert one_of("x", "mirror", ("refuse", "mirror")) == "mirror"
    for value in ("miror", 3):
        with pytest.raises(InputError, match=r"x: received .*; allowed: one of refuse, mirror\."):
            one_of("x", value, ("refuse", "mirror"))
    with pytest.raises(InputError, match='Did you mean "mirror"'):
        one_of("x", "miror", ("refuse", "mirror"))
