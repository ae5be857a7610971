"""Ground with impedance between a source and a receiver: spherical waves over a locally reacting plane."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import wofz

from asperity.arguments import Array, Complex, finite_array, positive
from asperity.radiation.track import IMPEDANCE, SPEED_OF_SOUND, wavenumber
from asperity.spectra import HALF_BAND

AIR_DENSITY = IMPEDANCE / SPEED_OF_SOUND
"""kg/m³."""
_FEWEST_NODES = 8  # of Gauss's rule over a band, beside one per radian of the interference


@dataclass(frozen=True)
class PorousGround:
    """A plane, locally reacting ground of porous material, as thick as sound enters it.

    Parameters
    ----------
    flow_resistivity : float
        σ, Pa s/m²: that which fits the ground, an effective one.

    Raises
    ------
    InputError
        If it is not positive.

    Notes
    -----
    Fitted to fibrous material at 0.01 < ρf/σ < 1. Ground has less, and is described all the same (C. I.
    Chessell, J. Acoust. Soc. Am. 62 (1977) 825), reasonably from about 250 Hz on (T. J. Cox and P. D'Antonio,
    Acoustic Absorbers and Diffusers, 3rd edition, p. 199). Coarse ballast, into which sound goes sideways as
    well, is no such ground (K. Attenborough et al., J. Acoust. Soc. Am. 129 (2011) 2806).
    """

    flow_resistivity: float

    def __post_init__(self) -> None:
        positive("flow resistivity of the ground (Pa s/m²)", self.flow_resistivity)

    def impedance(self, frequency: ArrayLike) -> Complex:
        """Characteristic impedance over that of air, e^{+iωt}, at positive frequencies, Hz."""
        at = finite_array("frequency (Hz)", frequency, "finite positive numbers", above=0.0)
        x = AIR_DENSITY * at / self.flow_resistivity
        return np.asarray(1.0 + 0.0571 * x**-0.754 - 0.087j * x**-0.732)

    def reflection(self, frequency: ArrayLike, cosine: ArrayLike, distance: ArrayLike) -> Complex:
        """Reflection coefficient of a spherical wave, with the ground wave.

        Parameters
        ----------
        frequency : array_like
            Hz.
        cosine : array_like
            Of the angle of incidence, from the normal: zero at grazing incidence.
        distance : array_like
            Length of the reflected path, m, long against a wave.

        Returns
        -------
        ndarray
            Q = R_p + (1 − R_p) F(w) of all three, broadcast.

        Notes
        -----
        C. F. Chien and W. W. Soroka, J. Sound Vib. 43 (1975) 9, here for e^{+iωt}: with the admittance β
        R_p = (cos θ − β)/(cos θ + β), w = (1 − i)/2 √(kR) (cos θ + β), F = 1 − i√π w exp(−w²) erfc(iw).
        """
        admittance, cos = 1.0 / self.impedance(frequency), np.asarray(cosine, dtype=float)
        plane = (cos - admittance) / (cos + admittance)
        path = np.sqrt(wavenumber(np.asarray(frequency, dtype=float)) * np.asarray(distance, dtype=float))
        w = (0.5 - 0.5j) * path * (cos + admittance)
        return np.asarray(plane + (1.0 - plane) * (1.0 - 1j * np.sqrt(np.pi) * w * wofz(-w)))

    def inverse_square(self, band: Array, heights: tuple[float, float], along: Array) -> Array:
        """Mean of 1/d² over a band: what stands for it where direct and reflected sound interfere.

        Parameters
        ----------
        band : ndarray (b,)
            Centres of one-third octaves, Hz, in which the power is even over lg f.
        heights : tuple of float
            Of source and receiver above the ground, m.
        along : ndarray (n,)
            Distances between them along the ground, m.

        Returns
        -------
        ndarray (b, n)
            1/m²; over hard ground, as a mean over all directions, 1/d².

        Notes
        -----
        ½ |exp(−ikR₁)/R₁ + Q exp(−ikR₂)/R₂|²/(1 + sin(2kh)/2kh): a monopole at the height h whose strength is
        such that it radiates its power over hard ground.
        """
        source, receiver = heights
        direct, reflected = np.hypot(along, receiver - source), np.hypot(along, receiver + source)
        cosine, difference = (receiver + source) / reflected, reflected - direct
        turns = 0.25 * float(wavenumber(band).max() * difference.max())  # of the phase over a band
        nodes, weights = np.polynomial.legendre.leggauss(_FEWEST_NODES + int(np.ceil(turns)))
        mean = np.zeros((len(band), len(along)))
        for node, weight in zip(nodes, weights, strict=True):
            f = (band * HALF_BAND**node)[:, None]
            k = wavenumber(f)
            delayed = self.reflection(f, cosine, reflected) * np.exp(-1j * k * difference) / reflected
            mean += (
                0.5 * weight * np.abs(1.0 / direct + delayed) ** 2 / (1.0 + np.sinc(2.0 * k * source / np.pi))
            )
        return 0.5 * mean
