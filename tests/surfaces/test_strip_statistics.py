"""Statistics of strips of any length: those of one map, whatever the pieces, and of all rows."""

import warnings

import numpy as np
import pytest

from asperity.errors import InputError
from asperity.spectra import psd
from asperity.surfaces import statistics
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.statistics import areal_statistics, survey_strip
from asperity.surfaces.synthesis import long_self_affine, self_affine

SPACING = (2e-6, 3e-6)


@pytest.fixture(scope="module")
def surface():
    found = self_affine((4000, 41), SPACING, rms=1e-6, hurst=0.8, longest=60e-6, shortest=12e-6, seed=3)
    return HeightMap(found.heights + 5e-6, SPACING)


@pytest.fixture
def small_pieces(monkeypatch):
    monkeypatch.setattr(statistics, "PIECE", 41 * 500)
    monkeypatch.setattr(statistics, "FEWEST_ROWS", 100)


def values(statistics):
    return {item.symbol: item.value for item in statistics}


class Watched:
    """A strip that counts what it is asked for."""

    def __init__(self, strip):
        self.strip, self.asked = strip, []
        self.shape, self.spacing, self.size = strip.shape, strip.spacing, strip.size

    def rows(self, first, stop):
        self.asked.append((first, stop))
        return self.strip.rows(first, stop)


def test_one_piece_has_the_statistics_of_a_map(surface):
    found, expected = values(survey_strip(surface, 500).statistics), values(areal_statistics(surface))
    whole = ["Std", "Sk", "Spk", "Svk", "Smr1", "Smr2"]  # are not found piece by piece
    assert [*found, *whole] == list(expected)
    expected = {symbol: expected[symbol] for symbol in found}
    for symbol, value in expected.items():
        assert found[symbol] == pytest.approx(value, rel=1e-9), symbol


@pytest.mark.usefixtures("small_pieces")
def test_pieces_change_nothing_but_the_correlation(surface):
    found, expected = values(survey_strip(surface, 200).statistics), values(areal_statistics(surface))
    for symbol in ("Sq", "Sa", "Ssk", "Sku", "Sz", "Sdq", "Sdr"):
        assert found[symbol] == pytest.approx(expected[symbol], rel=1e-9), symbol
    for symbol in ("Sal", "Str"):  # pairs across the ends of eight pieces are missing
        assert found[symbol] == pytest.approx(expected[symbol], rel=0.05), symbol


@pytest.mark.usefixtures("small_pieces")
def test_every_row_is_read_and_no_long_piece_at_once(surface):
    watched = Watched(surface)
    survey_strip(watched, 200, 100, 3900)
    assert min(first for first, _ in watched.asked) == 100
    assert max(stop for _, stop in watched.asked) == 3900
    assert max(stop - first for first, stop in watched.asked) <= 500 + 6
    inner = sum(stop - first for first, stop in watched.asked[: len(watched.asked) // 2])
    assert inner == 3800


def test_one_deep_place_far_along_the_strip_is_seen():
    """Two heights, the lower one a share s of all: skewness (2s − 1)/√(s(1 − s)), kurtosis skewness² + 1."""
    heights = np.zeros((50_000, 21))
    heights[40_000:40_100] = -248e-6
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = values(survey_strip(HeightMap(heights, (1e-3, 1e-3)), 1000).statistics)
    share = 100 / 50_000
    skewness = (2 * share - 1) / np.sqrt(share * (1 - share))
    assert found["Sz"] == pytest.approx(248e-6)
    assert found["Sq"] == pytest.approx(248e-6 * np.sqrt(share * (1 - share)))
    assert found["Sa"] == pytest.approx(2 * 248e-6 * share * (1 - share))
    assert found["Ssk"] == pytest.approx(skewness)
    assert found["Sku"] == pytest.approx(skewness**2 + 1)


@pytest.mark.usefixtures("small_pieces")
def test_distribution_holds_all_points_and_has_their_variance(surface):
    found = survey_strip(surface, 200)
    middle, width = (found.edges[1:] + found.edges[:-1]) / 2, np.diff(found.edges)
    assert np.sum(found.density * width) == pytest.approx(1.0)
    assert np.sum(middle * found.density * width) == pytest.approx(0.0, abs=0.02e-6)
    expected = values(found.statistics)["Sq"] ** 2
    assert np.sum(middle**2 * found.density * width) == pytest.approx(expected, rel=0.01)


@pytest.mark.usefixtures("small_pieces")
def test_the_distribution_counts_each_point_once_and_in_its_bin(surface):
    found = survey_strip(surface, 200)
    heights = surface.heights - surface.heights.mean()
    expected, _ = np.histogram(heights, found.edges)
    counts = found.density * heights.size * np.diff(found.edges)
    np.testing.assert_allclose(counts, expected, atol=1.01)  # the lowest or highest may lie beside an edge


@pytest.mark.usefixtures("small_pieces")
def test_spectrum_is_that_of_the_whole_strip(surface):
    found = survey_strip(surface, 200)
    wavenumber, density = psd(np.ascontiguousarray(surface.heights.T), SPACING[0], segment=200)
    np.testing.assert_allclose(found.wavenumber, wavenumber)
    strong = density.mean(axis=0) > 1e-3 * density.mean(axis=0).max()
    np.testing.assert_allclose(found.spectrum[strong][1:], density.mean(axis=0)[strong][1:], rtol=0.1)


def test_a_generated_strip_has_the_roughness_it_was_made_with():
    """0.5 µm rms over a metre at 10 µm, of which no more than pieces is ever held."""
    strip = long_self_affine(
        (100_000, 31), (10e-6, 10e-6), rms=0.5e-6, hurst=0.8, longest=0.2e-3, shortest=40e-6, seed=1
    )
    found = values(survey_strip(strip, 1000).statistics)
    assert found["Sq"] == pytest.approx(0.5e-6, rel=0.01)
    assert found["Sku"] == pytest.approx(3.0, abs=0.05)


def test_a_flat_strip_has_no_statistics():
    found = survey_strip(HeightMap(np.full((300, 11), 1e-6), SPACING), 100)
    assert found.statistics == []
    assert not found.spectrum.any()


def test_a_strip_shorter_than_a_segment_is_refused(surface):
    with pytest.raises(InputError, match="strip to survey: received 100 rows; allowed: at least 500 rows"):
        survey_strip(surface, 500, 0, 100)
