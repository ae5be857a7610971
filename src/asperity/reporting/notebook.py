"""A result that shows itself in a notebook."""

from __future__ import annotations

from xarray import DataTree

from asperity.reporting.data import present, stated
from asperity.schema import provenance
from asperity.schema.rolling import CONTACT_FORCE, TIME


class Result(DataTree):  # type: ignore[no-untyped-call]
    """The result of a run: a tree of datasets, which a notebook shows as verdict, numbers and a figure.

    It is an `xarray.DataTree` with the groups scenario, surface, contact, rolling and spectra, and what the
    kind of case adds; `asperity.report` writes all of it as a page.
    """

    __slots__ = ()

    @classmethod
    def of(cls, tree: DataTree) -> Result:
        """Make a result of a tree."""
        return cls(tree.to_dataset(inherit=False), children=tree.children)

    def _repr_html_(self) -> str:
        tree: str = super()._repr_html_()  # type: ignore[no-untyped-call]
        if stated(self, provenance.VERDICT) is None or not present(self, CONTACT_FORCE, TIME):
            return tree
        from asperity.reporting.notebook_view import notebook_view  # half a second of figures

        return notebook_view(self, tree)
