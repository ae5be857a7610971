"""The case: what is computed, as a TOML file with unit strings and as a frozen object in SI."""

from __future__ import annotations

from importlib import resources

from asperity.config.ball_on_beam import BallOnBeamCase
from asperity.config.case import LAWS, Case
from asperity.config.describing import commented
from asperity.config.parsing import KINDS, as_case, case_of, load_case, not_a_kind, parse_case
from asperity.config.wheel_on_rail import WheelOnRailCase

__all__ = [
    "KINDS",
    "LAWS",
    "BallOnBeamCase",
    "Case",
    "WheelOnRailCase",
    "as_case",
    "case_of",
    "demo_case",
    "load_case",
    "parse_case",
    "template",
]

_HEAD = """\
# {title} Run it with: asperity run CASE
# Every key may be left out, but for kind and a source of texture{source}.
# Lines that start with '#' show keys that have no fixed default, or that go with another key.

"""
_TITLES = {
    "ball-on-beam": "A ball rolls over a rough beam.",
    "wheel-on-rail": "A wheel rolls on an infinite track.",
}
_SOURCES = {
    "ball-on-beam": " in [surface]: file, rms, line or spectrum",
    "wheel-on-rail": ", of rail or wheel, or smooth = true",
}
_WRITTEN_OUT = {
    "ball-on-beam": {"surface.rms": '"0.5 um"'},
    "wheel-on-rail": {"surface.spectrum": '"iso3095"', "wheel.roughness": '"disc"'},
}


def template(kind: str) -> str:
    """Write a commented case: every key with its value, what it is, what is allowed and its default.

    Parameters
    ----------
    kind : str
        What rolls: ``"ball-on-beam"`` or ``"wheel-on-rail"``.

    Returns
    -------
    str
        A valid case in TOML.

    Raises
    ------
    InputError
        If there is no such kind.
    """
    if kind not in KINDS:
        raise not_a_kind(kind)
    head = _HEAD.format(title=_TITLES[kind], source=_SOURCES[kind])
    return head + commented(KINDS[kind], _WRITTEN_OUT[kind])


def demo_case() -> Case:
    """Return the case of ``asperity demo``: synthesised roughness, a few seconds of work."""
    text = resources.files(__name__).joinpath("demo.toml").read_text(encoding="utf-8")
    return parse_case(text, "demo.toml")
