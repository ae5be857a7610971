"""Structures by their modes, against closed forms: beams of one span and on supports, and tables of modes."""

import math
import warnings

import mpmath as mp
import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss
from numpy.testing import assert_allclose

from asperity.errors import CoarseSamplingWarning, InputError
from asperity.reference.materials import MATERIALS, Material, contact_modulus, material
from asperity.structures.beam import SUPPORTS, Beam, Support, SupportedBeam
from asperity.structures.modal import ModalStructure
from refusals import refusals

STEEL = material("steel")
BENDING, STIFFNESS, MASS = 875.0, 4375.0, 3.925  # N m² and kg/m: a steel bar of 50 × 10 mm, and a stiffer one
CLAMPED = math.inf
# roots of cos x cosh x = 1, as printed in Blevins, Formulas for Natural Frequency and Mode Shape, table 8-1
PRINTED_ROOTS = [4.73004074, 7.85320462, 10.9956079, 14.1371655, 17.2787597]
ENDS = {
    "simply-supported": [Support(0.0), Support(1.0)],
    "clamped": [Support(0.0, rotational_stiffness=CLAMPED), Support(1.0, rotational_stiffness=CLAMPED)],
    "free": [],
}


def beam(support="simply-supported", **options):
    return Beam(1.0, BENDING, MASS, support, **options)


def supported(supports, length=1.0, **options):
    return SupportedBeam(length, STIFFNESS, MASS, supports, **options)


def roots(of):
    """Wavenumbers, 1/m."""
    return np.sqrt(2.0 * np.pi * of.natural_frequencies * np.sqrt(MASS / of.bending_stiffness))


def zero_near(equation, found):
    return [float(mp.findroot(equation, x)) for x in found]


def test_frequencies_are_those_printed():
    n = np.arange(1, len(roots(beam())) + 1)
    assert_allclose(roots(beam()), n * np.pi, rtol=1e-12)
    assert (
        beam().natural_frequencies[-1] <= 10e3 < beam().natural_frequencies[-1] * ((n[-1] + 1) / n[-1]) ** 2
    )
    for support, rigid in (("free", 2), ("clamped", 0)):
        found = roots(beam(support))[rigid:]
        assert_allclose(found[:5], PRINTED_ROOTS, rtol=1e-8)
        # where cosh is large the roots are odd multiples of pi/2
        assert_allclose(found[12:], (np.arange(12, len(found)) + 1.5) * np.pi, rtol=1e-13)
    section = Beam.rectangular(1.0, 0.05, 0.01, STEEL)
    assert section.bending_stiffness == pytest.approx(BENDING)
    assert section.mass == pytest.approx(MASS)


@pytest.mark.parametrize("support", SUPPORTS)
def test_modes_are_orthonormal_and_slopes_their_derivative(support):
    high = beam(support, highest_frequency=200e3)
    assert len(high.natural_frequencies) > 80
    nodes, weights = leggauss(600)
    shapes, _ = high.shapes(0.5 * (nodes + 1.0))
    mass = shapes.T @ (0.5 * high.mass * weights[:, None] * shapes)
    assert_allclose(mass, np.eye(mass.shape[0]), atol=1e-11)
    x, step = np.linspace(0.01, 0.99, 37), 1e-6
    difference = (beam(support).shapes(x + step)[0] - beam(support).shapes(x - step)[0]) / (2 * step)
    slopes = beam(support).shapes(x)[1]
    assert_allclose(slopes, difference, atol=1e-6 * np.abs(slopes).max())
    shapes, slopes = beam(support).shapes([0.0, 1.0])  # at the ends
    if support == "free":  # Rayleigh: the mean square is a quarter of the end's
        assert_allclose(np.abs(shapes[:, 2:]) * np.sqrt(MASS), 2.0, rtol=1e-12)
    else:
        assert_allclose(shapes, 0.0, atol=1e-12)
        assert support != "clamped" or np.abs(slopes).max() < 1e-10


@pytest.mark.parametrize("support", SUPPORTS)
@pytest.mark.parametrize(
    ("start", "spacing", "count", "highest"),
    [(0.0, 1e-5, 10**5 + 1, 10e3), (0.0, 1 / 2049, 2050, 300e3), (0.0, 1.0, 2, 10e3), (0.7, -1e-3, 300, 10e3),
     (0.7, 0.0, 300, 10e3)],
)  # fmt: skip
def test_shapes_along_a_path_are_the_shapes(support, start, spacing, count, highest):
    b = beam(support, highest_frequency=highest)
    shapes, slopes = b.shapes_along(start, spacing, count)
    expected, size = b.shapes(start + spacing * np.arange(count)), 1.0 / np.sqrt(b.mass)
    assert np.abs(shapes - expected[0]).max() < 1e-12 * size
    assert np.abs((slopes - expected[1]) / roots(b)).max() < 1e-12 * size


def test_receptances_are_those_of_textbooks():
    for support, factor in (("simply-supported", 48.0), ("clamped", 192.0)):
        static = beam(support, highest_frequency=1e6).receptance(0.0, 0.5, 0.5)
        assert_allclose(static, 1.0 / (factor * BENDING), rtol=1e-6)
    # mass and moment of inertia of a slender rod, force at its end: 1/m + (L/2)^2/(m L^2/12) = 4/m
    floating = beam("free", suspension_frequency=0.1, loss_factor=0.0).receptance(2.0, 1.0, 1.0).real
    assert_allclose(floating, -4.0 / (MASS * (4.0 * np.pi) ** 2), rtol=2e-2)
    f = np.linspace(10.0, 5000.0, 200)
    assert_allclose(beam("free").receptance(f, 0.2, 0.7), beam("free").receptance(f, 0.7, 0.2), rtol=1e-12)
    assert np.all(beam("free").receptance(f, 0.3, 0.3).imag < 0.0)
    lossy = beam(loss_factor=0.01)  # at resonance it dissipates as a hysteretic loss factor does
    first = lossy.natural_frequencies[0]
    hysteretic = lossy.shapes(0.5)[0][0, 0] ** 2 / ((2 * np.pi * first) ** 2 * 0.01)
    assert_allclose(abs(lossy.receptance(first, 0.5, 0.5)), hysteretic, rtol=1e-3)


@pytest.mark.parametrize("support", SUPPORTS)
def test_two_supports_are_the_beam_in_closed_form(support):
    closed = Beam(1.0, STIFFNESS, MASS, support, highest_frequency=30e3)
    found = supported(ENDS[support], highest_frequency=30e3)
    skip = 2 if support == "free" else 0
    assert len(found.natural_frequencies) == len(closed.natural_frequencies)
    assert_allclose(found.natural_frequencies[skip:], closed.natural_frequencies[skip:], rtol=2e-9)
    assert found.natural_frequencies[:skip].tolist() == [0.0] * skip
    expected, shapes = (each.shapes_along(0.0, 1.0 / 332.0, 333) for each in (closed, found))
    turned = np.sign(np.sum(expected[0] * shapes[0], axis=0))[skip:]
    assert_allclose(shapes[0][:, skip:] * turned, expected[0][:, skip:], atol=1e-6)
    assert_allclose(shapes[1][:, skip:] * turned, expected[1][:, skip:], atol=2e-4)


def test_ends_on_turning_springs_are_those_of_the_closed_form():
    # ends pinned on turning springs of C L/B = 6
    ends = [Support(p, rotational_stiffness=6.0 * STIFFNESS) for p in (0.0, 1.0)]
    found = roots(supported(ends, highest_frequency=500.0))[:1]
    assert_allclose(found, zero_near(lambda x: mp.tan(x / 2) + mp.tanh(x / 2) + x / 3, found), rtol=1e-9)
    assert math.pi < found[0] < 4.730
    # what its supports do not hold has motions of a rigid body
    assert np.sum(supported([Support(0.2)]).natural_frequencies == 0.0) == 1


def test_losses_are_shared_by_strain_energy():
    """A stiff bar on two soft springs loses what they do, a soft one on stiff springs what it does."""

    def on_two(spring, **options):
        return supported([Support(x, spring, loss_factor=0.2) for x in (0.0, 1.0)], **options)

    soft = [Support(x, 1e3, loss_factor=0.2) for x in (0.0, 1.0)]
    stiff = SupportedBeam(1.0, 4e6, MASS, soft, loss_factor=0.01, highest_frequency=20.0)
    assert_allclose(stiff.natural_frequencies, np.sqrt([2e3, 6e3] / np.array(MASS)) / (2 * np.pi), rtol=1e-3)
    assert_allclose(stiff.damping_ratios, [0.1, 0.1], rtol=1e-3)
    assert_allclose(on_two(1e10, loss_factor=0.01).damping_ratios[:3], 0.005, rtol=2e-2)
    # between them: dω/ω of each spring constant says where the energy is
    middling, stiffer = (on_two(spring, loss_factor=0.0) for spring in (1e5, 1.001e5))
    share = 2.0 * (stiffer.natural_frequencies / middling.natural_frequencies - 1.0) / 1e-3
    assert_allclose(middling.damping_ratios[:4], 0.1 * share[:4], rtol=1e-3)


def tabled(of, positions, **options):
    shapes = of.shapes(positions)[0]
    return ModalStructure(positions, of.natural_frequencies, of.damping_ratios, shapes, **options)


@pytest.mark.parametrize("support", SUPPORTS)
def test_shapes_between_points_are_those_of_the_beam(support):
    """Ends of clamped and free beams decay within a wavelength, and are the hardest."""
    b = beam(support, highest_frequency=3e3)
    table, x = tabled(b, np.linspace(0.0, 1.0, 101)), np.linspace(0.0, 1.0, 1234)
    for expected, found, share in zip(b.shapes(x), table.shapes(x), (2e-5, 2e-4), strict=True):
        assert_allclose(found, expected, atol=share * np.abs(expected).max())
    fine = tabled(b, np.linspace(0.0, 1.0, 1001)).shapes(x)[0]
    assert_allclose(fine, b.shapes(x)[0], atol=1e-9 * np.abs(fine).max())
    along = table.shapes_along(0.1, 1e-4, 3000)
    assert_allclose(along, table.shapes(0.1 + 1e-4 * np.arange(3000)), rtol=0.0, atol=1e-13)


def test_noise_is_not_met_with_a_high_degree():
    x, noise = np.linspace(0.0, 1.0, 41), 0.02 * np.random.default_rng(1).standard_normal(41)
    shapes = (np.sin(np.pi * x)[:, None] + each[:, None] for each in (noise, 0.0 * noise))
    assert [ModalStructure(x, [100.0], 0.01, shape).degree for shape in shapes] == [3, 9]


@pytest.mark.parametrize(("points", "warned"), [(62, False), (60, True)])
def test_fewer_than_six_points_in_a_wavelength_are_warned_of(points, warned):
    twenty = beam(highest_frequency=10e3)
    assert len(twenty.natural_frequencies) == 20  # ten wavelengths: 61 points are six in each
    with warnings.catch_warnings(record=True) as seen:
        warnings.simplefilter("always")
        tabled(twenty, np.linspace(0.0, 1.0, points))
    assert [warning.category for warning in seen] == [CoarseSamplingWarning] * warned
    if warned:
        assert "fewer than 6 (1 of 20 modes" in str(seen[0].message)


def cut_off(highest, count, points, **options):
    """A beam, the first modes of it in a table, and the flexibility of its others as a matrix."""
    many, x = beam(highest_frequency=highest, **options), np.linspace(0.0, 1.0, points)
    shapes, natural = many.shapes(x)[0], 2.0 * np.pi * many.natural_frequencies
    residual = (shapes[:, count:] / natural[count:] ** 2) @ shapes[:, count:].T
    few = many.natural_frequencies[:count], many.damping_ratios[:count], shapes[:, :count]
    return many, residual, lambda flexibility=None: ModalStructure(x, *few, residual_flexibility=flexibility)


def test_residual_flexibility_completes_the_static_compliance():
    """All modes above the tenth as a matrix: L³/48EI again at mid-span, and far less of them before."""
    many, residual, table = cut_off(60e3, 10, 101, loss_factor=0.0)
    exact, f = 1.0 / (48.0 * BENDING), np.array([10.0, 500.0])
    for flexibility in (residual, np.diag(residual)):
        assert table(flexibility).receptance(0.0, 0.5, 0.5).real == pytest.approx(exact, rel=2e-6)  # 50 modes
    assert table().receptance(0.0, 0.5, 0.5).real < exact * (1.0 - 1e-4)
    assert_allclose(table(residual).receptance(f, 0.3, 0.62), many.receptance(f, 0.3, 0.62), rtol=1e-5)


def test_a_rigid_body_is_added_by_mass_and_inertia():
    x, f = np.linspace(0.0, 2.0, 31), np.array([7.0, 90.0])
    bending = ModalStructure(x, [300.0], 0.01, np.cos(np.pi * x)[:, None])
    body = bending.with_rigid_body(4.0, inertia=2.0)
    rigid = -(1.0 / 4.0 + (0.3 - 1.0) * (1.7 - 1.0) / 2.0) / (2.0 * np.pi * f) ** 2
    assert_allclose(body.receptance(f, 0.3, 1.7) - bending.receptance(f, 0.3, 1.7), rigid, rtol=1e-9)
    assert body.natural_frequencies.tolist() == [0.0, 0.0, 300.0]
    off = bending.with_rigid_body(4.0, inertia=2.0, centre=0.5)
    assert off.shapes(0.5)[0][0, 1] == pytest.approx(0.0, abs=1e-12)
    with pytest.raises(InputError, match=r"frequency \(Hz\): received 0.*no static receptance"):
        body.receptance(0.0, 0.3, 1.7)


X = np.linspace(0.0, 1.0, 5)
SINE = np.sin(np.pi * X)[:, None]
TABLE = {"positions": X, "frequencies": [1.0], "damping": 0.1, "mode_shapes": SINE}


BAR = {"length": 1.0, "bending_stiffness": BENDING, "mass_per_length": MASS}
USUAL = {Beam: BAR, SupportedBeam: BAR, ModalStructure: TABLE, Support: {}}


test_what_is_no_structure_is_refused = refusals(
    (Beam, {"length": 0.0}, "beam length"),
    (Beam, {"bending_stiffness": np.nan}, "bending stiffness"),
    (Beam, {"highest_frequency": 0.0}, "highest frequency"),
    (Beam, {"highest_frequency": 1.0}, "above the first natural frequency"),
    (Beam, {"suspension_frequency": 0.0}, "suspension frequency"),
    (Beam, {"loss_factor": -0.1}, "loss factor"),
    (Beam, {"support": "hinged"}, "one of simply-supported, free, clamped"),
    (SupportedBeam, {"supports": [Support(0.0), Support(1.1)]}, "1.1; allowed: 0 to 1, on the beam"),
    (SupportedBeam, {"supports": [Support(0.5)] * 2}, "one place twice; allowed: different places"),
    (SupportedBeam, {"supports": ENDS["clamped"], "highest_frequency": 1.0}, "above the first natural"),
    (SupportedBeam, {"highest_frequency": 1e10}, "knots of splines; allowed: 1500 knots.*fewer supports"),
    (Support, {"position": -0.1}, r"position of a support \(m\): received -0.1; allowed: 0 and more"),
    (Support, {"position": 0.0, "stiffness": 0.0}, "allowed: a support that holds something"),
    (Support, {"position": 0.0, "loss_factor": 2.0}, "loss factor of a support: received 2.0"),
    (ModalStructure, {"positions": X[::-1]}, "numbers that do not rise; allowed: two or more rising"),
    (ModalStructure, {"frequencies": [1.0, 2.0]}, r"\(5, 1\); allowed: .*\(5, 2\): a row for each"),
    (ModalStructure, {"damping": 1.0}, "damping ratios: received 1.0; allowed: 0 and more, below 1"),
    (ModalStructure, {"damping": [0.1, 0.1]}, "damping ratios: received 2 numbers; allowed: 1"),
    (ModalStructure, {"mode_shapes": SINE * np.nan}, "mode shapes: received nan; allowed: finite"),
    (ModalStructure, {"mode_shapes": 0.0 * SINE}, "mode 1 that does not move.*Leave it out"),
    (ModalStructure, {"modal_masses": [0.0]}, r"modal masses \(kg\): received 0.0"),
    (ModalStructure, {"frequencies": [], "mode_shapes": np.zeros((5, 0))}, "none; allowed: at least"),
    (ModalStructure, {"residual_flexibility": -X}, "residual flexibility.*received -1.0"),
    (ModalStructure, {"residual_flexibility": X[:3]}, r"received shape \(3,\)"),
    (ModalStructure, {"residual_flexibility": 1e-9 - 2e-9 * np.eye(5)}, "-2·10⁻⁹ m/N.*create energy"),
    (ModalStructure, {"residual_flexibility": np.triu(np.ones((5, 5)))}, "not symmetric"),
    of=lambda kind, change: kind(**(USUAL[kind] | change)),
)


TABLED = ModalStructure(**TABLE)


test_bad_questions_are_refused = refusals(
    (lambda: Beam.rectangular(1.0, -0.05, 0.01, STEEL), "beam width"),
    (lambda: beam().shapes([0.5, 1.1]), "positions on the beam"),
    (lambda: beam().shapes_along(0.9, 1e-3, 300), "positions on the beam"),
    (lambda: supported(ENDS["clamped"]).shapes(1.2), "received 1.2 to 1.2; allowed: 0 to 1"),
    (lambda: TABLED.shapes(1.2), r"positions on the structure \(m\): received 1.2 to 1.2"),
    (lambda: TABLED.with_rigid_body(-1.0), r"mass \(kg\): received -1"),
    (lambda: material("aluminum"), 'Did you mean "aluminium"'),
    (lambda: Material("jelly", 0.0, 0.3, 1000.0), "Young's modulus"),
    (lambda: Material("jelly", 1e5, 0.6, 1000.0), "Poisson's ratio"),
)


def test_materials():
    assert_allclose(contact_modulus(STEEL, STEEL), 210e9 / (2 * 0.91), rtol=1e-15)
    assert all(m.citation for m in MATERIALS.values())
    assert material(" Steel ") is STEEL
