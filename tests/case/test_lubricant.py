"""The oil of a bearing: its keys, the films that follow, and what is refused."""

import math

import pytest

from asperity.case.cases import as_case
from asperity.contact.film import Film, LineFilm, inlet_heating
from asperity.contact.oil import Oil
from asperity.errors import CaseError
from asperity.units import quantity, written
from refusals import refusals

CASE = {"kind": "ball-bearing", "bearing": {"name": "6205"}, "radial": "100 N"}
GRADE = {"oil": "ISO VG 68"}


def oiled(**keys):
    return as_case(CASE | {"lubricant": GRADE | keys})


def test_films_follow_from_the_keys():
    """Of a 6205 at 1800 1/min, whose surfaces roll with u = π d_m f (1 − γ²)/2."""
    case = oiled(temperature="50 °C", viscosity_index=120)
    oil = Oil.of_grade(68, 120.0)
    speed = math.pi * 39.04e-3 * 30.0 / 2.0 * (1.0 - (7.94 / 39.04) ** 2)
    for film, (contact, load), damping in zip(case.films, case.contacts, case.dampings, strict=True):
        assert film.speed == pytest.approx(speed, rel=0.01)
        left = inlet_heating(oil.viscosity(50.0), oil.thinning(50.0), film.speed, 0.14)
        alike = Film(contact, film.speed, oil.viscosity(50.0), oil.pressure_viscosity_at(50.0), left)
        assert film == alike
        assert damping == film.damping(load)
    assert as_case(CASE).films is None
    assert as_case(CASE).dampings == (20.0, 20.0)


def test_an_oil_by_its_viscosities_and_a_damping_by_its_time():
    """c = τ k of each contact with its film."""
    by_numbers = {"viscosity_40": "68 mm^2/s", "viscosity_100": "8.6 cSt", "density": "900 kg/m^3"}
    given = by_numbers | {"pressure_viscosity": "20 GPa^-1", "damping_time": "12.5 us"}
    case = as_case(CASE | {"lubricant": given})
    film, _ = case.films
    oil = Oil(68e-6, 8.6e-6, 900.0, 20e-9)
    assert (film.viscosity, film.pressure_viscosity) == (oil.viscosity(70.0), 20e-9)
    assert film.reduction == inlet_heating(film.viscosity, oil.thinning(70.0), film.speed, 0.14)
    assert case.dampings[0] == pytest.approx(12.5e-6 * film.stiffness(case.contacts[0][1]))


@pytest.mark.parametrize("formula", ["pan", "dowson"])
def test_films_of_rollers_are_those_of_lines_by_the_formula_that_is_asked_for(formula):
    """Of a NU205 at 1800 1/min: π d_m f (1 − γ²)/2; without oil contacts stay dry."""
    keys = {"kind": "roller-bearing", "bearing": {"name": "NU205"}, "radial": "2 kN"}
    case = as_case(keys | {"lubricant": GRADE | {"formula": formula}})
    oil = Oil.of_grade(68)
    speed = math.pi * 39e-3 * 30.0 / 2.0 * (1.0 - (7.5 / 39.0) ** 2)
    left = inlet_heating(oil.viscosity(70.0), oil.thinning(70.0), speed, 0.14)
    for film, (contact, load), damping in zip(case.films, case.contacts, case.dampings, strict=True):
        numbers = speed, oil.viscosity(70.0), oil.pressure_viscosity_at(70.0), left
        alike = LineFilm(contact, *numbers, formula)
        assert film.central(load) == pytest.approx(alike.central(load))
        assert film.minimum(load) == pytest.approx(alike.minimum(load))
        assert damping == film.damping(load)
    dry = as_case(keys)
    assert dry.films is None
    assert dry.dampings == (dry.contact_damping,) * 2


def test_a_temperature_is_one_of_degrees_celsius():
    assert quantity("-5 degC", "degC") == -5.0
    assert written(70.0, "degC", "degC") == "70 degC"


test_what_is_no_oil_is_told = refusals(
    ({"viscosity_40": "68 mm^2/s"}, r"viscosity_40"),
    ({"oil": "ISO VG 70"}, r'lubricant\.oil: received \'ISO VG 70\'; .*"ISO VG 68"'),
    ({"oil": "ISO VG 5"}, r"lubricant\.viscosity_index: received 95 of an oil of 5 mm²/s at 40 °C"),
    ({"temperature": "343 K"}, r"lubricant\.temperature: .*Write degrees Celsius, as in '70 degC'"),
    (
        {"temperature": "300 degC"},
        r"lubricant\.temperature: received 300 degC; allowed: -60 degC to 250 degC",
    ),
    ({"pressure_viscosity": "0 GPa^-1"}, r"lubricant\.pressure_viscosity"),
    of=lambda keys: oiled(**keys),
    error=CaseError,
)

test_what_does_not_go_together_is_told = refusals(
    ({"lubricant": {"temperature": "50 degC"}}, r"temperature: .* only together with oil or viscosity_40"),
    (
        {"lubricant": {"viscosity_40": "68 mm^2/s"}},
        r"lubricant\.viscosity_100: received nothing; allowed: the viscosity at 100 degC",
    ),
    (
        {"lubricant": {"viscosity_40": "8 mm^2/s", "viscosity_100": "9 mm^2/s"}},
        r"lubricant\.viscosity_100: received 9 mm²/s; allowed: less than at 40 °C, 8 mm²/s",
    ),
    (
        {"lubricant": GRADE, "laws": ["table", "direct"]},
        r'laws\[2\]: received "direct"; allowed: laws that are not solved in every step',
    ),
    (
        {"kind": "roller-bearing", "bearing": {"name": "NU205"}, "lubricant": GRADE | {"formula": "grubin"}},
        r'lubricant\.formula: received \'grubin\'; allowed: "pan", "dowson"',
    ),
    ({"lubricant": GRADE | {"formula": "pan"}}, r"lubricant\.formula: received an unknown key"),
    of=lambda keys: as_case(CASE | keys),
    error=CaseError,
)
