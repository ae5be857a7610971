"""A roller bearing that runs: what its slices feel of raceways, its static solution, its tones, refusals."""

import json
import tomllib
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.special import j0

import asperity
from asperity import Crowning, RollerBearing, SlicedContact
from asperity.case.cases import as_case, case_of
from asperity.errors import CaseError
from asperity.laws import Areal
from asperity.laws.film import WithFilm
from asperity.reduction.stiffness import ForceCurve
from asperity.rolling.bearing import BearingRings, roll_bearing
from asperity.scenarios import run_time
from asperity.scenarios.prepared_bearing import expected, prepare_bearing, raceways_of
from asperity.scenarios.raceway_grids import raceway_on
from asperity.scenarios.roller_raceways import OnRollerRaceway, on_surface
from asperity.scenes.bearing_validity import out_of_place
from asperity.scenes.computed_bearing import compute_bearing
from asperity.scenes.figures.bearing import _faults, along_roller, ball_contacts_table, films_table, load_zone
from asperity.serving.contact_preview import PressedSample
from asperity.structures.ring import Ring
from asperity.surfaces.faults import Fault
from asperity.surfaces.raceway import AroundTexture
from refusals import refusals

LOAD, RADIUS = 800.0, 6e-3
STRAIGHT = SlicedContact(113e9, 3e-3, Crowning("cylindrical", 8e-3))
CASE = {
    "kind": "roller-bearing",
    "radial": "2 kN",
    "duration": "40 ms",
    "settling": "10 ms",
    "time_step": "3 us",
    "bearing": {"name": "NU205"},
}


# --- what slices feel


@pytest.mark.parametrize("order", [30, 300])
def test_waves_are_felt_as_under_a_flat_punch_of_the_half_width(order):
    """J₀(kb), the transform of 1/π√(b² − x²), at whatever load the patch is."""
    texture = AroundTexture(waves=(order,), amplitudes=(1e-7,))
    on = on_surface(STRAIGHT, raceway_on(STRAIGHT, LOAD, RADIUS, texture), LOAD)
    half_width = STRAIGHT.semi_axes(STRAIGHT.approach(LOAD))[0]
    passed = 1e-7 * j0(order / RADIUS * half_width)
    assert np.ptp(on.felt) == pytest.approx(2.0 * abs(passed), rel=1e-3)
    wider = on.averaged(on.wavy, [[2.0 * half_width, 1.0]])[0]
    assert np.ptp(wider) == pytest.approx(2e-7 * abs(j0(2.0 * order / RADIUS * half_width)), rel=1e-3)


@pytest.mark.parametrize(("length", "lines"), [(3e-3, 1), (0.35e-3, 5)])
def test_slices_have_as_many_lines_as_a_fault_asks_for(length, lines):
    """Cells of an eighth of the fault: slices of 8/41 mm are cut into the fewest of them, an odd number."""
    spall = Fault("spall", length=length, width=length, depth=5e-6)
    surface = raceway_on(STRAIGHT, LOAD, RADIUS, faults=[spall])
    assert 8e-3 / 41 / lines <= length / 8.0
    assert surface.heights.shape[1] == 41 * lines
    assert surface.spacing[1] == pytest.approx(8e-3 / 41 / lines)


def test_of_a_wave_few_states_are_laid_out_and_what_lies_between_them_is_not_missed():
    """J₀(kb) is nearly straight over the approach: b² grows with the load, that as δ^(10/9)."""
    texture = AroundTexture(waves=(12,), amplitudes=(1e-7,))
    on = on_surface(STRAIGHT, raceway_on(STRAIGHT, LOAD, RADIUS, texture), LOAD)
    laid_out = on.build("areal").law.texture
    assert 2 < len(laid_out.approaches) < len(on.approaches) / 3
    axes = [STRAIGHT.semi_axes(each) for each in on.approaches]
    every = -on.averaged(on.wavy, axes)
    beyond = (laid_out.heights.shape[1] - on.rows) // 2
    heights = laid_out.heights[:, beyond:-beyond]
    between = np.array([np.interp(on.approaches, laid_out.approaches, each) for each in heights.T]).T
    assert np.abs(between - every).max() < 2e-5 * 1e-7
    assert np.ptp(every, axis=0).max() > 1e-9  # they are unlike


def test_the_force_of_the_law_is_that_of_all_slices():
    """Between its knots, too, but for the kinks where slices begin to touch one by one."""
    crowned = SlicedContact(113e9, 3e-3, Crowning.iso(8e-3, 7.5e-3))
    on = on_surface(crowned, raceway_on(crowned, LOAD, RADIUS), LOAD, damping=3.0)
    between = np.sqrt(on.approaches[1:] * on.approaches[:-1])
    assert on.curve.force(between) == pytest.approx(crowned.pressed(between).force, rel=1e-2)
    law = on.build("areal")
    assert law.law.damping == 3.0
    assert on.curve.inverse(LOAD) == pytest.approx(crowned.approach(LOAD), rel=1e-3)


def test_a_fault_takes_its_part_of_the_length_or_of_the_width_of_a_roller():
    """Of a straight one that loses a share of its slices the approach grows by (1 − share)^−0.9."""
    smooth, width = STRAIGHT.approach(LOAD), 11 / 41 * STRAIGHT.length

    def sunk(length):
        spall = Fault("spall", length=length, width=width, depth=1e-4)
        return -on_surface(STRAIGHT, raceway_on(STRAIGHT, LOAD, RADIUS, faults=[spall]), LOAD).over_faults

    long, short = sunk(1e-3), sunk(4e-5)
    assert long.max() == pytest.approx(smooth * ((30 / 41) ** -0.9 - 1.0), rel=0.03)
    assert 0.0 < short.max() < 0.5 * long.max()
    assert np.count_nonzero(short) < np.count_nonzero(long) < 0.1 * len(long)


def test_over_a_groove_across_its_whole_length_a_roller_sinks_onto_the_edges():
    groove = Fault("spall", length=1e-3, width=9e-3, depth=1e-4)
    on = on_surface(STRAIGHT, raceway_on(STRAIGHT, LOAD, RADIUS, faults=[groove]), LOAD)
    onto_edges = 1e-3**2 / (8.0 * STRAIGHT.radius)
    assert -on.over_faults.min() == pytest.approx(STRAIGHT.approach(LOAD) + onto_edges, rel=0.05)


# --- in time


def roll_slowly(bearing, laws):
    """A few steps at 1 kN."""
    rings = BearingRings(Ring.rigid(0.5), Ring.rigid(0.3, radial_stiffness=1e8, damping_ratio=0.02))
    return roll_bearing(
        bearing, rings, *laws, speed=0.1, radial=1000.0, duration=2e-5, time_step=1e-6, centrifugal=False
    )


def test_it_starts_as_the_static_solution_and_carries_the_load():
    """Independent of it: Newton's method on slices of both contacts (`RollerBearing.loaded`)."""
    bearing = RollerBearing.named("NU205", rollers=7)
    curve = []
    for contact in (bearing.inner_contact, bearing.outer_contact):
        at = contact.approach(8.0 * LOAD) * np.geomspace(1e-3, 1.0, 60)
        found = contact.pressed(at)
        curve.append(ForceCurve.from_samples(at, found.force, 10 / 9, found.stiffness[:, 0, 0]))
    run = roll_slowly(bearing, [Areal(each, None, 20.0) for each in curve])
    still = bearing.loaded(1000.0, cage_angles=run.cage[:1])
    np.testing.assert_allclose(run.inner_force[:, 0], still.inner_load[0], rtol=2e-3, atol=1e-3)
    moved = run.inner_motion[:2, 0] - run.outer_motion[:2, 0]
    np.testing.assert_allclose(moved, still.displacement[0, :2], rtol=1e-3, atol=1e-9)


def test_slow_rings_with_films_stand_as_in_a_static_solution_with_them():
    """Of rollers without mass: Σ Q_j cos ψ_j = F with δ_i(Q) + δ_o(Q) − h_i(Q) − h_o(Q) = u cos ψ_j."""
    case = as_case(CASE | {"radial": "1 kN", "lubricant": {"oil": "ISO VG 68"}})
    bearing = RollerBearing.named("NU205", rollers=7)
    laws, loads = [], [load for _, load in case.contacts]
    for film, load in zip(case.films, loads, strict=True):
        at = film.contact.approach(8.0 * load) * np.geomspace(1e-3, 1.0, 400)
        found = film.contact.pressed(at)
        curve = ForceCurve.from_samples(at, found.force, 10 / 9, found.stiffness[:, 0, 0])
        laws.append(WithFilm(Areal(curve, None, 20.0), film, load))
    run = roll_slowly(bearing, laws)
    forces = np.geomspace(0.01, 2000.0, 4000)
    nearer = np.zeros(len(forces))
    for film, load in zip(case.films, loads, strict=True):
        at = film.contact.approach(forces[-1]) * np.geomspace(1e-6, 1.0, 4000)
        dry = np.interp(forces, film.contact.pressed(at).force, at)
        nearer += dry - film.central(load) * (forces / load) ** film.formula.central.load
    angles = run.cage[0] + 2.0 * np.pi * np.arange(7) / 7
    moved = run.inner_motion[:2, 0] - run.outer_motion[:2, 0]
    gap = moved @ np.array([np.cos(angles), np.sin(angles)]) - 0.5 * bearing.clearance
    loads = np.interp(gap, nearer, forces, left=0.0)
    np.testing.assert_allclose(run.inner_force[:, 0], loads, rtol=5e-3, atol=0.2)
    assert loads @ np.cos(angles) == pytest.approx(1000.0, rel=2e-3)
    apart = sum(film.central(load) for film, load in zip(case.films, [loads.max()] * 2, strict=True))
    dry = bearing.loaded(1000.0, cage_angles=run.cage[:1]).displacement[0, 0]
    assert apart < dry - moved[0] < 1.6 * apart  # films of rollers that carry less are thicker


@pytest.fixture(scope="module")
def oiled():
    changes = {"lubricant": {"oil": "ISO VG 68"}, "outer_raceway": {"roughness": "20 nm"}}
    few = {"name": "NU205", "rollers": 9}
    times = {"speed": "6000 1/min", "bearing": few, "duration": "50 ms", "settling": "5 ms"}
    return asperity.run(as_case(CASE | changes | times), brief=True)


def test_a_run_with_oil_tells_the_films_of_its_rollers(oiled):
    found = oiled["bearing"].dataset
    case = case_of(tomllib.loads(oiled.attrs["case"]))
    for ring, film in zip(("inner", "outer"), case.films, strict=True):
        of = found.sel(ring=ring)
        load = float(of["ball_load"].max())
        assert float(of["heaviest_film"]) == pytest.approx(film.central(load))
        assert float(of["film_stiffness"]) == pytest.approx(film.stiffness(load))
        assert float(of["film_damping"]) == pytest.approx(film.damping(load))
    outer = found.sel(ring="outer")
    rms = float(outer["film_roughness"])
    assert 10e-9 < rms < 21e-9
    assert float(outer["heaviest_film_parameter"]) == pytest.approx(float(outer["least_film"].min()) / rms)
    assert found.attrs["film_formula"] == "Pan and Hamrock"
    assert found.attrs["left_out"] == RollerBearing.LEFT_OUT_OILED
    assert "Pan and B. J. Hamrock" in str(oiled.attrs["citations"])
    table = films_table(oiled)
    assert "Film by Pan and Hamrock" in table.note
    rows = dict(expected(prepare_bearing(case))[0])
    assert rows["not in it"] == RollerBearing.LEFT_OUT_OILED
    one = "all contacts with a ring have one damping, that under its heaviest load"
    assert one in rows["not in it"]
    assert one in oiled.attrs["verdict"]
    assert one not in RollerBearing.LEFT_OUT
    assert "µm at least; Λ" in next(told for name, told in rows.items() if name.startswith("film, outer"))


@pytest.mark.parametrize("changes", [{}, {"lubricant": {"oil": "ISO VG 68"}}])
def test_with_the_step_that_is_chosen_no_contact_is_softened(changes):
    """Five steps in a period at 70 kHz: a contact of slices is a half stiffer in impacts, not four times."""
    short = {"duration": "15 ms", "settling": "1 ms", "time_step": None, "speed": "12000 1/min"}
    case = as_case(CASE | short | changes)
    assert 4.0 < 1.0 / (case.step * case.ball_resonance) < 6.0
    (run,) = compute_bearing(prepare_bearing(case), lambda *_: None).runs.values()
    assert not run.softening.any()


def test_the_time_that_is_told_is_that_which_rollers_take():
    """Seven runs of 7 and 13 rollers, dry and with oil, took 1.6 to 1.85 µs a step of one, at pace one."""
    case = as_case(CASE | {"duration": "0.1 s", "settling": "5 ms", "laws": ["areal"]})
    prepared = prepare_bearing(case)
    _, work = expected(prepared)
    told = work.time.parts["the law areal"] / run_time.pace() - run_time.LAW
    assert 1.6e-6 < told / (work.steps * case.bearing.bearing.balls) < 1.85e-6


@pytest.fixture(scope="module")
def tree():
    fault = {"on": "outer", "length": "1 mm", "width": "6 mm", "depth": "50 um"}
    few = {"name": "NU205", "rollers": 9}
    changes = {"fault": fault, "speed": "6000 1/min", "bearing": few, "duration": "0.1 s", "settling": "5 ms"}
    return asperity.run(as_case(CASE | changes), brief=True)


def test_a_spall_of_the_outer_ring_is_heard_at_its_tone(tree):
    found = tree["bearing"].dataset
    assert found.tone.sel(part="outer") == pytest.approx(9 * 50.0 * (1.0 - 7.5 / 39.0))
    lines = dict(zip(found.part.values, found.lines_found.values[0], strict=True))
    assert lines == {"outer": 1.0, "inner": 0.0, "ball": 0.0}
    loads = found.ball_load.sel(ring="inner")
    around = (loads * np.cos(found.azimuth)).sum("ball")
    assert around.values == pytest.approx(2000.0, rel=1e-6)
    checks = json.loads(tree["contact"].attrs["validity"])
    assert not [each for each in checks if each["grade"] == "out of range"]
    pressed = tree["rolling/inner_force"].values.sum(axis=(0, 1)).mean()
    assert pressed > 2000.0


def test_what_lies_along_the_heaviest_roller_is_told_in_words_of_rollers(tree):
    found = tree["bearing"].dataset
    length = 7.8e-3
    for ring in ("inner", "outer"):
        line = found.line_load.sel(ring=ring).values
        assert line.mean() * length == pytest.approx(float(found.ball_load.sel(ring=ring).max()), rel=1e-9)
        assert float(found.line_pressure.sel(ring=ring).max()) == pytest.approx(
            float(found.peak_pressure.sel(ring=ring).max()), rel=1e-9
        )
    assert np.all(np.abs(found.along_roller) < 0.5 * length)
    assert found.attrs["element"] == "roller"
    assert found.attrs["ring_tilt"] == 0.0
    assert "tilt" not in str(along_roller.drawn(tree))
    tilted = tree.copy()
    tilted["bearing"].attrs |= {"ring_tilt": -2.74e-3, "tilt_moment": 5.483}
    told = "the pressure there is higher. The inner ring is held at a tilt of −2.74 mrad by 5.48 N m."
    assert told in str(along_roller.drawn(tilted))
    panel = along_roller.drawn(tree).chart.panels[0]
    assert panel.marks[0].y.max() == pytest.approx(float(found.line_pressure.max()) / 1e9)
    assert ball_contacts_table(tree).title == "Contacts of the rollers"
    assert next(iter(load_zone.drawn(tree).columns)) == "roller [1]"
    rows = dict(expected(prepare_bearing(as_case(CASE)))[0])
    assert {"heaviest load of a roller", "rollers that touch both rings"} < set(rows)
    assert "no rib" in rows["not in it"]
    assert "rollers" in rows["tones"]
    assert "resonance of the most loaded roller between the rings" in str(tree["scenario"].attrs)


def test_rings_of_rollers_that_cannot_be_are_told_of_rollers():
    case = as_case(CASE)
    still = np.zeros((3, 4))
    run = SimpleNamespace(
        cage=np.linspace(0.0, 1.0, 4),
        inner_force=np.zeros((13, 4)),
        inner_motion=still + 7.5e-3,
        outer_motion=still,
        flank_force=still[:0],
    )
    told = [finding.message for finding in out_of_place(case, "areal", run)]
    assert len(told) == 2
    assert told[0].startswith("displacement of a ring over the diameter of a roller")
    assert "of the rollers on the inner ring" in told[1]
    assert "ball" not in str(told)


def test_heights_count_by_the_stiffness_of_their_slices():
    """A rib at the end of a crowned roller, where nothing touches, moves nothing; one in the middle does."""
    crowned = SlicedContact(113e9, 3e-3, Crowning("circular", 8e-3, 40e-6))
    surface = raceway_on(crowned, LOAD, RADIUS)
    on = on_surface(crowned, surface, LOAD)
    at_end, amid = np.zeros((2, *surface.heights.shape))
    at_end[:, 0] = amid[:, 20] = 1e-7
    assert on.averaged(at_end, on.axes)[0] == pytest.approx(0.0, abs=1e-15)
    assert on.averaged(amid, on.axes)[0] == pytest.approx(1e-7 * on.weights[20])
    overlap = crowned.approach(LOAD) - crowned.drops
    assert on.weights[20] / on.weights[15] == pytest.approx((overlap[20] / overlap[15]) ** (1 / 9))


def test_the_case_is_laid_on_slices():
    prepared = prepare_bearing(as_case(CASE))
    inner, outer = raceways_of(prepared, None)
    assert isinstance(inner, OnRollerRaceway)
    assert inner.surface.heights.shape[1] == prepared.case.bearing.bearing.slices
    assert inner.load == prepared.case.static.inner_load.max() < outer.load
    assert as_case(CASE).title == "Roller bearing NU205 at 1800 1/min"


def test_on_the_page_the_most_loaded_roller_is_pressed_on_its_raceway():
    rough = PressedSample(as_case(CASE | {"outer_raceway": {"roughness": "20 nm"}}))
    found = rough.at(None)
    assert found["force"] == pytest.approx(rough.load, rel=1e-4)
    assert found["smooth_force"] == pytest.approx(rough.load, rel=0.2)
    assert rough.source.startswith("the most loaded roller on the outer raceway")


ROLLER_DENTED = {"on": "roller", "roller": 3, "length": "1 mm", "width": "2 mm", "depth": "20 um"}


def test_what_is_on_rollers_is_said_of_rollers():
    """As read and as written; the names that balls have are read, too, and mean the same."""
    named = as_case(CASE | {"rollers": {"waviness": "50 nm"}, "fault": ROLLER_DENTED})
    on_ball = {"ball" if name == "roller" else name: value for name, value in ROLLER_DENTED.items()}
    as_balls = as_case(CASE | {"balls": {"waviness": "50 nm"}, "fault": on_ball | {"on": "ball"}})
    assert named == as_balls
    text = named.to_toml()
    assert "[rollers]" in text
    assert 'on = "roller"' in text
    assert "ball" not in text
    assert not named.has_smooth_balls
    assert (named.fault.part, named.fault.number) == ("ball", 3)
    assert set(named.helping_changes) > {"rollers half as wavy", "5 µm less clearance", "a fifth slower"}
    assert named.called("balls") == "rollers" == next(iter({*type(named).inner} & {"balls", "rollers"}))


def test_a_dent_of_a_roller_is_drawn_on_it_and_each_part_runs_alone():
    short = {"speed": "12000 1/min", "duration": "30 ms", "settling": "1 ms"}
    short |= {"bearing": {"name": "NU205", "rollers": 5}, "rollers": {"waviness": "50 nm"}}
    found = asperity.run(as_case(CASE | short | {"fault": ROLLER_DENTED}))
    assert _faults(found) == {"ball": [(0.0, 3)]}
    alone = found["bearing"].dataset.source.values.tolist()
    assert alone == ["perfect surfaces", "the rollers", "the fault"]


def test_what_helps_is_compared_with_the_case():
    study = asperity.what_helps(as_case(CASE | {"inner_raceway": {"waviness": "0.1 um"}}))
    names = set(study.sweep["variant"])
    assert {"inner raceway half as wavy", "preloaded by 5 µm"} <= names


test_what_no_roller_bearing_has_is_refused = refusals(
    ({"laws": ["table", "areal"]}, 'laws: received table; allowed: "areal".*that of slices'),
    ({"bearing": {}}, "bearing.name: received none, and no rollers and no roller_diameter"),
    ({"bearing": {"name": "NU205", "crowning": "circular", "crowning_drop": "1 mm"}}, "crowning_drop"),
    ({"bearing": {"name": "6205"}}, "bearing.name: received '6205'"),
    ({"axial": "10 N"}, "axial: received 10 N.*contact_angle is 0"),
    ({"friction": 0.1}, "friction: received 0.1; allowed: none without bearing.taper and bearing.rib_height"),
    ({"wear_coefficient": 1e-8}, "wear_coefficient: received 1e-08; allowed: none: rollers slide nowhere"),
    ({"creep": {"kinetic": 0.5}}, "creep.kinetic: received 0.5; allowed: none: rollers slide nowhere"),
    ({"fault": {"on": "cage"}}, 'fault.on: received .cage.; allowed: "outer", "inner", "roller"'),
    ({"fault": {"length": "1 mm"}}, 'fault.on: received nothing; allowed: "outer", "inner", "roller"'),
    (
        {"fault": ROLLER_DENTED | {"roller": 14}},
        "fault.roller: received 14; allowed: 1 to 13, as many rollers",
    ),
    ({"balls": {"waviness": 1e-7}, "rollers": {"waviness": 1e-7}}, "received both balls and rollers"),
    of=lambda changes: as_case(CASE | changes),
    error=CaseError,
)
