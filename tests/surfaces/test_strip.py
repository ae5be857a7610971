"""Strips that are generated where they are read, what is kept of them, and what they are like as a whole."""

import gc
import multiprocessing
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from threading import Barrier, Event
from unittest.mock import Mock

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import kstest

from asperity.spectra import psd
from asperity.surfaces import statistics, synthesis, tiles
from asperity.surfaces import strip as module
from asperity.surfaces.bands import RangeOfBands
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.spectra import psd_2d
from asperity.surfaces.statistics import areal_statistics, survey_strip
from asperity.surfaces.strip import Fields, Rows, raised, turning
from refusals import refusals

DX = 10e-6
TEXTURE = {"rms": 1e-6, "hurst": 0.8, "longest": 0.4e-3, "shortest": 40e-6}
LEVELS = {0.1: 10.0, 0.05: 5.0, 0.025: 0.0}


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


def test_a_strip_with_rows_before_has_no_beginning():
    long = bands(9000, before=4000).rows(0, 9000)
    for before in (0, 700, 3999):
        short = bands(before + 1000, before=before)
        assert np.array_equal(short.rows(0, before + 1000), long[4000 - before : 5000])


KINDS = {
    "self-affine": lambda shape, dx, **keys: synthesis.long_self_affine(
        shape, (dx, dx), **TEXTURE | {"anisotropy": 2.0, "lay": 0.3}, **keys
    ),
    "bands": lambda shape, dx, **keys: synthesis.long_strip_from_bands(
        shape, (200 * dx, 200 * dx), list(LEVELS), list(LEVELS.values()), lateral=0.1, **keys
    ),
    "likeness": lambda shape, dx, **keys: synthesis.long_strip_like(SHEET, shape, **keys),
}
SHEET = synthesis.self_affine((40, 30), (DX, DX), **TEXTURE | {"longest": 0.2e-3}, seed=1)


@settings(max_examples=10, deadline=None, derandomize=True)
@given(st.data(), st.sampled_from(sorted(KINDS)), st.integers(0, 2**64))
def test_a_shorter_narrower_or_coarser_strip_is_a_piece_of_any_larger_one(data, kind, seed):
    rows, before = data.draw(st.integers(2, 900)), data.draw(st.integers(-2000, 3000))
    half, finer = data.draw(st.integers(0, 25)), data.draw(st.sampled_from([1, 2, 3]))
    if kind == "likeness":  # resampled maps are others
        finer = 1
    ahead, behind, wider = (data.draw(st.integers(0, most)) for most in (300, 300, 12))
    small = KINDS[kind]((rows, 2 * half + 1), DX, seed=seed, before=before).rows(0, rows)
    shape = finer * (ahead + rows + behind), 2 * finer * (half + wider) + 1
    large = KINDS[kind](shape, DX / finer, seed=seed, before=finer * (before + ahead)).rows(0, shape[0])
    first, middle = finer * ahead, shape[1] // 2
    piece = large[
        first : first + finer * rows : finer, middle - finer * half : middle + finer * half + 1 : finer
    ]
    np.testing.assert_allclose(small, piece, rtol=0, atol=1e-10 * max(np.std(large), 1e-12))


@pytest.mark.parametrize("shortest", [80e-6, 60e-6])
def test_shorter_waves_are_added_to_the_same_surface(shortest):
    """All that is in the coarse surface is in the fine one, scaled alike; no wave of the rest is so long."""
    fine, coarse = (synthesis.SelfAffine(**TEXTURE | keys) for keys in ({}, {"shortest": shortest}))
    both = [
        synthesis.self_affine((160, 160), (DX, DX), **TEXTURE | {"shortest": each}, seed=3).heights
        for each in (TEXTURE["shortest"], shortest)
    ]
    share = coarse.mean_square / fine.mean_square
    rest = both[0] - both[1] * np.sqrt(share)
    assert np.mean(rest**2) / np.mean(both[0] ** 2) == pytest.approx(1.0 - share, rel=0.4)
    qx, qy, density = psd_2d(HeightMap(rest, (DX, DX)))
    assert density[np.hypot(qx[:, None], qy) < 0.8 * 2 * np.pi / shortest].max() < 1e-3 * density.max()


def test_bands_are_added_to_the_same_line_and_none_of_its_waves_changes():
    coarse, fine = (
        synthesis.long_strip_from_bands((9, 1), (dx, dx), list(LEVELS), list(LEVELS.values()), seed=3).drawn
        for dx in (20e-3, 2e-3)
    )
    few, many = ([part.waves(0, np.zeros(1)) for part in each.ranges] for each in (coarse, fine))
    assert len(few[-1]) < 0.6 * len(many[-1])
    for less, more in zip(few, many, strict=False):
        np.testing.assert_array_equal(less, more[: len(less)])


@pytest.mark.parametrize("factor", [2.0, 1e-3])
def test_heights_are_proportional_to_the_rms_and_to_the_level(factor):
    one, other = (
        synthesis.self_affine((300, 40), (DX, DX), **TEXTURE | {"rms": rms}, seed=3).heights
        for rms in (1e-6, factor * 1e-6)
    )
    np.testing.assert_allclose(other, factor * one, rtol=0, atol=1e-18 * factor)
    line, louder = (
        synthesis.long_strip_from_bands((300, 5), (2e-3, 2e-3), [0.1], [level], seed=3).rows(0, 300)
        for level in (0.0, 20 * np.log10(factor))
    )
    np.testing.assert_allclose(louder, factor * line, rtol=0, atol=1e-18 * factor)


def strongest(texture):
    """Range of waves that holds most of a self-affine surface."""
    return max(texture.ranges, key=lambda each: each.power.sum())


def test_variance_and_spectrum_are_those_of_one_large_surface_in_blends_too():
    made = strip(rows=200000, ny=9)
    heights, along = made.rows(0, 200000), strongest(made.drawn).along
    in_blend = (DX * np.arange(200000) - along.start) % along.stride < along.blend
    inside, outside = heights[in_blend], heights[~in_blend]
    assert 0.4 < np.mean(in_blend) < 0.45
    assert np.sqrt(np.mean(outside**2)) == pytest.approx(1e-6, rel=0.03)
    assert np.sqrt(np.mean(inside**2)) == pytest.approx(1e-6, rel=0.08)
    wavenumber, found = densities(heights, DX, 1024)
    q = 2 * np.pi * wavenumber[:, None]
    areal = np.maximum(np.hypot(q, q.T), 2 * np.pi / TEXTURE["longest"]) ** (-2.0 - 2.0 * TEXTURE["hurst"])
    areal[np.hypot(q, q.T) > 2 * np.pi / TEXTURE["shortest"]] = 0.0
    areal[:, 0] *= 0.5
    wanted = areal.sum(axis=1) / areal.sum() * 1e-12 / wavenumber[1]
    band = np.digitize(wavenumber, np.geomspace(350, 24e3, 16))
    for i in range(1, 16):
        ratio = found[band == i].sum() / wanted[band == i].sum()
        scatter = 4.34 / np.sqrt(np.sum(band == i) * wavenumber[1] * DX * 200000)  # of one line, dB
        assert abs(10 * np.log10(ratio)) < 4.0 * scatter + 0.05


def expected_spectrum(shape, *, hurst, longest, shortest, anisotropy, lay, **_):
    """Mean square of windowed Fourier lines of a piece (nx, ny) of rms one, by integrating its spectrum."""
    q = np.arange(-15.0, 15.0, 1.0 / 16.0) * 2.0 * np.pi / longest
    x, y = q[:, None], q
    along, across = x * np.cos(lay) + y * np.sin(lay), y * np.cos(lay) - x * np.sin(lay)
    stretched = np.hypot(along * np.sqrt(anisotropy), across / np.sqrt(anisotropy))
    density = np.maximum(stretched, 2.0 * np.pi / longest) ** (-2.0 - 2.0 * hurst)
    density[np.hypot(x, y) > 2.0 * np.pi / shortest] = 0.0
    sides = []
    for points in shape:  # a window's transform at each Fourier line, of each wave
        turns = 2.0 * np.pi * np.fft.fftfreq(points)[:, None] - q
        window = np.hanning(points + 2)[1:-1]
        sides.append(np.abs(np.exp(-1j * turns[..., None] * np.arange(points)) @ window) ** 2)
    return sides[0] @ density @ sides[1].T / density.sum()


@pytest.mark.parametrize(("anisotropy", "lay"), [(1.0, 0.0), (3.0, 0.4)])
@pytest.mark.parametrize("where", ["middle", "blend"])
def test_the_mean_of_draws_is_the_spectrum_in_every_bin(anisotropy, lay, where):
    """By an estimator of its own, in bins of size and direction of the wavenumber, in steps of one."""
    keys = {"hurst": 0.8, "longest": 17.0, "shortest": 3.0, "anisotropy": anisotropy, "lay": lay}
    shape, along = (64, 32), strongest(synthesis.SelfAffine(1.0, **keys)).along
    before = 0 if where == "middle" else 32 - round(along.start + along.stride + 0.5 * along.blend)
    windows = np.hanning(66)[1:-1, None] * np.hanning(34)[1:-1]
    drawn = [
        synthesis.long_self_affine(shape, (1.0, 1.0), rms=1.0, seed=s, before=before, **keys).rows(0, 64)
        for s in range(120)
    ]
    x, y = np.fft.fftfreq(64)[:, None], np.fft.fftfreq(32)
    size = np.digitize(np.hypot(x, y), np.geomspace(0.02, 0.3, 8))
    bins = (size * 6 + np.mod(np.arctan2(y, x), np.pi) // (np.pi / 6)).astype(int).ravel()
    held = np.unique(bins[(size > 0).ravel() & (size < 8).ravel()])
    found = [np.bincount(bins, (np.abs(np.fft.fft2(z * windows)) ** 2).ravel())[held] for z in drawn]
    error = np.std(found, axis=0, ddof=1) / np.sqrt(len(found))
    off = (np.mean(found, axis=0) - np.bincount(bins, expected_spectrum(shape, **keys).ravel())[held]) / error
    # forty bins: one in a hundred sets of draws has a larger one than four, or a mean square above 1.8
    assert np.abs(off).max() < 4.0
    assert np.mean(off**2) < 1.8


def test_pieces_are_independent_and_join_without_a_step():
    made = strip()
    heights = made.rows(0, 20000)
    steps = np.abs(np.diff(heights, axis=0)).max(axis=1)
    for along in (each.along for each in made.drawn.ranges):
        ends = (along.start + k * along.stride + b for k in (1, 2, 3) for b in (0, along.blend))
        joints = np.array([round(end / DX) for end in ends])
        assert steps[joints[joints < len(steps)] - 1].max(initial=0.0) < 1.2 * np.quantile(steps, 0.999)
    apart = round(strongest(made.drawn).along.stride / DX)
    assert abs(np.corrcoef(heights[:4000].ravel(), heights[apart : apart + 4000].ravel())[0, 1]) < 0.2


def test_likeness_has_the_measured_distribution():
    measured = synthesis.self_affine((120, 120), (DX, DX), **TEXTURE, seed=1).heights
    skewed = HeightMap(np.where(measured > 0, 0.3 * measured, measured), (DX, DX))
    long = synthesis.long_strip_like(skewed, (60000, 9), seed=2)
    once = synthesis.from_map(skewed, (20000, 9), seed=2).heights
    heights = long.rows(0, 60000)
    assert kstest(heights[::40, 4], once[::40, 4]).pvalue > 1e-3
    along = long.drawn.ranges[0].along
    at = round((along.start + along.stride) / DX)
    blends = heights[at : at + round(along.blend / DX)]
    lowest, highest = np.quantile(skewed.levelled().heights, (0, 1))
    assert lowest <= blends.min() <= blends.max() <= highest


def test_a_long_strip_from_bands_has_their_levels():
    made = bands(60000, before=10)
    wavenumber, density = densities(made.rows(0, 60000), 2e-3, 4096)
    for wavelength, level in LEVELS.items():
        low, high = (10 ** (round(-10 * np.log10(wavelength)) / 10 + s / 20) for s in (-1, 1))
        energy = density[(wavenumber > low) & (wavenumber < high)].sum() * wavenumber[1]
        assert 10 * np.log10(energy / 1e-12) == pytest.approx(level, abs=0.4)


def test_strips_of_one_texture_share_pieces(monkeypatch):
    made, whole = [], RangeOfBands.waves

    def counted(part, tile, across):
        made.append((part.number, tile))
        return whole(part, tile, across)

    monkeypatch.setattr(RangeOfBands, "waves", counted)
    for before in (500, 600):
        bands(3000, before=before, seed=77).rows(0, 3000)
    assert len(made) == len(set(made)) > 2


def test_pieces_belong_to_places_on_the_grid(monkeypatch):
    """Whatever is before place zero; other spacings across have their own."""
    monkeypatch.setattr(module, "pieces", Fields())
    made, make = [], module.heights_at
    monkeypatch.setattr(module, "heights_at", lambda *each: made.append(len(each[1])) or make(*each))
    first = bands(5000, before=500, seed=78).rows(0, 5000)
    assert made == [4500 - 2 * module.PIECE, module.PIECE, module.PIECE, 500]
    second = bands(5000, before=600, seed=78).rows(0, 5000)
    assert made[4:] == [4400 - 2 * module.PIECE, 600]  # those between are there
    assert np.array_equal(second[100:], first[:4900])
    drawn = bands(5000, before=500, seed=78)
    closer = replace(drawn, spacing=(drawn.spacing[0], 0.5 * drawn.spacing[1])).rows(0, 5000)
    assert np.array_equal(closer[:, 2], first[:, 2])  # the middle
    assert not np.array_equal(closer, first)


def test_pieces_are_drawn_as_long_as_something_else_is_done(monkeypatch):
    monkeypatch.setattr(module, "pieces", Fields())
    third, made, make = Event(), [], module.heights_at

    def counted(*each):
        made.append(len(each[1]))
        if len(made) == 3:
            third.set()
        return make(*each)

    monkeypatch.setattr(module, "heights_at", counted)
    long = bands(10**6, seed=79)
    for threads, drawn in (("1", None), ("2", None), ("1", long)):
        monkeypatch.setenv("ASPERITY_THREADS", threads)
        with module.drawn_meanwhile(drawn):
            pass
    assert not made
    monkeypatch.setenv("ASPERITY_THREADS", "2")
    with module.drawn_meanwhile(long):
        assert third.wait(60.0)
    count = len(made)
    assert count < 10**6 // module.PIECE
    long.rows(0, 3 * module.PIECE)
    assert made == count * [module.PIECE]  # what is read is there, and no more is drawn


def test_heights_are_added_all_across_or_turn_by_turn():
    below, turn = Rows(np.arange(16.0).reshape(8, 2), (1.0, 2.0)), np.arange(6.0).reshape(3, 2)
    higher, rolled = raised(below, np.arange(8.0)), turning(below, turn, -4)
    assert np.array_equal(higher.rows(2, 4), below.rows(2, 4) + np.array([[2.0], [3.0]]))
    assert np.array_equal(rolled.rows(3, 8), below.rows(3, 8) + turn[[2, 0, 1, 2, 0]])
    for made in (higher, rolled):
        assert (made.shape, made.spacing) == ((8, 2), (1.0, 2.0))


test_what_is_wrong_is_said = refusals(
    (lambda: synthesis.long_self_affine((10, 3), (DX, DX), **TEXTURE | {"hurst": 2.0}, seed=1), "hurst"),
    (lambda: survey_strip(strip(1000), 500, 0, 100), "received 100 rows; allowed: at least 500 rows"),
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
            found = self.fields.rows(number, lambda number=number: self.make(number))[5:6]
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


def test_threads_make_different_fields_at_once():
    fields, both = Fields(), Barrier(2)

    def make(number):
        both.wait(60)  # until the other one is in the making
        return np.full((100, 3), float(number))

    with ThreadPoolExecutor(2) as threads:
        found = threads.map(lambda number: fields.rows(number, lambda: make(number))[0, 0], (1, 2))
        assert list(found) == [1.0, 2.0]


def test_a_field_whose_making_fails_is_made_by_the_next_who_wants_it():
    fields = Fields()
    with pytest.raises(ZeroDivisionError):
        fields.rows(0, lambda: np.zeros((100, 3)) / (1 // 0))
    assert fields.rows(0, lambda: np.ones((100, 3)))[0, 0] == 1.0


@pytest.fixture(scope="module")
def surface():
    found = synthesis.self_affine(
        (4000, 41), (2e-6, 3e-6), rms=1e-6, hurst=0.8, longest=60e-6, shortest=12e-6, seed=4
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
    # over 24 draws the line that differs most does so by 0.08 to 0.21
    np.testing.assert_allclose(found.spectrum[strong], density[strong], rtol=0.3)
    assert found.spectrum[strong].sum() == pytest.approx(density[strong].sum(), rel=0.05)


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


@pytest.mark.skipif(sys.platform == "win32", reason="processes are not forked there")
@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning")
def test_a_forked_process_reads_what_it_wrote_whatever_is_written_beside():
    made = Made()
    made.read(0)
    ours, theirs = multiprocessing.Pipe()

    def other():
        made.read(0, 1)
        theirs.send("written")
        theirs.recv()
        made.read(1, 0)

    process = multiprocessing.get_context("fork").Process(target=other)
    process.start()
    assert ours.poll(60)
    made.read(2)
    ours.send("written")
    process.join()
    assert process.exitcode == 0
    made.read(0, 2)
    assert made.numbers == [0, 2]


def test_random_numbers_that_are_kept_are_those_of_their_place_and_nobody_writes_to_them():
    """A larger first axis begins with the smaller one, also where it is too large to be kept."""
    many = tiles.deviates(7, (tiles.KEPT + 1,), 3, 0, 1)
    few = tiles.deviates(7, (40,), 3, 0, 1)
    assert np.array_equal(few, many[:40])
    assert np.array_equal(few, tiles.deviates(7, (40,), 3, 0, 1))
    for place in ((2, 0, 1), (3, 1, 1), (3, 0, 2)):
        assert not np.array_equal(few, tiles.deviates(7, (40,), *place))
    assert not np.array_equal(few, tiles.deviates(8, (40,), 3, 0, 1))
    with pytest.raises(ValueError, match="read-only"):
        few[0] = 0.0
