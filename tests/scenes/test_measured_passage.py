"""A passage that was measured beside the track, laid beside the computed one of the same train."""

import numpy as np
import pytest
import xarray
from numpy.testing import assert_allclose

from asperity import WheelOnRail
from asperity.errors import CaseError
from asperity.reporting.data import unless_missing
from asperity.scenes import schema
from asperity.scenes.figures.measured import pass_by_bands, passage_table
from asperity.scenes.figures.noise import pass_by_answers
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


def result(**noise):
    return xarray.DataTree.from_dict({"/pass_by": group(laid_out(**noise))})


BANDS = np.column_stack([BAND[3:], np.full(len(BAND) - 3, 70.0)])


def test_bands_stand_where_they_were_measured():
    found = laid_out(measured_bands=BANDS)
    assert_allclose(found[schema.MEASURED_BAND_LEVEL], np.where(BAND < 490, np.nan, 70.0))


def test_the_report_compares_them():
    levels = {"measured_maximum_level": 70.0, "measured_equivalent_level": "68 dB"}
    tree = result(measured_bands=BANDS, measured_exposure_level=80.0, **levels)
    rows = [[cell.text for cell in row] for row in passage_table(tree).rows]
    assert [row[:2] for row in rows] == [["L_pAFmax", "70.0"], ["L_pAeq,Tp", "68.0"], ["TEL", "80.0"]]
    for row in rows:
        assert float(row[2]) - float(row[1]) == pytest.approx(float(row[3]), abs=0.11)
    assert "TEL measured 80.0 dB(A)" in pass_by_answers(tree).numbers[0].note
    bands = {line.label: line.values for line in pass_by_bands.collect(tree).lines}
    assert set(bands) == {"rail", "sleepers", "total", "measured"}
    assert_allclose(bands["measured"][3:], 70.0 + a_weighting(BAND[3:]))
    # the sum of the bands is the exposure level of the whole passage, over the pass-by time of 1.584 s
    whole = 10.0 * np.log10(np.sum(10.0 ** (bands["total"] / 10.0)))
    exposure = float(tree["pass_by/sound_exposure_level_a"][0, -1])
    assert whole == pytest.approx(exposure - 10.0 * np.log10(3 * 26.4 / 50.0), abs=1e-6)
    assert passage_table(result()) is None
    assert unless_missing(pass_by_bands.drawn, result()) is None


@pytest.mark.parametrize("key", ["measured_bands", "measured_equivalent_level", "measured_exposure_level"])
def test_levels_over_a_pass_by_time_need_one(key):
    noise = {key: BANDS if key == "measured_bands" else 80.0}
    with pytest.raises(CaseError, match=rf"noise\.{key}: received a single axle.*Give noise\.vehicle_length"):
        WheelOnRail(surface={"spectrum": "iso3095"}, noise=noise)
