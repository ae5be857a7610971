"""A ball rolls over a rough beam: the whole chain from texture to spectra."""

from __future__ import annotations

from dataclasses import dataclass

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


def compute(case: BallOnBeamCase, progress: Progress) -> Computed:
    """Gather, reduce and roll.

    Parameters
    ----------
    case : BallOnBeamCase
        The case.
    progress : Progress
        Called during long work.

    Returns
    -------
    Computed
        All that was computed.
    """
    store, watch = Store(), Stopwatch()
    ball = Ball(case.ball.radius, case.ball.material, case.ball.load, case.ball.mass)
    beam = _beam(case)
    shape = ball_geometry(case, ball.static_load, contact_modulus(case.ball.material, case.beam.material))
    textures = gather(case, window_cells(case.contact))
    watch.lap("textures")
    compile_kernels(progress)  # not before the files are known to be right
    watch.lap("compiled functions")
    pace = case.contact.spacing / case.speed
    duration = min(case.rolled_time, (len(textures.line[textures.recorded]) - 1) * pace)
    warn_of_start(case, "shorten the duration or start farther along the beam")
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

    chain = reduce_and_roll(case, textures, shape, roll_law, store, progress, watch)
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


def _beam(case: BallOnBeamCase) -> Beam:
    return Beam.rectangular(
        case.beam.length,
        case.beam.width,
        case.beam.height,
        case.beam.material,
        support=case.beam.support,
        loss_factor=case.beam.loss_factor,
        highest_frequency=MODES_BEYOND * case.numerics.highest_frequency,
        suspension_frequency=case.beam.suspension_frequency,
    )


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
