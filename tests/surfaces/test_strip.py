"""Strips that are generated where they are read, what is kept of them, and what they are like as a whole."""

import gc
from concurrent.futures import ThreadPoolExecutor
from unittest.mock import Mock

import numpy as np
import pytest
from scipy.stats import kstest

from asperity.spectra import psd
from asperity.surfaces import statistics, synthesis
from asperity.surfaces import strip as module
from asperity.surfaces.bands import strip_from_bands
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.statistics import areal_statistics, survey_strip
from asperity.surfaces.strip import Fields, LongStrip, Rows, raised, turning
from refusals import refusals

DX = 10e-6
TEXTURE = {"rms": 1e-6, "hurst": 0.8, "longest": 0.4e-3, "shortest": 40e-6}
LEVELS = {0.1: 10.0, 0.05: 5.0, 0.025: 0.0}


@pytest.fixture(autouse=True)
def _short_pieces(monkeypatch):
    monkeypatch.setattr("asperity.surfaces.synthesis.PIECE_POINTS", 2**14)


def strip(rows=20000, ny=17):
    return synthesis.long_self_affine((rows, ny), (DX, DX), **TEXTURE, seed=3)


def bands(rows, before=0, seed=3):
    levels = list(LEVELS), list(LEVELS.values())
    return synthesis.long_strip_from_bands((rows, 5), (2e-3, 2e-3), *levels, seed=seed, before=before)


def densities(heights, spacing, segment):
    wavenumber, density = psd(np.ascontiguousarray(heights.T), spacing, segment=segment)
    return wavenumber, density.mean(axis=0)


def test_every_part_is_the_same_however_it_is_read():
    whole = strip().rows(0, 20000)
    again = strip()
    for first, stop in [(19000, 20000), (0, 1), (900, 2100), (5000, 5000), (963, 9000)]:
        assert np.array_equal(again.rows(first, stop), whole[first:stop])
    assert np.array_equal(strip(rows=3000).rows(0, 3000), whole[:3000])  # longer strips begin with shorter


def test_a_strip_with_rows_before_has_no_beginning():
    long = bands(9000, before=4000).rows(0, 9000)
    for before in (1, 700, 3999):
        short = bands(before + 1000, before=before)
        assert np.array_equal(short.rows(0, before + 1000), long[4000 - before : 5000])


def test_variance_and_spectrum_are_those_of_one_large_surface_in_blends_too():
    made = strip(rows=200000, ny=9)
    heights = made.rows(0, 200000)
    in_blend = np.arange(made.stride, 200000) % made.stride < made.blend
    inside, outside = heights[made.stride :][in_blend], heights[made.stride :][~in_blend]
    assert made.blend < made.stride
    assert np.sqrt(np.mean(outside**2)) == pytest.approx(1e-6, rel=0.03)
    assert np.sqrt(np.mean(inside**2)) == pytest.approx(1e-6, rel=0.08)
    one = synthesis.self_affine((100000, 9), (DX, DX), **TEXTURE, seed=5).heights
    (wavenumber, found), (_, wanted) = (densities(each, DX, 1024) for each in (heights, one))
    band = np.digitize(wavenumber, np.geomspace(300, 24e3, 20))
    for i in np.unique(band)[1:-1]:
        ratio = found[band == i].sum() / wanted[band == i].sum()
        assert 10 * np.log10(ratio) == pytest.approx(0.0, abs=0.5)


def test_pieces_are_independent_and_join_without_a_step():
    made = strip()
    heights = made.rows(0, 20000)
    steps = np.abs(np.diff(heights, axis=0)).max(axis=1)
    joints = np.arange(made.stride, 20000, made.stride) - 1
    assert steps[joints].max() < 1.2 * np.quantile(steps, 0.999)
    a, b = (heights[made.stride * k + made.blend : made.stride * (k + 1)].ravel() for k in (1, 2))
    assert abs(np.corrcoef(a, b)[0, 1]) < 0.2


def test_likeness_has_the_measured_distribution():
    measured = synthesis.self_affine((120, 120), (DX, DX), **TEXTURE, seed=1).heights
    skewed = HeightMap(np.where(measured > 0, 0.3 * measured, measured), (DX, DX))
    long = synthesis.long_strip_like(skewed, (60000, 9), seed=2)
    once = synthesis.from_map(skewed, (20000, 9), seed=2).heights
    heights = long.rows(0, 60000)
    assert kstest(heights[::40, 4], once[::40, 4]).pvalue > 1e-3
    blends = heights[long.stride : long.stride + long.blend]
    lowest, highest = np.quantile(skewed.levelled().heights, (0, 1))
    assert lowest <= blends.min() <= blends.max() <= highest


def test_a_long_strip_from_bands_has_their_levels():
    made = bands(60000, before=10)
    assert made.stride < 60000 / 10
    wavenumber, density = densities(made.rows(0, 60000), 2e-3, 4096)
    for wavelength, level in LEVELS.items():
        low, high = (10 ** (round(-10 * np.log10(wavelength)) / 10 + s / 20) for s in (-1, 1))
        energy = density[(wavenumber > low) & (wavenumber < high)].sum() * wavenumber[1]
        assert 10 * np.log10(energy / 1e-12) == pytest.approx(level, abs=0.4)


def test_strips_of_one_texture_share_pieces(monkeypatch):
    made, whole = [], strip_from_bands

    def counted(*arguments, **keywords):
        made.append(keywords["seed"])
        return whole(*arguments, **keywords)

    monkeypatch.setattr("asperity.surfaces.synthesis.strip_from_bands", counted)
    for before in (500, 600):
        bands(3000, before=before, seed=77).rows(0, 3000)
    assert len(made) == len(set(made))


def test_heights_are_added_all_across_or_turn_by_turn():
    below, turn = Rows(np.arange(16.0).reshape(8, 2), (1.0, 2.0)), np.arange(6.0).reshape(3, 2)
    higher, rolled = raised(below, np.arange(8.0)), turning(below, turn, -4)
    assert np.array_equal(higher.rows(2, 4), below.rows(2, 4) + np.array([[2.0], [3.0]]))
    assert np.array_equal(rolled.rows(3, 8), below.rows(3, 8) + turn[[2, 0, 1, 2, 0]])
    for made in (higher, rolled):
        assert (made.shape, made.spacing) == ((8, 2), (1.0, 2.0))


def zeros(shape, stride=4, blend=2):
    return LongStrip(shape, (DX, DX), lambda rows, seed: np.zeros((rows, 3)), 0, stride=stride, blend=blend)


test_what_is_wrong_is_said = refusals(
    (lambda: synthesis.long_self_affine((10, 3), (DX, DX), **TEXTURE | {"hurst": 2.0}, seed=1), "hurst"),
    (lambda: survey_strip(zeros((1000, 3)), 500, 0, 100), "received 100 rows; allowed: at least 500 rows"),
)


BYTES = 100 * 3 * 8
"""Of one field."""


class Made:
    """Fields that tell how often they were made."""

    def __init__(self):
        self.fields, self.numbers = Fields(), []

    def make(self, number):
        self.numbers.append(number)
        return np.arange(300.0).reshape(100, 3) + 1e4 * number

    def read(self, *numbers):
        for number in numbers:
            found = self.fields.rows(number, lambda number=number: self.make(number), 5, 6)
            assert found.tolist() == [[1e4 * number + 15, 1e4 * number + 16, 1e4 * number + 17]]
        return found


def test_fields_are_made_once_and_none_is_held_in_memory():
    made = Made()
    found = made.read(*2 * (0, 1, 2, 3, 4))
    assert made.numbers == [0, 1, 2, 3, 4]
    assert made.fields.nbytes == 0
    made.fields = None
    gc.collect()
    assert found[0, 0] == 4e4 + 15  # rows outlive the fields they are of


@pytest.mark.parametrize(
    ("kept", "read", "numbers"),
    [(4 * BYTES, (0, 1, 2, 3, 4, 3, 0), [0, 1, 2, 3, 4, 3, 0]), (0, (0, 1, 0, 1, 0, 1), [0, 1])],
)
def test_where_there_are_too_many_all_but_neighbours_are_made_again(monkeypatch, kept, read, numbers):
    monkeypatch.setattr(module, "BYTES_KEPT", kept)
    made = Made()
    made.read(*read)
    assert made.numbers == numbers


@pytest.mark.parametrize("at_once", [True, False])
def test_without_a_file_few_fields_are_held_in_memory(monkeypatch, at_once):
    """On a disk that is full when the file is made, or while it is written."""
    full = Mock(side_effect=OSError(28, "No space left on device"))
    monkeypatch.setattr("tempfile.TemporaryFile", full if at_once else lambda prefix: Mock(write=full))
    monkeypatch.setattr(module, "BYTES_IN_MEMORY", 4 * BYTES)
    made = Made()
    made.read(*2 * (0, 1, 2, 3))
    assert made.numbers == [0, 1, 2, 3]
    made.read(4)
    assert made.fields.nbytes == BYTES


def test_threads_read_beside_each_other():
    made = Made()
    with ThreadPoolExecutor(6) as threads:
        list(threads.map(lambda _: made.read(*30 * (0, 1, 2)), range(6)))
    assert sorted(made.numbers) == [0, 1, 2]


@pytest.fixture(scope="module")
def surface():
    found = synthesis.self_affine(
        (4000, 41), (2e-6, 3e-6), rms=1e-6, hurst=0.8, longest=60e-6, shortest=12e-6, seed=3
    )
    return HeightMap(found.heights + 5e-6, (2e-6, 3e-6))


@pytest.fixture
def in_pieces(monkeypatch):
    """At most 500 rows of 41 points at a time."""
    monkeypatch.setattr(statistics, "PIECE", 41 * 500)
    monkeypatch.setattr(statistics, "FEWEST_ROWS", 100)


def values(statistics):
    return {item.symbol: item.value for item in statistics}


def test_one_piece_has_the_statistics_of_a_map(surface):
    found, expected = values(survey_strip(surface, 500).statistics), values(areal_statistics(surface))
    for symbol in ("Std", "Sk", "Spk", "Svk", "Smr1", "Smr2"):  # are not found piece by piece
        del expected[symbol]
    assert found == pytest.approx(expected, rel=1e-9)


@pytest.mark.usefixtures("in_pieces")
def test_pieces_change_nothing_but_the_correlation_and_hold_every_row_once(surface, monkeypatch):
    asked = []

    class Watched(Rows):
        def rows(self, first, stop):
            asked.append((first, stop))
            return self.heights[first:stop]

    part = HeightMap(surface.heights[100:3900], surface.spacing)
    found = survey_strip(Watched(surface.heights, surface.spacing), 200, 100, 3900)
    assert max(stop - first for first, stop in asked) <= 500 + 6
    expected = values(areal_statistics(part))
    for symbol, value in values(found.statistics).items():  # pairs across the ends of pieces are missing
        off = 0.05 if symbol in ("Sal", "Str") else 1e-9
        assert value == pytest.approx(expected[symbol], rel=off, abs=0.0), symbol
    wavenumber, density = densities(part.heights, 2e-6, 200)
    np.testing.assert_allclose(found.wavenumber, wavenumber)
    strong = np.flatnonzero(density > 1e-3 * density.max())[1:]
    np.testing.assert_allclose(found.spectrum[strong], density[strong], rtol=0.1)


@pytest.mark.filterwarnings("ignore::asperity.errors.ShortRecordWarning")
def test_one_deep_place_far_along_the_strip_is_seen():
    """Two heights, the lower one a share s of all: skewness (2s − 1)/√(s(1 − s)), kurtosis skewness² + 1."""
    heights = np.zeros((50_000, 21))
    heights[40_000:40_100] = -248e-6
    found = values(survey_strip(HeightMap(heights, (1e-3, 1e-3)), 1000).statistics)
    share = 100 / 50_000
    skewness = (2 * share - 1) / np.sqrt(share * (1 - share))
    expected = {"Sz": 248e-6, "Sq": 248e-6 * np.sqrt(share * (1 - share)), "Ssk": skewness}
    expected |= {"Sa": 2 * 248e-6 * share * (1 - share), "Sku": skewness**2 + 1}
    assert {symbol: found[symbol] for symbol in expected} == pytest.approx(expected)


def test_a_flat_strip_has_no_statistics():
    found = survey_strip(HeightMap(np.full((300, 11), 1e-6), 1e-6), 100)
    assert found.statistics == []
    assert not found.spectrum.any()
