"""What bearings on balls and on rollers have in common: room, speeds, tones, centrifugal force."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

import numpy as np

from asperity.arguments import Array, not_negative, one_of, real, require, whole
from asperity.diagnostics.hypotheses import Tone

SLIP = 0.01
"""Share by which the cage of a bearing that is loaded lags at most."""
FASTEST = 1e6
"""Speed times pitch diameter, mm/min, beyond which only spindles, turbines and pumps of their own kind run:
bearings that are listed for general use run slower."""
PARTS = ("outer", "inner", "ball")
"""What can be wavy or faulty."""
GAP = "-1 mm to 10 mm: bearings lie between"
HARD = "1 MPa to 100 GPa: no solid is as soft, or as hard"


class RollingBearing:
    """Bearing of one row: equal balls or rollers between two rigid rings, held apart by a cage."""

    ELEMENT: ClassVar[str]
    """What rolls in it."""

    balls: int
    """Number of balls or rollers."""
    ball_diameter: float
    """Diameter of a ball or roller, m."""
    ball_mass: float
    """Its mass, kg."""
    pitch_diameter: float
    """Diameter of the circle of the centres, m."""
    free_angle: float
    """Contact angle without load, rad."""
    hardness: float
    """Of the rings, Pa."""
    turning: str
    """The ring that turns."""

    def check_room(self) -> None:
        """Refuse balls or rollers that do not fit side by side."""
        things = f"{self.ELEMENT}s"
        room = self.pitch_diameter * math.sin(math.pi / self.balls)  # between the centres of neighbours
        received = (
            f"{self.balls} of {self.ball_diameter * 1e3:.4g} mm on a pitch diameter of "
            f"{self.pitch_diameter * 1e3:.4g} mm"
        )
        allowed = f"{things} that fit side by side: at most {room * 1e3:.4g} mm"
        require(room >= self.ball_diameter, things, received, allowed, f"Take fewer or smaller {things}.")

    def azimuths(self, first: Array) -> Array:
        """Angles (m, Z) of all balls or rollers by those of the first (m,), rad."""
        return first[:, None] + 2.0 * math.pi / self.balls * np.arange(self.balls)

    def with_(self, **others: Any) -> Self:
        """The same bearing with other values for some parameters, in SI."""
        made: Any = self
        return replace(made, **others)

    @property
    def half_taper(self) -> float:
        """Angle β of the sides of what rolls to its axis, rad: zero but of tapered rollers."""
        return 0.0

    @property
    def raceway_radii(self) -> tuple[float, float]:
        """Radii of inner and outer raceway where they are touched at the free angle, m.

        (d_m ∓ D cos(α − β))/2, in the middle of a roller.
        """
        half = 0.5 * self.ball_diameter * math.cos(self.free_angle - self.half_taper)
        return 0.5 * self.pitch_diameter - half, 0.5 * self.pitch_diameter + half

    @property
    def fastest(self) -> float:
        """Speed, turns per second, beyond which hardly any bearing of this size runs (`FASTEST`), Hz."""
        return FASTEST / (60.0 * 1e3 * self.pitch_diameter)

    def centrifugal_force(self, speed: float) -> float:
        """Force of a ball or roller outwards, m (d_m/2) (2π f_c)², N, at a speed, turns per second."""
        cage = 2.0 * math.pi * self.kinematics(speed).cage
        return 0.5 * self.ball_mass * self.pitch_diameter * cage**2

    def flung_outwards(self, contact_angle: float) -> float:
        """Share of centrifugal force by which the outer contact carries more than the inner one.

        That across the axis of a roller, cos(α − β), by contacts that lie β from there; of a ball cos α.
        """
        return math.cos(contact_angle - self.half_taper) / math.cos(self.half_taper)

    def flung_axially(self, lift: float) -> float:
        """Force of the ribs of tapered rollers on the inner ring, N, against an axial load; balls have none.

        It comes of what each roller is thrown along its normal, N: so much less presses the inner contacts.
        """
        return self.balls * lift * math.sin(self.free_angle) if self.half_taper else 0.0

    def kinematics(
        self, speed: float, *, contact_angle: float | None = None, slip: float = 0.0
    ) -> Kinematics:
        """How fast everything turns where what is between the rings rolls, but for a slip of the cage.

        Parameters
        ----------
        speed : float
            Of the ring that turns, turns per second.
        contact_angle : float, optional
            At which balls touch while they run, or of the outer raceway of rollers, rad; the free one by
            default. Tapered rollers roll at that of their axis, β less.
        slip : float
            Share by which the cage is slower than in pure rolling.

        Returns
        -------
        Kinematics
            Frequencies, Hz: those of balls there are those of rollers.
        """
        angle = self.free_angle if contact_angle is None else contact_angle
        diameters = self.ball_diameter, self.pitch_diameter
        axis = angle - self.half_taper
        return Kinematics.rolling(self.balls, diameters, axis, self.turning, speed=speed, slip=slip)

    def tones_between(self, angle: float, least: float, most: float) -> dict[str, Tone]:
        """Tones of the parts per turn at a contact angle, and their limits for a cage that lags.

        Parameters
        ----------
        angle, least, most : float
            Contact angle, and its limits, rad.

        Returns
        -------
        dict
            `asperity.diagnostics.Tone` of ``"outer"``, ``"inner"`` and ``"ball"``.
        """
        limits = [
            self.kinematics(1.0, contact_angle=each, slip=slip)
            for each in (least, angle, most)
            for slip in (0.0, SLIP)
        ]
        found = {}
        for part, (order, modulation) in self.kinematics(1.0, contact_angle=angle).families.items():
            tones = [each.tone(part) for each in limits]
            slower = 1.0 - SLIP if part == "ball" else 1.0  # its spin follows that of the cage
            unlike = 2 if part == "ball" else 1  # a spot of it meets both rings in turn
            found[part] = Tone(order, modulation, min(tones) * slower, max(tones), unlike)
        return found


@dataclass(frozen=True)
class Kinematics:
    """Frequencies of a bearing that turns, Hz.

    Parameters
    ----------
    balls : int
        Z.
    inner, outer : float
        Turns of each ring.
    cage : float
        Turns of the cage.
    spin : float
        Turns of a ball about its own axis, as seen from the cage.
    """

    balls: int
    inner: float
    outer: float
    cage: float
    spin: float

    @classmethod
    def rolling(
        cls,
        balls: int,
        diameters: tuple[float, float],
        angle: float,
        turning: str,
        *,
        speed: float,
        slip: float = 0.0,
    ) -> Kinematics:
        """Frequencies of rolling without sliding, but for a slip of the cage.

        Parameters
        ----------
        balls : int
            Z: balls, or rollers.
        diameters : (float, float)
            Of a ball or roller, and of the circle of their centres, m.
        angle : float
            Of the contacts, rad.
        turning : {"inner", "outer"}
            The ring that turns.
        speed : float
            Of that ring, Hz.
        slip : float
            Share by which the cage is slower than in pure rolling.

        Returns
        -------
        Kinematics
        """
        speed = not_negative("speed (1/s)", speed)
        real("slip", slip, "0 or more, below 1", at_least=0.0, below=1.0)
        diameter, pitch = diameters
        gamma = diameter / pitch * math.cos(angle)
        inner, outer = (speed, 0.0) if turning == "inner" else (0.0, speed)
        cage = 0.5 * (inner * (1.0 - gamma) + outer * (1.0 + gamma)) * (1.0 - slip)
        spin = 0.5 * speed * pitch / diameter * (1.0 - gamma**2)
        return cls(balls, inner, outer, cage, spin)

    def passing_speeds(self, raceway_radii: tuple[float, float]) -> tuple[float, float]:
        """Speeds with which contacts move along the inner and the outer raceway, of such radii, m; m/s."""
        inner, outer = raceway_radii
        along_inner = 2.0 * math.pi * inner * abs(self.cage - self.inner)
        along_outer = 2.0 * math.pi * outer * abs(self.cage - self.outer)
        return along_inner, along_outer

    @property
    def turning(self) -> float:
        """Turns of the ring that turns."""
        return max(self.inner, self.outer)

    @property
    def ball_pass_outer(self) -> float:
        """Balls that pass a spot of the outer raceway (BPFO)."""
        return self.balls * abs(self.cage - self.outer)

    @property
    def ball_pass_inner(self) -> float:
        """Balls that pass a spot of the inner raceway (BPFI)."""
        return self.balls * abs(self.inner - self.cage)

    @property
    def ball_defect(self) -> float:
        """Meetings of a spot of a ball with either raceway (2 BSF)."""
        return 2.0 * self.spin

    def tone(self, part: str) -> float:
        """Frequency of a fault of a part: ``"outer"``, ``"inner"`` or ``"ball"``."""
        return self.families[one_of("part", part, PARTS)][0]

    def modulation(self, part: str) -> float:
        """Turns of a fault of a part past a load that stands still: distance of its side bands."""
        return self.families[one_of("part", part, PARTS)][1]

    @property
    def families(self) -> dict[str, tuple[float, float]]:
        """Tone of each part and distance of its side bands, for `asperity.diagnostics.explained_lines`."""
        tones = self.ball_pass_outer, self.ball_pass_inner, self.ball_defect
        return dict(zip(PARTS, zip(tones, (self.outer, self.inner, self.cage), strict=True), strict=True))

    def waviness(self, part: str, order: int, lobes: int) -> tuple[float, ...]:
        """Tones that a small waviness of a part makes in an axially loaded bearing.

        Parameters
        ----------
        part : {"outer", "inner", "ball"}
            What is wavy.
        order : int
            Waves per turn, 1 or more.
        lobes : int
            What moves: 0 the ring axially, 1 radially, k ≥ 2 the outer ring as it bends in k lobes.

        Returns
        -------
        tuple of float
            Frequencies above zero, rising, seen where nothing turns; none where the parts of all balls
            cancel.

        Notes
        -----
        Ball j is at ψ_j = 2π f_c t + 2πj/Z and meets cos n(ψ_j − 2π f t) of a raceway that turns with f; only
        where n ± k = iZ do the Z contributions to cos kψ not cancel. Order 1 of a raceway that turns is its
        eccentricity. A ball touches with opposite spots, where odd orders cancel. F. P. Wardle, Proc. IMechE
        202 C (1988) 305.
        """
        order = whole("order", order, "a whole number, 1 or more", at_least=1)
        lobes = whole("lobes", lobes, "a whole number, 0 or more", at_least=0)
        if one_of("part", part, PARTS) == "ball":
            found = {abs(order * self.spin + sign * lobes * self.cage) for sign in (-1, 1)}
            return tuple(sorted(found)) if order % 2 == 0 else ()
        passed = self.cage - self.modulation(part)
        matching = [sign for sign in (-1, 1) if (order + sign * lobes) % self.balls == 0]
        tones = {abs(order * passed + sign * lobes * self.cage) for sign in matching}
        return tuple(sorted(tone for tone in tones if tone > 1e-9 * self.turning))
