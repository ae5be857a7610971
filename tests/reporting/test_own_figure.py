"""A figure of one's own: one file of another package, and one line that names its chapter."""

import numpy as np
import pytest
from report_reading import read_csv
from report_tree import report_tree

import asperity
from asperity.scenes.report import OF_OTHERS, chapters, names_of_reports

FILE = '''
"""How far the force of each law is from its mean, sorted."""

import numpy as np

from asperity.reporting import chart
from asperity.reporting.figure import Chapter, Of, Series, figure
from asperity.schema.rolling import CONTACT_FORCE

FORCES = Of(CONTACT_FORCE, "{law}")


def share(tree):
    count = len(next(FORCES(tree)).values)
    yield Series("share of the time", "1", np.arange(count) / count)


@figure("Forces in order", share, FORCES)
def sorted_force(tree, lines):
    axes = chart.Axis("share of the time", 0.0, 1.0), chart.Axis("contact force / N")
    sorted_lines = [chart.Line(lines.at, np.sort(s.values), s.label, law=s.law) for s in lines.lines]
    yield chart.Panel(*axes, tuple(sorted_lines))
    yield "Of every law."


CHAPTER = Chapter("own", "A chapter of one's own", (sorted_force,))
'''


@pytest.fixture
def own_package(tmp_path, monkeypatch):
    """An installed package with a figure; afterwards it is gone."""
    told = tmp_path / "own_figure-1.0.dist-info"
    told.mkdir()
    (tmp_path / "own_figure.py").write_text(FILE, encoding="utf-8")
    (told / "METADATA").write_text(
        "Metadata-Version: 2.1\nName: own-figure\nVersion: 1.0\n", encoding="utf-8"
    )
    (told / "entry_points.txt").write_text(f"[{OF_OTHERS}]\nown = own_figure:CHAPTER\n", encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    chapters.cache_clear()
    yield
    chapters.cache_clear()


def test_a_figure_of_ones_own_is_one_file_and_one_line(own_package, tmp_path):
    tree = report_tree(["areal", "linear"])
    page = asperity.report(tree, tmp_path / "report")
    text = page.read_text(encoding="utf-8")
    assert text.index('id="own"') > text.index('id="laws"')
    assert ">A chapter of one&#39;s own</h2>" in text
    assert '<figure id="sorted_force"' in text
    columns = read_csv(page.parent / "sorted_force.csv")
    assert np.array_equal(columns["areal [N]"], tree["rolling/contact_force"].sel(law="areal"))
    assert "sorted_force.csv" in names_of_reports()
