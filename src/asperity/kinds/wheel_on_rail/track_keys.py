"""Track, contact and numerics of a case with a railway wheel."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

from asperity.config import values
from asperity.config.form import Section, key, optional
from asperity.config.sections import ContactCase, Numerics
from asperity.errors import InputError
from asperity.reference.tracks import TRACKS

if TYPE_CHECKING:
    from asperity.structures.track import Track

LossFactor = Annotated[float, values.Number(at_least=0, at_most=5)]


_NAMED = "of the named set"


class TrackParameters(Section):
    """The track without what a run records of it: a named, cited set; each single key overrides it."""

    name: Annotated[str, values.Choice(tuple(TRACKS))] = key("x2000", "named set of parameters")
    bending_stiffness: Annotated[float, values.Quantity("N m^2", above=0)] | None = optional(
        "4.7 MN m^2", "bending stiffness of the rail", _NAMED, "1 kN m^2 to 1 GN m^2: rails lie between"
    )
    mass_per_length: Annotated[float, values.Quantity("kg/m", above=0)] | None = optional(
        "60 kg/m", "mass of the rail per length", _NAMED, "1 kg/m to 1000 kg/m: rails lie between"
    )
    rail_loss_factor: LossFactor | None = optional(0.01, "loss factor of the rail", _NAMED)
    shear_stiffness: values.Force | None = optional(
        "243 MN",
        "shear stiffness of the rail; with it, the rail is a Timoshenko beam",
        _NAMED,
        "1 kN to 1 TN: rails lie between",
    )
    rotary_inertia: Annotated[float, values.Quantity("kg m", above=0)] | None = optional(
        "0.24 kg m",
        "rotary inertia of the rail per length",
        _NAMED,
        "1e-6 kg m to 1000 kg m: rails lie between",
    )
    pad_stiffness: values.Stiffness | None = optional(
        "300 MN/m", "stiffness of a rail pad", _NAMED, "1 kN/m to 1 TN/m: pads lie between"
    )
    pad_damping: values.Damping | None = optional(
        "18 kN s/m", "viscous damping of a pad", _NAMED, "1e-3 N s/m to 1e9 N s/m: pads lie between"
    )
    pad_loss_factor: LossFactor | None = optional(
        0.15, "loss factor of a pad, instead of pad_damping; approximated in time", _NAMED
    )
    sleeper_mass: values.Mass | None = optional(
        "150 kg",
        "mass of a sleeper under one rail: half a sleeper",
        _NAMED,
        "1 kg to 100 t: sleepers lie between",
    )
    ballast_stiffness: values.Stiffness | None = optional(
        "150 MN/m",
        "stiffness of the ballast under half a sleeper",
        _NAMED,
        "1 kN/m to 1 TN/m: ballast lies between",
    )
    ballast_damping: values.Damping | None = optional(
        "48 kN s/m", "viscous damping of the ballast", _NAMED, "1e-3 N s/m to 1e9 N s/m: ballast lies between"
    )
    ballast_loss_factor: LossFactor | None = optional(
        0.4, "loss factor of the ballast, instead of ballast_damping; approximated in time", _NAMED
    )
    sleeper_spacing: values.Length | None = optional(
        "0.6 m", "distance of the sleepers", _NAMED, "0.1 m to 10 m: sleepers are as far apart"
    )
    rail_head_radius: values.Length = key(
        "0.3 m", "radius of the rail head across the rail", "1 mm to 1 km: rail heads lie between"
    )
    material: values.OwnOrNamed = key("steel", "material of the rail")

    @property
    def overrides(self) -> dict[str, float]:
        """What the case says beside the name of its set, by the keywords of `Track`, in SI."""
        told = {name: getattr(self, name) for name in OVERRIDES}
        return {name: value for name, value in told.items() if value is not None}

    def model(self) -> Track:
        """Build the track: the named set with the keys of the case in it."""
        from asperity.structures.track import Track

        return Track.named(self.name, **self.overrides)

    def problems_at(self, speed: float) -> Iterator[InputError]:
        """A track that exists and is damped, over which a speed, m/s, is slower than the waves sent out."""
        try:
            track = self.model()
        except InputError as error:
            yield InputError("track", error.received, error.allowed, error.remedy)
            return
        if not track.is_damped:
            remedy = "Give the rail a loss factor, or damping to pads or ballast."
            yield InputError("track", "no damping at all", "a track whose vibration dies away", remedy)
        try:
            track.refuse_speed(speed)
        except InputError as error:
            yield InputError("speed", f"{speed:g} m/s", error.allowed, error.remedy)

    def problems(self) -> Iterator[InputError]:
        """Each damping either viscous or by a loss factor."""
        told = self.overrides
        for part in ("pad", "ballast"):
            viscous, loss = f"{part}_damping", f"{part}_loss_factor"
            if viscous in told and loss in told:
                received = f"{told[viscous]:g} N s/m and {loss} = {told[loss]:g}"
                remedy = "Remove one: damping is either viscous or by a loss factor."
                yield InputError(viscous, received, "one of them", remedy)


class PassedTrack(TrackParameters):
    """The track, and the points at which its motion is recorded."""

    points: tuple[values.Position, ...] | None = optional(
        ["9 m", "9.3 m"],
        "positions at which the motion of the rail is recorded while it is passed, from the sleeper that "
        "start counts from",
        "over a sleeper and at mid-span in the middle of the run",
        "0 m to 100 km: tracks are rolled over for less",
    )

    def points_or(self, middle: float) -> tuple[float, ...]:
        """The points, m; by default over the sleeper nearest to a position, m, and at mid-span after it."""
        if self.points is not None:
            return self.points
        bay = self.model().sleeper_spacing
        sleeper = bay * round(middle / bay)
        return sleeper, sleeper + bay / 2

    def problems_of_points(self, first: float, last: float) -> Iterator[InputError]:
        """Points that are passed in the record, from and to positions, m."""
        for point in self.points or ():
            if not first <= point <= last:
                allowed = f"positions that are passed, {first:g} m to {last:g} m"
                yield InputError("track.points", f"{point:g} m", allowed)

    def problems(self) -> Iterator[InputError]:
        """Dampings as of all tracks, and at least one point."""
        yield from super().problems()
        if self.points == ():
            remedy = "Remove the key for the default."
            yield InputError("points", "an empty list", "at least one position", remedy)


class TrackCase(PassedTrack):
    """The track, its points, and its rail head."""

    rail_profile: values.SectionFile | None = optional(
        "rail.csv", "measured shape of the rail head across the rail, instead of rail_head_radius"
    )

    def problems(self) -> Iterator[InputError]:
        """As of all tracks, and one rail head."""
        yield from super().problems()
        if {"rail_head_radius", "rail_profile"} <= self.model_fields_set:
            yield InputError("", "both rail_head_radius and rail_profile", "one of them", "Remove one.")


OVERRIDES = (
    "bending_stiffness",
    "mass_per_length",
    "rail_loss_factor",
    "shear_stiffness",
    "rotary_inertia",
    "pad_stiffness",
    "pad_damping",
    "pad_loss_factor",
    "sleeper_mass",
    "ballast_stiffness",
    "ballast_damping",
    "ballast_loss_factor",
    "sleeper_spacing",
)


class RailContact(ContactCase):
    """How the contact of wheel and rail is solved and reduced."""

    spacing: values.ChosenLength = optional(
        "0.5 mm",
        "grid spacing of the contact solution",
        "a ninth of the smooth contact's smaller half-width, or a quarter of surface.shortest",
        "1 um to 10 mm: an elastic continuum is coarser than grains, and contacts are smaller than 10 mm",
    )
    window: values.ChosenLength = optional(
        "20 mm",
        "side of the square window in which contact is solved; wider than the contact",
        "that of the smooth contact under three times the load, wider by roughness and by a flat",
        "10 um to 1 m: contacts lie between grains and bodies",
    )


class RailNumerics(Numerics):
    """How finely time and the track are resolved."""

    time_step: values.Duration | None = optional(
        "25 us",
        "time step",
        "near 1/8 of the highest frequency's period, on the grid of the contact if that is near",
        "10 ns to 1 ms: the spectra lie between",
    )
    kernel: Annotated[str, values.Choice(("poles", "scatter"))] = key(
        "poles", "how the track's response is carried on in time: by fitted poles, or by its whole past"
    )
    poles: Annotated[int, values.Number(at_least=10, at_most=1000, whole=True)] | None = optional(
        100,
        "largest number of poles, even; no more are taken than tell anything of the track",
        "100, or a tenth of the time steps that the track remembers if that is less",
        goes_with="kernel=poles",
    )

    def problems(self) -> Iterator[InputError]:
        """Poles come in pairs."""
        if self.poles is not None and self.poles % 2:
            yield InputError("poles", self.poles, "an even number", "Poles come in conjugate pairs.")
