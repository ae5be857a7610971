"""How large a wave of a bearing's part may be alone, for a limit of the velocity in each band."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from asperity.arguments import positive, require
from asperity.structures.ball_bearing import BallBearing
from asperity.structures.bearing_statics import LoadedBearing
from asperity.structures.roller_bearing import AnyBearing
from asperity.structures.roller_statics import LoadedRollers
from asperity.structures.rolling_bearing import PARTS

BELOW = 0.5
"""Share of the frequency of the outer ring on its balls up to which it follows waves as it would at rest: at
that share it is a third more than told."""
RADIAL = 1
"""Lobes of a ring that moves as a whole."""


@dataclass(frozen=True)
class WaveTolerance:
    """What one wave of a part makes, and how large it may be alone.

    Parameters
    ----------
    part : str
        ``"outer"``, ``"inner"`` or ``"ball"``, of which one has it.
    order : int
        Waves per turn.
    tones : tuple of float
        That it makes radially, Hz.
    velocity : float
        Rms radial velocity of the outer ring in the band for a wave of 1 m, 1/s.
    band : tuple of float
        Ends of the band, Hz.
    amplitude : float
        That makes the limit of the band alone, m.
    """

    part: str
    order: int
    tones: tuple[float, ...]
    velocity: float
    band: tuple[float, float]
    amplitude: float


def ring_frequency(found: LoadedBearing | LoadedRollers, outer_mass: float) -> float:
    """Natural frequency, Hz, of a free outer ring, kg, that moves radially on its balls."""
    stiffness = float(found.stiffness[:, 0, 0].mean())
    return math.sqrt(stiffness / positive("mass of the outer ring (kg)", outer_mass)) / (2.0 * math.pi)


def wave_tolerances(
    bearing: AnyBearing,
    found: LoadedBearing | LoadedRollers,
    speed: float,
    limits: Sequence[float],
    bands: Sequence[tuple[float, float]],
    *,
    highest: float = math.inf,
) -> Iterator[WaveTolerance]:
    """Waves that are heard radially in each band, and how large each may be alone.

    Parameters
    ----------
    bearing : BallBearing or RollerBearing
        The bearing.
    found : LoadedBearing or LoadedRollers
        It under its load, under which all balls or rollers touch.
    speed : float
        Of the ring that turns, turns per second.
    limits : sequence of float
        Largest rms radial velocity of the outer ring in each band, m/s; infinite for none.
    bands : sequence of (float, float)
        Their ends, Hz.
    highest : float
        Frequency beyond which nothing is told, Hz: `BELOW` of `ring_frequency` where its mass is known.

    Yields
    ------
    WaveTolerance
        Part by part, by rising order.

    Raises
    ------
    InputError
        If some ball or roller does not touch, as under a radial load.

    Notes
    -----
    The outer ring is free and follows its balls, the inner one stands as a whole; contacts are linear, and
    amplitudes normal to the surface. On a raceway n = iZ ± 1 waves of amplitude a move the ring on a circle
    of a/cos α. A ball that is wavy with an even n is wider and thinner by 2a as it turns; of Z balls it moves
    the ring to and fro by 2/Z of that, over cos α, in two tones of half as much each. Amplitudes are inverse
    to the velocity of one wave, and energies of several add. F. P. Wardle, Proc. IMechE 202 C (1988) 305.
    """
    touching = float(found.touching.min())
    arches = isinstance(bearing, BallBearing) and bool(bearing.arches)
    require(not arches, "grooves", "of two arcs", "of one arc: waves of two flanks are not in it")
    received = f"{touching:g} of {bearing.balls} {bearing.ELEMENT}s that touch"
    allowed = "a load under which all touch, an axial one, or a clearance below zero"
    require(touching == bearing.balls, "load", received, allowed)
    turning = bearing.kinematics(speed, contact_angle=found.contact_angle)
    lowest = min(low for low, _ in bands)
    highest = min(highest, max(high for _, high in bands))
    for part in PARTS:
        moved = 1.0 / math.cos(found.contact_angle)
        if part == "ball":
            moved *= 2.0 / bearing.balls  # in each of two tones
        order = 1
        slowest = 0.0
        while slowest <= highest:
            order += 1
            slowest = _slowest(part, order, turning.cage, turning.modulation(part), turning.spin)
            tones = turning.waviness(part, order, RADIAL)
            for limit, (low, high) in zip(limits, bands, strict=True):
                inside = [tone for tone in tones if low <= tone < min(high, highest)]
                velocity = moved * math.sqrt(sum((2.0 * math.pi * tone) ** 2 for tone in inside) / 2.0)
                if inside and lowest <= max(tones):
                    yield WaveTolerance(part, order, tones, velocity, (low, high), limit / velocity)


def _slowest(part: str, order: int, cage: float, ring: float, spin: float) -> float:
    """Frequency below which no wave of so many or more per turn is heard, Hz."""
    passed = order * spin if part == "ball" else order * abs(cage - ring)
    return passed - max(cage, ring)
