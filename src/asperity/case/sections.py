"""How the contact is solved and reduced, how finely time is resolved, and what radiates."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from asperity.arguments import MOST_PASSES, SHAKEDOWN, Array
from asperity.case import form, measured, tables
from asperity.case.surface import LEVEL
from asperity.errors import InputError
from asperity.parameters import (
    DAMPING,
    DURATION,
    FREQUENCY,
    LENGTH,
    LENGTH_OR_ZERO,
    PRESSURE,
    Choice,
    Either,
    ListOf,
    Number,
    Quantity,
    key,
    optional,
)
from asperity.reference import cnossos, railways
from asperity.units import written

if TYPE_CHECKING:
    from asperity.radiation.pass_by import Passage, Receiver
    from asperity.radiation.sound_path import SoundPath

MOST_CELLS = 2048  # along one side of the window
_HEARD = "0 dB to 180 dB: sound that is heard lies between"
_NOTHING = "nothing was measured"


class ContactKeys(form.Section):
    """How the rough contact is solved and reduced."""

    spacing: float = optional(
        LENGTH,
        "8 um",
        "grid spacing of the contact solution",
        "a ninth of the smooth contact's smaller half-width, or a quarter of surface.shortest",
        "1 nm to 10 mm: an elastic continuum is coarser than atoms, and contacts are smaller than 10 mm",
    )
    window: float = optional(
        LENGTH,
        "0.5 mm",
        "side of the square window in which contact is solved; wider than the contact",
        "that of the smooth contact under three times the load, wider by roughness and by a flat",
        "10 nm to 1 m: contacts lie between atoms and bodies",
    )
    rim_cells: str = key(
        Choice(("auto", "whole", "covered")),
        "auto",
        "cells of the grid at the rim of a contact: whole ones are in contact or not, as in CONTACT; covered "
        "ones count as far as they are covered, so that forces grow evenly, slower; auto takes covered ones "
        "for table and direct where the texture is smooth within the contact, else whole ones",
    )
    samples: int = key(
        Number(at_least=1, at_most=10_000, whole=True),
        8,
        "number of surface samples for the stiffness and the filters",
    )
    sample_length: float | None = optional(
        LENGTH,
        "2 mm",
        "length of the strips from which filters are estimated",
        "16 windows, or the length of the map",
        "10 nm to 100 m: samples lie between contacts and bodies",
    )
    approaches: tuple[float, ...] | None = optional(
        ListOf(Quantity("m"), least=2, rising=True),
        ["-0.5 um", "0 um", "1 um"],
        "approaches at which the contact is reduced, from the plane that the nominal patch feels",
        "chosen from the load and the roughness",
        "-10 mm to 10 mm: contacts are closer than that",
    )
    damping: float = key(
        DAMPING,
        "0 N s/m",
        "damping of the contact",
        "1e-9 N s/m to 1e9 N s/m: less damps nothing, more is rigid",
    )
    friction: float = key(
        Number(above=0, at_most=1),
        0.3,
        "coefficient of friction, up to which a contact sticks: sideways, and where what rolls creeps",
    )
    hardness: float | None = optional(
        PRESSURE,
        "3 GPa",
        "largest pressure",
        "elastic contact",
        "1 kPa to 1 TPa: no solid is as soft, or as hard",
    )
    running_in: int | str | None = optional(
        Either((SHAKEDOWN,), Number(at_least=1, at_most=MOST_PASSES, whole=True)),
        "shakedown",
        "passes under the working load that samples and path have had before, in which asperities yielded, "
        "or until a pass changes nothing",
        "an untouched surface",
        goes_with="hardness",
    )
    datum: str = key(
        Choice(("samples", "path")),
        "samples",
        "from whose first touch the state r = approach + d0 counts: that of the samples (as printed), or of "
        "samples and path",
    )
    normalise: str | None = optional(
        Choice(("low-wavenumber", "tangent")),
        "tangent",
        "what the contact filter is 1 at: its own low wavenumbers (as printed), or the tangent stiffness",
        "as printed for the law printed, tangent for every other",
    )
    linearise: str = key(
        Choice(("hertz", "rough", "secant")),
        "hertz",
        "stiffness of the linear laws under the load: dF/dr of smooth bodies, dF/dr of rough ones, or F/r",
    )
    filter_degree: int | None = optional(
        Number(at_least=1, at_most=20, whole=True),
        6,
        "degree of a polynomial that is fitted to each filter, in dB over wavenumber",
        "the filter is averaged over a sixth of an octave",
    )
    filter_taps: int | None = optional(
        Number(at_least=2, at_most=4096, whole=True),
        64,
        "order J of the filter (J + 1 taps), even, designed by window",
        "the first that meets the fitted filter within 0.3 dB down to -30 dB",
    )

    @property
    def cells(self) -> int:
        """Number of grid cells along one side of the window."""
        return round(self.window / self.spacing)

    def problems(self) -> Iterator[InputError]:
        """The filter order is even."""
        if self.filter_taps is not None and self.filter_taps % 2:
            remedy = "An odd order would shift the texture by half a step."
            yield InputError("filter_taps", self.filter_taps, "an even number", remedy)

    def problems_of_window(self) -> Iterator[InputError]:
        """The window holds a sensible number of cells, and strips more than one window."""
        if not 8 <= self.cells <= MOST_CELLS:
            window, spacing = (written(length, "m", "um") for length in (self.window, self.spacing))
            received = f"{window}, {self.cells} cells of {spacing}"
            allowed = f"8 to {MOST_CELLS} cells of the spacing"
            yield InputError("contact.window", received, allowed, "Change window or spacing.")
        if self.sample_length is not None and self.sample_length < 2 * self.window:
            received = written(self.sample_length, "m", "um")
            allowed = f"{2e6 * self.window:g} um"
            yield InputError("contact.sample_length", received, f"at least two windows, {allowed}")


class NumericsKeys(form.Section):
    """How finely time, and a track, are resolved."""

    highest_frequency: float = key(
        FREQUENCY, "5 kHz", "upper end of the spectra", "0.1 Hz to 10 MHz: rolling is slower than ultrasound"
    )
    time_step: float | None = optional(
        DURATION,
        "8 us",
        "time step",
        "near 1/20 of the highest frequency's period, of a wheel on a rail 1/8; on the grid of the contact",
        "1 ns to 1 s: the spectra lie between",
    )
    rtol: float = key(
        Number(above=0, at_most=0.01),
        1e-6,
        "tolerance of single contact solutions and of the law direct, relative to the largest overlap",
        "1e-12 to 0.01: double precision carries no more digits",
    )
    force_accuracy: float = key(
        Number(above=0, at_most=0.01),
        1e-4,
        "relative accuracy of the forces of scans and loading curves; of scans for filters a tenth",
        "1e-07 to 0.01: the tables that are interpolated carry no more digits",
    )
    kernel: str = key(
        Choice(("poles", "scatter")),
        "poles",
        "how a track's response is carried on in time: by fitted poles, or by its whole past",
    )
    poles: int | None = optional(
        Number(at_least=10, at_most=1000, whole=True),
        100,
        "largest number of poles, even; no more are taken than tell anything of the track",
        "100, or a tenth of the time steps that the track remembers if that is less",
        goes_with="kernel=poles",
    )

    def problems(self) -> Iterator[InputError]:
        """Poles come in pairs."""
        if self.poles is not None and self.poles % 2:
            yield InputError("poles", self.poles, "an even number", "Poles come in conjugate pairs.")


class NoiseKeys(form.Section):
    """What radiates where a track is rolled over, the labels of CNOSSOS-EU, and the train that passes."""

    ALTERNATIVES = (("axle_positions", "wheelbase"), ("ground", "flow_resistivity"))

    rail_radiation: Path | Array | None = optional(
        tables.TableFile(columns=(2,), read=tables.read_ratios),
        "rail_radiation.csv",
        "table of the rail's radiation ratio: frequency (Hz), ratio of its sound power per length to "
        "impedance of air, twice the width of its foot and mean square velocity",
        "that of a section with the widths of foot and head",
    )
    sleeper_length: float = key(
        LENGTH, "2.6 m", "length of a whole sleeper", "0.1 m to 10 m: sleepers lie between"
    )
    sleeper_width: float = key(
        LENGTH,
        "0.25 m",
        "width of a sleeper that radiates: of its top, with its sloping sides",
        "10 mm to 10 m: sleepers lie between",
    )
    wheel_width: float = key(
        LENGTH, "135 mm", "width of the wheel's tread", "10 mm to 1 m: wheels lie between"
    )
    axle_positions: tuple[float, ...] | None = optional(
        ListOf(LENGTH_OR_ZERO, least=1, rising=True),
        ["0 m", "2.5 m", "19 m", "21.5 m"],
        "axles of the vehicle that passes, behind its first; each has two wheels, on two rails",
        "the contacts that roll",
        "0 m to 1 km: trains are shorter",
    )
    wheelbase: float | None = optional(
        LENGTH,
        "2.5 m",
        "distance of the two axles of a bogie that passes, instead of axle_positions",
        "the contacts that roll",
        "0.1 m to 100 m: axles are as far apart",
    )
    vehicle_length: float | None = optional(
        LENGTH,
        "26.4 m",
        "length of the vehicle over its buffers, from which the pass-by time follows",
        "half a mean distance of the axles beyond the outer ones",
        "0.1 m to 1 km: vehicles lie between",
    )
    vehicles: int = key(
        Number(at_least=1, at_most=100, whole=True),
        1,
        "number of such vehicles, one behind the other",
        goes_with="vehicle_length",
    )
    vehicle: str | None = optional(
        Choice(tuple(railways.LIMITS)),
        "emu",
        "type of vehicle, whose limit of TSI Noise the level is held to",
        "no limit",
        goes_with="vehicle_length",
    )
    receiver_distance: float = key(
        LENGTH,
        "7.5 m",
        "distance of the receiver from the middle of the track",
        "1 m to 1 km: farther away air and weather decide",
    )
    receiver_height: float = key(
        LENGTH_OR_ZERO,
        "1.2 m",
        "height of the receiver above the rail head",
        "1 mm to 100 m: sound comes over ground",
    )
    ground: str | None = optional(
        Choice((railways.HARD, *railways.GROUNDS)),
        "grass",
        "ground beside the track, by its flow resistivity: direct and reflected sound interfere",
        "hard: the energy of both adds up, as it does in the mean",
    )
    flow_resistivity: float | None = optional(
        Quantity("Pa s/m^2", above=0),
        "200 kPa s/m^2",
        "flow resistivity of the ground, instead of its name",
        "that of noise.ground",
        "1 kPa s/m^2 to 1 GPa s/m^2: snow is no softer, and rock no harder",
    )
    ground_depth: float = key(
        LENGTH_OR_ZERO,
        "0.5 m",
        "depth of that ground below the rail head",
        "1 mm to 20 m: embankments lie between",
        goes_with="ground or flow_resistivity",
    )
    sleeper_depth: float = key(
        LENGTH,
        "0.18 m",
        "depth of the tops of sleepers, which radiate there over that ground, below the rail head; the rail "
        "radiates at half of it",
        "0.1 m to 0.5 m: rails and pads lie between",
        goes_with="ground or flow_resistivity",
    )
    directivity: str = key(
        Choice(cnossos.DIRECTIVITIES),
        cnossos.EVEN,
        "how rail, sleepers and wheel radiate: evenly, or by CNOSSOS-EU with the same power; or a rail as "
        "dipoles, upright where it moves up and down, across the track where it moves sideways",
    )
    rail_distance: float | None = optional(
        LENGTH,
        "1.5 m",
        "distance of both rails, each with half of the power",
        "both in the middle of the track",
        "0.1 m to 1.9 m: receivers stand beside the track",
    )
    far_rail_screening: float = key(
        LEVEL,
        "0 dB",
        "what wheels and the nearer rail take of the sound of the farther one",
        "0 dB to 40 dB: screens take no more",
        goes_with="rail_distance",
    )
    receiver_offset: float = key(
        LEVEL,
        "0 dB",
        "what the receiver adds to all that it hears: about +6 dB of a microphone flush in a large board",
        "-40 dB to 40 dB: boards and windows lie between",
    )
    measured_bands: Path | Array | None = optional(
        tables.TableFile(columns=(2,), read=measured.read_band_levels),
        "bands.csv",
        "sound pressure levels beside the track over the pass-by time of this train, measured, to compare: "
        "one-third octave (Hz), level (dB, or in a file dB(A))",
        _NOTHING,
    )
    measured_maximum_level: float | None = optional(LEVEL, "87 dB", "measured L_pAFmax", _NOTHING, _HEARD)
    measured_equivalent_level: float | None = optional(LEVEL, "85 dB", "measured L_pAeq,Tp", _NOTHING, _HEARD)
    measured_exposure_level: float | None = optional(LEVEL, "86 dB", "measured TEL", _NOTHING, _HEARD)

    def axles_behind(self, contacts: tuple[float, ...]) -> tuple[float, ...]:
        """Axles of one vehicle behind its first, m: as given, else the contacts, which are so far behind."""
        if self.axle_positions is not None:
            return self.axle_positions
        return contacts if self.wheelbase is None else (0.0, self.wheelbase)

    def passage(self, contacts: tuple[float, ...], speed: float) -> "Passage":
        """All axles of the train, of contacts so far behind the first, m, passing at a speed, m/s."""
        from asperity.radiation.pass_by import Passage

        axles = self.axles_behind(contacts)
        length = self.vehicle_length
        if length is None:
            return Passage(axles, speed)
        train = tuple(number * length + axle for number in range(self.vehicles) for axle in axles)
        return Passage(train, speed, self.vehicles * length)

    @property
    def receiver(self) -> "Receiver":
        """Where the sound is heard."""
        from asperity.radiation.pass_by import Receiver

        return Receiver(self.receiver_distance, self.receiver_height)

    @property
    def source_heights(self) -> dict[str, float]:
        """Of rail and sleepers above the rail head, m: where they are, but not below the ground.

        Over hard ground, whose reflection adds as energy, all radiate at the rail head.
        """
        if self.ground in (None, railways.HARD) and self.flow_resistivity is None:
            return {"rail": 0.0, "sleepers": 0.0}
        deepest = -self.ground_depth
        depths = {"rail": 0.5 * self.sleeper_depth, "sleepers": self.sleeper_depth}
        return {name: max(-depth, deepest) for name, depth in depths.items()}

    @property
    def ground_words(self) -> str:
        """The ground, in words."""
        if self.flow_resistivity is not None:
            return f"ground of {written(self.flow_resistivity, 'Pa s/m^2', 'kPa s/m^2')}"
        return self.ground or railways.HARD

    def sound_path(self, band: Array, receiver: "Receiver | None" = None) -> "SoundPath":
        """What stands between rails and a receiver, in one-third octaves, Hz."""
        from asperity.radiation.sound_path import PorousGround, SoundPath

        resistivity = self.flow_resistivity or railways.GROUNDS.get(self.ground or railways.HARD)
        ground = None if resistivity is None else PorousGround(resistivity)
        apart = self.rail_distance or 0.0
        return SoundPath(
            band,
            receiver or self.receiver,
            ground,
            self.ground_depth,
            self.directivity,
            apart,
            self.far_rail_screening,
            self.receiver_offset,
        )

    def problems(self) -> Iterator[InputError]:
        """The first axle is where the others count from."""
        if self.axle_positions and self.axle_positions[0] != 0.0:
            received = f"{self.axle_positions[0]:g} m first"
            yield InputError("axle_positions", received, "positions that rise from 0 m, the first axle")

    def problems_of_train(self, contacts: tuple[float, ...]) -> Iterator[InputError]:
        """Axles of one contact alone may be told otherwise; a vehicle is longer than they are apart."""
        told = [name for name in ("axle_positions", "wheelbase") if getattr(self, name) is not None]
        if told and len(contacts) > 1:
            allowed = "nothing where several contacts roll, which are the axles"
            yield InputError(f"noise.{told[0]}", "a train", allowed, "Remove it.")
        length = self.vehicle_length
        last = self.axles_behind(contacts)[-1]
        if length is not None and length <= last:
            allowed = f"more than that over its axles, {written(last, 'm', 'm')}"
            yield InputError("noise.vehicle_length", written(length, "m", "m"), allowed)
        elif self.passage(contacts, 1.0).passed is None:
            for name in ("measured_bands", "measured_equivalent_level", "measured_exposure_level"):
                if getattr(self, name) is not None:
                    remedy = "Give noise.vehicle_length."
                    allowed = "a train with a length, from which the pass-by time follows"
                    yield InputError(f"noise.{name}", "a single axle", allowed, remedy)
