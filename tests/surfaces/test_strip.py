"""Strips that are generated where they are read: statistics, blends, and freedom from how they are read."""

import numpy as np
import pytest
from scipy.stats import kstest

from asperity.errors import InputError
from asperity.spectra import psd
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.strip import LongStrip, Rows, raised, turning
from asperity.surfaces.synthesis import (
    from_map,
    long_self_affine,
    long_strip_from_bands,
    long_strip_like,
    self_affine,
    strip_from_bands,
)

DX = 10e-6
TEXTURE = {"rms": 1e-6, "hurst": 0.8, "longest": 0.4e-3, "shortest": 40e-6}


@pytest.fixture(autouse=True)
def _short_pieces(monkeypatch):
    monkeypatch.setattr("asperity.surfaces.synthesis.PIECE_POINTS", 2**14)


def strip(rows=20000, ny=17, seed=3):
    return long_self_affine((rows, ny), (DX, DX), **TEXTURE, seed=seed)


def test_every_part_is_the_same_however_it_is_read():
    whole = strip().rows(0, 20000)
    again = strip()
    for first, stop in [(19000, 20000), (0, 1), (900, 2100), (5000, 5000), (963, 9000)]:
        assert np.array_equal(again.rows(first, stop), whole[first:stop])
    assert np.array_equal(strip(rows=3000).rows(0, 3000), whole[:3000])  # longer strips begin with shorter


def test_variance_is_that_of_the_surface_in_blends_too():
    made = strip(rows=200000, ny=9)
    heights = made.rows(0, 200000)
    assert made.blend < made.stride
    in_blend = np.arange(made.stride, 200000) % made.stride < made.blend
    inside, outside = heights[made.stride :][in_blend], heights[made.stride :][~in_blend]
    assert np.sqrt(np.mean(outside**2)) == pytest.approx(1e-6, rel=0.03)
    assert np.sqrt(np.mean(inside**2)) == pytest.approx(1e-6, rel=0.08)


def test_spectrum_is_that_of_one_large_surface():
    long = strip(rows=200000, ny=9).rows(0, 200000)
    one = self_affine((100000, 9), (DX, DX), **TEXTURE, seed=5).heights
    wavenumber, found = psd(np.ascontiguousarray(long.T), DX, segment=1024)
    _, wanted = psd(np.ascontiguousarray(one.T), DX, segment=1024)
    used = (wavenumber > 300) & (wavenumber < 24e3)
    edges = np.geomspace(300, 24e3, 20)
    band = np.digitize(wavenumber[used], edges)
    for i in np.unique(band):
        ratio = found.mean(axis=0)[used][band == i].sum() / wanted.mean(axis=0)[used][band == i].sum()
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
    measured = self_affine((120, 120), (DX, DX), **TEXTURE, seed=1).heights
    skewed = HeightMap(np.where(measured > 0, 0.3 * measured, measured), (DX, DX))
    long = long_strip_like(skewed, (60000, 9), seed=2)
    once = from_map(skewed, (20000, 9), seed=2).heights
    heights = long.rows(0, 60000)
    assert kstest(heights[::40, 4], once[::40, 4]).pvalue > 1e-3
    blends = heights[long.stride : long.stride + long.blend]
    assert blends.min() >= skewed.levelled().heights.min()
    assert blends.max() <= skewed.levelled().heights.max()


def test_raised_adds_the_same_all_across():
    below = Rows(np.arange(12.0).reshape(6, 2), (1.0, 2.0))
    higher = raised(below, np.arange(6.0))
    assert higher.shape == (6, 2)
    assert higher.spacing == (1.0, 2.0)
    assert higher.size == (6.0, 4.0)
    assert np.array_equal(higher.rows(2, 4), below.rows(2, 4) + np.array([[2.0], [3.0]]))


def test_bad_strips_are_refused():
    def nothing(rows, seed):
        return np.zeros((rows, 3))

    with pytest.raises(InputError, match="blend of the strip"):
        LongStrip((10, 3), (DX, DX), nothing, 0, stride=4, blend=5)
    with pytest.raises(InputError, match="at least 2 points each"):
        LongStrip((10, 1), (DX, DX), nothing, 0, stride=4, blend=2)
    with pytest.raises(InputError, match="rows of the strip"):
        LongStrip((10, 3), (DX, DX), nothing, 0, stride=4, blend=2).rows(5, 11)
    with pytest.raises(InputError, match="hurst"):
        long_self_affine((10, 3), (DX, DX), **TEXTURE | {"hurst": 2.0}, seed=1)


def bands(rows, before=0, seed=3):
    wavelengths, levels = [0.1, 0.05, 0.025], [10.0, 5.0, 0.0]
    return long_strip_from_bands((rows, 5), (2e-3, 2e-3), wavelengths, levels, seed=seed, before=before)


def test_a_strip_with_rows_before_has_no_beginning():
    long = bands(9000, before=4000)
    for before in (1, 700, 3999):
        short = bands(before + 1000, before=before)
        assert np.array_equal(short.rows(0, before + 1000), long.rows(4000 - before, 5000))
    assert np.isfinite(long.rows(0, 9000)).all()


def test_a_long_strip_from_bands_has_their_levels():
    made = bands(60000, before=10)
    assert made.stride < 60000 / 10
    heights = made.rows(0, 60000)
    wavenumber, density = psd(np.ascontiguousarray(heights.T), 2e-3, segment=4096)
    for wavelength, level in ((0.1, 10.0), (0.05, 5.0), (0.025, 0.0)):
        low, high = (10 ** (round(-10 * np.log10(wavelength)) / 10 + s / 20) for s in (-1, 1))
        inside = (wavenumber > low) & (wavenumber < high)
        energy = density.mean(axis=0)[inside].sum() * wavenumber[1]
        assert 10 * np.log10(energy / 1e-12) == pytest.approx(level, abs=0.4)


def test_strips_of_one_texture_share_pieces(monkeypatch):
    made = []
    whole = strip_from_bands

    def counted(*arguments, **keywords):
        made.append(keywords["seed"])
        return whole(*arguments, **keywords)

    monkeypatch.setattr("asperity.surfaces.synthesis.strip_from_bands", counted)
    for before in (500, 600):
        bands(3000, before=before, seed=77).rows(0, 3000)
    assert len(made) == len(set(made))


def test_a_wheel_comes_round():
    turn = np.arange(6.0).reshape(3, 2)
    rolled = turning(Rows(np.zeros((8, 2)), (1.0, 2.0)), turn, -4)
    assert rolled.shape == (8, 2)
    assert rolled.size == (8.0, 4.0)
    assert np.array_equal(rolled.rows(3, 8), turn[[2, 0, 1, 2, 0]])
