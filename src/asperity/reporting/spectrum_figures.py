"""Figures over frequency: contact force and acceleration, in narrow bands and in one-third octaves."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from xarray import DataTree

from asperity.reporting.data import (
    PRODUCTS,
    differences,
    doubtful,
    laws,
    missing,
    of_law,
    present,
    sensor_labels,
    values,
    variable,
)
from asperity.reporting.part import Columns, Part
from asperity.reporting.style import (
    INK,
    MUTED,
    band_axis,
    decibels,
    frequency_axis,
    law_marker,
    law_style,
    legend_above,
    level_limits,
    new_figure,
    sequence,
    shade_doubtful,
    smooth_on_log_axis,
    styled,
)
from asperity.spectra import LEAST_PRODUCT

FORCE, ACCELERATION = "spectra/force_psd", "spectra/acceleration_psd"
LEVEL = "spectra/force_level"
LINEAR_REFERENCE = "spectra/linear_reference_level"  # by the frequency domain
ACCELERATION_REFERENCE = 1e-6  # m/s²
_SENSOR_DASHES = ("-", (0, (6, 1.5)), (0, (6, 1.5, 1.5, 1.5)), (0, (3, 1.5)), (0, (1.5, 1.5)), "-")

REFERENCE_STYLE: dict[str, Any] = {
    "color": INK,
    "linestyle": (0, (3, 3)),
    "linewidth": 1.0,
    "zorder": 5,
    "label": "linear, frequency domain",
}

Spectrum = tuple[NDArray[np.float64], NDArray[np.float64]]


def frequency_range(tree: DataTree) -> tuple[float, float]:
    """Frequencies that are drawn, in Hz: those of the one-third octaves, else all from 20 Hz on."""
    if present(tree, "spectra/band"):
        bands = values(tree, "spectra/band")
        return bands[0] / 10**0.05, bands[-1] * 10**0.05
    frequency = values(tree, "spectra/frequency")
    high = frequency[-1]
    return min(20.0, high / 100), high


def narrow_level(tree: DataTree, psd: NDArray[np.float64], reference: float) -> Spectrum:
    """Level of a PSD in dB within the drawn range, no denser than a line can show."""
    frequency = values(tree, "spectra/frequency")
    low, high = frequency_range(tree)
    kept = (frequency >= low) & (frequency <= high) & (frequency > 0)
    if not kept.any():
        return np.array([low, high]), np.full(2, np.nan)
    smooth, power = smooth_on_log_axis(frequency[kept], psd[kept], 24)
    return smooth, decibels(power, reference)


def shade_bands(axes: Axes, tree: DataTree, labelled: bool = True) -> None:
    """Shade the frequencies of the bands that say little."""
    if present(tree, "spectra/band"):
        shade_doubtful(axes, values(tree, "spectra/band"), doubtful(tree, "band"), labelled)


def shaded_words(tree: DataTree) -> str:
    """Say what is shaded in a spectrum, where something is; a blank comes first."""
    return doubtful_words(tree, "band") if present(tree, "spectra/band") else ""


@styled()
def force_figure(tree: DataTree) -> Figure:
    """Power spectral densities of the contact force of all laws on one axis."""
    names = laws(tree, FORCE)
    figure = new_figure(4.4)
    axes = figure.subplots()
    spectra = {law: narrow_level(tree, of_law(tree, FORCE, law, "frequency"), 1.0) for law in names}
    for law, (frequency, level) in spectra.items():
        axes.plot(frequency, level, label=law, **law_style(law, names[0]))
    frequency_axis(axes, *frequency_range(tree))
    shade_bands(axes, tree)
    level_limits(axes, [level for _, level in spectra.values()])
    axes.set_ylabel("contact force PSD / dB re 1 N²/Hz")
    legend_above(axes)
    return figure


def force_columns(tree: DataTree) -> Columns:
    """Power spectral density of the contact force per law, all lines."""
    columns: Columns = {"frequency [Hz]": values(tree, "spectra/frequency")}
    for law in laws(tree, FORCE):
        columns[f"{law} [N^2/Hz]"] = of_law(tree, FORCE, law, "frequency")
    return columns


@styled()
def band_figure(tree: DataTree) -> Figure:
    """One-third-octave levels of the contact force, and below them the differences to the linear laws."""
    compared = differences(tree)
    figure = new_figure(4.0 + 2.4 * len(compared))
    heights = [3.4, *(2.4 for _ in compared)]
    panels = figure.subplots(len(heights), 1, sharex=True, squeeze=False, height_ratios=heights)[:, 0]
    _draw_bands(panels[0], tree, LEVEL, laws(tree, LEVEL), span=100.0, step=10.0)
    if present(tree, LINEAR_REFERENCE):
        panels[0].plot(values(tree, "spectra/band"), values(tree, LINEAR_REFERENCE), **REFERENCE_STYLE)
    panels[0].set_ylabel("contact force level / dB re 1 N")
    legend_above(panels[0])
    for axes, (path, name) in zip(panels[1:], compared.items(), strict=True):
        _draw_bands(axes, tree, path, laws(tree, path), span=np.inf, step=5.0)
        axes.axhline(0, color=MUTED, linewidth=0.9)
        axes.set_ylabel(f"level − {name} / dB")
    for axes in panels:
        shade_doubtful(axes, values(tree, "spectra/band"), doubtful(tree, "band"), labelled=axes is panels[0])
        axes.label_outer()
    return figure


def _draw_bands(
    axes: Axes, tree: DataTree, path: str, names: Sequence[str], span: float, step: float
) -> None:
    bands = values(tree, "spectra/band")
    main = laws(tree, LEVEL)[0] if present(tree, LEVEL) else names[0]
    levels = [of_law(tree, path, law, "band") for law in names]
    for law, level in zip(names, levels, strict=True):
        axes.plot(bands, level, label=law, marker=law_marker(law), markeredgewidth=0, **law_style(law, main))
    level_limits(axes, levels, span, step)
    band_axis(axes, bands)


def product_columns(tree: DataTree, dim: str) -> Columns:
    """Bandwidth times averaging time of bands, and whether their levels say something."""
    if not present(tree, PRODUCTS[dim]):
        return {}
    return {
        "B T [1]": values(tree, PRODUCTS[dim], dim),
        f"B T of {LEAST_PRODUCT:g} or more [1]": (~doubtful(tree, dim)).astype(float),
    }


def band_columns(tree: DataTree) -> Columns:
    """Levels per one-third octave and law, and the differences."""
    columns: Columns = {"band centre [Hz]": values(tree, "spectra/band")} | product_columns(tree, "band")
    compared = {path: f"{{}} minus {name}" for path, name in differences(tree).items()}
    compared["spectra/force_level_difference_to_reference"] = "{} minus reference"
    for path, label in {LEVEL: "{}", **compared}.items():
        unit = "dB re 1 N" if path == LEVEL else "dB"
        for law in laws(tree, path):
            columns[f"{label.format(law)} [{unit}]"] = of_law(tree, path, law, "band")
    if present(tree, LINEAR_REFERENCE):
        columns["linear, frequency domain [dB re 1 N]"] = values(tree, LINEAR_REFERENCE)
    return columns


def _sensors(tree: DataTree) -> list[int]:
    found = variable(tree, ACCELERATION)
    assert found is not None
    others = [dim for dim in found.dims if dim != "sensor"]
    return [int(i) for i in np.flatnonzero(found.notnull().any(others).values)]


def _acceleration_level(tree: DataTree, law: str, sensor: int) -> Spectrum:
    psd = of_law(tree, ACCELERATION, law, "sensor", "frequency")[sensor]
    return narrow_level(tree, psd, ACCELERATION_REFERENCE**2)


def _finish_acceleration(axes: Axes, tree: DataTree, spectra: Sequence[Spectrum]) -> None:
    frequency_axis(axes, *frequency_range(tree))
    shade_bands(axes, tree)
    level_limits(axes, [level for _, level in spectra])
    axes.set_ylabel("acceleration PSD / dB re (1 µm/s²)²/Hz")
    legend_above(axes)


@styled()
def sensors_figure(tree: DataTree) -> Figure:
    """Power spectral densities of the acceleration at all sensors, by the main law."""
    main = laws(tree, ACCELERATION)[0]
    labels, sensors = sensor_labels(tree, ACCELERATION), _sensors(tree)
    figure = new_figure(4.2)
    axes = figure.subplots()
    spectra = [_acceleration_level(tree, main, sensor) for sensor in sensors]
    for index, (sensor, colour) in enumerate(zip(sensors, sequence(len(sensors)), strict=True)):
        dashes = _SENSOR_DASHES[index % len(_SENSOR_DASHES)]
        axes.plot(*spectra[index], color=colour, linestyle=dashes, label=labels[sensor])
    _finish_acceleration(axes, tree, spectra)
    return figure


def sensors_columns(tree: DataTree) -> Columns:
    """Power spectral density of the acceleration per sensor, by the main law."""
    main = laws(tree, ACCELERATION)[0]
    psd, labels = of_law(tree, ACCELERATION, main, "sensor", "frequency"), sensor_labels(tree, ACCELERATION)
    columns: Columns = {"frequency [Hz]": values(tree, "spectra/frequency")}
    return columns | {f"{main}, {labels[s]} [(m/s^2)^2/Hz]": psd[s] for s in _sensors(tree)}


def _middle_sensor(tree: DataTree) -> int:
    sensors = _sensors(tree)
    return sensors[len(sensors) // 2]


@styled()
def one_sensor_figure(tree: DataTree) -> Figure:
    """Power spectral densities of the acceleration at one sensor, by all laws."""
    names, sensor = laws(tree, ACCELERATION), _middle_sensor(tree)
    figure = new_figure(4.2)
    axes = figure.subplots()
    spectra = [_acceleration_level(tree, law, sensor) for law in names]
    for law, spectrum in zip(names, spectra, strict=True):
        axes.plot(*spectrum, label=law, **law_style(law, names[0]))
    _finish_acceleration(axes, tree, spectra)
    return figure


def one_sensor_columns(tree: DataTree) -> Columns:
    """Power spectral density of the acceleration at one sensor per law."""
    sensor = _middle_sensor(tree)
    label = sensor_labels(tree, ACCELERATION)[sensor]
    columns: Columns = {"frequency [Hz]": values(tree, "spectra/frequency")}
    for law in laws(tree, ACCELERATION):
        psd = of_law(tree, ACCELERATION, law, "sensor", "frequency")[sensor]
        columns[f"{law}, {label} [(m/s^2)^2/Hz]"] = psd
    return columns


DRAWN = "drawn as mean power per 1/24 octave where the lines are denser than that"


def _force_caption(tree: DataTree) -> str:
    return (
        f"Contact force of all laws, one-sided PSD, {DRAWN}; thick: the main law, {laws(tree, FORCE)[0]}. "
        "Ticks stand at the one-third octaves." + shaded_words(tree)
    )


def _band_caption(tree: DataTree) -> str:
    text = ["Levels per one-third octave (IEC 61260-1, base 10)."]
    if present(tree, LINEAR_REFERENCE):
        text.append("Dashed: the linear contact solved in the frequency domain.")
    if compared := list(differences(tree).values()):
        named = " and that of ".join(compared)
        text.append(f"Below: level minus that of {named}; positive where linear contact underestimates.")
    return " ".join(text) + doubtful_words(tree, "band")


def doubtful_words(tree: DataTree, dim: str) -> str:
    """Say what shaded bands are, where there are any; a blank comes first."""
    if not doubtful(tree, dim).any():
        return ""
    scatter = 4.34 / np.sqrt(LEAST_PRODUCT)
    return (
        f" Shaded: bandwidth times averaging time B T is below {LEAST_PRODUCT:g}; a level there has a "
        f"standard deviation of 4.34/√(B T) dB, more than {scatter:.1f} dB, and says little."
    )


def _sensors_caption(tree: DataTree) -> str:
    main = laws(tree, ACCELERATION)[0]
    text = f"Acceleration at all sensors by the main law, {main}, positive downwards; {DRAWN}."
    lost = missing(tree, "spectra/acceleration_level")
    return f"{text}{shaded_words(tree)} {lost}".strip()


def _one_sensor_caption(tree: DataTree) -> str:
    label = sensor_labels(tree, ACCELERATION)[_middle_sensor(tree)]
    return f"Acceleration at {label} by all laws; {DRAWN}.{shaded_words(tree)}"


_ACCELERATION_NEEDS = (ACCELERATION, "spectra/frequency")

FORCE_BANDS = Part(
    "force_bands",
    "Contact force in one-third octaves",
    (LEVEL, "spectra/band"),
    band_figure,
    band_columns,
    _band_caption,
)

SPECTRUM = (
    Part(
        "force_psd",
        "Contact force against frequency",
        (FORCE, "spectra/frequency"),
        force_figure,
        force_columns,
        _force_caption,
    ),
    FORCE_BANDS,
    Part(
        "acceleration_sensors",
        "Acceleration at the sensors",
        _ACCELERATION_NEEDS,
        sensors_figure,
        sensors_columns,
        _sensors_caption,
    ),
    Part(
        "acceleration_laws",
        "Acceleration by law",
        _ACCELERATION_NEEDS,
        one_sensor_figure,
        one_sensor_columns,
        _one_sensor_caption,
    ),
)
