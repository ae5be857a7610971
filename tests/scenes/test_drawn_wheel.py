"""A run of a drawn wheel: as by the table of its modes, which turning splits, and its sound mode by mode."""

import numpy as np
import pytest

from asperity import Track, Wheel, wheel_modes
from asperity.case.bodies import WheelOnRail
from asperity.radiation.wheel import RadiatingWheel
from asperity.scenarios.scene import mean_square_transfer
from asperity.scenes import schema
from asperity.scenes.figures.noise import LOUDEST, wheel_table
from asperity.scenes.noise import mode_by_mode, radiating_wheel
from asperity.spectra import a_weighted_total
from asperity.structures.modal import modal_answers
from asperity.structures.outline import FINENESS, mean_thickness
from asperity.written_numbers import count_of
from small_cases import HEARD

CASE = HEARD | {"settling": "20 ms", "numerics": {"highest_frequency": "1.6 kHz", "kernel": "scatter"}}


def case_of(**wheel):
    return WheelOnRail(**CASE | {"wheel": {"roughness": "disc"} | wheel})


@pytest.fixture(scope="module")
def drawn(runs):
    return runs(case_of(section="curved-web"))


def test_the_table_of_a_drawn_wheel_gives_the_same_run_up_and_down(drawn, runs, tmp_path):
    path = case_of(section="curved-web").rolling.standing_modes(1600.0).write(tmp_path / "modes.csv")
    again = runs(case_of(modes=path))
    up = ["rail", "sleepers"]
    power, alone = (drawn["spectra"][f"{name}_power_level"] for name in ("radiated", "single_force"))
    found = again["spectra/radiated_power_level"]
    pairs = [
        (again["rolling/contact_force"], drawn["rolling/contact_force"]),
        (found.sel(radiator=up), power.sel(radiator=up)),
        (found.sel(radiator="wheel"), alone.sel(single_force="wheel, vertical force alone")),
        (found.sel(radiator="total"), alone.sel(single_force="vertical motion alone")),
    ]
    for there, expected in pairs:
        least = 1e-9 * np.abs(expected.values).max()
        np.testing.assert_allclose(there.values, expected.values, rtol=1e-9, atol=least)


def test_the_wheel_is_told_mode_by_mode(drawn):
    held = drawn["spectra"]
    level = held["wheel_mode_power_level_a"].values[0]
    wheel = held["radiated_power_level_a"].sel(radiator="wheel").values[0]
    assert 10.0 * np.log10(np.sum(10.0 ** (level / 10.0))) == pytest.approx(wheel, abs=1e-9)
    modes = case_of(section="curved-web").rolling.standing_modes(1600.0)
    assert held["wheel_mode_frequency"].values[1:] == pytest.approx(modes.natural_frequencies)
    assert held["wheel_mode_diameters"].values[1:].tolist() == modes.nodal_diameters.tolist()
    assert held["wheel_mode"].values.tolist() == list(range(len(level)))
    found = wheel_table(drawn)
    rows = [[cell.text for cell in row] for row in found.rows]
    loudest = int(np.argmax(level))
    assert rows[0][0] == f"{held['wheel_mode_frequency'].values[loudest]:.0f} Hz"
    assert rows[0][3] == f"{level[loudest]:.1f}"
    assert rows[-1][0] == count_of(len(level) - LOUDEST, "other")
    assert sum(float(row[-1]) for row in rows) == pytest.approx(100.0, abs=0.6)


def test_a_mode_radiates_in_the_band_in_which_it_rings():
    """Of one mode with nodal diameters, its two waves count as one mode."""
    case = case_of(modes=np.array([[950.0, 1e-3, 300.0, 3, 0.5, 0.7], [500.0, 1e-3, 300.0, 0, 0.5, 0.7]]))
    band = np.array([500.0, 1000.0])
    power = np.zeros((1, 4, 2))
    power[0, 1:3, 1], power[0, 3, 0] = 1e-6, 2e-6
    found = mode_by_mode(case, power, band, every=False)
    level = found[schema.WHEEL_MODE_POWER_LEVEL_A][0]
    assert level[0] == -np.inf
    assert level[1] == pytest.approx(63.0, abs=0.02)
    assert level[2] == pytest.approx(63.0 - 3.2, abs=0.1)


def test_modes_that_ring_off_the_middle_alone_are_told_where_the_contact_is():
    half = [[0.1, 0.08], [0.15, 0.08], [0.15, 0.015], [0.4, 0.015], [0.4, 0.06], [0.46, 0.06]]
    mirrored = np.vstack([half, (np.array(half) * [1.0, -1.0])[::-1]])
    aside = case_of(section=mirrored).with_(sideways={"contact_place": 0.015})
    heard = len(aside.rolling.standing_modes(1600.0).table(0.015))
    assert heard > len(aside.rolling.standing_modes(1600.0).table())
    power = np.ones((1, len(radiating_wheel(aside).axial), 1))
    found = mode_by_mode(aside, power, np.array([1000.0]), every=False)
    assert len(found[schema.WHEEL_MODE]) == heard + 1


# --- without rolling: sound of the linear contact per roughness, of two wheels on a track

BANDS = 10.0 ** (np.arange(28, 35) / 10.0)  # 630 Hz to 2.5 kHz
TRACK = Track.named("uic60")
SMOOTH = {"surface": {"smooth": True}, "numerics": {"highest_frequency": 2.5e3}}


def sound(modes):
    """A-weighted level of the wheel per roughness that is the same in all bands, dB."""
    table = modes.turning(30.0 / 0.46).table()
    wheel, radiator = Wheel(600.0, 65e3, *table[:, :3].T), RadiatingWheel(0.46, 0.135, *table[:, 3:].T)
    f = (BANDS[:, None] * 10.0 ** (0.1 * (np.arange(1000) - 499.5) / 1000.0)).ravel()
    force = mean_square_transfer(f, wheel.receptance, TRACK, 1.2e9, TRACK.places(3))
    omega = 2.0 * np.pi * f
    answer = modal_answers(f, *table[:, :2].T).T / table[:, 2:3]
    power = radiator.power(f, np.abs(omega * answer) ** 2 * force).sum(axis=0)
    power = power.reshape(len(BANDS), -1).mean(axis=1)
    return a_weighted_total(10.0 * np.log10(power), BANDS)


@pytest.mark.parametrize("section", ["straight-web", pytest.param("curved-web", marks=pytest.mark.long)])
def test_the_sound_has_converged(section):
    wheel = WheelOnRail(wheel={"section": section}, **SMOOTH).rolling
    usual = sound(wheel.standing_modes(2.5e3))
    outline, steel = wheel.outline, wheel.material
    finer = wheel_modes(outline, steel, 1.25 * 2.5e3, size=0.7 * FINENESS * mean_thickness(outline))
    assert sound(finer) == pytest.approx(usual, abs=0.3)
    assert sound(wheel_modes(outline, steel, 2.0 * 2.5e3)) == pytest.approx(usual, abs=0.3)


def test_dampers_make_a_wheel_quieter():
    """Wheel damping: D. J. Thompson, Railway Noise and Vibration (2009)."""
    wheels = ({"section": "curved-web", "added_damping": ratio} for ratio in (0.0, 1e-3, 1e-2))
    rolling = [WheelOnRail(wheel=wheel, **SMOOTH).rolling for wheel in wheels]
    bare, some, more = (sound(each.standing_modes(2.5e3)) for each in rolling)
    assert bare > some + 1.0
    assert some > more + 4.0
