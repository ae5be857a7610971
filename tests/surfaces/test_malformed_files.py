"""Hostile, damaged and wrong files end in one clear message, before anything large is allocated."""

import io
import os
import pickle
import struct
import sys
import tracemalloc

import h5netcdf  # noqa: F401  what it takes itself is not what a file takes
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.io import savemat
from surface_files import npy, sdf_ascii, sdf_binary, x3p, x3p_xml, zipped

from asperity.errors import InputError
from asperity.surfaces.readers import guards, read_surface

STORED = np.add.outer(np.arange(3), 10 * np.arange(4))  # (y, x)
HEIGHTS = 1e-9 * STORED.T
HINTS = {"height_unit": "um", "pixel": "1 um"}
WORDS = [["1", "2"], ["3", "4"]]
IDENTITY = "".join(f"<r{i}{j}>{int(i == j)}</r{i}{j}>" for i in "123" for j in "123")
LAUGHS = '<!DOCTYPE l [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;">]>'
EXTERNAL = '<!doctype l [<!ENTITY a SYSTEM "file:///etc/passwd">]>'


def write(path, data):
    path.write_bytes(data)
    return path


def claiming(shape, data=b""):
    """A npy file whose header says so."""
    header = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}\n".encode()
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header + data


def xml(main):
    """An X3P archive with this record of 3 x 4 points."""
    return zipped(("main.xml", main), ("bindata/data.bin", bytes(96)))


class Bomb:
    def __reduce__(self):
        return (os.abort, ())


def pickled():
    objects = np.empty(2, dtype=object)
    objects[:] = [Bomb(), Bomb()]
    return npy(objects, allow_pickle=True)


def encrypted():
    data = bytearray(zipped(("a.npy", npy(HEIGHTS))))
    data[data.index(b"PK\x01\x02") + 8] |= 1  # the flag in the central directory
    return bytes(data)


UNPICKLED = "an array of type object; allowed: numbers; Python objects are never unpickled"
MALFORMED = [  # file, its contents, or what is changed in an X3P file, and what the message says
    ("a.txt", b"", "received an empty file"),
    *(
        (f"a.{kind}", b"MZ\x90\x00 a program", r"a file that starts with b'MZ.*correct the extension")
        for kind in ("npy", "npz", "nc", "sdf", "x3p")
    ),
    # more points than bytes
    ("a.sdf", sdf_binary(STORED, 7, points=65535, profiles=65535), r"points in \d+ bytes"),
    ("a.sdf", sdf_ascii(WORDS, NumPoints=50000, NumProfiles=20000), r"points in \d+ bytes"),
    ("a.x3p", {"sizes": (50000, 20000, 1)}, r"points in \d+ bytes"),
    ("a.npy", claiming((50000, 20000)), r"points in \d+ bytes"),
    ("a.npz", zipped(("a.npy", claiming((10**9,)))), r"points in \d+ bytes"),
    # archives
    ("a.npz", lambda: zipped(("a.npy", bytes(2**25))), r"that unpack to \d+; allowed: at most 200 times"),
    ("a.x3p", xml(x3p_xml((3, 4, 1)).replace("bindata", "../secret")), r"no member '\.\./secret/data\.bin'"),
    ("a.x3p", xml(x3p_xml((3, 4, 1), mask=True)), r"no member 'bindata/valid\.bin'; allowed: one of: main"),
    ("a.npz", encrypted(), "encrypted, password required .* an intact npz file"),
    ("a.x3p", x3p([STORED])[:400], "a zip archive without its directory"),
    *(
        ("a.x3p", xml(x3p_xml((3, 4, 1), preamble=text).encode(encoding)), "an XML document type or entity")
        for text in (LAUGHS, EXTERNAL)
        for encoding in ("utf-8", "utf-16")
    ),
    *(
        ("a.x3p", xml(main), "an intact X3P file")
        for main in (b"<a><b></a>", b"\xff\x00\xff", b"", b"+ADwAIQ-DOCTYPE")
    ),
    ("a.x3p", xml(b"<a/>"), r"SizeZ in .* received nothing"),
    # arrays
    ("a.npy", pickled(), UNPICKLED),
    ("a.npz", zipped(("a.npy", pickled())), UNPICKLED),
    ("a.npy", pickle.dumps(Bomb()), "a file that starts with"),
    ("a.npy", npy(HEIGHTS)[:20], "an intact npy file"),
    ("a.npy", npy(HEIGHTS)[:-1], "at least 96 bytes for so many points"),
    ("a.npy", claiming("(2, -3)", bytes(48)), "at least one point along each axis"),
    ("a.npy", claiming("(2, 'a')", bytes(48)), "an intact npy file"),
    ("a.npy", claiming("__import__('os').abort()"), "an intact npy file"),
    ("a.npy", npy(HEIGHTS).replace(b"NUMPY\x01", b"NUMPY\x09"), r"npy version \(9, 0\); allowed: version 1"),
    ("a.npy", npy(np.array([["a", "b"], ["c", "d"]])), "data of type <U1; allowed: real numbers"),
    ("a.npy", npy(np.zeros((2, 2), dtype=complex)), "complex128"),
    ("a.npy", npy(np.zeros((2, 2, 2, 2))), r"an array of shape \(2, 2, 2, 2\)"),
    ("a.npy", npy(np.float64(1.0)), r"an array of shape \(\)"),
    ("a.npy", npy(np.zeros((0, 3))), "at least one point along each axis"),
    ("a.npy", npy(np.full((2, 2), np.nan)), "every point is missing"),
    ("a.npy", npy(np.full((2, 2), np.inf)), "infinite"),
    # SDF
    ("a.sdf", sdf_binary(STORED, 5)[:40], "a header of 81 bytes"),
    ("a.sdf", sdf_binary(STORED, 5)[:-1], "at least 24 bytes for so many points"),
    ("a.sdf", sdf_binary(STORED, 5, compression=1), "compressed data"),
    ("a.sdf", sdf_binary(STORED, 5, unit=0.0), "Zscale in a.sdf: received 0.0; allowed: the height of one"),
    ("a.sdf", sdf_binary(STORED, 5, unit=np.nan), "Zscale in a.sdf: received 'nan'; allowed: a finite num"),
    ("a.sdf", sdf_binary(STORED, 5, steps=(-1e-6, 1e-6)), "spacing of the height map"),
    ("a.sdf", sdf_binary(STORED, 5, steps=(np.inf, 1e-6)), "Xscale"),
    ("a.sdf", sdf_binary(STORED, 5, points=0), "NumPoints"),
    ("a.sdf", sdf_ascii([["1", "2"], ["3", "x"]]), "could not convert"),
    ("a.sdf", sdf_ascii([["1", "2"], ["3"]]), "received 3 heights; allowed: the 4 that its header claims"),
    ("a.sdf", sdf_ascii(WORDS, NumPoints=None), "NumPoints in a.sdf: received nothing"),
    ("a.sdf", sdf_ascii(WORDS, NumPoints="2.5"), "NumPoints in a.sdf: received 2.5; allowed: a whole number"),
    ("a.sdf", sdf_ascii(WORDS, DataType=8), "allowed: 0 to 7"),
    ("a.sdf", sdf_ascii(WORDS, Compression=1), "compressed data"),
    # X3P
    ("a.x3p", {"sizes": (4, 4, 1)}, "at least 128 bytes for so many points"),
    ("a.x3p", {"sizes": (4, 0, 1)}, "SizeY"),
    ("a.x3p", {"sizes": (4, "many", 1)}, "SizeY in a.x3p: received 'many'"),
    ("a.x3p", {"steps": ("0", "1e-6")}, r"increment of CX in a.x3p: received 0.0; allowed: a length above"),
    ("a.x3p", {"steps": ("", "1e-6")}, "increment of CX in a.x3p: received nothing"),
    ("a.x3p", {"steps": ("1e-6", "")}, "spacing of the height map"),
    ("a.x3p", {"height": ("0", "")}, "increment of CZ"),
    ("a.x3p", {"link": False}, "no member ''"),
    ("a.x3p", {"rotation": f"<Rotation>{IDENTITY.replace('0', '0.1')}</Rotation>"}, "a rotation"),
    ("a.x3p", {"axes": ("A", "I")}, "a.x3p: received points with a CX each; allowed: a regular grid"),
    ("a.x3p", xml(x3p_xml((3, 4, 1), kind="Q")), r"data type of CZ in a\.x3p: received 'Q'; allowed: I, L"),
]


@pytest.mark.parametrize(("name", "contents", "message"), MALFORMED)
def test_a_malformed_file_ends_in_a_message(tmp_path, name, contents, message):
    if isinstance(contents, dict):
        contents = x3p([HEIGHTS.T], **contents)
    file = write(tmp_path / name, contents() if callable(contents) else contents)
    tracemalloc.start()
    with pytest.raises(InputError, match=message):
        read_surface(file, **({} if file.suffix in (".sdf", ".x3p") else HINTS))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 5e6


@pytest.mark.parametrize(("limit", "name", "contents", "message"), [
    ("MAX_FILE_BYTES", "a.txt", b"1.5\n2.5\n", r"size of a\.txt: received 8 bytes; allowed: at most 2 byt"),
    ("MAX_XML_BYTES", "a.x3p", x3p([STORED]), r"more than 2 bytes in main\.xml"),
])  # fmt: skip
def test_a_file_beyond_a_limit(tmp_path, monkeypatch, limit, name, contents, message):
    monkeypatch.setattr(guards, limit, 2)
    with pytest.raises(InputError, match=message):
        read_surface(write(tmp_path / name, contents))


def test_paths_at_which_no_file_is(tmp_path):
    with pytest.raises(InputError, match=r"received a folder; .*Name a file inside it"):
        read_surface(tmp_path)
    with pytest.raises(InputError, match=r"null\\x00character\.txt: received a path that cannot be followed"):
        read_surface("null\0character.txt")


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="the superuser reads every file")
def test_file_without_permission(tmp_path):
    file = write(tmp_path / "a.txt", b"1.5\n2.5\n")
    file.chmod(0)
    with pytest.raises(InputError, match="a file that cannot be read"):
        read_surface(file)


@pytest.mark.usefixtures("opened_apart")
@pytest.mark.parametrize(("code", "seconds", "message"), [
    ("import os; os.abort()", 20.0, r"a file that ends the program that opens it"),
    ("import numpy; numpy.ones(2**31)", 20.0, r"(MemoryError|more than 8 GiB of memory).* while it was"),
    # what is limited is the processor time: a file that only has to wait is read on
    ("import time; time.sleep(1.5); raise KeyError('read on')", 1.0, r"a format .*KeyError \('read on'\)"),
])  # fmt: skip
def test_a_library_that_fails_on_a_hostile_file(tmp_path, monkeypatch, code, seconds, message):
    (tmp_path / "SurfaceTopography.py").write_text(f"def open_topography(path):\n    {code}\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr("asperity.sandbox.SECONDS", seconds)
    with pytest.raises(InputError, match=rf"a\.plu: received {message}"):
        read_surface(write(tmp_path / "a.plu", b"content"))


@pytest.mark.usefixtures("opened_apart")
def test_what_a_library_does_not_know_is_no_damaged_file(tmp_path, monkeypatch):
    """And all that it has tried is not told."""
    code = "class CannotDetectFileFormat(Exception): pass\ndef open_topography(path):\n"
    code += "    raise CannotDetectFileFormat('tried: ' + 40 * 'a, ')\n"
    (tmp_path / "SurfaceTopography.py").write_text(code)
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(InputError) as caught:
        read_surface(write(tmp_path / "a.plu", b"content"))
    assert "received a format that SurfaceTopography does not read; allowed: text, CSV" in str(caught.value)
    assert not {"tried", "damaged"} & set(str(caught.value).replace(":", " ").split())


def claims_in_matlab():
    """An array of zeros that is packed to a thousandth."""
    stream = io.BytesIO()
    savemat(stream, {"z": np.zeros((3000, 3000))}, do_compression=True)
    return stream.getvalue()


@pytest.mark.parametrize(("name", "contents", "message"), [
    ("a.mat", b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM" + 40 * b"\xff", "an intact MATLAB"),
    ("a.mat", claims_in_matlab, "3000 x 3000 points in .* bytes, which unpack to 72000000; allowed: at most"),
    ("a.nc", b"CDF\x01" + 40 * b"\xff", "an intact netCDF file"),
    ("a.nc", b"CDF\x05" + 40 * b"\x00", "netCDF of 64-bit data .* nccopy"),
    ("a.dat", b"\x88\x1b\x03\x6f" + 900 * b"\x00", "a .dat file, which asperity does not read itself"),
])  # fmt: skip
def test_binary_files_that_hold_no_heights(tmp_path, monkeypatch, name, contents, message):
    monkeypatch.setitem(sys.modules, "SurfaceTopography", None)
    with pytest.raises(InputError, match=message):
        read_surface(write(tmp_path / name, contents() if callable(contents) else contents), **HINTS)


@pytest.mark.filterwarnings("ignore::asperity.errors.MissingPointsWarning")
@settings(max_examples=150)
@given(flips=st.lists(st.tuples(st.integers(0, 10**6), st.integers(0, 7)), min_size=1, max_size=4))
def test_flipped_bits_behind_the_checksum_of_x3p(tmp_path_factory, flips):
    """A surface or an `InputError`; `faults` mutates whole files, of which sums reject nearly all."""
    main = bytearray(x3p_xml((3, 4, 1)).encode())
    for place, bit in flips:
        main[place % len(main)] ^= 1 << bit
    file = tmp_path_factory.getbasetemp() / "inside.x3p"
    try:
        surface = read_surface(write(file, xml(bytes(main))))
    except InputError:
        return
    assert not np.isinf(surface.heights).any()


def test_heights_as_words_take_few_times_the_memory_of_their_numbers(tmp_path):
    """Of two digits each, as Python holds words of one letter once; words of all took half as much again."""
    file, count = tmp_path / "a.sdf", 200_000
    digits = 10 + np.arange(count) % 90
    head = f"aISO-1.0\nNumPoints = {count}\nNumProfiles = 1\nXscale = 1e-6\nYscale = 1e-6\nZscale = 1e-9\n"
    head += "Compression = 0\nDataType = 5\nCheckType = 0\n*\n"
    file.write_text(head + " ".join(str(n) for n in digits) + "\n*\n")
    tracemalloc.start()
    line = read_surface(file)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    np.testing.assert_allclose(line.heights, 1e-9 * digits, atol=1e-24)
    assert peak < 6 * 8 * count
