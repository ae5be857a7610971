"""What all kinds of case have in common: keys at the top, time step, and what must fit together."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import suppress
from typing import TYPE_CHECKING, Annotated, Any, Self

from asperity.config import values
from asperity.config.chosen import NominalPatch, choose_lengths
from asperity.config.content import described_value
from asperity.config.describing import in_toml, parameters, refused, toml_text
from asperity.config.form import Section, key, optional
from asperity.config.sections import MOST_CELLS, ContactCase, Index, Numerics, Surface
from asperity.errors import InputError
from asperity.laws import names
from asperity.units import written

MOST_STEPS = 10**8
SETTLED = 0.05
"""Run-in after which the force of a record varies as in a long run, within some per cent, s."""
RECORDED = 0.5
"""Record of a case that says nothing of it, s."""
STEPS_PER_PERIOD = 20  # of the highest frequency
SAMPLING = 2.5  # points per period of the highest frequency, at least

Law = Annotated[str, values.Choice(names)]


class Case(Section):
    """A body rolls over a rough surface; each kind of case adds its bodies and its defaults.

    Every length, time, force and so on is in SI here. A case does not change; `with_` makes another one.
    Cases are equal if all their keys are.
    """

    kind: str  # each kind declares its own
    speed: values.Speed = key(
        "1 m/s", "rolling speed", "0.1 mm/s to 1 km/s: slower rolling is static, and nothing rolls faster"
    )
    laws: tuple[Law, ...]  # each kind names its own
    seed: Index = key(1, "seed of everything random")
    start: values.Position | None = optional(
        "0.2 m",
        "where on the path the record starts",
        "after the run-in, which begins at 0 m",
        "0 m to 1000 km: paths are shorter",
    )
    duration: values.Duration | None = optional(
        "1 s", "time that is recorded", "0.5 s", "1 us to 1 h: records lie between"
    )
    settling: values.DurationOrZero | None = optional(
        "0.2 s",
        "time that is rolled before the record starts, so that the start from rest is forgotten",
        "50 ms",
        "1 us to 1 h: records lie between",
    )
    surface: Surface = key({}, "what is rolled over: a measured map, or synthesised roughness")

    if TYPE_CHECKING:  # each kind declares these two after the sections of its own
        contact: ContactCase
        numerics: Numerics

    def with_(self, **changes: Any) -> Self:
        """Return the same case with other values for some keys.

        Parameters
        ----------
        **changes
            Keys with their new values, in SI or as text with a unit; None takes a key out. A key of a section
            is written ``**{"contact.spacing": 4e-6}``, or in a mapping of keys of the section, of which the
            others stay: ``contact={"spacing": "4 um"}``.

        Returns
        -------
        Case
            A new case of the same kind.

        Raises
        ------
        CaseError
            With all errors at once, if the keys are wrong or do not fit together.
        """
        data = self.given()
        for name, value in changes.items():
            section, _, key_in_section = name.rpartition(".")
            _change(data, {section: {key_in_section: value}} if section else {name: value})
        return type(self)(**data)

    def to_toml(self) -> str:
        """Write the case as a case file: its kind, and all keys that are not at their defaults.

        Returns
        -------
        str
            TOML that reads as the same case, to the last bit.

        Raises
        ------
        InputError
            If a surface or a table stands in memory, which no case file can hold.
        """
        return toml_text({"kind": self.kind, **in_toml(self, in_memory=refused)})

    @property
    def text(self) -> str:
        """The case in TOML; what stands in memory is described, with its digest."""
        keys = in_toml(self, in_memory=lambda _, value: described_value(value))
        return toml_text({"kind": self.kind, **keys})

    def parameters(self) -> list[dict[str, Any]]:
        """List the keys that matter in this case, for people.

        Returns
        -------
        list of dict
            For each key: ``key`` (dotted), ``value`` and ``default`` (text with units), ``is_default`` and
            ``note`` (what the key is).
        """
        return parameters(self)

    @property
    def nominal_patch(self) -> NominalPatch | None:
        """Contact of its smooth bodies, from which grid and window are chosen; None where they are given."""

    def _choose(self) -> None:
        with suppress(InputError):  # bodies that do not touch in a point: `problems` say so
            if (patch := self.nominal_patch) is not None:
                choose_lengths(self, patch)

    @property
    def defect_length(self) -> float:
        """Length in m of a defect that the window is to hold beside the contact; zero without one."""
        return 0.0

    @property
    def coarsest_spacing(self) -> float:
        """Spacing of the contact grid in m on which the highest frequency is still resolved."""
        return self.speed / (SAMPLING * self.numerics.highest_frequency)

    @property
    def time_step(self) -> float:
        """Time step in s: as given, or near 1/(20 f_max) with positions on the grid of the contact solution.

        The distance rolled in one step is then a whole multiple, or a whole fraction, of ``contact.spacing``.
        """
        if self.numerics.time_step is not None:
            return self.numerics.time_step
        wanted = 1 / (STEPS_PER_PERIOD * self.numerics.highest_frequency)
        return time_step_on_grid(wanted, self.contact.spacing / self.speed)

    @property
    def record_start(self) -> float:
        """Position in m where the record starts: as given, or after the run-in."""
        return self.start if self.start is not None else self.speed * self.settled_time

    @property
    def settled_time(self) -> float:
        """Time in s that is rolled before the record starts: as given, or `SETTLED`."""
        return SETTLED if self.settling is None else self.settling

    @property
    def rolled_time(self) -> float:
        """Time in s that is recorded: as given, or `RECORDED`; the run-in comes before it."""
        return RECORDED if self.duration is None else self.duration

    @property
    def rolled_range(self) -> tuple[float, float]:
        """First and last position of the contact in m, from the start of the run-in."""
        first = self.record_start - self.speed * self.settled_time
        return first, self.record_start + self.speed * self.rolled_time

    def problems(self) -> Iterator[InputError]:
        """What must fit together across the sections; a kind adds its own."""
        yield from problems_of_laws(self)
        yield from problems_of_sampling(self)
        yield from problem_of_steps(self, self.settled_time + self.rolled_time)


def _change(data: dict[str, Any], changes: Mapping[str, Any]) -> None:
    """Put keys into the dicts of a case; None takes them out."""
    for name, value in changes.items():
        if value is None:
            data.pop(name, None)
        elif isinstance(value, Mapping) and isinstance(section := data.get(name, {}), dict):
            data[name] = section = dict(section)
            _change(section, value)
        else:
            data[name] = value


def problems_of_laws(case: Case) -> Iterator[InputError]:
    """At least one law, and each once."""
    if not case.laws:
        yield InputError("laws", "an empty list", "at least one law", 'Take laws = ["areal", "linear"].')
    for law in sorted(set(case.laws)):
        if case.laws.count(law) > 1:
            yield InputError("laws", f'"{law}" more than once', "each law once")


def problems_of_sampling(case: Case) -> Iterator[InputError]:
    """Grid and time step resolve the highest frequency and the shortest wavelength."""
    yield from _problems_of_window(case.contact)
    highest, coarsest = case.numerics.highest_frequency, case.coarsest_spacing
    spacing, surface = case.contact.spacing, case.surface
    if spacing > coarsest:
        received = f"{written(spacing, 'm', 'um')} at {case.speed:g} m/s and {highest:g} Hz"
        allowed = f"at most speed / ({SAMPLING} highest_frequency) = {coarsest * 1e6:.4g} um"
        yield InputError("contact.spacing", received, allowed, "Refine spacing, or lower highest_frequency.")
    if case.time_step > 1 / (SAMPLING * highest):
        allowed = f"at most 1 / ({SAMPLING} highest_frequency) = {1e6 / (SAMPLING * highest):.4g} us"
        yield InputError("numerics.time_step", f"{case.time_step * 1e6:g} us", allowed)
    shortest = surface.shortest
    if shortest is not None and shortest < 2 * spacing * (1 - 1e-9):
        received = f"{written(shortest, 'm', 'um')} on a spacing of {written(spacing, 'm', 'um')}"
        yield InputError("surface.shortest", received, f"at least two spacings, {2e6 * spacing:g} um")


def _problems_of_window(contact: ContactCase) -> Iterator[InputError]:
    """The window holds a sensible number of cells, and strips more than one window."""
    if not 8 <= contact.cells <= MOST_CELLS:
        window, spacing = (written(length, "m", "um") for length in (contact.window, contact.spacing))
        received = f"{window}, {contact.cells} cells of {spacing}"
        remedy = "Change window or spacing."
        yield InputError("contact.window", received, f"8 to {MOST_CELLS} cells of the spacing", remedy)
    if contact.sample_length is not None and contact.sample_length < 2 * contact.window:
        received, allowed = written(contact.sample_length, "m", "um"), f"{2e6 * contact.window:g} um"
        yield InputError("contact.sample_length", received, f"at least two windows, {allowed}")


def problem_of_steps(case: Case, time: float) -> Iterator[InputError]:
    """At least one time step to record, and not more than can be computed."""
    if case.rolled_time < case.time_step:
        received = f"{case.rolled_time * 1e3:.4g} ms"
        yield InputError("duration", received, f"at least one time step, {case.time_step * 1e3:.4g} ms")
    if time / case.time_step > MOST_STEPS:
        received = f"{time / case.time_step:.2g} time steps"
        yield InputError(
            "duration", received, f"at most {MOST_STEPS:g} time steps", "Roll faster or shorter."
        )


def time_step_on_grid(wanted: float, per_cell: float) -> float:
    """Time step, s, near the one wanted, with positions on the grid of the contact solution.

    A whole multiple, rounded down, or a whole fraction of the time, s, in which one cell is rolled over.
    """
    if wanted >= per_cell:
        return per_cell * math.floor(wanted / per_cell * (1 + 1e-9))
    parts = math.ceil(per_cell / wanted * (1 - 1e-9))
    # on the grid the texture needs no interpolation: rather a slightly longer step than a finer one
    nearest = min((parts, max(parts - 1, 1)), key=lambda n: abs(math.log(per_cell / n / wanted)))
    return per_cell / nearest
