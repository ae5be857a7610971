"""Text as instruments export it: what is beside the heights, and what marks a missing one."""

import numpy as np
import pytest
from surface_files import x3p, x3p_xml, zipped

from asperity import HeightMap, read_surface
from asperity.case.tables import read_levels
from asperity.errors import InputError, MissingPointsWarning, OutOfRangeWarning

X = 0.25 * np.arange(40)  # um
Z = np.round(0.1 * np.sin(X) + 0.02 * np.cos(7 * X), 6)
AT = [(i, j) for j in range(6) for i in range(8)]
MAP = np.round(np.random.default_rng(5).normal(size=(8, 6)), 4)  # um, over 1.5 x 0.5 um


@pytest.fixture
def read(tmp_path):
    def read(content, encoding="utf-8", **hints):
        file = tmp_path / "a.csv"
        file.write_bytes(content.encode(encoding))
        return read_surface(file, **hints)

    return read


def rows(form):
    return "".join(
        form.format(k=k, n=k + 1, x=x, z=z, a=1e4 * z) + "\n"
        for k, (x, z) in enumerate(zip(X, Z, strict=True))
    )


def points(form):
    return "".join(form.format(x=1.5 * i, y=0.5 * j, z=MAP[i, j]) + "\n" for i, j in AT)


@pytest.mark.parametrize(("head", "form"), [
    ("Scan Data,,\nLateral(µm),Total Profile(Å)", "{x:.2f},{a:.2f}"),
    ("NumPoints=40\n\nLateral(um)\tRaw(A)", "{x:.2f}\t{a:.2f}"),
    ("Horiz. units: um\nVert. units: A", "{x:.2f},{a:.2f}"),
    ('"x (um)","z (um)"', '"{x:.2f}","{z:.6f}"'),
    ("No.,Horizontal distance[um],Height[um]", "{n},{x:.2f},{z:.6f}"),
    ("Nr;Position [µm];Wert [µm]", "{k};{x:.2f};{z:.6f}"),
    (",x (um),z (um)", ",{x:.2f},{z:.6f}"),
    ("z (um);x (um)", "{z:.6f};{x:.2f}"),
    ("Height (um),Distance (um)", "{z:.6f},{x:.2f}"),
    ("x_um,z_um", "{x:.2f},{z:.6f}"),
    ("x (um);z (um);intensity", "{x:.2f};{z:.6f};0.{n}"),
    ("x (um),y (um),z (um)", "{x:.2f},3.5,{z:.6f}"),
    ("y (um),x (um),z (um)", "{x:.2f},3.5,{z:.6f}"),
    ("[Measurement]\nPitch,0.25,um\nUnit,um\n[Data]", "{z:.6f}"),
    ("X spacing: 0.25 um\nZ unit: um", "{z:.6f}"),
    ("Increment: 250 nm\nUnit: µm", "{z:.6f}"),
])  # fmt: skip
def test_a_line_as_it_is_exported(read, head, form):
    line = read(f"{head}\n{rows(form)}")
    np.testing.assert_allclose(line.heights, 1e-6 * Z, atol=2e-12)
    assert line.spacing == pytest.approx(0.25e-6)


def test_heights_in_mils_are_thousandths_of_an_inch(read):
    line = read("x (um),z (mil)\n" + "".join(f"{x:.2f},{z / 25.4:.15e}\n" for x, z in zip(X, Z, strict=True)))
    np.testing.assert_allclose(line.heights, 1e-6 * Z, rtol=1e-12)


def test_decimal_commas_in_quotes_and_alone(read):
    quoted = rows('"{x:.2f}"@"{z:.6f}"').replace(".", ",").replace("@", ",")
    np.testing.assert_allclose(read('"x (um)","z (um)"\n' + quoted).heights, 1e-6 * Z, atol=1e-15)
    alone = "Messpunktabstand: 0,25 µm\nEinheit: µm\n" + rows("{z:.6f}").replace(".", ",")
    np.testing.assert_allclose(read(alone).heights, 1e-6 * Z, atol=1e-15)


KEYENCE = [
    "Model,VK-X1000",
    "XY calibration,1500,nm/pixel",
    "Horizontal,6",
    "Vertical,8",
    "Unit,um",
    "",
    "Height",
]


@pytest.mark.parametrize(("head", "form"), [
    ("x (um),y (um),z (um),intensity", "{x},{y},{z},17"),
    ("x (um),y (um),z (um),R,G,B", "{x},{y},{z},1,2,3"),
    ("z (um),x (um),y (um)", "{z},{x},{y}"),
])  # fmt: skip
def test_a_map_of_points_as_it_is_exported(read, head, form):
    surface = read(f"{head}\n{points(form)}")
    np.testing.assert_allclose(surface.heights, 1e-6 * MAP, atol=1e-15)
    assert surface.spacing == pytest.approx((1.5e-6, 0.5e-6))


@pytest.mark.parametrize("quote", ["", '"'])
def test_a_map_below_many_lines_of_words(read, quote):
    cells = [*(line.split(",") for line in KEYENCE), *([str(z) for z in row] for row in MAP)]
    text = "\n".join(",".join(f"{quote}{cell}{quote}" for cell in row) if any(row) else "" for row in cells)
    surface = read(text)
    np.testing.assert_allclose(surface.heights, 1e-6 * MAP, atol=1e-15)
    assert surface.spacing == pytest.approx((1.5e-6, 1.5e-6))


def test_four_comments_that_state_steps_are_no_size(read):
    """Gwyddion's four lines are known by their order, in any language: these are others."""
    comments = "# Surface\n# dx: 1.5 µm\n# dy: 0.5 µm\n# unit: µm\n"
    surface = read(comments + "\n".join(" ".join(map(str, row)) for row in MAP))
    assert surface.shape == (8, 6)
    assert surface.spacing == pytest.approx((1.5e-6, 0.5e-6))


def framed(corner):
    top = ",".join([corner, *(str(0.5 * j) for j in range(6))])
    return "\n".join([top, *(",".join(map(str, (1.5 * i, *MAP[i]))) for i in range(8))])


@pytest.mark.parametrize("corner", ["", "0", "x (um) by y (um)"])
def test_positions_in_the_first_row_and_column_are_no_heights(read, corner):
    surface = read("# lateral unit: um\n# height unit: um\n" * (corner[:1] != "x") + framed(corner),
                   **({"height_unit": "um"} if corner[:1] == "x" else {}))  # fmt: skip
    np.testing.assert_allclose(surface.heights, 1e-6 * MAP, atol=1e-15)
    assert surface.spacing == pytest.approx((1.5e-6, 0.5e-6))
    given = read(framed(corner), height_unit="um", pixel=("3 um", "1 um"))
    assert isinstance(given, HeightMap)
    assert (given.shape, given.spacing) == ((8, 6), pytest.approx((3e-6, 1e-6)))


def test_a_plane_is_no_table_of_positions(read):
    plane = np.add.outer(1.0 * np.arange(8), 0.5 * np.arange(6))
    text = "\n".join(" ".join(map(str, row)) for row in plane)
    assert read(text, height_unit="um", pixel="5 um").shape == (8, 6)


@pytest.mark.parametrize("columns", [2, 3])
def test_positions_in_an_array_are_told(tmp_path, columns):
    table = np.column_stack([X, *[Z] * (columns - 1)])
    for name, array in (("a.npy", table), ("b.npy", table.T), ("c.npy", table.astype(np.float32))):
        np.save(tmp_path / name, array)
        with pytest.raises(InputError, match="even positions beside heights; allowed: heights alone"):
            read_surface(tmp_path / name, height_unit="um", pixel="0.25 um")


MARKS = ["-", "---", "n.a.", "#N/A", "NaN(ind)", "-nan(ind)", "1.#QNAN", "-1.#IND", "void", "LOST", "Invalid",
         "1e38", "1.70141e+38", "9.96921e+36", "-3.402823e+38"]  # fmt: skip


@pytest.mark.parametrize("mark", MARKS)
def test_marks_of_a_missing_height(read, mark):
    lines = rows("{x:.2f};{z:.6f}").splitlines()
    lines[5] = f"1.25;{mark}"
    with pytest.warns(MissingPointsWarning, match=r"1 point \(2.5 %"):
        line = read("x (um);z (um)\n------;------\n" + "\n".join(lines))
    np.testing.assert_allclose(np.delete(line.heights, 5), np.delete(1e-6 * Z, 5), atol=1e-15)


@pytest.mark.parametrize(("mark", "told"), [
    ("-9999", "a point has the height -10 mm, where others spread by"),
    ("999.999", "a point has the height 1 mm"),
])  # fmt: skip
def test_a_height_far_from_all_others_is_doubted(read, mark, told):
    lines = rows("{x:.2f};{z:.6f}").splitlines()
    lines[5] = f"1.25;{mark}"
    with pytest.warns(OutOfRangeWarning, match=f"{told}.* If it marks what is missing, write NaN there"):
        read("x (um);z (um)\n" + "\n".join(lines))


@pytest.mark.parametrize("mark", [np.finfo("f8").max, 1e38, 3.4e38])
def test_marks_of_a_missing_height_in_an_archive(tmp_path, mark):
    stored = 1e-6 * MAP.T
    stored[1, 2] = mark
    (tmp_path / "a.x3p").write_bytes(x3p([stored]))
    with pytest.warns(MissingPointsWarning, match="1 point"):
        assert np.isnan(read_surface(tmp_path / "a.x3p").heights[2, 1])


@pytest.mark.parametrize("coordinates", ["", "0;0;"])
def test_heights_listed_in_the_xml_of_an_archive(tmp_path, coordinates):
    """ISO 25178-72: one Datum for each point along x, then y; an empty one has no height."""
    words = [f"{coordinates}{1e-6 * z!r}" for z in map(float, MAP.T.ravel())]
    words[9] = ""
    for count, told in ((48, None), (47, "47 heights in its list; allowed: the 48 of its matrix")):
        listed = "".join(f"<Datum>{word}</Datum>" for word in words[:count])
        text = x3p_xml((8, 6, 1), link=False).replace(
            "</Record3>", f"<DataList>{listed}</DataList></Record3>"
        )
        (tmp_path / "a.x3p").write_bytes(zipped(("main.xml", text.encode())))
        if told:
            with pytest.raises(InputError, match=told):
                read_surface(tmp_path / "a.x3p")
            continue
        with pytest.warns(MissingPointsWarning, match="1 point"):
            heights = read_surface(tmp_path / "a.x3p").heights
        assert np.isnan(heights[1, 1])
        np.testing.assert_array_equal(np.delete(heights, 7), np.delete(1e-6 * MAP, 7))


def test_the_array_that_is_advised_holds_no_positions(tmp_path):
    np.savez(tmp_path / "a.npz", x=1e-6 * X, z=Z)
    with pytest.raises(InputError, match=r'received x, z; .* Choose one, as in array="z"'):
        read_surface(tmp_path / "a.npz")


@pytest.mark.parametrize(("head", "form"), [
    ("x [um];z [um];z error [um]", "{x:.2f};{z:.6f};0.01"),
    ("x [um];std [um];z [um]", "{x:.2f};0.01;{z:.6f}"),
    ("x [um];Höhe [um];Messunsicherheit [nm]", "{x:.2f};{z:.6f};10"),
    ("x [um];raw [um];filtered [um]", "{x:.2f};{z:.6f};{a:.2f}"),
    ("No;Position (um);Profile (um);Waviness (um);Roughness (um)", "{n};{x:.2f};{z:.6f};0.1;{a:.2f}"),
])  # fmt: skip
def test_what_stands_beside_heights_is_no_second_line(read, head, form):
    """Deviations and filtered parts have the unit of heights, as lines side by side have."""
    line = read(f"{head}\n{rows(form)}")
    np.testing.assert_allclose(line.heights, 1e-6 * Z, atol=1e-12)
    assert "without" in line.source


@pytest.mark.parametrize("beside", ["quality", "Temperatur [°C]", "speed (m/s)", "sigma_um"])
def test_what_stands_beside_two_lines_is_no_third(read, beside):
    """Lines that no word for heights names: their unit does."""
    found = read(f"pos_mm;left_um;right_um;{beside}\n" + rows("{x:.2f};{z:.6f};{a:.6f};98"))
    np.testing.assert_allclose(found.heights[:, 0], 1e-6 * Z, atol=1e-12)
    assert found.shape == (40, 2)


def test_lines_of_roughness_side_by_side_stay_lines(read):
    found = read("x [mm];roughness left [um];roughness right [um]\n" + rows("{x:.2f};{z:.6f};{z:.6f}"))
    assert isinstance(found, HeightMap)
    assert found.shape == (40, 2)


@pytest.mark.parametrize(("head", "form"), [
    ("x [um];depth [um]", "{x:.2f};{z:.6f}"),
    ("x (mm)\tTiefe (um)", "{m:.5f}\t{z:.6f}"),
    ("No;x (um);Profondeur (um);std", "{k};{x:.2f};{z:.6f};0.1"),
    ("# pixel: 0.25 um\nDepth [um]", "{z:.6f}"),
])  # fmt: skip
def test_depths_are_doubted(read, head, form):
    text = "".join(
        form.format(k=k, x=x, m=1e-3 * x, z=z) + "\n" for k, (x, z) in enumerate(zip(X, Z, strict=True))
    )
    with pytest.warns(OutOfRangeWarning, match=r"is taken for heights, .* change its sign in the file"):
        line = read(f"{head}\n{text}")
    np.testing.assert_allclose(line.heights, 1e-6 * Z, atol=1e-15)


def test_arrays_of_depths_are_doubted(tmp_path):
    np.savez(tmp_path / "a.npz", depth_um=1e-6 * MAP)
    with pytest.warns(OutOfRangeWarning, match=r"a.npz: 'depth_um' is taken for heights"):
        read_surface(tmp_path / "a.npz", height_unit="m", pixel="2 um")


@pytest.mark.parametrize("letter", "DdE")
@pytest.mark.parametrize("between", [" ", ";", "\t", ","])
def test_exponents_of_any_language(read, letter, between):
    text = "".join(f"{1e-4 * n:.4E}{between}{z:.6E}\n".replace("E", letter) for n, z in enumerate(Z))
    line = read(f"x (mm){between}z (um)\n{text}")
    np.testing.assert_allclose(line.heights, 1e-6 * Z, rtol=1e-6)
    assert line.spacing == pytest.approx(1e-7)


@pytest.mark.parametrize(
    "number", ["1.234,5", "-1,234.5", "1'234.5", "1’234,5", "12\u202f345,67", "1.234.567,8"]
)
@pytest.mark.parametrize("last", [True, False])
def test_marks_between_thousands_are_told(read, number, last):
    lines = rows("{x:.2f};{a:.1f}").splitlines()
    lines[-1 if last else 0] = f"{X[-1 if last else 0]:.2f};{number}"
    text = "x (um);z (nm)\n" + "\n".join(lines)
    with pytest.raises(InputError, match=r"with marks between thousands; .*Export them without"):
        read(text)


def test_marks_between_thousands_of_single_numbers_are_told(read):
    numbers = "\n".join(f"{1000.0 + 30 * z:,.3f}".translate(str.maketrans(",.", ".,")) for z in Z)
    with pytest.raises(InputError, match=r"'1\.\d{3},\d{3}', with marks between thousands"):
        read(f"Height (nm)\n{numbers}\n", pixel="1 um")
    assert read("x (mm),z (nm)\n1.234,560\n1.235,571\n1.236,569\n").heights[1] == pytest.approx(571e-9)


@pytest.mark.parametrize("mark", ["-9999", "9999.0", "-99999", "-32768"])
def test_what_files_are_filled_with_is_doubted_near_others(read, mark):
    """Heights of some 100 nm in nm: a mark is not 300 of their spread away."""
    lines = rows("{x:.2f};{a:.1f}").splitlines()
    lines[5] = f"1.25;{mark}"
    with pytest.warns(OutOfRangeWarning, match="If it marks what is missing, write NaN there"):
        read("x (um);z (nm)\n" + "\n".join(lines))


HEIGHTS_OF_LINE = "x [µm];z [µm]\n" + "".join(f"{0.25 * n};{np.sin(0.25 * n):.6f}\n" for n in range(40))


@pytest.mark.parametrize("ending", ["mat", "nc", "x3p", "npy", "sdf", "npz"])
def test_text_is_text_whatever_the_name_of_its_file(tmp_path, ending):
    file = tmp_path / f"a.{ending}"
    file.write_text(HEIGHTS_OF_LINE, encoding="utf-8")
    line = read_surface(file)
    assert (line.shape, line.spacing) == ((40,), pytest.approx(0.25e-6))


@pytest.mark.parametrize("ending", ["mat", "nc", "x3p", "npz", "sdf", "txt", "prw"])
def test_an_array_is_one_whatever_the_name_of_its_file(tmp_path, ending):
    heights = 1e-7 * np.random.default_rng(3).normal(size=(12, 10))
    np.save(tmp_path / "a.npy", heights)
    (tmp_path / "a.npy").rename(tmp_path / f"b.{ending}")
    found = read_surface(tmp_path / f"b.{ending}", pixel="1 um", height_unit="m")
    np.testing.assert_array_equal(found.heights, heights)


EXPORT, UNPACK = "Export it as text, as CSV", "Unpack it"


@pytest.mark.parametrize(("begins", "told", "remedy"), [
    (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "a document of Office, as old workbooks of Excel are", EXPORT),
    (b"%PDF-1.7\n1 0 obj\n", "a PDF", EXPORT),
    (b"\x1f\x8b\x08\x00", "a compressed file, gzip", UNPACK),
    (b"BZh91AY&SY", "a compressed file, bzip2", UNPACK),
    (b"\xfd7zXZ\x00\x00\x04", "a compressed file, xz", UNPACK),
    (b"7z\xbc\xaf\x27\x1c\x00", "a compressed file, 7z", UNPACK),
    (b"\x89PNG\r\n\x1a\n", "a picture, PNG", EXPORT),
    (b"\xff\xd8\xff\xe0\x00\x10JFIF", "a picture, JPEG", EXPORT),
])  # fmt: skip
def test_what_is_no_table_is_told_by_what_it_is(tmp_path, begins, told, remedy):
    (tmp_path / "a.csv").write_bytes(begins + bytes(100))
    with pytest.raises(InputError, match=rf"received {told}; allowed: heights as text\. {remedy}"):
        read_surface(tmp_path / "a.csv")
    with pytest.raises(InputError, match=f"received {told}; allowed: .*{remedy}"):
        read_levels(tmp_path / "a.csv")
    (tmp_path / "a.csv").rename(tmp_path / "a.raw")
    may_be_of_instrument = "Office" in told
    message = f"received {told}; allowed: a file with heights. {remedy}"
    with pytest.raises(InputError, match="SurfaceTopography" if may_be_of_instrument else message):
        read_surface(tmp_path / "a.raw")


def test_a_workbook_is_no_table(tmp_path):
    (tmp_path / "a.csv").write_bytes(zipped(("xl/workbook.xml", b"<workbook/>")))
    with pytest.raises(
        InputError, match="a zip archive, as workbooks of Excel are; allowed: heights as text"
    ):
        read_surface(tmp_path / "a.csv")
