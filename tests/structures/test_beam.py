"""Materials, the ball and the modes of the beam."""

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss
from numpy.testing import assert_allclose

from asperity.errors import InputError
from asperity.reference.materials import MATERIALS, Material, contact_modulus, material
from asperity.structures.beam import SUPPORTS, Beam
from asperity.structures.body import Ball

STEEL = material("steel")
# roots of cos x cosh x = 1, as printed in Blevins, Formulas for Natural Frequency and Mode Shape, table 8-1
PRINTED_ROOTS = [4.73004074, 7.85320462, 10.9956079, 14.1371655, 17.2787597]


def beam(support="simply-supported", **options):
    return Beam.rectangular(1.0, 0.05, 0.01, STEEL, support=support, **options)


def test_simply_supported_frequencies():
    b = beam()
    n = np.arange(1, len(b.natural_frequencies) + 1)
    expected = 0.5 * np.pi * n**2 * np.sqrt(b.bending_stiffness / b.mass_per_length) / b.length**2
    assert_allclose(b.natural_frequencies, expected, rtol=1e-12)
    assert (
        b.natural_frequencies[-1]
        <= 10e3
        < 0.5 * np.pi * (n[-1] + 1) ** 2 * np.sqrt(b.bending_stiffness / b.mass_per_length)
    )


@pytest.mark.parametrize("support", ["free", "clamped"])
def test_free_and_clamped_frequencies_match_printed_roots(support):
    b = beam(support)
    skip = 2 if support == "free" else 0
    roots = np.sqrt(
        2 * np.pi * b.natural_frequencies[skip:] * np.sqrt(b.mass_per_length / b.bending_stiffness)
    )
    assert_allclose(roots[:5], PRINTED_ROOTS, rtol=1e-8)
    # where cosh is large the roots are odd multiples of pi/2
    n = np.arange(12, len(roots))
    assert_allclose(roots[12:], (n + 1.5) * np.pi, rtol=1e-13)


@pytest.mark.parametrize("support", SUPPORTS)
def test_modes_are_orthonormal_even_the_high_ones(support):
    b = beam(support, highest_frequency=200e3)
    assert len(b.natural_frequencies) > 80
    nodes, weights = leggauss(600)
    shapes, _ = b.shapes(0.5 * (nodes + 1.0) * b.length)
    mass = shapes.T @ (0.5 * b.mass * weights[:, None] * shapes)
    assert_allclose(mass, np.eye(mass.shape[0]), atol=1e-11)


@pytest.mark.parametrize("support", SUPPORTS)
def test_slopes_are_the_derivative_of_the_shapes(support):
    b = beam(support)
    x = np.linspace(0.01, 0.99, 37)
    step = 1e-6
    difference = (b.shapes(x + step)[0] - b.shapes(x - step)[0]) / (2 * step)
    slopes = b.shapes(x)[1]
    assert_allclose(slopes, difference, atol=1e-6 * np.abs(slopes).max())


@pytest.mark.parametrize("support", SUPPORTS)
@pytest.mark.parametrize(("count", "highest_frequency"), [(10**6, 10e3), (2049, 300e3), (7, 10e3), (1, 10e3)])
def test_shapes_along_a_path_are_the_shapes(support, count, highest_frequency):
    b = beam(support, highest_frequency=highest_frequency)
    spacing = b.length / count
    k = np.sqrt(2 * np.pi * b.natural_frequencies * np.sqrt(b.mass_per_length / b.bending_stiffness))
    size = 1.0 / np.sqrt(b.mass)
    for first in range(0, count, 50_000):
        x = spacing * np.arange(first, min(first + 50_000, count) + 1)
        shapes, slopes = b.shapes_along(x[0], spacing, len(x))
        expected = b.shapes(x)
        assert np.abs(shapes - expected[0]).max() < 1e-12 * size
        assert np.abs((slopes - expected[1]) / k).max() < 1e-12 * size


def test_shapes_along_a_path_backwards_and_in_place():
    b = beam("clamped")
    for spacing in (-1e-3, 0.0):
        at = 0.7 + spacing * np.arange(300)
        assert_allclose(b.shapes_along(0.7, spacing, 300), b.shapes(at), atol=1e-11)
    with pytest.raises(InputError, match="positions on the beam"):
        b.shapes_along(0.9, 1e-3, 300)


def test_end_conditions():
    shapes, slopes = beam("clamped").shapes([0.0, 1.0])
    assert_allclose(shapes, 0.0, atol=1e-12)
    assert_allclose(slopes, 0.0, atol=1e-10)
    assert_allclose(beam().shapes([0.0, 1.0])[0], 0.0, atol=1e-12)
    b = beam("free")
    ends = b.shapes([0.0, 1.0])[0][:, 2:] * np.sqrt(b.mass)
    assert_allclose(np.abs(ends), 2.0, rtol=1e-12)  # Rayleigh: the mean square is a quarter of the end's


@pytest.mark.parametrize(("support", "factor"), [("simply-supported", 48.0), ("clamped", 192.0)])
def test_static_compliance_at_midspan(support, factor):
    b = beam(support, highest_frequency=1e6)
    expected = b.length**3 / (factor * b.bending_stiffness)
    assert_allclose(b.receptance(0.0, 0.5, 0.5), expected, rtol=1e-6)


def test_free_beam_moves_as_a_rigid_mass_above_its_suspension():
    b = beam("free", suspension_frequency=0.1, loss_factor=0.0)
    frequency = 2.0
    at_end = b.receptance(frequency, 1.0, 1.0).real
    # mass and moment of inertia of a slender rod, force at its end: 1/m + (L/2)^2/(m L^2/12) = 4/m
    assert_allclose(at_end, -4.0 / (b.mass * (2 * np.pi * frequency) ** 2), rtol=2e-2)


def test_receptance_is_reciprocal_and_dissipates():
    b = beam("free")
    f = np.linspace(10.0, 5000.0, 200)
    assert_allclose(b.receptance(f, 0.2, 0.7), b.receptance(f, 0.7, 0.2), rtol=1e-12)
    assert np.all(b.receptance(f, 0.3, 0.3).imag < 0.0)


def test_resonance_is_as_damped_as_a_loss_factor():
    b = beam(loss_factor=0.01)
    f1 = b.natural_frequencies[0]
    shape = b.shapes(0.5)[0][0, 0]
    hysteretic = shape**2 / ((2 * np.pi * f1) ** 2 * 0.01)
    assert_allclose(abs(b.receptance(f1, 0.5, 0.5)), hysteretic, rtol=1e-3)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"length": 0.0}, "beam length"),
        ({"bending_stiffness": np.nan}, "bending stiffness"),
        ({"mass_per_length": -1.0}, "mass per length"),
        ({"highest_frequency": 0.0}, "highest frequency"),
        ({"highest_frequency": 1.0}, "above the first natural frequency"),
        ({"suspension_frequency": 0.0}, "suspension frequency"),
        ({"loss_factor": -0.1}, "loss factor"),
        ({"support": "hinged"}, "one of simply-supported, free, clamped"),
    ],
)
def test_bad_beams_are_refused(change, message):
    with pytest.raises(InputError, match=message):
        Beam(**({"length": 1.0, "bending_stiffness": 875.0, "mass_per_length": 3.9} | change))


def test_bad_sections_and_positions_are_refused():
    with pytest.raises(InputError, match="beam width"):
        Beam.rectangular(1.0, -0.05, 0.01, STEEL)
    with pytest.raises(InputError, match="beam height"):
        Beam.rectangular(1.0, 0.05, np.inf, STEEL)
    with pytest.raises(InputError, match="positions on the beam"):
        beam().shapes([0.5, 1.1])


def test_ball_has_its_weight_or_a_given_load():
    ball = Ball(0.025, STEEL)
    assert_allclose(ball.mass, 0.5138, rtol=1e-3)
    assert_allclose(ball.static_load, ball.mass * 9.80665, rtol=1e-15)
    assert Ball(0.025, STEEL, load=30.0).static_load == 30.0
    with pytest.raises(InputError, match="ball radius"):
        Ball(0.0, STEEL)
    with pytest.raises(InputError, match="ball load"):
        Ball(0.025, STEEL, load=-1.0)


def test_materials():
    assert_allclose(contact_modulus(STEEL, STEEL), 210e9 / (2 * 0.91), rtol=1e-15)
    assert all(m.citation for m in MATERIALS.values())
    assert material(" Steel ") is STEEL
    with pytest.raises(InputError, match='Did you mean "aluminium"'):
        material("aluminum")
    with pytest.raises(InputError, match="Young's modulus"):
        Material("jelly", 0.0, 0.3, 1000.0)
    with pytest.raises(InputError, match="Poisson's ratio"):
        Material("jelly", 1e5, 0.6, 1000.0)
