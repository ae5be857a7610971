"""A crowned roller on its raceway as a half-space: what slices are held against, ends and edges included."""

from dataclasses import dataclass

import numpy as np

from asperity.arguments import Array, positive, real, whole
from asperity.contact.halfspace import HalfSpace
from asperity.contact.slices import SlicedContact
from asperity.contact.solved import Contact
from asperity.errors import HalfSpaceWarning, percent

HALF_WINDOW = 3.0
"""Half the window along the path over the half width of the slice that is pressed most."""
CARRIES = 0.25
"""Pressure at an end over the largest without ends, from which on it is told that the roller ends there."""


@dataclass(frozen=True, eq=False)
class SolvedRoller:
    """A roller pressed on its raceway, both half-spaces.

    Attributes
    ----------
    places : ndarray (n,)
        Middles of the cells along the roller, from its middle, m.
    line_load : ndarray (n,)
        Force per length there, N/m.
    pressure : ndarray (n,)
        Largest pressure across each of these places, Pa.
    moment : float
        Of the forces about the middle of the roller, N m, as of `PressedSlices`.
    contact : Contact
        The solution on all cells, along the path and along the roller: its approach, force and pressures.
    """

    places: Array
    line_load: Array
    pressure: Array
    moment: float
    contact: Contact

    @property
    def approach(self) -> float:
        """Approach of roller and raceway in the middle, m."""
        return self.contact.approach


def solved_roller(
    sliced: SlicedContact,
    force: float,
    tilt: float = 0.0,
    *,
    cells: tuple[int, int] = (8, 101),
    rtol: float = 1e-5,
) -> SolvedRoller:
    """Press a crowned roller, tilted if wanted, on its raceway: in three dimensions, on slender cells.

    Parameters
    ----------
    sliced : SlicedContact
        The roller: its modulus, radius and crowning.
    force : float
        N.
    tilt : float
        Angle by which the end at positive places comes nearer, rad.
    cells : (int, int)
        To the half width of the contact along the path, and to the length of the roller.
    rtol : float
        As of `HalfSpace.solve`.

    Returns
    -------
    SolvedRoller

    Raises
    ------
    InputError
        For a force or cells that cannot be.

    Warns
    -----
    HalfSpaceWarning
        Where an end carries: the roller ends there, which no half-space does. The pressure in the outermost
        cells follows from their size then, and that of a sharp end is higher without limit.

    Examples
    --------
    >>> from asperity import Crowning, SlicedContact
    >>> roller = SlicedContact(113.7e9, 3.25e-3, Crowning.iso(length=6e-3, diameter=7.5e-3))
    >>> found = solved_roller(roller, 500.0, cells=(6, 61))
    >>> f"{found.approach * 1e6:.2f} um, {found.pressure.max() / 1e9:.2f} GPa"
    '3.83 um, 1.22 GPa'
    """
    force = positive("force (N)", force)
    real("tilt (rad)", tilt, "an angle between -0.1 and 0.1", above=-0.1, below=0.1)
    allowed = "two whole numbers, 4 or more to the half width, and 30 or more to the length"
    to_width = whole("cells of the roller", cells[0], allowed, at_least=4)
    along = whole("cells of the roller", cells[1], allowed, at_least=30)
    pressures = sliced.pressures(sliced.pressed(sliced.approach(force, tilt), tilt).loads)
    half_width = 2.0 * sliced.radius * float(pressures.max()) / sliced.modulus
    spacing = half_width / to_width, sliced.length / along
    path = spacing[0] * np.arange(-round(HALF_WINDOW * to_width), round(HALF_WINDOW * to_width) + 1)
    places = spacing[1] * (np.arange(along) - 0.5 * (along - 1))
    gap = np.add.outer(path**2 / (2.0 * sliced.radius), sliced.crowning.drops(places) - tilt * places)
    found = HalfSpace(gap.shape, spacing, sliced.modulus).solve(gap, load=force, rtol=rtol)
    line_load = found.pressure.sum(axis=0) * spacing[0]
    highest = found.pressure.max(axis=0)
    at_end = float(highest[[0, -1]].max() / pressures.max())
    if at_end > CARRIES:
        HalfSpaceWarning.warn(
            f"An end of the roller carries {percent(at_end)} of the largest pressure of its slices: the "
            "roller ends there, which a half-space does not, and the pressure in the outermost cells follows "
            "from their size. Take a crowning that falls back more, or less tilt."
        )
    moment = float(line_load @ places) * spacing[1]
    return SolvedRoller(
        np.asarray(places, dtype=float), np.asarray(line_load), np.asarray(highest), moment, found
    )
