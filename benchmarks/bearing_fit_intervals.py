"""How often intervals of `asperity fit` hold for the load of a bearing, and for its contact angle.

    python benchmarks/bearing_fit_intervals.py --trials 200

A 6205 with a pit of its outer raceway, as in measured_6205.toml, under a radial or an axial load: lines of
its envelope tell either, tones of its parts the axial one, that is, the contact angle. Each trial has a load
and noise of its own. Lines take runs, and a fit some fifty of them: a grid of loads is run once, in some
six minutes of processor, and a fit gets, for each load that it asks, what the nearest one gave; what was
measured comes from loads half way between, so that no trial meets the record that it was made of. An axial
load leaves no jumps: there lines between loads of a coarse grid are found by their logarithms.
"""

from __future__ import annotations

import argparse
import os
import tempfile
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import asperity
from asperity.case.cases import as_case
from asperity.errors import InputError
from asperity.fitting.tried import TriedCase
from asperity.observables.bearings import LINE, NEAR, TONE
from asperity.observables.observable import Measured

CASE = as_case(Path(__file__).with_name("measured_6205.toml")).with_(
    duration="0.2 s", sensors=["0 deg"], time_step=None
)
STARTED = 100.0
"""Load of the case from which a fit begins, N."""
STEP = {"radial": 0.04, "axial": 0.2}
"""Of ln of the loads that are run."""
RUN, TRUE = (6.0, 1000.0), (38.0, 232.0)
"""Loads that a fit may ask, and that are true, N."""
SEED = 57
"""Of loads and noise: others than those by which the curves were chosen."""
HARMONICS = np.arange(1, 6)
TONES = "outer", "inner", "ball"


def under(load: str):
    """The case under one load alone, radial or axial."""
    return CASE.with_(**({"radial": 0.0, "axial": 0.0} | {load: STARTED}))


@dataclass(frozen=True, eq=False)
class Grid:
    """Runs under loads in equal steps of their logarithm: the frequencies of an envelope and its lines."""

    loads: np.ndarray
    frequency: np.ndarray
    lines: np.ndarray  # (loads, frequencies)
    smooth: bool

    @classmethod
    def between(cls, load: str, ends: tuple[float, float], beside: float = 0.0) -> Grid:
        """Run what is not kept yet, so many steps beside those that meet the load of the case."""
        step = STEP[load]
        low, high = (np.log(each / STARTED) / step - beside for each in ends)
        loads = STARTED * np.exp(step * (np.arange(np.ceil(low), np.floor(high) + 1.0) + beside))
        runs = [TriedCase(under(load), {load: each}).collected for each in loads.tolist()]
        frequency = min((each["envelope_frequency"] for each in runs), key=len)
        lines = np.stack([each["envelope"].ravel()[: len(frequency)] for each in runs])
        return cls(loads, frequency, lines, smooth=load == "axial")

    def run(self, load: float) -> dict[str, np.ndarray]:
        """What a run gives of all that is measured: that of the nearest load, or between both."""
        place = np.interp(np.log(load), np.log(self.loads), np.arange(len(self.loads)))
        below = min(int(place), len(self.loads) - 2)
        share = place - below if self.smooth else round(place - below)
        lines = self.lines[below] ** (1.0 - share) * self.lines[below + 1] ** share
        return {"envelope": lines, "envelope_frequency": self.frequency}


@contextmanager
def asked_of(grid: Grid, load: str) -> Iterator[None]:
    """Fits ask a grid in place of a run, and keep nothing that another fit would find."""
    ran, cache = TriedCase.__dict__["collected"], os.environ.get("ASPERITY_CACHE")
    TriedCase.collected = property(lambda trial: grid.run(trial.changes.get(load, STARTED)))
    try:
        with tempfile.TemporaryDirectory() as own:
            os.environ["ASPERITY_CACHE"] = own
            yield
    finally:
        TriedCase.collected = ran
        os.environ.pop("ASPERITY_CACHE")
        if cache is not None:
            os.environ["ASPERITY_CACHE"] = cache


def trials(load: str, count: int, noise: float, told: float | None, grids: list[Grid] | None) -> list[tuple]:
    """True load, value found and its interval, of fits to lines, or without grids to tones, that tell one."""
    case, draws, found = under(load), np.random.default_rng(SEED), []
    for number in range(count):
        true = float(np.exp(draws.uniform(*np.log(TRUE))))
        if grids:
            if not grids[1].smooth:
                true = float(grids[1].loads[number % len(grids[1].loads)])
            run, at = grids[1].run(true), HARMONICS * case.kinematics.tone("outer")
            near = np.abs(run["envelope_frequency"] - at[:, None]) <= NEAR * at[:, None]
            values = np.max(np.where(near, run["envelope"], 0.0), axis=1)
        else:
            turning = case.with_(**{load: true}).kinematics
            values = at = np.array([turning.tone(part) for part in TONES])
        noisy = values * 10.0 ** (0.05 * noise * draws.standard_normal(at.size))
        data = Measured(LINE if grids else TONE, at if grids else noisy, noisy, uncertainty=told)
        try:
            fit = asperity.fit(case, data, [load], starts=None if grids else 1)
            found.append((true, fit.values[load], fit.intervals[load]))
        except InputError:  # the lines leave it open, which is said
            continue
    return found


def coverage(found: list[tuple]) -> str:
    """How many intervals hold the true load, and how far off the loads are that were found."""
    held = [ends is not None and ends[0] <= true <= ends[1] for true, _, ends in found]
    off = np.array([abs(np.log(value / true)) for true, value, _ in found])
    wide = [np.log(ends[1] / ends[0]) / 2.0 for *_, ends in found if ends is not None]
    return (
        f"{sum(held)} of {len(held)} ({100.0 * np.mean(held):.1f} %) | {100.0 * np.median(off):.1f} % "
        f"| {100.0 * np.mean(off > 0.2):.0f} % | ± {100.0 * np.median(wide):.0f} %"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--trials", type=int, default=200, help="of each kind")
    count = parser.parse_args().trials
    print(
        "| load, from | noise | told | intervals that hold it | median off | off by over 20 % | median half |"
    )
    print("|---|---|---|---:|---:|---:|---:|")
    for load in ("radial", "axial"):
        asked = Grid.between(load, RUN)
        grids = [asked, asked if asked.smooth else Grid.between(load, TRUE, 0.5)]
        with asked_of(asked, load):
            for noise, told in ((0.5, 0.5), (1.0, 1.0), (1.0, None)):
                words = f"| {load}, lines | {noise:g} dB | {'yes' if told else 'no'} |"
                print(words, coverage(trials(load, count, noise, told, grids)), "|", flush=True)
    print("| axial, tones | 0.001 dB | yes |", coverage(trials("axial", count, 1e-3, 1e-3, None)), "|")


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    main()
