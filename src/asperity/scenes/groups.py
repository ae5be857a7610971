"""The groups of a result that no rolling changes: textures with their statistics, and the reduced contact."""

import warnings
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from asperity.arguments import Array, Indices
from asperity.errors import Finding, InhomogeneousWarning, ShortRecordWarning
from asperity.reduction.filter import punch_filter, punch_taps, response
from asperity.reporting import data
from asperity.scenarios.geometry import Geometry
from asperity.scenarios.reducing import Reduction
from asperity.scenarios.textures import Textures
from asperity.scenes.compute import Computed
from asperity.schema import Values, contact
from asperity.spectra import psd
from asperity.surfaces import statistics
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.spectra import psd_1d
from asperity.written_numbers import count_of

PATH_ROWS = 2000
"""Rows of a path, at most, that are kept to be looked at from above."""
FEWEST_POINTS = 16
"""Points of a segment of a line's spectrum, at least."""


def surface_group(computed: Computed, *, brief: bool) -> Values:
    """Lay out the textures of a case: first sample, a piece of the path, its line.

    And, if not in brief, of the whole path spectrum and statistics.
    """
    textures = computed.textures
    dx = computed.shape.spacing[0]
    recorded = computed.textures.recorded
    laid_out: Values = {}
    rows: list[dict[str, Any]] = []
    if textures.maps:
        first = textures.maps[0]
        laid_out[contact.MAP_X], laid_out[contact.MAP_Y] = (np.arange(n) * dx for n in first.shape)
        laid_out[contact.SAMPLE_HEIGHTS] = first.heights
        if textures.areal and not brief and np.ptp(first.heights):
            with ShortRecordWarning.caught() as caught:
                sample = statistics.areal_statistics(first)
            rows += _rows(_without_bounds(sample, caught), "first sample")
    if textures.path is not None:
        piece = textures.surface.rows(recorded.start, min(recorded.stop, recorded.start + PATH_ROWS))
        laid_out[contact.PATH_X], laid_out[contact.PATH_Y] = (np.arange(n) * dx for n in piece.shape)
        laid_out[contact.PATH_HEIGHTS] = piece
    measured = textures.untouched or textures
    if computed.case.surface.file is not None and measured.maps is not measured.strips:
        laid_out |= _homogeneity(measured.maps)
    line = textures.followed[recorded]
    laid_out |= {contact.DISTANCE: np.arange(len(line)) * dx, contact.LINE: line}
    if textures.untouched is not None:
        laid_out[contact.LINE_UNTOUCHED] = textures.untouched.followed[recorded]
    if not brief:
        path = _survey(textures, dx)
        laid_out |= _spectra(textures, path)
        beside = textures.path is not None and textures.areal
        rows += _rows(path.statistics, "path" if beside else "middle line of the path")
        for body, lines in textures.lines.items():
            if len(lines) > 1:
                means = [mean for mean, _, _ in statistics.line_statistics(lines)]
                rows += _rows(means, f"{count_of(len(lines), 'line')} of the {body}, mean")
    return laid_out | {
        contact.STATISTICS: rows,
        contact.SOURCE: textures.origin,
        contact.MISSING_SHARE: textures.missing_share,
        contact.ACROSS: "areal" if textures.areal else "lines",
    }


def _survey(textures: Textures, dx: float) -> statistics.StripSurvey:
    """Survey the recorded path, as a surface or, where nothing is known beside it, as a line."""
    recorded = textures.recorded
    segment = textures.maps[0].shape[0] if textures.maps else max(FEWEST_POINTS, len(textures.line) // 8)
    segment = min(segment, recorded.stop - recorded.start)
    if textures.path is None or not textures.areal:
        line = textures.followed[recorded]
        found = statistics.profile_statistics(Profile(line, dx)) if np.ptp(line) else []
        return statistics.StripSurvey(found, *psd(textures.line[recorded], dx, segment=segment))
    with ShortRecordWarning.caught() as caught:
        path = statistics.survey_strip(textures.surface, segment, recorded.start, recorded.stop)
        rough = path
        if textures.defects is not None:
            rough = statistics.survey_strip(textures.path, segment, recorded.start, recorded.stop)
    found = _without_bounds(path.statistics, caught)
    return replace(path, statistics=found, wavenumber=rough.wavenumber, spectrum=rough.spectrum)


def _without_bounds(
    found: list[statistics.Statistic], caught: list[warnings.WarningMessage]
) -> list[statistics.Statistic]:
    """Leave out the texture ratio of what is narrower than its waves: it would be a bound."""
    short = any(issubclass(each.category, ShortRecordWarning) for each in caught)
    return [item for item in found if not (short and item.symbol == "Str")]


def _homogeneity(maps: tuple[HeightMap, ...]) -> Values:
    """Test measured maps for being the same everywhere; synthesised ones are."""
    if any(min(m.shape) < 2 * max(statistics.TILES) or not np.ptp(m.heights) for m in maps):
        return {}
    found = [statistics.homogeneity(m) for m in maps]
    p_values = [f.p_value for f in found]
    if statistics.more_than_chance(p_values):
        failed = sum(not f.homogeneous for f in found)
        worst = max(found, key=lambda f: f.variation / f.expected)
        along, across = statistics.TILES
        InhomogeneousWarning.warn(
            f"{failed} of {len(maps)} measured maps are not the same everywhere "
            f"(p ≤ {statistics.SIGNIFICANCE:g}): the mean squares of {along} × {across} tiles vary by up to "
            f"{100 * worst.variation:.0f} %, those of stationary textures by {100 * worst.expected:.0f} %. "
            "Samples of them do not stand for the whole path: take more maps, crop them, "
            "or remove form and waviness."
        )
    return {
        contact.HOMOGENEITY_P: contact.HOMOGENEITY_P.variable(p_values, significance=statistics.SIGNIFICANCE),
        contact.TILE_VARIATION: [f.variation for f in found],
        contact.TILE_VARIATION_EXPECTED: [f.expected for f in found],
    }


def _spectra(textures: Textures, path: statistics.StripSurvey) -> Values:
    """Spectra of samples and path in the rolling direction, on the samples' wavenumbers."""
    wavenumber = path.wavenumber
    laid_out = Values()
    if textures.maps:
        spectra = [psd_1d(m)[1] for m in textures.maps]
        wavenumber = psd_1d(textures.maps[0])[0]
        first = spectra[0]
        laid_out[contact.PSD_SAMPLE] = np.mean([s[1:] for s in spectra if s.shape == first.shape], axis=0)
    along = np.interp(wavenumber[1:], path.wavenumber[1:], path.spectrum[1:], left=np.nan)
    return laid_out | {contact.PSD_PATH: along, contact.SURFACE_WAVENUMBER: wavenumber[1:]}


def _rows(found: list[statistics.Statistic], where: str) -> list[dict[str, Any]]:
    return [
        {
            "symbol": s.symbol,
            "value": s.value if np.isfinite(s.value) else None,
            "unit": s.unit,
            "bandwidth": " … ".join(data.engineering(length, "m") for length in s.bandwidth),
            "surface": where,
            "meaning": s.meaning,
        }
        for s in found
    ]


SMOOTH = "smooth bodies have one filter, that of the working load"
"""Why the filter that is applied is not known in other states of a case without samples."""


def contact_group(computed: Computed, found: Sequence[Finding], population: Sequence[Finding]) -> Values:
    """Lay out forces, stiffness and filters of all states, Hertz's where there are no samples.

    With the findings that hold the contact to the range of its laws, and the answers about its population.
    """
    shape = computed.shape
    reduction = computed.reduction
    laid_out = _hertz_only(shape) if reduction is None else _reduced(computed, reduction)
    if reduction is not None:
        laid_out[contact.POPULATION] = [_asked(answer) for answer in population]
    return laid_out | {
        contact.HERTZ_RADIUS: shape.semi_axes[0],
        contact.HERTZ_RADIUS_ACROSS: shape.semi_axes[1],
        contact.WORKING_LOAD: shape.load,
        contact.CONTACT_MODULUS: shape.modulus,
        contact.HERTZ_CONSTANT: shape.hertz.stiffness_constant,
        contact.VALIDITY: [finding.row() for finding in found],
    }


def _asked(answer: Finding) -> dict[str, Any]:
    assert answer.effect is not None
    words = {"question": answer.quantity, "value": answer.value, "answer": answer.meaning}
    grade = "" if answer.grade is None else answer.grade.value
    return words | {"effect": round(answer.effect, 3), "grade": grade}


def _reduced(computed: Computed, reduction: Reduction) -> Values:
    """States, and the contact at the working load, of a case with samples."""
    shape = computed.shape
    ensemble = reduction.ensemble
    approach = reduction.approaches
    working = reduction.pressed.contacts[0]
    curve = ensemble.curve
    states, touching = (np.where(r > 0.0, r, np.inf) for r in (ensemble.states, approach))
    hertz = np.array([shape.hertz.force(s) for s in approach])
    px, py = ((np.arange(n) - n // 2) * d for n, d in zip(shape.body.shape, shape.spacing, strict=True))
    return {
        contact.APPROACH: approach,
        contact.FORCE: ensemble.mean_force,
        contact.FORCE_STD: ensemble.force_spread,
        contact.STIFFNESS: ensemble.mean_force / states,
        contact.STIFFNESS_STD: ensemble.force_spread / states,
        contact.TANGENT_STIFFNESS: curve.stiffness(approach),
        contact.HERTZ_FORCE: hertz,
        contact.HERTZ_STIFFNESS: hertz / touching,
        contact.CONTACT_RADIUS: reduction.semi_axes[:, 0],
        contact.PX: px,
        contact.PY: py,
        contact.PRESSURE: working.pressure,
        contact.GAP: working.gap,
        contact.DATUM: ensemble.datum,
        contact.DATUM_SAMPLES: reduction.datums["samples"],
        contact.DATUM_PATH: reduction.datums["path"],
        contact.WORKING_APPROACH: reduction.pressed.approach,
        contact.WORKING_STIFFNESS: float(curve.stiffness(curve.inverse(shape.load))),
        contact.CONTACT_AREA: working.real_area,
        contact.CONTACT_AREA_RATIO: reduction.pressed.area_ratio,
        contact.ISOLATED_SHARE: reduction.pressed.isolated_share,
        contact.RIM_CELLS: computed.rim_cells,
        **({contact.RIM_CELLS_CHOSEN: computed.rims} if computed.rims else {}),
        contact.RMS_SLOPE: computed.textures.rms_slope,
        contact.SAMPLES: len(ensemble.forces),
        **computed.running_in,
        **_filters(reduction),
    }


def _filters(reduction: Reduction) -> Values:
    """Filters on the approaches of all states; NaN where a state carries too little load to have one."""
    main, *others = reduction.filters.values()
    estimated = main.contact_filter
    states = reduction.approaches
    rows = np.searchsorted(states, estimated.approaches)
    wavenumber = estimated.wavenumber
    ratio = estimated.asymptotic_stiffness / estimated.tangent_stiffness
    by_state = {
        contact.FILTER_SCALE: ratio,
        contact.FILTER_SIGNED: np.where(estimated.excited, estimated.signed, np.nan),
        contact.FILTER_COHERENCE: estimated.coherence,
        contact.FILTER_THEORY: punch_filter(wavenumber[None, :], reduction.semi_axes[rows, :1]),
    }
    laid_out: Values = {
        contact.WAVENUMBER: wavenumber,
        contact.FILTER_EXCITED: estimated.excited.astype(np.int8),
        **{entry: _on_states(values, rows, len(states)) for entry, values in by_state.items()},
    }
    named = [(contact.FILTERS, main), *((contact.PRINTED_FILTERS, other) for other in others)]
    for entries, each in named:  # as fitted, as estimated and as applied, and the spread of the fits
        fitted = each.contact_filter
        magnitudes = (fitted.magnitude, fitted.raw, each.applied, fitted.spread)
        for entry, values in zip(entries, magnitudes, strict=True):
            on_states = _on_states(values, rows, len(states))
            laid_out[entry] = entry.variable(on_states, normalise=fitted.normalise)
    return laid_out


def _on_states(values: Array, rows: Indices, count: int) -> Array:
    """Values of some states among `count`; NaN for the others."""
    full = np.full((count, *values.shape[1:]), np.nan)
    full[rows] = values
    return full


def _hertz_only(shape: Geometry) -> Values:
    """Contact of smooth bodies, and its closed-form filter, where a case has no samples."""
    hertz = shape.hertz
    working = shape.hertz.approach(shape.load)
    dx = shape.spacing[0]
    approach = np.linspace(0.0, 2.0 * working, 41)[1:]
    radius = np.array([hertz.semi_axes(d)[0] for d in approach])
    wavenumber = np.geomspace(0.01, 2.0, 120) / shape.semi_axes[0]
    force = np.array([hertz.force(d) for d in approach])
    theory = np.abs(punch_filter(wavenumber[None, :], radius[:, None]))
    state = np.array([np.argmin(np.abs(approach - working))])
    taps = np.abs(response(punch_taps(shape.semi_axes[0], dx), dx, wavenumber))
    applied = _on_states(taps, state, len(approach))
    return {
        contact.APPROACH: approach,
        contact.FORCE: force,
        contact.STIFFNESS: force / approach,
        contact.CONTACT_RADIUS: radius,
        contact.WAVENUMBER: wavenumber,
        contact.FILTER: contact.FILTER.variable(theory, normalise="tangent"),
        contact.FILTER_APPLIED: contact.FILTER_APPLIED.variable(applied, normalise="tangent", missing=SMOOTH),
        contact.DATUM: 0.0,
        contact.WORKING_APPROACH: working,
        contact.WORKING_STIFFNESS: hertz.tangent_stiffness(working),
    }
