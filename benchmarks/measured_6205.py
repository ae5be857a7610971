"""Signals measured beside a faulty 6205, and computed ones: lines, side bands, harmonics, pulses.

    python benchmarks/measured_6205.py DATA.npz

DATA.npz holds drive-end accelerations in g at 12 kHz from the bearing data of Case Western Reserve
University (an SKF 6205 beside a motor of 2 hp; round pits of 0.178 and 0.533 mm, 0.28 mm deep, on the outer
raceway in the middle of the load zone or on the inner one), by names such as `1797_OR_at_6_7`.

Computed is the same bearing by `table`, on smooth raceways with the pit: conformities and clearance of the
named 6205, and the path to the sensor as one resonance of the outer ring on its housing, chosen here: 0.3 kg
at 3 kHz, damping ratio 0.03. The load of the rig is not known: 100 N radially, without and with 100 N
axially, also chosen here. Nothing else can be turned. The same is done to both: the band from 2 to 4 kHz, its
envelope, its lines; harmonics are told by their ranks, as the path decides about levels.
"""

from __future__ import annotations

import argparse
import math
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from asperity import BallBearing
from asperity.diagnostics import amplitude_spectrum, envelope_spectrum, find_lines
from asperity.rolling.bearing import BearingRings, roll_bearing
from asperity.scenarios.raceway_laws import raceway_laws, raceway_on
from asperity.structures.ring import Ring
from asperity.surfaces.faults import Fault

BEARING, RATE, BAND = BallBearing.named("6205"), 12_000.0, (2000.0, 4000.0)
SIZES, DEPTH = {"7": 0.178e-3, "21": 0.533e-3}, 0.28e-3
STEP = 1.0 / (RATE * 28)
MASS, RESONANCE, DAMPING_RATIO, CONTACT_DAMPING = 0.3, 3000.0, 0.03, 50.0
NOISE = 0.02
"""Rms of white noise that a computed signal is given, over its own: lines are told from what is around."""
Load = tuple[float, float]  # radial, axial, N
LOADS: dict[str, Load | None] = {"measured": None, "radial": (100.0, 0.0), "and axial": (100.0, 100.0)}
RISEN = 0.25
"""Share of its peak from which on a pulse has begun."""


def computed(part: str, size: float, speed: float, load: Load, duration: float) -> np.ndarray:
    """Acceleration of the outer ring along the load, g, at 12 kHz, with a pit on one raceway."""
    from scipy.signal import resample_poly

    still, both = BEARING.loaded(*load), []
    largest, angle = float(still.outer_load.max()), still.contact_angle if load[1] else 0.0
    contacts = BEARING.inner_contact, BEARING.outer_contact
    for name, contact, radius in zip(("inner", "outer"), contacts, BEARING.raceway_radii, strict=True):
        pits = [Fault("pit", length=size, depth=DEPTH)] if name == part else []
        surface = raceway_on(contact, largest, radius, faults=pits)
        both.append(raceway_laws(["table"], contact, surface, largest, damping=CONTACT_DAMPING)["table"])
    held = MASS * (2 * math.pi * RESONANCE) ** 2
    housing = Ring.rigid(
        MASS, angle, radial_stiffness=held, axial_stiffness=held, damping_ratio=DAMPING_RATIO
    )
    run = roll_bearing(
        BEARING, BearingRings(Ring.rigid(0.5, angle), housing), *both, speed=speed, radial=load[0],
        axial=load[1], duration=duration, settling=0.1, time_step=STEP, sensors=[("outer", 0.0, "radial")],
    )  # fmt: skip
    signal = resample_poly(run.acceleration[0], 1, round(1 / STEP / RATE))[:-1] / 9.81
    noise = NOISE * signal.std() * np.random.default_rng(1).standard_normal(signal.size)
    return signal + noise


@dataclass
class Seen:
    """What is read from a signal of a bearing with a fault on one part."""

    speed: float  # turns/s
    order: float  # of the fault's line, over the speed
    expected: float
    lines: np.ndarray  # envelope at its harmonics, g
    sides: float  # side bands at the speed, over the first line
    other: float  # line of the other raceway over it
    rise: float  # of the mean pulse, s
    kurtosis: float

    @property
    def ranks(self) -> str:
        """Numbers of the harmonics, the largest first."""
        return " ".join(str(n + 1) for n in np.argsort(-self.lines))


def seen(signal: np.ndarray, part: str, nominal: float) -> Seen:
    """Read a signal, whichever it is."""
    shaft = find_lines(amplitude_spectrum(signal, RATE), nominal, harmonics=3)
    speed = nominal * (1.0 + shaft.deviation) if shaft.found else nominal
    turning = BEARING.kinematics(speed, contact_angle=0.0)
    spectrum, other = envelope_spectrum(signal, RATE, BAND), {"inner": "outer", "outer": "inner"}[part]
    family = find_lines(spectrum, turning.tone(part), distance=speed)
    first = family.amplitude[0]
    frequency, amplitude = spectrum
    away = amplitude[abs(frequency - turning.tone(other)) < 0.02 * turning.tone(other)].max() / first
    kurtosis = float(np.mean((signal - signal.mean()) ** 4) / signal.var() ** 2)
    order = turning.tone(part) * (1.0 + family.deviation) / speed
    sides = family.side_bands[0].mean() / first
    rise = rise_of(signal, turning.tone(part))
    return Seen(speed, order, turning.tone(part) / speed, family.amplitude, sides, away, rise, kurtosis)


def rise_of(signal: np.ndarray, passing: float) -> float:
    """Time from the beginning to the peak of the mean pulse, by the envelope, s: from entry to landing."""
    from scipy.signal import find_peaks, hilbert, resample_poly

    finer, fine = 8, 8 * RATE
    envelope = np.abs(hilbert(resample_poly(signal - signal.mean(), finer, 1)))
    before = round(0.4 * fine / passing)
    peaks, _ = find_peaks(envelope, distance=round(0.6 * fine / passing), height=np.quantile(envelope, 0.98))
    peaks = peaks[(peaks > before) & (peaks < envelope.size - before)]
    mean = np.mean([envelope[at - before : at + 1] for at in peaks], axis=0)
    mean -= np.quantile(mean, 0.1)
    return float(np.argmax((mean > RISEN * mean[-1])[::-1] == 0) / fine)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("data", type=Path)
    parser.add_argument("--duration", type=float, default=1.0)
    chosen = parser.parse_args()
    warnings.simplefilter("ignore")
    data, firsts = np.load(chosen.data), {}
    print("| pit, 1/min | | order, to α = 0 | side bands | other raceway | ranks | rise, ms | kurtosis |")
    print("|---|---|---:|---:|---:|---|---:|---:|")
    for part, name in (("outer", "OR_at_6"), ("inner", "IR")):
        for size, length in SIZES.items():
            for minute in (1797, 1730):
                for origin, load in LOADS.items():
                    if load is None:
                        signal = data[f"{minute}_{name}_{size}"].astype(float)
                    else:
                        signal = computed(part, length, minute / 60, load, chosen.duration)
                    found = seen(signal, part, minute / 60)
                    firsts[part, minute, origin, size] = found.lines[0]
                    row = [
                        f"{length * 1e3:.2f} mm, {part}, {minute}" if load is None else "",
                        origin,
                        f"{found.order:.3f}, {100 * (found.order / found.expected - 1):+.2f} %",
                        f"{found.sides:.2f}",
                        f"{found.other:.3f}",
                        found.ranks,
                        f"{found.rise * 1e3:.2f}",
                        f"{found.kurtosis:.1f}",
                    ]
                    print(f"| {' | '.join(row)} |", flush=True)
    print(
        "\n| first line of 0.53 mm over that of 0.18 mm | " + " | ".join(LOADS) + " |\n|---|---:|---:|---:|"
    )
    for part, minute in ((part, minute) for part in ("outer", "inner") for minute in (1797, 1730)):
        both = [firsts[part, minute, each, "21"] / firsts[part, minute, each, "7"] for each in LOADS]
        print(f"| {part}, {minute} | {' | '.join(f'{ratio:.1f}' for ratio in both)} |")
    for part, radius in zip(("inner", "outer"), BEARING.raceway_radii, strict=True):
        passing = 2 * math.pi * radius * BEARING.kinematics(1797 / 60).tone(part) / BEARING.balls
        told = ", ".join(f"{1e3 * length / passing:.2f} ms" for length in SIZES.values())
        print(f"\nA ball passes the {part} pits in {told} at 1797 1/min.")


if __name__ == "__main__":
    main()
