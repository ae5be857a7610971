"""The contact filter against sin q/q and filters known beforehand, and the taps that lines run through."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.signal import freqz
from threadpoolctl import threadpool_limits

from asperity import HalfSpace, Hertz
from asperity.contact.scan import ScanJob, scan_forces
from asperity.reduction import filter
from asperity.reduction.filter import ACCURACY, FLOOR, design_fir, filter_spectra
from asperity.surfaces.strip import Rows
from asperity.surfaces.synthesis import self_affine
from refusals import refusals

MODULUS, RADIUS, DELTA = 115e9, 25e-3, 1.2e-6
HERTZ = Hertz(MODULUS, RADIUS, RADIUS)
A, TANGENT = HERTZ.semi_axes(DELTA)[0], HERTZ.tangent_stiffness(DELTA)
M, DX, K0 = 4096, 1e-5, 5e6
PRINTED = {"normalise": "low-wavenumber", "asymptote": 1e3}


def estimate(spectra, stiffness=K0, **options):
    spectra = spectra if isinstance(spectra, list) else [spectra]
    return filter.estimate_filter(spectra, np.arange(len(spectra[0].force)), stiffness, **options)


def scanned(line, dx, stride):
    """Force of the ball at constant approach along a line that is the same all across, and that line."""
    nx = 2 * int(1.25 * A / dx) + 1
    x = (np.arange(nx) - nx // 2) * dx
    body = (x[:, None] ** 2 + x[None, :] ** 2) / (2 * RADIUS)
    surface = Rows(np.repeat(line[:, None], nx, axis=1))
    job = ScanJob(HalfSpace((nx, nx), dx, MODULUS), surface, body, np.array([DELTA]), stride, 1e-9)
    forces = scan_forces(job).forces
    return forces, line[None, nx // 2 :][:, : forces.shape[1] * stride]


def decibels(ratio):
    return 20.0 * np.log10(ratio)


def test_texture_that_is_the_same_all_across_is_filtered_by_sin_q_over_q():
    """Ratio, fit and applied response, at the same time: none may differ from theory, nor from the others.

    Where the texture of a strip has little, the ratio scatters: that of twelve strips by 0.1 to 0.3 dB.
    """
    dx, stride, strips = A / 10, 2, []
    waves = {"rms": 3e-4 * DELTA, "hurst": 0.8, "longest": 12 * A, "shortest": 4 * dx}
    for seed in range(1, 13):
        texture = self_affine((640 + 2 * int(1.25 * A / dx), 2), (dx, dx), **waves, seed=seed)
        strips.append(filter_spectra(*scanned(texture.heights[:, 0], dx, stride), dx))
    found = estimate(strips, TANGENT)
    designed = design_fir(found, dx, least=filter.tap_count(dx, A))
    q = 2 * np.pi * found.wavenumber * A
    theory = np.sin(q) / q
    knee, lobe = q < 2.1, (q > 2.1) & (q < 5.4) & (np.abs(q - np.pi) > 0.5)
    assert min(knee.sum(), lobe.sum()) >= 8
    responses = (found.raw, found.magnitude, designed.applied)
    for response, near, beyond in zip(responses, (0.4, 0.3, 0.3), (0.5, 0.7, 0.7), strict=True):
        off = decibels(response[0]) - decibels(np.abs(theory))
        assert np.abs(off[knee]).max() < near
        assert np.abs(off[lobe]).max() < beyond
        assert abs(off[knee | lobe].mean()) < 0.1
    assert_allclose(found.signed[0, q < 6], theory[q < 6], atol=0.05)
    assert designed.miss <= 0.3
    assert designed.applied[0, (q > 2.9) & (q < 3.4)].min() < 0.1  # the zero at π is there


def known(k):
    return np.exp(-((k * 8e-5) ** 2))


def heard(line, response=known):
    """Force that follows a line through a filter, N."""
    k = np.fft.rfftfreq(line.shape[-1], DX)
    return K0 * np.fft.irfft(np.fft.rfft(line) * response(k), line.shape[-1])


def synthetic(seed=0, lines=1):
    """Forces that follow the mean of random lines through a known filter, the lines, and the spacing."""
    z = np.random.default_rng(seed).standard_normal((lines, M)) * 1e-7
    return (heard(z.mean(axis=0)) + 30.0)[None], z, DX


def test_a_known_filter_is_found_under_both_normalisations():
    """Half the force halves only that over k_t; what is signed is over k_t whatever the normalisation."""
    forces, lines, dx = synthetic()
    spectra = filter_spectra(0.5 * forces, lines, dx)
    tangent, printed = estimate(spectra), estimate(spectra, 4e6, **PRINTED)
    band = (tangent.wavenumber > 1e3) & (tangent.wavenumber < 1.5e4)
    expected = known(tangent.wavenumber[band])
    for found, factor in (
        (tangent.raw, 0.5), (tangent.magnitude, 0.5), (tangent.signed, 0.5), (printed.raw, 1.0),
        (printed.magnitude, 1.0), (printed.signed, 0.625),
    ):  # fmt: skip
        assert_allclose(found[0, band], factor * expected, rtol=0.05)
    assert printed.asymptotic_stiffness[0] == pytest.approx(0.5 * K0, rel=0.02)
    assert (tangent.tangent_stiffness[0], printed.tangent_stiffness[0]) == (K0, 4e6)
    by_polynomial = estimate([filter_spectra(*synthetic(s)) for s in range(4)], **PRINTED, degree=6)
    low = by_polynomial.wavenumber < 2e4
    assert_allclose(by_polynomial.magnitude[0, low], known(by_polynomial.wavenumber[low]), atol=0.03)
    assert by_polynomial.magnitude.max() <= 1.0
    assert by_polynomial.magnitude.min() >= FLOOR
    assert by_polynomial.spread[0, low].max() < 0.05


def test_lines_beside_each_other_average_away_in_the_magnitude_and_not_in_the_signed_estimate():
    """Of n independent lines the mean has 1/n of the power: |H| starts at 1/√n, the regression at one."""
    found = estimate([filter_spectra(*synthetic(s, lines=9)) for s in range(4)], asymptote=1e4)
    low = (found.wavenumber > 300) & (found.wavenumber < 2e3)
    assert np.sqrt(np.mean(found.magnitude[0, low] ** 2)) == pytest.approx(1 / 3, rel=0.1)
    assert_allclose(found.signed[0, low], known(found.wavenumber[low]), atol=0.01)
    assert found.coherence[0, low].min() > 0.99
    # white lines: the share below a wavenumber is that of the bandwidth
    assert found.long_wave_share[0] == pytest.approx(1e4 / found.wavenumber[-1], rel=0.1)
    expected = K0 / 3 * np.sqrt(np.mean(known(np.linspace(0, 1e4, 100)) ** 2))
    assert found.asymptotic_stiffness[0] == pytest.approx(expected, rel=0.05)


def test_each_state_is_compared_with_the_lines_under_its_own_patch():
    forces, lines, dx = synthetic(lines=5)
    follows = np.stack([forces[0], K0 * lines[1:4].mean(axis=0), K0 * lines[2]])
    found = estimate(filter_spectra(follows, lines, dx, [2, 1, 0]))
    low = (found.wavenumber > 300) & (found.wavenumber < 2e3)
    assert found.coherence[:, low].min() > 0.99
    assert_allclose(found.signed[1:, low], 1.0, atol=0.01)
    assert estimate(filter_spectra(follows, lines, dx)).coherence[2, low].mean() < 0.6


def test_waves_too_short_for_the_scan_do_not_appear_as_longer_ones():
    """Forces at every fourth point, texture with most of its slopes in waves that these cannot tell apart."""
    k, stride = np.fft.rfftfreq(M, DX), 4
    spectrum = np.fft.rfft(np.random.default_rng(5).standard_normal(M))
    line = np.fft.irfft(spectrum * np.where(k < 2e3, 1.0, 0.5), M) * 1e-7
    forces, levels = heard(line, lambda k: known(4 * k))[None, ::stride], []
    for every, spacing in ((1, DX), (stride, stride * DX)):
        found = estimate(filter_spectra(forces, line[None, ::every], spacing))
        band = (found.wavenumber > 2e3) & (found.wavenumber < 6e3)
        levels.append(decibels(np.mean(found.raw[0, band] / known(4 * found.wavenumber[band]))))
    assert abs(levels[0]) < 0.3
    assert levels[1] < -3.0  # of the positions alone: the short waves count as texture, but exert no force


def test_what_the_texture_does_not_excite_is_left_out_and_the_filter_held():
    """Beyond a cut-off the force has only products of longer waves: their ratio to nothing is no filter."""
    k, strips = np.fft.rfftfreq(M, DX), []
    for seed in range(4):
        spectrum = np.fft.rfft(np.random.default_rng(seed).standard_normal(M)) / np.maximum(k, 5e3) ** 1.3
        line = np.fft.irfft(np.where(k < 2e4, spectrum, 0.0), M)
        line *= 1e-7 / line.std()
        force = heard(line)
        strips.append(filter_spectra((force + 1e5 / K0 * force**2)[None], line[None], DX))
    found = estimate(strips)
    assert found.excited[found.wavenumber < 1.9e4].all()
    assert not found.excited[found.wavenumber > 2.2e4].any()
    assert np.array_equal(np.isnan(found.raw[0]), ~found.excited)
    held = found.magnitude[0, found.excited][-1]
    assert_allclose(found.magnitude[0, ~found.excited], held, rtol=1e-9)
    # a tone, as of corrugation, does not hide what lies beyond it
    forces, lines, dx = synthetic()
    tone = 20 * lines.std() * np.cos(2 * np.pi * 2e3 * dx * np.arange(M))
    found = estimate(filter_spectra(forces + K0 * tone, lines + tone, dx))
    assert found.excited[found.wavenumber > 4e3].all()


def test_strips_and_their_spread():
    """Half of them are louder by a fifth, over a stiffness that is theirs."""
    strips = [
        filter_spectra((1.0 if s < 4 else 1.2) * f, z, DX) for s in range(8) for f, z, _ in [synthetic(s)]
    ]
    found = estimate(strips, 6e6)
    low = (found.wavenumber > 300) & (found.wavenumber < 1e3)
    assert_allclose(found.spread[0, low], np.std([5 / 6] * 4 + [1.0] * 4, ddof=1), rtol=0.1)
    assert_allclose(found.magnitude[0, low], np.sqrt((25 / 36 + 1) / 2), rtol=0.05)
    assert not estimate(strips[:1]).spread.any()


@pytest.mark.parametrize("normalise", ["tangent", "low-wavenumber"])
def test_a_strip_that_is_never_touched_lets_nothing_pass(normalise):
    """On very rough surfaces the lowest states touch some strips nowhere: their force is zero throughout."""
    forces, z, dx = synthetic()
    touched, silent = filter_spectra(forces, z, dx), filter_spectra(0.0 * forces, z, dx)
    alone, both = (estimate(strips, normalise=normalise) for strips in ([touched], [touched, silent]))
    halved = np.maximum(alone.magnitude / np.sqrt(2.0), FLOOR)
    assert_allclose(both.magnitude, halved, rtol=1e-5)  # alone it is cut off at one
    assert np.isfinite(design_fir(both, dx, 40).taps).all()
    assert (estimate(silent, normalise=normalise).magnitude == FLOOR).all()


def test_closed_form_of_smooth_bodies():
    k = np.linspace(100.0, 5e3, 50)
    found = filter.closed_form(np.array([DELTA]), k, np.array([A]), np.array([TANGENT]))
    q = 2 * np.pi * k * A
    assert_allclose(found.signed[0], np.sin(q) / q, rtol=1e-12)
    assert_allclose(found.magnitude[0], np.maximum(np.abs(np.sin(q) / q), FLOOR), rtol=1e-12)
    assert found.normalise == "tangent"


test_bad_input = refusals(
    (10, 20, "at least 16"),
    (20, 20, "a flat surface"),
    of=lambda forces, heights: filter_spectra(np.ones((1, forces)), np.ones((1, heights)), 1.0),
)


AXES = np.array([1e-4, 1.5e-4])
K = np.geomspace(100.0, 3e4, 100)


def fitted(rows, normalise="tangent"):
    rows = np.clip(np.abs(rows), 1e-3, 1.0)
    zero, every = np.zeros_like(rows), np.ones(len(rows))
    return filter.ContactFilter(
        np.arange(len(rows)) * 1e-6, K, np.ones(K.size, bool), rows, rows, zero, rows, zero,
        every, every, every, normalise,
    )  # fmt: skip


def knee(k):
    """A filter of a fine texture: most of its fall within two octaves, then lobes."""
    q = 2 * np.pi * k * AXES[:, None]
    return 0.6 / np.sqrt(1 + (q / 2.2) ** 4) * (1 + 0.3 * np.cos(2 * q))


def magnitude_at(taps, k):
    return np.array([np.abs(freqz(b, worN=2 * np.pi * k * DX)[1]) for b in taps])


@pytest.mark.parametrize("normalise", ["tangent", "low-wavenumber"])
def test_chosen_order_meets_the_fit_within_0_3_dB_down_to_30_dB(normalise):
    scale = 1.0 if normalise == "tangent" else knee(np.array([1e-3]))
    found = design_fir(fitted(knee(K) / scale, normalise), DX, least=filter.tap_count(DX, AXES.max()))
    between = np.geomspace(100.0, 3e4, 1999)
    wanted = 20 * np.log10(np.abs(knee(between) / scale))
    got = 20 * np.log10(magnitude_at(found.taps, between))
    counted = wanted > -30.0
    assert (~counted).any()
    assert np.abs(got - wanted)[counted].max() < ACCURACY + 0.1  # the fit is known at some wavenumbers only
    assert found.miss <= ACCURACY
    assert_allclose(found.applied, magnitude_at(found.taps, K), rtol=1e-6, atol=1e-9)
    assert normalise == "tangent" or found.taps.sum(axis=1) == pytest.approx(1.0, rel=1e-12)


def test_order_grows_no_further_than_it_must_or_may():
    contact_filter = fitted(knee(K))
    order = design_fir(contact_filter, DX).taps.shape[1] - 1
    shorter = design_fir(contact_filter, DX, most=order // 2)
    assert shorter.taps.shape[1] - 1 == 2 * (order // 4)
    assert shorter.miss > ACCURACY
    assert design_fir(contact_filter, DX, least=2 * order).taps.shape[1] == 2 * order + 1


def test_taps_have_the_same_digits_on_any_number_of_threads():
    taps = []
    for threads in (1, 2):
        with threadpool_limits(limits=threads, user_api="blas"):
            taps.append(design_fir(fitted(knee(K)), DX, least=600, most=600).taps)
    np.testing.assert_array_equal(*taps)


def test_order_as_given_is_a_design_by_window():
    taps = design_fir(fitted(knee(K)), DX, 200).taps
    assert taps.shape == (2, 201)
    assert_allclose(taps, taps[:, ::-1], atol=1e-15)
    assert_allclose(magnitude_at(taps, K), knee(K), atol=0.05)
    assert design_fir(fitted(knee(K)), DX, 20).miss > 3.0
    printed = design_fir(fitted(knee(K) / 0.78, "low-wavenumber"), DX, 60).taps
    assert_allclose(printed.sum(axis=1), 1.0, rtol=1e-12)


@pytest.mark.parametrize("order", [None, 400])
def test_output_has_the_designed_amplitude_and_no_delay(order):
    found = design_fir(fitted(knee(K)), DX, order)
    x, states = np.arange(6000) * DX, found.contact_filter.approaches
    wave = np.cos(2 * np.pi * K[40] * x)
    texture = filter.filtered_texture(wave, DX, found.taps, states)
    inner = slice(found.taps.shape[1], -found.taps.shape[1])
    expected = -knee(K[40:41]) * wave  # h = −z
    assert_allclose(texture.heights[:, inner], expected[:, inner], atol=0.02)


def test_response_is_real_and_signed():
    taps, k = filter.punch_taps(AXES, DX), np.linspace(0.0, 6e3, 200)
    assert_allclose(taps.sum(axis=1), 1.0, rtol=1e-12)
    assert_allclose(filter.response(taps, DX, k), filter.punch_filter(k, AXES[:, None]), atol=0.004)
    assert filter.response(taps, DX, k).min() < -0.2
    assert [filter.tap_count(1e-5, a) for a in (1e-4, 1.01e-4)] == [40, 42]


def test_miss_counts_where_the_fit_is_above_30_dB():
    contact_filter = fitted(10 ** (-np.minimum(K / 1e3, 60.0) / 20) * np.ones((1, K.size)))
    assert filter.LineFilter(contact_filter, np.ones((1, 1)), DX).miss == pytest.approx(30.0, abs=0.5)
