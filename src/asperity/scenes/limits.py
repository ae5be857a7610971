"""A pass-by beside the limits of TSI Noise, and the case beside the conditions of ISO 3095."""

from collections.abc import Callable
from typing import Any

import numpy as np
import xarray

from asperity.arguments import Array
from asperity.radiation.pass_by import Receiver
from asperity.reference import cnossos, tracks, tsi_noise
from asperity.scenes import schema
from asperity.schema import Values, spectra
from asperity.spectra import nominal_frequency
from asperity.surfaces.bands import likely_band

Condition = dict[str, Any]


def held_to_limits(case: Any, over_frequency: xarray.Dataset, at: Callable[[Receiver], Array]) -> Values:
    """Lay out L_pAeq,Tp (law, radiator), dB(A), normalised as TSI Noise asks, its limit and conditions.

    Of a function that finds it at a receiver: at that of the case and, from 250 km/h on, the additional one.

    Nothing of a case that does not say what type of vehicle passes.
    """
    vehicle, passage, receiver = case.noise.vehicle, case.passage, case.noise.receiver
    if vehicle is None:
        return {}
    limit = tsi_noise.pass_by_limit(vehicle, passage.speed, len(passage.axles) / passage.length)
    elsewhere = _of_receiver(receiver)
    laid_out: Values = {
        schema.VEHICLE: vehicle,
        schema.NORMALISED_LEVEL: at(receiver) + limit.normalisation,
        schema.REFERENCE_SPEED: limit.speed,
        schema.REFERENCE_CONDITIONS: [
            elsewhere,
            _of_speed(passage.speed),
            *_of_roughness(over_frequency),
            _of_decay(over_frequency),
        ],
    }
    if limit.level is not None and elsewhere["met"]:
        laid_out[schema.TSI_LIMIT] = limit.level
        if limit.above:
            laid_out[schema.NORMALISED_LEVEL_ABOVE] = at(Receiver(*tsi_noise.ABOVE)) + limit.normalisation
    return laid_out


def _condition(name: str, here: str, asked: str, met: bool) -> Condition:
    return {"condition": name, "here": here, "asked": asked, "met": met}


def _of_receiver(receiver: Receiver) -> Condition:
    asked, here = tsi_noise.RECEIVER, (receiver.distance, receiver.height)
    told, wanted = ("{:g} m from the track, {:g} m high".format(*each) for each in (here, asked))
    return _condition(
        "receiver", told, f"{wanted} (TSI Noise)", bool(np.allclose(here, asked, rtol=0.0, atol=1e-9))
    )


def _of_speed(speed: float) -> Condition:
    asked = f"80 km/h and the greatest, up to {3.6 * tsi_noise.GREATEST_SPEED:g} km/h (TSI Noise)"
    return _condition(
        "speed", f"{3.6 * speed:.4g} km/h", asked, speed <= tsi_noise.GREATEST_SPEED * (1 + 1e-9)
    )


def _of_roughness(over_frequency: xarray.Dataset) -> list[Condition]:
    """Rail roughness against its limit, where it is known."""
    if schema.ROUGHNESS_LEVEL.name not in over_frequency:
        return []
    levels = over_frequency[schema.ROUGHNESS_LEVEL.name]
    of_rail = levels.sel(part="rail" if "rail" in levels["part"] else "combined").values
    wavelength, limit = cnossos.rail_roughness("iso3095")
    wavelength, limit = wavelength[likely_band(wavelength)], limit[likely_band(wavelength)]
    apart = np.abs(np.log10(levels["surface_band"].values[:, None] / wavelength))
    known = apart.min(axis=0) < 0.03
    over = np.nan_to_num(of_rail[apart.argmin(axis=0)] - limit, nan=-np.inf)[known]
    names, asked = [f"{1e3 * w:.3g} mm" for w in wavelength[known]], f"in {known.sum()} of {len(limit)} bands"
    return [_banded("rail roughness", over, names, ("above", "dB"), f"at most the limit {asked}")]


def _of_decay(over_frequency: xarray.Dataset) -> Condition:
    """Vertical decay rate of the rail against its lower limit; in bands in which it was measured, that."""
    band, rate = over_frequency[spectra.BAND.name].values, over_frequency[schema.BAND_DECAY_RATE.name].values
    if schema.MEASURED_DECAY_RATE.name in over_frequency:
        measured = over_frequency[schema.MEASURED_DECAY_RATE.name].values
        rate = np.where(np.isfinite(measured), measured, rate)
    limit = tracks.iso_3095_decay_rate(band)
    known = np.isfinite(limit) & np.isfinite(rate)
    names = [nominal_frequency(float(f)) for f in band[known]]
    asked = f"at least the limit in {known.sum()} bands"
    return _banded("decay rate", (limit - rate)[known], names, ("below", "dB/m"), asked)


def _banded(name: str, beyond: Array, bands: list[str], words: tuple[str, str], asked: str) -> Condition:
    """Condition in bands: by how much each is beyond its limit, to which side, and in what unit."""
    outside, asked = int(np.sum(np.round(beyond, 1) > 0.0)), f"{asked} (EN ISO 3095:2013)"
    if not outside:
        return _condition(name, f"so in all {len(bands)} bands", asked, bool(bands))
    (side, unit), worst = words, int(np.argmax(beyond))
    here = f"{side} it in {outside} bands, by up to {beyond[worst]:.1f} {unit} at {bands[worst]}"
    return _condition(name, here, asked, False)
