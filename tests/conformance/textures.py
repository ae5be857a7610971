"""Checks of roughness processing, statistics and files."""

import sys
import tempfile
from functools import partial
from pathlib import Path

import mpmath as mp
import numpy as np
from ledger import Check

from asperity import HeightMap, Profile, read_surface
from asperity.surfaces.defects import flat_length, flat_trajectory
from asperity.surfaces.levelling import band_limit, level
from asperity.surfaces.measured_lines import remove_spikes, roll_over
from asperity.surfaces.spectra import psd_1d
from asperity.surfaces.statistics import areal_statistics
from asperity.surfaces.synthesis import self_affine

sys.path.insert(0, str(Path(__file__).parents[1] / "surfaces"))
from surface_files import sdf_ascii, sdf_binary, x3p

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


def spectra_of_surfaces():
    waves = {"rms": 0.4 * UM, "hurst": 0.8, "longest": 60 * UM, "shortest": 6 * UM, "seed": 5}
    surface = self_affine((512, 512), (UM, UM), **waves)
    wavenumber, density = psd_1d(surface, 0)
    total, deviation = density.sum() * (wavenumber[1] - wavenumber[0]), surface.heights.std()
    about, window = surface.heights - surface.heights.mean(axis=0), np.hanning(513)[:-1, None] ** 2
    expected = float(np.sum(window * about**2) / (512 * window.sum()))
    source = "Parseval, the mean square of the lines, each about its mean, weighted by the squared window"
    what = "one-sided PSD along x: its integral"
    yield Check(what, expected, total, "µm²", source=source, tolerance=1e-12)
    what = "self-affine surface of 0.4 µm rms: rms of one realisation"
    source = "its spectrum; tolerance: scatter of one window"
    yield Check(what, 0.4 * UM, deviation, "µm", source=source, tolerance=0.08)


def filters_and_form():
    dx = 1e-5
    wave = Profile(np.sin(2 * np.pi * dx * np.arange(4096) / 0.8e-3), dx)

    def kept(shortest):  # of its amplitude
        return np.sqrt(2) * band_limit(wave, shortest=shortest).heights[1000:3000].std()

    row = partial(Check, body="Gaussian filter")
    yield row("a wave at the cut-off", 0.5, kept(0.8e-3), source="ISO 16610-21, 50 %", tolerance=1e-3)
    expected = mp.exp(-mp.pi * (mp.sqrt(mp.log(2) / mp.pi) * 2) ** 2)
    source = "ISO 16610-21, e^(−π(αλc/λ)²)"
    yield row("a wave of half the cut-off", expected, kept(1.6e-3), source=source, tolerance=5e-3)
    u, v = np.meshgrid(np.linspace(-1, 1, 40), np.linspace(-1, 1, 30), indexing="ij")
    bowed = HeightMap(2e-6 * u**2 - 1e-6 * u * v + 3e-6, (1e-6, 1e-6))
    left = np.abs(level(bowed, 2).heights).max()
    what = "levelling of a paraboloid by degree 2: what is left"
    yield Check(what, 0.0, left, "µm", source="projection", tolerance=1e-9, absolute=True)


def files():
    heights = np.arange(12.0).reshape(3, 4)  # (x, y)
    words = [[f"{v:g}" for v in row] for row in heights.T]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "a.sdf").write_bytes(sdf_binary(heights.T, 5))
        (folder / "b.sdf").write_bytes(sdf_ascii(words))
        np.save(folder / "d.npy", heights)
        (folder / "c.x3p").write_bytes(x3p([heights.T * 1e-9]))
        for file, source, hints in (
            ("a.sdf", "ISO 25178-71, binary", {}),
            ("b.sdf", "ISO 25178-71, ASCII", {}),
            ("c.x3p", "ISO 25178-72", {}),
            ("d.npy", "NumPy's format", {"height_unit": "nm", "pixel": "2 um"}),
        ):
            surface = read_surface(folder / file, **hints)
            row = partial(Check, body=f"file {file[-3:].upper()}", source=source)
            found = surface.heights[2, 1]
            yield row("height of the point x = 2, y = 1", heights[2, 1] * 1e-9, found, "nm", tolerance=1e-9)
            if not hints:
                yield row("spacing across", 3 * UM, surface.spacing[1], "µm", tolerance=1e-12)
