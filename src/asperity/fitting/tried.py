"""A case with values that a fit tries, and what is predicted of it."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from asperity.case.any_case import AnyCase
from asperity.case.form import Section, case_key
from asperity.errors import PhysicsWarning
from asperity.observables import collected_of
from asperity.observables.observable import Collected
from asperity.progress import Progress
from asperity.running import run
from asperity.store import Store, made

RUN_FORMAT = 2
"""Raise it when what is kept of a run no longer means what it meant."""


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
    progress : callable
        Called while it is run.
    """

    base: AnyCase
    changes: Mapping[str, Any]
    fine: bool = True
    progress: Progress = lambda *_: None

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
            return collected_of(run(self.whole, self.progress, brief=True))

        with PhysicsWarning.ignored():
            return made(Store(), case_key("run-of-a-fit", RUN_FORMAT, self.whole), ran)


def _section(case: AnyCase, title: str) -> Section:
    found: Section = getattr(case, title)
    return found
