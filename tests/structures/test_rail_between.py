"""A rail between wheels: crossing kernels against receptances, shared, left out."""

import numpy as np
import pytest

from asperity.errors import InputError
from asperity.store import Store
from asperity.structures.moving_kernel import moving_kernel
from asperity.structures.rail_poles import NEGLIGIBLE, TOLERANCE, RailPoles, rail_between, rail_poles
from asperity.structures.track import Track

STEP = 50e-6
TRACK = Track(
    bending_stiffness=4.725e6, mass_per_length=60.0, rail_loss_factor=0.03, pad_stiffness=300e6,
    pad_damping=18e3, sleeper_mass=150.0, ballast_stiffness=150e6, ballast_damping=48e3, sleeper_spacing=0.6,
)  # fmt: skip


@pytest.fixture(scope="module")
def moving():
    return moving_kernel(TRACK, 56.0, STEP, duration=0.08, positions=12)


@pytest.fixture(scope="module")
def poles(moving):
    return rail_poles(moving, 60)


@pytest.mark.parametrize("distance", [2.5, -2.5, 0.35, -0.35, -6.05])
def test_the_transform_at_rest_is_the_transfer_receptance(distance):
    kernel = moving_kernel(TRACK, 0.0, STEP, duration=0.15, positions=24, distance=distance)
    frequency = np.array([30.0, 90.0, 250.0, 600.0, 1100.0, 1800.0])
    lags = STEP * np.arange(kernel.weights.shape[1])
    found = kernel.weights @ np.exp(-2j * np.pi * lags[:, None] * frequency)
    hat = np.sinc(frequency * STEP) ** 2
    for row in (0, 7, 12):
        x = 0.025 * row
        expected = hat * kernel.track.receptance(frequency, x + distance, x)
        direct = np.abs(kernel.track.receptance(frequency, x, x))
        assert np.all(np.abs(found[row] - expected) < 0.005 * direct)


def test_a_moving_receiver_meets_the_wave_where_it_is():
    """One that starts a bay behind, and rolls a bay in n steps, then meets what stands at the force."""
    lag, bay = 40, 0.6
    speed = bay / (lag * STEP)
    standing = moving_kernel(TRACK, 0.0, STEP, duration=0.08, positions=12)
    moving = moving_kernel(TRACK, speed, STEP, duration=0.08, positions=12, distance=-bay)
    np.testing.assert_allclose(
        moving.weights[:, lag], standing.weights[:, lag], atol=2e-3 * np.abs(standing.weights).max()
    )
    ahead = moving_kernel(TRACK, speed, STEP, duration=0.08, positions=12)
    assert np.abs(ahead.weights[:, lag] - standing.weights[:, lag]).max() > 0.1 * standing.weights.max()


def test_no_distance_changes_nothing(moving):
    again = moving_kernel(TRACK, 56.0, STEP, duration=0.08, positions=12, distance=0.0)
    np.testing.assert_array_equal(again.weights, moving.weights)


def test_crossing_kernels_are_fitted_within_half_a_percent_of_the_direct_one_and_kept(poles, tmp_path):
    told, cache = [], Store(tmp_path)
    between, again = (
        rail_between(poles, [0.0, 2.5], cache=cache, progress=lambda *args: told.append(args))
        for _ in range(2)
    )
    assert told == [(1, 1, "rail between contacts")] * 2
    assert set(between.crossing) == {2.5, -2.5}
    for distance, rail in between.crossing.items():
        assert isinstance(rail, RailPoles)
        left = rail.weights() - rail.kernel.weights
        error = np.linalg.norm(left) / np.linalg.norm(poles.kernel.weights)
        assert error <= TOLERANCE
        np.testing.assert_array_equal(again.crossing[distance].residues, rail.residues)


def test_a_train_costs_in_proportion_to_its_wheels(moving):
    """Distances beyond the reach are left out, and equal ones share a kernel."""
    coach = np.array([0.0, 2.5, 17.5, 20.0])
    counts = []
    for coaches in (2, 6):
        places = (coach + 26.0 * np.arange(coaches)[:, None]).ravel()
        between = rail_between(moving, places, reach=9.0)
        assert set(between.crossing) == {2.5, -2.5, 6.0, -6.0, 8.5, -8.5}
        pairs = [between.between(there - here) for here in places for there in places]
        counts.append(sum(pair is not None for pair in pairs) / places.size)
    assert counts[1] < 1.2 * counts[0] < 6.0


def test_what_is_too_far_to_feel_is_left_out_by_itself(moving):
    between = rail_between(moving, [0.0, 2.5, 60.0, 90.0])
    assert set(between.crossing) == {2.5, -2.5}
    assert between.reach == 2.5
    assert between.between(57.5) is None
    far = moving_kernel(TRACK, 56.0, STEP, duration=0.08, positions=12, distance=57.5)
    assert np.linalg.norm(far.weights) < NEGLIGIBLE * np.linalg.norm(moving.weights)


@pytest.mark.parametrize(
    ("places", "reach", "message"),
    [
        ([0.0, np.nan], None, r"places of the contacts.*finite numbers"),
        (["a"], None, r"places of the contacts.*finite numbers"),
        ([0.0, 2.5], -1.0, r"reach \(m\).*a finite number, zero or more"),
    ],
)
def test_wrong_places_are_refused(poles, places, reach, message):
    with pytest.raises(InputError, match=message):
        rail_between(poles, places, reach=reach)


def test_a_distance_that_is_no_number_is_refused():
    with pytest.raises(InputError, match=r"distance \(m\).*a finite number"):
        moving_kernel(TRACK, 56.0, STEP, distance=np.inf)
