"""A passage that was measured beside the track, laid beside the computed one of the same train."""

import numpy as np
import pytest
import xarray
from numpy.testing import assert_allclose

from asperity import WheelOnRail
from asperity.errors import CaseError, Grade
from asperity.radiation import pass_by
from asperity.scenes import schema
from asperity.scenes.figures.measured import PASS_BY_BANDS, passage_table
from asperity.scenes.figures.noise import PASS_BY, pass_by_answers
from asperity.scenes.measured import findings_of_passage
from asperity.scenes.noise import pass_by_group
from asperity.schema import group
from asperity.spectra import a_weighting

BAND = 1000.0 * 10.0 ** (np.arange(-6, 7) / 10.0)
TRAIN = {"axle_positions": [0.0, 2.5, 19.0, 21.5], "vehicle_length": 26.4, "vehicles": 3}


def laid_out(speed=50.0, **noise):
    """The pass-by of a sound power that falls from 100 dB in each band, by one law."""
    level = np.linspace(100.0, 90.0, len(BAND)) + np.array([0.0, -10.0, np.nan, 0.41])[:, None]
    names = {"law": ["areal"], "radiator": ["rail", "sleepers", "wheel", "total"], "band": BAND}
    power = {"radiated_power_level": (("law", "radiator", "band"), level[None])}
    spectra = xarray.Dataset(power | {"band_decay_rate": ("band", np.full(len(BAND), 2.0))}, names)
    case = WheelOnRail(surface={"spectrum": "iso3095"}, noise=TRAIN | noise, speed=speed)
    return pass_by_group(case, spectra)


COMPUTED = laid_out()
TIME, LEVEL = COMPUTED[schema.PASS_BY_TIME], COMPUTED[schema.PASS_BY_LEVEL][0, -1]
RECORD = np.column_stack([TIME + 81.3, LEVEL - 3.0])


def result(**noise):
    return xarray.DataTree.from_dict({"/pass_by": group(laid_out(**noise))})


def test_a_record_is_moved_over_the_computed_one():
    found = laid_out(measured_passage=RECORD)
    assert_allclose(found[schema.MEASURED_LEVEL][1:-1], LEVEL[1:-1] - 3.0, atol=1e-6)
    assert found[schema.MEASURED_DURATION_RATIO] == pytest.approx(1.0, abs=1e-9)
    assert found[schema.MEASURED_MAXIMUM_LEVEL] == pytest.approx(LEVEL.max() - 3.0)
    short = laid_out(measured_passage=RECORD[40:-30])
    inside = np.isfinite(short[schema.MEASURED_LEVEL])
    assert abs(inside.sum() - len(RECORD) + 70) <= 1  # an instant at an end may lie outside by rounding
    assert_allclose(short[schema.MEASURED_LEVEL][inside], LEVEL[inside] - 3.0, atol=1e-6)


def test_its_single_numbers_are_those_of_the_sound_before_time_weighting():
    """Weighting F spreads the energy by 0.125 s and delays it as much."""
    found = laid_out(measured_passage=RECORD)
    for own, computed, near in (
        (schema.MEASURED_EQUIVALENT_LEVEL, schema.PASS_BY_EQUIVALENT_LEVEL, 0.1),
        (schema.MEASURED_EXPOSURE_LEVEL, schema.TRANSIT_EXPOSURE_LEVEL, 0.1),
    ):
        assert found[own] == pytest.approx(float(found[computed][0, -1]) - 3.0, abs=near)


def test_the_energy_over_the_pass_by_time_is_taken_where_the_train_is():
    """Of a burst that begins and ends with the train, after time weighting."""
    time = np.arange(-4.0, 6.0, 0.002)
    front, rear = COMPUTED[schema.FRONT_TIME], COMPUTED[schema.REAR_TIME]
    burst = np.where((time >= front) & (time <= rear), 1.0, 1e-4)
    record = np.column_stack([time, pass_by.pressure_level(pass_by.time_weighted(burst, 0.002))])
    found = laid_out(measured_passage=record)
    assert found[schema.MEASURED_EQUIVALENT_LEVEL] == pytest.approx(94.0 - 0.02, abs=0.4)


def test_numbers_that_are_told_stand_for_those_of_a_record():
    found = laid_out(measured_passage=RECORD, measured_exposure_level="91.5 dB", measured_maximum_level=90.0)
    assert found[schema.MEASURED_EXPOSURE_LEVEL] == 91.5
    assert found[schema.MEASURED_MAXIMUM_LEVEL] == 90.0
    alone = laid_out(measured_equivalent_level=88.0)
    assert (alone[schema.MEASURED_EQUIVALENT_LEVEL], schema.MEASURED_LEVEL in alone) == (88.0, False)


def test_a_record_that_ends_early_has_fewer_numbers():
    """Ten decibels below its maximum is enough to lay it beside, not to find what TEL asks."""
    above = np.flatnonzero(LEVEL.max() - 10.5 < LEVEL)
    found = laid_out(measured_passage=RECORD[above[0] - 1 : above[-1] + 2])
    assert schema.MEASURED_EQUIVALENT_LEVEL in found
    assert schema.MEASURED_EXPOSURE_LEVEL not in found


def test_another_speed_is_told():
    found = laid_out(measured_passage=RECORD, speed=35.0)
    (finding,) = findings_of_passage(found)
    assert finding.grade is Grade.WARNING
    assert found[schema.MEASURED_DURATION_RATIO] == pytest.approx(0.7, abs=0.03)
    assert "It was another train, or another speed." in finding.message
    (fine,) = findings_of_passage(laid_out(measured_passage=RECORD))
    assert fine.grade is None
    assert findings_of_passage(laid_out()) == []


BANDS = np.column_stack([BAND[3:], np.full(len(BAND) - 3, 70.0)])


def test_bands_stand_where_they_were_measured():
    found = laid_out(measured_bands=BANDS)
    assert_allclose(found[schema.MEASURED_BAND_LEVEL], np.where(BAND < 490, np.nan, 70.0))


def test_the_report_compares_them():
    tree = result(measured_passage=RECORD, measured_bands=BANDS, measured_exposure_level=80.0)
    rows = [[cell.text for cell in row] for row in passage_table(tree).rows]
    assert [row[0] for row in rows] == ["L_pAFmax", "L_pAeq,Tp", "TEL"]
    assert rows[0][-1] == "+3.0"
    assert float(rows[2][2]) - 80.0 == pytest.approx(float(rows[2][3]), abs=0.11)
    assert "TEL measured 80.0 dB(A)" in pass_by_answers(tree).numbers[0].note
    drawn = {line.label: line.values for line in PASS_BY.collect(tree).lines}
    assert_allclose(drawn["measured"][1:-1], LEVEL[1:-1] - 3.0, atol=1e-6)
    assert "Measured: moved in time" in PASS_BY.said(tree)
    bands = {line.label: line.values for line in PASS_BY_BANDS.collect(tree).lines}
    assert set(bands) == {"rail", "sleepers", "total", "measured"}
    assert_allclose(bands["measured"][3:], 70.0 + a_weighting(BAND[3:]))
    # the sum of the bands is the exposure level of the whole passage, over the pass-by time of 1.584 s
    whole = 10.0 * np.log10(np.sum(10.0 ** (bands["total"] / 10.0)))
    exposure = float(tree["pass_by/sound_exposure_level_a"][0, -1])
    assert whole == pytest.approx(exposure - 10.0 * np.log10(3 * 26.4 / 50.0), abs=1e-6)
    assert passage_table(result()) is None
    assert not PASS_BY_BANDS.drawable(result())


@pytest.mark.parametrize("key", ["measured_bands", "measured_equivalent_level", "measured_exposure_level"])
def test_levels_over_a_pass_by_time_need_one(key):
    noise = {key: BANDS if key == "measured_bands" else 80.0}
    with pytest.raises(CaseError, match=rf"noise\.{key}: received a single axle.*Give noise\.vehicle_length"):
        WheelOnRail(surface={"spectrum": "iso3095"}, noise=noise)
