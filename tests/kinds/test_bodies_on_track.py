"""Bodies over a track have what a wheel on a rail has: its answers, and those of coupled wheels."""

import numpy as np
import pytest

import asperity
from asperity.scenarios.textures import other_contacts, textures_of
from asperity.scenes.schema import (
    LINEAR_REFERENCE_LEVEL,
    PASS_BY_MAXIMUM_LEVEL,
    POINT_VELOCITY_LEVEL,
    RADIATED_POWER_LEVEL,
    SOUND_POWER_LEVEL_A,
)
from asperity.schema.spectra import FORCE_LEVEL
from asperity.surfaces.heightmap import Profile
from asperity.surfaces.synthesis import from_bands

pytestmark = pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")
SPEED, STEP = 30.0, 0.5e-3 / 30.0
BANDS = 10.0 ** (np.arange(-20, -4) / 10.0)
LINE = Profile(from_bands(40_000, 0.5e-3, BANDS, np.full(BANDS.size, -10.0), 3).heights, 0.5e-3)
SHARED = {
    "speed": SPEED, "start": 2.0, "duration": 0.3, "settling": 0.06, "laws": ["linear", "hertz"],
    "track": {"name": "nordborg", "points": [4.0]},
    "numerics": {"time_step": STEP, "highest_frequency": 2500},
    "contact": {"spacing": 0.5e-3, "window": 20e-3},
}  # fmt: skip
WHEEL = {"radius": 0.46, "mass": 600, "load": 65e3, "transverse_radius": "inf"}
BODY = {"radius": 0.46, "transverse_radius": "inf", "mass": 600, "load": 65e3}
BOGIE = BODY | {"type": "bogie", "distance": 2.5, "masses": [1500], "springs": [0.6e6], "dampers": [1e4]}
SURFACE = {"line": LINE, "continuation": "mirror"}


def rolled(body):
    return asperity.run({"kind": "bodies", "over": "track", "body": body, "surface": SURFACE} | SHARED)


@pytest.fixture(scope="module")
def wheel():
    return asperity.run({"kind": "wheel-on-rail", "wheel": WHEEL, "surface": SURFACE} | SHARED)


@pytest.fixture(scope="module")
def body():
    return rolled(BODY)


@pytest.fixture(scope="module")
def bogie():
    return rolled(BOGIE)


def held(tree, entry, **at):
    return tree[entry.path].sel(**at).values


@pytest.mark.parametrize(
    "entry",
    [
        FORCE_LEVEL,
        RADIATED_POWER_LEVEL,
        PASS_BY_MAXIMUM_LEVEL,
        POINT_VELOCITY_LEVEL,
        LINEAR_REFERENCE_LEVEL,
        SOUND_POWER_LEVEL_A,
    ],
    ids=lambda entry: entry.name,
)
def test_a_wheel_that_is_entered_as_a_body_answers_as_a_wheel(wheel, body, entry):
    np.testing.assert_allclose(held(body, entry), held(wheel, entry), atol=1e-6, equal_nan=True)


def test_coupled_wheels_follow_the_coupled_reference(bogie, body):
    """Where waves between the wheels interfere, one wheel by itself is decibels off."""
    fine = bogie["spectra/band"].values > 150.0
    force = held(bogie, FORCE_LEVEL, law="linear")
    off = (force - held(bogie, LINEAR_REFERENCE_LEVEL))[fine]
    alone = (force - held(body, LINEAR_REFERENCE_LEVEL))[fine]
    strongest = np.argmax(np.abs(alone))  # 800 Hz
    assert abs(off[strongest]) < 0.3 < 2.0 < abs(alone[strongest])
    assert np.sqrt(np.mean(off**2)) < 0.7 < 1.0 < np.sqrt(np.mean(alone**2))


def test_two_wheels_radiate_what_their_forces_ask_for(bogie, body):
    """In each band the power follows the sum of both mean squares."""
    for law in ("linear", "hertz"):
        forces = 10.0 ** (held(bogie, FORCE_LEVEL, law=law) / 10.0)
        both = 10.0 ** (bogie["spectra/contact_force_level"].sel(law=law).values / 10.0)
        power = held(bogie, RADIATED_POWER_LEVEL, law=law, radiator="sleepers")
        one = held(body, RADIATED_POWER_LEVEL, law=law, radiator="sleepers")
        change = 10.0 * np.log10(both.sum(axis=0)) - held(body, FORCE_LEVEL, law=law)
        np.testing.assert_allclose(both.mean(axis=0), forces, rtol=1e-9)
        missed = np.abs(power - one - change)[3:]  # where the spectrum within a band differs
        assert np.median(missed) < 0.2
        assert missed.max() < 1.5


def test_axles_of_a_vehicle_pass_one_after_the_other(bogie):
    passing = bogie["pass_by/axle_time"].values
    np.testing.assert_allclose(passing, [0.0, 2.5 / SPEED])


def test_sound_is_that_of_a_track():
    case = {"kind": "bodies", "over": "plane", "surface": SURFACE, "noise": {"wheel_width": 0.14}}
    with pytest.raises(asperity.errors.InputError, match=r"noise: .*rolled over a plane.*over = \"track\""):
        asperity.run(case)


FLAT = {"flat_depth": 0.1e-3, "flat_position": 1.0}


def test_a_flat_is_that_of_a_wheel():
    laws = {"laws": ["linear"], "duration": 0.1}
    wheel = asperity.run({"kind": "wheel-on-rail", "wheel": WHEEL | FLAT, "surface": SURFACE} | SHARED | laws)
    body = asperity.run(
        {"kind": "bodies", "over": "track", "body": BODY | FLAT, "surface": SURFACE} | SHARED | laws
    )
    forces = [tree["rolling/contact_force"].values for tree in (wheel, body)]
    np.testing.assert_allclose(forces[1], forces[0], rtol=1e-6, atol=1.0)
    assert forces[0].max() > 80e3


def test_one_wheel_of_several_has_a_flat():
    """It strikes when its own place of the circumference comes down, and the other wheel hardly feels it."""
    struck = rolled(BOGIE | FLAT | {"flat_contacts": [2]})
    sound = rolled(BOGIE)
    change = struck["rolling/contact_force"] - sound["rolling/contact_force"]
    change, time = np.abs(change.sel(law="hertz").values), struck["rolling/time"].values
    assert change[1].max() > 2.0 * change[0].max() > 0.0
    assert time[np.argmax(change[1] > 0.1 * change[1].max())] == pytest.approx(1.0 / SPEED, abs=2e-3)


def test_each_contact_bears_its_own_measured_line():
    around = round(2 * np.pi * 0.46 / 1e-3)
    angle = 2.0 * np.pi * np.arange(around) / around
    lines = 1e-6 * np.array([np.sin(7 * angle), np.cos(12 * angle)])
    body = BOGIE | {"line": lines, "line_spacing": 1e-3}
    case = asperity.Bodies(**{"over": "track", "body": body, "surface": SURFACE} | SHARED)
    first = textures_of(case)
    which, others = other_contacts(case, np.array([65e3, 65e3]))
    second = others[0].textures(first)
    assert which == [0, 1]
    for textures, line in zip((first, second), lines, strict=True):
        turn = textures.parts["wheel"][: 2 * around : 2]  # on every second of the finer points
        inside = slice(20, around - 20)  # the ends are made to meet
        np.testing.assert_allclose(turn[inside], (line - line.mean())[inside], atol=1e-8)
    np.testing.assert_allclose(first.line - first.parts["wheel"], second.line - second.parts["wheel"])


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ({"flat_depth": 1e-4, "flat_contacts": [3]}, r"flat_contacts: received 3; allowed: numbers up to 2"),
        ({"roughness": "disc", "line": np.zeros(2900), "line_spacing": 1e-3}, "both roughness and line"),
        ({"line": np.zeros(900), "line_spacing": 1e-3}, r"body.line: received 0.9 m; allowed: a full turn"),
    ],
)
def test_textures_that_a_body_cannot_bear_are_refused(body, message):
    with pytest.raises((asperity.errors.InputError, asperity.errors.CaseError), match=message):
        rolled(BOGIE | body)
