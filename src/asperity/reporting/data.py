"""Looking into a result tree: what is there, or nothing."""

from __future__ import annotations

import json
import math
import re
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import NDArray
from xarray import DataArray, DataTree

from asperity.errors import InputError
from asperity.schema import Attribute, Entry
from asperity.schema.provenance import PARAMETERS
from asperity.schema.rolling import CONTACT
from asperity.schema.spectra import BAND_TIME_PRODUCT, START_SHARE
from asperity.spectra import nominal, say_little
from asperity.units import quantity

SOME = 64
"""Numbers among which a finite one is sought before it is among all."""
_PREFIXES = {-12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T"}
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def stored_variable(tree: DataTree, entry: Entry) -> DataArray | None:
    """Variable of an entry, or None if it is missing or holds no finite number."""
    if entry.group not in tree.children or entry.name not in tree[entry.group].variables:
        return None
    values: DataArray = tree.children[entry.group].dataset[entry.name]
    numbers = values.values.reshape(-1)
    if numbers.dtype.kind in "fiu" and not (np.isfinite(numbers[:SOME]).any() or np.isfinite(numbers).any()):
        return None
    return values


def values(tree: DataTree, entry: Entry, *dims: str) -> NDArray[np.float64]:
    """Numbers of an entry, which must exist, with the dimensions in the order of `dims`.

    A dimension of the variable that is not in `dims` is a fault of the caller.
    """
    found = stored_variable(tree, entry)
    if found is None:
        raise KeyError(entry.path)
    return np.asarray((found.transpose(*dims) if dims else found).values, dtype=float)


def present(tree: DataTree, *entries: Entry) -> bool:
    """Whether every one of `entries` is a variable with at least one finite number."""
    return all(stored_variable(tree, entry) is not None for entry in entries)


def missing(tree: DataTree, *entries: Entry) -> str:
    """Say of which of these variables values are missing, and why; nothing where none is."""
    found = [variable for entry in entries if (variable := stored_variable(tree, entry)) is not None]
    return " ".join(
        f"Gaps in the {variable.attrs['long_name'].replace(': ', ', ')}: {variable.attrs['missing']}."
        for variable in found
        if "missing" in variable.attrs
    )


def stated(tree: DataTree, attribute: Attribute) -> Any:
    """Value of an attribute, or None."""
    known = not attribute.group or attribute.group in tree.children
    node = tree[attribute.group] if known and attribute.group else tree
    return node.attrs.get(attribute.name) if known else None


def number(tree: DataTree, attribute: Attribute) -> float | None:
    """Finite number in an attribute, or None."""
    try:
        result = float(stated(tree, attribute))
    except (TypeError, ValueError):
        return None
    return result if math.isfinite(result) else None


def case_quantity(tree: DataTree, key: str, dimension: str) -> float | None:
    """Finite value of a key of the case in SI units, ``"m"`` or another, or None."""
    for item in json_list(tree, PARAMETERS):
        if item.get("key") == key:
            with suppress(InputError):
                found = quantity(str(item.get("value", "")), dimension)
                return found if math.isfinite(found) else None
    return None


def case_words(tree: DataTree, key: str) -> str:
    """Value of a key of the case in words; nothing where it is unknown."""
    found = (item.get("value", "") for item in json_list(tree, PARAMETERS) if item.get("key") == key)
    return str(next(found, ""))


def json_attribute(tree: DataTree, attribute: Attribute, empty: Any) -> Any:
    """JSON text in an attribute, decoded; `empty` if it is missing, damaged or of another kind."""
    try:
        found = json.loads(stated(tree, attribute))
    except (TypeError, ValueError):
        return empty
    return found if isinstance(found, type(empty)) else empty


def json_list(tree: DataTree, attribute: Attribute) -> list[dict[str, Any]]:
    """Entries of a list in an attribute, each a mapping; none if it is missing or damaged."""
    return [entry for entry in json_attribute(tree, attribute, []) if isinstance(entry, dict)]


def laws(tree: DataTree, entry: Entry) -> list[str]:
    """Laws that a variable has finite numbers for, in the order of the case."""
    found = stored_variable(tree, entry)
    if found is None:
        return []
    rest = [dim for dim in found.dims if dim != "law"]
    kept = found.notnull().any(rest).values
    return [str(law) for law, keep in zip(found["law"].values, kept, strict=True) if keep]


def of_law(tree: DataTree, entry: Entry, law: str, *dims: str) -> NDArray[np.float64]:
    """Numbers of one law, with the remaining dimensions in the order of `dims`; by default of contact 1."""
    found = stored_variable(tree, entry)
    if found is None:
        raise KeyError(entry.path)
    row = [str(name) for name in found["law"].values].index(law)
    of_first = {} if CONTACT.name in dims else {CONTACT.name: 0}
    one = found.isel({"law": row} | of_first, missing_dims="ignore")
    return np.asarray(one.transpose(*dims).values, dtype=float)


def doubtful(tree: DataTree, product: Entry) -> NDArray[np.bool_]:
    """Bands whose levels say little: the `product` of bandwidth and averaging time is small.

    Of force levels also those that still hold the start of the record.
    """
    (dim,) = product.dims
    if not present(tree, product):
        return np.zeros(tree[product.group].sizes[dim], dtype=bool)
    known = product is BAND_TIME_PRODUCT and present(tree, START_SHARE)
    start = values(tree, START_SHARE) if known else 0.0
    return np.asarray(say_little(values(tree, product, dim), start))


def engineering(value: float, unit: str, digits: int = 3) -> str:
    """Write `value`, in the SI `unit`, with a prefix: ``engineering(3.1e-7, "m")`` is ``"310 nm"``."""
    if not math.isfinite(value):
        return "–"
    if unit in ("", "1"):
        return plain(value, digits)
    if unit == "rad":
        return f"{math.degrees(value):.0f}°"
    power = 2 if unit == "m²" else 1  # a prefix on a squared unit is squared with it
    value += 0.0  # no minus before zero
    exponent = 0 if value == 0 else 3 * math.floor(math.floor(math.log10(abs(value))) / (3 * power))
    exponent = min(max(exponent, -12 if power == 1 else -9), 0 if power == 2 else 12)
    scaled = value / 10.0 ** (exponent * power)
    places = 0 if scaled == 0 else max(0, digits - 1 - math.floor(math.log10(abs(scaled))))
    return f"{scaled:.{places}f} {_PREFIXES[exponent]}{unit}".replace("-", "−")


def plain(value: float, digits: int = 3) -> str:
    """Write a number with `digits` digits and a true minus sign."""
    return f"{value:.{digits}g}".replace("-", "−")


def written_units(units: str) -> str:
    """Units of a variable as a reader writes them."""
    return units.replace("uPa", "µPa").replace("m/s2", "m/s²").replace("1e-6 m", "1 µm")


def force_unit(largest: float) -> tuple[float, str]:
    """Unit in which forces up to `largest` N read well: its size in N and its symbol."""
    return (1e3, "kN") if largest >= 5e3 else (1.0, "N")


def power_of_ten(value: float) -> str:
    """Write a power of ten with superscripts: ``"10⁻¹⁶"``."""
    return "10" + str(round(math.log10(value))).translate(_SUPERSCRIPT)


def nominal_band(centre: float) -> str:
    """Nominal name of the one-third octave with the exact `centre` in Hz (IEC 61260-1), as ``"31.5"``."""
    name = nominal(centre)
    return f"{name / 1000:g}k" if name >= 1000 else f"{name:g}"


TYPED_UNIT = "typed_unit"
"""Attribute of a coordinate: the unit in which the values of a swept key were written, where it is no SI."""
TYPED_FACTOR = "typed_factor"
"""The same unit in SI."""


def typed_unit(key: DataArray) -> str:
    """Unit of a swept key as it was typed; empty for words."""
    return "" if key.dtype.kind == "U" else str(key.attrs.get(TYPED_UNIT, key.attrs["units"]))


def typed_values(key: DataArray) -> list[Any]:
    """Values of a swept key in the unit in which they were typed."""
    size = float(key.attrs.get(TYPED_FACTOR, 1.0))
    values = key.values.tolist()
    if key.dtype.kind == "U" or size == 1.0:
        return list(values)
    return [float(f"{value / size:.12g}") for value in values]


def typed_words(key: DataArray) -> list[str]:
    """Values of a swept key in words, each with its unit: ``"50 km/h"``."""
    unit = typed_unit(key).removesuffix("1")
    return [value if isinstance(value, str) else f"{value:.6g} {unit}".strip() for value in typed_values(key)]


def moment(instant: object) -> str:
    """A moment of ISO 8601 in universal time as people write it; other words as they are."""
    words = str(instant or "")
    found = re.fullmatch(r"(\d{4}-\d\d-\d\d)T(\d\d:\d\d):\d\d\+00:00", words)
    return f"{found[1]}, {found[2]} UTC" if found else words
