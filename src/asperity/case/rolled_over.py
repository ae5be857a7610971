"""What is rolled over: tracks, and structures known by their modes or receptances."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Self

from asperity.arguments import Array, given_options
from asperity.case import tables
from asperity.case.body import INERTIA, PROFILE
from asperity.case.form import Section
from asperity.case.in_memory import Numbers, name_of
from asperity.case.measured import read_decay_rates, read_mobility
from asperity.case.ready_lists import OVER_TRACKS, NamedChanges, listed_changes
from asperity.case.surface import INDEX, of_file
from asperity.errors import InputError, PhysicsWarning
from asperity.parameters import (
    LENGTH,
    LENGTH_OR_ZERO,
    MASS,
    Choice,
    File,
    ListOf,
    MaterialOrName,
    Number,
    key,
    keys_of,
    optional,
)
from asperity.reference.materials import Material
from asperity.reference.railways import TRACKS
from asperity.structures.support import (
    MeasuredSleeper,
    StiffnessTable,
    measured_sleeper,
    preloads_of,
    stiffness_at_preload,
)
from asperity.structures.track import Track
from asperity.structures.track_parameters import LAYERS, MOST_BAYS, Bays
from asperity.surfaces.heightmap import Profile
from asperity.units import written
from asperity.written_numbers import rounded

if TYPE_CHECKING:
    from asperity.structures.modal import Modal, ModalStructure

SENSOR_SHARES = (0.2, 0.35, 0.5, 0.65, 0.8)
"""Of the length of a structure, where its acceleration is recorded if the case says nothing."""
LISTED = ("sleeper_spacing", "pad_stiffness", "ballast_stiffness")
"""What a table of bays holds."""
PRELOAD_STEPS = 20
"""Steps in which the preload of pads is found, whose stiffness depends on it."""
_WIDTHS = "10 mm to 1 m: rails lie between"


class Liveliness(NamedTuple):
    """What no mode of a structure exceeds."""

    frequency: float  # of the highest, Hz
    inverse_mass: float  # squares of all mass-normalised shapes at one place, 1/kg


class RolledOver(Section):
    """What is rolled over, of whatever kind: a new one is a section with these."""

    LONGEST_WAVE: ClassVar[float] = 1.6e-3
    """Longest wave of a texture of a stated rms, m: as long as an instrument's field of view."""
    OFFERED: ClassVar[tuple[str, ...]] = ("extent", "model", "sensor_positions")

    material: Material
    sensors: tuple[float, ...] | None = None

    @property
    def radius_across(self) -> float:
        """Radius across the path, m: positive where it bulges, infinite where it is flat."""
        return math.inf

    @property
    def profile(self) -> Path | Profile | None:
        """Its measured section across the path."""
        return None

    @property
    def sides(self) -> dict[str, float]:
        """Sides of its section that a contact has to be smaller than, m, by their keys."""
        return {}

    @property
    def extent(self) -> tuple[float, float] | None:
        """Where it begins and ends, m; None of what is endless."""
        return None

    @property
    def sensor_positions(self) -> tuple[float, ...]:
        """Where its acceleration is recorded, m: as given, else at shares of its length."""
        if self.sensors is not None or self.extent is None:
            return self.sensors or ()
        first, last = self.extent
        return tuple(first + share * (last - first) for share in SENSOR_SHARES)

    @property
    def helping_changes(self) -> NamedChanges:
        """Changes that may make what rolls over it quieter; the section of what rolls stands as `wheel`."""
        return {}

    def point_positions(self, middle: float) -> tuple[float, ...]:
        """Where the rail of a track is looked at, m, of a run whose middle is there, m."""
        return ()

    def model(self, highest_frequency: float) -> Modal | Track | None:
        """Build it, as far as it moves below a frequency, Hz; None for a rigid plane."""
        return None

    def liveliest(self, highest_frequency: float) -> Liveliness:
        """Bounds of its modes below a frequency, Hz; infinite where they are not known before it is built."""
        unknown = 0.0 if self.extent is None else math.inf
        return Liveliness(unknown, unknown)

    def problems_of_run(self, speed: float, first: float, last: float) -> Iterator[InputError]:
        """What does not fit to a speed, m/s, and to places passed in the record, from and to, m."""
        yield from ()

    def problems_of_sensors(self, first: float, last: float) -> Iterator[InputError]:
        """Sensors on what begins and ends at places, m."""
        for position in self.sensors or ():
            if not first <= position <= last:
                yield InputError("sensors", f"{position:g} m", f"positions on it, {first:g} to {last:g} m")


def sensors_along(goes_with: str = "") -> Any:
    """Declare where the acceleration of what has an extent is recorded."""
    return optional(
        ListOf(LENGTH_OR_ZERO, least=1),
        ["0.2 m", "0.35 m", "0.5 m", "0.65 m", "0.8 m"],
        "positions of the accelerometers",
        "at 20, 35, 50, 65 and 80 % of the length",
        "0 m to 10 km: structures are shorter",
        goes_with=goes_with,
    )


def _scatter(of: str, most: float) -> Any:
    words = f"standard deviation over the mean of the normal distribution from which {of} are drawn"
    return key(Number(at_least=0, at_most=most), 0.0, words, goes_with="bays")


class TrackKeys(RolledOver, parameters=keys_of(Track, otherwise="of the named set")):
    """A track: a named, cited set, each single key of which overrides it; and its rail head."""

    ALTERNATIVES = (
        ("rail_head_radius", "rail_profile"),
        ("pad_table", "pad_damping"),
        ("pad_table", "pad_loss_factor"),
        ("sleeper_table", "sleeper_bending_stiffness"),
        ("bay_table", "bays"),
        *(("bay_table", each) for each in LISTED),
        *((f"{layer}_damping", f"{layer}_loss_factor") for layer in LAYERS),
    )
    LONGEST_WAVE: ClassVar[float] = 0.1

    name: str = key(Choice(tuple(TRACKS)), "x2000", "named set of parameters")
    rail_head_radius: float = key(
        LENGTH, "0.3 m", "radius of the rail head across the rail", "1 mm to 1 km: rail heads lie between"
    )
    rail_profile: Path | Profile | None = optional(
        PROFILE, "rail.csv", "measured shape of the rail head across the rail, instead of rail_head_radius"
    )
    rail_foot_width: float = key(LENGTH, "150 mm", "width of the rail's foot, which radiates", _WIDTHS)
    rail_head_width: float = key(LENGTH, "72 mm", "width of the rail's head, which radiates", _WIDTHS)
    material: Material = key(MaterialOrName(), "steel", "material of the rail")
    pad_table: Path | Array | None = optional(
        tables.TableFile(columns=(3, 4), read=tables.read_dynamic_stiffness),
        "pad.csv",
        "measured dynamic stiffness of a pad: frequency (Hz), real and imaginary part (N/m), or magnitude "
        "(N/m) and loss factor, and the preload (N) if at several; approximated in time; with pad_stiffness "
        "it is scaled to have that as its real part at 300 Hz",
    )
    pad_preload: float | None = tables.PRELOAD_KEY
    sleeper_table: Path | Array | None = optional(
        tables.TableFile(columns=(3,), read=tables.read_seat_receptance),
        "sleeper.csv",
        "measured receptance of a free sleeper at a rail seat with both pressed alike: frequency (Hz), real "
        "and imaginary part (m/N), or magnitude (m/N) and phase (deg); modes on sleeper_mass are fitted",
    )
    bays: int | None = optional(
        Number(at_least=2, at_most=MOST_BAYS, whole=True),
        20,
        "number of bays that differ, after which the track repeats",
        "all bays are alike",
    )
    spacing_scatter: float = _scatter("distances of sleepers", 0.3)
    pad_scatter: float = _scatter("stiffnesses of pads", 1)
    ballast_scatter: float = _scatter("stiffnesses of ballast", 1)
    scatter_seed: int = key(INDEX, 1, "seed of these draws", goes_with="bays")
    bay_table: Path | Array | None = optional(
        tables.TableFile(columns=(3,), read=tables.read_bays),
        "bays.csv",
        "bays one by one instead, after which the track repeats: distance to the next sleeper (m), stiffness "
        "of pad and of ballast (N/m); damping goes with stiffness",
    )
    points: tuple[float, ...] | None = optional(
        ListOf(LENGTH_OR_ZERO, least=1),
        ["9 m", "9.3 m"],
        "positions at which the motion of the rail is recorded while it is passed, from a sleeper at 0 m",
        "over a sleeper and at mid-span in the middle of the run",
        "0 m to 100 km: tracks are rolled over for less",
    )
    decay_rates: Path | Array | None = optional(
        tables.TableFile(columns=(2, 3, 5), read=read_decay_rates),
        "decay_rates.csv",
        "measured decay rates (EN 15461), which the sound power of rail and sleepers then follows, not the "
        "motion: one-third octave (Hz), vertical and, if it is there, lateral rate (dB/m), which the rail's "
        "sound sideways follows; of both rails two of each, vertical ones first",
        "those of this track",
    )
    mobility: Path | Array | None = optional(
        tables.TableFile(columns=(2, 3), read=read_mobility),
        "mobility.csv",
        "measured point mobility of the rail at mid-span, likewise: frequency (Hz), magnitude or real and "
        "imaginary part ((m/s)/N; in a file also of an accelerance or receptance, by its unit)",
        "that of this track",
    )

    @property
    def helping_changes(self) -> NamedChanges:
        """Changes that may make a case over a track quieter: pads, roughness, speed, dampers, …."""
        return listed_changes(OVER_TRACKS)

    @property
    def radius_across(self) -> float:
        """Radius of the rail head, m."""
        return self.rail_head_radius

    @property
    def profile(self) -> Path | Profile | None:
        """Its measured section across the path."""
        return self.rail_profile

    @property
    def overrides(self) -> dict[str, Any]:
        """What the case says beside the name of its set, by the keywords of `Track`, in SI."""
        told = {name: getattr(self, name) for name in keys_of(Track, "")}
        if self.sleeper_table is not None:
            told["measured_sleeper"] = self._sleeper
        if self.pad_table is not None:
            told["pad_table"] = self._pad
        if self.bay_table is not None:
            told |= dict(zip(LISTED, self._listed.mean(axis=0).tolist(), strict=True))
        return given_options(told)

    @property
    def _pad(self) -> StiffnessTable:
        """The measured pad at its preload, without one at the least of the table."""
        return stiffness_at_preload(self._pad_rows, self.pad_preload or float(preloads_of(self._pad_rows)[0]))

    @cached_property
    def _pad_rows(self) -> Array:
        assert self.pad_table is not None
        return tables.read_dynamic_stiffness(self.pad_table)

    @cached_property
    def _sleeper(self) -> MeasuredSleeper:
        assert self.sleeper_table is not None
        frequency, receptance = tables.read_seat_receptance(self.sleeper_table)
        mass: float | None = getattr(self, "sleeper_mass")  # noqa: B009
        return measured_sleeper(frequency, receptance, mass or Track.named(self.name).sleeper_mass)

    @cached_property
    def _listed(self) -> Array:
        assert self.bay_table is not None
        return tables.read_bays(self.bay_table)

    def _drawn_or_listed(self) -> Bays | None:
        """How bays differ, if they do."""
        if self.bay_table is not None:
            return Bays.listed(*self._listed.T)
        if self.bays is None:
            return None
        scatters = {"spacing": self.spacing_scatter, "pad": self.pad_scatter, "ballast": self.ballast_scatter}
        return Bays.drawn(self.bays, **scatters, seed=self.scatter_seed)

    @property
    def described_tables(self) -> Iterator[tuple[str, str]]:
        """Say which measured sleepers and pads these are, and at which preload; nothing of others."""
        if self.sleeper_table is not None:
            met = f"{self._sleeper.fitted} meet it to {rounded(self._sleeper.fit_error, 2)} dB rms"
            yield "measured sleepers", f"{name_of(self.sleeper_table)}: {met}"
        if self.pad_table is None:
            return
        preloads = preloads_of(self._pad_rows)
        said = name_of(self.pad_table)
        if self.pad_preload is not None:
            at, least, most = (1e-3 * each for each in (self.pad_preload, preloads[0], preloads[-1]))
            said += f" at {rounded(at)} kN, measured from {rounded(least)} to {rounded(most)} kN"
        yield "measured pads", f"{said}: {1e-6 * self._pad.nominal:.4g} MN/m at 300 Hz"

    def preloaded(self, load: float) -> Self:
        """With the preload of the pads, where it matters and is not given, under a wheel with this load, N.

        That of the support right below the wheel, K(0) G(0|0) of the load at rest, on pads of that preload.
        """
        if self.pad_table is None or self.pad_preload is not None or len(preloads_of(self._pad_rows)) < 2:
            return self
        carried = 0.5 * load
        told = self.overrides
        for _ in range(PRELOAD_STEPS):
            pad = stiffness_at_preload(self._pad_rows, carried)
            track = Track.named(self.name, **(told | {"pad_table": pad}))
            carried = track.support.static * track.static_deflection(load)
        return self.with_chosen(pad_preload=carried)

    @cached_property
    def _named(self) -> Track:
        """The named set with the keys of the case in it, its bays equal."""
        return Track.named(self.name, **self.overrides)

    def model(self, highest_frequency: float = math.inf) -> Track:
        """Build the track: the named set with the keys of the case in it."""
        if self.sleeper_table is not None:
            from asperity.structures.modal_fit import judge_fit

            what = f"receptance of the sleeper in {name_of(self.sleeper_table)}"
            judge_fit(what, self._sleeper.fit_error, self._sleeper.fitted)
        bays = self._drawn_or_listed()
        return replace(self._named, bays=bays) if bays else self._named

    def default_of(self, name: str) -> float | str | None:
        """Value of a key that is left out: that of the named set."""
        if name in keys_of(Track, "") and name not in self.given_names:
            value: float | None = getattr(self._named, name)
            return value
        return super().default_of(name)

    def is_active(self, name: str) -> bool:
        """Whether a key matters: one that neither the case nor the named set gives does not."""
        given = getattr(self, name) is not None or name not in keys_of(Track, "")
        return super().is_active(name) and (given or self.default_of(name) is not None)

    def point_positions(self, middle: float) -> tuple[float, ...]:
        """The points, m; by default over the sleeper nearest to the middle, m, and at mid-span after it."""
        if self.points is not None:
            return self.points
        return self.model().sleeper_near(middle)

    def problems(self) -> Iterator[InputError]:
        """A preload that decides anything; bays above zero."""
        single = self.pad_table is not None and len(preloads_of(self._pad_rows)) < 2
        if self.pad_preload is not None and single:
            received = f"{written(self.pad_preload, 'N', 'kN')} for a table that is at no preload, or at one"
            yield InputError("pad_preload", received, "a preload for a table at several", "Remove it.")
        try:
            self._drawn_or_listed()
        except InputError as error:
            yield error.about(f"{error.what.split()[0]}_scatter")

    def problems_of_run(self, speed: float, first: float, last: float) -> Iterator[InputError]:
        """A track that exists and is damped, slower passed than its waves run; points that are passed."""
        try:
            track = self.model()
        except InputError as error:
            yield error.about("track", f"{error.received} ({error.what})")
            return
        if not track.is_damped:
            remedy = "Give the rail a loss factor, or damping to pads or ballast."
            yield InputError("track", "no damping at all", "a track whose vibration dies away", remedy)
        try:
            track.refuse_speed(speed)
        except InputError as error:
            yield error.about("speed", f"{speed:g} m/s")
        for point in self.points or ():
            if not first <= point <= last:
                allowed = f"positions that are passed, {first:g} m to {last:g} m"
                yield InputError("track.points", f"{point:g} m", allowed)


_UFF = "a universal file"
_AXIS = Choice(("x", "y", "z"))


class StructureKeys(RolledOver):
    """Any structure, by its modes along the path; of a plane, its material alone."""

    ALTERNATIVES = (("file", "receptances"),)

    file: Path | ModalStructure | None = optional(
        File(held=(Numbers,)),
        "guide.csv",
        f"its modes: a text table, netCDF, or {_UFF} (.uff, .unv); or, from Python, such modes",
    )
    along: str | None = of_file(_AXIS, "x", f"direction of the path in {_UFF}", "the file is none")
    force: str | None = of_file(_AXIS, "z", f"direction of the contact force in {_UFF}", "the file is none")
    damping_ratio: float | None = of_file(
        Number(at_least=0, at_most=0.99),
        0.01,
        f"damping ratio of all modes of {_UFF} that states none",
        "from the file",
    )
    nodes: tuple[int, ...] | None = of_file(
        ListOf(INDEX),
        [1, 2, 3],
        f"numbers of the nodes along the path in {_UFF}",
        "all that have mode shapes",
    )
    receptances: Path | Array | None = optional(
        File(columns=(5,)),
        "receptances.csv",
        "its measured receptances instead, which are fitted by modes: frequency (Hz), position of the "
        "response (m), position of the force (m), real and imaginary part (m/N)",
    )
    mass: float | None = optional(
        MASS,
        "20 kg",
        "mass of the structure if nothing holds it and its rigid-body modes are not in the file",
        "something holds it, or the file has all modes",
        "1 mg to 100000 t: structures that are rolled over lie between",
        goes_with="file or receptances",
    )
    inertia: float | None = optional(
        INERTIA,
        "1.5 kg m^2",
        "its moment of inertia in pitch",
        "it does not pitch",
        "1e-12 kg m^2 to 1e12 kg m^2: structures that are rolled over lie between",
        goes_with="mass",
    )
    sensors: tuple[float, ...] | None = sensors_along("file or receptances")
    material: Material = key(MaterialOrName(), "steel", "material of its surface")

    @property
    def is_known(self) -> bool:
        """Whether there is anything that it is known by."""
        return self.file is not None or self.receptances is not None

    @property
    def modes(self) -> ModalStructure:
        """The structure by its modes, if it is known."""
        return self._made[0]

    @property
    def extent(self) -> tuple[float, float] | None:
        """Where it begins and ends, m; None of a plane."""
        return self.modes.extent if self.is_known else None

    def model(self, highest_frequency: float) -> ModalStructure | None:
        """The structure, with the warnings met when it was read or fitted; None for a plane."""
        if not self.is_known:
            return None
        modes, doubts, measured_at = self._made
        for doubt in doubts:
            warnings.warn(doubt, stacklevel=2)
        if measured_at is not None:
            from asperity.structures.modal_fit import warn_of_short_band

            warn_of_short_band("structure", measured_at, highest_frequency)
        return modes

    @cached_property
    def _made(self) -> tuple[ModalStructure, list[Warning], Array | None]:
        """Modes, what was warned of, and the frequencies of receptances, Hz, rising; None of modes."""
        with PhysicsWarning.caught() as caught:
            modes, lines = self._fitted() if self.file is None else (self._read(), None)
        return modes, [each.message for each in caught if isinstance(each.message, Warning)], lines

    def _fitted(self) -> tuple[ModalStructure, Array]:
        """Modes that meet the receptances, and the frequencies of these."""
        from asperity.structures.receptance_fit import fit_structure, receptances_in

        assert self.receptances is not None
        rows = tables.read_table(self.receptances, tables.RECEPTANCES)
        at, driven, frequency, given = receptances_in(rows, name_of(self.receptances))
        fitted = fit_structure(at, driven, frequency, given, mass=self.mass, inertia=self.inertia)
        return fitted, frequency

    def _read(self) -> ModalStructure:
        """Modes of the file, with those of the rigid body."""
        assert self.file is not None
        modes = self.file
        if isinstance(modes, Path):
            from asperity.structures.modal_files import read_modal_structure

            modes = read_modal_structure(
                modes,
                along=self.along,
                force=self.force,
                damping=self.damping_ratio,
                nodes=self.nodes,
            )
        return modes if self.mass is None else modes.with_rigid_body(self.mass, inertia=self.inertia)

    def problems(self) -> Iterator[InputError]:
        """A source that can be read, and sensors on the structure."""
        if not self.is_known:
            return
        try:
            first, last = self.modes.extent
        except InputError as error:
            name = "receptances" if self.file is None else "file"
            yield error.about(name, f"{error.received} ({error.what})")
            return
        yield from self.problems_of_sensors(first, last)
