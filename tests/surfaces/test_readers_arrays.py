"""Bare arrays, netCDF and instrument files."""

import sys
from pathlib import Path

import h5netcdf
import numpy as np
import pytest

from asperity.errors import InputError, MissingPointsWarning
from asperity.surfaces.heightmap import Profile
from asperity.surfaces.readers import read_surface, read_surfaces

HEIGHTS = np.add.outer(10.0 * np.arange(4), np.arange(3))  # (x, y)
HINTS = {"height_unit": "um", "pixel": ("2 um", "3 um")}
DATA = Path(__file__).parents[3] / "shared" / "data"


@pytest.mark.parametrize("kind", ["f8", "f4", ">f8", "i2", "u1"])
@pytest.mark.parametrize("order", ["C", "F"])
def test_npy_map_with_x_first(tmp_path, kind, order):
    np.save(tmp_path / "a.npy", np.asarray(HEIGHTS, dtype=kind, order=order))
    surface = read_surface(tmp_path / "a.npy", **HINTS)
    np.testing.assert_allclose(surface.heights, 1e-6 * HEIGHTS, rtol=1e-14)
    assert surface.spacing == pytest.approx((2e-6, 3e-6))


def test_npy_line_also_as_one_row_or_column(tmp_path):
    for array, spacing in ((HEIGHTS[:, 0], 2e-6), (HEIGHTS[:, :1], 2e-6), (HEIGHTS[:, 0][None], 3e-6)):
        np.save(tmp_path / "a.npy", array)
        line = read_surface(tmp_path / "a.npy", **HINTS)
        assert isinstance(line, Profile)
        np.testing.assert_allclose(line.heights, 1e-6 * HEIGHTS[:, 0], rtol=1e-14)
        assert line.spacing == pytest.approx(spacing)
    with pytest.raises(InputError, match="received a line; allowed: a height map"):
        read_surfaces(tmp_path / "a.npy", **HINTS)


def test_npz_ensemble(tmp_path):
    file = tmp_path / "a.npz"
    np.savez_compressed(file, pixel_um=1.5, rough=np.stack([HEIGHTS, 2 * HEIGHTS]), smooth=HEIGHTS)
    samples = read_surfaces(file, array="rough", **HINTS)
    assert [sample.source for sample in samples] == ["a.npz:rough[0]", "a.npz:rough[1]"]
    np.testing.assert_allclose(samples[1].heights, 2e-6 * HEIGHTS, rtol=1e-14)
    second = read_surface(file, array="rough", index=1, **HINTS)
    np.testing.assert_array_equal(second.heights, samples[1].heights)
    assert read_surface(file, array="smooth", index=0, **HINTS).shape == (4, 3)
    with pytest.raises(InputError, match="an ensemble of 2 samples; allowed: one sample"):
        read_surface(file, array="rough", **HINTS)
    with pytest.raises(InputError, match=r"index of a sample .*received 2; allowed: 0 to 1"):
        read_surface(file, array="rough", index=2, **HINTS)
    with pytest.raises(InputError, match="received rough, smooth; allowed: exactly one"):
        read_surface(file, **HINTS)
    with pytest.raises(InputError, match="received 'tough'; allowed: one of: pixel_um, rough, smooth"):
        read_surface(file, array="tough", **HINTS)


def test_npz_with_one_array_and_scalars(tmp_path):
    np.savez(tmp_path / "a.npz", pixel_um=1.5, z=HEIGHTS)
    assert read_surface(tmp_path / "a.npz", **HINTS).source == "a.npz:z"


def test_units_are_asked_for(tmp_path):
    np.save(tmp_path / "a.npy", HEIGHTS)
    with pytest.raises(InputError, match="heights without a unit"):
        read_surface(tmp_path / "a.npy", pixel="1 um")
    with pytest.raises(InputError, match="heights without a pixel size"):
        read_surface(tmp_path / "a.npy", height_unit="um")


@pytest.mark.parametrize(
    ("array", "message"),
    [
        (np.array([["a", "b"], ["c", "d"]]), "data of type <U1; allowed: real numbers"),
        (np.zeros((2, 2), dtype=complex), "complex128"),
        (np.zeros((2, 2, 2, 2)), r"an array of shape \(2, 2, 2, 2\)"),
        (np.float64(1.0), r"an array of shape \(\)"),
        (np.zeros((0, 3)), "at least one point along each axis"),
        (np.full((2, 2), np.nan), "every point is missing"),
        (np.full((2, 2), 1e308), None),
        (np.full((2, 2), np.inf), "infinite"),
    ],
)
def test_bad_arrays(tmp_path, array, message):
    np.save(tmp_path / "a.npy", array)
    if message is None:
        assert read_surface(tmp_path / "a.npy", **HINTS).shape == (2, 2)
        return
    with pytest.raises(InputError, match=message):
        read_surface(tmp_path / "a.npy", **HINTS)


def netcdf(
    path, dimensions=("x", "y"), heights=HEIGHTS, *, unit="um", steps=True, name="heights", **attributes
):
    sizes = dict(zip(dimensions, heights.shape, strict=True))
    with h5netcdf.File(path, "w") as file:
        file.dimensions = sizes
        variable = file.create_variable(name, dimensions, data=heights)
        variable.attrs.update(({"units": unit} if unit else {}) | attributes)
        for axis, step in (("x", 2.0), ("y", 3.0)):
            if steps and axis in sizes:
                coordinate = file.create_variable(axis, (axis,), data=7 + step * np.arange(sizes[axis]))
                if steps is True:
                    coordinate.attrs["units"] = "um"
    return path


def test_netcdf_with_units_and_coordinates(tmp_path):
    surface = read_surface(netcdf(tmp_path / "a.nc"))
    np.testing.assert_allclose(surface.heights, 1e-6 * HEIGHTS, rtol=1e-14)
    assert surface.spacing == pytest.approx((2e-6, 3e-6))


def test_netcdf_image_is_turned_by_the_names_of_its_dimensions(tmp_path):
    surface = read_surface(netcdf(tmp_path / "a.nc", ("y", "x"), HEIGHTS.T, name="z"))
    np.testing.assert_allclose(surface.heights, 1e-6 * HEIGHTS, rtol=1e-14)
    assert surface.spacing == pytest.approx((2e-6, 3e-6))


def test_netcdf_falling_coordinate_is_reversed(tmp_path):
    file = netcdf(tmp_path / "a.nc")
    with h5netcdf.File(file, "a") as opened:
        opened["x"][...] = opened["x"][...][::-1]
    np.testing.assert_allclose(read_surface(file).heights, 1e-6 * HEIGHTS[::-1], rtol=1e-14)


def test_netcdf_ensemble_and_group(tmp_path):
    file = netcdf(tmp_path / "a.nc", ("sample", "y", "x"), np.stack([HEIGHTS.T, 3 * HEIGHTS.T]))
    np.testing.assert_allclose(read_surfaces(file)[1].heights, 3e-6 * HEIGHTS, rtol=1e-14)
    with h5netcdf.File(file, "a") as opened:
        group = opened.create_group("surface")
        group.dimensions = {"distance": 3}
        group.create_variable("line", ("distance",), data=np.array([1.0, 2.0, 4.0])).attrs["units"] = "m"
        group.create_variable("distance", ("distance",), data=np.array([0.0, 0.5, 1.0])).attrs["units"] = "m"
    line = read_surface(file, array="surface/line")
    np.testing.assert_array_equal(line.heights, [1.0, 2.0, 4.0])
    assert line.spacing == 0.5


def test_netcdf_conventional_attributes(tmp_path):
    stored = HEIGHTS.astype("i2")
    stored[1, 2] = -999
    attributes = {"missing_value": np.int16(-999), "scale_factor": 0.5, "add_offset": 4.0}
    with pytest.warns(MissingPointsWarning, match="1 points"):
        surface = read_surface(netcdf(tmp_path / "a.nc", heights=stored, **attributes))
    expected = 1e-6 * (0.5 * HEIGHTS + 4.0)
    expected[1, 2] = np.nan
    np.testing.assert_allclose(surface.heights, expected, rtol=1e-14)


def test_netcdf_hints_stand_for_what_is_not_stated(tmp_path):
    file = netcdf(tmp_path / "a.nc", unit=None, steps=False)
    with pytest.raises(InputError, match="heights without a unit"):
        read_surface(file)
    with pytest.raises(InputError, match="heights without a pixel size"):
        read_surface(file, height_unit="um")
    assert read_surface(file, **HINTS).spacing == pytest.approx((2e-6, 3e-6))
    bare = netcdf(tmp_path / "b.nc", steps="without units")
    with pytest.raises(InputError, match=r'x of b.nc:heights: received no unit.*pixel_unit="um"'):
        read_surface(bare)
    assert read_surface(bare, pixel_unit="mm").spacing == pytest.approx((2e-3, 3e-3))


def test_netcdf_choice(tmp_path):
    file = netcdf(tmp_path / "a.nc", name="first")
    with h5netcdf.File(file, "a") as opened:
        opened.create_variable("second", ("x", "y"), data=HEIGHTS).attrs["units"] = "nm"
    with pytest.raises(InputError, match="received first, second; allowed: exactly one"):
        read_surface(file)
    with pytest.raises(InputError, match="received 'third'; allowed: one of: first, second"):
        read_surface(file, array="third")
    np.testing.assert_allclose(read_surface(file, array="second").heights, 1e-9 * HEIGHTS, rtol=1e-14)


def test_netcdf_coordinate_that_is_not_uniform(tmp_path):
    file = netcdf(tmp_path / "a.nc")
    with h5netcdf.File(file, "a") as opened:
        opened["x"][1] = 9.5
    with pytest.raises(InputError, match=r"x of a\.nc:heights: received coordinates that are not uniform"):
        read_surface(file)


def package(tmp_path, monkeypatch, code):
    """Put code where SurfaceTopography is imported from; files are read in a process of their own."""
    place = tmp_path / "packages"
    place.mkdir(exist_ok=True)
    (place / "SurfaceTopography.py").write_text(code)
    if str(place) not in sys.path:
        monkeypatch.syspath_prepend(str(place))


AS_THEY_ARE = f"np.array({HEIGHTS.tolist()})"
FAKE = """
import types
from contextlib import nullcontext
import numpy as np

heights = {heights}
measured = types.SimpleNamespace(
    is_uniform={uniform}, unit={unit!r}, heights=lambda: heights, pixel_size=(2.0, 3.0)[: heights.ndim]
)
channel = types.SimpleNamespace(
    name="Height", nb_grid_pts=heights.shape, physical_sizes=(1.0, 1.0), topography=lambda **_: measured
)
reader = types.SimpleNamespace(channels=[channel], default_channel=channel)
open_topography = lambda path: nullcontext(reader)
"""
"""One channel with the attributes that the documentation of SurfaceTopography names."""


@pytest.fixture
def measured(tmp_path, monkeypatch):
    file = tmp_path / "a.plu"
    file.write_bytes(b"content")

    def fake(*, unit="um", uniform=True, heights=AS_THEY_ARE):
        package(tmp_path, monkeypatch, FAKE.format(unit=unit, uniform=uniform, heights=heights))
        return file

    return fake


def test_instrument_file_without_the_extra(tmp_path, monkeypatch):
    package(tmp_path, monkeypatch, "raise ImportError")
    (tmp_path / "a.al3d").write_bytes(b"AliconaImaging")
    with pytest.raises(InputError, match=r'a .al3d file.*pip install "asperity\[readers\]"'):
        read_surface(tmp_path / "a.al3d")


def test_instrument_file(measured):
    file = measured(heights=f"np.ma.masked_equal({HEIGHTS.tolist()}, 12.0)")
    with pytest.warns(MissingPointsWarning, match=r"a\.plu:Height: 1 points"):
        surface = read_surface(file)
    expected = 1e-6 * HEIGHTS
    expected[1, 2] = np.nan
    np.testing.assert_allclose(surface.heights, expected, rtol=1e-14)
    assert surface.spacing == pytest.approx((2e-6, 3e-6))
    with pytest.raises(InputError, match=r"array in a\.plu: received 'Phase'; allowed: one of: Height"):
        read_surface(file, array="Phase")


def test_instrument_file_of_a_line(measured):
    file = measured(heights=f"np.array({HEIGHTS[:, 0].tolist()})")
    assert isinstance(read_surface(file, array="Height"), Profile)


def test_instrument_file_that_lacks_something(measured):
    with pytest.raises(InputError, match="heights without a unit"):
        read_surface(measured(unit=None))
    with pytest.raises(InputError, match="points at no uniform spacing"):
        read_surface(measured(uniform=False))


@pytest.mark.parametrize(
    ("code", "message"),
    [
        ("import time\ndef open_topography(path): time.sleep(60)", "a file that takes more than 3 s to open"),
        ("import os\ndef open_topography(path): os.abort()", r"a file that ends the program that opens it"),
        (
            "import numpy\ndef open_topography(path): numpy.ones(2**31)",
            r"(MemoryError|more than 8 GiB of memory).* while it was opened",
        ),
        (
            "def open_topography(path): raise KeyError(b'0' * 4000)",
            r"KeyError \(.{300} …\) while it was opened",
        ),
    ],
)
def test_a_library_that_fails_on_a_hostile_file(tmp_path, monkeypatch, code, message):
    package(tmp_path, monkeypatch, code)
    monkeypatch.setattr("asperity.sandbox.SECONDS", 3.0)
    monkeypatch.setattr("asperity.sandbox.PATIENCE", 1.0)
    (tmp_path / "a.plu").write_bytes(b"content")
    with pytest.raises(InputError, match=message) as caught:
        read_surface(tmp_path / "a.plu")
    assert len(str(caught.value)) < 700
    assert "a.plu: received" in str(caught.value)


def test_other_work_on_the_machine_takes_no_time_from_a_file(tmp_path, monkeypatch):
    """What is limited is the processor time: a file that only has to wait is read on."""
    code = "import time\ndef open_topography(path): time.sleep(2.5); raise KeyError('read on')"
    package(tmp_path, monkeypatch, code)
    monkeypatch.setattr("asperity.sandbox.SECONDS", 1.5)
    (tmp_path / "a.plu").write_bytes(b"content")
    with pytest.raises(InputError, match="read on"):
        read_surface(tmp_path / "a.plu")


@pytest.mark.parametrize(
    ("name", "shape", "spacing"),
    [("al3d-1.al3d", (200, 296), 4.38027e-7), ("plu-1.plu", (768, 576), 1.66e-6)],
)
def test_measured_instrument_files(name, shape, spacing):
    pytest.importorskip("SurfaceTopography", reason="the extra asperity[readers] is not installed")
    if not (DATA / name).exists():
        pytest.skip("the measured file is not here")
    surface = read_surface(DATA / name)
    assert surface.shape == shape
    assert surface.spacing == pytest.approx((spacing, spacing))


@pytest.mark.skipif(not (DATA / "aa5754_um.npz").exists(), reason="the measured aluminium sheet is not here")
def test_measured_aluminium():
    samples = read_surfaces(DATA / "aa5754_um.npz", array="polished", height_unit="um", pixel="1.5625 um")
    assert [sample.shape for sample in samples] == [(512, 512)] * 5
    assert samples[0].heights[0, 0] == pytest.approx(-1.2314e-6)


@pytest.mark.skipif(not (DATA / "wheel_lines_um_1mm.npz").exists(), reason="the measured wheels are not here")
def test_measured_wheel_lines():
    file = DATA / "wheel_lines_um_1mm.npz"
    with pytest.warns(MissingPointsWarning, match="28 points"):
        surface = read_surface(file, array="flat0p2mm", height_unit="um", pixel="1 mm", transpose=True)
    assert surface.shape == (2882, 10)
    assert surface.line(0).heights[1] == pytest.approx(-1.9e-6)
