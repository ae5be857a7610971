"""A run of a drawn wheel: as by the table of its modes, which turning splits, and its sound mode by mode."""

import numpy as np
import pytest

from asperity.case.wheel_on_rail import WheelOnRail
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
