"""Roughness of rail and wheel in bands of wavelength, on the axes that rail acoustics uses."""

from collections.abc import Iterator

import numpy as np
from xarray import DataTree

from asperity.reporting import chart, data, panels
from asperity.reporting.chart import INK, Line, Mark, Note, Numbers, Panel, Rules
from asperity.reporting.figure import Lines, Of, figure
from asperity.scenes import schema
from asperity.schema import contact, rolling

PRODUCT = schema.SURFACE_BAND_LENGTH_PRODUCT
SPAN = 60.0
"""Levels, dB, that are drawn below the highest: a texture without waves leaves rounding errors."""
_LOOKS = {
    "rail": (chart.BLUE, (), 1.4, "o"),
    "wheel": (chart.VERMILLION, (6, 1.5), 1.4, "s"),
    "combined": (INK, (1.5, 1.5), 1.8, ""),
}


def _millimetres(wavelength: float) -> str:
    """Nominal name of a band of wavelength in mm, as ``"31.5"`` or ``"1000"``."""
    return f"{float(data.nominal_band(wavelength)) * 1e3:g}" if wavelength < 900 else f"{1e3 * wavelength:g}"


@figure(
    "Roughness of rail and wheel",
    Of(schema.SURFACE_BAND, "wavelength"),
    panels.products(PRODUCT),
    Of(schema.ROUGHNESS_LEVEL, "{part}"),
)
def roughness(tree: DataTree, lines: Lines) -> Iterator[Panel | str]:
    """Roughness levels per one-third octave of wavelength, long waves on the left."""
    parts = lines.of(schema.ROUGHNESS_LEVEL)
    lowest = max(np.nanmax(series.values) for series in parts) - SPAN
    levels = [np.where(series.values >= lowest, series.values, np.nan) for series in parts]
    kept = np.isfinite(levels).any(axis=0)  # bands in which some part reaches into the span
    wavelength, speed = lines.at[kept], data.number(tree, rolling.SPEED)
    drawn = [
        Line(wavelength, level[kept], series.name, *_LOOKS.get(series.name, (chart.MUTED, (), 1.4, "^")))
        for series, level in zip(parts, levels, strict=True)
    ]
    axis = panels.levels_axis(
        "roughness level / dB re 1 µm", [line.y for line in drawn], span=100.0, step=5.0
    )
    along = panels.band_axis(np.sort(wavelength), "wavelength / mm", _millimetres)
    along = panels.long_waves_left(along, f"frequency v/λ, at v = {speed or 0.0:.3g} m/s", speed)
    doubtful = panels.doubtful_boxes(wavelength, data.doubtful(tree, PRODUCT)[kept])
    yield Panel(along, axis, (*doubtful, *_contact(tree, wavelength), *drawn), height=4.2)
    yield (
        "Roughness levels per one-third octave of wavelength, re 1 µm, of the textures that were rolled, "
        "before any contact filter."
    )
    if any(series.name == "combined" for series in parts):
        yield "Combined: rail and wheel as they meet in the contact."
    yield (
        "Left out: bands that the texture does not hold, and levels more than "
        f"{SPAN:.0f} dB below the highest."
    )
    yield panels.shaded_words(tree, PRODUCT).replace("time B T", "length B T")


def _contact(tree: DataTree, wavelength: Numbers) -> list[Mark]:
    """The length of the contact, where it is among the wavelengths."""
    length = 2 * (data.number(tree, contact.HERTZ_RADIUS) or 0.0)
    if not wavelength.min() < length < wavelength.max():
        return []
    words = f"length of the contact, 2a = {data.engineering(length, 'm')}"
    return [Rules(np.array([length]), colour=INK), Note(words, length, 0.97, y_share=True, align="right")]
