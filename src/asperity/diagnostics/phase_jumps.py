"""Samples that are left out where no time tells it: the phase of a loud tone jumps there."""

import numpy as np

from asperity.arguments import Array, Complex, Indices, floats
from asperity.diagnostics.missing_samples import Runs, Samples, joined
from asperity.spectra import psd

DOMINANT = 0.5
"""Share of the mean square that the tone has."""
JUMP, PERSISTS = 0.8, 0.25
"""Radians by which a phase jumps, and within which it stays there."""
OFTEN = 8.0
"""Times that it must be what the phase moves by elsewhere, by the median."""
HELD = 0.5
"""Share of its amplitude that the tone has on either side: two tones that beat cancel each other where their
phase jumps."""
LEAST_WINDOW = 48
"""Samples over which a phase is taken, at least."""
TURNS, SEGMENT, LONGEST = 8.0, 2**12, 2**14
"""Of the shaft, over which tones are known apart; samples, at least and at most."""
SEGMENTS = 8
"""Of a signal, over which the mean is taken."""
LINE = 3
"""Places of a spectrum by which a line reaches beside its own."""


def lost_between(values: Samples, turn: float) -> Runs:
    """Where samples of a signal (n,) were left out: first places, and those behind the last.

    There the phase of the loudest tone jumps and stays; that tone needs half of the mean square or more, and
    `turn` is the number of samples of a turn of the shaft. A click and a blow move a phase only while they
    last. Not seen are samples that make whole periods, and places within a few periods of one another.
    """
    tone = _dominant(values, turn)
    if not tone:
        return joined([])
    window = round(np.ceil(LEAST_WINDOW * tone) / tone)
    firsts = range(0, max(values.size - 4 * window, 0), LONGEST)
    found = [
        first + _jumps(floats(values[first : first + LONGEST + 4 * window]), tone, window) for first in firsts
    ]
    wide = max(window // 8, 2)
    return joined([(at - wide, at + wide) for each in found for at in each])


def _dominant(values: Samples, turn: float) -> float:
    """Frequency of a tone that has half of the mean square of a signal (n,), cycles a sample; 0 for none."""
    size = min(max(SEGMENT, int(TURNS * turn)), LONGEST, values.size)
    firsts = np.unique(np.linspace(0, values.size - size, SEGMENTS).astype(int))
    frequency, densities = psd(np.array([values[first : first + size] for first in firsts]), 1.0)
    density = densities.sum(axis=0)
    at = int(density[LINE:-LINE].argmax()) + LINE
    around = slice(at - LINE, at + LINE + 1)
    if density[around].sum() < DOMINANT * density.sum() or at <= LINE:
        return 0.0
    return float(density[around] @ frequency[around] / density[around].sum())


def _jumps(values: Array, tone: float, window: int) -> Indices:
    """Places of a signal (n,) at which the phase of a tone, cycles a sample, jumps, and stays."""
    turned = np.exp(-2j * np.pi * tone * np.arange(values.size))
    total = np.concatenate([[0.0], np.cumsum((values - values.mean()) * turned)])
    seen = total[window:] - total[:-window]
    before, left, right, after = (seen[n * window : seen.size - (3 - n) * window] for n in range(4))
    inner, outer = (_phases(one, other) for one, other in ((left, right), (before, after)))
    size = np.min([np.abs(each) for each in (before, left, right, after)], axis=0)
    held = size >= HELD * np.median(np.abs(seen))
    stays = np.abs(np.angle(np.exp(1j * (outer - inner)))) <= PERSISTS
    jumped = held & stays & (np.abs(inner) >= max(JUMP, OFTEN * float(np.median(np.abs(inner)))))
    there = np.flatnonzero(jumped)
    apart = np.split(there, np.flatnonzero(np.diff(there) > window) + 1)
    places = [each[np.abs(inner[each]).argmax()] for each in apart if each.size]
    return np.array(places, dtype=np.intp) + 2 * window


def _phases(one: Complex, other: Complex) -> Array:
    """Phases of a tone (n,) after those before, less their mean."""
    between = other * one.conj()
    mean = (between / np.maximum(np.abs(between), 1e-300)).mean()
    return np.asarray(np.angle(between * mean.conj()))
