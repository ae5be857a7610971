"""Figures of studies, seeds and optimised textures."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from asperity.reporting.axes import EDGE, band_axis, doubtful_boxes, levels_axis, words_axis
from asperity.reporting.chart import (
    INK,
    MUTED,
    Area,
    Axis,
    Boxes,
    Chart,
    Dashes,
    Line,
    Mark,
    Numbers,
    Panel,
    Second,
    sequence_styles,
)
from asperity.reporting.data import typed_unit, typed_values, typed_words, written_units
from asperity.reporting.force_figures import main_last
from asperity.schema.spectra import BAND, BAND_TIME_PRODUCT, FORCE_LEVEL, LAW, START_SHARE
from asperity.spectra import nominal_length, say_little

MOST_PANELS = 6
"""Members of other keys that are drawn; the CSV file has all of them."""
_ENDS = ("", "_low", "_high")


def ensemble_chart(bands: xarray.Dataset, looks: Mapping[str, Mapping[str, Any]]) -> Chart:
    """Force level of each law, mean and band, a panel for each value of the other keys.

    The dataset is from `asperity.prediction_band`, whose ``meaning`` is the caption; looks of lines by law.
    """
    others = [str(dim) for dim in bands[FORCE_LEVEL.name].dims if dim not in (LAW.name, BAND.name)]
    places = list(product(*(range(bands.sizes[dim]) for dim in others)))[:MOST_PANELS]
    return Chart(
        tuple(_band_panel(bands.isel(dict(zip(others, at, strict=True))), others, looks) for at in places)
    )


def _band_panel(here: xarray.Dataset, keys: list[str], looks: Mapping[str, Mapping[str, Any]]) -> Panel:
    """Levels of one value of each of the other keys."""
    centre = here[BAND.name].values
    marks: list[Mark] = []
    if BAND_TIME_PRODUCT.name in here:
        little = say_little(here[BAND_TIME_PRODUCT.name], here.get(START_SHARE.name, 0.0))
        marks += doubtful_boxes(centre, little.values)
    drawn = []
    for law in main_last(map(str, here[LAW.name].values)):
        mean, low, high = (here[f"{FORCE_LEVEL.name}{end}"].sel({LAW.name: law}).values for end in _ENDS)
        look = dict(looks.get(law, {}))
        shade = {key: look[key] for key in ("colour", "law") if key in look}
        marks += [
            Area(centre, low, high, opacity=0.2, **shade),
            Line(centre, mean, law, **{"marker": "o"} | look),
        ]
        drawn += [low, high]
    axis = levels_axis("contact force level / dB re 1 N", drawn, span=100.0)
    title = ", ".join(f"{here[key].name} = {typed_words(here[key].expand_dims('place'))[0]}" for key in keys)
    return Panel(band_axis(centre), axis, tuple(marks), title=title, height=3.2)


BEFORE, AFTER = "before", "after"
_DASHES: dict[str, Dashes] = {BEFORE: (1.5, 1.5), AFTER: ()}


@dataclass(frozen=True, eq=False)
class TextureBands:
    """Numbers of the figure, by one-third octave of wavelength (b,)."""

    wavelength: NDArray[np.float64]  # centres, m
    levels: Mapping[str, NDArray[np.float64]]  # before and after, dB re 1 µm
    lowest: NDArray[np.float64]  # bounds of the levels; NaN where a band was not to be changed
    highest: NDArray[np.float64]
    frequency: NDArray[np.float64]  # at which they are passed, Hz
    # level of the response while they are passed, dB, by law, before and after
    heard: Mapping[str, Mapping[str, NDArray[np.float64]]]


def optimised_chart(bands: TextureBands, heard: str, units: str, colours: Mapping[str, str]) -> Chart:
    """The texture above, and below what is heard of it in each band; colours by law."""
    edges = bands.wavelength / EDGE, bands.wavelength * EDGE
    bounds = np.stack([*edges, bands.lowest, bands.highest])
    left, right, low, high = bounds[:, np.isfinite(bounds).all(axis=0)]
    texture: list[Boxes | Line] = [Boxes(left, right, low, high, "allowed", MUTED, 0.15)]
    response = []
    for name, dashes in _DASHES.items():
        texture.append(Line(*_steps(*edges, bands.levels[name]), name, INK, dashes))
        for law, levels in bands.heard.items():
            look = colours.get(law, INK), dashes
            response.append(
                Line(bands.wavelength, levels[name], f"{law}, {name}", *look, marker="o", law=law)
            )
    along = _wavelengths(bands)
    found = [*bands.levels.values(), bands.lowest, bands.highest]
    above = levels_axis("roughness level / dB re 1 µm", found)
    return Chart(
        (
            Panel(along, above, tuple(texture), height=3.2),
            Panel(along, Axis(f"in the band / {written_units(units)}"), tuple(response), heard, height=3.2),
        )
    )


def _wavelengths(bands: TextureBands) -> Axis:
    """Bands by wavelength, long waves on the left, and opposite the frequency at which they are passed."""
    axis = band_axis(np.sort(bands.wavelength), "one-third octave of wavelength", nominal_length)
    speed = float(np.median(bands.wavelength * bands.frequency))
    second = Second("frequency at which it is passed", speed, inverse=True, unit="Hz")
    return replace(axis, low=axis.high, high=axis.low, second=second, linked="wavelength")


def _steps(left: Numbers, right: Numbers, level: Numbers) -> tuple[Numbers, Numbers]:
    """A line that keeps its height within each band."""
    order = np.argsort(left)
    return np.stack([left, right], axis=1)[order].ravel(), np.repeat(level[order], 2)


MOST_LINES = 6
"""Values of other keys, or bands of one, that are told apart; the CSV file has all."""
"""Quantities in a figure; the table has all."""
PLACES = ("sensor", "point")
"""Dimensions over which levels are averaged; other words, as what radiates, are told apart."""
SPREAD = 20.0
"""Ratio of the largest value to the smallest from which the axis is logarithmic."""
WEIGHTED = f"{FORCE_LEVEL.name}_a"
_PREFIXES = {-9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}


def key_chart(
    mean: xarray.Dataset,
    scatter: xarray.Dataset | None,
    key: str,
    looks: Mapping[str, Mapping[str, Any]],
    names: Sequence[str],
) -> Chart:
    """What a swept key does: quantities over it, and the force level in bands for each value.

    `mean` and `scatter` are tables of a study without its seeds, if it swept any: `scatter` holds standard
    deviations under the same names. `looks` are looks of lines by law, `names` the quantities: those
    are drawn that are not zero or missing throughout. Where other keys are swept, too, the lines are those of
    the first law for their values.
    """
    drawn = [name for name in names if name in mean and _says_something(mean[name])][:MOST_PANELS]
    panels = [_panel(mean, scatter, name, key, looks) for name in drawn]
    rows = (replace(panel, beside=n % 2 == 1) for n, panel in enumerate(panels))
    bands = [_bands(mean, key)] if FORCE_LEVEL.name in mean else []
    return Chart((*rows, *bands))


def _panel(
    mean: xarray.Dataset,
    scatter: xarray.Dataset | None,
    name: str,
    key: str,
    looks: Mapping[str, Mapping[str, Any]],
) -> Panel:
    """One quantity over a key."""
    size, what, unit = _scale(mean[name])
    marks: list[Mark] = []
    labels = []
    for place, look in _lines(mean, name, key, looks):
        values = _over_places(_along(mean, name, key, place)) / size
        reach = None if scatter is None else _along(scatter, name, key, place).mean("place") / size
        marks += _over_key(mean[key], values, reach, look)
        labels.append(look["label"])
    law_unsaid = (
        LAW.name in mean[name].dims and labels[0] not in mean[LAW.name].values and not _others(mean, key)
    )
    title = f"{what}, {_main(mean)}" if law_unsaid else what
    return Panel(_key_axis(mean[key]), Axis(unit), tuple(marks), title, height=2.55)


def _says_something(values: xarray.DataArray) -> bool:
    """Whether a quantity without bands is anywhere neither missing nor zero."""
    flat = not any(str(dim).endswith(BAND.name) for dim in values.dims)
    return flat and bool((np.nan_to_num(np.asarray(values.values, dtype=float)) != 0.0).any())


def _swept(table: xarray.Dataset) -> list[str]:
    held = table[WEIGHTED if WEIGHTED in table else "mean_force"].dims
    return [str(dim) for dim in held if dim != LAW.name]


def _others(table: xarray.Dataset, key: str) -> list[str]:
    """Keys that are swept beside one."""
    return [name for name in _swept(table) if name != key]


def key_caption(mean: xarray.Dataset, scatter: xarray.Dataset | None, key: str) -> str:
    """Say what the figure of a key shows."""
    others = _others(mean, key)
    told = [str(mean[key].attrs["long_name"])]
    if scatter is not None:
        told.append("mean ± standard deviation over the seeds")
    if others:
        told.append(f"{_main(mean)} alone, a line for each {' and '.join(others)}")
    return f"{key}: {', '.join(told)}."


def _main(table: xarray.Dataset) -> str:
    return str(table[LAW.name].values[0])


def _scale(values: xarray.DataArray) -> tuple[float, str, str]:
    """Unit in which a quantity reads well, in SI, the name of the quantity and that of the unit."""
    what = str(values.attrs["long_name"]).removeprefix("A-weighted ").partition(",")[0].partition(":")[0]
    units = str(values.attrs["units"])
    if units == "1":
        size, unit = 0.01, "%"
    elif units.startswith("dB"):
        size, unit = 1.0, written_units(units)
    else:
        largest = np.nanmax(np.abs(values.values))
        power = 3 * math.floor(math.log10(largest) / 3) if largest > 0 else 0
        power = min(max(power, -9), 9)
        size, unit = 10.0**power, f"{_PREFIXES[power]}{units}"
    return size, what, unit


def _lines(
    table: xarray.Dataset,
    name: str,
    key: str,
    looks: Mapping[str, Mapping[str, Any]],
) -> list[tuple[dict[str, Any], dict[str, Any]]]:
    """Places that a line of a quantity goes through, and how it looks: laws, or values of other keys.

    Of what is told apart by other words, as what radiates, a line for each of them, or where other keys are
    swept the last of them, which is the whole.
    """
    held, others = table[name], _others(table, key)
    law = {LAW.name: _main(table)} if LAW.name in held.dims else {}
    own = [str(dim) for dim in held.dims if dim not in (key, *others, LAW.name, *PLACES)]
    if not others and own:
        found = [word for word in table[own[0]].values if held.sel({**law, own[0]: word}).notnull().any()]
        return [
            ({**law, own[0]: word}, {**look, "label": str(word)})
            for word, look in zip(found, sequence_styles(len(found)), strict=True)
        ]
    if not others:
        laws = main_last(map(str, table[LAW.name].values)) if law else []
        lines = [({LAW.name: each}, {**looks.get(each, {}), "label": each}) for each in laws]
        return lines or [({}, {"colour": INK, "label": ""})]
    here = law | {dim: table[dim].values[-1] for dim in own}
    places = list(product(*(range(table.sizes[name]) for name in others)))[:MOST_LINES]
    lines = []
    for place, look in zip(places, sequence_styles(len(places)), strict=True):
        at = {name: table[name].values[n] for name, n in zip(others, place, strict=True)}
        words = [f"{name} {typed_words(table[name])[n]}" for name, n in zip(others, place, strict=True)]
        lines.append(({**here, **at}, {**look, "label": ", ".join(words)}))
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


def _over_key(
    key: xarray.DataArray,
    found: xarray.DataArray,
    reach: xarray.DataArray | None,
    look: Mapping[str, Any],
) -> list[Boxes | Line]:
    """A line over a key, and how far its points scatter."""
    place = _places(key)
    order = np.argsort(place)
    x, y = place[order], np.asarray(found.values, dtype=float)[order]
    apart = {"width": 0.0} if _is_words(key) else {}  # nothing lies between words
    line = Line(x, y, **{"marker": "o", **look, **apart})
    if reach is None or not np.isfinite(reach.values).any():
        return [line]
    by = reach.values[order]
    return [Boxes(x, x, y - by, y + by, edge=line.colour, law=line.law), line]


def _is_words(key: xarray.DataArray) -> bool:
    return bool(key.dtype.kind == "U")


def _places(key: xarray.DataArray) -> Numbers:
    """Places of the values of a key on its axis: themselves, or their numbers where they are words."""
    return np.array(range(key.size) if _is_words(key) else typed_values(key), dtype=float)


def _key_axis(key: xarray.DataArray) -> Axis:
    if _is_words(key):
        return words_axis(typed_values(key), str(key.name))
    x, unit = _places(key), typed_unit(key)
    label = f"{key.name} / {unit}" if unit not in ("", "1") else str(key.name)
    low, high = float(x.min()), float(x.max())
    if low > 0 and high / low > SPREAD:
        room = (high / low) ** 0.04
        return Axis(label, low / room, high * room, log=True, linked=str(key.name))
    room = 0.04 * (high - low)
    return Axis(label, low - room, high + room, linked=str(key.name))


def _bands(table: xarray.Dataset, key: str) -> Panel:
    """Force level of the first law in each band, a line for each value of the key."""
    count, others = table.sizes[key], _others(table, key)
    shown = np.unique(np.linspace(0, count - 1, min(count, MOST_LINES)).round().astype(int))
    here = table.isel(dict.fromkeys(others, 0)).sel({LAW.name: _main(table)})
    band, words = table[BAND.name].values, typed_words(table[key])
    marks: list[Mark] = []
    if BAND_TIME_PRODUCT.name in here:
        little = say_little(here[BAND_TIME_PRODUCT.name], here.get(START_SHARE.name, 0.0))
        marks += doubtful_boxes(band, little.any([dim for dim in little.dims if dim != BAND.name]).values)
    for at, look in zip(shown, sequence_styles(len(shown)), strict=True):
        level = here[FORCE_LEVEL.name].isel({key: at}).values
        marks.append(Line(band, level, words[at], marker="o", **look))
    first = "".join(f", {name} {typed_words(table[name])[0]}" for name in others)
    axis = Axis("force level / dB re 1 N")
    return Panel(band_axis(band), axis, tuple(marks), f"{_main(table)}{first}", height=3.2)
