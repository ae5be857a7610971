"""A result and the progress of a run as a notebook shows them."""

import base64
import json
import re
import sys
import types

import numpy as np
import pytest
import xarray as xr

import asperity
from asperity.errors import InputError
from asperity.progress import COMPILING, shown_progress
from asperity.scenes.report import Result

CASE = asperity.BallOnBeam(laws=["hertz", "linear"], duration=5e-3, surface={"spectrum": "iso3095"})


@pytest.fixture
def result(runs):
    return runs(CASE)


def test_a_result_is_a_tree_that_shows_verdict_numbers_and_force(result):
    assert isinstance(result, xr.DataTree)
    page = result._repr_html_()
    assert re.sub(r"\s", "", result.attrs["verdict"])[:40] in re.sub(r"\s", "", page)
    varies = float(result["rolling/contact_force"].sel(law="hertz").std())
    assert f"<td>contact force varies by, rms</td><td>{varies:.3g} N</td>" in page
    (picture,) = re.findall(r'src="data:image/png;base64,([^"]+)"', page)
    assert base64.b64decode(picture)[:4] == b"\x89PNG"
    assert "<summary>All data</summary>" in page
    assert page.count("<div") == page.count("</div>")


def test_a_result_draws_its_figures_by_name(result):
    """The main one, which a notebook shows without being told, and those of the report."""
    bands = result.plot()
    assert bands._repr_png_()[:4] == b"\x89PNG"
    assert "one-third octave" in bands.axes[-1].get_xlabel()
    by_title = result.plot("contact force levels")
    for drawn, line in zip(by_title.axes[0].lines, bands.axes[0].lines, strict=True):
        np.testing.assert_array_equal(drawn.get_xydata(), line.get_xydata())
    with pytest.raises(
        InputError, match=r"received 'force_band'; allowed: .*force_bands.* Did you mean .force_bands"
    ):
        result.plot("force_band")
    with pytest.raises(InputError, match="it has none"):
        Result().plot()


def test_what_it_shows_cannot_run_scripts(result):
    hostile = Result.of(result.copy())
    hostile.attrs["verdict"] = "<script>alert(1)</script>"
    assert "<p><strong>Steel ball on a steel beam.</strong> &lt;script&gt;" in hostile._repr_html_()
    hostile.attrs["warnings"] = json.dumps([{"message": "coarse", "grade": "warning"}])
    assert "To be read with care: 1 warning" in hostile._repr_html_()


def test_it_survives_saving_and_a_part_of_it_is_shown_as_a_tree(result, tmp_path):
    again = asperity.open_result(asperity.save(result, tmp_path / "run.nc"))
    assert type(again) is Result
    assert "All data" in again._repr_html_()
    assert not any("All data" in part._repr_html_() for part in (result["rolling"], Result()))


@pytest.fixture
def notebook(monkeypatch):
    """An IPython that runs a notebook; returns what was displayed."""
    shown = []

    class Handle:
        def update(self, thing):
            shown.append(thing._repr_html_())

    def display(thing, display_id):
        assert display_id
        shown.append(thing._repr_html_())
        return Handle()

    shell = types.SimpleNamespace(has_trait=lambda name: name == "kernel")
    ipython = types.ModuleType("IPython")
    ipython.get_ipython = lambda: shell
    ipython.display = types.ModuleType("IPython.display")
    ipython.display.display = display
    monkeypatch.setitem(sys.modules, "IPython", ipython)
    monkeypatch.setitem(sys.modules, "IPython.display", ipython.display)
    return shown


def test_a_run_shows_a_bar_in_a_notebook_and_takes_it_away(notebook, tmp_path, monkeypatch):
    monkeypatch.setenv("ASPERITY_CACHE", str(tmp_path))
    asperity.run(CASE)
    assert notebook[0] == notebook[-1] == ""
    bar = r'<progress value="\d+" max="\d+"></progress> .+: \d+ of \d+'
    assert any(re.match(bar, shown) for shown in notebook)


def test_a_bar_is_drawn_now_and_then_and_escapes_its_words(notebook):
    with shown_progress(None) as progress:
        for done in range(1001):
            progress(done, 1000, "<b>scan</b>")
    assert len(notebook) < 20
    assert "&lt;b&gt;scan&lt;/b&gt;: 1000 of 1000" in notebook[-2]


def test_elsewhere_nothing_is_shown(notebook, monkeypatch, capsys):
    """Where another progress is asked for, that is the only one."""
    told = []
    with shown_progress(lambda *step: told.append(step)) as progress:
        progress(1, 2, "scan")
    assert told == [(1, 2, "scan")]
    monkeypatch.delitem(sys.modules, "IPython")
    with shown_progress(None) as progress:
        progress(1, 2, "scan")
    assert capsys.readouterr() == ("", "")
    assert notebook == []


def test_a_notebook_says_that_functions_are_compiled_before_it_waits():
    """In a kernel of its own, as the first roll of a notebook: nothing else is shown there for a minute."""
    client, nbformat = (pytest.importorskip(name) for name in ("nbclient", "nbformat"))
    lines = (
        "from asperity.progress import COMPILATION",
        'COMPILATION.begin("first")',
        'COMPILATION.begin("next")',
    )
    book = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell("\n".join(lines))])
    client.NotebookClient(book, timeout=60, kernel_name="python3").execute()
    (output,) = book.cells[0].outputs
    assert (output.name, output.text) == ("stderr", f"{COMPILING}\n")
