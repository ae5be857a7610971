"""A pass-by beside the limits of TSI Noise, and a case beside the conditions of ISO 3095."""

import json

import numpy as np
import pytest
import xarray
from numpy.testing import assert_allclose

from asperity import WheelOnRail
from asperity.errors import CaseError
from asperity.reference.cnossos import rail_roughness
from asperity.reference.railways import pass_by_limit
from asperity.scenes.beside_track import pass_by_group, sources_of
from asperity.scenes.figures.measured import limit_sentence, limits_table
from asperity.scenes.figures.noise import pass_by_answers
from asperity.scenes.measured import _of_roughness
from asperity.scenes.track import stated_levels
from asperity.schema import group
from asperity.surfaces.heightmap import Profile
from refusals import refusals

BAND = 1000.0 * 10.0 ** (np.arange(-7, 8) / 10.0)
KMH = 1.0 / 3.6
VEHICLE = {"vehicle": "emu", "axle_positions": [0.0, 2.5, 19.0, 21.5], "vehicle_length": 26.4}
DECAY = np.where(BAND < 380.0, 3.0, np.where(BAND < 760.0, 7.0, 3.0))  # above the limit


TABLE_4 = {
    "electric-locomotive": (84.0, 99.0), "diesel-locomotive": (85.0, None), "emu": (80.0, 95.0),
    "dmu": (81.0, 96.0), "coach": (79.0, None), "wagon": (83.0, None),
}  # fmt: skip


@pytest.mark.parametrize("vehicle", TABLE_4)
def test_limits_of_table_4(vehicle):
    """Regulation (EU) No 1304/2014, as printed, and its formulas (1), (2) and (4)."""
    slow, fast = TABLE_4[vehicle]
    at = {v: pass_by_limit(vehicle, v * KMH, 0.15) for v in (60.0, 80.0, 160.0, 249.9, 250.0, 320.0)}
    axles = 10.0 * np.log10(0.225 / 0.15) if vehicle == "wagon" else 0.0
    speeds = {60.0: 0.0, 80.0: 0.0, 160.0: -30 * np.log10(2.0), 249.9: -30 * np.log10(249.9 / 80.0)}
    for v, change in speeds.items():
        assert (at[v].level, 3.6 * at[v].speed) == (slow, pytest.approx(80.0))
        assert_allclose(at[v].normalisation, change + axles, atol=1e-9)
    for v, change in {250.0: 0.0, 320.0: -50.0 * np.log10(320.0 / 250.0)}.items():
        assert (at[v].level, 3.6 * at[v].speed) == (fast, pytest.approx(250.0))
        assert_allclose(at[v].normalisation, change + axles, atol=1e-9)


def test_a_level_is_compared_as_a_whole_decibel():
    limit = pass_by_limit("emu", 80.0 * KMH, 0.15)
    assert [limit.met(level) for level in (79.0, 80.0, 80.49, 80.5, 81.0)] == [True, True, True, False, False]


def passed(speed=160.0, power=100.0, decay=DECAY, over=-1.0, wheel=np.nan, measured=np.nan, **noise):
    """The pass-by of a sound power in the band of 1 kHz, dB, on a rail as rough as the limit and over."""
    level, parts = np.full((4, len(BAND)), np.nan), np.array([power, power - 10.0, wheel])
    level[:, 7] = *parts, 10.0 * np.log10(np.nansum(10.0 ** (parts / 10.0)))
    names = {"law": ["areal"], "radiator": ["rail", "sleepers", "wheel", "total"], "band": BAND}
    wavelength, limit = rail_roughness("iso3095")
    rough = np.stack([limit[7:29] + over, limit[7:29] + 20.0])  # the wheel's is not asked
    spectra = {
        "radiated_power_level": (("law", "radiator", "band"), level[None]),
        "band_decay_rate": ("band", decay),
        "measured_decay_rate": ("band", measured * decay),
        "roughness_level": (("part", "surface_band"), rough),
    }
    held = xarray.Dataset(
        spectra, names | {"part": ["rail", "wheel"], "surface_band": wavelength[7:29] * 1.005}
    )
    case = WheelOnRail(surface={"spectrum": "iso3095"}, noise=VEHICLE | noise, speed=speed * KMH)
    return group(pass_by_group(case, held))


def told(*args, **keys):
    tree = xarray.DataTree.from_dict({"/pass_by": passed(*args, **keys)})
    return limit_sentence(tree), limits_table(tree)


def conditions(**keys):
    return {each["condition"]: each for each in json.loads(passed(**keys).attrs["reference_conditions"])}


def test_the_level_is_normalised_and_held_to_the_limit():
    by = passed(wheel=95.0)
    assert (by.attrs["tsi_limit"], by.attrs["vehicle"]) == (80.0, "emu")
    assert_allclose(by.attrs["reference_speed"], 80.0 * KMH)
    change = by["normalised_level"] - by["pass_by_equivalent_level"]
    assert_allclose(change, -30.0 * np.log10(2.0), atol=1e-9)
    assert all(each["met"] for each in conditions().values())
    wagon = passed(80.0, vehicle="wagon", vehicles=3)
    change = wagon["normalised_level"] - wagon["pass_by_equivalent_level"]
    assert_allclose(change.sel(radiator="rail"), -10.0 * np.log10(4 / 26.4 / 0.225), atol=1e-9)


def test_said_whether_it_is_met_and_what_decides():
    by = passed()
    level = float(by["normalised_level"].sel(radiator="total").item())
    louder = 100.0 + 80.0 - level  # exactly the limit
    below, within, above = "3.0 dB below the 80 dB(A)", "met as a whole", "2.0 dB over the 80 dB(A)"
    for change, words in ((-3.0, below), (0.3, within), (2.0, above)):
        sentence, table = told(power=louder + change, wheel=0.0)
        assert words in sentence
        assert "TSI Noise, EMU: rolling noise alone has" in sentence
        assert sentence.endswith("at 80 km/h, " + table.rows[0][2].text + "; the rail decides.")
        assert table.rows[0][3].text == ("no" if words == above else "yes")
        assert [row[3].text for row in table.rows[1:]] == ["yes"] * 4
    unknown = "3.0 dB below the 80 dB(A) allowed without the wheel's part, so that it is not known whether"
    for change, words, met in ((-3.0, unknown, "–"), (2.0, f"{above} allowed even without the wheel", "no")):
        sentence, table = told(power=louder + change)
        assert words in sentence
        assert "TSI Noise, EMU: rolling noise without the wheel has" in sentence
        assert table.rows[0][3].text == met
    sentence, table = told(wheel=110.0)
    assert "rolling noise alone has" in sentence
    assert "; the wheel decides." in sentence
    assert "rail " in table.rows[0][1].text
    answers = pass_by_answers(xarray.DataTree.from_dict({"/pass_by": by}))
    assert answers.more == limit_sentence(xarray.DataTree.from_dict({"/pass_by": by}))


def test_fast_trains_are_held_to_the_limit_at_the_additional_place_too():
    """Regulation (EU) No 1304/2014, point 4.2.3: from 250 km/h on also 3.5 m high, against the same limit."""
    ground = {"ground": "pasture", "directivity": "cnossos"}
    fast, there = (passed(300.0, receiver_height=height, **ground) for height in (1.2, 3.5))
    change = -50.0 * np.log10(300.0 / 250.0)
    expected = there["pass_by_equivalent_level"] + change
    assert_allclose(fast["normalised_level_above"], expected, atol=1e-9)
    assert abs(float((expected - fast["normalised_level"]).sel(radiator="total").item())) > 0.5
    for without in (there, passed(249.0), passed(300.0, vehicle="coach")):
        assert "normalised_level_above" not in without
    level = float(fast["normalised_level_above"].sel(radiator="total").item())
    sentence, table = told(300.0, power=100.0 + 97.0 - level, **ground)
    assert "At 3.5 m height it has 97.0 dB(A), 2.0 dB over the 95 dB(A) allowed even without" in sentence
    assert table.rows[1][0].text == "L_pAeq,Tp at 250 km/h, 3.5 m high"
    assert [row[3].text for row in table.rows[1:3]] == ["no", "yes"]


STATED = {"vehicle": "coach", "vehicle_length": "26 m", "axle_positions": ["0 m", "2.5 m"]}
AT = np.array([1.0, 0.4, 0.1, 0.01, 0.00315])  # m
TABLE = np.transpose(rail_roughness("iso3095"))
TABLE[np.argmin(np.abs(TABLE[:, 0] - 0.1)), 1] += 2.0


@pytest.mark.parametrize(
    ("surface", "here", "rail"),
    [
        ({"spectrum": "iso3095"}, "so in all 22 bands, by the spectrum", [17.1, 17.1, 4.9, -8.0, -11.0]),
        (
            {"spectrum": "iso3095", "level": "1 dB"},
            "above it in 22 bands, by up to 1.0 dB at",
            [18.1, 18.1, 5.9, -7.0, -10.0],
        ),
        (
            {"spectrum": TABLE},
            "above it in 1 band, by up to 2.0 dB at 100 mm",
            [17.1, 17.1, 6.9, -8.0, -11.0],
        ),
    ],
)
def test_a_spectrum_is_judged_as_what_it_states(surface, here, rail):
    """By name, with a level, or from a table, whatever one texture of it happens to have: EN ISO 3095."""
    case = WheelOnRail(surface=surface, noise=STATED, wheel={"section": "rigid"}, track={"name": "uic60"})
    stated = stated_levels(case, ["rail", "wheel", "combined"], AT)
    assert_allclose(stated[0], rail, atol=0.051)
    assert_allclose(stated[2], stated[0])  # the wheel is smooth
    assert np.isnan(stated[1]).all()
    wavelength, limit = rail_roughness("iso3095")
    told = stated_levels(case, ["rail", "wheel"], wavelength)
    one_texture = limit + np.where(np.arange(len(limit)) % 2, 1.7, -1.7)
    levels = np.stack([one_texture, np.full(len(limit), -20.0)])
    names = {"part": ["rail", "wheel"], "surface_band": wavelength}
    of = {"roughness_level": levels, "stated_roughness_level": told}
    held = xarray.Dataset({name: (("part", "surface_band"), each) for name, each in of.items()}, names)
    assert _of_roughness(held)[0]["here"].startswith(here)
    measured = _of_roughness(held.drop_vars("stated_roughness_level"))
    assert measured[0]["here"].startswith("above it in 11 bands, by up to 1.7 dB")


def test_a_self_affine_rail_is_judged_as_its_spectrum_and_not_as_one_texture():
    """Whatever the seed; a measured line beside samples of it is judged as it is."""
    rough = {"rms": "5 um", "longest": "0.1 m", "shortest": "4 mm"}
    case = WheelOnRail(surface=rough, wheel={"section": "rigid"})
    (told,), (other,) = (stated_levels(each, ["rail"], AT) for each in (case, case.with_(seed=7)))
    assert_allclose(told, other)
    assert told[2:4] == pytest.approx([4.34, -11.72], abs=0.01)  # as test_synthesis holds to drawn ones
    assert np.isnan(told[4])  # of 3.15 mm there is no wave
    line = Profile(1e-6 * np.sin(np.arange(50_000.0)), 1e-3)
    rolled = case.with_(surface=rough | {"line": line, "continuation": "repeat"}, duration="0.1 s")
    assert np.isnan(stated_levels(rolled, ["rail"], AT)).all()
    line = case.with_(surface=rough | {"spectrum": "iso3095"})  # samples alone are self-affine
    assert_allclose(stated_levels(line, ["rail"], AT)[0], [17.1, 17.1, 4.9, -8.0, -11.0], atol=0.051)


def test_what_was_measured_or_corrugated_is_judged_as_it_is():
    rough = {"spectrum": "iso3095", "corrugation": "20 um", "corrugation_wavelength": "0.1 m"}
    case = WheelOnRail(surface=rough, wheel={"roughness": "disc", "section": "rigid"})
    rail, combined = stated_levels(case, ["rail", "combined"], AT)
    assert np.isnan(rail).tolist() == [False, False, True, False, False]
    assert np.isnan(combined[2])
    assert combined[3] > rail[3]  # with the wheel's
    line = Profile(1e-6 * np.sin(np.arange(50_000.0)), 1e-3)
    case = WheelOnRail(surface={"line": line, "continuation": "repeat"}, duration="0.1 s")
    assert np.isnan(stated_levels(case, ["rail", "combined"], AT)).all()


def test_conditions_that_are_not_met_are_named():
    over = np.full(22, -1.0)
    over[[3, 9]] = 0.7, 2.1  # 200 mm and 50 mm
    rough = conditions(over=over)["rail roughness"]
    assert rough["here"] == "above it in 2 bands, by up to 2.1 dB at 50 mm"
    assert "in 22 of 22 bands" in rough["asked"]
    assert conditions(over=0.04)["rail roughness"]["met"]  # printed to a tenth
    slow = DECAY.copy()
    slow[BAND > 4000.0] = 0.5
    slow[(BAND > 380.0) & (BAND < 410.0)] = 4.5
    decay = conditions(decay=slow)["decay rate"]
    assert decay["here"].startswith("below it in 2 bands, by up to 1.5 dB/m at 400")
    one = np.where(BAND < 4000.0, np.nan, 3.0)  # measured in the last bands alone: these are no longer low
    assert (
        "below it in 1 band, by up to 1.5 dB/m at 400"
        in conditions(decay=slow, measured=one)["decay rate"]["here"]
    )
    sentence, table = told(over=over, decay=slow, receiver_distance=10.0)
    assert "no limit holds for this receiver and speed" in sentence
    assert sentence.endswith("Not as a test asks: receiver, rail roughness, decay rate.")
    assert [row[3].text for row in table.rows] == ["–", "no", "yes", "no", "no"]
    assert not conditions(speed=330.0)["speed"]["met"]
    assert "no limit holds" in told(250.0, vehicle="coach")[0]
    assert "95 dB(A) allowed" in told(250.0)[0]


def test_without_a_type_of_vehicle_nothing_is_said():
    by = passed(vehicle=None)
    assert not {"normalised_level", "vehicle"} & {*by, *by.attrs}
    tree = xarray.DataTree.from_dict({"/pass_by": by})
    assert (limit_sentence(tree), limits_table(tree)) == ("", None)
    for noise, count in (({}, 0), ({"ground": "grass"}, 1), (VEHICLE, 1), (VEHICLE | {"ground": "lawn"}, 2)):
        assert len(sources_of(WheelOnRail(surface={"spectrum": "iso3095"}, noise=noise))) == count


test_vehicles_that_cannot_be = refusals(
    ({"vehicle": "emu"}, "only together with vehicle_length"),
    ({"vehicle": "tram", "vehicle_length": "30 m"}, 'allowed: "electric-locomotive", "diesel-locomotive"'),
    of=lambda noise: WheelOnRail(surface={"spectrum": "iso3095"}, noise=noise),
    error=CaseError,
)
