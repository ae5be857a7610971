"""The result of a ball-on-beam case, laid out as labelled groups."""

from __future__ import annotations

import json
import warnings
from collections import Counter
from collections.abc import Iterable
from datetime import UTC, datetime
from typing import Any

import numpy as np
import xarray
from numpy.typing import NDArray

from asperity import __version__
from asperity.errors import PhysicsWarning
from asperity.pointforce import LAWS
from asperity.reduction.filter import punch_filter
from asperity.results import checked, variable
from asperity.rolling.ball_on_beam import Rolling
from asperity.scenarios.ball_on_beam import Computed
from asperity.scenarios.verdict import verdict
from asperity.spectra import band_levels, psd
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.statistics import Statistic, areal_statistics, profile_statistics, psd_1d

SEGMENT = 0.2
"""Longest segment of the spectra, s: lines 5 Hz apart."""
PATH_ROWS = 2000
LINE_POINTS = 20000
ACCELERATION_REFERENCE = 1e-6
CITATIONS = (
    "O. Lundberg, State-dependent nonlinear contact modelling, licentiate thesis, KTH Stockholm (2014).",
    "A. E. H. Love, Phil. Trans. R. Soc. A 228 (1929) 377 (influence coefficients).",
    "I. A. Polonsky and L. M. Keer, Wear 231 (1999) 206 (projected conjugate gradients).",
    "E. A. H. Vollebregt, J. Comput. Phys. 257 (2014) 333 (preconditioning of rough contact).",
    "IEC 61260-1:2014 (one-third octaves, base 10).",
)


def layout(computed: Computed, caught: list[warnings.WarningMessage]) -> xarray.DataTree:
    """Lay out what was computed, with units and provenance.

    Parameters
    ----------
    computed : Computed
        Textures, reduction and runs.
    caught : list of WarningMessage
        Warnings met on the way; those of laying out may still be added to it.

    Returns
    -------
    xarray.DataTree
        Groups scenario, surface, contact, rolling, spectra.
    """
    spectra = _spectra(computed)
    groups = {
        "/scenario": _scenario(computed),
        "/surface": _surface(computed),
        "/contact": _contact(computed),
        "/rolling": _rolling(computed),
        "/spectra": spectra,
    }
    tree = xarray.DataTree.from_dict(groups)
    tree.attrs = {
        "title": f"{computed.case.ball.material} ball on a {computed.case.beam.material} beam",
        "asperity_version": __version__,
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "case": computed.case.text,
        "seed": computed.case.seed,
        "citations": json.dumps(CITATIONS),
        "verdict": verdict(computed.runs, spectra),
        "warnings": json.dumps(_collected(caught), ensure_ascii=False),
    }
    return checked(tree)


def _collected(caught: list[warnings.WarningMessage]) -> list[dict[str, Any]]:
    physics = [m for m in caught if issubclass(m.category, PhysicsWarning)]
    counts = Counter((m.category.__name__, str(m.message)) for m in physics)
    return [
        {"category": category, "message": message, "count": n} for (category, message), n in counts.items()
    ]


def _scenario(computed: Computed) -> xarray.Dataset:
    return xarray.Dataset(
        attrs={
            "kind": computed.case.kind,
            "parameters": json.dumps(computed.case.parameters(), ensure_ascii=False),
            "numerics": json.dumps(list(_numerics(computed)), ensure_ascii=False),
            "laws": json.dumps({n: _meaning(n) for n in computed.laws}, ensure_ascii=False),
        }
    )


def _meaning(name: str) -> str:
    base, _, filtered = name.partition("-")
    return LAWS[base].meaning + (" With the filtered line texture." if filtered else "")


def _numerics(computed: Computed) -> Iterable[dict[str, str]]:
    case, n = computed.case, computed.shape.body.shape[0]
    steps = max(len(r.time) for r in computed.runs.values()) - 1
    yield {"name": "time step", "value": f"{case.time_step * 1e6:.4g} µs"}
    yield {"name": "time steps", "value": f"{steps}"}
    yield {"name": "beam modes", "value": f"{len(computed.beam.natural_frequencies)}"}
    yield {"name": "contact window", "value": f"{n} × {n} cells of {case.contact.spacing * 1e6:.4g} µm"}
    if computed.reduction is not None:
        solves, iterations = computed.reduction.solves, computed.reduction.iterations
        yield {"name": "contacts solved for the filters", "value": f"{solves}"}
        yield {"name": "iterations per contact", "value": f"{iterations / max(solves, 1):.1f}"}
        yield {"name": "filter order J", "value": f"{computed.reduction.taps.shape[1] - 1}"}
    if computed.scan is not None:
        solves = int(np.count_nonzero(computed.scan.forces))
        yield {"name": "contacts solved for the table", "value": f"{solves}"}
        yield {"name": "contacts of the table not converged", "value": f"{computed.scan.unconverged}"}
    for name, run in computed.runs.items():
        residual = f"{run.energy.residual:.1e}"
        yield {"name": f"energy residual, {name}", "value": residual}
        yield {"name": f"time steps not converged, {name}", "value": f"{run.unconverged_steps}"}
    for name, seconds in computed.seconds.items():
        yield {"name": f"wall time, {name}", "value": f"{seconds:.2f} s"}


def _surface(computed: Computed) -> xarray.Dataset:
    textures, dx = computed.textures, computed.shape.spacing[0]
    variables: dict[str, xarray.Variable] = {}
    statistics: list[dict[str, Any]] = []
    if textures.maps:
        first = textures.maps[0]
        variables |= {
            "x": variable("x", np.arange(first.shape[0]) * dx, "m", "rolling direction"),
            "y": variable("y", np.arange(first.shape[1]) * dx, "m", "across"),
            "sample_heights": variable(("x", "y"), first.heights, "m", "height of the first sample"),
        }
        statistics += _listed(areal_statistics(first), "samples")
    if textures.path is not None:
        piece = textures.path.heights[textures.margin :][:PATH_ROWS]
        variables |= {
            "path_x": variable("path_x", np.arange(len(piece)) * dx, "m", "rolling direction"),
            "path_y": variable("path_y", np.arange(piece.shape[1]) * dx, "m", "across"),
            "path_heights": variable(("path_x", "path_y"), piece, "m", "height of the path"),
        }
        statistics += _listed(areal_statistics(HeightMap(piece, textures.path.spacing)), "path")
    else:
        statistics += _listed(profile_statistics(Profile(textures.line, dx)), "path")
    line = textures.line[textures.margin : len(textures.line) - textures.margin][:LINE_POINTS]
    variables["distance"] = variable("distance", np.arange(len(line)) * dx, "m", "distance along the path")
    variables["line"] = variable("distance", line, "m", "height along the middle of the path")
    variables |= _texture_spectra(computed)
    attrs = {
        "statistics": json.dumps(statistics, ensure_ascii=False),
        "source": textures.origin,
        "missing_share": textures.missing_share,
    }
    return xarray.Dataset(variables, attrs=attrs)


def _listed(statistics: list[Statistic], where: str) -> list[dict[str, Any]]:
    return [
        {
            "symbol": s.symbol,
            "value": s.value if np.isfinite(s.value) else None,
            "unit": s.unit,
            "bandwidth": f"{_length(s.bandwidth[0])} … {_length(s.bandwidth[1])}",
            "surface": where,
            "meaning": s.meaning,
        }
        for s in statistics
    ]


def _length(metres: float) -> str:
    return f"{metres * 1e3:.3g} mm" if metres >= 1e-3 else f"{metres * 1e6:.3g} µm"


def _texture_spectra(computed: Computed) -> dict[str, xarray.Variable]:
    """Spectra of samples and path in the rolling direction, on the samples' wavenumbers."""
    textures, dx = computed.textures, computed.shape.spacing[0]
    result: dict[str, xarray.Variable] = {}
    wavenumber: NDArray[np.floating[Any]]
    units, dims = "m3", "surface_wavenumber"
    if textures.maps:
        spectra = [psd_1d(m)[1] for m in textures.maps]
        wavenumber = psd_1d(textures.maps[0])[0]
        sampled = np.mean([s[1:] for s in spectra if s.shape == spectra[0].shape], axis=0)
        result["psd_sample"] = variable(dims, sampled, units, "PSD of the samples along the path, one-sided")
        segment = textures.maps[0].shape[0]
    else:
        segment = max(16, len(textures.line) // 8)
        wavenumber = np.fft.rfftfreq(segment, dx)
    lines = textures.line if textures.path is None else np.ascontiguousarray(textures.path.heights.T)
    if segment <= len(textures.line):
        k, density = psd(lines, dx, segment=segment)
        mean = np.atleast_2d(density).mean(axis=0)
        along = np.interp(wavenumber[1:], k, mean)
        result["psd_path"] = variable(dims, along, units, "PSD of the path along it, one-sided")
    if result:
        result[dims] = variable(dims, wavenumber[1:], "1/m", "wavenumber, cycles per metre")
    return result


def _contact(computed: Computed) -> xarray.Dataset:
    shape, reduction = computed.shape, computed.reduction
    attrs: dict[str, Any] = {
        "hertz_radius": shape.semi_axes[0],
        "working_load": shape.load,
        "contact_modulus": shape.modulus,
    }
    if reduction is None:
        return _hertz_only(computed, attrs)
    ensemble, working = reduction.ensemble, reduction.working
    attrs |= {
        "datum": ensemble.datum,
        "working_approach": reduction.working_approach,
        "contact_area": working.area,
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
            "F/δ of smooth bodies (Hertz), at δ = r − d0",
        ),
        "contact_radius": variable(
            "approach", reduction.semi_axes[:, 0], "m", "radius of the nominal patch at the mean force"
        ),
    }
    n = shape.body.shape[0]
    across = (np.arange(n) - n // 2) * shape.spacing[0]
    variables |= {
        "px": variable("px", across, "m", "rolling direction, from the middle of the contact"),
        "py": variable("py", across, "m", "across, from the middle of the contact"),
        "pressure": variable(("px", "py"), working.pressure, "Pa", "contact pressure at the working load"),
        "gap": variable(("px", "py"), working.gap, "m", "gap after deformation at the working load"),
    }
    return xarray.Dataset(variables | _filters(computed), attrs=attrs)


def _filters(computed: Computed) -> dict[str, xarray.Variable]:
    """Filters on the approaches of all states; NaN where a state carries too little load to have one."""
    reduction = computed.reduction
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


def _hertz_only(computed: Computed, attrs: dict[str, Any]) -> xarray.Dataset:
    """Contact of smooth bodies, and its closed-form filter, where a case has no samples."""
    hertz, load = computed.shape.hertz, computed.shape.load
    approach = np.linspace(0.0, 2.0 * hertz.approach(load), 41)[1:]
    radius = np.array([hertz.semi_axes(d)[0] for d in approach])
    wavenumber = np.geomspace(0.01, 2.0, 120) / computed.shape.semi_axes[0]
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


def _rolling(computed: Computed) -> xarray.Dataset:
    runs = list(computed.runs.values())
    laws, sensors = list(computed.runs), np.array(computed.case.beam.sensor_positions)

    terms = list(runs[0].energy.terms())
    energy = np.array([[run.energy.terms()[t] for t in terms] for run in runs])
    events = np.array([len(run.contact_loss) for run in runs])
    return xarray.Dataset(
        {
            "law": variable("law", np.array(laws), "1", "contact law"),
            "sensor": variable("sensor", sensors, "m", "position of the accelerometer on the beam"),
            "time": variable("time", runs[0].time, "s", "time"),
            "position": variable("time", runs[0].position, "m", "position of the contact on the beam"),
            "contact_force": variable(("law", "time"), _stack(runs, "contact_force"), "N", "contact force"),
            "relative_displacement": variable(
                ("law", "time"),
                _stack(runs, "relative_displacement"),
                "m",
                "approach of the mean surfaces, positive closing",
            ),
            "acceleration": variable(
                ("law", "sensor", "time"),
                _stack(runs, "acceleration"),
                "m/s2",
                "acceleration of the beam, positive downwards",
            ),
            "ball_displacement": variable(
                ("law", "time"),
                _stack(runs, "ball_displacement"),
                "m",
                "displacement of the ball, positive downwards",
            ),
            "beam_displacement": variable(
                ("law", "time"),
                _stack(runs, "beam_displacement"),
                "m",
                "displacement of the beam under the ball, positive downwards",
            ),
            "contact_loss_share": variable(
                "law", _stack(runs, "contact_loss_share"), "1", "share of the time without contact"
            ),
            "contact_loss_events": variable("law", events, "1", "losses of contact"),
            "longest_loss": variable(
                "law", _stack(runs, "longest_loss"), "s", "longest time without contact"
            ),
            "energy_term": variable("energy_term", np.array(terms), "1", "term of the energy balance"),
            "energy": variable(("law", "energy_term"), energy, "J", "energy since the start"),
            "energy_residual": variable(
                "law",
                np.array([run.energy.residual for run in runs]),
                "1",
                "what the energy balance leaves open, relative to the throughput",
            ),
        }
    )


def _spectra(computed: Computed) -> xarray.Dataset:
    step, highest = computed.case.time_step, computed.case.numerics.highest_frequency
    runs = list(computed.runs.values())
    samples = len(runs[0].time)
    segment = min(samples, round(SEGMENT / step))
    frequency, force = psd(_stack(runs, "contact_force"), step, segment=segment)
    _, acceleration = psd(_stack(runs, "acceleration"), step, segment=segment)
    band, force_level = band_levels(frequency, force, high=highest)
    _, acceleration_level = band_levels(frequency, acceleration, ACCELERATION_REFERENCE, high=highest)
    shown = (frequency > 0.0) & (frequency <= 1.13 * highest)
    laws = list(computed.runs)
    by_law, by_sensor = ("law", "frequency"), ("law", "sensor", "frequency")
    variables = {
        "law": variable("law", np.array(laws), "1", "contact law"),
        "sensor": variable(
            "sensor", np.array(computed.case.beam.sensor_positions), "m", "position of the accelerometer"
        ),
        "frequency": variable("frequency", frequency[shown], "Hz", "frequency"),
        "band": variable("band", band, "Hz", "one-third-octave band centre"),
        "force_psd": variable(by_law, force[:, shown], "N2/Hz", "PSD of the contact force, one-sided"),
        "force_level": variable(("law", "band"), force_level, "dB re 1 N", "contact force level"),
        "acceleration_psd": variable(
            by_sensor, acceleration[..., shown], "(m/s2)2/Hz", "PSD of the beam acceleration, one-sided"
        ),
        "acceleration_level": variable(
            ("law", "sensor", "band"), acceleration_level, "dB re 1e-6 m/s2", "acceleration level"
        ),
    }
    if "linear" in laws:
        difference = force_level - force_level[laws.index("linear")]
        variables["force_level_difference"] = variable(
            ("law", "band"), difference, "dB", "force level over that of the linear contact"
        )
    reference = next((name for name in ("direct", "table") if name in laws), None)
    if reference is not None:
        difference = force_level - force_level[laws.index(reference)]
        variables["force_level_difference_to_reference"] = variable(
            ("law", "band"), difference, "dB", f"force level over that of {reference}", reference=reference
        )
    return xarray.Dataset(variables)


def _stack(runs: list[Rolling], name: str) -> NDArray[np.float64]:
    return np.stack([getattr(run, name) for run in runs])
