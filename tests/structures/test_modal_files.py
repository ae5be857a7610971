"""Files of modes: text, netCDF, universal files; units, directions, and what is refused."""

import dataclasses
import importlib.util
from pathlib import Path

import h5netcdf
import numpy as np
import pytest
from numpy.testing import assert_allclose

from asperity.errors import InputError
from asperity.structures.beam import Beam
from asperity.structures.modal import ModalStructure
from asperity.structures.modal_files import read_modal_structure

BEAM = Beam(1.0, 100.0, 4.0, highest_frequency=400.0, loss_factor=0.02)
X = np.linspace(0.0, 1.0, 41)
TABLE = ModalStructure(X, BEAM.natural_frequencies, BEAM.damping_ratios, BEAM.shapes(X)[0])
MODES = len(TABLE.frequencies)
F = np.array([5.0, 31.0, 200.0])


def the_same(found, rtol):
    expected = TABLE.receptance(F, 0.31, 0.62)
    assert_allclose(found.receptance(F, 0.31, 0.62), expected, rtol=rtol)
    assert found.extent == pytest.approx((0.0, 1.0))


def text_of(separator=", ", *, residual=None, scale=1.0, masses=False):
    def line(label, values):
        return separator.join([label, *(repr(float(v)) for v in values)])

    lines = ["# a beam", line("frequency (kHz)", TABLE.frequencies / 1e3)]
    lines.append(line("damping ratio", TABLE.damping))
    if masses:
        lines.append(line("modal mass (g)", np.full(MODES, 1e3 * scale**2)))
    heading = ["position (mm)", *(f"mode {i}" for i in range(MODES))]
    table = np.column_stack([1e3 * X, scale * TABLE.mode_shapes])
    if residual is not None:
        heading.append("residual flexibility (um/N)")
        table = np.column_stack([table, 1e6 * residual])
    lines.append(separator.join(heading))
    return "\n".join([*lines, *(separator.join(repr(float(v)) for v in row) for row in table)])


@pytest.mark.parametrize("separator", [", ", " ", "\t"])
def test_a_text_table(tmp_path, separator):
    file = tmp_path / "beam.csv"
    file.write_text(text_of(separator))
    the_same(read_modal_structure(file), 1e-12)


def test_a_text_table_with_decimal_commas_and_modal_masses(tmp_path):
    file = tmp_path / "beam.csv"
    file.write_text(text_of("; ", scale=3.0, masses=True).replace(".", ","))
    the_same(read_modal_structure(file), 1e-12)


def test_a_text_table_with_residual_flexibility(tmp_path):
    residual = 1e-6 * np.sin(np.pi * X) ** 2
    file = tmp_path / "beam.txt"
    file.write_text(text_of(residual=residual))
    assert_allclose(read_modal_structure(file).residual_flexibility, residual, rtol=1e-12)


def test_the_table_of_the_documentation_is_one(tmp_path):
    page = (Path(__file__).parents[2] / "docs" / "bodies.md").read_text(encoding="utf-8")
    (tmp_path / "page.csv").write_text(page.partition("```text\n")[2].partition("```")[0])
    found = read_modal_structure(tmp_path / "page.csv")
    assert found.frequencies.tolist() == [52.4, 209.8]
    assert found.extent == (0.0, 1.0)
    assert found.residual_flexibility[4] == pytest.approx(69e-9)
    assert found.mode_shapes[4].tolist() == [0.714, 0.0]


def write_netcdf(path, *, transposed=False, without=(), bare=(), units="mm"):
    with h5netcdf.File(path, "w") as file:
        file.dimensions = {"position": 41, "mode": MODES}
        values = {
            "positions": (("position",), 1e3 * X),
            "natural_frequencies": (("mode",), TABLE.frequencies),
            "damping_ratios": (("mode",), TABLE.damping),
            "mode_shapes": (("position", "mode"), TABLE.mode_shapes),
            "residual_flexibility": (("position",), np.full(41, 2e-9)),
        }
        if transposed:
            values["mode_shapes"] = (("mode", "position"), TABLE.mode_shapes.T)
        for name, (dimensions, value) in values.items():
            if name not in without:
                file.create_variable(name, dimensions, data=value)
        for name, unit in {
            "positions": units,
            "natural_frequencies": "Hz",
            "residual_flexibility": "m/N",
        }.items():
            if name not in (*without, *bare):
                file.variables[name].attrs["units"] = unit


@pytest.mark.parametrize("transposed", [False, True])
def test_netcdf(tmp_path, transposed):
    write_netcdf(tmp_path / "beam.nc", transposed=transposed)
    found = read_modal_structure(tmp_path / "beam.nc")
    assert_allclose(found.residual_flexibility, 2e-9)
    the_same(dataclasses.replace(found, residual_flexibility=None), 1e-12)


MODE = b"frequency (Hz), 1\ndamping ratio, 0.1\n"
SHAPE = MODE + b"position (m), shape\n"


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("none.csv", None, "no such file"),
        ("empty.csv", b"", "an empty file"),
        ("words.csv", b"once upon a time", r"'once, upon, a, time' in line 1; allowed: a table of modes"),
        ("short.csv", b"frequency (Hz), 1\n0, 1\n1, 2\n", "no line of damping ratio"),
        ("long.csv", MODE, "no line of numbers"),
        ("row.csv", SHAPE + b"0, 1\n1\n", "'1' in line 5"),
        ("nan.csv", SHAPE + b"0, nan\n", "'0, nan' in line 4"),
        (
            "wide.csv",
            SHAPE + b"0, 1, 2\n1, 2, 3",
            "lines of 3 numbers; allowed: 2: a position, a shape of each of 1 modes",
        ),
        (
            "narrow.csv",
            MODE + b"position (m) residual flexibility (m/N)\n0\n1\n",
            "lines of 1 numbers; allowed: 3: a position, .* and the residual flexibility",
        ),
        ("unit.csv", b"frequency (kg), 1\n", "unit: received 'kg'"),
        ("si.csv", b"frequency, 1\n", r"no unit of the frequency; .* Write 'frequency \(Hz\)' with the unit"),
        (
            "mm.csv",
            MODE + b"0, 0\n500, 1\n1000, 0\n",
            r"no unit of the position; allowed: a unit in brackets. Write 'position \(m\)' with the unit",
        ),
        (
            "flexible.csv",
            MODE + b"position (m), 1, residual flexibility\n0, 0, 0\n",
            "no unit of the residual flexibility",
        ),
        ("sixteen.csv", b"\xff\xfe\x00", "no UTF-16"),
        ("garbage.nc", b"\x89HDF\r\n\x1a\n" + bytes(300), "while it was opened.*intact netCDF-4"),
        ("text.nc", b"frequency, 1", "while it was opened.*intact netCDF-4"),
    ],
)
def test_files_that_hold_no_modes(tmp_path, name, content, message):
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError, match=message):
        read_modal_structure(tmp_path / name)


def test_netcdf_that_lacks_a_variable_or_has_another_unit(tmp_path):
    write_netcdf(tmp_path / "beam.nc", without=("damping_ratios",))
    with pytest.raises(InputError, match=r"no variable damping_ratios; allowed: the variables positions,"):
        read_modal_structure(tmp_path / "beam.nc")
    write_netcdf(tmp_path / "unit.nc", units="Hz")
    with pytest.raises(InputError, match=r"unit: received 'Hz'; allowed: a unit that converts to m"):
        read_modal_structure(tmp_path / "unit.nc")
    write_netcdf(tmp_path / "bare.nc", bare=("positions",))
    with pytest.raises(InputError, match=r"positions without a unit; .* Set its attribute units = 'm', or"):
        read_modal_structure(tmp_path / "bare.nc")
    with h5netcdf.File(tmp_path / "words.nc", "w") as file:
        file.dimensions = {"n": 2}
        for variable in ("natural_frequencies", "damping_ratios", "mode_shapes"):
            file.create_variable(variable, ("n",), data=[1.0, 2.0])
        file.create_variable("positions", ("n",), data=np.array([b"a", b"b"]))
    with pytest.raises(InputError, match=r"positions of 1 dimensions and type .*allowed: numbers"):
        read_modal_structure(tmp_path / "words.nc")


def test_files_that_claim_too_much(tmp_path, monkeypatch):
    with h5netcdf.File(tmp_path / "bomb.nc", "w") as file:
        file.dimensions = {"position": 40_000_000, "mode": 1}
        for variable in ("natural_frequencies", "damping_ratios"):
            file.create_variable(variable, ("mode",), data=[1.0])
        for variable in ("positions", "mode_shapes"):
            file.create_variable(variable, ("position",), "f8", chunks=(100_000,))
    with pytest.raises(InputError, match=r"40000000 points in \d+ bytes"):
        read_modal_structure(tmp_path / "bomb.nc")
    monkeypatch.setattr("asperity.structures.modal_files.LARGEST_FILE", 5)
    (tmp_path / "large.csv").write_text("frequency, 1")
    with pytest.raises(InputError, match=r"large.csv: received 12 bytes"):
        read_modal_structure(tmp_path / "large.csv")


def test_what_is_for_universal_files_is_refused_of_others(tmp_path):
    (tmp_path / "beam.csv").write_text(text_of())
    with pytest.raises(InputError, match=r"force: received 'z'; allowed: nothing: it is for universal"):
        read_modal_structure(tmp_path / "beam.csv", force="z")


@pytest.mark.skipif(importlib.util.find_spec("pyuff") is not None, reason="pyuff is installed")
def test_without_pyuff_it_is_said_how_to_get_it(tmp_path):
    (tmp_path / "beam.uff").write_text("    -1\n")
    with pytest.raises(InputError, match=r'a universal file; allowed.*pip install "asperity\[uff\]"'):
        read_modal_structure(tmp_path / "beam.uff", along="x", force="z")


# --- universal files, written by pyuff ------------------------------------------------------------

LENGTH, FORCE = 1e3, 1.0  # of a file in mm and N: factors from SI, as dataset 164 has them
PATH = {"along": "y", "force": "z"}


@pytest.fixture
def pyuff():
    return pytest.importorskip("pyuff", reason="the extra asperity[uff] is not installed")


def nodes(**changed):
    count = X.size + 1  # one that is not on the path
    none = np.zeros(count)
    places = {"x": none, "y": LENGTH * np.append(X, X[3]), "z": np.append(none[1:], 70.0)}
    number = np.arange(1, count + 1)
    return {
        "type": 15,
        "node_nums": number,
        "def_cs": none,
        "disp_cs": none,
        "color": none,
        **places,
    } | changed


def units():
    return {
        "type": 164, "units_code": 9, "units_description": "mm N", "temp_mode": 1,
        "length": LENGTH, "force": FORCE, "temp": 1.0, "temp_offset": 0.0,
    }  # fmt: skip


def normal_mode(i, **changed):
    """A mode with its largest value one, as programs write it, in mm and N."""
    shape = np.append(TABLE.mode_shapes[:, i], 0.0)
    largest = np.abs(shape).max()
    mass = largest**-2 * FORCE / LENGTH  # N s²/mm of kg
    return {
        "type": 55, "model_type": 1, "analysis_type": 2, "data_ch": 2, "spec_data_type": 8, "load_case": 0,
        "mode_n": i + 1, "freq": TABLE.frequencies[i], "modal_m": mass, "modal_damp_vis": TABLE.damping[i],
        "modal_damp_his": 0.0, "node_nums": np.arange(1, X.size + 2),
        "r1": 0.0 * shape, "r2": 0.3 * shape, "r3": shape / largest,
    } | changed  # fmt: skip


def complex_mode(i, phase=0.7, spread=0.0):
    real = normal_mode(i)
    omega, ratio = 2.0 * np.pi * TABLE.frequencies[i], TABLE.damping[i]
    eigenvalue = omega * (-ratio + 1j * np.sqrt(1.0 - ratio**2))
    turned = real["r3"] * np.exp(1j * (phase + spread * np.linspace(0.0, 1.0, X.size + 1)))
    return real | {
        "analysis_type": 3, "eig": eigenvalue, "modal_b": 0j, "r3": turned, "r1": 0j * turned,
        "r2": 0j * turned,
        "modal_a": 2j * eigenvalue.imag * real["modal_m"] * np.exp(2j * phase),
    }  # fmt: skip


def write_universal(pyuff, path, *sets):
    pyuff.UFF(str(path)).write_sets(list(sets), "overwrite")
    return path


CHOSEN = {"nodes": np.arange(1, X.size + 1)}


def test_normal_modes_of_a_universal_file(pyuff, tmp_path):
    """Numbers of a dataset 55 have six digits; 200 Hz are 2 % from a resonance."""
    modes = [normal_mode(i) for i in range(MODES)]
    file = write_universal(pyuff, tmp_path / "beam.uff", nodes(), units(), *modes)
    the_same(read_modal_structure(file, **PATH, **CHOSEN), 2e-4)
    bare = write_universal(pyuff, tmp_path / "bare.unv", nodes(), *modes)
    the_same(read_modal_structure(bare, **PATH, **CHOSEN, length_unit="mm", force_unit="N"), 2e-4)


def test_losses_of_a_universal_file(pyuff, tmp_path):
    """Hysteretic ones are twice the damping ratio; without any, one has to be given."""
    lossy = [normal_mode(i, modal_damp_vis=0.0, modal_damp_his=0.02) for i in range(MODES)]
    file = write_universal(pyuff, tmp_path / "lossy.uff", nodes(), units(), *lossy)
    the_same(read_modal_structure(file, **PATH, **CHOSEN), 2e-4)
    none = [normal_mode(i, modal_damp_vis=0.0) for i in range(MODES)]
    file = write_universal(pyuff, tmp_path / "none.uff", nodes(), units(), *none)
    with pytest.raises(InputError, match=r"a damping ratio of 0 of the mode at 7.85.* Give damping"):
        read_modal_structure(file, **PATH, **CHOSEN)
    the_same(read_modal_structure(file, **PATH, **CHOSEN, damping=0.01), 2e-4)


def test_complex_modes_that_move_in_phase_are_real(pyuff, tmp_path):
    file = write_universal(
        pyuff, tmp_path / "beam.uff", nodes(), units(), *(complex_mode(i) for i in range(MODES))
    )
    the_same(read_modal_structure(file, **PATH, **CHOSEN), 2e-4)
    file = write_universal(pyuff, tmp_path / "turning.uff", nodes(), units(), complex_mode(0, spread=3.0))
    with pytest.raises(InputError, match=r"% of the mode at 7.85\d* Hz out of phase.*receptance instead"):
        read_modal_structure(file, **PATH, **CHOSEN)


@pytest.mark.parametrize(
    ("sets", "options", "message"),
    [
        ([nodes, units, normal_mode], {"along": None}, r'along of .*received None; allowed: one of "x"'),
        ([nodes, units, normal_mode], {}, "42 nodes at 41 places along y.*Choose those under the contact"),
        ([nodes, units, normal_mode], {"nodes": [1, 99]}, "node 99, which has no place or no shape"),
        ([nodes, normal_mode], CHOSEN, "no unit of length.*Give length_unit"),
        ([units, normal_mode], CHOSEN, r"datasets 164, 55; allowed: modes in datasets 55 and nodes"),
        ([nodes, units, lambda: normal_mode(0, modal_m=0.0)], CHOSEN, "a modal mass of 0 of the mode at"),
        ([nodes, units, lambda: normal_mode(0, spec_data_type=12)], CHOSEN, "a mode as data of type 12"),
        ([lambda: nodes(disp_cs=np.arange(42)), units, normal_mode], CHOSEN, "42 systems of coordinates"),
    ],
)
def test_universal_files_that_do_not_say_enough(pyuff, tmp_path, sets, options, message):
    made = [make(0) if make is normal_mode else make() for make in sets]
    file = write_universal(pyuff, tmp_path / "beam.uff", *made)
    with pytest.raises(InputError, match=message):
        read_modal_structure(file, **(PATH | dict(options)))


def test_damaged_universal_files(pyuff, tmp_path):
    whole = write_universal(pyuff, tmp_path / "beam.uff", nodes(), units(), normal_mode(0)).read_bytes()
    rng = np.random.default_rng(0)
    for i in range(6):
        damaged = bytearray(whole[: rng.integers(10, len(whole) - 100)])
        damaged[rng.integers(0, len(damaged))] = rng.integers(0, 256)
        (tmp_path / f"{i}.uff").write_bytes(bytes(damaged))
        with pytest.raises(InputError):
            read_modal_structure(tmp_path / f"{i}.uff", **PATH, **CHOSEN)
