"""Laws of several contacts, handed to the kernel together, piece by piece of the path."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from asperity.kernels.pointforce import Prepared
from asperity.kernels.several import Laws


class Stack:
    """`Prepared` laws of all contacts, padded to the largest: one kernel serves any number and mix."""

    def __init__(self, prepared: Sequence[Prepared]) -> None:
        self.prepared = prepared
        self.states = max(len(law.states) for law in prepared)
        self.table = any(len(law.slopes) for law in prepared)
        knots = max(len(law.knots) for law in prepared)
        n = len(prepared)

        def each(name: str, kind: type) -> NDArray[np.generic]:
            return np.array([getattr(law, name) for law in prepared], dtype=kind)

        none = np.zeros((n, 0))
        self.laws = Laws(
            each("form", np.int64),
            none,
            np.array([len(law.states) for law in prepared]),
            np.zeros((n, self.states)),
            np.zeros((n, 0, self.states)),
            np.zeros((n, 0, self.states)),
            none,
            np.array([len(law.knots) for law in prepared]),
            np.zeros((n, knots)),
            np.zeros((n, max(knots - 1, 0), 4)),
            each("exponent", float),
            each("bilateral", bool),
            each("datum", float),
            each("damping", float),
            each("damped_in_flight", bool),
        )
        for k, law in enumerate(prepared):
            self.laws.states[k, : len(law.states)] = law.states
            self.laws.knots[k, : len(law.knots)] = law.knots
            self.laws.coefficients[k, : len(law.coefficients)] = law.coefficients

    def piece(self, first: int, end: int) -> Laws:
        """Laws on the steps from `first` to before `end`."""
        n, rows = len(self.prepared), end - first
        planes, values = np.zeros((n, rows)), np.zeros((n, rows, self.states))
        slopes = np.zeros((n, rows if self.table else 0, self.states))
        touches = np.zeros((n, rows if self.table else 0))
        for k, law in enumerate(self.prepared):
            count = len(law.states)
            planes[k], values[k, :, :count] = law.planes[first:end], law.values[first:end]
            if len(law.slopes):
                slopes[k, :, :count], touches[k] = law.slopes[first:end], law.touches[first:end]
        return self.laws._replace(planes=planes, values=values, slopes=slopes, touches=touches)
