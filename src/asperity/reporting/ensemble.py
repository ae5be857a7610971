"""The figure of an ensemble: level of the contact force, mean and band, by law."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from typing import Any

import xarray

from asperity.reporting.axes import band_axis, doubtful_boxes, levels_axis
from asperity.reporting.chart import Area, Chart, Line, Mark, Panel
from asperity.reporting.spectrum_figures import main_last
from asperity.reporting.typed import typed_words
from asperity.schema.spectra import BAND, BAND_TIME_PRODUCT, FORCE_LEVEL, LAW, START_SHARE
from asperity.spectra import say_little

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
        tuple(_panel(bands.isel(dict(zip(others, at, strict=True))), others, looks) for at in places)
    )


def _panel(here: xarray.Dataset, keys: list[str], looks: Mapping[str, Mapping[str, Any]]) -> Panel:
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
