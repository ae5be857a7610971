"""Values that a result does not have are marked as such, with the reason."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import xarray

from asperity.errors import Grade, PhysicsWarning

NO_SIGNAL = "there is no signal in these bands, and nothing has no level"
NO_FILTER = "the samples do not touch in these states, or have no waves of these lengths"
REASONS = {
    "psd_path": "the path is shorter than these waves",
    "decay_rate_limit": "the standard sets no limit at these frequencies",
    "roughness_level": "this part has no roughness of these wavelengths",
    "roughness_limit": "the standard sets no limit at these wavelengths",
    "sound_power_level": "this source radiates nothing in these bands, or its method does not reach them",
}
"""Why a variable may lack values, by its name; others are filters, or levels without a signal."""
UNKNOWN = "no reason is known"


def marked(group: xarray.Dataset) -> xarray.Dataset:
    """Mark what is not a finite number.

    Parameters
    ----------
    group : xarray.Dataset
        A group of a result.

    Returns
    -------
    xarray.Dataset
        Infinite values are missing (NaN) as well; variables that lack values say why in their attribute
        ``missing``.

    Warns
    -----
    PhysicsWarning
        If no reason is known.
    """
    changed: dict[str, Any] = {}
    for key, values in group.data_vars.items():
        if values.dtype.kind != "f" or np.isfinite(values.values).all():
            continue
        name = str(key)
        level = str(values.attrs.get("units", "")).startswith("dB")
        reason = REASONS.get(name, NO_FILTER if "filter" in name else NO_SIGNAL if level else UNKNOWN)
        if reason == UNKNOWN:
            lost = int((~np.isfinite(values.values)).sum())
            message = f"{lost} of {values.size} values of {name} are not finite numbers, and {reason}"
            warnings.warn(PhysicsWarning(message, Grade.OUT), stacklevel=2)
        finite = values.where(np.isfinite(values))
        changed[name] = finite.assign_attrs(values.attrs | {"missing": reason})
    return group.assign(changed)
