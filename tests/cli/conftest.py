"""A folder for each test, and one run that all commands look at which read results."""

import shutil
from pathlib import Path
from types import SimpleNamespace

import pytest

from command_line import CASE, SMALL, program, working_in


@pytest.fixture(autouse=True)
def own_folder(tmp_path, monkeypatch):
    """A folder with two cases, and a cache of its own."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("ASPERITY_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("COLUMNS", "400")
    Path("case.toml").write_text(CASE)
    Path("small.toml").write_text(SMALL)
    return tmp_path


@pytest.fixture(scope="session")
def ran(tmp_path_factory):
    """Folder of a small run with its report, what was said, and what was imported for it."""
    with working_in(tmp_path_factory.mktemp("ran")) as folder:
        Path("small.toml").write_text(SMALL)
        script = "import sys\nfrom asperity.cli import main\nmain(standalone_mode=False)\nprint(*sys.modules)"
        done = program("run", "small.toml", "-o", "out", script=script)
    *stdout, modules = done.stdout.splitlines()
    out = folder / "out"
    return SimpleNamespace(
        folder=out, path=str(out), stdout=stdout, stderr=done.stderr.splitlines(), modules=modules.split()
    )


@pytest.fixture
def out(ran, own_folder):
    """A copy of this run, in the working folder."""
    shutil.copytree(ran.folder, "out")
    return Path("out")
