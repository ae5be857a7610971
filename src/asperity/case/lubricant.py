"""The oil of a bearing: by its grade, or by two viscosities; without it contacts are dry."""

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

from asperity.case.form import Section
from asperity.contact.film import LINES, Film, LineFilm, inlet_heating
from asperity.contact.oil import DENSITY, GRADES, INDEX, Oil
from asperity.errors import InputError
from asperity.parameters import DURATION, Choice, Number, Quantity, key, optional

GRADE = "ISO VG "
_VISCOSITY = Quantity("m^2/s", above=0)
_VISCOUS = "0.4 mm^2/s to 100000 mm^2/s: oils lie between"
_WITH_OIL = "oil or viscosity_40"


class LubricantKeys(Section):
    """The oil between balls and raceways, of which contacts are full."""

    ALTERNATIVES = (("oil", "viscosity_40"),)
    oil: str | None = optional(
        Choice(tuple(f"{GRADE}{grade}" for grade in GRADES)), f"{GRADE}68", "grade of the oil", "dry contacts"
    )
    viscosity_index: float = key(
        Number(at_least=0, at_most=300), INDEX, "its viscosity index (ASTM D2270)", goes_with="oil"
    )
    viscosity_40: float | None = optional(
        _VISCOSITY, "68 mm^2/s", "kinematic viscosity at 40 degC instead", "that of the grade", _VISCOUS
    )
    viscosity_100: float | None = optional(
        _VISCOSITY, "8.6 mm^2/s", "the same at 100 degC", "by the index", _VISCOUS, goes_with="viscosity_40"
    )
    temperature: float = key(
        Quantity("degC"),
        "70 degC",
        "temperature of oil and contacts",
        "-60 degC to 250 degC: oils are used between",
        goes_with=_WITH_OIL,
    )
    density: float = key(
        Quantity("kg/m^3", above=0),
        f"{DENSITY:g} kg/m^3",
        "density of the oil",
        "500 kg/m^3 to 2500 kg/m^3: oils lie between",
        goes_with=_WITH_OIL,
    )
    pressure_viscosity: float | None = optional(
        Quantity("Pa^-1", above=0),
        "20 GPa^-1",
        "pressure-viscosity coefficient at this temperature",
        "that of a mineral oil of these viscosities",
        "1 GPa^-1 to 100 GPa^-1: oils lie between",
        goes_with=_WITH_OIL,
    )
    damping_time: float | None = optional(
        DURATION,
        "12.5 us",
        "damping of each contact over its stiffness; bearings are said to have 2.5 to 25 us (Krämer 1993)",
        "that of its film",
        "1 ns to 10 ms: contacts lie between",
        goes_with=_WITH_OIL,
    )

    @property
    def found(self) -> Oil | None:
        """The oil, if there is one."""
        cool = self.viscosity_40
        hot = self.viscosity_100
        if self.oil is not None:
            graded = Oil.of_grade(int(self.oil.removeprefix(GRADE)), self.viscosity_index)
            cool = graded.viscosity_40
            hot = graded.viscosity_100
        if cool is None or hot is None:
            return None
        return Oil(cool, hot, self.density, self.pressure_viscosity)

    def film(self, contact: Any, speed: float) -> Film | None:
        """The film in a smooth contact whose surfaces roll with a speed, m/s, if there is oil."""
        oil = self.found
        return None if oil is None else self._kind(contact, speed, *self._at(oil, speed))

    @property
    def _kind(self) -> Callable[..., Film]:
        return Film

    def _at(self, oil: Oil, speed: float) -> tuple[float, float, float]:
        """Viscosity, Pa s, its pressure coefficient, 1/Pa, and share that is left of the film at a speed."""
        at = self.temperature
        viscosity = oil.viscosity(at)
        left = inlet_heating(viscosity, oil.thinning(at), speed, oil.conductivity)
        return viscosity, oil.pressure_viscosity_at(at), left

    def damping(self, film: Film, force: float) -> float:
        """Damping of a contact under a force, N, with its film, N s/m."""
        if self.damping_time is None:
            return film.damping(force)
        return self.damping_time * film.stiffness(force)

    def problems(self) -> Iterator[InputError]:
        """Both viscosities, of an oil that can be."""
        if self.viscosity_40 is not None and self.viscosity_100 is None:
            yield InputError("viscosity_100", "nothing", "the viscosity at 100 degC, beside viscosity_40")
            return
        try:
            if (oil := self.found) is not None:
                self._at(oil, 1.0)
        except InputError as error:
            yield error.about("viscosity_index" if self.oil else "viscosity_100")


class RollerLubricantKeys(LubricantKeys):
    """The oil between rollers and raceways, of which contacts are full."""

    formula: str = key(
        Choice(tuple(LINES)),
        "pan",
        "formula of the film: of Pan and Hamrock, or of Dowson, Higginson and Toyoda",
        goes_with=_WITH_OIL,
    )

    @property
    def _kind(self) -> Callable[..., Film]:
        return partial(LineFilm, fit=self.formula)
