"""Sound power of rolling by CNOSSOS-EU."""

import numpy as np
from numpy.testing import assert_allclose

from asperity.reference import cnossos
from asperity.scenes.noise import SOURCES, rolling_sound_power
from asperity.spectra import a_weighted_total

RAIL = cnossos.rail_roughness("iso3095")
DISC = cnossos.wheel_roughness("disc")
TRACK = cnossos.track_transfer("medium")
WHEEL = cnossos.wheel_transfer("920 mm")
FILTER = cnossos.contact_filter("50 kN, 920 mm")
MATCHED = 10.0**1.7  # m/s: frequency bands fall on wavelength bands, 1 kHz on 50 mm


def band(power, frequency):
    centres, levels = power
    return levels[:, np.argmin(np.abs(centres - frequency))]


def total(power):
    return a_weighted_total(power[1], power[0])


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
    energy = 10.0 ** (rail[1][0] / 10) + np.nan_to_num(10.0 ** (wheel[1][0] / 10))
    assert_allclose(both[1][0], 10 * np.log10(energy), rtol=1e-12)


def test_bands_without_roughness_are_unknown_and_left_out():
    # the wheel's table begins at 1 m: at 100 m/s nothing is known below 100 Hz
    centres, levels = rolling_sound_power(100.0, None, DISC, TRACK, WHEEL)
    assert np.isnan(levels[:, centres < 90.0]).all()
    assert np.isfinite(levels[:, centres > 90.0]).all()
    assert np.isfinite(total((centres, levels))).all()


def test_order_and_nominal_centres_do_not_matter():
    reversed_rail = (RAIL[0][::-1], RAIL[1][::-1])
    exact = (10.0 ** (np.rint(10 * np.log10(TRACK[0])) / 10), TRACK[1])
    a = rolling_sound_power(56.0, RAIL, DISC, TRACK, WHEEL)
    b = rolling_sound_power(56.0, reversed_rail, DISC, exact, WHEEL)
    assert_allclose(a[1], b[1], rtol=1e-14)


def test_faster_is_louder():
    slow, fast = (
        rolling_sound_power(v, RAIL, DISC, TRACK, WHEEL, contact_filter=FILTER) for v in (20.0, 80.0)
    )
    assert (total(fast) > total(slow) + 10.0).all()
