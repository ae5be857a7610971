"""Every law has a look of its own, and a row in the readme."""

from pathlib import Path

from asperity import laws
from asperity.reporting.chart import COLOURS


def test_every_law_has_its_module_its_colour_and_its_row_in_the_readme():
    readme = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")
    looks = [laws.spec_of(name).look for name in laws.names()]
    for told in zip(*((look.colour, look.dashes, look.marker) for look in looks), strict=True):
        assert len(set(told)) == len(told)
    assert {look.colour for look in looks} <= set(COLOURS)  # each with a dark one that people chose
    table = readme[readme.index("| law | contact force") : readme.index("How far each law")]
    for name in laws.names():
        base, _, variant = name.partition("-")
        assert f"`{base}`" in table
        assert not variant or f"`…-{variant}`" in table
