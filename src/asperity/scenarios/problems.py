"""What is wrong with a case that was read: told by its keys, before anything is computed."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from asperity.case.any_case import entries
from asperity.case.scene import Case
from asperity.contact.batched import find_device
from asperity.errors import CaseError, InputError, OutOfRangeWarning
from asperity.reduction.filter import FEWEST_POSITIONS
from asperity.scenarios import reducing
from asperity.scenarios.scene import PreparedCase
from asperity.scenarios.textures import lowest_recorded, recorded_time
from asperity.spectra import HALF_BAND, nominal_frequency, root_mean_square
from asperity.structures.moving_kernel import refuse_kernel
from asperity.structures.track import Track
from asperity.units import written
from asperity.written_numbers import in_newtons, rounded

STEEPEST = 1.0
"""Rms slope up to which surfaces are taken for such: the half-space is for small ones."""
ROUGHEST = 100.0
"""Rms height within the window up to which contacts are solved, in approaches of the smooth bodies."""
COMPARED = 10.0
"""The same up to which laws were compared with each other."""
_UNITS = {
    "file": 'Are the heights in µm? Then set height_unit = "um", and the pixel with its unit.',
    "rms": 'Is rms in µm? Then write it so: rms = "0.5 um".',
    "line": 'Are the heights in µm? Then set line_unit = "um", and line_spacing with its unit.',
    "spectrum": "Are the levels in dB re 1 µm, and the wavelengths in their unit?",
}
"""What to ask about heights that are too large, by the key that they come from."""


def refuse(errors: Sequence[InputError], source: str) -> None:
    """Raise errors, all at once; none where there are none."""
    if errors:
        raise errors[0] if len(errors) == 1 else CaseError(source, [str(error) for error in errors])


WORDS = {
    "depth of the dipped joint": "surface.joint_depth",
    "corrugation": "surface.corrugation_wavelength",
    "turning of the wheel": "speed",
    "positions of the supports (m)": "{over}.supports",
    "position of a support (m)": "{over}.supports",
    "supports": "{over}.supports",
    "depth of the wheel flat": "{rolling}.flat_depth",
    "length of the wheel flat": "{rolling}.flat_length",
    "load (N)": "{rolling}.load",
    "contact": "{rolling}.load",
}
"""Keys of what parts of a case that know no keys call otherwise."""


def by_key(case: Case, error: InputError) -> InputError:
    """An error, told by the key of a case that it is about, if there is one."""
    known = {entry.dotted for entry in entries(type(case))}
    name = error.what.partition("[")[0]
    places = {"over": case.over_name, "rolling": case.ROLLING}
    if name in known or name.partition(".")[0] in places.values():
        return error
    for section in ("surface", case.ROLLING, "contact", case.over_name):
        if f"{section}.{name}" in known:
            return error.about(f"{section}.{error.what}")
    return error.about(WORDS[name].format(**places)) if name in WORDS else error


def _problems_of_record(prepared: PreparedCase) -> Iterator[InputError]:
    """A record that holds no one-third octave up to the highest frequency."""
    case = prepared.case
    recorded = recorded_time(case, prepared.textures)
    highest = case.numerics.highest_frequency
    lowest = lowest_recorded(case, recorded)
    if highest * HALF_BAND < lowest:
        received = f"{rounded(highest, 4)} Hz with a record of {recorded:.4g} s"
        allowed = (
            "a record that holds a one-third octave up to it; of this the lowest is at "
            f"{rounded(lowest, 4)} Hz"
        )
        least = f"at least {nominal_frequency(lowest)}"
        remedy = f"Record longer (duration), or ask for {least}."
        yield InputError("numerics.highest_frequency", received, allowed, remedy)


def _problem_of_heights(prepared: PreparedCase) -> InputError | None:
    """Heights that no surface has on which bodies roll: most often in another unit."""
    case = prepared.case
    shape = prepared.shape
    textures = prepared.textures
    nx, ny = shape.body.shape
    maps = textures.maps
    depth = case.surface.corrugation
    wave = case.surface.corrugation_wavelength
    if depth is not None and wave is not None and 2.0 * math.pi * depth > STEEPEST * wave:
        received = f"{written(depth, 'm', 'um')} in waves of {written(wave, 'm', 'mm')}"
        allowed = (
            f"slopes up to {STEEPEST:g}, {written(STEEPEST * wave / (2.0 * math.pi), 'm', 'um')} in these"
        )
        return InputError("surface.corrugation", received, allowed, "Are both units right?")
    slope = root_mean_square(np.diff(textures.line)) / case.contact.spacing
    rough = 0.0
    if maps:
        slope = textures.rms_slope
        rough = float(np.mean([np.std(sample.heights[:nx, :ny]) for sample in maps]))
    approach = shape.hertz.approach(shape.load)
    if slope <= STEEPEST and rough <= ROUGHEST * approach:
        if rough > COMPARED * approach:
            OutOfRangeWarning.warn(
                f"Heights of {rounded(1e6 * rough)} µm rms within the window are {rounded(rough / approach)} "
                f"approaches of the smooth bodies, {rounded(1e6 * approach)} µm each: they touch at single "
                f"peaks, which would yield, and laws were compared up to {COMPARED:g}. Are load and heights "
                "in the right units?"
            )
        return None
    received = f"heights with an rms slope of {rounded(slope)}"
    allowed = f"slopes up to {STEEPEST:g}"
    if slope <= STEEPEST:
        received = f"heights of {rounded(1e6 * rough)} um rms within the window"
        allowed = f"up to {ROUGHEST:g} approaches of the bodies, {rounded(1e6 * approach)} um each"
    of_wheel, of_rail = (np.std(np.diff(textures.parts[part])) for part in ("wheel", "rail"))
    section, name = (case.rolling, case.ROLLING) if of_wheel > of_rail else (case.surface, "surface")
    key = next((key for key in _UNITS if getattr(section, key, None) is not None), "")
    return InputError(f"{name}.{key}".rstrip("."), received, allowed, _UNITS.get(key, ""))


def _problems_of_kernel(case: Case, track: Track) -> Iterator[InputError]:
    """What of the moving kernel of a track is known before it is computed: its frequencies and its size."""
    try:
        refuse_kernel(track, case.time_step)
    except InputError as error:
        key = "numerics.time_step" if case.numerics.time_step is not None else "numerics.highest_frequency"
        if error.what == "bays that differ":
            key = "track.bay_table" if case.track.bay_table is not None else "track.bays"
        yield error.about(key, f"{error.received} ({error.what})")


def problems(prepared: PreparedCase) -> Iterator[InputError]:
    """What the run would refuse of textures, samples, window and track, as far as it can be known before."""
    contact = prepared.case.contact
    shape = prepared.shape
    textures = prepared.textures
    yield from _problems_of_record(prepared)
    if isinstance(prepared.scene.over, Track):
        yield from _problems_of_kernel(prepared.case, prepared.scene.over)
    if contact.rim_cells == "covered" and find_device() is not None:
        remedy = "Take whole cells, or compute on the device cpu."
        yield InputError("contact.rim_cells", '"covered"', '"whole" on the device gpu', remedy)
    nx, ny = shape.body.shape
    if (steep := _problem_of_heights(prepared)) is not None:
        yield steep
        return
    smallest = min((min(sample.shape) for sample in textures.maps), default=nx)
    if smallest < nx:
        allowed = f"at most the measured map, {rounded(smallest * contact.spacing * 1e6, 4)} um"
        received = written(contact.window, "m", "um")
        yield InputError("contact.window", received, allowed, "Choose a smaller one, or measure wider maps.")
        return
    if textures.strips and any(strip.heights.any() for strip in textures.strips):
        rows = min(strip.shape[0] for strip in textures.strips)
        stride = reducing.filter_stride(shape)
        if (rows - nx) // stride + 1 < FEWEST_POSITIONS:
            least = (nx + (FEWEST_POSITIONS - 1) * stride) * contact.spacing
            received = f"strips of {rounded(rows * contact.spacing * 1e6, 4)} um"
            allowed = f"at least {rounded(least * 1e6, 4)} um, in which the contact is filtered"
            yield InputError(
                "contact.sample_length", received, allowed, "Lengthen it, or measure larger maps."
            )
    if contact.running_in is not None and not textures.strips:
        allowed = "only together with a surface that asperities are known of: file, or rms"
        yield InputError(
            "contact.running_in", str(contact.running_in), allowed, "Remove the key, or name one."
        )
    if contact.hardness is not None:
        largest = contact.hardness * contact.spacing**2 * nx * ny
        needed = shape.load if contact.approaches is not None else shape.largest_force
        if needed >= largest:
            received = (
                f"{contact.hardness / 1e9:.4g} GPa, with which the window carries {in_newtons(largest)}"
            )
            allowed = f"more than the {rounded(needed, 4)} N that are needed"
            yield InputError("contact.hardness", received, allowed, "Enlarge contact.window.")
