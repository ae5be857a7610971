"""Formats that libraries parse, netCDF and those of instruments, in a sandbox: see `asperity.sandbox`."""

import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from asperity.arguments import Array, listed, require, shown
from asperity.errors import InputError, reason
from asperity.hdf5 import check_unpacked, is_hdf5, opened_netcdf, refuse_data_elsewhere
from asperity.sandbox import Answer, sandboxed
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.readers import arrays, guards, positions
from asperity.surfaces.readers.hints import SPELLING, Hints, Spelling, spelled
from asperity.units import factor

PACKAGES = {"read_netcdf": ["h5netcdf"], "read_instrument": ["SurfaceTopography", "h5py"]}
"""What each reader needs; a classic netCDF file xarray instead, which takes longer to load than any file."""
READ = "text, CSV, npy, npz, mat, netCDF, SDF, X3P; instrument files with SurfaceTopography"
"""What is read."""


def read_apart(reader: str, kind: str) -> Callable[[Path, Hints], list[guards.Surface]]:
    """Make a reader of a format that calls a function of this module by its name in a process of its own."""

    def read(path: Path, hints: Hints) -> list[guards.Surface]:
        request = [reader, asdict(hints), asdict(SPELLING.get())]
        packages = ["xarray"] if _head(path) in CLASSIC else PACKAGES[reader]
        described, found = sandboxed(
            surfaces_in, path, request, source=path.name, kind=kind, packages=packages
        )
        return [
            (HeightMap if heights.ndim == 2 else Profile)(heights, spacing, source)
            for (spacing, source), heights in zip(described, found, strict=True)
        ]

    return read


def surfaces_in(path: str, reader: str, hints: dict[str, Any], spelling: dict[str, Any]) -> Answer:
    """Read a file as `read_apart` asks: spacings and sources of surfaces, and their heights."""
    read = {"read_netcdf": read_netcdf, "read_instrument": read_instrument}[reader]
    with spelled(Spelling(**spelling)):
        surfaces = read(Path(path), Hints(**hints))
    return [(each.spacing, each.source) for each in surfaces], [each.heights for each in surfaces]


def read_instrument(path: Path, hints: Hints) -> list[guards.Surface]:
    """Read the channel of an instrument's file that the hints name, or the reader's default one.

    The other hints stand for a unit or a size that the file does not state. SurfaceTopography gives maps with
    the file's x as the first axis, which is kept.
    """
    if is_hdf5(path):
        refuse_data_elsewhere(path, path.name)
    opener = _opener(path)
    try:
        with warnings.catch_warnings(action="ignore"), opener(path) as reader:  # remarks about itself
            return _channel(reader, path, hints)
    except (InputError, MemoryError):
        raise
    except Exception as error:
        received = "a format that SurfaceTopography does not read"
        if type(error).__name__ != "CannotDetectFileFormat":  # which lists all that it tried
            received += f" ({reason(error)})"
        raise InputError(path.name, received, READ, "Export it as one of these.") from error


def _channel(reader: Any, path: Path, hints: Hints) -> list[guards.Surface]:
    channels = {channel.name: channel for channel in reader.channels}
    name = reader.default_channel.name if hints.array is None else hints.array
    allowed = f"one of: {listed(list(channels))}"
    require(name in channels, f"array in {path.name}", shown(name), allowed, "Choose a channel.")
    points = channels[name].nb_grid_pts
    sized = channels[name].physical_sizes is not None
    few = np.prod(points, dtype=float) <= guards.MAX_POINTS
    allowed = f"at most {guards.MAX_POINTS} points"
    require(few, path.name, f"{points} points", allowed, "Crop or split the measurement.")
    sizes = {} if sized or hints.pixel is None else {"physical_sizes": (1.0,) * len(points)}
    return _surfaces(channels[name].topography(**sizes), hints, f"{path.name}:{name}")


def _opener(path: Path) -> Any:
    try:
        from SurfaceTopography import open_topography
    except ImportError:
        received = f"a {path.suffix or 'nameless'} file, which asperity does not read itself"
        allowed = READ
        remedy = 'Install it: pip install "asperity[readers]".'
        raise InputError(path.name, received, allowed, remedy) from None
    return open_topography


def _surfaces(measured: Any, hints: Hints, source: str) -> list[guards.Surface]:
    unit = None if measured.unit is None else factor(measured.unit, "m")
    received = "points at no uniform spacing"
    allowed = "a line, or a uniform map"
    line = np.ndim(measured.heights()) == 1
    require(measured.is_uniform or line, source, received, allowed, "Resample it at a uniform spacing first.")
    if not measured.is_uniform:  # to the library: it asks for equal steps, however they were printed
        x, z = (np.asarray(each, dtype=np.float64) for each in measured.positions_and_heights())
        lengths = hints.heights_in(source, unit)
        heights, step = positions.line(x, z, source)
        step *= hints.lateral_in(source, unit, "um", "Give it, as in", "Export it with its unit.")
        return [Profile(heights * lengths, step, source)]
    heights = np.ma.filled(np.ma.asarray(measured.heights(), dtype=np.float64), np.nan)
    heights = guards.without_marks(heights) * hints.heights_in(source, unit)
    lateral = hints.pixel_unit or unit
    dx, dy = np.broadcast_to(measured.pixel_size, 2)
    stated = None if lateral is None else (float(dx) * lateral, float(dy) * lateral)
    return guards.surfaces_of(heights, hints.spacing_in(source, stated), source)


# --- netCDF-4 through h5netcdf


def read_netcdf(path: Path, hints: Hints) -> list[guards.Surface]:
    """Read the variable of a netCDF file that the hints name (``group/variable`` in a group).

    Without a name it is ``heights`` or the only variable with dimensions that is no coordinate. The dimension
    called ``x`` becomes the first axis of the map, whatever their order in the file; without that name,
    dimensions are taken as (x, y), or (sample, x, y). Spacing is taken from coordinate variables, units from
    the ``units`` attributes; points are put in the order of rising coordinates. The other hints stand for
    what is not stated.
    """
    with _opened(path) as opened:
        variable = _chosen(opened, hints.array, path.name)
        source = f"{path.name}:{variable.name.lstrip('/')}"
        check_unpacked(path, source, variable.shape, np.dtype(variable.dtype).itemsize)
        heights = _decoded(variable, hints.heights_in(source, _unit(variable)), source)
        names = [name.rpartition("/")[2] for name in variable.dimensions]
        within = variable.name.strip("/").rpartition("/")[0]
        group = opened[within] if within else opened
        steps = []
        for axis, name in enumerate(names[-2:], -len(names[-2:])):
            if hints.pixel is None and name in group.variables:
                index, step = _placed(group.variables[name], hints, source, name)
                heights = np.take(heights, np.argsort(index), axis)
                steps.append(step)
        if len(names) > 1 and names[-1].lower() == "x":
            heights = np.swapaxes(heights, -1, -2)
            steps = steps[::-1]
        spacing = (steps[0], steps[-1]) if len(steps) == len(names[-2:]) else None
        return guards.surfaces_of(heights, hints.spacing_in(source, spacing), source)


CLASSIC = (b"CDF\x01", b"CDF\x02", b"CDF\x05")
"""What files of the classic format begin with, of which SciPy reads the first two."""


def _head(path: Path) -> bytes:
    with open(path, "rb") as file:
        return file.read(4)


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    """Open a netCDF file of either kind, as h5netcdf shows one."""
    head = _head(path)
    if head not in CLASSIC:
        with opened_netcdf(path, path.name, phony_dims="access") as opened:
            yield opened
        return
    received = "netCDF of 64-bit data (CDF-5)"
    allowed = "netCDF-4, or classic netCDF (CDF-1, CDF-2)"
    require(head != CLASSIC[2], path.name, received, allowed, "Convert it, as by nccopy -k nc4.")
    import xarray

    with xarray.open_dataset(path, engine="scipy", decode_cf=False) as opened:
        yield _Classic({str(name): _Variable(str(name), each) for name, each in opened.variables.items()})


class _Classic(dict[str, Any]):
    """Variables of a classic file, as h5netcdf shows them."""

    @property
    def variables(self) -> dict[str, Any]:
        """Variables by name."""
        return self

    @property
    def dimensions(self) -> set[str]:
        """Names of the dimensions of all variables."""
        return {name for each in self.values() for name in each.dimensions}


@dataclass(frozen=True)
class _Variable:
    """One of them; numbers of the most significant byte first are turned as they are read."""

    name: str
    held: Any

    def __getattr__(self, name: str) -> Any:
        return getattr(self.held, {"dimensions": "dims"}.get(name, name))

    def __getitem__(self, key: Any) -> Array:
        values = np.asarray(self.held[key].values)
        return values.astype(values.dtype.newbyteorder("="))


def _chosen(opened: Any, name: str | None, source: str) -> Any:
    candidates = [n for n, v in opened.variables.items() if v.ndim and n not in opened.dimensions]
    if name is None:
        name = "heights" if "heights" in candidates else arrays.only_one(candidates, source)
    try:
        variable = opened[name]
    except KeyError:
        variable = None
    is_variable = hasattr(variable, "dimensions") and hasattr(variable, "dtype")
    allowed = f"one of: {listed(candidates)}, or group/variable"
    require(is_variable, f"array in {source}", shown(name), allowed, "Choose one.")
    return variable


def _unit(variable: Any) -> float | None:
    unit = variable.attrs.get("units")
    return factor(unit, "m") if isinstance(unit, str) else None


def _decoded(variable: Any, unit: float, source: str) -> Array:
    """Apply the conventional attributes for missing values, scale and offset."""
    raw = np.asarray(variable[...])
    attributes = variable.attrs
    if str(attributes.get("_Unsigned", "")).lower() == "true" and raw.dtype.kind == "i":
        raw = raw.view(raw.dtype.str.replace("i", "u"))
    missing = _missing(raw, attributes)
    heights = guards.scaled(np.where(missing, np.zeros(1, raw.dtype), raw), 1.0, source)
    heights[missing] = np.nan
    scale = attributes.get("scale_factor", 1.0)
    offset = attributes.get("add_offset", 0.0)
    return (heights * float(np.ravel(scale)[0]) + float(np.ravel(offset)[0])) * unit


FILLED = {"i2": -32767, "i4": -2147483647, "i8": -9223372036854775806, "f4": 9.969209968386869e36,
          "f8": 9.969209968386869e36, "u2": 65535, "u4": 4294967295, "u8": 18446744073709551614}  # fmt: skip
"""What netCDF fills arrays with that were never written, by type; nothing of one byte."""


def _missing(raw: Array, attributes: Any) -> Array:
    """Points without a height, by the conventions of netCDF: what fills, marks, and is out of range.

    All of these are values as they are stored, before scale and offset; what fills by default counts where
    nothing else is said to.
    """
    told = {name: np.atleast_1d(attributes[name]) for name in _RANGES if name in attributes}
    told = {name: values for name, values in told.items() if values.dtype.kind in "iuf"}
    missing = np.zeros(raw.shape, dtype=bool)
    for name in ("_FillValue", "missing_value"):
        if name in told:  # often of another type than the heights
            missing |= np.isin(raw, told[name].astype(raw.dtype))
    if "_FillValue" not in told and (kind := raw.dtype.str[1:]) in FILLED:
        missing |= raw == np.array(FILLED[kind]).astype(raw.dtype)
    low, high = told.get("valid_range", (None, None))
    for least in (low, *told.get("valid_min", ())):
        missing |= np.zeros(1, bool) if least is None else raw < least
    for most in (high, *told.get("valid_max", ())):
        missing |= np.zeros(1, bool) if most is None else raw > most
    return missing


_RANGES = ("_FillValue", "missing_value", "valid_range", "valid_min", "valid_max")


def _placed(coordinate: Any, hints: Hints, source: str, name: str) -> tuple[positions.Index, float]:
    """Places of points along one axis, none left out, and their distance, m."""
    what = f"{name} of {source}"
    unit = hints.lateral_in(what, _unit(coordinate), "um", "Give it, as in", "Add the units attribute.")
    values = np.asarray(coordinate[...], dtype=np.float64)
    index, step = positions.places(values, what)
    require(
        len(values) == index.max() + 1, what, positions.UNEVEN, "a point at each place", positions.RESAMPLE
    )
    return index, step * unit
