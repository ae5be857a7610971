"""Cases of any bodies, on any structure: what is built of their keys, and what is said of wrong ones."""

import warnings

import numpy as np
import pytest

from asperity import Beam, Bodies, ModalStructure, Profile, Wheel, WheelOnRail, errors, material
from asperity.reporting import data
from asperity.running import prepare_case
from asperity.scenarios.scene import scene_of
from asperity.scenarios.textures import other_contacts, textures_of, textures_under
from asperity.scenes.figures.motion import body_acceleration
from asperity.scenes.over_frequency import passing_frequencies

ROUGH = {"rms": "0.05 um", "longest": "0.4 mm", "shortest": "80 um"}
COARSE = {"spacing": "20 um", "window": "0.6 mm", "samples": 2, "sample_length": "1.4 mm"}
BOGIE = {
    "type": "bogie", "masses": [3000], "springs": [1.2e6], "dampers": [2e4], "distance": 2.5, "mass": 600,
}  # fmt: skip
WHEEL = {"mass": 600.0, "load": 65e3, "radius": 0.46}


def case_of(body=(), **keys):
    return Bodies(**{"surface": ROUGH, "contact": COARSE, "body": dict(body), **keys})


def scene(*arguments, **keys):
    return scene_of(case_of(*arguments, **keys))


# --- what rolls


def test_bodies_weigh_what_they_are_said_to():
    (ball,) = scene().rolling
    mass = 4.0 / 3.0 * np.pi * 25e-3**3 * 7850.0
    assert ball.mass[0, 0] == pytest.approx(mass, rel=0.01)
    assert ball.static_loads == pytest.approx([mass * 9.80665], rel=0.01)
    body = {"type": "chain", "mass": 600, "masses": [1000, 5000], "springs": [1e6, 2e5], "load": 65e3}
    (chain,) = scene(body).rolling
    assert chain.static_loads == pytest.approx([65e3])  # a load holds all weights
    assert np.diag(chain.mass) == pytest.approx([600, 1000, 5000])
    (bogie,) = scene(BOGIE, over="plane").rolling
    assert bogie.static_loads == pytest.approx(
        9.80665 * np.full(2, 600 + 1500)
    )  # without one, they are carried
    assert bogie.mass[3, 3] == pytest.approx(3000 * 2.5**2 / 12)


def test_bodies_stand_behind_one_another():
    case = case_of(BOGIE | {"positions": ["0 m", "10 m"]}, over="plane")
    assert case.body.offsets == (0.0, 2.5, 10.0, 12.5)
    wheels = {"rear wheel, body 2": 1.0, "front wheel, body 2": 1.0}
    frame = {"frame, body 2": 1.0, "frame, pitch at its end, body 2": 1.25}
    assert dict(list(scene_of(case).degrees.items())[4:]) == wheels | frame


def test_elements_of_a_carriage_press_it_up_by_hertz():
    case = case_of({"type": "carriage", "masses": [0.4], "distance": 0.02, "radius": 3e-3, "load": 20.0})
    hertz = case.smooth_contact
    expected = hertz.tangent_stiffness(hertz.approach(20.0 - 9.80665 * case.body.contact_mass))
    assert scene_of(case).rolling[0].stiffness[0, 0] == pytest.approx(expected)


def test_loads_and_textures_of_their_own_make_laws_of_their_own():
    smooth = case_of({"positions": ["0 m", "0.1 m", "0.3 m"]})
    assert other_contacts(smooth, np.full(3, 5.0)) == ([0, 0, 0], [])
    which, others = other_contacts(case_of(), np.array([5.0, 7.0, 5.0, 7.0]))
    assert (which, others) == ([0, 1, 0, 1], [(0, 7.0)])


TURNING = {
    "over": "plane", "speed": 20, "duration": "0.2 s", "laws": ["linear"],
    "contact": {"spacing": "1 mm", "window": "20 mm"},
}  # fmt: skip


def both(body, **keys):
    """Textures under the first of two contacts that differ, and under the second."""
    case = case_of(BOGIE | {"radius": 0.46, "distance": "2 m"} | body, **TURNING | keys)
    which, others = other_contacts(case, np.full(2, 5.0))
    first = textures_of(case)
    assert which == [0, 1]
    return first, textures_under(case, others[0][0], first), round(2 * np.pi * 0.46 / 1e-3)


def test_each_contact_bears_a_roughness_of_its_own():
    first, second, around = both({"roughness": "disc"}, surface={"spectrum": "iso3095"})
    change = second.line - first.line
    assert change.std() > 1e-6
    np.testing.assert_allclose(change[around:], change[:-around], atol=1e-15)  # both turn


def test_each_contact_bears_its_own_measured_line():
    angle = 2.0 * np.pi * np.arange(2890) / 2890
    lines = 1e-6 * np.array([np.sin(7 * angle), np.cos(12 * angle)])
    body, rail = (
        {"line": lines, "line_spacing": 1e-3},
        Profile(1e-7 * np.random.default_rng(1).normal(size=9000), 1e-3),
    )
    first, second, around = both(body, surface={"line": rail})
    for textures, line in zip((first, second), lines, strict=True):
        inside = slice(20, around - 20)  # the ends are made to meet
        turn = np.roll(textures.parts["wheel"][:around], -textures.before)  # it begins where the record does
        np.testing.assert_allclose(turn[inside], (line - line.mean())[inside], atol=1e-8)
    np.testing.assert_allclose(first.line - first.parts["wheel"], second.line - second.parts["wheel"])


def test_equal_distances_have_passing_tones():
    assert passing_frequencies([0.0, 0.02, 0.04], 1.0, 180.0) == pytest.approx([50.0, 100.0, 150.0])
    assert passing_frequencies([0.0, 0.02, 0.05], 1.0, 180.0).size == 0
    assert passing_frequencies([0.0], 1.0, 180.0).size == 0


RUN_UP = {
    "over": "plane", "speed": "10..20 m/s in 0.2 s", "laws": ["linear"], "settling": "5 ms",
    "surface": {"corrugation": "1 um", "corrugation_wavelength": "20 mm"},
    "contact": {"spacing": "0.8 mm", "window": "20 mm"},
}  # fmt: skip
"""Bodies that pass a wave at 500 to 1000 Hz."""


def test_of_a_speed_that_changes_pages_say_of_which_one_frequencies_are(runs):
    """Two contacts 2 m apart pass a place with v/2 m, 10 Hz at the fastest; so do orders of a turn."""
    tree = runs(case_of(BOGIE | {"radius": 0.46, "distance": "2 m"}, **RUN_UP))
    assert tree["spectra"].to_dataset()["passing_frequency"].values[0] == pytest.approx(10.0)
    assert data.at_its_fastest(tree) == ", at the fastest, 20 m/s"
    said = body_acceleration.drawn(tree).caption
    assert "multiples of the 10 Hz at which contacts pass a place, at the fastest, 20 m/s;" in said
    steady = runs(case_of(BOGIE | {"radius": 0.46, "distance": "2 m"}, **RUN_UP | {"speed": 20.0}))
    assert data.at_its_fastest(steady) == ""
    assert "contacts pass a place; ten" in body_acceleration.drawn(steady).caption


@pytest.mark.parametrize(("wavelength", "doubted"), [("20 m", True), ("0.5 m", False), ("1.5 m", False)])
def test_a_wave_is_doubted_where_it_is_heard_at_no_speed_of_a_course(wavelength, doubted):
    """1.5 m are passed at 6.7 Hz where it is slowest, and at 13 Hz where it is fastest."""
    surface = {"corrugation": "1 um", "corrugation_wavelength": wavelength}
    prepared = prepare_case(case_of(WHEEL, **RUN_UP | {"surface": surface}))
    told = [str(each.message) for each in prepared.caught if "corrugation_wavelength" in str(each.message)]
    assert bool(told) == doubted
    assert not doubted or "it is passed at 0.5 to 1 Hz" in told[0]


# --- what is rolled over


def test_springs_carry_a_free_beam():
    """The bounce of a stiff beam on two springs: sqrt(2k/m), damped by half their loss factor."""
    springs = {"supports": [0.2, 0.8], "support_stiffness": 10.0, "support_loss_factor": 0.1}
    beam = scene(beam={"support": "free"} | springs).over
    mass = 0.05 * 0.01 * 7850.0
    assert beam.natural_frequencies.min() < np.sqrt(20.0 / mass) / (2 * np.pi) * 1.01
    assert beam.damping_ratios[:2] == pytest.approx([0.05, 0.05], rel=1e-3)


def modes(begin, frequency=200.0):
    x = np.linspace(begin, begin + 1.0, 41)
    return ModalStructure(x, [frequency], 0.01, np.sin(np.pi * (x - begin))[:, None], modal_masses=[2.0])


def test_modes_from_memory_are_rolled_over_where_they_are():
    case = case_of({"positions": ["0 m", "0.2 m"]}, over="structure", structure={"file": modes(2.0)})
    assert case.rolled_range == pytest.approx((2.0, 2.8))
    assert case.structure.sensor_positions[2] == pytest.approx(2.5)
    assert case != case.with_(structure={"file": modes(2.0, 201.0)})
    with pytest.raises(errors.InputError, match="where a case shall be written"):
        case.to_toml()


BEAM = Beam.rectangular(1.0, 0.05, 0.01, material("steel"), loss_factor=0.02, highest_frequency=500.0)
LOW = {"highest_frequency": "250 Hz"}
MODES = np.array([[800.0, 0.01, 20.0], [1500.0, 0.02, 15.0]])


def noisy(found, noise, random):
    return found * (1.0 + noise * (random.normal(size=found.size) + 1j * random.normal(size=found.size)))


def receptances(frequency, noise=0.0):
    """Table of the receptances of a beam at 19 places under a force at one of them."""
    random, rows = np.random.default_rng(1), []
    for place in np.linspace(0.0, 1.0, 21)[1:-1]:
        found = noisy(BEAM.receptance(frequency, place, 0.3), noise, random)
        rows += [[f, place, 0.3, h.real, h.imag] for f, h in zip(frequency, found, strict=True)]
    return np.array(rows)


def point(wheel, frequency, noise=0.0):
    """Table of the receptance of a wheel at its contact."""
    found = noisy(wheel.receptance(frequency), noise, np.random.default_rng(1))
    return np.column_stack([frequency, found.real, found.imag])


def on_structure(table):
    keys = {"over": "structure", "structure": {"receptances": table}, "start": 0.2, "duration": 0.1}
    return case_of(**keys, numerics=LOW)


def wheel_on_rail(table):
    keys = {"mass": 600.0, "receptance": table}
    return WheelOnRail(surface={"smooth": True}, wheel=keys, numerics=LOW)


def test_receptances_are_fitted_by_modes():
    case = on_structure(receptances(np.arange(2.0, 500.0, 0.5)))
    assert case.structure.sensor_positions[0] == pytest.approx(0.23)
    measured = BEAM.receptance([80.0], 0.3, 0.3)
    assert scene_of(case).over.receptance([80.0], 0.3, 0.3) == pytest.approx(measured, rel=0.02)


def doubts(case):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", errors.PhysicsWarning)
        scene_of(case)
    return caught


def test_doubts_are_those_of_the_run_not_of_reading():
    """Noise of a third of the receptance is told where the bodies are built, not where keys are read."""
    case = on_structure(receptances(np.arange(2.0, 400.0, 1.0), noise=0.3))
    assert {errors.EnergyWarning, errors.UnconvergedWarning} <= {each.category for each in doubts(case)}


@pytest.mark.parametrize(
    ("end", "graded"), [(500.0, None), (375.0, errors.Grade.WARNING), (200.0, errors.Grade.OUT)]
)
def test_receptances_that_end_below_twice_the_highest_frequency_are_warned_of(end, graded):
    """Of a structure, a body and a wheel."""
    frequency = np.arange(2.0, end + 1.0, 2.0)
    table = point(Wheel(600.0, 65e3, *MODES.T), frequency)
    body = case_of(WHEEL | {"receptance": table}, over="plane", numerics=LOW)
    cases = {"structure": on_structure(receptances(frequency)), "body": body, "wheel": wheel_on_rail(table)}
    for what, case in cases.items():
        told = [each.message for each in doubts(case) if each.category is errors.ShortRecordWarning]
        assert [message.grade for message in told] == ([graded] if graded else [])
        ends = f"of the {what} end at 374 Hz, 1.5 times numerics.highest_frequency; 2 times it, 500 Hz, are"
        remedy = "Give them to 500 Hz, or lower numerics.highest_frequency to 188 Hz"
        assert graded is not errors.Grade.WARNING or (ends in str(told[0]) and remedy in str(told[0]))


@pytest.mark.filterwarnings("ignore::asperity.errors.EnergyWarning")
def test_a_wheel_is_fitted_to_twice_the_highest_frequency():
    """A mode just above it is found in a record with 2 % of noise; fitted to it alone, it is a guess."""
    wheel = Wheel(600.0, 65e3, [100.0, 290.0], [0.01, 0.002], [300.0, 100.0])
    (fitted,) = scene_of(wheel_on_rail(point(wheel, np.arange(5.0, 500.0, 0.5), 0.02))).rolling
    assert np.abs(fitted.natural_frequencies / 290.0 - 1.0).min() < 1e-4


def test_what_touches_resonates_at_each_contact_and_is_known_by_its_receptance():
    (bogie,) = scene(BOGIE | {"modes": MODES}, over="plane").rolling
    assert bogie.natural_frequencies == pytest.approx([800.0, 1500.0, 800.0, 1500.0])
    assert bogie.shapes[1] == pytest.approx([0.0, 0.0, 20.0**-0.5, 15.0**-0.5])
    table = point(Wheel(600.0, 65e3, *MODES.T), np.arange(20.0, 10000.0, 4.0))
    (fitted,) = scene(WHEEL | {"receptance": table}, over="plane").rolling
    assert fitted.natural_frequencies[:2] == pytest.approx([800.0, 1500.0], rel=1e-3)
    assert fitted.static_loads == pytest.approx([65e3])


# --- what may not be


def test_what_is_wrong_with_bodies_and_structures_is_told(tmp_path):
    (tmp_path / "modes.csv").write_text("frequency (Hz), 10\n")
    table, short = receptances(np.arange(2.0, 400.0, 2.0)), {"line": np.zeros(900), "line_spacing": 1e-3}
    for keys, message in (
        ({"structure": {"file": tmp_path / "modes.csv"}}, r"structure\.file"),
        ({"structure": {"file": modes(0.0), "sensors": [2.0]}}, r"structure\.sensors: received 2 m"),
        ({"structure": {"receptances": table[1:]}}, r"structure\.receptances.*Complete the table"),
        ({"structure": {"receptances": table, "file": modes(0.0)}}, "both file and receptances"),
        (
            {"body": WHEEL | {"receptance": table[:199, [0, 3, 4]], "modes": MODES}, "over": "plane"},
            "both modes and receptance",
        ),
        (
            {"body": BOGIE | {"flat_depth": 1e-4, "flat_contacts": [3]}, "over": "plane"},
            r"flat_contacts: received 3; allowed: numbers up to 2",
        ),
        (
            {"over": "plane", "noise": {"wheel_width": 0.14}},
            r"noise\.wheel_width: received a key of a track; allowed: what a plane has",
        ),
    ):
        with pytest.raises(errors.CaseError, match=message):
            Bodies(**{"surface": ROUGH, "contact": COARSE, "over": "structure"} | keys)
    with pytest.raises(errors.InputError, match=r"body.line: received 0.9 m; allowed: a full turn"):
        textures_of(case_of(BOGIE | {"radius": 0.46} | short, surface={"spectrum": "iso3095"}, **TURNING))
