"""What bodies roll over: beams on supports, tracks, and structures known by their modes or receptances."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from asperity.config import values
from asperity.config.content import name_of
from asperity.config.form import Section, key, optional
from asperity.config.sections import Index
from asperity.config.tables import Column, read_table
from asperity.errors import InputError, PhysicsWarning
from asperity.kinds.ball_on_beam.case import BeamCase
from asperity.structures.beam import Support
from asperity.structures.modal import ModalStructure

SENSOR_SHARES = (0.2, 0.35, 0.5, 0.65, 0.8)
"""Of the length of a structure, where its acceleration is recorded if the case says nothing."""

ModesFile = Annotated[Path | ModalStructure, values.File(held=(ModalStructure,))]
TableFile = Annotated[Path | NDArray[np.float64], values.File(columns=5)]
RECEPTANCES = (
    Column("frequency", "Hz"),
    Column("position of the response", "m"),
    Column("position of the force", "m"),
    Column("real part", "m/N"),
    Column("imaginary part", "m/N"),
)
Axis = Annotated[str, values.Choice(("x", "y", "z"))]


class BeamOnSupports(BeamCase):
    """A beam, whose ends are held by `support`, and which has further supports along it."""

    supports: tuple[values.Position, ...] | None = optional(
        ["0.4 m", "0.8 m"],
        "positions of supports beside those of the ends",
        "one span",
        "0 m to 1 km: beams lie between",
    )
    support_stiffness: Annotated[float, values.Quantity("N/m", above=0, infinite=True)] = key(
        "inf",
        "stiffness of each of these supports",
        '1 mN/m to 1e15 N/m: stiffer ones are rigid: write "inf"',
        goes_with="supports",
    )
    support_loss_factor: Annotated[float, values.Number(at_least=0, at_most=1)] = key(
        0.0, "loss factor of these supports", goes_with="supports"
    )

    @property
    def held(self) -> list[Support]:
        """All supports, those of the ends among them."""
        ends = {"simply-supported": 0.0, "clamped": math.inf}.get(self.support)
        at_ends = [] if ends is None else [Support(x, rotational_stiffness=ends) for x in (0.0, self.length)]
        stiffness, loss = self.support_stiffness, self.support_loss_factor
        return [*at_ends, *(Support(x, stiffness, loss_factor=loss) for x in self.supports or ())]

    def problems(self) -> Iterator[InputError]:
        """Sensors, and supports on the beam, in places of their own."""
        yield from super().problems()
        if self.supports is None:
            return
        if not self.supports:
            yield InputError("supports", "an empty list", "at least one position", "Remove the key.")
        ends = () if self.support == "free" else (0.0, self.length)
        places = [*ends, *self.supports]
        if len(set(places)) < len(places) or max(places, default=0.0) > self.length:
            received = ", ".join(f"{x:g} m" for x in self.supports)
            allowed = f"different positions on the beam of {self.length:g} m, none where an end is held"
            yield InputError("supports", received, allowed)
        elif len(places) < 2:
            remedy = "A beam on one support rocks: add another."
            yield InputError("supports", f"{len(places)} of a free beam", "two supports or more", remedy)


class StructureCase(Section):
    """Any structure, by its modes along the path; of a plane, its material alone."""

    file: ModesFile | None = optional(
        "guide.csv",
        "its modes: a text table, netCDF, or a universal file (.uff, .unv); or, from Python, such modes",
    )
    along: Axis | None = optional(
        "x", "direction of the path in a universal file", "the file is none", goes_with="file"
    )
    force: Axis | None = optional(
        "z", "direction of the contact force in a universal file", "the file is none", goes_with="file"
    )
    length_unit: Annotated[str, values.LengthUnit()] | None = optional(
        "mm", "unit of length of a universal file that states none", "from the file", goes_with="file"
    )
    force_unit: Annotated[str, values.Choice(("N", "kN", "mN", "lbf"))] | None = optional(
        "N", "unit of force of a universal file that states none", "from the file", goes_with="file"
    )
    damping_ratio: Annotated[float, values.Number(at_least=0, at_most=0.99)] | None = optional(
        0.01,
        "damping ratio of all modes of a universal file that states none",
        "from the file",
        goes_with="file",
    )
    nodes: tuple[Index, ...] | None = optional(
        [1, 2, 3],
        "numbers of the nodes along the path in a universal file",
        "all that have mode shapes",
        goes_with="file",
    )
    receptances: TableFile | None = optional(
        "receptances.csv",
        "its measured receptances instead, which are fitted by modes: frequency (Hz), position of the "
        "response (m), position of the force (m), real and imaginary part (m/N)",
    )
    mass: values.Mass | None = optional(
        "20 kg",
        "mass of the structure if nothing holds it and its rigid-body modes are not in the file",
        "something holds it, or the file has all modes",
        "1 mg to 100000 t: structures that are rolled over lie between",
        goes_with="file or receptances",
    )
    inertia: Annotated[float, values.Quantity("kg m^2", above=0)] | None = optional(
        "1.5 kg m^2",
        "its moment of inertia in pitch",
        "it does not pitch",
        "1e-12 kg m^2 to 1e12 kg m^2: structures that are rolled over lie between",
        goes_with="mass",
    )
    sensors: tuple[values.Position, ...] | None = optional(
        ["0.2 m", "0.5 m"],
        "positions whose acceleration is recorded",
        "at 20, 35, 50, 65 and 80 % of the length",
        "0 m to 10 km: structures are shorter",
        goes_with="file or receptances",
    )
    material: values.OwnOrNamed = key("steel", "material of its surface")

    @property
    def is_known(self) -> bool:
        """Whether there is anything that it is known by."""
        return self.file is not None or self.receptances is not None

    @property
    def model(self) -> ModalStructure:
        """The structure, if it is known."""
        return self._made[0]

    @property
    def doubts(self) -> list[Warning]:
        """What was warned of when it was read or fitted."""
        return self._made[1]

    @property
    def measured_at(self) -> NDArray[np.float64] | None:
        """Frequencies of its receptances, Hz, rising; None of modes."""
        return self._made[2]

    @cached_property
    def _made(self) -> tuple[ModalStructure, list[Warning], NDArray[np.float64] | None]:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", PhysicsWarning)
            found, lines = self._fitted() if self.file is None else (self._read(), None)
        return found, [each.message for each in caught if isinstance(each.message, Warning)], lines

    def _fitted(self) -> tuple[ModalStructure, NDArray[np.float64]]:
        """Modes that meet the receptances, and the frequencies of these."""
        from asperity.structures.receptance_fit import fit_structure, receptances_in

        assert self.receptances is not None
        rows = read_table(self.receptances, RECEPTANCES)
        at, driven, frequency, given = receptances_in(rows, name_of(self.receptances))
        fitted = fit_structure(at, driven, frequency, given, mass=self.mass, inertia=self.inertia)
        return fitted, frequency

    def _read(self) -> ModalStructure:
        """Modes of the file, with those of the rigid body."""
        assert self.file is not None
        found = self.file
        if isinstance(found, Path):
            from asperity.structures.modal_files import read_modal_structure

            found = read_modal_structure(
                found,
                along=self.along,
                force=self.force,
                length_unit=self.length_unit,
                force_unit=self.force_unit,
                damping=self.damping_ratio,
                nodes=self.nodes,
            )
        return found if self.mass is None else found.with_rigid_body(self.mass, inertia=self.inertia)

    @property
    def sensor_positions(self) -> tuple[float, ...]:
        """Positions whose acceleration is recorded, m."""
        if self.sensors is not None:
            return self.sensors
        first, last = self.model.extent
        return tuple(first + share * (last - first) for share in SENSOR_SHARES)

    def problems(self) -> Iterator[InputError]:
        """One source, which can be read, and sensors on the structure."""
        if self.file is not None and self.receptances is not None:
            yield InputError("", "both file and receptances", "one of them", "Remove one.")
        if not self.is_known:
            return
        try:
            first, last = self.model.extent
        except InputError as error:
            name = "receptances" if self.file is None else "file"
            yield InputError(name, f"{error.received} ({error.what})", error.allowed, error.remedy)
            return
        for position in self.sensors or ():
            if not first <= position <= last:
                allowed = f"positions on the structure, {first:g} to {last:g} m"
                yield InputError("sensors", f"{position:g} m", allowed)
