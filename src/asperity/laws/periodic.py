"""A law on a path that is closed: a raceway, on which balls run turn after turn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asperity.arguments import Array
from asperity.laws import spec


@dataclass(frozen=True, eq=False)
class Periodic(spec.OnLaw):
    """A law on a path that is closed: positions count modulo its circumference, m.

    Parameters
    ----------
    law : Law
        Known from zero to the circumference at least.
    circumference : float
        m.
    ball : PairedLaw, optional
        The same law of the surface of the ball that rolls on it, on the same cells, from zero to its
        circumference at least; for a law that is a `PairedLaw` itself.
    radius : float
        Of the circle of that ball that rolls, m; negative where the contact runs against the positions on the
        path, with the surface in the other order.
    """

    circumference: float
    ball: spec.PairedLaw | None = None
    radius: float = 0.0

    def prepare(self, positions: spec.ArrayLike) -> spec.Prepared | spec.SteppedLaw:
        """Lay the law out on positions (n,), m, on as many turns as they are.

        With a ball (n, 2): these, and the angle of its spot that touches, rad.
        """
        at = np.asarray(positions, dtype=float)
        if self.ball is None:
            return self.law.prepare(_within(at, self.circumference))
        assert isinstance(self.law, spec.PairedLaw)
        on_path = _within(at[:, 0], self.circumference)
        on_ball = _within(self.radius * at[:, 1], 2.0 * np.pi * abs(self.radius))
        return self.law.prepare_pair(on_path, self.ball, on_ball)


def _within(positions: Array, turn: float) -> Array:
    """Positions within one turn, m; those that all are, as mostly, are left as they are."""
    if positions.min() >= 0.0 and positions.max() < turn:
        return positions
    return np.mod(positions, turn)
