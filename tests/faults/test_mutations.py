"""Valid files, mutated from a fixed seed, and random legal cases: a result or one message comes out."""

import random
from contextlib import suppress
from copy import deepcopy

import h5netcdf
import numpy as np
import pytest
from program import LONG, in_time
from surface_files import npy, sdf_ascii, sdf_binary, x3p, zipped

import asperity
from asperity.case.any_case import entries
from asperity.case.cases import case_class, case_of, parse_case
from asperity.errors import AsperityError, ComputationError, InputError
from asperity.parameters import Choice, Number, Quantity, limits_in
from asperity.running import prepare_case
from asperity.surfaces.readers import read_surface
from asperity.units import quantity
from small_cases import unmarked

MUTATIONS = 100_000 if LONG else 250
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
    b"nan", b"inf", b"-1", b"1e400", b"0x10", b"1_0", b"\x00", b"\xff\xfe", b"]" * 50, b'"', b"9" * 400, b"/",
]  # fmt: skip


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


CELLS = [[f"{v:g}" for v in row] for row in HEIGHTS.T]
POINTS = "".join(f"{x} {y} {HEIGHTS[x, y]:g}\n" for x in range(3) for y in range(4))
SURFACES = {  # valid files of all formats that are read here
    "binary.sdf": sdf_binary(HEIGHTS, 5),
    "ascii.sdf": sdf_ascii(CELLS),
    "a.x3p": x3p([HEIGHTS], kind="F"),
    "stored.x3p": x3p([HEIGHTS], compress=False),
    "a.npz": zipped(("z.npy", npy(HEIGHTS)), ("pixel.npy", npy(2.0))),
    "a.npy": npy(HEIGHTS),
    "matrix.csv": "\n".join(";".join(row) for row in CELLS).encode(),
    "points.txt": f"x (mm) y (mm) z (um)\n{POINTS}".encode(),
}


@pytest.mark.parametrize("name", SURFACES)
@pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")
def test_mutated_surfaces(tmp_path, name):
    file, source = tmp_path / name, random.Random(name)
    hints = {} if file.suffix in (".sdf", ".x3p") or name == "points.txt" else HINTS
    for _ in range(MUTATIONS):
        file.write_bytes(mutated(SURFACES[name], source))
        with in_time(SECONDS):
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
        with in_time(SECONDS):
            try:
                case = parse_case(text, tmp_path / "case.toml")
            except AsperityError:
                continue
        assert case.kind == "ball-on-beam"


@pytest.mark.usefixtures("opened_apart")
def test_mutated_netcdf(tmp_path):
    """HDF5 may hang or end its process: it has one of its own, and the program says so."""
    file = tmp_path / "a.nc"
    with h5netcdf.File(file, "w") as made:
        made.dimensions = {"x": 3, "y": 4}
        made.create_variable("z", ("x", "y"), data=HEIGHTS, fletcher32=True).attrs["units"] = "um"
    whole, source = file.read_bytes(), random.Random("netcdf")
    for _ in range(4000 if LONG else 8):
        file.write_bytes(mutated(whole, source))
        with suppress(InputError):
            assert not np.isinf(read_surface(file, **HINTS).heights).any()


# --- random cases from the schema

ROUGH = {
    "duration": "20 ms",
    "settling": "10 ms",
    "surface": {"rms": "0.2 um", "shortest": "50 um"},
    "contact": {"samples": 1, "spacing": "20 um"},
}
SHORT = {
    "ball-on-beam": ROUGH,
    "wheel-on-rail": ROUGH | {"surface": {"spectrum": "iso3095"}, "contact": {"samples": 1}},
    "bodies": ROUGH | {"body": {"positions": ["0 m", "0.2 m"], "load": "20 N"}},
}
LAWS = ["areal", "shifted", "printed", "table", "hertz", "linear", "linear-filtered", "hertz-filtered"]
LEFT = (
    "duration", "settling", "laws", "kind", "seed", "samples", "window", "spacing", "time_step",
    "sleeper_spacing",
)  # fmt: skip
"""Keys that decide how long a case takes."""


def drawn(entry, source):
    """A value of a key: near its default mostly, at a limit of what is plausible now and then; or None."""
    kind, default = entry.key.kind, entry.key.default
    if isinstance(kind, Choice):
        return source.choice(kind.known)
    if isinstance(kind, Number) and not kind.whole and isinstance(default, int | float):
        low, high = kind.at_least or kind.above or 0.0, kind.at_most or 10.0
        return source.choice([low, high, source.uniform(low, high), 0.5 * default])
    within = entry.key.within
    if not isinstance(kind, Quantity) or not within:
        return None
    limits = [quantity(limit, kind.dimension) for limit in limits_in(within)[:2]]
    example = entry.key.written_example
    if not isinstance(example, str) or example == "inf":
        return None
    value = quantity(example, kind.dimension) * 10.0 ** source.uniform(-0.7, 0.7)
    if source.random() < 0.1:
        value = source.choice(limits)
    return f"{min(max(value, limits[0]), limits[1])!r} {kind.dimension}"


def random_case(source):
    kind = source.choice(list(SHORT))
    case = deepcopy(SHORT[kind]) | {
        "kind": kind,
        "laws": source.sample(LAWS, 2),
        "seed": source.randrange(100),
    }
    known = [entry for entry in entries(case_class(kind)) if entry.name not in LEFT]
    for entry in source.sample(known, source.randint(1, 5)):
        section, _, name = entry.dotted.rpartition(".")
        value = drawn(entry, source)
        if value is not None:
            (case.setdefault(section, {}) if section else case)[name] = value
    return case


@pytest.mark.parametrize("seed", range(300) if LONG else (4,))
@pytest.mark.filterwarnings("ignore")
def test_a_random_case_is_computed_or_refused(seed, own_cache):
    source = random.Random(seed)
    for case in (random_case(source) for _ in range(50)):
        with suppress(AsperityError):
            case_of(case)
            break
    try:
        prepared = prepare_case(case_of(case))
    except AsperityError as error:
        assert len(str(error)) < 2000, case  # noqa: PT017 (either is right)
        return
    try:  # what a check passes a run does not refuse, but where the motion itself cannot be
        tree = asperity.run(prepared)
    except ComputationError as error:
        assert len(str(error)) < 2000, case  # noqa: PT017
        return
    assert list(unmarked(tree)) == [], case
    assert np.isfinite(tree["rolling/contact_force"].values).all(), case
