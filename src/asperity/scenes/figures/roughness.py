"""Roughness of rail and wheel in bands of wavelength, on the axes that rail acoustics uses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.reporting.axes import band_axis, doubtful_boxes, levels_axis
from asperity.reporting.chart import (
    BLUE,
    INK,
    MUTED,
    VERMILLION,
    Axis,
    Chart,
    Dashes,
    Line,
    Note,
    Panel,
    Rules,
    Second,
)
from asperity.reporting.data import doubtful, engineering, nominal_band, number, stored_variable
from asperity.reporting.force_figures import doubtful_words, product_series
from asperity.reporting.part import Data, Part, Series, series
from asperity.scenes import schema
from asperity.schema.contact import HERTZ_RADIUS
from asperity.schema.rolling import SPEED

ROUGHNESS, BAND, PRODUCT = schema.ROUGHNESS_LEVEL, schema.SURFACE_BAND, schema.SURFACE_BAND_LENGTH_PRODUCT
SPAN = 60.0
"""Levels, dB, that are drawn below the highest: a texture without waves leaves rounding errors."""
_LOOK: dict[str, tuple[str, Dashes, float, str]] = {
    "rail": (BLUE, (), 1.4, "o"),
    "wheel": (VERMILLION, (6, 1.5), 1.4, "s"),
    "combined": (INK, (1.5, 1.5), 1.8, ""),
}


def _parts(tree: DataTree) -> dict[str, Series]:
    """Levels by part; a part without any level is left out."""
    found = stored_variable(tree, ROUGHNESS)
    assert found is not None
    names = [str(name) for name in found["part"].values]
    rows = np.asarray(found.transpose(*ROUGHNESS.dims).values, dtype=float)
    return {
        name: Series(name, ROUGHNESS.units, row)
        for name, row in zip(names, rows, strict=True)
        if np.isfinite(row).any()
    }


def roughness_data(tree: DataTree) -> Data:
    """Roughness levels per wavelength band and part."""
    return Data(series(tree, BAND, "wavelength"), product_series(tree, PRODUCT) | _parts(tree))


def _drawn(data: Data) -> tuple[NDArray[np.bool_], dict[str, NDArray[np.float64]]]:
    """Bands in which some part reaches into the span, and the levels there."""
    levels = {line.name: line.values for line in data.lines.values() if line.units == ROUGHNESS.units}
    lowest = max(np.nanmax(level) for level in levels.values()) - SPAN
    drawn = {name: np.where(level >= lowest, level, np.nan) for name, level in levels.items()}
    kept = np.isfinite(np.stack(list(drawn.values()))).any(axis=0)
    return kept, {name: level[kept] for name, level in drawn.items()}


def roughness_chart(tree: DataTree, data: Data) -> Chart:
    """Roughness levels per one-third octave of wavelength, long waves on the left."""
    kept, levels = _drawn(data)
    wavelength = data.at[kept]
    lines = [
        Line(wavelength, level, name, *_LOOK.get(name, (MUTED, (), 1.4, "^")))
        for name, level in levels.items()
    ]
    axis = levels_axis("roughness level / dB re 1 µm", [line.y for line in lines], span=100.0, step=5.0)
    along = _wavelength_axis(tree, np.sort(wavelength))
    marks = (*doubtful_boxes(wavelength, doubtful(tree, PRODUCT)[kept]), *_contact(tree, wavelength), *lines)
    return Chart((Panel(along, axis, marks, height=4.2),))


def _wavelength_axis(tree: DataTree, wavelength: NDArray[np.float64]) -> Axis:
    """Bands of wavelength, named in mm, long waves on the left, and the frequency opposite."""
    axis = band_axis(wavelength, "wavelength / mm", _millimetres)
    speed = number(tree, SPEED)
    frequency = None
    if speed:
        frequency = Second(f"frequency v/λ, at v = {speed:.3g} m/s", speed, inverse=True, unit="Hz")
    return replace(axis, low=axis.high, high=axis.low, second=frequency)


def _millimetres(wavelength: float) -> str:
    """Nominal name of a band of wavelength in mm, as ``"31.5"`` or ``"1000"``."""
    return f"{float(nominal_band(wavelength)) * 1e3:g}" if wavelength < 900 else f"{1e3 * wavelength:g}"


def _contact(tree: DataTree, wavelength: NDArray[np.float64]) -> list[Rules | Note]:
    """The length of the contact, where it is among the wavelengths."""
    length = 2 * (number(tree, HERTZ_RADIUS) or 0.0)
    if not wavelength.min() < length < wavelength.max():
        return []
    words = f"length of the contact, 2a = {engineering(length, 'm')}"
    return [Rules(np.array([length]), colour=INK), Note(words, length, 0.97, y_share=True, align="right")]


def _caption(tree: DataTree) -> str:
    combined = " Combined: rail and wheel as they meet in the contact." if "combined" in _parts(tree) else ""
    return (
        "Roughness levels per one-third octave of wavelength, re 1 µm, of the textures that were rolled, "
        f"before any contact filter.{combined} Left out: bands that the texture "
        f"does not hold, and levels more than {SPAN:.0f} dB below the highest."
        + doubtful_words(tree, PRODUCT).replace("time B T", "length B T")
    )


ROUGHNESS_LEVELS = Part(
    "roughness",
    "Roughness of rail and wheel",
    (ROUGHNESS, BAND),
    roughness_data,
    roughness_chart,
    _caption,
)
