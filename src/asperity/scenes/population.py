"""Are samples and path one population, is one stiffness enough, does the direction matter? Answers in dB."""

import math
from collections.abc import Iterator, Sequence

import numpy as np
import scipy
from scipy.special import fdtrc

from asperity.arguments import Array
from asperity.errors import Finding, Grade, ShortRecordWarning
from asperity.laws import spec_of
from asperity.reduction.stiffness import samples_of_maps
from asperity.scenarios.reducing import Reduction
from asperity.scenes.compute import Computed
from asperity.spectra import level_of
from asperity.surfaces.heightmap import HeightMap
from asperity.surfaces.spectra import autocorrelation_lengths, psd_1d, texture_direction
from asperity.written_numbers import count_of, rounded

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


def answers(computed: Computed) -> list[Finding]:
    """Ask all that there is data for: nothing without samples, or of smooth ones.

    Those that concern laws are held to their limit.
    """
    reduction = computed.reduction
    if reduction is None or not any(np.ptp(sample.heights) for sample in computed.textures.maps):
        return []
    reduced = tuple(law for law in computed.case.laws if not spec_of(law).sees_heights)
    return [
        *_stiffness(reduction, reduced),
        *_filters(reduction),
        *_maps(computed, reduction, reduced),
        *_along_path(computed),
        *_direction(computed),
    ]


def _answer(
    question: str, value: str, answer: str, effect: float, brief: str = "", laws: tuple[str, ...] = ()
) -> Finding:
    """What was found, with its effect on levels, dB, which is graded where it concerns laws."""
    grade = Grade.OUT if effect > EFFECT[1] else Grade.WARNING if effect > EFFECT[0] else None
    limit = f"an effect of up to {EFFECT[0]:g} dB"
    remedy = "Take more samples or a longer path; the law table has the stiffness of every place."
    return Finding(
        question, value, limit, grade if laws else None, answer, remedy, brief, laws, effect=effect
    )


def _level(ratio: float) -> float:
    """Change of level, dB, by a relative change of amplitude."""
    return 20.0 * math.log10(1.0 + ratio)


def _stiffness(reduction: Reduction, laws: tuple[str, ...]) -> Iterator[Finding]:
    """Spread of the tangent stiffness under the load between samples."""
    samples = reduction.pressed.stiffnesses
    if len(samples) < FEWEST_SAMPLES or not samples.all():
        return
    spread = float(samples.std(ddof=1) / samples.mean())
    place = _level(spread)
    mean = _level(spread / math.sqrt(len(samples)))
    enough = "One stiffness is enough" if place <= EFFECT[0] else "One stiffness is not enough"
    yield _answer(
        "Is one contact stiffness enough for the path?",
        f"{count_of(len(samples), 'sample')}, coefficient of variation {rounded(100 * spread, 2)} %",
        f"{enough}: where stiffness governs the force, single places differ by {place:.1f} dB (one standard "
        f"deviation), and the mean of the samples is known to {mean:.1f} dB.",
        place,
        f"contact stiffness varies by {100 * spread:.0f} % between the samples",
        laws,
    )


def _filters(reduction: Reduction) -> Iterator[Finding]:
    """Spread of the filters of single strips at the working load; short ones scatter by chance."""
    estimated = next(iter(reduction.filters.values())).contact_filter
    count = len(reduction.pressed.contacts)
    if count < FEWEST_SAMPLES or not len(estimated.approaches):
        return
    at = int(np.argmin(np.abs(estimated.approaches - reduction.pressed.approach)))
    passed = estimated.excited & (estimated.magnitude[at] > PASSED) & np.isfinite(estimated.spread[at])
    if not passed.any():
        return
    square = np.mean((estimated.spread[at][passed] / estimated.magnitude[at][passed]) ** 2)
    strip, mean = (_level(float(np.sqrt(square / strips))) for strips in (1, count))
    value = f"{count} strips, {strip:.1f} dB rms between them"
    answer = f"The mean filter is known to {mean:.1f} dB, where it passes more than −10 dB."
    yield _answer("How well is the contact filter known?", value, answer, mean)


def _maps(computed: Computed, reduction: Reduction, laws: tuple[str, ...]) -> Iterator[Finding]:
    """Whether measured maps differ in stiffness by more than places of one map do."""
    maps = computed.textures.maps
    stiffnesses = reduction.pressed.stiffnesses
    if maps is computed.textures.strips or len(maps) < 2 or not stiffnesses.all():
        return
    shares = samples_of_maps(len(maps), computed.case.contact.samples)
    if sum(shares) < len(maps) + FEWEST_REPEATED:
        return
    groups = np.split(20.0 * np.log10(stiffnesses), np.cumsum(shares)[:-1])
    p, beyond, apart = told_apart(groups)
    answer = "The maps differ in stiffness no more than places of one map do."
    if apart:
        answer = (
            f"The maps are not one population: their stiffness differs by {beyond:.1f} dB (one standard "
            "deviation) beyond what places of one map do."
        )
    brief = f"maps differ by {beyond:.1f} dB in stiffness"
    value = f"{len(maps)} maps, p = {rounded(p, 2)}"
    effect = beyond if apart else 0.0
    yield _answer("Are the measured maps one population?", value, answer, effect, brief, laws)


def _along_path(computed: Computed) -> Iterator[Finding]:
    """Whether the roughness of the path is the same all along it."""
    textures = computed.textures
    question = "Is the path the same all along?"
    if _is_drawn(computed):
        answer = "It is the same all along, as it is drawn of one spectrum: its parts differ by chance."
        yield _answer(question, "drawn, not measured", answer, 0.0)
        return
    patch = 2.0 * computed.shape.semi_axes[0]
    levels = levels_along(textures.line[textures.recorded], patch / computed.shape.spacing[0])
    if levels is None:
        return
    p, beyond, apart = told_apart(list(levels))
    answer = f"The roughness of {len(levels)} parts of the path differs no more than chance makes it."
    if apart:
        answer = (
            f"The roughness is not the same all along the path: its level varies by {beyond:.1f} dB (one "
            f"standard deviation) between {len(levels)} parts of it, beyond chance; a record of another part "
            "differs by as much."
        )
    brief = f"roughness varies by {beyond:.1f} dB along the path"
    value = f"{len(levels)} parts, p = {rounded(p, 2)}"
    effect = beyond if apart else 0.0
    yield _answer(question, value, answer, effect, brief, tuple(computed.case.laws))


def _is_drawn(computed: Computed) -> bool:
    """Whether all that is rolled over is drawn: of a spectrum no realisation of it is to be judged."""
    bodies = {"rail": "surface", "wheel": computed.case.ROLLING}
    rough = {name for name, heights in computed.textures.parts.items() if heights.any()}
    return {bodies[name] for name in rough} <= computed.textures.drawn.keys()


def levels_along(line: Array, patch: float) -> Array | None:
    """Levels, dB, of the slope of a line averaged over a patch, (parts, pieces); None if it is too short.

    The patch is in points. The slope weighs the waves near the length of the contact, which are many in
    every piece.
    """
    points = max(1, round(patch))
    slope = np.diff(scipy.ndimage.uniform_filter1d(line, points))
    parts = min(PARTS, len(slope) // (PIECES * PIECE_LENGTHS * points))
    if parts < FEWEST_PARTS or not slope.any():
        return None
    length = len(slope) // (parts * PIECES)
    pieces = slope[: parts * PIECES * length].reshape(parts, PIECES, length)
    levels = level_of(np.mean(pieces**2, axis=-1))
    return levels if np.isfinite(levels).all() else None


def told_apart(groups: Sequence[Array]) -> tuple[float, float, bool]:
    """Probability that groups of levels differ so by chance, their standard deviation beyond it, and whether.

    Analysis of variance (R. A. Fisher): the F-test of one classification, and the component of variance
    between groups.
    """
    sizes = np.array([len(group) for group in groups])
    total = sizes.sum()
    count = len(groups)
    means = np.array([group.mean() for group in groups])
    within = sum(float(np.sum((g - m) ** 2)) for g, m in zip(groups, means, strict=True)) / (total - count)
    between = float(np.sum(sizes * (means - np.sum(sizes * means) / total) ** 2)) / (count - 1)
    if within == 0.0:
        return (1.0, 0.0, False) if between == 0.0 else (0.0, float(means.std(ddof=1)), True)
    size = (total - np.sum(sizes**2) / total) / (count - 1)
    p = float(fdtrc(count - 1, total - count, between / within))
    beyond = math.sqrt(max(0.0, (between - within) / size))
    return p, beyond, p <= SIGNIFICANCE and beyond > 0.0


def _direction(computed: Computed) -> Iterator[Finding]:
    """How much more power lines along the path have than lines across it."""
    spectra = along_over_across(computed.textures.maps, 2.0 * computed.shape.semi_axes[0])
    if spectra is None or not computed.textures.areal:
        return
    difference, (longest, shortest) = spectra
    first = computed.textures.maps[0]
    with ShortRecordWarning.ignored():  # a bound is good enough
        lags = autocorrelation_lengths(first)
    numbers = f"{difference:+.1f} dB from {rounded(1e6 * longest)} to {rounded(1e6 * shortest)} µm".replace(
        "-", "−"
    )
    value = f"{numbers}; Str {lags[0] / lags[1]:.2f}"
    answer = "Lines along and across are as rough: the direction of rolling does not matter."
    if abs(difference) > EFFECT[0]:
        value += f", Std {math.degrees(texture_direction(first)):.0f}°"
        answer = (
            f"The texture has a direction: lines along the path are {abs(difference):.1f} dB "
            f"{'rougher' if difference > 0 else 'smoother'} than lines across it. Rolled over at right "
            "angles, its levels differ by about as much."
        )
    yield _answer("Does the direction of rolling matter?", value, answer, abs(difference))


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
