"""The quantities that textures under a ball are judged by: acceleration of the beam."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.kinds.ball_on_beam import schema
from asperity.scenarios.measure import A_WEIGHTED, ACCELERATION, Measure, a_weighted, density_of

_MEANING = "acceleration level of the beam, energy mean over its sensors"


def _acceleration(tree: DataTree, law: str) -> NDArray[np.float64]:
    return density_of(tree, schema.ACCELERATION_PSD, law) / schema.ACCELERATION_REFERENCE**2


MEASURES = {
    A_WEIGHTED: Measure(f"{_MEANING}, A-weighted", "dB(A) re 1e-6 m/s²", a_weighted(_acceleration)),
    ACCELERATION: Measure(_MEANING, "dB re 1e-6 m/s²", _acceleration),
}
