"""Loss of contact: when, how long, which share of the time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class ContactLoss:
    """One flight."""

    start: float  # time of the first sample out of contact, s
    duration: float  # samples out of contact times the time step, s


def contact_losses(flying: NDArray[np.bool_], time_step: float) -> list[ContactLoss]:
    """Flights in a record, in order of time; `flying` (n,) says whether bodies are apart; time step in s."""
    edges = np.diff(np.concatenate([[False], np.asarray(flying, dtype=bool), [False]]).astype(np.int8))
    starts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    return [
        ContactLoss(float(start * time_step), float((end - start) * time_step))
        for start, end in zip(starts, ends, strict=True)
    ]
