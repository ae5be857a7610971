"""The linear reference in the frequency domain."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from asperity.errors import InputError
from asperity.scenarios.linear_force import (
    force_transfer,
    linear_force_psd,
    mean_square_transfer,
)
from asperity.scenes.track import linear_reference
from asperity.spectra import psd
from asperity.structures.track import Track
from asperity.structures.wheel import Wheel

WHEEL = Wheel(600.0, 65e3)
STIFFNESS = 1.25e9
F = np.geomspace(20.0, 4000.0, 50)
OMEGA = 2.0 * np.pi * F


@dataclass
class Spring:
    """A rail that is a spring, softer between the sleepers: compliance (1 − cos 2πx/L) c + c₀."""

    compliance: float = 0.0
    ripple: float = 0.0
    sleeper_spacing: float = 0.6

    def receptance(self, frequency, x, x0):
        at = self.compliance + self.ripple * (1.0 - np.cos(2 * np.pi * x / self.sleeper_spacing))
        return np.multiply.outer(at, np.ones(np.shape(frequency), dtype=complex))


def test_rigid_contact_and_rail_carry_the_wheel_along():
    # z = u_W: the force that shakes the mass, F = M d²z/dt², upwards as the height
    transfer = force_transfer(F, WHEEL, Spring(), np.inf, 0.0)
    assert_allclose(transfer[0], -600.0 * OMEGA**2, rtol=1e-12)


def test_soft_contact_gives_the_spring_force():
    transfer = force_transfer(F[F > 200.0], WHEEL, Track.named("nordborg"), 1e2, [0.0, 0.3])
    assert_allclose(transfer, 1e2, rtol=2e-6)


def test_soft_rail_decouples():
    assert_allclose(force_transfer(F, WHEEL, Spring(1e-3), STIFFNESS, 0.0), 1e3, rtol=2e-3)


def test_wheel_on_its_contact_spring_resonates():
    resonance = np.sqrt(STIFFNESS / 600.0)
    transfer = force_transfer(F, WHEEL, Spring(), STIFFNESS, 0.0)[0]
    assert_allclose(transfer, STIFFNESS / (1.0 - (resonance / OMEGA) ** 2), rtol=1e-9)


def test_impedances_of_a_real_track_add():
    track, x = Track.named("nordborg"), 0.17
    transfer = force_transfer(F, WHEEL, track, STIFFNESS, x)[0]
    # displacements under this force close the unit height: spring + rail down + wheel up
    closed = transfer / STIFFNESS + transfer * track.receptance(F, x, x) + transfer * WHEEL.receptance(F)
    assert_allclose(closed, 1.0, rtol=1e-12)


def test_mean_square_over_half_a_bay_is_that_of_the_bay():
    track, positions = Track.named("nordborg"), 6
    x = (np.arange(2 * positions) + 0.5) * 0.6 / (2 * positions)
    bay = np.mean(np.abs(force_transfer(F, WHEEL, track, STIFFNESS, x)) ** 2, axis=0)
    assert_allclose(mean_square_transfer(F, WHEEL, track, STIFFNESS, positions), bay, rtol=1e-8)


def test_mean_square_against_the_closed_form():
    # mean over the bay of 1/(a + c (1 − cos φ))² is (a + c)/(a (a + 2c))^1.5, a = 1/k without a wheel
    rail, heavy = Spring(0.0, 3e-10), Wheel(1e12, 65e3)
    a, c = 1.0 / STIFFNESS, 3e-10
    mean = mean_square_transfer(F, heavy, rail, STIFFNESS)
    assert_allclose(mean, (a + c) / (a * (a + 2 * c)) ** 1.5, rtol=1e-6)


def test_no_force_at_zero_frequency():
    transfer = mean_square_transfer([0.0, 100.0], WHEEL, Spring(1e-9), STIFFNESS)
    assert transfer[0] == 0.0
    assert transfer[1] > 0.0


def test_psd_of_a_known_texture():
    # a texture of white PSD W per cycle/m passes at v: W/v per Hz, times the squared force per height
    psd = linear_force_psd(F, np.full(F.shape, 1e-12), 50.0, Wheel(1e12, 65e3), Spring(), STIFFNESS)
    assert_allclose(psd, STIFFNESS**2 * 1e-12 / 50.0, rtol=1e-6)


def test_psd_holds_the_mean_square_of_the_moving_texture():
    # the mean square of a spring force over any speed is k² times that of the texture
    wavenumber = np.linspace(1.0, 100.0, 2001)
    texture = wavenumber**-2 * 1e-9
    for speed in (10.0, 56.0):
        f = wavenumber * speed
        psd = linear_force_psd(f, texture, speed, Wheel(1e12, 65e3), Spring(), STIFFNESS)
        assert np.trapezoid(psd, f) == pytest.approx(
            STIFFNESS**2 * np.trapezoid(texture, wavenumber), rel=1e-6
        )


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


def test_wheel_resonance_is_seen_in_the_force():
    flexible = Wheel(600.0, 65e3, [2000.0], [1e-4], [80.0])
    at = np.array([2000.0])
    rail = Spring(1e-10)
    resonant = np.abs(force_transfer(at, flexible, rail, STIFFNESS, 0.0)[0, 0])
    assert resonant == pytest.approx(2e-4 * 80.0 * (4000.0 * np.pi) ** 2, rel=1e-2)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: force_transfer([-1.0], WHEEL, Spring(), STIFFNESS, 0.0), "frequency"),
        (lambda: force_transfer(F, WHEEL, Spring(), 0.0, 0.0), "contact stiffness"),
        (lambda: mean_square_transfer(F, WHEEL, Spring(), STIFFNESS, 0), "positions in a bay"),
        (lambda: linear_force_psd(F, F, 0.0, WHEEL, Spring(), STIFFNESS), "speed"),
        (lambda: linear_force_psd(F, F[:-1], 50.0, WHEEL, Spring(), STIFFNESS), "texture_psd"),
    ],
)
def test_bad_input(call, message):
    with pytest.raises(InputError, match=message):
        call()
