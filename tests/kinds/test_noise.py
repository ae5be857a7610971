"""Sound power of rolling by CNOSSOS-EU."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from asperity.errors import InputError
from asperity.reference import cnossos
from asperity.scenes.sound import SOURCES, SoundPower, rolling_sound_power

RAIL = cnossos.rail_roughness("iso3095")
DISC = cnossos.wheel_roughness("disc")
TRACK = cnossos.track_transfer("medium")
WHEEL = cnossos.wheel_transfer("920 mm")
FILTER = cnossos.contact_filter("50 kN, 920 mm")
MATCHED = 10.0**1.7  # m/s: frequency bands fall on wavelength bands, 1 kHz on 50 mm


def band(power, frequency):
    return power.levels[:, np.argmin(np.abs(power.band - frequency))]


def test_levels_by_hand_where_bands_match():
    # 1 kHz at 50.1 m/s is 50 mm: rail −1.1 dB, disc-braked wheel −1.6 dB, filter −1.1 dB,
    # medium pad 104.4 dB, wheel 94.9 dB, four axles
    power = rolling_sound_power(MATCHED, RAIL, DISC, TRACK, WHEEL, contact_filter=FILTER, axles=4)
    # 10^-0.11 + 10^-0.16 = 0.77625 + 0.69183 = 1.46808, 1.667 dB; −1.1 dB; 10 lg 4 = 6.021 dB: 6.588 dB
    assert_allclose(band(power, 1000.0)[:2], [6.588 + 104.4, 6.588 + 94.9], atol=1e-3)
    # the wheel, 9.5 dB below the track, adds 10 lg(1 + 10^-0.95) = 0.462 dB
    assert_allclose(band(power, 1000.0)[2], 6.588 + 104.4 + 0.462, atol=1e-3)
    assert SOURCES == ("track", "wheel", "total")


def test_levels_by_hand_between_two_bands():
    # half a band faster: 1 kHz takes half of 50 mm (−1.1 dB) and half of 63 mm (0.9 dB)
    power = rolling_sound_power(10.0**1.75, RAIL, None, TRACK, WHEEL)
    # (10^-0.11 + 10^0.09)/2 = (0.77625 + 1.23027)/2 = 1.00326, 0.014 dB
    assert_allclose(band(power, 1000.0)[0], 0.014 + 104.4, atol=1e-3)


def test_smooth_wheel_and_smooth_rail():
    both, rail, wheel = (
        rolling_sound_power(MATCHED, r, w, TRACK, WHEEL)
        for r, w in ((RAIL, DISC), (RAIL, None), (None, DISC))
    )
    energy = 10.0 ** (rail.levels[0] / 10) + np.nan_to_num(10.0 ** (wheel.levels[0] / 10))
    assert_allclose(both.levels[0], 10 * np.log10(energy), rtol=1e-12)


def test_bands_without_roughness_are_unknown_and_left_out():
    # the wheel's table begins at 1 m: at 100 m/s nothing is known below 100 Hz
    power = rolling_sound_power(100.0, None, DISC, TRACK, WHEEL)
    assert np.isnan(power.levels[:, power.band < 90.0]).all()
    assert np.isfinite(power.levels[:, power.band > 90.0]).all()
    assert np.isfinite(power.a_weighted).all()


def test_order_and_nominal_centres_do_not_matter():
    reversed_rail = (RAIL[0][::-1], RAIL[1][::-1])
    exact = (10.0 ** (np.rint(10 * np.log10(TRACK[0])) / 10), TRACK[1])
    a = rolling_sound_power(56.0, RAIL, DISC, TRACK, WHEEL)
    b = rolling_sound_power(56.0, reversed_rail, DISC, exact, WHEEL)
    assert_allclose(a.levels, b.levels, rtol=1e-14)


def test_a_weighted_total_of_one_band():
    # IEC 61672-1: 0 dB at 1 kHz, −8.6 dB at 250 Hz, +1.0 dB at 4 kHz (table values, rounded to 0.1 dB)
    for frequency, weight in ((1000.0, 0.0), (10.0**2.4, -8.6), (10.0**3.6, 1.0)):
        power = SoundPower(np.array([frequency]), np.array([[100.0], [90.0], [100.4]]))
        assert_allclose(power.a_weighted, np.array([100.0, 90.0, 100.4]) + weight, atol=0.06)


def test_a_uniform_difference_moves_everything():
    power = rolling_sound_power(56.0, RAIL, DISC, TRACK, WHEEL)
    louder = power.with_difference(TRACK[0], np.full(24, 3.0))
    assert_allclose(louder.levels, power.levels + 3.0)
    assert_allclose(louder.a_weighted, power.a_weighted + 3.0)


def test_a_difference_moves_its_bands_only():
    power = rolling_sound_power(56.0, RAIL, DISC, TRACK, WHEEL)
    changed = power.with_difference([10.0**2.7, 1000.0, 20e3], [-2.0, np.nan, 5.0])
    moved = changed.levels - power.levels
    assert_allclose(moved[:, np.argmin(np.abs(power.band - 500.0))], -2.0)
    assert np.count_nonzero(np.abs(moved) > 1e-9) == 3


def test_faster_is_louder():
    slow, fast = (
        rolling_sound_power(v, RAIL, DISC, TRACK, WHEEL, contact_filter=FILTER) for v in (20.0, 80.0)
    )
    assert (fast.a_weighted > slow.a_weighted + 10.0).all()


GAP = (np.delete(RAIL[0], 20), np.delete(RAIL[1], 20))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"speed": 0.0}, "speed"),
        ({"axles": 0}, "number of axles"),
        ({"rail_roughness": None, "wheel_roughness": None}, "the rail, the wheel or both"),
        ({"rail_roughness": GAP}, "rail roughness: received missing or repeated bands"),
        ({"wheel_roughness": (DISC[0], DISC[1][:-1])}, "wheel roughness.*one finite level per band"),
        ({"wheel_roughness": (-DISC[0], DISC[1])}, "band centres"),
        ({"wheel_transfer": (WHEEL[0][1:], WHEEL[1][1:])}, "the bands of the track transfer"),
        ({"contact_filter": (FILTER[0][5:], FILTER[1][5:])}, "contact filter.*every band of the roughness"),
    ],
)
def test_bad_input(change, message):
    arguments = {
        "speed": 56.0,
        "rail_roughness": RAIL,
        "wheel_roughness": DISC,
        "track_transfer": TRACK,
        "wheel_transfer": WHEEL,
    }
    with pytest.raises(InputError, match=message):
        rolling_sound_power(**(arguments | change))


def test_bad_difference():
    power = rolling_sound_power(56.0, RAIL, DISC, TRACK, WHEEL)
    for centres, values in (([1000.0], [1.0, 2.0]), ([1000.0], [np.inf])):
        with pytest.raises(InputError, match="difference of force levels"):
            power.with_difference(centres, values)
