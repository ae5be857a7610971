"""The roughest waves of a bearing that keep limits of its velocities: shares in closed form, and refusals."""

import csv
import json
import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner

import asperity
from asperity.case.cases import as_case
from asperity.case.toml import read_toml
from asperity.cli import main
from asperity.errors import ComputationError, InputError
from asperity.optimising import bearing
from asperity.optimising.allocation import AIMED_BELOW
from asperity.optimising.several_limits import cheapest
from asperity.parameters import FROM_PYTHON
from asperity.written_numbers import rounded

pytestmark = pytest.mark.usefixtures("cache_of_module")
MANUAL = Path(__file__).parents[2] / "docs" / "reference" / "json.md"
OF_THREE = {
    "balls": 3, "ball_diameter": "7.94 mm", "pitch_diameter": "39.04 mm", "contact_angle": "20 deg"
}  # fmt: skip
CASE = {
    "kind": "ball-bearing", "bearing": OF_THREE, "axial": "60 N", "speed": "3600 1/min",
    "laws": ["linear"], "duration": "0.1 s", "settling": "10 ms", "centrifugal": False,
    "inner_raceway": {"waves": [5, 10, 13], "amplitudes": ["2 nm", "3 nm", "5 nm"]},
}  # fmt: skip
LINEAR = {"law": "linear", "verify": "linear", "record": "0.2 s"}
still = lambda *_: None  # noqa: E731


@pytest.fixture(scope="module")
def found(cache_of_module):
    """Under an axial load all balls are carried alike: a smooth bearing does not vibrate."""
    before = asperity.run(CASE, brief=True)["bearing/band_velocity"].values[0, 0]
    limits = {"low_band": float(before[0]) / 2.0, "medium_band": float(before[1]) / 3.0}
    return asperity.optimise(CASE, **LINEAR, **limits, reach="40 dB"), limits


def test_bands_of_one_price_share_a_limit_alike(found):
    """Velocities are in proportion to waves: one alone falls as its limit, two take half its square each."""
    answer, limits = found
    assert [band.orders for band in answer.bands] == [(5,), (10,), (13,)]
    assert [band.rms for band in answer.bands] == pytest.approx(np.array([2e-9, 3e-9, 5e-9]) / np.sqrt(2.0))
    low, medium = limits.values()
    below = 10.0 ** (-AIMED_BELOW / 20.0)
    velocity = answer.alone * 10.0 ** (answer.changes / 20.0)[:, None]
    assert velocity[0, 0] == pytest.approx(below * low, rel=1e-3)
    assert answer.changes[0] == pytest.approx(20.0 * np.log10(0.5), abs=0.05)
    assert velocity[1:, 1] == pytest.approx(medium / np.sqrt(2.0), rel=1e-2)
    assert not answer.floor.any()
    rolled = answer.velocities(after=True, law="linear")[:2]
    assert rolled == pytest.approx([low, medium], rel=6e-3)
    assert (rolled <= [low, medium]).all()
    assert answer.settled
    assert "missed" not in answer.sentence
    assert answer.price == pytest.approx(-answer.changes.sum())


def test_its_case_has_the_waves_found(found):
    answer, _ = found
    amplitudes = np.array([2e-9, 3e-9, 5e-9]) * 10.0 ** (answer.changes / 20.0)
    assert answer.case.inner_raceway.amplitudes == pytest.approx(amplitudes)
    assert "limit" in answer.sentence
    assert "Trials recorded 0.1 s" in answer.sentence


def test_the_command_writes_what_python_finds(found, tmp_path):
    """From what is kept of the same search: table, page, case and document."""
    answer, limits = found
    aim = tmp_path / "aim.toml"
    case = tmp_path / "case.toml"
    out = tmp_path / "out"
    case.write_text(as_case(CASE).to_toml())
    data = read_toml(bearing.bearing_aim_template(), "optimisation", "template")
    assert data.pop("case") == "case.toml"
    assert bearing.BearingAim.read(data, FROM_PYTHON).medium_band == pytest.approx(30e-6)
    keys = LINEAR | {name: f"{limit!r} m/s" for name, limit in limits.items()} | {"reach": "40 dB"}
    aim.write_text('case = "case.toml"\n' + "".join(f'{name} = "{each}"\n' for name, each in keys.items()))
    done = CliRunner().invoke(main, ["optimise", str(aim), "-o", str(out), "--no-report", "--json"])
    assert done.exit_code == 0, done.output
    told = json.loads(done.stdout)
    assert told["summary"] == answer.sentence
    assert {Path(each).name for each in told["files"].values()} == {
        "case.toml", "bands.csv", "bands.html", "run.nc"
    }  # fmt: skip
    with (out / "bands.csv").open(encoding="utf-8") as lines:
        heading, *rows = csv.reader(lines)
    assert heading == told["columns"]
    change = [float(row[heading.index("change [dB]")]) for row in rows]
    np.testing.assert_allclose(change, answer.changes, atol=1e-6)
    assert asperity.read_case(out / "case.toml").inner_raceway.amplitudes == pytest.approx(
        answer.case.inner_raceway.amplitudes
    )
    page = (out / "bands.html").read_text(encoding="utf-8")
    assert '<figure id="bands" class="chart">' in page
    listed = re.findall(r"`(\w+)`", MANUAL.read_text(encoding="utf-8").split("Of a ball bearing there is")[1])
    assert {"velocities_before", "velocities_after", "missed", "floor", "price", "limits"} <= set(
        listed
    ) & set(told)


def test_what_a_band_adds_is_told_by_accelerations_not_by_energies():
    """By a linear law: waves that stay, one more and one less than the balls, make the same lines."""
    case = as_case(
        CASE | {"inner_raceway": {},
                "outer_raceway": {"waves": [2, 4, 5], "amplitudes": ["20 nm", "30 nm", "40 nm"]}}
    )  # fmt: skip
    aim = bearing.BearingAim(**LINEAR, low_band="1 m/s", fewest_waves=3)
    bands = bearing.part_bands(case, aim)
    none, first, second, both = (
        bearing._accelerations(bearing.with_energies(case, bands, np.array(each)), aim, still)
        for each in ([0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0])
    )
    added = (first - none) + (second - none)
    assert (both - none).std() > 0.0
    np.testing.assert_allclose(both - none, added, atol=1e-3 * added.std())
    heard = [bearing._velocities(case, each)[0] for each in (none, first, first - none)]
    assert heard[0] > 0.0
    assert abs(np.sqrt(abs(heard[1] ** 2 - heard[0] ** 2)) / heard[2] - 1.0) > 0.05
    found = asperity.optimise(case, **LINEAR, low_band="1 m/s", fewest_waves=3, reach="1 dB")
    assert [found.floor[0], found.alone[0, 0]] == pytest.approx([heard[0], heard[2]], rel=1e-9)
    assert found.changes == pytest.approx([1.0, 1.0])  # as rough as it may be


def test_what_stays_takes_its_part_of_a_limit():
    """Two bands of one price share what is left of 5 µm/s beside 4: half of 3² each."""
    stays = np.array([4e-6, 0.0, 0.0])
    alone = np.array([[3e-6, 0.0, 0.0], [2e-6, 0.0, 0.0]])
    bands = [bearing.PartBand("balls", (order,), 1e-7) for order in (3, 4)]
    aim = bearing.BearingAim(low_band="5 um/s")
    trials, settled = bearing._search(
        lambda energies: np.sqrt(stays**2 + energies @ alone**2),
        alone, stays, bands, aim, aim.limits,
    )  # fmt: skip
    assert settled
    half = 0.5 * ((5.0 * 10.0 ** (-AIMED_BELOW / 20.0)) ** 2 - 4.0**2)  # 4.43 of 4.5
    assert trials[-1].energies == pytest.approx([half / 9.0, half / 4.0], rel=1e-3)
    bearing._refuse_reached(1.001 * stays + 1e-9, stays)
    with pytest.raises(InputError, match="more than 4 um/s, which the bearing has without"):
        bearing._refuse_reached(0.999 * stays + 1e-9, stays)


@pytest.mark.parametrize("over", [(1.002, 1.0), (1.0, 1.3), (1.04, 1.08)])
def test_limits_that_the_run_shown_misses_are_lowered_and_sought_again(over, monkeypatch):
    """All of the duration is louder than the trials, in the one band or the other: by 0.02 to 2.3 dB."""
    limits = {"low_band": 0.35e-6, "medium_band": 1.5e-6}
    trials = bearing._velocities
    quieter = np.array([*over, 1.0])
    monkeypatch.setattr(bearing, "_velocities", lambda *of: trials(*of) / quieter)
    found = asperity.optimise(CASE, **LINEAR, **limits, reach="40 dB")
    rolled = found.velocities(after=True, law="linear")[:2]
    assert (rolled <= list(limits.values())).all()
    assert (20.0 * np.log10(rolled / list(limits.values())) > -0.15).all()
    assert found.settled


def test_limits_that_are_missed_at_last_are_told_with_by_how_much_and_no_search_has_settled(monkeypatch):
    """What nothing corrects, in each of two bands, by each of two laws."""
    monkeypatch.setattr(bearing, "CORRECTIONS", 0)
    trials = bearing._velocities
    monkeypatch.setattr(bearing, "_velocities", lambda *of: trials(*of) / 1.3)
    limits = {"low_band": 0.35e-6, "medium_band": 1.5e-6}
    found = asperity.optimise(CASE, **LINEAR | {"verify": "hertz"}, **limits, reach="40 dB")
    assert found.came_to_rest
    assert not found.settled
    for law in ("hertz", "linear"):
        rolled = found.velocities(after=True, law=law)[:2]
        assert found.missed[law][:2] == pytest.approx(20.0 * np.log10(rolled / list(limits.values())))
        assert found.missed[law].min() == found.missed[law][2] == 0.0
    medium = [f"{rounded(float(found.missed[law][1]), 2)} dB by {law}" for law in ("hertz", "linear")]
    assert f"µm/s (0 without what was changed): missed by {' and '.join(medium)}. " in found.sentence
    assert found.sentence.count("missed by") == 2
    assert "The search did not settle: the best that was met is shown." in found.sentence


def test_several_limits_are_kept_at_the_least_price():
    """Where two limits bind, e = price/(λ·w): sums are kept, and no exchange of two bands is cheaper."""
    random = np.random.default_rng(5)
    weights = random.random((3, 12))
    weights[0, 6:] *= 0.01
    weights[1, :6] *= 0.01
    price = 0.5 + random.random(12)
    left = np.array([1.0, 0.7, 1e6])
    ends = np.full(12, 1e-6), np.full(12, 1e6)
    found = cheapest(weights, left, price, *ends)
    np.testing.assert_allclose((weights @ found)[:2], left[:2], rtol=1e-9)
    multipliers, rest, *_ = np.linalg.lstsq(weights[:2].T, price / found, rcond=None)
    assert (multipliers > 0.0).all()
    assert rest.max() < 1e-12 * np.sum((price / found) ** 2)
    with pytest.raises(ComputationError, match="no texture within the limits was found"):
        cheapest(weights, left, price, np.ones(12), ends[1])


def test_waves_are_not_raised_to_where_balls_leave_the_rings():
    """A band that is not heard in proportion, but shakes all from twice its height on, stays below."""
    bands = [bearing.PartBand("balls", (order,), 1e-8) for order in (4, 5)]
    alone = np.array([[1e-5, 0.0, 0.0], [1e-12, 0.0, 0.0]])

    def rolled(energies):
        leaving = 1e-4 * max(energies[1] - 4.1, 0.0)
        return np.array([np.sqrt(energies @ alone[:, 0] ** 2) + leaving, 0.0, 0.0])

    aim = bearing.BearingAim(low_band="5 um/s")
    trials, settled = bearing._search(rolled, alone, np.zeros(3), bands, aim, aim.limits)
    assert settled
    assert trials[-1].energies == pytest.approx([0.25, 10.0**0.6], rel=0.02)
    assert trials[-1].velocities[0] == pytest.approx(5e-6, rel=6e-3)


@pytest.mark.parametrize(
    ("case", "aim", "message"),
    [
        ({}, {}, "medium_band: received no limit of any band"),
        ({}, {"low_band": "1 um/s", "price": [1, 2]}, "price: received 2 values; allowed: one, or 3"),
        ({}, {"low_band": "1 um/s", "price": [0]}, "price: received only zeros"),
        ({}, {"low_band": "1 um/s", "fewest_waves": 9, "most_waves": 8}, "most_waves: received 8; allowed"),
        ({}, {"low_band": "1 um/s", "most_waves": 4}, "bands that may be changed: received none of 2 waves"),
        ({"inner_raceway": {}}, {"low_band": "1 um/s"}, "bands that may be changed: received none"),
        ({"sampling_rate": "10 kHz"}, {"high_band": "1 um/s"},
         r"high_band: received a limit in 1800 to 10000 Hz; allowed: bands that the sampling reaches"),
        ({}, {"low_band": "1 nm/s", "fewest_waves": 11},
         r"low_band: received 0.001 um/s in 50 to 300 Hz; allowed: more than [\d.]+ um/s, which the "),
    ],
)  # fmt: skip
def test_what_cannot_be_asked_is_refused(case, aim, message):
    with pytest.raises(InputError, match=message):
        asperity.optimise(CASE | case, **LINEAR, **aim)


def test_roughness_and_the_spectrum_are_changed_with_their_phases():
    keys = {"waviness": "10 nm", "last_order": 6, "fall": 1.0, "waves": [4], "amplitudes": ["1 nm"]}
    case = as_case(CASE | {"inner_raceway": {}, "balls": keys | {"roughness": "5 nm"}})
    aim = bearing.BearingAim(low_band="1 m/s")
    bands = bearing.part_bands(case, aim)
    assert [band.orders for band in bands] == [(2,), (3,), (4,), (5,), (6,), ()]
    assert bands[2].name == "balls, 4 waves"
    assert bands[-1].name == "balls, roughness"
    same = bearing.with_energies(case, bands, np.ones(6)).balls.texture()
    np.testing.assert_allclose(same.line(64, 3), case.balls.texture().line(64, 3), atol=1e-20)
    louder = bearing.with_energies(case, bands, np.array([1.0, 1.0, 1.0, 1.0, 1.0, 4.0])).balls
    assert louder.roughness == pytest.approx(10e-9)


def test_limits_are_lowered_by_all_that_was_missed_so_far():
    """What is rolled is 1 dB above what was sought, and 2 dB above at lower limits: 1, then 2 dB lower."""
    sought = []

    def of(kept):
        sought.append(20.0 * np.log10(kept))
        over = sought[-1] + (1.0 if len(sought) == 1 else 2.0)
        return SimpleNamespace(missed={"areal": np.maximum(over, 0.0)})

    found = bearing._within(of, np.ones(3))
    assert not found.missed["areal"].any()
    lowered = [-each[0] for each in sought]
    assert lowered == pytest.approx([0.0, 1.0 + AIMED_BELOW, 2.0 + AIMED_BELOW])


def test_a_limit_just_above_what_stays_is_kept_by_half_of_what_is_left():
    """0.01 dB above: nothing lies 0.025 dB below it."""
    stays, alone = np.array([4e-6, 0.0, 0.0]), np.array([[3e-6, 0.0, 0.0]])
    aim = bearing.BearingAim(low_band=4e-6 * 10.0 ** (0.01 / 20.0), reach="60 dB")
    bands = [bearing.PartBand("balls", (3,), 1e-7)]
    trials, rests = bearing._search(
        lambda energies: np.sqrt(stays**2 + energies @ alone**2), alone, stays, bands, aim, aim.limits
    )
    assert rests
    half = 0.5 * (aim.low_band**2 - 4e-6**2)
    assert trials[-1].energies == pytest.approx([half / 3e-6**2], rel=1e-6)


def test_a_limit_that_the_lowest_energies_miss_by_rounding_is_kept_by_them():
    weights, lowest = np.ones((1, 2)), np.full(2, 0.5)
    found = cheapest(weights, np.array([1.0 - 5e-10]), np.ones(2), lowest, np.ones(2))
    assert found == pytest.approx(lowest)
