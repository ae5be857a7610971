"""How finely bodies on a beam are resolved."""

from __future__ import annotations

from asperity.kinds.bodies.bodies import highest_beam_mode
from asperity.kinds.bodies.case import Bodies
from asperity.scenarios.refining import Setting, Way
from asperity.units import written


def settings_of(case: Bodies) -> list[Setting]:
    """Modes up to twice the frequency, where there are any."""
    if case.over != "beam":
        return []
    before, after = highest_beam_mode(case), 2.0 * highest_beam_mode(case)
    words = f"up to {written(before, 'Hz', 'kHz')} → up to {written(after, 'Hz', 'kHz')}"
    return [Setting("modes", (Way(words, {"beam.modes_up_to": after}),), scans_kept=True)]
