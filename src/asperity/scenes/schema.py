"""What the result of a scene may hold beside what all results hold: each with which results have it."""

from __future__ import annotations

from functools import partial

from asperity.schema import Attribute, Entry
from asperity.schema.spectra import BAND_TIME_PRODUCT, NO_SIGNAL

# --- what is rolled over, and what rolls

_SENSED = "where there are accelerometers"
OVER_DISPLACEMENT = Entry(
    "rolling",
    "over_displacement",
    ("law", "time"),
    "m",
    "displacement under the contact of what is rolled over, positive downwards",
    condition="of a kind that calls them nothing else",
)
ROLLING_DISPLACEMENT = Entry(
    "rolling",
    "rolling_displacement",
    ("law", "time"),
    "m",
    "displacement of what rolls, positive downwards",
    condition="of a kind that calls them nothing else",
)

ACCELERATION_REFERENCE = 1e-6
"""Of acceleration levels, m/s²."""
_SENSOR = "position of the accelerometer on what is rolled over"

ROLLING_SENSOR = Entry("rolling", "sensor", ("sensor",), "m", _SENSOR, condition=_SENSED)
ACCELERATION = Entry(
    "rolling",
    "acceleration",
    ("law", "sensor", "time"),
    "m/s2",
    "acceleration of what is rolled over, positive downwards",
    condition=_SENSED,
)
BALL_DISPLACEMENT = Entry(
    "rolling",
    "ball_displacement",
    ("law", "time"),
    "m",
    "displacement of the ball, positive downwards",
    condition="of a ball on a beam",
)
BEAM_DISPLACEMENT = Entry(
    "rolling",
    "beam_displacement",
    ("law", "time"),
    "m",
    "displacement of the beam under the ball, positive downwards",
    condition="of a ball on a beam",
)
ENERGY_TERM = Entry("rolling", "energy_term", ("energy_term",), "1", "term of the energy balance")
ENERGY = Entry("rolling", "energy", ("law", "energy_term"), "J", "energy since the start of the run-in")
ENERGY_RESIDUAL = Entry(
    "rolling",
    "energy_residual",
    ("law",),
    "1",
    "what the energy balance leaves open, relative to the throughput",
)

SPECTRA_SENSOR = Entry("spectra", "sensor", ("sensor",), "m", _SENSOR, condition=_SENSED)
ACCELERATION_PSD = Entry(
    "spectra",
    "acceleration_psd",
    ("law", "sensor", "frequency"),
    "(m/s2)2/Hz",
    "PSD of the acceleration of what is rolled over, one-sided",
    condition=_SENSED,
)
ACCELERATION_LEVEL = Entry(
    "spectra",
    "acceleration_level",
    ("law", "sensor", "band"),
    "dB re 1e-6 m/s2",
    "acceleration level",
    missing=NO_SIGNAL,
    condition=_SENSED,
)


# --- several contacts

_BODIES = "of bodies, one or many"
_CONTACT = "number of the contact, body by body, each from its rearmost; contact_force is that of the first"
_DEGREE = "degree of freedom of a body: what moves, and how"
CONTACT = Entry("rolling", "contact", ("contact",), "1", _CONTACT, condition=_BODIES)
OFFSET = Entry(
    "rolling",
    "offset",
    ("contact",),
    "m",
    "position of a contact ahead of that of the run",
    condition=_BODIES,
)
STATIC_LOAD = Entry(
    "rolling", "static_load", ("contact",), "N", "static force of a contact", condition=_BODIES
)
CONTACT_FORCES = Entry(
    "rolling",
    "contact_forces",
    ("law", "contact", "time"),
    "N",
    "force of each contact, compression positive",
    condition=_BODIES,
)
APPROACHES = Entry(
    "rolling",
    "approaches",
    ("law", "contact", "time"),
    "m",
    "approach of the mean surfaces at each contact, positive closing",
    condition=_BODIES,
)
OVER_DISPLACEMENTS = Entry(
    "rolling",
    "over_displacements",
    ("law", "contact", "time"),
    "m",
    "displacement of what is rolled over at each contact, positive downwards",
    condition=_BODIES,
)
ROLLING_DISPLACEMENTS = Entry(
    "rolling",
    "rolling_displacements",
    ("law", "contact", "time"),
    "m",
    "displacement of what rolls at each contact, positive downwards",
    condition=_BODIES,
)
LOSS_SHARES = Entry(
    "rolling",
    "contact_loss_shares",
    ("law", "contact"),
    "1",
    "share of the time out of each contact",
    condition=_BODIES,
)
DEGREE = Entry("rolling", "degree", ("degree",), "1", _DEGREE, condition=_BODIES)
BODY_DISPLACEMENT = Entry(
    "rolling",
    "body_displacement",
    ("law", "degree", "time"),
    "m",
    "motion of the bodies in their degrees of freedom, positive downwards; of a pitch at the front end, half "
    "the distance of the outermost contacts from the middle",
    condition=_BODIES,
)

SPECTRA_CONTACT = Entry("spectra", "contact", ("contact",), "1", _CONTACT, condition=_BODIES)
FORCE_PSDS = Entry(
    "spectra",
    "contact_force_psds",
    ("law", "contact", "frequency"),
    "N2/Hz",
    "PSD of the force of each contact, one-sided",
    condition=_BODIES,
)
FORCE_LEVELS = Entry(
    "spectra",
    "contact_force_levels",
    ("law", "contact", "band"),
    "dB re 1 N",
    "level of the force of each contact",
    missing=NO_SIGNAL,
    condition=_BODIES,
)
SUM_PSD = Entry(
    "spectra",
    "force_sum_psd",
    ("law", "frequency"),
    "N2/Hz",
    "PSD of the sum of all contact forces, one-sided",
    condition=_BODIES,
)
SPECTRA_DEGREE = Entry("spectra", "degree", ("degree",), "1", _DEGREE, condition=_BODIES)
BODY_ACCELERATION_PSD = Entry(
    "spectra",
    "body_acceleration_psd",
    ("law", "degree", "frequency"),
    "(m/s2)2/Hz",
    "PSD of the acceleration of the bodies in their degrees of freedom, one-sided",
    condition=_BODIES,
)
PASSING_FREQUENCY = Entry(
    "spectra",
    "passing_frequency",
    ("passing_frequency",),
    "Hz",
    "frequency at which contacts at equal distances pass a place, and its multiples",
    condition="contacts at equal distances",
)


# --- over a track

VELOCITY_REFERENCE = 1e-9
"""Of velocity levels, m/s."""

_OVER = "over a track"
_rolling = partial(Entry, "rolling", condition=_OVER)
_track = partial(Entry, "track", condition=_OVER)
_spectra = partial(Entry, "spectra", condition=_OVER)
_track_attribute = partial(Attribute, "track", condition=_OVER)
_POINT = "point on the rail passed by"
_BAND = "one-third-octave band centre"
_LOSSES = "where the track has loss factors"
SILENT = "of this wheel it is not known how its disc and tread vibrate"
_WHEEL = "of a wheel on a rail"
_NOISE = "where the law linear rolled over a roughness"

ROLLING_POINT = _rolling("point", ("point",), "m", _POINT)
RAIL_DISPLACEMENT = _rolling(
    "rail_displacement",
    ("law", "time"),
    "m",
    "displacement of the rail under the wheel, positive downwards",
    condition=_WHEEL,
)
WHEEL_DISPLACEMENT = _rolling(
    "wheel_displacement",
    ("law", "time"),
    "m",
    "displacement of the wheel, positive downwards",
    condition=_WHEEL,
)
POINT_DISPLACEMENT = _rolling(
    "point_displacement",
    ("law", "point", "time"),
    "m",
    "displacement of the rail at a point passed by, positive downwards",
)
POINT_VELOCITY = _rolling(
    "point_velocity",
    ("law", "point", "time"),
    "m/s",
    "velocity of the rail at a point passed by, positive downwards",
)

# --- the track


def _over_frequency(name: str, units: str, long_name: str, missing: str = "") -> Entry:
    return _track(name, ("frequency",), units, long_name, missing=missing)


TRACK_FREQUENCY = _over_frequency("frequency", "Hz", "frequency")
RECEPTANCE_MIDSPAN = _over_frequency("receptance_midspan", "m/N", "receptance of the rail at mid-span")
RECEPTANCE_MIDSPAN_PHASE = _over_frequency("receptance_midspan_phase", "rad", "its phase")
RECEPTANCE_SUPPORT = _over_frequency("receptance_support", "m/N", "receptance of the rail over a sleeper")
RECEPTANCE_SUPPORT_PHASE = _over_frequency("receptance_support_phase", "rad", "its phase")
WHEEL_RECEPTANCE = _over_frequency("wheel_receptance", "m/N", "receptance of the wheel")
CONTACT_RECEPTANCE = _over_frequency(
    "contact_receptance", "m/N", "receptance of the contact spring at the load"
)
DECAY_RATE = _over_frequency("decay_rate", "dB/m", "decay rate, eigenvalue")
DECAY_RATE_EN15461 = _over_frequency("decay_rate_en15461", "dB/m", "decay rate as measured by EN 15461")
DECAY_RATE_LIMIT = _over_frequency(
    "decay_rate_limit",
    "dB/m",
    "lower limit, ISO 3095:2013",
    missing="the standard sets no limit at these frequencies",
)
START_POSITION = _track("start_position", ("start_position",), "m", "place of the impulse, from a sleeper")
LAG = _track("lag", ("lag",), "s", "time since the impulse")
MOVING_KERNEL = _track(
    "moving_kernel", ("start_position", "lag"), "m/(N s)", "displacement of the rail under the wheel"
)
TRACK_BAND = _track("band", ("band",), "Hz", _BAND, condition=_LOSSES)
LAYER = _track("layer", ("layer",), "1", "part of the track with a loss factor", condition=_LOSSES)
LOSS_FACTOR_FORCE_ERROR = _track(
    "loss_factor_force_error",
    ("band",),
    "dB",
    "level of the linear contact force in time over that of constant loss factors",
    condition=_LOSSES,
)
LOSS_FACTOR_RAIL_ERROR = _track(
    "loss_factor_rail_error",
    ("band",),
    "dB",
    "level of the rail's receptance in time over that of constant loss factors",
    condition=_LOSSES,
)
LOSS_FACTOR = _track("loss_factor", ("layer",), "1", "constant loss factor", condition=_LOSSES)
RELAXED_STIFFNESS = _track(
    "relaxed_stiffness", ("layer", "band"), "1", "stiffness in time over the nominal one", condition=_LOSSES
)
RELAXED_LOSS_FACTOR = _track(
    "relaxed_loss_factor", ("layer", "band"), "1", "loss factor in time", condition=_LOSSES
)

NAME = _track_attribute("name", "text", "of the set of parameters")
SLEEPER_SPACING = _track_attribute("sleeper_spacing", "m", "distance of the sleepers")
PINNED_PINNED_FREQUENCY = _track_attribute(
    "pinned_pinned_frequency", "Hz", "at which half a bending wave fits between two sleepers"
)
CUT_ON_FREQUENCY = _track_attribute(
    "cut_on_frequency", "Hz", "above which waves run along the rail on its pads"
)
ANTIRESONANCE_FREQUENCY = _track_attribute(
    "antiresonance_frequency", "Hz", "at which the sleepers hold the rail still"
)
CRITICAL_SPEED = _track_attribute(
    "critical_speed", "m/s", "of the rail with its sleepers on a continuous foundation"
)
STATIC_DEFLECTION = _track_attribute(
    "static_deflection", "m", "of the rail at mid-span under the wheel's load, nominal stiffnesses"
)
STATIC_DEFLECTION_IN_TIME = _track_attribute(
    "static_deflection_in_time", "m", "the same, with what stands for the loss factors in time"
)
KERNEL_METHOD = _track_attribute("kernel_method", "text", "how the rail was carried on: poles or scatter")
KERNEL_POLES = _track_attribute(
    "kernel_poles", "1", "poles of the moving kernel", condition="where poles were used"
)
KERNEL_FIT_ERROR = _track_attribute(
    "kernel_fit_error", "1", "relative error of the poles", condition="where poles were used"
)

# --- spectra


def _product(dim: str, what: str, condition: str = _OVER) -> Entry:
    long_name = BAND_TIME_PRODUCT.long_name.replace("averaging time", f"averaging {what}")
    name = f"{dim}_{what}_product"
    return _spectra(
        name, (dim,), "1", long_name, condition=condition, attributes=BAND_TIME_PRODUCT.attributes
    )


SPECTRA_POINT = _spectra("point", ("point",), "m", _POINT)
TEXTURE_PSD = _spectra("texture_psd", ("frequency",), "m2/Hz", "PSD of the texture passed by, one-sided")
LINEAR_REFERENCE_PSD = _spectra(
    "linear_reference_psd",
    ("frequency",),
    "N2/Hz",
    "PSD of the contact force, linear, by frequency, with constant loss factors",
)
LINEAR_REFERENCE_LEVEL = _spectra(
    "linear_reference_level",
    ("band",),
    "dB re 1 N",
    "contact force level, linear, in the frequency domain",
    missing=NO_SIGNAL,
)
POINT_VELOCITY_PSD = _spectra(
    "point_velocity_psd",
    ("law", "point", "frequency"),
    "(m/s)2/Hz",
    "PSD of the rail's velocity at a point passed by, one-sided",
)
POINT_VELOCITY_LEVEL = _spectra(
    "point_velocity_level",
    ("law", "point", "band"),
    "dB re 1 nm/s",
    "velocity level of the rail at a point passed by",
    missing=NO_SIGNAL,
)
PART = _spectra("part", ("part",), "1", "what bears the texture")
SURFACE_BAND = _spectra("surface_band", ("surface_band",), "m", "wavelength of the one-third octave")
SURFACE_BAND_LENGTH_PRODUCT = _product("surface_band", "length")
ROUGHNESS_LEVEL = _spectra(
    "roughness_level",
    ("part", "surface_band"),
    "dB re 1 um",
    "roughness level of the line rolled over",
    missing="this part has no roughness of these wavelengths",
)
SOURCE = _spectra("source", ("source",), "1", "what radiates", condition=_NOISE)
NOISE_BAND = _spectra("noise_band", ("noise_band",), "Hz", _BAND, condition=_NOISE)
NOISE_BAND_TIME_PRODUCT = _product("noise_band", "time", _NOISE)
SOUND_POWER_LEVEL = _spectra(
    "sound_power_level",
    ("law", "source", "noise_band"),
    "dB re 1 pW",
    "sound power level of rolling",
    condition=_NOISE,
    missing="this source radiates nothing in these bands, or its method does not reach them",
    attributes=("reference",),
)
SOUND_POWER_LEVEL_A = _spectra(
    "sound_power_level_a",
    ("law", "source"),
    "dB(A) re 1 pW",
    "A-weighted sound power level of rolling, over the bands computed",
    condition=_NOISE,
    missing=NO_SIGNAL,
)
CNOSSOS_SOUND_POWER_LEVEL_A = _spectra(
    "cnossos_sound_power_level_a",
    ("source",),
    "dB(A) re 1 pW",
    "A-weighted sound power level by CNOSSOS-EU with its contact filter, over the bands computed",
    condition=_NOISE,
    missing=NO_SIGNAL,
    attributes=("contact_filter",),
)

RADIATOR = _spectra("radiator", ("radiator",), "1", "what radiates by its vibration")
RADIATED_POWER_LEVEL = _spectra(
    "radiated_power_level",
    ("law", "radiator", "band"),
    "dB re 1 pW",
    "sound power level from the vibration itself, of all axles",
    missing=SILENT,
    attributes=("wheel",),
)
RADIATED_POWER_LEVEL_A = _spectra(
    "radiated_power_level_a",
    ("law", "radiator"),
    "dB(A) re 1 pW",
    "A-weighted sound power level from the vibration itself, over the bands computed",
    missing=SILENT,
    attributes=("wheel",),
)
BAND_DECAY_RATE = _spectra(
    "band_decay_rate", ("band",), "dB/m", "decay rate of the rail, of the mean length in the band"
)

SLEEPER_PASSING_FREQUENCY = Attribute(
    "spectra", "sleeper_passing_frequency", "Hz", "speed over the distance of the sleepers", _OVER
)
PINNED_PINNED_LOW = Attribute(
    "spectra",
    "pinned_pinned_low",
    "Hz",
    "pinned–pinned frequency as a moving wheel meets it, the lower",
    _OVER,
)
PINNED_PINNED_HIGH = Attribute("spectra", "pinned_pinned_high", "Hz", "the higher", _OVER)
WHEEL_REVOLUTION_FREQUENCY = Attribute(
    "spectra", "wheel_revolution_frequency", "Hz", "turns of the wheel per second", _OVER
)

# --- the pass-by

_pass_by = partial(Entry, "pass_by", condition=_OVER)
_pass_by_attribute = partial(Attribute, "pass_by", condition=_OVER)
_HEARD = "dB(A) re 20 uPa"
_OF_RADIATOR = ("law", "radiator")
_LENGTH = "where the train has a length: not of one axle without vehicle_length"

PASS_BY_LAW = _pass_by("law", ("law",), "1", "contact law")
PASS_BY_RADIATOR = _pass_by("radiator", ("radiator",), "1", "what radiates by its vibration")
PASS_BY_BAND = _pass_by("band", ("band",), "Hz", _BAND)
PASS_BY_TIME = _pass_by("time", ("time",), "s", "time since the first axle was opposite the receiver")
AXLE = _pass_by("axle", ("axle",), "1", "number of the axle")
AXLE_TIME = _pass_by("axle_time", ("axle",), "s", "time at which it is opposite the receiver")
PASS_BY_LEVEL = _pass_by(
    "pass_by_level",
    (*_OF_RADIATOR, "time"),
    _HEARD,
    "A-weighted sound pressure level beside the track, with time weighting F",
    missing=SILENT,
)
PASS_BY_MAXIMUM_LEVEL = _pass_by(
    "pass_by_maximum_level",
    _OF_RADIATOR,
    _HEARD,
    "L_pAFmax, largest A-weighted sound pressure level with time weighting F",
    missing=SILENT,
)
PASS_BY_EQUIVALENT_LEVEL = _pass_by(
    "pass_by_equivalent_level",
    _OF_RADIATOR,
    _HEARD,
    "L_pAeq,Tp, A-weighted equivalent sound pressure level over the pass-by time",
    condition=_LENGTH,
    missing=SILENT,
)
TRANSIT_EXPOSURE_LEVEL = _pass_by(
    "transit_exposure_level",
    _OF_RADIATOR,
    _HEARD,
    "TEL, A-weighted transit exposure level: all between the points 10 dB down, over the pass-by time",
    condition=_LENGTH,
    missing=SILENT,
)
SOUND_EXPOSURE_LEVEL_A = _pass_by(
    "sound_exposure_level_a",
    _OF_RADIATOR,
    f"{_HEARD} and 1 s",
    "SEL, A-weighted sound exposure level of the whole passage",
    missing=SILENT,
)
SOUND_EXPOSURE_LEVEL = _pass_by(
    "sound_exposure_level",
    (*_OF_RADIATOR, "band"),
    "dB re 20 uPa and 1 s",
    "sound exposure level of the whole passage",
    missing=f"{NO_SIGNAL}; or {SILENT}",
)
RECEIVER_DISTANCE = _pass_by_attribute("receiver_distance", "m", "from the middle of the track")
RECEIVER_HEIGHT = _pass_by_attribute("receiver_height", "m", "above the rail head")
FRONT_TIME = _pass_by_attribute(
    "front_time", "s", "at which the front of the train is opposite: Tp begins", condition=_LENGTH
)
REAR_TIME = _pass_by_attribute("rear_time", "s", "at which its rear is opposite: Tp ends", condition=_LENGTH)

KEPT: dict[Entry, dict[str, str]] = {
    ACCELERATION_LEVEL: {},
    POINT_VELOCITY_LEVEL: {},
    FORCE_LEVELS: {},
    PASS_BY_MAXIMUM_LEVEL: {"radiator": "total"},
    PASS_BY_EQUIVALENT_LEVEL: {"radiator": "total"},
    TRANSIT_EXPOSURE_LEVEL: {"radiator": "total"},
    SOUND_EXPOSURE_LEVEL_A: {"radiator": "total"},
    SOUND_POWER_LEVEL: {},
    SOUND_POWER_LEVEL_A: {"source": "total"},
    RADIATED_POWER_LEVEL: {},
    RADIATED_POWER_LEVEL_A: {},
}
"""What a study keeps of it, where a result has it, and where of it."""
SHOWN = (
    f"{ACCELERATION_LEVEL.name}_a",
    RADIATED_POWER_LEVEL_A.name,
    PASS_BY_MAXIMUM_LEVEL.name,
    TRANSIT_EXPOSURE_LEVEL.name,
)
"""What a study shows of it unasked."""
