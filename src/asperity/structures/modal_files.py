"""Modes from universal files: datasets 55 or 2414 (modes), 15 or 2411 (nodes), 164 (units), by pyuff."""

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from asperity.arguments import Array, Complex, file_path, listed, no_file, one_of, require, shown
from asperity.errors import InputError
from asperity.files import amount
from asperity.hdf5 import check_unpacked, is_hdf5, opened_netcdf
from asperity.sandbox import Answer, sandboxed
from asperity.structures.modal import ModalStructure
from asperity.surfaces.readers.guards import hostile
from asperity.text_files import lines_of_cells, number_or_nan, read_text, refuse_decimal_commas
from asperity.units import factor, unit_in_brackets
from asperity.written_numbers import count_of, rounded

Dataset = dict[str, Any]

AXES = ("x", "y", "z")
NORMAL = 2
"""Analysis type of a dataset 55: normal modes."""
COMPLEX = (3, 7)
"""Its analysis types of complex modes, of first and second order."""
DISPLACEMENT = (0, 1, 8, 95, 96)
"""Its data types that are displacements: unknown, general, displacement; of a 2414 unknown vectors."""
AT_NODES = 1
"""Where data of a dataset 2414 are."""
COMPLEX_NUMBERS = (5, 6)
"""Its types of numbers that are complex."""
FULL = (0, 2, 3)
"""Its data characteristics with x, y and z: unknown, three and six degrees of freedom."""
OUT_OF_PHASE = 0.1
"""Share of a complex mode, of its mean square, that may move out of phase with the rest."""
_EXPORT = "Export it again."
_PACKAGES = ["h5netcdf", "pyuff"]


def modes_of_universal(path: str, given: dict[str, Any]) -> Answer:
    """Read the modes of a universal file, as `read_modal_structure` is asked."""
    file = Path(path)
    along, force = (_axis(name, given[name], file.name) for name in ("along", "force"))
    modes, nodes, units = _datasets(file)
    length, newtons = (_unit(units, name, file.name) for name in ("length", "force"))
    numbers, places = _path(nodes, along, given["nodes"], modes, file.name)
    read = [_mode(mode, numbers, force, given["damping"], file.name) for mode in modes]
    frequencies, ratios, masses, shapes = (list(values) for values in zip(*read, strict=True))
    order = np.argsort(places)
    normalised = np.column_stack(shapes)[order] / np.sqrt(masses) * np.sqrt(length / newtons)
    return NEEDED, [places[order] * length, np.array(frequencies), np.array(ratios), normalised]


def _axis(name: str, given: object, source: str) -> int:
    what = "path" if name == "along" else "contact force"
    remedy = f"Say in which direction of the file the {what} lies."
    return AXES.index(one_of(f"{name} of {source}", given, AXES, remedy))


def _datasets(file: Path) -> tuple[list[Dataset], list[Dataset], Dataset | None]:
    """Modes, nodes and units of a file."""
    try:
        import pyuff
    except ImportError:
        allowed = "a text table or netCDF; universal files with pyuff"
        remedy = 'Install it: pip install "asperity[uff]".'
        raise InputError(file.name, "a universal file", allowed, remedy) from None
    with hostile(file.name, "universal"):
        opened = pyuff.UFF(str(file))
        types = [str(kind).strip().removesuffix(".0") for kind in opened.get_set_types()]
        wanted = [i for i, kind in enumerate(types) if kind in ("15", "55", "164", "2411", "2414")]
        sets = [(types[i], opened.read_sets(i)) for i in wanted]
    sets = [("55", _of_analysis(each)) if kind == "2414" else (kind, each) for kind, each in sets]
    modes = [each for kind, each in sets if kind == "55" and each.get("analysis_type") in (NORMAL, *COMPLEX)]
    nodes = [each for kind, each in sets if kind in ("15", "2411")]
    units = [each for kind, each in sets if kind == "164"]
    if not modes or not nodes:
        received = f"datasets {listed(types) or 'of no kind'}"
        raise InputError(file.name, received, "modes in datasets 55 or 2414 and nodes in 15 or 2411", _EXPORT)
    return modes, nodes, units[-1] if units else None


def _of_analysis(found: Dataset) -> Dataset:
    """A dataset 2414 as the dataset 55 that it has succeeded: of modes at nodes, others without their type.

    Its records 12 and 13 are time, frequency, eigenvalue, modal mass, viscous and hysteretic damping; real
    and imaginary part of the eigenvalue, of modal A and of modal B. At each node stand the values of all
    degrees of freedom, of complex ones real and imaginary part in turn.
    """
    kind = found.get("analysis_type")
    at_nodes = found.get("dataset_location") == AT_NODES
    if kind not in (NORMAL, *COMPLEX) or not at_nodes:
        return {}
    values = np.array(found["data_at_node"], dtype=float)
    if found["data_type"] in COMPLEX_NUMBERS:
        values = values[:, ::2] + 1j * values[:, 1::2]
    numbers = {
        record: [float(found.get(f"record{record}_field{field}", 0.0)) for field in range(1, 7)]
        for record in (12, 13)
    }
    _, frequency, _, mass, viscous, hysteretic = numbers[12]
    real, imaginary, a_real, a_imaginary, *_ = numbers[13]
    told = {"freq": frequency, "modal_m": mass, "modal_damp_vis": viscous, "modal_damp_his": hysteretic}
    shape = {f"r{axis}": values[:, axis - 1] for axis in range(1, 1 + min(3, values.shape[1]))}
    eigen = {"eig": complex(real, imaginary), "modal_a": complex(a_real, a_imaginary)}
    as_before = {"data_ch": found["data_characteristic"], "spec_data_type": found["result_type"]}
    return {"analysis_type": kind, "node_nums": found["node_nums"], **as_before, **told, **eigen, **shape}


def _unit(stated: Dataset | None, of: str, source: str) -> float:
    """Length, m, or force, N, of one of the units of a file."""
    factor_of_it = math.nan if stated is None else float(stated[of])
    allowed = "a dataset 164 with units"
    require(0.0 < factor_of_it < math.inf, source, f"no unit of {of}", allowed, _EXPORT)
    return 1.0 / factor_of_it


def _path(
    nodes: list[Dataset], along: int, chosen: list[int] | None, modes: list[Dataset], source: str
) -> tuple[list[int], Array]:
    """Numbers of the nodes on the path and their places along it, in the file's unit of length."""
    place = {
        int(number): float(at)
        for each in nodes
        for number, at in zip(each["node_nums"], each[AXES[along]], strict=True)
    }
    turned = {int(system) for each in nodes for system in np.atleast_1d(each["disp_cs"])}
    received = f"nodes that move in {count_of(len(turned), 'system')} of coordinates"
    require(len(turned) == 1, source, received, "modes in one global system", _EXPORT)
    shared = set.intersection(*({int(n) for n in mode["node_nums"]} for mode in modes)) & place.keys()
    numbers = sorted(shared) if chosen is None else chosen
    if missing := [number for number in numbers if number not in shared]:
        received = f"node {missing[0]}, which has no place or no shape in each mode"
        raise InputError(f"nodes of {source}", received, "nodes of the file")
    places = np.array([place[number] for number in numbers])
    if len(numbers) < 2 or np.unique(places).size < places.size:
        apart = count_of(np.unique(places).size, "place")
        received = f"{count_of(len(numbers), 'node')} at {apart} along {AXES[along]}"
        remedy = "Choose those under the contact by nodes."
        raise InputError(source, received, "two nodes or more, one at each place", remedy)
    return numbers, places


def _mode(
    mode: Dataset, numbers: list[int], force: int, damping: float | None, source: str
) -> tuple[float, float, float, Array]:
    """Frequency, Hz, damping ratio, modal mass and shape at the nodes, in the file's units."""
    if mode["spec_data_type"] not in DISPLACEMENT or mode["data_ch"] not in FULL:
        received = f"a mode as data of type {mode['spec_data_type']}, characteristic {mode['data_ch']}"
        raise InputError(source, received, "displacements in three or six degrees of freedom", _EXPORT)
    row = {int(number): i for i, number in enumerate(mode["node_nums"])}
    values = np.asarray(mode[f"r{force + 1}"])[[row[number] for number in numbers]]
    if mode["analysis_type"] == NORMAL:
        frequency = float(mode["freq"])
        mass = float(mode["modal_m"])
        ratio = float(mode["modal_damp_vis"]) or 0.5 * float(mode["modal_damp_his"])
        shape = values.real.astype(float)
    else:
        eigenvalue = complex(mode["eig"])
        frequency = abs(eigenvalue) / (2.0 * np.pi)
        ratio = -eigenvalue.real / abs(eigenvalue) if eigenvalue else 0.0
        shape, turn = _real_mode(values, frequency, source)
        mass = float((complex(mode["modal_a"]) * turn**2 / (2j * abs(eigenvalue.imag) or 1.0)).real)
    received = f"a modal mass of {rounded(mass)} of the mode at {rounded(frequency, 4)} Hz"
    require(mass > 0.0, source, received, "positive ones; 1 of mass-normalised modes", _EXPORT)
    known = damping is not None or 0.0 < ratio < 1.0 or frequency == 0.0
    received = f"a damping ratio of {rounded(ratio)} of the mode at {rounded(frequency, 4)} Hz"
    require(known, source, received, "above 0, below 1", "Give damping, for all modes.")
    return frequency, ratio if damping is None else damping, mass, shape


def _real_mode(values: Complex, frequency: float, source: str) -> tuple[Array, complex]:
    """Real shape nearest to a complex one, and the factor that turns that into phase with it."""
    squares = np.sum(values**2)
    turn = complex(np.exp(-0.5j * np.angle(squares)))
    turned = values * turn
    share = float(np.sum(turned.imag**2) / max(np.sum(np.abs(turned) ** 2), np.finfo(float).tiny))
    received = f"{100 * share:.0f} % of the mode at {rounded(frequency, 4)} Hz out of phase"
    allowed = f"at most {100 * OUT_OF_PHASE:.0f} %: modes are taken as real"
    require(share <= OUT_OF_PHASE, source, received, allowed, "Give its receptance instead.")
    return turned.real.astype(float), turn


LARGEST_FILE = 256 * 2**20
"""Bytes of a file with modes."""

VARIABLES = {
    "positions": ("m", 1),
    "natural_frequencies": ("Hz", 1),
    "damping_ratios": ("", 1),
    "mode_shapes": ("", 2),
    "modal_masses": ("kg", 1),
    "residual_flexibility": ("m/N", 2),
}
"""Variables of a netCDF file, with SI unit and most dimensions, as `ModalStructure` takes them."""
NEEDED = list(VARIABLES)[:4]
ROWS = {
    "frequency": ("natural_frequencies", "Hz"),
    "damping ratio": ("damping_ratios", ""),
    "modal mass": ("modal_masses", "kg"),
}
"""First words of the lines of a text table before those of the positions."""
_TABLE = (
    "a table of modes: a line 'frequency (Hz)', a line 'damping ratio', then position (m) and mode shapes "
    "in each line"
)


def read_modal_structure(
    path: str | Path,
    *,
    along: str | None = None,
    force: str | None = None,
    damping: float | None = None,
    nodes: Sequence[int] | None = None,
    around: bool = False,
) -> ModalStructure:
    """Read a structure from a file of its modes.

    *Text or CSV*: a line ``frequency (Hz)`` with one number for each mode, a line ``damping ratio``, perhaps
    one ``modal mass (kg)`` (without it the shapes are mass-normalised, kg^(−1/2)), a heading ``position
    (mm)``, then for each position a line with it and the shape of each mode there. If the heading ends with
    ``residual flexibility (m/N)``, the last column is that. Without these units the table is refused.

    *NetCDF-4*: the variables ``positions``, ``natural_frequencies``, ``damping_ratios``, ``mode_shapes`` with
    the dimensions of positions and of frequencies; ``modal_masses`` and ``residual_flexibility`` if there are
    any. Attributes ``units`` name the units of what has one.

    *Universal file*: modes in datasets 55 or 2414, nodes in dataset 15 or 2411, units in dataset 164, through
    the package pyuff. The keywords are for these files alone.

    Parameters
    ----------
    path : str or Path
        The file, known by its content: netCDF-4, a universal file, or text.
    along, force : {"x", "y", "z"}, optional
        Direction of the path, and of the contact force.
    damping : float, optional
        Damping ratio of all modes, where the file states none.
    nodes : sequence of int, optional
        Numbers of the nodes on the path; all that have mode shapes if not given.
    around : bool
        Whether positions are angles, rad: the heading of a table is then ``angle (deg)``, and no universal
        file is read.

    Returns
    -------
    ModalStructure
        With positions and shapes in SI.

    Raises
    ------
    InputError
        If the file cannot be read or is damaged, or says too little; or as `ModalStructure`.

    Examples
    --------
    >>> from pathlib import Path
    >>> from asperity import read_modal_structure
    >>> lines = ["frequency (Hz), 120", "damping ratio, 0.01", "position (mm), shape"]
    >>> lines += ["0, 0", "250, 0.5", "500, 0.7", "750, 0.5", "1000, 0"]
    >>> _ = Path("plate.csv").write_text("\\n".join(lines))
    >>> read_modal_structure("plate.csv").extent
    (0.0, 1.0)
    """
    file = file_path("file of modes", path, "the path of a file")
    found = no_file(file)
    require(not found, str(file), found, "a file with modes", "Check the path.")
    size = file.stat().st_size
    require(size <= LARGEST_FILE, file.name, amount(size), f"at most {amount(LARGEST_FILE)}")
    numbers = None if nodes is None else [int(node) for node in nodes]
    given: dict[str, Any] = {"along": along, "force": force, "damping": damping, "nodes": numbers}
    universal = _is_universal(file)
    netcdf = is_hdf5(file) or file.suffix.lower() in (".nc", ".nc4")
    if universal and not around:
        return _read_from(file, "universal", modes_of_universal, given)
    for name, value in given.items():
        if value is not None:
            allowed = "nothing: it is for universal files (.uff, .unv)"
            raise InputError(name, shown(value), allowed, f"{file.name} states it, in SI or with its units.")
    if netcdf:
        return _read_from(file, "netCDF-4", modes_of_netcdf, "rad" if around else "m")
    return _structure(_table_of_modes(file, *(("angle", "rad") if around else ("position", "m"))), file.name)


def _is_universal(file: Path) -> bool:
    """Whether a file begins as universal files do, with the mark of a dataset, or has their extension."""
    with open(file, "rb") as opened:
        first = opened.read(1024).lstrip().split(maxsplit=1)
    return first[:1] == [b"-1"] or file.suffix.lower() in (".uff", ".unv", ".univ")


def _read_from(file: Path, kind: str, serve: Callable[..., Answer], *more: Any) -> ModalStructure:
    """Read a file in a process of its own, by a function that sends the names and values of its arrays."""
    names, arrays = sandboxed(serve, file, [*more], source=file.name, kind=kind, packages=_PACKAGES)
    return _structure(dict(zip(names, arrays, strict=True)), file.name)


def _structure(found: dict[str, Any], source: str) -> ModalStructure:
    try:
        given: list[Any] = [found.get(name) for name in VARIABLES]
        return ModalStructure(*given)
    except InputError as error:
        raise error.about(f"{error.what} in {source}") from None


def _table_of_modes(file: Path, place: str, dimension: str) -> dict[str, Array]:
    """Read a text table, see `read_modal_structure`, whose places have a name and a unit."""
    table_of = _TABLE.replace("position (m)", f"{place} ({dimension})")
    found: dict[str, Array] = {}
    rows: list[list[float]] = []
    unit = math.nan
    residual = math.nan
    content = read_text(file, file.name, table_of, largest=LARGEST_FILE)
    refuse_decimal_commas(content, file.name)
    for number, cells in lines_of_cells(content):
        values = [number_or_nan(cell) for cell in cells]
        words = next((i for i, value in enumerate(values) if not math.isnan(value)), len(cells))
        heading = " ".join(cells[:words])
        label = heading.lower()
        row = next((row for row in ROWS if label.startswith(row)), None)
        if row and not rows and words < len(cells) and np.isfinite(values[words:]).all():
            name, own = ROWS[row]
            found[name] = np.array(values[words:]) * _stated(heading, row, own, file)
        elif label.startswith(place) and not rows:
            unit = _stated(heading.partition("residual")[0], place, dimension, file)
            _, there, last = " ".join(cells).rpartition("residual flexibility")
            residual = _stated(last, "residual flexibility", "m/N", file) if there else math.nan
        elif words == 0 and np.isfinite(values).all() and len(values) == len((rows or [values])[0]):
            rows.append(values)
        else:
            raise InputError(file.name, f"'{', '.join(cells)[:40]}' in line {number}", table_of)
    missing = [row for row, (name, _) in ROWS.items() if name in NEEDED and name not in found]
    if missing or not rows:
        raise InputError(file.name, f"no line of {missing[0] if missing else 'numbers'}", table_of)
    table = np.array(rows)
    modes = found["natural_frequencies"].size
    columns = 1 + modes + (not math.isnan(residual))
    if table.shape[1] != columns:
        last = "" if math.isnan(residual) else ", and the residual flexibility"
        allowed = f"{columns}: a position, a shape of each of {modes} modes{last}"
        raise InputError(file.name, f"lines of {count_of(table.shape[1], 'number')}", allowed)
    if math.isnan(unit):
        _stated("", place, dimension, file)
    if not math.isnan(residual):
        found["residual_flexibility"] = residual * table[:, -1]
        table = table[:, :-1]
    return found | {"positions": unit * table[:, 0], "mode_shapes": table[:, 1:]}


def _stated(heading: str, name: str, dimension: str, file: Path) -> float:
    """SI value of the unit that a heading names in brackets; nothing with a dimension goes without."""
    unit = unit_in_brackets(heading)
    if dimension and not unit:
        remedy = f"Write '{name} ({dimension})' with the unit that it is in."
        raise InputError(file.name, f"no unit of the {name}", "a unit in brackets", remedy)
    return factor(unit, dimension) if unit else 1.0


def modes_of_netcdf(path: str, places: str) -> Answer:
    """Read the variables of a netCDF-4 file, whose positions have a unit as `places`."""
    file = Path(path)
    with hostile(file.name, "netCDF-4"), opened_netcdf(file, file.name) as opened:
        present = [name for name in VARIABLES if name in opened.variables]
        if missing := [name for name in NEEDED if name not in present]:
            allowed = f"the variables {', '.join(NEEDED)}"
            raise InputError(file.name, f"no variable {missing[0]}", allowed)
        known = VARIABLES | {"positions": (places, 1)}
        arrays = [netcdf_numbers(opened.variables[name], name, *known[name], file) for name in present]
        modes = opened.variables["natural_frequencies"].dimensions
        shapes = present.index("mode_shapes")
        if opened.variables["mode_shapes"].dimensions[:1] == modes:
            arrays[shapes] = arrays[shapes].T
    return present, arrays


def netcdf_numbers(variable: Any, name: str, unit: str, dimensions: int, file: Path) -> Array:
    """Read a variable of at most so many dimensions in SI; with a unit, its attribute must name one."""
    check_unpacked(file, f"{name} of {file.name}", variable.shape, np.dtype(variable.dtype).itemsize)
    if not 1 <= variable.ndim <= dimensions or variable.dtype.kind not in "fiu":
        received = f"{name} of {variable.ndim} dimensions and type {variable.dtype}"
        raise InputError(file.name, received, f"numbers along at most {dimensions} dimensions")
    stated = variable.attrs.get("units")
    if unit and not isinstance(stated, str):
        remedy = f"Set its attribute units = '{unit}', or the unit that it is in."
        raise InputError(file.name, f"{name} without a unit", "attributes that name the units", remedy)
    scale = factor(stated, unit) if unit else 1.0
    return np.asarray(variable[...], dtype=np.float64) * scale
