"""Ground with impedance, directivity and rails apart: against closed forms and the exact integral."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from asperity.radiation.pass_by import AxleSource, Passage, Receiver, divergence, exposure, squared_pressure
from asperity.radiation.sound_path import PorousGround, SoundPath
from asperity.radiation.track import wavenumber
from asperity.reference import cnossos
from asperity.reference.grounds import GROUNDS
from refusals import refusals

BAND = 10.0 ** (np.arange(17, 38) / 10.0)
HARD, GRASS = PorousGround(1e12), PorousGround(GROUNDS["grass"])
FLAT = Receiver(7.5, 0.0)


@pytest.mark.parametrize("resistivity", [80e3, 20e6])
def test_impedance_is_that_of_the_model_in_its_first_units(resistivity):
    """As C. I. Chessell prints it, σ in cgs units (J. Acoust. Soc. Am. 62 (1977) 825)."""
    x = 500.0 / (1e-3 * resistivity)
    printed = 1.0 + 9.08 * x**-0.754 - 11.9j * x**-0.732
    assert_allclose(PorousGround(resistivity).impedance(500.0), printed, rtol=0.01)


def test_grazing_incidence_and_hard_ground():
    # at grazing incidence far away nothing but −1/w² of the ground wave is left: w² = −ikRβ²/2
    f, far = 1000.0, 1e6
    admittance = 1.0 / GRASS.impedance(f)
    left = (1.0 + GRASS.reflection(f, 0.0, far)) * 1j * wavenumber(f) * far * admittance**2
    assert_allclose(left, 2.0, rtol=1e-4)
    assert_allclose(HARD.reflection(f, [0.0, 0.3, 1.0], 8.0), 1.0, atol=3e-3)
    assert abs(GRASS.reflection(f, 1.0, 8.0)) < abs(PorousGround(20e6).reflection(f, 1.0, 8.0)) < 1.0


def test_over_hard_ground_the_power_goes_above_it():
    """∫ |p|² dS over the half sphere is that of an even source."""
    sine, distance = 0.5 * (np.polynomial.legendre.leggauss(200)[0] + 1.0), 500.0
    band, around = BAND[BAND < 600.0], distance * np.sqrt(1.0 - sine**2)
    over = [
        HARD.inverse_square(band, (0.7, distance * s), np.array([r]))
        for s, r in zip(sine, around, strict=True)
    ]
    mean = 0.5 * np.polynomial.legendre.leggauss(200)[1] @ np.array(over)[:, :, 0]
    assert_allclose(mean * distance**2, 1.0, rtol=5e-3)
    low = HARD.inverse_square(BAND, (0.0, 1.2), np.array([7.5]))  # and right on the ground everywhere
    assert_allclose(low * (7.5**2 + 1.2**2), 1.0, rtol=5e-3)


def test_interference_within_a_band():
    """Over hard ground ½(1/R₁² + 1/R₂² + 2 ⟨cos kΔ⟩/R₁R₂)/(1 + sinc), the mean over lg f by quadrature."""
    source, receiver, away, centre = 0.5, 1.7, 7.5, 1000.0
    direct, bounced = np.hypot(away, receiver - source), np.hypot(away, receiver + source)
    f = centre * 10.0 ** np.linspace(-0.05, 0.05, 20_001)
    k = 2.0 * np.pi * f / 343.2
    square = 1.0 / direct**2 + 1.0 / bounced**2 + 2.0 * np.cos(k * (bounced - direct)) / (direct * bounced)
    expected = 0.5 * np.trapezoid(square / (1.0 + np.sin(k) / k), np.linspace(0.0, 1.0, len(f)))  # 2kh = k
    found = PorousGround(1e16).inverse_square(np.array([centre]), (source, receiver), np.array([away]))
    assert_allclose(found[0, 0], expected, rtol=1e-4)


def test_directivity_of_cnossos():
    """10 lg(0.01 + 0.99 sin²φ); upwards at 1.4 kHz 40/3 (⅔ sin 2ψ − sin ψ) times lg 10."""
    quarter = 0.5 * np.pi
    found = cnossos.directivity(
        [quarter, 0.0, quarter / 3, quarter, quarter, quarter], [0, 0, 0, -1, quarter, quarter / 3], 1400.0
    )
    upwards = 40.0 / 3.0 * (2.0 / 3.0 * np.sqrt(0.75) - 0.5)
    assert_allclose(found, [0.0, -20.0, 10 * np.log10(0.01 + 0.99 / 4), 0.0, -40.0 / 3.0, upwards], atol=1e-9)


def test_directivity_keeps_power_and_hence_exposure():
    """Beside the track at the height of the source the horizontal pattern leaves the exposure as it is."""
    path = SoundPath(BAND, FLAT, directivity="cnossos")
    vertical = path.integral(0.0) * 7.5 / np.pi  # what the vertical pattern takes from above goes sideways
    sine = (np.arange(400) + 0.5) / 400  # all around and up, in equal parts of the half sphere
    around = np.pi * (np.arange(50) + 0.5) / 50
    level = cnossos.directivity(around[:, None, None], np.arcsin(sine)[:, None], BAND)
    horizontal = np.mean(0.01 + 0.99 * np.sin(around) ** 2)
    assert_allclose(vertical * np.mean(10.0 ** (0.1 * level), axis=(0, 1)), horizontal, rtol=1e-4)
    opposite = path.inverse_square(0.0, np.zeros(1))[:, 0] * 7.5**2
    assert_allclose(opposite, vertical / 0.505, rtol=1e-6)


def test_paths_without_anything_are_the_closed_form():
    """Spread sources over the general path; rails apart add as two lines."""
    along, length = np.linspace(0.0, 60.0, 401), np.array([0.0, 0.01, 3.0, 40.0])
    path, source = SoundPath(np.full(4, 1000.0), FLAT), AxleSource(np.ones(4), length)
    expected = np.stack([divergence(each, 7.5, along) for each in length])
    assert_allclose(path.spread(0.0, length, along), expected, rtol=4e-3)
    passage, time = Passage([0.0, 2.5], 40.0), np.linspace(-1.0, 1.0, 101)
    found, closed = (squared_pressure(source, passage, FLAT, time, each) for each in (path, None))
    assert_allclose(found, closed, rtol=4e-3)
    assert_allclose(exposure(source, passage, FLAT, path), exposure(source, passage, FLAT), rtol=1e-9)
    apart = SoundPath(np.full(4, 1000.0), FLAT, rail_distance=1.5)
    both = 0.5 * (divergence(0.0, 6.75, along) + divergence(0.0, 8.25, along))
    assert_allclose(apart.inverse_square(0.0, along), np.broadcast_to(both, (4, 401)), rtol=1e-12)
    assert_allclose(apart.integral(0.0), 0.5 * np.pi * (1 / 6.75 + 1 / 8.25), rtol=1e-6)


def test_soft_ground_spreads_as_its_quadrature():
    """A wave that decays along the rail over grass: against a plain sum over the rail."""
    path, along = SoundPath(BAND[::7], Receiver(), GRASS, 0.5, "cnossos", 1.5), np.linspace(0.0, 40.0, 301)
    at = np.linspace(-120.0, 120.0, 12_001)
    weight = np.exp(-2.0 * np.abs(at) / 5.0) / 5.0 * (at[1] - at[0])
    found = path.spread(0.0, np.full(len(path.band), 5.0), along)
    for place in (0, 60, 200):
        expected = path.inverse_square(0.0, along[place] + at) @ weight
        assert_allclose(found[:, place], expected, rtol=0.01)


test_bad_input = refusals(
    (lambda: SoundPath(BAND, Receiver(0.7), rail_distance=1.5), "beside both rails"),
    (lambda: SoundPath(BAND, Receiver(7.5, -1.0), GRASS), "-0.5 m above the ground"),
)
