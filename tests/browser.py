"""A real browser for tests: Chromium without a window, driven by Playwright."""

import importlib.util
import os
import shutil

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
        yield started
        started.close()
