"""A ball bearing that runs: how it carries its load, what moves, how quiet it is, which part is heard."""

from functools import partial
from typing import TYPE_CHECKING

from asperity.schema import VIEW_OF, Attribute, Entry, rolling, spectra

if TYPE_CHECKING:
    from xarray import DataTree

OF_BEARING = "of a bearing"
_bearing, _rolling, _spectra = (
    partial(Entry, group, condition=OF_BEARING) for group in ("bearing", "rolling", "spectra")
)
_fact = partial(Attribute, "bearing", condition=OF_BEARING)

# --- how it carries its load

_BALL, _RING = "number of the ball or roller", "ring: inner or outer"
_STILL = "nothing vibrates"
BALL, ROLLING_BALL = (each("ball", "1", _BALL) for each in (_bearing, _rolling))
RING, ROLLING_RING = (each("ring", "1", _RING) for each in (_bearing, _rolling))
DIRECTION, ROLLING_DIRECTION = (
    each(
        "direction",
        "1",
        "direction: along the radial load, across it in the sense of rotation, along the axis",
    )
    for each in (_bearing, _rolling)
)
CAGE_ANGLE = _bearing("cage_angle", "rad", "angle of the first ball from the radial load, at rest")
AZIMUTH = _bearing("azimuth(cage_angle, ball)", "rad", "angle of a ball from the radial load")
BALL_LOAD = _bearing("ball_load(ring, cage_angle, ball)", "N", "static load of a contact")
BALL_ANGLE = _bearing(
    "ball_angle(ring, cage_angle, ball)",
    "rad",
    "contact angle",
    missing="balls that do not touch have no contact angle",
)
PEAK_PRESSURE = _bearing("peak_pressure(ring, cage_angle, ball)", "Pa", "largest pressure of a contact")
SEMI_AXIS_ALONG, SEMI_AXIS_ACROSS = (
    _bearing(f"semi_axis_{way}(ring, cage_angle, ball)", "m", f"semi-axis of a contact {way} its raceway")
    for way in ("along", "across")
)
_BETWEEN = "balls that do not touch both rings are not rolled by them"
SPIN_CREEPAGE = _bearing(
    "spin_creepage(ring, cage_angle, ball)",
    "rad/m",
    "turning of a ball against a raceway about their normal over the speed of rolling",
    missing=_BETWEEN,
)
RIM_CREEPAGE = _bearing(
    "rim_creepage(ring, cage_angle, ball)",
    "1",
    "creepage by the form of the groove at the rim of a contact across",
    missing=_BETWEEN,
)
SLIDING_HEAT = _bearing(
    "sliding_heat(ring, cage_angle, ball)",
    "W",
    "heat of a contact over its coefficient of friction, if all of it slips",
    missing=_BETWEEN,
)
RUBBING = "of a ball bearing with friction"
_rubbed = partial(Entry, "bearing", condition=RUBBING)
FRICTION_HEAT = _rubbed(
    "friction_heat(ring, cage_angle, ball)", "W", "heat of friction of a contact", missing=_BETWEEN
)
SLIPPING_SHARE = _rubbed(
    "slip_share(ring, cage_angle, ball)", "1", "share of a contact that slips", missing=_BETWEEN
)
BALL_SPIN_MOMENT = _rubbed(
    "spin_moment(ring, cage_angle, ball)",
    "N m",
    "moment of friction of a contact about its normal",
    missing=_BETWEEN,
)
GYRATION = _rubbed(
    "gyration(cage_angle, ball)",
    "1",
    "moment by which a ball gyrates over what friction holds at most",
    missing=_BETWEEN,
)
FRICTION_TORQUE = _rubbed(
    "friction_torque(law)", "N m", "torque that friction of all contacts asks of the rings, mean over time"
)
RUBS_ON_RIB = "of a bearing of tapered rollers with friction"
_on_rib = partial(Entry, "bearing", condition=RUBS_ON_RIB)
RIB_HEAT = _on_rib("rib_heat(cage_angle, ball)", "W", "heat of friction of a roller on the rib")
RIB_TORQUE = _on_rib(
    "rib_torque(law)", "N m", "torque that friction on the rib asks of the rings, mean over time"
)
_worn = partial(Entry, "bearing", condition="of a ball bearing with a wear_coefficient")
RACEWAY_ANGLE = _worn("raceway_angle", "rad", "place around a raceway, from the radial load")
WEAR_RATE = _worn(
    "wear_rate(ring, raceway_angle)",
    "m/s",
    "depth that wears in a second where a groove wears most; without friction as if all of a contact slips",
)
WORN_AREA_RATE = _worn(
    "worn_area_rate(ring, raceway_angle)", "m2/s", "area of a groove's section that wears in a second"
)
WORN_VOLUME_RATE = _worn("worn_volume_rate(ring)", "m3/s", "volume of a raceway that wears in a second")
RING_DISPLACEMENT = _bearing(
    "ring_displacement(direction, cage_angle)", "m", "static displacement of the inner ring"
)
RING_STIFFNESS = _bearing(
    "ring_stiffness(direction, cage_angle)", "N/m", "stiffness of the bearing under its load"
)
BALL_DIAMETER = _fact("ball_diameter", "m", "diameter of a ball")
PITCH_DIAMETER = _fact("pitch_diameter", "m", "diameter of the circle of the balls' centres")
CONTACT_ANGLE = _fact("contact_angle", "rad", "contact angle of the run, mean of the static ones")
ELEMENT = _fact("element", "text", "what rolls in it: ball or roller")
LEFT_OUT = _fact("left_out", "text", "what is not in the computation")

# --- its oil

OILED = "of a bearing with oil"
_film = partial(Entry, "bearing", condition=OILED)
_oil = partial(Attribute, "bearing", condition=OILED)
_IDLE = "balls that carry nothing have no contact for a film"
_SMOOTH = "both surfaces are smooth"
FILM_THICKNESS = _film(
    "film_thickness(ring, cage_angle, ball)", "m", "film in the middle of a contact", missing=_IDLE
)
LEAST_FILM = _film("least_film(ring, cage_angle, ball)", "m", "least film of a contact", missing=_IDLE)
FILM_PARAMETER = _film(
    "film_parameter(ring, cage_angle, ball)", "1", "least film over the rms of both surfaces",
    missing=f"{_IDLE}, or {_SMOOTH}"
)  # fmt: skip
HEAVIEST_FILM = _film("heaviest_film(ring)", "m", "film in the middle under the heaviest load")
HEAVIEST_PARAMETER = _film(
    "heaviest_film_parameter(ring)", "1", "film parameter under the heaviest load", missing=_SMOOTH
)
FILM_RMS = _film("film_roughness(ring)", "m", "rms of both surfaces together within a contact")
FILM_STIFFNESS = _film("film_stiffness(ring)", "N/m", "stiffness of a contact with its film, heaviest load")
FILM_DAMPING = _film("film_damping(ring)", "N s/m", "damping of a contact with its film, heaviest load")
FILM_HEATING = _film("film_heating(ring)", "1", "share of the film that the heating of the inlet leaves")
ASPERITY_SHARE = _film("asperity_share(ring)", "1", "share of the heaviest load that asperities carry")
FILM_FORMULA = _oil("film_formula", "text", "whose formula the films are by")
OIL_VISCOSITY = _oil("oil_viscosity", "Pa s", "viscosity of the oil at its temperature, without pressure")
OIL_PRESSURE = _oil("oil_pressure_viscosity", "1/Pa", "its pressure-viscosity coefficient")

# --- along the roller that carries most

OF_ROLLERS, OF_TAPERED = "of a roller bearing", "of a bearing of tapered rollers"
OF_ARCHES = "of a ball bearing with gothic arches, of whose flanks the force is the sum"
ALONG_ROLLER, LINE_LOAD, LINE_PRESSURE = (
    Entry("bearing", f"{name}", units, meaning, condition=OF_ROLLERS)
    for name, units, meaning in (
        ("along_roller", "m", "place of a slice from the middle of the roller"),
        ("line_load(ring, along_roller)", "N/m", "static load per length of the roller that carries most"),
        ("line_pressure(ring, along_roller)", "Pa", "pressure of the slices of that roller"),
    )
)
RING_TILT, TILT_MOMENT = (
    Attribute("bearing", name, units, meaning, condition=OF_ROLLERS)
    for name, units, meaning in (
        ("ring_tilt", "rad", "static tilt of the inner ring in the plane of the load, mean over the cage"),
        ("tilt_moment", "N m", "static moment that holds it there"),
    )
)

# --- what turns how fast

PART = _bearing("part", "1", "part of the bearing: outer or inner raceway, or ball")
TONE = _bearing("tone(part)", "Hz", "frequency at which a place of a part is met, in pure rolling")
MODULATION = _bearing("modulation(part)", "Hz", "turns of that place past the radial load")
TURNING = _fact("turning_frequency", "Hz", "turns of the ring that turns")
CAGE = _fact("cage_frequency", "Hz", "turns of the cage, in pure rolling")

# --- what was recorded

_SENSOR = "angle of an accelerometer on the outer ring from the radial load"
SENSOR, ROLLING_SENSOR = (each("ring_sensor", "rad", _SENSOR) for each in (_bearing, _rolling))
BALL_AZIMUTH = _rolling("ball_azimuth(ball, time)", "rad", "angle of a ball from the radial load, counted on")
CONTACT_RING = _rolling("contact_ring(contact)", "1", "ring of a contact: inner or outer")
CONTACT_BALL = _rolling("contact_ball(contact)", "1", "number of the ball of a contact")
INNER_FORCE, OUTER_FORCE = (
    Entry(
        "rolling",
        f"{ring}_force(law, ball, time)",
        "N",
        f"contact force of a ball and the {ring} ring",
        "of a ball bearing, in memory alone: a view of rolling/contact_force",
        attributes=(VIEW_OF,),
    )
    for ring in ("inner", "outer")
)
RING_FORCES = {"inner": INNER_FORCE, "outer": OUTER_FORCE}
"""Parts of the forces of all contacts, by the ring."""
TACHO = _rolling("tacho_speed(time)", "Hz", "turns per second of the ring that turns")
SPECTRA_SENSOR = _spectra("ring_sensor", "rad", _SENSOR)
ACCELERATION_LEVEL = _spectra(
    "ring_acceleration_level(law, ring_sensor, band)",
    "dB re 1e-6 m/s2",
    "level of the acceleration of the outer ring, radially",
    missing=_STILL,
)
BALL_MOTION = _rolling("ball_motion(law, ball, time)", "m", "motion of a ball along its contacts, outwards")
FLANK_FORCE = Entry(
    "rolling",
    "flank_force(law, contact, time)",
    "N",
    "part of the contact force on the flank against a negative axial load",
    condition=OF_ARCHES,
)
RIB_FORCE = Entry(
    "rolling",
    "rib_force(law, ball, time)",
    "N",
    "force of the rib on a roller along its axis",
    condition=OF_TAPERED,
)
RING_MOTION = _rolling("ring_motion(law, ring, direction, time)", "m", "motion of a ring")
RING_ACCELERATION = _rolling(
    "ring_acceleration(law, ring_sensor, time)", "m/s2", "acceleration of the outer ring, radially outwards"
)

# --- how quiet it is, and what is heard

LAW = _bearing("law", "1", "contact law")
JUDGED_BAND = _bearing("judged_band", "1", "band in which bearings are judged (ISO 15242-2)")
_BEYOND = "the sampling does not reach the band"
BAND_VELOCITY = _bearing(
    "band_velocity(law, ring_sensor, judged_band)", "m/s", "rms radial velocity in a band", missing=_BEYOND
)
BAND_ANDERONS = Entry(
    "bearing",
    "band_anderons(law, ring_sensor, judged_band)",
    "1",
    "radial velocity in a band in anderons",
    condition="of a bearing whose speed stays",
    missing=_BEYOND,
)
_CHANCE = "standard deviation of a velocity by the chance of one record, over it, by parts of the record"
BAND_DEVIATION = _bearing(
    "band_velocity_deviation(law, ring_sensor, judged_band)", "1", _CHANCE, missing=f"{_BEYOND}, or {_STILL}"
)
SOURCE = _bearing("source", "1", "part that is as it is, where all others are smooth")
ALONE_VELOCITY = _bearing(
    "alone_velocity(source, judged_band)",
    "m/s",
    "rms radial velocity in a band with the texture of one part alone, first sensor",
    missing=_BEYOND,
    attributes=("law",),
)
ALONE_DEVIATION = _bearing(
    "alone_velocity_deviation(source, judged_band)", "1", _CHANCE, missing=f"{_BEYOND}, or {_STILL}"
)
VELOCITY_AMPLITUDE = _spectra(
    "velocity_amplitude(law, frequency)",
    "m/s",
    "amplitude of lines of the radial velocity, first sensor",
    missing=_STILL,
)
ENVELOPE_FREQUENCY = _bearing("envelope_frequency", "Hz", "frequency of the envelope")
ENVELOPE = _bearing(
    "envelope(law, envelope_frequency)",
    "m/s2",
    "amplitude of lines in the envelope of the acceleration, first sensor",
    missing=_STILL,
)
ENVELOPE_LOW, ENVELOPE_HIGH = (
    _fact(f"envelope_{end}", "Hz", f"{end} end of the band of which the envelope is taken")
    for end in ("low", "high")
)
ENVELOPE_SPEED = _fact(
    "envelope_speed", "Hz", "speed of which the frequencies of the envelope are; of a run-up the fastest"
)
HARMONIC = _bearing("harmonic", "1", "multiple of the tone of a part")
_BEYOND = "the envelope does not reach it"


def _line(name: str, units: str, meaning: str) -> Entry:
    return _bearing(f"line_{name}(law, part, harmonic)", units, meaning, missing=_BEYOND)


LINE_FREQUENCY = _line("frequency", "Hz", "frequency of the line found next to it, first sensor")
LINE_AMPLITUDE = _line("amplitude", "m/s2", "amplitude of the line of the envelope next to the tone")
LINE_SIDE_BANDS = _line("side_bands", "m/s2", "larger amplitude one modulation beside it")
LINES_FOUND = _bearing("lines_found(law, part)", "1", "whether its lines stand out, 1 or 0")

# --- a run-up

_changing = partial(Entry, "bearing", condition="of a ball bearing whose speed changes")
_OF_ACCELERATION = "amplitude of lines of the acceleration"
_APART = "of a ball bearing whose speed changes by a tenth or more"
_told_apart = partial(Entry, "bearing", condition=_APART)
ORDER = _changing("order", "1", "events in a turn of the ring that turns")
ORDER_AMPLITUDE = _changing(
    "order_amplitude(law, order)", "m/s2", f"{_OF_ACCELERATION} over angle, first sensor", missing=_STILL
)
RUN_UP_SPEED = _changing("run_up_speed", "Hz", "middle of a range of speeds")
RUN_UP_FREQUENCY = _changing("run_up_frequency", "Hz", "middle of a range of frequencies")
RUN_UP_AMPLITUDE = _changing(
    "run_up_amplitude(run_up_speed, run_up_frequency)",
    "m/s2",
    f"{_OF_ACCELERATION} in pieces of the record, the highest in a range, main law, first sensor",
    missing="no piece of the record is at the speed, or nothing vibrates",
)
FOLLOWING_ORDER = _told_apart("following_order", "1", "middle of a band of orders")
FOLLOWS = _told_apart("follows_speed(following_order)", "m/s2", "what of the lines follows the speed")
STAYING_FREQUENCY = _told_apart("staying_frequency", "Hz", "middle of a band of frequencies")
STAYS = _told_apart(
    "stays_at_frequency(staying_frequency)", "1", "factor by which lines are larger there at any speed"
)
UNEXPLAINED = Attribute("bearing", "unexplained", "dB", "rms of what the two leave of the lines", _APART)

FIRST = {"harmonic": 1}
KEPT: dict[Entry, dict[str, int]] = {
    HEAVIEST_FILM: {},
    HEAVIEST_PARAMETER: {},
    FRICTION_TORQUE: {},
    RIB_TORQUE: {},
    BAND_VELOCITY: {},
    BAND_ANDERONS: {},
    BAND_DEVIATION: {},
    ACCELERATION_LEVEL: {},
    spectra.FORCE_LEVEL: {},
    TONE: {},
    LINE_FREQUENCY: FIRST,
    LINE_AMPLITUDE: FIRST,
    LINE_SIDE_BANDS: FIRST,
    LINES_FOUND: {},
}
"""What a study keeps of it, and where of it; of several sensors, of the first."""
SHOWN = (BAND_VELOCITY.name, LINE_AMPLITUDE.name, LINES_FOUND.name)
"""What a study shows of it unasked."""


def with_ring_forces(tree: "DataTree") -> "DataTree":
    """Give a result of a bearing the forces on each of its rings, parts of those of all contacts."""
    motion = tree.children.get(rolling.CONTACT_FORCE.group)
    if motion is None or CONTACT_RING.name not in motion.variables:
        return tree
    rings = motion.variables[CONTACT_RING.name].values.tolist()
    forces = motion.variables[rolling.CONTACT_FORCE.name].values
    for ring, entry in RING_FORCES.items():
        first = rings.index(ring)
        part = forces[:, first : first + rings.count(ring)]
        motion[entry.name] = entry.variable(part, **{VIEW_OF: rolling.CONTACT_FORCE.path})
    return tree
