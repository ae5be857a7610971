"""Films of oil on rough raceways: which film parameter they have, and what they leave to asperities."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from asperity.arguments import Array
from asperity.case.ball_bearing import BearingUnderLoad
from asperity.contact.film import Film, asperity_share, combined_rms, regime
from asperity.errors import percent
from asperity.spectra import root_mean_square
from asperity.surfaces.raceway import Raceway
from asperity.written_numbers import rounded

PLACES = 4
"""Pieces of a raceway, as long and wide as the contact, on which asperities are pressed."""


@dataclass(frozen=True, eq=False)
class RacewayFilm:
    """A film in the contact of a ball or roller and a raceway under a load.

    Parameters
    ----------
    film : Film
        Between smooth bodies.
    load : float
        Heaviest static one of a ball or roller, N.
    surfaces : tuple of Raceway
        The raceway, and what rolls on it on its cells if that is not smooth.
    damping : float
        Of the contact, N s/m.
    """

    film: Film
    load: float
    surfaces: tuple[Raceway, ...]
    damping: float

    @cached_property
    def axes(self) -> tuple[float, float]:
        """Half axes of the contact, m."""
        return self.film.contact.semi_axes_under(self.load)

    @property
    def longest(self) -> float:
        """Longest wave that counts as roughness, m: the contact is as long along the path."""
        return 2.0 * self.axes[0]

    @cached_property
    def rms(self) -> float:
        """Rms height of both surfaces together within contacts, each from its mean there, m."""
        return combined_rms(*(rms_within(each, self.axes) for each in self.surfaces))

    @property
    def parameter(self) -> float:
        """Film parameter: least film over that rms; infinite of smooth surfaces."""
        return self.film.minimum(self.load) / self.rms if self.rms else math.inf

    @cached_property
    def share(self) -> float:
        """Share of the load that asperities carry, mean over places."""
        if not self.rms:
            return 0.0
        pieces = [pieces_within(each, self.axes) for each in self.surfaces]
        few = [each[:: max(1, len(each) // PLACES)][:PLACES] for each in pieces]
        together = [sum(alike) for alike in zip(*few, strict=False)]
        numbers = (
            self.surfaces[0].spacing,
            self.film.contact.modulus,
            self.film.central(self.load),
            self.film.mean_pressure(self.load),
        )
        return float(np.mean([asperity_share(np.asarray(each), *numbers) for each in together]))

    @property
    def regime(self) -> str:
        """What separates the surfaces."""
        return regime(self.parameter)

    @property
    def outside(self) -> list[str]:
        """What is outside of the solutions that its formula was fitted to."""
        return [*self.film.outside(self.load)]

    @property
    def in_words(self) -> str:
        """Its thickness, and what separates the surfaces."""
        central, least = (1e6 * each(self.load) for each in (self.film.central, self.film.minimum))
        told = f"{rounded(central)} µm in the middle, {rounded(least)} µm at least"
        if not self.rms:
            return f"{told}; both surfaces are smooth"
        carried = f"asperities carry {percent(self.share)}" if self.share else "asperities carry nothing"
        return (
            f"{told}; Λ {rounded(self.parameter)} over {rounded(1e9 * self.rms)} nm rms of both surfaces "
            f"below {rounded(1e3 * self.longest)} mm: {self.regime}, {carried}"
        )


def films_on(
    case: BearingUnderLoad, raceways: Sequence[Raceway], balls: Sequence[Raceway]
) -> list[RacewayFilm]:
    """Films on the inner and the outer raceway under the heaviest static loads; none without oil."""
    found = []
    loads = [load for _, load in case.contacts]
    for film, surface, load, damping in zip(case.films or (), raceways, loads, case.dampings, strict=False):
        rough = [surface]
        if balls and balls[0].heights.any():
            rough.append(balls[0].on_cells(surface.spacing, surface.heights.shape[1], forwards=True))
        found.append(RacewayFilm(film, load, tuple(rough), damping))
    return found


def pieces_within(surface: Raceway, axes: tuple[float, float]) -> Array:
    """Pieces (n, rows, lines) of a rough surface, as long and wide as a contact, each from its mean, m."""
    heights = surface.heights
    rows, lines = (
        min(max(2, round(2.0 * axis / step)), count)
        for axis, step, count in zip(axes, surface.spacing, heights.shape, strict=True)
    )
    first = (heights.shape[1] - lines) // 2
    count = len(heights) // rows
    cut = heights[: count * rows, first : first + lines].reshape(count, rows, lines)
    return cut - cut.mean(axis=(1, 2), keepdims=True)


def rms_within(surface: Raceway, axes: tuple[float, float]) -> float:
    """Rms height of a surface within contacts of half axes, m, each from its mean there; m."""
    return root_mean_square(pieces_within(surface, axes))
