"""The picture of a report that README and documentation show, of the first lines in Python.

    python benchmarks/report_picture.py     # docs/pictures/report.png and, for dark screens, report_dark.png

It needs Chromium and Playwright (``pip install ".[test]"``).
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
from io import BytesIO
from pathlib import Path

from PIL import Image
from playwright.sync_api import sync_playwright

ROOT = Path(__file__).parents[1]
PICTURES = {"light": ROOT / "docs/pictures/report.png", "dark": ROOT / "docs/pictures/report_dark.png"}
VIEW = {"width": 1000, "height": 1600}


def written_page(folder: Path) -> Path:
    """Run the first lines in Python in a folder, and find the page that they write."""
    first = (ROOT / "docs/start/index.md").read_text(encoding="utf-8")
    lines = re.search(r"```python\n(.*?)```", first, re.DOTALL)
    assert lines is not None
    subprocess.run([sys.executable, "-c", lines[1]], cwd=folder, check=True)
    return folder / "page/report.html"


def main() -> None:
    """Make both pictures."""
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        page = written_page(Path(folder))
        chromium = shutil.which("chromium") or shutil.which("google-chrome")
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        for scheme, file in PICTURES.items():
            tab = browser.new_page(viewport=VIEW, color_scheme=scheme, device_scale_factor=1.25)
            tab.goto(page.as_uri(), wait_until="load")
            first = tab.locator("figure.chart .plot").first
            first.locator("canvas").last.wait_for()
            box = first.bounding_box()
            shown = {"x": 0, "y": 0, "width": VIEW["width"], "height": box["y"] + box["height"]}
            taken = Image.open(BytesIO(tab.screenshot(clip=shown))).convert("RGB")
            taken.save(file, optimize=True)  # every colour: few of them make green blue, or lines grey
        browser.close()


if __name__ == "__main__":
    main()
