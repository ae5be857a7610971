"""A run-up on its page: lines over orders, over speed and frequency, and what follows the speed or stays."""

from collections.abc import Iterable

import numpy as np
from xarray import DataTree

from asperity.arguments import Array
from asperity.reporting import chart, data, panels
from asperity.reporting.figure import Lines, Of, Series, figure
from asperity.scenes.figures.bearing import COLOURS, multiples, named_part, tones_of
from asperity.schema import bearing
from asperity.written_numbers import rounded

MULTIPLES = 3
"""Multiples of the tones of the parts that are drawn."""
SPAN = 60.0
"""dB below the highest line that colours reach."""
ACCELERATION = 1e-6
"""Reference of levels, m/s²."""
LEVEL = "amplitude / dB re 1 µm/s²"


def _level(amplitude: Array) -> Array:
    """Levels of amplitudes, m/s², dB."""
    return 20.0 * np.log10(np.maximum(amplitude, 1e-6 * ACCELERATION) / ACCELERATION)


def _orders(tree: DataTree) -> list[tuple[str, float]]:
    """Parts, and how often their places are met in a turn."""
    turning = data.number(tree, bearing.TURNING) or 1.0
    return [(part, tone / turning) for part, tone in tones_of(tree)]


@figure("Order spectrum", Of(bearing.ORDER), Of(bearing.ORDER_AMPLITUDE, "{law}"))
def order_spectrum(tree: DataTree, lines: Lines) -> chart.Drawn:
    """Lines of the acceleration over angle, up to some multiples of the tones."""
    orders = _orders(tree)
    highest = min((MULTIPLES + 0.5) * max(order for _, order in orders), float(lines.at[-1]))
    within = lines.at <= highest
    levels = [Series(s.name, s.units, _level(s.values), s.entry, s.label, s.places) for s in lines.lines]
    drawn = panels.styled(tree, lines.at, levels)
    rules = multiples(tree, orders, "{:.2f}", MULTIPLES, highest)
    along = chart.Axis("order, events in a turn", 0.0, highest)
    across = panels.levels_axis(LEVEL, [each.y[within] for each in drawn], 80.0)
    yield chart.Panel(along, across, (*rules, *drawn), height=4.2)
    yield (
        "Lines of the acceleration of the outer ring at the first accelerometer, resampled at equal steps of "
        "the angle of the ring that turns: what follows the speed stands still. Dashed: orders at which the "
        "places of a part are met, in pure rolling."
    )


def _by_speed(tree: DataTree) -> Iterable[Series]:
    """A column for each range of speed."""
    if not data.present(tree, bearing.RUN_UP_AMPLITUDE):
        return
    amplitudes = data.values(tree, bearing.RUN_UP_AMPLITUDE)
    for speed, numbers in zip(data.values(tree, bearing.RUN_UP_SPEED), amplitudes, strict=True):
        name = f"amplitude at {rounded(60.0 * float(speed), 6)} 1/min"
        yield Series(name, bearing.RUN_UP_AMPLITUDE.units, numbers, bearing.RUN_UP_AMPLITUDE)


@figure("Run-up", Of(bearing.RUN_UP_FREQUENCY), _by_speed)
def run_up_map(tree: DataTree, lines: Lines) -> chart.Drawn:
    """Level of the lines in colour, over frequency and speed; orders lie on straight lines."""
    speed = 60.0 * data.values(tree, bearing.RUN_UP_SPEED)
    levels = _level(data.values(tree, bearing.RUN_UP_AMPLITUDE))
    top = 5.0 * float(np.ceil(np.nanmax(levels) / 5.0))
    half = 0.5 * float(speed[1] - speed[0])
    wide = 0.5 * float(lines.at[1] - lines.at[0])
    ends = np.array([speed[0] - half, speed[-1] + half])
    left = 1e-3 * (float(lines.at[0]) - wide)
    right = 1e-3 * (float(lines.at[-1]) + wide)
    shown = chart.Field((left, right), (ends[0], ends[1]), levels.T, LEVEL, top - SPAN, top)
    orders = [
        chart.Line(
            1e-3 * order * ends / 60.0, ends, f"{named_part(tree, part)}, {order:.2f} in a turn",
            COLOURS[part], (3.0, 3.0), 1.2
        )
        for part, order in _orders(tree)
    ]  # fmt: skip
    along = chart.Axis("frequency / kHz", max(left, 0.0), right)
    across = chart.Axis("speed / (1/min)", float(ends[0]), float(ends[1]))
    yield chart.Panel(along, across, (shown, *orders), height=4.6)
    yield (
        "Lines of the acceleration at the first accelerometer by the main law, in pieces of the record at "
        "their speed. What follows the speed lies on straight lines through the origin, resonances stand "
        "upright; the orders of the parts are dashed."
    )


@figure("What follows the speed", Of(bearing.FOLLOWING_ORDER), Of(bearing.FOLLOWS, "follows the speed"))
def follows_speed(tree: DataTree, lines: Lines) -> chart.Drawn:
    """Excitation over orders."""
    level = _level(lines.lines[0].values)
    along = chart.Axis("order, events in a turn", float(lines.at[0]), float(lines.at[-1]), log=True)
    drawn = chart.Line(lines.at, level, "follows the speed", chart.BLUE, (), 1.4)
    yield chart.Panel(along, panels.levels_axis(LEVEL, [level]), (drawn,), height=3.2)
    left = data.number(tree, bearing.UNEXPLAINED) or 0.0
    yield (
        "Levels of all pieces, in bands of 1/24 octave, as the sum of what depends on the order alone and "
        "of what depends on the frequency alone, which the next figure shows. What the two leave is "
        f"{rounded(left, 2)} dB rms."
    )


@figure("What stays at its frequency", Of(bearing.STAYING_FREQUENCY), Of(bearing.STAYS, "stays"))
def stays_at_frequency(tree: DataTree, lines: Lines) -> chart.Drawn:
    """Resonances over frequency."""
    level = np.asarray(20.0 * np.log10(lines.lines[0].values))
    drawn = chart.Line(lines.at, level, "stays at its frequency", chart.VERMILLION, (), 1.4)
    along = panels.frequency_axis(float(lines.at[0]), float(lines.at[-1]))
    yield chart.Panel(along, panels.levels_axis("level / dB", [level]), (drawn,), height=3.2)
    yield "How much larger lines are there than over all, at any speed: resonances are peaks."


RUN_UP = run_up_map, order_spectrum, follows_speed, stays_at_frequency
