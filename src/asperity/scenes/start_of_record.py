"""What resonances have not built up yet when a record starts, of the linear force at the places it passes."""

import math
from collections.abc import Iterator

import numpy as np

from asperity import spectra as bands
from asperity.arguments import Array, ArrayLike, Complex
from asperity.errors import Finding, Grade
from asperity.scenarios.laws import working_point
from asperity.scenarios.scene import PreparedCase, Scene, force_transfer
from asperity.scenarios.textures import lowest_recorded, recorded_time
from asperity.written_numbers import rounded

PLACES = 8
"""Places along the record at which the linear contact is looked at."""


def ringing_along(scene: Scene, stiffness: float, ends: ArrayLike, band: Array) -> list[bands.RingingBand]:
    """How bands (b,), Hz, ring of the force of the first contact per height, at places along a record.

    The force is linear with a stiffness, N/m; the places lie between the ends of the record, m.
    """
    begin, end = np.asarray(ends)
    places = begin + (end - begin) * (np.arange(PLACES) + 0.5) / PLACES

    def transfer(frequency: Array) -> Complex:
        return force_transfer(frequency, scene.first, scene, stiffness, places)

    return [bands.ringing_band(transfer, float(centre)) for centre in band]


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
    ringing = ringing_along(prepared.scene, stiffness, ends, band)

    def low_after(settled: float) -> tuple[str, str] | None:
        return low_levels(band, np.array([each.not_built_up(settled, record) for each in ringing]))

    told = low_after(case.settled_time)
    if told is None:
        return
    where, low = told
    longer = max(case.settled_time, 0.01)
    while low_after(longer) is not None:
        longer = float(f"{1.25 * longer:.2g}")
    yield Finding(
        "levels of bands that the start of the record makes low",
        f"{where}, {low}",
        f"up to {rounded(-10.0 * math.log10(1.0 - bands.MOST_START), 1)} dB",
        Grade.WARNING,
        "Resonances there have not built up when the record starts.",
        f"Take a settling of {longer:g} s, with room for it before the record, or more damping.",
    )
