"""The result file: what is written comes back, and what is not ours is refused."""

import os

import h5netcdf
import h5py
import numpy as np
import pytest
import xarray as xr

import asperity
from asperity.errors import InputError
from asperity.results import GROUPS, case_text, groups_of_netcdf, read_result, save, variable
from asperity.scenes.report import Result
from asperity.schema import VERSION

CASE = "kind = 'ball-on-beam'  # µm"


def small_tree(**attrs):
    time, law = variable("time", np.arange(5) * 1e-3, "s", "Time"), variable("law", ["a", "b"], "", "Law")
    values, note = np.arange(10.0).reshape(2, 5), "compression positive"
    force = variable(("law", "time"), values, "N", "Contact force", note=note)
    root = {"asperity_version": "0.1.0", "schema_version": VERSION, "seed": 1, "case": CASE} | attrs
    groups = {f"/{name}": xr.Dataset() for name in GROUPS} | {
        "/rolling": xr.Dataset({"contact_force": force}, coords={"time": time, "law": law}),
        "/scenario": xr.Dataset(attrs={"kind": "ball-on-beam"}),
        "/": xr.Dataset(attrs=root),
    }
    return xr.DataTree.from_dict(groups)


@pytest.fixture
def path(tmp_path):
    return save(small_tree(), tmp_path / "run.nc")


@pytest.mark.usefixtures("opened_apart")
def test_a_result_comes_back_as_it_was(path):
    """Through the process that opens it, from its folder too; the file is closed, and arrays are our own."""
    found = read_result(path)
    xr.testing.assert_identical(found, small_tree())
    xr.testing.assert_identical(asperity.open_result(path.parent), Result.of(small_tree()))
    assert case_text(path) == CASE
    path.unlink()
    found["rolling/contact_force"].values[:] = 0.0


@pytest.mark.parametrize("attached", [0, 1])
def test_a_variable_without_all_of_its_dimensions_is_named(tmp_path, attached):
    with h5py.File(tmp_path / "a.nc", "w") as file:
        file["force"] = np.zeros((3, 2))
        file["time"] = np.zeros(3)
        file["time"].make_scale("time")
        for axis in range(attached):
            file["force"].dims[axis].attach_scale(file["time"])
    with pytest.raises(InputError, match=r"a damaged file \(.* \(a variable without dimensions, force"):
        groups_of_netcdf(str(tmp_path / "a.nc"), True)


def test_numbers_are_packed_with_a_checksum_and_come_back_to_the_bit(path):
    noise = np.random.default_rng(1).standard_normal((3, 20_000))
    held = {"noise": (("law", "step"), noise), "rare": (("law", "step"), np.where(noise > 1.0, noise, 0.0))}
    held |= {"flags": ("step", np.arange(20_000) // 7000), "none": (("no", "step"), np.empty((0, 20_000)))}
    tree = small_tree()
    tree["/rolling"] = xr.Dataset({name: variable(*each, "1", name) for name, each in held.items()})
    save(tree, path)
    xr.testing.assert_identical(read_result(path), tree)
    assert path.stat().st_size < 0.75 * 2 * noise.nbytes
    with h5netcdf.File(path) as file:
        assert all(file["rolling"][name].fletcher32 for name in ("noise", "rare", "flags"))


def test_a_variable_without_units_is_refused_and_nothing_written(tmp_path):
    bare = xr.DataTree.from_dict({"/contact": xr.Dataset({"force": ("approach", [1.0])})})
    with pytest.raises(ValueError, match="without units or long_name: /contact/force"):
        save(bare, tmp_path / "run.nc")
    assert list(tmp_path.iterdir()) == []


def test_a_result_that_fails_to_be_written_leaves_the_old_one(path):
    with pytest.raises(TypeError):
        save(small_tree(case=object()), path)
    xr.testing.assert_identical(read_result(path), small_tree())
    assert list(path.parent.iterdir()) == [path]


def flipped(path):
    contents = bytearray(path.read_bytes())
    contents[len(contents) // 2] ^= 8
    path.write_bytes(contents)


def emptied(path):
    """A netCDF-4 file of something else."""
    xr.Dataset({"force": ("time", [1.0])}).to_netcdf(path, engine="h5netcdf")


def filled(path):
    """Chunks that no one wrote take no space in a file, and all of it in memory."""
    with h5netcdf.File(path, "a") as file:
        file.dimensions["many"] = 2**40
        file.create_variable("/rolling/zeros", ("many",), "f8", chunks=(2**20,))


def filled_with_wide_items(path):
    """Few of them, each of many bytes, packed to nearly nothing."""
    with h5py.File(path, "a") as file:
        scale = file["rolling"].create_dataset("place", data=np.zeros(100_000, "S1000"), compression="gzip")
        scale.make_scale("place")


def filled_with_words(path):
    """One long word, at the length of which all others are sent."""
    words = np.array(["a" * 2000, *[""] * 10_000], dtype=object)
    with h5py.File(path, "a") as file:
        scale = file["rolling"].create_dataset("place", data=words, dtype=h5py.string_dtype())
        scale.make_scale("place")


def piped(path):
    path.unlink()
    os.mkfifo(path)


def of_version(**stated):
    tree = small_tree()
    del tree.attrs["schema_version"]
    tree.attrs |= stated | {"asperity_version": "0.0.9"}
    return lambda path: save(tree, path)


AGAIN = r"Run its case again, or read it with asperity '0\.0\.9'\."
TOO_MUCH = "more than 100 times its size in numbers"
NO_PIPES = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no such pipes")
SPOILT = [
    (os.unlink, r"run\.nc: received no such file", True),
    (lambda path: path.write_text("time, force"), "not netCDF-4", True),
    (lambda path: path.write_bytes(path.read_bytes()[: path.stat().st_size // 2]), "a damaged file", True),
    (flipped, "its digest does not fit its contents", True),
    (lambda path: path.write_bytes(b"\x89HDF\r\n\x1a\n and no more"), "a damaged file", True),
    (emptied, "of another kind", False),
    *((fill, TOO_MUCH, False) for fill in (filled, filled_with_wide_items, filled_with_words)),
    pytest.param(piped, "a pipe or a device, which may never end", True, marks=NO_PIPES),
    (of_version(schema_version=VERSION + 1), f"allowed: schema version {VERSION}.*Update asperity\\.", False),
    (of_version(schema_version=VERSION - 1), AGAIN, False),
    (of_version(schema_version="one"), AGAIN, False),
    (of_version(), AGAIN, False),
]


@pytest.mark.parametrize(("spoil", "message", "whole"), SPOILT)
def test_what_is_no_result_is_refused(path, spoil, message, whole):
    """And, where nothing of it can be read, its case neither."""
    spoil(path)
    for read in (read_result, case_text)[: 1 + whole]:
        with pytest.raises(InputError, match=message):
            read(path)


def test_a_file_without_a_case_or_too_large_is_refused(path, monkeypatch):
    emptied(path)
    with pytest.raises(InputError, match="without a case"):
        case_text(path)
    monkeypatch.setattr("asperity.results.LARGEST_FILE", 10)
    with pytest.raises(InputError, match="GiB"):
        read_result(path)
