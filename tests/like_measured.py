"""Data like the measured ones that lie beside some checkouts: with them, every checkout tests the same."""

from pathlib import Path

import numpy as np
import pytest

from asperity.reference.cnossos import wheel_roughness
from asperity.surfaces.bands import strip_from_bands
from asperity.surfaces.synthesis import self_affine

DATA = Path(__file__).parents[2] / "shared" / "data"
MM, UM = 1e-3, 1e-6
RADIUS = 0.459
FLAT = 0.28
"""Where the middle of the flat is on a wheel, m from the start of its lines."""

where_measured = pytest.mark.skipif(not DATA.exists(), reason="no measured data beside the checkout")
either = pytest.mark.parametrize(
    "measured", [False, pytest.param(True, marks=where_measured)], ids=["made", "measured"]
)
"""Runs a test with data that are made, and with measured ones where they are."""


def wheel_lines(depth, *, measured=False):
    """Ten lines of a wheel with a flat, µm, 5 mm apart and 1 mm between points, measured to and fro.

    `depth` of the flat is 0.2, 0.4 or 0.6 mm; 0.2 mm covers seven of the ten lines, and at 0.6 mm the fifth
    line is short. Missing points are NaN.
    """
    if measured:
        with np.load(DATA / "wheel_lines_um_1mm.npz") as archive:
            return np.asarray(archive[f"flat{depth:.1f}mm".replace(".", "p")], float)
    wavelengths, levels = wheel_roughness("disc")
    held = (wavelengths < 0.3) & (wavelengths > 2.4 * MM)
    rough = strip_from_bands((2884, 10), (MM, 5 * MM), wavelengths[held], levels[held], lateral=50.0, seed=7)
    rough, x = rough.heights.T, MM * np.arange(2884)
    middle, width = (3.0, 4.5) if depth < 0.3 else (4.5, 6.0)
    depths = depth * MM * np.maximum(0.0, 1.0 - ((np.arange(10) - middle) / width) ** 2)
    chord = depths[:, None] - (x - FLAT) ** 2 / (2 * RADIUS)
    lines = (rough - np.maximum(chord, 0.0)) / UM
    lines[1::2] = lines[1::2, ::-1]
    if depth > 0.5:
        lines[4, 2325:] = np.nan
    return lines


def sheet(index, *, measured=False):
    """A map of 256 × 256 points 1.5625 µm apart, m, as rough and steep as a rolled sheet is."""
    if measured:
        with np.load(DATA / "aa5754_um.npz") as archive:
            return archive["polished"][index, 128:384, 128:384].astype(float) * UM
    spacing = 1.5625 * UM
    waves = {"longest": 60 * UM, "shortest": 4 * spacing}
    return self_affine((256, 256), (spacing, spacing), rms=0.6 * UM, hurst=0.7, seed=index, **waves).heights
