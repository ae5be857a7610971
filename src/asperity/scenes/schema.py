"""What the result of a scene may hold beside what all results hold: each with which results have it."""

from functools import partial

from asperity.schema import Attribute, Entry, rolling
from asperity.schema.spectra import BAND_TIME_PRODUCT, NO_SIGNAL

_rolling, _spectra = partial(Entry, "rolling"), partial(Entry, "spectra")

# --- what is rolled over, and what rolls


def _displacement(name: str, of: str, condition: str = "of a kind that calls them nothing else") -> Entry:
    place = f"{name}_displacement(law, contact, time)"
    return _rolling(place, "m", f"displacement of {of}, positive downwards", condition)


OVER_DISPLACEMENT = _displacement("over", "what is rolled over, at the contact")
ROLLING_DISPLACEMENT = _displacement("rolling", "what rolls, at the contact")
BEAM_DISPLACEMENT = _displacement("beam", "the beam under the ball", "of a ball on a beam")
BALL_DISPLACEMENT = _displacement("ball", "the ball", "of a ball on a beam")
RAIL_DISPLACEMENT = _displacement("rail", "the rail under the wheel", "of a wheel on a rail")
WHEEL_DISPLACEMENT = _displacement("wheel", "the wheel", "of a wheel on a rail")

ENERGY_TERM = _rolling("energy_term", "1", "term of the energy balance")
ENERGY = _rolling("energy(law, energy_term)", "J", "energy since the start of the run-in")
_LEFT = "what the energy balance leaves open, relative to the throughput"
ENERGY_RESIDUAL = _rolling("energy_residual(law)", "1", _LEFT)

_DEGREE = "degree of freedom of a body: what moves, and how"
ROLLING_DEGREE, SPECTRA_DEGREE = (each("degree", "1", _DEGREE) for each in (_rolling, _spectra))
BODY_DISPLACEMENT = _rolling(
    "body_displacement(law, degree, time)",
    "m",
    "motion of the bodies in their degrees of freedom, positive downwards; of a pitch at the front end, half "
    "the distance of the outermost contacts from the middle",
)
_BODIES = "PSD of the acceleration of the bodies in their degrees of freedom, one-sided"
BODY_ACCELERATION_PSD = _spectra("body_acceleration_psd(law, degree, frequency)", "(m/s2)2/Hz", _BODIES)
_AT_FASTEST = "; of a speed that changes at the fastest"
PASSING_FREQUENCY = _spectra(
    "passing_frequency",
    "Hz",
    f"frequency at which contacts at equal distances pass a place, and its multiples{_AT_FASTEST}",
    "contacts at equal distances",
)

_AROUND = "where a line around what rolls was measured, of a turn or more"
_round = partial(_spectra, condition=_AROUND)
ORDER = _round("order", "1", "order of what is out of round: waves around what rolls")
ORDER_FREQUENCY = _round(
    "order_frequency(order)", "Hz", f"frequency at which they pass the contact{_AT_FASTEST}"
)
ORDER_LEVEL = _round(
    "order_level(order)",
    "dB re 1 um",
    "level of the rms height of an order",
    missing="no height of this order",
)
RUN_OUT = Attribute("spectra", "run_out", "m", "highest less lowest point around what rolls", _AROUND)

ACCELERATION_REFERENCE = 1e-6
"""Of acceleration levels, m/s²."""
_SENSED, _OVER = "where there are accelerometers", "acceleration of what is rolled over"
_SENSOR = "position of the accelerometer on what is rolled over"
ROLLING_SENSOR, SPECTRA_SENSOR = (each("sensor", "m", _SENSOR, _SENSED) for each in (_rolling, _spectra))
_DOWNWARDS = f"{_OVER}, positive downwards"
ACCELERATION = _rolling("acceleration(law, sensor, time)", "m/s2", _DOWNWARDS, _SENSED)
ACCELERATION_PSD = _spectra(
    "acceleration_psd(law, sensor, frequency)", "(m/s2)2/Hz", f"PSD of the {_OVER}, one-sided", _SENSED
)
ACCELERATION_LEVEL = _spectra(
    "acceleration_level(law, sensor, band)", "dB re 1e-6 m/s2", "acceleration level", _SENSED, NO_SIGNAL
)

# --- the rail of a track

VELOCITY_REFERENCE = 1e-9
"""Of velocity levels, m/s."""
_TRACK = "over a track"
_rail, _rail_spectra = partial(_rolling, condition=_TRACK), partial(_spectra, condition=_TRACK)
_POINT = "point on the rail passed by"
ROLLING_POINT, SPECTRA_POINT = (each("point", "m", _POINT) for each in (_rail, _rail_spectra))
_OF_POINT = "of the rail at a point passed by"
POINT_DISPLACEMENT = _rail(
    "point_displacement(law, point, time)", "m", f"displacement {_OF_POINT}, positive downwards"
)
POINT_VELOCITY = _rail("point_velocity(law, point, time)", "m/s", f"velocity {_OF_POINT}, positive downwards")
POINT_VELOCITY_PSD = _rail_spectra(
    "point_velocity_psd(law, point, frequency)",
    "(m/s)2/Hz",
    "PSD of the rail's velocity at a point passed by, one-sided",
)
POINT_VELOCITY_LEVEL = _rail_spectra(
    "point_velocity_level(law, point, band)", "dB re 1 nm/s", f"velocity level {_OF_POINT}", missing=NO_SIGNAL
)

# --- the track by itself

_track = partial(Entry, "track", condition=_TRACK)
_fact = partial(Attribute, "track", condition=_TRACK)
_losses = partial(Entry, "track", condition="where the track has loss factors")
_BAND = "one-third-octave band centre"

TRACK_FREQUENCY = _track("frequency", "Hz", "frequency")
RECEPTANCE_MIDSPAN = _track("receptance_midspan(frequency)", "m/N", "receptance of the rail at mid-span")
RECEPTANCE_MIDSPAN_PHASE = _track("receptance_midspan_phase(frequency)", "rad", "its phase")
RECEPTANCE_SUPPORT = _track("receptance_support(frequency)", "m/N", "receptance of the rail over a sleeper")
RECEPTANCE_SUPPORT_PHASE = _track("receptance_support_phase(frequency)", "rad", "its phase")
WHEEL_RECEPTANCE = _track("wheel_receptance(frequency)", "m/N", "receptance of the wheel")
_SPRING = "receptance of the contact spring at the load"
CONTACT_RECEPTANCE = _track("contact_receptance(frequency)", "m/N", _SPRING)
DECAY_RATE = _track("decay_rate(frequency)", "dB/m", "decay rate, eigenvalue")
DECAY_RATE_EN15461 = _track("decay_rate_en15461(frequency)", "dB/m", "decay rate as measured by EN 15461")
_LIMIT, _NONE = "lower limit, ISO 3095:2013", "the standard sets no limit at these frequencies"
DECAY_RATE_LIMIT = _track("decay_rate_limit(frequency)", "dB/m", _LIMIT, missing=_NONE)

TRACK_BAND = _losses("band", "Hz", _BAND)
LOSS_FACTOR_FORCE_ERROR = _losses(
    "loss_factor_force_error(band)",
    "dB",
    "level of the linear contact force in time over that of constant loss factors",
)

_bays = partial(Entry, "track", condition="where bays differ")
BAY = _bays("bay", "1", "bay of the cell, the first behind the sleeper at zero")
BAY_LENGTH = _bays("bay_length(bay)", "m", "distance to the next sleeper")
BAY_PAD_STIFFNESS = _bays("bay_pad_stiffness(bay)", "N/m", "stiffness of the pad with which a bay begins")
BAY_BALLAST_STIFFNESS = _bays("bay_ballast_stiffness(bay)", "N/m", "stiffness of the ballast below it")
_MEAN = "receptance of the rail at mid-span, root mean square over all bays"
RECEPTANCE_ALL_BAYS = _bays("receptance_all_bays(frequency)", "m/N", _MEAN)
_EQUAL = "receptance of the rail at mid-span of equal, nominal bays"
RECEPTANCE_EQUAL_BAYS = _bays("receptance_equal_bays(frequency)", "m/N", _EQUAL)

NAME = _fact("name", "text", "of the set of parameters")
SLEEPER_SPACING = _fact("sleeper_spacing", "m", "distance of the sleepers, mean")
_apart = partial(Attribute, "track", condition=f"{_TRACK}, on single supports")
PINNED_PINNED_FREQUENCY = _apart(
    "pinned_pinned_frequency", "Hz", "at which half a bending wave fits between two sleepers"
)
CUT_ON_FREQUENCY = _fact("cut_on_frequency", "Hz", "above which waves run along the rail on its pads")
_HELD = "at which the sleepers hold the rail still"
ANTIRESONANCE_FREQUENCY = Attribute(
    "track", "antiresonance_frequency", "Hz", _HELD, f"{_TRACK}, with sleepers that move"
)
CRITICAL_SPEED = _fact("critical_speed", "m/s", "of the rail with its sleepers on a continuous foundation")
STATIC_DEFLECTION = _fact(
    "static_deflection", "m", "of the rail at mid-span under the wheel's load, nominal stiffnesses"
)
STATIC_DEFLECTION_IN_TIME = _fact(
    "static_deflection_in_time", "m", "the same, with what stands for the loss factors in time"
)

# --- texture, linear reference and noise over a track

_PASSED = "PSD of the texture passed by, one-sided"
TEXTURE_PSD = _rail_spectra("texture_psd(frequency)", "m2/Hz", _PASSED)
LINEAR_REFERENCE_PSD = _rail_spectra(
    "linear_reference_psd(frequency)",
    "N2/Hz",
    "PSD of the contact force, linear, by frequency, with constant loss factors",
)
LINEAR_REFERENCE_LEVEL = _rail_spectra(
    "linear_reference_level(band)",
    "dB re 1 N",
    "contact force level, linear, in the frequency domain",
    missing=NO_SIGNAL,
)
PART = _rail_spectra("part", "1", "what bears the texture")
SURFACE_BAND = _rail_spectra("surface_band", "m", "wavelength of the one-third octave")
_PRODUCT = BAND_TIME_PRODUCT.long_name.replace("averaging time", "averaging length")
SURFACE_BAND_LENGTH_PRODUCT = _rail_spectra(
    "surface_band_length_product(surface_band)", "1", _PRODUCT, attributes=BAND_TIME_PRODUCT.attributes
)
ROUGHNESS_LEVEL = _rail_spectra(
    "roughness_level(part, surface_band)",
    "dB re 1 um",
    "roughness level of the line rolled over",
    missing="this part has no roughness of these wavelengths",
)
STATED_ROUGHNESS_LEVEL = _rail_spectra(
    "stated_roughness_level(part, surface_band)",
    "dB re 1 um",
    "roughness level that the spectrum of the case states, of which the line rolled over is one texture",
    condition=f"{_TRACK}, where a spectrum is named or given",
    missing="no spectrum states the level of this part in these bands",
)

_NOISE = "where a wheel or a rail is rough"
_noise = partial(_spectra, condition=_NOISE)
SOURCE = _noise("source", "1", "what radiates")
NOISE_BAND = _noise("noise_band", "Hz", _BAND)
SOUND_POWER_LEVEL = _noise(
    "sound_power_level(law, source, noise_band)",
    "dB re 1 pW",
    "sound power level of rolling by CNOSSOS-EU",
    missing="this source radiates nothing in these bands, or its method does not reach them",
    attributes=("reference",),
)
SOUND_POWER_LEVEL_A = _noise(
    "sound_power_level_a(law, source)",
    "dB(A) re 1 pW",
    "A-weighted sound power level of rolling by CNOSSOS-EU, over the bands computed",
    missing=NO_SIGNAL,
)
CNOSSOS_SOUND_POWER_LEVEL_A = _noise(
    "cnossos_sound_power_level_a(source)",
    "dB(A) re 1 pW",
    "A-weighted sound power level by CNOSSOS-EU with its contact filter, over the bands computed",
    missing=NO_SIGNAL,
    attributes=("contact_filter",),
)

SILENT = "of this wheel it is not known how its disc and tread vibrate"
STILL = "no sleeper moves on this track"
RADIATOR = _rail_spectra("radiator", "1", "what radiates by its vibration")
_radiated = partial(_rail_spectra, missing=SILENT, attributes=("wheel",))
RADIATED_POWER_LEVEL = _radiated(
    "radiated_power_level(law, radiator, band)",
    "dB re 1 pW",
    "sound power level from the vibration itself, of all axles",
)
RADIATED_POWER_LEVEL_A = _radiated(
    "radiated_power_level_a(law, radiator)",
    "dB(A) re 1 pW",
    "A-weighted sound power level from the vibration itself, over the bands computed",
)
RADIATED_POWER_DEVIATION = _radiated(
    "radiated_power_deviation(law, radiator)",
    "dB",
    "standard deviation of the A-weighted sound power level by the chance of one record",
)

SIDE = "where the contact of a wheel and a rail is off the middle, or the wheel is drawn"
RAIL_SIDEWAYS = "rail sideways"
"""The further radiator of a run in which something moves sideways; the wheel is that under both forces."""
SINGLE_FORCES = "wheel, vertical force alone", "wheel, lateral force alone", "vertical motion alone"
BY_VERTICAL, BY_LATERAL, VERTICAL_MOTION = SINGLE_FORCES
_alone = partial(_spectra, condition=SIDE, missing=SILENT)
SINGLE_FORCE = _alone("single_force", "1", "what would radiate if one force alone acted on the contact")
_POWER = "sound power level of what a single force would make radiate, of all axles"
SINGLE_FORCE_POWER_LEVEL = _alone("single_force_power_level(law, single_force, band)", "dB re 1 pW", _POWER)
SINGLE_FORCE_POWER_LEVEL_A = _alone(
    "single_force_power_level_a(law, single_force)",
    "dB(A) re 1 pW",
    f"A-weighted {_POWER}, over the bands computed",
)
BAND_DECAY_RATE = _rail_spectra(
    "band_decay_rate(band)", "dB/m", "decay rate of the rail, of the mean length in the band"
)

_RINGING = "where it is known how a wheel's disc and tread vibrate"
_mode = partial(_spectra, condition=_RINGING)
WHEEL_MODE = _mode("wheel_mode", "1", "mode of the wheel, by frequency; 0 is its rigid motion")
WHEEL_MODE_FREQUENCY = _mode(
    "wheel_mode_frequency(wheel_mode)", "Hz", "natural frequency of the wheel at rest"
)
WHEEL_MODE_DAMPING = _mode("wheel_mode_damping(wheel_mode)", "1", "damping ratio of a mode of the wheel")
WHEEL_MODE_DIAMETERS = _mode(
    "wheel_mode_diameters(wheel_mode)", "1", "nodal diameters of a mode of the wheel"
)
WHEEL_MODE_POWER_LEVEL_A = _mode(
    "wheel_mode_power_level_a(law, wheel_mode)",
    "dB(A) re 1 pW",
    "A-weighted sound power level of a mode of the wheels of all axles, over the bands computed",
    missing=NO_SIGNAL,
)

_MEASURED = "where something was measured on the track"
_beside = partial(_spectra, condition=_MEASURED, missing="it was not measured in these bands")
MEASURED_DECAY_RATE = _beside("measured_decay_rate(band)", "dB/m", "decay rate, measured")
_LATERAL = "lateral decay rate, measured"
MEASURED_LATERAL_DECAY_RATE = _beside(
    "measured_lateral_decay_rate(band)", "dB/m", _LATERAL, condition=f"{_MEASURED}, laterally"
)
_SIDEWAYS = f"{_MEASURED}, laterally, and something moves sideways"
_EXPECTED = "decay rate that EN 15461 finds on the computed track"
EXPECTED_LATERAL_DECAY_RATE = _beside(
    "expected_lateral_decay_rate(band)", "dB/m", f"lateral {_EXPECTED}", condition=_SIDEWAYS
)
MEASURED_LATERAL_POWER_CHANGE = _beside(
    "measured_lateral_power_change(band)",
    "dB",
    "sound power level of the rail sideways with what was measured over that of the computed track",
    condition=_SIDEWAYS,
)
EXPECTED_DECAY_RATE = _beside("expected_decay_rate(band)", "dB/m", _EXPECTED)
_MOBILITY = "point mobility of the rail at mid-span, rms in the band"
MEASURED_MOBILITY = _beside("measured_mobility(band)", "(m/s)/N", f"{_MOBILITY}, measured")
EXPECTED_MOBILITY = _beside("expected_mobility(band)", "(m/s)/N", f"{_MOBILITY}, of the computed track")
MEASURED_FORCE_CHANGE = _beside(
    "measured_force_change(band)",
    "dB",
    "level of a linear contact force on what was measured over that on the computed track",
)
MEASURED_POWER_CHANGE = _beside(
    "measured_power_change(band)",
    "dB",
    "sound power level of rail and sleepers with what was measured over that of the computed track",
)
_unmeasured = partial(_radiated, condition=_MEASURED)
UNMEASURED_POWER_LEVEL = _unmeasured(
    "unmeasured_power_level(law, radiator, band)",
    "dB re 1 pW",
    "sound power level from vibration of the computed track, of all axles",
)
UNMEASURED_POWER_LEVEL_A = _unmeasured(
    "unmeasured_power_level_a(law, radiator)",
    "dB(A) re 1 pW",
    "A-weighted sound power level from vibration of the computed track, over the bands computed",
)

_tone = partial(Attribute, "spectra", condition=_TRACK)
SLEEPER_PASSING_FREQUENCY = Attribute(
    "spectra",
    "sleeper_passing_frequency",
    "Hz",
    f"speed over the distance of the sleepers{_AT_FASTEST}",
    f"{_TRACK}, on single supports",
)
_split = partial(Attribute, "spectra", condition=f"{_TRACK}, on single supports")
PINNED_PINNED_LOW = _split(
    "pinned_pinned_low", "Hz", "pinned–pinned frequency as a moving wheel meets it, the lower"
)
PINNED_PINNED_HIGH = _split("pinned_pinned_high", "Hz", "the higher")
WHEEL_REVOLUTION_FREQUENCY = _tone("wheel_revolution_frequency", "Hz", "turns of the wheel per second")

# --- the pass-by

_pass_by = partial(Entry, "pass_by", condition=_TRACK)
_heard = partial(_pass_by, missing=SILENT)
_place = partial(Attribute, "pass_by")
_LENGTH = "where the train has a length: not of one axle without vehicle_length"

PASS_BY_LAW = _pass_by("law", "1", "contact law")
PASS_BY_RADIATOR = _pass_by("radiator", "1", "what radiates by its vibration")
PASS_BY_BAND = _pass_by("band", "Hz", _BAND)
PASS_BY_TIME = _pass_by("time", "s", "time since the first axle was opposite the receiver")
AXLE = _pass_by("axle", "1", "number of the axle")
AXLE_TIME = _pass_by("axle_time(axle)", "s", "time at which it is opposite the receiver")
PASS_BY_LEVEL = _heard(
    "pass_by_level(law, radiator, time)",
    "dB(A) re 20 uPa",
    "A-weighted sound pressure level beside the track, with time weighting F",
)
PASS_BY_MAXIMUM_LEVEL = _heard(
    "pass_by_maximum_level(law, radiator)",
    "dB(A) re 20 uPa",
    "L_pAFmax, largest A-weighted sound pressure level with time weighting F",
)
PASS_BY_EQUIVALENT_LEVEL = _heard(
    "pass_by_equivalent_level(law, radiator)",
    "dB(A) re 20 uPa",
    "L_pAeq,Tp, A-weighted equivalent sound pressure level over the pass-by time",
    condition=_LENGTH,
)
TRANSIT_EXPOSURE_LEVEL = _heard(
    "transit_exposure_level(law, radiator)",
    "dB(A) re 20 uPa",
    "TEL, A-weighted transit exposure level: all between the points 10 dB down, over the pass-by time",
    condition=_LENGTH,
)
SOUND_EXPOSURE_LEVEL_A = _heard(
    "sound_exposure_level_a(law, radiator)",
    "dB(A) re 20 uPa and 1 s",
    "SEL, A-weighted sound exposure level of the whole passage",
)
SOUND_EXPOSURE_LEVEL = _pass_by(
    "sound_exposure_level(law, radiator, band)",
    "dB re 20 uPa and 1 s",
    "sound exposure level of the whole passage",
    missing=f"{NO_SIGNAL}; or {SILENT}",
)
RECEIVER_DISTANCE = _place("receiver_distance", "m", "from the middle of the track", _TRACK)
RECEIVER_HEIGHT = _place("receiver_height", "m", "above the rail head", _TRACK)
GROUND = _place("ground", "text", "between track and receiver", _TRACK)
DIRECTIVITY = _place("directivity", "text", "of the sources: even, cnossos, or dipole", _TRACK)
RAIL_DISTANCE = _place("rail_distance", "m", "of both rails as sources; zero: both in the middle", _TRACK)
FAR_RAIL_SCREENING = _place("far_rail_screening", "dB", "of the farther rail", _TRACK)
RECEIVER_OFFSET = _place("receiver_offset", "dB", "that the receiver adds to all levels", _TRACK)
FRONT_TIME = _place("front_time", "s", "at which the front of the train is opposite: Tp begins", _LENGTH)
REAR_TIME = _place("rear_time", "s", "at which its rear is opposite: Tp ends", _LENGTH)

_passage = partial(Attribute, "pass_by", condition="where a passage was measured")
MEASURED_BAND_LEVEL = _pass_by(
    "measured_band_level(band)",
    "dB re 20 uPa",
    "equivalent sound pressure level over the pass-by time, measured",
    condition="where a passage was measured in one-third octaves",
    missing="it was not measured in these bands",
)
MEASURED_MAXIMUM_LEVEL = _passage("measured_maximum_level", "dB(A) re 20 uPa", "L_pAFmax, measured")
MEASURED_EQUIVALENT_LEVEL = _passage("measured_equivalent_level", "dB(A) re 20 uPa", "L_pAeq,Tp, measured")
MEASURED_EXPOSURE_LEVEL = _passage("measured_exposure_level", "dB(A) re 20 uPa", "TEL, measured")

# --- what helps

_effects = partial(Entry, "effects", condition="where it was asked what helps")
_changed = partial(_effects, missing=f"the case cannot take this change; or {SILENT}")
EFFECT_VARIANT = _effects("variant", "1", "what is changed of the case")
EFFECT_RADIATOR = _effects("radiator", "1", "what radiates by its vibration")
_A = RADIATED_POWER_LEVEL_A
_OF_A = "level with the change less that of the case as it is"
EFFECT_LEVEL = _changed("level(radiator)", _A.units, _A.long_name)
EFFECT = _changed("effect(variant, radiator)", "dB", _OF_A)
_CHANCE = "standard deviation of the level by the chance of its records"
EFFECT_LEVEL_DEVIATION = _changed("level_deviation(radiator)", "dB", _CHANCE)
_HALF = "half the 95 % confidence interval of the effect, by its scatter over the seeds"
EFFECT_ERROR = _effects(
    "effect_error(variant, radiator)",
    "dB",
    _HALF,
    missing="it has no effect, or fewer than two seeds that draw anything",
)
LEFT_OUT = _effects("left_out(variant)", "1", "why the change was left out; empty where it was not")
EFFECT_LAW = Attribute("effects", "law", "text", "contact law", EFFECT.condition)
EFFECT_SEEDS = Attribute("effects", "seeds", "1", "over which effects are averaged", EFFECT.condition)

_ASKED = "where noise.vehicle says what passes"
VEHICLE = _place("vehicle", "text", "type of vehicle, by which TSI Noise limits the level", _ASKED)
_LEVEL = "L_pAeq,Tp normalised to the reference speed, of wagons to 0.225 axles/m (TSI Noise)"
NORMALISED_LEVEL = _heard("normalised_level(law, radiator)", "dB(A) re 20 uPa", _LEVEL, condition=_ASKED)
_FAST = f"{_ASKED}, from 250 km/h on, and a limit holds"
NORMALISED_LEVEL_ABOVE = _heard(
    "normalised_level_above(law, radiator)", "dB(A) re 20 uPa", f"{_LEVEL}, 3.5 m high", condition=_FAST
)
REFERENCE_SPEED = _place("reference_speed", "m/s", "to which it is normalised", _ASKED)
_LIMIT = "largest normalised level of all sources, compared as a whole decibel"
TSI_LIMIT = _place("tsi_limit", "dB(A) re 20 uPa", _LIMIT, f"{_ASKED}, and a limit holds")
_ISO = "of a test by TSI Noise and ISO 3095: condition, what is here, what is asked, whether it is met"
REFERENCE_CONDITIONS = _place("reference_conditions", "JSON", _ISO, _ASKED)
# --- what moves sideways

_side = partial(Entry, "sideways", condition=SIDE)
_side_fact = partial(Attribute, "sideways", condition=SIDE)
SIDEWAYS_LAW = _side("law", "1", "contact law")
SIDEWAYS_FREQUENCY = _side("frequency", "Hz", "frequency")
SIDEWAYS_BAND = _side("band", "Hz", _BAND)
_RAIL = "receptance of the rail head at mid-span, sideways per force"
RAIL_LATERAL_RECEPTANCE = _side("rail_lateral_receptance(frequency)", "m/N", f"{_RAIL} sideways")
RAIL_CROSS_RECEPTANCE = _side("rail_cross_receptance(frequency)", "m/N", f"{_RAIL} downwards")
_WHEEL = "receptance of the wheel at the contact, along the axle per force"
WHEEL_LATERAL_RECEPTANCE = _side("wheel_lateral_receptance(frequency)", "m/N", f"{_WHEEL} along it")
WHEEL_CROSS_RECEPTANCE = _side("wheel_cross_receptance(frequency)", "m/N", f"{_WHEEL} downwards")
LATERAL_DECAY_RATE = _side(
    "lateral_decay_rate(frequency)", "dB/m", "decay rate of the rail sideways, eigenvalue"
)
_FORCE = "lateral contact force in stick, mean of the contacts"
LATERAL_FORCE_PSD = _spectra(
    "lateral_force_psd(law, frequency)", "N2/Hz", f"PSD of the {_FORCE}, one-sided", SIDE
)
LATERAL_FORCE_LEVEL = _side(
    "lateral_force_level(law, band)", "dB re 1 N", f"level of the {_FORCE}", missing=NO_SIGNAL
)
VERTICAL_FORCE_CHANGE = _side(
    "vertical_force_change(band)",
    "dB",
    "level of the linear vertical force with the lateral one over that without, which runs leave out",
)
_SLIP = (
    "share of the time in which the lateral force would be beyond friction, of a normal distribution, mean "
    "of the contacts"
)
SLIP_SHARE = _side("slip_share(law)", "1", _SLIP)
LATERAL_FORCE_SPREAD = _side("lateral_force_rms(law)", "N", f"rms of the {_FORCE}")
SIDEWAYS_CONTACT = _side("contact", "1", rolling.CONTACTS)
_EACH = "rms of the lateral force of each contact, in stick"
LATERAL_CONTACT_SPREAD = _side("lateral_contact_force_rms(law, contact)", "N", _EACH)
_PLACE = "of the contact across the {}, from its middle, positive towards the field side"
CONTACT_PLACE = _side_fact("contact_place", "m", _PLACE.format("tread"))
RAIL_CONTACT_PLACE = _side_fact("rail_contact_place", "m", _PLACE.format("rail head"))
STICK_STIFFNESS = _side_fact("stick_stiffness", "N/m", "lateral stiffness of the contact in stick, Mindlin")
SLIP_FORCE = _side_fact("slip_force", "N", "coefficient of friction times the static load")

# --- creep and friction

CREEPS = "where [creep] gives a creepage"
CREEPS_OR_RUBS = f"{CREEPS}, or a ball bearing has friction"
_creep, _creep_fact = (
    partial(Entry, "creep", condition=CREEPS),
    partial(Attribute, "creep", condition=CREEPS),
)
_creeping, _rubbing = (partial(_rolling, condition=each) for each in (CREEPS, CREEPS_OR_RUBS))
_rubbed = partial(_creep, condition=CREEPS_OR_RUBS)
WAYS = "along", "to the field side"
WAYS_OFF_TRACK = "along", "across"
_WAY = "direction of a force on what rolls"
_ON_ROLLING = "friction force on what rolls"
_HEAT = "heat of friction"
ROLLING_WAY, CREEP_WAY = (each("way", "1", _WAY) for each in (_creeping, _rubbed))
FRICTION_FORCE = _creeping("friction_force(law, contact, way, time)", "N", f"{_ON_ROLLING}, quasi-steady")
FRICTION_POWER = _rubbing("friction_power(law, contact, time)", "W", f"{_HEAT}, quasi-steady")
FULL_SLIP_SHARE = _creeping("full_slip_share(law)", "1", "share of the time in full slip, of all contacts")
MEAN_FRICTION_POWER = _rubbing("mean_friction_power(law)", "W", f"{_HEAT}, mean over time and contacts")
_WEARS = f"{CREEPS}, and wear"
_worn = partial(_rolling, condition=_WEARS)
WORN_AREA = _worn("worn_area(law)", "m2", "area of the section that one passage of all contacts takes, mean")
WEAR_DEPTH = _worn("wear_depth(law)", "m", "the same over the width of the smooth contact: its mean depth")
FRICTION_SAMPLE = _rubbed(
    "sample",
    "1",
    "contact under the working load: 0 of smooth bodies, then samples; of a ball "
    "bearing the most loaded ones, 0 of the inner ring, 1 of the outer one",
)
STICK_AREA, SLIP_AREA = (_rubbed(f"{w}_area(sample)", "m2", f"area that {w}s") for w in ("stick", "slip"))
SAMPLE_FRICTION = _rubbed("friction_force(sample, way)", "N", _ON_ROLLING)
SPIN_MOMENT = _rubbed("spin_moment(sample)", "N m", "moment of friction on what rolls about the normal")
SAMPLE_HEAT = _rubbed("friction_power(sample)", "W", _HEAT)
CREEP_X = _rubbed("x", "m", "place along the contact, from the middle of its window")
CREEP_Y = _rubbed("y", "m", "place across it; of a wheel to the field side")
TRACTION = _rubbed(
    "traction(x, y)",
    "Pa",
    "tangential traction of the first sample, or of smooth bodies; in a bearing where most heat is",
)
SLIP_VELOCITY = _rubbed(
    "slip_velocity(x, y)",
    "m/s",
    "slip velocity of the first sample, or of smooth bodies; in a bearing where most heat is",
)
CREEPAGE = _creep_fact("creepage", "JSON", "of what rolls: along, to the field side, spin in rad/m")
FULL_SLIP_SCALE = _creep_fact("full_slip_scale", "1", "part of the creepages from which on all slips")
FULL_SLIP_LOAD = _creep_fact("full_slip_load", "N", "load up to which all slips; infinite if that is any")

_SQUEALS = f"{CREEPS}, and the axial modes of its wheel are known"
_squeal = partial(_creep, condition=_SQUEALS, missing="this motion is damped too much to be found")
SQUEAL_MODE = _squeal("squeal_mode", "1", "free motion of the wheel on the rail, one for each of its modes")
SQUEAL_FREQUENCY = _squeal("squeal_frequency(squeal_mode)", "Hz", "frequency, as the contact feels it")
GROWTH_RATE = _squeal("growth_rate(squeal_mode)", "1/s", "growth of the amplitude, negative in decay")
SQUEAL_DIAMETERS = _squeal("squeal_diameters(squeal_mode)", "1", "nodal diameters of what rings most")
SQUEAL_SHAPE = _squeal(
    "squeal_shape(squeal_mode)", "1", "number of what rings most at rest: as it turns, it is two waves"
)
AXIAL_SHARE = _squeal("axial_share(squeal_mode)", "1", "axial part of its squared motion at the contact")
CREEP_DAMPING = _creep_fact(
    "creep_damping", "N s/m", "−∂F_y/∂η/V; negative: friction falls", condition=_SQUEALS
)
LOAD_SLOPE = _creep_fact("friction_per_load", "1", "slope of the lateral force over load", condition=_SQUEALS)
LARGEST_GROWTH = _creep_fact(
    "largest_growth_rate", "1/s", "growth rate of the fastest motion, whatever it is", condition=_SQUEALS
)
SQUEAL_GROWTH = _creep_fact(
    "squeal_growth_rate",
    "1/s",
    "growth rate of the fastest motion with two and more nodal diameters; squeal above zero",
    condition=_SQUEALS,
)


_TOTAL = {"radiator": "total"}
KEPT: dict[Entry, dict[str, str]] = {
    ACCELERATION_LEVEL: {},
    POINT_VELOCITY_LEVEL: {},
    PASS_BY_MAXIMUM_LEVEL: _TOTAL,
    PASS_BY_EQUIVALENT_LEVEL: _TOTAL,
    TRANSIT_EXPOSURE_LEVEL: _TOTAL,
    SOUND_EXPOSURE_LEVEL: _TOTAL,
    SOUND_EXPOSURE_LEVEL_A: _TOTAL,
    NORMALISED_LEVEL: _TOTAL,
    SOUND_POWER_LEVEL: {},
    SOUND_POWER_LEVEL_A: {"source": "total"},
    RADIATED_POWER_LEVEL: {},
    RADIATED_POWER_LEVEL_A: {},
    RADIATED_POWER_DEVIATION: {},
    FULL_SLIP_SHARE: {},
    MEAN_FRICTION_POWER: {},
    WEAR_DEPTH: {},
}
"""What a study keeps of it, where a result has it, and where of it."""
TOTALS = (
    RADIATED_POWER_LEVEL_A,
    SOUND_EXPOSURE_LEVEL_A,
    PASS_BY_MAXIMUM_LEVEL,
    PASS_BY_EQUIVALENT_LEVEL,
    TRANSIT_EXPOSURE_LEVEL,
    NORMALISED_LEVEL,
)
"""Single numbers of what is heard of it: totals, the first with its parts."""
SHOWN = (
    f"{ACCELERATION_LEVEL.name}_a",
    RADIATED_POWER_LEVEL_A.name,
    PASS_BY_MAXIMUM_LEVEL.name,
    TRANSIT_EXPOSURE_LEVEL.name,
    FULL_SLIP_SHARE.name,
    MEAN_FRICTION_POWER.name,
    WEAR_DEPTH.name,
    SQUEAL_GROWTH.name,
)
"""What a study shows of it unasked."""
