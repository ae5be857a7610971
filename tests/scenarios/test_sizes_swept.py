"""Every number of a case, times a thousand and a thousandth of it: refused, doubted, or named with a reason.

A key that is added stands in none of the lists: it must be judged, or be named here.
"""

from copy import deepcopy
from functools import cache

import numpy as np
import pytest

import small_cases
from asperity.case import PRESETS
from asperity.case.any_case import entries
from asperity.case.cases import as_case, case_class
from asperity.errors import AsperityError, PhysicsWarning
from asperity.parameters import Number, Quantity
from asperity.running import prepare_case
from asperity.structures.modal import ModalStructure

SMOOTH = {"smooth": True}
ROUGH = {"rms": "0.04 um", "longest": "0.4 mm", "shortest": "60 um"}
MASS_ABOVE = {"masses": ["0.4 kg"], "springs": ["0.1 MN/m"], "dampers": ["10 N s/m"]}
BODY_ABOVE = {"masses": ["4 t"], "springs": ["1.2 MN/m"], "dampers": ["10 kN s/m"]}
PIT = {"on": "outer", "length": "0.18 mm", "depth": "0.1 mm"}
TRAIN = {"axle_positions": ["0 m", "2.5 m", "19 m", "21.5 m"], "vehicle_length": "26 m"}
X = np.linspace(0.0, 1.0, 41)
GUIDE = ModalStructure(X, [200.0], 0.01, np.sin(np.pi * X)[:, None], modal_masses=[2.0])
BASES = {
    "ball-on-beam": small_cases.BALL | {"laws": ["linear"], "settling": "60 ms", "surface": SMOOTH},
    "wheel-on-rail": small_cases.HEARD
    | {"kind": "wheel-on-rail", "duration": "20 ms", "settling": "20 ms", "surface": SMOOTH}
    | {"contact": {"spacing": "0.5 mm", "samples": 2}, "wheel": {"section": "rigid"}}
    | {"numerics": {"highest_frequency": "2 kHz", "kernel": "scatter"}},
    "bodies": small_cases.BODIES | {"laws": ["linear"], "settling": "60 ms", "surface": SMOOTH},
    "ball-bearing": small_cases.BEARING,
    "roller-bearing": small_cases.BEARING | {"kind": "roller-bearing", "bearing": {"name": "NU205"}}
    | {"radial": "1 kN", "laws": ["areal"], "fault": {}},
}  # fmt: skip
WITH = {
    "ball-on-beam": {
        "surface": {"rms": "0.04 um", "longest": "0.4 mm", "shortest": "60 um", "hurst": 0.8}
        | {"anisotropy": 2.0, "lay": "30 deg"},
        "surface corrugation": {"corrugation": "0.3 um", "corrugation_wavelength": "1 mm"}
        | {"corrugation_bandwidth": 0.3},
        "surface joint": ROUGH
        | {"joint_depth": "10 um", "joint_length": "20 mm", "joint_position": "0.46 m"},
        "surface file": {"file": "map.npy", "pixel": "20 um", "height_unit": "um", "index": 0}
        | {"direction": "30 deg"},
        "surface line": {"line": "lines.npy", "line_unit": "um", "line_spacing": "40 um"}
        | {"line_distance": "0.1 mm"},
        "ball line": {"line": "lines.npy", "line_unit": "um", "line_spacing": "40 um"}
        | {"line_distance": "0.1 mm"},
        "ball roughness": {"roughness": "disc", "roughness_level": "3 dB"},
        "surface spectrum": {"spectrum": "iso3095", "level": "3 dB", "lateral": 1.0},
        "ball": {"mass": "0.5 kg", "radius": "25 mm", "load": "30 N", "transverse_radius": "50 mm"}
        | {"raceway": "outer", "raceway_radius": "100 mm"},
        "ball groove": {"groove_radius": "40 mm"},
        "ball positions": {"positions": ["0 m", "0.1 m"]},
        "ball flat": {"flat_depth": "20 um", "flat_position": "0.05 m", "flat_contacts": [1]},
        "ball carriage": {"type": "carriage", "masses": ["2 kg"], "contacts": 4, "distance": "60 mm"},
        "beam free": {"support": "free", "suspension_frequency": "5 Hz"},
        "ball flat length": {"flat_length": "2 mm"},
        "ball above": MASS_ABOVE | {"type": "chain"},
        "ball bogie": {
            "type": "bogie",
            "masses": ["0.4 kg"],
            "springs": ["0.1 MN/m"],
        }
        | {"distance": "100 mm", "inertia": "0.001 kg m^2"},
        "beam held": {"supports": ["0.05 m", "0.95 m"], "support_stiffness": "10 MN/m"}
        | {"support_loss_factor": 0.1, "support": "free"},
        "contact": {"damping": "20 N s/m", "friction": 0.3, "window": "0.66 mm"},
        "creep": {"longitudinal": 0.001, "lateral": -0.002, "spin": "1 rad/m"}
        | {"kinetic": 0.5, "falling_velocity": "0.5 m/s", "wear": "7e-4 mm^3/J"},
    },
    "wheel-on-rail": {
        "surface": {"rms": "2 um", "longest": "0.2 m", "shortest": "2 mm"},
        "surface corrugation": {"corrugation": "25 um", "corrugation_wavelength": "40 mm"},
        "surface joint": {"spectrum": "iso3095", "joint_depth": "1 mm", "joint_length": "1 m"},
        "wheel flat": {"flat_depth": "0.5 mm"},
        "wheel flat length": {"flat_length": "43 mm"},
        "wheel above": BODY_ABOVE | {"type": "chain"},
        "wheel bogie": {"type": "bogie", "masses": ["4 t"], "springs": ["1.2 MN/m"]}
        | {"distance": "2.5 m", "inertia": "1500 kg m^2"},
        "track damper": {"rail_damper_mass": "15 kg", "rail_damper_frequency": "800 Hz"}
        | {"rail_damper_loss_factor": 0.35},
        "track bays": {"bays": 10, "pad_scatter": 0.05, "ballast_scatter": 0.05, "spacing_scatter": 0.05},
        "track": {"points": ["1 m"], "rail_head_radius": "300 mm"},
        "track pad": {"pad_table": "pad.csv", "pad_preload": "30 kN"},
        "noise": TRAIN | {"measured_equivalent_level": "85 dB"},
        "noise exposure": TRAIN | {"measured_exposure_level": "86 dB"},
        "noise far": {"rail_distance": "1.5 m", "far_rail_screening": "3 dB"},
    },
    "bodies": {"structure": {"file": GUIDE, "damping_ratio": 0.01, "sensors": ["0.2 m"]}},
    "ball-bearing": {
        "": {"axial": "100 N", "rotating": "20 N", "sensors": ["30 deg"], "cage_slip": [0.01, 0.02]},
        "bearing preload": {"preload": "50 N"},
        "bearing angle": {"contact_angle": "15 deg"},
        "bearing": {"clearance": "10 um"},
        "bearing arch": {"arch_angle": "35 deg"},
        "shaft": {"mass": "1 kg"},
        "housing": {"radial_stiffness": "50 MN/m", "axial_stiffness": "50 MN/m"},
        "lubricant": {"viscosity_40": "68 mm^2/s", "viscosity_100": "9 mm^2/s"},
        "inner_raceway": {"waves": [3, 9], "amplitudes": ["1 um", "0.1 um"]},
        "inner_raceway wavy": {"waviness": "0.3 um", "fall": 1.5, "first_order": 2, "last_order": 100},
        "inner_raceway rough": {"roughness": "50 nm", "longest": "0.5 mm", "shortest": "50 um"}
        | {"hurst": 0.8, "anisotropy": 1.0},
        "fault": PIT | {"width": "0.18 mm", "angle": "20 deg", "offset": "1 mm", "edge": "20 um"},
        "fault burr": PIT | {"burr": "5 um", "burr_width": "50 um", "rim": 1.0, "rim_width": 1.0},
        "fault ball": PIT | {"on": "ball", "ball": 1},
        "fault count": PIT | {"count": 2},
    },
    "roller-bearing": {
        "": {"rotating": "20 N", "sensors": ["30 deg"], "cage_slip": [0.01, 0.02]}
        | {"tilt": "0.5 mrad", "rotating_tilt": "0.2 mrad"},
        "bearing": {"crowning": "partial", "crowning_straight": "3 mm", "crowning_drop": "2.6 um"},
        "fault": PIT | {"on": "roller", "roller": 1},
    },
}
"""Keys that stand beside those of one section, and what is swept where its default or example is not."""

DRAWN = {"modal_damping": [0.001, 0.01, 0.0001], "added_damping": 0.001, "bore_radius": "92.5 mm"}
DRAWN |= {"hub_radius": "135 mm", "hub_width": "175 mm", "hub_offset": "45 mm", "web_thickness": "28 mm"}
DRAWN |= {"web_thickness_rim": "22 mm", "web_bend": "20 mm", "fillet_radius": "25 mm", "tread_slope": 0.05}
DRAWN |= {"rim_thickness": "65 mm", "rim_width": "135 mm", "flange_height": "28 mm"}
DRAWN |= {"flange_thickness": "32 mm"}
WITH["wheel-on-rail"]["wheel drawn"] = {"section": "curved-web", **DRAWN}
OF_OTHERS = {
    "ball-on-beam": {f"ball.{name}" for name in DRAWN} | {"numerics.poles"},
    "roller-bearing": {"axial", "friction", "wear_coefficient"},
}
"""No wheel is drawn that rolls over a beam, and no beam has poles; cylindrical rollers slide nowhere."""
OF_A_FILE = {"structure.nodes", "structure.mass", "structure.inertia", "track.pad_preload"}
CARRIED_AXIALLY = {"bearing.taper", "bearing.rib_stiffness", "bearing.rib_height"}
"""Tapered rollers carry no radial load alone: they are tried where they run."""
LONG_WORK = {"contact.samples"}
"""They are doubted once their textures are made, which takes long."""
HARMLESS_SMALL = {
    "none of it is legal, and so little is as good as none": """
        surface.level ball.roughness_level noise.far_rail_screening noise.receiver_offset
        wheel.added_damping wheel.modal_damping wheel.hub_offset wheel.web_bend wheel.tread_slope
        beam.loss_factor beam.support_loss_factor structure.damping_ratio
        track.spacing_scatter track.pad_scatter track.ballast_scatter
        track.rail_loss_factor track.pad_loss_factor track.ballast_loss_factor track.sleeper_loss_factor
        track.under_sleeper_pad_loss_factor track.subgrade_loss_factor track.rail_damper_loss_factor
        creep.angle_of_attack creep.longitudinal creep.lateral creep.spin sideways.centroid_height
        axial rotating tilt rotating_tilt cage_slip bearing.clearance bearing.contact_angle bearing.preload
        bearing.crowning_straight shaft.damping_ratio housing.damping_ratio
        inner_raceway.amplitudes fault.burr fault.rim fault.rim_width""",
    "a place or an angle, of which any is legal": """
        surface.direction surface.lay ball.flat_position beam.sensors structure.sensors track.points
        wheel-on-rail:start sideways.contact_place sideways.wheel_shift sensors fault.angle fault.offset""",
    "a number that something is called by, or drawn from": "seed surface.index track.scatter_seed",
    "digits that are asked for": "numerics.rtol numerics.force_accuracy",
    "a bearing begins as it turns, not at rest": "ball-bearing:settling roller-bearing:settling",
    "an exponent, as any has a shape": "inner_raceway.fall",
    "beams rest on soft springs, too": "beam.support_stiffness",
    "they span nine decades": "wear_coefficient",
    "naphthenic oils have an index near zero": "lubricant.viscosity_index",
    "oils are cold, too": "lubricant.temperature",
    "the check presses samples, or bends the beam, and says so":
        "contact.approaches beam.suspension_frequency",
}  # fmt: skip
HARMLESS_LARGE = {
    "a number that something is called by, or drawn from": "seed surface.index track.scatter_seed",
    "as good as the same all across": "surface.lateral",
    "a track has no end": "wheel-on-rail:start",
    "what it takes is told": "wheel-on-rail:duration",
    "digits that are asked for": "numerics.rtol",
    "nothing times anything": "noise.receiver_offset sideways.wheel_shift",
    "stiffer is as good as rigid": "beam.support_stiffness tilt_stiffness",
    "they span nine decades": "wear_coefficient",
    "housings of small bearings weigh as much as a machine": "housing.mass",
}
SAME = {"wheel": "ball", "body": "ball", "rollers": "balls", "outer_raceway": "inner_raceway"}
SAME |= {"balls": "inner_raceway"}
"""Sections whose keys are those of another one, and judged as they are."""


def role(dotted):
    """A key by the section whose keys are the same."""
    section, dot, name = dotted.rpartition(".")
    while section in SAME:
        section = SAME[section]
    return f"{section}{dot}{name}"


def context(kind, dotted):
    """Keys that stand beside one in its section, where that is named."""
    section, _, name = dotted.rpartition(".")
    here = (keys for title, keys in WITH.get(kind, {}).items() if title.partition(" ")[0] == section)
    return next((keys for keys in here if name in keys), None)


def numbers_of(kind):
    return [each for each in entries(case_class(kind)) if isinstance(each.key.one, Quantity | Number)]


def swept():
    """Each kind with keys of numbers that no kind before it has, or that stand in its contexts."""
    known = set()
    for kind in PRESETS:
        left_out = OF_A_FILE | CARRIED_AXIALLY | LONG_WORK | OF_OTHERS.get(kind, set())
        own = [each for each in numbers_of(kind) if each.dotted not in left_out]
        own = [each for each in own if role(each.dotted) not in known or context(kind, each.dotted)]
        own = list({role(each.dotted): each for each in reversed(own)}.values())
        known |= {role(each.dotted) for each in own if each.section}
        yield from ((kind, each) for each in reversed(own))


SWEPT = {(kind, each.dotted): each for kind, each in swept()}


def beside(kind, entry):
    """Keys that stand beside one in its section, where it is given; that with which it goes among them."""
    known = {each.dotted: each for each in entries(case_class(kind))}
    keys = dict(context(kind, entry.dotted) or {})
    companion, _, value = entry.key.goes_with.partition("=")
    companion = companion.partition(" or ")[0]
    if companion and companion not in keys:
        other = known[f"{entry.section}.{companion}".lstrip(".")]
        keys = {**beside(kind, other), companion: value or other.key.written_example, **keys}
    return keys


def with_key(kind, entry, value):
    """A case of a kind with a value of one key, and what stands beside it."""
    keys = deepcopy(BASES[kind])
    others = beside(kind, entry)
    if entry.section in ("surface", "fault") and others:
        keys[entry.section] = {}
    inside = keys.setdefault(entry.section, {}) if entry.section else keys
    inside |= {**others, entry.name: value}
    if "structure" in keys:
        keys["over"] = "structure"
    return keys


def usual(kind, entry):
    """Its value among what stands beside it, in the case, by default or as an example."""
    section = BASES[kind].get(entry.section, {}) if entry.section else BASES[kind]
    for keys in (context(kind, entry.dotted) or {}, section):
        if entry.name in keys:
            return keys[entry.name]
    return entry.key.written_example


def times(factor, value):
    """A value of a key, as in TOML, times a number."""
    if isinstance(value, list):
        return [times(factor, each) for each in value]
    if isinstance(value, str):
        number, _, unit = value.partition(" ")
        return f"{factor * float(number)!r} {unit}"
    return round(factor * value) if isinstance(value, int) else factor * value


def said(keys):
    """What is told of a case: why it is refused, or what of it is doubtful."""
    try:
        with PhysicsWarning.caught() as caught:
            ready = prepare_case(as_case(keys))
    except AsperityError as error:
        return {str(error)}
    return {str(each.message) for each in (*caught, *ready.caught)}


DOUBTS = {}
"""What is told of cases, by what stands in them: with the usual value of most keys that is the same one."""


@cache
def of_the_usual(kind, dotted):
    entry = SWEPT[kind, dotted]
    with PhysicsWarning.caught() as caught:
        case = as_case(with_key(kind, entry, usual(kind, entry)))
    if case.text not in DOUBTS:
        with PhysicsWarning.caught() as of_case:
            ready = prepare_case(case)
        DOUBTS[case.text] = {str(each.message) for each in (*of_case, *ready.caught)}
    return {str(each.message) for each in caught} | DOUBTS[case.text]


@pytest.fixture(autouse=True, scope="module")
def measured(tmp_path_factory):
    """Files that cases name."""
    source = np.random.default_rng(0)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path_factory.mktemp("measured"))
        np.save("map.npy", 0.02 * source.standard_normal((90, 60)))
        np.save("lines.npy", 0.02 * source.standard_normal((3, 8000)))
        np.savetxt("pad.csv", [[10.0, 200.0, 0.1], [100.0, 220.0, 0.1], [1000.0, 260.0, 0.12]], delimiter=",",
                   header="frequency (Hz), stiffness (MN/m), loss factor", comments="")  # fmt: skip
        yield


@pytest.mark.parametrize("factor", [1e3, 1e-3])
@pytest.mark.parametrize(("kind", "entry"), [
    pytest.param(kind, entry, id=f"{kind} {dotted}") for (kind, dotted), entry in SWEPT.items()
])  # fmt: skip
def test_a_size_a_thousand_times_off_is_refused_or_doubted_or_named_here(kind, entry, factor):
    larger = factor > 1.0
    harmless = HARMLESS_LARGE if larger else HARMLESS_SMALL
    named = [
        reason
        for reason, keys in harmless.items()
        if {entry.dotted, role(entry.dotted), f"{kind}:{entry.dotted}"} & set(keys.split())
    ]
    value = usual(kind, entry)
    told = said(with_key(kind, entry, times(factor, value))) - of_the_usual(kind, entry.dotted)
    assert bool(told) is not bool(named), (value, told, named)
