import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from asperity.errors import InputError, ShortRecordWarning
from asperity.reference import cnossos
from asperity.surfaces.heightmap import Profile
from asperity.surfaces.measured_lines import (
    bring_into_register,
    common_length,
    process,
    strip_from_lines,
    trim,
)
from asperity.surfaces.synthesis import strip_from_bands
from like_measured import either, wheel_lines

MM, UM = 1e-3, 1e-6


def wheel_strip(lines=6):
    wavelengths, levels = (v[3:20] for v in cnossos.wheel_roughness("cast-iron"))
    return strip_from_bands((2880, lines), (MM, 5 * MM), wavelengths, levels, lateral=50.0, seed=7).heights


def test_lines_measured_to_and_fro_come_into_register():
    lines = wheel_strip().T
    shifts = [0, 12, -7, 100, 3, 55]
    measured = [
        Profile(np.roll(z[::-1] if k % 2 else z, shift), MM)
        for k, (z, shift) in enumerate(zip(lines, shifts, strict=True))
    ]
    found = bring_into_register(measured)
    assert_allclose(found.lines, lines, atol=1e-15)
    assert found.replaced == ()
    assert found.reversed == (False, True) * 3
    assert min(found.correlations) > 0.5


def test_short_lines_are_replaced_by_their_neighbours():
    lines = wheel_strip(4).T
    measured = [Profile(z[:2000] if k in (1, 3) else z, MM) for k, z in enumerate(lines)]
    with pytest.warns(ShortRecordWarning, match=r"2 of 4 parallel lines are shorter than 95%"):
        found = bring_into_register(measured)
    assert found.replaced == (1, 3)
    assert_allclose(found.lines[[0, 2]], lines[[0, 2]])
    assert_allclose(found.lines[1], (lines[0] + lines[2]) / 2)
    assert_allclose(found.lines[3], lines[2])
    assert bring_into_register(measured[:1]).lines.shape == (1, 2880)


def test_lines_are_cut_to_the_shortest():
    lines = [Profile(np.arange(n, dtype=float), MM) for n in (7, 5, 6)]
    assert_array_equal(common_length(lines), np.broadcast_to(np.arange(5.0), (3, 5)))


def test_strip_passes_through_its_lines_and_holds_beyond():
    lines = np.random.default_rng(1).standard_normal((5, 50))
    strip = strip_from_lines(lines, MM, 4 * MM, 41, MM)  # 20 mm to either side, lines to 8 mm
    assert strip.shape == (50, 41)
    assert_allclose(strip[:, 12:29:4], lines.T, atol=1e-12)
    assert_allclose(strip[:, :12], np.repeat(lines[:1].T, 12, axis=1), atol=1e-12)
    assert_allclose(strip[:, 29:], np.repeat(lines[-1:].T, 12, axis=1), atol=1e-12)


def test_interpolation_across_is_exact_for_its_polynomials():
    y = (np.arange(6) - 2.5) * 4 * MM
    cubic = strip_from_lines(np.repeat((y**3)[:, None], 3, axis=1), MM, 4 * MM, 21, MM)
    assert_allclose(cubic[0], ((np.arange(21) - 10) * MM) ** 3, atol=1e-12)
    linear = strip_from_lines(np.array([[0.0, 0.0], [1.0, 2.0]]), MM, 4 * MM, 5, MM)
    assert_allclose(linear, np.linspace(0, 1, 5) * np.array([[1.0], [2.0]]))


def test_one_line_is_laid_out_constant_across():
    line = np.arange(4.0)
    assert_array_equal(strip_from_lines([line], MM, MM, 3, MM), np.repeat(line[:, None], 3, axis=1))


def wheel(depth, measured):
    return [trim(Profile(z * UM, MM))[0] for z in wheel_lines(depth, measured=measured)]


@either
def test_flats_of_measured_wheels_come_to_lie_beside_each_other(measured):
    found = bring_into_register(wheel(0.2, measured))
    assert found.reversed[:7] == (False, True, False, True, False, True, False)
    assert np.ptp(np.argmin(found.lines[:7], axis=1)) <= 5  # the flat covers seven of the ten lines
    strip = strip_from_lines(found.lines, MM, 5 * MM, 91, 0.5 * MM)
    assert strip.shape == (found.lines.shape[1], 91)
    assert np.isfinite(strip).all()


@either
def test_lines_that_were_rolled_over_keep_to_and_fro_apart(measured):
    # the circle takes the short waves that tell the directions apart; the starts still lie close together
    found = bring_into_register([process(profile, curvature=True)[0] for profile in wheel(0.2, measured)])
    assert found.reversed == 5 * (False, True)
    assert np.ptp(np.argmin(found.lines[:5], axis=1)) <= 5


@either
def test_a_short_line_of_a_measured_wheel_does_not_spoil_the_others(measured):
    with pytest.warns(ShortRecordWarning, match="1 of 10"):
        found = bring_into_register(wheel(0.6, measured))
    assert found.replaced == (4,)
    assert np.ptp(np.argmin(found.lines[:9], axis=1)) <= 10
    assert min(found.correlations[:9]) > 0.75


@pytest.mark.parametrize(
    ("profiles", "text"),
    [
        ([], "parallel lines: received none"),
        ([Profile([0.0, np.nan, 1.0], MM)], "33.33% missing points"),
        ([Profile([0.0, 1.0], MM), Profile([0.0, 1.0], 2 * MM)], "one spacing for all"),
    ],
)
def test_wrong_lines_are_refused(profiles, text):
    with pytest.raises(InputError, match=text):
        bring_into_register(profiles)


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"lines": [[0.0, np.nan]]}, "parallel lines"),
        ({"lines": [0.0, 1.0]}, "parallel lines"),
        ({"distance_across": 0.0}, "spacings of the lines"),
        ({"shape_y": 0}, "spacings of the lines"),
    ],
)
def test_strip_from_lines_says_what_is_wrong(change, text):
    arguments = {"lines": [[0.0, 1.0]], "spacing": MM, "distance_across": MM, "shape_y": 3, "spacing_y": MM}
    with pytest.raises(InputError, match=text):
        strip_from_lines(**{**arguments, **change})
