"""``asperity bearing --limits``: how large each wave of each part may be alone, for limits of the bands."""

import math
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from asperity.case.loaded_bearing import read_bearing
from asperity.diagnostics import ISO_BANDS, one_anderon
from asperity.diagnostics.diagnosis import part_name
from asperity.errors import InputError
from asperity.structures.waviness_tolerance import BELOW, WaveTolerance, ring_frequency, wave_tolerances
from asperity.terminal import say, say_table
from asperity.units import quantity
from asperity.written_numbers import rounded

MOST = 100
"""Waves per turn up to which they are told: shorter ones are ground, and measured, as roughness."""
WIDTH = 110
ALLOWED = "three velocities with units, in anderons, or none, as '50 um/s, 2 anderon, none'"


def say_tolerances(source: str, options: Mapping[str, Any], limits: str, outer_mass: str | None) -> list[Any]:
    """Print the amplitude of each wave that makes the limit of its band alone; return them for programs."""
    keys = read_bearing(source, options)
    velocities = _limits(limits, keys.speed or 1.0)
    if not keys.speed:
        raise InputError("speed", "none", "a speed greater than 0", "Give it, as in --speed '1800 1/min'.")
    found = keys.loaded()
    element = keys.bearing.ELEMENT
    highest = math.inf
    if outer_mass is not None:
        highest = BELOW * ring_frequency(found, quantity(outer_mass, "kg"))
    every = wave_tolerances(keys.bearing, found, keys.speed, velocities, ISO_BANDS, highest=highest)
    told = [each for each in every if each.order <= MOST and math.isfinite(each.amplitude)]
    title = f"Largest amplitude of one wave that keeps its band within {limits}, all else perfect"
    head = ["of", "waves per turn", "tones / Hz", "band / Hz", "µm/s for 1 µm", "amplitude / nm"]
    say_table(title, head, [_row(each, element) for each in told], width=WIDTH)
    say(
        f"Waves of up to {MOST} per turn that move the outer ring radially; all others may be larger. "
        "Energies of several add: of ten that are alike each may have a third. Amplitudes are normal to the "
        f"surface; of a {element}, of one of them."
    )
    beyond = f"beyond half the frequency at which it moves on its {element}s it does not"
    if outer_mass is None:
        say(f"The outer ring follows its {element}s: {beyond}. With its --outer-mass those are left out.")
    else:
        say(f"The outer ring follows its {element}s up to {rounded(highest, 3)} Hz: {beyond}.")
    return [{**asdict(each), "tones": list(each.tones), "band": list(each.band)} for each in told]


def _row(each: WaveTolerance, element: str) -> list[str]:
    tones = ", ".join(f"{tone:.4g}" for tone in each.tones)
    band = f"{each.band[0]:g} to {each.band[1]:g}"
    return [
        part_name(each.part, element),
        f"{each.order}",
        tones,
        band,
        rounded(each.velocity),
        rounded(1e9 * each.amplitude),
    ]


def _limit(word: str, one: float) -> float:
    """Limit of a band in which one anderon is so much, m/s."""
    if word == "none":
        return math.inf
    number, _, unit = word.partition(" ")
    if unit.strip() in ("anderon", "anderons"):
        return one * quantity(number, "")
    return quantity(word, "m/s")


def _limits(text: str, speed: float) -> list[float]:
    """Limits of the three bands, m/s, at turns per second; infinite where there is none."""
    words = [word.strip() for word in text.split(",")]
    if len(words) != len(ISO_BANDS):
        raise InputError("--limits", f"'{text}'", ALLOWED)
    try:
        found = [_limit(word, one) for word, one in zip(words, one_anderon(speed), strict=True)]
    except InputError as error:
        raise error.about("--limits") from None
    if not all(each > 0.0 for each in found):
        raise InputError("--limits", f"'{text}'", f"{ALLOWED}, greater than 0")
    return found
