"""Contacts that are solved once, so that their kernels are compiled: all that a second process imports."""

from functools import cache

import numpy as np

from asperity.contact.halfspace import HalfSpace
from asperity.kernels import box


@cache
def press_once(*kinds: str) -> None:
    """Press a body on each kind of cells, to an approach and under a load, and estimate an approach.

    Once in a process.
    """
    x = np.arange(-4.0, 5.0) ** 2
    gap = np.add.outer(x, x)
    for cells in kinds:
        half_space = HalfSpace((9, 9), (1.0, 1.0), 1.0, cells=cells)
        half_space.solve(gap, approach=5.0)
        half_space.solve(gap, load=5.0)
    box.foundation_approach(np.zeros((9, 9)), 1.0, 1.0, 1.0, np.inf)
