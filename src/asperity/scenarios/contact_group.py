"""The group of a result that shows the reduced contact: stiffness, filters, pressure at the working load."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from asperity.reduction.filter import punch_filter
from asperity.reduction.fir import LineFilter, punch_taps, response
from asperity.results import variable
from asperity.scenarios.chain import Chain
from asperity.scenarios.geometry import Geometry
from asperity.scenarios.validity import Finding, rms_slope_of

PATCH_PLANE = "approach from the plane that the nominal patch feels: heights under its flat-punch weight"


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
        "datum_from": chain.case.contact.datum,
        **{f"datum_{name}": value for name, value in reduction.datums.items()},
        "working_approach": reduction.working_approach,
        "contact_area": working.area,
        "contact_area_ratio": reduction.area_ratio,
        "isolated_share": reduction.isolated_share,
        "rms_slope": rms_slope_of(chain),
        "validity": json.dumps([_row(finding) for finding in found], ensure_ascii=False),
        "samples": len(ensemble.forces),
        "normalise": next(iter(reduction.filters)),
    }
    state = ensemble.states
    safe = np.where(state > 0.0, state, np.inf)
    force, spread = ensemble.mean_force, ensemble.force_spread
    approach = reduction.approaches
    hertz = np.array([shape.hertz.force(s) for s in approach])
    touching = np.where(approach > 0.0, approach, np.inf)
    variables = {
        "approach": variable("approach", reduction.approaches, "m", PATCH_PLANE),
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
    main, *others = reduction.filters.values()
    estimated = main.contact_filter
    rows = np.searchsorted(reduction.approaches, estimated.approaches)
    wavenumber = estimated.wavenumber
    theory = punch_filter(wavenumber[None, :], reduction.semi_axes[rows, :1])
    ratio = estimated.asymptotic_stiffness / estimated.tangent_stiffness
    signed = np.where(estimated.excited, estimated.signed, np.nan)
    dims, count = ("approach", "wavenumber"), len(reduction.approaches)
    coherence = "share of the force's power that the mean line under the patch explains"
    variables = {
        "wavenumber": variable("wavenumber", wavenumber, "1/m", "wavenumber, cycles per metre"),
        "filter_excited": variable(
            "wavenumber", estimated.excited.astype(np.int8), "1", "1 where the texture excites the contact"
        ),
        "filter_scale": variable(
            "approach", _on_states(ratio, rows, count), "1", "k_0/k_t: low-wavenumber over tangent stiffness"
        ),
        "filter_signed": variable(dims, _on_states(signed, rows, count), "1", "contact filter, signed"),
        "filter_coherence": variable(dims, _on_states(estimated.coherence, rows, count), "1", coherence),
        "filter_theory": variable(dims, _on_states(theory, rows, count), "1", "sin q/q of the nominal patch"),
    }
    for name, found in (("filter", main), *(("printed_filter", other) for other in others)):
        variables |= _magnitudes(name, found, rows, count)
    return variables


def _magnitudes(name: str, found: LineFilter, rows: NDArray, count: int) -> dict[str, xarray.Variable]:
    """A filter as estimated, as fitted and as applied."""
    estimated, what = found.contact_filter, f"contact filter, {found.contact_filter.normalise} normalisation"
    laid_out = {
        name: (estimated.magnitude, f"{what}: fitted magnitude"),
        f"{name}_raw": (estimated.raw, f"{what}: ratio of the spectra, Eq. 2.6"),
        f"{name}_applied": (found.applied, f"{what}: magnitude of the taps"),
        f"{name}_std": (estimated.spread, f"{what}: standard deviation between the strips' fits"),
    }
    return {
        key: variable(("approach", "wavenumber"), _on_states(values, rows, count), "1", meaning)
        for key, (values, meaning) in laid_out.items()
    }


def _on_states(values: NDArray[np.float64], rows: NDArray, count: int) -> NDArray[np.float64]:
    """Values of some states among `count`; NaN for the others."""
    full = np.full((count, *values.shape[1:]), np.nan)
    full[rows] = values
    return full


def _hertz_only(chain: Chain[Any], attrs: dict[str, Any]) -> xarray.Dataset:
    """Contact of smooth bodies, and its closed-form filter, where a case has no samples."""
    shape, hertz, load = chain.shape, chain.shape.hertz, chain.shape.load
    approach = np.linspace(0.0, 2.0 * hertz.approach(load), 41)[1:]
    radius = np.array([hertz.semi_axes(d)[0] for d in approach])
    wavenumber = np.geomspace(0.01, 2.0, 120) / shape.semi_axes[0]
    force = np.array([hertz.force(d) for d in approach])
    theory = punch_filter(wavenumber[None, :], radius[:, None])
    dims = ("approach", "wavenumber")
    return xarray.Dataset(
        {
            "approach": variable("approach", approach, "m", "approach of the smooth bodies"),
            "force": variable("approach", force, "N", "contact force (Hertz)"),
            "stiffness": variable("approach", force / approach, "N/m", "contact stiffness F/r (Hertz)"),
            "contact_radius": variable("approach", radius, "m", "radius of the contact"),
            "wavenumber": variable("wavenumber", wavenumber, "1/m", "wavenumber, cycles per metre"),
            "filter": variable(dims, np.abs(theory), "1", "contact filter, magnitude (closed form)"),
            "filter_applied": variable(
                dims, _applied_at_load(shape, approach, wavenumber), "1", "magnitude of the taps"
            ),
        },
        attrs=attrs | {"datum": 0.0, "working_approach": hertz.approach(load)},
    )


def _applied_at_load(
    shape: Geometry, approach: NDArray[np.float64], wavenumber: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Magnitude of the one filter that smooth bodies have, in the state of the working load."""
    taps = punch_taps(shape.semi_axes[0], shape.spacing[0])
    state = np.array([np.argmin(np.abs(approach - shape.hertz.approach(shape.load)))])
    return _on_states(np.abs(response(taps, shape.spacing[0], wavenumber)), state, len(approach))
