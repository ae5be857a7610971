"""Textures with their statistics and spectra; the reduced contact: states, filters, pressure at the load."""

from functools import partial

from asperity.schema import Attribute, Entry

SAMPLED = "where there are samples"
RUN_IN = "where the surface was run in"

# --- what is rolled over

_surface, _of_surface = partial(Entry, "surface"), partial(Attribute, "surface")
_mapped = partial(_surface, condition=SAMPLED)
_beside = partial(_surface, condition="where texture lies beside the line")
_measured = partial(_surface, condition="where maps were measured, large enough to be told apart")

MAP_X = _mapped("x", "m", "rolling direction")
MAP_Y = _mapped("y", "m", "across")
SAMPLE_HEIGHTS = _mapped("sample_heights(x, y)", "m", "height of the first sample")
PATH_X = _beside("path_x", "m", "rolling direction")
PATH_Y = _beside("path_y", "m", "across")
PATH_HEIGHTS = _beside("path_heights(path_x, path_y)", "m", "height of the path")
DISTANCE = _surface("distance", "m", "distance along the path")
_LINE = "height along the middle of the path"
LINE = _surface("line(distance)", "m", _LINE)
LINE_UNTOUCHED = _surface("line_untouched(distance)", "m", f"{_LINE} before running-in", RUN_IN)
SURFACE_WAVENUMBER = _surface("surface_wavenumber", "1/m", "wavenumber, cycles per metre")
PSD_SAMPLE = _mapped("psd_sample(surface_wavenumber)", "m3", "PSD of the samples along the path, one-sided")
PSD_PATH = _surface(
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
TILE_VARIATION_EXPECTED = _measured(
    "tile_variation_expected(sample)", "1", "the same of stationary textures, median"
)

STATISTICS = _of_surface("statistics", "JSON", "statistics of the texture: symbol, value, unit, bandwidth, …")
SOURCE = _of_surface("source", "text", "where the texture comes from")
MISSING_SHARE = _of_surface("missing_share", "1", "share of the measured points that had no height")
ACROSS = _of_surface(
    "across", "text", "areal: texture of its own beside the line; lines: laid out between them"
)

# --- the reduced contact

_NO_FILTER = "the samples do not touch in these states, or have no waves of these lengths"
_entry, _attribute = partial(Entry, "contact"), partial(Attribute, "contact")
_sampled = partial(_entry, condition=SAMPLED)

APPROACH = _entry(
    "approach",
    "m",
    "approach from the plane that the nominal patch feels: heights under its flat-punch weight",
)
FORCE = _entry("force(approach)", "N", "contact force, mean of the samples")
FORCE_STD = _sampled("force_std(approach)", "N", "standard deviation of the force between samples")
STIFFNESS = _entry("stiffness(approach)", "N/m", "contact stiffness F/r, mean of the samples")
STIFFNESS_STD = _sampled("stiffness_std(approach)", "N/m", "standard deviation of the stiffness")
TANGENT_STIFFNESS = _sampled("tangent_stiffness(approach)", "N/m", "tangent stiffness dF/dr")
HERTZ_FORCE = _sampled("hertz_force(approach)", "N", "contact force of smooth bodies (Hertz)")
HERTZ_STIFFNESS = _sampled("hertz_stiffness(approach)", "N/m", "F/δ of smooth bodies (Hertz), at δ = r − d₀")
CONTACT_RADIUS = _entry("contact_radius(approach)", "m", "radius of the nominal patch at the mean force")
PX = _sampled("px", "m", "rolling direction, from the middle of the contact")
PY = _sampled("py", "m", "across, from the middle of the contact")
PRESSURE = _sampled("pressure(px, py)", "Pa", "contact pressure at the working load")
GAP = _sampled("gap(px, py)", "m", "gap after deformation at the working load")

WAVENUMBER = _entry("wavenumber", "1/m", "wavenumber, cycles per metre")
FILTER_EXCITED = _sampled("filter_excited(wavenumber)", "1", "1 where the texture excites the contact")
FILTER_SCALE = _sampled(
    "filter_scale(approach)", "1", "k_0/k_t: low-wavenumber over tangent stiffness", missing=_NO_FILTER
)


def _filter(name: str, what: str, condition: str = SAMPLED, attributes: tuple[str, ...] = ()) -> Entry:
    place = f"{name}(approach, wavenumber)"
    return _entry(place, "1", f"contact filter: {what}", condition, _NO_FILTER, attributes)


def _magnitudes(name: str, *conditions: str) -> tuple[Entry, ...]:
    """Entries of a filter as fitted, as estimated and as applied, and of the spread of its fits."""
    magnitudes = {
        "": "fitted magnitude",
        "_raw": "ratio of the spectra, Eq. 2.6",
        "_applied": "magnitude of the taps",
        "_std": "standard deviation between the strips' fits",
    }
    pairs = zip(magnitudes.items(), conditions, strict=True)
    return tuple(_filter(f"{name}{end}", what, condition, ("normalise",)) for (end, what), condition in pairs)


FILTER_SIGNED = _filter("filter_signed", "signed estimate")
FILTER_COHERENCE = _filter(
    "filter_coherence", "share of the force's power that the mean line under the patch explains"
)
FILTER_THEORY = _filter("filter_theory", "sin q/q of the nominal patch")
FILTERS = _magnitudes("filter", "", SAMPLED, "", SAMPLED)
FILTER, FILTER_RAW, FILTER_APPLIED, FILTER_STD = FILTERS
PRINTED_FILTERS = _magnitudes(
    "printed_filter", *["where a law follows the filter as printed beside others"] * 4
)
PRINTED_FILTER, PRINTED_FILTER_RAW, PRINTED_FILTER_APPLIED, PRINTED_FILTER_STD = PRINTED_FILTERS

_passed = partial(_entry, condition=RUN_IN)
_PASS = "(running_in_pass)"
_CONDITION = "(condition)"
RUNNING_IN_PASS = _passed("running_in_pass", "1", "pass of running-in")
RUNNING_IN_LOWERING = _passed(f"running_in_lowering{_PASS}", "m", "largest lowering of a place in the pass")
CONDITION = _passed("condition", "1", "before or after running-in")
TRACK_RMS = _passed(f"track_rms{_CONDITION}", "m", "rms height on the track, as wide as the nominal patch")
TRACK_STIFFNESS = _passed(
    f"track_stiffness{_CONDITION}", "N/m", "dF/dr under the load, elastic, mean of the samples"
)
YIELDED_SHARE = _attribute(
    "yielded_share", "1", "share of the touched area that was lowered in running-in", RUN_IN
)
SHAKEN_DOWN = _attribute(
    "shaken_down", "1", "one where the last pass lowered no place beyond the tolerance, else zero", RUN_IN
)

HERTZ_RADIUS = _attribute("hertz_radius", "m", "semi-axis of Hertz's contact in rolling direction")
HERTZ_RADIUS_ACROSS = _attribute("hertz_radius_across", "m", "semi-axis of Hertz's contact across")
HERTZ_CONSTANT = _attribute("hertz_constant", "N/m^1.5", "K of Hertz's F = K δ^1.5")
WORKING_LOAD = _attribute("working_load", "N", "static load")
WORKING_APPROACH = _attribute("working_approach", "m", "approach under the static load")
WORKING_STIFFNESS = _attribute(
    "working_stiffness", "N/m", "mean contact stiffness under the static load, dF/dr of the mean force"
)
CONTACT_MODULUS = _attribute("contact_modulus", "Pa", "E*, of both bodies")
DATUM = _attribute("datum", "m", "d₀: the state r is the approach plus this")
DATUM_SAMPLES = _attribute("datum_samples", "m", "highest first touch of the samples", SAMPLED)
DATUM_PATH = _attribute("datum_path", "m", "highest first touch of samples and path", SAMPLED)
CONTACT_AREA = _attribute(
    "contact_area",
    "m2",
    "area in contact of the first sample at the load, less what whole cells stand out beyond rims",
    SAMPLED,
)
CONTACT_AREA_RATIO = _attribute(
    "contact_area_ratio",
    "1",
    "cells in contact over those of smooth bodies on the same grid, both counted",
    SAMPLED,
)
ISOLATED_SHARE = _attribute(
    "isolated_share", "1", "share of the load on cells in contact without a neighbour", SAMPLED
)
RIM_CELLS = _attribute(
    "rim_cells",
    "text",
    "cells at the rim of a contact: whole, covered in part, or covered for some laws",
    SAMPLED,
)
RIM_CELLS_CHOSEN = _attribute("rim_cells_chosen", "text", "why they were chosen", "where they were chosen")
RMS_SLOPE = _attribute("rms_slope", "1", "rms slope Sdq of the samples on the grid", SAMPLED)
VALIDITY = _attribute("validity", "JSON", "what bounds the range of the laws: quantity, value, limit, …")
SAMPLES = _attribute("samples", "1", "number of samples", SAMPLED)
POPULATION = _attribute(
    "population",
    "JSON",
    "whether samples and path are one population: question, value, answer, effect on levels in dB",
    SAMPLED,
)
