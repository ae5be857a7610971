"""What chance and a start from rest leave of levels; one population or several: against closed forms."""

import json
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import stats
from scipy.stats import gamma

from asperity.reporting.tables import population_table
from asperity.scenes.population import _is_drawn, along_over_across, levels_along, told_apart
from asperity.spectra import band_product, level_deviation, ringing_band, values_seen
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.synthesis import self_affine
from small_cases import COARSE

CENTRE = 100.0
SETTLED, RECORD = 0.2, 0.8


def resonance(frequency, damping, centre=CENTRE):
    """One oscillator under a force, mass one; two places where it is the same."""
    own = 2.0 * np.pi * centre
    omega = 2.0 * np.pi * frequency
    return np.tile(1.0 / (own**2 - omega**2 + 2j * damping * own * omega), (2, 1))


@pytest.mark.parametrize(
    ("damping", "centre"), [(0.0005, CENTRE), (0.0025, CENTRE), (0.01, CENTRE), (0.00005, 4e3)]
)
def test_a_resonance_forgets_its_start_as_slowly_as_it_rings(damping, centre):
    """Its mean square grows as 1 − exp(−λt), λ = 2ζω; white noise in the band would be there at once.

    The last one rings longer than few frequencies in a band resolve.
    """
    rate = 2.0 * damping * 2.0 * np.pi * centre
    share = ringing_band(lambda f: resonance(f, damping, centre), centre).not_built_up(SETTLED, RECORD)
    expected = np.exp(-rate * SETTLED) * (1.0 - np.exp(-rate * RECORD)) / (rate * RECORD)
    assert share == pytest.approx(expected, rel=0.02, abs=0.01)


@pytest.mark.parametrize("damping", [0.0005, 0.001, 0.0025])
def test_a_band_holds_as_many_values_as_its_resonance_forgets(damping):
    """Of the correlation exp(−λ|τ|) of its square; the band itself would hold 18."""
    along = 2.0 * damping * 2.0 * np.pi * CENTRE * RECORD
    values = ringing_band(lambda f: resonance(f, damping), CENTRE).values(RECORD)
    expected = 0.5 * along / (1.0 - (1.0 - np.exp(-along)) / along)
    assert values == pytest.approx(max(expected, 1.0), rel=0.03)


def test_white_noise_holds_bandwidth_times_time():
    centres = 10.0 ** np.arange(2.0, 3.6, 0.1)
    found = [ringing_band(lambda f: np.ones((3, f.size)), centre) for centre in centres]
    values = [each.values(RECORD) for each in found]
    np.testing.assert_allclose(values, band_product(centres, RECORD), rtol=0.1)
    assert max(each.not_built_up(SETTLED, RECORD) for each in found) < 0.02


def test_places_that_ring_louder_count_more():
    """Half of a record that is silent leaves half of the values."""
    silent, even = (
        ringing_band(lambda f, p=p: np.outer(p, np.ones(f.size)), 1e3).values(RECORD)
        for p in ([1.0, 0.0], [1.0, 1.0])
    )
    assert silent == pytest.approx(0.5 * even, rel=1e-9)


@pytest.mark.parametrize("values", [1.0, 3.0, 50.0])
def test_a_level_deviates_as_that_of_a_gamma_distribution(values):
    draws = 10.0 * np.log10(gamma(values).rvs(200_000, random_state=1))
    assert level_deviation(values) == pytest.approx(draws.std(), rel=0.01)


def test_a_texture_that_comes_again_holds_the_values_of_one_turn():
    """Ten turns of the same noise scatter as one; noise that does not come again as all ten."""
    rng, turn, turns = np.random.default_rng(5), 400, 10
    centres, step = np.array([100.0, 200.0]), 1e-3
    seen = [values_seen(np.tile(rng.standard_normal(turn), turns), step, centres) for _ in range(40)]
    np.testing.assert_allclose(np.mean(seen, axis=0), 1.0 / turns, rtol=0.35)
    new = [values_seen(rng.standard_normal(turn * turns), step, centres) for _ in range(40)]
    assert (np.mean(new, axis=0) > 0.85).all()


UM = 1e-6
PATH = 40_000
"""Points of a path."""
PATCH = 8
"""Points of a patch."""


def noise(seed, points=PATH):
    return np.random.default_rng(seed).normal(size=points)


class TestToldApart:
    def test_the_probability_is_that_of_the_f_test(self):
        """Against another program, with groups of unequal size."""
        rng = np.random.default_rng(3)
        groups = [rng.normal(loc, 1.0, size) for loc, size in ((0.0, 3), (0.5, 5), (2.0, 4))]
        p, *_ = told_apart(groups)
        assert p == pytest.approx(stats.f_oneway(*groups).pvalue, rel=1e-9)

    def test_the_scatter_between_groups_is_found_without_that_inside_them(self):
        rng = np.random.default_rng(0)
        groups = list(rng.normal(0.0, 2.0, (400, 1)) + rng.normal(0.0, 3.0, (400, 8)))
        p, beyond, _ = told_apart(groups)
        assert p < 1e-6
        assert beyond == pytest.approx(2.0, rel=0.1)

    def test_groups_without_scatter(self):
        assert told_apart([np.ones(3), np.ones(2)]) == (1.0, 0.0, False)
        p, beyond, _ = told_apart([np.zeros(3), np.full(3, 2.0)])
        assert (p, beyond) == (0.0, pytest.approx(np.sqrt(2.0)))


class TestAlongThePath:
    def test_an_even_path_is_rarely_called_uneven(self):
        found = [told_apart(list(levels_along(noise(seed), PATCH)))[0] for seed in range(40)]
        assert np.mean(np.array(found) <= 0.05) < 0.15

    @pytest.mark.parametrize("shape", ["trend", "patch"])
    def test_a_rougher_end_and_a_rougher_middle_are_found(self, shape):
        """Known levels: from −3 dB to +3 dB along the path, or 6 dB on a quarter of it."""
        at = np.linspace(0.0, 1.0, PATH)
        level = 6.0 * at - 3.0 if shape == "trend" else 6.0 * (abs(at - 0.5) < 0.125)
        p, beyond, _ = told_apart(list(levels_along(noise(1) * 10 ** (level / 20), PATCH)))
        assert p < 1e-3
        assert beyond == pytest.approx(np.std(level), rel=0.25)

    def test_a_short_or_smooth_path_says_nothing(self):
        assert levels_along(noise(0, 500), PATCH) is None
        assert levels_along(np.zeros(PATH), PATCH) is None


class TestDirection:
    def test_a_lay_has_the_sign_of_the_path(self):
        """Waves along x: lines along are rougher. Turned, smoother by as much."""
        x = np.arange(256)
        waves = sum(np.sin(2 * np.pi * x / w + w) for w in np.linspace(9, 60, 40))[:, None]
        rough = HeightMap(UM * (waves + 0.1 * np.random.default_rng(0).normal(size=(256, 256))), (UM, UM))
        difference, (longest, shortest) = along_over_across([rough], 10 * UM)
        assert difference > 10.0
        assert (longest, shortest) == pytest.approx((128 * UM, 5 * UM))
        turned, _ = along_over_across([rough.transposed()], 10 * UM)
        assert turned == pytest.approx(-difference, rel=1e-6)

    def test_a_narrow_map_says_nothing(self):
        narrow = HeightMap(np.random.default_rng(0).normal(size=(256, 12)), (UM, UM))
        assert along_over_across([narrow], 10 * UM) is None


CASE = COARSE | {
    "laws": ["shifted", "linear"],
    "start": "0.3 m",
    "duration": "0.3 s",
    "contact": COARSE["contact"] | {"window": "0.92 mm", "samples": 8, "sample_length": "2 mm"},
}


def asked(result):
    return {item["question"]: item for item in json.loads(result["contact"].attrs["population"])}


def test_an_even_surface_is_one_population(runs):
    found = asked(result := runs(CASE))
    stiffness = found["Is one contact stiffness enough for the path?"]
    assert stiffness["answer"].startswith("One stiffness is enough: ")
    assert stiffness["value"].startswith("8 samples, coefficient of variation ")
    assert 0.0 < stiffness["effect"] < 1.0
    along = found["Is the path the same all along?"]
    assert (along["value"], along["effect"]) == ("drawn, not measured", 0.0)
    assert 0.0 < found["How well is the contact filter known?"]["effect"] < 3.0
    assert [row[0].text for row in population_table(result).rows] == list(found)


def test_maps_of_two_surfaces_are_told_apart(runs):
    """Two smooth maps and two that are so rough that they are softer by some decibels, whatever was drawn."""
    keys = {"hurst": 0.8, "longest": 1.2e-4, "shortest": 8e-5}
    maps = tuple(
        self_affine((60, 60), (40 * UM, 40 * UM), rms=rms * UM, seed=seed, **keys)
        for seed, rms in enumerate((0.02, 0.02, 3.0, 3.0))
    )
    result = runs(CASE | {"surface": {"file": maps}, "contact": CASE["contact"] | {"samples": 24}})
    found = asked(result)["Are the measured maps one population?"]
    assert found["answer"].startswith("The maps are not one population")
    assert found["effect"] > 1.0
    assert found["grade"] in ("warning", "out of range")
    assert "in stiffness" in result.attrs["verdict"]
    assert '"Are the measured maps one population?: 4 maps, p = ' in result.attrs["warnings"]


def test_a_path_that_gets_rougher_is_told(runs):
    line = np.random.default_rng(0).normal(size=20_000) * np.linspace(0.2, 1.8, 20_000)
    line = np.convolve(line, np.hanning(9) / 4, "same") * 0.02 * UM
    case = CASE | {"surface": CASE["surface"] | {"line": line, "line_spacing": 40 * UM}}
    found = asked(runs(case))["Is the path the same all along?"]
    assert found["answer"].startswith("The roughness is not the same all along the path")
    assert found["effect"] > 1.0


@pytest.mark.parametrize("spectrum", ["iso3095", "cnossos-average"])
def test_a_path_that_is_drawn_is_not_judged_by_one_realisation_of_it(runs, spectrum):
    """Of this seed waves of two metres make parts of one metre differ beyond what pieces of these do."""
    case = {
        "kind": "wheel-on-rail",
        "speed": "40 m/s",
        "laws": ["linear"],
        "duration": "0.1 s",
        "settling": "50 ms",
        "surface": {"spectrum": spectrum},
        "wheel": {"section": "rigid"},
        "track": {"name": "uic60"},
        "contact": {"spacing": "1 mm", "samples": 1, "sample_length": "0.1 m"},
        "numerics": {"highest_frequency": "3 kHz", "kernel": "scatter"},
    }
    tree = runs(case)
    assert asked(tree)["Is the path the same all along?"]["value"] == "drawn, not measured"
    assert "along the path" not in tree.attrs["verdict"]
    assert "Is the path the same" not in tree.attrs["warnings"]


@pytest.mark.parametrize(
    ("rough", "drawn", "all_of_it"),
    [
        (["rail"], ["surface"], True),
        (["rail", "wheel"], ["surface", "wheel"], True),
        (["rail", "wheel"], ["surface"], False),  # the wheel was measured
        (["rail", "wheel"], ["wheel"], False),
        (["rail"], ["wheel"], False),
    ],
)
def test_a_path_is_drawn_if_all_that_is_rough_is(rough, drawn, all_of_it):
    parts = {name: np.full(3, float(name in rough)) for name in ("rail", "wheel")}
    textures = SimpleNamespace(parts=parts, drawn=dict.fromkeys(drawn, "seed 1"))
    assert _is_drawn(SimpleNamespace(case=SimpleNamespace(ROLLING="wheel"), textures=textures)) is all_of_it
