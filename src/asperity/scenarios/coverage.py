"""Which one-third octaves of frequency the roughness of a case covers at its speed, and whether levels of a
file are those of anything that rolls."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from asperity.arguments import Array
from asperity.case.in_memory import name_of
from asperity.case.scene import Case
from asperity.case.tables import MEASURED_WAVE, columns_of_levels
from asperity.errors import InputError, OutOfRangeWarning
from asperity.reference import cnossos
from asperity.scenarios.records import spectrum_levels
from asperity.scenarios.textures import Textures
from asperity.spectra import HALF_BAND, nominal_frequency, nominal_length, third_octave_bands
from asperity.speeds import slowest
from asperity.surfaces.bands import likely_band
from asperity.written_numbers import rounded

HEARD = (100.0, 5000.0)
"""Hz, of the bands that count: those in which laws are compared, and which rolling noise is heard in."""
FEWEST = 0.5
"""Share of the bands below which levels in the others are doubted: waves of 400 mm to 3.15 mm, as measured on
rails, cover two thirds of them from 4 m/s to 150 m/s."""

FEWEST_LEVELS = 6
"""Bands of 400 mm to 3.15 mm from which on levels are held against the limit for rails."""
SMOOTHER, ROUGHER = 15.0, 30.0
"""Below and above that limit, in the mean, dB, from where on levels of a file are doubted. Sixty lines that
were measured on rails and the classes of CNOSSOS lie between 9 below and 4 above, wheels with flats 10 above.
Wavelengths ten times too long lower rails to some 20 below; ten times too short, they raise them by 13 at
most, and rails with corrugation are as rough, so that nothing is said."""


@dataclass(frozen=True, eq=False)
class Coverage:
    """What one texture covers."""

    key: str  # of the case
    name: str  # of a file or a spectrum
    waves: tuple[float, float]  # longest and shortest, m
    bands: Array  # centres of all bands that count, Hz
    covered: Array  # of those that it covers
    columns: str = ""  # of a table with several of levels: those that count, and those that do not

    def at(self, speed: float) -> str:
        """Say it of a speed, m/s."""
        longest, shortest = map(nominal_length, self.waves)
        share = f"{len(self.covered)} of {len(self.bands)} one-third octaves from "
        share += " to ".join(map(nominal_frequency, self.bands[[0, -1]]))
        held = ""
        if len(self.covered):
            ends = list(dict.fromkeys(map(nominal_frequency, self.covered[[0, -1]])))
            held = f", {'those from' if len(ends) > 1 else 'that of'} {' to '.join(ends)}"
        levels = f" ({self.columns})" * bool(self.columns)
        at = f"{speed:.4g} m/s" if slowest(speed) == speed else f"{slowest(speed):.4g} to {speed:.4g} m/s"
        return f"{self.name}{levels}, waves of {longest} to {shortest}: at {at} {share}{held}"


def coverages(case: Case, textures: Textures) -> Iterator[Coverage]:
    """What spectra, measured lines and measured maps of a case cover."""
    wheel = ("wheel", case.rolling, "roughness")
    for part, section, key in (("rail", case.surface, "spectrum"), wheel):
        name = f"{'surface' if part == 'rail' else case.ROLLING}.{key}"
        if (spectrum := getattr(section, key, None)) is not None:
            wavelength, _, called = spectrum_levels(spectrum)
            found = _covered(case, name, called, float(wavelength[0]), float(wavelength[-1]))
            yield replace(found, columns="" if isinstance(spectrum, str) else columns_of_levels(spectrum))
        elif section.line is not None and (lines := textures.lines.get(part)):
            longest = max(line.size for line in lines)
            shortest = 2.0 * lines[0].spacing
            yield _covered(case, name.replace(key, "line"), name_of(section.line), longest, shortest)
    if case.surface.file is not None and textures.maps:
        measured = textures.maps[0]
        longest = max(measured.size)
        shortest = 2.0 * max(measured.spacing)
        yield _covered(case, "surface.file", name_of(case.surface.file), longest, shortest)


def _covered(case: Case, key: str, name: str, longest: float, shortest: float) -> Coverage:
    highest = min(HEARD[1], case.numerics.highest_frequency)
    bands, _, _ = third_octave_bands(min(HEARD[0], 0.1 * highest), highest)
    lowest = case.speed / longest / HALF_BAND
    top = slowest(case.speed) / shortest * HALF_BAND
    return Coverage(key, name, (longest, shortest), bands, bands[(bands >= lowest) & (bands <= top)])


def doubt_levels(case: Case) -> None:
    """Warn of a file of levels far beside the limit for rails: of wavelengths or a reference that are
    wrong."""
    at, limit = cnossos.rail_roughness("iso3095")
    for key, spectrum in (
        ("surface.spectrum", case.surface.spectrum),
        (f"{case.ROLLING}.roughness", getattr(case.rolling, "roughness", None)),
    ):
        if not isinstance(spectrum, Path):
            continue
        wavelength, level, name = spectrum_levels(spectrum)
        held = likely_band(wavelength)
        if held.sum() < FEWEST_LEVELS:
            continue
        allowed = np.interp(np.log(wavelength[held]), np.log(at[::-1]), limit[::-1])
        beside = float(np.mean(level[held] - allowed))
        if -SMOOTHER <= beside <= ROUGHER:
            continue
        where = f"{rounded(abs(beside), 2)} dB {'above' if beside > 0.0 else 'below'}"
        usual = f"up to {SMOOTHER:g} dB below and {ROUGHER:g} dB above"
        OutOfRangeWarning.warn(
            f"{key}: the levels of {name} are, in the mean from 400 mm to 3.15 mm, {where} the limit of EN "
            f"ISO 3095 for rails; those of rails and wheels are {usual}. "
            "Are the wavelengths in their unit, and the levels re 1 µm?"
        )


def problems_of_coverage(case: Case, textures: Textures) -> Iterator[InputError]:
    """Errors about spectra and lines without a wave in any band that counts, where nothing else is rough.

    Those with waves in few of them are doubted.
    """
    surface = case.surface
    if case.has_defect or surface.file is not None or surface.corrugation is not None:
        return
    found = list(coverages(case, textures))
    covered = {float(band) for each in found for band in each.covered}
    if not found or len(covered) >= FEWEST * len(found[0].bands):
        return
    first = found[0]
    speed = case.speed
    ends = slowest(speed) / first.bands[-1], speed / first.bands[0]
    usual = " to ".join(f"{rounded(1e3 * each)} mm" for each in ends)
    remedy = f"At this speed they are heard by waves of {usual}. Is the unit of the wavelengths right?"
    if not covered and first.waves[1] > MEASURED_WAVE:
        yield InputError(first.key, first.at(speed), "waves that are heard at the speed of the case", remedy)
        return
    told = "; ".join(each.at(speed) for each in found)
    smooth = "In all others the surfaces are smooth, and levels say nothing."
    OutOfRangeWarning.warn(f"{first.key}: {told}. {smooth} {remedy}")
