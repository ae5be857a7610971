"""The direct law, and what every consistent law must do on a slow bump."""

import numpy as np
import pytest

from asperity import HalfSpace, Hertz
from asperity.contact.scan import ScanJob, first_touch, scan_forces
from asperity.errors import TruncatedContactWarning
from asperity.laws import Areal, Direct, Printed, Shifted, Table
from asperity.laws.layout import force
from asperity.reduction.filter import filtered_texture
from asperity.reduction.stiffness import ForceCurve, ForceTable
from asperity.reduction.texture import areal_texture
from asperity.rolling.rest import STEPPED_TOLERANCE, at_rest, evaluated
from asperity.structures.body import Body
from asperity.surfaces.faults import Fault, lay
from asperity.surfaces.strip import Rows
from refusals import refusals

DX, N, RADIUS, MODULUS, LOAD = 5e-6, 31, 10e-3, 115e9, 2.0
HERTZ = Hertz(MODULUS, RADIUS, RADIUS)
HALF_SPACE = HalfSpace((N, N), (DX, DX), MODULUS)
BODY = np.add.outer(*[((np.arange(N) - N // 2) * DX) ** 2 / (2 * RADIUS)] * 2)
ROUGH = 0.02e-6 * np.random.default_rng(0).standard_normal((60, N))


def direct(heights=ROUGH, **options):
    return Direct(heights, BODY, (DX, DX), MODULUS, start=0.0, **options)


def test_it_is_the_half_space_under_the_position():
    law = direct(rtol=1e-10).prepare([20 * DX, 33 * DX])
    for step, row in enumerate((20, 33)):
        alone = HALF_SPACE.solve(BODY - ROUGH[row - 15 : row + 16], approach=0.2e-6, rtol=1e-10)
        found, slope = law.evaluate(step, 0.2e-6)
        assert found == pytest.approx(alone.force, rel=1e-8)
        assert slope == pytest.approx(alone.stiffness, rel=1e-6)
        law.accept(step)
    assert law.evaluate(1, -1e-6) == (0.0, 0.0)


@pytest.mark.parametrize("hardness", [None, 1e9])
def test_edges_of_a_pit_give_way_as_under_a_contact_of_its_own(hardness):
    """They flow in part, too; where the window leaves the pit nothing of it stays."""
    pit = Fault("pit", angle=0.5, length=0.06e-3, depth=0.05e-3)
    faults, edges = lay((pit,), (400, N), (DX, DX))
    nothing = np.zeros(faults.shape)
    options = {"faults": faults, "edges": edges, "hardness": hardness, "rtol": 1e-9}
    space = HalfSpace((N, N), (DX, DX), MODULUS, hardness)
    rows = [32, 36, 200, 35]
    law = direct(nothing, **options).prepare(np.array(rows) * DX)
    for step, row in enumerate(rows):
        window = slice(row - N // 2, row + N // 2 + 1)
        under = edges.rearranged(lambda field, window=window: field[window])
        alone = space.solve(BODY - faults[window], approach=0.5e-6, rtol=1e-9, edges=under)
        found, slope = law.evaluate(step, 0.5e-6)
        assert found == pytest.approx(alone.force, rel=1e-7)
        assert slope == pytest.approx(alone.stiffness, rel=1e-5)
        law.accept(step)


def test_at_rest_it_carries_the_load_at_any_tolerance():
    """The contact from which rolling starts, against one that is solved under the load."""
    law = direct(rtol=0.01).prepare([20 * DX, 21 * DX])
    one, laws = [Body.rigid(1.0, LOAD)], evaluated([law], np.zeros(1))
    _, _, approach, _ = at_rest(one, np.zeros(1), np.zeros((1, 1)), laws, np.array([LOAD]), STEPPED_TOLERANCE)
    alone = HALF_SPACE.solve(BODY - ROUGH[5:36], load=LOAD, rtol=1e-9)
    assert approach[0] == pytest.approx(alone.approach, rel=1e-4)


def test_short_waves_survive_between_rows():
    """Cubic splines would lose (k/(1 − k))⁴ of a wave of k cycles a row, and the force 3e-5."""
    here, beyond = (
        0.05e-6 * np.cos(2 * np.pi * (np.arange(80) + by) / 12)[:, None] * np.ones((1, N)) for by in (0, 0.4)
    )
    between, on_row = (direct(each, rtol=1e-9) for each in (here, beyond))
    assert force(between, [40.4 * DX], 0.2e-6) == pytest.approx(force(on_row, [40 * DX], 0.2e-6), rel=1e-6)


def test_going_on_from_a_saved_state_repeats_every_bit():
    whole, resumed = (direct().prepare((20 + np.arange(12)) * DX) for _ in range(2))
    expected = []
    for step in range(12):
        if step == 5:
            state = {name: value.copy() for name, value in whole.state().items()}
        expected.append(whole.evaluate(step, 0.2e-6))
        whole.accept(step)
    resumed.restore(state)
    for step in range(5, 12):
        assert resumed.evaluate(step, 0.2e-6) == expected[step]
        resumed.accept(step)
    np.testing.assert_array_equal(resumed.counts, whole.counts)


def test_contacts_cut_off_are_told():
    law = direct().prepare([20 * DX])
    law.evaluate(0, 0.8e-6)
    law.accept(0)
    with pytest.warns(TruncatedContactWarning, match="in 1 of 1 contact solutions of the direct law"):
        law.warn_of_flaws()


test_sizes_and_paths_must_fit = refusals(
    (lambda: direct().prepare([10 * DX]), r"path \(m\): received"),
)


HEIGHT, ROWS = 5e-9, 1201
BUMP = HEIGHT * np.exp(-(((np.arange(ROWS) - ROWS // 2) * DX / 1e-3) ** 2))[:, None] * np.ones((1, N))
STATES = HERTZ.approach(LOAD) * np.array([0.5, 1.0, 1.5])
AREAL = areal_texture(BUMP, (DX, DX), STATES, [HERTZ.semi_axes(each) for each in STATES])
LINE = filtered_texture(BUMP[:, N // 2], DX, np.full((3, 21), 1 / 21), STATES)
CURVE = ForceCurve.hertz(HERTZ.stiffness_constant)


def looked_up():
    approaches = np.linspace(-0.1e-6, 0.5e-6, 13)
    scanned = scan_forces(ScanJob(HALF_SPACE, Rows(BUMP), BODY, approaches, stride=15))
    touches = first_touch(BUMP, BODY, 15)
    return Table(ForceTable(scanned.forces, approaches, N // 2 * DX, 15 * DX, touches))


@pytest.mark.parametrize(
    ("law", "share"),
    [
        (direct(BUMP, rtol=1e-8), 1.0),
        (looked_up(), 1.0),
        (Shifted(CURVE, LINE), 1.0),
        (Areal(CURVE, AREAL), 1.0),
        (Areal(CURVE, AREAL, plane=type(AREAL).unfiltered(AREAL.heights[1], DX)), 1.0),
        # the documented defect: secant stiffness against tangent motion, h/(1 + n) with n = 1/2
        (Printed(CURVE, LINE, datum=0.0), 2 / 3),
    ],
    ids=["direct", "table", "shifted", "areal", "areal, from a plane", "printed"],
)
def test_under_constant_load_the_ball_follows_a_slow_bump(law, share):
    """By how much it is lifted at the top, from a place without bump; 20 contact radii wide."""
    approach = []
    for position in (0.5 * (ROWS - 1) * DX, 40 * DX):
        low, high = -0.5e-6, 1e-6
        for _ in range(50):
            middle = 0.5 * (low + high)
            below = force(law, [position], middle)[0] < LOAD
            low, high = (middle, high) if below else (low, middle)
        approach.append(low)
    assert approach[1] - approach[0] == pytest.approx(share * HEIGHT, rel=0.01)
