"""The wheel and the track of a case."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from asperity.kinds.wheel_on_rail.case import WheelOnRail
from asperity.kinds.wheel_on_rail.linear_reference import force_transfer, mean_square_transfer
from asperity.kinds.wheel_on_rail.tables import fitted_to, read_modes, read_receptance
from asperity.structures.modal_fit import REACH, warn_of_short_band
from asperity.structures.track import Track
from asperity.structures.wheel import Wheel


@dataclass(frozen=True, eq=False)
class Bodies:
    """What is rolled in a case."""

    wheel: Wheel
    track: Track


def bodies_of(case: WheelOnRail) -> Bodies:
    """Build wheel and track of a case."""
    return Bodies(wheel_of(case), case.track_model())


def wheel_of(case: WheelOnRail) -> Wheel:
    """Build the wheel of a case: rigid, or with the modes or the receptance that the case names."""
    section = case.wheel
    if section.modes is not None:
        return Wheel.from_modes(section.mass, section.load, *read_modes(section.modes))
    if section.receptance is not None:
        highest = case.numerics.highest_frequency
        measured = read_receptance(section.receptance)
        warn_of_short_band("wheel", measured[0], highest)
        with fitted_to(section.receptance):
            return Wheel.from_receptance(
                section.mass, section.load, *measured, highest_frequency=REACH * highest
            )
    return Wheel.rigid(section.mass, section.load)


def transfer_at(
    bodies: Bodies, stiffness: float, places: NDArray[np.float64], frequency: NDArray[np.float64]
) -> NDArray[np.complex128]:
    """Force of the linear contact per height of the texture (p, f), N/m, the wheel at rest at places (p,), m.

    Stiffness of the contact, N/m; frequencies (f,), Hz.
    """
    return force_transfer(frequency, bodies.wheel, bodies.track, stiffness, places)


def square_transfer(bodies: Bodies, stiffness: float, frequency: NDArray[np.float64]) -> NDArray[np.float64]:
    """Mean square over a bay of the linear contact force per height of the texture (f,), (N/m)².

    Stiffness of the contact, N/m; frequencies (f,), Hz.
    """
    return mean_square_transfer(frequency, bodies.wheel, bodies.track, stiffness, positions=4)
