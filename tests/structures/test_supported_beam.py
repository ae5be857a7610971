"""Beams on any supports against closed forms: spans, springs, ends, losses."""

import math

import mpmath as mp
import numpy as np
import pytest
from numpy.testing import assert_allclose

from asperity.errors import InputError
from asperity.reference.materials import material
from asperity.structures.beam import SUPPORTS, Beam, Support, SupportedBeam

STIFFNESS, MASS = 4375.0, 3.925  # N m² and kg/m of a steel bar of 50 × 10 mm
CLAMPED = math.inf
ENDS = {
    "simply-supported": [Support(0.0), Support(1.0)],
    "clamped": [Support(0.0, rotational_stiffness=CLAMPED), Support(1.0, rotational_stiffness=CLAMPED)],
    "free": [],
}


def supported(supports, length=1.0, **options):
    return SupportedBeam(length, STIFFNESS, MASS, supports, **options)


def roots(beam, span=1.0):
    """Wavenumbers times a span."""
    return np.sqrt(2.0 * np.pi * beam.natural_frequencies * np.sqrt(MASS / STIFFNESS)) * span


@pytest.mark.parametrize("support", SUPPORTS)
def test_two_ends_are_those_of_the_beam_in_closed_form(support):
    closed = Beam(1.0, STIFFNESS, MASS, support, highest_frequency=30e3)
    found = supported(ENDS[support], highest_frequency=30e3)
    skip = 2 if support == "free" else 0
    assert len(found.natural_frequencies) == len(closed.natural_frequencies)
    assert_allclose(found.natural_frequencies[skip:], closed.natural_frequencies[skip:], rtol=2e-9)
    assert found.natural_frequencies[:skip].tolist() == [0.0] * skip
    x = np.linspace(0.0, 1.0, 333)
    expected, shapes = (beam.shapes_along(0.0, x[1], 333) for beam in (closed, found))
    turned = np.sign(np.sum(expected[0] * shapes[0], axis=0))[skip:]
    assert_allclose(shapes[0][:, skip:] * turned, expected[0][:, skip:], atol=1e-6)
    assert_allclose(shapes[1][:, skip:] * turned, expected[1][:, skip:], atol=2e-4)


def test_two_equal_spans_have_the_modes_of_two_beams():
    """Antisymmetric ones of a span on two supports, symmetric ones of a span clamped at the middle."""
    beam = supported([Support(0.0), Support(1.0), Support(2.0)], length=2.0, highest_frequency=2e3)
    clamped = [float(mp.findroot(lambda x: mp.tan(x) - mp.tanh(x), (n + 0.25) * mp.pi)) for n in range(1, 5)]
    expected = np.sort([*(np.pi * np.arange(1, 5)), *clamped])
    assert_allclose(roots(beam)[:8], expected, rtol=1e-9)


def test_a_cantilever_with_a_spring_at_its_tip():
    """x³(1 + cos x cosh x) + κ(sin x cosh x − cos x sinh x) = 0 with κ = K L³/B."""
    kappa = 40.0

    def equation(x):
        bent = mp.sin(x) * mp.cosh(x) - mp.cos(x) * mp.sinh(x)
        return x**3 * (1 + mp.cos(x) * mp.cosh(x)) + kappa * bent

    beam = supported(
        [Support(0.0, rotational_stiffness=CLAMPED), Support(1.0, kappa * STIFFNESS)], highest_frequency=2e3
    )
    found = roots(beam)
    assert_allclose(found, [float(mp.findroot(equation, x)) for x in found], rtol=1e-9)
    assert 1.875 < found[0] < 3.927  # between free and held


def test_a_beam_with_springs_against_rotation():
    """Both ends pinned, turning springs of c = C L/B: symmetric modes tan(x/2) + tanh(x/2) + 2x/c = 0."""
    c = 6.0
    ends = [Support(p, rotational_stiffness=c * STIFFNESS) for p in (0.0, 1.0)]
    found = roots(supported(ends, highest_frequency=500.0))

    def equation(x):
        return mp.tan(x / 2) + mp.tanh(x / 2) + 2 * x / c

    assert found[0] == pytest.approx(float(mp.findroot(equation, found[0])), rel=1e-9)
    assert math.pi < found[0] < 4.730


def test_many_springs_are_a_winkler_foundation():
    """Free beam under F at its middle: F β/2s (cosh βL + cos βL + 2)/(sinh βL + sin βL) (Hetényi, 1946)."""
    distance, spring, length = 0.08, 32e3, 2.0
    foundation = spring / distance
    at = distance * (np.arange(25) + 0.5)
    beam = supported([Support(x, spring) for x in at], length=length, highest_frequency=4e3, loss_factor=0.0)
    beta = (foundation / (4.0 * STIFFNESS)) ** 0.25
    x = beta * length
    finite = (np.cosh(x) + np.cos(x) + 2.0) / (np.sinh(x) + np.sin(x))
    middle = beam.receptance(0.0, 1.0, 1.0).real
    assert middle == pytest.approx(finite * beta / (2.0 * foundation), rel=5e-4)
    bounce = np.sqrt(foundation / MASS) / (2 * np.pi)
    pitch = bounce * np.sqrt(1.0 - 1.0 / 25**2)  # springs stand at the middles of their shares
    assert_allclose(beam.natural_frequencies[:2], [pitch, bounce], rtol=1e-5)


def test_losses_are_shared_by_strain_energy():
    """A stiff bar on two soft springs loses what they do, a soft one on stiff springs what it does."""
    supports = [Support(x, 1e3, loss_factor=0.2) for x in (0.0, 1.0)]
    stiff = SupportedBeam(1.0, 4e6, MASS, supports, loss_factor=0.01, highest_frequency=20.0)
    assert_allclose(stiff.natural_frequencies, np.sqrt([2e3, 6e3] / np.array(MASS)) / (2 * np.pi), rtol=1e-3)
    assert_allclose(stiff.damping_ratios, [0.1, 0.1], rtol=1e-3)
    supports = [Support(x, 1e10, loss_factor=0.2) for x in (0.0, 1.0)]
    assert_allclose(supported(supports, loss_factor=0.01).damping_ratios[:3], 0.005, rtol=2e-2)
    # between them: dω/ω of each spring constant says where the energy is
    middling = [Support(x, 1e5, loss_factor=0.2) for x in (0.0, 1.0)]
    more = [Support(x, 1.001e5, loss_factor=0.2) for x in (0.0, 1.0)]
    beam, stiffer = supported(middling, loss_factor=0.0), supported(more, loss_factor=0.0)
    share = 2.0 * (stiffer.natural_frequencies / beam.natural_frequencies - 1.0) / 1e-3
    assert_allclose(beam.damping_ratios[:4], 0.1 * share[:4], rtol=1e-3)


def test_modes_are_orthonormal_and_pinned():
    places = [0.0, 0.31, 0.9, 1.3]
    supports = [Support(0.0), Support(0.31, 3e6), Support(0.9), Support(1.3, 1e5, rotational_stiffness=50.0)]
    beam = supported(supports, length=1.4, highest_frequency=8e3)
    x, weights = np.polynomial.legendre.leggauss(400)
    shapes = beam.shapes(0.7 * (x + 1.0))[0]
    assert_allclose(shapes.T @ (0.7 * MASS * weights[:, None] * shapes), np.eye(shapes.shape[1]), atol=1e-5)
    held = beam.shapes(places)[0]
    assert np.abs(held[[0, 2]]).max() < 1e-9
    assert np.abs(held[[1, 3]]).max() > 0.1


@pytest.mark.parametrize(("supports", "count"), [([Support(0.2)], 1), ([Support(0.5, 1e4), Support(0.7)], 0)])
def test_what_supports_leave_free_is_rigid(supports, count):
    assert np.sum(supported(supports).natural_frequencies == 0.0) == count


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Support(-0.1), r"position of a support \(m\): received -0.1; allowed: 0 and more"),
        (lambda: Support(0.0, -1.0), r"stiffness of a support \(N/m\): received -1.0"),
        (lambda: Support(0.0, 0.0), "allowed: a support that holds something"),
        (lambda: Support(0.0, loss_factor=2.0), "loss factor of a support: received 2.0"),
        (lambda: supported([Support(0.0), Support(1.1)]), r"received 1.1; allowed: 0 to 1, on the beam"),
        (lambda: supported([Support(0.5), Support(0.5)]), "one place twice; allowed: different places"),
        (lambda: supported([], length=-1.0), r"beam length \(m\): received -1.0"),
        (lambda: supported([], loss_factor=3.0), "loss factor of the beam: received 3.0"),
        (lambda: supported([Support(0.0), Support(1.0)], highest_frequency=1.0), "above its first natural"),
        (
            lambda: supported([], highest_frequency=1e10),
            r"knots of splines; allowed: 1500 knots.*fewer supports",
        ),
        (lambda: supported([Support(0.0), Support(1.0)]).shapes(1.2), "received 1.2 to 1.2; allowed: 0 to 1"),
        (
            lambda: SupportedBeam.rectangular(1.0, -0.1, 0.01, material("steel"), []),
            r"beam width \(m\): received -0.1",
        ),
    ],
)
def test_beams_that_cannot_be_are_refused(make, message):
    with pytest.raises(InputError, match=message):
        make()
