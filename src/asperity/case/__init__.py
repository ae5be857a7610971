"""The case: what a person says of a scene, each key declared once; presets, one file and one line each."""

PRESETS: dict[str, str] = {
    "ball-on-beam": "asperity.case.beam.BallOnBeam",
    "wheel-on-rail": "asperity.case.bodies.WheelOnRail",
    "bodies": "asperity.case.bodies.Bodies",
    "ball-bearing": "asperity.case.ball_bearing.BearingUnderLoad",
}
"""Kinds of case by name, each with its module and class."""
