"""The contact filter: a larger state hears less of a fine texture.

A steel ball at constant state r = approach + d0 is moved along rough strips, and its force is compared,
wavenumber by wavenumber, with that of a point force on the line textures under the patch (Hann window, power
of all lines and strips, averaged over a sixth of an octave). A patch of semi-axis a = sqrt(R approach)
averages over its width, so the filter |H(k, r)| falls earlier the larger r is.

What is asserted:

- the wavenumbers at which the printed filter has fallen by 3 dB and by 10 dB are lower for each larger state;
- so is, on average over the wavenumbers, the filter that is referred to the tangent stiffness.

The printed normalisation (left) makes the filter one at the longest waves. It needs waves longer than the
patch, and the texture here rolls off at 1 mm: the largest state has lost half its force there already
(k_0/k_t = 0.54), which does not show. With a roll-off at 0.4 mm, shorter than the larger patches, k_0/k_t
goes down to 0.28, and the wavenumbers no longer fall in order (10 dB at 2400, 1630, 4010 and 1850 cycles/m).
Referred to the tangent stiffness (right), the filter says how much of the texture reaches the force in all.
It starts below one, since this texture also varies across the path. Where sin q / q, q = 2 pi k a, the closed
form for texture that is uniform across, goes through zero, it has a dip, and lobes beyond.

Run: python contact_filter.py [FOLDER]
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from asperity.contact import HalfSpace, Hertz
from asperity.contact.scan import first_touch
from asperity.reduction.filter import ContactFilter, estimate_filter, filter_spectra, punch_filter
from asperity.reduction.stiffness import ForceCurve
from asperity.reference.materials import contact_modulus, material
from asperity.reporting.style import sequence, styled, wavenumber_axis
from asperity.surfaces.synthesis import self_affine

STEEL = material("steel")
BALL = Hertz(contact_modulus(STEEL, STEEL), 25e-3, 25e-3)  # radius 25 mm
CELLS, SPACING, STRIDE = 81, 16e-6, 2  # m
STATES = np.array([2.0, 3.0, 5.0, 9.0]) * 1e-6  # r, m


class Filters(NamedTuple):
    """Filters of one set of scans in both normalisations, and the semi-axis of the patch at each state, m."""

    printed: ContactFilter
    tangent: ContactFilter
    semi_axis: np.ndarray


def filters(longest: float, strips: int = 3, rows: int = 720) -> Filters:
    grid = (SPACING, SPACING)
    x = (np.arange(CELLS) - CELLS // 2) * SPACING
    body = (x[:, None] ** 2 + x[None, :] ** 2) / (2 * BALL.radius_x)
    roughness = {"rms": 0.3e-6, "hurst": 0.8, "longest": longest, "shortest": 64e-6}
    textures = [self_affine((rows, CELLS), grid, **roughness, seed=seed).heights for seed in range(strips)]
    textures = [z - z.mean() for z in textures]
    datum = -min(first_touch(z, body, STRIDE).min() for z in textures)
    approaches = STATES - datum
    semi_axis = np.array([BALL.semi_axes(approach)[0] for approach in approaches])
    long_waves = 0.5 / (2 * np.pi * semi_axis)  # k a < 1/2, where sin q/q is one but for 4 %
    under = (semi_axis / SPACING).astype(int)  # lines on either side of the middle
    half_space = HalfSpace(body.shape, SPACING, BALL.modulus)
    spectra, means = [], []
    for z in textures:
        forces = half_space.scan(z, body, approaches, STRIDE, rtol=1e-5).values
        lines = z[CELLS // 2 :][: forces.shape[1] * STRIDE].T
        spectra.append(filter_spectra(forces, lines, SPACING, under))
        means.append(forces.mean(axis=1))
    slope = ForceCurve.from_samples(approaches, np.mean(means, axis=0)).stiffness(approaches)
    printed, tangent = (
        estimate_filter(spectra, approaches, slope, normalise=normalise, asymptote=long_waves)
        for normalise in ("low-wavenumber", "tangent")
    )
    return Filters(printed, tangent, semi_axis)


def falls_to(contact_filter: ContactFilter, level: float) -> np.ndarray:
    """Wavenumber at which each filter first falls to a level in dB, cycles/m."""
    found = []
    for magnitude in contact_filter.magnitude:
        loss = -decibels(magnitude)
        i = int(np.argmax(loss > -level))
        found.append(np.interp(-level, loss[i - 1 : i + 1], contact_filter.wavenumber[i - 1 : i + 1]))
    return np.array(found)


def draw(found: Filters, file: Path) -> None:
    with styled():
        figure = Figure(figsize=(9.6, 4.4))
        panels = figure.subplots(1, 2, sharey=True, gridspec_kw={"wspace": 0.08})
        titles = ("As printed: one at the longest waves", "Referred to the tangent stiffness")
        for axes, title, shown in zip(panels, titles, (found.printed, found.tangent), strict=True):
            k = shown.wavenumber
            rows = zip(
                sequence(len(STATES)), STATES, found.semi_axis, shown.magnitude, shown.spread, strict=True
            )
            for colour, state, a, magnitude, spread in rows:
                low, high = (decibels(np.maximum(magnitude + sign * spread, 1e-3)) for sign in (-1, 1))
                axes.fill_between(k, low, high, color=colour, alpha=0.15, lw=0)
                axes.plot(k, decibels(magnitude), color=colour, lw=2, label=f"r = {state * 1e6:g} µm")
                main_lobe = np.geomspace(k[0], 0.499 / a, 200)
                axes.plot(main_lobe, decibels(punch_filter(main_lobe, a)), ":", color=colour, lw=1.2)
            axes.plot([], [], ":", color="0.3", label="sin q / q, main lobe")
            axes.set_title(title, pad=8)
            wavenumber_axis(axes, 100.0, 1e4)
        panels[0].set(ylabel="contact filter |H| / dB", ylim=(-40, 5))
        panels[0].legend(loc="lower left")
        figure.savefig(file, dpi=150, facecolor="white")


def decibels(magnitude: np.ndarray) -> np.ndarray:
    return 20 * np.log10(np.maximum(magnitude, 1e-6))


def main(folder: Path = Path(), longest: float = 1e-3) -> dict[str, list[float]]:
    found = filters(longest)
    draw(found, folder / "contact_filter.png")
    numbers = {
        "wavenumber_at_3_db": falls_to(found.printed, -3.0).tolist(),
        "wavenumber_at_10_db": falls_to(found.printed, -10.0).tolist(),
        "mean_level_from_tangent": decibels(found.tangent.magnitude).mean(axis=1).tolist(),
    }
    for name, values in numbers.items():
        assert np.all(np.diff(values) < 0.0), f"{name} does not fall with the state: {values}"
    return numbers


if __name__ == "__main__":
    for name, values in main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path()).items():
        print(name, "=", ", ".join(f"{value:.4g}" for value in values))
