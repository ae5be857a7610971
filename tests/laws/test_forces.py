"""The contact laws: closed forms, slopes, damping, the static state."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.optimize import brentq

from asperity.kernels.pointforce import evaluate, evaluate_all, with_damping
from asperity.laws import Areal, HertzLaw, Linear, Printed, Shifted, Table, names
from asperity.laws.layout import force, on_curve, on_table
from asperity.reduction.stiffness import ForceCurve, ForceTable
from asperity.reduction.texture import StateTexture
from asperity.rolling.rest import at_rest
from asperity.structures.body import Body

K = 2.4e10  # N/m^1.5, a steel ball of 25 mm on steel
LOAD, SPACING = 5.0, 1e-5
HERTZ = ForceCurve.hertz(K)
WORKING = float(HERTZ.inverse(LOAD))
POSITIONS = np.linspace(1e-4, 3.5e-3, 60)


def waves(states=3):
    """A texture that differs from state to state, slowly enough not to outrun the approach."""
    phase = 2 * np.pi * SPACING * np.arange(400) / 3e-4
    shifts = 0.5 * np.random.default_rng(0).standard_normal((states, 1))
    return StateTexture(0.1e-6 * np.sin(phase + shifts), np.linspace(-0.5e-6, 1.5e-6, states), 0.0, SPACING)


def shifted_table(height, states=40, spacing=SPACING):
    """Table of a contact whose force is Hertz's of the approach less the texture."""
    approaches = np.linspace(-2e-6, 3e-6, states)
    return ForceTable(HERTZ.force(approaches[:, None] - height), approaches, 0.0, spacing, height)


TEXTURE, ALIKE = waves(), waves(states=1)
LAWS = [
    Printed(HERTZ, TEXTURE, datum=0.4e-6),
    Shifted(HERTZ, TEXTURE),
    Areal(HERTZ, TEXTURE),
    Table(shifted_table(TEXTURE.heights[1])),
    HertzLaw(K, TEXTURE),
    Linear(LOAD, 3e7, WORKING, TEXTURE),
]
PREPARED = [law.prepare(POSITIONS) for law in LAWS]


def test_slope_is_the_derivative_of_the_force_of_every_law():
    assert {law.name for law in LAWS} == {name for name in names() if "-" not in name} - {"direct"}
    approach, step = np.linspace(0.2e-6, 1.3e-6, 60) + 1.234e-9, 1e-13
    for prepared in PREPARED:
        above, below = (evaluate_all(prepared, approach + s, 0)[0] for s in (step, -step))
        value, slope, _ = evaluate_all(prepared, approach, 0)
        assert np.all(value != 0.0)
        assert_allclose(slope, (above - below) / (2 * step), rtol=1e-4)


@given(st.floats(-1e-6, 2.5e-6), st.floats(1e-9, 1e-6), st.integers(0, 59))
@settings(max_examples=200)
def test_force_never_falls_with_the_approach(approach, more, step):
    for prepared in PREPARED:
        low, high = evaluate(prepared, step, approach)[0], evaluate(prepared, step, approach + more)[0]
        assert high >= low * (1.0 - 1e-12)
        assert low >= 0.0 or prepared.bilateral


def test_printed_is_equation_2_1():
    approach = 0.25e-6  # between the first two states, at -0.5 and 0.5 um
    height = TEXTURE.at(POSITIONS)[:, :2] @ [0.25, 0.75]
    r = approach + 0.4e-6
    expected = K * approach**1.5 / r * (r - height)
    assert_allclose(force(LAWS[0], POSITIONS, approach), expected, rtol=1e-12)


def test_laws_follow_the_texture_by_hertz():
    followed = K * np.maximum(WORKING - ALIKE.at(POSITIONS)[:, 0], 0.0) ** 1.5
    for law in (Shifted(HERTZ, ALIKE), Areal(HERTZ, ALIKE), HertzLaw(K, ALIKE)):
        assert_allclose(force(law, POSITIONS, WORKING), followed, rtol=1e-12)
    assert_allclose(force(HertzLaw(K), POSITIONS, WORKING), LOAD, rtol=1e-12)
    plane = StateTexture.unfiltered(np.full(400, 0.2e-6), SPACING)
    planes = [force(law, POSITIONS, WORKING) for law in (HertzLaw(K, TEXTURE, plane=plane), LAWS[4])]
    assert_allclose(planes[0], force(Shifted(HERTZ, TEXTURE, plane=plane), POSITIONS, WORKING), rtol=1e-12)
    assert np.abs(planes[0] - planes[1]).max() > 0.01 * LOAD
    held = K * (5e-6 - TEXTURE.at(POSITIONS)[:, -1]) ** 1.5  # beyond the last state
    assert_allclose(force(Shifted(HERTZ, TEXTURE), POSITIONS, 5e-6), held, rtol=1e-12)


def test_table_reproduces_a_hertzian_table_between_its_nodes():
    positions = np.linspace(1e-4, 3e-3, 333)
    fine = 0.1 * SPACING  # first touch is known along straight lines
    law = Table(shifted_table(ALIKE.at(fine * np.arange(3500))[:, 0], states=6, spacing=fine))
    # first touch between two states included
    for approach in (WORKING, 0.3e-6, 0.05e-6, -0.05e-6):
        expected = K * np.maximum(approach - ALIKE.at(positions)[:, 0], 0.0) ** 1.5
        assert_allclose(force(law, positions, approach), expected, rtol=1e-3, atol=1e-3 * LOAD)


def test_damping_acts_in_contact_and_never_pulls_but_of_printed_and_linear():
    # in contact: c times the rate that is left after the force has slowed it
    value, slope = with_damping(5.0, 1e7, 0.02, 1e-3, 100.0, False)
    assert_allclose(value, 5.0 + 100.0 * (0.02 - 1e-3 * value), rtol=1e-14)
    assert_allclose(slope, 1e7 / 1.1, rtol=1e-14)
    assert with_damping(0.0, 0.0, 0.02, 1e-3, 100.0, False) == (0.0, 0.0)
    assert with_damping(5.0, 1e7, -1.0, 0.0, 100.0, False) == (0.0, 0.0)
    assert with_damping(0.0, 0.0, -0.02, 0.0, 100.0, True) == (-2.0, 0.0)
    in_flight = zip(LAWS, PREPARED, strict=True)
    assert {law.name for law, laid in in_flight if laid.damped_in_flight} == {"printed", "linear"}


def test_arguments_beyond_the_data_are_counted():
    s = np.linspace(0.0, 1e-6, 6)
    curve = ForceCurve.from_samples(s, HERTZ.force(s))
    texture = StateTexture.unfiltered(np.array([0.0, 0.0, 0.5e-6, 0.5e-6, 0.5e-6]), SPACING)
    prepared = Shifted(curve, texture).prepare(SPACING * np.arange(4))
    assert evaluate_all(prepared, np.full(4, 1.2e-6), 0)[2] == 2
    assert evaluate_all(on_curve(curve, None, np.zeros(3)), np.array([0.9e-6, 1.0e-6, 1.1e-6]), 0)[2] == 1
    assert evaluate_all(HertzLaw(K).prepare(np.zeros(1)), np.array([1.0]), 0)[2] == 0


@given(st.floats(1e-3, 1e4))
@settings(max_examples=40)
def test_a_body_at_rest_is_where_the_law_carries_its_load(load):
    def law(approach):
        return evaluate(PREPARED[1], 7, approach)

    def laws(approach):
        return np.array([law(at) for at in approach]).T

    one = [Body.rigid(1.0, load)], np.zeros(1), np.zeros((1, 1)), laws, np.array([load])
    _, _, approach, stiffness = at_rest(*one)
    root = brentq(lambda s: law(s)[0] - load, -1e-3, 1e-2, xtol=1e-18)
    assert_allclose(approach, root, rtol=1e-7)
    assert_allclose(stiffness, law(approach[0])[1])


@pytest.mark.parametrize(("beyond", "replaced"), [(0.15, True), (0.25, False)])
def test_the_state_just_beyond_a_first_touch_lies_on_the_line_to_the_next(beyond, replaced):
    """Less than a fifth of a state's distance beyond, its force is rounding of the scan."""
    root = np.array([0.0, 0.0, 0.7, 3.0, 4.0, 5.0])
    even = np.ones(9)
    table = ForceTable(np.outer(root**1.5, even), np.arange(6.0), 0.0, SPACING, (2.0 - beyond) * even)
    found = on_table(table, [3.3 * SPACING], damping=0.0, plane=None).values[0]
    line = 3.0 / (1.0 + beyond) * beyond
    assert found[2] == pytest.approx(line if replaced else 0.7)
    assert found[3:] == pytest.approx(root[3:])
