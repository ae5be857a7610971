"""How finely a wheel on a rail is resolved, and what its textures are judged by."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.errors import ComputationError
from asperity.kinds.wheel_on_rail.case import WheelOnRail
from asperity.scenarios.measure import (
    A_WEIGHTED,
    ACCELERATION,
    Measure,
    a_weighted,
    density_of,
    line_frequencies,
)
from asperity.scenarios.refining import Setting, Way
from asperity.scenes import schema
from asperity.schema import spectra
from asperity.structures.rail_poles import POLES


def settings_of(case: WheelOnRail) -> list[Setting]:
    """The kernel itself, which any number of poles can only come near to."""
    if case.numerics.kernel != "poles":
        return [Setting("poles", (), "the rail is scattered from its kernel, without poles")]
    words = f"up to {case.numerics.poles or POLES} → the kernel that they are fitted to"
    scattered = Way(words, {"numerics.kernel": "scatter", "numerics.poles": None})
    return [Setting("poles", (scattered,), scans_kept=True)]


ACCELERATION_REFERENCE = 1e-6
"""Of acceleration levels, m/s²."""


def _sound_power(tree: DataTree, law: str) -> NDArray[np.float64]:
    """Energy of a band, shared out over its lines as the force is: it has no finer spectrum."""
    held = tree[schema.SOUND_POWER_LEVEL.group].to_dataset()
    if schema.SOUND_POWER_LEVEL.name not in held:
        what = "the sound power of rolling is not known"
        raise ComputationError(what, "a rough rail, and bands between 50 Hz and 10 kHz")
    power = held[schema.SOUND_POWER_LEVEL.name].sel(law=law, source="total").values
    centre, frequency = held[schema.NOISE_BAND.name].values, line_frequencies(tree)
    force = density_of(tree, spectra.FORCE_PSD, law)
    step = frequency[1] - frequency[0]
    density = np.zeros_like(force)
    for middle, level in zip(centre, power, strict=True):
        inside = np.abs(np.log10(frequency / middle)) <= 0.05
        if inside.any() and force[inside].sum() > 0.0 and np.isfinite(level):
            density[inside] = 10.0 ** (level / 10.0) * force[inside] / (force[inside].sum() * step)
    return density


def _acceleration(tree: DataTree, law: str) -> NDArray[np.float64]:
    """Of the rail at the points that are passed by."""
    velocity = density_of(tree, schema.POINT_VELOCITY_PSD, law)
    return velocity * (2.0 * np.pi * line_frequencies(tree) / ACCELERATION_REFERENCE) ** 2


MEASURES = {
    A_WEIGHTED: Measure(
        "sound power level of rolling, A-weighted", "dB(A) re 1 pW", a_weighted(_sound_power), ("linear",)
    ),
    ACCELERATION: Measure(
        "acceleration level of the rail at the points passed by, energy mean",
        "dB re 1e-6 m/s²",
        _acceleration,
    ),
}
