"""What answers or fails as a reader of a foreign file, in a module that its process imports soon."""

from pathlib import Path

import numpy as np

from asperity.errors import InputError

ARRAYS = [
    np.arange(6.0).reshape(3, 2).T,
    np.float64(np.nan),
    np.empty(0),
    np.array(["é", "", "long words"], dtype=object),
    np.array([1, -2], dtype=np.int32),
]


def answered(path, fault):
    """Answer, or fail, as a reader of a foreign file."""
    if fault == "input":
        raise InputError(Path(path).name, "nothing", "something", "Write it.")
    if fault:
        raise KeyError("no such\tthing" + 1000 * "x")
    return {"path": path, "low": -np.inf, "seed": np.int64(3)}, ARRAYS
