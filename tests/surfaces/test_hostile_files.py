"""Hostile, damaged and wrong files end in one clear message, before anything large is allocated."""

import io
import os
import pickle
import struct
import tracemalloc
import warnings
import zipfile

import h5netcdf
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from surface_files import sdf_ascii, sdf_binary, x3p, x3p_xml

from asperity.errors import InputError, MissingPointsWarning
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.readers import guards, read_surface

HEIGHTS = np.add.outer(10.0 * np.arange(4), np.arange(3))
HINTS = {"height_unit": "um", "pixel": "1 um"}
METRES = {"height_unit": 1e-6, "pixel": 1e-6}


def write(path, data):
    path.write_bytes(data)
    return path


def archive(path, members, compression=zipfile.ZIP_DEFLATED):
    with zipfile.ZipFile(path, "w", compression) as opened:
        for name, content in members:
            opened.writestr(name, content)
    return path


def npy(array, **options):
    stream = io.BytesIO()
    np.save(stream, array, **options)
    return stream.getvalue()


def npy_claiming(shape, kind="<f8", data=b""):
    header = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}\n".encode()
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header + data


# --- files that are none


def test_no_such_file(tmp_path):
    with pytest.raises(
        InputError,
        match=r"^\S*missing\.x3p: received no such file; allowed: a file with heights\. Check the path\.$",
    ):
        read_surface(tmp_path / "missing.x3p")
    with pytest.raises(InputError, match=r"received a folder; .*Name a file inside it"):
        read_surface(tmp_path)
    with pytest.raises(InputError, match=r"null\\x00character\.txt: received a path that cannot be followed"):
        read_surface("null\0character.txt")
    with pytest.raises(InputError, match="received an empty file"):
        read_surface(write(tmp_path / "a.txt", b""))


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="the superuser reads every file")
def test_file_without_permission(tmp_path):
    file = write(tmp_path / "a.txt", b"1.5\n2.5\n")
    file.chmod(0)
    with pytest.raises(InputError, match="a file that cannot be read"):
        read_surface(file)


def test_file_beyond_the_limit(tmp_path, monkeypatch):
    monkeypatch.setattr(guards, "MAX_FILE_BYTES", 10)
    with pytest.raises(InputError, match=r"size of a\.txt: received 12 bytes; allowed: at most 10 bytes"):
        read_surface(write(tmp_path / "a.txt", b"1.5\n2.5\n3.5\n"))


@pytest.mark.parametrize("extension", ["npy", "npz", "nc", "sdf", "x3p"])
def test_content_that_contradicts_the_extension(tmp_path, extension):
    with pytest.raises(InputError, match=r"a file that starts with b'MZ.*correct the extension"):
        read_surface(write(tmp_path / f"a.{extension}", b"MZ\x90\x00 a program"))


# --- claims larger than the file


def claims(tmp_path):
    yield write(tmp_path / "a.sdf", sdf_binary(HEIGHTS, 7, points=65535, profiles=65535))
    yield write(tmp_path / "b.sdf", sdf_ascii([["1", "2"], ["3", "4"]], NumPoints=50000, NumProfiles=20000))
    yield x3p(tmp_path / "a.x3p", [HEIGHTS], sizes=(50000, 20000, 1))
    yield x3p(tmp_path / "b.x3p", [HEIGHTS], sizes=(10**9, 10**9, 10**9))
    yield x3p(tmp_path / "c.x3p", [HEIGHTS], sizes=(50000, 20000, 1), link=False, datums=["1"])
    yield write(tmp_path / "a.npy", npy_claiming((50000, 20000)))
    yield write(tmp_path / "b.npy", npy_claiming((50000, 2000)))
    yield archive(tmp_path / "a.npz", [("a.npy", npy_claiming((10**9,)))])


def test_a_billion_points_in_a_kilobyte(tmp_path):
    for file in claims(tmp_path):
        assert file.stat().st_size < 3000
        tracemalloc.start()
        with pytest.raises(InputError, match=r"points in \d+ bytes"):
            read_surface(file, **({} if file.suffix in (".sdf", ".x3p") else METRES))
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert peak < 5e6, f"{file.name} made {peak} bytes"


def test_netcdf_array_that_was_never_written(tmp_path):
    with h5netcdf.File(tmp_path / "a.nc", "w") as file:
        file.dimensions = {"x": 50000, "y": 5000}
        file.create_variable("heights", ("x", "y"), "f8", chunks=(500, 500)).attrs["units"] = "m"
    with pytest.raises(InputError, match=r"50000 x 5000 points in \d+ bytes"):
        read_surface(tmp_path / "a.nc", pixel="1 um")


# --- archives


def test_zip_bomb(tmp_path):
    bomb = archive(tmp_path / "a.npz", [("a.npy", npy_claiming((2**22,), data=bytes(2**25)))])
    with pytest.raises(InputError, match=r"bytes that unpack to \d+; allowed: at most 200 times"):
        read_surface(bomb, **HINTS)
    bomb = x3p(tmp_path / "a.x3p", np.zeros((1, 2048, 2048)))
    with pytest.raises(InputError, match="bytes that unpack to"):
        read_surface(bomb)


def test_xml_of_an_archive_is_bounded(tmp_path, monkeypatch):
    monkeypatch.setattr("asperity.surfaces.readers.guards.MAX_XML_BYTES", 100)
    with pytest.raises(InputError, match=r"more than 100 bytes in main\.xml"):
        read_surface(x3p(tmp_path / "a.x3p", [HEIGHTS]))


@pytest.mark.parametrize("name", ["../evil.bin", "/etc/evil", "a/../../evil", "C:/evil", "..\\evil"])
def test_names_that_leave_the_archive(tmp_path, name):
    file = x3p(tmp_path / "a.x3p", [HEIGHTS], extra={name: b"evil"})
    with pytest.raises(InputError, match="a member named"):
        read_surface(file)


def test_link_that_leaves_the_archive(tmp_path):
    (tmp_path / "secret.bin").write_bytes(bytes(96))
    main = x3p_xml((3, 4, 1)).replace("bindata/data.bin", "../secret.bin").encode()
    with pytest.raises(InputError, match="1 x 4 x 3 points in 0 bytes"):
        read_surface(archive(tmp_path / "a.x3p", [("main.xml", main)]))


def test_missing_members(tmp_path):
    main = x3p_xml((3, 4, 1), points_md5="", valid_md5="").encode()
    members = [("main.xml", main), ("bindata/data.bin", bytes(96))]
    with pytest.raises(InputError, match=r"no member 'bindata/valid\.bin'; allowed: one of: main\.xml"):
        read_surface(archive(tmp_path / "a.x3p", members))


def test_two_members_of_one_name(tmp_path):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        file = archive(tmp_path / "a.npz", [("a.npy", npy(HEIGHTS)), ("a.npy", npy(HEIGHTS))])
    with pytest.raises(InputError, match="two members of one name"):
        read_surface(file, **HINTS)


def test_too_many_members(tmp_path, monkeypatch):
    monkeypatch.setattr(guards, "MAX_MEMBERS", 2)
    file = archive(tmp_path / "a.npz", [(f"{i}.npy", npy(HEIGHTS)) for i in range(3)])
    with pytest.raises(InputError, match="received 3 members; allowed: at most 2"):
        read_surface(file, **HINTS)


def test_encrypted_member(tmp_path):
    data = bytearray(archive(tmp_path / "a.npz", [("a.npy", npy(HEIGHTS))]).read_bytes())
    data[data.index(b"PK\x01\x02") + 8] |= 1  # the flag in the central directory
    with pytest.raises(InputError, match="the encrypted member"):
        read_surface(write(tmp_path / "b.npz", bytes(data)), **HINTS)


def test_truncated_archive(tmp_path):
    data = x3p(tmp_path / "a.x3p", [HEIGHTS]).read_bytes()
    with pytest.raises(InputError, match="a zip archive without its directory"):
        read_surface(write(tmp_path / "b.x3p", data[: len(data) // 2]))


# --- XML

LAUGHS = '<!DOCTYPE l [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]>'
EXTERNAL = '<!doctype l [<!ENTITY a SYSTEM "file:///etc/passwd">]>'


@pytest.mark.parametrize("preamble", [LAUGHS, EXTERNAL])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
def test_xml_entities(tmp_path, preamble, encoding):
    main = x3p_xml((3, 4, 1), preamble=preamble).encode(encoding)
    file = archive(tmp_path / "a.x3p", [("main.xml", main), ("bindata/data.bin", bytes(96))])
    with pytest.raises(InputError, match="an XML document type or entity"):
        read_surface(file)


@pytest.mark.parametrize("main", [b"<a><b></a>", b"\xff\x00\xff", b"", b"+ADwAIQ-DOCTYPE"])
def test_xml_that_is_none(tmp_path, main):
    with pytest.raises(InputError, match="an intact XML file"):
        read_surface(archive(tmp_path / "a.x3p", [("main.xml", main)]))


def test_xml_without_records(tmp_path):
    with pytest.raises(InputError, match=r"SizeZ in .* received nothing"):
        read_surface(archive(tmp_path / "a.x3p", [("main.xml", b"<a/>")]))


# --- pickles and malformed headers


class Bomb:
    def __reduce__(self):
        return (os.abort, ())


def test_pickles_are_never_loaded(tmp_path):
    objects = np.empty(2, dtype=object)
    objects[:] = [Bomb(), Bomb()]
    content = npy(objects, allow_pickle=True)
    message = "an array of type object; allowed: numbers; Python objects are never unpickled"
    with pytest.raises(InputError, match=message):
        read_surface(write(tmp_path / "a.npy", content), **HINTS)
    with pytest.raises(InputError, match=message):
        read_surface(archive(tmp_path / "a.npz", [("a.npy", content)]), **HINTS)
    with pytest.raises(InputError, match="a file that starts with"):
        read_surface(write(tmp_path / "b.npy", pickle.dumps(Bomb())), **HINTS)


@pytest.mark.parametrize(
    "data",
    [
        npy(HEIGHTS)[:20],
        npy(HEIGHTS)[:-1],
        npy_claiming("(2, -3)", data=bytes(48)),
        npy_claiming("(2, 'a')", data=bytes(48)),
        npy_claiming("__import__('os').abort()"),
        npy(HEIGHTS).replace(b"NUMPY\x01", b"NUMPY\x09"),
    ],
)
def test_malformed_npy(tmp_path, data):
    with pytest.raises(InputError):
        read_surface(write(tmp_path / "a.npy", data), **HINTS)


def test_truncated_netcdf(tmp_path):
    with h5netcdf.File(tmp_path / "a.nc", "w") as file:
        file.dimensions = {"x": 4, "y": 3}
        file.create_variable("heights", ("x", "y"), data=HEIGHTS).attrs["units"] = "m"
    data = (tmp_path / "a.nc").read_bytes()
    with pytest.raises(InputError, match="an intact netCDF-4 file"):
        read_surface(write(tmp_path / "b.nc", data[: len(data) // 2]), pixel="1 um")


# --- fuzz: whatever is done to a valid file, a surface or an InputError comes out


@pytest.fixture(scope="module")
def valid_files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("valid")
    np.savez(folder / "a.npz", z=HEIGHTS)
    np.save(folder / "a.npy", HEIGHTS)
    words = [[f"{v:g}" for v in row] for row in HEIGHTS.T]
    valid = np.ones(12, dtype=bool)
    files = {
        "binary.sdf": sdf_binary(HEIGHTS, 5),
        "ascii.sdf": sdf_ascii(words),
        "a.x3p": x3p(folder / "a.x3p", [HEIGHTS], kind="F").read_bytes(),
        "stored.x3p": x3p(folder / "b.x3p", [HEIGHTS], valid=valid, compress=False).read_bytes(),
        "a.npz": (folder / "a.npz").read_bytes(),
        "a.npy": (folder / "a.npy").read_bytes(),
        "a.csv": "\n".join(";".join(row) for row in words).encode(),
    }
    return folder, files


NAMES = ["binary.sdf", "ascii.sdf", "a.x3p", "stored.x3p", "a.npz", "a.npy", "a.csv"]


def survives(folder, name, data):
    file = write(folder / f"fuzzed_{name}", data)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MissingPointsWarning)
        try:
            surface = read_surface(file, **({} if file.suffix in (".sdf", ".x3p") else HINTS))
        except InputError:
            return
    assert isinstance(surface, HeightMap | Profile)
    assert not np.isinf(surface.heights).any()


@pytest.mark.parametrize("name", NAMES)
def test_valid_files_are_valid(valid_files, name):
    folder, files = valid_files
    file = write(folder / f"valid_{name}", files[name])
    surface = read_surface(file, **({} if file.suffix in (".sdf", ".x3p") else HINTS))
    assert surface.heights.size == 12


@pytest.mark.parametrize("name", NAMES)
@settings(max_examples=60)
@given(data=st.data())
def test_truncated_files(valid_files, name, data):
    folder, files = valid_files
    survives(folder, name, files[name][: data.draw(st.integers(0, len(files[name]) - 1))])


def flipped(content, data):
    content = bytearray(content)
    flips = st.tuples(st.integers(0, len(content) - 1), st.integers(0, 7))
    for place, bit in data.draw(st.lists(flips, min_size=1, max_size=4)):
        content[place] ^= 1 << bit
    return bytes(content)


@pytest.mark.parametrize("name", NAMES)
@settings(max_examples=150)
@given(data=st.data())
def test_flipped_bits(valid_files, name, data):
    folder, files = valid_files
    survives(folder, name, flipped(files[name], data))


@settings(max_examples=300)
@given(data=st.data())
def test_flipped_bits_behind_the_checksums_of_x3p(valid_files, data):
    folder, _ = valid_files
    main = flipped(x3p_xml((3, 4, 1)).encode(), data)
    members = [("main.xml", main), ("bindata/data.bin", HEIGHTS.tobytes())]
    survives(folder, "inside.x3p", archive(folder / "inside.x3p", members).read_bytes())
