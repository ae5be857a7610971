"""Are samples and path one population, is one stiffness enough, does the direction matter? Answers in dB."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
import scipy
from numpy.typing import NDArray
from scipy.special import fdtrc

from asperity.errors import Grade, ShortRecordWarning
from asperity.laws import spec_of
from asperity.reduction.stiffness import samples_of_maps
from asperity.scenarios.chain import Chain
from asperity.scenarios.reducing import Reduction
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.spectra import autocorrelation_lengths, psd_1d, texture_direction

SIGNIFICANCE = 0.01
"""Probability by chance below which groups are told apart: there are several tests in every run."""
EFFECT = (1.0, 3.0)
"""Effects on levels, dB: warned of, and out of range, above."""
FEWEST_SAMPLES = 4
"""Samples of which a spread says something."""
PASSED = 10 ** (-10 / 20)
"""Magnitude of a filter from which its scatter is counted: −10 dB."""
PARTS, PIECES = 16, 8
"""Parts of a path whose levels are compared, at most, and pieces in which each of them scatters."""
FEWEST_PARTS = 4
FEWEST_REPEATED = 3
"""Samples beyond the first of each map, from which their scatter inside maps is known."""
PIECE_LENGTHS = 4
"""Length of a piece in lengths of the contact: neighbours are then all but independent."""
WAVES = 2
"""Waves that a sample must hold along and across for its direction to be judged."""


@dataclass(frozen=True)
class Answer:
    """What was asked of a run's texture, and what was found."""

    question: str
    value: str  # its number
    answer: str  # in a sentence
    effect: float  # on levels, dB
    grade: Grade | None  # None where it does not matter
    brief: str = ""  # for a headline
    laws: tuple[str, ...] = ()  # of the case that it concerns


_answered: WeakKeyDictionary[Chain, tuple[Answer, ...]] = WeakKeyDictionary()
"""Answers that were given: the range of validity and the report ask the same."""


def answers(chain: Chain) -> tuple[Answer, ...]:
    """Ask all that there is data for: nothing without samples, or of smooth ones."""
    if chain not in _answered:
        _answered[chain] = _found(chain)
    return _answered[chain]


def _found(chain: Chain) -> tuple[Answer, ...]:
    reduction = chain.reduction
    if reduction is None or not any(np.ptp(sample.heights) for sample in chain.textures.maps):
        return ()
    reduced = tuple(law for law in chain.case.laws if not spec_of(law).sees_heights)
    return (
        *_stiffness(reduction, reduced),
        *_filters(reduction),
        *_maps(chain, reduction, reduced),
        *_along_path(chain, tuple(chain.case.laws)),
        *_direction(chain),
    )


def _grade(effect: float) -> Grade | None:
    return Grade.OUT if effect > EFFECT[1] else Grade.WARNING if effect > EFFECT[0] else None


def _stiffness(reduction: Reduction, laws: tuple[str, ...]) -> Iterator[Answer]:
    """Spread of the tangent stiffness under the load between samples."""
    found = reduction.stiffnesses
    if len(found) < FEWEST_SAMPLES or not found.all():
        return
    spread = float(found.std(ddof=1) / found.mean())
    place = 20.0 * math.log10(1.0 + spread)
    mean = 20.0 * math.log10(1.0 + spread / math.sqrt(len(found)))
    grade = _grade(place)
    enough = "One stiffness is enough" if grade is None else "One stiffness is not enough"
    yield Answer(
        "Is one contact stiffness enough for the path?",
        f"{len(found)} samples, coefficient of variation {100 * spread:.2g} %",
        f"{enough}: where stiffness governs the force, single places differ by {place:.1f} dB (one standard "
        f"deviation), and the mean of the samples is known to {mean:.1f} dB.",
        place,
        grade,
        f"contact stiffness varies by {100 * spread:.0f} % between the samples",
        laws,
    )


def _filters(reduction: Reduction) -> Iterator[Answer]:
    """Spread of the filters of single strips at the working load; short ones scatter by chance."""
    estimated = next(iter(reduction.filters.values())).contact_filter
    count = len(reduction.stiffnesses)
    if count < FEWEST_SAMPLES or not len(estimated.approaches):
        return
    at = int(np.argmin(np.abs(estimated.approaches - reduction.working_approach)))
    passed = estimated.excited & (estimated.magnitude[at] > PASSED) & np.isfinite(estimated.spread[at])
    if not passed.any():
        return
    ratio = estimated.spread[at][passed] / estimated.magnitude[at][passed]
    strip, mean = (
        20.0 * math.log10(1.0 + float(np.sqrt(np.mean(ratio**2) / strips))) for strips in (1, count)
    )
    yield Answer(
        "How well is the contact filter known?",
        f"{count} strips, {strip:.1f} dB rms between them",
        f"The mean filter is known to {mean:.1f} dB, where it passes more than −10 dB.",
        mean,
        None,
    )


def _maps(chain: Chain, reduction: Reduction, laws: tuple[str, ...]) -> Iterator[Answer]:
    """Whether measured maps differ in stiffness by more than places of one map do."""
    maps = chain.textures.maps
    if maps is chain.textures.strips or len(maps) < 2 or not reduction.stiffnesses.all():
        return
    shares = samples_of_maps(len(maps), chain.case.contact.samples)
    if sum(shares) < len(maps) + FEWEST_REPEATED:
        return
    levels = 20.0 * np.log10(reduction.stiffnesses)
    p, beyond = told_apart(np.split(levels, np.cumsum(shares)[:-1]))
    apart = p <= SIGNIFICANCE
    told = (
        f"The maps are not one population: their stiffness differs by {beyond:.1f} dB (one standard "
        "deviation) beyond what places of one map do."
        if apart
        else "The maps differ in stiffness no more than places of one map do."
    )
    yield Answer(
        "Are the measured maps one population?",
        f"{len(maps)} maps, p = {p:.2g}",
        told,
        beyond if apart else 0.0,
        _grade(beyond) if apart else None,
        f"maps differ by {beyond:.1f} dB in stiffness",
        laws,
    )


def _along_path(chain: Chain, laws: tuple[str, ...]) -> Iterator[Answer]:
    """Whether the roughness of the path is the same all along it."""
    textures, patch = chain.textures, 2.0 * chain.shape.semi_axes[0]
    levels = levels_along(textures.line[textures.recorded], patch / chain.shape.spacing[0])
    if levels is None:
        return
    p, beyond = told_apart(list(levels))
    apart = p <= SIGNIFICANCE and beyond > 0.0
    told = (
        f"The roughness is not the same all along the path: its level varies by {beyond:.1f} dB (one "
        f"standard deviation) between {len(levels)} parts of it, beyond chance; a record of another part "
        "differs by as much."
        if apart
        else f"The roughness of {len(levels)} parts of the path differs no more than chance makes it."
    )
    yield Answer(
        "Is the path the same all along?",
        f"{len(levels)} parts, p = {p:.2g}",
        told,
        beyond if apart else 0.0,
        _grade(beyond) if apart else None,
        f"roughness varies by {beyond:.1f} dB along the path",
        laws,
    )


def levels_along(line: NDArray[np.float64], patch: float) -> NDArray[np.float64] | None:
    """Levels, dB, of the slope of a line averaged over a patch, (parts, pieces); None if it is too short.

    The patch is in points. The slope weighs the waves near the length of the contact, which are many in
    every piece.
    """
    points = max(1, round(patch))
    slope = np.diff(scipy.ndimage.uniform_filter1d(line, points))
    piece = PIECE_LENGTHS * points
    parts = min(PARTS, len(slope) // (PIECES * piece))
    if parts < FEWEST_PARTS or not slope.any():
        return None
    length = len(slope) // (parts * PIECES)
    pieces = slope[: parts * PIECES * length].reshape(parts, PIECES, length)
    with np.errstate(divide="ignore"):
        found = 10.0 * np.log10(np.mean(pieces**2, axis=-1))
    return found if np.isfinite(found).all() else None


def told_apart(groups: Sequence[NDArray[np.float64]]) -> tuple[float, float]:
    """Probability that groups of levels differ so by chance, and their standard deviation beyond chance.

    Analysis of variance (R. A. Fisher): the F-test of one classification, and the component of variance
    between groups.
    """
    sizes = np.array([len(group) for group in groups])
    total, count = sizes.sum(), len(groups)
    means = np.array([group.mean() for group in groups])
    within = sum(float(np.sum((g - m) ** 2)) for g, m in zip(groups, means, strict=True)) / (total - count)
    grand = float(np.sum(sizes * means) / total)
    between = float(np.sum(sizes * (means - grand) ** 2)) / (count - 1)
    if within == 0.0:
        return (1.0, 0.0) if between == 0.0 else (0.0, float(means.std(ddof=1)))
    size = (total - np.sum(sizes**2) / total) / (count - 1)
    p = float(fdtrc(count - 1, total - count, between / within))
    return p, math.sqrt(max(0.0, (between - within) / size))


def _direction(chain: Chain) -> Iterator[Answer]:
    """How much more power lines along the path have than lines across it."""
    found = along_over_across(chain.textures.maps, 2.0 * chain.shape.semi_axes[0])
    if found is None or not chain.textures.areal:
        return
    difference, (longest, shortest) = found
    first = chain.textures.maps[0]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ShortRecordWarning)  # a bound is good enough
        lags = autocorrelation_lengths(first)
    numbers = f"{difference:+.1f} dB from {1e6 * longest:.3g} to {1e6 * shortest:.3g} µm".replace("-", "−")
    direction = f"Str {lags[0] / lags[1]:.2f}"
    if abs(difference) <= EFFECT[0]:
        told = "Lines along and across are as rough: the direction of rolling does not matter."
    else:
        direction += f", Std {math.degrees(texture_direction(first)):.0f}°"
        told = (
            f"The texture has a direction: lines along the path are {abs(difference):.1f} dB "
            f"{'rougher' if difference > 0 else 'smoother'} than lines across it. Rolled over at right "
            "angles, its levels differ by about as much."
        )
    yield Answer(
        "Does the direction of rolling matter?", f"{numbers}; {direction}", told, abs(difference), None
    )


def along_over_across(maps: Sequence[HeightMap], patch: float) -> tuple[float, tuple[float, float]] | None:
    """Mean level difference of the spectra along and across, dB, and the wavelengths it is taken over, m.

    From half the shorter side of the samples to half the length of the contact, m, but no less than
    four points; None where that is no octave.
    """
    longest = min(min(surface.size) for surface in maps) / WAVES
    shortest = max(0.5 * patch, 4.0 * max(max(surface.spacing) for surface in maps))
    if longest < 2.0 * shortest:
        return None
    wavenumber = np.geomspace(1.0 / longest, 1.0 / shortest, 24)
    power = []
    for axis in (0, 1):
        spectra = [psd_1d(surface, axis) for surface in maps]
        power.append(np.mean([np.interp(wavenumber, k, density) for k, density in spectra], axis=0))
    if not (power[0].all() and power[1].all()):
        return None
    return float(np.mean(10.0 * np.log10(power[0] / power[1]))), (longest, shortest)
