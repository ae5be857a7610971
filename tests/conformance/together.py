"""Checks of several contacts at once."""

import mpmath as mp
import numpy as np
from ledger import Check
from scipy.integrate import solve_ivp

from asperity import Beam, material
from asperity.laws import HertzLaw, Linear
from asperity.reduction.texture import StateTexture
from asperity.rolling.roll import roll_bodies
from asperity.structures.body import Body

EMPTY = np.zeros(0)


def two_moving_forces():
    """Each mode of a simply supported beam under two constant forces, in closed form.

    It starts with the static displacement that moves on with the forces.
    """
    load, speed, places, end = 50.0, 8.0, (0.1, 0.33), 0.05
    beam = Beam.rectangular(1.0, 0.05, 0.01, material("steel"), highest_frequency=2e3, loss_factor=0.0)
    run = roll_bodies(
        beam, [Body.rigid(1e3, load)] * 2, [Linear(load, 1e-3)] * 2, speed=speed, start=0.1, duration=end,
        time_step=1e-5, positions=[0.0, 0.23],
    )  # fmt: skip
    scale, t = mp.sqrt(2 / mp.mpf(beam.mass)), mp.mpf(len(run.time) - 1) * mp.mpf("1e-5")
    found = [mp.mpf(0), mp.mpf(0)]
    for n, frequency in enumerate(beam.natural_frequencies, start=1):
        omega, turn, q = 2 * mp.pi * mp.mpf(frequency), n * mp.pi * speed, mp.mpf(0)
        for place in places:
            phase, factor = n * mp.pi * mp.mpf(place), scale * load / (omega**2 - turn**2)
            left = scale * load / omega**2 - factor  # of the static displacement, which rings
            q += factor * mp.sin(phase + turn * t) + left * mp.sin(phase) * mp.cos(omega * t)
            q += left * turn * mp.cos(phase) * mp.sin(omega * t) / omega
        for k, place in enumerate(places):
            found[k] += scale * mp.sin(n * mp.pi * (mp.mpf(place) + speed * t)) * q
    source = "Frýba, sum over the modes; tolerance: the time step"
    for k, which in enumerate(("rear", "front")):
        what = f"two forces of 50 N at 8 m/s on a beam of 1 m: displacement under the {which} one"
        yield Check(what, found[k], run.over_displacement[k, -1], "mm", source=source, tolerance=1e-6)


def rig():
    """A wheel on a Hertzian contact over a sine carries a mass on spring and damper."""
    spring, damper, stiffness, loads = 4e5, 30.0, 3e9, np.array([4.0, 11.0])
    masses, amplitude, length, start = np.array([0.4, 1.1]), 5e-7, 4e-3, 0.3
    link = np.array([[1.0, -1.0], [-1.0, 1.0]])

    def force(t, y):
        height = amplitude * np.sin(2 * np.pi * (start + t) / length)
        return stiffness * max(-y[0] - height, 0.0) ** 1.5

    def rates(t, y):
        total = np.array([force(t, y), 0.0]) - link @ (damper * y[2:] + spring * y[:2]) - loads
        return np.concatenate([y[2:], total / masses])

    wheel = -((15.0 / stiffness) ** (2 / 3) + amplitude * np.sin(2 * np.pi * start / length))
    rest = [wheel, wheel - loads[1] / spring, 0.0, 0.0]
    peer = solve_ivp(rates, (0.0, 0.01), rest, "DOP853", rtol=1e-12, atol=1e-18, max_step=2e-5)
    body = Body(
        np.diag(masses), damper * link, spring * link, np.array([[1.0, 0.0]]), loads, np.zeros(1),
        EMPTY, EMPTY, np.zeros((1, 0)),
    )  # fmt: skip
    x = 0.29 + length / 200 * np.arange(1200)
    texture = StateTexture.unfiltered(amplitude * np.sin(2 * np.pi * x / length), length / 200, 0.29)
    run = roll_bodies(
        None, [body], [HertzLaw(stiffness, texture)], speed=1.0, start=start, duration=0.01, time_step=2.5e-7,
        positions=[0.0],
    )  # fmt: skip
    expected, found = force(0.01, peer.y[:, -1]), run.contact_force[0, -1]
    what = "rig of two masses, Hertzian contact over a sine, after 10 ms: contact force"
    yield Check(what, expected, found, "N", source="DOP853 of SciPy, rtol 1e-12", tolerance=1e-6)


def passing_balls():
    """Four balls carry a mass over waves of twice their spacing, and of the spacing."""
    spacing, stiffness, mass, damper, h = 2e-3, 2e7, 0.8, 200.0, 4e-6
    places, none = spacing * (np.arange(4) - 1.5), np.zeros((2, 2))
    body = Body(
        np.diag([mass, mass * 5e-6]), none, none, np.column_stack([np.ones(4), places]),
        np.array([20.0, 0.0]), places, EMPTY, EMPTY, np.zeros((4, 0)),
    )  # fmt: skip
    for harmonic in (2, 4):
        wave = 8e-3 / harmonic
        x = 0.28 + 1e-5 * np.arange(40000)
        texture = StateTexture.unfiltered(1e-8 * np.cos(2 * np.pi * x / wave), 1e-5, 0.28)
        run = roll_bodies(
            None, [body], [Linear(5.0, stiffness, 0.0, texture, damping=damper)] * 4, speed=1.0, start=0.35,
            duration=0.08, settling=0.04, time_step=h, positions=[0.0],
        )  # fmt: skip
        omega = 2 * mp.pi / mp.mpf(wave)
        spring = 4 * (stiffness + 1j * damper * omega)
        mean = abs(sum(mp.expj(omega * mp.mpf(float(place))) for place in places)) / 4
        expected = mp.chop(mean * abs(spring / (spring - mass * omega**2)) * 10)
        heave = run.degrees_of_freedom[0][0, :-1]
        line = round(len(heave) * h / wave)
        found = round(2e9 * np.abs(np.fft.rfft(heave)[line]) / len(heave), 3)
        what = f"carriage on four balls 2 mm apart, waves of {wave * 1e3:g} mm: amplitude of heave per 10 nm"
        source = "mean over the balls · K/(K − Mω²)"
        amplitudes = (1e-9 * float(expected), 1e-9 * found)
        yield Check(what, *amplitudes, "nm", source=source, tolerance=0.02, absolute=True)
