"""``asperity bearing --table``: stiffness and damping over load and speed, for programs of rotors."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from asperity.arguments import Array
from asperity.case.bearing_sections import LOAD
from asperity.case.loaded_bearing import LoadKeys, read_bearing
from asperity.errors import InputError
from asperity.parameters import ANGLE, FROM_PYTHON, Quantity
from asperity.structures.stiffness_table import SIGNS, BearingMatrices, stiffness_table
from asperity.studies.definition import expanded, separated
from asperity.terminal import say, say_table
from asperity.written_numbers import count_of, rounded

SPEED = Quantity("Hz", "1/min", at_least=0)
SWEPT = {"radial": LOAD, "axial": LOAD, "speed": SPEED}
"""What may have several values."""
MOST = 10_000
"""Solutions, of 24 cage angles each: some 5 ms."""
SHOWN = 12
"""Rows that are printed."""
ENDINGS = (".csv", ".json")
WIDTH = 110


def write_table(
    source: str, options: Mapping[str, Any], table: Path, cage_angle: str | None, load_direction: str | None
) -> dict[str, Any]:
    """Write the matrices of a bearing to a file, print some of them, and return what programs are told."""
    if table.suffix.lower() not in ENDINGS:
        raise InputError("--table", f"'{table}'", f"a name that ends in {' or '.join(ENDINGS)}")
    given = [name for name in SWEPT if options.get(name) is not None]
    several = {name: _values(name, options[name], SWEPT[name]) for name in given}
    keys = read_bearing(source, {**options, **dict.fromkeys(given)})
    if any(keys.held.values()):
        raise InputError("--table", "a tilt with it", "a ring that is held without tilt")
    over = {name: several.get(name, np.array([getattr(keys, name) or 0.0])) for name in SWEPT}
    count = int(np.prod([each.size for each in over.values()]))
    if count > MOST:
        raise InputError("--table", f"{count} combinations of loads and speeds", f"at most {MOST}")
    found = stiffness_table(
        keys.bearing,
        **over,
        cage_angles=None if cage_angle is None else _values("--cage-angle", cage_angle, ANGLE),
        load_direction=float(_values("--load-direction", load_direction or "0 deg", ANGLE)[0]),
        contact_damping=keys.contact_damping,
    )
    written = found.write(table).resolve()
    _say(found, keys, source)
    say(f"Table of {count_of(found.stiffness[..., 0, 0].size, 'row')}: {written}")
    return {"files": {"table": written}}


def _values(what: str, text: str, kind: Quantity) -> Array:
    """Values of a list or a range, as it is typed."""
    found = expanded(what, separated(text))
    try:
        return np.array([kind(value, FROM_PYTHON) for value in found])  # type: ignore[attr-defined]
    except InputError as error:
        raise error.about(what) from None


def _say(found: BearingMatrices, keys: LoadKeys, source: str) -> None:
    """The first rows, and what they mean."""
    heading = [
        "radial / N",
        "axial / N",
        "1/min",
        "kxx / (N/m)",
        "kyy / (N/m)",
        "kzz / (N/m)",
        "cxx / (N s/m)",
    ]
    rows = []
    for a, b, n in np.ndindex(*found.stiffness.shape[:3]):
        matrix = found.stiffness[a, b, n].mean(axis=0)
        damping = found.damping[a, b, n].mean(axis=0)
        at = found.radial[a], found.axial[b], 60.0 * found.speed[n]
        rows.append([rounded(each, 4) for each in (*at, *np.diag(matrix), damping[0, 0])])
    name = keys.name or source
    left = f", the first {SHOWN} of {len(rows)}" if len(rows) > SHOWN else ""
    say_table(
        f"{name}: stiffness and damping, means over cage angles{left}", heading, rows[:SHOWN], width=WIDTH
    )
    say(SIGNS)
    if found.bearing.ELEMENT == "roller":
        say("The inner ring is held against tilt.")
    if not found.contact_damping:
        say("No damping is known of a bearing: give that of each contact with --damping, or read a case.")
