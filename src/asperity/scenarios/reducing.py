"""The reduction of a case: from textures to the state functions and line filters that the laws use."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from asperity.arguments import Array
from asperity.case import scene, sections
from asperity.contact import scan
from asperity.contact.batched import find_device
from asperity.contact.halfspace import HalfSpace
from asperity.contact.solved import Contact
from asperity.errors import ContactFilterWarning, InputError
from asperity.laws import LawSpec, Need, spec_of
from asperity.progress import Progress, counted
from asperity.reduction import filter, stiffness, texture
from asperity.scenarios.geometry import Geometry
from asperity.scenarios.scene import PreparedCase
from asperity.scenarios.textures import Textures
from asperity.store import Store
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.strip import Strip
from asperity.threads import in_order, thread_count
from asperity.written_numbers import in_newtons, rounded

STATES = 16
"""States chosen where the case names no approaches; up to twice as many where the path is touched earlier."""
EVENLY = 1.0 / 3.0
"""Power of the mean force in which chosen states are evenly apart: close where asperities join in, and half a
working approach under the largest force, where F^(2/3) is all but straight."""
PRESSED = 5
"""Forces for which approaches are found before states are chosen."""
LIGHTEST_STATE = 0.02
"""Mean force of the lowest chosen state, in loads of the class of the working load."""
FILTERED = 2.0
"""Times that the mean force of a state with a filter may lie outside the forces that chosen states cover."""
SCAN_TOLERANCE = "numerics.force_accuracy"
"""Key of a case that says how tightly contacts of scans and loading curves are solved."""
LEAST_DATUM = 1e-12
"""Least datum, m: above the rounding of a touch at zero, between smooth bodies."""


@dataclass(frozen=True, eq=False)
class PressedSamples:
    """Samples of a case under its working load, and the smooth body beside them."""

    half_space: HalfSpace  # on which the areas of the smooth body and tangent stiffnesses are taken
    contacts: list[Contact]
    smooth: Contact

    @property
    def approach(self) -> float:
        """Mean approach, m."""
        return float(np.mean([each.approach for each in self.contacts]))

    @property
    def stiffnesses(self) -> Array:
        """Tangent stiffness of each sample (N,), N/m."""
        return np.array([self.half_space.tangent_stiffness(each.pressure) for each in self.contacts])

    @property
    def area_ratio(self) -> float:
        """Contact area over that of smooth bodies, mean."""
        return float(np.mean([each.area for each in self.contacts])) / self.smooth.area

    @property
    def isolated_share(self) -> float:
        """Share of the load on cells that touch alone, mean."""
        return float(np.mean([stiffness.isolated_share(each.pressure) for each in self.contacts]))


def samples_of(
    case: scene.Case, shape: Geometry, maps: Iterable[HeightMap], axes: tuple[float, float]
) -> list[Array]:
    """Samples (nx, ny) of a case, cut from maps, about the plane felt by a patch of these semi-axes, m."""
    cells = (shape.body.shape[0], shape.body.shape[1])
    weights = texture.punch_weights(shape.spacing, axes)
    return stiffness.patches([each.heights for each in maps], cells, case.contact.samples, weights)


@dataclass(frozen=True, eq=False)
class Reduction:
    """State functions of a case."""

    approaches: Array  # (k,), of the states from the plane that the nominal patch feels, m
    ensemble: stiffness.StiffnessEnsemble  # loading curves
    # d0, m, by what it counts from: ``"samples"``, or ``"path"`` with strips and path as well
    datums: dict[str, float]
    semi_axes: Array  # (k, 2), of the nominal patch at the mean force of each state, m
    filters: "LineFilters"  # of the states that carry load, on their own approaches, by normalisation
    pressed: PressedSamples  # under the working load
    remedy: str  # a window that holds the contacts of all states
    counts: scan.Counts  # contact solutions done for the filters


def patch_planes(path: Strip, shape: Geometry) -> Array:
    """Height (rows,) of the plane that the nominal patch feels at each row of a path, m, peaks positive.

    The mean under the patch of the class of the geometry's working load, centred on each row.
    """
    return -texture.areal_texture(path, shape.spacing, [0.0], [shape.class_axes]).heights[0]


def reduce(prepared: PreparedCase, planes: Array | None, progress: Progress) -> Reduction:
    """Press and move the body on the samples, and reduce the forces to stiffness and filters.

    `planes` (rows,), m, are from `patch_planes` for the path, where it is areal. The cache keeps finished
    scans.
    """
    case = prepared.case
    shape = prepared.shape
    textures = prepared.textures
    contact = case.contact
    numerics = case.numerics
    half_space = shape.half_space(contact.hardness)
    samples = samples_of(case, shape, textures.maps, shape.class_axes)
    pressed = PressedSamples(
        half_space,
        [half_space.solve(shape.body - each, load=shape.load, rtol=numerics.rtol) for each in samples],
        half_space.solve(shape.body, load=shape.load, rtol=numerics.rtol),
    )
    along = None
    if textures.path is not None and planes is not None:
        along = _touches(textures.path, planes, shape)
    lowest = {"samples": min(float(scan.first_touch(each, shape.body).min()) for each in samples)}
    strips = [float(scan.first_touch(each.heights, shape.body).min()) for each in textures.strips]
    lowest["path"] = min(lowest["samples"], *strips, *([] if along is None else [float(along.min())]))
    approaches = _approaches(prepared, along, samples)
    refuse_uneven_states(approaches, textures)
    remedy = shape.remedy_for_cut_off(float(approaches[-1]), -lowest["path"])
    ensemble = stiffness.stiffness_ensemble(
        samples, half_space, shape.body, approaches, 0.0, rtol=scan.rtol_for(numerics.force_accuracy),
        progress=progress, tolerance=SCAN_TOLERANCE, remedy=remedy,
    )  # fmt: skip
    mean = ensemble.mean_force
    if contact.approaches is None and np.count_nonzero(mean) < 2:
        raise _too_rough(textures, f"contact in {np.count_nonzero(mean)} of {len(mean)} states")
    refuse_low_states(approaches, mean, shape, pressed.contacts[0].approach)
    # the curve, drawn through few states, may start a little before the first touch
    curve = ensemble.curve.first_touch
    datums = {name: -min(touch, curve, -LEAST_DATUM) for name, touch in lowest.items()}
    ensemble = replace(ensemble, datum=datums[contact.datum])
    filters, counts = line_filters(prepared, ensemble, progress)
    scan.warn_of_flaws(counts, "the filters", SCAN_TOLERANCE, remedy)
    axes = np.array([shape.axes(f) for f in mean])
    return Reduction(approaches, ensemble, datums, axes, filters, pressed, remedy, counts)


def filtered_loads(contact: sections.ContactKeys, shape: Geometry) -> tuple[float, float]:
    """Least and largest mean force of a state that has a filter, N.

    Chosen states go on to where the flattest place carries the largest force, and others carry far more.
    """
    largest = shape.largest_force if contact.approaches is None else math.inf
    return LIGHTEST_STATE * shape.class_load / FILTERED, largest * FILTERED


def refuse_low_states(approaches: Array, highest: Array, shape: Geometry, working_approach: float) -> None:
    """Refuse states (k,), m, that do not reach the working load, or of which only one is in contact.

    `highest` are the mean forces of the samples in the last states, two or more, N; the working approach, m,
    is that of a sample under the load.
    """
    reached = (
        f"up to {rounded(approaches[-1] * 1e6, 4)} um, where the samples carry {in_newtons(highest[-1])}"
    )
    if highest[-1] < shape.load:
        allowed = f"approaches that reach the working load of {in_newtons(shape.load)} and beyond"
        remedy = f"Go to {rounded(2e6 * working_approach)} um or more, or leave the key out."
        raise InputError("contact.approaches", reached, allowed, remedy)
    if not highest[-2] > 0.0:
        received = f"{reached}, and none at {rounded(approaches[-2] * 1e6, 4)} um"
        remedy = f"Add some around {rounded(1e6 * working_approach)} um, or leave the key out."
        raise InputError("contact.approaches", received, "at least two approaches in contact", remedy)


def refuse_uneven_states(approaches: Array, textures: Textures) -> None:
    """Refuse states (k,), m, that do not rise, as those of samples that no contact can be followed on."""
    if not (np.isfinite(approaches).all() and (np.diff(approaches) > 0.0).all()):
        raise _too_rough(textures, f"first touch at {rounded(1e6 * approaches[0])} um")


def _too_rough(textures: Textures, sign: str) -> InputError:
    """Error about samples on which no contact can be followed from touch to load."""
    rms = float(np.mean([np.std(sample.heights) for sample in textures.maps]))
    allowed = "heights that are small against the window, and states of contact from the touch to the load"
    received = f"samples of {rounded(1e6 * rms)} um rms, with {sign}"
    return InputError("surface", received, allowed, "Check the unit of the heights.")


def _touches(strip: Strip | Array, planes: Array, shape: Geometry) -> Array:
    """First touch at every row on which the window may begin, from the plane at its middle row, m."""
    half = shape.body.shape[0] // 2
    return scan.first_touch(strip, shape.body) + planes[half : len(planes) - half]


def _approaches(prepared: PreparedCase, along: Array | None, samples: Sequence[Array]) -> Array:
    """States as given, or by the load that places carry.

    Those of the samples do not depend on the path; more lie below where it is touched earlier, by whole
    steps: paths of other lengths over the same surface have them in common.
    """
    contact = prepared.case.contact
    shape = prepared.shape
    if contact.approaches is not None:
        return np.array(contact.approaches)
    places = touched_places(prepared.textures, shape)
    states = chosen_states([*samples, *places], shape, shape.half_space(contact.hardness))
    if along is None or len(states) < 2:
        return states
    earlier = min(float((shape.body - place).min()) for place in places) - float(along.min())
    step = 2.0 * (states[1] - states[0])
    count = min(math.ceil(max(earlier, 0.0) / step), STATES)
    return np.concatenate([states[0] - max(step, earlier / max(count, 1)) * np.arange(count, 0, -1), states])


def touched_places(textures: Textures, shape: Geometry) -> list[Array]:
    """Places (nx, ny) of each strip that are touched first and last, levelled to their patch planes, m.

    A few samples seldom meet the highest peak, nor the flattest place, which takes the largest forces last.
    """
    places = []
    nx = shape.body.shape[0]
    for strip in textures.strips:
        planes = patch_planes(strip, shape)
        touches = _touches(strip.heights, planes, shape)
        for row in (int(np.argmin(touches)), int(np.argmax(touches))):
            places.append(strip.heights[row : row + nx] - planes[row + nx // 2])
    return places


def chosen_states(places: Sequence[Array], shape: Geometry, half_space: HalfSpace) -> Array:
    """States from a light load to the largest force at all of some places (nx, ny), m; shape (STATES,).

    From the touch of a place to its load F^(2/3) is bent, and straight beyond: few states suffice where many
    places carry much, many are wanted where few carry little. So they are even in a low power of the mean.
    """
    light = LIGHTEST_STATE * shape.class_load
    forces = np.geomspace(light, shape.largest_force, PRESSED)
    curves = []
    for place in places:
        approaches = []
        start = None
        for force in forces:
            contact = half_space.solve(shape.body - place, load=force, start=start, rtol=1e-3)
            approaches.append(contact.approach)
            start = contact.pressure
        curves.append(stiffness.ForceCurve.from_samples(approaches, forces))
    lowest = min(curve.first_touch for curve in curves)
    highest = max(float(curve.inverse(shape.largest_force)) for curve in curves)
    at = np.linspace(lowest, highest, 64 * STATES)
    mean = np.mean([curve.force(at) for curve in curves], axis=0)
    even = np.linspace(light**EVENLY, mean[-1] ** EVENLY, STATES)
    return np.interp(even, mean**EVENLY, at)


def nominal_forces(shape: Geometry) -> Array:
    """Mean forces that `chosen_states` aims at, (STATES,), N."""
    light = LIGHTEST_STATE * shape.class_load
    return np.linspace(light**EVENLY, shape.largest_force**EVENLY, STATES) ** (1.0 / EVENLY)


# --- line filters: scanned on the strips, normalised as the laws want, designed for the path

LONG_WAVE = 0.5
"""k a below which a filter is taken to be at its asymptote: sin q/q is 0.96 there."""
LEAST_LONG_WAVES = 0.5
"""Least share of the lines' power at such wavenumbers for which the printed asymptote is one."""
LARGEST_MISS = 1.0
"""Largest distance of an applied filter from its fit that passes without a warning, dB."""
SHOWN = 3
"""States to one with a filter, counted from the highest, where no law filters a line."""
SMOOTH_WAVENUMBERS = 120
"""Wavenumbers of the closed-form filter where a case has no texture."""

LineFilters = Mapping[filter.Normalise, filter.LineFilter]


def normalisation(asked: str | None, law: LawSpec) -> filter.Normalise:
    """How the filter of a law is normalised: as is asked for, else as the law wants it."""
    return law.normalise if asked is None else asked  # type: ignore[return-value]


def filter_stride(shape: Geometry) -> int:
    """Rows of the contact grid between the positions of a scan for a filter: a sixth of the patch."""
    return max(1, math.floor(shape.class_axes[0] / 6 / shape.spacing[0]))


def line_filters(
    prepared: PreparedCase, ensemble: stiffness.StiffnessEnsemble, progress: Progress
) -> tuple[LineFilters, scan.Counts]:
    """Scan the strips, and design a filter for every normalisation that a law needs, or that is shown.

    That of the tangent stiffness is shown in any case, unless the case names another: in one of `SHOWN`
    states, if no law needs one. States whose mean force is out of `filtered_loads` have no filter. Filters of
    bodies without texture are sin q/q in closed form.
    """
    case = prepared.case
    shape = prepared.shape
    textures = prepared.textures
    contact = case.contact
    force = ensemble.mean_force
    needing = [spec for spec in map(spec_of, case.laws) if Need.FILTER in spec.needs]
    least, largest = filtered_loads(contact, shape)
    loaded = (force >= least) & (force <= largest)
    if not needing:
        loaded = np.isin(np.arange(len(force)), np.flatnonzero(loaded)[::-SHOWN])
    shown: filter.Normalise = contact.normalise or "tangent"  # type: ignore[assignment]
    needed = dict.fromkeys([shown, *(normalisation(contact.normalise, spec) for spec in needing)])
    approaches = ensemble.approaches[loaded]
    loads = FilteredStates(approaches, force[loaded], ensemble.curve.stiffness(approaches))
    return filters_of(
        textures.strips, shape, loads, tuple(needed), hardness=contact.hardness,
        accuracy=case.numerics.force_accuracy, degree=contact.filter_degree, order=contact.filter_taps,
        most=len(textures.line) - 1, progress=progress, lines=textures.averaged.strips,
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class FilteredStates:
    """States (s,) that have a filter."""

    approaches: Array  # m
    forces: Array  # mean of the samples, N
    tangents: Array  # its slopes, N/m


def filters_of(
    strips: Sequence[HeightMap],
    shape: Geometry,
    states: FilteredStates,
    needed: Sequence[filter.Normalise],
    *,
    hardness: float | None,
    accuracy: float,
    most: int,
    degree: int | None = None,
    order: int | None = None,
    progress: Progress | None,
    lines: Sequence[HeightMap] | None = None,
) -> tuple[LineFilters, scan.Counts]:
    """Scan strips in some states, and design the filter of each normalisation, of so many taps at most.

    Forces follow the lines of the strips, or those of others where what is pressed are means over cells. Of
    strips without texture it is sin q/q in closed form.
    """
    dx = shape.spacing[0]
    approaches = states.approaches
    tangent = states.tangents
    axes = np.array([shape.axes(f) for f in states.forces])
    if not any(np.ptp(strip.heights) for strip in strips):
        wavenumber = np.geomspace(0.01, 2.0, SMOOTH_WAVENUMBERS) / axes[:, 0].max()
        smooth = filter.closed_form(approaches, wavenumber, axes[:, 0], tangent)
        taps = filter.punch_taps(axes[:, 0], dx)
        return dict.fromkeys(needed, filter.LineFilter(smooth, taps, dx)), scan.total([])
    half_space = shape.half_space(hardness)
    device = find_device()
    stride = filter_stride(shape)
    rtol = scan.rtol_for(scan.FILTER_SHARE * accuracy)
    jobs = [
        scan.ScanJob(half_space, strip, shape.body, approaches, stride, rtol, device=device)
        for strip in strips
    ]
    scans = _scanned_strips(jobs, progress)
    half = shape.body.shape[0] // 2
    beside = (axes[:, 1] / shape.spacing[1]).astype(int)
    spectra = []
    for strip, scanned in zip(lines or strips, scans, strict=True):
        rows = scanned.forces.shape[1] * stride
        # the lines under the patch of each state, at every row of the grid
        spectra.append(filter.filter_spectra(scanned.forces, strip.heights[half : half + rows].T, dx, beside))
    fewest = filter.tap_count(dx, float(axes[:, 0].max()))
    filters = {}
    for normalise in needed:
        estimated = filter.estimate_filter(
            spectra, approaches, tangent, normalise=normalise, degree=degree,
            asymptote=LONG_WAVE / (2 * math.pi * axes[:, 0]),
        )  # fmt: skip
        filters[normalise] = filter.design_fir(estimated, dx, order, least=fewest, most=most)
    return filters, scan.total(each.counts for each in scans)


def _scanned_strips(jobs: Sequence[scan.ScanJob], progress: Progress | None) -> list[scan.ScannedForces]:
    """Forces at constant approach along each strip."""
    workers = thread_count() if jobs[0].device is None else 1  # one block fills a device

    def scanned(job: scan.ScanJob) -> scan.ScannedForces:
        # one strip is a block or two: strips beside each other keep all processors busy
        return scan.scan_forces(job, cache=Store(), workers=math.ceil(workers / len(jobs)), beside=jobs)

    scans = in_order(scanned, jobs, workers)
    return list(counted(scans, len(jobs), "scanning for the contact filters", progress))


_SHORTER = ": the report shows both. Leave out contact.filter_taps, or roll over a longer path."
_NORMALISED = 'Set contact.normalise = "tangent", or take a law that has it by default.'
_WITHOUT_KEY = "Take a law whose filter is one at the tangent stiffness, as shifted."


def warn_of_filter(
    found: filter.LineFilter, law: str, working_approach: float, *, has_keys: bool = True
) -> None:
    """Say what of a filter a law that uses it should not rest on, with the working approach, m.

    That the texture lacks the long waves at which the printed filter is one, or that the taps miss the fit;
    and what helps, of a case that has keys for it.
    """
    if found.miss > LARGEST_MISS:
        order = found.taps.shape[1] - 1
        ContactFilterWarning.warn(
            f"the filter of the law {law} with J = {order} misses the fitted one by "
            f"{rounded(found.miss, 2)} dB above −30 dB{_SHORTER if has_keys else '.'}"
        )
    estimated = found.contact_filter
    share = float(np.interp(working_approach, estimated.approaches, estimated.long_wave_share))
    if estimated.normalise == "tangent" or share >= LEAST_LONG_WAVES:
        return
    ratios = estimated.asymptotic_stiffness / estimated.tangent_stiffness
    ratio = float(np.interp(working_approach, estimated.approaches, ratios))
    ContactFilterWarning.warn(
        f"only {100 * share:.0f} % of the texture's power lies in waves with k a < {LONG_WAVE:g}, where the "
        f"filter of the law {law} is set to one: k_0/k_t = {ratio:.2f} under the working load, so its "
        f"force keeps {-20 * math.log10(ratio):.1f} dB that the contact averages away across the path. "
        f"{_NORMALISED if has_keys else _WITHOUT_KEY}"
    )
