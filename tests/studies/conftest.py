"""A folder for each test, with a smooth ball in it and a cache beside it."""

from pathlib import Path

import pytest
from executors import BALL


@pytest.fixture(autouse=True)
def own_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("ASPERITY_CACHE", str(tmp_path / "cache"))
    Path("ball.toml").write_text(BALL)
