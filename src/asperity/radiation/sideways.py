"""Sound of what moves sideways: of the rail, and of a wheel on which two forces act."""

from dataclasses import dataclass

import numpy as np

from asperity.arguments import Array, ArrayLike, Complex, positive
from asperity.radiation.track import IMPEDANCE, above_zero, dipole_ratio
from asperity.structures.lateral_rail import LateralTrack, contact_shapes

BOX = 1.19
"""Area of the air that goes with a square section, over the square of its height (of a flat strip π/4)."""


@dataclass(frozen=True)
class SideOfRail:
    """Section of a rail as a radiator of its lateral motion.

    Parameters
    ----------
    height, foot_width, head_width : float
        H, b_f and b_h, m.

    Raises
    ------
    InputError
        If a dimension is not positive.

    Notes
    -----
    The power per length is ρ c · 2H · σ · ⟨v²⟩, ⟨v²⟩ the mean over the height. The air between head and foot
    moves with the web: at low frequency the section is the line dipole of a box, of the area D = H (b_f +
    b_h)/2 + 1.19 H²; at high frequency its two sides radiate like plane ones. In between as
    `asperity.radiation.track.RailSection`. Against boundary elements of the section 60E1 in free air:
    +0.8 to −1 dB up to 315 Hz, −2 to −3.4 dB from 400 to 800 Hz, where the space between head and foot
    resonates, −1.5 to +2 dB above. Roll counts as much as motion of the whole, though it is a poorer
    radiator.
    """

    height: float
    foot_width: float
    head_width: float

    def __post_init__(self) -> None:
        for what in ("height", "foot_width", "head_width"):
            positive(f"{what} of the rail's section", getattr(self, what))

    def radiation_ratio(self, frequency: ArrayLike) -> Array:
        """Ratio σ (f,) at positive frequencies (f,), Hz."""
        outline = 0.5 * self.height * (self.foot_width + self.head_width)
        return dipole_ratio(above_zero(frequency), outline + BOX * self.height**2, 2.0 * self.height)

    def power(self, frequency: ArrayLike, square: Array) -> Array:
        """Sound power (..., f), W, of a mean square velocity that is integrated along the rail (..., f)."""
        return IMPEDANCE * 2.0 * self.height * self.radiation_ratio(frequency) * square


FEWEST_NODES = 4  # of Gauss's rule, beside one per radian of the shortest wave


def squared_lateral_mobility(
    track: LateralTrack, frequency: ArrayLike, places: Array, place: float
) -> Complex:
    """Integrals along the rail of how two forces at a contact move it sideways, (n, 2, 2, f), m (m/s)²/N².

    Parameters
    ----------
    track : LateralTrack
    frequency : array_like (f,)
        Hz, positive.
    places : ndarray (n,)
        Of the contact in the bay, 0 to L, m, that lie symmetrically about its middle.
    place : float
        Of the contact across the head, m from its middle, positive towards the field side.

    Returns
    -------
    ndarray (n, 2, 2, f) of complex
        Hermitian M, by which forces (F, T), downwards and sideways, make ∫⟨v²⟩ dx = (F, T)* M (F, T), mean
        over the height of the rail; right of each place twice, so that the mean over all places holds both
        sides.
    """
    omega = 2.0 * np.pi * above_zero(frequency)
    waves, rail, spacing = track.waves(omega), track.rail, track.track.sleeper_spacing
    low, high = -rail.foot_depth, rail.head_height
    slope = 0.5 * (high + low)
    height = np.array([[1.0, slope], [slope, (high**2 + high * low + low**2) / 3.0]])
    count = FEWEST_NODES + int(np.ceil(np.abs(waves.wavenumbers).max() * spacing))
    node, weight = (0.5 * each for each in np.polynomial.legendre.leggauss(count))
    node = node + 0.5

    def within(moved: Complex, length: float) -> Complex:
        """Integral over a piece of the products of motions (x, 2, i, f) at its nodes, (i, j, f)."""
        total = np.einsum("x,xaif,ab,xbjf->ijf", weight, moved.conj(), height, moved, optimize=True)
        return np.asarray(length * total)

    bay = within(np.stack([waves.outgoing(spacing * x) for x in node]), spacing)
    product = waves.multipliers.conj()[:, None] * waves.multipliers
    behind, forces, found = bay * product / (1.0 - product), contact_shapes(rail, place), []
    for x0 in places:
        sent = waves.coefficients * np.einsum("aj...,na->nj...", waves.incoming(x0), forces)
        rest = spacing - x0
        near = [np.einsum("ajf,njf->anf", waves.outgoing(x0 + rest * x), sent) for x in node]
        far = np.einsum("mif,njf,ijf->mnf", sent.conj(), sent, behind, optimize=True)
        found.append(far + within(np.stack(near), rest))
    return np.asarray(2.0 * omega**2 * np.stack(found))
