"""A row of runs that jump: curves through it, the chance of a record, and where it meets the data."""

from dataclasses import replace

import numpy as np
import pytest

import asperity
from asperity import observables
from asperity.errors import InputError
from asperity.fitting.row import NEIGHBOURS, STEP, Row, places_of, weights
from asperity.fitting.tried import TriedCase
from asperity.observables.observable import Measured, Observable

PLACES = places_of(-2.0, 2.0)
SLOPES = np.array([-6.0, -4.0, 3.0, 2.0, 1.0])
"""dB per e-fold, of five lines."""


def test_a_parabola_is_its_own_curve_without_chance():
    left = 3.0 - 2.0 * PLACES[:, None] + np.array([1.0, -4.0]) * PLACES[:, None] ** 2
    row = Row(PLACES, left)
    exact = 3.0 - 2.0 * row.fine[:, None] + np.array([1.0, -4.0]) * row.fine[:, None] ** 2
    np.testing.assert_allclose(row.curves, exact, atol=1e-9)
    assert row.chance(0.3) == pytest.approx(0.0, abs=1e-9)
    assert weights(PLACES, row.fine).sum(axis=1) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("at", [-2.0, 0.03, 1.1])
def test_a_curve_nearby_is_clevelands(at):
    """A parabola by least squares, of eleven neighbours weighted by (1 − |d/h|³)³, h 12/11 of the last."""
    values = np.random.default_rng(2).standard_normal(len(PLACES))
    near = np.argsort(np.abs(PLACES - at), kind="stable")[:11]
    away = PLACES[near] - at
    tricube = (1.0 - np.abs(away / (12.0 / 11.0 * np.abs(away).max())) ** 3) ** 3
    expected = np.polyfit(away, values[near], 2, w=np.sqrt(tricube))[-1]
    assert weights(PLACES, np.array([at])) @ values == pytest.approx(expected, rel=1e-9)


def test_a_row_has_enough_places_however_near_its_ends_are():
    assert np.diff(places_of(0.0, 4.0)) == pytest.approx(STEP)
    assert len(places_of(0.0, 0.1)) == 2 * NEIGHBOURS + 1


def test_the_chance_is_that_of_another_record_less_the_curve():
    """Known: records scatter by 0.5 dB at the lower half and by 0.1 dB at the upper, the curve by less."""
    draws, told, off = np.random.default_rng(4), [], []
    scatter = np.where(PLACES < 0.0, 0.5, 0.1)[:, None]
    for _ in range(300):
        row = Row(PLACES, np.sin(0.7 * PLACES)[:, None] + scatter * draws.standard_normal((len(PLACES), 2)))
        told.append([row.chance(-1.3) ** 2, row.chance(1.3) ** 2])
        at = np.array([-1.3, 1.3])
        another = np.sin(0.7 * at)[:, None] + np.array([[0.5], [0.1]]) * draws.standard_normal((2, 2))
        off.append(another - weights(PLACES, at) @ row.left)
    expected = np.mean(np.square(off), axis=(0, 2))
    assert np.mean(told, axis=(0, 2)) == pytest.approx(expected, rel=0.15)
    assert expected == pytest.approx([0.25 * 1.25, 0.01 * 1.25], rel=0.2)


@pytest.mark.parametrize(
    ("stated", "repeated", "noise", "jumps"),
    [
        (True, False, 0.5, 0.4),
        (True, True, 0.5, 0.4),
        (False, False, 1.0, 0.4),
        (True, False, 1.0, 0.0),
        (False, False, 1.0, 0.0),
    ],
)
def test_intervals_hold_as_often_as_said(stated, repeated, noise, jumps):
    """Lines that go with the place: 95 ± 4 % of 200 trials, and no wider than their slopes have it."""
    draws, held, half = np.random.default_rng(8), 0, []
    for true in np.linspace(-0.7, 0.7, 200).tolist():
        shape = (len(PLACES), len(SLOPES))
        left = SLOPES * (true - PLACES)[:, None] + jumps * draws.standard_normal(shape)
        left += np.hypot(noise, jumps) * draws.standard_normal(len(SLOPES))
        told = np.full(len(SLOPES), noise if stated else 1.0)
        met = Row(PLACES, left).met(told, stated=stated, repeated=repeated)
        low, high = met.ends
        held += low.place <= true <= high.place
        half.append(0.5 * (high.place - low.place))
    assert held >= 182
    if not repeated:
        assert held <= 198
    quantile = 1.96 if stated and not repeated else 2.776
    known = quantile * np.hypot(noise, 1.1 * jumps) / np.sqrt(np.sum(SLOPES**2))
    assert np.median(half) == pytest.approx(known, rel=0.25)


def test_what_the_case_leaves_out_widens_an_interval():
    """Lines that are met within 0.1 dB by no place, and are said to be certain to that."""
    left = SLOPES * (0.2 - PLACES)[:, None] + np.array([2.0, -2.0, 2.0, -2.0, 2.0])
    met = Row(PLACES, left).met(np.full(5, 0.1), stated=True, repeated=False)
    assert met.beyond == pytest.approx(2.0, rel=0.2)
    assert met.ends[1].place - met.ends[0].place > 0.8


def test_an_interval_that_reaches_the_end_of_a_row_says_so():
    left = SLOPES * (1.9 - PLACES)[:, None]
    low, high = Row(PLACES, left).met(np.full(5, 1.0), stated=True, repeated=False).ends
    assert (low.stop, high.stop) == ("", "further")
    assert high.place == PLACES[-1]


@pytest.fixture
def loud(monkeypatch):
    """A quantity of runs that jumps: the level of the pads' stiffness, in two bands of three dB a decade."""
    heard = Observable(
        "loudness",
        "dB",
        "x (1)",
        0.0,
        0.1,
        lambda _: "",
        lambda trial, measured: measured.at * np.log10(trial.whole.track.pad_stiffness),
        lambda _: ("track.pad_stiffness",),
        "loudness",
        collect=lambda _: {},
        jumps=True,
    )
    monkeypatch.setitem(observables.BUILT_IN, "loudness", heard)
    monkeypatch.setattr(TriedCase, "collected", {})
    return lambda stiffness, slopes, **more: Measured(
        "loudness", slopes, slopes * np.log10(stiffness), **more
    )


SLOPED = np.array([10.0, -20.0, 30.0])


def test_a_value_on_its_limit_has_no_interval(track, loud):
    found = asperity.fit(track, loud(900e6, SLOPED), ["track.pad_stiffness = 100..600 MN/m"])
    (estimate,) = found.estimates
    assert estimate.limit == "largest"
    assert estimate.interval is None
    assert found.correlations.size == 0
    assert found.values["track.pad_stiffness"] == pytest.approx(600e6)


def test_an_interval_stops_at_a_limit_or_where_the_row_ends(track, loud):
    wide = loud(550e6, SLOPED, uncertainty=3.0)
    (limited,) = asperity.fit(track, wide, ["track.pad_stiffness = 100..600 MN/m"]).estimates
    assert limited.stops == ("", "limit")
    assert limited.interval[1] == pytest.approx(600e6)
    far = loud(2.9e9, SLOPED, uncertainty=3.0)
    (further,) = asperity.fit(track, far, {"track.pad_stiffness": (3e6, 3e11)}).estimates
    assert further.stops == ("", "further")
    assert further.interval[1] == pytest.approx(3e9, rel=1e-3)


def test_what_a_row_leaves_out_stands_in_the_result(track, loud):
    off = replace(loud(300e6, SLOPED, uncertainty=0.1), values=SLOPED * np.log10(300e6) + [2.0, 2.0, -2.0])
    found = asperity.fit(track, off, ["track.pad_stiffness"])
    assert found.left_out > 1.0
    assert asperity.fit(track, loud(300e6, SLOPED, uncertainty=0.1), ["track.pad_stiffness"]).left_out == 0.0


def test_a_row_that_leaves_its_only_key_open_is_told(track, loud):
    with pytest.raises(
        InputError, match=r"leave every free key open \(track\.pad_stiffness is not determined"
    ):
        asperity.fit(track, loud(300e6, 0.1 * SLOPED, uncertainty=3.0), ["track.pad_stiffness"])
