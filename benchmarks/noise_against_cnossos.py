"""Numbers of docs/railway/noise.md: sound power from vibration against CNOSSOS-EU, radiation of the rail.

    python benchmarks/noise_against_cnossos.py     # tables, noise.png, noise_wheel.png, noise_rail.png

In the frequency domain, without rolling: sound power level per axle less roughness level, linear contact.
The transfer functions of CNOSSOS-EU are the same quantity. Nothing is fitted.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np

from asperity import Track, Wheel
from asperity.radiation.track import (
    SPEED_OF_SOUND,
    RailSection,
    SleeperTop,
    squared_mobility,
    squared_point_mobility,
)
from asperity.radiation.wheel import RadiatingWheel
from asperity.reference import cnossos
from asperity.reference.materials import MATERIALS
from asperity.reference.railways import SECTIONS
from asperity.reporting.chart import BLUE, GREEN, INK, VERMILLION, Axis, Chart, Line, Panel
from asperity.reporting.figure import write_chart
from asperity.reporting.panels import frequency_axis
from asperity.scenarios.scene import force_transfer
from asperity.scenes.cnossos_power import rolling_sound_power
from asperity.spectra import a_weighted_total, nominal
from asperity.store import Store
from asperity.structures.outline import WheelSection
from asperity.structures.wheel_modes import BEYOND, wheel_modes

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "radiation"))
from exact_fields import INSIDE_60E1, SECTION_60E1, mirrored, power_per_length

BANDS = 10.0 ** (np.arange(17, 38) / 10.0)  # 50 Hz to 5 kHz
WITHIN = 10.0 ** (0.1 * (np.arange(25) - 12.0) / 25.0)
PADS = {"soft": 225e6, "medium": 447e6, "hard": 894e6}  # as printed; geometric means of the classes
LOAD, STIFFNESS = 50e3, 1.143e9  # N; of Hertz's contact under it, radii of 0.46 m and 0.3 m
SPEED = 100.0 / 3.6
COLOURS = {"soft": BLUE, "medium": GREEN, "hard": VERMILLION}
DASHED = (3.7, 1.6)
TRANSFER = "sound power per axle − roughness / dB"


def track(pads: float) -> Track:
    """Ballasted track of Math. Probl. Eng. 2017, 5872419, table 1, with other pads."""
    area, density, moment = 7.745e-3, 7750.0, 3.217e-5
    return Track(
        bending_stiffness=210e9 * moment,
        mass_per_length=density * area,
        shear_stiffness=80.8e9 * area * 0.5329,
        rotary_inertia=density * moment,
        rail_loss_factor=0.02,  # not printed there
        pad_stiffness=pads,
        pad_loss_factor=0.25,
        sleeper_mass=170.0,
        ballast_stiffness=20e6,
        ballast_loss_factor=1.0,
        sleeper_spacing=0.55,
    )


def transfer(pads: float) -> dict[str, np.ndarray]:
    """Sound power level per axle less roughness level, dB re 1 pW and 1 µm, of rail, sleepers and both."""
    body, wheel = track(pads), Wheel(600.0, LOAD)
    f = (BANDS[:, None] * WITHIN).ravel()
    section = RailSection(0.150, 0.072, 7.745e-3)

    def spread(x):
        return np.abs(force_transfer(f, wheel.receptance, body, STIFFNESS, x)) ** 2

    node, weight = np.polynomial.legendre.leggauss(30)
    square = 0.5 * weight @ spread(0.5 * body.sleeper_spacing * (node + 1.0))
    parts = {
        "rail": section.power_per_force(body, f, spread),
        "sleepers": SleeperTop(2.6, 0.25).power_per_force(body, f, spread),
    }
    power = {
        name: np.mean((2.0 * part * square).reshape(len(BANDS), -1), axis=1) for name, part in parts.items()
    }
    power["track"] = power["rail"] + power["sleepers"]
    return {name: 10.0 * np.log10(each) for name, each in power.items()}  # (1 µm)² over 1 pW is 1 m²/W


def total(levels: np.ndarray) -> float:
    """A-weighted sound power of a track, dB, at 100 km/h, roughnesses and contact filter of CNOSSOS-EU."""
    silent = np.full(len(BANDS), -200.0)
    _, power = rolling_sound_power(
        SPEED,
        cnossos.rail_roughness("iso3095"),
        cnossos.wheel_roughness("disc"),
        (BANDS, levels),
        (BANDS, silent),
        contact_filter=cnossos.contact_filter("50 kN, 920 mm"),
    )
    return float(a_weighted_total(power[0], BANDS))


def wheel_transfer(pads: float, section: str) -> np.ndarray:
    """As `transfer`, of the two wheels of an axle, of a named section, that turn."""
    outline = WheelSection.named(section).outline(0.46)
    modes = wheel_modes(outline, MATERIALS["steel"], BEYOND * 5e3, cache=Store())
    body, table = track(pads), modes.turning(SPEED / 0.46).table()
    wheel = Wheel(600.0, LOAD, *table[:, :3].T)
    radiator = RadiatingWheel(0.46, 0.135, *table[:, 3:].T)
    f = (BANDS[:, None] * 10.0 ** (0.1 * (np.arange(400) - 199.5) / 400.0)).ravel()
    node, weight = np.polynomial.legendre.leggauss(12)
    places = 0.5 * body.sleeper_spacing * (node + 1.0)
    square = 0.5 * weight @ np.abs(force_transfer(f, wheel.receptance, body, STIFFNESS, places)) ** 2
    omega, natural = 2.0 * np.pi * f, 2.0 * np.pi * table[:, :1]
    answer = 1.0 / (table[:, 2:3] * (natural**2 - omega**2 + 2j * table[:, 1:2] * natural * omega))
    power = radiator.power(f, np.abs(omega * answer) ** 2 * 2.0 * square).sum(axis=0)
    return 10.0 * np.log10(np.mean(power.reshape(len(BANDS), -1), axis=1))


def panel(label: str, low: float, high: float, *lines: Line, **place: Any) -> Panel:
    """Lines over one-third octaves, between two levels."""
    ends = (float(edge * 10.0**step) for edge, step in ((lines[0].x[0], -0.05), (lines[0].x[-1], 0.05)))
    return Panel(frequency_axis(*ends, "one-third octave / Hz"), Axis(label, low, high), lines, **place)


def against_cnossos() -> None:
    """Print and draw our transfers beside those of the directive."""
    ours = {name: transfer(pads) for name, pads in PADS.items()}
    theirs = {name: cnossos.track_transfer(name)[1][: len(BANDS)] for name in PADS}
    print("| band / Hz | rail | sleepers | track | CNOSSOS-EU | difference | soft − hard | CNOSSOS-EU |")
    print("|---:|---:|---:|---:|---:|---:|---:|---:|")
    medium = ours["medium"]
    for i, band in enumerate(BANDS):
        change, label = (
            ours["soft"]["track"][i] - ours["hard"]["track"][i],
            theirs["soft"][i] - theirs["hard"][i],
        )
        cells = [medium["rail"][i], medium["sleepers"][i], medium["track"][i], theirs["medium"][i]]
        signed = [medium["track"][i] - theirs["medium"][i], change, label]
        row = [f"{cell:.1f}" for cell in cells] + [f"{cell:+.1f}" for cell in signed]
        print(f"| {nominal(band):g} | " + " | ".join(row) + " |")
    print("\n| pads | rail | sleepers | track | CNOSSOS-EU |\n|---|---:|---:|---:|---:|")
    for name in PADS:
        parts = [total(ours[name][part]) for part in ("rail", "sleepers", "track")]
        cells = [f"{cell:.1f}" for cell in (*parts, total(theirs[name]))]
        print(f"| {name}, {PADS[name] / 1e6:.0f} MN/m | " + " | ".join(cells) + " |")
    tracks = []
    for name, colour in COLOURS.items():
        tracks.append(Line(BANDS, ours[name]["track"], f"{name}, {PADS[name] / 1e6:.0f} MN/m", colour))
        tracks.append(Line(BANDS, theirs[name], f"{name}, CNOSSOS-EU", colour, DASHED))
    parts = [
        Line(BANDS, ours[name][part], f"{part}, {name} pads", COLOURS[name], dashes, marker=marker)
        for part, marker, dashes in (("rail", "o", ()), ("sleepers", "s", DASHED))
        for name in ("soft", "hard")
    ]
    left = panel(TRANSFER, 40, 125, *tracks, title="Track", height=4.2)
    right = panel(TRANSFER, 40, 125, *parts, title="Rail and sleepers", height=4.2, beside=True)
    write_chart(Chart((left, right)), "", Path("noise.png"))


def wheel_against_cnossos() -> None:
    """Print and draw the wheel beside that of the directive."""
    ours = {name: wheel_transfer(PADS["medium"], name) for name in SECTIONS}
    theirs = cnossos.wheel_transfer("920 mm")[1][: len(BANDS)]
    differences = " | ".join(["difference"] * len(ours))
    print(f"\n| band / Hz | {' | '.join(ours)} | CNOSSOS-EU, 920 mm | {differences} |")
    print("|---:|" + "---:|" * (2 * len(ours) + 1))
    for k, band in enumerate(BANDS):
        cells = [f"{own[k]:.1f}" for own in ours.values()] + [f"{theirs[k]:.1f}"]
        cells += [f"{own[k] - theirs[k]:+.1f}" for own in ours.values()]
        print(f"| {nominal(band):g} | {' | '.join(cells)} |")
    heard = ", ".join(f"{name} {total(own):.1f}" for name, own in ours.items())
    print(f"\nA-weighted, as the tracks: {heard}, CNOSSOS-EU {total(theirs):.1f} dB(A)")
    drawn = (
        *(
            Line(BANDS, own, name, colour, marker="o")
            for (name, own), colour in zip(ours.items(), COLOURS.values(), strict=True)
        ),
        Line(BANDS, theirs, "CNOSSOS-EU, 920 mm", INK, DASHED),
    )
    write_chart(Chart((panel(TRANSFER, 20, 125, *drawn, title="Two wheels"),)), "", Path("noise_wheel.png"))


def radiation_of_the_rail() -> None:
    """Print and draw the radiation ratio of a 60E1 section by boundary elements, and by the model."""
    bands = 10.0 ** (np.arange(20, 38) / 10.0)
    section = RailSection(0.150, 0.072, 60.21 / 7850.0)
    field = []
    for band in bands:
        at = band * 10.0 ** (0.1 * (np.arange(5) - 2.0) / 5.0)
        found = [
            power_per_length(mirrored(SECTION_60E1), INSIDE_60E1, 2 * np.pi * f / SPEED_OF_SOUND, 3e-3)
            for f in at
        ]
        field.append(np.mean(found) / section.radiating_width)
    model, exact = 10 * np.log10(section.radiation_ratio(bands)), 10 * np.log10(field)
    print("\n| band / Hz | boundary elements / dB | model / dB | difference |\n|---:|---:|---:|---:|")
    for band, computed, own in zip(bands, exact, model, strict=True):
        print(f"| {nominal(band):g} | {computed:.1f} | {own:.1f} | {own - computed:+.1f} |")
    drawn = (
        Line(bands, exact, "boundary elements, section 60E1", INK, marker="o"),
        Line(bands, model, "model: dipole, then both faces of the foot", VERMILLION),
    )
    write_chart(Chart((panel("10 lg radiation ratio / dB", -30, 6, *drawn),)), "", Path("noise_rail.png"))


if __name__ == "__main__":
    against_cnossos()
    wheel_against_cnossos()
    radiation_of_the_rail()
    given = track(PADS["medium"]), [500.0, 1000.0, 2000.0]
    length = squared_mobility(*given) / squared_point_mobility(*given)
    print("\nEffective lengths at 500, 1000, 2000 Hz:", ", ".join(f"{each:.1f} m" for each in length))
