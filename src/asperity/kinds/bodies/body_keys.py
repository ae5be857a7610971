"""What rolls in a case of any bodies: masses, springs and dampers above their contacts."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, PlainValidator

from asperity.config.form import Section, key
from asperity.config.keys import (
    Choice,
    ChoiceOrFile,
    Damping,
    File,
    Force,
    Length,
    LengthOrInfinite,
    Level,
    Mass,
    Number,
    OwnOrNamed,
    Position,
    Quantity,
    Stiffness,
)
from asperity.config.tables import TABLE_OF_LEVELS, problems_of_table, read_levels
from asperity.errors import InputError
from asperity.kinds.wheel_on_rail.tables import read_modes, read_receptance

MOST_CONTACTS = 200
KINDS_OF_BODY = ("mass", "chain", "bogie", "carriage")
ROUGHNESSES = ("cast-iron", "composite", "disc")

Roughness = Annotated[
    str | Path | NDArray[np.float64], PlainValidator(ChoiceOrFile(ROUGHNESSES, TABLE_OF_LEVELS, columns=2))
]
TableFile = Annotated[Path | NDArray[np.float64], PlainValidator(File(columns=3))]
_LIE_BETWEEN = "bodies that roll lie between"


class BodyCase(Section):
    """What rolls: one body, or several of the same kind behind one another."""

    type: Annotated[str, BeforeValidator(Choice(KINDS_OF_BODY))] = key(
        "mass",
        "a rigid mass; a chain of masses above it; a bogie on two; or a carriage on rolling elements",
    )
    positions: tuple[Position, ...] = key(
        ["0 m"],
        "where the bodies are, by their rearmost contacts, ahead of the position of the run",
        within=("0 m", "100 km", "trains are shorter"),
    )
    radius: Length = key("25 mm", "rolling radius", within=("10 um", "10 m", _LIE_BETWEEN))
    transverse_radius: LengthOrInfinite | None = key(
        None,
        "radius across the path of what rolls",
        otherwise="the rolling radius: a ball",
        example='"inf"',
        within=("10 um", "100 km", 'beyond that it is flat: write "inf"'),
    )
    groove_radius: Length | None = key(
        None,
        "radius of the groove that it rolls in, across the path",
        otherwise="what is rolled over is flat; of a track, the head of the rail",
        example='"26 mm"',
        within=("10 um", "100 m", "grooves lie between"),
    )
    groove_width: Length | None = key(
        None,
        "width of the groove between its edges",
        otherwise="wider than the contact",
        example='"4 mm"',
        goes_with="groove_radius",
        within=("10 um", "100 m", "grooves lie between"),
    )
    raceway_radius: Length | None = key(
        None,
        "radius of a curved raceway along the path",
        otherwise="what is rolled over is straight",
        example='"50 mm"',
        within=("10 um", "1 km", "raceways lie between"),
    )
    raceway: Annotated[str, BeforeValidator(Choice(("inner", "outer")))] = key(
        "inner", "whether it rolls around the raceway, or inside it", goes_with="raceway_radius"
    )
    material: OwnOrNamed = key("steel", "material")
    mass: Mass | None = key(
        None,
        "mass on each contact: of a ball, of a wheel with its share of the axle",
        otherwise="that of a ball of this radius",
        example='"600 kg"',
        within=("1e-12 kg", "1000 t", _LIE_BETWEEN),
    )
    load: Force | None = key(
        None,
        "static force of each contact, all weights included; evened out over those of one body",
        otherwise="the weights",
        example='"50 N"',
        within=("1 nN", "1 GN", "adhesion governs smaller loads"),
    )
    masses: tuple[Mass, ...] | None = key(
        None,
        "masses above: of a chain from below; the frame of a bogie; the carriage",
        otherwise="none",
        example='["0.4 kg"]',
        within=("1e-12 kg", "1000 t", _LIE_BETWEEN),
    )
    springs: tuple[Stiffness, ...] | None = key(
        None,
        "springs under these masses; of a bogie one for each wheel, of a carriage one for each element",
        otherwise="of a carriage Hertz's stiffness at rest; else none",
        example='["1.2 MN/m"]',
        within=("1e-3 N/m", "1e15 N/m", "springs lie between"),
    )
    dampers: tuple[Damping, ...] | None = key(
        None,
        "viscous dampers beside the springs",
        otherwise="none",
        example='["10 kN s/m"]',
        within=("1e-9 N s/m", "1e12 N s/m", "dampers lie between"),
    )
    contacts: Annotated[int, BeforeValidator(Number(at_least=1, at_most=MOST_CONTACTS, whole=True))] = key(
        4, "rolling elements of a carriage", goes_with="type=carriage"
    )
    distance: Length | None = key(
        None,
        "distance of the contacts of a bogie, its wheelbase, or of a carriage",
        otherwise="none",
        example='"2.5 m"',
        within=("10 um", "100 m", "bodies are shorter"),
    )
    inertia: Annotated[float, BeforeValidator(Quantity("kg m^2", above=0))] | None = key(
        None,
        "moment of inertia of a bogie's frame, or of a carriage, in pitch",
        otherwise="that of a bar as long as the contacts are apart",
        example='"1500 kg m^2"',
        within=("1e-15 kg m^2", "1e9 kg m^2", _LIE_BETWEEN),
    )
    modes: TableFile | None = key(
        None,
        "table of the resonances of what touches, the same at each contact: frequency (Hz), damping ratio, "
        "modal mass (kg)",
        otherwise="rigid",
        example='"modes.csv"',
    )
    receptance: TableFile | None = key(
        None,
        "table of the receptance of a mass, which is fitted by modes: frequency (Hz), real and imaginary "
        "part (m/N)",
        otherwise="rigid",
        example='"receptance.csv"',
    )
    roughness: Roughness | None = key(
        None,
        "one-third-octave wavelength spectrum of what rolls, around its circumference, another texture at "
        "each contact",
        otherwise="smooth",
        example='"disc"',
    )
    roughness_level: Level = key(
        "+0 dB",
        "level added to it",
        goes_with="roughness",
        within=("-120 dB", "120 dB", "a million times is another texture"),
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
