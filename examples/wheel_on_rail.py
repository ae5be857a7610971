"""Wheel on rail, rolling: the state-dependent contact against a linear one, 0 to 4 kHz.

A wheel of 600 kg under 65 kN rolls at 200 km/h on a rail with the roughness of ISO 3095, on the track "x2000"
(asperity's defaults: the thesis prints none). The thesis finds, against a fully linear contact of constant
stiffness and without a filter, less force at low and more at high frequency, so that the linear contact
underestimates A-weighted noise. What is found here depends on which constant stiffness that is:

- k_t = dF/dr at the working load. `shifted` then differs from it by the filter alone: nothing at low
  frequency, ever less at high frequency, 15 dB at 4 kHz and 5 dB(A) in all. `printed` has besides, in every
  band, the texture times k_c/k_t: small motions of F = k_c(r) (r - h) are k_t dr - k_c dh. The thesis'
  statement is *not* reproduced: the linear contact overestimates noise;
- k_c = F/r at the working load, 3.9 dB softer. That is too soft for the motion: too loud at 63 Hz, below the
  resonance of the wheel on the track, and too quiet around and above 1 kHz. Over it, `shifted` has 1 dB less
  at 63 Hz, 2.5 dB more from 1 to 1.6 kHz and, where the filter wins, 11 dB less at 4 kHz, in all 1 dB(A)
  less. `printed` without a filter has 3 to 5 dB less up to 630 Hz and about half a dB more from 1.25 kHz on:
  consistent with the thesis' statement. With the filter the excess is gone, and `printed` has 5 dB(A) less.

What is asserted: from 125 Hz on, `shifted` without a filter is the linear contact of stiffness k_t within
0.3 dB in every band; `printed` without a filter lies 20 lg(k_t/k_c) below it, and the two linear contacts
differ as the receptances of wheel, contact and track say, both within 0.4 dB; the filter takes away more in
every next band; and the signs above.

Run: python wheel_on_rail.py [FOLDER]
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from asperity.kinds.wheel_on_rail.case import WheelOnRail
from asperity.kinds.wheel_on_rail.compute import Computed, compute
from asperity.kinds.wheel_on_rail.linear_reference import mean_square_transfer
from asperity.kinds.wheel_on_rail.roll import roll_wheel
from asperity.kinds.wheel_on_rail.sound_power import rolling_sound_power
from asperity.laws import Law, Linear, Printed
from asperity.reference import cnossos
from asperity.reporting.style import band_axis, styled
from asperity.running import prepare_case
from asperity.spectra import band_levels, psd

CASE = WheelOnRail(
    speed="200 km/h",
    laws=["shifted", "shifted-unfiltered", "printed", "printed-unfiltered", "linear"],
    settling="0.2 s",
    surface={"spectrum": "iso3095"},
    wheel={"roughness": "disc"},
    track={"points": ["10 m"]},
    contact={"linearise": "rough"},
    numerics={"poles": 60},
)
LOWEST, HIGHEST = 63.0, 4000.0  # Hz, band centres
STEADY = 125.0  # Hz; below, sleepers are passed and the resonance of the wheel on the track is sharp
LINES = 5  # of the spectrum, drawn as one
TANGENT, SECANT = "linear, k_t", "linear, k_c"
STYLES = {
    TANGENT: ("#96700a", (0, (3, 1.5))),
    SECANT: ("#1c2126", (0, (3, 1.5))),
    "shifted": ("#c8500a", "-"),
    "shifted-unfiltered": ("#c8500a", (0, (1.5, 1.5))),
    "printed": ("#a8458f", "-"),
    "printed-unfiltered": ("#a8458f", (0, (1.5, 1.5))),
}


class Forces(NamedTuple):
    """PSD, N²/Hz, by law; levels of the bands, dB re 1 N; the stiffnesses, N/m; what the receptances say."""

    frequency: np.ndarray
    density: dict[str, np.ndarray]
    band: np.ndarray
    level: dict[str, np.ndarray]
    tangent: float
    secant: float
    expected: np.ndarray

    def over(self, law: str, base: str) -> np.ndarray:
        """Level of one law over another, dB, by band."""
        return self.level[law] - self.level[base]

    def mean_over(self, law: str, base: str, low: float, high: float) -> float:
        """The same, mean over the bands between two frequencies."""
        inside = (self.band > low / 1.05) & (self.band < high * 1.05)
        return float(self.over(law, base)[inside].mean())


def laws(computed: Computed) -> tuple[dict[str, Law], float, float]:
    """Laws compared, tangent and secant stiffness of the rough contact at the working load, N/m."""
    built = computed.chain.laws
    printed, linear = built["printed"], built["linear"]
    assert isinstance(printed, Printed)
    assert isinstance(linear, Linear)
    secant = linear.force / (linear.approach + printed.datum)
    found: dict[str, Law] = {TANGENT: linear, SECANT: replace(linear, stiffness=secant)}
    return found | {name: law for name, law in built.items() if name != "linear"}, linear.stiffness, secant


def forces(level: float = 0.0) -> Forces:
    case = CASE.with_(surface={"level": level}, wheel={"roughness_level": level})
    computed = compute(prepare_case(case), lambda done, total, message: None)
    compared, tangent, secant = laws(computed)
    segment = round(0.2 / case.time_step)
    density = {}
    for name, law in compared.items():
        run = roll_wheel(
            computed.rail, computed.wheel, law,
            start=case.start, duration=case.duration, settling=case.settling,
        )  # fmt: skip
        frequency, density[name] = psd(run.contact_force, case.time_step, segment=segment)
    levels = {name: band_levels(frequency, d, high=HIGHEST) for name, d in density.items()}
    band = levels[TANGENT][0]
    shown = band > LOWEST / 1.05
    transfers = [
        mean_square_transfer(frequency, computed.wheel, computed.track, k) for k in (secant, tangent)
    ]
    # in each line of the spectrum the softer contact has this much of the stiffer one's power
    softer = density[TANGENT] * transfers[0] / np.where(frequency > 0.0, transfers[1], np.inf)
    expected = band_levels(frequency, softer, high=HIGHEST)[1] - levels[TANGENT][1]
    return Forces(
        frequency, density, band[shown], {n: found[1][shown] for n, found in levels.items()},
        tangent, secant, expected[shown],
    )  # fmt: skip


def a_weighted_change(found: Forces, law: str, base: str) -> float:
    """Change of the sound power of rolling when `law` replaces the linear contact `base`, dB(A)."""
    power = rolling_sound_power(
        200 / 3.6,
        cnossos.rail_roughness("iso3095"),
        cnossos.wheel_roughness("disc"),
        cnossos.track_transfer("medium"),
        cnossos.wheel_transfer("920 mm"),
    )
    inside = (power.band > 150.0) & (power.band < HIGHEST * 1.05)
    power = replace(power, band=power.band[inside], levels=power.levels[:, inside])
    changed = power.with_difference(found.band, found.over(law, base))
    return float((changed.a_weighted - power.a_weighted)[-1])


def draw(found: Forces, file: Path) -> None:
    with styled():
        figure = Figure(figsize=(9.6, 8.4), layout="constrained")
        grid = figure.add_gridspec(2, 2, height_ratios=(1, 1))
        draw_psd(figure.add_subplot(grid[0, :]), found)
        left = figure.add_subplot(grid[1, 0])
        draw_difference(left, found, TANGENT, "Over the linear contact of stiffness k_t = dF/dr")
        right = figure.add_subplot(grid[1, 1], sharey=left)
        draw_difference(right, found, SECANT, "Over the linear contact of stiffness k_c = F/r")
        figure.savefig(file, dpi=150, facecolor="white")


def draw_psd(axes: Axes, found: Forces) -> None:
    lines = LINES * int(HIGHEST / found.frequency[1] / LINES)
    frequency = found.frequency[1 : lines + 1].reshape(-1, LINES).mean(axis=1)
    for name, (colour, dashes) in STYLES.items():
        mean = found.density[name][1 : lines + 1].reshape(-1, LINES).mean(axis=1)
        axes.plot(frequency / 1e3, 10 * np.log10(mean), color=colour, ls=dashes, lw=1.4, label=name)
    axes.set(xlabel="frequency / kHz", ylabel="force PSD / dB re 1 N²/Hz", xlim=(0.0, HIGHEST / 1e3))
    axes.set_title("Contact force at 200 km/h")
    axes.legend(loc="lower left", ncols=3)


def draw_difference(axes: Axes, found: Forces, base: str, title: str) -> None:
    for name, (colour, dashes) in STYLES.items():
        if name != base:
            axes.plot(found.band, found.over(name, base), color=colour, ls=dashes, lw=1.6)
    axes.axhline(0.0, color="0.5", lw=0.8)
    band_axis(axes, found.band)
    axes.set(ylabel="force level difference / dB", title=title)


def main(folder: Path = Path()) -> dict[str, float]:
    found = forces()
    draw(found, folder / "wheel_on_rail.png")
    steady = found.band > STEADY / 1.05
    scale = 20 * np.log10(found.secant / found.tangent)
    filtered = found.over("shifted", "shifted-unfiltered")
    numbers = {
        "tangent_stiffness": found.tangent,
        "secant_stiffness": found.secant,
        "secant_over_tangent": scale,
        "shifted_from_tangent": float(abs(found.over("shifted-unfiltered", TANGENT)[steady]).max()),
        "printed_from_scaled": float(abs(found.over("printed-unfiltered", TANGENT) - scale)[steady].max()),
        "secant_from_receptances": float(abs(found.over(SECANT, TANGENT) - found.expected)[steady].max()),
        "filter_at_125_hz": float(filtered[steady][0]),
        "filter_at_4_khz": float(filtered[-1]),
    }
    for law in ("shifted", "shifted-unfiltered", "printed", "printed-unfiltered"):
        for base in (TANGENT, SECANT):
            key = f"{law} over {base[-3:]}".replace("-", "_").replace(" ", "_")
            numbers[f"{key}_at_63_hz"] = float(found.over(law, base)[0])
            numbers[f"{key}_125_to_630_hz"] = found.mean_over(law, base, 125.0, 630.0)
            numbers[f"{key}_1000_to_1600_hz"] = found.mean_over(law, base, 1000.0, 1600.0)
            numbers[f"{key}_1250_to_4000_hz"] = found.mean_over(law, base, 1250.0, 4000.0)
            numbers[f"{key}_at_4_khz"] = float(found.over(law, base)[-1])
            numbers[f"{key}_a_weighted"] = a_weighted_change(found, law, base)
    assert numbers["shifted_from_tangent"] < 0.3
    assert numbers["printed_from_scaled"] < 0.4
    assert numbers["secant_from_receptances"] < 0.4
    assert np.all(np.diff(filtered[found.band > 950.0]) < 0.0)
    check_signs(numbers)
    return numbers


def check_signs(numbers: dict[str, float]) -> None:
    """Hold the statements to the numbers: less, or more, than the linear contact by at least so many dB."""
    less = {
        "shifted_over_k_t_at_4_khz": 8.0,
        "shifted_over_k_t_a_weighted": 3.0,
        "shifted_over_k_c_at_63_hz": 0.5,
        "shifted_over_k_c_at_4_khz": 3.0,
        "printed_over_k_c_125_to_630_hz": 3.0,
        "printed_over_k_c_a_weighted": 3.0,
        "printed_unfiltered_over_k_c_125_to_630_hz": 3.0,
    }
    more = {
        "shifted_over_k_c_1000_to_1600_hz": 1.0,
        "printed_unfiltered_over_k_c_1250_to_4000_hz": 0.4,
        "printed_unfiltered_over_k_c_a_weighted": 0.1,
    }
    for name, least in less.items():
        assert numbers[name] < -least, f"{name} is not below {-least} dB: {numbers[name]}"
    for name, least in more.items():
        assert numbers[name] > least, f"{name} is not above {least} dB: {numbers[name]}"


if __name__ == "__main__":
    for name, value in main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path()).items():
        print(f"{name} = {value:.4g}")
