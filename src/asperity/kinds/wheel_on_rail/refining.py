"""How finely the track of a case is resolved, beside what all kinds of case have."""

from __future__ import annotations

from asperity.kinds.wheel_on_rail.case import WheelOnRail
from asperity.scenarios.refining import Setting, Way
from asperity.structures.rail_poles import POLES


def settings_of(case: WheelOnRail) -> list[Setting]:
    """The kernel itself, which any number of poles can only come near to."""
    if case.numerics.kernel != "poles":
        return [Setting("poles", (), "the rail is scattered from its kernel, without poles")]
    words = f"up to {case.numerics.poles or POLES} → the kernel that they are fitted to"
    scattered = Way(words, {"numerics.kernel": "scatter", "numerics.poles": None})
    return [Setting("poles", (scattered,), scans_kept=True)]
