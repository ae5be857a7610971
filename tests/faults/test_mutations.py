"""Valid files, mutated from a fixed seed: a surface, a table, a case or one message comes out, in time."""

import random
import signal
import subprocess
import sys
import warnings
from contextlib import contextmanager, suppress
from pathlib import Path

import h5netcdf
import numpy as np
import pytest
from program import LONG

from asperity.case.cases import parse_case
from asperity.errors import AsperityError, InputError, PhysicsWarning
from asperity.results import read_result, save, variable
from asperity.sandbox import MEMORY
from asperity.schema import VERSION
from asperity.surfaces.readers import netcdf, read_surface
from asperity.surfaces.readers.hints import checked_hints

sys.path.insert(0, str(Path(__file__).parents[1] / "surfaces"))
from surface_files import sdf_ascii, sdf_binary, x3p

MUTATIONS = 100_000 if LONG else 1500
SECONDS = 5
HINTS = {"height_unit": "um", "pixel": "2 um"}
HEIGHTS = np.arange(12.0).reshape(3, 4)
CASE = """
kind = "ball-on-beam"
speed = "2 m/s"
laws = ["hertz", "linear"]
[surface]
rms = "0.3 um"
[ball]
material = { youngs_modulus = "72 GPa", poisson_ratio = 0.33, density = "2700 kg/m^3" }
[beam]
sensors = ["0.2 m", "0.5 m"]
"""
WORDS = [
    b"nan",
    b"inf",
    b"-1",
    b"1e400",
    b"0x10",
    b"1_0",
    b"\x00",
    b"\xff\xfe",
    b"]" * 50,
    b'"',
    b"9" * 400,
    b"/",
]


@contextmanager
def in_time():
    """Fail where a reader hangs."""
    if not hasattr(signal, "setitimer"):
        yield
        return

    def late(number, frame):
        raise TimeoutError(f"more than {SECONDS} s")

    before = signal.signal(signal.SIGALRM, late)
    signal.setitimer(signal.ITIMER_REAL, SECONDS)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def mutated(contents, source):
    """Flip bits, cut, repeat, exchange or insert, once to four times."""
    data = bytearray(contents)
    for _ in range(source.randint(1, 4)):
        place = source.randrange(len(data) + 1)
        length = source.choice((1, 2, 4, 8, 64))
        kind = source.randrange(6)
        if kind == 0 and place < len(data):
            data[place] ^= 1 << source.randrange(8)
        elif kind == 1:
            del data[place : place + length]
        elif kind == 2:
            data[place:place] = data[place : place + length] * source.choice((1, 2, 30))
        elif kind == 3:
            data[place : place + length] = bytes(source.choice((0, 255)) for _ in range(length))
        elif kind == 4:
            data[place:place] = source.choice(WORDS)
        else:
            del data[place:]
        data = data or bytearray(b"\n")
    return bytes(data)


def surfaces(folder):
    """Valid files of all formats that are read here."""
    words = [[f"{v:g}" for v in row] for row in HEIGHTS.T]
    np.savez(folder / "a.npz", z=HEIGHTS, pixel=2.0)
    np.save(folder / "a.npy", HEIGHTS)
    points = [f"{x} {y} {HEIGHTS[x, y]:g}" for x in range(3) for y in range(4)]
    return {
        "binary.sdf": sdf_binary(HEIGHTS, 5),
        "ascii.sdf": sdf_ascii(words),
        "a.x3p": x3p([HEIGHTS], kind="F"),
        "stored.x3p": x3p([HEIGHTS], compress=False),
        "a.npz": (folder / "a.npz").read_bytes(),
        "a.npy": (folder / "a.npy").read_bytes(),
        "matrix.csv": "\n".join(";".join(row) for row in words).encode(),
        "points.txt": ("x (mm) y (mm) z (um)\n" + "\n".join(points)).encode(),
    }


@pytest.mark.parametrize(
    "name",
    ["binary.sdf", "ascii.sdf", "a.x3p", "stored.x3p", "a.npz", "a.npy", "matrix.csv", "points.txt"],
)
def test_mutated_surfaces(tmp_path, name):
    contents, source = surfaces(tmp_path)[name], random.Random(name)
    file = tmp_path / f"mutated-{name}"
    hints = {} if file.suffix in (".sdf", ".x3p") or name == "points.txt" else HINTS
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PhysicsWarning)
        for _ in range(MUTATIONS):
            file.write_bytes(mutated(contents, source))
            with in_time():
                try:
                    surface = read_surface(file, **hints)
                except AsperityError as error:
                    assert len(str(error)) < 2000, error  # noqa: PT017 (either is right)
                    continue
            assert not np.isinf(surface.heights).any()


def test_mutated_cases(tmp_path):
    source = random.Random("case")
    for _ in range(MUTATIONS):
        text = mutated(CASE.encode(), source).decode("utf-8", errors="surrogateescape")
        with in_time():
            try:
                case = parse_case(text, tmp_path / "case.toml")
            except AsperityError:
                continue
        assert case.kind == "ball-on-beam"


def read_many(folder, first):
    """Read mutations of a netCDF file from a number on, each told before, where the process may be lost."""
    import resource

    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    contents, hints = (folder / "whole.nc").read_bytes(), checked_hints(**HINTS)
    for number in range(first, MUTATIONS):
        file = folder / f"mutated{number}.nc"
        file.write_bytes(mutated(contents, random.Random(f"netcdf {number}")))
        print(number, flush=True)
        signal.setitimer(signal.ITIMER_REAL, SECONDS)  # ends the process, wherever in HDF5 it is
        with suppress(AsperityError):
            assert not any(np.isinf(surface.heights).any() for surface in netcdf.read(file, hints))
        signal.setitimer(signal.ITIMER_REAL, 0)
        file.unlink()


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="there is no such alarm")
def test_mutated_netcdf(tmp_path):
    """Where HDF5 hangs or ends its process, the program says so."""
    with h5netcdf.File(tmp_path / "whole.nc", "w") as made:
        made.dimensions = {"x": 3, "y": 4}
        made.create_variable("z", ("x", "y"), data=HEIGHTS, fletcher32=True).attrs["units"] = "um"
    places = [str(Path(__file__).parent), str(tmp_path)]
    code = "import sys, pathlib; sys.path.insert(0, sys.argv[1]); from test_mutations import read_many; "
    code += "read_many(pathlib.Path(sys.argv[2]), int(sys.argv[3]))"
    first, lost = 0, {}
    while True:
        done = subprocess.run(
            [sys.executable, "-c", code, *places, str(first)], capture_output=True, text=True, check=False
        )
        if done.returncode == 0:
            break
        assert done.returncode < 0, done.stderr
        number = int(done.stdout.split()[-1])
        first = number + 1
        lost.setdefault(done.returncode, []).append(tmp_path / f"mutated{number}.nc")
    print({code: len(files) for code, files in lost.items()})
    for files in lost.values():
        for file in files[:2]:
            with pytest.raises(InputError, match=r"a file that (takes more than|ends the program)"):
                read_surface(file, **HINTS)


def test_no_damage_of_a_result_goes_unseen(tmp_path):
    """Each byte class of ``run.nc``: superblock, headers, attributes, data, and the seal itself."""
    import xarray

    force = variable("time", np.random.default_rng(1).normal(size=2000), "N", "force")
    groups = {f"/{name}": xarray.Dataset() for name in ("scenario", "surface", "contact", "spectra")}
    groups["/rolling"] = xarray.Dataset({"contact_force": force})
    groups["/"] = xarray.Dataset(
        attrs={"asperity_version": "1", "schema_version": VERSION, "case": "kind", "warnings": "[]"}
    )
    file = save(xarray.DataTree.from_dict(groups), tmp_path / "run.nc")
    whole, source = file.read_bytes(), random.Random("run")
    for place in range(0, len(whole), 7 if LONG else 211):
        data = bytearray(whole)
        data[place] ^= 1 << source.randrange(8)
        file.write_bytes(data)
        if place >= len(whole) - 80 or place < 8:  # the seal's own words, or the signature
            continue
        with pytest.raises(AsperityError, match="a damaged file: its digest does not fit its contents"):
            read_result(file)
    file.write_bytes(whole)
    assert read_result(file)["rolling/contact_force"].size == 2000
