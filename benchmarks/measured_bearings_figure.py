"""Figure of docs/evidence/measured_bearings.md: what was stated, what is measured, what is said of the rest.

python benchmarks/measured_bearings_figure.py DATA docs/evidence/measured_bearings.png
"""

from __future__ import annotations

import argparse
import json
import math
import re
from pathlib import Path
from typing import Any

import matplotlib as mpl
import measured_bearings as study
import numpy as np

mpl.use("Agg")
import matplotlib.pyplot as plt

STATED, MEASURED, REST = "#0067a5", "#be0032", "#555555"
SHADE = {"color": STATED, "alpha": 0.2, "lw": 0.0}
TOP = 0.42
"""Of vertical lines, below the legend."""
FULL = 8.0
"""Degrees of the faults that are drawn."""


def shaded(axes: Any, loads: tuple[int, ...], stated: list[np.ndarray]) -> None:
    """Shade what was stated over the load."""
    least, most = [each.min() for each in stated], [each.max() for each in stated]
    axes.fill_between(loads, least, most, label="stated before", **SHADE)


def growth(axes: Any, nice: Any, runs: list[dict[str, Any]]) -> None:
    """The outer line over the load."""
    shaded(
        axes, study.LOADS, [study.predicted_range(runs, "outer", each, "line", 100) for each in study.LOADS]
    )
    records = nice["outer"]
    over = [records[load]["line"] / records[100.0]["line"] for load in sorted(records)]
    axes.plot(sorted(records), over, "o", color=MEASURED, label="measured")
    for row in list(study.rest_of_nice(nice))[: len(study.REST)]:
        load = float(row[0].split()[1])
        middle, low, high = map(float, re.findall(r"[0-9.]+", row[3]))
        axes.plot([load, load], [low, high], color=REST)
        axes.plot(load, middle, "_", color=REST, ms=9)
    axes.plot([], [], color=REST, label="said of records that are not there, 80 %")
    axes.set(yscale="log", ylabel="line over that at 100 lb", title="MFPT: growth of the outer line")
    axes.set_yticks([0.5, 1, 2, 5], ["0.5", "1", "2", "5"])
    axes.minorticks_off()


def slips(axes: Any, nice: Any) -> None:
    """Slip of the cage over the load."""
    axes.fill_between(study.LOADS, 0.0, [25.0 / load for load in study.LOADS], label="stated before", **SHADE)
    for part, marker in (("outer", "o"), ("inner", "s")):
        loads = sorted(nice[part])
        slip = [100.0 * nice[part][each]["slip"] for each in loads]
        filled = MEASURED if part == "outer" else "none"
        axes.plot(loads, slip, f"{marker}-", color=MEASURED, lw=0.8, mfc=filled, label=f"by the {part} line")
    axes.axhline(0.0, color=REST, lw=0.6)
    axes.set(ylabel="slip of the cage, %", title="MFPT: slip, at a contact angle of zero")


def side_bands(axes: Any, nice: Any, held: dict[str, Any]) -> None:
    """Side bands of the inner line over the load."""
    loads = (0, *study.LOADS[1:])
    shaded(axes, loads, [study.predicted_range(held["mfpt"], "inner", each, "sides", 0) for each in loads])
    records = nice["inner"]
    axes.plot(sorted(records), [records[load]["sides"] for load in sorted(records)], "o", color=MEASURED)
    axial = [run for run in held["mfpt_reasons"] if run["on"] == "inner" and run["axial"]]
    found = [run["sides"] for run in axial]
    axes.plot(
        [run["load"] for run in axial], found, "--", color=STATED, label="30 N and 0.4 of the load axially"
    )
    axes.set(ylabel="side bands over the line", ylim=(0, 1), title="MFPT: side bands of the inner line")


def second_pulses(axes: Any, data: Any) -> None:
    """Onsets of pulses over a fault, correlated with themselves."""
    names = {
        "mfs_OR8_600": STATED,
        "mfs_OR8_1200": MEASURED,
        "own_OR8_1200": "#e68fac",
        "mfs_IR8_1200": "#2b3d26",
    }
    for name, colour in names.items():
        rig, fault, speed = name.split("_")
        part = "outer" if fault.startswith("OR") else "inner"
        times = study.crossing(part, FULL, float(speed))
        lag, found = study.apart(data[name].astype(float), study.HIT_RATE, times["whole"])
        label = f"{rig}, {part} {FULL:g}°, {speed} 1/min"
        axes.plot(lag / times["whole"], found, color=colour, lw=1.0, label=label)
        if part == "outer":
            axes.vlines(times["flight"] / times["whole"], -0.05, TOP, color=colour, ls=":", lw=1.0)
    for part in study.RINGS:
        length = math.radians(FULL) * study.HIT.raceway_radii[study.RINGS.index(part)]
        axes.vlines(
            1.0 - study.let_go(part, study.RIG_LOAD) / length, -0.05, TOP, color=REST, ls="--", lw=1.0
        )
    axes.plot([], [], ":", color=REST, label="stated before: free flight")
    axes.plot([], [], "--", color=REST, label="let go by 49 N, inner and outer")
    axes.set(xlabel="lag over the time from edge to edge", ylabel="correlation of onsets", xlim=(0.2, 1.25))
    axes.set(ylim=(-0.05, 0.7), title="HIT: from the first pulse to the second")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("data", type=Path)
    parser.add_argument("figure", type=Path)
    chosen = parser.parse_args()
    held = json.loads(study.PREDICTED.read_text())
    nice = study.nice_seen(np.load(chosen.data / study.NICE_FILE))
    mpl.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
    figure, axes = plt.subplots(2, 2, figsize=(10.0, 7.5), layout="constrained")
    growth(axes[0, 0], nice, held["mfpt"])
    slips(axes[0, 1], nice)
    side_bands(axes[1, 0], nice, held)
    second_pulses(axes[1, 1], np.load(chosen.data / study.HIT_FILE))
    for each in axes.flat[:3]:
        each.set_xlabel("load, lb")
    for each in axes.flat:
        each.legend(frameon=False, loc="upper left", fontsize=8)
    axes[0, 1].legend(frameon=False, loc="upper right", fontsize=8)
    axes[1, 0].legend(frameon=False, loc="lower right", fontsize=8)
    figure.savefig(chosen.figure, dpi=110, metadata={"Software": None})


if __name__ == "__main__":
    main()
