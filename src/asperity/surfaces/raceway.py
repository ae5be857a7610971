"""Surfaces that are closed around: raceways and balls with waviness, roughness, a trace, and faults."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Literal, Self

import numpy as np
from scipy import fft

from asperity.arguments import Array, ArrayLike, Complex, Flags, finite_array, require, two_lengths
from asperity.parameters import (
    LENGTH,
    LENGTH_OR_ZERO,
    File,
    ListOf,
    Number,
    checked_parameters,
    optional_parameter,
    parameter,
    usual_parameter,
)
from asperity.surfaces.edges import Edges
from asperity.surfaces.faults import MAP, Fault, lay, map_of
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.likeness import likeness
from asperity.surfaces.strip import places_across
from asperity.surfaces.synthesis import LikeMaps, SelfAffine
from asperity.surfaces.tiles import closed
from asperity.written_numbers import count_of, rounded

MOST_POINTS = 2**26
"""Points of a raceway: 512 MiB."""
_WAVES = "1 nm to 1 mm: raceways and balls are rounder"
_LISTED_WAVES = "1e-6 nm to 1 mm: short waves have little, and raceways and balls are rounder"
_RMS = "0.01 nm to 0.1 mm: finishes lie between"
_HIGHEST = "1 to 100000: others are shorter than contacts"
_LENGTHS = "1 nm to 1 m: textures lie between"
_RATIOS = "0.001 to 1000: lay is no longer"
_FALL = Number(at_least=-10, at_most=10)
_ORDER = Number(at_least=1, whole=True)
_AMPLITUDES = ListOf(LENGTH_OR_ZERO)
_TRACE = File(columns=(2,), content="a table of angle and deviation")


@dataclass(frozen=True)
class AroundTexture:
    """What is on a raceway or ball all around: waviness, a measured trace, roughness; the sum of them.

    Parameters
    ----------
    waves, amplitudes : tuple
        Waves per turn, and the amplitude of each, m.
    waviness : float, optional
        Amplitude at `first_order` of a spectrum that falls as order^-fall up to `last_order`, m.
    first_order, last_order, fall : int, int, float
        Of that spectrum.
    trace : (n, 2) array, optional
        Measured roundness over one turn: angle, rad, and deviation, m. Its mean and its first order, which
        say how the part lay on the instrument, are taken off.
    roughness : float, optional
        Rms height of self-affine roughness, m: that of the ensemble, see `asperity.surfaces.synthesis`.
    hurst, longest, shortest, anisotropy : float
        Of the roughness; wavelengths in m.
    map : HeightMap or path, optional
        A measured roughness instead, complete. It does not close around a raceway, and is not tiled: a
        surface in its likeness does.

    Raises
    ------
    InputError
        If numbers do not fit each other, or the trace does not close.
    """

    waves: tuple[int, ...] = parameter(ListOf(_ORDER), [3, 9], "waves per turn", _HIGHEST, default=())
    amplitudes: tuple[float, ...] = parameter(
        _AMPLITUDES, ["1 um", "0.1 um"], "amplitude of each of the waves", _LISTED_WAVES, default=()
    )
    waviness: float | None = optional_parameter(LENGTH, "0.5 um", "amplitude at first_order", _WAVES)
    first_order: int = usual_parameter(_ORDER, 2, "fewest waves per turn of the waviness", _HIGHEST)
    last_order: int = usual_parameter(_ORDER, 100, "most waves per turn of it", _HIGHEST)
    fall: float = usual_parameter(_FALL, 1.5, "p of its amplitudes, which fall as order^-p")
    trace: Array | None = optional_parameter(  # noqa: RUF009
        _TRACE, "roundness.csv", "measured roundness"
    )
    roughness: float | None = optional_parameter(LENGTH, "20 nm", "rms of the roughness", _RMS)
    hurst: float = usual_parameter(Number(above=0, at_most=1), 0.8, "its Hurst exponent")
    longest: float = usual_parameter(LENGTH, "0.5 mm", "its roll-off wavelength", _LENGTHS)
    shortest: float = usual_parameter(LENGTH, "50 um", "its shortest wavelength", _LENGTHS)
    anisotropy: float = usual_parameter(
        Number(above=0), 1.0, "its correlation length along over that across", _RATIOS
    )
    map: HeightMap | Path | None = optional_parameter(  # noqa: RUF009
        MAP, "raceway.x3p", "measured roughness instead"
    )

    def __post_init__(self) -> None:
        checked_parameters(self)
        received = f"{count_of(len(self.waves), 'wave')} and {count_of(len(self.amplitudes), 'amplitude')}"
        require(len(self.waves) == len(self.amplitudes), "waves", received, "one amplitude for each")
        received = f"{self.first_order} to {self.last_order}"
        require(1 <= self.first_order <= self.last_order, "orders of the waviness", received, "rising orders")
        both = self.map is not None and self.roughness is not None
        require(not both, "roughness", "a number and a map", "one of them", "Remove one.")
        if self.trace is not None:
            closed_trace(self.trace)

    @property
    def is_rough(self) -> bool:
        """Whether it holds heights that differ across the path."""
        return self.roughness is not None or self.map is not None

    @property
    def draw(self) -> str:
        """What its random numbers belong to, beside a seed; empty where there are none."""
        waves = "waves" * bool(self.waves or self.waviness)
        rough = (
            f"self-affine, drawn out {self.anisotropy:.6g} times"
            if self.roughness
            else "map" * bool(self.map)
        )
        return " and ".join(filter(None, (waves, rough)))

    def line(self, rows: int, seed: int) -> Complex:
        """Complex amplitudes (rows // 2 + 1,), m, of waves per turn: a line is their real part, summed."""
        found = np.zeros(rows // 2 + 1, dtype=complex)
        last = rows // 2 - 1
        highest = max((*self.waves, self.last_order if self.waviness else 1))
        remedy = "Leave out waves that are shorter than the contacts, or add them as roughness."
        require(highest <= last, "waves per turn", highest, f"at most {last}, by two cells a wave", remedy)
        phases = np.exp(2j * np.pi * np.random.default_rng([seed, 1]).random(last + 1))
        if self.waviness:
            orders = np.arange(self.first_order, self.last_order + 1)
            found[orders] += self.waviness * (orders / self.first_order) ** -self.fall * phases[orders]
        for order, amplitude in zip(self.waves, self.amplitudes, strict=True):
            found[order] += amplitude * phases[order]
        if self.trace is not None:
            angle, deviation = closed_trace(self.trace)
            from scipy.interpolate import CubicSpline

            spline = CubicSpline(angle, deviation, bc_type="periodic")
            measured = fft.rfft(spline(2.0 * np.pi * np.arange(rows) / rows)) * (2.0 / rows)
            found[2 : last + 1] += measured[2 : last + 1]
        return found

    def rough(self, shape: tuple[int, int], spacing: tuple[float, float], seed: int) -> Array:
        """Roughness (rows, lines), m, closed along the rows."""
        around = shape[0] * spacing[0]
        across = places_across(shape[1], spacing[1])
        if self.map is not None:
            like = likeness(map_of(self.map).levelled(), spacing)
            return like.transform(closed(LikeMaps(like, seed, shape[0]), shape[0], across))
        texture = SelfAffine(
            rms=self.roughness or 0.0, hurst=self.hurst, longest=self.longest, shortest=self.shortest,
            anisotropy=self.anisotropy, seed=seed, around=around,
        )  # fmt: skip
        texture.check(spacing)
        return closed(texture, shape[0], across)


def closed_trace(trace: ArrayLike) -> tuple[Array, Array]:
    """Angles (n + 1,), rad, over exactly one turn, and deviations, m, whose last is the first; or refuse.

    The step from the end of the trace to its beginning must be none that its own steps are not: it may turn
    by one step less than a whole turn, or end where it began.
    """
    what = "roundness trace"
    angle, deviation = finite_array(what, trace, "finite angles, rad, and deviations, m", shape=(None, 2)).T
    steps = np.diff(angle)
    jumps = np.abs(np.diff(deviation))
    require(len(angle) >= 8 and (steps > 0.0).all(), what, "few or falling angles", "8 or more, rising")
    turned = angle[-1] - angle[0]
    turn = 2.0 * math.pi
    widest = float(steps.max())
    received = f"{math.degrees(turned):.6g} deg"
    allowed = "one turn, 360 deg, or one step less"
    once = turn - 1.5 * widest <= turned <= turn + 1e-3 * widest
    require(once, what, received, allowed, "Trim it to one turn.")
    open_by = abs(float(deviation[-1] - deviation[0]))
    received = f"ends that differ by {rounded(open_by * 1e6)} um"
    allowed = f"ends that meet as its neighbours do, within {rounded(jumps.max() * 1e6)} um"
    require(open_by <= jumps.max(), what, received, allowed, "Take off what drifted, or measure anew.")
    n = len(angle) - (turned > turn - 0.5 * steps.min())  # without where it came back to its first place
    return np.append(angle[:n], angle[0] + turn), np.append(deviation[:n], deviation[0])


FRINGE = 16
"""Rows beyond either end of a circle, from which splines close it."""


@dataclass(frozen=True, eq=False)
class Raceway:
    """Surface of a raceway or a ball, closed along its rows: behind the last comes the first.

    Parameters
    ----------
    heights : (rows, lines) array
        Roughness and short waves, m, positive out of the material; the middle line is the path.
    spacing : (float, float)
        Distances (dx, dy), m, of rows and lines.
    line : (rows,) array, optional
        Long waves, m, the same all across, that contacts follow as a plane.
    faults : (rows, lines) array, optional
        Heights of faults, m, zero elsewhere.
    edges : Edges, optional
        Sharp edges of faults: in cells that they cross, heights are those of the sound surface.

    Raises
    ------
    InputError
        If shapes do not fit or heights are not finite.
    """

    heights: Array
    spacing: tuple[float, float]
    line: Array = None  # type: ignore[assignment]  # zeros, as the next
    faults: Array = None  # type: ignore[assignment]
    edges: Edges | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "spacing", two_lengths("spacing of the raceway", self.spacing))
        shape = np.shape(self.heights)
        for name, expected in (("heights", (None, None)), ("line", shape[:1]), ("faults", shape)):
            given = getattr(self, name)
            what = f"{name} of the raceway"
            values = np.zeros(shape[: len(expected)]) if given is None else given
            object.__setattr__(self, name, finite_array(what, values, "finite heights", shape=expected))
        allowed = "8 rows or more, and an odd number of lines, so that one is the middle"
        require(shape[0] >= 8 and shape[1] % 2, "heights of the raceway", f"shape {shape}", allowed)

    @cached_property
    def damaged(self) -> Flags:
        """Where faults or their edges are (rows, lines)."""
        hollow = self.faults != 0.0
        return hollow if self.edges is None else hollow | self.edges.crossed

    @property
    def circumference(self) -> float:
        """Length of the path, m."""
        return len(self.heights) * self.spacing[0]

    def on_cells(self, spacing: tuple[float, float], lines: int, *, forwards: bool = True) -> Self:
        """The surface on other cells (dx, dy), m, and so many lines; of rows in the other order if backwards.

        Its rows are as far apart as they can be for the path to close. Its long waves lie in its heights.
        """
        from scipy.ndimage import map_coordinates

        rows, wide = self.heights.shape
        count = round(self.circumference / spacing[0])  # the same cells, but for what closes the circle
        along = np.arange(count) * (rows / count) + FRINGE
        across = (np.arange(lines) - lines // 2) * (spacing[1] / self.spacing[1]) + wide // 2
        at = np.meshgrid(along, across, indexing="ij")

        def sampled(values: Array, order: Literal[1, 3]) -> Array:
            around = np.pad(values, ((FRINGE, FRINGE), (0, 0)), "wrap")
            found = map_coordinates(around, at, order=order, mode="nearest")
            return found if forwards else np.roll(found[::-1], 1, axis=0)

        edges = None
        if self.edges is not None:
            fields = (self.edges.distance, self.edges.normal, self.edges.drop)
            distance, normal, drop = (sampled(each, 1) for each in fields)
            edges = Edges(distance, normal, drop, spacing)
        heights = sampled(self.heights + self.line[:, None], 3)
        faults = sampled(self.faults, 1)
        steps = self.circumference / count, spacing[1]
        return type(self)(heights, steps, faults=faults, edges=edges)


def raceway(
    texture: AroundTexture,
    faults: Sequence[Fault],
    shape: tuple[int, int],
    spacing: tuple[float, float],
    *,
    seed: int,
    followed: float,
) -> Raceway:
    """Surface (rows, lines) of a raceway or a ball, spacing (dx, dy), m.

    Waves of its line longer than `followed`, m, stay in the `line` of the `Raceway`, shorter ones are in its
    heights.
    """
    rows, lines = shape
    received = f"{rows} × {lines} points"
    allowed = f"at most {MOST_POINTS} points"
    remedy = "Lengthen the shortest wavelength of the roughness, or enlarge the smallest fault."
    require(rows * lines <= MOST_POINTS, "surface of the raceway", received, allowed, remedy)
    waves = texture.line(rows, seed) * (0.5 * rows)
    long = np.arange(len(waves)) * followed <= rows * spacing[0]
    heights = texture.rough(shape, spacing, seed) if texture.is_rough else np.zeros(shape)
    if (waves * ~long).any():
        heights = heights + fft.irfft(waves * ~long, rows)[:, None]
    laid, edges = lay(tuple(faults), shape, spacing)
    return Raceway(heights, spacing, fft.irfft(waves * long, rows), laid, edges)
