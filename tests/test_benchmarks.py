"""The scripts that guard against slowness, and compare two runs to the last bit, judge as they should."""

import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from asperity.case.cases import as_case
from asperity.results import save, variable
from small_cases import COARSE

sys.path.insert(0, str(Path(__file__).parents[1] / "benchmarks"))
import bearing_fit_intervals
import bearing_machines
import measured_bearings as bearings
import measured_railway as railway
import railway_by_hand
import railway_foot
import railway_supports
from compare_runs import compare, main
from guard import CASES, ratios, rolled_in_turn, timed


class Clockwork:
    """A tree whose pieces take known times, one after the other."""

    def __init__(self, *times):
        self.times = [{}, *times]
        self.asked = 0

    def time(self, case):
        self.asked += 1
        return self.times[self.asked - 1]


def test_what_looks_slower_gets_twice_the_rounds():
    before = Clockwork({"scan": 1.0}, {"scan": 1.0}, {"scan": 1.0}, {"scan": 1.0})
    after = Clockwork({"scan": 1.3}, {"scan": 1.2}, {"scan": 1.04}, {"scan": 1.2})
    assert ratios(*rolled_in_turn([before, after], "any", 2)) == {"scan": 1.04}
    assert after.asked == 5
    same = Clockwork({"scan": 1.0}, {"scan": 1.0})
    rolled_in_turn([same, Clockwork({"scan": 1.0}, {"scan": 1.1})], "any", 2)
    assert same.asked == 3


def test_a_run_is_told_apart_by_its_pieces():
    case = COARSE | {"laws": ["hertz"], "start": "0.2 m", "duration": "0.1 s"}
    times = timed(case)
    assert 0.0 < times["rolling"] < times["whole run"]


def test_cases_of_the_guard_are_cases():
    assert {as_case(case).kind for case in CASES.values()} == {
        "ball-on-beam",
        "wheel-on-rail",
        "ball-bearing",
    }


def written(path, force=(1.0, 2.0, np.nan), name="contact_force", dim="time", note="of one law", **attrs):
    held = xr.Dataset({name: variable(dim, np.array(force), "N", "Contact force", note=note)})
    tree = xr.DataTree.from_dict({"/": xr.Dataset(attrs={"case": "text"}), "/rolling": held})
    tree["rolling"].attrs = {"verdict": "stays"} | attrs
    return save(tree, path)


@pytest.fixture
def first(tmp_path):
    return written(tmp_path / "a.nc")


@pytest.mark.parametrize(("change", "told"), [
    ({}, ""),
    ({"force": (1.0, np.nextafter(2.0, 3.0), np.nan)}, "contact_force: 1 of 3 differ, by up to 4.44e-16"),
    ({"force": (1.0, 2.0, 3.0)}, "contact_force: 1 of 3 differ"),
    ({"force": (1.0, 2.0)}, "contact_force: shape (3,), now (2,)"),
    ({"dim": "step"}, "contact_force: dimensions ('time',), now ('step',)"),
    ({"note": "of all laws"}, "contact_force/note: 'of one law', now 'of all laws'"),
    ({"verdict": "leaves"}, "@verdict: 'stays', now 'leaves'"),
    ({"name": "force"}, "contact_force: missing"),
])  # fmt: skip
def test_every_difference_is_told(first, tmp_path, capsys, change, told):
    other = written(tmp_path / "b.nc", **change)
    assert main([str(first), str(other)]) == (1 if told else 0)
    assert capsys.readouterr().out.startswith(f"rolling/{told}" if told else "")
    assert bool(compare(first, other, {})[0]) == bool(told)


def test_what_is_new_or_changed_its_name_on_purpose_is_no_difference(first, tmp_path):
    other = written(tmp_path / "b.nc", name="force", dim="step", seed=1)
    assert compare(first, other, {"contact_force": "force", "time": "step"}) == ([], ["rolling/@seed"])
    found, added = compare(first, other, {"rolling/contact_force": "rolling/force"})
    assert [str(d) for d in found] == ["rolling/contact_force: dimensions ('time',), now ('step',)"]
    assert added == ["rolling/@seed"]


def test_results_of_a_study_that_have_no_groups_are_compared_as_well(tmp_path):
    held = xr.Dataset({"peak_force": variable("member", np.array([1.0, 2.0]), "N", "Peak force")})
    studies = [tmp_path / name for name in ("a.nc", "b.nc")]
    for each in studies:
        save(xr.DataTree(held), each)
    assert compare(*studies, {}) == ([], [])


def test_draws_of_a_railway_keep_the_mean_energy():
    """What is known of wheels and rails are means of energies: scatter of 4 dB would add 1.8 dB to them."""
    source = SimpleNamespace(generator=np.random.default_rng(2))
    drawn = railway.Ensemble._drawn(source, 4.0, 5)
    assert abs(10.0 * np.log10(np.mean(railway.energy(drawn[1:])))) < 0.3
    assert not drawn[0].any()


def test_levels_between_bands_of_roughness_lie_on_straight_lines_over_the_logarithm():
    """Of falling wavelengths; beyond them the first and the last level stand, as NumPy has it of one row."""
    waves = 0.2 * 10.0 ** (-0.1 * np.arange(25))
    rows = np.random.default_rng(4).normal(size=(3, 25))
    for speed in (20.0, 136.0, 300.0):
        place = np.log10(speed / 3.6 / railway.BAND)
        expected = [np.interp(place, np.log10(waves)[::-1], row[::-1]) for row in rows]
        np.testing.assert_allclose(railway.at_bands(waves, rows, speed), expected, rtol=0, atol=1e-12)
        np.testing.assert_allclose(railway.at_bands(waves, rows[0], speed), expected[0], rtol=0, atol=1e-12)


def test_a_vehicle_scatters_as_those_of_its_kind_in_other_trains():
    """Two kinds, three trains: what one is off by is not in its own interval, but in those of others."""
    computed = np.zeros((6, 20_000))
    measured = np.array([3.0, 0.0, 0.0, 40.0, 0.0, 0.0])
    trains, kinds = np.array([1, 2, 3, 1, 2, 3]), np.array([0, 0, 0, 1, 1, 1])
    found = railway.with_scatter_of_others(computed, measured, trains, kinds)
    other = 3.0 / np.sqrt(2.0)
    assert found.std(axis=1) == pytest.approx([0.0, other, other, 0.0, *[40.0 / np.sqrt(2.0)] * 2], rel=0.02)
    told = railway.interval(found.T)
    assert railway.held(told, measured) == "4 of 6"
    assert railway.held(told, measured, kinds == 1) == "2 of 3"


def test_a_vehicle_is_passed_at_the_speed_of_the_coaches_in_between(tmp_path):
    """Between the middles of vehicles k and k + 1 are bogies 2k and 2k + 1, but for those of locomotives."""
    bogies = ["pass-by,section,bogie,speed (km/h),time (s),bogie of"]
    of = ["coach"] * 4 + ["locomotive"] * 2
    for section, more in (("B2", 50.0), ("B5", 0.0)):
        bogies += [f"7,{section},{k},{100.0 + k + more},0,{each}" for k, each in enumerate(of, 1)]
    (tmp_path / "bogies_intercity.csv").write_text("\n".join(bogies), encoding="utf-8")
    head = "pass-by,section,speed (km/h),interval,vehicles,total (dB(A))"
    rows = [
        "7,B5,140,2,locomotive and coach,97",
        "7,B5,140,full,train,90",
        "7,B5,140,1,coaches,93",
        "7,B4,,1,coaches,1",
    ]
    (tmp_path / "pass_by_intercity.csv").write_text("\n".join([head, *rows]), encoding="utf-8")
    first, last = railway.Railway(tmp_path).vehicles
    assert (first.number, first.types, first.speed, first.total) == (1, railway.COACH, 102.5, 93.0)
    assert (last.number, last.types, last.speed, last.total) == (2, railway.HALF, 104.0, 97.0)


def test_a_hammer_that_strikes_straight_hears_the_vertical_waves_alone():
    """One 10 mm off that leans by 0.1 finds rates between those up and down and sideways at 500 Hz."""
    keys = {name: first for name, (*_, first) in railway.FREE.items()}
    sideways = keys | {name: first for name, (*_, first) in railway.SIDEWAYS.items()}
    motion = railway.sideways_motion(railway.sideways_track(sideways))
    straight = {"place": 0.0, "slope": 0.0}
    plain = railway.hammered(railway.tracks_of(keys))
    np.testing.assert_allclose(railway.hammered_askew(keys | straight, motion), plain, rtol=1e-9)
    askew = railway.hammered_askew(keys | {"place": 0.01, "slope": 0.1}, motion)
    beside, at = railway.lateral_rates(sideways), int(np.argmin(np.abs(railway.CENTRES - 500.0)))
    assert 2.0 * beside[at] < askew[at] < 0.8 * plain[at]


def test_what_is_computed_anew_stands_beside_the_same_run_of_what_was_stated():
    run = {"on": "outer", "clearance": 1e-05, "path": 3000.0, "angle": 0.0, "axial": 0.0, "sides": 0.1}
    lines = {(100, 2e-4): 1.0, (100, 5e-4): 2.0, (300, 2e-4): 0.5, (300, 5e-4): 2.0}
    stated = [run | {"load": load, "size": size, "line": line} for (load, size), line in lines.items()]
    stated.append(stated[-1] | {"clearance": 2e-5, "line": 9.0})  # of another clearance, at one load alone
    anew = [
        each | {"line": 2.0 * each["line"], "sides": 0.3} if each["load"] == 300 else each for each in stated
    ]
    rows = list(bearings.beside_rows(stated, anew[::-1]))
    assert rows[0] == ["outer, 100 lb", "1.00–1.00", "1.00–1.00", "0.10–0.10", "0.10–0.10", "+0 %"]
    assert rows[1] == ["outer, 300 lb", "0.50–1.00", "1.00–2.00", "0.10–0.10", "0.30–0.30", "+100 %"]
    for other in (anew[1:], [*anew[1:], anew[0] | {"angle": 70.0}]):
        with pytest.raises(ValueError, match="not those that were stated"):
            list(bearings.beside_rows(stated, other))


def test_every_angle_and_speed_that_is_not_there_is_told_of_each_rig_and_raceway():
    """A raceway without a record loses as the other one, by the square roots of R = 1/(1/r_b ± 1/R)."""
    ball, (inner, outer) = 0.5 * bearings.HIT.ball_diameter, bearings.HIT.raceway_radii
    there = [("mfs", "outer", 1e-4), ("mfs", "inner", 2e-4), ("own", "outer", 4e-4)]
    seen = [
        {"rig": rig, "on": part, "angle": angle, "speed": 1200.0, "lost": lost}
        for rig, part, lost in there
        for angle in (2.0, 8.0)
    ]
    rows = {row[0]: row[1:] for row in bearings.rest_of_hit(seen)}
    assert len(rows) == 4 * 9 - len(seen)
    assert not {"mfs, outer 8°, 1200 1/min", "own, outer 2°, 1200 1/min"} & set(rows)
    relative = np.sqrt((1.0 / ball - 1.0 / outer) / (1.0 / ball + 1.0 / inner))
    for rig, part, lost, radius in ((*there[0], outer), ("own", "inner", 4e-4 * relative, inner)):
        whole, told, _ = rows[f"{rig}, {part} 5°, 900 1/min"]
        share = 1.0 - lost / (np.radians(5.0) * radius)
        assert float(told) == pytest.approx(share * float(whole), abs=2e-3)
    assert rows["own, inner 2°, 600 1/min"][:2] == ["0.923", "0.462"]  # bridged: at half of it


def test_seats_that_move_by_half_have_four_times_the_modal_mass():
    """Of a force on both alike and of one against the other; sleepers as a whole, and their turn, stay."""
    even, heavier = railway.sleepers(0.03), railway.sleepers(0.03, 4.0)
    for plain, heavy in zip(even, heavier, strict=True):
        share = np.array(heavy.modal_masses) / plain.modal_masses
        assert share == pytest.approx([1.0] + [4.0] * (len(share) - 1))
        assert heavy.natural_frequencies == plain.natural_frequencies
    given = {"sleeper_loss_factor": 0.03, "modal_masses": 4.0}
    tracks = railway.tracks_of({"pad_stiffness": 9e8} | given, railway.KINDS[2])
    assert [each.measured_sleeper for each in tracks] == heavier


def test_waves_along_a_rail_are_heard_as_cylinders_and_all_together_as_sources_apart():
    """In the far field 2/(π cos ψ) of what sources apart are, whose mean over all directions is one."""
    k, far = 20.0, 1e4
    angle = np.radians([0.0, 30.0, 60.0])
    told = railway_by_hand.heard_waves(k, k * np.sin(angle), far)
    assert told == pytest.approx(2.0 / (np.pi * np.cos(angle)), rel=1e-4)
    every = k * np.cos(np.pi * (np.arange(4000) + 0.5) / 4000)  # ∫ dk/√(k₀² − k²) by Chebyshev's places
    weighted = railway_by_hand.heard_waves(k, every, far) * np.sqrt(1.0 - (every / k) ** 2)
    assert 0.5 * np.pi * weighted.mean() == pytest.approx(1.0, rel=1e-3)
    slower = railway_by_hand.heard_waves(k, np.array([1.1, 1.2]) * k, 2.0)
    fades = 2.0 * k * np.sqrt(np.array([1.1, 1.2]) ** 2 - 1.0)  # K₀(z)² goes as exp(−2z)/z
    expected = np.log(fades[1] / fades[0]) + 2.0 * (fades[1] - fades[0])
    assert np.log(slower[0] / slower[1]) == pytest.approx(expected, rel=2e-3)


def test_a_foot_that_flaps_is_heavy_below_its_resonance_and_light_above():
    """As a mass: below it carries along, far above it stays behind; at rest it is part of the rail."""
    track = railway.tracks_of({"pad_stiffness": 9e8})[0]
    omega = 2.0 * np.pi * np.array([1.0 + 0j, 3e3, 5e4])
    plain, flapping = (
        each.rail.waves(omega)[0][0] for each in (track, railway_supports.with_more(track, (5e3, 10.0)))
    )
    assert flapping[0] == pytest.approx(plain[0], rel=1e-6)
    assert flapping[1].real > 1.01 * plain[1].real
    assert flapping[2].real < plain[2].real
    mass = track.mass_per_length + 10.0 * 0.36 / 0.64
    heavier = replace(track, mass_per_length=mass).rail.waves(omega)[0][0]
    assert flapping[1] == pytest.approx(heavier[1], rel=2e-3)
    still = railway_supports.with_more(track, (np.inf, 10.0)).receptance([500.0], 0.3, 0.3)
    assert still == pytest.approx(track.receptance([500.0], 0.3, 0.3), rel=1e-12)


def test_a_foot_by_finite_elements_is_that_of_the_printed_section():
    """Its area is made so; centroid and second moments are told by the section alone, waves by these."""
    told = railway_foot.printed_units(railway_foot.section_of(railway_foot.flare()))
    assert told == pytest.approx(list(railway_foot.PRINTED.values()), rel=0.012)
    bent = railway_foot.lowest_waves()
    slow = railway_foot.wavenumber(bent[0, 0]) / railway_foot.WAVENUMBERS[0]  # a beam, where waves are long
    assert slow == pytest.approx(1.0, abs=2e-3)
    along = np.sqrt(210e9 / 7850.0) * railway_foot.WAVENUMBERS[0] / (2.0 * np.pi)
    assert bent[0, 1] == pytest.approx(along, rel=5e-3)  # a bar that is pulled along
    assert railway_foot.foot_on_spring() == pytest.approx(railway_supports.BY_ELEMENTS, rel=1e-3)
    flaps = railway_foot.wavenumber(bent[:, 0], *railway_supports.BY_ELEMENTS)
    assert flaps / railway_foot.WAVENUMBERS == pytest.approx(1.0, abs=0.022)


def test_sections_are_met_where_no_more_is_left_than_rails_differ_by_and_than_is_asked():
    """Rails a factor apart in all bands but the last, where they are alike; B3 is met without that band."""
    apart = {"B1": 2.0, "B2": 1.0, "B3": 1.3, "B4": 3.0, "B5": 3.0}
    low = np.ones(18)

    def rates(section, *_):
        return np.array([low, low * 10.0 ** (0.1 * np.append(np.full(17, apart[section]), 0.0))])

    left = {section: np.append(np.full(17, 1.22), 0.0) for section in apart}
    left["B3"] = np.append(np.full(17, 1.0), 4.0)
    tried = railway.TriedOnNearest(SimpleNamespace(rates=rates), {})
    tried.__dict__.update(left={railway.FOOT: left}, in_bays={railway.FOOT: None})
    row = tried.verdicts().splitlines()[-1]
    assert row == f"| {railway.FOOT} | 0 | B1 B4 B5 | B1 B3 B4 B5 | B1 B2 B4 B5 | B3 |"


def test_the_strongest_relaxation_of_a_pad_loses_what_is_printed_at_most():
    track = railway_supports.with_more(
        railway.tracks_of({"pad_stiffness": 9e8, "pad_damping": 0.0})[0],
        strength=railway.STRONGEST,
        frequency=500.0,
    )
    stiffness = track.springs["pad"].stiffness(2.0 * np.pi * np.geomspace(50.0, 5e3, 400))
    assert np.max(stiffness.imag / stiffness.real) == pytest.approx(0.35, abs=2e-3)
    assert stiffness.real[-1] == pytest.approx((1.0 + railway.STRONGEST) * 9e8, rel=0.01)


def test_a_value_on_a_limit_is_marked():
    limits = railway.FREE["pad_loss_factor"]
    told = [railway.on_limit(each, limits) for each in (0.35, 0.2, 0.05)]
    assert told == [" (most)", "", " (least)"]


def test_a_grid_of_runs_gives_the_nearest_or_what_lies_between():
    loads, lines = np.array([50.0, 100.0, 200.0]), np.array([[1.0], [4.0], [4.0]])
    asked = {
        smooth: [
            bearing_fit_intervals.Grid(loads, np.ones(1), lines, smooth).run(load)["envelope"].item()
            for load in (20.0, 60.0, 50.0 * np.sqrt(2.0), 80.0, 300.0)
        ]
        for smooth in (False, True)
    }
    assert [asked[False][k] for k in (0, 1, 3, 4)] == [1.0, 1.0, 4.0, 4.0]
    assert asked[True] == pytest.approx([1.0, 1.0 * 4.0 ** np.log2(1.2), 2.0, 4.0 ** np.log2(1.6), 4.0])


def test_coverage_counts_intervals_that_hold_the_load():
    found = [(100.0, 100.0, (90.0, 110.0)), (100.0, 150.0, (120.0, 200.0)), (100.0, 99.0, None)]
    assert bearing_fit_intervals.coverage(found).startswith("1 of 3 (33.3 %)")


def test_no_sign_of_a_fault_is_counted_as_if_half_of_all_had_one_and_four_of_five_speeds_were_right(capsys):
    """Of three records with a fault in four at the right speed one is silent, and all sound ones are."""
    about = {"basis": "sound", "turns": 50.0, "confidence": 0.86, "asked": "right"}
    rows = [about | {"part": "outer", "said": "not" if n == 0 else "rightly"} for n in range(4)]
    rows += [about | {"part": None, "said": "not"} for _ in range(2)]
    rows += [each | {"asked": asked, "said": "rightly"} for each in rows for asked in ("near", "wrong")]
    bearing_machines.no_sign(rows)
    assert capsys.readouterr().out == "no sign (sound), 86 % sure: 2 of 3 sound, 80 % with half faulty\n"


@pytest.mark.long
def test_of_verdicts_that_there_is_no_fault_as_many_are_right_as_they_say():
    """Machines of a seed by which nothing was set: within two standard deviations of their number."""
    rows = list(bearing_machines.asked(bearing_machines.KINDS, 1203, 2))
    for kind in ("sound", "nothing"):
        own = [
            row for row in rows if row["said"] == "not" and row["basis"] == kind and row["confidence"] > 0.5
        ]
        silent = [sum(bool(row["part"]) is struck for row in own) for struck in (True, False)]
        shares = [count / sum(bool(row["part"]) is struck for row in rows)
                  for count, struck in zip(silent, (True, False), strict=True)]  # fmt: skip
        right = shares[1] / sum(shares)
        said = np.mean([row["confidence"] for row in own])
        assert abs(right - said) < 2.0 * np.sqrt(said * (1.0 - said) / min(silent)), (kind, right, said)
