import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from asperity.surfaces.bands import band_levels_of
from asperity.surfaces.defects import corrugation, dipped_joint, flat_geometry, flat_length, flat_trajectory
from asperity.surfaces.heightmap import Profile
from asperity.surfaces.measured_lines import roll_over
from refusals import refusals

MM, UM = 1e-3, 1e-6
RADIUS, DEPTH = 0.46, 0.4 * MM
X = np.arange(-200, 201) * 0.5 * MM


def test_corrugation_is_a_sine():
    line = corrugation(20000, 0.5 * MM, wavelength=0.04, amplitude=25 * UM)
    assert_allclose(line.heights.max(), 25 * UM, rtol=1e-6)
    assert_allclose(line.heights.std(), 25 * UM / np.sqrt(2), rtol=1e-6)
    assert_allclose(line.heights, 25 * UM * np.sin(2 * np.pi * line.x / 0.04))


def test_band_of_corrugation_lies_about_its_wavelength():
    line = corrugation(40000, MM, wavelength=0.04, amplitude=10 * np.sqrt(2) * UM, bandwidth=0.33, seed=3)
    wavelength, level = band_levels_of(line)
    assert_allclose(level[np.argmin(np.abs(wavelength - 0.04))], 20.0, atol=0.5)
    assert (level[(wavelength < 0.03) | (wavelength > 0.06)] < -20).all()


@pytest.mark.parametrize("before", [0, -700])  # within a tile, and about its blend with the next
def test_a_band_of_corrugation_has_its_rms_in_the_mean_of_draws(before):
    """A line of 0.6 m holds three values of the envelope's square; its own rms is left as it was drawn."""
    keys = {"wavelength": 0.04, "amplitude": np.sqrt(2) * UM, "bandwidth": 0.33, "before": before}
    squares = [np.mean(corrugation(600, MM, seed=s, **keys).heights ** 2) for s in range(200)]
    error = np.std(squares, ddof=1) / np.sqrt(len(squares))
    assert error < 0.05 * UM**2
    assert abs(np.mean(squares) - UM**2) < 3.0 * error


@pytest.mark.parametrize("bandwidth", [0.1, 0.3, 1.0])
def test_the_rms_of_a_record_of_corrugation_scatters_no_more_than_noise_of_its_bandwidth(bandwidth):
    """The rms of noise has a relative standard deviation of 1/(2 √(B L)): Bendat and Piersol, Random Data."""
    keys = {"wavelength": 0.04, "amplitude": np.sqrt(2) * UM, "bandwidth": bandwidth}
    rms = [corrugation(1000, 2 * MM, seed=s, **keys).heights.std() / UM for s in range(100)]
    band = (2 ** (bandwidth / 2) - 2 ** (-bandwidth / 2)) / 0.04
    assert 0.3 < np.std(rms) * 2.0 * np.sqrt(2.0 * band) < 1.0
    assert abs(np.mean(np.square(rms)) - 1.0) < 3.0 * np.std(np.square(rms)) / 10.0


@pytest.mark.parametrize("bandwidth", [None, 0.01, 0.33])
def test_a_longer_or_finer_corrugation_is_the_same_one(bandwidth):
    keys = {"wavelength": 0.04, "amplitude": UM, "bandwidth": bandwidth, "seed": 3}
    long = corrugation(9000, 0.5 * MM, before=3000, **keys).heights
    short = corrugation(1500, MM, before=700, **keys).heights
    assert_allclose(short, long[3000 - 2 * 700 :: 2][:1500], atol=1e-10 * UM)


def test_fresh_flat_is_the_chord_of_the_wheel():
    length = flat_length(DEPTH, RADIUS)
    assert_allclose(length, 2 * np.sqrt(RADIUS**2 - (RADIUS - DEPTH) ** 2), rtol=1e-3)
    geometry = flat_geometry(X, DEPTH, RADIUS)
    chord = (RADIUS - DEPTH) / np.cos(X / RADIUS) - RADIUS  # exact, in polar coordinates
    assert_allclose(geometry, np.minimum(chord, 0.0), atol=0.002 * DEPTH)
    assert_allclose(geometry.min(), -DEPTH)
    assert_array_equal(geometry[np.abs(X) > length / 2], 0.0)


def test_worn_flat_is_a_rounded_one_over_its_chord_or_longer():
    """z = −d/2 (1 + cos 2πx/l): from l = π √(2 R d) on the wheel's curvature nowhere turns."""
    chord, longer = flat_length(DEPTH, RADIUS), 1.2 * np.pi * np.sqrt(2 * RADIUS * DEPTH)
    for length in (None, longer):
        at = np.array([0, 0.25, 0.5, 0.6]) * (length or chord)
        heights = flat_geometry(at, DEPTH, RADIUS, "worn", length)
        assert_allclose(heights, [-DEPTH, -DEPTH / 2, 0, 0], atol=1e-12)
    assert -DEPTH < flat_trajectory(X, DEPTH, RADIUS, "worn").min() < -0.3 * DEPTH
    assert_allclose(flat_trajectory(X, DEPTH, RADIUS, "worn", longer).min(), -DEPTH, rtol=1e-3)


@pytest.mark.parametrize(("shape", "length"), [("fresh", None), ("worn", None), ("worn", 0.07)])
def test_trajectory_is_the_wheel_rolled_over_the_flat(shape, length):
    x = np.arange(-2000, 2001) * 0.02 * MM
    rolled = roll_over(Profile(flat_geometry(x, DEPTH, RADIUS, shape, length), 0.02 * MM), RADIUS).heights
    assert_allclose(flat_trajectory(x, DEPTH, RADIUS, shape, length), rolled, atol=0.3 * UM)


def test_dipped_joint_has_its_depth_angle_and_length():
    x = np.linspace(-1.0, 1.0, 20001)
    dip = dipped_joint(x, 2 * MM, 1.0)
    assert_allclose(dip[10000], -2 * MM)
    slope = np.gradient(dip, x)
    assert_allclose(slope[10010] - slope[9990], 8 * 2 * MM / 1.0, rtol=0.01)
    assert_array_equal(dip[np.abs(x) >= 0.5], 0.0)
    assert np.abs(np.diff(slope[x > 0.3])).max() < 1e-5 + 8 * 2 * MM * 1e-4
    assert_allclose(dip, dip[::-1], atol=1e-15)


def corrugated(**changes):
    return corrugation(1001, MM, **{"wavelength": 0.033, "amplitude": UM, **changes})


def flat(depth=DEPTH, shape="fresh", length=None, function=flat_geometry):
    return function(X, depth, RADIUS, shape, length)


test_what_is_wrong_is_said = refusals(
    (lambda: corrugated(wavelength=1.5 * MM), "at least two samples, 0.002 m"),
    (lambda: corrugated(wavelength=2.1 * MM, bandwidth=1.0), "at least two samples"),
    *((lambda depth=depth: flat(depth), "depth of the wheel flat") for depth in (0.0, -MM, np.nan, 0.1)),
    (lambda: flat(length=0.1), "length of the wheel flat"),
    (lambda: flat(length=0.03, shape="worn", function=flat_trajectory), "length of the wheel flat"),
    (lambda: flat(length=np.nan, shape="worn"), "length of the wheel flat"),
    (lambda: dipped_joint(X, 0.0, 1.0), "depth of the dipped joint"),
    (lambda: dipped_joint(X, 0.1, 1.0), "depth of the dipped joint"),
)
