"""The folder of a case that names files."""

import pytest
from case_texts import write_files


@pytest.fixture
def source(tmp_path):
    """The path of a case among the files that the cases here name."""
    return write_files(tmp_path)
