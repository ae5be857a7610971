"""Grids of raceways, and of surfaces of balls and rollers, that slender contacts ask for."""

import math
from collections.abc import Sequence

from scipy import fft

from asperity.arguments import positive
from asperity.contact.hertz import Hertz
from asperity.contact.slices import SlicedContact
from asperity.surfaces.faults import Fault
from asperity.surfaces.raceway import AroundTexture, Raceway, raceway

AnyContact = Hertz | SlicedContact
"""Smooth contact of a ball, or of a roller, with its raceway."""
CELLS = (8, 16)
"""Cells along and across to a half axis of the contact under the load."""
CELLS_OF_FAULT = 8
"""Cells to the length and the width of a fault, or to twice the width of its burr, at least."""
CELLS_OF_WAVE = 3
"""Cells to the shortest wavelength of a roughness, at least."""
HALF_WINDOW = 3.2
"""Half the window over the half axes under the load: 1.6 times those under the largest force of a state."""
FOLLOWED = 10.0
"""Half axes along, under the load, of a wave that contacts follow as a plane, and its bow is not in the scan:
half a per cent of the force at an amplitude of a tenth of the approach, which itself moves 15 %."""


def raceway_on(
    contact: AnyContact,
    load: float,
    radius: float,
    texture: AroundTexture | None = None,
    faults: Sequence[Fault] = (),
    *,
    seed: int = 0,
) -> Raceway:
    """Make a raceway, or the surface of a ball or roller, on the grid that its contacts ask for.

    Parameters
    ----------
    contact : Hertz or SlicedContact
        Smooth contact of ball or roller and raceway, x along the path.
    load : float
        Largest static load of a ball or roller, N: laws are made for up to eight times as much.
    radius : float
        Of the path around, m: of the raceway, or of the ball.
    texture : AroundTexture, optional
        What is on it all around; smooth by default.
    faults : sequence of Fault
        What is damaged.
    seed : int
        Of phases and roughness.

    Returns
    -------
    Raceway
        As wide as the contacts of balls; as rollers are long, in whole numbers of lines for each slice.

    Raises
    ------
    InputError
        For faults off the raceway, textures that do not close, and surfaces of too many points.
    """
    texture = texture or AroundTexture()
    around = 2.0 * math.pi * positive("radius of the raceway (m)", radius)
    axes = contact.semi_axes_under(positive("load of a ball or roller (N)", load))
    slice_length = None if isinstance(contact, Hertz) else contact.length / contact.slices
    cells = axes[0] / CELLS[0], slice_length or axes[1] / CELLS[1]
    wave = [texture.shortest / CELLS_OF_WAVE] if texture.is_rough else []
    along, across = (
        min([cell, *wave, *(fault.details[axis] / CELLS_OF_FAULT for fault in faults)])
        for axis, cell in enumerate(cells)
    )
    stride = max(1, math.floor(cells[0] / along + 1e-9))
    rows = stride * fft.next_fast_len(math.ceil(around / along / stride), real=True)
    if isinstance(contact, Hertz):
        # a ball sinks into a hollow until it lands on edges, which may be as far out
        rx = 8.0 * contact.radius_x
        ry = 8.0 * contact.radius_y
        sinks = max((min(f.depth, f.size[0] ** 2 / rx, f.size[1] ** 2 / ry) for f in faults), default=0.0)
        half = HALF_WINDOW * axes[1] + 0.5 * math.sqrt(ry * sinks)
        lines = 2 * math.ceil(half / across) + 1
    else:
        lines = contact.slices * (2 * math.ceil(0.5 * (cells[1] / across - 1.0) - 1e-9) + 1)
        across = contact.length / lines
    steps = around / rows, across
    return raceway(texture, faults, (rows, lines), steps, seed=seed, followed=FOLLOWED * axes[0])
