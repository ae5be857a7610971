"""Marks all tests of this folder, and holds the run that what is disturbed has to end as."""

import sys
from pathlib import Path

import pytest

sys.path.extend([str(Path(__file__).parent), str(Path(__file__).parents[1] / "surfaces")])
from program import finished, prepared


def pytest_itemcollected(item):
    item.add_marker(pytest.mark.faults)  # this hook sees tests of this folder alone


@pytest.fixture(scope="session")
def undisturbed(tmp_path_factory):
    """A folder with a finished run."""
    folder = prepared(tmp_path_factory.mktemp("undisturbed"))
    finished(folder)
    return folder
