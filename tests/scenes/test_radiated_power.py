"""Sound power of runs: from the vibration itself, and by CNOSSOS-EU with its labels."""

import json

import numpy as np
import pytest

from asperity import WheelOnRail
from asperity.errors import Grade, OutOfRangeWarning
from asperity.radiation.track import SleeperTop
from asperity.reference import cnossos
from asperity.reporting.chart import Line
from asperity.running import prepare_case
from asperity.scenes import noise
from asperity.scenes.figures.noise import noise_answers, radiated_power_bands, sound_power_table
from asperity.scenes.noise import RADIATORS, rail_section, rolling_sound_power, silent_wheel
from asperity.scenes.track import planned_track
from asperity.spectra import HALF_BAND, a_weighted_total, band_energies
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
        assert noise.track_label(labelled(track={"pad_stiffness": stiffness})) == name
    for diameter, name in {0.6: "680 mm", 0.8: "840 mm", 0.9: "920 mm", 1.25: "1200 mm"}.items():
        assert noise.wheel_label(labelled(wheel={"radius": diameter / 2})) == name


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
    found = noise.findings_of_labels(labelled(**sections))
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
    with pytest.warns(OutOfRangeWarning, match="in range 800 to 1000"):
        planned_track(prepare_case(labelled(track=hard)))
    without = prepare_case(labelled(track=hard, laws=["hertz"]))
    assert "CNOSSOS" not in dict(planned_track(without))["sound power"]


CASE = HEARD | {"duration": "0.6 s"}
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


def levels(tree, name="radiated_power_level"):
    return dict(zip(RADIATORS, tree["spectra"][name].values[0], strict=True))


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
    lines, spectra = radiated_power_bands.collect(tree), tree["spectra"]
    found = lines.columns()["track by CNOSSOS-EU, linear [dB re 1 pW]"]
    known = np.isfinite(found)
    np.testing.assert_allclose(found[known], spectra["sound_power_level"].values[0, 0])
    assert lines.at[known] == pytest.approx(spectra["noise_band"].values)
    labels, own = (
        [mark.label for mark in chart.panels[0].marks if isinstance(mark, Line)]
        for chart in (radiated_power_bands.drawn(found).chart for found in (tree, ringing))
    )
    assert labels[:3] == ["rail", "sleepers", "total"]
    assert "wheel" in own
    table, level = sound_power_table(tree), levels(tree, "radiated_power_level_a")
    rail, sleepers, total = (f"{level[name]:.1f}" for name in ("rail", "sleepers", "total"))
    known = {"rail": rail, "sleepers": sleepers, "rail and sleepers": total, "wheel": "–", "total": total}
    assert dict(zip(table.head, (cell.text for cell in table.rows[0]), strict=True)).items() >= known.items()
    missing = "The wheel's part is missing, and the total is that of rail and sleepers: of this wheel it"
    assert missing in table.note
    assert "missing" not in sound_power_table(ringing).note
    answers = noise_answers(tree)
    assert answers.numbers[0].value == f"{total} dB(A)"
    assert "without the wheel" in answers.numbers[0].note
    assert answers.lead.startswith(f"By vibration the rail decides: {rail} of {total} dB(A)")
    first = {
        head: row.text for head, row in zip(answers.tables[0].head, answers.tables[0].rows[0], strict=True)
    }
    assert first == {"law": "linear", "model": "by vibration"} | known
