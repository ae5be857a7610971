"""What the report of a wheel says first: who radiates how much, by which model, and how loud it passes."""

from __future__ import annotations

import numpy as np
from xarray import DataTree

from asperity.reporting.data import laws, number, of_law, present, values
from asperity.reporting.headline import Answers, HeadlineNumber, deciding_bands
from asperity.reporting.tables import Cell, ReportTable, text_cell
from asperity.scenes import schema
from asperity.scenes.figures.noise import sources, told_level
from asperity.scenes.figures.pass_by import passing_radiators
from asperity.scenes.figures.radiated import radiators, silence
from asperity.schema import Entry
from asperity.schema.spectra import BAND
from asperity.spectra import a_weighting, energy_sum

OWN, STANDARD = "own radiation model", "CNOSSOS-EU"
"""Where a sound power comes from: from the vibration that was computed, or from tables by label."""
TRACK = "rail and sleepers"
WHOLE = "total"

Powers = dict[str, float]
"""A-weighted sound power by what radiates, dB re 1 pW; what is not known is missing."""


def noise_answers(tree: DataTree) -> Answers | None:
    """Sound power of the main law by both models, and what decides it."""
    own = _powers(tree, schema.RADIATED_POWER_LEVEL_A, radiators(tree))
    standard = _powers(tree, schema.SOUND_POWER_LEVEL_A, sources(tree, schema.SOUND_POWER_LEVEL_A))
    if not own and not standard:
        return None
    lead, *more = [*_by_vibration(tree, own), *_by_label(tree, standard)]
    return Answers(lead, " ".join(more), _numbers(tree, own, standard), (_table(own, standard),))


def _powers(tree: DataTree, entry: Entry, names: list[str]) -> Powers:
    if not laws(tree, entry):
        return {}
    levels = of_law(tree, entry, laws(tree, entry)[0], entry.dims[-1])
    return {name: float(level) for name, level in zip(names, levels, strict=True) if np.isfinite(level)}


def _by_vibration(tree: DataTree, own: Powers) -> list[str]:
    """Say what radiates most by its own vibration, and in which bands."""
    parts = {name: level for name, level in own.items() if name != WHOLE}
    if not parts:
        return []
    most = max(parts, key=lambda name: parts[name])
    whole = own.get(WHOLE, parts[most])
    bands = _bands(tree, schema.RADIATED_POWER_LEVEL, radiators(tree), most)
    verb = "decide" if most == "sleepers" else "decides"
    return [
        f"By vibration the {most} {verb}: {parts[most]:.1f} of {whole:.1f} dB(A) of sound power, half of it "
        f"in the bands of {bands}.",
        *filter(None, [silence(tree)]),
    ]


def _by_label(tree: DataTree, standard: Powers) -> list[str]:
    """Say which of track and wheel radiates more by CNOSSOS-EU."""
    if not {"track", "wheel"} <= set(standard):
        return []
    less, most = sorted(("track", "wheel"), key=lambda name: standard[name])
    bands = _bands(tree, schema.SOUND_POWER_LEVEL, sources(tree, schema.SOUND_POWER_LEVEL), most)
    return [
        f"By CNOSSOS-EU the {most} decides: {standard[most]:.1f} dB(A), beside {standard[less]:.1f} dB(A) of "
        f"the {less}, half of it in the bands of {bands}."
    ]


def _bands(tree: DataTree, entry: Entry, names: list[str], source: str) -> str:
    """Bands that hold half the A-weighted sound power of a source."""
    band = values(tree, BAND if entry.dims[-1] == BAND.name else schema.NOISE_BAND)
    level = of_law(tree, entry, laws(tree, entry)[0], *entry.dims[1:])[names.index(source)]
    return deciding_bands(band, level + a_weighting(band))


def _numbers(tree: DataTree, own: Powers, standard: Powers) -> tuple[HeadlineNumber, ...]:
    found = []
    if WHOLE in own:
        held = "rail, sleepers and wheel" if "wheel" in own else f"{TRACK}, without the wheel"
        found.append((OWN, own[WHOLE], f"re 1 pW; {held}, from their computed vibration"))
    if WHOLE in standard:
        told = "re 1 pW; track and wheel by its tables, from the computed contact force"
        found.append((STANDARD, standard[WHOLE], told))
    return tuple(
        HeadlineNumber(f"sound power, {how}", f"{level:.1f} dB(A)", note) for how, level, note in found
    )


def _table(own: Powers, standard: Powers) -> ReportTable:
    """Sound power by source and model."""
    both = [own[name] for name in ("rail", "sleepers") if name in own]
    track = float(energy_sum(both)) if len(both) == 2 else np.nan
    rows = [
        ("by vibration, own model", own, track),
        ("by CNOSSOS-EU", standard, standard.get("track", np.nan)),
    ]
    cells = [
        [
            text_cell(name),
            *(Cell(told_level(levels.get(part, np.nan)), "number") for part in ("rail", "sleepers")),
            Cell(told_level(together), "number"),
            Cell(told_level(levels.get("wheel", np.nan)), "number"),
            Cell(told_level(levels.get(WHOLE, np.nan)), "number total"),
        ]
        for name, levels, together in rows
        if levels
    ]
    head = ["dB(A) re 1 pW", "rail", "sleepers", TRACK, "wheel", "sum"]
    note = "" if "wheel" in own or not own else "–: not known. The first sum is without the wheel."
    return ReportTable("sound_power_sources", "Sound power by source", head, cells, note)


def pass_by_answers(tree: DataTree) -> Answers | None:
    """Level beside the track by the main law."""
    levels = {
        name: float(of_law(tree, entry, laws(tree, entry)[0], "radiator")[-1])
        for name, entry in _PASSING.items()
        if present(tree, entry)
    }
    if not levels:
        return None
    (first, level), *others = levels.items()
    away = number(tree, schema.RECEIVER_DISTANCE)
    where = "" if away is None else f", {away:g} m from the track"
    held = "" if "wheel" in passing_radiators(tree) else ", without the wheel"
    told = "".join(f"; {name} {other:.1f} dB(A)" for name, other in others)
    note = f"re 20 µPa{where}{told}; {OWN}{held}"
    return Answers(numbers=(HeadlineNumber(f"pass-by, {first}", f"{level:.1f} dB(A)", note),))


_PASSING = {"TEL": schema.TRANSIT_EXPOSURE_LEVEL, "L_pAFmax": schema.PASS_BY_MAXIMUM_LEVEL}
"""Single numbers; the first only of a vehicle, whose length is known."""
