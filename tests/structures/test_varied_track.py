"""Tracks whose bays differ, and waves of a cell: against equal bays, superposed supports, a known trend."""

from dataclasses import replace

import numpy as np
import pytest

from asperity import Track
from asperity.errors import InputError
from asperity.radiation import passing
from asperity.radiation.track import squared_mobility
from asperity.structures.cell_waves import CellWaves, cell_waves
from asperity.structures.moving_kernel import moving_kernel
from asperity.structures.rail_poles import rail_between, rail_poles
from asperity.structures.track import decay_rate, decay_rate_en15461
from asperity.structures.track_parameters import Bays
from refusals import refusals
from superposed import free_rail, superposed, supports_by_hand

SHEARED = {"shear_stiffness": 243e6, "rotary_inertia": 0.24}
PLACES = [(0.0, 0.0), (0.3, 0.3), (0.1, 0.5), (0.6, 0.2), (13.3, 0.25), (0.31, -8.21), (59.9, 59.7)]


def random_cell(track, omega, count, seed=1):
    """Waves of a cell whose supports and distances are random_cell."""
    draw, support = np.random.default_rng(seed), track.support.stiffness(omega)
    supports = support * draw.uniform(0.3, 2.0, (count, 1))
    return cell_waves(*track.rail.waves(omega), supports, draw.uniform(0.5, 0.7, count), count)


@pytest.mark.parametrize("section", [{}, SHEARED])
@pytest.mark.parametrize("shift", [0.0, 33.0])
@pytest.mark.parametrize("count", [1, 2, 7, 100])
def test_equal_bays_answer_as_one(section, shift, count):
    track = Track.named("x2000", **section)
    omega = np.concatenate([np.geomspace(30.0, 3e4, 40), np.linspace(4e4, 5e5, 10)]) - 1j * shift
    one, support = track.waves(omega), track.support.stiffness(omega)
    cell = cell_waves(*track.rail.waves(omega), np.array([support] * count), np.full(count, 0.6), count)
    for x, x0 in PLACES:
        assert cell.receptance(x, x0) == pytest.approx(one.receptance(x, x0), rel=1e-9, abs=1e-200)
    slowest = np.abs(one.multipliers).max(axis=0)
    assert np.abs(cell.multipliers).max(axis=0) == pytest.approx(slowest**count, rel=1e-10, abs=0.0)
    for bay in (0, count // 2, count - 1):
        assert np.abs(cell.bay(bay).multipliers).max(axis=0) == pytest.approx(slowest, rel=1e-10)


def test_a_stretch_of_it_answers_like_one_bay():
    cell = random_cell(Track.named("x2000"), np.geomspace(60.0, 2e5, 30) - 10j, 5)
    length = cell.spacing / cell.bays
    here, there = cell.bay(1), cell.bay(4)
    for x, x0 in [(0.1, 0.2), (0.55, 0.0), (0.3, 0.59)]:
        carried = cell.carried(1, 9)
        seen = np.sum(there.outgoing(x) * carried * here.coefficients * here.incoming(x0), axis=0)
        exact = cell.receptance(9 * length + x, length + x0)
        assert seen == pytest.approx(exact, rel=1e-10, abs=1e-60)
    nodes = np.linspace(0.0, length, 5)
    for of_nodes, of_places in zip(here.shapes_at_nodes(4), here.symmetric_shapes(nodes), strict=True):
        assert of_nodes == pytest.approx(of_places, rel=1e-12)
    assert cell.carried(-9, -6) == pytest.approx(cell.carried(1, 4), rel=1e-12)
    assert cell.carried(9, 1) == pytest.approx(
        np.prod([cell.bay(n).multipliers for n in range(1, 9)], axis=0), rel=1e-6, abs=0.0
    )


def test_waves_lost_between_two_supports_are_refused():
    with pytest.raises(InputError, match="at most 200"):
        random_cell(Track.named("x2000"), np.array([1e9 + 0j]), 2)
    cell = random_cell(Track.named("x2000"), np.array([2e5 + 0j]), 30)
    with pytest.raises(InputError, match="at most 200"):
        cell.outgoing(cell.spacing)


EULER = Track.named("x2000")
UIC60 = Track.named("uic60")
VARIED = Bays.drawn(6, spacing=0.05, pad=0.2, ballast=0.3, seed=4)
STEP = 5e-5


def in_bays(track, bays=VARIED):
    return replace(track, bays=bays)


@pytest.mark.parametrize("named", ["x2000", "uic60"])
@pytest.mark.parametrize("frequency", [80.0, 330.0, 1050.0, 1250.0, 2500.0])
def test_it_is_the_superposition_of_360_bays(named, frequency):
    track, omega = in_bays(Track.named(named, rail_loss_factor=0.05)), 2.0 * np.pi * frequency
    bays, pairs = track.bays, [(0.3, 0.3), (0.61, 0.3), (2.7, 0.3)]
    supports = [supports_by_hand(track, omega, *share) for share in zip(bays.pad, bays.ballast, strict=True)]
    ends = np.concatenate([[0.0], np.cumsum(np.tile(bays.lengths * track.sleeper_spacing, 60))])
    at = ends[:-1] - 30 * track.period
    expected = superposed(free_rail(track, omega), np.tile(supports, 60), at, pairs)
    found = track.receptance(frequency, *np.transpose(pairs))
    np.testing.assert_allclose(found, expected, rtol=1e-8)


@pytest.mark.parametrize("track", [EULER, UIC60])
def test_equal_bays_are_one(track):
    cell, frequency = in_bays(track, Bays.equal(5)), np.geomspace(40.0, 5e3, 20)
    assert cell.regular == track
    assert cell.bay_tracks == [track] * 5
    for rate in (decay_rate, decay_rate_en15461):
        assert rate(cell, frequency) == pytest.approx(rate(track, frequency), rel=1e-9)
    for x in (0.0, 0.2, 1.5, -0.1):
        assert cell.static_deflection(7e4, x) == pytest.approx(
            track.static_deflection(7e4, x), rel=1e-10, abs=0.0
        )
    assert cell.critical_speed == pytest.approx(track.critical_speed, rel=1e-12)
    assert (cell.period, cell.mid_spans[-1]) == pytest.approx((5 * 0.6, 2.7))


def test_sleepers_and_mid_spans_are_those_of_the_bays():
    track = in_bays(EULER)
    ends = np.append(track.sleepers, track.period)
    assert np.diff(ends) == pytest.approx(0.6 * np.array(VARIED.spacing))
    assert track.mid_spans == pytest.approx(0.5 * (ends[1:] + ends[:-1]))
    for bay in (-7, 2, 11):
        at = bay // 6 * track.period
        near = track.sleeper_near(at + track.sleepers[bay % 6] + 0.1)
        assert near == pytest.approx((at + track.sleepers[bay % 6], at + track.mid_spans[bay % 6]))
    assert EULER.sleeper_near(1.9) == pytest.approx((1.8, 2.1))


@pytest.mark.parametrize("distance", [0.0, 1.3, -2.5])
def test_kernels_of_equal_bays_are_that_of_one(distance):
    like = {"duration": 0.03, "positions": 6, "distance": distance}
    one = moving_kernel(EULER, 56.0, STEP, **like).weights
    cell = moving_kernel(in_bays(EULER, Bays.equal(3)), 56.0, STEP, **like).weights.reshape(3, *one.shape)
    assert np.abs(cell - one).max() < 1e-9 * np.abs(one).max()


def test_a_force_over_a_sleeper_is_followed_where_bays_are_not_its_mirror_image():
    like = {"duration": 0.02, "positions": 6}
    track = in_bays(EULER)
    here, beside = (moving_kernel(track, 56.0, STEP, distance=d, **like).weights for d in (0.0, 1e-9))
    assert np.abs(here - beside).max() < 1e-6 * np.abs(here).max()


@pytest.mark.parametrize("distance", [0.0, 1.8, -1.8])
def test_a_kernel_at_rest_is_the_receptance_of_its_bay(distance):
    kernel = moving_kernel(in_bays(EULER), 0.0, STEP, positions=4, distance=distance)
    frequency = np.array([60.0, 400.0, 1300.0])
    transform = kernel.weights @ np.exp(
        -2j * np.pi * frequency * STEP * np.arange(kernel.weights.shape[1])[:, None]
    )
    for row in (0, 5, 15, 23):
        x = row * kernel.track.period / 24
        near, expected = (kernel.track.receptance(frequency, x + d, x) for d in (0.0, distance))
        off = transform[row] / np.sinc(frequency * STEP) ** 2 - expected
        assert np.all(np.abs(off) < 0.01 * np.abs(near))


def test_poles_stand_for_all_bays_and_contacts_feel_each_other_across_them():
    kernel = moving_kernel(in_bays(EULER, Bays.drawn(3, ballast=0.4, seed=1)), 56.0, 2e-4, positions=6)
    poles = rail_poles(kernel, 60)
    assert poles.accepted
    assert poles.residues.shape == (18, 60 // 2 + np.sum(poles.poles.imag == 0) // 2)
    between = rail_between(poles, [0.0, 2.5])
    assert between.between(2.5).kernel.weights.shape == kernel.weights.shape


def test_more_bays_than_memory_holds_are_refused():
    track = in_bays(EULER, Bays.equal(100))
    with pytest.raises(InputError, match=r"received 100, for a kernel of 400 ms .*at most 31 of them"):
        moving_kernel(track, 56.0, 5e-6, duration=0.4)


def test_static_deflection_is_the_limit_of_the_receptance():
    for track in (in_bays(EULER), in_bays(UIC60)):
        for x in (0.0, 0.25, 2.9):
            slow = replace(track, pad_loss_factor=None, ballast_loss_factor=None, rail_loss_factor=0.0)
            limit = slow.receptance(0.3, x, x).real
            assert limit == pytest.approx(slow.static_deflection(1.0, x), rel=1e-4, abs=0.0)


def test_scattered_sleepers_lower_and_widen_the_pinned_pinned_peak():
    """T. X. Wu and D. J. Thompson, Acustica 86 (2000) 313-321: it may be suppressed by random spacing."""
    frequency, track = np.linspace(1000.0, 1400.0, 201), Track.named("nordborg")
    peaks = [np.abs(track.receptance(frequency, 0.3, 0.3))]
    for scatter in (0.02, 0.05, 0.1):
        cell = in_bays(track, Bays.drawn(30, spacing=scatter, seed=1))
        scattered = np.abs(cell.receptance(frequency, cell.mid_spans, cell.mid_spans))
        peaks.append(np.sqrt(np.mean(scattered**2, axis=0)))
    assert scattered.max() < 0.7 * peaks[0].max()
    heights = [each.max() / peaks[0].max() for each in peaks]
    widths = [np.mean(each > each.max() / np.sqrt(2.0)) for each in peaks]
    assert np.all(np.diff(heights) < -0.05)
    assert np.all(np.diff(widths) > 0.0)


def test_draws_are_those_of_their_seed_alone():
    bays = Bays.drawn(100, spacing=0.05, pad=0.1, ballast=0.2, seed=2)
    assert bays == Bays.drawn(100, spacing=0.05, pad=0.1, ballast=0.2, seed=2)
    assert bays.pad == Bays.drawn(100, pad=0.1, seed=2).pad
    assert np.mean(bays.spacing) == pytest.approx(1.0, abs=1e-12)
    for values, scatter in ((bays.spacing, 0.05), (bays.pad, 0.1), (bays.ballast, 0.2)):
        assert np.std(values) == pytest.approx(scatter, rel=0.25)


test_bays_that_cannot_be_are_refused = refusals(
    (
        lambda: Bays.drawn(20, spacing=0.9, seed=1),
        "spacing of the bays: received -.*times the nominal one in bay",
    ),
    (lambda: Bays.drawn(50, ballast=0.6, seed=1), "ballast of the bays: .*Lower its scatter"),
    (lambda: Bays.drawn(5, pad=-0.1), "scatter of the pad"),
    (lambda: Bays.drawn(101), "bays of a cell"),
    (lambda: Bays((1.0, 1.0), (1.0,), (1.0, 1.0)), "pad of the bays: received 1 value"),
    (lambda: Bays((1.0, 1.2), (1.0, 1.0), (1.0, 1.0)), "mean spacing"),
    (lambda: Bays((1.0,), (np.nan,), (1.0,)), "pad of the bays"),
)


# --- what many bays cost


@pytest.fixture
def evaluated(monkeypatch):
    """How often waves of a cell were evaluated at a place, and carried from bay to bay."""
    counts = {"_shape": 0, "carried": 0}

    def counting(name, method):
        def counted(self, *arguments):
            counts[name] += 1
            return method(self, *arguments)

        return counted

    for name in counts:
        monkeypatch.setattr(CellWaves, name, counting(name, getattr(CellWaves, name)))
    return counts


X2000_IN_BAYS = replace(Track.named("x2000"), bays=Bays.drawn(3, spacing=0.05, pad=0.1, seed=1))


def test_the_mobility_of_many_bays_is_integrated_from_places_that_all_forces_share(evaluated):
    """For each place of a force, waves were evaluated at places of its own: it took six times as many."""
    frequency = np.array([30.0, 300.0, 3000.0])
    squared_mobility(X2000_IN_BAYS, frequency)
    assert evaluated["_shape"] <= 10 * 3 * 40  # 20 places of a force in each bay, twice as many of the rail


def test_waves_are_carried_to_the_bays_ahead_once_for_all_forces_in_a_bay(evaluated):
    kernel = moving_kernel(X2000_IN_BAYS, 56.0, 1e-4, duration=0.03, positions=4)
    assert len(kernel.weights) == 12
    assert (
        evaluated["carried"] <= 3 * 6
    )  # for each of 3 bays to those passed in 1.7 m, and one on either side


@pytest.mark.parametrize("track", [X2000_IN_BAYS, X2000_IN_BAYS.regular])
def test_waves_at_the_first_frequencies_are_those_at_all(track):
    omega = 2.0 * np.pi * np.geomspace(30.0, 3000.0, 9) - 3j
    waves = track.waves(omega)
    first, places = waves.at_first(4), np.linspace(0.0, 0.6, 5)
    for some, every in zip(first.symmetric_shapes(places), waves.symmetric_shapes(places), strict=True):
        np.testing.assert_array_equal(some, every[..., :4])
    np.testing.assert_array_equal(first.carried(0, 2), waves.carried(0, 2)[:, :4])


def test_what_is_far_from_a_point_is_computed_in_the_first_zone_alone(monkeypatch):
    """Waves of every bay were computed in all four, and three thrown away."""
    kernel, lines = moving_kernel(X2000_IN_BAYS, 56.0, 1e-4, duration=0.02, positions=2), []

    def noted(waves, places):
        lines.append(waves.wavenumbers.shape[-1])
        return shapes(waves, places)

    shapes = CellWaves.symmetric_shapes
    monkeypatch.setattr(CellWaves, "symmetric_shapes", noted)
    waves = passing._Waves(kernel, 300)
    assert lines == [301] * 3
    assert waves.grid.omega.size == 1201
