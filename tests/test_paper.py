"""The paper says what the evidence says."""

import re
import statistics
from pathlib import Path

from asperity.reference.law_accuracy import law_map

PAPER = Path(__file__).parents[1] / "paper"
TEXT = (PAPER / "paper.md").read_text(encoding="utf-8")
BODY = TEXT.split("---", 2)[2]


def test_every_citation_is_in_the_list_and_every_entry_is_cited():
    known = set(re.findall(r"^@\w+\{(\w+),", (PAPER / "paper.bib").read_text(encoding="utf-8"), re.MULTILINE))
    assert known == set(re.findall(r"@(\w+)", BODY))


def test_every_figure_is_there_and_drawn_by_the_script():
    script = (PAPER / "figures.py").read_text(encoding="utf-8")
    for name in re.findall(r"\]\((\w+\.png)\)", BODY):
        assert (PAPER / name).stat().st_size > 10_000
        assert f'"{name}"' in script


def median(law, points):
    return statistics.median(p.details["laws"][law] for p in points if law in p.details["laws"])


def test_its_numbers_are_those_of_the_map():
    points = law_map().points
    kept = [p for p in points if p.loss < 0.01]
    smooth = [p for p in kept if p.place.within <= 0.1]
    stated = " ".join(BODY.split())
    assert f"computed at {len(points)} points" in stated
    assert f"`areal` is off by {median('areal', smooth):.1f} dB in the median" in stated
    assert f"with its filter by {median('linear-filtered', smooth):.1f} dB" in stated
    assert f"without by {median('linear', smooth):.1f} dB" in stated
    assert median("table", kept) < 0.1
    page = (PAPER.parent / "docs/law_accuracy.md").read_text(encoding="utf-8")
    (share,) = re.findall(r"\| all \|.*?(\d+) % \|", page)
    assert f"held in {share} % of cases" in stated
