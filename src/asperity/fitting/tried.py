"""A case with values that a fit tries, and what is predicted of it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from asperity.case.any_case import AnyCase
from asperity.case.form import Section, case_key
from asperity.errors import PhysicsWarning
from asperity.observables import collected_of
from asperity.observables.observable import Collected
from asperity.progress import Progress, which_of
from asperity.running import run
from asperity.store import Store, made

RUN_FORMAT = 3
"""Raise it when what is kept of a run no longer means what it meant."""


@dataclass(eq=False)
class FitRuns:
    """Runs of a fit: how many there were, and how many there are at most.

    Parameters
    ----------
    progress : callable
        Called while a case is run, and told which run of how many at most it is.
    done, most : int
        Runs that were begun, and all that there are at most.
    """

    progress: Progress = lambda *_: None
    done: int = 0
    most: int = 1

    def begun(self) -> Progress:
        """Begin the next run: what is to be called during it."""
        self.done += 1
        which = which_of("run", self.done, max(self.most, self.done))
        return lambda done, total, message: self.progress(done, total, f"{which}{message}")


@dataclass(frozen=True, eq=False)
class TriedCase:
    """A case with values that a fit tries.

    Parameters
    ----------
    base : AnyCase
        The case that is fitted.
    changes : mapping
        Dotted keys with their values, in SI; None takes a key out.
    fine : bool
        Whether bands are resolved as in a report, or enough to search.
    runs : FitRuns
        Runs of the fit, of which its own is one.
    """

    base: AnyCase
    changes: Mapping[str, Any]
    fine: bool = True
    runs: FitRuns = field(default_factory=FitRuns)

    @cached_property
    def case(self) -> AnyCase:
        """The case, whose changed sections alone are made anew; keys that are right are not read again."""
        by_section: dict[str, dict[str, Any]] = {}
        for dotted, value in self.changes.items():
            title, _, name = dotted.rpartition(".")
            by_section.setdefault(title, {})[name] = value
        top = by_section.pop("", {})
        sections = {
            title: _section(self.base, title).with_known(**each) for title, each in by_section.items()
        }
        return self.base.with_known(**top, **sections)

    @cached_property
    def whole(self) -> AnyCase:
        """The case, read as a whole: what follows from other keys is chosen anew. Its main law alone runs."""
        return self.base.with_(**{"laws": self.base.laws[:1], **self.changes})

    @cached_property
    def collected(self) -> Collected:
        """What a run of it gives of all that is measured, kept by all that it depends on."""

        def ran() -> Collected:
            return collected_of(run(self.whole, self.runs.begun(), brief=True))

        with PhysicsWarning.ignored():
            return made(Store(), case_key("run-of-a-fit", RUN_FORMAT, self.whole), ran)


def _section(case: AnyCase, title: str) -> Section:
    found: Section = getattr(case, title)
    return found
