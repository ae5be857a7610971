"""A finite beam that is rolled over."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.errors import InputError
from asperity.kernels.modal import modal_coefficients
from asperity.rolling.path import Path
from asperity.rolling.stability import RESOLVED
from asperity.structures.beam import Beam
from asperity.structures.modal import Modal

CHUNK = 2048  # steps whose mode shapes are held at once
ON_SUPPORT = 1e-9
"""Distance to a support that counts as none, m."""
PLACES = 256
"""Positions at which mode shapes are looked at."""


@dataclass(frozen=True)
class RolledBeam:
    """A beam behind the protocol of `asperity.rolling.bodies.RolledOver`."""

    beam: Beam

    def laid(self, path: Path, load: float) -> BeamSide:
        """Let it carry the load as if it had rolled on it for long."""
        refuse_off_the_beam(self.beam, path)
        return BeamSide(self.beam, path, load)

    def alternating_compliance(self, path: Path) -> float:
        """Least of all places on the path, m/N."""
        shapes = self.beam.shapes(path.positions[:: max(1, len(path.positions) // PLACES)])[0]
        return modal_alternating_compliance(beam_step(self.beam, path.time_step), shapes)


def most_compliance(structure: Modal, paths: Sequence[Path]) -> float:
    """Largest static compliance of a structure on some paths, m/N; infinite if nothing holds it."""
    natural = 2.0 * np.pi * structure.natural_frequencies
    if not (natural > 0.0).all():
        return float("inf")
    every = (path.positions[:: max(1, len(path.positions) // PLACES)] for path in paths)
    return float(max(((structure.shapes(at)[0] / natural) ** 2).sum(axis=1).max() for at in every))


class BeamSide:
    """A beam in contact, exact mode by mode: q'' + 2ζω q' + ω² q = φ F, displacement Σ φ q."""

    def __init__(self, beam: Beam, path: Path, load: float) -> None:
        self.path, self.shapes = path, ShapesAlong(beam, path)
        self.step = beam_step(beam, path.time_step)
        stiffness = (2.0 * np.pi * beam.natural_frequencies) ** 2
        (shape,), (slope,) = under = beam.shapes(path.positions[0])
        self.modes, self.rates = carried(stiffness, *under, np.array([load]), path.speed)
        self.displacement = float(shape @ self.modes)
        self.velocity = float(shape @ self.rates + path.speed * (slope @ self.modes))

    def free(self, step: int, before: float) -> float:
        """Displacement at the end of a step without the force there, m."""
        a, (shape, ahead, _) = self.step, self.shapes.around(step)
        return float(ahead @ (a[0] * self.modes + a[1] * self.rates + a[2] * (shape * before)))

    def compliance(self, step: int) -> float:
        """Of the force at the end of a step, m/N."""
        return float(self.shapes.around(step)[1] ** 2 @ self.step[3])

    def complete(self, step: int, before: float, force: float) -> None:
        """Advance over a step; the velocity holds what the contact climbs on the bent beam."""
        a, (shape, ahead, slope) = self.step, self.shapes.around(step)
        parts = np.array([self.modes, self.rates, shape * before, ahead * force])
        self.modes, self.rates = (a[:4] * parts).sum(axis=0), (a[4:] * parts).sum(axis=0)
        self.displacement = float(ahead @ self.modes)
        self.velocity = float(ahead @ self.rates + self.path.speed * (slope @ self.modes))

    def state(self) -> dict[str, NDArray[Any]]:
        """Modal coordinates and their rates, and what they are at the contact."""
        contact = np.array([self.displacement, self.velocity])
        return {"modes": self.modes, "rates": self.rates, "contact": contact}

    def restore(self, state: dict[str, NDArray[Any]]) -> None:
        """Go on from there."""
        self.modes, self.rates = state["modes"], state["rates"]
        self.displacement, self.velocity = (float(value) for value in state["contact"])


class ShapesAlong:
    """Mode shapes under the contact, in chunks whose bounds do not depend on where a run was taken up.

    A resumed run thus equals an uninterrupted one bit by bit.
    """

    def __init__(self, beam: Beam, path: Path) -> None:
        self.beam, self.path, self.offset = beam, path, -1
        self.shapes = self.slopes = np.zeros((0, 0))

    def end_of_chunk(self, step: int) -> int:
        """Make ready the chunk of the step that ends at `step`; the last one in it."""
        offset = (step - 1) // CHUNK * CHUNK
        end = min(offset + CHUNK, self.path.total)
        if offset != self.offset:
            start, spacing = float(self.path.positions[offset]), self.path.speed * self.path.time_step
            self.shapes, self.slopes = self.beam.shapes_along(start, spacing, end + 1 - offset)
            self.offset = offset
        return end

    def around(self, step: int) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Shapes at start and end of a step, kg^-1/2, and slopes at its end, kg^-1/2 per metre."""
        self.end_of_chunk(step)
        row = step - self.offset
        return self.shapes[row - 1], self.shapes[row], self.slopes[row]


def carried(
    stiffness: NDArray[np.float64],
    shapes: NDArray[np.float64],
    slopes: NDArray[np.float64],
    forces: NDArray[np.float64],
    speed: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Modal displacements and rates (modes,) under constant forces (k,), N, that have long moved at a speed.

    Of ω² (modes,) and of shapes and slopes (k, modes) under the forces. Displacements are the static ones:
    what is left to ring is less by (k v/ω)² than the static displacement of a mode of wavenumber k. A force
    on a support has just come onto a structure at rest; so are modes that nothing holds.
    """
    moving = forces * (
        np.abs(shapes).max(axis=1, initial=0.0) > ON_SUPPORT * np.abs(slopes).max(axis=1, initial=0.0)
    )
    displacement, rate = (
        np.divide(push, stiffness, out=np.zeros_like(stiffness), where=stiffness > 0.0)
        for push in (forces @ shapes, speed * (moving @ slopes))
    )
    return displacement, rate


def beam_step(beam: Beam, time_step: float) -> NDArray[np.float64]:
    """Exact step of a beam's modes, (8, modes), as `asperity.kernels.modal.modal_coefficients` has it.

    Time step in s. Of modes that turn by more than RESOLVED in a step only the static answer to the force at
    its end: sampled, they would seem slow, and move the wrong way.
    """
    natural = 2.0 * np.pi * beam.natural_frequencies
    return resolved_step(natural, np.full(natural.shape, beam.damping_ratio), time_step)


def resolved_step(
    natural: NDArray[np.float64], damping_ratio: NDArray[np.float64], time_step: float
) -> NDArray[np.float64]:
    """As `beam_step`, of natural angular frequencies (modes,), rad/s, and damping ratios (modes,)."""
    coefficients = modal_coefficients(natural, damping_ratio, time_step)
    damped = natural * np.sqrt(np.maximum(1.0 - damping_ratio**2, 0.0))
    fast = damped * time_step > RESOLVED
    coefficients[:, fast] = 0.0
    coefficients[3, fast] = 1.0 / natural[fast] ** 2
    return coefficients


def modal_alternating_compliance(coefficients: NDArray[np.float64], shapes: NDArray[np.float64]) -> float:
    """Least alternating compliance of modes, m/N: of coefficients (8, modes) and shapes (places, modes)."""
    return float((shapes**2 @ alternating_of_modes(coefficients)).min())


def alternating_of_modes(coefficients: NDArray[np.float64]) -> NDArray[np.float64]:
    """Alternating compliance of each mode, of coefficients (8, ...), for a shape of one."""
    a = coefficients
    # q and q' change their sign from step to step, as the force does
    determinant = (1.0 + a[0]) * (1.0 + a[5]) - a[1] * a[4]
    return np.asarray(((a[3] - a[2]) * (1.0 + a[5]) - a[1] * (a[7] - a[6])) / determinant)


def refuse_off_the_beam(beam: Beam, path: Path) -> None:
    """Refuse a path that leaves the beam."""
    start, first, end = (float(path.positions[i]) for i in (path.settled, 0, -1))
    if not (first >= -1e-9 * beam.length and end <= beam.length * (1.0 + 1e-9)):
        longest = (beam.length - start) / path.speed
        remedy = f"From there the beam ends after {longest:.6g} s." if first >= 0.0 else "Start on the beam."
        raise InputError(
            "path (m)", f"{first:.6g} to {end:.6g}", f"0 to {beam.length:.6g}, on the beam", remedy
        )
