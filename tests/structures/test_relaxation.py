"""Springs beside Maxwell elements: closed forms, causality and passivity."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from asperity.structures.track import Relaxation, relaxing

strengths = st.lists(st.floats(0.0, 10.0), min_size=3, max_size=3).map(tuple)
relaxations = st.builds(Relaxation, st.floats(0.0, 2.0), strengths, st.just((5.0, 70.0, 900.0)))


def test_a_maxwell_element_at_its_frequency_and_far_from_it():
    element = Relaxation(0.25, (2.0,), (100.0,))
    far_below, at, far_above = element.at(2.0 * np.pi * np.array([1e-6, 100.0, 1e12]))
    assert far_below == pytest.approx(0.25, abs=1e-7)
    assert at == pytest.approx(0.25 + 1.0 + 1.0j)
    assert far_above == pytest.approx(2.25)


def test_it_answers_in_time_by_a_spring_and_exponentials():
    # a unit strain rises at t = 0: stress = static + Σ strength e^(-2π f t), whose transform is K/(iω)
    found = Relaxation(0.5, (1.0, 3.0), (10.0, 200.0))
    omega, decay = 300.0 - 1.0j, 2.0 * np.pi * np.array([10.0, 200.0])
    stress = 0.5 / (1j * omega) + np.sum([1.0, 3.0] / (1j * omega + decay))
    assert found.at(omega) / (1j * omega) == pytest.approx(stress, rel=1e-12)


@given(relaxations, st.floats(1.0, 1e4))
def test_it_never_gives_energy_back(relaxation, frequency):
    assert relaxation.at(2.0 * np.pi * frequency).imag >= 0.0


@given(relaxations, st.floats(1.0, 5e3))
def test_the_stiffness_grows_as_kramers_and_kronig_ask(relaxation, frequency):
    # Re K(ω) - K(0) = (2ω²/π) P∫ Im K(x)/(x (ω² - x²)) dx; over the logarithm of x, pole taken off
    omega = 2.0 * np.pi * frequency
    at = relaxation.at(omega)

    def rest(neper):
        x = omega * np.exp(neper)
        if abs(neper) < 1e-6:
            return 0.0  # antisymmetric about the pole
        pair = [relaxation.at(y).imag / (1.0 - (y / omega) ** 2) for y in (x, omega / np.exp(neper))]
        return sum(pair)

    grown = 2.0 / np.pi * quad(rest, 1e-6, 25.0, limit=400)[0]
    assert at.real - relaxation.static == pytest.approx(grown, rel=1e-3, abs=1e-4)


def test_the_basis_is_a_spring_and_elements_of_unit_strength():
    omega = np.array([[10.0, 200.0], [3e3, 4e4]])
    basis = relaxing(omega, (20.0, 300.0))
    assert basis.shape == (2, 2, 3)
    np.testing.assert_array_equal(basis[..., 0], 1.0)
    mixed = Relaxation(0.3, (0.7, 0.2), (20.0, 300.0))
    np.testing.assert_allclose(basis @ [0.3, 0.7, 0.2], mixed.at(omega), rtol=1e-14)
