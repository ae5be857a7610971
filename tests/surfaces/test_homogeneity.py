import numpy as np
import pytest
from numpy.testing import assert_allclose

from asperity.errors import InputError
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.homogeneity import homogeneity, more_than_chance
from asperity.surfaces.statistics import areal_statistics
from asperity.surfaces.synthesis import self_affine

UM = 1e-6


def texture(seed, **options):
    chosen = {"rms": UM, "hurst": 0.8, "longest": 20 * UM, "shortest": 4 * UM, **options}
    return self_affine((192, 192), (UM, UM), seed=seed, **chosen)


def test_stationary_surfaces_are_rarely_called_inhomogeneous():
    p_values = [homogeneity(texture(seed), surrogates=19).p_value for seed in range(24)]
    # the p-value is uniform under the null hypothesis: mean 0.525, standard error 0.059
    assert abs(np.mean(p_values) - 0.525) < 0.18
    assert sum(p <= 0.05 for p in p_values) <= 5  # more than 5 of 24 has a probability of 0.1 %


def test_a_rougher_half_is_found():
    rough = np.array(texture(1).heights)
    rough[:, 96:] *= 1.5
    found = homogeneity(HeightMap(rough, (UM, UM)))
    assert not found.homogeneous
    assert found.p_value == 1 / 40
    assert found.variation > 2 * found.expected
    assert found.tile_rms.shape == (4, 4)
    assert_allclose(found.tile_rms[:, 2:].mean() / found.tile_rms[:, :2].mean(), 1.5, rtol=0.15)


def test_result_is_reproducible():
    surface = texture(2)
    assert homogeneity(surface, seed=5).p_value == homogeneity(surface, seed=5).p_value


def test_homogeneity_says_what_is_wrong():
    surface = texture(0)
    for tiles in ((1, 1), (0, 4), (97, 1)):
        with pytest.raises(InputError, match="tiles: received"):
            homogeneity(surface, tiles)
    with pytest.raises(InputError, match="at least 19"):
        homogeneity(surface, surrogates=10)


@pytest.mark.parametrize("degrees", [0.0, 25.0, 90.0, 140.0])
def test_direction_of_a_ridged_texture(degrees):
    angle = np.radians(degrees)
    x, y = np.meshgrid(np.arange(128) * UM, np.arange(128) * UM, indexing="ij")
    across = x * np.cos(angle) + y * np.sin(angle)
    rng = np.random.default_rng(0)
    ridges = sum(np.sin(2 * np.pi * across / w + rng.uniform(0, 6)) for w in np.linspace(4, 12, 20) * UM)
    blurred = ridges + 3 * rng.standard_normal(x.shape)
    with pytest.warns(UserWarning, match="upper bound"):
        found = {one.symbol: one.value for one in areal_statistics(HeightMap(blurred, (UM, UM)))}
    difference = (np.degrees(found["Std"]) - degrees + 90) % 180 - 90
    assert abs(difference) <= 2.0


def test_aspect_ratio_of_stretched_and_isotropic_texture():
    def found(surface):
        return {one.symbol: one.value for one in areal_statistics(surface)}

    assert found(texture(3))["Str"] > 0.75
    stretched = found(texture(3, anisotropy=4.0, longest=40 * UM))
    assert stretched["Str"] < 0.4
    assert abs(np.degrees(stretched["Std"]) - 90.0) < 12.0


def test_large_maps_are_tested_on_fewer_points():
    """A trend of ± 40 % over a map of 500 points a side is found, and the map itself passes."""
    surface = self_affine((500, 500), (UM, UM), rms=UM, hurst=0.8, longest=40 * UM, shortest=4 * UM, seed=1)
    assert homogeneity(surface).homogeneous
    trend = surface.heights * np.linspace(0.6, 1.4, 500)[:, None]
    found = homogeneity(HeightMap(trend, surface.spacing))
    assert found.p_value == 1 / 40
    whole = np.sqrt(np.mean(trend**2))
    assert_allclose(np.sqrt(np.mean(found.tile_rms**2)), whole, rtol=0.02)  # of all points


@pytest.mark.parametrize(
    ("failed", "maps", "more"),
    [
        (0, 5, False),
        (1, 1, True),
        (1, 2, False),
        (2, 2, True),
        (1, 5, False),
        (2, 5, True),
        (2, 8, False),
        (3, 8, True),
    ],
)
def test_more_maps_fail_than_chance_makes_fail(failed, maps, more):
    assert more_than_chance([0.05] * failed + [0.5] * (maps - failed)) == more
