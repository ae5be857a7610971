"""A case made finer setting by setting, on the same surface: a finer or wider texture thinned or cut."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from scipy import fft
from xarray import DataTree

from asperity.arguments import Array
from asperity.case import beam, rolled_over
from asperity.case.scene import Case
from asperity.errors import InputError
from asperity.scenarios.geometry import window_cells
from asperity.scenarios.scene import PreparedCase
from asperity.scenarios.textures import Textures
from asperity.schema import contact
from asperity.schema.convergence import PATH_LENGTH
from asperity.spectra import psd
from asperity.structures.rail_poles import POLES
from asperity.surfaces.heightmap import HeightMap
from asperity.units import written
from asperity.written_numbers import count_of, rounded

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

    def along(line: Array) -> Array:
        return (_long_waves(line, every) if smooth else line)[first::every]

    def area(heights: Array, phase: int, kept: int | None) -> Array:
        found = _long_waves(heights, every) if smooth else heights
        middle = heights.shape[1] // 2
        reach = (middle if kept is None else kept // 2 * every) // every * every
        return found[phase::every, middle - reach : middle + reach + 1 : every]

    def thinned(surface: HeightMap, kept: int | None) -> HeightMap:
        return replace(surface, heights=area(surface.heights, 0, kept), spacing=(wide, wide))

    wide = every * spacing
    path = textures.path
    if path is not None:
        rows, across = path.shape
        if rows * across > MOST_POINTS:
            received = f"a path of {rows} x {across} points"
            raise InputError(
                "path", received, f"at most {MOST_POINTS} points, to be compared on another grid"
            )
        path = HeightMap(area(path.rows(0, rows), first, lines), (wide, wide))
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
        trajectory=None if textures.trajectory is None else textures.trajectory[first::every],
    )


def _short_waves(line: Array, every: int) -> float:
    """Share of the mean square slope of a line in waves of less than two of every so many points."""
    wavenumber, density = psd(line, 1.0, segment=max(16, len(line) // SEGMENTS))
    slope = wavenumber**2 * density
    beyond = wavenumber > 1.1 * 0.5 / every  # the window smears what lies at the limit
    return float(slope[beyond].sum() / slope.sum()) if slope.any() else 0.0


def _long_waves(heights: Array, every: int) -> Array:
    """Heights (n, ...) without waves of less than two of every so many points, by cosine series."""
    found = heights
    for axis, points in enumerate(heights.shape):
        series = np.moveaxis(fft.dct(found, axis=axis), axis, 0)
        series[points // every + 1 :] = 0.0  # term k has the wavelength 2 points/k
        found = fft.idct(np.moveaxis(series, 0, axis), axis=axis)
    return found


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
    # function (coarser, finer ready case) that makes the coarser one roll over the surface of the finer one;
    # None where textures are not laid out anew
    laid_anew: Callable[[Any, Any], Any] | None = None


def on_the_surface_of(small: PreparedCase, large: PreparedCase) -> PreparedCase:
    """A case on the textures of a finer or wider one, restricted to its own grid and window."""
    spacing = large.case.contact.spacing
    every = round(small.case.contact.spacing / spacing)
    lines = window_cells(small.case.contact)
    points = restricted(large.textures.points or large.textures, spacing, every, lines)
    return replace(small, textures=points.over_cells() if small.shape.cells == "covered" else points)


def settings_of_scene(prepared: PreparedCase, result: DataTree) -> list[Setting]:
    """All settings of a case that was run, whose states its result has."""
    states = result[contact.APPROACH.group].to_dataset()[contact.APPROACH.name].values
    return settings_for(prepared, states)


def settings_for(prepared: PreparedCase, approaches: Array) -> list[Setting]:
    """All settings of a case; `approaches` (k,), m, are the states of the run.

    The grid gets nodes between its own: window, strips and time step stay.
    """
    case = prepared.case
    textures = prepared.textures
    spacing = case.contact.spacing
    window = case.contact.window
    count = case.contact.samples
    half = window_cells(case.contact) // 2
    step = case.time_step
    strip = {}
    fine = 0.5 * spacing
    wider = (4 * half + 1) * spacing
    narrower = (2 * (half // 2) + 1) * spacing
    if textures.strips:  # a little less than they are, so that no rounding lengthens them
        rows = min(each.shape[0] for each in textures.strips)
        strip = {"contact.sample_length": rows * textures.strips[0].spacing[0] * (1 - 1e-9)}
    finer = {"contact.spacing": fine, "contact.window": 0.5 * wider, "numerics.time_step": step} | strip
    long = {name: max(length, 2.001 * wider) for name, length in strip.items()}
    middles = 0.5 * (approaches[1:] + approaches[:-1])
    every = np.sort(np.concatenate([approaches, middles])).tolist()
    windows = (
        Way(f"{_length(window)} → {_length(wider)}", {"contact.window": wider} | long),
        Way(f"{_length(window)} → {_length(narrower)}", {"contact.window": narrower}, coarser=True),
    )
    more = Way(f"{count} → {2 * count}", {"contact.samples": 2 * count})
    denser = Way(f"{len(approaches)} → {count_of(len(every), 'state')}", {"contact.approaches": tuple(every)})
    steps = f"{rounded(1e6 * step, 4)} µs → {rounded(5e5 * step, 4)} µs"
    shorter = Way(steps, {"numerics.time_step": 0.5 * step})
    reduced = [
        Setting("window", windows, laid_anew=on_the_surface_of),
        Setting("samples", (more,)),
        Setting("approaches", (denser,)),
    ]
    if not textures.maps:
        reduced = [Setting(each.name, (), NO_SAMPLES) for each in reduced]
    grid = Setting(
        "grid", (Way(f"{_length(spacing)} → {_length(fine)}", finer),), laid_anew=on_the_surface_of
    )
    half_path = Way(f"{rounded(case.rolled_time)} s → its first half")
    return [
        grid,
        *reduced,
        Setting("time step", (shorter,)),
        *_own_settings(case),
        Setting(PATH_LENGTH, (half_path,)),
    ]


def _own_settings(case: Case) -> list[Setting]:
    """How finely what is rolled over is resolved: modes of a beam, or the kernel behind a track's poles."""
    over = case.rolled_over
    if isinstance(over, rolled_over.TrackKeys):
        if case.numerics.kernel != "poles":
            return [Setting("poles", (), "the rail is scattered from its kernel, without poles")]
        words = f"up to {case.numerics.poles or POLES} → the kernel that they are fitted to"
        scattered = Way(words, {"numerics.kernel": "scatter", "numerics.poles": None})
        return [Setting("poles", (scattered,))]
    if not isinstance(over, beam.BeamKeys):
        return []
    before = over.highest_mode(case.numerics.highest_frequency)
    words = f"up to {written(before, 'Hz', 'kHz')} → up to {written(2.0 * before, 'Hz', 'kHz')}"
    return [Setting("modes", (Way(words, {f"{case.over_name}.modes_up_to": 2.0 * before}),))]


def _length(length: float) -> str:
    return written(length, "m", "um" if length < 1e-3 else "mm").replace("um", "µm")
