"""Reports of all kinds in a browser: on screens of all sizes and on paper, for everybody."""

from __future__ import annotations

import pytest
from drawn import EMPTY, OVERLAPS, RECORDER, settled

from asperity.case import PRESETS


@pytest.fixture(params=list(PRESETS))
def address(request, reports):
    """A report of each kind."""
    return (reports[request.param] / "report.html").as_uri()


@pytest.fixture
def opened(browser, address):
    """Open it in a window so high that all is drawn; nothing is loaded and nothing fails."""
    pages, told = [], []

    def open_page(width, scheme="light"):
        page = browser.new_page(viewport={"width": width, "height": 40_000}, color_scheme=scheme)
        pages.append(page)
        page.add_init_script(RECORDER)
        page.on("console", lambda message: told.append(message.text))
        page.on("pageerror", lambda error: told.append(str(error)))
        page.on("request", lambda request: None if request.url == address else told.append(request.url))
        page.goto(address)
        for figure in page.locator("figure.chart").all():
            figure.locator(".uplot canvas").last.wait_for(state="attached")
        settled(page)
        return page

    yield open_page
    for page in pages:
        page.close()
    assert not told


@pytest.mark.parametrize(("width", "scheme"), [(1280, "light"), (390, "dark")])
def test_every_figure_is_drawn_and_readable(opened, width, scheme):
    page = opened(width, scheme)
    assert page.evaluate(EMPTY) == []
    assert page.evaluate(OVERLAPS) == []
    assert page.evaluate("document.documentElement.scrollWidth") <= width


def test_paper_has_every_figure_in_its_width(opened):
    page = opened(1280, "dark")
    page.emulate_media(media="print")
    settled(page)
    page.set_viewport_size({"width": 688, "height": 20_000})  # of A4 between its margins
    assert page.evaluate(EMPTY) == []
    assert page.evaluate(OVERLAPS) == []
    assert page.evaluate("document.documentElement.scrollWidth") <= 688
    assert not page.locator("figure.chart details").first.is_visible()


def test_numbers_stand_where_no_script_runs(browser, address):
    page = browser.new_page(java_script_enabled=False)
    page.goto(address)
    figures = page.locator("figure.chart").count()
    assert figures > 8
    assert page.locator("figure.chart details.numbers td:visible").count() > 10 * figures
    page.close()


def test_no_finding_of_axe(opened):
    axe = pytest.importorskip(
        "axe_playwright_python.sync_playwright",
        reason="no test of accessibility: pip install axe-playwright-python",
    )
    page = opened(1280, "dark")
    page.evaluate("document.querySelectorAll('details').forEach((folded) => { folded.open = true; })")
    found = axe.Axe().run(page).response["violations"]
    assert [(each["id"], [node["html"][:120] for node in each["nodes"][:3]]) for each in found] == []
