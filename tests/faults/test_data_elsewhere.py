"""A file brings its own data: what refers to others is refused, and the process that opens it cannot."""

import socket
import subprocess
import sys
from pathlib import Path

import h5netcdf
import h5py
import numpy as np
import pytest
from reaching import tries

import asperity
from asperity import hdf5, sandbox
from asperity.confinement import confine
from asperity.errors import InputError
from asperity.results import save
from test_results import small_tree

SECRET = np.arange(64, dtype="<f8")


@pytest.fixture
def secret(tmp_path):
    """A file of somebody else, of which no number may be seen; HDF5 and bare numbers."""
    folder = tmp_path / "of somebody else"
    folder.mkdir()
    SECRET.tofile(folder / "bare")
    with h5py.File(folder / "whole.h5", "w") as file:
        file["heights"] = SECRET.reshape(8, 8)
    return folder


def external_storage(group, secret):
    external = [(str(secret / "bare"), 0, h5py.h5f.UNLIMITED)]
    return group.create_dataset("heights", (8, 8), "<f8", external=external)


def virtual(group, secret):
    layout = h5py.VirtualLayout((8, 8), "<f8")
    layout[:] = h5py.VirtualSource(secret / "whole.h5", "heights", (8, 8))
    return group.create_virtual_dataset("heights", layout)


def external_link(group, secret):
    group["heights"] = h5py.ExternalLink(str(secret / "whole.h5"), "/heights")


def link_through_a_soft_one(group, secret):
    """The one leads to the other, which leads out."""
    group["out"] = h5py.ExternalLink(str(secret / "whole.h5"), "/")
    group["heights"] = h5py.SoftLink("out/heights")


WAYS = [
    (external_storage, "data of 'heights' in another file"),
    (virtual, "a virtual data set 'heights', made of others"),
    (external_link, "a link 'heights' to another file"),
    (link_through_a_soft_one, "a link 'out' to another file"),
]


def as_a_map(forged):
    """What a map says of itself, beside heights that lie elsewhere."""
    scales = [forged.create_dataset(name, data=np.arange(8.0)) for name in "xy"]
    for name, scale in zip("xy", scales, strict=True):
        scale.attrs["units"] = "um"
        scale.make_scale(name)
    if isinstance(forged.get("heights", getlink=True), h5py.HardLink):
        for axis, scale in enumerate(scales):
            forged["heights"].dims[axis].attach_scale(scale)
        forged["heights"].attrs["units"] = "m"


def surface(tmp_path, way, secret):
    with h5py.File(tmp_path / "x.nc", "w") as forged:
        way(forged, secret)
        as_a_map(forged)
    return asperity.read_surface(tmp_path / "x.nc", pixel="1 um", height_unit="m")


def result(tmp_path, way, secret):
    """With a seal that fits: anybody can make one."""
    from asperity.files import atomic_write

    file = save(small_tree(), tmp_path / "run.nc")
    with h5py.File(file, "a") as forged:
        way(forged.create_group("contact/inner"), secret)
    contents = file.read_bytes()
    atomic_write(file, lambda written: written.write(contents), sealed=True)
    return asperity.open_result(file)


def modes(tmp_path, way, secret):
    with h5py.File(tmp_path / "m.nc", "w") as forged:
        way(forged, secret)
    return asperity.read_modal_structure(tmp_path / "m.nc")


def foreign(tmp_path, way, secret):
    """HDF5 of an instrument, behind bytes of its own, which a library would read."""
    with h5py.File(tmp_path / "x.h5", "w", userblock_size=1024) as forged:
        way(forged, secret)
    return asperity.read_surface(tmp_path / "x.h5")


@pytest.mark.faults
@pytest.mark.parametrize(("way", "message"), WAYS, ids=[way.__name__ for way, _ in WAYS])
@pytest.mark.parametrize("opened", [surface, result, modes, foreign])
def test_data_that_lie_in_another_file_are_refused(tmp_path, secret, opened, way, message):
    """In everything that opens HDF5; in this process, where nothing but the look at it stands guard."""
    with pytest.raises(InputError, match=f"{message}; allowed: a file that holds all of its data itself"):
        opened(tmp_path, way, secret)


def test_what_a_file_says_twice_or_of_itself_is_no_data_elsewhere(tmp_path):
    """Hard links in a circle, and soft links, also to nothing, are in the file."""
    with h5netcdf.File(tmp_path / "whole.nc", "w") as file:
        file.dimensions = {"x": 3}
        file.create_variable("heights", ("x",), data=np.arange(3.0))
    with h5py.File(tmp_path / "whole.nc", "a") as file:
        group = file.create_group("group")
        group["above"] = file["/"]
        group["again"] = file["heights"]
        group["soft"] = h5py.SoftLink("/heights")
        group["nowhere"] = h5py.SoftLink("/nothing")
    hdf5.refuse_data_elsewhere(tmp_path / "whole.nc", "whole.nc")
    line = asperity.read_surface(tmp_path / "whole.nc", array="heights", pixel="1 um", height_unit="um")
    np.testing.assert_allclose(line.heights, [0.0, 1e-6, 2e-6])


CONFINED = (
    "import sys; from asperity.confinement import confine; sys.exit(0 if confine(sys.executable) else 7)"
)


@pytest.mark.faults
def test_the_process_that_opens_a_file_can_open_no_other(tmp_path, secret, monkeypatch):
    """By the kernel, so in libraries as well; what Python needs late is found."""
    if subprocess.run([sys.executable, "-c", CONFINED], check=False).returncode == 7:
        pytest.skip("this system has no Landlock")
    monkeypatch.syspath_prepend(Path(__file__).parent)
    (tmp_path / "a.nc").write_bytes(b"content")
    with socket.create_server(("127.0.0.1", 0)) as server:
        arguments = [str(secret), server.getsockname()[1]]
        found, _ = sandbox.sandboxed(tries, tmp_path / "a.nc", arguments, source="a.nc", kind="netCDF-4")
    done = {name for name, outcome in found.items() if outcome == "done"}
    assert done - {"connected"} == {"own", "late"}, found  # connections are refused from Linux 6.7 on
    assert (tmp_path / "a.nc").read_bytes() == b"content"


def test_a_system_without_it_stays_as_it_was(monkeypatch, tmp_path):
    monkeypatch.setattr(sys, "platform", "darwin")
    assert not confine(str(tmp_path / "a.nc"))
    (tmp_path / "b.nc").touch()


@pytest.mark.parametrize("target", ["/nowhere", "/round", "deeper/heights"])
def test_a_soft_link_that_leads_nowhere_is_called_so(tmp_path, target):
    """It damages nothing else; and one that leads to what is there is followed."""
    file = tmp_path / "linked.nc"
    heights = 1e-6 * np.random.default_rng(0).normal(size=(30, 40))
    with h5py.File(file, "w") as opened:
        opened["heights"] = heights
        opened["again"] = h5py.SoftLink("/heights")
        opened["round"] = h5py.SoftLink(target)
    with pytest.raises(
        InputError, match=r"received a link 'round' that leads nowhere; .* del file\['round'\]"
    ):
        asperity.read_surface(file, array="heights", height_unit="m", pixel="1 um")
    with h5py.File(file, "a") as opened:
        del opened["round"]
    read = asperity.read_surface(file, array="again", height_unit="m", pixel="1 um")
    np.testing.assert_array_equal(read.heights, heights)
