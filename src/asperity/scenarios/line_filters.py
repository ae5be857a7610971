"""The line filters of a case: scanned on its strips, normalised as its laws want, designed for its path."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from asperity.config.sections import ContactCase
from asperity.contact.batched import find_device
from asperity.contact.scan import ScanJob, ScannedForces, scan_forces
from asperity.errors import ContactFilterWarning
from asperity.laws import LawSpec, Need, spec_of
from asperity.progress import Progress
from asperity.reduction.filter import (
    FilterSpectra,
    LineFilter,
    Normalise,
    closed_form,
    design_fir,
    estimate_filter,
    filter_spectra,
    punch_taps,
    tap_count,
)
from asperity.reduction.stiffness import StiffnessEnsemble
from asperity.scenarios.geometry import Geometry
from asperity.scenarios.textures import Textures
from asperity.store import Cache
from asperity.surfaces.heightmap import HeightMap
from asperity.threads import in_order, thread_count

LONG_WAVE = 0.5
"""k a below which a filter is taken to be at its asymptote: sin q/q is 0.96 there."""
LEAST_LONG_WAVES = 0.5
"""Least share of the lines' power at such wavenumbers for which the printed asymptote is one."""
LARGEST_MISS = 1.0
"""Largest distance of an applied filter from its fit that passes without a warning, dB."""
SMOOTH_WAVENUMBERS = 120
"""Wavenumbers of the closed-form filter where a case has no texture."""

LineFilters = Mapping[Normalise, LineFilter]


def normalisation(contact: ContactCase, law: LawSpec) -> Normalise:
    """How the filter of a law is normalised: as the case says, else as the law wants it."""
    return law.normalise if contact.normalise is None else contact.normalise  # type: ignore[return-value]


def normalisations(contact: ContactCase, laws: Iterable[str]) -> tuple[Normalise, ...]:
    """List the normalisations that laws need, each once, behind the one that is shown in any case."""
    filtered = (spec for spec in map(spec_of, laws) if Need.FILTER in spec.needs)
    shown: Normalise = contact.normalise or "tangent"  # type: ignore[assignment]
    return tuple(dict.fromkeys([shown, *(normalisation(contact, law) for law in filtered)]))


def filter_stride(shape: Geometry) -> int:
    """Rows of the contact grid between the positions of a scan for a filter: a sixth of the patch."""
    return max(1, math.floor(shape.class_axes[0] / 6 / shape.spacing[0]))


def line_filters(
    contact: ContactCase,
    textures: Textures,
    shape: Geometry,
    ensemble: StiffnessEnsemble,
    loads: tuple[float, float],
    needed: Iterable[Normalise],
    *,
    rtol: float,
    cache: Cache | None,
    progress: Progress,
) -> tuple[LineFilters, list[ScannedForces[NDArray[np.float64]]]]:
    """Scan the strips, and design a filter for every normalisation that is needed; return them and the scans.

    States whose mean force is not between two `loads`, N, have no filter. Filters of bodies without texture
    are sin q/q in closed form.
    """
    dx, force = shape.spacing[0], ensemble.mean_force
    loaded = (force >= loads[0]) & (force <= loads[1])
    approaches, curve = ensemble.approaches[loaded], ensemble.curve
    tangent = curve.stiffness(approaches)
    axes = np.array([shape.axes(f) for f in force[loaded]])
    if not any(np.ptp(strip.heights) for strip in textures.strips):
        wavenumber = np.geomspace(0.01, 2.0, SMOOTH_WAVENUMBERS) / axes[:, 0].max()
        smooth = closed_form(approaches, wavenumber, axes[:, 0], tangent)
        taps = punch_taps(axes[:, 0], dx)
        return dict.fromkeys(needed, LineFilter(smooth, taps, dx)), []
    half_space, device = shape.half_space(contact.hardness), find_device()
    jobs = [
        ScanJob(half_space, strip, shape.body, approaches, filter_stride(shape), rtol, device=device)
        for strip in textures.strips
    ]
    scans = _scanned(jobs, cache, progress)
    spectra = [
        _spectra(strip, scanned, shape, axes[:, 1])
        for strip, scanned in zip(textures.strips, scans, strict=True)
    ]
    least, most = tap_count(dx, float(axes[:, 0].max())), len(textures.line) - 1
    filters = {}
    for normalise in needed:
        estimated = estimate_filter(
            spectra, approaches, tangent, normalise=normalise, degree=contact.filter_degree,
            asymptote=LONG_WAVE / (2 * math.pi * axes[:, 0]),
        )  # fmt: skip
        filters[normalise] = design_fir(estimated, dx, contact.filter_taps, least=least, most=most)
    return filters, scans


def _scanned(
    jobs: list[ScanJob], cache: Cache | None, progress: Progress
) -> list[ScannedForces[NDArray[np.float64]]]:
    """Forces at constant approach along each strip."""
    workers = thread_count() if jobs[0].device is None else 1  # one block fills a device
    message = "scanning for the contact filters"

    def scan(job: ScanJob) -> ScannedForces[NDArray[np.float64]]:
        # one strip is a block or two: strips beside each other keep all processors busy
        return scan_forces(job, cache=cache, workers=math.ceil(workers / len(jobs)), beside=jobs)

    progress(0, len(jobs), message)
    scans = []
    for scanned in in_order(scan, jobs, workers):
        scans.append(scanned)
        progress(len(scans), len(jobs), message)
    return scans


def _spectra(
    strip: HeightMap,
    scanned: ScannedForces[NDArray[np.float64]],
    shape: Geometry,
    semi_axes: NDArray[np.float64],
) -> FilterSpectra:
    """Spectra of a scan, and of the lines under the patch of each state at every row of the grid."""
    dx, dy = shape.spacing
    half = shape.body.shape[0] // 2
    rows = scanned.forces.shape[1] * filter_stride(shape)
    lines = strip.heights[half : half + rows].T
    return filter_spectra(scanned.forces, lines, dx, (semi_axes / dy).astype(int))


def warn_of_filter(found: LineFilter, law: str, working_approach: float) -> None:
    """Say what of a filter a law that uses it should not rest on, with the working approach, m.

    That the texture lacks the long waves at which the printed filter is one, or that the taps miss the fit.
    """
    if found.miss > LARGEST_MISS:
        order = found.taps.shape[1] - 1
        warnings.warn(
            f"the filter of the law {law} with J = {order} misses the fitted one by {found.miss:.2g} dB "
            "above −30 dB: the report shows both. Leave out contact.filter_taps, or roll over a longer path.",
            ContactFilterWarning,
            stacklevel=2,
        )
    estimated = found.contact_filter
    share = float(np.interp(working_approach, estimated.approaches, estimated.long_wave_share))
    if estimated.normalise == "tangent" or share >= LEAST_LONG_WAVES:
        return
    ratios = estimated.asymptotic_stiffness / estimated.tangent_stiffness
    ratio = float(np.interp(working_approach, estimated.approaches, ratios))
    warnings.warn(
        f"only {100 * share:.0f} % of the texture's power lies in waves with k a < {LONG_WAVE:g}, where the "
        f"filter of the law {law} is set to one: k_0/k_t = {ratio:.2f} under the working load, so its "
        f"force keeps {-20 * math.log10(ratio):.1f} dB that the contact averages away across the path. "
        'Set contact.normalise = "tangent", or take a law that has it by default.',
        ContactFilterWarning,
        stacklevel=2,
    )
