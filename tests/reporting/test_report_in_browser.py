"""Reports of all kinds in a browser: on screens of all sizes and on paper, for everybody."""

from __future__ import annotations

import pytest
from drawn import OVERLAPS, PIXELS, RECORDER, settled

from asperity.kinds import KINDS

SIZES = [(1280, "light"), (390, "dark")]


@pytest.fixture(params=list(KINDS))
def address(request, reports):
    """A report of each kind."""
    return (reports[request.param] / "report.html").as_uri()


@pytest.fixture
def opened(browser, address):
    """Open it, high enough that all is drawn; nothing is loaded and nothing fails."""
    pages, told = [], []

    def open_page(width, scheme="light"):
        page = browser.new_page(viewport={"width": width, "height": 30_000}, color_scheme=scheme)
        pages.append(page)
        page.add_init_script(RECORDER)
        page.on("console", lambda message: told.append(message.text))
        page.on("pageerror", lambda error: told.append(str(error)))
        page.on("request", lambda request: None if request.url == address else told.append(request.url))
        page.goto(address)
        page.locator("figure.chart .uplot canvas").last.wait_for(state="attached")
        settled(page)
        return page

    yield open_page
    for page in pages:
        page.close()
    assert not told


@pytest.mark.parametrize(("width", "scheme"), SIZES)
def test_every_figure_is_drawn_and_readable(opened, width, scheme):
    page = opened(width, scheme)
    assert page.locator("figure.chart:not(:has(.uplot canvas))").count() == 0
    for canvas in page.locator("figure.chart .uplot canvas").all():
        name = canvas.evaluate("canvas => canvas.closest('figure').id")
        shown = canvas.evaluate(
            "canvas => canvas.getContext('2d', { willReadFrequently: true }) && canvas.texts.length"
        )
        assert shown >= 3, name
    assert page.evaluate(OVERLAPS) == []
    assert page.evaluate("document.documentElement.scrollWidth") <= width
