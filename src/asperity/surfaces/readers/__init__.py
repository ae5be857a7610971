"""Reading measured surfaces: the format is found from the first bytes, then from the extension."""

import zipfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from asperity import extensions
from asperity.arguments import require, shown, whole
from asperity.errors import InputError, MissingPointsWarning, percent
from asperity.hdf5 import is_hdf5
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.readers import arrays, guards, iso_25178, matlab, simpack, text
from asperity.surfaces.readers.belief import doubt_depth, judge_sizes
from asperity.surfaces.readers.formats import SurfaceFormat
from asperity.surfaces.readers.headings import is_depth
from asperity.surfaces.readers.hints import Hints, Length, advice, checked_hints, spell
from asperity.surfaces.readers.libraries import CLASSIC, read_apart
from asperity.text_files import refuse_no_table
from asperity.written_numbers import count_of

__all__ = ["SurfaceFormat", "read_all", "read_surface"]

Reader = Callable[[Path, Hints], list[guards.Surface]]

READ_AS_TEXT = {"", ".txt", ".csv", ".tsv", ".dat", ".asc", ".xyz"}
MAY_BE_BINARY = {"", ".dat", ".asc", ".xyz"}
"""Of these, those that instruments also give files of their own."""
ARCHIVES = b"PK", b"\xd0\xcf"
"""What files of instruments may begin with, as files of Office do."""
OWN: dict[str, tuple[str, Reader]] = {
    ".npy": ("npy", arrays.read_npy),
    ".npz": ("npz", arrays.read_npz),
    ".nc": ("netCDF", read_apart("read_netcdf", "netCDF")),
    ".mat": ("MATLAB", matlab.read_mat),
    ".sdf": ("SDF", iso_25178.read_sdf),
    ".x3p": ("X3P", iso_25178.read_x3p),
    ".prw": ("Simpack profile", simpack.read),
    ".prr": ("Simpack profile", simpack.read),
}
TEXT: tuple[str, Reader] = "text", text.read
OTHER: tuple[str, Reader] = "known instrument", read_apart("read_instrument", "known instrument")


def _installed(name: str, format: Any) -> SurfaceFormat:
    """A format that a package beside this one reads."""
    allowed = "an asperity.surfaces.readers.SurfaceFormat"
    require(isinstance(format, SurfaceFormat), f'reader "{name}"', shown(format), allowed)
    assert isinstance(format, SurfaceFormat)
    taken = sorted((OWN.keys() | READ_AS_TEXT) & set(format.extensions))
    remedy = "Say what its files begin with."
    known = bool(format.begins) or not taken
    require(known, f'reader "{name}"', ", ".join(taken), "extensions of its own", remedy)
    return format


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
        Text or CSV, ``.npy``, ``.npz``, ``.mat``, netCDF, SDF (ISO 25178-71), X3P (ISO 25178-72); other
        instrument formats with the extra ``asperity[readers]``.
    array : str, optional
        Name of the array (npz, mat), variable (netCDF) or channel (instrument file), where there are several.
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
    MissingPointsWarning, percent
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
    remedy = advice("index", 0, f"Choose one of 0 to {len(surfaces) - 1}, as in", "Keep one in the file.")
    single = index is not None or len(surfaces) == 1
    require(single, str(path), f"an ensemble of {len(surfaces)} samples", "one sample", remedy)
    return _finished(_chosen(surfaces, index, path), transpose, fill, spikes, lines)[0]


def read_all(
    path: str | Path,
    *,
    index: int | None = None,
    transpose: bool = False,
    fill: bool = False,
    spikes: bool = False,
    lines: bool | None = None,
    **hints: Any,
) -> list[guards.Surface]:
    """Read the line, the map, all maps of an ensemble, or one of them; hints are those of `read_surface`.

    In a 3-D array the sample is the first axis, then x, then y.
    """
    surfaces = _chosen(_read(path, checked_hints(**hints)), index, path)
    return _finished(surfaces, transpose, fill, spikes, lines)


def read_across(path: str | Path) -> guards.Surface:
    """Read the section of a body across its path, a line whose places need not be even.

    Uneven ones are interpolated, see `positions.made_even`. All else is as `read_surface` reads it.
    """
    surfaces = _read(path, Hints(section=True))
    require(len(surfaces) == 1, str(path), f"an ensemble of {len(surfaces)} samples", "one line")
    return _finished(surfaces, False, False, False, None)[0]


def _chosen(surfaces: list[guards.Surface], index: int | None, path: str | Path) -> list[guards.Surface]:
    """The sample of an index, or all where there is none."""
    what = f"index of a sample in {path}"
    last = len(surfaces) - 1
    if index is None:
        return surfaces
    return [surfaces[whole(what, index, f"0 to {last}", at_least=0, at_most=last)]]


def _read(path: str | Path, hints: Hints) -> list[guards.Surface]:
    file = guards.readable_file(path)
    with file.open("rb") as stream:
        head = stream.read(32)
    extension = file.suffix.lower().replace(".nc4", ".nc")
    installed = extensions.taken(extensions.READERS, _installed).values()
    format = next((each for each in installed if each.has(extension, head)), None)
    kind, reader = _own(file, head, extension) if format is None else (format.name, format.surfaces)
    with guards.hostile(file.name, kind):
        surfaces = _read_by(reader, file, hints)
    judge_sizes(surfaces[0], hints)
    source, _, name = surfaces[0].source.partition(":")
    if is_depth(name):
        doubt_depth(source, name)
    return surfaces


def _own(file: Path, head: bytes, extension: str) -> tuple[str, Reader]:
    """What a file that begins so is called, and what reads it, of the formats that this program knows."""
    content = _by_content(file, head)
    if content:
        return OWN[content]
    if extension in OWN:
        named, reader = OWN[extension]
        remedy = "Export it again, or correct the extension."
        is_text = reader is not simpack.read and text.is_numeric(file)
        require(is_text, file.name, f"a file that starts with {head[:8]!r}", f"a {named} file", remedy)
        return TEXT
    as_text = extension in READ_AS_TEXT and (extension not in MAY_BE_BINARY or text.holds_text(file))
    if not as_text and not head.startswith(ARCHIVES):
        refuse_no_table(head, file.name, "a file with heights")
    return TEXT if as_text else OTHER


def _read_by(reader: Reader, file: Path, hints: Hints) -> list[guards.Surface]:
    if reader is not OTHER[1] or not text.is_numeric(file):
        return reader(file, hints)
    try:
        return reader(file, hints)
    except InputError:  # no library knows it: numbers are numbers, whatever the name of their file
        return text.read(file, hints)


def _by_content(file: Path, head: bytes) -> str | None:
    """Extension that a file of this content has by right, of those in `OWN`; None for all others."""
    extension = file.suffix.lower()
    if head[:1].lower() in (b"a", b"b") and head[1:8].upper() in (b"ISO-1.0", b"ISO-2.0", b"BCR-1.0"):
        return ".sdf"
    if head.startswith(b"a") and extension == ".sdf":  # softgauges bear the name of their institute
        return ".sdf"
    if head.startswith(b"\x93NUMPY"):
        return ".npy"
    if head.startswith(matlab.HEAD) or (extension == ".mat" and not text.holds_text(file)):
        return ".mat"
    if extension in ("", ".nc", ".nc4", ".cdf", ".dat") and (head.startswith(CLASSIC) or is_hdf5(file)):
        return ".nc"
    if extension in (".prw", ".prr") and simpack.holds_profile(file):
        return extension
    if not head.startswith(b"PK"):
        return None
    received = "a zip archive without its directory"
    allowed = "an intact archive"
    remedy = "The file is truncated; copy or export it again."
    require(zipfile.is_zipfile(file), file.name, received, allowed, remedy)
    with guards.hostile(file.name, "zip"), guards.archive(file) as opened:
        names = opened.namelist()
    if "main.xml" in names:
        return ".x3p"
    return ".npz" if names and all(name.endswith(".npy") for name in names) else None


def _finished(
    surfaces: list[guards.Surface], transpose: bool, fill: bool, spikes: bool, lines: bool | None
) -> list[guards.Surface]:
    """Take spikes out, turn and fill as it was asked for, and warn of points without a height."""
    of_lines = "Lines of a rail or a wheel have processing of their own."
    of_maps = {"transpose": "Leave it out.", "spikes": of_lines}
    for name, flag in (("transpose", transpose), ("fill", fill), ("spikes", spikes)):
        require(isinstance(flag, bool | np.bool_), name, shown(flag), "True or False")
        for surface in surfaces if flag and name in of_maps else ():
            is_map = isinstance(surface, HeightMap)
            received = f"a line, {surface.source}"
            require(is_map, name, received, "a height map", of_maps[name])
    done: list[Any] = list(surfaces)
    if spikes:
        done = [surface.without_spikes() for surface in done]
    if transpose:
        done = [surface.transposed() for surface in done]
    filled = [surface.filled(lines) for surface in done] if fill else done
    before, missing, ends = (
        sum(int(np.isnan(each.heights).sum()) for each in some) for some in (surfaces, done, filled)
    )
    if missing:
        share = missing / sum(surface.heights.size for surface in surfaces)
        left = "left as NaN, which contact cannot be solved with"
        remedy = f"{spell('fill', True)} interpolates them"
        if fill:
            left = "interpolated from their neighbours"
            remedy = "check the measurement"
        if fill and ends:
            left = f"interpolated along the lines but for {ends} at their ends"
        verb = "has" if missing == 1 else "have"
        what = (
            f"{surfaces[0].source}: {count_of(missing, 'point')} ({percent(share)} of all) {verb} no "
            "height, none should"
        )
        spiky = missing - before
        what += f" ({spiky} of them {'was a spike' if spiky == 1 else 'were spikes'})" * (spiky > 0)
        MissingPointsWarning.warn(f"{what}; {left}; {remedy}")
    return filled
