"""How finely a ball on a beam is resolved, and what its textures are judged by."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.kinds.ball_on_beam.bodies import highest_mode
from asperity.kinds.ball_on_beam.case import BallOnBeam
from asperity.scenarios.measure import A_WEIGHTED, ACCELERATION, Measure, a_weighted, density_of
from asperity.scenarios.refining import Setting, Way
from asperity.scenes import schema
from asperity.units import written


def settings_of(case: BallOnBeam) -> list[Setting]:
    """Modes up to twice the frequency."""
    before, after = highest_mode(case), 2.0 * highest_mode(case)
    words = f"up to {written(before, 'Hz', 'kHz')} → up to {written(after, 'Hz', 'kHz')}"
    return [Setting("modes", (Way(words, {"beam.modes_up_to": after}),), scans_kept=True)]


_MEANING = "acceleration level of the beam, energy mean over its sensors"


def _acceleration(tree: DataTree, law: str) -> NDArray[np.float64]:
    return density_of(tree, schema.ACCELERATION_PSD, law) / schema.ACCELERATION_REFERENCE**2


MEASURES = {
    A_WEIGHTED: Measure(f"{_MEANING}, A-weighted", "dB(A) re 1e-6 m/s²", a_weighted(_acceleration)),
    ACCELERATION: Measure(_MEANING, "dB re 1e-6 m/s²", _acceleration),
}
