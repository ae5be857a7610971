"""Contact solutions that missed their tolerance or were cut off by the window, and what to do about them."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from asperity.errors import Grade, TruncatedContactWarning, UnconvergedWarning, percent
from asperity.kernels.scanning import TRUNCATED


class Counts(NamedTuple):
    """Contact solutions, and how they went."""

    solved: int = 0  # in contact
    iterations: int = 0  # of conjugate gradients, all solutions together
    unconverged: int = 0  # missed the tolerance
    truncated: int = 0  # with a noticeable share of the force on the window's edge


def total(counts: Iterable[Counts]) -> Counts:
    """Counts of several scans together."""
    return Counts(*(sum(column) for column in zip(*counts, strict=True)))


def warn_of_flaws(counts: Counts, what: str, tolerance: str, remedy: str = "Enlarge the window.") -> None:
    """Warn of contact solutions that did not converge or were cut off, graded by their share.

    They were made for `what`, as ``"the scan"``; `tolerance` is the key or argument that says how tightly
    they are solved, `remedy` what to do about contacts that are cut off.
    """
    solved, _, unconverged, truncated = counts
    if unconverged:
        share = unconverged / max(solved, 1)
        warnings.warn(
            UnconvergedWarning(
                f"{unconverged} of {solved} contact solutions of {what} ({percent(share)}) missed their "
                f"tolerance; their forces are approximate. Try a larger {tolerance}, and check the surface "
                "for outliers.",
                Grade.of_share(share),
            ),
            stacklevel=4,
        )
    if truncated:
        share = truncated / max(solved, 1)
        warnings.warn(
            TruncatedContactWarning(
                f"in {truncated} of {solved} contact solutions of {what} ({percent(share)}) more than "
                f"{100 * TRUNCATED:.0f} % of the force acts on the window's edge: the contact is cut off and "
                f"its force too small{_MEANING[Grade.of_share(share)]}. {remedy}",
                Grade.of_share(share),
            ),
            stacklevel=4,
        )


_MEANING = {
    Grade.NOTE: ", too seldom to matter",
    Grade.WARNING: "",
    Grade.OUT: ", so often that levels are wrong",
}


def window_for(body: NDArray[np.float64], spacing: tuple[float, float], overlap: float) -> float:
    """Side of a square window, m, that holds the contact of a body (nx, ny), m, which goes on as a parabola.

    Hertz's patch of smooth bodies at the largest overlap, m, of the undeformed ones, with the highest peak,
    and a tenth more for peaks beyond it.
    """
    middle = [n // 2 for n in body.shape]
    edges = min(body[0, middle[1]], body[-1, middle[1]]), min(body[middle[0], 0], body[middle[0], -1])
    grown = [np.sqrt(max(0.5 * overlap / edge, 0.0)) if edge > 0.0 else 1.0 for edge in edges]
    return 1.1 * float(max(n * d * g for n, d, g in zip(body.shape, spacing, grown, strict=True)))
