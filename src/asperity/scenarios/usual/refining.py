"""Settings of its own that a kind of case can be computed with more finely: none."""

from __future__ import annotations

from asperity.config.case import Case
from asperity.scenarios.refining import Setting


def settings_of(case: Case) -> list[Setting]:
    """List them."""
    return []
