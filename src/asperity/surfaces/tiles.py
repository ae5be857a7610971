"""Gaussian surfaces that are drawn: functions of place, given a spectrum and a seed, on any grid.

A stationary Gaussian surface of a spectrum S(k) is a sum of waves whose amplitudes are random. Made of the
Fourier lines of a grid, it is another one on each length, width and spacing. Here random numbers are attached
to what is absolute instead:

- The plane is covered with *tiles* whose sizes follow from the longest waves of the spectrum. In each the
  surface is a sum of waves that close on the tile, each √S times a random number. They are summed at the
  places asked for, so that every spacing samples one function. Shorter waves are more terms of the sum.
- Neighbouring tiles are independent and give way to each other over a *blend*, weighted by cos θ and sin θ,
  θ rising from 0 to π/2. The sum of two independent Gaussian fields keeps variance and distribution exactly,
  and the correlation at a lag τ times cos(πτ/2 blend) at least. A longer path or a wider strip has more
  tiles.
- Random numbers come from a counter (Philox; J. K. Salmon et al., Proc. SC11, 2011) that is set to the tile
  and the wave: any of them can be had without those before.

The spectrum is thus exact in the mean, but for the blends, and a shorter, narrower or coarser piece is part
of any larger or finer one. Along a path waves are summed by a Fourier transform on a grid twice as fine as
they need, from which the places asked for are interpolated by a Kaiser-Bessel kernel, to some 1e-13 of
the rms (J. A. Fessler and B. P. Sutton, IEEE Trans. Signal Process. 51 (2003) 560).
"""

import math
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy import fft
from scipy.special import i0e

from asperity.arguments import Array, NDArray

TAPS = 14
"""Points of the transform that a height is interpolated from."""
FINER = 2
"""Points of the transform per point that the waves need."""
KERNEL = math.pi * TAPS * (1.0 - 0.5 / FINER)
"""Shape of the kernel: how fast it fades."""
GROUP = 16
"""Waves along that share a stream of random numbers."""

Waves = NDArray[np.complex128]


def random_of(seed: int, *place: int) -> np.random.Generator:
    """Random numbers of a seed and a place, at most three whole numbers, negative ones too."""
    key = np.random.SeedSequence(seed).generate_state(2, np.uint64)
    counter = np.zeros(4, np.int64)
    counter[1 : 1 + len(place)] = place
    return np.random.Generator(np.random.Philox(key=key, counter=counter.view(np.uint64)))


def deviates(seed: int, shape: tuple[int, ...], *place: int) -> Waves:
    """Complex numbers whose parts are standard normal; a larger first axis begins with the smaller one."""
    return random_of(seed, *place).standard_normal((*shape, 2)).view(np.complex128)[..., 0]


@dataclass(frozen=True)
class Tiling:
    """Tiles along one direction, of a length, m, each of which gives way to the next over a blend, m."""

    length: float
    blend: float
    start: float  # where tile zero begins, m

    @classmethod
    def around_zero(cls, length: float, blend: float) -> "Tiling":
        """Tiles the middle of one of which is at zero."""
        return cls(length, blend, -0.5 * length)

    @classmethod
    def from_zero(cls, length: float, blend: float) -> "Tiling":
        """Tiles, one of which is alone from somewhat before zero on."""
        return cls(length, blend, -blend - 0.25 * (length - 2.0 * blend))

    def __str__(self) -> str:
        return f"tiles of {self.length:.6g} m from {self.start:.6g} m"

    @property
    def stride(self) -> float:
        """Distance from tile to tile, m."""
        return self.length - self.blend

    def touching(self, first: float, last: float) -> range:
        """Tiles that lie between two places, m."""
        return range(
            math.floor((first - self.start - self.blend) / self.stride),
            math.floor((last - self.start) / self.stride) + 1,
        )

    def within(self, tile: int, place: Array) -> Array:
        """Places, m, from where a tile begins."""
        return np.asarray(place - (self.start + tile * self.stride))

    def weight(self, tile: int, place: Array) -> Array:
        """Share of a tile at places, m: their squares add up to one."""
        within = self.within(tile, place)
        rising = np.clip(within / self.blend, 0.0, 1.0)
        falling = np.clip((within - self.stride) / self.blend, 0.0, 1.0)
        return np.sin(0.5 * np.pi * rising) * np.cos(0.5 * np.pi * falling) * (falling < 1.0)


class Drawn(Protocol):
    """A surface that is drawn, as waves along x."""

    @property
    def along(self) -> Tiling:
        """Tiles along x: the waves of each close on its length."""

    def waves(self, tile: int, across: Array) -> Waves:
        """Complex amplitudes (waves, ny), m, of a tile at places across (ny,), m: 0, 1, 2, … waves a tile."""

    @property
    def name(self) -> Hashable:
        """What names it: surfaces of one name are the same."""

    @property
    def draw(self) -> str:
        """What its random numbers belong to: surfaces for which it is the same have the same ones."""


def heights_at(tiling: Tiling, along: Array, lines: int, tile_of: Callable[[int], Array]) -> Array:
    """Heights, m, at rising places along (n,), on so many lines across; shape (n, lines).

    `tile_of` gives the heights of a tile on its fine grid, see `fine`.
    """
    heights = np.zeros((len(along), lines))
    for tile in tiling.touching(along[0], along[-1]):
        weight = tiling.weight(tile, along)
        there = np.flatnonzero(weight)
        if len(there):
            rows = slice(there[0], there[-1] + 1)
            place = tiling.within(tile, along[rows]) / tiling.length
            heights[rows] += weight[rows, None] * interpolated(tile_of(tile), place)
    return heights


def closed(waves: Waves, rows: int) -> Array:
    """Heights (rows, ny), m, of waves (waves, ny) that close on so many rows, but for those of two rows."""
    spectrum = np.zeros((rows // 2 + 1, waves.shape[1]), np.complex128)
    held = (rows + 1) // 2
    spectrum[: len(waves)][:held] = 0.5 * rows * waves[:held]
    spectrum[0] *= 2.0
    return np.asarray(fft.irfft(spectrum, rows, axis=0, overwrite_x=True))


def fine(waves: Waves) -> Array:
    """Waves summed on a fine grid over one period (points, ny), m, as `interpolated` takes them."""
    points = fft.next_fast_len(max(2 * FINER * len(waves), 2 * TAPS), real=True)
    root = np.sqrt(KERNEL**2 - (math.pi * TAPS * np.arange(len(waves)) / points) ** 2)
    response = TAPS * np.sinh(root) / root * math.exp(-KERNEL)
    return closed(waves / response[:, None], points)


def interpolated(fine: Array, place: Array) -> Array:
    """Heights (n, ny), m: the real part of Σ waves[i] exp(2πi·i·place), at places (n,) in periods."""
    points = len(fine)
    at = place * points
    first = np.ceil(at - 0.5 * TAPS)
    heights = np.zeros((len(place), fine.shape[1]))
    for tap in range(TAPS):
        off = (at - first - tap) * (2.0 / TAPS)
        inside = KERNEL * np.sqrt(np.clip(1.0 - off**2, 0.0, None))
        weight = i0e(inside) * np.exp(inside - KERNEL)
        heights += weight[:, None] * fine[(first.astype(np.intp) + tap) % points]
    return heights
