"""Settings that a case can be computed with more finely, to see how far its result depends on them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from asperity.config.case import Case
from asperity.scenarios.geometry import window_cells
from asperity.scenarios.textures import Textures
from asperity.schema.convergence import PATH_LENGTH
from asperity.units import written

NO_SAMPLES = "nothing is reduced from samples here"


@dataclass(frozen=True)
class Way:
    """One way of changing a setting."""

    words: str  # from what to what
    # keys of the case with their new values, in SI
    changes: Mapping[str, Any] = field(default_factory=dict)
    coarser: bool = False  # textures of the case hold those of the changed one, not the other way round


@dataclass(frozen=True)
class Setting:
    """What can be made finer."""

    name: str
    ways: tuple[Way, ...]  # the first that the case allows is taken
    limit: str = ""  # why there is no way
    # whether textures are laid out anew: the surface of the finer case is then restricted for the coarser one
    laid_anew: bool = False
    scans_kept: bool = False  # whether all scans of the case are found in the cache


def shared_settings(
    case: Case, textures: Textures, approaches: NDArray[np.float64]
) -> tuple[list[Setting], list[Setting]]:
    """Settings that all kinds of case have: those named before what a kind has of its own, and after it.

    `approaches` (k,), m, are the states of the run.
    """
    samples = bool(textures.maps)
    first = [
        Setting("grid", (_finer_grid(case, textures),), laid_anew=True),
        _with_samples("window", samples, (_wider(case, textures), _narrower(case)), laid_anew=True),
        _with_samples("samples", samples, (_more_samples(case),)),
        _with_samples("approaches", samples, (_denser(approaches),)),
        Setting("time step", (_shorter_step(case),), scans_kept=True),
    ]
    return first, [Setting(PATH_LENGTH, (Way(f"{_time(case.rolled_time)} → its first half"),))]


def _with_samples(name: str, samples: bool, ways: tuple[Way, ...], *, laid_anew: bool = False) -> Setting:
    """A setting of the reduction, which a case without samples has not."""
    return Setting(name, ways, laid_anew=laid_anew) if samples else Setting(name, (), NO_SAMPLES)


def _finer_grid(case: Case, textures: Textures) -> Way:
    """Half the spacing, with nodes between those of the grid: window, strips and time step stay."""
    spacing, half = case.contact.spacing, window_cells(case.contact) // 2
    changes = {
        "contact.spacing": 0.5 * spacing,
        "contact.window": (4 * half + 1) * 0.5 * spacing,
        "numerics.time_step": case.time_step,
    }
    return Way(f"{_length(spacing)} → {_length(0.5 * spacing)}", changes | _strip_length(textures))


def _wider(case: Case, textures: Textures) -> Way:
    spacing, half = case.contact.spacing, window_cells(case.contact) // 2
    window = (4 * half + 1) * spacing
    kept = {name: max(length, 2.001 * window) for name, length in _strip_length(textures).items()}
    return Way(f"{_length(case.contact.window)} → {_length(window)}", {"contact.window": window} | kept)


def _narrower(case: Case) -> Way:
    spacing, half = case.contact.spacing, window_cells(case.contact) // 2
    window = (2 * (half // 2) + 1) * spacing
    words = f"{_length(case.contact.window)} → {_length(window)}"
    return Way(words, {"contact.window": window}, coarser=True)


def _strip_length(textures: Textures) -> dict[str, float]:
    """Strips for the filters as long as they are, m; a little less, so that no rounding lengthens them."""
    if not textures.strips:
        return {}
    rows = min(strip.shape[0] for strip in textures.strips)
    return {"contact.sample_length": rows * textures.strips[0].spacing[0] * (1 - 1e-9)}


def _more_samples(case: Case) -> Way:
    count = case.contact.samples
    return Way(f"{count} → {2 * count}", {"contact.samples": 2 * count})


def _denser(approaches: NDArray[np.float64]) -> Way:
    """A state more between any two."""
    middles = 0.5 * (approaches[1:] + approaches[:-1])
    every = np.sort(np.concatenate([approaches, middles])).tolist()
    return Way(f"{len(approaches)} → {len(every)} states", {"contact.approaches": tuple(every)})


def _shorter_step(case: Case) -> Way:
    step = case.time_step
    return Way(f"{_us(step)} → {_us(0.5 * step)}", {"numerics.time_step": 0.5 * step})


def _length(length: float) -> str:
    return written(length, "m", "um" if length < 1e-3 else "mm").replace("um", "µm")


def _us(time: float) -> str:
    return f"{1e6 * time:.4g} µs"


def _time(time: float) -> str:
    return f"{time:.3g} s"
