"""Checks of spectra, bands and weighting."""

from functools import partial

import mpmath as mp
import numpy as np
from ledger import Check

from asperity.diagnostics import one_anderon
from asperity.spectra import a_weighting, third_octave_bands

A_WEIGHTING = {
    10: -70.4, 20: -50.5, 31.5: -39.4, 63: -26.2, 125: -16.1, 250: -8.6, 500: -3.2, 1000: 0.0, 2000: 1.2,
    4000: 1.0, 8000: -1.1, 16000: -6.6,
}  # fmt: skip
"""IEC 61672-1:2013, Table 3, by nominal frequency."""


def weighting():
    row = partial(Check, source="IEC 61672-1, Table 3, printed to 0.1 dB", tolerance=0.0501, absolute=True)
    for nominal, printed in A_WEIGHTING.items():
        exact = 1000 * 10 ** (round(10 * np.log10(nominal / 1000)) / 10)
        yield row(f"A-weighting at {nominal:g} Hz", printed, a_weighting(exact), "dB")


def anderons():
    """One anderon is a microinch of way for each radian, over the root of the octaves of the band."""
    source = "Sugawara Laboratories, units of measurement, 50 Hz to 10.8 kHz in three, as printed"
    for band in ((50.0, 300.0), (300.0, 1800.0), (1800.0, 10.8e3)):
        what = f"one anderon of {band[0]:g} to {band[1]:g} Hz at 1800 1/min"
        (found,) = one_anderon(30.0, (band,))
        yield Check(what, 7.698, 1e6 * found, "µm/s", source=source, tolerance=5.1e-4, absolute=True)


def bands():
    found = np.array(third_octave_bands(90.0, 5500.0))  # centres, lower and upper edges
    row = partial(Check, source="IEC 61260-1, 1000·10^(n/10), edges ·10^±(1/20)", tolerance=1e-12)

    def of(n):
        return found[:, np.argmin(np.abs(np.log10(found[0] / 1000) - n / 10))]

    for n in (-10, -3, 2, 7):
        yield row(f"one-third octave n = {n}: centre", 1000 * mp.mpf(10) ** (mp.mpf(n) / 10), of(n)[0], "Hz")
    for which, edge, exponent in (("lower", 1, "-0.05"), ("upper", 2, "0.05")):
        expected = 1000 * mp.mpf(10) ** mp.mpf(exponent)
        yield row(f"one-third octave of 1 kHz: {which} edge", expected, of(0)[edge], "Hz")
    lengths = 1.0 / third_octave_bands(1 / 0.3, 1 / 3e-3)[0]
    nearest = lengths[np.argmin(np.abs(lengths - 0.05))]
    expected, source = 1 / mp.mpf(10) ** mp.mpf("1.3"), "base 10 in wavenumber, 10^(13/10) 1/m"
    yield row("wavelength band called 50 mm: centre", expected, nearest, "mm", source=source)
