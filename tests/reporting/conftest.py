"""Real runs, made once for all tests of results and reports."""

import pytest

import asperity
from asperity.case import PRESETS
from asperity.kinds.report import report
from small_cases import CASES

HARDNESS = {"ball-on-beam": "0.6 GPa", "wheel-on-rail": "1.2 GPa", "bodies": "0.6 GPa"}
"""Of which the highest crests yield, so that results hold what is said of running-in, too."""


def run_in(case):
    contact = case["contact"] | {"hardness": HARDNESS[case["kind"]], "running_in": 1}
    return case | {"contact": contact}


class Made(dict):
    """Values that are made when they are first asked for: not every process needs every kind."""

    def __init__(self, make):
        super().__init__()
        self.make = make

    def __missing__(self, key):
        self[key] = self.make(key)
        return self[key]


@pytest.fixture(scope="session")
def real_runs(tmp_path_factory):
    """Results by kind of case."""
    cache = str(tmp_path_factory.mktemp("cache"))

    def run(kind):
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("ASPERITY_CACHE", cache)
            return asperity.run(run_in(CASES[kind]))

    return Made(run)


@pytest.fixture(scope="session", params=list(PRESETS))
def real_run(request, real_runs):
    """Result of one kind of case after the other."""
    return real_runs[request.param]


@pytest.fixture(scope="session")
def reports(real_runs, tmp_path_factory):
    """Folders of the reports, by kind."""
    folder = tmp_path_factory.mktemp("reports")
    return Made(lambda kind: report(real_runs[kind], folder / kind).parent)
