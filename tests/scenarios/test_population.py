"""One population or several: analysis of variance, parts of a path, along and across, and what a run says."""

import json

import numpy as np
import pytest
from scipy import stats

from asperity.reporting.tables import population_table
from asperity.scenes.population import along_over_across, levels_along, told_apart
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.synthesis import self_affine
from small_cases import COARSE

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
    assert found["Is the path the same all along?"]["grade"] == ""
    assert 0.0 < found["How well is the contact filter known?"]["effect"] < 3.0
    assert [row[0].text for row in population_table(result).rows] == list(found)


def test_maps_of_two_surfaces_are_told_apart(runs):
    """Two smooth maps and two that are so rough that they are softer by some decibels."""
    keys = {"hurst": 0.8, "longest": 1.2e-4, "shortest": 8e-5}
    maps = tuple(
        self_affine((60, 60), (40 * UM, 40 * UM), rms=rms * UM, seed=seed, **keys)
        for seed, rms in enumerate((0.02, 0.02, 1.5, 1.5))
    )
    result = runs(CASE | {"surface": {"file": maps}, "contact": CASE["contact"] | {"samples": 16}})
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
