"""The energy balance of a run: where the work of the load went."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asperity.kernels.modal import (
    BEAM_DAMPING,
    CONTACT_WORK,
    SLOPE_WORK,
    THROUGHPUT,
    BeamMotion,
    System,
)


@dataclass(frozen=True)
class EnergyBalance:
    """Energies gained and work done since the start, J.

    The work of the load equals the sum of the others, up to what the time step leaves open: the integrals are
    taken by the trapezoidal rule from the recorded motion, the energies from the state at the end.
    """

    load: float  # work of the load on the ball
    ball: float  # kinetic energy gained by the ball
    beam: float  # kinetic and bending energy gained by the beam
    beam_damping: float  # dissipated in the beam
    contact: float  # work on the contact: stored, damped, less what the texture feeds in
    slope: float  # work against the slope of the deflected beam, given up to the drive that keeps the speed
    throughput: float  # time integral of the moduli of the powers at ball and beam

    @property
    def residual(self) -> float:
        """What the balance leaves open, relative to the throughput."""
        left = self.load - self.ball - self.beam - self.beam_damping - self.contact - self.slope
        return abs(left) / self.throughput if self.throughput > 0.0 else 0.0

    def terms(self) -> dict[str, float]:
        """The terms by their names in results, J; the first equals the sum of the others."""
        return {
            "work of the load": self.load,
            "ball kinetic": self.ball,
            "beam": self.beam,
            "beam damping": self.beam_damping,
            "contact": self.contact,
            "beam slope": self.slope,
        }


def beam_energy(system: System, motion: BeamMotion) -> float:
    """Kinetic and bending energy of the beam, J."""
    return 0.5 * float(np.sum(motion.velocity**2 + system.stiffness * motion.displacement**2))


def balance(system: System, motion: BeamMotion, first: tuple[float, float, float]) -> EnergyBalance:
    """Balance of a run; `first` holds displacement, m, and velocity, m/s, of the ball and the energy of the
    beam, J, at its start.
    """
    displacement, velocity, energy = first
    return EnergyBalance(
        load=system.load * (float(motion.ball[0]) - displacement),
        ball=0.5 * system.mass * (float(motion.ball[1]) ** 2 - velocity**2),
        beam=beam_energy(system, motion) - energy,
        beam_damping=float(motion.ledger[BEAM_DAMPING]),
        contact=float(motion.ledger[CONTACT_WORK]),
        slope=float(motion.ledger[SLOPE_WORK]),
        throughput=float(motion.ledger[THROUGHPUT]),
    )
