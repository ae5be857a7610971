"""Figure of a track's loss factors: what stands for them in time, and what that does to the contact force."""

from __future__ import annotations

import numpy as np
from xarray import DataTree

from asperity.reporting.axes import EDGE, band_axis, log_axis
from asperity.reporting.chart import (
    BLUE,
    GREEN,
    INK,
    MUTED,
    VERMILLION,
    Axis,
    Boxes,
    Chart,
    Line,
    Panel,
    Rules,
)
from asperity.reporting.data import engineering, number, stored_variable, values
from asperity.reporting.part import Data, Part, Series, present_series, series
from asperity.scenes import schema

BAND, FORCE, RAIL = schema.TRACK_BAND, schema.LOSS_FACTOR_FORCE_ERROR, schema.LOSS_FACTOR_RAIL_ERROR
CONSTANT, STIFFNESS, LOSS = schema.LOSS_FACTOR, schema.RELAXED_STIFFNESS, schema.RELAXED_LOSS_FACTOR
_COLOURS = (BLUE, VERMILLION, GREEN)
_DASHES = ((), (6, 1.5), (3, 1.5))
_DOTS = (1.5, 1.5)


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


def loss_chart(tree: DataTree, data: Data) -> Chart:
    """Errors of force and receptance per one-third octave; stiffness and loss factor of each part."""
    bands = band_axis(data.at)
    looks = dict(zip(_layers(tree), zip(_COLOURS, _DASHES, strict=True), strict=False))
    nominal = Rules(np.ones(1), "y", dashes=_DOTS, width=1.0)
    constants = [
        Rules(data.lines[CONSTANT, layer].values[:1], "y", colour=colour, dashes=_DOTS, width=1.0)
        for layer, (colour, _) in looks.items()
    ]
    stiffness, loss = (
        [Line(data.at, data.lines[entry, layer].values, layer, *look) for layer, look in looks.items()]
        for entry in (STIFFNESS, LOSS)
    )
    times = log_axis("stiffness / nominal", [nominal.at, *(line.y for line in stiffness)])
    factor = log_axis("loss factor", [mark.at for mark in constants] + [line.y for line in loss])
    return Chart(
        (
            Panel(bands, Axis("error / dB"), _errors(data), height=2.4),
            Panel(bands, times, (nominal, *stiffness), height=1.9),
            Panel(bands, factor, (*constants, *loss), height=1.9),
        )
    )


def _errors(data: Data) -> tuple[Boxes | Line | Rules, ...]:
    bands, error = data.at, data.lines[FORCE].values
    low, high = np.fmin(error, 0.0), np.fmax(error, 0.0)
    bars = Boxes(bands / EDGE, bands * EDGE, low, high, "contact force", _COLOURS[0], hatch="/")
    of_rail = [
        Line(bands, data.lines[entry].values, "receptance of the rail", MUTED, (6, 1.5), 1.2)
        for entry in (RAIL,)
        if entry in data.lines
    ]
    return bars, *of_rail, Rules(np.zeros(1), "y", colour=INK, dashes=(), width=0.8)


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
    loss_chart,
    _loss_caption,
)
