"""One variable, or one attribute, of a result file: said once, for who writes it and for who draws it."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from asperity.errors import Grade, PhysicsWarning

if TYPE_CHECKING:
    import xarray
    from numpy.typing import ArrayLike

UNKNOWN = "no reason is known"


@dataclass(frozen=True)
class Entry:
    """A variable of a result file.

    Attributes
    ----------
    group, name : str
        Where it stands, and what it is called there.
    dims : tuple of str
        Its dimensions; those of a coordinate are its own name.
    units : str
        In SI; ``"1"`` for a pure number, ``"dB re 1 N"`` for a level.
    long_name : str
        What it is.
    condition : str
        Which results have it, where not all have.
    missing : str
        Why values may be missing (NaN).
    attributes : tuple of str
        What else is said of it.
    """

    group: str
    name: str
    dims: tuple[str, ...]
    units: str
    long_name: str
    condition: str = ""
    missing: str = ""
    attributes: tuple[str, ...] = ()

    @property
    def path(self) -> str:
        """As ``"contact/force"``."""
        return f"{self.group}/{self.name}"

    def variable(self, values: ArrayLike, **attributes: Any) -> xarray.Variable:
        """Make the variable; what is not a finite number is missing, and the variable says why."""
        import xarray

        found = np.asarray(values)
        attrs = {"units": self.units, "long_name": self.long_name} | attributes
        if found.dtype.kind == "f" and not (finite := np.isfinite(found)).all():
            attrs.setdefault("missing", self.missing or UNKNOWN)
            if attrs["missing"] == UNKNOWN:
                lost = f"{found.size - finite.sum()} of {found.size} values of {self.name}"
                told = PhysicsWarning(f"{lost} are not finite numbers, and {UNKNOWN}", Grade.OUT)
                warnings.warn(told, stacklevel=2)
            found = np.where(finite, found, np.nan)
        return xarray.Variable(self.dims, found, attrs)


@dataclass(frozen=True)
class Attribute:
    """An attribute of a group of a result file, or of its root.

    Attributes
    ----------
    group, name : str
        Where it stands (``""``: at the root), and what it is called there.
    units : str
        In SI; ``"text"``, or ``"JSON"`` for what is laid out as that.
    meaning : str
        What it is.
    condition : str
        Which results have it, where not all have.
    """

    group: str
    name: str
    units: str
    meaning: str
    condition: str = ""


def variables(values: Mapping[Entry, Any]) -> dict[str, xarray.Variable]:
    """Variables by name, of one group: arrays are laid out, variables taken as they are."""
    import xarray

    return {
        entry.name: found if isinstance(found, xarray.Variable) else entry.variable(found)
        for entry, found in values.items()
    }


def attributes(values: Mapping[Attribute, Any]) -> dict[str, Any]:
    """Attributes by name, of one group."""
    return {attribute.name: value for attribute, value in values.items()}
