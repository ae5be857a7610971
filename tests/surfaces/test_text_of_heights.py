"""Text and CSV: separators, decimal marks, headers, units, missing heights, layouts."""

import numpy as np
import pytest

from asperity import HeightMap, read_surface
from asperity.errors import InputError, MissingPointsWarning
from asperity.surfaces.readers.headings import Title, columns_of_heights
from refusals import refusals

# 3 lines along x, 4 points across, in um
ROWS = [[0.5, 1.25, -2.0, 3.0], [4.0, 5.5, 6.0, 7.75], [8.0, -9.5, 10.0, 11.0]]
HINTS = {"height_unit": "um", "pixel": ("2 um", "3 um")}
POINTS = {"height_unit": "um", "pixel_unit": "mm"}


@pytest.fixture
def read(tmp_path):
    def read(content, encoding="utf-8", **hints):
        file = tmp_path / "a.csv"
        file.write_bytes(content if isinstance(content, bytes) else content.encode(encoding))
        return read_surface(file, **hints)

    return read


def matrix(delimiter, decimal=".", end=""):
    lines = (delimiter.join(str(v).replace(".", decimal) for v in row) + end for row in ROWS)
    return "\n".join(lines) + "\n"


def points(delimiter, places):
    return "\n".join(delimiter.join(map(str, (2 * i, 3 * j, ROWS[i][j]))) for i, j in places)


PLACES = [(i, j) for i in range(3) for j in range(4)]
ANY_ORDER = points(",", np.random.default_rng(3).permutation(PLACES))


@pytest.mark.parametrize(("content", "hints"), [
    *((matrix(delimiter), HINTS) for delimiter in ("\t", ";", ",", " ", "   ", ", ")),
    *((matrix(delimiter, ","), HINTS) for delimiter in ("\t", ";", "; ", " ")),
    *((matrix(delimiter, end=delimiter), HINTS) for delimiter in (";", ",", "\t")),
    ("Sample No. 5, left; side\n\n" + matrix("\t", ","), HINTS),
    ("% made by hand\n// 12.5\n" + matrix(" "), HINTS),
    (matrix(";").replace("\n", "\r\n"), HINTS),
    ("\ufeff" + matrix(";"), HINTS),
    (";;;\n" + matrix(";"), HINTS),
    ("# unit: um\n# dx = 2 um\n# dy = 3 um\n" + matrix(" "), {}),
    (f"x (um),y,z (um)\n{ANY_ORDER}", {}),
    (f"x (mm),y (mm),z (nm)\n{ANY_ORDER}", HINTS),  # a hint is stronger
])  # fmt: skip
def test_a_map_in_every_dialect(read, content, hints):
    surface = read(content, **hints)
    assert isinstance(surface, HeightMap)
    np.testing.assert_allclose(surface.heights, 1e-6 * np.array(ROWS), rtol=1e-14)
    assert surface.spacing == pytest.approx((2e-6, 3e-6))


SEMICOLONS = "\n0,0;1,5\n0,1;2,5\n0,2;-3,5\n"


HEADERS = {"# units = nm": 1e-9, "Height (nm)": 1e-9, "# height unit: mm": 1e-3, "roughness [µm]": 1e-6,
           "# Value units: m": 1.0}  # fmt: skip


@pytest.mark.parametrize(("content", "hints", "heights", "spacing"), [
    ("1.5\n2.5\n-3.5", HINTS, [1.5, 2.5, -3.5], 2e-6),
    ("0,5\n1\n2,75\n", HINTS, [0.5, 1, 2.75], 2e-6),  # a number without a comma makes it sure
    ("0,5\n1,5\n2,75\n", HINTS | {"decimal": ","}, [0.5, 1.5, 2.75], 2e-6),
    ("0,5\n1,5\n2,75\n", POINTS | {"decimal": "."}, [5, 5, 75], 1e-3),
    *((title + SEMICOLONS, {}, [1.5, 2.5, -3.5], 1e-4) for title in ("x [mm]; z (µm)", "x (mm); z [um]")),
    ("# lateral unit: mm\n# unit: um\n2 5\n1 6\n0 7\n", {}, [7, 6, 5], 1e-3),
    ("# unit: um\n# spacing: 1.5 mm\n1.5\n2.5\n", {}, [1.5, 2.5], 1.5e-3),
    ("# unit: mm\n# spacing: 1.5 mm\n1.5\n2.5\n", HINTS, [1.5, 2.5], 2e-6),
    ("1.5\n2.5\n", {"height_unit": 1e-6, "pixel": 2e-6}, [1.5, 2.5], 2e-6),
    ("1.5\n2.5\n", {"height_unit": "um", "pixel": 2.0, "pixel_unit": "um"}, [1.5, 2.5], 2e-6),
    *((f"{header}\n1.5\n2.5\n", {"pixel": "1 mm"}, 1e6 * unit * np.array([1.5, 2.5]), 1e-3)
      for header, unit in HEADERS.items()),
])  # fmt: skip
def test_a_line_with_its_units(read, content, hints, heights, spacing):
    line = read(content, **hints)
    np.testing.assert_allclose(line.heights, 1e-6 * np.array(heights))
    assert line.spacing == pytest.approx(spacing)


@pytest.mark.parametrize("encoding", ["latin-1", "utf-16"])
def test_units_in_other_encodings(read, encoding):
    found = read("x [mm]; z (µm)" + SEMICOLONS, encoding).heights
    np.testing.assert_allclose(found, [1.5e-6, 2.5e-6, -3.5e-6])


@pytest.mark.parametrize(("content", "missing"), [
    *((matrix(";").replace("5.5", word), [[1, 1]]) for word in ("NaN", "nan", "BAD", "***", "*", "NA", "")),
    (points(" ", [place for place in PLACES if place != (1, 2)]), [[1, 2]]),
    ("1;2;3;4\n;;;\n5;6;7;8\n", [[1, 0], [1, 1], [1, 2], [1, 3]]),
    ("\n1.5\n\n\n2.5\n3.5\n\n", [[1], [2]]),  # an empty line between single heights keeps its place
])  # fmt: skip
def test_missing_heights(read, content, missing):
    with pytest.warns(
        MissingPointsWarning, match=f"{len(missing)} points? .* ha(s|ve) no height.*left as NaN"
    ):
        surface = read(content, **HINTS)
    assert np.argwhere(np.isnan(surface.heights)).tolist() == missing


def test_filled_on_request(read):
    values = [str(0.5 * i) for i in range(60)]
    values[30] = "BAD"
    with pytest.warns(MissingPointsWarning, match="interpolated from their neighbours"):
        line = read("\n".join(values), fill=True, **HINTS)
    assert line.heights[30] == pytest.approx(15e-6)


SCATTERED = np.random.default_rng(5).random((2000, 3))
SCATTERED[:, :2] = np.rint(SCATTERED[:, :2] * 1e6)
LINE = "1.5\n2.5\n"


SAID = [
    (LINE, {"pixel": "1 um"}, r'heights without a unit.*height_unit="um"'),
    (LINE, {"height_unit": "um"}, r'heights without a pixel size.*pixel="1.5 um"'),
    ("0 1.5\n1 2.5\n", {"height_unit": "um"}, r'coordinates without a unit.*pixel_unit="mm"'),
    ("0,5\n1,5\n2,75\n", HINTS, r'unambiguous decimal mark.*Give decimal=","'),
    ("1 2 3 4\n5 6 7\n", HINTS, "3 values in row 2; allowed: 4"),
    ("1 2 3 4\n5 6 x 8\n", HINTS, "'5 6 x 8' in line 2"),
    ("only words\nand more\n", HINTS, "no line of numbers"),
    ("0 1\n1 2\n2.5 3\n", POINTS, "coordinates that are not uniform"),
    ("0 1\n1 2\n1 3\n2 1\n", POINTS, "several points at one place, one of them again as point 3; .*twice"),
    ("1 1\n1 2\n", POINTS, "fewer than two different coordinates.*Check the file and its columns"),
    ("0 1\nnan 2\n", POINTS, "missing or infinite coordinates"),
    ("3 0\n5.3 1\n1 2\n4.1 3\n9 4\n", POINTS, "not uniform.*Its second column is even: exchange both"),
    # decimal commas between commas: four columns of whole numbers, as it seems
    *(
        (text, POINTS | {"pixel": "1 um"}, "commas in numbers and between them; .* or semicolons")
        for text in (
            "0,0000,-0,0123\n0,0731,1,2504\n",
            "10,5, 1,25\n11,0, 1,07\n",
            "x (um),z (um)\n10,5,-0,3\n11,0,1,9\n",
        )
    ),
    # three columns of heights are no points: they would lie on a diagonal
    ("0 1 2\n10 11 12\n20 21 22\n", HINTS, "3 points that would need a grid of 3 x 3"),
    ("\n".join(" ".join(map(str, p)) for p in SCATTERED), HINTS, r"regular grid|not uniform"),
    ("Height (kg)\n1\n2\n", {"pixel": "1 um"}, "unit in the header: received 'kg'"),
    ("z (dB(A))\n1\n2\n", {"pixel": "1 um"}, "unit in the header: received 'dB'"),  # no ångström
    ("Level dB [A]\n1\n2\n", {"pixel": "1 um"}, "unit in the header: received 'dB'"),
    ("x (mm);L dB(A)\n1;2\n2;3\n", {}, "received 'dB'"),
    ("1 2 3 4\n1 inf 2 3\n", HINTS, "infinite values"),
    (b"1 2\x00\x01", HINTS, "bytes that are no text"),
    ("1.5\n", HINTS, "at least two along each axis"),
    (LINE, HINTS | {"decimal": "x"}, "decimal: received 'x'"),
    (LINE, HINTS | {"height_unit": "kg"}, "a unit that converts to m"),
    (LINE, HINTS | {"height_unit": 0.0}, "height_unit: received 0.0"),
    (LINE, HINTS | {"pixel": ("1 um", "1 um", "1 um")}, "pixel: received"),
    (LINE, HINTS | {"array": 3}, "array: received 3; allowed: the name of an array"),
    (LINE, HINTS | {"index": 1}, "index of a sample"),
    (LINE, HINTS | {"transpose": True}, "transpose: received a line"),
    (LINE, HINTS | {"spikes": True}, r"spikes: received a line, .* allowed: a height map"),
    (LINE, HINTS | {"fill": "yes"}, "fill: received 'yes'; allowed: True or False"),
]


def test_numbers_that_begin_with_zeros_are_whole_ones_beside_decimal_points(read):
    heights = read("01,2.5,3.5,4.5\n-02,2.5,0.5,4.5\n", **HINTS).heights
    np.testing.assert_allclose(heights, 1e-6 * np.array([[1.0, 2.5, 3.5, 4.5], [-2.0, 2.5, 0.5, 4.5]]))


test_what_is_wrong_is_said = refusals(
    *SAID,
    of=lambda content, hints, read: read(content, **hints),
)


SIDE_BY_SIDE = np.array([[0.51, 1.0], [-0.25, 2.0], [0.0, 3.5]])  # µm
POSITIONS = ("0", "0,001", "0,002")  # m
ROUGH = "".join(f"{left};{right}\n" for left, right in SIDE_BY_SIDE).replace(".", ",")
WITH_PLACE = "".join(f"{x};{row}\n" for x, row in zip(POSITIONS, ROUGH.splitlines(), strict=True))


@pytest.mark.parametrize(
    "text",
    [
        "Distance [m];Left rail [µm];Right rail [µm]\n" + WITH_PLACE,
        "Trolley 7;;\nSite;km 12,3;\n\nWeg [m];links [µm];rechts [µm]\n" + WITH_PLACE.replace("\n", ";\n"),
        "Sampling interval: 1 mm\nUnits: um\nleft;right\n" + ROUGH,
        "Sample distance;1;mm\nUnit: um\n".replace("1;mm", "1 mm;") + ROUGH.replace(";", "\t"),
    ],
)
def test_lines_beside_each_other_as_trolleys_write_them(read, text):
    for encoding in ("utf-8", "latin-1"):
        lines = read(text, encoding)
        np.testing.assert_allclose(lines.heights, 1e-6 * SIDE_BY_SIDE)
        assert lines.spacing[0] == pytest.approx(1e-3)
    coarser = read("x [mm],a [um],b [um]\n0,1,2\n5,3,4\n10,5,6\n", pixel="1 mm", height_unit="nm")
    np.testing.assert_allclose(coarser.heights, 1e-9 * np.arange(1, 7).reshape(3, 2))  # hints are stronger
    assert coarser.spacing[0] == pytest.approx(1e-3)


def test_points_in_one_unit_are_no_lines(read):
    surface = read("x (um),y (um),z (um)\n" + ANY_ORDER)
    assert surface.shape == (3, 4)
    with pytest.raises(InputError, match="coordinates that are not uniform"):
        read("a;b\n1;2\n5;3\n6;1\n", pixel="1 mm", height_unit="um", pixel_unit="mm")


# --- headings of instruments' exports

LEVELS = np.round(1e2 * np.random.default_rng(8).normal(size=(10, 8)), 4)  # nm: rows along y, columns along x
LINE_X = 0.25 * np.arange(40)
LINE_Z = np.round(0.1 * np.sin(LINE_X), 6)


def gwyddion(channel, width, height, unit, columns=8, value="m"):
    """A matrix as Gwyddion exports it, in the language of the program."""
    rows = "\n".join("\t".join(f"{v * 1e-9:.6e}" for v in row[:columns]) for row in LEVELS)
    size = f"# {width}: {12.0:.1f} µm\n# {height}: 5000 nm\n"
    return f"# {channel}: Topography\n{size}# {unit}: {value}\n{rows}\n"


@pytest.mark.parametrize("words", [
    ("Channel", "Width", "Height", "Value units"),
    ("Kanal", "Breite", "Höhe", "Werteinheiten"),
    ("Canal", "Largeur", "Hauteur", "Unités de valeur"),
    ("Kanál", "Šířka", "Výška", "Jednotky hodnot"),
    ("チャンネル", "幅", "高さ", "値の単位"),
])  # fmt: skip
@pytest.mark.parametrize("columns", [8, 3, 2])
def test_a_map_that_states_its_size(read, words, columns):
    surface = read(gwyddion(*words, columns))
    np.testing.assert_allclose(surface.heights, 1e-9 * LEVELS[:, :columns].T, atol=1e-15)
    assert surface.spacing == pytest.approx((12e-6 / columns, 0.5e-6))
    other = read(gwyddion(*words, columns), pixel="1 um", height_unit="mm")
    assert other.spacing == pytest.approx((1e-6, 1e-6))  # hints are stronger
    np.testing.assert_allclose(other.heights, 1e-12 * LEVELS[:, :columns].T, atol=1e-18)


def test_sizes_of_no_map_are_left_alone(read):
    read(
        "# Sample: 3\n# Radius: 2.5 um\n# Length: 5 mm\n# Operator: me\n# unit: um\n1 2 3 4\n5 6 7 8\n",
        pixel="1 mm",
    )
    points = read(f"# Width: 4 um\n# Height: 9 um\nx (um),y (um),z (um)\n{ANY_ORDER}")
    assert points.spacing == pytest.approx((2e-6, 3e-6))
    with pytest.raises(InputError, match="a length above zero"):
        read(gwyddion("Channel", "Width", "Height", "Value units").replace("12.0", "0.0"))
    with pytest.raises(InputError, match=r"unit in the header: received 'V'"):
        read(gwyddion("Channel", "Width", "Height", "Value units", value="V"))


def exported(head, end="", separator=","):
    return head + "".join(f"{x:.2f}{separator}{z:.6f}{end}\n" for x, z in zip(LINE_X, LINE_Z, strict=True))


BLOCK = "Scan Parameters\nScan Type,Standard Scan\nStylus,Radius: 2.5 µm\nLength,10 mm\n\nScan Data\n"


@pytest.mark.parametrize(("head", "separator"), [
    ("x in µm,y in µm\n", ","),
    ("x in um;z in um\n", ";"),
    ("Länge / µm;Profil / µm\n", ";"),
    (BLOCK + "Lateral um,Raw Micrometer,\n", ","),
    (BLOCK.replace(",", "\t") + "Lateral um\tRaw micron\n", "\t"),
    ('"Lateral (um)","Raw (um)"\n', ","),
    ("X;Z\n[µm];[µm]\n", ";"),
    ("X\tZ\nµm\tMikrometer\n", "\t"),
    ("# X  Z\n# um um\n", " "),
    ("Distance micrometres  Height micrometers\n", " "),
])  # fmt: skip
def test_units_in_titles_of_all_kinds(read, head, separator):
    for encoding in ("utf-8", "utf-16", "utf-16-le", "utf-16-be", "latin-1"):
        for empty in (0, 1, 3):  # cells at the end of each line; white space makes none
            line = read(exported(head, separator * empty, separator), encoding)
            np.testing.assert_allclose(line.heights, 1e-6 * LINE_Z)
            assert line.spacing == pytest.approx(0.25e-6)


@pytest.mark.parametrize(("titles", "ones"), [
    ("X;Y;valid\n[mm];[mm];[1/0]", True),
    ("X (mm);Z (mm);Valid", True),
    ("X;Z;gültig\nmm;mm;-", True),
    ("x in mm;z in mm;is invalid", False),
    ("Valid;X (mm);Z (mm)", True),
])  # fmt: skip
def test_a_column_says_what_is_valid(read, titles, ones):
    good = np.ones(40, dtype=bool)
    good[[0, 7, 8]] = False
    flags = np.where(good == ones, 1, 0)
    cells = [
        [f"{x / 1e3:.5f}", f"{z / 1e3:.9f}", f"{f}"] for x, z, f in zip(LINE_X, LINE_Z, flags, strict=True)
    ]
    first = titles.startswith("Valid")
    rows = "\n".join(";".join([row[2], *row[:2]] if first else row) for row in cells)
    with pytest.warns(MissingPointsWarning, match="3 points"):
        line = read(f"{titles}\n{rows}\n")
    np.testing.assert_allclose(line.heights, np.where(good, 1e-6 * LINE_Z, np.nan), atol=1e-12)


def test_a_column_of_other_numbers_is_no_validity(read):
    with pytest.raises(InputError, match=r"not uniform|regular grid"):
        read("X (mm);Y (mm);valid\n0;1;2\n1;4;3\n2;2;5\n", height_unit="mm")


@pytest.mark.parametrize("name", ["a.prn", "a.out", "a.prf2", "noname"])
def test_text_is_known_by_its_content(tmp_path, name):
    file = tmp_path / name
    file.write_text(exported("x in um,z in um\n"), encoding="utf-16")
    np.testing.assert_allclose(read_surface(file).heights, 1e-6 * LINE_Z)
    file.write_bytes(b"x in um\n" + bytes(range(256)) * 4)
    with pytest.raises(InputError):
        read_surface(file)


@pytest.mark.parametrize("text", [
    "", "\n\n", "words\n", "x (um)\n", "1\n", "1;2\n3\n", "a,b\n1,2\n", "# Width: 1 um\n1 2 3 4\n2 3 4 5\n",
    "X;Y;valid\n[mm];[mm];[1/0]\n0;1;0\n1;2;0\n2;3;0\n", "0 1 2\n0 2 2\n", "x (V),z (um)\n0,1\n1,2\n",
])  # fmt: skip
def test_text_that_is_intact_is_never_called_damaged(read, text):
    for encoding in ("utf-8", "utf-16", "utf-16-le"):
        with pytest.raises((InputError, MissingPointsWarning)) as told:
            read(text, encoding)
        assert "damaged" not in str(told.value)


@pytest.mark.parametrize(("numbers", "kept"), [
    ([1.0, 2.0, 3.0, 4.0], ["a", "b"]),
    ([0.0, 1.0, 2.0, 3.0], ["a", "b"]),
    ([3.0, 1.0, 7.0, 9.0], ["i", "a", "b"]),
])  # fmt: skip
def test_a_column_titled_as_a_number_is_left_out_where_it_counts_on(numbers, kept):
    """The letter i may name points, or a channel."""
    table = np.column_stack([numbers, np.zeros((4, 2))])
    found, titles = columns_of_heights(table, [Title(name, "") for name in "iab"])
    assert [title.name for title in titles] == kept
    assert found.shape == (4, len(kept))
