"""A ball, or any body, may repeat or mirror a measured map or line that is shorter than its path."""

import numpy as np
import pytest

from asperity import BallOnBeam, Bodies, HeightMap, Profile
from asperity.errors import CaseError, InputError
from asperity.running import prepare_case
from asperity.surfaces.synthesis import self_affine

MAP = self_affine((200, 90), (10e-6, 10e-6), rms=0.05e-6, hurst=0.8, longest=0.4e-3, shortest=60e-6, seed=2)
CONTACT = {"spacing": 10e-6, "window": 0.6e-3, "samples": 1}
RUN = {"duration": 20e-3, "settling": 50e-3, "laws": ["areal"], "contact": CONTACT}


def path(kind, how, measured=MAP):
    case = kind(surface={"file": measured, "continuation": how}, **RUN)
    textures = prepare_case(case).textures
    rows, window = textures.path.shape
    assert textures.maps[0].shape == (200, 90)  # the samples stay those of the map
    return textures.path.rows(0, rows), window, textures


@pytest.mark.parametrize("kind", [BallOnBeam, Bodies])
def test_a_ball_repeats_a_measured_map(kind):
    heights, window, textures = path(kind, "repeat")
    np.testing.assert_array_equal(heights[200:], heights[:-200])
    assert "repeated" in textures.origin
    first = textures.before - window  # a window before the record
    inside = heights[first + window : first + 200 - window]  # but for where it closes
    middle = (90 - window) // 2
    expected = textures.maps[0].heights[window : 200 - window, middle : middle + window]
    np.testing.assert_allclose(inside - inside.mean(), expected - expected.mean(), atol=1e-12)
    steps = np.abs(np.diff(heights, axis=0)).max()
    assert steps < 1.5 * np.abs(np.diff(MAP.heights, axis=0)).max()  # the ends meet


def test_a_ball_mirrors_a_measured_map():
    heights, window, textures = path(BallOnBeam, "mirror")
    first = textures.before - window
    np.testing.assert_array_equal(heights[first : first + 200], heights[first : first + 399][:198:-1])
    assert "mirrored" in textures.origin


def test_without_it_a_path_is_synthesised():
    assert "synthesised in their likeness" in path(BallOnBeam, None)[2].origin


@pytest.mark.parametrize("how", ["repeat", "mirror"])
def test_a_line_goes_on_for_a_ball(how):
    line = Profile(MAP.heights[:, 3] - MAP.heights[:, 3].mean(), 10e-6)
    keys = RUN | {"laws": ["hertz"]}
    with pytest.raises(InputError, match=r"a longer line, or surface\.continuation"):
        prepare_case(BallOnBeam(surface={"line": line}, **keys))
    textures = prepare_case(BallOnBeam(surface={"line": line, "continuation": how}, **keys)).textures
    period = 200 if how == "repeat" else 398
    np.testing.assert_array_equal(textures.line[period:], textures.line[:-period])


def test_it_goes_with_what_is_measured_and_as_wide_as_the_window():
    with pytest.raises(CaseError, match="only together with file or line"):
        BallOnBeam(surface={"rms": 1e-7, "continuation": "mirror"})
    narrow = HeightMap(MAP.heights[:, :40], MAP.spacing)
    with pytest.raises(
        InputError, match=r"surface\.continuation: received 0\.4 mm across; allowed: a map as wide as"
    ):
        path(BallOnBeam, "mirror", narrow)
