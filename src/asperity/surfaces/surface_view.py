"""What a notebook shows of a surface or a line: its size, its rms height and a small picture."""

from __future__ import annotations

import base64
import io
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from asperity.printable import printable
from asperity.units import written

if TYPE_CHECKING:
    from asperity.surfaces.heightmap import HeightMap, Profile

POINTS = 600
"""Along each side of a picture, at most."""


def surface_view(surface: HeightMap | Profile) -> str:
    """Describe a surface and draw it, heights in µm over lengths in mm, as HTML without anything active."""
    from matplotlib.figure import Figure

    sizes, spacings = np.atleast_1d(surface.size), np.atleast_1d(surface.spacing)
    points, size, apart = (
        " × ".join(each) for each in (
            map(str, surface.shape),
            (written(float(f"{length:.4g}"), "m", "mm") for length in sizes),
            (written(float(f"{step:.4g}"), "m", "um") for step in spacings),
        )
    )  # fmt: skip
    rms = written(float(f"{np.nanstd(surface.heights):.4g}"), "m", "um")
    missing = f", {surface.missing_share:.2%} without a height" if surface.missing_share else ""
    what = "Height map" if len(sizes) == 2 else "Profile"
    told = f"{points} points, {size}, {apart} apart, rms height {rms}{missing}."
    source = f"<br>{escape(printable(surface.source))}" if surface.source else ""
    told = escape(told.replace(" um", " µm"))
    figure = Figure(figsize=(6.0, 2.8 if len(sizes) == 2 else 1.8), layout="constrained")
    axes = figure.subplots()
    axes.set_xlabel("x / mm")
    thin = tuple(slice(None, None, max(1, -(-n // POINTS))) for n in surface.shape)
    if len(sizes) == 2:
        extent = (0.0, 1e3 * sizes[0], 0.0, 1e3 * sizes[1])
        shown = 1e6 * surface.heights[thin].T
        image = axes.imshow(shown, origin="lower", extent=extent, cmap="cividis")
        if sizes.max() > 4.0 * sizes.min():
            axes.set_aspect("auto")
        figure.colorbar(image, ax=axes, label="height / µm")
        axes.set_ylabel("y / mm")
    else:
        axes.plot(1e3 * surface.x, 1e6 * surface.heights, linewidth=0.6)
        axes.set_ylabel("height / µm")
    png = io.BytesIO()
    figure.savefig(png, format="png", dpi=110)
    data = base64.b64encode(png.getvalue()).decode()
    picture = f'<img alt="{what.lower()}" src="data:image/png;base64,{data}">'
    return f"<div><p><strong>{what}.</strong> {told}{source}</p>{picture}</div>"
