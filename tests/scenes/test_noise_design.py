"""Design answers: what pads and speed do to the sound of rail and sleepers.

By the linear contact force in the frequency domain, on tracks of published parameters. The rules are those of
D. J. Thompson, Railway Noise and Vibration (Elsevier, 2009).
"""

import numpy as np
import pytest

from asperity.radiation.track import STEEL_DENSITY, RailSection, SleeperTop
from asperity.reference import cnossos
from asperity.scenarios.scene import force_transfer, mean_square_transfer
from asperity.spectra import HALF_BAND, a_weighted_total, energy_sum, third_octave_bands
from asperity.structures.body import Wheel
from asperity.structures.track import Track, decay_rate

CENTRES, LOW, HIGH = third_octave_bands(100.0, 5000.0)
LINES = 10
FREQUENCY = CENTRES[:, None] * 10.0 ** (0.1 * ((np.arange(LINES) + 0.5) / LINES - 0.5))
RAIL = RailSection(foot_width=0.15, head_width=0.072, area=60.2 / STEEL_DENSITY)
SLEEPER = SleeperTop(length=2.6, width=0.25)
WHEEL, STIFFNESS = Wheel(600.0, 65e3), 1.25e9
TRACKS = ("x2000", "nordborg", "uic60")


def roughness_psd(speed):
    """One-sided PSD, m³, of the limit of ISO 3095 with the contact filter of CNOSSOS-EU, at f/v."""
    wavelength, level = cnossos.rail_roughness("iso3095")
    _, filtered = cnossos.contact_filter("50 kN, 920 mm")
    exact = 10.0 ** (np.rint(10.0 * np.log10(wavelength)) / 10.0)
    energy = 1e-12 * 10.0 ** ((level + filtered) / 10.0) * exact / (HALF_BAND - 1.0 / HALF_BAND)
    order = np.argsort(exact)
    at = np.log(speed / FREQUENCY)
    return np.exp(np.interp(at, np.log(exact[order]), np.log(energy[order])))


def in_bands(track, speed=30.0):
    """Sound power levels of rail and sleepers in bands, dB re 1 pW, of one wheel."""
    lines, texture = FREQUENCY.ravel(), roughness_psd(speed).ravel()
    force = mean_square_transfer(lines, WHEEL.receptance, track, STIFFNESS, track.places(6)) * texture / speed

    def spread(x):
        return np.abs(force_transfer(lines, WHEEL.receptance, track, STIFFNESS, x)) ** 2

    found = []
    for part in (RAIL, SLEEPER):
        density = (force * part.power_per_force(track, lines, spread)).reshape(FREQUENCY.shape)
        found.append(10.0 * np.log10(density.mean(axis=1) * (HIGH - LOW) / 1e-12))
    return np.array(found)


def heard(track, speed=30.0):
    """The same, A-weighted and summed."""
    return a_weighted_total(in_bands(track, speed), CENTRES)


PADS = 60e6 * 2.0 ** np.arange(8)  # 60 MN/m to 7.7 GN/m
REAL = PADS < 2e9
"""Pads of ballasted tracks; the stiffer ones stand for none."""


@pytest.mark.parametrize("name", TRACKS)
def test_noise_against_pad_stiffness(name):
    """Stiffer pads: less of the rail, whose waves decay faster, more of the sleepers, a best pad between.

    Thompson; N. Vincent, P. Bouvet, D. J. Thompson, P. E. Gautier, J. Sound Vib. 193 (1996) 161-171.
    """
    found = np.array([heard(Track.named(name, pad_stiffness=pad, pad_loss_factor=0.2)) for pad in PADS])
    rail, sleepers = found[REAL].T
    assert (np.diff(rail) < -0.5).all()
    assert (np.diff(sleepers) > 1.0).all()
    assert rail[0] - rail[-1] > 6.0
    assert sleepers[-1] - sleepers[0] > 12.0
    assert rail[0] > sleepers[0] + 15.0
    total = energy_sum(found)
    best = int(total.argmin())
    assert 400e6 < PADS[best] < 4e9
    assert min(total[0], total[-1]) > total[best] + 1.0
    equal = np.exp(np.interp(0.0, sleepers - rail, np.log(PADS[REAL])))  # where both are as loud
    assert PADS[best] / 4.0 < equal < PADS[best] * 4.0


@pytest.mark.parametrize("name", TRACKS)
@pytest.mark.parametrize("pad", [150e6, 1200e6])
def test_noise_rises_by_about_30_lg_v(name, pad):
    """From 60 to 320 km/h on the roughness of ISO 3095. Thompson."""
    track = Track.named(name, pad_stiffness=pad, pad_loss_factor=0.2)
    speeds = np.geomspace(60.0, 320.0, 5) / 3.6
    total = [energy_sum(heard(track, speed=speed)) for speed in speeds]
    assert 25.0 < np.polyfit(np.log10(speeds), total, 1)[0] < 35.0


@pytest.mark.parametrize("name", TRACKS)
def test_rail_dampers_quieten_the_rail_alone(name):
    """The rail decays faster and is quieter, by the more the softer the pads; sleepers are as loud.

    D. J. Thompson, C. J. C. Jones, T. P. Waters, D. Farrington, Applied Acoustics 68 (2007) 43-57: some 6 dB
    of the track were measured. Softer pads gain more: M. G. R. Toward, G. Squicciarini, D. J. Thompson, Y.
    Gao, 11th International Workshop on Railway Noise (2013). Well below its frequency a damper is a mass,
    which lets waves run.
    """
    dampers = {"rail_damper_mass": 17.0, "rail_damper_frequency": 1000.0, "rail_damper_loss_factor": 0.35}
    gains = []
    for pad in (120e6, 800e6):
        pads = {"pad_stiffness": pad, "pad_loss_factor": 0.2}
        plain, damped = Track.named(name, **pads), Track.named(name, **pads, **dampers)
        rail, sleepers = heard(damped) - heard(plain)
        bands = CENTRES[(CENTRES > 950.0) & (CENTRES < 3000.0)]
        assert (decay_rate(damped, bands) > decay_rate(plain, bands)).all()
        assert abs(sleepers) < 0.5
        gains.append(-rail)
    assert gains[0] > gains[1]
    assert all(4.0 < gain < 12.0 for gain in gains)


@pytest.mark.parametrize("name", TRACKS)
def test_sleepers_are_heard_below_the_rail_and_less_if_they_are_heavy(name):
    """Sleepers lead at low frequency, the rail from 1 kHz on, in between by the pads. Thompson.

    Above its resonance a mass moves half as much if it is twice as heavy: 6 dB.
    """
    lead = []
    for pad in (120e6, 300e6, 800e6):
        pads = {"pad_stiffness": pad, "pad_loss_factor": 0.2}
        rail, sleepers = in_bands(Track.named(name, **pads))
        heavy = in_bands(Track.named(name, sleeper_mass=2.0 * Track.named(name).sleeper_mass, **pads))
        assert (sleepers - rail)[CENTRES < 260.0].min() > 5.0
        assert (rail - sleepers)[CENTRES > 950.0].min() > 10.0
        lead.append(CENTRES[sleepers > rail].max())
        np.testing.assert_allclose((heavy[1] - sleepers)[CENTRES > 950.0], -6.0, atol=0.5)
        total = a_weighted_total(np.array([[rail, sleepers], heavy]), CENTRES)
        assert total[0, 1] - total[1, 1] > 3.0
        assert abs(total[0, 0] - total[1, 0]) < 0.6
    assert lead[0] < lead[1] < lead[2]
