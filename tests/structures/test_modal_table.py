"""Structures by their modes: the built-in beam from a table, residual flexibility, rigid bodies, refusals."""

import warnings

import numpy as np
import pytest
from numpy.testing import assert_allclose

from asperity.errors import CoarseSamplingWarning, InputError
from asperity.laws import HertzLaw
from asperity.reduction.texture import StateTexture
from asperity.reference.materials import material
from asperity.rolling.roll import roll_bodies
from asperity.structures.beam import SUPPORTS, Beam
from asperity.structures.body import Body
from asperity.structures.modal import ModalStructure

STEEL = material("steel")
FORTY = Beam.rectangular(1.0, 0.05, 0.01, STEEL, highest_frequency=37.6e3)


def tabled(beam, positions, **options):
    shapes = beam.shapes(positions)[0]
    return ModalStructure(positions, beam.natural_frequencies, beam.damping_ratios, shapes, **options)


def rolled(structure):
    """Two balls one behind the other, over a wave of 10 mm."""
    balls = [Body.rigid(0.5, 30.0)] * 2
    heights = 3e-7 * np.sin(2 * np.pi * np.arange(0.0, 0.25, 1e-4) / 0.01)
    law = HertzLaw(2.4e10, StateTexture.unfiltered(heights, 1e-4, 0.2))
    options = {"speed": 2.0, "start": 0.2, "duration": 0.04, "time_step": 5e-6, "positions": [0.0, 0.15]}
    return roll_bodies(structure, balls, [law] * 2, **options)


def test_forty_modes_from_a_table_roll_as_the_beam_does():
    assert len(FORTY.natural_frequencies) == 40
    table = tabled(FORTY, np.linspace(0.0, 1.0, 1001))
    expected, found = rolled(FORTY), rolled(table)
    assert np.ptp(expected.contact_force) > 1.0  # N
    assert_allclose(found.contact_force, expected.contact_force, rtol=0.0, atol=1e-9 * 30.0)
    deflection = np.abs(expected.over_displacement).max()
    assert_allclose(found.over_displacement, expected.over_displacement, rtol=0.0, atol=1e-9 * deflection)


@pytest.mark.parametrize("support", SUPPORTS)
def test_shapes_between_points_are_those_of_the_beam(support):
    """Ends of clamped and free beams decay within a wavelength, and are the hardest."""
    beam = Beam.rectangular(1.0, 0.05, 0.01, STEEL, support=support, highest_frequency=3e3)
    table = tabled(beam, np.linspace(0.0, 1.0, 101))
    x = np.linspace(0.0, 1.0, 1234)
    expected, found = beam.shapes(x), table.shapes(x)
    assert_allclose(found[0], expected[0], atol=2e-5 * np.abs(expected[0]).max())
    assert_allclose(found[1], expected[1], atol=2e-4 * np.abs(expected[1]).max())
    along = table.shapes_along(0.1, 1e-4, 3000)
    assert_allclose(along, table.shapes(0.1 + 1e-4 * np.arange(3000)), rtol=0.0, atol=1e-13)


def test_few_points_at_unequal_distances_do_well():
    """Nodes of a finite-element model: 12 to 25 points in the shortest wavelength, a ratio of two."""
    beam = Beam.rectangular(1.0, 0.05, 0.01, STEEL, highest_frequency=2.4e3)
    assert len(beam.natural_frequencies) == 10
    steps = np.random.default_rng(3).uniform(1.0, 2.0, 90)
    x = np.concatenate([[0.0], np.cumsum(steps) / steps.sum()])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        table = tabled(beam, x)
    at = np.linspace(0.0, 1.0, 999)
    assert_allclose(table.shapes(at)[0], beam.shapes(at)[0], atol=1e-6)
    f = np.linspace(20.0, 2e3, 50)
    assert_allclose(table.receptance(f, 0.31, 0.62), beam.receptance(f, 0.31, 0.62), rtol=1e-5)


def test_noise_is_not_met_with_a_high_degree():
    x = np.linspace(0.0, 1.0, 41)
    shape = np.sin(np.pi * x) + 0.02 * np.random.default_rng(1).standard_normal(x.size)
    assert ModalStructure(x, [100.0], 0.01, shape[:, None]).degree == 3
    assert ModalStructure(x, [100.0], 0.01, np.sin(np.pi * x)[:, None]).degree == 9


@pytest.mark.parametrize(("points", "warned"), [(62, False), (60, True)])
def test_fewer_than_six_points_in_a_wavelength_are_warned_of(points, warned):
    beam = Beam.rectangular(1.0, 0.05, 0.01, STEEL, highest_frequency=10e3)
    assert len(beam.natural_frequencies) == 20  # ten wavelengths: 61 points are six in each
    x = np.linspace(0.0, 1.0, points)
    with warnings.catch_warnings(record=True) as seen:
        warnings.simplefilter("always")
        tabled(beam, x)
    assert [warning.category for warning in seen] == [CoarseSamplingWarning] * warned
    if warned:
        assert "fewer than 6 (1 of 20 modes" in str(seen[0].message)


def test_residual_flexibility_completes_the_static_compliance():
    """All modes above the tenth as a matrix: L³/48EI again at mid-span, and far less of them before."""
    many = Beam.rectangular(1.0, 0.05, 0.01, STEEL, highest_frequency=60e3, loss_factor=0.0)
    x = np.linspace(0.0, 1.0, 101)
    shapes, natural = many.shapes(x)[0], 2.0 * np.pi * many.natural_frequencies
    residual = (shapes[:, 10:] / natural[10:] ** 2) @ shapes[:, 10:].T
    of_ten = (many.natural_frequencies[:10], 0.0, shapes[:, :10])
    exact = 1.0 / (48.0 * many.bending_stiffness)
    bare = ModalStructure(x, *of_ten)
    for flexibility in (residual, np.diag(residual)):
        whole = ModalStructure(x, *of_ten, residual_flexibility=flexibility)
        assert whole.receptance(0.0, 0.5, 0.5).real == pytest.approx(exact, rel=2e-6)  # 50 modes
    assert bare.receptance(0.0, 0.5, 0.5).real < exact * (1.0 - 1e-4)
    matrix = ModalStructure(x, *of_ten, residual_flexibility=residual)
    f = np.array([10.0, 500.0])
    assert_allclose(matrix.receptance(f, 0.3, 0.62), many.receptance(f, 0.3, 0.62), rtol=1e-5)


def test_modes_above_a_record_carry_on_as_their_flexibility():
    """Twenty modes and the flexibility of nine more roll as all of them do; without it far from that."""
    many = Beam.rectangular(1.0, 0.05, 0.01, STEEL, highest_frequency=20e3)
    x = np.linspace(0.0, 1.0, 401)
    shapes, natural = many.shapes(x)[0], 2.0 * np.pi * many.natural_frequencies
    residual = (shapes[:, 20:] / natural[20:] ** 2) @ shapes[:, 20:].T
    few = many.natural_frequencies[:20], many.damping_ratios[:20], shapes[:, :20]
    bare, whole = ModalStructure(x, *few), ModalStructure(x, *few, residual_flexibility=residual)
    expected = rolled(many).contact_force
    error = [np.abs(rolled(each).contact_force - expected).max() for each in (bare, whole)]
    assert error[0] > 0.1 * np.ptp(expected)
    assert error[1] < 0.05 * error[0]


def test_a_rigid_body_is_added_by_mass_and_inertia():
    x = np.linspace(0.0, 2.0, 31)
    body = ModalStructure(x, [300.0], 0.01, np.cos(np.pi * x)[:, None]).with_rigid_body(4.0, inertia=2.0)
    bending = ModalStructure(x, [300.0], 0.01, np.cos(np.pi * x)[:, None])
    f = np.array([7.0, 90.0])
    rigid = -(1.0 / 4.0 + (0.3 - 1.0) * (1.7 - 1.0) / 2.0) / (2.0 * np.pi * f) ** 2
    found = body.receptance(f, 0.3, 1.7) - bending.receptance(f, 0.3, 1.7)
    assert_allclose(found, rigid, rtol=1e-9)
    assert body.natural_frequencies.tolist() == [0.0, 0.0, 300.0]
    with pytest.raises(InputError, match=r"frequency \(Hz\): received 0.*no static receptance"):
        body.receptance(0.0, 0.3, 1.7)
    off = ModalStructure(x, [300.0], 0.01, np.cos(np.pi * x)[:, None]).with_rigid_body(
        4.0, inertia=2.0, centre=0.5
    )
    assert off.shapes(0.5)[0][0, 1] == pytest.approx(0.0, abs=1e-12)


def test_modal_masses_scale_the_shapes():
    x = np.linspace(0.0, 1.0, 31)
    table = ModalStructure(x, [50.0], [0.02], np.sin(np.pi * x)[:, None], modal_masses=[3.0])
    assert table.receptance(0.0, 0.5, 0.5) == pytest.approx(1.0 / (3.0 * (100.0 * np.pi) ** 2))
    assert table.receptance(50.0, 0.5, 0.5).imag < 0.0  # damped under e^{+iωt}


X = np.linspace(0.0, 1.0, 5)
SINE = np.sin(np.pi * X)[:, None]


@pytest.mark.parametrize(
    ("arguments", "options", "message"),
    [
        ((X[::-1], [1.0], 0.1, SINE), {}, "numbers that do not rise; allowed: two or more rising"),
        ((X, [1.0, 2.0], 0.1, SINE), {}, r"received shape \(5, 1\); allowed: \(5, 2\): a row for each"),
        ((X, [-1.0], 0.1, SINE), {}, r"natural frequencies \(Hz\): received -1.0; allowed: 0 and more"),
        ((X, [1.0], 1.0, SINE), {}, "damping ratios: received 1.0; allowed: 0 and more, below 1"),
        ((X, [1.0], [0.1, 0.1], SINE), {}, r"damping ratios: received 2 numbers; allowed: 1"),
        ((X, [1.0], 0.1, SINE * np.nan), {}, "mode shapes: received values that are not finite"),
        ((X, [1.0], 0.1, 0.0 * SINE), {}, "mode 1 that does not move anywhere.*Leave it out"),
        ((X, [1.0], 0.1, SINE), {"modal_masses": [0.0]}, r"modal masses \(kg\): received 0.0"),
        ((X, [], [], np.zeros((5, 0))), {}, "natural frequencies.*received none; allowed: at least one"),
        ((X, [1.0], 0.1, SINE), {"residual_flexibility": -X}, "residual flexibility.*received -1.0"),
        ((X, [1.0], 0.1, SINE), {"residual_flexibility": X[:3]}, r"received shape \(3,\)"),
        (
            (X, [1.0], 0.1, SINE),
            {"residual_flexibility": 1e-9 - 2e-9 * np.eye(5)},
            "an eigenvalue of -2e-09 m/N; allowed: no negative one: it would create energy",
        ),
        ((X, [1.0], 0.1, SINE), {"residual_flexibility": np.triu(np.ones((5, 5)))}, "not symmetric"),
    ],
)
def test_what_is_no_structure_is_refused(arguments, options, message):
    with pytest.raises(InputError, match=message):
        ModalStructure(*arguments, **options)


def test_a_place_off_the_structure_is_refused():
    table = ModalStructure(X, [1.0], 0.1, SINE)
    with pytest.raises(InputError, match=r"positions on the structure \(m\): received 1.2 to 1.2"):
        table.shapes(1.2)
    with pytest.raises(InputError, match=r"mass \(kg\): received -1"):
        table.with_rigid_body(-1.0)
