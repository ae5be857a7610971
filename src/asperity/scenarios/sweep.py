"""One case at several speeds and loads, tabulated."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from asperity.errors import InputError
from asperity.progress import Progress

if TYPE_CHECKING:
    import xarray

    from asperity.config import Case

TABULATED = {
    "force_level": "spectra",
    "force_level_difference": "spectra",
    "sound_power_level_a": "spectra",
    "contact_loss_share": "rolling",
    "contact_loss_events": "rolling",
}


def sweep(
    case: str | os.PathLike[str] | Case,
    speeds: Sequence[float],
    loads: Sequence[float],
    progress: Progress | None = None,
) -> xarray.Dataset:
    """Compute a wheel-on-rail case at several speeds and loads.

    Parameters
    ----------
    case : path or case object
        A case with a wheel on a rail.
    speeds : sequence of float
        m/s.
    loads : sequence of float
        Static contact forces, N.
    progress : callable, optional
        ``progress(done, total, message)``, called during long work.

    Returns
    -------
    xarray.Dataset, dims (speed, load, law, band)
        `force_level`, `force_level_difference` (to the linear law), `rms_force`, `contact_loss_share`,
        `contact_loss_events`, `sound_power_level_a` (total); NaN where a run has no such value, as
        force levels in bands that only other runs have. Attributes: case, seed and version.

    Raises
    ------
    InputError
        If the case has no wheel, a list is empty or holds a value twice, or a value is out of range.
    ComputationError
        If a computation fails.
    """
    import xarray

    from asperity.config import WheelOnRailCase, changed, load_case
    from asperity.scenarios import run

    loaded = load_case(case) if isinstance(case, str | os.PathLike) else case
    if not isinstance(loaded, WheelOnRailCase):
        raise InputError(
            "case", f'kind = "{loaded.kind}"', 'kind = "wheel-on-rail"', "Sweep a wheel on rail."
        )
    for name, values in (("speeds", speeds), ("loads", loads)):
        if not len(values) or len(set(values)) < len(values):
            raise InputError(name, list(values), "one value or more, each once")
    report = progress or (lambda done, total, message: None)
    cases = [
        [changed(loaded, speed=f"{v!r} m/s", wheel={"load": f"{p!r} N"}) for p in map(float, loads)]
        for v in map(float, speeds)
    ]
    by_load = _coordinate("load", loads, "N", "static contact force")
    rows = []
    for i, (speed, row) in enumerate(zip(speeds, cases, strict=True)):
        found = []
        for j, (load, one) in enumerate(zip(loads, row, strict=True)):
            where = f"{speed:.4g} m/s, {load / 1e3:.4g} kN"
            report(i * len(loads) + j, len(speeds) * len(loads), f"sweep: {where}")
            found.append(_tabulated(run(one, progress)))
        rows.append(xarray.concat(found, by_load, join="outer"))
    report(len(speeds) * len(loads), len(speeds) * len(loads), "sweep")
    table = xarray.concat(rows, _coordinate("speed", speeds, "m/s", "rolling speed"), join="outer")
    return table.assign_attrs(_provenance(loaded))


def _tabulated(tree: xarray.DataTree) -> xarray.Dataset:
    """What a sweep keeps of one run."""
    import xarray

    kept = {n: tree[g][n].reset_coords(drop=True) for n, g in TABULATED.items() if n in tree[g]}
    if "sound_power_level_a" in kept:
        kept["sound_power_level_a"] = kept["sound_power_level_a"].sel(source="total", drop=True)
    force = tree["rolling/contact_force"]
    kept["rms_force"] = force.std("time").reset_coords(drop=True)
    kept["rms_force"].attrs = {"units": "N", "long_name": "rms of the contact force about its mean"}
    return xarray.Dataset(kept)


def _coordinate(name: str, values: Sequence[float], units: str, long_name: str) -> xarray.DataArray:
    import xarray

    attrs = {"units": units, "long_name": long_name}
    return xarray.DataArray(np.asarray(values, dtype=float), dims=name, name=name, attrs=attrs)


def _provenance(case: Case) -> dict[str, str | int]:
    from asperity import __version__

    return {"asperity_version": __version__, "case": case.text, "seed": case.seed}
