"""The energy balance of bodies on several contacts: where the work of the loads went."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Ledger:
    """Energies gained and work done since the start, J, in run-in and run.

    The work of the loads equals the sum of the others, up to what the time step leaves open: the integrals
    are taken by the trapezoidal rule from the motion, the energies from the states at start and end. On a
    rail, of which displacements alone are known, `contact` holds what goes into contacts and rail together,
    and the terms of the structure are zero.
    """

    loads: float  # work of the constant forces that press the bodies down
    bodies: float  # kinetic and elastic energy gained by the bodies
    body_damping: float  # dissipated in their dampers and modes
    structure: float  # kinetic and elastic energy gained by what is rolled over
    structure_damping: float  # dissipated there
    contact: float  # work on the contacts: stored, damped, less what textures feed in
    slope: float  # work against the slope of the bent structure, given up to the drive that keeps the speed
    contact_damping: float  # the part of `contact` that their dampers took
    throughput: float  # time integral of the moduli of the powers at both sides of all contacts

    @property
    def residual(self) -> float:
        """What the balance leaves open, relative to the throughput."""
        gained = self.bodies + self.body_damping + self.structure + self.structure_damping
        left = self.loads - gained - self.contact - self.slope
        return abs(left) / self.throughput if self.throughput > 0.0 else 0.0

    def shares(self) -> dict[str, float]:
        """The terms by their names in results, J; the first equals the sum of the others."""
        return {
            "work of the loads": self.loads,
            "bodies": self.bodies,
            "damping of the bodies": self.body_damping,
            "structure": self.structure,
            "damping of the structure": self.structure_damping,
            "contacts": self.contact,
            "slope of the structure": self.slope,
        }
