"""What is not imported for other libraries' sake."""

import subprocess
import sys

CODE = """
import sys
from asperity.unneeded import spare_pint
spare_pint()
import numpy, xarray
tree = xarray.Dataset(coords={"x": numpy.arange(3.0), "law": ["areal", "table"]})
assert tree["x"].sel(x=1.0) == 1.0
assert "pint" not in sys.modules, "pint was imported"
from asperity.units import quantity
assert quantity("3 furlong", "m") > 600.0
assert "pint" in sys.modules
spare_pint()
"""


def test_pint_is_imported_for_units_alone():
    done = subprocess.run([sys.executable, "-c", CODE], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
