"""The figure of an optimised texture: its levels by wavelength, and what each band is heard as."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from asperity.reporting.axes import EDGE, band_axis, levels_axis
from asperity.reporting.chart import Axis, Boxes, Chart, Dashes, Line, Numbers, Panel, Second
from asperity.reporting.data import written_units
from asperity.reporting.style import INK, MUTED
from asperity.spectra import nominal_length

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
