"""What a package beside this one looks at in a run: entries of the result, and a function that finds them."""

import json
import re
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray

from asperity import extensions
from asperity.arguments import require, shown
from asperity.errors import InputError, reason
from asperity.scenes.compute import Computed
from asperity.schema import Attribute, Entry, Values


def _everywhere(computed: Computed) -> bool:
    """Every run has what is looked at."""
    return True


@dataclass(frozen=True)
class Observer:
    """What is looked at in each run that has what it takes, and laid out in its result.

    Parameters
    ----------
    name : str
        Group of the result in which its entries stand.
    entries : sequence of Entry and Attribute
        All that it may lay out, each with its dimensions, unit and meaning.
    observe : callable
        ``observe(computed)`` returns values of some of them, by entry, of a run: its case, its scene, its
        records in time by law (`asperity.scenes.compute.Computed`).
    asked_of : callable
        ``asked_of(computed)`` says whether a run has what it takes.
    sources : sequence of str
        What its method is cited by.

    Raises
    ------
    InputError
        If any of it is wrong.
    """

    name: str
    entries: Sequence[Entry | Attribute]
    observe: Callable[[Computed], Values]
    asked_of: Callable[[Computed], bool] = _everywhere
    sources: Sequence[str] = ()

    def __post_init__(self) -> None:
        what = f"observer {self.name}"
        word = isinstance(self.name, str) and re.fullmatch(r"\w+", self.name)
        require(word, "name of an observer", shown(self.name), "letters, digits and underscores")
        for function in (self.observe, self.asked_of):
            require(callable(function), what, shown(function), "a function of what was computed")
        cited = not isinstance(self.sources, str) and all(isinstance(each, str) for each in self.sources)
        require(cited, f"sources of {what}", shown(self.sources), "a list of texts")
        elsewhere = sorted({each.group for each in self.entries if each.group != self.name})
        require(self.entries, what, "no entry", "what it lays out, as asperity.schema.Entry")
        allowed = f'entries of the group "{self.name}"'
        require(not elsewhere, what, ", ".join(elsewhere), allowed)

    def values(self, computed: Computed) -> Values:
        """Look at a run; an `InputError` says what is wrong with what was found."""
        try:
            found = self.observe(computed) if self.asked_of(computed) else {}
        except Exception as error:  # the run is not lost for it
            received = f"a failure, {reason(error)}"
            raise InputError(f"observer {self.name}", received, "values of its entries") from error
        what = f"observer {self.name}"
        require(isinstance(found, Mapping), what, shown(found), "values by its entries, as a dict")
        strange = [shown(each) for each in found if each not in self.entries]
        require(not strange, what, ", ".join(strange), "entries that it declares")
        return _fitting(what, found)


def _fitting(observer: str, found: Mapping[Entry | Attribute, Any]) -> Values:
    """Make what an observer found ready to be written, or say by an `InputError` what does not fit."""
    made = {item: _written(item, value, observer) for item, value in found.items()}
    variables = {item: value for item, value in made.items() if isinstance(item, Entry)}
    sizes: dict[str, int] = {}
    for entry in sorted(variables, key=lambda item: item.place != item.name):  # coordinates first
        shape = variables[entry].shape
        allowed = ", ".join(f"{name}: {sizes.get(name, 'any size')}" for name in entry.dims)
        fits = all(sizes.setdefault(*each) == each[1] for each in zip(entry.dims, shape, strict=True))
        require(fits, f"{entry.place} of {observer}", f"the shape {shape}", f"dimensions ({allowed})")
    return made


def _written(item: Entry | Attribute, value: Any, observer: str) -> Any:
    """Make one value as a result file holds it."""
    what = f"{item.place if isinstance(item, Entry) else item.name} of {observer}"
    try:
        if isinstance(item, Attribute) and item.units == "JSON":
            json.dumps(value)
            return value
        values = np.asarray(value)
    except (TypeError, ValueError) as error:  # of what JSON does not know; of lists of unequal lengths
        raise InputError(what, f"a failure, {reason(error)}", "one array, or what JSON holds") from error
    words = values.dtype.kind == "U" or (values.dtype.kind == "O" and _are_words(values))
    require(words or values.dtype.kind in "biuf", what, f"values of {values.dtype}", "real numbers, or texts")
    if isinstance(item, Attribute):
        require(values.ndim < 2, what, shown(values), "one number or text, or a list of them")
        return value
    made = isinstance(value, xarray.Variable | xarray.DataArray)
    names = value.dims if made else item.dims
    received = f"dimensions ({', '.join(map(str, names))})" if made else f"the shape {values.shape}"
    fits = values.ndim == len(item.dims) and tuple(names) == item.dims
    require(fits, what, received, f"dimensions ({', '.join(item.dims)})")
    return item.variable(values, **(value.attrs if made else {}))


def _are_words(values: np.ndarray[Any, Any]) -> bool:
    return all(isinstance(each, str) for each in values.flat)


def observers() -> dict[str, Observer]:
    """Observers of packages beside this one, by name."""
    return extensions.taken(extensions.OBSERVERS, _installed)


def _installed(name: str, observer: Any) -> Observer:
    allowed = "an asperity.scenes.observer.Observer"
    require(isinstance(observer, Observer), f'observer "{name}"', shown(observer), allowed)
    assert isinstance(observer, Observer)
    require(
        observer.name == name, "name of the observer", shown(observer.name), f'"{name}", as its entry point'
    )
    return observer


def observed(computed: Computed, others: Values) -> tuple[Values, tuple[str, ...]]:
    """Lay out what observers find in a run, beside all `others` in its result, and the sources of that.

    One that fails is named in a warning, and left out.
    """
    laid_out: Values = {}
    sources: list[str] = []
    groups = {item.group for item in others}
    for observer in observers().values():
        try:
            allowed = f"a group of its own, none of {', '.join(sorted(groups))}"
            require(observer.name not in groups, "group of the observer", observer.name, allowed)
            found = observer.values(computed)
        except InputError as error:
            warnings.warn(extensions.ExtensionWarning(f"{error} It is left out."), stacklevel=2)
            continue
        laid_out |= found
        sources += observer.sources if found else ()
    return laid_out, tuple(sources)
