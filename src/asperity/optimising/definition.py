"""What an optimisation asks: a quantity of a case, limits, and the texture by its one-third octaves."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeVar

import numpy as np
from xarray import DataTree

from asperity.arguments import Array, FilePath, Flags
from asperity.case import any_case, cases, form, rolled_over, scene
from asperity.case.speed import refuse_course
from asperity.case.surface import DEFECTS, LEVEL, Surface
from asperity.errors import InputError
from asperity.optimising.allocation import Limits
from asperity.optimising.kinds import optimisation_of
from asperity.parameters import LENGTH, Choice, ListOf, Number, Origin, Quantity, key, optional
from asperity.scenarios import preparing, records
from asperity.scenes import noise, schema
from asperity.schema import Entry, spectra
from asperity.spectra import HALF_BAND, a_weighting, energy_of, third_octave_bands
from asperity.surfaces.bands import band_levels_of
from asperity.surfaces.heightmap import HeightMap, Profile
from asperity.written_numbers import count_of, rounded

C = TypeVar("C", bound=scene.Case)
A_WEIGHTED, ACCELERATION = "A-weighted level", "rms acceleration"
"""What a texture may be judged by."""
ROWS = 2**17
"""Most rows of a path whose levels are taken."""
HOLLOW = 80.0
"""Bands so far below the highest, dB, hold no texture."""
LOWEST_HEARD = 20.0
"""Hz."""
FEWEST_BANDS = 2


@dataclass(frozen=True)
class Measure:
    """A quantity that textures of a kind of case are judged by."""

    meaning: str  # what it is the level of
    units: str  # of the level
    # its energy per Hz (f,) relative to the square of its reference, of a law in a result
    energy: Callable[[DataTree, str], Array]
    weighted: bool = True  # as the ear does, line by line

    def density(self, tree: DataTree, law: str) -> Array:
        """Energy per Hz (f,) relative to the square of its reference, weighted."""
        weight = energy_of(a_weighting(line_frequencies(tree))) if self.weighted else 1.0
        return weight * self.energy(tree, law)


def measures_of(case: scene.Case) -> dict[str, Measure]:
    """What textures of a case are judged by, by name: sound where a track is rolled over, else motion."""
    if isinstance(case.rolled_over, rolled_over.TrackKeys):
        without = ", without the wheel" if noise.silent_wheel(case) else ""
        power = f"sound power level from vibration, A-weighted{without}"
        at_points = "acceleration level of the rail at the points passed by, energy mean"
        return {
            A_WEIGHTED: Measure(power, "dB(A) re 1 pW", _sound_power, weighted=False),
            ACCELERATION: Measure(at_points, "dB re 1e-6 m/s²", _of_points, weighted=False),
        }
    if case.rolled_over.sensor_positions:
        meaning = f"acceleration level of the {case.over_name}, energy mean over its sensors"
        return {
            A_WEIGHTED: Measure(f"{meaning}, A-weighted", "dB(A) re 1e-6 m/s²", _of_sensors),
            ACCELERATION: Measure(meaning, "dB re 1e-6 m/s²", _of_sensors, weighted=False),
        }
    meaning = "contact force level, energy mean over the contacts, A-weighted"
    return {A_WEIGHTED: Measure(meaning, "dB(A) re 1 N", partial(_psd, spectra.FORCE_PSD))}


def line_frequencies(tree: DataTree) -> Array:
    """Frequencies of the spectra of a result (f,), Hz."""
    return np.asarray(tree[spectra.FREQUENCY.path].values)


def _psd(entry: Entry, tree: DataTree, law: str) -> Array:
    """PSD of a law over frequency (f,), mean over the places at which it is known."""
    found = tree[entry.group].to_dataset()[entry.name].sel(law=law)
    places = [dim for dim in found.dims if dim != spectra.FREQUENCY.name]
    return found.mean(places).values


def _of_sensors(tree: DataTree, law: str) -> Array:
    return _psd(schema.ACCELERATION_PSD, tree, law) / schema.ACCELERATION_REFERENCE**2


def _of_points(tree: DataTree, law: str) -> Array:
    velocity = _psd(schema.POINT_VELOCITY_PSD, tree, law)
    return velocity * (2.0 * np.pi * line_frequencies(tree) / schema.ACCELERATION_REFERENCE) ** 2


def _sound_power(tree: DataTree, law: str) -> Array:
    """The total of a run, A-weighted by bands as its page tells it, shared over lines as the force is."""
    held = tree[schema.RADIATED_POWER_LEVEL.group].to_dataset()
    power = held[schema.RADIATED_POWER_LEVEL.name].sel(law=law, radiator="total").values
    centre = held[spectra.BAND.name].values
    frequency = line_frequencies(tree)
    force = _psd(spectra.FORCE_PSD, tree, law)
    step = frequency[1] - frequency[0]
    density = np.zeros_like(force)
    for middle, level in zip(centre, power + a_weighting(centre), strict=True):
        inside = np.abs(np.log10(frequency / middle)) <= 0.05
        if force[inside].sum() > 0.0 and np.isfinite(level):
            density[inside] = energy_of(level) * force[inside] / (force[inside].sum() * step)
    return density


# --- the texture


@dataclass(frozen=True, eq=False)
class Bands:
    """A texture by its one-third octaves of wavelength, the longest first."""

    wavelength: Array  # (n,), centres, m
    levels: Array  # (n,), dB re 1 µm
    changed: Flags  # (n,), which of them may be changed
    lateral: float | None  # correlation length across over that along; None of a line

    def with_changed(self, levels: Array, lateral: float | None) -> "Bands":
        """The same with other levels of those that may be changed."""
        every = self.levels.copy()
        every[self.changed] = levels
        return replace(self, levels=every, lateral=lateral)

    @property
    def table(self) -> Array:
        """Wavelengths and levels side by side (n, 2), as a case takes them."""
        return np.stack([self.wavelength, self.levels], axis=1)

    def edges(self, speed: float) -> tuple[Array, Array]:
        """Frequencies, Hz, between which the changed bands are passed at a speed, m/s."""
        centre = np.concatenate([third_octave_bands(1.0 / w, 1.0 / w)[0] for w in self.changed_wavelength])
        return speed * centre / HALF_BAND, speed * centre * HALF_BAND

    @property
    def changed_wavelength(self) -> Array:
        """Centres of the bands that may be changed, m."""
        return self.wavelength[self.changed]


def bands_of(case: scene.Case, longest: float | None, shortest: float | None) -> Bands:
    """Take the bands of a case's texture: of its spectrum, else of its path.

    Those between two wavelengths, m, may be changed; by default those that are heard, from 20 Hz to the
    highest frequency of the spectra. Waves that the grid of the contact cannot hold are left out.
    """
    refuse_course(case.speed, "where bands of a texture are heard at frequencies")
    surface = case.surface
    lateral = surface.lateral
    if lateral is None and not surface.has_line:
        lateral = 1.0 / surface.anisotropy if surface.rms is not None else 1.0
    if surface.spectrum is not None:
        wavelength, levels, _ = records.spectrum_levels(surface.spectrum)
        levels = levels + surface.level
    else:
        wavelength, levels = _measured(case)
    held = wavelength / HALF_BAND > 2.06 * case.contact.spacing
    wavelength = wavelength[held]
    levels = levels[held]
    low = longest or case.speed / LOWEST_HEARD
    high = shortest or case.speed / case.numerics.highest_frequency
    changed = (wavelength < low * HALF_BAND) & (wavelength > high / HALF_BAND)
    if np.count_nonzero(changed) < FEWEST_BANDS:
        bands = count_of(int(np.count_nonzero(changed)), "band")
        received = f"{bands} of the texture between {rounded(high)} m and {rounded(low)} m"
        allowed = f"at least {FEWEST_BANDS}"
        remedy = (
            f"Its bands are {rounded(wavelength.min())} m to {rounded(wavelength.max())} m. "
            "Change longest or shortest."
        )
        raise InputError("bands that may be changed", received, allowed, remedy)
    return Bands(wavelength, levels, changed, lateral)


def _measured(case: scene.Case) -> tuple[Array, Array]:
    """Levels of the path, mean over its lines, at the wavelengths that it holds, the longest first."""
    textures = preparing.prepare(case).textures
    spacing = case.contact.spacing
    line = Profile(textures.line - textures.line.mean(), spacing)
    if textures.path is None:
        wavelength, levels = band_levels_of(line)
    else:
        heights = textures.path.rows(0, min(textures.path.shape[0], ROWS))
        wavelength, levels = band_levels_of(HeightMap(heights - heights.mean(), (spacing, spacing)))
    full = levels > levels.max() - HOLLOW
    order = np.argsort(-wavelength[full])
    return wavelength[full][order], levels[full][order]


def with_texture(case: C, bands: Bands) -> C:
    """The case over a texture of these bands; defects and other bodies stay as they are."""
    keys = case.given()
    sources = Surface.keys.keys() - set(DEFECTS)
    kept = {name: value for name, value in keys.get("surface", {}).items() if name not in sources}
    lay = {} if bands.lateral is None else {"lateral": bands.lateral}
    keys["surface"] = kept | {"spectrum": bands.table} | lay
    return type(case)(**keys)


_HEAD = """\
# The texture that rolls quietest, or the roughest that keeps a limit. Run it with: asperity optimise FILE
# The case: its path, from the folder of this file, or a section [case] with its keys.

case = "case.toml"

"""
_TEXTURES = "10 nm to 10 m: textures lie between"
_LEVELS = "-200 dB to 120 dB: 1e-10 um to 1 m in one band"
_RMS = "1 pm to 1 mm: rms heights lie between"
_PRICE = Number(at_least=0)


class Aim(form.Section):
    """What the texture of a case shall be."""

    quantity: str = key(
        Choice((A_WEIGHTED, ACCELERATION)),
        A_WEIGHTED,
        "what it is judged by: sound power of a wheel, else motion; or the unweighted acceleration",
    )
    limit: float | None = optional(
        LEVEL,
        "100 dB",
        "level of the quantity that is kept: the roughest texture is sought, by its price",
        "the quantity is made as small as the bounds allow",
        "-400 dB to 400 dB: levels lie between",
    )
    law: str = key(any_case.LAW, "areal", "law of the contact force that is rolled while searching")
    verify: str = key(any_case.LAW, "table", "law with which the texture is rolled before and after")
    longest: float | None = optional(
        LENGTH, "10 mm", "longest wavelength that is changed", "the longest that is heard", _TEXTURES
    )
    shortest: float | None = optional(
        LENGTH, "100 um", "shortest wavelength that is changed", "the shortest that is heard", _TEXTURES
    )
    reach: float = key(
        Quantity("dB", above=0),
        "20 dB",
        "how far levels may go from those of the case where no bound is given",
        "0.01 dB to 100 dB: five powers of ten are another surface",
    )
    lowest: tuple[float, ...] | None = optional(
        ListOf(LEVEL),
        ["-40 dB"],
        "least level of a one-third octave, dB re 1 um: one for all, or one for each from the longest",
        "the reach below that of the case",
        _LEVELS,
    )
    highest: tuple[float, ...] | None = optional(
        ListOf(LEVEL),
        ["+10 dB"],
        "largest level of a one-third octave, dB re 1 um: one for all, or one for each from the longest",
        "the reach above that of the case",
        _LEVELS,
    )
    rms_at_least: float | None = optional(
        LENGTH,
        "0.5 um",
        "least rms height of these wavelengths together, as friction or oil asks for",
        "any",
        _RMS,
    )
    rms_at_most: float | None = optional(
        LENGTH, "2 um", "largest rms height of these wavelengths together", "any", _RMS
    )
    price: tuple[float, ...] = key(
        ListOf(_PRICE),
        (1.0,),
        "price of lowering a one-third octave by 1 dB, which raising it saves: one for all, or one for each "
        "from the longest",
    )
    budget: float | None = optional(_PRICE, 30.0, "largest price of all changes together", "any")
    lateral: tuple[float, ...] | None = optional(
        ListOf(Number(above=0)),
        [0.5, 2.0],
        "least and largest correlation length across over that along: the lay, which is chosen between",
        "as it is in the case",
    )

    def problems(self) -> Iterator[InputError]:
        """Something that keeps the texture from being as smooth as it may be; bounds in order."""
        if self.limit is None and self.rms_at_least is None and self.budget is None:
            remedy = "Give rms_at_least, or budget with price; or a limit to be kept."
            allowed = "something that keeps it rough: without, the smoothest is the quietest"
            yield InputError("rms_at_least", "nothing, and no budget", allowed, remedy)
        if self.rms_at_least and self.rms_at_most and self.rms_at_least > self.rms_at_most:
            yield InputError("rms_at_least", f"{self.rms_at_least:g} m", "at most rms_at_most")
        if self.longest and self.shortest and self.longest < self.shortest:
            yield InputError("longest", f"{self.longest:g} m", "at least shortest")
        if self.limit is not None and not any(self.price):
            yield InputError("price", "only zeros", "a price that tells which roughness is worth more")
        if self.lateral is not None and not (len(self.lateral) == 2 and self.lateral[0] < self.lateral[1]):
            yield InputError("lateral", list(self.lateral), "two numbers, the least first")

    def limits(self, start: Array) -> Limits:
        """Limits of levels (b,), dB re 1 µm, around those that the search starts from."""
        return Limits(
            start,
            _for_each("lowest", self.lowest, start - self.reach),
            _for_each("highest", self.highest, start + self.reach),
            _for_each("price", self.price, np.ones_like(start)),
            np.inf if self.budget is None else self.budget,
            self.rms_at_least or 0.0,
            self.rms_at_most or np.inf,
        )


def _for_each(name: str, values: tuple[float, ...] | None, otherwise: Array) -> Array:
    if values is None:
        return otherwise
    if len(values) not in (1, len(otherwise)):
        raise InputError(name, count_of(len(values), "value"), f"one, or {len(otherwise)}: one for each band")
    return np.broadcast_to(np.array(values), otherwise.shape)


def load_aim(path: FilePath) -> tuple[any_case.AnyCase, form.Section]:
    """Read a case, and what its texture shall be, from TOML: ``case``, a path or a section, and its aim."""
    remedy = "Check the path, or write one with 'asperity new optimisation > optimisation.toml'."
    keys, base, origin = cases.read_with_case(path, "optimisation", remedy)
    case = cases.case_of(base, origin)
    return case, optimisation_of(case).aim.read(keys, Origin.file(path))


def aim_template() -> str:
    """A commented case and aim."""
    return _HEAD + any_case.commented(Aim, {"rms_at_least": '"0.5 um"'})
