"""Figure of a track's loss factors: what stands for them in time, and what that does to the contact force."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter
from numpy.typing import NDArray
from xarray import DataTree

from asperity.reporting.data import engineering, number, present, values, variable
from asperity.reporting.part import Columns, Part
from asperity.reporting.style import INK, LAW_STYLES, MUTED, frequency_axis, legend_above, new_figure, styled

BAND, FORCE, RAIL = "track/band", "track/loss_factor_force_error", "track/loss_factor_rail_error"
CONSTANT, STIFFNESS, LOSS = "track/loss_factor", "track/relaxed_stiffness", "track/relaxed_loss_factor"
_COLOURS = tuple(LAW_STYLES[law].colour for law in ("areal", "shifted", "table"))
_DOTS = (0, (1.5, 1.5))
EDGE = 10**0.05
"""From the centre of a one-third octave to its upper edge."""


class _Layer(NamedTuple):
    """A part of the track: its constant loss factor, and its stiffness and loss factor in time per band."""

    name: str
    constant: float
    stiffness: NDArray[np.float64]
    loss: NDArray[np.float64]


def _layers(tree: DataTree) -> list[_Layer]:
    found = variable(tree, CONSTANT)
    names = [] if found is None else [str(name) for name in found["layer"].values]
    bands = (values(tree, path, "layer", "band") for path in (STIFFNESS, LOSS))
    return [_Layer(*row) for row in zip(names, values(tree, CONSTANT), *bands, strict=True)]


@styled()
def loss_figure(tree: DataTree) -> Figure:
    """Errors of force and receptance per one-third octave; stiffness and loss factor of each part."""
    figure = new_figure(6.6)
    errors, stiffness, loss = figure.subplots(3, 1, sharex=True, height_ratios=[1.3, 1, 1])
    bands = values(tree, BAND)
    _draw_errors(errors, tree, bands)
    for colour, layer in zip(_COLOURS, _layers(tree), strict=False):
        stiffness.plot(bands, layer.stiffness, color=colour, label=layer.name)
        loss.plot(bands, layer.loss, color=colour)
        loss.axhline(layer.constant, color=colour, linestyle=_DOTS, linewidth=1.0)
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


def _draw_errors(axes: Axes, tree: DataTree, bands: NDArray[np.float64]) -> None:
    axes.bar(
        bands / EDGE, values(tree, FORCE), (EDGE - 1 / EDGE) * bands, align="edge",
        color=_COLOURS[0], linewidth=0, label="contact force",
    )  # fmt: skip
    if present(tree, RAIL):
        label = "receptance of the rail"
        axes.plot(bands, values(tree, RAIL), color=MUTED, linestyle=(0, (6, 1.5)), linewidth=1.2, label=label)
    axes.axhline(0, color=INK, linewidth=0.8)
    axes.set_ylabel("error / dB")


def loss_columns(tree: DataTree) -> Columns:
    """Errors per band, and stiffness and loss factor of each part at its centre."""
    bands = values(tree, BAND)
    columns: Columns = {"band centre [Hz]": bands, "contact force, error [dB]": values(tree, FORCE)}
    if present(tree, RAIL):
        columns["receptance of the rail, error [dB]"] = values(tree, RAIL)
    for layer in _layers(tree):
        columns[f"{layer.name}, stiffness over nominal [1]"] = layer.stiffness
        columns[f"{layer.name}, loss factor [1]"] = layer.loss
        columns[f"{layer.name}, constant loss factor [1]"] = np.full(len(bands), layer.constant)
    return columns


def _loss_caption(tree: DataTree) -> str:
    names = ("static_deflection_in_time", "static_deflection")
    rest, nominal = (number(tree, "track", name) for name in names)
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
    loss_figure,
    loss_columns,
    _loss_caption,
)
