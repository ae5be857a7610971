"""A roller bearing by its name or its dimensions, and how it carries a load."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from asperity.arguments import ArrayLike, one_of
from asperity.structures.ball_bearing import BallBearing
from asperity.structures.rollers_on_raceways import RollersOnRaceways

if TYPE_CHECKING:
    from asperity.structures.roller_statics import LoadedRollers

ROLLER_BEARINGS: dict[str, dict[str, float]] = {
    "NU205": {"rollers": 13, "roller_diameter": 7.5e-3, "roller_length": 7.8e-3, "pitch_diameter": 39e-3},
}
"""By the keywords of `RollerBearing`, m."""
PRINTED: dict[str, str] = {
    "NU205": "An inner raceway of 31.5 mm and a static load rating of 27 kN are those of SKF NU 205 ECP, as "
    "the tables of bd_warehouse have them; an outer raceway of 46.5 mm is usual; how many rollers there are, "
    "and how long they carry, is not printed, and is chosen so that ISO 76 makes this rating of them."
}
"""What of them is printed, and what is chosen."""
CLEARANCE = 20e-6
"""Diametral clearance of the named bearings, m, chosen here."""


@dataclass(frozen=True)
class RollerBearing(RollersOnRaceways):
    """Roller bearing of one row: equal rollers between two rigid raceways, held apart by a cage.

    Parameters
    ----------
    rollers : int
        Z.
    roller_diameter, roller_length, pitch_diameter : float
        D, the effective length L, and d_m, m.
    contact_angle : float
        Of the outer raceway, rad: 0 of a cylindrical roller bearing.
    taper : float
        Angle between opposite sides of a tapered roller, rad, by which the inner raceway is at a smaller one.
    rib_stiffness : float, optional
        Of the end of a tapered roller on the rib of the inner ring, N/m; rigid by default.
    rib_height : float, optional
        How far above the inner raceway the rib touches the end of a tapered roller, m, for its friction.
    clearance : float
        Diametral: how far the inner ring moves from side to side, m; below zero the rollers are pressed.
    crowning : {"cylindrical", "circular", "partial", "logarithmic"}
        Form of the rollers, or of rollers and raceways together, see `asperity.Crowning`.
    crowning_drop : float, optional
        How far they fall back at the ends, m; by default 0.00035 D, which ISO/TS 16281 has for logarithmic
        ones.
    crowning_straight : float
        Length of the straight middle of a partial crowning, m.
    slices : int
        Into how many a roller is cut along its length, 30 or more.
    hardness : float
        Of the rings, Pa.
    material, roller_material : Material
        Of rings and rollers.
    turning : {"inner", "outer"}
        The ring that turns.

    Raises
    ------
    InputError
        If a number is out of range, the rollers do not fit side by side, or a crowning cannot be.

    Notes
    -----
    Contacts are the slices of ISO/TS 16281, see `asperity.SlicedContact`. There is no film of lubricant, no
    friction in the balance, and rings do not bend. A tapered roller is pushed along its axis by both, by
    (Q_i + Q_o) sin β with β half the taper, and the rib holds it there. As rib and inner contact together
    press the inner ring along the normal of the outer contact, a ring sees both raceways at the angle of the
    outer one, and the rib as a spring in series with them, a compliance of 4 sin² β/k. What rollers are
    thrown outwards presses them on the rib, too, and the rib the inner ring against the axial load. Speeds
    are those of cones that roll, by the angle α − β of the rollers' axes. That the rib pushes
    beside the middle of a roller's end, and so tilts it a little, is left out.

    Examples
    --------
    >>> from asperity import RollerBearing
    >>> bearing = RollerBearing.named("NU205")
    >>> turning = bearing.kinematics(speed=1800 / 60)
    >>> f"{turning.ball_pass_outer:.1f} Hz, {turning.ball_pass_inner:.1f} Hz"
    '157.5 Hz, 232.5 Hz'
    >>> loaded = bearing.loaded(radial=2000.0)
    >>> f"{loaded.inner_load.max():.0f} N, {loaded.inner_pressure.max() / 1e9:.2f} GPa"
    '889 N, 1.41 GPa'
    """

    @classmethod
    def named(cls, name: str, **others: Any) -> RollerBearing:
        """A bearing by its designation, with other values for some parameters.

        Parameters
        ----------
        name : str
            As in `ROLLER_BEARINGS`, where it is said what is printed of it.
        **others
            Parameters, in SI.

        Returns
        -------
        RollerBearing
            With a clearance of 20 µm and the profile of ISO/TS 16281 unless others are given.
        """
        dimensions: dict[str, Any] = dict(ROLLER_BEARINGS[one_of("bearing", name, ROLLER_BEARINGS)])
        return cls(**(dimensions | {"clearance": CLEARANCE} | others))

    def loaded(
        self,
        radial: float = 0.0,
        axial: float = 0.0,
        *,
        tilt: ArrayLike | None = None,
        moment: ArrayLike | None = None,
        tilt_stiffness: float | None = None,
        speed: float = 0.0,
        cage_angles: ArrayLike | None = None,
    ) -> LoadedRollers:
        """How it carries a load: of each roller its share and how that lies along it, at each cage angle.

        Parameters
        ----------
        radial, axial : float
            Forces on the inner ring, N; rollers with a contact angle of 0 carry no axial one.
        tilt : float or (float, float), optional
            Of the inner ring, rad, in the plane of the radial load and across it: a positive one moves it
            axially where the load points, and presses the ends of those rollers that lie back along the axis.
            0 by default; the moments are found.
        moment : float or (float, float), optional
            On the inner ring in these planes, N m, instead: the tilt is found.
        tilt_stiffness : float, optional
            By which a shaft holds the inner ring at `tilt`, N m/rad: it gives way to the moment of the
            rollers, and the tilt is found. Rigid by default.
        speed : float
            Turns per second, for the centrifugal force on the rollers.
        cage_angles : array_like (m,), optional
            Angles of the first roller from the direction of the radial load, rad; by default 24 over the
            passing of one roller.

        Returns
        -------
        LoadedRollers
            Displacements, loads, their distribution along the rollers, pressures, stiffnesses.

        Raises
        ------
        InputError
            Without a load, with an axial one that nothing carries, or one under which contacts are no lines.

        Warns
        -----
        OutOfRangeWarning
            Where pressures leave dents, a crowning is deeper than the approach brings to bear, or an end that
            is sharp carries.
        """
        from asperity.structures.roller_statics import roller_load_distribution

        return roller_load_distribution(
            self, radial, axial, tilt=tilt, moment=moment, tilt_stiffness=tilt_stiffness, speed=speed,
            cage_angles=cage_angles,
        )  # fmt: skip


AnyBearing = BallBearing | RollerBearing
"""What turns on balls or on rollers."""
