"""A result that shows itself in a notebook: verdict, warnings, numbers, and its figures."""

import base64
from html import escape
from typing import TYPE_CHECKING

from xarray import DataTree

from asperity.reporting import data, headline
from asperity.schema import bearing, provenance, rolling

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MAIN = ("force_bands", "load_zone")
"""Figures that stand for a run, the second for that of a bearing."""


class Result(DataTree):  # type: ignore[no-untyped-call]
    """The result of a run: a tree of datasets, which a notebook shows as verdict, numbers and a figure.

    It is an `xarray.DataTree` with the groups scenario, surface, contact, rolling and spectra, and what the
    kind of case adds; `plot` draws its figures, and `asperity.report` writes all of it as a page.
    """

    __slots__ = ()

    @classmethod
    def of(cls, tree: DataTree) -> "Result":
        """Make a result of a tree."""
        return cls(tree.to_dataset(inherit=False), children=tree.children)

    def plot(self, name: str | None = None) -> "Figure":
        """Draw a figure of the result, for a notebook to show or for ``savefig``.

        Parameters
        ----------
        name : str, optional
            A figure of the report by the name of its file, as ``"force_bands"``, or by its title or the
            beginning of it, as ``"contact force levels"``; by default this one, of a bearing its load zone.

        Returns
        -------
        matplotlib.figure.Figure
            The figure.

        Raises
        ------
        InputError
            If the result has no such figure; the message lists those that it has, and the nearest.

        Examples
        --------
        >>> import asperity
        >>> result = asperity.run(case)
        >>> result.plot().savefig("force.png")
        >>> result.plot("force_bands").axes[0].get_xlabel()
        'one-third octave band / Hz'
        """
        from asperity.reporting.figure import chosen_figures
        from asperity.reporting.paper import draw
        from asperity.scenes.report import figures_of

        figures = figures_of(self)
        main = next((figure.name for figure in figures if figure.name in MAIN), None)
        (figure,) = chosen_figures(figures, [main if name is None else name])
        return draw(figure.chart)

    def _repr_html_(self) -> str:
        tree: str = super()._repr_html_()  # type: ignore[no-untyped-call]
        rolled = data.present(self, rolling.CONTACT_FORCE) or data.present(self, bearing.BALL_LOAD)
        if data.stated(self, provenance.VERDICT) is None or not rolled:
            return tree
        title, verdict = (
            escape(str(data.stated(self, each))) for each in (provenance.TITLE, provenance.VERDICT)
        )
        valid = headline.validity(headline.lights(self)).quantity
        image = base64.b64encode(self.plot()._repr_png_()).decode()  # type: ignore[attr-defined]
        return (
            f"<div><p><strong>{title}.</strong> {verdict} {valid}</p>\n{_numbers(self)}\n"
            f'<img alt="main figure" width="840" src="data:image/png;base64,{image}">\n'
            f"<details><summary>All data</summary>{tree}</details></div>"
        )


def _numbers(tree: DataTree) -> str:
    """The numbers with which the page of the result begins."""
    from asperity.reporting.page import answers_of
    from asperity.scenes.report import chapters

    cells = ((each.name, each.value, each.note) for each in answers_of(tree, chapters()).numbers)
    rows = ("".join(f"<td>{escape(cell)}</td>" for cell in row) for row in cells)
    return f"<table>{''.join(f'<tr>{row}</tr>' for row in rows)}</table>"
