"""What a package beside this one looks at in a run: entries of the result, and a function that finds them."""

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

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
        for function in (self.observe, self.asked_of):
            require(callable(function), what, shown(function), "a function of what was computed")
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
        strange = [shown(each) for each in found if each not in self.entries]
        require(not strange, f"observer {self.name}", ", ".join(strange), "entries that it declares")
        return found


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
