"""How loud the train of a case is beside the track: from the sound power of a result to its levels."""

import numpy as np
import pytest
import xarray
from numpy.testing import assert_allclose

from asperity import WheelOnRail
from asperity.errors import CaseError
from asperity.radiation import pass_by, sound_path
from asperity.reporting.data import unless_missing
from asperity.scenes.figures.noise import pass_by_level, pass_by_table
from asperity.scenes.noise import pass_by_group
from asperity.schema import group
from refusals import refusals

BAND = 1000.0 * 10.0 ** (np.arange(-6, 7) / 10.0)
KILOHERTZ = 6  # where the A-weighting is zero


def case(**noise):
    return WheelOnRail(surface={"spectrum": "iso3095"}, noise=noise, speed=50.0)


def passed(rail=100.0, sleepers=90.0, wheel=np.nan, decay=1.0, **noise):
    """The pass-by of a sound power in the band of 1 kHz only, dB re 1 pW, by one law."""
    level, parts = np.full((4, len(BAND)), np.nan), np.array([rail, sleepers, wheel])
    level[:, KILOHERTZ] = *parts, summed(parts)
    names = {"law": ["areal"], "radiator": ["rail", "sleepers", "wheel", "total"], "band": BAND}
    power = (("law", "radiator", "band"), level[None])
    spectra = {"radiated_power_level": power, "band_decay_rate": ("band", np.full(len(BAND), decay))}
    return group(pass_by_group(case(**noise), xarray.Dataset(spectra, names)))


def heard(**keys):
    return passed(**keys).sel(law="areal")


def summed(levels):
    return 10.0 * np.log10(np.nansum(10.0 ** (np.asarray(levels) / 10.0)))


def sel(power, axles, source_height=0.0):
    """10 lg of W ρc Q/(4 d v) over (20 µPa)² s."""
    distance = np.hypot(7.5, 1.2 - source_height)
    return 10.0 * np.log10(axles * 1e-12 * 10 ** (power / 10) * 413.0 * 2.0 / (4 * distance * 50.0) / 4e-10)


@pytest.mark.parametrize("wheel", [95.0, np.nan])
def test_one_axle_has_a_maximum_and_an_exposure(wheel):
    """What is not known is missing, and not in the total."""
    found = heard(wheel=wheel)
    assert found.sizes["axle"] == 1
    assert not {"transit_exposure_level", "pass_by_equivalent_level", "front_time"} & {*found, *found.attrs}
    by, banded = found["sound_exposure_level_a"], found["sound_exposure_level"].sel(radiator="rail")
    assert "disc and tread" in by.attrs.get("missing", "disc and tread")
    assert ("missing" in by.attrs) == np.isnan(wheel)
    own = [sel(100.0, 1), sel(90.0, 1), sel(wheel, 1, 0.46)]
    assert_allclose(by, [*own, summed(own)], atol=1e-3)
    assert_allclose(banded, np.where(np.arange(len(BAND)) == KILOHERTZ, own[0], np.nan), atol=1e-3)


def test_axles_of_a_train_pass_when_they_do():
    found = heard(axle_positions=[0.0, 2.5, 19.0], vehicle_length=25.0, vehicles=2)
    assert_allclose(found["axle_time"], np.array([0.0, 2.5, 19.0, 25.0, 27.5, 44.0]) / 50.0)
    assert_allclose([found.attrs["front_time"], found.attrs["rear_time"]], [-3.0 / 50.0, 47.0 / 50.0])
    total = found.sel(radiator="total")
    assert_allclose(total["sound_exposure_level_a"], summed([sel(100.0, 6), sel(90.0, 6)]), atol=1e-3)
    # over Tp = 1 s the energy of TEL is nearly that of SEL, and L_pAeq,Tp holds less of it
    exposure = float(total["sound_exposure_level_a"])
    assert total["pass_by_equivalent_level"] < total["transit_exposure_level"] < exposure
    assert exposure < total["transit_exposure_level"] + 0.5


def test_the_receiver_stands_where_the_case_says():
    near, far = heard(), heard(receiver_distance="15 m", receiver_height="0 m")
    assert (far.attrs["receiver_distance"], far.attrs["receiver_height"]) == (15.0, 0.0)
    closer = 10.0 * np.log10(15.0 / np.hypot(7.5, 1.2))  # exposure falls as 1/d
    change = near["sound_exposure_level_a"] - far["sound_exposure_level_a"]
    assert_allclose(change.sel(radiator="rail"), closer, atol=1e-6)


def test_ground_directivity_and_rails_are_those_of_the_case():
    """The plain path is bit for bit that without any key; the others say what they are."""
    plain, named = heard(wheel=95.0), heard(wheel=95.0, ground="hard", directivity="even")
    assert plain.equals(named)
    assert plain.attrs == named.attrs
    grass, same = heard(ground="grass"), heard(flow_resistivity="80 kPa s/m^2")
    assert (grass.attrs["ground"], same.attrs["ground"]) == ("grass", "ground of 80 kPa s/m^2")
    assert_allclose(grass["pass_by_level"], same["pass_by_level"])
    for depth, found in ((0.5, grass), (2.0, heard(ground="grass", ground_depth="2 m"))):
        path = sound_path.SoundPath(
            np.array([1000.0]), pass_by.Receiver(), sound_path.PorousGround(80e3), depth
        )
        expected = 10.0 * np.log10(path.integral(0.0)[0] * np.hypot(7.5, 1.2) / np.pi)
        change = found["sound_exposure_level_a"] - heard()["sound_exposure_level_a"]
        assert_allclose(change.sel(radiator="rail"), expected, atol=1e-6)
    across = heard(directivity="cnossos", decay=30.0)  # opposite 10 lg(1/0.505) and what goes sideways
    louder = (across["pass_by_maximum_level"] - heard(decay=30.0)["pass_by_maximum_level"]).sel(
        radiator="rail"
    )
    assert 2.0 < float(louder) < 4.0
    apart = heard(rail_distance="1.5 m")
    more = (apart["sound_exposure_level_a"] - heard()["sound_exposure_level_a"]).sel(radiator="rail")
    line = np.mean([1.0 / np.hypot(7.5 + side, 1.2) for side in (-0.75, 0.75)]) * np.hypot(7.5, 1.2)
    assert_allclose(more, 10.0 * np.log10(line), atol=1e-4)


def test_what_is_said_of_ground_and_directivity():
    by = passed(ground="asphalt", directivity="cnossos")
    said = pass_by_level.drawn(xarray.DataTree.from_dict({"/pass_by": by})).caption
    assert "ground: asphalt" in said
    assert "directivity: cnossos" in said
    plain = pass_by_level.drawn(xarray.DataTree.from_dict({"/pass_by": passed()})).caption
    assert "ground: hard" in plain
    assert "directivity: even" in plain


test_trains_that_cannot_be = refusals(
    ({"ground": "ballast"}, 'ground: .*allowed: "hard", "grass", "pasture"'),
    ({"ground": "grass", "flow_resistivity": "1 MPa s/m^2"}, "both ground and flow_resistivity"),
    ({"flow_resistivity": "10 Pa s/m^2"}, "allowed: 1 kPa s/m.2 to 1 GPa s/m.2"),
    ({"flow_resistivity": "200 kPa"}, 'with its unit, as "200 kPa s/m.2"'),
    ({"ground_depth": "1 m"}, "only together with ground or flow_resistivity"),
    ({"directivity": "dipole"}, 'allowed: "even", "cnossos"'),
    ({"receiver_distance": "0.5 m"}, "receiver_distance: .*1 m to 1 km"),
    ({"rail_distance": "3 m"}, "rail_distance: .*0.1 m to 1.9 m"),
    ({"axle_positions": ["1 m", "3 m"]}, "received 1 m first; allowed: positions that rise from 0 m"),
    ({"axle_positions": ["0 m", "3 m", "3 m"]}, "allowed: a list that rises"),
    ({"axle_positions": []}, "received an empty list"),
    ({"axle_positions": ["0 m"], "wheelbase": "2 m"}, "both axle_positions and wheelbase"),
    ({"wheelbase": "2.5 m", "vehicle_length": "2 m"}, "allowed: more than that over its axles, 2.5 m"),
    ({"vehicles": 2}, "vehicle_length"),
    ({"vehicles": 0, "vehicle_length": "20 m"}, "vehicles"),
    of=lambda noise: case(**noise),
    error=CaseError,
)


def test_figure_and_table_say_what_passes():
    by = passed(wheelbase=2.5)
    assert_allclose(by["axle_time"], [0.0, 0.05])
    assert_allclose(by.attrs["rear_time"] - by.attrs["front_time"], 5.0 / 50.0)
    tree = xarray.DataTree.from_dict({"/pass_by": by})
    assert "2 axles pass (ticks), two wheels on each, 7.5 m" in pass_by_level.drawn(tree).caption
    table = pass_by_table(tree)
    assert [row[1].text for row in table.rows] == ["total", "rail", "sleepers"]
    assert table.head[2:] == ["L_pAFmax / dB(A)", "L_pAeq,Tp / dB(A)", "TEL / dB(A)", "SEL / dB(A)"]
    assert len(pass_by_level.drawn(tree).columns) == 4  # time, rail, sleepers, total
    assert unless_missing(pass_by_table, xarray.DataTree.from_dict({"/pass_by": xarray.Dataset()})) is None
