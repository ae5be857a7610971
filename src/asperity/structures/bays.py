"""Bays that differ: distances of sleepers, pads and ballast of a cell, after which the track repeats."""

from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import NamedTuple

import numpy as np

from asperity.arguments import Array, not_negative, require, whole
from asperity.errors import InputError

MOST_BAYS = 100
"""Of a cell: waves are kept of each of them, some ten megabytes."""


class Share(NamedTuple):
    """Stiffness and damping of one support relative to the nominal ones."""

    pad: float
    ballast: float


@dataclass(frozen=True)
class Bays:
    """How each bay of a cell differs: its length, and the support with which it begins.

    All relative to the nominal values of a track; damping goes with stiffness, so that losses stay as they
    are. The mean length is the nominal one.

    Raises
    ------
    InputError
        If there are more than `MOST_BAYS`, not as many values of each, or one that is not positive.
    """

    spacing: tuple[float, ...]
    pad: tuple[float, ...]
    ballast: tuple[float, ...]

    def __post_init__(self) -> None:
        whole("bays of a cell", len(self.spacing), f"1 to {MOST_BAYS}", at_least=1, at_most=MOST_BAYS)
        for each in fields(self):
            values = np.array(getattr(self, each.name))
            what, count = f"{each.name} of the bays", f"as many as bays, {len(self.spacing)}"
            require(len(values) == len(self.spacing), what, f"{len(values)} values", count)
            if wrong := np.flatnonzero(~((values > 0.0) & np.isfinite(values))).tolist():
                received = f"{values[wrong[0]]:.3g} times the nominal one in bay {wrong[0] + 1}"
                raise InputError(what, received, "above zero", "Lower its scatter, or take another seed.")
        received, allowed = f"{np.mean(self.spacing):.6g} times the nominal one", "the nominal one"
        even = np.isclose(np.mean(self.spacing), 1.0, rtol=1e-9)
        require(even, "mean spacing of the bays", received, allowed)

    @classmethod
    def equal(cls, count: int = 1) -> "Bays":
        """Bays that do not differ."""
        return cls(*[(1.0,) * count] * 3)

    @classmethod
    def drawn(
        cls, count: int, *, spacing: float = 0.0, pad: float = 0.0, ballast: float = 0.0, seed: int = 0
    ) -> "Bays":
        """Draw bays from normal distributions, of which these are the standard deviations over the mean.

        Of the lengths the mean is taken out, so that the cell is as long as one of equal bays. The draws of
        one quantity do not depend on the scatter of the others.
        """
        scatters = {"spacing": spacing, "pad": pad, "ballast": ballast}
        drawn = np.random.default_rng(seed).standard_normal((len(scatters), count))
        drawn[0] -= drawn[0].mean()
        return cls(
            *(
                tuple((1.0 + not_negative(f"scatter of the {name}", scatter) * each).tolist())
                for (name, scatter), each in zip(scatters.items(), drawn, strict=True)
            )
        )

    @classmethod
    def listed(cls, spacing: Array, pad: Array, ballast: Array) -> "Bays":
        """Bays one by one (n,), in any unit: of each quantity the mean is taken for the nominal one."""
        return cls(*(tuple((each / each.mean()).tolist()) for each in (spacing, pad, ballast)))

    @property
    def lengths(self) -> Array:
        """Relative lengths (n,)."""
        return np.array(self.spacing)

    @property
    def shares(self) -> Iterator[Share]:
        """Of the supports with which bays begin, one after the other."""
        return (Share(*pair) for pair in zip(self.pad, self.ballast, strict=True))
