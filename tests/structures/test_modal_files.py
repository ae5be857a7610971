"""Modes from files: tables, netCDF and universal files; units, directions, and what is refused."""

import dataclasses
import importlib.util
from pathlib import Path

import h5netcdf
import numpy as np
import pytest
from numpy.testing import assert_allclose

from asperity.errors import InputError
from asperity.structures import beam, modal, modal_files
from refusals import refusals

BEAM = beam.Beam(1.0, 100.0, 4.0, highest_frequency=400.0, loss_factor=0.02)
X = np.linspace(0.0, 1.0, 41)
TABLE = modal.ModalStructure(X, BEAM.natural_frequencies, BEAM.damping_ratios, BEAM.shapes(X)[0])
MODES = len(TABLE.frequencies)
F = np.array([5.0, 31.0, 200.0])
RESIDUAL = 1e-6 * np.sin(np.pi * X) ** 2


def the_same(found, rtol):
    bare = dataclasses.replace(found, residual_flexibility=None)
    assert_allclose(bare.receptance(F, 0.31, 0.62), TABLE.receptance(F, 0.31, 0.62), rtol=rtol)
    assert found.extent == pytest.approx((0.0, 1.0))


def text_of(separator=", ", scale=1.0):
    """In kHz, mm and µm/N; of another scale with modal masses, g."""
    table = np.column_stack([1e3 * X, scale * TABLE.mode_shapes, 1e6 * RESIDUAL])
    rows = [["# a beam"], ["frequency (kHz)", *(TABLE.frequencies / 1e3)], ["damping ratio", *TABLE.damping]]
    if scale != 1.0:
        rows.append(["modal mass (g)", *np.full(MODES, 1e3 * scale**2)])
    rows.append(["position (mm)", *(f"mode {i}" for i in range(MODES)), "residual flexibility (um/N)"])
    cells = [
        [cell if isinstance(cell, str) else repr(float(cell)) for cell in row] for row in [*rows, *table]
    ]
    return "\n".join(map(separator.join, cells))


@pytest.mark.parametrize(
    "text", [text_of(), text_of(" "), text_of("\t"), text_of("; ", scale=3.0).replace(".", ",")]
)
def test_a_text_table(tmp_path, text):
    (tmp_path / "beam.csv").write_text(text)
    found = modal_files.read_modal_structure(tmp_path / "beam.csv")
    the_same(found, 1e-12)
    assert_allclose(found.residual_flexibility, RESIDUAL, rtol=1e-12)
    with pytest.raises(InputError, match=r"force: received 'z'; allowed: nothing: it is for universal"):
        modal_files.read_modal_structure(tmp_path / "beam.csv", force="z")


def test_the_table_of_the_documentation_is_one(tmp_path):
    page = (Path(__file__).parents[2] / "docs" / "beams" / "bodies.md").read_text(encoding="utf-8")
    (tmp_path / "page.csv").write_text(page.partition("```text\n")[2].partition("```")[0])
    found = modal_files.read_modal_structure(tmp_path / "page.csv")
    assert found.frequencies.tolist() == [52.4, 209.8]
    assert found.extent == (0.0, 1.0)
    assert found.residual_flexibility[4] == pytest.approx(69e-9, rel=1e-6, abs=0.0)
    assert found.mode_shapes[4].tolist() == [0.714, 0.0]


def netcdf(path, *, without=(), **changed):
    """Write variables by name, each its dimensions, values and unit."""
    variables = {
        "positions": (("position",), 1e3 * X, "mm"),
        "natural_frequencies": (("mode",), TABLE.frequencies, "Hz"),
        "damping_ratios": (("mode",), TABLE.damping, ""),
        "mode_shapes": (("position", "mode"), TABLE.mode_shapes, ""),
        "residual_flexibility": (("position",), RESIDUAL, "m/N"),
    } | changed
    with h5netcdf.File(path, "w") as file:
        file.dimensions = {"position": X.size, "mode": MODES}
        for name, (dimensions, values, unit) in variables.items():
            if name not in without:
                variable = file.create_variable(name, dimensions, data=values)
                variable.attrs.update({"units": unit} if unit else {})
    return path


@pytest.mark.parametrize("shapes", [{}, {"mode_shapes": (("mode", "position"), TABLE.mode_shapes.T, "")}])
def test_netcdf(tmp_path, shapes):
    found = modal_files.read_modal_structure(netcdf(tmp_path / "beam.nc", **shapes))
    assert_allclose(found.residual_flexibility, RESIDUAL)
    the_same(found, 1e-12)


MODE = b"frequency (Hz), 1\ndamping ratio, 0.1\n"
SHAPE = MODE + b"position (m), shape\n"


def read(name, content, tmp_path):
    if content is not None:
        (tmp_path / name).write_bytes(content)
    modal_files.read_modal_structure(tmp_path / name)


test_files_that_hold_no_modes = refusals(
    ("none.csv", None, "no such file"),
    ("empty.csv", b"", "an empty file"),
    ("words.csv", b"once upon a time", r"'once, upon, a, time' in line 1; allowed: a table of modes"),
    ("short.csv", b"frequency (Hz), 1\n0, 1\n1, 2\n", "no line of damping ratio"),
    ("long.csv", MODE, "no line of numbers"),
    ("commas.csv", b"frequency (Hz),1\n0,05,1,5\n", "commas in numbers and between them"),
    ("row.csv", SHAPE + b"0, 1\n1\n", "'1' in line 5"),
    ("nan.csv", SHAPE + b"0, nan\n", "'0, nan' in line 4"),
    ("wide.csv", SHAPE + b"0, 1, 2\n1, 2, 3", "lines of 3 numbers; allowed: 2: a position, a shape of"),
    (
        "narrow.csv",
        MODE + b"position (m) residual flexibility (m/N)\n0\n1\n",
        "lines of 1 number; allowed: 3: a position, .* and the residual flexibility",
    ),
    ("unit.csv", b"frequency (kg), 1\n", "unit: received 'kg'"),
    ("si.csv", b"frequency, 1\n", r"no unit of the frequency; .* Write 'frequency \(Hz\)' with the unit"),
    ("mm.csv", MODE + b"0, 0\n500, 1\n", r"no unit of the position; .*Write 'position \(m\)' with"),
    ("f.csv", MODE + b"position (m), 1, residual flexibility\n0, 0, 0\n", "no unit of the residual flex"),
    ("sixteen.csv", b"\xff\xfe\x00", "no UTF-16"),
    ("garbage.nc", b"\x89HDF\r\n\x1a\n" + bytes(300), "while it was opened.*intact netCDF-4"),
    of=read,
)


test_netcdf_that_lacks_a_variable_or_has_another_unit = refusals(
    ({"without": ["damping_ratios"]}, r"no variable damping_ratios; allowed: the variables positions,"),
    ({"positions": (("position",), X, "Hz")}, r"unit: received 'Hz'; allowed: a unit that converts to m"),
    (
        {"positions": (("position",), X, "")},
        r"positions without a unit; .* Set its attribute units = 'm'",
    ),
    (
        {"positions": (("position",), np.full(X.size, b"a"), "m")},
        r"positions of 1 dimensions and type .*allowed: numbers",
    ),
    of=lambda changed, tmp_path: modal_files.read_modal_structure(netcdf(tmp_path / "beam.nc", **changed)),
)


def test_files_that_claim_too_much(tmp_path, monkeypatch):
    with h5netcdf.File(tmp_path / "bomb.nc", "w") as file:
        file.dimensions = {"position": 40_000_000, "mode": 1}
        for variable in ("natural_frequencies", "damping_ratios"):
            file.create_variable(variable, ("mode",), data=[1.0])
        for variable in ("positions", "mode_shapes"):
            file.create_variable(variable, ("position",), "f8", chunks=(100_000,))
    with pytest.raises(InputError, match=r"40000000 points in \d+ bytes"):
        modal_files.read_modal_structure(tmp_path / "bomb.nc")
    monkeypatch.setattr("asperity.structures.modal_files.LARGEST_FILE", 5)
    (tmp_path / "large.csv").write_text("frequency, 1")
    with pytest.raises(InputError, match=r"large.csv: received 12 bytes"):
        modal_files.read_modal_structure(tmp_path / "large.csv")


@pytest.mark.skipif(importlib.util.find_spec("pyuff") is not None, reason="pyuff is installed")
def test_without_pyuff_it_is_said_how_to_get_it(tmp_path):
    (tmp_path / "beam.uff").write_text("    -1\n")
    with pytest.raises(InputError, match=r'a universal file; allowed.*pip install "asperity\[uff\]"'):
        modal_files.read_modal_structure(tmp_path / "beam.uff", along="x", force="z")


# --- universal files, written by pyuff ------------------------------------------------------------

LENGTH, FORCE = 1e3, 1.0  # of a file in mm and N: factors from SI, as dataset 164 has them
NUMBERS = np.arange(1, X.size + 2)  # of the nodes: the last one is not on the path
CHOSEN = {"along": "y", "force": "z", "nodes": NUMBERS[:-1]}
UNITS = {
    "type": 164, "units_code": 9, "units_description": "mm N", "temp_mode": 1, "length": LENGTH,
    "force": FORCE, "temp": 1.0, "temp_offset": 0.0,
}  # fmt: skip


def nodes(**changed):
    none = np.zeros(NUMBERS.size)
    places = {"x": none, "y": LENGTH * np.append(X, X[3]), "z": np.append(none[1:], 70.0)}
    plain = dict.fromkeys(("def_cs", "disp_cs", "color"), none)
    return {"type": 15, "node_nums": NUMBERS} | plain | places | changed


def mode(i=0, **changed):
    """A mode with its largest value one, as programs write it, in mm and N."""
    shape = np.append(TABLE.mode_shapes[:, i], 0.0)
    largest = np.abs(shape).max()
    mass = largest**-2 * FORCE / LENGTH  # N s²/mm of kg
    return {
        "type": 55, "model_type": 1, "analysis_type": 2, "data_ch": 2, "spec_data_type": 8, "load_case": 0,
        "mode_n": i + 1, "freq": TABLE.frequencies[i], "modal_m": mass, "modal_damp_vis": TABLE.damping[i],
        "modal_damp_his": 0.0, "node_nums": NUMBERS, "r1": 0.0 * shape, "r2": 0.3 * shape,
        "r3": shape / largest,
    } | changed  # fmt: skip


def complex_mode(i, phase=0.7, spread=0.0):
    real = mode(i)
    omega, ratio = 2.0 * np.pi * TABLE.frequencies[i], TABLE.damping[i]
    eigenvalue = omega * (-ratio + 1j * np.sqrt(1.0 - ratio**2))
    turned = real["r3"] * np.exp(1j * (phase + spread * np.linspace(0.0, 1.0, NUMBERS.size)))
    mass = 2j * eigenvalue.imag * real["modal_m"] * np.exp(2j * phase)
    of_complex = {"analysis_type": 3, "eig": eigenvalue, "modal_a": mass, "modal_b": 0j}
    return real | of_complex | {"r3": turned, "r1": 0j * turned, "r2": 0j * turned}


def fields(width, *values):
    """A line of a universal file."""
    return "".join(f"{v:{width}d}" if isinstance(v, int) else f"{v:{width}.5E}" for v in values) + "\n"


def analysis(i=0, *, of_complex=False, six=False, location=1, result=8, kind=None):
    """A dataset 2414 of a mode, line by line after its definition, with the values of a dataset 55."""
    told = complex_mode(i) if of_complex else mode(i)
    shapes = np.stack([told[name] for name in ("r1", "r2", "r3")], axis=1) + 0.0
    if six:
        shapes = np.hstack([shapes, np.ones_like(shapes)])
    eigenvalue, a = (complex(told.get(name, 0.0)) for name in ("eig", "modal_a"))
    numbers = (0.0, told["freq"], 0.0, told["modal_m"], told["modal_damp_vis"], 0.0)
    lines = ["    -1\n", "  2414\n", fields(10, i + 1), "mode\n", fields(10, location), *5 * ["NONE\n"]]
    kind = kind or (3 if of_complex else 2)
    lines += [fields(10, 1, kind, 3 if six else 2, result, 5 if of_complex else 2, shapes.shape[1])]
    lines += [fields(10, 0, 0, 0, 0, 0, i + 1, 0, 0), fields(10, 0, 0), fields(13, *numbers)]
    lines += [fields(13, eigenvalue.real, eigenvalue.imag, a.real, a.imag, 0.0, 0.0)]
    for number, values in zip(NUMBERS.tolist(), shapes, strict=True):
        both = [part for v in values for part in (v.real, v.imag)] if of_complex else values.tolist()
        lines += [fields(10, number), fields(13, *both)]
    return "".join([*lines, "    -1\n"])


@pytest.mark.parametrize("how", [{}, {"six": True}, {"of_complex": True}, {"result": 95}])
@pytest.mark.parametrize("name", ["modes.unv", "modes.dat"])
def test_modes_in_datasets_of_analysis(universal, name, how):
    """2414, as programs write normal modes today; known by its content."""
    file = universal(nodes(), UNITS)
    whole = file.read_text() + "".join(analysis(i, **how) for i in range(MODES))
    file = file.with_name(name)
    file.write_text(whole)
    the_same(modal_files.read_modal_structure(file, **CHOSEN), 2e-4)


@pytest.mark.parametrize("how", [{"kind": 4}, {"location": 2}])
def test_an_analysis_that_is_none_of_modes_at_nodes_is_left_out(universal, how):
    file = universal(nodes(), UNITS)
    file.write_text(file.read_text() + analysis(**how).replace("\n         1\n", "\n         1         6\n"))
    with pytest.raises(InputError):
        modal_files.read_modal_structure(file, **CHOSEN)


@pytest.fixture
def universal(tmp_path):
    """``universal(*sets)`` writes a universal file."""
    pyuff = pytest.importorskip("pyuff", reason="the extra asperity[uff] is not installed")

    def written(*sets):
        pyuff.UFF(str(tmp_path / "beam.uff")).write_sets(list(sets), "overwrite")
        return tmp_path / "beam.uff"

    return written


@pytest.mark.parametrize(
    ("make", "sets", "options"),
    [
        (mode, [nodes(), UNITS], {}),
        (lambda i: mode(i, modal_damp_vis=0.0, modal_damp_his=0.02), [nodes(), UNITS], {}),
        (lambda i: mode(i, modal_damp_vis=0.0), [nodes(), UNITS], {"damping": 0.01}),
        (complex_mode, [nodes(), UNITS], {}),
    ],
    ids=["normal", "hysteretic, twice the ratio", "damping given", "complex, in phase"],
)
def test_modes_of_a_universal_file(universal, make, sets, options):
    """Numbers of a dataset 55 have six digits; 200 Hz are 2 % from a resonance."""
    file = universal(*sets, *map(make, range(MODES)))
    the_same(modal_files.read_modal_structure(file, **CHOSEN, **options), 2e-4)


test_universal_files_that_do_not_say_enough = refusals(
    ([nodes(), UNITS, mode()], {"along": None}, r"along of .*received None; allowed: one of x"),
    ([nodes(), UNITS, mode()], {"nodes": None}, "42 nodes at 41 places along y.*Choose those under"),
    ([nodes(), UNITS, mode()], {"nodes": [1, 99]}, "node 99, which has no place or no shape"),
    ([nodes(), mode()], {}, "no unit of length.*dataset 164.*Export it again"),
    ([UNITS, mode()], {}, r"datasets 164, 55; allowed: modes in datasets 55 or 2414 and nodes"),
    ([nodes(), UNITS, mode(modal_m=0.0)], {}, "a modal mass of 0 of the mode at"),
    ([nodes(), UNITS, mode(spec_data_type=12)], {}, "a mode as data of type 12"),
    ([nodes(), UNITS, mode(modal_damp_vis=0.0)], {}, r"ratio of 0 of the mode at 7.85.* Give damping"),
    ([nodes(disp_cs=np.arange(42)), UNITS, mode()], {}, "42 systems of coordinates"),
    ([nodes(), UNITS, complex_mode(0, spread=3.0)], {}, r"% of the mode at 7.85\d* Hz out of phase.*rec"),
    of=lambda sets, options, universal: modal_files.read_modal_structure(
        universal(*sets), **(CHOSEN | options)
    ),
)


@pytest.mark.usefixtures("opened_apart")
def test_damaged_universal_files(universal):
    file, rng = universal(nodes(), UNITS, mode()), np.random.default_rng(0)
    whole = file.read_bytes()
    for _ in range(3):
        damaged = bytearray(whole[: rng.integers(10, len(whole) - 100)])
        damaged[rng.integers(0, len(damaged))] = rng.integers(0, 256)
        file.write_bytes(bytes(damaged))
        with pytest.raises(InputError):
            modal_files.read_modal_structure(file, **CHOSEN)
