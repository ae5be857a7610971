"""Spectra of what a measured file holds: those that its picture draws, and their CSV file."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from asperity.arguments import shown
from asperity.errors import InputError
from asperity.files import atomic_write
from asperity.reporting.figure import write_columns
from asperity.surfaces.cleaning import nearly_complete
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.measured_lines import full_lines
from asperity.surfaces.readers.hints import on_command_line, spelled
from asperity.surfaces.spectra import psd_1d, psd_radial
from asperity.terminal import say
from asperity.units import quantity

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from asperity.config.recipe import Recipe
    from asperity.surfaces.heightmap import HeightMap, Profile
    from asperity.surfaces.measured_lines import ThirdOctaves
    from asperity.surfaces.statistics import Statistic

Spectra = dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]]
"""Wavenumbers, cycles/m, above zero, and one-sided PSD, m³, by the direction of the lines."""


def spectra_of(surface: HeightMap | Profile) -> Spectra:
    """Spectra of levelled heights along x, and of a map along y; none where more than 5 % are missing."""
    if isinstance(surface, Profile):
        line = nearly_complete(surface)
        return {} if line is None else {"along the line": _above_zero(psd_1d(line))}
    whole = nearly_complete(surface)
    if whole is None:
        return {}
    return {f"along {name}": _above_zero(psd_1d(whole, axis)) for axis, name in enumerate("xy")}


def spectra_of_lines(lines: Sequence[Profile]) -> Spectra:
    """Mean of the spectra of lines side by side, of those that are as long as the others."""
    each = [_above_zero(psd_1d(line)) for line in full_lines(lines)]
    if not each:
        return {}
    return {"along the lines, mean": (each[0][0], np.mean([density for _, density in each], axis=0))}


def _above_zero(
    spectrum: tuple[NDArray[np.float64], NDArray[np.float64]],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    return spectrum[0][1:], spectrum[1][1:]


def write_spectra(spectra: Spectra, surface: HeightMap | Profile | None, path: Path) -> Path:
    """Write spectra to a CSV file; of a map also the areal one, averaged over directions."""
    pairs = {
        f"wavenumber {name} [1/m]": (wavenumber, f"PSD {name} [m³]", density)
        for name, (wavenumber, density) in spectra.items()
    }
    if isinstance(surface, HeightMap) and spectra:
        pairs["angular wavenumber [rad/m]"] = (*_areal(surface),)
    longest = max(len(first) for first, _, _ in pairs.values())
    columns = {}
    for heading, (first, title, second) in pairs.items():
        columns[heading], columns[title] = _padded(first, longest), _padded(second, longest)
    return write_columns(columns, path)


def _areal(surface: HeightMap) -> tuple[NDArray[np.float64], str, NDArray[np.float64]]:
    wavenumber, density = psd_radial(nearly_complete(surface) or surface)
    return wavenumber, "areal PSD, mean over directions [m⁴]", density


def _padded(values: NDArray[np.float64], length: int) -> NDArray[np.float64]:
    return np.concatenate([values, np.full(length - len(values), np.nan)])


def inspect(
    file: Path,
    picture: Path | None,
    *,
    psd: bool = False,
    recipe: Path | None = None,
    store: Path | None = None,
    **options: Any,
) -> dict[str, Any]:
    """Print what is in a measured file, and draw it; return what a program wants to know.

    The ending of `picture` names its format; by default its name is made of those of file, array and map, in
    the working folder. `psd` says whether the spectra go to a CSV file beside the picture. Options are the
    keys of a recipe as they are typed, lengths with their units, angles with theirs or in degrees; `recipe`
    is a file with others, `store` the one to write them all to.
    """
    from asperity.config.parsing import Origin, validated
    from asperity.config.recipe import Recipe, read_measured, recipe_text
    from asperity.surfaces.steps import stepped

    typed = _typed(recipe, options)
    steps = validated(Recipe, typed, Origin("options"))
    array, index, lines = steps.array, steps.index, steps.lines
    chosen = [str(part) for part in (array, index) if part is not None]
    if picture is None:
        picture = Path(
            "-".join([file.stem, *(re.sub(r"[^\w.]+", "-", part) for part in chosen), "surface.png"])
        )
    formats = (".png", ".pdf", ".svg")
    if picture.suffix.lower() not in formats:
        raise InputError("picture", f"'{picture}'", f"a name that ends in {', '.join(formats)}")
    if picture.resolve() == file.resolve():
        raise InputError("picture", f"'{picture}'", "another name than that of the measured file")
    with spelled(on_command_line):
        surfaces = read_measured(file, **steps.hints)
        side_by_side = tuple(stepped(line, **steps.steps) for line in _as_lines(surfaces, lines))
        if not side_by_side:
            surfaces = [stepped(surface, **steps.steps) for surface in surfaces]
    if store is not None:
        atomic_write(store, lambda stream: stream.write(recipe_text(typed).encode()))
        say(f"Recipe: {store.resolve()}")
    title = ", ".join(filter(None, [file.name, array, "" if index is None else f"map {index}"]))
    told = {"file": str(file.resolve()), "array": array, "index": index, **_sizes(surfaces), "warnings": []}
    if side_by_side:
        return told | _inspect_lines(side_by_side, title, picture, steps, psd=psd)
    return told | _inspect_first(surfaces, title, picture, steps, psd=psd)


def _typed(recipe: Path | None, options: dict[str, Any]) -> dict[str, Any]:
    """Keys of a recipe from a file with the options that are given beside it, or these alone."""
    from asperity.config.recipe import read_recipe, typed_recipe

    given = {name: value for name, value in options.items() if value is not None and value is not False}
    if (lines := options.get("lines")) is not None:
        given["lines"] = lines
    if "direction" in given:
        given["direction"] = _angle(given["direction"])
    if "crop" in given:
        given["crop"] = [part.strip() for part in given["crop"].split(",")]
    if recipe is None:
        return given
    read_recipe(recipe)
    return typed_recipe(recipe) | given


def _inspect_first(
    surfaces: list[HeightMap | Profile], title: str, picture: Path, steps: Recipe, *, psd: bool
) -> dict[str, Any]:
    """Print what is in the first of maps, or in a line, and draw it."""
    from asperity.cli.inspecting import spectra_of
    from asperity.surfaces.heightmap import Profile

    say(f"{title}: {described(surfaces)}")
    first = surfaces[0].levelled()
    if len(surfaces) > 1:
        say(f"Statistics of the first of {len(surfaces)} maps; choose another one with --index.")
        title += f", the first of {len(surfaces)} maps"
    found = statistics_of(first, steps)
    for line in statistics_lines(found):
        say(line)
    homogeneous, line = homogeneity_of(first)
    for part in line.splitlines():
        say(part)
    spectra = spectra_of(first)
    octaves, told = _against_limit([first] if isinstance(first, Profile) else [])
    drawn = _draw(first, title, picture, spectra, octaves)
    say(f"Picture: {drawn.resolve()}")
    return told | {
        "statistics": [_documented(item) for item in found],
        "material_ratio": _material_ratio(first.heights),
        "homogeneity": homogeneous,
        "files": {"picture": str(drawn.resolve())} | _written_spectra(spectra, first, picture, wanted=psd),
    }


def _written_spectra(
    spectra: Spectra, surface: HeightMap | Profile | None, picture: Path, *, wanted: bool
) -> dict[str, str]:
    """Write the spectra beside the picture, where that is wanted; they need complete heights."""
    from asperity.cli.inspecting import write_spectra

    if not wanted:
        return {}
    if not spectra:
        received = "more than 5 % of points without a height"
        raise InputError("--psd", received, "nearly complete heights", "Fill them with --fill.")
    name = f"{picture.stem.removesuffix('-surface')}-psd.csv"
    path = write_spectra(spectra, surface, picture.with_name(name))
    say(f"Spectra: {path.resolve()}")
    return {"psd": str(path.resolve())}


def _angle(text: str) -> str:
    """An angle with its unit; a bare number is in degrees."""
    allowed = "an angle, as 30 (degrees) or '0.5 rad'"
    for angle in (text, f"{text} deg"):
        try:
            if math.isfinite(quantity(angle, "rad")):
                return angle
        except InputError:
            continue
    raise InputError("--direction", shown(text), allowed)


def _sizes(surfaces: list[HeightMap | Profile]) -> dict[str, Any]:
    """Number of surfaces, and points, sizes and spacings, m, of each."""
    import numpy as np

    first = surfaces[0]
    return {
        "count": len(surfaces),
        "shape": first.shape,
        "size": np.atleast_1d(first.size),
        "spacing": np.atleast_1d(first.spacing),
        "missing_share": max(surface.missing_share for surface in surfaces),
    }


def _documented(item: Statistic) -> dict[str, Any]:
    return {
        "symbol": item.symbol,
        "value": item.value,
        "unit": item.unit,
        "bandwidth": item.bandwidth,
        "meaning": item.meaning,
    }


def _material_ratio(heights: NDArray[np.float64]) -> dict[str, Any]:
    """The material ratio curve: shares of the points, and the heights, m, that they reach."""
    from asperity.surfaces.statistics import material_ratio_curve

    ratio, height = material_ratio_curve(heights)
    return {"ratio": ratio, "height": height}


def _as_lines(surfaces: list[HeightMap | Profile], told: bool | None) -> tuple[Profile, ...]:
    """Lines side by side, where the user or the shape of an array says so; else none."""
    from asperity.surfaces.heightmap import HeightMap
    from asperity.surfaces.measured_lines import lines_of

    first = surfaces[0]
    if len(surfaces) > 1 or not isinstance(first, HeightMap):
        return ()
    return lines_of(first) if (first.holds_lines if told is None else told) else ()


def _inspect_lines(
    lines: tuple[Profile, ...], title: str, picture: Path, steps: Recipe, *, psd: bool
) -> dict[str, Any]:
    """Print what is in lines side by side, and draw them."""
    import numpy as np

    from asperity.cli.inspecting import spectra_of_lines
    from asperity.reporting.figure import write_chart
    from asperity.reporting.texture_figures import lines_chart
    from asperity.surfaces.statistics import line_statistics

    say(f"{title}: {described_lines(lines)}")
    if steps.lines is None:
        say("Taken for lines measured side by side, by its shape; --map takes it for a map.")
    levelled = [line.levelled() for line in lines]
    found = line_statistics(levelled, *_filtered(levelled[0], steps))
    say(f"Each line levelled; wavelengths {_band(found[0][0])}; mean (lowest to highest of a line):")
    for item, low, high in found:
        spread = " to ".join(_scaled(replace(item, value=value)) for value in (low, high))
        say(f"  {item.symbol:4} {_scaled(item):>12}  {item.meaning} ({spread})")
    spectra = spectra_of_lines(levelled)
    octaves, roughness = _against_limit(levelled)
    chart = lines_chart([line.heights for line in levelled], lines[0].spacing, spectra, octaves)
    drawn = write_chart(chart, title, picture)
    say(f"Picture: {drawn.resolve()}")
    return roughness | {
        "statistics": [_documented(item) | {"lowest": low, "highest": high} for item, low, high in found],
        "material_ratio": _material_ratio(np.concatenate([line.heights for line in levelled])),
        "homogeneity": None,
        "files": {"picture": str(drawn.resolve())} | _written_spectra(spectra, None, picture, wanted=psd),
    }


def _against_limit(lines: list[Profile]) -> tuple[ThirdOctaves | None, dict[str, Any]]:
    """One-third-octave levels of a rail's or wheel's lines and the limit, printed band by band."""
    from asperity.spectra import nominal
    from asperity.surfaces.measured_lines import third_octaves

    found = third_octaves(lines) if lines else None
    if found is None:
        return None, {"third_octaves": None}
    say("One-third octaves, dB re 1 µm, and the limit of EN ISO 3095:2013 for rails; by EN 15610: without")
    say("spikes, rolled over with a circle (what was processed before counts as measured):")
    say(f"  {'wavelength':>10} {'limit':>7} {'as measured':>17} {'by EN 15610':>17}")
    for row in range(len(found.wavelength)):
        limit, values = found.limit[row], (found.measured[row], found.processed[row])
        if math.isfinite(limit):
            judged = (f"{value:10.1f} {'pass' if value <= limit else 'FAIL':>6}" for value in values)
            length = f"{nominal(1e3 * found.wavelength[row]):g} mm"
            say(f"  {length:>10} {limit:7.1f} {' '.join(judged)}")
    names = ("wavelength", "limit", "measured", "processed")
    return found, {"third_octaves": {name: getattr(found, name)[found.limited] for name in names}}


def described(surfaces: list[HeightMap | Profile]) -> str:
    """Say in one line what was read."""
    import numpy as np

    first = surfaces[0]
    sizes, spacings = np.atleast_1d(first.size), np.atleast_1d(first.spacing)
    kind = "map" if len(sizes) == 2 else "line"
    many = f"{len(surfaces)} {kind}s, each" if len(surfaces) > 1 else f"a {kind} of"
    points = " × ".join(map(str, first.shape))
    extent = f"{_lengths(sizes)}, {_lengths(spacings)} apart"
    missing = max(surface.missing_share for surface in surfaces)
    return f"{many} {points} points, {extent}, {missing:.2%} without a height"


def described_lines(lines: tuple[Profile, ...]) -> str:
    """Say in one line what lines side by side are."""
    first, missing = lines[0], sum(line.missing_share for line in lines) / len(lines)
    return (
        f"{len(lines)} parallel lines, each of {len(first.heights)} points, {_lengths([first.size])}, "
        f"{_lengths([first.spacing])} apart, {missing:.2%} without a height"
    )


def _lengths(metres: Iterable[float]) -> str:
    """Lengths in the one unit that suits the largest: ``"0.8 × 0.4 mm"``."""
    found = list(metres)
    units = ((1.0, 1.0, "m"), (0.05e-3, 1e3, "mm"), (0.0, 1e6, "µm"))
    scale, unit = next((scale, unit) for least, scale, unit in units if max(found) >= least)
    return " × ".join(f"{each * scale:.4g}" for each in found) + f" {unit}"


def statistics_of(surface: HeightMap | Profile, steps: Recipe) -> list[Statistic]:
    """Roughness parameters of a levelled surface, on which these steps were taken."""
    from asperity.surfaces.heightmap import HeightMap
    from asperity.surfaces.statistics import areal_statistics, profile_statistics

    band, section = _filtered(surface, steps)
    if isinstance(surface, HeightMap):
        return areal_statistics(surface, band)
    return profile_statistics(surface, band, section)


def _filtered(surface: HeightMap | Profile, steps: Recipe) -> tuple[tuple[float, float] | None, float | None]:
    """Shortest and longest wavelength that filters left, m, and the section length of a line."""
    import numpy as np

    if steps.longest is None and steps.shortest is None:
        return None, None
    shortest = steps.shortest or 2.0 * float(np.min(surface.spacing))
    return (shortest, steps.longest or float(np.max(surface.size))), steps.longest


def statistics_lines(found: list[Statistic]) -> list[str]:
    """Lines of a table of roughness parameters."""
    head = f"Levelled; wavelengths {_band(found[0])}:"
    return [head, *(f"  {item.symbol:4} {_scaled(item):>12}  {item.meaning}" for item in found)]


def _band(item: Statistic) -> str:
    return " to ".join(_lengths([float(f"{wavelength:.3g}")]) for wavelength in item.bandwidth)


def _scaled(item: Statistic) -> str:
    if not math.isfinite(item.value):
        return "–"
    if item.unit == "rad":
        return f"{math.degrees(item.value):.0f}°"
    return f"{item.value * 1e6:.4g} µm" if item.unit == "m" else f"{item.value:.4g}"


def homogeneity_of(surface: HeightMap | Profile) -> tuple[dict[str, Any] | None, str]:
    """Whether the texture of a map is the same everywhere, as numbers and in words; nothing of a line."""
    import numpy as np

    from asperity.surfaces.cleaning import FILLED_SHARE_WARNED
    from asperity.surfaces.heightmap import HeightMap
    from asperity.surfaces.homogeneity import TILES, homogeneity
    from asperity.surfaces.levelling import level
    from asperity.surfaces.likeness import FLAT

    if not isinstance(surface, HeightMap) or min(surface.shape) < 2 * max(TILES):
        return None, ""
    whole, what = nearly_complete(surface), "Homogeneity, Std and spectra are those of"
    if whole is None:
        least = f"a map with at least {1.0 - FILLED_SHARE_WARNED:.0%} of its points"
        return None, f"{what} {least}: --fill fills missing points."
    if np.ptp(level(whole).heights) <= FLAT:
        return None, "Homogeneity: a plane has no texture to be tested"
    found = homogeneity(whole)
    tiles = " × ".join(map(str, found.tile_rms.shape))
    verdict = "the same everywhere, as far as chance tells"
    if not found.homogeneous:
        verdict = "not the same everywhere: a piece of it does not stand for another"
    line = (
        f"Homogeneity: mean squares of {tiles} tiles vary by {100 * found.variation:.0f} %, of stationary "
        f"textures like it by {100 * found.expected:.0f} % (p = {found.p_value:.2g}): {verdict}"
    )
    if surface.missing_share:
        line += f"\n{what} the map with its missing points, {surface.missing_share:.2g} of all, interpolated."
    numbers = {
        "variation": found.variation,
        "expected": found.expected,
        "p_value": found.p_value,
        "homogeneous": bool(found.homogeneous),
    }
    return numbers, line


def _draw(
    surface: HeightMap | Profile,
    title: str,
    picture: Path,
    spectra: Spectra,
    octaves: ThirdOctaves | None = None,
) -> Path:
    """Draw a levelled surface and its spectra to a PNG, PDF or SVG file."""
    from asperity.reporting.figure import write_chart
    from asperity.reporting.texture_figures import surface_chart
    from asperity.surfaces.heightmap import HeightMap

    spacing = surface.spacing if isinstance(surface, HeightMap) else (surface.spacing, surface.spacing)
    return write_chart(surface_chart(surface.heights, spacing, spectra, octaves), title, picture)
