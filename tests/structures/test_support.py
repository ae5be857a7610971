"""Supports of a rail as chains: closed forms of two layers, free and bedded beams, limits, dissipation."""

import numpy as np
import pytest

from asperity.structures.support import BendingSleeper, Chain, ConstantLoss, Relaxation, RigidMass, Spring

OMEGA = 2.0 * np.pi * np.array([1.0, 30.0, 90.0, 276.0, 600.0, 1500.0, 4000.0])
LOWER = OMEGA * (1.0 - 0.1j)  # in the lower half-plane
PAD = Spring(300e6, ConstantLoss(0.15), 0.0)
BALLAST = Spring(150e6, Relaxation(0.6, (0.2, 0.5), (30.0, 300.0)), 1e4)
SLEEPER = {"mass": 150.0, "length": 2.6, "bending_stiffness": 6e6, "seat_distance": 1.5}


def test_pad_sleeper_and_ballast_are_the_closed_form():
    pad, ballast = PAD.stiffness(LOWER), BALLAST.stiffness(LOWER)
    below = ballast - 150.0 * LOWER**2
    chain = Chain((PAD, RigidMass(150.0), BALLAST))
    np.testing.assert_allclose(chain.stiffness(LOWER), pad * below / (pad + below), rtol=1e-12)
    np.testing.assert_allclose(chain.sleeper_square(LOWER), np.abs(pad / (pad + below)) ** 2, rtol=1e-12)
    assert chain.static == pytest.approx(300e6 * 90e6 / 390e6, rel=1e-14)


def test_a_long_chain_is_its_equations_of_motion():
    """Pad, sleeper, pad under it, ballast with mass, subgrade: two equations for the two masses."""
    soft, ground = Spring(200e6, ConstantLoss(0.2), 0.0), Spring(90e6, ConstantLoss(0.3), 2e4)
    chain = Chain((PAD, RigidMass(150.0), soft, BALLAST, RigidMass(300.0), ground))
    for omega, found, squares in zip(
        OMEGA, chain.stiffness(OMEGA), np.transpose(chain.squares(OMEGA), (2, 0, 1)), strict=True
    ):
        pad, under, ballast, deep = (each.stiffness(omega) for each in (PAD, soft, BALLAST, ground))
        layer = 1.0 / (1.0 / under + 1.0 / ballast)
        matrix = [[pad + layer - 150.0 * omega**2, -layer], [-layer, layer + deep - 300.0 * omega**2]]
        sleeper, bed = np.linalg.solve(matrix, [pad, 0.0])
        assert found == pytest.approx(pad * (1.0 - sleeper), rel=1e-11)
        moved = np.abs([1.0, sleeper, sleeper, sleeper - layer / under * (sleeper - bed), bed, bed]) ** 2
        np.testing.assert_allclose(squares[:, 0], moved, rtol=1e-9)
        squeezed = np.abs([1.0 - sleeper, layer / ballast * (sleeper - bed), bed]) ** 2
        np.testing.assert_allclose(squares[[0, 3, 5], 1], squeezed, rtol=1e-8)


def test_nothing_moves_on_rigid_ground():
    for sleeper in (RigidMass(150.0), BendingSleeper(**SLEEPER)):
        chain = Chain((PAD, sleeper))
        np.testing.assert_array_equal(chain.stiffness(OMEGA), Chain((PAD,)).stiffness(OMEGA))
        np.testing.assert_array_equal(chain.sleeper_square(OMEGA), 0.0)
        assert chain.static == 300e6
    assert not Chain((PAD,)).sleeper_square(OMEGA).any()


def test_a_stiff_sleeper_is_a_point_mass():
    below, stiff = BALLAST.stiffness(LOWER), BendingSleeper(**(SLEEPER | {"bending_stiffness": 1e18}))
    np.testing.assert_allclose(stiff.on(LOWER, below), RigidMass(150.0).on(LOWER, below), rtol=1e-9)
    np.testing.assert_allclose(stiff.spread(LOWER, below), 1.0, rtol=1e-8)


def test_a_sleeper_is_right_at_any_complex_frequency():
    """Causal: the receptance is analytic, so that its mean on a circle is its value in the middle."""
    middle, sleeper = 4000.0 - 300.0j, BendingSleeper(**SLEEPER)
    ring = middle + 200.0 * np.exp(2j * np.pi * np.arange(64) / 64)
    assert (1.0 / sleeper.on(ring, BALLAST.stiffness(ring))).mean() == pytest.approx(
        1.0 / sleeper.on(middle, BALLAST.stiffness(middle)), rel=1e-12, abs=0.0
    )
