"""What a kind of case has to offer: a folder of modules, each imported when it is first asked for."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from dataclasses import dataclass
from types import ModuleType
from typing import TYPE_CHECKING, Any

from asperity.schema import Entry, contact, provenance, rolling, spectra, surface

if TYPE_CHECKING:
    import warnings

    import xarray

    from asperity.config.case import Case
    from asperity.progress import Progress
    from asperity.reporting.chapter import Chapter
    from asperity.scenarios.geometry import Geometry
    from asperity.scenarios.preparing import Prepared
    from asperity.scenarios.textures import Textures

SHARED = (provenance, surface, contact, rolling, spectra)
"""What the results of all kinds hold."""


@dataclass(frozen=True)
class Words:
    """What a commented case of a kind says beside its keys."""

    title: str  # one sentence: what rolls over what
    sources: str  # where texture may come from, as the end of a sentence
    # values, in TOML, of keys that have no default and shall stand in the case
    written_out: Mapping[str, str]


@dataclass(frozen=True)
class Kind:
    """A kind of case, by the folder that holds all there is about it.

    Attributes
    ----------
    folder : str
        Its package. The modules below stand in it:

        ========== ===================================================================================
        case       ``CASE``, the class of its cases; ``WORDS`` and ``ROLLING``, the section of what rolls
        bodies     ``bodies_of(case)``, built from the case
        geometry   ``geometry_of(case)``, what presses on what on the contact grid
        textures   ``textures_of(case)``; ``warn_of(case, shape, textures)``, before anything is computed
        compiling  ``compile_kernels(progress)``, of all that is stepped
        compute    ``compute(prepared, progress)``, from textures to runs
        result     ``layout(computed, caught)``, the tree of a run
        schema     what its result holds beside what all results hold; ``KEPT``, what of it a study keeps:
                   entries, each with the place on its dimensions if not all of it
        chapters   ``CHAPTERS`` of its report
        plan       ``rows(case)``, what will be computed, in words; ``seconds(prepared, progress, pace)`` by
                   part of the work, s; ``step_seconds(prepared)``; ``records(case)``; ``REPORT``, s
        ========== ===================================================================================
    """

    folder: str

    def _part(self, name: str) -> Any:
        return importlib.import_module(f"{self.folder}.{name}")

    @property
    def case(self) -> type[Case]:
        """Class of its cases."""
        found: type[Case] = self._part("case").CASE
        return found

    @property
    def words(self) -> Words:
        """What a commented case says beside its keys."""
        found: Words = self._part("case").WORDS
        return found

    @property
    def rolling(self) -> str:
        """The section of the case that describes what rolls."""
        return str(self._part("case").ROLLING)

    def bodies_of(self, case: Case) -> Any:
        """Build the bodies of a case."""
        return self._part("bodies").bodies_of(case)

    def geometry_of(self, case: Case) -> Geometry:
        """Lay out the bodies of a case on the contact grid."""
        found: Geometry = self._part("geometry").geometry_of(case)
        return found

    def textures_of(self, case: Case) -> Textures:
        """Gather the textures of a case."""
        found: Textures = self._part("textures").textures_of(case)
        return found

    def warn_of(self, case: Case, shape: Geometry, textures: Textures) -> None:
        """Warn of what is doubtful before anything is computed."""
        self._part("textures").warn_of(case, shape, textures)

    def compile_kernels(self, progress: Progress) -> None:
        """Compile all that is stepped, or load it."""
        self._part("compiling").compile_kernels(progress)

    def computed(
        self, prepared: Prepared, progress: Progress, caught: list[warnings.WarningMessage]
    ) -> xarray.DataTree:
        """Compute a case and lay out its result; warnings of laying out may be added to `caught`."""
        computed = self._part("compute").compute(prepared, progress)
        found: xarray.DataTree = self._part("result").layout(computed, caught)
        return found

    @property
    def schema(self) -> tuple[ModuleType, ...]:
        """Modules with the entries of its result, its own the last."""
        return (*SHARED, self._part("schema"))

    @property
    def kept(self) -> Mapping[Entry, Mapping[str, str]]:
        """What a study keeps of its results beside what it keeps of all, and where of it."""
        found: Mapping[Entry, Mapping[str, str]] = self._part("schema").KEPT
        return found

    @property
    def chapters(self) -> tuple[Chapter, ...]:
        """Chapters of its report."""
        found: tuple[Chapter, ...] = self._part("chapters").CHAPTERS
        return found

    @property
    def plan(self) -> Any:
        """Its module ``plan``."""
        return self._part("plan")
