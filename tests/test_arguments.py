"""Wrong types and values at the doors of Python: always a message that names what was received."""

import re

import numpy as np
import pytest
import xarray as xr

import asperity
from asperity import HalfSpace, HeightMap, Profile, Track, read_surface, study
from asperity.arguments import finite_array, one_of, real, real_array, shown, two_lengths, whole
from asperity.case.cases import as_case, parse_case
from asperity.errors import InputError
from asperity.structures.moving_kernel import moving_kernel
from refusals import refusals

MICROMETRE = (1e-6, 1e-6)
MAP = HeightMap(np.random.default_rng(0).normal(size=(20, 8)) * 1e-8, MICROMETRE)
X = (np.arange(8) - 4) * 1e-6
BALL = np.add.outer(X**2, X**2) / 2e-4
HALF_SPACE = HalfSpace((8, 8), MICROMETRE, 1e11)
TRACK = Track.named("x2000")
HOLED = np.where(np.arange(160).reshape(20, 8) == 28, np.nan, MAP.heights)

NO_NUMBERS = ["1 um", b"x", [], {}, Ellipsis, 1 + 2j, np.array(["x"]), len, float("nan"), True, (1, 2, 3)]
"""Values that stand for no single number and for no pair of them."""
NO_ARRAYS = ["a", b"x", {}, Ellipsis, [1 + 2j], ["x"], len, [[1], [1, 2]]]


def scanned(**changes):
    arguments = {"surface": MAP.heights, "body": BALL, "approaches": [1e-8]}
    return HALF_SPACE.scan(**(arguments | changes))


NUMBERS = {
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
    "spacing of the height map": lambda v: HeightMap(MAP.heights, v),
    "spacing of the profile": lambda v: Profile(MAP.heights[0], v),
    "index of a line": lambda v: MAP.line(v),
    "start of a piece": lambda v: MAP.crop(v, (4e-6, 4e-6)),
    "size of a piece": lambda v: MAP.crop((0.0, 0.0), v),
    "longest wavelength": lambda v: MAP.band_limited(longest=v),
    "pad_stiffness": lambda v: Track.named("x2000", pad_stiffness=v),
    "sleeper_mass": lambda v: Track.named("x2000", sleeper_mass=v),
    "pad_damping": lambda v: Track.named("x2000", pad_damping=v),
    "positions on the track": lambda v: TRACK.receptance(100.0, v, 0.0),
    "speed": lambda v: moving_kernel(TRACK, v, 1e-4),
    "time step": lambda v: moving_kernel(TRACK, 20.0, v),
    "workers of a study": lambda v: study({"kind": "ball-on-beam"}, {"seed": [1]}, workers=v),
}
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
NEEDED = ("half-space shape", "half-space spacing", "contact modulus", "stride of the scan",
          "rtol of a contact", "pad_stiffness")  # fmt: skip


def doors():
    for table, values in ((NUMBERS, NO_NUMBERS), (ARRAYS, NO_ARRAYS)):
        yield from ((name, door, value) for name, door in table.items() for value in values)
    yield from ((name, NUMBERS[name], None) for name in NEEDED)


@pytest.mark.parametrize(("name", "door", "value"), list(doors()))
def test_what_is_no_number_or_array_is_refused_by_name(name, door, value):
    name = re.sub(" of a (scan|contact|study)$", "", name)
    with pytest.raises(InputError, match=rf"^{name}.*: received .*; allowed: "):
        door(value)


@pytest.mark.parametrize("value", [None, 1, [], Ellipsis, True, ""], ids=repr)
@pytest.mark.parametrize(
    "door", [read_surface, asperity.open_result, asperity.run, study, lambda v: study(v, {"seed": [1]})]
)
def test_what_is_no_path_is_refused(door, value):
    with pytest.raises(InputError, match=r"received .*; allowed: the path of "):
        door(value)


KEYS = {"kind": "ball-on-beam", "duration": "0.002 s", "laws": ("linear",), "seed": np.int64(3),
        "surface": {"spectrum": "iso3095"}}  # fmt: skip
WORDS = ("refuse", "mirror")


test_what_is_said_of_other_arguments = refusals(
    (lambda: HalfSpace((8, 8), 1e-6, "115 GPa"), r"received '115 GPa'.*in SI, without unit and quotes"),
    (lambda: scanned(device=0), "device: received 0; allowed: 'cpu' or 'gpu'"),
    (lambda: scanned(device=""), "device: received ''"),
    (lambda: scanned(surface=np.ma.masked_invalid(HOLED)), "1 of 160 points without a height"),
    (lambda: moving_kernel("x2000", 20.0, 1e-4), "track: received 'x2000'; allowed: a Track, as Track.named"),
    (lambda: Track.named(None), "track name: received None"),
    (lambda: study(KEYS), "sweep: received nothing; allowed: keys of the case"),
    (lambda: asperity.run(KEYS, progress="yes"), "progress: received 'yes'"),
    (lambda: one_of("x", "miror", WORDS), "received 'miror'; allowed: one of refuse, mirror. Did you mean"),
    (lambda: one_of("x", 3, WORDS), "x: received 3; allowed: one of refuse, mirror."),
)


def hinted(hints, tmp_path):
    np.save(tmp_path / "a.npy", MAP.heights)
    read_surface(tmp_path / "a.npy", **({"height_unit": "m", "pixel": "1 um"} | hints))


test_hints_of_the_wrong_kind = refusals(
    ({"height_unit": True}, "height_unit: received True"),
    ({"pixel": (1e-6, True)}, "pixel: received True"),
    ({"index": True}, "index of a sample in .*: received True; allowed: 0 to 0"),
    of=hinted,
)


@pytest.mark.usefixtures("own_cache")
@pytest.mark.usefixtures("members_in_this_process")
def test_a_mapping_of_keys_is_run_as_its_toml_text_and_studied():
    result = asperity.run(KEYS)
    again = asperity.run(parse_case(result.attrs["case"]))
    assert result["rolling/contact_force"].equals(again["rolling/contact_force"])
    assert result.attrs["seed"] == 3
    assert as_case(KEYS | {"surface": {"rms": 5e-7}}).surface.rms == 5e-7  # a number is in SI
    found = study(KEYS, {"seed": [1, 2]}, workers=1)
    assert found["completed"].values.tolist() == [True, True]


# --- what takes them


def test_numbers_and_arrays_of_other_libraries_are_taken():
    for value in (np.float32(2.0), np.array(2), xr.DataArray(2.0), np.int8(2)):
        assert real("x", value, "a number") == whole("x", value, "a number", at_least=0) == 2
    assert two_lengths("x", np.array([1.0, 2.0])) == (1.0, 2.0)
    assert two_lengths("x", 1.0) == (1.0, 1.0)
    assert real_array("x", 1.0, "numbers").shape == ()
    masked = np.ma.masked_equal([[1, 2], [3, 4]], 3)
    assert np.isnan(real_array("x", masked, "numbers")[1, 0])
    assert scanned(surface=MAP, approaches=1e-8).equals(scanned())
    assert finite_array("x", 2.0, "numbers", count=1).shape == (1,)
    np.testing.assert_array_equal(finite_array("x", [[1], [2]], shape=(2, None), rising=True), [[1], [2]])
    assert one_of("x", "mirror", WORDS) == "mirror"


def test_received_values_are_shown_short_and_plain():
    assert shown("C:\\data") == "'C:\\data'"
    assert shown(np.zeros((3, 4))) == "an array of float64 of shape (3, 4)"
    assert shown(np.float64(1.5)) == "1.5"
    assert len(shown("x" * 1000)) < 70
    assert shown(10**5000) == "a huge number"


test_arrays_within_limits = refusals(
    ([1.0, 1.0], {"rising": True}, "received numbers that do not rise"),
    ([[1.0, 2.0]], {"shape": (2, None)}, r"received shape \(1, 2\); allowed: numbers"),
    ([1.0, 2.0], {"count": 3}, "received 2 numbers; allowed: 3"),
    ([[1], [1, 2]], {}, "rows of unequal length"),
    ([1.0, np.inf], {}, "received inf"),
    ([0.0, 1.0], {"above": 0.0}, r"received 0\.0"),
    ([0.0, 1.0], {"below": 1.0}, r"received 1\.0"),
    ([-0.5], {"at_least": 0.0}, r"received -0\.5"),
    of=lambda values, limits: finite_array("x", values, "numbers", **limits),
)
