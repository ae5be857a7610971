"""The reduced contact: force and stiffness of its states, filters, pressure at the working load."""

from functools import partial

from asperity.schema import Attribute, Entry

SAMPLED = "where there are samples"
_NO_FILTER = "the samples do not touch in these states, or have no waves of these lengths"
_entry, _attribute = partial(Entry, "contact"), partial(Attribute, "contact")
_sampled = partial(_entry, condition=SAMPLED)

_STATE = "approach from the plane that the nominal patch feels: heights under its flat-punch weight"
APPROACH = _entry("approach", "m", _STATE)
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
_SCALE = "k_0/k_t: low-wavenumber over tangent stiffness"
FILTER_SCALE = _sampled("filter_scale(approach)", "1", _SCALE, missing=_NO_FILTER)


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
_COHERENCE = "share of the force's power that the mean line under the patch explains"
FILTER_COHERENCE = _filter("filter_coherence", _COHERENCE)
FILTER_THEORY = _filter("filter_theory", "sin q/q of the nominal patch")
FILTERS = _magnitudes("filter", "", SAMPLED, "", SAMPLED)
FILTER, FILTER_RAW, FILTER_APPLIED, FILTER_STD = FILTERS
PRINTED_FILTERS = _magnitudes(
    "printed_filter", *["where a law follows the filter as printed beside others"] * 4
)
PRINTED_FILTER, PRINTED_FILTER_RAW, PRINTED_FILTER_APPLIED, PRINTED_FILTER_STD = PRINTED_FILTERS

RUN_IN = "where the surface was run in"
_passed = partial(_entry, condition=RUN_IN)
_PASS, _CONDITION = "(running_in_pass)", "(condition)"
RUNNING_IN_PASS = _passed("running_in_pass", "1", "pass of running-in")
RUNNING_IN_LOWERING = _passed(f"running_in_lowering{_PASS}", "m", "largest lowering of a place in the pass")
CONDITION = _passed("condition", "1", "before or after running-in")
TRACK_RMS = _passed(f"track_rms{_CONDITION}", "m", "rms height on the track, as wide as the nominal patch")
_ELASTIC = "dF/dr under the load, elastic, mean of the samples"
TRACK_STIFFNESS = _passed(f"track_stiffness{_CONDITION}", "N/m", _ELASTIC)
_YIELDED = "share of the touched area that was lowered in running-in"
YIELDED_SHARE = _attribute("yielded_share", "1", _YIELDED, RUN_IN)
_SETTLED = "one where the last pass lowered no place beyond the tolerance, else zero"
SHAKEN_DOWN = _attribute("shaken_down", "1", _SETTLED, RUN_IN)

HERTZ_RADIUS = _attribute("hertz_radius", "m", "semi-axis of Hertz's contact in rolling direction")
HERTZ_RADIUS_ACROSS = _attribute("hertz_radius_across", "m", "semi-axis of Hertz's contact across")
HERTZ_CONSTANT = _attribute("hertz_constant", "N/m^1.5", "K of Hertz's F = K δ^1.5")
WORKING_LOAD = _attribute("working_load", "N", "static load")
WORKING_APPROACH = _attribute("working_approach", "m", "approach under the static load")
_WORKING = "mean contact stiffness under the static load, dF/dr of the mean force"
WORKING_STIFFNESS = _attribute("working_stiffness", "N/m", _WORKING)
CONTACT_MODULUS = _attribute("contact_modulus", "Pa", "E*, of both bodies")
DATUM = _attribute("datum", "m", "d₀: the state r is the approach plus this")
DATUM_SAMPLES = _attribute("datum_samples", "m", "highest first touch of the samples", SAMPLED)
DATUM_PATH = _attribute("datum_path", "m", "highest first touch of samples and path", SAMPLED)
CONTACT_AREA = _attribute("contact_area", "m2", "area in contact of the first sample at the load", SAMPLED)
_AREA = "area in contact over that of smooth bodies on the same grid"
CONTACT_AREA_RATIO = _attribute("contact_area_ratio", "1", _AREA, SAMPLED)
_ISOLATED = "share of the load on cells in contact without a neighbour"
ISOLATED_SHARE = _attribute("isolated_share", "1", _ISOLATED, SAMPLED)
RMS_SLOPE = _attribute("rms_slope", "1", "rms slope Sdq of the samples on the grid", SAMPLED)
VALIDITY = _attribute("validity", "JSON", "what bounds the range of the laws: quantity, value, limit, …")
SAMPLES = _attribute("samples", "1", "number of samples", SAMPLED)
_ALIKE = "whether samples and path are one population: question, value, answer, effect on levels in dB"
POPULATION = _attribute("population", "JSON", _ALIKE, SAMPLED)
