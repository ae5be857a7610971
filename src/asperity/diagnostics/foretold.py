"""Places at which a signal that tones make is not what they foretell: samples lost there, clicks, a knock."""

from collections.abc import Iterator

import numpy as np

from asperity.arguments import Array, floats
from asperity.diagnostics.missing_samples import BLOCK, Mask, Runs, Samples, joined, runs_of

ORDER = 11
"""Samples from which the next one is foretold: two for each of five tones, and one for the mean."""
PARTS, PART = 32, 20 * ORDER
"""Parts of a signal at most, and samples of each: in the best foretold one nothing happens."""
QUIET = 0.01
"""Of the median size of the signal, that what is not foretold may have for tones to make it."""
OFTEN = 0.95
"""Share of what is not foretold that lies below the size by which it is measured: knocks do not move that,
and heavy tails of noise do so little."""
UNLIKE = 4.0
FAINTER = 2.7
"""Times that size, from which on something happened, and where it did, others did: Gaussian noise is so large
once in 2e14 samples, and once in 8e6."""
MORE = 2.0
"""Times as many places at most that are fainter: of blows there are more, the fainter they may be."""


def unforetold(values: Samples, most: float) -> Runs:
    """First place of each stretch of a signal (n,) that its tones do not foretell, and that behind its last.

    None of a signal that more than a few tones make, nor where there are more than so many, or many more that
    are fainter: those are blows.
    """
    parts = _parts(values)
    weights = _foreteller(parts)
    missed = np.abs([np.convolve(part, weights, "valid") for part in parts])
    reached = float(np.quantile(missed, OFTEN))
    if float(np.median(missed)) > QUIET * float(np.median(np.abs(parts - np.mean(parts)))):
        return joined([])

    def unlike(times: float) -> Iterator[Mask]:
        parts = (
            floats(values[first : first + BLOCK + ORDER]) for first in range(0, values.size - ORDER, BLOCK)
        )
        return (np.abs(np.convolve(part, weights, "valid")) > times * reached for part in parts)

    def places(times: float) -> Runs:
        return joined([(first, last + ORDER) for first, last in runs_of(unlike(times))])

    clear = len(places(UNLIKE))
    if not clear:
        return joined([])
    found = places(FAINTER)
    return found if len(found) <= min(most, MORE * clear) else joined([])


def _parts(values: Samples) -> Array:
    """Parts of a signal (n,), evenly spread, which overlap by half at most, (parts, samples)."""
    last = max(values.size - PART, 0)
    firsts = np.linspace(0, last, min(PARTS, 1 + 2 * last // PART)).astype(int)
    return np.array([floats(values[first : first + PART]) for first in firsts])


def _foreteller(parts: Array) -> Array:
    """Weights (ORDER + 1,) of samples, the last one first, by which what is foretold is taken off one."""
    rows = np.lib.stride_tricks.sliding_window_view(parts, ORDER + 1, axis=1)
    triangles = np.asarray(np.linalg.qr(rows, mode="r"))
    missed = np.abs(triangles[:, -1, -1])  # what no sum of the other columns makes
    best = rows[np.argmin(missed)]
    weights, *_ = np.linalg.lstsq(best[:, :-1], best[:, -1], rcond=None)
    return np.append(-weights, 1.0)[::-1]
