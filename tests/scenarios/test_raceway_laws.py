import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from numpy.testing import assert_allclose

from asperity import BallBearing, HalfSpace
from asperity.errors import InputError, OutOfRangeWarning
from asperity.laws.layout import force
from asperity.scenarios.raceway_grids import FOLLOWED, raceway_on
from asperity.scenarios.raceway_laws import OnRaceway, raceway_laws
from asperity.scenarios.raceway_limits import doubt_surface
from asperity.scenarios.roller_raceways import felt_by
from asperity.surfaces.cell_means import pressed_heights
from asperity.surfaces.faults import Fault
from asperity.surfaces.raceway import AroundTexture

MM, UM, NM = 1e-3, 1e-6, 1e-9
CONTACT = BallBearing.named("6205").outer_contact
LOAD = 68.0
APPROACH = CONTACT.approach(LOAD)
ALONG, ACROSS = CONTACT.semi_axes(APPROACH)
PIT = Fault("pit", angle=np.pi, length=0.18 * MM, depth=0.28 * MM)
ALL = ("table", "areal", "hertz")


def laws_on(surface, *names):
    return raceway_laws(names or ALL, CONTACT, surface, LOAD)


def rough(rms, radius=0.2 * MM, seed=4):
    texture = AroundTexture(roughness=rms, longest=0.3 * MM, shortest=0.1 * MM)
    return raceway_on(CONTACT, LOAD, radius, texture, [PIT] if radius > 0.2 * MM else (), seed=seed)


def solved(heights, approach, cells=(16, 40)):
    """Force of the ball on heights (x, y), N, at one approach or some; on a grid finer by another factor."""
    (dx, dy), (m, n) = (ALONG / cells[0], ACROSS / cells[1]), (9 * cells[0], 4 * cells[1])
    x, y = np.meshgrid(np.arange(-m, m + 1) * dx, np.arange(-n, n + 1) * dy, indexing="ij")
    gap = x**2 / (2 * CONTACT.radius_x) + y**2 / (2 * CONTACT.radius_y) - heights(x, y)
    space = HalfSpace(gap.shape, (dx, dy), CONTACT.modulus)
    return np.squeeze([space.solve(gap, each).force for each in np.atleast_1d(approach)])


def test_smooth_raceway_is_solved_once_and_is_hertz():
    on = OnRaceway(CONTACT, raceway_on(CONTACT, LOAD, 23.4 * MM), LOAD)
    assert on.scanned_in(slice(None)).counts.solved == len(on.approaches)
    assert len(on.positions) > 15000
    law = laws_on(on.surface)
    for share, name in product((0.1, 0.5, 1.0, 3.0, 8.0), ALL):
        found = force(law[name], [0.0, 1.0, -0.3], CONTACT.approach(share * LOAD))
        assert_allclose(found, share * LOAD, rtol=5e-3)
    finer = solved(lambda x, y: 0.0, APPROACH)
    assert_allclose(force(law["table"], 0.0, APPROACH), finer, rtol=1e-3)


def test_areal_textures_have_one_state_where_all_are_alike():
    smooth = laws_on(raceway_on(CONTACT, LOAD, 0.2 * MM), "areal")["areal"]
    assert smooth.prepare([0.0]).values.tolist() == [[0.0]]
    assert force(smooth, [0.0], APPROACH) == pytest.approx(LOAD)
    on = OnRaceway(CONTACT, rough(40 * NM), LOAD)
    assert len(on.loaded.approaches) > 8
    found = on.build("areal").prepare([0.0, 0.1 * MM])
    assert np.array_equal(found.states, on.loaded.approaches)
    assert np.ptp(found.values, axis=1).min() > 1 * NM


def test_stiffness_on_a_smooth_raceway_is_that_of_hertz_without_steps():
    """Whole cells miss it by half a per cent, as rows of cells enter."""
    surface = raceway_on(CONTACT, LOAD, 0.2 * MM)
    approaches = APPROACH * np.linspace(0.9, 1.1, 21)
    on = laws_on(surface, "direct")["direct"].prepare(np.zeros(1))
    forces = [on.evaluate(0, approach)[0] for approach in approaches]
    exact = [CONTACT.force(approach) for approach in approaches]
    assert np.abs(np.diff(forces) / np.diff(exact) - 1.0).max() < 2e-3
    assert_allclose(forces, exact, rtol=2e-4)


def test_rough_raceways_have_the_forces_of_a_fine_grid():
    """Of covered cells half as large and less, whose heights are drawn at their own points."""
    waves = 2.0 * np.pi * np.random.default_rng(3).normal(0.0, 4e3, (40, 2))

    def heights(x, y):
        return 40 * NM * sum(np.cos(k * x + m * y + i) for i, (k, m) in enumerate(waves)) / math.sqrt(20.0)

    flat = raceway_on(CONTACT, LOAD, 0.2 * MM)
    dx, dy = flat.spacing
    n, lines = flat.heights.shape
    x, y = (np.arange(n) - n // 2) * dx, (np.arange(lines) - lines // 2) * dy
    texture = heights(*np.meshgrid(x, y, indexing="ij"))
    on = OnRaceway(CONTACT, replace(flat, heights=np.roll(texture, -(n // 2), axis=0)), LOAD)
    assert on.seen.cells == "covered"
    law = on.build("direct").prepare(np.zeros(1))
    approaches = APPROACH * np.linspace(0.95, 1.05, 5)
    found = [law.evaluate(0, approach)[0] for approach in approaches]
    assert_allclose(found, solved(heights, approaches, (24, 60)), rtol=2.5e-4)


def test_cells_are_whole_where_surfaces_are_rough_or_have_faults():
    def cells(surface, *balls):
        return OnRaceway(CONTACT, surface, LOAD, balls=balls).seen.cells

    smooth, ball = rough(20 * NM), raceway_on(CONTACT, LOAD, 0.7 * MM)
    assert cells(smooth) == cells(smooth, ball) == "covered"
    pit = Fault("pit", angle=1.0, length=0.18 * MM, depth=0.28 * MM)
    assert cells(rough(300 * NM)) == "whole"
    assert cells(rough(20 * NM, radius=1.0 * MM)) == "whole"
    assert cells(smooth, raceway_on(CONTACT, LOAD, 0.7 * MM, faults=(pit,))) == "whole"
    assert cells(smooth, replace(smooth, heights=20.0 * smooth.heights)) == "whole"
    along = smooth.spacing[0]
    assert cells(replace(smooth, spacing=(along, 6.0 * along))) == "covered"
    assert cells(replace(smooth, spacing=(along, 6.1 * along))) == "whole"


def test_heights_are_pressed_as_means_across_the_end_of_a_turn():
    surface = rough(20 * NM)
    heights, n = surface.heights, len(surface.heights)
    found = OnRaceway(CONTACT, surface, LOAD).pressed(heights, 3)
    turns = np.vstack([heights] * 3)
    assert_allclose(found, pressed_heights(turns)[n - 3 : 2 * n + 3], atol=1e-15)
    assert np.std(found - turns[n - 3 : 2 * n + 3]) > 1e-3 * np.std(heights)


def test_positions_on_smooth_raceways_have_the_levels_of_every_row():
    surface = rough(30 * NM, radius=0.6 * MM / 2 / np.pi)
    alike = {"least_load": 0.5 * LOAD, "accuracy": 1e-6}  # the shortest wave is 1e-4 of the load
    every, on = (OnRaceway(CONTACT, surface, LOAD, shortest=wave, **alike) for wave in (0.0, 1.0))
    assert every.scanned_stride == 1
    assert on.scanned_stride == 4
    for least in (0.0, 0.49 * LOAD):  # balls that carry less have shorter patches
        assert OnRaceway(CONTACT, surface, LOAD, shortest=1.0, least_load=least).scanned_stride == 2
    places = np.arange(len(surface.heights)) * surface.spacing[0]
    found, exact = (np.fft.rfft(force(each.build("table"), places, APPROACH)) for each in (on, every))
    waves = surface.circumference / np.arange(1, 7)
    off = 20.0 * np.log10(np.abs(found / exact)[1:7])
    assert np.abs(off[waves > 1.6 * ALONG]).max() < 0.1


@pytest.mark.parametrize(("rms", "stride"), [(30 * NM, 5), (80 * NM, 3)])
def test_positions_on_long_smooth_raceways_have_the_bands_of_every_row(rms, stride):
    """On waves of 1.6 half axes and more."""
    texture = AroundTexture(roughness=rms, longest=0.3 * MM, shortest=0.06 * MM)
    surface = raceway_on(CONTACT, LOAD, 1.5 * MM, texture, seed=4)
    wave = 1.6 * ALONG
    alike = {"least_load": LOAD}
    every, on = (OnRaceway(CONTACT, surface, LOAD, shortest=each, **alike) for each in (0.0, wave))
    assert (every.scanned_stride, on.scanned_stride) == (1, stride)
    assert on.roughness == pytest.approx(rms / APPROACH, rel=0.1)
    places = np.arange(len(surface.heights)) * surface.spacing[0]
    states = on.states_under(0.9 * LOAD, LOAD)
    exact, found = (force(each.build("table", states), places, APPROACH) for each in (every, on))
    exact, found = (np.abs(np.fft.rfft(each)) ** 2 for each in (exact, found))
    waves = surface.circumference / np.arange(1, len(exact))
    for longest in wave * 2.0 ** (np.arange(1, 7) / 3):
        band = np.append(False, (waves <= longest) & (waves > longest / 2.0 ** (1 / 3)))
        assert abs(10.0 * np.log10(found[band].sum() / exact[band].sum())) < 0.1


@pytest.mark.parametrize("where", ["heights", "line"])
def test_higher_raceway_is_a_larger_approach(where):
    smooth, h = raceway_on(CONTACT, LOAD, 0.1 * MM), 0.2 * UM
    raised = replace(smooth, **{where: getattr(smooth, where) + h})
    before, after = laws_on(smooth), laws_on(raised)
    for name in ALL:
        wanted = force(before[name], 0.1 * MM, APPROACH + h)
        assert_allclose(force(after[name], 0.1 * MM, APPROACH), wanted, rtol=2e-3)
    assert_allclose(felt_by(CONTACT, raised, LOAD), h, rtol=1e-9)


def test_force_closes_around_a_rough_raceway():
    surface = rough(30 * NM)
    around = surface.circumference
    step = np.arange(-4, 5) * 1e-3 * surface.spacing[0]
    law = laws_on(surface)
    places = np.linspace(0.0, around, 50, endpoint=False)
    for name in ALL:
        found = force(law[name], places, APPROACH)
        for turns in (1, -3):
            assert_allclose(force(law[name], places + turns * around, APPROACH), found, rtol=1e-9)
        over = force(law[name], step, APPROACH)  # no jump, and one slope
        assert_allclose(np.diff(over), np.diff(over).mean(), rtol=0.05, atol=1e-9 * LOAD)
        assert np.ptp(found) > 0.01 * LOAD
    exact, averaged = (force(law[name], places, APPROACH) for name in ("table", "areal"))
    # exact but for what is of second order in the heights: of forty draws 0.9 F (σ/δ)², deviation 0.2
    second_order = LOAD * (np.std(surface.heights) / APPROACH) ** 2
    assert np.std(averaged - exact) < 1.5 * second_order < 0.1 * np.std(exact)


def test_states_and_positions_that_a_motion_asks_for_have_the_forces_of_all():
    surface = rough(20 * NM, radius=0.1 * MM)
    alike = {"least_load": LOAD}
    every, on = (OnRaceway(CONTACT, surface, LOAD, shortest=wave, **alike) for wave in (0.0, 0.8 * ALONG))
    assert on.scanned_stride == 3 * every.scanned_stride
    states = on.states_under(0.8 * LOAD, LOAD)
    few, whole = on.build("table", states), every.build("table")
    assert 3 <= few.law.table.forces.shape[0] <= 5
    places = np.linspace(0.0, surface.circumference, 100)
    for load in (0.6 * LOAD, 0.9 * LOAD, 1.25 * LOAD):
        exact, found = (force(law, places, CONTACT.approach(load)) for law in (whole, few))
        assert abs(20.0 * np.log10(np.std(found) / np.std(exact))) < 0.1
        assert np.std(found - exact) < 0.05 * np.std(exact)
    least, most = 0.3 * LOAD, 2.0 * LOAD
    wider = on.wider(states, least, most)
    forces = whole.law.table.forces[wider]
    assert forces[0].max() <= least < forces[1].max()
    assert forces[-2].min() < most <= forces[-1].min()
    assert on.wider(wider, least, most) == wider


@pytest.mark.parametrize("waves", [1, 3])
def test_waves_are_felt_by_sin_q_over_q(waves):
    radius, texture = 0.175 * MM, AroundTexture(waves=(waves,), amplitudes=(5 * NM,))
    surface = raceway_on(CONTACT, LOAD, radius, texture, seed=3)
    long = 2 * np.pi * radius / waves > FOLLOWED * ALONG
    assert long == (not surface.heights.any()) == bool(surface.line.any())
    q = waves / radius * ALONG
    places = surface.spacing[0] * np.arange(len(surface.heights))
    law = laws_on(surface, *ALL, "shifted", "linear", "linear-filtered")
    height = np.fft.rfft(surface.heights[:, 0] + surface.line)[waves]
    for name, factor in (("linear", 1.0), ("linear-filtered", np.sin(q) / q)):
        above = (force(law[name], places, APPROACH) - LOAD) / CONTACT.tangent_stiffness(APPROACH)
        assert abs(np.fft.rfft(above)[waves] - factor * height) < 0.02 * abs(height), name
    averaged = dict.fromkeys(("table", "areal", "shifted"), np.sin(q) / q)
    for name, factor in (averaged | {"hertz": 1.0}).items():
        above = (force(law[name], places, APPROACH) / CONTACT.stiffness_constant) ** (2 / 3) - APPROACH
        assert abs(np.fft.rfft(above)[waves] - factor * height) < 0.02 * abs(height), name
    felt = np.fft.rfft(felt_by(CONTACT, surface, LOAD))[waves]
    assert abs(felt - np.sin(q) / q * height) < 4e-3 * abs(felt)


def test_pit_narrower_than_the_contact_takes_a_part_of_it_away():
    on = OnRaceway(CONTACT, raceway_on(CONTACT, LOAD, 1.0 * MM, faults=(PIT,)), LOAD)
    with pytest.warns(OutOfRangeWarning, match=r"under 68 N; else they have 17 N .* has 16\.\d N, and 272 N"):
        law, middle = laws_on(on.surface), np.pi * MM
    with pytest.warns(OutOfRangeWarning, match="At a fault areal holds for .* under 68 N; else it has 17 N"):
        laws_on(on.surface, "areal")
    assert 0 < on.scanned_in(slice(None)).counts.solved < 110 * len(on.approaches)  # of 720
    for away, approach in product((0.0, 0.07 * MM, 0.12 * MM), (APPROACH, CONTACT.approach(4 * LOAD))):
        exact = solved(lambda x, y, x0=away: -0.28 * MM * (np.hypot(x + x0, y) < 0.09 * MM), approach)
        found = force(law["table"], [middle + away, middle - away], approach)
        assert 0.5 < exact / CONTACT.force(approach) < 1.001
        assert_allclose(found, exact, rtol=1.5e-3)
        assert_allclose(found[0], found[1], rtol=2e-3)
    assert 0.02 < 1.0 - force(law["table"], middle, APPROACH) / LOAD < 0.3
    # under the load for which they are made the simple laws have it, too; far from it nothing is lost
    sunk = APPROACH - felt_by(CONTACT, on.surface, LOAD)[round(middle / on.surface.spacing[0])]
    for name in ALL:
        assert_allclose(force(law[name], middle, sunk), LOAD, rtol=4e-3)
        assert_allclose(force(law[name], middle + 1.5 * MM, APPROACH), LOAD, rtol=1e-3)


@pytest.mark.parametrize("width", [6 * MM, 0.7 * MM, 3 * MM], ids=["far edge", "sides", "sides far out"])
def test_ball_over_a_spall_touches_its_edges_first(width):
    length, depth = 0.8 * MM, 0.2 * MM
    spall = Fault("spall", angle=np.pi, length=length, width=width, depth=depth)
    law = laws_on(raceway_on(CONTACT, LOAD, 1.0 * MM, faults=(spall,)), "table")["table"]
    along, across = (length / 2) ** 2 / (2 * CONTACT.radius_x), (width / 2) ** 2 / (2 * CONTACT.radius_y)
    sinks, middle = min(along, across), np.pi * MM
    cell = ALONG / 8 * length / 2 / CONTACT.radius_x, ACROSS / 16 * width / 2 / CONTACT.radius_y
    cell = cell[across < along]
    within = 0.02 * sinks + 0.3 * cell  # the first cells touch with their middles
    assert force(law, middle, sinks - within) == 0.0
    assert 0.0 < force(law, middle, sinks + within) < CONTACT.force(sinks)
    if along < across:  # on the nearer edge, sooner
        beside = middle + np.array([-length, length]) / 4
        assert (force(law, beside, along / 4 - within) == 0.0).all()
        assert (force(law, beside, along / 4 + within) > 0.0).all()
    deep = sinks + 4 * APPROACH
    hollow = solved(lambda x, y: -depth * (abs(x) < length / 2) * (abs(y) < width / 2), deep)
    assert_allclose(force(law, middle, deep), hollow, rtol=0.5 * cell / (4 * APPROACH))
    both = force(law, middle + 0.375 * np.array([-length, length]), 2 * APPROACH)
    assert_allclose(both[0], both[1], rtol=1e-3)


def test_unknown_law_is_refused():
    with pytest.raises(InputError, match=r"law: received 'prinetd'; .*\"printed\""):
        laws_on(raceway_on(CONTACT, LOAD, 0.1 * MM), "prinetd")


def test_direct_over_a_pit_stays_between_its_rows():
    """Splines would swing beyond the edges, by more than the contact is deep."""
    surface = raceway_on(CONTACT, LOAD, 1.0 * MM, faults=(PIT,))
    table, direct = (laws_on(surface, name)[name] for name in ("table", "direct"))
    places = np.pi * MM + np.array([-0.13, -0.09, -0.03, 0.0, 0.05]) * MM
    places = surface.spacing[0] * (np.round(places / surface.spacing[0])[:, None] + [0.0, 0.3, 0.5, 0.8])
    found, exact = (force(law, places.ravel(), APPROACH) for law in (direct, table))
    assert_allclose(found, exact, rtol=4e-4)


def test_waves_on_any_line_of_a_raceway_count():
    """200 approaches high on all lines but the first."""
    smooth = raceway_on(CONTACT, LOAD, 0.2 * MM)
    along = np.linspace(0.0, 20.0 * np.pi, len(smooth.heights), endpoint=False)
    heights = 200.0 * APPROACH * np.outer(np.sin(along), np.arange(smooth.heights.shape[1]) > 0)
    with pytest.raises(InputError, match=r"waves all around: received .*200 approaches of"):
        doubt_surface(replace(smooth, heights=heights), APPROACH, "ball")


def test_steps_between_rows_of_a_raceway_are_no_steeper_than_one():
    """Every other row is so high that two are further apart in height than along."""
    smooth = raceway_on(CONTACT, LOAD, 0.2 * MM)
    heights = np.zeros_like(smooth.heights)
    heights[::2] = 1.1 * smooth.spacing[0]
    steep = replace(smooth, heights=heights)
    with pytest.raises(InputError, match=r"rms slope: received 1\.1; allowed: at most 1"):
        doubt_surface(steep, smooth.spacing[0], "ball")
    doubt_surface(replace(steep, heights=0.8 * heights), smooth.spacing[0], "ball")


@pytest.mark.parametrize("forwards", [True, False])
def test_direct_sees_the_pits_of_ball_and_raceway_where_they_are(forwards):
    """One deeper pit where both meet, two where the ball has turned on; on other cells and a finer grid."""
    surface, away, radius, beta = raceway_on(CONTACT, LOAD, 1.0 * MM, faults=(PIT,)), 0.05 * MM, 0.7 * MM, 5.0
    pit = Fault("pit", angle=beta, length=0.18 * MM, depth=0.28 * MM)
    ball = raceway_on(CONTACT, 0.8 * LOAD, radius, faults=(pit,))
    keys = {"balls": [ball], "forwards": forwards}
    (law,) = raceway_laws(["direct"], CONTACT, surface, LOAD, **keys)["direct"]
    ahead = np.array([away, -away]) / (radius if forwards else -radius)
    on = law.prepare(np.column_stack([[np.pi * MM - away] * 2, beta - ahead + 2 * np.pi * np.array([0, 7])]))
    for step, places in enumerate(([away, away], [away, -away])):

        def both(x, y, places=places):
            return -0.28 * MM * sum(np.hypot(x - at, y) < 0.09 * MM for at in places)

        assert_allclose(on.evaluate(step, APPROACH)[0], solved(both, APPROACH), rtol=2e-3)
        on.accept(step)


def test_a_ball_that_runs_backwards_shows_the_same_spot():
    """What lies before it lies behind, and the force of a spot stays, to less than a cell's turn."""
    surface = raceway_on(CONTACT, LOAD, 1.0 * MM)
    ball = raceway_on(CONTACT, LOAD, 0.7 * MM, AroundTexture(waves=(3, 5), amplitudes=(0.2 * UM, 0.3 * UM)))
    spots, found = np.array([0.0, 0.4, 1.1, 2.9, 5.3]), []
    for forwards in (True, False):
        keys = {"balls": [ball], "forwards": forwards}
        (law,) = raceway_laws(["direct"], CONTACT, surface, LOAD, **keys)["direct"]
        on = law.prepare(np.column_stack([np.full(len(spots), 0.5 * MM), spots]))
        found.append([])
        for step in range(len(spots)):
            found[-1].append(on.evaluate(step, APPROACH)[0])
            on.accept(step)
    assert np.ptp(found[0]) > 0.05 * LOAD
    assert_allclose(found[1], found[0], rtol=1e-4)
    cell = surface.spacing[0] / (0.7 * MM)
    assert np.abs(np.gradient(found[0], spots)).max() * cell > 20 * 1e-4 * LOAD  # so much a cell off would be
