"""Values that are not there are marked, with the reason; all others of a result are finite."""

import numpy as np
import pytest
import xarray as xr

import asperity
from asperity.errors import PhysicsWarning
from asperity.scenes.report import page_of
from asperity.schema import Entry
from asperity.schema.entry import UNKNOWN
from asperity.schema.spectra import NO_SIGNAL

BEAM = {
    "kind": "ball-on-beam",
    "duration": "10 ms",
    "laws": ["hertz"],
    "contact": {"samples": 1},
    "surface": {"rms": "0.3 um"},
}
RAIL = {
    "kind": "wheel-on-rail",
    "duration": "50 ms",
    "settling": "50 ms",
    "laws": ["linear"],
    "surface": {"smooth": True},
    "contact": {"samples": 1},
}


LEVEL = Entry("spectra", "level", ("band",), "dB re 1 N", "level", missing=NO_SIGNAL)
FORCE = Entry("rolling", "force", ("time",), "N", "force")


def test_levels_of_nothing_are_missing_not_infinite():
    found = LEVEL.variable([1.0, -np.inf])
    np.testing.assert_array_equal(found.values, [1.0, np.nan])
    assert found.attrs["missing"] == NO_SIGNAL
    assert found.attrs["long_name"] == "level"


def test_what_is_finite_is_left_as_it_is():
    expected = xr.Variable("time", [1.0, 2.0], {"units": "N", "long_name": "force"})
    xr.testing.assert_identical(FORCE.variable([1.0, 2.0]), expected)


def test_a_number_that_should_be_there_is_warned_of():
    with pytest.warns(PhysicsWarning, match="1 of 2 values of force are not finite numbers"):
        found = FORCE.variable([1.0, np.nan])
    assert found.attrs["missing"] == UNKNOWN


def unmarked(tree):
    """Names of variables with values that are not finite, without a reason."""
    for node in tree.subtree:
        for name, values in node.to_dataset(inherit=False).variables.items():
            if values.dtype.kind != "f":
                continue
            if np.isinf(values.values).any():
                yield f"{node.path}/{name} is infinite"
            if np.isnan(values.values).any() and values.attrs.get("missing", UNKNOWN) == UNKNOWN:
                yield f"{node.path}/{name} is missing"


@pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")
@pytest.mark.parametrize(
    ("base", "changed"),
    [
        pytest.param(BEAM, {"beam": {"sensors": ["0 m", "0.5 m"]}}, id="sensor at an end"),
        pytest.param(BEAM, {"beam": {"length": "100 m"}}, id="beam of 100 m"),
        pytest.param(RAIL, {}, id="smooth rail"),
        pytest.param(
            RAIL,
            {
                "surface": {"corrugation": "0.2 mm", "corrugation_wavelength": "30 mm"},
                "laws": ["hertz", "linear"],
            },
            id="corrugation that the wheel leaves",
        ),
    ],
)
def test_every_value_of_a_result_is_finite_or_marked(base, changed, tmp_path, monkeypatch):
    monkeypatch.setenv("ASPERITY_CACHE", str(tmp_path))
    tree = asperity.run(base | changed)
    assert list(unmarked(tree)) == []
    missing = [v for v in tree["spectra"].data_vars.values() if "missing" in v.attrs]
    if "beam" in changed and "sensors" in changed["beam"]:
        assert [v.name for v in missing] == ["acceleration_level"]
        assert "there is no signal in these bands, and nothing has no level" in page_of(tree)
