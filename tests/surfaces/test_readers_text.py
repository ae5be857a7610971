"""Text and CSV: separators, decimal marks, headers, units, missing heights, layouts."""

import numpy as np
import pytest

from asperity.errors import InputError, MissingPointsWarning
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.readers import read_surface

# 3 lines along x, 4 points across, in um
ROWS = [[0.5, 1.25, -2.0, 3.0], [4.0, 5.5, 6.0, 7.75], [8.0, -9.5, 10.0, 11.0]]
HINTS = {"height_unit": "um", "pixel": ("2 um", "3 um")}


@pytest.fixture
def write(tmp_path):
    def write(content, name="a.csv", encoding="utf-8"):
        file = tmp_path / name
        file.write_bytes(content if isinstance(content, bytes) else content.encode(encoding))
        return file

    return write


def matrix(delimiter, decimal=".", end=""):
    lines = (delimiter.join(str(v).replace(".", decimal) for v in row) + end for row in ROWS)
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize(
    "content",
    [
        matrix("\t"),
        matrix(";"),
        matrix(","),
        matrix(" "),
        matrix("   "),
        matrix(", "),
        matrix("\t", ","),
        matrix(";", ","),
        matrix("; ", ","),
        matrix(" ", ","),
        matrix(";", end=";"),
        matrix(",", end=","),
        matrix("\t", end="\t"),
        "Sample No. 5, left; side\n\n" + matrix("\t", ","),
        "% made by hand\n// 12.5\n" + matrix(" "),
        matrix(";").replace("\n", "\r\n"),
        "\ufeff" + matrix(";"),
        ";;;\n" + matrix(";"),
    ],
)
def test_matrix_in_every_dialect(write, content):
    surface = read_surface(write(content), **HINTS)
    assert isinstance(surface, HeightMap)
    np.testing.assert_allclose(surface.heights, 1e-6 * np.array(ROWS), rtol=1e-14)
    assert surface.spacing == pytest.approx((2e-6, 3e-6))


def test_integers_separated_by_commas(write):
    surface = read_surface(write("1,2,3,4\n5,6,7,9\n"), **HINTS)
    np.testing.assert_allclose(surface.heights, [[1e-6, 2e-6, 3e-6, 4e-6], [5e-6, 6e-6, 7e-6, 9e-6]])


def test_ambiguous_comma_is_refused_and_resolved(write):
    file = write("0,5\n1,5\n2,75\n")
    with pytest.raises(InputError, match=r'unambiguous decimal mark.*Give decimal=","'):
        read_surface(file, **HINTS)
    line = read_surface(file, decimal=",", **HINTS)
    np.testing.assert_allclose(line.heights, [0.5e-6, 1.5e-6, 2.75e-6])
    pairs = read_surface(write("0,5\n1,5\n2,75\n"), decimal=".", height_unit="um", pixel_unit="mm")
    np.testing.assert_allclose(pairs.heights, [5e-6, 5e-6, 75e-6])
    assert pairs.spacing == pytest.approx(1e-3)


def test_decimal_comma_is_sure_where_some_numbers_have_none(write):
    line = read_surface(write("0,5\n1\n2,75\n"), **HINTS)
    np.testing.assert_allclose(line.heights, [0.5e-6, 1e-6, 2.75e-6])


@pytest.mark.parametrize(
    ("header", "encoding"),
    [
        ("x [mm]; z (µm)", "utf-8"),
        ("x [mm]; z (µm)", "latin-1"),
        ("x [mm]; z (µm)", "utf-16"),
        ("x (mm); z [um]", "utf-8"),
    ],
)
def test_column_titles_with_units(write, header, encoding):
    profile = read_surface(write(f"{header}\n0,0;1,5\n0,1;2,5\n0,2;-3,5\n", encoding=encoding))
    assert isinstance(profile, Profile)
    np.testing.assert_allclose(profile.heights, [1.5e-6, 2.5e-6, -3.5e-6])
    assert profile.spacing == pytest.approx(1e-4)


@pytest.mark.parametrize(
    ("header", "unit"),
    [
        ("# unit: um", 1e-6),
        ("# units = nm", 1e-9),
        ("Height (nm)", 1e-9),
        ("# height unit: mm", 1e-3),
        ("roughness [µm]", 1e-6),
        ("# Value units: m", 1.0),
    ],
)
def test_height_units_in_headers(write, header, unit):
    profile = read_surface(write(f"{header}\n1.5\n2.5\n"), pixel="1 mm")
    np.testing.assert_allclose(profile.heights, [1.5 * unit, 2.5 * unit])


def test_pixel_sizes_in_headers(write):
    line = read_surface(write("# unit: um\n# spacing: 1.5 mm\n1.5\n2.5\n"))
    assert line.spacing == pytest.approx(1.5e-3)
    surface = read_surface(write("# unit: um\n# dx = 2 um\n# dy = 3 um\n" + matrix(" ")))
    assert surface.spacing == pytest.approx((2e-6, 3e-6))


def test_hint_is_stronger_than_header(write):
    file = write("# unit: um\n# spacing: 1.5 mm\n1.5\n2.5\n")
    line = read_surface(file, height_unit="nm", pixel="2 mm")
    np.testing.assert_allclose(line.heights, [1.5e-9, 2.5e-9])
    assert line.spacing == pytest.approx(2e-3)


def test_lateral_unit_line_and_falling_x(write):
    profile = read_surface(write("# lateral unit: mm\n# unit: um\n2 5\n1 6\n0 7\n"))
    np.testing.assert_allclose(profile.heights, [7e-6, 6e-6, 5e-6])
    assert profile.spacing == pytest.approx(1e-3)


def test_points_on_a_grid_in_any_order(write):
    lines = [f"{2 * i},{3 * j},{ROWS[i][j]}" for i in range(3) for j in range(4)]
    np.random.default_rng(3).shuffle(lines)
    file = write("x (um),y (um),z (nm)\n" + "\n".join(lines))
    surface = read_surface(file)
    np.testing.assert_allclose(surface.heights, 1e-9 * np.array(ROWS), rtol=1e-14)
    assert surface.spacing == pytest.approx((2e-6, 3e-6))


def test_hole_in_the_grid_is_missing(write):
    lines = [f"{2 * i} {3 * j} {ROWS[i][j]}" for i in range(3) for j in range(4) if (i, j) != (1, 2)]
    with pytest.warns(MissingPointsWarning, match="1 points"):
        surface = read_surface(write("\n".join(lines)), height_unit="um", pixel_unit="um")
    assert np.argwhere(np.isnan(surface.heights)).tolist() == [[1, 2]]


@pytest.mark.parametrize("marker", ["NaN", "nan", "BAD", "***", "*", "NA", ""])
def test_missing_markers(write, marker):
    content = matrix(";").replace("5.5", marker)
    with pytest.warns(MissingPointsWarning, match=r"1 points \(8.33 % of all\) have no height.*left as NaN"):
        surface = read_surface(write(content), **HINTS)
    assert np.argwhere(np.isnan(surface.heights)).tolist() == [[1, 1]]


def test_a_whole_row_may_be_missing(write):
    with pytest.warns(MissingPointsWarning, match="4 points"):
        surface = read_surface(write("1;2;3;4\n;;;\n5;6;7;8\n"), **HINTS)
    assert np.isnan(surface.heights[1]).all()


def test_empty_line_between_single_heights_keeps_its_place(write):
    with pytest.warns(MissingPointsWarning):
        line = read_surface(write("\n1.5\n\n\n2.5\n3.5\n\n"), **HINTS)
    np.testing.assert_array_equal(np.isnan(line.heights), [False, True, True, False, False])


def test_filled_on_request(write):
    values = [str(0.5 * i) for i in range(60)]
    values[30] = "BAD"
    with pytest.warns(MissingPointsWarning, match="interpolated from their neighbours"):
        line = read_surface(write("\n".join(values)), fill=True, **HINTS)
    assert line.heights[30] == pytest.approx(15e-6)


def test_transpose(write):
    surface = read_surface(write(matrix(";")), transpose=True, **HINTS)
    assert surface.shape == (4, 3)
    assert surface.spacing == pytest.approx((3e-6, 2e-6))
    with pytest.raises(InputError, match="transpose: received a line"):
        read_surface(write("1.5\n2.5\n"), transpose=True, **HINTS)


@pytest.mark.parametrize(
    ("content", "hints", "message"),
    [
        ("1.5\n2.5\n", {"pixel": "1 um"}, r'heights without a unit.*height_unit="um"'),
        ("1.5\n2.5\n", {"height_unit": "um"}, r'heights without a pixel size.*pixel="1.5 um"'),
        ("0 1.5\n1 2.5\n", {"height_unit": "um"}, r'coordinates without a unit.*pixel_unit="mm"'),
        ("1 2 3 4\n5 6 7\n", HINTS, "3 values in row 2; allowed: 4"),
        ("1 2 3 4\n5 6 x 8\n", HINTS, "'5 6 x 8' in line 2"),
        ("only words\nand more\n", HINTS, "no line of numbers"),
        ("0 1\n1 2\n2.5 3\n", {"height_unit": "um", "pixel_unit": "mm"}, "coordinates that are not uniform"),
        ("0 1\n1 2\n1 3\n2 1\n", {"height_unit": "um", "pixel_unit": "mm"}, "several points at one place"),
        ("1 1\n1 2\n", {"height_unit": "um", "pixel_unit": "mm"}, "fewer than two different coordinates"),
        ("0 1\nnan 2\n", {"height_unit": "um", "pixel_unit": "mm"}, "missing or infinite coordinates"),
        (
            "0 0 1\n1 1 1\n1 2 2\n7 9 3\n",
            {"height_unit": "um", "pixel_unit": "mm"},
            "not uniform",
        ),
        # three columns of heights are no points: they would lie on a diagonal
        ("0 1 2\n10 11 12\n20 21 22\n", HINTS, "3 points that would need a grid of 3 x 3"),
        ("Height (kg)\n1\n2\n", {"pixel": "1 um"}, "unit in the header: received 'kg'"),
        ("1 2 3 4\n1 inf 2 3\n", HINTS, "infinite values"),
        ("NaN\n1\n", {"height_unit": "um", "pixel": "1 um", "decimal": "x"}, "decimal: received 'x'"),
        (b"1 2\x00\x01", HINTS, "binary data; allowed: text"),
        ("1.5\n", HINTS, "at least two along each axis"),
    ],
)
def test_bad_text(write, content, hints, message):
    with pytest.raises(InputError, match=message):
        read_surface(write(content), **hints)


def test_scattered_points_are_refused_before_a_grid_is_made(write):
    points = np.random.default_rng(5).random((2000, 3))
    points[:, :2] = np.rint(points[:, :2] * 1e6)
    with pytest.raises(InputError, match=r"regular grid|not uniform"):
        read_surface(write("\n".join(" ".join(map(str, p)) for p in points)), **HINTS)


@pytest.mark.parametrize(
    ("hints", "message"),
    [
        ({"height_unit": "kg"}, "a unit that converts to m"),
        ({"height_unit": 0.0}, "height_unit: received 0.0"),
        ({"pixel": "1.5"}, "quantity"),
        ({"pixel": "-1 um"}, "pixel: received"),
        ({"pixel": np.nan}, "pixel: received nan"),
        ({"pixel": ("1 um", "1 um", "1 um")}, "pixel: received"),
        ({"pixel_unit": -1.0}, "pixel_unit: received"),
        ({"array": 3}, "array: received 3; allowed: the name of an array"),
        ({"index": 1}, "index of a sample"),
    ],
)
def test_bad_hints(write, hints, message):
    with pytest.raises(InputError, match=message):
        read_surface(write("1.5\n2.5\n"), **(HINTS | hints))


def test_bare_pixel_is_in_pixel_unit(write):
    assert read_surface(write("1.5\n2.5\n"), height_unit="um", pixel=2e-6).spacing == 2e-6
    line = read_surface(write("1.5\n2.5\n"), height_unit="um", pixel=2.0, pixel_unit="um")
    assert line.spacing == pytest.approx(2e-6)
