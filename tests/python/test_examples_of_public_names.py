"""Every public name has a docstring with an example, and every example does what it says."""

import doctest
import inspect

import pytest

import asperity

NAMES = sorted(set(asperity.__all__) - {"__version__", "laws"})
SHORT = {"laws": ["hertz", "linear"], "duration": 5e-3, "surface": {"spectrum": "iso3095"}}


@pytest.mark.parametrize("name", [*NAMES, "laws.register"])
def test_the_examples_of_a_public_name_hold(name, tmp_path, monkeypatch):
    """Those of its methods, too. In the examples `case` stands for any case that is soon computed."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("ASPERITY_CACHE", str(tmp_path / "cache"))
    thing = asperity.laws.register if name == "laws.register" else getattr(asperity, name)
    assert "Examples\n--------" in inspect.getdoc(thing)
    found = doctest.DocTestFinder().find(thing, name, globs={"case": asperity.BallOnBeam(**SHORT)})
    assert len(found[0].examples) >= 2
    said = []
    for example in found:
        example.globs |= {} if example is found[0] else vars(inspect.getmodule(thing))  # of methods
        doctest.DocTestRunner().run(example, out=said.append)
    assert not said, "".join(said)
