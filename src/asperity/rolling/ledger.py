"""Where the work of the loads went in a run, and what its balance leaves open."""

from __future__ import annotations

from dataclasses import dataclass

from asperity.kernels import stepping
from asperity.rolling import steps
from asperity.rolling.stepper import Stepper


@dataclass(frozen=True)
class Ledger:
    """Energies gained and work done since the start, J, in run-in and run.

    The work of the loads, the constant forces that press the bodies down, equals the sum of kinetic and
    elastic energy gained by bodies and structure, of what their damping dissipated, of the work on the
    contacts (stored, damped, less what textures feed in), and of that against the slope of the bent
    structure, given up to the drive that keeps the speed; up to what the time step leaves open: the integrals
    are taken by the trapezoidal rule from the motion, the energies from the states at start and end. Of a
    rail displacements alone are known: its contacts hold what goes into contacts and rail together, and the
    terms of the structure are those of other structures.
    """

    shares: dict[str, float]  # by their names in results; the first equals the sum of the others
    contact_damping: float  # what the dampers of the contacts took of their share
    throughput: float  # time integral of the moduli of the powers at both sides of all contacts

    @property
    def of_nothing(self) -> Ledger:
        """The same where nothing was gained or done."""
        return Ledger(dict.fromkeys(self.shares, 0.0), 0.0, 0.0)

    @property
    def residual(self) -> float:
        """What the balance leaves open, relative to the throughput."""
        loads, *others = self.shares.values()
        return abs(loads - sum(others)) / self.throughput if self.throughput > 0.0 else 0.0


def ledger_of(stepper: Stepper) -> Ledger:
    """Balance of a run."""
    both = zip(stepper.energies(), stepper.energies_at_start, strict=True)
    structure, bodies, loads = (now - then for now, then in both)
    ledger = stepper.motion.ledger.tolist()
    shares = {
        "work of the loads": -loads,
        "bodies": bodies,
        "damping of the bodies": ledger[stepping.BODY_DAMPING] + _missed_of_dampers(stepper),
        "structure": structure,
        "damping of the structure": ledger[stepping.OVER_DAMPING],
        "contacts": ledger[stepping.CONTACT_WORK],
        "slope of the structure": ledger[stepping.SLOPE_WORK],
    }
    return Ledger(shares, ledger[stepping.CONTACT_DAMPING], ledger[stepping.THROUGHPUT])


def _missed_of_dampers(stepper: Stepper) -> float:
    """Energy, J, that stiff dampers of bodies took beyond what the ledger has of them."""
    h = stepper.course.time_step
    of = stepper.system.body
    record = stepper.record
    missed = 0.0
    for k, (body, core, rates) in enumerate(
        zip(stepper.course.bodies, record.core, stepper.started, strict=True)
    ):
        if steps.stiff_dampers(body, h):
            count = len(body.mass)
            force = record.contact_force[of == k]
            missed += steps.missed_by_powers(body, h, core[:count], rates[:count], force)
    return missed
