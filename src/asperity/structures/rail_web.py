"""A rail whose web bends: head and foot, each a beam that bends and twists, and a plate between them."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from asperity.arguments import Array, Complex, require
from asperity.structures.lateral_parameters import DENSITY, YOUNG, LateralParameters
from asperity.structures.periodic_rail import decaying
from asperity.written_numbers import rounded

POISSON = 0.3
MOTIONS = 4
"""Of a section: of the head sideways and its twist, then of the foot."""
_BENT = MOTIONS + np.arange(2)
"""Behind the motions: of head and foot, what bending moves without shear."""
_MOVED = np.array([0, 2])
_TWISTED = np.array([1, 3])


@dataclass(frozen=True, eq=False)
class Beams:
    """Head and foot, each a Timoshenko beam that twists about its own centroid; the head first.

    Parameters
    ----------
    mass : ndarray (2,)
        Per length, kg/m.
    rotary_inertia, polar_inertia : ndarray (2,)
        Per length, kg m.
    bending_stiffness, torsional_stiffness : ndarray (2,)
        N m².
    shear_stiffness : ndarray (2,)
        N.
    """

    mass: Array
    rotary_inertia: Array
    polar_inertia: Array
    bending_stiffness: Array
    torsional_stiffness: Array
    shear_stiffness: Array


@dataclass(frozen=True, eq=False)
class WebbedSection:
    """A rail's section whose web bends across it, clamped into head and foot.

    Parameters
    ----------
    beams : Beams
        Head and foot.
    heights : ndarray (6,)
        Above the centre of twist, m: bottom, centroid of the foot, lower and upper end of the web, centroid
        of the head, top.
    web_mass : float
        kg/m.
    web_stiffness : float
        Of the web as a plate that bends, N m: E t³/(12 (1 − ν²)).
    """

    beams: Beams
    heights: Array
    web_mass: float
    web_stiffness: float

    @property
    def web_height(self) -> float:
        """Of the web, m."""
        return float(self.heights[3] - self.heights[2])

    @cached_property
    def ends(self) -> Array:
        """Displacement and slope at the lower end of the web, then at the upper one, by motions (4, 4)."""
        _, foot, low, high, head, _ = self.heights
        return np.array(
            [
                [0.0, 0.0, 1.0, low - foot],
                [0.0, 0.0, 0.0, 1.0],
                [1.0, high - head, 0.0, 0.0],
                [0.0, 1.0, 0.0, 0.0],
            ]
        )

    @cached_property
    def bent_web(self) -> Array:
        """Stiffness per length of the web between the motions (4, 4): a strip of plate without load."""
        h = self.web_height
        strip = np.array(
            [
                [12.0, 6.0 * h, -12.0, 6.0 * h],
                [6.0 * h, 4.0 * h**2, -6.0 * h, 2.0 * h**2],
                [-12.0, -6.0 * h, 12.0, -6.0 * h],
                [6.0 * h, 2.0 * h**2, -6.0 * h, 4.0 * h**2],
            ]
        )
        return self.web_stiffness / h**3 * self.ends.T @ strip @ self.ends

    @cached_property
    def web_squares(self) -> Array:
        """Mean over the web of its displacement squared, by motions (4, 4), of the shape that it takes."""
        h = self.web_height
        strip = np.array(
            [
                [156.0, 22.0 * h, 54.0, -13.0 * h],
                [22.0 * h, 4.0 * h**2, 13.0 * h, -3.0 * h**2],
                [54.0, 13.0 * h, 156.0, -22.0 * h],
                [-13.0 * h, -3.0 * h**2, -22.0 * h, 4.0 * h**2],
            ]
        )
        return self.ends.T @ strip @ self.ends / 420.0

    @cached_property
    def mass(self) -> Array:
        """Mass per length between the motions (4, 4): of head, foot and web."""
        own = np.zeros(MOTIONS)
        own[_MOVED] = self.beams.mass
        own[_TWISTED] = self.beams.polar_inertia
        return np.diag(own) + self.web_mass * self.web_squares

    @property
    def top(self) -> Array:
        """Displacement of the top of the head by motions (4,)."""
        return np.array([1.0, self.heights[5] - self.heights[4], 0.0, 0.0])

    @property
    def bottom(self) -> Array:
        """Displacement of the bottom of the foot by motions (4,)."""
        return np.array([0.0, 0.0, 1.0, self.heights[0] - self.heights[1]])

    @property
    def squares(self) -> Array:
        """Mean over the whole height of the displacement squared, by motions (4, 4)."""
        bottom, foot, low, high, head, top = self.heights
        found = (high - low) * self.web_squares
        for first, (start, end) in ((0, (high - head, top - head)), (2, (bottom - foot, low - foot))):
            lengths = np.array([end - start, (end**2 - start**2) / 2.0, (end**3 - start**3) / 3.0])
            own = slice(first, first + 2)
            found[own, own] += lengths[[[0, 1], [1, 2]]]
        return found / (top - bottom)


def section_of(rail: LateralParameters) -> WebbedSection:
    """Section of a rail whose web bends, with the sums and moments of the whole rail.

    Masses of head and foot follow from the mass of the rail and its centroid. What bending stiffness and
    rotary inertia each has makes the rail twist about its centre of twist; they shear by their masses. Of the
    polar inertia what is left has first what their rotary inertias are, then what their depths tell.

    Raises
    ------
    InputError
        If heights do not follow each other, the rail has no shear, or nothing is left for head or foot.
    """
    thickness = rail.web
    assert thickness is not None
    web = np.array([-rail.web_depth, rail.web_height - rail.web_depth])
    heights = np.array([-rail.foot_depth, -rail.foot_centroid, *web, rail.head_centroid, rail.head_height])
    told = ", ".join(f"{1e3 * each:.4g}" for each in heights)
    require(
        bool((np.diff(heights) > 0.0).all()),
        "rail whose web bends",
        f"heights above the centre of twist of {told} mm",
        "such that rise: bottom, centroid of the foot, web's lower and upper end, centroid of the head, top",
    )
    finite = "a shear_stiffness that is finite"
    require(bool(np.isfinite(rail.shear_stiffness)), "rail whose web bends", "one without shear", finite)
    web_mass = DENSITY * thickness * rail.web_height
    places = heights[[4, 1]]
    masses = _masses(rail, web_mass, web, places)
    of_foot = places[0] / (places[0] - places[1])
    shares = np.array([1.0 - of_foot, of_foot])
    twists = np.array([1.0 - rail.foot_torsion_share, rail.foot_torsion_share])
    beams = Beams(
        masses,
        shares * rail.rotary_inertia,
        _polar_inertias(rail, web_mass, heights, masses, shares * rail.rotary_inertia),
        shares * rail.bending_stiffness,
        twists * rail.torsional_stiffness,
        masses / masses.sum() * rail.shear_stiffness,
    )
    return WebbedSection(beams, heights, web_mass, YOUNG * thickness**3 / 12.0 / (1.0 - POISSON**2))


def _masses(rail: LateralParameters, web_mass: float, web: Array, places: Array) -> Array:
    """Of head and foot (2,), kg/m, whose centroids are at such places, that the rail's is where it is."""
    total = rail.track.mass_per_length
    rest = total - web_mass
    moment = total * rail.centroid_height - web_mass * web.mean()
    head, foot = places
    upper = (moment - foot * rest) / (head - foot)
    masses = np.array([upper, rest - upper])
    of_head, of_foot, of_web = (rounded(each) for each in (*masses, web_mass))
    received = f"a head of {of_head} and a foot of {of_foot} kg/m beside a web of {of_web} kg/m"
    remedy = "Do web_thickness, web_height and centroids belong to a rail of this mass?"
    require(bool((masses > 0.0).all()), "rail whose web bends", received, "masses above 0", remedy)
    return masses


def _polar_inertias(
    rail: LateralParameters, web_mass: float, heights: Array, masses: Array, rotary: Array
) -> Array:
    """Of head and foot (2,) about their own centroids, kg m: what that of the rail leaves."""
    bottom, foot, low, high, head, top = heights
    apart = np.array([head, foot]) - rail.centroid_height
    web = web_mass * ((0.5 * (high + low) - rail.centroid_height) ** 2 + (high - low) ** 2 / 12.0)
    left = rail.polar_inertia - masses @ apart**2 - web - rotary.sum()
    received = f"{rounded(left)} kg m of the polar inertia left for head and foot upright"
    remedy = "Are the centroids of head and foot too far apart, or is polar_inertia too small?"
    require(bool(left > 0.0), "rail whose web bends", received, "more than 0", remedy)
    upright = masses * np.array([top - high, low - bottom]) ** 2
    return rotary + left * upright / upright.sum()


def webbed_waves(
    section: WebbedSection, omega: Complex, losses: Complex, foundation: Complex | float = 0.0
) -> tuple[Complex, Complex, Complex]:
    """Six waves of the rail without supports: k (6, f), rad/m, shapes (4, 6, f), and their amplitudes (6, f).

    The answer of the motions to forces all along the rail, exp(−ikx), is D(q)⁻¹ with q = k². With what
    bending moves without shear, b, beside the motions v and θ of each beam,

        S q (v − b) − m' ω² v,  (EI q² + S q − ρI ω² q) b − S q v,  (GJ q − I ω²) θ,

    and between them the web, stiffness and mass. The rows of what bends have q as a factor: without it D is
    linear in q, and its six roots are eigenvalues. With D symmetric, each residue has one shape.
    """
    beams = section.beams
    size = MOTIONS + len(_BENT)
    square = omega**2
    lossy = np.broadcast_to(losses, square.shape)
    rest = np.zeros((len(square), size, size), dtype=complex)  # q⁰ of D
    rest[:, :MOTIONS, :MOTIONS] = (
        lossy[:, None, None] * section.bent_web - square[:, None, None] * section.mass
    )
    rest[:, :MOTIONS, :MOTIONS] += np.moveaxis(
        np.broadcast_to(foundation, (MOTIONS, MOTIONS, len(square))), -1, 0
    )
    slope = np.zeros_like(rest)  # q of D
    shear = lossy[:, None] * beams.shear_stiffness
    slope[:, _MOVED, _MOVED] = shear
    slope[:, _MOVED, _BENT] = slope[:, _BENT, _MOVED] = -shear
    slope[:, _BENT, _BENT] = shear - square[:, None] * beams.rotary_inertia
    slope[:, _TWISTED, _TWISTED] = lossy[:, None] * beams.torsional_stiffness
    curved = np.zeros_like(rest)  # q² of D
    curved[:, _BENT, _BENT] = lossy[:, None] * beams.bending_stiffness
    constant = rest.copy()
    linear = slope.copy()
    constant[:, _BENT] = slope[:, _BENT]
    linear[:, _BENT] = curved[:, _BENT]
    q, whole = np.linalg.eig(-np.linalg.solve(linear, constant))
    derived = slope[:, None] + 2.0 * q[..., None, None] * curved[:, None]
    scale = np.einsum("fai,fiab,fbi->fi", whole, derived, whole)
    k = decaying(q)
    shapes = np.moveaxis(whole[:, :MOTIONS], 0, -1)
    return k.T, shapes, (-0.5j / (k * scale)).T
