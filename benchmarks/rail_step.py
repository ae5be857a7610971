# ruff: noqa: E402 (the threads are set before numpy is imported)
"""Time a step of the wheel on the rail, against scattering the moving kernel.

The track's kernel, its poles and the laws are prepared beforehand (not timed; the laying-out of a law on
the path is reported beside). Timed is the rolling alone: rail, wheel and contact of every time step. The
same law rolls with the rail as poles and as the explicit scatter of its kernel, which is how time-domain
models with impulse responses do it; both in one run, best of the rounds. CPU time of one thread.
With a figure, the time of a step against the number of poles, too.

    python benchmarks/rail_step.py --figure benchmarks/growth_poles.svg
"""

from __future__ import annotations

import os

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"

import argparse
import time

import numpy as np
from numpy.typing import ArrayLike
from step_clock import Clock

from asperity import Hertz as HertzContact
from asperity.laws import HertzLaw, Law, Linear, Shifted, Table
from asperity.reduction.filter import filtered_texture
from asperity.reduction.stiffness import ForceCurve, ForceTable
from asperity.reduction.texture import StateTexture
from asperity.reference import cnossos
from asperity.rolling.roll import roll_bodies
from asperity.structures.body import Body
from asperity.structures.moving_kernel import MovingKernel, moving_kernel
from asperity.structures.rail_poles import RailBetween, RailPoles, rail_poles
from asperity.structures.track import Track
from asperity.surfaces.bands import from_bands

SPEED, STEP, LOAD, MASS = 56.0, 40e-6, 65e3, 600.0  # m/s, s (25 kHz), N, kg
STATES = 14
SPACING = 1e-3  # of the texture, m


class LaidOut:
    """A law laid out on the path once."""

    def __init__(self, law: Law, positions: ArrayLike) -> None:
        began = time.process_time()
        self.prepared = law.prepare(positions)
        self.seconds = time.process_time() - began
        self.name, self.damping = law.name, law.damping

    def prepare(self, positions: ArrayLike) -> object:
        """The same arrays in every round."""
        return self.prepared


def laws(duration: float) -> dict[str, Law]:
    """The laws over one line of ISO 3095 roughness, filtered in as many states as a case has."""
    hertz = HertzContact(210e9 / (2 * (1 - 0.3**2)), 0.46, 0.30)
    approach = hertz.approach(LOAD)
    states = approach * np.linspace(0.1, 3.0, STATES)
    wavelengths, levels = (v[7:29] for v in cnossos.rail_roughness("iso3095"))
    points = int((duration * SPEED + 2.0) / SPACING)
    heights = from_bands(points, SPACING, wavelengths, levels, 1).heights
    plain = StateTexture.unfiltered(-heights, SPACING, -1.0)
    filters = np.zeros((STATES, 41))
    for i, s in enumerate(states):
        half = min(20, max(1, round(hertz.semi_axes(s)[0] / SPACING)))
        window = np.hanning(2 * half + 3)[1:-1]
        filters[i, 20 - half : 21 + half] = window / window.sum()
    filtered = filtered_texture(heights, SPACING, filters, states, -1.0)
    force = np.array([hertz.force(s) for s in states])
    following = np.array([[hertz.force(s + h) for h in heights] for s in states])
    curve = ForceCurve.from_samples(np.append(0.0, states), np.append(0.0, force))
    return {
        "linear": Linear(LOAD, hertz.tangent_stiffness(approach), approach, plain),
        "hertz": HertzLaw(hertz.stiffness_constant, plain),
        "shifted": Shifted(curve, filtered),
        "table": Table(ForceTable(following, states, -1.0, SPACING, -heights)),
    }


def timed(rail: RailPoles | MovingKernel, law: LaidOut, duration: float) -> float:
    """CPU time per step, s."""
    clock = Clock()
    roll_bodies(
        RailBetween(rail, {}), [Body.rigid(MASS, LOAD)], [law], positions=[0.0], start=0.0, duration=duration,
        speed=SPEED, time_step=STEP, progress=clock,
    )  # type: ignore[arg-type] # fmt: skip
    return clock.seconds_per_step


def with_poles(kernel: MovingKernel, count: int, most: int = 100) -> RailPoles:
    """A rail of so many poles: fitted, and beyond the most that are, those again and again in equal shares.

    Such a rail moves as the fitted one does, and costs what as many different poles would.
    """
    fitted = rail_poles(kernel, min(count, most))
    times = max(1, count // most)
    residues = np.tile(fitted.residues, (1, times)) / times
    return RailPoles(kernel, np.tile(fitted.poles, times), residues, fitted.fit_error, fitted.static_error)


def draw(path: str, kernel: MovingKernel, law: LaidOut, duration: float, rounds: int) -> None:
    """Measure how the time of a step grows with the poles, and draw it."""
    import matplotlib.pyplot as plt

    rails = [with_poles(kernel, count) for count in (24, 50, 100, 200, 400, 800, 1600, 3200)]
    best = np.full(len(rails) + 1, np.inf)
    for _ in range(rounds):
        best = np.minimum(best, [timed(rail, law, duration) for rail in (*rails, kernel)])
    count, seconds = np.array([rail.count for rail in rails]), best[:-1]
    print("\npoles: " + ", ".join(f"{n}: {1e6 * t:.3f}" for n, t in zip(count, seconds, strict=True)) + " µs")
    print(f"scatter: {1e6 * best[-1]:.3f} µs")
    figure, axis = plt.subplots(figsize=(4.2, 3.2), layout="constrained")
    axis.loglog(count, 1e6 * seconds, "o-", label="measured")
    axis.loglog(count, 1e6 * seconds[-1] * count / count[-1], "--", color="0.5", label="linear")
    axis.axhline(1e6 * best[-1], linestyle=":", color="0.5", label=f"scatter, {kernel.weights.shape[1]} taps")
    axis.set_xlabel("poles")
    axis.set_ylabel("CPU time of a step, µs")
    axis.set_xticks(count, [str(n) for n in count], minor=False)
    axis.minorticks_off()
    axis.legend(frameon=False)
    figure.savefig(path)


def main() -> None:
    """Print a table: µs per step and ratios."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--duration", type=float, default=10.0, help="simulated time, s")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--poles", type=int, nargs="+", default=[40, 100, 200])
    parser.add_argument("--figure", metavar="FILE", help="measure growth with poles, too, and draw it here")
    options = parser.parse_args()
    track = Track.named("nordborg")
    kernel = moving_kernel(track, SPEED, STEP)
    rails = {f"{count} poles": rail_poles(kernel, count) for count in options.poles}
    taps = kernel.weights.shape[1]
    for name, rail in rails.items():
        print(f"{name}: {len(rail.poles)} kept of conjugate pairs, kernel error {rail.fit_error:.1e}")
    print(f"scatter: {taps} taps ({taps * kernel.time_step:.2f} s)\n")
    positions = SPEED * STEP * np.arange(int(options.duration / STEP * (1 + 1e-12)) + 1)
    print("| law | rail | µs per step | simulated/wall time | scatter/poles | laying-out, µs per step |")
    print("|---|---|---:|---:|---:|---:|")
    for name, law in laws(options.duration).items():
        LaidOut(law, positions[:100])  # compiles
        laid_out = LaidOut(law, positions)
        timed(kernel, laid_out, options.duration)  # compiles
        best = dict.fromkeys([*rails, "scatter"], np.inf)
        for _ in range(options.rounds):
            for label, rail in {**rails, "scatter": kernel}.items():
                best[label] = min(best[label], timed(rail, laid_out, options.duration))
        for label, seconds in best.items():
            ratio = f"{best['scatter'] / seconds:.0f}" if label != "scatter" else "–"
            columns = [f"{1e6 * seconds:.3f}", f"{STEP / seconds:.0f}", ratio]
            columns.append(f"{1e6 * laid_out.seconds / len(positions):.2f}")
            print(f"| `{name}` | {label} | {' | '.join(columns)} |")
    if options.figure:
        hertz = LaidOut(laws(options.duration)["hertz"], positions)
        draw(options.figure, kernel, hertz, options.duration, options.rounds)


if __name__ == "__main__":
    main()
