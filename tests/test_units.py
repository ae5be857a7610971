"""Quantities with units: what is understood, and what each misunderstanding is answered."""

import math
from contextlib import suppress

import pint
import pytest
from hypothesis import given
from hypothesis import strategies as st

from asperity.errors import InputError
from asperity.units import _OTHERS, _PREFIXED, _PREFIXES, factor, quantity

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
    ("Check its spelling", "m", ["25 furlongz"]),
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


@pytest.mark.parametrize("dimension", _PREFIXED)
def test_usual_units_are_those_of_the_unit_library(dimension):
    library = pint.UnitRegistry()
    for unit in (dimension, *(prefix + dimension for prefix in _PREFIXES)):
        expected = library.Quantity(1.0, unit).to(dimension).magnitude
        assert factor(unit, dimension) == pytest.approx(
            expected, rel=1e-15, abs=0.0
        )  # its digits, not its last bit


@pytest.mark.parametrize(("unit", "dimension"), _OTHERS)
def test_other_units_that_need_no_library_are_its_units(unit, dimension):
    expected = pint.UnitRegistry().Quantity(1.0, unit).to(dimension).magnitude
    assert factor(unit, dimension) == pytest.approx(expected, rel=1e-15)
