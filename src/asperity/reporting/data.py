"""Looking into a result tree: what is there, or nothing."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from xarray import DataArray, DataTree

from asperity.results import BASELINES, difference_name
from asperity.spectra import LEAST_PRODUCT, nominal

_PREFIXES = {-12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T"}
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def variable(tree: DataTree, path: str) -> DataArray | None:
    """Variable at `path`, as ``"contact/force"``, or None if it is missing or holds no finite number."""
    group, _, name = path.partition("/")
    if group not in tree.children or name not in tree[group].variables:
        return None
    values: DataArray = tree[group].to_dataset()[name]
    if values.dtype.kind in "fiu" and not np.isfinite(values.values).any():
        return None
    return values


def values(tree: DataTree, path: str, *dims: str) -> NDArray[np.float64]:
    """Numbers at `path`, which must exist, with the dimensions in the order of `dims`.

    A dimension of the variable that is not in `dims` is a fault of the caller.
    """
    found = variable(tree, path)
    if found is None:
        raise KeyError(path)
    return np.asarray((found.transpose(*dims) if dims else found).values, dtype=float)


def present(tree: DataTree, *paths: str) -> bool:
    """Whether every one of `paths` is a variable with at least one finite number."""
    return all(variable(tree, path) is not None for path in paths)


def missing(tree: DataTree, *paths: str) -> str:
    """Say of which of these variables how many values are missing, and why; nothing where none is."""
    told = []
    for path in paths:
        found = variable(tree, path)
        if found is not None and "missing" in found.attrs:
            lost = int((~np.isfinite(found.values)).sum())
            name = found.attrs.get("long_name", path.rpartition("/")[2])
            told.append(f"{lost} of {found.size} values of the {name} are missing: {found.attrs['missing']}.")
    return " ".join(told)


def number(tree: DataTree, group: str, name: str) -> float | None:
    """Finite number in an attribute of a group, or None."""
    found = tree[group].attrs.get(name) if group in tree.children else None
    try:
        result = float(found)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return None
    return result if math.isfinite(result) else None


def entries(attrs: Mapping[Any, Any], name: str, empty: Any) -> Any:
    """JSON text in an attribute, decoded; `empty` if it is missing, damaged or of another kind."""
    try:
        found = json.loads(attrs.get(name, "null"))
    except (TypeError, ValueError):
        return empty
    return found if isinstance(found, type(empty)) else empty


def group_attrs(tree: DataTree, group: str) -> dict[str, Any]:
    """Attributes of a group; none if the group is missing."""
    return {str(k): v for k, v in tree[group].attrs.items()} if group in tree.children else {}


def laws(tree: DataTree, path: str) -> list[str]:
    """Laws that the variable at `path` has finite numbers for, in the order of the case."""
    found = variable(tree, path)
    if found is None:
        return []
    rest = [dim for dim in found.dims if dim != "law"]
    kept = found.notnull().any(rest).values
    return [str(law) for law, keep in zip(found["law"].values, kept, strict=True) if keep]


def of_law(tree: DataTree, path: str, law: str, *dims: str) -> NDArray[np.float64]:
    """Numbers of one law at `path`, with the remaining dimensions in the order of `dims`."""
    found = variable(tree, path)
    if found is None:
        raise KeyError(path)
    row = [str(name) for name in found["law"].values].index(law)
    return np.asarray(found.isel(law=row).transpose(*dims).values, dtype=float)


def baselines(names: Sequence[str]) -> list[str]:
    """Those of the laws `names` that all others are compared with, the one of practice first."""
    return [name for name in BASELINES if name in names]


def differences(tree: DataTree) -> dict[str, str]:
    """Variables of force level differences to the linear laws, with the law each compares with."""
    paths = {f"spectra/{difference_name(name)}": name for name in BASELINES}
    return {path: name for path, name in paths.items() if present(tree, path)}


PRODUCTS = {
    "band": "spectra/band_time_product",
    "noise_band": "spectra/noise_band_time_product",
    "surface_band": "spectra/surface_band_length_product",
}
"""Bandwidth times averaging time, by the dimension of the bands."""


def doubtful(tree: DataTree, dim: str) -> NDArray[np.bool_]:
    """Bands along `dim` whose levels say little, because too few of their waves were averaged."""
    count = tree["spectra"].sizes[dim]
    if not present(tree, PRODUCTS[dim]):
        return np.zeros(count, dtype=bool)
    return values(tree, PRODUCTS[dim], dim) < LEAST_PRODUCT


def sensor_labels(tree: DataTree, path: str) -> list[str]:
    """Labels of the sensors of the variable at `path`: their names if they have any, else their positions."""
    found = variable(tree, path)
    if found is None:
        return []
    for name in ("sensor_label", "label"):
        if name in found.coords:
            return [str(label) for label in found[name].values]
    positions = found["sensor"].values
    return [f"x = {p:g} m" if isinstance(p, float) else str(p) for p in positions.tolist()]


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
