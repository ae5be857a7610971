"""The contact laws: closed forms, slopes, damping, slow bumps, the static state."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.optimize import brentq

from asperity.errors import ComputationError, InputError
from asperity.kernels.pointforce import Prepared, evaluate, evaluate_all, with_damping
from asperity.laws import Areal, HertzLaw, Linear, Printed, Shifted, Table, names
from asperity.laws.layout import _straight_to_touch, force, on_curve
from asperity.reduction.stiffness import ForceCurve
from asperity.reduction.table import ForceTable
from asperity.reduction.texture import StateTexture
from asperity.rolling.rest import at_rest
from asperity.structures.body import Body

K = 2.4e10  # N/m^1.5, a steel ball of 25 mm on steel
LOAD = 5.0
SPACING = 1e-5
HERTZ = ForceCurve.hertz(K)
WORKING = float(HERTZ.inverse(LOAD))


def waves(states=3, points=400, seed=0):
    """A texture that differs from state to state, slowly enough not to outrun the approach."""
    x = SPACING * np.arange(points)
    rng = np.random.default_rng(seed)
    rows = [0.1e-6 * np.sin(2 * np.pi * x / 3e-4 + p) for p in 0.5 * rng.standard_normal(states)]
    return StateTexture(np.array(rows), np.linspace(-0.5e-6, 1.5e-6, states), 0.0, SPACING)


def shifted_table(height, states=40):
    """Table of a contact whose force is Hertz's of the approach less the texture."""
    approaches = np.linspace(-2e-6, 3e-6, states)
    return ForceTable(HERTZ.force(approaches[:, None] - height), approaches, 0.0, SPACING)


def resting(law, load):
    """Approach, and stiffness there, at which a body under a load rests on a law."""
    rest = at_rest([Body.rigid(1.0, load)], np.zeros(1), np.zeros((1, 1)), [law])
    return rest.approach[0], rest.stiffness[0]


def every_law():
    texture = waves()
    return [
        Printed(HERTZ, texture, datum=0.4e-6),
        Shifted(HERTZ, texture),
        Areal(HERTZ, texture),
        Table(shifted_table(texture.heights[1])),
        HertzLaw(K, texture),
        Linear(LOAD, 3e7, WORKING, texture),
    ]


def test_registry_knows_every_law_by_its_name():
    assert {law.name for law in every_law()} == {name for name in names() if "-" not in name} - {"direct"}


@pytest.mark.parametrize("law", every_law(), ids=lambda law: law.name)
def test_slope_is_the_derivative_of_the_force(law):
    positions = np.linspace(1e-4, 3.5e-3, 60)
    prepared = law.prepare(positions)
    approach = np.linspace(0.2e-6, 1.3e-6, 60) + 1.234e-9
    step = 1e-13
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


PREPARED = [law.prepare(np.linspace(1e-4, 3.5e-3, 60)) for law in every_law()]


def test_printed_is_equation_2_1():
    texture, datum = waves(), 0.4e-6
    positions = np.array([0.7e-3, 1.1e-3])
    approach = 0.25e-6  # between the first two states, at -0.5 and 0.5 um
    height = 0.25 * texture.at(positions)[:, 0] + 0.75 * texture.at(positions)[:, 1]
    r = approach + datum
    expected = K * approach**1.5 / r * (r - height)
    assert_allclose(force(Printed(HERTZ, texture, datum), positions, approach), expected, rtol=1e-12)


def test_shifted_areal_and_hertz_follow_the_texture():
    texture = waves(states=1)
    positions = np.linspace(1e-4, 3e-3, 50)
    expected = K * np.maximum(WORKING - texture.at(positions)[:, 0], 0.0) ** 1.5
    for law in (Shifted(HERTZ, texture), Areal(HERTZ, texture), HertzLaw(K, texture)):
        assert_allclose(force(law, positions, WORKING), expected, rtol=1e-12)
    assert_allclose(force(HertzLaw(K), positions, WORKING), LOAD, rtol=1e-12)


def test_table_reproduces_a_hertzian_table_between_its_nodes():
    texture = waves(states=1)
    positions = np.linspace(1e-4, 3e-3, 333)
    law = Table(shifted_table(texture.heights[0], states=6))
    # first touch between two states included
    for approach in (WORKING, 0.3e-6, 0.05e-6, -0.05e-6):
        expected = K * np.maximum(approach - texture.at(positions)[:, 0], 0.0) ** 1.5
        assert_allclose(force(law, positions, approach), expected, rtol=1e-3, atol=1e-3 * LOAD)


def test_linear_is_linear_and_pulls():
    law = Linear(LOAD, 3e7, WORKING)
    approach = WORKING + np.array([-1e-6, 0.0, 1e-6])
    assert_allclose(force(law, np.zeros(3), approach), LOAD + 3e7 * (approach - WORKING), rtol=1e-12)
    assert force(law, 0.0, WORKING - 1e-6) < 0.0


def test_texture_is_held_outside_its_states():
    texture = waves()
    positions = np.array([1e-3])
    law = Shifted(ForceCurve.hertz(K), texture)
    expected = K * (5e-6 - texture.at(positions)[:, -1]) ** 1.5
    assert_allclose(force(law, positions, 5e-6), expected, rtol=1e-12)


@pytest.mark.parametrize("name", ["shifted", "areal", "table"])
def test_slow_bump_lifts_the_body_by_its_height(name):
    bump = 0.02e-6
    height = np.full(50, -bump)  # a peak: negative away from contact
    texture = StateTexture.unfiltered(height, SPACING)
    follows = {"shifted": Shifted, "areal": Areal}
    law = Table(shifted_table(height)) if name == "table" else follows[name](HERTZ, texture)
    approach, _ = resting(lambda s: evaluate(law.prepare(2e-4), 0, s), LOAD)
    assert_allclose((WORKING - approach) / bump, 1.0, rtol=0.01)


def test_printed_follows_two_thirds_of_a_slow_bump():
    bump = 1e-4 * WORKING
    law = Printed(HERTZ, StateTexture.unfiltered(np.full(50, -bump), SPACING), datum=0.0)
    approach, _ = resting(lambda s: evaluate(law.prepare(2e-4), 0, s), LOAD)
    assert_allclose((WORKING - approach) / bump, 2.0 / 3.0, rtol=1e-3)


def test_damping_acts_in_contact_only_and_never_pulls():
    # in contact: c times the rate that is left after the force has slowed it
    value, slope = with_damping(5.0, 1e7, 0.02, 1e-3, 100.0, False)
    assert_allclose(value, 5.0 + 100.0 * (0.02 - 1e-3 * value), rtol=1e-14)
    assert_allclose(slope, 1e7 / 1.1, rtol=1e-14)
    assert with_damping(0.0, 0.0, 0.02, 1e-3, 100.0, False) == (0.0, 0.0)
    assert with_damping(5.0, 1e7, -1.0, 0.0, 100.0, False) == (0.0, 0.0)


def test_printed_and_linear_damp_in_flight():
    assert with_damping(0.0, 0.0, -0.02, 0.0, 100.0, True) == (-2.0, 0.0)
    in_flight = {law.name: law.prepare(np.array([1e-3])).damped_in_flight for law in every_law()}
    assert {name for name, acts in in_flight.items() if acts} == {"printed", "linear"}


def test_arguments_beyond_the_data_are_counted():
    s = np.linspace(0.0, 1e-6, 6)
    curve = ForceCurve.from_samples(s, HERTZ.force(s))
    texture = StateTexture.unfiltered(np.array([0.0, 0.0, 0.5e-6, 0.5e-6, 0.5e-6]), SPACING)
    prepared = Shifted(curve, texture).prepare(SPACING * np.arange(4))
    assert isinstance(prepared, Prepared)
    assert evaluate_all(prepared, np.full(4, 1.2e-6), 0)[2] == 2
    assert evaluate_all(on_curve(curve, None, np.zeros(3)), np.array([0.9e-6, 1.0e-6, 1.1e-6]), 0)[2] == 1
    assert evaluate_all(HertzLaw(K).prepare(np.zeros(1)), np.array([1.0]), 0)[2] == 0


@given(st.floats(1e-3, 1e4))
@settings(max_examples=40)
def test_a_body_at_rest_is_where_the_law_carries_its_load(load):
    law = Shifted(HERTZ, waves())
    prepared = law.prepare(np.array([7e-4]))
    approach, stiffness = resting(lambda s: evaluate(prepared, 0, s), load)
    root = brentq(lambda s: evaluate(prepared, 0, s)[0] - load, -1e-3, 1e-2, xtol=1e-18)
    assert_allclose(approach, root, rtol=1e-7)
    assert_allclose(stiffness, evaluate(prepared, 0, approach)[1])


def test_load_that_no_approach_carries():
    with pytest.raises(
        ComputationError, match=r"do not come to rest .* loads of 5 N the last .*smaller load"
    ):
        resting(lambda s: (0.0, 0.0), 5.0)


@pytest.mark.parametrize("damping", [-1.0, np.nan])
def test_bad_damping_is_refused(damping):
    for law in every_law():
        with pytest.raises(InputError, match="contact damping"):
            replace(law, damping=damping).prepare(np.zeros(1))


def test_datum_below_the_first_touch_is_refused():
    s = np.linspace(-3e-6, 1e-6, 5)
    curve = ForceCurve.from_samples(s, (s + 3e-6) * 1e6)
    with pytest.raises(InputError, match=r"datum of the state .*at least 3e-06.*highest first touch"):
        Printed(curve, None, datum=1e-6)
    assert Printed(curve, None, datum=3e-6).datum == 3e-6


@pytest.mark.parametrize(("beyond", "replaced"), [(0.15, True), (0.25, False)])
def test_the_state_just_beyond_a_first_touch_lies_on_the_line_to_the_next(beyond, replaced):
    """Less than a fifth of a state's distance beyond, its force is rounding of the scan."""
    states, touch = np.arange(6.0), 2.0 - beyond
    root = np.array([[0.0, 0.0, 0.7, 3.0, 4.0, 5.0]])
    found = _straight_to_touch(states, root, np.array([touch]))
    line = 3.0 / (3.0 - touch) * beyond
    assert found[0, 2] == pytest.approx(line if replaced else 0.7)
    np.testing.assert_array_equal(found[0, 3:], root[0, 3:])
