"""Wheel and rail at a contact off the middle: receptances downwards and sideways, and the lateral force.

Forces on the rail, downwards and towards the field side, are F and T, those on the wheel −F and −T. With the
receptances α (2, 2) of both bodies, each for forces on itself, both approach each other by (α_W + α_R)(F, T),
which the springs of the contact, normal and in stick tangential, take up: A (F, T) = (z, 0) for a height z of
the texture, A = α_W + α_R + diag(1/k_N, 1/k_T). D. J. Thompson, Railway Noise and Vibration (Elsevier, 2009),
with a spring alone sideways, where that adds the damper of a contact that creeps.
"""

import numpy as np

from asperity.arguments import Array, Complex
from asperity.structures.modal import modal_answers
from asperity.structures.wheel_modes import WheelModes


def wheel_receptances(modes: WheelModes | None, mass: float, frequency: Array, place: float) -> Complex:
    """Displacement of a wheel at its contact per force there, (2, 2, f), m/N, downwards and sideways.

    A free mass, kg, in both directions, and modes, at a place, m from the running circle, positive towards
    the field side; frequencies (f,), Hz, above zero. The wheel's rigid roll is left out.
    """
    rigid = np.multiply.outer(np.eye(2), -1.0 / (mass * (2.0 * np.pi * frequency) ** 2))
    if modes is None:
        return rigid.astype(complex)
    shape = np.stack(modes.at(place))  # (2, p)
    answers = modal_answers(frequency, modes.natural_frequencies, modes.damping_ratios)
    return np.asarray(rigid + np.einsum("ap,bp,fp->abf", shape, shape, answers))


def at_springs(receptances: Complex, normal: float, tangential: float) -> Complex:
    """Both bodies' receptances (2, 2, f), and those of the springs of the contact, N/m: A, m/N."""
    springs = np.diag([1.0 / normal, 1.0 / tangential])
    return np.asarray(receptances + springs[..., None])


def lateral_force(answer: Complex) -> Complex:
    """Lateral force per vertical force (f,), T/F = −A_vl/A_ll: the lateral motion of both bodies agrees."""
    return np.asarray(-answer[1, 0] / answer[1, 1])


def vertical_change(answer: Complex) -> Complex:
    """Vertical force over that of a contact that is free sideways (f,), 1/(1 − A_vl²/(A_vv A_ll)).

    What the lateral force does to the vertical one, which a run in time leaves out.
    """
    return np.asarray(1.0 / (1.0 - answer[0, 1] * answer[1, 0] / (answer[0, 0] * answer[1, 1])))
