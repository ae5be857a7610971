"""The contact stiffness k_c(r) from an ensemble of surface samples on one common datum."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from asperity.contact import HalfSpace
from asperity.contact.flaws import Counts, total, warn_of_flaws
from asperity.errors import InputError
from asperity.progress import Progress
from asperity.reduction.stiffness import ForceCurve
from asperity.threads import in_order

TANGENT = 1e-4
"""Relative residual of the tangent stiffnesses of a loading curve."""


@dataclass(frozen=True, eq=False)
class StiffnessEnsemble:
    """Loading curves of N samples at common approaches."""

    approaches: NDArray[np.float64]  # (k,), from the samples' patch planes, m, positive closing
    forces: NDArray[np.float64]  # (N, k), N
    tangents: NDArray[np.float64]  # (N, k), dF/d(approach) of the solved contacts, N/m
    datum: float
    """d0, m: the state is r = approach + d0, one offset for all samples, no less than the highest first
    touch, so that F(r = 0) = 0 for each of them."""
    held: int  # states, from the lowest, in which the window holds the contacts of all samples

    @property
    def mean_force(self) -> NDArray[np.float64]:
        """Ensemble mean of the force, N, shape (k,)."""
        return np.asarray(self.forces.mean(axis=0))

    @property
    def force_spread(self) -> NDArray[np.float64]:
        """Standard deviation of the force between samples, N, shape (k,)."""
        if len(self.forces) < 2:
            return np.zeros(self.forces.shape[1])
        return np.asarray(self.forces.std(axis=0, ddof=1))

    @property
    def states(self) -> NDArray[np.float64]:
        """States r = approach + d0, m, shape (k,)."""
        return self.approaches + self.datum

    @property
    def curve(self) -> ForceCurve:
        """f(approach): monotone fit through the ensemble mean, with its slopes; k_c(r) = f/r (Eq. 2.3)."""
        return ForceCurve.from_samples(self.approaches, self.mean_force, stiffness=self.tangents.mean(axis=0))


def patches(
    maps: Sequence[NDArray[np.float64]],
    shape: tuple[int, int],
    count: int,
    weights: NDArray[np.float64],
) -> list[NDArray[np.float64]]:
    """Cut at least so many samples of (nx, ny) cells out of maps, each levelled to the plane its patch feels.

    Samples are spread evenly over the maps, at least one from each, overlapping if need be; heights in m.
    The weights are from `punch_weights` at the working load: wavelengths longer than the patch, which the
    texture of the path carries, must not be counted a second time inside the samples.
    """
    result = []
    for index, heights in enumerate(maps):
        spare = (heights.shape[0] - shape[0], heights.shape[1] - shape[1])
        if min(spare) < 0:
            raise InputError(
                "window of the contact",
                f"{shape[0]} × {shape[1]} cells",
                f"no more than the map's {heights.shape[0]} × {heights.shape[1]} cells at this spacing",
                "Choose a smaller contact.window or provide larger maps.",
            )
        for i, j in _spread(spare, samples_of_maps(len(maps), count)[index]):
            cut = heights[i : i + shape[0], j : j + shape[1]]
            result.append(cut - weighted_mean(cut, weights))
    return result


def samples_of_maps(maps: int, count: int) -> list[int]:
    """How many of at least so many samples are cut out of each of some maps."""
    return [max(count // maps + (index < count % maps), 1) for index in range(maps)]


def _spread(spare: tuple[int, int], count: int) -> list[tuple[int, int]]:
    """`count` offsets spread evenly over a rectangle: the points of a rank-one lattice."""
    golden = 0.5 * (np.sqrt(5.0) - 1.0)
    along = (np.arange(count) + 0.5) / count
    across = np.mod(0.5 + golden * np.arange(count), 1.0)
    return [(round(u * spare[0]), round(v * spare[1])) for u, v in zip(along, across, strict=True)]


def weighted_mean(heights: NDArray[np.float64], weights: NDArray[np.float64]) -> float:
    """Mean height, m, under a patch at the middle of a sample of odd sides, by its `punch_weights`."""
    mx, my = (min(w, h) // 2 for w, h in zip(weights.shape, heights.shape, strict=True))
    cx, cy = heights.shape[0] // 2, heights.shape[1] // 2
    wx, wy = weights.shape[0] // 2, weights.shape[1] // 2
    inner = weights[wx - mx : wx + mx + 1, wy - my : wy + my + 1]
    return float(np.vdot(heights[cx - mx : cx + mx + 1, cy - my : cy + my + 1], inner) / inner.sum())


def stiffness_ensemble(
    samples: Sequence[NDArray[np.float64]],
    half_space: HalfSpace,
    body: NDArray[np.float64],
    approaches: NDArray[np.float64],
    datum: float,
    *,
    rtol: float = 1e-6,
    workers: int | None = None,
    progress: Progress | None = None,
    tolerance: str = "rtol",
    remedy: str = "Enlarge the window.",
) -> StiffnessEnsemble:
    """Press the body on each of the samples (nx, ny) from `patches`, stepping the approach (k,) up.

    Half-space, body and `rtol` are as in `ScanJob`, `datum` is d0 in m; `tolerance` and `remedy` say what to
    do about contacts that do not converge or are cut off, as in `warn_of_flaws`.
    """

    cell = half_space.cell_area

    def load(sample: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64], Counts]:
        block = half_space.at_positions(sample, body, np.zeros(1), approaches, 1, rtol)
        forces = cell * block.totals[:, 0]
        tangents = [
            half_space.tangent_stiffness(pressure, TANGENT) if force > 0.0 else 0.0
            for force, pressure in zip(forces, block.pressures[0], strict=True)
        ]
        return forces, np.array(tangents), Counts(*block.counts.tolist())

    scans, message = [], "pressing the samples"
    if progress:
        progress(0, len(samples), message)
    for scanned in in_order(load, samples, workers):
        scans.append(scanned)
        if progress:
            progress(len(scans), len(samples), message)
    forces, tangents = (np.array([scanned[i] for scanned in scans]) for i in (0, 1))
    counts = [scanned[2] for scanned in scans]
    warn_of_flaws(total(counts), "the loading curves", tolerance, remedy)
    cut_off = max(each.truncated for each in counts)  # contacts grow: the highest states are cut off
    return StiffnessEnsemble(
        np.asarray(approaches, dtype=np.float64), forces, tangents, datum, len(approaches) - cut_off
    )
