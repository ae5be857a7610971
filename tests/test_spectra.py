import tracemalloc

import numpy as np
import pytest
import scipy.signal
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.fft import next_fast_len

from asperity import spectra
from refusals import refusals


def test_nominal_names_are_those_of_the_standard():
    """IEC 61260-1:2014, annex E: 3162.28 Hz is called 3.15 kHz."""
    found = [spectra.nominal_frequency(1000 * 10 ** (n / 10)) for n in (-16, -15, 0, 1, 5, 7)]
    assert ", ".join(found) == "25 Hz, 31.5 Hz, 1 kHz, 1.25 kHz, 3.15 kHz, 5 kHz"
    found = [spectra.nominal_length(10 ** (n / 10)) for n in (4, 0, -2, -15, -29, -31)]
    assert ", ".join(found) == "2.5 m, 1 m, 630 mm, 31.5 mm, 1.25 mm, 800 µm"


def test_bands_follow_one_another():
    centres, low, high = spectra.third_octave_bands(100.0, 5000.0)
    assert centres.size == 18
    assert_allclose(high[:-1], low[1:], rtol=1e-14)


@settings(max_examples=50)
@given(st.lists(st.floats(1.0, 499.0), min_size=1, max_size=6), st.integers(0, 2**31))
def test_neighbouring_bands_add_up_to_their_union(cuts, seed):
    frequency = np.arange(501.0)
    density = np.random.default_rng(seed).random(501)
    edges = np.concatenate([[0.5], np.sort(cuts), [499.5]])
    parts = spectra.band_energies(frequency, density, edges[:-1], edges[1:])
    assert_allclose(parts.sum(), density[1:500].sum(), rtol=1e-12)


def test_a_line_on_an_edge_is_shared_in_proportion():
    energies = spectra.band_energies([0.0, 1.0, 2.0], [0.0, 8.0, 0.0], [0.0, 0.75], [0.75, 2.0])
    assert_allclose(energies, [2.0, 6.0])


def test_bands_are_those_that_the_lines_cover():
    frequency = np.arange(0.0, 501.0)
    centres, levels = spectra.band_levels(frequency, np.full(501, 4e-12), reference=2e-6)
    assert_allclose(centres[[0, -1]], [5.01187, 398.107], rtol=1e-5)
    assert_allclose(levels, 10 * np.log10(centres * (10**0.05 - 10**-0.05)), atol=1e-9)
    chosen, _ = spectra.band_levels(frequency, np.ones(501), low=100.0, high=200.0)
    assert_allclose(chosen, [100.0, 125.8925, 158.4893, 199.5262], rtol=1e-6)
    assert np.isneginf(spectra.band_levels(frequency, np.zeros((2, 501)))[1]).all()


NOMINAL = [31.5, 40, 50, 63, 80, 100, 125, 160, 200, 250, 315, 400, 500, 630, 800, 1000, 1250, 1600]
"""Hz, of the bands with the numbers 15 to 32 of IEC 61260-1."""


def test_bands_are_found_by_nominal_and_by_exact_centres_in_any_order():
    numbers = np.arange(15, 15 + len(NOMINAL))
    assert spectra.third_octave_numbers(NOMINAL).tolist() == numbers.tolist()
    wavelengths = [0.4, 0.315, 0.0125, 0.00315]  # m
    assert spectra.third_octave_numbers(wavelengths).tolist() == [-4, -5, -19, -25]
    levels = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])
    found = spectra.in_bands(10.0 ** (0.1 * numbers[:6]), [63.0, 31.5, 80.0], levels)
    assert_allclose(found[0], [2.0, np.nan, np.nan, 1.0, 3.0, np.nan])
    assert_allclose(found[1], [5.0, np.nan, np.nan, 4.0, 6.0, np.nan])


def test_energy_sum():
    assert_allclose(spectra.energy_sum([60.0, 60.0]), 63.0103, atol=1e-4)
    assert_allclose(spectra.energy_sum([[0.0, -np.inf], [10.0, 10.0]], axis=0), [10.41393, 10.0], atol=1e-5)
    assert_allclose(spectra.energy_of([0.0, 10.0, -np.inf]), [1.0, 10.0, 0.0])
    assert_allclose(spectra.energy_mean([[10.0, 0.0], [10.0, -np.inf]], axis=0), [10.0, -3.0103], atol=1e-4)
    assert np.isneginf(spectra.a_weighting(0.0))


@pytest.mark.parametrize(("segment", "share"), [(4000, 18 / 35), (2000, None), (500, None)])
def test_averaging_time_is_that_of_the_scatter_of_a_band(segment, share):
    """The variance of a band's mean square is 1/(B T): Bendat and Piersol, Random Data (2010).

    One Hann window over the whole record leaves (3/8)²/(35/128) = 18/35 of it.
    """
    samples, step = 4000, 1e-3
    time = spectra.averaging_time(samples, step, segment=segment)
    if share is not None:
        assert_allclose(time, share * samples * step, rtol=1e-6)
    assert 0.5 * samples * step < time < samples * step
    noise = np.random.default_rng(5).standard_normal((2000, samples))
    frequency, density = spectra.psd(noise, step, segment=segment)
    square = spectra.band_energies(frequency, density, [100.0], [300.0])[:, 0]
    assert_allclose(square.std() / square.mean(), 1 / np.sqrt(200.0 * time), rtol=0.05)


def test_product_of_band_and_time_says_how_far_a_level_scatters():
    samples, step, segment = 2000, 1e-3, 500
    noise = np.random.default_rng(6).standard_normal((2000, samples))
    band, level = spectra.band_levels(*spectra.psd(noise, step, segment=segment), low=100.0, high=400.0)
    product = spectra.band_product(band, spectra.averaging_time(samples, step, segment=segment))
    assert_allclose(product[band.searchsorted(99.0)], 23.08 * 2.0 * 0.8384, rtol=1e-3)
    assert_allclose(level.std(axis=0), 4.34 / np.sqrt(product), rtol=0.06)


@pytest.mark.parametrize("length", [64, 65, 1000])
def test_psd_agrees_with_scipy(length):
    signals = np.random.default_rng(2).normal(size=(2, 1000)) + 3.0
    expected = scipy.signal.welch(
        signals - signals.mean(axis=1, keepdims=True),
        fs=50.0,
        nperseg=length,
        noverlap=length // 2,
        detrend=False,
    )
    found = spectra.psd(signals, 0.02, segment=length)
    np.testing.assert_allclose(found[0], expected[0], rtol=1e-12)
    np.testing.assert_allclose(found[1], expected[1], rtol=1e-10, atol=1e-18)


LINES = np.arange(100.0)


test_what_is_wrong_is_said = refusals(
    (lambda: spectra.psd([1.0], 1.0), "signal: received shape"),
    (lambda: spectra.psd([1.0, np.nan, 2.0], 1.0), "NaN or infinite"),
    (lambda: spectra.psd([1.0, 2.0], -1.0), "spacing: received -1.0"),
    (lambda: spectra.psd([1.0, 2.0], 1.0, segment=3), "segment: received 3"),
    (lambda: spectra.third_octave_bands(0.0, 1.0), "band limits"),
    (lambda: spectra.third_octave_bands(2.0, 1.0), "band limits"),
    (lambda: spectra.band_levels([0.0, 1.0, 3.0], [1.0, 1.0, 1.0]), "unequal steps"),
    (lambda: spectra.band_levels([0.0, 1.0], [1.0, 1.0, 1.0]), "frequency and psd"),
    (lambda: spectra.band_levels([0.0, 1.0], [1.0, 1.0]), "enough lines"),
    (lambda: spectra.band_levels(LINES, LINES, reference=0.0), "reference"),
    (lambda: spectra.a_weighting([-1.0]), "0 Hz or more"),
)


def test_a_record_beyond_memory_is_a_mean_of_segments_that_fill_it(monkeypatch):
    """Of at most a million samples each; its variance stays, and a shorter one is taken as it is."""
    for samples in (2**20 - 3, 2**20):
        assert spectra.longest_segment(samples) == samples
    for samples in (2**20 + 1, 1_299_709, 8_000_000, 33_554_432):
        length = spectra.longest_segment(samples)
        assert 2**19 <= length <= 2**20
        assert next_fast_len(length) < 1.01 * length
        advance = length - length // 2
        unused = (samples - length) % advance
        assert unused < 0.02 * samples
    monkeypatch.setattr(spectra, "LONGEST_SEGMENT", 2**10)
    monkeypatch.setattr(spectra, "ROUND", 2**4)
    noise = np.random.default_rng(3).standard_normal(8_000)
    frequency, density = spectra.psd(noise, 0.1)
    assert len(frequency) <= 2**9 + 1
    assert density.sum() * frequency[1] == pytest.approx(noise.var(), rel=0.03)


def test_a_long_segment_takes_few_times_the_memory_of_its_samples():
    """Of what is transformed, windows and densities: beside it lies what it becomes, nothing else."""
    signal = np.random.default_rng(0).normal(size=2**18)
    spectra.psd(signal, 1.0)  # imports
    tracemalloc.start()
    try:
        spectra.psd(signal, 1.0)
        assert tracemalloc.get_traced_memory()[1] < 2.8 * signal.nbytes
    finally:
        tracemalloc.stop()


def test_a_centred_window_is_even_about_the_middle_of_a_record():
    expected = np.sin(np.pi * np.array([1, 3, 5, 7]) / 8.0) ** 2
    assert_allclose(spectra.hann_window(4, centred=True), expected)
    assert_allclose(spectra.hann_window(4), [0.0, 0.5, 1.0, 0.5], atol=1e-15)
