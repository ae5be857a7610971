"""Which laws a case can roll over its surface, and which it rolls where it names none."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from pydantic import model_validator

from asperity.config.case import Case, Law, problems_of_laws
from asperity.config.form import Section, key
from asperity.errors import InputError
from asperity.laws import Need, names, spec_of

ROLLED = ("areal", "shifted", "printed", "table", "linear-filtered", "linear")
"""Laws that are rolled where a case names none, as far as its surface allows them."""
SMOOTH = "hertz-filtered"
"""Main law of those where there is no sample of the surface."""


class LawsOfSurface(Case):
    """A case whose laws are those that its surface has the texture for."""

    laws: tuple[Law, ...] = key(ROLLED, "laws of the contact force; the first is the main one")

    @model_validator(mode="before")
    @classmethod
    def _laws_that_the_surface_allows(cls, data: Any) -> Any:
        """Leave out of the default laws those that need more texture than there is."""
        if not isinstance(data, Mapping) or "laws" in data:
            return data
        surface = data.get("surface")
        keys = surface.given() if isinstance(surface, Section) else surface
        if not isinstance(keys, Mapping):
            return data
        areal = {"spectrum", "lateral"} <= keys.keys()
        line = "line" in keys or ("spectrum" in keys and not areal)
        samples = areal or not keys.keys().isdisjoint(("file", "rms"))
        return {**data, "laws": _rolled(line=line, samples=samples)}

    def default_of(self, name: str) -> Any:
        """Value of a key that is left out: laws as the surface allows them."""
        if name == "laws":
            return _rolled(line=self.surface.has_line, samples=self.surface.has_samples)
        return super().default_of(name)


def problems_of_surface_laws(case: Case) -> Iterator[InputError]:
    """Laws, each once, that need no more texture than there is."""
    yield from problems_of_laws(case)
    for law in sorted(set(case.laws)):
        if case.surface.has_line and spec_of(law).needs_areal_path:
            allowed = "laws that need no texture beside the line: " + _listed(line=True)
            yield InputError("laws", f'"{law}" with a path given as a line', allowed)
        elif not case.surface.has_samples and Need.SAMPLES in spec_of(law).needs:
            remedy = 'Give samples as well: file = "…" or rms = "…" in [surface].'
            allowed = _listed(line=True, samples=False)
            yield InputError("laws", f'"{law}" without samples of the surface', allowed, remedy)
    if case.contact.linearise == "rough" and not case.surface.has_samples:
        yield InputError("contact.linearise", '"rough" without samples of the surface', '"hertz"')


def _allowed(*, line: bool, samples: bool = True) -> list[str]:
    """Laws that can be rolled over a line, without or with samples of the surface."""
    return [
        name
        for name in names()
        if not (line and spec_of(name).needs_areal_path)
        and (samples or Need.SAMPLES not in spec_of(name).needs)
    ]


def _listed(*, line: bool, samples: bool = True) -> str:
    return ", ".join(f'"{name}"' for name in _allowed(line=line, samples=samples))


def _rolled(*, line: bool, samples: bool) -> tuple[str, ...]:
    """Laws of a case that names none."""
    if not line:
        return ROLLED
    allowed = _allowed(line=True, samples=samples)
    return (*(() if samples else (SMOOTH,)), *(law for law in ROLLED if law in allowed))
