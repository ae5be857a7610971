"""The reduced contact: force and stiffness of its states, filters, pressure at the working load."""

from __future__ import annotations

from functools import partial

from asperity.schema.entry import Attribute, Entry

_entry = partial(Entry, "contact")
_attribute = partial(Attribute, "contact")
_SAMPLES = "where there are samples"
_PRINTED = "where a law follows the filter as printed beside others"
_NO_FILTER = "the samples do not touch in these states, or have no waves of these lengths"
_RUN_IN = "where the surface was run in"
_STATES = ("approach", "wavenumber")

APPROACH = _entry(
    "approach",
    ("approach",),
    "m",
    "approach from the plane that the nominal patch feels: heights under its flat-punch weight",
)
FORCE = _entry("force", ("approach",), "N", "contact force, mean of the samples")
FORCE_STD = _entry(
    "force_std", ("approach",), "N", "standard deviation of the force between samples", _SAMPLES
)
STIFFNESS = _entry("stiffness", ("approach",), "N/m", "contact stiffness F/r, mean of the samples")
STIFFNESS_STD = _entry("stiffness_std", ("approach",), "N/m", "standard deviation of the stiffness", _SAMPLES)
TANGENT_STIFFNESS = _entry("tangent_stiffness", ("approach",), "N/m", "tangent stiffness dF/dr", _SAMPLES)
HERTZ_FORCE = _entry("hertz_force", ("approach",), "N", "contact force of smooth bodies (Hertz)", _SAMPLES)
HERTZ_STIFFNESS = _entry(
    "hertz_stiffness", ("approach",), "N/m", "F/δ of smooth bodies (Hertz), at δ = r − d₀", _SAMPLES
)
CONTACT_RADIUS = _entry("contact_radius", ("approach",), "m", "radius of the nominal patch at the mean force")
PX = _entry("px", ("px",), "m", "rolling direction, from the middle of the contact", _SAMPLES)
PY = _entry("py", ("py",), "m", "across, from the middle of the contact", _SAMPLES)
PRESSURE = _entry("pressure", ("px", "py"), "Pa", "contact pressure at the working load", _SAMPLES)
GAP = _entry("gap", ("px", "py"), "m", "gap after deformation at the working load", _SAMPLES)

WAVENUMBER = _entry("wavenumber", ("wavenumber",), "1/m", "wavenumber, cycles per metre")
FILTER_EXCITED = _entry(
    "filter_excited", ("wavenumber",), "1", "1 where the texture excites the contact", _SAMPLES
)
FILTER_SCALE = _entry(
    "filter_scale",
    ("approach",),
    "1",
    "k_0/k_t: low-wavenumber over tangent stiffness",
    _SAMPLES,
    _NO_FILTER,
)


def _filter(
    name: str, long_name: str, condition: str = "", attributes: tuple[str, ...] = ("normalise",)
) -> Entry:
    return _entry(name, _STATES, "1", f"contact filter: {long_name}", condition, _NO_FILTER, attributes)


FILTER_SIGNED = _filter("filter_signed", "signed estimate", _SAMPLES, ())
FILTER_COHERENCE = _filter(
    "filter_coherence", "share of the force's power that the mean line under the patch explains", _SAMPLES, ()
)
FILTER_THEORY = _filter("filter_theory", "sin q/q of the nominal patch", _SAMPLES, ())

_MAGNITUDES = {
    "": "fitted magnitude",
    "_raw": "ratio of the spectra, Eq. 2.6",
    "_applied": "magnitude of the taps",
    "_std": "standard deviation between the strips' fits",
}
FILTER = _filter("filter", _MAGNITUDES[""])
FILTER_RAW = _filter("filter_raw", _MAGNITUDES["_raw"], _SAMPLES)
FILTER_APPLIED = _filter("filter_applied", _MAGNITUDES["_applied"])
FILTER_STD = _filter("filter_std", _MAGNITUDES["_std"], _SAMPLES)
PRINTED_FILTER = _filter("printed_filter", _MAGNITUDES[""], _PRINTED)
PRINTED_FILTER_RAW = _filter("printed_filter_raw", _MAGNITUDES["_raw"], _PRINTED)
PRINTED_FILTER_APPLIED = _filter("printed_filter_applied", _MAGNITUDES["_applied"], _PRINTED)
PRINTED_FILTER_STD = _filter("printed_filter_std", _MAGNITUDES["_std"], _PRINTED)
FILTERS = (FILTER, FILTER_RAW, FILTER_APPLIED, FILTER_STD)
PRINTED_FILTERS = (PRINTED_FILTER, PRINTED_FILTER_RAW, PRINTED_FILTER_APPLIED, PRINTED_FILTER_STD)

RUNNING_IN_PASS = _entry("running_in_pass", ("running_in_pass",), "1", "pass of running-in", _RUN_IN)
RUNNING_IN_LOWERING = _entry(
    "running_in_lowering", ("running_in_pass",), "m", "largest lowering of a place in the pass", _RUN_IN
)
RUNNING_IN_YIELDING = _entry(
    "running_in_yielding", ("running_in_pass",), "1", "share of the touched area that yields in it", _RUN_IN
)
CONDITION = _entry("condition", ("condition",), "1", "before or after running-in", _RUN_IN)
TRACK_RMS = _entry(
    "track_rms", ("condition",), "m", "rms height on the track, as wide as the nominal patch", _RUN_IN
)
TRACK_SLOPE = _entry("track_slope", ("condition",), "1", "rms slope on the track", _RUN_IN)
TRACK_AREA_RATIO = _entry(
    "track_area_ratio",
    ("condition",),
    "1",
    "area in contact under the load over that of smooth bodies",
    _RUN_IN,
)
TRACK_STIFFNESS = _entry(
    "track_stiffness", ("condition",), "N/m", "dF/dr under the load, elastic, mean of the samples", _RUN_IN
)
YIELDED_SHARE = _attribute(
    "yielded_share", "1", "share of the touched area that was lowered in running-in", _RUN_IN
)
SHAKEN_DOWN = _attribute(
    "shaken_down", "1", "one where the last pass lowered no place beyond the tolerance, else zero", _RUN_IN
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
DATUM_FROM = _attribute("datum_from", "text", "where the datum was taken from", _SAMPLES)
DATUM_SAMPLES = _attribute("datum_samples", "m", "highest first touch of the samples", _SAMPLES)
DATUM_PATH = _attribute("datum_path", "m", "highest first touch of samples and path", _SAMPLES)
CONTACT_AREA = _attribute("contact_area", "m2", "area in contact of the first sample at the load", _SAMPLES)
CONTACT_AREA_RATIO = _attribute(
    "contact_area_ratio", "1", "area in contact over that of smooth bodies on the same grid", _SAMPLES
)
ISOLATED_SHARE = _attribute(
    "isolated_share", "1", "share of the load on cells in contact without a neighbour", _SAMPLES
)
RMS_SLOPE = _attribute("rms_slope", "1", "rms slope Sdq of the samples on the grid", _SAMPLES)
VALIDITY = _attribute("validity", "JSON", "what bounds the range of the laws: quantity, value, limit, …")
SAMPLES = _attribute("samples", "1", "number of samples", _SAMPLES)
POPULATION = _attribute(
    "population",
    "JSON",
    "whether samples and path are one population: question, value, answer, effect on levels in dB",
    _SAMPLES,
)
