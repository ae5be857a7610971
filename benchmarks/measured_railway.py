"""A measured railway, Niederwangen near Bern: decay rates, pass-bys, and what rail dampers change.

    python benchmarks/measured_railway.py DATA -o docs/evidence

DATA is the folder of the tables that the page names. Everything is written into measured_railway.md there,
with two figures; the same digits each time.

Sections of track differ by what was measured on them: decay rates, vertical and lateral, of both rails, and
roughness. Both go into a case of a wheel on a rail as they are. The linear law rolls, and the sound of each
part at the microphone comes out. Around that lies an ensemble: roughness as it scatters between campaigns and
rails, decay rates as they scatter between rails and years, shares of the parts as models may be off. It makes
the intervals, and takes in what was measured of one section before it tells of others.
"""

from __future__ import annotations

import argparse
import csv
import json
import warnings
from dataclasses import dataclass, replace
from functools import cache, cached_property, partial
from pathlib import Path

import numpy as np
import railway_by_hand
import railway_sleepers
import railway_supports
import railway_web
from scipy.optimize import brentq, least_squares

import asperity
from asperity.case.bodies import WheelOnRail
from asperity.observables.observable import Measured
from asperity.reference import cnossos
from asperity.scenes import schema
from asperity.scenes.beside_track import pass_by_group
from asperity.scenes.measured import HammerTest
from asperity.spectra import HALF_BAND, a_weighting, nominal_frequency
from asperity.structures.lateral_rail import LateralTrack
from asperity.structures.support import MeasuredSleeper
from asperity.structures.track import EN_15461_BAYS, Track, decay_rate_of_responses
from asperity.structures.track_parameters import Bays

SECTIONS = {"B1": "Tata", "B2": "Schrey & Veit", "B3": "Vossloh", "B4": "Strail", "B5": "none"}
REFERENCE = "B5"
STATED = Path(__file__).with_suffix(".json")
"""What was predicted before anybody compared, and the level of coaches before it was taken apart."""
NUMBERS = np.arange(22, 38)
"""Of the one-third octaves that are compared, 160 Hz to 5 kHz: below, the board is in the near field."""
BAND = 10.0 ** (0.1 * NUMBERS)
AXLES = {"axle_positions": [0.0, 2.5, 19.0, 21.5], "vehicle_length": 26.4, "vehicles": 9}
MICROPHONE = {"receiver_distance": 3.1, "receiver_height": 0.7, "rail_distance": 1.5, "receiver_offset": 6.0}
"""2.35 m from the near rail's middle, 0.7 m above it, flush in a board that doubles the pressure."""
WHEEL = {"section": "straight-web", "load": 55e3, "roughness": "disc"}
PLACE = -7.5e-3
"""Of the contact across the head, m: a tread of 1:20 on a head of 300 mm that leans by 1:40."""
SPEED = 139.0
"""Of the runs, km/h."""
DRAWS, SEED = 4000, 1
PARTS = ("rail", "rail sideways", "sleepers", "wheel")


def level(energy):
    return 10.0 * np.log10(energy)


def energy(level):
    return 10.0 ** (0.1 * np.asarray(level))


# --- the tables


@dataclass(frozen=True)
class Vehicle:
    """From the middle of a vehicle to that of the next: train, number, speed, km/h, A-weighted level, dB.

    The speed is that of the bogies of coaches in between: those of locomotives stand otherwise apart.
    """

    train: int
    number: int
    name: str
    speed: float
    total: float

    @property
    def types(self):
        """Shares of vehicles in the time."""
        return COACH if self.name == "coaches" else HALF


@dataclass(frozen=True, eq=False)
class Railway:
    """What was measured, by the rows of its tables."""

    folder: Path

    def rows(self, name):
        """Rows of a table."""
        with (self.folder / f"{name}.csv").open(encoding="utf-8") as file:
            return list(csv.DictReader(file))

    @cached_property
    def decay(self):
        """Rows of decay rates."""
        return self.rows("decay_rates")

    @cached_property
    def roughness(self):
        """Rows of roughness."""
        return self.rows("rail_roughness")

    @cached_property
    def passages(self):
        """Rows of pass-bys."""
        return self.rows("pass_by_intercity")

    def rates(self, section, direction, year, damper=None):
        """Decay rates of both rails (2, 18), left first, 100 Hz to 5 kHz, dB/m, in a year; None without."""
        rows = [
            row
            for row in self.decay
            if row["section"] == section
            and row["direction"] == direction
            and row["date"].startswith(year)
            and (damper is None or row["damper"] == damper)
        ]
        rows.sort(key=lambda row: row["rail"])
        return np.array([[float(row[name]) for name in row if name.endswith(" Hz")] for row in rows])

    @cached_property
    def scatter(self):
        """Standard deviations of ln Δ by direction (18,): of both rails and two dates of each section."""
        found = {}
        for direction in ("vertical", "lateral"):
            each = [
                np.log(np.vstack([self.rates(name, direction, year) for year in ("2013-07", "2015")]))
                for name in SECTIONS
            ]
            found[direction] = np.sqrt(np.mean([np.var(rates, axis=0, ddof=1) for rates in each], axis=0))
        return found

    def rail_roughness(self, section, campaign):
        """Levels of both rails (2, 25), dB re 1 um, by MBBM in a campaign."""
        rows = [
            row
            for row in self.roughness
            if (row["section"], row["campaign"], row["measured by"]) == (section, str(campaign), "MBBM")
        ]
        return np.array([[float(row[name]) for name in row if name.endswith(" cm")] for row in rows])

    @cached_property
    def wavelengths(self):
        """Of the bands of roughness (25,), m, falling."""
        return np.array([0.01 * float(n.split()[0]) for n in self.roughness[0] if n.endswith(" cm")])

    @cached_property
    def vehicles(self):
        """Of the reference, each interval from the middle of a vehicle to that of the next."""
        bogies = {}
        for row in self.rows("bogies_intercity"):
            if row["section"] == REFERENCE:
                bogies.setdefault(row["pass-by"], {})[int(row["bogie"])] = row
        found = []
        for row in self.passages:
            if row["section"] == REFERENCE and row["interval"] != "full":
                number = int(row["interval"])
                between = [bogies[row["pass-by"]][2 * number + k] for k in (0, 1)]
                speeds = [float(each["speed (km/h)"]) for each in between if each["bogie of"] == "coach"]
                given = row["vehicles"], float(np.mean(speeds)), float(row["total (dB(A))"])
                found.append(Vehicle(int(row["pass-by"]), number, *given))
        return sorted(found, key=lambda each: (each.train, each.number))

    def levels(self, section, interval="full", vehicles=None):
        """A-weighted levels in `BAND` and their total of each passage, by its number."""
        found = {}
        for row in self.passages:
            kept = row["interval"] == "full" if interval == "full" else row["vehicles"] == vehicles
            if row["section"] == section and kept:
                bands = [float(row[name]) for name in row if name.endswith(" Hz")][2:18]
                found.setdefault(row["pass-by"], []).append([*bands, float(row["total (dB(A))"])])
        return {name: level(energy(each).mean(axis=0)) for name, each in found.items()}


# --- decay rates fitted

CENTRES = 10.0 ** (0.1 * np.arange(20, 38))
FREE = {  # least, most, first guess; between limits that are printed for such tracks
    "pad_stiffness": (100e6, 2000e6, 900e6),
    "pad_loss_factor": (0.05, 0.35, 0.2),
    "ballast_stiffness": (20e6, 300e6, 80e6),
    "ballast_loss_factor": (0.3, 2.0, 1.0),
    "rail_loss_factor": (0.001, 0.02, 0.006),
}
DAMPED = {"ballast_damping": (5e3, 200e3, 50e3)}
"""N s/m, in place of a loss factor."""
BENDS = {"sleeper_loss_factor": (0.005, 0.1, 0.03)}
SIDEWAYS = {
    "pad_stiffness": (20e6, 800e6, 200e6),
    "pad_roll_stiffness": (50e3, 5e6, 600e3),
    "ballast_stiffness": (10e6, 300e6, 100e6),
}
"""Sideways, beside the losses of `FREE`."""
DAMPER = {
    "rail_damper_mass": (1.0, 60.0, 15.0),
    "rail_damper_frequency": (200.0, 8000.0, 1200.0),
    "rail_damper_loss_factor": (0.02, 0.9, 0.3),
}
LINES = 16
"""Frequencies in a band."""
HALF_SLEEPER, LENGTH, SEAT = 150.0, 2.6, 0.75
"""Of a B91: kg, m of the whole, and m from its middle to a seat."""
BENT = (125.0, 363.0, 724.0)
"""Hz, its free vertical bending modes as measured; the first and the third are even."""
BENDING = 7.0e6
"""Bending stiffness of an even beam with modes near these, N m²."""
KINDS = "rigid", "both rails pressed alike", "one rail hammered", "rigid, hammer off the middle and askew"
VISCOUS = {name: each for name, each in FREE.items() if name != "ballast_loss_factor"} | DAMPED
STIFFENS = {"pad_stiffens": True}
SEATS = {"modal_masses": (0.5, 8.0, 1.5)}
"""Of all bending modes where the seat moves by one, over those of an even beam."""
SHEAR = 80.77e9 * 76.7e-4 * 0.393
CANDIDATES = {
    "rigid, hammer off the middle and askew": (FREE, {}),
    "rail's shear stiffness within 15 %": (
        FREE | {"shear_stiffness": (0.85 * SHEAR, 1.15 * SHEAR, SHEAR)},
        {},
    ),
    "sleepers 0.57 to 0.63 m apart": (FREE | {"sleeper_spacing": (0.57, 0.63, 0.6)}, {}),
    "ballast with a mass, on subgrade": (
        FREE | {"ballast_mass": (20.0, 400.0, 100.0), "subgrade_stiffness": (50e6, 800e6, 200e6)},
        {},
    ),
    "ballast with a damper": (VISCOUS, {}),
    "pads that stiffen": (FREE, STIFFENS),
    "both": (VISCOUS, STIFFENS),
    "even sleepers that bend, one rail hammered": (FREE | BENDS, {}, KINDS[2]),
    "and both": (VISCOUS | BENDS, STIFFENS, KINDS[2]),
    "and seats that move by less": (VISCOUS | BENDS | SEATS, STIFFENS, KINDS[2]),
}
"""What could be in the rates: keys that are free beside how a hammer strikes, what is given, the sleepers."""
NEAREST = tuple(CANDIDATES)[-1]
BED = {"subgrade_stiffness": (50e6, 800e6, 200e6)}
STRONGEST = 0.98
"""Of a Maxwell element: the loss factor is then 0.35 where it is largest, s/(2√(1 + s))."""
BY_MODES = "first_loss", "second_loss", "third_loss"
TRIED = {
    "the nearest": ({}, (), {}),
    "ballast of 100 kg on subgrade": (BED, (), {"ballast_mass": 100.0}),
    "ballast with a mass, on subgrade": (BED | {"ballast_mass": (20.0, 400.0, 100.0)}, (), {}),
    "a loss for each mode of the sleeper": (
        dict.fromkeys(BY_MODES, (0.002, 0.3, 0.03)),
        ("sleeper_loss_factor",),
        {},
    ),
    "pads of one relaxation": (
        {"strength": (0.05, STRONGEST, 0.7), "frequency": (50.0, 5000.0, 800.0)},
        ("pad_loss_factor",),
        {"pad_stiffens": False, "pad_damping": 0.0},
    ),
    "sleepers 0.57 to 0.63 m apart": ({"sleeper_spacing": (0.57, 0.63, 0.6)}, (), {}),
    "a foot that flaps at 5.4 kHz, by hand": ({}, (), {"foot": railway_supports.BY_HAND}),
    "a foot that flaps, by finite elements": ({}, (), {"foot": railway_supports.BY_ELEMENTS}),
    "that, and ballast of 100 kg on subgrade": (
        BED,
        (),
        {"ballast_mass": 100.0, "foot": railway_supports.BY_ELEMENTS},
    ),
}
"""What is tried on top of the nearest: keys that are free beside its own, those that go, what is given."""
BY_ITSELF, PAID, FOOT, BOTH = (tuple(TRIED)[number] for number in (0, 1, 7, 8))
"""Those of these with which what bays that differ do is computed, too."""
MOST = 1.2
"""dB rms, asked of the better sections."""
LOSSES = "pad_loss_factor", "rail_loss_factor", "sleeper_loss_factor"
WIDER = {name: (0.1 * low, 10.0 * high, first) for name, (low, high, first) in (FREE | BENDS).items()}
HELD = {"pad_loss_factor": 0.2, "rail_loss_factor": 0.006, "sleeper_loss_factor": 0.03}
"""Losses amid their limits."""
DIFFER = {"count": 40, "seed": 3, "spacing": 0.03, "pad": 0.2, "ballast": 0.3}
"""Bays after which a track repeats, and standard deviations over the mean: 2 cm of spacing; chosen here."""
ASKEW = {"place": (1e-3, 10e-3, 5e-3), "slope": (1e-3, 0.1, 0.03)}
"""Of hammer and accelerometer: m off the middle of the head, and sine of the lean; limits chosen here."""


def modal_mass(number):
    """Mass of the half, kg, of a free even beam in its mode of a number, where the seat moves by one."""
    turn = (4.730041, 7.853205, 10.995608)[number] / LENGTH
    even, odd = (np.cos, np.cosh), (np.sin, np.sinh)
    bends, fades = odd if number % 2 else even
    x = np.linspace(0.0, 0.5 * LENGTH, 2001)
    shape = bends(turn * x) / bends(turn * x[-1]) + fades(turn * x) / fades(turn * x[-1])
    return HALF_SLEEPER * np.mean(shape**2) / np.interp(SEAT, x, shape) ** 2


def sleepers(loss, heavier=1.0):
    """Half a B91 by its measured modes: both seats pressed alike, and one against the other.

    One loss factor, or one of each mode; modal masses are those of an even beam, or so many times as large.
    """
    first, second, third = 0.5 * np.broadcast_to(loss, 3)
    turning = HALF_SLEEPER * (0.5 * LENGTH) ** 2 / 3.0 / SEAT**2
    masses = [heavier * modal_mass(number) for number in range(3)]
    even = ((0.0, BENT[0], BENT[2]), (0.0, first, third), (HALF_SLEEPER, *masses[::2]))
    odd = ((0.0, BENT[1]), (0.0, second), (turning, masses[1]))
    return [MeasuredSleeper(HALF_SLEEPER, *each) for each in (even, odd)]


DISTANCES = 0.6 * np.array(EN_15461_BAYS)


def lines_of_bands():
    """Frequencies in each band (18, lines), Hz."""
    steps = (np.arange(LINES) + 0.5) / LINES
    return CENTRES[:, None] * HALF_BAND ** (2.0 * steps - 1.0)


def motion(tracks):
    """Receptances at the distances of EN 15461 (x, lines) of a rail on tracks that share a force."""
    omega = 2.0 * np.pi * lines_of_bands().ravel()
    return motion_of([track.waves(omega) for track in tracks], tracks[0].sleeper_spacing)


def motion_of(waves, spacing, force=None):
    """The same of their waves, with the force in the middle of the first bay or at a place, m.

    A hammer on one rail presses half as much on both alike, and half as much on one against the other.
    """
    begin = 0.5 * spacing if force is None else force
    each = [[own.receptance(begin + spacing * bays, begin) for bays in EN_15461_BAYS] for own in waves]
    return np.mean(each, axis=0)


def hammered(tracks):
    """Decay rates by EN 15461 in bands (18,), dB/m, of a rail on tracks that share a force."""
    return in_bands(tracks[0].sleeper_spacing * np.array(EN_15461_BAYS), motion(tracks), lines_of_bands())


def in_bands(distances, responses, frequency):
    """Rates in bands, of responses that are summed over each of them."""
    lengths = 1.0 / decay_rate_of_responses(distances, np.abs(responses)).reshape(frequency.shape)
    weights = np.abs(frequency * responses[0].reshape(frequency.shape)) ** 2
    return 1.0 / np.average(lengths, axis=1, weights=weights)


def sideways_track(keys, web_thickness=np.inf):
    """The rail sideways, of the losses of `FREE` and the stiffnesses of `SIDEWAYS`; it keeps its form."""
    losses = {name: value for name, value in keys.items() if name.endswith("loss_factor")}
    own = {name: value for name, value in keys.items() if name in SIDEWAYS}
    track = Track.named("uic60", ballast_stiffness=80e6, pad_stiffness=900e6, **losses)
    return LateralTrack(track, web_thickness=web_thickness, **own)


def hammered_askew(keys, sideways, kind="rigid"):
    """The same of a hammer and an accelerometer off the middle of the head that lean.

    They twist the rail and press it sideways a little, and hear as much of it; those waves reach farther.
    """
    tracks, beside = askew(keys, sideways, kind)
    distances = tracks[0].sleeper_spacing * np.array(EN_15461_BAYS)
    return in_bands(distances, motion(tracks) + beside, lines_of_bands())


def askew(keys, sideways, kind):
    """Tracks that share the force of a hammer that leans, and what it hears of the rail sideways."""
    told = dict(keys)
    place, slope = (told.pop(name) for name in ASKEW)
    receptances, track = sideways
    moved = np.array([1.0, slope]) @ track.contact_shapes(place)
    return tracks_of(told, kind), np.einsum("a,xabf,b->xf", moved, receptances, moved)


def hammered_in_bays(keys, sideways, kind):
    """Levels of rates in bays that differ (places, 18), less those in equal ones, dB, of a hammer askew."""
    tracks, beside = askew(keys, sideways, kind)
    spacing, omega = tracks[0].sleeper_spacing, 2.0 * np.pi * lines_of_bands().ravel()
    distances = spacing * np.array(EN_15461_BAYS)
    differ = [replace(track, bays=Bays.drawn(**DIFFER)) for track in tracks]
    waves = [track.waves(omega) for track in differ]
    each = [motion_of(waves, spacing, force) for force in differ[0].mid_spans[::4]]
    rates = [in_bands(distances, moved + beside, lines_of_bands()) for moved in (*each, motion(tracks))]
    return level(rates[:-1]) - level(rates[-1])


def sideways_motion(track):
    """Receptances of a rail sideways at the distances of EN 15461 (x, m, m, f), and the rail."""
    waves = track.waves(2.0 * np.pi * lines_of_bands().ravel())
    return waves.receptances(0.3 + DISTANCES, 0.3), track


def tracks_of(keys, kind="rigid", **more):
    """What a hammer on one rail feels, by the kind of sleeper."""
    told = dict(keys)
    beside = {name: told.pop(name) for name in ASIDE if name in told}
    by_modes = [told.pop(name) for name in BY_MODES if name in told]
    bent = told.pop("sleeper_loss_factor", by_modes or 0.0), told.pop("modal_masses", 1.0)
    bodies = [None] if kind == KINDS[0] else sleepers(*bent)
    return [
        railway_supports.with_more(Track.named("uic60", measured_sleeper=each, **told, **more), **beside)
        for each in (bodies if kind == KINDS[2] else bodies[:1])
    ]


ASIDE = "foot", "strength", "frequency"
"""What `railway_supports.with_more` gives a track."""


def lateral_rates(keys):
    """Decay rates (18,), dB/m, of a rail that keeps its form sideways, struck at the top of its head."""
    return rates_of_form(keys, KEEPS)


def webbed_rates(keys):
    """The same of the package's own rail, whose web bends, struck on the side of its head."""
    frequency = lines_of_bands()
    track = sideways_track(keys, web_thickness=None)
    lengths = 1.0 / track.decay_rate_en15461(frequency.ravel()).reshape(frequency.shape)
    return 1.0 / lengths.mean(axis=1)


def fitted(computed, free, aim):
    """Keys whose levels of decay rates are nearest to an aim (18,), dB, and by how much they are off."""
    low, high, first = (np.log10([each[k] for each in free.values()]) for k in range(3))

    def keys(unknowns):
        return dict(zip(free, (10.0**unknowns).tolist(), strict=True))

    fit = least_squares(
        lambda unknowns: level(computed(keys(unknowns))) - aim, first, bounds=(low, high), max_nfev=30
    )
    return keys(fit.x), fit.fun


def rms(values):
    return float(np.sqrt(np.mean(np.asarray(values) ** 2)))


# --- the sound of a section, by a run


def spectrum_of(wavelengths, levels):
    """Table of a roughness, longest wave first, with what is longer than was measured as at 0.32 m."""
    exact = 10.0 ** (0.1 * np.round(10.0 * np.log10(wavelengths)))
    longer = exact[0] * 10.0 ** (0.1 * np.arange(8, 0, -1))
    return np.column_stack([np.append(longer, exact), np.append(np.full(8, levels[0]), levels)])


def passing(track, speed, rail, rates=None, duration=1.0, place=PLACE, wheel=None, web=np.inf):
    """Case of a wheel on a rail with a roughness of both (tables, dB re 1 um), at a speed, km/h.

    Sideways the rail keeps its form, as when the predictions were stated, unless its web is given, m.
    """
    keys = dict(track)
    if rates is not None:
        keys["decay_rates"] = np.column_stack([CENTRES, rates.T])
    return WheelOnRail(
        laws=["linear-filtered"],
        speed=speed / 3.6,
        duration=duration,
        settling=0.2,
        surface={"spectrum": rail},
        wheel=WHEEL | (wheel or {}),
        track={"name": "uic60"} | keys,
        sideways={"contact_place": place, "web_thickness": web},
        noise=AXLES | MICROPHONE,
    )


def heard(case, tree):
    """A-weighted equivalent levels at the microphone in `BAND` by part, then of all (5, bands), dB.

    Of a run and a case that may differ in what stands between the track and the microphone.
    """
    side = tree["sideways"]
    beside = {
        schema.SIDEWAYS_FREQUENCY: side["frequency"].values,
        schema.LATERAL_DECAY_RATE: side["lateral_decay_rate"].values,
    }
    found = pass_by_group(case, tree["spectra"].to_dataset(), beside)
    over_time = level(found[schema.REAR_TIME] - found[schema.FRONT_TIME])
    numbers = np.rint(10.0 * np.log10(found[schema.PASS_BY_BAND])).astype(int)
    exposure = found[schema.SOUND_EXPOSURE_LEVEL][0]
    return exposure[:, np.isin(numbers, NUMBERS)] - over_time + a_weighting(BAND)


def over_ways(case, tree):
    """What is heard by each of `WAYS` (ways, 5, bands)."""
    return np.stack([heard(case.with_(noise=keys), tree) for keys in WAYS])


def over_middle(case, tree):
    """What is heard over ground at the middle depth, the mean of even sources and dipoles (bands,)."""
    middle = [each for each in WAYS if each["ground_depth"] == DEPTHS[1]]
    return level(np.mean([energy(heard(case.with_(noise=keys), tree)[-1]) for keys in middle], axis=0))


def mean_of(ways):
    """Levels of the mean energy of ways, by part (parts, bands)."""
    return level(energy(ways[:, : len(PARTS)]).mean(axis=0))


def mean_roughness(lines):
    return level(energy(lines).mean(axis=0))


def at_bands(wavelengths, levels, speed):
    """Roughness levels (..., 25) at the wavelengths v/f of `BAND`, between bands by lg λ."""
    at, rising = np.log10(wavelengths)[::-1], np.asarray(levels)[..., ::-1]
    place = np.clip(np.log10(speed / 3.6 / BAND), at[0], at[-1])
    after = np.clip(np.searchsorted(at, place, side="right"), 1, len(at) - 1)
    share = (place - at[after - 1]) / (at[after] - at[after - 1])
    return rising[..., after - 1] + share * (rising[..., after] - rising[..., after - 1])


DEPTHS = (0.22, 0.315, 0.41)
"""m, of the terrain below the top of the rail, as measured: least, middle, most."""
WAYS = [
    {"ground": "ballast-shoulder", "ground_depth": depth, "directivity": directivity}
    for directivity in ("even", "dipole")
    for depth in DEPTHS
]
"""Of the sound to the microphone. What is nominal is the mean of their energies. Beside the track a rail is
measured to lie between: about 4 dB more directional than a monopole (X. Zhang, IWRN 10, 2010)."""
NEAR = 0.61
"""Share of the near rail in the exposure: 1/d of 2.45 and 3.91 m."""
SHARES = (2.0, 5.0, 4.0, 4.0)
"""Standard deviations by which the level of each part may be off, dB, together and by band."""
TYPES = {"coach": ("disc", 4.0), "locomotive": ("disc", 6.0), "motor coach": ("mean", 5.0)}
"""Wheels: which roughness is expected, its standard deviation, dB; "mean": of disc and composite blocks."""
LOCOMOTIVES = 0.14
"""Share of a train's time that is its locomotive: one interval and a half of some eleven."""
OTHERS = -10.0, 6.0
"""Level of what neither roughness nor decay changes (traction, air, bogies) less that of rolling, dB, and its
standard deviation."""
ABSOLUTE, SITE = 1.0, 1.0
"""Errors of levels at one place, and of differences between places, dB: microphone, ground, terrain."""


CAMPAIGNS, YEARS = (4, 2, 3), ("2015", "2013-07")
"""Of roughness and decay rates, the ones of the time of the pass-bys first."""


class Ensemble:
    """Draws of all that is uncertain, at any speed; the first is the nominal one until something is seen."""

    def __init__(self, railway, ways, speed):
        self.railway, self.parts, self.speed = railway, mean_of(ways), speed
        self.generator = np.random.default_rng(SEED)
        self.waves, self.held = railway.wavelengths, {}
        way = self._chosen(np.full(len(ways), 1.0 / len(ways)))
        self.left = self._chosen([0.5, 0.5])
        for k, (name, deviation) in enumerate(zip(PARTS, SHARES, strict=True)):
            apart = np.vstack([np.zeros(len(BAND)), (ways[:, k] - self.parts[k])[way[1:]]])
            self.held[f"share of {name}"] = apart + self._drawn(deviation, len(BAND))
        self.held["others"] = OTHERS[0] + self._drawn(OTHERS[1], len(BAND))
        self.held["offset"] = self._drawn(1.5, 1)
        for name, (kind, deviation) in TYPES.items():
            self.held[f"wheels of {name}"] = self.wheels(kind) + self._drawn(deviation, len(self.waves))
        self.campaign, self.year = self._chosen([0.5, 0.25, 0.25]), self._chosen([0.6, 0.4])
        for name in SECTIONS:
            if name != "B1":
                self._add_section(name)
        self.reference = {
            what: self.held[f"{REFERENCE} {what}"][0].copy() for what in ("vertical", "lateral")
        }
        expected = self.wheels(TYPES["coach"][0])
        rolled = self.held[f"{REFERENCE} roughness"][0]
        self.rolled = energy(at_bands(self.waves, rolled, speed)) + energy(
            at_bands(self.waves, expected, speed)
        )

    def _drawn(self, deviation, count):
        """Errors that are common to all bands, and those of each, (draws, count), dB; none of the first.

        Their mean energy is one: what is known are means of energies, over wheels, bays and rails.
        """
        draw = self.generator.standard_normal
        found = deviation * (0.8 * draw((DRAWS, 1)) + 0.6 * draw((DRAWS, count)))
        found -= 0.05 * np.log(10.0) * deviation**2
        found[0] = 0.0
        return found

    def _of_rails(self, left, right):
        """Mean of both rails (draws, ...), of which the near one is louder; of both alike in the first draw.

        Which of them is near the microphone is not known: either in half of the draws.
        """
        share = np.where(self.left == 1, NEAR, 1.0 - NEAR)
        share[0] = 0.5
        return share[:, None] * left + (1.0 - share[:, None]) * right

    def wheels(self, kind):
        """Roughness of wheels by CNOSSOS-EU at the wavelengths that were measured, dB re 1 um."""
        kinds = ("disc", "composite") if kind == "mean" else (kind,)
        found = []
        for each in kinds:
            at, levels = cnossos.wheel_roughness(each)
            found.append(np.interp(np.log10(self.waves), np.log10(at)[::-1], levels[::-1]))
        return np.mean(found, axis=0)

    def _chosen(self, chances):
        """One of so many records in each draw, the first one in the nominal draw."""
        found = self.generator.choice(len(chances), DRAWS, p=chances)
        found[0] = 0
        return found

    def _add_section(self, name):
        """Roughness: of one campaign for all sections, and what a repetition differs by.

        Decay rates: of one year for all sections, each rail off by their scatter in each band; as ln of the
        mean 1/Δ.
        """
        campaigns = np.stack([self.railway.rail_roughness(name, c) for c in CAMPAIGNS])[self.campaign]
        both = level(self._of_rails(energy(campaigns[:, 0]), energy(campaigns[:, 1])))
        self.held[f"{name} roughness"] = both + self._drawn(1.5, len(self.waves))
        for direction in ("vertical", "lateral"):
            rates = np.stack([self.railway.rates(name, direction, year)[:, 2:] for year in YEARS])
            apart = self.railway.scatter[direction][2:]
            scatter = apart * self.generator.standard_normal((DRAWS, *rates.shape[1:])) - 0.5 * apart**2
            scatter[0] = 0.0
            longer = np.exp(scatter) / rates[self.year]
            self.held[f"{name} {direction}"] = np.log(self._of_rails(longer[:, 0], longer[:, 1]))

    def level(self, section, types, speed):
        """A-weighted levels at a section (draws, bands), of types of vehicles with their shares of the time.

        The transfer from roughness to sound is that of the run at the reference, part by part.
        """
        transfer = 0.0
        for k, part in enumerate(PARTS):
            direction = {"wheel": None, "rail sideways": "lateral"}.get(part, "vertical")
            longer = 0.0
            if direction is not None:
                longer = self.held[f"{section} {direction}"] - self.reference[direction]
            transfer = transfer + energy(self.parts[k] + self.held[f"share of {part}"]) * np.exp(longer)
        rail = energy(at_bands(self.waves, self.held[f"{section} roughness"], speed))
        rough = sum(
            share * (rail + energy(at_bands(self.waves, self.held[f"wheels of {name}"], speed)))
            for name, share in types.items()
        )
        filtered = contact_filter(speed) - contact_filter(self.speed)
        rolling = transfer * rough / self.rolled * energy(filtered)
        others = energy(level(energy(self.parts).sum(axis=0)) + self.held["others"])
        return level(rolling + others) + self.held["offset"]

    def difference(self, section, types, speed, faster=1.0):
        """Level at a section less that at the reference (draws, bands), dB, passed so much faster there."""
        apart = self.level(section, types, speed) - self.level(REFERENCE, types, speed)
        return apart + 30.0 * np.log10(faster)

    def see(self, computed, measured, error, steps=4):
        """Take in what was measured (k,), with standard deviations of errors (k,), dB, in smoothing steps.

        `computed` tells it of this ensemble (draws, k). Each step moves the draws by the linear gain, with
        errors that are larger by the root of the number of steps (ensemble smoother, A. A. Emerick and A. C.
        Reynolds, Computers & Geosciences 55 (2013) 3).
        """
        names, wider = list(self.held), np.sqrt(steps) * error
        for _ in range(steps):
            found, state = computed(self), np.hstack([self.held[name] for name in names])
            apart = found - found.mean(axis=0)
            covariance = apart.T @ apart / DRAWS + np.diag(wider**2)
            gain = (state - state.mean(axis=0)).T @ apart / DRAWS @ np.linalg.inv(covariance)
            missed = measured + wider * self.generator.standard_normal(found.shape) - found
            moved = np.split(
                state + missed @ gain.T, np.cumsum([self.held[n].shape[1] for n in names])[:-1], axis=1
            )
            self.held = dict(zip(names, moved, strict=True))
        return self


def contact_filter(speed):
    """Of CNOSSOS-EU for 50 kN on a wheel of 920 mm, dB in `BAND`: what changes with the speed alone."""
    at, gain = cnossos.contact_filter("50 kN, 920 mm")
    return np.interp(np.log10(speed / 3.6 / BAND), np.log10(at)[::-1], gain[::-1])


INTERCITY = {"coach": 1.0 - LOCOMOTIVES, "locomotive": LOCOMOTIVES}


def at_site(difference):
    """Differences (draws, bands) as two places show them: with the error of a place, together and by band."""
    draw = np.random.default_rng(SEED + 2).standard_normal
    return difference + SITE * (0.7 * draw((DRAWS, 1)) + 0.7 * draw(difference.shape))


def total_difference(spectrum, difference):
    """Difference of the A-weighted level (n,), of levels at the reference (bands,) and differences."""
    return level(energy(spectrum + difference).sum(axis=-1)) - level(energy(spectrum).sum(axis=-1))


def interval(values):
    """Median and 80 % interval of draws (n, ...): (3, ...)."""
    return np.quantile(values, [0.5, 0.1, 0.9], axis=0)


# --- the page


def of_means(passages):
    """Energy mean of passages (bands), and of A-weighted totals."""
    mean = level(np.mean([energy(each) for each in passages.values()], axis=0))
    return mean[:-1], float(mean[-1])


NAMES = [nominal_frequency(each) for each in BAND]
INTERCITY_SPEED = 136.0
COACH = {"coach": 1.0}
HALF = {"coach": 0.5, "locomotive": 0.5}
"""From the middle of a locomotive to that of the coach behind it."""


def signed(value):
    return f"{value:+.1f}".replace("-", "−")


def with_interval(values):
    """Median and 80 % interval of draws (n,), in words."""
    middle, low, high = interval(values)
    return f"{signed(middle)} ({signed(low)} … {signed(high)})"


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" + "---:|" * (len(head) - 1)]
    return "\n".join([*lines, *("| " + " | ".join(row) + " |" for row in rows)])


def rates_of(railway, section, year="2015"):
    return np.vstack([railway.rates(section, each, year) for each in ("vertical", "lateral")])


@dataclass(frozen=True, eq=False)
class Found:
    """What was computed and measured, before it is written."""

    railway: Railway

    @cached_property
    def candidates_of_rates(self):
        """Tables of what is left of decay rates, of keys of the nearest kind, and these by section."""
        return decay_candidates(self.railway)

    @cached_property
    def tried(self):
        """What more of physics leaves."""
        return TriedOnNearest(self.railway, self.candidates_of_rates[-1])

    @cached_property
    def track(self):
        """Of the reference in 2015, by its vertical decay rates."""
        aim = level(self.railway.rates(REFERENCE, "vertical", "2015")).mean(axis=0)
        return fitted(lambda keys: hammered(tracks_of(keys)), FREE, aim)[0]

    def case(self, section, track=None, **more):
        """A coach that passes a section at 139 km/h, as measured on it."""
        rail = spectrum_of(self.railway.wavelengths, mean_roughness(self.railway.rail_roughness(section, 4)))
        keys = self.track | (track or {})
        return passing(keys, SPEED, rail, rates_of(self.railway, section), **more)

    @cached_property
    def reference(self):
        """Case and result of the reference, with points that are passed."""
        case = self.case(REFERENCE).with_(track={"points": railway_by_hand.POINTS.tolist()})
        return case, asperity.run(case)

    @cached_property
    def runs(self):
        """Of the reference and the section with Strail dampers, by way."""
        damped = self.case("B4")
        return {REFERENCE: over_ways(*self.reference), "B4": over_ways(damped, asperity.run(damped))}

    def spectrum(self, section):
        """Levels of a run in the mean over all ways, of all parts together (bands,)."""
        return level(energy(mean_of(self.runs[section])).sum(axis=0))

    @cached_property
    def stated(self):
        """What was predicted before anybody compared."""
        return json.loads(STATED.read_text(encoding="utf-8"))

    def first_stated(self, section):
        """Medians by band (bands,), dB, of what was first stated of a section and intercity trains."""
        rows = self.stated["sections"]
        return np.array([float(row[2]) for row in rows if row[0] == SECTIONS[section]])

    @cached_property
    def measured_difference(self):
        """Strail less reference, by passage (n, bands + 1)."""
        damped, plain = self.railway.levels("B4"), self.railway.levels(REFERENCE)
        return np.array([damped[name] - plain[name] for name in damped])

    @cached_property
    def coach(self):
        """Levels at the reference opposite coaches, and their total."""
        return of_means(self.railway.levels(REFERENCE, "each", "coaches"))

    @cached_property
    def locomotive(self):
        """From the middle of a locomotive to that of a coach."""
        return of_means(self.railway.levels(REFERENCE, "each", "locomotive and coach"))

    @property
    def train(self):
        """Over the whole train."""
        return of_means(self.railway.levels(REFERENCE))

    def ensemble(self):
        """A new one, that has seen nothing."""
        return Ensemble(self.railway, self.runs[REFERENCE], SPEED)

    @cached_property
    def blind(self):
        """What is known before any pass-by."""
        return self.ensemble()

    def _seen_at_reference(self, ensemble):
        at = REFERENCE, INTERCITY_SPEED
        each = [ensemble.level(at[0], types, at[1]) for types in (COACH, HALF)]
        return np.hstack(each)

    @cached_property
    def after_reference(self):
        """After coaches and locomotives at the reference."""
        measured = np.append(self.coach[0], self.locomotive[0])
        return self.ensemble().see(self._seen_at_reference, measured, np.full(len(measured), ABSOLUTE))

    @cached_property
    def after_strail(self):
        """After the difference by Strail dampers, too."""
        measured = np.append(self.coach[0], self.locomotive[0])
        found = self.ensemble().see(self._seen_at_reference, measured, np.full(len(measured), ABSOLUTE))
        apart = self.measured_difference[:, :-1]
        error = np.hypot(SITE, apart.std(axis=0, ddof=1) / np.sqrt(len(apart)))
        return found.see(lambda e: e.difference("B4", INTERCITY, INTERCITY_SPEED), apart.mean(axis=0), error)

    @cached_property
    def agreement(self):
        """Largest difference of the runs' change and that of the nominal draw, without other sources, dB."""
        nominal = self.ensemble()
        nominal.held["others"] = np.full_like(nominal.held["others"], -200.0)
        expected = nominal.difference("B4", COACH, SPEED)[0]
        return float(np.abs(self.spectrum("B4") - self.spectrum(REFERENCE) - expected).max())

    def difference(self, ensemble, section):
        """Of intercity trains by band, and of the A-weighted level of the train that was measured."""
        bands = at_site(ensemble.difference(section, INTERCITY, INTERCITY_SPEED))
        return bands, total_difference(self.train[0], bands)


def decay_fits(found):
    """Of each section before its dampers: rms of the fit by kind of sleeper, losses, and sideways."""
    rows, drawn = [], {}
    for section in SECTIONS:
        both = level(found.railway.rates(section, "vertical", "2012", "none"))
        aim, row, keys = both.mean(axis=0), [section, f"{rms(both[0] - both[1]):.1f}"], {}
        sides = level(found.railway.rates(section, "lateral", "2012", "none"))
        losses = {name: value for name, value in FREE.items() if name.endswith("loss_factor")}
        lateral, off_sideways = fitted(lateral_rates, SIDEWAYS | losses, sides.mean(axis=0))
        drawn[section, "lateral"] = sides.mean(axis=0), sides.mean(axis=0) + off_sideways
        sideways = sideways_motion(sideways_track(lateral))
        for kind in KINDS:
            free = FREE | {KINDS[0]: {}, KINDS[3]: ASKEW}.get(kind, BENDS)

            def computed(each, kind=kind, sideways=sideways):
                return hammered_askew(each, sideways) if kind == KINDS[3] else hammered(tracks_of(each, kind))

            keys, off = fitted(computed, free, aim)
            row.append(f"{rms(off):.1f} ({rms(off[:-1]):.1f})")
            drawn[section, kind] = aim, aim + off
        row += [f"{1e-6 * keys[name]:.0f}" for name in ("pad_stiffness", "ballast_stiffness")]
        row += [f"{keys[name]:.2g}" for name in (*keys,) if name.endswith("loss_factor")]
        row += [f"{1e3 * keys['place']:.0f}", f"{keys['slope']:.2f}"]
        rows.append([*row, f"{rms(off_sideways):.1f}"])
    head = ["", "left − right", *KINDS, "pad / (MN/m)", "ballast / (MN/m)"]
    head += ["loss of pad", "of ballast", "of rail", "off / mm", "slope", "sideways"]
    return table(head, rows), drawn


@cache
def webbed_sideways(railway, section):
    """Motion and rail of a section without dampers whose web bends, fitted to its lateral rates."""
    sides = level(railway.rates(section, "lateral", "2012", "none")).mean(axis=0)
    losses = {name: value for name, value in FREE.items() if name.endswith("loss_factor")}
    keys, _ = fitted(webbed_rates, SIDEWAYS | losses, sides)
    return sideways_motion(sideways_track(keys, web_thickness=None))


def fit_candidate(railway, section, free, fixed, kind=KINDS[0]):
    """Keys of a section that a hammer askew strikes, and by how much its rates are off (18,), dB."""
    sideways = webbed_sideways(railway, section)
    aim = level(railway.rates(section, "vertical", "2012", "none")).mean(axis=0)
    return fitted(lambda keys: hammered_askew(keys | fixed, sideways, kind), free | ASKEW, aim)


def decay_candidates(railway):
    """What is left of the rates of each section by candidate, keys of the nearest, and these by section.

    The last with what is left of each band (18,), dB.
    """
    rows, offs = [], {}
    for name, candidate in CANDIDATES.items():
        found = [fit_candidate(railway, section, *candidate) for section in SECTIONS]
        offs = dict(zip(SECTIONS, found, strict=True))
        said = [f"{rms(off):.2f} ({rms(off[:-1]):.2f})" for _, off in found]
        rows.append([name, *said, f"{np.mean([rms(off) for _, off in found]):.2f}"])
    keys_of = []
    for section, (keys, _) in offs.items():
        row = [f"{1e-6 * keys[name]:.0f}" for name in ("pad_stiffness", "ballast_stiffness")]
        row += [f"{1e-3 * keys['ballast_damping']:.0f}"]
        row += [f"{keys[f'{part}_loss_factor']:.2g}" for part in ("pad", "rail", "sleeper")]
        keys_of.append(
            [
                section,
                *row,
                f"{keys['modal_masses']:.1f}",
                f"{1e3 * keys['place']:.0f}",
                f"{keys['slope']:.2f}",
            ]
        )
    head = ["", "pad / (MN/m)", "ballast / (MN/m)", "/ (kN s/m)", "loss of pad", "of rail", "of sleeper"]
    head += ["modal masses", "off / mm", "slope"]
    return table(["", *SECTIONS, "mean"], rows), table(head, keys_of), offs


def bays_that_differ(railway, name, fits):
    """What bays that differ do to rates of a kind of track that was tried: no key is free for it.

    By section what is left of bands with bays alike and with bays that differ, and by how much a place is off
    their mean, dB (18,) each.
    """
    sideways_of, found = partial(webbed_sideways, railway), {}
    free, fixed, kind = CANDIDATES[NEAREST]
    more, _, given = TRIED[name]
    free, fixed = free | ASKEW | more, fixed | given
    for section, (keys, off) in fits.items():
        places = hammered_in_bays(keys | fixed, sideways_of(section), kind)
        factor = energy(places.mean(axis=0))

        def computed(each, section=section, factor=factor):
            return factor * hammered_askew(each | fixed, sideways_of(section), kind)

        aim = level(railway.rates(section, "vertical", "2012", "none")).mean(axis=0)
        _, in_bays = nearer(computed, free, keys, aim)
        found[section] = off, in_bays, places.std(axis=0)
    return found


def between_rails(railway):
    """By section what left and right rail differ by in each band (18,), dB."""
    each = {name: level(railway.rates(name, "vertical", "2012", "none")) for name in SECTIONS}
    return {name: left - right for name, (left, right) in each.items()}


def bays_table(railway, found):
    """The same as a table, of 100 Hz to 4 kHz."""
    apart = between_rails(railway)
    rows = [
        [section, *(f"{rms(each[:-1]):.2f}" for each in (apart[section], *own))]
        for section, own in found.items()
    ]
    head = ["100 Hz to 4 kHz, rms dB", "left − right", "left of the nearest, bays alike", "bays differ"]
    return table([*head, "bays differ: one place of the hammer less the mean"], rows)


def nearer(computed, free, known, aim):
    """As `fitted`, begun at first guesses and where another fit ended, a little within limits: the better."""
    begun = {
        name: (low, high, float(np.clip(known.get(name, first), 1.02 * low, 0.98 * high)))
        for name, (low, high, first) in free.items()
    }
    return min((fitted(computed, each, aim) for each in (free, begun)), key=lambda end: rms(end[1]))


def fit_on_nearest(railway, section, nearest, more, gone=(), given=(), bands=None):
    """Keys and what is left of bands, dB, with more free beside the nearest, whose keys are known."""
    free, fixed, kind = CANDIDATES[NEAREST]
    free = {name: each for name, each in (free | ASKEW | more).items() if name not in gone}
    fixed, sideways = fixed | dict(given), webbed_sideways(railway, section)
    aim = level(railway.rates(section, "vertical", "2012", "none")).mean(axis=0)
    return nearer(
        lambda keys: hammered_askew(keys | fixed, sideways, kind)[:bands], free, nearest, aim[:bands]
    )


@dataclass(frozen=True, eq=False)
class TriedOnNearest:
    """What more of physics leaves of rates on top of the nearest kind of track, by what is tried."""

    railway: Railway
    nearest: dict

    @cached_property
    def fits(self):
        """Keys and what is left of bands (18,), dB, by what is tried and section."""
        return {
            name: {
                section: fit_on_nearest(self.railway, section, self.nearest[section][0], *each)
                for section in SECTIONS
            }
            for name, each in TRIED.items()
        }

    @cached_property
    def in_bays(self):
        """What bays that differ do to some of these."""
        some = (BY_ITSELF, PAID, FOOT, BOTH)
        return {name: bays_that_differ(self.railway, name, self.fits[name]) for name in some}

    @cached_property
    def left(self):
        """What is left of bands (18,), dB, by what is tried and section, bays that differ among it."""
        alike = {
            name: {section: off for section, (_, off) in each.items()} for name, each in self.fits.items()
        }
        differ = {
            f"{name}, bays that differ": {section: off for section, (_, off, _) in each.items()}
            for name, each in self.in_bays.items()
        }
        return alike | differ

    def keys(self, name):
        """How many keys more are free, in words."""
        more, gone, _ = TRIED[name.removesuffix(", bays that differ")]
        return f"{len(more) - len(gone):+d}" if more or gone else "0"

    def table(self):
        """All that is left."""
        apart = between_rails(self.railway)
        rows = [
            [
                name,
                self.keys(name) if name in self.left else "",
                *(f"{rms(off):.2f} ({rms(off[:-1]):.2f})" for off in each.values()),
                f"{np.mean([rms(off[:-1]) for off in each.values()]):.2f}",
            ]
            for name, each in (self.left | {"left − right": apart}).items()
        ]
        return table(["rms dB", "keys more", *SECTIONS, "mean without 5 kHz"], rows)

    def verdicts(self):
        """Which sections are met by which kind: at most what rails differ by, and at most 1.2 dB."""
        apart, rows = between_rails(self.railway), []
        names = [name for name in self.left if name.removesuffix(", bays that differ") in self.in_bays]
        for name in sorted(names, key=lambda each: (FOOT in each or BOTH in each, "differ" in each)):
            row = [name, self.keys(name)]
            for most in (lambda section, bands: rms(apart[section][bands]), lambda *_: MOST):
                for bands in (slice(None), slice(-1)):
                    met = [
                        section
                        for section, off in self.left[name].items()
                        if rms(off[bands]) <= most(section, bands)
                    ]
                    row.append("all" if len(met) == len(SECTIONS) else " ".join(met))
            rows.append(row)
        head = ["sections that are met by", "keys more", "rails differ by more, 18 bands", "without 5 kHz"]
        return table([*head, "at most 1.2 dB, 18 bands", "without 5 kHz"], rows)

    def subgrades(self):
        """Of ballast of 100 kg, MN/m, in words."""
        return ", ".join(f"{1e-6 * keys['subgrade_stiffness']:.0f}" for keys, _ in self.fits[PAID].values())


def highest_band(found):
    """The band of 5 kHz, dB/m, in sections without dampers by date, both rails, and what is computed."""
    rows = []
    for section in SECTIONS:
        row = [section]
        for year in ("2012", "2013-01", "2013-07", "2015"):
            rates = found.railway.rates(section, "vertical", year, "none")
            row.append(" / ".join(f"{each:.1f}" for each in rates[:, -1]) if rates.size else "")
        aim = level(found.railway.rates(section, "vertical", "2012", "none"))[:, -1].mean()
        row += [f"{energy(aim + found.tried.left[name][section][-1]):.1f}" for name in (BY_ITSELF, FOOT)]
        rows.append(row)
    head = ["5 kHz, dB/m, left / right", "September 2012", "January 2013", "July 2013", "2015"]
    return table([*head, "the nearest", FOOT], rows)


def losses_on_limits(railway, fits, given=()):
    """Losses of a kind of track that lie on a limit, without limits, and what these matter."""
    rows, given = [], dict(given)
    for section, (keys, off) in fits.items():
        limits = FREE | BENDS
        fit = partial(fit_on_nearest, railway, section, keys)
        freely, left = fit({name: WIDER[name] for name in LOSSES}, given=given)
        low, _ = fit({}, given=given, bands=-1)
        _, held = fit({}, gone=LOSSES, given=given | HELD)
        said = []
        for name in LOSSES:
            told = [f"{keys[name]:.2g}{on_limit(keys[name], limits[name])}", f"{freely[name]:.2g}"]
            if name == "rail_loss_factor":
                told.append(f"{low[name]:.2g}{on_limit(low[name], limits[name])}")
            said += told
        rows.append([section, *said, *(f"{rms(each):.2f}" for each in (off, left, held))])
    head = ["", "pad", "without limits", "rail", "without limits", "fitted without 5 kHz"]
    head += ["sleeper", "without limits", "left, rms dB", "left without limits", "left with 0.2, 0.006, 0.03"]
    return table(head, rows)


def on_limit(value, limits):
    """A word on a value within a hundredth of a limit."""
    low, high, _ = limits
    return " (most)" if value > 0.99 * high else " (least)" if value < 1.01 * low else ""


def determined(found):
    """What `asperity.fit` says of the reference in 2012: values with intervals, and what is open."""
    rates = found.railway.rates(REFERENCE, "vertical", "2012", "none")
    keys = {name: first for name, (*_, first) in FREE.items()}
    bends = {"sleeper_bending_stiffness": BENDING, "sleeper_loss_factor": 0.03}
    case = WheelOnRail(surface={"smooth": True}, track={"name": "uic60"} | keys | bends)
    measured = [Measured("vertical decay rate", CENTRES, each) for each in rates]
    fit = asperity.fit(case, measured, {f"track.{name}": each[:2] for name, each in FREE.items()}, starts=4)
    told = [f"- `{each.name}`: {each.words}" for each in fit.estimates]
    return "\n".join([*told, *(f"- {each.words}" for each in fit.undetermined)])


def over_temperature(found):
    """Stiffness of the pads of the reference by date, all else as of their mean."""
    rows = []
    records = [row for row in found.railway.decay if row["section"] == REFERENCE]
    years = ("2012", "2013-01", "2013-07", "2015")
    levels = {year: level(found.railway.rates(REFERENCE, "vertical", year)).mean(axis=0) for year in years}
    mean = np.mean(list(levels.values()), axis=0)
    keys, _ = fitted(lambda each: hammered(tracks_of(each)), FREE, mean)
    pads = {name: FREE[name] for name in ("pad_stiffness", "pad_loss_factor")}
    for year, aim in levels.items():
        own, off = fitted(lambda each: hammered(tracks_of(keys | each)), pads, aim)
        warm = [float(row["temperature (C)"]) for row in records if row["date"].startswith(year)]
        stiffness = f"{1e-6 * own['pad_stiffness']:.0f}"
        loss = f"{own['pad_loss_factor']:.2f}"
        rows.append([year, f"{np.mean(warm):.0f}", stiffness, loss, f"{rms(off):.1f}"])
    return table(["B5", "°C", "pad / (MN/m)", "loss of pad", "rms / dB"], rows)


def lateral_at(found):
    """Decay rates sideways at 1.25 kHz, dB/m: what each assumption makes of it."""
    at = int(np.argmin(np.abs(CENTRES - 1250.0)))
    sides = found.railway.rates(REFERENCE, "lateral", "2012", "none")
    usual = {"pad_loss_factor": 0.35, "ballast_loss_factor": 1.0, "rail_loss_factor": 0.02}
    stiff = {"pad_stiffness": 300e6, "pad_roll_stiffness": 900e6 * 0.15**2 / 12.0, "ballast_stiffness": 80e6}
    changes = {
        "a third of the vertical pad, losses as fitted vertically": {},
        "rail with a loss factor of 0.005": {"rail_loss_factor": 0.005},
        "and pads with one of 0.15": {"rail_loss_factor": 0.005, "pad_loss_factor": 0.15},
        "and pads half as stiff": {"rail_loss_factor": 0.005, "pad_loss_factor": 0.15}
        | {name: 0.5 * stiff[name] for name in ("pad_stiffness", "pad_roll_stiffness")},
    }
    rows = [[name, f"{lateral_rates(usual | stiff | each)[at]:.2f}"] for name, each in changes.items()]
    losses = {name: value for name, value in FREE.items() if name.endswith("loss_factor")}
    keys, _ = fitted(lateral_rates, SIDEWAYS | losses, level(sides).mean(axis=0))
    own = f"all fitted: rail {keys['rail_loss_factor']:.2g}, pads {keys['pad_loss_factor']:.2g}"
    rows.append([f"{own} and {1e-6 * keys['pad_stiffness']:.0f} MN/m", f"{lateral_rates(keys)[at]:.2f}"])
    rows.append(["measured, both rails", " and ".join(f"{each:.1f}" for each in sides[:, at])])
    return table(["sideways at 1.25 kHz", "dB/m"], rows)


SIDE = railway_web.TOP - 0.02
"""Height of the side of the head, where EN 15461 strikes it, m."""
SECTION_FORMS = {
    "section keeps its form": {"web_thickness": np.inf},
    "head and foot, web held": {"stiffer": 100.0},
    "head and foot, web bends": {},
    "and a third stiffer": {"stiffer": 1.3},
    "and hammered on the side of the head": {"place": SIDE},
    "web bends, as the package has it": {"web_thickness": None},
    "and that hammered on the side of the head": {"web_thickness": None, "place": SIDE},
}
KEEPS, BENDS_WEB, STRUCK, OWN_WEB, OWN_STRUCK = (tuple(SECTION_FORMS)[k] for k in (0, 2, 4, 5, 6))
UP_TO_2_KHZ = 14
"""Bands."""


def rates_of_form(keys, form):
    """Decay rates sideways (18,), dB/m, of a section by name."""
    told, frequency = SECTION_FORMS[form], lines_of_bands()
    own = head_of_package if "web_thickness" in told else railway_web.head_over_distance
    moved = own(sideways_track(keys), frequency.ravel(), DISTANCES, **told)
    lengths = 1.0 / decay_rate_of_responses(DISTANCES, np.abs(moved)).reshape(frequency.shape)
    return 1.0 / lengths.mean(axis=1)


def head_of_package(track, frequency, distances, web_thickness, place=railway_web.TOP):
    """As `railway_web.head_over_distance`, of the package's own rail with a web."""
    rail = replace(track, web_thickness=web_thickness)
    twist, head = rail.contact_shapes(place - railway_web.TOP)
    moved = rail.waves(2.0 * np.pi * frequency).receptances(0.3 + distances, 0.3)
    return np.einsum("a,xabf,b->xf", head + twist, moved, head + twist)


@cache
def fit_of_form(railway, section, form, bands):
    """Keys of a section that is fitted to lateral rates of so many bands, and rates over measured (18,)."""
    measured = level(railway.rates(section, "lateral", "2012", "none")).mean(axis=0)
    losses = {name: value for name, value in FREE.items() if name.endswith("loss_factor")}
    keys, _ = fitted(lambda keys: rates_of_form(keys, form)[:bands], SIDEWAYS | losses, measured[:bands])
    return keys, level(rates_of_form(keys, form)) - measured


def web_at(found):
    """The reference sideways by form of the section: 1.25 kHz over measured, what is left, and losses."""
    at, rows = int(np.argmin(np.abs(CENTRES - 1250.0))), []
    for form in SECTION_FORMS:
        for bands, upto in ((len(CENTRES), "5 kHz"), (UP_TO_2_KHZ, "2 kHz")):
            keys, off = fit_of_form(found.railway, REFERENCE, form, bands)
            without = level(rates_of_form(keys | {"pad_loss_factor": 1e-3}, form))[at]
            without += off[at] - level(rates_of_form(keys, form))[at]
            rows.append(
                [
                    form,
                    upto,
                    f"{energy(off[at]):.2f}",
                    f"{energy(without):.2f}",
                    f"{rms(off[:bands]):.1f}",
                    f"{keys['rail_loss_factor']:.2g}",
                    f"{keys['pad_loss_factor']:.2g}",
                    f"{1e-6 * keys['pad_stiffness']:.0f}",
                ]
            )
    head = ["", "fitted up to", "1.25 kHz over measured", "with pads that lose nothing", "left, rms dB"]
    return table([*head, "loss of rail", "of pad", "pad / (MN/m)"], rows)


def web_sections(found):
    """All sections sideways: 1.25 kHz over measured and rms of all bands, by form of the section."""
    at, rows = int(np.argmin(np.abs(CENTRES - 1250.0))), []
    forms = KEEPS, BENDS_WEB, STRUCK, OWN_WEB, OWN_STRUCK
    for section in SECTIONS:
        offs = [fit_of_form(found.railway, section, form, len(CENTRES))[1] for form in forms]
        sides = level(found.railway.rates(section, "lateral", "2012", "none"))
        said = [f"{energy(off[at]):.1f}, {rms(off):.1f}" for off in offs]
        scatter = f"{rms(sides[0] - sides[1]):.1f}" if len(sides) > 1 else "one rail"
        rows.append([section, scatter, *said])
    return table(["1.25 kHz over measured, and rms / dB", "left − right / dB", *forms], rows)


def damper_fits(found):
    """Tuned chains from the change of vertical decay rates, 2012 to 2015 and to July 2013."""
    rows = []
    for section in ("B1", "B2", "B3", "B4"):
        before = level(found.railway.rates(section, "vertical", "2012", "none")).mean(axis=0)
        track, _ = fitted(lambda keys: hammered(tracks_of(keys)), FREE, before)
        plain = level(hammered(tracks_of(track)))
        for year in ("2013-07", "2015"):
            after = level(found.railway.rates(section, "vertical", year)).mean(axis=0)
            keys, off = fitted(
                lambda keys, track=track: hammered(tracks_of(track, **keys)), DAMPER, plain + after - before
            )
            rows.append(
                [
                    f"{section} {SECTIONS[section]}, {year}",
                    f"{keys['rail_damper_mass']:.1f}",
                    f"{keys['rail_damper_frequency']:.0f}",
                    f"{keys['rail_damper_loss_factor']:.2f}",
                    f"{rms(after - before):.1f}",
                    f"{rms(off):.1f}",
                ]
            )
    return table(["section", "kg in a bay", "Hz", "loss factor", "change, rms dB", "left, rms dB"], rows)


HEARD = slice(2, 15)
"""250 Hz to 4 kHz, in which spectra are compared."""
AS_IT_IS = "as it is: even and dipoles over a ballast shoulder, in the mean"
SHOULDER = {"ground": "ballast-shoulder", "ground_depth": 0.315}
PLACES = {
    "even, over a ballast shoulder 0.315 m below the rail": SHOULDER,
    "dipoles over it": SHOULDER | {"directivity": "dipole"},
    "even, over grass": SHOULDER | {"ground": "grass"},
    "even, over ground of 10 kPa s/m²": {"flow_resistivity": 10e3, "ground_depth": 0.315},
    "dipoles over hard ground": {"directivity": "dipole"},
    "directivity of CNOSSOS-EU over hard ground": {"directivity": "cnossos"},
    "far rail screened by 10 dB, hard ground": {"rail_distance": 1.5, "far_rail_screening": 10.0},
}
RUNS = {
    "wheel with a curved web": {"wheel": {"section": "curved-web"}},
    "wheel with a bent web": {"wheel": {"section": "bent-web"}},
    "contact in the middle of the head": {"place": 0.0},
    "rail whose web bends sideways": {"web": railway_web.THICKNESS},
    "continuous supports, rates as measured": {"track": {"continuous": True}},
}


def candidates(found):
    """Blind spectra of coaches at the reference, and what each assumption makes of them."""
    measured, total = found.coach
    case, tree = found.reference
    ensemble = found.blind
    slower = ensemble.level(REFERENCE, COACH, INTERCITY_SPEED)[0]
    slower = slower - ensemble.level(REFERENCE, COACH, SPEED)[0]
    plain, own = heard(case, tree), found.spectrum(REFERENCE)
    up, all_up = (level(energy(plain[rows]).sum(axis=0)) for rows in ([0, 2], [0, 2, 3]))
    spectra = {
        "rail up and down and sleepers, hard ground": up,
        "and the wheel": all_up,
        "and the rail sideways": plain[-1],
        AS_IT_IS: own,
    }
    for name, keys in PLACES.items():
        spectra[name] = heard(case.with_(noise=keys), tree)[-1]
    for name, keys in RUNS.items():
        other = found.case(REFERENCE, duration=0.5, **keys)
        spectra[name] = own + over_middle(other, asperity.run(other)) - over_middle(case, tree)
    along = mean_of(found.runs[REFERENCE])
    along[PARTS.index("rail")] += railway_by_hand.of_waves(
        tracks_of(found.track)[0], BAND, AXLES | MICROPHONE, NEAR
    )
    spectra["waves along the rail, in their near field"] = level(energy(along).sum(axis=0))
    waves = found.railway.wavelengths

    def rough(levels, wheels=0.0):
        both = [at_bands(waves, each, SPEED) for each in (levels, ensemble.wheels("disc") + wheels)]
        return level(sum(energy(each) for each in both))

    own = mean_roughness(found.railway.rail_roughness(REFERENCE, 4))
    base = rough(own)
    spectra["wheels smoother by 4 dB"] = spectra[AS_IT_IS] + rough(own, -4.0) - base
    for name, rail in (("left", 0), ("right", 1)):
        both = energy(found.railway.rail_roughness(REFERENCE, 4))
        nearer = level(NEAR * both[rail] + (1.0 - NEAR) * both[1 - rail])
        spectra[f"the {name} rail is the near one"] = spectra[AS_IT_IS] + rough(nearer) - base
    other = mean_roughness(found.railway.rail_roughness(REFERENCE, 2))
    spectra["roughness of a year before"] = spectra[AS_IT_IS] + rough(other) - base
    rows, offs = [], {}
    for name, each in spectra.items():
        off = each + slower - measured
        offs[name] = off
        about = off[HEARD] - off[HEARD].mean()
        computed = float(level(energy(each + slower).sum()))
        rows.append([name, f"{computed:.1f}", signed(off[HEARD].mean()), f"{rms(about):.1f}"])
    rows.append(["measured", f"{total:.1f}", "", ""])
    return table(["", "dB(A)", "mean of bands less measured", "rms about it"], rows), offs


def sleeper_candidates(found):
    """What could make sleepers quieter from 250 to 400 Hz, each computed by itself; and what is left of all.

    Changes of the sleepers alone, or of all sound where a board is the candidate; then spectra.
    """
    measured, (case, tree) = found.coach[0], found.reference
    parts, at = mean_of(found.runs[REFERENCE]), PARTS.index("sleepers")
    track = tracks_of(found.track)[0]
    nominal = found.blind
    slower = nominal.level(REFERENCE, COACH, INTERCITY_SPEED)[0] - nominal.level(REFERENCE, COACH, SPEED)[0]
    none, own = np.zeros(len(BAND)), parts[at]

    def over(resistivity):
        each = [
            [heard(case.with_(noise=ground | {"ground_depth": depth}), tree)[at] for depth in DEPTHS]
            for ground in ({"flow_resistivity": resistivity}, {"ground": "ballast-shoulder"})
        ]
        soft, firm = (level(energy(levels).mean(axis=0)) for levels in each)
        return soft - firm

    bends = tracks_of(found.track | {"sleeper_bending_stiffness": BENDING, "sleeper_loss_factor": 0.03})[0]
    changes = {
        "as it is: circles in a plane, each by itself": (none, none),
        "a strip of 1.3 m by 0.25 m": (railway_sleepers.of_shape(BAND), none),
        "strips, together as they move": (railway_sleepers.of_neighbours(track, BAND), none),
        "strips, both rails alike": (railway_sleepers.of_neighbours(track, BAND, both_rails=True), none),
        "half of each top under ballast": (railway_sleepers.of_covering(BAND), none),
        "air goes round: dipoles": (railway_sleepers.of_dipole(BAND), none),
        "sleepers that bend": (railway_sleepers.of_track(track, bends, BAND), none),
        "board of 1.6 m by 1.6 m, sound upon it": (none, railway_sleepers.of_board(BAND)),
        "the same, from 35° below": (none, railway_sleepers.of_board(BAND, np.radians(35.0))),
        "no doubling by the board": (none, none - MICROPHONE["receiver_offset"]),
    }
    for name, resistivity in SOFT.items():
        changes[name] = (over(resistivity), none)
    quiet = np.where((BAND > 240.0) & (BAND < 410.0), -200.0, 0.0)
    changes["no sleepers at all from 250 to 400 Hz"] = (quiet, none)
    rows, three = [], [NAMES.index(each) for each in ("250 Hz", "315 Hz", "400 Hz")]
    for name, (sleepers_by, all_by) in changes.items():
        changed = parts.copy()
        changed[at] = own + sleepers_by
        spectrum = level(energy(changed).sum(axis=0)) + all_by + slower
        off = spectrum - measured
        about = off[HEARD] - off[HEARD].mean()
        moved = spectrum - level(energy(parts).sum(axis=0)) - slower
        said = [*(signed(moved[k]) for k in three), *(signed(off[k]) for k in three)]
        rows.append([name, *said, f"{rms(about):.1f}", f"{level(energy(spectrum).sum()):.1f}"])
    plain = level(energy(parts).sum(axis=0)) + slower - measured
    for name, bands in RIGHT.items():
        off = np.where(np.isin(NAMES, bands), 0.0, plain)
        about = off[HEARD] - off[HEARD].mean()
        total = level(energy(measured + off).sum())
        rows.append([name, *[""] * 3, *(signed(off[k]) for k in three), f"{rms(about):.1f}", f"{total:.1f}"])
    head = ["sleepers", "change at 250 Hz", "315 Hz", "400 Hz", "then less measured", "315 Hz", "400 Hz"]
    return table([*head, "bands, rms dB", "dB(A)"], rows)


LOW, PINNED = ("250 Hz", "315 Hz", "400 Hz"), ("1 kHz", "1.25 kHz")
RIGHT = {
    "right from 250 to 400 Hz, by whatever": LOW,
    "and at 1 and 1.25 kHz": LOW + PINNED,
    "and at 4 kHz": (*LOW, *PINNED, "4 kHz"),
}
SOFT = {"ground of 50 kPa s/m²": 50e3, "ground of 10 kPa s/m²": 10e3}


def half_width(ensemble, known=(), scale=0.0):
    """Half of the 80 % interval of the A-level of coaches, dB, where what is known scatters so much less."""
    kept = ensemble.held
    try:
        ensemble.held = {
            name: each[:1] + scale * (each - each[:1]) if name in known else each
            for name, each in kept.items()
        }
        total = level(energy(ensemble.level(REFERENCE, COACH, INTERCITY_SPEED)).sum(axis=1))
    finally:
        ensemble.held = kept
    _, low, high = interval(total)
    return 0.5 * (high - low)


def widths(found):
    """What makes the interval of the A-level as wide as it is, and how well wheels would have to be known."""
    ensemble, wheels = found.blind, "wheels of coach"
    groups = {
        "all": (),
        "wheels' roughness known": (wheels,),
        "how the parts radiate known": tuple(f"share of {part}" for part in PARTS),
        "the rail's roughness known": (f"{REFERENCE} roughness",),
        "decay rates known": (f"{REFERENCE} vertical", f"{REFERENCE} lateral"),
        "level of the place and of other sources known": ("offset", "others"),
    }
    rows = [[name, f"± {half_width(ensemble, known):.1f}"] for name, known in groups.items()]
    radiate = groups["how the parts radiate known"]
    both = wheels, *radiate
    rows.insert(3, ["both of these known", f"± {half_width(ensemble, both):.1f}"])
    return table(["", "80 % / dB(A)"], rows), brentq(lambda s: half_width(ensemble, both, s) - 3.0, 0.0, 1.0)


def spectrum_table(found):
    """Coaches at the reference: measured, as first stated, anew, by part, and after what was seen there."""
    measured, total = found.coach
    parts, stated = mean_of(found.runs[REFERENCE]), found.stated["coaches"]
    blind = found.blind.level(REFERENCE, COACH, INTERCITY_SPEED)
    after = found.after_reference.level(REFERENCE, COACH, INTERCITY_SPEED)

    def rounded(draws):
        return "{:.1f} ({:.0f} … {:.0f})".format(*interval(draws))

    rows = [
        [
            name,
            f"{measured[k]:.1f}",
            stated[name],
            rounded(blind[:, k]),
            *(f"{each:.1f}" for each in parts[:, k]),
            rounded(after[:, k]),
        ]
        for k, name in enumerate(NAMES)
    ]
    anew, seen = (level(energy(each).sum(axis=1)) for each in (blind, after))
    of_parts = level(energy(parts).sum(axis=1))
    last = [f"{total:.1f}", stated["dB(A)"], rounded(anew), *(f"{each:.1f}" for each in of_parts)]
    rows.append([f"**{each}**" for each in ["dB(A)", *last, rounded(seen)]])
    head = [
        "band",
        "measured",
        "as first stated, 80 %",
        "anew, 80 %",
        *PARTS,
        "one roughness of wheels, 80 %",
    ]
    return table(head, rows)


def by_hand(found):
    """A run held against formulas, over bands from 160 Hz to 2.5 kHz."""
    case, tree = found.reference
    kept = slice(0, 13)
    force, faster = railway_by_hand.force(case, tree, BAND)
    plain = heard(case, tree)[PARTS.index("rail")]
    compared = {
        "contact force: receptances at places that stand still, filter of CNOSSOS-EU": (
            railway_by_hand.at_bands(tree, "force_level", BAND)[0] - force
        ),
        "∫⟨v²⟩dx of the rail: six points of a bay that the wheel passes": (
            -railway_by_hand.rail_at_points(case, tree, BAND)
        ),
        "rail at the microphone, over hard ground: p² = W′ρc/2d": (
            plain - railway_by_hand.at_microphone(tree, BAND, AXLES | MICROPHONE)
        ),
    }
    rows = [
        [name, signed(off[kept].mean()), f"{np.std(off[kept]):.1f}", f"{np.abs(off[kept]).max():.1f}"]
        for name, off in compared.items()
    ]
    head = ["the run less what is computed by hand / dB", "mean", "rms about it", "largest"]
    return table(head, rows), dict(zip(NAMES, faster, strict=True))


def vehicles(found):
    """Vehicles at the reference, in the mean of a train and one by one: tables, and what they say in numbers.

    Computed blind, and with one roughness of all wheels and one offset of the board. What one vehicle or one
    train has beside these is drawn with the scatter of those of all other trains.
    """
    passed = found.railway.vehicles
    trains = np.array([each.train for each in passed])
    coaches = np.array([each.types == COACH for each in passed])
    speeds, measured = (np.array([getattr(each, name) for each in passed]) for name in ("speed", "total"))
    blind, seen = (
        np.stack([totals(ensemble.level(REFERENCE, each.types, each.speed)) for each in passed])
        for ensemble in (found.blind, found.after_reference)
    )
    one = with_scatter_of_others(seen, measured, trains, coaches)
    told = [interval(draws.T) for draws in (blind, one)]
    by_vehicle = [
        [each.train, each.number, each.name, f"{each.speed:.1f}", f"{each.total:.1f}"]
        + [f"{end:.1f}" for draws in told for end in draws[:, k]]
        for k, each in enumerate(passed)
    ]
    names = sorted(set(trains.tolist()))
    of_trains = [
        [draws[coaches & (trains == name)].mean(axis=0) for name in names] for draws in (blind, seen)
    ]
    means = np.array([measured[coaches & (trains == name)].mean() for name in names])
    whole = with_scatter_of_others(np.stack(of_trains[1]), means, np.array(names), np.zeros(len(names)))
    by_train = []
    for k, name in enumerate(names):
        kept = coaches & (trains == name)
        by_train.append(
            [
                str(name),
                f"{kept.sum()}",
                f"{speeds[kept].mean():.0f}",
                f"{means[k]:.1f} ± {np.std(measured[kept], ddof=1):.1f}",
                in_words(of_trains[0][k]),
                in_words(whole[k]),
                " ".join(signed(each) for each in (measured - told[1][0])[kept]),
                " ".join(signed(each) for each in (measured - told[1][0])[~coaches & (trains == name)])
                or "–",
            ]
        )
    head = ["train", "coaches", "km/h", "measured, ± of one coach", "blind, 80 %"]
    head += ["one roughness, one offset, 80 %", "each coach, measured less computed", "with the locomotive"]
    inside = [[held(draws, measured, kept) for kept in (coaches, ~coaches)] for draws in told]
    return {
        "trains": table(head, by_train),
        "coaches_inside_blind": inside[0][0],
        "locomotives_inside_blind": inside[0][1],
        "coaches_inside": inside[1][0],
        "locomotives_inside": inside[1][1],
        "trains_inside": held(interval(whole.T), means),
        "coach_scatter": rms((measured - told[1][0])[coaches]),
        "coach_half": float(np.mean(np.diff(told[1][1:, coaches], axis=0)) / 2.0),
        "trains_rms": rms(means - np.median(of_trains[1], axis=1)),
        "vehicles": int(coaches.sum()),
    }, by_vehicle


VEHICLES = (
    *(
        "train",
        "interval",
        "vehicles",
        "speed (km/h)",
        "measured (dB(A))",
        "blind (dB(A))",
        "blind, low (dB(A))",
    ),
    *("blind, high (dB(A))", "computed (dB(A))", "low (dB(A))", "high (dB(A))"),
)


def totals(levels):
    """A-weighted levels (draws,), dB, of levels in bands (draws, bands)."""
    return level(energy(levels).sum(axis=1))


def in_words(draws):
    """Median and 80 % interval of levels (n,)."""
    return "{:.1f} ({:.1f} … {:.1f})".format(*interval(draws))


def held(told, measured, kept=slice(None)):
    """How many of those measured (n,) lie within an interval (3, n), in words."""
    inside = ((measured >= told[1]) & (measured <= told[2]))[kept]
    return f"{inside.sum()} of {inside.size}"


def with_scatter_of_others(draws, measured, groups, kinds):
    """Draws (n, draws) with the scatter of what was measured (n,) of the same kind in other groups (n,)."""
    off = measured - np.median(draws, axis=1)
    drawn = np.random.default_rng(SEED + 3).standard_normal(draws.shape)
    scatter = [
        rms(off[(kinds == kind) & (groups != group)]) for group, kind in zip(groups, kinds, strict=True)
    ]
    return draws + np.array(scatter)[:, None] * drawn


def course(found):
    """How the A-level of coaches goes with the speed, by train, measured and computed: n of n lg v."""
    passed = [each for each in found.railway.vehicles if each.types == COACH]
    names = sorted({each.train for each in passed})
    of_train = [[(e.speed, e.total) for e in passed if e.train == name] for name in names]
    speeds, levels = np.array([np.mean(each, axis=0) for each in of_train]).T
    slope, covariance = np.polyfit(np.log10(speeds), levels, 1, cov=True)
    faster = speeds > speeds.min()
    without, apart = np.polyfit(np.log10(speeds[faster]), levels[faster], 1, cov=True)
    ends = speeds.min(), speeds.max()

    def computed(ensemble):
        slow, fast = (totals(ensemble.level(REFERENCE, COACH, v)) for v in ends)
        return "{:.0f} ({:.0f} … {:.0f})".format(*interval((fast - slow) / np.log10(ends[1] / ends[0])))

    return {
        "slope": slope[0],
        "slope_error": float(np.sqrt(covariance[0, 0])),
        "slope_without": without[0],
        "slope_without_error": float(np.sqrt(apart[0, 0])),
        "slope_blind": computed(found.blind),
        "slope_computed": computed(found.after_reference),
        "slowest": ends[0],
        "fastest": ends[1],
    }


def board(found):
    """Offset of the board and roughness of wheels, blind and after the reference, and what goes with it."""
    ensembles = found.blind, found.after_reference
    stated = MICROPHONE["receiver_offset"]
    rows = [["board, dB", *(with_interval(stated + each.held["offset"][:, 0]) for each in ensembles)]]
    waves, wheels = found.railway.wavelengths, "wheels of coach"
    for wave in WAVES:
        at = int(np.argmin(np.abs(np.log(waves / wave))))
        rows.append(
            [
                f"wheels of coaches at {100.0 * waves[at]:.2g} cm, dB re 1 µm",
                *(with_interval(each.held[wheels][:, at]) for each in ensembles),
            ]
        )
    after = found.after_reference.held
    heard_waves = (waves > 0.007) & (waves < 0.16)
    common = after[wheels][:, heard_waves].mean(axis=1)
    shares = sum(after[f"share of {part}"].mean(axis=1) for part in PARTS) / len(PARTS)
    return {
        "board": table(["", "blind, 80 %", "after the reference, 80 %"], rows),
        "board_wheels": f"{np.corrcoef(after['offset'][:, 0], common)[0, 1]:+.1f}".replace("-", "−"),
        "board_shares": f"{np.corrcoef(after['offset'][:, 0], shares)[0, 1]:+.1f}".replace("-", "−"),
    }


WAVES = (0.125, 0.08, 0.05, 0.0315, 0.02, 0.0125, 0.008)
"""m, of the bands of wheels' roughness that are printed."""


def dampers_on_pads():
    """What dampers do to the level at 120 km/h on soft and on stiff pads, dB(A).

    Also as the printed method has it: decay rates of a free rail with dampers add to those of the track, here
    on supports that are continuous; a damper changes nothing else.
    """
    damper = {"rail_damper_mass": 17.0, "rail_damper_frequency": 1000.0, "rail_damper_loss_factor": 0.35}
    free = {
        "pad_stiffness": 1e4,
        "pad_loss_factor": 0.2,
        "ballast_stiffness": 50e6,
        "ballast_loss_factor": 1.0,
    }
    free |= {"rail_loss_factor": 1e-4, "continuous": True}
    more = HammerTest.of_track(Track.named("uic60", **free, **damper), BAND).decay_rate
    rail, rows = PARTS.index("rail"), []
    for stiffness, printed in ((120e6, -2.5), (800e6, -0.7)):
        pads = {"pad_stiffness": stiffness, "pad_loss_factor": 0.2, "rail_loss_factor": 0.02}
        bed = {"ballast_stiffness": 50e6, "ballast_loss_factor": 1.0}

        def bands(web, keys, plain=pads | bed):
            case = passing(plain | keys, 120.0, "iso3095", duration=0.5, wheel={"section": web})
            return energy(heard(case, asperity.run(case)))

        changes = []
        for web in ("straight-web", "curved-web"):
            before, after = (level(bands(web, keys).sum(axis=1)) for keys in ({}, damper))
            changes.append(after - before)
        even = bands("curved-web", {"continuous": True})[: len(PARTS)]
        own = HammerTest.of_track(Track.named("uic60", continuous=True, **pads, **bed), BAND).decay_rate
        added = even.copy()
        added[rail] *= own / (own + more)
        ratios = [added.sum() / even.sum(), added[rail].sum() / even[rail].sum()]
        found = [*(each[at] for at in (-1, rail) for each in changes)]
        found[2:2], found[5:] = [level(ratios[0])], [level(ratios[1])]
        rows.append([f"{1e-6 * stiffness:.0f} MN/m", signed(printed), *(signed(each) for each in found)])
    head = ["pads", "printed / dB(A)"]
    for what in ("all", "rail up and down"):
        head += [f"{what}, {how}" for how in ("plane web", "curved web", "curved web, decay rates added")]
    return table(head, rows)


def drawn(found, rates, folder):
    """Two figures: decay rates, and differences of sections."""
    import matplotlib as mpl

    mpl.use("svg")
    mpl.rcParams["svg.hashsalt"] = "measured railway"
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(1, 2, figsize=(9.0, 3.8), sharey=True, layout="constrained")
    colours = dict(zip(SECTIONS, ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#222222"), strict=True))
    for axis, kind, title in zip(axes, (KINDS[3], "lateral"), ("up and down", "sideways"), strict=True):
        for section, colour in colours.items():
            aim, own = rates[section, kind]
            axis.loglog(CENTRES, energy(aim), "o", color=colour, ms=3.5)
            axis.loglog(CENTRES, energy(own), "-", color=colour, lw=1.0, label=section)
        axis.set(title=title, xlabel="band / Hz", xticks=[125, 250, 500, 1000, 2000, 4000])
        axis.set_xticklabels(["125", "250", "500", "1k", "2k", "4k"])
        axis.minorticks_off()
        axis.grid(alpha=0.3)
    axes[0].set(ylabel="decay rate / (dB/m)", yticks=[0.3, 1, 3, 10])
    axes[0].set_yticklabels(["0.3", "1", "3", "10"])
    axes[1].legend(title="measured (dots), fitted", ncols=2, fontsize=8, title_fontsize=8)
    figure.savefig(folder / "measured_railway_decay.svg", metadata={"Date": None})
    plt.close(figure)

    figure, axes = plt.subplots(1, 3, figsize=(10.0, 3.4), sharey=True, layout="constrained")
    at = np.arange(len(BAND))
    shown = [("B4", found.blind), ("B2", found.after_strail), ("B3", found.after_strail)]
    for axis, (section, ensemble) in zip(axes, shown, strict=True):
        middle, low, high = interval(found.difference(ensemble, section)[0])
        axis.fill_between(at, low, high, color="#0072b2", alpha=0.2, lw=0, label="anew, 80 %")
        axis.plot(at, middle, color="#0072b2", label="anew")
        axis.plot(at, found.first_stated(section), "--", color="#d55e00", lw=1.2, label="as first stated")
        if section == "B4":
            axis.plot(
                at, found.measured_difference.mean(axis=0)[:-1], "o-", color="#222222", label="measured"
            )
        axis.axhline(0.0, color="#888888", lw=0.8)
        axis.set(
            title=SECTIONS[section] + (", blind" if section == "B4" else ", kept back"), xlabel="band / Hz"
        )
        axis.set_xticks(at[::3], [each.replace(" Hz", "").replace(" kHz", "k") for each in NAMES[::3]])
        axis.grid(alpha=0.3)
    axes[0].set_ylabel("section less reference / dB")
    axes[0].legend(fontsize=8)
    figure.savefig(folder / "measured_railway.svg", metadata={"Date": None})
    plt.close(figure)


def strail(found):
    """Strail less reference: measured, as first stated, and anew, blind and after the reference."""
    measured, spread = (f(found.measured_difference, axis=0) for f in (np.mean, np.std))
    columns = [found.difference(each, "B4") for each in (found.blind, found.after_reference)]
    by_run = found.spectrum("B4") - found.spectrum(REFERENCE)
    rows = [
        [
            name,
            f"{signed(measured[k])} ± {spread[k]:.1f}",
            *found.stated["strail"][name],
            signed(by_run[k]),
            *(with_interval(bands[:, k]) for bands, _ in columns),
        ]
        for k, name in enumerate(NAMES)
    ]
    of_run = total_difference(found.spectrum(REFERENCE), by_run)
    last = [f"{signed(measured[-1])} ± {spread[-1]:.1f}", *found.stated["strail"]["dB(A)"], signed(of_run)]
    rows.append([f"**{each}**" for each in ["dB(A)", *last, *(with_interval(total) for _, total in columns)]])
    head = ["band", "measured, ± of one train", "stated, blind", "stated, after the reference"]
    return table([*head, "two runs of a coach", "anew, blind", "anew, after the reference"], rows)


def strail_in_numbers(found):
    """Band rms of the prediction, of no difference, and how many bands lie in the interval."""
    measured = found.measured_difference.mean(axis=0)
    said = []
    for ensemble in (found.blind, found.after_reference):
        bands, _ = found.difference(ensemble, "B4")
        middle, low, high = interval(bands)
        off, inside = middle - measured[:-1], (measured[:-1] >= low) & (measured[:-1] <= high)
        sure = (low > 0.0) | (high < 0.0)
        of_sure = [float(np.sqrt(np.mean(each[sure] ** 2))) for each in (off, measured[:-1])]
        said.append((float(np.sqrt(np.mean(off**2))), int(inside.sum()), int(sure.sum()), *of_sure))
    return said, float(np.sqrt(np.mean(measured[:-1] ** 2)))


def split(rows):
    """Head and rows of a table."""
    return rows[0], rows[1:]


def page(found, folder):
    """Text of the page; its figures go into a folder."""
    (blind, after), none = strail_in_numbers(found)
    fits, rates = decay_fits(found)
    tried, of_nearest = found.tried, found.candidates_of_rates[-1]
    assumed, offs = candidates(found)
    checked, faster = by_hand(found)
    wide, share_known = widths(found)
    drawn(found, rates, folder)
    fitted_off = {section: rms(np.subtract(*rates[section, KINDS[3]])) for section in SECTIONS}
    write_table(
        LEDGER,
        ledger(found, fitted_off, {name: rms(off) for name, (_, off) in of_nearest.items()}, offs),
        folder / "measured_railway.csv",
    )
    write_table(SHOWN, shown(found), folder / "railway_sections.csv")
    one_by_one, of_vehicles = vehicles(found)
    write_table(VEHICLES, of_vehicles, folder / "railway_vehicles.csv")
    off = offs[AS_IT_IS]
    whole = interval(level(energy(found.blind.level(REFERENCE, COACH, INTERCITY_SPEED)).sum(axis=1)))
    return (
        Path(__file__)
        .with_suffix(".txt")
        .read_text(encoding="utf-8")
        .format(
            predicted=table(*split(found.stated["predicted"])),
            regional=table(*split(found.stated["regional"])),
            anew=table(*split(found.stated["predicted anew"])),
            regional_anew=table(*split(found.stated["regional anew"])),
            strail=strail(found),
            fits=fits,
            candidates_of_rates=found.candidates_of_rates[0],
            nearest=found.candidates_of_rates[1],
            bays=bays_table(found.railway, tried.in_bays[BY_ITSELF]),
            tried=tried.table(),
            verdicts=tried.verdicts(),
            highest=highest_band(found),
            worst=tried.left[FOOT][REFERENCE][-1],
            subgrades=tried.subgrades(),
            losses=losses_on_limits(found.railway, of_nearest),
            losses_of_foot=losses_on_limits(found.railway, tried.fits[FOOT], TRIED[FOOT][2]),
            lateral=lateral_at(found),
            web=web_at(found),
            web_sections=web_sections(found),
            determined=determined(found),
            temperature=over_temperature(found),
            dampers=damper_fits(found),
            spectrum=spectrum_table(found),
            sleepers=sleeper_candidates(found),
            widths=wide,
            share_known=share_known,
            wheels_known=TYPES["coach"][1] * share_known,
            candidates=assumed,
            by_hand=checked,
            faster_1000=signed(faster["1 kHz"]),
            faster_1250=signed(faster["1.25 kHz"]),
            pads=dampers_on_pads(),
            blind_middle=whole[0],
            agreement=found.agreement,
            blind_offset=signed(off[HEARD].mean()),
            blind_about=rms(off[HEARD] - off[HEARD].mean()),
            blind_low=whole[1],
            blind_high=whole[2],
            measured_a=found.coach[1],
            blind_rms=blind[0],
            blind_inside=blind[1],
            none_rms=none,
            after_rms=after[0],
            after_inside=after[1],
            sure=blind[2],
            sure_rms=blind[3],
            sure_none=blind[4],
            sure_after=after[2],
            after_sure_rms=after[3],
            after_sure_none=after[4],
            **one_by_one,
            **course(found),
            **board(found),
        )
    )


SOURCE = "Swiss Federal Railways, Niederwangen 2012 to 2015"


def ledger(found, fits, left, offs):
    """Rows for the page of conformance: what, who measured it, measured, computed, deviation."""
    (blind, _), _ = strail_in_numbers(found)
    apart = found.difference(found.blind, "B4")[1]
    measured = found.measured_difference.mean(axis=0)[-1]
    coaches = found.blind.level(REFERENCE, COACH, INTERCITY_SPEED)
    total = level(energy(coaches).sum(axis=1))
    band, offset = off_bands(offs[AS_IT_IS])
    anew = [
        (f"{with_interval(apart)} dB(A)", f"{signed(interval(apart)[0] - measured)} dB"),
        ("", f"{blind[0]:.1f} dB rms"),
        (
            "{:.1f} ({:.0f} … {:.0f}) dB(A)".format(*interval(total)),
            f"{signed(interval(total)[0] - found.coach[1])} dB",
        ),
        (f"{signed(offset)} dB in the mean", f"{rms(band):.1f} dB rms about it"),
    ]
    rows = []
    for (what, aim, *first), (computed, off) in zip(found.stated["ledger"], anew, strict=True):
        rows.append((what, aim, *first))
        rows.append((what, aim, ", ".join(each for each in (computed, "anew") if each), off))
    for section, off in fits.items():
        what = f"vertical decay rates of {section}, 100 Hz to 5 kHz"
        rows.append((what, "18 bands", "five keys and how the hammer strikes fitted", f"{off:.1f} dB rms"))
        rows.append(
            (what, "18 bands", "nine keys fitted, pads stiffen, sleepers bend", f"{left[section]:.1f} dB rms")
        )
    return [[row[0], SOURCE, *row[1:]] for row in rows]


def off_bands(off):
    """Deviations in the bands that are compared, about their mean, and that mean."""
    return off[HEARD] - off[HEARD].mean(), off[HEARD].mean()


LEDGER = "what", "source", "measured", "computed", "deviation"
SHOWN = (
    *("section", "band (Hz)", "predicted (dB)", "low (dB)", "high (dB)", "measured (dB)"),
    *("anew (dB)", "anew, low (dB)", "anew, high (dB)"),
)


def shown(found):
    """Section by section and band by band: as first stated, measured, and as stated anew."""
    return [
        [*first, *anew]
        for first, anew in zip(found.stated["sections"], found.stated["sections anew"], strict=True)
    ]


def write_table(head, rows, file):
    with file.open("w", encoding="utf-8", newline="") as lines:
        csv.writer(lines, lineterminator="\n").writerows([head, *rows])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("data", type=Path, help="folder of decay_rates.csv and the others")
    parser.add_argument("-o", "--output", type=Path, required=True, help="folder of the page and its figures")
    given = parser.parse_args()
    found = Found(Railway(given.data))
    text = page(found, given.output)
    (given.output / "measured_railway.md").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    main()
