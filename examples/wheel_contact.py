"""Wheel on rail, pressed: stiffness of the rough contact, and filters of five states.

A railway wheel (radius 460 mm) stands on a rail head (radius 300 mm). Both functions of the state-dependent
contact are computed on one datum d0, r = approach + d0: the stiffness k_c(r) = F/r beside Hertz's, drawn at
r - d0, and the contact filters at r = 5, 15, 30, 70 and 110 µm. The texture is self-affine, of 1 µm rms and
waves of 2 to 30 mm, level below.

What is asserted:

- the rough stiffness rises more smoothly than Hertz's, which starts with a vertical tangent: its steepest
  rise over an rms height is less than half;
- filtering grows with the state: the wavenumbers at which the printed filter has fallen by 3 dB and by 10 dB
  are lower for each larger state. They do so because this texture holds waves longer than the largest patch,
  at which the printed normalisation can anchor; it does not hold for all textures;
- so does, whatever the texture, the filter referred to the tangent stiffness, on average over wavenumbers;
- on texture that is uniform across and small, the filter is sin q / q, q = 2 pi k a: from r = 15 µm on,
  within 0.02 rms over its main lobe.

Texture that varies across the rail as it does along it is averaged over the width of the patch too. Referred
to the tangent stiffness, its filters start lower and fall earlier than sin q / q: at r = 110 µm, 3 dB are
lost at 19 cycles/m instead of 30, and 10 dB at 47 instead of 51. As printed, what is lost at the longest
waves (k_0/k_t = 0.75) is left out, and 3 dB are lost at 39 cycles/m only.

Run: python wheel_contact.py [FOLDER]
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from asperity.contact import HalfSpace, Hertz
from asperity.contact.scan import first_touch
from asperity.reduction.areal import punch_weights
from asperity.reduction.ensemble import StiffnessEnsemble, patches, stiffness_ensemble
from asperity.reduction.filter import (
    ContactFilter,
    FilterSpectra,
    estimate_filter,
    filter_spectra,
    punch_filter,
)
from asperity.reference.materials import contact_modulus, material
from asperity.reporting.style import sequence, styled, wavenumber_axis
from asperity.surfaces.synthesis import self_affine

STEEL = material("steel")
WHEEL = Hertz(contact_modulus(STEEL, STEEL), 0.46, 0.30)  # rolling radius, radius of the rail head
LOAD = 65e3  # N
RMS = 1e-6  # m
CELLS, SPACING, STRIDE = 81, 0.25e-3, 3  # m
STATES = np.array([5.0, 15.0, 30.0, 70.0, 110.0]) * 1e-6  # r, m
RISE = np.linspace(0.0, 20e-6, 41)[1:]  # states of the stiffness where it rises, m
ROUGH, SMOOTH = "#0067a5", "#c8500a"

X = (np.arange(CELLS) - CELLS // 2) * SPACING
BODY = X[:, None] ** 2 / (2 * WHEEL.radius_x) + X[None, :] ** 2 / (2 * WHEEL.radius_y)
HALF_SPACE = HalfSpace(BODY.shape, SPACING, WHEEL.modulus)


class Filters(NamedTuple):
    """Filters of rough strips in both normalisations, that of a uniform strip, and the semi-axes, m."""

    printed: ContactFilter
    tangent: ContactFilter
    uniform: ContactFilter
    semi_axis: np.ndarray


def strip(rms: float, seed: int) -> np.ndarray:
    grid = (SPACING, SPACING)
    made = self_affine((1920, CELLS), grid, rms=rms, hurst=0.8, longest=30e-3, shortest=2e-3, seed=seed)
    return made.heights - made.heights.mean()


def stiffness(strips: list[np.ndarray]) -> StiffnessEnsemble:
    """Loading curves on one datum for samples and strips; each sample counts from its patch's plane."""
    weights = punch_weights((SPACING, SPACING), WHEEL.semi_axes(WHEEL.approach(LOAD)))
    samples = patches(strips, BODY.shape, 12, weights)
    datum = -min(float(first_touch(z, BODY).min()) for z in [*samples, *strips])
    states = np.concatenate([RISE, np.arange(25e-6, 116e-6, 5e-6)])
    return stiffness_ensemble(samples, HALF_SPACE, BODY, states - datum, datum)


def scanned(z: np.ndarray, approaches: np.ndarray) -> np.ndarray:
    """Forces at constant approach along a strip, N, shape (states, positions)."""
    return HALF_SPACE.scan(z, BODY, approaches, STRIDE, rtol=1e-5).values


def spectra(z: np.ndarray, forces: np.ndarray, across: np.ndarray) -> FilterSpectra:
    """Spectra of scanned forces and of the lines under the patch of each state."""
    lines = z[CELLS // 2 :][: forces.shape[1] * STRIDE].T
    return filter_spectra(forces, lines, SPACING, across)


def filters(strips: list[np.ndarray], ensemble: StiffnessEnsemble) -> Filters:
    approaches = STATES - ensemble.datum
    semi_axis = np.array([WHEEL.semi_axes(approach)[0] for approach in approaches])
    long_waves = 0.5 / (2 * np.pi * semi_axis)  # k a < 1/2, where sin q/q is one but for 4 %
    slope = ensemble.curve.stiffness(approaches)
    half_width = [WHEEL.semi_axes(approach)[1] for approach in approaches]
    under = (np.array(half_width) / SPACING).astype(int)  # lines on either side of the middle
    found = [spectra(z, scanned(z, approaches), under) for z in strips]
    printed, tangent = (
        estimate_filter(found, approaches, slope, normalise=normalise, asymptote=long_waves)
        for normalise in ("low-wavenumber", "tangent")
    )
    uniform = np.repeat(strip(0.3 * RMS, seed=0)[:, :1], CELLS, axis=1)
    forces = scanned(uniform - uniform.mean(), approaches)
    smooth = [WHEEL.tangent_stiffness(WHEEL.approach(force)) for force in forces.mean(axis=1)]
    same = estimate_filter([spectra(uniform, forces, under)], approaches, smooth)
    return Filters(printed, tangent, same, semi_axis)


def falls_to(contact_filter: ContactFilter, level: float) -> np.ndarray:
    """Wavenumber at which each filter first falls to a level in dB, cycles/m."""
    found = []
    for magnitude in contact_filter.magnitude:
        loss = -decibels(magnitude)
        i = int(np.argmax(loss > -level))
        found.append(np.interp(-level, loss[i - 1 : i + 1], contact_filter.wavenumber[i - 1 : i + 1]))
    return np.array(found)


def from_closed_form(found: Filters) -> np.ndarray:
    """Rms distance of each uniform filter from sin q/q over its main lobe."""
    k = found.uniform.wavenumber
    distance = []
    for a, signed in zip(found.semi_axis, found.uniform.signed, strict=True):
        lobe = 2 * k * a < 1.0
        distance.append(np.sqrt(np.mean((signed - punch_filter(k, a))[lobe] ** 2)))
    return np.array(distance)


def steepest_rise(stiffness: np.ndarray) -> float:
    """Largest rise of k over one rms height of the texture, N/m."""
    span = round(RMS / (RISE[1] - RISE[0]))
    return float(np.max(stiffness[span:] - stiffness[:-span]))


def hertz_stiffness(s: np.ndarray) -> np.ndarray:
    return WHEEL.stiffness_constant * np.sqrt(np.maximum(s, 0.0))


def decibels(magnitude: np.ndarray) -> np.ndarray:
    return 20 * np.log10(np.maximum(magnitude, 1e-6))


def draw(ensemble: StiffnessEnsemble, found: Filters, file: Path) -> None:
    with styled():
        figure = Figure(figsize=(9.6, 8.2), layout="constrained")
        panels = figure.subplots(2, 2)
        draw_stiffness(panels[0, 0], ensemble)
        draw_uniform(panels[0, 1], found)
        titles = ("Filter as printed: one at the longest waves", "Referred to the tangent stiffness")
        for axes, title, shown in zip(panels[1], titles, (found.printed, found.tangent), strict=True):
            draw_filter(axes, shown, found.semi_axis)
            axes.set(title=title, ylim=(-30, 5), ylabel="contact filter |H| / dB")
        panels[1, 0].legend(loc="lower left")
        figure.savefig(file, dpi=150, facecolor="white")


def draw_stiffness(axes: Axes, ensemble: StiffnessEnsemble) -> None:
    r, datum = ensemble.states * 1e6, ensemble.datum * 1e6  # µm
    axes.plot(r, ensemble.mean_force / ensemble.states / 1e9, color=ROUGH, lw=2, label="rough, 12 samples")
    past_touch = np.linspace(0.0, 1.0, 400) ** 2 * (r[-1] - datum) * 1e-6
    hertz = hertz_stiffness(past_touch) / 1e9
    axes.plot(datum + past_touch * 1e6, hertz, "--", color=SMOOTH, lw=2, label="Hertz at r − d₀")
    axes.axvline(datum, color="0.5", lw=0.8)
    axes.annotate("d₀", (datum, 0.97), (3, 0), ("data", "axes fraction"), "offset points", va="top")
    axes.set(xlabel="state r / µm", ylabel="contact stiffness F/r / (GN/m)", title="Stiffness")
    axes.set(xlim=(0.0, 115.0), ylim=(0.0, None))
    axes.legend(loc="lower right")


def draw_uniform(axes: Axes, found: Filters) -> None:
    fine = np.geomspace(5.0, 500.0, 400)
    rows = zip(sequence(len(STATES)), STATES, found.semi_axis, found.uniform.signed, strict=True)
    for colour, state, a, signed in rows:
        k = found.uniform.wavenumber
        shown = k * a < 1.0
        axes.plot(k[shown], signed[shown], "o", ms=3, color=colour, label=f"r = {state * 1e6:g} µm")
        axes.plot(fine[fine * a < 1.0], punch_filter(fine[fine * a < 1.0], a), color=colour, lw=1.2)
    axes.plot([], [], color="0.3", lw=1.2, label="sin q / q")
    wavenumber_axis(axes, 5.0, 500.0)
    axes.set(ylim=(-0.4, 1.2), ylabel="contact filter H", title="Texture uniform across, 0.3 µm rms")
    axes.legend(loc="lower left")


def draw_filter(axes: Axes, shown: ContactFilter, semi_axis: np.ndarray) -> None:
    rows = zip(sequence(len(STATES)), STATES, semi_axis, shown.magnitude, shown.spread, strict=True)
    k = shown.wavenumber
    for colour, state, a, magnitude, spread in rows:
        low, high = (decibels(np.maximum(magnitude + sign * spread, 1e-3)) for sign in (-1, 1))
        axes.fill_between(k, low, high, color=colour, alpha=0.15, lw=0)
        axes.plot(k, decibels(magnitude), color=colour, lw=2, label=f"r = {state * 1e6:g} µm")
        main_lobe = np.geomspace(k[0], 0.499 / a, 200)
        axes.plot(main_lobe, decibels(punch_filter(main_lobe, a)), ":", color=colour, lw=1.2)
    axes.plot([], [], ":", color="0.3", label="sin q / q, main lobe")
    wavenumber_axis(axes, 5.0, 500.0)


def main(folder: Path = Path()) -> dict[str, float | list[float]]:
    strips = [strip(RMS, seed) for seed in range(3)]
    ensemble = stiffness(strips)
    found = filters(strips, ensemble)
    draw(ensemble, found, folder / "wheel_contact.png")
    rough = (ensemble.mean_force / ensemble.states)[: len(RISE)]
    growing = {
        "wavenumber_at_3_db": falls_to(found.printed, -3.0).tolist(),
        "wavenumber_at_10_db": falls_to(found.printed, -10.0).tolist(),
        "mean_level_from_tangent": decibels(found.tangent.magnitude).mean(axis=1).tolist(),
    }
    numbers = {
        "datum": ensemble.datum,
        "steepest_rise_rough": steepest_rise(rough),
        "steepest_rise_hertz": steepest_rise(hertz_stiffness(RISE - ensemble.datum)),
        "distance_from_closed_form": from_closed_form(found).tolist(),
        **growing,
    }
    assert numbers["steepest_rise_rough"] < 0.5 * numbers["steepest_rise_hertz"]
    for name, values in growing.items():
        assert np.all(np.diff(values) < 0.0), f"{name} does not fall with the state: {values}"
    assert max(numbers["distance_from_closed_form"][1:]) < 0.02
    return numbers


if __name__ == "__main__":
    for name, value in main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path()).items():
        print(name, "=", ", ".join(f"{v:.4g}" for v in np.atleast_1d(value)))
