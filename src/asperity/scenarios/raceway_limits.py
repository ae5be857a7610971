"""What no raceway is meant to have: waves that lift the balls, slopes, faults as long as balls are apart."""

import numpy as np

from asperity.arguments import require
from asperity.errors import OutOfRangeWarning
from asperity.scenarios.geometry import HIGHEST_FORCE
from asperity.scenarios.problems import ROUGHEST, STEEPEST
from asperity.spectra import root_mean_square
from asperity.surfaces.faults import Fault
from asperity.surfaces.raceway import Raceway
from asperity.written_numbers import rounded

HELD = HIGHEST_FORCE ** (2.0 / 3.0)
"""Approaches of a smooth contact up to which the states of laws reach."""
REMEDY = 'Is the unit right? Waviness is written as "0.5 um", roughness as "20 nm".'


def doubt_surface(surface: Raceway, approach: float, rolls: str) -> None:
    """Hold what is on a raceway or a ball all around to the approach of its smooth contact, m.

    Waves that lift a ball out of the states of its laws are warned of. What goes round with one wave moves
    the ring alone. What `rolls` is a ball or a roller.

    Raises
    ------
    InputError
        Above a hundred approaches, or an rms slope of one.
    """
    if not (surface.line.any() or surface.heights.any()):
        return
    turns = np.fft.rfft(surface.line)
    turns[:2] = 0.0
    heights = surface.heights if surface.heights.any() else surface.heights[:, :1]  # all lines are alike
    waves = heights + np.fft.irfft(turns, len(surface.line))[:, None]
    highest = 0.5 * float(np.ptp(waves))
    for height in (highest, 0.5 * float(np.ptp(surface.line))):
        received = (
            f"{rounded(height * 1e6, 4)} µm, {rounded(height / approach)} approaches of "
            f"{rounded(approach * 1e6)} µm"
        )
        require(height <= ROUGHEST * approach, "waves all around", received, f"at most {ROUGHEST:g}", REMEDY)
    if 2.0 * highest > STEEPEST * surface.spacing[0]:  # else no two rows are so unlike
        slope = np.diff(waves, axis=0, append=waves[:1]) / surface.spacing[0]
        steep = root_mean_square(slope)
        require(steep <= STEEPEST, "rms slope", rounded(steep), f"at most {STEEPEST:g}", REMEDY)
    held = HELD * approach
    if highest > held:
        OutOfRangeWarning.warn(
            f"Waves all around of ± {rounded(highest * 1e6)} µm are {rounded(highest / approach)} times "
            f"the approach of the most loaded {rolls}, {rounded(approach * 1e6)} µm: {rolls}s lose contact "
            f"and come down harder than the laws cover, which is ± {rounded(held * 1e6)} µm. {REMEDY}"
        )


def doubt_fault(fault: Fault, apart: float, part: str, rolls: str) -> None:
    """Warn of a fault that is as long as what `rolls` is apart on a raceway, m, which `part` names."""
    length = fault.size[0]
    if length > apart:
        OutOfRangeWarning.warn(
            f"fault.length: the {fault.shape} on the {part} is {length * 1e3:.4g} mm long, the {rolls}s are "
            f"{apart * 1e3:.4g} mm apart: two or more are in it at once, and no {rolls} strikes it alone. "
            "Is the unit right?"
        )


def doubt_rise(fault: Fault, approach: float, part: str, rolls: str) -> None:
    """Warn of a fault that stands out of what `part` names by more than laws cover of an approach, m."""
    held = HELD * approach
    if fault.highest > held:
        key = "burr" if fault.burr else "map" if fault.shape == "map" else "depth"
        OutOfRangeWarning.warn(
            f"fault.{key}: the {fault.shape} on the {part} stands out by "
            f"{rounded(fault.highest * 1e6)} µm, {rounded(fault.highest / approach)} times the approach of "
            f"the most loaded {rolls}, {rounded(approach * 1e6)} µm: {rolls}s come down harder than the laws "
            f"cover, which is {rounded(held * 1e6)} µm. Is the unit right?"
        )
