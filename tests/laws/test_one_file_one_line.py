"""A law is one file and one line: in a copy of the package, that is all that is added."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import asperity
from asperity import laws
from asperity.reporting.chart import COLOURS
from small_cases import BALL

FILE = '''
"""`cubic`: a law that did not come with the program, with a key of its own."""

from asperity.laws.areal import Areal
from asperity.laws.spec import LawSpec, Look, Need
from asperity.parameters import key
from asperity.parameters import Quantity


def build(materials):
    damping = materials.damping + materials.parameters["viscosity"]
    return Areal(materials.curve, materials.areal, damping, plane=materials.plane, name="cubic")


LAW = LawSpec(
    "cubic",
    "A law from a file of its own.",
    build,
    frozenset({Need.SAMPLES, Need.AREAL}),
    look=Look("#7f3b08", "-", "p"),
    parameters={"viscosity": key(Quantity("N s/m", at_least=0.0), "0 N s/m", "damping of this law besides")},
)
'''
SCRIPT = """
import json, pathlib, sys
from asperity.case.cases import parse_case, template
from asperity.scenes.report import report
from asperity.running import run
from asperity.studies.running import study

assert '"direct", "cubic", "hertz"' in template("ball-on-beam")
assert '"direct", "cubic", "hertz"' in template("wheel-on-rail")
try:
    parse_case('kind = "ball-on-beam"\\nlaws = ["cubik"]')
except ValueError as error:
    assert 'Did you mean "cubic"?' in str(error), error
case = json.loads(sys.argv[2])
tree = run(case)
force = tree["rolling/contact_force"]
assert (force.sel(law="cubic").values == force.sel(law="areal").values).all()
varied = study(case, {"cubic.viscosity": ["0 N s/m", "1 kN s/m"]})
levels = varied["force_level_a"].sel(law="cubic").values
assert levels[0] > levels[1] + 0.1, levels
assert "viscosity" not in template("bodies"), "not rolled"
assert "[cubic]" in template("bodies", laws=["cubic"])
assert 'viscosity = "0 N s/m"' in template("bodies", laws=["cubic"])
assert '"key": "cubic.viscosity"' in tree["scenario"].attrs["parameters"]
try:
    run(case | {"cubic": {"viscosity": "-1 N s/m"}})
except ValueError as error:
    assert "cubic.viscosity: received '-1 N s/m'; allowed: " in str(error), error
page = report(tree, sys.argv[1]).read_text(encoding="utf-8")
assert "<strong>cubic</strong>: A law from a file of its own." in page
assert ":#7f3b08;" in page
assert "cubic [dB re 1 N]" in (pathlib.Path(sys.argv[1]) / "force_bands.csv").read_text(encoding="utf-8")
print("all follows")
"""


def test_a_law_is_one_file_and_one_line(tmp_path):
    package = shutil.copytree(Path(asperity.__file__).parent, tmp_path / "src" / "asperity")
    (package / "laws" / "cubic.py").write_text(FILE, encoding="utf-8")
    registry = package / "laws" / "__init__.py"
    lines = registry.read_text(encoding="utf-8").splitlines()
    lines.insert(lines.index('    "direct",') + 1, '    "cubic",')
    registry.write_text("\n".join(lines) + "\n", encoding="utf-8")
    case = json.dumps(BALL | {"laws": ["cubic", "areal", "linear"]})
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT, str(tmp_path / "report"), case],
        env=os.environ | {"PYTHONPATH": str(package.parent)}, capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "all follows"


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
