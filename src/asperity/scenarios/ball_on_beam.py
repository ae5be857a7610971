"""A ball rolls over a rough beam: the whole chain from texture to spectra."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from asperity.config import BallOnBeamCase
from asperity.contact import Hertz
from asperity.pointforce import Law
from asperity.progress import Progress
from asperity.reference.materials import contact_modulus
from asperity.rolling.ball_on_beam import Rolling, roll
from asperity.scenarios.beam_textures import gather
from asperity.scenarios.chain import Chain, Checkpoint, Stopwatch, reduce_and_roll, warn_of_start
from asperity.scenarios.compiling import compile_kernels
from asperity.scenarios.geometry import Geometry, geometry, parabola, window_cells
from asperity.scenarios.textures import Textures
from asperity.store import Store, content_key
from asperity.structures.ball import Ball
from asperity.structures.beam import Beam

if TYPE_CHECKING:
    from asperity.scenarios.preparing import Prepared

MODES_BEYOND = 4.0
"""Beam modes are kept up to this multiple of the highest frequency."""


@dataclass(frozen=True, eq=False)
class Computed:
    """Everything that was computed for a case, before it is laid out as a result.

    Attributes
    ----------
    case : BallOnBeamCase
        The case.
    chain : Chain
        Textures, state functions, laws and runs.
    ball, beam
        What was rolled.
    """

    case: BallOnBeamCase
    chain: Chain[Rolling]
    ball: Ball
    beam: Beam


@dataclass(frozen=True, eq=False)
class Bodies:
    """What is rolled in a case.

    Attributes
    ----------
    ball, beam
        The bodies.
    """

    ball: Ball
    beam: Beam


def bodies_of(case: BallOnBeamCase) -> Bodies:
    """Build the bodies of a case.

    Parameters
    ----------
    case : BallOnBeamCase
        The case.

    Returns
    -------
    Bodies
        Ball and beam.

    Raises
    ------
    InputError
        If the beam has no natural frequency in the range.
    """
    beam = Beam.rectangular(
        case.beam.length,
        case.beam.width,
        case.beam.height,
        case.beam.material,
        support=case.beam.support,
        loss_factor=case.beam.loss_factor,
        highest_frequency=MODES_BEYOND * case.numerics.highest_frequency,
        suspension_frequency=case.beam.suspension_frequency,
    )
    return Bodies(_ball(case), beam)


def _ball(case: BallOnBeamCase) -> Ball:
    return Ball(case.ball.radius, case.ball.material, case.ball.load, case.ball.mass)


def geometry_of(case: BallOnBeamCase) -> Geometry:
    """Lay out the ball of a case on the contact grid, under its load.

    Parameters
    ----------
    case : BallOnBeamCase
        The case.

    Returns
    -------
    Geometry
        Shape of the ball.
    """
    modulus = contact_modulus(case.ball.material, case.beam.material)
    return ball_geometry(case, _ball(case).static_load, modulus)


def textures_of(case: BallOnBeamCase) -> Textures:
    """Gather the textures of a case.

    Parameters
    ----------
    case : BallOnBeamCase
        The case.

    Returns
    -------
    Textures
        With a window before and beyond the path.
    """
    return gather(case, window_cells(case.contact))


def warn_of(case: BallOnBeamCase, shape: Geometry, textures: Textures) -> None:
    """Warn of what is doubtful before anything is computed.

    Parameters
    ----------
    case, shape, textures
        The case, its geometry and its textures.
    """
    warn_of_start(case, "shorten the duration or start farther along the beam")


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
    assert isinstance(case, BallOnBeamCase)
    assert isinstance(bodies, Bodies)
    ball, beam, store, watch = bodies.ball, bodies.beam, Store(), Stopwatch(textures=prepared.seconds)
    compile_kernels(progress)  # not before the files are known to be right
    watch.lap("compiled functions")
    pace = case.contact.spacing / case.speed
    duration = min(case.rolled_time, (len(textures.line[textures.recorded]) - 1) * pace)
    checkpoint = Checkpoint(store, _run_key(case, textures, duration)) if "direct" in case.laws else None

    def roll_law(law: Law) -> Rolling:
        return roll(
            beam,
            ball,
            law,
            speed=case.speed,
            start=case.record_start,
            duration=duration,
            settling=case.settled_time,
            time_step=case.time_step,
            sensors=case.beam.sensor_positions,
            highest_frequency=case.numerics.highest_frequency,
            progress=progress,
            checkpoint=checkpoint if law.name == "direct" else None,
        )

    chain = reduce_and_roll(case, textures, prepared.shape, roll_law, store, progress, watch)
    return Computed(case, chain, ball, beam)


def ball_geometry(case: BallOnBeamCase, load: float, modulus: float) -> Geometry:
    """Lay out the ball of a case on the contact grid.

    Parameters
    ----------
    case : BallOnBeamCase
        The case.
    load : float
        Working load, N.
    modulus : float
        Contact modulus E*, Pa.

    Returns
    -------
    Geometry
        Shape of the ball.
    """
    radius, contact = case.ball.radius, case.contact
    hertz = Hertz(modulus, radius, radius)
    return geometry(contact, parabola(contact, radius), hertz, load, smallest_radius=radius, body="ball")


def _run_key(case: BallOnBeamCase, textures: Textures, duration: float) -> str:
    """Name of a direct run: everything that its motion depends on."""
    assert textures.path is not None
    scalars = [
        case.speed, case.record_start, case.settled_time, duration, case.time_step, case.numerics.rtol,
        case.numerics.highest_frequency, case.contact.hardness, case.contact.damping,
        list(case.beam.sensor_positions),
    ]  # fmt: skip
    sections = [case.ball.model_dump(mode="json"), case.beam.model_dump(mode="json")]
    return content_key("direct", textures.path.rows(0, textures.path.shape[0]), scalars, sections)
