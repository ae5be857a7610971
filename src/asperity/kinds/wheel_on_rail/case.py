"""The case of a wheel that rolls on an infinite track: its keys, defaults, and what must fit together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from pydantic import model_validator

from asperity.config import values
from asperity.config.case import (
    Case,
    Law,
    problem_of_steps,
    problems_of_laws,
    problems_of_sampling,
    time_step_on_grid,
)
from asperity.config.chosen import NominalPatch
from asperity.config.describing import in_words
from asperity.config.form import Section, key
from asperity.config.tables import check_band_levels, read_levels
from asperity.errors import InputError
from asperity.kinds.wheel_on_rail.noise_keys import NoiseCase
from asperity.kinds.wheel_on_rail.surface_keys import RailSurface
from asperity.kinds.wheel_on_rail.track_keys import OVERRIDES, RailContact, RailNumerics, TrackCase
from asperity.kinds.wheel_on_rail.wheel_keys import WheelCase
from asperity.reference.materials import contact_modulus
from asperity.scenarios.kind import Words
from asperity.units import written

if TYPE_CHECKING:
    from asperity.radiation.pass_by import Passage
    from asperity.structures.track import Track

STEPS_PER_PERIOD = 8  # of the highest frequency
CLOSE = 1.2  # a time step may be changed by this factor to bring positions onto the grid

ROLLED = ("areal", "shifted", "printed", "linear-filtered", "linear")
OVER_DEFECTS = ("direct", "linear-filtered", "linear")
"""Laws that are rolled where a case names none, and where it rolls over a flat or a joint."""


class WheelOnRail(Case):
    """A wheel rolls on a rail of infinite length on discrete supports.

    Each key's meaning, default and allowed values are printed by ``asperity new wheel-on-rail``. Positions
    count along the rail, in m from a sleeper. Every law is allowed: textures are laid out as strips.

    Examples
    --------
    >>> from asperity import WheelOnRail
    >>> case = WheelOnRail(surface={"spectrum": "iso3095"}, track={"pad_stiffness": 150e6})
    >>> case.with_(speed="200 km/h").track_model().pad_stiffness
    150000000.0
    """

    kind: Annotated[str, values.Choice(("wheel-on-rail",))] = key("wheel-on-rail", "what rolls")
    speed: values.Speed = key(
        "56 m/s", "rolling speed", "1 mm/s to 1 km/s: slower rolling is static, and nothing rolls faster"
    )
    laws: tuple[Law, ...] = key(
        ROLLED,
        "laws of the contact force; the first is the main one, direct where a flat or a joint is rolled over",
    )
    start: values.Position = key(
        "0 m", "where the record starts, from a sleeper", "0 m to 100 km: tracks are rolled over for less"
    )
    duration: values.Duration = key("1 s", "time that is recorded", "10 us to 1 h: records lie between")
    settling: values.DurationOrZero = key(
        "0.3 s",
        "time that is rolled before the record starts, so that the start is forgotten",
        "10 us to 1 h: records lie between",
    )
    surface: RailSurface = key({}, "texture of the rail: measured or synthesised, with defects on top")
    wheel: WheelCase = key({}, "the wheel that rolls")
    track: TrackCase = key({}, "the track that is rolled over")
    contact: RailContact = key({}, "how the rough contact is solved and reduced")
    numerics: RailNumerics = key({}, "how finely time and the track are resolved")
    noise: NoiseCase = key({}, "what radiates, and the labels of CNOSSOS-EU")

    @model_validator(mode="before")
    @classmethod
    def _laws_that_see_defects(cls, data: Any) -> Any:
        """Roll over a flat or a joint by a law that sees its shape, where the case names none."""
        if not isinstance(data, Mapping) or "laws" in data:
            return data
        keys: set[str] = set()
        for section in (data.get("wheel"), data.get("surface")):
            found = section.given() if isinstance(section, Section) else section
            keys |= set(found) if isinstance(found, Mapping) else set()
        return {**data, "laws": OVER_DEFECTS} if keys & {"flat_depth", "flat_length", "joint_depth"} else data

    def default_of(self, name: str) -> Any:
        """Value of a key that is left out: laws as the defects ask for them."""
        return OVER_DEFECTS if name == "laws" and self.has_defect else super().default_of(name)

    @property
    def has_defect(self) -> bool:
        """Whether a flat or a joint is rolled over."""
        return self.wheel.flat is not None or self.surface.joint_depth is not None

    @property
    def defect_length(self) -> float:
        """Length of a flat in m, which the window is to hold beside the contact."""
        flat = self.wheel.flat
        return 0.0 if flat is None else flat[1]

    @property
    def nominal_patch(self) -> NominalPatch:
        """Contact of wheel and rail by their radii, from which grid and window are chosen."""
        wheel, modulus = self.wheel, contact_modulus(self.wheel.material, self.track.material)
        across = 1.0 / (1.0 / wheel.transverse_radius + 1.0 / self.track.rail_head_radius)
        return NominalPatch.of(modulus, wheel.radius, across, wheel.load)

    @property
    def tread(self) -> WheelCase:
        """What touches the rail."""
        return self.wheel

    @property
    def tread_name(self) -> str:
        """Section that describes what touches the rail."""
        return "wheel"

    @property
    def rolling_radius(self) -> float:
        """Radius of what rolls, m."""
        return self.wheel.radius

    @property
    def axles(self) -> int:
        """Number of axles whose sound power is added."""
        return self.noise.axles

    @property
    def passage(self) -> Passage:
        """The axles that pass a receiver beside the track."""
        return self.noise.passage(self.speed)

    @property
    def time_step(self) -> float:
        """Time step in s: as given, or near 1/(8 f_max).

        Where that changes it by less than 20 %, the distance rolled in one step is a whole multiple, or a
        whole fraction, of ``contact.spacing``.
        """
        if self.numerics.time_step is not None:
            return self.numerics.time_step
        per_cell = self.contact.spacing / self.speed
        wanted = 1 / (STEPS_PER_PERIOD * self.numerics.highest_frequency)
        cells = round(wanted / per_cell)
        found = cells * per_cell if cells else time_step_on_grid(wanted, per_cell)
        return found if 1 / CLOSE <= found / wanted <= CLOSE else wanted

    @property
    def record_start(self) -> float:
        """Position in m, from a sleeper, where the record starts."""
        return self.start

    @property
    def settled_time(self) -> float:
        """Time in s that is rolled before the record starts."""
        return self.settling

    @property
    def rolled_time(self) -> float:
        """Time in s that is recorded; `settling` comes before it."""
        return self.duration

    @property
    def point_positions(self) -> tuple[float, ...]:
        """Positions in m at which the rail's motion is recorded, with the default filled in."""
        return self.track.points_or(self.start + self.speed * self.duration / 2)

    def track_model(self) -> Track:
        """Build the track of this case: the named set with the case's own keys in it."""
        return self.track.model()

    def parameters(self) -> list[dict[str, Any]]:
        """List the keys that matter, as `Case.parameters`, with the values of the named track."""
        track, own = self.track_model(), self.track.overrides
        listed = []
        for item in super().parameters():
            section, _, name = item["key"].partition(".")
            if section == "track" and name in OVERRIDES and name not in own:
                value = getattr(track, name)
                if value is None:
                    continue
                text = in_words(value, type(self.track).model_fields[name])
                item = item | {"value": text, "default": text}
            listed.append(item)
        return listed

    def problems(self) -> Iterator[InputError]:
        """What must fit together across the sections."""
        yield from problems_of_laws(self)
        yield from problems_of_sampling(self)
        yield from problem_of_steps(self, self.settling + self.duration)
        yield from _problems_of_texture(self)
        yield from _problems_of_levels(self)
        yield from self.track.problems_at(self.speed)
        yield from _problems_of_path(self)
        widest = 2 * min(self.wheel.radius, self.track.rail_head_radius)
        if self.contact.window > widest:
            allowed = f"at most the smaller diameter of wheel and rail head, {written(widest, 'm', 'mm')}"
            yield InputError("contact.window", written(self.contact.window, "m", "mm"), allowed)


def _problems_of_texture(case: WheelOnRail) -> Iterator[InputError]:
    surface, spacing = case.surface, case.contact.spacing
    if not (surface.has_texture or case.wheel.has_texture or surface.smooth):
        allowed = "file, rms, line, spectrum or a defect in [surface]; roughness, line or a flat in [wheel]"
        yield InputError("surface", "no texture", allowed, "For a smooth rail, set smooth = true.")
    if surface.corrugation_wavelength is not None and surface.corrugation_wavelength < 2 * spacing:
        wave, step = (written(length, "m", "mm") for length in (surface.corrugation_wavelength, spacing))
        received = f"{wave} on a spacing of {step}"
        allowed = f"at least two spacings, {2e3 * spacing:g} mm"
        yield InputError("surface.corrugation_wavelength", received, allowed)


def _problems_of_levels(case: WheelOnRail) -> Iterator[InputError]:
    """Band levels that no wheel or rail has ask for their unit."""
    if case.surface.accept_levels:
        return
    for name, table, level in (
        ("surface.spectrum", case.surface.spectrum, case.surface.level),
        ("wheel.roughness", case.wheel.roughness, case.wheel.roughness_level),
    ):
        levels = np.zeros(1) if table is None or isinstance(table, str) else read_levels(table)[1]
        if table is not None:
            try:
                check_band_levels(levels + level, name)
            except InputError as error:
                yield error


def _problems_of_path(case: WheelOnRail) -> Iterator[InputError]:
    length, contact = case.speed * case.duration, case.contact
    filters = (contact.filter_taps or 0) * contact.spacing
    if length < max(contact.window, filters):
        received = f"{case.duration:g} s, in which {length * 1e3:.4g} mm are rolled"
        allowed = f"at least contact.window, {written(contact.window, 'm', 'mm')}"
        if filters > contact.window:
            allowed = f"at least contact.filter_taps spacings, {written(filters, 'm', 'mm')}"
        yield InputError("duration", received, allowed, "A path must be longer than window and filters.")
    (first, last), joint = case.rolled_range, case.surface.joint_position
    if joint is not None and not first <= joint <= last:
        allowed = f"a position that is rolled over, {first:g} m to {last:g} m"
        yield InputError("surface.joint_position", f"{joint:g} m", allowed)
    yield from case.track.problems_of_points(case.start, last)


CASE = WheelOnRail
ROLLING = "wheel"
WORDS = Words(
    "A wheel rolls on an infinite track.",
    ", of rail or wheel, or smooth = true",
    {"surface.spectrum": '"iso3095"', "wheel.roughness": '"disc"'},
)
