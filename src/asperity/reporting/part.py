"""What a figure of the report consists of: a drawing, a caption, and the numbers in it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from matplotlib.figure import Figure
from numpy.typing import NDArray
from xarray import DataTree

from asperity.reporting.data import present

Columns = dict[str, NDArray]
"""Columns of a CSV file: ``"quantity [unit]"`` → numbers, all of one length, in SI units."""


@dataclass(frozen=True)
class Part:
    """One figure of the report.

    Parameters
    ----------
    name : str
        Name of its CSV file and of its place in the page.
    title : str
        Its heading.
    needs : tuple of str
        Variables, as ``"contact/force"``, without which it is left out.
    draw : callable
        Makes the figure from a result tree.
    columns : callable
        Makes the columns of the CSV file from a result tree.
    caption : callable
        Says, from a result tree, what is drawn and with which conventions.
    any_of : tuple of str, optional
        Variables of which it needs at least one.
    worth : callable, optional
        Whether these variables have anything to show: a smooth surface has no spectrum.
    """

    name: str
    title: str
    needs: tuple[str, ...]
    draw: Callable[[DataTree], Figure]
    columns: Callable[[DataTree], Columns]
    caption: Callable[[DataTree], str]
    any_of: tuple[str, ...] = ()
    worth: Callable[[DataTree], bool] = lambda _: True

    def drawable(self, tree: DataTree) -> bool:
        """Whether `tree` holds what the figure needs."""
        some = not self.any_of or any(present(tree, path) for path in self.any_of)
        return some and present(tree, *self.needs) and self.worth(tree)
