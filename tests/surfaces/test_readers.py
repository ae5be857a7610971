"""The same map in every format, read back in metres and in place; lines, ensembles, units, instruments."""

import io
import sys
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace

import h5netcdf
import h5py
import numpy as np
import pytest
from scipy.io import netcdf_file, savemat
from surface_files import SDF_TYPES, npy, sdf_ascii, sdf_binary, x3p, zipped

from asperity.errors import InputError, MissingPointsWarning, PhysicsWarning
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.readers import libraries, read_all, read_surface
from asperity.surfaces.readers.hints import Hints
from refusals import refusals

# 4 points along x, 3 along y, no symmetry, nm
HEIGHTS = np.add.outer(10.0 * np.arange(4), np.arange(3))
STORED = HEIGHTS.T  # as images are
NM = {"height_unit": "nm", "pixel": ("2 um", "3 um")}
DATA = Path(__file__).parents[3] / "shared" / "data"
IDENTITY = "".join(f"<r{i}{j}>{int(i == j)}</r{i}{j}>" for i in "123" for j in "123")


def netcdf(*, x=(7.0, 9.0, 11.0, 13.0), lateral="um", unit="nm", **variables):
    """Variables, each of dimensions, heights and attributes, with coordinates if their unit is not None."""
    stream = io.BytesIO()
    with h5netcdf.File(stream, "w") as file:
        file.dimensions = {"x": 4, "y": 3, "sample": 2}
        for name, (dimensions, heights, attributes) in (variables or {"z": ("xy", HEIGHTS, {})}).items():
            names = ["sample", *dimensions] if heights.ndim == 3 else list(dimensions)
            stated = {"units": unit} if unit else {}
            file.create_variable(name, names, data=heights).attrs.update(stated | attributes)
        for name, values in {"x": x, "y": (7.0, 10.0, 13.0)}.items() if lateral is not None else ():
            stated = {"units": lateral} if lateral else {}
            file.create_variable(name, (name,), data=np.array(values)).attrs.update(stated)
    return stream.getvalue()


def classic(version=2, kind="f8", **attributes):
    """netCDF of the classic format, whose numbers have the most significant byte first."""
    stream = io.BytesIO()
    with netcdf_file(stream, "w", version=version) as file:
        file.createDimension("x", 4)
        file.createDimension("y", 3)
        for name, values in {"x": [7.0, 9.0, 11.0, 13.0], "y": [7.0, 10.0, 13.0]}.items():
            variable = file.createVariable(name, "f8", (name,))
            variable[:], variable.units = values, "um"
        variable = file.createVariable("heights", kind, ("x", "y"))
        variable[:], variable.units = attributes.pop("heights", HEIGHTS), "nm"
        for name, value in attributes.items():
            setattr(variable, name, value)
        file.flush()
        return stream.getvalue()


def matlab(**variables):
    """A file of MATLAB before version 7.3."""
    stream = io.BytesIO()
    savemat(stream, variables, do_compression=True)
    return stream.getvalue()


def matlab_hdf5(**variables):
    """One of version 7.3: columns follow one another, and words are numbers of their own class."""
    stream = io.BytesIO()
    with h5py.File(stream, "w", userblock_size=512) as file:
        for name, values in variables.items():
            words = isinstance(values, str)
            stored = np.array([[ord(word)] for word in values], "u2") if words else values.T
            file[name] = stored
            file[name].attrs["MATLAB_class"] = np.bytes_("char" if words else "double")
    return b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(128) + stream.getvalue()[128:]


def behind_a_block(size, begin=b""):
    """HDF5 whose signature stands behind bytes of whoever wrote it."""
    stream = io.BytesIO()
    with h5py.File(stream, "w", userblock_size=size) as file:
        file["z"] = np.array(HEIGHTS, dtype=float)
    return begin.ljust(size, b"\0") + stream.getvalue()[size:]


def holed(marker, heights=STORED, at=(2, 1)):
    """Heights with a marker at the second point along x and the third along y."""
    stored = np.array(heights, dtype=float)
    stored[at] = marker
    return stored


def words(heights):
    return [["BAD" if np.isnan(v) else f"{v:g}" for v in row] for row in heights]


WHOLE = {
    **{
        f"{kind} {order}": ("a.npy", npy(np.asarray(HEIGHTS, dtype=kind, order=order)), NM)
        for kind in ("f8", "f4", ">f8", "i2", "u1")
        for order in "CF"
    },
    "npz with a scalar": ("a.npz", zipped(("s.npy", npy(np.float64(1))), ("z.npy", npy(HEIGHTS))), NM),
    "npz by name": ("a.npz", zipped(("b.npy", npy(STORED)), ("z.npy", npy(HEIGHTS))), NM | {"array": "z"}),
    "transposed": ("a.npy", npy(STORED), NM | {"pixel": ("3 um", "2 um"), "transpose": True}),
    **{f"sdf {code}": ("a.sdf", sdf_binary(STORED, code), {}) for code in SDF_TYPES},
    "sdf in ASCII": ("a.sdf", sdf_ascii(words(STORED)), {}),
    "sdf by its first bytes": ("data", sdf_binary(STORED, 5), {}),
    **{
        f"x3p {kind}": ("a.x3p", x3p([STORED - 5], kind=kind, height=("1e-9", "5e-9"), compress=zip_), {})
        for kind, zip_ in zip("ILFD", (True, False) * 2, strict=True)
    },
    "x3p, not rotated": ("a.x3p", x3p([1e-9 * STORED], rotation=f"<Rotation>{IDENTITY}</Rotation>"), {}),
    **{f"classic netCDF {version}": ("a.nc", classic(version), {}) for version in (1, 2)},
    **{f"classic netCDF of {kind}": ("a.cdf", classic(kind=kind), {}) for kind in ("f4", "i2", "i4")},
    **{
        f"matlab as {name}": (name, matlab(z=HEIGHTS, words="abc", one=1.0), NM)
        for name in ("a.mat", "a.dat")
    },
    "matlab by name": ("a.mat", matlab(a=STORED, z=HEIGHTS), NM | {"array": "z"}),
    "matlab structure": ("a.mat", matlab(s={"z": HEIGHTS, "rate": 1.0}), NM | {"array": "s.z"}),
    "matlab 7.3": ("a.mat", matlab_hdf5(z=HEIGHTS, words="abc"), NM),
    "netCDF": ("a.nc", netcdf(), {}),
    **{
        f"HDF5 behind {size} bytes as {name}": (name, behind_a_block(size, begin), NM)
        for name, size, begin in (("a.nc", 512, b""), ("a.dat", 4096, b"# of X\n"), ("a", 1024, b"PK"))
    },
    "netCDF image": ("a.nc", netcdf(z=("yx", STORED, {})), {}),
    "netCDF that falls": ("a.nc", netcdf(x=7 - 2.0 * np.arange(4), z=("xy", HEIGHTS[::-1], {})), {}),
    "netCDF without units": ("a.nc", netcdf(lateral=None, unit=""), NM),
    "netCDF with a unit of its steps": ("a.nc", netcdf(lateral=""), {"pixel_unit": "um"}),
    "netCDF by name": ("a.nc", netcdf(s=("yx", STORED, {}), z=("xy", HEIGHTS, {})), {"array": "z"}),
    "netCDF called heights": ("a.nc", netcdf(s=("yx", STORED, {}), heights=("xy", HEIGHTS, {})), {}),
}
ENDS = {code: np.iinfo(kind) if code not in (3, 7) else np.finfo(kind) for code, kind in SDF_TYPES.items()}
"""Limits of each type."""
REVISIONS = {  # magic, how points are counted, which end is reserved, and the types that a revision has
    "ISO-1.0": (b"bISO-1.0", "<HH", "min", (4, 5, 6, 3, 7)),
    "ISO-2.0": (b"bISO-2.0", "<II", "min", (4, 5, 6, 3, 7)),
    "ISO-2.0 that counts as before": (b"bISO-2.0", "<HH", "min", (5, 7)),
    "BCR-1.0": (b"bBCR-1.0", "<HH", "max", tuple(SDF_TYPES)),
    "BCR-1.0 in capitals": (b"BBCR-1.0", "<HH", "max", (5, 7)),
}
MARKED = {
    f"sdf {revision} {SDF_TYPES[code]}": (holed(getattr(ENDS[code], end)), code, magic, counts)
    for revision, (magic, counts, end, codes) in REVISIONS.items()
    for code in codes
}
NC_FILL = {"i2": -32767, "i4": -2147483647, "f4": 9.969209968386869e36, "f8": 9.969209968386869e36}
RANGES = {
    "_FillValue of another type": {"_FillValue": np.float32(-999.0)},
    "missing_value of another type": {"missing_value": -999.0},
    "several missing values": {"missing_value": np.array([-998.0, -999.0])},
    "valid_range": {"valid_range": np.array([-100.0, 100.0])},
    "valid_min": {"valid_min": -100.0},
}
PACKED = {"missing_value": np.int16(-999), "scale_factor": 0.5, "add_offset": 4.0}
MARKERS = {1: 2**16 - 1, 2: 2**32 - 1, 3: np.nan, 5: -(2**15), 6: -(2**31), 7: np.nan}
HOLED = {
    **{f"sdf {code}": ("a.sdf", sdf_binary(holed(marker), code)) for code, marker in MARKERS.items()},
    **{
        name: ("a.sdf", sdf_binary(stored, code, magic=magic, counts=counts))
        for name, (stored, code, magic, counts) in MARKED.items()
    },
    "sdf in ASCII": ("a.sdf", sdf_ascii(words(holed(np.nan)))),
    "sdf of BCR in ASCII": ("a.sdf", sdf_ascii(words(holed(32767)), magic="aBCR-1.0", DataType="INTEGER")),
    "sdf of BCR in ASCII, double": ("a.sdf", sdf_ascii(words(holed(1.7e308)), magic="aBCR-1.0", code=7)),
    "x3p mask": ("a.x3p", x3p([STORED], kind="I", height=("1e-9", ""), valid=holed(0, STORED + 1) > 0)),
    "x3p not a number": ("a.x3p", x3p([1e-9 * holed(np.nan)])),
    "x3p infinite": ("a.x3p", x3p([1e-9 * holed(np.inf)])),
    "netCDF": ("a.nc", netcdf(z=("xy", holed(-999, 2 * HEIGHTS - 8, (1, 2)).astype("i2"), PACKED))),
    "classic netCDF": (
        "a.nc",
        classic(kind="i2", heights=holed(-999, HEIGHTS, (1, 2)), missing_value=np.int16(-999)),
    ),
    **{
        f"netCDF that fills {kind}": (
            "a.nc",
            netcdf(z=("xy", holed(fill, HEIGHTS, (1, 2)).astype(kind), {})),
        )
        for kind, fill in NC_FILL.items()
    },
    **{
        f"netCDF {name}": ("a.nc", netcdf(z=("xy", holed(-999, HEIGHTS, (1, 2)), told)))
        for name, told in RANGES.items()
    },
    **{
        f"npy {kind}": ("a.npy", npy(holed(np.iinfo(kind).min, HEIGHTS, (1, 2)).astype(kind)))
        for kind in ("i2", ">i4", "i8")
    },
    **{
        f"npy {kind} {sign}": ("a.npy", npy(holed(sign * np.finfo(kind).max, HEIGHTS, (1, 2)).astype(kind)))
        for kind in ("f4", "f8")
        for sign in (-1.0, 1.0)
    },
}


@pytest.fixture
def write(tmp_path):
    def write(name, contents):
        (tmp_path / name).write_bytes(contents)
        return tmp_path / name

    return write


@pytest.mark.parametrize(("name", "contents", "hints"), WHOLE.values(), ids=WHOLE)
def test_a_map_is_the_same_in_every_format(write, name, contents, hints):
    surface = read_surface(write(name, contents), **hints)
    assert isinstance(surface, HeightMap)
    np.testing.assert_allclose(surface.heights, 1e-9 * HEIGHTS, rtol=1e-14, atol=1e-24)
    assert surface.spacing == pytest.approx((2e-6, 3e-6))
    assert surface.source.startswith(name)


@pytest.mark.usefixtures("opened_apart")
@pytest.mark.parametrize("kind", ["netCDF", "classic netCDF 2", "matlab by name", "matlab 7.3"])
def test_what_libraries_read_they_read_in_a_sandbox_too(write, kind):
    name, contents, hints = WHOLE[kind]
    surface = read_surface(write(name, contents), **hints)
    np.testing.assert_allclose(surface.heights, 1e-9 * HEIGHTS, rtol=1e-14, atol=1e-24)


@pytest.mark.parametrize(("name", "contents"), HOLED.values(), ids=HOLED)
def test_a_missing_point_is_missing_in_every_format(write, name, contents):
    with pytest.warns(MissingPointsWarning, match=r"1 point \(8\.3 % of all\) has no height.*left as NaN"):
        surface = read_surface(write(name, contents), **(NM if name == "a.npy" else {}))
    expected = 1e-9 * holed(np.nan, HEIGHTS, (1, 2))
    np.testing.assert_allclose(surface.heights, expected, rtol=1e-14, atol=1e-24)
    assert surface.spacing == pytest.approx((2e-6, 3e-6))


@pytest.mark.parametrize(("magic", "end"), [(b"bISO-1.0", "max"), (b"bBCR-1.0", "min")])
@pytest.mark.parametrize("code", [4, 5, 6])
def test_the_other_end_of_a_type_is_a_height(write, magic, end, code):
    value = getattr(ENDS[code], end)
    surface = read_surface(write("a.sdf", sdf_binary(holed(value), code, magic=magic)))
    assert surface.heights[1, 2] == pytest.approx(1e-9 * value)


@pytest.mark.parametrize("code", [0, 1, 2, 4, 5, 6])
@pytest.mark.parametrize("magic", [b"bISO-1.0", b"bBCR-1.0"])
@pytest.mark.parametrize("end", ["min", "max"])
def test_an_end_of_a_type_that_is_not_reserved_is_told_where_it_stands_alone(write, magic, code, end):
    kind = np.iinfo(SDF_TYPES[code])
    stored = 50 + np.arange(64).reshape(8, 8) % 9
    file = write("a.sdf", sdf_binary(stored, code, magic=magic))
    assert not np.isnan(read_surface(file).heights).any()  # nothing is told
    stored[2, 3:5] = getattr(kind, end)
    file = write("a.sdf", sdf_binary(stored, code, magic=magic))
    with pytest.warns(PhysicsWarning) as caught:
        heights = read_surface(file).heights
    told = [str(each.message) for each in caught if "an end of the type" in str(each.message)]
    if np.isnan(heights).any():
        assert not told
    else:
        assert told == [
            f"a.sdf: 2 points of 64 stored as {getattr(kind, end)}, an end of the type, away from all "
            "others: taken for heights. If it marks what is missing, export the file as text with NaN there."
        ]


@pytest.mark.parametrize("code", [0, 4])
def test_heights_that_reach_the_end_of_a_type_are_not_doubted(write, code):
    stored = np.iinfo(SDF_TYPES[code]).max - np.arange(64).reshape(8, 8) % 9
    assert not np.isnan(read_surface(write("a.sdf", sdf_binary(stored, code))).heights).any()


@pytest.mark.parametrize("file_format", ["ASCII", "BINARY"])
@pytest.mark.parametrize("revision", ["ISO_1_0", "ISO_2_0", "BCR_1_0"])
def test_an_independent_writer_is_understood(tmp_path, revision, file_format):
    """sdfio, of every type; BCR has no direction of its profiles, which it turns."""
    sdfio = pytest.importorskip("sdfio", minversion="2.0")
    rules = sdfio.Revision[revision].rules
    for kind in rules.data_types:
        file, stored = tmp_path / f"{kind.name}.sdf", 1e-9 * holed(np.nan)
        scales = {"x_scale": 2e-6, "y_scale": 3e-6, "z_scale": 1e-9}
        written = sdfio.SdfFile.from_array(stored, **scales, format=sdfio.FileFormat[file_format])
        written.with_revision(sdfio.Revision[revision], data_type=kind).save(file)
        with pytest.warns(MissingPointsWarning, match="1 point"):
            found = read_surface(file).heights
        turned = slice(None, None, -1 if rules.reverses_profile_order else 1)
        np.testing.assert_allclose(found, stored[turned].T, rtol=1e-6, atol=1e-15)


def test_eight_bit_sdf_has_no_marker(write):
    assert read_surface(write("a.sdf", sdf_binary(holed(255), 0))).heights[1, 2] == pytest.approx(255e-9)


SOFTGAUGE = sdf_ascii(words([HEIGHTS[:, 1]]), steps=(2e-6, 0)).replace(b"aISO-1.0", b"aNPL-V1.0")
"""The published ones look like this: own version word, no spacing across."""


@pytest.mark.parametrize(("name", "contents", "spacing"), [
    ("a.npy", npy(HEIGHTS[:, 1]), 2e-6),
    ("a.npy", npy(HEIGHTS[:, 1:2]), 2e-6),
    ("a.npy", npy(HEIGHTS[:, 1][None]), 3e-6),
    ("a.sdf", SOFTGAUGE, 2e-6),
    ("a.x3p", x3p([[1e-9 * HEIGHTS[:, 1]]], steps=("2e-6", "")), 2e-6),
    ("a.nc", netcdf(z=("x", HEIGHTS[:, 1], {})), 2e-6),
])  # fmt: skip
def test_a_line_is_the_same_in_every_format(write, name, contents, spacing):
    line = read_surface(write(name, contents), **(NM if name == "a.npy" else {}))
    assert isinstance(line, Profile)
    np.testing.assert_allclose(line.heights, 1e-9 * HEIGHTS[:, 1], rtol=1e-14)
    assert line.spacing == pytest.approx(spacing)


@pytest.mark.parametrize(("name", "contents", "hints"), [
    ("a.npz", zipped(("z.npy", npy(np.stack([HEIGHTS, 2 * HEIGHTS])))), NM),
    ("a.nc", netcdf(z=("yx", np.stack([STORED, 2 * STORED]), {})), {}),
    ("a.x3p", x3p([1e-9 * STORED, 2e-9 * STORED]), {}),
])  # fmt: skip
def test_an_ensemble_is_read_whole_or_by_sample(write, name, contents, hints):
    file = write(name, contents)
    samples = read_all(file, **hints)
    assert len(samples) == 2
    assert samples[1].source.endswith("[1]")
    for one in (samples[1], read_surface(file, index=1, **hints)):
        np.testing.assert_allclose(one.heights, 2e-9 * HEIGHTS, rtol=1e-14)
    with pytest.raises(InputError, match=r"an ensemble of 2 samples.*Choose one of 0 to 1, as in index=0"):
        read_surface(file, **hints)
    with pytest.raises(InputError, match=r"index of a sample .*received 2; allowed: 0 to 1"):
        read_surface(file, index=2, **hints)


def test_netcdf_group(write):
    file = write("a.nc", netcdf())
    with h5netcdf.File(file, "a") as opened:
        group = opened.create_group("surface")
        group.dimensions = {"distance": 3}
        group.create_variable("line", ("distance",), data=np.array([1.0, 2.0, 4.0])).attrs["units"] = "m"
        group.create_variable("distance", ("distance",), data=np.array([0.0, 0.5, 1.0])).attrs["units"] = "m"
    line = read_surface(file, array="surface/line")
    np.testing.assert_array_equal(line.heights, [1.0, 2.0, 4.0])
    assert line.spacing == 0.5


def never_written():
    stream = io.BytesIO()
    with h5netcdf.File(stream, "w") as file:
        file.dimensions = {"x": 50000, "y": 5000}
        file.create_variable("heights", ("x", "y"), "f8", chunks=(500, 500)).attrs["units"] = "m"
    return stream.getvalue()


SEVERAL = zipped(("p.npy", npy(np.float64(1))), ("b.npy", npy(STORED)), ("z.npy", npy(HEIGHTS)))
UNEVEN = np.array([(0, 5e-6), (1.3e-6, 7e-6), (2e-6, 4e-6), (3e-6, 1e-6)]).tobytes()
REFUSED = [  # file, its contents, hints, and what the message says
    ("a.npz", SEVERAL, NM, "received b, z; allowed: exactly one"),
    ("a.npz", SEVERAL, NM | {"array": "q"}, "received 'q'; allowed: one of: p, b, z"),
    ("a.npy", npy(HEIGHTS + 1j), NM, "complex128; allowed: real numbers. Keep numbers alone in the file"),
    ("a.npz", zipped(("z.npy", npy(HEIGHTS + 1j))), NM, 'real numbers. Select another one, as in array="'),
    ("a.mat", matlab(s=np.array([HEIGHTS, STORED], object)), NM, "received none; .* real numbers by itself"),
    ("a.nc", netcdf(unit=""), {}, "heights without a unit"),
    ("a.nc", netcdf(lateral=None), {}, "heights without a pixel size"),
    ("a.nc", netcdf(lateral=""), {}, r'x of a.nc:z: .* without a unit.*pixel_unit="um"'),
    ("a.nc", netcdf(b=("xy", HEIGHTS, {}), z=("xy", HEIGHTS, {})), {}, "received b, z; allowed: exactly one"),
    ("a.nc", netcdf(), {"array": "q"}, "received 'q'; allowed: one of: z, or group/variable"),
    ("a.nc", netcdf(x=[0.0, 1.0, 2.5, 3.0]), {}, r"x of a\.nc:z: received coordinates that are not uniform"),
    ("a.nc", never_written(), {"pixel": "1 um"}, r"50000 x 5000 points in \d+ bytes"),
    ("a.nc", netcdf()[:3000], {}, "an intact netCDF file"),
    *(
        (name, contents, {hint: value}, f"hints for .*received {hint}; allowed: no hints")
        for name, contents in (("a.sdf", sdf_binary(STORED, 5)), ("a.x3p", x3p([STORED])))
        for hint, value in (("height_unit", "um"), ("pixel", "1 um"), ("array", "a"))
    ),
]


LARGEST = np.where(np.arange(40) % 2, 1e308, -1e308)


@pytest.mark.parametrize(
    ("file", "contents"),
    [
        ("a.txt", b"\n".join(b"%.3e" % value for value in LARGEST)),
        ("places.txt", b"\n".join(b"%.3e %d" % pair for pair in enumerate(LARGEST))),
        ("places_beyond.txt", b"\n".join(b"%.3e %d" % (value, n) for n, value in enumerate(LARGEST))),
        ("a.npy", npy(LARGEST)),
        ("a.npz", zipped(("z.npy", npy(LARGEST)))),
        ("a.mat", matlab(z=LARGEST)),
        ("a.sdf", sdf_binary(np.tile(0.1 * LARGEST, (2, 1)), 7)),
    ],
)
def test_the_largest_numbers_there_are_end_in_a_message(write, file, contents):
    hints = {} if file == "a.sdf" else NM | ({"pixel_unit": "um", "pixel": None} if "places" in file else {})
    with pytest.raises(InputError, match=r"every point is missing|missing or infinite coord|of 1·10⁹⁹"):
        read_surface(write(file, contents), **hints)


test_what_a_file_does_not_say_is_asked_for = refusals(
    *REFUSED,
    of=lambda name, contents, hints, write: read_surface(write(name, contents), **hints),
)


@pytest.fixture
def measured(write, monkeypatch):
    """A file of one channel with the attributes that the documentation of SurfaceTopography names."""

    def fake(*, unit="nm", uniform=True, heights=HEIGHTS):
        size = (2000.0, 3000.0)[: heights.ndim]
        topography = SimpleNamespace(is_uniform=uniform, unit=unit, heights=lambda: heights, pixel_size=size)
        channel = SimpleNamespace(name="Height", nb_grid_pts=heights.shape, physical_sizes=(1.0, 1.0))
        channel.topography = lambda **_: topography
        reader = SimpleNamespace(channels=[channel], default_channel=channel)
        package = SimpleNamespace(open_topography=lambda path: nullcontext(reader))
        monkeypatch.setitem(sys.modules, "SurfaceTopography", package)
        return write("a.plu", b"content")

    return fake


def test_instrument_file(measured):
    file = measured(heights=np.ma.masked_equal(HEIGHTS, 12.0))
    with pytest.warns(MissingPointsWarning, match=r"a\.plu:Height: 1 point"):
        surface = read_surface(file)
    np.testing.assert_allclose(surface.heights, 1e-9 * holed(np.nan, HEIGHTS, (1, 2)), rtol=1e-14)
    assert surface.spacing == pytest.approx((2e-6, 3e-6))
    assert isinstance(read_surface(measured(heights=HEIGHTS[:, 0]), array="Height"), Profile)


def test_a_line_that_a_library_calls_uneven_is_one_whose_positions_were_rounded():
    """Rounded to 1 nm, 99.5613 nm apart; what is really uneven is told."""
    x, z = np.round(0.0995613 * np.arange(200), 3), np.sin(np.arange(200.0))
    for places, wrong in ((x, False), (x**2, True)):
        line = SimpleNamespace(is_uniform=False, unit="um", heights=lambda: z,
                               positions_and_heights=lambda places=places: (places, z))  # fmt: skip
        with pytest.raises(InputError, match="x of a: received coordinates that") if wrong else nullcontext():
            (profile,) = libraries._surfaces(line, Hints(), "a")
            np.testing.assert_allclose(profile.heights, 1e-6 * z)
            assert profile.spacing == pytest.approx(9.95613e-8, rel=1e-4)


def test_instrument_file_that_lacks_something(measured, monkeypatch):
    for changes, hints, message in (
        ({}, {"array": "Phase"}, r"array in a\.plu: received 'Phase'; allowed: one of: Height"),
        ({"unit": None}, {}, "heights without a unit"),
        ({"uniform": False}, {}, "points at no uniform spacing"),
    ):
        with pytest.raises(InputError, match=message):
            read_surface(measured(**changes), **hints)
    file = measured()
    monkeypatch.setitem(sys.modules, "SurfaceTopography", None)
    with pytest.raises(InputError, match=r'a .plu file.*pip install "asperity\[readers\]"'):
        read_surface(file)


@pytest.mark.parametrize(("name", "shape", "spacing"), [
    ("al3d-1.al3d", (200, 296), 4.38027e-7),
    ("plu-1.plu", (768, 576), 1.66e-6),
    ("rubber_x3p.x3p", (860, 634), 2.2799e-6),
])  # fmt: skip
@pytest.mark.filterwarnings("ignore::asperity.errors.MissingPointsWarning")
def test_measured_files(name, shape, spacing):
    if not (DATA / name).exists():
        pytest.skip("the measured file is not here")
    if name.endswith(("al3d", "plu")):
        pytest.importorskip("SurfaceTopography", reason="the extra asperity[readers] is not installed")
    surface = read_surface(DATA / name)
    assert surface.shape == shape
    assert surface.spacing == pytest.approx((spacing, spacing), rel=1e-4)
