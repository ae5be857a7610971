"""A roller bearing at rest: printed load distributions, closed forms, another solution; what turns."""

import math
import re
import warnings

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import least_squares

from asperity import RollerBearing
from asperity.errors import InputError, OutOfRangeWarning
from asperity.reference.materials import Material
from refusals import refusals

NU205 = RollerBearing.named("NU205")
ISO_STEEL = Material("steel of ISO/TS 16281", 207e9, 0.3, 7850.0)
MANY = RollerBearing(200, 1e-3, 1e-3, 80e-3, crowning="cylindrical")
TAPERED = RollerBearing(15, 7e-3, 10e-3, 45e-3, contact_angle=0.25)
OF_ENDS = "ignore:The ends of cylindrical rollers"

SJOVALL = {
    0.1: 0.1268, 0.2: 0.1737, 0.3: 0.2055, 0.4: 0.2286, 0.5: 0.2453,
    0.6: 0.2568, 0.7: 0.2636, 0.8: 0.2658, 0.9: 0.2628, 1.0: 0.2523,
}  # fmt: skip
"""J_r over the load zone ε for line contacts, as textbooks and handbooks print it: for exponent 1.1."""


def sjovalls_integral(zone, exponent):
    """(1/2π) ∫ (1 − (1 − cos ψ)/2ε)^n cos ψ dψ over the load zone."""
    end = math.acos(1.0 - 2.0 * zone)
    carried = lambda psi: (1.0 - (1.0 - math.cos(psi)) / (2.0 * zone)) ** exponent * math.cos(psi)  # noqa: E731
    return quad(carried, -end, end)[0] / (2.0 * math.pi)


# --- at rest


@pytest.mark.filterwarnings(OF_ENDS)
@pytest.mark.parametrize(("zone", "printed"), SJOVALL.items())
def test_many_rollers_carry_a_radial_load_as_sjovalls_integral(zone, printed):
    """ε = (1 − P_d/2x)/2, and F = Z Q J_r of the load Q of the roller that carries most, with 10/9."""
    assert sjovalls_integral(zone, 1.1) == pytest.approx(printed, abs=1e-4)
    heaviest = 5.0
    approach = 2.0 * MANY.inner_contact.approach(heaviest)
    moved = approach / (2.0 * zone)  # approach = x − P_d/2 = 2 ε x
    bearing = MANY.with_(clearance=2.0 * moved * (1.0 - 2.0 * zone))
    load = bearing.rollers * heaviest * sjovalls_integral(zone, 10.0 / 9.0)
    found = bearing.loaded(radial=load, cage_angles=[0.0])
    assert found.inner_load.max() == pytest.approx(heaviest, rel=1e-3)
    assert found.displacement[0, 0] == pytest.approx(moved, rel=1e-3)


@pytest.mark.filterwarnings(OF_ENDS)
def test_at_half_a_load_zone_axial_and_radial_load_are_as_printed():
    """NSK, CAT. E728g, 5.1: F_a = 1.260 F_r tan α, Q = 4.08 F_r/(Z cos α): for 1.1, 0.15 % beside 10/9."""
    angle, radial = 0.2, 300.0
    bearing = MANY.with_(contact_angle=angle)
    found = bearing.loaded(radial, 1.260 * radial * math.tan(angle), cage_angles=[0.0])
    assert found.touching[0] == pytest.approx(100, abs=2)
    assert found.inner_load.max() == pytest.approx(4.08 * radial / (200 * math.cos(angle)), rel=2e-3)


def test_under_an_axial_load_all_rollers_share_it():
    found = TAPERED.loaded(axial=3000.0)
    assert found.inner_load == pytest.approx(3000.0 / (15 * math.sin(0.25)), rel=1e-9)
    assert found.outer_load == pytest.approx(found.inner_load, rel=1e-12)


def slices_of_the_standard(approach, tilt, bearing):
    """Loads of slices (Z, n), N, as ISO/TS 16281 writes them: of N and mm, the profile twice."""
    length, n = 1e3 * bearing.roller_length, bearing.slices
    places = length * ((np.arange(n) + 0.5) / n - 0.5)
    profile = 0.00035 * 1e3 * bearing.roller_diameter * np.log(1.0 / (1.0 - (2.0 * places / length) ** 2))
    overlap = np.maximum(1e3 * approach[:, None] - places * np.tan(tilt[:, None]) - 2.0 * profile, 0.0)
    return 35948.0 * length ** (8 / 9) / n * overlap ** (10 / 9)


def test_loads_along_the_rollers_are_those_of_the_standard():
    bearing = NU205.with_(material=ISO_STEEL, roller_material=ISO_STEEL)
    found = bearing.loaded(2000.0, tilt=(1e-3, 4e-4), cage_angles=[0.1])
    psi = found.azimuth[0]
    along, across = found.displacement[0, :2]
    approach = along * np.cos(psi) + across * np.sin(psi) - 0.5 * bearing.clearance
    tilt = 1e-3 * np.cos(psi) + 4e-4 * np.sin(psi)
    loads = slices_of_the_standard(approach, tilt, bearing)
    np.testing.assert_allclose(found.inner_slices[0], loads, rtol=1e-5, atol=1e-5)
    assert loads.sum(1) @ np.cos(psi) == pytest.approx(2000.0, rel=1e-6)
    assert loads.sum(1) @ np.sin(psi) == pytest.approx(0.0, abs=1e-3)
    places = bearing.inner_contact.places
    turning = -(loads @ places) @ np.column_stack([np.cos(psi), np.sin(psi)])
    assert found.moment[0] == pytest.approx(turning, rel=1e-5)


def out_of_balance(state, bearing, load, lift, azimuth):
    """Newtons and newton metres that are missing at the inner ring and at each roller, from coordinates."""
    ring = state[:5] * [1e-5, 1e-5, 1e-5, 1e-3, 1e-3]
    outwards, turned = (state[5:].reshape(-1, 2) * [1e-5, 1e-3]).T[..., None]  # along the normal, and tilt
    cosine, sine = math.cos(bearing.contact_angle), math.sin(bearing.contact_angle)
    x, drops = bearing.inner_contact.places, bearing.inner_contact.drops
    constant = bearing.inner_contact.stiffness_constant / bearing.slices
    around = np.array([np.cos(azimuth), np.sin(azimuth)])
    tilt = (ring[3:] @ around)[:, None]
    # a point at x along a roller: how far from the axis, and along it
    radius, along = 0.5 * bearing.pitch_diameter - x * sine, x * cosine
    out = (ring[:2] @ around)[:, None] - along * tilt
    normal = cosine * out + sine * (ring[2] + radius * tilt) - 0.5 * bearing.clearance * cosine
    roller = outwards + x * turned
    inner = constant * np.maximum(normal - roller - drops, 0.0) ** (10 / 9)
    outer = constant * np.maximum(roller - drops, 0.0) ** (10 / 9)
    push, turning = inner.sum(1), inner @ (sine * radius - cosine * along)
    ring_met = [*(around @ push * cosine), sine * push.sum(), *(around @ turning)]
    on_rollers = [push + lift * cosine - outer.sum(1), 1e3 * (inner - outer) @ x]
    return np.concatenate([(np.array(load) - ring_met) * [1, 1, 1, 1e3, 1e3], *on_rollers])


@pytest.mark.parametrize(("bearing", "load", "speed"), [
    (NU205.with_(rollers=7), (1500.0, 0.0, 0.0, 0.3, 0.1), 0.0),
    (NU205.with_(rollers=5), (700.0, 0.0, 0.0, 0.2, 0.0), 400.0),
    (TAPERED.with_(rollers=5, crowning="circular", crowning_drop=4e-6), (400.0, 0.0, 900.0, 2.0, 1.0), 300.0),
])  # fmt: skip
def test_it_is_in_balance_by_another_solution(bearing, load, speed):
    """Of all coordinates at once, from forces alone: clearance, crowning, moments, centrifugal force."""
    found = bearing.loaded(load[0], load[2], moment=load[3:], speed=speed, cage_angles=[0.2])
    cage = 2.0 * np.pi * bearing.kinematics(speed).cage
    mass = np.pi / 4.0 * bearing.roller_diameter**2 * bearing.roller_length * 7850.0
    lift = mass * 0.5 * bearing.pitch_diameter * cage**2
    azimuth = found.azimuth[0]
    start = np.zeros(5 + 2 * bearing.rollers)
    start[:5] = found.displacement[0] / [1e-5, 1e-5, 1e-5, 1e-3, 1e-3] * [1.1, 1.0, 0.95, 0.9, 1.1]
    start[5::2] = 1.0
    other = least_squares(
        out_of_balance, start, args=(bearing, load, lift, azimuth), ftol=1e-15, xtol=1e-13, gtol=1e-13
    )
    assert np.abs(other.fun).max() < 1e-4
    moved = other.x[:5] * [1e-5, 1e-5, 1e-5, 1e-3, 1e-3]
    free = [0, 1, 3, 4] if bearing.contact_angle == 0.0 else range(5)
    np.testing.assert_allclose(moved[free], found.displacement[0][free], rtol=1e-4, atol=1e-9)
    assert found.outer_load.min() >= 0.999 * lift * math.cos(bearing.contact_angle)


@pytest.mark.parametrize(("bearing", "speed"), [(NU205, 0.0), (TAPERED, 200.0)])
def test_its_stiffness_is_what_a_little_more_load_meets(bearing, speed):
    loads = np.array([1500.0, 0.0, 1200.0 * (bearing is TAPERED), 0.5, 0.0])
    free = [0, 1, 3, 4] if bearing is NU205 else list(range(5))

    def at(change):
        radial, _, axial, *moment = loads + change
        return bearing.loaded(radial, axial, moment=moment, speed=speed, cage_angles=[0.1]).displacement[0]

    found = bearing.loaded(loads[0], loads[2], moment=loads[3:], speed=speed, cage_angles=[0.1])
    stiffness = found.stiffness[0][np.ix_(free, free)]
    for column, more in ((0, 1e-1), (3, 1e-4)):
        change = np.zeros(5)
        change[column] = more
        moved = (at(change) - at(-change)) / (2.0 * more)
        unit = np.zeros(5)
        unit[column] = 1.0
        np.testing.assert_allclose(stiffness @ moved[free], unit[free], atol=2e-3)
    np.testing.assert_allclose(found.stiffness[0], found.stiffness[0].T, rtol=1e-9)


def test_dampers_of_both_contacts_take_what_a_roller_between_them_leaves():
    """Alike, it follows by a half, and a pair damps as half of one; where it follows less, the inner more."""
    found = TAPERED.loaded(axial=3000.0)
    sine, cosine = math.sin(0.25), math.cos(0.25)
    expected = 15 * 10.0 * np.diag([0.5 * cosine**2, 0.5 * cosine**2, sine**2])
    np.testing.assert_allclose(found.damping(20.0), np.broadcast_to(expected, (24, 3, 3)), atol=1e-9)
    fast = TAPERED.loaded(axial=1000.0, speed=400.0, cage_angles=[0.0])
    stiff = [
        contact.tangent_stiffness(contact.approach(float(load[0, 0])))
        for contact, load in (
            (TAPERED.inner_contact, fast.inner_load),
            (TAPERED.outer_contact, fast.outer_load),
        )
    ]
    share = stiff[0] / sum(stiff)
    assert share < 0.49
    along = 15 * 20.0 * ((1.0 - share) ** 2 + share**2) * sine**2
    assert fast.damping(20.0)[0, 2, 2] == pytest.approx(along, rel=1e-6)
    alone = NU205.with_(rollers=3).loaded(500.0, cage_angles=[0.0])
    assert alone.touching[0] == 1.0
    np.testing.assert_allclose(alone.damping(20.0)[0], np.diag([10.0, 0.0, 0.0]), atol=1e-9)


def test_slip_alone_moves_tones_of_rollers():
    tones = TAPERED.tones(axial=True)
    pure = TAPERED.kinematics(1.0)
    slipped = TAPERED.kinematics(1.0, slip=0.01)
    assert tones["outer"].order == tones["outer"].highest == pytest.approx(pure.ball_pass_outer)
    assert tones["outer"].lowest == pytest.approx(slipped.ball_pass_outer)
    assert tones["inner"].highest == pytest.approx(slipped.ball_pass_inner)
    assert tones["ball"].unlike == 2


def test_a_tilt_presses_the_ends_that_lie_back_where_the_load_points():
    found = NU205.loaded(2000.0, tilt=2e-3, cage_angles=[0.0])
    straight = NU205.loaded(2000.0, cage_angles=[0.0])
    assert found.inner_slices[0, 0, 0] > found.inner_slices[0, 0, -1] == 0.0
    assert found.moment[0, 0] > 0.0 == pytest.approx(straight.moment[0, 0], abs=1e-9)
    assert found.inner_pressure.max() > straight.inner_pressure.max()
    assert found.carrying_length.max() < straight.carrying_length.max() <= NU205.roller_length


@pytest.mark.parametrize(("bearing", "axial"), [(NU205, 0.0), (TAPERED, 1200.0)])
@pytest.mark.parametrize("stiffness", [500.0, 1e5])
def test_a_shaft_gives_way_to_the_moment_of_rollers(bearing, axial, stiffness):
    """k (γ₀ − γ) in both planes is the moment of a ring that is held at γ; soft ones stand as without one."""
    free = np.array([1e-3, 2e-4])
    held = {"speed": 100.0, "cage_angles": [0.1]}
    found = bearing.loaded(1500.0, axial, tilt=free, tilt_stiffness=stiffness, **held)
    tilt = found.displacement[0, 3:]
    again = bearing.loaded(1500.0, axial, tilt=tilt, **held)
    np.testing.assert_allclose(again.moment[0], stiffness * (free - tilt), rtol=1e-6)
    np.testing.assert_allclose(again.inner_slices, found.inner_slices, rtol=1e-6, atol=1e-6)
    assert found.tilt == tilt[0] < 1e-3
    soft, loose = (
        bearing.loaded(1500.0, axial, **each, **held)
        for each in ({"tilt": free, "tilt_stiffness": 1e-3}, {"moment": [1e-6, 2e-7]})
    )
    np.testing.assert_allclose(soft.displacement[0, 3:], loose.displacement[0, 3:], atol=1e-7)


def test_the_static_load_rating_is_that_of_iso_76():
    """C₀ = 44 (1 − γ) Z L D in N and mm is 27 kN in catalogues; 4 GPa under Q = 5 C₀/Z."""
    rating = 44.0 * (1.0 - 7.5 / 39.0) * 13 * 7.8 * 7.5
    assert rating == pytest.approx(27e3, rel=0.01)
    contact = NU205.with_(crowning="cylindrical").inner_contact
    assert contact.peak_pressure(contact.approach(5.0 * rating / 13)) == pytest.approx(4.0e9, rel=0.03)


# --- what turns


def test_multiples_of_the_speed_are_those_of_the_kinematics_of_rolling():
    """Raceways of 31.5 and 46.5 mm roll on rollers of 7.5 mm: no slip at either contact."""
    assert NU205.raceway_radii == pytest.approx((15.75e-3, 23.25e-3))
    turning = NU205.kinematics(1.0)
    surface = 2.0 * np.pi * 3.75e-3 * turning.spin
    assert 2.0 * np.pi * 23.25e-3 * turning.cage == pytest.approx(surface)
    assert 2.0 * np.pi * 15.75e-3 * (1.0 - turning.cage) == pytest.approx(surface)
    assert turning.ball_pass_outer == pytest.approx(13 * 0.5 * (1.0 - 7.5 / 39.0))
    assert NU205.with_(turning="outer").kinematics(1.0).cage == pytest.approx(1.0 - turning.cage)


# --- what cannot be


def test_a_rib_is_a_spring_in_series_with_the_raceways():
    """4 sin² β/k of the two ways of Q sin β along the axis that open both contacts, by hand."""
    level = NU205.with_(contact_angle=0.25)
    tapered = level.with_(taper=0.07, rib_stiffness=3e8)
    rigid, soft = (each.loaded(axial=600.0) for each in (level, tapered))
    load = 600.0 / (NU205.rollers * np.sin(0.25))
    np.testing.assert_allclose(soft.rib_force, 2.0 * load * np.sin(0.035), rtol=1e-9)
    moved = soft.displacement[:, 2] - rigid.displacement[:, 2]
    np.testing.assert_allclose(moved, 4.0 * np.sin(0.035) ** 2 * load / 3e8 / np.sin(0.25), rtol=1e-9)
    np.testing.assert_allclose(
        tapered.with_(rib_stiffness=None).loaded(axial=600.0).displacement, rigid.displacement, rtol=1e-12
    )
    assert not rigid.rib_force.any()


def test_a_soft_rib_gives_way_by_its_force_where_rollers_are_thrown_on_it_too():
    """The ring moves by both approaches, and by 2 sin β of the way of a roller along its axis."""
    of = NU205.with_(contact_angle=0.25, taper=0.07, rib_stiffness=5e6)
    found = of.loaded(axial=2000.0, speed=400.0)
    loads = found.inner_load[0, 0], found.outer_load[0, 0]
    reached = of.inner_contact.approach(loads[0]) + of.outer_contact.approach(loads[1])
    opened = 2.0 * np.sin(0.035) * found.rib_force[0, 0] / of.rib_stiffness
    moved = found.displacement[0, 2] * np.sin(0.25) - 0.5 * of.clearance * np.cos(0.25)
    assert opened > 0.02 * reached
    assert moved == pytest.approx(reached + opened, rel=1e-9)


def test_fast_tapered_rollers_and_their_rings_are_in_balance():
    """Forces of both contacts, of the rib along the axis at α − β, and of m (d_m/2) ω² outwards."""
    of = NU205.with_(contact_angle=0.25, taper=0.07)
    found = of.loaded(800.0, 600.0, speed=200.0, cage_angles=[0.1])
    along = np.array([np.sin(0.215), np.cos(0.215)])  # outwards and towards the large end
    outer, inner = (np.array([np.cos(angle), -np.sin(angle)]) for angle in (0.25, 0.18))
    on_inner, on_outer = found.inner_load[0, :, None] * inner, found.outer_load[0, :, None] * outer
    on_rib = found.rib_force[0, :, None] * along
    thrown = [of.centrifugal_force(200.0), 0.0]
    assert np.abs(on_inner + thrown - on_outer - on_rib).max() < 1e-9 * found.inner_load.max()
    pressed = on_inner - on_rib  # on the inner ring, against it
    across = pressed[:, 0] @ np.cos(found.azimuth[0])
    np.testing.assert_allclose([across, -pressed[:, 1].sum()], [800.0, 600.0], rtol=1e-9)
    np.testing.assert_allclose(-on_outer[:, 1].sum(), 600.0, rtol=1e-9)


def cones(angle, half, **others):
    """A bearing whose raceways and rollers are cones with one apex."""
    diameter = 2.0 * 20e-3 * np.tan(half) / np.sin(angle - half)
    return RollerBearing(15, diameter, 8e-3, 40e-3, contact_angle=angle, taper=2.0 * half, **others)


def test_tapered_rollers_turn_as_cones_with_one_apex():
    """Raceways of half angles α − 2β and α: the cage turns by sin(α − 2β)/(sin(α − 2β) + sin α)."""
    angle, half = 0.3, 0.04
    of = cones(angle, half)
    inner, outer = np.sin([angle - 2.0 * half, angle])
    turning = of.kinematics(1.0)
    assert turning.cage == pytest.approx(inner / (inner + outer), rel=1e-12)
    assert turning.spin == pytest.approx(inner * outer / (inner + outer) / np.sin(half), rel=1e-12)
    assert np.divide(*of.raceway_radii) == pytest.approx(inner / outer, rel=1e-12)
    assert of.tones()["outer"].order == pytest.approx(15.0 * turning.cage, rel=1e-12)


def sides(angle, half):
    """Unit vectors from the apex, along the axis and outwards: raceways, axis of a roller; and across it."""
    inner, outer, axis, across = (
        np.array([math.cos(at), math.sin(at), 0.0])
        for at in (angle - 2.0 * half, angle, angle - half, angle - half + 0.5 * math.pi)
    )
    return inner, outer, axis, across


@pytest.mark.parametrize("turning", ["inner", "outer"])
@pytest.mark.parametrize(("angle", "half", "height"), [(0.3, 0.04, 0.7e-3), (0.5, 0.07, 1.2e-3)])
def test_the_end_of_a_roller_slides_on_the_rib_as_cones_turn(turning, angle, half, height):
    """Velocities of roller and ring, by vectors, at a place h above a raceway on which none slides."""
    of = cones(angle, half, rib_height=height, turning=turning)
    found = of.kinematics(30.0)
    inner, outer, axis, across = sides(angle, half)
    along = np.array([1.0, 0.0, 0.0])
    rings = {"inner": found.inner, "outer": found.outer}
    sense = 1.0 if turning == "outer" else -1.0
    roller = 2.0 * np.pi * (found.cage * along + sense * found.spin * axis)
    end = 70e-3
    for ring, side in (("inner", inner), ("outer", outer)):
        slides = np.cross(roller - 2.0 * np.pi * rings[ring] * along, end * side)
        assert np.abs(slides).max() < 1e-12
    slides = np.cross(roller - 2.0 * np.pi * found.inner * along, end * inner + height * across)
    assert np.linalg.norm(slides) == pytest.approx(2.0 * np.pi * 30.0 * of.rib_lever, rel=1e-9)


@pytest.mark.parametrize(("angle", "half", "height"), [(0.3, 0.04, 0.7e-3), (0.5, 0.07, 1.2e-3)])
def test_friction_on_the_rib_asks_the_rings_for_what_balances_a_roller(angle, half, height):
    """Moments about the apex: of the rib, and of what sticks along both raceways; μ Q h sin α/(2 sin β)."""
    of = cones(angle, half, rib_height=height)
    found = of.loaded(800.0, 700.0, speed=200.0, cage_angles=[0.1])
    rubs = 0.08 * found.rib_force[0]
    inner, outer, _, across = sides(angle, half)
    # forces across the plane of roller and bearing, at p, on g_i and on g_o: p F + g_i a_i + g_o a_o = 0
    place = 70e-3 * inner + height * across
    on_inner, on_outer = np.linalg.solve(np.column_stack([inner, outer])[:2], -place[:2, None] * rubs)
    asked = on_outer * outer[1]
    np.testing.assert_allclose(on_inner * inner[1] + rubs * place[1], -asked, rtol=1e-9)
    torque = found.rib_torque(0.08)[0]
    np.testing.assert_allclose(torque, np.abs(asked), rtol=1e-9)
    np.testing.assert_allclose(torque, rubs * height * math.sin(angle) / (2.0 * math.sin(half)), rtol=1e-9)
    assert np.isnan(cones(angle, half).loaded(axial=700.0).rib_torque(0.08)).all()


def test_an_axial_load_below_what_pushes_a_ring_away_is_refused():
    """Where one roller carries all, Q cos α and Q sin α; thrown rollers push it by F_c cos(α − β)/cos β."""
    of = NU205.with_(contact_angle=0.25, taper=0.07)
    push = 13 * of.centrifugal_force(200.0) * np.cos(0.215) / np.cos(0.035) * np.sin(0.25)
    for radial, speed, least in ((800.0, 0.0, 800.0 * np.tan(0.25)), (0.0, 200.0, push)):
        ends = "," if speed else "[.]"
        told = rf"axial load: .* beside {radial:g} N radially; .* {least:.4g} N, .* apart{ends}"
        with pytest.raises(InputError, match=told):
            of.loaded(radial, 0.999 * least, speed=speed)
        with OutOfRangeWarning.ignored():  # so lightly are few slices pressed
            assert of.loaded(radial, 1.2 * least, speed=speed).imbalance < 1e-9
    with pytest.raises(InputError, match=f"{push:.3g} N of them by rollers that are thrown on their rib"):
        of.loaded(0.0, 1.0, speed=200.0)


def test_the_stiffness_with_a_rib_is_the_derivative_of_its_forces():
    """Of a fast tilted bearing: central differences of what moments and forces the ring's place needs."""
    of = NU205.with_(contact_angle=0.25, taper=0.07, rib_stiffness=5e7)

    def at(axial):
        return of.loaded(800.0, axial, tilt=5e-4, speed=200.0, cage_angles=[0.1])

    less, found, more = (at(600.0 + step) for step in (-0.1, 0.0, 0.1))
    moved = (more.displacement - less.displacement)[0, :3] / 0.2
    pushed = found.stiffness[0, :3, :3] @ moved
    np.testing.assert_allclose(pushed, [0.0, 0.0, 1.0], atol=2e-6)


test_geometries_that_do_not_close = refusals(
    ({"rollers": 17}, r"rollers: received 17 of 7.5 mm on a pitch diameter of 39 mm; .* at most 7.166"),
    ({"rollers": 2}, "a whole number at least 3"),
    ({"clearance": 1e-3}, r"clearance: received 1000 µm; allowed: less than 750 µm"),
    ({"crowning": "round"}, 'crowning of the roller bearing: received .*"cylindrical"'),
    ({"crowning": "cylindrical", "crowning_drop": 1e-6}, "drop of the crowning: received 1 µm"),
    ({"crowning_straight": 1e-3}, "straight middle of the crowning: received 1 mm"),
    ({"slices": 5}, "slices of the roller bearing: received 5"),
    ({"contact_angle": 1.5}, "contact_angle of the roller bearing"),
    (
        {"taper": 0.1},
        r"contact_angle: received 0° of rollers that taper; allowed: more than their taper, 5.73°",
    ),
    ({"taper": 0.1, "contact_angle": 0.1}, "contact_angle: received 5.73° of rollers that taper"),
    ({"rib_stiffness": 1e8}, "rib_stiffness: received one of rollers that do not taper; allowed: none"),
    ({"rib_height": 1e-3}, "rib_height: received one of rollers that do not taper; allowed: none"),
    (
        {"contact_angle": 0.3, "taper": 0.1, "rib_height": 4e-3},
        "rib_height: received 4 mm; allowed: less than half a roller's 7.5 mm. It counts from the inner",
    ),
    of=lambda changes: NU205.with_(**changes),
)
test_loads_that_cannot_be = refusals(
    ({}, "load: received none; allowed: a radial or axial load, a moment, a tilt or an interference"),
    ({"radial": -1.0}, "radial load"),
    ({"radial": 1.0, "axial": 1.0}, "axial load: received 1 N; allowed: 0 N where contact_angle is 0"),
    ({"radial": 1.0, "tilt": 0.0, "moment": 0.0}, "load: received both tilt and moment"),
    ({"radial": 1.0, "moment": 0.0, "tilt_stiffness": 1.0}, "load: received both tilt_stiffness and moment"),
    ({"radial": 1.0, "tilt_stiffness": -1.0}, "tilt_stiffness (N m/rad): received -1.0"),
    (
        {"radial": 1.0, "tilt": 1.0},
        r"tilt \(rad\): received 1.0; allowed: a number, or two.*below 0.1 rad.*unit",
    ),
    ({"radial": 1.0, "moment": [1.0, 2.0, 3.0]}, "moment (N m)"),
    (
        {"radial": 300e3},
        "contact: received half a width of 0.21 radii on the inner ring; allowed: at most 0.1",
    ),
    ({"radial": 1.0, "cage_angles": ["a"]}, "angles of the cage"),
    of=lambda load: NU205.loaded(**load),
)


def test_the_name_of_a_bearing_is_known():
    with pytest.raises(Exception, match=r"bearing: received 'NU209'; allowed: one of .*NU205"):
        RollerBearing.named("NU209")


@pytest.mark.filterwarnings(OF_ENDS)
def test_a_fit_that_presses_rollers_beyond_what_lasts_is_doubted_with_the_cause():
    """Rings that overlap by 20 µm press a roller with 35948 L^(8/9) δ^(10/9), N and mm, of ISO/TS 16281."""
    tight = NU205.with_(
        clearance=-40e-6, crowning="cylindrical", material=ISO_STEEL, roller_material=ISO_STEEL
    )
    with pytest.warns(OutOfRangeWarning, match="presses every roller with .* fatigues .* looser fit") as told:
        tight.loaded(radial=100.0)
    squeezed = float(re.search(r"([\d.]+) N, without any load", str(told[0].message))[1])
    assert squeezed == pytest.approx(35948.0 * 7.8 ** (8 / 9) * 0.02 ** (10 / 9), rel=2e-3)
    crushed = NU205.with_(clearance=-300e-6)
    cause = r"A clearance of -300 µm alone presses each roller .* a looser fit"
    with pytest.warns(OutOfRangeWarning), pytest.raises(InputError, match=cause):
        crushed.loaded(radial=100.0)
    with warnings.catch_warnings(action="error"):
        NU205.with_(clearance=-20e-6).loaded(radial=100.0)


def test_doubts_are_told():
    deep = NU205.with_(crowning="circular", crowning_drop=100e-6)
    with pytest.warns(OutOfRangeWarning, match=r"Only \d+ % of the length .* is deeper than an approach of"):
        deep.loaded(radial=500.0)
    with pytest.warns(OutOfRangeWarning, match="ends of cylindrical rollers carry 100 % of the largest"):
        NU205.with_(crowning="cylindrical").loaded(radial=500.0)
    with pytest.warns(OutOfRangeWarning, match=r"ring with 4.\d+ GPa, above 4 GPa, where dents begin"):
        NU205.loaded(radial=45e3)
    with pytest.warns(OutOfRangeWarning, match=r"with 1.\d+ GPa, above 1 GPa, the hardness: the rings flow"):
        NU205.with_(hardness=1e9).loaded(radial=1500.0)
