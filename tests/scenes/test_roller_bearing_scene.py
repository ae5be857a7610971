"""A roller bearing that runs: what its slices feel of raceways, its static solution, its tones, refusals."""

import json

import numpy as np
import pytest
from scipy.special import j0

import asperity
from asperity import Crowning, RollerBearing, SlicedContact
from asperity.case.cases import as_case
from asperity.errors import CaseError
from asperity.laws import Areal
from asperity.reduction.stiffness import ForceCurve
from asperity.rolling.bearing import BearingRings, roll_bearing
from asperity.scenarios.prepared_bearing import expected, prepare_bearing, raceways_of
from asperity.scenarios.roller_raceways import OnRollerRaceway, on_surface, surface_on
from asperity.scenes.figures.bearing import along_roller, ball_contacts_table
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
    on = on_surface(STRAIGHT, surface_on(STRAIGHT, LOAD, RADIUS, texture), LOAD)
    half_width = STRAIGHT.semi_axes(STRAIGHT.approach(LOAD))[0]
    passed = 1e-7 * j0(order / RADIUS * half_width)
    assert np.ptp(on.felt) == pytest.approx(2.0 * abs(passed), rel=1e-3)
    wider = on.averaged(on.wavy, [[2.0 * half_width, 1.0]])[0]
    assert np.ptp(wider) == pytest.approx(2e-7 * abs(j0(2.0 * order / RADIUS * half_width)), rel=1e-3)


def test_the_force_of_the_law_is_that_of_all_slices():
    """Between its knots, too, but for the kinks where slices begin to touch one by one."""
    crowned = SlicedContact(113e9, 3e-3, Crowning.iso(8e-3, 7.5e-3))
    on = on_surface(crowned, surface_on(crowned, LOAD, RADIUS), LOAD, damping=3.0)
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
        return -on_surface(STRAIGHT, surface_on(STRAIGHT, LOAD, RADIUS, faults=[spall]), LOAD).over_faults

    long, short = sunk(1e-3), sunk(4e-5)
    assert long.max() == pytest.approx(smooth * ((30 / 41) ** -0.9 - 1.0), rel=0.03)
    assert 0.0 < short.max() < 0.5 * long.max()
    assert np.count_nonzero(short) < np.count_nonzero(long) < 0.1 * len(long)


def test_over_a_groove_across_its_whole_length_a_roller_sinks_onto_the_edges():
    groove = Fault("spall", length=1e-3, width=9e-3, depth=1e-4)
    on = on_surface(STRAIGHT, surface_on(STRAIGHT, LOAD, RADIUS, faults=[groove]), LOAD)
    onto_edges = 1e-3**2 / (8.0 * STRAIGHT.radius)
    assert -on.over_faults.min() == pytest.approx(STRAIGHT.approach(LOAD) + onto_edges, rel=0.05)


# --- in time


def test_it_starts_as_the_static_solution_and_carries_the_load():
    """Independent of it: Newton's method on slices of both contacts (`RollerBearing.loaded`)."""
    bearing = RollerBearing.named("NU205", rollers=7)
    curve = []
    for contact in (bearing.inner_contact, bearing.outer_contact):
        at = contact.approach(8.0 * LOAD) * np.geomspace(1e-3, 1.0, 60)
        found = contact.pressed(at)
        curve.append(ForceCurve.from_samples(at, found.force, 10 / 9, found.stiffness[:, 0, 0]))
    laws = [Areal(each, None, 20.0) for each in curve]
    rings = BearingRings(Ring.rigid(0.5), Ring.rigid(0.3, radial_stiffness=1e8, damping_ratio=0.02))
    run = roll_bearing(
        bearing, rings, *laws, speed=0.1, radial=1000.0, duration=2e-5, time_step=1e-6, centrifugal=False
    )
    still = bearing.loaded(1000.0, cage_angles=run.cage[:1])
    np.testing.assert_allclose(run.inner_force[:, 0], still.inner_load[0], rtol=2e-3, atol=1e-3)
    moved = run.inner_motion[:2, 0] - run.outer_motion[:2, 0]
    np.testing.assert_allclose(moved, still.displacement[0, :2], rtol=1e-3, atol=1e-9)


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
    panel = along_roller.drawn(tree).chart.panels[0]
    assert panel.marks[0].y.max() == pytest.approx(float(found.line_pressure.max()) / 1e9)
    assert ball_contacts_table(tree).title == "Contacts of the rollers"
    rows = dict(expected(prepare_bearing(as_case(CASE)))[0])
    assert {"heaviest load of a roller", "rollers that touch both rings"} < set(rows)
    assert "no rib" in rows["not in it"]
    assert "rollers" in rows["tones"]


def test_heights_count_by_the_stiffness_of_their_slices():
    """A rib at the end of a crowned roller, where nothing touches, moves nothing; one in the middle does."""
    crowned = SlicedContact(113e9, 3e-3, Crowning("circular", 8e-3, 40e-6))
    surface = surface_on(crowned, LOAD, RADIUS)
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


test_what_no_roller_bearing_has_is_refused = refusals(
    ({"laws": ["table", "areal"]}, 'laws: received table; allowed: "areal".*that of slices'),
    ({"bearing": {}}, "bearing.name: received none, and no rollers and no roller_diameter"),
    ({"bearing": {"name": "NU205", "crowning": "circular", "crowning_drop": "1 mm"}}, "crowning_drop"),
    ({"bearing": {"name": "6205"}}, "bearing.name: received '6205'"),
    (
        {"lubricant": {"oil": "ISO VG 68"}},
        "lubricant: received an oil; allowed: none: only contacts of balls",
    ),
    ({"axial": "10 N"}, "axial: received 10 N.*contact_angle is 0"),
    of=lambda changes: as_case(CASE | changes),
    error=CaseError,
)
