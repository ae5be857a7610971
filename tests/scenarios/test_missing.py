"""Values that are not there are marked, with the reason; all others of a result are finite."""

import numpy as np
import pytest
import xarray as xr

from asperity.errors import PhysicsWarning
from asperity.scenes.report import page_of
from asperity.schema import UNKNOWN, Entry
from asperity.schema.spectra import NO_SIGNAL
from small_cases import unmarked

LEVEL = Entry("spectra", "level(band)", "dB re 1 N", "level", missing=NO_SIGNAL)
FORCE = Entry("rolling", "force(time)", "N", "force")


def test_what_is_not_finite_is_missing_with_a_reason_or_a_warning():
    found = LEVEL.variable([1.0, -np.inf])  # of nothing
    np.testing.assert_array_equal(found.values, [1.0, np.nan])
    assert (found.attrs["missing"], found.attrs["long_name"]) == (NO_SIGNAL, "level")
    expected = xr.Variable("time", [1.0, 2.0], {"units": "N", "long_name": "force"})
    xr.testing.assert_identical(FORCE.variable([1.0, 2.0]), expected)
    with pytest.warns(PhysicsWarning, match="1 of 2 values of force are not finite numbers"):
        found = FORCE.variable([1.0, np.nan])
    assert found.attrs["missing"] == UNKNOWN


BEAM = {"kind": "ball-on-beam", "duration": "10 ms", "laws": ["hertz"], "contact": {"samples": 1},
        "surface": {"rms": "0.3 um"}, "numerics": {"highest_frequency": "2 kHz"}}  # fmt: skip
RAIL = {"kind": "wheel-on-rail", "duration": "50 ms", "settling": "50 ms", "laws": ["hertz", "linear"],
        "contact": {"samples": 1}, "wheel": {"section": "rigid"}}  # fmt: skip
RINGING = {"wheel": {"section": "straight-web"}, "numerics": {"highest_frequency": "1.6 kHz"}}
CORRUGATED = {"corrugation": "0.2 mm", "corrugation_wavelength": "30 mm"}


@pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")
@pytest.mark.parametrize(
    ("case", "missing"),
    [
        (BEAM | {"beam": {"sensors": ["0 m", "0.5 m"]}}, ["acceleration_level"]),  # at an end
        (BEAM | {"beam": {"length": "100 m"}}, None),
        (RAIL | {"surface": {"smooth": True}} | RINGING, None),
        (RAIL | {"surface": CORRUGATED}, None),  # that the wheel leaves
    ],
)
def test_every_value_of_a_result_is_finite_or_marked(runs, case, missing):
    tree = runs(case)
    assert list(unmarked(tree)) == []
    if missing is not None:
        assert [v.name for v in tree["spectra"].data_vars.values() if "missing" in v.attrs] == missing
        assert "there is no signal in these bands, and nothing has no level" in page_of(tree)
