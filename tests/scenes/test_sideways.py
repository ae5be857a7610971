"""What moves sideways in a run: nothing in the middle; off it by the formulas, at every place of a bay."""

import math

import numpy as np
import pytest

from asperity.case.wheel_on_rail import WheelOnRail
from asperity.contact.tangential import stick_stiffness
from asperity.reference.materials import MATERIALS
from asperity.scenes.figures.sideways import SIDEWAYS, sideways_table
from asperity.spectra import HALF_BAND, band_energies
from asperity.structures.lateral_rail import LateralTrack

CASE = {
    "laws": ["linear"],
    "duration": "0.3 s",
    "settling": "0.1 s",
    "surface": {"spectrum": "iso3095"},
    "wheel": {"roughness": "disc"},
    "track": {"name": "uic60"},
    "contact": {"spacing": "1 mm"},
    "numerics": {"highest_frequency": "4 kHz", "kernel": "scatter"},
}
PLACE = 0.01


@pytest.fixture
def off(runs):
    return runs(WheelOnRail(**CASE | {"sideways": {"contact_place": PLACE}}))


def rms_levels(frequency, density, band):
    return 10.0 * np.log10(band_energies(frequency, density, band / HALF_BAND, band * HALF_BAND))


def test_nothing_moves_sideways_under_a_rigid_wheel_in_the_middle(runs):
    tree = runs(WheelOnRail(**CASE))
    assert "sideways" not in tree.children
    assert sideways_table(tree) is None


def test_the_lateral_force_is_that_of_compatibility_at_every_place(off):
    """T/F = −α_lv/(α_ll + 1/k_T), squared and averaged over the bay as the vertical force is spread."""
    case = WheelOnRail(**CASE)
    track, vertical = LateralTrack(case.track_model()), case.track_model()
    frequency, force = (off["spectra"][name].values for name in ("frequency", "force_psd"))
    hertz = case.smooth_contact
    axes = hertz.semi_axes(hertz.approach(65e3))
    softness = 1.0 / stick_stiffness(axes, (MATERIALS["steel"],) * 2)
    wheel = -1.0 / (600.0 * (2.0 * np.pi * frequency) ** 2)
    squares, weights = [], []
    for x in (np.arange(30) + 0.5) * 0.6 / 30:
        rail = track.at_contact(frequency, x, x, PLACE)
        squares.append(np.abs(rail[1, 0] / (rail[1, 1] + wheel + softness)) ** 2)
        normal = 1.0 / hertz.tangent_stiffness(hertz.approach(65e3))
        weights.append(np.abs(wheel + normal + vertical.receptance(frequency, x, x)) ** -2)
    share = np.average(squares, axis=0, weights=weights)
    band = off["sideways"]["band"].values
    inside = (band > 100.0) & (band < 3500.0)
    expected = rms_levels(frequency, share * force[0], band)[inside]
    found = off["sideways"]["lateral_force_level"].values[0][inside]
    np.testing.assert_allclose(found, expected, atol=0.15)


def test_slip_is_told_of_a_normal_distribution(off):
    side, spectra = off["sideways"], off["spectra"]
    density, frequency = spectra["lateral_force_psd"].values[0], spectra["frequency"].values
    rms = float(side["lateral_force_rms"][0])
    assert rms == pytest.approx(math.sqrt(density.sum() * (frequency[1] - frequency[0])), rel=1e-3)
    assert side.attrs["slip_force"] == pytest.approx(0.3 * 65e3)
    expected = math.erfc(0.3 * 65e3 / math.sqrt(2.0) / rms)
    assert float(side["slip_share"][0]) == pytest.approx(expected, abs=1e-12)


def test_the_farther_off_the_louder_and_less_friction_slips(runs, off):
    """Force and amplitude grow with the place; the other way it is as loud."""
    way = {"contact_place": -2.0 * PLACE, "friction": 0.001}
    other = runs(WheelOnRail(**CASE | {"sideways": way}))["sideways"]
    change = other["lateral_force_level"].values[0] - off["sideways"]["lateral_force_level"].values[0]
    np.testing.assert_allclose(change, 20.0 * math.log10(2.0), atol=1e-6)
    louder = (
        other["lateral_power_level_a"].values[0, 0] - off["sideways"]["lateral_power_level_a"].values[0, 0]
    )
    assert louder == pytest.approx(20.0 * math.log10(2.0), abs=1e-6)
    assert float(other["slip_share"][0]) > 0.5
    assert other.attrs["contact_place"] == -0.02


def test_softer_pads_let_waves_run_farther_and_the_rail_sound_louder_sideways(runs, off):
    """As vertically: N. Vincent et al., J. Sound Vib. 193 (1996) 161."""
    way = {"contact_place": PLACE, "pad_stiffness": 20e6, "pad_roll_stiffness": 1.2e5}
    softer = runs(WheelOnRail(**CASE | {"sideways": way}))["sideways"]
    rate = [each["lateral_decay_rate"].values for each in (softer, off["sideways"])]
    assert np.all(rate[0] < 0.95 * rate[1])
    louder = softer["lateral_power_level_a"] - off["sideways"]["lateral_power_level_a"]
    assert float(louder.sel(radiator="rail sideways")[0]) > 1.0


def ringing(runs, place, **wheel):
    wheel = {"roughness": "disc", "section": "straight-web"} | wheel
    return runs(WheelOnRail(**CASE | {"wheel": wheel, "sideways": {"contact_place": place}}))


def test_off_the_middle_axial_modes_of_the_wheel_ring(runs):
    """Of a wheel with a plane web, whose axial modes a vertical force in the middle leaves alone."""
    middle, off = (ringing(runs, place)["sideways"] for place in (0.0, PLACE))
    change = (off["lateral_power_level"] - middle["lateral_power_level"]).values[0]
    band = middle["band"].values
    for name in (1, 2):  # under the vertical force, and under both
        assert np.max(change[name, (band > 200.0) & (band < 1300.0)]) > 6.0
    assert np.all((off["lateral_force_level"] - middle["lateral_force_level"]).values[0, 2:12] > 10.0)


def test_the_wheel_under_its_vertical_force_is_that_of_the_run(runs):
    """By modes of unit mass, and by the table of modes that a run in time takes."""
    tree = ringing(runs, PLACE)
    own = tree["sideways"]["lateral_power_level"].sel(radiator="wheel, vertical force").values
    known = tree["spectra"]["radiated_power_level"].sel(radiator="wheel").values
    np.testing.assert_allclose(own, known, atol=1e-6)


def test_the_chapter_says_where_how_loud_and_whether_it_slips(runs, off):
    for tree in (off, ringing(runs, PLACE)):
        for figure in SIDEWAYS:
            assert figure.drawable(tree)
            assert figure.laid_out(tree).panels
        said = SIDEWAYS[0].said(tree)
        assert "10 mm off the middle" in said
        assert "(Mindlin)" in said
        table = sideways_table(tree)
        row = dict(zip(table.head, (cell.text for cell in table.rows[0]), strict=True))
        assert row["law"] == "linear"
        assert row["beyond friction"] == "0.0 %"
        rail = [float(row[head]) for head in ("rail up and down", "rail sideways", "rail, both")]
        assert rail[2] == pytest.approx(10.0 * np.log10(np.sum(10.0 ** (0.1 * np.array(rail[:2])))), abs=0.1)
    assert float(row["wheel, both forces"]) > 100.0
