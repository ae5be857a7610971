"""How finely bodies on a beam are resolved, and what their textures are judged by."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.kinds.bodies.bodies import highest_beam_mode
from asperity.kinds.bodies.case import Bodies
from asperity.scenarios.measure import A_WEIGHTED, Measure, a_weighted, density_of
from asperity.scenarios.refining import Setting, Way
from asperity.scenes import schema
from asperity.units import written


def settings_of(case: Bodies) -> list[Setting]:
    """Modes up to twice the frequency, where there are any."""
    if case.over != "beam":
        return []
    before, after = highest_beam_mode(case), 2.0 * highest_beam_mode(case)
    words = f"up to {written(before, 'Hz', 'kHz')} → up to {written(after, 'Hz', 'kHz')}"
    return [Setting("modes", (Way(words, {"beam.modes_up_to": after}),), scans_kept=True)]


def _force(tree: DataTree, law: str) -> NDArray[np.float64]:
    return density_of(tree, schema.FORCE_PSDS, law)


MEASURES = {
    A_WEIGHTED: Measure(
        "contact force level, energy mean over the contacts, A-weighted", "dB(A) re 1 N", a_weighted(_force)
    ),
}
