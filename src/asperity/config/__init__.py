"""The case: what is computed, as a TOML file with unit strings and as a frozen object in SI."""

from __future__ import annotations

from importlib import resources

from asperity.config.ball_on_beam import LAWS, BallOnBeamCase
from asperity.config.describing import commented
from asperity.config.parsing import KINDS, load_case, not_a_kind, parse_case

__all__ = ["KINDS", "LAWS", "BallOnBeamCase", "demo_case", "load_case", "parse_case", "template"]

_HEAD = """\
# A ball rolls over a rough beam. Run it with: asperity run CASE
# Every key may be left out, but for kind and a source of texture in [surface]: file, rms, line or spectrum.
# Lines that start with '#' show keys that have no fixed default, or that go with another key.

"""


def template(kind: str) -> str:
    """Write a commented case: every key with its value, what it is, what is allowed and its default.

    Parameters
    ----------
    kind : str
        What rolls: ``"ball-on-beam"``.

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
    return _HEAD + commented(KINDS[kind], {"surface.rms": '"0.5 um"'})


def demo_case() -> BallOnBeamCase:
    """Return the case of ``asperity demo``: synthesised roughness, a few seconds of work."""
    text = resources.files(__name__).joinpath("demo.toml").read_text(encoding="utf-8")
    return parse_case(text, "demo.toml")
