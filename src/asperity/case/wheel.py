"""How a wheel rings: by the drawing of its section, its modes or its receptance; or it is rigid."""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from asperity.arguments import Array
from asperity.case import form, tables
from asperity.errors import InputError
from asperity.parameters import Either, ListOf, Number, key, keys_of, optional
from asperity.reference.materials import Material
from asperity.reference.railways import SECTIONS
from asperity.store import Store
from asperity.structures import wheel_modes as ringing
from asperity.structures.outline import WheelSection, checked_outline, volume_of

RIGID = "rigid"
OTHERWISE = f'Give other dimensions, or section = "{RIGID}".'
CLOSE_RADIUS = 0.05
"""By which part the running circle of an outline may differ from the rolling radius."""
_RATIO = Number(above=0, at_most=0.9)
_DIMENSIONS = {
    name: replace(each, goes_with="section")
    for name, each in keys_of(WheelSection, otherwise="that of the named section").items()
}
_OF_DRAWN = ("modal_damping", "added_damping")


class Ringing(form.Section, parameters=_DIMENSIONS):
    """Resonances of what touches, the same at each contact."""

    radius: float
    material: Material

    modes: Path | Array | None = optional(
        tables.TableFile(columns=(3, 6), read=tables.read_mode_table),
        "modes.csv",
        "table of the resonances of what touches, the same at each contact: frequency (Hz), damping ratio, "
        "modal mass (kg); the sound of wheels needs three columns more: number of nodal diameters, by which "
        "turning splits a mode, and rms axial velocity of the disc and rms radial velocity of the tread, "
        "both per radial velocity at the contact",
        "those of the section",
    )
    receptance: Path | Array | None = optional(
        tables.TableFile(columns=(3,), read=tables.read_receptance),
        "receptance.csv",
        "table of the receptance of a mass, which is fitted by modes: frequency (Hz), real and imaginary "
        "part (m/N)",
        "modes, or rigid",
    )
    section: str | Path | Array = key(
        Either((RIGID, *SECTIONS), tables.TableFile(columns=(2,), read=tables.read_outline)),
        RIGID,
        "section of a wheel, whose modes are computed: drawn here from main dimensions, or an outline as a "
        "table, radius (mm) and axial place (mm) from the running circle, positive away from the flange",
    )
    modal_damping: tuple[float, ...] = key(
        ListOf(_RATIO, least=1),
        list(ringing.DAMPING),
        "damping ratios of its modes with 0, 1 and so on nodal diameters, the last of all beyond",
        goes_with="section",
    )
    added_damping: float = key(
        Number(at_least=0, at_most=0.9),
        0.0,
        "damping ratio that wheel dampers or rings add to its modes with two nodal diameters or more",
        goes_with="section",
    )

    @property
    def is_rigid(self) -> bool:
        """Whether it has no section."""
        return isinstance(self.section, str) and self.section == RIGID

    @property
    def is_drawn(self) -> bool:
        """Whether its modes are computed from its section."""
        return self.modes is None and self.receptance is None and not self.is_rigid

    @property
    def dimensions(self) -> dict[str, float]:
        """What the case says beside its named section."""
        return {name: each for name in _DIMENSIONS if (each := getattr(self, name)) is not None}

    @cached_property
    def outline(self) -> Array:
        """Outline of the drawn section (n, 2): radius and axial place, m."""
        if isinstance(self.section, str):
            return WheelSection.named(self.section, **self.dimensions).outline(self.radius)
        return tables.read_outline(self.section)

    def default_of(self, name: str) -> Any:
        """Value of a key that is left out: a dimension of the named section."""
        if name in _DIMENSIONS and name not in self.given_names and self.is_active(name):
            return SECTIONS[str(self.section)][name]
        return super().default_of(name)

    def is_active(self, name: str) -> bool:
        """Whether a key matters: dimensions of a named section, damping of a drawn one."""
        if name in _DIMENSIONS:
            return self.is_drawn and isinstance(self.section, str)
        return self.is_drawn if name in _OF_DRAWN else super().is_active(name)

    def standing_modes(self, highest_frequency: float) -> ringing.WheelModes | None:
        """Modes of the wheel at rest, for spectra up to a frequency, Hz; None without nodal diameters."""
        if self.modes is not None:
            table = tables.read_mode_table(self.modes)
            return ringing.WheelModes.from_table(table) if table.shape[1] > len(tables.MODES) else None
        if not self.is_drawn:
            return None
        found = _computed(
            self.outline.tobytes(),
            self.material,
            min(ringing.BEYOND * highest_frequency, ringing.HIGHEST),
        )
        return found.damped(self.modal_damping, self.added_damping)

    def turning_modes(self, highest_frequency: float, speed: float) -> ringing.WheelModes | None:
        """The same in the frame of a contact that moves along at a speed, m/s."""
        modes = self.standing_modes(highest_frequency)
        return None if modes is None else modes.turning(speed / self.radius)

    def resonances(
        self, highest_frequency: float, speed: float, place: float = 0.0
    ) -> tuple[Array, Array, Array]:
        """Natural frequencies, Hz, damping ratios and modal masses, kg, as the contact feels them.

        At a place across the tread, m from the running circle, positive away from the flange.
        """
        if (turning := self.turning_modes(highest_frequency, speed)) is not None:
            table = turning.table(place)
        else:
            table = np.zeros((0, 3)) if self.modes is None else tables.read_mode_table(self.modes)
        frequency, ratio, mass = table[:, :3].T
        return frequency, ratio, mass

    @property
    def drawn_mass(self) -> float:
        """Mass of the drawn wheel without its axle, kg; zero of any other, or where it cannot be drawn."""
        with suppress(InputError):
            return self.material.density * volume_of(self.outline) if self.is_drawn else 0.0
        return 0.0

    def problems(self) -> Iterator[InputError]:
        """One description of how it rings, and a drawing that fits to the wheel."""
        yield from super().problems()
        told = [name for name in ("modes", "receptance") if getattr(self, name) is not None]
        if (
            told
            and not (isinstance(self.section, str) and self.section == RIGID)
            and "section" in self.given_names
        ):
            yield InputError("", f"both section and {told[0]}", "one of them", "Remove one.")
        if self.is_drawn:
            yield from self._problems_of_drawing()

    def _problems_of_drawing(self) -> Iterator[InputError]:
        try:
            outline, circle = ringing.with_running_circle(checked_outline(self.outline))
        except InputError as error:
            yield InputError("section", error.received, error.allowed, error.remedy or OTHERWISE)
            return
        drawn = outline[circle, 0]
        if abs(drawn / self.radius - 1.0) > CLOSE_RADIUS:
            allowed = f"within {CLOSE_RADIUS:.0%} of the rolling radius, {self.radius * 1e3:.4g} mm"
            ratio = drawn / self.radius
            remedy = ""
            if abs(ratio / 2.0 - 1.0) <= CLOSE_RADIUS:
                remedy = "Are the radii of the section diameters? Then halve them."
            elif abs(2.0 * ratio - 1.0) <= CLOSE_RADIUS:
                remedy = f'Is radius the diameter? Then write radius = "{drawn * 1e3:.4g} mm".'
            yield InputError("section", f"a running circle of {drawn * 1e3:.4g} mm", allowed, remedy)


@lru_cache(maxsize=8)
def _computed(outline: bytes, material: Material, highest: float) -> ringing.WheelModes:
    return ringing.wheel_modes(np.frombuffer(outline).reshape(-1, 2), material, highest, cache=Store())
