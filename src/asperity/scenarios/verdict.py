"""The sentence at the top of a report: what the run says."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import xarray

from asperity.errors import Grade
from asperity.laws import baselines, names, spec_of
from asperity.scenarios.chain import Chain, Run
from asperity.scenarios.law_choice import LawChoice
from asperity.scenarios.tree import difference_to
from asperity.scenarios.validity import Finding
from asperity.schema.spectra import (
    BAND,
    BAND_TIME_PRODUCT,
    FORCE_LEVEL_DIFFERENCE_TO_REFERENCE,
    START_SHARE,
)
from asperity.spectra import nominal_frequency, say_little

COMPARED = (100.0, 5000.0)
"""Band centres between which laws are compared, Hz."""


def verdict(
    chain: Chain[Any],
    spectra: xarray.Dataset,
    found: Sequence[Finding],
    body: str,
    sound_power: xarray.DataArray | None = None,
    choice: LawChoice | None = None,
) -> str:
    """Say in a sentence or two how the main law's contact went, and how far it is from the others.

    The main law is the first of the chain; `body` is what rolls: "ball" or "wheel"; sound power (laws,),
    A-weighted, dB; choice of a law, from the law accuracy map.
    """
    main, run = next(iter(chain.runs.items()))
    dynamic = float(np.std(run.contact_force))
    sentences = list(_doubts(chain, found))
    sentences += [f"{_contact(run, body)} ({main}); the contact force varies by {_force(dynamic)} rms"]
    secant = " (linear with the stiffness F/r)" if chain.case.contact.linearise == "secant" else ""
    others = [law for law in baselines(chain.runs) if difference_to(law).name in spectra and law != main]
    shown = compared_bands(spectra)
    if not shown.any():
        sentences.append("The record is too short to compare its one-third octaves with those of other laws")
    elif compared := list(_compared(spectra.isel(band=shown), main, others)):
        sentences.append(f"Per one-third octave {main} is {' and '.join(compared)}{secant}")
    if choice is not None and (told := choice.sentence(main)) is not None:
        sentences.append(told)
    if sound_power is not None and others:
        own = sound_power.sel(law=main)
        changes = [f"{_signed(own - sound_power.sel(law=name))} over {name}" for name in others]
        sentences.append(f"Its A-weighted sound power is {' and '.join(changes)}{secant}")
    return ". ".join(sentences) + "."


def _doubts(chain: Chain[Any], found: Sequence[Finding]) -> Iterator[str]:
    """Say first where the main law is outside its range, and what the scanned contact gives instead."""
    main = next(iter(chain.runs))
    doubts = [finding for finding in found if finding.concerns(main)]
    if not doubts:
        return
    out = any(finding.grade is Grade.OUT for finding in doubts)
    reasons = ", ".join(finding.brief for finding in doubts)
    seeing = [law for law in names() if law in chain.runs and spec_of(law).sees_heights]
    better = [law for law in seeing if any(law not in finding.laws for finding in doubts)]
    instead = [
        f"{law} varies by {_force(float(np.std(chain.runs[law].contact_force)))} rms" for law in better
    ]
    yield f"{'Out of range' if out else 'Doubtful'} for {main}: {'; '.join([reasons, *instead[:1]])}"


def compared_bands(spectra: xarray.Dataset) -> np.ndarray:
    """Bands in which laws are compared: those whose levels say something."""
    low, high = COMPARED
    band = spectra[BAND.name]
    product, start = spectra[BAND_TIME_PRODUCT.name], spectra.get(START_SHARE.name, 0.0)
    inside = (band >= low * 0.9) & (band <= high * 1.1)
    return np.asarray(inside & ~say_little(product, start))


def _compared(bands: xarray.Dataset, main: str, others: list[str]) -> Iterator[str]:
    """Distance to the linear laws, the one of practice first, and to the reference."""
    for name in others:
        yield f"{_range(bands[difference_to(name).name].sel(law=main))} over {name}"
    to_reference = bands.get(FORCE_LEVEL_DIFFERENCE_TO_REFERENCE.name)
    if to_reference is not None and to_reference.attrs["reference"] != main:
        distance = float(abs(to_reference.sel(law=main)).max())
        yield f"at most {distance:.1f} dB from {to_reference.attrs['reference']}"


def _signed(difference: float | xarray.DataArray) -> str:
    rounded = round(float(difference), 1)
    return f"{rounded:+.1f} dB".replace("-", "−") if rounded else "0.0 dB"


def _force(newtons: float) -> str:
    return f"{newtons:.3g} N" if newtons < 1e3 else f"{newtons / 1e3:.3g} kN"


def _contact(run: Run, body: str) -> str:
    if not run.contact_loss:
        return f"The {body} never loses contact"
    share, count = 100.0 * run.contact_loss_share, len(run.contact_loss)
    return f"The {body} loses contact {count} time{'s' if count > 1 else ''}, {share:.2g} % of the time"


def _range(difference: xarray.DataArray) -> str:
    ends = (int(difference.values.argmin()), int(difference.values.argmax()))
    return " to ".join(
        f"{_signed(difference[i])} ({nominal_frequency(float(difference.band[i]))})" for i in ends
    )
