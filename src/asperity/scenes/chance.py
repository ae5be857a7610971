"""How far the level of a band may be off in one record: by chance, and by what it still holds of its start.

However wide a band is, it holds few independent values where few resonances ring in it, and what rings
forgets its start as slowly. Both follow from the force of the linear contact per height of the texture at the
places that are passed: its inverse transform over a band, g, is the force that a pulse leaves.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from asperity.arguments import Array, Complex
from asperity.scenes.compute import Computed
from asperity.schema import Entry, spectra
from asperity.spectra import (
    HALF_BAND,
    LEAST_PRODUCT,
    MOST_START,
    averaging_time,
    band_product,
    level_deviation,
)

LINES = 4096
"""Frequencies in a band: they resolve loss factors down to 10⁻⁴."""
PLACES = 8
"""Places along the record at which the linear contact is looked at."""


def values_seen(signal: Array, step: float, centres: Array) -> Array:
    """Number of independent values that bands of a record (n,) are seen to hold, for each one of B T (b,).

    (Σ S)²/Σ S² of the lines of a band over what noise has that is white in it; fewer where a few lines stand
    out, as those of a texture that comes again with each turn of a wheel. Time step in s, centres in Hz.
    """
    frequency = np.fft.rfftfreq(signal.size, step)
    density = np.abs(np.fft.rfft(signal - signal.mean())) ** 2  # a window would make each line several
    found = np.ones(len(centres))
    for band, centre in enumerate(centres):
        lines = density[(frequency >= centre / HALF_BAND) & (frequency < centre * HALF_BAND)]
        if lines.size > 1 and lines.any():
            # of lines from one record the mean square is twice that of their expected values, less the share
            # of each in the sum
            ratio = lines @ lines / lines.sum() ** 2
            found[band] = (2.0 - ratio) / ratio / lines.size
    return np.minimum(found, 1.0)


def chance_and_start(
    transfer: Callable[[Array], Complex], centres: Array, settled: float, record: float
) -> tuple[Array, Array]:
    """Independent values that bands hold (b,), and the share of their mean square that is not built up (b,).

    Of the force per height (p, f) at places and frequencies, of centres (b,), Hz, and of a record, s, that
    begins `settled`, s, after vibration did. The mean square of a force that begins at zero grows as the
    integral of |g|²: the share is what is still to come, as a mean over the record. The mean square over a
    record T of a force with the correlation R(τ) has a relative variance of ∫|R|²(1 − |τ|/T) dτ/(T R(0)²);
    its inverse is the number of independent values, bandwidth times T for noise that is white in the band.
    """
    numbers, shares = np.empty((2, len(centres)))
    for band, centre in enumerate(centres):
        low, width = centre / HALF_BAND, centre * (HALF_BAND - 1.0 / HALF_BAND)
        force = transfer(low + width * (np.arange(LINES) + 0.5) / LINES)
        after = np.arange(LINES) / width
        pulse = np.sum(np.abs(np.fft.ifft(force)) ** 2, axis=0)
        coming = np.where(np.arange(LINES) < LINES // 2, np.clip((after - settled) / record, 0.0, 1.0), 0.0)
        shares[band] = coming @ pulse / pulse.sum()
        power = np.abs(force) ** 2
        lag = np.minimum(after, LINES / width - after)
        alike = np.mean(np.abs(np.fft.ifft(power)) ** 2, axis=0) @ np.maximum(1.0 - lag / record, 0.0)
        numbers[band] = max(np.mean(power) ** 2 * width * record / alike, 1.0)
    return numbers, shares


def sureness(computed: Computed) -> dict[Entry, Any]:
    """Lay out how sure the levels of bands are: B T, chance, and start.

    By the first contact: others of one path hold much the same.
    """
    case, run, band = computed.case, computed.first, computed.band
    time = averaging_time(len(run.time), case.time_step, segment=computed.segment)
    seen = values_seen(run.contact_force[0], case.time_step, band)
    record, (begin, end) = float(run.time[-1]), run.positions[0, [0, -1]]
    places = begin + (end - begin) * (np.arange(PLACES) + 0.5) / PLACES
    transfer = partial(computed.scene.transfer, computed.stiffness, places)
    product = band_product(band, time)
    held, start = chance_and_start(transfer, band, case.settled_time, record)
    values = np.minimum(product * seen, held * time / record)
    return {
        spectra.START_SHARE: spectra.START_SHARE.variable(start, most=MOST_START),
        spectra.BAND_TIME_PRODUCT: spectra.BAND_TIME_PRODUCT.variable(product, least=LEAST_PRODUCT),
        spectra.LEVEL_DEVIATION: level_deviation(values),
    }
