"""Modes from a universal file: datasets 55 (modes), 15 or 2411 (nodes) and 164 (units), through pyuff."""

from __future__ import annotations

from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from asperity.apart import send
from asperity.arguments import listed, shown
from asperity.errors import InputError
from asperity.surfaces.readers.guards import hostile
from asperity.units import factor

Array = NDArray[np.float64]

AXES = ("x", "y", "z")
NORMAL, COMPLEX = 2, (3, 7)
"""Analysis types of a dataset 55: normal modes, and complex ones of first and second order."""
DISPLACEMENT = (0, 1, 8)
"""Its data types that are displacements: unknown, general, displacement."""
FULL = (0, 2, 3)
"""Its data characteristics with x, y and z: unknown, three and six degrees of freedom."""
OUT_OF_PHASE = 0.1
"""Share of a complex mode, of its mean square, that may move out of phase with the rest."""
_EXPORT = "Export it again."


def serve_universal(path: str, given: dict[str, Any], answers: BinaryIO) -> None:
    """Read the modes of a universal file, as `read_modal_structure` is asked, and send them to `answers`."""
    file = Path(path)
    along, force = (_axis(name, given[name], file.name) for name in ("along", "force"))
    modes, nodes, units = _datasets(file)
    length, newtons = _units(units, given, file.name)
    numbers, places = _path(nodes, along, given["nodes"], modes, file.name)
    read = [_mode(mode, numbers, force, given["damping"], file.name) for mode in modes]
    frequencies, ratios, masses, shapes = (list(values) for values in zip(*read, strict=True))
    order = np.argsort(places)
    normalised = np.column_stack(shapes)[order] / np.sqrt(masses) * np.sqrt(length / newtons)
    names = ["positions", "natural_frequencies", "damping_ratios", "mode_shapes"]
    send(
        answers,
        names,
        [places[order] * length, np.array(frequencies), np.array(ratios), normalised],
    )


def _axis(name: str, given: object, source: str) -> int:
    if given not in AXES:
        what = "path" if name == "along" else "contact force"
        remedy = f"Say in which direction of the file the {what} lies."
        raise InputError(f"{name} of {source}", shown(given), 'one of "x", "y", "z"', remedy)
    return AXES.index(str(given))


def _datasets(file: Path) -> tuple[list[dict[str, Any]], list[dict[str, Any]], dict[str, Any] | None]:
    """Modes, nodes and units of a file."""
    try:
        import pyuff
    except ImportError:
        allowed = "a text table or netCDF; universal files with pyuff"
        remedy = 'Install it: pip install "asperity[uff]".'
        raise InputError(file.name, "a universal file", allowed, remedy) from None
    with hostile(file.name, "universal"):
        opened = pyuff.UFF(str(file))
        types = [str(kind).strip() for kind in opened.get_set_types()]
        types = [kind.removesuffix(".0") for kind in types]
        wanted = [i for i, kind in enumerate(types) if kind in ("15", "55", "164", "2411")]
        read = [opened.read_sets(i) for i in wanted]
    found = {"15": [], "55": [], "164": [], "2411": []}  # type: dict[str, list[dict[str, Any]]]
    for i, content in zip(wanted, read, strict=True):
        found[types[i]].append(content)
    modes = [each for each in found["55"] if each.get("analysis_type") in (NORMAL, *COMPLEX)]
    nodes = found["15"] + found["2411"]
    if not modes or not nodes:
        received = f"datasets {listed(types) or 'of no kind'}"
        raise InputError(file.name, received, "modes in datasets 55 and nodes in dataset 15 or 2411", _EXPORT)
    return modes, nodes, found["164"][-1] if found["164"] else None


def _units(stated: dict[str, Any] | None, given: dict[str, Any], source: str) -> tuple[float, float]:
    """Length, m, and force, N, of one of the units of a file."""
    found = []
    for name, dimension in (("length", "m"), ("force", "N")):
        key = f"{name}_unit"
        if given[key] is not None:
            found.append(factor(given[key], dimension))
        elif stated is not None and np.isfinite(stated[name]) and stated[name] > 0.0:
            found.append(1.0 / stated[name])
        else:
            raise InputError(source, f"no unit of {name}", "a dataset 164, or the unit given", f"Give {key}.")
    return found[0], found[1]


def _path(
    nodes: list[dict[str, Any]],
    along: int,
    chosen: list[int] | None,
    modes: list[dict[str, Any]],
    source: str,
) -> tuple[list[int], Array]:
    """Numbers of the nodes on the path and their places along it, in the file's unit of length."""
    place = {
        int(number): float(at)
        for each in nodes
        for number, at in zip(each["node_nums"], each[AXES[along]], strict=True)
    }
    turned = {int(system) for each in nodes for system in np.atleast_1d(each["disp_cs"])}
    if len(turned) > 1:
        received = f"nodes that move in {len(turned)} systems of coordinates"
        raise InputError(source, received, "modes in one global system", _EXPORT)
    shared = set.intersection(*({int(n) for n in mode["node_nums"]} for mode in modes)) & place.keys()
    numbers = sorted(shared) if chosen is None else chosen
    if missing := [number for number in numbers if number not in shared]:
        received = f"node {missing[0]}, which has no place or no shape in each mode"
        raise InputError(f"nodes of {source}", received, "nodes of the file")
    places = np.array([place[number] for number in numbers])
    if len(numbers) < 2 or np.unique(places).size < places.size:
        received = f"{len(numbers)} nodes at {np.unique(places).size} places along {AXES[along]}"
        remedy = "Choose those under the contact by nodes."
        raise InputError(source, received, "two nodes or more, one at each place", remedy)
    return numbers, places


def _mode(
    mode: dict[str, Any], numbers: list[int], force: int, damping: float | None, source: str
) -> tuple[float, float, float, Array]:
    """Frequency, Hz, damping ratio, modal mass and shape at the nodes, in the file's units."""
    if mode["spec_data_type"] not in DISPLACEMENT or mode["data_ch"] not in FULL:
        received = f"a mode as data of type {mode['spec_data_type']}, characteristic {mode['data_ch']}"
        raise InputError(source, received, "displacements in three or six degrees of freedom", _EXPORT)
    row = {int(number): i for i, number in enumerate(mode["node_nums"])}
    values = np.asarray(mode[f"r{force + 1}"])[[row[number] for number in numbers]]
    if mode["analysis_type"] == NORMAL:
        frequency, mass = float(mode["freq"]), float(mode["modal_m"])
        ratio = float(mode["modal_damp_vis"]) or 0.5 * float(mode["modal_damp_his"])
        shape = values.real.astype(float)
    else:
        eigenvalue = complex(mode["eig"])
        frequency = abs(eigenvalue) / (2.0 * np.pi)
        ratio = -eigenvalue.real / abs(eigenvalue) if eigenvalue else 0.0
        shape, turn = _real_mode(values, frequency, source)
        mass = float((complex(mode["modal_a"]) * turn**2 / (2j * abs(eigenvalue.imag) or 1.0)).real)
    if not mass > 0.0:
        received = f"a modal mass of {mass:.3g} of the mode at {frequency:.4g} Hz"
        raise InputError(source, received, "positive ones; 1 of mass-normalised modes", _EXPORT)
    if damping is None and not 0.0 < ratio < 1.0 and frequency > 0.0:
        received = f"a damping ratio of {ratio:.3g} of the mode at {frequency:.4g} Hz"
        raise InputError(source, received, "above 0, below 1", "Give damping, for all modes.")
    return frequency, ratio if damping is None else damping, mass, shape


def _real_mode(values: NDArray[np.complex128], frequency: float, source: str) -> tuple[Array, complex]:
    """Real shape nearest to a complex one, and the factor that turns that into phase with it."""
    squares = np.sum(values**2)
    turn = complex(np.exp(-0.5j * np.angle(squares)))
    turned = values * turn
    share = float(np.sum(turned.imag**2) / max(np.sum(np.abs(turned) ** 2), np.finfo(float).tiny))
    if share > OUT_OF_PHASE:
        received = f"{100 * share:.0f} % of the mode at {frequency:.4g} Hz out of phase"
        allowed = f"at most {100 * OUT_OF_PHASE:.0f} %: modes are taken as real"
        raise InputError(source, received, allowed, "Give its receptance instead.")
    return turned.real.astype(float), turn
