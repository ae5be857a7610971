"""Measured or synthesised surfaces and lines: heights on a uniform grid, in metres, peaks positive."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity.arguments import Array, real, two, two_lengths, whole
from asperity.errors import InputError


@dataclass(frozen=True, eq=False)
class HeightMap:
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

    heights: Array
    spacing: tuple[float, float]
    source: str = ""

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
    def x(self) -> Array:
        """Coordinates (nx,) along the rolling direction in m, from zero."""
        return np.arange(self.shape[0], dtype=np.float64) * self.spacing[0]

    @property
    def y(self) -> Array:
        """Coordinates (ny,) across the rolling direction in m, from zero."""
        return np.arange(self.shape[1], dtype=np.float64) * self.spacing[1]

    @property
    def missing_share(self) -> float:
        """Share of the points without a height, 0 to 1."""
        return float(np.isnan(self.heights).mean())

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

    def _repr_html_(self) -> str:
        from asperity.surfaces.surface_view import surface_view

        return surface_view(self)

    def levelled(self, degree: int | str = "plane") -> HeightMap:
        """Return the map less its least-squares polynomial form.

        Parameters
        ----------
        degree : str or int
            ``"plane"`` or ``"quadratic"``, as in a case, or the total degree of the polynomial in x and y: 1,
            2, or 0, which removes the mean.

        Returns
        -------
        HeightMap
            See `asperity.surfaces.levelling.level`.
        """
        from asperity.surfaces.levelling import level

        return level(self, degree)

    def filled(self, lines: bool | None = None) -> HeightMap:
        """Return the map with its missing points interpolated from their neighbours.

        Parameters
        ----------
        lines : bool, optional
            Whether the array holds lines measured side by side, which are filled along themselves; by default
            its shape tells.

        Returns
        -------
        HeightMap
            See `asperity.surfaces.levelling.fill`.
        """
        from asperity.surfaces.levelling import fill

        return fill(self, lines)

    def without_spikes(self) -> HeightMap:
        """Return the map with its spikes as points without a height.

        Returns
        -------
        HeightMap
            See `asperity.surfaces.spikes.spikes`; `filled` interpolates the points.
        """
        from asperity.surfaces.spikes import without_spikes

        return without_spikes(self)

    def band_limited(self, longest: float | None = None, shortest: float | None = None) -> HeightMap:
        """Return the map with only the wavelengths between two limits.

        Parameters
        ----------
        longest, shortest : float, optional
            Limits in m; a limit left out does not act.

        Returns
        -------
        HeightMap
            See `asperity.surfaces.levelling.band_limit`.
        """
        from asperity.surfaces.levelling import band_limit

        return band_limit(self, longest=longest, shortest=shortest)

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
        ny = self.shape[1]
        allowed = f"0 to {ny - 1}, or None for the central line"
        what = "index of a line of the map"
        chosen = ny // 2 if index is None else whole(what, index, allowed, at_least=0, at_most=ny - 1)
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
        first = two("start of a piece of the map", start, "two lengths (x, y) in m")
        lengths = two("size of a piece of the map", size, "two lengths (lx, ly) in m")
        kept = tuple(
            _window(f"piece of the map along {axis}", s, length, step, n)
            for axis, s, length, step, n in zip("xy", first, lengths, self.spacing, self.shape, strict=True)
        )
        return replace(self, heights=self.heights[kept])

    def transposed(self) -> HeightMap:
        """Return the map with x and y exchanged, so that the other direction is rolled along."""
        return replace(self, heights=self.heights.T, spacing=self.spacing[::-1])


@dataclass(frozen=True, eq=False)
class Profile:
    """Heights along one line at uniform spacing.

    Parameters
    ----------
    heights : (n,) array_like
        Heights in m, peaks positive; NaN marks a point without a height. Kept as a read-only float64 copy.
    spacing : float
        Distance of neighbouring points in m.
    source : str
        Where the heights came from.

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

    heights: Array
    spacing: float
    source: str = ""

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

    @property
    def x(self) -> Array:
        """Coordinates (n,) in m, from zero."""
        return np.arange(len(self.heights), dtype=np.float64) * self.spacing

    @property
    def missing_share(self) -> float:
        """Share of the points without a height, 0 to 1."""
        return float(np.isnan(self.heights).mean())

    def _repr_html_(self) -> str:
        from asperity.surfaces.surface_view import surface_view

        return surface_view(self)

    def levelled(self, degree: int | str = "plane") -> Profile:
        """Return the line less its least-squares polynomial of the given degree.

        Parameters
        ----------
        degree : str or int
            ``"plane"`` for the mean line or ``"quadratic"``, as in a case, or the degree: 1, 2, or 0, which
            removes the mean.

        Returns
        -------
        Profile
            See `asperity.surfaces.levelling.level`.
        """
        from asperity.surfaces.levelling import level

        return level(self, degree)

    def filled(self) -> Profile:
        """Return the line with its missing points interpolated from their neighbours.

        Returns
        -------
        Profile
            See `asperity.surfaces.levelling.fill`.
        """
        from asperity.surfaces.levelling import fill

        return fill(self)

    def band_limited(self, longest: float | None = None, shortest: float | None = None) -> Profile:
        """Return the line with only the wavelengths between two limits.

        Parameters
        ----------
        longest, shortest : float, optional
            Limits in m; a limit left out does not act.

        Returns
        -------
        Profile
            See `asperity.surfaces.levelling.band_limit`.
        """
        from asperity.surfaces.levelling import band_limit

        return band_limit(self, longest=longest, shortest=shortest)

    def crop(self, start: float, size: float) -> Self:
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
        kept = _window("piece of the line", start, size, self.spacing, len(self.heights))
        return replace(self, heights=self.heights[kept])


def _checked_heights(heights: ArrayLike, dimensions: int, source: str) -> Array:
    what = f"heights of {source}" if source else "heights"
    shape = "(nx, ny)" if dimensions == 2 else "(n,)"
    allowed = f"an array {shape} of real numbers, at least two along each axis"
    try:
        array = np.asanyarray(heights)
    except ValueError:  # ragged lists
        raise InputError(what, "rows of unequal length", allowed, "Mark missing points with NaN.") from None
    if array.dtype.kind not in "fiu":
        raise InputError(what, f"data of type {array.dtype}", allowed, "Convert them to numbers.")
    if array.ndim != dimensions or min(array.shape, default=0) < 2:
        raise InputError(what, f"an array of shape {array.shape}", allowed, "Select one map or one line.")
    array = _frozen_copy(array)
    if np.isinf(array).any():
        raise InputError(what, "infinite values", "finite heights, NaN where missing", "Mark them as NaN.")
    if np.isnan(array).all():
        raise InputError(what, "no valid height: every point is missing", allowed, "Check the measurement.")
    return array


def _frozen_copy(array: NDArray[Any]) -> Array:
    if isinstance(array, np.ma.MaskedArray):
        array = np.ma.filled(array.astype(np.float64), np.nan)
    immutable = array.dtype == np.float64 and array.flags.owndata and not array.flags.writeable
    if not immutable:  # an array that nobody can write to needs no copy
        array = np.array(array, dtype=np.float64, order="C")
        array.flags.writeable = False
    return array


def _window(what: str, start: float, size: float, step: float, points: int) -> slice:
    allowed = f"from 0 to {points * step:.6g} m, at least {2 * step:.6g} m long"
    start, size = (real(what, each, f"lengths in m, {allowed}") for each in (start, size))
    received = f"{size} m from {start} m"
    first, count = round(start / step), round(size / step)
    if first < 0 or count < 2 or first + count > points:
        raise InputError(what, received, allowed, "Choose a smaller piece inside it.")
    return slice(first, first + count)
