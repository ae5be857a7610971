"""Checks of roughness processing and statistics."""

from functools import partial

import mpmath as mp
import numpy as np
from ledger import Check

from asperity.surfaces.defects import flat_length, flat_trajectory
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.levelling import band_limit
from asperity.surfaces.measured_lines import remove_spikes, roll_over
from asperity.surfaces.statistics import areal_statistics

MM, UM = 1e-3, 1e-6


def circle():
    def drop(away):  # of a circle of 0.375 m, m
        return mp.mpf("0.375") - mp.sqrt(mp.mpf("0.375") ** 2 - mp.mpf(away * MM) ** 2)

    heights, slot = np.zeros(401), np.zeros(401)
    heights[200], slot[195:206] = 50 * UM, -1 * MM
    rolled, left = (roll_over(Profile(each, MM), 0.375).heights for each in (heights, slot))
    source = "a circle of 0.375 m that rests on a point"
    for away in (1, 4):
        what = f"EN 15610: rolled over a point of 50 µm, height {away} mm beside it"
        yield Check(what, 50 * UM - drop(away), rolled[200 + away], "µm", source=source, tolerance=1e-9)
    what, source = "EN 15610: rolled over a slot of 12 mm, depth that is left", "sagitta of the circle"
    yield Check(what, drop(6), -left[200], "µm", source=source, tolerance=1e-6)


def spikes():
    x = (np.arange(401) - 200) * MM
    source = "removed where higher than w²/3 m and sharper than 1e7 µm/m²"
    for height, width, left in ((40, 6, 0.0), (10, 6, 10.0), (20, 10, 20.0)):
        line = Profile(height * UM * np.clip(1 - np.abs(x) / (width * MM / 2), 0, None), MM)
        found = remove_spikes(line)[0].heights.max()
        what = f"EN 15610: spike of {height} µm, {width} mm wide, what is left"
        yield Check(what, left * UM, found, "µm", source=source, tolerance=1e-9, absolute=True)


def flats():
    radius, depth = mp.mpf("0.46"), mp.mpf("0.5e-3")
    chord, found = 2 * mp.sqrt(2 * radius * depth - depth**2), flat_length(0.5e-3, 0.46)
    what = "fresh flat of 0.5 mm on R = 0.46 m: length"
    yield Check(what, chord, found, "mm", source="chord of the circle", tolerance=1e-3)
    lowest = np.min(flat_trajectory(np.linspace(-0.05, 0.05, 2001), 0.5e-3, 0.46))
    what = "fresh flat: deepest point of the wheel's centre"
    yield Check(what, depth, abs(lowest), "mm", source="the depth itself", tolerance=2e-3)


def statistics():
    n, dx = 2048, 1e-6
    wave = np.sin(2 * np.pi * 32 * np.arange(n) / n)[:, None] * np.ones((1, 64))
    found = {s.symbol: s.value for s in areal_statistics(HeightMap(wave * UM, (dx, dx)))}
    slope = 2 * mp.pi * 32 / (n * mp.mpf(dx)) * mp.mpf(UM) / mp.sqrt(2)
    row = partial(Check, body="ISO 25178", tolerance=1e-6)
    yield row("Sq of a sine of 1 µm", UM / mp.sqrt(2), found["Sq"], "µm", source="a sine wave, A/√2")
    yield row("Ssk of a sine", 0.0, found["Ssk"], source="a sine wave, 0", absolute=True)
    yield row("Sku of a sine", 1.5, found["Sku"], source="a sine wave, 3/2")
    source = "a sine wave, kA/√2; tolerance: the ends, where it has no differences"
    yield row("Sdq of a sine", slope, found["Sdq"], source=source, tolerance=2e-3)


def filters():
    dx = 1e-5
    wave = Profile(np.sin(2 * np.pi * dx * np.arange(4096) / 0.8e-3), dx)

    def kept(shortest):  # of its amplitude
        return np.sqrt(2) * band_limit(wave, shortest=shortest).heights[1000:3000].std()

    row = partial(Check, body="Gaussian filter")
    yield row("a wave at the cut-off", 0.5, kept(0.8e-3), source="ISO 16610-21, 50 %", tolerance=1e-3)
    expected = mp.exp(-mp.pi * (mp.sqrt(mp.log(2) / mp.pi) * 2) ** 2)
    source = "ISO 16610-21, e^(−π(αλc/λ)²)"
    yield row("a wave of half the cut-off", expected, kept(1.6e-3), source=source, tolerance=5e-3)
