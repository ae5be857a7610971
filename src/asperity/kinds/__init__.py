"""What rolls over what: one folder and one line for each kind of case."""

from __future__ import annotations

from asperity.scenarios.kind import Kind

KINDS: dict[str, Kind] = {
    "ball-on-beam": Kind("asperity.kinds.ball_on_beam"),
    "wheel-on-rail": Kind("asperity.kinds.wheel_on_rail"),
    "bodies": Kind("asperity.kinds.bodies"),
}
