"""Whether the chance that one record tells of its levels is the scatter of records with other textures.

    python benchmarks/level_scatter.py [members]

rolls a ball over a beam and a wheel over a track with as many seeds that nothing was fitted to (30), and
prints for each one-third octave the standard deviation that the runs tell, their scatter, and the ratio of
both. Ends with 1 if any told is below two thirds of the scatter.
"""

from __future__ import annotations

import sys
import warnings

import numpy as np

from asperity import run

FIRST_SEED = 101
CASES = {
    "ball": {
        "kind": "ball-on-beam",
        "laws": ["linear"],
        "surface": {"rms": "0.3 um", "longest": "10 mm", "shortest": "60 um"},
        "ball": {"load": "30 N"},
        "contact": {"spacing": "20 um", "window": "0.76 mm", "linearise": "hertz"},
    },
    "wheel": {
        "kind": "wheel-on-rail",
        "laws": ["linear"],
        "duration": "0.3 s",
        "surface": {"spectrum": "iso3095"},
        "wheel": {"roughness": "disc", "section": "rigid"},
        "contact": {"linearise": "hertz"},
    },
}


def main(members: int) -> int:
    """Print both tables; whether a told chance is too small."""
    warnings.simplefilter("ignore")
    small = 0
    for name, case in CASES.items():
        runs = [run(case | {"seed": FIRST_SEED + k})["spectra"] for k in range(members)]
        scatter = np.std([each["force_level"].values[0] for each in runs], axis=0, ddof=1)
        told = np.sqrt(np.mean([each["level_deviation"].values ** 2 for each in runs], axis=0))
        start = np.mean([each["start_share"].values for each in runs], axis=0)
        print(f"{name}, {members} seeds\n  band/Hz  told/dB  scatter/dB  ratio  start share")
        for row in zip(runs[0]["band"].values, told, scatter, told / scatter, start, strict=True):
            print("  {:7.0f}  {:7.2f}  {:10.2f}  {:5.2f}  {:11.3f}".format(*row))
        small += int(np.sum(told < 2.0 / 3.0 * scatter))
    return 1 if small else 0


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 30))
