"""Figures of rolling noise: sound power per one-third octave and A-weighted, per law."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator
from numpy.typing import NDArray
from xarray import DataTree

from asperity.reporting.data import doubtful, laws, of_law, values, variable
from asperity.reporting.part import Columns, Part
from asperity.reporting.spectrum_figures import doubtful_words, product_columns
from asperity.reporting.style import (
    INK,
    LAW_STYLES,
    MUTED,
    band_axis,
    law_marker,
    law_style,
    legend_above,
    level_limits,
    new_figure,
    shade_doubtful,
    styled,
)
from asperity.spectra import a_weighting

POWER, POWER_A = "spectra/sound_power_level", "spectra/sound_power_level_a"
BAND = "spectra/noise_band"
_SHARES = {"track": (0, (1.5, 1.5)), "wheel": (0, (6, 1.5, 1.5, 1.5))}


def sources(tree: DataTree, path: str) -> list[str]:
    """Sources of the levels at `path`, as ``["track", "wheel", "total"]``."""
    found = variable(tree, path)
    return [] if found is None else [str(name) for name in found["source"].values]


def _weighted(tree: DataTree, law: str, source: str) -> NDArray[np.float64]:
    level = of_law(tree, POWER, law, "source", "noise_band")[sources(tree, POWER).index(source)]
    return level + a_weighting(values(tree, BAND))


def _share_law(tree: DataTree) -> str:
    names = laws(tree, POWER)
    return "linear" if "linear" in names else names[0]


@styled()
def band_figure(tree: DataTree) -> Figure:
    """A-weighted sound power per one-third octave: the total by each law, track and wheel of linear."""
    figure = new_figure(4.4)
    axes = figure.subplots()
    names, found, bands = laws(tree, POWER), sources(tree, POWER), values(tree, BAND)
    whole = "total" if "total" in found else found[-1]
    levels = []
    for law in names:
        level = _weighted(tree, law, whole)
        axes.plot(
            bands, level, label=f"{whole}, {law}", marker=law_marker(law), markeredgewidth=0,
            **law_style(law, names[0]),
        )  # fmt: skip
        levels.append(level)
    share = _share_law(tree)
    for source, dashes in _SHARES.items():
        if source in found:
            level = _weighted(tree, share, source)
            axes.plot(bands, level, color=MUTED, linestyle=dashes, label=f"{source}, {share}", linewidth=1.2)
    level_limits(axes, levels, span=60.0)
    band_axis(axes, bands)
    shade_doubtful(axes, bands, doubtful(tree, "noise_band"))
    axes.set_ylabel("sound power level / dB(A) re 1 pW")
    legend_above(axes, columns=6)
    return figure


def band_columns(tree: DataTree) -> Columns:
    """Sound power per band, law and source, unweighted, beside the A-weighting."""
    bands = values(tree, BAND)
    columns: Columns = {"band centre [Hz]": bands, "A-weighting [dB]": a_weighting(bands)}
    columns |= product_columns(tree, "noise_band")
    for law in laws(tree, POWER):
        rows = of_law(tree, POWER, law, "source", "noise_band")
        columns |= {
            f"{source}, {law} [dB re 1 pW]": row
            for source, row in zip(sources(tree, POWER), rows, strict=True)
        }
    return columns


def _band_caption(tree: DataTree) -> str:
    share = _share_law(tree)
    return (
        "A-weighted one-third octaves. The linear law: the roughness that was rolled and the transfer "
        "functions of CNOSSOS-EU, without its contact filter, for a linear contact follows the bare texture. "
        "The other laws add their difference of the contact force level to linear, band by band, which holds "
        "what the contact filters. "
        f"Grey: the shares of track and wheel by {share}.{doubtful_words(tree, 'noise_band')}"
    )


@styled()
def total_figure(tree: DataTree) -> Figure:
    """A-weighted sound power as bars, by source and law."""
    names, found = laws(tree, POWER_A), sources(tree, POWER_A)
    figure = new_figure(0.7 + len(found) * (0.3 + 0.2 * len(names)))
    axes = figure.subplots()
    levels = np.array([of_law(tree, POWER_A, law, "source") for law in names])
    base = 5 * np.floor((np.nanmin(levels) - 5) / 5)
    thickness = 0.82 / len(names)
    for row, (law, level) in enumerate(zip(names, levels, strict=True)):
        places = np.arange(len(found)) + (row - (len(names) - 1) / 2) * thickness
        colour = LAW_STYLES.get(law.partition("-")[0])
        axes.barh(
            places, level - base, 0.86 * thickness, left=base, label=law, linewidth=0,
            color=colour.colour if colour else MUTED,
        )  # fmt: skip
        _write(axes, level, places)
    axes.set_yticks(range(len(found)), found)
    axes.invert_yaxis()
    axes.grid(visible=False, axis="y")
    top = float(np.nanmax(levels))
    axes.set_xlim(base, top + 0.07 * (top - base))  # room for the numbers
    axes.xaxis.set_major_locator(MultipleLocator(5))
    axes.set_xlabel("A-weighted sound power level / dB(A) re 1 pW")
    legend_above(axes)
    return figure


def _write(axes: Axes, levels: NDArray[np.float64], places: NDArray[np.floating]) -> None:
    for level, place in zip(levels, places, strict=True):
        if np.isfinite(level):
            axes.annotate(
                f"{level:.1f}", (level, place), xytext=(4, 0), textcoords="offset points", va="center",
                fontsize=8, color=INK,
            )  # fmt: skip


def total_columns(tree: DataTree) -> Columns:
    """A-weighted sound power: one row, one column per source and law."""
    columns: Columns = {}
    for law in laws(tree, POWER_A):
        levels = of_law(tree, POWER_A, law, "source")
        columns |= {
            f"{source}, {law} [dB(A) re 1 pW]": np.array([level])
            for source, level in zip(sources(tree, POWER_A), levels, strict=True)
        }
    return columns


NOISE = (
    Part(
        "sound_power",
        "A-weighted sound power",
        (POWER_A,),
        total_figure,
        total_columns,
        lambda _: (
            "Sum of the A-weighted bands below. The axis does not start at zero: compare the ends of the "
            "bars, not their lengths."
        ),
    ),
    Part(
        "sound_power_bands",
        "Sound power in one-third octaves",
        (POWER, BAND),
        band_figure,
        band_columns,
        _band_caption,
    ),
)
