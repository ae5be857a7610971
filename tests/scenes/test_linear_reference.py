"""The linear reference in the frequency domain, and the error that loss factors bring into it in time."""

import re
import warnings
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from asperity import Track, Wheel
from asperity.errors import LossFactorWarning, warn_of_findings
from asperity.scenarios.scene import force_transfer, mean_square_transfer
from asperity.scenes.track import _coupled, findings_of_losses, linear_reference, loss_factor_error
from asperity.spectra import nominal_frequency, psd
from asperity.structures.moving_kernel import moving_kernel

WHEEL, HEAVY = Wheel(600.0, 65e3).receptance, Wheel(1e12, 65e3).receptance
STIFFNESS = 1.25e9
F = np.geomspace(20.0, 4000.0, 50)


@dataclass
class Spring:
    """A rail that is a spring, softer between the sleepers: compliance (1 − cos 2πx/L) c + c₀."""

    compliance: float = 0.0
    ripple: float = 0.0
    sleeper_spacing: float = 0.6

    def receptance(self, frequency, x, x0):
        at = self.compliance + self.ripple * (1.0 - np.cos(2 * np.pi * x / self.sleeper_spacing))
        return np.multiply.outer(at, np.ones(np.shape(frequency), dtype=complex))

    def places(self, count):
        return (np.arange(count) + 0.5) * 0.5 * self.sleeper_spacing / count


def test_mean_square_over_half_a_bay_is_that_of_the_bay():
    track, positions = Track.named("nordborg"), 6
    x = (np.arange(2 * positions) + 0.5) * 0.6 / (2 * positions)
    bay = np.mean(np.abs(force_transfer(F, WHEEL, track, STIFFNESS, x)) ** 2, axis=0)
    assert_allclose(mean_square_transfer(F, WHEEL, track, STIFFNESS, track.places(positions)), bay, rtol=1e-8)


def test_mean_square_against_the_closed_form():
    assert force_transfer([0.0], WHEEL, Spring(), STIFFNESS, 0.0)[0] == 0.0
    # mean over the bay of 1/(a + c (1 − cos φ))² is (a + c)/(a (a + 2c))^1.5, a = 1/k without a wheel
    a, c = 1.0 / STIFFNESS, 3e-10
    mean = mean_square_transfer(F, HEAVY, Spring(0.0, c), STIFFNESS, Spring().places(12))
    assert_allclose(mean, (a + c) / (a * (a + 2 * c)) ** 1.5, rtol=1e-6)


def test_between_cells_the_reference_passes_the_texture_that_the_laws_follow():
    """Waves of six cells, in steps of three quarters of a cell: 5 kHz at 30 m/s."""
    cells = 1e-3 * np.arange(3000)
    line = 1e-6 * np.sin(2 * np.pi * cells / 6e-3)
    step, at = 25e-6, 0.1 + 0.75e-3 * np.arange(3000)
    case = SimpleNamespace(speed=30.0, contact=SimpleNamespace(spacing=1e-3))
    computed = SimpleNamespace(
        case=case, textures=SimpleNamespace(start=0.0, line=line, followed=line), track=Spring(),
        scene=SimpleNamespace(first=WHEEL, offsets=(0.0,)), first=SimpleNamespace(positions=[at]),
        stiffness=STIFFNESS, frequency=np.fft.rfftfreq(1024, step),
        psd=lambda line: psd(line, step, segment=1024)[1],
    )  # fmt: skip
    _, texture = linear_reference(computed)
    assert 10 * np.log10(texture.sum() * computed.frequency[1] / 0.5e-12) == pytest.approx(0.0, abs=0.1)


# --- loss factors in time

STEP = 50e-6
LOSSY = Track.named("nordborg-loss-factor", ballast_loss_factor=2.0)


def lost(track):
    return loss_factor_error(track, WHEEL, STIFFNESS, 5000.0)


@pytest.fixture(scope="module")
def error():
    return lost(LOSSY)


def test_loss_factors_err_as_the_kernel_does(error):
    """Force of a wheel on the transform of the kernel at rest, against the receptance of the track."""
    bands, force = error.values()
    assert len(bands) == len(force) == 31
    assert [nominal_frequency(bands[i]) for i in (0, -1)] == ["5 Hz", "5 kHz"]
    places, kernel = 0.6 / 12 * np.arange(12), moving_kernel(LOSSY, 0.0, STEP, positions=12)
    lag = STEP * np.arange(kernel.weights.shape[1])
    for band in (8, 11, 12, 16, 17):  # from 31.5 Hz to 250 Hz
        frequency = bands[band] * 10.0 ** np.linspace(-0.049, 0.049, 40)
        transform = kernel.weights @ np.exp(-2j * np.pi * lag[:, None] * frequency)
        rail = transform / np.sinc(frequency * STEP) ** 2
        nominal = np.array([LOSSY.receptance(frequency, x, x) for x in places])
        carried = WHEEL(frequency) + 1.0 / STIFFNESS
        levels = [10 * np.log10(np.mean(np.abs(1 / (carried + each)) ** 2)) for each in (rail, nominal)]
        assert levels[0] - levels[1] == pytest.approx(force[band], abs=0.03)


def test_a_large_error_is_warned_of_with_a_remedy_and_a_small_one_is_not(error):
    with pytest.warns(LossFactorWarning) as caught:
        warn_of_findings(findings_of_losses(error))
    text = str(caught[0].message)
    assert "constant loss factors, at most: −1.0 dB (630 Hz), in range up to 0.75 dB" in text
    assert re.search("read the one-third octaves of 250 Hz, .*630 Hz with their error", text)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warn_of_findings(findings_of_losses(lost(Track.named("nordborg-loss-factor"))))


def test_contacts_that_feel_each_other_add_what_all_pass_with_its_delay_and_their_own_by_power():
    """Of two wheels 2 m apart, each with T of its own and C of the other's: |T + C e^{iωd/v}|², T² + C²."""
    own, other, ahead, speed = 3.0, 1.0 - 2.0j, 2.0, 40.0
    lines = np.array([5.0, 12.0])
    transfer = np.array([[own, other], [other, own]])[..., None] * np.ones(2)
    scene = SimpleNamespace(offsets=(1.0, 1.0 + ahead), coupled_transfer=lambda *_: transfer)
    along, each = _coupled(scene, 1e9, speed, np.array([0.1, 0.3, 0.5]), lines)
    turn = np.exp(2j * np.pi * lines * ahead / speed)
    expected = 0.5 * (np.abs(own + other * turn) ** 2 + np.abs(other + own * turn) ** 2)
    assert along == pytest.approx(expected, rel=1e-12)
    assert each == pytest.approx(np.full(2, own**2 + abs(other) ** 2), rel=1e-12)
