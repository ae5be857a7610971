"""The result file: what is written comes back, and what is not ours is refused."""

import os

import h5netcdf
import numpy as np
import pytest
import xarray as xr

import asperity
from asperity.errors import InputError
from asperity.results import GROUPS, case_text, checked, read_result, save, variable
from asperity.sandbox import sandboxed
from asperity.scenes.notebook import Result
from asperity.schema import VERSION


def small_tree():
    time = variable("time", np.arange(5) * 1e-3, "s", "Time")
    laws = variable("law", ["areal", "linear"], "", "Law of the contact force")
    force = variable(
        ("law", "time"), np.arange(10.0).reshape(2, 5), "N", "Contact force", note="compression positive"
    )
    groups = {f"/{name}": xr.Dataset() for name in GROUPS}
    groups["/rolling"] = xr.Dataset({"contact_force": force}, coords={"time": time, "law": laws})
    groups["/scenario"] = xr.Dataset(attrs={"kind": "ball-on-beam"})
    groups["/"] = xr.Dataset(
        attrs={
            "asperity_version": "0.1.0",
            "schema_version": VERSION,
            "seed": 1,
            "case": "kind = 'ball-on-beam'  # µm",
        }
    )
    return xr.DataTree.from_dict(groups)


def test_a_result_comes_back_as_it_was(tmp_path, monkeypatch):
    """Through the process that opens it; its arrays can be written to."""
    monkeypatch.setattr("asperity.results.sandboxed", sandboxed)
    tree = small_tree()
    found = read_result(save(tree, tmp_path / "run.nc"))
    xr.testing.assert_identical(found, tree)
    found["rolling/contact_force"].values[:] = 0.0


def test_a_small_file_of_many_numbers_is_refused(tmp_path):
    """Chunks that no one wrote take no space in a file, and all of it in memory."""
    path = save(small_tree(), tmp_path / "run.nc")
    with h5netcdf.File(path, "a") as file:
        file.dimensions["many"] = 2**40
        file.create_variable("/rolling/zeros", ("many",), "f8", chunks=(2**20,))
    with pytest.raises(InputError, match="more than 100 times its size in numbers"):
        read_result(path)


def test_what_hardly_shrinks_is_not_compressed(tmp_path):
    """Noise is left as it is; a clock and rare events are not. All come back to the bit."""
    noise = np.random.default_rng(1).standard_normal((3, 20_000))
    tree = small_tree()
    tree["/rolling"] = xr.Dataset(
        {
            "contact_force": variable(("law", "step"), noise, "N", "Contact force"),
            "gap": variable(("law", "step"), np.where(noise > 1.0, noise, 0.0), "m", "Gap"),
            "time": variable("step", np.arange(20_000) * 1e-5, "s", "Time"),
            "flags": variable("step", np.arange(20_000) // 7000, "1", "Flags"),
            "none": variable(("no", "step"), np.empty((0, 20_000)), "1", "Nothing"),
        }
    )
    path = save(tree, tmp_path / "run.nc")
    xr.testing.assert_identical(read_result(path), tree)
    with h5netcdf.File(path) as file:
        kept = file["rolling"].variables
        assert {name: kept[name].compression for name in ("contact_force", "gap", "time", "flags")} == {
            "contact_force": None,
            "gap": "gzip",
            "time": "gzip",
            "flags": "gzip",
        }
        assert all(item.fletcher32 for name, item in kept.items() if name != "none")


def test_a_folder_stands_for_its_run(tmp_path):
    save(small_tree(), tmp_path / "run.nc")
    xr.testing.assert_identical(asperity.open_result(tmp_path), Result.of(small_tree()))


def test_the_file_is_closed_after_loading(tmp_path):
    path = save(small_tree(), tmp_path / "run.nc")
    tree = read_result(path)
    path.unlink()
    save(small_tree(), path)
    assert tree["rolling/contact_force"].values[1, 4] == 9.0


def test_a_variable_without_units_is_refused_and_nothing_written(tmp_path):
    bare = xr.DataTree.from_dict({"/contact": xr.Dataset({"force": ("approach", [1.0])})})
    with pytest.raises(ValueError, match="/contact/force"):
        checked(bare)
    with pytest.raises(ValueError, match="without units"):
        save(bare, tmp_path / "run.nc")
    assert list(tmp_path.iterdir()) == []


def test_a_result_that_fails_to_be_written_leaves_the_old_one(tmp_path):
    path = save(small_tree(), tmp_path / "run.nc")
    broken = small_tree()
    broken.attrs["case"] = object()
    with pytest.raises(TypeError):
        save(broken, path)
    xr.testing.assert_identical(read_result(path), small_tree())
    assert [entry.name for entry in tmp_path.iterdir()] == ["run.nc"]


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(InputError, match=r"absent\.nc: received no such file"):
        read_result(tmp_path / "absent.nc")


def test_a_text_file_is_refused(tmp_path):
    (tmp_path / "run.nc").write_text("time, force")
    with pytest.raises(InputError, match="not netCDF-4"):
        read_result(tmp_path / "run.nc")


def test_a_truncated_file_is_refused(tmp_path):
    path = save(small_tree(), tmp_path / "run.nc")
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    with pytest.raises(InputError, match="a damaged file"):
        read_result(path)


def test_a_netcdf_file_of_another_kind_is_refused(tmp_path):
    xr.Dataset({"force": ("time", [1.0])}).to_netcdf(tmp_path / "run.nc", engine="h5netcdf")
    with pytest.raises(InputError, match="of another kind"):
        read_result(tmp_path / "run.nc")


@pytest.mark.parametrize(
    ("version", "remedy"),
    [
        (VERSION + 1, r"Update asperity\."),
        (VERSION - 1, r"Run its case again, or read it with asperity '0\.0\.9'\."),
        (None, r"Run its case again"),
        ("one", "Run its case again"),
    ],
)
def test_a_result_of_another_schema_is_refused_with_what_to_do(tmp_path, version, remedy):
    tree = small_tree()
    tree.attrs |= {"schema_version": version, "asperity_version": "0.0.9"}
    if version is None:
        del tree.attrs["schema_version"]
    with pytest.raises(InputError, match=f"allowed: schema version {VERSION}.*{remedy}"):
        read_result(save(tree, tmp_path / "run.nc"))


def test_a_file_too_large_is_refused(tmp_path, monkeypatch):
    path = save(small_tree(), tmp_path / "run.nc")
    monkeypatch.setattr("asperity.results.LARGEST_FILE", 10)
    with pytest.raises(InputError, match="GiB"):
        read_result(path)


def test_the_case_is_read_alone(tmp_path):
    path = save(small_tree(), tmp_path / "run.nc")
    assert case_text(path) == "kind = 'ball-on-beam'  # µm"


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no such pipes")
def test_a_pipe_is_no_result(tmp_path):
    os.mkfifo(tmp_path / "run.nc")
    for read in (case_text, read_result):
        with pytest.raises(InputError, match="a pipe or a device, which may never end"):
            read(tmp_path / "run.nc")


@pytest.mark.parametrize("content", [b"time, force", b"\x89HDF\r\n\x1a\n and no more"])
def test_a_file_without_a_case_is_refused(tmp_path, content):
    (tmp_path / "run.nc").write_bytes(content)
    with pytest.raises(InputError, match=r"not netCDF-4|a damaged file"):
        case_text(tmp_path / "run.nc")
    xr.Dataset({"force": ("time", [1.0])}).to_netcdf(tmp_path / "other.nc", engine="h5netcdf")
    with pytest.raises(InputError, match="without a case"):
        case_text(tmp_path / "other.nc")
