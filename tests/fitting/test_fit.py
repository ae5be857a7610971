"""Keys come back from data that they made, within intervals that hold; what data leave open is said."""

import math
from dataclasses import replace

import numpy as np
import pytest

import asperity
from asperity import observables
from asperity.fitting import determined, running
from asperity.fitting.determined import open_direction, spread_of
from asperity.fitting.fitted import Estimate, Undetermined
from asperity.fitting.free import free_key
from asperity.fitting.tried import TriedCase
from asperity.observables.observable import Measured, Observable
from known_keys import RUBBER, mobility
from refusals import refusals

TRUE = {"track.pad_stiffness": 4e8, "track.pad_loss_factor": 0.25}
FREQUENCY = np.geomspace(80.0, 2500.0, 14)


def test_keys_of_a_track_come_back_from_its_mobility(track):
    true = TRUE | {"track.ballast_stiffness": 9e7, "track.ballast_loss_factor": 0.6}
    found = asperity.fit(track, mobility(track.with_(**true), FREQUENCY), list(true), starts=2)
    assert found.values == pytest.approx(true, rel=1e-4)
    assert found.rms() < 1e-3 < found.rms(before=True)
    assert found.case.track.pad_stiffness == found.values["track.pad_stiffness"]
    assert found.case.with_(**dict.fromkeys(true)) == track.with_(**dict.fromkeys(true))


@pytest.mark.parametrize("stated", [pytest.param(True, marks=pytest.mark.long), False])
def test_values_lie_within_their_intervals_as_often_as_said(track, rubber, stated):
    """95 ± 4 % of 200 trials, of each key; the scatter of 95 % of so many is 1.5 %."""
    draws, at = np.random.default_rng(7), np.linspace(0.0, 3.0, 12)
    exact = 1e-8 * TRUE["track.pad_stiffness"] * np.exp(-TRUE["track.pad_loss_factor"] * at)
    inside = dict.fromkeys(TRUE, 0)
    for _ in range(200):
        noisy = exact * 10.0 ** (0.1 * 0.4 * draws.standard_normal(len(at)))
        data = Measured(RUBBER, at, noisy, uncertainty=0.4 if stated else None)
        found = asperity.fit(track, data, starts=1)
        for name, (low, high) in found.intervals.items():
            inside[name] += low <= TRUE[name] <= high
    assert all(0.91 <= count / 200 <= 0.99 for count in inside.values()), inside


def test_an_interval_is_that_of_a_line_of_least_squares(track, rubber):
    """ln k − η x is a line in the logarithm of k: its deviation is known from any book."""
    at = np.linspace(0.0, 3.0, 12)
    level = np.array([0.3, -0.2, 0.1, 0.4, -0.5, 0.0, 0.2, -0.1, -0.3, 0.4, -0.2, 0.1])
    data = Measured(RUBBER, at, 4.0 * np.exp(-0.25 * at) * 10.0 ** (0.1 * level))
    found = asperity.fit(track, data, starts=1)
    design = np.stack([np.ones(12), -at], axis=1)
    line, square, *_ = np.linalg.lstsq(design, np.log(data.values), rcond=None)
    spread = square[0] / 10 * np.linalg.inv(design.T @ design)
    assert found.values["track.pad_stiffness"] == pytest.approx(1e8 * np.exp(line[0]), rel=1e-5)
    low, high = found.intervals["track.pad_stiffness"]
    half = 2.228139 * np.sqrt(spread[0, 0])  # Student, 10 degrees of freedom
    assert np.log(high / low) == pytest.approx(2.0 * half, rel=1e-3)
    known = asperity.fit(track, replace(data, uncertainty=0.5), starts=1)
    assert known.values == pytest.approx(found.values)
    low, high = known.intervals["track.pad_stiffness"]
    of_data = (0.5 * np.log(10.0) / 10.0) * np.sqrt(np.linalg.inv(design.T @ design)[0, 0])
    assert np.log(high / low) == pytest.approx(2.0 * 1.959964 * of_data, rel=1e-3)  # normal
    # of the logarithm of η, whose slope is η times that of η itself
    both = spread[0, 1] / np.sqrt(spread[0, 0] * spread[1, 1])
    assert found.correlations[0, 1] == pytest.approx(both, abs=1e-3)


def test_pads_and_ballast_in_series_are_told_as_one(track):
    """Far below any resonance a support is k_p k_b/(k_p + k_b): ballast goes as half of what pads do here."""
    losses = {"track.pad_loss_factor": 0.3, "track.ballast_loss_factor": 0.3}
    base = track.with_(**{"track.ballast_stiffness": 1.5e8, "track.sleeper_mass": 1.0, **losses})
    stiff = base.with_(**{"track.pad_stiffness": 4e8, "track.ballast_stiffness": 2e8})
    data = mobility(stiff, [1.0, 1.5, 2.0, 3.0, 4.0])
    found = asperity.fit(base, data, ["track.pad_stiffness", "track.ballast_stiffness"], starts=2)
    (left,) = found.undetermined
    assert left.free.name == "track.pad_stiffness"
    ((other, change),) = left.others
    assert other == "track.ballast_stiffness"
    kept, series = 3e8, 4e8 * 2e8 / 6e8
    ballast = series * kept / (kept - series)
    assert found.values == {other: pytest.approx(ballast, rel=1e-3)}
    assert found.case.track.pad_stiffness == kept
    assert change < 0.0
    assert found.sentence.startswith(
        "track.pad_stiffness is not determined apart from track.ballast_stiffness: "
    )
    assert f"less of {other}; left at 300 MN/m" in found.sentence


def test_of_two_in_series_the_one_is_held_with_which_the_data_are_met(track):
    """Pads of 100 MN/m, as the case has them, are softer than both together were: ballast is left instead."""
    losses = {"track.pad_loss_factor": 0.3, "track.ballast_loss_factor": 0.3, "track.sleeper_mass": 1.0}
    base = track.with_(**{"track.pad_stiffness": 1e8, "track.ballast_stiffness": 2e8, **losses})
    stiff = base.with_(**{"track.pad_stiffness": 4e8})
    data = mobility(stiff, [1.0, 1.5, 2.0, 3.0, 4.0])
    found = asperity.fit(base, data, ["track.ballast_stiffness", "track.pad_stiffness"], starts=2)
    assert [each.free.name for each in found.undetermined] == ["track.ballast_stiffness"]
    assert found.values == {"track.pad_stiffness": pytest.approx(4e8, rel=1e-3)}


def lossy():
    """Data of a loss factor of 0.06."""
    at = np.linspace(0.0, 3.0, 12)
    return Measured(RUBBER, at, 3.0 * np.exp(-0.06 * at), uncertainty=1.5)


@pytest.mark.parametrize("keys", [list(TRUE), ["track.pad_loss_factor"]])
def test_a_value_that_data_contradict_is_not_left_as_the_case_has_it(track, rubber, keys):
    """A loss factor of 0.06 is known to a factor of ten; 0.5, as the case has it, is 2 to 3 dB rms off."""
    found = asperity.fit(track.with_(**{"track.pad_loss_factor": 0.5}), lossy(), keys, starts=1)
    assert not found.undetermined
    assert found.values["track.pad_loss_factor"] == pytest.approx(0.06, rel=0.02)
    low, high = found.intervals["track.pad_loss_factor"]
    assert high / low > 9.0


def test_an_open_value_that_data_do_not_contradict_is_left_as_the_case_has_it(track, rubber):
    """0.12 in place of the loss factor of 0.06 is 0.2 dB rms off, of data that are certain to 1.5 dB."""
    found = asperity.fit(track.with_(**{"track.pad_loss_factor": 0.12}), lossy(), starts=1)
    assert [each.free.name for each in found.undetermined] == ["track.pad_loss_factor"]
    assert found.case.track.pad_loss_factor == 0.12


def test_the_chance_of_the_record_that_is_run_is_in_the_intervals(track, monkeypatch):
    """Of levels that scatter by 0.5 to 5 dB from record to record: 95 ± 4 % of 200 trials."""
    chance = np.geomspace(5.0, 0.5, 12)
    heard = Observable(
        "loudness",
        "dB",
        "x (1)",
        0.0,
        0.1,
        lambda _: "",
        lambda trial, measured: trial.case.surface.level + 0.0 * measured.at,
        lambda _: ("surface.level",),
        "loudness",
        collect=lambda _: {},
        chance=lambda _, measured: chance[np.rint(measured.at).astype(int)],
    )
    monkeypatch.setitem(observables.BUILT_IN, "loudness", heard)
    monkeypatch.setattr(TriedCase, "collected", {})
    draws, inside, at = np.random.default_rng(3), 0, np.arange(12.0)
    for _ in range(200):
        data = Measured("loudness", at, 4.0 + chance * draws.standard_normal(12))
        low, high = asperity.fit(track, data, starts=1).intervals["surface.level"]
        inside += low <= 4.0 <= high
        assert high - low < 3.0  # by all bands alike it would be 4 dB
    assert 0.91 <= inside / 200 <= 0.99
    alike = Measured("loudness", at, 4.0 + 0.0 * at)
    low, high = asperity.fit(track, alike, starts=1).intervals["surface.level"]
    known = 2.200985 / np.sqrt(np.sum(1.0 / (0.1**2 + chance**2)))  # Student, 11 degrees of freedom
    assert high - low == pytest.approx(2.0 * known, rel=1e-3)  # records that agree by chance tell no more


def test_the_open_direction_is_the_one_that_changes_nothing():
    slopes = np.outer(np.linspace(1.0, 2.0, 6), [1.0, 2.0])  # of b/3 and 2 b/3: the second weighs twice
    found = determined.open_direction(slopes, determined.Spread(1.0, 2.0))
    assert (found.number, found.others) == (0, {1: pytest.approx(-0.5)})
    assert found.half_width == np.inf
    other = determined.open_direction(slopes, determined.Spread(1.0, 2.0), {0})
    assert (other.number, other.others) == (1, {0: pytest.approx(-2.0)})
    assert determined.open_direction(slopes, determined.Spread(1.0, 2.0), {0, 1}) is None


def test_what_levels_are_open_with_is_told_in_decibels(track):
    """An e-fold of an amplitude is 8.7 dB: 1 dB is 11.5 % of a stiffness."""
    name, stiffness = "noise.receiver_offset", "track.pad_stiffness"
    offset, pads = (free_key(track, each) for each in (name, stiffness))
    told = Undetermined(offset, (("surface.level", -0.5), (stiffness, 2.0)), (name, "surface.level"))
    assert ": 1 dB more of it is made up for by 0.5 dB less of surface.level and 23 % more of" in told.words
    assert (
        ": 1 % more of it is made up for by 0.17 dB more" in Undetermined(pads, ((name, 2.0),), (name,)).words
    )


def test_a_value_known_to_a_factor_of_three_is_determined():
    """By 95 %: half its interval, of logarithms, is 1.96 over the slope of the residuals."""
    spread = spread_of(1.0, 1, believed=True)
    for factor, is_open in ((2.9, False), (3.1, True)):
        slopes = np.array([[1.959964 / math.log(factor)], [0.0]])
        assert (open_direction(slopes, spread) is not None) == is_open


def test_scatter_read_from_repeats_widens_intervals_and_never_narrows_them():
    """Student's 2.228 of ten degrees of freedom; without repeats what is left narrows them, too."""
    for square, repeated, alone in ((2.5, 1.0, 0.5), (40.0, 2.0, 2.0)):
        read = spread_of(square, 10, believed=False, read=True)
        assert (read.scale, read.quantile) == (repeated, pytest.approx(2.228139, abs=1e-6))
        assert spread_of(square, 10, believed=False).scale == pytest.approx(alone)


def test_what_data_never_feel_is_left_alone(track):
    base = track.with_(**{"track.rail_loss_factor": 0.01})
    data = mobility(base.with_(**TRUE), FREQUENCY)
    keys = ["track.rail_foot_width", *TRUE]
    found = asperity.fit(base, data, keys, starts=1)
    assert [each.free.name for each in found.undetermined] == ["track.rail_foot_width"]
    assert found.undetermined[0].words.endswith("is not determined by these data; left at 150 mm")
    assert found.values == pytest.approx(TRUE, rel=1e-4)


def test_a_value_on_its_limit_is_told(track, rubber):
    at = np.linspace(0.0, 3.0, 12)
    data = Measured(RUBBER, at, 4.0 * np.exp(-0.9 * at))
    found = asperity.fit(track, data, starts=1)
    last = found.estimates[1]
    assert (last.limit, last.interval) == ("largest", None)
    assert last.value == pytest.approx(0.5, rel=2e-3)
    assert "On a limit: track.pad_loss_factor." in found.sentence
    free = {"track.pad_stiffness": None, "track.pad_loss_factor": (0.05, 2.0)}
    assert asperity.fit(track, data, free, starts=1).values["track.pad_loss_factor"] == pytest.approx(0.9)


def test_what_a_case_leaves_out_is_found_beside_the_uncertainty(track, rubber):
    """Data that are certain to 0.1 dB and scatter by 0.8 dB: the case leaves out the difference."""
    at = np.linspace(0.0, 3.0, 400)
    noise = 0.8 * np.random.default_rng(2).standard_normal(400)
    data = Measured(RUBBER, at, 4.0 * np.exp(-0.25 * at) * 10.0 ** (0.1 * noise), uncertainty=0.1)
    found = asperity.fit(track, data, starts=1)
    assert found.left_out == pytest.approx(np.sqrt(0.8**2 - 0.1**2), rel=0.1)
    assert "it leaves out 0.8 dB" in found.sentence


def test_a_loss_factor_takes_the_place_of_a_damping(track):
    damped = asperity.WheelOnRail(surface={"spectrum": "iso3095"}, track={"pad_damping": "28 kN s/m"})
    true = damped.with_(**{"track.pad_damping": None, "track.pad_loss_factor": 0.2})
    found = asperity.fit(damped, mobility(true, FREQUENCY), ["track.pad_loss_factor"], starts=1)
    assert found.values == {"track.pad_loss_factor": pytest.approx(0.2, rel=1e-3)}
    assert "pad_damping" not in found.case.to_toml()


def test_a_fit_goes_on_where_it_was(track, rubber, monkeypatch):
    at = np.linspace(0.0, 3.0, 12)
    data, descended = Measured(RUBBER, at, 4.0 * np.exp(-0.25 * at)), []
    descend = running.descend

    def interrupted(*arguments):
        if len(descended) == 2:
            raise KeyboardInterrupt
        descended.append(arguments)
        return descend(*arguments)

    monkeypatch.setattr(running, "descend", interrupted)
    with pytest.raises(KeyboardInterrupt):
        asperity.fit(track, data, starts=3)
    count = []
    monkeypatch.setattr(running, "descend", lambda *arguments: count.append(1) or descend(*arguments))
    found = asperity.fit(track, data, starts=3)
    assert len(count) == 2  # from the third start, and to the end
    assert found.values == pytest.approx(TRUE, rel=1e-5)


SMOOTH = {"smooth": True}
BEAM = asperity.BallOnBeam(surface=SMOOTH)
POINTS = Measured("vertical decay rate", [100.0, 125.0, 160.0], [5.0, 4.0, 3.0])
test_it_says_what_is_wrong = refusals(
    ({"case": BEAM}, "a case with no track: it is of kind ball-on-beam; allowed: what the case can predict"),
    ({"free": ["track.pad"]}, "track.pad: received an unknown key; allowed: a key of a wheel-on-rail case"),
    ({"free": ["track.name"]}, "allowed: a key that holds one number, as track.pad_stiffness"),
    ({"free": []}, "free: received no key; allowed: one key or more"),
    ({"free": "track.pad_stiffness"}, "free: received 'track.pad_stiffness'; allowed: a list of keys"),
    ({"free": ["track.pad_stiffness"] * 2}, "free more than once; allowed: each key once"),
    ({"free": ["track.pad_stiffness = "]}, "allowed: a key, or a key = least..largest"),
    ({"free": ["track.pad_stiffness = 3 MN/m"]}, 'allowed: a least and a largest value, as (1e8, 2e9) or "'),
    ({"free": {"track.pad_stiffness": (3e8, 1e8)}}, "allowed: a least value below the largest"),
    ({"free": ["track.pad_stiffness = 1..2 kg"]}, "received '1 kg'; allowed: a least and a largest value"),
    ({"free": {"track.pad_stiffness": (1.0, 1e9)}}, "1 N/m; allowed: 1 kN/m to 1 TN/m"),
    ({"free": None}, "fit: received 5 free keys and 3 values; allowed: more values than free keys"),
    ({"starts": 0.5, "free": ["track.pad_stiffness"]}, "starts: received 0.5; allowed: 1 to 100"),
    ({"measured": []}, "what was measured: received nothing; allowed: one file or more"),
    (
        {"measured": None},
        "allowed: files, or keys of the case that name them. Name files of what was measured",
    ),
    (
        {"measured": Measured("colour", [1.0], [1.0])},
        "received 'colour'; allowed: one of vertical decay rate",
    ),
    (
        {
            "measured": mobility(asperity.WheelOnRail(surface={"smooth": True}), [1e3, 2e3]),
            "free": ["wheel.load"],
        },
        "data that leave every free key open (wheel.load is not determined by these data; left at 65 kN); "
        "allowed: data that tell one of them",
    ),
    of=lambda given, track: asperity.fit(**{"case": track, "measured": POINTS, "free": None} | given),
)

test_what_was_measured_is_checked = refusals(
    (([1.0], [1.0, 2.0]), "x: received an array"),
    (([1.0], [np.nan]), "x: received what is not finite"),
    (([1.0], [1.0], 0.0), "uncertainty of the x: received 0.0; allowed: dB, greater than 0"),
    of=lambda given: Measured("x", *given),
)


def test_values_before_and_intervals_stand_in_words(track):
    free = replace(free_key(track, "track.pad_stiffness"), before=3e8, given=True)
    found = Estimate(free, 4e8, (3.5e8, 4.5e8), "")
    assert (found.before_in_words, found.interval_in_words) == ("300 MN/m", "350 MN/m to 450 MN/m")
    found = Estimate(replace(free, given=False), 4e8, None, "least")
    assert (found.before_in_words, found.interval_in_words) == ("–", "on its limit")
