"""Creepage of the balls of a bearing: a ball spins on one of its raceways, and slides in both grooves."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from asperity.arguments import Array, one_of, require
from asperity.contact.groove_creepage import (
    conformal_creepage,
    contact_curvature,
    sliding_speed,
    spin_moment,
)
from asperity.structures.balls_in_grooves import BallsInGrooves
from asperity.structures.bearing_statics import LoadedBearing

Ring = Literal["inner", "outer"]
RINGS: tuple[Ring, Ring] = ("inner", "outer")


def ball_axis(bearing: BallsInGrooves, angles: tuple[Array, Array], control: Ring) -> Array:
    """Inclination of the axes of balls to that of the bearing (...), rad, as in `spin_creepage`."""
    one_of("control", control, RINGS)
    share = bearing.ball_diameter / bearing.pitch_diameter
    inner, outer = angles
    if control == "outer":
        return np.arctan2(np.sin(outer), np.cos(outer) + share)
    return np.arctan2(np.sin(inner), np.cos(inner) - share)


def spin_creepage(bearing: BallsInGrooves, angles: tuple[Array, Array], control: Ring) -> tuple[Array, Array]:
    """Spin creepages of balls of which one ring controls the axis: they do not spin on that one.

    Parameters
    ----------
    bearing : BallBearing
        Its diameters.
    angles : (ndarray, ndarray)
        Contact angles with the inner and the outer ring (...), rad.
    control : {"inner", "outer"}
        The ring on which no ball spins.

    Returns
    -------
    (ndarray, ndarray)
        Of the contacts with the inner and the outer ring (...), rad/m, without sign: turning of a ball
        against the raceway about the normal, over the speed of rolling.

    Notes
    -----
    The axis of a ball is inclined to that of the bearing by β, with γ' = D/d_m
    tan β = sin α_o/(cos α_o + γ') by outer, sin α_i/(cos α_i − γ') by inner control. Then the spin is
    φ_i = sin α_i/R_i + tan(α_i − β)/R and φ_o = sin α_o/R_o − tan(α_o − β)/R, with the distances
    R_i,o = (d_m ∓ D cos α)/2 of the contacts from the axis and the radius R of a ball. T. A. Harris and
    M. N. Kotzalas, Advanced Concepts of Bearing Technology, 5th ed. (2007), chapter 2.
    """
    on_inner, on_outer = _spins(bearing, angles, ball_axis(bearing, angles, control))
    if control == "outer":
        return np.abs(on_inner), np.where(np.isnan(on_outer), np.nan, 0.0)
    return np.where(np.isnan(on_inner), np.nan, 0.0), np.abs(on_outer)


def _spins(bearing: BallsInGrooves, angles: tuple[Array, Array], axis: Array) -> tuple[Array, Array]:
    """Spins on the inner and the outer ring of balls that turn about an axis inclined by an angle, rad/m."""
    radius = 0.5 * bearing.ball_diameter
    pitch = 0.5 * bearing.pitch_diameter
    inner, outer = angles
    on_inner = np.sin(inner) / (pitch - radius * np.cos(inner)) + np.tan(inner - axis) / radius
    on_outer = np.sin(outer) / (pitch + radius * np.cos(outer)) - np.tan(outer - axis) / radius
    return on_inner, on_outer


def flank_spin(bearing: BallsInGrooves) -> tuple[float, float]:
    """Spin creepages, rad/m, of a ball that rolls on all four flanks, on the inner and on the outer ring.

    Its axis is that of the bearing, so that it slides in the middle of no contact: the spins are
    sin α/R_i + tan α/R and tan α/R − sin α/R_o, as in `spin_creepage` with β = 0.
    """
    angle = np.array(bearing.arch_angle or 0.0)
    on_inner, on_outer = _spins(bearing, (angle, angle), np.array(0.0))
    return float(on_inner), abs(float(on_outer))


@dataclass(frozen=True, eq=False)
class BearingCreepage:
    """How balls slide on both raceways (2, m, Z), the inner one first; NaN of balls that do not touch both.

    Attributes
    ----------
    axis : ndarray (m, Z)
        Inclination of the axis of a ball to that of the bearing, rad.
    spin : ndarray
        Spin creepage, rad/m; zero on the ring that controls the axis of a ball.
    rim : ndarray
        Creepage by the groove at the rim of a contact, by which its sides lag there.
    sliding : ndarray
        ∫ p |s| dA if all of a contact slips, N: the most heat over speed and coefficient of friction.
    """

    axis: Array
    spin: Array
    rim: Array
    sliding: Array


def creepage_of(loaded: LoadedBearing) -> BearingCreepage:
    """Find how the balls of a loaded bearing slide.

    That ring controls the axis of a ball on which spinning would take the larger moment of friction
    (A. B. Jones, J. Basic Eng. 81 (1959) 1), that of the inner one by the cosine of what the angles differ.
    """
    of = loaded.bearing
    require(not of.arches, "grooves", "of two arcs", "of one arc: on two flanks a ball spins on both rings")
    angles = loaded.inner_angle, loaded.outer_angle
    loads = loaded.inner_load, loaded.outer_load
    axes = [loaded.semi_axes(ring) for ring in RINGS]
    moments = [spin_moment(load, each) for load, each in zip(loads, axes, strict=True)]
    by_outer = moments[1] * np.cos(angles[0] - angles[1]) > moments[0]
    spins = np.where(by_outer, spin_creepage(of, angles, "outer"), spin_creepage(of, angles, "inner"))
    radius = 0.5 * of.ball_diameter
    axis = np.where(by_outer, ball_axis(of, angles, "outer"), ball_axis(of, angles, "inner"))
    rims = list[Array]()
    sliding = list[Array]()
    grooves = of.inner_conformity * of.ball_diameter, of.outer_conformity * of.ball_diameter
    contacts = of.inner_contact, of.outer_contact
    for spin, groove, contact, load, each in zip(spins, grooves, contacts, loads, axes, strict=True):
        curvature = contact_curvature(radius, groove)
        rims.append(-conformal_creepage(each[1], each[1], curvature, contact.radius_x))
        sliding.append(sliding_speed(load, each, spin, curvature, contact.radius_x))
    return BearingCreepage(axis, spins, np.where(np.isnan(spins), np.nan, rims), np.array(sliding))
