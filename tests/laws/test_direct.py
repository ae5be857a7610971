"""The direct law, and what every consistent law must do on a slow bump."""

import numpy as np
import pytest

from asperity.contact import HalfSpace, Hertz
from asperity.contact.scan import ScanJob, scan_forces
from asperity.errors import InputError, TruncatedContactWarning
from asperity.laws import Areal, Direct, Printed, Shifted, Table
from asperity.laws.layout import force
from asperity.reduction.filter import filtered_texture
from asperity.reduction.stiffness import ForceCurve
from asperity.reduction.table import ForceTable
from asperity.reduction.texture import areal_texture
from asperity.rolling.rest import STEPPED_TOLERANCE, at_rest
from asperity.structures.body import Body
from asperity.surfaces.strip import Rows

DX, N, RADIUS, MODULUS, LOAD = 5e-6, 31, 10e-3, 115e9, 2.0
HERTZ = Hertz(MODULUS, RADIUS, RADIUS)


def body():
    x = (np.arange(N) - N // 2) * DX
    return (x[:, None] ** 2 + x[None, :] ** 2) / (2 * RADIUS)


def rough(rows, seed=0):
    return 0.02e-6 * np.random.default_rng(seed).standard_normal((rows, N))


def direct(heights, **options):
    return Direct(heights, body(), (DX, DX), MODULUS, start=0.0, **options)


class TestDirect:
    def test_it_is_the_half_space_under_the_position(self):
        heights = rough(60)
        law = direct(heights, rtol=1e-10).prepare([20 * DX, 33 * DX])
        half_space = HalfSpace((N, N), (DX, DX), MODULUS)
        for step, row in enumerate((20, 33)):
            alone = half_space.solve(body() - heights[row - 15 : row + 16], approach=0.2e-6, rtol=1e-10)
            found, slope = law.evaluate(step, 0.2e-6)
            assert found == pytest.approx(alone.force, rel=1e-8)
            assert slope == pytest.approx(alone.stiffness, rel=1e-6)
            law.accept(step)

    def test_at_rest_it_carries_the_load_at_any_tolerance(self):
        """The contact from which rolling starts, against one that is solved under the load."""
        heights = rough(60)
        law = direct(heights, rtol=0.01).prepare([20 * DX, 21 * DX])
        one, at = [Body.rigid(1.0, LOAD)], [lambda approach: law.evaluate(0, approach)]
        rest = at_rest(one, np.zeros(1), np.zeros((1, 1)), at, STEPPED_TOLERANCE)
        alone = HalfSpace((N, N), (DX, DX), MODULUS).solve(body() - heights[5:36], load=LOAD, rtol=1e-9)
        assert rest.approach[0] == pytest.approx(alone.approach, rel=1e-4)

    def test_between_rows_the_texture_is_interpolated(self):
        x = np.arange(80) * DX
        wave = 0.05e-6 * np.cos(2 * np.pi * x / (30 * DX))[:, None] * np.ones((1, N))
        shifted = 0.05e-6 * np.cos(2 * np.pi * (x + 0.4 * DX) / (30 * DX))[:, None] * np.ones((1, N))
        between = force(direct(wave, rtol=1e-9), [40.4 * DX], 0.2e-6)
        on_row = force(direct(shifted, rtol=1e-9), [40 * DX], 0.2e-6)
        assert between == pytest.approx(on_row, rel=1e-6)

    def test_short_waves_survive_between_rows(self):
        x = np.arange(80) * DX
        wave, shifted = (
            np.cos(2 * np.pi * at / (2.7 * DX))[:, None] * np.ones((1, N)) for at in (x, x + 0.5 * DX)
        )
        found = direct(wave).prepare([40.5 * DX])._rows_at(25.5)
        # quintic splines lose (k/(1 − k))^6 of a wave of k cycles a row, and add as much of its image
        loss = (1 / 2.7 / (1 - 1 / 2.7)) ** 6
        np.testing.assert_allclose(found, shifted[25 : 25 + N], atol=2 * loss)

    def test_out_of_contact(self):
        law = direct(rough(60)).prepare([20 * DX])
        assert law.evaluate(0, -1e-6) == (0.0, 0.0)

    def test_going_on_from_a_saved_state_repeats_every_bit(self):
        positions = 20 * DX + np.arange(12) * DX
        whole = direct(rough(60)).prepare(positions)
        resumed = direct(rough(60)).prepare(positions)
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

    def test_contacts_cut_off_are_told(self):
        law = direct(rough(60)).prepare([20 * DX])
        law.evaluate(0, 0.8e-6)
        law.accept(0)
        with pytest.warns(TruncatedContactWarning, match="in 1 of 1 contact solutions of the direct law"):
            law.warn_of_flaws()

    def test_path_must_hold_the_window(self):
        with pytest.raises(InputError, match=r"path \(m\): received"):
            direct(rough(60)).prepare([10 * DX])

    def test_sizes_must_fit(self):
        with pytest.raises(InputError, match="a body as wide as the path"):
            direct(np.zeros((60, N + 1)))
        with pytest.raises(InputError, match="contact damping"):
            direct(rough(60), damping=-1.0)


class TestSlowBump:
    """Under constant load the ball follows a slow bump: Δr = Δh (20 contact radii wide)."""

    HEIGHT = 5e-9
    ROWS = 1201

    def strip(self):
        x = (np.arange(self.ROWS) - self.ROWS // 2) * DX
        return self.HEIGHT * np.exp(-((x / 1e-3) ** 2))[:, None] * np.ones((1, N))

    def rise(self, law):
        """How far the ball is lifted at the top, under constant load, from a place without bump."""
        top = 0.5 * (self.ROWS - 1) * DX
        approach = []
        for position in (top, 40 * DX):
            low, high = -0.5e-6, 1e-6
            for _ in range(50):
                middle = 0.5 * (low + high)
                below = force(law, [position], middle)[0] < LOAD
                low, high = (middle, high) if below else (low, middle)
            approach.append(low)
        return approach[1] - approach[0]

    def test_direct(self):
        assert self.rise(direct(self.strip(), rtol=1e-8)) == pytest.approx(self.HEIGHT, rel=0.01)

    def test_table(self):
        approaches = np.linspace(-0.1e-6, 0.5e-6, 13)
        half_space = HalfSpace(body().shape, DX, MODULUS)
        scanned = scan_forces(ScanJob(half_space, Rows(self.strip()), body(), approaches, stride=15))
        law = Table(ForceTable(scanned.forces, approaches, N // 2 * DX, 15 * DX))
        assert self.rise(law) == pytest.approx(self.HEIGHT, rel=0.01)

    def texture(self):
        """Filtered line and areal texture at three states."""
        approaches = HERTZ.approach(LOAD) * np.array([0.5, 1.0, 1.5])
        taps = np.array([np.full(2 * m + 1, 1 / (2 * m + 1)) for m in (10, 10, 10)])
        line = filtered_texture(self.strip()[:, N // 2], DX, taps, approaches)
        axes = [HERTZ.semi_axes(a) for a in approaches]
        return line, areal_texture(self.strip(), (DX, DX), approaches, axes)

    def test_shifted_areal_and_printed(self):
        curve = ForceCurve.hertz(HERTZ.stiffness_constant)
        line, areal = self.texture()
        assert self.rise(Shifted(curve, line)) == pytest.approx(self.HEIGHT, rel=0.01)
        assert self.rise(Areal(curve, areal)) == pytest.approx(self.HEIGHT, rel=0.01)
        # the documented defect: secant stiffness against tangent motion, h/(1 + n) with n = 1/2
        assert self.rise(Printed(curve, line, datum=0.0)) == pytest.approx(2 / 3 * self.HEIGHT, rel=0.01)

    def test_states_counted_from_a_plane_change_nothing_on_a_consistent_law(self):
        curve = ForceCurve.hertz(HERTZ.stiffness_constant)
        _, areal = self.texture()
        plane = type(areal).unfiltered(areal.heights[1], DX)
        assert self.rise(Areal(curve, areal, plane=plane)) == pytest.approx(self.HEIGHT, rel=0.01)
