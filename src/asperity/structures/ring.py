"""Rings as harmonics around their circumference: rigid on springs, bending, seen at a moving angle."""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from asperity.arguments import Array, ArrayLike, not_negative, one_of, positive, real, require, whole
from asperity.kernels.curves import STRIDE
from asperity.structures.modal import Modal, turned_on
from asperity.written_numbers import rounded

Direction = Literal["radial", "axial"]


@dataclass(frozen=True, eq=False)
class Ring(Modal):
    """Modes of a ring: at an angle ψ it moves by a cos(nψ − β) q radially outwards, b cos(nψ − β) q axially.

    Each mode obeys q″ + 2ζω q′ + ω² q = Σ φ F of the forces on it, as those of `asperity.structures.modal`.

    Parameters
    ----------
    frequencies, damping : ndarray (m,)
        Undamped, Hz, 0 where nothing holds it; damping ratios.
    lobes, phases : ndarray (m,)
        n, and β, rad.
    radial, axial : ndarray (m,)
        a and b, mass-normalised, kg^(−1/2).
    contact_angle : float
        α, rad: contacts act along n(ψ), radially with cos α and axially with sin α.
    """

    frequencies: Array
    damping: Array
    lobes: Array
    phases: Array
    radial: Array
    axial: Array
    contact_angle: float = 0.0

    @classmethod
    def rigid(
        cls,
        mass: float,
        contact_angle: float = 0.0,
        *,
        radial_stiffness: float = 0.0,
        axial_stiffness: float = 0.0,
        damping_ratio: float = 0.0,
    ) -> "Ring":
        """A rigid ring that moves along the radial load, across it, and axially if contacts do.

        Parameters
        ----------
        mass : float
            With all that it carries, kg.
        contact_angle : float
            Rad.
        radial_stiffness, axial_stiffness : float
            Of the shaft or housing that holds it, N/m; 0 where nothing does.
        damping_ratio : float
            Of the ring on these springs.

        Returns
        -------
        Ring
            With two modes, or three; lobes 1, 1 and 0.
        """
        size = positive("mass of a ring (kg)", mass) ** -0.5
        radial = not_negative("radial stiffness of a ring (N/m)", radial_stiffness)
        axial = not_negative("axial stiffness of a ring (N/m)", axial_stiffness)
        ratio = real("damping_ratio", damping_ratio, "0 and more, below 1", at_least=0.0, below=1.0)
        modes = (
            (radial, 1.0, 0.0, size, 0.0),
            (radial, 1.0, 0.5 * math.pi, size, 0.0),
            (axial, 0.0, 0.0, 0.0, size),
        )
        stiffness, lobes, phases, moved, along = np.array(modes[: 3 if contact_angle else 2]).T
        frequencies = np.sqrt(stiffness / mass) / (2.0 * math.pi)
        return cls(frequencies, np.full(len(lobes), ratio), lobes, phases, moved, along, contact_angle)

    @classmethod
    def bending(
        cls,
        mass: float,
        radius: float,
        bending_stiffness: float,
        contact_angle: float = 0.0,
        *,
        most_lobes: int,
        damping_ratio: float,
    ) -> "Ring":
        """Lobes cos nψ and sin nψ of a free thin ring that bends in its plane without stretching.

        ω_n² = n² (n² − 1)²/(n² + 1) EI/(ρA R⁴), and the mass of each mode is half of the ring's times
        1 + 1/n²: A. E. H. Love, A Treatise on the Mathematical Theory of Elasticity, 4th ed. (1927), § 293.
        Valid while the ring is thin and a lobe much longer than it is thick.

        Parameters
        ----------
        mass, radius : float
            Of the ring alone, kg, and its mean radius, m.
        bending_stiffness : float
            EI against bending in its plane, N m².
        contact_angle : float
            Rad.
        most_lobes : int
            Largest n, from 2 on.
        damping_ratio : float
            Of each mode.

        Returns
        -------
        Ring
            Two modes for each number of lobes, in the frame of the ring.
        """
        positive("mass of a ring (kg)", mass)
        stiffness = positive("bending stiffness of a ring (N m^2)", bending_stiffness)
        most = whole("most lobes of a ring", most_lobes, "a whole number, 2 or more", at_least=2)
        n = np.repeat(np.arange(2.0, most + 1.0), 2)
        per_length = mass / (2.0 * math.pi * positive("radius of a ring (m)", radius))
        squares = n**2 * (n**2 - 1.0) ** 2 / (n**2 + 1.0) * stiffness / (per_length * radius**4)
        ratio = real("damping_ratio", damping_ratio, "0 and more, below 1", at_least=0.0, below=1.0)
        return cls(
            np.sqrt(squares) / (2.0 * math.pi),
            np.full(n.size, ratio),
            n,
            np.tile([0.0, 0.5 * math.pi], n.size // 2),
            (0.5 * mass * (1.0 + n**-2)) ** -0.5,
            np.zeros(n.size),
            contact_angle,
        )

    @property
    def natural_frequencies(self) -> Array:
        """Undamped natural frequencies (m,), Hz."""
        return self.frequencies

    @property
    def damping_ratios(self) -> Array:
        """Damping ratios (m,)."""
        return self.damping

    @property
    def extent(self) -> tuple[float, float]:
        """All angles, rad: a ring is closed."""
        return -math.inf, math.inf

    def shapes(self, x: ArrayLike) -> tuple[Array, Array]:
        """Mode shapes along the contacts' normal, outwards, and their slopes.

        Parameters
        ----------
        x : array_like (n,)
            Angles, rad.

        Returns
        -------
        shapes, slopes : ndarray (n, m)
            kg^(−1/2), and per radian.
        """
        angle = np.multiply.outer(np.asarray(x, dtype=float), self.lobes) - self.phases
        size = math.cos(self.contact_angle) * self.radial + math.sin(self.contact_angle) * self.axial
        return size * np.cos(angle), -self.lobes * size * np.sin(angle)

    def shapes_along(self, start: float, spacing: float, count: int) -> tuple[Array, Array]:
        """As `shapes`, at so many angles that are equally spaced, to rounding and many times faster."""
        exact = self.shapes(start + spacing * np.arange(0, count, STRIDE))
        return turned_on(*exact, self.lobes, spacing, count)

    def towards(self, angle: float, direction: Direction = "radial") -> Array:
        """Motion of a place for each mode (m,), kg^(−1/2): outwards at an angle, rad, or axially."""
        one_of("direction", direction, ("radial", "axial"))
        size = self.radial if direction == "radial" else self.axial
        return size * np.cos(self.lobes * angle - self.phases)

    def pressed(self, radial: float, axial: float = 0.0) -> Array:
        """Constant force on each mode (m,) of forces along ψ = 0 and along the axis, N."""
        held = axial == 0.0 or bool(np.any(self.axial))
        require(held, "axial load (N)", f"{axial:g}", "0 on a ring whose contacts carry none")
        along = self.lobes == 1.0, self.lobes == 0.0
        forces = np.where(along[0], radial, 0.0) * self.towards(0.0)
        return forces + np.where(along[1], axial, 0.0) * self.axial


CLOSED = 1e-6
"""Share of the largest shape by which the ends of modes around a circle may differ."""


@dataclass(frozen=True, eq=False)
class Around(Modal):
    """Modes around a circle, as of a housing, known at angles from 0 to 2π: computed or measured.

    Parameters
    ----------
    modes : ModalStructure
        Radial displacement at positions that are angles, rad, the same at 0 and 2π.
    contact_angle : float
        α, rad, of the contacts, which see cos α of it.

    Raises
    ------
    InputError
        If the angles do not go around, or a mode differs at its ends.
    """

    modes: Modal
    contact_angle: float = 0.0

    def __post_init__(self) -> None:
        first, last = self.modes.extent
        whole_turn = abs(first) <= 1e-9 and math.isclose(last, 2.0 * math.pi, rel_tol=1e-6)
        require(whole_turn, "angles of modes (rad)", f"{first:.6g} to {last:.6g}", "0 to 2π, a whole turn")
        shapes, _ = self.modes.shapes(np.linspace(first, last, 64))
        missed = float(np.abs(shapes[-1] - shapes[0]).max())
        allowed = "the same shapes at 0 and 2π"
        closed = missed <= CLOSED * np.abs(shapes).max()
        received = f"ends {rounded(missed, 2)} apart"
        require(closed, "modes around a circle", received, allowed, "Repeat the first row at the end.")

    @property
    def natural_frequencies(self) -> Array:
        """Undamped natural frequencies (m,), Hz."""
        return self.modes.natural_frequencies

    @property
    def damping_ratios(self) -> Array:
        """Damping ratios (m,)."""
        return self.modes.damping_ratios

    @property
    def extent(self) -> tuple[float, float]:
        """All angles, rad."""
        return -math.inf, math.inf

    def shapes(self, x: ArrayLike) -> tuple[Array, Array]:
        """As of `Ring`, at angles (n,), rad."""
        found, slopes = self.modes.shapes(np.asarray(x, dtype=float) % (2.0 * math.pi))
        size = math.cos(self.contact_angle)
        return size * found, size * slopes

    def towards(self, angle: float, direction: Direction = "radial") -> Array:
        """As of `Ring`: outwards at an angle, rad; none axially."""
        radial = one_of("direction", direction, ("radial", "axial")) == "radial"
        return self.modes.shapes([angle % (2.0 * math.pi)])[0][0] * float(radial)
