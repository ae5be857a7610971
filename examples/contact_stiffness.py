"""Stiffness of a rough contact: below Hertz's, and rising more smoothly.

A steel ball is pressed on an ensemble of rough samples. All share one datum d0: the state is
r = approach + d0, zero where the highest sample is first touched, and the contact stiffness is
k_c(r) = F(r)/r. Smooth bodies first touch at r = d0, so Hertz's k(s) = K_H sqrt(s) is drawn at s = r - d0.

What is asserted:

- past its first touch Hertz's stiffness overtakes the rough one within an rms height of the texture,
  and stays above it;
- the rough stiffness rises more smoothly: its steepest rise over an rms height is less than half of Hertz's,
  which starts with a vertical tangent;
- whatever the datum, the rough contact is the softer one: under equal load its tangent stiffness dF/dr is
  lower.

What does *not* hold is that roughness lowers the force at equal approach of the mean planes: peaks touch
early, so it is larger there, certainly where the planes meet (smooth bodies only touch) and on these samples
still by 17 ± 6 % (standard error) at r = 4 µm. With both forces divided by one and the same r, the rough
stiffness lies above.

Run: python contact_stiffness.py [FOLDER]
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from asperity.contact import HalfSpace, Hertz
from asperity.contact.scan import first_touch
from asperity.reduction.areal import punch_weights
from asperity.reduction.ensemble import StiffnessEnsemble, patches, stiffness_ensemble
from asperity.reference.materials import contact_modulus, material
from asperity.reporting.style import styled
from asperity.surfaces.synthesis import self_affine

STEEL = material("steel")
BALL = Hertz(contact_modulus(STEEL, STEEL), 25e-3, 25e-3)  # radius 25 mm
WORKING_LOAD = 5.0  # N, the weight of the ball
RMS = 0.5e-6  # m
CELLS, SPACING = 79, (10e-6, 10e-6)  # m
STATES = np.linspace(0.0, 4e-6, 41)[1:]  # r, m
LOADS = np.geomspace(1.0, 100.0, 41)  # N
ROUGH, SMOOTH = "#0067a5", "#c8500a"


def press_on_samples(count: int = 12, maps: int = 4) -> StiffnessEnsemble:
    x = (np.arange(CELLS) - CELLS // 2) * SPACING[0]
    body = (x[:, None] ** 2 + x[None, :] ** 2) / (2 * BALL.radius_x)
    rough = [
        self_affine(
            (3 * CELLS, 3 * CELLS), SPACING, rms=RMS, hurst=0.8, longest=0.4e-3, shortest=32e-6, seed=seed
        ).heights
        for seed in range(maps)
    ]
    # each sample counts from the plane that the nominal patch feels; waves longer than it are no roughness
    patch = punch_weights(SPACING, BALL.semi_axes(BALL.approach(WORKING_LOAD)))
    samples = patches(rough, body.shape, count, patch)
    datum = -min(float(first_touch(sample, body).min()) for sample in samples)
    half_space = HalfSpace(body.shape, SPACING, BALL.modulus)
    return stiffness_ensemble(samples, half_space, body, STATES - datum, datum)


def hertz_stiffness(s: np.ndarray) -> np.ndarray:
    return BALL.stiffness_constant * np.sqrt(np.maximum(s, 0.0))


def steepest_rise(stiffness: np.ndarray) -> float:
    """Largest rise of k over one rms height of the texture, N/m."""
    span = round(RMS / (STATES[1] - STATES[0]))
    return float(np.max(stiffness[span:] - stiffness[:-span]))


def hertz_tangent(loads: np.ndarray) -> np.ndarray:
    return np.array([BALL.tangent_stiffness(BALL.approach(load)) for load in loads])


def draw(ensemble: StiffnessEnsemble, file: Path) -> None:
    with styled():
        figure = Figure(figsize=(9.6, 3.9))
        left, right = figure.subplots(1, 2)
        draw_over_state(left, ensemble)
        tangent = ensemble.curve.stiffness(ensemble.curve.inverse(LOADS))
        right.loglog(LOADS, tangent / 1e6, color=ROUGH, lw=2, label="rough, mean")
        right.loglog(LOADS, hertz_tangent(LOADS) / 1e6, "--", color=SMOOTH, lw=2, label="Hertz")
        right.set(xlabel="load / N", ylabel="tangent stiffness dF/dr / (MN/m)", xlim=(LOADS[0], LOADS[-1]))
        right.set_yticks([5, 10, 20, 50], ["5", "10", "20", "50"])
        right.set_yticks([], minor=True)
        right.set_xticks([1, 10, 100], ["1", "10", "100"])
        right.set_title("Tangent stiffness at equal load")
        right.legend(loc="lower right")
        figure.savefig(file, dpi=150, facecolor="white")


def draw_over_state(axes: Axes, ensemble: StiffnessEnsemble) -> None:
    datum, r = ensemble.datum * 1e6, STATES * 1e6  # µm
    mean, spread = ensemble.mean_force / STATES / 1e6, ensemble.force_spread / STATES / 1e6  # MN/m
    label = f"rough, {len(ensemble.forces)} samples ± std"
    axes.fill_between(r, mean - spread, mean + spread, color=ROUGH, alpha=0.2, lw=0)
    axes.plot(r, mean, color=ROUGH, lw=2, label=label)
    past_touch = np.linspace(0.0, 1.0, 400) ** 2 * (STATES[-1] - ensemble.datum)
    hertz = hertz_stiffness(past_touch) / 1e6
    axes.plot(datum + past_touch * 1e6, hertz, "--", color=SMOOTH, lw=2, label="Hertz at r − d₀")
    axes.axvline(datum, color="0.5", lw=0.8)
    axes.text(
        datum - 0.04, 0.97, "d₀: mean planes meet", transform=axes.get_xaxis_transform(),
        rotation=90, ha="right", va="top", color="0.35", fontsize=8,
    )  # fmt: skip
    axes.set(xlabel="state r / µm", ylabel="contact stiffness F/r / (MN/m)")
    axes.set(xlim=(0.0, r[-1]), ylim=(0.0, None), title="Stiffness as the point force uses it")
    axes.legend(loc="lower right")


def main(folder: Path = Path()) -> dict[str, float]:
    ensemble = press_on_samples()
    rough = ensemble.mean_force / STATES
    hertz = hertz_stiffness(STATES - ensemble.datum)
    overtaken = STATES[np.flatnonzero(hertz <= rough)[-1] + 1]
    curve = ensemble.curve
    softening = curve.stiffness(curve.inverse(LOADS)) / hertz_tangent(LOADS)
    numbers = {
        "datum": ensemble.datum,
        "overtaken_after": float(overtaken - ensemble.datum),
        "steepest_rise_rough": steepest_rise(rough),
        "steepest_rise_hertz": steepest_rise(hertz),
        "softening_at_working_load": float(np.interp(WORKING_LOAD, LOADS, softening)),
        "softening_at_most": float(softening.max()),
        "force_over_hertz": float(ensemble.mean_force[-1] / BALL.force(STATES[-1] - ensemble.datum)),
    }
    draw(ensemble, folder / "contact_stiffness.png")
    assert numbers["overtaken_after"] < RMS
    assert numbers["steepest_rise_rough"] < 0.5 * numbers["steepest_rise_hertz"]
    assert numbers["softening_at_most"] < 1.0
    return numbers


if __name__ == "__main__":
    for name, value in main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path()).items():
        print(f"{name} = {value:.4g}")
