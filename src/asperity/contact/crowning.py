"""How far the profile of a roller falls back towards its ends: straight, circular, partly, logarithmic."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from asperity.arguments import Array, ArrayLike, finite_array, not_negative, one_of, positive, require
from asperity.contact.line import LineContact
from asperity.written_numbers import rounded

Form = Literal["cylindrical", "circular", "partial", "logarithmic"]
FORMS: tuple[Form, ...] = get_args(Form)
"""Forms of a profile."""
OF_DIAMETER = 0.00035
"""Drop of the logarithmic profile of ISO/TS 16281 over the diameter of the roller."""


@dataclass(frozen=True)
class Crowning:
    """Profile of a roller, or of a roller and its raceway together, along its length.

    Parameters
    ----------
    form : {"cylindrical", "circular", "partial", "logarithmic"}
        Straight; one arc from end to end; straight in the middle, with arcs that begin there without a kink;
        or a logarithm.
    length : float
        Effective length L of the roller, m.
    drop : float
        How far the profile falls back at the ends, m; of a logarithmic one, whose ends fall back without
        limit, what its logarithm is multiplied with. 0 of a cylindrical one.
    straight : float
        Length of the straight middle of a partial one, m.

    Raises
    ------
    InputError
        If a number is out of range, or one is given that the form has not.

    Notes
    -----
    Logarithmic: P(x) = drop · ln 1/(1 − (2x/L)²), G. Lundberg, Forsch. Ing.-Wes. 10 (1939) 201.

    Examples
    --------
    >>> from asperity import Crowning
    >>> profile = Crowning.iso(length=6e-3, diameter=7.5e-3)
    >>> [f"{each * 1e6:.2f} um" for each in profile.drops([1.5e-3, 2.9e-3])]
    ['0.76 um', '7.15 um']
    """

    form: Form
    length: float
    drop: float = 0.0
    straight: float = 0.0

    def __post_init__(self) -> None:
        one_of("form of the crowning", self.form, FORMS)
        length = positive("length of the roller (m)", self.length)
        drop = not_negative("drop of the crowning (m)", self.drop)
        straight = not_negative("straight middle of the crowning (m)", self.straight)
        crowned = self.form != "cylindrical"
        received = f"{rounded(drop * 1e6, 4)} µm"
        allowed = "more than 0 of a crowned roller" if crowned else "0 of a cylindrical roller"
        require((drop > 0.0) == crowned, "drop of the crowning", received, allowed)
        most = 0.1 * length
        allowed = f"at most {rounded(most * 1e6)} µm, a tenth of the length"
        require(drop <= most, "drop of the crowning", received, allowed, "Is the unit right?")
        received = f"{rounded(straight * 1e3, 4)} mm"
        allowed = f"less than the length, {rounded(length * 1e3, 4)} mm, of a partial crowning, else 0"
        fits = straight < length if self.form == "partial" else straight == 0.0
        require(fits, "straight middle of the crowning", received, allowed)

    @classmethod
    def iso(cls, length: float, diameter: float) -> Crowning:
        """The logarithmic profile of ISO/TS 16281 for rollers up to 2.5 diameters long.

        Parameters
        ----------
        length, diameter : float
            Of the roller, m.

        Returns
        -------
        Crowning
            P(x) = 0.00035 D ln 1/(1 − (2x/L)²). It is that of `lundberg` for a pressure of 3 GPa on a plane.
        """
        return cls("logarithmic", length, OF_DIAMETER * positive("diameter of the roller (m)", diameter))

    @classmethod
    def lundberg(cls, contact: LineContact, force: float) -> Crowning:
        """The profile by which the pressure is alike along the line under a force.

        Parameters
        ----------
        contact : LineContact
            Of roller and raceway.
        force : float
            N.

        Returns
        -------
        Crowning
            P(x) = F/(πE*L) ln 1/(1 − (2x/L)²).
        """
        drop = positive("force (N)", force) / (math.pi * contact.modulus * contact.length)
        return cls("logarithmic", contact.length, drop)

    def drops(self, places: ArrayLike) -> Array:
        """How far the profile falls back at places along the roller.

        Parameters
        ----------
        places : array_like (n,)
            From the middle, m; within the length.

        Returns
        -------
        ndarray (n,)
            m, zero in the middle; infinite at the ends of a logarithmic one.
        """
        half = 0.5 * self.length
        x = np.abs(finite_array("places along the roller (m)", places, shape=(None,)))
        beyond = float(x.max(initial=0.0))
        allowed = f"at most half its length, {rounded(half * 1e3, 4)} mm"
        received = f"{rounded(beyond * 1e3, 4)} mm from the middle"
        require(beyond <= half * (1.0 + 1e-9), "places along the roller", received, allowed)
        if self.form == "cylindrical":
            return np.zeros_like(x)
        if self.form == "logarithmic":
            with np.errstate(divide="ignore"):
                return self.drop * -np.log1p(-np.minimum((x / half) ** 2, 1.0))
        curved = half - 0.5 * self.straight
        radius = 0.5 * (curved**2 + self.drop**2) / self.drop
        along = np.clip(x - 0.5 * self.straight, 0.0, curved)
        # R − √(R² − x²), without taking near numbers from each other
        return along**2 / (radius + np.sqrt(radius**2 - along**2))
