"""A run of a drawn wheel: as by the table of its modes, which turning splits, and its sound mode by mode."""

import numpy as np
import pytest

from asperity.case.wheel_on_rail import WheelOnRail
from asperity.scenes import schema
from asperity.scenes.figures.wheel import LOUDEST, wheel_table
from asperity.scenes.noise import mode_by_mode
from asperity.structures.wheel import Wheel

CASE = {
    "laws": ["linear"],
    "duration": "0.2 s",
    "settling": "20 ms",
    "surface": {"spectrum": "iso3095"},
    "contact": {"spacing": "1 mm"},
    "numerics": {"highest_frequency": "1.6 kHz", "kernel": "scatter"},
}


def case_of(**wheel):
    return WheelOnRail(**CASE | {"wheel": {"roughness": "disc"} | wheel})


@pytest.fixture(scope="module")
def drawn(runs):
    return runs(case_of(section="curved-web"))


def test_the_table_of_a_drawn_wheel_gives_the_same_run(drawn, runs, tmp_path):
    path = case_of(section="curved-web").rolling.standing_modes(1600.0).write(tmp_path / "modes.csv")
    again = runs(case_of(modes=path))
    for group, name in (("rolling", "contact_force"), ("spectra", "radiated_power_level")):
        expected = drawn[group][name].values
        np.testing.assert_allclose(
            again[group][name].values, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max()
        )


def test_the_wheel_is_heard(drawn):
    assert drawn["spectra"]["radiated_power_level"].attrs["wheel"] == "computed"
    assert np.isfinite(drawn["spectra"]["radiated_power_level_a"].values).all()


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
    assert rows[-1][0] == f"{len(level) - LOUDEST} others"
    assert sum(float(row[-1]) for row in rows) == pytest.approx(100.0, abs=0.6)


def test_a_mode_radiates_in_the_band_in_which_it_rings():
    """Of one mode with nodal diameters, its two waves count as one mode."""
    case = case_of(modes=np.array([[950.0, 1e-3, 300.0, 3, 0.5, 0.7], [500.0, 1e-3, 300.0, 0, 0.5, 0.7]]))
    band = np.array([500.0, 1000.0])
    power = np.zeros((1, 4, 2))
    power[0, 1:3, 1], power[0, 3, 0] = 1e-6, 2e-6
    found = mode_by_mode(case, power, band)
    level = found[schema.WHEEL_MODE_POWER_LEVEL_A][0]
    assert level[0] == -np.inf
    assert level[1] == pytest.approx(63.0, abs=0.02)
    assert level[2] == pytest.approx(63.0 - 3.2, abs=0.1)


def test_turning_splits_the_resonances_of_the_run():
    """Seen from the contact, a mode with n nodal diameters answers at n times the turning speed beside it."""
    case = case_of(section="curved-web")
    standing, wheel = case.rolling.standing_modes(1600.0), case.rolling.tread(1600.0, case.speed)
    frequency = np.linspace(880.0, 1040.0, 3201)
    at = np.argmin(np.abs(standing.natural_frequencies - 960.0))
    n, shift = standing.nodal_diameters[at], case.speed / 0.46 / (2.0 * np.pi)
    answer = np.abs(wheel.receptance(frequency))
    peaks = frequency[1:-1][
        (answer[1:-1] > answer[:-2]) & (answer[1:-1] > answer[2:]) & (answer[1:-1] > 10 * np.median(answer))
    ]
    expected = standing.natural_frequencies[at] + n * shift * np.array([-1.0, 1.0])
    assert n == 3
    assert peaks == pytest.approx(expected, abs=0.1)
    still = Wheel(600.0, 65e3, *standing.table().T[:3])
    assert np.argmax(np.abs(still.receptance(frequency))) == np.argmin(
        np.abs(frequency - standing.natural_frequencies[at])
    )
