"""Figures of the beam's acceleration over frequency."""

from __future__ import annotations

from typing import Any

import numpy as np
from xarray import DataTree

from asperity.reporting.chart import Chart, Line, sequence_styles
from asperity.reporting.data import laws, missing, of_law, stored_variable
from asperity.reporting.force_figures import (
    DRAWN,
    laws_panel,
    narrow_level,
    shaded_words,
    spectrum_panel,
)
from asperity.reporting.part import Data, Part, Series, series
from asperity.scenes.schema import ACCELERATION_LEVEL, ACCELERATION_REFERENCE
from asperity.scenes.schema import ACCELERATION_PSD as PSD
from asperity.schema.spectra import FREQUENCY

_AXIS = "acceleration PSD / dB re (1 µm/s²)²/Hz"


def sensor_label(tree: DataTree, sensor: int) -> str:
    """Name of a sensor: its position."""
    found = stored_variable(tree, PSD)
    assert found is not None
    return f"x = {float(found['sensor'][sensor]):g} m"


def _sensors(tree: DataTree) -> list[int]:
    """Sensors that have a signal."""
    found = stored_variable(tree, PSD)
    assert found is not None
    others = [dim for dim in found.dims if dim != "sensor"]
    return [int(i) for i in np.flatnonzero(found.notnull().any(others).values)]


def _spectrum(tree: DataTree, law: str, sensor: int) -> Series:
    psd = of_law(tree, PSD, law, "sensor", "frequency")[sensor]
    return Series(f"{law}, {sensor_label(tree, sensor)}", PSD.units, psd)


def sensors_data(tree: DataTree) -> Data:
    """Power spectral density of the acceleration at each sensor, by the main law."""
    main = laws(tree, PSD)[0]
    lines: dict[Any, Series] = {
        sensor_label(tree, sensor): _spectrum(tree, main, sensor) for sensor in _sensors(tree)
    }
    return Data(series(tree, FREQUENCY), lines)


def sensors_chart(tree: DataTree, data: Data) -> Chart:
    """Power spectral densities of the acceleration at all sensors, by the main law."""
    levels = {
        label: narrow_level(tree, psd.values, ACCELERATION_REFERENCE**2) for label, psd in data.lines.items()
    }
    looks = sequence_styles(len(levels))
    drawn = [Line(*levels[label], label, **look) for label, look in zip(levels, looks, strict=True)]
    return Chart((spectrum_panel(tree, drawn, _AXIS),))


def _middle_sensor(tree: DataTree) -> int:
    sensors = _sensors(tree)
    return sensors[len(sensors) // 2]


def laws_data(tree: DataTree) -> Data:
    """Power spectral density of the acceleration at one sensor, by each law."""
    sensor = _middle_sensor(tree)
    lines: dict[Any, Series] = {law: _spectrum(tree, law, sensor) for law in laws(tree, PSD)}
    return Data(series(tree, FREQUENCY), lines)


def laws_chart(tree: DataTree, data: Data) -> Chart:
    """Power spectral densities of the acceleration at one sensor, by all laws."""
    return Chart((laws_panel(tree, data.lines, _AXIS, ACCELERATION_REFERENCE**2),))


def _sensors_caption(tree: DataTree) -> str:
    main = laws(tree, PSD)[0]
    text = f"Acceleration at all sensors by the main law, {main}, positive downwards; {DRAWN}."
    return f"{text}{shaded_words(tree)} {missing(tree, ACCELERATION_LEVEL)}".strip()


def _laws_caption(tree: DataTree) -> str:
    label = sensor_label(tree, _middle_sensor(tree))
    return f"Acceleration at {label} by all laws; {DRAWN}.{shaded_words(tree)}"


ACCELERATION = (
    Part(
        "acceleration_sensors",
        "Acceleration at the sensors",
        (PSD, FREQUENCY),
        sensors_data,
        sensors_chart,
        _sensors_caption,
    ),
    Part(
        "acceleration_laws",
        "Acceleration by law",
        (PSD, FREQUENCY),
        laws_data,
        laws_chart,
        _laws_caption,
    ),
)
