"""How sound comes from the rails to a receiver: over what ground, from which rail, how evenly it leaves.

All sources are incoherent. As far as nothing else is said they radiate evenly over reflecting ground, so that
p² = W ρc Q/(4π d²) with Q = 2 at a distance d.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import wofz

from asperity.arguments import Array, ArrayLike, Complex, require
from asperity.quadrature import gauss
from asperity.radiation.pass_by import STEPS, AxleSource, Passage, Receiver, time_weighted
from asperity.radiation.track import IMPEDANCE, SPEED_OF_SOUND, wavenumber
from asperity.reference import cnossos
from asperity.spectra import HALF_BAND, energy_of

AIR_DENSITY = IMPEDANCE / SPEED_OF_SOUND
"""kg/m³."""
DIRECTIVITY_FACTOR = 2.0
"""Q: all of the power goes above the ground."""
_FACTOR = IMPEDANCE * DIRECTIVITY_FACTOR / (4.0 * np.pi)  # of p² = W ρc Q/(4π d²)
_FEWEST_NODES = 8  # of Gauss's rule over a band, beside one per radian of the interference


@dataclass(frozen=True)
class PorousGround:
    """A plane, locally reacting ground of porous material, as thick as sound enters it.

    Parameters
    ----------
    flow_resistivity : float
        σ, Pa s/m²: that which fits the ground, an effective one.

    Notes
    -----
    Fitted to fibrous material at 0.01 < ρf/σ < 1. Ground has less, and is described all the same (C. I.
    Chessell, J. Acoust. Soc. Am. 62 (1977) 825), reasonably from about 250 Hz on (T. J. Cox and P. D'Antonio,
    Acoustic Absorbers and Diffusers, 3rd edition, p. 199). Coarse ballast, into which sound goes sideways as
    well, is no such ground (K. Attenborough et al., J. Acoust. Soc. Am. 129 (2011) 2806).
    """

    flow_resistivity: float

    def impedance(self, frequency: ArrayLike) -> Complex:
        """Characteristic impedance over that of air, e^{+iωt}, at positive frequencies, Hz."""
        x = AIR_DENSITY * np.asarray(frequency, dtype=float) / self.flow_resistivity
        return 1.0 + 0.0571 * x**-0.754 - 0.087j * x**-0.732

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
        admittance = 1.0 / self.impedance(frequency)
        cos = np.asarray(cosine, dtype=float)
        plane = (cos - admittance) / (cos + admittance)
        path = np.sqrt(wavenumber(np.asarray(frequency, dtype=float)) * np.asarray(distance, dtype=float))
        w = (0.5 - 0.5j) * path * (cos + admittance)
        return plane + (1.0 - plane) * (1.0 - 1j * np.sqrt(np.pi) * w * wofz(-w))

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
        direct = np.hypot(along, receiver - source)
        reflected = np.hypot(along, receiver + source)
        cosine = (receiver + source) / reflected
        difference = reflected - direct
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


# --- from the rails to a receiver


_PLACES = 400  # along the rail at which paths are computed; in between they are interpolated
_ANGLES = 200  # at which sound comes, from opposite to along the rail: even at both ends, midpoints do


@dataclass(frozen=True, eq=False)
class SoundPath:
    """What stands between sources and receiver, in one-third octaves.

    Parameters
    ----------
    band : ndarray (b,)
        Centres, Hz.
    receiver : Receiver
        Where the sound is heard.
    ground : PorousGround, optional
        Its impedance; without it sound of the ground adds as energy, as that of a hard one does in the mean.
    ground_depth : float
        Of the ground below the rail head, m.
    directivity : str
        ``"even"``, or ``"cnossos"``: that of rolling noise by CNOSSOS-EU, scaled so that the power stays what
        it is. By the standard, which scales nothing, a source is as loud opposite as an even one. Or
        ``"dipole"``: a rail radiates 3 cos²θ, θ from the direction of its motion, in the mean over all
        directions as an even source.
    rail_distance : float
        Between both rails, m, each with half of the power; zero has both in the middle of the track.
    far_rail_screening : float
        What is lost of the sound of the farther rail, dB.
    receiver_offset : float
        What the receiver adds to the level, dB: 6 of a microphone flush in a large board.

    Raises
    ------
    InputError
        If the receiver is not beside the rails, or not above the ground.
    """

    band: Array
    receiver: Receiver
    ground: PorousGround | None = None
    ground_depth: float = 0.5
    directivity: str = cnossos.EVEN
    rail_distance: float = 0.0
    far_rail_screening: float = 0.0
    receiver_offset: float = 0.0

    def __post_init__(self) -> None:
        nearest = 0.5 * self.rail_distance
        away = f"{self.receiver.distance:g} m from the middle of the track"
        require(
            self.receiver.distance > nearest, "receiver", away, f"more than {nearest:g} m, beside both rails"
        )
        above = self.receiver.height + self.ground_depth
        require(
            self.ground is None or above >= 0.0, "receiver", f"{above:g} m above the ground", "zero or more"
        )

    def squared_pressure(self, source: AxleSource, passage: Passage, time: ArrayLike) -> Array:
        """Mean square sound pressure (..., b, t), Pa², of what all axles make radiate, at times (t,), s."""
        run = passage.speed * np.asarray(time, dtype=float)
        farthest = max(float(passage.axles[-1] - run.min()), float(run.max()))  # the same on either side
        grid = np.linspace(0.0, farthest, 2 * math.ceil(farthest / self.receiver.distance * STEPS) + 2)
        lengths = np.broadcast_to(np.asarray(source.length, dtype=float), len(self.band))
        places = [np.abs(run - at) for at in passage.axles]
        spread = [
            np.sum([np.interp(each, grid, one) for each in places], axis=0)
            for one in self.spread(source.height, lengths, grid, source.motion)
        ]
        return self._factor * np.asarray(source.power, dtype=float)[..., None] * np.stack(spread)

    def exposure(self, source: AxleSource, passage: Passage) -> Array:
        """Integral of the squared sound pressure over the whole passage (..., b), Pa² s.

        However far the power is spread along the rail; over hard ground W ρc Q/(4 d v) per axle.
        """
        share = len(passage.axles) / passage.speed * self.integral(source.height, source.motion)
        return self._factor * share * np.asarray(source.power, dtype=float)

    @property
    def _factor(self) -> float:
        """Of p² over W and what stands for 1/d², Pa s/m."""
        return _FACTOR * float(10.0 ** (0.1 * self.receiver_offset))

    def inverse_square(self, height: float, along: Array, motion: str = "all") -> Array:
        """What stands for 1/d² of a source above reflecting ground (b, n), 1/m².

        Of a source at a height above the rail head, m, that is (n,) m along the rail from the place opposite,
        with a motion as of `AxleSource`.
        """
        near, far = (self.receiver.distance + side * self.rail_distance for side in (-0.5, 0.5))
        found = self._from_rail(height, near, along, motion)
        if near == far:
            return found
        heard = 10.0 ** (-0.1 * self.far_rail_screening)
        return 0.5 * (found + heard * self._from_rail(height, far, along, motion))

    def _from_rail(self, height: float, lateral: float, along: Array, motion: str) -> Array:
        away = np.hypot(lateral, along)
        rise = self.receiver.height - height
        if self.ground is None:
            found = np.broadcast_to(1.0 / (away**2 + rise**2), (len(self.band), len(along)))
        else:
            heights = height + self.ground_depth, self.receiver.height + self.ground_depth
            found = self.ground.inverse_square(self.band, heights, away)
        if self.directivity == cnossos.DIPOLE:
            moved = {"vertical": rise, "lateral": lateral}.get(motion)  # along the direction of motion
            return found if moved is None else found * 3.0 * moved**2 / (away**2 + rise**2)
        if self.directivity == cnossos.EVEN:
            return found
        azimuth = np.arctan2(lateral, along)
        elevation = np.arctan2(rise, away)
        return found * _strength(azimuth, elevation, self.band) / _mean_strength(self.band)

    def spread(self, height: float, length: Array, along: Array, motion: str = "all") -> Array:
        """The same (b, n) of power that is spread as exp(−2|ξ|/ℓ)/ℓ along the rail around its middle.

        ℓ is (b,), m; places (n,), m, rise evenly from zero, opposite the receiver.
        """
        step = float(along[1] - along[0])
        reach = len(along) + np.ceil(4.0 * length / step).astype(int)  # beyond it exp(−8) is felt
        places = step * np.arange(reach.max())
        lateral = self.receiver.distance
        coarse = lateral * np.sinh(np.linspace(0.0, np.arcsinh(places[-1] / lateral), _PLACES))
        smooth = self.inverse_square(height, coarse, motion) * (lateral**2 + coarse**2)
        spread = []
        for one, ell, end in zip(smooth, length.tolist(), reach, strict=True):
            found = (np.interp(places, coarse, one) / (lateral**2 + places**2))[:end]
            if ell > 0.0:
                both = np.concatenate([found[:0:-1], found])  # from one side to the other
                ahead, behind = (time_weighted(each, step, 0.5 * ell) for each in (both, both[::-1]))
                found = 0.5 * (ahead + behind[::-1])[end - 1 :]
            spread.append(found[: len(along)])
        return np.stack(spread)

    def integral(self, height: float, motion: str = "all") -> Array:
        """Integral of `inverse_square` along the whole rail (b,), 1/m; over hard ground π/d."""
        angle = 0.5 * np.pi * (np.arange(_ANGLES) + 0.5) / _ANGLES
        lateral = self.receiver.distance
        found = self.inverse_square(height, lateral * np.tan(angle), motion) * lateral / np.cos(angle) ** 2
        return np.pi * found.mean(axis=-1)


def _strength(azimuth: Array, elevation: Array, band: Array) -> Array:
    """Factor of the intensity (b, n) by CNOSSOS-EU."""
    return energy_of(cnossos.directivity(azimuth, elevation, band[:, None]))


def _mean_strength(band: Array) -> Array:
    """Its mean over all directions above the ground (b, 1); all around a source sin²φ is ½ in the mean."""
    elevation, weight = gauss(64, 0.0, 0.5 * np.pi)
    around = _strength(np.array(0.25 * np.pi), elevation, band) * np.cos(elevation)
    return (around @ weight)[:, None]
