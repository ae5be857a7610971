"""How far the table of a wheel moves its force by what is left out of its scan: states, positions and rows.

    python benchmarks/left_out_states.py            # all cases, in some fifteen minutes of processor time
    python benchmarks/left_out_states.py template   # those whose names begin so

Each case is rolled by `table` as it is; with all states at the same positions; and with the same states at a
position in every row, on cells that are one row long. Printed are the differences of the force in one-third
octaves from each of these, rms and at most, and the shares of the contacts and of the time of the law on the
clock that are left.
"""

import argparse
import os
import tempfile
import warnings
from contextlib import ExitStack
from unittest.mock import patch

import numpy as np

from asperity.case.cases import parse_case, template
from asperity.running import prepare_case
from asperity.scenarios import laws, scene
from asperity.scenes.compute import compute

SHORT = {"duration": "0.4 s"}
SELF_AFFINE = SHORT | {"surface.spectrum": None, "surface.lateral": None, "surface.level": None}
CASES = {
    "template, 56 m/s": {},
    "template, 30 m/s": {"speed": "30 m/s"},
    "template, 10 dB louder": {"surface.level": "+10 dB"},
    "83 m/s, another texture": SHORT | {"speed": "83 m/s", "seed": 2},
    "40 m/s, another texture": SHORT | {"speed": "40 m/s", "seed": 3},
    "self-affine, 1 um rms": SELF_AFFINE | {"surface.rms": "1 um"},
    "self-affine, 3 um rms": SELF_AFFINE | {"surface.rms": "3 um"},
    "pads that lose little": SHORT | {"track.pad_loss_factor": 0.02},
}


def every_state(approaches, _):
    """All states, in place of those that tell the force."""
    return list(range(len(approaches)))


def rolled(case):
    """Levels of the force in bands, dB; how many contacts were solved for them; time of the law, s."""
    with tempfile.TemporaryDirectory() as folder, patch.dict(os.environ, ASPERITY_CACHE=folder):
        computed = compute(prepare_case(case), lambda *_: None)
    return np.array(computed.force_levels[0]), computed.scan.counts.solved, computed.seconds["law table"]


def main():
    """Roll the cases that are asked for, and print a line for each thing that is left out."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("name", nargs="?", default="", help="how the names of cases begin")
    asked = parser.parse_args().name
    warnings.simplefilter("ignore")
    left_out = {
        "states": [patch.object(laws, "states_apart", every_state)],
        "positions and rows": [
            patch.object(laws, "table_stride", lambda _: 1),
            patch.object(scene, "long_cells_fit", lambda *_: False),
        ],
    }
    for name, changes in CASES.items():
        if not name.startswith(asked):
            continue
        case = parse_case(template("wheel-on-rail")).with_(laws=["table"], **changes)
        levels, contacts, taken = rolled(case)
        for what, patches in left_out.items():
            with ExitStack() as stack:
                for each in patches:
                    stack.enter_context(each)
                exact, of_all, longer = rolled(case)
            off = levels - exact
            print(
                f"{name:24} {what:18} {np.sqrt(np.mean(off**2)):.3f} dB rms, {np.abs(off).max():.2f} dB at "
                f"most, {contacts / of_all:.2f} of the contacts, {taken / longer:.2f} of the time",
                flush=True,
            )


if __name__ == "__main__":
    main()
