"""The contact filter against sin q/q, and against filters that are known beforehand."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from asperity.contact import HalfSpace, Hertz
from asperity.contact.scan import ScanJob, scan_forces
from asperity.errors import InputError
from asperity.reduction.filter import (
    FLOOR,
    closed_form,
    design_fir,
    estimate_filter,
    filter_spectra,
    punch_filter,
    tap_count,
)
from asperity.surfaces.strip import Rows
from asperity.surfaces.synthesis import self_affine

MODULUS, RADIUS, DELTA = 115e9, 25e-3, 1.2e-6
HERTZ = Hertz(MODULUS, RADIUS, RADIUS)
A = HERTZ.semi_axes(DELTA)[0]
TANGENT = HERTZ.tangent_stiffness(DELTA)


def decibels(ratio):
    return 20.0 * np.log10(ratio)


def scanned(line, dx, stride):
    """Force of the ball at constant approach along a line that is the same all across, and that line."""
    nx = 2 * int(1.25 * A / dx) + 1
    x = (np.arange(nx) - nx // 2) * dx
    body = (x[:, None] ** 2 + x[None, :] ** 2) / (2 * RADIUS)
    surface = Rows(np.repeat(line[:, None], nx, axis=1))
    job = ScanJob(HalfSpace((nx, nx), dx, MODULUS), surface, body, np.array([DELTA]), stride, 1e-9)
    forces = scan_forces(job).forces
    return forces, line[None, nx // 2 :][:, : forces.shape[1] * stride]


@pytest.mark.parametrize(("q", "tolerance"), [(1.0, 0.01), (2.0, 0.01), (3.0, 0.02), (4.0, 0.02)])
def test_ball_on_a_sinusoid(q, tolerance):
    """The whole chain: 3-D scan, spectra, tangent stiffness; sign included."""
    per_period = round(2 * np.pi / q * 16)
    dx, periods = 2 * np.pi * A / q / per_period, 6
    stride = max(1, per_period // 16)
    length = periods * per_period + 2 * int(1.25 * A / dx) + stride
    wave = 0.02 * DELTA * np.cos(2 * np.pi * np.arange(length) / per_period)
    forces, line = scanned(wave, dx, stride)
    count = periods * per_period // stride
    spectra = filter_spectra(forces[:, :count], line[:, : count * stride], dx)
    found = estimate_filter([spectra], [DELTA], [TANGENT])
    i = int(np.argmin(np.abs(found.wavenumber - q / (2 * np.pi * A))))
    assert found.signed[0, i] == pytest.approx(np.sin(q) / q, abs=tolerance)
    assert found.raw[0, i] == pytest.approx(abs(np.sin(q) / q), abs=tolerance)
    assert punch_filter(q / (2 * np.pi * A), A) == pytest.approx(np.sin(q) / q, rel=1e-12)


def test_texture_that_is_the_same_all_across_is_filtered_by_sin_q_over_q():
    """Ratio, fit and applied response, at the same time: none may differ from theory, nor from the others."""
    dx, stride, strips = A / 10, 2, []
    for seed in (1, 2):
        rows = 640 + 2 * int(1.25 * A / dx)
        texture = self_affine(
            (rows, 2), (dx, dx), rms=3e-4 * DELTA, hurst=0.8, longest=12 * A, shortest=4 * dx, seed=seed
        )
        forces, line = scanned(texture.heights[:, 0], dx, stride)
        strips.append(filter_spectra(forces, line, dx))
    found = estimate_filter(strips, [DELTA], [TANGENT])
    designed = design_fir(found, dx, least=tap_count(dx, A))
    q = 2 * np.pi * found.wavenumber * A
    theory = np.sin(q) / q
    knee, lobe = q < 2.1, (q > 2.1) & (q < 5.4) & (np.abs(q - np.pi) > 0.5)
    assert min(knee.sum(), lobe.sum()) >= 8
    responses = (found.raw, found.magnitude, designed.applied)
    for response, near, beyond in zip(responses, (0.25, 0.5, 0.5), (0.8, 1.1, 1.2), strict=True):
        off = decibels(response[0]) - decibels(np.abs(theory))
        assert np.abs(off[knee]).max() < near
        assert np.abs(off[lobe]).max() < beyond
        assert abs(off[knee | lobe].mean()) < 0.1
    assert_allclose(found.signed[0, q < 6], theory[q < 6], atol=0.05)
    assert designed.miss <= 0.3
    lowest = (q > 2.9) & (q < 3.4)
    assert designed.applied[0, lowest].min() < 10 ** (-20 / 20)  # the zero at π is there


def known(k):
    return np.exp(-((k * 8e-5) ** 2))


def synthetic(seed=0, m=4096, dx=1e-5, k0=5e6, lines=1):
    """Forces that follow the mean of independent random lines through a known filter."""
    z = np.random.default_rng(seed).standard_normal((lines, m)) * 1e-7
    h = known(np.fft.rfftfreq(m, dx))
    return k0 * np.fft.irfft(np.fft.rfft(z.mean(axis=0)) * h, m)[None] + 30.0, z, dx


def test_known_filter_is_found_under_both_normalisations():
    spectra = [filter_spectra(*synthetic())]
    tangent = estimate_filter(spectra, [0.0], [5e6])
    printed = estimate_filter(spectra, [0.0], [4e6], normalise="low-wavenumber", asymptote=1e3)
    band = (tangent.wavenumber > 1e3) & (tangent.wavenumber < 1.5e4)
    expected = known(tangent.wavenumber[band])
    for response in (tangent.raw, tangent.magnitude, tangent.signed, printed.raw, printed.magnitude):
        scale = 1.0 if response is not printed.signed else 1.25
        assert_allclose(response[0, band], scale * expected, rtol=0.05)
    assert_allclose(
        printed.signed[0, band], 1.25 * expected, rtol=0.05
    )  # over k_t whatever the normalisation
    assert printed.asymptotic_stiffness[0] == pytest.approx(5e6, rel=0.02)


def test_half_the_force_halves_only_the_tangent_normalisation():
    forces, lines, dx = synthetic()
    spectra = [filter_spectra(0.5 * forces, lines, dx)]
    tangent = estimate_filter(spectra, [0.0], [5e6])
    printed = estimate_filter(spectra, [0.0], [5e6], normalise="low-wavenumber", asymptote=1e3)
    i = int(np.argmin(np.abs(tangent.wavenumber - 5e3)))
    expected = known(tangent.wavenumber[i])
    assert tangent.magnitude[0, i] == pytest.approx(0.5 * expected, rel=0.05)
    assert printed.magnitude[0, i] == pytest.approx(expected, rel=0.05)


def test_lines_beside_each_other_average_away_in_the_magnitude_and_not_in_the_signed_estimate():
    """Of n independent lines the mean has 1/n of the power: |H| starts at 1/√n, the regression at one."""
    found = estimate_filter([filter_spectra(*synthetic(seed=s, lines=9)) for s in range(4)], [0.0], [5e6])
    low = (found.wavenumber > 300) & (found.wavenumber < 2e3)
    assert np.sqrt(np.mean(found.magnitude[0, low] ** 2)) == pytest.approx(1 / 3, rel=0.1)
    assert_allclose(found.signed[0, low], known(found.wavenumber[low]), atol=0.01)
    assert found.coherence[0, low].min() > 0.99


def test_each_state_is_compared_with_the_lines_under_its_own_patch():
    forces, lines, dx = synthetic(lines=5)
    middle = lines[1:4].mean(axis=0)
    follows = np.stack([forces[0], 5e6 * (middle - middle.mean()), 5e6 * lines[2]])
    found = estimate_filter([filter_spectra(follows, lines, dx, [2, 1, 0])], np.arange(3.0), [5e6] * 3)
    low = (found.wavenumber > 300) & (found.wavenumber < 2e3)
    assert found.coherence[:, low].min() > 0.99
    assert_allclose(found.signed[1:, low], 1.0, atol=0.01)
    wrong = estimate_filter([filter_spectra(follows, lines, dx)], np.arange(3.0), [5e6] * 3)
    assert wrong.coherence[2, low].mean() < 0.6


def test_incoherent_force_lowers_the_coherence_and_leaves_the_signed_estimate():
    """Samples whose force has noise of its own count by what they share with the texture."""
    strips = []
    for seed in range(12):
        forces, lines, dx = synthetic(seed=seed)
        noise = np.random.default_rng(100 + seed).standard_normal(forces.shape) * forces.std()
        strips.append(filter_spectra(forces + noise, lines, dx))
    found = estimate_filter(strips, [0.0], [5e6])
    band = (found.wavenumber > 1e3) & (found.wavenumber < 5e3)
    assert_allclose(found.signed[0, band], known(found.wavenumber[band]), atol=0.1)
    assert 0.5 < found.coherence[0, band].mean() < 0.99


def test_waves_too_short_for_the_scan_do_not_appear_as_longer_ones():
    """Forces at every fourth point, texture with most of its slopes in waves that these cannot tell apart."""
    rng = np.random.default_rng(5)
    m, stride, dx = 1024, 4, 1e-5
    spectrum = np.fft.rfft(rng.standard_normal(m * stride))
    k = np.fft.rfftfreq(m * stride, dx)
    line = np.fft.irfft(spectrum * np.where(k < 2e3, 1.0, 0.5), m * stride) * 1e-7
    follows = 5e6 * np.fft.irfft(np.fft.rfft(line) * known(4 * k), m * stride)
    forces = follows[::stride]
    fine = filter_spectra(forces[None], line[None], dx)
    coarse = filter_spectra(forces[None], line[None, ::stride], stride * dx)
    levels = []
    for spectra in (fine, coarse):
        found = estimate_filter([spectra], [0.0], [5e6])
        band = (found.wavenumber > 2e3) & (found.wavenumber < 6e3)
        levels.append(decibels(np.mean(found.raw[0, band] / known(4 * found.wavenumber[band]))))
    assert abs(levels[0]) < 0.3
    assert levels[1] < -3.0  # of the positions alone: the short waves count as texture, but exert no force


def test_what_the_texture_does_not_excite_is_left_out_and_the_filter_held():
    """Beyond a cut-off the force has only products of longer waves: their ratio to nothing is no filter."""
    m, dx, strips = 4096, 1e-5, []
    k = np.fft.rfftfreq(m, dx)
    for seed in range(4):
        spectrum = np.fft.rfft(np.random.default_rng(seed).standard_normal(m)) / np.maximum(k, 5e3) ** 1.3
        line = np.fft.irfft(np.where(k < 2e4, spectrum, 0.0), m)
        line *= 1e-7 / line.std()
        heard = np.fft.irfft(np.fft.rfft(line) * known(k), m)
        strips.append(filter_spectra((5e6 * (heard + 1e5 * heard**2))[None], line[None], dx))
    found = estimate_filter(strips, [0.0], [5e6])
    assert found.excited[found.wavenumber < 1.9e4].all()
    assert not found.excited[found.wavenumber > 2.2e4].any()
    assert np.isnan(found.raw[0, ~found.excited]).all()
    assert np.isfinite(found.raw[0, found.excited]).all()
    held = found.magnitude[0, found.excited][-1]
    assert_allclose(found.magnitude[0, ~found.excited], held, rtol=1e-9)


def test_corrugation_does_not_hide_what_lies_beyond_it():
    forces, lines, dx = synthetic()
    tone = 20 * lines.std() * np.cos(2 * np.pi * 2e3 * dx * np.arange(lines.shape[1]))
    found = estimate_filter([filter_spectra(forces + 5e6 * tone, lines + tone, dx)], [0.0], [5e6])
    assert found.excited[found.wavenumber > 4e3].all()


def test_share_of_long_waves_and_the_two_stiffnesses():
    """White lines: the share below a wavenumber is that of the bandwidth."""
    spectra = [filter_spectra(*synthetic(seed=s, lines=4)) for s in range(4)]
    found = estimate_filter(spectra, [0.0], [5e6], asymptote=1e4)
    assert found.long_wave_share[0] == pytest.approx(1e4 / found.wavenumber[-1], rel=0.1)
    assert found.tangent_stiffness[0] == 5e6
    below = found.wavenumber < 1e4
    expected = 5e6 * np.sqrt(0.25 * np.mean(known(np.linspace(0, 1e4, 100)) ** 2))
    assert below.any()
    assert found.asymptotic_stiffness[0] == pytest.approx(expected, rel=0.05)


def test_strips_and_their_spread():
    spectra = [filter_spectra(*synthetic(seed=s)) for s in range(4)]
    louder = [filter_spectra(1.2 * f, z, dx) for f, z, dx in (synthetic(seed=s) for s in range(4, 8))]
    found = estimate_filter([*spectra, *louder], [0.0], [6e6])
    low = (found.wavenumber > 300) & (found.wavenumber < 1e3)
    assert_allclose(found.spread[0, low], np.std([5 / 6] * 4 + [1.0] * 4, ddof=1), rtol=0.1)
    assert_allclose(found.magnitude[0, low], np.sqrt((25 / 36 + 1) / 2), rtol=0.05)
    assert not estimate_filter(spectra[:1], [0.0], [5e6]).spread.any()


@pytest.mark.parametrize("normalise", ["tangent", "low-wavenumber"])
def test_a_strip_that_is_never_touched_lets_nothing_pass(normalise):
    """On very rough surfaces the lowest states touch some strips nowhere: their force is zero throughout."""
    forces, z, dx = synthetic()
    touched, silent = filter_spectra(forces, z, dx), filter_spectra(0.0 * forces, z, dx)
    alone = estimate_filter([touched], [0.0], [5e6], normalise=normalise)
    both = estimate_filter([touched, silent], [0.0], [5e6], normalise=normalise)
    halved = np.maximum(alone.magnitude / np.sqrt(2.0), FLOOR)
    assert_allclose(both.magnitude, halved, rtol=1e-5)  # alone it is cut off at one
    assert np.isfinite(design_fir(both, dx).taps).all()
    assert (estimate_filter([silent], [0.0], [5e6], normalise=normalise).magnitude == FLOOR).all()


def test_polynomial_as_printed():
    spectra = [filter_spectra(*synthetic(seed=s)) for s in range(4)]
    found = estimate_filter(spectra, [0.0], [5e6], normalise="low-wavenumber", asymptote=1e3, degree=6)
    band = found.wavenumber < 2e4
    assert_allclose(found.magnitude[0, band], known(found.wavenumber[band]), atol=0.03)
    assert found.magnitude.max() <= 1.0
    assert found.magnitude.min() >= FLOOR
    assert found.spread[0, band].max() < 0.05


def test_closed_form_of_smooth_bodies():
    k = np.linspace(100.0, 5e3, 50)
    found = closed_form(np.array([DELTA]), k, np.array([A]), np.array([TANGENT]))
    q = 2 * np.pi * k * A
    assert_allclose(found.signed[0], np.sin(q) / q, rtol=1e-12)
    assert_allclose(found.magnitude[0], np.maximum(np.abs(np.sin(q) / q), FLOOR), rtol=1e-12)
    assert found.normalise == "tangent"


def test_bad_input():
    with pytest.raises(InputError, match="a whole number of heights a force, at least 16"):
        filter_spectra(np.ones((1, 20)), np.ones((1, 21)), 1.0)
    with pytest.raises(InputError, match="at least 16"):
        filter_spectra(np.ones((1, 10)), np.ones((1, 20)), 1.0)
    with pytest.raises(InputError, match="a flat surface"):
        filter_spectra(np.ones((1, 20)), np.ones((1, 20)), 1.0)
