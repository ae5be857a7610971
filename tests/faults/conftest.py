"""Marks all tests of this folder, and holds the run that what is disturbed has to end as."""

import sys
from pathlib import Path

import pytest

sys.path.extend([str(Path(__file__).parent), str(Path(__file__).parents[1] / "surfaces")])
from program import finished, prepared


def pytest_collection_modifyitems(items):
    for item in items:
        if Path(__file__).parent in item.path.parents:
            item.add_marker(pytest.mark.faults)


@pytest.fixture(scope="session")
def undisturbed(tmp_path_factory):
    """A folder with a finished run."""
    folder = prepared(tmp_path_factory.mktemp("undisturbed"))
    finished(folder)
    return folder
