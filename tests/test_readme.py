"""The README does what it says."""

import re
import subprocess
import sys
from pathlib import Path

from click.testing import CliRunner

from asperity.cli import main

README = (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8")


def test_it_is_short():
    assert README.count("\n") <= 120


def test_its_first_lines_run(tmp_path):
    (snippet,) = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    done = subprocess.run(
        [sys.executable, "-c", snippet], cwd=tmp_path, capture_output=True, text=True, encoding="utf-8"
    )
    assert done.returncode == 0, done.stderr
    assert "the contact force varies by " in done.stdout
    assert (tmp_path / "force.png").stat().st_size > 10_000
    assert done.stdout.strip().partition(";")[0] in (tmp_path / "page/report.html").read_text(
        encoding="utf-8"
    )


def test_its_links_and_pictures_lead_somewhere():
    for target in re.findall(r"\]\(([^)#]+)\)", README) + re.findall(r'src(?:set)?="([^"]+)"', README):
        assert (Path(__file__).parents[1] / target).exists(), target


def test_its_commands_exist():
    for command in set(re.findall(r"^asperity (\w+)|&& asperity (\w+)", README, re.MULTILINE)):
        name = "".join(command)
        assert CliRunner().invoke(main, [name, "--help"]).exit_code == 0, name
