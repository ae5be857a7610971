"""The report in a browser: read by cursor and keys, on screens of all sizes and on paper, by everybody."""

from __future__ import annotations

import re

import numpy as np
import pytest
from report_tree import report_tree

from asperity.kinds.report import report

STEPS, HIGHEST = 4000, 60.0
SIZES = [(1280, "light"), (1280, "dark"), (360, "light"), (360, "dark")]


@pytest.fixture(scope="module")
def tree():
    """A run whose main law loses contact twice, and is highest once."""
    tree = report_tree(["areal", "table", "linear-filtered", "linear"], steps=STEPS)
    rolling = tree["rolling"].to_dataset()
    force = rolling["contact_force"].values.clip(1.0)
    force[0, 500:540] = force[0, 3000:3100] = 0.0
    force[0, 2000] = HIGHEST
    share = (force <= 0).mean(axis=1)
    tree["rolling"] = rolling.assign(
        contact_force=(("law", "time"), force), contact_loss_share=("law", share)
    )
    return tree


@pytest.fixture(scope="module")
def address(tree, tmp_path_factory):
    return report(tree, tmp_path_factory.mktemp("run")).as_uri()


@pytest.fixture
def page(browser, address):
    """The report, opened in a wide window; nothing is loaded and nothing fails."""
    page, told = browser.new_page(viewport={"width": 1280, "height": 900}), []
    page.on("console", lambda message: told.append(message.text))
    page.on("pageerror", lambda error: told.append(str(error)))
    page.on("request", lambda request: None if request.url == address else told.append(request.url))
    page.goto(address)
    page.wait_for_selector("figure.ready canvas")
    yield page
    page.close()
    assert not told


def reading(page):
    """Time, ms, and force of the laws, N, that are read at the cursor, and who has no contact."""
    text = page.locator("[role=status]").text_content().replace("−", "-")
    force = {law: float(number) for law, number in re.findall(r"([a-z-]+) (-?[\d.]+) N", text)}
    return float(text.split(" ms")[0]), force, text.partition("no contact: ")[2]


def test_the_force_is_read_at_the_cursor(page, tree):
    area = page.get_by_role("application")
    area.focus()
    area.press("Home")
    for _ in range(12):
        area.press("+")
    for _ in range(7):
        area.press("ArrowRight")
    time, force, _ = reading(page)
    rolling = tree["rolling"].to_dataset()
    index = int(np.argmin(np.abs(1e3 * rolling["time"].values - time)))
    assert index == 7  # zoomed in, a key is a time step
    for law, found in force.items():
        values = rolling["contact_force"].sel(law=law).values
        assert found == pytest.approx(values[index], abs=np.ptp(values) / 2**14 + 0.005)
    assert "areal" in force


def test_the_largest_force_is_found(page, tree):
    page.get_by_role("button", name="largest force").press("Enter")
    time, force, _ = reading(page)
    assert time == pytest.approx(1e3 * float(tree["rolling/time"][2000]), abs=0.011)
    assert force["areal"] == pytest.approx(HIGHEST, abs=0.005)


def test_losses_of_contact_are_visited_in_turn(page, tree):
    button, times = page.get_by_role("button", name="next loss of contact"), 1e3 * tree["rolling/time"].values
    for first, last in ((500, 540), (3000, 3100), (500, 540)):  # and round again
        button.press("Enter")
        time, force, without = reading(page)
        assert times[first] <= time + 0.011
        assert time <= times[last]
        assert (force["areal"], without) == (0.0, "areal")


def picture(page):
    """What is drawn, once it is."""
    page.wait_for_timeout(100)
    page.mouse.move(0, 0)
    return page.locator(".plot").screenshot()


def test_zooming_draws_a_part_and_all_comes_back(page):
    whole = picture(page)
    page.get_by_role("button", name="zoom in").press("Enter")
    assert picture(page) != whole
    page.get_by_role("button", name="whole run").press("Enter")
    assert picture(page) == whole
    box = page.locator(".u-over").bounding_box()
    page.mouse.move(box["x"] + 100, box["y"] + 50)
    page.mouse.down()
    page.mouse.move(box["x"] + 200, box["y"] + 60)
    page.mouse.up()
    assert picture(page) != whole


def test_laws_are_drawn_at_will(page):
    boxes = page.get_by_role("group", name="Laws that are drawn").get_by_role("checkbox")
    assert boxes.count() == 4
    before = picture(page)
    box = page.get_by_role("checkbox", name="table")
    box.focus()
    box.press("Space")
    assert picture(page) != before


@pytest.mark.parametrize(("width", "scheme"), [(1280, "dark"), (360, "light")])  # each of both, once
def test_no_serious_finding_of_axe(browser, address, width, scheme):
    axe = pytest.importorskip(
        "axe_playwright_python.sync_playwright",
        reason="no test of accessibility: pip install axe-playwright-python",
    )
    page = browser.new_page(viewport={"width": width, "height": 900}, color_scheme=scheme)
    page.goto(address)
    page.wait_for_selector("figure.ready canvas")
    page.evaluate("document.querySelectorAll('details').forEach((folded) => { folded.open = true; })")
    found = axe.Axe().run(page).response["violations"]
    page.close()
    grave = [
        (each["id"], each["impact"], [node["html"][:120] for node in each["nodes"][:3]])
        for each in found
        if each["impact"] in ("serious", "critical")
    ]
    assert not grave


@pytest.mark.parametrize(("width", "scheme"), SIZES)
def test_the_page_is_as_wide_as_the_screen(browser, address, width, scheme):
    page = browser.new_page(viewport={"width": width, "height": 900}, color_scheme=scheme)
    page.goto(address)
    page.wait_for_selector("figure.ready canvas")
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert page.locator("figure .drawing:visible").count() == page.locator("figure").count() - 1
    page.close()


def test_without_scripts_the_drawing_stays(browser, address):
    page = browser.new_page(java_script_enabled=False)
    page.goto(address)
    assert page.locator("#force_envelope .drawing svg").is_visible()
    assert page.locator(".live").count() == 0
    page.close()


def test_paper_shows_the_whole_case_and_the_drawing(page):
    assert not page.locator("details .case").is_visible()
    page.emulate_media(media="print")
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert page.locator("details .case").is_visible()
    assert page.locator("#force_envelope .drawing svg").is_visible()
    assert not page.locator(".live").is_visible()
