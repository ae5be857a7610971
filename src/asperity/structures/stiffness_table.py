"""Stiffness and damping of a bearing over load, speed and cage angle, for programs of rotors."""

import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from asperity.arguments import Array, ArrayLike, as_row, finite_array
from asperity.files import write_bytes
from asperity.structures.roller_bearing import AnyBearing
from asperity.text_files import write_csv

AXES = ("x", "y", "z")
PAIRS = tuple(f"{along}{by}" for along in AXES for by in AXES)
"""Of the columns of a matrix: force along the first, motion along the second."""
SIGNS = (
    "x and y are radial, z is axial; y is a quarter turn ahead of x in the sense in which the ring turns. "
    "k and c are of the bearing: the force on the inner ring is minus k times its displacement and minus c "
    "times its velocity, kxy that along x by a motion along y. The radial load acts on the inner ring at "
    "load_direction from x towards y, the axial one along z."
)
"""What the numbers of a table mean."""
ROUNDING = 1e-12
"""Coefficients of this share of the largest one are none."""


@dataclass(frozen=True, eq=False)
class BearingMatrices:
    """Matrices of a bearing over a radial loads, b axial loads, s speeds and, where asked for, c cage angles.

    Attributes
    ----------
    bearing : BallBearing or RollerBearing
        Whose they are; a ring on rollers is held against tilt.
    radial, axial : ndarray (a,), (b,)
        Loads on the inner ring, N.
    speed : ndarray (s,)
        Of the ring that turns, turns per second.
    cage_angle : ndarray (c,) or None
        Of the first ball from the radial load, rad; None where matrices are means while a ball passes.
    load_direction : float
        Of the radial load from x towards y, rad.
    contact_damping : float
        Of each contact along its normal, N s/m.
    stiffness : ndarray (a, b, s, c, 3, 3)
        N/m, over x, y and z; c is 1 for means.
    damping : ndarray (a, b, s, c, 3, 3)
        N s/m.
    displacement : ndarray (a, b, s, c, 3)
        Of the inner ring, m.
    """

    bearing: AnyBearing
    radial: Array
    axial: Array
    speed: Array
    cage_angle: Array | None
    load_direction: float
    contact_damping: float
    stiffness: Array
    damping: Array
    displacement: Array

    @property
    def angular_speed(self) -> Array:
        """Speeds (s,), rad/s."""
        return 2.0 * math.pi * self.speed

    def elements(self) -> Iterator[dict[str, Any]]:
        """Keywords of a ``BearingElement`` of ROSS at each load and cage angle, over `angular_speed`.

        ``frequency``, rad/s, and lists of the same length: ``kxx``, ``kxy`` … ``kyy``, ``kzz`` and the same
        of ``c``; beside them ``load``, which says of what. ROSS takes no coupling of radial and axial motion.
        """
        angles = [None] if self.cage_angle is None else self.cage_angle.tolist()
        for (a, radial), (b, axial), (n, angle) in product(
            enumerate(self.radial.tolist()), enumerate(self.axial.tolist()), enumerate(angles)
        ):
            found: dict[str, Any] = {"frequency": self.angular_speed.tolist()}
            for letter, matrices in (("k", self.stiffness), ("c", self.damping)):
                here = matrices[a, b, :, n]
                found |= {f"{letter}{pair}": here[:, *_place(pair)].tolist() for pair in ROSS}
            yield {"load": {"radial": radial, "axial": axial, "cage_angle": angle}, **found}

    def write(self, path: Path) -> Path:
        """Write the table as CSV or, by the ending .json, with its elements for ROSS; atomically."""
        if path.suffix.lower() == ".json":
            return write_bytes(path, json.dumps(self._document(), indent=1).encode())
        heading = ["radial (N)", "axial (N)", "speed (rad/s)", "cage angle (rad)"][: 3 + self._has_angles]
        heading += [f"k{pair} (N/m)" for pair in PAIRS] + [f"c{pair} (N s/m)" for pair in PAIRS]
        return write_csv(path, [*heading, *(f"displacement {axis} (m)" for axis in AXES)], self._rows())

    @property
    def _has_angles(self) -> bool:
        return self.cage_angle is not None

    def _rows(self) -> Iterator[list[float]]:
        angles = np.zeros(1) if self.cage_angle is None else self.cage_angle
        axes = (self.radial, self.axial, self.angular_speed, angles)
        for place in np.ndindex(*self.stiffness.shape[:4]):
            at = [float(axis[n]) for axis, n in zip(axes, place, strict=True)][: 3 + self._has_angles]
            matrices = (self.stiffness[place].ravel(), self.damping[place].ravel(), self.displacement[place])
            yield at + np.concatenate(matrices).tolist()

    def _document(self) -> dict[str, Any]:
        angles = None if self.cage_angle is None else self.cage_angle.tolist()
        return {
            "what": f"stiffness and damping of a {self.bearing.ELEMENT} bearing",
            "signs": SIGNS,
            "units": {
                "k": "N/m",
                "c": "N s/m",
                "frequency": "rad/s",
                "radial": "N",
                "axial": "N",
                "angle": "rad",
            },
            "axes": {
                "radial": self.radial.tolist(),
                "axial": self.axial.tolist(),
                "frequency": self.angular_speed.tolist(),
                "cage_angle": angles,
            },
            "load_direction": self.load_direction,
            "contact_damping": self.contact_damping,
            "stiffness": self.stiffness.tolist(),
            "damping": self.damping.tolist(),
            "displacement": self.displacement.tolist(),
            "elements": list(self.elements()),
        }


ROSS = ("xx", "xy", "yx", "yy", "zz")
"""Coefficients that a ``BearingElement`` has."""


def _place(pair: str) -> tuple[int, int]:
    return AXES.index(pair[0]), AXES.index(pair[1])


def _without_rounding(matrices: Array) -> Array:
    largest = np.abs(matrices).max(axis=(-1, -2), keepdims=True)
    return np.where(np.abs(matrices) > ROUNDING * largest, matrices, 0.0)


def stiffness_table(
    bearing: AnyBearing,
    radial: ArrayLike = 0.0,
    axial: ArrayLike = 0.0,
    speed: ArrayLike = 0.0,
    *,
    cage_angles: ArrayLike | None = None,
    load_direction: float = 0.0,
    contact_damping: float = 0.0,
) -> BearingMatrices:
    """Stiffness and damping matrices of a bearing at every combination of loads and speeds.

    Parameters
    ----------
    bearing : BallBearing or RollerBearing
        The bearing.
    radial, axial : array_like (a,), (b,)
        Loads on the inner ring, N.
    speed : array_like (s,)
        Of the ring that turns, turns per second, for the centrifugal force on the balls.
    cage_angles : array_like (c,), optional
        Of the first ball from the radial load, rad; by default matrices are means over 24 angles while a
        ball passes.
    load_direction : float
        Angle of the radial load from x towards y, rad.
    contact_damping : float
        Of each contact along its normal, N s/m.

    Returns
    -------
    BearingMatrices
        Matrices over x, y and z; `SIGNS` says which.

    Raises
    ------
    InputError
        Of a combination that the bearing does not carry, as its `loaded` says it.
    """
    axes = [
        finite_array(what, as_row(values), shape=(None,))
        for what, values in (("radial load (N)", radial), ("axial load (N)", axial), ("speed (1/s)", speed))
    ]
    angles = None
    if cage_angles is not None:
        angles = finite_array(
            "angles of the cage (rad)", np.atleast_1d(np.asarray(cage_angles)), shape=(None,)
        )
    cosine = math.cos(load_direction)
    sine = math.sin(load_direction)
    turn = np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])

    def at(place: Sequence[int]) -> list[Array]:
        loads = [float(axis[n]) for axis, n in zip(axes, place, strict=True)]
        found = bearing.loaded(loads[0], loads[1], speed=loads[2], cage_angles=angles)
        held = found.stiffness[:, :3, :3]  # against tilt, which rings on rollers resist
        matrices = [turn @ each @ turn.T for each in (held, found.damping(contact_damping))]
        of = [*matrices, found.displacement[:, :3] @ turn.T]
        return of if angles is not None else [each.mean(axis=0, keepdims=True) for each in of]

    sizes = tuple(axis.size for axis in axes)
    every = [at(place) for place in np.ndindex(*sizes)]
    stiffness, damping, displacement = (
        np.array(each).reshape(*sizes, *each[0].shape) for each in zip(*every, strict=True)
    )
    return BearingMatrices(
        bearing=bearing,
        radial=axes[0],
        axial=axes[1],
        speed=axes[2],
        cage_angle=angles,
        load_direction=load_direction,
        contact_damping=contact_damping,
        stiffness=_without_rounding(stiffness),
        damping=_without_rounding(damping),
        displacement=displacement,
    )
