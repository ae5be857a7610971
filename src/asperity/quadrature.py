"""Gauss's rule: places and weights by which smooth functions are integrated."""

import numpy as np

from asperity.arguments import Array


def gauss(count: int, begin: float = 0.0, end: float = 1.0) -> tuple[Array, Array]:
    """Places (count,) between two ends, and weights (count,), whose sum is the distance of the ends.

    What is summed so is exact for polynomials up to the degree 2 count − 1.
    """
    nodes, weights = np.polynomial.legendre.leggauss(count)
    half = 0.5 * (end - begin)
    return begin + half * (nodes + 1.0), half * weights
