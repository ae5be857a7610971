"""Charts as the script draws them: on screens and paper, for eyes and ears, by mouse and keys."""

from __future__ import annotations

import re

import numpy as np
import pytest
from drawn import OVERLAPS, RECORDER, pixels, settled
from report_reading import HOSTILE

from asperity.reporting import chart
from asperity.reporting.chart import BLUE, COLOURS, GREEN, INK, VERMILLION, Axis, Boxes, Chart, Line, Panel
from asperity.reporting.page import PageFigure, page_template
from asperity.reporting.panels import band_axis, doubtful_boxes, frequency_axis, wavenumber_axis, words_axis
from asperity.reporting.payload import chart_script, chart_style, charts_json, digest_of

AREAL = {"label": "areal", "law": "areal", "colour": BLUE, "width": 2.2}
LINEAR = {"label": "linear", "law": "linear", "colour": VERMILLION, "dashes": (3.0, 1.5)}
SIZES = [(1280, "light"), (390, "dark")]
HIGHEST = 777.0
BANDS = 1000 * 10 ** (np.arange(-14, 8) / 10)


def run_chart():
    """Forces of a run with one highest point, and when contact is lost."""
    time = np.linspace(0.0, 3.0, 30_001)
    force, linear = 500 + 100 * np.sin(40 * time), 500 + 150 * np.sin(40 * time)
    force[20_000] = HIGHEST
    axis = Axis("time / s", 0.0, 3.0, linked=chart.TIME)
    bars = Boxes(*(np.array([at]) for at in (1.0, 1.1, -0.35, 0.35)), colour=BLUE, law="areal", label="areal")
    zero = chart.Rules(np.zeros(1), "y", dashes=())
    forces = Panel(
        axis, Axis("contact force / N"), (zero, Line(time, linear, **LINEAR), Line(time, force, **AREAL))
    )
    lost = Panel(axis, words_axis(("areal", "a law of a longer name"), "no contact"), (bars,), height=1.3)
    places = {"largest force": np.array([[1.99, 2.01]]), "next loss of contact": np.array([[0.9, 1.2]])}
    return Chart((forces, lost), places)


def spectrum_chart():
    """Lines with a gap, shades, rules and notes in each other's way."""
    frequency = np.geomspace(30, 5000, 200)
    level = 60 - 10 * np.log10(frequency)
    broken = np.where((frequency > 200) & (frequency < 400), np.nan, level + 6)
    notes = [
        chart.Note(words, 1000.0, 0.95, y_share=True) for words in ("first mode", "second mode, not far")
    ]
    upright = chart.Note("pinned-pinned", 2000.0, 0.03, y_share=True, upright=True)
    lines = (Line(frequency, broken, **LINEAR), Line(frequency, level, **AREAL))
    shades = doubtful_boxes(BANDS, BANDS < 60)
    rules = chart.Rules(np.array([1000.0, 1010.0, 2000.0]))
    axis = Axis("force PSD / dB re 1 N²/Hz", 20, 60)
    return Chart((Panel(frequency_axis(30, 5000), axis, (*shades, rules, *lines, *notes, upright)),))


def bands_chart():
    """Lines with markers in bands, and hatched bars below zero."""
    level = 30 + np.sin(np.arange(BANDS.size))
    zeros = np.zeros(BANDS.size)
    bars = Boxes(BANDS / 1.1, BANDS * 1.1, -level, zeros, "rail", GREEN, hatch="/", edge=INK)
    above = Line(BANDS, level, marker="o", **AREAL), Line(BANDS, level + 2, marker="s", **LINEAR)
    axis = band_axis(BANDS)
    return Chart((Panel(axis, Axis("level / dB"), above), Panel(axis, Axis("less / dB"), (bars,), height=2)))


def map_chart():
    """A field with a gap, outlined, beside a stretched one."""
    x, y = np.meshgrid(np.linspace(-1, 1, 40), np.linspace(-1, 1, 30), indexing="ij")
    pressure = np.where(x**2 + y**2 < 0.5, 800 * (1 - x**2 - y**2), np.nan)
    turn = np.linspace(0, 6.28, 60)
    side, up = Axis("x / mm (rolling direction →)", -1, 1), Axis("y / mm", -1, 1)
    field = chart.Field((-1, 1), (-1, 1), pressure, "pressure / MPa", 0, 800, "inferno_r")
    outline = chart.Shape(0.7 * np.cos(turn), 0.7 * np.sin(turn), dashes=(3.0, 2.0))
    gap = chart.Field((-1, 1), (-1, 1), x, "gap / µm", -0.5, 0.5)
    return Chart(
        (
            Panel(side, up, (field, outline), "pressure", equal=True),
            Panel(side, up, (gap,), "gap", beside=True),
        )
    )


def axes_chart():
    """Second axes, turned axes, logarithmic ones, areas."""
    wave = np.geomspace(10, 2e4, 50)
    psd = Axis("one-sided PSD / m³", log=True)
    depth = Axis("depth / µm", 10, 0, second=chart.Second("share / %", scale=10.0))
    turned = Axis("hardness / GPa", 5, 0, second=chart.Second("strength / kPa", scale=0.3, offset=1.0))
    spread = chart.Area(wave, 0.5e-9 / wave**2, 2e-9 / wave**2, "scatter", BLUE)
    mean = Line(wave, 1e-9 / wave**2, HOSTILE, GREEN)
    profile = Line(np.linspace(0, 10, 30), np.linspace(4, 1, 30), marker="^", width=0)
    return Chart(
        (Panel(wavenumber_axis(10, 2e4), psd, (spread, mean)), Panel(depth, turned, (profile,), beside=True))
    )


def scene_chart():
    """A drawing: a body and words, one axis with a name and one without."""
    body = chart.Shape(np.array([0.0, 4.0, 4.0, 0.0]), np.array([0.0, 0.0, 1.0, 1.0]), fill=BLUE)
    notes = [chart.Note(words, 1.0, 0.5) for words in ("1 m/s", "R = 2 m")]
    foot = Boxes(*(np.array([at]) for at in (0.0, 0.5, -0.5, 0.0)), colour=chart.GRID, hatch="/", edge=INK)
    return Chart(
        (Panel(Axis("x / m", -1.0, 5.0), Axis("", -1.0, 2.0), (body, foot, *notes), equal=True, plain=True),)
    )


def words_chart():
    """Bars that stand and bars that lie, by words."""
    words, count = ("rail", "sleepers", "wheel with its axle", "sum"), np.arange(4.0)
    high = np.array([90.0, 80, 95, 97])
    up = Boxes(count - 0.3, count + 0.3, np.full(4, 60.0), high, "areal", BLUE, law="areal", hatch="x")
    flat = Boxes(np.zeros(4), high, count - 0.3, count + 0.3, "share", GREEN)
    return Chart(
        (
            Panel(words_axis(words), Axis("power / dB(A)", 60, 100), (up,)),
            Panel(Axis("share / %", 0, 100), words_axis(words), (flat,), beside=True),
        )
    )


CHARTS = {
    "run": run_chart(),
    "spectrum": spectrum_chart(),
    "bands": bands_chart(),
    "map": map_chart(),
    "axes": axes_chart(),
    "words": words_chart(),
    "scene": scene_chart(),
}


def text_of_page():
    """A page with all charts, allowed to do what a report may."""
    figure = page_template("blocks.html.jinja").module.figure
    columns = {"x [m]": np.array([4711.0])}
    figures = (
        figure(PageFigure(name, f"Figure of {name}", "", chart, "", columns))
        for name, chart in CHARTS.items()
    )
    look = page_template("look.css.jinja").render(
        light=chart.colour_variables(dark=False, colours=COLOURS),
        dark=chart.colour_variables(dark=True, colours=COLOURS),
    )
    policy = f"default-src 'none'; style-src 'unsafe-inline'; script-src 'sha256-{digest_of(chart_script())}'"
    return (
        f'<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><title>Charts</title>'
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">'
        f'<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<style>{look}{chart_style()}</style></head><body><main><h1>Charts</h1><h2>All</h2>{''.join(figures)}</main>"
        f'<script type="application/json" id="charts">{charts_json(CHARTS, COLOURS)}</script>'
        f"<script>{chart_script()}</script></body></html>"
    )


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    path = tmp_path_factory.mktemp("charts") / "page.html"
    path.write_text(text_of_page(), encoding="utf-8")
    return path.as_uri()


@pytest.fixture
def opened(browser, address):
    """Open the page; nothing is loaded and nothing fails."""
    pages, told = [], []

    def open_page(width=1280, scheme="light", **kwargs):
        page = browser.new_page(viewport={"width": width, "height": 6000}, color_scheme=scheme, **kwargs)
        pages.append(page)
        page.add_init_script(RECORDER)
        page.on("console", lambda message: told.append(message.text))
        page.on("pageerror", lambda error: told.append(str(error)))
        page.on("request", lambda request: None if request.url == address else told.append(request.url))
        page.goto(address)
        if kwargs.get("java_script_enabled", True):
            panels = sum(len(chart.panels) for chart in CHARTS.values())
            page.locator(".uplot canvas").nth(panels - 1).wait_for(state="attached")
            settled(page)
        return page

    yield open_page
    for page in pages:
        page.close()
    assert not told


DRAWN = [
    ("run", 0, BLUE), ("run", 0, VERMILLION), ("run", 1, BLUE), ("spectrum", 0, BLUE),
    ("spectrum", 0, VERMILLION), ("bands", 0, BLUE), ("bands", 1, GREEN), ("bands", 1, INK),
    ("map", 0, "#fcffa4"), ("map", 0, INK), ("map", 1, "#00224e"), ("map", 1, "#fee838"),
    ("axes", 0, GREEN), ("axes", 1, INK), ("words", 0, BLUE), ("words", 1, GREEN), ("scene", 0, BLUE),
]  # fmt: skip


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_every_mark_is_drawn_in_the_colours_of_the_page(opened, scheme):
    page = opened(scheme=scheme)
    for name, panel, colour in DRAWN:
        light = scheme == "light" or name == "map"
        assert pixels(page, name, colour if light else COLOURS[colour], panel) > 15, (name, panel, colour)


def test_a_law_is_shown_or_not_in_all_figures_at_once(opened):
    page = opened()
    places = [("run", 0), ("run", 1), ("spectrum", 0), ("bands", 0), ("words", 0)]
    page.locator("#bands").get_by_role("checkbox", name="areal").uncheck()
    assert [pixels(page, name, BLUE, panel) for name, panel in places] == [0] * 5
    assert not page.locator("#words").get_by_role("checkbox", name="areal").is_checked()
    assert pixels(page, "run", VERMILLION) > 15
    page.locator("#run").get_by_role("checkbox", name="areal").first.check()
    assert all(pixels(page, name, BLUE, panel) > 15 for name, panel in places)


def test_what_is_no_law_is_shown_or_not_in_its_figure(opened):
    page = opened()
    page.locator("#words").get_by_role("checkbox", name="share").uncheck()
    assert pixels(page, "words", GREEN, 1) == 0
    assert pixels(page, "bands", GREEN, 1) > 15


def said(page, name):
    return page.locator(f"#{name} [role=status]").text_content().replace("−", "-")


def test_points_are_read_by_keys(opened):
    page = opened()
    area = page.get_by_role("application", name="Figure of run: contact force / N over time / s")
    area.focus()
    area.press("Home")
    for _ in range(12):
        area.press("+")
    for _ in range(7):
        area.press("ArrowRight")
    time, areal = re.match(r"time ([\d.]+) s: linear [\d.]+ N, areal ([\d.]+) N", said(page, "run")).groups()
    assert float(time) == pytest.approx(7e-4)  # zoomed in, a key is a time step
    assert float(areal) == pytest.approx(500 + 100 * np.sin(40 * 7e-4), abs=0.06)
    area.press("End")
    assert said(page, "run").startswith("time 3 s:")


def test_bands_words_and_fields_are_read_by_their_names(opened):
    page = opened()
    bands = page.locator("#bands [role=application]").first
    bands.press("Home")
    bands.press("ArrowRight")
    assert said(page, "bands") == "one-third octave band 50 Hz: areal 30.84 dB, linear 32.84 dB"
    words = page.locator("#words [role=application]").first
    words.press("Home")
    assert said(page, "words").endswith("rail: areal 90 dB(A)")
    field = page.locator("#map [role=application]").first
    field.press("ArrowUp")
    pressure = float(said(page, "map").split("pressure ")[1].split(" MPa")[0])
    assert 780 < pressure <= 800


def test_a_place_is_shown_by_its_button(opened):
    page = opened()
    whole = pixels(page, "run", VERMILLION)
    page.get_by_role("button", name="largest force").press("Enter")
    assert f"areal {HIGHEST:.0f} N" in said(page, "run")
    assert pixels(page, "run", VERMILLION) != whole
    assert pixels(page, "run", BLUE, 1) == 0  # the panel below shows the same time
    page.get_by_role("button", name="next loss of contact").press("Enter")
    assert pixels(page, "run", BLUE, 1) > 15
    page.locator("#run").get_by_role("button", name="show all").press("Enter")
    assert pixels(page, "run", VERMILLION) == whole


def test_a_part_is_dragged_over_and_all_comes_back(opened):
    page = opened()
    whole, over = pixels(page, "spectrum", BLUE), page.locator("#spectrum .u-over")
    box = over.bounding_box()
    page.mouse.move(box["x"] + 100, box["y"] + 50)
    page.mouse.down()
    page.mouse.move(box["x"] + 200, box["y"] + 60)
    page.mouse.up()
    page.mouse.move(0, 0)
    assert pixels(page, "spectrum", BLUE) != whole
    over.dblclick()
    assert pixels(page, "spectrum", BLUE) == whole


def test_one_cursor_stands_on_all_frequencies(opened):
    page = opened()
    box = page.locator("#spectrum .u-over").bounding_box()
    at = box["x"] + box["width"] * np.log(1000 / 30) / np.log(5000 / 30)
    page.mouse.move(at - 5, box["y"] + 90)
    page.mouse.move(at, box["y"] + 90)
    for name, level in (("spectrum", 60 - 10 * np.log10(1000)), ("bands", 30 + np.sin(14))):
        entry = page.locator(f"#{name} label").filter(has_text="areal").text_content()
        assert float(re.search(r"areal([\d.]+) dB", entry)[1]) == pytest.approx(level, abs=0.1)
    assert page.locator("#run .curves .value").all_text_contents() == ["", ""]
    page.mouse.move(0, 0)
    assert not any(page.locator("#bands .curves .value").all_text_contents())


@pytest.mark.parametrize("width", [1280, 800, 360])
def test_no_text_stands_over_another_and_none_is_cut_off(opened, width):
    page = opened(width)
    texts = page.evaluate("[...document.querySelectorAll('.uplot canvas')].map((c) => c.texts.length)")
    assert min(texts) > 3
    assert page.evaluate(OVERLAPS) == []
    assert page.evaluate("document.documentElement.scrollWidth") <= width


def test_paper_has_all_figures_light_and_whole(opened):
    page = opened(1280, "dark")
    page.emulate_media(media="print", color_scheme="dark")
    assert pixels(page, "run", BLUE) > 15
    assert pixels(page, "run", COLOURS[BLUE]) == 0
    widths = page.locator(".uplot canvas").evaluate_all(
        "all => all.map((c) => c.getBoundingClientRect().width)"
    )
    assert min(widths) > 300
    assert max(widths) <= 680
    assert page.evaluate(OVERLAPS) == []
    assert not page.get_by_role("button").first.is_visible()
    assert not page.get_by_text("4711").first.is_visible()
    page.emulate_media(media="screen", color_scheme="dark")
    assert pixels(page, "run", COLOURS[BLUE]) > 15


def test_numbers_stand_where_nothing_is_drawn(opened, browser, address):
    assert not opened().get_by_text("4711").first.is_visible()
    assert opened(java_script_enabled=False).get_by_text("4711").first.is_visible()
    old = browser.new_page()
    old.add_init_script("delete window.DecompressionStream")
    old.goto(address)
    assert old.get_by_text("4711").first.is_visible()
    old.close()


def test_figures_far_below_are_drawn_when_they_are_near(browser, address):
    page = browser.new_page(viewport={"width": 390, "height": 500})
    page.goto(address)
    page.wait_for_selector("#run .uplot canvas")
    assert page.locator("#words .uplot").count() == 0
    page.locator("#words").scroll_into_view_if_needed()
    page.wait_for_selector("#words .uplot canvas")
    page.close()


@pytest.mark.parametrize(("width", "scheme"), SIZES)
def test_no_finding_of_axe(opened, width, scheme):
    axe = pytest.importorskip(
        "axe_playwright_python.sync_playwright",
        reason="no test of accessibility: pip install axe-playwright-python",
    )
    found = axe.Axe().run(opened(width, scheme)).response["violations"]
    assert [(each["id"], [node["html"][:120] for node in each["nodes"][:3]]) for each in found] == []
