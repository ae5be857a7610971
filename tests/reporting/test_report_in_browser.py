"""Reports of all kinds in a browser: on screens of all sizes and on paper, for everybody."""

import pytest
from drawn import assert_accessible, assert_readable, pages_of

from small_cases import CASES

WIDEST = "wheel-on-rail"
"""Its report has figures of all sorts; those of the others are looked at by --long."""


@pytest.fixture(params=[pytest.param(kind, marks=[pytest.mark.long] * (kind != WIDEST)) for kind in CASES])
def address(request, reports):
    """A report of each kind."""
    return (reports[request.param] / "report.html").as_uri()


def test_every_figure_is_drawn_and_readable_on_screens_and_paper(browser, address):
    with pages_of(browser, address) as opened:
        assert_readable(opened(390, "dark"), 390)
        page = opened(1280, "dark")
        assert_readable(page, 1280)
        page.emulate_media(media="print")
        page.set_viewport_size({"width": 688, "height": 1000})  # of A4 between its margins
        assert_readable(page, 688)
        assert not page.locator("figure.chart details").first.is_visible()
        page.emulate_media(media="screen")
        assert_accessible(page)
