"""Charts, and reports of all kinds, as browsers draw them: on screens and paper, by mouse and keys."""

import re

import numpy as np
import pytest
from report_reading import HOSTILE

from asperity.reporting import panels
from asperity.reporting.chart import (
    BLUE,
    COLOURS,
    GREEN,
    INK,
    TIME,
    VERMILLION,
    Axis,
    Boxes,
    Chart,
    Field,
    Line,
    Note,
    Panel,
    Rules,
    Shape,
)  # fmt: skip
from asperity.reporting.data import page_colours
from asperity.reporting.figure import PageFigure
from asperity.reporting.page import figures_page, whole_page
from asperity.scenes.report import write_summary
from browser import OVERLAPS, assert_accessible, assert_readable, pages_of, pixels, shared_page
from small_cases import CASES

AREAL = {"label": "areal", "law": "areal", "colour": BLUE, "width": 2.2}
LINEAR = {"label": "linear", "law": "linear", "colour": VERMILLION, "dashes": (3.0, 1.5)}
HIGHEST = 777.0
BANDS = 1000 * 10 ** (np.arange(-14, 8) / 10)


def run_chart():
    """Forces of a run with one highest point, and when contact is lost."""
    time = np.linspace(0.0, 3.0, 30_001)
    force, linear = 500 + 100 * np.sin(40 * time), 500 + 150 * np.sin(40 * time)
    force[20_000] = HIGHEST
    axis = Axis("time / s", 0.0, 3.0, linked=TIME)
    bars = Boxes(*(np.array([at]) for at in (1.0, 1.1, -0.35, 0.35)), colour=BLUE, law="areal", label="areal")
    marks = Rules(np.zeros(1), "y", dashes=()), Line(time, linear, **LINEAR), Line(time, force, **AREAL)
    names = panels.words_axis(("areal", "a law of a longer name"), "no contact")
    lost = Panel(axis, names, (bars,), height=1.3)
    return Chart((Panel(axis, Axis("contact force / N"), marks), lost))


def spectrum_chart():
    """Lines with a gap, shades, rules and notes in each other's way."""
    frequency = np.geomspace(30, 5000, 200)
    level = 60 - 10 * np.log10(frequency)
    broken = np.where((frequency > 200) & (frequency < 400), np.nan, level + 6)
    notes = [Note(words, 1000.0, 0.95, y_share=True) for words in ("first mode", "second mode, not far")]
    notes.append(Note("pinned-pinned", 2000.0, 0.03, y_share=True, upright=True))
    behind = *panels.doubtful_boxes(BANDS, BANDS < 60), Rules(np.array([1000.0, 1010.0, 2000.0]))
    marks = (*behind, Line(frequency, broken, **LINEAR), Line(frequency, level, **AREAL), *notes)
    axis = Axis("force PSD / dB re 1 N²/Hz", 20, 60)
    return Chart((Panel(panels.frequency_axis(30, 5000), axis, marks),))


def bands_chart():
    """Lines with markers in bands, and hatched bars below zero."""
    level, axis = 30 + np.sin(np.arange(BANDS.size)), panels.band_axis(BANDS)
    bars = Boxes(BANDS / 1.1, BANDS * 1.1, -level, 0 * level, HOSTILE, GREEN, hatch="/", edge=INK)
    above = Line(BANDS, level, marker="o", **AREAL), Line(BANDS, level + 2, marker="s", **LINEAR)
    return Chart((Panel(axis, Axis("level / dB"), above), Panel(axis, Axis("less / dB"), (bars,), height=2)))


def map_chart():
    """A field with a gap, outlined, beside a stretched one."""
    x, y = np.meshgrid(np.linspace(-1, 1, 40), np.linspace(-1, 1, 30), indexing="ij")
    pressure, turn = np.where(x**2 + y**2 < 0.5, 800 * (1 - x**2 - y**2), np.nan), np.linspace(0, 6.28, 60)
    axes = Axis("x / mm (rolling direction →)", -1, 1), Axis("y / mm", -1, 1)
    field = Field((-1, 1), (-1, 1), pressure, "pressure / MPa", 0, 800, "inferno_r")
    outline = Shape(0.7 * np.cos(turn), 0.7 * np.sin(turn), dashes=(3.0, 2.0))
    gap = Field((-1, 1), (-1, 1), x, "gap / µm", -0.5, 0.5)
    whole = Panel(*axes, (field, outline), "pressure", equal=True)
    return Chart((whole, Panel(*axes, (gap,), "gap", beside=True)))


def words_chart():
    """Bars that stand and bars that lie, by words."""
    words = ("rail", "sleepers", "wheel with its axle", "sum")
    at, high = np.arange(4.0), np.arange(80.0, 96.0, 4.0)
    up = Boxes(at - 0.3, at + 0.3, np.full(4, 60.0), high, "areal", BLUE, law="areal", hatch="x")
    flat, axis = Boxes(0 * at, high, at - 0.3, at + 0.3, "share", GREEN), panels.words_axis(words)
    stood = Panel(axis, Axis("power / dB(A)", 60, 100), (up,))
    return Chart((stood, Panel(Axis("share / %", 0, 100), axis, (flat,), beside=True)))


MAKERS = (run_chart, spectrum_chart, bands_chart, map_chart, words_chart)
CHARTS = {make.__name__.removesuffix("_chart"): make() for make in MAKERS}
NUMBERS = {"x [m]": np.array([4711.0])}


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    """A page with all charts, allowed to do what a report may."""
    figures = [PageFigure(name, f"Figure of {name}", "", of, "", NUMBERS) for name, of in CHARTS.items()]
    path = tmp_path_factory.mktemp("charts") / "page.html"
    path.write_text(figures_page("Charts", "All.", figures, {}), encoding="utf-8")
    return path.as_uri()


@pytest.fixture
def opened(browser, address):
    with pages_of(browser, address) as open_page:
        yield open_page


DRAWN = [
    ("run", 0, BLUE), ("run", 0, VERMILLION), ("run", 1, BLUE), ("spectrum", 0, BLUE),
    ("spectrum", 0, VERMILLION), ("bands", 0, BLUE), ("bands", 1, GREEN), ("bands", 1, INK),
    ("map", 0, "#fcffa4"), ("map", 0, INK), ("map", 1, "#00224e"), ("map", 1, "#fee838"),
    ("words", 0, BLUE), ("words", 1, GREEN),
]  # fmt: skip


@pytest.mark.parametrize(("width", "scheme"), [(1280, "light"), (800, "dark"), (360, "dark")])
def test_every_mark_is_drawn_in_the_colours_of_the_page_and_no_text_over_another(opened, width, scheme):
    page = opened(width, scheme)
    for name, panel, colour in DRAWN if width > 360 else ():
        light = scheme == "light" or name == "map"
        assert pixels(page, name, colour if light else COLOURS[colour], panel) > 15, (name, panel, colour)
    texts = page.evaluate("[...document.querySelectorAll('.uplot canvas')].map((c) => c.texts.length)")
    assert min(texts) > 3
    assert page.evaluate(OVERLAPS) == []
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    if width != 360:
        assert_accessible(page)


CROSSED = """([figure, said, colour]) => {  // pixels of a colour where words stand
  const canvas = document.querySelector(`#${figure} .uplot canvas`);
  const { left, top, right, bottom } = canvas.texts.find(({ text }) => text === said);
  const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d");
  copy.drawImage(canvas, 0, 0);
  const { data } = copy.getImageData(left, top, right - left, bottom - top);
  const parts = [1, 3, 5].map((n) => parseInt(colour.slice(n, n + 2), 16));
  const has = (i) => parts.every((part, k) => Math.abs(data[i + k] - part) < 12);
  return data.filter((_, i) => i % 4 === 0 && has(i)).length;
}"""


@pytest.mark.parametrize("width", [360, 1280])
def test_words_stand_clear_of_lines_where_there_is_room(browser, tmp_path, width):
    """A line ran through "says little", which stood at the bottom whatever was drawn there."""
    low = Line(BANDS, np.linspace(1.0, 40.0, BANDS.size), marker="o", **AREAL)
    panel = Panel(
        panels.band_axis(BANDS), Axis("level / dB", 0, 60), (*panels.doubtful_boxes(BANDS, BANDS < 60), low)
    )
    path = tmp_path / "page.html"
    figure = PageFigure("low", "Low", "", Chart((panel,)), "", NUMBERS)
    path.write_text(figures_page("Charts", "All.", [figure], {}), encoding="utf-8")
    with pages_of(browser, path.as_uri()) as opened:
        assert opened(width).evaluate(CROSSED, ["low", "says little", BLUE]) == 0


def test_a_law_is_shown_or_not_in_all_figures_at_once_and_what_is_no_law_in_its_own(opened):
    page = opened()
    places = [("run", 0), ("run", 1), ("spectrum", 0), ("bands", 0), ("words", 0)]
    page.locator("#bands").get_by_role("checkbox", name="areal").uncheck()
    assert [pixels(page, name, BLUE, panel) for name, panel in places] == [0] * 5
    assert not page.locator("#words").get_by_role("checkbox", name="areal").is_checked()
    assert pixels(page, "run", VERMILLION) > 15
    page.locator("#run").get_by_role("checkbox", name="areal").first.check()
    assert all(pixels(page, name, BLUE, panel) > 15 for name, panel in places)
    page.locator("#words").get_by_role("checkbox", name="share").uncheck()
    assert pixels(page, "words", GREEN, 1) == 0
    assert pixels(page, "bands", GREEN, 1) > 15


def test_a_law_that_is_unticked_is_one_click_away(browser, tmp_path):
    figure = PageFigure("run", "Forces", "", CHARTS["run"], "", NUMBERS)
    colours = page_colours([BLUE, VERMILLION])
    words = {"title": "", "summary": "", "version": "", "files": {}, "blocks": [figure], "remake": None}
    path = tmp_path / "page.html"
    path.write_text(
        whole_page("figures.html.jinja", [figure], colours, ["linear"], **words), encoding="utf-8"
    )
    with pages_of(browser, path.as_uri()) as opened:
        page = opened()
        assert (pixels(page, "run", VERMILLION), pixels(page, "run", BLUE) > 15) == (0, True)
        page.locator("#run").get_by_role("checkbox", name="linear").check()
        assert pixels(page, "run", VERMILLION) > 15


def said(page, name):
    return page.locator(f"#{name} [role=status]").text_content().replace("−", "-")


def test_points_bands_words_and_fields_are_read_by_keys(opened):
    page = opened()
    area = page.get_by_role("application", name="Figure of run: contact force / N over time / s")
    for key in ("Home", *["+"] * 12, *["ArrowRight"] * 7):
        area.press(key)
    time, areal = re.match(r"time ([\d.]+) s: linear [\d.]+ N, areal ([\d.]+) N", said(page, "run")).groups()
    assert float(time) == pytest.approx(7e-4)  # zoomed in, a key is a time step
    assert float(areal) == pytest.approx(500 + 100 * np.sin(40 * 7e-4), abs=0.06)
    area.press("End")
    assert said(page, "run").startswith("time 3 s:")
    for name, keys in (("bands", ("Home", "ArrowRight")), ("words", ("Home",)), ("map", ("ArrowUp",))):
        for key in keys:
            page.locator(f"#{name} [role=application]").first.press(key)
    assert said(page, "bands") == "one-third octave band 50 Hz: areal 30.84 dB, linear 32.84 dB"
    assert said(page, "words").endswith("rail: areal 80 dB(A)")
    assert 780 < float(said(page, "map").split("pressure ")[1].split(" MPa")[0]) <= 800


def test_parts_are_shown_by_dragging_and_all_comes_back(opened):
    page = opened()
    whole, over = pixels(page, "spectrum", BLUE), page.locator("#spectrum .u-over")
    over.drag_to(over, source_position={"x": 100, "y": 50}, target_position={"x": 200, "y": 60})
    page.mouse.move(0, 0)
    assert pixels(page, "spectrum", BLUE) != whole
    over.dblclick()
    assert pixels(page, "spectrum", BLUE) == whole


def test_one_cursor_stands_on_all_frequencies(opened):
    page = opened()
    over = page.locator("#spectrum .u-over")
    at = over.bounding_box()["width"] * np.log(1000 / 30) / np.log(5000 / 30)
    over.hover(position={"x": at - 5, "y": 90})
    over.hover(position={"x": at, "y": 90})
    for name, level in (("spectrum", 60 - 10 * np.log10(1000)), ("bands", 30 + np.sin(14))):
        entry = page.locator(f"#{name} label").filter(has_text="areal").text_content()
        assert float(re.search(r"areal([\d.]+) dB", entry)[1]) == pytest.approx(level, abs=0.1)
    assert page.locator("#run .curves .value").all_text_contents() == ["", ""]
    page.mouse.move(0, 0)
    assert not any(page.locator("#bands .curves .value").all_text_contents())


def test_paper_has_all_figures_light_and_whole(opened):
    page = opened(1280, "dark")
    page.emulate_media(media="print", color_scheme="dark")
    assert pixels(page, "run", BLUE) > 15
    assert pixels(page, "run", COLOURS[BLUE]) == 0
    canvases = page.locator(".uplot canvas")
    widths = canvases.evaluate_all("all => all.map((c) => c.getBoundingClientRect().width)")
    assert 200 < min(widths) < max(widths) <= 680
    assert page.evaluate(OVERLAPS) == []
    assert not page.get_by_role("button").first.is_visible()
    assert not page.get_by_text("4711").first.is_visible()
    page.emulate_media(media="screen", color_scheme="dark")
    assert pixels(page, "run", COLOURS[BLUE]) > 15


@pytest.mark.parametrize("lacking", ["scripts", "DecompressionStream"])
def test_numbers_stand_where_nothing_is_drawn(browser, address, lacking):
    scripts = lacking == "scripts"
    context = browser.new_context(java_script_enabled=False) if scripts else browser.contexts[0]
    page = context.new_page()
    page.add_init_script(f"delete window.{lacking}")
    page.goto(address)
    assert page.get_by_text("4711").first.is_visible()
    page.close()


def test_figures_far_below_are_drawn_when_they_are_near(browser, address):
    page = shared_page(browser, 390, 500)
    page.goto(address)
    page.wait_for_selector("#run .uplot canvas")
    assert page.locator("#words .uplot").count() == 0
    page.locator("#words").scroll_into_view_if_needed()
    page.wait_for_selector("#words .uplot canvas")


# --- paper, and narrow screens

WIDEST = "wheel-on-rail"
"""Its report has figures of all sorts; those of the others are looked at by --long."""

CUT = """() => [...document.querySelectorAll(".rows")]
  .filter((each) => each.scrollWidth > each.clientWidth + 1).map((each) => each.getAttribute("aria-label"))"""
REGIONS = """() => [...document.querySelectorAll("[role=region], nav, main, header")].map((each) =>
  `${each.getAttribute("role") ?? each.tagName} ${each.getAttribute("aria-label") ?? ""}`)"""
SHEETS = re.compile(rb"/Type\s*/Page\b")
SHEET = (297 - 2 * 11) * 96 / 25.4 - 12  # pixels of A4 between its margins
PRINTED_SIZE = """matchMedia("print").addEventListener("change", ({ matches }) => {
  const { height } = document.body.getBoundingClientRect();
  if (matches) window.printed_size = [Number(document.body.style.zoom) || 1, height];
})"""


def test_tables_are_whole_on_narrow_screens_and_contents_stay_in_sight(browser, reports):
    page = shared_page(browser, 390)
    page.goto((reports[WIDEST] / "report.html").as_uri())
    assert page.evaluate(CUT) == []
    before = page.locator(".rows td").first.evaluate("it => getComputedStyle(it, '::before').content")
    assert before == '"law"'
    regions = page.evaluate(REGIONS)
    assert len(set(regions)) == len(regions)  # no two landmarks of one name
    page.evaluate("document.querySelector('#provenance').scrollIntoView()")
    contents = page.locator("nav[aria-label=Contents]").bounding_box()
    assert 0.0 <= contents["y"] < 1000.0


@pytest.mark.parametrize("way", ["button", "summary"])
def test_a_summary_is_one_sheet_of_paper(browser, reports, real_runs, tmp_path, way):
    """With a table of more rows than a sheet holds."""
    file = reports[WIDEST] / "report.html"
    if way == "summary":
        file = write_summary(real_runs[WIDEST], tmp_path / "summary.html")
    page = shared_page(browser, 1200, 900)
    page.goto(file.as_uri())
    page.evaluate("window.print = () => { window.printed = true; }")
    page.locator("figure.chart.ready").last.wait_for(state="attached")
    assert page.locator("#print-summary").count() == (way == "button")
    more = "it => { for (let n = 0; n < 25; n++) it.append(it.rows[0].cloneNode(true)); }"
    page.locator(".answer tbody").first.evaluate(more)
    if way == "button":
        page.emulate_media(media="print")
        assert not page.locator("#print-summary").is_visible()
        page.emulate_media(media="null")
        page.click("#print-summary")
        page.wait_for_function("() => window.printed")
    else:
        page.evaluate("dispatchEvent(new Event('load'))")
        page.wait_for_function("() => Number(document.body.style.zoom) < 1")
    page.evaluate(PRINTED_SIZE)
    assert len(SHEETS.findall(page.pdf(prefer_css_page_size=True))) == 1
    zoom, height = page.evaluate("printed_size")
    assert zoom == 1.0 or height == pytest.approx(SHEET, rel=0.02)  # no smaller than the sheet asks for


# --- reports of all kinds


@pytest.fixture(params=[pytest.param(kind, marks=[pytest.mark.long] * (kind != WIDEST)) for kind in CASES])
def report_address(request, reports):
    """A report of each kind."""
    return (reports[request.param] / "report.html").as_uri()


def test_every_figure_is_drawn_and_readable_on_screens_and_paper(browser, report_address):
    with pages_of(browser, report_address) as opened:
        page = opened(390, "dark")
        assert_readable(page, 390)
        page.set_viewport_size({"width": 1280, "height": 1000})
        assert_readable(page, 1280)
        assert page.locator(".uplot canvas").first.bounding_box()["width"] > 390
        page.emulate_media(media="print")
        page.set_viewport_size({"width": 688, "height": 1000})  # of A4 between its margins
        assert_readable(page, 688)
        assert not page.locator("figure.chart details").first.is_visible()
