"""The history of the force as a browser gets it: every step within a hair, or every extreme of a long run."""

from __future__ import annotations

import base64
import json
import zlib

import numpy as np
import pytest
from report_reading import HOSTILE
from report_tree import report_tree

from asperity.reporting import history as history_module
from asperity.reporting.history import as_json, history


def unpacked(found):
    """Forces by law, in the unit of the figure, as the script of the page unpacks them."""
    raw = np.frombuffer(zlib.decompress(base64.b64decode(found["data"])), np.uint8)
    planes = raw.reshape(len(found["laws"]), 2, found["points"]).astype(np.int64)
    changes = (planes[:, 0] | planes[:, 1] << 8).astype(np.int16)
    levels = np.cumsum(np.cumsum(changes, axis=1, dtype=np.int64), axis=1)
    return {
        law["name"]: law["lowest"] + law["step"] * row for law, row in zip(found["laws"], levels, strict=True)
    }


@pytest.fixture(scope="module")
def tree():
    return report_tree(["areal", "printed", "linear"], steps=3000)


def test_every_time_step_is_within_half_a_level(tree):
    found = history(tree)
    assert (found["steps"], found["points"], found["force"], found["time"]) == (1, 3000, "N", "ms")
    force = tree["rolling/contact_force"]
    for law, read in unpacked(found).items():
        values = force.sel(law=law).values
        assert np.abs(read - values).max() <= 0.51 * np.ptp(values) / (2**14 - 1)
    times = found["start"] + found["pitch"] * np.arange(found["points"])
    np.testing.assert_allclose(times, 1e3 * tree["rolling/time"].values, atol=1e-9)


def test_a_long_run_keeps_its_extremes(tree, monkeypatch):
    monkeypatch.setattr(history_module, "MOST", 900)
    tree = tree.copy(deep=True)
    tree["rolling"]["contact_force"].values[0, [1234, 2345]] = 50.0, -20.0
    found = history(tree)
    assert found["points"] * len(found["laws"]) <= 900
    read = unpacked(found)["areal"]
    assert (read.min(), read.max()) == pytest.approx((-20.0, 50.0), abs=0.01)
    end = found["start"] + found["pitch"] * found["points"]
    assert end == pytest.approx(1e3 * float(tree["rolling/time"][-1]))
    highest = found["pitch"] * int(np.argmax(read))
    assert highest == pytest.approx(1e3 * float(tree["rolling/time"][1234]), abs=2 * found["pitch"])


def test_losses_are_told_step_by_step(tree):
    tree = tree.copy(deep=True)
    tree["rolling"]["contact_force"].values[:] = 5.0
    tree["rolling"]["contact_force"].values[:, [0, 1, 700, 2999]] = 0.0
    tree["rolling"]["contact_loss_share"].values[:] = 4 / 3000
    losses = {law["name"]: law["losses"] for law in history(tree)["laws"]}
    assert losses["areal"] == losses["printed"] == [[0, 1], [700, 700], [2999, 2999]]
    assert losses["linear"] == []  # it pulls


def test_a_force_that_never_changes(tree):
    tree = tree.copy(deep=True)
    tree["rolling"]["contact_force"].values[:] = 7.0
    assert all(np.array_equal(read, np.full(3000, 7.0)) for read in unpacked(history(tree)).values())


def test_nothing_in_the_data_ends_their_element():
    text = as_json({"name": f"</script>{HOSTILE}"})
    assert "<" not in text
    assert json.loads(text)["name"] == f"</script>{HOSTILE}"
