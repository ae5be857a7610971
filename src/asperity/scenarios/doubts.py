"""Sizes that are legal but hardly meant: masses, loads, dampers and waves in a wrong unit."""

import math
from collections.abc import Mapping
from itertools import product

import numpy as np

from asperity.case.ball_bearing import BearingUnderLoad
from asperity.case.beam import BeamKeys
from asperity.case.scene import Case
from asperity.case.sideways import SidewaysKeys
from asperity.contact.batched import UNTRIED, find_device
from asperity.contact.hertz import Hertz
from asperity.errors import OutOfRangeWarning
from asperity.laws import spec_of
from asperity.reference.materials import material
from asperity.rolling.steps import warn_if_coarse
from asperity.scenarios.usual import OF_ANYTHING, OF_BEARINGS, OF_TRAINS, UNIT, unusual
from asperity.speeds import slowest
from asperity.structures.balls_in_grooves import STATIC_PRESSURE
from asperity.structures.body import GRAVITY
from asperity.structures.roller_bearing import AnyBearing, RollerBearing
from asperity.structures.track import Track
from asperity.structures.track_parameters import LAYERS
from asperity.units import written
from asperity.written_numbers import between, in_newtons, rounded

FASTEST_TRAIN = 160.0
"""m/s: no train has run faster than 574.8 km/h, in 2007."""
HOLLOW = 0.01
"""Share of the mass of a solid ball of the same radius that nothing that rolls falls short of."""
LIFTED = 0.5
"""Share of its weight below which a load means that something carries the body."""
UNDAMPED, OVERDAMPED = 1e-4, 2.0
"""Times critical damping below which a damper damps nothing, and above which there is no spring beside it."""
LIGHT_ABOVE = 0.01
"""Share of the mass on a contact that a mass above it has at least."""
OF_A_BAR = 100.0
"""Times the moment of inertia of a bar, and its share, between which frames and carriages have theirs."""
LONG_RUN_IN = 20.0
"""Records that are as long as what is rolled before one at most."""
SHALLOW = 0.05
"""Share of the approach at rest below which a dip is none."""
STRAIGHT = 500.0
"""Times the radius of what rolls from which a curved path or section is as good as straight."""
FINE_STEP = 0.02
"""Share of the time step that would be chosen below which a given one costs without a gain."""
MANY_WINDOWS = 100.0
"""Windows that are longer than any sample has to be."""
SLENDER = 2.0, 1000.0
"""Lengths in heights between which beams bend as beams, and are no wires."""
MODES_WANTED = 200.0
"""Times the highest frequency of the spectra above which no mode of a beam is felt."""
RIGID_SPRING, LOOSE_SPRING = 300.0, 0.003
"""Times the stiffness of a contact of a bearing between which springs hold a ring, and are not rigid."""
TURNING_LOAD = 10.0
"""Times the loads that stand still which no load that turns with the shaft exceeds."""
HIGHEST_BURR = 0.1
"""Diameters of a ball that burrs and the rounding of edges do not reach."""
SMOOTHEST = 1e-10
"""Rms height, m, that no surface falls short of: polished glass and silicon have as much."""
LOWEST_HEARD = 10.0
"""Hz, below which waves that are passed are heard by nobody."""
SOFTEST_TRACK = 0.01
"""Deflection under a wheel at rest, m, that no track reaches: they have a few millimetres at most."""
HARDEST_LAYER = 2e10
"""N/m, stiffer than any pad or bed of a track: hard pads have 3 GN/m at most."""
FULLY_LOSSY = 5.0, 1e5
"""Hz between which a damper of a track is as stiff as its spring: of named ones 135 Hz to 2.7 kHz."""
BENDS = 20.0
"""m²/s, less than the root of any rail's or sleeper's bending stiffness over mass per length: 100 to 400."""
SHEARS, TWISTS = (500.0, 6000.0), (100.0, 4000.0)
"""m/s, between which waves of shear and of twist run along rails: about 2000 and 800."""
SECTION_OF_A_RAIL = "bending_stiffness", "shear_stiffness", "rotary_inertia"
GYRATION = 0.005, 0.2
"""m, between which radii of gyration of rails lie: they are 20 mm to 70 mm."""
OF_VERTICAL = 0.01, 10.0
"""Times the vertical stiffness between which the lateral one of a layer lies, and that against roll."""
LIGHTLY_LOADED = 0.2
"""Share of the weight of the shaft that a bearing carries at least."""
BESIDE_APEX = 0.2
"""Share of a taper by which rollers are off the one apex at which cones roll: printed angles are rounded."""
HEAVIEST = 1e5
"""Times the mass of all balls that no ring weighs with all that moves with it."""


def doubt_device() -> None:
    """Warn where contacts are to be solved on what the program was never run on."""
    if (device := find_device()) is not None:
        told = f"The device gpu ({device.name}) is {UNTRIED}: compare a small run with the device cpu first."
        OutOfRangeWarning.warn(told)


def doubt_sizes(case: Case, over: object) -> None:
    """Warn of sizes of a case that are hardly meant; `over` is what is rolled over."""
    doubt_device()
    rolling = case.rolling
    name = case.ROLLING
    surface = case.surface
    mass = rolling.contact_mass
    load = rolling.contact_load
    carried = mass + sum(rolling.masses or ()) * len(rolling.positions) / len(rolling.offsets)
    solid = 4.0 / 3.0 * math.pi * rolling.radius**3 * rolling.material.density
    if mass < HOLLOW * solid:
        _warn(f"{name}.mass", mass, "kg", f"a solid ball of its radius and material has {rounded(solid)} kg")
    if load < LIFTED * GRAVITY * carried:
        told = f"what rests on a contact weighs {in_newtons(GRAVITY * carried)}, so that something lifts it"
        _warn(f"{name}.load", load, "N", told)
    pressure = case.smooth_contact.pressure_under(load)
    if case.contact.hardness is None and pressure > STATIC_PRESSURE:
        told = f"smooth bodies press with {rounded(pressure / 1e9)} GPa, and dents begin in bearing steel at "
        _warn(f"{name}.load", load, "N", f"{told}{STATIC_PRESSURE / 1e9:g} GPa (ISO 76)", "kN")
    _doubt_above(case)
    _doubt_damping("contact.damping", case.contact.damping, case.smooth_contact, load, mass)
    if surface.rms is not None and surface.rms < SMOOTHEST:
        _warn("surface.rms", surface.rms, "m", "the smoothest surfaces that are made have 0.1 nm", "nm")
    first, last = case.rolled_range
    if surface.rms is not None and surface.longest is not None and surface.longest > last - first:
        told = f"{rounded(last - first)} m are rolled, which hold less than the rms of the texture"
        _warn("surface.longest", surface.longest, "m", told, "mm")
    if surface.corrugation is not None and (wave := surface.corrugation_wavelength) is not None:
        passed = [each / wave for each in (slowest(case.speed), float(case.speed))]
        highest = case.numerics.highest_frequency
        if not (passed[1] >= LOWEST_HEARD and passed[0] <= 1.13 * highest):
            at = between(*map(rounded, passed))
            told = f"it is passed at {at} Hz, and spectra go from some {LOWEST_HEARD:g} Hz to "
            _warn("surface.corrugation_wavelength", wave, "m", f"{told}{highest:g} Hz", "mm")
    _doubt_lengths(case)
    _doubt_run_in(case.settling, case.rolled_time)
    _doubt_time_step(case)
    _doubt_usual(case, OF_ANYTHING)
    if isinstance(case.rolled_over, BeamKeys):
        _doubt_beam(case, case.rolled_over)
    if isinstance(over, Track):
        _doubt_usual(case, OF_TRAINS, **{name: "wheel"})
        if case.speed > FASTEST_TRAIN:
            _warn("speed", float(case.speed), "m/s", "no train has run faster than 160 m/s, 575 km/h", "km/h")
        _doubt_layers(over, case.over_name, load)
        _doubt_rail(over, case.over_name, over.mass_per_length)
        if over.sleeper_bending_stiffness is not None:
            mass = 2.0 * over.sleeper_mass / over.sleeper_length
            _doubt_bending(
                f"{case.over_name}.sleeper_bending_stiffness", over.sleeper_bending_stiffness, mass
            )
        _doubt_sideways(case, over)


def _doubt_usual(case: Case | BearingUnderLoad, usual: Mapping[str, str], **called: str) -> None:
    """Warn of sizes that are given beyond those that machines of a kind have."""
    for told in unusual(case, usual, **called):
        OutOfRangeWarning.warn(told)


def _doubt_lengths(case: Case) -> None:
    """Warn of lengths that do not fit to what rolls, or to how far it rolls."""
    first, last = case.rolled_range
    path = f"{rounded(last - first)} m are rolled"
    sample = case.contact.sample_length
    window = case.contact.window
    if sample is not None and sample > max(MANY_WINDOWS * window, last - first):
        told = f"{path}, and the window is {rounded(1e3 * window)} mm wide"
        _warn("contact.sample_length", sample, "m", told, "mm")
    deep = case.surface.joint_depth
    dip = case.surface.joint_length
    if deep is not None and dip > 2.0 * (last - first):
        _warn("surface.joint_length", dip, "m", f"{path}, so that there is no more of it than a slope", "mm")
    body = case.rolling
    name = case.ROLLING
    round_body = f"a body of a radius of {rounded(1e3 * body.radius)} mm"
    for key in ("raceway_radius", "transverse_radius", "groove_radius"):
        bent = getattr(body, key)
        if bent is not None and STRAIGHT * body.radius < abs(bent) < math.inf:
            _warn(f"{name}.{key}", bent, "m", f"beside {round_body} that is as good as straight", "mm")
    contact = case.smooth_contact
    approach = contact.approach(body.contact_load)
    if deep is not None and deep < SHALLOW * approach:
        told = f"at rest bodies approach by {rounded(1e6 * approach)} µm, beside which that is none"
        _warn("surface.joint_depth", deep, "m", told, "um")
    touching = 2.0 * contact.semi_axes(approach)[0]
    sunk = body.flat_depth
    by_depth = None if sunk is None else math.sqrt(8.0 * body.radius * sunk)
    chords = {"flat_length": body.flat_length, "flat_depth": by_depth}
    for key, chord in chords.items():
        if chord is not None and chord < touching:
            flat, patch = (f"{rounded(1e3 * each)} mm long" for each in (chord, touching))
            told = f"the flat is {flat}, the contact at rest {patch}"
            _warn(f"{name}.{key}", getattr(body, key), "m", told, "mm")
    for section, key in ((name, "positions"), ("noise", "axle_positions")):
        places = getattr(getattr(case, section, None), key, None) or ()
        if (apart := float(np.diff(sorted(places)).min(initial=math.inf))) < body.radius:
            _warn(f"{section}.{key}", apart, "m", f"so near, two of {round_body} overlap", "mm")
    if body.distance is not None and body.distance < body.radius:
        _warn(f"{name}.distance", body.distance, "m", f"so near, two of {round_body} overlap", "mm")
    for section in ("surface", name):
        beside = getattr(getattr(case, section), "line_distance", None)
        if beside is not None and beside > window:
            told = f"the window is {rounded(1e3 * window)} mm wide, and holds no line but the middle one"
            _warn(f"{section}.line_distance", beside, "m", told, "mm")


def _doubt_above(case: Case) -> None:
    """Warn of masses, springs and dampers above the contacts that do not fit to each other."""
    body = case.rolling
    name = case.ROLLING
    lightest = min(body.masses or (math.inf,))
    if lightest < LIGHT_ABOVE * body.contact_mass:
        told = f"what it rests on has {rounded(body.contact_mass)} kg on each contact"
        _warn(f"{name}.masses", lightest, "kg", told)
    if not body.masses:
        return
    if body.inertia is not None and body.distance is not None:
        bar = sum(body.masses) * body.distance**2 / 12.0
        if not 1.0 / OF_A_BAR <= body.inertia / bar <= OF_A_BAR:
            told = f"a bar of its mass, as long as its contacts are apart, has {rounded(bar)} kg m^2"
            _warn(f"{name}.inertia", body.inertia, "kg m^2", told)
    hard = case.resting_stiffness
    for number, spring in enumerate(body.springs or ()):
        mass = body.masses[min(number, len(body.masses) - 1)]
        if (yields := GRAVITY * mass / spring) > body.radius:
            told = f"the mass above it presses it down by {rounded(yields)} m"
            _warn(f"{name}.springs", spring, "N/m", told, "MN/m")
        elif spring > 0.5 * hard and body.type != "carriage":
            told = f"the contact at rest has {written(hard, 'N/m', 'MN/m', exactly=False)}"
            _warn(f"{name}.springs", spring, "N/m", told, "MN/m")
        critical = 2.0 * math.sqrt(spring * mass)
        damper = body.dampers[number] if body.dampers else 0.0
        if damper and not UNDAMPED * critical <= damper <= OVERDAMPED * critical:
            told = f"critical damping of the spring beside it is {rounded(critical)} N s/m"
            _warn(f"{name}.dampers", damper, "N s/m", told)


def _doubt_run_in(settling: float | None, recorded: float) -> None:
    """Warn of a run-in, s, that is long beside the record, s."""
    if settling is not None and settling > LONG_RUN_IN * recorded:
        _warn("settling", settling, "s", f"the record is {rounded(recorded)} s long")


def _doubt_time_step(case: Case) -> None:
    """Warn of a given time step that is far finer than the one that would be taken."""
    step = case.numerics.time_step
    if step is not None and step < FINE_STEP * case.chosen_step:
        chosen = written(case.chosen_step, "s", "us", exactly=False)
        told = f"without it {chosen} would be taken, in a small part of the time"
        _warn("numerics.time_step", step, "s", told, "us")


def _doubt_beam(case: Case, beam: BeamKeys) -> None:
    """Warn of a beam that is none, and of modes that nothing excites."""
    slender = beam.length / beam.height
    if not SLENDER[0] <= slender <= SLENDER[1]:
        told = f"it is {rounded(1e3 * beam.height)} mm high, and beams are {SLENDER[0]:g} to {SLENDER[1]:g} "
        _warn(f"{case.over_name}.length", beam.length, "m", f"{told}times as long")
    highest = case.numerics.highest_frequency
    if beam.modes_up_to is not None and beam.modes_up_to > MODES_WANTED * highest:
        told = f"spectra go up to {highest:g} Hz, and modes far above it move nothing"
        _warn(f"{case.over_name}.modes_up_to", beam.modes_up_to, "Hz", told)


def _doubt_layers(track: Track, section: str, load: float) -> None:
    """Warn of springs and dampers between rail and ground that no track has, under a wheel's load, N."""
    if (bent := track.static_deflection(load)) > SOFTEST_TRACK:
        told = f"tracks yield by a few millimetres at most. {UNIT} Look at pads, ballast and subgrade."
        OutOfRangeWarning.warn(f"The rail yields by {rounded(1e3 * bent)} mm under a wheel at rest: {told}")
    for layer in LAYERS:
        stiffness, damping = (getattr(track, f"{layer}_{each}") for each in ("stiffness", "damping"))
        if stiffness is None or math.isinf(stiffness):
            continue
        if stiffness > HARDEST_LAYER:
            told = "hard pads have 3000 MN/m, and all other layers are softer"
            _warn(f"{section}.{layer}_stiffness", stiffness, "N/m", told, "MN/m")
        elif damping:
            lossy = stiffness / (2.0 * math.pi * damping)
            if not FULLY_LOSSY[0] <= lossy <= FULLY_LOSSY[1]:
                spring = written(stiffness, "N/m", "MN/m", exactly=False)
                told = (
                    f"it is as stiff as the spring beside it, {spring}, at {rounded(lossy)} Hz, and others "
                )
                told += f"at {FULLY_LOSSY[0]:g} Hz to {FULLY_LOSSY[1] / 1e3:g} kHz"
                _warn(f"{section}.{layer}_damping", damping, "N s/m", told, "kN s/m")


def _doubt_rail(keys: Track | SidewaysKeys, section: str, mass: float) -> None:
    """Warn of a rail, of a mass per length, kg/m, that bends, shears or turns as none does."""
    bending, shear, rotary = (getattr(keys, name, None) for name in SECTION_OF_A_RAIL)
    if bending is not None:
        _doubt_bending(f"{section}.bending_stiffness", bending, mass)
    if shear is not None:
        _doubt_waves(f"{section}.shear_stiffness", shear, "N", mass, "shear", SHEARS)
    if rotary is not None and not GYRATION[0] <= (radius := math.sqrt(rotary / mass)) <= GYRATION[1]:
        told = f"its radius of gyration would be {rounded(1e3 * radius)} mm"
        _warn(f"{section}.rotary_inertia", rotary, "kg m", told)


def _doubt_waves(
    key: str, stiffness: float, unit: str, inertia: float, what: str, speeds: tuple[float, float]
) -> None:
    """Warn of a stiffness, over an inertia per length, by which waves run along a rail as in none."""
    speed = math.sqrt(stiffness / inertia)
    if math.isfinite(speed) and not speeds[0] <= speed <= speeds[1]:
        told = (
            f"waves of {what} would run at {rounded(speed)} m/s, in rails {speeds[0]:g} to {speeds[1]:g} m/s"
        )
        _warn(key, stiffness, unit, told, f"M{unit}")


def _doubt_bending(key: str, stiffness: float, mass: float) -> None:
    """Warn of a beam, of a mass per length, kg/m, that is far too slender."""
    if math.sqrt(stiffness / mass) < BENDS:
        steel = material("steel")
        thick = math.sqrt(12.0 * stiffness / mass * steel.density / steel.youngs_modulus)
        told = f"a bar of steel that bends as easily for its mass is {rounded(1e3 * thick)} mm high"
        _warn(key, stiffness, "N m^2", told, "kN m^2")


def _doubt_sideways(case: Case, track: Track) -> None:
    """Warn of stiffnesses of a rail sideways that are far from those up and down."""
    if "sideways" not in case.inner:
        return
    keys = case.sideways
    width = case.track.rail_foot_width
    _doubt_rail(keys, "sideways", track.mass_per_length)
    if {"torsional_stiffness", "polar_inertia"} & keys.given().keys():
        lateral = keys.model(track.regular, width)
        what = f"twist, of a polar inertia of {rounded(lateral.polar_inertia)} kg m,"
        twist = lateral.torsional_stiffness, "N m^2", lateral.polar_inertia, what, TWISTS
        _doubt_waves("sideways.torsional_stiffness", *twist)
    roll = track.pad_stiffness * width**2 / 12.0
    for name, vertical, unit, what in (
        ("pad_stiffness", track.pad_stiffness, "N/m", "the vertical one"),
        ("pad_roll_stiffness", roll, "N m", "that of an even pad under the foot"),
        ("ballast_stiffness", track.ballast_stiffness, "N/m", "the vertical one"),
    ):
        given = getattr(keys, name)
        if given is None or math.isinf(vertical):
            continue
        if not OF_VERTICAL[0] <= given / vertical <= OF_VERTICAL[1]:
            told = f"{what} is {written(vertical, unit, f'M{unit}', exactly=False)}"
            _warn(f"sideways.{name}", given, unit, told, f"M{unit}")


def doubt_bearing(case: BearingUnderLoad) -> None:
    """Warn of sizes of a bearing that are hardly meant, and of a given time step that is long."""
    of = case.bearing.bearing
    load = case.radial + case.axial + case.bearing.bearing.preload
    weight = GRAVITY * case.shaft.mass
    heavier = "radial" if case.radial >= case.axial else "axial"
    if load < LIGHTLY_LOADED * weight:
        _warn(heavier, load, "N", f"shaft.mass alone weighs {in_newtons(weight)}")
    for name, ring in (("shaft", case.shaft), ("housing", case.housing)):
        if not of.ball_mass <= ring.mass <= HEAVIEST * of.balls * of.ball_mass:
            told = f"one of its {of.balls} balls has {rounded(1e3 * of.ball_mass)} g"
            _warn(f"{name}.mass", ring.mass, "kg", told)
    contact, heaviest = case.contacts[1]
    _doubt_usual(case, OF_ANYTHING | OF_BEARINGS)
    _doubt_run_in(case.settling, case.duration)
    _doubt_springs(case, contact.stiffness_under(heaviest))
    _doubt_taper(of)
    if case.rotating > TURNING_LOAD * load:
        _warn("rotating", case.rotating, "N", f"all that stands still is {in_newtons(load)}")
    _doubt_damping("contact_damping", case.contact_damping, contact, heaviest, of.ball_mass)
    idle = of.balls - float(case.static.touching.min())
    for law in (law for law in case.laws if spec_of(law).may_pull and idle):
        OutOfRangeWarning.warn(
            f"{law}: up to {idle:.0f} of {of.balls} balls carry nothing, and there it pulls the rings "
            "together. Take a law that lets go, or load the bearing along its axis."
        )
    for name, keys in case.faults.items():
        for key, most in (("width", 1.0), ("depth", 0.5), ("edge", HIGHEST_BURR), ("burr", HIGHEST_BURR)):
            size = keys.fault and getattr(keys.fault, key)
            across = "length" if key == "width" and of.ELEMENT == "roller" else "diameter"
            room = getattr(of, f"{of.ELEMENT}_{across}")
            if size and size > most * room:
                told = f"{of.ELEMENT}s have a {across} of {rounded(1e3 * room)} mm"
                _warn(f"{name}.{key}", size, "m", told, "mm")
    for name in map(case.called, ("inner_raceway", "outer_raceway", "balls")):
        keys = getattr(case, name)
        if keys.roughness is not None and keys.roughness < SMOOTHEST:
            told = "the smoothest surfaces that are made have 0.1 nm"
            _warn(f"{name}.roughness", keys.roughness, "m", told, "nm")
        around = math.pi * (of.pitch_diameter if name.endswith("raceway") else of.ball_diameter)
        if keys.roughness is not None and keys.longest > around:
            told = f"{rounded(1e3 * around)} mm are around, which hold less than that roughness"
            _warn(f"{name}.longest", keys.longest, "m", told, "mm")
    what = f"the resonance of the most loaded {of.ELEMENT} between the rings"
    resonance = case.ball_resonance
    warn_if_coarse(case.step, [(what, resonance, 0.99 * case.resolving(resonance) / resonance)])


def _doubt_springs(case: BearingUnderLoad, contact: float) -> None:
    """Warn of springs that hold a ring or a roller as none does, beside the stiffness of a contact, N/m."""
    rings = product((("shaft", case.shaft), ("housing", case.housing)), ("radial", "axial"))
    springs = {f"{name}.{way}_stiffness": getattr(ring, f"{way}_stiffness") for (name, ring), way in rings}
    springs["bearing.rib_stiffness"] = getattr(case.bearing.bearing, "rib_stiffness", None)
    for key, stiffness in springs.items():
        if stiffness and not LOOSE_SPRING <= stiffness / contact <= RIGID_SPRING:
            told = f"a contact of the bearing has {written(contact, 'N/m', 'MN/m', exactly=False)}"
            _warn(key, stiffness, "N/m", told, "MN/m")


def _doubt_taper(of: AnyBearing) -> None:
    """Warn of tapered rollers that cannot roll: those that do have the apex of the raceways, on the axis."""
    if not isinstance(of, RollerBearing) or not of.taper:
        return
    inclined = of.contact_angle - 0.5 * of.taper
    rolling = 2.0 * math.atan(of.roller_diameter / of.pitch_diameter * math.sin(inclined))
    if abs(of.taper / rolling - 1.0) > BESIDE_APEX:
        told = f"rollers that roll as cones with one apex have {rounded(math.degrees(rolling))} deg"
        _warn("bearing.taper", of.taper, "rad", told, "deg")


def _doubt_damping(key: str, damping: float, contact: Hertz, load: float, mass: float) -> None:
    """Warn of a damper beside a contact under a load, N, of a mass, kg, that leaves nothing to its spring."""
    critical = 2.0 * math.sqrt(contact.stiffness_under(load) * mass)
    if damping and not UNDAMPED * critical <= damping <= OVERDAMPED * critical:
        _warn(key, damping, "N s/m", f"critical damping of this contact is {rounded(critical)} N s/m")


def _warn(key: str, value: float, dimension: str, told: str, unit: str = "") -> None:
    size = written(value, dimension, unit or dimension, exactly=False)
    OutOfRangeWarning.warn(f"{key} = {size}: {told}. {UNIT}")
