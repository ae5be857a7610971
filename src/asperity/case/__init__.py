"""The case: what a person says of a scene, each key declared once; presets, one file and one line each."""

from asperity import extensions

PRESETS: dict[str, str] = {
    "ball-on-beam": "asperity.case.beam.BallOnBeam",
    "wheel-on-rail": "asperity.case.bodies.WheelOnRail",
    "bodies": "asperity.case.bodies.Bodies",
    "ball-bearing": "asperity.case.ball_bearing.BearingUnderLoad",
    "roller-bearing": "asperity.case.roller_bearing.RollerBearingUnderLoad",
}
"""Kinds of case by name, each with its module and class."""


def kinds() -> dict[str, str]:
    """All kinds of case by name, those of packages beside this one last, each with its module and class.

    What a package names is not imported for that.
    """
    others = {each.name: each.place.replace(":", ".") for each in extensions.offers(extensions.KINDS)}
    return PRESETS | {name: place for name, place in others.items() if name not in PRESETS}
