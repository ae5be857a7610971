"""Decay rates from the eigenvalue and by EN 15461."""

import math

import numpy as np
import pytest

from asperity import Track
from asperity.errors import InputError
from asperity.structures.track import EN_15461_BAYS, decay_rate, decay_rate_en15461, decay_rate_of_responses


def test_below_cut_on_the_decay_is_that_of_a_winkler_foundation():
    """Near zero frequency waves fall with exp(-beta x), 20 lg e beta dB/m."""
    spacing = 0.02
    rail = Track(4.725e6, 60.0, 300e6 * spacing, 0.0, 150e6 * spacing, spacing, rail_loss_factor=1e-6)
    beta = (100e6 / (4.0 * 4.725e6)) ** 0.25
    assert decay_rate(rail, 1.0) == pytest.approx(20.0 * math.log10(math.e) * beta, rel=1e-4)


def test_far_above_cut_on_the_decay_is_that_of_the_rail():
    """A bending wave of a free rail with loss factor eta falls with exp(-eta k x/4)."""
    rail = Track(4.725e6, 60.0, 1e5, 0.0, 1e5, 0.6, rail_loss_factor=0.02)
    frequency = np.array([[1000.0, 2000.0, 4000.0]])
    k = np.sqrt(2.0 * np.pi * frequency) * (60.0 / 4.725e6) ** 0.25
    expected = 20.0 * math.log10(math.e) * 0.02 * k / 4.0
    np.testing.assert_allclose(decay_rate(rail, frequency), expected, rtol=1e-3)


def test_the_eigenvalue_is_the_decay_of_the_far_field():
    rail = Track.named("uic60")
    frequency = np.array([300.0, 800.0, 1063.0, 3000.0])
    near, far = (np.abs(rail.receptance(frequency, 0.3 + 0.6 * n, 0.3)) for n in (40, 50))
    np.testing.assert_allclose(20.0 * np.log10(near / far) / 6.0, decay_rate(rail, frequency), rtol=1e-6)


def test_the_standard_has_29_positions():
    assert len(EN_15461_BAYS) == 29
    assert EN_15461_BAYS[-1] == 66.0


@pytest.mark.parametrize("rate", [0.8, 2.0, 4.0, 8.0])
def test_an_exponential_decay_is_found_by_the_standard(rate):
    """The rectangles of the standard overestimate the sum by some (2 alpha Delta x)^2/12."""
    distances = 0.6 * np.array(EN_15461_BAYS)
    responses = 3e-9 * 10.0 ** (-rate * distances / 20.0)
    found = decay_rate_of_responses(distances, responses[:, None])
    assert found == pytest.approx(rate, rel=0.015)


def test_both_rates_agree_where_one_wave_rules():
    rail = Track.named("uic60")
    frequency = np.array([2000.0, 2500.0, 3000.0])
    np.testing.assert_allclose(decay_rate_en15461(rail, frequency), decay_rate(rail, frequency), rtol=0.15)


def test_the_standard_finds_its_floor_without_decay():
    """A wave of constant amplitude: 4.343 dB over the length that the positions stand for."""
    distances = 0.6 * np.array(EN_15461_BAYS)
    length = 0.6 * (66.0 + 6.0)
    expected = 10.0 * math.log10(math.e) / length
    assert decay_rate_of_responses(distances, np.ones(29)) == pytest.approx(expected, rel=1e-12)


def test_bad_questions_are_refused():
    rail = Track.named("nordborg")
    with pytest.raises(InputError, match="frequency"):
        decay_rate(rail, [0.0, 100.0])
    with pytest.raises(InputError, match="frequency"):
        decay_rate_en15461(rail, -1.0)
    with pytest.raises(InputError, match="ascending from zero"):
        decay_rate_of_responses([0.3, 0.6], [1.0, 0.5])
