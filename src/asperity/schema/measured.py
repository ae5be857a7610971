"""What a case names as measured, beside what was computed of it: one list over all quantities."""

from functools import partial

from asperity.schema import Entry

_entry = partial(Entry, "measured", condition="where [measured] names tables")
_BEYOND = "the case predicts nothing there"

VALUE_NUMBER = _entry("value_number", "1", "number of the measured value")
QUANTITY = _entry("quantity(value_number)", "1", "what was measured")
SOURCE = _entry("source(value_number)", "1", "table in which it stands")
AXIS = _entry("axis(value_number)", "1", "over what it was measured, with the unit")
AT = _entry("at(value_number)", "1", "where on this axis, in its unit")
UNITS = _entry("unit(value_number)", "1", "unit of both values")
VALUE = _entry("measured(value_number)", "1", "measured value, in this unit; of a complex one its magnitude")
COMPUTED = _entry(
    "computed(value_number)", "1", "computed value, by the main law, in this unit", missing=_BEYOND
)
DEVIATION = _entry("deviation(value_number)", "dB", "level of measured over computed", missing=_BEYOND)
UNCERTAINTY = _entry(
    "deviation_uncertainty(value_number)",
    "dB",
    "standard deviation of that level, by measuring and by the chance of the record that was computed",
    missing=_BEYOND,
)
