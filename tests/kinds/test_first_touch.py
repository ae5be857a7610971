"""What `asperity new` writes runs as it stands, with every check in range."""

import json

import pytest

from asperity.case import PRESETS
from asperity.case.cases import parse_case, template
from asperity.running import run

pytestmark = pytest.mark.usefixtures("cache_of_module")  # the ball's scans are those of the bodies


@pytest.mark.parametrize("kind", sorted(PRESETS))
def test_what_new_prints_runs_with_all_checks_in_range(kind):
    tree = run(parse_case(template(kind)))
    assert [w for w in json.loads(tree.attrs["warnings"]) if w["grade"] != "note"] == []
    checks = json.loads(tree["contact"].attrs["validity"])
    assert len(checks) > 5
    assert {check["grade"] for check in checks} <= {"", "note"}
    assert "never loses contact" in tree.attrs["verdict"]
