"""A figure for each swept key of a study: what was asked for over it, and the force level in bands."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from asperity.reporting.style import INK, band_axis, new_figure, sequence, shade_doubtful, styled
from asperity.reporting.typed import typed_unit, typed_values, typed_words
from asperity.schema.spectra import BAND, BAND_TIME_PRODUCT, FORCE_LEVEL, LAW, START_SHARE
from asperity.spectra import say_little

MOST_LINES = 6
"""Values of other keys, or bands of one, that are told apart; the CSV file has all."""
MOST_PANELS = 6
"""Quantities in a figure; the table has all."""
PLACES = ("sensor", "point")
"""Dimensions over which levels are averaged; other words, as what radiates, are told apart."""
LETTERS = 26
"""In a line of the label of an axis."""
SPREAD = 20.0
"""Ratio of the largest value to the smallest from which the axis is logarithmic."""
WEIGHTED = f"{FORCE_LEVEL.name}_a"
_PREFIXES = {-9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}


@styled()
def key_figure(
    mean: xarray.Dataset,
    scatter: xarray.Dataset | None,
    key: str,
    looks: Mapping[str, Mapping[str, Any]],
    names: Sequence[str],
) -> Figure:
    """Draw what a swept key does: quantities over it, and the force level in bands for each value.

    `mean` and `scatter` are tables of a study without its seeds, if it swept any: `scatter` holds standard
    deviations under the same names. `looks` are line properties by law, `names` the quantities: those
    are drawn that are not zero or missing throughout. Where other keys are swept, too, the lines are those of
    the first law for their values.
    """
    others = [name for name in _swept(mean) if name != key]
    drawn = [name for name in names if name in mean and _says_something(mean[name])][:MOST_PANELS]
    rows = (len(drawn) + 1) // 2
    figure = new_figure(2.55 * rows + 3.4)
    figure.set_facecolor("white")  # it goes to a file of its own
    figure.suptitle(_title(mean, scatter, key, others), x=0.01, ha="left", fontweight="bold")
    grid = figure.add_gridspec(rows + 1, 2, height_ratios=[*[1.0] * rows, 1.25])
    told: list[list[str]] = []
    for n, name in enumerate(drawn):
        axes = figure.add_subplot(grid[n // 2, n % 2])
        size, label = _scale(mean[name])
        labels = []
        for place, style in _lines(mean, name, key, others, looks):
            reach = None if scatter is None else _along(scatter, name, key, place).mean("place") / size
            values = _over_places(_along(mean, name, key, place)) / size
            _draw_over_key(axes, mean[key], values, reach, style)
            labels.append(str(style["label"]))
        axes.set_ylabel(label)
        if any(labels) and labels not in told:
            own = LAW.name in mean[name].dims and labels[0] not in mean[LAW.name].values and not others
            axes.legend(fontsize=7.5, title=_main(mean) if own else None, title_fontsize=7.5)
            told.append(labels)
    _draw_bands(figure.add_subplot(grid[rows, :]), mean, key, others)
    return figure


def _says_something(values: xarray.DataArray) -> bool:
    """Whether a quantity without bands is anywhere neither missing nor zero."""
    flat = not any(str(dim).endswith(BAND.name) for dim in values.dims)
    return flat and bool((np.nan_to_num(np.asarray(values.values, dtype=float)) != 0.0).any())


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


def _scale(values: xarray.DataArray) -> tuple[float, str]:
    """Unit in which a quantity reads well, in SI, and the label of its axis."""
    what = str(values.attrs["long_name"]).removeprefix("A-weighted ").partition(",")[0].partition(":")[0]
    units = str(values.attrs["units"])
    if units == "1":
        size, unit = 0.01, "%"
    elif units.startswith("dB"):
        size, unit = 1.0, units.replace("uPa", "µPa").replace("m/s2", "m/s²")
    else:
        largest = np.nanmax(np.abs(values.values))
        power = 3 * math.floor(math.log10(largest) / 3) if largest > 0 else 0
        power = min(max(power, -9), 9)
        size, unit = 10.0**power, f"{_PREFIXES[power]}{units}"
    return size, f"{textwrap.fill(what, LETTERS)}\n/ {unit}"


def _lines(
    table: xarray.Dataset,
    name: str,
    key: str,
    others: Sequence[str],
    looks: Mapping[str, Mapping[str, Any]],
) -> list[tuple[dict[str, Any], dict[str, Any]]]:
    """Places that a line of a quantity goes through, and how it looks: laws, or values of other keys.

    Of what is told apart by other words, as what radiates, a line for each of them, or where other keys are
    swept the last of them, which is the whole.
    """
    held = table[name]
    law = {LAW.name: _main(table)} if LAW.name in held.dims else {}
    own = [str(dim) for dim in held.dims if dim not in (key, *others, LAW.name, *PLACES)]
    if not others and own:
        found = [word for word in table[own[0]].values if held.sel({**law, own[0]: word}).notnull().any()]
        colours = sequence(len(found))
        return [
            ({**law, own[0]: word}, {"color": colour, "label": str(word)})
            for word, colour in zip(found, colours, strict=True)
        ]
    if not others:
        laws = [str(name) for name in table[LAW.name].values] if law else []
        lines = [({LAW.name: each}, {**looks.get(each, {}), "label": each}) for each in laws]
        return lines or [({}, {"color": INK, "label": ""})]
    here = law | {dim: table[dim].values[-1] for dim in own}
    places = list(product(*(range(table.sizes[name]) for name in others)))[:MOST_LINES]
    lines = []
    for place, colour in zip(places, sequence(len(places)), strict=True):
        at = {name: table[name].values[n] for name, n in zip(others, place, strict=True)}
        words = [f"{name} {typed_words(table[name])[n]}" for name, n in zip(others, place, strict=True)]
        lines.append(({**here, **at}, {"color": colour, "label": ", ".join(words)}))
    return lines


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
        little = say_little(here[BAND_TIME_PRODUCT.name], here.get(START_SHARE.name, 0.0))
        shade_doubtful(axes, band, little.any([dim for dim in little.dims if dim != BAND.name]).values)
    first = ", ".join(f"{name} {typed_words(table[name])[0]}" for name in others)
    axes.set_title(f"{_main(table)}{f', {first}' if first else ''}")
    axes.set_ylabel("force level / dB re 1 N")
    axes.legend(fontsize=7.5, ncols=3)
