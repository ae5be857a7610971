"""How far a result depends on how finely it was computed."""

from __future__ import annotations

from functools import partial

from asperity.schema.entry import Attribute, Entry

_ASKED = "where convergence was asked for"
_entry = partial(Entry, "convergence", condition=_ASKED)
_NOT_COMPARED = "this setting was not changed, or changes nothing of the kind"

PATH_LENGTH = "path length"
"""The setting that needs no other run: half of the record is compared with all; by chance they differ."""

MEANINGLESS = 3.0
"""Change of levels, dB, from which on a run has not come near to what it computes."""


def meaningless(size: float, chance: float) -> bool:
    """Whether a change of levels, dB, says that they mean nothing: large, and twice what chance does, dB.

    Chance is the change by half of the record; none if it is not known (NaN).
    """
    return size > MEANINGLESS and not size <= 2.0 * chance


SETTING = _entry("setting", ("setting",), "1", "setting that was changed")
CHANGE = _entry("change", ("setting",), "1", "from what to what")
LIMIT = _entry("limit", ("setting",), "1", "why it was not changed; empty where it was")
LAW = _entry("law", ("law",), "1", "contact law")
BAND = _entry("band", ("band",), "Hz", "one-third-octave band centre")
FORCE_LEVEL_CHANGE = _entry(
    "force_level_change",
    ("setting", "law", "band"),
    "dB",
    "contact force level of the finer computation over that of the coarser",
    missing=_NOT_COMPARED,
)
MOTION_LEVEL_CHANGE = _entry(
    "motion_level_change",
    ("setting", "law", "band"),
    "dB",
    "level of the recorded motion, energy mean over its places, of the finer computation over that of the "
    "coarser",
    missing=_NOT_COMPARED,
    attributes=("quantity",),
)
STIFFNESS_CHANGE = _entry(
    "stiffness_change",
    ("setting",),
    "1",
    "mean contact stiffness of the finer computation over that of the coarser, less one",
    missing=_NOT_COMPARED,
)
LARGEST_CHANGE = _entry(
    "largest_change",
    ("setting",),
    "dB",
    "largest size of the change of the main law's force level, 100 Hz to 5 kHz, bands that say something",
    missing=_NOT_COMPARED,
)
LARGEST_BAND = _entry("largest_band", ("setting",), "Hz", "band of it", missing=_NOT_COMPARED)

SENTENCE = Attribute("convergence", "verdict", "text", "which setting matters most, and how much", _ASKED)
