"""A real browser for tests, Chromium without a window, driven by Playwright; and what it draws on a page."""

import importlib.util
import os
import shutil
from contextlib import contextmanager

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
"""What the program is called on different systems."""


def chromium():
    """Start the browser of this machine, and end it; tests skip, with the reason, where there is none."""
    if importlib.util.find_spec("playwright") is None:
        pytest.skip("no browser tests: Playwright is missing (pip install playwright)")
    program = next(filter(None, map(shutil.which, NAMES)), None)
    if program is None:
        pytest.skip(f"no browser tests: none of {', '.join(NAMES)} is installed (apt-get install chromium)")
    from playwright.sync_api import sync_playwright

    flags = ["--disable-gpu", "--disable-dev-shm-usage"]
    if getattr(os, "geteuid", lambda: 1)() == 0:  # a sandbox of its own it has for other users alone
        flags.append("--no-sandbox")
    with sync_playwright() as playwright:
        started = playwright.chromium.launch(executable_path=program, args=flags)
        context = started.new_context()
        context.add_init_script(RECORDER)
        context.new_page()
        yield started
        started.close()


def shared_page(browser, width=1280, height=1000, scheme="light"):
    """The page that all tests of a browser share; one of their own would start a process, for half a second.

    It is as wide and high as asked for, on a screen, with nothing beneath the mouse.
    """
    page = browser.contexts[0].pages[0]
    page.mouse.move(0, 0)
    page.set_viewport_size({"width": width, "height": height})
    page.emulate_media(media="null", color_scheme=scheme)
    return page


# --- what is drawn: colours, and texts with their places

RECORDER = """(() => {  // every text that is drawn, where it stands in its picture
  const { fillText, clearRect } = CanvasRenderingContext2D.prototype;
  CanvasRenderingContext2D.prototype.fillText = function (text, x, y) {
    const size = this.measureText(text), place = this.getTransform();
    const corners = [-size.actualBoundingBoxLeft, size.actualBoundingBoxRight].flatMap((across) =>
      [-size.actualBoundingBoxAscent, size.actualBoundingBoxDescent].map((down) =>
        place.transformPoint({ x: x + across, y: y + down })));
    const [xs, ys] = [corners.map((c) => c.x), corners.map((c) => c.y)];
    if (text) (this.canvas.texts ??= []).push({ text, left: Math.min(...xs), right: Math.max(...xs),
      top: Math.min(...ys), bottom: Math.max(...ys) });
    return fillText.call(this, text, x, y);
  };
  CanvasRenderingContext2D.prototype.clearRect = function (...box) {
    this.canvas.texts = [];
    return clearRect.apply(this, box);
  };
})()"""

PIXELS = """(canvas, colours) => {  // how many have each of the colours, and how many are not empty
  const { width, height } = canvas, count = colours.map(() => 0);
  const copy = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
  copy.drawImage(canvas, 0, 0);
  const { data } = copy.getImageData(0, 0, width, height);
  for (let i = 0; i < data.length; i += 4) {
    if (data[i + 3] < 200) continue;
    const has = (colour) => colour.reduce((off, part, k) => off + Math.abs(data[i + k] - part), 0) < 12;
    colours.forEach((colour, n) => { if (has(colour)) count[n]++; });
  }
  return count;
}"""

OVERLAPS = """() => {  // texts that stand over others, or are cut off
  const meet = (a, b) =>
    a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1;
  const found = [];
  const look = (boxes, where) => boxes.forEach((a, n) => boxes.slice(n + 1).forEach((b) => {
    if (meet(a, b)) found.push(`${where}: ${a.text} over ${b.text}`);
  }));
  for (const canvas of document.querySelectorAll(".uplot canvas")) {
    const texts = canvas.texts ?? [], { id } = canvas.closest("figure");
    look(texts, id);
    for (const { text, left, right, top, bottom } of texts) {
      const inside = left >= -1 && top >= -1 && right <= canvas.width + 1 && bottom <= canvas.height + 1;
      if (!inside) found.push(`${id}: ${text} is cut off`);
    }
  }
  for (const figure of document.querySelectorAll("figure.chart")) {
    const words = "h2, h3, label, button, strong, .names span, .along, summary";
    const labels = figure.querySelectorAll(`${words}, .uplot`);
    const boxes = [...labels].map((label) => ({ text: label.textContent || label.className,
      ...label.getBoundingClientRect().toJSON() }));
    look(boxes.filter((box) => box.width && box.height), figure.id);
  }
  return found;
}"""

EMPTY = """() => {  // panels without words, or with nothing but words and grid
  const root = getComputedStyle(document.documentElement);
  const grid = [0, 2, 4].map((n) => parseInt(root.getPropertyValue("--c2").trim().slice(n + 1, n + 3), 16));
  return [...document.querySelectorAll(".uplot canvas")].filter((canvas) => {
    const { left, top, width, height } = canvas.parentElement.querySelector(".u-over").style;
    const [x, y, across, down] = [left, top, width, height].map(parseFloat);
    const copy = new OffscreenCanvas(across, down).getContext("2d", { willReadFrequently: true });
    copy.drawImage(canvas, -x, -y);
    const { data } = copy.getImageData(0, 0, across, down);
    let drawn = 0;
    for (let i = 0; drawn < 100 && i < data.length; i += 4) {
      const off = grid.reduce((sum, part, k) => sum + Math.abs(data[i + k] - part), 0);
      if (data[i + 3] > 200 && off > 60) drawn++;
    }
    return drawn < 100 || (canvas.texts ?? []).length < 3;
  }).map((canvas) => canvas.closest("figure").id);
}"""


ALL_HAVE = "(what) => [...document.querySelectorAll('figure.chart')].every((it) => it.querySelector(what))"


def settled(page):
    """Wait until what was asked for is drawn."""
    page.evaluate("new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn)))")


def pixels(page, name, colour, panel=0):
    """Pixels of a colour in a panel of a figure."""
    settled(page)
    canvas = page.locator(f"#{name} .uplot canvas").nth(panel)
    return canvas.evaluate(PIXELS, [[int(colour[n : n + 2], 16) for n in (1, 3, 5)]])[0]


@contextmanager
def pages_of(browser, address):
    """Opens a page at any width, with all drawn as before it is printed; nothing is loaded, nothing fails."""
    told, page = [], shared_page(browser)
    heard = {
        "console": lambda message: told.append(message.text),
        "pageerror": lambda error: told.append(str(error)),
        "request": lambda request: None if request.url == address else told.append(request.url),
    }

    def open_page(width=1280, scheme="light"):
        shared_page(browser, width, scheme=scheme).goto(address)
        page.wait_for_function(ALL_HAVE, arg=".plot .panel")
        page.evaluate("for (const name of ['beforeprint', 'afterprint']) dispatchEvent(new Event(name))")
        page.wait_for_function(ALL_HAVE, arg=".uplot canvas")
        settled(page)
        return page

    for event, hear in heard.items():
        page.on(event, hear)
    yield open_page
    for event, hear in heard.items():
        page.remove_listener(event, hear)
    assert not told


def assert_readable(page, width):
    """Nothing is empty, wider than the page, or stands over another."""
    settled(page)
    assert page.evaluate(EMPTY) == []
    assert page.evaluate(OVERLAPS) == []
    assert page.evaluate("document.documentElement.scrollWidth") <= width


LOOKS = """() => {  // marks one of all texts that look alike, to all that stands behind them
  const looks = new Map(), seen = new Set();
  const look = (element) => {
    if (!element) return "";
    if (!looks.has(element)) {
      const of = getComputedStyle(element);
      const own = [of.color, of.backgroundColor, of.backgroundImage, of.opacity, of.fontSize, of.fontWeight,
        of.textShadow, of.position, of.visibility, of.display === "none"];
      looks.set(element, `${look(element.parentElement)}>${element.tagName} ${own.join(" ")}`);
    }
    return looks.get(element);
  };
  const has_text = (element) => element.matches("input, select, textarea, button")
    || [...element.childNodes].some(({ nodeType, data }) => nodeType === Node.TEXT_NODE && data.trim());
  for (const element of [...document.body.querySelectorAll("*")].filter(has_text)) {
    if (!seen.has(look(element))) element.dataset.look = seen.add(look(element)).size;
  }
}"""
AXE = """async (looks) => {  // contrast, which takes most of its time, of those of their looks alone
  axe.configure({ rules: [{ id: "color-contrast", selector: looks }] });
  const { violations } = await axe.run({ resultTypes: ["violations"] });
  return violations.map(({ id, nodes }) => [id, nodes.slice(0, 3).map(({ html }) => html.slice(0, 120))]);
}"""


def assert_accessible(page):
    """No finding of axe, with all that is folded open; rows of numbers are alike, and two stand for them."""
    name, reason = "axe_playwright_python.sync_playwright", "pip install axe-playwright-python"
    axe = pytest.importorskip(name, reason=reason).Axe()
    page.evaluate("document.querySelectorAll('details').forEach((folded) => { folded.open = true; })")
    page.evaluate(
        "document.querySelectorAll('details.numbers tr:nth-child(n+3)').forEach((row) => row.remove())"
    )
    page.evaluate(LOOKS)
    page.evaluate(axe.axe_script)
    assert page.evaluate(AXE, "[data-look]") == []
