"""How large one wave may be for the limit of a band: by the balance of all balls, and rolled."""

import json
import math

import numpy as np
import pytest

import asperity
from asperity import BallBearing
from asperity.diagnostics import ISO_BANDS
from asperity.errors import InputError
from asperity.structures.waviness_tolerance import ring_frequency, wave_tolerances
from command_line import call, words_of

BEARING = BallBearing.named("6205")
SPEED = 30.0
FOUND = BEARING.loaded(axial=150.0, speed=SPEED)
LIMITS = (50e-6, 30e-6, 20e-6)
TOLD = list(wave_tolerances(BEARING, FOUND, SPEED, LIMITS, ISO_BANDS, highest=3000.0))


def ring_motion(part, order, amplitude, time):
    """Radial motion of a free outer ring along one direction, from the balance of linear contacts."""
    turning = BEARING.kinematics(SPEED, contact_angle=FOUND.contact_angle)
    Z, cosine = BEARING.balls, math.cos(FOUND.contact_angle)
    psi = 2.0 * math.pi * (turning.cage * time[:, None] + np.arange(Z) / Z)
    if part == "ball":
        turned = 2.0 * math.pi * turning.spin * time
        waves = np.zeros(psi.shape)
        waves[:, 0] = amplitude * (np.cos(order * turned) + np.cos(order * (turned + math.pi)))
    else:
        waves = amplitude * np.cos(order * (psi - 2.0 * math.pi * turning.modulation(part) * time[:, None]))
    across = np.stack([np.cos(psi), np.sin(psi)], axis=-1) * cosine
    matrix = np.einsum("tzi,tzj->tij", across, across)
    return np.linalg.solve(matrix, np.einsum("tzi,tz->ti", across, waves)[..., None])[:, 0, 0]


@pytest.mark.parametrize(
    ("part", "order"), [("outer", 8), ("outer", 28), ("inner", 10), ("ball", 4), ("ball", 6)]
)
def test_the_amplitude_makes_the_limit_of_its_band(part, order):
    """Tones are found in the spectrum of the motion, and their velocities added up."""
    (each,) = (wave for wave in TOLD if (wave.part, wave.order) == (part, order))
    rate, duration = 20_000, 4.0
    time = np.arange(int(rate * duration)) / rate
    moved = ring_motion(part, order, each.amplitude, time)
    window = np.hanning(time.size)
    power = np.abs(np.fft.rfft((moved - moved.mean()) * window)) ** 2 / (rate * (window**2).sum())
    frequency = np.fft.rfftfreq(time.size, 1.0 / rate)
    inside = (frequency > each.band[0]) & (frequency < each.band[1])
    velocity = np.sqrt(2.0 * (power * (2.0 * np.pi * frequency) ** 2)[inside].sum() / duration)
    limit = LIMITS[ISO_BANDS.index(each.band)]
    assert velocity == pytest.approx(limit, rel=2e-3)
    assert frequency[np.argmax(power)] == pytest.approx(max(each.tones), abs=30.0)


def test_all_waves_that_are_heard_are_listed_and_no_other():
    """n = iZ ± 1 on raceways, even n on balls; below all bands, and beyond the highest, there is none."""
    outer = [wave.order for wave in TOLD if wave.part == "outer"]
    assert outer[:6] == [8, 10, 17, 19, 26, 28]
    assert all(order % 9 in (1, 8) for order in outer)
    turning = BEARING.kinematics(SPEED, contact_angle=FOUND.contact_angle)
    highest = 3045.0  # between the two waves of the inner ring beside 171
    every = list(wave_tolerances(BEARING, FOUND, SPEED, LIMITS, ISO_BANDS, highest=highest))
    for part in ("outer", "inner", "ball"):
        told = {wave.order for wave in every if wave.part == part}
        each = {order: turning.waviness(part, order, 1) for order in range(2, 400)}
        assert told == {order for order, tones in each.items() if any(50 <= tone < highest for tone in tones)}
    slow = list(wave_tolerances(BEARING, FOUND, 10.0, LIMITS, ISO_BANDS, highest=400.0))
    assert [wave.order for wave in slow if wave.part == "outer"][:2] == [17, 19]  # 36 Hz is below 50 Hz


def test_a_bearing_that_rolls_has_the_limit():
    """Ten waves of the amplitude that is allowed, on the outer raceway of a free ring."""
    (ten,) = (wave for wave in TOLD if (wave.part, wave.order) == ("outer", 10))
    case = asperity.BearingUnderLoad(
        speed=SPEED, axial=150.0, laws=["hertz"], duration=0.06, settling=0.02, bearing={"name": "6205"},
        shaft={"mass": 2.0, "radial_stiffness": 1e9, "axial_stiffness": 1e9},
        outer_raceway={"waves": [10], "amplitudes": [ten.amplitude]},
    )  # fmt: skip
    found = asperity.run(case, brief=True)["bearing/band_velocity"]
    assert float(found[0, 0, 0]) == pytest.approx(LIMITS[0], rel=0.03)


def test_a_ring_that_is_free_moves_on_its_balls():
    stiffness = FOUND.stiffness[:, 0, 0].mean()
    assert ring_frequency(FOUND, 0.06) == pytest.approx(math.sqrt(stiffness / 0.06) / (2.0 * math.pi))
    with pytest.raises(InputError, match="of 9 balls that touch; allowed: a load under which all touch"):
        next(wave_tolerances(BEARING, BEARING.loaded(radial=50.0), SPEED, LIMITS, ISO_BANDS))


def test_the_command_lists_them_and_says_how_they_add():
    words = (
        "bearing",
        "6205",
        "--axial",
        "150 N",
        "--speed",
        "1800 1/min",
        "--limits",
        "50 um/s, 30 um/s, none",
    )
    said = words_of(call(*words, "--outer-mass", "60 g").stdout)
    assert "outer ring 8 108.3 50 to 300" in said
    assert "up to 3530 Hz" in said
    assert "Energies of several add: of ten that are alike each may have a third." in said
    assert "1800 to 10000" not in said
    told = json.loads(call(*words, "--json").stdout)["tolerances"]
    assert told[0]["part"] == "outer"
    assert told[0]["amplitude"] == pytest.approx(TOLD[0].amplitude)
    assert max(each["order"] for each in told) == 100
    assert "With its --outer-mass those are left out" in call(*words).stdout


def test_limits_in_anderons_are_velocities():
    """A microinch for each radian at 1500 1/min, over the root of lb 6 octaves: 25.4 nm · 50π/s · 1.608."""
    words = "bearing", "6205", "--axial", "150 N", "--speed", "1500 1/min", "--json", "--limits"
    in_anderons = json.loads(call(*words, "2 anderon, 1 anderon, none").stdout)["tolerances"]
    one = 25.4e-9 * 50.0 * np.pi * np.sqrt(np.log2(6.0))
    as_velocities = json.loads(call(*words, f"{2.0 * one} m/s, {one} m/s, none").stdout)["tolerances"]
    assert [each["amplitude"] for each in in_anderons] == pytest.approx(
        [each["amplitude"] for each in as_velocities]
    )


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ("--limits", "many anderons, none, none"),
            "--limits: received 'many'; allowed: a number",
        ),
        (
            ("--limits", "5 um/s"),
            "--limits: received '5 um/s'; allowed: three velocities with units, in anderons",
        ),
        (("--limits", "5 um, 1 um/s, none"), "--limits: received 'um'; allowed: a unit that converts to m/s"),
        (("--limits", "0 um/s, 1 um/s, none"), "or none, as '50 um/s, 2 anderon, none', greater than 0"),
        (("--limits", "5 um/s, none, none", "--signal", "a.npy"), "--limits: received a signal, a picture"),
        (("--outer-mass", "60 g"), "--outer-mass: received '60 g'; allowed: --limits with it"),
        (("--limits", "5 um/s, none, none"), "speed: received none; allowed: a speed greater than 0"),
    ],
)
def test_limits_that_are_none_are_told(words, message):
    assert message in call("bearing", "6205", "--axial", "150 N", *words, code=2).stderr
