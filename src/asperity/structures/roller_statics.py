"""How a roller bearing carries a load at rest: the energy of all slices is least there, and convex."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from asperity.arguments import Array, ArrayLike, finite_array, not_negative, positive, require
from asperity.contact.slices import EXPONENT, SlicedContact
from asperity.errors import ComputationError, Grade, InputError, OutOfRangeWarning, percent
from asperity.structures.bearing_statics import (
    LoadedRow,
    angles_of_cage,
    doubt_fit,
    doubt_pressure,
    pressed_by_fit,
)
from asperity.structures.least_energy import TOLERANCE, least_energy
from asperity.structures.rollers_on_raceways import STEEPEST_TILT, RollersOnRaceways
from asperity.written_numbers import rounded

STATIC_PRESSURE = 4.0e9
"""Peak pressure of rollers, Pa, from which on a dent of 1/10 000 of their diameter remains (ISO 76:2006)."""
STEEPEST = 0.1
"""Half width of a contact over the radius of its gap, above which it is refused: no half-space."""
LEAST_LENGTH = 0.5
"""Share of the length of the heaviest roller that carries, below which its crowning is told."""
SHARP = 0.5
"""Pressure at an end that does not fall back without limit, over the largest, from which on it is told."""
FORCES, MOMENTS = slice(0, 3), slice(3, 5)
"""Along the load, across it, axially; tilts in the plane of the load and across it."""


@dataclass(frozen=True, eq=False)
class LoadedRollers(LoadedRow):
    """A roller bearing under a load at m angles of its cage, its Z rollers of n slices at ψ from it.

    Attributes
    ----------
    bearing : RollerBearing
        What is loaded.
    radial, axial, speed : float
        Load on the inner ring, N, and turns per second.
    azimuth : ndarray (m, Z)
        ψ of the rollers, rad; those of the first roller are the angles of the cage.
    displacement : ndarray (m, 5)
        Of the inner ring: along the radial load, across it (towards ψ = 90°), axially, m; tilts in the plane
        of the load and across it, rad.
    moment : ndarray (m, 2)
        On the inner ring in these planes, N m.
    inner_slices, outer_slices : ndarray (m, Z, n)
        Load of each slice, N, from the end that lies back along the axis on.
    stiffness : ndarray (m, 5, 5)
        Derivative of forces and moments by displacements and tilts of the inner ring.
    imbalance : float
        Force that is left out of balance, over the load, or over what the interference or the centrifugal
        force of a roller presses if that is more.
    """

    bearing: RollersOnRaceways
    radial: float
    axial: float
    speed: float
    azimuth: Array
    displacement: Array
    moment: Array
    inner_slices: Array
    outer_slices: Array
    stiffness: Array
    imbalance: float

    @property
    def inner_load(self) -> Array:  # type: ignore[override]
        """Loads of the contacts with the inner ring (m, Z), N."""
        return self.inner_slices.sum(axis=-1)

    @property
    def outer_load(self) -> Array:
        """Loads of the contacts with the outer ring (m, Z), N."""
        return self.outer_slices.sum(axis=-1)

    @property
    def inner_pressure(self) -> Array:
        """Largest pressures along the rollers at the inner ring (m, Z), Pa."""
        return self.bearing.inner_contact.pressures(self.inner_slices).max(axis=-1)

    @property
    def outer_pressure(self) -> Array:
        """Largest pressures along the rollers at the outer ring (m, Z), Pa."""
        return self.bearing.outer_contact.pressures(self.outer_slices).max(axis=-1)

    def damping(self, of_contact: float) -> Array:
        """Damping matrices of the inner ring, held against tilt, by dampers of contacts along their normals.

        Parameters
        ----------
        of_contact : float
            Damping of one contact, N s/m.

        Returns
        -------
        ndarray (m, 3, 3)
            Along the radial load, across it, axially; symmetric.

        Notes
        -----
        As of `asperity.structures.bearing_statics.LoadedBearing.damping`: far below the frequency at which
        rollers ring between the rings one follows by the share s = k_i/(k_i + k_o) of what overlaps, without
        tilt, and the dampers of both contacts take what (1 − s)² and s² of it leave. A slice of the load q is
        as stiff as 10/9 q^(1/10) (c/n)^(9/10).
        """
        of_contact = not_negative("damping of a contact (N s/m)", of_contact)
        of = self.bearing
        stiff = []
        for contact, slices in ((of.inner_contact, self.inner_slices), (of.outer_contact, self.outer_slices)):
            of_slice = (contact.stiffness_constant / contact.slices) ** (1.0 / EXPONENT)
            root = np.where(slices > 0.0, slices ** (1.0 - 1.0 / EXPONENT), 0.0)
            stiff.append(EXPONENT * of_slice * root.sum(axis=-1))
        inner, outer = stiff
        follows = inner / np.where(outer > 0.0, inner + outer, 1.0)
        taken = of_contact * ((1.0 - follows) ** 2 * (inner > 0.0) + follows**2 * (outer > 0.0))
        normal = _followed(of, self.azimuth)[..., 0, FORCES]
        return np.einsum("mz,mzi,mzj->mij", taken, normal, normal)

    @property
    def tilt(self) -> float:
        """Tilt of the inner ring in the plane of the radial load, mean over the cage, rad."""
        return float(self.displacement[:, 3].mean())

    @property
    def rib_force(self) -> Array:
        """Forces of the rib on tapered rollers along their axis (m, Z), N."""
        of = self.bearing
        lift = of.centrifugal_force(self.speed) * of.flung_outwards(of.contact_angle)
        return of.rib_force(self.inner_load, self.outer_load, lift)

    def rib_torque(self, friction: float) -> Array:
        """Torque that turns one ring against the other as rollers' ends rub on the rib (m, Z), N m.

        Parameters
        ----------
        friction : float
            Coefficient of friction.

        Returns
        -------
        ndarray (m, Z)
            Part of each roller; times 2π turns per second it is its heat, W.
        """
        return friction * self.bearing.rib_lever * self.rib_force

    @property
    def carrying_length(self) -> Array:
        """Length of each roller that touches the inner ring (m, Z), m."""
        share = np.count_nonzero(self.inner_slices, axis=-1) / self.bearing.slices
        return self.bearing.roller_length * share

    def semi_axes(self, ring: str) -> tuple[Array, Array]:
        """Half widths and half lengths (m, Z) of contacts with the ``"inner"`` or ``"outer"`` ring, m."""
        inner = ring == "inner"
        slices = self.inner_slices if inner else self.outer_slices
        contact = self.bearing.inner_contact if inner else self.bearing.outer_contact
        along = 2.0 * contact.radius / contact.modulus * contact.pressures(slices).max(axis=-1)
        across = 0.5 * contact.length / contact.slices * np.count_nonzero(slices, axis=-1)
        return along, across

    @property
    def inner_angle(self) -> Array:
        """Contact angles with the inner ring (m, Z), rad; NaN of rollers that do not touch."""
        return np.where(self.inner_load > 0.0, self.bearing.contact_angle, np.nan)

    @property
    def outer_angle(self) -> Array:
        """Contact angles with the outer ring (m, Z), rad; NaN of rollers that do not touch."""
        return np.where(self.outer_load > 0.0, self.bearing.contact_angle, np.nan)

    @property
    def contact_angle(self) -> float:
        """Angle of the contacts, rad: that of the raceways."""
        return self.bearing.contact_angle

    def at_speed(self, speed: float) -> LoadedRollers:
        """The same load and tilt at another speed, turns per second."""
        load = np.array([self.radial, 0.0, self.axial, 0.0, 0.0])
        return _solved(self.bearing, load, self.displacement[0, MOMENTS], speed, self.azimuth[:, 0])


def roller_load_distribution(
    bearing: RollersOnRaceways,
    radial: float,
    axial: float,
    *,
    tilt: ArrayLike | None,
    moment: ArrayLike | None,
    tilt_stiffness: float | None,
    speed: float,
    cage_angles: ArrayLike | None,
) -> LoadedRollers:
    """Solve for the load distribution and doubt it, see `RollerBearing.loaded`."""
    radial = not_negative("radial load (N)", radial)
    axial = not_negative("axial load (N)", axial)
    speed = not_negative("speed (1/s)", speed)
    both = tilt is not None and moment is not None
    require(not both, "load", "both tilt and moment", "one of them", "Remove one.")
    if tilt_stiffness is not None:
        tilt_stiffness = positive("tilt_stiffness (N m/rad)", tilt_stiffness)
        require(moment is None, "load", "both tilt_stiffness and moment", "one of them", "Remove one.")
    tilted = _both_planes("tilt (rad)", tilt, largest=STEEPEST_TILT)
    moments = _both_planes("moment (N m)", moment)
    carried = bearing.contact_angle > 0.0 or axial == 0.0
    allowed = "0 N where contact_angle is 0: such rollers slide axially"
    require(carried, "axial load", f"{rounded(axial, 4)} N", allowed, "Ribs are not in it.")
    _check_axial(bearing, radial, axial, speed)
    turned = bool(moments.any() or tilted.any())
    held = radial + axial > 0.0 or turned or bearing.clearance < 0.0
    remedy = "Without one the inner ring is loose."
    require(held, "load", "none", "a radial or axial load, a moment, a tilt or an interference", remedy)
    angles = angles_of_cage(bearing, cage_angles)
    load = np.array([radial, 0.0, axial, *moments])
    prescribed = tilted if moment is None else None
    try:
        found = _solved(bearing, load, prescribed, speed, angles, tilt_stiffness or math.inf)
    except ComputationError as error:
        received = f"{rounded(radial, 4)} N radial and {rounded(axial, 4)} N axial: {error.what}"
        remedy = f"Try {error.remedy}."
        raise InputError("load", received, "what the rollers carry", remedy) from error
    _doubt(found)
    return found


def _check_axial(bearing: RollersOnRaceways, radial: float, axial: float, speed: float) -> None:
    """Refuse an axial load that is less than what raceways at an angle push a free ring away with."""
    lift = bearing.centrifugal_force(speed) * bearing.flung_outwards(bearing.contact_angle)
    thrown = bearing.flung_axially(lift)
    least = radial * math.tan(bearing.contact_angle) + thrown
    received = f"{rounded(axial, 4)} N beside {rounded(radial, 4)} N radially"
    of_ribs = f", {rounded(thrown, 3)} N of them by rollers that are thrown on their rib" * (thrown > 0.0)
    allowed = (
        f"more than {rounded(least, 4)} N, with which raceways at this angle push the rings apart{of_ribs}"
    )
    remedy = "Give the axial load with which the other bearing of a pair holds it."
    require(least == 0.0 or axial > least, "axial load", received, allowed, remedy)


def _both_planes(what: str, given: ArrayLike | None, *, largest: float = math.inf) -> Array:
    """Tilts or moments in the plane of the load and across it; one number is that in the plane."""
    values = np.zeros(2) if given is None else np.atleast_1d(np.asarray(given))
    if values.shape == (1,):
        values = np.append(values, 0.0)
    allowed = "a number, or two: in the plane of the load and across it"
    if math.isfinite(largest):
        allowed += f", below {largest:g} rad"
    values = finite_array(what, values, allowed, shape=(2,))
    require(np.abs(values).max() < largest, what, float(np.abs(values).max()), allowed, "Is the unit right?")
    return values


@dataclass(frozen=True)
class _Rollers:
    """What rollers do between raceways that overlap by a stretch (…, 2): approach, and tilt times L/2, m.

    Each is where the energy is least over its way into the outer raceway, its tilt, and its way along its
    axis against a rib that is a spring, which opens both contacts.
    """

    inner: SlicedContact
    outer: SlicedContact
    lift: float  # centrifugal force along the normal of the contacts, N
    along: float  # the same along the axis, N
    opens: float  # how far both contacts open for a way along the axis
    rib: float  # stiffness of the rib, N/m; infinite of a rigid one, against which they do not move

    @property
    def lever(self) -> float:
        """Half the length, m, by which tilts are lengths and moments are forces."""
        return 0.5 * self.inner.length

    def _pressed(self, contact: SlicedContact, overlap: Array) -> tuple[Array, Array, Array]:
        """Energy, force (…, 2) and stiffness (…, 2, 2) of one contact."""
        found = contact.pressed(overlap[..., 0], overlap[..., 1] / self.lever)
        scales = np.array([1.0, 1.0 / self.lever])
        force = np.stack([found.force, found.moment], axis=-1) * scales
        return found.energy, force, found.stiffness * scales[:, None] * scales

    def together(self, stretch: Array) -> tuple[Array, Array, Array, tuple[Array, Array]]:
        """Energy, force (…, 2), stiffness (…, 2, 2), and overlaps of inner and outer contacts (…, 2)."""
        held = math.isinf(self.rib)
        if self.lift == 0.0 and held:
            # both contacts are alike: the roller is in the middle
            half = 0.5 * stretch
            energy, force, stiffness = self._pressed(self.inner, half)
            return 2.0 * energy, force, 0.5 * stiffness, (half, half)
        ways = np.eye(3)[: 2 if held else 3]
        into_outer, out_of_inner = (
            ways[:, :2] + sign * self.opens * np.outer(ways[:, 2], [1.0, 0.0]) for sign in (-1.0, 1.0)
        )
        pulled = ways @ [self.lift, 0.0, self.along]
        spring = np.diag(ways @ [0.0, 0.0, 0.0 if held else self.rib])

        def energy_of(way: Array) -> tuple[Array, Array, Array]:
            above = self._pressed(self.inner, stretch - way @ out_of_inner)
            below = self._pressed(self.outer, way @ into_outer)
            gradient = below[1] @ into_outer.T - above[1] @ out_of_inner.T + way @ spring - pulled
            hessian = into_outer @ below[2] @ into_outer.T + out_of_inner @ above[2] @ out_of_inner.T + spring
            stored = 0.5 * ((way @ spring) * way).sum(-1) - way @ pulled
            return above[0] + below[0] + stored, gradient, hessian

        free = np.array([self.outer.approach(self.lift), 0.0])
        start = (np.maximum(0.5 * stretch, 0.0) * [1.0, 0.0] + 0.5 * free) @ ways[:, :2].T
        scale = self.lift + float(self._pressed(self.inner, 0.5 * stretch)[1].max()) or 1.0
        way, _ = least_energy(energy_of, start, scale, "balance of a roller")
        energy, _, hessian = energy_of(way)
        overlaps = stretch - way @ out_of_inner, way @ into_outer
        _, force, stiffness = self._pressed(self.inner, overlaps[0])
        ridge = 1e-12 * np.trace(hessian, axis1=-2, axis2=-1)[..., None, None] * np.eye(len(ways))
        moved = out_of_inner @ stiffness
        condensed = stiffness - np.swapaxes(moved, -1, -2) @ np.linalg.solve(hessian + ridge, moved)
        return energy, force, condensed, overlaps


def _solved(
    bearing: RollersOnRaceways,
    load: Array,
    tilt: Array | None,
    speed: float,
    angles: Array,
    tilt_stiffness: float = math.inf,
) -> LoadedRollers:
    """The inner ring in balance at each angle of the cage; tilted as it is told, or as moments tilt it.

    A shaft that gives way has a tilt where no moment acts, and a stiffness against another one, N m/rad.
    """
    told = None if tilt is None else tuple(tilt.tolist())
    return _balanced(bearing, tuple(load.tolist()), told, speed, tuple(angles.tolist()), tilt_stiffness)


@lru_cache(maxsize=64)  # of cases that are read one after the other, most have the load of another one
def _balanced(
    bearing: RollersOnRaceways,
    forces: tuple[float, ...],
    tilts: tuple[float, ...] | None,
    speed: float,
    angles: tuple[float, ...],
    tilt_stiffness: float,
) -> LoadedRollers:
    load = np.array(forces)
    tilt = None if tilts is None else np.array(tilts)
    azimuth = bearing.azimuths(np.array(angles))
    moved = _followed(bearing, azimuth)
    lift = bearing.centrifugal_force(speed) * bearing.flung_outwards(bearing.contact_angle)
    inner = bearing.inner_contact
    outer = bearing.outer_contact
    overlap = 0.5 * max(-bearing.clearance, 0.0)
    scale = max(load[0], load[2], float(np.abs(load[MOMENTS]).max()) / (0.5 * bearing.roller_length))
    scale = max(scale, inner.force(0.5 * overlap))
    rib = math.inf if bearing.rib_stiffness is None else bearing.rib_stiffness
    lift = lift if lift > TOLERANCE * scale else 0.0
    rollers = _Rollers(inner, outer, lift, bearing.flung_along * lift, bearing.pushed_along, rib)
    levers = np.array([1.0, 1.0, 1.0, rollers.lever, rollers.lever])
    moved = moved / levers  # tilts of the ring as ways at half a length of a roller
    rest = np.array([-0.5 * bearing.clearance * math.cos(bearing.contact_angle), 0.0])
    start = np.tile(_first_ways(bearing, load), (len(angles), 1))
    held = tilt is not None and math.isinf(tilt_stiffness)
    spring = 0.0
    if tilt is not None:
        start[:, MOMENTS] = tilt * levers[MOMENTS]
        tilted = rest + np.einsum("mzik,mk->mzi", moved[..., MOMENTS], start[:, MOMENTS])
        scale = max(scale, float(rollers.together(tilted)[1].max()))
        if held:
            rest = tilted
        else:
            spring = tilt_stiffness / rollers.lever**2
    free = [0, 1] + [2] * bool(math.sin(bearing.contact_angle)) + [3, 4] * (not held)
    force = load / levers
    force[2] -= bearing.flung_axially(lift)
    shaft = _Shaft(spring * np.diag([each in (3, 4) for each in free]), start[0, free])
    ring, imbalance = shaft.balance(
        rollers, moved[..., free], rest, force[free], start[:, free], max(scale, lift)
    )
    stretch = rest + np.einsum("mzik,mk->mzi", moved[..., free], ring)
    _, pulled, stiffness, overlaps = rollers.together(stretch)
    start[:, free] = ring
    slices = [
        contact.pressed(at[..., 0], at[..., 1] / rollers.lever).loads
        for contact, at in zip((inner, outer), overlaps, strict=True)
    ]
    moments = np.einsum("mzik,mzi->mk", moved, pulled)[:, MOMENTS] * levers[MOMENTS]
    whole = np.einsum("mzik,mzij,mzjl->mkl", moved, stiffness, moved) * levers[:, None] * levers
    found = azimuth, start / levers, moments, slices[0], slices[1], whole
    for each in found:
        each.setflags(write=False)
    return LoadedRollers(bearing, forces[0], forces[2], speed, *found, imbalance)


@dataclass(frozen=True)
class _Shaft:
    """A shaft that holds the ring: its stiffness against the ways that are free, and where it does not push.

    Parameters
    ----------
    stiffness : ndarray (f, f)
        Against ways of the ring, N/m; zero of those that it does not hold.
    at_ease : ndarray (f,)
        Ways of the ring at which it does not push, m; of those that it holds.
    """

    stiffness: Array
    at_ease: Array

    def balance(
        self, rollers: _Rollers, moved: Array, rest: Array, force: Array, start: Array, scale: float
    ) -> tuple[Array, float]:
        """Ways of the ring (m, f), m, at which rollers and shaft carry a force (f,), N; what is left of it.

        `moved` (m, Z, 2, f) is how rollers follow the ring, `rest` where they are without that, m.
        """

        def energy_of(ring: Array) -> tuple[Array, Array, Array]:
            energy, pulled, stiffness, _ = rollers.together(rest + np.einsum("mzik,mk->mzi", moved, ring))
            turned = (ring - self.at_ease) @ self.stiffness
            gradient = np.einsum("mzik,mzi->mk", moved, pulled) - force + turned
            hessian = np.einsum("mzik,mzij,mzjl->mkl", moved, stiffness, moved) + self.stiffness
            stored = 0.5 * (turned * (ring - self.at_ease)).sum(-1)
            return energy.sum(-1) + stored - ring @ force, gradient, hessian

        return least_energy(energy_of, start, scale, "balance of the inner ring")


def _first_ways(bearing: RollersOnRaceways, load: Array) -> Array:
    """Ways of the ring (5,), m, from which its balance is sought: through the clearance, by its load."""
    apart = max(0.5 * bearing.clearance, 0.0)
    pressed = 2.0 * bearing.inner_contact.approach(5.0 * load[FORCES].max() / bearing.rollers)
    sine = math.sin(bearing.contact_angle)
    along = (apart + pressed) * (load[0] > 0.0)
    axially = (apart + pressed) / sine if sine else 0.0
    return np.array([along, 0.0, axially, 0.0, 0.0])


def _followed(bearing: RollersOnRaceways, azimuth: Array) -> Array:
    """How approach and tilt times L/2 of rollers (…, 2) follow the inner ring (…, 2, 5).

    A tilt γ at an azimuth moves the ring axially by R γ where it is R from the axis, and outwards by −x γ
    where it is x along the axis.
    """
    cosine = math.cos(bearing.contact_angle)
    sine = math.sin(bearing.contact_angle)
    around = np.stack([np.cos(azimuth), np.sin(azimuth)], axis=-1)
    moved = np.zeros((*azimuth.shape, 2, 5))
    moved[..., 0, 0:2] = cosine * around
    moved[..., 0, 2] = sine
    moved[..., 0, 3:5] = 0.5 * bearing.pitch_diameter * sine * around
    moved[..., 1, 3:5] = -0.5 * bearing.roller_length * around
    return moved


def _doubt(found: LoadedRollers) -> None:
    """Refuse or warn of contacts that are no lines, of dents, of crownings too deep, of sharp ends."""
    of = found.bearing
    doubt_fit(of)
    by_fit, looser = pressed_by_fit(of)
    for ring, contact, slices in (
        ("inner", of.inner_contact, found.inner_slices),
        ("outer", of.outer_contact, found.outer_slices),
    ):
        peak = float(contact.pressures(slices).max())
        heaviest = float(slices.sum(axis=-1).max())
        lighter = looser if by_fit > 0.5 * heaviest else "Lower the load or the tilt"
        width = 2.0 * peak / contact.modulus
        received = f"half a width of {rounded(width, 2)} radii on the {ring} ring"
        allowed = f"at most {STEEPEST:g}, where the roller is an elastic half-space"
        require(width <= STEEPEST, "contact", received, allowed, f"{lighter}.")
        doubt_pressure(of, ring, peak, STATIC_PRESSURE, lighter)
    _doubt_crowning(found)


def _doubt_crowning(found: LoadedRollers) -> None:
    of = found.bearing
    slices = found.inner_slices[found.heaviest]
    share = np.count_nonzero(slices) / of.slices
    if 0.0 < share < LEAST_LENGTH:
        contact = of.inner_contact
        deep = rounded(float(contact.drops.max()) * 1e6)
        pressed = rounded(contact.approach(float(slices.sum())) * 1e6)
        OutOfRangeWarning.warn(
            f"Only {percent(share)} of the length of the roller that carries most, "
            f"{rounded(slices.sum(), 4)} N, touches: its crowning, {deep} µm at the outermost slice, is "
            f"deeper than an approach of {pressed} µm and the tilt bring to bear. Take a shallower crowning, "
            "less tilt, or a larger load."
        )
    if of.crowning == "logarithmic":
        return
    pressures = of.inner_contact.pressures(found.inner_slices)
    at_end = float(pressures[..., [0, -1]].max() / max(float(pressures.max()), 1e-300))
    if at_end > SHARP:
        OutOfRangeWarning.warn(
            f"The ends of {of.crowning} rollers carry {percent(at_end)} of the largest pressure: slices know "
            "no edge, where the pressure is higher. Take a logarithmic crowning, or solve the contact.",
            Grade.NOTE,
        )
