"""How far a result depends on how finely it was computed."""

from functools import partial

from asperity.schema import Attribute, Entry

_ASKED = "where convergence was asked for"
_entry = partial(Entry, "convergence", condition=_ASKED)
_changed = partial(_entry, missing="this setting was not changed, or changes nothing of the kind")

PATH_LENGTH = "path length"
"""The setting that needs no other run: half of the record is compared with all; by chance they differ."""

MEANINGLESS = 3.0
"""Change of levels, dB, from which on a run has not come near to what it computes."""


def meaningless(size: float, chance: float) -> bool:
    """Whether a change of levels, dB, says that they mean nothing: large, and twice what chance does, dB.

    Chance is the change by half of the record; none if it is not known (NaN).
    """
    return size > MEANINGLESS and not size <= 2.0 * chance


SETTING = _entry("setting", "1", "setting that was changed")
CHANGE = _entry("change(setting)", "1", "from what to what")
LIMIT = _entry("limit(setting)", "1", "why it was not changed; empty where it was")
LAW = _entry("law", "1", "contact law")
BAND = _entry("band", "Hz", "one-third-octave band centre")
_OVER = "of the finer computation over that of the coarser"
FORCE_LEVEL_CHANGE = _changed("force_level_change(setting, law, band)", "dB", f"contact force level {_OVER}")
MOTION_LEVEL_CHANGE = _changed(
    "motion_level_change(setting, law, band)",
    "dB",
    f"level of the recorded motion, energy mean over its places, {_OVER}",
    attributes=("quantity",),
)
STIFFNESS_CHANGE = _changed("stiffness_change(setting)", "1", f"mean contact stiffness {_OVER}, less one")
LARGEST_CHANGE = _changed(
    "largest_change(setting)",
    "dB",
    "largest size of the change of the main law's force level, 100 Hz to 5 kHz, bands that say something",
)
LARGEST_BAND = _changed("largest_band(setting)", "Hz", "band of it")

SENTENCE = Attribute("convergence", "verdict", "text", "which setting matters most, and how much", _ASKED)
