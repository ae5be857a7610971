"""Checks of roughness processing, statistics and files."""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import mpmath as mp
import numpy as np
from ledger import Check

from asperity.surfaces.defects import flat_length, flat_trajectory
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.levelling import band_limit, level
from asperity.surfaces.measured_lines import remove_spikes, roll_over
from asperity.surfaces.readers import read_surface
from asperity.surfaces.spectra import psd_1d
from asperity.surfaces.statistics import areal_statistics
from asperity.surfaces.synthesis import self_affine

sys.path.insert(0, str(Path(__file__).parents[1] / "surfaces"))
from surface_files import sdf_ascii, sdf_binary, x3p

MM, UM = 1e-3, 1e-6


def circle():
    heights = np.zeros(401)
    heights[200] = 50 * UM
    rolled = roll_over(Profile(heights, MM), 0.375).heights
    source = "a circle of 0.375 m that rests on a point"
    for away in (1, 4):
        drop = mp.mpf("0.375") - mp.sqrt(mp.mpf("0.375") ** 2 - mp.mpf(away * MM) ** 2)
        what = f"EN 15610: rolled over a point of 50 µm, height {away} mm beside it"
        yield Check(what, source, float(50 - drop * 1e6), rolled[200 + away] * 1e6, 1e-9, "µm")
    slot = np.zeros(401)
    slot[195:206] = -1 * MM
    rolled = roll_over(Profile(slot, MM), 0.375).heights
    sagitta = mp.mpf("0.375") - mp.sqrt(mp.mpf("0.375") ** 2 - mp.mpf(6 * MM) ** 2)
    yield Check(
        "EN 15610: rolled over a slot of 12 mm, depth that is left",
        "sagitta of the circle",
        float(sagitta * 1e6),
        -rolled[200] * 1e6,
        1e-6,
        "µm",
    )


def spikes():
    x = (np.arange(401) - 200) * MM
    for height, width, left in ((40, 6, 0.0), (10, 6, 10.0), (20, 10, 20.0)):
        line = Profile(height * UM * np.clip(1 - np.abs(x) / (width * MM / 2), 0, None), MM)
        found = remove_spikes(line)[0].heights.max() * 1e6
        what = f"EN 15610: spike of {height} µm, {width} mm wide, what is left"
        yield Check(
            what,
            "removed where higher than w²/3 m and sharper than 1e7 µm/m²",
            left,
            found,
            1e-9,
            "µm",
            absolute=True,
        )


def flats():
    radius, depth = mp.mpf("0.46"), mp.mpf("0.5e-3")
    chord = 2 * mp.sqrt(2 * radius * depth - depth**2)
    yield Check(
        "fresh flat of 0.5 mm on R = 0.46 m: length",
        "chord of the circle",
        float(chord) * 1e3,
        flat_length(0.5e-3, 0.46) * 1e3,
        1e-3,
        "mm",
    )
    lowest = float(np.min(flat_trajectory(np.linspace(-0.05, 0.05, 2001), 0.5e-3, 0.46))) * 1e3
    yield Check(
        "fresh flat: deepest point of the wheel's centre", "the depth itself", 0.5, abs(lowest), 2e-3, "mm"
    )


def statistics():
    n, dx = 2048, 1e-6
    wave = np.sin(2 * np.pi * 32 * np.arange(n) / n)[:, None] * np.ones((1, 64))
    found = {s.symbol: s.value for s in areal_statistics(HeightMap(wave * UM, (dx, dx)))}
    k = 2 * mp.pi * 32 / (n * mp.mpf(dx))
    source = "a sine wave"
    yield Check(
        "ISO 25178: Sq of a sine of 1 µm",
        f"{source}, A/√2",
        float(1 / mp.sqrt(2)),
        found["Sq"] * 1e6,
        1e-6,
        "µm",
    )
    yield Check("ISO 25178: Ssk of a sine", f"{source}, 0", 0.0, found["Ssk"], 1e-6, absolute=True)
    yield Check("ISO 25178: Sku of a sine", f"{source}, 3/2", 1.5, found["Sku"], 1e-6)
    slope = float(k * mp.mpf(UM) / mp.sqrt(2))
    yield Check(
        "ISO 25178: Sdq of a sine",
        f"{source}, kA/√2; tolerance: the ends, where it has no differences",
        slope,
        found["Sdq"],
        2e-3,
    )


def spectra_of_surfaces():
    surface = self_affine(
        (512, 512), (1e-6, 1e-6), rms=0.4e-6, hurst=0.8, longest=60e-6, shortest=6e-6, seed=5
    )
    wavenumber, density = psd_1d(surface, 0)
    total = float(density.sum() * (wavenumber[1] - wavenumber[0]))
    yield Check(
        "one-sided PSD along x: its integral",
        "Parseval, the mean square of the heights; tolerance: the window",
        float(np.mean((surface.heights - surface.heights.mean()) ** 2)) * 1e12,
        total * 1e12,
        0.05,
        "µm²",
    )
    yield Check(
        "self-affine surface of 0.4 µm rms: rms of one realisation",
        "its spectrum; tolerance: scatter of one window",
        0.4,
        float(surface.heights.std()) * 1e6,
        0.08,
        "µm",
    )


def filters_and_form():
    n, dx = 4096, 1e-5
    x = dx * np.arange(n)
    wave = Profile(1e-6 * np.sin(2 * np.pi * x / 0.8e-3), dx)
    kept = band_limit(wave, shortest=0.8e-3).heights[1000:3000]
    yield Check(
        "Gaussian filter: a wave at the cut-off",
        "ISO 16610-21, 50 %",
        0.5,
        float(np.sqrt(2) * kept.std()) * 1e6,
        1e-3,
    )
    half = band_limit(wave, shortest=1.6e-3).heights[1000:3000]
    alpha = mp.sqrt(mp.log(2) / mp.pi)
    expected = float(mp.exp(-mp.pi * (alpha * 2) ** 2))
    yield Check(
        "Gaussian filter: a wave of half the cut-off",
        "ISO 16610-21, e^(−π(αλc/λ)²)",
        expected,
        float(np.sqrt(2) * half.std()) * 1e6,
        5e-3,
    )
    u, v = np.meshgrid(np.linspace(-1, 1, 40), np.linspace(-1, 1, 30), indexing="ij")
    bowed = HeightMap(2e-6 * u**2 - 1e-6 * u * v + 3e-6, (1e-6, 1e-6))
    left = float(np.abs(level(bowed, 2).heights).max()) * 1e6
    yield Check(
        "levelling of a paraboloid by degree 2: what is left",
        "projection",
        0.0,
        left,
        1e-9,
        "µm",
        absolute=True,
    )


def files():
    heights = np.arange(12.0).reshape(3, 4)  # (x, y)
    words = [[f"{v:g}" for v in row] for row in heights.T]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "a.sdf").write_bytes(sdf_binary(heights.T, 5))
        (folder / "b.sdf").write_bytes(sdf_ascii(words))
        np.save(folder / "d.npy", heights)
        x3p(folder / "c.x3p", [heights.T * 1e-9])
        for file, source, hints in (
            ("a.sdf", "ISO 25178-71, binary", {}),
            ("b.sdf", "ISO 25178-71, ASCII", {}),
            ("c.x3p", "ISO 25178-72", {}),
            ("d.npy", "NumPy's format", {"height_unit": "nm", "pixel": "2 um"}),
        ):
            surface = read_surface(folder / file, **hints)
            what = f"file {file[-3:].upper()}: height of the point x = 2, y = 1"
            yield Check(what, source, float(heights[2, 1]), float(surface.heights[2, 1]) * 1e9, 1e-9, "nm")
            if not hints:
                yield Check(
                    f"file {file[-3:].upper()}: spacing across",
                    source,
                    3.0,
                    surface.spacing[1] * 1e6,
                    1e-12,
                    "µm",
                )


CHECKS = (circle, spikes, flats, statistics, spectra_of_surfaces, filters_and_form, files)
