"""A time step that the case leaves to the program is never doubted by the program."""

import json
import math
import warnings
from types import SimpleNamespace

import numpy as np
import pytest

import asperity
from asperity.case.cases import as_case
from asperity.case.time_steps import _resonance, longest_step
from asperity.errors import PhysicsWarning
from asperity.running import prepare_case
from asperity.scenarios.prepared_bearing import prepare_bearing
from asperity.scenarios.preparing import doubt_time_step
from asperity.scenes.computed_bearing import compute_bearing

BRIEF = {"settling": "50 ms", "surface": {"smooth": True}, "laws": ["hertz"]}
ON_RAIL = BRIEF | {"duration": "0.1 s", "contact": {"spacing": "1 mm"}}
WHEEL = ON_RAIL | {"kind": "wheel-on-rail", "wheel": {"section": "rigid"}}
BALL = BRIEF | {"kind": "ball-on-beam", "duration": "60 ms", "start": "0.4 m", "ball": {"load": "50 N"}}
BOGIE = {"type": "bogie", "distance": "2.5 m", "masses": ["3000 kg"], "springs": ["1.2 MN/m"]}
BOGIE |= {"radius": "0.46 m", "transverse_radius": "inf", "mass": "600 kg", "load": "65 kN"}
COARSE = {
    "a wheel, by the resonance of its contact": WHEEL
    | {"numerics": {"highest_frequency": "300 Hz", "kernel": "scatter"}},
    "a fast wheel, by sleepers": WHEEL
    | {
        "speed": "150 m/s",
        "numerics": {"highest_frequency": "300 Hz", "kernel": "scatter"},
        "track": {"pad_stiffness": "3 GN/m"},
    },
    "a bogie on a track": ON_RAIL
    | {"kind": "bodies", "over": "track", "speed": "50 m/s", "body": BOGIE}
    | {"numerics": {"highest_frequency": "200 Hz", "kernel": "scatter"}},
    "modes of a beam": BALL | {"numerics": {"highest_frequency": "500 Hz"}, "beam": {"modes_up_to": "9 kHz"}},
    "a ball on a light beam": BALL
    | {"numerics": {"highest_frequency": "500 Hz"}, "beam": {"width": "10 mm", "height": "5 mm"}},
}
DOUBT = "time steps in a period", "softening"


def foreseen(case):
    """What a check says of the time step."""
    with PhysicsWarning.caught() as caught:
        doubt_time_step(prepare_case(case))
    return [str(each.message) for each in caught]


@pytest.mark.parametrize("name", COARSE)
def test_a_time_step_by_default_is_doubted_neither_by_the_check_nor_by_the_run(name):
    """Coarse spectra ask for a step by which contact, modes or sleepers would be lost."""
    case = as_case(COARSE[name])
    assert case.usual_step > case.time_step  # it is not the spectra that ask for it
    assert foreseen(case) == []
    assert foreseen(case.with_(**{"numerics.time_step": case.usual_step})) or case.over_name == "beam"
    if case.kind == "wheel-on-rail":
        return  # the check has all that the run looks at
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        tree = asperity.run(case, brief=True)
    told = [each["message"] for each in json.loads(tree.attrs["warnings"])]
    assert not [message for message in told if any(words in message for words in DOUBT)]


@pytest.mark.parametrize(("keys", "step"), [(WHEEL, 1 / 40e3), (BALL, 1e-5)])
def test_a_step_that_resolves_all_is_as_long_as_it_was(keys, step):
    """Near 1/(8 f) of a wheel and 1/(20 f) elsewhere, with positions on the grid of the contact."""
    case = as_case(keys)
    assert case.time_step == case.usual_step == pytest.approx(step, rel=0.3)
    assert case.time_step < longest_step(case, case.time_step)


@pytest.mark.parametrize(
    "rings",
    [
        {"housing.mass": "60 mg"},
        {"housing.lobes": 20, "housing.thickness": "0.5 mm"},
    ],
)
def test_the_default_step_of_a_bearing_follows_light_rings_and_their_modes(rings):
    """A ball has 2.1 g: the contact with such a ring is stiffer against both than balls are between rings."""
    keys = {"kind": "ball-bearing", "speed": "18000 1/min", "radial": "300 N", "axial": "300 N"}
    keys |= {"bearing": {"name": "6205"}, "laws": ["hertz"], "duration": "5 ms", "settling": "0.1 ms"}
    heavy = as_case(keys)
    case = heavy.with_(**rings)
    assert case.step < heavy.step
    with PhysicsWarning.caught() as caught:
        compute_bearing(prepare_bearing(case), lambda *done: None)
    assert not [each for each in caught if any(words in str(each.message) for words in DOUBT)]


def test_the_default_step_of_a_bearing_has_four_to_a_period_of_the_highest_lobe():
    """A thin ring: n (n² − 1)/√(n² + 1) √(EI/(ρA R⁴))/2π, R to the middle of its section."""
    keys = {"kind": "ball-bearing", "speed": "18000 1/min", "radial": "300 N", "bearing": {"name": "6205"}}
    case = as_case(keys | {"housing": {"lobes": 20, "thickness": "3 mm", "mass": "1 kg"}})
    bearing, n = case.bearing.bearing, 20
    radius = bearing.raceway_radii[1] + 1.5e-3
    bending = math.sqrt(bearing.material.youngs_modulus / bearing.material.density / 12.0) * 3e-3 / radius**2
    highest = n * (n**2 - 1) / math.sqrt(n**2 + 1) * bending / (2.0 * math.pi)
    assert 0.5 < 4.0 * highest * case.step <= 1.0


def test_a_step_that_is_chosen_is_found_anew_on_another_grid():
    case = as_case(BALL | {"contact": {}})
    before = case.time_step
    finer = case.with_chosen(contact=case.contact.with_chosen(spacing=0.3 * case.contact.spacing))
    assert finer.time_step != before
    cells = finer.time_step * finer.speed / finer.contact.spacing
    assert max(cells, 1.0 / cells) == pytest.approx(round(max(cells, 1.0 / cells)), rel=1e-9)


def test_what_follows_of_keys_is_found_anew_when_they_are_chosen():
    case = as_case(BALL | {"contact": {}})
    worked_out = {"smooth_contact", "contact_resonance", "room", "rolled_range", "rolled_time", "chosen_step"}
    assert case.time_step == case.chosen_step
    assert worked_out <= vars(case).keys()
    heavier = case.with_chosen(ball=case.ball.with_known(mass=2.0 * case.ball.contact_mass))
    assert heavier.contact_resonance == pytest.approx(case.contact_resonance / math.sqrt(2.0))
    assert heavier.ball.contact_mass == 2.0 * case.ball.contact_mass
    later = case.with_known(settling=0.5 * case.settled_time)
    assert later.settled_time == 0.5 * case.settled_time
    assert later.rolled_range[0] == pytest.approx(later.record_start - later.speed * later.settled_time)


def test_contacts_are_told_from_the_foremost_on():
    body = BOGIE | {"positions": ["0 m", "4 m", "9 m"]}
    uneven = as_case(ON_RAIL | {"kind": "bodies", "over": "track", "speed": "50 m/s", "body": body})
    assert uneven.contacts_behind == pytest.approx((0.0, 2.5, 5.0, 7.5, 9.0, 11.5))


@pytest.mark.parametrize("contacts", [1, 2, 4])
def test_the_resonance_of_several_contacts_on_one_mode_is_that_of_their_masses(contacts):
    """Masses m, each on a spring k on one mass M that is free: the fastest of them move against it."""
    m, k, other = 0.07, 3e7, 0.4
    stiffness = k * np.eye(contacts + 1)
    stiffness[-1, :-1] = stiffness[:-1, -1] = -k
    stiffness[-1, -1] = contacts * k
    mass = np.array([m] * contacts + [other])
    fastest = np.linalg.eigvalsh(stiffness / np.sqrt(np.outer(mass, mass)))[-1]
    case = SimpleNamespace(rolling=SimpleNamespace(contact_mass=m, offsets=(0.0,) * contacts))
    assert _resonance(case, k, 1.0 / other) == pytest.approx(math.sqrt(fastest) / (2.0 * math.pi), rel=1e-12)
