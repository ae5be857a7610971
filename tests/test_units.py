"""Quantities with units: what is understood, and what each misunderstanding is answered."""

import math

import pint
import pytest
from hypothesis import given
from hypothesis import strategies as st

from asperity.errors import InputError
from asperity.units import _OTHERS, _PREFIXED, _PREFIXES, factor, quantity


@pytest.mark.parametrize(
    ("text", "dimension", "value"),
    [
        ("25 mm", "m", 0.025),
        ("25mm", "m", 0.025),
        ("1e-3 m", "m", 1e-3),
        ("1e-3m", "m", 1e-3),
        ("  8   um ", "m", 8e-6),
        ("8 µm", "m", 8e-6),  # micro sign
        ("8 μm", "m", 8e-6),  # Greek mu
        ("-0.5 um", "m", -5e-7),
        (".5 um", "m", 5e-7),
        ("5. um", "m", 5e-6),
        ("0 um", "m", 0.0),
        ("5 N s/m", "N s/m", 5.0),
        ("5N s/m", "N s/m", 5.0),
        ("5 N*s/m", "N s/m", 5.0),
        ("5 N·s/mm", "N s/m", 5000.0),
        ("200 km/h", "m/s", 200 / 3.6),
        ("5 kHz", "Hz", 5000.0),
        ("65 kN", "N", 65e3),
        ("3 GPa", "Pa", 3e9),
        ("7850 kg/m^3", "kg/m^3", 7850.0),
        ("7.85 g/cm³", "kg/m**3", 7850.0),
        ("1 N/um", "N/m", 1e6),
        ("600 kg", "kg", 600.0),
        ("10 ms", "s", 0.01),
        ("+0 dB", "dB", 0.0),
        ("-6dB", "dB", -6.0),
        ("inf", "m", math.inf),
        ("-inf", "m", -math.inf),
        ("inf m", "m", math.inf),
        ("0.8", "", 0.8),
        ("5 %", "", 0.05),
    ],
)
def test_quantities(text, dimension, value):
    assert quantity(text, dimension) == pytest.approx(value, rel=1e-14)


@given(
    st.floats(-1e200, 1e200),
    st.sampled_from([("um", 1e-6), ("mm", 1e-3), ("m", 1.0), ("km", 1e3)]),
    st.sampled_from(["", " ", "  "]),
)
def test_every_number_keeps_its_value(number, unit, gap):
    name, si = unit
    assert quantity(f"{number!r}{gap}{name}", "m") == pytest.approx(number * si, rel=1e-14)


@given(st.text(max_size=60))
def test_any_text_is_a_value_or_a_clear_error(text):
    try:
        value = quantity(text, "m")
    except InputError:
        value = 0.0
    assert not math.isnan(value)


@pytest.mark.parametrize(
    ("text", "dimension", "message"),
    [
        ("25", "m", "Add the unit"),
        ("25 kg", "m", "'kg'; allowed: a unit that converts to m"),
        ("25 mm", "", "Leave the unit away"),
        ("25 furlongz", "m", "Check its spelling"),
        ("200 kmh", "m/s", 'Did you mean "km/h"'),
        ("200 km h", "m/s", 'Did you mean "km/h"'),
        ("200 kmph", "m/s", 'Did you mean "km/h"'),
        ("20 ms", "m/s", 'Did you mean "m/s"'),
        ("5 KN", "N", 'Did you mean "kN"'),
        ("3 mM", "m", 'Did you mean "mm" or "Mm"'),
        ("200 knm", "N/m", 'Did you mean "kN/m"'),
        ("mm 25", "m", "number first"),
        ("2,5 mm", "m", "decimal point"),
        ("1_000 mm", "m", "number first"),
        ("", "m", "number first"),
        ("nan m", "m", "NaN is not a value"),
        ("1e999 m", "m", "too large"),
        ("1e308 km", "m", "too large"),
        ("3 m", "dB", "'m'; allowed: a unit that converts to dB"),
        ("3 dB", "m", "'dB'; allowed: a unit that converts to m"),
        ("3 (m)", "m", 'Did you mean "m"'),
        ("3 m; import os", "m", "powers, as in"),
        ("1 " + "m" * 100, "m", "powers, as in"),
    ],
)
def test_messages(text, dimension, message):
    with pytest.raises(InputError) as caught:
        quantity(text, dimension)
    assert message in str(caught.value)


def test_a_tower_of_powers_is_refused_unevaluated():
    with pytest.raises(InputError, match="powers"):
        quantity("1 m^9^9^9^9", "m")


@pytest.mark.parametrize("dimension", _PREFIXED)
def test_usual_units_are_those_of_the_unit_library(dimension):
    library = pint.UnitRegistry()
    for unit in (dimension, *(prefix + dimension for prefix in _PREFIXES)):
        assert factor(unit, dimension) == library.Quantity(1.0, unit).to(dimension).magnitude


def test_factor():
    assert factor("um", "m") == pytest.approx(1e-6, rel=1e-14)
    assert factor("dB", "dB") == 1.0
    with pytest.raises(InputError, match="allowed: no unit"):
        factor("m", "")


@pytest.mark.parametrize(("unit", "dimension"), _OTHERS)
def test_other_units_that_need_no_library_are_its_units(unit, dimension):
    expected = pint.UnitRegistry().Quantity(1.0, unit).to(dimension).magnitude
    assert factor(unit, dimension) == pytest.approx(expected, rel=1e-15)
