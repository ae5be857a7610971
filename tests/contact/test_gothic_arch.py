"""A groove of two arcs against coordinates of its circles; a ball between two by the least of its energy."""

import math

import numpy as np
import pytest
from scipy.optimize import minimize

from asperity import FourPointBall, GothicArch
from asperity.contact.hertz import in_groove
from refusals import refusals

STEEL = 115e9
BALL, GROOVE = 2e-3, 2.1e-3
ARCH = GothicArch.at_angle(math.radians(50.0), BALL, GROOVE)
SINE, COSINE = math.sin(ARCH.contact_angle), math.cos(ARCH.contact_angle)


def between(oversize=2e-6, raceway=math.inf):
    """A ball between a groove that is curved along the path and a straight one."""
    return FourPointBall(ARCH, ARCH.contact(STEEL, raceway), ARCH.contact(STEEL), oversize)


# --- the section


def test_a_ball_touches_both_flanks_where_the_section_says():
    """From coordinates: the section is what lies within both circles, the ball as low as it fits."""
    arcs = np.array([[-ARCH.offset, 0.0], [ARCH.offset, 0.0]])
    angle = np.linspace(-1.5, 1.5, 600_001)
    way = np.column_stack([np.sin(angle), -np.cos(angle)])
    middle = np.array([0.0, -COSINE * (GROOVE - BALL)])

    def out_to(centre):
        """How far it is from the middle of the ball to a circle, each way."""
        along = way @ (middle - centre)
        return -along + np.sqrt(along**2 - (middle - centre) @ (middle - centre) + GROOVE**2)

    gap = np.minimum(*map(out_to, arcs)) - BALL
    assert gap.min() == pytest.approx(0.0, abs=1e-12)
    right = angle > 0.0
    assert angle[right][gap[right].argmin()] == pytest.approx(math.radians(50.0), abs=1e-4)
    assert angle[~right][gap[~right].argmin()] == pytest.approx(-math.radians(50.0), abs=1e-4)
    assert gap[300_000] == pytest.approx(ARCH.bottom_gap, rel=1e-9)
    touched = middle + BALL * np.array([SINE, -COSINE])
    bottom = np.array([0.0, -math.sqrt(GROOVE**2 - ARCH.offset**2)])
    turned = 2.0 * math.asin(0.5 * np.linalg.norm(touched - bottom) / GROOVE)
    assert ARCH.flank == pytest.approx(GROOVE * turned, rel=1e-9)


def test_a_contact_on_a_flank_is_that_in_a_groove_on_a_cone():
    found, expected = ARCH.contact(STEEL, 10e-3), in_groove(STEEL, BALL, GROOVE, 10e-3 / COSINE)
    assert found == expected
    assert 1.0 / found.radius_x == pytest.approx(1.0 / BALL + COSINE / 10e-3)


# --- between two of them


def least_energy(ball, nearer, shifted):
    """Energy of four contacts at the place of the ball where it is least, by circles and nothing else, J."""
    off, deep = ARCH.offset, COSINE * (GROOVE - BALL)
    lower = np.array([[-off, deep], [off, deep]])
    upper = np.array([[shifted - off, -deep - nearer], [shifted + off, -deep - nearer]])

    def energy(place):
        held = 0.0
        for contact, arcs in ((ball.lower, lower), (ball.upper, upper)):
            apart = np.linalg.norm(1e-6 * place - arcs, axis=1)
            overlap = np.maximum(apart - (GROOVE - BALL) + 0.5 * ball.oversize, 0.0)
            held += 0.4 * contact.stiffness_constant * (overlap**2.5).sum()
        return held * 1e6

    found = minimize(
        energy, np.array([0.01, -0.02]), method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-15}
    )
    return found.fun * 1e-6


@pytest.mark.parametrize(("nearer", "shifted", "contacts"), [
    (0.0, 0.0, 4), (0.5e-6, 0.4e-6, 4), (-0.5e-6, 0.3e-6, 4), (0.0, 4e-6, 2), (1e-6, -5e-6, 2),
])  # fmt: skip
def test_forces_are_those_of_the_least_energy_of_all_four_contacts(nearer, shifted, contacts):
    """Of the exact circles, whose angles change: by some hundredths of what moves over r − R."""
    ball = between(raceway=12e-3)
    step = 2e-8
    found = [
        (least_energy(ball, nearer + a, shifted + b) - least_energy(ball, nearer - a, shifted - b))
        / (2.0 * step)
        for a, b in ((step, 0.0), (0.0, step))
    ]
    told = ball.forces(nearer, shifted)
    np.testing.assert_allclose(found, told, rtol=0.03, atol=0.03 * np.abs(told).max())
    assert ball.contacts(nearer, shifted) == contacts


def test_at_rest_two_lines_of_two_contacts_in_series_are_pressed_by_the_oversize():
    ball = FourPointBall(ARCH, ARCH.contact(STEEL), ARCH.contact(STEEL), 2e-6)
    force = ARCH.contact(STEEL).force(1e-6)  # each contact by half of it
    assert ball.line_forces(0.0, 0.0) == pytest.approx([force, force], rel=1e-12)
    assert ball.forces(0.0, 0.0) == pytest.approx([2.0 * force * COSINE, 0.0], abs=1e-12)
    of_line = 0.5 * ARCH.contact(STEEL).tangent_stiffness(1e-6)
    expected = 2.0 * of_line * np.diag([COSINE**2, SINE**2])
    np.testing.assert_allclose(ball.stiffness(0.0, 0.0), expected, rtol=1e-9, atol=1.0)


@pytest.mark.parametrize("place", [(0.3e-6, 0.5e-6), (0.2e-6, 4e-6)])
def test_its_stiffness_is_what_forces_change_by(place):
    ball = between()
    for column, step in enumerate(1e-10 * np.eye(2)):
        change = (ball.forces(*(place + step)) - ball.forces(*(place - step))) / 2e-10
        np.testing.assert_allclose(ball.stiffness(*place)[:, column], change, rtol=1e-6, atol=10.0)


def test_one_line_opens_where_its_approach_is_used_up():
    ball = between()
    opening = ball.opening_shift(0.5e-6)
    assert opening == pytest.approx((2e-6 + 0.5e-6 * COSINE) / SINE)
    assert [ball.contacts(0.5e-6, share * opening) for share in (0.999, 1.001)] == [4, 2]
    loose = between(oversize=-1e-6)
    assert loose.opening_shift() == 0.0
    assert [loose.contacts(0.0, shift) for shift in (0.0, 0.9e-6, 1.4e-6)] == [0, 0, 2]
    assert loose.forces(0.0, 0.9e-6).tolist() == [0.0, 0.0]


def test_the_largest_force_has_an_ellipse_as_wide_as_the_flank():
    ball = between()
    contact = ball.upper
    widest = max(
        (each.semi_axes(each.approach(ball.largest_force))[1] for each in (ball.lower, contact)),
    )
    assert widest == pytest.approx(ARCH.flank, rel=1e-9)


test_arches_that_cannot_be = refusals(
    ({"ball_radius": 0.0}, r"radius of the ball \(m\): received 0"),
    ({"groove_radius": 1.9e-3}, "radius of the groove: received 1.9 mm; allowed: more than .* ball, 2 mm"),
    ({"offset": 0.2e-3}, "offset of the arcs: received 200 µm; allowed: less than 100 µm.*unit right"),
    ({"offset": 0.0}, "offset of the arcs"),
    of=lambda changes: GothicArch(
        **{"ball_radius": BALL, "groove_radius": GROOVE, "offset": 7e-5, **changes}
    ),
)
test_displacements_that_cannot_be = refusals(
    (
        {"shifted": 30e-6},
        "displacement of the arches: received 30 µm; allowed: at most 10 µm, 0.1 of what .*Angles change",
    ),
    ({"oversize": 120e-6}, "force of a contact: received .* N; allowed: at most .* N, whose ellipse reaches"),
    of=lambda given: between(given.get("oversize", 0.0)).forces(0.0, given.get("shifted", 0.0)),
)


def test_an_angle_of_an_arch_is_more_than_zero():
    with pytest.raises(
        Exception, match=r"contact_angle of the arch \(rad\): received 1.6; allowed: more than 0"
    ):
        GothicArch.at_angle(1.6, BALL, GROOVE)
