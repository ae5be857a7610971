"""The scans of a case: what they share, and whose key their warnings name."""

import warnings

import numpy as np
import pytest

from asperity.case.cases import parse_case
from asperity.contact.scan import ScanJob, first_touch
from asperity.errors import PhysicsWarning
from asperity.running import prepare_case
from asperity.scenarios import laws, reducing
from asperity.scenarios.laws import table_stride
from asperity.scenes.compute import compute

pytestmark = pytest.mark.usefixtures("own_cache")

CASE = """
kind = "ball-on-beam"
duration = "4 ms"
settling = "0 s"
laws = ["table", "direct"]
[surface]
rms = "0.05 um"
longest = "0.4 mm"
shortest = "40 um"
[contact]
spacing = "10 um"
window = "0.5 mm"
samples = 2
approaches = ["0 um", "0.3 um", "0.6 um", "1.2 um"]
[numerics]
force_accuracy = 1e-3
rtol = 1e-5
"""


def quiet(done, total, message):
    """A progress that nobody sees."""


@pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")
def test_first_touch_along_the_path_is_found_once(monkeypatch):
    looked_at = []

    def counted(surface, body, stride=1):
        looked_at.append(surface)
        return first_touch(surface, body, stride)

    for module in (laws, reducing.scan):
        monkeypatch.setattr(module, "first_touch", counted)
    prepared = prepare_case(parse_case(CASE))
    chain = compute(prepared, quiet)
    path, shape = prepared.textures.path, prepared.shape
    assert sum(surface is path for surface in looked_at) == 1
    stride, half = table_stride(shape), shape.body.shape[0] // 2
    planes = reducing.patch_planes(path, shape)[half:-half:stride]
    expected = first_touch(path, shape.body, stride) + planes
    assert np.array_equal(chain.laws["table"].table.touches, expected)


def test_every_scan_of_a_case_has_the_tolerance_of_its_key(monkeypatch):
    """1e-3 of the force asks for a residual of 4e-4, scans for filters for a tenth; warnings name the key."""
    asked = set()

    def noted(self):
        asked.add(self.rtol)
        check(self)

    check = ScanJob.__post_init__
    monkeypatch.setattr(ScanJob, "__post_init__", noted)
    monkeypatch.setattr("asperity.contact.halfspace.MAX_ITERATIONS", 4)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        compute(prepare_case(parse_case(CASE)), quiet)
    assert asked == {1e-3 / 2.5, 0.1 * 1e-3 / 2.5}
    told = [str(w.message) for w in caught if issubclass(w.category, PhysicsWarning)]
    keys = {
        "the loading curves": "force_accuracy",
        "the filters": "force_accuracy",
        "the path": "force_accuracy",
    }
    for what, key in (keys | {"the direct law": "rtol"}).items():
        mine = [text for text in told if f"contact solutions of {what} (" in text and "missed" in text]
        assert len(mine) == 1, told
        assert f"Try a larger numerics.{key}" in mine[0]
