"""What rolls in a case of any bodies: masses, springs and dampers above their contacts."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from asperity.config import values
from asperity.config.form import key, optional
from asperity.config.sections import MeasuredLine
from asperity.config.tables import TABLE_OF_LEVELS, problems_of_table, read_levels
from asperity.errors import InputError
from asperity.kinds.wheel_on_rail.wheel_keys import FlatKeys
from asperity.scenes.tables import read_modes, read_receptance

MOST_CONTACTS = 200
Number = Annotated[int, values.Number(at_least=1, at_most=MOST_CONTACTS, whole=True)]
"""Of a contact, body by body, from the rearmost of each."""
KINDS_OF_BODY = ("mass", "chain", "bogie", "carriage")
ROUGHNESSES = ("cast-iron", "composite", "disc")

Roughness = Annotated[
    str | Path | NDArray[np.float64], values.ChoiceOrFile(ROUGHNESSES, TABLE_OF_LEVELS, columns=2)
]
TableFile = Annotated[Path | NDArray[np.float64], values.File(columns=3)]
ModesFile = Annotated[Path | NDArray[np.float64], values.File(columns=3, further=3)]


class BodyCase(MeasuredLine, FlatKeys):
    """What rolls: one body, or several of the same kind behind one another."""

    type: Annotated[str, values.Choice(KINDS_OF_BODY)] = key(
        "mass", "a rigid mass; a chain of masses above it; a bogie on two; or a carriage on rolling elements"
    )
    positions: tuple[values.Position, ...] = key(
        ["0 m"],
        "where the bodies are, by their rearmost contacts, ahead of the position of the run",
        "0 m to 100 km: trains are shorter",
    )
    radius: values.Length = key("25 mm", "rolling radius", "10 um to 10 m: bodies that roll lie between")
    transverse_radius: values.LengthOrInfinite | None = optional(
        "inf",
        "radius across the path of what rolls",
        "the rolling radius: a ball",
        '10 um to 100 km: beyond that it is flat: write "inf"',
    )
    groove_radius: values.Length | None = optional(
        "26 mm",
        "radius of the groove that it rolls in, across the path",
        "what is rolled over is flat; of a track, the head of the rail",
        "10 um to 100 m: grooves lie between",
    )
    groove_width: values.Length | None = optional(
        "4 mm",
        "width of the groove between its edges",
        "wider than the contact",
        "10 um to 100 m: grooves lie between",
        goes_with="groove_radius",
    )
    raceway_radius: values.Length | None = optional(
        "50 mm",
        "radius of a curved raceway along the path",
        "what is rolled over is straight",
        "10 um to 1 km: raceways lie between",
    )
    raceway: Annotated[str, values.Choice(("inner", "outer"))] = key(
        "inner", "whether it rolls around the raceway, or inside it", goes_with="raceway_radius"
    )
    material: values.OwnOrNamed = key("steel", "material")
    mass: values.Mass | None = optional(
        "600 kg",
        "mass on each contact: of a ball, of a wheel with its share of the axle",
        "that of a ball of this radius",
        "1e-12 kg to 1000 t: bodies that roll lie between",
    )
    load: values.Force | None = optional(
        "50 N",
        "static force of each contact, all weights included; evened out over those of one body",
        "the weights",
        "1 nN to 1 GN: adhesion governs smaller loads",
    )
    masses: tuple[values.Mass, ...] | None = optional(
        ["0.4 kg"],
        "masses above: of a chain from below; the frame of a bogie; the carriage",
        "none",
        "1e-12 kg to 1000 t: bodies that roll lie between",
    )
    springs: tuple[values.Stiffness, ...] | None = optional(
        ["1.2 MN/m"],
        "springs under these masses; of a bogie one for each wheel, of a carriage one for each element",
        "of a carriage Hertz's stiffness at rest; else none",
        "1e-3 N/m to 1e15 N/m: springs lie between",
    )
    dampers: tuple[values.Damping, ...] | None = optional(
        ["10 kN s/m"],
        "viscous dampers beside the springs",
        "none",
        "1e-9 N s/m to 1e12 N s/m: dampers lie between",
    )
    contacts: Annotated[int, values.Number(at_least=1, at_most=MOST_CONTACTS, whole=True)] = key(
        4, "rolling elements of a carriage", goes_with="type=carriage"
    )
    distance: values.Length | None = optional(
        "2.5 m",
        "distance of the contacts of a bogie, its wheelbase, or of a carriage",
        "none",
        "10 um to 100 m: bodies are shorter",
    )
    inertia: Annotated[float, values.Quantity("kg m^2", above=0)] | None = optional(
        "1500 kg m^2",
        "moment of inertia of a bogie's frame, or of a carriage, in pitch",
        "that of a bar as long as the contacts are apart",
        "1e-15 kg m^2 to 1e9 kg m^2: bodies that roll lie between",
    )
    modes: ModesFile | None = optional(
        "modes.csv",
        "table of the resonances of what touches, the same at each contact: frequency (Hz), damping ratio, "
        "modal mass (kg); the sound of wheels needs three columns more, as in wheel.modes",
        "rigid",
    )
    receptance: TableFile | None = optional(
        "receptance.csv",
        "table of the receptance of a mass, which is fitted by modes: frequency (Hz), real and imaginary "
        "part (m/N)",
        "rigid",
    )
    roughness: Roughness | None = optional(
        "disc",
        "one-third-octave wavelength spectrum of what rolls, around its circumference, another texture at "
        "each contact",
        "smooth",
    )
    roughness_level: values.Level = key(
        "+0 dB",
        "level added to it",
        "-120 dB to 120 dB: a million times is another texture",
        goes_with="roughness",
    )

    line: values.LineFile | None = optional(
        "wheels.csv",
        "measured line around what rolls, once around; several side by side: one for each contact in turn",
    )
    flat_contacts: tuple[Number, ...] = key(
        (1,), "contacts whose body has the flat, by number", goes_with="flat_depth or flat_length"
    )

    @property
    def across(self) -> float:
        """Radius across the path, m."""
        return self.radius if self.transverse_radius is None else self.transverse_radius

    @property
    def contact_mass(self) -> float:
        """Mass on each contact, kg."""
        if self.mass is not None:
            return self.mass
        return float(4.0 / 3.0 * np.pi * self.radius**3 * self.material.density)

    @property
    def places(self) -> tuple[float, ...]:
        """Contacts of one body ahead of its rearmost one, m."""
        count = {"bogie": 2, "carriage": self.contacts}.get(self.type, 1)
        return tuple((self.distance or 0.0) * i for i in range(count))

    @property
    def offsets(self) -> tuple[float, ...]:
        """All contacts ahead of the position of the run, m, body by body."""
        return tuple(position + place for position in self.positions for place in self.places)

    def problems(self) -> Iterator[InputError]:
        """What each type of body needs, and contacts that are apart."""
        if not self.positions:
            yield InputError("positions", "an empty list", "at least one position", 'Take ["0 m"].')
        if len(self.offsets) > MOST_CONTACTS:
            yield InputError("positions", f"{len(self.offsets)} contacts", f"at most {MOST_CONTACTS}")
        yield from self._problems_of_type()
        yield from self.problems_of_line()
        yield from self.problems_of_flat()
        if self.roughness is not None and self.line is not None:
            yield InputError("", "both roughness and line", "one of them", "Remove one.")
        if max(self.flat_contacts, default=0) > len(self.offsets):
            received, allowed = f"{max(self.flat_contacts)}", f"numbers up to {len(self.offsets)}"
            yield InputError("flat_contacts", received, allowed)
        ordered = np.sort(self.offsets)
        if len(ordered) > 1 and np.diff(ordered).min() <= 1e-9:
            received = "two contacts in the same place"
            yield InputError("positions", received, "contacts that are apart", "Move one of them.")
        yield from problems_of_table(self, "roughness", read_levels)
        yield from problems_of_table(self, "modes", read_modes)
        yield from problems_of_table(self, "receptance", read_receptance)
        if self.receptance is not None and (self.type != "mass" or self.modes is not None):
            received = f"beside {'modes' if self.modes is not None else f'type {self.type}'}"
            yield InputError(
                "receptance", received, "that of a mass, alone", "Give modes, or the receptance."
            )

    def _problems_of_type(self) -> Iterator[InputError]:
        above = {"mass": 0, "bogie": 1, "carriage": 1}.get(self.type)
        masses = len(self.masses or ())
        if above is not None and masses != above:
            allowed = {0: "no masses above", 1: "one mass above the contacts"}[above]
            yield InputError("masses", f"{masses} of a {self.type}", allowed)
        if self.type == "chain" and not masses:
            yield InputError("masses", "none of a chain", "at least one mass above", 'As ["2500 kg"].')
        springs, dampers = len(self.springs or ()), len(self.dampers or ())
        optional = self.type == "carriage"
        if springs != masses and not (optional and springs == 0):
            yield InputError("springs", f"{springs} under {masses} masses", "one spring under each mass")
        if dampers not in (0, masses):
            yield InputError(
                "dampers", f"{dampers} beside {masses} springs", "one beside each spring, or none"
            )
        apart = len(self.places) > 1
        if apart and self.distance is None:
            yield InputError("distance", f"nothing for a {self.type}", "the distance of its contacts")
        for name in ("distance", "inertia"):
            if not apart and getattr(self, name) is not None:
                allowed = 'only of a "bogie", or of a "carriage" on several elements'
                yield InputError(name, f"of a {self.type}", allowed, "Remove the key.")
