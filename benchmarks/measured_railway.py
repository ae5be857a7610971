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
import warnings
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares

import asperity
from asperity.case.bodies import WheelOnRail
from asperity.reference import cnossos
from asperity.scenes.measured import HammerTest
from asperity.spectra import a_weighting, nominal_frequency
from asperity.structures.track import Track

SECTIONS = {"B1": "Tata", "B2": "Schrey & Veit", "B3": "Vossloh", "B4": "Strail", "B5": "none"}
REFERENCE = "B5"
NUMBERS = np.arange(22, 38)
"""Of the one-third octaves that are compared, 160 Hz to 5 kHz: below, the board is in the near field."""
BAND = 10.0 ** (0.1 * NUMBERS)
AXLES = {"axle_positions": [0.0, 2.5, 19.0, 21.5], "vehicle_length": 26.4, "vehicles": 9}
MICROPHONE = {"receiver_distance": 3.1, "receiver_height": 0.7, "rail_distance": 1.5, "receiver_offset": 6.0}
"""2.35 m from the near rail's middle, 0.7 m above it, flush in a board that doubles the pressure."""
WHEEL = {"section": "straight-web", "load": 55e3, "roughness": "disc"}
PLACE = -7.5e-3
"""Of the contact across the head, m: a tread of 1:20 on a head of 300 mm that leans by 1:40."""
DRAWS, SEED = 4000, 1
PARTS = ("rail", "rail sideways", "sleepers", "wheel")


def level(energy):
    return 10.0 * np.log10(energy)


def energy(level):
    return 10.0 ** (0.1 * np.asarray(level))


# --- the tables


@dataclass(frozen=True)
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
    "pad_stiffness": (100e6, 2000e6, 600e6),
    "pad_loss_factor": (0.05, 0.35, 0.2),
    "ballast_stiffness": (20e6, 300e6, 80e6),
    "ballast_loss_factor": (0.3, 2.0, 1.0),
    "rail_loss_factor": (0.001, 0.02, 0.006),
}


def fitted_track(rates, **more):
    """Track whose vertical decay rates are nearest to those of both rails, and how far they are, dB."""
    aim = np.mean(level(rates), axis=0)
    low, high, first = (np.log10([each[k] for each in FREE.values()]) for k in range(3))

    def track(unknowns):
        return Track.named("uic60", **dict(zip(FREE, (10.0**unknowns).tolist(), strict=True)), **more)

    def off(unknowns):
        return level(HammerTest.of_track(track(unknowns), CENTRES).decay_rate) - aim

    fit = least_squares(off, first, bounds=(low, high), x_scale=0.1)
    return track(fit.x), fit.fun


# --- the sound of a section, by a run


def spectrum_of(wavelengths, levels):
    """Table of a roughness, longest wave first, with what is longer than was measured as at 0.32 m."""
    exact = 10.0 ** (0.1 * np.round(10.0 * np.log10(wavelengths)))
    longer = exact[0] * 10.0 ** (0.1 * np.arange(8, 0, -1))
    return np.column_stack([np.append(longer, exact), np.append(np.full(8, levels[0]), levels)])


def passing(track, speed, rail, wheel, rates=None, duration=1.0, **noise):
    """Case of a wheel on a rail with a roughness of both (tables, dB re 1 um), at a speed, km/h."""
    keys = {name: getattr(track, name) for name in FREE}
    if rates is not None:
        keys["decay_rates"] = np.column_stack([CENTRES, rates.T])
    return WheelOnRail(
        laws=["linear-filtered"],
        speed=speed / 3.6,
        duration=duration,
        settling=0.2,
        surface={"spectrum": rail},
        wheel=WHEEL | {"roughness": wheel},
        track={"name": "uic60"} | keys,
        sideways={"contact_place": PLACE},
        noise=AXLES | MICROPHONE | noise,
    )


def heard(case):
    """A-weighted equivalent levels at the microphone in `BAND` by part, then of all (5, bands), dB."""
    tree = asperity.run(case)
    group = tree["pass_by"]
    over_time = float(group.attrs["rear_time"] - group.attrs["front_time"])
    exposure = group["sound_exposure_level"].sel(radiator=[*PARTS, "total"])[0]
    numbers = np.rint(10.0 * np.log10(group["band"].values)).astype(int)
    kept = np.isin(numbers, NUMBERS)
    return exposure.values[:, kept] - level(over_time) + a_weighting(BAND)


def mean_roughness(lines):
    return level(energy(lines).mean(axis=0))


def at_bands(wavelengths, levels, speed):
    """Roughness levels (..., 25) at the wavelengths v/f of `BAND`, between bands by lg λ."""
    place, at = np.log10(speed / 3.6 / BAND), np.log10(wavelengths)[::-1]
    return np.apply_along_axis(lambda each: np.interp(place, at, each[::-1]), -1, np.asarray(levels))


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

    def __init__(self, railway, parts, speed):
        self.railway, self.parts, self.speed = railway, parts, speed
        self.generator = np.random.default_rng(SEED)
        self.waves, self.held = railway.wavelengths, {}
        for name, deviation in zip(PARTS, SHARES, strict=True):
            self.held[f"share of {name}"] = self._drawn(deviation, len(BAND))
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
        """Errors that are common to all bands, and those of each, (draws, count); none of the first."""
        draw = self.generator.standard_normal
        found = deviation * (0.8 * draw((DRAWS, 1)) + 0.6 * draw((DRAWS, count)))
        found[0] = 0.0
        return found

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
        campaigns = np.stack([mean_roughness(self.railway.rail_roughness(name, c)) for c in CAMPAIGNS])
        self.held[f"{name} roughness"] = campaigns[self.campaign] + self._drawn(1.5, len(self.waves))
        for direction in ("vertical", "lateral"):
            rates = np.stack([self.railway.rates(name, direction, year)[:, 2:] for year in YEARS])
            apart = self.railway.scatter[direction][2:]
            scatter = np.exp(apart * self.generator.standard_normal((DRAWS, *rates.shape[1:])))
            scatter[0] = 1.0
            self.held[f"{name} {direction}"] = np.log(np.mean(1.0 / (rates[self.year] * scatter), axis=1))

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
INTERCITY_SPEED, REGIONAL_SPEED = 136.0, 120.0
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
    def track(self):
        """Of the reference in 2015, by its vertical decay rates."""
        return fitted_track(self.railway.rates(REFERENCE, "vertical", "2015"))[0]

    def run(self, section, speed=139.0):
        """Levels by part, and of all (5, bands), of a coach of a section, as measured on it."""
        rail = spectrum_of(self.railway.wavelengths, mean_roughness(self.railway.rail_roughness(section, 4)))
        return heard(passing(self.track, speed, rail, "disc", rates_of(self.railway, section)))

    @cached_property
    def runs(self):
        """Of the reference and the section with Strail dampers."""
        return {section: self.run(section) for section in (REFERENCE, "B4")}

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
        return Ensemble(self.railway, self.runs[REFERENCE][:4], 139.0)

    @cached_property
    def blind(self):
        """What is known before any pass-by."""
        return self.ensemble()

    def _seen_at_reference(self, ensemble):
        at = REFERENCE, INTERCITY_SPEED
        each = [ensemble.level(at[0], types, at[1]) for types in ({"coach": 1.0}, HALF)]
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

    def difference(self, ensemble, section):
        """Of intercity trains by band, and of the A-weighted level of the train that was measured."""
        bands = at_site(ensemble.difference(section, INTERCITY, INTERCITY_SPEED))
        return bands, total_difference(self.train[0], bands)

    def regional(self, section, speed):
        """The same of motor coaches, with their own spectrum at the reference."""
        types = {"motor coach": 1.0}
        bands = at_site(self.after_strail.difference(section, types, speed))
        return bands, total_difference(self.after_strail.level(REFERENCE, types, speed), bands)


def predictions(found):
    """What is not in the folder, in two tables."""
    intercity = [found.difference(found.after_strail, section) for section in ("B2", "B3")]
    regional = [found.regional(section, REGIONAL_SPEED) for section in ("B2", "B3", "B4")]
    columns = [*intercity, *regional]
    rows = [[name, *(with_interval(bands[:, k]) for bands, _ in columns)] for k, name in enumerate(NAMES)]
    rows.append(["**dB(A)**", *(f"**{with_interval(total)}**" for _, total in columns)])
    head = [
        "band",
        *(f"{SECTIONS[n]}, intercity" for n in ("B2", "B3")),
        *(f"{SECTIONS[n]}, regional" for n in ("B2", "B3", "B4")),
    ]
    speeds = [
        [f"{speed:.0f}", *(with_interval(found.regional(n, speed)[1]) for n in ("B2", "B3", "B4"))]
        for speed in (100.0, 120.0, 139.0)
    ]
    over_speed = table(["km/h", *(f"{SECTIONS[n]} / dB(A)" for n in ("B2", "B3", "B4"))], speeds)
    return table(head, rows), over_speed


def strail(found):
    """Strail less reference, measured and predicted, blind and after the spectrum at the reference."""
    measured, spread = (f(found.measured_difference, axis=0) for f in (np.mean, np.std))
    columns = [found.difference(each, "B4") for each in (found.blind, found.after_reference)]
    by_run = found.runs["B4"][-1] - found.runs[REFERENCE][-1]
    rows = [
        [
            name,
            f"{signed(measured[k])} ± {spread[k]:.1f}",
            signed(by_run[k]),
            *(with_interval(bands[:, k]) for bands, _ in columns),
        ]
        for k, name in enumerate(NAMES)
    ]
    of_run = total_difference(found.runs[REFERENCE][-1], by_run)
    rows.append(
        ["**dB(A)**", f"**{signed(measured[-1])} ± {spread[-1]:.1f}**", f"**{signed(of_run)}**"]
        + [f"**{with_interval(total)}**" for _, total in columns]
    )
    return table(
        ["band", "measured, ± of one train", "two runs of a coach", "blind", "after the reference"], rows
    )


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


def page(found):
    """Text of the page."""
    predicted, regional = predictions(found)
    (blind, after), none = strail_in_numbers(found)
    return (
        Path(__file__)
        .with_suffix(".md")
        .read_text(encoding="utf-8")
        .format(
            predicted=predicted,
            regional=regional,
            strail=strail(found),
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
        )
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("data", type=Path, help="folder of decay_rates.csv and the others")
    parser.add_argument("-o", "--output", type=Path, required=True, help="folder of the page and its figures")
    given = parser.parse_args()
    found = Found(Railway(given.data))
    (given.output / "measured_railway.md").write_text(page(found), encoding="utf-8")


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    main()
