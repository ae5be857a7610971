"""Signals measured beside a faulty 6205, and computed ones: lines, side bands, harmonics, pulses.

    python benchmarks/measured_6205.py DATA.npz
    python benchmarks/measured_6205.py --names 1797_OR_at_3_14 1730_B_21 --load 200,0

DATA.npz holds drive-end accelerations in g at 12 kHz from the bearing data of Case Western Reserve
University (an SKF 6205 beside a motor of 2 hp; round pits, 0.28 mm deep), by names of speed in 1/min, place,
and diameter in thousandths of an inch: IR on the inner raceway, B on a ball, OR_at_6, OR_at_3 and OR_at_12 on
the outer one in the middle of the load zone, a quarter turn beside it and opposite. All of them are taken, or
those of --names, which are computed where they are not in the data, too.

Computed is `measured_6205.toml`, a case that `asperity run` takes as well, with that speed, pit and load, by
`table`. Conformities and clearance are those of the named 6205, and the path to the sensor is one resonance
of the outer ring on its housing. The load of the rig is not known: 100 N radially, without and with 100 N
axially, or what --load says. Nothing else can be turned. The same is done to both: the band from 2 to 4 kHz,
its envelope, its lines; harmonics are told by their ranks, as the path decides about levels.
"""

from __future__ import annotations

import argparse
import math
import re
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import asperity
from asperity import BallBearing
from asperity.case.cases import read_case
from asperity.diagnostics import amplitude_spectrum, envelope_spectrum, find_lines

CASE = read_case(Path(__file__).with_suffix(".toml"))
BEARING, RATE, BAND = BallBearing.named("6205"), 12_000.0, (2000.0, 4000.0)
INCH = 25.4e-3
PLACES = {"IR": ("inner", 0), "B": ("ball", 0), "OR_at_6": ("outer", 0), "OR_at_3": ("outer", 90),
          "OR_at_12": ("outer", 180)}  # fmt: skip
"""Part with the pit, and degrees from the load."""
NAME = re.compile(rf"(\d+)_({'|'.join(PLACES)})_(\d+)")
NOISE = 0.02
"""Rms of white noise that a computed signal is given, over its own: lines are told from what is around."""
RISEN = 0.25
"""Share of its peak from which on a pulse has begun."""


def computed(name: str, load: tuple[float, float], duration: float) -> list[np.ndarray]:
    """Accelerations of the outer ring, g, along the load and beside the pit, of a record's name."""
    speed, place, size = NAME.fullmatch(name).groups()
    part, angle = PLACES[place]
    fault = {"on": part, "angle": math.radians(angle), "length": int(size) * 1e-3 * INCH}
    case = CASE.with_(
        speed=int(speed) / 60, radial=load[0], axial=load[1], duration=duration, fault=fault,
        sensors=[0.0, math.radians(angle)],
    )  # fmt: skip
    found = []
    for signal in asperity.run(case, brief=True)["rolling/ring_acceleration"].values[0] / 9.81:
        noise = NOISE * signal.std() * np.random.default_rng(1).standard_normal(signal.size)
        found.append(signal + noise)
    return found


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
    spectrum, other = envelope_spectrum(signal, RATE, BAND), "inner" if part == "outer" else "outer"
    beside = turning.cage if part == "ball" else speed
    family = find_lines(spectrum, turning.tone(part), distance=beside)
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


def row_of(name: str, origin: str, found: Seen) -> str:
    """Line of the table."""
    deviation = 100 * (found.order / found.expected - 1)
    cells = [
        name, origin, f"{found.order:.3f}, {deviation:+.2f} %", f"{found.sides:.2f}", f"{found.other:.3f}",
        found.ranks, f"{found.rise * 1e3:.2f}", f"{found.kurtosis:.1f}",
    ]  # fmt: skip
    return f"| {' | '.join(cells)} |"


def at_rest(load: tuple[float, float], speed: float, angle: float) -> float:
    """Largest static load of a ball at an angle, deg, on the outer ring, N."""
    return float(BEARING.loaded(*load, speed=speed, cage_angles=[math.radians(angle)]).outer_load[0, 0])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("data", type=Path, nargs="?")
    parser.add_argument("--names", nargs="+", default=[], help="of records, as 1797_OR_at_3_14")
    parser.add_argument("--load", action="append", help="radial and axial, N, as 100,100; may be repeated")
    parser.add_argument("--duration", type=float, default=1.0, help="of what is computed, s")
    chosen = parser.parse_args()
    warnings.simplefilter("ignore")
    data = np.load(chosen.data) if chosen.data else {}
    loads = [tuple(map(float, each.split(","))) for each in chosen.load or ["100,0", "100,100"]]
    names = chosen.names or [name for name in data if NAME.fullmatch(name)]
    if wrong := [name for name in names if not NAME.fullmatch(name)]:
        parser.error(f"{wrong[0]}: names are SPEED_PLACE_SIZE, PLACE one of {', '.join(PLACES)}")
    origins = {load: f"{load[0]:g} N, {load[1]:g} N axially" for load in loads}
    firsts: dict[tuple[object, ...], float] = {}
    print("| record | | order, to α = 0 | side bands | other raceway | ranks | rise, ms | kurtosis |")
    print("|---|---|---:|---:|---:|---|---:|---:|")
    for name in names:
        speed, place, _ = NAME.fullmatch(name).groups()
        part, turns = PLACES[place][0], int(speed) / 60
        if name in data:
            found = seen(data[name].astype(float), part, turns)
            firsts[name, "measured", "here"] = found.lines[0]
            print(row_of(name, "measured", found), flush=True)
        for load, origin in origins.items():
            for where, signal in zip(("along", "here"), computed(name, load, chosen.duration), strict=True):
                found = seen(signal, part, turns)
                firsts[name, origin, where] = found.lines[0]
            print(row_of("" if name in data else name, origin, found), flush=True)

    def ratios(title: str, over: str, pairs: list[tuple[str, str]]) -> None:
        shown = [(name, base) for name, base in pairs if name in names and base in names and name != base]
        if not shown:
            return
        print(f"\n{title}\n\n| {over} | measured | {' | '.join(origins.values())} |")
        print(f"|---|---:{'|---:' * len(loads)}|")
        for name, base in shown:
            cells = []
            for origin in ("measured", *origins.values()):
                each = [firsts.get((one, origin, "here")) for one in (name, base)]
                cells.append("–" if None in each else f"{each[0] / each[1]:.3g}")
            for n, load in enumerate(loads, 1):
                speed, place, _ = NAME.fullmatch(name).groups()
                if (angle := PLACES[place][1]) and over == "record":
                    fixed = firsts[name, origins[load], "along"] / firsts[base, origins[load], "along"]
                    pressed = [at_rest(load, int(speed) / 60, each) for each in (angle, 0)]
                    cells[n] += f"; along {fixed:.3g}; load {pressed[0] / pressed[1]:.3g}"
            print(f"| {name} | {' | '.join(cells)} |")

    middle = [(name, re.sub(r"_at_\d+_", "_at_6_", name)) for name in names]
    ratios(
        "First line over that of the same pit at 6 o'clock: seen beside the pit; along the load; and the "
        "largest static load of a ball there over that at 6.", "record", middle
    )  # fmt: skip
    smallest = min((int(name.rpartition("_")[2]) for name in names), default=0)
    sizes = [(name, f"{name.rpartition('_')[0]}_{smallest}") for name in names]
    ratios("First line over that of the smallest pit at the same place.", "larger pit", sizes)
    for part, radius in zip(("inner", "outer"), BEARING.raceway_radii, strict=True):
        passing = 2 * math.pi * radius * BEARING.kinematics(1797 / 60).tone(part) / BEARING.balls
        sizes = sorted({int(name.rpartition("_")[2]) for name in names})
        told = ", ".join(f"{each * INCH / passing:.2f} ms" for each in sizes)
        print(f"\nA ball passes the pits on the {part} raceway in {told} at 1797 1/min.")


if __name__ == "__main__":
    main()
