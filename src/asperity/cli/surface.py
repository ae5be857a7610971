"""What a measured file holds, in words, as numbers and as a picture: size, statistics, spectra and limits."""

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import asdict, replace
from itertools import zip_longest
from pathlib import Path
from typing import Any

import numpy as np

from asperity.arguments import Array, given_options
from asperity.case import surface as recipes
from asperity.errors import InputError, percent
from asperity.files import write_bytes
from asperity.parameters import Origin
from asperity.ranks import Ranked
from asperity.reporting.figure import write_chart
from asperity.reporting.texture_figures import lines_chart, surface_chart, with_octaves
from asperity.spectra import nominal
from asperity.surfaces import cleaning, likeness, statistics
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.surfaces.levelling import level
from asperity.surfaces.measured_lines import ThirdOctaves, full_lines, lines_of, third_octaves
from asperity.surfaces.readers import read_all
from asperity.surfaces.readers.belief import larger_reading, typical_slope
from asperity.surfaces.readers.hints import on_command_line, spelled
from asperity.surfaces.readers.text import COLUMNS
from asperity.surfaces.spectra import psd_1d, psd_radial
from asperity.terminal import say
from asperity.text_files import write_csv
from asperity.written_numbers import rounded

Surfaces = Sequence[HeightMap | Profile]
Spectra = dict[str, tuple[Array, Array]]
"""Wavenumbers, cycles/m, above zero, and one-sided PSD, m³, by the direction of the lines."""
AREAL = "areal"
SLOPE_POINTS = 2 * statistics.MARGIN + 1
RAILS = 1e-4
"""Spacing of points, m, from which on they are those of a rail or a wheel."""
KILOMETRES = 100.0 / 3.6
"""Speed of rails and wheels, m/s."""


def show_surface(
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
    keys of a recipe as they are typed, with their units; `recipe` is a file with others, `store` the one to
    write them all to.
    """
    typed = _typed(recipe, options)
    steps = recipes.Recipe.read(typed, Origin("options"))
    array = steps.array
    index = steps.index
    if picture is None:
        chosen = [re.sub(r"[^\w.]+", "-", str(part)) for part in (array, index) if part is not None]
        picture = Path("-".join([file.stem, *chosen, "surface.png"]))
    if picture.resolve() == file.resolve():
        raise InputError("picture", f"'{picture}'", "another name than that of the measured file")
    title = ", ".join(filter(None, [file.name, array, "" if index is None else f"map {index}"]))
    levelled, sizes = _levelled(file, steps, title)
    if store is not None:
        write_bytes(store, recipes.recipe_text(typed).encode())
        say(f"Recipe: {store.resolve()}")
    contents, spectra = _show(levelled, sizes["count"], title, picture, steps, psd)
    say(f"Picture: {picture.resolve()}")
    files = {"picture": picture}
    if psd:
        files["psd"] = _write_spectra(spectra, picture)
        say(f"Spectra: {files['psd'].resolve()}")
    return {"file": file.resolve(), "array": array, "index": index, **sizes, **contents, "files": files}


def _typed(recipe: Path | None, options: dict[str, Any]) -> dict[str, Any]:
    """Keys of a recipe from a file with the options that are given beside it, or these alone."""
    given = given_options(options)
    given = {name: value for name, value in given.items() if value is not False or name == "lines"}
    if "crop" in given:
        given["crop"] = [part.strip() for part in given["crop"].split(",")]
    if recipe is None:
        return given
    recipes.read_recipe(recipe)
    return recipes.typed_recipe(recipe) | given


def _levelled(
    file: Path, steps: recipes.Recipe, title: str
) -> tuple[list[HeightMap | Profile], dict[str, Any]]:
    """Read a file, say what it holds, and return its lines or its first map, levelled, and sizes of all.

    Heights as they were read are kept no longer: evaluations take no more memory than they need.
    """
    with spelled(on_command_line):
        read: Surfaces = read_all(file, **steps.hints)
        lines = _side_by_side(read, steps.lines)
        surfaces = [steps.stepped(each) for each in lines or read]
    say(f"{title}: {described(surfaces)}")
    if COLUMNS in (source := surfaces[0].source):
        say(f"Columns taken: {source.partition(COLUMNS)[2]}.")
    if told := scale_in_words(surfaces[0]):
        say(told)
    sized = read if lines else surfaces
    sizes = {
        "count": len(sized),
        "shape": sized[0].shape,
        "size": np.atleast_1d(sized[0].size),
        "spacing": np.atleast_1d(sized[0].spacing),
        "missing_share": max(surface.missing_share for surface in sized),
    }
    shown = len(surfaces) if isinstance(surfaces[0], Profile) else 1
    del read, lines, sized
    return [level(surfaces.pop(0), overwrite=True) for _ in range(shown)], sizes


def _side_by_side(surfaces: Surfaces, wanted: bool | None) -> tuple[Profile, ...]:
    """Lines side by side, where the user or the shape of an array says so; else none."""
    first = surfaces[0]
    if len(surfaces) > 1 or not isinstance(first, HeightMap):
        return ()
    return lines_of(first) if (first.holds_lines if wanted is None else wanted) else ()


# --- maps and lines


def _show(
    levelled: list[HeightMap | Profile],
    count: int,
    title: str,
    picture: Path,
    steps: recipes.Recipe,
    psd: bool,
) -> tuple[dict[str, Any], Spectra]:
    """Print what is in lines, or in the first of a count of maps, and draw it; return numbers and spectra.

    Spectra where they are asked for, with the areal one of a map. Lines are gone when they are drawn: what
    draws takes room.
    """
    first = levelled[0]
    lines = [each for each in levelled if isinstance(each, Profile)]
    beside = len(lines) > 1
    if beside and steps.lines is None:
        say("Taken for lines measured side by side, by its shape; --map takes it for a map.")
    elif count > 1 and not beside:
        say(f"Statistics of the first of {count} maps; choose another one with --index.")
        title += f", the first of {count} maps"
    band, section = _filtered(first, steps)
    if isinstance(first, HeightMap):
        spectra = _spectra_of_map(first)
        items = [(item, item.value, item.value) for item in statistics.areal_statistics(first, band)]
        chart = surface_chart(first.heights, first.spacing, spectra)
    else:
        spectra = _spectra_of_lines(lines)
        items = statistics.line_statistics(lines, band, section)
        chart = lines_chart([line.heights for line in lines], first.spacing, spectra)
    if not psd:
        spectra = {}  # they are drawn, and as long as the line
    ratio = _material_ratio([each.heights for each in lines or levelled[:1]])
    octaves = _third_octaves(lines)  # last of all: lines are processed where they stand
    if octaves is not None:
        chart = with_octaves(chart, octaves)
    of_map = first if isinstance(first, HeightMap) else None
    del first, lines
    levelled.clear()
    lead = "Each line levelled" if beside else "Levelled"
    waves = _band(items[0][0])
    say(f"{lead}; wavelengths {waves}{'; mean (lowest to highest of a line)' * beside}:")
    for item, *ends in items:
        spread = " to ".join(_scaled(replace(item, value=value)) for value in ends)
        say(f"  {item.symbol:4} {_scaled(item):>12}  {item.meaning}{f' ({spread})' * beside}")
    unknown = [item.symbol for item, *_ in items if math.isnan(item.value)]
    if slopes := [symbol for symbol in unknown if symbol[1:] in ("dq", "dr")]:
        say(f"No {' and no '.join(slopes)}: slopes by ISO 4287 take {SLOPE_POINTS} points in a row.")
    homogeneous = None if of_map is None else _homogeneity(of_map)
    write_chart(chart, title, picture)
    if of_map is not None and spectra:
        spectra[AREAL] = psd_radial(cleaning.nearly_complete(of_map) or of_map)
    rows = [asdict(item) | ({"lowest": low, "highest": high} if beside else {}) for item, low, high in items]
    told = {"statistics": rows, "homogeneity": homogeneous, "material_ratio": ratio}
    return told | {"third_octaves": _limited(octaves)}, spectra


def _material_ratio(heights: Sequence[Array]) -> dict[str, Array]:
    """Shares of points and heights, m, that they reach."""
    ratio, height = statistics.material_ratio_curve(Ranked(heights))
    return {"ratio": ratio, "height": height}


def _limited(octaves: ThirdOctaves | None) -> dict[str, Array] | None:
    """One-third octaves for which there is a limit."""
    if octaves is None:
        return None
    names = ("wavelength", "limit", "measured", "processed")
    return {name: getattr(octaves, name)[octaves.limited] for name in names}


def _spectra_of_map(surface: HeightMap) -> Spectra:
    """Spectra of levelled heights along x and along y; none where more than 5 % are missing."""
    whole = cleaning.nearly_complete(surface)
    each = [psd_1d(whole, axis) for axis in (0, 1)] if whole else []
    return {f"along {name}": (k[1:], psd[1:]) for name, (k, psd) in zip("xy", each, strict=False)}


def _spectra_of_lines(lines: list[Profile]) -> Spectra:
    """Mean spectrum of levelled lines of full length; none where each lacks more than 5 %."""
    each = [psd_1d(line) for line in full_lines(lines)]
    name = "along the lines, mean" if len(lines) > 1 else "along the line"
    return {name: (each[0][0][1:], np.mean([psd[1:] for _, psd in each], axis=0))} if each else {}


def _write_spectra(spectra: Spectra, picture: Path) -> Path:
    """Write spectra to a CSV file beside the picture; they need complete heights."""
    if not spectra:
        received = "more than 5 % of points without a height"
        raise InputError("--psd", received, "nearly complete heights", "Fill them with --fill.")
    heading: list[str] = []
    for name in spectra:
        titles = [f"wavenumber {name} [1/m]", f"PSD {name} [m³]"]
        areal = ["angular wavenumber [rad/m]", "areal PSD, mean over directions [m⁴]"]
        heading += areal if name == AREAL else titles
    columns = (values.tolist() for pair in spectra.values() for values in pair)
    name = f"{picture.stem.removesuffix('-surface')}-psd.csv"
    return write_csv(picture.with_name(name), heading, zip_longest(*columns, fillvalue=math.nan))


# --- in words


def described(surfaces: Surfaces) -> str:
    """Say in one line what was read: a map or a line, several maps, or lines side by side."""
    first = surfaces[0]
    shares = [surface.missing_share for surface in surfaces]
    sizes = np.atleast_1d(first.size)
    spacings = np.atleast_1d(first.spacing)
    count = len(surfaces)
    is_map = isinstance(first, HeightMap)
    many = f"a {'map' if is_map else 'line'} of"
    if count > 1:
        many = f"{count} maps, each" if is_map else f"{count} parallel lines, each of"
    missing = max(shares) if is_map else sum(shares) / count
    points = " × ".join(map(str, first.shape))
    extent = f"{_lengths(sizes)}, {_lengths(spacings)} apart"
    without = f"{percent(missing)} without a height" if missing else "all with a height"
    return f"{many} {points} points, {extent}, {without}"


def scale_in_words(surface: HeightMap | Profile) -> str:
    """Slope from point to point, by which a wrong unit shows, and frequencies of the waves held."""
    slope = typical_slope(surface)
    if slope is None:
        return ""
    waves = float(np.max(surface.size)), 2.0 * float(np.min(surface.spacing))
    speed, name = (KILOMETRES, "100 km/h") if waves[1] >= 2.0 * RAILS else (1.0, "1 m/s")
    held = " to ".join(_lengths([float(f"{wave:.3g}")]) for wave in waves)
    passed = " to ".join(_frequency(speed / wave) for wave in waves)
    angle = f"{rounded(math.degrees(math.atan(slope)), 2)}°"
    return (
        f"Slopes from point to point: {rounded(slope, 2)} ({angle}). Waves of {held} pass with "
        f"{passed} at {name}. {larger_reading(surface)}"
    ).rstrip()


def _frequency(hertz: float) -> str:
    return f"{rounded(hertz / 1e3)} kHz" if hertz >= 1e3 else f"{rounded(hertz)} Hz"


def _lengths(metres: Iterable[float]) -> str:
    """Lengths in the one unit that suits the largest: ``"0.8 × 0.4 mm"``."""
    lengths = list(metres)
    units = ((1.0, 1.0, "m"), (0.05e-3, 1e3, "mm"), (0.0, 1e6, "µm"))
    scale, unit = next((scale, unit) for least, scale, unit in units if max(lengths) >= least)
    return " × ".join(rounded(length * scale, 4) for length in lengths) + f" {unit}"


def _filtered(
    surface: HeightMap | Profile, steps: recipes.Recipe
) -> tuple[tuple[float, float] | None, float | None]:
    """Shortest and longest wavelength that filters left, m, and the section length of a line."""
    if steps.longest is None and steps.shortest is None:
        return None, None
    shortest = steps.shortest or 2.0 * float(np.min(surface.spacing))
    return (shortest, steps.longest or float(np.max(surface.size))), steps.longest


def _band(item: statistics.Statistic) -> str:
    return " to ".join(_lengths([float(f"{wavelength:.3g}")]) for wavelength in item.bandwidth)


def _scaled(item: statistics.Statistic) -> str:
    if not math.isfinite(item.value):
        return "–"
    if item.unit == "rad":
        return f"{math.degrees(item.value):.0f}°"
    return f"{rounded(item.value * 1e6, 4)} µm" if item.unit == "m" else rounded(item.value, 4)


def _homogeneity(surface: HeightMap) -> dict[str, Any] | None:
    """Print whether the texture of a map is the same everywhere; return its numbers, none of a small one."""
    if min(surface.shape) < 2 * max(statistics.TILES):
        return None
    whole = cleaning.nearly_complete(surface)
    what = "Homogeneity, Std and spectra are those of"
    if whole is None:
        share = f"{1.0 - cleaning.FILLED_SHARE_WARNED:.0%}"
        say(f"{what} a map with at least {share} of its points: --fill fills missing points.")
        return None
    if np.ptp(level(whole).heights) <= likeness.FLAT:
        say("Homogeneity: a plane has no texture to be tested")
        return None
    found = statistics.homogeneity(whole)
    tiles = " × ".join(map(str, found.tile_rms.shape))
    verdict = "the same everywhere, as far as chance tells"
    if not found.homogeneous:
        verdict = "not the same everywhere: a piece of it does not stand for another"
    say(
        f"Homogeneity: mean squares of {tiles} tiles vary by {100 * found.variation:.0f} %, of stationary "
        f"textures like it by {100 * found.expected:.0f} % (p = {rounded(found.p_value, 2)}): {verdict}"
    )
    if surface.missing_share:
        missing = rounded(surface.missing_share, 2)
        say(f"{what} the map with its missing points, {missing} of all, interpolated.")
    names = ("variation", "expected", "p_value")
    return {name: getattr(found, name) for name in names} | {"homogeneous": bool(found.homogeneous)}


def _third_octaves(lines: list[Profile]) -> ThirdOctaves | None:
    """One-third-octave levels of a rail's or wheel's lines, which are gone, and the limit, printed band by
    band."""
    found = third_octaves(lines, overwrite=True) if lines else None
    if found is None:
        return None
    say("One-third octaves, dB re 1 µm, and the limit of EN ISO 3095:2013 for rails; by EN 15610: without")
    say("spikes, rolled over with a circle (what was processed before counts as measured):")
    say(f"  {'wavelength':>10} {'limit':>7} {'as measured':>17} {'by EN 15610':>17}")
    bands = zip(found.wavelength, found.limit, found.measured, found.processed, strict=True)
    for wavelength, limit, *levels in bands:
        if math.isfinite(limit):
            judged = " ".join(f"{value:10.1f} {'pass' if value <= limit else 'FAIL':>6}" for value in levels)
            say(f"  {f'{nominal(1e3 * wavelength):g} mm':>10} {limit:7.1f} {judged}")
    return found
