"""Reports of the real runs, made once for all tests of reports."""

import pytest

from asperity.scenes.report import report
from small_cases import Made


@pytest.fixture(scope="session")
def reports(real_runs, tmp_path_factory):
    """Folders of the reports, by kind."""
    folder = tmp_path_factory.mktemp("reports")
    return Made(lambda kind: report(real_runs[kind], folder / kind).parent)
