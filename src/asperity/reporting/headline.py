"""The three numbers that a report begins with: of the force, of its losses, and over linear contact."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.reporting.data import doubtful, engineering, laws, of_law, present, values
from asperity.reporting.law_entries import differences, law_entry
from asperity.reporting.tables import in_percent, signed
from asperity.schema import rolling
from asperity.schema.spectra import BAND, BAND_TIME_PRODUCT, FORCE_LEVEL
from asperity.spectra import energy_sum, nominal_frequency

LOW, HIGH = 90.0, 5500.0
"""Frequencies between which the band centres lie that laws are compared in, Hz: 100 Hz to 5 kHz."""


@dataclass(frozen=True)
class HeadlineNumber:
    """A number at the top of the page: what it is, the number with its unit, and what to read beside it."""

    name: str
    value: str
    note: str


def headline(tree: DataTree, own: HeadlineNumber | None = None) -> list[HeadlineNumber]:
    """Numbers of the main law; `own`, of the kind of case, takes the place of the change of force level."""
    if not present(tree, rolling.CONTACT_FORCE):
        return []
    main = laws(tree, rolling.CONTACT_FORCE)[0]
    force = of_law(tree, rolling.CONTACT_FORCE, main, "time")
    found = [_dynamic(main, force), _loss(tree, main), own or _over_practice(tree, main)]
    return [number for number in found if number is not None]


def _dynamic(main: str, force: NDArray[np.float64]) -> HeadlineNumber:
    mean, rms = float(np.nanmean(force)), float(np.nanstd(force))
    share = f"{in_percent(rms / mean)} of its mean of {engineering(mean, 'N')}" if mean > 0 else ""
    top = engineering(float(np.nanmax(force)), "N")
    return HeadlineNumber(
        "contact force varies by, rms", engineering(rms, "N"), f"{share}; at most {top} ({main})"
    )


def _loss(tree: DataTree, main: str) -> HeadlineNumber | None:
    if main not in laws(tree, rolling.CONTACT_LOSS_SHARE):
        return None
    if law_entry(tree, main).may_pull:
        return HeadlineNumber("time without contact", "–", f"{main} cannot lose it: its force may pull")
    share = float(of_law(tree, rolling.CONTACT_LOSS_SHARE, main))
    if not share:
        return HeadlineNumber("time without contact", "0 %", f"contact is never lost ({main})")
    told = []
    if present(tree, rolling.CONTACT_LOSS_EVENTS):
        count = int(of_law(tree, rolling.CONTACT_LOSS_EVENTS, main))
        told.append(f"lost {'once' if count == 1 else f'{count} times'}")
    if present(tree, rolling.LONGEST_LOSS):
        told.append(f"longest {engineering(float(of_law(tree, rolling.LONGEST_LOSS, main)), 's')}")
    return HeadlineNumber("time without contact", in_percent(share), f"{', '.join(told)} ({main})".strip())


def told_bands(tree: DataTree) -> NDArray[np.bool_]:
    """Bands that laws are compared in: from 100 Hz to 5 kHz, averaged enough to say something."""
    band = values(tree, BAND)
    return (band > LOW) & (band < HIGH) & ~doubtful(tree, BAND_TIME_PRODUCT)


def _over_practice(tree: DataTree, main: str) -> HeadlineNumber | None:
    """Change of the level of all compared bands together over the linear law of practice, and its range."""
    others = {entry: law for entry, law in differences(tree).items() if law != main}
    if not others or not present(tree, BAND):
        return None
    entry, law = next(iter(others.items()))
    name = f"contact force level over {law}"
    change = of_law(tree, entry, main, "band")
    told = told_bands(tree) & np.isfinite(change)
    if not told.any():
        return HeadlineNumber(name, "–", "the record is too short to compare its one-third octaves")
    level = of_law(tree, FORCE_LEVEL, main, "band")[told]
    whole = float(energy_sum(level) - energy_sum(level - change[told]))
    bands = values(tree, BAND)[told]
    ends = [int(find(change[told])) for find in (np.argmin, np.argmax)]
    low, high = (f"{signed(change[told][i])} dB ({nominal_frequency(float(bands[i]))})" for i in ends)
    return HeadlineNumber(
        name, f"{signed(whole)} dB", f"of all bands together; single ones {low} to {high} ({main})"
    )
