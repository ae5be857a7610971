"""What is heard or measured of a run in one number, that textures are judged by: energy over frequency."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from xarray import DataTree

from asperity.schema import Entry, spectra
from asperity.spectra import a_weighting

A_WEIGHTED = "A-weighted level"
ACCELERATION = "rms acceleration"
MEASURE_NAMES = (A_WEIGHTED, ACCELERATION)


@dataclass(frozen=True)
class Measure:
    """A quantity that textures of a kind of case are judged by."""

    meaning: str  # what it is the level of
    units: str  # of the level
    # its energy per Hz (f,) relative to the square of its reference, of a law in a result
    density: Callable[[DataTree, str], NDArray[np.float64]]
    beside: tuple[str, ...] = ()  # laws without which it is not known


def line_frequencies(tree: DataTree) -> NDArray[np.float64]:
    """Frequencies of the spectra of a result (f,), Hz."""
    return np.asarray(tree[spectra.FREQUENCY.path].values)


def density_of(tree: DataTree, entry: Entry, law: str) -> NDArray[np.float64]:
    """PSD of a law over frequency (f,), mean over the places at which it is known."""
    found = tree[entry.group].to_dataset()[entry.name].sel(law=law)
    places = [dim for dim in found.dims if dim != spectra.FREQUENCY.name]
    return np.asarray(found.mean(places).values)


def a_weights(frequency: NDArray[np.float64]) -> NDArray[np.float64]:
    """Factors (f,) by which A-weighting changes energies at frequencies > 0, Hz."""
    return np.asarray(10.0 ** (a_weighting(frequency) / 10.0))


def a_weighted(density: Callable[[DataTree, str], NDArray[np.float64]]) -> Callable[..., NDArray[np.float64]]:
    """Weight a density as the ear does."""
    return lambda tree, law: a_weights(line_frequencies(tree)) * density(tree, law)
