"""What rolls: one body or several alike, each on one contact or several, with textures of their own."""

import math
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path

import numpy as np

from asperity.arguments import Array
from asperity.case.surface import ADDED_LEVEL, LEVEL, LEVELS, MeasuredLine
from asperity.case.tables import fitted_to, read_receptance
from asperity.case.wheel import OTHERWISE, Ringing
from asperity.errors import InputError
from asperity.parameters import (
    DAMPING,
    FORCE,
    LENGTH,
    LENGTH_OR_ZERO,
    MASS,
    STIFFNESS,
    Choice,
    Either,
    File,
    ListOf,
    MaterialOrName,
    Number,
    Quantity,
    key,
    optional,
)
from asperity.reference.cnossos import WHEEL_ROUGHNESS
from asperity.reference.materials import Material
from asperity.structures.body import GRAVITY, Body, Wheel, carriage, chain
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.units import written
from asperity.written_numbers import count_of, rounded

MOST_CONTACTS = 200
DEEPEST_FLAT = 0.01  # of the radius
CLOSE_LENGTH = 0.05  # by which a measured length may differ from that of the chord
COUNT = Number(at_least=1, at_most=MOST_CONTACTS, whole=True)
INERTIA = Quantity("kg m^2", above=0)
_BODIES = "bodies that roll lie between"
_FLAT = {"goes_with": "flat_depth or flat_length"}
PROFILE = File(held=(Profile,))
OF_SEVERAL = (
    "type", "positions", "groove_radius", "raceway_radius", "raceway", "masses", "springs", "dampers",
    "contacts", "distance", "inertia", "flat_contacts",
)  # fmt: skip
"""Keys of what rolls on several contacts, or in a groove."""


class FlatOnTread(MeasuredLine):
    """What rolls on its tread: textures around it, and a flat on it."""

    radius: float

    roughness: str | Path | Array | None = optional(
        Either(tuple(WHEEL_ROUGHNESS), LEVELS),
        "disc",
        "one-third-octave wavelength spectrum of what rolls, around its circumference, another texture at "
        "each contact",
        "smooth",
    )
    roughness_level: float = key(LEVEL, "+0 dB", "level added to it", ADDED_LEVEL, goes_with="roughness")
    line: Path | HeightMap | Profile | None = optional(
        File(held=(HeightMap, Profile)),
        "wheels.csv",
        "measured line around what rolls, once around; several side by side: across, with line_distance, or "
        "one for each contact in turn",
    )
    flat_depth: float | None = optional(
        LENGTH,
        "0.5 mm",
        "depth of a flat on the tread, which direct and table see; with flat_length alone, that of its chord",
        within="10 nm to 100 mm: flats lie between",
    )
    flat_length: float | None = optional(
        LENGTH,
        "43 mm",
        "length of the flat: that of its chord, sqrt(8 radius flat_depth); a worn one may be longer",
        within="10 um to 1 m: flats lie between",
    )
    flat_shape: str = key(Choice(("fresh", "worn")), "fresh", "a chord with sharp ends, or rounded", **_FLAT)
    flat_position: float | None = optional(
        LENGTH_OR_ZERO,
        "1 m",
        "where the flat is on the tread, along the circumference from the point that touches at start",
        "half a turn on, or half of the record if that is shorter, so that no impact is cut",
        "0 m to 100 m: wheels are smaller",
        **_FLAT,
    )
    flat_contacts: tuple[int, ...] = key(
        ListOf(COUNT), (1,), "contacts whose body has the flat, by number", **_FLAT
    )

    @property
    def circumference(self) -> float:
        """Length of the tread around what rolls, m."""
        return 2 * math.pi * self.radius

    @property
    def has_own_texture(self) -> bool:
        """Whether the tread is rough."""
        return self.roughness is not None or self.line is not None

    @property
    def flat(self) -> tuple[float, float] | None:
        """Depth and length of the flat, m; None without one."""
        depth = self.flat_depth
        length = self.flat_length
        if depth is None:
            return None if length is None else (self._chord_depth(length), length)
        chord = math.sqrt(8.0 * self.radius * depth)
        return depth, chord if length is None or self.flat_shape == "fresh" else max(length, chord)

    def _chord_depth(self, length: float) -> float:
        return length**2 / (8.0 * self.radius)

    def problems(self) -> Iterator[InputError]:
        """A flat that is small against the body, its length as its depth."""
        yield from super().problems()
        if self.flat is None:
            return
        deepest = DEEPEST_FLAT * self.radius
        if self.flat[0] > deepest:
            name = "flat_length" if self.flat_depth is None else "flat_depth"
            chord = f"{math.sqrt(8.0 * self.radius * deepest) * 1e3:.4g} mm"
            allowed = (
                f"at most {DEEPEST_FLAT:g} of the radius deep, {deepest * 1e3:.4g} mm, a chord of {chord}"
            )
            yield InputError(name, written(getattr(self, name), "m", "mm"), allowed)
        elif self.flat_depth is not None and self.flat_length is not None:
            yield from self._problem_of_both(self.flat_depth, self.flat_length)
        if self.flat_position is not None and self.flat_position >= self.circumference:
            allowed = f"less than the circumference, {self.circumference:.4g} m"
            yield InputError("flat_position", f"{self.flat_position:g} m", allowed)

    def _problem_of_both(self, depth: float, length: float) -> Iterator[InputError]:
        """A fresh flat is a chord; a worn one is at least as long, and at most as the radius."""
        chord = math.sqrt(8.0 * self.radius * depth)
        worn = self.flat_shape == "worn"
        longest = self.radius if worn else chord * (1.0 + CLOSE_LENGTH)
        if chord * (1.0 - CLOSE_LENGTH) <= length <= longest:
            return
        allowed = f"{chord * 1e3:.4g} mm, the chord sqrt(8 radius flat_depth), within {CLOSE_LENGTH:.0%}"
        remedy = f"The chord of this length is {rounded(self._chord_depth(length) * 1e3)} mm deep."
        if worn:
            allowed = f"{chord * 1e3:.4g} mm, the chord sqrt(8 radius flat_depth), to the radius"
        elif length > chord:
            remedy += ' A worn flat may be longer: flat_shape = "worn".'
        received = f"{written(length, 'm', 'mm')} beside a depth of {written(depth, 'm', 'mm')}"
        yield InputError("flat_length", received, allowed, remedy)


class Rolling(Ringing, FlatOnTread):
    """What rolls: one body, or several of the same kind behind one another."""

    ALTERNATIVES = (("roughness", "line"), ("profile", "transverse_radius"), ("modes", "receptance"))

    type: str = key(
        Choice(("mass", "chain", "bogie", "carriage")),
        "mass",
        "a rigid mass; a chain of masses above it; a bogie on two; or a carriage on rolling elements",
    )
    positions: tuple[float, ...] = key(
        ListOf(LENGTH_OR_ZERO, least=1),
        ["0 m"],
        "where the bodies are, by their rearmost contacts, ahead of the position of the run",
        "0 m to 100 km: trains are shorter",
    )
    radius: float = key(LENGTH, "25 mm", "rolling radius", f"10 um to 10 m: {_BODIES}")
    transverse_radius: float | None = optional(
        Quantity("m", above=0, infinite=True),
        "inf",
        "radius across the path of what rolls",
        "the rolling radius: a ball",
        '10 um to 100 km: beyond that it is flat: write "inf"',
    )
    profile: Path | Profile | None = optional(
        PROFILE, "tread.csv", "measured shape of what rolls across the path, instead of transverse_radius"
    )
    groove_radius: float | None = optional(
        LENGTH,
        "26 mm",
        "radius of the groove that it rolls in, across the path",
        "what is rolled over is flat; of a track, the head of the rail",
        "10 um to 100 m: grooves lie between",
    )
    raceway_radius: float | None = optional(
        LENGTH,
        "50 mm",
        "radius of a curved raceway along the path",
        "what is rolled over is straight",
        "10 um to 1 km: raceways lie between",
    )
    raceway: str = key(
        Choice(("inner", "outer")),
        "inner",
        "whether it rolls around the raceway, or inside it",
        goes_with="raceway_radius",
    )
    material: Material = key(MaterialOrName(), "steel", "material")
    mass: float | None = optional(
        MASS,
        "600 kg",
        "mass on each contact: of a ball, of a wheel with its share of the axle",
        "that of a ball of this radius",
        f"1e-12 kg to 1000 t: {_BODIES}",
    )
    load: float | None = optional(
        FORCE,
        "50 N",
        "static force of each contact, all weights included; evened out over those of one body",
        "the weights",
        "1 nN to 1 GN: adhesion governs smaller loads",
    )
    masses: tuple[float, ...] | None = optional(
        ListOf(MASS),
        ["0.4 kg"],
        "masses above: of a chain from below; the frame of a bogie; the carriage",
        "none",
        f"1e-12 kg to 1000 t: {_BODIES}",
    )
    springs: tuple[float, ...] | None = optional(
        ListOf(STIFFNESS),
        ["1.2 MN/m"],
        "springs under these masses; of a bogie one for each wheel, of a carriage one for each element",
        "of a carriage Hertz's stiffness at rest; else none",
        "1e-3 N/m to 1e15 N/m: springs lie between",
    )
    dampers: tuple[float, ...] | None = optional(
        ListOf(DAMPING),
        ["10 kN s/m"],
        "viscous dampers beside the springs",
        "none",
        "1e-9 N s/m to 1e12 N s/m: dampers lie between",
    )
    contacts: int = key(COUNT, 4, "rolling elements of a carriage", goes_with="type=carriage")
    distance: float | None = optional(
        LENGTH,
        "2.5 m",
        "distance of the contacts of a bogie, its wheelbase, or of a carriage",
        "none",
        "10 um to 100 m: bodies are shorter",
    )
    inertia: float | None = optional(
        INERTIA,
        "1500 kg m^2",
        "moment of inertia of a bogie's frame, or of a carriage, in pitch",
        "that of a bar as long as the contacts are apart",
        f"1e-15 kg m^2 to 1e9 kg m^2: {_BODIES}",
    )

    @property
    def across(self) -> float:
        """Radius across the path, m."""
        return self.radius if self.transverse_radius is None else self.transverse_radius

    @property
    def raceway_along(self) -> float:
        """Radius of what is rolled over along the path, m: positive where it bulges, infinite if straight."""
        if self.raceway_radius is None:
            return math.inf
        return self.raceway_radius if self.raceway == "inner" else -self.raceway_radius

    @cached_property
    def contact_mass(self) -> float:
        """Mass on each contact, kg."""
        if self.mass is not None:
            return self.mass
        return float(4.0 / 3.0 * np.pi * self.radius**3 * self.material.density)

    @cached_property
    def contact_load(self) -> float:
        """Static force of each contact, N: as given, or the weights, evened out."""
        above = sum(self.masses or ()) / len(self.places)
        return self.load or GRAVITY * (self.contact_mass + above)

    @property
    def upper_load(self) -> float:
        """What the contact above each element of a carriage carries, N."""
        above = self.contact_load - GRAVITY * self.contact_mass
        if not above > 0.0:
            raise InputError(
                "load", f"{rounded(above, 4)} N above each element", "a carriage that presses on them"
            )
        return above

    @cached_property
    def places(self) -> tuple[float, ...]:
        """Contacts of one body ahead of its rearmost one, m."""
        count = {"bogie": 2, "carriage": self.contacts}.get(self.type, 1)
        return tuple((self.distance or 0.0) * i for i in range(count))

    @cached_property
    def offsets(self) -> tuple[float, ...]:
        """All contacts ahead of the position of the run, m, body by body."""
        return tuple(position + place for position in self.positions for place in self.places)

    @property
    def degrees(self) -> dict[str, float]:
        """Degrees of freedom of all bodies, each from its contacts upwards: 1, or the lever of a pitch, m."""
        lever = 0.5 * self.places[-1]
        above = len(self.masses or ())
        one = {"mass on the contact": 1.0} | {f"mass {n} above": 1.0 for n in range(1, above + 1)}
        if self.type == "bogie":
            one = {"rear wheel": 1.0, "front wheel": 1.0, "frame": 1.0, "frame, pitch at its end": lever}
        if self.type == "carriage":
            one = {f"element {n}": 1.0 for n in range(1, len(self.places) + 1)}
            one |= {"carriage": 1.0, "carriage, pitch at its end": lever}
        if len(self.positions) == 1:
            return one
        bodies = range(1, len(self.positions) + 1)
        return {f"{name}, body {number}": each for number in bodies for name, each in one.items()}

    @property
    def described(self) -> str:
        """What rolls, in words."""
        words = {"mass": ("body", "bodies"), "chain": ("suspended body", "suspended bodies")}
        one, many = words.get(self.type, (self.type, f"{self.type}s"))
        return f"a {one}" if len(self.positions) == 1 else f"{len(self.positions)} {many}"

    def model(
        self,
        upper_stiffness: float,
        highest_frequency: float,
        speed: float,
        name: str = "body",
        place: float = 0.0,
    ) -> Body:
        """Build one of the bodies, with the resonances of what touches, turning at a rolling speed, m/s.

        It touches at a place across its tread, m. Stiffness of the contact above each element of a carriage,
        N/m, if the section gives none. Receptances are fitted up to twice the highest frequency, Hz; shorter
        ones are warned of by `name`.
        """
        if self.receptance is not None:
            from asperity.structures.modal_fit import REACH, warn_of_short_band
            from asperity.structures.receptance_fit import fit_body

            frequency, measured = read_receptance(self.receptance)
            warn_of_short_band(name, frequency, highest_frequency)
            within = frequency <= REACH * highest_frequency
            with fitted_to(self.receptance):
                return fit_body(self.contact_mass, self.contact_load, frequency[within], measured[within])
        resonances = self.resonances(highest_frequency, speed, place)
        body = self._rigid(upper_stiffness)
        return body.with_modes(*resonances) if len(resonances[0]) else body

    def _rigid(self, upper_stiffness: float) -> Body:
        mass = self.contact_mass
        places = self.places
        above = list(self.masses or ())
        extra = self.contact_load * len(places) - GRAVITY * (mass * len(places) + sum(above))
        springs = list(self.springs or ())
        dampers = list(self.dampers or [0.0] * len(above))
        if self.type == "chain":
            return chain([mass, *above], springs, dampers, load=extra)
        if self.type == "mass":
            return Body.rigid(mass, self.contact_load)
        inertia = self.inertia or above[0] * (places[-1] or 2.0 * self.radius) ** 2 / 12.0
        upper = springs[0] if springs else upper_stiffness
        return carriage(above[0], inertia, places, mass, upper, dampers[0], load=extra)

    def tread(self, highest_frequency: float, speed: float, place: float = 0.0) -> Wheel:
        """What touches at each contact, at a place, m, by itself: mass and modes, as `model` has them."""
        return Wheel(self.contact_mass, self.contact_load, *self.resonances(highest_frequency, speed, place))

    def problems(self) -> Iterator[InputError]:
        """What each type of body needs, and contacts that are apart."""
        yield from super().problems()
        if len(self.offsets) > MOST_CONTACTS:
            yield InputError("positions", count_of(len(self.offsets), "contact"), f"at most {MOST_CONTACTS}")
        yield from self._problems_of_type()
        if max(self.flat_contacts, default=0) > len(self.offsets):
            received = f"{max(self.flat_contacts)}"
            allowed = f"numbers up to {len(self.offsets)}"
            yield InputError("flat_contacts", received, allowed)
        ordered = np.sort(self.offsets)
        if len(ordered) > 1 and np.diff(ordered).min() <= 1e-9:
            received = "two contacts in the same place"
            yield InputError("positions", received, "contacts that are apart", "Move one of them.")
        if self.receptance is not None and self.type != "mass":
            received = f"beside type {self.type}"
            allowed = "that of a mass, alone"
            yield InputError("receptance", received, allowed, "Give modes, or the receptance.")
        if self.contact_mass < (drawn := self.drawn_mass):
            allowed = f"at least {drawn:.4g} kg, that of the drawn wheel, to which the axle adds"
            yield InputError("mass", f"{self.contact_mass:g} kg", allowed, OTHERWISE)

    def _problems_of_type(self) -> Iterator[InputError]:
        above = {"mass": 0, "bogie": 1, "carriage": 1}.get(self.type)
        masses = len(self.masses or ())
        if above is not None and masses != above:
            allowed = {0: "no masses above", 1: "one mass above the contacts"}[above]
            yield InputError("masses", f"{masses} of a {self.type}", allowed)
        if self.type == "chain" and not masses:
            yield InputError("masses", "none of a chain", "at least one mass above", 'As ["2500 kg"].')
        springs = len(self.springs or ())
        dampers = len(self.dampers or ())
        if springs != masses and not (self.type == "carriage" and springs == 0):
            yield InputError("springs", f"{springs} under {masses} masses", "one spring under each mass")
        if dampers not in (0, masses):
            allowed = "one beside each spring, or none"
            yield InputError("dampers", f"{dampers} beside {masses} springs", allowed)
        apart = len(self.places) > 1
        if apart and self.distance is None:
            yield InputError("distance", f"nothing for a {self.type}", "the distance of its contacts")
        for name in ("distance", "inertia"):
            if not apart and getattr(self, name) is not None:
                allowed = 'only of a "bogie", or of a "carriage" on several elements'
                yield InputError(name, f"of a {self.type}", allowed, "Remove the key.")
