"""What a track could have beside what the package gives it: a foot that flaps, pads of one relaxation."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from asperity.structures.periodic_rail import Rail
from asperity.structures.support import Relaxation
from asperity.structures.track import Track
from asperity.structures.track_parameters import Relaxations

BY_HAND = 5400.0, 2.0 * 0.067 * 0.016 * 7850.0 * 0.613
"""Hz, and kg/m of both halves of a UIC 60's foot that flaps: 67 mm beside the web, 16 mm thick in the mean,
and the share of a cantilever that its first mode takes where its root moves."""
BY_ELEMENTS = 6490.0, 28.5
"""The same by waves of the section, as `railway_foot` has them."""
LOSS = 0.02
"""Of the foot."""


@dataclass(frozen=True)
class FlappingRail(Rail):
    """A rail whose foot is in resonance at a frequency, Hz, with a mass, kg/m."""

    foot: tuple[float, float] = (np.inf, 0.0)

    def waves(self, omega, foundation=None):
        """As of a rail whose mass grows towards that frequency."""
        frequency, mass = self.foot
        ratio = (omega / (2.0 * np.pi * frequency)) ** 2 / (1.0 + 1j * LOSS)
        heavier = self.mass_per_length + mass * ratio / (1.0 - ratio)
        plain = {each.name: getattr(self, each.name) for each in fields(Rail)}
        return Rail(**(plain | {"mass_per_length": heavier})).waves(omega, foundation)


@dataclass(frozen=True)
class FlappingTrack(Track):
    """A track whose rail has such a foot."""

    foot: tuple[float, float] = (np.inf, 0.0)

    @property
    def rail(self):
        """The rail without supports."""
        plain = super().rail
        own = {each.name: getattr(plain, each.name) for each in fields(Rail)}
        return FlappingRail(**own, foot=self.foot)


def with_more(track: Track, foot=None, strength=None, frequency=None) -> Track:
    """The track with a foot of a frequency, Hz, and a mass, kg/m, or pads that relax.

    A pad is a spring with a Maxwell element beside it, which adds a strength of the spring's stiffness well
    above its frequency, Hz.
    """
    if strength is not None:
        pad = Relaxation(1.0, (strength,), (frequency,))
        track = replace(track, relaxations=Relaxations(pad=pad))
    if foot is not None:
        own = {each.name: getattr(track, each.name) for each in fields(Track)}
        track = FlappingTrack(**own, foot=foot)
    return track
