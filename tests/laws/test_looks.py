"""Every law has a look of its own, and a row in the table of what is computed."""

from pathlib import Path

from asperity import laws
from asperity.reporting.chart import COLOURS


def test_every_law_has_its_module_its_colour_and_its_row_in_the_table():
    page = Path(__file__).parents[2] / "docs" / "method" / "what_it_computes.md"
    told = page.read_text(encoding="utf-8")
    looks = [laws.spec_of(name).look for name in laws.names()]
    for shown in zip(*((look.colour, look.dashes, look.marker) for look in looks), strict=True):
        assert len(set(shown)) == len(shown)
    assert {look.colour for look in looks} <= set(COLOURS)  # each with a dark one that people chose
    table = told[told.index("| law | contact force") : told.index("## How far each law")]
    for name in laws.names():
        base, _, variant = name.partition("-")
        assert f"`{base}`" in table
        assert not variant or f"`…-{variant}`" in table
