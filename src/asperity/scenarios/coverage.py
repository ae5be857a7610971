"""Which one-third octaves of frequency the roughness of a case covers at its speed."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from asperity.arguments import Array
from asperity.case.form import name_of
from asperity.case.scene import Case
from asperity.case.tables import MEASURED_WAVE, columns_of_levels
from asperity.errors import InputError, OutOfRangeWarning
from asperity.scenarios.records import spectrum_levels
from asperity.scenarios.textures import Textures
from asperity.spectra import HALF_BAND, nominal_frequency, nominal_length, third_octave_bands
from asperity.speeds import slowest
from asperity.written_numbers import rounded

HEARD = (100.0, 5000.0)
"""Hz, of the bands that count: those in which laws are compared, and which rolling noise is heard in."""
FEWEST = 0.5
"""Share of the bands below which levels in the others are doubted: waves of 400 mm to 3.15 mm, as measured on
rails, cover two thirds of them from 4 m/s to 150 m/s."""


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
            held = f", those from {' to '.join(map(nominal_frequency, self.covered[[0, -1]]))}"
        levels = f" ({self.columns})" * bool(self.columns)
        return f"{self.name}{levels}, waves of {longest} to {shortest}: at {speed:.4g} m/s {share}{held}"


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


def problems_of_coverage(case: Case, textures: Textures) -> Iterator[InputError]:
    """Errors about spectra without a wave in any band that counts, as no roughness is measured.

    Those with waves in few of them are doubted.
    """
    surface = case.surface
    others = (surface.file, surface.line, surface.corrugation, case.rolling.line)
    if case.has_defect or any(other is not None for other in others):
        return
    found = list(coverages(case, textures))
    covered = {float(band) for each in found for band in each.covered}
    if not found or len(covered) >= FEWEST * len(found[0].bands):
        return
    first = found[0]
    speed = case.speed
    usual = " to ".join(f"{rounded(1e3 * speed / first.bands[end])} mm" for end in (-1, 0))
    remedy = f"At this speed they are heard by waves of {usual}. Is the unit of the wavelengths right?"
    if not covered and first.waves[1] > MEASURED_WAVE:
        yield InputError(first.key, first.at(speed), "waves that are heard at the speed of the case", remedy)
        return
    told = "; ".join(each.at(speed) for each in found)
    smooth = "In all others the surfaces are smooth, and levels say nothing."
    OutOfRangeWarning.warn(f"{first.key}: {told}. {smooth} {remedy}")
