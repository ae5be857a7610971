"""A case made finer setting by setting, on the same surface: a finer or wider texture thinned or cut."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from asperity.case.scene import Case
from asperity.errors import InputError
from asperity.scenarios.geometry import window_cells
from asperity.scenarios.textures import Textures
from asperity.schema.convergence import PATH_LENGTH
from asperity.spectra import psd
from asperity.surfaces.heightmap import HeightMap
from asperity.units import written

MOST_POINTS = 2**27
"""Points of a path that is held at once: 1 GiB."""
SHORT_WAVES = 1e-4
"""Share of the mean square slope in waves that a coarser grid does not hold, from which they are removed."""
SEGMENTS = 8
"""Segments of the spectrum in which such waves are looked for."""


def restricted(textures: Textures, spacing: float, every: int, lines: int) -> Textures:
    """Restrict textures to a layout of fewer points.

    Parameters
    ----------
    textures : Textures
        Of the finer or wider layout.
    spacing : float
        Its spacing, m.
    every : int
        Every which point is kept, in both directions; where the record starts, one is.
    lines : int
        Points across that are kept of path and strips, about the middle one; odd.

    Returns
    -------
    Textures
        The same heights at fewer points, without the waves that only the finer grid holds, if there are any.

    Raises
    ------
    InputError
        If the path is too long to be held at once.
    """
    smooth = every > 1 and _short_waves(textures.line, every) > SHORT_WAVES
    first = textures.before % every

    def along(line: NDArray[np.float64]) -> NDArray[np.float64]:
        return (_long_waves(line, every) if smooth else line)[first::every]

    def area(heights: NDArray[np.float64], phase: int, kept: int | None) -> NDArray[np.float64]:
        found = _long_waves(heights, every) if smooth else heights
        middle = heights.shape[1] // 2
        reach = (middle if kept is None else kept // 2 * every) // every * every
        return found[phase::every, middle - reach : middle + reach + 1 : every]

    def thinned(surface: HeightMap, kept: int | None) -> HeightMap:
        return replace(surface, heights=area(surface.heights, 0, kept), spacing=(wide, wide))

    wide = every * spacing
    path = _held_path(textures, spacing)
    if path is not None:
        path = HeightMap(area(path.heights, first, lines), (wide, wide), path.source)
    line = along(textures.line) if path is None else path.heights[:, path.shape[1] // 2].copy()
    strips = tuple(thinned(strip, lines) for strip in textures.strips)
    every_map = tuple(thinned(one, None) for one in textures.maps)
    before = (textures.before - first) // every
    recorded = -(-(len(textures.line) - textures.before - textures.beyond - 1) // every) + 1
    return replace(
        textures,
        maps=strips if textures.maps is textures.strips else every_map,
        strips=strips,
        path=path,
        line=line,
        start=textures.start + first * spacing,
        before=before,
        beyond=len(line) - before - recorded,
        parts={name: along(part) for name, part in textures.parts.items()},
        defects=None if textures.defects is None else textures.defects[first::every],
        trajectory=None if textures.trajectory is None else textures.trajectory[first::every],
    )


def _held_path(textures: Textures, spacing: float) -> HeightMap | None:
    """The path in memory, if there is one."""
    path = textures.path
    if path is None or isinstance(path, HeightMap):
        return path
    rows, across = path.shape
    if rows * across > MOST_POINTS:
        received = f"a path of {rows} x {across} points"
        raise InputError("path", received, f"at most {MOST_POINTS} points, to be compared on another grid")
    return HeightMap(path.rows(0, rows), (spacing, spacing))


def _short_waves(line: NDArray[np.float64], every: int) -> float:
    """Share of the mean square slope of a line in waves of less than two of every so many points."""
    wavenumber, density = psd(line, 1.0, segment=max(16, len(line) // SEGMENTS))
    slope = wavenumber**2 * density
    beyond = wavenumber > 1.1 * 0.5 / every  # the window smears what lies at the limit
    return float(slope[beyond].sum() / slope.sum()) if slope.any() else 0.0


def _long_waves(heights: NDArray[np.float64], every: int) -> NDArray[np.float64]:
    """Heights (n, ...) without waves of less than two of every so many points, by cosine series."""
    found = heights
    for axis, points in enumerate(heights.shape):
        series = np.moveaxis(fft.dct(found, axis=axis), axis, 0)
        series[points // every + 1 :] = 0.0  # term k has the wavelength 2 points/k
        found = fft.idct(np.moveaxis(series, 0, axis), axis=axis)
    return np.asarray(found)


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
