"""What a run, or a bearing, gives of what is measured: read where it stands, and keys fitted to it."""

import json
import re
import warnings
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import asperity
from asperity import observables
from asperity.case.cases import as_case, read_case
from asperity.case.tables import read_levels
from asperity.errors import BandsWarning
from asperity.fitting import tried as fitted_to
from asperity.fitting.free import free_key
from asperity.fitting.running import measured_for
from asperity.fitting.tried import FitRuns, TriedCase
from asperity.observables.observable import Measured
from asperity.scenes import schema
from asperity.schema import bearing, contact, spectra
from asperity.spectra import a_weighting
from command_line import call
from refusals import refusals
from small_cases import BALL, BEARING, HEARD, tree_of

BAND = 10.0 ** (0.1 * np.arange(20, 33))
HEIGHTS = 20.0 * np.log10(BAND)
"""Some level in each band, dB."""


def predicted(what, case, at, places=None):
    data = Measured(what, at, np.ones(len(at)), places=places)
    return observables.observable(what).predict(TriedCase(case, {}), data)


@pytest.fixture
def ran(monkeypatch):
    """Lets a case be run by a function that lays out its result; says how often that was called."""
    calls = []

    def by(values):
        def run(case, progress, *, brief):
            assert brief
            calls.append(case)
            progress(1, 2, "rolling")
            return tree_of(values(case))

        monkeypatch.setattr(fitted_to, "run", run)
        return calls

    return by


def of_beam(case):
    """Force and acceleration of a linear contact: both in proportion to the roughness."""
    level = HEIGHTS + 20.0 * np.log10(case.surface.rms / 1e-7)
    sensors = case.rolled_over.sensor_positions
    return {
        spectra.LAW: ["linear"],
        spectra.BAND: BAND,
        spectra.FORCE_LEVEL: level[None],
        schema.SPECTRA_SENSOR: list(sensors),
        schema.ACCELERATION_LEVEL: np.stack([level + 10.0 * n for n in range(len(sensors))])[None],
        contact.APPROACH: np.array([0.0, 1e-7, 1e-6, 1e-5]),
        contact.FORCE: np.array([0.0, 1.0, 10.0, 100.0]),
        contact.TANGENT_STIFFNESS: np.array([0.0, 1e7, 1e8, 1e9]),
    }


@pytest.fixture
def beam(ran):
    return as_case(BALL | {"laws": ["linear"]}), ran(of_beam)


def test_levels_are_those_of_the_run(beam):
    case, calls = beam
    own = HEIGHTS + 20.0 * np.log10(0.4)  # 0.04 um
    at = np.array([BAND[3], 1e5])
    np.testing.assert_allclose(predicted("contact force level", case, at), [own[3], np.nan])
    third = predicted("acceleration level", case, at, places=(case.rolled_over.sensor_positions[2], 0.0))
    np.testing.assert_allclose(third, [own[3] + 20.0, np.nan])
    mean = 10.0 * np.log10(np.mean(10.0 ** np.arange(5)))
    np.testing.assert_allclose(predicted("acceleration level", case, at)[0], own[3] + mean)
    np.testing.assert_allclose(predicted("contact stiffness", case, [3.0, 1e4]), [3e7, np.nan])
    assert len(calls) == 1  # kept


def test_roughness_is_fitted_to_forces_with_few_runs(beam):
    case, calls = beam
    data = Measured("contact force level", BAND, HEIGHTS + 20.0 * np.log10(0.8))
    told = []
    found = asperity.fit(case, data, progress=lambda *step: told.append(step[2]))
    assert found.values == {"surface.rms": pytest.approx(0.08e-6, rel=1e-4)}
    assert len(calls) < 12
    said = [re.fullmatch(r"run (\d+) of at most (\d+): rolling", each) for each in told if "rolling" in each]
    assert [int(each[1]) for each in said] == list(range(1, len(calls) + 1))
    most = [int(each[2]) for each in said]
    # as it is; 15 steps and 5 more; slopes twice; held as often as contradicted; 4 for either end
    assert most[0] == 1 + 20 + 2 + 2 * 5 + 8
    assert most == sorted(most, reverse=True)
    assert len(calls) <= most[-1] < most[0]
    assert found.case.surface.rms == found.values["surface.rms"]


def test_more_runs_than_were_counted_are_not_more_than_there_are_at_most():
    told = []
    runs = FitRuns(lambda *step: told.append(step[2]), most=1)
    for _ in range(2):
        runs.begun()(0, 1, "rolling")
    assert told == ["run 1 of at most 1: rolling", "run 2 of at most 2: rolling"]


def test_bands_that_the_case_has_not_are_left_out_and_told(beam):
    case, _ = beam
    data = Measured("contact force level", [BAND[2], BAND[4], 1e5], [HEIGHTS[2], HEIGHTS[4], 0.0])
    with pytest.warns(UserWarning, match="contact force level in measured, frequency .Hz.: 100000 left out"):
        found = asperity.fit(case, data)
    assert found.measured[0].at.tolist() == [BAND[2], BAND[4]]


test_data_beyond_the_case_are_refused = refusals(
    (
        "contact force level",
        [2e4, 3e4],
        "frequency (Hz): received 20000, 30000; allowed: where the case",
    ),
    ("contact stiffness", [1e5, 2e5], "contact stiffness in measured, load (N): received"),
    of=lambda what, at, beam: asperity.fit(beam[0], Measured(what, at, [1.0, 2.0]), ["surface.rms"]),
)


# --- a train that passes


def of_train(case):
    """Levels of wheel and rail roughness where they are passed, by energy, and what the receiver adds."""
    wavelength = case.speed / BAND
    table = np.column_stack(read_levels(case.wheel.roughness))
    near = np.abs(np.log(wavelength[:, None] / table[:, 0])).argmin(axis=1)
    energy = 1e-9 + 10.0 ** (0.1 * table[near, 1])
    level = 60.0 + 10.0 * np.log10(energy) + case.noise.receiver_offset
    return {
        schema.PASS_BY_LAW: ["linear"],
        schema.PASS_BY_RADIATOR: ["rail", "total"],
        schema.PASS_BY_BAND: BAND,
        schema.SOUND_EXPOSURE_LEVEL: np.stack([level - 3.0, level])[None],
    }


START = np.column_stack([10.0 ** (-0.1 * np.arange(6, 25)), np.linspace(10.0, -10.0, 19)])
TRAIN = HEARD | {"noise": {"vehicle_length": "26 m"}, "speed": "40 m/s", "wheel": {"section": "rigid"}}


@pytest.fixture
def train(ran):
    case = as_case({"kind": "wheel-on-rail"} | TRAIN)
    return case.with_(**{"wheel.roughness": START}), ran(of_train)


def test_sound_is_the_level_over_the_pass_by_time(train):
    case, _ = train
    passed = case.passage.passed
    expected = of_train(case)[schema.SOUND_EXPOSURE_LEVEL][0, 1] - 10.0 * np.log10(passed[1] - passed[0])
    np.testing.assert_allclose(predicted("sound pressure level", case, BAND), expected)
    data = Measured("sound pressure level", BAND, expected + 5.5)
    found = asperity.fit(case, data)
    assert found.values == {"noise.receiver_offset": pytest.approx(5.5, abs=1e-3)}


def test_roughness_in_bands_is_common_to_pass_bys_at_several_speeds(train):
    """Each band is heard at another frequency at each speed; few runs find all of them."""
    case, calls = train
    true = START + np.column_stack([np.zeros(19), 4.0 + 2.0 * np.sin(np.arange(19))])
    data = []
    for speed in (40.0, 50.0):
        conditions = {"speed": speed}
        known = TriedCase(case, {"wheel.roughness": true, **conditions})
        level = observables.observable("sound pressure level").predict(
            known, Measured("sound pressure level", BAND, BAND)
        )
        data.append(Measured("sound pressure level", BAND, level, conditions=conditions))
    calls.clear()
    found = asperity.fit(case, data, ["wheel.roughness"])
    heard = {each.free.band: each.value for each in found.estimates}
    levels = {band: level for band, level in true if band > 0.0225}  # 40 m/s over 1.6 kHz, half a band off
    assert heard == pytest.approx(levels, abs=0.05)
    assert len(calls) < 40  # with one run for each band and speed two tables of slopes alone took 44
    assert isinstance(found.case.wheel.roughness, np.ndarray)


def test_a_spectrum_that_was_fitted_lies_beside_the_case(train, tmp_path, monkeypatch):
    """Pass-bys in a table, A-weighted, a line for each; the column of speeds says how each was passed."""
    monkeypatch.chdir(tmp_path)
    case, _ = train
    heading = ["train", "speed (km/h)", "total (dB(A))", *(f"{round(at)} Hz" for at in BAND)]
    lines = [",".join(heading)]
    for speed in (144.0, 180.0):
        level = of_train(case.with_(speed=speed / 3.6))[schema.SOUND_EXPOSURE_LEVEL][0, 1] + a_weighting(BAND)
        passed = case.with_(speed=speed / 3.6).passage.passed
        level = level - 10.0 * np.log10(passed[1] - passed[0]) + 2.0
        lines.append(",".join(["A", f"{speed:g}", "90", *(f"{each:.6f}" for each in level)]))
    Path("pass_by.csv").write_text("\n".join(lines))
    np.savetxt("wheel.csv", START, delimiter=",", header="wavelength (m), level (dB re 1 um)", comments="")
    Path("case.toml").write_text(case.with_(**{"wheel.roughness": "wheel.csv"}).to_toml())
    told = json.loads(
        call("fit", "case.toml", "--to", "pass_by.csv", "--free", "wheel.roughness", "--json").stdout
    )
    assert told["rms"] < 0.05 < told["rms_before"]
    _, levels = read_levels(Path(told["files"]["wheel.roughness"]))
    assert levels[:11] == pytest.approx(START[:11, 1] + 2.0, abs=0.05)
    np.testing.assert_allclose(levels[11:], START[11:, 1])
    assert read_case("fitted.toml").wheel.roughness == Path("fitted_wheel_roughness.csv").resolve()


# --- a bearing


@pytest.fixture(scope="module")
def ball_bearing():
    keys = {key: each for key, each in BEARING.items() if key not in ("fault", "radial")}
    return as_case(keys | {"bearing": {"name": "6205"}, "axial": "200 N"})


def test_tones_tell_the_axial_load_by_the_contact_angle(ball_bearing):
    """Of a bearing without a run: the tones follow the contact angle of its load."""
    case = ball_bearing.with_(axial="900 N")
    turning = case.kinematics
    tones = np.array([turning.tone("outer"), turning.tone("inner"), turning.tone("ball"), turning.cage])
    found = asperity.fit(ball_bearing, Measured("bearing tone", tones, tones), ["axial"], starts=1)
    assert found.values == {"axial": pytest.approx(900.0, rel=1e-3)}
    assert found.predicted[0] == pytest.approx(tones, rel=1e-6)


def test_a_load_that_may_be_zero_is_sought_by_its_logarithm(ball_bearing, ran):
    """Its limits, 0 to 100 MN, are no scale: steps of half a meganewton found 624 N for 400 N."""
    free = free_key(ball_bearing, "axial")
    assert (free.logarithmic, free.low, free.high) == (True, pytest.approx(0.02), 1e8)
    assert free.range_source == "from 0.0001 of the case's value to the limit of the key"
    lines = np.arange(1.0, 400.0)
    ran(
        lambda case: {
            bearing.LAW: ["hertz"],
            bearing.ENVELOPE_FREQUENCY: lines,
            bearing.ENVELOPE: 1e-3 * case.axial ** (lines / 200.0)[None],
        }
    )
    at = np.array([50.0, 100.0, 200.0, 300.0])
    found = asperity.fit(ball_bearing, Measured("envelope line", at, 1e-3 * 400.0 ** (1.02 * at / 200.0)))
    assert found.values["axial"] == pytest.approx(400.0, rel=0.01)
    assert not found.estimates[0].limit


def jumping_lines(case):
    """Lines that rise and fall with the load, and jump by some tenths of a decibel from one to the next."""
    lines, load = np.arange(1.0, 400.0), np.log(case.axial)
    resonant = np.exp(-0.5 * ((load - np.log(30.0 + lines)) / 1.2) ** 2)
    jumps = 1.0 + 0.03 * np.sin(997.0 * load * lines)
    return {
        bearing.LAW: ["hertz"],
        bearing.ENVELOPE_FREQUENCY: lines,
        bearing.ENVELOPE: (resonant * jumps)[None],
    }


def test_a_load_is_found_though_lines_jump_with_it_and_fall_again(ball_bearing, ran):
    """Slopes over two per cent are those of jumps; one start ends on the wrong side of a resonance."""
    ran(jumping_lines)
    case = ball_bearing.with_(envelope_band=(2e3, 6e3))
    at = np.array([50.0, 100.0, 200.0, 300.0, 370.0])
    held = []
    for number, true in enumerate((40.0, 150.0, 400.0, 1200.0)):
        values = jumping_lines(case.with_(axial=float(true)))[bearing.ENVELOPE][0]
        noise = 10.0 ** (0.025 * np.random.default_rng(number).standard_normal(at.size))
        found = asperity.fit(case, Measured("envelope line", at, values[at.astype(int) - 1] * noise))
        assert found.values["axial"] == pytest.approx(true, rel=0.25), true
        low, high = found.intervals["axial"]
        held.append(low <= true <= high)
    assert sum(held) >= 3


def test_loads_lie_within_their_intervals_where_lines_jump(ball_bearing, monkeypatch):
    """Of forty, 95 % less two standard deviations of so many; half of them within a tenth."""

    case, at = ball_bearing.with_(envelope_band=(2e3, 6e3)), np.array([50.0, 100.0, 200.0, 300.0, 370.0])

    def of_load(trial):
        made = jumping_lines(SimpleNamespace(axial=trial.changes.get("axial", case.axial)))
        return {"envelope": made[bearing.ENVELOPE][0], "envelope_frequency": made[bearing.ENVELOPE_FREQUENCY]}

    monkeypatch.setattr(TriedCase, "collected", property(of_load))
    data = Measured("envelope line", at, at, uncertainty=0.5)
    draws, held, off = np.random.default_rng(5), 0, []
    for true in np.geomspace(60.0, 700.0, 40).tolist():
        exact = observables.observable(data.what).predict(TriedCase(case, {"axial": true}), data)
        noisy = exact * 10.0 ** (0.025 * draws.standard_normal(at.size))
        found = asperity.fit(case, replace(data, values=noisy), ["axial"])
        low, high = found.intervals["axial"]
        held += low <= true <= high
        off.append(abs(np.log(found.values["axial"] / true)))
    assert held >= 36
    assert np.median(off) < 0.06


def test_an_interval_reaches_to_all_loads_that_meet_the_lines(ball_bearing, ran):
    """Of a resonance passed at 200 N both flanks are alike: 100 N and 400 N, and not what lies beyond."""
    lines = np.arange(1.0, 400.0)

    def passed(case):
        high = np.exp(-0.5 * (np.log(case.axial / 200.0) / 0.5) ** 2)
        return {
            bearing.LAW: ["hertz"],
            bearing.ENVELOPE_FREQUENCY: lines,
            bearing.ENVELOPE: np.full((1, lines.size), high),
        }

    calls = ran(passed)
    case, at = ball_bearing.with_(envelope_band=(2e3, 6e3), axial="120 N"), np.array([50.0, 150.0, 250.0])
    values = np.full(3, passed(case.with_(axial="100 N"))[bearing.ENVELOPE][0, 0])
    told, data = [], Measured("envelope line", at, values, uncertainty=1.0)
    found = asperity.fit(case, data, ["axial"], lambda done, total, message: told.append(message))
    low, high = found.intervals["axial"]
    assert low == pytest.approx(96.0, abs=1.0)  # what 1.13 dB allow, by three lines of 1 dB each
    assert high == pytest.approx(417.0, abs=4.0)
    assert 47 < len(calls) <= 50
    assert any("of at most 50" in message for message in told)


@pytest.mark.parametrize("trials", [8, pytest.param(200, marks=pytest.mark.long)])
def test_contact_angles_lie_within_their_intervals(ball_bearing, trials):
    """Of the axial load by tones with noise that is told, in closed form: 95 ± 4 %, of 200."""
    draws, held = np.random.default_rng(2), 0
    for true in np.geomspace(60.0, 700.0, trials).tolist():
        turning = ball_bearing.with_(axial=true).kinematics
        tones = np.array([turning.tone("outer"), turning.tone("inner"), turning.tone("ball")])
        noisy = tones * 10.0 ** (0.05 * 0.001 * draws.standard_normal(3))
        data = Measured("bearing tone", noisy, noisy, uncertainty=0.001)
        low, high = asperity.fit(ball_bearing, data, ["axial"], starts=1).intervals["axial"]
        held += low <= true <= high
    assert 0.91 * trials - 1.0 <= held <= 0.99 * trials + 1.0


def test_a_search_where_runs_jump_begins_within_a_factor_of_ten(ball_bearing, ran):
    """Limits of a load are twenty e-folds apart: places all over them are loads that nothing carries."""
    calls = ran(jumping_lines)
    case = ball_bearing.with_(envelope_band=(2e3, 6e3), radial="20 N")
    at = np.array([50.0, 100.0, 200.0, 300.0])
    values = jumping_lines(case.with_(axial=400.0))[bearing.ENVELOPE][0][at.astype(int) - 1]
    asperity.fit(case, Measured("envelope line", at, values), ["axial", "radial"], starts=4)
    loads = np.array([each.axial for each in calls])
    apart = np.log(loads[:, None] / loads)
    assert (np.abs(apart - 0.15) < 1e-9).any()  # slopes are taken over more than the jumps
    assert not (np.abs(apart - 0.02) < 1e-9).any()
    looked_at = loads[:19]  # the case, and six places for each start but the first
    assert 15.0 <= looked_at.min() < 40.0
    assert 1200.0 < looked_at.max() <= 2600.0
    assert observables.observable("envelope line").chance(
        {}, Measured("envelope line", at, values)
    ) == pytest.approx(0.4)


def test_loads_are_looked_at_within_a_factor_of_ten(ball_bearing, ran):
    """Where the load is the only key, no other is run at all."""
    calls = ran(jumping_lines)
    case = ball_bearing.with_(envelope_band=(2e3, 6e3))
    at = np.array([50.0, 100.0, 200.0, 300.0])
    values = jumping_lines(case.with_(axial=400.0))[bearing.ENVELOPE][0][at.astype(int) - 1]
    asperity.fit(case, Measured("envelope line", at, values))
    loads = np.array([each.axial for each in calls])
    assert loads.min() >= 15.0
    assert loads.max() <= 2600.0
    assert loads.min() < 40.0
    assert loads.max() > 1200.0


def test_a_search_where_runs_jump_begins_at_two_places(ball_bearing, ran):
    """At the case and at the best of six loads that are spread about it."""
    told = []
    ran(jumping_lines)
    case = ball_bearing.with_(envelope_band=(2e3, 6e3), radial="20 N")
    at = np.array([50.0, 100.0, 200.0, 300.0])
    values = jumping_lines(case.with_(axial=400.0))[bearing.ENVELOPE][0][at.astype(int) - 1]
    data = Measured("envelope line", at, values)
    asperity.fit(case, data, ["axial", "radial"], lambda done, total, message: told.append((total, message)))
    assert (3, "search for 2 keys") in told


def test_the_band_of_the_envelope_that_a_run_chose_stays(ball_bearing, ran):
    """From run to run another band was the most impulsive one: lines jumped by 16 dB."""
    lines = np.arange(1.0, 400.0)

    def laid(case):
        low, high = case.envelope_band or ((2e3, 6e3) if case.axial < 300.0 else (6e3, 9e3))
        return {
            bearing.LAW: ["hertz"],
            bearing.ENVELOPE_LOW: low,
            bearing.ENVELOPE_HIGH: high,
            bearing.ENVELOPE_FREQUENCY: lines,
            bearing.ENVELOPE: (1.0 if low == 2e3 else 0.1) * case.axial ** (lines / 200.0)[None],
        }

    ran(laid)
    at = np.array([50.0, 100.0, 200.0, 300.0])
    data = Measured("envelope line", at, 400.0 ** (1.02 * at / 200.0))
    said = "envelope_band = 2 kHz, 6 kHz, as the run of the case chose it, stays while others are tried: give"
    with pytest.warns(BandsWarning, match=re.escape(said)):
        found = asperity.fit(ball_bearing, data)
    assert found.values["axial"] == pytest.approx(400.0, rel=0.01)
    assert found.case.envelope_band == (2e3, 6e3)
    given = ball_bearing.with_(envelope_band=(2e3, 6e3))
    with warnings.catch_warnings(action="error"):
        assert asperity.fit(given, data).values["axial"] == pytest.approx(400.0, rel=0.01)


def test_velocities_and_lines_are_those_of_the_run(ball_bearing, ran):
    lines = np.arange(1.0, 200.0)
    ran(
        lambda case: {
            bearing.LAW: ["hertz"],
            bearing.SENSOR: [0.0],
            bearing.JUDGED_BAND: ["low", "medium", "high"],
            bearing.BAND_VELOCITY: np.array([[[1e-6, 2e-6, 3e-6]]]),
            bearing.ENVELOPE_FREQUENCY: lines,
            bearing.ENVELOPE: np.where(lines == 101.0, 0.5, 0.01)[None],
        }
    )
    velocity = predicted("bearing band velocity", ball_bearing, np.array([100.0, 4000.0, 2e4]))
    np.testing.assert_allclose(velocity, [1e-6, 3e-6, np.nan])
    line = predicted("envelope line", ball_bearing, np.array([100.0, 50.0, 900.0]))
    np.testing.assert_allclose(line, [0.5, 0.01, np.nan])


# --- files of them

ROWS = "100, 1\n125, 2\n160, 3\n"
READ = (
    ("frequency (Hz), force level (dB re 1 N)\n" + ROWS, "contact force level", "beam", 2.0),
    ("frequency (Hz), force level (dB re 1 kN)\n" + ROWS, "contact force level", "beam", 62.0),
    ("frequency (Hz), level (dB re 1e-6 m/s^2)\n" + ROWS, "acceleration level", "beam", 2.0),
    ("load (N), stiffness (MN/m)\n" + ROWS, "contact stiffness", "beam", 2e6),
    ("frequency (Hz), level (dB)\n" + ROWS, "sound pressure level", "train", 2.0),
    ("tone (Hz)\n100\n125\n", "bearing tone", "ball_bearing", 125.0),
    ("frequency (Hz), velocity (um/s)\n" + ROWS, "bearing band velocity", "ball_bearing", 2e-6),
    ("frequency (Hz), envelope amplitude (mm/s^2)\n" + ROWS, "envelope line", "ball_bearing", 2e-3),
)


@pytest.mark.parametrize(("text", "what", "of", "second"), READ, ids=[row[1] for row in READ])
def test_headings_tell_what_was_measured(text, what, of, second, tmp_path, request):
    (tmp_path / "a.csv").write_text(text)
    case = request.getfixturevalue(of)
    (found,) = measured_for(case if of == "ball_bearing" else case[0], tmp_path / "a.csv", {}, None)
    assert found.what == what
    assert found.values[1] == pytest.approx(second)


test_what_a_case_lacks_is_said = refusals(
    ("bearing tone", "beam", "a case with no bearing: it is of kind ball-on-beam"),
    ("sound pressure level", "beam", "a case with no track: it is of kind ball-on-beam"),
    ("acceleration level", "train", "a case with no accelerometers on what is rolled over"),
    ("contact force level", "bearing", "a case with no bodies that roll: it is of kind ball-bearing"),
    ("contact stiffness", "bearing", "a case with no single contact: it is of kind ball-bearing"),
    ("mobility", "bearing", "a case with nothing that is rolled over: it is of kind ball-bearing"),
    ("sound pressure level", "alone", "no pass-by time: noise.vehicle_length is not given"),
    of=lambda what, of, beam, train, ball_bearing: measured_for(
        {
            "beam": beam[0],
            "train": train[0],
            "alone": train[0].with_(**{"noise.vehicle_length": None}),
            "bearing": ball_bearing,
        }[of],
        Measured(what, [100.0, 125.0], [1.0, 2.0]),
        {},
        None,
    ),
)


def test_the_value_of_the_case_is_told_though_the_search_begins_within_limits(ball_bearing):
    free = free_key(ball_bearing, "axial", (300.0, 900.0))
    assert (free.before, free.start) == (200.0, 300.0)
    assert free.words(free.before) == "200 N"
