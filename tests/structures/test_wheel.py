"""The wheel: modes, poles, impulse response, and modes found again in a receptance."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.linalg import expm

from asperity.errors import InputError, UnconvergedWarning
from asperity.structures.wheel import Wheel

pytestmark = pytest.mark.filterwarnings("ignore:.* modes are narrower")  # of tables without noise

MASS, LOAD = 600.0, 65e3
FREQUENCIES = np.array([330.0, 1100.0, 1950.0, 2850.0, 3700.0, 4600.0])
RATIOS = np.array([5e-3, 1e-3, 2e-4, 1e-4, 1e-4, 1.5e-4])
MASSES = np.array([900.0, 250.0, 120.0, 80.0, 60.0, 50.0])


def modal_wheel():
    return Wheel.from_modes(MASS, LOAD, FREQUENCIES, RATIOS, MASSES)


def modal_masses(wheel):
    return (1.0 / (2j * wheel.residues * wheel.poles.imag)).real


class TwoMasses:
    """A tread of mass m1 on a hub of mass m2, spring and damper between; matrices of motion."""

    m1, m2, stiffness, damping = 150.0, 450.0, 4e9, 2e4
    coupling = np.array([[1.0, -1.0], [-1.0, 1.0]])
    mass = np.diag([m1, m2])

    def receptance(self, frequency):
        omega = 2.0 * np.pi * frequency
        return np.array(
            [
                np.linalg.inv(self.coupling * (self.stiffness + 1j * w * self.damping) - w**2 * self.mass)[
                    0, 0
                ]
                for w in omega
            ]
        )

    def impulse_response(self, time):
        inverse = np.linalg.inv(self.mass)
        upper = np.hstack([np.zeros((2, 2)), np.eye(2)])
        lower = np.hstack(
            [-inverse @ self.coupling * self.stiffness, -inverse @ self.coupling * self.damping]
        )
        state = np.vstack([upper, lower])
        start = np.array([0.0, 0.0, 1.0 / self.m1, 0.0])
        return np.array([(expm(state * t) @ start)[0] for t in time])

    def wheel(self):
        total = self.m1 + self.m2
        reduced = self.m1 * self.m2 / total
        omega = np.sqrt(self.stiffness / reduced)
        ratio = self.damping / (2.0 * reduced * omega)
        return Wheel.from_modes(total, LOAD, [omega / (2 * np.pi)], [ratio], [self.m1 * total / self.m2])


def impulse_response(wheel, time):
    """What poles and residues say of the displacement after a unit impulse: t/M + 2 Re Σ r e^{st}."""
    t = np.maximum(np.asarray(time, dtype=float), 0.0)
    return t / wheel.mass + 2.0 * (wheel.residues * np.exp(wheel.poles * t[..., None])).real.sum(axis=-1)


def test_receptance_is_the_sum_of_the_modes():
    f = np.geomspace(1.0, 20e3, 400)
    omega, natural = 2 * np.pi * f, 2 * np.pi * FREQUENCIES[:, None]
    dynamic = MASSES[:, None] * (natural**2 - omega**2 + 2j * RATIOS[:, None] * natural * omega)
    assert_allclose(modal_wheel().receptance(f), (1 / dynamic).sum(axis=0) - 1 / (MASS * omega**2), rtol=1e-9)


def test_rigid_wheel_is_a_mass():
    wheel = Wheel.rigid(MASS, LOAD)
    assert_allclose(wheel.receptance(1000.0), -1.0 / (MASS * (2000.0 * np.pi) ** 2))
    assert_allclose(impulse_response(wheel, [-1.0, 0.0, 0.5]), [0.0, 0.0, 0.5 / MASS])
    assert wheel.natural_frequencies.size == 0


def test_two_masses_in_frequency_and_time():
    system = TwoMasses()
    wheel = system.wheel()
    f = np.geomspace(10.0, 5e3, 60)
    assert_allclose(wheel.receptance(f), system.receptance(f), rtol=1e-9)
    time = np.linspace(0.0, 0.02, 80)
    exact = system.impulse_response(time)
    assert_allclose(impulse_response(wheel, time), exact, atol=1e-10 * exact.max())


def test_impulse_response_is_that_of_each_mode():
    wheel, t = modal_wheel(), np.linspace(0.0, 0.05, 500)
    omega = 2 * np.pi * FREQUENCIES
    damped = omega * np.sqrt(1 - RATIOS**2)
    decay = np.exp(-np.outer(t, RATIOS * omega))
    exact = t / MASS + (decay * np.sin(np.outer(t, damped)) / (MASSES * damped)).sum(axis=1)
    assert_allclose(impulse_response(wheel, t), exact, atol=1e-12 * exact.max())


def test_frequencies_and_damping_come_back_from_the_poles():
    wheel = modal_wheel()
    assert_allclose(wheel.natural_frequencies, FREQUENCIES, rtol=1e-12)
    assert_allclose(wheel.damping_ratios, RATIOS, rtol=1e-9)


def test_fit_gives_back_the_modes():
    f = np.arange(20.0, 5001.0, 2.0)
    wheel = Wheel.from_receptance(MASS, LOAD, f, modal_wheel().receptance(f))
    assert wheel.fit_error < 1e-3
    assert_allclose(wheel.natural_frequencies, FREQUENCIES, rtol=1e-6)
    assert_allclose(wheel.damping_ratios, RATIOS, rtol=1e-3)
    assert_allclose(modal_masses(wheel), MASSES, rtol=1e-3)


def test_fit_of_two_masses_gives_back_the_impulse_response():
    system, f, time = TwoMasses(), np.arange(20.0, 3001.0, 5.0), np.linspace(0.0, 0.02, 80)
    wheel = Wheel.from_receptance(system.m1 + system.m2, LOAD, f, system.receptance(f))
    exact = system.impulse_response(time)
    assert_allclose(impulse_response(wheel, time), exact, atol=1e-4 * exact.max())


def test_fit_up_to_a_frequency_keeps_what_lies_below():
    f = np.arange(20.0, 5001.0, 2.0)
    given_receptance = modal_wheel().receptance(f)
    noisy = given_receptance * np.where(f > 2400.0, 10.0, 1.0)  # nonsense above
    wheel = Wheel.from_receptance(MASS, LOAD, f, noisy, highest_frequency=2400.0)
    below = f <= 2400.0
    level = 20 * np.log10(np.abs(wheel.receptance(f[below]) / given_receptance[below]))
    assert np.abs(level).max() < 0.1
    assert_allclose(wheel.natural_frequencies[:3], FREQUENCIES[:3], rtol=1e-4)


def test_fit_of_a_noisy_receptance_finds_the_modes_and_takes_energy():
    f, rng = np.arange(20.0, 5001.0, 2.0), np.random.default_rng(1)
    noise = 0.02 * (rng.standard_normal(f.size) + 1j * rng.standard_normal(f.size))
    wheel = Wheel.from_receptance(MASS, LOAD, f, modal_wheel().receptance(f) * (1.0 + noise))
    # 2 % of noise in amplitude is 0.17 dB; the fit cannot be nearer, and must not be much farther
    assert 0.15 < wheel.fit_error < 0.2
    for natural in FREQUENCIES:
        assert np.abs(wheel.natural_frequencies / natural - 1.0).min() < 1e-4
    assert (wheel.receptance(np.geomspace(1.0, 50e3, 5000)).imag <= 0.0).all()


def test_fit_of_a_rigid_wheel_has_no_modes():
    f = np.arange(20.0, 1000.0)
    wheel = Wheel.from_receptance(MASS, LOAD, f, Wheel.rigid(MASS, LOAD).receptance(f))
    assert wheel.poles.size == 0
    assert wheel.fit_error < 1e-9


@settings(max_examples=20)
@given(
    st.lists(
        st.tuples(st.floats(100.0, 6e3), st.floats(1e-4, 0.5), st.floats(10.0, 1e4)), min_size=1, max_size=6
    )
)
def test_any_modal_wheel_takes_energy_and_starts_at_rest(modes):
    wheel = Wheel.from_modes(MASS, LOAD, *zip(*modes, strict=True))
    omega = 2.0 * np.pi * np.geomspace(1.0, 20e3, 200)
    alpha = wheel.receptance(omega / (2.0 * np.pi))
    assert (alpha.imag <= 1e-12 * np.abs(alpha)).all()
    assert impulse_response(wheel, 0.0) == pytest.approx(0.0, abs=1e-15)
    # the first instant moves 1/M and every modal mass freely
    short = 1e-9
    assert impulse_response(wheel, short) / short == pytest.approx(
        1 / MASS + sum(1 / m for *_, m in modes), rel=1e-3
    )


def test_doubtful_fit_is_warned_of():
    f = np.arange(20.0, 5001.0, 2.0)
    with pytest.warns(UnconvergedWarning, match=r"dB only, more than 1 dB.*Give a finer or smoother"):
        wheel = Wheel.from_receptance(0.5 * MASS, LOAD, f, modal_wheel().receptance(f))
    assert 1.0 < wheel.fit_error < 6.0


@pytest.mark.parametrize("factor", [1e3, 1e-3])
def test_a_receptance_in_another_unit_is_refused(factor):
    f = np.arange(20.0, 3001.0, 2.0)
    with pytest.raises(InputError, match=r"dB only.*Check the mass, the unit m/N"):
        Wheel.from_receptance(MASS, LOAD, f, factor * modal_wheel().receptance(f))


def test_the_other_time_factor_is_refused():
    f = np.arange(20.0, 3001.0, 2.0)
    with pytest.raises(InputError, match=r"mostly positive.*Conjugate"):
        Wheel.from_receptance(MASS, LOAD, f, modal_wheel().receptance(f).conj())


F20 = np.arange(20.0, 40.0)


@pytest.mark.parametrize(
    ("frequency", "receptance", "message"),
    [
        (F20, np.ones(19), "one value per frequency"),
        (F20[::-1], -np.ones(20), "frequencies in disorder"),
        (F20 - 20.0, -np.ones(20), "frequencies in disorder"),
        (F20, np.full(20, np.nan), "not finite"),
        (F20, np.zeros(20), "a value of zero"),
        (F20[:5], -np.ones(5), "ten points or more"),
    ],
)
def test_bad_receptance(frequency, receptance, message):
    with pytest.raises(InputError, match=message):
        Wheel.from_receptance(MASS, LOAD, frequency, receptance)


@pytest.mark.parametrize(
    ("modes", "message"),
    [
        (([100.0, 200.0], [0.01], [10.0, 10.0]), "2 frequencies, 1 damping ratios"),
        (([-100.0], [0.01], [10.0]), "natural frequencies of the wheel"),
        (([100.0], [0.0], [10.0]), "damping ratios of the wheel"),
        (([100.0], [1.0], [10.0]), "damping ratios of the wheel"),
        (([100.0], [0.01], [np.inf]), "modal masses of the wheel"),
    ],
)
def test_bad_modes(modes, message):
    with pytest.raises(InputError, match=message):
        Wheel.from_modes(MASS, LOAD, *modes)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((0.0, LOAD), "wheel mass"),
        ((MASS, np.inf), "wheel load"),
        ((MASS, LOAD, np.array([-1 + 5j]), np.array([])), "two lists of the same length"),
        ((MASS, LOAD, np.array([-1 + 5j]), np.array([np.nan])), "finite values"),
        ((MASS, LOAD, np.array([1 + 5j]), np.array([1.0])), "damped modes only"),
        ((MASS, LOAD, np.array([-5.0 + 0j]), np.array([1.0])), "damped modes only"),
    ],
)
def test_bad_wheel(arguments, message):
    with pytest.raises(InputError, match=message):
        Wheel(*arguments)


def test_no_static_receptance():
    with pytest.raises(InputError, match="no static receptance"):
        Wheel.rigid(MASS, LOAD).receptance([0.0, 1.0])
