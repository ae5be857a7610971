"""Is a case inside the range in which its laws are known to hold? Number and limit of each, and a verdict."""

import math
from collections.abc import Iterator, Sequence

import numpy as np
import xarray

from asperity.case.scene import Case
from asperity.errors import Finding, Grade, percent
from asperity.laws import baselines, names, spec_of
from asperity.reporting import data
from asperity.rolling.ground import LARGEST_DEFLECTION, share_bent, small_motion
from asperity.rolling.roll import RolledBodies
from asperity.scenarios import rim_cells
from asperity.scenarios.law_choice import UNMAPPED, WANTED, LawChoice, law_choice
from asperity.scenarios.preparing import ContactTrial
from asperity.scenarios.reducing import PressedSamples
from asperity.scenarios.scene import PreparedCase
from asperity.scenes.compute import Computed
from asperity.scenes.start_of_record import low_levels
from asperity.schema import Entry, spectra
from asperity.spectra import nominal_frequency, say_little
from asperity.written_numbers import in_newtons, rounded

AREA = (0.9, 0.7)
"""Real contact area over that of smooth bodies: warned of, and out of range, below."""
SLOPE = (0.2, 0.5)
"""Rms slope: warned of, and out of range, above. The half-space leaves out terms of its square."""
ISOLATED = (0.05, 0.25)
"""Share of the load on cells that touch alone: warned of, and out of range, above."""
RESIDUAL = 1e-3
"""What the energy balance may leave open, relative to the throughput."""
MISSED_LOAD = (0.5, 1.0)
"""Share of its load by which the mean contact force of a body may miss it: warned of, and out of range."""
BENT = (LARGEST_DEFLECTION, 0.1)
"""Share of its length that what is rolled over may be displaced by: warned of, and out of range."""
PRESSED, THROWN = (0.05, 0.2), (0.5, 2.0)
"""Shares of its radius by which what rolls may approach a surface, and be off it, likewise."""
SOFTENED = (0.1, 0.5)
"""Share by which the time step may soften a contact: warned of, and out of range."""
MISSED_STIFFNESS = 0.01
"""Share by which the stiffness on whole cells may be off: 0.1 dB of a force that follows it."""
CELLS_PER_WAVE = 4
"""Cells that the shortest wave must have, so that no more than `ISOLATED` touches alone."""


def findings(
    computed: Computed, population: Sequence[Finding], choice: LawChoice | None = None
) -> list[Finding]:
    """Hold a case to the range in which its laws are known to hold; without samples, its time steps alone.

    With answers about its population. Which law to take instead is what the map of law errors chooses, where
    it knows of the case.
    """
    case = computed.case
    reduction = computed.reduction
    steps = (case.rolled_time + case.settled_time) / case.time_step
    worst = max(computed.runs, key=lambda law: computed.runs[law].unconverged_steps)
    missed = computed.runs[worst].unconverged_steps
    time_steps = _rare(
        f"share of the time steps that missed their tolerance{f', {worst}' if missed else ''}",
        missed / steps,
        "Their contact force is too coarse.",
        "Take a smaller numerics.time_step.",
        warned=True,
    )
    motion = [time_steps, *_of_motion(computed)]
    if reduction is None:
        return motion
    return [
        _area(case, reduction.pressed.area_ratio, choice),
        _slope(computed),
        _isolated(case, reduction.pressed.isolated_share),
        *_whole_cells(computed, reduction.pressed),
        *_cut_off(computed),
        *(answer for answer in population if answer.laws),
        *motion,
    ]


def energy_left(law: str, residual: float, key: str) -> Finding:
    """What the energy balance of a run by a law leaves open, relative to the throughput.

    `key` is that of the time step.
    """
    told = f"{rounded(residual, 2)} of the energy that passed through the contacts is unaccounted for"
    return Finding(
        f"energy that the balance leaves open, {law}", f"{rounded(residual, 2)} of the throughput",
        f"up to {RESIDUAL:g}", Grade.WARNING if residual > RESIDUAL else None,
        "The time step is coarse for what moves.", f"Take a smaller {key}.", told, (law,)
    )  # fmt: skip


def beyond(
    quantity: str, share: float, limits: tuple[float, float], meaning: str, remedy: str, brief: str, law: str,
    *, warned: bool = False,
) -> Iterator[Finding]:  # fmt: skip
    """A share of a law that is warned of, and out of range, above limits; None where it is below both."""
    if (grade := _grade(share, limits)) is not None:
        value = percent(share)
        limit = f"up to {percent(limits[0])}"
        told = brief.format(value)
        yield Finding(f"{quantity}, {law}", value, limit, grade, meaning, remedy, told, (law,), warned=warned)


def contacts_softened(law: str, share: float, key: str) -> Iterator[Finding]:
    """Contacts of a law that are softened to be stable, by a share of their compliance at rest.

    None where that is little; `key` is that of the time step.
    """
    yield from beyond(
        "softening of contacts by the time step",
        share,
        SOFTENED,
        "The time step is too long for contacts as stiff on bodies as light, which are made softer.",
        f"Take a smaller {key}.",
        "contacts softened by {} for the time step",
        law,
    )


def load_missed(what: str, of: str, mean: float, law: str) -> Iterator[Finding]:
    """A mean force of contacts, in loads, that is far from one."""
    if (grade := _grade(abs(mean - 1.0), MISSED_LOAD)) is not None:
        yield Finding(
            f"{what} {of} over its load, {law}",
            rounded(mean),
            f"{1.0 - MISSED_LOAD[0]:g} to {1.0 + MISSED_LOAD[0]:g}",
            grade,
            "What rolls is thrown, sucked on, or a record shorter than it bounces.",
            "Look for what drives it: supports, springs, a linear contact that pulls; or record longer.",
            f"a {what} of {rounded(mean)} loads",
            (law,),
        )


def _of_motion(computed: Computed) -> Iterator[Finding]:
    """Whether motions are possible: energies that balance, mean forces that are loads, small deflections."""
    left = {law: run.energy.residual for law, run in computed.runs.items()}
    main = next(iter(left))
    worst = max(left, key=left.__getitem__)
    for law in dict.fromkeys((main, worst)):
        if law == main or left[law] > RESIDUAL:
            yield energy_left(law, left[law], "numerics.time_step")
    for law, run in computed.runs.items():
        yield from contacts_softened(
            law, float(run.softening.max()) * computed.stiffness, "numerics.time_step"
        )
        loads = np.bincount(run.body, computed.scene.loads)
        share = np.bincount(run.body, run.contact_force.mean(axis=1)) / loads
        mean = float(share[np.argmax(np.abs(share - 1.0))])
        yield from load_missed("mean contact force", "of a body", mean, law)
        yield from _displaced(computed, law, run)


def _displaced(computed: Computed, law: str, run: RolledBodies) -> Iterator[Finding]:
    """Displacements beyond what theory allows under the contacts, and beyond the size of what rolls."""
    if (small := small_motion(computed.over)) is not None:
        yield from beyond(
            f"displacement of the {small.name} over {small.of}",
            share_bent(computed.over, run.over_displacement),
            BENT,
            f"{small.meaning}.",
            f"Check {small.check}.",
            f"a {small.name} displaced by {{}} of {small.of}",
            law,
            warned=True,
        )
    radius = computed.case.rolling.radius
    remedy = "Check heights, load, springs and supports."
    yield from beyond(
        f"approach of the surfaces over the radius of the {computed.case.ROLLING}",
        float(run.relative_displacement.max()) / radius,
        PRESSED,
        "The contact is no small part of the bodies.",
        remedy,
        "an approach of {} of the radius",
        law,
    )
    yield from beyond(
        f"distance of the surfaces over the radius of the {computed.case.ROLLING}",
        -float(run.relative_displacement.min()) / radius,
        THROWN,
        "What rolls is thrown off, or what it rolls over falls.",
        remedy,
        "surfaces apart by {} of the radius",
        law,
    )


def choice_of(computed: Computed, *, brief: bool) -> LawChoice | None:
    """What the map of law errors says of a case; in brief only where the real contact asks for it."""
    reduction = computed.reduction
    if brief and (reduction is None or reduction.pressed.area_ratio >= AREA[0]):
        return None
    return law_choice(computed)


def foreseen(prepared: PreparedCase, tried: ContactTrial, choice: LawChoice | None) -> list[Finding]:
    """What a run will find fault with, from contacts that were tried."""
    case = prepared.case
    lowest, *_, highest = tried.approaches.tolist()
    remedy = prepared.shape.remedy_for_cut_off(highest, -lowest)
    found = (
        _area(case, tried.pressed.area_ratio, choice),
        _slope(prepared),
        _isolated(case, tried.pressed.isolated_share),
        *_whole_cells(prepared, tried.pressed),
        _rare(f"{_CUT_OFF}, the loading curve of a sample", tried.cut_off, _TOO_SMALL, remedy),
    )
    return [finding for finding in found if finding.grade is not None]


def _grade(value: float, limits: tuple[float, float]) -> Grade | None:
    """Grade of a value: out of range below limits that fall, above limits that rise."""
    sign = 1.0 if limits[1] > limits[0] else -1.0
    warned, out = (sign * value > sign * limit for limit in limits)
    return Grade.OUT if out else Grade.WARNING if warned else None


def _rare(quantity: str, share: float, meaning: str, remedy: str, *, warned: bool = False) -> Finding:
    """What should not happen at all: a share."""
    grade = Grade.of_share(share) if share else None
    return Finding(quantity, percent(share), "below 1 %", grade, meaning, remedy, warned=warned)


def doubted_by_area(laws: Sequence[str], ratio: float, choice: LawChoice | None) -> tuple[str, ...]:
    """Laws of a case that a ratio of real contact makes doubtful, where the map does not trust them.

    None where the map trusts the first, which the others are compared with.
    """
    if ratio >= AREA[0] or (choice is not None and choice.trusts(laws[0])):
        return ()
    blind = [law for law in laws if not spec_of(law).sees_heights]
    return tuple(law for law in blind if choice is None or not choice.trusts(law))


def _area(case: Case, ratio: float, choice: LawChoice | None) -> Finding:
    doubted = doubted_by_area(case.laws, ratio, choice)
    taken = UNMAPPED if choice is None else choice.taken
    return Finding(
        "real contact area over that of smooth bodies",
        f"{ratio:.2f}",
        f"from {AREA[0]:g} on, or within {WANTED:g} dB by the map of law errors",
        _grade(ratio, AREA) if doubted else None,
        "Laws of a line or an averaged texture take the whole patch for the contact; this is a part of it.",
        f"Read {taken}, which was rolled as well." if taken in case.laws else f"Take {taken}.",
        f"real contact area {percent(ratio)} of that of smooth bodies",
        doubted,
    )


def _slope(prepared: PreparedCase) -> Finding:
    slope = prepared.textures.rms_slope
    pressure = 0.5 * prepared.shape.modulus * slope
    return Finding(
        "rms slope of the samples, Sdq",
        rounded(slope, 2),
        f"up to {SLOPE[0]:g}",
        _grade(slope, SLOPE),
        "An elastic half-space is for small slopes, and elastic asperities carry about E* Sdq/2 = "
        f"{rounded(pressure / 1e9, 2)} GPa.",
        "Leave out the short waves that yield at first touch by surface.shortest, or give contact.hardness.",
        f"rms slope {rounded(slope, 2)}",
        tuple(prepared.case.laws),
    )


def _isolated(case: Case, share: float) -> Finding:
    least = CELLS_PER_WAVE * case.contact.spacing
    surface = case.surface
    ways = [f"surface.shortest = {_um(least)} leaves out the waves that this one does not resolve"]
    known = surface.shortest or (2.0 * surface.pixel if surface.pixel is not None else None)
    if known is not None and known < least:
        ways.insert(0, f"contact.spacing = {_um(known / CELLS_PER_WAVE, down=True)} resolves all waves")
    return Finding(
        "share of the load on asperities of a single cell",
        percent(share),
        f"up to {percent(ISOLATED[0])}",
        _grade(share, ISOLATED),
        "The grid does not resolve the asperities: forces depend on contact.spacing.",
        f"A grid that would do: {', or '.join(ways)}.",
        f"{percent(share)} of the load on single cells",
        tuple(case.laws),
    )


def _whole_cells(prepared: PreparedCase, pressed: PressedSamples) -> Iterator[Finding]:
    """Laws of single contacts on cells that are in contact or not: their stiffness jumps."""
    case = prepared.case
    shape = prepared.shape
    seeing = tuple(law for law in case.laws if spec_of(law).sees_heights)
    if not seeing or prepared.cells_seen != "whole":
        return
    missed = rim_cells.stiffness_missed(shape)
    samples = [shape.body - each.undeformed_gap for each in pressed.contacts]
    within = rim_cells.roughness_within(samples, shape)
    if within <= rim_cells.SMOOTH:
        cells = rounded(min(shape.semi_axes) / case.contact.spacing, 2)
        level = 20.0 * math.log10(1.0 + missed)
        yield Finding(
            f"error of the stiffness on whole cells, {' and '.join(seeing)}",
            f"up to {percent(missed)}, about {rounded(level, 2)} dB in one-third octaves",
            f"up to {percent(MISSED_STIFFNESS)}",
            Grade.WARNING if missed > MISSED_STIFFNESS else None,
            f"The texture is smooth within the contact ({rounded(within, 2)} approaches rms): few of its "
            f"cells, {cells} in the half-width, enter as the force varies, and each lets the stiffness jump. "
            "Bands of what is damped little move by more.",
            'Set contact.rim_cells = "covered".',
            f"stiffness on whole cells up to {percent(missed)} off, some {rounded(level, 2)} dB",
            seeing,
        )


_CUT_OFF = "share of contacts that the window cuts off"
_TOO_SMALL = "Their force is too small."


def _cut_off(computed: Computed) -> Iterator[Finding]:
    """Contacts that the window cuts off: those that are rolled, and all that were solved."""
    reduction = computed.reduction
    main, run = next(iter(computed.runs.items()))
    assert reduction is not None
    ensemble = reduction.ensemble
    held = float(ensemble.mean_force[ensemble.held - 1]) if ensemble.held else 0.0
    visited = float(np.mean(run.contact_force > held)) if ensemble.held < len(ensemble.approaches) else 0.0
    yield Finding(
        f"share of the time in contacts that the window cuts off, {main}",
        percent(visited),
        "below 1 %",
        Grade.of_share(visited) if visited and not spec_of(main).is_smooth else None,
        f"Forces above {in_newtons(held)} are too small: their contacts are larger than the window.",
        reduction.remedy,
        f"{percent(visited)} of the time in contacts that the window cuts off",
        (main,),
    )
    scans = {"filters": reduction.counts} | ({"path": computed.scan.counts} if computed.scan else {})
    for name, counts in scans.items():
        share = counts.truncated / max(counts.solved, 1)
        yield _rare(f"{_CUT_OFF}, {name}", share, _TOO_SMALL, reduction.remedy, warned=True)


def _um(length: float, *, down: bool = False) -> str:
    """Write a length as it stands in a case file, rounded up, or down, to two digits."""
    unit = 10.0 ** (math.floor(math.log10(length * 1e6)) - 1)
    digits = length * 1e6 / unit
    rounded = math.floor(digits * (1 + 1e-9)) if down else math.ceil(digits * (1 - 1e-9))
    return f'"{round(rounded * unit, 6):g} um"'


COMPARED = (100.0, 5000.0)
"""Band centres between which laws are compared, Hz."""
MOST_NAMED = 4
"""Contacts that the verdict names."""


def verdict(
    computed: Computed,
    over_frequency: xarray.Dataset,
    found: Sequence[Finding],
    choice: LawChoice | None = None,
) -> str:
    """Say in a sentence or two how the main law's contact went, and how far it is from the others.

    The main law is the first of the runs. By the group of spectra; choice of a law, from the law accuracy
    map.
    """
    main, run = next(iter(computed.runs.items()))
    sentences = list(_doubts(computed, found))
    if not run.vibrates:
        still = f"{_contact(run, computed.case.ROLLING)} ({main}); nothing vibrates: its force does not vary"
        return ". ".join([*sentences, still]) + "."
    forces = "the contact force varies" if len(run.contact_force) == 1 else "the contact forces vary"
    contact = f"{_contact(run, computed.case.ROLLING)} ({main})"
    if spec_of(main).may_pull:
        contact = f"By {main} no contact can be lost: its force may pull"
    sentences.append(f"{contact}; {forces} by {_varies(run)} rms")
    secant = " (linear with the stiffness F/r)" if computed.case.contact.linearise == "secant" else ""
    others = {law: difference_to(law).name for law in baselines(computed.runs) if law != main}
    others = {law: name for law, name in others.items() if name in over_frequency}
    shown = compared_bands(over_frequency)
    if not shown.any():
        sentences.append("The record is too short to compare its one-third octaves with those of other laws")
    elif compared := list(_compared(over_frequency.isel(band=shown).sel(law=main), main, others)):
        sentences.append(f"Per one-third octave {main} is {' and '.join(compared)}{secant}")
    if choice is not None and (told := choice.sentence(main)) is not None:
        sentences.append(told)
    sentences += _start_of_record(over_frequency)
    return ". ".join(sentences) + "."


def _start_of_record(over_frequency: xarray.Dataset) -> Iterator[str]:
    """Say in which bands resonances have not built up yet, so that levels of the force are low."""
    if (start := over_frequency.get(spectra.START_SHARE.name)) is None:
        return
    if (told := low_levels(over_frequency[spectra.BAND.name].values, start.values)) is not None:
        where, low = told
        held = "resonances there have not built up when the record starts"
        yield f"Levels at {where} are {low}: {held}; a longer settling helps"


def _doubts(computed: Computed, found: Sequence[Finding]) -> Iterator[str]:
    """Say first where the main law is outside its range, and what the scanned contact gives instead."""
    runs = computed.runs
    main = next(iter(runs))
    doubts = [finding for finding in found if finding.concerns(main)]
    if not doubts:
        return
    out = any(finding.grade is Grade.OUT for finding in doubts)
    reasons = ", ".join(finding.brief for finding in doubts)
    seeing = [law for law in names() if law in runs and spec_of(law).sees_heights]
    better = [law for law in seeing if any(law not in finding.laws for finding in doubts)]
    instead = [f"{law} varies by {_varies(runs[law])} rms" for law in better[:1]]
    yield f"{'Out of range' if out else 'Doubtful'} for {main}: {'; '.join([reasons, *instead])}"


def compared_bands(over_frequency: xarray.Dataset) -> np.ndarray:
    """Bands in which laws are compared: those whose levels say something."""
    low, high = COMPARED
    band = over_frequency[spectra.BAND.name]
    start = over_frequency.get(spectra.START_SHARE.name, 0.0)
    inside = (band >= low * 0.9) & (band <= high * 1.1)
    return inside & ~say_little(over_frequency[spectra.BAND_TIME_PRODUCT.name], start)


def difference_to(baseline: str) -> Entry:
    """Find the entry of the force levels over those of a baseline."""
    role = spec_of(baseline).role
    assert role is not None
    return spectra.FORCE_LEVEL_DIFFERENCES[role]


def _compared(bands: xarray.Dataset, main: str, others: dict[str, str]) -> Iterator[str]:
    """Distance of the main law to the linear laws, the one of practice first, and to the reference."""
    for law, name in others.items():
        ends = (bands[name][end] for end in (bands[name].values.argmin(), bands[name].values.argmax()))
        low, high = ((f"{data.signed(float(end))} dB", nominal_frequency(float(end.band))) for end in ends)
        alike = low[0] == high[0]  # in all bands
        told = low[0] if alike else f"{low[0]} ({low[1]}) to {high[0]} ({high[1]})"
        yield f"{told} over {law}"
    to_reference = bands.get(spectra.FORCE_LEVEL_DIFFERENCE_TO_REFERENCE.name)
    if to_reference is not None and to_reference.attrs["reference"] != main:
        yield f"at most {float(abs(to_reference).max()):.1f} dB from {to_reference.attrs['reference']}"


def _varies(run: RolledBodies) -> str:
    """Rms of the contact forces, each about its own mean."""
    return in_newtons(float(np.sqrt(np.mean(np.var(run.contact_force, axis=-1)))))


def _contact(run: RolledBodies, body: str) -> str:
    """Say how often the contact of a body is lost; of several contacts, which, and how much of the time."""
    share = 1.0 - run.in_contact.mean(axis=-1)
    one = len(run.body) == 1
    starts, _ = run.flights[0]
    if one and not len(starts):
        return f"The {body} never loses contact"
    if one:
        times = f"{len(starts)} time{'s' if len(starts) > 1 else ''}"
        return f"The {body} loses contact {times}, {percent(share[0])} of the time"
    lost = [f"{k + 1} ({percent(part)})" for k, part in enumerate(share) if part > 0.0]
    if not lost:
        return f"None of the {len(share)} contacts is ever lost"
    named = ", ".join(lost[:MOST_NAMED]) + (" and others" if len(lost) > MOST_NAMED else "")
    return f"Of {len(share)} contacts, {len(lost)} {'is' if len(lost) == 1 else 'are'} lost at times: {named}"
