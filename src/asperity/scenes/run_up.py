"""A bearing whose speed changes: orders of its acceleration, what follows the speed, and what stays."""

import numpy as np

from asperity.arguments import Array
from asperity.diagnostics.orders import LEAST_CHANGE, RunUp, order_spectrum, resonances_apart, run_up
from asperity.scenes.computed_bearing import ComputedBearing
from asperity.scenes.observer import DECLARED, Observer
from asperity.schema import Values, bearing
from asperity.speeds import SpeedCourse, slowest

PIECES = 32
"""Pieces of a record, end to end, in which the speed is taken as constant."""
FINEST = 2.0
"""Hz, of the lines in these, where the record is long."""
SPEEDS, FREQUENCIES = 48, 512
"""Ranges of speed and of frequency that are laid out, at most."""
LINES_OF_A_BAND = 40.0
"""Lowest frequency told apart, over the resolution: then each band of 1/24 octave holds a line."""
HIGHEST_ORDER = 200.0


def run_up_group(computed: ComputedBearing) -> Values:
    """Lay out the first sensor of a run-up over orders, and over speed and frequency by the main law."""
    case = computed.case
    assert isinstance(case.speed, SpeedCourse)
    rate = case.sampling_rate
    runs = computed.runs
    (first, *_) = runs.values()
    turns = case.speed.covered(first.time)
    spectra = [order_spectrum(run.acceleration[0], turns) for run in runs.values() if run.vibrates]
    if not spectra:
        return {}
    order = spectra[0][0]
    kept = (order > 0.0) & (order <= min(HIGHEST_ORDER, 0.5 * rate / slowest(case.speed)))
    amplitudes = iter(each[kept] for _, each in spectra)
    nothing = np.full(np.count_nonzero(kept), np.nan)
    found: Values = {
        bearing.ORDER: order[kept],
        bearing.ORDER_AMPLITUDE: [next(amplitudes) if run.vibrates else nothing for run in runs.values()],
    }
    if not first.vibrates:
        return found
    resolution = max(PIECES / case.duration, FINEST)
    pieces = run_up(first.acceleration[0], rate, case.speed.at(first.time), resolution=resolution)
    lowest = LINES_OF_A_BAND * resolution
    found |= laid_on_speeds(pieces, case.highest_frequency)
    if pieces.speed.max() < LEAST_CHANGE * pieces.speed.min() or 2.0 * lowest >= case.highest_frequency:
        return found
    apart = resonances_apart(pieces, lowest=lowest)
    heard = apart.frequency <= case.highest_frequency
    return found | {
        bearing.FOLLOWING_ORDER: apart.order,
        bearing.FOLLOWS: apart.follows,
        bearing.STAYING_FREQUENCY: apart.frequency[heard],
        bearing.STAYS: apart.stays[heard],
        bearing.UNEXPLAINED: apart.unexplained,
    }


def laid_on_speeds(pieces: RunUp, highest: float) -> Values:
    """The highest lines of all pieces in ranges of speed and of frequency, up to a frequency, Hz."""
    speed = pieces.speed
    count = min(SPEEDS, len(speed))
    edges = np.linspace(speed.min(), speed.max(), count + 1)
    rows = np.clip(np.searchsorted(edges, speed, side="right") - 1, 0, count - 1)
    within = np.count_nonzero(pieces.frequency <= highest)
    width = -(-within // FREQUENCIES)
    starts = np.arange(0, within, width)
    pooled = np.maximum.reduceat(pieces.amplitude[:, :within], starts, axis=1)
    amplitude = np.full((count, len(starts)), np.nan)
    for row in np.unique(rows):
        amplitude[row] = np.sqrt(np.mean(pooled[rows == row] ** 2, axis=0))
    step = float(pieces.frequency[1])
    middle: Array = pieces.frequency[starts] + 0.5 * (width - 1) * step
    return {
        bearing.RUN_UP_SPEED: 0.5 * (edges[1:] + edges[:-1]),
        bearing.RUN_UP_FREQUENCY: middle,
        bearing.RUN_UP_AMPLITUDE: amplitude,
    }


def _speed_changes(computed: ComputedBearing) -> bool:
    return isinstance(computed.case.speed, SpeedCourse)


OBSERVER = Observer(
    "run_up",
    DECLARED,
    run_up_group,
    needs=("bearing",),
    asked_of=_speed_changes,
)
