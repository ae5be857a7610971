"""A film of oil between bodies that roll on each other: how thick, stiff and damped it is."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from asperity.arguments import Array, ArrayLike, one_of, positive
from asperity.contact.halfspace import HalfSpace
from asperity.contact.hertz import Hertz
from asperity.contact.slices import SlicedContact
from asperity.written_numbers import rounded


class Fit(NamedTuple):
    """A film thickness over the radius along the path: c U^a G^b W^d (1 − s exp(−r k))."""

    coefficient: float
    speed: float
    material: float
    load: float
    leaking: float = 0.0  # s, what leaves to the sides of a circular contact
    narrow: float = 0.0  # r, how fast that ends as contacts widen

    def thickness(self, groups: "Groups") -> float:
        """Film thickness over the radius along the path."""
        kept = 1.0
        if self.leaking:
            kept -= self.leaking * math.exp(-self.narrow * groups.ellipticity)
        shared = groups.speed**self.speed * groups.material**self.material * groups.load**self.load
        return self.coefficient * shared * kept


class Groups(NamedTuple):
    """Numbers on which a film depends."""

    speed: float  # U = η₀ u/(E' R)
    material: float  # G = α E'
    load: float  # W = F/(E' R²) of a point, F/(E' R L) of a line
    ellipticity: float = math.inf  # k, the axis of the contact across the path over that along it


class Formula(NamedTuple):
    """A formula of films, by the number of which it is known how far it goes."""

    name: str
    source: str
    central: Fit  # film in the middle
    minimum: Fit  # least film
    fitted_to: str  # solutions, in words
    fitted: Mapping[str, tuple[float, float]]  # least and largest of their numbers
    beyond: tuple[str, str]  # what is known of the formula beyond them, and in general


ELLIPSES = Formula(
    "Hamrock and Dowson",
    "B. J. Hamrock and D. Dowson, J. Lubrication Technology 99 (1977) 264 (films of elliptic contacts).",
    Fit(2.69, 0.67, 0.53, -0.067, 0.61, 0.73),  # 1.90 of a circular contact
    Fit(3.63, 0.68, 0.49, -0.073, 1.0, 0.68),
    "the 34 solutions of Hamrock and Dowson",
    {
        "speed": (8.4e-13, 5.1e-11), "material": (2310.0, 6785.0), "load": (1.1e-7, 1.3e-6),
        "ellipticity": (1.0, 8.0),
    },
    (
        "The film is that of the formula, continued; a later fit is 5 to 15 % above it.",
        "Measured films averaged 30 % above the formula (Koye and Winer 1981).",
    ),
)  # fmt: skip
WITHIN = "the numbers at which it is within a fifth of solutions of Reynolds' equation"
_of_lines = partial(
    Formula,
    fitted={"speed": (1e-12, 5e-11), "material": (2500.0, 5000.0), "load": (2e-5, 5e-4)},
)
LINES = {
    "pan": _of_lines(
        "Pan and Hamrock",
        "P. Pan and B. J. Hamrock, J. Tribology 111 (1989) 246 (films of line contacts).",
        Fit(2.922, 0.692, 0.470, -0.166),
        Fit(1.714, 0.694, 0.568, -0.128),
        fitted_to=WITHIN,
        beyond=(
            "The film is that of the formula, continued: solutions are up to a third thicker at G 7500, and "
            "up to twice as thick at W 1e-6.",
            "Ends of rollers, where the film is thinner, are not in it.",
        ),
    ),
    "dowson": _of_lines(
        "Dowson, Higginson and Toyoda",
        "D. Dowson and G. R. Higginson, Elasto-Hydrodynamic Lubrication (1977), and D. Dowson and S. Toyoda, "
        "5th Leeds-Lyon Symposium (1979) (least and central film of line contacts).",
        Fit(3.06, 0.69, 0.56, -0.10),
        Fit(2.65, 0.70, 0.54, -0.13),
        fitted_to=f"{WITHIN}, for an oil that is not compressed",
        beyond=(
            "The film is that of the formula, continued. In the middle it is 10 to 45 % too thick for an oil "
            "that is compressed, within these numbers, too.",
            "Ends of rollers, where the film is thinner, are not in it.",
        ),
    ),
}
SYMBOLS = {"speed": "U", "material": "G", "load": "W", "ellipticity": "k"}
FULL, BOUNDARY = 3.0, 1.0
"""Film parameters from which on a film separates the surfaces, and below which asperities carry: B. J.
Hamrock, S. R. Schmid and B. O. Jacobson, Fundamentals of Fluid Film Lubrication, 2nd ed. (2004)."""


@dataclass(frozen=True)
class Film:
    """Film of oil between smooth bodies in an elliptic contact, which roll.

    Parameters
    ----------
    contact : Hertz
        Of the bodies, x along the path.
    speed : float
        Mean of the speeds with which both surfaces run into the contact, m/s: that of rolling, without slip.
    viscosity : float
        η₀ of the oil at the inlet without pressure, Pa s.
    pressure_viscosity : float
        α, 1/Pa.
    reduction : float
        Share of the isothermal film that the heating of the inlet leaves, `inlet_heating`.

    Raises
    ------
    InputError
        If a number is not positive.

    Notes
    -----
    The inlet is full of oil: starvation, as of grease, is not in it. Film and bodies are in series: under a
    force F the bodies have come nearer by δ_H(F) − h(F). As h falls with F, though slowly, the contact is
    softer than without oil, and gives way as it is pressed faster: an edge of the contact that moves into the
    inlet with da/dt has the speed u + da/dt there, so that h grows by 0.67 h/u · da/dt. Against that the
    contact pushes with c = k · 0.67 h a/(2 δ u), which hardly changes with the load. Both hold for motion
    that is slow against the time 2a/u in which the oil passes through.

    Examples
    --------
    >>> from asperity.contact.film import Film
    >>> from asperity.contact.hertz import in_groove
    >>> film = Film(in_groove(115e9, 3.97e-3, 4.13e-3, 15.55e-3), 1.76, 0.0173, 18.5e-9)  # of a 6205
    >>> f"{film.central(60.0) * 1e6:.2f} µm, least {film.minimum(60.0) * 1e6:.2f} µm"
    '0.16 µm, least 0.13 µm'
    """

    contact: Hertz
    speed: float
    viscosity: float
    pressure_viscosity: float
    reduction: float = 1.0

    def __post_init__(self) -> None:
        for name in ("speed", "viscosity", "pressure_viscosity", "reduction"):
            positive(f"{name} of the film", getattr(self, name))

    @property
    def formula(self) -> Formula:
        """Formula of its thickness."""
        return ELLIPSES

    @property
    def radius(self) -> float:
        """Relative radius along the path, m."""
        return self.contact.radius_x

    def groups(self, force: float) -> Groups:
        """Numbers on which it depends under a force, N."""
        modulus = 2.0 * self.contact.modulus
        radius = self.radius
        return Groups(
            self.viscosity * self.speed / (modulus * radius),
            self.pressure_viscosity * modulus,
            positive("force (N)", force) / (modulus * radius**2),
            1.03 * (self.contact.radius_y / radius) ** 0.64,
        )

    def central(self, force: float) -> float:
        """Film thickness in the middle of the contact under a force, N; m."""
        return self.reduction * self.radius * self.formula.central.thickness(self.groups(force))

    def minimum(self, force: float) -> float:
        """Least film thickness of the contact under a force, N; m: at its sides, of a line at its outlet."""
        return self.reduction * self.radius * self.formula.minimum.thickness(self.groups(force))

    def stiffness(self, force: float) -> float:
        """dF/dδ, N/m, of bodies and film in series under a force, N: 1/k = 1/k_H − dh/dF."""
        bodies = self.contact.stiffness_under(force)
        return 1.0 / (1.0 / bodies - self.formula.central.load * self.central(force) / force)

    def damping(self, force: float) -> float:
        """Damping of the contact under a force, N, by the film that its edge draws in; N s/m."""
        # dh over the speed of the edge, s
        drawn = self.formula.central.speed * self.central(force) / self.speed
        return self.stiffness(force) * drawn * self.widening(force)

    def widening(self, force: float) -> float:
        """How fast the half axis along the path grows with the approach under a force, N: da/dδ."""
        approach = self.contact.approach(force)
        return 0.5 * self.contact.semi_axes(approach)[0] / approach

    def mean_pressure(self, force: float) -> float:
        """Mean pressure of the contact under a force, N; Pa."""
        along, across = self.contact.semi_axes_under(force)
        return force / (math.pi * along * across)

    def of_bodies(self, approach: ArrayLike) -> Array:
        """Forces of the bodies without a film at approaches (n,), m; N."""
        closed = np.maximum(np.asarray(approach, dtype=float), 0.0)
        return np.asarray(self.contact.stiffness_constant * closed**1.5)

    def outside(self, force: float) -> Iterator[str]:
        """What of it is outside the solutions that its formula was fitted to, under a force, N: in words."""
        groups = self.groups(force)
        for name, (least, most) in self.formula.fitted.items():
            value = getattr(groups, name)
            if not least <= value <= most:
                yield f"{SYMBOLS[name]} {rounded(value)} ({rounded(least)} to {rounded(most)})"


@dataclass(frozen=True)
class LineFilm(Film):
    """Film of oil between a roller and its raceway, smooth, which roll.

    Parameters
    ----------
    contact : SlicedContact
        Of the roller.
    speed, viscosity, pressure_viscosity, reduction : float
        As in `Film`.
    fit : {"pan", "dowson"}
        Formula, as in `LINES`.

    Raises
    ------
    InputError
        If a number is not positive, or the fit unknown.

    Notes
    -----
    The film is that under the mean load per length of the roller, F/L: where a crowned roller presses more it
    is thinner, by 5 to 10 per cent. The edge of the contact is that of Hertz under the same,
    b = √(4FR/πE*L). Its damping c = k · 0.692 h/u · b k_H/(2F) falls with the load, about as its root.

    Examples
    --------
    >>> from asperity import Crowning, SlicedContact
    >>> from asperity.contact.film import LineFilm
    >>> roller = SlicedContact(113.7e9, 3.03e-3, Crowning.iso(length=7.8e-3, diameter=7.5e-3))
    >>> film = LineFilm(roller, 1.77, 0.0173, 18.5e-9)  # of a bearing NU 205 on its inner ring
    >>> f"{film.central(800.0) * 1e6:.2f} µm, least {film.minimum(800.0) * 1e6:.2f} µm"
    '0.13 µm, least 0.12 µm'
    """

    contact: Any
    fit: str = "pan"

    def __post_init__(self) -> None:
        super().__post_init__()
        one_of("fit of the film", self.fit, LINES)

    @property
    def formula(self) -> Formula:
        """Formula of its thickness."""
        return LINES[self.fit]

    @property
    def radius(self) -> float:
        """Relative radius along the path, m."""
        return float(self.contact.radius)

    def groups(self, force: float) -> Groups:
        """Numbers on which it depends under a force, N."""
        modulus = 2.0 * self.contact.modulus
        radius = self.radius
        return Groups(
            self.viscosity * self.speed / (modulus * radius),
            self.pressure_viscosity * modulus,
            positive("force (N)", force) / (self.contact.length * modulus * radius),
        )

    def widening(self, force: float) -> float:
        """How fast the half width grows with the approach under a force, N: db/dδ."""
        per_length = force / (math.pi * self.contact.modulus * self.contact.length)
        half_width = 2.0 * math.sqrt(per_length * self.radius)
        return 0.5 * half_width * self.contact.stiffness_under(force) / force

    def mean_pressure(self, force: float) -> float:
        """Mean pressure of the contact under a force, N; Pa."""
        along, across = self.contact.semi_axes_under(force)
        return force / (4.0 * along * across)

    def of_bodies(self, approach: ArrayLike) -> Array:
        """Forces of the bodies without a film at approaches (n,), m; N."""
        return np.asarray(self.contact.pressed(approach).force)


def inlet_heating(
    viscosity: float, thinning: float, speed: float, conductivity: float, sliding: float = 0.0
) -> float:
    """Share of the isothermal film that is left where shear heats the oil in the inlet.

    Parameters
    ----------
    viscosity : float
        η₀, Pa s.
    thinning : float
        β = −d ln η/dT, 1/K, `asperity.contact.oil.Oil.thinning`.
    speed : float
        Mean of both surfaces, m/s.
    conductivity : float
        Of the oil, W/(m K).
    sliding : float
        Difference of the speeds of both surfaces over their sum; 0 of pure rolling.

    Returns
    -------
    float
        (1 + 0.241 (1 + 14.8 Z^0.83) L^0.64)⁻¹, L = η₀ β u²/k.

    Notes
    -----
    W. R. D. Wilson and S. Sheu, J. Lubrication Technology 105 (1983) 187.
    """
    heated = viscosity * thinning * speed**2 / conductivity
    return 1.0 / (1.0 + 0.241 * (1.0 + 14.8 * abs(sliding) ** 0.83) * heated**0.64)


def squeeze_force(contact: Hertz | SlicedContact, viscosity: float, gap: float, speed: float) -> float:
    """Force of oil between rigid bodies that come nearer without rolling, N, at a gap, m, and a speed, m/s.

    12 π η V √(R_x R_y)/(h (1/R_x + 1/R_y)), the closed form of Reynolds' equation for the gap
    h + x²/2R_x + y²/2R_y: of a ball on a plane 6 π η V R²/h. Of a cylinder 3√2 π η V L (R/h)^1.5, as if it
    had no ends and no crowning.
    """
    positive("gap (m)", gap)
    if isinstance(contact, SlicedContact):
        over_gap = (contact.radius / gap) ** 1.5
        return 3.0 * math.sqrt(2.0) * math.pi * viscosity * speed * contact.length * over_gap
    mean = math.sqrt(contact.radius_x * contact.radius_y)
    opening = 1.0 / contact.radius_x + 1.0 / contact.radius_y
    return 12.0 * math.pi * viscosity * speed * mean / (gap * opening)


def regime(parameter: float) -> str:
    """Say by the film parameter Λ, least film over combined rms roughness, what separates the surfaces."""
    if parameter >= FULL:
        return "full film"
    return "boundary" if parameter < BOUNDARY else "mixed"


def asperity_share(
    heights: Array, spacing: tuple[float, float], modulus: float, film: float, pressure: float
) -> float:
    """Share of the load that asperities carry where a film keeps the mean planes of the surfaces apart.

    Parameters
    ----------
    heights : ndarray (nx, ny)
        Combined roughness of both surfaces within the contact, m.
    spacing : (float, float)
        Distances of its points, m.
    modulus : float
        Contact modulus E*, Pa.
    film : float
        Distance of the mean planes: the central film, m.
    pressure : float
        Mean pressure of the contact, Pa, which film and asperities carry together.

    Returns
    -------
    float
        Mean pressure of elastic asperities over that of the contact, at most 1.

    Notes
    -----
    The rough contact is solved on one period of the surface, whose mean planes stay as far apart as the film
    keeps them: bodies have been deformed already, by what film and asperities carry together. The oil
    between asperities is as thick there as between smooth surfaces.
    """
    positive("film (m)", film)
    above = heights - heights.mean()
    if above.max() <= film:
        return 0.0
    half_space = HalfSpace((heights.shape[0], heights.shape[1]), spacing, modulus, boundary="periodic")
    solved = half_space.solve(film - above, approach=0.0, rtol=1e-4)
    return min(solved.force / (above.size * half_space.cell_area * pressure), 1.0)


def combined_rms(*rms: float) -> float:
    """Rms of the sum of heights that have nothing to do with each other, from the rms of each."""
    return float(np.sqrt(np.sum(np.square(rms))))
