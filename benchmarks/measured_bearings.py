"""Bearings with faults, predicted and measured: load, size of the fault, and what the rig adds.

    python benchmarks/measured_bearings.py --predict             # writes measured_bearings.json
    python benchmarks/measured_bearings.py DATA                  # compares it with the records in a folder

DATA is a folder with `mfpt_nice_48k.npz` and `hit_6205_51k.npz`. What is predicted without any record stands
in `measured_bearings.json`: of a NICE bearing whose load grows (MFPT fault data) the growth of the fault's
line, its side bands and its slip; of a 6205 (HIT) the time from a ball's entry into a fault to its landing.
"""

from __future__ import annotations

import argparse
import json
import math
import warnings
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

import asperity
from asperity import BallBearing, BallBearingCase
from asperity.diagnostics.envelopes import analytic_signal

PREDICTED = Path(__file__).with_suffix(".json")
POUND = 4.4482216
FINE = 2**21
"""Length to which an envelope is padded, so that lines are found to a fraction of what a record resolves."""
BAND = (2000.0, 20_000.0)
"""Of the envelope, Hz: wide, as nothing is known of the path."""

# --- MFPT: a fault of a NICE bearing whose load grows

NICE = {"balls": 8, "ball_diameter": 5.97e-3, "pitch_diameter": 31.62e-3}
NICE_RATE, NICE_SPEED = 48_828.0, 25.0
LOADS = (25, 50, 100, 150, 200, 250, 300)
"""Pounds."""
WEIGHT = 10.0
"""N, of the shaft: what is left where no load is applied."""
SIZES = (0.2e-3, 0.5e-3, 1.25e-3)
"""Lengths and widths of the fault, m: it is not described."""
CLEARANCES = (2e-6, 10e-6, 20e-6)
PATHS = ((0.3, 3000.0), (0.3, 6000.0))
"""Mass and frequency of the outer ring on its housing, kg and Hz."""


def nice_case(load: float, part: str, size: float, clearance: float, path: tuple[float, float]) -> Any:
    """A NICE bearing with a pit, under a radial load, N."""
    mass, frequency = path
    stiffness = mass * (2.0 * math.pi * frequency) ** 2
    return BallBearingCase(
        speed=NICE_SPEED, radial=max(load, WEIGHT), laws=["table"], time_step=4.1e-6, settling=0.08,
        duration=0.25 if part == "outer" else 0.4, sampling_rate=NICE_RATE, envelope_band=BAND,
        contact_damping=50.0, bearing=NICE | {"clearance": clearance},
        shaft={"mass": 0.5, "radial_stiffness": 0.0, "axial_stiffness": 0.0},
        housing={
            "mass": mass, "radial_stiffness": stiffness, "axial_stiffness": stiffness, "damping_ratio": 0.03,
        },
        fault={"on": part, "length": size, "depth": 0.3e-3},
    )  # fmt: skip


def lines_of(
    signal: np.ndarray,
    rate: float,
    line: float,
    beside: float,
    slip: float = 0.02,
    band: tuple[float, float] = BAND,
) -> dict[str, float]:
    """First line of the envelope, its frequency to a hundredth of what the record resolves, side bands."""
    envelope = np.abs(analytic_signal(signal - signal.mean(), rate, *band))
    window = np.hanning(envelope.size)
    spectrum = np.abs(np.fft.rfft(2.0 / window.sum() * window * (envelope - envelope.mean()), FINE))
    step, order = rate / FINE, np.arange(1, 6)

    def at(*frequencies: float) -> np.ndarray:
        return spectrum[np.rint(np.array(frequencies) / step).astype(int)]

    tried = np.arange(line * (1.0 - slip), line * (1.0 + slip), 0.5 * step)
    clear = (spectrum[np.rint(np.multiply.outer(tried, order) / step).astype(int)] ** 2).sum(axis=1)
    best = float(tried[np.argmax(clear)])
    harmonics = at(*(order * best))
    sides = at(best - beside, best + beside).mean() if beside else 0.0
    kurtosis = float(np.mean((signal - signal.mean()) ** 4) / signal.var() ** 2)
    return {
        "frequency": best, "line": float(harmonics[0]), "all": float(np.sqrt((harmonics**2).sum())),
        "sides": float(sides / harmonics[0]), "kurtosis": kurtosis,
    }  # fmt: skip


def nice_run(job: tuple[float, str, float, float, tuple[float, float]]) -> dict[str, Any]:
    """What the case of a load, part, size, clearance and path has in its envelope."""
    load, part, size, clearance, path = job
    warnings.simplefilter("ignore")
    case = nice_case(load * POUND, part, size, clearance, path)
    (signal,) = asperity.run(case, brief=True)["rolling/ring_acceleration"].values[0]
    turning = case.kinematics
    found = lines_of(signal / 9.81, NICE_RATE, turning.tone(part), NICE_SPEED, slip=0.002)
    told = {"load": load, "on": part, "size": size, "clearance": clearance, "path": path[1]}
    return told | {name: float(f"{value:.5g}") for name, value in found.items()}


def nice_jobs() -> Iterator[tuple[float, str, float, float, tuple[float, float]]]:
    """All runs: sizes, clearances and paths about the middle one of each."""
    size, clearance, path = SIZES[1], CLEARANCES[1], PATHS[0]
    for part, loads in (("outer", LOADS), ("inner", (0, *LOADS[1:]))):
        for load in loads:
            yield from ((load, part, each, clearance, path) for each in SIZES)
            if load in (0, 25, 100, 300):
                yield from ((load, part, size, each, path) for each in CLEARANCES if each != clearance)
                yield from ((load, part, size, clearance, each) for each in PATHS[1:])


# --- HIT: a ball that crosses a fault of a known angle

HIT = BallBearing.named("6205")
ANGLES, SPEEDS = (2.0, 5.0, 8.0), (600.0, 900.0, 1200.0)
"""Degrees of the raceway, 1/min."""
GRAVITY = 9.81


def crossing(part: str, angle: float, speed: float) -> dict[str, float]:
    """How long a ball takes over a fault of an angle, deg, at a speed, 1/min: s.

    `whole` from edge to edge. `middle`: a ball that is pressed in all the way turns about the one edge
    until it lands on the other. `flight`: a ball on the outer raceway that is let go at the edge, as the
    other balls hold the rings apart, is drawn outwards by its weight and its centrifugal force alone, and
    lands where the far edge's circle meets its parabola; none on the inner raceway, from which both draw it.
    """
    turning = HIT.kinematics(speed / 60.0, contact_angle=0.0)
    outer = HIT.raceway_radii[1]
    past = turning.cage if part == "outer" else turning.inner - turning.cage
    whole = angle / 360.0 / past
    if part == "inner":
        return {"whole": whole, "middle": 0.5 * whole, "flight": whole}
    along = 2.0 * math.pi * past * outer
    relative = 1.0 / (2.0 / HIT.ball_diameter - 1.0 / outer)
    drawn = GRAVITY + 0.5 * HIT.pitch_diameter * (2.0 * math.pi * turning.cage) ** 2
    share = along / (along + math.sqrt(drawn * relative))
    return {"whole": whole, "middle": 0.5 * whole, "flight": share * whole}


def predict(jobs: int) -> dict[str, Any]:
    """All that is said without any record."""
    with ProcessPoolExecutor(jobs) as pool:
        runs = []
        for each in pool.map(nice_run, nice_jobs()):
            print(each, flush=True)
            runs.append(each)
    times = [
        {"on": part, "angle": angle, "speed": speed}
        | {name: float(f"{value:.5g}") for name, value in crossing(part, angle, speed).items()}
        for part in ("outer", "inner")
        for angle in ANGLES
        for speed in SPEEDS
    ]
    return {"mfpt": runs, "hit": times}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("data", type=Path, nargs="?")
    parser.add_argument("--predict", action="store_true")
    parser.add_argument("--jobs", type=int, default=2)
    chosen = parser.parse_args()
    if chosen.predict:
        PREDICTED.write_text(json.dumps(predict(chosen.jobs), indent=1) + "\n")


if __name__ == "__main__":
    main()
