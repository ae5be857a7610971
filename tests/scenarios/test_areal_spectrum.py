"""A surface by its one-third-octave levels that a ball rolls over: path and samples have them."""

import numpy as np
import pytest

from asperity import BallOnBeam
from asperity.errors import CaseError, InputError
from asperity.running import prepare_case
from asperity.surfaces.bands import band_levels_of
from asperity.surfaces.heightmap import HeightMap
from small_cases import COARSE

WAVELENGTHS = 10.0 ** (-np.arange(26, 41) / 10.0)  # 2.5 mm to 0.1 mm
LEVELS = np.stack([WAVELENGTHS, -20.0 + 8.0 * np.log10(WAVELENGTHS / 1e-3)], axis=1)


def textures(lateral=1.0, **keys):
    case = COARSE | {
        "surface": {"spectrum": LEVELS, "lateral": lateral},
        "start": "0.2 m",
        "duration": "0.4 s",
    }
    return prepare_case(BallOnBeam(**case | keys)).textures


def test_path_and_samples_have_the_levels():
    """As far as a record of its length tells them: standard deviation 4.34 dB / √(bandwidth · length)."""
    found = textures(surface={"spectrum": LEVELS, "lateral": 1.0, "level": "+6 dB"})
    path = found.path.rows(0, found.path.shape[0])
    dx = found.maps[0].spacing
    for heights in (path, found.maps[0].heights):
        whole = HeightMap(heights, dx)
        wavelength, level = band_levels_of(whole, shortest=WAVELENGTHS[-1], longest=WAVELENGTHS[0])
        asked = np.interp(np.log(wavelength), np.log(WAVELENGTHS[::-1]), LEVELS[::-1, 1] + 6.0)
        scatter = 4.34 / np.sqrt(0.23 / wavelength * heights.shape[0] * dx[0])
        assert (np.abs(level - asked) < 3.0 * scatter).all()
        assert np.mean(np.abs(level - asked)) < 1.0
    assert found.areal
    np.testing.assert_array_equal(found.line, path[:, path.shape[1] // 2])


def test_lay_along_and_across():
    """A lateral correlation above 1 draws the texture out across the path."""

    def slopes(lateral):
        heights = textures(lateral).maps[0].heights
        return np.std(np.diff(heights, axis=0)) / np.std(np.diff(heights, axis=1))

    assert slopes(1.0) == pytest.approx(1.0, abs=0.15)
    assert slopes(4.0) > 2.0
    assert slopes(0.25) < 0.7


def test_one_source_of_samples():
    both = {"spectrum": LEVELS, "lateral": 1.0, "rms": "0.1 um"}
    with pytest.raises(CaseError, match=r"surface\.lateral.*a number beside rms"):
        BallOnBeam(surface=both)


def test_a_surface_is_rolled_over_by_all_laws():
    """Those of a case that names none are those of any surface."""
    case = BallOnBeam(surface={"spectrum": LEVELS, "lateral": 1.0})
    assert case.laws == BallOnBeam(surface={"rms": "1 um"}).laws
    assert "laws" not in case.given()


def test_a_spectrum_without_lateral_is_a_line():
    case = BallOnBeam(surface={"spectrum": LEVELS})
    assert "areal" not in case.laws
    assert case.surface.has_line
    assert not case.surface.has_samples


def test_a_path_shorter_than_a_strip_is_refused():
    with pytest.raises((InputError, CaseError), match="strips from which filters are estimated"):
        textures(start="0.06 m", settling="0 s", duration="5 ms")


def test_a_gap_in_the_table_is_named():
    with pytest.raises(CaseError, match="a gap in the bands"):
        BallOnBeam(surface={"spectrum": np.delete(LEVELS, 3, axis=0), "lateral": 1.0})
