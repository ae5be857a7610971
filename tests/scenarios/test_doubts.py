"""Sizes that are wrong by a thousand are doubted by the check; defaults and templates are not."""

import re
from pathlib import Path

import pytest

import small_cases
from asperity.case import PRESETS
from asperity.case.cases import as_case, demo_case, parse_case, template
from asperity.cli import main
from asperity.contact.batched import UNTRIED, processor
from asperity.errors import OutOfRangeWarning, PhysicsWarning
from asperity.running import prepare_case

BALL, BEARING = small_cases.BALL | {"settling": "50 ms"}, small_cases.BEARING
WHEEL = small_cases.HEARD | {"kind": "wheel-on-rail", "laws": ["hertz"], "surface": {"smooth": True}}


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
            BALL | {"surface": {"corrugation": "1 um", "corrugation_wavelength": "40 m"}},
            "surface.corrugation_wavelength = 40000 mm: it is passed at 0.025 Hz",
        ),
        (BALL | {"surface": BALL["surface"] | {"longest": "0.4 m"}}, "surface.longest = 400 mm: 0.07 m are"),
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
            "fault.width = 18 mm: balls are 7.9",
        ),
        (BEARING | {"laws": ["linear"]}, "linear: up to 7 of 9 balls carry nothing, and there it pulls"),
        (BEARING | {"balls": {"roughness": "0.02 nm"}}, "balls.roughness = 0.02 nm"),
        (BEARING | {"time_step": "20 us"}, "the resonance of the most loaded ball .* time steps in a period"),
    ],
)
def test_a_size_in_a_wrong_unit_is_doubted_with_what_it_is_beside(keys, words):
    told = doubts(as_case(keys))
    assert any(re.search(words, each) for each in told), told


@pytest.mark.parametrize("kind", [*PRESETS, "demo"])
def test_defaults_and_templates_are_not_doubted(kind):
    case = demo_case() if kind == "demo" else parse_case(template(kind, ()), "case.toml")
    with OutOfRangeWarning.caught() as caught:
        ready = prepare_case(case)
    assert [str(each.message) for each in (*caught, *ready.caught)] == []
