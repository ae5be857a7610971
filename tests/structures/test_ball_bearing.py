"""A ball bearing at rest: closed forms, another solution; its kinematics against all balls; its rings."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.optimize import least_squares

from asperity import BallBearing, ModalStructure
from asperity.errors import HalfSpaceWarning, InputError, OutOfRangeWarning
from asperity.structures.ring import Around, Ring
from refusals import refusals

B6205 = BallBearing.named("6205")
TIGHT = B6205.with_(clearance=-4e-6)
OTHER = BallBearing(11, 6e-3, 30e-3, 0.515, 0.53, contact_angle=math.radians(25.0), preload=20.0)


# --- at rest


@pytest.mark.parametrize("bearing", [B6205, OTHER])
def test_under_an_axial_load_all_balls_share_it(bearing):
    """Q = F/(Z sin α), and the angle at which A (cos α₀/cos α − 1) is the approach under Q."""
    found, total = bearing.loaded(axial=90.0), 90.0 + bearing.preload
    angle, opened = found.contact_angle, math.cos(bearing.free_angle) / math.cos(found.contact_angle) - 1.0
    np.testing.assert_allclose(found.inner_angle, angle, rtol=1e-10)
    np.testing.assert_allclose(found.inner_load, total / bearing.balls / math.sin(angle), rtol=1e-9)
    approach = (found.inner_load / bearing.series_stiffness) ** (2 / 3)
    np.testing.assert_allclose(approach, bearing.groove_distance * opened, rtol=1e-8)


def test_many_balls_carry_a_radial_load_as_the_integral():
    """Q = F/(Z J), J = 1/2π ∫ cos^2.5 over the loaded half, and F = Z K x^1.5 J."""
    J = quad(lambda psi: math.cos(psi) ** 2.5, -0.5 * math.pi, 0.5 * math.pi)[0] / (2.0 * math.pi)
    many = BallBearing(200, 1e-3, 80e-3, clearance=0.0)
    found = many.loaded(radial=200.0, cage_angles=[0.0])
    closed = (200.0 / (many.balls * many.series_stiffness * J)) ** (2 / 3)
    assert found.displacement[0, 0] == pytest.approx(closed, rel=2e-4)
    assert found.stiffness[0, 0, 0] == pytest.approx(1.5 * 200.0 / closed, rel=2e-4)


def test_each_angle_of_the_cage_has_a_balance_of_its_own():
    """The same as alone, and as asked before; nobody changes what others are given as well."""
    at = [0.0, 0.1, 0.3]
    found = B6205.loaded(radial=500.0, cage_angles=at)
    np.testing.assert_allclose(found.azimuth[:, 0], at)
    for angle, displacement in zip(at, found.displacement, strict=True):
        alone = B6205.loaded(radial=500.0, cage_angles=[angle])
        np.testing.assert_allclose(alone.displacement[0], displacement, rtol=1e-7, atol=1e-13)
    assert np.ptp(found.displacement[:, 0]) > 1e-4 * found.displacement[0, 0]
    np.testing.assert_array_equal(np.isnan(found.inner_angles), found.inner_loads == 0.0)
    assert np.isnan(found.inner_angles).any()
    with pytest.raises(ValueError, match="read-only"):
        found.displacement[0] = 0.0


def test_its_geometry_is_that_of_textbooks():
    """1/R = (2/D) γ/(1 ∓ γ) along the raceways; clearance and free contact angle say the same."""
    gamma = 0.2 * math.cos(OTHER.free_angle)
    assert OTHER.free_angle == pytest.approx(math.radians(25.0))
    assert 1.0 / OTHER.inner_contact.radius_x == pytest.approx(2.0 / 6e-3 * (1.0 + gamma / (1.0 - gamma)))
    assert 1.0 / OTHER.outer_contact.radius_x == pytest.approx(2.0 / 6e-3 * (1.0 - gamma / (1.0 + gamma)))
    loose = OTHER.with_(contact_angle=None, clearance=OTHER.radial_clearance)
    assert loose.free_angle == pytest.approx(OTHER.free_angle)
    assert OTHER.radial_clearance == pytest.approx(2 * 0.045 * 6e-3 * (1 - math.cos(math.radians(25.0))))
    assert TIGHT.free_angle == 0.0
    assert BallBearing.named("6205", contact_angle=0.3).free_angle == pytest.approx(0.3)
    assert sum(OTHER.raceway_radii) == pytest.approx(30e-3)


def forces_out_of_balance(state, bearing, load, lift, azimuth):
    """Newtons that are missing at the inner ring and at each ball, from their coordinates."""
    (along, across, axial), D = state[:3] * 1e-5, bearing.ball_diameter
    balls = state[3:].reshape(-1, 2) * 1e-5  # from where they are without load, outwards and axially
    apart, cosine, sine = 0.25 * bearing.radial_clearance, np.cos(azimuth), np.sin(azimuth)
    out = np.array([(0.5 - bearing.outer_conformity) * D + apart, 0.0])  # centres of the grooves
    inn = np.column_stack([along * cosine + across * sine, np.full(azimuth.size, axial)])
    inn += [(bearing.inner_conformity - 0.5) * D - apart, 0.0]

    def pull(centres, conformity, contact):
        towards = centres - balls
        distance = np.hypot(*towards.T)[:, None]
        overlap = np.maximum(distance - (conformity - 0.5) * D, 0.0)
        return contact.stiffness_constant * overlap**1.5 * towards / distance

    inner = pull(inn, bearing.inner_conformity, bearing.inner_contact)
    on_balls = inner + pull(out, bearing.outer_conformity, bearing.outer_contact) + [lift, 0.0]
    on_ring = load - np.array([inner[:, 0] @ cosine, inner[:, 0] @ sine, inner[:, 1].sum()])
    return np.concatenate([on_ring, on_balls.ravel()])


@pytest.mark.parametrize(("bearing", "radial", "axial", "speed", "angle"), [
    (B6205, 100.0, 40.0, 30.0, 0.2), (B6205, 300.0, 10.0, 400.0, 0.1), (TIGHT, 150.0, 0.0, 100.0, 0.3),
    (OTHER, 30.0, 60.0, 300.0, 0.05), (OTHER.with_(turning="outer"), 30.0, 60.0, 200.0, 0.05),
])  # fmt: skip
def test_it_is_in_balance_by_another_solution(bearing, radial, axial, speed, angle):
    """Of all coordinates at once, from forces alone: finite Z, clearance, preload, centrifugal force."""
    found = bearing.loaded(radial, axial, speed=speed, cage_angles=[angle])
    cage = 2.0 * np.pi * bearing.kinematics(speed).cage
    lift = np.pi / 6 * bearing.ball_diameter**3 * 7850.0 * 0.5 * bearing.pitch_diameter * cage**2
    load = [radial, 0.0, axial + bearing.preload]
    azimuth = found.azimuth[0]
    start = np.zeros(3 + 2 * bearing.balls)
    start[:3] = found.displacement[0] * 1e5 * [1.3, 1.0, 0.8]
    start[3::2], start[4::2] = 0.6, 0.4 * start[2]
    least = {"xtol": 1e-15, "ftol": 1e-15, "gtol": 1e-15}
    other = least_squares(forces_out_of_balance, start, args=(bearing, load, lift, azimuth), **least)
    assert np.abs(other.fun).max() < 1e-6
    np.testing.assert_allclose(other.x[:3] * 1e-5, found.displacement[0], rtol=1e-6, atol=1e-12)


@pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")
@settings(max_examples=30)
@given(
    st.floats(0.0, 500.0), st.floats(0.1, 500.0), st.floats(0.0, 300.0), st.floats(-0.5, 2.0),
    st.sampled_from([B6205, TIGHT, OTHER]),
)  # fmt: skip
def test_forces_balance(radial, axial, speed, angle, bearing):
    found = bearing.loaded(radial, axial, speed=speed, cage_angles=[angle])
    inner, outer = np.exp(1j * np.nan_to_num([found.inner_angle, found.outer_angle]))  # inwards and along
    inward, total = found.inner_load * inner, axial + bearing.preload
    scale = max(radial, total, found.outer_load.max())
    across = (inward.real * np.exp(1j * found.azimuth)).sum()
    np.testing.assert_allclose([across, inward.imag.sum()], [radial, total], rtol=0.0, atol=2e-9 * scale)
    lift = bearing.centrifugal_force(speed)
    np.testing.assert_allclose(found.outer_load * outer - inward, lift, rtol=0.0, atol=1e-8 * scale)
    assert found.imbalance <= 1e-10


@pytest.mark.parametrize("speed", [0.0, 1e-45, 1.0, 60.0])
def test_loads_of_almost_nothing_are_in_balance_as_far_as_numbers_tell(speed):
    found = B6205.loaded(axial=5e-3, speed=speed)
    along = found.inner_load * np.sin(found.inner_angle)
    np.testing.assert_allclose(along.sum(axis=1), 5e-3, rtol=1e-6)
    assert found.imbalance <= 1e-7
    assert B6205.loaded(radial=7.0, axial=1.0, speed=7e-46, cage_angles=[0.0]).imbalance <= 1e-10


@pytest.mark.parametrize(("bearing", "speed"), [(B6205, 0.0), (TIGHT, 0.0), (OTHER, 400.0)])
def test_its_stiffness_is_what_a_little_more_load_meets(bearing, speed):
    radial, axial, more = 120.0, 30.0, 1e-3
    at = {"speed": speed, "cage_angles": [0.15]}
    found = bearing.loaded(radial, axial, **at)
    for row, (dr, da) in ((0, (more, 0.0)), (2, (0.0, more))):
        up, down = (bearing.loaded(radial + s * dr, axial + s * da, **at) for s in (1, -1))
        moved = (up.displacement[0] - down.displacement[0]) / (2.0 * more)
        np.testing.assert_allclose(found.stiffness[0] @ moved, np.eye(3)[row], atol=1e-4)


def test_the_static_load_rating_is_where_dents_begin():
    """ISO 76: 4.2 GPa under Q = 5 C₀/Z; C₀ of a 6205 is 7.8 kN in catalogues."""
    heaviest = 5.0 * 7800.0 / B6205.balls
    contact = B6205.inner_contact
    assert contact.peak_pressure(contact.approach(heaviest)) == pytest.approx(4.2e9, rel=0.02)


def test_ellipses_are_those_of_hertz():
    found = B6205.loaded(radial=100.0)
    for ring, contact in (("inner", B6205.inner_contact), ("outer", B6205.outer_contact)):
        load, peak = (getattr(found, f"{ring}_{what}")[3, 0] for what in ("load", "pressure"))
        along, across = (axis[3, 0] for axis in found.semi_axes(ring))
        assert (along, across) == pytest.approx(contact.semi_axes(contact.approach(load)))
        assert peak == pytest.approx(1.5 * load / (np.pi * along * across))
    assert set(found.touching) <= {2.0, 3.0}


def test_a_free_ball_leaves_the_inner_ring_where_its_outer_contact_takes_the_interference():
    lift = TIGHT.outer_contact.force(2e-6)
    unit = TIGHT.centrifugal_force(1.0)
    leaves = math.sqrt(lift / unit)
    assert TIGHT.loaded(speed=0.999 * leaves).touching.min() == 9
    with pytest.warns(OutOfRangeWarning, match=r"lifts balls off the inner ring") as told:
        assert TIGHT.loaded(speed=1.2 * leaves).touching.max() == 0
    (said,) = [float(str(each.message).split("leaves at ")[1].split()[0]) for each in told]
    assert said == pytest.approx(60.0 * leaves, rel=1e-3)


# --- what turns


def test_multiples_of_the_speed_are_those_printed_for_it():
    """Case Western Reserve University, bearing information: SKF 6205-2RS JEM and 6203-2RS JEM."""
    for dimensions, printed in (
        ((9, 0.3126, 1.537), (0.39828, 3.5848, 5.4152, 4.7135)),
        ((8, 0.2656, 1.122), (0.3817, 3.0530, 4.9469, 3.9874)),
    ):
        found = BallBearing(*dimensions).kinematics(1.0)
        told = found.cage, found.ball_pass_outer, found.ball_pass_inner, found.ball_defect
        assert told == pytest.approx(printed, abs=3e-4)


def test_the_ring_that_turns_and_slip():
    inner, outer = (B6205.with_(turning=ring).kinematics(10.0) for ring in ("inner", "outer"))
    assert inner.cage + outer.cage == pytest.approx(10.0)
    assert inner.turning == outer.turning == 10.0
    for name in ("ball_pass_outer", "ball_pass_inner", "ball_defect"):
        assert getattr(inner, name) == pytest.approx(getattr(outer, name))
    slow = B6205.kinematics(10.0, slip=0.01)
    assert slow.ball_pass_outer == pytest.approx(0.99 * inner.ball_pass_outer)
    assert slow.ball_pass_outer + slow.ball_pass_inner == pytest.approx(90.0)
    steep = B6205.kinematics(10.0, contact_angle=1.0)
    assert steep.cage == pytest.approx(5.0 * (1.0 - 7.94 / 39.04 * math.cos(1.0)))


@pytest.mark.parametrize("turning", ["inner", "outer"])
@pytest.mark.parametrize("part", ["outer", "inner", "ball"])
def test_waviness_makes_the_tones_that_all_balls_make_together(part, turning):
    """Sums over the balls, of every order and motion; most of them are zero."""
    bearing = BallBearing(7, 2e-3, 10e-3, turning=turning)  # the cage turns with 0.4 or 0.6, a ball with 2.4
    turns = bearing.kinematics(1.0)
    time = np.arange(4000) / 400.0
    azimuth = 2.0 * np.pi * (turns.cage * time + np.arange(7)[:, None] / 7)
    rolled = azimuth - 2.0 * np.pi * {"outer": turns.outer, "inner": turns.inner, "ball": 0}[part] * time
    heard = 0
    for order in range(1, 30):
        met = np.cos(order * rolled)
        if part == "ball":
            spot = 2.0 * np.pi * turns.spin * time
            met = np.zeros_like(azimuth)
            met[0] = np.cos(order * spot) + np.cos(order * (spot + np.pi))
        for lobes in range(4):
            together = (met * np.cos(lobes * azimuth)).sum(0)
            lines = np.flatnonzero(np.abs(np.fft.rfft(together)) > 1e-6 * time.size)
            assert turns.waviness(part, order, lobes) == pytest.approx(lines[lines > 0] / 10.0)
            heard += lines.size
    assert heard > 20


# --- what cannot be


test_geometries_that_do_not_close = refusals(
    ({"balls": 16}, r"balls: received 16 of 7.94 mm on a pitch diameter of 39.04 mm; .* at most 7.6"),
    ({"balls": 2}, "a whole number at least 3"),
    ({"ball_diameter": 0.0}, "ball_diameter of the ball bearing"),
    ({"inner_conformity": 0.5}, "inner_conformity of the ball bearing: received 0.5; .* greater than 0.5"),
    ({"contact_angle": 0.2}, "received both clearance and contact_angle"),
    ({"clearance": None, "contact_angle": 1.5}, "an angle from 0 to 1.4 rad"),
    ({"clearance": 1e-3}, r"clearance: received 1000 µm; allowed: less than 158.8 µm"),
    ({"clearance": -150e-6}, r"clearance: received -150 µm, which presses .* GPa unloaded; .* -\d+ µm"),
    ({"turning": "both"}, 'allowed: "inner", "outer"'),
    ({"preload": -1.0}, "preload"),
    of=lambda changes: B6205.with_(**changes),
)


def test_the_largest_interference_that_is_named_is_allowed():
    with pytest.raises(InputError) as refused:
        B6205.with_(clearance=-150e-6)
    most = float(refused.value.allowed.split()[0]) * 1e-6
    B6205.with_(clearance=0.99 * most)
    with pytest.raises(InputError, match=r"4.2 GPa, where dents begin \(ISO 76\)"):
        B6205.with_(clearance=1.01 * most)


@pytest.mark.parametrize(("share", "told"), [(0.98, False), (1.02, True)])
def test_a_fit_that_fatigues_steel_unloaded_is_told(share, told, recwarn):
    """From 1.5 GPa on, the fatigue load limit of ISO 281; of Hertz's contacts it grows as the root of δ."""
    load = TIGHT.interference_force(2e-6)
    contacts = TIGHT.inner_contact, TIGHT.outer_contact
    peak = max(each.peak_pressure(each.approach(load)) for each in contacts)
    TIGHT.with_(clearance=share * TIGHT.clearance * (1.5e9 / peak) ** 2).loaded(radial=100.0)
    assert any("ISO 281" in str(each.message) for each in recwarn) == told


test_loads_that_cannot_be = refusals(
    ({}, "load: received none; allowed: a radial or axial load, or a preload"),
    ({"radial": -1.0}, "radial load"),
    ({"radial": 1.0, "cage_angles": ["a"]}, "angles of the cage"),
    ({"radial": 20e3}, r"of one ball on the inner ring, a contact that fills 0.\d+ rad of the groove"),
    of=lambda load: B6205.loaded(**load),
)


def test_doubts_are_told():
    with pytest.warns(HalfSpaceWarning) as told:
        B6205.loaded(radial=2000.0)
    rings = {str(each.message).split(" the contact")[0].split("ball ")[1] for each in told}
    assert rings == {"on the inner ring", "on the outer ring"}
    soft, shallow = B6205.with_(hardness=1e9), B6205.with_(inner_conformity=0.7, outer_conformity=0.6)
    with pytest.warns(OutOfRangeWarning, match=r"inner ring with 1.06 GPa, above 1 GPa, the hardness"):
        soft.loaded(radial=100.0)
    with pytest.warns(OutOfRangeWarning, match=r"inner ring with 4.\d+ GPa, above 4.2 GPa, where dents"):
        shallow.loaded(radial=2500.0)
    with pytest.raises(
        InputError, match=r"bearing: received '6299'; allowed: a bearing that has a name. Did"
    ):
        BallBearing.named("6299")


def test_only_one_ball_right_below_the_load_is_in_balance():
    """Across it the ring is free within its clearance: the energy is flat there."""
    loose = B6205.with_(clearance=100e-6).loaded(radial=1.0, cage_angles=[0.0])
    assert loose.touching[0] == 1
    assert loose.inner_load[0, 0] == pytest.approx(1.0)


# --- its rings


MASS, RADIUS, STIFFNESS = 0.3, 26e-3, 40.0


def test_lobes_have_unit_mass_and_the_energy_of_bending_of_their_frequency():
    """∮ μ (w² + v²) R dψ = 1 with v' = −w, and ∮ EI (w″ + w)²/R³ dψ = ω², by quadrature."""
    ring = Ring.bending(MASS, RADIUS, STIFFNESS, most_lobes=4, damping_ratio=0.01)
    psi, step = np.linspace(0.0, 2 * np.pi, 720, endpoint=False, retstep=True)
    w, slope = ring.shapes(psi)
    assert np.allclose(slope[1:-1], np.gradient(w, psi, axis=0)[1:-1], atol=1e-3 * np.abs(slope).max())
    n = np.array([2, 2, 3, 3, 4, 4])
    v = -np.cumsum(w, axis=0) * step
    v -= v.mean(axis=0)
    mass = MASS / (2 * np.pi * RADIUS) * (w**2 + v**2).sum(axis=0) * RADIUS * step
    assert mass == pytest.approx(np.ones(6), rel=1e-3)
    bent = STIFFNESS / RADIUS**3 * (((1 - n**2) * w) ** 2).sum(axis=0) * step
    assert np.sqrt(bent) / (2 * np.pi) == pytest.approx(ring.natural_frequencies, rel=1e-9)


def test_a_rigid_ring_moves_as_a_mass_on_its_springs():
    ring = Ring.rigid(2.0, 0.4, radial_stiffness=8e6, axial_stiffness=2e6, damping_ratio=0.05)
    assert ring.natural_frequencies * 2 * np.pi == pytest.approx([2e3, 2e3, 1e3])
    (along, across), _ = ring.shapes([0.0, np.pi / 2])
    assert along * np.sqrt(2.0) == pytest.approx([np.cos(0.4), 0.0, np.sin(0.4)])
    assert across * np.sqrt(2.0) == pytest.approx([0.0, np.cos(0.4), np.sin(0.4)])
    assert ring.towards(np.pi / 2) * np.sqrt(2.0) == pytest.approx([0.0, 1.0, 0.0])
    assert ring.towards(1.0, "axial") * np.sqrt(2.0) == pytest.approx([0.0, 0.0, 1.0])
    assert ring.pressed(3.0, 5.0) * np.sqrt(2.0) == pytest.approx([3.0, 0.0, 5.0])


@pytest.mark.parametrize("ring", [
    Ring.rigid(2.0, 0.4, radial_stiffness=8e6, axial_stiffness=2e6),
    Ring.bending(MASS, RADIUS, STIFFNESS, 0.3, most_lobes=4, damping_ratio=0.01),
])  # fmt: skip
@pytest.mark.parametrize(("start", "spacing"), [(-40.0, 3e-4), (1.0, -2e-2), (700.0, 0.7)])
def test_shapes_at_angles_that_are_evenly_apart_are_the_shapes(ring, start, spacing):
    along = ring.shapes_along(start, spacing, 300)
    for found, expected in zip(along, ring.shapes(start + spacing * np.arange(300)), strict=True):
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-11 * np.abs(expected).max())


def around(angles, shapes):
    return Around(ModalStructure(angles, np.full(shapes.shape[1], 900.0), 0.01, shapes), 0.3)


def test_modes_around_a_circle_from_a_table_are_those_of_the_ring():
    ring = Ring.bending(MASS, RADIUS, STIFFNESS, 0.3, most_lobes=2, damping_ratio=0.01)
    table = np.linspace(0.0, 2 * np.pi, 181)
    read = around(table, ring.shapes(table)[0] / np.cos(0.3))
    at = np.array([-1.0, 0.1, 7.0])
    for found, expected in zip(read.shapes(at), ring.shapes(at), strict=True):
        assert found == pytest.approx(expected, abs=1e-6)
    assert read.towards(0.7) == pytest.approx(ring.towards(0.7), rel=1e-6)
    assert not read.towards(0.7, "axial").any()


test_what_is_no_ring_is_refused = refusals(
    (lambda: Ring.rigid(0.0), "mass of a ring"),
    (lambda: Ring.rigid(1.0, radial_stiffness=-1.0), "radial stiffness of a ring"),
    (lambda: Ring.rigid(1.0, damping_ratio=1.0), "damping_ratio.*below 1"),
    (lambda: Ring.bending(1.0, 0.1, 0.0, most_lobes=2, damping_ratio=0.1), "bending stiffness of a ring"),
    (lambda: Ring.bending(1.0, 0.1, 1.0, most_lobes=1, damping_ratio=0.1), "lobes.*2 or more"),
    (lambda: Ring.rigid(1.0).pressed(0.0, 1.0), "axial load"),
    (lambda: around([0.0, 1.0, 2.0, 3.0], np.ones((4, 1))), "angles of modes.*0 to 3.*a whole turn"),
    (
        lambda: around(np.linspace(0.0, 2 * np.pi, 9), np.linspace(1.0, 1.2, 9)[:, None]),
        "modes around a circle.*apart.*Repeat the first row",
    ),
)


def test_a_ball_is_struck_more_slowly_where_its_cage_lags():
    """D/d (1 − (d cos α/D)²) times a turn of the shaft in pure rolling, from the least angle on, less 1 %."""
    bearing = BallBearing.named("6205")
    ratio = bearing.ball_diameter / bearing.pitch_diameter
    tone = bearing.tones()["ball"]
    assert tone.order == pytest.approx((1.0 - ratio**2) / ratio, rel=1e-12)
    assert tone.lowest == pytest.approx(0.99 * tone.order, rel=1e-12)
    assert tone.highest == pytest.approx((1.0 - (ratio * np.cos(np.radians(15.2))) ** 2) / ratio, rel=1e-3)
