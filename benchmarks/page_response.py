"""How long the page takes from moving the slider to the picture, in a real browser.

Needs the extra app, Playwright and a Chromium: python benchmarks/page_response.py
"""

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from playwright.sync_api import sync_playwright

CASES = {
    "ball-on-beam as the form opens": 'kind = "ball-on-beam"\n[surface]\nrms = "0.5 um"\n',
    "ball-on-beam, 30 N on 0.15 um": (
        'kind = "ball-on-beam"\n[ball]\nload = "30 N"\n[surface]\nrms = "0.15 um"\n'
        '[contact]\nspacing = "5 um"\nwindow = "0.6 mm"\n'
    ),
    "wheel-on-rail as the form opens": (
        'kind = "wheel-on-rail"\n[surface]\nspectrum = "iso3095"\n[wheel]\nroughness = "disc"\n'
    ),
    "wheel-on-rail, 0.1 mm grid": (
        'kind = "wheel-on-rail"\n[surface]\nspectrum = "iso3095"\n[contact]\nspacing = "0.1 mm"\n'
    ),
}
POSITIONS = 40
MOVED = "(it, share) => { it.value = 1000 * share; it.dispatchEvent(new Event('input')); }"
ANSWERED = "before => document.body.dataset.answers !== before"


def first_picture(browser, address):
    """Open the page; time of its first picture, ms."""
    page = browser.new_page(viewport={"width": 1280, "height": 900})
    page.goto(address)
    page.wait_for_selector("body[data-first-picture]", timeout=60_000)
    return page, int(page.evaluate("() => document.body.dataset.firstPicture"))


def slider(page, case, folder):
    """Open a case, and move its slider; cells along a side and times, ms."""
    file = folder / "case.toml"
    file.write_text(case)
    before = page.evaluate("() => document.body.dataset.answers")
    page.set_input_files("#case-file", file)
    page.wait_for_function(ANSWERED, arg=before, timeout=60_000)
    page.wait_for_timeout(1000)
    times = []
    for share in np.random.default_rng(1).random(POSITIONS):
        before = page.evaluate("() => document.body.dataset.answers")
        page.locator("#approach").evaluate(MOVED, share)
        page.wait_for_function(ANSWERED, arg=before, timeout=60_000)
        times.append(int(page.evaluate("() => document.body.dataset.slider")))
    return np.array(times)


def main():
    program = shutil.which("chromium") or shutil.which("google-chrome")
    with tempfile.TemporaryDirectory() as place, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=["--no-sandbox", "--disable-gpu"])
        command = [sys.executable, "-m", "asperity", "serve", "-o", f"{place}/page"]
        server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        try:
            address = server.stdout.readline().split()[-1]
            page, cold = first_picture(browser, address)
            page.close()
            page, warm = first_picture(browser, address)
            print(f"first picture: {cold} ms after the start of the server, {warm} ms later on")
            for name, case in CASES.items():
                times = slider(page, case, Path(place))
                print(f"{name}: median {np.median(times):.0f} ms, slowest {times.max()} ms")
        finally:
            server.send_signal(2)
            server.wait()
            browser.close()


if __name__ == "__main__":
    main()
