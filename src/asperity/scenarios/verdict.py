"""The sentence at the top of a report: what the run says."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray

from asperity.scenarios.chain import Run

COMPARED = (100.0, 5000.0)
"""Band centres between which laws are compared, Hz."""


def verdict(runs: Mapping[str, Run], spectra: xarray.Dataset, body: str) -> str:
    """Say in a few words how the main law's contact went, and how far it is from the others.

    Parameters
    ----------
    runs : mapping of str to Run
        Runs by law; the first is the main one.
    spectra : Dataset
        The spectra group of the result.
    body : str
        What rolls: "ball" or "wheel".

    Returns
    -------
    str
        One or two sentences.
    """
    main, run = next(iter(runs.items()))
    dynamic = float(np.std(run.contact_force))
    parts = [f"{_contact(run, body)} ({main}); the contact force varies by {_force(dynamic)} rms"]
    bands = (spectra["band"] >= COMPARED[0] * 0.9) & (spectra["band"] <= COMPARED[1] * 1.1)
    if "force_level_difference" in spectra and main != "linear" and bool(bands.any()):
        difference = spectra["force_level_difference"].sel(law=main).where(bands, drop=True)
        parts.append(f"against the linear contact it is {_range(difference)} per one-third octave")
    if "force_level_difference_to_reference" in spectra and bool(bands.any()):
        difference = spectra["force_level_difference_to_reference"]
        reference = difference.attrs["reference"]
        if reference != main:
            distance = float(abs(difference.sel(law=main).where(bands, drop=True)).max())
            parts.append(f"and at most {distance:.1f} dB from {reference}")
    if "sound_power_level_a" in spectra and "linear" in spectra["law"].values and main != "linear":
        level = spectra["sound_power_level_a"].sel(source="total")
        louder = float(level.sel(law=main) - level.sel(law="linear"))
        change = f"{louder:+.1f} dB".replace("-", "−")
        parts.append(f"which changes the A-weighted sound power by {change}")
    return ", ".join(parts) + "."


def _force(newtons: float) -> str:
    return f"{newtons:.3g} N" if newtons < 1e3 else f"{newtons / 1e3:.3g} kN"


def _contact(run: Run, body: str) -> str:
    if not run.contact_loss:
        return f"The {body} never loses contact"
    share, count = 100.0 * run.contact_loss_share, len(run.contact_loss)
    return f"The {body} loses contact {count} time{'s' if count > 1 else ''}, {share:.2g} % of the time"


def _range(difference: xarray.DataArray) -> str:
    low, high = float(difference.min()), float(difference.max())
    low_at, high_at = (
        float(difference.band[int(i)]) for i in (difference.values.argmin(), difference.values.argmax())
    )
    return f"{low:+.1f} dB ({low_at:.0f} Hz) to {high:+.1f} dB ({high_at:.0f} Hz)".replace("-", "−")
