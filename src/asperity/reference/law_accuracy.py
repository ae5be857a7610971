"""How far each contact law was from `direct` on the cases of the law accuracy map.

The map is data, made by ``benchmarks/law_accuracy.py`` and told of in ``docs/evidence/law_accuracy.md``.
Laws bear the names that stand in cases; ``linear-remington``, ``linear-dprs`` and ``linear-cnossos`` are
filters of practice in front of the linear contact of smooth bodies.
"""

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

from asperity.files import packaged

LOW, HIGH = 100.0, 5000.0
"""Centres of the lowest and highest one-third octave in which laws were compared, Hz."""
LEAST = 0.1
"""Least error that counts, dB: what is smaller is as good."""


@dataclass(frozen=True)
class Place:
    """A texture and its bodies in numbers without dimension, of waves that excite 100 Hz or more."""

    roughness: float  # rms height over the approach of the smooth bodies under the load
    correlation: float  # correlation length in the rolling direction over the length of the smooth contact
    across: float  # the same across; where the window ends before, the most that it shows
    within: float  # rms height over the plane that the nominal patch feels, over the approach
    dynamic: float  # rms force of the linear contact that follows the felt plane, over the load
    highest_wavenumber: float  # k a: 2 pi `HIGH` over the speed, times the semi-axis along the path


@dataclass(frozen=True)
class MappedPoint:
    """A case that was rolled with `direct` and with the other laws."""

    kind: str
    load: float  # N
    speed: float  # m/s
    anisotropy: float  # correlation length along over that across, as the texture was asked for
    hurst: float
    place: Place  # mean of the paths
    loss: float  # share of the time out of contact under `direct`
    # by law, rms over the one-third octaves of the level of the contact force less that of `direct`, dB, each
    # of energies averaged over the paths; at least `LEAST`
    errors: Mapping[str, float]
    details: Mapping[str, Any]  # what else the file holds


@dataclass(frozen=True, eq=False)
class LawMap:
    """All points, and how far their interpolation held elsewhere."""

    points: tuple[MappedPoint, ...]
    # by law: standard deviations of the estimate, above and below it, within which the logarithm of the error
    # stayed in the share `claim` of the points that were drawn at random, each estimated from all others
    spread: Mapping[str, float]
    claim: float
    bands: tuple[float, ...]  # centres of the one-third octaves, Hz


@cache
def law_map() -> LawMap:
    """Read the map that comes with the program."""
    return law_map_of(json.loads(packaged("reference/law_accuracy.json")))


def law_map_of(data: Mapping[str, Any]) -> LawMap:
    """Lay a map out of what its file holds."""
    return LawMap(mapped_points(data["points"]), data["spread"], data["claim"], tuple(data["bands"]))


def mapped_points(entries: Iterable[Mapping[str, Any]]) -> tuple[MappedPoint, ...]:
    """Lay points out of what a file holds of each."""
    return tuple(
        MappedPoint(
            **{name: point[name] for name in ("kind", "load", "speed", "anisotropy", "hurst", "loss")},
            place=Place(**point["place"]),
            errors={law: max(error, LEAST) for law, error in point["laws"].items()},
            details=point,
        )
        for point in entries
    )
