"""Vector fitting against rational functions whose poles and residues are known."""

import numpy as np
import pytest

from asperity.errors import InputError
from asperity.structures.modal_fit import vector_fit

POLES = np.array([-20.0, -5.0 + 300.0j, -40.0 + 2000.0j, -10.0 + 2100.0j])
RESIDUES = np.array([[3.0, 1.0 - 2.0j, 4.0j, 0.5], [1.0, 0.2j, -3.0, 2.0 + 1.0j]])


def response(s, poles, residues):
    total = 0
    for pole, residue in zip(poles, residues, strict=True):
        total = total + residue / (s - pole)
        if pole.imag != 0.0:
            total = total + np.conj(residue) / (s - np.conj(pole))
    return total


def test_it_finds_the_poles_and_residues_of_a_rational_function():
    s = 2j * np.pi * np.geomspace(1.0, 1000.0, 300)
    values = [response(s, POLES, r) for r in RESIDUES]
    start = np.array([-1.0 + 100j, -5.0 + 1000j, -10.0 + 3000j, -100.0])
    fit = vector_fit(s, values, start)
    order, known = np.argsort(np.abs(fit.poles)), np.argsort(np.abs(POLES))
    assert fit.error < 1e-9
    np.testing.assert_allclose(fit.poles[order], POLES[known], rtol=1e-7)
    np.testing.assert_allclose(fit.residues[:, order], RESIDUES[:, known], rtol=1e-6, atol=1e-6)


def test_on_the_unit_circle_it_finds_a_discrete_response():
    poles = np.exp(np.array([-0.01, -0.002 + 0.3j, -0.05 + 1.2j]))
    residues = np.array([0.5, 1.0 - 1.0j, 0.3j])
    z = np.exp(1j * np.linspace(0.01, 3.0, 200))
    fit = vector_fit(z, response(z, poles, residues), 0.95 * np.exp([0.1j, 1.0j, 0.0]), domain="disc")
    assert fit.error < 1e-9
    np.testing.assert_allclose(
        fit.poles[np.argsort(fit.poles.imag)], poles[np.argsort(poles.imag)], rtol=1e-7
    )


def test_all_poles_are_stable_even_for_noise():
    random = np.random.default_rng(3)
    s = 1j * np.linspace(1.0, 100.0, 200)
    noise = random.normal(size=(3, 200)) + 1j * random.normal(size=(3, 200))
    fit = vector_fit(s, noise, -1.0 + 1j * np.linspace(2, 90, 10))
    assert (fit.poles.real < 0.0).all()
    z = np.exp(1j * np.linspace(0.01, 3.0, 200))
    fit = vector_fit(z, noise, 0.9 * np.exp(1j * np.linspace(0.1, 3, 10)), domain="disc")
    assert (np.abs(fit.poles) < 1.0).all()


def test_weights_move_the_error_to_where_they_are_small():
    s = 2j * np.pi * np.geomspace(1.0, 1000.0, 300)
    values = response(s, POLES, RESIDUES[0])
    low = np.abs(s) < 1000.0
    start = np.array([-1.0 + 200j, -5.0 + 1500j])
    error = {}
    for name, weights in (("low", np.where(low, 1e3, 1.0)), ("high", np.where(low, 1.0, 1e3))):
        fit = vector_fit(s, values, start, weights=weights)
        error[name] = np.abs(response(s, fit.poles, fit.residues[0]) - values)
    assert error["low"][low].max() < error["high"][low].max()
    assert error["high"][~low].max() < error["low"][~low].max()


def test_too_few_points_and_bad_values_are_refused():
    with pytest.raises(InputError, match="3 points for 2 poles"):
        vector_fit(1j * np.arange(1, 4), np.ones(3), [-1 + 1j, -1 + 2j])
    with pytest.raises(InputError, match="not finite"):
        vector_fit(1j * np.arange(1, 9), np.full(8, np.nan), [-1 + 1j])
