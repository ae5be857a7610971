"""The program as a user starts it, in a folder of its own."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

from asperity.results import read_result

LONG = os.environ.get("ASPERITY_FAULTS") == "long"
"""Whether to take the time that a thorough search needs: ``ASPERITY_FAULTS=long pytest tests/faults``."""
START = "from asperity.__main__ import start; start()"
RUN = ("run", "case.toml", "-o", "out", "--no-report")
CASE = """
kind = "ball-on-beam"
duration = "10 ms"
settling = "5 ms"
laws = ["hertz", "table"]
[surface]
rms = "0.1 um"
longest = "0.2 mm"
shortest = "40 um"
[contact]
samples = 1
sample_length = "2 mm"
spacing = "20 um"
[ball]
load = "5 N"
[numerics]
highest_frequency = "2 kHz"
"""
"""A case of a second, with kept blocks."""


def program(folder, *words, code=START, **more):
    """Start the program; its cache lies beside its results."""
    environment = os.environ | {"ASPERITY_CACHE": str(folder / "cache")} | more.pop("env", {})
    environment.pop("COVERAGE_PROCESS_CONFIG", None)  # what measures it breaks by signals and full disks
    return subprocess.Popen(
        [sys.executable, "-X", "faulthandler", "-c", code, *words],
        cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment, **more,
    )  # fmt: skip


def ended(process, timeout=300):
    """Wait for it; return its exit code and all it said."""
    out, err = process.communicate(timeout=timeout)
    return process.returncode, out + err


def prepared(folder, text=CASE, name="case.toml"):
    """Make the folder and write the case into it."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_text(text)
    return folder


def promised(code, told):
    """Whatever happens, the program ends with one of its exit codes and without a traceback."""
    assert code in (0, 2, 3, 130), told
    assert "Traceback" not in told, told
    assert "the program failed" not in told, told
    if code in (2, 3):
        assert "Error: " in told


def left(folder):
    """What no finished write leaves in a folder and below."""
    return [path for path in Path(folder).rglob(".*") if path.is_file() or path.suffix == ".part"]


def numbers(folder):
    """All arrays of a run, and its attributes but for time and clock."""
    tree = read_result(folder)
    arrays = {
        f"{node.path}/{name}": values.values
        for node in tree.subtree
        for name, values in node.to_dataset(inherit=False).variables.items()
    }
    return arrays, {name: tree.attrs[name] for name in ("case", "verdict", "warnings")}


def same(first, second):
    """Whether two runs are the same to the last bit."""
    (arrays, attributes), (others, found) = numbers(first), numbers(second)
    assert json.dumps(attributes) == json.dumps(found)
    assert arrays.keys() == others.keys()
    for name, values in arrays.items():
        np.testing.assert_array_equal(values, others[name], err_msg=name)
