"""A folder for each test, and one run that all commands look at which read results."""

import shutil
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from command_line import CASE, SMALL, call, working_in


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
    """Folder of a small run with its report, and what was said; what draws for papers is not there for it."""
    with working_in(tmp_path_factory.mktemp("ran")) as folder, pytest.MonkeyPatch.context() as patch:
        for name in ["matplotlib", *(name for name in sys.modules if name.startswith("matplotlib."))]:
            patch.setitem(sys.modules, name, None)
        Path("small.toml").write_text(SMALL)
        done = call("run", "small.toml", "-o", "out")
    out = folder / "out"
    return SimpleNamespace(
        folder=out, path=str(out), stdout=done.stdout.splitlines(), stderr=done.stderr.splitlines()
    )


@pytest.fixture
def out(ran, own_folder):
    """A copy of this run, in the working folder."""
    shutil.copytree(ran.folder, "out")
    return Path("out")
