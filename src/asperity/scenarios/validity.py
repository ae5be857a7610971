"""Is a case inside the range in which its laws are known to hold? Number and limit of each, and a verdict."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import xarray

from asperity.config.case import Case
from asperity.errors import Grade, OutOfRangeWarning, percent
from asperity.laws import baselines, names, spec_of
from asperity.rolling.roll import RolledBodies
from asperity.scenarios.chain import Chain
from asperity.scenarios.geometry import Geometry
from asperity.scenarios.law_choice import WANTED, LawChoice, law_choice, law_to_take
from asperity.scenarios.population import EFFECT, answers
from asperity.scenarios.scene import Scene
from asperity.scenarios.textures import Textures
from asperity.scenarios.tree import difference_to, rms_about_mean
from asperity.scenarios.trial import ContactTrial
from asperity.schema.spectra import (
    BAND,
    BAND_TIME_PRODUCT,
    FORCE_LEVEL_DIFFERENCE_TO_REFERENCE,
    START_SHARE,
)
from asperity.spectra import nominal_frequency, say_little
from asperity.surfaces.statistics import shortest_wave_for

_CUT_OFF = "share of contacts that the window cuts off"

AREA = (0.9, 0.7)
"""Real contact area over that of smooth bodies: warned of, and out of range, below."""
SLOPE = (0.2, 0.5)
"""Rms slope: warned of, and out of range, above. The half-space leaves out terms of its square."""
ISOLATED = (0.05, 0.25)
"""Share of the load on cells that touch alone: warned of, and out of range, above."""
CELLS_PER_WAVE = 4
"""Cells that the shortest wave must have, so that no more than `ISOLATED` touches alone."""


@dataclass(frozen=True)
class Finding:
    """One quantity, how far it may go, and what to make of it."""

    quantity: str  # what was found
    value: str  # its number
    limit: str  # where its range ends
    grade: Grade | None  # None where it is inside its range
    meaning: str  # of being outside
    remedy: str  # what to do
    brief: str  # quantity and number in a few words, for a headline
    laws: tuple[str, ...]  # of the case that it concerns
    told: bool = False  # whether it has been warned of where it was found

    def concerns(self, law: str) -> bool:
        """Whether it makes a law doubtful."""
        return self.grade in (Grade.WARNING, Grade.OUT) and law in self.laws

    @property
    def message(self) -> str:
        """All of it in one or two sentences."""
        return f"{self.quantity}: {self.value}, in range {self.limit}. {self.meaning} {self.remedy}"


def findings(chain: Chain, choice: LawChoice | None = None) -> list[Finding]:
    """Hold a case to the range in which its laws are known to hold; without samples, its time steps alone.

    Which law to take instead is what the map of law errors chooses, where it knows of the case.
    """
    steps = _time_steps(chain)
    if chain.reduction is None:
        return [steps]
    case, reduction = chain.case, chain.reduction
    return [
        _area(case, reduction.area_ratio, choice),
        _slope(case, chain.shape, chain.textures),
        _isolated(case, reduction.isolated_share),
        *_cut_off(chain),
        *_populations(chain),
        steps,
    ]


def choice_of(chain: Chain, scene: Scene, *, brief: bool) -> LawChoice | None:
    """What the map of law errors says of a case; in brief only where the real contact asks for it."""
    if brief and (chain.reduction is None or chain.reduction.area_ratio >= AREA[0]):
        return None
    return law_choice(chain.case, chain.shape, chain.textures, scene)


def foreseen(
    case: Case, shape: Geometry, textures: Textures, tried: ContactTrial, choice: LawChoice | None
) -> list[Finding]:
    """What a run will find fault with, from contacts that were tried."""
    remedy = shape.remedy_for_cut_off(
        float(tried.approaches[-1]), tried.working, -float(tried.approaches[0]), textures.widest_window
    )
    share = tried.cut_off
    window = Finding(
        f"{_CUT_OFF}, the loading curve of a sample",
        percent(share),
        "below 1 %",
        Grade.of_share(share) if share else None,
        "Their force is too small.",
        remedy,
        "",
        (),
    )
    area, grid = _area(case, tried.area_ratio, choice), _isolated(case, tried.isolated_share)
    found = (area, _slope(case, shape, textures), grid, window)
    return [finding for finding in found if finding.grade is not None]


def warn_of_findings(found: list[Finding]) -> None:
    """Warn of what is outside its range and was not told where it was found."""
    for finding in found:
        if finding.grade is not None and not finding.told:
            warnings.warn(OutOfRangeWarning(finding.message, finding.grade), stacklevel=2)


def _grade(value: float, limits: tuple[float, float]) -> Grade | None:
    """Grade of a value: out of range below limits that fall, above limits that rise."""
    sign = 1.0 if limits[1] > limits[0] else -1.0
    warned, out = (sign * value > sign * limit for limit in limits)
    return Grade.OUT if out else Grade.WARNING if warned else None


def doubted_by_area(laws: Sequence[str], ratio: float, choice: LawChoice | None) -> tuple[str, ...]:
    """Laws of a case that a ratio of real contact makes doubtful, where the map does not trust them.

    None where the map trusts the first, which the others are compared with.
    """
    if ratio >= AREA[0] or (choice is not None and choice.trusts(laws[0])):
        return ()
    blind = [law for law in laws if not spec_of(law).sees_heights]
    return tuple(law for law in blind if choice is None or not choice.trusts(law))


def _area(case: Case, ratio: float, choice: LawChoice | None) -> Finding:
    doubted, taken = doubted_by_area(case.laws, ratio, choice), law_to_take(choice)
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


def _slope(case: Case, shape: Geometry, textures: Textures) -> Finding:
    slope, spacing = textures.rms_slope, shape.spacing[0]
    pressure = 0.5 * shape.modulus * slope
    shortest = max(shortest_wave_for(sample, SLOPE[0]) for sample in textures.maps)
    remedy = "Leave out the short waves that yield at first touch"
    if shortest > 2 * spacing:
        remedy += f": surface.shortest = {_um(shortest)} leaves a slope of {SLOPE[0]:g}"
    hard = "" if case.contact.hardness is not None else ", or give contact.hardness"
    return Finding(
        "rms slope of the samples, Sdq",
        f"{slope:.2g}",
        f"up to {SLOPE[0]:g}",
        _grade(slope, SLOPE),
        "An elastic half-space is for small slopes, and elastic asperities carry about E* Sdq/2 = "
        f"{pressure / 1e9:.2g} GPa.",
        f"{remedy}{hard}.",
        f"rms slope {slope:.2g}",
        tuple(case.laws),
    )


def _isolated(case: Case, share: float) -> Finding:
    least, surface = CELLS_PER_WAVE * case.contact.spacing, case.surface
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


def _cut_off(chain: Chain) -> Iterator[Finding]:
    """Contacts that the window cuts off: those that are rolled, and all that were solved."""
    reduction, scan = chain.reduction, chain.scan
    assert reduction is not None
    ensemble, highest = reduction.ensemble, float(reduction.approaches[-1])
    remedy = chain.shape.remedy_for_cut_off(
        highest, reduction.working_approach, reduction.datums["path"], chain.textures.widest_window
    )
    main, run = next(iter(chain.runs.items()))
    held = float(ensemble.mean_force[ensemble.held - 1]) if ensemble.held else 0.0
    visited = float(np.mean(run.contact_force > held)) if ensemble.held < len(ensemble.approaches) else 0.0
    yield Finding(
        f"share of the time in contacts that the window cuts off, {main}",
        percent(visited),
        "below 1 %",
        Grade.of_share(visited) if visited and not spec_of(main).is_smooth else None,
        f"Forces above {held:.3g} N are too small: their contacts are larger than the window.",
        remedy,
        f"{percent(visited)} of the time in contacts that the window cuts off",
        (main,),
    )
    scans = {"filters": reduction.counts}
    if scan is not None:
        scans["path"] = scan.counts
    for name, counts in scans.items():
        share = counts.truncated / max(counts.solved, 1)
        grade = Grade.of_share(share) if counts.truncated else None
        yield Finding(
            f"{_CUT_OFF}, {name}",
            percent(share),
            "below 1 %",
            grade,
            "Their force is too small.",
            remedy,
            "",
            (),
            told=True,
        )


def _time_steps(chain: Chain) -> Finding:
    """Time steps whose contact force missed its tolerance, of the law that has most of them."""
    case = chain.case
    steps = (case.rolled_time + case.settled_time) / case.time_step
    worst = max(chain.runs, key=lambda law: chain.runs[law].unconverged_steps)
    missed = chain.runs[worst].unconverged_steps
    return Finding(
        f"share of the time steps that missed their tolerance{f', {worst}' if missed else ''}",
        percent(missed / steps),
        "below 1 %",
        Grade.of_share(missed / steps) if missed else None,
        "Their contact force is too coarse.",
        "Take a smaller numerics.time_step.",
        "",
        (),
        told=True,
    )


def _populations(chain: Chain) -> Iterator[Finding]:
    """Whether samples and path are one population, so that what is reduced from samples fits all of it."""
    for answer in answers(chain):
        if answer.laws:
            yield Finding(
                answer.question,
                f"{answer.value}: {answer.effect:.1f} dB",
                f"an effect of up to {EFFECT[0]:g} dB",
                answer.grade,
                answer.answer,
                "Take more samples or a longer path; the law table has the stiffness of every place.",
                answer.brief,
                answer.laws,
            )


def _um(length: float, *, down: bool = False) -> str:
    """Write a length as it stands in a case file, rounded up, or down, to two digits."""
    unit = 10.0 ** (math.floor(math.log10(length * 1e6)) - 1)
    digits = length * 1e6 / unit
    rounded = math.floor(digits * (1 + 1e-9)) if down else math.ceil(digits * (1 - 1e-9))
    return f'"{round(rounded * unit, 6):g} um"'


COMPARED = (100.0, 5000.0)
"""Band centres between which laws are compared, Hz."""


def verdict(
    chain: Chain,
    spectra: xarray.Dataset,
    found: Sequence[Finding],
    body: str,
    sound_power: xarray.DataArray | None = None,
    choice: LawChoice | None = None,
) -> str:
    """Say in a sentence or two how the main law's contact went, and how far it is from the others.

    The main law is the first of the chain; `body` is what rolls: "ball" or "wheel"; sound power (laws,),
    A-weighted, dB; choice of a law, from the law accuracy map.
    """
    main, run = next(iter(chain.runs.items()))
    dynamic = rms_about_mean(run.contact_force)
    sentences = list(_doubts(chain, found))
    forces = "the contact force varies" if len(run.contact_force) == 1 else "the contact forces vary"
    sentences += [f"{_contact(run, body)} ({main}); {forces} by {_force(dynamic)} rms"]
    secant = " (linear with the stiffness F/r)" if chain.case.contact.linearise == "secant" else ""
    others = [law for law in baselines(chain.runs) if difference_to(law).name in spectra and law != main]
    shown = compared_bands(spectra)
    if not shown.any():
        sentences.append("The record is too short to compare its one-third octaves with those of other laws")
    elif compared := list(_compared(spectra.isel(band=shown), main, others)):
        sentences.append(f"Per one-third octave {main} is {' and '.join(compared)}{secant}")
    if choice is not None and (told := choice.sentence(main)) is not None:
        sentences.append(told)
    if sound_power is not None and others:
        own = sound_power.sel(law=main)
        changes = [f"{_signed(own - sound_power.sel(law=name))} over {name}" for name in others]
        sentences.append(f"Its A-weighted sound power is {' and '.join(changes)}{secant}")
    return ". ".join(sentences) + "."


def _doubts(chain: Chain, found: Sequence[Finding]) -> Iterator[str]:
    """Say first where the main law is outside its range, and what the scanned contact gives instead."""
    main = next(iter(chain.runs))
    doubts = [finding for finding in found if finding.concerns(main)]
    if not doubts:
        return
    out = any(finding.grade is Grade.OUT for finding in doubts)
    reasons = ", ".join(finding.brief for finding in doubts)
    seeing = [law for law in names() if law in chain.runs and spec_of(law).sees_heights]
    better = [law for law in seeing if any(law not in finding.laws for finding in doubts)]
    instead = [
        f"{law} varies by {_force(rms_about_mean(chain.runs[law].contact_force))} rms" for law in better
    ]
    yield f"{'Out of range' if out else 'Doubtful'} for {main}: {'; '.join([reasons, *instead[:1]])}"


def compared_bands(spectra: xarray.Dataset) -> np.ndarray:
    """Bands in which laws are compared: those whose levels say something."""
    low, high = COMPARED
    band = spectra[BAND.name]
    product, start = spectra[BAND_TIME_PRODUCT.name], spectra.get(START_SHARE.name, 0.0)
    inside = (band >= low * 0.9) & (band <= high * 1.1)
    return np.asarray(inside & ~say_little(product, start))


def _compared(bands: xarray.Dataset, main: str, others: list[str]) -> Iterator[str]:
    """Distance to the linear laws, the one of practice first, and to the reference."""
    for name in others:
        yield f"{_range(bands[difference_to(name).name].sel(law=main))} over {name}"
    to_reference = bands.get(FORCE_LEVEL_DIFFERENCE_TO_REFERENCE.name)
    if to_reference is not None and to_reference.attrs["reference"] != main:
        distance = float(abs(to_reference.sel(law=main)).max())
        yield f"at most {distance:.1f} dB from {to_reference.attrs['reference']}"


def _signed(difference: float | xarray.DataArray) -> str:
    rounded = round(float(difference), 1)
    return f"{rounded:+.1f} dB".replace("-", "−") if rounded else "0.0 dB"


def _force(newtons: float) -> str:
    return f"{newtons:.3g} N" if newtons < 1e3 else f"{newtons / 1e3:.3g} kN"


MOST_NAMED = 4
"""Contacts that the verdict names."""


def _contact(run: RolledBodies, body: str) -> str:
    """Say how often the contact of a body is lost; of several contacts, which, and how much of the time."""
    share, (first, *others) = 1.0 - run.in_contact.mean(axis=-1), run.contact_loss
    if not others and not first:
        return f"The {body} never loses contact"
    if not others:
        times = f"{len(first)} time{'s' if len(first) > 1 else ''}"
        return f"The {body} loses contact {times}, {100.0 * share[0]:.2g} % of the time"
    lost = [f"{k + 1} ({100.0 * part:.2g} %)" for k, part in enumerate(share) if part > 0.0]
    if not lost:
        return f"None of the {len(share)} contacts is ever lost"
    named = ", ".join(lost[:MOST_NAMED]) + (" and others" if len(lost) > MOST_NAMED else "")
    return f"Of {len(share)} contacts, {len(lost)} {'is' if len(lost) == 1 else 'are'} lost at times: {named}"


def _range(difference: xarray.DataArray) -> str:
    ends = (int(difference.values.argmin()), int(difference.values.argmax()))
    return " to ".join(
        f"{_signed(difference[i])} ({nominal_frequency(float(difference.band[i]))})" for i in ends
    )
