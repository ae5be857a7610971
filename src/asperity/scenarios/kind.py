"""What a kind of case has to offer: a folder of modules, each imported when it is first asked for."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from dataclasses import dataclass
from types import ModuleType
from typing import TYPE_CHECKING, Any

from asperity.schema import contact, convergence, provenance, rolling, spectra, surface

if TYPE_CHECKING:
    import warnings

    import numpy as np
    import xarray
    from numpy.typing import NDArray

    from asperity.config.case import Case
    from asperity.progress import Progress
    from asperity.reporting.figure import Chapter
    from asperity.scenarios.geometry import Geometry
    from asperity.scenarios.laws import OwnContact
    from asperity.scenarios.measure import Measure
    from asperity.scenarios.preparing import PreparedCase
    from asperity.scenarios.refining import Setting
    from asperity.scenarios.textures import Textures

SHARED = (provenance, surface, contact, rolling, spectra, convergence)
"""What the results of all kinds hold."""
USUAL = "asperity.scenes"
"""What a kind offers that says nothing of its own."""


@dataclass(frozen=True)
class Words:
    """What a commented case of a kind says beside its keys."""

    title: str  # one sentence: what rolls over what
    sources: str  # where texture may come from, as the end of a sentence
    # values, in TOML, of keys that have no default and shall stand in the case
    written_out: Mapping[str, str]


@dataclass(frozen=True)
class Kind:
    """A kind of case, by the folder that holds all there is about it; of a small one, by its only file.

    Attributes
    ----------
    folder : str
        Its package, in which these modules stand, or one module with all their names. Where one body rolls
        over another the first three are enough: `asperity.scenes` has the others.

        ========== ===================================================================================
        case       ``CASE``, the class of its cases; ``WORDS`` and ``ROLLING``, the section of what rolls
        bodies     ``bodies_of(case)``, the scene: what rolls and what is rolled over;
                   ``geometry_of(case)``, what presses on what on the contact grid
        textures   ``textures_of(case)``; ``warn_of(case, shape, textures)``, before anything is computed
        compute    ``compute(prepared, progress)``, from textures to runs
        result     ``layout(computed, caught, brief)``, the tree of a run
        chapters   ``CHAPTERS`` of its report
        plan       ``rows(prepared)``, what will be computed, in words;
                   ``settings_of(case)``, how finely its bodies are resolved; ``MEASURES``, by name what
                   textures are judged by
        ========== ===================================================================================
    """

    folder: str

    def offers(self, module: str, name: str) -> Any:
        """What stands under a name in a module of the folder, or in the one file; else what is usual."""
        for place in (f"{self.folder}.{module}", self.folder, f"{USUAL}.{module}"):
            found = getattr(_module(place), name, None)
            if found is not None:
                return found
        raise AttributeError(f"{self.folder} offers no {name}, and none is usual")

    @property
    def case(self) -> type[Case]:
        """Class of its cases."""
        found: type[Case] = self.offers("case", "CASE")
        return found

    @property
    def words(self) -> Words:
        """What a commented case says beside its keys."""
        found: Words = self.offers("case", "WORDS")
        return found

    @property
    def rolling(self) -> str:
        """The section of the case that describes what rolls."""
        return str(self.offers("case", "ROLLING"))

    def bodies_of(self, case: Case) -> Any:
        """Build the bodies of a case."""
        return self.offers("bodies", "bodies_of")(case)

    def geometry_of(self, case: Case) -> Geometry:
        """Lay out the bodies of a case on the contact grid."""
        found: Geometry = self.offers("bodies", "geometry_of")(case)
        return found

    def contacts_of(self, case: Case, loads: NDArray[np.float64]) -> tuple[list[int], list[OwnContact]]:
        """Which law each contact rolls by: 0 for that of the first, k for that of the k-th that differs.

        Static loads (c,), N. With the contacts that differ from the first.
        """
        found: tuple[list[int], list[OwnContact]] = self.offers("textures", "contacts_of")(case, loads)
        return found

    def textures_of(self, case: Case) -> Textures:
        """Gather the textures of a case."""
        found: Textures = self.offers("textures", "textures_of")(case)
        return found

    def warn_of(self, case: Case, shape: Geometry, textures: Textures) -> None:
        """Warn of what is doubtful before anything is computed."""
        self.offers("textures", "warn_of")(case, shape, textures)

    def computed(
        self,
        prepared: PreparedCase,
        progress: Progress,
        caught: list[warnings.WarningMessage],
        *,
        brief: bool = False,
    ) -> xarray.DataTree:
        """Compute a case and lay out its result, in brief without what only its report shows.

        Warnings of laying out may be added to `caught`.
        """
        computed = self.offers("compute", "compute")(prepared, progress)
        found: xarray.DataTree = self.offers("result", "layout")(computed, caught, brief=brief)
        return found

    @property
    def schema(self) -> tuple[ModuleType, ...]:
        """Modules with the entries of its result."""
        return (*SHARED, importlib.import_module(f"{USUAL}.schema"))

    @property
    def measures(self) -> Mapping[str, Measure]:
        """What its textures are judged by, by name."""
        found: Mapping[str, Measure] = self.offers("plan", "MEASURES")
        return found

    @property
    def chapters(self) -> tuple[Chapter, ...]:
        """Chapters of its report, and the last one of all kinds."""
        return (*self.offers("chapters", "CHAPTERS"), self.offers("chapters", "UNCERTAINTY"))

    def settings_of(self, case: Case) -> list[Setting]:
        """How finely its bodies are resolved, beside what all kinds have."""
        found: list[Setting] = self.offers("plan", "settings_of")(case)
        return found

    def plan(self, name: str) -> Any:
        """What it says of its work under a name, see above."""
        return self.offers("plan", name)


def _module(place: str) -> ModuleType | None:
    """The module, if there is one of that name."""
    try:
        return importlib.import_module(place)
    except ModuleNotFoundError as error:
        if error.name != place:  # one that it needs is not there
            raise
        return None
