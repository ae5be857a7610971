"""What can be asked for, and what is said of what cannot."""

import numpy as np
import pytest

import asperity
from asperity.case.toml import read_toml
from asperity.errors import InputError
from asperity.optimising.definition import Aim, aim_template, bands_of, load_aim, with_texture
from asperity.parameters import FROM_PYTHON
from refusals import refusals
from small_cases import COARSE, WHEEL

CASE = COARSE | {"start": "0.2 m", "duration": "0.2 s"}
BANDS = np.array([[10.0 ** (-n / 10.0), -30.0] for n in range(25, 37)])


SPECTRUM = CASE | {"surface": {"spectrum": BANDS}}
ON_PLANE = {"kind": "bodies", "over": "plane", "surface": CASE["surface"]}


def test_the_template_is_an_aim():
    data = read_toml(aim_template(), "optimisation", "template")
    assert data.pop("case") == "case.toml"
    assert Aim.read(data, FROM_PYTHON).rms_at_least == pytest.approx(0.5e-6)


test_wrong_aims_are_refused_with_all_that_is_wrong = refusals(
    ({"rms_at_least": None}, "without, the smoothest is the quietest"),
    ({"colour": "red"}, "unknown key"),
    ({"rms_at_least": "2 um", "rms_at_most": "1 um"}, "at most rms_at_most"),
    ({"longest": "1 mm", "shortest": "2 mm"}, "at least shortest"),
    ({"limit": "100 dB", "price": [0.0]}, "a price that tells"),
    ({"lateral": [2.0, 1.0]}, "two numbers, the least first"),
    ({"quantity": "loudness"}, "quantity"),
    ({"lowest": ["-40 dB", "-30 dB"]}, "one for each band"),
    ({"lowest": ["-20 dB"], "highest": ["-30 dB"]}, "lowest below highest"),
    ({"rms_at_least": "0.1 mm"}, "rms_at_least: received 100 µm.*at most .* which the highest levels"),
    ({"rms_at_least": None, "budget": 1.0, "rms_at_most": "1 nm"}, "rms_at_most: received 1.00 nm.*at least"),
    ({"rms_at_least": None, "budget": 1.0, "highest": ["-90 dB"], "lowest": ["-99 dB"]}, "budget.*cheapest"),
    ({"longest": "0.3 mm", "shortest": "0.29 mm"}, "Change longest or shortest"),
    ({"case": SPECTRUM, "lateral": [0.5, 2.0]}, "a line, which has no lay"),
    (
        {"case": CASE | {"speed": "1..2 m/s in 0.1 s"}},
        "speed: received a course, 1 to 2 m/s; allowed: one constant",
    ),
    ({"case": ON_PLANE, "quantity": "rms acceleration"}, '"rms acceleration" of bodies'),
    of=lambda aim: asperity.optimise(**{"case": CASE, "rms_at_least": "1 um"} | aim),
)


@pytest.mark.parametrize(("text", "match"), [
    ("rms_at_least = '1 um'", "case: received nothing"),
    ("case = 'none.toml'\nrms_at_least = '1 um'", "none.toml"),
    ("case = 'case.toml'\nrms_at_leest = '1 um'", "rms_at_least"),
])  # fmt: skip
def test_files_that_say_too_little_or_too_much(tmp_path, text, match):
    (tmp_path / "case.toml").write_text(asperity.BallOnBeam(**CASE).to_toml())
    (tmp_path / "aim.toml").write_text(text)
    with pytest.raises(InputError, match=match):
        load_aim(tmp_path / "aim.toml")


def test_bands_are_those_of_the_spectrum_that_are_heard():
    case = asperity.BallOnBeam(**CASE | {"surface": {"spectrum": BANDS, "lateral": 2.0, "level": "+3 dB"}})
    bands = bands_of(case, None, None)
    np.testing.assert_allclose(bands.wavelength, BANDS[:, 0])
    np.testing.assert_allclose(bands.levels, -27.0)
    assert bands.lateral == 2.0
    low, high = bands.edges(case.speed)
    assert high.max() >= case.numerics.highest_frequency > low.max() / 10**0.1
    np.testing.assert_allclose(np.sqrt(low * high), case.speed / bands.changed_wavelength)


def test_bands_of_a_self_affine_texture_have_its_rms():
    case = asperity.BallOnBeam(**CASE)
    bands = bands_of(case, 1.0, 1e-6)
    rms = 1e-6 * np.sqrt(np.sum(10.0 ** (bands.levels / 10.0)))
    assert rms == pytest.approx(case.surface.rms, rel=0.1)


def test_the_case_with_a_texture_keeps_all_else():
    surface = WHEEL.get("surface", {}) | {"corrugation": "5 um", "corrugation_wavelength": "40 mm"}
    case = asperity.WheelOnRail(**WHEEL | {"surface": surface})
    bands = bands_of(case, None, None)
    found = with_texture(case, bands)
    assert found.surface.corrugation == case.surface.corrugation
    assert found.wheel == case.wheel
    np.testing.assert_array_equal(found.surface.spectrum, bands.table)
    assert found.surface.lateral == case.surface.lateral
