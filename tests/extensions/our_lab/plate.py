"""A simply supported plate that is rolled over along a line: a structure by its modes."""

from dataclasses import dataclass

import numpy as np

from asperity.case.rolled_over import RolledOver, sensors_along
from asperity.parameters import LENGTH, MaterialOrName, Number, key
from asperity.reference.materials import Material

MODES_BEYOND = 4.0
"""Modes are kept up to this multiple of the highest frequency."""


@dataclass(frozen=True)
class ThinPlate:
    """A thin plate on simple supports all around, as it is seen along a line across it."""

    length: float  # m, along the path
    width: float  # m
    thickness: float  # m
    place: float  # m, of the path from one side
    material: Material
    damping_ratio: float
    highest: float  # Hz

    @property
    def extent(self):
        """Where it begins and ends, m."""
        return 0.0, self.length

    @property
    def _modes(self):
        """Half waves along and across of all modes (m,), and their natural frequencies, Hz, rising."""
        of, h = self.material, self.thickness
        stiffness = of.youngs_modulus * h**3 / (12.0 * (1.0 - of.poisson_ratio**2))
        scale = 0.5 * np.pi * np.sqrt(stiffness / (of.density * h))
        most = [int(np.sqrt(self.highest / scale) * side) + 1 for side in (self.length, self.width)]
        along, across = (each.ravel() for each in np.mgrid[1 : most[0] + 1, 1 : most[1] + 1])
        frequency = scale * ((along / self.length) ** 2 + (across / self.width) ** 2)
        kept = np.argsort(frequency)[: max(1, np.count_nonzero(frequency <= self.highest))]
        return along[kept], across[kept], frequency[kept]

    @property
    def natural_frequencies(self):
        """Of all modes (m,), Hz."""
        return self._modes[2]

    @property
    def damping_ratios(self):
        """Of all modes (m,)."""
        return np.full(len(self.natural_frequencies), self.damping_ratio)

    def shapes(self, x):
        """Mass-normalised shapes and their slopes (n, m) at places (n,), m."""
        along, across, _ = self._modes
        mass = self.material.density * self.length * self.width * self.thickness
        wave = np.pi * along / self.length
        height = 2.0 / np.sqrt(mass) * np.sin(np.pi * across * self.place / self.width)
        phase = np.multiply.outer(np.asarray(x), wave)
        return height * np.sin(phase), height * wave * np.cos(phase)

    def shapes_along(self, start, spacing, count):
        """The same at equally spaced places."""
        return self.shapes(start + spacing * np.arange(count))


class Plate(RolledOver):
    """A rectangular plate on simple supports all around."""

    length: float = key(LENGTH, "1 m", "length, along the path", "10 mm to 100 m: plates lie between")
    width: float = key(LENGTH, "0.6 m", "width", "10 mm to 100 m: plates lie between")
    thickness: float = key(LENGTH, "10 mm", "thickness", "10 um to 1 m: plates lie between")
    place: float = key(LENGTH, "0.3 m", "place of the path from one side", "1 mm to 100 m: on the plate")
    loss_factor: float = key(Number(at_least=0, at_most=0.5), 0.01, "loss factor of every mode")
    material: Material = key(MaterialOrName(), "steel", "material")
    sensors: tuple[float, ...] | None = sensors_along()

    @property
    def extent(self):
        """Where it begins and ends, m."""
        return 0.0, self.length

    def model(self, highest_frequency):
        """Build it."""
        sides = self.length, self.width, self.thickness, self.place
        return ThinPlate(*sides, self.material, 0.5 * self.loss_factor, MODES_BEYOND * highest_frequency)

    def problems(self):
        """Sensors on the plate."""
        yield from self.problems_of_sensors(*self.extent)
