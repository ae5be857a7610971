"""What a report says first: the answers of its chapters."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.reporting.data import engineering, laws, of_law, present
from asperity.reporting.law_entries import law_entry
from asperity.reporting.tables import ReportTable, in_percent
from asperity.schema import rolling
from asperity.spectra import nominal_frequency

LOW, HIGH = 90.0, 5500.0
"""Frequencies between which the band centres lie that laws are compared in, Hz: 100 Hz to 5 kHz."""
MOST = 0.5
"""Share of the energy that deciding bands hold."""


@dataclass(frozen=True)
class HeadlineNumber:
    """A number at the top of the page: what it is, the number with its unit, and what to read beside it."""

    name: str
    value: str
    note: str


@dataclass(frozen=True)
class Answers:
    """What a chapter says at the top of the page."""

    lead: str = ""  # a sentence: what decides
    more: str = ""  # sentences beside it
    numbers: tuple[HeadlineNumber, ...] = ()
    tables: tuple[ReportTable, ...] = ()


def force_answers(tree: DataTree) -> Answers | None:
    """Force of the main law, and its losses of contact."""
    if not present(tree, rolling.CONTACT_FORCE):
        return None
    main = laws(tree, rolling.CONTACT_FORCE)[0]
    force = of_law(tree, rolling.CONTACT_FORCE, main, "time")
    lost = _loss(tree, main)
    return Answers(numbers=(_dynamic(force), *([lost] if lost else [])))


def _dynamic(force: NDArray[np.float64]) -> HeadlineNumber:
    mean, rms = float(np.nanmean(force)), float(np.nanstd(force))
    share = f"{in_percent(rms / mean)} of its mean of {engineering(mean, 'N')}; " if mean > 0 else ""
    top = engineering(float(np.nanmax(force)), "N")
    return HeadlineNumber("contact force varies by, rms", engineering(rms, "N"), f"{share}at most {top}")


def _loss(tree: DataTree, main: str) -> HeadlineNumber | None:
    if main not in laws(tree, rolling.CONTACT_LOSS_SHARE):
        return None
    if law_entry(tree, main).may_pull:
        return HeadlineNumber("time without contact", "–", f"{main} cannot lose it: its force may pull")
    share = float(of_law(tree, rolling.CONTACT_LOSS_SHARE, main))
    if not share:
        return HeadlineNumber("time without contact", "0 %", "contact is never lost")
    told = []
    if present(tree, rolling.CONTACT_LOSS_EVENTS):
        count = int(of_law(tree, rolling.CONTACT_LOSS_EVENTS, main))
        told.append(f"lost {'once' if count == 1 else f'{count} times'}")
    if present(tree, rolling.LONGEST_LOSS):
        told.append(f"longest {engineering(float(of_law(tree, rolling.LONGEST_LOSS, main)), 's')}")
    return HeadlineNumber("time without contact", in_percent(share), ", ".join(told))


def deciding_bands(bands: NDArray[np.float64], level: NDArray[np.float64]) -> str:
    """The fewest one-third octaves (b,), Hz, that hold half the energy of levels (b,), dB, in words."""
    energy = np.nan_to_num(10.0 ** (level / 10.0))
    loudest = np.argsort(-energy, kind="stable")
    held = np.cumsum(energy[loudest])
    kept = np.sort(loudest[: 1 + int(np.searchsorted(held, MOST * held[-1]))])
    runs = np.split(kept, np.flatnonzero(np.diff(kept) > 1) + 1)
    ends = [
        list(dict.fromkeys(nominal_frequency(float(bands[i])) for i in (run[0], run[-1]))) for run in runs
    ]
    return _listed([" to ".join(each) for each in ends])


def _listed(words: list[str]) -> str:
    """Words as a sentence lists them."""
    return " and ".join(filter(None, [", ".join(words[:-1]), words[-1]]))
