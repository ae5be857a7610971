"""A result that shows itself in a notebook: verdict, warnings, numbers, and its figures."""

import base64
from collections.abc import Callable
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np
from xarray import DataTree

from asperity.reporting import chart, data, panels
from asperity.reporting.figure import Of
from asperity.schema import Entry, bearing, provenance, rolling, spectra

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LOAD_ZONE = "load_zone"
"""Figure that stands for the run of a bearing."""
COLUMNS = 350
"""Stretches in which a long force is drawn by its extremes."""


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
        from asperity.reporting.figure import chosen_figures
        from asperity.reporting.paper import draw
        from asperity.scenes.report import figures_of

        if name is None and data.present(self, rolling.CONTACT_FORCE, rolling.TIME):
            return draw(_overview(self))
        of_bearing = name is None and data.present(self, bearing.BALL_LOAD)
        (figure,) = chosen_figures(figures_of(self), [LOAD_ZONE if of_bearing else name])
        return draw(figure.laid_out(self))

    def _repr_html_(self) -> str:
        tree: str = super()._repr_html_()  # type: ignore[no-untyped-call]
        rolled = data.present(self, rolling.CONTACT_FORCE, rolling.TIME)
        if data.stated(self, provenance.VERDICT) is None or not (
            rolled or data.present(self, bearing.BALL_LOAD)
        ):
            return tree
        title, verdict = (
            escape(str(data.stated(self, each))) for each in (provenance.TITLE, provenance.VERDICT)
        )
        drawn = f"{_picture(self)}\n{_numbers(self)}" if rolled else ""
        return (
            f"<div><p><strong>{title}.</strong> {verdict}</p>\n{_warnings(self)}\n{drawn}\n"
            f"<details><summary>All data</summary>{tree}</details></div>"
        )


def _warnings(tree: DataTree) -> str:
    """Every warning on the physics, in a list that opens."""
    told = [
        f"<li>{escape(str(item.get('grade', 'warning')).capitalize() + ': ' + str(item.get('message')))}</li>"
        for item in data.json_list(tree, provenance.WARNINGS)
    ]
    count = f"{len(told)} warning{'s' if len(told) > 1 else ''}"
    return f"<details><summary>{count}</summary><ul>{''.join(told)}</ul></details>" if told else ""


def _numbers(tree: DataTree) -> str:
    """Mean and rms of the force, and its losses, by law."""
    heads = ["law", "mean force", "rms about it", "largest", "time without contact", "longest loss"]
    rows = [f"<tr>{''.join(f'<th>{name}</th>' for name in heads)}</tr>"]
    losses: dict[Entry, Callable[[float], str]] = {
        rolling.CONTACT_LOSS_SHARE: "{:.2%}".format,
        rolling.LONGEST_LOSS: lambda s: data.engineering(s, "s") if s > 0 else "–",
    }
    for law in data.laws(tree, rolling.CONTACT_FORCE):
        force = data.of_law(tree, rolling.CONTACT_FORCE, law)
        cells = [law, *(data.engineering(float(f(force)), "N") for f in (np.nanmean, np.nanstd, np.nanmax))]
        for entry, write in losses.items():
            known = law in data.laws(tree, entry) and not data.law_entry(tree, law).may_pull
            cells.append(write(float(data.of_law(tree, entry, law))) if known else "–")
        rows.append(f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in cells)}</tr>")
    return f"<table>{''.join(rows)}</table>"


def _picture(tree: DataTree) -> str:
    from asperity.reporting.paper import draw  # half a second

    image = base64.b64encode(draw(_overview(tree))._repr_png_()).decode()
    main = escape(data.laws(tree, rolling.CONTACT_FORCE)[0])
    return f'<img alt="contact force of {main}" width="840" src="data:image/png;base64,{image}">'


def _overview(tree: DataTree) -> chart.Chart:
    """Force of the main law in time, and the force levels of all laws."""
    main, time = next(Of(rolling.CONTACT_FORCE, "{law}")(tree)), data.values(tree, rolling.TIME)
    size, unit = data.force_unit(float(np.nanmax(np.abs(main.values))))
    second, symbol = data.time_unit(float(time[-1] - time[0]))
    starts, low, high = chart.envelope(main.values / size, COLUMNS)
    look: dict[str, Any] = {"colour": data.law_entry(tree, main.law).colour}
    shown: chart.Mark = chart.Line(time / second, main.values / size, width=1.0, **look)
    if len(starts) < len(time):
        shown = chart.Area(time[starts] / second, low, high, opacity=1.0, **look)
    low_end, high_end = panels.main_limits([main], ())
    up = chart.Axis(f"contact force / {unit}", low_end / size, high_end / size)
    drawn = [chart.Panel(chart.Axis(f"time / {symbol}"), up, (shown,), main.law, height=3.0)]
    if data.present(tree, spectra.FORCE_LEVEL):
        band = data.values(tree, spectra.BAND)
        levels = panels.styled(tree, band, Of(spectra.FORCE_LEVEL, "{law}")(tree))
        axis = panels.levels_axis("force level / dB re 1 N", [line.y for line in levels])
        drawn.append(chart.Panel(panels.band_axis(band), axis, tuple(levels), height=3.0, beside=True))
    return chart.Chart(tuple(drawn))
