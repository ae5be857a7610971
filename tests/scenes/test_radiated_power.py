"""Sound power of runs, from the vibration and by CNOSSOS-EU, and how loud the train of a case passes."""

import json

import numpy as np
import pytest
import xarray
from numpy.testing import assert_allclose

from asperity import WheelOnRail
from asperity.errors import CaseError, Grade, OutOfRangeWarning
from asperity.radiation import pass_by, sound_path
from asperity.radiation.track import SleeperTop
from asperity.reference import cnossos
from asperity.reporting.chart import Line
from asperity.reporting.data import unless_missing
from asperity.running import prepare_case
from asperity.scenes import cnossos_power
from asperity.scenes.beside_track import pass_by_group
from asperity.scenes.cnossos_power import rolling_sound_power
from asperity.scenes.figures import noise as figures
from asperity.scenes.noise import RADIATORS, rail_section, silent_wheel
from asperity.scenes.track import planned_track
from asperity.schema import group
from asperity.spectra import HALF_BAND, a_weighted_total, band_energies
from refusals import refusals
from small_cases import HEARD

OF_WHEEL = cnossos.wheel_roughness("disc")
OF_TRACK = cnossos.track_transfer("medium")
TRANSFER = cnossos.wheel_transfer("920 mm")


def test_bands_without_roughness_are_unknown_and_left_out():
    # the wheel's table begins at 1 m: at 100 m/s nothing is known below 100 Hz
    centres, levels = rolling_sound_power(100.0, None, OF_WHEEL, OF_TRACK, TRANSFER)
    assert np.isnan(levels[:, centres < 90.0]).all()
    assert np.isfinite(levels[:, centres > 90.0]).all()
    assert np.isfinite(a_weighted_total(levels, centres)).all()


def labelled(track=None, wheel=None, **keys):
    sections = {"track": track or {}, "wheel": wheel or {}}
    return WheelOnRail(surface={"spectrum": "iso3095"}, **sections, **keys)


def test_pads_have_the_class_of_the_directive_and_wheels_the_nearest_diameter():
    """Table [2.3.b]: 150 to 250, 250 to 800, 800 to 1000 MN/m."""
    pads = {80e6: "soft", 200e6: "soft", 250e6: "medium", 799e6: "medium", 900e6: "hard", 2e9: "hard"}
    for stiffness, name in pads.items():
        assert cnossos_power.track_label(labelled(track={"pad_stiffness": stiffness})) == name
    for diameter, name in {0.6: "680 mm", 0.8: "840 mm", 0.9: "920 mm", 1.25: "1200 mm"}.items():
        assert cnossos_power.wheel_label(labelled(wheel={"radius": diameter / 2})) == name


@pytest.mark.parametrize(
    ("sections", "told"),
    [
        ({}, None),
        (
            {"track": {"pad_stiffness": 100e6}},
            "dynamic stiffness of the rail pads, MN/m, for CNOSSOS-EU: 100, in range 150 to 250. "
            "CNOSSOS-EU's sound power is that of another one. Take the sound power from the vibra",
        ),
        ({"track": {"pad_stiffness": 1200e6}}, "in range 800 to 1000."),
        ({"track": {"sleeper_mass": 40.0}}, "half a sleeper, kg, for CNOSSOS-EU: 40, in range 110 to 210"),
        ({"track": {"sleeper_mass": 400.0}}, "for CNOSSOS-EU: 400, in range 110 to 210"),
        (
            {"wheel": {"radius": 0.25}},
            "diameter of the wheel, mm, for CNOSSOS-EU: 500, in range 591.3 to 782",
        ),
    ],
)
def test_a_label_that_does_not_fit_is_told_with_what_to_do(sections, told):
    found = cnossos_power.findings_of_labels(labelled(**sections))
    assert [finding.grade for finding in found] == [Grade.WARNING] * (told is not None)
    assert all(told in finding.message for finding in found)


def test_a_check_says_whose_sound_power_is_computed():
    found = dict(planned_track(prepare_case(labelled())))
    assert found["sound power"] == (
        "of rail, sleepers and wheel; by CNOSSOS-EU for soft pads and a wheel of 920 mm"
    )
    rigid = dict(planned_track(prepare_case(labelled(wheel={"section": "rigid"}))))["sound power"]
    assert rigid.startswith("of rail and sleepers: of this wheel it is not known how")
    hard = {"pad_stiffness": 1200e6}
    for laws in (["linear"], ["hertz"]):  # it is told whatever laws are rolled
        with pytest.warns(OutOfRangeWarning, match="in range 800 to 1000"):
            told = dict(planned_track(prepare_case(labelled(track=hard, laws=laws))))
        assert "by CNOSSOS-EU for hard pads" in told["sound power"]


CASE = HEARD | {"duration": "0.15 s"}
MODES = np.array(
    [  # frequency, damping ratio, modal mass, nodal diameters, axial, radial
        [430.0, 1e-2, 3000.0, 2, 3.0, 0.5],
        [1950.0, 3e-4, 330.0, 2, 0.8, 0.7],
        [2550.0, 3e-4, 280.0, 3, 0.9, 0.7],
        [3300.0, 3e-4, 260.0, 4, 1.0, 0.7],
    ]
)


@pytest.fixture
def run(runs):
    """A rigid wheel, on pads that are not those of the label."""
    case = WheelOnRail(**CASE | {"track": {"name": "uic60", "pad_stiffness": 130e6}})
    return case, runs(case)


@pytest.fixture
def ringing(runs):
    return runs(WheelOnRail(**CASE | {"wheel": {"roughness": "disc", "modes": MODES}}))


def test_cnossos_is_told_whatever_laws_are_rolled(runs):
    """It was told only where `linear` was among them: the bare law is rolled for it where nobody names it."""
    alone, beside = (runs(WheelOnRail(**HEARD | {"laws": ["hertz", *more]})) for more in ([], ["linear"]))
    assert list(alone["rolling"]["law"].values) == ["hertz"]
    for name in ("sound_power_level", "sound_power_level_a", "cnossos_sound_power_level_a"):
        told, known = (tree["spectra"][name] for tree in (alone, beside))
        if "law" in known.dims:
            told, known = (each.sel(law="hertz", drop=True) for each in (told, known))
        np.testing.assert_array_equal(told, known)
        assert told.attrs == known.attrs


def levels(tree, name="radiated_power_level"):
    found = tree["spectra"][name][0]
    return dict(zip(found["radiator"].values.tolist(), found.values, strict=True))


def spread(track, lines):
    """Mean square of the linear force over a bay, of a rigid wheel of 600 kg."""
    receptance = -1.0 / (600.0 * (2.0 * np.pi * lines) ** 2) + 1.0 / 1.25e9
    return lambda places: np.array(
        [1.0 / np.abs(receptance + track.receptance(lines, x, x)) ** 2 for x in places]
    )


def test_the_power_is_that_of_the_force_on_two_rails(run):
    case, tree = run
    spectra, track = tree["spectra"], case.track.model()
    frequency, band = spectra["frequency"].values, spectra["band"].values
    for name, part in (("rail", rail_section(case, track)), ("sleepers", SleeperTop(2.6, 0.25))):
        density = part.power_per_force(track, frequency, spread(track, frequency))
        density *= spectra["force_psd"].values[0]
        power = 2.0 * band_energies(frequency, density, band / HALF_BAND, band * HALF_BAND)
        inside = band < 3500.0  # the lines end in the last band
        np.testing.assert_allclose(
            levels(tree)[name][inside], 10.0 * np.log10(power / 1e-12)[inside], atol=0.05
        )


def test_what_a_result_says_of_a_rigid_wheel_and_of_its_labels(run):
    _, tree = run
    found = levels(tree)
    assert np.isnan(found["wheel"]).all()
    assert_summed(found, ("rail", "sleepers"))
    why = tree["spectra"]["radiated_power_level"].attrs
    assert why["wheel"] == why["missing"] == "of this wheel it is not known how its disc and tread vibrate"
    told = json.loads(tree.attrs["warnings"])
    label, silent = (w for w in told if w["category"] == "MissingSourceWarning" or "CNOSSOS" in w["message"])
    assert silent["grade"] == "note"
    assert "that of rail and sleepers alone: of this wheel it is not" in silent["message"]
    assert "MN/m, for CNOSSOS-EU: 130, in range 150 to 250" in label["message"]


def assert_summed(found, names):
    power = sum(10.0 ** (found[name] / 10.0) for name in names)
    np.testing.assert_allclose(found["total"], 10.0 * np.log10(power), rtol=1e-12)


@pytest.mark.parametrize(
    ("wheel", "silent"),
    [
        ({}, False),  # the default wheel is drawn
        ({"modes": MODES[:, :3]}, True),
        ({"modes": MODES}, False),
        ({"receptance": np.array([[100.0 * n, -1e-9, -1e-11] for n in range(1, 30)])}, True),
    ],
)
def test_which_wheel_is_silent(wheel, silent):
    assert bool(silent_wheel(WheelOnRail(surface={"spectrum": "iso3095"}, wheel=wheel))) == silent


def test_a_wheel_that_rings_is_louder_than_the_rail_at_high_frequency(ringing):
    found, band = levels(ringing), ringing["spectra"]["band"].values
    assert ringing["spectra"]["radiated_power_level"].attrs["wheel"] == "computed"
    assert "MissingSourceWarning" not in ringing.attrs["warnings"]
    assert (found["wheel"] > found["rail"])[(band > 2200.0) & (band < 3500.0)].all()
    assert (found["wheel"] < found["rail"] - 6.0)[(band > 600.0) & (band < 1300.0)].all()
    assert_summed(found, RADIATORS[:3])


def test_a_flat_on_a_smooth_rail_without_a_linear_law_has_a_sound_power(runs):
    flat = {"surface": {"smooth": True}, "wheel": {"flat_depth": "0.2 mm"}, "duration": "0.1 s"}
    tree = runs(WheelOnRail(**CASE | flat | {"laws": ["hertz"]}))
    assert "sound_power_level" not in tree["spectra"]
    assert levels(tree, "radiated_power_level_a")["total"] > 90.0


def test_the_report_shows_it_beside_cnossos(run, ringing):
    _, tree = run
    lines, spectra = figures.radiated_power_bands.collect(tree), tree["spectra"]
    found = lines.columns()["track by CNOSSOS-EU, linear [dB re 1 pW]"]
    known = np.isfinite(found)
    np.testing.assert_allclose(found[known], spectra["sound_power_level"].values[0, 0])
    assert lines.at[known] == pytest.approx(spectra["noise_band"].values)
    labels, own = (
        [mark.label for mark in chart.panels[0].marks if isinstance(mark, Line)]
        for chart in (figures.radiated_power_bands.drawn(found).chart for found in (tree, ringing))
    )
    assert labels[:3] == ["rail", "sleepers", "total"]
    assert "wheel" in own
    table, level = figures.sound_power_table(tree), levels(tree, "radiated_power_level_a")
    rail, sleepers, total = (f"{level[name]:.1f}" for name in ("rail", "sleepers", "total"))
    known = {"rail": rail, "sleepers": sleepers, "rail and sleepers": total, "wheel": "–", "total": total}
    assert dict(zip(table.head, (cell.text for cell in table.rows[0]), strict=True)).items() >= known.items()
    missing = "The wheel's part is missing, and the total is that of rail and sleepers: of this wheel it"
    assert missing in table.note
    assert "missing" not in figures.sound_power_table(ringing).note
    answers = figures.noise_answers(tree)
    assert answers.numbers[0].value == f"{total} dB(A)"
    assert "without the wheel" in answers.numbers[0].note
    assert answers.lead.startswith(f"By vibration the rail decides: {rail} of {total} dB(A)")
    first = {
        head: row.text for head, row in zip(answers.tables[0].head, answers.tables[0].rows[0], strict=True)
    }
    assert first == {"law": "linear", "model": "by vibration"} | known


PASSED = 1000.0 * 10.0 ** (np.arange(-6, 7) / 10.0)
KILOHERTZ = 6  # where the A-weighting is zero


BOGIE = {"type": "bogie", "masses": ["4 t"], "springs": ["1.2 MN/m"], "distance": "2.5 m"}
BOGIE |= {"inertia": "1500 kg m^2"}


def passing(wheel=None, **noise):
    return WheelOnRail(surface={"spectrum": "iso3095"}, wheel=wheel or {}, noise=noise, speed=50.0)


def passed(rail=100.0, sleepers=90.0, wheel=np.nan, decay=1.0, rolling=None, **noise):
    """The pass-by of a sound power in the band of 1 kHz only, dB re 1 pW, by one law."""
    level, parts = np.full((4, len(PASSED)), np.nan), np.array([rail, sleepers, wheel])
    level[:, KILOHERTZ] = *parts, summed(parts)
    names = {"law": ["areal"], "radiator": ["rail", "sleepers", "wheel", "total"], "band": PASSED}
    power = (("law", "radiator", "band"), level[None])
    spectra = {"radiated_power_level": power, "band_decay_rate": ("band", np.full(len(PASSED), decay))}
    return group(pass_by_group(passing(rolling, **noise), xarray.Dataset(spectra, names)))


def heard(**keys):
    return passed(**keys).sel(law="areal")


def summed(levels):
    return 10.0 * np.log10(np.nansum(10.0 ** (np.asarray(levels) / 10.0)))


def sel(power, axles, source_height=0.0):
    """10 lg of W ρc Q/(4 d v) over (20 µPa)² s."""
    distance = np.hypot(7.5, 1.2 - source_height)
    return 10.0 * np.log10(axles * 1e-12 * 10 ** (power / 10) * 413.0 * 2.0 / (4 * distance * 50.0) / 4e-10)


def test_power_of_all_axles_of_a_bogie_is_that_of_one_axle_each():
    """Two that make 3.01 dB more together pass as two of which one was rolled."""
    twice = summed([0.0, 0.0])
    one = heard(wheel=95.0, axle_positions=["0 m", "2.5 m"])
    both = heard(rail=100.0 + twice, sleepers=90.0 + twice, wheel=95.0 + twice, rolling=BOGIE)
    assert both["sound_exposure_level_a"].values == pytest.approx(one["sound_exposure_level_a"].values)


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
    assert_allclose(banded, np.where(np.arange(len(PASSED)) == KILOHERTZ, own[0], np.nan), atol=1e-3)


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
    for depth, found in ((0.5, grass), (0.1, heard(ground="grass", ground_depth="0.1 m"))):
        path = sound_path.SoundPath(
            np.array([1000.0]), pass_by.Receiver(), sound_path.PorousGround(80e3), depth
        )
        heights = -0.09, -min(0.18, depth)  # of the middle of the rail and the sleepers' tops
        expected = [10.0 * np.log10(path.integral(h)[0] * np.hypot(7.5, 1.2) / np.pi) for h in heights]
        change = found["sound_exposure_level_a"] - heard()["sound_exposure_level_a"]
        assert_allclose(change.sel(radiator=["rail", "sleepers"]), expected, atol=1e-6)
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
    said = figures.pass_by_level.drawn(xarray.DataTree.from_dict({"/pass_by": by})).caption
    assert "ground: asphalt" in said
    assert "directivity: cnossos" in said
    plain = figures.pass_by_level.drawn(xarray.DataTree.from_dict({"/pass_by": passed()})).caption
    assert "ground: hard" in plain
    assert "directivity: even" in plain


test_trains_that_cannot_be = refusals(
    ({"ground": "ballast"}, 'ground: .*allowed: "hard", "grass", "pasture"'),
    ({"ground": "grass", "flow_resistivity": "1 MPa s/m^2"}, "both ground and flow_resistivity"),
    ({"flow_resistivity": "10 Pa s/m^2"}, "allowed: 1 kPa s/m.2 to 1 GPa s/m.2"),
    ({"flow_resistivity": "200 kPa"}, 'with its unit, as "200 kPa s/m.2"'),
    ({"ground_depth": "1 m"}, "only together with ground or flow_resistivity"),
    ({"ground": "grass", "sleeper_depth": "0.6 m"}, "sleeper_depth: .*0.1 m to 0.5 m"),
    ({"directivity": "monopole"}, 'allowed: "even", "cnossos", "dipole"'),
    ({"far_rail_screening": "10 dB"}, "only together with rail_distance"),
    ({"rail_distance": "1.5 m", "far_rail_screening": "-1 dB"}, "far_rail_screening: .*0 dB to 40 dB"),
    ({"receiver_offset": "60 dB"}, "receiver_offset: .*-40 dB to 40 dB"),
    ({"receiver_distance": "0.5 m"}, "receiver_distance: .*1 m to 1 km"),
    ({"rail_distance": "3 m"}, "rail_distance: .*0.1 m to 1.9 m"),
    ({"axle_positions": ["1 m", "3 m"]}, "received 1 m first; allowed: positions that rise from 0 m"),
    ({"axle_positions": ["0 m", "3 m", "3 m"]}, "allowed: a list that rises"),
    ({"axle_positions": []}, "received an empty list"),
    ({"axle_positions": ["0 m"], "wheelbase": "2 m"}, "both axle_positions and wheelbase"),
    ({"wheelbase": "2.5 m", "vehicle_length": "2 m"}, "allowed: more than that over its axles, 2.5 m"),
    ({"vehicles": 2}, "vehicle_length"),
    ({"vehicles": 0, "vehicle_length": "20 m"}, "vehicles"),
    of=lambda noise: passing(**noise),
    error=CaseError,
)


def test_figure_and_table_say_what_passes():
    by = passed(wheelbase=2.5)
    assert_allclose(by["axle_time"], [0.0, 0.05])
    assert_allclose(by.attrs["rear_time"] - by.attrs["front_time"], 5.0 / 50.0)
    tree = xarray.DataTree.from_dict({"/pass_by": by})
    assert "2 axles pass (ticks), two wheels on each, 7.5 m" in figures.pass_by_level.drawn(tree).caption
    table = figures.pass_by_table(tree)
    assert [row[1].text for row in table.rows] == ["total", "rail", "sleepers"]
    assert table.head[2:] == ["L_pAFmax / dB(A)", "L_pAeq,Tp / dB(A)", "TEL / dB(A)", "SEL / dB(A)"]
    assert len(figures.pass_by_level.drawn(tree).columns) == 4  # time, rail, sleepers, total
    assert (
        unless_missing(figures.pass_by_table, xarray.DataTree.from_dict({"/pass_by": xarray.Dataset()}))
        is None
    )
