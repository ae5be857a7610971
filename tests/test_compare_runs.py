"""The script that compares two runs to the last bit finds every difference, and nothing but differences."""

import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from asperity.results import save, variable

sys.path.insert(0, str(Path(__file__).parents[1] / "benchmarks"))
from compare_runs import compare, main


def written(path, force=(1.0, 2.0, np.nan), name="contact_force", dim="time", note="of one law", **attrs):
    held = xr.Dataset({name: variable(dim, np.array(force), "N", "Contact force", note=note)})
    tree = xr.DataTree.from_dict({"/": xr.Dataset(attrs={"case": "text"}), "/rolling": held})
    tree["rolling"].attrs = {"verdict": "stays"} | attrs
    return save(tree, path)


@pytest.fixture
def first(tmp_path):
    return written(tmp_path / "a.nc")


@pytest.mark.parametrize(("change", "told"), [
    ({}, ""),
    ({"force": (1.0, np.nextafter(2.0, 3.0), np.nan)}, "contact_force: 1 of 3 differ, by up to 4.44e-16"),
    ({"force": (1.0, 2.0, 3.0)}, "contact_force: 1 of 3 differ"),
    ({"force": (1.0, 2.0)}, "contact_force: shape (3,), now (2,)"),
    ({"dim": "step"}, "contact_force: dimensions ('time',), now ('step',)"),
    ({"note": "of all laws"}, "contact_force/note: 'of one law', now 'of all laws'"),
    ({"verdict": "leaves"}, "@verdict: 'stays', now 'leaves'"),
    ({"name": "force"}, "contact_force: missing"),
])  # fmt: skip
def test_every_difference_is_told(first, tmp_path, capsys, change, told):
    other = written(tmp_path / "b.nc", **change)
    assert main([str(first), str(other)]) == (1 if told else 0)
    assert capsys.readouterr().out.startswith(f"rolling/{told}" if told else "")
    assert bool(compare(first, other, {})[0]) == bool(told)


def test_what_is_new_or_changed_its_name_on_purpose_is_no_difference(first, tmp_path):
    other = written(tmp_path / "b.nc", name="force", dim="step", seed=1)
    assert compare(first, other, {"contact_force": "force", "time": "step"}) == ([], ["rolling/@seed"])
    found, added = compare(first, other, {"rolling/contact_force": "rolling/force"})
    assert [str(d) for d in found] == ["rolling/contact_force: dimensions ('time',), now ('step',)"]
    assert added == ["rolling/@seed"]
