"""Any two bodies."""

from __future__ import annotations

from dataclasses import dataclass

from asperity.rolling.bodies import RolledOver, Rolls


@dataclass(frozen=True, eq=False)
class Bodies:
    """What is rolled over, and what rolls."""

    over: RolledOver
    rolls: Rolls
