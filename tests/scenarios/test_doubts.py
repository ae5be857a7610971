"""Sizes that are wrong by a thousand are doubted by the check; defaults and templates are not."""

import re
from pathlib import Path

import numpy as np
import pytest

import small_cases
from asperity.case import PRESETS
from asperity.case.any_case import entries
from asperity.case.cases import as_case, demo_case, parse_case, template
from asperity.cli import main
from asperity.contact.batched import UNTRIED, processor
from asperity.errors import OutOfRangeWarning, PhysicsWarning
from asperity.reference.railways import TRACKS
from asperity.running import prepare_case
from asperity.surfaces.heightmap import HeightMap

BALL, BEARING = small_cases.BALL | {"settling": "50 ms"}, small_cases.BEARING
DENT = {"shape": "dent", "on": "outer", "length": "1 mm", "depth": "1 mm"}
BODIES = small_cases.BODIES | {"laws": ["linear"], "settling": "50 ms"}
BOGIE = {"type": "bogie", "mass": "0.5 kg", "masses": ["4 kg"], "springs": ["20 kN/m"], "distance": "100 mm"}
CHAIN = {"type": "chain", "mass": "0.5 kg", "masses": ["0.1 kg", "4 kg"], "load": "60 N"}
CHAIN |= {"springs": ["20 kN/m", "100 N/m"], "dampers": ["5 N s/m", "5 N s/m"]}
WHEEL = small_cases.HEARD | {"kind": "wheel-on-rail", "laws": ["hertz"], "surface": {"smooth": True}}
WHEEL |= {"wheel": {"section": "rigid"}, "duration": "20 ms"}

NU205 = {
    "kind": "roller-bearing",
    "bearing": {"name": "NU205"},
    "axial": "0 N",
    "radial": "2 kN",
    "laws": ["areal"],
}


def doubts(case):
    """What is told of sizes when a case is laid ready."""
    with PhysicsWarning.caught() as caught:
        ready = prepare_case(case)
    return [str(each.message) for each in (*caught, *ready.caught)]


def test_a_device_on_which_nothing_was_ever_run_is_told(monkeypatch):
    """In help, in what a check and a run doubt, and in the documentation."""
    root = Path(__file__).parents[2]
    monkeypatch.setattr("asperity.scenarios.doubts.find_device", processor)
    assert [each for each in doubts(as_case(BALL)) if UNTRIED in each and "processor, numpy" in each]
    for command in (main.commands[name] for name in ("check", "run", "study", "fit", "optimise")):
        (help_of,) = [each.help for each in command.params if "--device" in each.opts]
        assert UNTRIED in help_of
    for page in ("docs/start/index.md", "docs/extend/decisions.md", "benchmarks/README.md"):
        told = " ".join((root / page).read_text(encoding="utf-8").split()).lower()
        assert UNTRIED in told, page


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        (BALL | {"ball": {"load": "30 N", "mass": "0.5 g"}}, "ball.mass = 0.0005 kg: a solid ball of its"),
        (
            BALL | {"ball": {"load": "30 N", "mass": "514 kg"}},
            "ball.load = 30 N: .* weighs 5.04 kN",
        ),
        (
            BALL | {"contact": BALL["contact"] | {"damping": "1 MN s/m"}},
            "contact.damping = 1 MN s/m: crit",
        ),
        (BALL | {"surface": BALL["surface"] | {"rms": "0.04 nm"}}, "surface.rms = 0.04 nm: the smoothest"),
        (
            BALL | {"surface": {"rms": "18 um", "longest": "0.4 mm", "shortest": "0.2 mm"}},
            r"Heights of 1\d\.?\d* µm rms within the window are 1\d.* each: they touch at single peaks, "
            r"which would yield, and laws were compared up to 10\. Are load and heights in the right units\?",
        ),
        (
            BALL | {"surface": {"corrugation": "1 um", "corrugation_wavelength": "40 m"}},
            "surface.corrugation_wavelength = 40000 mm: it is passed at 0.025 Hz",
        ),
        (BALL | {"surface": BALL["surface"] | {"longest": "0.4 m"}}, "surface.longest = 400 mm: 0.07 m are"),
        (
            BALL | {"contact": BALL["contact"] | {"sample_length": "80 mm", "samples": 1}},
            "contact.sample_length = 80 mm: 0.07 m are rolled, and the window is 0.66 mm wide",
        ),
        (
            BALL
            | {
                "laws": ["linear"],
                "contact": {},
                "ball": {"load": "40 kN"},
                "surface": {"spectrum": "iso3095"},
            },
            r"ball.load = 40 kN: smooth bodies press with 5\.\d+ GPa, and dents begin",
        ),
        (WHEEL | {"speed": "200 m/s"}, "speed = 200 m/s: no train has run faster than 160 m/s, 575 km/h"),
        (WHEEL | {"speed": "720 km/h"}, "speed = 720 km/h: no train has run faster than 160 m/s, 575 km/h"),
        (WHEEL | {"track": {"ballast_stiffness": "150 kN/m"}}, "The rail yields by 4\\d.* mm under a wheel"),
        (
            BEARING | {"inner_raceway": {"roughness": "50 nm", "longest": "500 mm"}},
            "inner_raceway.longest = 500 mm: 123 mm are around, which hold less than that roughness",
        ),
        (BEARING | {"radial": "0.1 N"}, "radial = 0.1 N: shaft.mass alone weighs 9.81 N"),
        (BEARING | {"shaft": {"mass": "1 g"}}, "shaft.mass = 0.001 kg: one of its 9 balls has 2.06 g"),
        (BEARING | {"housing": {"mass": "60 t"}}, "housing.mass = 60000 kg"),
        (BEARING | {"contact_damping": "20 kN s/m"}, "contact_damping = 20000 N s/m: critical damping"),
        (
            BEARING | {"fault": BEARING["fault"] | {"width": "18 mm"}},
            "fault.width = 18 mm: balls have a diameter of 7.9",
        ),
        (
            BEARING | NU205 | {"fault": BEARING["fault"] | {"width": "9 mm"}},
            "fault.width = 9 mm: rollers have a length of 7.8 mm",
        ),
        (
            BEARING | NU205 | {"fault": BEARING["fault"] | {"depth": "3.8 mm"}},
            "fault.depth = 3.8 mm: rollers have a diameter of 7.5 mm",
        ),
        (
            BEARING | {"fault": DENT},
            "fault.depth: the dent on the outer raceway stands out by 222 µm, .* which is .* µm. Is the unit",
        ),
        (
            BEARING | {"fault": DENT | {"shape": "particle", "on": "ball"}},
            "fault.depth: the particle on the balls stands out by 1000 µm, .* times the approach of the most",
        ),
        (
            BEARING | {"fault": DENT | {"shape": "pit", "burr": "0.2 mm", "on": "inner"}},
            "fault.burr: the pit on the inner raceway stands out by 200 µm",
        ),
        (
            BEARING | {"fault": [BEARING["fault"], BEARING["fault"] | {"angle": "90 deg", "depth": "50 nm"}]},
            r"fault\[2\].depth = 0.05 um: dents, pits and spalls have 0.5 um to 10 mm",
        ),
        (BODIES | {"body": BOGIE | {"load": "10 N"}}, "body.load = 10 N: .* weighs 24.5 N"),
        (
            BODIES | {"body": CHAIN},
            "body.springs = 100 N/m: the mass above it presses it down by 0.392 m",
        ),
        (BEARING | {"laws": ["linear"]}, "linear: up to 7 of 9 balls carry nothing, and there it pulls"),
        (BEARING | {"balls": {"roughness": "0.02 nm"}}, "balls.roughness = 0.02 nm"),
        (BEARING | {"time_step": "20 us"}, "the resonance of the most loaded ball .* time steps in a period"),
    ],
)
def test_a_size_in_a_wrong_unit_is_doubted_with_what_it_is_beside(keys, words):
    told = doubts(as_case(keys))
    assert any(re.search(words, each) for each in told), told


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        (BEARING | {"fault": DENT | {"shape": "pit", "depth": "0.28 mm"}}, "stands out"),
        (BEARING | {"fault": DENT | {"depth": "10 um"}}, "stands out"),
        (BALL | {"surface": {"rms": "8 um", "longest": "0.4 mm", "shortest": "0.2 mm"}}, "single peaks"),
    ],
)
def test_what_is_deep_or_rough_within_what_laws_cover_is_not_doubted(keys, words):
    assert not [each for each in doubts(as_case(keys)) if words in each]


def test_a_map_of_a_fault_that_stands_out_is_doubted():
    heights = np.zeros((21, 21))
    heights[8:13, 8:13] = 0.2e-3
    fault = {"on": "outer", "shape": "map", "map": HeightMap(heights, (50e-6, 50e-6))}
    (told,) = [each for each in doubts(as_case(BEARING | {"fault": fault})) if "stands out" in each]
    assert told.startswith("fault.map: the map on the outer raceway stands out by 200 µm")


def test_half_the_weight_of_a_bogie_is_on_each_of_its_contacts():
    """4 kg on two wheels of 0.5 kg: half of 24.5 N is less than 15 N, half of 44 N is more."""
    assert not [
        each for each in doubts(as_case(BODIES | {"body": BOGIE | {"load": "15 N"}})) if "load" in each
    ]


OF_A_TRACK = {
    "track": {
        "bending_stiffness": (None, r"a bar of steel that bends as easily for its mass is 5.92 mm high"),
        "pad_stiffness": ("hard pads have 3000 MN/m", "The rail yields by .* mm"),
        "ballast_stiffness": ("hard pads have 3000 MN/m", "The rail yields by .* mm"),
        "under_sleeper_pad_stiffness": ("hard pads have 3000 MN/m", "The rail yields by .* mm"),
        "subgrade_stiffness": ("hard pads have 3000 MN/m", "The rail yields by .* mm"),
        "pad_damping": ("spring beside it, 200 MN/m, at 1.77 Hz", "at 1.77·10⁶ Hz"),
        "ballast_damping": ("spring beside it, 150 MN/m, at 0.497 Hz", "at 497000 Hz"),
        "sleeper_bending_stiffness": (None, "a bar of steel that bends as easily for its mass is .* mm high"),
    },
    "sideways": {
        "pad_stiffness": ("the vertical one is 200 MN/m",) * 2,
        "ballast_stiffness": ("the vertical one is 150 MN/m",) * 2,
        "pad_roll_stiffness": ("that of an even pad under the foot is 0.375 MN m",) * 2,
        "bending_stiffness": (None, "a bar of steel .* is 2.84 mm high"),
        "shear_stiffness": ("waves of shear would run at 74400 m/s", "waves of shear would run at 74.4 m/s"),
        "torsional_stiffness": ("inertia of 0.279 kg m, would run at 25300 m/s", "would run at 25.3 m/s"),
        "polar_inertia": ("inertia of 280 kg m, would run at 25.3 m/s", "would run at 25300 m/s"),
        "rotary_inertia": ("its radius of gyration would be 815 mm", None),
    },
}


@pytest.mark.parametrize(
    ("section", "name", "words"),
    [(section, *each) for section, keys in OF_A_TRACK.items() for each in keys.items()],
)
def test_keys_of_a_track_in_a_wrong_unit_are_doubted_and_their_examples_are_not(section, name, words):
    """A thousand times its example and a thousandth; None where that is refused, or as good as none."""
    example, unit = next(
        (float(entry.key.example.split()[0]), entry.key.example.split(maxsplit=1)[1])
        for entry in entries(type(as_case(WHEEL)))
        if entry.dotted == f"{section}.{name}"
    )
    for times, told in ((1e3, words[0]), (1e-3, words[1]), (1.0, "")):
        if told is None:
            continue
        keys = {"track": {}, section: {name: f"{times * example:g} {unit}"}}
        found = [each for each in doubts(as_case(WHEEL | keys)) if "Is the unit right?" in each]
        assert bool(found) is bool(told), found
        assert not told or any(re.search(told, each) for each in found), found


@pytest.mark.parametrize("name", TRACKS)
def test_no_named_track_is_doubted(name):
    assert not [each for each in doubts(as_case(WHEEL | {"track": {"name": name}})) if "unit" in each]


@pytest.mark.parametrize("kind", [*PRESETS, "demo"])
def test_defaults_and_templates_are_not_doubted(kind):
    case = demo_case() if kind == "demo" else parse_case(template(kind, ()), "case.toml")
    with OutOfRangeWarning.caught() as caught:
        ready = prepare_case(case)
    assert [str(each.message) for each in (*caught, *ready.caught)] == []
