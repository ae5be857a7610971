"""The group of a result that shows the reduced contact: stiffness, filters, pressure at the working load."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from asperity.reduction.filter import LineFilter, punch_filter, punch_taps, response
from asperity.scenarios.chain import Chain
from asperity.scenarios.geometry import Geometry
from asperity.scenarios.population import Answer, answers
from asperity.scenarios.running_in import RunInCase
from asperity.scenarios.validity import Finding
from asperity.schema import Attribute, Entry, attributes, contact, variables

SMOOTH = "smooth bodies have one filter, that of the working load"
"""Why the filter that is applied is not known in other states of a case without samples."""


def contact_group(chain: Chain, found: Sequence[Finding]) -> xarray.Dataset:
    """Lay out forces, stiffness and filters of all states, Hertz's where there are no samples.

    With the findings that hold the contact to the range of its laws.
    """
    facts: dict[Attribute, Any] = {
        contact.VALIDITY: json.dumps([_row(finding) for finding in found], ensure_ascii=False)
    }
    if chain.reduction is not None:
        asked = [_asked(answer) for answer in answers(chain)]
        facts[contact.POPULATION] = json.dumps(asked, ensure_ascii=False)
    return _reduced(chain).assign_attrs(attributes(facts))


def _reduced(chain: Chain) -> xarray.Dataset:
    """What does not depend on what has rolled."""
    shape, reduction = chain.shape, chain.reduction
    facts: dict[Attribute, Any] = {
        contact.HERTZ_RADIUS: shape.semi_axes[0],
        contact.HERTZ_RADIUS_ACROSS: shape.semi_axes[1],
        contact.WORKING_LOAD: shape.load,
        contact.CONTACT_MODULUS: shape.modulus,
        contact.HERTZ_CONSTANT: shape.hertz.stiffness_constant,
    }
    if reduction is None:
        return _hertz_only(chain, facts)
    ensemble, working = reduction.ensemble, reduction.working
    facts |= {
        contact.DATUM: ensemble.datum,
        contact.DATUM_FROM: chain.case.contact.datum,
        contact.DATUM_SAMPLES: reduction.datums["samples"],
        contact.DATUM_PATH: reduction.datums["path"],
        contact.WORKING_APPROACH: reduction.working_approach,
        contact.WORKING_STIFFNESS: float(ensemble.curve.stiffness(ensemble.curve.inverse(shape.load))),
        contact.CONTACT_AREA: working.area,
        contact.CONTACT_AREA_RATIO: reduction.area_ratio,
        contact.ISOLATED_SHARE: reduction.isolated_share,
        contact.RMS_SLOPE: chain.textures.rms_slope,
        contact.SAMPLES: len(ensemble.forces),
    }
    state = ensemble.states
    safe = np.where(state > 0.0, state, np.inf)
    force, spread = ensemble.mean_force, ensemble.force_spread
    approach = reduction.approaches
    hertz = np.array([shape.hertz.force(s) for s in approach])
    touching = np.where(approach > 0.0, approach, np.inf)
    px, py = ((np.arange(n) - n // 2) * d for n, d in zip(shape.body.shape, shape.spacing, strict=True))
    laid_out: dict[Entry, Any] = {
        contact.APPROACH: approach,
        contact.FORCE: force,
        contact.FORCE_STD: spread,
        contact.STIFFNESS: force / safe,
        contact.STIFFNESS_STD: spread / safe,
        contact.TANGENT_STIFFNESS: ensemble.curve.stiffness(approach),
        contact.HERTZ_FORCE: hertz,
        contact.HERTZ_STIFFNESS: hertz / touching,
        contact.CONTACT_RADIUS: reduction.semi_axes[:, 0],
        contact.PX: px,
        contact.PY: py,
        contact.PRESSURE: working.pressure,
        contact.GAP: working.gap,
    }
    if chain.running_in is not None:
        laid_out |= _running_in(chain.running_in)
        facts |= {
            contact.YIELDED_SHARE: chain.running_in.yielded_share,
            contact.SHAKEN_DOWN: int(chain.running_in.settled),
        }
    return xarray.Dataset(variables(laid_out | _filters(chain)), attrs=attributes(facts))


def _running_in(found: RunInCase) -> dict[Entry, Any]:
    """What each pass of running-in did, and the surface before and after it."""
    both = (found.before, found.after)
    return {
        contact.RUNNING_IN_PASS: np.arange(1, len(found.largest) + 1),
        contact.RUNNING_IN_LOWERING: found.largest,
        contact.RUNNING_IN_YIELDING: found.yielding,
        contact.CONDITION: ["before", "after"],
        contact.TRACK_RMS: [each.rms for each in both],
        contact.TRACK_SLOPE: [each.slope for each in both],
        contact.TRACK_AREA_RATIO: [each.area_ratio for each in both],
        contact.TRACK_STIFFNESS: [each.stiffness for each in both],
    }


def _row(finding: Finding) -> dict[str, str]:
    grade = "" if finding.grade is None else finding.grade.value
    return {
        **{k: getattr(finding, k) for k in ("quantity", "value", "limit", "meaning", "remedy")},
        "grade": grade,
    }


def _asked(answer: Answer) -> dict[str, Any]:
    grade = "" if answer.grade is None else answer.grade.value
    told = {name: getattr(answer, name) for name in ("question", "value", "answer")}
    return told | {"effect": round(answer.effect, 3), "grade": grade}


def _filters(chain: Chain) -> dict[Entry, Any]:
    """Filters on the approaches of all states; NaN where a state carries too little load to have one."""
    reduction = chain.reduction
    assert reduction is not None
    main, *others = reduction.filters.values()
    estimated = main.contact_filter
    rows, count = np.searchsorted(reduction.approaches, estimated.approaches), len(reduction.approaches)
    wavenumber = estimated.wavenumber
    theory = punch_filter(wavenumber[None, :], reduction.semi_axes[rows, :1])
    ratio = estimated.asymptotic_stiffness / estimated.tangent_stiffness
    signed = np.where(estimated.excited, estimated.signed, np.nan)
    laid_out = {
        contact.WAVENUMBER: wavenumber,
        contact.FILTER_EXCITED: estimated.excited.astype(np.int8),
        contact.FILTER_SCALE: _on_states(ratio, rows, count),
        contact.FILTER_SIGNED: _on_states(signed, rows, count),
        contact.FILTER_COHERENCE: _on_states(estimated.coherence, rows, count),
        contact.FILTER_THEORY: _on_states(theory, rows, count),
    } | _magnitudes(contact.FILTERS, main, rows, count)
    for other in others:
        laid_out |= _magnitudes(contact.PRINTED_FILTERS, other, rows, count)
    return laid_out


def _magnitudes(
    entries: tuple[Entry, ...], found: LineFilter, rows: NDArray[np.intp], count: int
) -> dict[Entry, xarray.Variable]:
    """A filter as fitted, as estimated and as applied, and the spread of its fits."""
    estimated = found.contact_filter
    magnitudes = (estimated.magnitude, estimated.raw, found.applied, estimated.spread)
    return {
        entry: entry.variable(_on_states(values, rows, count), normalise=estimated.normalise)
        for entry, values in zip(entries, magnitudes, strict=True)
    }


def _on_states(values: NDArray[np.float64], rows: NDArray[np.intp], count: int) -> NDArray[np.float64]:
    """Values of some states among `count`; NaN for the others."""
    full = np.full((count, *values.shape[1:]), np.nan)
    full[rows] = values
    return full


def _hertz_only(chain: Chain, facts: dict[Attribute, Any]) -> xarray.Dataset:
    """Contact of smooth bodies, and its closed-form filter, where a case has no samples."""
    shape, hertz, load = chain.shape, chain.shape.hertz, chain.shape.load
    approach = np.linspace(0.0, 2.0 * hertz.approach(load), 41)[1:]
    radius = np.array([hertz.semi_axes(d)[0] for d in approach])
    wavenumber = np.geomspace(0.01, 2.0, 120) / shape.semi_axes[0]
    force = np.array([hertz.force(d) for d in approach])
    theory = np.abs(punch_filter(wavenumber[None, :], radius[:, None]))
    applied = _applied_at_load(shape, approach, wavenumber)
    laid_out = variables(
        {
            contact.APPROACH: approach,
            contact.FORCE: force,
            contact.STIFFNESS: force / approach,
            contact.CONTACT_RADIUS: radius,
            contact.WAVENUMBER: wavenumber,
            contact.FILTER: contact.FILTER.variable(theory, normalise="tangent"),
            contact.FILTER_APPLIED: contact.FILTER_APPLIED.variable(
                applied, normalise="tangent", missing=SMOOTH
            ),
        }
    )
    facts |= {
        contact.DATUM: 0.0,
        contact.WORKING_APPROACH: hertz.approach(load),
        contact.WORKING_STIFFNESS: hertz.tangent_stiffness(hertz.approach(load)),
    }
    return xarray.Dataset(laid_out, attrs=attributes(facts))


def _applied_at_load(
    shape: Geometry, approach: NDArray[np.float64], wavenumber: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Magnitude of the one filter that smooth bodies have, in the state of the working load."""
    taps = punch_taps(shape.semi_axes[0], shape.spacing[0])
    state = np.array([np.argmin(np.abs(approach - shape.hertz.approach(shape.load)))])
    return _on_states(np.abs(response(taps, shape.spacing[0], wavenumber)), state, len(approach))
