"""What a result is held against: what was measured on a track and beside it, and the limits of TSI Noise."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray

from asperity.arguments import Array, ArrayLike, Complex, NDArray, as_row
from asperity.case.measured import read_band_levels, read_decay_rates, read_mobility
from asperity.case.rolled_over import TrackKeys
from asperity.case.sections import NoiseKeys
from asperity.errors import Finding, Grade, MeasuredTrackWarning
from asperity.radiation.pass_by import Receiver
from asperity.reference import cnossos, railways
from asperity.scenes import compute, schema
from asperity.schema import Values, spectra
from asperity.spectra import HALF_BAND, in_bands, nominal_frequency, third_octave_numbers
from asperity.structures.lateral_rail import LateralTrack
from asperity.structures.track import Track, decay_rate_en15461, decay_rate_of_responses
from asperity.surfaces.bands import likely_band
from asperity.written_numbers import count_of, rounded

LINES = 64
"""Frequencies in a band: they resolve the resonance of a rail whose loss factor is 1 %."""


@dataclass(frozen=True, eq=False)
class HammerTest:
    """Decay rates by EN 15461 and point mobility at mid-span of a track, in one-third octaves.

    Parameters
    ----------
    frequency : ndarray (b, n)
        Lines in each band, Hz.
    decay_rate : ndarray (b,)
        Vertical, dB/m; NaN in bands without one.
    mobility : ndarray (b, n)
        (m/s)/N, e^{+iωt}; NaN in bands without one.

    Notes
    -----
    EN 15461 makes a decay rate of the sum over one side of the rail, Δ = 4.343/Σ(|A_n|²/|A_0|² Δx_n), where
    4.343 = 10/ln 10. On both sides, then, ∫|v|² dx = |v_0|² · 2 · 4.343/Δ. At the force the rail moves by
    v_0 = Y h/(α_W + α_C + α_R) of a texture h, α_R = Y/iω: on a softer rail the force is smaller.
    """

    frequency: Array
    decay_rate: Array
    mobility: Complex

    @classmethod
    def of_track(cls, track: Track, band: ArrayLike, count: int = LINES) -> "HammerTest":
        """What the test would find on a computed track, in bands by their centres (b,), Hz.

        Responses are summed over the band, at a count of lines, before they are compared: 1/Δ is a mean that
        is weighted with the squared mobility.
        """
        frequency = _lines_in(band, count)
        half = float(track.mid_spans[0])
        lines = frequency.ravel()
        struck = np.mean([each.receptance(lines, half, half) for each in track.under_one_rail], axis=0)
        mobility = 2j * np.pi * frequency * struck.reshape(frequency.shape)
        rate = _rate_in_bands(decay_rate_en15461(track, lines), mobility)
        return cls(frequency, rate, mobility)

    def measured(
        self, decay_rates: tuple[Array, Array] | None, mobility: tuple[Array, NDArray[np.inexact]] | None
    ) -> "HammerTest":
        """What was measured, in the bands of this test of the computed track.

        Decay rates in one-third octaves by their centres, dB/m; mobility over frequencies that rise, Hz,
        (m/s)/N: its phase is that of the computed track if magnitudes are given alone.
        """
        found = np.full(self.frequency.shape, np.nan + 0j)
        rate = np.full(len(found), np.nan)
        if decay_rates is not None:
            rate = in_bands(self.centre, *decay_rates)
        if mobility is not None:
            at, given = mobility
            held = (self.frequency[:, -1] > at[0]) & (self.frequency[:, 0] < at[-1])
            found[held] = _interpolated(self.frequency[held], at, given)
            if not np.iscomplexobj(given):
                found *= np.exp(1j * np.angle(self.mobility))
        return replace(self, decay_rate=rate, mobility=found)

    @property
    def centre(self) -> Array:
        """Of the bands (b,), Hz."""
        return np.sqrt(self.frequency[:, 0] * self.frequency[:, -1])

    @property
    def rms_mobility(self) -> Array:
        """Root mean square over each band (b,), (m/s)/N."""
        return np.sqrt(np.mean(np.abs(self.mobility) ** 2, axis=1))

    def driven(self, other: Complex) -> Array:
        """Mean square velocity at the contact per height of the texture (b,), (m/s)²/m².

        Receptance of wheel and contact spring together, m/N, at the lines (b, n).
        """
        receptance = self.mobility / (2j * np.pi * self.frequency)
        with np.errstate(invalid="ignore"):  # where none was measured
            return np.mean(np.abs(self.mobility / (other + receptance)) ** 2, axis=1)

    def longer(self, computed: "HammerTest") -> Array:
        """Length of the rail that radiates over that computed (b,); one where no decay rate was measured."""
        return np.nan_to_num(computed.decay_rate / self.decay_rate, nan=1.0)

    def louder(self, computed: "HammerTest", other: Complex) -> Array:
        """Mean square velocity at the contact over that computed (b,); one where no mobility was measured.

        With the linear contact's force: the other receptance as in `driven`.
        """
        return np.nan_to_num(self.driven(other) / computed.driven(other), nan=1.0)


def _lines_in(band: ArrayLike, count: int) -> Array:
    """Frequencies of each band (b, count), even over lg f, Hz."""
    centre = as_row(band)
    steps = (np.arange(count) + 0.5) / count
    return centre[:, None] * HALF_BAND ** (2.0 * steps - 1.0)


def _rate_in_bands(rate: Array, mobility: Complex) -> Array:
    """Decay rates (b,), dB/m, of responses that are summed over each band, at its lines (b n,) and (b, n)."""
    lengths = 1.0 / rate.reshape(mobility.shape)
    return 1.0 / np.average(lengths, axis=1, weights=np.abs(mobility) ** 2)


def lateral_hammer_test(track: LateralTrack, band: ArrayLike, count: int = LINES) -> Array:
    """Decay rates sideways (b,), dB/m, that a hammer on the side of the head would find, as `HammerTest`.

    In bands by their centres (b,), Hz, each summed at a count of lines.
    """
    frequency = _lines_in(band, count)
    distances, motion = track.hammered(frequency.ravel())
    rate = decay_rate_of_responses(distances, np.abs(motion))
    return _rate_in_bands(rate, frequency * motion[0].reshape(frequency.shape))


def lateral_rates(keys: TrackKeys, track: LateralTrack, band: Array) -> tuple[Values, Array | float]:
    """Lay out decay rates sideways, measured and computed, in bands by their centres (b,), Hz.

    With the length of rail that radiates sideways over that computed (b,); one in bands where none was
    measured, and everywhere where none was.
    """
    rates = None if keys.decay_rates is None else read_decay_rates(keys.decay_rates)
    if rates is None or rates[2] is None:
        return {}, 1.0
    computed = lateral_hammer_test(track, band)
    longer = computed / in_bands(band, rates[0], rates[2])
    laid_out: Values = {
        schema.EXPECTED_LATERAL_DECAY_RATE: np.where(np.isfinite(longer), computed, np.nan),
        schema.MEASURED_LATERAL_POWER_CHANGE: 10.0 * np.log10(longer),
    }
    return laid_out, np.nan_to_num(longer, nan=1.0)


def _interpolated(frequency: Array, at: Array, given: NDArray[np.inexact]) -> NDArray[np.inexact]:
    """Numbers between those of a table, and beyond them as at its ends; magnitudes by their logarithms."""
    if np.iscomplexobj(given):
        return np.asarray(np.interp(frequency, at, given))
    return np.exp(np.interp(np.log(frequency), np.log(at), np.log(given)))


# --- beside what was computed

FACTOR = 3.0
"""By which a decay rate or a mobility may be off that of the computed track before it is warned of."""


def hammer_tests(keys: TrackKeys, track: Track, band: Array) -> tuple[HammerTest, HammerTest, Values] | None:
    """What was measured on a track, what would be on the computed one, and both laid out over bands.

    In bands by their centres, Hz. None where the keys say nothing of the kind.
    """
    if keys.decay_rates is None and keys.mobility is None:
        return None
    computed = HammerTest.of_track(track, band)
    rates = None
    lateral = None
    laid_out = Values()
    if keys.decay_rates is not None:
        centres, vertical, lateral = read_decay_rates(keys.decay_rates)
        rates = centres, vertical
    mobility = None if keys.mobility is None else read_mobility(keys.mobility)
    found = computed.measured(rates, mobility)
    if rates is not None:
        laid_out[schema.MEASURED_DECAY_RATE] = found.decay_rate
        laid_out[schema.EXPECTED_DECAY_RATE] = computed.decay_rate
        if lateral is not None:
            laid_out[schema.MEASURED_LATERAL_DECAY_RATE] = in_bands(band, centres, lateral)
    if mobility is not None:
        laid_out[schema.MEASURED_MOBILITY] = found.rms_mobility
        laid_out[schema.EXPECTED_MOBILITY] = computed.rms_mobility
    return found, computed, laid_out


def measured_track(run: compute.Computed) -> tuple[Values, Array, Array] | None:
    """What was measured on the track of a case: laid out, and what it does in bands (b,).

    Factors of the sound power of rail and sleepers, and of the length of rail that radiates, over those of
    the computed track. None where the case says nothing of the kind.
    """
    if (tests := hammer_tests(run.case.track, run.track.nominal, run.band)) is None:
        return None
    found, computed, laid_out = tests
    lines = computed.frequency
    other = run.scene.first(lines.ravel()).reshape(lines.shape) + 1.0 / run.stiffness
    longer = found.longer(computed)
    louder = found.louder(computed, other)
    known = np.isfinite(found.decay_rate) | np.isfinite(found.rms_mobility)
    laid_out[schema.MEASURED_POWER_CHANGE] = np.where(known, 10.0 * np.log10(longer * louder), np.nan)
    if schema.MEASURED_MOBILITY in laid_out:
        force = 10.0 * np.log10(louder * (computed.rms_mobility / found.rms_mobility) ** 2)
        laid_out[schema.MEASURED_FORCE_CHANGE] = force
    return laid_out, longer * louder, longer


def findings_of_measured(keys: TrackKeys, track: Track, band: Array) -> list[Finding]:
    """Hold what was measured to the computed track, in bands by their centres (b,), Hz."""
    *_, laid_out = hammer_tests(keys, track, band) or (Values(),)
    compared = (
        ("decay_rates", "decay rate", schema.MEASURED_DECAY_RATE, schema.EXPECTED_DECAY_RATE),
        ("mobility", "point mobility", schema.MEASURED_MOBILITY, schema.EXPECTED_MOBILITY),
    )
    found = []
    for key, quantity, own, expected in compared:
        ratio = laid_out[own] / laid_out[expected] if own in laid_out else np.full(1, np.nan)
        if np.isnan(ratio).all():
            continue
        apart = np.exp(np.abs(np.log(ratio)))
        worst = int(np.nanargmax(apart))
        off = ", ".join(map(nominal_frequency, band[apart > FACTOR]))
        found.append(
            Finding(
                f"measured {quantity} over that of the computed track, farthest from 1",
                f"{rounded(ratio[worst], 2)} ({nominal_frequency(band[worst])})",
                f"{rounded(1.0 / FACTOR, 2)} to {FACTOR:g}",
                Grade.WARNING if off else None,
                f"The contact force is that of another track than the one measured: see {off}.",
                f"Fit pads, ballast and losses of [track] to it (asperity fit CASE), or check track.{key}.",
                category=MeasuredTrackWarning,
            )
        )
    return found


# --- a passage beside the track


def measured_passage(keys: NoiseKeys, band: Array) -> Values:
    """Lay out what was measured as a train passed; bands by their centres, Hz."""
    laid_out: Values = {}
    if keys.measured_bands is not None:
        laid_out[schema.MEASURED_BAND_LEVEL] = in_bands(band, *read_band_levels(keys.measured_bands))
    told = schema.MEASURED_MAXIMUM_LEVEL, schema.MEASURED_EQUIVALENT_LEVEL, schema.MEASURED_EXPOSURE_LEVEL
    values = {entry: getattr(keys, entry.name) for entry in told}  # the keys are called alike
    return laid_out | {entry: value for entry, value in values.items() if value is not None}


# --- limits of TSI Noise

Condition = dict[str, Any]


def held_to_limits(case: Any, over_frequency: xarray.Dataset, at: Callable[[Receiver], Array]) -> Values:
    """Lay out L_pAeq,Tp (law, radiator), dB(A), normalised as TSI Noise asks, its limit and conditions.

    Of a function that finds it at a receiver: at that of the case and, from 250 km/h on, the additional one.

    Nothing of a case that does not say what type of vehicle passes.
    """
    vehicle = case.noise.vehicle
    passage = case.passage
    receiver = case.noise.receiver
    if vehicle is None:
        return {}
    limit = railways.pass_by_limit(vehicle, passage.speed, len(passage.axles) / passage.length)
    here = (receiver.distance, receiver.height)
    asked = railways.RECEIVER
    offset = case.noise.receiver_offset
    there = bool(np.allclose(here, asked, rtol=0.0, atol=1e-9)) and not offset
    told, wanted = ("{:g} m from the track, {:g} m high".format(*each) for each in (here, asked))
    told += f", which adds {offset:+g} dB" if offset else ""
    greatest = railways.GREATEST_SPEED
    of_speed = f"80 km/h and the greatest, up to {3.6 * greatest:g} km/h (TSI Noise)"
    slow_enough = passage.speed <= greatest * (1 + 1e-9)
    laid_out: Values = {
        schema.VEHICLE: vehicle,
        schema.NORMALISED_LEVEL: at(receiver) + limit.normalisation,
        schema.REFERENCE_SPEED: limit.speed,
        schema.REFERENCE_CONDITIONS: [
            _condition("receiver", told, f"{wanted} (TSI Noise)", there),
            _condition("speed", f"{3.6 * passage.speed:.4g} km/h", of_speed, slow_enough),
            *_of_sources(over_frequency),
            *_of_roughness(over_frequency),
            _of_decay(over_frequency),
        ],
    }
    if limit.level is not None and there:
        laid_out[schema.TSI_LIMIT] = limit.level
        if limit.above:
            laid_out[schema.NORMALISED_LEVEL_ABOVE] = at(Receiver(*railways.ABOVE)) + limit.normalisation
    return laid_out


def _condition(name: str, here: str, asked: str, met: bool) -> Condition:
    return {"condition": name, "here": here, "asked": asked, "met": met}


def _of_sources(over_frequency: xarray.Dataset) -> list[Condition]:
    """That nothing which rolls is left out of the level; nothing where all is in it."""
    reason = over_frequency[schema.RADIATED_POWER_LEVEL.name].attrs.get("wheel", "computed")
    if reason == "computed":
        return []
    return [_condition("sources", f"rail and sleepers alone: {reason}", "rail, sleepers and wheel", False)]


def _of_roughness(over_frequency: xarray.Dataset) -> list[Condition]:
    """Rail roughness against its limit, where it is known: as a spectrum states it, else as it was rolled.

    One texture of a spectrum is above it in some bands, and below it in others.
    """
    if schema.ROUGHNESS_LEVEL.name not in over_frequency:
        return []
    levels = over_frequency[schema.ROUGHNESS_LEVEL.name]
    at = {"part": "rail" if "rail" in levels["part"] else "combined"}
    of_rail = levels.sel(at).values
    how = ""
    if schema.STATED_ROUGHNESS_LEVEL.name in over_frequency:
        stated = over_frequency[schema.STATED_ROUGHNESS_LEVEL.name].sel(at).values
        of_rail = np.where(np.isfinite(stated), stated, of_rail)
        how = ", by the spectrum that the case states" if np.isfinite(stated).any() else ""
    wavelength, limit = cnossos.rail_roughness("iso3095")
    wavelength, limit = wavelength[likely_band(wavelength)], limit[likely_band(wavelength)]
    own = levels["surface_band"].values
    known = np.isin(third_octave_numbers(wavelength), third_octave_numbers(own))
    over = np.nan_to_num(in_bands(wavelength, own, of_rail) - limit, nan=-np.inf)[known]
    names = [f"{rounded(1e3 * w)} mm" for w in wavelength[known]]
    asked = f"in {known.sum()} of {len(limit)} bands"
    condition = _banded("rail roughness", over, names, ("above", "dB"), f"at most the limit {asked}")
    return [condition | {"here": f"{condition['here']}{how}"}]


def _of_decay(over_frequency: xarray.Dataset) -> Condition:
    """Vertical decay rate of the rail against its lower limit; in bands in which it was measured, that."""
    band = over_frequency[spectra.BAND.name].values
    rate = over_frequency[schema.BAND_DECAY_RATE.name].values
    if schema.MEASURED_DECAY_RATE.name in over_frequency:
        measured = over_frequency[schema.MEASURED_DECAY_RATE.name].values
        rate = np.where(np.isfinite(measured), measured, rate)
    limit = railways.iso_3095_decay_rate(band)
    known = np.isfinite(limit) & np.isfinite(rate)
    names = [nominal_frequency(float(f)) for f in band[known]]
    asked = f"at least the limit in {count_of(known.sum(), 'band')}"
    return _banded("decay rate", (limit - rate)[known], names, ("below", "dB/m"), asked)


def _banded(name: str, beyond: Array, bands: list[str], words: tuple[str, str], asked: str) -> Condition:
    """Condition in bands: by how much each is beyond its limit, to which side, and in what unit."""
    outside = int(np.sum(np.round(beyond, 1) > 0.0))
    asked = f"{asked} (EN ISO 3095:2013)"
    if not outside:
        return _condition(name, f"so in all {len(bands)} bands", asked, bool(bands))
    side, unit = words
    worst = int(np.argmax(beyond))
    here = f"{side} it in {count_of(outside, 'band')}, by up to {beyond[worst]:.1f} {unit} at {bands[worst]}"
    return _condition(name, here, asked, False)
