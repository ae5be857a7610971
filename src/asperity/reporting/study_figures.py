"""A figure for each swept key of a study: dB(A), largest force and lost contact over it, and bands."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from asperity.reporting.data import force_unit
from asperity.reporting.style import INK, band_axis, new_figure, sequence, shade_doubtful, styled
from asperity.reporting.typed import typed_unit, typed_values, typed_words
from asperity.schema.rolling import CONTACT_LOSS_SHARE
from asperity.schema.spectra import BAND, BAND_TIME_PRODUCT, FORCE_LEVEL, LAW
from asperity.spectra import LEAST_PRODUCT

MOST_LINES = 6
"""Values of other keys, or bands of one, that are told apart; the CSV file has all."""
LETTERS = 26
"""In a line of the label of an axis."""
SPREAD = 20.0
"""Ratio of the largest value to the smallest from which the axis is logarithmic."""
WEIGHTED = f"{FORCE_LEVEL.name}_a"


@styled()
def key_figure(
    mean: xarray.Dataset, scatter: xarray.Dataset | None, key: str, looks: Mapping[str, Mapping[str, Any]]
) -> Figure:
    """Draw what a swept key does: four quantities over it, and the force level in bands for each value.

    `mean` and `scatter` are tables of a study without its seeds, if it swept any: `scatter` holds standard
    deviations under the same names. `looks` are line properties by law. Where other keys are swept, too, the
    lines are those of the first law for their values.
    """
    others = [name for name in _swept(mean) if name != key]
    figure = new_figure(8.6)
    figure.set_facecolor("white")  # it goes to a file of its own
    figure.suptitle(_title(mean, scatter, key, others), x=0.01, ha="left", fontweight="bold")
    grid = figure.add_gridspec(3, 2, height_ratios=[1, 1, 1.25])
    panels = [figure.add_subplot(grid[n // 2, n % 2]) for n in range(4)]
    for axes, (name, label, size) in zip(panels, _quantities(mean), strict=False):
        for place, style in _lines(mean, key, others, looks):
            reach = None if scatter is None else _along(scatter, name, key, place).mean("place") / size
            _draw_over_key(axes, mean[key], _over_places(_along(mean, name, key, place)) / size, reach, style)
        axes.set_ylabel(label)
    for axes in panels[len(_quantities(mean)) :]:
        axes.set_axis_off()
    panels[0].legend(fontsize=7.5)
    _draw_bands(figure.add_subplot(grid[2, :]), mean, key, others)
    return figure


def _swept(table: xarray.Dataset) -> list[str]:
    held = table[WEIGHTED if WEIGHTED in table else "mean_force"].dims
    return [str(dim) for dim in held if dim != LAW.name]


def _title(mean: xarray.Dataset, scatter: xarray.Dataset | None, key: str, others: Sequence[str]) -> str:
    told = [f"{mean[key].attrs['long_name']}"]
    if scatter is not None:
        told.append("mean ± standard deviation over the seeds")
    if others:
        told.append(f"{_main(mean)} alone, a line for each {' and '.join(others)}")
    return f"{key}: {', '.join(told)}"


def _main(table: xarray.Dataset) -> str:
    return str(table[LAW.name].values[0])


def _quantities(table: xarray.Dataset) -> list[tuple[str, str, float]]:
    """What is drawn over the key: name, label of the axis, and its unit in SI."""
    motion = [
        str(name)
        for name, values in table.data_vars.items()
        if str(values.attrs.get("units", "")).startswith("dB(A)") and name != WEIGHTED
    ]
    size, symbol = force_unit(float(np.nanmax(table["peak_force"].values)))
    wanted = [(WEIGHTED, "force level / dB(A) re 1 N", 1.0)]
    heard = sorted(motion, key=lambda name: table[name].ndim)[:1]  # rather sound than motion at places
    wanted += [(name, _level_label(table[name]), 1.0) for name in heard]
    wanted += [
        ("peak_force", f"largest force / {symbol}", size),
        (CONTACT_LOSS_SHARE.name, "time without contact / %", 0.01),
        ("rms_force", f"force, rms about its mean / {symbol}", size),
    ]
    return [item for item in wanted if item[0] in table][:4]


def _level_label(level: xarray.DataArray) -> str:
    what = str(level.attrs["long_name"]).removeprefix("A-weighted ").partition(",")[0]
    units = str(level.attrs["units"]).replace("uPa", "µPa")
    return f"{textwrap.fill(what, LETTERS)}\n/ {units}"


def _lines(
    table: xarray.Dataset, key: str, others: Sequence[str], looks: Mapping[str, Mapping[str, Any]]
) -> list[tuple[dict[str, Any], dict[str, Any]]]:
    """Places that a line goes through, and how it looks: laws, or values of other keys."""
    if not others:
        laws = [str(law) for law in table[LAW.name].values]
        return [({LAW.name: law}, {**looks.get(law, {}), "label": law}) for law in laws]
    places = list(product(*(range(table.sizes[name]) for name in others)))[:MOST_LINES]
    found = []
    for place, colour in zip(places, sequence(len(places)), strict=True):
        here = {name: table[name].values[at] for name, at in zip(others, place, strict=True)}
        words = [f"{name} {typed_words(table[name])[at]}" for name, at in zip(others, place, strict=True)]
        found.append(({LAW.name: _main(table), **here}, {"color": colour, "label": ", ".join(words)}))
    return found


def _along(table: xarray.Dataset, name: str, key: str, place: Mapping[str, Any]) -> xarray.DataArray:
    """A quantity over a key and over the places on a body."""
    held = table[name].sel({dim: at for dim, at in place.items() if dim in table[name].dims})
    rest = [dim for dim in held.dims if dim != key]
    return held.stack(place=rest, create_index=False) if rest else held.expand_dims("place", -1)


def _over_places(level: xarray.DataArray) -> xarray.DataArray:
    """Energy mean of levels at several places."""
    if level.sizes["place"] == 1:
        return level.isel(place=0)
    power: xarray.DataArray = 10.0 ** (level / 10.0)
    mean = power.mean("place")
    return mean.copy(data=10.0 * np.log10(mean.values))


def _draw_over_key(
    axes: Axes,
    key: xarray.DataArray,
    found: xarray.DataArray,
    reach: xarray.DataArray | None,
    style: Mapping[str, Any],
) -> None:
    values, at = np.asarray(found.values, dtype=float), typed_values(key)
    words = key.dtype.kind == "U"
    x = np.arange(len(at), dtype=float) if words else np.array(at, dtype=float)
    order = np.argsort(x)
    joined = {**style, "linestyle": "none"} if words else style  # nothing lies between words
    axes.plot(x[order], values[order], marker="o", markersize=3.5, **joined)
    if reach is not None and np.isfinite(reach.values).any():
        colour = style.get("color", INK)
        axes.errorbar(x, values, yerr=reach.values, fmt="none", ecolor=colour, elinewidth=0.9, capsize=2.5)
    if words:
        axes.set_xticks(x, at)
        axes.set_xlim(-0.5, len(at) - 0.5)
    elif x.min() > 0 and x.max() / x.min() > SPREAD:
        axes.set_xscale("log")
    unit = typed_unit(key)
    axes.set_xlabel(f"{key.name} / {unit}" if unit not in ("", "1") else str(key.name))


def _draw_bands(axes: Axes, table: xarray.Dataset, key: str, others: Sequence[str]) -> None:
    """Force level of the first law in each band, a line for each value of the key."""
    if FORCE_LEVEL.name not in table:
        axes.set_axis_off()
        return
    count = table.sizes[key]
    shown = np.unique(np.linspace(0, count - 1, min(count, MOST_LINES)).round().astype(int))
    here = table.isel(dict.fromkeys(others, 0)).sel({LAW.name: _main(table)})
    band, words = table[BAND.name].values, typed_words(table[key])
    for at, colour in zip(shown, sequence(len(shown)), strict=True):
        level = here[FORCE_LEVEL.name].isel({key: at}).values
        axes.plot(band, level, color=colour, label=words[at], marker="o", markersize=2.5)
    band_axis(axes, band)
    if BAND_TIME_PRODUCT.name in here:
        product_of = here[BAND_TIME_PRODUCT.name]
        least = product_of.min([dim for dim in product_of.dims if dim != BAND.name]).values
        shade_doubtful(axes, band, least < LEAST_PRODUCT)
    first = ", ".join(f"{name} {typed_words(table[name])[0]}" for name in others)
    axes.set_title(f"{_main(table)}{f', {first}' if first else ''}")
    axes.set_ylabel("force level / dB re 1 N")
    axes.legend(fontsize=7.5, ncols=3)
