"""Rollers between rings that are tilted while they turn: statics, energy, tones, films, refusals."""

import numpy as np
import pytest

import asperity
from asperity import RollerBearing
from asperity.case.cases import as_case
from asperity.errors import CaseError, InputError
from asperity.kernels.pointforce import evaluate_all
from asperity.laws import Areal, HertzLaw, Linear
from asperity.laws.film import WithFilm
from asperity.laws.tilted import Tilted
from asperity.reduction.stiffness import ForceCurve
from asperity.reduction.texture import StateTexture
from asperity.rolling.bearing import BearingRings, roll_bearing
from asperity.scenarios.prepared_bearing import expected, prepare_bearing
from asperity.scenes.along_rollers import along_group
from asperity.scenes.computed_bearing import compute_bearing
from asperity.scenes.figures.bearing import ball_contacts_table
from asperity.schema.bearing import RING_TILT, TILT_MOMENT
from asperity.speeds import SpeedCourse
from asperity.structures.ring import Ring
from refusals import refusals

ROLLERS = {"rollers": 7, "roller_diameter": 8e-3, "roller_length": 8e-3, "clearance": 4e-6}
CYLINDRICAL = RollerBearing(pitch_diameter=40e-3, **ROLLERS)
TAPERED = RollerBearing(pitch_diameter=40e-3 * np.cos(0.3), contact_angle=0.3, **ROLLERS)
"""Of both the cage turns 0.4 times as fast as the inner ring, so that all comes again after five turns."""
TURNS, SPEED, STEP = 5, 200.0, 3.125e-6
LOADS = {CYLINDRICAL: (1000.0, 0.0), TAPERED: (1000.0, 600.0)}


def law_of(contact, damping=20.0, texture=None):
    """The force curve of level slices, on a texture."""
    at = contact.approach(6000.0) * np.geomspace(1e-3, 1.0, 60)
    found = contact.pressed(at)
    curve = ForceCurve.from_samples(at, found.force, 10 / 9, found.stiffness[:, 0, 0])
    return Areal(curve, texture, damping)


def rolled(bearing, damping=60.0, **others):
    angle = bearing.contact_angle
    laws = [Tilted(law_of(each, damping), each) for each in (bearing.inner_contact, bearing.outer_contact)]
    held = {"radial_stiffness": 1e8, "axial_stiffness": 1e8, "damping_ratio": 0.3}
    rings = BearingRings(Ring.rigid(0.5, angle), Ring.rigid(0.3, angle, **held))
    radial, axial = LOADS[bearing]
    times = {
        "speed": SPEED,
        "duration": TURNS / SPEED,
        "settling": 0.02,
        "time_step": STEP,
        "highest_frequency": 2e4,
    }
    given = {"radial": radial, "axial": axial, "centrifugal": False} | times | others
    return roll_bearing(bearing, rings, *laws, **given)


@pytest.mark.parametrize("bearing", [CYLINDRICAL, TAPERED])
@pytest.mark.parametrize("way", ["tilt", "rotating_tilt"])
def test_slow_tilted_rings_stand_as_in_the_static_solution(bearing, way):
    """Independent of it: the energy of all slices, least over five coordinates and each roller's tilt."""
    start = {"speed": 1e-3, "duration": 2e-6, "settling": 0.0, "time_step": 1e-6}
    run = rolled(bearing, 0.0, **start, **{way: 1.2e-3})
    still = bearing.loaded(*LOADS[bearing], tilt=1.2e-3, cage_angles=run.cage[:1])
    most = still.inner_load.max()
    assert np.abs(run.inner_force[:, 0] - still.inner_load[0]).max() < 1e-9 * most
    assert np.abs(run.outer_force[:, 0] - still.outer_load[0]).max() < 1e-9 * most
    moved = run.inner_motion[:, 0] - run.outer_motion[:, 0]
    assert np.abs(moved - still.displacement[0, :3]).max() < 1e-9 * np.abs(moved).max()
    level = bearing.loaded(*LOADS[bearing], cage_angles=run.cage[:1])
    assert np.abs(level.displacement[0] - still.displacement[0])[:3].max() > 0.01 * np.abs(moved).max()
    back = rolled(bearing, 0.0, **start, **{way: -1.2e-3})
    assert np.abs(back.inner_force - run.inner_force)[:, 0].max() < 1e-9 * most
    moved_back = back.inner_motion[:, 0] - back.outer_motion[:, 0]
    arm = 0.5 * bearing.pitch_diameter * np.tan(bearing.contact_angle)
    assert moved_back[0] - moved[0] == pytest.approx(2.0 * 1.2e-3 * arm, rel=1e-9, abs=1e-15)


def test_at_a_high_speed_half_of_the_tilt_is_near_what_moments_leave():
    """At 18 000 1/min a roller presses outwards with 30 N: the outer contact holds it more."""
    fast = {"speed": 300.0, "duration": 2e-6, "settling": 0.0, "time_step": 1e-6, "centrifugal": True}
    run = rolled(CYLINDRICAL, 0.0, tilt=1.5e-3, **fast)
    still = CYLINDRICAL.loaded(1000.0, tilt=1.5e-3, speed=300.0, cage_angles=run.cage[:1])
    for force, load in ((run.inner_force, still.inner_load), (run.outer_force, still.outer_load)):
        assert np.abs(force[:, 0] - load[0]).max() < 5e-3 * load.max()


@pytest.mark.parametrize("rib", [None, 3e8])
def test_the_rib_pushes_tapered_rollers_in_a_run_as_at_rest(rib):
    bearing = TAPERED.with_(taper=0.07, rib_stiffness=rib)
    LOADS[bearing] = LOADS[TAPERED]
    slow = {"speed": 1e-3, "duration": 2e-6, "settling": 0.0, "time_step": 1e-6}
    run = rolled(bearing, 0.0, tilt=1e-3, **slow)
    still = bearing.loaded(*LOADS[bearing], tilt=1e-3, cage_angles=run.cage[:1])
    most = still.inner_load.max()
    assert still.rib_force.max() == pytest.approx(2.0 * most * np.sin(0.035), rel=1e-12)
    assert np.abs(run.inner_force[:, 0] - still.inner_load[0]).max() < 1e-9 * most
    assert np.abs(run.rib_force[:, 0] - still.rib_force[0]).max() < 1e-9 * most
    fast = rolled(bearing, 0.0, tilt=1e-3, **slow | {"speed": 100.0, "centrifugal": True})
    still = bearing.loaded(*LOADS[bearing], tilt=1e-3, speed=100.0, cage_angles=fast.cage[:1])
    assert np.abs(fast.rib_force[:, 0] - still.rib_force[0]).max() < 1e-4 * most
    turned = rolled(bearing, tilt=1e-3)
    pushed = bearing.rib_force(turned.inner_force, turned.outer_force)
    assert np.abs(turned.rib_force - pushed).max() < 1e-3 * most
    assert turned.energy.residual < 1e-6
    assert not rolled(TAPERED, 0.0, tilt=1e-3, **slow).rib_force.size


@pytest.mark.parametrize("rib", [None, 3e8])
@pytest.mark.parametrize("speed", [500.0, SpeedCourse((0.0, 1.0), (500.0, 900.0))])
def test_rollers_that_are_thrown_on_their_rib_press_the_outer_ring_no_harder(rib, speed):
    """Held by nothing else the outer ring carries the axial load, Q_o sin α Z, at any speed."""
    bearing = TAPERED.with_(taper=0.07, rib_stiffness=rib)
    LOADS[bearing] = 0.0, 600.0
    run = rolled(bearing, speed=speed, duration=2e-3, settling=2e-3, centrifugal=True)
    load = 600.0 / (7 * np.sin(0.3))
    lift = bearing.centrifugal_force(500.0) * np.cos(0.265) / np.cos(0.035)
    assert lift > 0.3 * load
    np.testing.assert_allclose(run.outer_force.mean(), load, rtol=5e-3)
    np.testing.assert_allclose(run.inner_force.mean(), load - lift, rtol=1e-2)


def test_a_rib_follows_a_speed_that_changes():
    """At a speed that is reached the rib pushes as at that speed: F_c goes with its square."""
    bearing = TAPERED.with_(taper=0.07, rib_stiffness=3e8)
    LOADS[bearing] = LOADS[TAPERED]
    times = {"duration": 1e-3, "settling": 2e-3, "centrifugal": True}
    course = SpeedCourse((0.0, 1.0), (100.0, 400.0))
    changing, even = (rolled(bearing, speed=each, **times).rib_force[:, 0] for each in (course, 100.0))
    assert np.abs(changing - even).max() < 1e-3 * even.max()


def test_a_rigid_rib_holds_what_is_thrown_at_the_speed_of_the_moment():
    bearing = TAPERED.with_(taper=0.07)
    LOADS[bearing] = LOADS[TAPERED]
    course = SpeedCourse([0.0, 1e-3], [100.0, 400.0])
    run = rolled(bearing, speed=course, duration=1e-3, settling=1e-4, centrifugal=True)
    thrown = run.rib_force - np.sin(0.035) * (run.inner_force + run.outer_force)
    expected = bearing.centrifugal_force(1.0) * course.at(run.time) ** 2 * np.sin(0.3 - 0.035)
    np.testing.assert_allclose(thrown, np.tile(expected, (7, 1)), rtol=1e-9)


def lines(run):
    """Amplitudes (directions, k) of the inner ring's motion at whole multiples of a fifth of its turns, m."""
    first = run.inner_motion[:, :-1]
    return np.abs(np.fft.rfft(first, axis=1)) / first.shape[1]


def at(*orders):
    """Places of orders of the inner ring's turns among `lines`."""
    return [round(TURNS * each) for each in orders]


@pytest.mark.parametrize("bearing", [CYLINDRICAL, TAPERED])
def test_a_tilt_that_stands_makes_tones_of_rollers_that_pass_alone(bearing):
    """Everything comes again as the next roller comes: Z f_c, 2.8 times the turns, and its multiples.

    Unloaded rollers are thrown against the outer ring: between both they would rattle as chance has it.
    """
    run = rolled(bearing, tilt=1.5e-3, centrifugal=True)
    found = lines(run)[0]
    passing = at(2.8, 5.6, 8.4)
    others = np.setdiff1d(np.arange(1, 50), passing)
    assert found[passing[0]] > 1e-9
    assert found[others].max() < 1e-4 * found[passing[0]]
    level = lines(rolled(bearing, centrifugal=True))[0]
    assert abs(found[passing[0]] / level[passing[0]] - 1.0) > 0.02
    assert run.energy.residual < 1e-6
    assert run.unconverged_steps == 0


def test_a_tilt_that_turns_is_heard_at_twice_the_turns_of_level_raceways_and_at_once_of_tapered_ones():
    """Rollers of even crowning carry alike tilted either way; raceways at an angle come nearer, too."""
    even = lines(rolled(CYLINDRICAL, rotating_tilt=1.5e-3))[0]
    tapered = lines(rolled(TAPERED, rotating_tilt=1.5e-3))
    once, twice = at(1.0, 2.0)
    assert even[twice] > 2e-8
    assert even[once] < 1e-3 * even[twice]
    assert tapered[0, once] > 10.0 * even[twice]
    assert tapered[2, twice] > 1e-8
    both = lines(rolled(CYLINDRICAL, tilt=1.5e-3, rotating_tilt=0.5e-3))[0]
    assert both[once] > 2e-8  # 2 t r cos(φ) of (t + r cos φ)²


def test_the_energy_of_a_turning_tilt_is_balanced():
    run = rolled(TAPERED, tilt=0.5e-3, rotating_tilt=1e-3)
    assert run.energy.residual < 1e-6
    assert run.unconverged_steps == 0


def test_the_force_is_that_of_the_slices_on_the_texture_of_the_law():
    contact = CYLINDRICAL.inner_contact
    along = np.arange(200) * 1e-4
    texture = StateTexture.unfiltered(-1e-6 * np.cos(along / 1e-3), 1e-4, 0.0)
    law = Tilted(law_of(contact, 3.0, texture), contact)
    assert (law.name, law.damping) == ("areal", 3.0)
    places, tilts = along[20:180:20], np.linspace(-2e-3, 2e-3, 8)
    laid = law.prepare(np.column_stack([places, tilts]))
    force, stiffness, _ = evaluate_all(laid, np.full(8, 5e-6), 0)
    expected_at = contact.pressed(5e-6 - texture.at(places)[:, 0], tilts)
    np.testing.assert_allclose(force, expected_at.force, rtol=1e-12)
    np.testing.assert_allclose(stiffness, expected_at.stiffness[:, 0, 0], rtol=1e-9)


def test_a_film_keeps_tilted_rollers_apart():
    """Under the force it has, δ = δ_dry(F) − h(F)."""
    case = as_case(CASE | {"tilt": "1 mrad", "lubricant": {"oil": "ISO VG 68"}})
    (film, _), ((contact, load), _) = case.films, case.contacts
    law = WithFilm(Tilted(law_of(contact), contact), film, load)
    laid = law.prepare(np.column_stack([np.zeros(3), [0.0, 5e-4, 1e-3]]))
    force, _, _ = evaluate_all(laid, np.full(3, contact.approach(load)), 0)
    for each, tilt in zip(force, (0.0, 5e-4, 1e-3), strict=True):
        thick = film.central(load) * (each / load) ** film.formula.central.load
        assert contact.approach(each, tilt) - thick == pytest.approx(contact.approach(load), rel=1e-9)


def test_only_a_law_that_follows_a_texture_is_tilted():
    contact = CYLINDRICAL.inner_contact
    law = Tilted(HertzLaw(1e10), contact)
    assert law.prepare(np.zeros((2, 2))).form == 3
    printed = Tilted(_Table(), contact)
    with pytest.raises(InputError, match=r"law of a tilted roller: received table.*as areal"):
        printed.prepare(np.zeros((2, 2)))


class _Table:
    """A law that looks forces up."""

    name, damping = "table", 0.0

    def prepare(self, positions):
        return Linear(1.0, 1.0).prepare(positions)._replace(form=2)


# --- as a case

CASE = {
    "kind": "roller-bearing",
    "radial": "2 kN",
    "speed": "6000 1/min",
    "duration": "20 ms",
    "settling": "2 ms",
    "bearing": {"name": "NU205"},
    "outer_raceway": {"waviness": "0.1 um"},
}


TAPER = {"name": "NU205", "contact_angle": "14 deg", "taper": "4 deg", "rib_stiffness": "300 MN/m"}


@pytest.mark.parametrize(("stiffness", "told"), [("300 MN/m", False), ("300 kN/m", True), ("300 GN/m", True)])
def test_a_rib_that_is_hardly_meant_is_doubted(stiffness, told):
    case = as_case(CASE | {"axial": "1 kN", "bearing": TAPER | {"rib_stiffness": stiffness}})
    said = [str(each.message) for each in prepare_bearing(case).caught]
    assert any(each.startswith("bearing.rib_stiffness = ") for each in said) == told


@pytest.mark.parametrize(
    ("taper", "told"), [("4 deg", False), ("5 deg", False), ("3 deg", True), ("6 deg", True)]
)
def test_rollers_whose_cones_have_another_apex_are_doubted(taper, told):
    """Of one apex on the axis tan β = D/d_m sin(α − β): 4.5 degrees here."""
    case = as_case(CASE | {"axial": "1 kN", "bearing": TAPER | {"taper": taper}})
    said = [str(each.message) for each in prepare_bearing(case).caught]
    assert (
        any(each.startswith(f"bearing.taper = {taper}: rollers that roll as cones") for each in said) == told
    )


TILTED = {"tilt": "-1 mrad", "rotating_tilt": "0.2 mrad"}


def test_a_case_tells_tilt_moment_and_time():
    level, tilted = (as_case(CASE | each) for each in ({}, TILTED))
    assert tilted.static.displacement[0, 3] == pytest.approx(-1.2e-3)
    moment = tilted.static.moment[:, 0].mean()
    assert moment < 0.0
    rows, work = expected(prepare_bearing(tilted))
    told = dict(rows)["tilt of the inner ring"]
    assert told == f"-1 mrad and 0.2 mrad that turns; {moment:.3g} N m hold it in the plane of the load"
    level_rows, level_work = expected(prepare_bearing(level))
    assert "tilt of the inner ring" not in dict(level_rows)
    beyond, level_beyond = (of.time.parts["each part alone"] for of in (work, level_work))
    assert beyond == pytest.approx(2.4 * level_beyond)


GIVING = {"tilt": "1 mrad", "tilt_stiffness": "500 N m"}


def test_a_case_tilts_as_far_as_its_shaft_gives_way():
    """At rest, mean over the cage; a run is that of this tilt."""
    case = as_case(CASE | GIVING)
    rollers = case.static
    tilts, moments = rollers.displacement[:, 3], rollers.moment[:, 0]
    np.testing.assert_allclose(moments, 500.0 * (1e-3 - tilts), rtol=1e-6)
    tilt = float(tilts.mean())
    assert case.tilts == {"tilt": tilt, "rotating_tilt": 0.0}
    told = dict(expected(prepare_bearing(case))[0])["tilt of the inner ring"]
    given = f"{1e3 * tilt:.4g} mrad, as the shaft gives way from 1 mrad"
    assert told == f"{given}; {moments.mean():.3g} N m hold it in the plane of the load"
    runs = []
    for each in (GIVING, {"tilt": f"{tilt!r} rad"}):
        short = as_case(CASE | {"duration": "10 ms", "settling": "1 ms"} | each)
        computed = compute_bearing(prepare_bearing(short), lambda *_: None)
        (run,) = computed.rolled.values()
        runs.append(run.inner_force)
        laid_out = along_group(computed)
        assert laid_out[RING_TILT] == pytest.approx(tilt)
        assert laid_out[TILT_MOMENT] == pytest.approx(moments.mean(), rel=1e-4)
    np.testing.assert_allclose(*runs, atol=1e-6)


def test_a_case_runs_tilted():
    """Its inner ring lies as much less deep than a level one as at rest, in the mean."""
    run = {"duration": "30 ms", "rotating_tilt": "0 mrad", "outer_raceway": None}
    level, tilted = (as_case(CASE | run | {"tilt": tilt}) for tilt in ("0 mrad", "-2 mrad"))
    found, still = [], []
    for case in (level, tilted):
        (rolled_case,) = compute_bearing(prepare_bearing(case), lambda *_: None).rolled.values()
        found.append((rolled_case.inner_motion - rolled_case.outer_motion)[0].mean())
        still.append(case.static.displacement[:, 0].mean())
    assert found[1] - found[0] == pytest.approx(still[1] - still[0], rel=0.05)
    assert found[1] < 0.98 * found[0]  # ends are pressed


def test_the_report_tells_what_the_rib_of_tapered_rollers_pushes():
    tapered, level = (
        asperity.run(
            CASE | {"axial": "1 kN", "bearing": TAPER | keys, "outer_raceway": None, "duration": "12 ms"}
        )
        for keys in ({}, {"taper": "0 deg", "rib_stiffness": None})
    )
    force = tapered["rolling/rib_force"].values
    ends = f"{force.min():.3g} to {force.max():.3g} N"
    assert (
        f"As it runs the rib pushes rollers along their axes by {ends}. " in ball_contacts_table(tapered).note
    )
    assert "rib pushes" not in ball_contacts_table(level).note


RUBBING = {"axial": "1 kN", "friction": 0.1, "bearing": TAPER | {"rib_height": "1.2 mm"}}


def test_ends_that_rub_on_the_rib_are_warm_by_what_drives_the_rings():
    """2π f M of heat: at rest of each roller, in the run by the mean of all forces of the rib."""
    rubbing = CASE | RUBBING | {"outer_raceway": None, "duration": "12 ms", "centrifugal": False}
    found = asperity.run(rubbing, brief=True)
    of = RollerBearing.named(
        "NU205", contact_angle=np.radians(14.0), taper=np.radians(4.0), rib_height=1.2e-3
    )
    force = found["rolling/rib_force"].values.sum(axis=1).mean()
    torque = found["bearing/rib_torque"].values
    assert torque == pytest.approx(0.1 * of.rib_lever * force, rel=1e-5)
    heat = found["bearing/rib_heat"].values
    rests = as_case(rubbing).static.rib_force
    np.testing.assert_allclose(heat, 200.0 * np.pi * 0.1 * of.rib_lever * rests, rtol=1e-9)
    assert heat.sum(axis=1).mean() == pytest.approx(200.0 * np.pi * torque[0], rel=2e-3)
    told = (
        f"asks the rings for {1e3 * torque[0]:.4g} N mm, and turns {heat.sum(axis=1).mean():.4g} W into heat"
    )
    assert told in ball_contacts_table(found).note
    assert "friction_heat" not in found["bearing"]


test_tilts_that_cannot_be_are_refused = refusals(
    ({"tilt": "0.2"}, 'tilt: received .0.2.; allowed: an angle, with its unit, as "30 deg"'),
    ({"tilt": "0.2 rad"}, "tilt: received 0.2 rad; allowed: -0.1 rad to 0.1 rad. Shafts tilt less"),
    ({"tilt": "20 mrad", "rotating_tilt": "90 mrad"}, "rotating_tilt: received 0.11 rad; allowed: below 0.1"),
    ({"tilt": "1 mm"}, "tilt: received '1 mm'"),
    (
        {"tilt_stiffness": "1 kN m", "rotating_tilt": "1 mrad"},
        "tilt_stiffness: received one beside rotating_tilt; allowed: a tilt that stands alone",
    ),
    ({"tilt_stiffness": "0 N m"}, "tilt_stiffness: received .0 N m."),
    (
        {"axial": "1 kN", "bearing": TAPER | {"taper": "4 rad"}},
        "bearing.taper: received .4 rad.; allowed: an angle",
    ),
    (
        {"bearing": TAPER},
        "axial: received 0 N beside 2000 N radially; allowed: more than 509.2 N, .* 10.6 N of them",
    ),
    ({"bearing": {"name": "NU205", "taper": "4 deg"}}, "bearing.contact_angle: received 0° of rollers that"),
    ({"bearing": {"name": "NU205", "rib_stiffness": "1 MN/m"}}, "bearing.rib_stiffness: "),
    (
        RUBBING | {"bearing": TAPER},
        "friction: received 0.1; allowed: none without bearing.taper and bearing.rib_height: rollers slide",
    ),
    (RUBBING | {"creep": {"kinetic": 0.5}}, "creep.kinetic: received 0.5; allowed: none: rollers slide"),
    ({"bearing": {"name": "NU205", "rib_height": "1 mm"}}, "bearing.rib_height: "),
    ({"tilt": "60 mrad"}, "radial: received half a width of .*Lower the load or the tilt"),
    of=lambda changes: as_case(CASE | changes),
    error=CaseError,
)
