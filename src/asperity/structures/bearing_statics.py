"""How a ball bearing carries a load at rest: the energy of all contacts is least there, and convex."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Self

import numpy as np

from asperity.arguments import Array, ArrayLike, finite_array, not_negative, require
from asperity.contact.hertz import Hertz, check_half_space
from asperity.errors import ComputationError, Grade, InputError, OutOfRangeWarning
from asperity.structures.balls_in_grooves import STATIC_PRESSURE, BallsInGrooves
from asperity.structures.least_energy import TOLERANCE, least_energy
from asperity.structures.rolling_bearing import FASTEST, RollingBearing
from asperity.written_numbers import rounded

if TYPE_CHECKING:
    from asperity.structures.rollers_on_raceways import RollersOnRaceways

FATIGUE_PRESSURE = 1.5e9
"""Peak pressure, Pa, of the fatigue load limit, below which bearing steel lasts (ISO 281:2007)."""
LEAST = 1e-6
"""N, of what holds a ball between arches: less is none."""
PLANE = np.eye(2)
"""Across which a ball moves: radially and axially."""
STEPS = 24
"""Angles of the cage over the passing of a ball."""
SPEEDS = 14
"""Halvings of the interval that holds the speed at which a ball leaves the inner ring."""


class LoadedRow:
    """A row of balls or rollers under a load, at m angles of its cage."""

    bearing: RollingBearing
    speed: float
    azimuth: Array
    inner_load: Array

    @property
    def touching(self) -> Array:
        """How many balls or rollers touch the inner ring, at each angle of the cage (m,)."""
        return np.asarray(np.count_nonzero(self.inner_load, axis=1), dtype=float)

    @property
    def heaviest(self) -> tuple[int, int]:
        """Angle of the cage and ball or roller, by number, at which one carries most."""
        cage, element = np.unravel_index(int(self.inner_load.argmax()), self.inner_load.shape)
        return int(cage), int(element)

    @cached_property
    def leaving_speed(self) -> float | None:
        """Turns per second from which on some leave the inner ring, all of which are pressed at rest.

        None where it stands still or is slower, or where some are not pressed at rest.
        """
        if self._all_touch() or self.speed == 0.0 or not self.at_speed(0.0)._all_touch():
            return None
        low = 0.0
        high = self.speed
        for _ in range(SPEEDS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.at_speed(middle)._all_touch() else (low, middle)
        return high

    def at_speed(self, speed: float) -> Self:
        """The same load at another speed, turns per second."""
        raise NotImplementedError

    def _all_touch(self) -> bool:
        return bool(self.touching.min() == self.bearing.balls)


@dataclass(frozen=True, eq=False)
class LoadedBearing(LoadedRow):
    """A bearing under a load at m angles of its cage, its Z balls at ψ from the radial load.

    Attributes
    ----------
    bearing : BallBearing
        What is loaded.
    radial, axial, speed : float
        Load on the inner ring, N, the preload in the axial one, and turns per second.
    azimuth : ndarray (m, Z)
        ψ of the balls, rad; those of the first ball are the angles of the cage.
    displacement : ndarray (m, 3)
        Of the inner ring: along the radial load, across it (towards ψ = 90°), axially, m.
    inner_loads, outer_loads : ndarray (m, Z, k)
        Of the contacts, N: one of each ball and ring, or of two flanks those against a positive and against a
        negative axial load.
    inner_angles, outer_angles : ndarray (m, Z, k)
        Of the contacts, rad; NaN of those that do not touch.
    stiffness : ndarray (m, 3, 3)
        Derivative of the force by the displacement of the inner ring, N/m.
    imbalance : float
        Force that is left out of balance, over the load, or over what the interference or the centrifugal
        force of a ball presses if that is more.
    """

    bearing: BallsInGrooves
    radial: float
    axial: float
    speed: float
    azimuth: Array
    displacement: Array
    inner_loads: Array
    outer_loads: Array
    inner_angles: Array
    outer_angles: Array
    stiffness: Array
    imbalance: float

    @property
    def inner_load(self) -> Array:  # type: ignore[override]
        """Load of the heavier contact of each ball with the inner ring (m, Z), N."""
        return self.inner_loads.max(axis=-1)

    @property
    def outer_load(self) -> Array:
        """Load of the heavier contact of each ball with the outer ring (m, Z), N."""
        return self.outer_loads.max(axis=-1)

    @property
    def inner_angle(self) -> Array:
        """Angle of that contact with the inner ring (m, Z), rad; NaN of balls that do not touch."""
        return _of_heavier(self.inner_loads, self.inner_angles)

    @property
    def outer_angle(self) -> Array:
        """Angle of that contact with the outer ring (m, Z), rad; NaN of balls that do not touch."""
        return _of_heavier(self.outer_loads, self.outer_angles)

    def semi_axes(self, ring: str) -> tuple[Array, Array]:
        """Semi-axes of the contacts with the ``"inner"`` or ``"outer"`` ring, along and across (m, Z), m."""
        contact, load = self._contacts[ring]
        along, across = contact.semi_axes_under(1.0)
        return along * np.cbrt(load), across * np.cbrt(load)

    @property
    def inner_pressure(self) -> Array:
        """Peak pressures at the inner ring, (m, Z), Pa."""
        return self._pressure("inner")

    @property
    def outer_pressure(self) -> Array:
        """Peak pressures at the outer ring, (m, Z), Pa."""
        return self._pressure("outer")

    def _pressure(self, ring: str) -> Array:
        contact, load = self._contacts[ring]
        return contact.pressure_under(1.0) * np.cbrt(load)

    @property
    def _contacts(self) -> dict[str, tuple[Hertz, Array]]:
        of = self.bearing
        return {"inner": (of.inner_contact, self.inner_load), "outer": (of.outer_contact, self.outer_load)}

    def damping(self, of_contact: float) -> Array:
        """Damping matrices of the inner ring by dampers of the contacts along their normals.

        Parameters
        ----------
        of_contact : float
            Damping of one contact, N s/m.

        Returns
        -------
        ndarray (m, 3, 3)
            In the directions of `displacement`; symmetric.

        Notes
        -----
        To first order in the frequency, far below that at which balls ring between the rings: a ball follows
        as it does at rest, b = S u with S = (K_i + K_o)⁻¹ K_i, and the dampers of both its contacts dissipate
        what (I − S)ᵀ C_i (I − S) + Sᵀ C_o S says.
        """
        of_contact = not_negative("damping of a contact (N s/m)", of_contact)
        inner = self._links(self.inner_loads, self.inner_angles, self.bearing.inner_conformity, "inner")
        outer = self._links(self.outer_loads, self.outer_angles, self.bearing.outer_conformity, "outer")
        held = np.where((self.outer_load > 0.0)[..., None, None], inner[0] + outer[0], np.eye(2))
        follows = np.linalg.solve(held, inner[0])
        left = np.eye(2) - follows
        turned = np.swapaxes(left, -1, -2) @ inner[1] @ left
        turned = turned + np.swapaxes(follows, -1, -2) @ outer[1] @ follows
        moved = _moved(self.azimuth)
        return of_contact * np.einsum("mzik,mzij,mzjl->mkl", moved, turned, moved)

    def _links(self, load: Array, angle: Array, conformity: float, ring: str) -> tuple[Array, Array]:
        """Stiffness of contacts in the plane of the axis (m, Z, 2, 2), N/m, and n nᵀ of those that touch."""
        contact = self._contacts[ring][0]
        overlap = (load / contact.stiffness_constant) ** (2.0 / 3.0)
        touching = load > 0.0
        there = np.where(touching, angle, 0.0)
        normal = np.stack([np.cos(there), np.sin(there)], axis=-1)
        along = np.where(touching, 1.5 * load / np.where(touching, overlap, 1.0), 0.0)
        across = load / ((conformity - 0.5) * self.bearing.ball_diameter + overlap)
        outer = normal[..., :, None] * normal[..., None, :]
        stiffness = (along - across)[..., None, None] * outer + across[..., None, None] * np.eye(2)
        return stiffness.sum(axis=2), (touching[..., None, None] * outer).sum(axis=2)

    @property
    def contact_angle(self) -> float:
        """Mean angle of both contacts, of balls that touch the inner ring weighted with that load, rad.

        Of two flanks without sign.
        """
        outer = np.where(self.outer_loads > 0.0, self.outer_angles, self.inner_angles)
        angle = np.where(self.inner_loads > 0.0, 0.5 * (self.inner_angles + outer), 0.0)
        if self.bearing.arches:
            angle = np.abs(angle)
        return float((angle * self.inner_loads).sum() / max(self.inner_loads.sum(), 1e-300))

    def at_speed(self, speed: float) -> LoadedBearing:
        """The same load at another speed, turns per second."""
        return _solved(self.bearing, self.radial, self.axial, speed, self.azimuth[:, 0])


def _of_heavier(loads: Array, angles: Array) -> Array:
    """Angles (m, Z) of the heavier of k contacts, of loads and angles (m, Z, k)."""
    return np.take_along_axis(angles, loads.argmax(axis=-1)[..., None], axis=-1)[..., 0]


def angles_of_cage(bearing: RollingBearing, given: ArrayLike | None) -> Array:
    """Angles of the first ball or roller (m,), rad: by default over the passing of one."""
    if given is None:
        given = 2.0 * math.pi / bearing.balls * np.arange(STEPS) / STEPS
    return finite_array("angles of the cage (rad)", np.atleast_1d(np.asarray(given)), shape=(None,))


def load_distribution(
    bearing: BallsInGrooves, radial: float, axial: float, speed: float, cage_angles: ArrayLike | None
) -> LoadedBearing:
    """Solve for the load distribution and doubt it, see `BallBearing.loaded`."""
    radial = not_negative("radial load (N)", radial)
    axial = not_negative("axial load (N)", axial)
    speed = not_negative("speed (1/s)", speed)
    preloaded = axial + bearing.preload
    held = radial + preloaded > 0.0 or bearing.radial_clearance < 0.0
    allowed = "a radial or axial load, or a preload"
    remedy = "Without one the inner ring is loose."
    require(held, "load", "none", allowed, remedy)
    angles = angles_of_cage(bearing, cage_angles)
    try:
        found = _solved(bearing, radial, preloaded, speed, angles)
        _doubt(found)
    except ComputationError as error:
        lift = bearing.centrifugal_force(speed)
        received = (
            f"{rounded(radial, 4)} N radial and {rounded(preloaded, 4)} N axial at "
            f"{rounded(60.0 * speed, 5)} 1/min"
        )
        received += f", with {rounded(lift)} N of each ball outwards" * (lift > 0.0)
        remedy = f"Try {error.remedy}."
        raise InputError("load", f"{received}: {error.what}", "what the balls carry", remedy) from error
    return found


def _length(stretch: Array) -> Array:
    """Lengths (…) of stretches (…, 2): of two components, `numpy.linalg.norm` takes three times as long."""
    radial, axial = stretch[..., 0], stretch[..., 1]
    return np.asarray(np.sqrt(radial * radial + axial * axial))


def _link(stretch: Array, length: float, constant: float) -> tuple[Array, Array, Array, Array]:
    """Energy, force (2), and stiffness (2, 2) of contacts that hold two centres at a length; and the load.

    They are Hertzian: the energy 0.4 K δ^2.5 of the stretch (…, 2), radial and axial, beyond the length.
    """
    distance = _length(stretch)
    normal = stretch / distance[..., None]
    overlap = np.maximum(distance - length, 0.0)
    load = constant * overlap**1.5
    across = (load / distance)[..., None, None]
    along = (1.5 * constant * np.sqrt(overlap))[..., None, None] - across
    stiffness = along * normal[..., :, None] * normal[..., None, :] + across * PLANE
    return 0.4 * constant * overlap**2.5, load[..., None] * normal, stiffness, load


@dataclass(frozen=True)
class _Balls:
    """What the balls of a bearing do between two groove centres that are a stretch (…, 2) apart."""

    bearing: BallsInGrooves
    lift: float  # centrifugal force, N

    @cached_property
    def inner(self) -> tuple[float, float]:
        """Length and constant of the link to the inner groove centre."""
        of = self.bearing
        return (of.inner_conformity - 0.5) * of.ball_diameter, of.inner_contact.stiffness_constant

    @cached_property
    def outer(self) -> tuple[float, float]:
        """Those of the link to the outer one."""
        of = self.bearing
        return (of.outer_conformity - 0.5) * of.ball_diameter, of.outer_contact.stiffness_constant

    def _flanks(self, stretch: Array, ring: str) -> list[tuple[Array, Array, Array, Array]]:
        """What each contact with a ring holds along a stretch (…, 2) of ball and groove, as of `_link`."""
        of = self.bearing
        length, constant = self.inner if ring == "inner" else self.outer
        if not of.arches:
            return [_link(stretch, length, constant)]
        offset = of.arches[ring == "outer"].offset
        return [_link(stretch + np.array([0.0, side]), length, constant) for side in (offset, -offset)]

    def held(self, stretch: Array, ring: str) -> tuple[Array, Array, Array]:
        """Energy, force (2) and stiffness (2, 2) of all contacts with a ring together."""
        (energy, force, stiffness, _), *others = self._flanks(stretch, ring)
        for more_energy, more_force, more_stiffness, _ in others:
            energy, force, stiffness = energy + more_energy, force + more_force, stiffness + more_stiffness
        return energy, force, stiffness

    def contacts(self, stretch: Array, ring: str) -> tuple[Array, Array]:
        """Loads and angles (…, k) of the contacts with a ring; NaN of those that do not touch."""
        found = self._flanks(stretch, ring)
        angles = [
            np.where(load > 0.0, np.arctan2(force[..., 1], force[..., 0]), np.nan)
            for _, force, _, load in found
        ]
        return np.stack([each[3] for each in found], -1), np.stack(angles, -1)

    def together(self, stretch: Array) -> tuple[Array, Array, Array, Array]:
        """Energy, force on the inner groove centre, its stiffness, and place of the ball (…, 2)."""
        if self.bearing.arches:
            return self._between(stretch, *self._on_flanks(stretch))
        series = self.bearing.series_stiffness
        energy, force, stiffness, load = _link(stretch, self.bearing.groove_distance, series)
        normal = stretch / _length(stretch)[..., None]
        length, constant = self.outer
        ball = (length + (load / constant) ** (2.0 / 3.0))[..., None] * normal
        if self.lift == 0.0:
            return energy, force, stiffness, ball
        free = np.zeros_like(stretch)
        free[..., 0] = length + (self.lift / constant) ** (2.0 / 3.0)
        start = np.where((load > self.lift)[..., None], ball, free)
        return self._between(stretch, start, max(self.lift, float(load.max())))

    def _on_flanks(self, stretch: Array) -> tuple[Array, float]:
        """Where balls of arches would be without each other's line, mean by their loads (…, 2); the largest.

        A line are the flanks that face each other; balls that no line presses are thrown into both flanks.
        """
        of = self.bearing
        length, constant = self.outer
        cosine = math.cos(of.arch_angle or 0.0)
        thrown = np.zeros_like(stretch)
        thrown[..., 0] = length * cosine + (self.lift / (2.0 * cosine * constant)) ** (2.0 / 3.0) / cosine
        inner, outer = (each.offset for each in of.arches)
        weight = np.full(stretch.shape[:-1], max(self.lift, LEAST))
        ball = weight[..., None] * thrown
        largest = max(self.lift, LEAST)
        for side in (1.0, -1.0):
            line = stretch + np.array([0.0, side * (inner + outer)])
            load = _link(line, of.groove_distance, of.series_stiffness)[3]
            normal = line / _length(line)[..., None]
            place = (length + (load / constant) ** (2.0 / 3.0))[..., None] * normal
            place = place - np.array([0.0, side * outer])
            ball = ball + load[..., None] * place
            weight = weight + load
            largest = max(largest, float(load.max()))
        return ball / weight[..., None], largest

    def _between(self, stretch: Array, start: Array, largest: float) -> tuple[Array, Array, Array, Array]:
        """As `together`, with balls looked for from some places on (…, 2), under loads up to one, N."""
        ball, _ = least_energy(lambda at: self._apart(stretch, at), start, 0.1 * largest, "balance of a ball")
        energy, force, inner = self.held(stretch - ball, "inner")
        outer = self.held(ball, "outer")
        held = inner + outer[2]
        ridge = 1e-12 * np.trace(held, axis1=-2, axis2=-1) + 1e-9
        condensed = inner - inner @ np.linalg.solve(held + ridge[..., None, None] * PLANE, inner)
        return energy + outer[0] - self.lift * ball[..., 0], force, condensed, ball

    def _apart(self, stretch: Array, ball: Array) -> tuple[Array, Array, Array]:
        """Energy of balls at some places, its gradient and Hessian."""
        inner = self.held(stretch - ball, "inner")
        outer = self.held(ball, "outer")
        gradient = outer[1] - inner[1] - self.lift * np.array([1.0, 0.0])
        return inner[0] + outer[0] - self.lift * ball[..., 0], gradient, inner[2] + outer[2]


def _moved(azimuth: Array) -> Array:
    """How the stretch of a ball at an azimuth, radial and axial, follows the inner ring (m, Z, 2, 3)."""
    moved = np.zeros((*azimuth.shape, 2, 3))
    moved[..., 0, 0] = np.cos(azimuth)
    moved[..., 0, 1] = np.sin(azimuth)
    moved[..., 1, 2] = 1.0
    return moved


def _solved(
    bearing: BallsInGrooves, radial: float, axial: float, speed: float, angles: Array
) -> LoadedBearing:
    """The inner ring in balance at each angle of the cage."""
    return _balanced(bearing, radial, axial, speed, tuple(angles.tolist()))


@lru_cache(maxsize=64)  # of cases that are read one after the other, most have the load of another one
def _balanced(
    bearing: BallsInGrooves, radial: float, axial: float, speed: float, angles: tuple[float, ...]
) -> LoadedBearing:
    azimuth = bearing.azimuths(np.array(angles))
    moved = _moved(azimuth)
    A = bearing.groove_distance
    load = np.array([radial, 0.0, axial])
    rest = np.array([bearing.centres_apart, 0.0])
    offsets = sum(each.offset for each in bearing.arches)

    def stretched(ring: Array) -> Array:
        return rest + np.einsum("mzik,mk->mzi", moved, ring)

    def energy_of(ring: Array) -> tuple[Array, Array, Array]:
        energy, force, stiffness, _ = balls.together(stretched(ring))
        gradient = np.einsum("mzik,mzi->mk", moved, force) - load
        hessian = np.einsum("mzik,mzij,mzjl->mkl", moved, stiffness, moved)
        return energy.sum(-1) - ring @ load, gradient, hessian

    interference = bearing.series_stiffness * max(-0.5 * bearing.radial_clearance, 0.0) ** 1.5
    scale = max(radial, axial, interference)
    lift = bearing.centrifugal_force(speed)
    balls = _Balls(bearing, lift if lift > TOLERANCE * scale else 0.0)  # less would be lost in rounding
    start = np.zeros((len(angles), 3))
    pressed = (5.0 * scale / bearing.balls / bearing.series_stiffness) ** (2.0 / 3.0)
    start[:, 0] = (max(0.5 * bearing.radial_clearance, 0.0) + pressed) * (radial > 0.0)
    along = A * math.sin(bearing.free_angle) - offsets + math.sqrt(2.0 * A * pressed)
    start[:, 2] = along * (axial > 0.0)
    ring, imbalance = least_energy(energy_of, start, max(scale, lift), "balance of the inner ring")
    stretch = stretched(ring)
    ball = balls.together(stretch)[3]
    inner_loads, inner_angles = balls.contacts(stretch - ball, "inner")
    outer_loads, outer_angles = balls.contacts(ball, "outer")
    found = azimuth, ring, inner_loads, outer_loads, inner_angles, outer_angles, energy_of(ring)[2]
    for each in found:
        each.setflags(write=False)
    return LoadedBearing(bearing, radial, axial, speed, *found, imbalance)


def _doubt(found: LoadedBearing) -> None:
    """Refuse or warn of contacts that fill their grooves, of dents, of balls that leave the inner ring."""
    of = found.bearing
    doubt_fit(of)
    alone = _pressed_unloaded(found)
    sides = zip(("inner", "outer"), (of.inner_conformity, of.outer_conformity), of.raceway_radii, strict=True)
    for ring, conformity, raceway in sides:
        contact, load = found._contacts[ring]
        heaviest = float(load.max())
        D = of.ball_diameter
        force, lighter = max(alone[ring], default=(0.0, ""))
        lighter = lighter if force > 0.5 * heaviest else "Lower the load"
        check_half_space(
            contact.semi_axes_under(heaviest),
            0.5 * D,
            groove_radius=conformity * D,
            raceway_radius=raceway if ring == "inner" else -raceway,
            cause=f"{rounded(heaviest, 4)} N of one ball on the {ring} ring",
            lighter=lighter,
        )
        _doubt_flanks(found, ring)
        peak = float(found._pressure(ring).max())
        doubt_pressure(of, ring, peak, STATIC_PRESSURE, lighter)
    if found.leaving_speed is not None:
        OutOfRangeWarning.warn(
            f"At {rounded(60.0 * found.speed, 5)} 1/min centrifugal force lifts balls off the inner ring, "
            "all of which are pressed at rest; the first one leaves at "
            f"{rounded(60.0 * found.leaving_speed, 5)} 1/min. Raise axial load or preload."
        )


def doubt_pressure(of: RollingBearing, ring: str, peak: float, denting: float, lighter: str) -> None:
    """Warn of a pressure, Pa, that leaves dents, or by which rings flow, and say what makes it smaller."""
    limit = min(denting, of.hardness)
    if peak <= limit:
        return
    hard = peak > of.hardness
    means = "the hardness: the rings flow" if hard else "where dents begin (ISO 76)"
    OutOfRangeWarning.warn(
        f"{of.ELEMENT.capitalize()}s press the {ring} ring with {rounded(peak / 1e9)} GPa, above "
        f"{limit / 1e9:g} GPa, {means}. {lighter}.",
        Grade.OUT if hard else Grade.WARNING,
    )


def _doubt_flanks(found: LoadedBearing, ring: str) -> None:
    """Refuse contacts that reach the bottom of an arch, where its arcs meet."""
    if not found.bearing.arches:
        return
    across = float(found.semi_axes(ring)[1].max())
    most = found.bearing.arches[ring == "outer"].flank
    received = f"half an axis of {rounded(1e3 * across)} mm across the {ring} raceway"
    allowed = f"at most {rounded(1e3 * most)} mm, where the arcs of the arch meet"
    require(across <= most, "contact", received, allowed, "Lower the load, or take a wider arch_angle.")


def doubt_fit(of: BallsInGrooves | RollersOnRaceways) -> None:
    """Warn of a clearance below zero that presses what rolls beyond what steel lasts under, unloaded."""
    squeezed = of.interference_force(overlap_of(of))
    peak = max(each.pressure_under(squeezed) for each in (of.inner_contact, of.outer_contact))
    if peak > FATIGUE_PRESSURE:
        OutOfRangeWarning.warn(
            f"clearance = {rounded(of.radial_clearance * 1e6, 4)} µm presses every {of.ELEMENT} with "
            f"{rounded(peak / 1e9)} GPa, {rounded(squeezed, 4)} N, without any load: beyond "
            f"{FATIGUE_PRESSURE / 1e9:g} GPa bearing steel fatigues (ISO 281), and fits stay below. Is the "
            "unit right? Take a looser fit."
        )


def overlap_of(of: BallsInGrooves | RollersOnRaceways) -> float:
    """How far raceways overlap where something rolls between them unloaded, along its normal, m."""
    return max(-0.5 * of.radial_clearance * math.cos(of.free_angle), 0.0)


def pressed_by_fit(of: BallsInGrooves | RollersOnRaceways) -> tuple[float, str]:
    """Force of a ball or roller, N, that comes from the fit alone, and what makes it smaller."""
    squeezed = of.interference_force(overlap_of(of))
    clearance = f"A clearance of {rounded(of.radial_clearance * 1e6, 4)} µm alone"
    return squeezed, f"{clearance} presses each {of.ELEMENT} with {rounded(squeezed, 4)} N: take a looser fit"


def _pressed_unloaded(found: LoadedBearing) -> dict[str, list[tuple[float, str]]]:
    """Forces of a ball on each ring, N, that come from no load, and what makes each of them smaller."""
    of = found.bearing
    looser = pressed_by_fit(of)
    thrown = of.centrifugal_force(found.speed)
    turning = f"Centrifugal force alone is {rounded(thrown, 4)} N at {rounded(60.0 * found.speed, 5)} 1/min"
    slower = (thrown, f"{turning}: run slower")
    return {"inner": [looser], "outer": [looser, slower]}


def doubt_speed(bearing: RollingBearing, speed: float) -> None:
    """Warn of a speed, turns per second, at which hardly any bearing runs."""
    if speed > bearing.fastest:
        factor = 60.0 * speed * 1e3 * bearing.pitch_diameter
        OutOfRangeWarning.warn(
            f"speed = {rounded(speed, 5)} Hz is {rounded(60.0 * speed, 6)} 1/min, {rounded(factor, 2)} "
            f"mm/min by the pitch diameter: few {bearing.ELEMENT} bearings run beyond {rounded(FASTEST)}. "
            f'Is it in 1/min? Then write "{rounded(speed, 5)} 1/min".'
        )
