"""Figure of a track's loss factors: what stands for them in time, and what that does to the contact force."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter
from xarray import DataTree

from asperity.kinds.wheel_on_rail import schema
from asperity.reporting.data import engineering, number, stored_variable, values
from asperity.reporting.part import Data, Part, Series, present_series, series
from asperity.reporting.style import (
    BLUE,
    GREEN,
    INK,
    MUTED,
    VERMILLION,
    frequency_axis,
    legend_above,
    new_figure,
    styled,
)

BAND, FORCE, RAIL = schema.TRACK_BAND, schema.LOSS_FACTOR_FORCE_ERROR, schema.LOSS_FACTOR_RAIL_ERROR
CONSTANT, STIFFNESS, LOSS = schema.LOSS_FACTOR, schema.RELAXED_STIFFNESS, schema.RELAXED_LOSS_FACTOR
_COLOURS = (BLUE, VERMILLION, GREEN)
_DOTS = (0, (1.5, 1.5))
EDGE = 10**0.05
"""From the centre of a one-third octave to its upper edge."""


def _layers(tree: DataTree) -> list[str]:
    """Parts of the track that have a loss factor."""
    found = stored_variable(tree, CONSTANT)
    return [] if found is None else [str(name) for name in found["layer"].values]


def loss_data(tree: DataTree) -> Data:
    """Errors per band, and stiffness and loss factor of each part at its centre."""
    band = series(tree, BAND, "band centre")
    lines = present_series(tree, {FORCE: "contact force, error", RAIL: "receptance of the rail, error"})
    constant = np.broadcast_to(values(tree, CONSTANT)[:, None], (len(_layers(tree)), len(band.values)))
    for row, layer in enumerate(_layers(tree)):
        for entry, name, rows in (
            (STIFFNESS, "stiffness over nominal", values(tree, STIFFNESS, *STIFFNESS.dims)),
            (LOSS, "loss factor", values(tree, LOSS, *LOSS.dims)),
            (CONSTANT, "constant loss factor", constant),
        ):
            lines[entry, layer] = Series(f"{layer}, {name}", entry.units, rows[row])
    return Data(band, lines)


@styled()
def loss_figure(tree: DataTree, data: Data) -> Figure:
    """Errors of force and receptance per one-third octave; stiffness and loss factor of each part."""
    figure = new_figure(6.6)
    errors, stiffness, loss = figure.subplots(3, 1, sharex=True, height_ratios=[1.3, 1, 1])
    bands = data.at
    _draw_errors(errors, data)
    for colour, layer in zip(_COLOURS, _layers(tree), strict=False):
        stiffness.plot(bands, data.lines[STIFFNESS, layer].values, color=colour, label=layer)
        loss.plot(bands, data.lines[LOSS, layer].values, color=colour)
        constant = data.lines[CONSTANT, layer].values[0]
        loss.axhline(constant, color=colour, linestyle=_DOTS, linewidth=1.0)
    stiffness.axhline(1, color=MUTED, linestyle=_DOTS, linewidth=1.0)
    stiffness.set_ylabel("stiffness / nominal")
    loss.set_ylabel("loss factor")
    for axes in (stiffness, loss):
        axes.set_yscale("log")
        axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
        axes.yaxis.set_minor_formatter(NullFormatter())
    frequency_axis(loss, bands[0] / EDGE, bands[-1] * EDGE, "one-third octave band / Hz")
    for axes in (errors, stiffness):
        axes.tick_params(labelbottom=False)
        legend_above(axes)
    return figure


def _draw_errors(axes: Axes, data: Data) -> None:
    bands = data.at
    axes.bar(
        bands / EDGE, data.lines[FORCE].values, (EDGE - 1 / EDGE) * bands, align="edge",
        color=_COLOURS[0], linewidth=0, label="contact force",
    )  # fmt: skip
    if RAIL in data.lines:
        look: dict[str, Any] = {"color": MUTED, "linestyle": (0, (6, 1.5)), "linewidth": 1.2}
        axes.plot(bands, data.lines[RAIL].values, label="receptance of the rail", **look)
    axes.axhline(0, color=INK, linewidth=0.8)
    axes.set_ylabel("error / dB")


def _loss_caption(tree: DataTree) -> str:
    rest = number(tree, schema.STATIC_DEFLECTION_IN_TIME)
    nominal = number(tree, schema.STATIC_DEFLECTION)
    softer = ""
    if rest and nominal:
        softer = (
            f" At rest the track is softer: the wheel's load lowers the rail by {engineering(rest, 'm')}, by "
            f"{engineering(nominal, 'm')} on the nominal stiffnesses."
        )
    return (
        "Nothing that answers after a force only has one stiffness and one loss factor (dotted) at all "
        "frequencies: the stiffness grows where it dissipates. In time, springs and Maxwell elements stand "
        "for the loss factors, chosen for the contact force. Above: level of the linear contact force over "
        "that with constant loss factors, for a wheel at rest, mean over a bay; dashed: of the rail's "
        "displacement under a given force. Receptances, decay rates and the linear contact in the frequency "
        f"domain have constant loss factors.{softer}"
    )


LOSS_FACTORS = Part(
    "loss_factors",
    "Loss factors in time",
    (BAND, FORCE, CONSTANT, STIFFNESS, LOSS),
    loss_data,
    loss_figure,
    _loss_caption,
)
