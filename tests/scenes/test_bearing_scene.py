"""A ball bearing that runs: its load at rest, how it moves, how quiet it is, which part is heard."""

import json
import math
import sys
from dataclasses import replace
from types import SimpleNamespace

import h5py
import numpy as np
import pytest

import asperity
from asperity import laws
from asperity.case.cases import as_case
from asperity.errors import CaseError, ComputationError, InputError, OutOfRangeWarning, percent
from asperity.parameters import Number, key
from asperity.reference.materials import MATERIALS
from asperity.scenarios import raceway_laws, roller_raceways, scanned_states
from asperity.scenarios.prepared_bearing import prepare_bearing
from asperity.scenes import computed_bearing
from asperity.scenes.bearing_heard import heard_group
from asperity.scenes.bearing_validity import out_of_place
from asperity.scenes.computed_bearing import bearing_rings, cage_slip, compute_bearing
from asperity.scenes.figures.bearing import ball_sliding_table, ball_turn, load_zone
from asperity.scenes.figures.sideways import friction_table
from asperity.scenes.report import page_of
from asperity.schema import VIEW_OF, spectra
from asperity.schema import bearing as schema
from asperity.structures.raceway_wear import raceway_wear
from asperity.studies.member import kept
from asperity.written_numbers import rounded
from command_line import program
from small_cases import BEARING

D, PITCH, BALLS, TURNS = 7.94e-3, 39.04e-3, 9, 30.0
RATE = 51_200.0
SMOOTH, PIT = {name: each for name, each in BEARING.items() if name != "fault"}, BEARING["fault"]
SHORT = SMOOTH | {"duration": "50 ms"}
B6205 = asperity.BallBearing.named("6205")
OUTER = 0.5 * BALLS * TURNS * (1.0 - D / PITCH)
INNER = 0.5 * BALLS * TURNS * (1.0 + D / PITCH)


OF_THREE = {
    "balls": 3, "ball_diameter": "7.94 mm", "pitch_diameter": "39.04 mm", "contact_angle": "20 deg"
}  # fmt: skip


def group(tree, name="bearing"):
    return tree[name].to_dataset()


def test_at_rest_loads_balance_pressures_are_those_of_hertz_and_tones_those_of_pure_rolling(runs):
    found = group(runs(BEARING))
    load, azimuth = found["ball_load"], found["azimuth"]
    inner = load.sel(ring="inner")
    assert (inner * np.cos(azimuth)).sum("ball").values == pytest.approx(100.0, rel=1e-8)
    assert (inner * np.sin(azimuth)).sum("ball").values == pytest.approx(0.0, abs=1e-6)
    area = math.pi * found["semi_axis_along"] * found["semi_axis_across"]
    np.testing.assert_allclose(found["peak_pressure"] * area, 1.5 * load, rtol=1e-9)
    spin = 0.5 * TURNS * PITCH / D * (1.0 - (D / PITCH) ** 2)
    assert found["part"].values.tolist() == ["outer", "inner", "ball"]
    assert found["tone"].values == pytest.approx([OUTER, INNER, 2.0 * spin], rel=1e-12)
    assert found["modulation"].values == pytest.approx([0.0, TURNS, OUTER / BALLS], rel=1e-12)


def test_a_pit_of_the_outer_ring_is_heard_at_its_tone_alone(runs):
    found = group(runs(BEARING))
    assert found["lines_found"].values[0].tolist() == [1.0, 0.0, 0.0]
    lines = found["line_frequency"].values[0, 0]
    assert lines == pytest.approx(OUTER * np.arange(1, 6), abs=0.5 / 0.1)
    assert found["line_side_bands"].values[0, 0, 0] == 0.0  # it stands still


def test_a_pit_of_the_inner_ring_has_side_bands_one_turn_beside_its_lines():
    """It turns through the load zone."""
    case = BEARING | {"fault": PIT | {"on": "inner"}, "duration": "0.25 s"}
    found = group(asperity.run(case, brief=True))
    assert found["lines_found"].values[0].tolist() == [0.0, 1.0, 0.0]
    assert found["line_frequency"].values[0, 1] == pytest.approx(INNER * np.arange(1, 6), abs=0.5 / 0.25)
    at = found["envelope_frequency"].values
    line, between, *beside = (
        found["envelope"].values[0, np.abs(at - tone) < 0.5 / 0.25].max()
        for tone in (INNER, INNER + 0.5 * TURNS, INNER - TURNS, INNER + TURNS)
    )
    assert line > min(beside) > max(0.3 * line, 5.0 * between)
    assert found["line_side_bands"].values[0, 1, 0] == pytest.approx(max(beside), rel=0.05)


def test_a_pit_strikes_by_what_the_static_load_loses_over_it():
    """Below the load, 25° and 40° beside it, and opposite, where no ball is loaded."""
    prepared, heard, lost = prepare_bearing(as_case(BEARING)), [], []
    bearing = prepared.case.bearing.bearing
    depth = -roller_raceways.felt_by(
        bearing.outer_contact, prepared.raceways[1], prepared.case.contacts[1][1]
    ).min()
    for angle in (0, 25, 40, 180):
        case = BEARING | {"fault": PIT | {"angle": f"{angle} deg"}, "duration": "50 ms"}
        tree = asperity.run(case, brief=True)
        heard.append(group(tree)["band_velocity"].values[0, 0, 2])
        load = bearing.loaded(100.0, speed=TURNS, cage_angles=[np.radians(angle)]).outer_load[0, 0]
        lost.append(load - bearing.outer_contact.force(bearing.outer_contact.approach(load) - depth))
    assert np.array(heard) / heard[0] == pytest.approx(np.array(lost) / lost[0], rel=0.3, abs=0.07)


def test_what_a_part_makes_alone_is_told(runs):
    tree = runs(BEARING)
    found = group(tree)
    assert found["source"].values.tolist() == ["perfect surfaces", "the fault"]
    alone, whole = found["alone_velocity"].values, found["band_velocity"].values[0, 0]
    assert alone[1] == pytest.approx(whole, rel=1e-12)  # nothing else is rough
    assert alone[0, 2] < 0.1 * whole[2]
    above = np.maximum(alone[1] ** 2 - alone[0] ** 2, 0.0) / np.maximum(alone[1], alone[0]) ** 2
    for band, share in zip(("300 to 1800 Hz", "1800 to 10000 Hz"), above[1:], strict=True):
        assert f"µm/s in {band} ({100 * share:.0f} % from the fault" in tree.attrs["verdict"]
    assert "no film of lubricant" in tree.attrs["verdict"]
    assert "Its envelope has lines of the outer raceway (108" in tree.attrs["verdict"]
    smooth = runs(SMOOTH)
    assert "source" not in group(smooth)
    assert "envelope" not in smooth.attrs["verdict"]  # nothing is struck
    assert tree.attrs["verdict"][:40] in tree._repr_html_()  # of a notebook, with the load zone
    assert tree.plot().axes[0].get_xlabel() == "mm"
    checks = json.loads(tree["contact"].attrs["validity"])
    assert [check["grade"] for check in checks] == ["", ""]
    assert tree["rolling/energy_residual"].values[0] < 1e-6


def test_what_runs_of_the_parts_doubt_is_not_told_beside_the_run_of_the_bearing():
    """They run beside it, and doubt the same."""
    case = as_case(BEARING | {"duration": "50 ms", "time_step": "4 us"})
    told, alone = (asperity.run(case, brief=brief).attrs["warnings"] for brief in (False, True))
    assert told == alone
    assert json.loads(told)


@pytest.mark.filterwarnings("error")
def test_what_is_doubted_of_a_bearing_that_is_laid_ready_is_kept_and_not_said():
    """So that parts, which are laid ready beside the run of the bearing, say nothing of it again."""
    inner, outer = prepare_bearing(as_case(BEARING | {"radial": "3 kN"})).caught
    assert "of one ball on the inner ring the contact fills" in str(inner.message)
    assert "of one ball on the outer ring the contact fills" in str(outer.message)


def test_bands_beyond_the_sampling_are_missing_and_a_band_that_is_given_is_taken():
    keys = {"duration": "1 s", "sampling_rate": "12.8 kHz", "envelope_band": ["4 kHz", "5 kHz"]}
    case = as_case(SMOOTH | keys)
    noise = np.random.default_rng(1).normal(size=(1, 12_800))
    found = heard_group(case, {"hertz": SimpleNamespace(vibrates=True, acceleration=noise)})
    assert np.isnan(found[schema.BAND_VELOCITY][0][0]).tolist() == [False, False, True]
    assert (found[schema.ENVELOPE_LOW], found[schema.ENVELOPE_HIGH]) == (4000.0, 5000.0)


def test_the_spectrum_of_velocity_is_that_of_the_acceleration_over_the_angular_frequency():
    """Of a sine of 3 m/s² at 1 kHz, 3/(2π 1000) m/s; its rms is the velocity in the band."""
    case = as_case(SMOOTH | {"duration": "1 s", "sampling_rate": "25.6 kHz"})
    sine = 3.0 * np.sin(2.0 * np.pi * 1e3 * np.arange(25_600) / 25_600.0)
    found = heard_group(case, {"hertz": SimpleNamespace(vibrates=True, acceleration=sine[None])})
    at = int(np.argmax(found[schema.VELOCITY_AMPLITUDE][0]))
    assert found[spectra.FREQUENCY][at] == pytest.approx(1e3, rel=1e-12)
    assert found[schema.VELOCITY_AMPLITUDE][0][at] == pytest.approx(3.0 / (2.0 * np.pi * 1e3), rel=1e-3)
    in_band = found[schema.BAND_VELOCITY][0][0][1]
    assert in_band == pytest.approx(found[schema.VELOCITY_AMPLITUDE][0][at] / math.sqrt(2.0), rel=2e-3)


def test_lines_are_looked_for_where_the_slip_of_the_cage_puts_them():
    """Blows three per cent slower than pure rolling; the envelope reaches beyond five lines of every part."""
    case = as_case(SMOOTH | {"duration": "2 s", "sampling_rate": "25.6 kHz", "cage_slip": [0.03, 0.03]})
    time, slowed = np.arange(51_200) / 25_600.0, 0.97 * OUTER
    since = np.mod(time, 1.0 / slowed)
    blows = np.exp(-since / 1e-3) * np.sin(2.0 * np.pi * 5e3 * since)
    found = heard_group(case, {"hertz": SimpleNamespace(vibrates=True, acceleration=blows[None])})
    assert found[schema.LINES_FOUND] == [[1.0, 0.0, 0.0]]
    assert found[schema.LINE_FREQUENCY][0][0] == pytest.approx(slowed * np.arange(1, 6), abs=0.5)
    assert found[schema.ENVELOPE_FREQUENCY][-1] > 5.0 * INNER


def test_the_cage_slips_within_its_bounds_and_by_its_share(runs):
    slipping = as_case(BEARING | {"cage_slip": [0.01, 0.03], "duration": "3 s"})
    drawn = cage_slip(slipping)(np.linspace(-0.01, 3.0, 20_001))
    assert 0.01 <= drawn.min() < 0.012 < 0.028 < drawn.max() <= 0.03
    whole, turn = np.arange(20), 1.0 / slipping.kinematics.cage
    values, between = (cage_slip(slipping)((whole + part) * turn - slipping.settling) for part in (0, 0.5))
    assert between[:-1] == pytest.approx(0.5 * (values[1:] + values[:-1]), rel=1e-9)
    assert len(np.unique(values)) == 20
    even = runs(SMOOTH | {"cage_slip": [0.02, 0.02]})
    azimuth = group(even, "rolling")["ball_azimuth"].values[0]
    turned = 2.0 * np.pi * 0.98 * OUTER / BALLS * (len(azimuth) - 1) / RATE
    assert azimuth[-1] - azimuth[0] == pytest.approx(turned, rel=1e-9)


def test_rings_stand_on_what_holds_them_and_the_outer_one_bends_as_its_section():
    held = {"mass": "2 kg", "radial_stiffness": "50 MN/m", "axial_stiffness": "8 MN/m", "damping_ratio": 0.1}
    bent = {"lobes": 3, "width": "15 mm", "thickness": "3 mm"}
    rings = bearing_rings(case := as_case(BEARING | {"axial": "50 N", "shaft": held, "housing": bent}))
    expected = np.sqrt(np.array([50e6, 50e6, 8e6]) / 2.0) / (2.0 * np.pi)
    assert rings.inner.natural_frequencies == pytest.approx(expected, rel=1e-12)
    assert (rings.inner.damping_ratios == 0.1).all()
    assert not rings.outer.natural_frequencies.any()
    assert bearing_rings(as_case(BEARING)).outer_bending is None
    steel, radius = MATERIALS["steel"], case.bearing.bearing.raceway_radii[1] + 1.5e-3
    n = np.array([2.0, 2.0, 3.0, 3.0])  # of a thin ring: E I/(ρ A R⁴) with I/A = h²/12
    squares = n**2 * (n**2 - 1.0) ** 2 / (n**2 + 1.0) * steel.youngs_modulus / steel.density
    expected = np.sqrt(squares * (3e-3) ** 2 / 12.0 / radius**4) / (2.0 * np.pi)
    assert rings.outer_bending.natural_frequencies == pytest.approx(expected, rel=1e-6)


def test_surfaces_lie_on_the_cells_of_their_own_contacts():
    """Of balls of that with the outer ring, which is the wider one."""
    case = as_case(SMOOTH | {"balls": {"waves": [3], "amplitudes": ["0.1 um"]}})
    prepared = prepare_bearing(case)
    inner, outer = (contact.semi_axes(contact.approach(load))[1] for contact, load in case.contacts)
    across = [each.spacing[1] for each in (*prepared.raceways, *prepared.balls)]
    assert across == pytest.approx(np.array([inner, *[outer] * (1 + BALLS)]) / 16.0, rel=1e-9)
    assert abs(inner / outer - 1.0) > 0.01


def test_lines_that_do_not_stand_out_are_not_denied():
    """What was asked of the envelope is told: a verdict of the signal may be sure of a part all the same."""
    pit = {"on": "inner", "length": "0.05 mm", "depth": "1 nm"}
    changes = {"radial": "0 N", "axial": "100 N", "fault": pit, "duration": "60 ms"}
    told = asperity.run(BEARING | changes, brief=True).attrs["verdict"]
    words = "No part has a line 4 times above what is around it in the envelope, and two such multiples. "
    assert words in told
    assert "lines of" not in told


def test_balls_differ_and_one_alone_has_the_fault():
    waves = {"balls": {"waviness": "10 nm"}, "fault": PIT | {"on": "ball"}}
    prepared = prepare_bearing(as_case(BEARING | waves))
    faults = [np.abs(surface.faults).max() for surface in prepared.balls]
    assert faults == pytest.approx([0.1e-3] + [0.0] * (BALLS - 1))
    assert not np.allclose(prepared.balls[0].line, prepared.balls[1].line, atol=1e-9)


def test_several_faults_lie_where_they_are_and_each_is_heard():
    others = {"on": "inner"}, {"on": "ball", "ball": 4}, {"angle": "90 deg"}
    case = as_case(BEARING | {"fault": [PIT, *(PIT | each for each in others)], "duration": "0.4 s"})
    prepared = prepare_bearing(case)
    assert prepared.caught == ()
    inner, outer = (np.flatnonzero(each.faults.any(axis=1)) / len(each.faults) for each in prepared.raceways)
    assert (set(np.round(8 * outer) % 8), set(np.round(8 * inner) % 8)) == ({0.0, 2.0}, {0.0})
    assert [n for n, surface in enumerate(prepared.balls, 1) if surface.faults.any()] == [4]
    tree = asperity.run(case, brief=True)
    assert group(tree)["lines_found"].values[0, :2].tolist() == [1.0, 1.0]
    drawn = load_zone.drawn(tree).chart.panels[0].marks
    marks = {mark.label: mark for mark in drawn if getattr(mark, "marker", "") == "D"}
    raceway = 0.5 * (PITCH + D) * 1e3
    assert marks["faults of the outer raceway"].x == pytest.approx([0.0, raceway], abs=0.01)
    angle, ball = 2.0 * np.pi * 3 / BALLS, marks["fault of the balls"]  # where it touches the outer ring
    at = np.array([ball.x, ball.y]) - raceway * np.array([[np.sin(angle)], [-np.cos(angle)]])
    assert np.hypot(*at) == pytest.approx(0.0, abs=0.02)


def test_faults_that_overlap_and_pressures_that_dent_are_told_before_the_run():
    heavy = prepare_bearing(as_case(BEARING | {"radial": "10 kN"}))
    assert any(issubclass(each.category, OutOfRangeWarning) for each in heavy.caught)
    prepared = prepare_bearing(as_case(BEARING | {"fault": [PIT, PIT | {"length": "0.1 mm"}]}))
    assert "their heights add up" in str(prepared.caught[0].message)
    assert prepared.raceways[1].faults.min() == pytest.approx(-0.2e-3)


@pytest.mark.filterwarnings("ignore::asperity.errors.TruncatedContactWarning")  # of few cells
def test_direct_rolls_balls_as_their_average_where_waves_are_long(monkeypatch):
    """On coarse cells: a ball's waves under the contact, and their heights beside a smooth ball."""
    case = as_case(
        {"kind": "ball-bearing", "bearing": OF_THREE, "axial": "60 N", "radial": "5 N",
         "speed": "120000 1/min", "laws": ["areal", "direct"], "duration": "2.1 ms", "settling": "0 s",
         "time_step": "3 us", "centrifugal": False, "balls": {"waves": [2], "amplitudes": ["0.2 um"]}}
    )  # fmt: skip
    directions, made = [], raceway_laws.laws_on

    def seen(*given, forwards, **keys):
        directions.append(forwards)
        return made(*given, forwards=forwards, **keys)

    monkeypatch.setattr("asperity.scenes.computed_bearing.laws_on", seen)
    monkeypatch.setattr("asperity.scenarios.raceway_grids.CELLS", (3, 4))
    monkeypatch.setattr("asperity.rolling.bearing.INSTANTS", 2)
    tree = asperity.run(case, brief=True)
    assert directions == [False, True]  # balls run forwards on the ring that stands still
    force = tree["rolling/outer_force"].values[..., 20:-20]  # without the ends of the filter
    assert force[1].std(axis=1).min() > 0.03 * force[1].mean()
    varying = force - force.mean(axis=-1, keepdims=True)
    assert np.std(varying[0] - varying[1]) < 0.05 * np.std(varying[1])
    off = []
    for ring in ("inner", "outer"):
        found, solved = tree[f"rolling/{ring}_force"].values
        off.append(percent(np.sqrt(np.mean((found - solved) ** 2) / solved.var(axis=1).mean())))
    *_, check = json.loads(tree["contact"].attrs["validity"])
    assert check["quantity"].startswith("areal from direct")
    assert check["value"].split(", ")[:2] == off


def test_forces_that_leave_the_states_scanned_have_more_scanned_and_are_those_of_all(monkeypatch):
    keys = {
        "bearing": OF_THREE,
        "radial": "5 N",
        "axial": "60 N",
        "speed": "120000 1/min",
        "centrifugal": False,
    }
    keys |= {"laws": ["table"], "duration": "2.1 ms", "settling": "0 s", "time_step": "3 us"}
    prepared = prepare_bearing(as_case(BEARING | keys))
    ends, found = [], []
    monkeypatch.setattr(
        raceway_laws.OnRaceway,
        "build",
        lambda on, law, states, made=raceway_laws.OnRaceway.build: (
            ends.append(states.stop) or made(on, law, states)
        ),
    )
    for shares in ((0.0, 1e9), (0.2, 0.3)):
        monkeypatch.setattr(scanned_states, "EXPECTED", shares)
        found += compute_bearing(prepared, lambda *_: None).runs.values()
    whole, *_ = ends
    first, last = ends[4], ends[-2]
    assert first < last < whole
    rolled = computed_bearing.roll_bearing

    def fail_at_first(*given, **keys):
        monkeypatch.setattr(computed_bearing, "roll_bearing", rolled)
        raise ComputationError("no rest", "another load")

    monkeypatch.setattr(computed_bearing, "roll_bearing", fail_at_first)
    found += compute_bearing(prepared, lambda *_: None).runs.values()
    every, few, failed = (run.outer_force for run in found)
    assert np.std(few - every) < 3e-3 * np.std(every)
    np.testing.assert_array_equal(failed, every)  # what fails in the states expected is rolled over all


def test_forces_of_a_bearing_stand_by_contact_each_a_ball_on_a_ring(runs, tmp_path):
    """Those on the inner ring carry the load; on the outer one balls press by centrifugal force, too."""
    tree = runs(BEARING)
    found = group(tree, "rolling")
    assert found["contact_force"].dims == ("law", "contact", "time")
    main = found["contact_force"].values[0]
    means = {}
    for ring in ("inner", "outer"):
        on_it = found["contact_ring"].values == ring
        azimuth = found["ball_azimuth"].sel(ball=found["contact_ball"].values[on_it]).values
        carried = np.sum(main[on_it] * [np.cos(azimuth), np.sin(azimuth)], axis=1)
        assert carried.mean(axis=1) == pytest.approx([100.0, 0.0], abs=1.0)
        means[ring] = main[on_it].mean()
        peak = kept(tree)["peak_force"].sel(ring=ring).values
        assert peak == main[on_it].max()
        turn = next(each for each in ball_turn.collect(tree).lines if each.name == f"{ring} force")
        of_first = main[on_it & (found["contact_ball"].values == 1)][0]
        np.testing.assert_array_equal(turn.values, of_first[-len(turn.values) :])
    pressing = B6205.centrifugal_force(TURNS)
    assert means["outer"] - means["inner"] == pytest.approx(pressing, rel=0.02)
    path = asperity.save(tree, tmp_path / "run.nc")
    with h5py.File(path) as file:
        assert {name for name in file["rolling"] if name.endswith("_force")} == {"contact_force"}
    again = asperity.open_result(path)
    assert again.identical(tree)
    earlier = again["rolling/outer_force"]  # as scripts of before call it
    assert earlier.dims == ("law", "ball", "time")
    np.testing.assert_array_equal(earlier.values[0], main[found["contact_ring"].values == "outer"])
    assert np.shares_memory(earlier.values, again["rolling/contact_force"].values)
    again["rolling/contact_ring"][:] = "inner"
    asperity.save(again, path)
    with pytest.raises(InputError, match="a damaged file"):
        asperity.open_result(path)


def test_balls_slide_in_their_grooves_without_spin_under_a_radial_load(runs):
    """Heat by the groove alone is 0.161 Q a² κ V/R_x, at the speed of a ball on the outer raceway."""
    tree = runs(BEARING)
    found = group(tree)
    of = B6205
    load, across = found["ball_load"].values, found["semi_axis_across"].values
    between = (load > 0.0).all(axis=0)
    assert 0 < between.sum() < between.size
    spin, rim, heat = (found[name].values for name in ("spin_creepage", "rim_creepage", "sliding_heat"))
    for each in (spin, rim, heat):
        np.testing.assert_array_equal(np.isfinite(each), np.broadcast_to(between, each.shape))
    np.testing.assert_allclose(spin[:, between], 0.0, atol=1e-6)
    speed = 2.0 * np.pi * OUTER / BALLS * 0.5 * (PITCH + D)
    curvature = 0.5 * (2.0 / D + 1.0 / (0.52 * D))
    for row, contact in enumerate((of.inner_contact, of.outer_contact)):
        at_rim = across[row] ** 2 * curvature / (2.0 * contact.radius_x)
        expected = 0.16114 * load[row] * at_rim * speed
        np.testing.assert_allclose(heat[row][between], expected[between], rtol=3e-3)
        np.testing.assert_allclose(rim[row][between], (1.0 - 0.3473**2) * at_rim[between], rtol=1e-4)
    page = page_of(tree)
    sliding = ball_sliding_table(tree)
    assert sliding.head == [
        "ball at",
        "contact with",
        "spin / (rad/m)",
        "sliding at the rim / %",
        "heat over μ / W",
    ]
    rows = [[cell.text for cell in row[:2]] for row in sliding.rows[:4]]
    assert rows == [["0°", "inner ring"], ["0°", "outer ring"], ["40°", "inner ring"], ["40°", "outer ring"]]
    told = [float(row[4].text) for row in sliding.rows[:2]]
    np.testing.assert_allclose(told, heat[:, 0, 0], rtol=5e-3)
    assert "Sliding of the balls" in page
    for of_paths in ("How far the levels may be off", "contacts vary by, rms", "contact 1 of"):
        assert of_paths not in page


def test_raceways_wear_by_the_work_of_sliding_where_a_coefficient_is_given(runs):
    """Archard: the volume is k/H of the heat over friction of all contacts; the page says how deep."""
    tree = asperity.run(SHORT | {"wear_coefficient": 1e-8}, brief=True)
    found = group(tree)
    assert "wear_rate" not in group(runs(BEARING))
    heat = found["sliding_heat"].sum("ball").mean("cage_angle")
    np.testing.assert_allclose(found["worn_volume_rate"], 1e-8 / B6205.hardness * heat, rtol=1e-9)
    case = as_case(BEARING)
    deepest = raceway_wear(case.static, case.kinematics, 1e-8).depth.max(axis=2)
    np.testing.assert_allclose(found["wear_rate"], deepest)
    depth = found["wear_rate"].sel(ring="outer")
    assert abs(np.sin(found["raceway_angle"].values[depth.values.argmax()])) < 0.1
    assert float(depth.min()) == 0.0
    page = page_of(tree)
    assert "Wear of the raceways" in page
    assert "if all of each contact slips" in page
    assert any("Archard" in each for each in json.loads(tree.attrs["citations"]))


def test_friction_takes_less_heat_than_if_all_slipped_and_turns_the_rings_against_it(runs, monkeypatch):
    """At rest; and in time under the forces of the run, whose torque hardly differs on even raceways."""
    monkeypatch.setattr("asperity.structures.bearing_statics.STEPS", 4)  # angles of the cage
    tree = asperity.run(SHORT | {"friction": 0.1, "wear_coefficient": 1e-8}, brief=True)
    found = group(tree)
    assert "friction_heat" not in group(runs(BEARING))
    heat, most = found["friction_heat"].values, 0.1 * found["sliding_heat"].values
    touching = np.isfinite(most)
    np.testing.assert_array_equal(np.isfinite(heat), touching)
    assert np.all(heat[touching] <= 1.005 * most[touching])
    assert 0.5 * most[touching].sum() < heat[touching].sum() < 0.99 * most[touching].sum()
    slips = found["slip_share"].values[touching]
    assert 0.0 <= slips.min() < slips.max() < 1.0
    np.testing.assert_allclose(found["spin_moment"].values[touching], 0.0, atol=1e-9)  # no contact angle
    torque = found["friction_torque"].values[0]
    power = tree["rolling/friction_power"].values[0].sum(axis=0)
    turns = as_case(BEARING).kinematics
    assert power.mean() / (2.0 * np.pi * turns.inner) == pytest.approx(torque, rel=1e-9)
    assert power.mean() == pytest.approx(np.nansum(heat, axis=(0, 2)).mean(), rel=0.1)
    kept_numbers = [each for each in tree["rolling"].data_vars.values() if "time" in each.dims]
    size = sum(each.size for each in kept_numbers if VIEW_OF not in each.attrs)
    assert size <= as_case(SHORT | {"friction": 0.1}).numbers_written < 1.25 * size
    worn = 1e-8 / (0.1 * B6205.hardness) * np.nansum(heat, axis=2).mean(axis=1)
    np.testing.assert_allclose(found["worn_volume_rate"], worn, rtol=1e-6)
    page = page_of(tree)
    assert "by what slips with the friction of the case, where the groove wears most" in page
    assert "With the friction of the case, parts of a contact stick" in page
    assert f"ask the rings for {rounded(1e3 * torque)} N mm" in page
    assert "The contact that makes more heat of the two most loaded ones of both rings" in page
    rows = [[cell.text for cell in row] for row in friction_table(tree).rows]
    assert [row[0] for row in rows] == [
        "inner ring",
        "outer ring",
        *(f"in time, {law}" for law in BEARING["laws"]),
    ]
    assert any("Kalker" in each for each in json.loads(tree.attrs["citations"]))


def test_no_force_is_written_below_zero_where_a_ball_leaves_the_ring(runs):
    """The filter that thins a record rings where a force begins or ends at once: by newtons at a pit."""
    found = group(runs(BEARING), "rolling")
    assert found["inner_force"].values.min() == 0.0
    assert found["outer_force"].values.min() > 0.0  # centrifugal force keeps balls on it


@pytest.mark.parametrize(
    ("share", "moved", "words"),
    [(1.0, 1e-5, []), (0.3, 1e-5, ["a mean radial force of 0.3 loads"]), (1.0, D, ["by 100 % of a ball"])],
)
def test_a_bearing_whose_rings_or_forces_cannot_be_is_doubted(share, moved, words):
    """Nine balls that carry 100 N, or a part of it, along the load; a ring that is off by a ball."""
    case = as_case(SMOOTH)
    cage = np.linspace(0.0, 2.0 * math.pi, 50)
    along = np.cos(cage + 2.0 * math.pi / BALLS * np.arange(BALLS)[:, None]).clip(0.0)
    run = SimpleNamespace(
        cage=cage,
        inner_force=share * 100.0 * along / np.sum(along**2, axis=0),
        inner_motion=np.full((3, 50), moved),
        outer_motion=np.zeros((3, 50)),
        flank_force=np.zeros((0, 50)),
    )
    told = [finding.brief for finding in out_of_place(case, "hertz", run)]
    assert len(told) == len(words)
    assert all(words[n] in each for n, each in enumerate(told)), told


def test_balls_carry_the_preload_along_the_axis():
    case = as_case(SMOOTH | {"radial": "0 N", "bearing": SMOOTH["bearing"] | {"preload": "60 N"}})
    carried = 60.0 / (BALLS * math.sin(case.static.contact_angle))
    for share, words in ((1.0, []), (0.4, ["a mean axial force of 0.4 loads"])):
        run = SimpleNamespace(
            cage=np.linspace(0.0, 1.0, 9),
            inner_force=np.full((BALLS, 9), share * carried),
            inner_motion=np.zeros((3, 9)),
            outer_motion=np.zeros((3, 9)),
            flank_force=np.zeros((0, 9)),
        )
        told = [finding.brief for finding in out_of_place(case, "hertz", run)]
        assert len(told) == len(words)
        assert all(word in each for word, each in zip(words, told, strict=True))


def test_a_law_that_is_registered_rolls_in_a_bearing_with_keys_of_its_own(tmp_path):
    """Of Hertz's force times a factor: once it is that of `hertz`, and twice it holds the ring nearer."""

    def build(materials):
        constant = materials.parameters["factor"] * materials.hertz_constant
        law = laws.HertzLaw(constant, materials.line, materials.damping, materials.name)
        return replace(law, plane=materials.line_at_load)

    factor = key(Number(above=0), 1.0, "times Hertz")
    laws.register(laws.LawSpec("stiffer", "Hertz, times a factor.", build, parameters={"factor": factor}))
    try:
        case = as_case(SHORT | {"laws": ["hertz", "stiffer"]})
        tree = asperity.run(case)
        hertz, alike = tree["rolling/inner_force"].values
        np.testing.assert_array_equal(alike, hertz)
        twice = asperity.run(case.with_(laws=["stiffer"], stiffer={"factor": 2.0}), brief=True)
        sag, nearer = (each["rolling/ring_motion"].values[0, 0, 0].mean() for each in (tree, twice))
        assert 0.0 < nearer < sag
        assert "stiffer" in asperity.report(tree, tmp_path).read_text()
        with pytest.raises(
            CaseError, match=r'stiffer: received keys of a law that is not rolled; .*"stiffer"'
        ):
            case.with_(laws=["hertz"], stiffer={"factor": 2.0})
    finally:
        laws.unregister("stiffer")


KILLED_HALF_WAY = """
import os, signal, sys
import asperity
from asperity.rolling import bearing, stepper
from asperity.scenarios import raceway_grids
from asperity.scenarios.prepared_bearing import prepare_bearing
from asperity.scenes.computed_bearing import compute_bearing

raceway_grids.CELLS = (3, 4)
bearing.INSTANTS, stepper.SAVE_EVERY = 1, 0.0

def progress(done, total, message):
    if message == "rolling" and done >= 0.5 * total:
        os.kill(os.getpid(), signal.SIGKILL)

compute_bearing(prepare_bearing(asperity.read_case(sys.argv[1])), progress)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="processes are ended by signals")
@pytest.mark.filterwarnings("ignore::asperity.errors.PhysicsWarning")  # of few cells
def test_direct_in_a_bearing_that_was_killed_goes_on_to_the_last_bit(monkeypatch, tmp_path):
    """Balls with waves on their own: their surfaces, and what each contact started from, come back."""
    case = as_case(
        {"kind": "ball-bearing", "bearing": OF_THREE, "axial": "60 N", "speed": "600000 1/min",
         "laws": ["direct"], "duration": "1 ms", "settling": "0 s", "time_step": "15 us",
         "centrifugal": False, "balls": {"waves": [2], "amplitudes": ["0.2 um"]}}
    )  # fmt: skip
    monkeypatch.setattr("asperity.scenarios.raceway_grids.CELLS", (3, 4))
    monkeypatch.setattr("asperity.rolling.bearing.INSTANTS", 1)
    prepared = prepare_bearing(case)
    steps = []

    def rolled():
        steps.clear()
        told = lambda done, total, message: steps.append(done) if message == "rolling" else None  # noqa: E731
        return compute_bearing(prepared, told).runs["direct"]

    monkeypatch.setenv("ASPERITY_CACHE", str(tmp_path / "whole"))
    whole = rolled()
    last = max(steps)
    case.save(tmp_path / "case.toml")
    cache = str(tmp_path / "killed")
    program(str(tmp_path / "case.toml"), code=-9, script=KILLED_HALF_WAY, ASPERITY_CACHE=cache)
    monkeypatch.setenv("ASPERITY_CACHE", cache)
    resumed = rolled()
    assert 0.3 * last < steps[0] < last  # not from the start
    for name in ("inner_force", "outer_force", "ball_motion", "inner_motion", "acceleration"):
        np.testing.assert_array_equal(getattr(resumed, name), getattr(whole, name))


def test_levels_of_a_bearing_hold_the_energy_of_its_forces_and_its_acceleration(runs):
    """Bands together have the mean square of all lines within them, but for the bursts of a short record."""
    tree = runs(BEARING)
    found, moved = group(tree, "spectra"), group(tree, "rolling")
    begin, end = found["band"].values[[0, -1]] * 10.0 ** np.array([-0.05, 0.05])
    forces = moved["contact_force"].values[0]
    for records, level in (
        (forces, found["force_level"].values[0]),
        (moved["ring_acceleration"].values[0] / 1e-6, found["ring_acceleration_level"].values[0, 0]),
    ):
        window = np.sqrt(8.0 / 3.0) * np.hanning(records.shape[1])
        lines = np.fft.rfft(window * (records - records.mean(axis=1, keepdims=True)))
        frequency = np.fft.rfftfreq(records.shape[1], 1.0 / RATE)
        within = (frequency > begin) & (frequency < end)
        square = 2.0 * np.mean(np.sum(np.abs(lines[:, within]) ** 2, axis=1)) / records.shape[1] ** 2
        assert 10.0 * np.log10(np.sum(10.0 ** (level / 10.0)) / square) == pytest.approx(0.0, abs=2.0)
    deviation = group(tree)["band_velocity_deviation"].values
    assert ((deviation > 0.0) & (deviation < 0.5)).all()
