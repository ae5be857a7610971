"""How finely the beam of a case is resolved, beside what all kinds of case have."""

from __future__ import annotations

from asperity.kinds.ball_on_beam.bodies import highest_mode
from asperity.kinds.ball_on_beam.case import BallOnBeam
from asperity.scenarios.refining import Setting, Way
from asperity.units import written


def settings_of(case: BallOnBeam) -> list[Setting]:
    """Modes up to twice the frequency."""
    before, after = highest_mode(case), 2.0 * highest_mode(case)
    words = f"up to {written(before, 'Hz', 'kHz')} → up to {written(after, 'Hz', 'kHz')}"
    return [Setting("modes", (Way(words, {"beam.modes_up_to": after}),), scans_kept=True)]
