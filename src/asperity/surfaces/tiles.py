"""Gaussian surfaces that are drawn: functions of place, given a spectrum and a seed, on any grid.

A stationary Gaussian surface of a spectrum S(k) is a sum of waves whose amplitudes are random. Made of the
Fourier lines of a grid, it is another one on each length, width and spacing. Here random numbers are attached
to what is absolute instead:

- Waves belong to *ranges* of wavelength, six one-third octaves each, the same for every surface. A spectrum
  that reaches to longer or shorter waves has more ranges, and changes no other.
- The plane is covered with the *tiles* of each range, whose sizes follow from its longest wave. In each the
  surface is a sum of waves that close on the tile, each √S times a random number. They are summed at the
  places asked for, so that every spacing samples one function. Shorter waves are more terms of the sum.
- Neighbouring tiles are independent and give way to each other over a *blend*, weighted by cos θ and sin θ,
  θ rising smoothly from 0 to π/2. The sum of two independent Gaussian fields keeps variance and distribution
  exactly, and the correlation at a lag τ times cos(π²τ/4 blend) at least. A longer path or a wider strip has
  more tiles.
- Random numbers come from a counter (Philox; J. K. Salmon et al., Proc. SC11, 2011) that is set to the range
  and the tile, and are counted from its longest wave on: any of them can be had without those before.

The spectrum is thus exact in the mean, but for the blends, and a shorter, narrower or coarser piece is part
of any larger or finer one. Along a path waves are summed by a Fourier transform on a grid twice as fine as
they need, from which the places asked for are interpolated by a Kaiser-Bessel kernel, to some 1e-13 of
the rms (J. A. Fessler and B. P. Sutton, IEEE Trans. Signal Process. 51 (2003) 560).
"""

import math
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Protocol

import numpy as np
from numpy.polynomial import chebyshev
from scipy import fft
from scipy.special import i0e

from asperity.arguments import Array, Complex

RANGE = 10.0**0.6
"""Ratio of the longest wave of a range to its shortest: six one-third octaves."""
FIRST = 10.0**-0.05
"""Least wavenumber of range 0, 1/m: an edge of one-third octaves."""
BLEND = 0.3
"""Length of the blend of two tiles, in tiles."""
TAPS = 14
"""Points of the transform that a height is interpolated from."""
FINER = 2
"""Points of the transform per point that the waves need."""
KERNEL = math.pi * TAPS * (1.0 - 0.5 / FINER)
"""Shape of the kernel: how fast it fades."""
DEGREE = 13
"""Degree of the polynomials by which the kernel is found between two points, to rounding."""
TOGETHER = 2**9
"""Places for which the kernel is found at a time."""
KEPT = 2**18
"""Complex random numbers that are kept, at most, 4 MB: the next case often has a surface of the same ones."""

Waves = Complex


def range_of(wavenumber: float) -> int:
    """Number of the range that a wavenumber, 1/m, belongs to; shorter waves have larger ones."""
    return math.floor(math.log(wavenumber / FIRST) / math.log(RANGE) + 1e-9)


def start_of(number: int) -> float:
    """Least wavenumber of a range, 1/m, that of its longest wave."""
    return FIRST * RANGE**number


@lru_cache(maxsize=64)
def _key(seed: int) -> tuple[int, int]:
    first, second = np.random.SeedSequence(seed).generate_state(2, np.uint64)
    return int(first), int(second)


def random_of(seed: int, *place: int) -> np.random.Generator:
    """Random numbers of a seed and a place, at most three whole numbers, negative ones too."""
    counter = np.zeros(4, np.int64)
    counter[1 : 1 + len(place)] = place
    key = np.array(_key(seed), np.uint64)
    return np.random.Generator(np.random.Philox(key=key, counter=counter.view(np.uint64)))


def deviates(seed: int, shape: tuple[int, ...], *place: int) -> Waves:
    """Complex numbers whose parts are standard normal; a larger first axis begins with the smaller one.

    They are not to be written to.
    """
    draw = _deviates if math.prod(shape) <= KEPT else _deviates.__wrapped__
    return draw(seed, shape, *place)


@lru_cache(maxsize=16)
def _deviates(seed: int, shape: tuple[int, ...], *place: int) -> Waves:
    drawn = random_of(seed, *place).standard_normal((*shape, 2)).view(np.complex128)[..., 0]
    drawn.flags.writeable = False
    return drawn


@dataclass(frozen=True)
class Tiling:
    """Tiles along one direction, of a length, m, each of which gives way to the next over a blend, m."""

    length: float
    blend: float
    start: float  # where tile zero begins, m

    @classmethod
    def around_zero(cls, length: float, blend: float = BLEND) -> "Tiling":
        """Tiles the middle of one of which is at zero, with a blend in lengths of a tile."""
        return cls(length, blend * length, -0.5 * length)

    @classmethod
    def from_zero(cls, length: float) -> "Tiling":
        """Tiles, one of which is alone from somewhat before zero on."""
        return cls(length, BLEND * length, -(0.25 + 0.5 * BLEND) * length)

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

    def held(self, tile: int, place: Array) -> slice:
        """Which of rising places, m, lie in a tile."""
        begin = self.start + tile * self.stride
        return slice(*np.searchsorted(place, (begin, begin + self.length)).tolist())

    def within(self, tile: int, place: Array) -> Array:
        """Places, m, from where a tile begins."""
        return place - (self.start + tile * self.stride)

    def weight(self, tile: int, place: Array) -> Array:
        """Share of a tile at places, m: their squares add up to one."""
        within = self.within(tile, place)
        weight = ((within > 0.0) & (within < self.length)).astype(np.float64)
        for blend, share in ((within, np.sin), (within - self.stride, np.cos)):
            there = (blend > 0.0) & (blend < self.blend)
            weight[there] = share(0.5 * np.pi * np.sin(0.5 * np.pi / self.blend * blend[there]) ** 2)
        return weight


class WaveRange(Protocol):
    """Waves of a range of wavelengths, as waves along x."""

    @property
    def along(self) -> Tiling:
        """Tiles along x: the waves of each close on its length."""

    def waves(self, tile: int, across: Array) -> Waves:
        """Complex amplitudes (waves, ny), m, of a tile at places across (ny,), m: 0, 1, 2, … waves a tile."""


class Drawn(Protocol):
    """A surface that is drawn: the sum of ranges of waves."""

    @property
    def ranges(self) -> Sequence[WaveRange]:
        """Its ranges of waves, the longest first."""

    @property
    def name(self) -> Hashable:
        """What names it: surfaces of one name are the same."""

    @property
    def draw(self) -> str:
        """What its random numbers belong to: surfaces for which it is the same have the same ones."""


def heights_at(
    ranges: Sequence[WaveRange], along: Array, lines: int, tile_of: Callable[[int, int], Array]
) -> Array:
    """Heights, m, at rising places along (n,), on so many lines across; shape (n, lines).

    `tile_of` gives the heights of a range, by its place among them, in a tile on its fine grid, see `fine`.
    """
    heights = np.zeros((len(along), lines))
    for place, waves in enumerate(ranges):
        tiling = waves.along
        for tile in tiling.touching(along[0], along[-1]):
            rows = tiling.held(tile, along)
            if rows.stop > rows.start:
                periods = tiling.within(tile, along[rows]) / tiling.length
                heights[rows] += interpolated(tile_of(place, tile), periods, tiling.weight(tile, along[rows]))
    return heights


def closed(drawn: Drawn, rows: int, across: Array) -> Array:
    """Heights (rows, ny), m, of a surface that closes on so many rows, but for waves of less than two."""
    spectrum = np.zeros((rows // 2 + 1, len(across)), np.complex128)
    held = (rows + 1) // 2
    for each in drawn.ranges:
        waves = each.waves(0, across)[:held]
        spectrum[: len(waves)] += 0.5 * rows * waves
    spectrum[0] *= 2.0
    return fft.irfft(spectrum, rows, axis=0, overwrite_x=True)


def fine(waves: Waves) -> Array:
    """Waves summed on a fine grid over one period and `TAPS` points, (points, ny), m, for `interpolated`."""
    points = fft.next_fast_len(max(2 * FINER * len(waves), 2 * TAPS), real=True)
    root = np.sqrt(KERNEL**2 - (math.pi * TAPS * np.arange(len(waves)) / points) ** 2)
    response = TAPS * np.sinh(root) / root * math.exp(-KERNEL)
    spectrum = np.zeros((points // 2 + 1, waves.shape[1]), np.complex128)
    spectrum[: len(waves)] = waves * (0.5 * points / response)[:, None]
    spectrum[0] *= 2.0
    heights = np.empty((points + TAPS, waves.shape[1]))
    heights[:points] = fft.irfft(spectrum, points, axis=0, overwrite_x=True)
    heights[points:] = heights[:TAPS]
    return heights


def interpolated(fine: Array, place: Array, weight: Array | float = 1.0) -> Array:
    """Heights (n, ny), m: the real part of Σ waves[i] exp(2πi·i·place), places in periods, times weights."""
    from scipy.sparse import csr_array

    points = len(fine) - TAPS
    count = len(place)
    at = place * points
    first = np.ceil(at - 0.5 * TAPS)
    share = _kernel(first - (at - 0.5 * TAPS)) * np.broadcast_to(weight, count)[:, None]
    taps = np.mod(first, points).astype(np.int32)[:, None] + np.arange(TAPS, dtype=np.int32)
    ends = np.arange(0, TAPS * count + 1, TAPS, dtype=np.int32)
    return csr_array((share.ravel(), taps.ravel(), ends), (count, len(fine))) @ fine


def _kernel(after: Array) -> Array:
    """Kernel (n, TAPS) at points of the grid, the first of which lies so far after its beginning, 0 to 1."""
    powers = np.ones((DEGREE + 1, TOGETHER))
    found = np.empty((len(after), TAPS))
    for i in range(0, len(after), TOGETHER):  # always as many: no place depends on how many there are
        part = after[i : i + TOGETHER]
        powers[1, : len(part)] = 2.0 * part - 1.0
        for degree in range(2, DEGREE + 1):
            np.multiply(powers[degree - 1], powers[1], out=powers[degree])
        found[i : i + TOGETHER] = (powers.T @ _polynomials())[: len(part)]
    return found


@lru_cache(maxsize=1)
def _polynomials() -> Array:
    """Coefficients (DEGREE + 1, TAPS) of powers of a place between −1 and 1 of the kernel at each tap."""
    at = chebyshev.chebpts1(DEGREE + 1)
    off = 1.0 - (at[:, None] + 1.0 + 2.0 * np.arange(TAPS)) / TAPS
    inside = KERNEL * np.sqrt(np.clip(1.0 - off**2, 0.0, None))
    fitted = chebyshev.chebfit(at, i0e(inside) * np.exp(inside - KERNEL), DEGREE)
    return np.stack([chebyshev.cheb2poly(each) for each in fitted.T], axis=1)
