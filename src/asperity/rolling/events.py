"""Loss of contact: when, how long, which share of the time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class ContactLoss:
    """One flight.

    Parameters
    ----------
    start : float
        Time of the first sample out of contact, s.
    duration : float
        Number of samples out of contact times the time step, s.
    """

    start: float
    duration: float


def contact_losses(flying: NDArray, time_step: float) -> list[ContactLoss]:
    """Flights in a record.

    Parameters
    ----------
    flying : ndarray (n,) of bool
        Whether the bodies are apart at each time step.
    time_step : float
        s.

    Returns
    -------
    list of ContactLoss
        In order of time.
    """
    edges = np.diff(np.concatenate([[False], np.asarray(flying, dtype=bool), [False]]).astype(np.int8))
    starts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    return [
        ContactLoss(float(start * time_step), float((end - start) * time_step))
        for start, end in zip(starts, ends, strict=True)
    ]
