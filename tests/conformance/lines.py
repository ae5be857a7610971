"""Checks of spectra, bands and weighting."""

from __future__ import annotations

import mpmath as mp
import numpy as np
from ledger import Check

from asperity.spectra import a_weighting, band_levels, energy_sum, psd, third_octave_bands
from asperity.units import quantity

A_WEIGHTING = {
    10: -70.4, 20: -50.5, 31.5: -39.4, 63: -26.2, 125: -16.1, 250: -8.6, 500: -3.2, 1000: 0.0, 2000: 1.2,
    4000: 1.0, 8000: -1.1, 16000: -6.6,
}  # fmt: skip
"""IEC 61672-1:2013, Table 3, by nominal frequency."""


def weighting():
    for nominal, printed in A_WEIGHTING.items():
        exact = 1000 * 10 ** (round(10 * np.log10(nominal / 1000)) / 10)
        found = float(a_weighting(exact))
        yield Check(
            f"A-weighting at {nominal:g} Hz",
            "IEC 61672-1, Table 3, printed to 0.1 dB",
            printed,
            found,
            0.0501,
            "dB",
            absolute=True,
        )


def bands():
    centres, low, high = third_octave_bands(90.0, 5500.0)
    source = "IEC 61260-1, 1000·10^(n/10), edges ·10^±(1/20)"
    for n in (-10, -3, 2, 7):
        i = int(np.argmin(np.abs(np.log10(centres / 1000) - n / 10)))
        yield Check(
            f"one-third octave n = {n}: centre",
            source,
            float(1000 * mp.mpf(10) ** (mp.mpf(n) / 10)),
            centres[i],
            1e-12,
            "Hz",
        )
    i = int(np.argmin(np.abs(centres - 1000)))
    yield Check(
        "one-third octave of 1 kHz: lower edge",
        source,
        float(1000 * mp.mpf(10) ** mp.mpf("-0.05")),
        low[i],
        1e-12,
        "Hz",
    )
    yield Check(
        "one-third octave of 1 kHz: upper edge",
        source,
        float(1000 * mp.mpf(10) ** mp.mpf("0.05")),
        high[i],
        1e-12,
        "Hz",
    )
    lengths = 1.0 / third_octave_bands(1 / 0.3, 1 / 3e-3)[0]
    nearest = lengths[np.argmin(np.abs(lengths - 0.05))]
    yield Check(
        "wavelength band called 50 mm: centre",
        "base 10 in wavenumber, 10^(13/10) 1/m",
        float(1 / mp.mpf(10) ** mp.mpf("1.3")) * 1e3,
        nearest * 1e3,
        1e-12,
        "mm",
    )


def densities():
    step, n = 1e-4, 8000
    t = step * np.arange(n)
    sine = 3.0 * np.sin(2 * np.pi * 1000.0 * t)
    frequency, density = psd(sine, step, segment=2000)
    total = float(density.sum() * (frequency[1] - frequency[0]))
    yield Check("PSD of a sine of 3 N: its integral", "A²/2", 4.5, total, 1e-9, "N²")
    level = band_levels(frequency, density)
    i = int(np.argmin(np.abs(level[0] - 1000.0)))
    yield Check(
        "level of that sine in its one-third octave",
        "10 lg 4.5",
        float(10 * mp.log10(4.5)),
        float(level[1][i]),
        1e-4,
        "dB",
        absolute=True,
    )
    yield Check(
        "two equal levels together",
        "10 lg 2",
        float(80 + 10 * mp.log10(2)),
        float(energy_sum([80.0, 80.0])),
        1e-12,
        "dB",
    )


def units():
    yield Check("unit door: 1 inch", "international inch", 25.4, quantity("1 inch", "m") * 1e3, 1e-12, "mm")
    yield Check("unit door: 1 kgf", "standard gravity", 9.80665, quantity("1 kgf", "N"), 1e-12, "N")
    yield Check("unit door: 200 km/h", "SI", 200 / 3.6, quantity("200 km/h", "m/s"), 1e-12, "m/s")


CHECKS = (weighting, bands, densities, units)
