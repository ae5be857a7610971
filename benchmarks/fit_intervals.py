"""How often intervals of `asperity fit` hold, on decay rates of a real track.

    python benchmarks/fit_intervals.py DATA --trials 200

DATA is the folder of the measured railway. A case has keys near those of its reference; its own computed
vertical decay rates of two rails, with noise as large as rails and dates scatter there, are fitted again.
"""

from __future__ import annotations

import argparse
import warnings
from pathlib import Path

import measured_railway
import numpy as np

import asperity
from asperity.case.bodies import WheelOnRail
from asperity.observables.observable import Measured
from asperity.scenes.measured import HammerTest

RATES = "vertical decay rate"
TRUE = {
    "pad_stiffness": 900e6,
    "pad_loss_factor": 0.25,
    "ballast_stiffness": 60e6,
    "ballast_loss_factor": 1.0,
    "rail_loss_factor": 0.006,
}
"""Near those of the reference."""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("data", type=Path, help="folder of decay_rates.csv")
    parser.add_argument("--trials", type=int, default=200, help="how many tables are made and fitted")
    parser.add_argument("--known", action="store_true", help="the noise is told, not read from both rails")
    given = parser.parse_args()
    scatter = 10.0 / np.log(10.0) * measured_railway.Railway(given.data).scatter["vertical"]
    bands = measured_railway.CENTRES
    case = WheelOnRail(surface={"smooth": True}, track={"name": "uic60"} | TRUE)
    exact = HammerTest.of_track(case.track.model(), bands).decay_rate
    free = {f"track.{name}": measured_railway.FREE[name][:2] for name in TRUE}
    inside, told, draws = dict.fromkeys(free, 0), dict.fromkeys(free, 0), np.random.default_rng(7)
    for _ in range(given.trials):
        noise = scatter * draws.standard_normal((2, len(bands)))
        if given.known:
            rates = exact * 10.0 ** (0.1 * noise.mean(axis=0))
            measured = [Measured(RATES, bands, rates, uncertainty=scatter / np.sqrt(2.0))]
        else:
            measured = [Measured(RATES, bands, exact * 10.0 ** (0.1 * each)) for each in noise]
        found = asperity.fit(case, measured, free, starts=1)
        for name, (low, high) in filter(all, found.intervals.items()):
            told[name] += 1
            inside[name] += low <= TRUE[name.removeprefix("track.")] <= high
    for name in free:
        share = f"{100.0 * inside[name] / told[name]:.0f} %" if told[name] else "never told"
        print(f"{name}: told in {told[name]} of {given.trials}, true value inside in {share}")
    print(f"all: {100.0 * sum(inside.values()) / sum(told.values()):.1f} % of {sum(told.values())}")


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    main()
