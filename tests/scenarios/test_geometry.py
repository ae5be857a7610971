"""What presses on what: radii, measured sections and grooves, contacts that are too large or too coarse."""

import numpy as np
import pytest

from asperity import Bodies, Hertz, Profile
from asperity.errors import CoarseSamplingWarning, HalfSpaceWarning, InputError
from asperity.scenarios.geometry import geometry_of
from refusals import refusals
from small_cases import changed

COARSE = pytest.mark.filterwarnings("ignore::asperity.errors.CoarseSamplingWarning")


def ball(load, **keys):
    return geometry_of(changed("ball-on-beam", ball={"load": load}, **keys))


def wheel(**keys):
    return geometry_of(changed("wheel-on-rail", contact={"spacing": "0.4 mm", "window": "20 mm"}, **keys))


def section(bend, half=30e-3):
    """A section across the path that bends up by y²/2R, 1/R in 1/m."""
    y = np.linspace(-half, half, 121)
    return Profile(0.5 * bend * y**2, y[1] - y[0])


HALF = (3 * 30.0 * 25e-3 / (4 * 210e9 / (2 * 0.91))) ** (1 / 3)
REFUSED = [
    (lambda: ball("5 MN"), "at most R/3"),
    (lambda: ball("300 N"), r"contact\.window: received"),
    (lambda: ball("30 N", contact={"approaches": ["0 um", "4 mm"]}), "an approach of 4000 µm"),
    *(
        (
            lambda side=side: ball("30 N", beam={side: 1.99 * HALF}),
            rf"beam\.{side}: received 337 um; allowed: at least 339 um",
        )
        for side in ("width", "height")
    ),
    (
        lambda: wheel(track={"rail_profile": section(-1 / 0.3, 5e-3)}),
        "wheel.profile and track.rail_profile: received sections that meet 5.0 mm from an edge",
    ),
    (lambda: wheel(wheel={"profile": section(20.0)}), "sections that meet 0.0 mm from an edge"),
]


test_contacts_that_cannot_be_are_refused = refusals(*REFUSED)


def test_a_beam_as_wide_as_its_contact_is_held_and_a_coarse_grid_is_told():
    ball("30 N", beam={"width": 2.01 * HALF})
    with pytest.warns(CoarseSamplingWarning, match="an eighth of the contact radius"):
        ball("10 N")


def test_radii_make_hertz():
    shape = wheel(wheel={"transverse_radius": "0.5 m"})
    assert shape.hertz.radius_x == 0.46
    assert shape.hertz.radius_y == pytest.approx(1 / (1 / 0.3 + 1 / 0.5))
    assert shape.largest_force < 8 * 65e3  # what the window holds
    shape = wheel()
    assert Hertz(shape.modulus, 0.46, 0.3).stiffness_constant == pytest.approx(9.413e10, rel=1e-3)
    assert shape.semi_axes == pytest.approx((6.20e-3, 4.67e-3), rel=1e-3)


def test_measured_section_of_a_circle_is_its_radius():
    shape, round_head = wheel(track={"rail_profile": section(-1 / 0.3)}), wheel()
    assert shape.hertz.radius_y == pytest.approx(0.3, rel=1e-3)
    np.testing.assert_allclose(shape.body, round_head.body, atol=1e-9)


def bodies(body, over="beam", window="0.6 mm", **keys):
    contact = {"spacing": "20 um", "window": window, "samples": 1, "sample_length": "9 mm"}
    return Bodies(surface={"rms": "0.05 um"}, contact=contact, body=body, over=over, **keys)


def smooth_contact(*arguments, **keys):
    return bodies(*arguments, **keys).smooth_contact


def test_bodies_are_round_lie_in_grooves_and_bend_with_raceways():
    """1/R: 1/3 − 1/3.12 across; around an inner ring 1/3 + 1/20 along, inside an outer one 1/3 − 1/20."""
    found = smooth_contact({})
    assert (found.radius_x, found.radius_y) == pytest.approx((25e-3, 25e-3))
    keys = {"radius": 3e-3, "groove_radius": 3.12e-3, "raceway_radius": 20e-3}
    inner, outer = smooth_contact(keys), smooth_contact(keys | {"raceway": "outer"})
    assert inner.radius_y == pytest.approx(78e-3)
    assert inner.radius_x == pytest.approx(1e-3 / (1 / 3 + 1 / 20))
    assert outer.radius_x == pytest.approx(1e-3 / (1 / 3 - 1 / 20))
    tread = {"radius": 0.46, "transverse_radius": "inf", "load": 65e3, "mass": 600}
    assert smooth_contact(tread, "track").radius_y == pytest.approx(0.3)  # that of the rail's head
    glass = smooth_contact({}, "plane", structure={"material": "glass"})
    assert glass.modulus < smooth_contact({}, "plane").modulus


def in_groove(load, **keys):
    body = {"radius": 3e-3, "groove_radius": 3.12e-3, "mass": 0.05, "load": load} | keys
    return geometry_of(bodies(body, window="4 mm"))


@COARSE
def test_the_gap_of_a_groove_is_that_of_circle_in_circle():
    """Distance of the ball from points along the arc of the groove."""
    found = in_groove(5.0)
    s = 2e-5 * (np.arange(found.body.shape[1]) - found.body.shape[1] // 2)
    ball, groove = 3e-3, 3.12e-3
    x, y = groove * np.sin(s / groove), groove * (1 - np.cos(s / groove))
    middle = found.body[found.body.shape[0] // 2]
    np.testing.assert_allclose(middle, np.hypot(x, y - ball) - ball, rtol=1e-3, atol=1e-12)
    assert found.semi_axes[1] > 5 * found.semi_axes[0]


@COARSE
def test_where_the_half_space_ends_in_a_groove():
    with pytest.warns(HalfSpaceWarning, match="rad of the groove to either side"):
        in_groove(800.0, groove_radius=3.05e-3, mass=1.0)
    with pytest.raises(InputError, match=r"fills .* rad of the groove"):
        in_groove(5000.0, groove_radius=3.05e-3, mass=1.0)
