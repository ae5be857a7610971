"""What is written is what other programs that write netCDF-4 write."""

import io

import numpy as np
import pytest
import xarray

from asperity.netcdf import WHOLE_CHUNK, write_netcdf


def written(tree):
    """The file of a tree, as xarray reads it."""
    file = io.BytesIO()
    write_netcdf(tree, file)
    return xarray.open_datatree(file, engine="h5netcdf").load()


@pytest.fixture
def tree():
    held = {
        "force": (("law", "time"), [[1.0, np.nan, 3.0], [4.0, 5.0, 6.0]], {"units": "N"}),
        "touches": (("time",), np.array([True, False, True])),
        "count": (("time",), np.arange(3, dtype=np.int64)),
        "of": (("part",), np.array(["ball", "beam – steel"], object)),
        "one": ((), 2.5),
        "said": ((), "µm"),
        "none": (("empty",), np.zeros(0)),
        "single": (("time",), np.arange(3, dtype=np.float32)),
    }
    coordinates = {
        "law": ["areal", "linear"],
        "time": [0.0, 0.5, 1.0],
        "place": ("time", [1.0, 2.0, 3.0], {"units": "m"}),
    }
    root = xarray.Dataset(held, coordinates, {"title": "ß", "seed": 3, "values": [1.0, 2.0]})
    inner = xarray.Dataset({"again": (("time", "law"), np.ones((4, 1)))}, {"time": [0.0, 1.0, 2.0, 3.0]})
    deep = xarray.Dataset({"below": (("time", "own"), np.zeros((4, 2)))})  # a dimension of the group above
    return xarray.DataTree.from_dict({"/rolling": root, "/contact": inner, "/contact/deep": deep})


def test_a_tree_comes_back_as_from_the_writer_of_xarray(tree):
    by_xarray = io.BytesIO()
    tree.to_netcdf(by_xarray, engine="h5netcdf", write_inherited_coords=False)
    expected = xarray.open_datatree(by_xarray, engine="h5netcdf").load()
    assert written(tree).identical(expected)


def test_dimensions_are_scales_that_every_variable_names(tree):
    import h5py

    file = io.BytesIO()
    write_netcdf(tree, file)
    with h5py.File(file) as held:
        force, again = held["rolling/force"], held["contact/again"]
        assert [each[0].name for each in force.dims] == ["/rolling/law", "/rolling/time"]
        assert [each[0].name for each in again.dims] == ["/contact/time", "/contact/law"]
        assert held["contact/law"].attrs["NAME"].startswith(b"This is a netCDF dimension but not a netCDF v")
        scales = [
            held[each].attrs["_Netcdf4Dimid"] for each in ("rolling/time", "contact/time", "contact/law")
        ]
        assert len(set(scales)) == 3
        assert np.isnan(force.fillvalue)
        assert force.chunks == force.shape
        assert again.attrs["_Netcdf4Coordinates"].tolist() == scales[1:]


def test_numbers_are_packed_with_a_checksum_and_large_ones_in_chunks():
    import h5py

    file, count = io.BytesIO(), WHOLE_CHUNK // 4
    write_netcdf(
        xarray.DataTree.from_dict({"/rolling": xarray.Dataset({"force": ("time", np.zeros(count))})}), file
    )
    assert len(file.getvalue()) < count
    with h5py.File(file) as held:
        force = held["rolling/force"]
        assert force.fletcher32
        assert force.chunks < force.shape
