"""Which laws suit a case: where it lies on the law accuracy map, and what they are off by there."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from scipy import fft

from asperity.arguments import Array
from asperity.errors import percent
from asperity.reduction.texture import areal_texture
from asperity.reference.law_accuracy import HIGH, LOW, LawMap, MappedPoint, Place, law_map
from asperity.scenarios.geometry import Geometry
from asperity.scenarios.scene import PreparedCase
from asperity.spectra import psd, root_mean_square
from asperity.speeds import at_fastest
from asperity.structures.track import Track
from asperity.surfaces.spectra import CORRELATION_THRESHOLD
from asperity.surfaces.strip import Strip
from asperity.threads import thread_count
from asperity.written_numbers import in_newtons, rounded

ROWS = 2**15
"""Most rows of a path, from its middle, that are looked at: a length that is transformed fast."""
STEEPNESS = 8
"""Power of the wavenumber with which waves are left out below the lowest: a steeper edge rings longer."""
RESOLUTION = 10.0
"""Step of the frequencies at which the linear force is summed, Hz, where the path is long enough."""

SquareTransfer = Callable[[float, Array], Array]
"""Mean square of the linear contact force per height of the texture (f,), (N/m)², by contact stiffness, N/m,
and frequencies (f,), Hz."""


def place_of(path: Strip, shape: Geometry, speed: float, square_transfer: SquareTransfer) -> Place | None:
    """Find the place of a texture under the bodies of a case on the map, if there is one.

    Waves that excite less than 100 Hz at the speed, m/s, are left out: the bodies follow them. Smooth paths
    have no place.
    """
    heights, felt = _heard(path, shape, speed)
    if not heights.any():
        return None
    approach = shape.hertz.approach(shape.load)
    dx = shape.spacing[0]
    along, across = correlation_lengths(heights, shape.spacing)
    a, b = shape.semi_axes
    # rms force of the linear contact that follows the felt plane, up to 10 kHz
    wavenumber, density = psd(felt, dx, segment=min(len(felt), round(speed / RESOLUTION / dx)))
    among = (wavenumber * speed >= LOW) & (wavenumber * speed <= 2.0 * HIGH)
    transfer = square_transfer(shape.hertz.tangent_stiffness(approach), (wavenumber * speed)[among])
    force = float(np.sqrt(density[among] @ transfer * (wavenumber[1] - wavenumber[0])))
    return Place(
        roughness=root_mean_square(heights) / approach,
        correlation=along / (2.0 * a),
        across=across / (2.0 * b),
        within=root_mean_square(heights[:, heights.shape[1] // 2] - felt) / approach,
        dynamic=force / shape.load,
        highest_wavenumber=2.0 * math.pi * HIGH / speed * a,
    )


def _heard(path: Strip, shape: Geometry, speed: float) -> tuple[Array, Array]:
    """Heights (rows, ny) and the plane (rows,) that the patch feels, m, of what excites 100 Hz or more."""
    beside = shape.body.shape[0] // 2  # at its ends the patch sees nothing
    rows = min(path.shape[0], ROWS + 2 * beside)
    first = (path.shape[0] - rows) // 2
    heights = path.rows(first, first + rows)
    felt = -areal_texture(heights, shape.spacing, [0.0], [shape.semi_axes]).heights[0]
    known = slice(beside, rows - beside)
    lowest = LOW / speed
    dx = shape.spacing[0]
    return without_slow(heights[known], dx, lowest), without_slow(felt[known], dx, lowest)


def without_slow(heights: Array, spacing: float, lowest: float) -> Array:
    """Heights (rows, ...) without waves along x below a wavenumber, cycles/m.

    The edge is smooth, half the height at the wavenumber. They are mirrored at their ends, and what is within
    one such wave of these, up to an eighth, is cut off.
    """
    rows = len(heights)
    share = np.arange(rows) / (2.0 * rows * spacing * lowest)
    gain = share**STEEPNESS / (1.0 + share**STEEPNESS)
    cut = min(round(1.0 / (lowest * spacing)), rows // 8)
    spectra = fft.dct(heights, axis=0, workers=thread_count())  # of mirrored lines
    spectra *= gain.reshape(-1, *[1] * (heights.ndim - 1))
    passed = fft.idct(spectra, axis=0, overwrite_x=True, workers=thread_count())
    return passed[cut : rows - cut]


def correlation_lengths(heights: Array, spacing: tuple[float, float]) -> tuple[float, float]:
    """Lags along and across, m, at which the mean product of heights (rows, ny) falls to 0.2 of their square.

    The threshold is that of ISO 25178-2 for Sal. Where it is not reached: half the length, or half the width.
    """
    rows, columns = heights.shape
    furthest = rows // 2
    period = fft.next_fast_len(rows + furthest, real=True)
    spectra = fft.rfft(heights, period, axis=0, workers=thread_count())
    power = np.sum(spectra.real**2 + spectra.imag**2, axis=1)
    along = fft.irfft(power, period)[: furthest + 1] / (columns * (rows - np.arange(furthest + 1)))
    across = [
        np.einsum("xy,xy->", heights[:, : columns - lag], heights[:, lag:]) / (rows * (columns - lag))
        for lag in range(columns // 2 + 1)
    ]
    return _fallen(along, spacing[0]), _fallen(np.array(across), spacing[1])


def _fallen(products: Array, step: float) -> float:
    share = products / max(products[0], np.finfo(float).tiny)
    below = np.flatnonzero(share <= CORRELATION_THRESHOLD)
    if not below.size:
        return step * (len(share) - 1)
    k = max(int(below[0]), 1)
    fall = max(share[k - 1] - share[k], np.finfo(float).tiny)
    return step * (k - 1 + float((share[k - 1] - CORRELATION_THRESHOLD) / fall))


MEANING = (
    "rms over the one-third octaves from 100 Hz to 5 kHz of the force level less that of direct; in brackets "
    "the band that held in four of five random cases"
)
WANTED = 1.0
"""Error that a law is taken for, dB."""
STEP = math.log(10.0) / 2.0
"""Unit of distance on the map: half a decade, about the step of its grid."""
OTHER_KIND = 1.0
"""Distance between a ball on a beam and a wheel on a rail that are in the same place."""
FAR = 1.0
"""Distance to the nearest point beyond which a place is off the map."""
MARGIN = 1.1
"""Ratio by which k a of the highest band may lie beyond those of the points."""
REACH = 2.0
"""Distance over which errors are alike."""
TREND, NOISE = 0.04, 0.1
"""Shares of a trend across the map, and of what chance adds to a point, in the variance of their logarithms.
"""
LONG, WIDE, TINY = 10.0, 1.0, 1e-4
"""Lengths of correlation beyond which nothing changes, in contacts, along and across; least ratio of all."""
LOST = 0.1
"""Share of the time out of contact from which paths part and levels scatter."""
CHEAP = ("areal", "table")
"""Laws that are taken, the cheapest first."""
SURE = "table"
"""The one that scans the whole path, and is to be had wherever the first is."""
UNMAPPED = "direct"
"""Law that is taken where the map knows nothing, as over a defect: windows that hold one are dear to scan."""


@dataclass(frozen=True)
class ExpectedError:
    """The expected error of a law, dB, and the band that held in four of five random cases."""

    law: str
    error: float
    low: float
    high: float

    def __str__(self) -> str:
        return f"{self.law} {_db(self.error)} ({_db(self.low)} to {_db(self.high)})"


@dataclass(frozen=True)
class LawChoice:
    """What the map says of a case."""

    place: Place
    # of the laws of the case, and of those that may be taken, by law; the best first
    expected: dict[str, ExpectedError]
    distance: float  # to the nearest point, in half decades
    nearest: MappedPoint
    reach: tuple[float, float]  # least and greatest k a of the highest band among the points of the bodies
    at: str = ""  # of which speed it is, of one that changes

    @property
    def taken(self) -> str:
        """Law to take."""
        return next(filter(self.trusts, CHEAP), SURE)

    @property
    def off_map(self) -> bool:
        """Whether no point is near, or none of the bodies has waves as short, or as long, for its contact."""
        low, high = self.reach
        return self.distance > FAR or not low <= self.place.highest_wavenumber <= high

    def trusts(self, law: str) -> bool:
        """Whether a law is expected to be as near as is wanted."""
        return not self.off_map and law in self.expected and self.expected[law].high <= WANTED

    def rows(self) -> Iterator[tuple[str, str]]:
        """Say which law to take, the errors to expect, and where the case lies: names and values."""
        yield "law to take", self._advice()
        errors = ", ".join(map(str, self.expected.values()))
        yield "expected errors, dB", f"{'guesses: ' * self.off_map}{errors}; {MEANING}"
        place = self.place
        near = self.nearest
        off = ": off the map, so that the expected errors are guesses" if self.off_map else ""
        yield (
            "place on the map",
            f"rms {rounded(place.roughness, 2)} approaches, {rounded(place.within, 2)} within the patch; "
            f"correlation length {rounded(place.correlation, 2)} contacts; dynamic force about "
            f"{rounded(place.dynamic, 2)} of the load; k a of {HIGH / 1e3:g} kHz "
            f"{rounded(place.highest_wavenumber, 2)}, mapped from {rounded(self.reach[0], 2)} to "
            f"{rounded(self.reach[1], 2)}. Nearest point: {near.kind}, {in_newtons(near.load)}, "
            f"{near.speed:g} m/s, {self.distance:.1f} half decades away{off}{self.at}",
        )

    def entries(self) -> dict[str, Any]:
        """Lay it out for a result file."""
        return {
            "errors": [asdict(found) for found in self.expected.values()],
            "taken": self.taken,
            "off_map": self.off_map,
            "wanted": WANTED,
        }

    def sentence(self, law: str) -> str | None:
        """Say in a sentence how far a law is expected from `direct`; nothing of a law that was not mapped."""
        if (found := self.expected.get(law)) is None:
            return None
        instead = "" if law == self.taken or self.trusts(law) else f"; take {self.taken}"
        guess = "A guess, off the map of law errors" if self.off_map else "By the map of law errors"
        return (
            f"{guess}: {law} is {_db(found.error)} dB ({_db(found.low)} to {_db(found.high)}) from direct, "
            f"rms over the one-third octaves{instead}"
        )

    def _advice(self) -> str:
        cheap = self.expected[CHEAP[0]]
        if self.taken == cheap.law:
            text = f"{cheap.law}: expected within {WANTED:g} dB of direct, without a scan of the path"
        elif self.off_map:
            text = f"{self.taken}: how far {cheap.law} is off is not known here"
        else:
            leaves = "leaves its range" if cheap.error > WANTED else "may leave its range"
            text = f"{self.taken}: {cheap.law} {leaves} ({_db(cheap.error)} dB, up to {_db(cheap.high)})"
        if self.nearest.loss > LOST:
            lost = percent(self.nearest.loss)
            text += f"; with contact lost {lost} of the time, levels of short records scatter"
        return text


def unmapped(prepared: PreparedCase) -> str:
    """Say why the map of law errors cannot know of a case; empty where nothing keeps it from that."""
    case = prepared.case
    textures = prepared.textures
    if textures.path is None:
        return "it holds textures, and of a line nothing is known beside it"
    seen = f"{UNMAPPED} solves the contact as it is"
    if textures.defects is not None:
        return f"it holds no flats and no joints; {seen}"
    if textures.areal or not np.ptp(textures.line):
        return ""
    names = {"rail": case.over_name, "wheel": case.ROLLING}
    if measured := " and ".join(names[body] for body in textures.lines):
        how = f"heights beside the measured lines of the {measured} are carried over from these"
        return f"it holds textures that are rough across, too, and {how}; {seen}"
    return f"it holds textures that are rough across, too, and this one is alike all across; {seen}"


def advised_law(prepared: PreparedCase, choice: LawChoice | None) -> Iterator[tuple[str, str]]:
    """Say which law to take, or why the map does not say it: names and values."""
    if choice is not None:
        yield from choice.rows()
    elif reason := unmapped(prepared):
        yield "law to take", f"not told by the map of law errors: {reason}"


def law_choice(prepared: PreparedCase) -> LawChoice | None:
    """Ask the map about a case; it knows nothing of lines alone, smooth paths and defects.

    It holds wheels on rails, which stand for all that rolls over a track, and balls on beams, for all else.
    """
    case = prepared.case
    scene = prepared.scene
    path = prepared.textures.path
    if path is None or unmapped(prepared):
        return None
    kind = "wheel-on-rail" if isinstance(scene.over, Track) else "ball-on-beam"
    place = place_of(path, prepared.shape, case.speed, scene.square_transfer)
    if place is None:
        return None
    return replace(choose(law_map(), kind, place, case.laws), at=at_fastest(case.speed))


def choose(mapped: LawMap, kind: str, place: Place, laws: Sequence[str]) -> LawChoice:
    """Expect the errors of laws at a place on a map, and say which law to take."""
    known = [law for law in dict.fromkeys((*CHEAP, *laws)) if law in mapped.spread]
    expected = sorted((expected_error(mapped, kind, place, law) for law in known), key=lambda e: e.error)
    here = _coordinates(mapped, kind, place)
    distances = np.linalg.norm(_of_points(mapped) - here, axis=1)
    reached = [p.place.highest_wavenumber for p in mapped.points if p.kind == kind]
    reach = (min(reached) / MARGIN, max(reached) * MARGIN)
    nearest = mapped.points[int(np.argmin(distances))]
    return LawChoice(place, {found.law: found for found in expected}, float(distances.min()), nearest, reach)


def expected_error(mapped: LawMap, kind: str, place: Place, law: str) -> ExpectedError:
    """Expect the error of a law at a place."""
    logarithm, deviation = estimate(mapped, kind, place, law)
    error = math.exp(logarithm)
    factor = math.exp(mapped.spread[law] * deviation)
    return ExpectedError(law, error, error / factor, error * factor)


def estimate(mapped: LawMap, kind: str, place: Place, law: str) -> tuple[float, float]:
    """Estimate the logarithm of the error of a law, and its standard deviation in those of the whole map."""
    at, logarithms, inverse = _fitted(mapped, law)
    here = _coordinates(mapped, kind, place)[None]
    to_points = _covariance(at, here)[:, 0]
    mean = float(logarithms.mean())
    weights = inverse @ to_points
    variance = float(_covariance(here, here)[0, 0] + NOISE - weights @ to_points)
    return mean + float(weights @ (logarithms - mean)), math.sqrt(variance)


@lru_cache(maxsize=32)
def _fitted(mapped: LawMap, law: str) -> tuple[Array, Array, Array]:
    """Coordinates of the points of a law, logarithms of its errors there, and their inverse covariance."""
    known = [point for point in mapped.points if law in point.errors]
    at = _of_points(mapped)[[law in point.errors for point in mapped.points]]
    inverse = np.asarray(np.linalg.inv(_covariance(at, at) + NOISE * np.eye(len(at))), dtype=np.float64)
    return at, np.log([point.errors[law] for point in known]), inverse


def _covariance(these: Array, those: Array) -> Array:
    """Covariance (n, m) of logarithms at coordinates (n, c) and (m, c)."""
    squares = np.sum((these[:, None] - those) ** 2, axis=-1)
    return np.exp(-0.5 * squares / REACH**2) + TREND * these @ those.T


def _coordinates(mapped: LawMap, kind: str, place: Place) -> Array:
    """Coordinates of a place; a contact feels no difference between lengths far beyond its own."""
    lengths = (min(place.correlation, LONG), min(place.across, WIDE))
    ratios = np.maximum([place.within, place.dynamic, *lengths, place.highest_wavenumber], TINY)
    kinds = [known == kind for known in _kinds(mapped)]
    return np.append(np.log(ratios) / STEP, np.multiply(kinds, OTHER_KIND / math.sqrt(2.0)))


@lru_cache(maxsize=4)
def _kinds(mapped: LawMap) -> list[str]:
    """Kinds of scenes on a map."""
    return sorted({point.kind for point in mapped.points})


@lru_cache(maxsize=4)
def _of_points(mapped: LawMap) -> Array:
    """Coordinates (n, c) of all points of a map."""
    return np.array([_coordinates(mapped, point.kind, point.place) for point in mapped.points])


def _db(error: float) -> str:
    return f"{error:.1f}" if error < 9.95 else f"{error:.0f}"
