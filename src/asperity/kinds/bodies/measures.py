"""The quantities that textures under bodies are judged by: their contact forces, together."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.kinds.bodies import schema
from asperity.scenarios.measure import A_WEIGHTED, Measure, a_weighted, density_of


def _force(tree: DataTree, law: str) -> NDArray[np.float64]:
    return density_of(tree, schema.FORCE_PSDS, law)


MEASURES = {
    A_WEIGHTED: Measure(
        "contact force level, energy mean over the contacts, A-weighted", "dB(A) re 1 N", a_weighted(_force)
    ),
}
