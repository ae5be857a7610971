"""Results on their way to another process."""

import io

import numpy as np
import pytest
import xarray

from asperity.streamed import receive_result, send_result


@pytest.fixture
def tree():
    first = xarray.Dataset(
        {
            "a": (("x", "y"), np.arange(6.0).reshape(2, 3).T.copy().T, {"units": "m", "rows": [1, 2]}),
            "one": ((), np.float64(np.nan), {"share": np.float64(0.1)}),
            "none": ("empty", np.empty(0)),
            "told": ("y", np.array(["é", "", "long words"], dtype=object)),
            "whole": ("x", np.array([1, -2], dtype=np.int32)),
        },
        coords={"x": [0.5, 1.5], "law": ("y", ["areal", "table", "direct"])},
        attrs={"title": "a “title”", "seed": np.int64(3), "low": -np.inf},
    )
    return xarray.DataTree.from_dict({"/": xarray.Dataset(attrs={"case": "x"}), "/first/second": first})


def test_what_is_received_was_sent(tree):
    stream = io.BytesIO()
    send_result(tree, stream)
    stream.write(b"what follows")
    stream.seek(0)
    found = receive_result(stream)
    assert found.identical(tree)
    assert found["first/second/a"].dtype == np.float64
    assert found["first/second/whole"].dtype == np.int32
    assert list(found["first/second"].coords) == ["x", "law"]
    assert stream.read() == b"what follows"
    assert receive_result(stream) is None


def test_a_stream_that_breaks_off_is_no_result(tree):
    stream = io.BytesIO()
    send_result(tree, stream)
    with pytest.raises(ValueError, match="breaks off"):
        receive_result(io.BytesIO(stream.getvalue()[:-5]))
