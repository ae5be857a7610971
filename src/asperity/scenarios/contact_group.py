"""The group of a result that shows the reduced contact: stiffness, filters, pressure at the working load."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from asperity.reduction.filter import punch_filter
from asperity.results import variable
from asperity.scenarios.chain import Chain
from asperity.scenarios.validity import Finding, rms_slope_of


def contact_group(chain: Chain[Any], found: Sequence[Finding]) -> xarray.Dataset:
    """Lay out the reduced contact of a case.

    Parameters
    ----------
    chain : Chain
        What was computed.
    found : sequence of Finding
        What holds it to the range of its laws.

    Returns
    -------
    xarray.Dataset
        Forces, stiffness and filters of all states; Hertz's where there are no samples.
    """
    shape, reduction = chain.shape, chain.reduction
    attrs: dict[str, Any] = {
        "hertz_radius": shape.semi_axes[0],
        "hertz_radius_across": shape.semi_axes[1],
        "working_load": shape.load,
        "contact_modulus": shape.modulus,
        "hertz_constant": shape.hertz.stiffness_constant,  # N/m^1.5
    }
    if reduction is None:
        return _hertz_only(chain, attrs)
    ensemble, working = reduction.ensemble, reduction.working
    attrs |= {
        "datum": ensemble.datum,
        "working_approach": reduction.working_approach,
        "contact_area": working.area,
        "contact_area_ratio": reduction.area_ratio,
        "isolated_share": reduction.isolated_share,
        "rms_slope": rms_slope_of(chain),
        "validity": json.dumps([_row(finding) for finding in found], ensure_ascii=False),
        "samples": len(ensemble.forces),
        "normalise": reduction.contact_filter.normalise,
    }
    state = ensemble.states
    safe = np.where(state > 0.0, state, np.inf)
    force, spread = ensemble.mean_force, ensemble.force_spread
    approach = reduction.approaches
    hertz = np.array([shape.hertz.force(s) for s in approach])
    touching = np.where(approach > 0.0, approach, np.inf)
    variables = {
        "approach": variable("approach", reduction.approaches, "m", "approach of the mean surfaces"),
        "force": variable("approach", force, "N", "contact force, ensemble mean"),
        "force_std": variable("approach", spread, "N", "standard deviation of the force between samples"),
        "stiffness": variable("approach", force / safe, "N/m", "contact stiffness F/r, ensemble mean"),
        "stiffness_std": variable("approach", spread / safe, "N/m", "standard deviation of the stiffness"),
        "tangent_stiffness": variable(
            "approach", ensemble.curve.stiffness(reduction.approaches), "N/m", "tangent stiffness dF/dr"
        ),
        "hertz_force": variable("approach", hertz, "N", "contact force of smooth bodies (Hertz)"),
        "hertz_stiffness": variable(
            "approach",
            hertz / touching,
            "N/m",
            "F/δ of smooth bodies (Hertz), at δ = r − d₀",
        ),
        "contact_radius": variable(
            "approach", reduction.semi_axes[:, 0], "m", "radius of the nominal patch at the mean force"
        ),
    }
    px, py = ((np.arange(n) - n // 2) * d for n, d in zip(shape.body.shape, shape.spacing, strict=True))
    variables |= {
        "px": variable("px", px, "m", "rolling direction, from the middle of the contact"),
        "py": variable("py", py, "m", "across, from the middle of the contact"),
        "pressure": variable(("px", "py"), working.pressure, "Pa", "contact pressure at the working load"),
        "gap": variable(("px", "py"), working.gap, "m", "gap after deformation at the working load"),
    }
    return xarray.Dataset(variables | _filters(chain), attrs=attrs)


def _row(finding: Finding) -> dict[str, str]:
    grade = "" if finding.grade is None else finding.grade.value
    return {
        **{k: getattr(finding, k) for k in ("quantity", "value", "limit", "meaning", "remedy")},
        "grade": grade,
    }


def _filters(chain: Chain[Any]) -> dict[str, xarray.Variable]:
    """Filters on the approaches of all states; NaN where a state carries too little load to have one."""
    reduction = chain.reduction
    assert reduction is not None
    found = reduction.contact_filter
    dims = ("approach", "wavenumber")
    rows = np.searchsorted(reduction.approaches, found.approaches)
    wavenumber = found.wavenumber

    def spread_out(values: NDArray[np.float64]) -> NDArray[np.float64]:
        full = np.full((len(reduction.approaches), len(wavenumber)), np.nan)
        full[rows] = values
        return full

    theory = punch_filter(wavenumber[None, :], reduction.semi_axes[rows, :1])
    return {
        "wavenumber": variable("wavenumber", wavenumber, "1/m", "wavenumber, cycles per metre"),
        "filter": variable(dims, spread_out(found.magnitude), "1", "contact filter, magnitude"),
        "filter_std": variable(dims, spread_out(found.spread), "1", "standard deviation between samples"),
        "filter_signed": variable(dims, spread_out(found.signed), "1", "contact filter, signed estimate"),
        "filter_theory": variable(dims, spread_out(theory), "1", "sin q/q of the nominal patch"),
    }


def _hertz_only(chain: Chain[Any], attrs: dict[str, Any]) -> xarray.Dataset:
    """Contact of smooth bodies, and its closed-form filter, where a case has no samples."""
    hertz, load = chain.shape.hertz, chain.shape.load
    approach = np.linspace(0.0, 2.0 * hertz.approach(load), 41)[1:]
    radius = np.array([hertz.semi_axes(d)[0] for d in approach])
    wavenumber = np.geomspace(0.01, 2.0, 120) / chain.shape.semi_axes[0]
    force = np.array([hertz.force(d) for d in approach])
    theory = punch_filter(wavenumber[None, :], radius[:, None])
    dims = ("approach", "wavenumber")
    return xarray.Dataset(
        {
            "approach": variable("approach", approach, "m", "approach of the mean surfaces"),
            "force": variable("approach", force, "N", "contact force (Hertz)"),
            "stiffness": variable("approach", force / approach, "N/m", "contact stiffness F/r (Hertz)"),
            "contact_radius": variable("approach", radius, "m", "radius of the contact"),
            "wavenumber": variable("wavenumber", wavenumber, "1/m", "wavenumber, cycles per metre"),
            "filter": variable(dims, np.abs(theory), "1", "contact filter, magnitude (closed form)"),
        },
        attrs=attrs | {"datum": 0.0, "working_approach": hertz.approach(load)},
    )
