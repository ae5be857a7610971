"""Bearings with faults, predicted and measured: load, size of the fault, and what the rig adds.

    python benchmarks/measured_bearings.py DATA                  # compares the records with it
    python benchmarks/measured_bearings.py --predict anew.json   # predicts anew, beside what was stated

DATA is a folder with `mfpt_nice_48k.npz`, `hit_6205_51k.npz` and `cwru_6205_12k.npz`. Predicted without any
record, in `measured_bearings.json`: of a NICE bearing whose load grows (MFPT fault data) the growth of the
fault's line and its side bands; of a 6205 (HIT) the time from a ball's entry into a fault to its landing; and
what could explain records that were missed, those of a 6205 with pits (CWRU) among them.
"""

from __future__ import annotations

import argparse
import csv
import itertools
import json
import math
import warnings
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

import measured_6205
import numpy as np

import asperity
from asperity import BallBearing, BearingUnderLoad
from asperity.diagnostics.envelopes import band_envelope

NICE_FILE, HIT_FILE, PIT_FILE = "mfpt_nice_48k.npz", "hit_6205_51k.npz", "cwru_6205_12k.npz"
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


def nice_case(
    load: float,
    part: str,
    size: float,
    clearance: float,
    path: tuple[float, float],
    angle: float,
    axial: float,
) -> Any:
    """A NICE bearing with a pit at an angle, deg, from a radial load, N, and a sensor there."""
    mass, frequency = path
    stiffness = mass * (2.0 * math.pi * frequency) ** 2
    return BearingUnderLoad(
        speed=NICE_SPEED, radial=max(load, WEIGHT), axial=axial, laws=["table"], time_step=4.1e-6,
        settling=0.08, duration=0.25 if part == "outer" else 0.4, sampling_rate=NICE_RATE, envelope_band=BAND,
        sensors=[math.radians(angle)], contact_damping=50.0, bearing=NICE | {"clearance": clearance},
        shaft={"mass": 0.5, "radial_stiffness": 0.0, "axial_stiffness": 0.0},
        housing={
            "mass": mass, "radial_stiffness": stiffness, "axial_stiffness": stiffness, "damping_ratio": 0.03,
        },
        fault={"on": part, "length": size, "depth": 0.3e-3, "angle": math.radians(angle)},
    )  # fmt: skip


def lines_of(
    signal: np.ndarray,
    rate: float,
    line: float,
    beside: float,
    slip: float = 0.02,
    band: tuple[float, float] = BAND,
) -> dict[str, Any]:
    """First line of the envelope, its frequency to a hundredth of what the record resolves, side bands."""
    envelope = band_envelope(signal - signal.mean(), rate, *band)
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
        "ranks": " ".join(str(n + 1) for n in np.argsort(-harmonics)),
    }  # fmt: skip


NiceJob = tuple[float, str, float, float, tuple[float, float], float, float]
"""Load, pounds, part, size, clearance, path, angle of the fault, deg, and axial load, N."""


def nice_run(job: NiceJob) -> dict[str, Any]:
    """What the case of a job has in its envelope."""
    load, part, size, clearance, path, angle, axial = job
    warnings.simplefilter("ignore")
    case = nice_case(load * POUND, part, size, clearance, path, angle, axial)
    (signal,) = asperity.run(case, brief=True)["rolling/ring_acceleration"].values[0]
    turning = case.kinematics
    found = lines_of(signal / 9.81, NICE_RATE, turning.tone(part), NICE_SPEED, slip=0.002)
    del found["ranks"]
    told = {"load": load, "on": part, "size": size, "clearance": clearance, "path": path[1], "angle": angle}
    return told | {"axial": axial} | rounded(found)


def rounded(found: dict[str, Any]) -> dict[str, Any]:
    """Numbers as they are written."""
    return {name: value if isinstance(value, str) else float(f"{value:.4g}") for name, value in found.items()}


def nice_jobs() -> Iterator[NiceJob]:
    """All runs: sizes, clearances and paths about the middle one of each."""
    size, clearance, path = SIZES[1], CLEARANCES[1], PATHS[0]
    for part, loads in (("outer", LOADS), ("inner", (0, *LOADS[1:]))):
        for load in loads:
            yield from ((load, part, each, clearance, path, 0.0, 0.0) for each in SIZES)
            if load in (0, 25, 100, 300):
                others = [each for each in CLEARANCES if each != clearance]
                yield from ((load, part, size, each, path, 0.0, 0.0) for each in others)
                yield from ((load, part, size, clearance, each, 0.0, 0.0) for each in PATHS[1:])


def nice_reasons() -> Iterator[NiceJob]:
    """What may explain what was missed: a fault beside the load, a longer one, an axial load, a tight fit."""
    size, clearance, path = SIZES[1], CLEARANCES[1], PATHS[0]
    for load in (25, 100, 300):
        yield load, "outer", size, clearance, path, 70.0, 0.0
        yield load, "outer", size, 30e-6, path, 60.0, 0.0
        yield load, "outer", 2.0 * SIZES[2], clearance, path, 0.0, 0.0
    for load in (0, 100, 300):
        yield load, "inner", size, clearance, path, 0.0, 30.0 + 0.4 * load * POUND
        yield load, "inner", size, -6e-6, path, 0.0, 0.0


# --- CWRU: what a sharp pit under a load that stands still does not explain

REASONS = (
    {}, {"rotating": 35.0}, {"rotating": 85.0}, {"burr": 2e-6}, {"burr": 4e-6}, {"worn": 1e-6},
    {"worn": 2e-6}, {"worn": 2e-6, "rotating": 35.0}, {"worn": 2e-6, "rotating": 85.0}, {"path": 2500.0},
    {"path": 3500.0},
)  # fmt: skip
"""Load that turns, N; height of a burr, and depth to which the surface is worn 0.1 mm around the pit, m;
frequency of the path, 3 kHz else, Hz."""
WORN = 0.1e-3
PIT_BAND = (2000.0, 4000.0)


def pit_case(
    size: int, part: str, *, rotating: float = 0.0, burr: float = 0.0, worn: float = 0.0, path: float = 3e3
) -> Any:
    """The 6205 with a pit, thousandths of an inch, on a raceway, and one thing that is not sharp."""
    case = measured_6205.CASE
    housing = {"mass": case.housing.mass, "damping_ratio": case.housing.damping_ratio}
    stiffness = case.housing.mass * (2.0 * math.pi * path) ** 2
    housing |= {"radial_stiffness": stiffness, "axial_stiffness": stiffness}
    length = size * 1e-3 * measured_6205.INCH
    faults: list[dict[str, Any]] = [{"on": part, "length": length, "depth": 0.28e-3, "burr": burr}]
    if worn:
        faults.append({"on": part, "shape": "mark", "length": length + 2.0 * WORN, "depth": worn})
    return case.with_(
        speed=1797 / 60, radial=100.0, rotating=rotating, duration=0.3, housing=housing, sensors=[0.0],
        fault=faults,
    )  # fmt: skip


def pit_run(job: tuple[int, str, dict[str, float]]) -> dict[str, Any]:
    """The line of a pit at 1797 1/min, and what is beside it."""
    size, part, reason = job
    warnings.simplefilter("ignore")
    case = pit_case(size, part, **reason)
    (signal,) = asperity.run(case, brief=True)["rolling/ring_acceleration"].values[0]
    turning = case.kinematics
    found = lines_of(signal / 9.81, 12e3, turning.tone(part), turning.inner, slip=0.002, band=PIT_BAND)
    return {"pit": size, "on": part} | reason | rounded(found)


def pit_jobs() -> Iterator[tuple[int, str, dict[str, float]]]:
    """Both outer pits with each reason, and all pits sharp and worn."""
    yield from ((size, "outer", reason) for reason in REASONS for size in (7, 21))
    for reason in WEAR:
        yield 14, "outer", reason
        yield from ((size, "inner", reason) for size in (7, 14, 21))


WEAR: tuple[dict[str, float], ...] = ({}, {"worn": 1e-6}, {"worn": 2e-6})


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


def told(found: Iterator[dict[str, Any]]) -> list[dict[str, Any]]:
    """All of them, each shown as it comes."""
    kept = []
    for each in found:
        print(each, flush=True)
        kept.append(each)
    return kept


def predict(jobs: int) -> dict[str, Any]:
    """All that is said without any record."""
    with ProcessPoolExecutor(jobs) as pool:
        pits = told(pool.map(pit_run, pit_jobs()))
        reasons = told(pool.map(nice_run, nice_reasons()))
        runs = told(pool.map(nice_run, nice_jobs()))
    times = [
        {"on": part, "angle": angle, "speed": speed}
        | {name: float(f"{value:.5g}") for name, value in crossing(part, angle, speed).items()}
        for part in ("outer", "inner")
        for angle in ANGLES
        for speed in SPEEDS
    ]
    return {"mfpt": runs, "hit": times, "mfpt_reasons": reasons, "cwru_reasons": pits}


# --- held against the records


def padded(values: np.ndarray) -> np.ndarray:
    """Amplitudes of a signal on `FINE` places."""
    window = np.hanning(values.size)
    return np.abs(np.fft.rfft(2.0 / window.sum() * window * (values - values.mean()), FINE))


def speed_of(signal: np.ndarray, rate: float, nominal: float) -> float:
    """Speed whose harmonics are highest in the signal and its envelope, over what is around, 1/s."""
    step, order = rate / FINE, np.arange(1, 6)
    tried = np.arange(0.98 * nominal, 1.02 * nominal, step)
    places, clear = np.rint(np.multiply.outer(tried, order) / step).astype(int), np.zeros(tried.size)
    for values in (signal, band_envelope(signal - signal.mean(), rate, *BAND)):
        spectrum = padded(values)
        around = [np.median(spectrum[int(0.9 * at) : int(1.1 * at)]) for at in order * nominal / step]
        clear += np.log(np.maximum(spectrum[places] / around, 1.0)).sum(axis=1)
    return float(tried[np.argmax(clear)])


def nice_seen(data: Any) -> dict[str, dict[float, dict[str, float]]]:
    """What each record of the NICE bearing holds, by part and load."""
    turning = BallBearing(**NICE).kinematics(NICE_SPEED, contact_angle=0.0)
    found: dict[str, dict[float, dict[str, float]]] = {"outer": {}, "inner": {}}
    for name in data:
        part, load = name.removesuffix("lb").split("_")
        signal = data[name].astype(float)
        speed = speed_of(signal, NICE_RATE, NICE_SPEED)
        seen = lines_of(signal, NICE_RATE, turning.tone(part) * speed / NICE_SPEED, speed)
        cage = seen["frequency"] / speed / turning.balls
        slip = 1.0 - (cage if part == "outer" else 1.0 - cage) / (turning.cage / NICE_SPEED)
        found[part][float(load)] = seen | {"speed": speed, "slip": slip}
    return found


def predicted_range(runs: list[dict[str, Any]], part: str, load: float, what: str, over: float) -> np.ndarray:
    """A quantity by all sizes, clearances and paths, over that at another load of the same, or itself."""
    fixed = ("on", "size", "clearance", "path")

    def all_at(of: float) -> dict[tuple[Any, ...], float]:
        return {tuple(r[n] for n in fixed): r[what] for r in runs if r["on"] == part and r["load"] == of}

    here = all_at(load)
    if not over:
        return np.array(list(here.values()))
    there = all_at(over)
    return np.array([value / there[key] for key, value in here.items()])


def onsets(signal: np.ndarray, rate: float, whole: float) -> np.ndarray:
    """How much more energy follows each instant than came before it, from a factor of two on, logarithmic.

    Before are 0.3 of the time from edge to edge, s, and 0.4 ms at most; after it is a quarter of that.
    """
    energy = band_envelope(signal - signal.mean(), rate, *BAND) ** 2
    before = round(min(0.3 * whole, 4e-4) * rate)
    after = max(2, before // 4)
    done = np.concatenate([[0.0], np.cumsum(energy)])
    ahead, behind = ((done[n:] - done[:-n]) / n for n in (after, before))
    count = energy.size - after - before
    ahead, behind = ahead[before : before + count], behind[:count]
    floor = 0.02 * np.quantile(ahead, 0.99)
    found = np.log((ahead + floor) / (behind + floor))
    return np.where(found > math.log(2.0), found, 0.0)


def apart(signal: np.ndarray, rate: float, whole: float) -> tuple[np.ndarray, np.ndarray]:
    """Lags up to 1.3 of the time from edge to edge, s, and how onsets correlate with themselves there."""
    found = onsets(signal, rate, whole)
    found = found - found.mean()
    size = 2 ** math.ceil(math.log2(2 * found.size))
    correlation = np.fft.irfft(np.abs(np.fft.rfft(found, size)) ** 2, size)[: round(1.3 * whole * rate)]
    return np.arange(correlation.size) / rate, correlation / correlation[0]


def second_pulse(signal: np.ndarray, rate: float, whole: float) -> tuple[float, float]:
    """Lag of the highest peak of that correlation, s, NaN where none stands out, and its height.

    Sought from 0.3 to 1.15 of the time from edge to edge, s.
    """
    lag, correlation = apart(signal, rate, whole)
    inside = np.flatnonzero((lag > 0.3 * whole) & (lag < 1.15 * whole))
    at = inside[np.argmax(correlation[inside])]
    stands = correlation[at] > CLEAR and inside[0] < at < inside[-1]
    return (float(lag[at]) if stands else math.nan), float(correlation[at])


CLEAR = 0.07
"""Correlation from which on a second pulse stands out."""


def relative_radius(part: str) -> float:
    """Of a ball and a raceway along the path, m."""
    inner, outer = HIT.raceway_radii
    return 1.0 / (2.0 / HIT.ball_diameter + (1.0 / inner if part == "inner" else -1.0 / outer))


def let_go(part: str, load: float) -> float:
    """How much shorter than from edge to edge a ball is free, m: on either side it touches until it is out by
    the approach of both its contacts, sqrt(2 R delta) from the edge."""
    carried = float(HIT.loaded(load).outer_load.max())
    return 2.0 * math.sqrt(2.0 * relative_radius(part) * (carried / HIT.series_stiffness) ** (2.0 / 3.0))


def hit_seen(data: Any) -> list[dict[str, Any]]:
    """What each record of the 6205 holds."""
    found = []
    for name in data:
        rig, fault, speed = name.split("_")
        if fault == "Normal":
            continue
        part, angle = ("outer" if fault.startswith("OR") else "inner"), float(fault[2:])
        signal, times = data[name].astype(float), crossing(part, angle, float(speed))
        lag, height = second_pulse(signal, HIT_RATE, times["whole"])
        length = math.radians(angle) * HIT.raceway_radii[RINGS.index(part)]
        lost = (1.0 - lag / times["whole"]) * length
        told = {"rig": rig, "on": part, "angle": angle, "speed": float(speed), "lag": lag, "height": height}
        found.append(told | times | {"lost": lost, "length": length})
    return found


HIT_RATE = 51_200.0
RINGS = ("inner", "outer")


# --- what is said of records that are not in the folder, given those that are


def rest_of_nice(nice: dict[str, dict[float, dict[str, float]]]) -> Iterator[list[str]]:
    """Rows of loads between: straight lines over the load between neighbours, of the logarithm for levels."""
    for part, records in nice.items():
        for load in REST:
            base = records[100.0]["line"]

            def between(of: Any, load: float = load, records: Any = records) -> float:
                return float(
                    np.interp(load, sorted(records), [of(records[each]) for each in sorted(records)])
                )

            over = math.exp(between(lambda seen: math.log(seen["line"]))) / base
            slip, line = 100 * between(lambda seen: seen["slip"]), between(lambda seen: seen["frequency"])
            sides, wide = between(lambda seen: seen["sides"]), SPREAD[part]
            yield [
                f"{part}, {load:g} lb", f"{line:.2f} ± {LINE_OFF:g}", f"{slip:+.2f} ± {SLIP_OFF:g}",
                f"{over:.2f} ({over / wide:.2f}–{over * wide:.2f})",
                f"{sides:.2f} ± {SIDES_OFF:g}" if part == "inner" else "–",
            ]  # fmt: skip


REST = (50.0, 150.0, 200.0, 250.0)
"""Pounds."""
SPREAD = {"outer": 1.8, "inner": 1.5}
"""Factor about a predicted line that holds four records of five: chosen, as no load was measured twice."""
LINE_OFF, SLIP_OFF, SIDES_OFF = 0.25, 0.25, 0.14
"""Hz, per cent, and over the line, likewise."""


def rest_of_hit(seen: list[dict[str, Any]]) -> Iterator[list[str]]:
    """Rows of the angles and speeds that are not there: what is lost at 8 degrees is lost at all."""
    known = {(r["rig"], r["on"], r["angle"], r["speed"]) for r in seen}
    for (rig, part), angle in itertools.product(RIGS, (5.0, 2.0, 8.0)):
        lost = lost_on(seen, rig, part)
        for speed in SPEEDS:
            if (rig, part, angle, speed) in known:
                continue
            whole = crossing(part, angle, speed)["whole"]
            length = math.radians(angle) * HIT.raceway_radii[RINGS.index(part)]
            time, off = 1e3 * whole * max(1.0 - lost / length, 0.5), ANGLE_OFF[angle]
            yield [
                f"{rig}, {part} {angle:g}°, {speed:g} 1/min", f"{1e3 * whole:.3f}", f"{time:.3f}",
                f"{time * (1 - off):.3f}–{time * (1 + off):.3f}",
            ]  # fmt: skip


RIGS = ("mfs", "outer"), ("mfs", "inner"), ("own", "outer"), ("own", "inner")


def lost_on(seen: list[dict[str, Any]], rig: str, part: str) -> float:
    """What a ball loses on a rig and raceway, m, by its faults of 8 degrees; else by those of the other one.

    It goes as the square root of the relative radius (`let_go`).
    """
    on = part if any((r["rig"], r["on"]) == (rig, part) for r in seen) else RINGS[1 - RINGS.index(part)]
    own = np.mean([r["lost"] for r in seen if (r["rig"], r["on"], r["angle"]) == (rig, on, 8.0)])
    return float(own) * math.sqrt(relative_radius(part) / relative_radius(on))


ANGLE_OFF = {2.0: 0.25, 5.0: 0.08, 8.0: 0.04}
"""Share about a predicted time that holds four records of five: 0.2 degrees of the fault, 0.08 mm of what is
lost, and of the shortest that the second pulse hardly stands out."""


# --- tables


def table(head: str, rows: Any) -> None:
    """Print a table of Markdown."""
    columns = head.split(" | ")
    print(f"\n| {head} |\n|---{'|---:' * (len(columns) - 1)}|")
    for row in rows:
        print(f"| {' | '.join(row)} |")


def nice_rows(
    nice: dict[str, dict[float, dict[str, float]]], runs: list[dict[str, Any]]
) -> Iterator[list[str]]:
    """Measured beside what was stated."""
    for part, records in nice.items():
        for load, seen in sorted(records.items()):
            lines = predicted_range(runs, part, load, "line", 100)
            sides = predicted_range(runs, part, load, "sides", 0)
            said = f"{sides.min():.2f}–{sides.max():.2f}" if part == "inner" else "0"
            yield [
                f"{part}, {load:g} lb", f"{seen['speed']:.2f}", f"{seen['frequency']:.2f}",
                f"{100 * seen['slip']:+.2f}", f"{seen['line']:.3f}",
                f"{seen['line'] / records[100.0]['line']:.2f}", f"{lines.min():.2f}–{lines.max():.2f}",
                f"{seen['sides']:.2f}", said, f"{seen['kurtosis']:.1f}",
            ]  # fmt: skip


def hit_rows(seen: list[dict[str, Any]]) -> Iterator[list[str]]:
    """Measured beside what was stated, and beside a ball that is let go by the load that the rig has."""
    for each in seen:
        clear = math.isfinite(each["lag"])
        share = max(1.0 - let_go(each["on"], RIG_LOAD) / each["length"], 0.5)
        measured = each["lag"] / each["whole"]
        found = [f"{1e3 * each['lag']:.3f}", f"{measured:.2f}"] if clear else ["–", "–"]
        yield [
            f"{each['rig']}, {each['on']} {each['angle']:g}°, {each['speed']:g} 1/min",
            f"{1e3 * each['whole']:.3f}", *found, f"{each['height']:.2f}",
            f"{each['flight'] / each['whole']:.2f}", f"{share:.2f}",
            f"{each['lost'] * 1e3:.2f}" if clear else "–",
        ]  # fmt: skip


RIG_LOAD = 5.0 * GRAVITY
"""N, of the rig `mfs`, as stated."""


def reason_rows(held: dict[str, Any], data: Any) -> Iterator[list[str]]:
    """Both pits and their ratio: measured, and for each candidate."""
    turning = HIT.kinematics(1797 / 60, contact_angle=0.0)
    pits: dict[str, list[dict[str, Any]]] = {}
    for size in (7, 21):
        signal = data[f"1797_OR_at_6_{size}"].astype(float)
        given = signal, 12e3, turning.tone("outer"), turning.inner, 0.02, PIT_BAND
        pits.setdefault("measured", []).append(lines_of(*given))
    for reason in REASONS:
        name = ", ".join(WRITTEN[key](value) for key, value in reason.items()) or "sharp, load still, 3 kHz"
        pits[name] = [pit_of(held, size, "outer", reason) for size in (7, 21)]
    for name, (small, large) in pits.items():
        yield [
            name, f"{small['line']:.2f}", f"{large['line']:.2f}", f"{large['line'] / small['line']:.2f}",
            f"{small['sides']:.2f}", f"{large['sides']:.2f}", small["ranks"], large["ranks"],
            f"{small['kurtosis']:.1f}", f"{large['kurtosis']:.1f}",
        ]  # fmt: skip


WRITTEN = {
    "rotating": lambda force: f"{force:g} N turn with the shaft",
    "burr": lambda height: f"a burr of {height * 1e6:g} µm",
    "worn": lambda depth: f"worn by {depth * 1e6:g} µm around",
    "path": lambda frequency: f"path of {frequency / 1e3:g} kHz",
}


def pit_of(held: dict[str, Any], size: int, part: str, reason: dict[str, float]) -> dict[str, Any]:
    """The run of a pit with a reason."""
    same = (r for r in held["cwru_reasons"] if (r["pit"], r["on"]) == (size, part))
    return next(r for r in same if {name: r[name] for name in WRITTEN if name in r} == reason)


def wear_rows(held: dict[str, Any], data: Any) -> Iterator[list[str]]:
    """Lines of larger pits over that of the smallest at the same place, sharp and worn, and measured."""
    turning = HIT.kinematics(1797 / 60, contact_angle=0.0)
    for part, place in (("outer", "OR_at_6"), ("inner", "IR")):

        def measured(size: int, part: str = part, place: str = place) -> float:
            signal = data[f"1797_{place}_{size}"].astype(float)
            return float(lines_of(signal, 12e3, turning.tone(part), turning.inner, 0.02, PIT_BAND)["line"])

        for size in (14, 21):
            found = [
                pit_of(held, size, part, reason)["line"] / pit_of(held, 7, part, reason)["line"]
                for reason in WEAR
            ]
            known = f"1797_{place}_{size}" in data
            told = f"{measured(size) / measured(7):.2f}" if known else "not in the folder"
            name = f"{part}, {size * 1e-3 * measured_6205.INCH * 1e3:.2f} mm over 0.18 mm"
            yield [name, told, *(f"{each:.2f}" for each in found)]


def periodic_rows(data: Any) -> Iterator[list[str]]:
    """How much of the envelope's power the fault's lines and their side bands hold, which debris does not."""
    turning = HIT.kinematics(1797 / 60, contact_angle=0.0)
    for name in ("OR_at_6_7", "OR_at_6_21", "IR_7", "IR_21"):
        part, signal = ("outer" if name.startswith("OR") else "inner"), data[f"1797_{name}"].astype(float)
        line = lines_of(signal, 12e3, turning.tone(part), turning.inner, 0.02, PIT_BAND)["frequency"]
        envelope = band_envelope(signal - signal.mean(), 12e3, *PIT_BAND)
        power = np.abs(np.fft.rfft(envelope - envelope.mean())) ** 2
        frequency, shaft = np.fft.rfftfreq(envelope.size, 1.0 / 12e3), speed_of(signal, 12e3, turning.inner)
        shares, near = list[str](), np.zeros(frequency.size, dtype=bool)
        for most in (0, 4):
            for order in range(int(PIT_BAND[0] / line)):
                width = 0.6 + 0.15 * order  # Hz: a slip of 0.15 % moves the harmonics by so much
                for beside in range(-most, most + 1):
                    centre = order * line + beside * shaft
                    near |= (abs(frequency - centre) < width) & (frequency > 0.0)
            shares += [f"{power[near].sum() / power[1:].sum():.2f}", f"{near.mean():.2f}"]
        yield [f"1797 {name}", *shares]


def nice_reason_rows(held: dict[str, Any]) -> Iterator[list[str]]:
    """Candidates for the records of MFPT."""
    for r in held["mfpt_reasons"]:
        yield [
            f"{r['on']}, {r['load']:g} lb", f"{r['size'] * 1e3:g} mm", f"{r['clearance'] * 1e6:g} µm",
            f"{r['angle']:g}°", f"{r['axial']:.0f} N", f"{r['line']:.3f}", f"{r['sides']:.2f}",
        ]  # fmt: skip


def ledger_rows(
    nice: Any, seen: list[dict[str, Any]], held: dict[str, Any], data: Any
) -> Iterator[tuple[str, str, str, str, str]]:
    """What CONFORMANCE.md says of it: what, whose records, measured, computed, and the deviation."""
    for each in (each for each in seen if math.isfinite(each["lag"])):
        free = max(1.0 - let_go(each["on"], RIG_LOAD) / each["length"], 0.5) * each["whole"]
        name = f"6205, {each['angle']:g}° of the {each['on']} raceway, {each['speed']:g} 1/min"
        yield (
            f"{name}, rig {each['rig']}: from entry to landing", "HIT-SM", f"{1e3 * each['lag']:.3f} ms",
            f"{1e3 * free:.3f} ms, let go by 49 N", f"{100 * (free / each['lag'] - 1):+.0f} %",
        )  # fmt: skip
    outer, beside = nice["outer"], nice["inner"][100.0]["sides"]
    lines = predicted_range(held["mfpt"], "outer", 300, "line", 100)
    sides = predicted_range(held["mfpt"], "inner", 100, "sides", 0)
    growth = outer[300.0]["line"] / outer[100.0]["line"]
    yield (
        "NICE bearing: outer line at 300 lb over that at 100 lb", "MFPT", f"{growth:.2f}",
        f"{lines.min():.2f} to {lines.max():.2f}, blind", f"a factor of {growth / lines.max():.1f} or more",
    )  # fmt: skip
    yield (
        "NICE bearing, 100 lb: side bands of the inner line over it", "MFPT", f"{beside:.2f}",
        f"{sides.min():.2f} to {sides.max():.2f}, blind", f"{sides.min() - beside:+.2f} or more",
    )  # fmt: skip
    for load in (25.0, 100.0, 300.0):
        slip = outer[load]["slip"]
        yield (
            f"NICE bearing, {load:g} lb: line of the outer raceway over pure rolling", "MFPT",
            f"{1.0 - slip:.4f}", f"1 less 0 to {25.0 / load:.2f} %, blind", f"{100 * slip:+.2f} % of slip",
        )  # fmt: skip
    rows = {row[0]: row for row in reason_rows(held, data)}
    measured = rows["measured"]
    chosen = "sharp, load still, 3 kHz", "worn by 2 µm around", "85 N turn with the shaft"
    for name in chosen:
        after = "" if name == chosen[0] else ", chosen afterwards"
        for column, what in ((3, "outer line of 0.53 mm over that of 0.18 mm"), (5, "side bands of 0.53 mm")):
            off = float(rows[name][column]) - float(measured[column])
            yield f"6205, {what}: {name}", "CWRU", measured[column], rows[name][column] + after, f"{off:+.2f}"


def beside_rows(stated: list[dict[str, Any]], anew: list[dict[str, Any]]) -> Iterator[list[str]]:
    """What was stated of each load beside what is computed anew: ranges, and the largest change of a line.

    Runs are the same by all that was given, one to one.
    """
    given = ("load", "on", "size", "clearance", "path", "angle", "axial")
    ran = [{tuple(r[name] for name in given): r["line"] for r in runs} for runs in (stated, anew)]
    if ran[0].keys() != ran[1].keys() or len(ran[0]) != len(stated):
        raise ValueError("runs anew are not those that were stated")
    for part, load in dict.fromkeys((r["on"], r["load"]) for r in stated):
        words = [f"{part}, {load:g} lb"]
        for what, over in (("line", 100), ("sides", 0)):
            # clearances and paths were run at some loads alone: sizes are common to all
            ranges = [predicted_range(alike(runs), part, load, what, over) for runs in (stated, anew)]
            words += [f"{found.min():.2f}–{found.max():.2f}" for found in ranges]
        moved = [ran[1][key] / ran[0][key] - 1.0 for key in ran[0] if (key[1], key[0]) == (part, load)]
        yield [*words, f"{100 * max(moved, key=abs):+.0f} %"]


def alike(runs: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Runs of the middle clearance and path."""
    return [r for r in runs if (r["clearance"], r["path"]) == (CLEARANCES[1], PATHS[0][1])]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("data", type=Path, nargs="?", help="folder of the records")
    parser.add_argument("--predict", type=Path, help="file that takes what is predicted, computed anew")
    parser.add_argument("--held", type=Path, default=PREDICTED, help="file of what was predicted")
    parser.add_argument("--ledger", type=Path, help="file of rows for CONFORMANCE.md")
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    chosen = parser.parse_args()
    if chosen.predict:
        chosen.predict.write_text(json.dumps(predict(chosen.jobs), indent=1) + "\n")
    held = json.loads(chosen.held.read_text())
    if chosen.predict:
        anew = json.loads(chosen.predict.read_text())["mfpt"]
        head = (
            "record | line over 100 lb, stated | anew | side bands, stated | anew | largest change of a line"
        )
        table(head, beside_rows(held["mfpt"], anew))
    if not chosen.data:
        return
    nice = nice_seen(np.load(chosen.data / NICE_FILE))
    seen, pits = hit_seen(np.load(chosen.data / HIT_FILE)), np.load(chosen.data / PIT_FILE)
    table(
        "record | speed, 1/s | line, Hz | slip, % | line, g | over 100 lb | stated | side bands | stated "
        "| kurtosis",
        nice_rows(nice, held["mfpt"]),
    )
    table("not in the folder | line, Hz | slip, % | line over 100 lb | side bands", rest_of_nice(nice))
    table(
        "record | edge to edge, ms | measured | share | height | flight | let go | lost, mm", hit_rows(seen)
    )
    table("not in the folder | edge to edge, ms | predicted, ms | 80 %", rest_of_hit(seen))
    table(
        "NICE, record | fault | clearance | beside the load | axial | line, g | side bands",
        nice_reason_rows(held),
    )
    table(
        "CWRU, outer | 0.18 mm, g | 0.53 mm, g | ratio | side bands | of 0.53 mm | ranks | of 0.53 mm "
        "| kurtosis | of 0.53 mm",
        reason_rows(held, pits),
    )
    table("CWRU, first line | measured | sharp | worn by 1 µm | worn by 2 µm", wear_rows(held, pits))
    table(
        "CWRU, record | power in lines | of all frequencies | with side bands | of all frequencies",
        periodic_rows(pits),
    )
    if chosen.ledger:
        rows = [("what", "source", "measured", "computed", "deviation"), *ledger_rows(nice, seen, held, pits)]
        with chosen.ledger.open("w", encoding="utf-8", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows(rows)


if __name__ == "__main__":
    main()
