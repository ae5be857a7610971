"""The figure of an ensemble: level of the contact force, mean and band, by law."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from itertools import product

import xarray
from matplotlib.figure import Figure

from asperity.reporting.style import INK, MUTED, band_axis, new_figure, shade_doubtful, styled
from asperity.reporting.typed import typed_words
from asperity.schema.spectra import BAND, BAND_TIME_PRODUCT, FORCE_LEVEL, LAW, START_SHARE
from asperity.spectra import say_little

MOST_PANELS = 6
"""Members of other keys that are drawn; the CSV file has all of them."""
LETTERS = 150
"""In a line of the caption."""


@styled()
def ensemble_figure(bands: xarray.Dataset, colours: Mapping[str, str]) -> Figure:
    """Draw the force level of each law, mean and band, a panel for each value of the other keys.

    The dataset is from `asperity.prediction_band`; colours by law.
    """
    name, law, band = FORCE_LEVEL.name, LAW.name, BAND.name
    others = [str(dim) for dim in bands[name].dims if dim not in (law, band)]
    places = list(product(*(range(bands.sizes[dim]) for dim in others)))[:MOST_PANELS]
    figure = new_figure(1.2 + 3.2 * len(places))
    figure.set_facecolor("white")  # it goes to a file of its own
    panels = figure.subplots(len(places), 1, squeeze=False)[:, 0]
    for axes, place in zip(panels, places, strict=True):
        here = bands.isel(dict(zip(others, place, strict=True)))
        centre = here[band].values
        for each in map(str, here[law].values):
            mean, low, high = (here[f"{name}{end}"].sel({law: each}).values for end in ("", "_low", "_high"))
            colour = colours.get(each, INK)
            axes.fill_between(centre, low, high, color=colour, alpha=0.2, linewidth=0)
            axes.plot(centre, mean, color=colour, label=each, marker="o", markersize=3)
        band_axis(axes, centre)
        if BAND_TIME_PRODUCT.name in here:
            little = say_little(here[BAND_TIME_PRODUCT.name], here.get(START_SHARE.name, 0.0))
            shade_doubtful(axes, centre, little.values)
        axes.set_ylabel("contact force level / dB re 1 N")
        axes.set_title(", ".join(_valued(here[dim]) for dim in others))
    panels[0].legend(ncols=3)
    told = "\n".join(textwrap.wrap(str(bands.attrs["meaning"]), LETTERS))
    figure.supxlabel(told, fontsize=8, color=MUTED, x=0.01, ha="left")
    return figure


def _valued(key: xarray.DataArray) -> str:
    """A swept key with its value and unit, as it was typed."""
    return f"{key.name} = {typed_words(key.expand_dims('place'))[0]}"
