"""Arrays in little room, for a browser to unpack: each once, in steps, in levels, or in single precision."""

import base64
import hashlib
import json
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass, replace
from functools import cache
from typing import Any

import numpy as np

from asperity.arguments import Array
from asperity.files import packaged
from asperity.reporting import chart
from asperity.reporting.chart import Axis, Chart, Field, Line, Mark, Panel, envelope

LONG = 1000
"""Numbers from which an array is kept in levels."""
LEVELS = 2**14 - 2
"""Steps between the lowest and the highest number of such an array: finer than any screen."""


class Arrays:
    """Arrays in one run of bytes."""

    def __init__(self) -> None:
        self.told: list[dict[str, Any]] = []
        """How each is kept: ``start`` and ``step``, ``low`` and ``size`` of levels, or neither."""
        self._bytes: list[bytes] = []
        self._known: dict[tuple[bytes, bool, int], int] = {}

    def place(self, numbers: Array, linear: bool, levels: int = LEVELS) -> int:
        """Number under which an array is kept; one that is drawn on a `linear` axis may be rounded."""
        flat = np.ascontiguousarray(numbers, dtype=np.float64).ravel()
        key = (flat.tobytes(), linear, levels)
        if key not in self._known:
            self._known[key] = len(self.told)
            how, kept = _kept(flat, linear, levels)
            self.told.append({"count": flat.size, **how})
            self._bytes.append(kept)
        return self._known[key]

    @property
    def packed(self) -> str:
        """All of them: Base64 of zlib."""
        return base64.b64encode(zlib.compress(b"".join(self._bytes), 6)).decode("ascii")


def _kept(numbers: Array, linear: bool, levels: int) -> tuple[dict[str, float], bytes]:
    """How an array is kept, and its bytes."""
    if (steps := _steps(numbers)) is not None:
        return steps, b""
    finite = numbers[np.isfinite(numbers)]
    if linear and numbers.size > LONG and finite.size and not np.isinf(numbers).any():
        low = float(finite.min())
        size = float(np.ptp(finite)) / levels
        return {"low": low, "size": size}, _levels((numbers - low) / (size or 1.0))
    with np.errstate(over="ignore"):
        single = numbers.astype("<f4")
    return {}, _planes(single)


def _steps(numbers: Array) -> dict[str, float] | None:
    """Start and step of numbers that are equally spaced."""
    if numbers.size < 3 or not np.isfinite(numbers).all():
        return None
    start = float(numbers[0])
    step = float(numbers[-1] - numbers[0]) / (numbers.size - 1)
    off = np.abs(start + step * np.arange(numbers.size) - numbers).max()
    return {"start": start, "step": step} if off <= 1e-6 * abs(step) else None


def _levels(heights: Array) -> bytes:
    """Second differences of levels, modulo 2¹⁶; level 0 is a missing number, 1 the lowest."""
    levels = np.nan_to_num(np.rint(heights) + 1.0, nan=0.0).astype(np.int64)
    changes = np.diff(np.diff(levels, prepend=0), prepend=0)
    return _planes((changes & 0xFFFF).astype("<u2"))


def _planes(numbers: np.ndarray) -> bytes:
    """First bytes of all numbers, then their second ones, and so on: alike ones pack better."""
    return numbers.view(np.uint8).reshape(-1, numbers.itemsize).T.tobytes()


MOST = 300_000
"""Numbers of the lines of a chart; longer ones are shown by the extremes of stretches of them."""
PIXELS = (800, 320)
"""Of a field, along x and along y."""
SHADES = 1022
"""Of a field, from the lowest number to the highest."""
COLOURED = ("colour", "fill", "edge")
SCRIPTS = ("numbers", "ticks", "marks", "panel", "cursor", "legend", "figures")


def charts_json(charts: Mapping[str, Chart], colours: Mapping[str, str], unticked: Sequence[str] = ()) -> str:
    """What the script draws, by the name of its figure, as text that may stand in a script element.

    `colours` are those of the page, in the order of its CSS variables; `unticked` are the laws that are not
    shown until they are ticked.
    """
    arrays = Arrays()
    look = list(colours)
    told = {
        name: {"panels": [_panel(panel, arrays, look) for panel in _thinned(drawn).panels]}
        for name, drawn in charts.items()
    }
    found: dict[str, Any] = {"charts": told, "colours": look, "arrays": arrays.told, "data": arrays.packed}
    found |= {"unticked": list(unticked)} if unticked else {}
    text = json.dumps(found, ensure_ascii=True, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c")  # so that nothing in it ends the element


def _thinned(drawn: Chart) -> Chart:
    """The chart with as many numbers as a page holds, and fields as fine as can be seen."""
    lines = [mark for panel in drawn.panels for mark in panel.marks if isinstance(mark, Line)]
    steps = -(-sum(line.y.size for line in lines) // MOST)
    panels = (replace(panel, marks=tuple(_thinner(m, steps) for m in panel.marks)) for panel in drawn.panels)
    return replace(drawn, panels=tuple(panels))


def _thinner(mark: Mark, steps: int) -> Mark:
    """Every n-th cell of a field; of a long line the extremes of stretches of twice as many `steps`."""
    if isinstance(mark, Field):
        sizes = zip(mark.values.shape, PIXELS, strict=True)
        every = tuple(slice(None, None, -(-size // most)) for size, most in sizes)
        return replace(mark, values=mark.values[every])
    if not isinstance(mark, Line) or steps <= 1 or mark.y.size <= LONG:
        return mark
    stretches = mark.y.size // (2 * steps)
    kept = 2 * steps * stretches
    low, high = envelope(mark.y[:kept], stretches)[1:]
    return replace(mark, x=mark.x[:kept:steps], y=np.stack([low, high], axis=1).ravel())


def _panel(panel: Panel, arrays: Arrays, colours: list[str]) -> dict[str, Any]:
    """A panel in plain words and numbers, without what is the default."""

    def told(owner: Any) -> dict[str, Any]:
        held = {each.name: (getattr(owner, each.name), each.default) for each in fields(owner)}
        return {
            name: plainly(value, name, owner)
            for name, (value, default) in held.items()
            if isinstance(value, np.ndarray) or value != default
        }

    def plainly(value: Any, name: str, owner: Any) -> Any:
        match value:
            case np.ndarray() if isinstance(owner, Field):
                return {"array": arrays.place(value, True, SHADES), "shape": value.shape}
            case np.ndarray():
                return arrays.place(value, linear=not _axis(panel, owner, name).log)
            case tuple():
                return [plainly(each, name, owner) for each in value]
            case str() if name in COLOURED and value in colours:
                return f"--c{colours.index(value)}"
            case float():  # of numpy, too
                return float(value) if np.isfinite(value) else None
        if is_dataclass(value):
            kind = {"kind": type(value).__name__.lower()} if name == "marks" else {}
            return kind | told(value)
        return value

    def somewhere(mark: Mark) -> bool:
        return not isinstance(mark, chart.Note) or bool(np.isfinite([mark.x, mark.y]).all())

    return told(replace(panel, marks=tuple(filter(somewhere, panel.marks))))


def _axis(panel: Panel, mark: Mark, name: str) -> Axis:
    """Axis along which an array of a mark is drawn."""
    along_y = mark.along == "y" if isinstance(mark, chart.Rules) else name in ("y", "low", "high")
    return panel.y if along_y else panel.x


@cache
def chart_script() -> str:
    """The script of a page: the library that draws axes, with its licence, and what draws charts with it."""
    library = packaged("reporting/uplot/uPlot.iife.min.js").partition("\n")[2]
    licence = packaged("reporting/uplot/LICENSE")
    own = (packaged(f"reporting/charts/{name}.js") for name in SCRIPTS)
    return f'/*! uPlot 1.6.32\n{licence}\n*/\n{library}\n(() => {{\n"use strict";\n{"".join(own)}}})();\n'


@cache
def chart_style() -> str:
    """Styles of charts, and those that the library needs."""
    return f"{packaged('reporting/uplot/uPlot.min.css')}\n{packaged('reporting/charts/charts.css')}"


def digest_of(script: str) -> str:
    """SHA-256 of a script, as policies of pages name it."""
    return base64.b64encode(hashlib.sha256(script.encode("utf-8")).digest()).decode("ascii")
