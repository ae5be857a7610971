"""Sound power of runs from the vibration itself."""

import json
import warnings

import numpy as np
import pytest

import asperity
from asperity.case.wheel_on_rail import WheelOnRail
from asperity.errors import MissingSourceWarning, PhysicsWarning
from asperity.radiation.track import SleeperTop, squared_point_mobility
from asperity.reporting.chart import Line
from asperity.scenes.figures.noise import RADIATED, noise_answers, radiated_table
from asperity.scenes.noise import RADIATORS, rail_section, silent_wheel
from asperity.spectra import HALF_BAND, band_energies, psd

CASE = {
    "laws": ["linear"],
    "duration": "0.6 s",
    "settling": "0.1 s",
    "surface": {"spectrum": "iso3095"},
    "wheel": {"roughness": "disc"},
    "track": {"name": "uic60"},
    "contact": {"spacing": "1 mm"},
    "numerics": {"highest_frequency": "4 kHz", "poles": 60},
}
MODES = np.array(
    [  # frequency, damping ratio, modal mass, nodal diameters, axial, radial
        [430.0, 1e-2, 3000.0, 2, 3.0, 0.5],
        [1950.0, 3e-4, 330.0, 2, 0.8, 0.7],
        [2550.0, 3e-4, 280.0, 3, 0.9, 0.7],
        [3300.0, 3e-4, 260.0, 4, 1.0, 0.7],
    ]
)


def rolled(**sections):
    """Roll the case with some keys changed, or of a section."""
    told = dict(CASE)
    for name, keys in sections.items():
        told[name] = CASE.get(name, {}) | keys if isinstance(keys, dict) else keys
    case = WheelOnRail(**told)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PhysicsWarning)
        return case, asperity.run(case)


@pytest.fixture(scope="module")
def run():
    return rolled()


@pytest.fixture(scope="module")
def stiff():
    return rolled(track={"pad_stiffness": 1200e6, "pad_loss_factor": 0.25})


@pytest.fixture(scope="module")
def labelled():
    return rolled(track={"pad_stiffness": 300e6}, noise={"track_pad": "hard", "axles": 4})


@pytest.fixture(scope="module")
def ringing():
    return rolled(wheel={"modes": MODES})


def levels(tree, name="radiated_power_level"):
    return dict(zip(RADIATORS, tree["spectra"][name].values[0], strict=True))


def spread(track, lines):
    """Mean square of the linear force over a bay, of a rigid wheel of 600 kg."""
    receptance = -1.0 / (600.0 * (2.0 * np.pi * lines) ** 2) + 1.0 / 1.25e9
    return lambda places: np.array(
        [1.0 / np.abs(receptance + track.receptance(lines, x, x)) ** 2 for x in places]
    )


@pytest.mark.parametrize("which", ["run", "labelled"])
def test_the_power_is_that_of_the_force_on_two_rails_of_every_axle(which, request):
    case, tree = request.getfixturevalue(which)
    spectra, track = tree["spectra"], case.track_model()
    frequency, force = spectra["frequency"].values, spectra["force_psd"].values[0]
    band = spectra["band"].values
    top = SleeperTop(2.6, 0.25)
    for name, part in (("rail", rail_section(case, track)), ("sleepers", top)):
        density = part.power_per_force(track, frequency, spread(track, frequency)) * force
        expected = (
            2.0 * case.axles * band_energies(frequency, density, band / HALF_BAND, band * HALF_BAND) / 1e-12
        )
        inside = band < 3500.0  # the lines end in the last band
        np.testing.assert_allclose(levels(tree)[name][inside], 10.0 * np.log10(expected[inside]), atol=0.05)


@pytest.mark.parametrize("which", ["run", "stiff"])
def test_the_motion_at_the_contact_is_that_of_the_force(which, request):
    """Where the deflection from bay to bay does not matter, the contact moves by F |Y|.

    At the pinned-pinned frequency, 1063 Hz, this holds because the force is spread over a bay as it is.
    """
    case, tree = request.getfixturevalue(which)
    track = case.track_model()
    displacement = tree["rolling"]["rail_displacement"].values[0, 0]
    segment = min(displacement.size // 4, round(0.2 / case.time_step))
    frequency, moved = psd(displacement, case.time_step, segment=segment)
    _, force = psd(tree["rolling"]["contact_force"].values[0, 0], case.time_step, segment=segment)
    lines = frequency > 0.0
    velocity, of_force = (2.0 * np.pi * frequency) ** 2 * moved, np.zeros_like(force)
    share = spread(track, frequency[lines])
    of_force[lines] = squared_point_mobility(track, frequency[lines], share) * force[lines]
    band = 1000.0 * 10.0 ** (np.arange(-5, 4) / 10.0)
    edges = band / HALF_BAND, band * HALF_BAND
    both = [band_energies(frequency, density, *edges) for density in (velocity, of_force)]
    level = 10.0 * np.log10(both[0] / both[1])
    assert np.abs(level).max() < 1.6, level
    assert abs(level.mean()) < 0.6, level


def test_a_rigid_wheel_says_that_its_part_is_missing(run):
    _, tree = run
    found = levels(tree)
    assert np.isnan(found["wheel"]).all()
    both = 10.0 * np.log10(10.0 ** (found["rail"] / 10.0) + 10.0 ** (found["sleepers"] / 10.0))
    np.testing.assert_allclose(found["total"], both, rtol=1e-12)
    why = tree["spectra"]["radiated_power_level"].attrs
    assert why["wheel"] == "the wheel is rigid"
    assert why["missing"] == "of this wheel it is not known how its disc and tread vibrate"
    told = [w for w in json.loads(tree.attrs["warnings"]) if w["category"] == MissingSourceWarning.__name__]
    assert [w["grade"] for w in told] == ["note"]
    assert "that of rail and sleepers alone: the wheel is rigid" in told[0]["message"]


@pytest.mark.parametrize(
    ("wheel", "reason"),
    [
        ({"modes": MODES[:, :3]}, "the table wheel.modes does not say how the modes move disc and tread"),
        ({"modes": MODES}, ""),
        (
            {"receptance": np.array([[100.0 * n, -1e-9, -1e-11] for n in range(1, 30)])},
            "the wheel's receptance does not say how its disc and tread move",
        ),
    ],
)
def test_why_a_wheel_is_silent(wheel, reason):
    assert silent_wheel(WheelOnRail(surface={"spectrum": "iso3095"}, wheel=wheel)) == reason


def test_a_wheel_that_rings_is_louder_than_the_rail_at_high_frequency(ringing):
    _, tree = ringing
    found, band = levels(tree), tree["spectra"]["band"].values
    assert np.isfinite(found["wheel"]).all()
    assert tree["spectra"]["radiated_power_level"].attrs["wheel"] == "computed"
    assert "MissingSourceWarning" not in tree.attrs["warnings"]
    assert (found["wheel"] > found["rail"])[(band > 2200.0) & (band < 3500.0)].all()
    assert (found["wheel"] < found["rail"] - 6.0)[(band > 600.0) & (band < 1300.0)].all()
    parts = sum(10.0 ** (found[name] / 10.0) for name in RADIATORS[:3])
    np.testing.assert_allclose(found["total"], 10.0 * np.log10(parts), rtol=1e-12)


def test_a_soft_pad_makes_the_rail_louder_and_the_sleepers_quieter(stiff):
    """100 against 1200 MN/m of the same loss factor, in dB(A), over the same roughness."""
    _, loose = rolled(track={"pad_stiffness": 100e6, "pad_loss_factor": 0.25})
    soft, stiff = (levels(tree, "radiated_power_level_a") for tree in (loose, stiff[1]))
    assert soft["rail"] > stiff["rail"] + 2.0
    assert soft["sleepers"] < stiff["sleepers"] - 5.0


def test_a_flat_on_a_smooth_rail_without_a_linear_law_has_a_sound_power():
    told = {"laws": ["hertz"], "surface": {"smooth": True}, "wheel": {"flat_depth": "0.2 mm"}}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PhysicsWarning)
        tree = asperity.run(WheelOnRail(**(CASE | told)))
    assert "sound_power_level" not in tree["spectra"]
    assert levels(tree, "radiated_power_level_a")["total"] > 90.0


def test_a_label_that_contradicts_the_track_is_warned_of(labelled):
    _, tree = labelled
    told = [w["message"] for w in json.loads(tree.attrs["warnings"]) if "CNOSSOS" in w["message"]]
    assert len(told) == 1
    assert "300 MN/m, in range 800 to 1000 MN/m" in told[0]


def test_the_report_shows_it_beside_cnossos(run, ringing):
    _, tree = run
    lines = RADIATED.collect(tree)
    band, standard = tree["spectra"]["noise_band"].values, tree["spectra"]["sound_power_level"].values[0]
    found = lines.columns["track by CNOSSOS-EU, linear [dB re 1 pW]"]
    np.testing.assert_allclose(found[np.isfinite(found)], standard[0])
    assert lines.at[np.isfinite(found)] == pytest.approx(band)
    labels, own = (
        [mark.label for mark in RADIATED.laid_out(found).panels[0].marks if isinstance(mark, Line)]
        for found in (tree, ringing[1])
    )
    assert labels[:3] == ["rail", "sleepers", "total"]
    assert "wheel" in own
    table = radiated_table(tree)
    assert table.head[1:5] == ["rail", "sleepers", "wheel", "total"]
    assert (
        "The wheel's part is missing, and the total is that of rail and sleepers: the wheel is" in table.note
    )
    level = levels(tree, "radiated_power_level_a")
    cells = [cell.text for cell in table.rows[0]]
    assert cells[1:5] == [f"{level['rail']:.1f}", f"{level['sleepers']:.1f}", "–", f"{level['total']:.1f}"]
    assert "missing" not in radiated_table(ringing[1]).note
    answers = noise_answers(tree)
    assert answers.numbers[0].value == f"{level['total']:.1f} dB(A)"
    assert "without the wheel" in answers.numbers[0].note
    assert answers.lead.startswith(
        f"By vibration the rail decides: {level['rail']:.1f} of {level['total']:.1f} dB(A)"
    )
    by_vibration, *_ = ([cell.text for cell in row] for row in answers.tables[0].rows)
    assert by_vibration[1:] == [cells[1], cells[2], cells[4], "–", cells[4]]
