"""Figures of studies, seeds and optimised textures."""

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain, product
from typing import Any

import numpy as np
import xarray

from asperity.arguments import Array
from asperity.reporting import chart, data, panels
from asperity.reporting.chart import INK, Axis, Boxes, Drawn, Line, Mark, Panel, sequence_styles
from asperity.schema.spectra import BAND, BAND_TIME_PRODUCT, FORCE_LEVEL, LAW, START_SHARE
from asperity.spectra import energy_of, level_of, nominal_length, say_little
from asperity.written_numbers import capital

MOST_PANELS = 6
"""Members of other keys, or quantities, that are drawn; the CSV file has all of them."""
MOST_LINES = 6
"""Values of other keys, or bands of one, that are told apart; the CSV file has all."""
Looks = Mapping[str, Mapping[str, Any]]
"""Looks of lines by law."""


def _laws(table: xarray.Dataset) -> list[str]:
    """Laws in the order in which they are drawn: the main law, the first, on top."""
    main, *others = map(str, table[LAW.name].values)
    return [*others, main]


def _shades(table: xarray.Dataset) -> list[Mark]:
    """Shades of bands that say little anywhere."""
    if BAND_TIME_PRODUCT.name not in table:
        return []
    little = say_little(table[BAND_TIME_PRODUCT.name], table.get(START_SHARE.name, 0.0))
    others = [dim for dim in little.dims if dim != BAND.name]
    return panels.doubtful_boxes(table[BAND.name].values, little.any(others).values)


def ensemble_figure(bands: xarray.Dataset, looks: Looks) -> Drawn:
    """Force level of each law, mean and band, a panel for each value of the other keys.

    The dataset is from `asperity.prediction_band`, whose ``meaning`` is the caption; looks of lines by law.
    """
    others = [dim for dim in bands[FORCE_LEVEL.name].dims if dim not in (LAW.name, BAND.name)]
    places = list(product(*(range(bands.sizes[dim]) for dim in others)))
    shown = [places[n] for n in chart.spread(len(places), MOST_PANELS)]
    for place in shown:
        here = bands.isel(dict(zip(others, place, strict=True)))
        band = here[BAND.name].values
        marks = _shades(here)
        ends = []
        for law in _laws(here):
            of_law = here.sel({LAW.name: law})
            mean, low, high = (of_law[f"{FORCE_LEVEL.name}{end}"].values for end in ("", "_low", "_high"))
            look = dict(looks.get(law, {}))
            shade = {key: look[key] for key in ("colour", "law") if key in look}
            marks += [
                chart.Area(band, low, high, opacity=0.2, **shade),
                Line(band, mean, law, **{"marker": "o"} | look),
            ]
            ends += [low, high]
        axis = panels.levels_axis("contact force level / dB re 1 N", ends, span=100.0)
        title = ", ".join(f"{key} = {data.typed_words(here[key].expand_dims('place'))[0]}" for key in others)
        yield Panel(panels.band_axis(band), axis, tuple(marks), title, height=3.2)
    yield str(bands.attrs["meaning"])
    yield chart.part_shown(len(shown), len(places), f"values of {' and '.join(map(str, others))}")


# --- an optimised texture


def optimised_figure(
    columns: Mapping[str, Array], heard: str, units: str, colours: Mapping[str, str]
) -> Drawn:
    """The texture above, and below what is heard of it in each band, of each law that has a colour.

    Columns by their titles, each by one-third octave of wavelength (b,), begin with these, the frequencies
    at which they are passed, the texture before and after, and its bounds, NaN where a band was not to be
    changed; those of the response, with its units, are as ``"areal after [dB]"``.
    """
    wavelength, frequency, *levels = list(columns.values())[:6]
    edges = wavelength / panels.EDGE, wavelength * panels.EDGE
    bounds = np.stack([*edges, *levels[2:]])
    left, right, low, high = bounds[:, np.isfinite(bounds).all(axis=0)]
    order = np.argsort(edges[0])
    steps = np.stack(edges, axis=1)[order].ravel()  # a level keeps its height within each band
    texture: list[Mark] = [Boxes(left, right, low, high, "allowed", chart.MUTED, 0.15)]
    response: list[Mark] = []
    for name, dashes, level in (("before", (1.5, 1.5), levels[0]), ("after", (), levels[1])):
        texture.append(Line(steps, np.repeat(level[order], 2), f"texture {name}", INK, dashes))
        for law, colour in colours.items():
            look: dict[str, Any] = {"colour": colour, "dashes": dashes, "marker": "o"}
            response.append(
                Line(wavelength, columns[f"{law} {name} [{units}]"], f"{law}, {name}", law=law, **look)
            )
    along = panels.band_axis(np.sort(wavelength), "one-third octave of wavelength", nominal_length)
    speed = float(np.median(wavelength * frequency))
    along = panels.long_waves_left(along, "frequency at which it is passed", speed, "wavelength")
    yield Panel(along, panels.levels_axis("roughness level / dB re 1 µm", levels), tuple(texture), height=3.2)
    below = Axis(f"in the band / {data.written_units(units)}")
    yield Panel(along, below, tuple(response), heard, height=3.2)
    yield "Above, the texture before and after, and what it was allowed to be; below, what is heard of it."


# --- what a swept key does

PLACES = ("sensor", "point")
"""Dimensions over which levels are averaged; other words, as what radiates, are told apart."""
SPREAD = 20.0
"""Ratio of the largest value to the smallest from which the axis is logarithmic."""


def key_figures(
    mean: xarray.Dataset, scatter: xarray.Dataset | None, key: str, looks: Looks, names: Sequence[str]
) -> Iterator[tuple[str, str, Drawn]]:
    """Figures of a swept key, each with its name and title: one for each thing that its lines stand for.

    So that no legend mixes laws, what radiates, and values of keys; the parameters are those of `key_figure`.
    """
    kept = [name for name in names if name in mean and _says_something(mean[name])]
    drawn = kept[:MOST_PANELS]
    told: dict[str, list[str]] = {}
    for name in drawn:
        told.setdefault(_told_apart(mean, name, key), []).append(name)
    left = chart.part_shown(len(drawn), len(kept), "quantities")
    for n, (what, some) in enumerate(told.items()):
        title = f"Over {key}" + (f", by {what}" if what and n else "")
        parts = chain(key_figure(mean, scatter, key, looks, some), [left] * (n == len(told) - 1))
        yield f"key-{key}" + (f"-{what}" if n else ""), title, parts
    if FORCE_LEVEL.name in mean:
        yield f"bands-{key}", f"Force level by {key}", _bands(mean, key)


def _told_apart(table: xarray.Dataset, name: str, key: str) -> str:
    """What the lines of a quantity over a key stand for, in a word."""
    held = table[name]
    others = _others(table, key)
    own = [str(dim) for dim in held.dims if dim not in (key, *others, LAW.name, *PLACES)]
    if others:
        return "other keys"
    return own[0] if own else LAW.name if LAW.name in held.dims else ""


def key_figure(
    mean: xarray.Dataset, scatter: xarray.Dataset | None, key: str, looks: Looks, names: Sequence[str]
) -> Drawn:
    """What a swept key does: quantities over it.

    `mean` and `scatter` are tables of a study without its seeds, if it swept any: `scatter` holds standard
    deviations under the same names. `looks` are looks of lines by law, `names` the quantities: those
    are drawn that are not zero or missing throughout. Where other keys are swept, too, the lines are those of
    the first law for their values.
    """
    drawn = [name for name in names if name in mean and _says_something(mean[name])][:MOST_PANELS]
    for n, name in enumerate(drawn):
        yield replace(_panel(mean, scatter, name, key, looks), beside=n % 2 == 1)
    told = [str(mean[key].attrs["long_name"])]
    others = _others(mean, key)
    if scatter is not None:
        told.append("mean ± standard deviation over the seeds")
    if others:
        told.append(f"{_main(mean)} alone, a line for each {' and '.join(others)}")
    yield f"{key}: {', '.join(told)}."
    count = math.prod(mean.sizes[name] for name in others)
    yield chart.part_shown(min(count, MOST_LINES), count, f"values of {' and '.join(others)}")


def ends_in_words(table: xarray.Dataset, names: Sequence[str]) -> str:
    """Say where the first of some levels that a study has is lowest and highest, of the main law."""
    name = next((each for each in names if each in table and _says_something(table[each])), "")
    if not name:
        return ""
    keys = [key for key in json.loads(table.attrs["sweep"]) if key in table.dims]
    held = table[name]
    told = [str(table[name].attrs["long_name"]).partition(":")[0].partition(",")[0]]
    if LAW.name in held.dims:
        held = held.sel({LAW.name: _main(table)})
        told.append(_main(table))
    for dim in [str(dim) for dim in held.dims if dim not in keys]:
        told.append(str(most := _largest(held, dim)))
        held = held.sel({dim: most})
    units = data.written_units(str(held.attrs["units"]))
    ends = {}
    for found in (held.argmin(...), held.argmax(...)):
        at = {str(dim): int(place) for dim, place in found.items()}
        where = ", ".join(f"{key} {data.typed_words(table[key])[n]}" for key, n in at.items())
        ends[where] = f"{float(held[at]):.1f} {units}"
    low, *high = (f"{level} at {where}" for where, level in ends.items())
    return f"{capital(', '.join(told))}: {f'from {low} to {high[0]}' if high else low}."


def _says_something(found: xarray.DataArray) -> bool:
    """Whether a quantity without bands is anywhere neither missing nor zero."""
    flat = not any(str(dim).endswith(BAND.name) for dim in found.dims)
    return flat and bool((np.nan_to_num(np.asarray(found.values, dtype=float)) != 0.0).any())


def _others(table: xarray.Dataset, key: str) -> list[str]:
    """Keys that are swept beside one."""
    return [name for name in json.loads(table.attrs["sweep"]) if name in table.dims and name != key]


def _main(table: xarray.Dataset) -> str:
    return str(table[LAW.name].values[0])


def _scale(found: xarray.DataArray) -> tuple[float, str, str]:
    """Unit in which a quantity reads well, in SI, the name of the quantity and that of the unit."""
    what = str(found.attrs["long_name"]).removeprefix("A-weighted ").partition(",")[0].partition(":")[0]
    size, symbol = data.unit_of_quantity(str(found.name), str(found.attrs["units"]), found.values)
    return size, what, symbol or "1"


def _panel(mean: xarray.Dataset, scatter: xarray.Dataset | None, name: str, key: str, looks: Looks) -> Panel:
    """One quantity over a key, and how far its points scatter."""
    size, what, unit = _scale(mean[name])
    is_words = mean[key].dtype.kind == "U"
    places = _places(mean[key])
    order = np.argsort(places)
    marks: list[Mark] = []
    lines = list(_lines(mean, name, key, looks))
    for place, look in lines:
        found = _over_places(_along(mean[name], key, place)) / size
        apart = {"width": 0.0} if is_words else {}  # nothing lies between words
        line = Line(places[order], found[order], **{"marker": "o", **look, **apart})
        if scatter is not None:
            by = np.nanmean(_along(scatter[name], key, place), axis=1)[order] / size
            if np.isfinite(by).any():
                marks.append(Boxes(line.x, line.x, line.y - by, line.y + by, edge=line.colour, law=line.law))
        marks.append(line)
    place, look = lines[0]
    others = _others(mean, key)
    told = [str(at) for dim, at in place.items() if dim not in others and str(at) != look["label"]]
    title = ", ".join([what, *told])
    return Panel(_key_axis(mean[key]), Axis(unit), tuple(marks), title, height=2.55)


def _lines(
    table: xarray.Dataset, name: str, key: str, looks: Looks
) -> Iterator[tuple[dict[str, Any], dict[str, Any]]]:
    """Places that a line of a quantity goes through, and how it looks: laws, or values of other keys.

    Of what is told apart by other words, as what radiates, a line for each of them, or where other keys are
    swept the largest of them.
    """
    held = table[name]
    others = _others(table, key)
    law = {LAW.name: _main(table)} if LAW.name in held.dims else {}
    own = [str(dim) for dim in held.dims if dim not in (key, *others, LAW.name, *PLACES)]
    if others:
        here = law | {dim: _largest(held.sel(law), dim) for dim in own}
        every = list(product(*(range(table.sizes[dim]) for dim in others)))
        found = [every[n] for n in chart.spread(len(every), MOST_LINES)]
        for place, look in zip(found, sequence_styles(len(found)), strict=True):
            at = {dim: table[dim].values[n] for dim, n in zip(others, place, strict=True)}
            words = [f"{dim} {data.typed_words(table[dim])[n]}" for dim, n in zip(others, place, strict=True)]
            yield here | at, {**look, "label": ", ".join(words)}
    elif own:
        words = [word for word in table[own[0]].values if held.sel({**law, own[0]: word}).notnull().any()]
        for word, look in zip(words, sequence_styles(len(words)), strict=True):
            yield {**law, own[0]: word}, {**look, "label": str(word)}
    elif law:
        for each in _laws(table):
            yield {LAW.name: each}, {**looks.get(each, {}), "label": each}
    else:
        yield {}, {"colour": INK, "label": ""}


def _largest(held: xarray.DataArray, dim: str) -> Any:
    """Place along a dimension of the largest value, of levels that are summed their total."""
    most = held.max([other for other in held.dims if other != dim]).values
    return held[dim].values[::-1][np.nan_to_num(most, nan=-np.inf)[::-1].argmax()]


def _along(found: xarray.DataArray, key: str, place: Mapping[str, Any]) -> Array:
    """A quantity over a key and over the places on a body (key, place)."""
    held = found.sel({dim: at for dim, at in place.items() if dim in found.dims}).transpose(key, ...)
    return np.asarray(held.values, dtype=float).reshape(held.sizes[key], -1)


def _over_places(level: Array) -> Array:
    """Energy mean of levels at several places."""
    one = level.shape[1] == 1
    return level[:, 0] if one else level_of(np.nanmean(energy_of(level), axis=1))


def _places(key: xarray.DataArray) -> Array:
    """Places of the values of a key on its axis: themselves, or their numbers where they are words."""
    is_words = key.dtype.kind == "U"
    return np.array(range(key.size) if is_words else data.typed_values(key), dtype=float)


def _key_axis(key: xarray.DataArray) -> Axis:
    if key.dtype.kind == "U":
        return panels.words_axis(data.typed_values(key), str(key.name))
    x = _places(key)
    unit = data.typed_unit(key)
    label = f"{key.name} / {unit}" if unit not in ("", "1") else str(key.name)
    low = float(x.min())
    high = float(x.max())
    if low > 0 and high / low > SPREAD:
        room = (high / low) ** 0.04
        return Axis(label, low / room, high * room, log=True, linked=str(key.name))
    room = 0.04 * (high - low)
    return Axis(label, low - room, high + room, linked=str(key.name))


def _bands(table: xarray.Dataset, key: str) -> Drawn:
    """Force level of the first law in each band, a line for each value of the key."""
    count = table.sizes[key]
    others = _others(table, key)
    shown = chart.spread(count, MOST_LINES)
    here = table.isel(dict.fromkeys(others, 0)).sel({LAW.name: _main(table)})
    band = table[BAND.name].values
    words = data.typed_words(table[key])
    marks = _shades(here)
    for at, look in zip(shown, sequence_styles(len(shown)), strict=True):
        level = here[FORCE_LEVEL.name].isel({key: at}).values
        marks.append(Line(band, level, words[at], marker="o", **look))
    first = "".join(f", {name} {data.typed_words(table[name])[0]}" for name in others)
    axis = Axis("force level / dB re 1 N")
    title = f"{_main(table)}{first}"
    yield Panel(panels.band_axis(band), axis, tuple(marks), title, height=3.2)
    yield f"Force level of {title}: one-third octaves, a line for each value of {key}."
    yield chart.part_shown(len(shown), count, f"values of {key}")
