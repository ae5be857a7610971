"""Roughness of rail and wheel in bands of wavelength, on the axes that rail acoustics uses."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator
from numpy.typing import NDArray
from xarray import DataTree

from asperity.kinds.wheel_on_rail import schema
from asperity.reporting.data import doubtful, engineering, nominal_band, number, stored_variable
from asperity.reporting.part import Data, Part, Series, series
from asperity.reporting.spectrum_figures import doubtful_words, product_series
from asperity.reporting.style import (
    BLUE,
    INK,
    MUTED,
    VERMILLION,
    level_limits,
    new_figure,
    shade_doubtful,
    styled,
)
from asperity.schema.contact import HERTZ_RADIUS
from asperity.schema.rolling import SPEED

ROUGHNESS, BAND, PRODUCT = schema.ROUGHNESS_LEVEL, schema.SURFACE_BAND, schema.SURFACE_BAND_LENGTH_PRODUCT
SPAN = 60.0
"""Levels, dB, that are drawn below the highest: a texture without waves leaves rounding errors."""
_LOOK = {
    "rail": (BLUE, "-", "o"),
    "wheel": (VERMILLION, (0, (6, 1.5)), "s"),
    "combined": (INK, (0, (1.5, 1.5)), ""),
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


@styled()
def roughness_figure(tree: DataTree, data: Data) -> Figure:
    """Roughness levels per one-third octave of wavelength, long waves on the left."""
    figure = new_figure(4.2)
    axes = figure.subplots()
    kept, levels = _drawn(data)
    wavelength = data.at[kept]
    for name, level in levels.items():
        colour, dashes, marker = _LOOK.get(name, (MUTED, "-", "^"))
        thick = 1.8 if name == "combined" else 1.4
        axes.plot(
            wavelength, level, color=colour, linestyle=dashes, marker=marker, label=name, linewidth=thick
        )
    level_limits(axes, levels.values(), span=100.0, step=5.0)
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + 0.1 * (high - low))  # room for a note
    axes.set_ylabel("roughness level / dB re 1 µm")
    _wavelength_axis(axes, wavelength)
    speed = number(tree, SPEED)
    if speed:
        _frequency_on_top(axes, wavelength, speed)
    _mark_contact(axes, tree)
    shade_doubtful(axes, wavelength, doubtful(tree, PRODUCT)[kept])
    axes.legend(loc="best")
    return figure


def _wavelength_axis(axes: Axes, wavelength: NDArray[np.float64]) -> None:
    edge = 10**0.05
    axes.set_xscale("log")
    axes.set_xlim(wavelength.max() * edge, wavelength.min() / edge)
    axes.xaxis.set_major_locator(FixedLocator(wavelength.tolist()))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda w, _: _millimetres(w)))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.tick_params(axis="x", labelrotation=90)
    axes.set_xlabel("wavelength / mm")


def _millimetres(wavelength: float) -> str:
    """Nominal name of a band of wavelength in mm, as ``"31.5"`` or ``"1000"``."""
    return f"{float(nominal_band(wavelength)) * 1e3:g}" if wavelength < 900 else f"{1e3 * wavelength:g}"


def _frequency_on_top(axes: Axes, wavelength: NDArray[np.float64], speed: float) -> None:
    top = axes.twiny()
    top.set_xscale("log")
    top.set_xlim(axes.get_xlim())
    top.grid(visible=False)
    octaves = 1000 * 10 ** (np.arange(-30, 22, 3) / 10)
    shown = [f for f in octaves if wavelength.min() <= speed / f <= wavelength.max()]
    top.xaxis.set_major_locator(FixedLocator([speed / f for f in shown]))
    top.xaxis.set_major_formatter(FuncFormatter(lambda w, _: nominal_band(speed / w)))
    top.xaxis.set_minor_locator(NullLocator())
    top.set_xlabel(f"frequency v/λ / Hz, at v = {speed:.3g} m/s")


def _mark_contact(axes: Axes, tree: DataTree) -> None:
    radius = number(tree, HERTZ_RADIUS)
    if not radius or not axes.get_xlim()[1] < 2 * radius < axes.get_xlim()[0]:
        return
    axes.axvline(2 * radius, color=INK, linewidth=0.9, linestyle=":")
    axes.annotate(
        f"length of the contact, 2a = {engineering(2 * radius, 'm')}", (2 * radius, 0.97),
        xycoords=axes.get_xaxis_transform(), xytext=(-5, 0), textcoords="offset points",
        va="top", ha="right", fontsize=8.5, color=MUTED,
    )  # fmt: skip


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
    roughness_figure,
    _caption,
)
