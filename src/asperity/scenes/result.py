"""The result of a case of any kind, laid out as labelled groups: each observer adds what it sees."""

import warnings
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from datetime import UTC, datetime
from typing import Any

import numpy as np
import xarray

from asperity import __version__, laws
from asperity import spectra as bands
from asperity.arguments import Array
from asperity.case.any_case import AnyCase
from asperity.contact.batched import find_device
from asperity.errors import Grade, PhysicsWarning, warn_of_findings
from asperity.progress import Progress
from asperity.reference import cnossos
from asperity.scenarios.law_choice import LawChoice, advised_law
from asperity.scenarios.scene import PreparedCase, force_transfer
from asperity.scenes import creep, measured, noise, observer, roundness, schema, sideways, track, validity
from asperity.scenes.compute import Computed, compute
from asperity.scenes.groups import contact_group, surface_group
from asperity.scenes.population import answers
from asperity.schema import VERSION, Values, group, provenance, rolling, spectra, tree
from asperity.structures.rail_poles import RailBetween, RailPoles
from asperity.structures.track import Track
from asperity.written_numbers import rounded

METHOD = (
    "O. Lundberg, licentiate thesis, KTH Stockholm (2014).",
    "Lundberg, Finnveden, Björklund, Pärssinen and Lopez Arteaga, A nonlinear state-dependent model for "
    "vibrations excited by roughness in rolling contacts, submitted to J. Sound Vib. (2014): its paper A.",
    "Lundberg, Nordborg, Lopez Arteaga and Finnveden, Estimation of nonlinearities in the wheel-rail rolling "
    "noise generation process, ISMA (2014): its paper B.",
    "H. Hertz, J. reine angew. Math. 92 (1882) 156 (contact of smooth bodies).",
)
ROUGH_CONTACT = (
    "A. E. H. Love, Phil. Trans. R. Soc. A 228 (1929) 377 (influence coefficients).",
    "I. A. Polonsky and L. M. Keer, Wear 231 (1999) 206 (projected conjugate gradients).",
    "E. A. H. Vollebregt, A new solver for the elastic normal contact problem using conjugate gradients, "
    "deflation, and an FFT-based preconditioner (2014).",
)
BANDS = ("IEC 61260-1:2014 (one-third octaves, base 10).",)
EXPECTED = ("G. Matheron, Economic Geology 58 (1963) 1246 (kriging, of the expected errors of laws).",)


def computed_result(
    prepared: PreparedCase, progress: Progress, caught: list[warnings.WarningMessage], *, brief: bool = False
) -> xarray.DataTree:
    """Compute a case and lay its result out: surface, contact, rolling and spectra; a track and its pass-by.

    With units and provenance. `caught` are the warnings met on the way; those of laying out may still be
    added to it. In brief without what only a report shows: what the path is like, and the choice of a law
    where nothing depends on it.
    """
    computed = compute(prepared, progress)
    case = computed.case
    scene = computed.scene
    side = sideways.sideways_of(computed)
    over_frequency = spectra_group(computed, None if side is None else side.power)
    choice = validity.choice_of(computed, brief=brief)
    population = answers(computed)
    found = validity.findings(computed, population, choice)
    own = Values()
    in_bands = group(over_frequency)
    losses: Values = {}
    sources = METHOD + (ROUGH_CONTACT if computed.reduction else ()) + BANDS + (EXPECTED if choice else ())
    if isinstance(scene.over, Track):
        highest = case.numerics.highest_frequency
        losses = track.loss_factor_error(computed.track, scene.first, computed.stiffness, highest)
        found += track.findings_of_losses(losses)
        if schema.SOUND_POWER_LEVEL_A in over_frequency:
            found += noise.findings_of_labels(case)
        found += measured.findings_of_measured(case.track, computed.track.nominal, computed.band)
        beside = {} if side is None else sideways.sideways_group(side)
        own = track.track_group(computed, losses) | noise.pass_by_group(case, in_bands, beside)
        creeps = creep.creep_group(computed)
        own |= beside | creeps
        sources += (*scene.over.sources, cnossos.CITATION, *noise.sources_of(case))
        sources += sideways.SOURCES if beside else ()
        sources += creep.SOURCES if creeps else ()
        noise.warn_of_silence(case)
    warn_of_findings(found)
    textures = surface_group(computed, brief=brief)
    reduced = contact_group(computed, found, population)
    expected = {provenance.EXPECTED_ERRORS: choice.entries()} if choice else {}
    scenario = scenario_group(case, _numerics(computed, choice, losses)) | expected
    laid_out = scenario | textures | reduced | rolling_group(computed) | over_frequency | own
    added, more_sources = observer.observed(computed, laid_out)
    sources += more_sources
    result = tree(laid_out | added)
    verdict = validity.verdict(computed, in_bands, found, choice)
    result.attrs = root_attributes(case, case.title, sources, verdict, caught, computed.textures.drawn)
    return result


def scenario_group(case: AnyCase, numerics: Iterable[tuple[str, str]]) -> Values:
    """Lay out what was asked for, and numbers of the computation by their names."""
    return {
        provenance.KIND: case.kind,
        provenance.PARAMETERS: case.parameters(),
        provenance.LAWS: [laws.spec_of(name).entry() for name in case.laws],
        provenance.NUMERICS: [{"name": name, "value": value} for name, value in numerics],
    }


def root_attributes(
    case: AnyCase,
    title: str,
    sources: Sequence[str],
    verdict: str,
    caught: list[warnings.WarningMessage],
    drawn: Mapping[str, str],
) -> dict[str, Any]:
    """What the root of a result says: what was computed, by what, and what is doubtful of it.

    Of what was `drawn`, by part, what its random numbers belong to.
    """
    told: Values = {
        provenance.TITLE: title,
        provenance.ASPERITY_VERSION: __version__,
        provenance.SCHEMA_VERSION: VERSION,
        provenance.CREATED: datetime.now(UTC).isoformat(timespec="seconds"),
        provenance.CASE: case.text,
        **({provenance.IN_MEMORY: held} if (held := case.in_memory) else {}),
        provenance.SEED: case.seed,
        provenance.DRAWN: dict(drawn),
        provenance.CITATIONS: sources,
        provenance.VERDICT: verdict,
        provenance.WARNINGS: _collected(caught),  # those of laying out are among them
    }
    return dict(group(told).attrs)


def _collected(caught: list[warnings.WarningMessage]) -> list[dict[str, Any]]:
    """Warnings on the physics, each once with its number, the gravest first."""
    physics = [m.message for m in caught if isinstance(m.message, PhysicsWarning)]
    counts = Counter((type(m).__name__, str(m), m.grade) for m in physics)
    order = list(Grade)
    return [
        {"category": category, "message": message, "grade": grade.value, "count": n}
        for (category, message, grade), n in sorted(counts.items(), key=lambda c: -order.index(c[0][2]))
    ]


def _numerics(computed: Computed, choice: LawChoice | None, losses: Values) -> Iterator[tuple[str, str]]:
    """Numbers of the computation: names and values."""
    case, (nx, ny), runs = computed.case, computed.shape.body.shape, computed.runs
    yield "time step", f"{rounded(case.time_step * 1e6, 4)} µs"
    yield "time steps", f"{max(len(run.time) for run in runs.values()) - 1}"
    yield "contact window", f"{nx} × {ny} cells of {rounded(case.contact.spacing * 1e6, 4)} µm"
    if (device := find_device()) is not None:
        yield "scans solved on", device.name
    if (reduction := computed.reduction) is not None:
        yield "contacts solved for the filters", f"{reduction.counts.solved}"
        iterations = reduction.counts.iterations / max(reduction.counts.solved, 1)
        yield "iterations per contact", f"{iterations:.1f}"
        orders = {each.taps.shape[1] - 1 for each in reduction.filters.values()}
        yield "filter order J", ", ".join(map(str, sorted(orders)))
    if (scan := computed.scan) is not None:
        precision = "single" if scan.single else "double"
        yield "contacts solved for the table", f"{scan.counts.solved} in {precision} precision"
    if len(computed.scene.offsets) > 1:
        yield "contacts", f"{len(computed.scene.offsets)}"
    yield from _of_structure(computed)
    yield from roundness.planned_roundness(computed)
    yield from track.described_losses(losses)
    yield from advised_law(computed, choice)
    for part, seconds in computed.seconds.items():
        yield f"wall time, {part}", f"{seconds:.2f} s"


def _of_structure(computed: Computed) -> Iterator[tuple[str, str]]:
    over = computed.over
    if isinstance(over, RailBetween):
        weights, step = computed.rail.kernel.weights, computed.rail.kernel.time_step
        yield "start positions of the moving kernel", f"{weights.shape[0]} in a bay"
        yield (
            "length of the moving kernel",
            f"{rounded((weights.shape[1] - 1) * step)} s, {weights.shape[1]} steps",
        )
        if isinstance(over.direct, RailPoles):
            yield "track in time", f"{over.direct.count} poles"
            yield "error of the fitted poles, relative", rounded(over.direct.fit_error, 2)
        else:
            yield "track in time", "scattered from the moving kernel"
    elif over is not None:
        yield "modes of what is rolled over", f"{len(over.natural_frequencies)}"


def rolling_group(computed: Computed) -> Values:
    """Lay out what was recorded in time: each contact, what it is over, each body, energy."""
    case = computed.case
    scene = computed.scene
    stack = computed.stacked
    first = computed.first
    runs = computed.runs.values()
    lost = [[duration for _, duration in run.flights] for run in runs]
    over, rolls = (getattr(schema, name.upper()) for name in case.DISPLACEMENTS)
    laid_out: Values = {
        rolling.LAW: list(computed.runs),
        rolling.TIME: first.time,
        rolling.POSITION: first.positions[0],
        rolling.CONTACT: 1 + np.arange(len(scene.offsets)),
        rolling.OFFSET: scene.offsets,
        rolling.STATIC_LOAD: scene.loads,
        rolling.CONTACT_FORCE: stack("contact_force"),
        rolling.RELATIVE_DISPLACEMENT: stack("relative_displacement"),
        over: stack("over_displacement"),
        rolls: stack("rolling_displacement"),
        rolling.CONTACT_LOSS_SHARE: 1.0 - stack("in_contact").mean(axis=-1),
        rolling.CONTACT_LOSS_EVENTS: [[len(durations) for durations in run] for run in lost],
        rolling.LONGEST_LOSS: [[durations.max(initial=0.0) for durations in run] for run in lost],
        schema.ROLLING_DEGREE: list(scene.degrees),
        schema.BODY_DISPLACEMENT: _motion(computed),
        schema.ENERGY_TERM: list(first.energy.shares),
        schema.ENERGY: [list(run.energy.shares.values()) for run in runs],
        schema.ENERGY_RESIDUAL: [run.energy.residual for run in runs],
        rolling.SPEED: case.speed,
    }
    if sensors := case.rolled_over.sensor_positions:
        laid_out |= {schema.ROLLING_SENSOR: sensors, schema.ACCELERATION: stack("acceleration")}
    if case.point_positions:
        moved, velocity = computed.points
        laid_out |= {schema.ROLLING_POINT: case.point_positions}
        laid_out |= {schema.POINT_DISPLACEMENT: moved, schema.POINT_VELOCITY: velocity}
    return laid_out


def _motion(computed: Computed) -> Array:
    """Degrees of freedom of all bodies (laws, d, n), positive downwards, m."""
    levers = np.array(list(computed.scene.degrees.values()))[:, None]
    return np.stack([-levers * np.concatenate(run.degrees_of_freedom) for run in computed.runs.values()])


def spectra_group(computed: Computed, side: noise.SidewaysPower | None = None) -> Values:
    """Lay out PSDs and one-third octaves of force and motion, and what follows from them for sound.

    With how sure the levels are, and how far the laws are from each other. The sound power of what moves
    sideways, where something does, is that of `asperity.scenes.sideways.Sideways.power`.
    """
    scene = computed.scene
    forces = computed.stacked("contact_force")
    shown = computed.shown
    density = computed.force_psd.mean(axis=1)
    level = computed.levels(density)
    laid_out: Values = {
        spectra.LAW: list(computed.runs),
        spectra.FREQUENCY: computed.frequency[shown],
        spectra.BAND: computed.band,
        spectra.CONTACT: 1 + np.arange(forces.shape[1]),
        spectra.FORCE_PSD: density[..., shown],
        spectra.FORCE_LEVEL: level,
        spectra.CONTACT_FORCE_LEVEL: computed.force_levels,
    }
    product, start, values = held_values(computed)
    laid_out |= (
        sureness(product, start, values) | level_differences(list(computed.runs), level) | _bodies(computed)
    )
    if forces.shape[1] > 1:
        tones = passing_frequencies(
            scene.offsets, computed.case.speed, computed.case.numerics.highest_frequency
        )
        laid_out |= {schema.PASSING_FREQUENCY: tones} if tones.size else {}
    if sensors := computed.case.rolled_over.sensor_positions:
        density = computed.psd(computed.stacked("acceleration"))
        laid_out[schema.SPECTRA_SENSOR] = sensors
        laid_out[schema.ACCELERATION_PSD] = density[..., shown]
        laid_out[schema.ACCELERATION_LEVEL] = computed.levels(density, schema.ACCELERATION_REFERENCE)
    laid_out |= roundness.orders_group(computed)
    if isinstance(scene.over, Track):
        laid_out |= track.track_spectra(computed, values, side) | track.tones(computed)
    return laid_out


PLACES = 8
"""Places along the record at which the linear contact is looked at."""


def held_values(computed: Computed) -> tuple[Array, Array, Array]:
    """B T of the bands (b,), the share of their level that the start makes, and the independent values held.

    By the first contact: others of one path hold much the same.
    """
    case = computed.case
    run = computed.first
    band = computed.band
    time = bands.averaging_time(len(run.time), case.time_step, segment=computed.segment)
    seen = bands.values_seen(run.contact_force[0], case.time_step, band)
    record, (begin, end) = float(run.time[-1]), run.positions[0, [0, -1]]
    places = begin + (end - begin) * (np.arange(PLACES) + 0.5) / PLACES
    of = (computed.scene.first, computed.scene, computed.stiffness, places)
    product = bands.band_product(band, time)
    held, start = bands.chance_and_start(lambda f: force_transfer(f, *of), band, case.settled_time, record)
    return product, start, np.minimum(product * seen, held * time / record)


def sureness(product: Array, start: Array, values: Array) -> Values:
    """Lay out how sure the levels of bands are: B T, chance, and start, from `held_values`."""
    return {
        spectra.START_SHARE: spectra.START_SHARE.variable(start, most=bands.MOST_START),
        spectra.BAND_TIME_PRODUCT: spectra.BAND_TIME_PRODUCT.variable(product, least=bands.LEAST_PRODUCT),
        spectra.LEVEL_DEVIATION: bands.level_deviation(values),
    }


def level_differences(names: list[str], force_level: Array) -> Values:
    """Differences of force levels (laws, bands), dB, to the linear laws, and to a reference if any."""
    compared = {validity.difference_to(law): law for law in laws.baselines(names)}
    if (solved := laws.reference(names)) is not None:
        compared[spectra.FORCE_LEVEL_DIFFERENCE_TO_REFERENCE] = solved
    with np.errstate(invalid="ignore"):  # where nothing vibrates by either law
        return {
            entry: entry.variable(force_level - force_level[names.index(law)], reference=law)
            for entry, law in compared.items()
        }


def _bodies(computed: Computed) -> Values:
    """Acceleration of the bodies in their degrees of freedom, from second differences of their motion."""
    step = computed.case.time_step
    curvature = np.pad(np.diff(_motion(computed), 2) / step**2, ((0, 0), (0, 0), (1, 1)), mode="edge")
    half = np.pi * computed.frequency * step
    to_acceleration = (half / np.sin(np.maximum(half, 1e-12))) ** 4
    density = (computed.psd(curvature) * to_acceleration)[..., computed.shown]
    return {schema.SPECTRA_DEGREE: list(computed.scene.degrees), schema.BODY_ACCELERATION_PSD: density}


EQUAL = 1e-6
"""Relative difference of distances that are equal."""


def passing_frequencies(offsets: Iterable[float], speed: float, highest: float) -> Array:
    """Multiples k v/L, Hz, of the frequency at which contacts at an equal distance L pass a place.

    Offsets in m, speed in m/s, up to the highest frequency, Hz; none where distances differ.
    """
    gaps = np.diff(np.sort(np.fromiter(offsets, dtype=float)))
    if not gaps.size or np.ptp(gaps) > EQUAL * gaps.mean():
        return np.zeros(0)
    first = speed / gaps.mean()
    return np.asarray(first * np.arange(1, int(highest / first) + 1))
