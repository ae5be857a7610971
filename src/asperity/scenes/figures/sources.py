"""The one total of a run's sound and what it is made of: which source decides, and which are about equal."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from xarray import DataArray, DataTree

from asperity.arguments import Array
from asperity.reporting import data
from asperity.scenes import schema
from asperity.schema import Entry
from asperity.spectra import energy_of, energy_sum

WHOLE, RAIL = "total", "rail"
SURE = 2.0
"""Standard deviations of a difference, by chance, from which two levels are told apart."""
SAME = 0.1
"""Difference of levels, dB, below which they are equal in print."""
BODIES = {RAIL: (RAIL, schema.RAIL_SIDEWAYS), "sleepers": ("sleepers",), "wheel": ("wheel",)}
"""What radiates, and by which motions."""


@dataclass(frozen=True)
class Sources:
    """The total of what a law makes radiate and its parts, dB(A).

    Parameters
    ----------
    whole : float
        The total, with everything that is known to radiate.
    parts : dict of str to float
        What it is made of, by name; what is unknown is missing.
    deviation : dict of str to float
        Standard deviation of the parts by the chance of the record, dB.
    """

    whole: float
    parts: Mapping[str, float]
    deviation: Mapping[str, float] = field(default_factory=dict)

    @property
    def bodies(self) -> dict[str, tuple[float, float]]:
        """Level and its deviation of each body that radiates: of the rail, up and down and sideways."""
        found = {}
        for body, motions in BODIES.items():
            if known := [name for name in motions if name in self.parts]:
                levels = np.array([self.parts[name] for name in known])
                whole = float(energy_sum(levels))
                share = energy_of(levels - whole)
                by_chance = [self.deviation.get(name, 0.0) for name in known]  # of one record: they add up
                found[body] = whole, float(share @ by_chance)
        return found

    @property
    def loudest(self) -> list[str]:
        """The body that is loudest, and those about equal to it."""
        return loudest(self.bodies)

    @property
    def in_words(self) -> str:
        """Its parts: ``"rail 81.2, rail sideways 70.0, sleepers 65.1, wheel 79.1"``."""
        return ", ".join(f"{name} {level:.1f}" for name, level in self.parts.items())


def loudest(levels: Mapping[str, tuple[float, float]]) -> list[str]:
    """The loudest of some levels, each with its standard deviation, dB, and those about equal to it."""
    order = sorted(levels, key=lambda name: -levels[name][0])
    if not order:
        return []
    most, by_chance = levels[order[0]]
    return [
        name
        for name in order
        if most - levels[name][0] <= max(SAME, SURE * float(np.hypot(by_chance, levels[name][1])))
    ]


def decides(names: Sequence[str]) -> str:
    """Say that a source decides, or that several are about equal: ``"the rail decides"``."""
    if len(names) > 1:
        return f"{', '.join(names[:-1])} and {names[-1]} are about equal"
    return f"the {names[0]} {'decide' if names[0].endswith('s') else 'decides'}"


def main_sources(tree: DataTree, entry: Entry) -> Sources | None:
    """Total and parts of a single number of the main law by what radiates; None without it."""
    found = data.stored_variable(tree, entry)
    if found is None or not (laws := data.laws(tree, entry)):
        return None
    levels = _known(found, data.of_law(tree, entry, laws[0]))
    if WHOLE not in levels:
        return None
    deviation = schema.RADIATED_POWER_DEVIATION
    chance = {}
    if (of := data.stored_variable(tree, deviation)) is not None and laws[0] in data.laws(tree, deviation):
        chance = _known(of, data.of_law(tree, deviation, laws[0]))
    return Sources(levels.pop(WHOLE), levels, chance)


def _known(found: DataArray, numbers: Array) -> dict[str, float]:
    """Numbers of a variable by what radiates; what is unknown is missing."""
    names = map(str, found["radiator"].values)
    return {name: float(each) for name, each in zip(names, numbers, strict=True) if np.isfinite(each)}
