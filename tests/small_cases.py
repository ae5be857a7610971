"""A small real run of each kind of case, as small as the chain goes."""

import numpy as np
from xarray import DataTree

from asperity.case.cases import as_case
from asperity.schema import UNKNOWN, group

ON_BEAM = {
    "duration": "20 ms",
    "settling": "0 s",
    "surface": {"rms": "0.04 um", "longest": "0.4 mm", "shortest": "60 um"},
    "contact": {"spacing": "20 um", "window": "0.66 mm", "samples": 2, "sample_length": "1.4 mm"},
    "numerics": {"highest_frequency": "2 kHz"},
}
BALL = ON_BEAM | {
    "kind": "ball-on-beam",
    "laws": ["areal", "shifted", "printed", "table", "linear-filtered", "linear"],
    "start": "0.45 m",
    "ball": {"load": "30 N"},
}
WHEEL = {
    "kind": "wheel-on-rail",
    "laws": ["areal", "shifted", "printed", "linear-filtered", "linear"],
    "duration": "40 ms",
    "settling": "20 ms",
    "surface": {"spectrum": "iso3095"},
    "wheel": {"roughness": "disc", "section": "rigid"},
    "contact": {"spacing": "1 mm", "samples": 2, "sample_length": "0.1 m"},
    "numerics": {"highest_frequency": "4 kHz", "poles": 60},
    "sideways": {"contact_place": "5 mm"},
}
HEARD = {
    "laws": ["linear"],
    "duration": "0.2 s",
    "settling": "0.1 s",
    "surface": {"spectrum": "iso3095"},
    "wheel": {"roughness": "disc", "section": "rigid"},
    "track": {"name": "uic60"},
    "contact": {"spacing": "1 mm", "samples": 2, "sample_length": "0.1 m"},
    "numerics": {"highest_frequency": "4 kHz", "kernel": "scatter"},
}
"""Keys of a wheel on a rail whose sound is looked at: of a linear contact, which no sample changes."""
BODIES = ON_BEAM | {
    "kind": "bodies",
    "over": "beam",
    "laws": ["areal", "printed", "linear-filtered", "linear"],
    "start": "0.4 m",
    "body": {
        "type": "bogie",
        "load": "30 N",
        "distance": "100 mm",
        "masses": ["1 kg"],
        "springs": ["20 kN/m"],
        "dampers": ["5 N s/m"],
    },
}
CASES = {case["kind"]: case for case in (BALL, WHEEL, BODIES)}


BEARING = {
    "kind": "ball-bearing",
    "speed": "1800 1/min",
    "radial": "100 N",
    "laws": ["hertz"],
    "duration": "0.1 s",
    "settling": "10 ms",
    "bearing": {"name": "6205"},
    "fault": {"on": "outer", "length": "0.18 mm", "depth": "0.1 mm"},
}
"""A ball bearing with a pit in the middle of the load zone."""


def changed(kind, **keys):
    """A small case of a kind with other keys, in its sections too; a surface is another one altogether."""
    base = CASES[kind]
    for name, value in keys.items():
        if isinstance(value, dict) and name != "surface":
            keys[name] = base.get(name, {}) | value
    return as_case(base | keys)


class Made(dict):
    """Values that are made when they are first asked for: not every process needs every one."""

    def __init__(self, make):
        super().__init__()
        self.make = make

    def __missing__(self, key):
        self[key] = self.make(key)
        return self[key]


COARSE = {
    "kind": "ball-on-beam",
    "settling": "50 ms",
    "surface": {"rms": "0.05 um", "longest": "0.4 mm", "shortest": "80 um"},
    "ball": {"load": "30 N"},
    "contact": {"spacing": "40 um", "window": "0.76 mm"},
    "numerics": {"highest_frequency": "2 kHz"},
}
"""A ball on a grid so coarse that many of them roll in a test."""


def unmarked(tree):
    """Names of variables with values that are not finite, without a reason."""
    for node in tree.subtree:
        for name, values in node.to_dataset(inherit=False).variables.items():
            reason = values.attrs.get("missing", UNKNOWN) != UNKNOWN
            if values.dtype.kind == "f" and (
                np.isinf(values.values).any() or np.isnan(values.values).any() > reason
            ):
                yield f"{node.path}/{name}"


def tree_of(values):
    """A result that holds some variables."""
    names = {entry.group: {} for entry in values}
    for entry, held in values.items():
        names[entry.group][entry] = held
    return DataTree.from_dict({f"/{name}": group(held) for name, held in names.items()})
