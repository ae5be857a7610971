"""The scene of a case: what rolls and what it is rolled over; its linear force; and a case laid ready."""

import math
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Self

import numpy as np

from asperity.arguments import Array, ArrayLike, Complex, as_row
from asperity.case.scene import Case
from asperity.errors import InputError
from asperity.laws import Need, needs_of, spec_of
from asperity.scenarios.geometry import Geometry
from asperity.scenarios.long_cells import long_cells_fit
from asperity.scenarios.textures import Textures
from asperity.speeds import slowest
from asperity.structures.body import Body, Wheel
from asperity.structures.modal import Modal, receptances_between
from asperity.structures.track import Track
from asperity.structures.wheel_modes import WheelModes

PLACES = (0.3, 0.37, 0.45, 0.5, 0.6)
"""Places on a structure, in its lengths, over which a linear force is averaged: no mode has nodes at all."""
Receptance = Callable[[ArrayLike], Complex]
"""Displacement of a place per harmonic force there (f,), m/N, e^{+iωt}, by frequencies (f,), Hz."""
POSITIONS = 4
"""Places in half a bay of a track, which is its own mirror image, over which a linear force is averaged."""


@dataclass(frozen=True, eq=False)
class Scene:
    """Bodies on a structure."""

    over: Modal | Track | None  # None for a rigid plane
    rolling: tuple[Body, ...]  # in the order of their positions
    positions: tuple[float, ...]  # of the bodies ahead of that of the run, m
    # degrees of freedom by name, body by body, and what makes them lengths: 1, or a lever, m
    degrees: Mapping[str, float]
    wheel: Wheel | None  # what touches a rail, by itself: its mass and its modes
    modes: WheelModes | None  # its modes in the frame of the contact, where their shapes are known

    @property
    def offsets(self) -> tuple[float, ...]:
        """All contacts ahead of the position of the run, m, body by body."""
        pairs = zip(self.positions, self.rolling, strict=True)
        return tuple(float(at + place) for at, body in pairs for place in body.places)

    @property
    def loads(self) -> Array:
        """Static forces of all contacts (c,), N."""
        return np.concatenate([body.static_loads for body in self.rolling])

    def first(self, frequency: ArrayLike) -> Complex:
        """Displacement of the first contact of what rolls per force there (f,), m/N, e^{+iωt}; in Hz."""
        return self.rolling[0].receptance(frequency)[:, 0, 0]

    def receptance(self, frequency: ArrayLike, x: ArrayLike, x0: ArrayLike) -> Complex:
        """Displacement of what is rolled over at `x` (p,), m, per force at `x0`, (p, f), m/N, e^{+iωt}."""
        if isinstance(self.over, Track):
            return self.over.receptance(frequency, x, x0)
        if self.over is None:
            return np.zeros((np.size(x), np.size(frequency)), dtype=complex)
        pairs = zip(np.atleast_1d(x), np.atleast_1d(x0), strict=True)
        return np.array(receptances_between(self.over, frequency, pairs))

    def coupled_transfer(self, stiffness: float, place: float, frequency: Array, count: int) -> Complex:
        """Forces of the first contacts per height under each of them (count, count, f), N/m, e^{+iωt}.

        All at rest, the run at a place, m; frequencies (f,), Hz, above zero. What rolls on the contacts left
        out moves freely.
        """
        at = place + np.array(self.offsets)[:count]
        to = np.repeat(at, count)
        of = np.tile(at, count)
        over = self.receptance(frequency, to, of)
        answer = over.reshape(count, count, -1).transpose(2, 0, 1) + np.eye(count) / stiffness
        first = 0
        for body in self.rolling:
            within = slice(first, first + len(body.places))
            shared = min(within.stop, count) - first
            if shared > 0:
                answer[:, within, within] += body.receptance(frequency)[:, :shared, :shared]
            first = within.stop
        return np.asarray(np.moveaxis(np.linalg.inv(answer), 0, -1))

    def square_transfer(self, stiffness: float, frequency: ArrayLike) -> Array:
        """Mean square of `force_transfer` of the first contact along what is rolled over (f,), (N/m)².

        Other contacts of its body bear their static load.
        """
        return mean_square_transfer(frequency, self.first, self, stiffness, self._places)

    @property
    def _places(self) -> Array:
        if isinstance(self.over, Track):
            return self.over.places(POSITIONS)
        if self.over is None:
            return np.zeros(1)
        begin, end = self.over.extent
        return begin + (end - begin) * np.array(PLACES)


def scene_of(case: Case) -> Scene:
    """Build what rolls and what it rolls over, of a case."""
    body = case.rolling
    over = case.rolled_over
    highest = case.numerics.highest_frequency
    try:
        model = over.model(highest)
    except InputError as error:
        raise _of_modes(case, error) from None
    on_track = isinstance(model, Track)
    place, _ = case.contact_places
    one = body.model(case.upper_stiffness, highest, case.speed, case.ROLLING, place)
    degrees = body.degrees if len(body.degrees) > 1 or case.ROLLING == "body" else {case.ROLLING: 1.0}
    return Scene(
        model,
        (one,) * len(body.positions),
        body.positions,
        degrees,
        body.tread(highest, case.speed, place) if on_track else None,
        body.turning_modes(highest, case.speed) if on_track else None,
    )


def _of_modes(case: Case, error: InputError) -> InputError:
    """Error about a beam of which no mode is kept, by the key that says how many are."""
    given = getattr(case.rolled_over, "modes_up_to", None) is not None
    key = f"{case.over_name}.modes_up_to" if given else "numerics.highest_frequency"
    return (
        error.about(key, f"modes up to {error.received} Hz") if "highest frequency" in error.what else error
    )


@dataclass(frozen=True, eq=False)
class PreparedCase:
    """A case that can be computed."""

    case: Case
    scene: Scene  # what rolls over what
    shape: Geometry  # the gap of the bodies on the contact grid
    textures: Textures  # what is rolled over
    # how cells at rims count for laws that see heights, where that was chosen, and why
    cells_of_heights: str | None = None
    rims: str = ""
    # where those are covered: rms height of the samples within the contact, in approaches
    roughness: float = math.inf
    caught: tuple[warnings.WarningMessage, ...] = ()  # warnings met on the way
    seconds: dict[str, float] = field(default_factory=dict)  # wall time of each part, s
    processor: float = 0.0  # time that preparing took, s

    @property
    def rim_cells(self) -> str:
        """How cells at rims count, in words: with the laws whose contacts have others than the samples."""
        if self.cells_of_heights != "covered":
            return self.shape.cells
        covered = f"covered for {' and '.join(law for law in self.case.laws if spec_of(law).sees_heights)}"
        long = self.has_long_cells and Need.SCAN in needs_of(self.case.laws)
        return f"{covered}, two rows long where the path is scanned" if long else covered

    @property
    def cells_seen(self) -> str:
        """Kind of cells, as in `HalfSpace`, of laws that see heights."""
        return self.cells_of_heights or self.shape.cells

    @property
    def leaves_states_out(self) -> bool:
        """Whether a path is scanned at no more states than tell its forces.

        On covered cells, and on a track, which damps what forces are off by: a beam rings with it.
        """
        given = self.case.contact.approaches is not None
        return self.cells_seen == "covered" and isinstance(self.scene.over, Track) and not given

    @property
    def kinds_of_cells(self) -> tuple[str, ...]:
        """Kinds of cells, as in `HalfSpace`, on which its contacts are solved."""
        return tuple(dict.fromkeys((self.shape.cells, self.cells_seen)))

    @property
    def seeing(self) -> Self:
        """The case as laws have it that see heights: on cells that may be theirs alone."""
        if self.cells_of_heights != "covered":
            return self
        shape = self.shape.over_cells()
        return replace(self, shape=shape, textures=self.textures.over_cells(), cells_of_heights=None)

    @property
    def has_long_cells(self) -> bool:
        """Whether a path is scanned on cells that are two rows long: where such covered ones are as good.

        Not where surfaces flow, nor over flats and joints: these are finer.
        """
        if (
            self.cells_of_heights != "covered"
            or self.case.contact.hardness is not None
            or self.case.has_defect
        ):
            return False
        wave = slowest(self.case.speed) / self.case.numerics.highest_frequency
        return long_cells_fit(self.shape, self.roughness, wave)

    @property
    def scanning(self) -> Self:
        """The case as a law has it whose path is scanned."""
        if not self.has_long_cells:
            return self.seeing
        shape = self.shape.on_long_cells().over_cells()
        textures = self.textures.on_long_cells().over_cells()
        return replace(self, shape=shape, textures=textures, cells_of_heights=None)

    @property
    def chosen(self) -> dict[str, str]:
        """Keys that hold what was chosen, whatever else of the case is changed: cells at rims.

        Where some of its laws do not see heights none do, as a key holds for all laws.
        """
        kind = self.cells_of_heights
        seeing = all(spec_of(law).sees_heights for law in self.case.laws)
        return {"contact.rim_cells": kind} if kind is not None and seeing else {}


# --- the linear reference in the frequency domain: roughness moved between a wheel and a rail at rest
#
# The force is F = −h/(α_W + α_C + α_R) with the receptances of wheel, contact spring and rail, and the
# texture h positive away from contact: F = z/(α_W + α_C + α_R) of heights z. P. J. Remington, Wheel/rail
# rolling noise, I: Theoretical analysis, J. Acoust. Soc. Am. 81 (1987); D. J. Thompson, Railway Noise and
# Vibration (Elsevier, 2009).


def force_transfer(
    frequency: ArrayLike, wheel: Receptance, track: Any, stiffness: float, x: ArrayLike
) -> Complex:
    """Contact force per height of the texture, the wheel at given positions on the rail: (n, f), N/m.

    F/z = 1/(α_W + α_C + α_R), force compressive, height out of the material, e^{+iωt}; of the wheel is given
    α_W. Frequencies (f,), Hz, zero or above: at zero the force is zero, since the wheel is free. Stiffness of
    the contact at the static load, N/m, infinite for a rigid one; positions (n,), m from a sleeper.
    """
    f = as_row(frequency)
    positions = as_row(x)
    moving = f > 0.0
    transfer = np.zeros((positions.size, f.size), dtype=complex)
    carried = wheel(f[moving]) + 1.0 / stiffness
    transfer[:, moving] = 1.0 / (carried + track.receptance(f[moving], positions, positions))
    return transfer


def mean_square_transfer(
    frequency: ArrayLike, wheel: Receptance, track: Any, stiffness: float, x: ArrayLike
) -> Array:
    """Mean square over positions of the contact force per height of the texture, |F/z|², (f,), (N/m)².

    As `force_transfer`, for instance at `Track.places`.
    """
    return np.mean(np.abs(force_transfer(frequency, wheel, track, stiffness, x)) ** 2, axis=0)
