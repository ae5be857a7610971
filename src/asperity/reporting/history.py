"""The contact force of a whole run, laid out for a browser, in which it is zoomed and read by cursor."""

from __future__ import annotations

import base64
import hashlib
import json
import zlib
from dataclasses import replace
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.reporting.data import values
from asperity.reporting.law_entries import baselines_among, law_colours, law_entry, pulling
from asperity.reporting.part import by_law
from asperity.reporting.style import envelope
from asperity.reporting.time_figures import (
    FORCE_ENVELOPE,
    force_unit_of,
    lost,
    main_limits,
    stretches,
    time_unit,
)
from asperity.schema.rolling import CONTACT_FORCE, TIME

MOST = 300_000
"""Numbers of all laws that are laid out; a longer run is shown by the extremes of stretches of it."""
LEVELS = 2**14 - 1
"""Steps between the lowest and the highest force of a law: finer than any screen."""


def history(tree: DataTree) -> dict[str, Any]:
    """What the script of the page draws: times, laws with their look and losses of contact, packed forces."""
    time, forces = values(tree, TIME), {law: s.values for law, s in by_law(tree, CONTACT_FORCE).items()}
    main, duration = next(iter(forces)), float(time[-1] - time[0])
    unit = time_unit(duration)
    size, symbol = force_unit_of(tree)
    low, high = main_limits(forces, pulling(tree))
    colours = list(law_colours(tree))
    beside = {main, *baselines_among(tree, list(forces))[:1]}  # what a reader sees first
    steps = _steps_per_point(len(time), len(forces))
    laws, packed = [], []
    for law, force in forces.items():
        flight, shown = lost(tree, law, force), _thinned(force, steps)
        entry, (bottom, top) = law_entry(tree, law), (float(shown.min()), float(shown.max()))
        packed.append(_packed(shown, bottom, top))
        laws.append(
            {
                "name": law,
                "main": law == main,
                "colour": f"--c{colours.index(entry.colour)}",
                "dashes": [] if isinstance(entry.dashes, str) else list(entry.dashes[1]),
                "lowest": bottom / size,
                "step": (top - bottom) / LEVELS / size,
                "shown": law in beside and bottom >= low and top <= high,
                "losses": stretches(flight),
            }
        )
    return {
        "laws": laws,
        "points": len(packed[0]) // 2,
        "steps": steps,
        "pitch": duration / (len(packed[0]) // 2 - (steps == 1)) / unit[0],
        "start": float(time[0]) / unit[0],
        "interval": duration / (len(time) - 1) / unit[0],
        "time": unit[1],
        "force": symbol,
        "data": base64.b64encode(zlib.compress(b"".join(packed), 6)).decode("ascii"),
    }


def _steps_per_point(steps: int, laws: int) -> int:
    """Time steps to a point: one, or as many as a long run takes, each with its lowest or highest force."""
    return max(1, -(-steps * laws // MOST))


def _thinned(force: NDArray[np.float64], steps: int) -> NDArray[np.float64]:
    """The force, or, two by two, its extremes in stretches of twice `steps`."""
    if steps == 1:
        return force
    _, low, high = envelope(force, max(1, len(force) // (2 * steps)))
    return np.stack([low, high], axis=1).ravel()


def _packed(force: NDArray[np.float64], low: float, high: float) -> bytes:
    """Second differences of a force in steps of its range, first their low bytes, then their high ones."""
    steps = np.rint((force - low) / ((high - low) or 1.0) * LEVELS).astype(np.int64)
    changes = np.diff(np.diff(steps, prepend=0), prepend=0)
    return (changes & 0xFFFF).astype("<u2").view(np.uint8).reshape(-1, 2).T.tobytes()


FORCE_HISTORY = replace(FORCE_ENVELOPE, live=history)
"""The whole run: drawn, and in a browser to be zoomed and read."""


def as_json(found: dict[str, Any]) -> str:
    """JSON that may stand in a script element: nothing in it ends the element."""
    return json.dumps(found, ensure_ascii=True).replace("<", "\\u003c")


@cache
def script() -> str:
    """The script of the page: the library that draws, with its licence, and what the page does with it."""
    library = files("asperity.reporting") / "uplot"
    code = (library / "uPlot.iife.min.js").read_text(encoding="utf-8").partition("\n")[2]
    licence = (library / "LICENSE").read_text(encoding="utf-8")
    own = (files("asperity.reporting") / "history.js").read_text(encoding="utf-8")
    return f"/*! uPlot 1.6.32\n{licence}\n*/\n{code}\n{own}"


@cache
def script_style() -> str:
    """Styles that the library needs."""
    return (files("asperity.reporting") / "uplot" / "uPlot.min.css").read_text(encoding="utf-8")


def script_digest() -> str:
    """Digest of the script, by which a page allows it and nothing else to run."""
    return base64.b64encode(hashlib.sha256(script().encode("utf-8")).digest()).decode("ascii")
