"""Optimising the texture of a case: from the case and an aim to textures that were rolled over."""

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from asperity.arguments import Array, FilePath
from asperity.case import cases, form, scene
from asperity.case.any_case import AnyCase
from asperity.errors import InputError, PhysicsWarning
from asperity.optimising.allocation import Limits, Trial, rms_of, search
from asperity.optimising.definition import (
    Aim,
    Bands,
    Measure,
    bands_of,
    line_frequencies,
    measures_of,
    with_texture,
)
from asperity.optimising.kinds import Optimisation, optimisation_of, searched
from asperity.progress import Progress, shown_progress
from asperity.reporting.data import written_units
from asperity.running import run, with_choices_fixed
from asperity.scenarios.preparing import prepare
from asperity.scenes import result
from asperity.spectra import band_energies, level_of
from asperity.store import Store, made
from asperity.threads import one_thread_in_linear_algebra
from asperity.written_numbers import between, engineering, rounded, signed

if TYPE_CHECKING:
    from asperity.optimising.bearing import OptimisedBearing
    from asperity.scenes.report import Result

FORMAT = 2
"""Raise it when what is kept of a trial no longer means what it meant."""
AT_A_BOUND = 0.05
"""A level so near to its bound lies on it, dB."""


@dataclass(frozen=True, eq=False)
class Optimised:
    """A texture that was optimised.

    Attributes
    ----------
    aim : Aim
        What the texture should be.
    measure : Measure
        What it was judged by.
    limits : Limits
        What the levels of the bands that were changed might be.
    before, after : Bands
        The texture of the case, and the one found.
    trials : tuple of Trial
        Textures that the search went on from, rolled over with ``aim.law``; that of the case first, the one
        found last.
    came_to_rest : bool
        Whether the search ended by itself.
    case : Case
        The case with the texture found.
    result_before, result_after : Result
        Both textures, rolled over with ``aim.verify`` and ``aim.law``.
    """

    aim: Aim
    measure: Measure
    limits: Limits
    before: Bands
    after: Bands
    trials: tuple[Trial, ...]
    came_to_rest: bool
    case: scene.Case
    result_before: "Result"
    result_after: "Result"

    def level(self, after: bool, law: str) -> float:
        """Level of the quantity, dB, of one of the two textures with a law that was rolled over both."""
        tree = self.result_after if after else self.result_before
        frequency = line_frequencies(tree)
        density = self.measure.density(tree, law)
        return float(level_of(density.sum() * (frequency[1] - frequency[0])))

    def band_levels(self, tree: "Result", law: str) -> Array:
        """Level of the quantity (b,), dB, while each changed band is passed, of one of the results."""
        density = self.measure.density(tree, law)
        edges = self.after.edges(self.case.speed)
        return level_of(band_energies(line_frequencies(tree), density, *edges))

    @property
    def levels(self) -> dict[str, tuple[float, float]]:
        """Level of the quantity before and after, dB, by law: that of the check, then that of the search."""
        laws = dict.fromkeys((self.aim.verify, self.aim.law))
        return {law: (self.level(False, law), self.level(True, law)) for law in laws}

    @property
    def changes(self) -> dict[str, float]:
        """By how much the level of the quantity changes, dB, by law."""
        return {law: after - before for law, (before, after) in self.levels.items()}

    @property
    def missed(self) -> dict[str, float]:
        """By how much the run after is over the limit, dB, by law; empty without a limit."""
        if (limit := self.aim.limit) is None:
            return {}
        return {law: max(after - limit, 0.0) for law, (_, after) in self.levels.items()}

    @property
    def settled(self) -> bool:
        """Whether the search ended by itself, and the run after keeps the limit by each law."""
        return self.came_to_rest and not any(self.missed.values())

    @property
    def of_limit(self) -> str:
        """Say whether the texture found keeps the limit, by each law; nothing where none was asked for."""
        if (limit := self.aim.limit) is None:
            return ""
        told = []
        for law, (_, after) in self.levels.items():
            over = self.missed[law]
            kept = f"missed by {rounded(over, 2)} dB ({after:.2f})" if over else f"kept ({after:.1f})"
            told.append(f"by {law} {kept}")
        return f"Limit {limit:g} {written_units(self.measure.units)}: {', '.join(told)}."

    @property
    def active(self) -> list[str]:
        """Limits that the texture found lies on."""
        limits = self.limits
        levels = self.after.levels[self.after.changed]
        aim = self.aim
        found = []
        if aim.limit is not None and abs(self.trials[-1].level - aim.limit) < 2 * AT_A_BOUND:
            found.append("limit")
        for name in ("rms_at_least", "rms_at_most"):
            bound = getattr(limits, name)
            if 0.0 < bound < np.inf and abs(20.0 * np.log10(rms_of(levels) / bound)) < AT_A_BOUND:
                found.append(name)
        if np.isfinite(limits.budget) and limits.cost(levels) > limits.budget - AT_A_BOUND:
            found.append("budget")
        for name, bound in (("lowest", limits.lowest), ("highest", limits.highest)):
            if count := np.count_nonzero(np.abs(levels - bound) < AT_A_BOUND):
                found.append(f"{name} in {count} of {len(levels)} bands")
        return found

    @property
    def sentence(self) -> str:
        """What came of it, for people."""
        aim = self.aim
        first = self.before
        last = self.after
        rms = [engineering(rms_of(bands.levels[bands.changed]), "m") for bands in (first, last)]
        units = written_units(self.measure.units)
        told = [
            f"{law} {before:.1f} to {after:.1f} {units}, {signed(after - before)} dB"
            for law, (before, after) in self.levels.items()
        ]
        lay = ""
        if aim.lateral and first.lateral and last.lateral:
            lay = f", lay {rounded(first.lateral)} to {rounded(last.lateral)}"
        words = [
            f"{self.measure.meaning}: {'; '.join(told)}; rms of the bands {between(*rms)}{lay}.",
            *([self.of_limit] if self.of_limit else []),
            f"Active bounds: {'; '.join(self.active) or 'none'}.",
        ]
        if not self.settled:
            words.append("The search did not settle: the best texture that was met is shown.")
        if aim.limit is None and self.changes[aim.verify] >= 0.0:
            words.append(f"By {aim.verify} the texture is no better: {aim.law} does not hold here.")
        return " ".join(words)


def optimise(
    case: FilePath | Mapping[str, Any] | AnyCase,
    progress: Progress | None = None,
    **aim: Any,
) -> "Optimised | OptimisedBearing":
    """Find the texture that rolls quietest, or the roughest that keeps a limit.

    Parameters
    ----------
    case : path, mapping or case object
        The case, as `asperity.run` takes it.
    progress : callable, optional
        ``progress(done, total, message)``, called during long work.
    **aim
        What the texture shall be, in SI or as text with a unit, as the keys that ``asperity new
        optimisation`` lists: ``quantity``, ``rms_at_least``, ``budget``, ``limit`` and so on; of a ball
        bearing those of ``asperity new optimisation-of-bearings``: ``medium_band``, ``price`` and so on.

    Returns
    -------
    Optimised, or OptimisedBearing
        Textures before and after, the case with the one found, and both rolled over again.

    Raises
    ------
    InputError
        If the case or the aim is wrong.
    ComputationError
        If no texture lies within the limits, or a computation fails.

    Notes
    -----
    The bands of the texture are one-third octaves of wavelength λ, which are heard at v/λ. Energies of the
    response in these bands of frequency are, for a linear contact, in proportion to those of the texture; a
    law that is rolled over each trial corrects the proportions. Trials are kept in the store: interrupted,
    the same search goes on where it was.

    Examples
    --------
    >>> import asperity
    >>> found = asperity.optimise(case, rms_at_least="0.3 um", law="hertz", verify="linear")
    >>> found.changes["linear"] < 0.0
    True
    """
    given = cases.as_case(case)
    asked = optimisation_of(given).aim(**aim)
    with shown_progress(progress) as told:
        found: Optimised | OptimisedBearing = searched(given, asked, told)
        return found


def optimised(case: scene.Case, aim: Aim, progress: Progress) -> Optimised:
    """Find the texture of a case by an aim, as `optimise` does."""
    measures = measures_of(case)
    if aim.quantity not in measures:
        raise InputError("quantity", f'"{aim.quantity}" of {case.kind}', " or ".join(measures))
    measure = measures[aim.quantity]
    before = bands_of(case, aim.longest, aim.shortest)
    if aim.lateral is not None and before.lateral is None:
        raise InputError("lateral", "bounds for a line, which has no lay", "a surface", "Remove the key.")
    searched_about = with_choices_fixed(case, (aim.law,))
    limits = aim.limits(before.levels[before.changed])
    numbers = itertools.count(1)

    def report(words: str) -> None:
        number = next(numbers)
        progress(number, number + 1, f"texture {number}: {words}")

    def roll(levels: Array, lateral: float | None) -> Trial:
        return _rolled(searched_about, aim, measure, before.with_changed(levels, lateral), progress)

    start = roll(before.levels[before.changed], before.lateral)
    lay = None if aim.lateral is None else (aim.lateral[0], aim.lateral[1])
    trials, settled = search(roll, start, limits, aim.limit, lay, report)
    after = before.with_changed(trials[-1].levels, trials[-1].lateral)
    laws = tuple(dict.fromkeys((aim.verify, aim.law)))
    case = with_choices_fixed(case, laws)
    found = with_texture(case, after)
    results = [run(each.with_(laws=laws), progress) for each in (with_texture(case, before), found)]
    return Optimised(aim, measure, limits, before, after, tuple(trials), settled, found, *results)


def _rolled(base: scene.Case, aim: Aim, measure: Measure, bands: Bands, progress: Progress) -> Trial:
    """Roll over a texture with the law of the search; what came of it is kept by all that it depends on."""
    case = with_texture(base, bands).with_(laws=(aim.law,))

    def rolled() -> dict[str, Array]:
        # those of the texture found are told
        with PhysicsWarning.ignored(), one_thread_in_linear_algebra():
            tree = result.computed_result(prepare(case), progress, [])
        return {"frequency": line_frequencies(tree), "density": measure.density(tree, aim.law)}

    kept = made(Store(), form.case_key("texture", FORMAT, case, aim.quantity, aim.law), rolled)
    frequency = kept["frequency"]
    density = kept["density"]
    energies = np.maximum(band_energies(frequency, density, *bands.edges(case.speed)), 0.0)
    whole = float(density.sum() * (frequency[1] - frequency[0]))
    return Trial(bands.levels[bands.changed], bands.lateral, energies, max(whole - energies.sum(), 0.0))


OF_BODIES = Optimisation(Aim, optimised, "asperity.cli.optimising_texture.told_texture")
