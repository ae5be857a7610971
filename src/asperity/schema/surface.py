"""What is rolled over: textures, their statistics and spectra."""

from __future__ import annotations

from functools import partial

from asperity.schema.entry import Attribute, Entry

_entry = partial(Entry, "surface")
_attribute = partial(Attribute, "surface")
_SAMPLES = "where there are samples"
_PATH = "where texture lies beside the line"
_ROUGH = "where the path is rough"
_MAPS = "where maps were measured, large enough to be told apart"

X = _entry("x", ("x",), "m", "rolling direction", _SAMPLES)
Y = _entry("y", ("y",), "m", "across", _SAMPLES)
SAMPLE_HEIGHTS = _entry("sample_heights", ("x", "y"), "m", "height of the first sample", _SAMPLES)
PATH_X = _entry("path_x", ("path_x",), "m", "rolling direction", _PATH)
PATH_Y = _entry("path_y", ("path_y",), "m", "across", _PATH)
PATH_HEIGHTS = _entry("path_heights", ("path_x", "path_y"), "m", "height of the path", _PATH)
DISTANCE = _entry("distance", ("distance",), "m", "distance along the path")
LINE = _entry("line", ("distance",), "m", "height along the middle of the path")
LINE_UNTOUCHED = _entry(
    "line_untouched",
    ("distance",),
    "m",
    "height along the middle of the path before running-in",
    "where the surface was run in",
)
PATH_HEIGHT = _entry("path_height", ("path_height",), "m", "height of the path about its mean", _ROUGH)
PATH_HEIGHT_DENSITY = _entry(
    "path_height_density",
    ("path_height",),
    "1/m",
    "probability density of the heights of the path",
    _ROUGH,
)
SURFACE_WAVENUMBER = _entry(
    "surface_wavenumber", ("surface_wavenumber",), "1/m", "wavenumber, cycles per metre"
)
PSD_SAMPLE = _entry(
    "psd_sample",
    ("surface_wavenumber",),
    "m3",
    "PSD of the samples along the path, one-sided",
    _SAMPLES,
)
PSD_PATH = _entry(
    "psd_path",
    ("surface_wavenumber",),
    "m3",
    "PSD of the path along it, one-sided",
    missing="the path is shorter than these waves",
)
HOMOGENEITY_P = _entry(
    "homogeneity_p",
    ("sample",),
    "1",
    "share of stationary textures whose tiles vary as much as those of a map",
    _MAPS,
    attributes=("significance",),
)
TILE_VARIATION = _entry(
    "tile_variation", ("sample",), "1", "coefficient of variation of the tiles' mean squares", _MAPS
)
TILE_VARIATION_EXPECTED = _entry(
    "tile_variation_expected", ("sample",), "1", "the same of stationary textures, median", _MAPS
)
TILE_RMS = _entry("tile_rms", ("sample", "tile_x", "tile_y"), "m", "rms height of the tiles", _MAPS)

STATISTICS = _attribute("statistics", "JSON", "statistics of the texture: symbol, value, unit, bandwidth, …")
SOURCE = _attribute("source", "text", "where the texture comes from")
MISSING_SHARE = _attribute("missing_share", "1", "share of the measured points that had no height")
ACROSS = _attribute(
    "across", "text", "areal: texture of its own beside the line; lines: laid out between them"
)
