"""Results on their way from another process."""

import io

import numpy as np
import pytest

from asperity.streamed import receive_result, send_groups

FIRST = {
    "a": (("x", "y"), np.arange(6.0).reshape(3, 2).T, {"units": "m", "rows": [1, 2]}),
    "x": (("x",), np.array([0.5, 1.5]), {}),
    "one": ((), np.float64(np.nan), {"share": np.float64(0.1)}),
    "none": (("empty",), np.empty(0), {}),
    "told": (("y",), np.array(["é", "", "long words"], dtype=object), {}),
    "whole": (("x",), np.array([1, -2], dtype=np.int32), {}),
}
GROUPS = [
    ("/", {"case": "x", "seed": np.int64(3), "low": -np.inf}, {}),
    ("/first/second", {"title": "a “title”"}, FIRST),
]


@pytest.fixture
def stream():
    send_groups(GROUPS, found := io.BytesIO())
    return found


def test_what_is_received_was_sent(stream):
    stream.write(b"what follows")
    stream.seek(0)
    found = receive_result(stream)
    assert dict(found.attrs) == GROUPS[0][1]
    group = found["first/second"].to_dataset()
    assert group.attrs == {"title": "a “title”"}
    assert set(group.variables) == set(FIRST)
    assert list(group.coords) == ["x"]
    for name, (dims, values, attributes) in FIRST.items():
        variable = group[name].variable
        assert (variable.dims, variable.attrs) == (dims, attributes)
        assert variable.dtype == (values.dtype if name != "told" else "<U10")
        np.testing.assert_array_equal(variable.values, values)
    assert stream.read() == b"what follows"
    assert receive_result(stream) is None


def test_a_stream_that_breaks_off_is_no_result(stream):
    with pytest.raises(ValueError, match="breaks off"):
        receive_result(io.BytesIO(stream.getvalue()[:-5]))
