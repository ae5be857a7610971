"""SDF and X3P files written here from the definition of the formats, read back in metres and in place."""

import zipfile
from pathlib import Path

import numpy as np
import pytest
from surface_files import SDF_TYPES, sdf_ascii, sdf_binary, x3p

from asperity.errors import InputError, MissingPointsWarning
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.readers import read_surface, read_surfaces

# 4 points along x, 3 along y, no symmetry: the height in nm is 10 x-index + y-index
STORED = np.add.outer(np.arange(3), 10 * np.arange(4))
EXPECTED = np.add.outer(10e-9 * np.arange(4), 1e-9 * np.arange(3))
DATA = Path(__file__).parents[3] / "shared" / "data"


def write(path, data):
    path.write_bytes(data)
    return path


@pytest.mark.parametrize("code", SDF_TYPES)
def test_binary_sdf_of_every_data_type(tmp_path, code):
    surface = read_surface(write(tmp_path / "a.sdf", sdf_binary(STORED, code)))
    np.testing.assert_allclose(surface.heights, EXPECTED, rtol=1e-14)
    assert surface.spacing == (2e-6, 3e-6)
    assert surface.source == "a.sdf"


@pytest.mark.parametrize(
    ("code", "marker"),
    [(1, 2**16 - 1), (2, 2**32 - 1), (3, np.nan), (5, -(2**15)), (6, -(2**31)), (7, np.nan)],
)
def test_missing_points_of_binary_sdf(tmp_path, code, marker):
    stored = STORED.astype(float)
    stored[2, 1] = marker
    file = write(tmp_path / "a.sdf", sdf_binary(stored, code))
    with pytest.warns(MissingPointsWarning, match=r"1 points \(8\.33 % of all\)"):
        surface = read_surface(file)
    assert np.argwhere(np.isnan(surface.heights)).tolist() == [[1, 2]]


def test_eight_bit_sdf_has_no_marker(tmp_path):
    stored = STORED.copy()
    stored[0, 0] = 255
    surface = read_surface(write(tmp_path / "a.sdf", sdf_binary(stored, 0)))
    assert surface.heights[0, 0] == pytest.approx(255e-9)


def test_ascii_sdf_with_bad_point(tmp_path):
    words = [[str(v) for v in row] for row in STORED]
    words[2][1] = "BAD"
    file = write(tmp_path / "a.sdf", sdf_ascii(words))
    with pytest.warns(MissingPointsWarning):
        surface = read_surface(file)
    expected = EXPECTED.copy()
    expected[1, 2] = np.nan
    np.testing.assert_allclose(surface.heights, expected, rtol=1e-14)
    assert surface.spacing == (2e-6, 3e-6)


def test_sdf_of_one_profile_is_a_profile(tmp_path):
    # the published softgauges look like this: own version word, no spacing across
    data = sdf_ascii([["-0.296539", "-0.270753", "0.5"]], steps=(2.5e-7, 0), unit=1e-6, code=7)
    profile = read_surface(write(tmp_path / "a.sdf", data.replace(b"aISO-1.0", b"aNPL-V1.0")))
    assert isinstance(profile, Profile)
    np.testing.assert_allclose(profile.heights, [-0.296539e-6, -0.270753e-6, 0.5e-6])
    assert profile.spacing == 2.5e-7


def test_sdf_is_recognised_without_its_extension(tmp_path):
    assert read_surface(write(tmp_path / "data", sdf_binary(STORED, 5))).shape == (4, 3)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (sdf_binary(STORED, 5)[:40], "a header of 81 bytes"),
        (sdf_binary(STORED, 5)[:-1], "at least 24 bytes for so many points"),
        (sdf_binary(STORED, 5, compression=1), "compressed data"),
        (sdf_binary(STORED, 5, unit=0.0), "Zscale"),
        (sdf_binary(STORED, 5, unit=np.nan), "Zscale in a.sdf: received 'nan'; allowed: a finite number"),
        (sdf_binary(STORED, 5, steps=(-1e-6, 1e-6)), "spacing of the height map"),
        (sdf_binary(STORED, 5, steps=(np.inf, 1e-6)), "Xscale"),
        (sdf_binary(STORED, 5, points=0), "NumPoints"),
        (sdf_ascii([["1", "2"], ["3", "x"]]), "could not convert"),
        (sdf_ascii([["1", "2"], ["3"]]), "received 3 heights; allowed: the 4 that its header claims"),
        (sdf_ascii([["1", "2"], ["3", "4"]], NumPoints=None), "NumPoints in a.sdf: received nothing"),
        (sdf_ascii([["1", "2"], ["3", "4"]], NumPoints="2.5"), "NumPoints"),
        (sdf_ascii([["1", "2"], ["3", "4"]], DataType=8), "allowed: 0 to 7"),
        (sdf_ascii([["1", "2"], ["3", "4"]], Compression=1), "compressed data"),
        (sdf_ascii([["BAD", "BAD"], ["BAD", "BAD"]]), "every point is missing"),
        (sdf_ascii([["1e999", "2"], ["3", "4"]], code=7), "infinite"),
    ],
)
def test_bad_sdf(tmp_path, data, message):
    with pytest.raises(InputError, match=message):
        read_surface(write(tmp_path / "a.sdf", data))


@pytest.mark.parametrize("kind", ["I", "L", "F", "D"])
@pytest.mark.parametrize("compress", [True, False])
def test_x3p_of_every_data_type(tmp_path, kind, compress):
    file = x3p(tmp_path / "a.x3p", [STORED], kind=kind, height=("1e-9", "5e-9"), compress=compress)
    surface = read_surface(file)
    np.testing.assert_allclose(surface.heights, EXPECTED + 5e-9, rtol=1e-14)
    assert surface.spacing == (2e-6, 3e-6)


def test_x3p_in_metres_without_increment(tmp_path):
    np.testing.assert_array_equal(read_surface(x3p(tmp_path / "a.x3p", [EXPECTED.T])).heights, EXPECTED)


def test_x3p_valid_points(tmp_path):
    valid = np.ones((3, 4), dtype=bool)
    valid[2, 1] = False
    file = x3p(tmp_path / "a.x3p", [STORED], kind="I", valid=valid)
    with pytest.warns(MissingPointsWarning):
        surface = read_surface(file)
    assert np.argwhere(np.isnan(surface.heights)).tolist() == [[1, 2]]


@pytest.mark.parametrize("marker", [np.nan, np.inf])
def test_x3p_marks_missing_points_by_heights_that_are_not_finite(tmp_path, marker):
    stored = EXPECTED.T.copy()
    stored[2, 1] = marker
    with pytest.warns(MissingPointsWarning):
        surface = read_surface(x3p(tmp_path / "a.x3p", [stored]))
    assert np.argwhere(np.isnan(surface.heights)).tolist() == [[1, 2]]


def test_x3p_layers(tmp_path):
    file = x3p(tmp_path / "a.x3p", [EXPECTED.T, 2 * EXPECTED.T])
    np.testing.assert_array_equal(read_surface(file, index=1).heights, 2 * EXPECTED)
    assert len(read_surfaces(file)) == 2
    with pytest.raises(InputError, match=r"an ensemble of 2 samples.*Choose one of 0 to 1, as in index=0"):
        read_surface(file)


def test_x3p_profile_without_spacing_across(tmp_path):
    profile = read_surface(x3p(tmp_path / "a.x3p", [[[1e-6, 3e-6, 2e-6]]], steps=("4e-6", ""), feature="PRF"))
    assert isinstance(profile, Profile)
    np.testing.assert_array_equal(profile.heights, [1e-6, 3e-6, 2e-6])
    assert profile.spacing == 4e-6


def test_x3p_points_as_text(tmp_path):
    datums = [f"{h!r}" for h in EXPECTED.T.ravel().tolist()]
    datums[5] = ""
    file = x3p(tmp_path / "a.x3p", [STORED], link=False, datums=datums)
    with pytest.warns(MissingPointsWarning):
        surface = read_surface(file)
    expected = EXPECTED.copy()
    expected[1, 1] = np.nan
    np.testing.assert_array_equal(surface.heights, expected)


def test_x3p_list_of_points_in_any_order(tmp_path):
    order = np.random.default_rng(1).permutation(12)
    i, j = np.divmod(order, 3)
    points = np.stack([i * 2e-6, j * 3e-6, EXPECTED[i, j]], axis=1)
    file = x3p(
        tmp_path / "a.x3p",
        np.zeros((1, 1, 1)),
        data=points.tobytes(),
        axes=("A", "A"),
        steps=("", ""),
        dimension="<ListDimension>12</ListDimension>",
        feature="PCL",
    )
    surface = read_surface(file)
    np.testing.assert_array_equal(surface.heights, EXPECTED)
    assert surface.spacing == pytest.approx((2e-6, 3e-6))


def test_x3p_profile_with_absolute_x(tmp_path):
    points = np.array([(0.0, 5e-6), (1e-6, 7e-6), (2e-6, 4e-6)])
    options = {"axes": ("A", "I"), "steps": ("", ""), "sizes": (3, 1, 1), "feature": "PRF"}
    profile = read_surface(x3p(tmp_path / "a.x3p", [[[0.0]]], data=points.tobytes(), **options))
    np.testing.assert_array_equal(profile.heights, [5e-6, 7e-6, 4e-6])
    assert profile.spacing == pytest.approx(1e-6)
    points[1, 0] = 1.3e-6
    with pytest.raises(InputError, match="coordinates that are not uniform"):
        read_surface(x3p(tmp_path / "b.x3p", [[[0.0]]], data=points.tobytes(), **options))


IDENTITY = "".join(f"<r{i}{j}>{int(i == j)}</r{i}{j}>" for i in "123" for j in "123")


def test_x3p_identity_rotation_is_accepted(tmp_path):
    file = x3p(tmp_path / "a.x3p", [EXPECTED.T], rotation=f"<Rotation>{IDENTITY}</Rotation>")
    np.testing.assert_array_equal(read_surface(file).heights, EXPECTED)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"points_md5": "0" * 32}, "bindata/data.bin with the checksum"),
        ({"extra": {"md5checksum.hex": b"0" * 32}}, "main.xml with the checksum"),
        ({"sizes": (4, 4, 1)}, "at least 128 bytes for so many points"),
        ({"sizes": (4, 0, 1)}, "SizeY"),
        ({"sizes": (4, -3, 1)}, "SizeY"),
        ({"sizes": (4, "many", 1)}, "SizeY in a.x3p: received 'many'"),
        ({"steps": ("0", "1e-6")}, "increment of CX"),
        ({"steps": ("nan", "1e-6")}, "increment of CX"),
        ({"steps": ("-1e-6", "1e-6")}, "increment of CX"),
        ({"steps": ("", "1e-6")}, "increment of CX in a.x3p: received nothing"),
        ({"steps": ("1e-6", "")}, "spacing of the height map"),
        ({"height": ("0", "")}, "increment of CZ"),
        ({"link": False}, "0 bytes"),
        ({"link": False, "datums": ["1"] * 13}, "13 points; allowed: the 12"),
        ({"link": False, "datums": ["1;2"] * 12}, "1 numbers apart by semicolons"),
        ({"rotation": f"<Rotation>{IDENTITY.replace('0', '0.1')}</Rotation>"}, "a rotation"),
        ({"axes": ("A", "I"), "sizes": (2, 1, 3)}, "3 layers of points"),
    ],
)
def test_bad_x3p(tmp_path, options, message):
    with pytest.raises(InputError, match=message):
        read_surface(x3p(tmp_path / "a.x3p", [EXPECTED.T], **options))


def test_x3p_of_unknown_data_type(tmp_path):
    file = x3p(tmp_path / "a.x3p", [EXPECTED.T])
    content = x3p(tmp_path / "b.x3p", [EXPECTED.T])
    with zipfile.ZipFile(content) as archive, zipfile.ZipFile(file, "w") as changed:
        main = archive.read("main.xml").replace(b"<DataType>D</DataType>", b"<DataType>Q</DataType>")
        changed.writestr("main.xml", main)
    with pytest.raises(InputError, match=r"data type of CX in a\.x3p: received 'Q'; allowed: I, L, F or D"):
        read_surface(file)


@pytest.mark.parametrize(
    ("hints", "name"),
    [({"height_unit": "um"}, "height_unit"), ({"pixel": "1 um"}, "pixel"), ({"array": "a"}, "array")],
)
def test_standard_formats_take_no_hints(tmp_path, hints, name):
    for file in (write(tmp_path / "a.sdf", sdf_binary(STORED, 5)), x3p(tmp_path / "a.x3p", [EXPECTED.T])):
        with pytest.raises(InputError, match=f"hints for .*received {name}; allowed: no hints"):
            read_surface(file, **hints)


@pytest.mark.skipif(not (DATA / "rubber_x3p.x3p").exists(), reason="the measured rubber surface is not here")
def test_measured_rubber():
    with pytest.warns(MissingPointsWarning, match="5296 points"):
        surface = read_surface(DATA / "rubber_x3p.x3p")
    assert isinstance(surface, HeightMap)
    assert surface.shape == (860, 634)
    assert surface.spacing == (2.279984215e-06, 2.279794519e-06)
