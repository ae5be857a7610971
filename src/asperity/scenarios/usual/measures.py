"""The quantities that textures are judged by, where a kind names none: the contact force."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.scenarios.measure import A_WEIGHTED, Measure, a_weighted, density_of
from asperity.schema import spectra


def _force(tree: DataTree, law: str) -> NDArray[np.float64]:
    return density_of(tree, spectra.FORCE_PSD, law)


MEASURES = {
    A_WEIGHTED: Measure("contact force level, A-weighted", "dB(A) re 1 N", a_weighted(_force)),
}
