"""Tables of what was measured, beside which the report states what was computed."""

from pathlib import Path

from asperity.case.form import Section
from asperity.parameters import File, optional

_WITHOUT = "nothing was measured"


def _table(of: str, example: str) -> Path | None:
    """Declare a key that names a table, as `asperity fit` reads it."""
    kind = File(content="a table, relative to the case, with units in its heading")
    found: Path | None = optional(
        kind, example, f"{of}, beside which the report states what was computed", _WITHOUT
    )
    return found


class MeasuredKeys(Section):
    """What was measured of bodies that roll: the report says how far it is from what was computed."""

    force_level: Path | None = _table("levels of the contact force in one-third octaves", "force.csv")
    acceleration_level: Path | None = _table(
        "levels of the acceleration in one-third octaves, mean of all accelerometers",
        "acceleration.csv",
    )
    mobility: Path | None = _table("mobility, accelerance or receptance of what is rolled over", "hammer.csv")
    contact_stiffness: Path | None = _table("stiffnesses of the contact over its load", "stiffness.csv")


class MeasuredBearingKeys(Section):
    """What was measured at a bearing: the report says how far it is from what was computed."""

    tone: Path | None = _table("tones of raceways, of what rolls or of the cage", "tones.csv")
    band_velocity: Path | None = _table("velocities of the outer ring in bands of ISO 15242", "velocity.csv")
    envelope_line: Path | None = _table("amplitudes of lines of the envelope", "lines.csv")
