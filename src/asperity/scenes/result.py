"""The result of a case of any kind, laid out as labelled groups: each observer adds what it sees."""

import warnings
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from datetime import UTC, datetime
from typing import Any

import xarray

from asperity import __version__, laws
from asperity.case.any_case import AnyCase
from asperity.contact.batched import find_device
from asperity.errors import Grade, PhysicsWarning, warn_of_findings
from asperity.progress import Progress
from asperity.scenarios.law_choice import LawChoice, advised_law
from asperity.scenarios.scene import PreparedCase
from asperity.scenes import schema, validity
from asperity.scenes.compute import Computed, compute
from asperity.scenes.groups import contact_group, surface_group
from asperity.scenes.observer import observed
from asperity.scenes.observers import OVER_STRUCTURES
from asperity.scenes.over_frequency import body_motion, spectra_group
from asperity.scenes.population import answers
from asperity.scenes.records import recorded_group
from asperity.schema import VERSION, Values, group, provenance, rolling, spectra, tree
from asperity.speeds import speed_at
from asperity.structures.rail_poles import RailBetween, RailPoles
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
    """Compute a case and lay its result out: surface, contact, rolling and spectra; and what observers see.

    With units and provenance. `caught` are the warnings met on the way; those of laying out may still be
    added to it. In brief without what only a report shows: what the path is like, and the choice of a law
    where nothing depends on it.
    """
    computed = compute(prepared, progress)
    case = computed.case
    over_frequency = spectra_group(computed)
    choice = validity.choice_of(computed, brief=brief)
    population = answers(computed)
    seen = observed(computed, OVER_STRUCTURES)
    found = validity.findings(computed, population, choice) + seen.findings
    warn_of_findings(found)
    textures = surface_group(computed, brief=brief)
    reduced = contact_group(computed, found, population)
    expected = {provenance.EXPECTED_ERRORS: choice.entries()} if choice else {}
    scenario = scenario_group(case, _numerics(computed, choice, seen.numerics)) | expected
    laid_out = scenario | textures | reduced | rolling_group(computed) | over_frequency | seen.values
    result = tree(laid_out)
    over_bands = {entry: value for entry, value in laid_out.items() if entry.group == spectra.LAW.group}
    verdict = validity.verdict(computed, group(over_bands), found, choice)
    sources = METHOD + (ROUGH_CONTACT if computed.reduction else ()) + BANDS + (EXPECTED if choice else ())
    sources += tuple(seen.sources)
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


def _numerics(
    computed: Computed, choice: LawChoice | None, seen: Iterable[tuple[str, str]]
) -> Iterator[tuple[str, str]]:
    """Numbers of the computation: names and values, with those that observers have `seen`."""
    case = computed.case
    nx, ny = computed.shape.body.shape
    runs = computed.runs
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
    yield from seen
    yield from advised_law(computed, choice)
    for part, seconds in computed.seconds.items():
        yield f"wall time, {part}", f"{seconds:.2f} s"


def _of_structure(computed: Computed) -> Iterator[tuple[str, str]]:
    over = computed.over
    if isinstance(over, RailBetween):
        weights = computed.rail.kernel.weights
        step = computed.rail.kernel.time_step
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
    lost = [[duration for _, duration in run.flights] for run in computed.runs.values()]
    over, rolls = (getattr(schema, name.upper()) for name in case.DISPLACEMENTS)
    laid_out: Values = recorded_group(computed) | {
        rolling.POSITION: first.positions[0],
        rolling.TACHO: speed_at(case.speed, first.time),
        rolling.OFFSET: scene.offsets,
        rolling.STATIC_LOAD: scene.loads,
        rolling.RELATIVE_DISPLACEMENT: stack("relative_displacement"),
        over: stack("over_displacement"),
        rolls: stack("rolling_displacement"),
        rolling.CONTACT_LOSS_SHARE: 1.0 - stack("in_contact").mean(axis=-1),
        rolling.CONTACT_LOSS_EVENTS: [[len(durations) for durations in run] for run in lost],
        rolling.LONGEST_LOSS: [[durations.max(initial=0.0) for durations in run] for run in lost],
        schema.ROLLING_DEGREE: list(scene.degrees),
        schema.BODY_DISPLACEMENT: body_motion(computed),
        rolling.SPEED: float(case.speed),
    }
    if sensors := case.rolled_over.sensor_positions:
        laid_out |= {schema.ROLLING_SENSOR: sensors, schema.ACCELERATION: stack("acceleration")}
    if case.point_positions:
        moved, velocity = computed.points
        laid_out |= {schema.ROLLING_POINT: case.point_positions}
        laid_out |= {schema.POINT_DISPLACEMENT: moved, schema.POINT_VELOCITY: velocity}
    return laid_out
