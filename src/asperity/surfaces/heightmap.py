"""Measured or synthesised surfaces and lines: heights on a uniform grid, in metres, peaks positive."""

from __future__ import annotations

import base64
import io
from dataclasses import dataclass, replace
from html import escape
from typing import Self

import numpy as np

from asperity.arguments import Array, ArrayLike, real, real_array, require, two, two_lengths, whole
from asperity.errors import percent, printable
from asperity.surfaces import cleaning, levelling
from asperity.surfaces.even_heights import EvenHeights
from asperity.units import written

PICTURE_POINTS = 600
"""Points along each side of the picture that a notebook shows, at most."""


@dataclass(frozen=True, eq=False)
class Heights(EvenHeights):
    """What maps and lines have in common."""

    def levelled(self, degree: int | str = "plane") -> Self:
        """Return the heights less their least-squares polynomial form.

        Parameters
        ----------
        degree : str or int
            ``"plane"`` (of a line: its mean line), ``"quadratic"`` or ``"quartic"``, as in a case, or the
            total degree of the polynomial in x and y: 1, 2, 4, or 0, which removes the mean.

        Returns
        -------
        HeightMap or Profile
            See `asperity.surfaces.levelling.level`.
        """
        return levelling.level(self, degree)

    def filled(self, lines: bool | None = None) -> Self:
        """Return the heights with their missing points interpolated from their neighbours.

        Parameters
        ----------
        lines : bool, optional
            Whether a map holds lines measured side by side, which are filled along themselves; by default its
            shape tells.

        Returns
        -------
        HeightMap or Profile
            See `asperity.surfaces.cleaning.fill`.
        """
        return cleaning.fill(self, lines)

    def band_limited(self, longest: float | None = None, shortest: float | None = None) -> Self:
        """Return the heights with only the wavelengths between two limits.

        Parameters
        ----------
        longest, shortest : float, optional
            Limits in m; a limit left out does not act.

        Returns
        -------
        HeightMap or Profile
            See `asperity.surfaces.levelling.band_limit`.
        """
        return levelling.band_limit(self, longest=longest, shortest=shortest)

    @property
    def described(self) -> str:
        """How many points they are, how far apart, and how rough."""

        def lengths(values: ArrayLike, unit: str) -> str:
            return " × ".join(written(float(f"{each:.4g}"), "m", unit) for each in np.atleast_1d(values))

        points = " × ".join(map(str, self.heights.shape))
        missing = f", {percent(self.missing_share)} without a height" if self.missing_share else ""
        size = lengths(self._sides, "mm")
        spacing = lengths(self.spacing, "um")
        rms = lengths(np.nanstd(self.heights), "um")
        return f"{points} points, {size}, {spacing} apart, rms height {rms}{missing}"

    @property
    def _sides(self) -> Array:
        """Lengths along, and of a map across, m."""
        return np.atleast_1d(self.spacing) * self.heights.shape

    def __repr__(self) -> str:
        source = f", {printable(self.source)}" if self.source else ""
        return f"<{type(self).__name__}: {self.described}{source}>"

    def _repr_html_(self) -> str:
        """Describe and draw the heights, in µm over lengths in mm, as HTML without anything active."""
        what = "Height map" if self.heights.ndim == 2 else "Profile"
        source = f"<br>{escape(printable(self.source))}" if self.source else ""
        picture = f'<img alt="{what.lower()}" src="data:image/png;base64,{self._picture(self._sides)}">'
        said = escape(f"{self.described}.".replace(" um", " µm"))
        return f"<div><p><strong>{what}.</strong> {said}{source}</p>{picture}</div>"

    def _picture(self, sizes: Array) -> str:
        """Picture of heights with sides of these lengths, m, as PNG in base 64."""
        from matplotlib.figure import Figure

        figure = Figure(figsize=(6.0, 2.8 if len(sizes) == 2 else 1.8), layout="constrained")
        axes = figure.subplots()
        axes.set_xlabel("x / mm")
        if len(sizes) == 2:
            thin = tuple(slice(None, None, max(1, -(-n // PICTURE_POINTS))) for n in self.heights.shape)
            extent = (0.0, 1e3 * sizes[0], 0.0, 1e3 * sizes[1])
            image = axes.imshow(1e6 * self.heights[thin].T, origin="lower", extent=extent, cmap="cividis")
            axes.set_aspect("auto" if sizes.max() > 4.0 * sizes.min() else "equal")
            figure.colorbar(image, ax=axes, label="height / µm")
            axes.set_ylabel("y / mm")
        else:
            axes.plot(1e3 * self.x, 1e6 * self.heights, linewidth=0.6)
            axes.set_ylabel("height / µm")
        png = io.BytesIO()
        figure.savefig(png, format="png", dpi=110)
        return base64.b64encode(png.getvalue()).decode()


@dataclass(frozen=True, eq=False, repr=False)
class HeightMap(Heights):
    """Heights of a surface on a uniform rectangular grid.

    Parameters
    ----------
    heights : (nx, ny) array_like
        Heights in m, peaks positive; the first axis is x, the rolling direction. NaN marks a point without a
        height. Kept as a read-only float64 copy.
    spacing : tuple of float
        Distances (dx, dy) of neighbouring points in m. One float stands for both.
    source : str
        Where the heights came from.

    Raises
    ------
    InputError
        If the heights are not a 2-D array of real numbers with at least two points along each axis, hold an
        infinite value or no value at all, or if a spacing is not positive and finite.

    Examples
    --------
    >>> import numpy as np
    >>> from asperity import HeightMap
    >>> surface = HeightMap(1e-6 * np.array([[0.0, 1.0, 0.0], [1.0, 2.0, 1.0]]), (1e-3, 2e-3))
    >>> surface.shape, surface.size
    ((2, 3), (0.002, 0.006))
    >>> (surface.line().heights * 1e6).tolist()  # along the rolling direction
    [1.0, 2.0]
    """

    spacing: tuple[float, float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "heights", _checked_heights(self.heights, 2, self.source))
        object.__setattr__(self, "spacing", two_lengths("spacing of the height map", self.spacing))

    @property
    def shape(self) -> tuple[int, int]:
        """Number of points (nx, ny)."""
        nx, ny = self.heights.shape
        return nx, ny

    @property
    def size(self) -> tuple[float, float]:
        """Lengths (nx dx, ny dy) of the area that the points stand for, in m."""
        return self.shape[0] * self.spacing[0], self.shape[1] * self.spacing[1]

    @property
    def y(self) -> Array:
        """Coordinates (ny,) across the rolling direction in m, from zero."""
        return np.arange(self.shape[1], dtype=np.float64) * self.spacing[1]

    def rows(self, first: int, stop: int) -> Array:
        """Return the heights of some rows across the rolling direction.

        Parameters
        ----------
        first, stop : int
            The rows first … stop − 1.

        Returns
        -------
        (stop − first, ny) ndarray
            Heights in m.
        """
        return self.heights[first:stop]

    def without_spikes(self) -> HeightMap:
        """Return the map with its spikes as points without a height.

        Returns
        -------
        HeightMap
            See `asperity.surfaces.cleaning.spikes`; `filled` interpolates the points.
        """
        return cleaning.without_spikes(self)

    def line(self, index: int | None = None) -> Profile:
        """Return one line of the map along the rolling direction.

        Parameters
        ----------
        index : int, optional
            Which of the ny lines, from zero; the central one (ny // 2) if left out.

        Returns
        -------
        Profile
            The (nx,) heights with spacing dx.

        Raises
        ------
        InputError
            If there is no such line.
        """
        last = self.shape[1] - 1
        allowed = f"0 to {last}, or None for the central line"
        index = self.shape[1] // 2 if index is None else index
        chosen = whole("index of a line of the map", index, allowed, at_least=0, at_most=last)
        return Profile(self.heights[:, chosen], self.spacing[0], self.source)

    def crop(self, start: tuple[float, float], size: tuple[float, float]) -> HeightMap:
        """Return a rectangular piece of the map.

        Parameters
        ----------
        start : tuple of float
            Coordinates (x, y) of the first point kept, in m; rounded to the grid.
        size : tuple of float
            Lengths (lx, ly) of the piece in m; rounded to the grid.

        Returns
        -------
        HeightMap
            The piece; its coordinates start from zero again.

        Raises
        ------
        InputError
            If the piece is not inside the map or holds fewer than two points along an axis.
        """
        corner = two("start of a piece of the map", start, "two lengths (x, y) in m")
        sides = two("size of a piece of the map", size, "two lengths (lx, ly) in m")
        piece = tuple(
            _window(f"piece of the map along {'xy'[axis]}", corner[axis], sides[axis], self.spacing[axis], n)
            for axis, n in enumerate(self.shape)
        )
        return replace(self, heights=self.heights[piece])

    def transposed(self) -> HeightMap:
        """Return the map with x and y exchanged, so that the other direction is rolled along."""
        return replace(self, heights=self.heights.T, spacing=self.spacing[::-1])


@dataclass(frozen=True, eq=False, repr=False)
class Profile(Heights):
    """Heights along one line at uniform spacing.

    Parameters
    ----------
    heights : (n,) array_like
        Heights in m, peaks positive; NaN marks a point without a height. Kept as a read-only float64 copy.
    spacing : float
        Distance of neighbouring points in m.
    source : str
        Where the heights came from.
    start : float, optional
        Coordinate of the first point in m, where the source has one.

    Raises
    ------
    InputError
        If the heights are not a 1-D array of at least two real numbers, hold an infinite value or no value at
        all, or if the spacing is not positive and finite.

    Examples
    --------
    >>> from asperity import Profile
    >>> line = Profile([0.0, 2e-6, 1e-6, 3e-6], 1e-3)
    >>> line.size, len(line.levelled().heights)
    (0.004, 4)
    """

    spacing: float
    start: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "heights", _checked_heights(self.heights, 1, self.source))
        allowed = "a finite length above zero, in m"
        object.__setattr__(self, "spacing", real("spacing of the profile", self.spacing, allowed, above=0.0))

    @property
    def shape(self) -> tuple[int]:
        """Number of points (n,)."""
        return (len(self.heights),)

    @property
    def size(self) -> float:
        """Length n dx that the points stand for, in m."""
        return len(self.heights) * self.spacing

    def crop(self, start: float, size: float) -> Profile:
        """Return a piece of the line.

        Parameters
        ----------
        start, size : float
            Coordinate of the first point kept and length of the piece in m; rounded to the grid.

        Returns
        -------
        Profile
            The piece; its coordinates start from zero again.

        Raises
        ------
        InputError
            If the piece is not inside the line or holds fewer than two points.
        """
        piece = _window("piece of the line", start, size, self.spacing, len(self.heights))
        return replace(self, heights=self.heights[piece], start=None)


def _checked_heights(heights: ArrayLike, dimensions: int, source: str) -> Array:
    what = f"heights of {source}" if source else "heights"
    shape = "(nx, ny)" if dimensions == 2 else "(n,)"
    allowed = f"an array {shape} of real numbers, at least two along each axis"
    array = real_array(what, heights, allowed)
    fits = array.ndim == dimensions and min(array.shape, default=0) >= 2
    require(fits, what, f"an array of shape {array.shape}", allowed, "Select one map or one line.")
    finite = "finite heights, NaN where missing"
    require(not np.isinf(array).any(), what, "infinite values", finite, "Mark them as NaN.")
    nothing = "no valid height: every point is missing"
    require(not np.isnan(array).all(), what, nothing, allowed, "Check the measurement.")
    made_here = isinstance(heights, np.ndarray) and not np.may_share_memory(array, heights)
    if not made_here and not _is_fixed(array):
        array = array.copy()
    array.flags.writeable = False
    return array


def _is_fixed(array: Array) -> bool:
    """Whether an array, or most of one that it is a view of, needs no copy, as nobody can write to it."""
    owner = array if array.base is None else array.base
    own = isinstance(owner, np.ndarray) and owner.flags.owndata and 2 * array.size >= owner.size
    return own and not owner.flags.writeable and not array.flags.writeable


def _window(what: str, start: float, size: float, step: float, points: int) -> slice:
    allowed = f"from 0 to {points * step:.6g} m, at least {2 * step:.6g} m long"
    start, size = (real(what, each, f"lengths in m, {allowed}") for each in (start, size))
    first = round(start / step)
    count = round(size / step)
    inside = first >= 0 and count >= 2 and first + count <= points
    require(inside, what, f"{size} m from {start} m", allowed, "Choose a smaller piece inside it.")
    return slice(first, first + count)
