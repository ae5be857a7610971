"""What a function returns that was called in a process of its own is what it returned."""

import io

import numpy as np
import pytest

from asperity.errors import InputError
from asperity.sandbox import received, sandboxed, send

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
        raise InputError(path, "nothing", "something", "Write it.")
    if fault:
        raise KeyError("no such\tthing" + 1000 * "x")
    return {"path": path, "low": -np.inf, "seed": np.int64(3)}, ARRAYS


def test_what_is_received_was_sent():
    send(answered("é", ""), stream := io.BytesIO())
    description, arrays = received(stream.getvalue())
    assert description == {"path": "é", "low": -np.inf, "seed": 3}
    for found, sent in zip(arrays, ARRAYS, strict=True):
        assert found.dtype == (sent.dtype if sent.dtype != object else "<U10")
        np.testing.assert_array_equal(found, sent)
        assert found.flags.aligned
        assert found.flags.writeable
    with pytest.raises(ValueError, match="buffer"):
        received(stream.getvalue()[:-5])


@pytest.mark.parametrize(("fault", "message"), [
    ("input", "^a.nc: received nothing; allowed: something. Write it.$"),
    ("any", r"KeyError \('no such\\tthingx+ …\) while it was opened; allowed: an intact text file"),
])  # fmt: skip
def test_what_it_raises_is_told(fault, message, monkeypatch):
    monkeypatch.syspath_prepend(__file__.rpartition("/")[0])
    with pytest.raises(InputError, match=message):
        sandboxed(answered, ["a.nc", fault], "a.nc", 1, "text")
