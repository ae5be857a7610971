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


def test_its_snippet_makes_its_figure(tmp_path):
    (snippet,) = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    done = subprocess.run([sys.executable, "-c", snippet], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("30.0 N on ")
    assert (tmp_path / "quick_start.png").stat().st_size > 10_000
    shown = Path(__file__).parents[1] / "docs" / "quick_start.png"
    assert shown.is_file()


def test_its_links_lead_somewhere():
    for target in re.findall(r"\]\(([^)#]+)\)", README):
        assert (Path(__file__).parents[1] / target).exists(), target


def test_its_commands_exist():
    for command in set(re.findall(r"^asperity (\w+)|&& asperity (\w+)", README, re.MULTILINE)):
        name = "".join(command)
        assert CliRunner().invoke(main, [name, "--help"]).exit_code == 0, name
