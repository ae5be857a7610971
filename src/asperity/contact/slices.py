"""A roller on its raceway as springs side by side, slices of ISO/TS 16281: force and moment under tilt."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from asperity.arguments import Array, ArrayLike, not_negative, positive, whole
from asperity.contact.crowning import Crowning
from asperity.contact.hertz import SmoothContact

ISO_STIFFNESS = 35948e6
"""Load of a steel roller between two raceways over L^(8/9) δ^(10/9), N/m²; printed as 35948, of N and mm."""
ISO_MODULUS = 207e9 / (2.0 * (1.0 - 0.3**2))
"""Contact modulus of the steel that it is for, 207 GPa and 0.3, Pa."""
OF_MODULUS = 2.0 ** (10.0 / 9.0) * ISO_STIFFNESS / ISO_MODULUS
"""The same of one contact, which gives way by half, over its modulus: Q = 0.68 E* L^(8/9) δ^(10/9)."""
EXPONENT = 10.0 / 9.0
SLICES = 41
FEWEST = 30
"""Slices that ISO/TS 16281 asks for."""
STEPS = 60
"""Of Newton's method, at most: the force over the approach is convex."""


@dataclass(frozen=True, eq=False)
class PressedSlices:
    """What the slices of rollers carry at approaches and tilts (…,).

    Attributes
    ----------
    loads : ndarray (…, n)
        Of each slice, N.
    force, moment : ndarray (…,)
        Their sum, N, and that of loads times places, N m: positive where the end at positive places carries
        more.
    energy : ndarray (…,)
        J.
    stiffness : ndarray (…, 2, 2)
        Derivatives of force and moment by approach and tilt.
    """

    loads: Array
    force: Array
    moment: Array
    energy: Array
    stiffness: Array


@dataclass(frozen=True)
class SlicedContact(SmoothContact):
    """Contact of a roller and its raceway by slices that do not know of each other.

    Parameters
    ----------
    modulus : float
        Contact modulus E*, Pa.
    radius : float
        Relative radius of curvature across the line, m, for pressures: the loads do not depend on it.
    crowning : Crowning
        Profile and length.
    slices : int
        How many, 30 at least.

    Notes
    -----
    ISO/TS 16281:2008: a slice k of n carries c_L/n · δ_k^(10/9) at its overlap δ_k = δ + xₖ ψ − P(xₖ), where
    the roller is tilted by ψ. The standard has c_L = 35948 L^(8/9), of N and mm, for a steel roller between
    two raceways; here it is that of one contact, which gives way by half as much, in proportion to E*. No
    edge is in it: where a sharp end carries, the true pressure there is higher.

    Examples
    --------
    >>> from asperity import Crowning, SlicedContact
    >>> roller = SlicedContact(113.7e9, 3.25e-3, Crowning.iso(length=6e-3, diameter=7.5e-3))
    >>> straight = roller.approach(500.0)
    >>> f"{straight * 1e6:.2f} um; tilted by 2': {roller.pressed(straight, 5.8e-4).moment * 1e3:.0f} N mm"
    "3.78 um; tilted by 2': 239 N mm"
    """

    modulus: float
    radius: float
    crowning: Crowning
    slices: int = SLICES

    def __post_init__(self) -> None:
        for name in ("modulus", "radius"):
            positive(f"{name} of the roller's contact", getattr(self, name))
        allowed = f"a whole number, {FEWEST} or more, as ISO/TS 16281 asks for"
        whole("slices of a roller", self.slices, allowed, at_least=FEWEST, at_most=10_000)

    @property
    def length(self) -> float:
        """Effective length of the roller, m."""
        return self.crowning.length

    @cached_property
    def places(self) -> Array:
        """Middles of the slices from that of the roller (n,), m."""
        return self.length * ((np.arange(self.slices) + 0.5) / self.slices - 0.5)

    @cached_property
    def drops(self) -> Array:
        """How far the profile falls back at them (n,), m."""
        return self.crowning.drops(self.places)

    @property
    def stiffness_constant(self) -> float:
        """Load of all slices of a cylindrical roller over δ^(10/9), N/m^(10/9)."""
        return OF_MODULUS * self.modulus * float(self.length) ** (8.0 / 9.0)

    def pressed(self, approach: ArrayLike, tilt: ArrayLike = 0.0) -> PressedSlices:
        """What the slices carry.

        Parameters
        ----------
        approach, tilt : array_like (…,)
            Of the middle, m, and angle by which the end at positive places comes nearer, rad.

        Returns
        -------
        PressedSlices
        """
        delta, psi = np.broadcast_arrays(np.asarray(approach, dtype=float), np.asarray(tilt, dtype=float))
        places = self.places
        overlap = np.maximum(delta[..., None] + psi[..., None] * places - self.drops, 0.0)
        constant = self.stiffness_constant / self.slices
        root = overlap ** (EXPONENT - 1.0)
        loads = constant * root * overlap
        slope = constant * EXPONENT * np.where(overlap > 0.0, root, 0.0)
        powers = np.stack([slope.sum(-1), slope @ places, slope @ places**2], axis=-1)
        return PressedSlices(
            loads,
            loads.sum(-1),
            loads @ places,
            (loads * overlap).sum(-1) / (EXPONENT + 1.0),
            powers[..., [[0, 1], [1, 2]]],
        )

    def force(self, approach: float) -> float:
        """Force without tilt at an approach, N (zero while apart).

        Parameters
        ----------
        approach : float
            m.

        Returns
        -------
        float
            N.
        """
        return float(self.pressed(approach).force)

    def approach(self, force: float, tilt: float = 0.0) -> float:
        """Approach of the middle under a force, m.

        Parameters
        ----------
        force : float
            N.
        tilt : float
            As of `pressed`, rad.

        Returns
        -------
        float
            m.
        """
        force = not_negative("force (N)", force)
        if force == 0.0 and tilt == 0.0:
            return 0.0
        touch = float((self.drops - tilt * self.places).min())
        way = (force / self.stiffness_constant) ** (1.0 / EXPONENT)
        # from above, where Newton's steps on a convex force do not overshoot
        while self.pressed(touch + way, tilt).force < force:
            way *= 2.0
        high = touch + way
        for _ in range(STEPS if force else 0):
            found = self.pressed(high, tilt)
            step = (float(found.force) - force) / float(found.stiffness[0, 0])
            high -= step
            if abs(step) <= 1e-14 * abs(high):
                break
        return high

    def tangent_stiffness(self, approach: float) -> float:
        """dF/dδ without tilt at an approach, N/m.

        Parameters
        ----------
        approach : float
            m.

        Returns
        -------
        float
            N/m; zero while apart.
        """
        return float(self.pressed(approach).stiffness[0, 0])

    def semi_axes(self, approach: float) -> tuple[float, float]:
        """Half width of the contact and half the length that touches, without tilt at an approach, m.

        Parameters
        ----------
        approach : float
            m.

        Returns
        -------
        along, across : float
            Along the path b = 2pR/E* of the largest pressure, and across it, m; zero while apart.
        """
        touching = np.count_nonzero(self.pressed(approach).loads) / self.slices
        half_width = 2.0 * self.peak_pressure(approach) * self.radius / self.modulus
        return half_width, 0.5 * self.length * touching

    def pressures(self, loads: ArrayLike) -> Array:
        """Pressures of Hertz on the middle line of slices.

        Parameters
        ----------
        loads : array_like (…, n)
            Of the slices, N.

        Returns
        -------
        ndarray (…, n)
            √(qE*/πRw) of slices of the width w, Pa.
        """
        width = self.length / self.slices
        per_width = np.asarray(loads, dtype=float) * self.modulus / (math.pi * self.radius * width)
        return np.sqrt(per_width)

    def peak_pressure(self, approach: float) -> float:
        """Largest pressure without tilt at an approach, Pa.

        Parameters
        ----------
        approach : float
            m.

        Returns
        -------
        float
            Pa; zero while apart.
        """
        return float(self.pressures(self.pressed(approach).loads).max())
