"""A wheel rolls on an infinite track: the whole chain from texture to sound power."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from asperity.config import WheelOnRailCase
from asperity.config.tables import read_modes, read_receptance
from asperity.errors import TruncatedContactWarning, UnconvergedWarning
from asperity.pointforce import Law
from asperity.progress import Progress
from asperity.rolling.passing import passed_points
from asperity.rolling.wheel_on_rail import WheelRolling, roll
from asperity.scenarios.chain import Chain, Checkpoint, Stopwatch, reduce_and_roll, warn_of_start
from asperity.scenarios.compiling import compile_rail_kernels
from asperity.scenarios.geometry import Geometry
from asperity.scenarios.rail_defects import NEED_GEOMETRY
from asperity.scenarios.rail_geometry import rail_geometry
from asperity.scenarios.rail_textures import gather
from asperity.scenarios.textures import Textures
from asperity.store import Store, content_key
from asperity.structures.moving_kernel import MovingKernel, moving_kernel
from asperity.structures.rail_poles import RailPoles, most_poles, rail_poles
from asperity.structures.track import Track
from asperity.structures.wheel import Wheel

if TYPE_CHECKING:
    from asperity.scenarios.preparing import Prepared

POLES = 100
"""Poles of a rail where the case says nothing, if its kernel has lags enough."""


@dataclass(frozen=True, eq=False)
class Computed:
    """Everything that was computed for a case, before it is laid out as a result.

    Attributes
    ----------
    case : WheelOnRailCase
        The case.
    chain : Chain
        Textures, state functions, laws and runs.
    wheel, track
        What was rolled.
    kernel : MovingKernel
        Response of the rail under the moving contact.
    rail : RailPoles or MovingKernel
        How it was carried on in time.
    points : tuple of ndarray (laws, points, n)
        Displacement, m, and velocity, m/s, of the passed points.
    """

    case: WheelOnRailCase
    chain: Chain[WheelRolling]
    wheel: Wheel
    track: Track
    kernel: MovingKernel
    rail: RailPoles | MovingKernel
    points: tuple[NDArray[np.float64], NDArray[np.float64]]


@dataclass(frozen=True, eq=False)
class Bodies:
    """What is rolled in a case.

    Attributes
    ----------
    wheel, track
        The bodies.
    """

    wheel: Wheel
    track: Track


def bodies_of(case: WheelOnRailCase) -> Bodies:
    """Build the bodies of a case.

    Parameters
    ----------
    case : WheelOnRailCase
        The case.

    Returns
    -------
    Bodies
        Wheel and track.

    Raises
    ------
    InputError
        If the wheel's receptance is none.
    """
    return Bodies(wheel_of(case), case.track_model())


def geometry_of(case: WheelOnRailCase) -> Geometry:
    """Lay out wheel and rail of a case on the contact grid, see `rail_geometry`."""
    return rail_geometry(case)


def textures_of(case: WheelOnRailCase) -> Textures:
    """Gather the textures of a case, see `asperity.scenarios.rail_textures.gather`."""
    return gather(case)


def compute(prepared: Prepared, progress: Progress) -> Computed:
    """Reduce and roll.

    Parameters
    ----------
    prepared : Prepared
        A case from `asperity.scenarios.preparing.prepare`.
    progress : Progress
        Called during long work.

    Returns
    -------
    Computed
        All that was computed.
    """
    case, bodies, textures = prepared.case, prepared.bodies, prepared.textures
    assert isinstance(case, WheelOnRailCase)
    assert isinstance(bodies, Bodies)
    track, wheel, store = bodies.track, bodies.wheel, Store()
    watch = Stopwatch(textures=prepared.seconds)
    compile_rail_kernels(progress)  # not before the files are known to be right
    watch.lap("compiled functions")
    kernel = moving_kernel(track, case.speed, case.time_step, cache=store, progress=progress)
    rail: RailPoles | MovingKernel = kernel
    if case.numerics.kernel == "poles":
        count = case.numerics.poles or min(POLES, most_poles(kernel.weights.shape[1]))
        found = rail_poles(kernel, count=count, cache=store)
        if found.accepted:
            rail = found
        else:
            warnings.warn(
                f"{count} poles miss the moving kernel by {100 * found.fit_error:.2g} %: the "
                "track is scattered from the kernel itself, which is slower. Take more poles.",
                UnconvergedWarning,
                stacklevel=2,
            )
    watch.lap("track")
    checkpoint = Checkpoint(store, _run_key(case, textures)) if "direct" in case.laws else None

    def roll_law(law: Law) -> WheelRolling:
        return roll(
            rail,
            wheel,
            law,
            start=case.start,
            duration=case.duration,
            settling=case.settling,
            highest_frequency=case.numerics.highest_frequency,
            progress=progress,
            checkpoint=checkpoint if law.name == "direct" else None,
        )

    chain = reduce_and_roll(case, textures, prepared.shape, roll_law, store, progress, watch)
    points = passed_points(kernel, list(chain.runs.values()), case.point_positions, progress)
    watch.lap("passed points")
    return Computed(case, chain, wheel, track, kernel, rail, points)


def wheel_of(case: WheelOnRailCase) -> Wheel:
    """Build the wheel of a case.

    Parameters
    ----------
    case : WheelOnRailCase
        The case.

    Returns
    -------
    Wheel
        Rigid, or with the modes or the receptance that the case names.
    """
    section = case.wheel
    if section.modes is not None:
        return Wheel.from_modes(section.mass, section.load, *read_modes(section.modes))
    if section.receptance is not None:
        highest = case.numerics.highest_frequency
        measured = read_receptance(section.receptance)
        return Wheel.from_receptance(section.mass, section.load, *measured, highest_frequency=highest)
    return Wheel.rigid(section.mass, section.load)


def warn_of(case: WheelOnRailCase, shape: Geometry, textures: Textures) -> None:
    """Warn of a record that holds the start, and of a window too short for what a law shall see of a defect.

    Parameters
    ----------
    case, shape, textures
        The case, its geometry and its textures.
    """
    warn_of_start(case, "set settling")
    seen = [law for law in case.laws if law in NEED_GEOMETRY]
    if not seen or textures.defects is None or case.wheel.flat is None:
        return
    _, length = case.wheel.flat
    window, a = case.contact.window, shape.semi_axes[0]
    if length + 2 * a > window:
        warnings.warn(
            f"the flat is {length * 1e3:.3g} mm long and the contact {2e3 * a:.3g} mm, together more than "
            f"contact.window = {window * 1e3:.3g} mm: where the wheel stands on the flat's ends, "
            f"{' and '.join(seen)} cut the contact off. Enlarge the window.",
            TruncatedContactWarning,
            stacklevel=2,
        )


def _run_key(case: WheelOnRailCase, textures: Textures) -> str:
    """Name of a direct run: everything that its motion depends on."""
    scalars = [case.speed, case.start, case.duration, case.settling, case.time_step, case.numerics.rtol]
    contact = [case.contact.hardness, case.contact.damping, case.contact.spacing]
    sections = [s.model_dump(mode="json") for s in (case.wheel, case.track, case.numerics)]
    files = [case.wheel.profile, case.track.rail_profile, case.wheel.modes, case.wheel.receptance]
    content = [path.read_bytes().hex() for path in files if path is not None]
    heights = textures.surface.rows(0, len(textures.line))
    return content_key("direct-rail", heights, scalars, contact, sections, content)
