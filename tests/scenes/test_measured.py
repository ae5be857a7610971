"""What was measured beside what was computed: in sound power, figures, tables and warnings of a run."""

import json

import numpy as np
import pytest

from asperity.case.bodies import WheelOnRail
from asperity.errors import MeasuredTrackWarning
from asperity.running import prepare_case
from asperity.scenes.figures.measured import MEASURED, measured_table
from asperity.scenes.figures.noise import noise_answers, radiated_power_bands, sound_power_table
from asperity.scenes.figures.track import decay_rate, receptance
from asperity.scenes.measured import HammerTest
from asperity.scenes.track import planned_track
from small_cases import HEARD

BAND = 1000.0 * 10.0 ** (np.arange(-8, 6) / 10.0)  # 160 Hz to 3.15 kHz


@pytest.fixture(scope="module")
def plain(runs):
    return runs(WheelOnRail(**HEARD))


def own_data(case):
    """What a hammer finds on the track of a case, as tables."""
    own = HammerTest.of_track(case.track.model(), BAND)
    mobility = own.mobility.ravel()
    columns = own.frequency.ravel(), mobility.real, mobility.imag
    return np.column_stack([BAND, own.decay_rate]), np.column_stack(columns)


def with_track(**keys):
    return WheelOnRail(**HEARD | {"track": HEARD["track"] | keys})


def warned(tree):
    return [
        w["message"] for w in json.loads(tree.attrs["warnings"]) if w["category"] == "MeasuredTrackWarning"
    ]


def test_own_data_fed_back_change_nothing(plain, runs):
    rates, mobility = own_data(WheelOnRail(**HEARD))
    tree = runs(with_track(decay_rates=rates, mobility=mobility))
    for name in ("radiated_power_level", "band_decay_rate"):
        np.testing.assert_allclose(tree["spectra"][name], plain["spectra"][name], rtol=1e-9)
    np.testing.assert_array_equal(
        tree["spectra/unmeasured_power_level"], plain["spectra/radiated_power_level"]
    )
    assert not warned(tree)
    inside = np.isfinite(tree["spectra/measured_power_change"].values)
    assert inside.sum() == len(BAND)
    np.testing.assert_allclose(tree["spectra/measured_power_change"][inside], 0.0, atol=1e-9)


@pytest.fixture(scope="module")
def damped(runs):
    """Four times the decay of the computed track from 500 Hz to 1 kHz, with rates sideways."""
    rates, _ = own_data(WheelOnRail(**HEARD))
    some = np.column_stack([rates[5:9, 0], 4.0 * rates[5:9, 1], np.full(4, 0.5)])
    return runs(with_track(decay_rates=some))


def test_four_times_the_decay_takes_six_decibels_of_rail_and_sleepers(plain, damped):
    inside = (plain["spectra/band"] > 490) & (plain["spectra/band"] < 1010)
    lost = plain["spectra/radiated_power_level"] - damped["spectra/radiated_power_level"]
    for part in ("rail", "sleepers", "total"):
        np.testing.assert_allclose(lost.sel(radiator=part)[0, inside], 20.0 * np.log10(2.0), rtol=1e-9)
        np.testing.assert_array_equal(lost.sel(radiator=part)[0, ~inside], 0.0)
    shorter = damped["spectra/band_decay_rate"] / plain["spectra/band_decay_rate"]
    np.testing.assert_allclose(shorter, np.where(inside, 4.0, 1.0))
    np.testing.assert_array_equal(damped["rolling/contact_force"], plain["rolling/contact_force"])
    heard = plain["pass_by/sound_exposure_level"] - damped["pass_by/sound_exposure_level"]
    np.testing.assert_allclose(heard.sel(radiator="rail")[0, inside], 20.0 * np.log10(2.0), rtol=1e-9)


def test_a_contradiction_is_warned_of_with_its_bands(damped):
    (message,) = warned(damped)
    assert "measured decay rate over that of the computed track, farthest from 1: 4 (" in message
    assert "see 500 Hz, 630 Hz, 800 Hz, 1 kHz. Fit pads, ballast and losses of [track]" in message


def test_a_plan_warns_of_it_too():
    rates, _ = own_data(WheelOnRail(**HEARD))
    rates[3, 1] *= 0.3
    with pytest.warns(MeasuredTrackWarning, match="farthest from 1: 0.3 ") as caught:
        planned_track(prepare_case(with_track(decay_rates=rates)))
    assert "see 315 Hz." in str(caught[-1].message)


def test_the_report_shows_both(damped):
    table = sound_power_table(damped)
    assert [row[1].text for row in table.rows[:2]] == ["by vibration", "nothing measured"]
    measured, computed = (float(row[table.head.index("total")].text) for row in table.rows[:2])
    assert computed > measured + 1.0
    card = noise_answers(damped).numbers[0]
    assert card.value == f"{measured:.1f} dB(A)"
    assert f"track as measured, {computed:.1f} dB(A) if all is computed" in card.note
    marks = radiated_power_bands.drawn(damped).chart.panels[0].marks
    assert "rail, nothing measured" in {getattr(mark, "label", "") for mark in marks}
    beside = measured_table(damped)
    assert beside.head == [
        "band",
        "decay rate, measured / (dB/m)",
        "computed",
        "lateral, measured",
        "rail and sleepers / dB",
    ]
    assert [(row[0].text, row[-1].text) for row in beside.rows] == [
        (f, "−6.0") for f in ("500", "630", "800", "1k")
    ]
    decay = decay_rate.collect(damped)
    shown = {line.label: line.values for line in decay.lines}
    inside = np.isfinite(shown[MEASURED])
    np.testing.assert_allclose(decay.at[inside][[0, -1]], [447.0, 1122.0], rtol=0.01)
    assert set(shown[f"{MEASURED}, lateral"][inside]) == {0.5}


def test_a_mobility_changes_force_and_rail_and_is_drawn_as_a_receptance(runs):
    _, mobility = own_data(WheelOnRail(**HEARD))
    tree = runs(with_track(mobility=np.column_stack([mobility[:, 0], 2.0 * mobility[:, 1:]])))
    names = "measured_mobility", "expected_mobility", "measured_force_change", "measured_power_change"
    own, expected, force, power = (tree["spectra"][f"{name}"].values for name in names)
    inside = np.isfinite(own)
    np.testing.assert_allclose(own[inside], 2.0 * expected[inside], rtol=1e-9)
    np.testing.assert_allclose((force + 20.0 * np.log10(2.0))[inside], power[inside], rtol=1e-9)
    soft = (tree["spectra/band"].values > 240) & (
        tree["spectra/band"].values < 410
    )  # softer than the contact
    assert (np.abs(power[soft]) < 2.0).all()
    assert (force[soft] < -4.0).all()
    assert not warned(tree)
    lines = {line.label: line.values for line in receptance.collect(tree).lines if line.units == "m/N"}
    assert 1.7 < np.nanmedian(lines[MEASURED] / lines["rail, mid-span"]) < 2.3
    assert "linear force / dB" in measured_table(tree).head
