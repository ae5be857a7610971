"""Sections of wheels and rails with uneven places, as instruments and programs have them; Simpack's files."""

import numpy as np
import pytest

from asperity.errors import InputError
from asperity.surfaces.readers import read_across, read_surface
from asperity.surfaces.readers.positions import made_even

SIMPACK = """! *** SIMPACK Rail-Wheel Profile ***
  header.begin
    version       =  1                       ! Version flag
    type          =  {kind}                  ! 0=rail profile, 1=wheel profile
  header.end
  spline.begin
    comment        = 'a head'                ! type = 7
    rotate         = {rotate}                ! 3: Rotation angle about x
    {unit}
    point.begin
    ! y value (lengths unit)  z value (lengths unit)    weight (default=1.0)
{points}
    point.end
  spline.end
"""
Y = 30e-3 * np.linspace(-1.0, 1.0, 241) ** 3 * 0.6 + 30e-3 * 0.4 * np.linspace(-1.0, 1.0, 241)
"""Places, m, closer in the middle than at the ends."""
RADIUS = 0.3


@pytest.fixture
def simpack(tmp_path):
    def simpack(kind, *, unit="units.len.f = +1.0E+03", rotate="+0.0", weight="", points=None, scale=1e3):
        name = "a.prw" if kind else "a.prr"
        z = (1.0 if kind else -1.0) * (np.sqrt(RADIUS**2 - Y**2) - RADIUS)
        rows = "\n".join(f"{a:.9E}\t{b:.9E}{weight}" for a, b in scale * np.array([Y, z]).T[::-1])
        text = SIMPACK.format(kind=kind, unit=unit, rotate=rotate, points=rows if points is None else points)
        (tmp_path / name).write_text(text)
        return tmp_path / name

    return simpack


def is_the_circle(line):
    y = line.start + line.spacing * np.arange(len(line.heights))
    np.testing.assert_allclose(line.heights, np.sqrt(RADIUS**2 - y**2) - RADIUS, rtol=0.0, atol=2e-8)
    inner = np.abs(y) < 10e-3
    assert np.polynomial.polynomial.polyfit(y[inner], line.heights[inner], 2)[2] == pytest.approx(
        -0.5 / RADIUS, rel=1e-3
    )


@pytest.mark.parametrize("kind", [0, 1], ids=["rail", "wheel"])
@pytest.mark.parametrize("how", [{}, {"weight": "\t1.0"}, {"unit": "", "scale": 1.0}], ids=str)
def test_a_profile_of_simpack_is_read_with_heights_out_of_its_material(simpack, kind, how):
    """Its one z points downwards: out of a wheel, into a rail."""
    is_the_circle(read_across(simpack(kind, **how)))
    is_the_circle(read_surface(simpack(kind, **how)))


@pytest.mark.parametrize(("how", "message"), [
    ({"rotate": "+0.05"}, r"rotate in a.prr: received 0.05; allowed: 0. Apply it to the points"),
    ({"points": "1.0 2.0 3.0 4.0"}, r"points of a.prr: received '1.0 2.0 3.0 4.0'; allowed: y, z"),
    ({"points": "1.0 two"}, "received '1.0 two'"),
    ({"points": ""}, "received 0 points"),
    ({"unit": "units.len.f = -1"}, "units.len.f in a.prr: received -1"),
])  # fmt: skip
def test_a_profile_of_simpack_that_is_not_understood_is_refused(simpack, how, message):
    with pytest.raises(InputError, match=message):
        read_across(simpack(0, **how))


def test_the_name_of_such_a_file_is_not_enough(tmp_path, simpack):
    (tmp_path / "b.prw").write_text("1 2\n2 3\n")
    with pytest.raises(
        InputError, match=r"b.prw: received a file that starts with .*; allowed: a Simpack profile"
    ):
        read_across(tmp_path / "b.prw")
    with pytest.raises(InputError, match=r"type in a.prw: received 2; allowed: 0, a rail, or 1, a wheel"):
        read_across(simpack(2))


@pytest.mark.parametrize("order", [slice(None), slice(None, None, -1)], ids=["rising", "falling"])
def test_uneven_places_of_a_section_are_interpolated_and_those_of_a_surface_refused(tmp_path, order):
    rows = "\n".join(f"{1e3 * y:.6f};{1e3 * (np.sqrt(RADIUS**2 - y**2) - RADIUS):.6f}" for y in Y[order])
    (tmp_path / "a.csv").write_text(f"y (mm);z (mm)\n{rows}\n")
    is_the_circle(read_across(tmp_path / "a.csv"))
    with pytest.raises(InputError, match="not uniform"):
        read_surface(tmp_path / "a.csv")


@pytest.mark.parametrize(("places", "message"), [
    ([0.0, 1.0, 1.5, 1.5, 3.0, 4.0], "several heights at 1.5; .*Leave flanks out that overhang"),
    ([0.0, 1.0, 2.2, 3.0, 4.1, 9.0], "a gap of 0.544 of the line without a point; allowed: at most 0.1"),
])  # fmt: skip
def test_what_no_spline_may_fill_is_refused(places, message):
    places = (
        np.concatenate([np.array(places), 9.0 + np.cumsum([0.5, 0.7] * 2)]) if places[-1] == 4.0 else places
    )
    with pytest.raises(InputError, match=message):
        made_even(np.array(places), np.zeros(len(places)), "a.csv")
