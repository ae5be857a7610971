"""Modes of a wheel as its contact and the air around it feel them: from its section, at rest or turning."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from asperity.arguments import (
    Array,
    ArrayLike,
    Flags,
    Integers,
    finite_array,
    positive,
    real,
    require,
)
from asperity.errors import InputError
from asperity.reference.materials import Material
from asperity.store import Store, content_key, made
from asperity.structures.outline import Mesh, checked_outline, mesh_of
from asperity.text_files import write_csv
from asperity.threads import one_thread_in_linear_algebra

# Radon's rule of seven points in a triangle, exact to the fifth degree
_ROOT = np.sqrt(15.0)
_NEAR = (6.0 - _ROOT) / 21.0
_FAR = (6.0 + _ROOT) / 21.0
_AT = np.array(
    [[1 / 3, 1 / 3, 1 / 3]]
    + [[*np.roll([1.0 - 2.0 * a, a, a], turn)] for a in (_NEAR, _FAR) for turn in range(3)]
)
_WEIGHT = np.array([9 / 40] + [(155.0 - _ROOT) / 1200.0] * 3 + [(155.0 + _ROOT) / 1200.0] * 3)
FIRST_MODES = 8
"""Modes that are sought at first."""
SHIFT = 0.1
"""Of the highest frequency: about where the inverse iteration is quickest."""


def _shapes() -> tuple[Array, Array]:
    """Quadratic functions at the seven points (7, 6), and derivatives by the areal coordinates (7, 6, 3)."""
    a = _AT
    one = np.eye(3)
    pairs = ((0, 1), (1, 2), (2, 0))
    values = np.hstack([a * (2.0 * a - 1.0), np.stack([4.0 * a[:, i] * a[:, j] for i, j in pairs], axis=1)])
    corners = (4.0 * a - 1.0)[:, :, None] * one
    sides = [4.0 * (a[:, [i]] * one[j] + a[:, [j]] * one[i]) for i, j in pairs]
    return values, np.concatenate([corners, np.stack(sides, axis=1)], axis=1)


def matrices(mesh: Mesh, n: int, material: Material) -> tuple[Any, Any]:
    """Stiffness and mass, sparse (3k, 3k), of n nodal diameters; u_r, u_θ and u_z of node after node."""
    from scipy.sparse import coo_array

    values, slopes = _shapes()
    corners = mesh.nodes[mesh.triangles[:, :3]]
    sides = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)  # opposite to each corner
    area = 0.5 * (sides[:, 1, 1] * sides[:, 0, 0] - sides[:, 1, 0] * sides[:, 0, 1])
    areal = np.stack([-sides[..., 1], sides[..., 0]], axis=-1) / (2.0 * area)[:, None, None]  # (e, 3, 2)
    fr, fz = np.moveaxis(np.einsum("qsa,eac->eqsc", slopes, areal), -1, 0)
    r = np.einsum("qa,ea->eq", _AT, corners[..., 0])[..., None]
    f = np.broadcast_to(values, fr.shape)
    strain = np.zeros((*fr.shape[:2], 6, 18))  # rr, θθ, zz, rz, rθ, θz
    strain[:, :, 0, 0::3] = fr
    strain[:, :, 2, 2::3] = fz
    strain[:, :, 1, 0::3] = f / r
    strain[:, :, 1, 1::3] = n * f / r
    strain[:, :, 3, 0::3] = fz
    strain[:, :, 3, 2::3] = fr
    strain[:, :, 4, 0::3] = -n * f / r
    strain[:, :, 4, 1::3] = fr - f / r
    strain[:, :, 5, 1::3] = fz
    strain[:, :, 5, 2::3] = -n * f / r
    around = 2.0 * np.pi if n == 0 else np.pi
    weight = around * _WEIGHT * area[:, None] * r[..., 0]
    stress = np.einsum("ij,eqjb->eqib", _elasticity(material), strain) * weight[..., None, None]
    stiffness = strain.reshape(len(area), -1, 18).transpose(0, 2, 1) @ stress.reshape(len(area), -1, 18)
    product = np.einsum("eq,qa,qb->eab", material.density * weight, values, values, optimize=True)
    mass = np.einsum("eab,ij->eaibj", product, np.eye(3)).reshape(-1, 18, 18)
    unknown = (3 * mesh.triangles[:, :, None] + np.arange(3)).reshape(len(area), 18)
    where = np.repeat(unknown, 18, axis=1).ravel(), np.tile(unknown, (1, 18)).ravel()
    shape = (3 * len(mesh.nodes),) * 2
    found = [coo_array((each.ravel(), where), shape).tocsc() for each in (stiffness, mass)]
    found[1].eliminate_zeros()  # directions do not couple
    return found[0], found[1]


def _elasticity(material: Material) -> Array:
    """Hooke's law of the six strains (6, 6), Pa."""
    nu = material.poisson_ratio
    scale = material.youngs_modulus / ((1.0 + nu) * (1.0 - 2.0 * nu))
    law = np.zeros((6, 6))
    law[:3, :3] = scale * (nu + (1.0 - 2.0 * nu) * np.eye(3))
    law[3:, 3:] = scale * (0.5 - nu) * np.eye(3)
    return law


def natural_modes(mesh: Mesh, n: int, material: Material, highest: float, held: Flags) -> tuple[Array, Array]:
    """Natural frequencies up to the highest (p,), Hz, and mass-normalised shapes (p, k, 3), kg^(−1/2).

    `held` (k, 3) are the displacements that are zero. Of n = 0 torsion is left out: no radial or axial force
    excites it.
    """
    from scipy.sparse.linalg import LinearOperator, eigsh, splu

    stiffness, mass = matrices(mesh, n, material)
    fixed = held.copy()
    if n == 0:
        fixed[:, 1] = True
    free = np.flatnonzero(~fixed.ravel())
    stiffness = stiffness[free][:, free]
    mass = mass[free][:, free]
    start = np.random.default_rng(0).standard_normal(len(free))
    count = FIRST_MODES
    shift = -((2.0 * np.pi * SHIFT * highest) ** 2)
    # positive definite: no pivots are sought, and half as much is filled in
    how: Any = {"permc_spec": "MMD_AT_PLUS_A", "diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}
    factors = splu((stiffness - shift * mass).tocsc(), **how)
    inverse = LinearOperator(stiffness.shape, matvec=factors.solve, dtype=np.float64)
    while True:
        count = min(count, len(free) - 1)
        squares, found = eigsh(stiffness, count, mass, sigma=shift, v0=start, OPinv=inverse)
        if squares.max() > (2.0 * np.pi * highest) ** 2 or count == len(free) - 1:
            break
        count *= 2
    order = np.argsort(squares)
    frequency = np.sqrt(np.maximum(squares[order], 0.0)) / (2.0 * np.pi)
    below = order[frequency <= highest]
    shapes = np.zeros((len(below), 3 * len(mesh.nodes)))
    shapes[:, free] = found[:, below].T
    return frequency[: len(below)], shapes.reshape(len(below), len(mesh.nodes), 3)


HEADING = (
    "frequency (Hz)",
    "damping ratio",
    "modal mass (kg)",
    "nodal diameters",
    "axial velocity over the disc",
    "radial velocity of the tread",
)
"""Of a table of modes in a file."""
FORMAT = 2
"""Of modes that are kept: raise it where their computation changes."""
BEYOND = 1.25
"""Modes are sought up to this multiple of the highest frequency of the spectra."""
HIGHEST = 12.5e3
"""And not beyond this frequency, Hz: modes get dense as its square, and nothing is heard of them."""
DAMPING = (1e-3, 1e-2, 1e-4)
"""Damping ratios of 0, 1, and 2 and more nodal diameters, as usual in the literature on railway wheels."""
MOST_DIAMETERS = 40
TREAD_DEPTH = 0.010
"""By which the radius of the tread may differ from that at the running circle, m: not the flange."""
ROUNDED = 1e-6
"""Depth, m, by which a point at the edge of the tread may be off as its place is rounded."""
HIGHEST_FLANGE = 0.060
"""By which a flange stands out of the tread at most, m: they have 25 mm to 40 mm."""
SEAT = 1e-3
"""By which radii of the seat on the axle may differ, m."""
SILENT = 1e-4
"""Share of its largest motion on the tread below which a mode does not answer to a force."""


@dataclass(frozen=True, eq=False)
class WheelModes:
    """Modes of a wheel beside its rigid motion, mass-normalised, by a force at the bottom of its tread.

    Parameters
    ----------
    natural_frequencies : ndarray (p,)
        Undamped, Hz.
    damping_ratios : ndarray (p,)
        ζ, share of critical damping.
    nodal_diameters : ndarray (p,) of int
        n.
    places : ndarray (k,)
        Across the tread, rising, m from the running circle, positive away from the flange.
    radial, axial : ndarray (p, k)
        Displacement there where the force acts, outwards and away from the flange, kg^(−1/2).
    disc : ndarray (p,)
        Root mean square of the axial velocity over both sides of a disc of the wheel's radius, per modal
        velocity, kg^(−1/2).
    tread : ndarray (p,)
        The same of the radial velocity over the tread.

    Notes
    -----
    The modal answer to a radial force F_r and an axial one F_a at one place is
    ``q = (radial F_r + axial F_a) / (ω₀² − ω² + 2iζω₀ω)``, and the displacements there are ``radial q`` and
    ``axial q``: receptances are reciprocal.
    """

    natural_frequencies: Array
    damping_ratios: Array
    nodal_diameters: Integers
    places: Array
    radial: Array
    axial: Array
    disc: Array
    tread: Array

    @classmethod
    def from_table(cls, table: ArrayLike) -> "WheelModes":
        """Modes by the table that `table` makes (p, 6): radial ones, in the middle of the tread alone."""
        frequency, ratio, mass, diameters, disc, tread = np.asarray(table, dtype=float).T
        shape = mass**-0.5
        none = np.zeros((len(mass), 1))
        number = diameters.astype(np.int64)
        place = np.zeros(1)
        return cls(frequency, ratio, number, place, shape[:, None], none, disc * shape, tread * shape)

    def at(self, place: float = 0.0) -> tuple[Array, Array]:
        """Radial and axial displacement (p,) each, kg^(−1/2), at a place, m from the running circle.

        Of modes by a table those that it holds, wherever the contact is.

        Raises
        ------
        InputError
            If the place is off the tread.
        """
        if len(self.places) == 1:
            return self.radial[:, 0], self.axial[:, 0]
        low = float(self.places[0])
        high = float(self.places[-1])
        allowed = f"{low * 1e3:.4g} mm to {high * 1e3:.4g} mm, the tread"
        where = real("place of the contact (m)", place, allowed, at_least=low, at_most=high)
        right = int(np.clip(np.searchsorted(self.places, where), 1, len(self.places) - 1))
        share = (where - self.places[right - 1]) / (self.places[right] - self.places[right - 1])
        both = [
            (1.0 - share) * each[:, right - 1] + share * each[:, right] for each in (self.radial, self.axial)
        ]
        return both[0], both[1]

    def heard(self, place: float = 0.0) -> Flags:
        """Whether each mode (p,) answers to a radial force at a place, m."""
        largest = np.maximum(np.abs(self.radial).max(axis=1), np.abs(self.axial).max(axis=1))
        return np.abs(self.at(place)[0]) > SILENT * largest

    def table(self, place: float = 0.0) -> Array:
        """Table of modes as `wheel.modes` of a case takes it (s, 6), of a contact at a place, m.

        Frequency, Hz, damping ratio, modal mass, kg, number of nodal diameters, and rms axial velocity of the
        disc and rms radial velocity of the tread, both per radial velocity at the contact. Modes that do not
        answer radially there are left out.
        """
        heard = self.heard(place)
        shape = np.abs(self.at(place)[0])[heard]
        columns = (self.natural_frequencies[heard], self.damping_ratios[heard], shape**-2.0)
        numbers = (self.nodal_diameters[heard], self.disc[heard] / shape, self.tread[heard] / shape)
        return np.column_stack([*columns, *numbers])

    def write(self, path: str | Path, place: float = 0.0) -> Path:
        """Write `table` to a CSV file, to the last bit, as `wheel.modes` of a case reads it."""
        rows = self.table(place).tolist()
        return write_csv(Path(path), HEADING, [[*row[:3], int(row[3]), *row[4:]] for row in rows])

    def damped(self, ratios: Sequence[float], added: float = 0.0) -> "WheelModes":
        """With damping ratios of 0, 1 and so on nodal diameters, the last of all beyond.

        Wheel dampers add a ratio to modes of two and more nodal diameters.
        """
        given = finite_array(
            "damping ratios", ratios, "above 0, below 1", shape=(None,), above=0.0, below=1.0
        )
        own = given[np.minimum(self.nodal_diameters, len(given) - 1)]
        own = own + np.where(self.nodal_diameters >= 2, added, 0.0)
        if (own >= 1.0).any():
            raise InputError("damping ratio with dampers", f"{own.max():.4g}", "below 1")
        return replace(self, damping_ratios=own)

    def turning(self, angular_speed: float) -> "WheelModes":
        """Modes in the frame of the contact, over which the wheel turns, rad/s.

        A mode with n nodal diameters is two waves around the wheel, which the turning carries: its answer
        h(t) to an impulse becomes h(t) cos(nΩt), that of two modes of damped frequencies ω_d ± nΩ with the
        same decay and the modal masses 2mω_d/(ω_d ± nΩ). Each of them is a wave, which moves all of the
        circumference alike: its rms is √2 that of a standing one per displacement at the contact. Left out:
        centrifugal and Coriolis forces, of the order of Ω/ω_d.

        Raises
        ------
        InputError
            If the wheel turns faster than a wave runs around it.
        """
        split = self.nodal_diameters > 0
        part = np.repeat(np.arange(len(split)), np.where(split, 2, 1))
        sign = np.concatenate([[-1.0, 1.0] if two else [0.0] for two in split] or [[]])
        diameters = self.nodal_diameters[part]
        natural = 2.0 * np.pi * self.natural_frequencies[part]
        ratio = self.damping_ratios[part]
        decay = ratio * natural
        damped = natural * np.sqrt(1.0 - ratio**2)
        moved = damped + sign * diameters * angular_speed
        if (slow := moved <= 0.0).any():
            received = f"faster than a wave of a mode of {diameters[slow][0]} nodal diameters"
            raise InputError("turning of the wheel", received, "slower ones", "Roll more slowly.")
        undamped = np.hypot(moved, decay)
        scale = np.where(sign == 0.0, 1.0, np.sqrt(0.5 * moved / damped))
        wave = np.where(sign == 0.0, 1.0, np.sqrt(2.0)) * scale
        radial, axial = (scale[:, None] * each[part] for each in (self.radial, self.axial))
        disc, tread = (wave * each[part] for each in (self.disc, self.tread))
        natural = undamped / (2.0 * np.pi)
        return WheelModes(natural, decay / undamped, diameters, self.places, radial, axial, disc, tread)


def wheel_modes(
    outline: ArrayLike,
    material: Material,
    highest_frequency: float,
    *,
    size: float | None = None,
    cache: Store | None = None,
) -> WheelModes:
    """Modes of a wheel up to a frequency, Hz, held where it sits on its axle, by finite elements.

    Parameters
    ----------
    outline : array_like (n, 2)
        Its section: radius and axial place, m, the latter from the running circle, positive away from the
        flange. The points of smallest radius are the seat.
    material : Material
        Elastic, isotropic.
    highest_frequency : float
        Hz.
    size : float, optional
        Of the triangles, m.
    cache : Store, optional
        Keeps the modes.

    Returns
    -------
    WheelModes
        By frequency, with damping ratios of `DAMPING`; torsion of n = 0 left out.

    Raises
    ------
    InputError
        If the outline is none of a wheel.

    Examples
    --------
    >>> from asperity import WheelSection, material, wheel_modes
    >>> outline = WheelSection.named("straight-web", web_thickness=0.03).outline(0.46)
    >>> modes = wheel_modes(outline, material("steel"), 600.0)
    >>> modes.nodal_diameters.tolist()
    [1, 0, 2]
    """
    section = checked_outline(outline)
    highest = positive("highest frequency (Hz)", highest_frequency)
    section, circle = with_running_circle(section)

    def make() -> dict[str, Array]:
        with one_thread_in_linear_algebra():
            return _found(mesh_of(section, size, circle), section[circle, 0], material, highest)

    numbers = [material.youngs_modulus, material.poisson_ratio, material.density, highest, size]
    key = content_key("wheel-modes", FORMAT, section, numbers)
    found = made(cache, key, make)
    order = np.argsort(found["frequency"], kind="stable")
    names = ("radial", "axial", "disc", "tread")
    shapes = {name: found[name][order] for name in names}
    number = found["n"][order].astype(np.int64)
    none = np.zeros(len(order))
    return WheelModes(found["frequency"][order], none, number, found["places"], **shapes).damped(DAMPING)


def with_running_circle(outline: Array) -> tuple[Array, int]:
    """Outline with a point on the running circle, at the axial place 0 and the largest radius; its number."""
    r, z = outline.T
    r2, z2 = np.roll(outline, -1, axis=0).T
    over = np.flatnonzero((np.minimum(z, z2) <= 0.0) & (np.maximum(z, z2) >= 0.0) & (z != z2))
    if not len(over):
        received = f"axial places of {z.min() * 1e3:.4g} mm to {z.max() * 1e3:.4g} mm"
        allowed = "places on both sides of the running circle, at 0 mm"
        raise InputError("outline of the section", received, allowed, "Count them from there.")
    radius = r[over] - z[over] * (r2 - r)[over] / (z2 - z)[over]
    edge = int(over[np.argmax(radius)])
    largest = float(radius.max())
    top = int(np.argmax(r))
    if largest + TREAD_DEPTH < r[top] < largest + HIGHEST_FLANGE:
        inside = r[z < 0.0].max(initial=0.0)
        received = f"a flange at an axial place of {z[top] * 1e3:.4g} mm, up to {r[top] * 1e3:.4g} mm"
        allowed = "places positive away from the flange"
        both = inside > largest + TREAD_DEPTH
        require(z[top] < 0.0 or both, "outline of the section", received, allowed, "Change their sign.")
    for number in (edge, (edge + 1) % len(outline)):
        if abs(outline[number, 1]) < ROUNDED:
            return outline, number
    return np.insert(outline, edge + 1, (largest, 0.0), axis=0), edge + 1


def _found(mesh: Mesh, radius: float, material: Material, highest: float) -> dict[str, Array]:
    """Modes of all numbers of nodal diameters, one behind the other."""

    seat = mesh.nodes[:, 0] <= mesh.nodes[:, 0].min() + SEAT
    if seat.sum() < 3:  # an edge has three nodes
        received = "one point nearest to the axis"
        remedy = "Let an edge have the smallest radius."
        raise InputError("outline of the section", received, "a seat along the axis", remedy)
    tread, edges = _tread(mesh, radius)
    held = np.repeat(seat[:, None], 3, axis=1)
    parts: list[tuple[Array, ...]] = []
    for n in range(MOST_DIAMETERS + 1):
        frequency, shape = natural_modes(mesh, n, material, highest, held)
        if n > 1 and not len(frequency):
            break
        around = 1.0 if n == 0 else np.sqrt(0.5)
        disc = around * np.sqrt(_over_disc(mesh, shape[..., 2])) / radius
        rolled = around * np.sqrt(_mean_square(mesh, edges, shape[..., 0]))
        radial, axial = np.moveaxis(shape[:, tread, ::2], -1, 0)
        parts.append((frequency, np.full(len(frequency), float(n)), disc, rolled, radial, axial))
    columns = [np.concatenate(each) for each in zip(*parts, strict=True)]
    names = ("frequency", "n", "disc", "tread", "radial", "axial")
    return dict(zip(names, columns, strict=True)) | {"places": mesh.nodes[tread, 1]}


def _tread(mesh: Mesh, radius: float) -> tuple[Integers, Integers]:
    """Nodes of the tread by rising axial place, and its edges."""
    r, z = mesh.nodes.T
    first = mesh.edges[:, 0]
    last = mesh.edges[:, 2]
    outer = (z[last] > z[first]) & (np.abs(r[mesh.edges] - radius) <= TREAD_DEPTH + ROUNDED).all(axis=1)
    start = int(np.argmin(np.hypot(r[first] - radius, z[first])))
    count = len(outer)
    kept = []
    for step, at in ((1, start), (-1, start - 1)):
        while outer[at % count]:
            kept.append(at % count)
            at += step
    edges = mesh.edges[kept]
    nodes = np.unique(edges)
    return nodes[np.argsort(z[nodes])], edges


_SIMPSON = np.array([1.0, 4.0, 1.0]) / 6.0


def _over_disc(mesh: Mesh, axial: Array) -> Array:
    """Integral of the square of axial shapes (p, k) over both sides, per π: ∫ u² r |dr|, (p,)."""
    r = mesh.nodes[mesh.edges, 0]
    weight = _SIMPSON * r * np.abs(r[:, 2] - r[:, 0])[:, None]
    return np.einsum("peb,eb->p", axial[:, mesh.edges] ** 2, weight)


def _mean_square(mesh: Mesh, edges: Integers, radial: Array) -> Array:
    """Mean square of radial shapes (p, k) along edges, over their axial places (p,)."""
    z = mesh.nodes[edges, 1]
    weight = _SIMPSON * np.abs(z[:, 2] - z[:, 0])[:, None]
    return np.einsum("peb,eb->p", radial[:, edges] ** 2, weight) / weight.sum()
