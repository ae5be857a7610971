"""State functions of tangential contact: stiffness in stick and creep, rough and smooth under one load."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from asperity.arguments import Array, ArrayLike, finite_array, require
from asperity.contact.creep import DIRECTIONS, has_room, over_smooth, rolled_over
from asperity.contact.halfspace import HalfSpace
from asperity.contact.scan import Counts, warn_of_flaws
from asperity.contact.solved import Contact
from asperity.contact.tangential import FrictionalHalfSpace
from asperity.kernels.scanning import TRUNCATED
from asperity.progress import Progress, counted
from asperity.reference.materials import Material
from asperity.threads import in_order

UNLIMITED, MOTION = 1e9, 1e-12
"""Coefficient of friction by which nothing slips in a shift, m or rad, or creepage of this size."""


@dataclass(frozen=True, eq=False)
class TractionStates:
    """Tangential contact over the approach, of rough samples and of the smooth contact under the same loads.

    Attributes
    ----------
    approaches : ndarray (n,)
        Of the states, m, from the plane z = 0 of the samples.
    load : ndarray (samples, n)
        N.
    area : ndarray (2, samples, n)
        Real area of contact, m²; here and below of the sample, then of the smooth contact under its load.
    normal : ndarray (2, samples, n)
        Stiffness dF/dr, N/m.
    tangential : ndarray (2, samples, n, 2, 2)
        Force against a shift, along and across, of a contact that sticks all over, N/m; symmetric.
    creep : ndarray (2, samples, n, 3)
        Force against a small creepage: longitudinal by longitudinal and lateral by lateral, N, lateral by
        spin, N m. NaN where a sample is too short to roll over.
    """

    approaches: Array
    load: Array
    area: Array
    normal: Array
    tangential: Array
    creep: Array

    @property
    def quantities(self) -> dict[str, tuple[str, Array]]:
        """Unit and values (2, samples, n), rough and smooth, of each by its name."""
        k = self.tangential
        c = self.creep
        return {
            "real area": ("m^2", self.area), "normal stiffness": ("N/m", self.normal),
            "stiffness along": ("N/m", k[..., 0, 0]), "stiffness across": ("N/m", k[..., 1, 1]),
            "longitudinal creep": ("N", c[..., 0]), "lateral creep": ("N", c[..., 1]),
            "spin creep": ("N m", c[..., 2]),
        }  # fmt: skip

    @property
    def change(self) -> dict[str, tuple[Array, Array]]:
        """Each over that of the smooth contact: mean and standard deviation (n,) over the samples."""
        ratios = {name: rough / smooth for name, (_, (rough, smooth)) in self.quantities.items()}
        return {name: (each.mean(axis=0), each.std(axis=0)) for name, each in ratios.items()}


def middle_of(sample: Array, nx: int) -> Array:
    """Window (nx, ny) in the middle of a sample (rows, ny)."""
    first = (len(sample) - nx) // 2
    return sample[first : first + nx]


def traction_states(
    half_space: HalfSpace,
    bodies: tuple[Material, Material],
    body: ArrayLike,
    samples: Sequence[ArrayLike],
    approaches: ArrayLike,
    progress: Progress | None = None,
) -> TractionStates:
    """Tangential stiffness and creep of a body on rough samples, at given approaches.

    Parameters
    ----------
    half_space : HalfSpace
        Grid and modulus; the first axis is the rolling direction.
    bodies : (Material, Material)
        Of the half-space's modulus.
    body : array_like (nx, ny)
        Gap of the smooth bodies, m, zero at its lowest point.
    samples : sequence of array_like (rows, ny)
        Heights, m, peaks positive, pressed in their middle. Where they have more rows than the window, they
        are rolled over under the load of each state: over four lengths of the smooth contact, at least three.
    approaches : array_like (n,)
        Rising, m, with all samples in contact.
    progress : callable, optional
        ``progress(done, total, message)``.

    Returns
    -------
    TractionStates
        The functions.

    Raises
    ------
    InputError
        For arrays that do not fit, or a state in which a sample is not in contact.

    Notes
    -----
    Nothing slips: stiffness and creep at the beginning, where friction has no limit. What pressure and
    traction of unlike bodies do to each other is left out, with a warning.

    On any area of contact, in the continuum as on a grid, the stiffnesses along and across obey
    ``(1 − ν) k_n ≤ k_t ≤ k_n`` and ``1/k_xx + 1/k_yy ≤ (2 − ν)/(1 − ν)/k_n``, which is equal on an ellipse:
    Cerruti's kernel lies between Boussinesq's and that over 1 − ν, and the pressure of a flat punch, taken as
    a traction, cannot store less than the true one.

    Examples
    --------
    >>> import numpy as np
    >>> from asperity import HalfSpace, material
    >>> from asperity.reduction.traction import traction_states
    >>> steel, x = material("steel"), 10e-6 * np.arange(-20, 21)
    >>> space = HalfSpace((41, 41), 10e-6, 0.5 * 210e9 / (1 - 0.3**2))
    >>> ball, waves = np.add.outer(x**2, x**2) / (2 * 25e-3), 20e-9 * np.cos(x / 5e-6)
    >>> found = traction_states(space, (steel, steel), ball, [np.add.outer(waves, waves)], [0.5e-6])
    >>> f"{found.tangential[0, 0, 0, 0, 0] / found.normal[0, 0, 0]:.3f}"  # Mindlin: 2(1 − ν)/(2 − ν)
    '0.824'
    """
    r = finite_array("approaches", approaches, "rising lengths, m", shape=(None,), rising=True)
    allowed = f"finite numbers, an array of the half-space's shape {half_space.shape}"
    gap = finite_array("body", body, allowed, shape=half_space.shape)
    nx, ny = half_space.shape
    allowed = f"arrays of finite numbers, at least one, of {nx} rows or more and {ny} columns"
    heights = [finite_array("sample", each, allowed, shape=(None, ny)) for each in samples]
    shortest = min(map(len, heights), default=0)
    require(shortest >= nx, "samples", f"{len(heights)} of {shortest} rows at least", allowed)
    uncoupled = FrictionalHalfSpace(half_space, bodies, UNLIMITED, coupled=False)
    if uncoupled.unlikeness:  # a warning tells what is neglected, once
        uncoupled.shift(half_space.solve(gap, approach=r[-1]))
    g = uncoupled.shear_modulus
    nu = uncoupled.poisson_ratio
    both = Material("both", 2.0 * g * (1.0 + nu), nu, 1.0)
    stuck = FrictionalHalfSpace(half_space, (both, both), UNLIMITED)

    def pressed(sample: Array) -> list[Array]:
        found = list[Array]()
        start = None
        gap_here = gap - middle_of(sample, nx)
        for approach in r.tolist():
            contact = half_space.solve(gap_here, approach=approach, start=start)
            allowed = f"above {gap_here.min():.4g} m, where a sample touches"
            require(contact.force > 0.0, "approaches", f"{approach:.4g} m", allowed)
            start = contact.pressure
            smooth = half_space.solve(gap, load=contact.force)
            found.append(_tangents(stuck, contact, smooth, sample))
        return found

    done = counted(in_order(pressed, heights), len(heights), "tangential states", progress)
    values = np.moveaxis(np.array(list(done)), 2, 0)
    load, cut_off, area, normal = np.moveaxis(values[..., :4], -1, 0)
    counts = Counts(load[0].size, truncated=int(cut_off[0].sum()))
    remedy = "or end the approaches lower."
    warn_of_flaws(counts, "the states", "rtol", f"Enlarge the window, {remedy}")
    matrices = values[..., 4:8].reshape(*load.shape, 2, 2)
    return TractionStates(r, load[0], area, normal, matrices, values[..., 8:])


def _tangents(stuck: FrictionalHalfSpace, contact: Contact, smooth: Contact, sample: Array) -> Array:
    """Of a rough and of a smooth contact: load, whether it is cut off, area, stiffnesses, creep, (2, 11)."""
    found = np.full((2, 11), np.nan)
    for row, each in zip(found, (contact, smooth), strict=True):
        shifts = ((MOTION, 0.0), (0.0, MOTION))
        matrix = -np.array([stuck.shift(each, shift).force for shift in shifts]).T / MOTION
        row[:8] = each.force, each.edge_share > TRUNCATED, each.real_area, each.stiffness, *matrix.ravel()
    if has_room(smooth, sample):
        motions = MOTION * np.array(list(DIRECTIONS.values()))
        rolled = rolled_over(stuck, smooth, sample, motions)
        for i, ((xi, eta, spin), states) in enumerate(zip(motions.tolist(), rolled, strict=True)):
            axis = min(i, 1)
            steady = -stuck.roll(smooth, (xi, eta), spin).force[axis] / MOTION
            found[:, 8 + i] = steady * over_smooth(*states, axis)[0], steady
    return found
