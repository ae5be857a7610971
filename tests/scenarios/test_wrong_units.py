"""Heights and pixels in another unit than they are taken for are refused, with the likely cause."""

import numpy as np
import pytest

from asperity.case.cases import case_of
from asperity.errors import InputError
from asperity.running import prepare_case
from asperity.surfaces.synthesis import self_affine

MAP = self_affine((200, 120), (8e-6, 8e-6), rms=0.05e-6, hurst=0.8, longest=0.4e-3, shortest=60e-6, seed=2)
CONTACT = {"spacing": "8 um", "window": "0.6 mm", "samples": 1}


def refusal(kind, surface, **sections):
    case = {"kind": kind, "duration": "20 ms", "settling": "0 s", "laws": ["areal"], "surface": surface}
    with pytest.raises(InputError) as caught:
        prepare_case(case_of({**case, **sections}))
    return str(caught.value)


@pytest.fixture
def map_in_um(tmp_path):
    np.save(tmp_path / "map.npy", MAP.heights * 1e6)
    return str(tmp_path / "map.npy")


@pytest.mark.parametrize("kind", ["ball-on-beam", "bodies"])
def test_a_map_of_um_read_as_m_is_refused(kind, map_in_um):
    right = {"file": map_in_um, "pixel": "8 um", "height_unit": "um"}
    message = refusal(kind, {**right, "height_unit": "m"}, contact=CONTACT)
    assert message.startswith("surface.file: received heights with an rms slope of ")
    assert 'Are the heights in µm? Then set height_unit = "um"' in message
    case = {"kind": kind, "duration": "20 ms", "settling": "50 ms", "contact": CONTACT, "laws": ["areal"]}
    prepare_case(case_of({**case, "surface": right}))


@pytest.mark.parametrize("kind", ["ball-on-beam", "bodies"])
def test_a_roughness_of_half_a_millimetre_is_refused(kind):
    assert 'Is rms in µm? Then write it so: rms = "0.5 um".' in refusal(kind, {"rms": "0.5 mm"})


def test_a_roughness_of_many_approaches_is_refused_without_steep_slopes():
    surface = {"rms": "60 um", "longest": "1 mm", "shortest": "0.5 mm"}
    ball = {"radius": "25 mm", "load": "5 N"}
    message = refusal("ball-on-beam", surface, ball=ball, contact={**CONTACT, "spacing": "10 um"})
    assert "um rms within the window; allowed: up to 100 approaches of the bodies, 0.348 um each" in message


def test_a_line_of_um_read_as_m_is_refused(tmp_path):
    np.save(tmp_path / "line.npy", MAP.heights[:, 0] * 1e6)
    line = {"line": str(tmp_path / "line.npy"), "line_unit": "m", "line_spacing": "80 um"}
    message = refusal("ball-on-beam", line, laws=["linear"], duration="5 ms")
    assert message.startswith("surface.line: received heights with an rms slope of ")
    assert 'line_unit = "um"' in message


def test_a_pixel_with_which_memory_is_too_small_is_refused(map_in_um):
    """8 mm instead of 8 µm: 1.6 m × 0.96 m, 2.4e10 points."""
    surface = {"file": map_in_um, "pixel": "8 mm", "height_unit": "um"}
    message = refusal("ball-on-beam", surface, contact=CONTACT)
    assert (
        "surface.file: received maps of 1600 mm × 960 mm, 2.4e+10 points at contact.spacing = 8 um" in message
    )
    assert "Is the pixel in µm, not mm?" in message
