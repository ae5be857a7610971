"""Whether the working tree gives the answers of a commit: small cases of all kinds, and a surface that wears.

    python benchmarks/same_answers.py ac0672f

Both trees compute the same cases, each with kernels and kept work of its own. Printed is, for each case,
record and law, the largest difference relative to the rms: of contact forces, of a bearing those of both
rings and its acceleration, of friction, and of depths. Where contact is lost a course is chaotic, and
rounding alone grows by orders of magnitude within milliseconds.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

Records = dict[str, tuple[np.ndarray, np.ndarray]]
"""Names of rows, and rows, of each record of a case by its name."""

ROOT = Path(__file__).parents[1]
LAWS = ["areal", "shifted", "table", "printed", "hertz-filtered", "linear"]
TEXTURE = {"rms": "0.05 um", "longest": "0.4 mm", "shortest": "32 um"}
ON_BEAM = {
    "laws": LAWS, "start": "0.3 m", "duration": "10 ms", "settling": "5 ms", "surface": TEXTURE,
    "contact": {"window": "0.4 mm", "spacing": "16 um", "samples": 2, "sample_length": "2 mm"},
}  # fmt: skip
PRESSED = {"radius": "10 mm", "load": "20 N"}
BALL = {"kind": "ball-on-beam", **ON_BEAM, "ball": PRESSED}
WHEEL = {
    "kind": "wheel-on-rail", "speed": "30 m/s", "duration": "50 ms", "settling": "20 ms",
    "laws": ["shifted", "printed", "linear"], "surface": {"spectrum": "iso3095", "level": "-10 dB"},
    "contact": {"spacing": "0.5 mm", "window": "20 mm"}, "numerics": {"poles": 60},
}  # fmt: skip
BODIES = {
    "kind": "bodies", "over": "track", "speed": "30 m/s", "duration": "50 ms", "settling": "20 ms",
    "laws": ["hertz-filtered"], "surface": {"spectrum": "iso3095", "level": "-10 dB"},
    "track": {"name": "nordborg"}, "contact": {"spacing": "0.5 mm", "window": "20 mm"},
    "numerics": {"highest_frequency": "2.5 kHz"},
}  # fmt: skip
BOGIE = {
    "type": "bogie", "distance": "2.5 m", "radius": "0.46 m", "transverse_radius": "inf", "mass": "600 kg",
    "masses": ["1500 kg"], "springs": ["0.6 MN/m"], "dampers": ["10 kN s/m"], "load": "60 kN",
}  # fmt: skip
GUIDE = {
    "kind": "bodies", "over": "plane", "speed": 0.5, "duration": 0.02, "laws": ["hertz-filtered"],
    "surface": {"spectrum": "iso3095", "level": "-48 dB"},
    "body": {
        "type": "carriage", "contacts": 3, "distance": "8 mm", "masses": ["0.6 kg"], "mass": "1 g",
        "radius": "3 mm", "groove_radius": "3.12 mm", "load": "25 N", "inertia": "0.2 g m^2",
    },
    "contact": {"spacing": "8 um", "window": "0.9 mm", "damping": "20 N s/m"},
}  # fmt: skip
BEARING = {
    "kind": "ball-bearing", "laws": ["areal", "table", "hertz"], "speed": "3600 1/min", "axial": "100 N",
    "duration": "40 ms", "settling": "5 ms", "bearing": {"name": "6205"},
    "inner_raceway": {"waviness": "0.5 um"}, "outer_raceway": {"waviness": "0.5 um"},
}  # fmt: skip
FAULTS = BEARING | {
    "radial": "100 N", "rotating": "5 N", "cage_slip": [0.0, 0.01],
    "bearing": {"name": "6205", "preload": "20 N"},
    "fault": [
        {"on": "outer", "length": "0.18 mm", "depth": "0.1 mm"},
        {"on": "inner", "length": "0.2 mm", "depth": "0.1 mm"},
        {"on": "ball", "length": "0.2 mm", "depth": "5 um"},
    ],
}  # fmt: skip
MODES = [[1000.0, 0.01, 300.0], [2500.0, 0.001, 150.0]]  # Hz, damping ratio, kg
CASES = {
    "ball": BALL,
    "ball on a free beam": BALL | {"beam": {"support": "free"}},
    "ball on a clamped beam": BALL | {"beam": {"support": "clamped", "loss_factor": 0.02}},
    "ball, hardness and damping": BALL
    | {"laws": ["areal", "table"], "contact": BALL["contact"] | {"hardness": "3 GPa", "damping": "5 N s/m"}},
    "ball, direct": BALL | {"laws": ["direct"], "duration": "3 ms", "settling": "0 s"},
    "ball that is lifted": BALL | {"surface": TEXTURE | {"rms": "0.3 um"}, "duration": "2 ms"},
    "ball as a body": {"kind": "bodies", "over": "beam", **ON_BEAM, "body": PRESSED},
    "wheel": WHEEL,
    "wheel, scattered rail": WHEEL | {"numerics": {"kernel": "scatter"}},
    "wheel with modes": WHEEL | {"wheel": {"modes": MODES}},
    "wheel, loss factors": WHEEL | {"track": {"name": "nordborg-loss-factor"}},
    "wheel, corrugation": WHEEL | {"surface": {"corrugation_wavelength": "50 mm", "corrugation": "5 um"}},
    "wheel with a flat": WHEEL | {"laws": ["linear", "direct"], "wheel": {"flat_depth": "0.1 mm"}},
    "bogie": BODIES | {"body": BOGIE},
    "guide": GUIDE,
    "bearing": BEARING,
    "bearing, rough": BEARING
    | {"laws": ["areal"]}
    | {"outer_raceway": {"roughness": "20 nm", "shortest": "60 um", "longest": "0.5 mm"}},
    "bearing, faults": FAULTS,
    "bearing, direct": {
        "kind": "ball-bearing",
        "laws": ["direct"],
        "speed": "120000 1/min",
        "radial": "5 N",
        "axial": "60 N",
        "duration": "2.1 ms",
        "settling": "30 us",
        "time_step": "5 us",
        "centrifugal": False,
        "bearing": {
            "balls": 3,
            "ball_diameter": "7.94 mm",
            "pitch_diameter": "39.04 mm",
            "contact_angle": "20 deg",
        },
        "balls": {"waviness": "50 nm"},
        "fault": {"on": "outer", "length": "0.1 mm", "depth": "0.1 mm"},
    },
    "bearing, lobes and slip": BEARING
    | {"laws": ["areal"], "cage_slip": [0.0, 0.01], "housing": {"lobes": 3}, "balls": {"waviness": "50 nm"}},
    "creep": WHEEL | {"laws": ["shifted"], "creep": {"longitudinal": 0.002, "spin": "0.1 rad/m"}},
}
RECORDS = "contact_forces", "contact_force", "ring_acceleration", "friction_force"
"""Names of records in a result, that of earlier versions first."""


def records_of(case: dict[str, Any]) -> Records:
    """Records of the run of a case that are compared, by law."""
    import xarray

    import asperity

    rolling = asperity.run(case)["rolling"].to_dataset()
    if "contact_force" not in rolling and "inner_force" in rolling:  # of earlier versions
        rings = [rolling[f"{ring}_force"].rename(ball="contact") for ring in ("inner", "outer")]
        rolling["contact_force"] = xarray.concat(rings, "contact").transpose("law", "contact", "time")
    there = [name for name in RECORDS if name in rolling]
    return {name: (rolling["law"].values, rolling[name].values) for name in there}


def worn_depths() -> Records:
    """Depths that friction takes from a rough strip under either law of wear."""
    from asperity import ArchardWear, EnergyWear, FrictionalHalfSpace, HalfSpace, material, worn
    from asperity.surfaces.synthesis import self_affine

    x = 0.5e-3 * (np.arange(32) - 15.5)
    wheel = np.add.outer(x**2 / (2 * 0.46), x**2 / (2 * 0.3))
    steel = material("steel")
    half_space = HalfSpace(wheel.shape, 0.5e-3, 0.5 * 210e9 / (1 - 0.3**2))
    rolling = FrictionalHalfSpace(half_space, (steel, steel), 0.3)
    waves = {"rms": 0.5e-6, "hurst": 0.8, "longest": 6e-3, "shortest": 1.5e-3, "seed": 1}
    rail = self_affine((48, 32), (0.5e-3, 0.5e-3), **waves)
    laws = {"energy": EnergyWear(), "archard": ArchardWear(3e9)}
    depths = [
        worn(rolling, rail, wheel, 65e3, law, (0.002, 0.0), passes=20, closed=True, speed=30.0).depth
        for law in laws.values()
    ]
    return {"depth": (np.array(list(laws)), np.array(depths))}


def keep_records(folder: str, only: str) -> None:
    """Compute all cases, and keep their records in a folder."""
    import warnings

    warnings.simplefilter("ignore")
    rings = find_spec("asperity.structures.outline") is not None  # earlier wheels are rigid
    computed: dict[str, Callable[[], Records]] = {}
    for name, case in CASES.items():
        if "modes" in case.get("wheel", {}):
            case = case | {"wheel": {"modes": np.array(MODES)}}
        elif rings and case["kind"] == "wheel-on-rail":
            case = case | {"wheel": {"section": "rigid"} | case.get("wheel", {})}
        computed[name] = partial(records_of, case)
    computed["wear"] = worn_depths
    for name in (name for name in computed if only in name):
        for record, (rows, values) in computed[name]().items():
            np.savez(Path(folder) / f"{name}, {record}.npz", rows=rows, values=values)
        print(name, file=sys.stderr, flush=True)


def main() -> None:
    """Compare."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("commit", nargs="?", default="HEAD", help="what the working tree is compared with")
    parser.add_argument("--only", default="", help="part of the names of the cases that are compared")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        archive = subprocess.run(
            ["git", "archive", arguments.commit, "src"], cwd=ROOT, check=True, capture_output=True
        )
        subprocess.run(["tar", "-x", "-C", folder], input=archive.stdout, check=True)
        for name, source in (("old", Path(folder) / "src"), ("new", ROOT / "src")):
            (own := Path(folder) / name).mkdir()
            places = {"PYTHONPATH": source, "ASPERITY_CACHE": own / "kept"}
            code = f"import same_answers; same_answers.keep_records({str(own)!r}, {arguments.only!r})"
            places["PYTHONPATH"] = f"{source}{os.pathsep}{ROOT / 'benchmarks'}"
            environment = os.environ | {key: str(value) for key, value in places.items()}
            subprocess.run([sys.executable, "-c", code], env=environment, check=True)
        for file in sorted((Path(folder) / "old").glob("*.npz")):
            old, new = np.load(file), np.load(Path(folder) / "new" / file.name)
            for row, before, after in zip(old["rows"], old["values"], new["values"], strict=True):
                first = np.s_[..., : min(before.shape[-1], after.shape[-1])]
                change = np.abs(after[first] - before[first]).max() / np.std(before)
                lost = 100.0 * np.mean(before == 0.0)
                print(f"{file.stem:44} {row:16} {change:9.1e}  out of contact {lost:.0f} %")


if __name__ == "__main__":
    main()
