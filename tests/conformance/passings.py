"""Checks of the level beside the track while axles pass."""

import math
from functools import partial

import mpmath as mp
import numpy as np
from ledger import Check
from scipy.special import jv

from asperity.radiation.pass_by import AxleSource, Passage, Receiver, pass_by_levels, pressure_level
from asperity.radiation.sound_path import PorousGround, SoundPath
from asperity.reference.railways import GROUNDS

WATT = np.array([1e-3])
FLAT = Receiver(7.5, 0.0)
PATH = SoundPath(np.array([1000.0]), FLAT)
IMPEDANCE, REFERENCE = mp.mpf(413), mp.mpf("4e-10")


def decibels(squared):
    return 10 * mp.log10(squared / REFERENCE)


def point():
    """A point source over reflecting ground: p² = W ρc/(2π d²), integral over the passage W ρc/(2 d v)."""
    watt, d, v = mp.mpf("1e-3"), mp.mpf("7.5"), mp.mpf(50)
    found = pressure_level(PATH.squared_pressure(AxleSource(WATT), Passage([0.0], 50.0), [0.0, 1.0])[0, 0])
    row, source = partial(Check, unit="dB", absolute=True), "hemisphere, p² = W ρc/(2π d²)"
    expected = decibels(watt * IMPEDANCE / (2 * mp.pi * d**2))
    yield row("1 mW opposite, 7.5 m", expected, found, source=source, tolerance=1e-3)
    found = pressure_level(PATH.exposure(AxleSource(WATT, 5.0), Passage([0.0, 2.5], 50.0))[0])
    what = "SEL of two axles of 1 mW at 50 m/s, spread along the rail"
    source = "∫ W ρc/(2π (d² + v²t²)) dt = W ρc/(2 d v)"
    yield row(what, decibels(2 * watt * IMPEDANCE / (2 * d * v)), found, source=source, tolerance=1e-9)


def ground():
    """Reflection of a spherical wave over a plane with impedance, against Sommerfeld's integral, e^{+iωt}."""
    away, height = 7.5, 2.2
    path = math.hypot(away, height)
    for name, f in (("grass", 500), ("lawn", 1000), ("asphalt", 2000)):
        surface, k = PorousGround(GROUNDS[name]), 2.0 * np.pi * f / 343.2
        x = 413.0 / 343.2 * f / GROUNDS[name]
        admittance = 1.0 / (1.0 + 0.0571 * x**-0.754 - 0.087j * x**-0.732)

        def wave(kappa, k=k, admittance=admittance):
            vertical = np.sqrt(k**2 - kappa**2)
            vertical = np.where(vertical.imag > 0.0, -vertical, vertical)
            plane = (vertical / k - admittance) / (vertical / k + admittance)
            turn = np.exp(-1j * vertical * height)
            return plane * jv(0, kappa * away) * turn * kappa / (1j * vertical)

        around = [0, k / 2 + 0.4j, k + 0.4j, 3 * k / 2 + 0.4j]  # the branch point k
        contour = np.array(around + [2 * k + n for n in (0, 4, 8, 12, 16)], dtype=complex)
        half, middle = 0.5 * np.diff(contour)[:, None], 0.5 * (contour[1:] + contour[:-1])[:, None]
        nodes, weights = np.polynomial.legendre.leggauss(200)
        exact = np.sum(wave(middle + half * nodes) * half @ weights) * path * np.exp(1j * k * path)
        found = surface.reflection(float(f), height / path, path)
        body = f"spherical wave over {name}, {f} Hz, 2.2 m in height and 7.5 m away"
        row = partial(Check, body=body, source="Sommerfeld's integral, by quadrature", tolerance=0.01)
        yield row("|Q|", abs(exact), abs(found))
        yield row("phase of Q", np.angle(exact), np.angle(found), absolute=True)


def train():
    """A long train is a line source, W' = W/a; over its own length L its ends are missing."""
    apart, d, count = mp.mpf(6), mp.mpf("7.5"), 400
    passage = Passage(float(apart) * np.arange(count), 40.0)
    time = passage.times(FLAT)
    squared = PATH.squared_pressure(AxleSource(WATT), passage, time)
    _, found, _ = pass_by_levels(time, squared, passage.passed)
    over = count * apart / d
    ends = 2 / mp.pi * (mp.atan(over) - mp.log(1 + over**2) / (2 * over))
    expected = decibels(mp.mpf("1e-3") / apart * IMPEDANCE / (2 * d) * ends)
    what, source = "L_pAeq,Tp of 400 axles, 6 m apart", "line source, p² = W' ρc/(2 d), mean over its length"
    yield Check(what, expected, found[0], "dB", source=source, tolerance=2e-3, absolute=True)
