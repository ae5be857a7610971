"""Tables in netCDF files: the columns of a text table as variables, along the dimensions that they have."""

import h5netcdf
import numpy as np
import pytest

from asperity.case import tables
from asperity.case.tables import RECEPTANCES, read_receptance, read_table
from asperity.errors import InputError
from asperity.structures.receptance_fit import receptances_in

RNG = np.random.default_rng(1)
F, AT, FORCES = np.arange(10.0, 40.0), np.array([0.1, 0.3, 0.4]), np.array([0.1, 0.4])
GIVEN = RNG.standard_normal((F.size, AT.size, FORCES.size)) - 1j
GRID = {
    "frequency": (("f",), F / 1e3, "kHz"),
    "position_of_the_response": (("r",), 1e3 * AT, "mm"),
    "position_of_the_force": (("e",), 1e3 * FORCES, "mm"),
    "real_part": (("f", "r", "e"), GIVEN.real, "m/N"),
    "imaginary_part": (("e", "f", "r"), np.moveaxis(GIVEN.imag, 2, 0), "m/N"),
}


def write(path, variables):
    with h5netcdf.File(path, "w") as file:
        for along, values, _ in variables.values():
            for name, size in zip(along, np.shape(values), strict=True):
                if name not in file.dimensions:
                    file.dimensions[name] = size
        for name, (along, values, unit) in variables.items():
            file.create_variable(name, along, data=values)
            if unit:
                file.variables[name].attrs["units"] = unit
    return path


def test_receptances_lie_as_a_matrix_along_frequencies_and_places(tmp_path):
    rows = read_table(write(tmp_path / "matrix.nc", GRID), RECEPTANCES)
    at, forces, f, given = receptances_in(rows, "matrix.nc")
    for found, expected in ((at, AT), (forces, FORCES), (f, F), (given, GIVEN)):
        np.testing.assert_allclose(found, expected, rtol=1e-12)


def test_a_receptance_of_a_wheel_is_three_variables(tmp_path):
    point = GIVEN[:, 0, 0]
    parts = {"real_part": (("f",), point.real, "m/N"), "imaginary_part": (("f",), point.imag, "m/N")}
    f, given = read_receptance(write(tmp_path / "wheel.nc", {"frequency": GRID["frequency"]} | parts))
    np.testing.assert_allclose(f, F, rtol=1e-12)
    np.testing.assert_allclose(given, point, rtol=1e-12)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"real_part": None},
            "no variable real_part; allowed: the variables frequency, position_of_the_resp",
        ),
        ({"frequency": (("f",), F, "")}, "frequency without a unit"),
        ({"frequency": (("f",), F, "kg")}, "'kg'"),
        ({"frequency": (("f",), np.where(F > 20, F, np.nan), "Hz")}, "numbers that are not finite"),
        (
            {"position_of_the_force": (("e", "a", "b", "c"), np.ones((2, 1, 1, 1)), "m")},
            "at most 3 dimensions",
        ),
    ],
)
def test_what_is_no_table_is_said(tmp_path, change, message):
    variables = {name: value for name, value in (GRID | change).items() if value is not None}
    with pytest.raises(InputError, match=message):
        read_table(write(tmp_path / "wrong.nc", variables), RECEPTANCES)


def test_tables_have_a_most_of_lines(tmp_path, monkeypatch):
    file = write(tmp_path / "matrix.nc", GRID)
    found = [(along, np.asarray(values)) for along, values, _ in GRID.values()]
    monkeypatch.setattr(tables, "MOST_LINES", 179)
    with pytest.raises(InputError, match="a table of 180 lines; allowed: at most 179"):
        tables._laid_out(found, file)


@pytest.mark.parametrize("content", [b"", b"frequency (Hz), 1", b"\x89HDF\r\n\x1a\n" + bytes(300)])
def test_damaged_files_are_said(tmp_path, content):
    (tmp_path / "broken.nc").write_bytes(content)
    with pytest.raises(InputError, match=r"an empty file|intact netCDF-4"):
        read_table(tmp_path / "broken.nc", RECEPTANCES)
