"""What resonances have not built up yet when a record starts, of the linear force at the places it passes."""

import math
from collections.abc import Iterator

import numpy as np

from asperity import spectra as bands
from asperity.arguments import Array, ArrayLike
from asperity.errors import Finding, Grade
from asperity.scenarios.laws import working_point
from asperity.scenarios.scene import PreparedCase, Scene, force_transfer
from asperity.scenarios.textures import lowest_recorded, recorded_time
from asperity.written_numbers import rounded

PLACES = 8
"""Places along the record at which the linear contact is looked at."""


def chance_along(
    scene: Scene, stiffness: float, ends: ArrayLike, band: Array, settled: float, record: float
) -> tuple[Array, Array]:
    """Independent values that bands hold (b,), and the share of their mean square that is not built up (b,).

    Of the force of the first contact per height, linear with a stiffness, N/m, at places between the ends of
    a record, m: as `asperity.spectra.chance_and_start`.
    """
    begin, end = np.asarray(ends)
    places = begin + (end - begin) * (np.arange(PLACES) + 0.5) / PLACES
    return bands.chance_and_start(
        lambda frequency: force_transfer(frequency, scene.first, scene, stiffness, places),
        band,
        settled,
        record,
    )


def low_levels(band: Array, share: Array) -> tuple[str, str] | None:
    """Bands (b,), Hz, whose levels are low by more than `MOST_START`, and by how much, in words; or None."""
    much = share > bands.MOST_START
    if not much.any():
        return None
    where = ", ".join(bands.nominal_frequency(float(centre)) for centre in band[much])
    return where, f"up to {-10.0 * math.log10(1.0 - share.max()):.1f} dB low"


def start_foreseen(prepared: PreparedCase) -> Iterator[Finding]:
    """What a run will say of the start of its record, by the stiffness of the smooth contact."""
    if not np.ptp(prepared.textures.line):
        return
    case = prepared.case
    record = recorded_time(case, prepared.textures)
    stiffness = working_point(case.contact, prepared.shape, None)[1]
    ends = (case.record_start, case.record_start + case.rolled_in(record))
    band = bands.third_octave_bands(lowest_recorded(case, record), case.numerics.highest_frequency)[0]
    of = (prepared.scene, stiffness, ends, band)
    settled = case.settled_time
    told = low_levels(band, chance_along(*of, settled, record)[1])
    if told is None:
        return
    where, low = told
    longer = max(settled, 0.01)
    while low_levels(band, chance_along(*of, longer, record)[1]) is not None:
        longer = float(f"{1.25 * longer:.2g}")
    yield Finding(
        "levels of bands that the start of the record makes low",
        f"{where}, {low}",
        f"up to {rounded(-10.0 * math.log10(1.0 - bands.MOST_START), 1)} dB",
        Grade.WARNING,
        "Resonances there have not built up when the record starts.",
        f"Take a settling of {longer:g} s, with room for it before the record, or more damping.",
    )
