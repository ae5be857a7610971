"""A ball bearing by its name or its dimensions, and how it carries a load."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from asperity.arguments import ArrayLike
from asperity.reference.bearings import LISTED, listed_bearing
from asperity.structures.balls_in_grooves import BallsInGrooves

if TYPE_CHECKING:
    from asperity.structures.bearing_statics import LoadedBearing

BEARINGS: dict[str, dict[str, Any]] = {name: each.dimensions for name, each in LISTED.items()}
"""By the keywords of `BallBearing`, m and rad; `asperity.reference.bearings` says where they are printed."""
CLEARANCE = 10e-6
"""Diametral clearance of named bearings without a contact angle, m, chosen here."""


@dataclass(frozen=True)
class BallBearing(BallsInGrooves):
    """Ball bearing of one row: equal balls between two rigid grooved rings, held apart by a cage.

    Parameters
    ----------
    balls : int
        Z.
    ball_diameter, pitch_diameter : float
        D and d_m, m.
    inner_conformity, outer_conformity : float
        Radius of each groove over the ball's diameter, above 0.5.
    clearance : float, optional
        Diametral: how far the inner ring moves from side to side, m; below zero the balls are pressed. 0 if
        neither it nor the contact angle is given.
    contact_angle : float, optional
        That at which the balls touch both grooves without load, rad, instead of the clearance.
    arch_angle : float, optional
        That from the middle at which a ball touches both flanks of a groove of two arcs, rad, the same of
        both rings: a bearing of four-point contact, whose clearance is that of such balls. By default grooves
        have one arc.
    preload : float
        Constant axial force on the inner ring, as of a spring, N.
    hardness : float
        Of the rings, Pa.
    material, ball_material : Material
        Of rings and balls.
    turning : {"inner", "outer"}
        The ring that turns.

    Raises
    ------
    InputError
        If a number is out of range, the balls do not fit side by side, clearance and contact angle are both
        given, or the balls are pressed beyond the elastic range without any load.

    Notes
    -----
    Contacts are elliptic and Hertzian, with R_x of the raceways at the free contact angle. There is no film
    of lubricant, no friction, no shoulder of a groove, and rings do not bend. T. A. Harris and M. N.
    Kotzalas, Essential Concepts of Bearing Technology, 5th ed. (2007).

    Examples
    --------
    >>> from asperity import BallBearing
    >>> bearing = BallBearing.named("6205")
    >>> turning = bearing.kinematics(speed=1797 / 60, contact_angle=0.0)
    >>> f"{turning.ball_pass_outer:.1f} Hz, {turning.ball_pass_inner:.1f} Hz"
    '107.4 Hz, 162.2 Hz'
    >>> loaded = bearing.loaded(radial=100.0)
    >>> f"{loaded.inner_load.max():.0f} N, {loaded.inner_pressure.max() / 1e9:.2f} GPa"
    '68 N, 1.06 GPa'
    """

    @classmethod
    def named(cls, name: str, **others: Any) -> BallBearing:
        """A bearing by its designation, with other values for some parameters.

        Parameters
        ----------
        name : str
            As ``asperity bearing --list`` has it, where the dimensions are cited.
        **others
            Parameters, in SI.

        Returns
        -------
        BallBearing
            With grooves of 0.52 D and, where no contact angle is printed, a clearance of 10 µm unless others
            are given: chosen, not printed.
        """
        dimensions = listed_bearing(name).dimensions
        if others.get("clearance") is not None:
            dimensions.pop("contact_angle", None)
        elif others.get("contact_angle", dimensions.get("contact_angle")) is None:
            dimensions["clearance"] = CLEARANCE
        return cls(**(dimensions | others))

    def loaded(
        self,
        radial: float = 0.0,
        axial: float = 0.0,
        *,
        speed: float = 0.0,
        cage_angles: ArrayLike | None = None,
    ) -> LoadedBearing:
        """How it carries a load: of each ball its share, at each angle of the cage.

        Parameters
        ----------
        radial, axial : float
            Forces on the inner ring, N; the preload is added to the axial one.
        speed : float
            Turns per second, for the centrifugal force on the balls.
        cage_angles : array_like (m,), optional
            Angles of the first ball from the direction of the radial load, rad; by default 24 over the
            passing of one ball.

        Returns
        -------
        LoadedBearing
            Displacements, loads, contact angles, ellipses, pressures and stiffnesses.

        Raises
        ------
        InputError
            Without a load or preload, or where contacts are no longer small against the grooves.

        Warns
        -----
        HalfSpaceWarning
            Where contacts fill so much of a groove that forces are too large.
        OutOfRangeWarning
            Where pressures leave dents, or all balls are pressed at rest and one leaves the inner ring.
        """
        from asperity.structures.bearing_statics import load_distribution

        return load_distribution(self, radial, axial, speed, cage_angles)
