"""Material ratio (Abbott) curve, and what it says of peaks, core and valleys."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

CORE = 0.4
"""Share of the curve over which its secant is least steep, and which the straight line is fitted to."""


@dataclass(frozen=True)
class Stratified:
    """Parameters of a surface of peaks, core and valleys, m and shares of all points."""

    core: float  # height of the core, Sk or Rk
    peaks: float  # reduced height of the peaks above it, Spk or Rpk
    valleys: float  # reduced depth of the valleys below it, Svk or Rvk
    peak_ratio: float  # material ratio where peaks end, Smr1 or Rmr1
    valley_ratio: float  # where valleys begin, Smr2 or Rmr2


def material_ratio_curve(
    heights: NDArray[np.float64], points: int = 201
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Material ratio (points,), 0 to 1, and the heights, m, that this share of the points reach or exceed."""
    ratio = np.linspace(0.0, 1.0, points)
    return ratio, np.quantile(heights[np.isfinite(heights)], 1.0 - ratio)


def stratified(heights: NDArray[np.float64]) -> Stratified:
    """Core, peaks and valleys by the straight line through the flattest 40 % of the material ratio curve.

    ISO 25178-2:2021 and ISO 21920-2:2021, as ISO 13565-2:1996 has it: of all secants over 40 % the first of
    least slope, the line of least squares of the heights there, from 0 to 100 % the core; peaks and valleys
    are as high as triangles of the same area over the share that they have. Heights of any shape, m; missing
    ones are left out.
    """
    falling = np.sort(heights[np.isfinite(heights)])[::-1]
    count = falling.size
    ratio = (np.arange(count) + 0.5) / count
    width = min(max(2, round(CORE * count)), count - 1)
    drop = falling[:-width] - falling[width:]
    first = int(np.argmax(drop <= drop.min() + 1e-9 * (falling[0] - falling[-1])))
    part = slice(first, first + width + 1)
    slope, at_zero = np.polyfit(ratio[part], falling[part], 1)
    top, bottom = at_zero, at_zero + slope
    above, below = np.maximum(falling - top, 0.0), np.maximum(bottom - falling, 0.0)
    peak_ratio, valley_ratio = np.mean(above > 0.0), 1.0 - np.mean(below > 0.0)
    return Stratified(
        float(top - bottom),
        float(2.0 * above.mean() / peak_ratio) if peak_ratio else 0.0,
        float(2.0 * below.mean() / (1.0 - valley_ratio)) if valley_ratio < 1.0 else 0.0,
        float(peak_ratio),
        float(valley_ratio),
    )
