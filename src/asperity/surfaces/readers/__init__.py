"""Reading measured surfaces: the format is found from the first bytes, then from the extension."""

from __future__ import annotations

import warnings
import zipfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeVar

import numpy as np

from asperity.arguments import shown, whole
from asperity.errors import InputError, MissingPointsWarning
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.readers import arrays, sdf, text, x3p
from asperity.surfaces.readers.guards import Hints, Length, Surface, archive, checked_hints, readable_file
from asperity.surfaces.readers.headers import advice, spell
from asperity.surfaces.readers.instruments import read_apart

__all__ = ["read_surface", "read_surfaces"]

S = TypeVar("S", HeightMap, Profile, Surface)
Reader = Callable[[Path, Hints], list[Surface]]

NETCDF = read_apart("netcdf", "netCDF-4")
INSTRUMENTS = read_apart("instruments", "known instrument")
TEXT = {"", ".txt", ".csv", ".tsv", ".dat", ".asc", ".xyz"}
OWN: dict[str, tuple[str, Reader]] = {
    ".npy": ("npy", arrays.read_npy),
    ".npz": ("npz", arrays.read_npz),
    ".nc": ("netCDF-4", NETCDF),
    ".nc4": ("netCDF-4", NETCDF),
    ".sdf": ("SDF", sdf.read),
    ".x3p": ("X3P", x3p.read),
}


def read_surface(
    path: str | Path,
    *,
    array: str | None = None,
    index: int | None = None,
    height_unit: Length | None = None,
    pixel: Length | Sequence[Length] | None = None,
    pixel_unit: Length | None = None,
    decimal: str | None = None,
    transpose: bool = False,
    fill: bool = False,
    spikes: bool = False,
    lines: bool | None = None,
) -> HeightMap | Profile:
    """Read one measured surface or line.

    The first axis of a map is x, the rolling direction. Formats that name their axes (SDF, X3P, netCDF with a
    dimension ``x``, x-y-z text, instrument files) are turned so that the file's x is the first axis, and
    ``spacing[0]`` is the file's increment along x. Formats that do not (npy, npz, text matrices) are taken as
    they lie: their first axis, the rows of a text matrix, is x.

    Parameters
    ----------
    path : str or Path
        Text or CSV, ``.npy``, ``.npz``, netCDF-4, SDF (ISO 25178-71), X3P (ISO 25178-72); other instrument
        formats with the extra ``asperity[readers]``.
    array : str, optional
        Name of the array (npz), variable (netCDF) or channel (instrument file), where there are several.
    index : int, optional
        Which sample, from zero, where the file holds an ensemble (a 3-D array).
    height_unit : str or float, optional
        Unit of the heights, as ``"um"``, or its length in m. Stronger than what the file states.
    pixel : str, float or pair of these, optional
        Distance of neighbouring points, as ``"1.5 um"``, or (dx, dy). Stronger than what the file states.
    pixel_unit : str or float, optional
        Unit of the coordinates in a text file, and of a `pixel` given without one; metres if left out.
    decimal : {".", ","}, optional
        Decimal mark of a text file, where it is ambiguous.
    transpose : bool
        Exchange x and y, so that the file's other direction is rolled along.
    fill : bool
        Interpolate missing points, see `HeightMap.filled`. They are reported in any case.
    spikes : bool
        Take spikes for points without a height, before those are filled: see `HeightMap.without_spikes`.
    lines : bool, optional
        Whether an array of two dimensions holds lines measured side by side, which are filled along
        themselves and not at their ends; by default its shape tells.

    Returns
    -------
    HeightMap or Profile
        Heights and spacing in m; NaN where a point is missing.

    Raises
    ------
    InputError
        If the file cannot be read, is damaged or hostile, or does not state a unit or pixel size that was not
        given either.

    Warns
    -----
    MissingPointsWarning
        If points have no height.

    Examples
    --------
    >>> import numpy as np
    >>> from asperity import read_surface
    >>> np.save("map.npy", np.random.default_rng(1).normal(size=(40, 30)))
    >>> surface = read_surface("map.npy", height_unit="um", pixel="1.5 um")
    >>> surface.shape, surface.spacing
    ((40, 30), (1.5e-06, 1.5e-06))
    """
    surfaces = _read(path, checked_hints(array, height_unit, pixel, pixel_unit, decimal))
    allowed = f"0 to {len(surfaces) - 1}"
    if index is None and len(surfaces) > 1:
        received = f"an ensemble of {len(surfaces)} samples"
        remedy = advice("index", 0, f"Choose one of {allowed}, as in", "Keep one in the file.")
        raise InputError(str(path), received, "one sample", remedy)
    what = f"index of a sample in {path}"
    chosen = 0 if index is None else whole(what, index, allowed, at_least=0, at_most=len(surfaces) - 1)
    return _finished([surfaces[chosen]], transpose, fill, spikes, lines)[0]


def read_surfaces(
    path: str | Path,
    *,
    array: str | None = None,
    height_unit: Length | None = None,
    pixel: Length | Sequence[Length] | None = None,
    pixel_unit: Length | None = None,
    decimal: str | None = None,
    transpose: bool = False,
    fill: bool = False,
    spikes: bool = False,
) -> list[HeightMap]:
    """Read all samples of an ensemble of maps, as `read_surface` does: a list, of one for a single map.

    In a 3-D array the sample is the first axis, then x, then y. A line is refused.
    """
    surfaces = _read(path, checked_hints(array, height_unit, pixel, pixel_unit, decimal))
    maps = [surface for surface in surfaces if isinstance(surface, HeightMap)]
    if len(maps) < len(surfaces):
        raise InputError(str(path), "a line", "a height map", "Read it with read_surface, or give a map.")
    return _finished(maps, transpose, fill, spikes)


def _read(path: str | Path, hints: Hints) -> list[Surface]:
    file = readable_file(path)
    return _reader(file)(file, hints)


def _reader(file: Path) -> Reader:
    extension = file.suffix.lower()
    with file.open("rb") as stream:
        head = stream.read(16)
    found = _by_content(file, head)
    if extension in OWN:
        kind, reader = OWN[extension]
        if found is not reader:
            received = f"a file that starts with {head[:8]!r}"
            raise InputError(
                file.name, received, f"a {kind} file", "Export it again, or correct the extension."
            )
        return reader
    if found is not None:
        return found
    return text.read if extension in TEXT else INSTRUMENTS


def _by_content(file: Path, head: bytes) -> Reader | None:
    if head.startswith((b"aISO-1.0", b"bISO-1.0", b"aBCR-1.0", b"bBCR-1.0")):
        return sdf.read
    if head.startswith(b"a") and file.suffix.lower() == ".sdf":  # softgauges bear the name of their institute
        return sdf.read
    if head.startswith(b"\x93NUMPY"):
        return arrays.read_npy
    if head.startswith(b"\x89HDF") and file.suffix.lower() in ("", ".nc", ".nc4"):
        return NETCDF
    if head.startswith(b"PK"):
        return _by_members(file)
    return None


def _by_members(file: Path) -> Reader | None:
    if not zipfile.is_zipfile(file):
        remedy = "The file is truncated; copy or export it again."
        raise InputError(file.name, "a zip archive without its directory", "an intact archive", remedy)
    with archive(file) as opened:
        names = opened.namelist()
    if "main.xml" in names:
        return x3p.read
    if names and all(name.endswith(".npy") for name in names):
        return arrays.read_npz
    return None


def _finished(
    surfaces: list[S], transpose: bool, fill: bool, spikes: bool, lines: bool | None = None
) -> list[S]:
    for name, flag in (("transpose", transpose), ("fill", fill), ("spikes", spikes)):
        if not isinstance(flag, bool | np.bool_):
            raise InputError(name, shown(flag), "True or False")
    read = surfaces
    if spikes:
        surfaces = [_without_spikes(surface) for surface in surfaces]
    if transpose:
        surfaces = [_transposed(surface) for surface in surfaces]
    filled = [_filled(surface, lines) for surface in surfaces] if fill else surfaces
    _report_missing(read, surfaces, filled)
    return filled


def _without_spikes(surface: S) -> S:
    if isinstance(surface, Profile):
        remedy = "Lines of a rail or a wheel have processing of their own."
        raise InputError("spikes", f"a line, {surface.source}", "a height map", remedy)
    return surface.without_spikes()


def _filled(surface: S, lines: bool | None) -> S:
    return surface.filled() if isinstance(surface, Profile) else surface.filled(lines)


def _transposed(surface: S) -> S:
    if isinstance(surface, Profile):
        raise InputError("transpose", f"a line, {surface.source}", "a height map", "Leave it out.")
    return surface.transposed()


def _missing_points(surfaces: Sequence[Surface]) -> int:
    return sum(int(np.isnan(surface.heights).sum()) for surface in surfaces)


def _report_missing(read: Sequence[Surface], surfaces: Sequence[Surface], filled: Sequence[Surface]) -> None:
    """Warn of points without a height in what was read, of those that its spikes leave, and of the filled."""
    missing = _missing_points(surfaces)
    if not missing:
        return
    spikes = missing - _missing_points(read)
    share = missing / sum(surface.heights.size for surface in surfaces)
    left = "left as NaN, which contact cannot be solved with"
    remedy = f"{spell('fill', True)} interpolates them"
    if filled is not surfaces:
        left, remedy = "interpolated from their neighbours", "check the measurement"
        if ends := _missing_points(filled):
            left = f"interpolated along the lines but for {ends} at their ends"
    what = f"{read[0].source}: {missing} points ({100 * share:.3g} % of all) have no height, none should"
    what += f" ({spikes} of them were spikes)" * bool(spikes)
    message = f"{what}; {left}; {remedy}"
    warnings.warn(message, MissingPointsWarning, stacklevel=4)
