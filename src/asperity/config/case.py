"""What all kinds of case have in common: keys at the top, time step, and what must fit together."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BeforeValidator, PrivateAttr

from asperity.config.describing import parameters
from asperity.config.keys import Choice, Duration, DurationOrZero, Position, Section, Speed, key
from asperity.config.sections import ContactCase, Index, Numerics, Surface
from asperity.errors import InputError
from asperity.laws import names
from asperity.units import written

MOST_STEPS = 10**8
SETTLED = 0.05
"""Run-in after which the force of a record varies as in a long run, within some per cent, s."""
SAMPLING = 2.5  # points per period of the highest frequency, at least

Law = Annotated[str, BeforeValidator(Choice(names))]


class Case(Section):
    """A body rolls over a rough surface; each kind of case adds its bodies and its defaults.

    Every length, time, force and so on is in SI here; units stand in the case file alone.
    """

    kind: str
    speed: Speed
    laws: tuple[Law, ...]
    seed: Index = key(1, "seed of everything random")
    start: Position | None
    duration: Duration | None
    settling: DurationOrZero | None
    surface: Surface

    if TYPE_CHECKING:  # each kind declares these two after the sections of its own
        contact: ContactCase
        numerics: Numerics

    _text: str = PrivateAttr("")
    _given: dict[str, Any] = PrivateAttr(default_factory=dict)
    _source: str = PrivateAttr("case")

    @property
    def text(self) -> str:
        """The TOML text that this case was read from."""
        return self._text

    @property
    def given(self) -> dict[str, Any]:
        """The keys that its file holds, as TOML gives them."""
        return self._given

    @property
    def source(self) -> str:
        """The file that this case was read from; relative paths in it start at its folder."""
        return self._source

    def parameters(self) -> list[dict[str, Any]]:
        """List the keys that matter in this case, for people.

        Returns
        -------
        list of dict
            For each key: ``key`` (dotted), ``value`` and ``default`` (text with units), ``is_default`` and
            ``note`` (what the key is).
        """
        given = dict(self._given)
        given.setdefault("laws", list(self.laws))
        return parameters(self, given)

    @property
    def time_step(self) -> float:
        """Time step in s."""
        raise NotImplementedError

    @property
    def record_start(self) -> float:
        """Position in m where the record starts."""
        raise NotImplementedError

    @property
    def settled_time(self) -> float:
        """Time in s that is rolled before the record starts."""
        raise NotImplementedError

    @property
    def rolled_time(self) -> float:
        """Time in s that is recorded; the run-in comes before it."""
        raise NotImplementedError

    @property
    def rolled_range(self) -> tuple[float, float]:
        """First and last position of the contact in m, from the start of the run-in."""
        first = self.record_start - self.speed * self.settled_time
        return first, self.record_start + self.speed * self.rolled_time


def problems_of_laws(case: Case) -> Iterator[InputError]:
    """At least one law, and each once."""
    if not case.laws:
        yield InputError("laws", "an empty list", "at least one law", 'Take laws = ["areal", "linear"].')
    for law in sorted(set(case.laws)):
        if case.laws.count(law) > 1:
            yield InputError("laws", f'"{law}" more than once', "each law once")


def problems_of_sampling(case: Case) -> Iterator[InputError]:
    """Grid and time step resolve the highest frequency and the shortest wavelength."""
    highest = case.numerics.highest_frequency
    coarsest = case.speed / (SAMPLING * highest)
    spacing, surface = case.contact.spacing, case.surface
    if spacing > coarsest:
        received = f"{written(spacing, 'm', 'um')} at {case.speed:g} m/s and {highest:g} Hz"
        allowed = f"at most speed / ({SAMPLING} highest_frequency) = {coarsest * 1e6:.4g} um"
        yield InputError("contact.spacing", received, allowed, "Refine spacing, or lower highest_frequency.")
    if case.time_step > 1 / (SAMPLING * highest):
        allowed = f"at most 1 / ({SAMPLING} highest_frequency) = {1e6 / (SAMPLING * highest):.4g} us"
        yield InputError("numerics.time_step", f"{case.time_step * 1e6:g} us", allowed)
    shortest = surface.band[1]
    if shortest is not None and shortest < 2 * spacing * (1 - 1e-9):
        received = f"{written(shortest, 'm', 'um')} on a spacing of {written(spacing, 'm', 'um')}"
        yield InputError("surface.shortest", received, f"at least two spacings, {2e6 * spacing:g} um")


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
