"""How far every contact law is from `direct`, the 3-D contact solved in every time step (slow).

For an ensemble of paths (one per seed, surface and samples drawn anew) a ball rolls over a beam with every
law. Compared are one-third-octave levels of the contact force, 100 Hz to 5 kHz, from band energies averaged
over the ensemble; the correlation of the time signals with `direct`; and the share of time out of contact.
The tables are Markdown. `table` should stay within 0.3 dB of `direct` in permanent contact and within 1 dB
where contact is intermittent.

    python benchmarks/table_against_direct.py --load 30 --rms 0.05 --seeds 10     # permanent
    python benchmarks/table_against_direct.py --load 5 --rms 0.02 --seeds 10      # permanent, light
    python benchmarks/table_against_direct.py --load 5 --rms 0.15 --seeds 20      # intermittent
"""

from __future__ import annotations

import argparse
import json
import sys
import time
import warnings
from collections import Counter
from dataclasses import dataclass, field

import numpy as np

from asperity.case.beam import BallOnBeam
from asperity.case.cases import parse_case
from asperity.errors import PhysicsWarning
from asperity.progress import progress_bar
from asperity.running import prepare_case
from asperity.scenes.compute import Computed, compute
from asperity.spectra import band_levels, psd

LAWS = [
    "direct", "table", "areal", "shifted", "printed", "hertz-filtered", "hertz", "linear-filtered", "linear",
]  # fmt: skip
LOW, HIGH = 100.0, 5000.0  # Hz


@dataclass
class Ensemble:
    """What the paths so far have shown; arrays have one row per path, then per law."""

    centres: np.ndarray | None = None
    energies: list[np.ndarray] = field(default_factory=list)
    correlations: list[np.ndarray] = field(default_factory=list)
    losses: list[np.ndarray] = field(default_factory=list)
    unconverged: int = 0
    steps: int = 0

    def add(self, computed: Computed) -> None:
        """Add a path."""
        runs = computed.runs
        step = computed.case.time_step
        force = np.stack([runs[law].contact_force[0] for law in LAWS])
        segment = min(force.shape[1], round(0.1 / step))
        self.centres, levels = band_levels(*psd(force, step, segment=segment), low=LOW, high=HIGH)
        self.energies.append(10 ** (levels / 10))
        self.correlations.append(np.corrcoef(force)[0])
        self.losses.append(np.array([1.0 - runs[law].in_contact.mean() for law in LAWS]))
        self.unconverged += runs["direct"].unconverged_steps
        self.steps += force.shape[1] - 1

    @property
    def differences(self) -> np.ndarray:
        """Levels of the mean band energies relative to `direct`, dB, shape (laws, bands)."""
        levels = 10 * np.log10(np.mean(self.energies, axis=0))
        return np.asarray(levels - levels[0])


def case_of(options: argparse.Namespace, seed: int) -> BallOnBeam:
    """One member of the ensemble."""
    return parse_case(
        f"""
        kind = "ball-on-beam"
        laws = {json.dumps(LAWS)}
        seed = {seed}
        start = "0.4 m"
        duration = "{options.duration} s"
        [surface]
        rms = "{options.rms} um"
        longest = "0.4 mm"
        shortest = "{options.shortest} um"
        [ball]
        load = "{options.load} N"
        [contact]
        spacing = "{options.spacing} um"
        window = "{options.window} mm"
        samples = {options.samples}
        """
    )


def report(options: argparse.Namespace, ensemble: Ensemble, caught: Counter[str]) -> None:
    """Print the validity table and the bands."""
    difference = ensemble.differences
    loss = 100 * np.mean(ensemble.losses, axis=0)
    correlation = np.mean(ensemble.correlations, axis=0)
    print(
        f"\nLoad {options.load:g} N, texture {options.rms:g} um rms, {len(ensemble.energies)} paths of "
        f"{options.duration:g} s, window {options.window:g} mm; unconverged steps of direct: "
        f"{ensemble.unconverged} of {ensemble.steps}"
    )
    print("Warnings: " + (", ".join(f"{n} x {name}" for name, n in caught.items()) or "none") + "\n")
    print("| law | largest difference, dB | rms difference, dB | correlation | out of contact, % |")
    print("|---|---:|---:|---:|---:|")
    for i, law in enumerate(LAWS):
        worst = difference[i][np.argmax(np.abs(difference[i]))]
        rms = np.sqrt(np.mean(difference[i] ** 2))
        print(f"| `{law}` | {worst:+.2f} | {rms:.2f} | {correlation[i]:.4f} | {loss[i]:.2f} |")
    print("\nDifference of the band levels to direct, dB\n")
    print("| band, Hz | " + " | ".join(LAWS[1:]) + " |")
    print("|---:|" + "---:|" * (len(LAWS) - 1))
    assert ensemble.centres is not None
    for centre, row in zip(ensemble.centres, difference[1:].T, strict=True):
        print(f"| {centre:.0f} | " + " | ".join(f"{x:+.2f}" for x in row) + " |")


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--load", type=float, default=30.0, help="N")
    parser.add_argument("--rms", type=float, default=0.05, help="um")
    parser.add_argument("--seeds", type=int, default=5, help="paths in the ensemble")
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--duration", type=float, default=0.3, help="s of each path")
    parser.add_argument("--samples", type=int, default=4, help="surface samples for the state functions")
    parser.add_argument("--spacing", type=float, default=12.0, help="of the contact grid, um")
    parser.add_argument("--shortest", type=float, default=32.0, help="wavelength of the texture, um")
    parser.add_argument("--window", type=float, default=0.65, help="mm")
    options = parser.parse_args()
    ensemble, caught = Ensemble(), Counter[str]()
    for seed in range(options.first_seed, options.first_seed + options.seeds):
        began = time.perf_counter()
        with warnings.catch_warnings(record=True) as messages, progress_bar() as progress:
            warnings.simplefilter("always", PhysicsWarning)
            ensemble.add(compute(prepare_case(case_of(options, seed)), progress))
        caught.update(message.category.__name__ for message in messages)
        table = ensemble.differences[LAWS.index("table")]
        print(
            f"seed {seed}: {time.perf_counter() - began:.0f} s; table so far within "
            f"{np.max(np.abs(table)):.2f} dB of direct",
            file=sys.stderr,
        )
    report(options, ensemble, caught)


if __name__ == "__main__":
    main()
