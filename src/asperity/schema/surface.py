"""What is rolled over: textures, their statistics and spectra."""

from functools import partial

from asperity.schema import Attribute, Entry, contact

_entry, _attribute = partial(Entry, "surface"), partial(Attribute, "surface")
_sampled = partial(_entry, condition=contact.SAMPLED)
_beside = partial(_entry, condition="where texture lies beside the line")
_measured = partial(_entry, condition="where maps were measured, large enough to be told apart")

X = _sampled("x", "m", "rolling direction")
Y = _sampled("y", "m", "across")
SAMPLE_HEIGHTS = _sampled("sample_heights(x, y)", "m", "height of the first sample")
PATH_X = _beside("path_x", "m", "rolling direction")
PATH_Y = _beside("path_y", "m", "across")
PATH_HEIGHTS = _beside("path_heights(path_x, path_y)", "m", "height of the path")
DISTANCE = _entry("distance", "m", "distance along the path")
_LINE = "height along the middle of the path"
LINE = _entry("line(distance)", "m", _LINE)
LINE_UNTOUCHED = _entry("line_untouched(distance)", "m", f"{_LINE} before running-in", contact.RUN_IN)
SURFACE_WAVENUMBER = _entry("surface_wavenumber", "1/m", "wavenumber, cycles per metre")
PSD_SAMPLE = _sampled("psd_sample(surface_wavenumber)", "m3", "PSD of the samples along the path, one-sided")
PSD_PATH = _entry(
    "psd_path(surface_wavenumber)",
    "m3",
    "PSD of the path along it, one-sided",
    missing="the path is shorter than these waves",
)
HOMOGENEITY_P = _measured(
    "homogeneity_p(sample)",
    "1",
    "share of stationary textures whose tiles vary as much as those of a map",
    attributes=("significance",),
)
TILE_VARIATION = _measured(
    "tile_variation(sample)", "1", "coefficient of variation of the tiles' mean squares"
)
_STATIONARY = "the same of stationary textures, median"
TILE_VARIATION_EXPECTED = _measured("tile_variation_expected(sample)", "1", _STATIONARY)

_STATISTICS = "statistics of the texture: symbol, value, unit, bandwidth, …"
STATISTICS = _attribute("statistics", "JSON", _STATISTICS)
SOURCE = _attribute("source", "text", "where the texture comes from")
MISSING_SHARE = _attribute("missing_share", "1", "share of the measured points that had no height")
_ACROSS = "areal: texture of its own beside the line; lines: laid out between them"
ACROSS = _attribute("across", "text", _ACROSS)
