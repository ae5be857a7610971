"""How finely the track of a case is resolved, beside what all kinds of case have."""

from __future__ import annotations

from asperity.kinds.wheel_on_rail.case import WheelOnRail
from asperity.scenarios.refining import Setting, Way
from asperity.structures.rail_poles import POLES


def settings_of(case: WheelOnRail) -> list[Setting]:
    """Twice as many poles, or half as many where the kernel has too few lags."""
    if case.numerics.kernel != "poles":
        return [Setting("poles", (), "the rail is scattered from its kernel, without poles")]
    count = case.numerics.poles or POLES
    ways = [Way(f"{count} → {n}", {"numerics.poles": n}) for n in (2 * count, count // 4 * 2)]
    return [Setting("poles", tuple(ways), scans_kept=True)]
