"""Quantities with units: what is understood, and what each misunderstanding is answered."""

import math
from contextlib import suppress

import pint
import pytest
from hypothesis import given
from hypothesis import strategies as st

from asperity import unit_table
from asperity.errors import InputError
from asperity.unit_table import BASE, UNITS, scale_of
from asperity.units import factor, quantity, written

READ = [
    (0.025, "m", ["25 mm", "25mm"]),
    (1e-3, "m", ["1e-3 m", "1e-3m"]),
    (8e-6, "m", ["  8   um ", "8 µm", "8 μm"]),  # micro sign, Greek mu
    (-5e-7, "m", ["-0.5 um"]),
    (5e-7, "m", [".5 um"]),
    (5e-6, "m", ["5. um"]),
    (0.0, "m", ["0 um"]),
    (5.0, "N s/m", ["5 N s/m", "5N s/m", "5 N*s/m", "0.005 N·s/mm"]),
    (200 / 3.6, "m/s", ["200 km/h"]),
    (5000.0, "Hz", ["5 kHz"]),
    (30.0, "Hz", ["1800 1/min", "1800 rpm", "1800 r/min", "1800 min^-1", "1800 min⁻¹"]),
    (65e3, "N", ["65 kN"]),
    (3e9, "Pa", ["3 GPa"]),
    (7850.0, "kg/m**3", ["7850 kg/m^3", "7.85 g/cm³"]),
    (1e6, "N/m", ["1 N/um"]),
    (0.01, "s", ["10 ms"]),
    (-6.0, "dB", ["-6dB", "-6 dB"]),
    (math.inf, "m", ["inf", "inf m", "+inf"]),
    (-math.inf, "m", ["-inf"]),
    (0.05, "", ["0.05", "5 %"]),
]


@pytest.mark.parametrize(
    ("value", "dimension", "text"), [(v, d, text) for v, d, all_ in READ for text in all_]
)
def test_quantities(text, dimension, value):
    assert quantity(text, dimension) == pytest.approx(value, rel=1e-14, abs=0.0)


@given(
    st.floats(-1e200, 1e200),
    st.sampled_from([("um", 1e-6), ("mm", 1e-3), ("m", 1.0), ("km", 1e3)]),
    st.sampled_from(["", " ", "  "]),
)
def test_every_number_keeps_its_value(number, unit, gap):
    name, si = unit
    assert quantity(f"{number!r}{gap}{name}", "m") == pytest.approx(number * si, rel=1e-14)


@pytest.mark.parametrize("text", ["143 km/h", "85.7 km/h", "200 km/h", "56 m/s", "0.37 m/s", "39.72 m/s"])
def test_a_speed_is_written_as_it_was_typed(text):
    """To the last bit, and short."""
    for exactly in (True, False):
        assert written(quantity(text, "m/s"), "m/s", "m/s", exactly=exactly) == text


def test_a_speed_that_nobody_typed_is_written_in_its_own_unit():
    assert written(100.0 / 3.0 + 1e-9, "m/s", "m/s") == "33.3333 m/s"
    assert written(math.nan, "m/s", "m/s") == "nan m/s"


DIMENSIONS = ("", "m", "Hz", "N", "N/m", "m/N", "dB", "dB/m", "kg", "rad", "s", "Pa s/m^2", "N s/m", "kg/m^3")
WORDS = st.text("dBmMkKuµ/°% ^*²·()1pchNPC", max_size=8) | st.sampled_from(
    ["dBm", "dbm", "DBM", "dB m", "dBm/Hz", "dBu", "dB/km", "Np", "degC", "delta_degC", "octave", "ppm", "B"]
)


@given(WORDS, st.sampled_from(DIMENSIONS))
def test_any_word_in_the_place_of_a_unit_is_one_or_a_clear_error(word, dimension):
    """Levels too, of which the unit library makes quantities of another kind."""
    with suppress(InputError):
        assert factor(word, dimension) > 0.0


def test_levels_by_length_are_recognised():
    with pytest.raises(InputError, match='Did you mean "dB/m"'):
        factor("dBm", "dB/m")


@given(st.text(max_size=60))
def test_any_text_is_a_value_or_a_clear_error(text):
    try:
        value = quantity(text, "m")
    except InputError:
        value = 0.0
    assert not math.isnan(value)


MESSAGES = [
    ("Add the unit", "m", ["25"]),
    ("'kg'; allowed: a unit that converts to m", "m", ["25 kg"]),
    ("allowed: no unit. Leave the unit away", "", ["25 mm"]),
    ("Check its spelling. Known in its place: m, micron, ", "m", ["25 furlongz"]),
    ("'smoot' in it is unknown: check its spelling. Known in its place: m, ", "N/m", ["2 kN/smoot"]),
    ("'newtonn' in it is unknown: check its spelling. Known in its place: N, dyn, ", "N/m", ["3 newtonn/mm"]),
    ("'wug' in it is unknown: check its spelling. Known in its place: m, ", "m^2", ["3 wug^2", "3 sq wug"]),
    ("Known in its place: m, micron, angstrom, in, thou, ft, yd, mi, nmi.", "dB/m", ["1 dB per furlong"]),
    ("Check its spelling.", "N", ["3 wug wag"]),
    ('Did you mean "km/h"', "m/s", ["200 kmh", "200 km h", "200 kmph"]),
    ('Did you mean "m/s"', "m/s", ["20 ms"]),
    ('Did you mean "kN"', "N", ["5 KN"]),
    ('Did you mean "mm" or "Mm"', "m", ["3 mM"]),
    ('Did you mean "kN/m"', "N/m", ["200 knm"]),
    ('Did you mean "m"', "m", ["3 (m)"]),
    ("number first", "m", ["mm 25", "1_000 mm", ""]),
    ("decimal point", "m", ["2,5 mm"]),
    ("NaN is not a value", "m", ["nan m"]),
    ("too large", "m", ["1e999 m", "1e308 km"]),
    ("'m'; allowed: a unit that converts to dB", "dB", ["3 m"]),
    ("'dB'; allowed: a unit that converts to m", "m", ["3 dB"]),
    ("powers, as in", "m", ["3 m; import os", "1 " + "m" * 100, "1 m^9^9^9^9"]),
]


@pytest.mark.parametrize(
    ("message", "dimension", "text"), [(m, d, text) for m, d, all_ in MESSAGES for text in all_]
)
def test_messages(text, dimension, message):
    with pytest.raises(InputError) as caught:
        quantity(text, dimension)
    assert message in str(caught.value)


OTHERWISE = {"gramme", "degC", "°C", "celsius", "dB", "decibel", "Np", "neper", "rayl"}
"""Names that the library lacks, or of which it makes scales with a zero of their own, or logarithms."""
SHADOWED = {"mcd", "mcc"}
"""Millicandela and thousandths of a cubic centimetre, which the library takes for other things."""
PRODUCTS = (
    "N s/m", "N/m/s", "N/m s", "kg m^2", "kg*m**2", "kN·m", "N/mm²", "m^-1", "m per s", "square meter",
    "cubic cm", "meters squared", "kg/m^3 s^2", "W/m^2", "N mm/deg", "hours", "lbs", "min^-1",
)  # fmt: skip


def prefixed():
    """Names of the table, some with prefixes."""
    for name in sorted({name for names in UNITS for name in names.split()} - OTHERWISE):
        yield name
        if name not in "%°µμ mmHg":
            yield from (each for prefix in ("m", "k", "µ", "mega") if (each := prefix + name) not in SHADOWED)


def test_units_and_their_products_are_what_the_library_pint_says_they_are():
    """To the digits of its sums of floats: those of the table are exact."""
    library = pint.UnitRegistry()
    for unit in (*prefixed(), *PRODUCTS):
        found = scale_of(unit)
        in_base = "*".join(f"{base}**{n}" for base, n in zip(BASE, found.exponents, strict=True) if n)
        expected = library.Quantity(1.0, unit.replace("·", "*")).to(in_base or "dimensionless")
        assert found.value == pytest.approx(expected.magnitude, rel=1e-12), unit


@pytest.mark.parametrize(
    "unit", ["m//s", "per m", "/m", "m/", "square", "m square", "furlongz", "Pas", "m%", "squared m"]
)
def test_what_is_no_unit_has_no_scale(unit):
    assert scale_of(unit) is None


def test_an_angle_is_a_number_but_for_frequencies_which_count_turns():
    assert quantity("1 rad/s", "Hz") == pytest.approx(1.0 / (2.0 * math.pi), rel=1e-15)
    assert quantity("360 deg/s", "Hz") == pytest.approx(1.0, rel=1e-15)
    assert quantity("6 krpm", "Hz") == pytest.approx(100.0, rel=1e-15)
    assert quantity("5 kN m/rad", "N m") == 5000.0
    assert quantity("1 turn", "rad") == pytest.approx(2.0 * math.pi, rel=1e-15)
    assert quantity("3 dB/km", "dB/m") == 0.003


def test_of_the_table_of_units_those_are_read_that_are_asked_for():
    for function in (unit_table.scale_of, unit_table.named_unit, unit_table._defined):
        function.cache_clear()
    assert scale_of("kN s/mm").value == 1e6
    assert unit_table._defined.cache_info().currsize == 3


def test_words_behind_a_unit_raise_it_where_it_stands():
    assert scale_of("m per second squared") == scale_of("m/s^2")
    assert scale_of("N per meter cubed") == scale_of("N/m^3")
    assert scale_of("kg meter squared") == scale_of("kg m^2")
