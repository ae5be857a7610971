"""A result that shows itself in a notebook, and draws its figures."""

from __future__ import annotations

from typing import TYPE_CHECKING

from xarray import DataTree

from asperity.reporting.data import present, stated
from asperity.schema import provenance
from asperity.schema.rolling import CONTACT_FORCE, TIME

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Result(DataTree):  # type: ignore[no-untyped-call]
    """The result of a run: a tree of datasets, which a notebook shows as verdict, numbers and a figure.

    It is an `xarray.DataTree` with the groups scenario, surface, contact, rolling and spectra, and what the
    kind of case adds; `plot` draws its figures, and `asperity.report` writes all of it as a page.
    """

    __slots__ = ()

    @classmethod
    def of(cls, tree: DataTree) -> Result:
        """Make a result of a tree."""
        return cls(tree.to_dataset(inherit=False), children=tree.children)

    def plot(self, name: str | None = None) -> Figure:
        """Draw a figure of the result, for a notebook to show or for ``savefig``.

        Parameters
        ----------
        name : str, optional
            A figure of the report by the name of its file, as ``"force_bands"``, or by its title or the
            beginning of it, as ``"contact force levels"``; by default the force of the main law in time
            beside the force levels of all laws.

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
        from asperity.kinds.report import figures_of
        from asperity.reporting.figure import chosen_figures
        from asperity.reporting.notebook_view import overview_chart
        from asperity.reporting.paper import draw

        if name is None and present(self, CONTACT_FORCE, TIME):
            return draw(overview_chart(self))
        (figure,) = chosen_figures(figures_of(self), [name])
        return draw(figure.laid_out(self))

    def _repr_html_(self) -> str:
        tree: str = super()._repr_html_()  # type: ignore[no-untyped-call]
        if stated(self, provenance.VERDICT) is None or not present(self, CONTACT_FORCE, TIME):
            return tree
        from asperity.reporting.notebook_view import notebook_view  # half a second of figures

        return notebook_view(self, tree)
