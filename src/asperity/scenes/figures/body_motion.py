"""Figures of the motion of the bodies."""

from __future__ import annotations

from typing import Any

from xarray import DataTree

from asperity.reporting.chart import Chart, Line, sequence_styles
from asperity.reporting.data import laws, of_law, stored_variable
from asperity.reporting.force_figures import DRAWN, narrow_level, shaded_words, spectrum_panel
from asperity.reporting.part import Data, Part, Series, series
from asperity.scenes.figures.contacts import tone_rules, tones_words
from asperity.scenes.schema import ACCELERATION_REFERENCE, BODY_ACCELERATION_PSD, SPECTRA_DEGREE
from asperity.schema.spectra import FREQUENCY

MOST_LINES = 6
"""Degrees of freedom that are drawn."""


def degree_names(tree: DataTree) -> list[str]:
    """Names of the degrees of freedom."""
    found = stored_variable(tree, SPECTRA_DEGREE)
    return [] if found is None else [str(name) for name in found.values]


def _shown(names: list[str]) -> list[int]:
    """What is drawn: the last degrees first, which are those of what rests on the others."""
    return list(range(len(names)))[-MOST_LINES:]


def motion_data(tree: DataTree) -> Data:
    """Acceleration of the bodies in their degrees of freedom, by the main law."""
    main = laws(tree, BODY_ACCELERATION_PSD)[0]
    density = of_law(tree, BODY_ACCELERATION_PSD, main, "degree", "frequency")
    lines: dict[Any, Series] = {
        index: Series(name, BODY_ACCELERATION_PSD.units, density[index])
        for index, name in enumerate(degree_names(tree))
    }
    return Data(series(tree, FREQUENCY), lines)


def motion_chart(tree: DataTree, data: Data) -> Chart:
    """Acceleration of the bodies over frequency."""
    shown = [data.lines[index] for index in _shown(degree_names(tree))]
    levels = [
        Line(*narrow_level(tree, line.values, ACCELERATION_REFERENCE**2), line.name, **look)
        for line, look in zip(shown, sequence_styles(len(shown)), strict=True)
    ]
    label = "acceleration PSD / dB re (1 µm/s²)²/Hz"
    return Chart((spectrum_panel(tree, levels, label, tone_rules(tree)),))


def _caption(tree: DataTree) -> str:
    names = degree_names(tree)
    some = (
        f" The last {MOST_LINES} of {len(names)} are drawn; the file has all."
        if len(names) > MOST_LINES
        else ""
    )
    main = laws(tree, BODY_ACCELERATION_PSD)[0]
    return (
        f"Acceleration of the bodies by the main law, {main}; {DRAWN}.{some}"
        f"{tones_words(tree)}{shaded_words(tree)}"
    )


MOTION = (
    Part(
        "body_acceleration",
        "Acceleration of the bodies",
        (BODY_ACCELERATION_PSD, FREQUENCY),
        motion_data,
        motion_chart,
        _caption,
    ),
)
