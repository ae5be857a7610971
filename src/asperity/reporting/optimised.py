"""The figure of an optimised texture: its levels by wavelength, and what each band is heard as."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from asperity.reporting.style import INK, MUTED, legend_above, new_figure, styled
from asperity.spectra import nominal_length

BEFORE, AFTER = "before", "after"
MOST_LABELS = 11


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


@styled()
def optimised_figure(bands: TextureBands, heard: str, units: str, colours: Mapping[str, str]) -> Figure:
    """Draw the texture above, and below what is heard of it in each band; colours by law."""
    figure = new_figure(6.4)
    figure.set_facecolor("white")  # it goes to a file of its own
    above, below = figure.subplots(2, 1, sharex=True)
    place = np.arange(len(bands.wavelength))
    edges = np.arange(len(place) + 1) - 0.5
    above.stairs(
        bands.highest, edges, baseline=bands.lowest, fill=True, color=MUTED, alpha=0.15, label="allowed"
    )
    for name, style in ((BEFORE, ":"), (AFTER, "-")):
        above.stairs(bands.levels[name], edges, baseline=None, linestyle=style, color=INK, label=name)
        for law, levels in bands.heard.items():
            look = {"color": colours.get(law, INK), "linestyle": style, "marker": "o", "markersize": 3}
            below.plot(place, levels[name], label=f"{law}, {name}", **look)
    above.set_ylabel("roughness level / dB re 1 µm")
    below.set_ylabel(f"in the band / {units}")
    below.set_title(heard)
    every = max(1, -(-len(place) // MOST_LABELS))
    labels = [
        f"{nominal_length(w)}\n{_in_hertz(f)}"
        for w, f in zip(bands.wavelength[::every], bands.frequency[::every], strict=True)
    ]
    below.set_xticks(place[::every], labels)
    below.set_xlabel("one-third octave of wavelength, and the frequency at which it is passed")
    legend_above(above)
    below.legend(ncols=2)
    return figure


def _in_hertz(frequency: float) -> str:
    return f"{frequency / 1000:.3g} kHz" if frequency >= 1000 else f"{frequency:.3g} Hz"
